//! Cycle thread: runs one cycle after the other at absolute deadlines, without anything that could make it wait. A
//! backend that owns the clock of the cycle shifts the deadlines.

use super::backends::Backends;
use super::clock::CycleClock;
use super::frames::FrameSender;
use super::gate::Gate;
use super::histogram::{Counts, Histogram};
use super::lanes::{CommandQueues, Numbers};
use super::realtime::{self, Processor};
use super::samples::SampleSender;
use super::schedule::Schedule;
use super::trials::TrialSlot;
use super::wake::Wake;
use crate::recording::CycleTime;
use crate::scenario::{Player, Report};
use lineshaft_core::command::Commands;
use lineshaft_core::drive::{Inputs, Outputs};
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_ros::surface::host::{self, Percentiles, Snapshot, StampedEvent};
use rtrb::Producer;
use rustix::thread::clock_nanosleep_absolute;
use rustix::time::{ClockId, Timespec, clock_gettime};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;

/// Timing statistics of the thread; written by it, read by other threads.
#[derive(Debug, Default)]
pub struct Statistics {
    /// Number of cycles.
    pub cycles: AtomicU64,
    /// Number of missed cycles.
    pub missed: AtomicU64,
    /// Sum of the wake-up latencies, in ns.
    pub lateness_ns: AtomicU64,
    /// Sum of the cycle durations, in ns.
    pub duration_ns: AtomicU64,
    /// Maximum wake-up latency since the last report, in ns.
    pub newest_lateness_ns: AtomicU64,
    /// Maximum cycle duration since the last report, in ns.
    pub newest_duration_ns: AtomicU64,
    /// Maximum wake-up latency, in ns.
    pub worst_lateness_ns: AtomicU64,
    /// Maximum cycle duration, from wake-up to end, in ns.
    pub worst_duration_ns: AtomicU64,
    /// Wake-up latencies, in ns.
    pub lateness: Histogram,
    /// Cycle durations, in ns.
    pub duration: Histogram,
    /// Number of events that were lost because the ring buffer was full.
    pub events_lost: AtomicU64,
}

/// Counts of both histograms at the last call of [`Statistics::take`]; they belong to the caller.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    lateness: Counts,
    duration: Counts,
}

/// A scenario that is played on the running machine. It allocates, so such a run is for tests only.
pub struct Play {
    /// The scenario.
    pub player: Player,
    /// Source of the numbers of its commands.
    pub numbers: Numbers,
    /// Receives the report at its end.
    pub report: Sender<Report>,
}

impl Statistics {
    /// Returns the statistics that the surface publishes, and restarts their maxima and percentiles. There may be only
    /// one caller, which stores `last`. It allocates, so the cycle thread never calls it.
    pub fn take(&self, last: &mut Taken) -> host::Statistics {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let newest_maximum = |maximum: &AtomicU64| maximum.swap(0, Ordering::Relaxed);
        let now = Taken { lateness: self.lateness.counts(), duration: self.duration.counts() };
        let last = std::mem::replace(last, now.clone());
        let newest_lateness_ns = newest_maximum(&self.newest_lateness_ns);
        let newest_duration_ns = newest_maximum(&self.newest_duration_ns);
        let (worst_lateness_ns, worst_duration_ns) = (of(&self.worst_lateness_ns), of(&self.worst_duration_ns));
        host::Statistics {
            cycles: of(&self.cycles),
            missed: of(&self.missed),
            lateness_ns: of(&self.lateness_ns),
            duration_ns: of(&self.duration_ns),
            newest_lateness_ns,
            newest_duration_ns,
            worst_lateness_ns,
            worst_duration_ns,
            newest_lateness: now.lateness.since(&last.lateness).percentiles(newest_lateness_ns),
            newest_duration: now.duration.since(&last.duration).percentiles(newest_duration_ns),
            lateness: now.lateness.percentiles(worst_lateness_ns),
            duration: now.duration.percentiles(worst_duration_ns),
            events_lost: of(&self.events_lost),
        }
    }

    /// Returns one line for people about all cycles, with times in whole us, rounded down.
    pub fn summary(&self) -> String {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let times = |histogram: &Histogram, worst: &AtomicU64| {
            let worst = of(worst);
            let Percentiles { p50, p99, p999 } = histogram.counts().percentiles(worst);
            let [p50, p99, p999, worst] = [p50, p99, p999, worst].map(|time| time / 1000);
            format!("p50 {p50} us, p99 {p99} us, p99.9 {p999} us, max {worst} us")
        };
        format!(
            "{} cycles, {} missed; lateness {}; duration {}",
            of(&self.cycles),
            of(&self.missed),
            times(&self.lateness, &self.worst_lateness_ns),
            times(&self.duration, &self.worst_duration_ns),
        )
    }

    /// Records the wake-up latency and the duration of a cycle, in ns.
    fn count(&self, lateness: u64, duration: u64) {
        let add = |counter: &AtomicU64, by| counter.fetch_add(by, Ordering::Relaxed);
        add(&self.cycles, 1);
        add(&self.lateness_ns, lateness);
        add(&self.duration_ns, duration);
        for (newest, worst, value) in [
            (&self.newest_lateness_ns, &self.worst_lateness_ns, lateness),
            (&self.newest_duration_ns, &self.worst_duration_ns, duration),
        ] {
            newest.fetch_max(value, Ordering::Relaxed);
            worst.fetch_max(value, Ordering::Relaxed);
        }
        self.lateness.record(lateness);
        self.duration.record(duration);
    }
}

/// Data that the cycle thread owns.
pub struct CycleThread {
    /// The machine.
    pub machine: Machine,
    /// Backends of the machine.
    pub backends: Backends,
    /// Scenario that is played.
    pub play: Option<Play>,
    /// Trial of an axis that is tuned, if any, and the source of the numbers of its commands.
    pub trials: (TrialSlot, Numbers),
    /// Queues of commands.
    pub lanes: CommandQueues,
    /// Sends events.
    pub events: Producer<StampedEvent>,
    /// Sends complete cycles to the recorder.
    pub frames: FrameSender,
    /// Publishes signals.
    pub snapshot: triple_buffer::Input<Snapshot>,
    /// Sends the cycles of the state topics.
    pub samples: SampleSender,
    /// Publishes parameters.
    pub parameters: triple_buffer::Input<ParameterImage>,
    /// Last published version of the parameters.
    pub published: u64,
    /// Wakes the bridge when there is data to pass on.
    pub wake: Wake,
    /// Gate; while it is closed, no cycle runs.
    pub gate: Arc<Gate>,
    /// Set by another thread to end it.
    pub stop: Arc<AtomicBool>,
    /// Timing statistics.
    pub statistics: Arc<Statistics>,
    /// Calculates the times of cycles.
    pub clock: CycleClock,
    /// Processor on which it runs.
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
    // Interrupted by a signal: the deadline is absolute, so the sleep is repeated.
    while clock_nanosleep_absolute(ClockId::Monotonic, &request) == Err(rustix::io::Errno::INTR) {}
}

impl CycleThread {
    /// Runs until it is stopped. `ready` gets the requests that the operating system did not grant, before the first
    /// cycle.
    pub fn run(mut self, ready: Sender<Vec<String>>) {
        // The receiver may have gone.
        let _ = ready.send(realtime::claim(self.processor));
        let (gate, stop) = (Arc::clone(&self.gate), Arc::clone(&self.stop));
        let (mut inputs, mut outputs) = (self.machine.inputs(), self.machine.outputs());
        let mut earliest = 0;
        while gate.wait(&stop) {
            earliest = self.cycles(&mut inputs, &mut outputs, earliest);
            gate.set_closed();
        }
    }

    /// Runs cycles until the gate closes or the program ends. Their timing starts again, not before `earliest`; returns
    /// the earliest time of the next cycle, in ns of the monotonic clock.
    fn cycles(&mut self, inputs: &mut Inputs, outputs: &mut Outputs, earliest: u64) -> u64 {
        let cycle_ns = self.machine.config().cycle_ns;
        let mut schedule = Schedule::new(nanoseconds(ClockId::Monotonic).max(earliest), cycle_ns);
        let mut missed = 0;
        // Commands submitted before the gate closed are still executed, so that each gets an answer.
        while !self.stop.load(Ordering::Relaxed) && (self.gate.is_wanted() || !self.lanes.are_empty()) {
            sleep_until(schedule.deadline());
            let woken = nanoseconds(ClockId::Monotonic);
            inputs.begin(self.machine.next_cycle(), missed);
            let time = self.clock.at(schedule.deadline(), cycle_ns);
            self.one(inputs, outputs, time);
            schedule.shift(self.backends.clock_shift(schedule.pending()));
            let done = nanoseconds(ClockId::Monotonic);
            self.statistics.count(schedule.lateness(woken), done.saturating_sub(woken));
            let late = schedule.advance(done);
            self.statistics.missed.fetch_add(late, Ordering::Relaxed);
            missed = u32::try_from(late).unwrap_or(u32::MAX);
        }
        self.trials.0.give_up();
        schedule.deadline()
    }

    fn one(&mut self, inputs: &mut Inputs, outputs: &mut Outputs, time: CycleTime) {
        let stamp_ns = time.stamp_ns;
        let (trials, numbers) = &mut self.trials;
        let is_tried = trials.is_busy();
        let mut room = self.lanes.take_stops();
        if let Some(play) = &mut self.play {
            let mut number = play.numbers.reserve(play.player.most_commands());
            play.player.before(inputs.cycle, &mut number, self.backends.plant.as_mut(), room);
            let played = play.player.commands().iter().count();
            room = room.saturating_sub(played);
            self.lanes.take_others(played + usize::from(is_tried));
            self.lanes.add(play.player.commands());
        } else {
            self.lanes.take_others(usize::from(is_tried));
        }
        if is_tried {
            let command = trials.before(&self.machine, self.lanes.commands().stop, room > 0, numbers);
            self.lanes.add(Commands::queue(command.as_slice()));
        }
        self.backends.read(inputs);
        if let Some(play) = &self.play {
            play.player.override_inputs(inputs);
        }
        self.frames.before(&self.machine);
        self.machine.cycle(inputs, self.lanes.commands(), outputs);
        self.backends.write(outputs);
        self.end_play();
        let snapshot = self.snapshot.input_buffer_mut();
        snapshot.cycle = inputs.cycle;
        snapshot.stamp_ns = stamp_ns;
        snapshot.board.copy_from(self.machine.board());
        self.snapshot.publish();
        let is_sampled = self.samples.send(inputs.cycle, stamp_ns, self.machine.board());
        let is_set = self.publish_parameters();
        // After the signals: a reader of an event finds signals that are at least as new.
        for &event in self.machine.events() {
            if self.events.push(StampedEvent { event, stamp_ns }).is_err() {
                self.statistics.events_lost.fetch_add(1, Ordering::Relaxed);
            }
        }
        let (stream, commands) = self.lanes.drain();
        self.frames.send(time, inputs, &self.machine, stream, commands);
        if is_sampled || is_set || !self.machine.events().is_empty() {
            self.wake.wake();
        }
    }

    /// Publishes the parameters if they have changed.
    fn publish_parameters(&mut self) -> bool {
        // Each of the three images is updated when its turn comes.
        let is_set = self.published != self.machine.parameter_version();
        if is_set {
            self.published = self.machine.parameter_version();
            self.machine.copy_parameters(self.parameters.input_buffer_mut());
            self.parameters.publish();
        }
        is_set
    }

    /// Evaluates the cycle for the scenario, and reports at its end.
    fn end_play(&mut self) {
        if let Some(play) = &mut self.play {
            play.player.after(&self.machine);
        }
        if let Some(play) = self.play.take_if(|play| play.player.is_over()) {
            // The receiver has gone if the program is ending.
            let _ = play.report.send(play.player.finish());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newest_values_start_again_and_sums_and_worst_values_do_not() {
        let (statistics, mut last) = (Statistics::default(), Taken::default());
        for (lateness, duration) in [(10, 300), (40, 100)] {
            statistics.count(lateness, duration);
        }
        let first = statistics.take(&mut last);
        statistics.count(20, 50);
        let second = statistics.take(&mut last);
        assert_eq!((first.cycles, first.lateness_ns, first.duration_ns), (2, 50, 400));
        assert_eq!((first.newest_lateness_ns, first.newest_duration_ns), (40, 300));
        assert_eq!((second.cycles, second.lateness_ns, second.duration_ns), (3, 70, 450));
        assert_eq!((second.newest_lateness_ns, second.newest_duration_ns), (20, 50));
        assert_eq!((second.worst_lateness_ns, second.worst_duration_ns), (40, 300));
        // 100 ns are in the bucket 100 to 101 ns.
        assert_eq!(first.newest_lateness, Percentiles { p50: 10, p99: 40, p999: 40 });
        assert_eq!(first.newest_duration, Percentiles { p50: 101, p99: 300, p999: 300 });
        assert_eq!((first.lateness, first.duration), (first.newest_lateness, first.newest_duration));
        assert_eq!(second.newest_lateness, Percentiles { p50: 20, p99: 20, p999: 20 });
        assert_eq!(second.newest_duration, Percentiles { p50: 50, p99: 50, p999: 50 });
        assert_eq!(second.lateness, Percentiles { p50: 20, p99: 40, p999: 40 });
        assert_eq!(second.duration, Percentiles { p50: 101, p99: 300, p999: 300 });
        let third = statistics.take(&mut last);
        assert_eq!((third.newest_lateness, third.newest_duration), (Percentiles::default(), Percentiles::default()));
        assert_eq!((third.lateness, third.duration), (second.lateness, second.duration));
        // Larger than all before, so that the maximum of the period does not limit the value of an older sample.
        statistics.count(60, 400);
        let fourth = statistics.take(&mut last);
        assert_eq!(fourth.newest_lateness, Percentiles { p50: 60, p99: 60, p999: 60 });
        assert_eq!(fourth.newest_duration, Percentiles { p50: 400, p99: 400, p999: 400 });
    }

    #[test]
    fn summary_gives_percentiles_and_maximum_in_us() {
        let statistics = Statistics::default();
        (1..=1000).for_each(|number| statistics.count(number * 1000, number * 2000));
        statistics.missed.store(3, Ordering::Relaxed);
        // 500 us are in the bucket that ends at 507.903 us, 990 and 999 us in the one that ends at 999.423 us.
        let wanted = "1000 cycles, 3 missed; \
            lateness p50 507 us, p99 999 us, p99.9 999 us, max 1000 us; \
            duration p50 1015 us, p99 1998 us, p99.9 1998 us, max 2000 us";
        assert_eq!(statistics.summary(), wanted);
    }
}
