//! Queues of commands to the cycle thread: stops, other commands, and streamed setpoints.

use lineshaft_core::command::{Action, Command, Commands, Setpoint, Setpoints, Source};
use lineshaft_core::machine::MAX_COMMANDS;
use lineshaft_core::table::Table;
use lineshaft_core::trajectory::Trajectory;
use lineshaft_program::Module;
use lineshaft_ros::surface::host::{MOST_COMMANDS, SubmitError};
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Data that the machine shares but must not free.
#[derive(Debug)]
enum SharedData {
    Trajectory(Arc<Trajectory>),
    Table(Arc<Table>),
    Program(Arc<Module>),
}

impl SharedData {
    fn of(action: &Action) -> Option<Self> {
        match action {
            Action::Trajectory(trajectory) => Some(Self::Trajectory(Arc::clone(trajectory))),
            Action::LoadTable { table, .. } => Some(Self::Table(Arc::clone(table))),
            Action::LoadProgram { module, .. } => Some(Self::Program(Arc::clone(module))),
            _ => None,
        }
    }

    /// Whether there is another reference.
    fn is_shared(&self) -> bool {
        let count = match self {
            Self::Trajectory(trajectory) => Arc::strong_count(trajectory),
            Self::Table(table) => Arc::strong_count(table),
            Self::Program(module) => Arc::strong_count(module),
        };
        count > 1
    }
}

/// Sending end of the queues, shared by all sources of commands.
#[derive(Debug)]
pub struct Commander {
    doors: Mutex<QueueInputs>,
    numbers: Numbers,
    /// References to each trajectory, table and program that the cycle thread may have, so that it never frees one.
    kept: Mutex<Vec<SharedData>>,
}

#[derive(Debug)]
struct QueueInputs {
    /// Whether commands are accepted: cycles run, or will run.
    is_open: bool,
    /// Halt, quick_stop, disable, abort and deactivate.
    stop: Producer<Command>,
    queue: Producer<Command>,
    stream: triple_buffer::Input<SetpointMailbox>,
    /// Content of the mailbox.
    mail: SetpointMailbox,
}

/// Mailbox of streamed setpoints: for each axis the newest one and its number, which increases with each setpoint of
/// that axis. A stream to one axis therefore neither replaces the setpoint of another axis nor makes it look new.
#[derive(Clone, Debug)]
struct SetpointMailbox {
    /// Source of the newest setpoint.
    source: Source,
    /// Number 0: there was none yet.
    axes: Vec<(u64, Setpoint)>,
}

/// Sequence numbers of commands of all sources.
#[derive(Clone, Debug, Default)]
pub struct Numbers(Arc<AtomicU64>);

impl Numbers {
    /// Reserves `count` numbers and returns the one before the first of them.
    pub fn reserve(&self, count: u64) -> u64 {
        self.0.fetch_add(count, Ordering::Relaxed)
    }
}

/// Receiving end of the queues, in the cycle thread.
#[derive(Debug)]
pub struct CommandQueues {
    stop: Consumer<Command>,
    queue: Consumer<Command>,
    stream: triple_buffer::Output<SetpointMailbox>,
    /// Number of the last setpoint received for each axis.
    seen: Vec<u64>,
    /// New setpoints of the current cycle.
    taken_stream: Setpoints,
    taken_stop: Vec<Command>,
    taken_queue: Vec<Command>,
}

/// Creates the queues of a machine with this number of axes.
pub fn lanes(axes: usize) -> (Commander, CommandQueues) {
    let (stop_in, stop) = RingBuffer::new(MOST_COMMANDS);
    let (queue_in, queue) = RingBuffer::new(MOST_COMMANDS);
    let none = (0, Setpoint { velocity: 0.0, duration: None });
    let mail = SetpointMailbox { source: Source::Machine, axes: vec![none; axes] };
    let (stream_in, stream) = triple_buffer::triple_buffer(&mail);
    let doors = Mutex::new(QueueInputs { is_open: true, stop: stop_in, queue: queue_in, stream: stream_in, mail });
    let room = || Vec::with_capacity(MAX_COMMANDS);
    let (seen, taken_stream) = (vec![0; axes], Setpoints::none(axes));
    let lanes = CommandQueues { stop, queue, stream, seen, taken_stream, taken_stop: room(), taken_queue: room() };
    (Commander { doors, numbers: Numbers::default(), kept: Mutex::default() }, lanes)
}

impl Commander {
    /// Submits a command and returns its sequence number.
    ///
    /// # Errors
    /// Returns an error if its queue is full, or if no cycle would execute it.
    pub fn submit(&self, source: Source, action: Action) -> Result<u64, SubmitError> {
        let mut doors = self.lock_inputs();
        if !doors.is_open {
            return Err(SubmitError::Unconfigured);
        }
        self.push(&mut doors, source, action)
    }

    /// Makes the first cycle begin with a deactivation, before cycles run again. Returns false if commands are accepted
    /// already.
    pub fn deactivate_first(&self) -> bool {
        let mut doors = self.lock_inputs();
        if doors.is_open {
            return false;
        }
        // While commands are not accepted, the queue can only have the deactivation of a failed attempt.
        doors.stop.slots() < MOST_COMMANDS || self.push(&mut doors, Source::Machine, Action::Deactivate).is_ok()
    }

    /// Calls a function while commands are accepted: cycles run until it returns.
    ///
    /// # Errors
    /// Returns an error if no cycle runs; the function was not called.
    pub fn while_open<T>(&self, act: impl FnOnce() -> T) -> Result<T, SubmitError> {
        let doors = self.lock_inputs();
        if doors.is_open { Ok(act()) } else { Err(SubmitError::Unconfigured) }
    }

    /// Accepts commands, because cycles run.
    pub fn open(&self) {
        self.lock_inputs().is_open = true;
    }

    /// Accepts no more commands. Accepted ones are still executed.
    pub fn close(&self) {
        self.lock_inputs().is_open = false;
    }

    /// Returns true if commands are accepted.
    pub fn is_open(&self) -> bool {
        self.lock_inputs().is_open
    }

    fn lock_inputs(&self) -> MutexGuard<'_, QueueInputs> {
        // A poisoned lock means that another thread panicked between two complete pushes: the rings are valid.
        self.doors.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn push(&self, doors: &mut QueueInputs, source: Source, action: Action) -> Result<u64, SubmitError> {
        let lane = if action.stops() { &mut doors.stop } else { &mut doors.queue };
        if lane.is_full() {
            return Err(SubmitError::Full);
        }
        self.kept().extend(SharedData::of(&action));
        let sequence = self.numbers.reserve(1) + 1;
        lane.push(Command { sequence, source, action }).map_err(|_| SubmitError::Full)?;
        Ok(sequence)
    }

    /// Frees the trajectories and tables without another reference.
    pub fn free_unshared(&self) {
        // Without another reference, no thread can clone it.
        self.kept().retain(SharedData::is_shared);
    }

    fn kept(&self) -> MutexGuard<'_, Vec<SharedData>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the source of numbers, for commands that do not pass the queues.
    pub fn numbers(&self) -> Numbers {
        self.numbers.clone()
    }

    /// Replaces the setpoints of these axes; all of them are used in the same cycle.
    ///
    /// # Errors
    /// Returns an error if no cycle runs.
    pub fn stream(&self, setpoints: &Setpoints) -> Result<(), SubmitError> {
        let mut doors = self.lock_inputs();
        // A setpoint that waits until the next configuration would seem new then.
        if !doors.is_open {
            return Err(SubmitError::Unconfigured);
        }
        let QueueInputs { stream, mail, .. } = &mut *doors;
        mail.source = setpoints.source;
        for ((number, newest), new) in mail.axes.iter_mut().zip(&setpoints.axes) {
            if let Some(new) = new {
                (*number, *newest) = (*number + 1, *new);
            }
        }
        stream.input_buffer_mut().clone_from(mail);
        stream.publish();
        Ok(())
    }
}

impl CommandQueues {
    /// Takes the commands of a cycle, stops first; those beyond the maximum wait for the next cycle.
    pub fn take(&mut self) {
        self.take_stops();
        self.take_others(0);
    }

    /// Takes the stops of a cycle. Returns the number of other commands that fit.
    pub fn take_stops(&mut self) -> usize {
        fill(&mut self.taken_stop, &mut self.stop, MAX_COMMANDS);
        MAX_COMMANDS.saturating_sub(self.taken_stop.len())
    }

    /// Takes the other commands, after the stops; leaves room for `kept` commands that are added.
    pub fn take_others(&mut self, kept: usize) {
        let room = MAX_COMMANDS.saturating_sub(self.taken_stop.len() + kept);
        fill(&mut self.taken_queue, &mut self.queue, room);
        self.take_stream();
    }

    fn take_stream(&mut self) {
        self.taken_stream.clear();
        if !self.stream.update() {
            return;
        }
        let SetpointMailbox { source, axes } = self.stream.output_buffer();
        self.taken_stream.source = *source;
        for (((number, newest), seen), taken) in axes.iter().zip(&mut self.seen).zip(&mut self.taken_stream.axes) {
            if std::mem::replace(seen, *number) != *number {
                *taken = Some(*newest);
            }
        }
    }

    /// Whether no command is waiting.
    pub fn are_empty(&self) -> bool {
        self.stop.is_empty() && self.queue.is_empty()
    }

    /// Adds commands that did not pass the queues, after those that did.
    pub fn add(&mut self, commands: Commands<'_>) {
        self.taken_stop.extend_from_slice(commands.stop);
        self.taken_queue.extend_from_slice(commands.queue);
        if let Some(stream) = commands.stream {
            self.taken_stream.merge(stream);
        }
    }

    /// Returns the commands of the current cycle.
    pub fn commands(&self) -> Commands<'_> {
        Commands { stop: &self.taken_stop, queue: &self.taken_queue, stream: self.stream() }
    }

    /// Returns the setpoints of the current cycle, if any.
    pub fn stream(&self) -> Option<&Setpoints> {
        Some(&self.taken_stream).filter(|stream| !stream.is_empty())
    }

    /// Removes the executed setpoints and commands, the commands in the order of their execution.
    pub fn drain(&mut self) -> (Option<&Setpoints>, impl Iterator<Item = Command>) {
        let stream = Some(&self.taken_stream).filter(|stream| !stream.is_empty());
        (stream, self.taken_stop.drain(..).chain(self.taken_queue.drain(..)))
    }
}

fn fill(taken: &mut Vec<Command>, lane: &mut Consumer<Command>, room: usize) {
    while taken.len() < room.min(taken.capacity()) {
        let Ok(command) = lane.pop() else { return };
        taken.push(command);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::object::AxisSet;

    const HALT: Action = Action::Halt(AxisSet::EMPTY);
    const ENABLE: Action = Action::Enable(AxisSet::EMPTY);

    #[test]
    fn stops_come_first_and_numbers_grow_over_both_lanes() {
        let (commander, mut lanes) = lanes(3);
        let numbers: Vec<u64> =
            [ENABLE, HALT, ENABLE].into_iter().map(|action| commander.submit(Source::Ros, action).unwrap()).collect();
        assert_eq!(numbers, [1, 2, 3]);
        lanes.take();
        let order: Vec<u64> = lanes.commands().iter().map(|command| command.sequence).collect();
        assert_eq!(order, [2, 1, 3]);
        lanes.drain().1.for_each(drop);
        lanes.take();
        assert_eq!(lanes.commands().iter().count(), 0);
    }

    #[test]
    fn a_full_lane_refuses_and_the_other_one_still_takes() {
        let (commander, mut lanes) = lanes(3);
        let taken = (0..5000).take_while(|_| commander.submit(Source::Ros, ENABLE).is_ok()).count();
        assert_eq!(taken, 2048);
        assert_eq!(SubmitError::Full.to_string(), "2048 commands wait for the machine already; try again");
        assert_eq!(commander.submit(Source::Ros, HALT), Ok(2049));
        lanes.take();
        assert_eq!(lanes.commands().iter().count(), MAX_COMMANDS, "the rest waits");
        lanes.drain().1.for_each(drop);
        assert!(commander.submit(Source::Ros, ENABLE).is_ok());
    }

    /// Ten clients at once, each with an enable, a reset and an additive goal for each of 64 axes; then each halts each
    /// axis. No command is refused, no cycle gets more than 64, the order is that of submission, and stops are first.
    #[test]
    fn ten_clients_with_64_axes_are_all_served_and_their_stops_first() {
        let (commander, mut lanes) = lanes(64);
        let axes = || (0..64).map(AxisSet::one);
        let (mut others, mut stops) = (Vec::new(), Vec::new());
        for _ in 0..10 {
            for axis in axes() {
                for action in [Action::Enable(axis), Action::ResetErrors(axis), Action::SaveParameters(axis)] {
                    others.push(commander.submit(Source::Ros, action).expect("room for all"));
                }
            }
        }
        // Some cycles later, with the queue still full.
        let mut taken = vec![numbers_of_a_cycle(&mut lanes), numbers_of_a_cycle(&mut lanes)];
        for _ in 0..10 {
            stops.extend(axes().map(|axis| commander.submit(Source::Ros, Action::Halt(axis)).expect("room for all")));
        }
        while !lanes.are_empty() {
            taken.push(numbers_of_a_cycle(&mut lanes));
        }
        assert_eq!(taken.iter().map(Vec::len).max(), Some(64));
        // 1920 other commands and 640 stops.
        assert_eq!(taken.len(), (1920 + 640) / 64);
        let order: Vec<u64> = taken.into_iter().flatten().collect();
        let expected: Vec<u64> = others[..128].iter().chain(&stops).chain(&others[128..]).copied().collect();
        assert_eq!(order, expected);
    }

    fn numbers_of_a_cycle(lanes: &mut CommandQueues) -> Vec<u64> {
        lanes.take();
        lanes.drain().1.map(|command| command.sequence).collect()
    }

    /// Commands of a scenario have reserved room in addition to those of clients; a stop of a client never waits for
    /// them.
    #[test]
    fn room_that_is_kept_for_others_is_none_of_the_stops() {
        let (commander, mut lanes) = lanes(3);
        assert!((0..100).all(|_| commander.submit(Source::Ros, ENABLE).is_ok()));
        assert!((0..10).all(|_| commander.submit(Source::Ros, HALT).is_ok()));
        assert_eq!(lanes.take_stops(), 54);
        lanes.take_others(30);
        let commands = lanes.commands();
        assert_eq!((commands.stop.len(), commands.queue.len()), (10, 24));
    }

    /// Another thread that drops a trajectory never drops the last reference.
    #[test]
    fn a_trajectory_is_freed_here_once_nobody_has_it() {
        use lineshaft_core::position::Position;
        use lineshaft_core::trajectory::{Knot, Track};
        let knot = Knot { position: Position::ZERO, velocity: None, acceleration: None };
        let track = Track { knots: Box::new([knot]), ..Track::default() };
        let trajectory = Arc::new(Trajectory::new(0, Box::new([1]), Box::new([track]), None).expect("a sound one"));
        let watch = Arc::downgrade(&trajectory);
        let (commander, mut lanes) = lanes(3);
        commander.submit(Source::Ros, Action::Trajectory(trajectory)).unwrap();
        commander.free_unshared();
        assert_eq!(watch.strong_count(), 2, "in the lane and here");
        lanes.take();
        lanes.drain().1.for_each(drop);
        assert_eq!(watch.strong_count(), 1);
        commander.free_unshared();
        assert_eq!(watch.strong_count(), 0);
    }

    #[test]
    fn a_closed_door_takes_nothing_and_opens_with_a_deactivation() {
        let (commander, mut lanes) = lanes(3);
        assert_eq!(commander.submit(Source::Ros, ENABLE), Ok(1));
        commander.close();
        for action in [ENABLE, HALT, Action::Activate] {
            assert_eq!(commander.submit(Source::Ros, action), Err(SubmitError::Unconfigured));
        }
        assert_eq!(commander.stream(&set(&[(0, 1.0)])), Err(SubmitError::Unconfigured));
        assert!(!lanes.are_empty());
        assert_eq!(taken(&mut lanes), []);
        assert_eq!(lanes.commands().iter().count(), 1, "what was taken before comes out");
        lanes.drain().1.for_each(drop);
        assert!(lanes.are_empty());

        assert!(commander.deactivate_first() && commander.deactivate_first());
        assert_eq!(commander.submit(Source::Ros, ENABLE), Err(SubmitError::Unconfigured), "not before cycles run");
        commander.open();
        assert!(!commander.deactivate_first(), "they run");
        assert_eq!(commander.submit(Source::Ros, ENABLE), Ok(3));
        lanes.take();
        let order: Vec<_> = lanes.commands().iter().map(|command| (command.sequence, command.action.clone())).collect();
        assert_eq!(order, [(2, Action::Deactivate), (3, ENABLE)]);
    }

    /// Returns setpoints of these axes.
    fn set(velocities: &[(usize, f64)]) -> Setpoints {
        let mut set = Setpoints { source: Source::Ros, ..Setpoints::none(3) };
        velocities.iter().for_each(|&(axis, velocity)| set.axes[axis] = Some(Setpoint { velocity, duration: None }));
        set
    }

    fn taken(lanes: &mut CommandQueues) -> Vec<Option<f64>> {
        lanes.take();
        let axes = lanes.commands().stream.map(|stream| stream.axes.clone()).unwrap_or_default();
        axes.into_iter().map(|axis| axis.map(|setpoint| setpoint.velocity)).collect()
    }

    #[test]
    fn the_newest_setpoint_of_each_axis_wins_and_is_taken_once() {
        let (commander, mut lanes) = lanes(3);
        assert_eq!(taken(&mut lanes), []);
        commander.stream(&set(&[(0, 1.0), (2, 1.0)])).unwrap();
        commander.stream(&set(&[(2, 2.0)])).unwrap();
        assert_eq!(taken(&mut lanes), [Some(1.0), None, Some(2.0)], "who streams to one takes none from another");
        assert_eq!(lanes.commands().stream.unwrap().source, Source::Ros);
        assert_eq!(taken(&mut lanes), [], "nothing new");
        commander.stream(&set(&[(1, 3.0)])).unwrap();
        assert_eq!(taken(&mut lanes), [None, Some(3.0), None], "the others are not new again");
        commander.stream(&set(&[(1, 3.0)])).unwrap();
        assert_eq!(taken(&mut lanes), [None, Some(3.0), None], "the same again is new");
    }

    #[test]
    fn what_a_scenario_streams_comes_on_top() {
        let (commander, mut lanes) = lanes(3);
        commander.stream(&set(&[(0, 1.0), (1, 1.0)])).unwrap();
        lanes.take();
        let played = Setpoints { source: Source::Scenario, ..set(&[(1, 5.0), (2, 6.0)]) };
        lanes.add(Commands { stream: Some(&played), ..Commands::default() });
        let stream = lanes.commands().stream.unwrap();
        assert_eq!(stream.axes, set(&[(0, 1.0), (1, 5.0), (2, 6.0)]).axes);
        assert_eq!(stream.source, Source::Scenario);
        assert_eq!(taken(&mut lanes), []);
    }
}
