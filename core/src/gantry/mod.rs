//! A gantry: two drives that move one axis, and that the axis sees as one drive.
//!
//! Law      apart = position of the second drive - position of the first (inc); skew = apart - square, with square: the
//!          value of apart at which the gantry is square. Setpoint of the second drive = setpoint of the first + held;
//!          held = apart when the axis is switched on, until squaring moves it to square. A new coordinate of either
//!          drive is no motion, so apart is continued. If the position values themselves define square, it is
//!          calculated from them again
//! Reads    the inputs of both drives, the inputs assigned to their reference switches
//! Writes   one input, which the axis uses as that of its drive; the outputs of the second drive
//! Refuses  nothing: errors are reported to the axis, which has the reactions
//! Source   contract section 3, docs/homing.md

mod join;

use crate::drive::{DriveInput, DriveOutput, DriveState, inputs};
use crate::encoder::{Form, Reader};
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan};
use serde::{Deserialize, Serialize};

/// State of one of its two drives.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Side {
    reader: Reader,
    /// Position value of this cycle.
    raw: i64,
    /// Whether its position is of this cycle.
    valid: bool,
    /// Whether its reference switch is active.
    home: bool,
    /// Outermost position with active reference switch, at its last edge since the start of the search.
    edge: Option<i64>,
    /// Whether the switch became active during the present leg.
    came: bool,
    /// Position at which the switch became inactive again before that of the other drive became active.
    left: Option<i64>,
    /// Change of the position with its last fresh value (inc).
    change: i64,
}

impl Side {
    fn new(form: Form) -> Self {
        Self {
            reader: Reader::new(form),
            raw: 0,
            valid: false,
            home: false,
            edge: None,
            came: false,
            left: None,
            change: 0,
        }
    }

    fn place(&self) -> i64 {
        self.reader.position()
    }

    /// Returns the difference between positions and values of the drive.
    fn origin(&self) -> i64 {
        self.place().wrapping_sub(self.reader.count().unwrap_or(self.raw))
    }

    /// Reads a drive and its switch. Returns true if its coordinate is new. `both`: whether the switches of both drives
    /// are active.
    fn read(&mut self, input: &DriveInput, assigned: bool, both: bool) -> bool {
        let before = self.place();
        let is_anew = input.online && self.reader.epoch().is_some_and(|epoch| epoch != input.epoch);
        self.raw = input.count;
        self.valid = input.online && self.reader.take(input.count, input.epoch, true).valid;
        let home = input.inputs & inputs::HOME != 0 || assigned;
        if home != std::mem::replace(&mut self.home, home) {
            self.edge = Some(if home { self.place() } else { before });
            self.left = (!home && self.came && !both).then_some(before);
            self.came |= home;
        }
        if input.fresh {
            self.change = self.place().wrapping_sub(before);
        }
        is_anew
    }
}

/// Motion of the second drive relative to the first one, for squaring.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Squaring {
    plan: Plan,
    /// Cycle in which the plan begins.
    start: u64,
    /// Value of held before (inc).
    from: i64,
    /// Value of square to which it leads; none for a stop before.
    square: Option<i64>,
}

impl Squaring {
    /// Returns the value of held by the plan, `ago` cycles before `cycle`.
    fn held(&self, cycle: u64, ago: u64) -> i64 {
        let elapsed = cycle.saturating_sub(self.start).checked_sub(ago);
        elapsed.map_or(self.from, |elapsed| self.plan.at(elapsed).position.floor())
    }
}

/// Cycles by which a drive may lag behind its command, in addition to its delay.
const LAG: u64 = 3;

/// Error of a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GantryError {
    /// The position of the second drive is unknown.
    Unread,
    /// Skew beyond the allowed range (inc).
    Skewed(i64),
}

/// Configuration of a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GantrySetup {
    /// Index of the axis.
    pub axis: u16,
    /// Indices of its drives among the drives.
    pub drives: [usize; 2],
    /// Form of the values of both drives.
    pub form: Form,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
    /// Cycles until its drives can respond, in addition to the one that every drive needs.
    pub delay: u32,
}

/// State of a gantry between two cycles.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Gantry {
    setup: GantrySetup,
    sides: [Side; 2],
    /// Value of apart at which it is square (inc); none before both drives were read.
    square: Option<i64>,
    /// Setpoint of the second drive minus that of the first (inc).
    held: i64,
    /// Velocity of that difference (inc/s).
    rate: f64,
    squaring: Option<Squaring>,
    /// State of the joined reference switch.
    home: bool,
    /// Position of the first drive since which the reference switches differ (inc).
    differs_since: Option<i64>,
    /// Whether the data of both are of this cycle.
    is_fresh: bool,
    /// Whether the coordinate of the second drive is new in this cycle.
    is_anew: bool,
    /// Whether either coordinate is new, and square has not been calculated from the position values since.
    is_unsure: bool,
    /// Whether a coordinate is new in this cycle and square is assumed to be unchanged.
    is_assumed: bool,
    /// Whether the skew was out of range in the last cycle.
    is_beyond: bool,
    /// State of the second drive.
    second: DriveState,
}

impl Gantry {
    /// Returns the state before its drives are read.
    pub fn new(setup: GantrySetup) -> Self {
        Self {
            setup,
            sides: [Side::new(setup.form); 2],
            square: None,
            held: 0,
            rate: 0.0,
            squaring: None,
            home: false,
            differs_since: None,
            is_fresh: false,
            is_anew: false,
            is_unsure: false,
            is_assumed: false,
            is_beyond: false,
            second: DriveState::NotReady,
        }
    }

    /// Returns its configuration.
    pub fn setup(&self) -> &GantrySetup {
        &self.setup
    }

    /// Whether it has the same configuration as `fresh`, and its state is possible.
    pub fn is_sound(&self, fresh: &Self) -> bool {
        let reads = |side: &Side| side.reader.is_sound() && side.reader.form() == self.setup.form;
        self.setup == fresh.setup
            && self.sides.iter().all(reads)
            && self.rate.is_finite()
            && self.squaring.is_none_or(|squaring| squaring.plan.is_sound())
    }

    /// Reads both drives and returns the input for the axis. `assigned`: levels of the inputs assigned to their
    /// reference switches; `offset`: value of apart at which it is square, if known beforehand.
    pub fn read(&mut self, drives: [&DriveInput; 2], assigned: [bool; 2], offset: Option<i64>) -> DriveInput {
        let [first, second] = &mut self.sides;
        let is_anew = first.read(drives[0], assigned[0], self.home);
        self.is_anew = second.read(drives[1], assigned[1], self.home);
        let (one, other) = (first.home, second.home);
        self.home = if self.home { one || other } else { one && other };
        self.differs_since = (one != other).then(|| self.differs_since.unwrap_or(first.place()));
        let joined = join::joined(drives);
        self.is_fresh = joined.fresh;
        let is_known = offset.is_some() && matches!(self.setup.form, Form::Absolute(_));
        let is_read = self.square.is_some();
        self.is_unsure |= (is_anew || self.is_anew) && is_known && is_read;
        self.is_assumed = (is_anew && first.valid || self.is_anew && second.valid) && !is_known && is_read;
        if (self.is_unsure || !is_read) && first.valid && second.valid && self.is_fresh && self.squaring.is_none() {
            // Values that start again at any number give the offset up to their range.
            let [count, other] = [first, second].map(|side| side.reader.count().unwrap_or(side.raw));
            let skew = offset
                .map_or(0, |offset| self.setup.form.circle().shortest_distance(offset, other.wrapping_sub(count)));
            self.square = Some(self.position_difference().saturating_sub(skew));
            self.is_unsure = false;
        }
        self.second = join::state(drives[1]);
        let switch = if self.home { inputs::HOME } else { 0 };
        DriveInput { inputs: joined.inputs & !inputs::HOME | switch, ..joined }
    }

    /// Returns position of the second drive minus position of the first (inc).
    pub fn position_difference(&self) -> i64 {
        let [first, second] = &self.sides;
        second.place().wrapping_sub(first.place())
    }

    /// Returns the skew, as far as it is known (inc).
    pub fn skew(&self) -> i64 {
        let square = self.squaring.map_or(self.square, |squaring| squaring.square);
        square.map_or(0, |square| self.position_difference().saturating_sub(square))
    }

    /// Returns setpoint of the second drive minus that of the first (inc).
    pub fn held(&self) -> i64 {
        self.held
    }

    /// Returns the state of the second drive.
    pub fn second(&self) -> DriveState {
        self.second
    }

    /// Returns the position value of the second drive.
    pub fn second_count(&self) -> i64 {
        self.sides[1].raw
    }

    /// Returns the reference switch of the second drive.
    pub fn second_home(&self) -> bool {
        self.sides[1].home
    }

    /// Whether the coordinate of the second drive is new in this cycle.
    pub fn has_new_coordinate(&self) -> bool {
        self.is_anew
    }

    /// Whether a coordinate is new in this cycle and square is assumed to be unchanged.
    pub fn is_assumed(&self) -> bool {
        self.is_assumed
    }

    /// Whether the data of both are of this cycle.
    pub fn is_fresh(&self) -> bool {
        self.is_fresh
    }

    /// Whether the position of the second drive is known.
    pub fn is_second_read(&self) -> bool {
        self.sides[1].valid
    }

    /// Returns the change of position of the second drive with its last fresh value (inc).
    pub fn second_change(&self) -> i64 {
        self.sides[1].change
    }

    /// Sets whether the skew is out of range, and returns whether it was before.
    pub fn set_skew_exceeded(&mut self, is_beyond: bool) -> bool {
        std::mem::replace(&mut self.is_beyond, is_beyond)
    }

    /// Sets held to apart while the axis is off. Returns true if that ends a squaring.
    pub fn hold_present_difference(&mut self) -> bool {
        let ended = self.squaring.take().is_some();
        if ended {
            self.square = Some(self.position_difference());
        }
        (self.held, self.rate) = (self.position_difference(), 0.0);
        ended
    }

    /// Advances squaring by one cycle.
    pub fn advance(&mut self, cycle: u64) {
        let Some(Squaring { plan, start, square, .. }) = self.squaring else { return };
        let elapsed = cycle.saturating_sub(start);
        let motion = plan.at(elapsed);
        (self.held, self.rate) = (motion.position.floor(), motion.velocity);
        if elapsed >= plan.cycles() {
            (self.squaring, self.rate) = (None, 0.0);
            self.held = square.unwrap_or(self.held);
            // A squaring that was stopped makes it no longer square.
            self.square = Some(square.unwrap_or(self.position_difference()));
        }
    }

    /// Returns the error of this cycle. The skew may be `max_skew` (inc) relative to square; while homing searches,
    /// relative to held; and during squaring, relative to the planned values.
    pub fn error(&self, cycle: u64, max_skew: i64, searches: bool) -> Option<GantryError> {
        if !self.sides[1].valid {
            return Some(GantryError::Unread);
        }
        let (low, high) = match (self.squaring, self.square) {
            (Some(squaring), _) => {
                let ago = squaring.held(cycle, self.lag());
                (ago.min(self.held), ago.max(self.held))
            }
            (None, Some(square)) if !searches => (square, square),
            _ => (self.held, self.held),
        };
        let apart = self.position_difference();
        if !self.is_fresh {
            // Values of different cycles give no skew; the cycles without fresh data are counted elsewhere.
            return None;
        }
        let beyond = apart.saturating_sub(apart.clamp(low, high));
        (beyond.saturating_abs() > max_skew).then_some(GantryError::Skewed(beyond))
    }

    /// Returns the cycles by which a drive may lag behind its command.
    fn lag(&self) -> u64 {
        LAG.saturating_add(self.setup.delay.into())
    }

    /// Begins a leg of a search.
    pub fn begin_leg(&mut self) {
        for side in &mut self.sides {
            (side.came, side.left) = (false, None);
        }
    }

    /// Whether a drive has moved further than `slack` (inc) beyond its reference switch while that of the other one has
    /// not become active.
    pub fn has_passed(&self, slack: i64) -> bool {
        let gone = |side: &Side| side.left.map_or(0, |left| side.place().wrapping_sub(left).saturating_abs());
        self.sides.iter().any(|side| gone(side) > slack)
    }

    /// Begins a search for the reference switches, and returns whether both are active.
    pub fn begin_search(&mut self) -> bool {
        let [first, second] = &mut self.sides;
        (first.edge, second.edge) = (None, None);
        self.home = first.home && second.home;
        self.differs_since = self.differs_since.map(|_| first.place());
        self.home
    }

    /// Returns the travel of the first drive since the reference switches differ (inc).
    pub fn differs_for(&self) -> Option<i64> {
        self.differs_since.map(|since| self.sides[0].place().wrapping_sub(since).saturating_abs())
    }

    /// Returns the result of the last edges of the reference switches; none before both have come.
    pub fn found(&self) -> Option<Found> {
        let [first, second] = &self.sides;
        let (edge, other) = first.edge.zip(second.edge)?;
        let square = other.wrapping_sub(edge);
        Some(Found { square, way: square.saturating_sub(self.held), gone: first.place().wrapping_sub(edge) })
    }

    /// Moves the second drive to square.
    pub fn begin_squaring(&mut self, square: i64, limits: &Limits, cycle: u64) {
        let start = Motion::at_rest(Position::whole(self.held));
        let plan = profile::to_rest(start, Position::whole(square), limits, self.setup.cycle_ns);
        self.squaring = Some(Squaring { plan, start: cycle, from: self.held, square: Some(square) });
    }

    /// Whether squaring moves the second drive up. None: no motion.
    pub fn squaring_is_upward(&self) -> Option<bool> {
        (self.rate != 0.0).then_some(self.rate > 0.0)
    }

    /// Whether the second drive is being squared.
    pub fn is_squaring(&self) -> bool {
        self.squaring.is_some()
    }

    /// Stops the second drive during squaring. Returns true if there was one to stop.
    pub fn stop_squaring(&mut self, limits: &Limits, cycle: u64) -> bool {
        let Some(squaring) = self.squaring.filter(|squaring| squaring.square.is_some()) else { return false };
        let now = squaring.plan.at(cycle.saturating_sub(squaring.start));
        let plan = profile::stop(now, limits, self.setup.cycle_ns);
        let from = squaring.held(cycle, self.lag());
        self.squaring = Some(Squaring { plan, start: cycle, from, square: None });
        true
    }

    /// Returns the outputs of the second drive, from those of the first.
    pub fn lead(&self, first: &DriveOutput) -> DriveOutput {
        let [leads, follows] = &self.sides;
        let place = first.position.wrapping_add(leads.origin()).wrapping_add(self.held);
        DriveOutput { position: place.wrapping_sub(follows.origin()), velocity: first.velocity + self.rate, ..*first }
    }
}

/// Result of a search for the reference switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// Value of apart at which it is square (inc).
    pub square: i64,
    /// Necessary motion of the second drive (inc).
    pub way: i64,
    /// Travel of the first drive since its edge (inc).
    pub gone: i64,
}
