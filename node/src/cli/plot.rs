//! `lineshaft plot`.

use super::command_output::watch;
use super::{Exit, complain, say, times};
use crate::recording::bag::SCENARIO;
use crate::recording::plot::{Across, Chosen, Figure, HEIGHTS, Problem, Target, WIDTHS, write};
use crate::recording::run::{Run, RunError};
use crate::recording::series::{Kind, Recorded, Series, SeriesError, alias, load};
use clap::Args;
use clap::builder::RangedU64ValueParser;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct PlotArgs {
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
    #[arg(long, value_name = "SIGNAL=UNIT", value_parser = unit)]
    unit: Vec<(String, String)>,
}

/// Reason why no figure was drawn.
#[derive(Debug, thiserror::Error)]
enum PlotError {
    #[error("{0}")]
    Run(#[from] RunError),
    #[error("{0}")]
    Series(#[from] SeriesError),
    #[error("{0}")]
    Figure(#[from] Problem),
    #[error("--unit {name}={unit}: {reason}")]
    Unit { name: String, unit: String, reason: String },
}

pub(super) fn plot(args: &PlotArgs) -> Exit {
    match draw(args) {
        Ok(recorded) => {
            for cut in &recorded.cuts {
                eprintln!("warning: {cut}");
            }
            for late in &recorded.late {
                eprintln!("warning: {late}");
            }
            say(&args.output.display());
            Exit::Good
        }
        Err(error) => {
            complain(&error);
            Exit::Usage
        }
    }
}

fn draw(args: &PlotArgs) -> Result<Recorded, PlotError> {
    // Names are checked first, because reading a run takes time.
    Target::of(&args.output)?;
    let mut run = Run::open(&args.run)?;
    watch(&mut run);
    let mut recorded = load(&mut run, &args.signals)?;
    run.end_progress();
    for (name, unit) in &args.unit {
        set_unit(&mut recorded.series, name, unit)?;
    }
    let is_named =
        |name: &String| args.signals.contains(name) || alias(name).is_some_and(|alias| args.signals.contains(&alias));
    let signals = recorded.series.iter().map(|series| Chosen { series, by_name: is_named(&series.name) });
    let figure = Figure {
        title: args.title.clone().or_else(|| scenario(&run)).unwrap_or_else(|| name(&args.run)),
        signals: signals.collect(),
        marks: &recorded.marks,
        from: args.from,
        to: args.to,
        across: Across::Time,
        width: args.width,
        height: args.height,
        split: args.split,
    };
    write(&figure, &args.output)?;
    Ok(recorded)
}

/// Sets the unit of the signals with that name; a factor before the unit multiplies their values.
fn set_unit(series: &mut [Series], name: &str, text: &str) -> Result<(), PlotError> {
    let (factor, unit) = match text.split_once(' ').map(|(factor, unit)| (factor.parse::<f64>(), unit)) {
        Some((Ok(factor), unit)) if factor.is_normal() => (factor, unit),
        _ => (1.0, text),
    };
    let mut is_found = false;
    for series in series.iter_mut().filter(|series| series.name == name) {
        is_found = true;
        unit.clone_into(&mut series.unit);
        // Values in another unit are not integers any more.
        if factor != 1.0 {
            series.kind = Kind::Real;
            series.points.iter_mut().for_each(|point| point.1 *= factor);
        }
    }
    if is_found {
        return Ok(());
    }
    let reason = format!("{name} is not one of the chosen signals");
    Err(PlotError::Unit { name: name.to_owned(), unit: text.to_owned(), reason })
}

/// Returns a parser of a size within a range, in px.
pub(super) fn pixels((least, most): (u32, u32)) -> RangedU64ValueParser<u32> {
    RangedU64ValueParser::new().range(u64::from(least)..=u64::from(most))
}

/// Parses a signal and its unit.
fn unit(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').filter(|(name, unit)| !name.is_empty() && !unit.is_empty());
    pair.map(|(name, unit)| (name.to_owned(), unit.to_owned()))
        .ok_or_else(|| "must be a signal and its unit, as `lag=inc`".to_owned())
}

/// Returns the name of the scenario that was played.
fn scenario(run: &Run) -> Option<String> {
    let name = run.metadata("lineshaft")?.get(SCENARIO)?;
    Some(name.clone()).filter(|name| !name.trim().is_empty())
}

/// Returns the last part of a path; a figure does not show the folder.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use crate::cli::{Command, Line};
    use crate::interrupt::Interrupt;
    use crate::recording::bag::BagOptions;
    use crate::recording::test_bags::{TestBag, joints};
    use crate::scenario::{Options, Scenario, simulate};
    use clap::Parser;

    fn args(run: PathBuf, signals: &[&str], output: PathBuf) -> PlotArgs {
        let signals = signals.iter().map(|signal| (*signal).to_owned()).collect();
        let (from, to, height, title, unit) = (None, None, None, None, Vec::new());
        PlotArgs { run, signals, output, from, to, width: 900, height, title, split: false, unit }
    }

    #[test]
    fn a_bag_of_any_recorder_is_drawn() {
        let folder = tempfile::tempdir().unwrap();
        let (run, output) = (folder.path().join("swing.mcap"), folder.path().join("swing.svg"));
        let mut bag = TestBag::new();
        for n in 0..200_u32 {
            let stamp = u64::from(n) * 10_000_000;
            bag.message("/joint_states", stamp, &joints(stamp, &[("x", (f64::from(n) / 30.0).sin()), ("y", 0.5)]));
        }
        std::fs::write(&run, bag.finish()).unwrap();
        draw(&args(run.clone(), &["*.position"], output.clone())).unwrap();
        let svg = std::fs::read_to_string(&output).unwrap();
        for text in ["\nswing.mcap\n", "\nx.actual.position\n", "\ntime (s)\n", "constant: y.actual.position 0.5"] {
            assert!(svg.contains(text), "`{text}` is not in {svg}");
        }
        let problem = draw(&args(run.clone(), &["z.*"], output.clone())).unwrap_err().to_string();
        assert!(problem.starts_with("no signal matches `z.*`"), "{problem}");
        let units = |unit: &str| {
            let unit = vec![super::unit(unit).unwrap()];
            let args = PlotArgs { unit, ..args(run.clone(), &["*.position"], output.clone()) };
            draw(&args).map_err(|problem| problem.to_string())?;
            Ok::<String, String>(std::fs::read_to_string(&output).unwrap())
        };
        assert_eq!(units("z=inc"), Err("--unit z=inc: z is not one of the chosen signals".to_owned()));
        // The values are from -1 to 1.
        let drawn = units("x.actual.position=1000 mm").unwrap();
        assert!(drawn.contains("\nposition (mm)\n") && drawn.contains("\n1000\n"), "{drawn}");
        assert!(super::unit("lag").is_err() && super::unit("=inc").is_err());
        let problem = draw(&args(run, &["*"], folder.path().join("swing.pdf"))).unwrap_err().to_string();
        assert!(problem.ends_with("swing.pdf ends with neither .svg nor .png"), "{problem}");
    }

    #[test]
    fn a_figure_of_a_scenario_has_its_name_as_title() {
        let folder = tempfile::tempdir().unwrap();
        let (bag, output) = (folder.path().join("a.mcap"), folder.path().join("a.svg"));
        let cell = Cell::demo();
        let text = "scenario: x moves to 5 mm\nfor: 0.5 s\nsteps:\n  - {at: 0, do: {enable: {axes: [x]}}}\n  - when: \
                    {signal: x.state, is: STANDSTILL}\n    do: {move_axis: {axis: x, mode: absolute, position: 5 mm, \
                    velocity: 0.1 m/s}}\n";
        let scenario = Scenario::parse("x.yaml", text, &cell).unwrap();
        let record = Some(BagOptions::split(bag.clone(), 0, 0));
        let options = Options { record, csv: None, events: false, progress: false, interrupt: Interrupt::default() };
        simulate(&cell, &scenario, &options).unwrap();
        draw(&args(bag, &["x.command.position"], output.clone())).unwrap();
        let svg = std::fs::read_to_string(&output).unwrap();
        assert!(svg.contains("\nx moves to 5 mm\n") && !svg.contains("a.mcap"));
    }

    /// Two topics may have a signal with the same name.
    #[test]
    fn unit_is_that_of_all_signals_with_the_name() {
        let one = |topic: &str| Series {
            name: "lag".to_owned(),
            unit: String::new(),
            kind: Kind::Int,
            topic: topic.to_owned(),
            points: vec![(0.0, 2.0)],
            gaps: Vec::new(),
        };
        let mut series = [one("/left/signals"), one("/right/signals")];
        set_unit(&mut series, "lag", "0.5 mm").unwrap();
        for series in &series {
            assert_eq!((series.unit.as_str(), series.points[0]), ("mm", (0.0, 1.0)), "{}", series.topic);
            assert_eq!(series.kind, Kind::Real);
        }
    }

    #[test]
    fn times_before_the_start_and_sizes_are_checked() {
        let parse = |more: &[&str]| {
            let line = ["lineshaft", "plot", "run.mcap", "--signals", "x.*", "-o", "x.svg"];
            Line::try_parse_from(line.iter().chain(more)).map_err(|error| error.to_string())
        };
        for (text, time) in [("-1 s", -1.0), ("-250 ms", -0.25), ("-3", -3.0), ("2 s", 2.0)] {
            let line = parse(&["--from", text, "--to", text]).unwrap();
            let Some(Command::Plot(args)) = line.command else { panic!("{line:?}") };
            assert_eq!((args.from, args.to), (Some(time), Some(time)));
        }
        for (size, range) in [("--width", WIDTHS), ("--height", HEIGHTS)] {
            let range = format!("{}..={}", range.0, range.1);
            let problem = parse(&[size, "100"]).unwrap_err();
            assert!(problem.contains(&format!("100 is not in {range}")), "{problem}");
        }
        let help = parse(&["--help"]).unwrap_err();
        for (least, most) in [WIDTHS, HEIGHTS] {
            assert!(help.contains(&format!("(px, {least} to {most})")), "{help}");
        }
    }

    #[test]
    fn a_signal_may_be_named_by_its_field() {
        let folder = tempfile::tempdir().unwrap();
        let (run, output) = (folder.path().join("still.mcap"), folder.path().join("still.svg"));
        let mut bag = TestBag::new();
        for stamp in [0, 10] {
            bag.message("/joint_states", stamp, &joints(stamp, &[("x", 0.5)]));
        }
        std::fs::write(&run, bag.finish()).unwrap();
        // It never changes, but is drawn because its full name was given.
        draw(&args(run, &["x.position"], output)).unwrap();
    }

    #[test]
    fn a_figure_is_named_after_its_run() {
        assert_eq!(name(Path::new("/var/bags/first_move.mcap")), "first_move.mcap");
        assert_eq!(name(Path::new("/var/bags/night/")), "night");
    }
}
