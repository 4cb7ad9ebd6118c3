//! Arguments of `lineshaft table`.

use crate::cli::plot::pixels;
use crate::recording::plot::{HEIGHTS, WIDTHS};
use clap::{Args, Subcommand, ValueEnum, value_parser};
use lineshaft_core::table::{Form, Interpolation};
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum TableCommand {
    /// Make a table from a description: segments of the master, each with a way and a law
    #[command(after_help = MAKE_HELP)]
    Make(MakeArgs),
    /// Tell what a table asks of its axis, and how fast its master may run
    #[command(after_help = CHECK_HELP)]
    Check(CheckArgs),
    /// Draw position, velocity, acceleration and jerk over the master
    #[command(after_help = PLOT_HELP)]
    Plot(PlotArgs),
    /// Convert between CSV files, the section `tables` of a cell, and forms
    #[command(after_help = CONVERT_HELP)]
    Convert(ConvertArgs),
}

const MAKE_HELP: &str = "\
knife.yaml:
  points: 1001       # 2 to 1000000
  master: 20000      # period (inc)
  form: y            # or xy; left out: y
  cyclic: true       # left out: true; false: the slave stands before and after
  segments:          # where each ends (inc of the master), its way (inc of the slave), its law
    - {to: 5000, travel: 0, law: dwell}
    - {to: 12000, travel: 8000, law: modified_sine}
    - {to: 20000, travel: -8000, law: polynomial_5}

Laws: dwell, straight, simple_sine, modified_sine, modified_trapezoid, polynomial_5, polynomial_7; docs/cams.md explains them.
The points are whole increments, rounded to the nearest; the first is 0, the last the sum of all ways.

Example:
  lineshaft table make knife.yaml -o knife.csv

Exit codes: 0 good, 2 bad usage or a file with errors.";

const CHECK_HELP: &str = "\
Derivatives are increments of the slave per increment of the master. Those of a description are those of its laws. Those of a CSV \
file are the slopes between its points, and divided differences for acceleration and jerk, which whole increments blur. With an axis they are \
compared with its max_velocity, max_acceleration, max_deceleration and max_jerk at --master-speed, without it at max_velocity of the \
--leader; the fastest speed is printed in any case. The master runs forward. With a cell and a description, `check` also prints which table of \
the cell has these points: a CSV file that was not made again after a change has other ones.

Examples:
  lineshaft table check knife.yaml
  lineshaft table check knife.yaml --cell cell.yaml --axis knife --master-speed '40000 inc/s'
  lineshaft table check knife.yaml --cell cell.yaml --axis knife --leader belt --master-speed '300 mm/s'
  lineshaft table check knife.csv --master 20000 --cell cell.yaml --axis knife
  lineshaft table check lift.csv --master 36000 --interpolation cubic

Exit codes: 0 good, 2 a limit is exceeded, bad usage, or a file with errors.";

const PLOT_HELP: &str = "\
Examples:
  lineshaft table plot knife.yaml -o knife.svg
  lineshaft table plot knife.csv --form xy -o knife.png

Exit codes: 0 good, 2 bad usage or a file with errors.";

const CONVERT_HELP: &str = "\
A .yaml file holds an entry of section `tables`, as it stands in a cell; a cell may be read, too. From form y to form xy the period of \
the master is needed; from xy to y the places have to be at equal distances.

Examples:
  lineshaft table convert knife.csv knife.yaml --name knife --master 20000
  lineshaft table convert cell.yaml knife.csv --name knife
  lineshaft table convert knife.csv places.csv --to xy --master 20000

Exit codes: 0 good, 2 bad usage or a file with errors.";

/// Forms of tables on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum FormArg {
    /// One column: values at equal distances of the master
    Y,
    /// Two columns: place of the master, value
    Xy,
    /// One column: 16-bit words of a data block
    Words,
}

impl From<FormArg> for Form {
    fn from(form: FormArg) -> Self {
        match form {
            FormArg::Y => Self::Y,
            FormArg::Xy => Self::Xy,
            FormArg::Words => Self::Words,
        }
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct MakeArgs {
    /// The description: FILE.yaml
    pub(super) description: PathBuf,
    /// The table: FILE.csv; one that exists is replaced
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

/// A table as a motion.
#[derive(Debug, Args)]
pub(in crate::cli) struct SourceArgs {
    /// A description (FILE.yaml) or points (FILE.csv)
    pub(super) file: PathBuf,
    /// Form of a CSV file; left out: y
    #[arg(long, value_enum)]
    pub(super) form: Option<FormArg>,
    /// Period of the master of a CSV file of form y (inc)
    #[arg(long, value_name = "INC", value_parser = value_parser!(i64).range(1..=i64::from(i32::MAX)))]
    pub(super) master: Option<i64>,
    /// The CSV file is run through once, not round and round: its end is not beside its start
    #[arg(long)]
    pub(super) once: bool,
    /// What is between the points of a CSV file, as key `interpolation` of a cam says; left out: linear
    #[arg(long, value_name = "linear|cubic|quintic", value_parser = interpolation)]
    pub(super) interpolation: Option<Interpolation>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct CheckArgs {
    #[command(flatten)]
    pub(super) source: SourceArgs,
    /// The cell of the axis
    #[arg(long, value_name = "CELL", requires = "axis")]
    pub(super) cell: Option<PathBuf>,
    /// The axis that is to follow the table
    #[arg(long, value_name = "NAME", requires = "cell")]
    pub(super) axis: Option<String>,
    /// Speed of the master, such as `40000 inc/s`, or with --leader `300 mm/s`; a number without a unit is in inc/s. Without it that is
    /// max_velocity of the leader, if --leader names an axis
    #[arg(long, value_name = "SPEED")]
    pub(super) master_speed: Option<String>,
    /// The master in the cell: an axis, an encoder, or what else can lead
    #[arg(long, value_name = "NAME", requires = "cell")]
    pub(super) leader: Option<String>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct PlotArgs {
    #[command(flatten)]
    pub(super) source: SourceArgs,
    /// The figure: FILE.svg or FILE.png; one that exists is replaced
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// Width (px, 500 to 8000)
    #[arg(long, value_name = "N", default_value_t = 1200, value_parser = pixels(WIDTHS))]
    pub(super) width: u32,
    /// Height (px, 200 to 20000); left out: what the panels need
    #[arg(long, value_name = "N", value_parser = pixels(HEIGHTS))]
    pub(super) height: Option<u32>,
    /// A line above the figure; left out: the name of the file
    #[arg(long, value_name = "TEXT")]
    pub(super) title: Option<String>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ConvertArgs {
    /// FILE.csv, or FILE.yaml with section `tables`
    pub(super) input: PathBuf,
    /// FILE.csv or FILE.yaml; one that exists is replaced, but no .yaml file with more than a table
    pub(super) output: PathBuf,
    /// Form of a CSV file that is read; left out: y
    #[arg(long, value_enum)]
    pub(super) form: Option<FormArg>,
    /// Form of what is written; left out: that of what is read
    #[arg(long, value_enum)]
    pub(super) to: Option<FormArg>,
    /// Period of the master (inc): from form y to form xy, or the length of a cam of form y in a .yaml file
    #[arg(long, value_name = "INC", value_parser = value_parser!(i64).range(1..=i64::from(i32::MAX)))]
    pub(super) master: Option<i64>,
    /// Name of the table in a .yaml file; left out: that of the only one there, or of the CSV file
    #[arg(long, value_name = "NAME")]
    pub(super) name: Option<String>,
}

fn interpolation(text: &str) -> Result<Interpolation, String> {
    let found = Interpolation::ALL.iter().find(|(name, _)| *name == text).map(|(_, each)| *each);
    found.ok_or_else(|| "linear, cubic and quintic are allowed".to_owned())
}
