//! Tests the recorder on a machine without a clock: lost cycles and reports.

use super::*;
use crate::cell::Cell;
use crate::recording::CycleTime;
use crate::recording::bag::STAMPS_AHEAD;
use crate::recording::replay::{Verdict, replay};
use crate::recording::run::Run;
use crate::recording::series::stamp;
use crate::recording::validate::{Align, validate};
use crate::run::frames::{FrameSender, frames};
use crate::run::lanes::{CommandQueues, lanes};
use crate::run::trials::trials;
use lineshaft_core::command::Commands;
use lineshaft_core::machine::Machine;
use lineshaft_msgs::msg::AxisStates;
use std::path::Path;
use std::sync::mpsc::{Sender, channel};

/// A machine at standstill, its recorder, and all connections between them.
struct Rig {
    machine: Machine,
    sender: FrameSender,
    recorder: Recorder,
    lanes: CommandQueues,
    ask: Sender<Asked>,
    /// Time by which stamps are ahead of log times from a cycle on, in ns.
    ahead: Vec<(u64, i64)>,
    _folder: tempfile::TempDir,
}

impl Rig {
    /// `record`: writes the bag `bag.mcap` from the first cycle on.
    fn new(record: bool, flight: Option<u64>) -> Self {
        let (cell, folder) = (Cell::demo(), tempfile::tempdir().unwrap());
        let machine = Machine::new(cell.machine.clone()).unwrap();
        let (sender, receiver, _) = frames(&machine);
        let (config, directory) = (machine.config().clone(), machine.directory().clone());
        let encoder = Encoder::new(&cell, &config, &directory);
        let ((commander, lanes), (ask, asked)) = (lanes(config.axes.len()), channel());
        let handle = Arc::new(Handle::new(
            config,
            directory,
            commander,
            trials().0,
            ask.clone(),
            triple_buffer::triple_buffer(&Default::default()).1,
            Default::default(),
        ));
        let subject = Arc::new(Subject::new(&cell, &cell.ros.node_name()));
        let options = BagOptions { path: folder.path().join("bag.mcap"), ..BagOptions::default() };
        let bag = record.then(|| Bag::create(&options, Subject::clone(&subject)).unwrap());
        let place = FlightFolder::create(folder.path().join("flight"), 2).unwrap();
        let flight = flight.map(|seconds| (Flight::new(seconds * 1_000_000_000), place));
        let recorder = Recorder::new(handle, receiver, encoder, subject, asked, bag, flight);
        Self { machine, sender, recorder, lanes, ask, ahead: Vec::new(), _folder: folder }
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self._folder.path().join(name)
    }

    /// Runs cycles without the recorder.
    fn run(&mut self, cycles: u64) {
        let (mut inputs, mut outputs) = (self.machine.inputs(), self.machine.outputs());
        for _ in 0..cycles {
            inputs.cycle = self.machine.next_cycle();
            self.sender.before(&self.machine);
            self.machine.cycle(&inputs, Commands::default(), &mut outputs);
            let time = self.time(inputs.cycle);
            self.sender.send(time, &inputs, &self.machine, None, std::iter::empty());
        }
    }

    /// Returns the time of a cycle.
    fn time(&self, cycle: u64) -> CycleTime {
        let log_ns = 1_700_000_000_000_000_000 + cycle * 1_000_000;
        let ahead = self.ahead.iter().rev().find(|(from, _)| *from <= cycle).map_or(0, |(_, ahead)| *ahead);
        CycleTime { log_ns, stamp_ns: log_ns.strict_add_signed(ahead) }
    }

    /// Makes the recorder receive all pending cycles.
    fn look(&mut self) {
        while self.recorder.look() {}
    }

    /// Returns the notes that the recorder sent to the machine.
    fn notes(&mut self) -> Vec<(Code, i64)> {
        self.lanes.take();
        let note = |command: lineshaft_core::command::Command| match command.action {
            Action::Note { code, number } => (code, number),
            other => panic!("no note: {other:?}"),
        };
        self.lanes.drain().1.map(note).collect()
    }

    fn asks(&mut self, request: RecordRequest) -> oneshot::Receiver<RecordResponse> {
        let (answer, answered) = oneshot::channel();
        self.ask.send((request, answer)).unwrap();
        self.look();
        answered
    }

    /// Runs the recorder until a bag that is being finished or saved is done.
    fn wait(&mut self, mut answered: oneshot::Receiver<RecordResponse>) -> RecordResponse {
        loop {
            self.recorder.look();
            match answered.try_recv() {
                Ok(response) => return response,
                Err(oneshot::error::TryRecvError::Empty) => std::thread::yield_now(),
                Err(error) => panic!("{error}"),
            }
        }
    }
}

fn command(command: u8) -> RecordRequest {
    RecordRequest { command, ..RecordRequest::default() }
}

fn verdict(path: &Path) -> Verdict {
    replay(&mut Run::open(path).unwrap()).unwrap().verdict
}

#[test]
fn lost_cycles_are_counted_and_reported_and_prevent_a_replay() {
    let mut rig = Rig::new(true, None);
    rig.run(2100);
    rig.look();
    assert_eq!(rig.notes(), [], "a gap is seen with the cycle after it");
    rig.run(1);
    rig.look();
    assert_eq!(rig.notes(), [(Code::RECORD_LOST, 100)]);
    let status = rig.asks(command(RecordRequest::STATUS)).try_recv().unwrap();
    assert_eq!((status.recording, status.lost, status.replayable), (true, 100, false));
    let path = rig.path("bag.mcap");
    assert!(rig.recorder.end());
    assert_eq!(verdict(&path), Verdict::Gap { first: 2000, next: 2100 });
    let run = Run::open(&path).unwrap();
    let end = run.metadata("lineshaft_end").unwrap();
    assert_eq!((end["lost"].as_str(), end["replayable"].as_str()), ("100", "false"));
}

#[test]
fn cycles_that_are_lost_at_the_very_end_count_too() {
    let mut rig = Rig::new(true, None);
    rig.run(2005);
    rig.look();
    let path = rig.path("bag.mcap");
    assert!(rig.recorder.end());
    assert_eq!(Run::open(&path).unwrap().metadata("lineshaft_end").unwrap()["lost"], "5");
}

#[test]
fn a_bag_that_is_begun_in_mid_run_begins_with_the_next_state() {
    let mut rig = Rig::new(false, None);
    rig.run(1500);
    rig.look();
    let path = rig.path("later.mcap");
    let start = RecordRequest { path: path.display().to_string(), ..command(RecordRequest::START) };
    let begun = rig.asks(start.clone());
    let twice = rig.asks(start).try_recv().unwrap();
    assert!(!twice.success && twice.message.ends_with("is about to be recorded already"), "{}", twice.message);
    rig.run(700);
    let begun = rig.wait(begun);
    assert_eq!((begun.success, begun.recording, begun.message.as_str()), (true, true, "recording from cycle 2000 on"));
    let stopped = rig.asks(command(RecordRequest::STOP));
    let stopped = rig.wait(stopped);
    assert_eq!((stopped.success, stopped.cycles, stopped.replayable), (true, 200, true), "{}", stopped.message);
    assert_eq!(verdict(&path), Verdict::Same);
    let again = rig.asks(command(RecordRequest::STOP)).try_recv().unwrap();
    assert_eq!((again.success, again.message.as_str()), (false, "nothing is being recorded"));
}

#[test]
fn a_start_that_has_not_begun_can_be_stopped() {
    let mut rig = Rig::new(false, None);
    rig.run(10);
    let start = RecordRequest { path: "x.mcap".to_owned(), ..command(RecordRequest::START) };
    let begun = rig.asks(start);
    let stopped = rig.asks(command(RecordRequest::STOP)).try_recv().unwrap();
    assert_eq!((stopped.success, stopped.message.as_str()), (true, "x.mcap was stopped before it began"));
    assert!(!rig.wait(begun).success);
}

#[test]
fn bad_requests_are_refused_with_a_sentence_and_change_nothing() {
    let mut rig = Rig::new(true, None);
    let bad = |duration| RecordRequest { max_bag_duration: duration, ..command(RecordRequest::START) };
    for (request, sentence) in [
        (command(9), "command is 9; 0 STATUS, 1 START, 2 STOP, 3 SAVE are allowed"),
        (command(RecordRequest::SAVE), "the flight recorder is off"),
        (bad(0.0), "bag.mcap is being recorded already"),
    ] {
        let response = rig.asks(request).try_recv().unwrap();
        assert!(!response.success && response.message.ends_with(sentence), "{}", response.message);
        assert!(response.recording);
    }
    let mut rig = Rig::new(false, None);
    // A file begins at a key cycle, of which there is one per second.
    for duration in [-1.0, 0.5, f64::NAN, f64::INFINITY, 4e7] {
        let response = rig.asks(bad(duration)).try_recv().unwrap();
        let sentence = format!("max_bag_duration is {duration} s; 0 or 1 to 31536000 s is allowed");
        assert_eq!((response.success, response.message), (false, sentence));
    }
}

#[test]
fn the_flight_recorder_saves_on_request_and_keeps_no_more_than_it_may() {
    let mut rig = Rig::new(false, Some(3));
    let early = rig.asks(command(RecordRequest::SAVE));
    let early = rig.wait(early);
    assert!(!early.success && early.message.contains("has kept no cycle yet"), "{}", early.message);
    let mut paths = Vec::new();
    for _ in 0..4 {
        rig.run(1900);
        rig.look();
        let saved = rig.asks(command(RecordRequest::SAVE));
        let saved = rig.wait(saved);
        assert!(saved.success && saved.replayable, "{}", saved.message);
        paths.push(std::path::PathBuf::from(saved.path));
    }
    let kept: Vec<bool> = paths.iter().map(|path| path.exists()).collect();
    assert_eq!(kept, [false, false, true, true]);
    assert_eq!(verdict(&paths[3]), Verdict::Same);
}

/// Returns log time, stamp and cycle of each message of axis_states.
fn states(path: &Path) -> Vec<(u64, u64, u64)> {
    let (mut run, mut states) = (Run::open(path).unwrap(), Vec::new());
    while let Some(message) = run.next_message().unwrap() {
        if message.kind == "lineshaft_msgs/msg/AxisStates" {
            let AxisStates { header, cycle, .. } = message.decode().unwrap();
            states.push((message.log_time, stamp(&header.stamp).unwrap(), cycle));
        }
    }
    states
}

/// One hour back after 0.9 s and ten hours forward after 3.2 s, in bags with files of 2 s: log times grow by one cycle
/// per cycle, stamps have steps, and every bag and file can be replayed.
#[test]
fn bags_keep_steady_log_times_where_the_system_clock_is_set() {
    const HOUR: i64 = 3_600_000_000_000;
    let mut rig = Rig::new(false, Some(3));
    rig.ahead = vec![(900, -HOUR), (3200, 9 * HOUR)];
    let path = rig.path("bag");
    let start =
        RecordRequest { path: path.display().to_string(), max_bag_duration: 2.0, ..command(RecordRequest::START) };
    let begun = rig.asks(start);
    for _ in 0..10 {
        rig.run(500);
        rig.look();
    }
    assert!(rig.wait(begun).success);
    let saved = rig.asks(command(RecordRequest::SAVE));
    let saved = rig.wait(saved);
    assert!(saved.success, "{}", saved.message);
    let stopped = rig.asks(command(RecordRequest::STOP));
    assert!(rig.wait(stopped).replayable);

    let states = states(&path);
    assert_eq!(states.len(), 500, "100 a second");
    for (log_ns, stamp_ns, cycle) in states {
        let time = rig.time(cycle);
        assert_eq!((log_ns, stamp_ns), (time.log_ns, time.stamp_ns), "{cycle}");
    }
    assert_eq!(verdict(&path), Verdict::Same);
    // A comparison uses log times: there is no gap, and no time decreases.
    let open = || Run::open(&path).unwrap();
    let report = validate(&mut open(), &mut open(), &[], Align::Start).unwrap();
    assert!(report.passed(), "{report}");
    // Each file begins with its own stamps; without steps before it no file has the key.
    for (file, ahead) in [("bag_0.mcap", None), ("bag_1.mcap", Some(-HOUR)), ("bag_2.mcap", Some(9 * HOUR))] {
        let file = path.join(file);
        assert_eq!(verdict(&file), Verdict::Same, "{}", file.display());
        let run = Run::open(&file).unwrap();
        let found = run.metadata("lineshaft").unwrap().get(STAMPS_AHEAD).map(|ahead| ahead.parse().unwrap());
        assert_eq!(found, ahead, "{}", file.display());
    }
    // A bag that begins after a step begins with the system time.
    let saved = Path::new(&saved.path);
    assert_eq!(verdict(saved), Verdict::Same);
    let begin = self::states(saved)[0];
    assert!(begin.0 == begin.1 && begin.2 == 1000, "{begin:?}");
    assert!(saved.file_name().unwrap().to_str().unwrap().starts_with("flight_20231115_071"), "{}", saved.display());
}

/// Stamps that a step does not explain are a difference: a stamp with a smaller error, or one of two stamps in a cycle.
#[test]
fn other_stamps_than_those_of_the_cycle_are_a_difference() {
    let mut rig = Rig::new(true, None);
    // 50 ms are no step.
    rig.ahead = vec![(1000, 50_000_000)];
    rig.run(1500);
    rig.look();
    let path = rig.path("bag.mcap");
    assert!(rig.recorder.end());
    let Verdict::Differs(difference) = verdict(&path) else { panic!("no difference") };
    assert_eq!(
        (difference.cycle, difference.what.as_str()),
        (1000, "lineshaft_msgs/msg/AxisStates.header.stamp.nanosec")
    );
}
