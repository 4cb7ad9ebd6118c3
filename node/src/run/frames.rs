//! The way of whole cycles out of the cycle thread, for the recorder.
//!
//! Frames go round. Events and applied commands travel beside them in rings of their own, because their number differs;
//! commands are freed where they arrive. When the recorder does not keep up, the cycle is left out and counted.

use super::pool::{Emptier, Filler, Room, pool};
use crate::recording::key_cycles;
use lineshaft_core::command::{Command, Setpoints};
use lineshaft_core::drive::Inputs;
use lineshaft_core::event::Event;
use lineshaft_core::machine::{Machine, State};
use lineshaft_core::signal::Board;
use rtrb::{Consumer, Producer, PushError, RingBuffer};

/// Cycles that may wait for the recorder.
const ROOM: Room = Room { time_ns: 2_000_000_000, bytes: 128 << 20, least: 64 };
/// States that may be on their way.
const STATES: usize = 4;
/// Commands that may be on their way.
const COMMANDS: usize = 2048;
/// Events that may be on their way.
const EVENTS: usize = 1 << 15;

/// One cycle on its way.
#[derive(Debug)]
pub struct Frame {
    /// t_k: nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
    /// As the machine took them.
    pub inputs: Inputs,
    /// Streamed setpoints that were new, if any.
    pub stream: Setpoints,
    /// At the end of the cycle.
    pub board: Board,
    /// Before the cycle; key cycles have it, if one was free.
    pub state: Option<Box<State>>,
}

/// The end in the cycle thread.
#[derive(Debug)]
pub struct FrameSender {
    pool: Filler<Frame>,
    states: Consumer<Box<State>>,
    /// The state before the cycle that runs.
    state: Option<Box<State>>,
    commands: Producer<(u64, Command)>,
    /// Commands for which the recorder leaves no room, on their way to be freed elsewhere.
    spent: Producer<Command>,
    events: Producer<Event>,
    key_cycles: u64,
}

/// Frees the commands for which the recorder has left no room.
#[derive(Debug)]
pub struct Spent(Consumer<Command>);

impl Spent {
    /// Frees what has come.
    pub fn free(&mut self) {
        while self.0.pop().is_ok() {}
    }
}

/// The end in the recorder.
#[derive(Debug)]
pub struct FrameReceiver {
    pool: Emptier<Frame>,
    states: Producer<Box<State>>,
    commands: Consumer<(u64, Command)>,
    events: Consumer<Event>,
    /// Room for what belongs to the next frame.
    room: Taken,
}

/// What belongs to a frame.
#[derive(Debug, Default)]
pub struct Taken {
    /// In the order in which they applied.
    pub commands: Vec<Command>,
    /// In their order.
    pub events: Vec<Event>,
    /// Events of cycles before it that were left out.
    pub left_out: Vec<Event>,
}

/// Makes the way for one machine.
pub fn frames(machine: &Machine) -> (FrameSender, FrameReceiver, Spent) {
    let axes = machine.config().axes.len();
    let frame = || {
        let (inputs, stream, board) = (machine.inputs(), Setpoints::none(axes), machine.board().clone());
        Frame { stamp_ns: 0, inputs, stream, board, state: None }
    };
    let cycle_ns = machine.config().cycle_ns;
    let bytes = size_of::<Frame>() + size_of_val(machine.inputs().drive.as_slice()) + 8 * machine.board().len();
    let bytes = bytes + size_of_val(Setpoints::none(axes).axes.as_slice());
    let (filler, emptier) = pool(ROOM.count(cycle_ns, bytes), frame);
    let (mut states_in, states) = RingBuffer::new(STATES);
    (0..STATES).for_each(|_| drop(states_in.push(Box::new(machine.state().clone()))));
    let (commands, commands_out) = RingBuffer::new(COMMANDS);
    let (events, events_out) = RingBuffer::new(EVENTS);
    let (spent, spent_out) = RingBuffer::new(COMMANDS);
    let key_cycles = key_cycles(cycle_ns);
    let sender = FrameSender { pool: filler, states, state: None, commands, spent, events, key_cycles };
    let receiver = FrameReceiver {
        pool: emptier,
        states: states_in,
        commands: commands_out,
        events: events_out,
        room: Taken::default(),
    };
    (sender, receiver, Spent(spent_out))
}

impl FrameSender {
    /// Keeps the state of the machine before a key cycle.
    pub fn before(&mut self, machine: &Machine) {
        if !machine.next_cycle().is_multiple_of(self.key_cycles) {
            return;
        }
        if self.state.is_none() {
            self.state = self.states.pop().ok();
        }
        if let Some(state) = &mut self.state {
            state.as_mut().clone_from(machine.state());
        }
    }

    /// Sends the cycle that has just run. `commands` are those that applied; they are freed by the receiver.
    pub fn send(
        &mut self,
        stamp_ns: u64,
        inputs: &Inputs,
        machine: &Machine,
        stream: Option<&Setpoints>,
        commands: impl Iterator<Item = Command>,
    ) {
        let cycle = inputs.cycle;
        let mut is_whole = true;
        for command in commands {
            if let Err(PushError::Full((_, command))) = self.commands.push((cycle, command)) {
                is_whole = false;
                // Freed here only when recorder and bridge have both stood still for long.
                drop(self.spent.push(command));
            }
        }
        for &event in machine.events() {
            is_whole &= self.events.push(event).is_ok();
        }
        if !is_whole {
            return self.pool.leave_out();
        }
        self.pool.send(|frame| {
            frame.stamp_ns = stamp_ns;
            frame.inputs.copy_from(inputs);
            frame.stream.clear();
            if let Some(stream) = stream {
                frame.stream.take(stream);
            }
            frame.board.copy_from(machine.board());
            frame.state = if cycle.is_multiple_of(self.key_cycles) { self.state.take() } else { None };
        });
    }
}

impl FrameReceiver {
    /// The next cycle, with its commands and events.
    pub fn take(&mut self) -> Option<(Box<Frame>, Taken)> {
        let frame = self.pool.take()?;
        let cycle = frame.inputs.cycle;
        let mut taken = std::mem::take(&mut self.room);
        // What stands before belongs to cycles that were left out.
        while self.commands.peek().is_ok_and(|(of, _)| *of <= cycle) {
            let Ok((of, command)) = self.commands.pop() else { break };
            if of == cycle {
                taken.commands.push(command);
            }
        }
        while self.events.peek().is_ok_and(|event| event.cycle <= cycle) {
            let Ok(event) = self.events.pop() else { break };
            let of = if event.cycle == cycle { &mut taken.events } else { &mut taken.left_out };
            of.push(event);
        }
        Some((frame, taken))
    }

    /// Gives a frame back to be filled again.
    pub fn give_back(&mut self, mut frame: Box<Frame>, mut taken: Taken) {
        if let Some(state) = frame.state.take() {
            drop(self.states.push(state));
        }
        self.pool.give_back(frame);
        taken.commands.clear();
        taken.events.clear();
        taken.left_out.clear();
        self.room = taken;
    }

    /// Cycles that were left out so far.
    pub fn lost(&self) -> u64 {
        self.pool.lost()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use lineshaft_core::command::{Action, Commands, Setpoint, Source};
    use lineshaft_core::object::AxisSet;

    fn machine() -> Machine {
        Machine::new(Cell::demo().machine).unwrap()
    }

    /// Runs a cycle with one command and sends it.
    fn run(machine: &mut Machine, sender: &mut FrameSender) {
        let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
        inputs.cycle = machine.next_cycle();
        let action = Action::Enable(AxisSet::one(0));
        let commands = [Command { sequence: inputs.cycle + 1, source: Source::Cli, action }];
        sender.before(machine);
        let mut stream = Setpoints { source: Source::Ros, ..Setpoints::none(4) };
        stream.axes[1] = Some(Setpoint { velocity: inputs.cycle as f64, duration: Some(inputs.cycle) });
        // Every second cycle has something new.
        let stream = Some(&stream).filter(|_| inputs.cycle.is_multiple_of(2));
        machine.cycle(&inputs, Commands { stream, ..Commands::queue(&commands) }, &mut outputs);
        sender.send(7 * inputs.cycle, &inputs, machine, stream, commands.into_iter());
    }

    #[test]
    fn a_frame_holds_what_the_machine_took_and_did() {
        let mut machine = machine();
        let (mut sender, mut receiver, _spent) = frames(&machine);
        for cycle in 0..2500 {
            let before = postcard::to_allocvec(machine.state()).unwrap();
            run(&mut machine, &mut sender);
            let (frame, taken) = receiver.take().unwrap();
            assert_eq!((frame.inputs.cycle, frame.stamp_ns), (cycle, 7 * cycle));
            assert_eq!(&frame.board, machine.board());
            let setpoint = Setpoint { velocity: cycle as f64, duration: Some(cycle) };
            let streamed = Some(setpoint).filter(|_| cycle.is_multiple_of(2));
            assert_eq!(frame.stream.axes, [None, streamed, None, None], "cycle {cycle}");
            assert_eq!(taken.events, machine.events());
            assert_eq!(taken.commands.iter().map(|command| command.sequence).collect::<Vec<_>>(), [cycle + 1]);
            let state = frame.state.as_ref().map(|state| postcard::to_allocvec(state).unwrap());
            assert_eq!(state, cycle.is_multiple_of(1000).then_some(before));
            receiver.give_back(frame, taken);
        }
        assert_eq!(receiver.lost(), 0);
        assert!(receiver.take().is_none());
    }

    #[test]
    fn a_recorder_that_stands_still_costs_cycles_which_are_counted_and_then_goes_on() {
        let mut machine = machine();
        let (mut sender, mut receiver, _spent) = frames(&machine);
        (0..2100).for_each(|_| run(&mut machine, &mut sender));
        let mut expected = 0;
        while let Some((frame, taken)) = receiver.take() {
            assert_eq!(frame.inputs.cycle, expected);
            expected += 1;
            receiver.give_back(frame, taken);
        }
        assert_eq!((expected, receiver.lost()), (2000, 100), "2 s fit");
        // Commands and events of the cycles that were left out are gone; the next cycle has its own.
        run(&mut machine, &mut sender);
        let (frame, taken) = receiver.take().unwrap();
        assert_eq!(frame.inputs.cycle, 2100);
        assert_eq!(taken.commands.iter().map(|command| command.sequence).collect::<Vec<_>>(), [2101]);
        assert!(taken.events.iter().all(|event| event.cycle == 2100));
    }
}
