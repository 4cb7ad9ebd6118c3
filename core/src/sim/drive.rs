//! A simulated drive: the CiA 402 state machine over a model of its motion.

use std::collections::VecDeque;

use super::motor::{FASTEST, Travel, TwoSpeed, Valve, VelocityLag};
use super::{Model, SecondOrder};
use crate::drive::{DriveInput, DriveOutput, DriveState, MODE_CSV, MODE_VELOCITY, control};

#[derive(Clone, Debug)]
enum Motion {
    Ideal,
    SecondOrder {
        law: SecondOrder,
        state: super::second_order::State,
        acceleration: f64,
    },
    Velocity(VelocityLag),
    TwoSpeed(TwoSpeed),
    Valve {
        law: Valve,
        /// Setpoints in their dead time, oldest first; always as many.
        on_the_way: VecDeque<f64>,
    },
}

impl Motion {
    /// Turns it against its setpoint?
    fn is_inverted(&self) -> bool {
        match self {
            Motion::Ideal | Motion::SecondOrder { .. } => false,
            Motion::Velocity(law) => law.inverted,
            Motion::TwoSpeed(law) => law.inverted,
            Motion::Valve { law, .. } => law.inverted,
        }
    }

    /// Takes it velocities, whatever the mode?
    fn has_velocity_only(&self) -> bool {
        matches!(self, Motion::Velocity(_) | Motion::TwoSpeed(_) | Motion::Valve { .. })
    }
}

/// One simulated drive.
#[derive(Clone, Debug)]
pub struct SimDrive {
    motion: Motion,
    /// Outputs on their way, oldest first; one for each cycle of the delay and one more.
    on_the_way: VecDeque<DriveOutput>,
    delay: u32,
    state: DriveState,
    count: i64,
    travel: Travel,
    velocity: f64,
    epoch: u32,
    fault: u16,
    online: bool,
    pending_jump: i64,
    last_control: u16,
    mode: i8,
    cycle_ns: u64,
}

impl SimDrive {
    /// A drive that is powered, online and off.
    pub fn new(model: Model, delay: u32, cycle_ns: u64) -> Self {
        let motion = match model {
            Model::Ideal => Motion::Ideal,
            Model::SecondOrder(law) => Motion::SecondOrder { law, state: Default::default(), acceleration: 0.0 },
            Model::Velocity(law) => Motion::Velocity(law),
            Model::TwoSpeed(law) => Motion::TwoSpeed(law),
            Model::Valve(law) => {
                // Room for one more, which stands there for the length of a step.
                let mut on_the_way = VecDeque::with_capacity(law.on_the_way() + 1);
                on_the_way.resize(law.on_the_way(), 0.0);
                Motion::Valve { law, on_the_way }
            }
        };
        let mut on_the_way = VecDeque::with_capacity(delay as usize + 2);
        on_the_way.resize(delay as usize + 1, DriveOutput::default());
        Self {
            motion,
            on_the_way,
            delay,
            state: DriveState::NotReady,
            count: 0,
            travel: Travel::default(),
            velocity: 0.0,
            epoch: 0,
            fault: 0,
            online: true,
            pending_jump: 0,
            last_control: 0,
            mode: 0,
            cycle_ns,
        }
    }

    /// Delay of the drive in cycles.
    pub fn delay(&self) -> u32 {
        self.delay
    }

    /// Puts the drive into fault with a code of object 603Fh.
    pub fn inject_fault(&mut self, code: u16) {
        self.fault = code;
        self.state = DriveState::FaultReaction;
    }

    /// Takes the drive off the bus for good.
    pub fn lose(&mut self) {
        self.online = false;
    }

    /// Lets its encoder read `by` more counts from the next inputs on, as after a slip; switched on, it works that off.
    pub fn jump(&mut self, by: i64) {
        self.pending_jump = self.pending_jump.wrapping_add(by);
    }

    /// What it tells now, after it has done what reached it.
    pub(super) fn read(&mut self) -> DriveInput {
        if let Some(output) = self.on_the_way.pop_front() {
            self.obey(output);
        }
        let jump = std::mem::take(&mut self.pending_jump);
        self.count = self.count.wrapping_add(jump);
        if let Motion::SecondOrder { state, .. } = &mut self.motion {
            state.shift(jump);
        }
        DriveInput {
            count: self.count,
            epoch: self.epoch,
            velocity: self.velocity,
            effort: 0.0,
            status: self.state.status(),
            mode: self.mode,
            fault: self.fault,
            online: self.online,
            fresh: self.online,
        }
    }

    pub(super) fn write(&mut self, output: DriveOutput) {
        self.on_the_way.push_back(output);
    }

    fn obey(&mut self, output: DriveOutput) {
        self.mode = output.mode;
        self.change_state(output.control);
        self.last_control = output.control;
        let is_on = self.state == DriveState::Enabled;
        if self.motion.has_velocity_only() || matches!(output.mode, MODE_CSV | MODE_VELOCITY) {
            // Without its voltage a motor is asked for nothing, and runs down.
            let asked = if is_on && output.velocity.is_finite() { output.velocity } else { 0.0 };
            let asked = if self.motion.is_inverted() { 0.0 - asked } else { asked };
            self.run_at(asked.clamp(-FASTEST, FASTEST));
        } else if is_on {
            self.move_to(output.position);
        } else {
            self.velocity = 0.0;
            if let Motion::SecondOrder { state, .. } = &mut self.motion {
                state.rest_at(self.count);
            }
        }
    }

    fn move_to(&mut self, position: i64) {
        match &mut self.motion {
            Motion::SecondOrder { law, state, .. } => {
                law.step(state, position);
                self.count = state.position();
                self.velocity = state.velocity();
            }
            _ => {
                self.velocity = position.wrapping_sub(self.count) as f64 / (self.cycle_ns as f64 / 1e9);
                self.count = position;
            }
        }
    }

    /// One cycle towards a velocity (inc/s).
    fn run_at(&mut self, setpoint: f64) {
        let velocity = &mut self.velocity;
        let mean = match &mut self.motion {
            Motion::Ideal => {
                *velocity = setpoint;
                setpoint
            }
            Motion::SecondOrder { law, acceleration, .. } => law.step_velocity(velocity, acceleration, setpoint),
            Motion::Velocity(law) => law.step(velocity, setpoint),
            Motion::TwoSpeed(law) => law.step(velocity, setpoint),
            Motion::Valve { law, on_the_way } => {
                on_the_way.push_back(setpoint);
                on_the_way.pop_front();
                let old = on_the_way.front().copied().unwrap_or(setpoint);
                let new = on_the_way.get(1).copied().unwrap_or(setpoint);
                law.step(velocity, old, new)
            }
        };
        self.count = self.count.wrapping_add(self.travel.advance(mean, self.cycle_ns));
    }

    fn change_state(&mut self, word: u16) {
        use DriveState::*;
        let rises = |bit: u16| word & bit != 0 && self.last_control & bit == 0;
        self.state = match self.state {
            NotReady => SwitchOnDisabled,
            FaultReaction => Fault,
            Fault if rises(control::FAULT_RESET) => {
                self.fault = 0;
                SwitchOnDisabled
            }
            Fault => Fault,
            // Bit 1 off: no voltage.
            _ if word & 0x02 == 0 => SwitchOnDisabled,
            // Bit 2 off: quick stop.
            Enabled | QuickStop if word & 0x04 == 0 => QuickStop,
            _ if word & 0x04 == 0 => SwitchOnDisabled,
            QuickStop => QuickStop,
            _ if word & 0x01 == 0 => Ready,
            Ready if word & 0x08 == 0 => SwitchedOn,
            Ready | SwitchedOn | Enabled if word & 0x08 != 0 => match self.state {
                Ready => SwitchedOn,
                _ => Enabled,
            },
            SwitchedOn | Enabled => SwitchedOn,
            other => other,
        };
    }
}
