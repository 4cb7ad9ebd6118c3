//! `lineshaft tune`.

use super::{Exit, TuneArgs, complain, say, store};
use crate::cell::Cell;
use crate::document::Problems;
use crate::recording::encoder::sentence;
use crate::recording::plot::{Problem, Target};
use crate::tune::{
    ApplyError, Bounds, Ended, Findings, Setting, Subject, TrialError, Unfit, apply, by_hand, try_simulated, write_plot,
};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::state::AXIS_STATES;
use lineshaft_core::unit::{Quantity, Scale};
use lineshaft_tune::{Record, Refusal};

/// Why nothing was tuned.
#[derive(Debug, thiserror::Error)]
enum TuneError {
    #[error("{0}")]
    Cell(Problems),
    #[error(
        "{axis} is a real drive: this command tries simulated ones. With --sim a simulation takes its place, as the cell describes it"
    )]
    Real { axis: String },
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
    Apply { axis: String, error: ApplyError, lines: String },
}

impl TuneError {
    fn exit(&self) -> Exit {
        match self {
            Self::Trial { .. } | Self::Refused { .. } | Self::Run(TrialError::Record(_)) => Exit::Failed,
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
    // What is wrong with the names is said before anything moves.
    args.output.as_deref().map(Target::of).transpose()?;
    let mut cell = Cell::load(&args.cell).map_err(TuneError::Cell)?;
    let Ok(_store) = store::open(&args.store, &mut cell) else { return Ok(Exit::Usage) };
    let config = &cell.machine;
    let setting = Setting::of(config, &args.axis, |place| config.axes[place].power_on(), &bounds(args, config)?)?;
    let is_real = cell.backends.iter().any(|backend| !backend.is_simulated());
    if is_real && !args.sim {
        return Err(TuneError::Real { axis: args.axis.clone() });
    }
    let record = run(args, &cell, setting)?;
    let subject = Subject::of(&config.axes[usize::from(setting.axis)]);
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
        let written = apply(&args.cell, &args.axis, &findings.gains).map_err(by_hand)?;
        let keys = written.iter().map(|gain| gain.key).collect::<Vec<_>>().join(", ");
        let keys = if keys.is_empty() { "nothing new".to_owned() } else { keys };
        say(&format_args!("{}: {} written for {}", args.cell.display(), keys, args.axis));
    }
    Ok(Exit::Good)
}

/// The bounds in increments.
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
    })
}

fn increments(scale: &Scale, text: &str, order: u8) -> Result<f64, String> {
    let quantity = Quantity::parse(text, &scale.dimensions(order)).map_err(|error| error.to_string())?;
    scale.rate(&quantity, order).map_err(|error| error.to_string())
}

/// What the axis did.
fn run(args: &TuneArgs, cell: &Cell, setting: Setting) -> Result<Record, TuneError> {
    let (ended, record) = try_simulated(cell, setting, args.record.options().as_ref(), |_| {})?;
    match said(ended, &cell.machine, setting) {
        None => Ok(record),
        Some(sentence) => Err(TuneError::Trial { axis: args.axis.clone(), sentence }),
    }
}

/// Why there is no whole record; none where there is one.
fn said(ended: Ended, config: &MachineConfig, setting: Setting) -> Option<String> {
    Some(match ended {
        Ended::Done => return None,
        Ended::Aborted(abort) => abort.to_string(),
        Ended::Failed(event) => format!("{} (code {})", sentence(&event, std::iter::empty(), config), event.code.0),
        Ended::Interrupted(state) => {
            let name = usize::try_from(state).ok().and_then(|place| AXIS_STATES.get(place)).unwrap_or(&"unknown");
            format!("somebody else has stopped or moved it; it is in state {name}")
        }
        Ended::NoRoom(travel) => format!(
            "the software limits leave {:.0} inc either way of where it stands; a travel of {:.0} inc was asked for",
            travel.max(0.0),
            setting.permitted.travel
        ),
        Ended::Late => "it took too long, which an excitation of this axis should not".to_owned(),
    })
}
