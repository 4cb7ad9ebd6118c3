//! Evaluates cycle, drives, backends and recorder for `/diagnostics`.

use super::Recorder;
use crate::surface::history::error_state_text;
use crate::surface::host::{BackendHealth, Snapshot};
use crate::surface::messages::AxisView;
use lineshaft_core::code::Code;
use lineshaft_core::drive::DriveState;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::signal::{Directory, Signal};
use lineshaft_core::state::{AXIS_STATES, AxisState, DRIVE_STATES};
use lineshaft_msgs::foreign::diagnostic_msgs::msg::{DiagnosticStatus, KeyValue};
use std::time::{Duration, Instant};

/// Number of cycle times without a new cycle after which the cycle counts as stale, but at least [`LEAST_STALE`].
const STALE_CYCLES: u64 = 10;
/// Minimum time for [`STALE_CYCLES`].
const LEAST_STALE: Duration = Duration::from_millis(100);
/// Duration of the warning about missed cycles.
const WARNING_TIME: Duration = Duration::from_secs(1);
/// Hardware ID of statuses that belong to no drive.
const NO_HARDWARE: &str = "none";
/// `machine.state` if an axis is in error.
const MACHINE_ERROR: i64 = 2;

/// Finding about the cycle, a drive, a backend or the recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    Good,
    /// No cycle runs.
    Stale,
    /// Number of cycles missed within the last second.
    Missed(u64),
    /// An axis is in error.
    AxisError,
    Error(Code),
    DriveFault,
    DriveAway,
    Locked,
    DriveWarns,
    /// Number of cycles missing in the recording.
    Lost(u64),
    RecorderGone,
    /// Number of problems of a backend.
    BackendTroubles(usize),
}

impl Finding {
    fn level(self) -> u8 {
        use Finding::{
            AxisError, BackendTroubles, DriveAway, DriveFault, DriveWarns, Error, Good, Locked, Lost, Missed,
            RecorderGone,
        };
        match self {
            Good => DiagnosticStatus::OK,
            Missed(_) | Locked | DriveWarns | Lost(_) => DiagnosticStatus::WARN,
            AxisError | Error(_) | DriveFault | DriveAway | RecorderGone | BackendTroubles(_) => {
                DiagnosticStatus::ERROR
            }
            Finding::Stale => DiagnosticStatus::STALE,
        }
    }
}

/// Findings of one evaluation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Findings {
    pub machine: Finding,
    /// Findings by index of the drives.
    pub drives: Vec<Finding>,
    /// Findings of backends that report details.
    pub backends: Vec<Finding>,
    pub recorder: Finding,
}

impl Findings {
    /// Returns the levels, in the order of the statuses.
    pub(super) fn levels(&self) -> Vec<u8> {
        let others = self.drives.iter().chain(&self.backends).copied();
        [self.machine].into_iter().chain(others).chain([self.recorder]).map(Finding::level).collect()
    }
}

/// Data for the messages in addition to signals.
pub(super) struct StatusData<'a> {
    /// Name of the node.
    pub node: &'a str,
    /// Lifecycle state.
    pub state: &'a str,
    /// Returns the message about an error of an axis.
    pub error: &'a dyn Fn(u16, Code) -> Option<String>,
}

/// Axis with a drive.
struct Drive {
    /// Index of the axis.
    axis: u16,
    view: AxisView,
    hardware: String,
}

/// Evaluates successive snapshots.
pub(super) struct DiagnosticsEvaluator {
    drives: Vec<Drive>,
    /// Signals state, error and overruns of the machine.
    machine: Option<[Signal; 3]>,
    /// Time without a new cycle after which the cycle is stale.
    patience: Duration,
    /// Newest cycle, and the time when it was first seen.
    newest: (Option<u64>, Instant),
    /// Number of missed cycles at the last evaluation.
    missed: u64,
    /// Number of newly missed cycles, and the end of the warning about them.
    warned: Option<(u64, Instant)>,
}

impl DiagnosticsEvaluator {
    pub(super) fn new(
        views: Vec<AxisView>,
        hardware: Vec<Option<String>>,
        directory: &Directory,
        cycle_ns: u64,
        now: Instant,
    ) -> Self {
        let drives = views.into_iter().zip(0_u16..).filter(|(view, _)| !view.is_virtual);
        let drives = drives.map(|(view, axis)| {
            let hardware = hardware.get(usize::from(axis)).cloned().flatten();
            Drive { axis, view, hardware: hardware.unwrap_or_else(|| NO_HARDWARE.to_owned()) }
        });
        Self {
            drives: drives.collect(),
            machine: machine_signals(directory),
            patience: Duration::from_nanos(cycle_ns.saturating_mul(STALE_CYCLES)).max(LEAST_STALE),
            newest: (None, now),
            missed: 0,
            warned: None,
        }
    }

    /// Evaluates the present state.
    pub(super) fn evaluate(
        &mut self,
        snapshot: &Snapshot,
        now: Instant,
        backends: &[BackendHealth],
        recorder: &Recorder,
    ) -> Findings {
        let backends = backends.iter().map(judge_backend).collect();
        let recorder = match recorder {
            Recorder::Gone => Finding::RecorderGone,
            Recorder::Status(status) if status.recording && status.lost > 0 => Finding::Lost(status.lost),
            _ => Finding::Good,
        };
        if self.is_stale(snapshot, now) {
            return Findings {
                machine: Finding::Stale,
                drives: vec![Finding::Stale; self.drives.len()],
                backends,
                recorder,
            };
        }
        let drives = self.drives.iter().map(|drive| judge_drive(&drive.view, snapshot)).collect();
        Findings { machine: self.judge_machine(snapshot, now), drives, backends, recorder }
    }

    fn is_stale(&mut self, snapshot: &Snapshot, now: Instant) -> bool {
        // A snapshot before the first cycle has no time.
        if snapshot.stamp_ns == 0 {
            return true;
        }
        if self.newest.0 != Some(snapshot.cycle) {
            self.newest = (Some(snapshot.cycle), now);
        }
        now.saturating_duration_since(self.newest.1) > self.patience
    }

    fn judge_machine(&mut self, snapshot: &Snapshot, now: Instant) -> Finding {
        let Some([state, _, overruns]) = self.machine else { return Finding::Good };
        let missed = snapshot.board.int(overruns).cast_unsigned();
        let more = missed.saturating_sub(std::mem::replace(&mut self.missed, missed));
        let before = self.warned.filter(|(_, until)| now < *until);
        self.warned = match more {
            0 => before,
            _ => Some((more.saturating_add(before.map_or(0, |(count, _)| count)), now + WARNING_TIME)),
        };
        if snapshot.board.int(state) == MACHINE_ERROR {
            return Finding::AxisError;
        }
        self.warned.map_or(Finding::Good, |(count, _)| Finding::Missed(count))
    }

    /// Returns the messages for an evaluation.
    pub(super) fn describe(
        &self,
        findings: &Findings,
        snapshot: &Snapshot,
        backends: &[BackendHealth],
        recorder: &Recorder,
        words: &StatusData<'_>,
    ) -> Vec<DiagnosticStatus> {
        let mut all = vec![self.describe_machine(findings.machine, snapshot, words)];
        let drives = self.drives.iter().zip(&findings.drives);
        all.extend(drives.map(|(drive, finding)| drive.describe(*finding, snapshot, words)));
        let backends = backends.iter().zip(&findings.backends);
        all.extend(backends.map(|(backend, finding)| describe_backend(backend, *finding, words)));
        all.push(describe_recorder(findings.recorder, recorder, words));
        all
    }

    fn describe_machine(&self, finding: Finding, snapshot: &Snapshot, words: &StatusData<'_>) -> DiagnosticStatus {
        let message = match finding {
            Finding::Stale => format!("no cycle runs; the node is {}", words.state),
            Finding::Missed(count) => format!("{count} cycles missed"),
            Finding::AxisError => "an axis is in error".to_owned(),
            _ => words.state.to_owned(),
        };
        let mut values = vec![pair("lifecycle", words.state), pair("cycle", snapshot.cycle)];
        if let Some([_, error, overruns]) = self.machine {
            values.push(pair("missed cycles", snapshot.board.int(overruns)));
            values.push(pair("error code", snapshot.board.int(error)));
        }
        status(finding, words.node, "machine", message, NO_HARDWARE, values)
    }
}

fn machine_signals(directory: &Directory) -> Option<[Signal; 3]> {
    let of = |name| directory.find(name);
    Some([of("machine.state")?, of("machine.error")?, of("machine.overruns")?])
}

impl Drive {
    fn describe(&self, finding: Finding, snapshot: &Snapshot, words: &StatusData<'_>) -> DiagnosticStatus {
        let (view, board) = (&self.view, &snapshot.board);
        let named = |names: &[&'static str], place: i64| {
            usize::try_from(place).ok().and_then(|place| names.get(place).copied()).unwrap_or("?")
        };
        let name = |names: &[&'static str], signal| named(names, view.int(board, signal));
        let state = name(AXIS_STATES, AxisSignal::State);
        let code = Code(u32::try_from(view.int(board, AxisSignal::Error)).unwrap_or(u32::MAX));
        let error = || (words.error)(self.axis, code).unwrap_or_else(|| format!("{}: {}", view.name, code_name(code)));
        let message = match finding {
            Finding::Stale => format!("no cycle runs; the node is {}", words.state),
            Finding::Error(_) => error(),
            Finding::DriveFault => "the drive is in fault".to_owned(),
            Finding::DriveAway => "the drive does not answer, or is not ready".to_owned(),
            Finding::Locked => "stopped, and locked until ~/reset_errors".to_owned(),
            Finding::DriveWarns => "the drive warns".to_owned(),
            _ => state.to_owned(),
        };
        let row = if code.is_none() { None } else { code.row() };
        let (cause, remedy) = row.map_or(("none", "none"), |row| (row.cause, row.remedy));
        let last = view.int(board, AxisSignal::FaultCode);
        let bit = |signal| if view.bit(board, signal) { "yes" } else { "no" };
        let mut values = vec![
            pair("state", state),
            pair("drive state", name(DRIVE_STATES, AxisSignal::DriveState)),
            pair("enabled", bit(AxisSignal::Enabled)),
            pair("error code", code.0),
            pair("error", if code.is_none() { "none".to_owned() } else { error() }),
            pair("cause", cause),
            pair("remedy", remedy),
            pair(
                "last error",
                if last == 0 { "none".to_owned() } else { format!("{last}, {}", error_state_text(view, board)) },
            ),
            pair("command position", view.length_text(board, AxisSignal::CommandPosition)),
            pair("position", view.length_text(board, AxisSignal::ActualPosition)),
            pair("following error", view.length_text(board, AxisSignal::FollowingError)),
            pair("velocity", view.velocity_text(board, AxisSignal::ActualVelocity)),
            pair("effort", format!("{} (drive unit)", view.effort(board))),
            pair("drive warns", bit(AxisSignal::Warning)),
        ];
        if let Some((second, skew)) = view.second_drive(board) {
            values.extend([pair("second drive state", named(DRIVE_STATES, second)), pair("skew", skew)]);
        }
        status(finding, words.node, &view.name, message, &self.hardware, values)
    }
}

/// Returns the name of a code if its message is unknown: `following error`, `drive fault 0x2310`.
fn code_name(code: Code) -> String {
    if let Some(fault) = code.0.checked_sub(Code::DRIVE_FAULT).filter(|fault| *fault <= u32::from(u16::MAX)) {
        return format!("drive fault {fault:#06x}");
    }
    let row = Code::rows().find(|row| row.code == code);
    row.map_or_else(|| format!("error {}", code.0), |row| row.name.to_ascii_lowercase().replace('_', " "))
}

fn judge_drive(view: &AxisView, snapshot: &Snapshot) -> Finding {
    let board = &snapshot.board;
    let code = Code(u32::try_from(view.int(board, AxisSignal::Error)).unwrap_or(u32::MAX));
    let drive = view.int(board, AxisSignal::DriveState);
    let is = |state: DriveState| drive == state as i64;
    if !code.is_none() {
        Finding::Error(code)
    } else if is(DriveState::Fault) || is(DriveState::FaultReaction) {
        Finding::DriveFault
    } else if is(DriveState::NotReady) {
        Finding::DriveAway
    } else if view.int(board, AxisSignal::State) == AxisState::Stopping as i64 {
        Finding::Locked
    } else if view.bit(board, AxisSignal::Warning) {
        Finding::DriveWarns
    } else {
        Finding::Good
    }
}

fn judge_backend(backend: &BackendHealth) -> Finding {
    match backend.health.as_ref().map(|health| health.problems.len()) {
        None => Finding::Stale,
        Some(0) => Finding::Good,
        Some(count) => Finding::BackendTroubles(count),
    }
}

fn describe_backend(backend: &BackendHealth, finding: Finding, words: &StatusData<'_>) -> DiagnosticStatus {
    let part = format!("backend {}", backend.name);
    let Some(health) = &backend.health else {
        return status(finding, words.node, &part, "not started".to_owned(), &backend.hardware, vec![]);
    };
    let message = if health.problems.is_empty() { "in operation".to_owned() } else { health.problems.join("; ") };
    let values = health.values.iter().map(|(key, value)| pair(key, value)).collect();
    status(finding, words.node, &part, message, &backend.hardware, values)
}

fn describe_recorder(finding: Finding, recorder: &Recorder, words: &StatusData<'_>) -> DiagnosticStatus {
    let (message, values) = match (finding, recorder) {
        (Finding::RecorderGone, _) => ("the recorder has failed: nothing is recorded any more".to_owned(), vec![]),
        (_, Recorder::Status(status)) => {
            let message = match finding {
                Finding::Lost(lost) => format!("{lost} cycles are missing in the recording"),
                _ => status.message.clone(),
            };
            let values = vec![
                pair("recording", if status.recording { "yes" } else { "no" }),
                pair("bag", &status.path),
                pair("cycles", status.cycles),
                pair("size", format!("{} bytes", status.size)),
                pair("missing cycles", status.lost),
                pair("replayable", if status.replayable { "yes" } else { "no" }),
            ];
            (message, values)
        }
        _ => ("not asked yet".to_owned(), vec![]),
    };
    status(finding, words.node, "recorder", message, NO_HARDWARE, values)
}

fn pair(key: &str, value: impl ToString) -> KeyValue {
    KeyValue { key: key.to_owned(), value: value.to_string() }
}

/// Returns a status with a name in the format of the diagnostic tools of ROS.
fn status(
    finding: Finding,
    node: &str,
    part: &str,
    message: String,
    hardware: &str,
    values: Vec<KeyValue>,
) -> DiagnosticStatus {
    let name = format!("{node}: {part}");
    DiagnosticStatus { level: finding.level(), name, message, hardware_id: hardware.to_owned(), values }
}

#[cfg(test)]
mod tests;
