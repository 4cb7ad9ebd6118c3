//! Replays a recorded run with the core, cycle by cycle, and compares the result bit by bit.
//!
//! Law      the same cell, inputs and commands in the same cycles give the same signals and messages. Of wall time only
//!          log times are used, and how far the recorded stamps are ahead of them
//! Reads    a [`Run`] with the attachment `cell.yaml`: it replays commands and inputs, and compares everything else.
//!          Values that were stored before the run are the attachment `store.yaml`. A run that does not begin with
//!          cycle 0 begins with the attachment `machine_state`
//! Refuses  a run without cell or inputs, a changed cell, a state of another version or cell
//!
//! All messages of a cycle have the same log time; their order is arbitrary.

mod compare;
mod group;
mod report;

pub use compare::Difference;
pub use report::{Report, Verdict};

use super::bag::STAMPS_AHEAD;
use super::encoder::Encoder;
use super::run::{Run, RunError};
use super::{CLOCK_STEP_NS, Cycle, CycleTime, inputs, verb};
use crate::cell::Cell;
use crate::document::Problems;
use crate::store::read_store;
use compare::Comparison;
use group::Group;
use lineshaft_core::command::{Command, Commands, Setpoints, Source};
use lineshaft_core::drive::{Inputs, Outputs};
use lineshaft_core::machine::{Machine, StateError};
use lineshaft_msgs::msg::CycleInputs;
use verb::Applied;

/// Reason why a run cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The bag cannot be read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The bag was not recorded by this program.
    #[error(
        "there is no attachment cell.yaml: only what lineshaft recorded can be replayed; `lineshaft validate` compares \
         other bags"
    )]
    NoCell,
    /// The bag has no inputs.
    #[error("there is no message of type lineshaft_msgs/msg/CycleInputs: without inputs nothing can be replayed")]
    NoInputs,
    /// The bag has only inputs and commands.
    #[error("there is nothing to compare with: no signals, events, axis states or joint states")]
    NothingToCompare,
    /// The cell is not the recorded one.
    #[error("the attached cell.yaml was changed after the recording: its SHA-256 is {found}, {recorded} was recorded")]
    ChangedCell {
        /// SHA-256 of the attachment.
        found: String,
        /// Recorded SHA-256.
        recorded: String,
    },
    /// The cell has errors in this version.
    #[error("the attached cell has errors:\n{0}")]
    Cell(Problems),
    /// The stored values do not fit the cell in this version.
    #[error("the attached store does not fit the attached cell:\n{0}")]
    Store(Problems),
    /// The bag begins in the middle of a run, without a state.
    #[error("the recording begins with cycle {0} and holds no state of the machine to begin with")]
    NoState(u64),
    /// The state cannot be read.
    #[error("the attached state of the machine cannot be read by version {version}: {reason}")]
    BadState {
        /// Version of this program.
        version: &'static str,
        /// Reason.
        reason: String,
    },
    /// The state does not belong to the first cycle.
    #[error("the attached state of the machine is that before cycle {state}; the inputs begin with cycle {inputs}")]
    OtherCycle {
        /// Cycle of the state.
        state: u64,
        /// Cycle of the first inputs.
        inputs: u64,
    },
    /// No machine can be made from the state or the cell.
    #[error("the attached state and cell make no machine: {0}")]
    Machine(#[from] StateError),
    /// A message is invalid.
    #[error("{topic}: the message recorded at {log_time} ns cannot be read: {reason}")]
    Message {
        /// Message type or topic.
        topic: String,
        /// Log time, in ns.
        log_time: u64,
        /// Reason.
        reason: String,
    },
}

/// Replays a run up to its first difference.
///
/// # Errors
/// Returns an error if the run cannot be replayed at all or is damaged.
pub fn replay(run: &mut Run) -> Result<Report, ReplayError> {
    let cell = attached_cell(run)?;
    let record = run.metadata("lineshaft");
    // In bags without this key, stamps and log times are equal.
    let ahead_ns = record.and_then(|record| record.get(STAMPS_AHEAD)?.parse().ok()).unwrap_or(0);
    let mut player = Player::new(cell, run.attachment_of(0, "machine_state")?, record.is_some(), ahead_ns);
    let cut: Vec<bool> = run.files().iter().map(|file| file.cut.is_some()).collect();
    let mut group = Group::default();
    let mut verdict = None;
    while verdict.is_none() {
        match run.next_message()? {
            Some(message) if group.is_of(message.log_time) => group.add(&message)?,
            next => {
                // In a file that was cut off, the last cycle may be incomplete.
                let is_last = next.is_none_or(|next| next.file != group.file);
                let is_whole = !(is_last && cut.get(group.file) == Some(&true));
                verdict = player.play(&group, is_whole)?;
                group.clear();
                match next {
                    Some(message) => group.add(&message)?,
                    None => break,
                }
            }
        }
    }
    if player.cycles == 0 && verdict.is_none() {
        return Err(ReplayError::NoInputs);
    }
    let report = player.report(run, verdict.unwrap_or(Verdict::Same));
    if report.verdict == Verdict::Same && report.values == 0 && report.messages == 0 {
        return Err(ReplayError::NothingToCompare);
    }
    Ok(report)
}

fn attached_cell(run: &Run) -> Result<Cell, ReplayError> {
    let bytes = run.attachment("cell.yaml")?.ok_or(ReplayError::NoCell)?;
    let text = String::from_utf8_lossy(&bytes);
    if let Some(recorded) = run.metadata("lineshaft").and_then(|metadata| metadata.get("cell_sha256")) {
        let found = super::sha256(text.as_bytes());
        if found != *recorded {
            return Err(ReplayError::ChangedCell { found, recorded: recorded.clone() });
        }
    }
    let files = super::attached_files(run)?;
    let mut cell = Cell::parse_recorded("cell.yaml", text, files.as_deref()).map_err(ReplayError::Cell)?;
    if let Some(bytes) = run.attachment("store.yaml")? {
        let text = String::from_utf8_lossy(&bytes);
        let stored = read_store("store.yaml", &text, &cell.machine).map_err(ReplayError::Store)?;
        stored.put_into(&mut cell.machine);
    }
    Ok(cell)
}

/// Replays one cycle after the other.
struct Player {
    /// Whether this program made the recording.
    is_ours: bool,
    cell: Cell,
    state: Option<Vec<u8>>,
    /// Time by which stamps are ahead of log times in the first cycle, in ns.
    ahead_ns: i64,
    stage: Option<Stage>,
    /// Number of replayed cycles.
    cycles: u64,
    first: u64,
}

/// State of the replay, from the first inputs on.
struct Stage {
    machine: Machine,
    encoder: Encoder,
    inputs: Inputs,
    outputs: Outputs,
    comparison: Comparison,
    /// Time by which stamps are ahead of log times, in ns.
    ahead_ns: i64,
    /// Log time of the previous cycle, in ns.
    log_ns: Option<u64>,
}

impl Player {
    fn new(cell: Cell, state: Option<Vec<u8>>, is_ours: bool, ahead_ns: i64) -> Self {
        Self { is_ours, cell, state, ahead_ns, stage: None, cycles: 0, first: 0 }
    }

    /// Replays the cycle of a group; returns a verdict if the replay cannot continue.
    fn play(&mut self, group: &Group, is_whole: bool) -> Result<Option<Verdict>, ReplayError> {
        let expected = self.stage.as_ref().map(|stage| stage.machine.next_cycle());
        let Some(recorded) = &group.inputs else {
            let is_gap = is_whole && group.is_of_a_cycle(self.is_ours);
            return Ok(expected.filter(|_| is_gap).map(|first| Verdict::Gap { first, next: first + 1 }));
        };
        let cycle = recorded.message.cycle;
        if let Some(first) = expected.filter(|&expected| expected != cycle) {
            return Ok(Some(Verdict::Gap { first, next: cycle }));
        }
        let mut stage = match self.stage.take() {
            Some(stage) => stage,
            None => {
                self.first = cycle;
                let stage = Stage::new(&self.cell, cycle, self.state.take(), self.is_ours)?;
                Stage { ahead_ns: self.ahead_ns, ..stage }
            }
        };
        let difference = stage.play(group, &recorded.message, recorded.crc, is_whole)?;
        self.stage = Some(stage);
        self.cycles += 1;
        Ok(difference.map(Verdict::Differs))
    }

    fn report(self, run: &Run, verdict: Verdict) -> Report {
        let counts = self.stage.map(|stage| stage.comparison.counts).unwrap_or_default();
        Report::new(run, verdict, self.first, self.cycles, counts)
    }
}

impl Stage {
    /// Creates a machine before cycle `first`.
    fn new(cell: &Cell, first: u64, state: Option<Vec<u8>>, is_ours: bool) -> Result<Self, ReplayError> {
        let config = cell.machine.clone();
        let machine = match state {
            None if first == 0 => Machine::new(config).map_err(StateError::Config)?,
            None => return Err(ReplayError::NoState(first)),
            Some(bytes) => {
                let state = postcard::from_bytes(&bytes).map_err(|error| ReplayError::BadState {
                    version: env!("CARGO_PKG_VERSION"),
                    reason: error.to_string(),
                })?;
                Machine::restore(config, state)?
            }
        };
        if machine.next_cycle() != first {
            return Err(ReplayError::OtherCycle { state: machine.next_cycle(), inputs: first });
        }
        Ok(Self {
            encoder: Encoder::new(cell, machine.config(), machine.directory()),
            inputs: machine.inputs(),
            outputs: machine.outputs(),
            comparison: Comparison::new(machine.directory(), is_ours),
            ahead_ns: 0,
            log_ns: None,
            machine,
        })
    }

    fn play(
        &mut self,
        group: &Group,
        recorded: &CycleInputs,
        crc: u32,
        is_whole: bool,
    ) -> Result<Option<Difference>, ReplayError> {
        let config = self.machine.config();
        inputs::read_inputs(recorded, config, &mut self.inputs).map_err(|reason| group.bad("CycleInputs", reason))?;
        let (commands, stream) = self.commands(group)?;
        let stream = stream.as_ref();
        self.machine.cycle(&self.inputs, Commands { stream, ..Commands::queue(&commands) }, &mut self.outputs);
        self.follow_step(group);
        let cycle = Cycle {
            time: CycleTime { log_ns: group.log_time, stamp_ns: group.log_time.saturating_add_signed(self.ahead_ns) },
            inputs: &self.inputs,
            commands: &commands,
            stream,
            events: self.machine.events(),
            board: self.machine.board(),
        };
        let encoded = self.encoder.encode(&cycle);
        self.comparison.compare(group, crc, &encoded, self.machine.board(), is_whole)
    }

    /// Follows a step of the system clock. It is no input of the machine and appears only in stamps. A smaller
    /// difference is no step; the comparison of messages finds it. A gap without cycles is an exception: steps within
    /// it have no event, and only their sum is visible.
    fn follow_step(&mut self, group: &Group) {
        let before = self.log_ns.replace(group.log_time);
        let is_gap = before.is_some_and(|before| group.log_time.saturating_sub(before) > CLOCK_STEP_NS);
        let Some(stamp_ns) = group.stamp_ns() else { return };
        let ahead_ns = CycleTime { log_ns: group.log_time, stamp_ns }.ahead_ns();
        if is_gap || ahead_ns.abs_diff(self.ahead_ns) > CLOCK_STEP_NS {
            self.ahead_ns = ahead_ns;
        }
    }

    /// Returns the commands in the order in which they were applied, and the setpoints.
    fn commands(&self, group: &Group) -> Result<(Vec<Command>, Option<Setpoints>), ReplayError> {
        let (mut commands, mut stream) = (Vec::new(), None::<Setpoints>);
        for applied in &group.commands {
            let bad = |reason: String| group.bad("AppliedCommand", reason);
            if applied.cycle != self.machine.next_cycle() {
                let (of, cycle) = (applied.cycle, self.machine.next_cycle());
                return Err(bad(format!("it is of cycle {of} and stands among those of cycle {cycle}")));
            }
            let source = source(&applied.source).ok_or_else(|| {
                bad(format!("source is `{}`; ros, scenario, cli, machine are allowed", applied.source))
            })?;
            let (config, directory) = (self.machine.config(), self.machine.directory());
            match verb::applied_from_json(&applied.command, source, config, directory).map_err(bad)? {
                Applied::Command(action) => commands.push(Command { sequence: applied.sequence, source, action }),
                Applied::Stream(newer) => match &mut stream {
                    Some(stream) => stream.merge(&newer),
                    None => stream = Some(newer),
                },
            }
        }
        Ok((commands, stream))
    }
}

fn source(name: &str) -> Option<Source> {
    let all = [Source::Ros, Source::Scenario, Source::Cli, Source::Machine];
    all.into_iter().find(|source| source.name() == name)
}

#[cfg(test)]
mod tests;
