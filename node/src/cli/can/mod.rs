//! `lineshaft can`: commissioning of a CAN bus without ROS.
//!
//! Law      a command reports errors of its arguments and files before it opens the bus, and sends only the requested
//!          frames
//! Refuses  wrong arguments and files with exit code 2; errors and missing answers of the bus or a device with exit
//!          code 1

mod args;
mod configure;
mod dump;
mod info;
mod layer;
mod monitor;
mod nmt;
mod open;
mod scan;
mod sdo;
mod simulate;
mod table;

pub(super) use self::args::CanCommand;
use self::args::SdoCommand;
use super::Exit;
use super::command_output::Output;
use crate::document::Problems;
use lineshaft_can::commission::{CommissionError, Refusal};

/// Reason why a command failed.
#[derive(Debug)]
enum Failure {
    /// Wrong arguments, or a file with errors.
    Usage(String),
    /// A cell with errors.
    Problems(Problems),
    /// The bus or a device refused a request or did not answer.
    Bus(String),
}

impl From<CommissionError> for Failure {
    fn from(error: CommissionError) -> Self {
        Self::Bus(error.to_string())
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Self::Usage(refusal.to_string())
    }
}

pub(super) fn can(command: &CanCommand) -> Exit {
    let (name, is_json) = match command {
        CanCommand::Scan(args) => ("can scan", args.json),
        CanCommand::Info(args) => ("can info", args.json),
        _ => ("can", false),
    };
    let mut output = Output::new(name, is_json);
    let done = match command {
        CanCommand::Scan(args) => scan::scan(args, &mut output),
        CanCommand::Info(args) => info::info(args, &mut output),
        CanCommand::Pdo(args) => info::pdo(args),
        CanCommand::Sdo(SdoCommand::Read(args)) => sdo::read(args),
        CanCommand::Sdo(SdoCommand::Write(args)) => sdo::write(args),
        CanCommand::Nmt(args) => nmt::nmt(args),
        CanCommand::Lss(words) => layer::lss(words),
        CanCommand::Monitor(args) => monitor::monitor(args),
        CanCommand::Dump(args) => dump::dump(args),
        CanCommand::Configure(args) => configure::configure(args),
        CanCommand::Simulate(args) => simulate::simulate(args),
    };
    let exit = match done {
        Ok(()) => Exit::Good,
        Err(Failure::Usage(sentence)) => {
            output.complain(&sentence);
            Exit::Usage
        }
        Err(Failure::Problems(problems)) => {
            output.complain_of(&problems);
            Exit::Usage
        }
        Err(Failure::Bus(sentence)) => {
            output.complain(&sentence);
            Exit::Failed
        }
    };
    output.finish(exit)
}
