//! `lineshaft table`: processes tables of cams without a machine.
//!
//! Law      errors of a file are reported with file, line and column; a file is written as a whole or not at all
//! Refuses  wrong arguments and files, and tables that exceed the limits of an axis, with exit code 2

mod args;
mod check;
mod convert;

pub(super) use self::args::TableCommand;
use self::args::{MakeArgs, PlotArgs, SourceArgs};
use super::{Exit, complain, say};
use crate::document::{Document, Place};
use crate::recording::plot::{Target, replace};
use crate::table::csv::{self, Refused};
use crate::table::description::Description;
use crate::table::figure::{self, Sheet};
use crate::table::motion::{Motion, Points};
use lineshaft_core::table::{Form, Table};
use std::path::Path;

/// Reason why a command failed, as text.
#[derive(Debug)]
enum Failure {
    /// Problems of files, each with its location.
    Problems(String),
    /// An error message.
    Sentence(String),
}

impl Failure {
    /// Returns the failure for an error of a file.
    fn of(path: &Path, Refused { place, sentence }: Refused) -> Self {
        match place {
            Some(Place { line, col }) => Self::Problems(format!("{}:{line}:{col}: {sentence}\n", path.display())),
            None => Self::Sentence(format!("{}: {sentence}", path.display())),
        }
    }

    fn tell(&self) -> Exit {
        match self {
            Self::Problems(lines) => eprint!("{lines}"),
            Self::Sentence(sentence) => complain(sentence),
        }
        Exit::Usage
    }
}

pub(super) fn table(command: &TableCommand) -> Exit {
    let done = match command {
        TableCommand::Make(args) => make(args),
        TableCommand::Check(args) => check::check(args),
        TableCommand::Plot(args) => plot(args),
        TableCommand::Convert(args) => convert::convert(args),
    };
    done.unwrap_or_else(|failure| failure.tell())
}

/// Format of a file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    Yaml,
}

impl Format {
    fn of(path: &Path) -> Result<Self, Failure> {
        match path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("yaml" | "yml") => Ok(Self::Yaml),
            _ => Err(Failure::Sentence(format!("{} ends with neither .csv nor .yaml", path.display()))),
        }
    }
}

/// Returns the last part of a path, without the folder.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn save(path: &Path, text: &str) -> Result<(), Failure> {
    replace(path, text.as_bytes()).map_err(|problem| Failure::Sentence(problem.to_string()))
}

fn describe(path: &Path) -> Result<Description, Failure> {
    let document = Document::read(path);
    let description = Description::read(&document);
    let problems = document.into_problems();
    description.filter(|_| problems.is_empty()).ok_or_else(|| Failure::Problems(problems.to_string()))
}

/// Reads the table of a CSV file.
fn read_csv(path: &Path, form: Form) -> Result<Table, Failure> {
    let of = |refused| Failure::of(path, refused);
    let (x, y) = csv::load(path).and_then(|text| csv::parse(&text, form)).map_err(of)?;
    Table::new(form, &x, &y).map_err(|error| of(Refused { place: None, sentence: error.to_string() }))
}

/// Reads the motion of a description or of a CSV file.
fn motion(args: &SourceArgs) -> Result<Motion, Failure> {
    let path = args.file.as_path();
    if Format::of(path)? == Format::Yaml {
        let given = [
            ("--form", args.form.is_some()),
            ("--master", args.master.is_some()),
            ("--once", args.once),
            ("--interpolation", args.interpolation.is_some()),
        ];
        if let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            return Err(Failure::Sentence(format!("{option} is for a CSV file; a description says it itself")));
        }
        let description = describe(path)?;
        description.table().map_err(|refused| Failure::of(path, refused))?;
        return Ok(Motion::Planned(description));
    }
    let table = read_csv(path, args.form.map_or(Form::Y, Form::from))?;
    let points = Points::new(table, args.master, !args.once, args.interpolation.unwrap_or_default());
    points.map(Motion::Points).map_err(|sentence| Failure::of(path, Refused { place: None, sentence }))
}

fn make(args: &MakeArgs) -> Result<Exit, Failure> {
    if Format::of(&args.output)? != Format::Csv {
        return Err(Failure::Sentence(format!("{} has to end with .csv", args.output.display())));
    }
    let description = describe(&args.description)?;
    let table = description.table().map_err(|refused| Failure::of(&args.description, refused))?;
    save(&args.output, &csv::text(&table, &description.comments()))?;
    say(&args.output.display());
    Ok(Exit::Good)
}

fn plot(args: &PlotArgs) -> Result<Exit, Failure> {
    let sentence = |problem: crate::recording::plot::Problem| Failure::Sentence(problem.to_string());
    // Names are checked first, because reading a long table takes time.
    Target::of(&args.output).map_err(sentence)?;
    let title = args.title.clone().unwrap_or_else(|| name(&args.source.file));
    let sheet = Sheet { title, width: args.width, height: args.height };
    figure::draw(&motion(&args.source)?, sheet, &args.output).map_err(sentence)?;
    say(&args.output.display());
    Ok(Exit::Good)
}
