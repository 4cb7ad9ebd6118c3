//! `lineshaft functions`.

use super::params::width;
use super::{Exit, FunctionsArgs, say, say_all};
use crate::functions::{details, listing, markdown};
use crate::scenario::{did_you_mean, nearest};
use lineshaft_core::function::{Kind, Origin, TYPES, sak_factor};
use lineshaft_core::unit::{Dimension, Quantity, excerpt};

/// Name of the compensation of the following error, used instead of a type.
const SAK: &str = "sak";
/// Range of the time between two calls of a slot, in ns.
const CALLS: std::ops::RangeInclusive<i64> = 125_000..=5_100_000_000;

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
