//! `lineshaft can nmt`.

use super::Failure;
use super::args::{NmtArg, NmtArgs, Target};
use super::open::Known;
use crate::cli::say;
use clap::ValueEnum;
use lineshaft_can::NmtState;
use std::time::{Duration, Instant};

/// Maximum boot time of a device.
const BOOT: Duration = Duration::from_secs(1);

pub(super) fn nmt(args: &NmtArgs) -> Result<(), Failure> {
    let mut session = Known::of(&args.bus)?.open()?;
    let node = match args.target {
        Target::One(node) => Some(node),
        Target::All => None,
    };
    session.nmt(args.command.into(), node)?;
    let command = args.command.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    let whom = node.map_or_else(|| "all nodes".to_owned(), |node| node.to_string());
    say(&format_args!("{whom}: {command} is sent"));
    let resets = matches!(args.command, NmtArg::ResetNode | NmtArg::ResetCommunication);
    let Some(node) = node.filter(|_| resets) else { return Ok(()) };
    let began = Instant::now();
    match session.wait_for_state(node, BOOT, |state| state == NmtState::BootUp)? {
        Some(_) => {
            say(&format_args!("{node}: it has booted after {} ms", began.elapsed().as_millis()));
            Ok(())
        }
        None => Err(Failure::Bus(format!("{node}: no boot-up message has come within {} s", BOOT.as_secs()))),
    }
}
