//! `lineshaft tune`.

mod real;

use self::real::{RealError, try_real};
use super::record::RecordArgs;
use super::store::{self, StoreArgs};
use super::{Exit, complain, say, times};
use crate::cell::{Cell, CellBackend};
use crate::cell_file::EditError;
use crate::document::Problems;
use crate::interrupt::Interrupt;
use crate::recording::plot::{Problem, Target};
use crate::tune::{Bounds, Findings, Setting, Subject, TrialError, Unfit, apply, by_hand, try_until, write_plot};
use clap::Args;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::unit::{Quantity, Scale, parse_decimal};
use lineshaft_ros::layer::NodeName;
use lineshaft_tune::{Record, Refusal};
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Runs the cell without ROS, simulated drives as fast as it goes, real ones only with --real: enables the axis, opens its position loop (out_an), finds where it breaks away, moves it to and fro by \
random steps of its velocity or effort, and disables it. From what it did a model is made, and of the model gains with a phase margin of 60 deg and \
a gain margin of 6 dB. Printed is the model with its deviations, old and new gains, and what both do with a step and a move. Nothing is \
written without --apply. A value has a unit: 90 deg, 200 mm/s, 20000 inc. A number without a unit is in SI (m, rad, m/s, rad/s), and \
the first line of the output says so.

Examples:
  lineshaft tune cell.yaml x
  lineshaft tune cell.yaml x --travel '90 deg' --velocity '500 deg/s' --output x.svg
  lineshaft tune cell.yaml x --apply
  lineshaft tune cell.yaml x --real --travel '20 mm' --velocity '50 mm/s'

Ctrl-C stops the axis and switches it off. Exit codes: 0 gains were found, 1 none: the sentence says why, 2 bad usage or a file with errors.";

#[derive(Debug, Args)]
pub(super) struct TuneArgs {
    /// The cell
    cell: PathBuf,
    /// The axis
    axis: String,
    /// Way either side of where the axis stands (at least 100 inc); left out: what it goes in 0.4 s at that velocity, or what it needs to stop; less where its limits leave less
    #[arg(long, value_name = "LENGTH")]
    travel: Option<String>,
    /// Largest velocity, to `max_velocity`; left out: 30 % of it
    #[arg(long, value_name = "VELOCITY")]
    velocity: Option<String>,
    /// Largest effort in parts of the largest one (0.01 to 1), for interface torque; left out: 0.3
    #[arg(long, value_name = "PART")]
    effort: Option<f64>,
    /// Time of the motion to and fro, as `6 s` (1 s to 60 s); left out: 6 s
    #[arg(long, value_name = "TIME", value_parser = times::seconds)]
    duration: Option<f64>,
    /// Inertia of the load in parts of the motor's (0 to 1000), for interface torque with the encoder on the motor: gains that keep their margins within play, too; left out, or 0: an axis with play gets no gains
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    inertia_ratio: Option<f64>,
    /// Draw what was found: FILE.svg or FILE.png; one that exists is replaced
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the gains into the cell
    #[arg(long)]
    apply: bool,
    /// Put simulation in the place of every backend
    #[arg(long)]
    sim: bool,
    /// Permits that a cell with real drives moves the axis
    #[arg(long, conflicts_with = "sim")]
    real: bool,
    #[command(flatten)]
    record: RecordArgs,
    #[command(flatten)]
    store: StoreArgs,
}

/// Reason why tuning failed.
#[derive(Debug, thiserror::Error)]
enum TuneError {
    #[error("{0}")]
    Cell(Problems),
    #[error("{0}; --real permits that, with --sim a simulation takes the place of all drives")]
    Leave(String),
    #[error(transparent)]
    Real(#[from] RealError),
    #[error("{0}")]
    Name(String),
    #[error(transparent)]
    Unfit(#[from] Unfit),
    #[error("--{name}: {sentence}")]
    Amount { name: &'static str, sentence: String },
    #[error(transparent)]
    Run(#[from] TrialError),
    #[error("{axis}: {sentence}")]
    Trial { axis: String, sentence: String },
    #[error("{axis}: {refusal}")]
    Refused { axis: String, refusal: Refusal },
    #[error("{0}")]
    Plot(#[from] Problem),
    #[error("{error}\nthe lines for {axis} by hand:\n{lines}")]
    Apply { axis: String, error: EditError, lines: String },
}

impl TuneError {
    fn exit(&self) -> Exit {
        match self {
            Self::Trial { .. }
            | Self::Refused { .. }
            | Self::Real(RealError::Run(_))
            | Self::Run(TrialError::Record(_)) => Exit::Failed,
            Self::Run(TrialError::Interrupted(signal)) => Exit::Signal(*signal),
            _ => Exit::Usage,
        }
    }
}

pub(super) fn tune(args: &TuneArgs) -> Exit {
    match try_axis(args) {
        Ok(exit) => exit,
        Err(TuneError::Cell(problems)) => {
            eprint!("{problems}");
            Exit::Usage
        }
        Err(error) => {
            complain(&error);
            error.exit()
        }
    }
}

fn try_axis(args: &TuneArgs) -> Result<Exit, TuneError> {
    // Names are checked before anything moves.
    args.output.as_deref().map(Target::of).transpose()?;
    let mut cell = Cell::load(&args.cell).map_err(TuneError::Cell)?;
    let is_simulated = args.sim || cell.backends.iter().all(CellBackend::is_simulated);
    // A real axis has the limits that its node has stored.
    let opened = if is_simulated {
        store::open(&args.store, &mut cell)
    } else {
        let name =
            NodeName::new(&cell.ros.namespace, &cell.ros.name).map_err(|error| TuneError::Name(error.to_string()))?;
        store::open_for_node(&args.store, &mut cell, &name, Some(&args.cell))
    };
    let Ok(_store) = opened else { return Ok(Exit::Usage) };
    let config = &cell.machine;
    let setting = Setting::of(config, &args.axis, |place| config.axes[place].power_on(), &bounds(args, config)?)?;
    if !is_simulated && !args.real {
        return Err(TuneError::Leave(setting.permission_question(&config.axes[usize::from(setting.axis)])));
    }
    let axis = &config.axes[usize::from(setting.axis)];
    for (name, text, order) in [("travel", &args.travel, 0), ("velocity", &args.velocity, 1)] {
        if let Some(line) = text.as_ref().and_then(|text| reading(&axis.scale, name, text, order)) {
            say(&line);
        }
    }
    let record = run(args, &cell, setting, is_simulated)?;
    let subject = Subject::of(axis, &axis.power_on());
    let refused = |refusal| TuneError::Refused { axis: args.axis.clone(), refusal };
    let findings = Findings::find(subject, &record, &setting.wish, &setting.before).map_err(refused)?;
    say(&findings.text().trim_end());
    if let Some(path) = &args.output {
        write_plot(&findings, &record, path)?;
        say(&path.display());
    }
    if findings.gains.is_empty() {
        return Ok(Exit::Failed);
    }
    if args.apply {
        let by_hand = |error| TuneError::Apply {
            axis: args.axis.clone(),
            error,
            lines: by_hand(&findings.gains).trim_end().to_owned(),
        };
        let written = apply(&args.cell, &cell.text, &args.axis, &findings.gains).map_err(by_hand)?;
        let keys = written.iter().map(|gain| gain.key).collect::<Vec<_>>().join(", ");
        let keys = if keys.is_empty() { "nothing new".to_owned() } else { keys };
        say(&format_args!("{}: {} written for {}", args.cell.display(), keys, args.axis));
    }
    Ok(Exit::Good)
}

/// Returns the bounds in increments.
fn bounds(args: &TuneArgs, config: &MachineConfig) -> Result<Bounds, TuneError> {
    let Some(scale) = config.axes.iter().find(|axis| axis.name == args.axis).map(|axis| axis.scale) else {
        return Ok(Bounds::default());
    };
    let amount = |name, text: &Option<String>, order| {
        let amount = text.as_ref().map(|text| increments(&scale, text, order)).transpose();
        amount.map_err(|sentence| TuneError::Amount { name, sentence })
    };
    Ok(Bounds {
        travel: amount("travel", &args.travel, 0)?,
        velocity: amount("velocity", &args.velocity, 1)?,
        effort: args.effort,
        duration: args.duration,
        inertia_ratio: args.inertia_ratio,
    })
}

fn increments(scale: &Scale, text: &str, order: u8) -> Result<f64, String> {
    let unit = scale.unit().unit();
    let quantity = Quantity::parse(text, &scale.dimensions(order))
        .map_err(|error| error.message_with_example(scale.kind().dimension(order), unit))?;
    scale.rate(&quantity, order).map_err(|error| error.message_with_hint())
}

/// Returns a note with the unit in which a number without unit was read, and its value in the axis unit; `None` if a
/// unit is given.
fn reading(scale: &Scale, name: &str, text: &str, order: u8) -> Option<String> {
    let number = text.trim();
    parse_decimal(number).ok()?;
    let quantity = Quantity::parse(number, &scale.dimensions(order)).ok()?;
    let rate = scale.rate(&quantity, order).ok()?;
    let own = if order == 0 { scale.format_increments(rate.round() as i64) } else { scale.format_rate(rate, order) };
    let si = quantity.to_string();
    let read = if si == own { si } else { format!("{si} ({own})") };
    Some(format!("--{name} {number} has no unit: it is read as {read}"))
}

/// Runs the trial; returns its record.
fn run(args: &TuneArgs, cell: &Cell, setting: Setting, is_simulated: bool) -> Result<Record, TuneError> {
    let (ended, record) = if is_simulated {
        let interrupt = Interrupt::listen()
            .map_err(|error| RealError::Run(format!("signals of the system cannot be received: {error}")))?;
        try_until(cell, setting, args.record.options().as_ref(), |_| {}, &interrupt)?
    } else {
        try_real(args, cell, setting)?
    };
    match ended.sentence(&cell.machine, &setting) {
        None => Ok(record),
        Some(sentence) => Err(TuneError::Trial { axis: args.axis.clone(), sentence }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::unit::{Fraction, Unit};

    fn quantity(number: i128, unit: Unit) -> Quantity {
        Quantity::new(Fraction::from(number), unit)
    }

    /// 4 rad/s are 4 * 180 / pi = 229.183118 deg/s.
    #[test]
    fn number_without_a_unit_is_shown_with_the_unit_that_it_is_read_in() {
        let turn = Scale::new(Fraction::from(36_000), quantity(360, Unit::DEGREE)).unwrap();
        let turn = turn.with_unit(Unit::DEGREE).unwrap();
        let of = |name, text, order| reading(&turn, name, text, order);
        assert_eq!(
            of("velocity", "4", 1).unwrap(),
            "--velocity 4 has no unit: it is read as 4 rad/s (229.183118 deg/s)"
        );
        assert_eq!(of("velocity", "4 rad/s", 1), None);
        assert_eq!(of("velocity", "4 furlongs", 1), None);
        let millimetre = Scale::new(Fraction::from(1000), quantity(1, Unit::MILLIMETRE)).unwrap();
        let refused = |text: &str| increments(&turn, text, 1).unwrap_err();
        assert_eq!(refused("fast"), "`fast` is not a number; an angular velocity such as `1 deg/s` is expected");
        assert_eq!(refused("5 mm/s"), "`5 mm/s` is a velocity; an angular velocity such as `5 deg/s` is expected");
        assert_eq!(refused("5deg/s"), "`5deg/s` has no blank between number and unit; write `5 deg/s`");
        assert_eq!(
            refused("5 rad/sec"),
            "`rad/sec` in `5 rad/sec` is not a unit; an angular velocity has deg/s, rad/s, rev/s, rpm; did you mean `rad/s`?"
        );
        let line = reading(&millimetre, "travel", " 0.02 ", 0).unwrap();
        assert_eq!(line, "--travel 0.02 has no unit: it is read as 0.02 m");
    }
}
