//! Sends whole cycles from the cycle thread to the recorder.
//!
//! Each cycle is packed: only what has changed is sent. Events, latches, setpoints and applied commands ("extras") have
//! separate rings, because their number varies; commands are freed by the recorder. When the recorder does not keep up, the cycle is
//! skipped and counted as lost.

use crate::recording::packed::{Packer, Unpacker};
use crate::recording::{CycleTime, FrameDirection, key_cycles};
use lineshaft_core::command::{Command, Setpoint, Setpoints, Source};
use lineshaft_core::drive::{FrameKind, Inputs, Latch, RecordedFrame};
use lineshaft_core::event::Event;
use lineshaft_core::machine::{Machine, State};
use rtrb::{Consumer, Producer, PushError, RingBuffer};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Maximum number of cycles that wait for the recorder: those of this time, in ns,
const TIME_NS: u64 = 2_000_000_000;
/// with this fraction of the maximum size of a cycle (64 axes in a trajectory needed a fortieth),
const SHARE: usize = 32;
/// and this memory, in bytes,
const MEMORY: usize = 32 << 20;
/// but at least this number.
const LEAST: usize = 16;
/// Maximum number of states in transit.
const STATES: usize = 2;
/// Maximum number of commands in transit.
const COMMANDS: usize = 2048;
/// Maximum number of events, of latches and of setpoints in transit.
const EXTRAS: usize = 1 << 14;

/// A cycle in transit. Its packed bytes are in a separate ring.
#[derive(Debug)]
pub struct Head {
    /// Cycle number k.
    pub cycle: u64,
    /// Time t_k.
    pub time: CycleTime,
    /// Number of packed bytes.
    pub length: usize,
    /// Whether it can be unpacked without the cycles before it.
    pub is_key: bool,
    /// State before the cycle; key cycles have it, if a free one was available.
    pub state: Option<Box<State>>,
}

impl Head {
    /// Whether a bag, and so a replay, can begin with it.
    pub fn can_begin(&self) -> bool {
        self.is_key && (self.cycle == 0 || self.state.is_some())
    }
}

/// Sender in the cycle thread.
#[derive(Debug)]
pub struct FrameSender {
    packer: Packer,
    heads: Producer<Head>,
    bytes: Producer<u8>,
    states: Consumer<Box<State>>,
    /// State before the running cycle.
    state: Option<Box<State>>,
    commands: Producer<(u64, Command)>,
    /// Commands for which the recorder has no space. Another thread frees them.
    spent: Producer<Command>,
    events: Producer<Event>,
    latches: Producer<(u64, Latch)>,
    setpoints: Producer<(u64, StreamedSetpoint)>,
    key_cycles: u64,
    lost: Arc<AtomicU64>,
}

/// A setpoint of a cycle: source of the newest setpoint of the cycle, axis, and setpoint.
pub type StreamedSetpoint = (Source, u16, Setpoint);

/// Frees the commands for which the recorder had no space.
#[derive(Debug)]
pub struct Spent(Consumer<Command>);

impl Spent {
    /// Frees all received commands.
    pub fn free(&mut self) {
        while self.0.pop().is_ok() {}
    }
}

/// Receiver in the recorder.
#[derive(Debug)]
pub struct FrameReceiver {
    heads: Consumer<Head>,
    bytes: Consumer<u8>,
    states: Producer<Box<State>>,
    commands: Consumer<(u64, Command)>,
    events: Consumer<Event>,
    latches: Consumer<(u64, Latch)>,
    setpoints: Consumer<(u64, StreamedSetpoint)>,
    unpacker: Unpacker,
    lost: Arc<AtomicU64>,
}

/// Contents of a received cycle. Its memory is reused.
#[derive(Debug, Default)]
pub struct Taken {
    /// Packed inputs and signals.
    pub bytes: Vec<u8>,
    /// Extras of the cycle.
    pub extras: Extras,
    /// Events of earlier cycles that were lost.
    pub left_out: Vec<Event>,
}

/// Parts that few cycles have.
#[derive(Clone, Debug, Default)]
pub struct Extras {
    /// Commands in the order in which they were applied.
    pub commands: Vec<Command>,
    /// Events in their order.
    pub events: Vec<Event>,
    /// Latches of the inputs.
    pub latches: Vec<Latch>,
    /// New streamed setpoints.
    pub setpoints: Vec<StreamedSetpoint>,
    /// Frames of the buses; the recorder adds them.
    pub frames: BusFrames,
}

impl Extras {
    /// Whether the cycle has no extras.
    pub fn is_empty(&self) -> bool {
        let Self { commands, events, latches, setpoints, frames } = self;
        commands.is_empty() && events.is_empty() && latches.is_empty() && setpoints.is_empty() && frames.is_empty()
    }

    /// Its memory in bytes, without the heap memory of the commands.
    pub fn memory(&self) -> usize {
        let Self { commands, events, latches, setpoints, frames } = self;
        size_of::<Self>()
            + commands.capacity() * size_of::<Command>()
            + events.capacity() * size_of::<Event>()
            + latches.capacity() * size_of::<Latch>()
            + setpoints.capacity() * size_of::<StreamedSetpoint>()
            + frames.memory()
    }
}

/// A frame of a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusFrame<'a> {
    /// Index of the bus.
    pub bus: usize,
    /// Direction.
    pub way: FrameDirection,
    /// Time after the beginning of the cycle, in ns.
    pub offset_ns: i64,
    /// Kind, which defines the bytes.
    pub kind: FrameKind,
    /// Bytes.
    pub bytes: &'a [u8],
}

/// Frames of buses, in their order, with their bytes one after the other.
#[derive(Clone, Debug, Default)]
pub struct BusFrames {
    heads: Vec<BusFrameHead>,
    bytes: Vec<u8>,
}

/// A frame without its bytes, in few bytes: the flight recorder keeps millions.
#[derive(Clone, Copy, Debug)]
struct BusFrameHead {
    offset_ns: i64,
    bus: u16,
    /// Number of its bytes.
    length: u16,
    kind: FrameKind,
    way: FrameDirection,
}

impl BusFrames {
    /// Adds a frame of the bus with this index.
    pub fn push(&mut self, bus: usize, kind: FrameKind, frame: RecordedFrame<'_>) {
        let RecordedFrame { is_sent, offset_ns, bytes } = frame;
        let way = if is_sent { FrameDirection::Sent } else { FrameDirection::Received };
        // No bus has frames of 64 kB, and no cell as many buses.
        let bytes = bytes.get(..usize::from(u16::MAX)).unwrap_or(bytes);
        let (bus, length) = (u16::try_from(bus).unwrap_or(u16::MAX), bytes.len() as u16);
        self.heads.push(BusFrameHead { offset_ns, bus, length, kind, way });
        self.bytes.extend_from_slice(bytes);
    }

    /// Returns the frames in their order.
    pub fn iter(&self) -> impl Iterator<Item = BusFrame<'_>> {
        let mut rest = self.bytes.as_slice();
        self.heads.iter().map(move |head| {
            let BusFrameHead { bus, way, kind, offset_ns, length } = *head;
            // The bytes of all frames are there.
            let (bytes, after) = rest.split_at_checked(length.into()).unwrap_or_default();
            rest = after;
            BusFrame { bus: bus.into(), way, offset_ns, kind, bytes }
        })
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// Removes all frames, and keeps the memory.
    pub fn clear(&mut self) {
        self.heads.clear();
        self.bytes.clear();
    }

    /// Heap memory, in bytes.
    fn memory(&self) -> usize {
        self.heads.capacity() * size_of::<BusFrameHead>() + self.bytes.capacity()
    }
}

/// Creates sender and receiver for one machine.
pub fn frames(machine: &Machine) -> (FrameSender, FrameReceiver, Spent) {
    let cycle_ns = machine.config().cycle_ns;
    let inputs = machine.inputs();
    let packer = Packer::new(&inputs, machine.board());
    let count = usize::try_from(TIME_NS / cycle_ns.max(1)).unwrap_or(usize::MAX).max(LEAST);
    let memory = count.saturating_mul(packer.most() / SHARE).min(MEMORY).max(LEAST * packer.most());
    let (heads, heads_out) = RingBuffer::new(count);
    let (bytes, bytes_out) = RingBuffer::new(memory);
    let (mut states_in, states) = RingBuffer::new(STATES);
    (0..STATES).for_each(|_| drop(states_in.push(Box::new(machine.state().clone()))));
    let (commands, commands_out) = RingBuffer::new(COMMANDS);
    let (events, events_out) = RingBuffer::new(EXTRAS);
    let (latches, latches_out) = RingBuffer::new(EXTRAS);
    let (setpoints, setpoints_out) = RingBuffer::new(EXTRAS);
    let (spent, spent_out) = RingBuffer::new(COMMANDS);
    let lost = Arc::<AtomicU64>::default();
    let sender = FrameSender {
        packer,
        heads,
        bytes,
        states,
        state: None,
        commands,
        spent,
        events,
        latches,
        setpoints,
        key_cycles: key_cycles(cycle_ns),
        lost: Arc::clone(&lost),
    };
    let receiver = FrameReceiver {
        heads: heads_out,
        bytes: bytes_out,
        states: states_in,
        commands: commands_out,
        events: events_out,
        latches: latches_out,
        setpoints: setpoints_out,
        unpacker: Unpacker::new(&inputs, machine.board()),
        lost,
    };
    (sender, receiver, Spent(spent_out))
}

impl FrameSender {
    /// Stores the state of the machine before a key cycle.
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

    /// Sends the cycle that has just run. `commands` are those that were applied; the receiver frees them.
    pub fn send(
        &mut self,
        time: CycleTime,
        inputs: &Inputs,
        machine: &Machine,
        stream: Option<&Setpoints>,
        commands: impl Iterator<Item = Command>,
    ) {
        if !self.send_extras(inputs, machine, stream, commands) || self.is_full() {
            self.lost.fetch_add(1, Ordering::Relaxed);
            return;
        }
        let cycle = inputs.cycle;
        let is_key = cycle.is_multiple_of(self.key_cycles);
        let packed = self.packer.pack(inputs, machine.board(), is_key);
        let state = if is_key { self.state.take() } else { None };
        // There is room for both. The bytes are sent first, so that they are available when the head is.
        let _ = self.bytes.push_entire_slice(packed);
        drop(self.heads.push(Head { cycle, time, length: packed.len(), is_key, state }));
    }

    fn is_full(&self) -> bool {
        self.heads.is_full() || self.bytes.slots() < self.packer.most()
    }

    /// Sends the extras. Returns false if some of them have no space.
    fn send_extras(
        &mut self,
        inputs: &Inputs,
        machine: &Machine,
        stream: Option<&Setpoints>,
        commands: impl Iterator<Item = Command>,
    ) -> bool {
        let cycle = inputs.cycle;
        let mut is_whole = true;
        for command in commands {
            if let Err(PushError::Full((_, command))) = self.commands.push((cycle, command)) {
                is_whole = false;
                // Freed here only if recorder and bridge have both been blocked for a long time.
                drop(self.spent.push(command));
            }
        }
        for &event in machine.events() {
            is_whole &= self.events.push(event).is_ok();
        }
        for &latch in &inputs.latch {
            is_whole &= self.latches.push((cycle, latch)).is_ok();
        }
        if let Some(Setpoints { source, axes }) = stream {
            for (axis, setpoint) in (0..).zip(axes).filter_map(|(axis, setpoint)| Some((axis, (*setpoint)?))) {
                is_whole &= self.setpoints.push((cycle, (*source, axis, setpoint))).is_ok();
            }
        }
        is_whole
    }
}

impl FrameReceiver {
    /// Returns the next cycle, with its contents in `taken`.
    pub fn take(&mut self, taken: &mut Taken) -> Option<Head> {
        let head = self.heads.pop().ok()?;
        taken.bytes.resize(head.length, 0);
        // They were sent before the head.
        let _ = self.bytes.pop_entire_slice(&mut taken.bytes);
        let extras = &mut taken.extras;
        extras.frames.clear();
        extras.events.clear();
        taken.left_out.clear();
        while self.events.peek().is_ok_and(|event| event.cycle <= head.cycle) {
            let Ok(event) = self.events.pop() else { break };
            let of = if event.cycle == head.cycle { &mut extras.events } else { &mut taken.left_out };
            of.push(event);
        }
        take_those_of(head.cycle, &mut self.commands, &mut extras.commands);
        take_those_of(head.cycle, &mut self.latches, &mut extras.latches);
        take_those_of(head.cycle, &mut self.setpoints, &mut extras.setpoints);
        Some(head)
    }

    /// Returns an unpacker of these cycles, before its first one.
    pub fn unpacker(&self) -> Unpacker {
        self.unpacker.clone()
    }

    /// Returns the state of a cycle to the sender for reuse.
    pub fn give_back(&mut self, state: Box<State>) {
        drop(self.states.push(state));
    }

    /// Number of cycles that were lost so far.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

/// Takes the entries of a cycle, and drops those of lost cycles before it.
fn take_those_of<T>(cycle: u64, from: &mut Consumer<(u64, T)>, to: &mut Vec<T>) {
    to.clear();
    while from.peek().is_ok_and(|(of, _)| *of <= cycle) {
        let Ok((of, thing)) = from.pop() else { return };
        if of == cycle {
            to.push(thing);
        }
    }
}

/// Returns the setpoints of a cycle as the machine received them; `None` if it received none.
pub fn stream(setpoints: &[StreamedSetpoint], axes: usize) -> Option<Setpoints> {
    let (source, ..) = setpoints.first()?;
    let mut stream = Setpoints { source: *source, ..Setpoints::none(axes) };
    for (_, axis, setpoint) in setpoints {
        if let Some(place) = stream.axes.get_mut(usize::from(*axis)) {
            *place = Some(*setpoint);
        }
    }
    Some(stream)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use lineshaft_core::command::{Action, Commands};
    use lineshaft_core::drive::Edge;
    use lineshaft_core::object::{AxisSet, Object};

    fn machine() -> Machine {
        Machine::new(Cell::demo().machine).unwrap()
    }

    #[test]
    fn frames_of_buses_keep_their_order_and_bytes() {
        let mut frames = BusFrames::default();
        let frame = |is_sent, offset_ns, bytes| RecordedFrame { is_sent, offset_ns, bytes };
        frames.push(1, FrameKind(227), frame(true, -5, &[1, 2, 3]));
        frames.push(0, FrameKind(1), frame(false, 9, &[]));
        frames.push(0, FrameKind(1), frame(false, 10, &[4]));
        let expected =
            |bus, kind, way, offset_ns, bytes| BusFrame { bus, way, offset_ns, kind: FrameKind(kind), bytes };
        let expected = [
            expected(1, 227, FrameDirection::Sent, -5, &[1, 2, 3][..]),
            expected(0, 1, FrameDirection::Received, 9, &[]),
            expected(0, 1, FrameDirection::Received, 10, &[4]),
        ];
        assert_eq!(frames.iter().collect::<Vec<_>>(), expected);
        frames.clear();
        assert!(frames.is_empty() && frames.iter().next().is_none());
    }

    fn latch(cycle: u64) -> Latch {
        Latch { object: Object::Axis(1), edge: Edge::Rising, age_ns: None, position: Some(cycle as i64) }
    }

    /// Runs a cycle with one command and sends it.
    fn run(machine: &mut Machine, sender: &mut FrameSender) -> Inputs {
        let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
        inputs.begin(machine.next_cycle(), 0);
        inputs.drive[0].count = -5 * inputs.cycle as i64;
        if inputs.cycle.is_multiple_of(3) {
            inputs.add_latch(latch(inputs.cycle));
        }
        let action = Action::Enable(AxisSet::one(0));
        let commands = [Command { sequence: inputs.cycle + 1, source: Source::Cli, action }];
        sender.before(machine);
        let mut stream = Setpoints { source: Source::Ros, ..Setpoints::none(4) };
        stream.axes[1] = Some(Setpoint { velocity: inputs.cycle as f64, duration: Some(inputs.cycle) });
        // Every second cycle has new setpoints.
        let stream = Some(&stream).filter(|_| inputs.cycle.is_multiple_of(2));
        machine.cycle(&inputs, Commands { stream, ..Commands::queue(&commands) }, &mut outputs);
        sender.send(CycleTime::same(7 * inputs.cycle), &inputs, machine, stream, commands.into_iter());
        inputs
    }

    #[test]
    fn a_cycle_arrives_as_the_machine_took_and_did_it() {
        let mut machine = machine();
        let (mut sender, mut receiver, _spent) = frames(&machine);
        let (mut unpacker, mut taken) = (receiver.unpacker(), Taken::default());
        for cycle in 0..2500_u64 {
            let before = postcard::to_allocvec(machine.state()).unwrap();
            let mut inputs = run(&mut machine, &mut sender);
            let head = receiver.take(&mut taken).unwrap();
            assert_eq!(
                (head.cycle, head.time, head.is_key),
                (cycle, CycleTime::same(7 * cycle), cycle.is_multiple_of(1000))
            );
            unpacker.unpack(head.cycle, &taken.bytes, head.is_key);
            assert_eq!(taken.extras.latches, inputs.latch);
            inputs.latch.clear();
            assert_eq!((&unpacker.inputs, &unpacker.board), (&inputs, machine.board()));
            let setpoint = Setpoint { velocity: cycle as f64, duration: Some(cycle) };
            let streamed = Setpoints { source: Source::Ros, axes: vec![None, Some(setpoint), None, None] };
            let streamed = Some(streamed).filter(|_| cycle.is_multiple_of(2));
            assert_eq!(stream(&taken.extras.setpoints, 4), streamed, "cycle {cycle}");
            assert_eq!(taken.extras.events, machine.events());
            assert_eq!(taken.extras.commands.iter().map(|command| command.sequence).collect::<Vec<_>>(), [cycle + 1]);
            let state = head.state.as_ref().map(|state| postcard::to_allocvec(state).unwrap());
            assert_eq!(state, cycle.is_multiple_of(1000).then_some(before));
            head.state.into_iter().for_each(|state| receiver.give_back(state));
        }
        assert_eq!(receiver.lost(), 0);
        assert!(receiver.take(&mut taken).is_none());
    }

    #[test]
    fn blocked_recorder_loses_counted_cycles_and_continues() {
        let mut machine = machine();
        let (mut sender, mut receiver, _spent) = frames(&machine);
        (0..2100).for_each(|_| drop(run(&mut machine, &mut sender)));
        let (mut unpacker, mut taken, mut expected) = (receiver.unpacker(), Taken::default(), 0);
        while let Some(head) = receiver.take(&mut taken) {
            assert_eq!(head.cycle, expected);
            unpacker.unpack(head.cycle, &taken.bytes, head.is_key);
            expected += 1;
        }
        assert_eq!((expected, receiver.lost()), (2000, 100), "2 s fit");
        // The extras of the lost cycles are dropped. The next cycle has only its own, and is packed relative to the
        // last one that was sent.
        run(&mut machine, &mut sender);
        let head = receiver.take(&mut taken).unwrap();
        assert_eq!(head.cycle, 2100);
        assert_eq!(taken.extras.commands.iter().map(|command| command.sequence).collect::<Vec<_>>(), [2101]);
        assert!(taken.extras.events.iter().all(|event| event.cycle == 2100));
        assert_eq!(taken.extras.latches, [latch(2100)]);
        unpacker.unpack(head.cycle, &taken.bytes, head.is_key);
        assert_eq!(&unpacker.board, machine.board());
    }
}
