use super::*;
use crate::surface::parameters::fake;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::drive::Health;
use lineshaft_core::machine::Machine;
use lineshaft_msgs::srv::RecordResponse;

const OK: u8 = 0;
const WARN: u8 = 1;
const ERROR: u8 = 2;
const STALE: u8 = 3;

/// A machine with axes line (virtual) and x, after its first cycle.
struct Bench {
    machine: Machine,
    judge: DiagnosticsEvaluator,
    snapshot: Snapshot,
    begin: Instant,
}

impl Bench {
    fn new() -> Self {
        Self::of(fake::config())
    }

    fn of(config: MachineConfig) -> Self {
        let machine = Machine::new(config).expect("a sound config");
        let begin = Instant::now();
        let views = AxisView::all(machine.config(), machine.directory());
        let hardware = vec![None, Some("plant:0".to_owned())];
        let judge = DiagnosticsEvaluator::new(views, hardware, machine.directory(), 1_000_000, begin);
        let snapshot = Snapshot { cycle: 1, stamp_ns: 5, board: machine.board().clone() };
        let mut bench = Self { machine, judge, snapshot, begin };
        bench.set("x.drive_state", 1);
        bench.set("machine.state", 1);
        bench
    }

    fn set(&mut self, signal: &str, value: i64) {
        let signal = self.machine.directory().find(signal).expect("a signal");
        self.snapshot.board.set_int(signal, value);
    }

    /// Returns the levels of machine, x and recorder at a time in milliseconds.
    fn levels(&mut self, ms: u64) -> Vec<u8> {
        let now = self.begin + Duration::from_millis(ms);
        self.judge.evaluate(&self.snapshot, now, &[], &Recorder::Unknown).levels()
    }

    fn describe(&mut self, ms: u64, recorder: &Recorder) -> Vec<DiagnosticStatus> {
        let now = self.begin + Duration::from_millis(ms);
        let findings = self.judge.evaluate(&self.snapshot, now, &[], recorder);
        let error = |axis, code: Code| (axis == 1 && code.0 == 88).then(|| "x: a sentence".to_owned());
        self.judge.describe(
            &findings,
            &self.snapshot,
            &[],
            recorder,
            &StatusData { node: "cell", state: "active", error: &error },
        )
    }
}

fn value<'a>(status: &'a DiagnosticStatus, key: &str) -> &'a str {
    &status.values.iter().find(|pair| pair.key == key).expect("a key").value
}

#[test]
fn cycle_is_stale_after_100_ms_and_10_cycles() {
    let mut bench = Bench::new();
    assert_eq!(bench.levels(0), [OK, OK, OK]);
    assert_eq!(bench.levels(100), [OK, OK, OK]);
    assert_eq!(bench.levels(101), [STALE, STALE, OK]);
    bench.snapshot.cycle += 1;
    assert_eq!(bench.levels(102), [OK, OK, OK]);

    let views = AxisView::all(bench.machine.config(), bench.machine.directory());
    let mut slow = DiagnosticsEvaluator::new(views, Vec::new(), bench.machine.directory(), 20_000_000, bench.begin);
    let mut look =
        |ms| slow.evaluate(&bench.snapshot, bench.begin + Duration::from_millis(ms), &[], &Recorder::Unknown).machine;
    assert_eq!((look(0), look(200), look(201)), (Finding::Good, Finding::Good, Finding::Stale));
    // Before the first cycle the cycle is stale.
    bench.snapshot.stamp_ns = 0;
    assert_eq!(bench.levels(102), [STALE, STALE, OK]);
}

#[test]
fn missed_cycles_are_warned_of_for_a_second() {
    let mut bench = Bench::new();
    let mut at = |ms: u64, overruns: i64| {
        bench.set("machine.overruns", overruns);
        bench.snapshot.cycle = ms + 1;
        let now = bench.begin + Duration::from_millis(ms);
        bench.judge.evaluate(&bench.snapshot, now, &[], &Recorder::Unknown).machine
    };
    assert_eq!(at(0, 0), Finding::Good);
    assert_eq!(at(20, 3), Finding::Missed(3));
    assert_eq!(at(900, 5), Finding::Missed(5));
    assert_eq!(at(1_899, 5), Finding::Missed(5));
    assert_eq!(at(1_900, 5), Finding::Good);
    assert_eq!(at(2_000, 6), Finding::Missed(1));
}

#[test]
fn each_drive_problem_has_level_and_message() {
    for (signals, level, message) in [
        (&[("x.state", 1), ("x.drive_state", 4)][..], OK, "STANDSTILL"),
        (&[("x.drive_state", 7)], ERROR, "the drive is in fault"),
        (&[("x.drive_state", 6)], ERROR, "the drive is in fault"),
        (&[("x.drive_state", 0)], ERROR, "the drive does not answer, or is not ready"),
        (&[("x.error", 88)], ERROR, "x: a sentence"),
        (&[("x.error", 10201)], ERROR, "x: following error"),
        (&[("x.error", 0x1_2310)], ERROR, "x: drive fault 0x2310"),
        (&[("x.error", 4_000_000_000)], ERROR, "x: error 4000000000"),
        (&[("x.state", 6)], WARN, "stopped, and locked until ~/reset_errors"),
        (&[("x.warning", 1)], WARN, "the drive warns"),
    ] {
        let mut bench = Bench::new();
        for (signal, value) in signals {
            bench.set(signal, *value);
        }
        let all = bench.describe(0, &Recorder::Unknown);
        assert_eq!(
            all.iter().map(|status| status.name.as_str()).collect::<Vec<_>>(),
            ["cell: machine", "cell: x", "cell: recorder"]
        );
        let x = &all[1];
        assert_eq!((x.level, x.message.as_str(), x.hardware_id.as_str()), (level, message, "plant:0"), "{signals:?}");
    }
}

#[test]
fn values_have_their_units() {
    let mut bench = Bench::new();
    for (signal, value) in [("x.actual.position", 12_345), ("x.command.position", -500), ("x.following_error", 7)] {
        bench.set(signal, value);
    }
    let velocity = bench.machine.directory().find("x.actual.velocity").unwrap();
    bench.snapshot.board.set_real(velocity, 2_500.0);
    let all = bench.describe(0, &Recorder::Unknown);
    // 1000 increments are one millimetre.
    let texts = ["position", "command position", "following error", "velocity", "error code", "drive state"];
    let texts = texts.map(|key| value(&all[1], key));
    assert_eq!(texts, ["12.345 mm", "-0.5 mm", "0.007 mm", "2.5 mm/s", "0", "SWITCH_ON_DISABLED"]);
    assert_eq!((value(&all[0], "cycle"), value(&all[0], "lifecycle")), ("1", "active"));
}

#[test]
fn gantry_status_reports_both_drives() {
    let mut config = fake::config();
    config.axes[1].second = config.axes[1].drive;
    config.axes[1].parameters.gantry.max_skew = Some(200);
    let mut bench = Bench::of(config);
    bench.set("x.second.drive_state", 7);
    bench.set("x.skew", -150);
    let all = bench.describe(0, &Recorder::Unknown);
    assert_eq!((value(&all[1], "second drive state"), value(&all[1], "skew")), ("FAULT", "-0.15 mm"));
    let one = Bench::new().describe(0, &Recorder::Unknown);
    assert!(one[1].values.iter().all(|pair| pair.key != "skew"));
}

#[test]
fn recorder_status_follows_its_answer() {
    let mut bench = Bench::new();
    let status = |recording, lost| {
        Recorder::Status(RecordResponse {
            recording,
            lost,
            message: "recording".to_owned(),
            ..RecordResponse::default()
        })
    };
    for (recorder, level, message) in [
        (status(true, 0), OK, "recording"),
        (status(true, 4), WARN, "4 cycles are missing in the recording"),
        (status(false, 4), OK, "recording"),
        (Recorder::Gone, ERROR, "the recorder has failed: nothing is recorded any more"),
    ] {
        let all = bench.describe(0, &recorder);
        assert_eq!((all[2].level, all[2].message.as_str()), (level, message));
    }
}

#[test]
fn machine_error_has_precedence_over_missed_cycles() {
    let mut bench = Bench::new();
    bench.set("machine.state", 2);
    bench.set("machine.overruns", 9);
    assert_eq!(bench.levels(0)[0], ERROR);
}

/// A backend is stale before its start, and in error with each of its messages; its status is between those of the drives and the recorder.
#[test]
fn backend_status_reports_problems_and_values() {
    let mut bench = Bench::new();
    let backend = |health| BackendHealth { name: "bus0".to_owned(), hardware: "socketcan:can0".to_owned(), health };
    let health = |problems: &[&str]| {
        let problems = problems.iter().map(|&problem| problem.to_owned()).collect();
        Some(Health { problems, values: vec![("drives in operation", "1 of 2".to_owned())], ..Health::default() })
    };
    let mut status = |health| {
        let backends = [backend(health)];
        let findings = bench.judge.evaluate(&bench.snapshot, bench.begin, &backends, &Recorder::Unknown);
        let words = StatusData { node: "cell", state: "active", error: &|_, _| None };
        let all = bench.judge.describe(&findings, &bench.snapshot, &backends, &Recorder::Unknown, &words);
        assert_eq!(findings.levels(), all.iter().map(|status| status.level).collect::<Vec<_>>());
        all[2].clone()
    };
    let (before, good) = (status(None), status(health(&[])));
    assert_eq!((before.level, before.message.as_str()), (STALE, "not started"));
    assert_eq!((good.level, good.name.as_str(), good.message.as_str()), (OK, "cell: backend bus0", "in operation"));
    assert_eq!((good.hardware_id.as_str(), value(&good, "drives in operation")), ("socketcan:can0", "1 of 2"));
    let bad = status(health(&["node 3 (x): it is silent", "node 4 (y): it has booted"]));
    assert_eq!((bad.level, bad.message.as_str()), (ERROR, "node 3 (x): it is silent; node 4 (y): it has booted"));
}
