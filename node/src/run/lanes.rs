//! The three ways of commands into the cycle thread.

use lineshaft_core::command::{Action, Command, Commands, Setpoints, Source};
use lineshaft_core::machine::MAX_COMMANDS;
use lineshaft_ros::surface::host::Busy;
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Room of the stop lane: halt, quick_stop and disable.
const STOP_ROOM: usize = 64;
/// Room of the queue.
const QUEUE_ROOM: usize = 256;

/// The end of the lanes at which commands go in; shared by all who give commands.
#[derive(Debug)]
pub struct Commander {
    doors: Mutex<Doors>,
    numbers: Numbers,
}

#[derive(Debug)]
struct Doors {
    stop: Producer<Command>,
    queue: Producer<Command>,
    stream: triple_buffer::Input<Setpoints>,
}

/// The sequence numbers of commands, whoever gives them.
#[derive(Clone, Debug, Default)]
pub struct Numbers(Arc<AtomicU64>);

impl Numbers {
    /// Sets `count` numbers aside and returns the one before the first of them.
    pub fn reserve(&self, count: u64) -> u64 {
        self.0.fetch_add(count, Ordering::Relaxed)
    }
}

/// The end of the lanes in the cycle thread.
#[derive(Debug)]
pub struct Lanes {
    stop: Consumer<Command>,
    queue: Consumer<Command>,
    stream: triple_buffer::Output<Setpoints>,
    taken_stop: Vec<Command>,
    taken_queue: Vec<Command>,
}

/// Makes the lanes of one machine.
pub fn lanes() -> (Commander, Lanes) {
    let (stop_in, stop) = RingBuffer::new(STOP_ROOM);
    let (queue_in, queue) = RingBuffer::new(QUEUE_ROOM);
    let (stream_in, stream) = triple_buffer::triple_buffer(&Setpoints::default());
    let doors = Mutex::new(Doors { stop: stop_in, queue: queue_in, stream: stream_in });
    let room = || Vec::with_capacity(MAX_COMMANDS);
    let lanes = Lanes { stop, queue, stream, taken_stop: room(), taken_queue: room() };
    (Commander { doors, numbers: Numbers::default() }, lanes)
}

impl Commander {
    /// Hands a command over and returns its sequence number.
    ///
    /// # Errors
    /// Its lane is full.
    pub fn submit(&self, source: Source, action: Action) -> Result<u64, Busy> {
        // A poisoned lock means that another thread panicked between two whole pushes: the rings are sound.
        let mut doors = self.doors.lock().unwrap_or_else(PoisonError::into_inner);
        let stops = matches!(action, Action::Halt(_) | Action::QuickStop(_) | Action::Disable(_));
        let lane = if stops { &mut doors.stop } else { &mut doors.queue };
        if lane.is_full() {
            return Err(Busy);
        }
        let sequence = self.numbers.reserve(1) + 1;
        lane.push(Command { sequence, source, action }).map_err(|_| Busy)?;
        Ok(sequence)
    }

    /// Where the numbers come from, for whoever gives commands past the lanes.
    pub fn numbers(&self) -> Numbers {
        self.numbers.clone()
    }

    /// Puts newer streamed setpoints in the place of the last ones.
    pub fn stream(&self, setpoints: Setpoints) {
        let mut doors = self.doors.lock().unwrap_or_else(PoisonError::into_inner);
        doors.stream.write(setpoints);
    }
}

impl Lanes {
    /// Takes what is due for a cycle, the stop lane first; what does not fit waits for the next cycle.
    pub fn take(&mut self) {
        fill(&mut self.taken_stop, &mut self.stop, MAX_COMMANDS);
        let left = MAX_COMMANDS - self.taken_stop.len();
        fill(&mut self.taken_queue, &mut self.queue, left);
        self.stream.update();
    }

    /// Adds commands that did not come through the lanes; they come after those that did.
    pub fn add(&mut self, commands: Commands<'_>) {
        self.taken_stop.extend_from_slice(commands.stop);
        self.taken_queue.extend_from_slice(commands.queue);
    }

    /// What was taken.
    pub fn commands(&self) -> Commands<'_> {
        Commands { stop: &self.taken_stop, queue: &self.taken_queue, stream: Some(self.stream.output_buffer()) }
    }

    /// Gives away what was taken and has applied, in the order in which it did.
    pub fn drain(&mut self) -> impl Iterator<Item = Command> {
        self.taken_stop.drain(..).chain(self.taken_queue.drain(..))
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
        let (commander, mut lanes) = lanes();
        let numbers: Vec<u64> =
            [ENABLE, HALT, ENABLE].into_iter().map(|action| commander.submit(Source::Ros, action).unwrap()).collect();
        assert_eq!(numbers, [1, 2, 3]);
        lanes.take();
        let order: Vec<u64> = lanes.commands().iter().map(|command| command.sequence).collect();
        assert_eq!(order, [2, 1, 3]);
        lanes.drain().for_each(drop);
        lanes.take();
        assert_eq!(lanes.commands().iter().count(), 0);
    }

    #[test]
    fn a_full_lane_refuses_and_the_other_one_still_takes() {
        let (commander, mut lanes) = lanes();
        let taken = (0..1000).take_while(|_| commander.submit(Source::Ros, ENABLE).is_ok()).count();
        assert_eq!(taken, QUEUE_ROOM);
        assert_eq!(commander.submit(Source::Ros, HALT), Ok(QUEUE_ROOM as u64 + 1));
        lanes.take();
        assert_eq!(lanes.commands().iter().count(), MAX_COMMANDS, "the rest waits");
        lanes.drain().for_each(drop);
        assert!(commander.submit(Source::Ros, ENABLE).is_ok());
    }

    #[test]
    fn the_newest_setpoints_win() {
        let (commander, mut lanes) = lanes();
        for generation in 1..=3 {
            commander.stream(Setpoints { generation, velocity: vec![Some(1.0)] });
        }
        lanes.take();
        assert_eq!(lanes.commands().stream.unwrap().generation, 3);
        lanes.take();
        assert_eq!(lanes.commands().stream.unwrap().generation, 3, "nothing newer: the same again");
    }
}
