//! A simulated drive: the CiA 402 state machine over a model of its motion.

use std::collections::VecDeque;

use super::analog::Analog;
use super::driven::DrivenCount;
use super::homing::{InDrive, Way};
use super::mechanics::Brake;
use super::motor::{FASTEST, Lag, Travel, TwoSpeed, Valve, VelocityLag};
use super::plant::Servo;
use super::word::Word;
use super::{Fixtures, Mechanics, Model, SecondOrder, Sign, age};
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
        /// Setpoints in their dead time, oldest first; always as many.
        on_the_way: VecDeque<f64>,
    },
    Servo(Box<Servo>),
}

impl Motion {
    /// Turns it against its setpoint?
    fn is_inverted(&self) -> bool {
        match self {
            Motion::Ideal | Motion::SecondOrder { .. } => false,
            Motion::Velocity(law) => law.inverted,
            Motion::TwoSpeed(law) => law.inverted,
            Motion::Valve { law, .. } => law.inverted,
            Motion::Servo(servo) => servo.is_inverted(),
        }
    }

    /// How its velocity decays without power, if its model says so.
    fn coast(&self) -> Option<Lag> {
        match self {
            Motion::SecondOrder { law, .. } => law.coast(),
            _ => None,
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
    capabilities: Capabilities,
    emergency: Option<Emergency>,
    state: DriveState,
    count: i64,
    /// What its encoder has read in the cycle before, with its noise.
    told: i64,
    travel: Travel,
    velocity: f64,
    epoch: u32,
    fault: u16,
    online: bool,
    pending_jump: i64,
    word: Word,
    fixtures: Fixtures,
    /// Place of count 0.
    origin: i64,
    /// Place of the last cycle.
    place: i64,
    /// Place of the cycle before.
    place_before: i64,
    /// Counts of a scenario in the place of its own.
    driven: DrivenCount,
    /// Homing of its own.
    homing: InDrive,
    /// The index gives no pulses any more.
    index_lost: bool,
    /// Something holds it: it does not move, whatever it is asked for.
    jammed: bool,
    /// Bits of the digital inputs that are stuck, and how.
    stuck: (u32, u32),
    /// Bits of switches that are wired to somewhere else.
    hidden: u32,
    /// What a hanging load does when nothing holds it (counts/s^2).
    load: f64,
    brake: Option<Brake>,
    sign: Option<Sign>,
    /// It is given a voltage.
    analog: Option<Analog>,
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
            travel: Travel::default(),
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
            driven: DrivenCount::default(),
            homing: InDrive::default(),
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

    /// The same in the place of a drive that offers other things.
    #[must_use]
    pub fn offering(self, capabilities: Capabilities) -> Self {
        Self { capabilities, ..self }
    }

    /// What it offers.
    pub fn capabilities(&self) -> Capabilities {
        self.capabilities
    }

    /// Sends an emergency message with the next inputs.
    pub fn send_emergency(&mut self, emergency: Emergency) {
        self.emergency = Some(emergency);
    }

    /// Lets its encoder tell words of that form.
    pub fn speak(&mut self, form: Form) {
        self.word = Word::new(form);
    }

    /// Turns bits of the next `words` words of its encoder over.
    pub fn disturb(&mut self, bits: i64, words: u32) {
        self.word.disturb(bits, words);
    }

    /// Lets its encoder tell so many counts for each from now on: 0 where it is dead, -1 where its tracks are swapped.
    pub fn count_by(&mut self, factor: i64) {
        self.word.count_by(factor);
    }

    /// Cuts the line of its encoder for good: an absolute one has no words any more; of an incremental one the drive tells it, as
    /// a fault of its encoder (7305h).
    pub fn cut_encoder(&mut self) {
        if self.word.is_absolute() { self.word.cut() } else { self.inject_fault(0x7305) }
    }

    /// Where its axis stands (inc), by the counts of a scenario where there are any.
    pub(super) fn place(&self) -> i64 {
        self.driven.way().map_or(self.place, |(_, to)| to.wrapping_add(self.driven.origin()))
    }

    /// Gives the counts of the next cycle, as it would tell them.
    pub(super) fn replace_count(&mut self, raw: i64) {
        self.driven.give(raw);
    }

    /// Whether it stands somewhere else in this cycle without having moved.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.driven.is_elsewhere()
    }

    /// Where that stands which turns an encoder of the axis (inc).
    pub(super) fn turned(&self) -> i64 {
        match &self.motion {
            Motion::Servo(servo) if servo.reads_load() => self.place.wrapping_add(servo.load()),
            _ => self.place,
        }
    }

    /// Where its load stands, whatever an encoder reads (inc of the motor).
    #[cfg(test)]
    pub(crate) fn load_place(&self) -> i64 {
        match &self.motion {
            Motion::Servo(servo) => self.place.wrapping_add(servo.load()),
            _ => self.place,
        }
    }

    /// Puts switches and an index along its way, and the axis to its start: its counts are 0 there.
    pub fn fit(&mut self, fixtures: Fixtures) {
        self.origin = fixtures.start.wrapping_sub(self.count);
        (self.place, self.place_before) = (fixtures.start, fixtures.start);
        self.fixtures = fixtures;
    }

    /// Lets its counts begin anew where it stands, as after its power came back.
    pub fn renew_counts(&mut self) {
        self.origin = self.origin.wrapping_add(self.count);
        let moved = self.count;
        self.count = 0;
        self.told = self.told.wrapping_sub(moved);
        self.epoch = self.epoch.wrapping_add(1);
        if let Motion::SecondOrder { state, .. } = &mut self.motion {
            state.shift(moved.wrapping_neg());
        }
    }

    /// Lets its index give no pulses any more.
    pub fn lose_index(&mut self) {
        self.index_lost = true;
    }

    /// Lets a lost index give its pulses again.
    pub fn find_index(&mut self) {
        self.index_lost = false;
    }

    /// Lets digital inputs (60FDh) be stuck: those of `mask` read as in `value`.
    pub fn stick(&mut self, mask: u32, value: u32) {
        self.stuck = (mask, value & mask);
    }

    /// Hangs a load, a brake and wires on it. Switches that are wired to somewhere else do not read at the drive.
    pub(super) fn hang(&mut self, mechanics: &Mechanics) {
        self.hidden = mechanics.wired();
        self.load = mechanics.load;
        self.brake = mechanics.brake.map(Brake::new);
        self.sign = mechanics.sign;
        if let Motion::Servo(servo) = &mut self.motion {
            servo.hang(mechanics.load);
        }
    }

    /// Wires it to a voltage, if there is one.
    pub(super) fn wire(&mut self, analog: Option<Analog>) {
        self.analog = analog;
    }

    pub(super) fn analog(&self) -> Option<&Analog> {
        self.analog.as_ref()
    }

    /// Does its contact tell that it may be enabled?
    pub(super) fn is_ready(&self) -> bool {
        self.online && !matches!(self.state, DriveState::Fault | DriveState::FaultReaction)
    }

    /// The switches along its way (bits of 60FDh), wherever they are wired to.
    pub(super) fn actuated(&self) -> u32 {
        let (mask, value) = self.stuck;
        self.fixtures.inputs(self.place) & !mask | value
    }

    /// What a switch, a bit of those inputs, has done on the way of this cycle, in its order: how long ago (ns), and whether it is
    /// actuated since then.
    pub(super) fn switched(&self, switch: u32) -> [Option<(u32, bool)>; 2] {
        if self.stuck.0 & switch != 0 {
            return [None; 2];
        }
        // Places beyond all machines are none that a switch stands at.
        let way = self.place.saturating_sub(self.place_before) as f64;
        self.fixtures.edges_passed(switch, self.place_before, self.place).map(|edge| {
            let (place, is_on) = edge?;
            let share = self.place.saturating_sub(place) as f64 / way;
            Some((age(share, self.cycle_ns), is_on))
        })
    }

    /// Lets something hold it where it stands, or lets it go.
    pub fn jam(&mut self, jammed: bool) {
        self.jammed = jammed;
    }

    /// Puts the drive into fault with a code of object 603Fh.
    pub fn inject_fault(&mut self, code: u16) {
        self.fault = code;
        self.state = DriveState::FaultReaction;
    }

    /// Takes the drive off the bus until it is [found](Self::find).
    pub fn lose(&mut self) {
        self.online = false;
    }

    /// Brings a lost drive back.
    pub fn find(&mut self) {
        self.online = true;
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
        self.origin = self.origin.wrapping_sub(jump);
        if let Motion::SecondOrder { state, .. } = &mut self.motion {
            state.shift(jump);
        }
        let before = std::mem::replace(&mut self.place, self.count.wrapping_add(self.origin));
        self.place_before = before;
        self.driven.step(&self.word, self.origin);
        let (from, to, origin) = match (self.driven.way(), self.driven.origin()) {
            (Some((from, to)), origin) => (from.wrapping_add(origin), to.wrapping_add(origin), origin),
            (None, _) => (before, self.place, self.origin),
        };
        let passed = self.fixtures.index_passed(from, to).filter(|_| !self.index_lost);
        let (noise, effort) = self.measure();
        DriveInput {
            count: self.word.tell(self.count.wrapping_add(noise)),
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

    /// What the encoder of a motor reads too much, and its torque (per mille). Its velocity is what its counts have changed by over the
    /// cycle, as a drive knows no other one; where its homing moves it, that of its homing.
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

    /// Bits 10, 12 and 13 in mode homing.
    fn homing_status(&self) -> u16 {
        let InDrive { runs, attained, failed, .. } = self.homing;
        let bit = |on: bool, bit: u16| if on && self.mode == MODE_HOMING { bit } else { 0 };
        bit(attained, STATUS_HOMING_ATTAINED) | bit(failed, STATUS_HOMING_ERROR) | bit(!runs, STATUS_TARGET_REACHED)
    }

    /// One cycle of homing of its own.
    fn home(&mut self, order: HomingOrder, starts: bool) {
        if starts {
            self.homing = InDrive::start(order.method);
        }
        self.velocity = 0.0;
        if !self.homing.runs {
            return;
        }
        let start = self.count.wrapping_add(self.origin);
        let cycle_s = self.cycle_ns as f64 / 1e9;
        let way = Way { fixtures: self.fixtures, has_index: !self.index_lost, stuck: self.stuck };
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

    /// What digital outputs do to it: they work its brake, and tell the sign of its reference.
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
            self.turn(output, is_held);
        } else if is_held {
            self.stand();
        } else if !is_on && self.state != DriveState::QuickStop && self.load != 0.0 {
            self.fall();
        } else if is_on && let Mode::Homing(order) = output.mode {
            self.home(order, starts);
        } else if !is_on
            && self.state != DriveState::QuickStop
            && let Some(lag) = self.motion.coast()
        {
            self.coast(lag);
        } else if self.motion.has_velocity_only() || matches!(output.mode, Mode::Velocity | Mode::Speed) {
            // Without its voltage a motor is asked for nothing, and runs down.
            let asked = if is_on && output.velocity.is_finite() { output.velocity } else { 0.0 };
            let asked = if self.motion.is_inverted() { 0.0 - asked } else { asked };
            self.run_at(asked.clamp(-FASTEST, FASTEST));
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

    /// Nothing holds the load for one cycle.
    fn fall(&mut self) {
        let cycle_s = self.cycle_ns as f64 / 1e9;
        let mean = self.velocity + self.load * cycle_s / 2.0;
        self.velocity = (self.velocity + self.load * cycle_s).clamp(-FASTEST, FASTEST);
        self.count = self.count.wrapping_add(self.travel.advance(mean.clamp(-FASTEST, FASTEST), self.cycle_ns));
        self.rest_here();
    }

    /// One cycle without power, in which friction brakes it.
    fn coast(&mut self, lag: Lag) {
        let mean = lag.cycle(&mut self.velocity, 0.0);
        self.count = self.count.wrapping_add(self.travel.advance(mean, self.cycle_ns));
        self.rest_here();
    }

    /// A regulator that takes over begins here.
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

    /// One cycle of a motor: with a torque, with a velocity, or without current; quick stop brakes it by its own loop.
    fn turn(&mut self, output: DriveOutput, is_held: bool) {
        let Motion::Servo(servo) = &mut self.motion else { return };
        let sense = if servo.is_inverted() { -1.0 } else { 1.0 };
        let velocity = match (self.state, output.mode) {
            (DriveState::QuickStop, _) => Some(0.0),
            (DriveState::Enabled, Mode::Velocity | Mode::Speed) => Some(sense * output.velocity),
            _ => None,
        };
        let setpoint = match (velocity, self.state, output.mode) {
            (Some(velocity), ..) => servo.close(velocity),
            (None, DriveState::Enabled, Mode::Torque | Mode::Voltage) => sense * output.effort / 1000.0,
            _ => 0.0,
        };
        if velocity.is_none() || is_held {
            servo.open();
        }
        self.count = self.count.wrapping_add(servo.step(setpoint, is_held));
    }

    fn move_to(&mut self, word: i64) {
        let position = self.word.near(self.count, word);
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
            // A motor turns by its torque.
            Motion::Servo(_) => return,
        };
        self.count = self.count.wrapping_add(self.travel.advance(mean, self.cycle_ns));
    }
}
