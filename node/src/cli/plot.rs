//! `lineshaft plot`.

use super::command_output::watch;
use super::{Exit, PlotArgs, complain, say};
use crate::recording::plot::{Across, Chosen, Figure, Problem, Target, write};
use crate::recording::run::{Run, RunError};
use crate::recording::series::{Recorded, SeriesError, alias, load};
use lineshaft_core::unit::{Dimension, Quantity};
use std::path::Path;

/// Why nothing was drawn.
#[derive(Debug, thiserror::Error)]
enum PlotError {
    #[error("{0}")]
    Run(#[from] RunError),
    #[error("{0}")]
    Series(#[from] SeriesError),
    #[error("{0}")]
    Figure(#[from] Problem),
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
    // Reading a run takes time: what is wrong with the names is said before.
    Target::of(&args.output)?;
    let mut run = Run::open(&args.run)?;
    watch(&mut run);
    let recorded = load(&mut run, &args.signals)?;
    run.end_progress();
    let is_named =
        |name: &String| args.signals.contains(name) || alias(name).is_some_and(|alias| args.signals.contains(&alias));
    let signals = recorded.series.iter().map(|series| Chosen { series, by_name: is_named(&series.name) });
    let figure = Figure {
        title: args.title.clone().unwrap_or_else(|| name(&args.run)),
        signals: signals.collect(),
        marks: &recorded.marks,
        from: args.from,
        to: args.to,
        across: Across::Time,
        width: args.width,
        height: args.height,
    };
    write(&figure, &args.output)?;
    Ok(recorded)
}

/// The last part of a path: where it is is of no interest in a figure.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A time on the command line (s).
pub(super) fn time(text: &str) -> Result<f64, String> {
    Quantity::parse(text, &[Dimension::Time]).map(|time| time.si()).map_err(|error| error.sentence())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Command, Line};
    use crate::recording::plot::{HEIGHTS, WIDTHS};
    use crate::recording::test_bags::{TestBag, joints};
    use clap::Parser;
    use std::path::PathBuf;

    fn args(run: PathBuf, signals: &[&str], output: PathBuf) -> PlotArgs {
        let signals = signals.iter().map(|signal| (*signal).to_owned()).collect();
        PlotArgs { run, signals, output, from: None, to: None, width: 900, height: None, title: None }
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
        let problem = draw(&args(run.clone(), &["z.*"], output)).unwrap_err().to_string();
        assert!(problem.starts_with("no signal matches `z.*`"), "{problem}");
        let problem = draw(&args(run, &["*"], folder.path().join("swing.pdf"))).unwrap_err().to_string();
        assert!(problem.ends_with("swing.pdf ends with neither .svg nor .png"), "{problem}");
    }

    #[test]
    fn times_are_seconds_or_have_a_unit() {
        assert_eq!(time("1.2 s"), Ok(1.2));
        assert_eq!(time("250 ms"), Ok(0.25));
        assert_eq!(time("3"), Ok(3.0));
        assert!(time("3 mm").is_err());
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
        // It never changes, and is drawn as it is named in full.
        draw(&args(run, &["x.position"], output)).unwrap();
    }

    #[test]
    fn a_figure_is_named_after_its_run() {
        assert_eq!(name(Path::new("/var/bags/first_move.mcap")), "first_move.mcap");
        assert_eq!(name(Path::new("/var/bags/night/")), "night");
    }
}
