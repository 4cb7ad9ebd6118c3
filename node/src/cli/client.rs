//! `lineshaft state`, `enable`, `disable`, `halt`, `reset`, `move`, `home`, `jog`, `activate`: commands to a running node.

use super::logging::Logging;
use super::times::within;
use super::{Exit, complain};
use crate::client::{
    AxesService, Failure, Given, Jog, Motion, Options, StateForm, activate, command_axes, home, jog, move_axis, state,
};
use clap::{Args, Subcommand};
use std::time::Duration;

const AXES_HELP: &str = "\
The command talks to the node by its ROS 2 services; ROS need not be installed. The node and the command need the same ROS_DOMAIN_ID \
and ROS_AUTOMATIC_DISCOVERY_RANGE.

The command waits for the end. If the node does not accept it within --timeout, the command ends with exit code 1, and the axes may still \
move. If a name is unknown, halt and disable stop the other axes.

Exit codes: 0 done, 1 the node refused it, lacks an axis or did not answer, 2 bad usage.";

const MOVE_HELP: &str = "\
POSITION and the rates have a unit: 10 mm, -90 deg, 200 mm/s, 1000 inc; 0 needs none. All of them are in increments (inc), or none. \
The command waits for the end of the motion. Ctrl-C cancels the motion: the axis stops, and the command ends when it is at rest. \
If the command is killed, the motion goes on.

Examples:
  lineshaft enable x
  lineshaft move x '50 mm'
  lineshaft move x '-10 mm' --relative --velocity '20 mm/s'
  lineshaft move turret '90 deg'

Exit codes: 0 the position was reached, 1 refused, aborted, cancelled or no answer, 2 bad usage.";

const HOME_HELP: &str = "\
Each axis is homed by the method of its cell; the command waits for the ends. Ctrl-C cancels: the axes stop.

Exit codes: 0 all axes are homed, 1 refused, aborted, cancelled or no answer, 2 bad usage.";

const JOG_HELP: &str = "\
VELOCITY has a unit: 20 mm/s, -30 deg/s, 5 rpm. The axis moves until Ctrl-C, or for the time of \
--for, and then stops. It also stops if the command is killed or the network fails: the node accepts no velocity that is older than \
setpoint_timeout (100 ms).

Examples:
  lineshaft jog x '20 mm/s'
  lineshaft jog x '-20 mm/s' --for '2 s'

Exit codes: 0 the axis moved and stopped, 1 refused or no answer, 2 bad usage.";

const STATE_HELP: &str = "\
Prints one line for each axis, then a line for each error with cause and remedy. Values are in SI (m, rad, per s), with the unit of the \
axis in parentheses.

Exit codes: 0 printed, 1 no answer, 2 bad usage.";

const ACTIVATE_HELP: &str = "\
A node whose cell has `autostart: false` waits, unconfigured, until it is activated; so does a node whose backends did not start. \
The command configures the node if necessary, which starts its backends and its cycles, and activates it. It enables no axis.

Exit codes: 0 the node is active, 1 a transition failed or no answer, 2 bad usage.";

/// Commands to a node.
#[derive(Debug, Subcommand)]
pub(super) enum ClientCommand {
    /// Show the axes of a node that runs, without ROS
    #[command(after_help = STATE_HELP)]
    State(StateArgs),
    /// Enable axes of a node that runs, without ROS
    #[command(after_help = AXES_HELP)]
    Enable(AxesArgs),
    /// Stop axes of a node that runs and disable them, without ROS
    #[command(after_help = AXES_HELP)]
    Disable(AxesArgs),
    /// Move an axis of a node that runs, without ROS
    #[command(after_help = MOVE_HELP)]
    Move(MoveArgs),
    /// Jog an axis of a node that runs, without ROS
    #[command(after_help = JOG_HELP)]
    Jog(JogArgs),
    /// Home axes of a node that runs, without ROS
    #[command(after_help = HOME_HELP)]
    Home(HomeArgs),
    /// Stop axes of a node that runs, without ROS
    #[command(after_help = AXES_HELP, alias = "stop")]
    Halt(HaltArgs),
    /// Reset errors of axes of a node that runs, without ROS
    #[command(after_help = AXES_HELP)]
    Reset(AxesArgs),
    /// Activate a node that waits, without ROS
    #[command(after_help = ACTIVATE_HELP)]
    Activate(NodeArgs),
}

/// Which node.
#[derive(Clone, Debug, Args)]
pub(super) struct NodeArgs {
    /// Full name of the node; without it /lineshaft (`state`: or the only Lineshaft node of the domain)
    #[arg(long, value_name = "NAME")]
    node: Option<String>,
    /// How long the node may take to be found and to give a first answer (100 ms to 600 s)
    #[arg(long, value_name = "TIME", default_value = "5 s", value_parser = timeout)]
    timeout: Duration,
}

impl NodeArgs {
    fn options(&self) -> Options {
        Options { node: self.node.clone(), timeout: self.timeout, is_reading: false, is_stop: false }
    }
}

#[derive(Debug, Args)]
pub(super) struct StateArgs {
    /// Print again and again, five times per second, until Ctrl-C
    #[arg(long)]
    watch: bool,
    /// Print JSON; with --watch an object on each line
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    node: NodeArgs,
}

#[derive(Debug, Args)]
pub(super) struct AxesArgs {
    /// Names of the axes
    #[arg(value_name = "AXIS", required_unless_present = "all")]
    axes: Vec<String>,
    /// All axes of the cell
    #[arg(long, conflicts_with = "axes")]
    all: bool,
    #[command(flatten)]
    node: NodeArgs,
}

impl AxesArgs {
    /// Returns the axis names; empty for all axes.
    fn names(&self) -> &[String] {
        if self.all { &[] } else { &self.axes }
    }
}

#[derive(Debug, Args)]
pub(super) struct HomeArgs {
    /// Names of the axes
    #[arg(value_name = "AXIS", required_unless_present = "all")]
    axes: Vec<String>,
    /// All axes that have a homing method
    #[arg(long, conflicts_with = "axes")]
    all: bool,
    #[command(flatten)]
    node: NodeArgs,
}

impl HomeArgs {
    /// Returns the axis names; empty for all axes that have a homing method.
    fn names(&self) -> &[String] {
        if self.all { &[] } else { &self.axes }
    }
}

#[derive(Debug, Args)]
pub(super) struct HaltArgs {
    /// Names of the axes; without a name all axes
    #[arg(value_name = "AXIS")]
    axes: Vec<String>,
    /// All axes of the cell
    #[arg(long, conflicts_with = "axes")]
    all: bool,
    #[command(flatten)]
    node: NodeArgs,
}

impl HaltArgs {
    /// Returns the axis names; empty for all axes.
    fn names(&self) -> &[String] {
        if self.all { &[] } else { &self.axes }
    }
}

#[derive(Debug, Args)]
pub(super) struct MoveArgs {
    /// Name of the axis
    axis: String,
    /// Position, such as '10 mm' or '90 deg'
    #[arg(allow_hyphen_values = true)]
    position: String,
    /// POSITION is a distance from the commanded position
    #[arg(long)]
    relative: bool,
    /// Velocity; without it default_velocity of the axis
    #[arg(long, value_name = "VELOCITY", allow_hyphen_values = true)]
    velocity: Option<String>,
    /// Acceleration; without it default_acceleration of the axis
    #[arg(long, value_name = "ACCELERATION", allow_hyphen_values = true)]
    acceleration: Option<String>,
    /// Deceleration; without it default_deceleration of the axis
    #[arg(long, value_name = "DECELERATION", allow_hyphen_values = true)]
    deceleration: Option<String>,
    #[command(flatten)]
    node: NodeArgs,
}

impl MoveArgs {
    fn motion(&self) -> Result<Motion, Failure> {
        let rate =
            |name, text: &Option<String>, order| text.as_ref().map(|text| Given::read(name, text, order)).transpose();
        Ok(Motion {
            axis: self.axis.clone(),
            position: Given::read("POSITION", &self.position, 0)?,
            is_relative: self.relative,
            velocity: rate("--velocity", &self.velocity, 1)?,
            acceleration: rate("--acceleration", &self.acceleration, 2)?,
            deceleration: rate("--deceleration", &self.deceleration, 2)?,
        })
    }
}

#[derive(Debug, Args)]
pub(super) struct JogArgs {
    /// Name of the axis
    axis: String,
    /// Velocity, such as '20 mm/s' or '-30 deg/s'
    #[arg(allow_hyphen_values = true)]
    velocity: String,
    /// Stop after this time (20 ms to 86400 s; a number without a unit is in s); without it at Ctrl-C
    #[arg(long = "for", value_name = "TIME", value_parser = jog_time)]
    time: Option<Duration>,
    #[command(flatten)]
    node: NodeArgs,
}

impl JogArgs {
    fn jog(&self) -> Result<Jog, Failure> {
        let velocity = Given::read("VELOCITY", &self.velocity, 1)?;
        Ok(Jog { axis: self.axis.clone(), velocity, time: self.time })
    }
}

fn timeout(text: &str) -> Result<Duration, String> {
    within(text, (0.1, 600.0), "100 ms to 600 s")
}

fn jog_time(text: &str) -> Result<Duration, String> {
    within(text, (0.02, 86_400.0), "20 ms to 86400 s")
}

pub(super) fn client(command: &ClientCommand, logging: &Logging) -> Exit {
    // The output is for a person or a script, and the command itself reports failures.
    logging.show_errors_only();
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
    let done = match runtime {
        Ok(runtime) => runtime.block_on(run(command)),
        Err(error) => Err(Failure::Failed(format!("no threads: {error}"))),
    };
    match done {
        Ok(()) => Exit::Good,
        Err(failure) => {
            complain(&failure);
            match failure {
                Failure::Usage(_) => Exit::Usage,
                Failure::Failed(_) => Exit::Failed,
            }
        }
    }
}

async fn run(command: &ClientCommand) -> Result<(), Failure> {
    match command {
        ClientCommand::State(args) => {
            let options = Options { is_reading: true, ..args.node.options() };
            state(&options, StateForm { is_watch: args.watch, is_json: args.json }).await
        }
        ClientCommand::Enable(args) => axes_command(AxesService::Enable, args).await,
        ClientCommand::Disable(args) => axes_command(AxesService::Disable, args).await,
        ClientCommand::Reset(args) => axes_command(AxesService::ResetErrors, args).await,
        ClientCommand::Halt(args) => command_axes(&args.node.options(), AxesService::Halt, args.names()).await,
        ClientCommand::Move(args) => move_axis(&args.node.options(), &args.motion()?).await,
        ClientCommand::Jog(args) => jog(&args.node.options(), &args.jog()?).await,
        ClientCommand::Home(args) => home(&args.node.options(), args.names()).await,
        ClientCommand::Activate(node) => activate(&node.options()).await,
    }
}

async fn axes_command(service: AxesService, args: &AxesArgs) -> Result<(), Failure> {
    command_axes(&args.node.options(), service, args.names()).await
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{CommandFactory, Parser};

    #[derive(Debug, Parser)]
    struct Line {
        #[command(subcommand)]
        command: ClientCommand,
    }

    fn parse(words: &[&str]) -> Result<ClientCommand, clap::Error> {
        Line::try_parse_from([&["lineshaft"], words].concat()).map(|line| line.command)
    }

    #[test]
    fn negative_positions_and_options_after_them_are_understood() {
        let Ok(ClientCommand::Move(args)) = parse(&["move", "x", "-10 mm", "--relative", "--velocity", "20 mm/s"])
        else {
            panic!("it is a good command");
        };
        assert_eq!((args.axis.as_str(), args.position.as_str(), args.relative), ("x", "-10 mm", true));
        assert_eq!((args.velocity.as_deref(), args.acceleration), (Some("20 mm/s"), None));
        assert_eq!(args.node.timeout, Duration::from_secs(5));
        let Ok(ClientCommand::Jog(args)) = parse(&["jog", "x", "-1 mm/s", "--for", "500 ms", "--node", "/cell/a"])
        else {
            panic!("it is a good command");
        };
        assert_eq!((args.velocity.as_str(), args.time), ("-1 mm/s", Some(Duration::from_millis(500))));
        assert_eq!(args.node.node.as_deref(), Some("/cell/a"));
    }

    #[test]
    fn all_axes_must_be_requested_explicitly_except_for_halt() {
        assert!(parse(&["enable"]).is_err() && parse(&["enable", "--all", "x"]).is_err() && parse(&["home"]).is_err());
        assert!(parse(&["enable", "--all"]).is_ok() && parse(&["enable", "x", "y"]).is_ok());
        // A stop is not refused because of a missing argument.
        assert!(
            matches!(parse(&["halt"]), Ok(ClientCommand::Halt(HaltArgs { axes, all: false, .. })) if axes.is_empty())
        );
    }

    #[test]
    fn node_is_activated_by_its_name() {
        let Ok(ClientCommand::Activate(node)) = parse(&["activate", "--node", "/cell/a"]) else {
            panic!("it is a good command");
        };
        assert_eq!((node.node.as_deref(), node.timeout), (Some("/cell/a"), Duration::from_secs(5)));
        assert!(parse(&["activate", "x"]).is_err());
    }

    #[test]
    fn help_of_all_is_that_of_its_command() {
        let line = Line::command();
        let help = |command: &str| {
            let command = line.find_subcommand(command)?;
            let all = command.get_arguments().find(|argument| argument.get_id().as_str() == "all")?;
            all.get_help().map(ToString::to_string)
        };
        for command in ["enable", "disable", "reset", "halt"] {
            assert_eq!(help(command).as_deref(), Some("All axes of the cell"), "{command}");
        }
        assert_eq!(help("home").as_deref(), Some("All axes that have a homing method"));
    }

    #[test]
    fn stop_is_another_name_of_halt() {
        assert!(matches!(parse(&["stop", "x"]), Ok(ClientCommand::Halt(HaltArgs { axes, .. })) if axes == ["x"]));
    }

    #[test]
    fn times_have_ranges_and_are_in_seconds_without_a_unit() {
        assert_eq!(timeout("5"), Ok(Duration::from_secs(5)));
        assert_eq!(jog_time("2"), Ok(Duration::from_secs(2)));
        assert_eq!(timeout("50 ms"), Err("50 ms is not allowed; 100 ms to 600 s is".to_owned()));
        assert!(jog_time("1 mm").is_err() && jog_time("-1 s").is_err());
        assert_eq!(jog_time("2s"), Err("`2s` has no blank between number and unit; write `2 s`".to_owned()));
    }
}
