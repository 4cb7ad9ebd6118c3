//! Events: what happened in a cycle, as numbers; [`text`](crate::text) makes sentences of them outside the cycle.

use crate::code::Code;
use crate::object::Object;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// How much it matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Expected.
    Info = 0,
    /// Worth a look.
    Warn = 1,
    /// The machine or an axis failed.
    Error = 2,
}

/// What kind of event; the names stand in the interface (`lineshaft_msgs/Event.kind`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A command was accepted.
    Accepted,
    /// A command was refused; nothing changed.
    Refused,
    /// A command or goal ended; code 0 when it reached what it wanted.
    Done,
    /// An axis changed its state.
    State,
    /// An error appeared.
    Error,
    /// Errors were reset.
    Reset,
    /// A latch was taken.
    Latch,
    /// A goal found the mark that it searched for.
    Mark,
    /// A limit was reached or left.
    Limit,
    /// An axis got its zero.
    Homed,
    /// Parameters changed, or READ_VALUE has found a value of a function.
    Parameter,
    /// Cycles were missed.
    Overrun,
    /// Something to know that is no error.
    Warning,
}

impl Kind {
    /// Every kind with its name.
    pub const ALL: [(Kind, &'static str); 13] = [
        (Kind::Accepted, "accepted"),
        (Kind::Refused, "refused"),
        (Kind::Done, "done"),
        (Kind::State, "state"),
        (Kind::Error, "error"),
        (Kind::Reset, "reset"),
        (Kind::Latch, "latch"),
        (Kind::Mark, "mark"),
        (Kind::Limit, "limit"),
        (Kind::Homed, "homed"),
        (Kind::Parameter, "parameter"),
        (Kind::Overrun, "overrun"),
        (Kind::Warning, "warning"),
    ];

    /// The name in the interface.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| name)
    }
}

/// A number with its meaning, for the sentence of an event.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub enum Number {
    /// Nothing to say.
    #[default]
    None,
    /// (inc)
    Position(i64),
    /// (inc/s)
    Velocity(f64),
    /// (inc/s^2)
    Acceleration(f64),
    /// (inc/s^3)
    Jerk(f64),
    /// A plain count, number or choice.
    Count(i64),
    /// (ns)
    Time(i64),
    /// A plain real number.
    Real(f64),
}

/// NaN, which a request may hold, equals itself here: the same event twice is the same.
impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        match (*self, *other) {
            (Self::None, Self::None) => true,
            (Self::Position(a), Self::Position(b))
            | (Self::Count(a), Self::Count(b))
            | (Self::Time(a), Self::Time(b)) => a == b,
            (Self::Velocity(a), Self::Velocity(b))
            | (Self::Acceleration(a), Self::Acceleration(b))
            | (Self::Jerk(a), Self::Jerk(b))
            | (Self::Real(a), Self::Real(b)) => a == b || (a.is_nan() && b.is_nan()),
            _ => false,
        }
    }
}

/// The place of a trajectory that an event or a refusal is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPlace {
    /// Number of the point, from 0, or of the point at which the segment ends.
    pub point: u32,
    /// The planned time of that point, from the start of the trajectory (ns).
    pub time_ns: u64,
    /// Factor by which the time of the trajectory is stretched, or would have to be; 1 where time does not matter.
    pub stretch: f64,
    /// Largest allowed factor.
    pub max_stretch: f64,
}

/// One event of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Grows by one per event, without gaps.
    pub sequence: u64,
    /// The cycle.
    pub cycle: u64,
    /// How long before t_k it happened (ns), below the cycle's length.
    pub age_ns: u32,
    /// How much it matters.
    pub severity: Severity,
    /// What kind.
    pub kind: Kind,
    /// Which object it is about.
    pub source: Object,
    /// Which code; [`Code::NONE`] where nothing is wrong.
    pub code: Code,
    /// Sequence number of the command that this answers or ends; 0 for none.
    pub command: u64,
    /// A position that belongs to it (latched, reached).
    pub position: Position,
    /// Catalogue row that this is about.
    pub parameter: Option<u16>,
    /// What was asked or found.
    pub asked: Number,
    /// What is allowed.
    pub limit: Number,
    /// Where in a trajectory.
    pub place: Option<TrajectoryPlace>,
}

impl Event {
    /// The end of a command: good news without a code, a warning with one.
    pub fn done(source: Object, sequence: u64, code: Code, position: Position) -> Self {
        let severity = if code.is_none() { Severity::Info } else { Severity::Warn };
        Self { position, ..Self::new(severity, Kind::Done, source, code).of_command(sequence) }
    }

    /// An event without numbers; the queue fills in sequence and cycle.
    pub fn new(severity: Severity, kind: Kind, source: Object, code: Code) -> Self {
        Self {
            sequence: 0,
            cycle: 0,
            age_ns: 0,
            severity,
            kind,
            source,
            code,
            command: 0,
            position: Position::ZERO,
            parameter: None,
            asked: Number::None,
            limit: Number::None,
            place: None,
        }
    }

    /// The same, about a command.
    pub fn of_command(self, sequence: u64) -> Self {
        Self { command: sequence, ..self }
    }

    /// The same, with numbers for the sentence.
    pub fn with(self, asked: Number, limit: Number) -> Self {
        Self { asked, limit, ..self }
    }
}

/// Why a command is refused: a code, the object and the numbers that its sentence needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// Why.
    pub code: Code,
    /// About which object.
    pub object: Object,
    /// Catalogue row that this is about.
    pub parameter: Option<u16>,
    /// What was asked.
    pub asked: Number,
    /// What is allowed.
    pub limit: Number,
    /// Where in a trajectory.
    pub place: Option<TrajectoryPlace>,
}

impl Refusal {
    /// A refusal that needs no numbers.
    pub fn new(code: Code, object: Object) -> Self {
        Self { code, object, parameter: None, asked: Number::None, limit: Number::None, place: None }
    }

    /// The same with numbers.
    pub fn with(self, asked: Number, limit: Number) -> Self {
        Self { asked, limit, ..self }
    }

    /// The same with the stretch of a trajectory that it is about.
    pub fn with_stretch(self, stretch: f64) -> Self {
        Self { place: self.place.map(|place| TrajectoryPlace { stretch, ..place }), ..self }
    }

    /// The event that answers command `sequence`.
    pub fn event(&self, sequence: u64) -> Event {
        let event = Event::new(Severity::Warn, Kind::Refused, self.object, self.code).of_command(sequence);
        Event { parameter: self.parameter, asked: self.asked, limit: self.limit, place: self.place, ..event }
    }
}

/// The events of one cycle, in room that is taken before the first one.
#[derive(Clone, Debug)]
pub struct EventQueue {
    events: Vec<Event>,
    next: u64,
    cycle: u64,
    lost: u64,
}

impl EventQueue {
    /// Room for `capacity` events a cycle.
    pub fn new(capacity: usize) -> Self {
        Self { events: Vec::with_capacity(capacity.max(2)), next: 0, cycle: 0, lost: 0 }
    }

    /// Empties the queue for cycle `cycle`, whose first event gets number `next`.
    pub fn begin(&mut self, cycle: u64, next: u64) {
        self.events.clear();
        self.cycle = cycle;
        self.next = next;
        self.lost = 0;
    }

    /// Adds an event. When there is no room, the last event tells how many were lost.
    pub fn push(&mut self, event: Event) {
        // One place is kept for the notice.
        if self.events.len() + 1 < self.events.capacity() {
            self.events.push(Event { sequence: self.next, cycle: self.cycle, ..event });
            self.next = self.next.wrapping_add(1);
            return;
        }
        if self.lost == 0 {
            let notice = Event::new(Severity::Error, Kind::Warning, Object::Machine, Code::EVENTS_LOST);
            self.events.push(Event { sequence: self.next, cycle: self.cycle, ..notice });
            self.next = self.next.wrapping_add(1);
        }
        self.lost = self.lost.saturating_add(1);
        if let Some(notice) = self.events.last_mut() {
            notice.asked = Number::Count(self.lost as i64);
        }
    }

    /// The last event of this cycle gives way to another one, if it is `outdated`; else that comes behind it.
    pub fn push_over(&mut self, event: Event, outdated: impl Fn(&Event) -> bool) {
        match self.events.last_mut().filter(|last| outdated(last)) {
            Some(last) => *last = Event { sequence: last.sequence, cycle: last.cycle, ..event },
            None => self.push(event),
        }
    }

    /// The number of the next event.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// The events of this cycle.
    pub fn as_slice(&self) -> &[Event] {
        &self.events
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_holds_no_number_equals_itself() {
        for make in [Number::Real, Number::Velocity, Number::Acceleration, Number::Jerk] {
            assert_eq!(make(f64::NAN), make(f64::NAN));
            assert_eq!(make(0.0), make(-0.0));
            assert_ne!(make(f64::NAN), make(0.0));
        }
        assert_ne!(Number::Real(1.0), Number::Velocity(1.0));
        assert_ne!(Number::Count(1), Number::Time(1));
    }

    #[test]
    fn a_full_queue_tells_how_many_events_it_lost_and_takes_no_memory() {
        let mut queue = EventQueue::new(4);
        queue.begin(7, 0);
        let room = queue.events.capacity();
        for _ in 0..room + 4 {
            queue.push(Event::new(Severity::Info, Kind::State, Object::Machine, Code::NONE));
        }
        assert_eq!(queue.events.capacity(), room);
        let last = queue.as_slice().last().unwrap();
        assert_eq!((last.code, last.asked, last.cycle), (Code::EVENTS_LOST, Number::Count(5), 7));
        let sequences: Vec<u64> = queue.as_slice().iter().map(|event| event.sequence).collect();
        assert_eq!(sequences, (0..room as u64).collect::<Vec<_>>());
    }
}
