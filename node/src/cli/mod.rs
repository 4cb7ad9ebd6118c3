//! The command line: what each command does, and with which code it ends.

mod check;
mod run;
mod signals;
mod sim;

use crate::run::realtime::Processor;
use clap::{Args, Parser, Subcommand};
use lineshaft_ros::layer::{RosArguments, log_filter};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// How a command ends (contract section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All went well.
    Good,
    /// An expectation or the machine failed.
    Failed,
    /// Bad usage, or a file with errors.
    Usage,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        match exit {
            Exit::Good => Self::from(0),
            Exit::Failed => Self::from(1),
            Exit::Usage => Self::from(2),
        }
    }
}

#[derive(Debug, Parser)]
#[command(
    name = "lineshaft",
    version,
    about = "The electronic line shaft for ROS 2",
    long_about = "The electronic line shaft for ROS 2: runs servo axes in a fixed cycle and shows them as topics, services and \
                  actions.\n\nWithout a command it runs the built-in demo cell in simulation.",
    after_help = "Exit codes: 0 good, 1 an expectation or the machine failed, 2 bad usage or a file with errors."
)]
struct Line {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a cell as a ROS 2 node
    #[command(after_help = "After --ros-args: -r __node:=NAME, -r __ns:=NAMESPACE.\n\
                            The environment: ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE (SUBNET, LOCALHOST), \
                            ROS_LOCALHOST_ONLY, RUST_LOG.\n\
                            Ctrl-C halts and disables all axes and ends the node; a second one ends it at once.")]
    Run(RunArgs),
    /// Play a scenario on a simulated cell, as fast as it goes, without ROS
    Sim(SimArgs),
    /// Check a cell, and a scenario for it, and report all errors at once
    Check(CheckArgs),
    /// List the signals of a cell that can be traced
    Signals(CellArgs),
}

#[derive(Debug, Default, Args)]
struct RunArgs {
    /// The cell; left out: the built-in demo
    cell: Option<PathBuf>,
    /// Put simulation in the place of every backend
    #[arg(long)]
    sim: bool,
    /// Play this scenario on the running machine; the node ends with it
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Processor of the cycle thread: a number, or `any`; left out: the last one
    #[arg(long, value_name = "N|any", value_parser = processor)]
    cpu: Option<Processor>,
}

#[derive(Debug, Args)]
struct SimArgs {
    /// The cell
    cell: PathBuf,
    /// The scenario
    #[arg(long, value_name = "FILE")]
    scenario: PathBuf,
    /// Write the traced signals to this file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// The cell
    cell: PathBuf,
    /// A scenario for it
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct CellArgs {
    /// The cell
    cell: PathBuf,
}

fn processor(text: &str) -> Result<Processor, String> {
    match text {
        "any" => Ok(Processor::Any),
        number => number
            .parse()
            .map(Processor::Number)
            .map_err(|_| "a number of a processor, or `any`, is allowed".to_owned()),
    }
}

/// Runs the program with these arguments, the first one being its own name.
pub fn main(arguments: impl IntoIterator<Item = String>) -> ExitCode {
    start_logging();
    let (ros, rest) = match RosArguments::take(arguments) {
        Ok(taken) => taken,
        Err(error) => {
            eprintln!("error: {error}");
            return Exit::Usage.into();
        }
    };
    let line = match Line::try_parse_from(rest) {
        Ok(line) => line,
        Err(error) => {
            // --help and --version are no errors, and go to standard output.
            let exit = if error.use_stderr() { Exit::Usage } else { Exit::Good };
            let _ = error.print();
            return exit.into();
        }
    };
    let exit = match line.command {
        None => run::run(&RunArgs::default(), ros),
        Some(Command::Run(args)) => run::run(&args, ros),
        Some(_) if ros != RosArguments::default() => {
            eprintln!("error: --ros-args belong to `lineshaft run`");
            Exit::Usage
        }
        Some(Command::Sim(args)) => sim::sim(&args),
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::Signals(args)) => signals::signals(&args.cell),
    };
    exit.into()
}

/// Prints to standard output; a reader that has seen enough is no failure.
fn say(text: &dyn std::fmt::Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Logs to standard error; `RUST_LOG` decides what, else all that a person would want to know.
fn start_logging() {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(log_filter("info")));
    let lines = tracing_subscriber::fmt().with_env_filter(filter).with_target(false).with_writer(std::io::stderr);
    // A second start within one process keeps the first.
    // With nobody left to read it, a line is lost; the machine goes on.
    let _ = lines.with_ansi(std::io::stderr().is_terminal()).log_internal_errors(false).try_init();
}
