//! Tests mistakes of new users; the message must contain the place, the name, the value, and the allowed range or the
//! correct name.
//!
//! Each message was reviewed from the view of a new user. A message may be reworded; the parts in this table must
//! remain.

use crate::support::machine::share;
use std::path::Path;
use std::process::Command;

const CELL: &str = "\
lineshaft: 1
cycle: 1 ms
backends:
  plant: {type: sim}
io:
  start: {type: di, backend: plant, address: 0}
encoders:
  belt: {backend: plant, address: 0, bits: 16, type: linear, scale: {increments: 40, per: 1 mm}}
masters:
  sum: {add: [belt, line]}
tables:
  cut: {form: xy, points: [[0, 0], [5000, 1200], [20000, 20000]]}
axes:
  line:
    type: linear
    unit: mm
    drive: virtual
    scale: {increments: 1000, per: 1 mm}
    max_velocity: 1 m/s
    max_acceleration: 2 m/s^2
  x:
    type: linear
    unit: mm
    scale: {increments: 1000, per: 1 mm}
    drive: {backend: plant, address: 0, interface: position}
    min_position: -50 mm
    max_position: 850 mm
    max_velocity: 1200 mm/s
    max_acceleration: 8 m/s^2
    max_following_error: 10 mm
    error_reaction: 2
    sim: {model: second_order, bandwidth: 60 Hz}
  turret:
    type: rotary
    unit: deg
    scale: {increments: 36000, per: 360 deg}
    drive: {backend: plant, address: 1}
    modulo: 360 deg
    max_velocity: 90 deg/s
    max_acceleration: 360 deg/s^2
groups:
  arm: [x, turret]
functions:
  ratio: {slot: 0, type: varsync, source: belt, source_bits: 16, sink: none, m1: 10000, m2: 12500}
";

const SCENARIO: &str = "\
scenario: out and back
for: 2 s
trace: [x.command.position]
steps:
  - {at: 0, do: {enable: {axes: [x, turret]}}}
  - {name: gear, at: 50 ms, do: {synchronize: {id: gear, axis: turret, master: line, mode: position, numerator: 9, denominator: 125}}}
  - name: out
    when: {signal: x.state, is: STANDSTILL}
    do: {move_axis: {axis: x, position: 100 mm, velocity: 500 mm/s}}
expect:
  - {signal: x.command.position, at: end, is: 100 mm, within: 1 inc}
  - {event: {kind: error}, count: 0}
";

const TABLE: &str = "\
form: y
points: 101
master: 20000
segments:
  - {to: 5000, travel: 0, law: dwell}
  - {to: 12000, travel: 8000, law: modified_sine}
  - {to: 20000, travel: -8000, law: polynomial_5}
";

/// Text in the file, text that a new user writes instead, and parts that the message must contain.
type Typo = (&'static str, &'static str, &'static [&'static str]);

const VELOCITY: &str = "    max_velocity: 1200 mm/s\n";

const IN_CELLS: &[Typo] = &[
    // Keys.
    (VELOCITY, "    max_velocty: 1200 mm/s\n", &["cell.yaml:28:5: ", "`max_velocty`", "axis `x`", "`max_velocity`?"]),
    (VELOCITY, "", &["cell.yaml:22:5: ", "missing key `max_velocity`", "axis `x`"]),
    (
        VELOCITY,
        "    max_velocity: 1200 mm/s\n    max_velocity: 2 m/s\n",
        &["cell.yaml:29:5: ", "duplicate key `max_velocity`", "28:5"],
    ),
    ("axes:\n", "axis:\n", &["cell.yaml:13:1: ", "`axis`", "`axes`?"]),
    ("{backend: plant, address: 1}", "{backend: plant}", &["cell.yaml:37:12: ", "`address`", "axis `turret`"]),
    // Syntax.
    (VELOCITY, "    max_velocity 1200 mm/s\n", &["cell.yaml:28:5: ", "a colon", "`max_velocity: 1200 mm/s`"]),
    (VELOCITY, "    max_velocity:1200 mm/s\n", &["cell.yaml:28:5: ", "a blank", "`max_velocity: 1200 mm/s`"]),
    (VELOCITY, "     max_velocity: 1200 mm/s\n", &["cell.yaml:28:18: ", "another column", "same column"]),
    (VELOCITY, "\tmax_velocity: 1200 mm/s\n", &["cell.yaml:28:2: ", "a tab", "blanks"]),
    ("36000, per", "36000 per", &["cell.yaml:36:34: ", "a comma"]),
    ("per: 360 deg}", "per: 360 deg", &["cell.yaml:36:12: ", "`}` is missing for `{` at 36:12"]),
    (VELOCITY, "    max_velocity = 1200 mm/s\n", &["cell.yaml:28:5: ", "a colon", "`max_velocity: 1200 mm/s`"]),
    // Numbers and units.
    (
        VELOCITY,
        "    max_velocity: 1200 mm\n",
        &["cell.yaml:28:19: ", "max_velocity", "`1200 mm` is a length", "`1200 mm/s`"],
    ),
    (VELOCITY, "    max_velocity: 1200mm/s\n", &["cell.yaml:28:19: ", "max_velocity", "no blank", "`1200 mm/s`"]),
    (
        VELOCITY,
        "    max_velocity: 1200\u{a0}mm/s\n",
        &["cell.yaml:28:19: ", "max_velocity", "a no-break space (U+00A0)", "`1200 mm/s` with an ordinary space"],
    ),
    (VELOCITY, "    max_velocity: 1200 deg/s\n", &["cell.yaml:28:19: ", "an angular velocity", "`1200 mm/s`"]),
    (VELOCITY, "    max_velocity: fast\n", &["cell.yaml:28:19: ", "`fast` is not a number", "`1 mm/s`"]),
    (VELOCITY, "    max_velocity: 1,2 m/s\n", &["cell.yaml:28:19: ", "`1,2`", "decimal point"]),
    (
        VELOCITY,
        "    max_velocity: -1200 mm/s\n",
        &["cell.yaml:28:19: ", "`-1200 mm/s`", "more than 0 up to 2147483648 mm/s"],
    ),
    (VELOCITY, "    max_velocity:\n", &["cell.yaml:28:17: ", "max_velocity has no value", "a velocity"]),
    ("cycle: 1 ms", "cycle: 1", &["cell.yaml:2:8: ", "cycle is `1`", "125 us..20 ms", "is in s"]),
    ("cycle: 1 ms", "cycle: 50 ms", &["cell.yaml:2:8: ", "cycle is `50 ms`", "125 us..20 ms"]),
    ("cycle: 1 ms", "cycle: 1 msec", &["cell.yaml:2:8: ", "`msec`", "`ms`?"]),
    ("per: 360 deg", "per: 1 turn", &["cell.yaml:36:37: ", "`turn`", "`rev`?"]),
    ("per: 360 deg", "per: 360", &["cell.yaml:38:13: ", "modulo is `360 deg`", "`per: 360 deg`"]),
    ("unit: deg", "unit: grad", &["cell.yaml:35:11: ", "`grad`", "deg, rad, rev, inc", "`deg`?"]),
    ("address: 1}", "address: one}", &["cell.yaml:37:38: ", "address is `one`", "0..65535"]),
    (
        "min_position: -50 mm",
        "min_position: 900 mm",
        &["cell.yaml:26:19: ", "min_position 900 mm", "max_position 850 mm"],
    ),
    // Choices.
    ("error_reaction: 2", "error_reaction: 9", &["cell.yaml:31:21: ", "error_reaction is `9`", "0 to 5"]),
    ("error_reaction: 2", "error_reaction: \"2\"", &["cell.yaml:31:21: ", "error_reaction", "without quotes"]),
    (
        "type: linear\n    unit: mm\n    scale",
        "type: lineal\n    unit: mm\n    scale",
        &["cell.yaml:22:11: ", "`lineal`", "`linear`?"],
    ),
    (
        "interface: position",
        "interface: cyclic_position",
        &["cell.yaml:25:52: ", "`cyclic_position`", "open_loop", "`position`?"],
    ),
    ("type: sim}", "type: simulation}", &["cell.yaml:4:17: ", "`simulation`", "sim, can", "`sim`?"]),
    ("type: varsync", "type: varsinc", &["cell.yaml:44:26: ", "`varsinc`", "`varsync`?"]),
    // Names of other objects.
    ("plant, address: 1}", "plan, address: 1}", &["cell.yaml:37:22: ", "`plan`", "`plant`?"]),
    ("plant, address: 1}", "plant, address: 0}", &["cell.yaml:37:38: ", "address 0", "`plant`", "25:38"]),
    ("source: belt", "source: bell", &["cell.yaml:44:43: ", "`bell`", "`belt`?"]),
    ("[belt, line]", "[belt, lin]", &["cell.yaml:10:21: ", "`lin`", "`line`?"]),
    ("[x, turret]", "[x, turet]", &["cell.yaml:42:12: ", "`turet`", "`turret`?"]),
    ("sum: {add: [belt, line]}", "a: {add: [b]}\n  b: {add: [a]}", &["cell.yaml:11:13: ", "loop", "b -> a -> b"]),
    (
        "points: [[0, 0], [5000, 1200], [20000, 20000]]",
        "csv: cut.csv",
        &["cell.yaml:12:24: ", "`cut.csv`", "No such file"],
    ),
];

const IN_SCENARIOS: &[Typo] = &[
    ("for: 2 s", "fro: 2 s", &["s.yaml:2:1: ", "`fro`", "`for`?"]),
    ("for: 2 s", "for 2 s", &["s.yaml:2:1: ", "a colon", "`for: 2 s`"]),
    ("for: 2 s", "for: 2 mm", &["s.yaml:2:6: ", "`2 mm` is a length", "`2 s`"]),
    ("[x.command.position]", "[x.comand.position]", &["s.yaml:3:9: ", "`x.comand.position`", "`x.command.position`?"]),
    ("axes: [x, turret]", "axes: [x, turet]", &["s.yaml:5:33: ", "`turet`", "line, x, turret"]),
    ("axes: [x, turret]", "axis: [x, turret]", &["s.yaml:5:27: ", "`axis`", "`axes`?"]),
    ("enable:", "enabel:", &["s.yaml:5:18: ", "`enabel`", "`enable`?"]),
    ("move_axis:", "MC_MoveAbsolute:", &["s.yaml:9:10: ", "`MC_MoveAbsolute`", "`move_axis`?"]),
    ("{at: 0, do", "{at 0, do", &["s.yaml:5:6: ", "`at 0`", "`at: 0`"]),
    ("at: 50 ms", "at: 3 s", &["s.yaml:6:22: ", "3 s", "1.999 s"]),
    ("at: 50 ms", "at: 50ms", &["s.yaml:6:22: ", "`50ms`", "`50 ms`"]),
    (", denominator: 125", "", &["s.yaml:6:47: ", "missing key `denominator`"]),
    ("master: line", "master: lin", &["s.yaml:6:47: ", "`lin`", "line, line.actual"]),
    ("mode: position,", "mode: positon,", &["s.yaml:6:92: ", "`positon`", "`position`?"]),
    ("position: 100 mm", "position: 100 deg", &["s.yaml:9:21: ", "position", "`100 deg` is an angle", "`100 mm`"]),
    ("velocity: 500 mm/s", "velocity: 500 mm", &["s.yaml:9:21: ", "velocity", "`500 mm` is a length", "`500 mm/s`"]),
    ("is: STANDSTILL", "is: STANDSTIL", &["s.yaml:8:33: ", "x.state is `STANDSTIL`", "`STANDSTILL`?"]),
    ("is: 100 mm", "is: 0.5", &["s.yaml:11:47: ", "0.5", "is in increments", "`0.5 m` is `500 mm`"]),
    (", position: 100 mm", "", &["s.yaml:9:21: ", "missing key `position`"]),
    ("turret]}}}", "turret]}}, refused: 10007}", &["s.yaml:5:57: ", "refused is 10007", "`refused: {code: 10007}`"]),
    ("turret]}}}", "turret]}}, refused: yes}", &["s.yaml:5:57: ", "refused is yes", "`refused: any`"]),
    ("[x.command.position]", "[*.command.*]", &["s.yaml:3:9: ", "an alias", "put quotes", "begins with `*`"]),
    ("axes: [x, turret]", "axes: [x, turret", &["s.yaml:5:33: ", "`]` is missing for `[` at 5:33"]),
    ("scenario: out", "scenario: \"out", &["s.yaml:1:11: ", "the closing quotation mark"]),
    ("kind: error", "kind: errors", &["s.yaml:12:20: ", "`errors`", "`error`?"]),
    ("count: 0", "count: none", &["s.yaml:12:35: ", "count is `none`", "a whole number"]),
    ("  - {signal: x.c", " - {signal: x.c", &["s.yaml:12:3: ", "the indentation", "same column"]),
];

const IN_TABLES: &[Typo] = &[
    ("points: 101", "points: 1", &["t.yaml:2:9: ", "points is 1", "2..1000000"]),
    ("master: 20000", "master: 20000 inc", &["t.yaml:3:9: ", "`20000 inc`", "a unit is not allowed"]),
    ("master: 20000", "master: 10000", &["t.yaml:7:10: ", "20000", "10000"]),
    ("law: dwell", "law: dwel", &["t.yaml:5:32: ", "`dwel`", "`dwell`?"]),
    ("to: 12000", "to: 4000", &["t.yaml:6:10: ", "to is 4000", "5000"]),
    ("segments:", "segment:", &["t.yaml:4:1: ", "`segment`", "`segments`?"]),
];

/// Arguments, and parts that the message must contain.
const ON_THE_COMMAND_LINE: &[(&[&str], &[&str])] = &[
    (&["chekc", "cell.yaml"], &["'chekc'", "'check'"]),
    (&["check"], &["required", "<CELL>"]),
    (&["check", "cell.yml"], &["cell.yml", "No such file"]),
    (&["check", "cell.yaml", "--scenaro", "s.yaml"], &["'--scenaro'", "'--scenario'"]),
    (&["check", "cell.yaml", "--scenario"], &["a value is required", "--scenario <FILE>"]),
    (&["run", "cell.yaml", "--sims"], &["'--sims'", "'--sim'"]),
    (&["sim", "cell.yaml"], &["cell.yaml is no scenario", "--scenario"]),
    (&["sim", "s.yaml"], &["s.yaml:1:1: ", "no cell", "`cell: FILE`"]),
    (&["sim", "cell.yaml", "s.yaml"], &["'s.yaml'", "`lineshaft sim cell.yaml --scenario s.yaml`"]),
    (&["check", "cell.yaml", "s.yaml"], &["'s.yaml'", "`lineshaft check cell.yaml --scenario s.yaml`"]),
    (&["run", "cell.yaml", "-r", "__node:=b"], &["'-r'", "`lineshaft run cell.yaml --ros-args -r __node:=b`"]),
    (&["new"], &["the file is missing", "`lineshaft new machine.yaml`", "--list"]),
    (&["new", "geer", "a.yaml"], &["`geer`", "`gear`?"]),
    (&["new", "a.yaml", "gear"], &["`lineshaft new gear a.yaml`"]),
    (&["enable"], &["required", "<AXIS>", "`lineshaft enable --all`"]),
    (&["home"], &["required", "<AXIS>", "`lineshaft home --all`"]),
    (&["move", "x"], &["required", "<POSITION>"]),
    (&["move", "x", "10mm"], &["POSITION", "`10mm`", "`10 mm`"]),
    (&["move", "x", "10 mm", "--speed", "5 mm/s"], &["'--speed'", "`--velocity`?"]),
    (&["move", "x", "ten"], &["POSITION", "`ten` is not a number", "`1 mm`", "`1 deg`"]),
    (&["jog", "x", "5 mm/s", "--for", "2s"], &["--for", "`2s`", "`2 s`"]),
    (&["tune", "cell.yaml", "z"], &["`z`", "line, x, turret"]),
    (&["tune", "cell.yaml", "x", "--velocity", "5mm/s"], &["--velocity", "`5mm/s`", "`5 mm/s`"]),
    (&["table", "check", "t.yaml", "--master-speed", "5 mm/s"], &["--master-speed", "`5 mm/s`", "--leader", "inc/s"]),
    (&["table", "check", "cell.yaml"], &["cell.yaml:1:1: ", "no description of a table", "`segments`"]),
    (&["explain", "max_velocty"], &["`max_velocty`", "`max_velocity`"]),
    (&["explain", "MC_MoveAbsolut"], &["`MC_MoveAbsolut`", "`MC_MoveAbsolute`"]),
    (&["can", "scan", "--bus", "can0"], &["'can0'", "socketcan:can0"]),
];

/// A folder with valid files; a mistake can be made in one of them.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        for (name, text) in [("cell.yaml", CELL), ("s.yaml", SCENARIO), ("t.yaml", TABLE)] {
            folder.write(name, text);
        }
        folder
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).expect("room");
    }

    /// Returns exit code and standard error.
    fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(arguments).current_dir(self.path()).env("ROS_HOME", self.path());
        let output = command.output().expect("the program starts");
        (output.status.code(), String::from_utf8(output.stderr).expect("text"))
    }

    /// Makes each mistake in the file, and undoes it.
    fn make(&self, file: &str, good: &str, arguments: &[&str], typos: &[Typo]) {
        assert_eq!(self.run(arguments), (Some(0), String::new()), "{file} is good");
        for (from, to, parts) in typos {
            assert!(good.contains(from), "{from:?} is not in {file}");
            self.write(file, &good.replacen(from, to, 1));
            let (code, said) = self.run(arguments);
            assert_eq!(code, Some(2), "{to:?}: {said}");
            // One line for the mistake; a missing name may have consequences.
            assert!(said.lines().count() <= 4, "{to:?}: {said}");
            assert_has(to, &said, parts);
        }
        self.write(file, good);
    }
}

#[track_caller]
fn assert_has(what: &str, said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "{what:?}: {part:?} is missing in: {said}");
    }
}

#[test]
fn mistakes_in_cells_have_a_place_a_name_and_what_is_allowed() {
    assert!(IN_CELLS.len() >= 30);
    Folder::new().make("cell.yaml", CELL, &["check", "cell.yaml"], IN_CELLS);
}

#[test]
fn mistakes_in_scenarios_have_a_place_a_name_and_what_is_allowed() {
    assert!(IN_SCENARIOS.len() >= 15);
    Folder::new().make("s.yaml", SCENARIO, &["check", "cell.yaml", "--scenario", "s.yaml"], IN_SCENARIOS);
}

#[test]
fn mistakes_in_tables_have_a_place_a_name_and_what_is_allowed() {
    assert!(IN_TABLES.len() >= 5);
    Folder::new().make("t.yaml", TABLE, &["table", "make", "t.yaml", "-o", "t.csv"], IN_TABLES);
}

#[test]
fn mistakes_on_the_command_line_name_what_was_meant() {
    assert!(ON_THE_COMMAND_LINE.len() >= 10);
    let folder = Folder::new();
    for (arguments, parts) in ON_THE_COMMAND_LINE {
        let (code, said) = folder.run(arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert_has(&arguments.join(" "), &said, parts);
    }
}

/// Errors that only a run detects: it ends with 1, and names the step.
#[test]
fn an_axis_that_follows_itself_is_refused_in_its_step() {
    let folder = Folder::new();
    let both = "{synchronize: {axis: x, master: turret, mode: position, numerator: 1, denominator: 1}}";
    let loop_of_two = SCENARIO
        .replacen("  - {name: gear", &format!("  - {{at: 40 ms, do: {both}}}\n  - {{name: gear"), 1)
        .replacen("master: line", "master: x", 1);
    for (text, place) in
        [(SCENARIO.replacen("master: line", "master: turret", 1), "s.yaml:6:34: "), (loop_of_two, "s.yaml:7:34: ")]
    {
        folder.write("s.yaml", &text);
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command
            .args(["sim", "cell.yaml", "--scenario", "s.yaml"])
            .current_dir(folder.path())
            .env("ROS_HOME", folder.path());
        let output = command.output().expect("the program starts");
        let said = String::from_utf8(output.stdout).expect("text");
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert_has("a loop", &said, &[place, "turret", "would follow itself"]);
    }
}
