//! A gantry: two drives that carry one axis between them, which sees them as one.
//!
//! Law      apart = place of the second drive - place of the first (inc); skew = apart - square, the apart at which the gantry is square;
//!          setpoint of the second = setpoint of the first + held; held = apart as the axis comes on, until squaring leads it to
//!          the square. A new coordinate of either drive is no motion, so apart goes on; where the words themselves tell what is square,
//!          it is taken from them anew
//! Reads    the inputs of both drives, the inputs that are assigned to their reference switches
//! Writes   one input, which the axis takes for that of its drive; the outputs of the second drive
//! Refuses  nothing: what is wrong is told to the axis, which has the reactions
//! Source   contract section 3, docs/homing.md

mod join;

use crate::drive::{DriveInput, DriveOutput, DriveState, inputs};
use crate::encoder::{Form, Reader};
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan};
use serde::{Deserialize, Serialize};

/// One of its two drives.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Side {
    reader: Reader,
    /// Its word of this cycle.
    raw: i64,
    /// Its place is one of this cycle.
    valid: bool,
    /// Its reference switch is actuated.
    home: bool,
    /// The outermost place at which that was so, at its last edge since it was sought.
    edge: Option<i64>,
    /// It came since the leg under way began.
    came: bool,
    /// Where it was left again before the other one came.
    left: Option<i64>,
    /// What the place changed by with its last fresh word (inc).
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

    /// Places minus words.
    fn origin(&self) -> i64 {
        self.place().wrapping_sub(self.reader.count().unwrap_or(self.raw))
    }

    /// Reads a drive and its switch; has its coordinate begun anew? `both`: the switches of both are actuated.
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

/// The second drive on its way to the square, while the first goes its own.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Squaring {
    plan: Plan,
    /// Cycle in which the plan begins.
    start: u64,
    /// What was held before (inc).
    from: i64,
    /// The square that it leads to; none of one that stops before.
    square: Option<i64>,
}

impl Squaring {
    /// What the plan holds, `ago` cycles before that one.
    fn held(&self, cycle: u64, ago: u64) -> i64 {
        let elapsed = cycle.saturating_sub(self.start).checked_sub(ago);
        elapsed.map_or(self.from, |elapsed| self.plan.at(elapsed).position.floor())
    }
}

/// Cycles that a drive may lag behind what it is asked for, beside its delay.
const LAG: u64 = 3;

/// What is wrong with a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The second drive tells no place.
    Unread,
    /// So far from where it may be (inc).
    Skewed(i64),
}

/// What a gantry is set up as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GantrySetup {
    /// The axis.
    pub axis: u16,
    /// Places of its drives among the drives.
    pub drives: [usize; 2],
    /// What both tell.
    pub form: Form,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
    /// Cycles until its drives can have answered, beside the one that every drive takes.
    pub delay: u32,
}

/// What a gantry is between two cycles.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Gantry {
    setup: GantrySetup,
    sides: [Side; 2],
    /// Apart at which it is square (inc); none before both drives were read.
    square: Option<i64>,
    /// What the setpoint of the second drive is more than that of the first (inc).
    held: i64,
    /// Its change beside the motion of the axis (inc/s).
    rate: f64,
    squaring: Option<Squaring>,
    /// The reference switch as the axis sees it.
    home: bool,
    /// Place of the first drive since which the reference switches differ (inc).
    differs_since: Option<i64>,
    /// The words of both are of this cycle.
    is_fresh: bool,
    /// The coordinate of the second drive has begun anew in this cycle.
    is_anew: bool,
    /// That of either has, and what is square is not taken from the words since.
    is_unsure: bool,
    /// What is square is where they stand, since either coordinate has begun anew in this cycle.
    is_assumed: bool,
    /// It was too far from where it may be in the last cycle.
    is_beyond: bool,
    /// What the second drive shows.
    second: DriveState,
}

impl Gantry {
    /// Before its drives were read.
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

    /// What it is set up as.
    pub fn setup(&self) -> &GantrySetup {
        &self.setup
    }

    /// Is it set up as another one, and could its state have come about?
    pub fn is_sound(&self, fresh: &Self) -> bool {
        let reads = |side: &Side| side.reader.is_sound() && side.reader.form() == self.setup.form;
        self.setup == fresh.setup
            && self.sides.iter().all(reads)
            && self.rate.is_finite()
            && self.squaring.is_none_or(|squaring| squaring.plan.is_sound())
    }

    /// Reads both drives, and returns what the axis reads. `assigned`: the inputs that are their reference switches; `offset`: the apart at which
    /// it is square, where that is known beforehand.
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
            // Words that begin anew somewhere tell the offset up to their circle.
            let [count, other] = [first, second].map(|side| side.reader.count().unwrap_or(side.raw));
            let skew = offset.map_or(0, |offset| self.setup.form.circle().way(offset, other.wrapping_sub(count)));
            self.square = Some(self.apart().saturating_sub(skew));
            self.is_unsure = false;
        }
        self.second = join::state(drives[1]);
        let switch = if self.home { inputs::HOME } else { 0 };
        DriveInput { inputs: joined.inputs & !inputs::HOME | switch, ..joined }
    }

    /// Place of the second drive minus place of the first (inc).
    pub fn apart(&self) -> i64 {
        let [first, second] = &self.sides;
        second.place().wrapping_sub(first.place())
    }

    /// How far it is from square, as far as that is known (inc).
    pub fn skew(&self) -> i64 {
        let square = self.squaring.map_or(self.square, |squaring| squaring.square);
        square.map_or(0, |square| self.apart().saturating_sub(square))
    }

    /// What the setpoint of the second drive is more than that of the first (inc).
    pub fn held(&self) -> i64 {
        self.held
    }

    /// What the second drive shows.
    pub fn second(&self) -> DriveState {
        self.second
    }

    /// Word of the second drive.
    pub fn second_count(&self) -> i64 {
        self.sides[1].raw
    }

    /// The reference switch of the second drive.
    pub fn second_home(&self) -> bool {
        self.sides[1].home
    }

    /// Has the coordinate of the second drive begun anew in this cycle?
    pub fn is_anew(&self) -> bool {
        self.is_anew
    }

    /// Is what is square where they stand, since the coordinate of either has begun anew in this cycle?
    pub fn is_assumed(&self) -> bool {
        self.is_assumed
    }

    /// Are the words of both of this cycle?
    pub fn is_fresh(&self) -> bool {
        self.is_fresh
    }

    /// Does the second drive tell its place?
    pub fn is_second_read(&self) -> bool {
        self.sides[1].valid
    }

    /// What the place of the second drive changed by with its last fresh word (inc).
    pub fn second_change(&self) -> i64 {
        self.sides[1].change
    }

    /// Notes whether it is too far from where it may be; was it before?
    pub fn note_beyond(&mut self, is_beyond: bool) -> bool {
        std::mem::replace(&mut self.is_beyond, is_beyond)
    }

    /// The axis is not on: it holds what it finds once it is. True where that ends a squaring.
    pub fn let_go(&mut self) -> bool {
        let ended = self.squaring.take().is_some();
        if ended {
            self.square = Some(self.apart());
        }
        (self.held, self.rate) = (self.apart(), 0.0);
        ended
    }

    /// One cycle of squaring.
    pub fn advance(&mut self, cycle: u64) {
        let Some(Squaring { plan, start, square, .. }) = self.squaring else { return };
        let elapsed = cycle.saturating_sub(start);
        let motion = plan.at(elapsed);
        (self.held, self.rate) = (motion.position.floor(), motion.velocity);
        if elapsed >= plan.cycles() {
            (self.squaring, self.rate) = (None, 0.0);
            self.held = square.unwrap_or(self.held);
            // One that was stopped on its way is known to be square no more.
            self.square = Some(square.unwrap_or(self.apart()));
        }
    }

    /// What is wrong with it in this cycle, where it may be so far (inc) from square, while it looks for its square from what it holds, and while
    /// it is led from where that has led it to.
    pub fn trouble(&self, cycle: u64, max_skew: i64, searches: bool) -> Option<Trouble> {
        if !self.sides[1].valid {
            return Some(Trouble::Unread);
        }
        let (low, high) = match (self.squaring, self.square) {
            (Some(squaring), _) => {
                let ago = squaring.held(cycle, self.lag());
                (ago.min(self.held), ago.max(self.held))
            }
            (None, Some(square)) if !searches => (square, square),
            _ => (self.held, self.held),
        };
        let apart = self.apart();
        if !self.is_fresh {
            // Words of different cycles are no skew; how long they are waited for is counted.
            return None;
        }
        let beyond = apart.saturating_sub(apart.clamp(low, high));
        (beyond.saturating_abs() > max_skew).then_some(Trouble::Skewed(beyond))
    }

    /// Cycles that a drive may lag behind what it is asked for.
    fn lag(&self) -> u64 {
        LAG.saturating_add(self.setup.delay.into())
    }

    /// A leg of a search begins.
    pub fn begin_leg(&mut self) {
        for side in &mut self.sides {
            (side.came, side.left) = (false, None);
        }
    }

    /// Has a side gone further than `slack` (inc) beyond its reference switch, though the other one's did not come?
    pub fn has_passed(&self, slack: i64) -> bool {
        let gone = |side: &Side| side.left.map_or(0, |left| side.place().wrapping_sub(left).saturating_abs());
        self.sides.iter().any(|side| gone(side) > slack)
    }

    /// A search for the reference switches begins: is that of both actuated?
    pub fn begin_search(&mut self) -> bool {
        let [first, second] = &mut self.sides;
        (first.edge, second.edge) = (None, None);
        self.home = first.home && second.home;
        self.differs_since = self.differs_since.map(|_| first.place());
        self.home
    }

    /// How far the first drive has gone since the reference switches differ (inc).
    pub fn differs_for(&self) -> Option<i64> {
        self.differs_since.map(|since| self.sides[0].place().wrapping_sub(since).saturating_abs())
    }

    /// The square by the last edges of the reference switches, how far the second drive is from it by what it holds, and how far the first
    /// drive has gone since its own edge (inc); none before both have come.
    pub fn found(&self) -> Option<Found> {
        let [first, second] = &self.sides;
        let (edge, other) = first.edge.zip(second.edge)?;
        let square = other.wrapping_sub(edge);
        Some(Found { square, way: square.saturating_sub(self.held), gone: first.place().wrapping_sub(edge) })
    }

    /// Leads the second drive to the square.
    pub fn begin_squaring(&mut self, square: i64, limits: &Limits, cycle: u64) {
        let start = Motion::at_rest(Position::whole(self.held));
        let plan = profile::to_rest(start, Position::whole(square), limits, self.setup.cycle_ns);
        self.squaring = Some(Squaring { plan, start: cycle, from: self.held, square: Some(square) });
    }

    /// Does the second drive go up on its way (inc)? None where it stays.
    pub fn goes_up(&self) -> Option<bool> {
        (self.rate != 0.0).then_some(self.rate > 0.0)
    }

    /// Is the second drive on its way?
    pub fn is_squaring(&self) -> bool {
        self.squaring.is_some()
    }

    /// Stops the second drive where it is on its way. True where it was on one to the square.
    pub fn stop_squaring(&mut self, limits: &Limits, cycle: u64) -> bool {
        let Some(squaring) = self.squaring.filter(|squaring| squaring.square.is_some()) else { return false };
        let now = squaring.plan.at(cycle.saturating_sub(squaring.start));
        let plan = profile::stop(now, limits, self.setup.cycle_ns);
        let from = squaring.held(cycle, self.lag());
        self.squaring = Some(Squaring { plan, start: cycle, from, square: None });
        true
    }

    /// The outputs of the second drive, from those of the first.
    pub fn lead(&self, first: &DriveOutput) -> DriveOutput {
        let [leads, follows] = &self.sides;
        let place = first.position.wrapping_add(leads.origin()).wrapping_add(self.held);
        DriveOutput { position: place.wrapping_sub(follows.origin()), velocity: first.velocity + self.rate, ..*first }
    }
}

/// What the reference switches have told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// Apart at which it is square (inc).
    pub square: i64,
    /// What the second drive has to go for it (inc).
    pub way: i64,
    /// What the first drive has gone since its edge (inc).
    pub gone: i64,
}
