//! `lineshaft functions`.

use super::params::width;
use super::{Exit, say, say_all};
use crate::functions::{details, listing, markdown};
use crate::scenario::{did_you_mean, nearest};
use clap::{Args, value_parser};
use lineshaft_core::function::{Kind, Origin, TYPES, sak_factor};
use lineshaft_core::unit::{Dimension, Quantity, excerpt};

pub(super) const HELP: &str = "\
docs/functions.md explains the types. `sak` is the factor of the field of that name, with which a function cancels the following error \
of the axis that it moves: of the time between two calls, and of the gain of the position loop of that axis' drive.

Examples:
  lineshaft functions
  lineshaft functions varsync
  lineshaft functions sak --cycle '2 ms' --gain 1000

Exit codes: 0 good, 2 bad usage, no such type, or a factor that no function takes.";

/// Name of the compensation of the following error, used instead of a type.
const SAK: &str = "sak";
/// Range of the time between two calls of a slot, in ns.
const CALLS: std::ops::RangeInclusive<i64> = 125_000..=5_100_000_000;

#[derive(Debug, Args)]
pub(super) struct FunctionsArgs {
    /// A type as `varsync`: what it reads and writes, and its fields; or `sak`; left out: the list
    #[arg(value_name = "TYPE")]
    name: Option<String>,
    /// Of `sak`: time between two calls, as `2 ms`
    #[arg(long, value_name = "TIME", requires = "gain", value_parser = call)]
    cycle: Option<u64>,
    /// Of `sak`: gain of the position loop (rpm)
    #[arg(long, value_name = "RPM", requires = "cycle", value_parser = value_parser!(u32).range(1..))]
    gain: Option<u32>,
    /// Of `sak`: the function reads a pulse input, not the position of another drive
    #[arg(long, requires = "gain")]
    external: bool,
    /// Print the tables of docs/functions.md
    #[arg(long, conflicts_with_all = ["name", "cycle", "gain", "external"])]
    markdown: bool,
}

pub(super) fn functions(args: &FunctionsArgs) -> Exit {
    match (&args.name, args.cycle, args.gain) {
        _ if args.markdown => say_all(&markdown()),
        (Some(name), Some(cycle), Some(gain)) if name == SAK => return sak(cycle, gain, args.external),
        (Some(name), None, None) if name == SAK => return complain("sak needs --cycle and --gain"),
        (_, Some(_), _) => return complain("--cycle and --gain belong to `lineshaft functions sak`"),
        (None, ..) => say_all(&listing(width())),
        (Some(name), ..) => match Kind::find(name) {
            Some(kind) => say_all(&details(kind.description(), width())),
            None => return complain(&unknown(name)),
        },
    }
    Exit::Good
}

fn unknown(name: &str) -> String {
    let names = TYPES.iter().map(|row| row.name).chain([SAK]);
    let meant = nearest(name, names).map_or(String::new(), |meant| format!("{} ", did_you_mean(meant)));
    format!("no function type `{}`; {meant}`lineshaft functions` lists all", excerpt(name))
}

/// Prints the factor of the compensation.
fn sak(cycle_ns: u64, gain: u32, external: bool) -> Exit {
    let origin = if external { Origin::Pulses } else { Origin::Drive };
    match sak_factor(cycle_ns, gain, origin) {
        Some(factor) => {
            say(&factor);
            Exit::Good
        }
        None => complain(&format!(
            "with {gain} rpm in a cycle of {} ms the factor exceeds 32767, which no function takes",
            cycle_ns as f64 / 1e6
        )),
    }
}

fn complain(sentence: &str) -> Exit {
    super::complain(&sentence);
    Exit::Usage
}

/// Parses the time between two calls, in ns.
pub(super) fn call(text: &str) -> Result<u64, String> {
    let time = Quantity::parse(text, &[Dimension::Time]).map_err(|error| error.message_with_hint())?;
    let call = time.nanoseconds().map_err(|error| error.message_with_hint())?;
    if !CALLS.contains(&call) {
        return Err("125 us to 5.1 s is allowed".to_owned());
    }
    Ok(call.unsigned_abs())
}
