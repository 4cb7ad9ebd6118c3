//! Blocks and modes of the Siemens WF 725 / 726 positioning modules.
//!
//! Law      START fixes the ends of all blocks, from the previous end: P + NV + WK + preset (G90), or previous end + P
//!          (G91)
//!          closed loop: trapezoid with MD1, MD2; blocks of one direction run without a stop between them, and pass
//!          each end with the lower of both speeds
//!          open loop: the speed is a function of the distance to go; a block of the same direction is adopted at a
//!          deceleration point of the previous one
//!          position reached (PEH): within the window before MD30 has elapsed since the switch-off, and never outside
//!          of it again
//! Reads    machine data `wf.*`, the command or actual position
//! Writes   orders, its signals
//! Refuses  START without blocks, request or in motion, speeds that are 0 or too high, ends beyond the software limits
//! Source   spec/wf725.md
//!
//! The module works in cycles of 4 ms; this implementation evaluates the same in every cycle of the axis. Times that
//! the source counts in module cycles (G) are kept.

mod closed;
mod enable;
mod jog;
mod open;
mod parameters;
mod program;
mod reference;
mod request;
mod signals;
mod steps;

pub use enable::enable;
pub use request::{Block, Blocks, FIXED_SPEEDS, FULL_SPEED, Jog, MAX_BLOCKS, MODES, MOST_BCD, Mode, Request, Speed};
pub use signals::WfSignal;

use super::{Order, View};
use crate::code::Code;
use crate::drive::{Interface, Switching};
use crate::event::{Number, Refusal};
use crate::object::Object;
use crate::parameter::wf::Parameters;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Three module cycles (ns), after which the speed value may be read (WF-IF-08).
const SPEED_VALID_NS: u64 = 12_000_000;
/// Speed values per volt (WF-DAC-02). A division by it gives the nearest f64 to each tenth.
const VALUES_PER_VOLT: f64 = 10.0;

/// State of a block (WF-OST-01 to 10); a closed loop has no steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum State {
    /// No motion.
    #[default]
    Idle = 0,
    /// At the programmed speed, or on the profile.
    Run = 1,
    /// At MD42.
    Step1 = 2,
    /// At MD43.
    Step2 = 3,
    /// At MD44.
    Step3 = 4,
    /// Switched off; coasting into the window.
    Settle = 5,
    /// Position reached.
    Done = 6,
    /// Stopped by an alarm.
    Alarm = 7,
}

/// Names of [`State`], by number.
const STATES: &[&str] = &["IDLE", "RUN", "STEP1", "STEP2", "STEP3", "SETTLE", "DONE", "ALARM"];

/// State of the vocabulary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wf {
    mode: Mode,
    program: Blocks,
    /// Ends of the blocks of this START (inc), before rounding.
    ends: [Position; MAX_BLOCKS],
    /// First block of the next START, active block, and the block after the last one of this START.
    next: u8,
    active: u8,
    end: u8,
    /// Closed loop: last block in the direction of the active one, and the limiting block.
    last: u8,
    limiting_block: u8,
    jog: Jog,
    /// Deceleration cam of the interface.
    cam: bool,
    fixed_speed: u8,
    /// Whether the controller enable request was withdrawn.
    request_withdrawn: bool,
    /// Reset bit of this cycle, and that of the present request.
    reset: bool,
    resets: bool,
    state: State,
    /// End of the last block (inc), before rounding.
    set: Position,
    /// Direction of motion: 1, -1, or 0.
    direction: i8,
    /// Present speed value; closed loop: that of the block.
    speed: f64,
    /// Closed loop: whether it stops, with state IDLE at the end.
    ending: bool,
    /// Open loop: whether the next block was considered; the distance to go is to its end (WF-BCF-04).
    considered: bool,
    started: u64,
    switched_off: u64,
    speed_valid: bool,
    alarm: u8,
    /// Zero of the programmed positions (actual value preset).
    preset: Position,
    synchronized: bool,
    /// Whether an order of a step was rejected: the motion has to be stopped.
    failed: bool,
    /// Outputs of the last step.
    switching: Switching,
}

impl Wf {
    /// Executes a request. If it or its order is refused, the caller keeps the previous state.
    pub(crate) fn run(&mut self, request: &Request, view: &View<'_>) -> Result<Option<Order>, Refusal> {
        let refuse = |code| Err(Refusal::new(code, Object::Axis(request.axis)));
        if request.reset {
            return Ok(self.acknowledge(view));
        }
        self.cam = request.cam.unwrap_or(self.cam);
        let mut order = None;
        if let Some(enable) = request.enable {
            self.request_withdrawn = !enable;
            if self.request_withdrawn {
                order = self.stop(view);
            }
        }
        let changes = request.mode.is_some_and(|mode| mode != self.mode)
            || request.blocks.is_some()
            || request.block.is_some()
            || request.value.is_some();
        if changes && self.is_in_motion(view) {
            return refuse(Code::WF_IN_MOTION);
        }
        if let Some(mode) = request.mode.filter(|mode| *mode != self.mode) {
            self.change_mode(mode);
        }
        if let Some(blocks) = &request.blocks {
            self.load(blocks, view).map_err(|refusal| refusal.of(request.axis))?;
        }
        if let Some(block) = request.block {
            if block == 0 || block > self.program.count() {
                let numbers = (Number::Count(block.into()), Number::Count(self.program.count().into()));
                return refuse(Code::WF_NO_SUCH_BLOCK).map_err(|refusal: Refusal| refusal.with(numbers.0, numbers.1));
            }
            self.next = block - 1;
        }
        if let Some(value) = request.value {
            if self.mode != Mode::ActualValue {
                return refuse(Code::WF_NOT_IN_THIS_MODE);
            }
            self.preset = self.distance_base(view) - value.exact() - offsets(view);
            self.synchronized = true;
        }
        if request.jog.is_some() || request.fixed_speed.is_some() {
            self.jog = request.jog.unwrap_or(self.jog);
            self.fixed_speed = request.fixed_speed.unwrap_or(self.fixed_speed).clamp(1, FIXED_SPEEDS);
            // Without the enable they are only stored: they must not cause a refusal of the request that removes the
            // enable.
            if request.enable != Some(false) && self.mode == Mode::Reference {
                order = self.travel(view).map_err(|refusal| refusal.of(request.axis))?.or(order);
            }
            if request.enable != Some(false) && self.mode == Mode::Jog {
                order = self.jog(view).map_err(|refusal| refusal.of(request.axis))?.or(order);
            }
        }
        if request.start {
            order = Some(self.start(view).map_err(|refusal| refusal.of(request.axis))?);
        }
        Ok(order)
    }

    /// Takes a new zero of the axis: programmed positions refer to it (WF-IF-11, WF-REF-05).
    pub(crate) fn set_zero(&mut self) {
        (self.synchronized, self.preset) = (true, Position::ZERO);
    }

    /// Marks the zero as no longer valid.
    pub(crate) fn invalidate_zero(&mut self) {
        self.synchronized = false;
    }

    /// Returns true if the vocabulary has work to do before its first request.
    pub(crate) fn wakes(&self, p: &Parameters) -> bool {
        p.max_following_error.is_some()
    }

    /// Executes one step at t_k, after the commands of the cycle.
    pub(crate) fn step(&mut self, view: &View<'_>) -> Option<Order> {
        let order = self.step_block(view);
        self.switching = if is_open(view) { self.switch(view) } else { Switching::default() };
        order
    }

    fn step_block(&mut self, view: &View<'_>) -> Option<Order> {
        self.reset = std::mem::take(&mut self.resets);
        if std::mem::take(&mut self.failed) && view.owns {
            return Some(self.standstill(view));
        }
        if let Some(order) = self.watch_following_error(view) {
            return Some(order);
        }
        if matches!(self.state, State::Idle | State::Alarm) {
            return None;
        }
        if self.mode == Mode::Reference {
            self.step_travel(view);
            return None;
        }
        if !view.owns || !view.free {
            self.end_activity();
            return None;
        }
        self.speed_valid |= self.is_running() && is_open(view) && elapsed(view, self.started) >= SPEED_VALID_NS;
        if is_open(view) { self.step_open(view) } else { self.step_closed(view) }
    }

    /// Returns the outputs. After the switch-off, F and B show the direction to the target (WF-OLC-10).
    fn switch(&self, view: &View<'_>) -> Switching {
        let output = self.is_running();
        // Reference travel may reverse on the cam, independently of JOG.
        let turned = self.mode == Mode::Reference && f64::from(self.direction) * view.search_speed < 0.0;
        let direction = if turned { -self.direction } else { self.direction };
        let towards = if output { direction.into() } else { self.following_error(view) };
        let dac = if output { f64::from(direction) * self.speed / VALUES_PER_VOLT } else { 0.0 };
        Switching { forward: towards > 0, backward: towards < 0, output, dac }
    }

    /// Handles an order of [`step`](Self::step) that the axis rejected.
    pub(crate) fn order_failed(&mut self, _refusal: Refusal) {
        self.end_activity();
        self.failed = true;
    }

    /// Returns the deceleration cam, which the requests set.
    pub(crate) fn cam(&self) -> bool {
        self.cam
    }

    /// Returns the commanded outputs of this cycle.
    pub(crate) fn switching(&self) -> Switching {
        self.switching
    }

    /// Writes its signals: one word for each of [`WfSignal`]. `switching` are the commanded outputs that the axis
    /// allows.
    pub(crate) fn publish(&self, view: &View<'_>, switching: Switching, words: &mut [u64]) {
        use WfSignal as S;
        let mut set = |signal: WfSignal, word: u64| {
            if let Some(place) = words.get_mut(signal as usize) {
                *place = word;
            }
        };
        let enabled = enable(!self.request_withdrawn, view.on, self.reset, self.alarm);
        let has_block = !matches!(self.state, State::Idle) && !self.has_no_blocks();
        set(S::Active, view.owns.into());
        set(S::Mode, self.mode as u64);
        set(S::State, self.state.word());
        set(S::Block, if has_block { u64::from(self.active) + 1 } else { 0 });
        set(S::Speed, self.speed.to_bits());
        set(S::Dac, switching.dac.to_bits());
        set(S::Q, switching.output.into());
        set(S::F, switching.forward.into());
        set(S::B, switching.backward.into());
        set(S::G, self.speed_valid.into());
        set(S::Enable, (enabled && (switching.output || !is_open(view))).into());
        set(S::Ready, view.on.into());
        set(S::Peh, (self.state == State::Done).into());
        set(S::Synchronized, self.synchronized.into());
        set(S::Alarm, self.alarm.into());
        set(S::FollowingError, self.following_error(view).cast_unsigned());
        set(S::DistanceToGo, self.distance_to_go(view).cast_unsigned());
    }

    /// Returns true if a restored state is valid.
    pub(crate) fn is_sound(&self) -> bool {
        let legal = self.ends.iter().chain([&self.set]).all(|position| position.is_legal());
        // The preset is a difference of two legal positions and offsets.
        let near = self.preset.raw().unsigned_abs() < 1 << 98;
        let places = [self.next, self.active, self.end, self.last, self.limiting_block];
        let inside = places.into_iter().all(|place| usize::from(place) <= MAX_BLOCKS);
        let speed = self.speed.is_finite() && (0.0..=FULL_SPEED * 2.0).contains(&self.speed);
        let speed = speed && self.switching.dac.is_finite();
        legal && near && inside && speed && self.program.is_sound() && self.direction.unsigned_abs() <= 1
    }

    /// Returns true if the inputs JOG+ and JOG- run the axis in this mode.
    fn has_no_blocks(&self) -> bool {
        matches!(self.mode, Mode::Jog | Mode::Reference)
    }

    /// Returns true if a speed is commanded, or a profile runs.
    fn is_running(&self) -> bool {
        matches!(self.state, State::Run | State::Step1 | State::Step2 | State::Step3)
    }

    fn is_in_motion(&self, view: &View<'_>) -> bool {
        let more = self.state == State::Done && self.active + 1 < self.end;
        self.is_running() || self.state == State::Settle || more || is_moved(view)
    }

    fn change_mode(&mut self, mode: Mode) {
        self.mode = mode;
        self.next = 0;
        self.jog = Jog::None;
        // In setup the set position follows the actual one (WF-SET-01).
        if self.has_no_blocks() && self.state != State::Alarm {
            self.end_activity();
        }
    }

    /// Handles the reset bit: ends the motion and acknowledges the alarm (WF-MON-06).
    fn acknowledge(&mut self, view: &View<'_>) -> Option<Order> {
        self.resets = true;
        if self.alarm == 0 {
            return self.stop(view);
        }
        self.clear_alarm();
        Some(Order::Reset)
    }

    /// Handles a reset of the error of the axis, which acknowledges the alarm as well, whether or not it has stopped
    /// the axis.
    pub(crate) fn take_reset(&mut self) {
        if self.alarm != 0 {
            self.clear_alarm();
        }
    }

    fn clear_alarm(&mut self) {
        self.alarm = 0;
        self.end_activity();
    }

    /// Ends the motion; a reached position is kept.
    fn stop(&mut self, view: &View<'_>) -> Option<Order> {
        self.end = self.end.min(self.active + 1);
        if !self.is_running() && self.state != State::Settle {
            return None;
        }
        // The travel ended at the mark, and its speed is off already (WF-REF-09).
        if self.mode == Mode::Reference && self.state == State::Settle {
            return None;
        }
        Some(self.standstill(view))
    }

    /// Returns the stop. Open loop: off at once. Closed loop: with a ramp.
    fn standstill(&mut self, view: &View<'_>) -> Order {
        if is_open(view) {
            self.end_activity();
            return Order::Speed { velocity: 0.0 };
        }
        let p = view.parameters;
        self.state = State::Run;
        self.ending = true;
        Order::Stop { limits: p.vocabularies.wf.limits(p.max_velocity, view.largest_limits()) }
    }

    /// Ends all activity; another owner may move the axis.
    fn end_activity(&mut self) {
        self.state = State::Idle;
        self.ending = false;
        self.considered = false;
        self.speed_valid = false;
        self.speed = 0.0;
        self.end = self.active;
    }

    /// Raises an alarm, which stops the axis through its errors.
    fn raise(&mut self, alarm: u8, code: Code, found: i64, allowed: i64) -> Option<Order> {
        self.end_activity();
        self.state = State::Alarm;
        self.alarm = alarm;
        Some(Order::Fail { code, found: Number::Position(found), allowed: Number::Position(allowed) })
    }

    /// Takes an alarm that the axis itself raised; its drive is already off.
    pub(crate) fn note_alarm(&mut self, alarm: u8) {
        self.end_activity();
        self.state = State::Alarm;
        self.alarm = alarm;
    }

    /// SETTLE and DONE: position reached and held (WF-PEH-01 to 03).
    fn settle(&mut self, view: &View<'_>) -> Option<Order> {
        let parameters = view.parameters;
        let window = parameters.vocabularies.wf.peh_window.unwrap_or(parameters.in_position_window);
        let error = self.following_error(view);
        let is_inside = error.unsigned_abs() <= window.unsigned_abs();
        match self.state {
            State::Settle if is_inside => self.state = State::Done,
            State::Settle if self.is_late(view) => return self.raise_not_reached(error, window),
            State::Done if !is_inside => return self.raise_not_reached(error, window),
            State::Done if self.active + 1 < self.end => {
                self.active += 1;
                return Some(self.begin(view));
            }
            _ => {}
        }
        None
    }

    /// Raises alarm 22.
    fn raise_not_reached(&mut self, error: i64, window: i64) -> Option<Order> {
        self.raise(22, Code::WF_POSITION_NOT_REACHED, error, window)
    }

    /// Returns true if MD30 has elapsed.
    fn is_late(&self, view: &View<'_>) -> bool {
        let wf = &view.parameters.vocabularies.wf;
        let since = if wf.peh_from_start == 1 { self.started } else { self.switched_off };
        elapsed(view, since) >= wf.md30.unsigned_abs()
    }

    fn switch_off(&mut self, view: &View<'_>) {
        self.state = State::Settle;
        self.switched_off = view.cycle;
        self.speed_valid = false;
        self.speed = 0.0;
    }

    /// Returns set position minus actual position (inc); open loop: 0 without a target.
    fn following_error(&self, view: &View<'_>) -> i64 {
        let actual = view.actual.position.floor();
        let has_end = match self.state {
            State::Idle => false,
            // In reference mode the set position follows the actual one (WF-SET-01).
            _ if self.mode == Mode::Reference => false,
            State::Run => !self.has_no_blocks(),
            _ => true,
        };
        match (is_open(view), has_end) {
            (true, true) => self.set.nearest().saturating_sub(actual),
            (false, _) if view.on => view.command.position.floor().saturating_sub(actual),
            _ => 0,
        }
    }

    fn distance_to_go(&self, view: &View<'_>) -> i64 {
        if self.state == State::Idle || self.has_no_blocks() {
            return 0;
        }
        let block = if self.considered { self.active.saturating_add(1) } else { self.active };
        self.end_of(block).nearest().saturating_sub(view.actual.position.floor())
    }

    /// Returns the end of a block.
    fn end_of(&self, block: u8) -> Position {
        self.ends.get(usize::from(block)).copied().unwrap_or(self.set)
    }

    /// Returns the direction of a block whose previous end is known.
    fn direction_of(&self, block: u8) -> i8 {
        direction(self.end_of(block.saturating_sub(1)), self.end_of(block))
    }
}

/// Returns true if the axis has reduction steps.
fn is_open(view: &View<'_>) -> bool {
    view.interface == Some(Interface::OpenLoop)
}

/// Returns true if the axis is in motion. An axis that coasts after the vocabulary switched it off may be started
/// again.
fn is_moved(view: &View<'_>) -> bool {
    !(view.rests || is_open(view) && view.owns)
}

/// Returns the time since a cycle (ns).
fn elapsed(view: &View<'_>, since: u64) -> u64 {
    view.cycle.saturating_sub(since).saturating_mul(view.cycle_ns)
}

/// Returns the direction from one whole increment to another.
fn direction(from: Position, to: Position) -> i8 {
    to.nearest().cmp(&from.nearest()) as i8
}

/// Returns NV + WK.
fn offsets(view: &View<'_>) -> Position {
    let wf = &view.parameters.vocabularies.wf;
    Position::whole(wf.zero_offset) + Position::whole(wf.tool_length)
}

/// Reason to refuse a request, without the axis.
#[derive(Clone, Copy, Debug)]
struct RefusalReason {
    code: Code,
    parameter: Option<u16>,
    asked: Number,
    limit: Number,
}

impl RefusalReason {
    fn new(code: Code) -> Self {
        Self { code, parameter: None, asked: Number::None, limit: Number::None }
    }

    /// Returns the objection with a parameter.
    fn about(self, row: u16) -> Self {
        Self { parameter: Some(row), ..self }
    }

    fn with(self, asked: Number, limit: Number) -> Self {
        Self { asked, limit, ..self }
    }

    fn of(self, axis: u16) -> Refusal {
        Refusal {
            parameter: self.parameter,
            ..Refusal::new(self.code, Object::Axis(axis)).with(self.asked, self.limit)
        }
    }
}

#[cfg(test)]
mod tests;
