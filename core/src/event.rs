//! Events of a cycle, as numbers; [`text`](crate::text) creates messages of them outside the cycle.

use crate::code::Code;
use crate::object::Object;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Expected.
    Info = 0,
    /// Unusual.
    Warn = 1,
    /// The machine or an axis failed.
    Error = 2,
}

/// Kind of an event; the names are those of the interface (`lineshaft_msgs/Event.kind`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A command was accepted.
    Accepted,
    /// A command was refused; nothing changed.
    Refused,
    /// A command or goal ended; code 0 if it succeeded.
    Done,
    /// An axis changed its state.
    State,
    /// An error appeared.
    Error,
    /// Errors were reset.
    Reset,
    /// A latch was captured.
    Latch,
    /// A goal found the mark that it searched for.
    Mark,
    /// A limit was reached or left.
    Limit,
    /// An axis was homed.
    Homed,
    /// Parameters changed, or READ_VALUE was answered.
    Parameter,
    /// Cycles were missed.
    Overrun,
    /// A notice that is no error.
    Warning,
}

impl Kind {
    /// All kinds with their names.
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

    /// Returns the name in the interface.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| name)
    }
}

/// A number with its meaning, for the message of an event.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub enum Number {
    /// No number.
    #[default]
    None,
    /// Position (inc).
    Position(i64),
    /// Velocity (inc/s).
    Velocity(f64),
    /// Acceleration (inc/s^2).
    Acceleration(f64),
    /// Jerk (inc/s^3).
    Jerk(f64),
    /// A plain count, number or choice.
    Count(i64),
    /// Time (ns).
    Time(i64),
    /// A plain real number.
    Real(f64),
}

/// NaN, which a request may contain, equals itself here, so that the same event is equal to itself.
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

/// Place in a trajectory of an event or a refusal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPlace {
    /// Number of the point, from 0, or of the point at the end of the segment.
    pub point: u32,
    /// Planned time of that point, from the start of the trajectory (ns).
    pub time_ns: u64,
    /// Factor by which the time of the trajectory is stretched, or would have to be; 1 if the time is irrelevant.
    pub stretch: f64,
    /// Maximum factor.
    pub max_stretch: f64,
}

/// One event of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Sequence number, which increases by one per event, without gaps.
    pub sequence: u64,
    /// Number of the cycle.
    pub cycle: u64,
    /// Time of the event before t_k (ns), below the cycle time.
    pub age_ns: u32,
    /// Severity.
    pub severity: Severity,
    /// Kind.
    pub kind: Kind,
    /// Object of the event.
    pub source: Object,
    /// Code; [`Code::NONE`] without an error.
    pub code: Code,
    /// Sequence number of the command that this answers or ends; 0: none.
    pub command: u64,
    /// Position of the event (latched, reached).
    pub position: Position,
    /// Index of the parameter row of the event.
    pub parameter: Option<u16>,
    /// Requested or found value.
    pub asked: Number,
    /// Allowed value.
    pub limit: Number,
    /// Place in a trajectory.
    pub place: Option<TrajectoryPlace>,
}

impl Event {
    /// Creates the end of a command: an info without a code, a warning with one.
    pub fn done(source: Object, sequence: u64, code: Code, position: Position) -> Self {
        let severity = if code.is_none() { Severity::Info } else { Severity::Warn };
        Self { position, ..Self::new(severity, Kind::Done, source, code).of_command(sequence) }
    }

    /// Creates an event without numbers; the queue sets sequence and cycle.
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

    /// Returns the event with the sequence number of a command.
    pub fn of_command(self, sequence: u64) -> Self {
        Self { command: sequence, ..self }
    }

    /// Returns the event with numbers for its message.
    pub fn with(self, asked: Number, limit: Number) -> Self {
        Self { asked, limit, ..self }
    }
}

/// Reason for the refusal of a command: a code, the object and the numbers of the message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// Error code.
    pub code: Code,
    /// Object of the refusal.
    pub object: Object,
    /// Index of the parameter row of the refusal.
    pub parameter: Option<u16>,
    /// Requested value.
    pub asked: Number,
    /// Allowed value.
    pub limit: Number,
    /// Place in a trajectory.
    pub place: Option<TrajectoryPlace>,
}

impl Refusal {
    /// Creates a refusal without numbers.
    pub fn new(code: Code, object: Object) -> Self {
        Self { code, object, parameter: None, asked: Number::None, limit: Number::None, place: None }
    }

    /// Returns the refusal with numbers.
    pub fn with(self, asked: Number, limit: Number) -> Self {
        Self { asked, limit, ..self }
    }

    /// Returns the refusal with the stretch of its trajectory.
    pub fn with_stretch(self, stretch: f64) -> Self {
        Self { place: self.place.map(|place| TrajectoryPlace { stretch, ..place }), ..self }
    }

    /// Returns the event that answers command `sequence`.
    pub fn event(&self, sequence: u64) -> Event {
        let event = Event::new(Severity::Warn, Kind::Refused, self.object, self.code).of_command(sequence);
        Event { parameter: self.parameter, asked: self.asked, limit: self.limit, place: self.place, ..event }
    }
}

/// The events of one cycle, in memory that is allocated before the first one.
#[derive(Clone, Debug)]
pub struct EventQueue {
    events: Vec<Event>,
    next: u64,
    cycle: u64,
    lost: u64,
}

impl EventQueue {
    /// Creates a queue for `capacity` events per cycle.
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

    /// Adds an event. If there is no room, the last event contains the number of lost events.
    pub fn push(&mut self, event: Event) {
        // One place is reserved for the notice.
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

    /// Replaces the last event of this cycle if it is `outdated`; otherwise adds the event.
    pub fn push_over(&mut self, event: Event, outdated: impl Fn(&Event) -> bool) {
        match self.events.last_mut().filter(|last| outdated(last)) {
            Some(last) => *last = Event { sequence: last.sequence, cycle: last.cycle, ..event },
            None => self.push(event),
        }
    }

    /// Returns the number of the next event.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Returns the events of this cycle.
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
    fn full_queue_reports_lost_events_without_allocation() {
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
