//! `lineshaft sim --all DIR`: plays all scenarios of a folder in parallel.
//!
//! Law      the scenarios are all files NAME.scenario.yaml in the folder and its subfolders, in the order of their
//!          paths. Their results are printed in that order, whichever is finished first
//! Refuses  folders that cannot be read, or without a scenario

use super::played::{ERROR, FAILED, PASSED, Played, Trouble};
use crate::cell::Cell;
use crate::cli::Exit;
use crate::cli::command_output::Output;
use crate::interrupt::Interrupt;
use crate::progress::{MOMENT, Progress};
use crate::scenario::{Options, SUFFIX, Scenario, cell_next_to, cell_of, other_cell, simulate};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

/// Stack of each thread, in bytes; as large as that of the main thread of a program usually is.
const STACK: usize = 8 << 20;

/// Plays all scenarios of a folder and prints the result of each, and a summary.
pub(super) fn play(
    folder: &Path,
    jobs: Option<u16>,
    interrupt: &Interrupt,
    output: &mut Output,
) -> (Vec<Played>, Exit) {
    let usual = || thread::available_parallelism().map_or(1, usize::from);
    let jobs = jobs.map_or_else(usual, usize::from);
    let found = find(folder);
    let played = found.and_then(|scenarios| {
        let mut progress = Progress::wanted("scenarios", MOMENT, !output.is_json());
        let count = scenarios.len();
        side_by_side(&scenarios, jobs, interrupt, |done, played| {
            progress.aside(|| played.show_briefly(output));
            progress.set(done, Some(count));
        })
    });
    match played {
        Ok(played) => {
            output.say(&summary(&played));
            let exit = exit(&played);
            (played, exit)
        }
        Err(sentence) => {
            output.complain(&format_args!("--all {}: {sentence}", folder.display()));
            (Vec::new(), Exit::Usage)
        }
    }
}

/// Returns text such as `5 passed, 1 failed, 2 with errors`.
fn summary(played: &[Played]) -> String {
    let count = |verdict: &str| played.iter().filter(|played| played.verdict() == verdict).count();
    let errors = match count(ERROR) {
        0 => String::new(),
        errors => format!(", {errors} with errors"),
    };
    format!("{} passed, {} failed{errors}", count(PASSED), count(FAILED))
}

fn exit(played: &[Played]) -> Exit {
    if let Some(signal) = played.iter().find_map(Played::ended_by) {
        return Exit::Signal(signal);
    }
    let has = |verdict: &str| played.iter().any(|played| played.verdict() == verdict);
    if has(ERROR) {
        Exit::Usage
    } else if has(FAILED) {
        Exit::Failed
    } else {
        Exit::Good
    }
}

/// Returns the paths of all scenarios of a folder, sorted; at least one.
fn find(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let (mut scenarios, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        let cannot = |error: std::io::Error| format!("cannot read the folder {}: {error}", folder.display());
        for entry in fs::read_dir(&folder).map_err(cannot)? {
            let entry = entry.map_err(cannot)?;
            // A link to a folder is not followed, because it may form a loop.
            match entry.file_type().map_err(cannot)?.is_dir() {
                true => folders.push(entry.path()),
                false => scenarios.extend(Some(entry.path()).filter(|path| is_scenario(path))),
            }
        }
    }
    scenarios.sort();
    if scenarios.is_empty() { Err(format!("there is no file NAME{SUFFIX}")) } else { Ok(scenarios) }
}

fn is_scenario(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.len() > SUFFIX.len() && name.ends_with(SUFFIX)
}

/// Plays scenarios with this number of threads; calls `each` in their order with the number of finished ones and the
/// last one of these.
fn side_by_side(
    scenarios: &[PathBuf],
    jobs: usize,
    interrupt: &Interrupt,
    mut each: impl FnMut(usize, &Played),
) -> Result<Vec<Played>, String> {
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..jobs.clamp(1, scenarios.len().max(1)) {
            let (sender, next) = (sender.clone(), &next);
            let work = move || {
                // A thread ends on an interrupt, if no scenario is left, or if there is no receiver after an error.
                while interrupt.requested().is_none() {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(scenario) = scenarios.get(place) else { return };
                    if sender.send((place, play_one(scenario, interrupt))).is_err() {
                        return;
                    }
                }
            };
            let thread = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
            let _thread = thread.map_err(|error| format!("no thread can be started: {error}; give fewer --jobs"))?;
        }
        drop(sender);
        let (mut early, mut played) = (BTreeMap::new(), Vec::with_capacity(scenarios.len()));
        for (place, result) in receiver {
            early.insert(place, result);
            while let Some(result) = early.remove(&played.len()) {
                each(played.len() + 1, &result);
                played.push(result);
            }
        }
        Ok(played)
    })
}

fn play_one(scenario: &Path, interrupt: &Interrupt) -> Played {
    let cell = cell_of(scenario);
    // A file that looks like the cell of the scenario but is not used.
    let unused = cell_next_to(scenario).filter(|path| path.is_file() && other_cell(scenario, Some(path)).is_some());
    let note = unused.map(|unused| {
        let (file, unused) = (scenario.display(), unused.display());
        format!("{file}: its key `cell` names the cell; {unused} is not used")
    });
    Played::new(scenario, cell, note, |cell| {
        let cell = Cell::load(cell)?;
        let scenario = Scenario::load(scenario, &cell)?;
        let options = Options { interrupt: interrupt.clone(), ..Options::default() };
        simulate(&cell, &scenario, &options).map_err(Trouble::Simulate)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Place, Problems};

    fn scenario(seed: usize) -> PathBuf {
        PathBuf::from(format!("missing/{seed:03}.scenario.yaml"))
    }

    #[test]
    fn results_come_in_the_order_of_the_scenarios_for_any_number_of_jobs() {
        let scenarios: Vec<_> = (0..50).map(scenario).collect();
        for jobs in [1, 2, 7, 256] {
            let mut order = Vec::new();
            let played = side_by_side(&scenarios, jobs, &Interrupt::default(), |done, played| {
                order.push((done, played.json()["scenario_file"].as_str().map(str::to_owned)));
            });
            let expected: Vec<_> = (0..50).map(|seed| (seed + 1, Some(scenario(seed).display().to_string()))).collect();
            assert_eq!(order, expected, "{jobs}");
            let played = played.unwrap();
            assert!(played.len() == 50 && played.iter().all(|played| played.verdict() == ERROR));
        }
        assert_eq!(side_by_side(&[], 4, &Interrupt::default(), |_, _| panic!("there is none")).unwrap().len(), 0);
    }

    #[test]
    fn scenarios_are_found_below_the_folder_in_the_order_of_their_paths() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        for name in [
            "b/z.scenario.yaml",
            "b/a/m.scenario.yaml",
            "a.scenario.yaml",
            "c.yaml",
            ".scenario.yaml",
            "b/x.scenario.yml",
        ] {
            fs::create_dir_all(root.join(name).parent().unwrap()).unwrap();
            fs::write(root.join(name), "").unwrap();
        }
        std::os::unix::fs::symlink(root, root.join("b/loop")).unwrap();
        let names: Vec<_> =
            find(root).unwrap().iter().map(|path| path.strip_prefix(root).unwrap().to_owned()).collect();
        assert_eq!(names, ["a.scenario.yaml", "b/a/m.scenario.yaml", "b/z.scenario.yaml"].map(PathBuf::from));
        let empty = tempfile::tempdir().unwrap();
        assert_eq!(find(empty.path()).unwrap_err(), "there is no file NAME.scenario.yaml");
        assert!(find(&root.join("none")).unwrap_err().starts_with("cannot read the folder "));
    }

    #[test]
    fn errors_weigh_more_than_failures_in_summary_and_exit() {
        let bad = || {
            let problems = Problems::new("s.yaml");
            problems.push(Place::START, "bad", None);
            Played::new(Path::new("s.yaml"), Err(problems), None, |_| panic!("there is no cell"))
        };
        let run = |failed: bool| {
            let cell = Cell::demo();
            let is = if failed { "5 mm" } else { "0 mm" };
            let text =
                format!("scenario: s\ncycles: 5\nexpect:\n  - {{signal: x.command.position, at: end, is: {is}}}\n");
            let read = Scenario::parse("s.yaml", &text, &cell).unwrap();
            let report = simulate(&cell, &read, &Options::default()).unwrap();
            Played::new(Path::new("s.yaml"), Ok(PathBuf::from("demo.yaml")), None, |_| Ok(report))
        };
        let all = [run(false), run(true), run(true), bad()];
        assert_eq!((summary(&all), exit(&all)), ("1 passed, 2 failed, 1 with errors".to_owned(), Exit::Usage));
        assert_eq!((summary(&all[..3]), exit(&all[..3])), ("1 passed, 2 failed".to_owned(), Exit::Failed));
        assert_eq!((summary(&all[..1]), exit(&all[..1])), ("1 passed, 0 failed".to_owned(), Exit::Good));
    }
}
