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
use crate::cell::Preset;
use crate::interrupt::EndSignal;
use crate::output;
use crate::recording::bag::BagOptions;
use crate::recording::clean::{clean, clean_lines};
use crate::recording::plot::{HEIGHTS, WIDTHS};
use crate::recording::validate::{Align, Tolerance};
use crate::run::realtime::Processor;
use crate::run::recorder::{BAG_DURATIONS, is_bag_duration};
use clap::builder::RangedU64ValueParser;
use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use lineshaft_core::parameter::System;
use lineshaft_ros::layer::{RosArguments, Side};
use std::path::PathBuf;
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
    Run(RunArgs),
    /// Play a scenario on a simulated cell, as fast as it goes, without ROS; or all scenarios of a folder
    #[command(after_help = sim::HELP)]
    Sim(SimArgs),
    /// Check a cell, and a scenario for it, and report all errors at once
    Check(CheckArgs),
    /// Write a new cell and a scenario for it, to start from
    #[command(override_usage = new::USAGE, after_help = new::HELP)]
    New(new::NewArgs),
    /// Print the built-in demo cell
    Demo(new::DemoArgs),
    /// Explain a code, a parameter, a signal, a function type or field, a verb, or a ROS interface
    #[command(after_help = explain::HELP)]
    Explain(explain::ExplainArgs),
    /// List the signals of a cell that can be traced
    Signals(CellArgs),
    /// List the parameters there are, or those of a cell
    #[command(after_help = PARAMS_HELP)]
    Params(ParamsArgs),
    /// Write the limits of joints as MoveIt's joint_limits.yaml, or read such a file into a cell
    #[command(after_help = LIMITS_HELP)]
    Limits(LimitsArgs),
    /// List the types of function slots, or all that is said of one
    #[command(after_help = FUNCTIONS_HELP)]
    Functions(FunctionsArgs),
    /// List the topics, services, actions and types that there are in ROS 2
    #[command(after_help = "Exit codes: 0 good, 2 bad usage, or nothing of that name.")]
    Interfaces(InterfacesArgs),
    /// Play a recorded run through the core again and report the first difference
    #[command(
        after_help = "Plays the recorded inputs and commands with the attached cell and compares all signals, events and \
                            states of each cycle, bit for bit.\n\
                            Exit codes: 0 no difference, 2 cannot be replayed, or not any further because cycles are missing, 3 differs."
    )]
    Replay(ReplayArgs),
    /// Compare a recorded run with an expected one, signal by signal
    #[command(after_help = VALIDATE_HELP)]
    Validate(ValidateArgs),
    /// Draw signals of a recorded run
    #[command(
        after_help = "Signals of one meaning and unit share a panel; bits and states are lanes below. What a pattern \
                            chooses and never changes is named below the figure, not drawn; so are fractions."
    )]
    Plot(PlotArgs),
    /// Find gains for the loops of an axis that are closed here
    #[command(after_help = TUNE_HELP)]
    Tune(TuneArgs),
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
    Bag(BagCommand),
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

const TUNE_HELP: &str = "\
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

const PARAMS_HELP: &str = "\
Without a cell: the catalogue, or everything about the one parameter that --name names. With a cell: the values that its axes \
begin with; * marks those that are not at their default.

Examples:
  lineshaft params --name 'sync*'
  lineshaft params --name max_velocity
  lineshaft params cell.yaml --changed
  lineshaft params cell.yaml --export > parameters.yaml
  lineshaft params cell.yaml --import parameters.yaml

Exit codes: 0 good, 2 bad usage, no such parameter, or a file with errors.";

const LIMITS_HELP: &str = "\
Written are position, velocity, acceleration and jerk of each axis with a drive, in SI units, to standard output. max_acceleration is the \
lower of max_acceleration and max_deceleration of the axis.

--from changes the cell file: values only, comments and order stay. Each change is printed. has_..: false gives no limit, so the cell keeps its \
own. max_deceleration follows max_acceleration where the cell leaves it out or has a lower one. Values that a node has saved \
(docs/storage.md) hide those of the cell.

Examples:
  lineshaft limits cell.yaml > joint_limits.yaml
  lineshaft limits cell.yaml --group arm > joint_limits.yaml
  lineshaft limits cell.yaml --from joint_limits.yaml

Exit codes: 0 good, 2 bad usage, no such group, or a file with errors; the cell is what it was then.";

const FUNCTIONS_HELP: &str = "\
docs/functions.md explains the types. `sak` is the factor of the field of that name, with which a function cancels the following error \
of the axis that it moves: of the time between two calls, and of the gain of the position loop of that axis' drive.

Examples:
  lineshaft functions
  lineshaft functions varsync
  lineshaft functions sak --cycle '2 ms' --gain 1000

Exit codes: 0 good, 2 bad usage, no such type, or a factor that no function takes.";

const VALIDATE_HELP: &str = "\
Both runs are bags of any recorder: an .mcap file, a folder, or a metadata.yaml. The trajectories of joint_states and \
axis_states are compared in time, read on straight lines between their samples. Numbers that change in steps (states, bits, \
error codes) must have the same values in the same order; where both runs have samples at the same times, at the same times.

SIGNAL is a name or a pattern, such as x.actual.position (also x.position), x.command.velocity, x.following_error, '*.position', \
or time, which loosens where the signals begin and end (by itself two samples of what is expected) and how long a run may \
have no sample (by itself five of its samples). VALUE is a number in SI (m, m/s, m/s^2, rad, \
rad/s, rad/s^2, N, Nm, s) or has a unit: 10 um, 0.1 deg, 5 mm/s, 50 ms. A value with a unit holds for those matched \
signals that have it: of linear or of rotary axes, as the cell.yaml attached to one of the runs tells. Without it a length \
and an angle for one signal are refused, unless the last of them names it alone. What has no tolerance must be equal. Of several the last one holds.

Examples:
  lineshaft validate run.mcap --against expected.mcap --tolerance '*.position=10 um' --tolerance '*.velocity=5 mm/s'
  lineshaft validate run/ --against expected/ --align motion --tolerance '*=1 mm' --tolerance 'time=50 ms'

Exit codes: 0 all signals agree, 1 one deviates, is missing, has a gap or is NaN, 2 bad usage or a bad file.";

#[derive(Debug, Args)]
struct TuneArgs {
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

#[derive(Debug, Args)]
struct PlotArgs {
    /// The run: an .mcap file, a folder, or a metadata.yaml
    run: PathBuf,
    /// Signals to draw, as `x.*`; several times for more
    #[arg(long, value_name = "GLOB", required = true)]
    signals: Vec<String>,
    /// The figure: FILE.svg or FILE.png; one that exists is replaced
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Begin here, as `1.2 s`, from the start of the run; left out: with the first value
    #[arg(long, value_name = "TIME", value_parser = times::seconds, allow_hyphen_values = true)]
    from: Option<f64>,
    /// End here
    #[arg(long, value_name = "TIME", value_parser = times::seconds, allow_hyphen_values = true)]
    to: Option<f64>,
    /// Width (px, 500 to 8000)
    #[arg(long, value_name = "N", default_value_t = 1200, value_parser = pixels(WIDTHS))]
    width: u32,
    /// Height (px, 200 to 20000); left out: what the panels need
    #[arg(long, value_name = "N", value_parser = pixels(HEIGHTS))]
    height: Option<u32>,
    /// Title above the figure; left out: the name of the scenario of the run, or of its file
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Draw each signal in a panel of its own: curves that lie on each other stay visible
    #[arg(long)]
    split: bool,
    /// Unit of the numbers of a signal, as `lag=inc` or `speed=0.0001 rpm`; several times for more
    #[arg(long, value_name = "SIGNAL=UNIT", value_parser = plot::unit)]
    unit: Vec<(String, String)>,
}

#[derive(Debug, Args)]
struct ValidateArgs {
    /// The run: an .mcap file, a folder, or a metadata.yaml
    run: PathBuf,
    /// The run that is expected, likewise
    #[arg(long, value_name = "EXPECTED")]
    against: PathBuf,
    /// How far a signal may be from what is expected
    #[arg(long, value_name = "SIGNAL=VALUE")]
    tolerance: Vec<Tolerance>,
    /// From where the times of both count
    #[arg(long, value_enum, default_value_t)]
    align: AlignArg,
    /// Write a JUnit report, one test case for each signal; a file that exists is replaced
    #[arg(long, value_name = "FILE", value_parser = outputs::report())]
    junit: Option<PathBuf>,
    /// Print one JSON object (docs/json.md) instead of the report
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum AlignArg {
    /// The first sample of each run
    #[default]
    Start,
    /// The first sample at which a position is further from where it was than its tolerance
    Motion,
}

impl From<AlignArg> for Align {
    fn from(align: AlignArg) -> Self {
        match align {
            AlignArg::Start => Self::Start,
            AlignArg::Motion => Self::Motion,
        }
    }
}

#[derive(Debug, Subcommand)]
enum BagCommand {
    /// Tell what a run holds, and whether it can be replayed
    #[command(
        after_help = "Exit codes: 0 the run was read to its end, also one that was cut off; 2 bad usage, or a file \
                            that is damaged or no bag."
    )]
    Info {
        /// The run: an .mcap file, a folder, or a metadata.yaml
        run: PathBuf,
        /// Print one JSON object (docs/json.md) instead of the lines
        #[arg(long)]
        json: bool,
    },
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
    #[command(flatten)]
    record: RecordArgs,
    /// Keep the frames of buses on CAN in recordings, as the flight recorder does in its bags
    #[arg(long)]
    record_frames: bool,
    #[command(flatten)]
    flight: FlightArgs,
    #[command(flatten)]
    store: StoreArgs,
}

/// Where and how a run is recorded.
#[derive(Clone, Debug, Default, Args)]
struct RecordArgs {
    /// Record the run from its first cycle on: `NAME.mcap` is that file, anything else a new folder (a rosbag2 bag)
    #[arg(long, value_name = "PATH")]
    record: Option<PathBuf>,
    /// Begin a new file of the bag beyond this size (bytes, 0 never), at the next full second of cycles; folders only
    #[arg(long, value_name = "BYTES", default_value_t = 0, requires = "record")]
    max_bag_size: u64,
    /// Begin a new file of the bag beyond this time (s, 0 never, 1 and more), at the next full second of cycles; folders only
    #[arg(long, value_name = "SECONDS", default_value = "0", requires = "record", value_parser = bag_duration)]
    max_bag_duration: u64,
}

impl RecordArgs {
    /// Returns the options of the recording, if one was requested.
    fn options(&self) -> Option<BagOptions> {
        let path = self.record.clone()?;
        Some(BagOptions::split(path, self.max_bag_size, self.max_bag_duration))
    }
}

/// The flight recorder.
#[derive(Clone, Debug, Args)]
struct FlightArgs {
    /// The last seconds that the flight recorder keeps and saves as a bag after a fault (s, 1 to 600; 0 off)
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = value_parser!(u64).range(0..=600))]
    flight_recorder: u64,
    /// Where its bags go; left out: ~/.ros/lineshaft/<node> (ROS_HOME counts)
    #[arg(long, value_name = "FOLDER")]
    flight_folder: Option<PathBuf>,
    /// How many of its bags are kept (1 to 1000); the oldest is removed for a new one
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = value_parser!(u64).range(1..=1000))]
    flight_keep: u64,
}

impl Default for FlightArgs {
    fn default() -> Self {
        Self { flight_recorder: 10, flight_folder: None, flight_keep: 10 }
    }
}

/// Where saved parameters are kept.
#[derive(Clone, Debug, Default, Args)]
struct StoreArgs {
    /// Start with the parameters saved in this file, and keep there what is saved; `none`: keep nothing. Left out: `sim`,
    /// and `tune` of a simulated axis, keep nothing; `run`, and `tune` of a real axis, use
    /// ~/.ros/lineshaft/<node>/parameters.<cell>.yaml (ROS_HOME counts)
    #[arg(long, value_name = "FILE|none")]
    store: Option<PathBuf>,
}

/// Options that are valid for a single scenario only.
const NOT_WITH_ALL: [&str; 8] =
    ["cell", "scenario", "csv", "events", "record", "max_bag_size", "max_bag_duration", "store"];

#[derive(Debug, Args)]
struct SimArgs {
    /// The cell; left out: the one that key `cell` of the scenario names, or NAME.yaml next to NAME.scenario.yaml. Without --scenario
    /// this is the scenario
    cell: Option<PathBuf>,
    /// The scenario
    #[arg(long, value_name = "FILE", required_unless_present_any = ["all", "cell"])]
    scenario: Option<PathBuf>,
    /// Play each NAME.scenario.yaml in this folder and in those below it
    #[arg(long, value_name = "DIR", conflicts_with_all = NOT_WITH_ALL)]
    all: Option<PathBuf>,
    /// How many scenarios are played at the same time (1 to 256); left out: one on each processor
    #[arg(long, value_name = "N", requires = "all", conflicts_with = "scenario", value_parser = value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
    /// Write a JUnit report, one test case for each expectation; a file that exists is replaced
    #[arg(long, value_name = "FILE", value_parser = outputs::report())]
    junit: Option<PathBuf>,
    /// Print one JSON object (docs/json.md) instead of the report
    #[arg(long, conflicts_with = "events")]
    json: bool,
    /// Write the traced signals to this file; one that exists is replaced
    #[arg(long, value_name = "FILE", value_parser = outputs::trace())]
    csv: Option<PathBuf>,
    /// Print every event as it comes: cycle, severity, kind, sentence and code
    #[arg(long)]
    events: bool,
    #[command(flatten)]
    record: RecordArgs,
    #[command(flatten)]
    store: StoreArgs,
}

#[derive(Debug, Args)]
struct ReplayArgs {
    /// The run: an .mcap file, a folder, or a metadata.yaml
    run: PathBuf,
    /// Print one JSON object (docs/json.md) instead of the report
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// The cell
    cell: PathBuf,
    /// A scenario for it
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Draw its function slots, and who reads what of whom: FILE.svg; one that exists is replaced
    #[arg(long, value_name = "FILE")]
    graph: Option<PathBuf>,
    /// Hold it to the bounds of a source that are narrower
    #[arg(long, value_enum)]
    preset: Option<PresetArg>,
    /// Print one JSON object (docs/json.md) instead of the lines
    #[arg(long)]
    json: bool,
}

/// A source to whose bounds a cell is held.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum PresetArg {
    /// Fast functions of AMKASYN: 16 slots, 8 axes; docs/functions.md has all
    Amkasyn,
}

impl From<PresetArg> for Preset {
    fn from(preset: PresetArg) -> Self {
        match preset {
            PresetArg::Amkasyn => Self::Amkasyn,
        }
    }
}

#[derive(Debug, Args)]
struct CellArgs {
    /// The cell
    cell: PathBuf,
}

#[derive(Debug, Args)]
struct ParamsArgs {
    /// The cell; left out: the catalogue
    cell: Option<PathBuf>,
    /// Only parameters whose key, source's name or name with its axis matches, as `sync*`; capitals do not count
    #[arg(long, value_name = "GLOB")]
    name: Option<String>,
    /// Only parameters of one source
    #[arg(long, value_enum)]
    system: Option<SystemArg>,
    /// Only what is not at its default
    #[arg(long, requires = "cell")]
    changed: bool,
    /// Print the parameters, exactly, as --import and ~/import_parameters take them
    #[arg(long, requires = "cell", conflicts_with_all = ["name", "system"])]
    export: bool,
    /// Check a file of parameters against the cell and tell what it would change; changes nothing
    #[arg(long, value_name = "FILE", requires = "cell", conflicts_with_all = ["name", "system", "changed", "export"])]
    import: Option<PathBuf>,
    /// Print the catalogue as Markdown: docs/parameters.md
    #[arg(long, conflicts_with_all = ["cell", "name", "system", "changed", "export", "import"])]
    markdown: bool,
}

#[derive(Debug, Args)]
struct LimitsArgs {
    /// The cell
    cell: PathBuf,
    /// Only the joints of one group; left out: all axes with a drive
    #[arg(long, value_name = "NAME")]
    group: Option<String>,
    /// Read this joint_limits.yaml into the cell, which is changed in its place
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct InterfacesArgs {
    /// A topic, a service, an action, or a type as `MoveAxis`: all that is said about it; left out: the list
    name: Option<String>,
    /// Print everything as Markdown, as it stands in docs/interfaces.md
    #[arg(long, conflicts_with = "name")]
    markdown: bool,
}

#[derive(Debug, Args)]
struct FunctionsArgs {
    /// A type as `varsync`: what it reads and writes, and its fields; or `sak`; left out: the list
    #[arg(value_name = "TYPE")]
    name: Option<String>,
    /// Of `sak`: time between two calls, as `2 ms`
    #[arg(long, value_name = "TIME", requires = "gain", value_parser = functions::call)]
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

/// A source of parameters.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SystemArg {
    /// Lineshaft itself
    Native,
    /// zub MACS
    Macs,
    /// Unidrive M advanced motion controller
    Amc,
    /// SAIA PCD4.H3
    Saia,
    /// Siemens WF 725 and 726
    Wf,
}

impl From<SystemArg> for System {
    fn from(system: SystemArg) -> Self {
        match system {
            SystemArg::Native => Self::Native,
            SystemArg::Macs => Self::Macs,
            SystemArg::Amc => Self::Amc,
            SystemArg::Saia => Self::Saia,
            SystemArg::Wf => Self::Wf,
        }
    }
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

/// Returns a parser of a size within a range, in px.
fn pixels((least, most): (u32, u32)) -> RangedU64ValueParser<u32> {
    RangedU64ValueParser::new().range(u64::from(least)..=u64::from(most))
}

/// Parses a time in s; returns it in ns.
fn bag_duration(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if is_bag_duration(seconds) => Ok((seconds * 1e9) as u64),
        _ => Err(format!("{BAG_DURATIONS} is allowed")),
    }
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
        None => run::run(&RunArgs::default(), &ros, &logging),
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
        Some(Command::Signals(args)) => signals::signals(&args.cell),
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
