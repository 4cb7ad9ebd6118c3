//! Tests the program on the command line: its output and exit codes.

use crate::support::{domain::Domain, machine::share};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// Runs the program in `folder`.
fn lineshaft(folder: &Path, arguments: &[&str]) -> Output {
    let _machine = share();
    Command::new(env!("CARGO_BIN_EXE_lineshaft"))
        .args(arguments)
        .current_dir(folder)
        .env("ROS_HOME", folder)
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("it ended by itself")
}

/// Returns the YAML blocks of the contract: a cell, then a scenario.
fn examples() -> (String, String) {
    let contract = std::fs::read_to_string(root("docs/contract.md")).expect("the contract");
    let blocks = contract.split("```yaml\n").skip(1).filter_map(|block| block.split("```").next());
    let blocks: Vec<String> = blocks.map(str::to_owned).collect();
    let [cell, scenario] = blocks.try_into().expect("two examples");
    (cell, scenario)
}

#[test]
fn the_contracts_own_cell_and_scenario_are_good() {
    let folder = tempfile::tempdir().unwrap();
    let (cell, scenario) = examples();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("cell.yaml", &cell);
    write("scenario.yaml", &scenario);
    write("start.csv", "start\n0\n1\n0\n");
    let check = lineshaft(folder.path(), &["check", "cell.yaml", "--scenario", "scenario.yaml"]);
    let said = text(&check.stderr);
    assert_eq!((code(&check), said.as_str()), (0, ""));
    let sim = lineshaft(folder.path(), &["sim", "cell.yaml", "--scenario", "scenario.yaml"]);
    assert_eq!(code(&sim), 0, "{}{}", text(&sim.stdout), text(&sim.stderr));
}

#[test]
fn first_move_passes_and_writes_the_same_bytes_twice() {
    let folder = tempfile::tempdir().unwrap();
    let (cell, scenario) = (root("launch-configs/demo.yaml"), root("launch-configs/scenarios/first_move.yaml"));
    let (cell, scenario) = (cell.to_str().unwrap(), scenario.to_str().unwrap());
    for csv in ["a.csv", "b.csv"] {
        let output = lineshaft(folder.path(), &["sim", cell, "--scenario", scenario, "--csv", csv]);
        assert_eq!(code(&output), 0, "{}{}", text(&output.stdout), text(&output.stderr));
        assert!(text(&output.stdout).contains("PASSED"));
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("a.csv").len() > 10_000);
    assert!(read("a.csv") == read("b.csv"), "two runs differ");
}

#[test]
fn every_delivered_scenario_passes() {
    let cell = root("launch-configs/demo.yaml");
    let mut count = 0;
    for entry in std::fs::read_dir(root("launch-configs/scenarios")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "yaml") {
            let arguments = ["sim", cell.to_str().unwrap(), "--scenario", path.to_str().unwrap()];
            let output = lineshaft(&root(""), &arguments);
            assert_eq!(code(&output), 0, "{}{}", text(&output.stdout), text(&output.stderr));
            count += 1;
        }
    }
    assert!(count > 0);
}

#[test]
fn failed_expectation_ends_with_1_and_reports_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "scenario: never there\ncycles: 10\nexpect:\n  - {signal: x.command.position, at: end, is: 5 mm}\n";
    std::fs::write(folder.path().join("s.yaml"), scenario).unwrap();
    let cell = root("launch-configs/demo.yaml");
    let output = lineshaft(folder.path(), &["sim", cell.to_str().unwrap(), "--scenario", "s.yaml"]);
    let report = text(&output.stdout);
    assert_eq!(code(&output), 1);
    assert!(report.contains("FAILED") && report.contains("s.yaml:4:") && report.contains("5 mm"), "{report}");
}

#[test]
fn sim_prints_its_events_as_they_come() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "scenario: refused and done\ncycles: 400\nsteps:\n  \
                    - {at: 3, do: {move_axis: {axis: x, position: 5 mm}}, refused: {code: NOT_ENABLED}}\n  \
                    - {at: 4, do: {move_axis: {axis: nobody, position: 0}}, refused: {code: 10022}}\n  \
                    - {at: 5, do: {move_axis: {axis: line, position: 1 um}}}\n";
    std::fs::write(folder.path().join("s.yaml"), scenario).unwrap();
    let cell = root("launch-configs/demo.yaml");
    let sim = |more: &[&str]| {
        let output =
            lineshaft(folder.path(), &[&["sim", cell.to_str().unwrap(), "--scenario", "s.yaml"], more].concat());
        assert_eq!(code(&output), 0, "{}{}", text(&output.stdout), text(&output.stderr));
        text(&output.stdout)
    };
    let (plain, told) = (sim(&[]), sim(&["--events"]));
    let (events, report) = told.split_once("scenario `").unwrap();
    let without_pace = |report: &str| report.lines().filter(|line| !line.contains("real time")).collect::<String>();
    assert_eq!(without_pace(&format!("scenario `{report}")), without_pace(&plain));
    let lines: Vec<_> = events.lines().collect();
    assert!(
        lines.contains(&"cycle 3 (0.003 s) warn refused: x: the axis is not enabled; enable it first (code 10007)"),
        "{events}"
    );
    let own = "cycle 4 (0.004 s) warn refused: no axis is called `nobody`; there are ";
    assert!(lines.iter().any(|line| line.starts_with(own) && line.ends_with(" (code 10022)")), "{events}");
    assert!(lines.iter().any(|line| line.starts_with("cycle 5 (0.005 s) info accepted: ")), "{events}");
    assert!(lines.iter().any(|line| line.contains(" info done: ") && !line.contains("code")), "{events}");
}

/// Unknown keys, wrong units, duplicate names, a limit above its counterpart, a missing file, wrong usage: each ends
/// with 2 and starts nothing.
#[test]
fn bad_files_and_bad_usage_end_with_2() {
    let folder = tempfile::tempdir().unwrap();
    let demo = std::fs::read_to_string(root("launch-configs/demo.yaml")).unwrap();
    let bad = [
        ("max_velocity: 90 deg/s", "max_velocty: 90 deg/s", "did you mean `max_velocity`?"),
        ("max_velocity: 90 deg/s", "max_velocity: 90 mm", "an angular velocity such as"),
        ("  turret:", "  x:", "x"),
        ("min_position: -50 mm", "min_position: 900 mm", "min_position"),
        ("cycle: 1 ms", "cycle: 1 s", "20 ms"),
        ("type: rotary", "type: rotry", "did you mean `rotary`?"),
    ];
    for (from, to, said) in bad {
        assert!(demo.contains(from), "{from}");
        std::fs::write(folder.path().join("bad.yaml"), demo.replacen(from, to, 1)).unwrap();
        for arguments in [&["check", "bad.yaml"][..], &["run", "bad.yaml"], &["signals", "bad.yaml"]] {
            let output = lineshaft(folder.path(), arguments);
            let problems = text(&output.stderr);
            assert_eq!(code(&output), 2, "{to}: {problems}");
            assert!(problems.starts_with("bad.yaml:") && problems.contains(said), "{to}: {problems}");
            assert!(output.stdout.is_empty());
        }
    }
    for arguments in [&["check", "no-such.yaml"][..], &["dance"], &["sim", "bad.yaml"], &["run", "--bogus"], &["check"]]
    {
        let output = lineshaft(folder.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(!output.stderr.is_empty());
    }
    let output = lineshaft(folder.path(), &["run", "--ros-args", "--params-file", "p.yaml"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("--params-file"));
}

/// The robot description is read from the folder of the cell; mismatches are reported, an unreadable file is refused.
#[test]
fn a_robot_description_is_checked_with_its_cell() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let demo = std::fs::read_to_string(root("launch-configs/demo.yaml")).unwrap();
    let described = demo.replacen("# robot_description: demo.urdf", "robot_description: robots/r.urdf", 1);
    assert_ne!(demo, described);
    std::fs::create_dir_all(folder.path().join("in/robots")).unwrap();
    write("in/cell.yaml", &described);

    let check = || lineshaft(folder.path(), &["check", "in/cell.yaml"]);
    let missing = check();
    assert_eq!(code(&missing), 2);
    let problem = text(&missing.stderr);
    assert!(problem.starts_with("in/robots/r.urdf:1:1: robot_description: cannot read the file: "), "{problem}");

    write("in/robots/r.urdf", "<robot name='r'>\n<joint>\n</robot>");
    let malformed = check();
    assert_eq!(code(&malformed), 2);
    assert!(text(&malformed.stderr).starts_with("in/robots/r.urdf:3:"), "{}", text(&malformed.stderr));

    write("in/robots/r.urdf", "<robot name='r'><joint name='hoist' type='continuous'/></robot>");
    let told = check();
    assert_eq!((code(&told), text(&told.stdout).contains("cell.yaml: good:")), (0, true));
    let warning = "warning: robot_description: joint hoist: no axis has that name, so nothing moves it\n";
    assert_eq!(text(&told.stderr), warning);
}

/// 6041h is read-only: a value that cannot be read is only a warning. 6081h would be written: it is an error.
#[test]
fn what_is_wrong_in_an_eds_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let eds = std::fs::read_to_string(root("launch-configs/can/cia402_sim.eds")).unwrap();
    write("drive.eds", &eds.replacen("[6041]\n", "[6041]\nParameterValue=x\n", 1));
    write(
        "cell.yaml",
        "lineshaft: 1\ncycle: 4 ms\n\
         backends: {bus0: {type: can, transport: 'slcan-tcp:127.0.0.1:1', bitrate: 1000000}}\n\
         axes:\n  x: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {backend: bus0, node: 3, eds: drive.eds},\n    \
         max_velocity: 1 m/s, max_acceleration: 1 m/s^2}\n",
    );
    let said = "`drive.eds`: line 1531: [6041] ParameterValue=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); \
                passed over\n";
    let check = lineshaft(folder.path(), &["check", "cell.yaml"]);
    assert_eq!((code(&check), text(&check.stderr)), (0, format!("warning: eds {said}")));
    let scan = ["can", "scan", "--cell", "cell.yaml"];
    let pdo = ["can", "pdo", "3", "--bus", "slcan-tcp:127.0.0.1:1", "--eds", "drive.eds"];
    for (words, key) in [(scan.as_slice(), "eds"), (pdo.as_slice(), "--eds")] {
        let output = lineshaft(folder.path(), words);
        let begin = format!("warning: {key} {said}error: ");
        assert!(code(&output) == 1 && text(&output.stderr).starts_with(&begin), "{}", text(&output.stderr));
    }
    write("drive.eds", &eds.replacen("[6081]\n", "[6081]\nParameterValue=-1\n", 1));
    let sentence =
        "eds `drive.eds`: line 1789: [6081] ParameterValue=-1: -1 is not within 0 and 4294967295, as UNSIGNED32 is";
    for words in [["check", "cell.yaml"].as_slice(), scan.as_slice()] {
        let output = lineshaft(folder.path(), words);
        assert!(code(&output) == 2 && text(&output.stderr).contains(sentence), "{}", text(&output.stderr));
    }
}

#[test]
fn types_of_functions_are_listed_and_explained() {
    let here = root("");
    let functions = |more: &[&str]| lineshaft(&here, &[&["functions"], more].concat());
    let listed = functions(&[]);
    assert_eq!(code(&listed), 0);
    assert!(text(&listed.stdout).contains("cam      switches outputs by cams"), "{}", text(&listed.stdout));
    let explained = functions(&["imes"]);
    assert_eq!(code(&explained), 0);
    assert!(text(&explained.stdout).contains("  window  0 to 1073741823 (inc), left out: 0, live\n"));
    let page = std::fs::read_to_string(root("docs/functions.md")).unwrap();
    let markdown = text(&functions(&["--markdown"]).stdout);
    assert!(markdown.lines().count() > 60 && markdown.lines().all(|line| page.contains(line)), "{markdown}");
    for (name, sentence) in [
        ("imse", "error: no function type `imse`; did you mean `imes`? `lineshaft functions` lists all\n"),
        ("sak", "error: sak needs --cycle and --gain\n"),
    ] {
        let unknown = functions(&[name]);
        assert_eq!((code(&unknown), text(&unknown.stderr).as_str()), (2, sentence));
    }
}

/// Proves: AMK-SAK-O1, AMK-SAK-O2, AMK-SAK-O3
#[test]
fn compensation_factor_is_reported() {
    let sak = |more: &[&str]| lineshaft(&root(""), &[&["functions", "sak"], more].concat());
    let told = |more: &[&str]| text(&sak(more).stdout);
    assert_eq!(told(&["--cycle", "2 ms", "--gain", "1000"]), "4032\n");
    assert_eq!(told(&["--cycle", "1 ms", "--gain", "1000", "--external"]), "7936\n");
    let refused = |more: &[&str], part: &str| {
        let output = sak(more);
        let problems = text(&output.stderr);
        assert!(code(&output) == 2 && problems.contains(part), "{problems}");
    };
    refused(
        &["--cycle", "0.5 ms", "--gain", "400", "--external"],
        "with 400 rpm in a cycle of 0.5 ms the factor exceeds 32767, which no function takes",
    );
    refused(&["--cycle", "2 ms"], "--gain <RPM>");
    refused(&["--cycle", "1 us", "--gain", "1000"], "125 us to 5.1 s is allowed");
    refused(&["--cycle", "1 ms", "--gain", "0"], "0 is not in 1..");
    let other = lineshaft(&root(""), &["functions", "cam", "--cycle", "1 ms", "--gain", "5"]);
    assert_eq!(text(&other.stderr), "error: --cycle and --gain belong to `lineshaft functions sak`\n");
}

#[test]
fn check_counts_functions_warns_of_circles_and_draws_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let functions = "functions:\n  a: {slot: 0, type: dcopy, source: b.sink, sink: none}\n  b: {slot: 1, type: dcopy, source: a.sink, sink: feed}\n";
    let head = "lineshaft: 1\ncycle: 1 ms\naxes: {}\n";
    write("none.yaml", head);
    write(
        "cell.yaml",
        &format!("{head}memory: {{feed: {{type: i32}}}}\ntables: {{t: {{form: y, points: [1]}}}}\n{functions}"),
    );
    let check = |more: &[&str]| lineshaft(folder.path(), &[&["check"], more].concat());
    let output = check(&["cell.yaml", "--graph", "cell.svg"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let expected = "cell.yaml: good: 1 memory cell, 2 functions, 1 table; cycle 1 ms\ncell.svg\n";
    assert_eq!(text(&output.stdout), expected);
    let warning = "warning: function a reads itself: a -> b -> a; a sees b as of the cycle before\n";
    assert_eq!(text(&output.stderr), warning);
    let figure = std::fs::read_to_string(folder.path().join("cell.svg")).unwrap();
    assert!(figure.starts_with("<svg ") && figure.contains(">1 b: dcopy</text>"), "{figure}");
    for (arguments, sentence) in [
        (["cell.yaml", "--graph", "cell.png"], "error: the figure cell.png has to end with .svg\n"),
        (["none.yaml", "--graph", "none.svg"], "error: the cell has no functions that could be drawn\n"),
    ] {
        let output = check(&arguments);
        assert_eq!(code(&output), 2);
        assert!(text(&output.stderr).ends_with(sentence), "{}", text(&output.stderr));
    }
    assert!(!folder.path().join("none.svg").exists() && !folder.path().join("cell.png").exists());
}

/// Proves: AMK-GEN-04, AMK-SNK-02, AMK-CAM-33
#[test]
fn check_holds_a_cell_to_a_preset_and_names_those_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let axes: String = (1..=9)
        .map(|n| format!("  x{n}: {{type: linear, drive: virtual, scale: {{increments: 1, per: 1 mm}}, max_velocity: 1, max_acceleration: 1}}\n"))
        .collect();
    // Four words of each cam follow the first 32.
    let cell = |cams: usize| {
        let words = vec!["0"; 32 + 4 * cams].join(", ");
        format!(
            "lineshaft: 1\ncycle: 1 ms\naxes:\n{axes}functions:\n  a: {{slot: 16, type: dcopy, source: x1, sink: x9}}\n  \
             b: {{slot: 1, type: cam, source: x1, cams: [{cams}], tables: [t]}}\ntables:\n  t: {{form: words, words: [{words}]}}\n"
        )
    };
    std::fs::write(folder.path().join("wide.yaml"), cell(57)).unwrap();
    let narrow = cell(56).replace("slot: 16", "slot: 15").replace("sink: x9", "sink: x8");
    std::fs::write(folder.path().join("narrow.yaml"), narrow).unwrap();
    let check = |arguments: &[&str]| {
        let output = lineshaft(folder.path(), &[&["check"], arguments].concat());
        (code(&output), text(&output.stdout), text(&output.stderr))
    };
    assert_eq!(check(&["wide.yaml"]).0, 0);
    let told = "wide.yaml:14:13: slot is 16; preset amkasyn allows 0..15\n\
                wide.yaml:14:48: sink is `x9`, axis 9 of the cell; preset amkasyn allows axes 1..8\n\
                wide.yaml:15:46: cams[0] is 57; preset amkasyn allows 0..56\n\
                wide.yaml:15:60: tables[0] is `t`, which has 260 words; preset amkasyn allows 1..256\n";
    assert_eq!(check(&["wide.yaml", "--preset", "amkasyn"]), (2, String::new(), told.to_owned()));
    assert_eq!(check(&["--preset", "amkasyn", "narrow.yaml"]).0, 0);
    let (exit, _, said) = check(&["narrow.yaml", "--preset", "amkasin"]);
    assert_eq!(exit, 2);
    assert!(said.contains("'amkasin' for '--preset") && said.contains("[possible values: amkasyn]"), "{said}");
}

#[test]
fn check_refuses_sets_that_can_never_start_and_warns_of_those_that_move_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let check = |function: &str| {
        let cell = format!(
            "lineshaft: 1\ncycle: 1 ms\naxes:\n  x: {{type: rotary, drive: virtual, scale: {{increments: 1000, per: 1 rev}}, \
             max_velocity: 60 rpm, max_acceleration: 360 deg/s^2}}\nfunctions:\n  f: {function}\n"
        );
        std::fs::write(folder.path().join("cell.yaml"), cell).unwrap();
        let output = lineshaft(folder.path(), &["check", "cell.yaml"]);
        (code(&output), text(&output.stderr))
    };
    let told = "cell.yaml:6:6: f: the first table is missing; the function reads its points or cams there; START refuses this set\n";
    assert_eq!(check("{slot: 0, type: cam, source: x}"), (2, told.to_owned()));
    let told = "warning: f: speed is left out, which is 0: the function gives no speed\n";
    assert_eq!(check("{slot: 0, type: digdreh, sink: x}"), (0, told.to_owned()));
    assert_eq!(check("{slot: 0, type: digdreh, sink: x, speed: 100}"), (0, String::new()));
}

#[test]
fn interfaces_are_listed_and_explained() {
    let here = root("");
    let listed = lineshaft(&here, &["interfaces"]);
    assert_eq!(code(&listed), 0);
    assert!(text(&listed.stdout).contains("action  ~/move_axis"), "{}", text(&listed.stdout));
    let explained = lineshaft(&here, &["interfaces", "MoveAxis"]);
    assert!(text(&explained.stdout).starts_with("lineshaft_msgs/action/MoveAxis\n"), "{}", text(&explained.stdout));
    let page = std::fs::read_to_string(root("docs/interfaces.md")).unwrap();
    let markdown = text(&lineshaft(&here, &["interfaces", "--markdown"]).stdout);
    assert!(markdown.lines().count() > 300 && markdown.lines().all(|line| page.lines().any(|known| known == line)));
    let unknown = lineshaft(&here, &["interfaces", "MoveAxes"]);
    assert_eq!((code(&unknown), unknown.stdout.is_empty()), (2, true));
    let sentence = "error: no topic, service, action or type `MoveAxes`; did you mean `MoveAxis`? `lineshaft interfaces` lists all\n";
    assert_eq!(text(&unknown.stderr), sentence);
}

#[test]
fn help_and_version_are_no_errors() {
    let here = root("");
    for (arguments, said) in [
        (&["--help"][..], "Exit codes"),
        (&["--version"], concat!("lineshaft ", env!("CARGO_PKG_VERSION"))),
        (&["run", "--help"], "ROS_DOMAIN_ID"),
        (&["run", "--help"], "--store <FILE|none>"),
        (&["run", "--help"], "`lineshaft state`, enable, disable, move, jog, home"),
        (&["--help"], "Move an axis of a node that runs, without ROS"),
        (&["move", "--help"], "lineshaft move turret '90 deg'"),
        (&["sim", "--help"], "--csv"),
        (&["sim", "--help"], "--store <FILE|none>"),
        (&["check", "--help"], "--scenario"),
        (&["check", "--help"], "--preset"),
    ] {
        let output = lineshaft(&here, arguments);
        assert_eq!(code(&output), 0, "{arguments:?}");
        assert!(text(&output.stdout).contains(said), "{arguments:?}: {}", text(&output.stdout));
    }
}

#[test]
fn signals_lists_every_signal_with_type_and_unit() {
    let output = lineshaft(&root(""), &["signals", "launch-configs/demo.yaml"]);
    let list = text(&output.stdout);
    let line = |name: &str| list.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap().to_owned();
    assert!(line("x.command.position").contains("i64") && line("x.command.position").contains(" inc "));
    assert!(line("x.command.velocity").contains("f64") && line("x.command.velocity").contains("inc/s"));
    assert!(line("x.actual.count").contains("drivable"));
    assert!(line("x.state").contains("1 STANDSTILL"));
    assert!(!line("line.target.position").is_empty() && !line("machine.overruns").is_empty());
}

#[test]
fn file_instead_of_a_command_gives_a_hint() {
    let here = root("");
    let output = lineshaft(&here, &["launch-configs/demo.yaml"]);
    let hint = "hint: `lineshaft run launch-configs/demo.yaml` runs a cell\n";
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).ends_with(hint), "{}", text(&output.stderr));
    let (cell, scenario) = ("launch-configs/demo.yaml", "launch-configs/scenarios/first_move.yaml");
    for (arguments, said) in [
        (
            &["check", scenario][..],
            "this looks like a scenario; a cell is expected, check it with `lineshaft check CELL",
        ),
        (&["sim", scenario, "--scenario", cell], "this looks like a scenario; a cell is expected, "),
        (
            &["check", cell, "--scenario", cell],
            "this looks like a cell; a scenario is expected, check it with `lineshaft",
        ),
    ] {
        let output = lineshaft(&here, arguments);
        let complaint = text(&output.stderr);
        assert_eq!((code(&output), complaint.lines().count()), (2, 1), "{complaint}");
        assert!(complaint.contains(said), "{complaint}");
    }
}

/// The reader of the log may end first, like `tee` on Ctrl-C: the axes are halted anyway.
#[test]
fn closed_log_does_not_end_the_node() {
    use rustix::process::{Pid, Signal, kill_process};
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let (home, domain) = (tempfile::tempdir().unwrap(), Domain::take());
    let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
    command.env("ROS_HOME", home.path());
    command
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_DOMAIN_ID", domain.to_string())
        .stderr(Stdio::piped());
    let mut program = command.spawn().unwrap();
    let mut log = BufReader::new(program.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("ROS 2 node") {
        line.clear();
        assert!(log.read_line(&mut line).unwrap() > 0, "it ended early");
    }
    drop(log);
    let pid = Pid::from_raw(program.id().cast_signed()).unwrap();
    kill_process(pid, Signal::INT).unwrap();
    assert_eq!(program.wait().unwrap().code(), Some(0));
}

/// `lineshaft params`: the catalogue, one parameter, a cell, and export and import of a parameter file.
#[test]
fn params_shows_the_catalogue_and_a_cell_and_checks_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let cell = root("launch-configs/demo.yaml");
    let cell = cell.to_str().unwrap();
    let run = |arguments: &[&str]| lineshaft(folder.path(), &[&["params"], arguments].concat());

    let all = text(&run(&[]).stdout);
    assert!(all.lines().next().unwrap().starts_with("name "), "{all}");
    assert!(
        all.lines().any(|line| line.starts_with("max_velocity "))
            && all.lines().any(|line| line.starts_with("revers "))
    );
    let one = text(&run(&["--name", "VELMAX"]).stdout);
    assert!(one.starts_with("velmax\n") && one.contains("another view of max_velocity"), "{one}");
    let page = text(&run(&["--markdown"]).stdout);
    assert_eq!(page, std::fs::read_to_string(root("docs/parameters.md")).unwrap());

    let changed = text(&run(&[cell, "--changed", "--name", "x.*"]).stdout);
    assert!(changed.contains("x.max_position") && !changed.contains("y.") && !changed.contains("setpoint_timeout"));
    let export = run(&[cell, "--export"]);
    assert_eq!(code(&export), 0);
    std::fs::write(folder.path().join("p.yaml"), &export.stdout).unwrap();
    assert_eq!(text(&run(&[cell, "--import", "p.yaml"]).stdout), "nothing would change\n");
    std::fs::write(folder.path().join("p.yaml"), "x.max_velocity: 0.8 m/s\nx.PROFTIME: 2000\n").unwrap();
    let change = "x.max_velocity: 1200 mm/s -> 800 mm/s\nx.proftime: 1 ms -> 2 ms\n";
    assert_eq!(text(&run(&[cell, "--import", "p.yaml"]).stdout), change);

    std::fs::write(folder.path().join("p.yaml"), "x.max_velocty: 1\nx.error_reaction: 6\n").unwrap();
    let bad = run(&[cell, "--import", "p.yaml"]);
    assert_eq!((code(&bad), text(&bad.stdout).as_str()), (2, ""));
    assert_eq!(
        text(&bad.stderr),
        "p.yaml:1:1: no parameter is called `x.max_velocty`, did you mean `x.max_velocity`?\n\
         p.yaml:2:19: error_reaction is 6; 0 to 5 is allowed\n"
    );
    for (arguments, said) in [
        (&["--name", "velmx"][..], "error: no parameter matches `velmx`, did you mean `velmax`?\n"),
        (&["--name", "["], "error: --name: `[` is no pattern: unclosed character class; missing ']'\n"),
        (&["none.yaml"], "none.yaml:1:1: cannot read the file: No such file or directory (os error 2)\n"),
        (
            &[cell, "--import", "none.yaml"],
            "none.yaml:1:1: cannot read the file: No such file or directory (os error 2)\n",
        ),
    ] {
        let output = run(arguments);
        assert_eq!((code(&output), text(&output.stderr).as_str()), (2, said));
    }
    assert_eq!(code(&run(&["--export"])), 2);
}

/// A named pipe without a writer, a folder or a device instead of a file does not block.
#[test]
fn what_is_no_regular_file_is_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let demo = std::fs::read_to_string(root("launch-configs/demo.yaml")).unwrap();
    std::fs::write(folder.path().join("demo.yaml"), &demo).unwrap();
    let described = demo.replacen("# robot_description: demo.urdf", "robot_description: pipe", 1);
    std::fs::write(folder.path().join("described.yaml"), described).unwrap();
    for (name, what) in [("pipe", "a named pipe"), ("folder", "a folder"), ("/dev/null", "a device")] {
        for arguments in [
            &["check", name][..],
            &["check", "demo.yaml", "--scenario", name],
            &["sim", "demo.yaml", "--scenario", name],
            &["params", "demo.yaml", "--import", name],
            &["run", name],
            &["run", "demo.yaml", "--store", "none", "--ros-args", "--params-file", name],
        ] {
            let output = lineshaft(folder.path(), arguments);
            let said = text(&output.stderr);
            assert_eq!(code(&output), 2, "{arguments:?}: {said}");
            assert!(said.contains(&format!("it is {what}; a regular file is expected")), "{arguments:?}: {said}");
        }
    }
    let output = lineshaft(folder.path(), &["check", "described.yaml"]);
    let said = "pipe:1:1: robot_description: cannot read the file: it is a named pipe; a regular file is expected\n";
    assert_eq!((code(&output), text(&output.stderr).as_str()), (2, said));
}
