//! Tests that the program accepts every command and every block of YAML in README.md and docs/*.md.

use crate::support::{
    machine::share,
    pages::{self, Page, Quote, root, words},
};
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Placeholders in capitals, with values for those that the parser restricts.
const VALUES: &[(&str, &str)] = &[("NODE", "1"), ("ADDRESS", "socketcan:can0"), ("TIME", "1 s"), ("COMMAND", "sim")];

/// Cells and scenarios for placeholders and for files of the user: page or any, word, file of the repository.
const STANDS_FOR: &[(&str, &str, &str)] = &[
    ("docs/cams.md", "CELL", "launch-configs/cams/01_flying_knife.yaml"),
    ("docs/cams.md", "SCENARIO", "launch-configs/cams/01_flying_knife.scenario.yaml"),
    ("docs/can.md", "machine.yaml", "launch-configs/can/drive.yaml"),
    ("docs/can.md", "machine.scenario.yaml", "launch-configs/can/first_move.scenario.yaml"),
    ("docs/moveit.md", "CELL", "arm.yaml"),
    ("docs/functions.md", "CELL", "launch-configs/functions.yaml"),
    ("docs/shaft.md", "CELL", "launch-configs/shaft/01_labeller.yaml"),
    ("docs/shaft.md", "SCENARIO", "launch-configs/shaft/01_labeller.scenario.yaml"),
    ("docs/storage.md", "FILE", "store.yaml"),
    ("docs/contract.md", "CELL", "arm.yaml"),
    ("docs/contract.md", "FILE", "joint_limits.yaml"),
    ("docs/ci.md", "FILE", "launch-configs/arm6/arm6.scenario.yaml"),
    ("", "CELL", "launch-configs/demo.yaml"),
    ("", "CELL.yaml", "launch-configs/demo.yaml"),
    ("", "cell.yaml", "launch-configs/demo.yaml"),
    ("", "S", "launch-configs/scenarios/first_move.yaml"),
    ("", "S.yaml", "launch-configs/scenarios/first_move.yaml"),
    ("", "s.yaml", "launch-configs/scenarios/first_move.yaml"),
    ("", "acceptance.yaml", "launch-configs/scenarios/first_move.yaml"),
    ("", "CAM.yaml", "knife.yaml"),
    ("", "CAM.csv", "cam.csv"),
    ("", "TYPE", "varsync"),
    ("", "RUN", "run.mcap"),
];

/// Files that pages assume, and the files of the repository that are copied there.
const FIXTURES: &[(&str, &str)] = &[
    ("knife.yaml", "launch-configs/functions/tables/knife.yaml"),
    ("joint_limits.yaml", "launch-configs/arm6/joint_limits.yaml"),
    ("config/joint_limits.yaml", "launch-configs/arm6/joint_limits.yaml"),
    ("arm.yaml", "launch-configs/arm6/arm6.yaml"),
    ("arm6.urdf", "launch-configs/arm6/arm6.urdf"),
    ("pick.scenario.yaml", "launch-configs/arm6/arm6.scenario.yaml"),
    ("plan.yaml", "launch-configs/arm6/plan.yaml"),
    ("machine.yaml", "launch-configs/demo.yaml"),
    ("cell.yaml", "launch-configs/demo.yaml"),
];

/// Runs that pages assume: first_move.yaml with the demo.
const RUNS: [&str; 4] = ["run", "run.mcap", "expected.mcap", "look.mcap"];

/// Commands that need neither ROS nor hardware. tests/tune_cli.rs runs `tune`, which takes seconds.
const RUNNABLE: [&str; 12] = [
    "check",
    "sim",
    "signals",
    "params",
    "limits",
    "functions",
    "interfaces",
    "table",
    "replay",
    "validate",
    "plot",
    "bag",
];

/// Options whose value is a written file.
const OUTPUTS: [&str; 7] = ["-o", "--output", "--csv", "--record", "--graph", "--store", ">"];

/// Commands whose files no page contains.
const NOT_RUN: &[&str] = &[
    // With a cell with other limits; tests/table_cli.rs compares the output on the page.
    "lineshaft table check knife.yaml --cell cell.yaml --axis knife --master-speed 18000",
    // With scenarios of the user; tests/ci.rs plays some.
    "lineshaft sim --all . --junit report.xml",
    // Name of a field; its factors need options.
    "lineshaft functions sak",
];

fn commands() -> Vec<Quote> {
    pages::read().iter().flat_map(|page| page.commands("lineshaft ")).collect()
}

/// Returns the words of the program itself: up to a redirection, a pipe or another command.
fn up_to_redirection(words: &[String]) -> &[String] {
    let end = words.iter().position(|word| [">", "|", "&", "<", ";"].contains(&word.as_str()));
    &words[..end.unwrap_or(words.len())]
}

#[test]
fn every_command_on_a_page_parses() {
    let folder = tempfile::tempdir().unwrap();
    let parameters = folder.path().join("parameters.yaml");
    fs::write(&parameters, "/**:\n  ros__parameters: {x.max_velocity: 0.5}\n").unwrap();
    let (mut wrong, mut whole, mut names) = (Vec::new(), 0, 0);
    for quote in commands() {
        let all = words(&quote.text.replace(['[', ']'], ""));
        let all = up_to_redirection(&all);
        let before = |place: usize| place.checked_sub(1).map_or("", |place| all[place].as_str());
        let value = |(place, word): (usize, &String)| match (before(place), word.as_str()) {
            ("--params-file", _) => Some(parameters.to_str().unwrap().to_owned()),
            ("--bus", "..") => Some("socketcan:can0".to_owned()),
            (_, "..") => None,
            (_, word) => {
                Some(VALUES.iter().find(|(name, _)| *name == word).map_or(word, |(_, value)| *value).to_owned())
            }
        };
        let given: Vec<String> = all.iter().enumerate().filter_map(value).collect();
        match lineshaft::cli::parses(given) {
            Ok(()) => whole += 1,
            // A sentence may name only a command or an option: `lineshaft check --graph`.
            Err(error) if error.is_incomplete && !quote.is_block => names += 1,
            Err(error) => wrong.push(format!("{}: {}\n{}", quote.place, quote.text, error.message)),
        }
    }
    println!("{whole} whole commands, {names} names of commands in sentences");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(whole >= 90 && names >= 30, "{whole} {names}");
}

/// Paths below these folders are files of the repository, in commands and in text. ARCHITECTURE.md omits `src`.
#[test]
fn files_that_a_page_names_exist() {
    let (mut missing, mut count) = (Vec::new(), 0);
    let folders = ["launch-configs", "docs", "tests", "node", "core"];
    for quote in pages::read().iter().flat_map(Page::code) {
        for word in words(&quote.text) {
            let path =
                word.split("::").next().unwrap_or_default().trim_end_matches(['.', ',', ':', ';', '}', ')', ']']);
            let Some((folder, file)) = path.split_once('/') else { continue };
            // `node/ros/side` is a module; a pattern or a placeholder is no path.
            if !folders.contains(&folder) || !file.contains('.') || path.contains(['*', '{', '<', '(', '$']) {
                continue;
            }
            count += 1;
            if !root().join(path).exists() && !root().join(folder).join("src").join(file).exists() {
                missing.push(format!("{}: {path}", quote.place));
            }
        }
    }
    println!("{count} names of files");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert!(count >= 60, "{count}");
}

/// Creates a folder with the files that the pages assume.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    copy(&root().join("launch-configs"), &folder.path().join("launch-configs"));
    for made in ["docs", "tmp", "config"] {
        fs::create_dir(folder.path().join(made)).expect("a folder");
    }
    for (name, file) in FIXTURES {
        fs::copy(root().join(file), folder.path().join(name)).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
    for run in RUNS {
        let sim = "sim launch-configs/demo.yaml --scenario launch-configs/scenarios/first_move.yaml --record";
        let output = lineshaft(folder.path(), &[words(sim), vec![run.to_owned()]].concat());
        assert!(output.status.success(), "{}", said(&output));
    }
    folder
}

/// Copies a folder with its content.
fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).expect("a copy");
        }
    }
}

fn lineshaft(folder: &Path, arguments: &[String]) -> Output {
    let _machine = share();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
    command.args(arguments).current_dir(folder).env("ROS_HOME", folder);
    command.output().expect("the program starts")
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Returns the arguments of a command that can be run in the folder of [`workplace`]; `None` for any other.
fn runnable(quote: &Quote, folder: &Path) -> Option<Vec<String>> {
    let all = words(&without_options(&quote.text));
    let stands_for = |word: &String| {
        let found = STANDS_FOR.iter().find(|(page, name, _)| (page.is_empty() || *page == quote.page) && name == word);
        found.map_or_else(|| word.replace("/tmp/", "tmp/"), |(_, _, file)| (*file).to_owned())
    };
    let given: Vec<String> = all.iter().skip(1).map(stands_for).collect();
    let is_known = given.first().is_some_and(|verb| RUNNABLE.contains(&verb.as_str()));
    if !is_known || NOT_RUN.contains(&quote.text.as_str()) || lineshaft::cli::parses(program_of(&given)).is_err() {
        return None;
    }
    let is_output = |place: usize| place > 0 && OUTPUTS.contains(&given[place - 1].as_str());
    let is_there = |(place, word): (usize, &String)| {
        let is_file = ["yaml", "csv", "mcap", "wasm"].iter().any(|end| word.ends_with(&format!(".{end}")));
        is_output(place) || !is_file || folder.join(word).exists()
    };
    given.iter().enumerate().all(is_there).then_some(given)
}

/// Returns a command line for the parser.
fn program_of(given: &[String]) -> Vec<String> {
    [&["lineshaft".to_owned()][..], up_to_redirection(given)].concat()
}

/// Removes optional parts in brackets.
fn without_options(text: &str) -> String {
    let mut parts = text.split('[');
    let begin = parts.next().unwrap_or_default().to_owned();
    parts.fold(begin, |text, part| text + part.split_once(']').map_or("", |(_, rest)| rest))
}

#[test]
fn commands_without_ros_and_hardware_run() {
    let folder = workplace();
    let folder = folder.path();
    let (mut done, mut wrong) = (HashSet::new(), Vec::new());
    for quote in commands() {
        let Some(given) = runnable(&quote, folder) else { continue };
        if !done.insert(given.clone()) {
            continue;
        }
        if let Some(place) = given.iter().position(|word| word == "--record") {
            remove(&folder.join(&given[place + 1]));
        }
        let arguments = up_to_redirection(&given);
        let output = lineshaft(folder, arguments);
        if let Some([redirection, file]) = given.get(arguments.len()..arguments.len() + 2)
            && redirection == ">"
        {
            fs::write(folder.join(file), &output.stdout).unwrap();
        }
        if !output.status.success() {
            wrong.push(format!("{}: {}\n{given:?}\n{}", quote.place, quote.text, said(&output)));
        }
    }
    println!("{} commands run", done.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(done.len() >= 35, "{}", done.len());
}

/// Removes a recording, a file or a folder, with its metadata.
fn remove(path: &Path) {
    let metadata = path.with_file_name("metadata.yaml");
    for path in [path, metadata.as_path()] {
        let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
        assert!(removed.is_ok() || !path.exists(), "{}", path.display());
    }
}

/// Sections of a cell.
const SECTIONS: [&str; 14] = [
    "lineshaft",
    "cycle",
    "ros",
    "backends",
    "io",
    "memory",
    "encoders",
    "axes",
    "functions",
    "groups",
    "tables",
    "machine",
    "safety",
    "programs",
];

/// Returns the keys at the left margin.
fn roots(text: &str) -> Vec<&str> {
    let keys = text.lines().filter_map(|line| line.split_once(':')).map(|(key, _)| key);
    keys.filter(|key| !key.is_empty() && key.chars().all(is_of_key)).collect()
}

fn is_of_key(c: char) -> bool {
    c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'
}

/// Removes the dots that replace other keys on a page.
fn without_dots(text: &str) -> String {
    text.replace("{..}", "{}").replace("{.., ", "{").replace(", ..}", "}").replace(", ..]", "]")
}

/// Writes a block of a page into a file. Returns the command that accepts it, and whether the block is a complete file:
/// parts are completed as parts of a scenario, of a cell or of an axis, and have errors, but no unknown keys.
fn prepared(text: &str, roots: &[&str], folder: &Path) -> (&'static str, bool) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file");
    let has = |key: &str| roots.contains(&key);
    if has("segments") {
        write("table.yaml", text);
        ("table make table.yaml -o table.csv", true)
    } else if has("scenario") {
        write("scenario.yaml", text);
        // For the previous cell on the page.
        ("check cell.yaml --scenario scenario.yaml", true)
    } else if has("lineshaft") {
        write("cell.yaml", text);
        ("check cell.yaml", true)
    } else if has("steps") || has("expect") || text.starts_with("drive:\n  -") {
        write("part.yaml", &format!("scenario: part\ncycles: 10\n{text}"));
        ("check launch-configs/demo.yaml --scenario part.yaml", false)
    } else if roots.iter().all(|root| SECTIONS.contains(root)) {
        write("part.yaml", &format!("lineshaft: 1\ncycle: 1 ms\n{text}"));
        ("check part.yaml", false)
    } else {
        let indented: String = text.lines().map(|line| format!("    {line}\n")).collect();
        write("part.yaml", &format!("lineshaft: 1\ncycle: 1 ms\naxes:\n  x:\n{indented}"));
        ("check part.yaml", false)
    }
}

#[test]
fn yaml_on_a_page_is_accepted() {
    let folder = workplace();
    let folder = folder.path();
    fs::write(folder.join("start.csv"), "start\n0\n1\n0\n").unwrap();
    let (mut wrong, mut whole, mut parts) = (Vec::new(), 0, 0);
    // A list at the root has steps of a CI pipeline; their commands are checked as commands.
    let blocks = pages::read().iter().flat_map(Page::blocks).collect::<Vec<_>>();
    let mut page = "";
    for block in blocks.iter().filter(|block| block.language == "yaml" && !block.text.starts_with("- ")) {
        // A scenario never belongs to the cell of another page.
        let own = block.place.split(':').next().unwrap_or_default();
        if own != page {
            page = own;
            fs::copy(root().join("launch-configs/demo.yaml"), folder.join("cell.yaml")).unwrap();
        }
        let keys = roots(&block.text);
        let (command, is_whole) = prepared(&without_dots(&block.text), &keys, folder);
        let output = lineshaft(folder, &words(command));
        let report = said(&output);
        let is_bad = |line: &str| line.contains("unknown key") || line.contains("is not YAML");
        let is_good = if is_whole { output.status.success() } else { !report.lines().any(is_bad) };
        if !is_good || keys.is_empty() {
            wrong.push(format!("{}: {keys:?}\n{report}", block.place));
        }
        if is_whole {
            whole += 1;
        } else {
            parts += 1;
        }
    }
    println!("{whole} cells, scenarios and tables, {parts} parts of them");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(whole >= 3 && parts >= 14, "{whole} {parts}");
}

/// The page tells readers to save its example and to play it on the demo. The added expectations test that MC_GearOut
/// keeps the velocity, and that MC_Halt then stops the axis.
#[test]
fn example_for_a_plc_plays_on_the_demo() {
    let folder = tempfile::tempdir().unwrap();
    let page = pages::read().into_iter().find(|page| page.name == "docs/from-plc.md").expect("docs/from-plc.md");
    let block = page.blocks().into_iter().find(|block| block.language == "yaml").expect("an example");
    let expected = "expect:\n  - {signal: turret.state, at: 3.4 s, is: CONTINUOUS_MOTION}\n  \
                    - {signal: turret.state, at: end, is: STANDSTILL}\n";
    fs::write(folder.path().join("plc.yaml"), block.text + expected).unwrap();
    fs::copy(root().join("launch-configs/demo.yaml"), folder.path().join("demo.yaml")).unwrap();
    let output = lineshaft(folder.path(), &words("sim demo.yaml --scenario plc.yaml"));
    assert!(output.status.success(), "{}", said(&output));
}

/// Returns the declared arguments of a launch file, and their other spellings.
fn launch_arguments(file: &Path) -> [Vec<String>; 2] {
    let mut command = Command::new("python3");
    command.arg(root().join("tests/launch/stand_in.py")).arg("--show-args").arg(file);
    let output = command.output().expect("the tests need python3");
    let listed: serde_json::Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", said(&output)));
    ["declared", "also"].map(|key| {
        let names = listed[key].as_array().into_iter().flatten();
        names.filter_map(|name| Some(name.as_str()?.to_owned())).collect()
    })
}

#[test]
fn launch_commands_name_files_and_arguments_that_exist() {
    let files = ["launch-configs/demo.launch.py", "launch-configs/arm6/arm6.launch.py"].map(|file| root().join(file));
    let pages = pages::read();
    let mut count = 0;
    let examples = files.iter().flat_map(|file| {
        let text = fs::read_to_string(file).expect("a launch file");
        text.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>()
    });
    let written = pages.iter().flat_map(Page::code).map(|quote| quote.text).chain(examples);
    for text in written.filter(|text| text.starts_with("ros2 launch lineshaft ")) {
        let given = words(&text);
        let named: Option<&PathBuf> = files.iter().find(|file| file.ends_with(&given[3]));
        let [declared, also] = launch_arguments(named.unwrap_or_else(|| panic!("{text}: no such launch file")));
        for argument in given.iter().filter_map(|word| Some(word.split_once(":=")?.0.to_owned())) {
            assert!(declared.contains(&argument) || also.contains(&argument), "{text}: {argument}");
        }
        count += 1;
    }
    assert!(count >= 10, "{count}");
    // README lists the arguments.
    let [declared, _] = launch_arguments(&files[0]);
    let readme = pages.iter().find(|page| page.name == "README.md").expect("README.md").one_line();
    let listed = format!("--show-args` lists the arguments: {}.", declared.join(", "));
    assert!(readme.contains(&listed), "{listed}");
}
