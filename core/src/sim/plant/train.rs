//! Drive train: motor, coupling and load, solved exactly over one cycle, including events within it.
//!
//! Law      the equations of [`super::regions`], exact as long as the region does not change. A body with dry friction
//!          slides against it; when its velocity passes 0 it sticks if the other torques do not exceed its static
//!          friction, until they do. A coupling with backlash transmits from its flanks on, with spring and damping. An
//!          event within a step is found by halving it 30 times. If a part of a cycle has more than [`MOST_SEARCHES`]
//!          searches for events, the rest of that part is omitted: the train does not move in it, so that no energy is
//!          added
//! Reads    the acceleration of the setpoint (rad/s^2), whether the shaft is held
//! Writes   the angle of the motor per cycle (rad), velocities (rad/s), twist (rad)
//! Refuses  nothing: a setpoint of NaN is 0
//! Source   contract section 3

use super::data::{Friction, MotorData};
use super::regions::{DRIVE, Equations, Held, LOAD, MOTOR, Region, RegionSteps, TRAVEL, TWIST, Vector};
use nalgebra::SVector;

/// Maximum searches for events in one part of a cycle; an event takes at most two.
const MOST_SEARCHES: u32 = 128;

/// Contact of the coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Contact {
    /// It has no backlash, or there is no coupling.
    Always,
    /// Between its flanks.
    Open,
    /// The motor pushes the load in positive direction.
    Ahead,
    /// The motor pushes the load in negative direction.
    Behind,
}

impl Contact {
    /// Returns the contact for the twist and half the gap.
    fn of(twist: f64, half_gap: f64) -> Self {
        match () {
            () if twist > half_gap => Self::Ahead,
            () if twist < -half_gap => Self::Behind,
            () => Self::Open,
        }
    }

    /// Returns the flank, as a sign.
    fn side(self) -> f64 {
        match self {
            Self::Always | Self::Open => 0.0,
            Self::Ahead => 1.0,
            Self::Behind => -1.0,
        }
    }
}

/// State of the friction of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FrictionState {
    /// It has no dry friction.
    Free,
    /// It slides in positive direction.
    Forwards,
    /// It slides in negative direction.
    Backwards,
    /// Friction holds it.
    Sticks,
    /// It is held externally against any torque.
    Held,
}

impl FrictionState {
    fn stands(self) -> bool {
        matches!(self, Self::Sticks | Self::Held)
    }

    /// Returns true if a sliding body reverses with that velocity.
    fn reverses(self, velocity: f64) -> bool {
        velocity * self.sign() < 0.0
    }

    /// Returns the direction of sliding.
    fn sign(self) -> f64 {
        match self {
            Self::Forwards => 1.0,
            Self::Backwards => -1.0,
            Self::Free | Self::Sticks | Self::Held => 0.0,
        }
    }
}

/// State of a drive train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    values: Vector,
    contact: Contact,
    /// Friction states of motor and load.
    grips: [FrictionState; 2],
}

/// One of the bodies; accelerations are torques divided by its inertia (rad/s^2).
#[derive(Clone, Copy, Debug)]
struct Body {
    /// Constant acceleration.
    weight: f64,
    /// Sliding friction.
    sliding: f64,
    /// Static friction.
    holding: f64,
}

impl Body {
    fn new(inertia: f64, frictions: &[Friction], torque: f64) -> Self {
        let sum = |part: fn(&Friction) -> f64| frictions.iter().map(part).sum::<f64>();
        let over = |torque: f64| if inertia > 0.0 { torque / inertia } else { 0.0 };
        let (sliding, holding) = (sum(|friction| friction.coulomb), sum(|friction| friction.holding));
        Self { weight: over(torque), sliding: over(sliding), holding: over(holding) }
    }

    fn grip_at_rest(&self) -> FrictionState {
        if self.holding > 0.0 { FrictionState::Sticks } else { FrictionState::Free }
    }

    /// Returns the friction state of a body at rest with that acceleration.
    fn grip_against(&self, pull: f64) -> FrictionState {
        match () {
            () if pull.abs() <= self.holding => FrictionState::Sticks,
            () if pull > 0.0 => FrictionState::Forwards,
            () => FrictionState::Backwards,
        }
    }

    /// Returns the accelerations that do not depend on its neighbours.
    fn held(&self, grip: FrictionState) -> f64 {
        self.weight - self.sliding * grip.sign()
    }

    /// Returns true if it leaves its region with that velocity and acceleration.
    fn leaves(&self, grip: FrictionState, velocity: f64, pull: f64) -> bool {
        grip.reverses(velocity) || grip == FrictionState::Sticks && pull.abs() > self.holding
    }
}

/// The law of a drive train over one cycle.
#[derive(Clone, Debug)]
pub(super) struct Train {
    equations: Equations,
    bodies: [Body; 2],
    /// Steps from the beginning of a cycle until a setpoint takes effect in it, and of the rest.
    parts: [RegionSteps; 2],
}

impl Train {
    /// Creates the train of checked data; a setpoint takes effect `part_ns` after the beginning of its cycle.
    pub(super) fn new(data: &MotorData, part_ns: u64, cycle_ns: u64) -> Self {
        let equations = Equations::new(data);
        let (own, load) = (data.friction, data.load.friction);
        let bodies = if equations.is_elastic {
            [Body::new(data.inertia, &[own], 0.0), Body::new(data.load.inertia, &[load], data.load.torque)]
        } else {
            [Body::new(equations.inertia, &[own, load], data.load.torque), Body::new(0.0, &[], 0.0)]
        };
        let load_sticks = load.is_dry() && equations.is_elastic;
        let has_gap = equations.half_gap > 0.0;
        let has_events = own.is_dry() || load.is_dry() || has_gap;
        let enters = |region: Region| (region.pressed || has_gap) && (!region.load_stands || load_sticks);
        let durations = [part_ns, cycle_ns.saturating_sub(part_ns)].map(|part| part as f64 / 1e9);
        Self { equations, bodies, parts: durations.map(|part| RegionSteps::new(&equations, part, has_events, enters)) }
    }

    /// Returns the state at rest, with the twist of the coupling by the weight of the load.
    pub(super) fn rest(&self) -> State {
        let Equations { half_gap, pace, is_elastic, .. } = self.equations;
        let [_, load] = self.bodies;
        let pulled = if is_elastic { -load.weight / self.equations.spring[1] } else { 0.0 };
        let twist = if pulled == 0.0 { 0.0 } else { pulled + half_gap.copysign(pulled) };
        let mut values = Vector::zeros();
        values[TWIST] = twist * pace;
        let contact = if half_gap > 0.0 { Contact::of(twist, half_gap) } else { Contact::Always };
        State { values, contact, grips: self.bodies.map(|body| body.grip_at_rest()) }
    }

    /// Executes one cycle with the accelerations of the setpoint in its two parts (rad/s^2). Returns the angle of the
    /// motor (rad).
    pub(super) fn cycle(&self, state: &mut State, asked: [f64; 2], held: bool) -> f64 {
        state.values[TRAVEL] = 0.0;
        let grip = &mut state.grips[0];
        if held {
            (*grip, state.values[MOTOR]) = (FrictionState::Held, 0.0);
        } else if *grip == FrictionState::Held {
            *grip = self.bodies[0].grip_at_rest();
        }
        for (part, asked) in self.parts.iter().zip(asked) {
            self.run(part, state, if asked.is_finite() { asked } else { 0.0 });
        }
        state.values[TRAVEL]
    }

    /// Executes one part of a cycle.
    fn run(&self, part: &RegionSteps, state: &mut State, asked: f64) {
        let mut searches = 0;
        for _ in 0..part.pieces {
            let mut left = part.ticks;
            while left > 0 {
                if searches > MOST_SEARCHES {
                    return;
                }
                let (taken, searched) = self.advance(part, state, asked, left);
                left = left.saturating_sub(taken);
                searches += u32::from(searched);
            }
        }
    }

    /// Advances by the longest possible step of at most `left` ticks, or up to an event within it. Returns the ticks,
    /// and whether it had to search.
    fn advance(&self, part: &RegionSteps, state: &mut State, asked: f64, left: u32) -> (u32, bool) {
        let held = self.held(state, asked);
        let region = Region {
            pressed: state.contact != Contact::Open,
            motor_stands: state.grips[0].stands(),
            load_stands: state.grips[1].stands(),
        };
        let (mut taken, mut searched) = (0, false);
        for level in (0..=left.max(1).ilog2()).rev() {
            let next = State { values: part.step(region, level, &state.values, &held), ..*state };
            let happens = self.has_left_region(&next, asked);
            if happens && level > 0 {
                searched = true;
                continue;
            }
            *state = next;
            taken += 1_u32 << level;
            if happens {
                self.switch(state, asked);
                break;
            }
            if !searched {
                break;
            }
        }
        (taken, searched)
    }

    /// Returns the constant inputs of a step.
    fn held(&self, state: &State, asked: f64) -> Held {
        let Equations { spring: [of_motor, of_load], half_gap, .. } = self.equations;
        let flank = half_gap * state.contact.side();
        let ([motor, load], [of_its, of_loads]) = (self.bodies, state.grips);
        SVector::from([asked, motor.held(of_its) + of_motor * flank, load.held(of_loads) - of_load * flank])
    }

    /// Returns the acceleration of each body without its dry friction.
    fn accelerations(&self, state: &State, asked: f64) -> [f64; 2] {
        let Equations { spring, damping, half_gap, .. } = self.equations;
        let twist = self.twist(state) - half_gap * state.contact.side();
        let rate = state.values[MOTOR] - state.values[LOAD];
        let transmits = if state.contact == Contact::Open { 0.0 } else { 1.0 };
        let [motor, load] = self.bodies;
        [
            motor.weight + self.drive(state, asked) - transmits * (spring[0] * twist + damping[0] * rate),
            load.weight + transmits * (spring[1] * twist + damping[1] * rate),
        ]
    }

    /// Returns true if a state has left its region.
    fn has_left_region(&self, state: &State, asked: f64) -> bool {
        let (twist, half_gap) = (self.twist(state), self.equations.half_gap);
        let parts = match state.contact {
            Contact::Always => false,
            Contact::Open => twist.abs() > half_gap,
            Contact::Ahead => twist < half_gap,
            Contact::Behind => twist > -half_gap,
        };
        let ([motor, load], pulls) = (self.bodies, self.accelerations(state, asked));
        parts
            || motor.leaves(state.grips[0], state.values[MOTOR], pulls[0])
            || load.leaves(state.grips[1], state.values[LOAD], pulls[1])
    }

    /// Changes to the region of a state.
    fn switch(&self, state: &mut State, asked: f64) {
        if state.contact != Contact::Always {
            state.contact = Contact::of(self.twist(state), self.equations.half_gap);
        }
        let [motor, load] = self.bodies;
        if state.grips[0] == FrictionState::Sticks || state.grips[0].reverses(state.values[MOTOR]) {
            state.values[MOTOR] = 0.0;
            state.grips[0] = motor.grip_against(self.accelerations(state, asked)[0]);
        }
        if state.grips[1] == FrictionState::Sticks || state.grips[1].reverses(state.values[LOAD]) {
            state.values[LOAD] = 0.0;
            state.grips[1] = load.grip_against(self.accelerations(state, asked)[1]);
        }
    }

    /// Returns the acceleration of the motor by the stage (rad/s^2).
    pub(super) fn drive(&self, state: &State, asked: f64) -> f64 {
        let Equations { lag_s, drag, .. } = self.equations;
        if lag_s > 0.0 { state.values[DRIVE] } else { asked - drag * state.values[MOTOR] }
    }

    /// Returns the inertia that the stage turns (kg m^2).
    pub(super) fn inertia(&self) -> f64 {
        self.equations.inertia
    }

    /// Returns the angle of the motor relative to the load (rad).
    pub(super) fn twist(&self, state: &State) -> f64 {
        state.values[TWIST] / self.equations.pace
    }

    /// Returns the velocity of the motor (rad/s).
    pub(super) fn velocity(&self, state: &State) -> f64 {
        state.values[MOTOR]
    }
}

#[cfg(test)]
mod tests;
