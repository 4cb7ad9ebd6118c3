//! The cycle thread: absolute deadlines, one cycle after the other, and nothing that could make it wait.

use super::frames::FrameSender;
use super::lanes::{Lanes, Numbers};
use super::realtime::{self, Processor};
use crate::scenario::{Player, Report};
use lineshaft_core::drive::{Backend, Inputs, Outputs};
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::sim::Plant;
use lineshaft_ros::surface::host::{Snapshot, StampedEvent};
use rtrb::Producer;
use rustix::thread::clock_nanosleep_absolute;
use rustix::time::{ClockId, Timespec, clock_gettime};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;

/// How well the thread keeps its time; written by it, read by anybody.
#[derive(Debug, Default)]
pub struct Statistics {
    /// Cycles run.
    pub cycles: AtomicU64,
    /// Cycles missed.
    pub missed: AtomicU64,
    /// Latest wake-up after its deadline (ns).
    pub worst_lateness_ns: AtomicU64,
    /// Longest cycle, from its wake-up to its end (ns).
    pub worst_duration_ns: AtomicU64,
    /// Events that found the ring full.
    pub events_lost: AtomicU64,
}

/// A scenario that plays on the running machine. It takes memory, so such a run is for rehearsals.
pub struct Play {
    /// The scenario.
    pub player: Player,
    /// Numbers of its commands.
    pub numbers: Numbers,
    /// Where its report goes when it is over.
    pub report: Sender<Report>,
}

/// Numbers that are set aside for the scenario's commands of one cycle.
const PLAYED_COMMANDS: u64 = 1024;

/// Everything that the cycle thread owns.
pub struct CycleThread {
    /// The machine.
    pub machine: Machine,
    /// Simulation of its drives.
    pub plant: Plant,
    /// A scenario that plays on it.
    pub play: Option<Play>,
    /// Ways in.
    pub lanes: Lanes,
    /// Way out of events.
    pub events: Producer<StampedEvent>,
    /// Way out of whole cycles, for the recorder.
    pub frames: FrameSender,
    /// Way out of signals.
    pub snapshot: triple_buffer::Input<Snapshot>,
    /// Way out of parameters.
    pub parameters: triple_buffer::Input<ParameterImage>,
    /// The version that went out last.
    pub published: u64,
    /// Set from outside to end it.
    pub stop: Arc<AtomicBool>,
    /// How it does.
    pub statistics: Arc<Statistics>,
    /// Where it runs.
    pub processor: Processor,
}

fn nanoseconds(clock: ClockId) -> u64 {
    let now = clock_gettime(clock);
    (now.tv_sec.unsigned_abs()).saturating_mul(1_000_000_000).saturating_add(now.tv_nsec.unsigned_abs())
}

fn sleep_until(deadline: u64) {
    let request = Timespec {
        tv_sec: (deadline / 1_000_000_000).cast_signed(),
        tv_nsec: (deadline % 1_000_000_000).cast_signed(),
    };
    // Interrupted by a signal: the deadline is absolute, so sleep on.
    while clock_nanosleep_absolute(ClockId::Monotonic, &request) == Err(rustix::io::Errno::INTR) {}
}

impl CycleThread {
    /// Runs until it is told to stop. `ready` gets what the system did not grant, before the first cycle.
    pub fn run(mut self, ready: Sender<Vec<String>>) {
        // Nobody may wait for it any more.
        let _ = ready.send(realtime::claim(self.processor));
        let cycle_ns = self.machine.config().cycle_ns;
        let (mut inputs, mut outputs) = (self.machine.inputs(), self.machine.outputs());
        let start = nanoseconds(ClockId::Monotonic);
        let wall_start = nanoseconds(ClockId::Realtime);
        let mut deadline = start;
        let mut missed = 0;
        while !self.stop.load(Ordering::Relaxed) {
            sleep_until(deadline);
            let woken = nanoseconds(ClockId::Monotonic);
            inputs.cycle = self.machine.next_cycle();
            inputs.missed = missed;
            self.one(&mut inputs, &mut outputs, wall_start.saturating_add(deadline - start));
            let done = nanoseconds(ClockId::Monotonic);
            self.count(woken.saturating_sub(deadline), done.saturating_sub(woken));
            deadline += cycle_ns;
            missed = self.skip_missed(&mut deadline, done, cycle_ns);
        }
        self.plant.stop();
    }

    fn one(&mut self, inputs: &mut Inputs, outputs: &mut Outputs, stamp_ns: u64) {
        self.lanes.take();
        if let Some(play) = &mut self.play {
            let mut number = play.numbers.reserve(PLAYED_COMMANDS);
            play.player.before(inputs.cycle, &mut number, Some(&mut self.plant));
            self.lanes.add(play.player.commands());
        }
        self.plant.read(inputs);
        if let Some(play) = &self.play {
            play.player.override_inputs(inputs);
        }
        self.frames.before(&self.machine);
        self.machine.cycle(inputs, self.lanes.commands(), outputs);
        self.plant.write(outputs);
        self.end_play();
        let snapshot = self.snapshot.input_buffer_mut();
        snapshot.cycle = inputs.cycle;
        snapshot.stamp_ns = stamp_ns;
        snapshot.board.copy_from(self.machine.board());
        self.snapshot.publish();
        self.publish_parameters();
        // After the signals: who reacts to an event finds signals that are at least as new.
        for &event in self.machine.events() {
            if self.events.push(StampedEvent { event, stamp_ns }).is_err() {
                self.statistics.events_lost.fetch_add(1, Ordering::Relaxed);
            }
        }
        self.frames.send(stamp_ns, inputs, &self.machine, self.lanes.drain());
    }

    fn publish_parameters(&mut self) {
        // Of the three images each is brought up to date when its turn comes.
        if self.published != self.machine.parameter_version() {
            self.published = self.machine.parameter_version();
            self.machine.copy_parameters(self.parameters.input_buffer_mut());
            self.parameters.publish();
        }
    }

    /// Judges the cycle for the scenario, and reports it when it is over.
    fn end_play(&mut self) {
        if let Some(play) = &mut self.play {
            play.player.after(&self.machine);
        }
        if let Some(play) = self.play.take_if(|play| play.player.is_over()) {
            // Nobody left to hear it: the program is ending.
            let _ = play.report.send(play.player.finish());
        }
    }

    fn count(&self, lateness: u64, duration: u64) {
        self.statistics.cycles.fetch_add(1, Ordering::Relaxed);
        self.statistics.worst_lateness_ns.fetch_max(lateness, Ordering::Relaxed);
        self.statistics.worst_duration_ns.fetch_max(duration, Ordering::Relaxed);
    }

    /// Moves the deadline past whole cycles that can no longer be kept, and says how many they are.
    fn skip_missed(&self, deadline: &mut u64, now: u64, cycle_ns: u64) -> u32 {
        let late = now.saturating_sub(*deadline) / cycle_ns;
        *deadline += late * cycle_ns;
        self.statistics.missed.fetch_add(late, Ordering::Relaxed);
        u32::try_from(late).unwrap_or(u32::MAX)
    }
}
