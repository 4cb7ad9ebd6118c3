//! Command line: commands and their exit codes.

mod bag;
mod can;
mod check;
mod client;
mod command_output;
mod completions;
mod explain;
mod file_hint;
mod functions;
mod interfaces;
mod junit;
mod limits;
mod logging;
mod man;
mod new;
mod outputs;
mod params;
mod plot;
mod program;
mod record;
mod replay;
mod run;
mod schema;
mod signals;
mod sim;
mod store;
mod table;
mod times;
mod tune;
mod usage;
mod usage_hint;
mod validate;

pub use self::usage::{UsageError, parses};

use self::logging::Logging;
use crate::interrupt::EndSignal;
use crate::output;
use crate::recording::clean::{clean, clean_lines};
use clap::{Parser, Subcommand};
use lineshaft_ros::layer::{RosArguments, Side};
use std::process::ExitCode;

/// Result of a command (contract section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success.
    Good,
    /// An expectation or the machine failed.
    Failed,
    /// Wrong usage, or a file with errors.
    Usage,
    /// A replay differs from the recording.
    Differs,
    /// A signal ended the command before its result.
    Signal(EndSignal),
}

impl Exit {
    /// Returns the exit code.
    fn code(self) -> u8 {
        match self {
            Self::Good => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Differs => 3,
            Self::Signal(signal) => signal.exit_code(),
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}

#[derive(Debug, Parser)]
#[command(
    name = "lineshaft",
    version,
    about = "The electronic line shaft for ROS 2",
    long_about = "The electronic line shaft for ROS 2: runs servo axes in a fixed cycle and shows them as topics, services and \
                  actions.\n\nWithout a command it runs the built-in demo cell in simulation.",
    after_help = "Exit codes: 0 good, 1 an expectation or the machine failed, 2 bad usage or a file with errors, \
                  3 a replay differs from its recording, 128 and the number of a signal that ended it before its result."
)]
struct Line {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a cell as a ROS 2 node
    #[command(
        after_help = "After --ros-args, as every ROS 2 node takes them: -r FROM:=TO, -r __node:=NAME, -r __ns:=NAMESPACE, \
                            -p NAME:=VALUE, --params-file FILE, --log-level [LOGGER:=]LEVEL, --disable-rosout-logs, \
                            --disable-stdout-logs. NAME is any of `lineshaft params CELL`, use_sim_time, or \
                            qos_overrides.TOPIC.publisher.depth and the like.\n\
                            The environment: ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE (SUBNET, LOCALHOST), \
                            ROS_LOCALHOST_ONLY, RUST_LOG.\n\
                            Ctrl-C halts and disables all axes and ends the node, as do SIGTERM, SIGHUP and SIGQUIT; a second one ends it at once.\n\
                            From another terminal, without ROS: `lineshaft state`, enable, disable, move, jog, home, halt, reset, activate."
    )]
    Run(run::RunArgs),
    /// Play a scenario on a simulated cell, as fast as it goes, without ROS; or all scenarios of a folder
    #[command(after_help = sim::HELP)]
    Sim(sim::SimArgs),
    /// Check a cell, and a scenario for it, and report all errors at once
    Check(check::CheckArgs),
    /// Write a new cell and a scenario for it, to start from
    #[command(override_usage = new::USAGE, after_help = new::HELP)]
    New(new::NewArgs),
    /// Print the built-in demo cell
    Demo(new::DemoArgs),
    /// Explain a code, a parameter, a signal, a function type or field, a verb, or a ROS interface
    #[command(after_help = explain::HELP)]
    Explain(explain::ExplainArgs),
    /// List the signals of a cell that can be traced
    Signals(signals::CellArgs),
    /// List the parameters there are, or those of a cell
    #[command(after_help = params::HELP)]
    Params(params::ParamsArgs),
    /// Write the limits of joints as MoveIt's joint_limits.yaml, or read such a file into a cell
    #[command(after_help = limits::HELP)]
    Limits(limits::LimitsArgs),
    /// List the types of function slots, or all that is said of one
    #[command(after_help = functions::HELP)]
    Functions(functions::FunctionsArgs),
    /// List the topics, services, actions and types that there are in ROS 2
    #[command(after_help = "Exit codes: 0 good, 2 bad usage, or nothing of that name.")]
    Interfaces(interfaces::InterfacesArgs),
    /// Play a recorded run through the core again and report the first difference
    #[command(
        after_help = "Plays the recorded inputs and commands with the attached cell and compares all signals, events and \
                            states of each cycle, bit for bit.\n\
                            Exit codes: 0 no difference, 2 cannot be replayed, or not any further because cycles are missing, 3 differs."
    )]
    Replay(replay::ReplayArgs),
    /// Compare a recorded run with an expected one, signal by signal
    #[command(after_help = validate::HELP)]
    Validate(validate::ValidateArgs),
    /// Draw signals of a recorded run
    #[command(
        after_help = "Signals of one meaning and unit share a panel; bits and states are lanes below. What a pattern \
                            chooses and never changes is named below the figure, not drawn; so are fractions."
    )]
    Plot(plot::PlotArgs),
    /// Find gains for the loops of an axis that are closed here
    #[command(after_help = tune::HELP)]
    Tune(tune::TuneArgs),
    /// Print the JSON Schema of cells or scenarios, for editors
    Schema(schema::SchemaArgs),
    /// Make, check, draw and convert tables of cams
    #[command(subcommand)]
    Table(table::TableCommand),
    /// Begin, check and try programs of function slots
    #[command(subcommand)]
    Program(program::ProgramCommand),
    /// Look into recordings
    #[command(subcommand)]
    Bag(bag::BagCommand),
    /// Commission the devices of a CAN bus, without ROS
    #[command(subcommand)]
    Can(can::CanCommand),
    /// Print the script that completes commands and options in a shell
    #[command(after_help = "bash: source <(lineshaft completions bash)")]
    Completions(completions::CompletionsArgs),
    /// Write a man page of each command
    Man(man::ManArgs),
    #[command(flatten)]
    Client(client::ClientCommand),
}

/// Runs the program with these arguments, the first one being the name of the program.
pub fn main(arguments: impl IntoIterator<Item = String>) -> ExitCode {
    let arguments: Vec<String> = arguments.into_iter().collect();
    // Internal command, and therefore not in the help.
    if arguments.get(1).is_some_and(|command| command == Side::COMMAND) {
        return lineshaft_ros::side::main();
    }
    written(command(arguments)).into()
}

/// Runs the command of the arguments.
fn command(arguments: Vec<String>) -> Exit {
    let (ros, rest) = match RosArguments::take(arguments) {
        Ok(taken) => taken,
        Err(error) => {
            complain(&error);
            return Exit::Usage;
        }
    };
    let logging = Logging::start(ros.stdout_logs);
    let line = match Line::try_parse_from(&rest) {
        Ok(line) => line,
        Err(error) => {
            let error = usage_hint::without_escape_tip(error);
            // --help and --version are no errors, and go to standard output.
            let printed = error.print();
            if error.use_stderr() {
                if let Some(hint) = usage_hint::hint(&error, rest.get(1..).unwrap_or_default()) {
                    eprintln!("hint: {hint}");
                }
                return Exit::Usage;
            }
            let _ = output::kept(printed);
            return Exit::Good;
        }
    };
    match line.command {
        None => run::run(&run::RunArgs::default(), &ros, &logging),
        Some(Command::Run(args)) => run::run(&args, &ros, &logging),
        Some(_) if ros != RosArguments::default() => {
            eprintln!("error: --ros-args belong to `lineshaft run`");
            Exit::Usage
        }
        Some(Command::Sim(args)) => sim::sim(&args),
        Some(Command::Tune(args)) => tune::tune(&args),
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::New(args)) => new::new(&args),
        Some(Command::Demo(args)) => new::print_demo(&args),
        Some(Command::Explain(args)) => explain::explain(&args),
        Some(Command::Signals(args)) => signals::signals(&args),
        Some(Command::Params(args)) => params::params(&args),
        Some(Command::Limits(args)) => limits::limits(&args),
        Some(Command::Functions(args)) => functions::functions(&args),
        Some(Command::Interfaces(args)) => interfaces::interfaces(&args),
        Some(Command::Plot(args)) => plot::plot(&args),
        Some(Command::Replay(args)) => replay::run(&args),
        Some(Command::Validate(args)) => validate::validate(&args),
        Some(Command::Schema(args)) => schema::run(&args),
        Some(Command::Table(command)) => table::table(&command),
        Some(Command::Program(command)) => program::program(&command),
        Some(Command::Bag(command)) => bag::bag(&command),
        Some(Command::Can(command)) => can::can(&command),
        Some(Command::Completions(args)) => completions::completions(&args),
        Some(Command::Man(args)) => man::man(&args),
        Some(Command::Client(command)) => client::client(&command, &logging),
    }
}

/// Prints an error, which may contain text from outside.
fn complain(error: &dyn std::fmt::Display) {
    eprintln!("error: {}", clean_lines(&error.to_string()));
}

/// Prints warnings, one per line.
fn warn(warnings: impl IntoIterator<Item = String>) {
    for warning in warnings {
        eprintln!("warning: {}", clean(&warning));
    }
}

/// Prints a line to standard output. An error is reported at the end of the command.
fn say(text: &dyn std::fmt::Display) {
    output::print_line(text);
}

/// Prints a text that contains its line feeds. An error is reported at the end of the command.
fn say_all(text: &str) {
    output::print(text);
}

/// Returns the exit code of a command after all of its output was written. A command that failed before keeps its exit
/// code.
fn written(exit: Exit) -> Exit {
    let Err(error) = output::finish() else { return exit };
    complain(&format_args!("cannot write standard output: {error}"));
    if exit == Exit::Good { Exit::Failed } else { exit }
}
