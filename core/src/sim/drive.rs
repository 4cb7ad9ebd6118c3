//! Simulated drive: the CiA 402 state machine with a model of its motion.

use std::collections::VecDeque;

use super::analog::Analog;
use super::driven::ScenarioCount;
use super::homing::{DriveHoming, Track};
use super::mechanics::Brake;
use super::motor::{CountAccumulator, Lag, MAX_VELOCITY, TwoSpeed, Valve, VelocityLag};
use super::plant::Servo;
use super::word::Word;
use super::{Fixtures, Mechanics, Model, SecondOrder, SignOutputs, age};
use crate::drive::{
    BusState, Capabilities, DriveInput, DriveOutput, DriveState, Emergency, HomingOrder, MODE_HOMING, Mode, Outputs,
    STATUS_HOMING_ATTAINED, STATUS_HOMING_ERROR, STATUS_TARGET_REACHED, control,
};
use crate::encoder::Form;

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
        /// Setpoints in their dead time, oldest first; their number is constant.
        on_the_way: VecDeque<f64>,
    },
    Servo(Box<Servo>),
}

impl Motion {
    /// Returns true if it turns against its setpoint.
    fn is_inverted(&self) -> bool {
        match self {
            Motion::Ideal | Motion::SecondOrder { .. } => false,
            Motion::Velocity(law) => law.inverted,
            Motion::TwoSpeed(law) => law.inverted,
            Motion::Valve { law, .. } => law.inverted,
            Motion::Servo(servo) => servo.is_inverted(),
        }
    }

    /// Returns the decay of its velocity without power, if the model defines it.
    fn coast(&self) -> Option<Lag> {
        match self {
            Motion::SecondOrder { law, .. } => law.coast(),
            _ => None,
        }
    }

    /// Returns true if its setpoint is a velocity in every mode.
    fn has_velocity_only(&self) -> bool {
        matches!(self, Motion::Velocity(_) | Motion::TwoSpeed(_) | Motion::Valve { .. })
    }
}

/// One simulated drive.
#[derive(Clone, Debug)]
pub struct SimDrive {
    motion: Motion,
    /// Delayed outputs, oldest first; one for each cycle of the delay and one more.
    on_the_way: VecDeque<DriveOutput>,
    capabilities: Capabilities,
    emergency: Option<Emergency>,
    state: DriveState,
    count: i64,
    /// Reading of its encoder in the previous cycle, with its noise.
    told: i64,
    travel: CountAccumulator,
    velocity: f64,
    epoch: u32,
    fault: u16,
    online: bool,
    pending_jump: i64,
    word: Word,
    fixtures: Fixtures,
    /// Position of count 0.
    origin: i64,
    /// Position in the last cycle.
    place: i64,
    /// Position in the cycle before.
    place_before: i64,
    /// Counts of a scenario that replace its own.
    driven: ScenarioCount,
    /// Homing by the drive itself.
    homing: DriveHoming,
    /// Whether the index gives no more pulses.
    index_lost: bool,
    /// Whether it is jammed: it does not move, whatever its setpoint.
    jammed: bool,
    /// Stuck bits of the digital inputs, and their values.
    stuck: (u32, u32),
    /// Bits of switches that are wired to digital inputs of the cell.
    hidden: u32,
    /// Acceleration of a hanging load without brake and power (counts/s^2).
    load: f64,
    brake: Option<Brake>,
    sign: Option<SignOutputs>,
    /// Voltage interface, if it has one.
    analog: Option<Analog>,
    last_control: u16,
    mode: i8,
    cycle_ns: u64,
}

impl SimDrive {
    /// Creates a drive that is supplied with power, online and off.
    pub fn new(model: Model, delay: u32, cycle_ns: u64) -> Self {
        let motion = match model {
            Model::Ideal => Motion::Ideal,
            Model::SecondOrder(law) => Motion::SecondOrder { law, state: Default::default(), acceleration: 0.0 },
            Model::Velocity(law) => Motion::Velocity(law),
            Model::TwoSpeed(law) => Motion::TwoSpeed(law),
            Model::Valve(law) => {
                // Room for one more setpoint during a step.
                let mut on_the_way = VecDeque::with_capacity(law.delayed_setpoints() + 1);
                on_the_way.resize(law.delayed_setpoints(), 0.0);
                Motion::Valve { law, on_the_way }
            }
            Model::Motor(law) => Motion::Servo(Box::new(Servo::new(law, cycle_ns))),
        };
        let mut on_the_way = VecDeque::with_capacity(delay as usize + 2);
        on_the_way.resize(delay as usize + 1, DriveOutput::default());
        Self {
            motion,
            on_the_way,
            capabilities: model.capabilities(delay),
            emergency: None,
            state: DriveState::NotReady,
            count: 0,
            told: 0,
            travel: CountAccumulator::default(),
            velocity: 0.0,
            epoch: 0,
            fault: 0,
            online: true,
            pending_jump: 0,
            word: Word::default(),
            fixtures: Fixtures::default(),
            origin: 0,
            place: 0,
            place_before: 0,
            driven: ScenarioCount::default(),
            homing: DriveHoming::default(),
            index_lost: false,
            jammed: false,
            stuck: (0, 0),
            hidden: 0,
            load: 0.0,
            brake: None,
            sign: None,
            analog: None,
            last_control: 0,
            mode: 0,
            cycle_ns,
        }
    }

    /// Returns the drive with other capabilities.
    #[must_use]
    pub fn offering(self, capabilities: Capabilities) -> Self {
        Self { capabilities, ..self }
    }

    /// Returns the capabilities.
    pub fn capabilities(&self) -> Capabilities {
        self.capabilities
    }

    /// Sends an emergency message with the next inputs.
    pub fn send_emergency(&mut self, emergency: Emergency) {
        self.emergency = Some(emergency);
    }

    /// Sets the form of the process data of its encoder.
    pub fn set_encoder_form(&mut self, form: Form) {
        self.word = Word::new(form);
    }

    /// Inverts bits of the next `words` readings of its encoder.
    pub fn invert_bits(&mut self, bits: i64, words: u32) {
        self.word.disturb(bits, words);
    }

    /// Sets the factor of the counts of its encoder: 0 for a dead one, -1 for swapped tracks.
    pub fn set_count_factor(&mut self, factor: i64) {
        self.word.count_by(factor);
    }

    /// Cuts the line of its encoder permanently: an absolute encoder sends no more data; for an incremental one the
    /// drive reports a fault of its encoder (7305h).
    pub fn cut_encoder(&mut self) {
        if self.word.is_absolute() { self.word.cut() } else { self.inject_fault(0x7305) }
    }

    /// Returns the position of its axis (inc), from the counts of a scenario if there are any.
    pub(super) fn place(&self) -> i64 {
        self.driven.travel().map_or(self.place, |(_, to)| to.wrapping_add(self.driven.origin()))
    }

    /// Sets the counts of the next cycle, in the form of its process data.
    pub(super) fn replace_count(&mut self, raw: i64) {
        self.driven.give(raw);
    }

    /// Returns true if its position has changed in this cycle without motion.
    pub(super) fn has_jumped(&self) -> bool {
        self.driven.has_jumped()
    }

    /// Returns the position that turns an encoder of the axis (inc).
    pub(super) fn encoder_position(&self) -> i64 {
        match &self.motion {
            Motion::Servo(servo) if servo.reads_load() => self.place.wrapping_add(servo.load()),
            _ => self.place,
        }
    }

    /// Returns the position of its load, independently of any encoder (inc of the motor).
    #[cfg(test)]
    pub(crate) fn load_place(&self) -> i64 {
        match &self.motion {
            Motion::Servo(servo) => self.place.wrapping_add(servo.load()),
            _ => self.place,
        }
    }

    /// Installs switches and an index, and sets the start position of the axis: its counts are 0 there.
    pub fn install_fixtures(&mut self, fixtures: Fixtures) {
        self.origin = fixtures.start.wrapping_sub(self.count);
        (self.place, self.place_before) = (fixtures.start, fixtures.start);
        self.fixtures = fixtures;
    }

    /// Restarts its counts at the present position, as after power-on.
    pub fn restart_counts(&mut self) {
        self.origin = self.origin.wrapping_add(self.count);
        let moved = self.count;
        self.count = 0;
        self.told = self.told.wrapping_sub(moved);
        self.epoch = self.epoch.wrapping_add(1);
        if let Motion::SecondOrder { state, .. } = &mut self.motion {
            state.shift(moved.wrapping_neg());
        }
    }

    /// Stops the pulses of its index.
    pub fn lose_index(&mut self) {
        self.index_lost = true;
    }

    /// Restores the pulses of its index.
    pub fn restore_index(&mut self) {
        self.index_lost = false;
    }

    /// Makes digital inputs (60FDh) stuck: those of `mask` read as in `value`.
    pub fn set_stuck_inputs(&mut self, mask: u32, value: u32) {
        self.stuck = (mask, value & mask);
    }

    /// Attaches a load, a brake and wiring. Switches that are wired to digital inputs of the cell do not read at the
    /// drive.
    pub(super) fn attach_mechanics(&mut self, mechanics: &Mechanics) {
        self.hidden = mechanics.wired();
        self.load = mechanics.load;
        self.brake = mechanics.brake.map(Brake::new);
        self.sign = mechanics.sign;
        if let Motion::Servo(servo) = &mut self.motion {
            servo.attach_weight(mechanics.load);
        }
    }

    /// Sets its voltage interface, if any.
    pub(super) fn set_analog(&mut self, analog: Option<Analog>) {
        self.analog = analog;
    }

    pub(super) fn analog(&self) -> Option<&Analog> {
        self.analog.as_ref()
    }

    /// Returns the state of its ready contact.
    pub(super) fn is_ready(&self) -> bool {
        self.online && !matches!(self.state, DriveState::Fault | DriveState::FaultReaction)
    }

    /// Returns its actuated switches (bits of 60FDh), however they are wired.
    pub(super) fn actuated(&self) -> u32 {
        let (mask, value) = self.stuck;
        self.fixtures.inputs(self.place) & !mask | value
    }

    /// Returns the edges of a switch (a bit of those inputs) in this cycle, in their order: their age (ns), and whether
    /// the switch is actuated afterwards.
    pub(super) fn switched(&self, switch: u32) -> [Option<(u32, bool)>; 2] {
        if self.stuck.0 & switch != 0 {
            return [None; 2];
        }
        // A position beyond the range of machines is not at a switch.
        let way = self.place.saturating_sub(self.place_before) as f64;
        self.fixtures.edges_passed(switch, self.place_before, self.place).map(|edge| {
            let (place, is_on) = edge?;
            let share = self.place.saturating_sub(place) as f64 / way;
            Some((age(share, self.cycle_ns), is_on))
        })
    }

    /// Jams or releases the axis.
    pub fn jam(&mut self, jammed: bool) {
        self.jammed = jammed;
    }

    /// Puts the drive into fault with a code of object 603Fh.
    pub fn inject_fault(&mut self, code: u16) {
        self.fault = code;
        self.state = DriveState::FaultReaction;
    }

    /// Takes the drive off the bus until it is [found](Self::reconnect).
    pub fn disconnect(&mut self) {
        self.online = false;
    }

    /// Reconnects a lost drive.
    pub fn reconnect(&mut self) {
        self.online = true;
    }

    /// Adds `by` counts to the reading of its encoder from the next inputs on, as after a slip; an enabled drive then
    /// corrects the difference.
    pub fn jump(&mut self, by: i64) {
        self.pending_jump = self.pending_jump.wrapping_add(by);
    }

    /// Executes the outputs that arrive now, and returns its inputs.
    pub(super) fn read(&mut self) -> DriveInput {
        if let Some(output) = self.on_the_way.pop_front() {
            self.obey(output);
        }
        let jump = std::mem::take(&mut self.pending_jump);
        self.count = self.count.wrapping_add(jump);
        self.origin = self.origin.wrapping_sub(jump);
        if let Motion::SecondOrder { state, .. } = &mut self.motion {
            state.shift(jump);
        }
        let before = std::mem::replace(&mut self.place, self.count.wrapping_add(self.origin));
        self.place_before = before;
        self.driven.step(&self.word, self.origin);
        let (from, to, origin) = match (self.driven.travel(), self.driven.origin()) {
            (Some((from, to)), origin) => (from.wrapping_add(origin), to.wrapping_add(origin), origin),
            (None, _) => (before, self.place, self.origin),
        };
        let passed = self.fixtures.index_passed(from, to).filter(|_| !self.index_lost);
        let (noise, effort) = self.measure();
        DriveInput {
            count: self.word.next_word(self.count.wrapping_add(noise)),
            epoch: self.epoch,
            velocity: self.velocity,
            effort,
            status: self.state.status() | self.homing_status(),
            mode: self.mode,
            fault: self.fault,
            online: self.online,
            fresh: self.online,
            bus: BusState::Active,
            emergency: self.emergency.take().filter(|_| self.online),
            inputs: self.actuated() & !self.hidden,
            index: passed.map(|place| self.word.of(place.wrapping_sub(origin))),
            unacknowledged: false,
        }
    }

    /// Returns the error of the encoder reading of a motor, and its torque (per mille). The velocity is the change of
    /// the counts over the cycle, as in a real drive; during homing of the drive it is that of homing.
    fn measure(&mut self) -> (i64, f64) {
        let Motion::Servo(servo) = &mut self.motion else { return (0, 0.0) };
        let noise = servo.read();
        let told = self.count.wrapping_add(noise);
        let change = told.wrapping_sub(std::mem::replace(&mut self.told, told));
        if self.mode != MODE_HOMING {
            self.velocity = change as f64 / (self.cycle_ns as f64 / 1e9);
        }
        (noise, if servo.is_inverted() { 0.0 - servo.effort() } else { servo.effort() })
    }

    pub(super) fn write(&mut self, output: DriveOutput) {
        self.on_the_way.push_back(output);
    }

    /// Returns bits 10, 12 and 13 in mode homing.
    fn homing_status(&self) -> u16 {
        let DriveHoming { runs, attained, failed, .. } = self.homing;
        let bit = |on: bool, bit: u16| if on && self.mode == MODE_HOMING { bit } else { 0 };
        bit(attained, STATUS_HOMING_ATTAINED) | bit(failed, STATUS_HOMING_ERROR) | bit(!runs, STATUS_TARGET_REACHED)
    }

    /// Executes one cycle of homing by the drive.
    fn home(&mut self, order: HomingOrder, starts: bool) {
        if starts {
            self.homing = DriveHoming::start(order.method);
        }
        self.velocity = 0.0;
        if !self.homing.runs {
            return;
        }
        let start = self.count.wrapping_add(self.origin);
        let cycle_s = self.cycle_ns as f64 / 1e9;
        let way = Track { fixtures: self.fixtures, has_index: !self.index_lost, stuck: self.stuck };
        let steps = [order.search_velocity, order.zero_velocity].map(|velocity| velocity * cycle_s);
        let (place, reference) = self.homing.step(start, steps, &way);
        self.velocity = place.wrapping_sub(start) as f64 / cycle_s;
        if let Some(reference) = reference {
            self.origin = reference;
            self.epoch = self.epoch.wrapping_add(1);
            self.velocity = 0.0;
        }
        self.count = place.wrapping_sub(self.origin);
        match &mut self.motion {
            Motion::SecondOrder { state, .. } => state.rest_at(self.count),
            Motion::Servo(servo) => servo.rest(),
            _ => {}
        }
    }

    /// Applies the digital outputs of the cell, which control its brake and the sign of its reference.
    pub(super) fn wired_to(&mut self, output: DriveOutput, all: &Outputs) -> DriveOutput {
        if let Some(brake) = &mut self.brake {
            brake.step(all, self.cycle_ns);
        }
        let output = self.analog.as_ref().map_or(output, |analog| analog.output(all, self.online));
        let velocity = self.sign.map_or(output.velocity, |sign| sign.of(output.velocity, all));
        DriveOutput { velocity, ..output }
    }

    fn obey(&mut self, output: DriveOutput) {
        self.mode = output.mode.number();
        let starts = output.control & control::START_HOMING != 0 && self.last_control & control::START_HOMING == 0;
        let before = self.state;
        self.state = match self.analog {
            Some(_) => Analog::next(before, output.control),
            None => before.next(output.control, self.last_control),
        };
        if before == DriveState::Fault && self.state != DriveState::Fault {
            self.fault = 0;
        }
        self.last_control = output.control;
        let is_on = self.state == DriveState::Enabled;
        self.homing.runs &= matches!(output.mode, Mode::Homing(_)) && is_on;
        let is_held = self.jammed || self.brake.is_some_and(|brake| brake.closed);
        let homes = is_on && matches!(output.mode, Mode::Homing(_));
        if matches!(self.motion, Motion::Servo(_)) && !homes {
            self.run_motor(output, is_held);
        } else if is_held {
            self.stand();
        } else if !is_on && self.state != DriveState::QuickStop && self.load != 0.0 {
            self.run_free_fall();
        } else if is_on && let Mode::Homing(order) = output.mode {
            self.home(order, starts);
        } else if !is_on
            && self.state != DriveState::QuickStop
            && let Some(lag) = self.motion.coast()
        {
            self.coast(lag);
        } else if self.motion.has_velocity_only() || matches!(output.mode, Mode::Velocity | Mode::Speed) {
            // Without its voltage a motor has no setpoint, and coasts.
            let asked = if is_on && output.velocity.is_finite() { output.velocity } else { 0.0 };
            let asked = if self.motion.is_inverted() { 0.0 - asked } else { asked };
            self.run_at(asked.clamp(-MAX_VELOCITY, MAX_VELOCITY));
        } else if is_on {
            self.move_to(output.position);
        } else {
            self.stand();
        }
    }

    fn stand(&mut self) {
        self.velocity = 0.0;
        self.rest_here();
    }

    /// Lets the load fall freely for one cycle.
    fn run_free_fall(&mut self) {
        let cycle_s = self.cycle_ns as f64 / 1e9;
        let mean = self.velocity + self.load * cycle_s / 2.0;
        self.velocity = (self.velocity + self.load * cycle_s).clamp(-MAX_VELOCITY, MAX_VELOCITY);
        self.count =
            self.count.wrapping_add(self.travel.advance(mean.clamp(-MAX_VELOCITY, MAX_VELOCITY), self.cycle_ns));
        self.rest_here();
    }

    /// Executes one cycle without power, with braking by friction.
    fn coast(&mut self, lag: Lag) {
        let mean = lag.cycle(&mut self.velocity, 0.0);
        self.count = self.count.wrapping_add(self.travel.advance(mean, self.cycle_ns));
        self.rest_here();
    }

    /// Starts a controller from the present state.
    fn rest_here(&mut self) {
        match &mut self.motion {
            Motion::SecondOrder { state, acceleration, .. } => {
                state.rest_at(self.count);
                *acceleration = 0.0;
            }
            Motion::Servo(servo) => servo.rest(),
            _ => {}
        }
    }

    /// Executes one cycle of a motor: with a torque, with a velocity, or without current; quick stop brakes with its
    /// own loop.
    fn run_motor(&mut self, output: DriveOutput, is_held: bool) {
        let Motion::Servo(servo) = &mut self.motion else { return };
        let sense = if servo.is_inverted() { -1.0 } else { 1.0 };
        let velocity = match (self.state, output.mode) {
            (DriveState::QuickStop, _) => Some(0.0),
            (DriveState::Enabled, Mode::Velocity | Mode::Speed) => Some(sense * output.velocity),
            _ => None,
        };
        let setpoint = match (velocity, self.state, output.mode) {
            (Some(velocity), ..) => servo.velocity_setpoint(velocity),
            (None, DriveState::Enabled, Mode::Torque | Mode::Voltage) => sense * output.effort / 1000.0,
            _ => 0.0,
        };
        if velocity.is_none() || is_held {
            servo.reset_loop();
        }
        self.count = self.count.wrapping_add(servo.step(setpoint, is_held));
    }

    fn move_to(&mut self, word: i64) {
        let position = self.word.count_near(self.count, word);
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

    /// Executes one cycle towards a velocity (inc/s).
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
            // A motor is turned by its torque.
            Motion::Servo(_) => return,
        };
        self.count = self.count.wrapping_add(self.travel.advance(mean, self.cycle_ns));
    }
}
