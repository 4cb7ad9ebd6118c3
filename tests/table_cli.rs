//! Tests `lineshaft table` on the command line: its output, its messages and its exit codes.

use crate::support::machine::share;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const CELL: &str = "\
lineshaft: 1
cycle: 1 ms
backends:
  plant: {type: sim}
axes:
  knife:
    type: linear
    unit: mm
    scale: {increments: 1000, per: 1 mm}
    drive: {backend: plant, address: 0, interface: position}
    max_velocity: 40 mm/s
    max_acceleration: 400 mm/s^2
    max_deceleration: 200 mm/s^2
    max_jerk: 100 m/s^3
    max_following_error: 20 mm
    sim: {model: ideal}
";

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A folder with the description of the example, used as the working folder.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let from = root("launch-configs/functions/tables/knife.yaml");
        std::fs::copy(from, folder.path().join("knife.yaml")).expect("the example");
        let bench = Self(folder);
        bench.write("cell.yaml", CELL);
        bench
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).expect("written");
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn run(&self, line: &str) -> Output {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.arg("table").args(line.split(' ')).current_dir(&self.0);
        command.output().expect("the program starts")
    }

    /// Runs a command that must succeed; returns its output.
    fn succeed(&self, line: &str) -> String {
        let output = self.run(line);
        let said = text(&output.stderr);
        assert_eq!((output.status.code(), said.as_str()), (Some(0), ""), "{line}");
        text(&output.stdout)
    }

    /// Runs a command that must end with code 2; returns its message.
    fn fail(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(2), "{line}: {}{}", text(&output.stdout), text(&output.stderr));
        text(&output.stderr)
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

/// Returns the values of a CSV file of one column.
fn values(text: &str) -> Vec<i64> {
    text.lines().filter(|line| !line.starts_with('#')).map(|line| line.parse().expect(line)).collect()
}

#[test]
fn table_made_from_a_description_is_valid_in_a_cell() {
    let bench = Bench::new();
    assert_eq!(bench.succeed("make knife.yaml -o knife.csv"), "knife.csv\n");
    let csv = bench.read("knife.csv");
    let head = "# form y, 1001 points, cyclic; period 20000 inc of the master, way 0 inc\n# to 5000: travel 0, dwell\n# to 12000: \
                travel 8000, modified_sine\n# to 20000: travel -8000, polynomial_5\n";
    assert!(csv.starts_with(head), "{csv}");
    let points = values(&csv);
    assert_eq!((points.len(), points[0], points[1000]), (1001, 0, 0));
    // A point every 20 inc: dwell up to 5000, half of the rise at 8500, end of the rise at 12000, half of the fall at
    // 16000.
    assert_eq!([points[250], points[425], points[600], points[800]], [0, 4000, 8000, 4000]);
    // By the law of VDI 2143: 16000 is z = 1/2; at 14000, z = 1/4, f = 10/64 - 15/256 + 6/1024 = 0.103515625.
    assert_eq!(points[700], (8000.0_f64 * (1.0 - 0.103_515_625)).round() as i64);
    bench.write("cell.yaml", &format!("{CELL}tables:\n  cut: {{form: y, csv: knife.csv}}\n"));
    let check =
        Command::new(env!("CARGO_BIN_EXE_lineshaft")).args(["check", "cell.yaml"]).current_dir(&bench.0).output();
    assert!(check.expect("the program starts").status.success());
    let again = bench.read("knife.csv");
    bench.succeed("make knife.yaml -o knife.csv");
    assert_eq!(bench.read("knife.csv"), again, "the same bytes each time");
}

#[test]
fn invalid_files_are_refused_with_line_and_column_and_nothing_is_written() {
    let bench = Bench::new();
    let knife = bench.read("knife.yaml");
    for (from, to, sentence) in [
        ("law: dwell", "law: dwel", "bad.yaml:10:32: law is `dwel`; one of dwell, straight, simple_sine, "),
        ("points:", "pionts:", "bad.yaml:5:1: unknown key `pionts` in the description, did you mean `points`?\n"),
        (
            "master: 20000",
            "master: 21000",
            "bad.yaml:12:10: the last segment ends at 20000; 21000, the period of the master, is needed\n",
        ),
        (
            "travel: 8000",
            "travel: 80000000",
            "bad.yaml:5:9: points is 1001; with so few the steps between them are 32768 inc and more; ",
        ),
    ] {
        bench.write("bad.yaml", &knife.replacen(from, to, 1));
        let said = bench.fail("make bad.yaml -o bad.csv");
        assert!(said.starts_with(sentence), "{said}");
        assert!(!bench.0.path().join("bad.csv").exists());
    }
    for (csv, form, sentence) in [
        ("x,y\n0,0\n", "xy", "bad.csv:1:1: `x` is no whole number of 32 bits; a line of names needs `#` before it\n"),
        ("0,0\n10,NaN\n", "xy", "bad.csv:2:4: `NaN` is not finite; a whole number is expected\n"),
        ("0,0\n10,1\n10,2\n", "xy", "bad.csv:3:1: place 10 is not after 10, the one of line 2; places rise\n"),
        ("0;0\n", "xy", "bad.csv:1:2: `;` stands between columns; a comma is expected\n"),
        (
            "0\n1,5\n",
            "y",
            "bad.csv:2:3: 2 columns stand there; 1 is expected; a decimal sign is a point, and two columns are of form xy\n",
        ),
        ("3,0\n5,0\n", "xy", "error: bad.csv: the curve begins at 3; 0 is needed\n"),
    ] {
        bench.write("bad.csv", csv);
        assert_eq!(bench.fail(&format!("check bad.csv --form {form}")), sentence);
    }
    assert_eq!(bench.fail("make knife.yaml -o knife.txt"), "error: knife.txt ends with neither .csv nor .yaml\n");
    assert!(bench.fail("make none.yaml -o a.csv").starts_with("none.yaml:1:1: cannot read the file: "));
    assert!(bench.fail("check none.csv --master 5").starts_with("error: none.csv: "));
    assert_eq!(
        bench.fail("check knife.yaml --master 5"),
        "error: --master is for a CSV file; a description says it itself\n"
    );
}

#[test]
fn check_shows_peaks_limits_and_fastest_speed() {
    let bench = Bench::new();
    let said = bench.succeed("check knife.yaml");
    let mut lines = said.lines();
    let first = "knife.yaml: 3 segments, 1001 points of form y, cyclic; period 20000 inc of the master, way 0 inc";
    assert_eq!(lines.next(), Some(first));
    // Cv, Ca and Cj of the modified sine by 8000 inc in 7000 inc: 4 pi / (4 + pi), 4 pi^2 / (4 + pi), 16 pi^3 / (4 +
    // pi).
    let pi = std::f64::consts::PI;
    let of = |factor: f64, order: i32| factor / (4.0 + pi) * 8000.0 / 7000.0_f64.powi(order);
    for (name, value, at) in [
        ("velocity", of(4.0 * pi, 1), 8500.0),
        ("acceleration", of(4.0 * pi * pi, 2), 5000.0 + 7000.0 / 8.0),
        ("jerk", of(16.0 * pi.powi(3), 3), 5000.0),
    ] {
        let line = lines.next().expect("a line");
        let (found, place) = line.split_once(" at ").expect("a place");
        let words: Vec<&str> = found.split_whitespace().collect();
        assert_eq!(words[..2], ["largest", name]);
        assert!((words[2].parse::<f64>().expect(line) / value - 1.0).abs() < 1e-5, "{line}: {value}");
        assert_eq!(place.parse::<f64>().expect(line), at);
    }
    assert_eq!(lines.next(), None);

    // The rise is the steepest segment, and its end decelerates as much as its start accelerates: the deceleration has
    // half of the limit, so it is decisive.
    let fastest = (200_000.0 / of(4.0 * pi * pi, 2)).sqrt();
    assert!(40_000.0 / of(4.0 * pi, 1) > fastest && (1e8 / of(16.0 * pi.powi(3), 3)).cbrt() > fastest);
    let slow = bench.succeed("check knife.yaml --cell cell.yaml --axis knife --master-speed 10000");
    for word in ["max_velocity", "max_acceleration", "max_deceleration", "max_jerk"] {
        let line = slow.lines().find(|line| line.trim_start().starts_with(word)).expect(word);
        assert!(line.contains(": ok, "), "{line}");
    }
    let line = slow.lines().find(|line| line.contains("fastest")).expect("a line");
    let wanted = format!("  fastest master speed: {fastest:.1} inc/s, then max_deceleration binds at 11125");
    assert_eq!(line, wanted);
    assert!(slow.contains("  max_velocity      40 mm/s (40000 inc/s): ok, 20.10"), "{slow}");
    let fast = bench.run("check knife.yaml --cell cell.yaml --axis knife --master-speed 18000");
    assert_eq!(fast.status.code(), Some(2));
    assert_eq!(text(&fast.stderr), "error: the table exceeds max_deceleration of axis knife\n");
    assert!(
        text(&fast.stdout).contains("max_deceleration  200 mm/s^2 (200000 inc/s^2): exceeded, 292.4"),
        "{}",
        text(&fast.stdout)
    );
    // Without a speed there is no verdict; the fastest speed is still shown.
    let alone = bench.succeed("check knife.yaml --cell cell.yaml --axis knife");
    assert!(alone.contains(&wanted) && !alone.contains("ok"), "{alone}");
    assert_eq!(
        bench.fail("check knife.yaml --cell cell.yaml --axis knive"),
        "error: cell.yaml: no axis is called `knive`; there are knife\n"
    );
}

/// 2.01098 inc/inc at 20 mm/s of the belt, 20000 inc/s, are 40.22 mm/s of the knife, whose limit is 40.
#[test]
fn speed_of_a_master_has_units_and_without_one_is_max_velocity_of_the_leader() {
    let bench = Bench::new();
    let axes = "  belt:\n    type: linear\n    unit: mm\n    drive: virtual\n    scale: {increments: 1000, per: 1 mm}\n    \
                max_velocity: 20 mm/s\n    max_acceleration: 1 m/s^2\n";
    bench.write("cell.yaml", &format!("{CELL}{axes}"));
    let check = "check knife.yaml --cell cell.yaml --axis knife";
    let at_speed = |line: &[&str]| {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.arg("table").args(check.split(' ')).args(line).current_dir(&bench.0);
        let output = command.output().expect("the program starts");
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (code, said, problems) = at_speed(&["--leader", "belt"]);
    assert_eq!(code, Some(2), "{said}{problems}");
    assert!(
        problems.starts_with("error: the table exceeds max_velocity, max_deceleration of axis knife"),
        "{problems}"
    );
    let head = "axis knife of cell.yaml at a master speed of 20000 inc/s (20 mm/s), max_velocity of belt\n";
    assert!(said.contains(head), "{said}");
    assert!(said.contains("  fastest master speed: 14886.3 inc/s (14.8862"), "{said}");
    let (code, said, problems) = at_speed(&["--leader", "belt", "--master-speed", "10 mm/s"]);
    assert_eq!((code, problems.as_str()), (Some(0), ""), "{said}");
    assert!(said.contains("axis knife of cell.yaml at a master speed of 10000 inc/s (10 mm/s)\n"), "{said}");
    let (code, said, _) = at_speed(&["--master-speed", "10000 inc/s"]);
    assert!(code == Some(0) && said.contains(" at a master speed of 10000 inc/s\n"), "{said}");

    let refused = |line: &[&str]| at_speed(line).2;
    assert_eq!(
        refused(&["--master-speed", "10 mm/s"]),
        "error: --master-speed: `10 mm/s` needs the scale of the master: name it by --leader, or give the speed in inc/s\n"
    );
    assert_eq!(
        refused(&["--leader", "belt", "--master-speed", "10 deg/s"]),
        "error: --master-speed: `10 deg/s` is an angular velocity; a velocity such as `10 mm/s` is expected\n"
    );
    assert_eq!(
        refused(&["--leader", "bolt"]),
        "error: cell.yaml: `bolt` cannot lead; knife, knife.actual, belt, belt.actual, machine.vmaster can\n"
    );
}

#[test]
fn a_table_of_the_cell_that_was_not_made_again_is_reported() {
    let bench = Bench::new();
    bench.succeed("make knife.yaml -o knife.csv");
    bench.write("cell.yaml", &format!("{CELL}tables:\n  cut: {{form: y, csv: knife.csv}}\n"));
    let check = "check knife.yaml --cell cell.yaml --axis knife";
    let said = bench.succeed(check);
    assert!(said.contains("  these are the points of table cut of cell.yaml\n"), "{said}");
    // The description changes, the CSV file does not.
    bench.write("knife.yaml", &bench.read("knife.yaml").replace("8000", "8001"));
    let said = bench.succeed(check);
    let line = "  no table of cell.yaml has these points; `lineshaft table make knife.yaml -o FILE.csv` writes them into its CSV file\n";
    assert!(said.contains(line), "{said}");
}

#[test]
fn jumps_leave_no_speed() {
    let bench = Bench::new();
    let sine = bench.read("knife.yaml").replacen("modified_sine", "simple_sine", 1);
    bench.write("sine.yaml", &sine);
    let output = bench.run("check sine.yaml --cell cell.yaml --axis knife --master-speed 1");
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("  acceleration jumps at 5000 from 0 to 0.000805682\n"), "{said}");
    assert!(said.contains("max_jerk          100000 mm/s^3 (100000000 inc/s^3): exceeded, a jump at 5000\n"), "{said}");
    assert!(said.contains("fastest master speed: none, max_jerk permits no jump, which there is at 5000\n"), "{said}");
}

#[test]
fn check_of_points_uses_and_mentions_differences() {
    let bench = Bench::new();
    // Slopes 1, 0, -1, 0 over 100 inc each: 0.01 inc/inc^2 at each corner.
    bench.write("corners.csv", "0\n100\n100\n0\n0\n");
    let said = bench.succeed("check corners.csv --master 400 --cell cell.yaml --axis knife");
    assert!(said.contains("largest velocity      1 inc/inc                at 0\n"), "{said}");
    assert!(said.contains("largest acceleration  0.01 inc/inc^2           at 0\n"), "{said}");
    assert!(said.contains("acceleration and jerk are divided differences of the points\n"), "{said}");
    assert!(said.contains("whole increments alone may make 0.0002 inc/inc^2 and 4e-6 inc/inc^3\n"), "{said}");
    // 200000 inc/s^2 by 0.01: 4472.1 inc/s; 1e8 inc/s^3 by 2e-4: 7937.
    assert!(said.contains("fastest master speed: 4472.14 inc/s, then max_deceleration binds at "), "{said}");
    bench.write("steep.csv", "0\n40000\n0\n");
    let steep = bench.succeed("check steep.csv --master 400");
    assert!(steep.ends_with("  function interpolators do not take it: point 2 is 32768 inc or more from the one before it; less is needed, by more points\n"), "{steep}");
    let missing = "error: corners.csv: a table of form y has no places; --master with its period (inc) is needed\n";
    assert_eq!(bench.fail("check corners.csv"), missing);
}

/// Twelve points of 1000000 sin x: the derivatives of the spline are within 2 % of 1000000 (2 pi / 12000)^2 and ^3;
/// with straight lines, the slope would step.
#[test]
fn a_spline_is_checked_by_its_own_derivatives() {
    let bench = Bench::new();
    let points: Vec<String> =
        (0..=12).map(|i| format!("{}", (1e6 * (f64::from(i) * std::f64::consts::TAU / 12.0).sin()).round())).collect();
    bench.write("sine.csv", &points.join("\n"));
    for (name, least) in [("cubic", 0.9), ("quintic", 0.99)] {
        let said = bench.succeed(&format!("check sine.csv --master 12000 --interpolation {name}"));
        assert!(said.contains("of the spline through the points, as an axis on that cam follows it"), "{said}");
        let turn = std::f64::consts::TAU / 12_000.0;
        for (word, wanted) in [("velocity", 1e6 * turn), ("acceleration", 1e6 * turn.powi(2))] {
            let line = said.lines().find(|line| line.contains(&format!("largest {word}"))).expect("a line");
            let value: f64 = line.split_whitespace().nth(2).expect("a number").parse().expect("a number");
            assert!((least..2.0 - least).contains(&(value / wanted)), "{name} {word}: {value} {wanted}");
        }
    }
    let said = bench.fail("check sine.csv --master 12000 --interpolation round");
    assert!(said.contains("linear, cubic and quintic are allowed"), "{said}");
    bench.write("two.csv", "0\n5\n");
    let said = bench.fail("check two.csv --master 100 --interpolation cubic");
    assert!(said.contains("two.csv: a cam has 2 points; 3 or more are needed"), "{said}");
}

#[test]
fn tables_are_converted_there_and_back() {
    let bench = Bench::new();
    bench.succeed("make knife.yaml -o knife.csv");
    let points = values(&bench.read("knife.csv"));
    bench.succeed("convert knife.csv snippet.yaml");
    let snippet = bench.read("snippet.yaml");
    assert!(snippet.starts_with("tables:\n  knife:\n    form: y\n    points: [0, 0, "), "{snippet}");
    bench.succeed("convert knife.csv cam.yaml --master 20000");
    assert!(
        bench
            .read("cam.yaml")
            .starts_with("tables:\n  knife:\n    form: y\n    cam: {length: 20000}\n    points: [0, ")
    );
    bench.succeed("convert cam.yaml placed.csv --to xy");
    assert!(bench.read("placed.csv").ends_with("\n20000,0\n"), "a cam knows its period");
    bench.write(
        "once.yaml",
        "tables:\n  rise: {form: xy, cam: {cyclic: false, interpolation: cubic}, points: [[0, 0], [5, 9]]}\n",
    );
    bench.succeed("convert once.yaml even.yaml --to y");
    assert_eq!(
        bench.read("even.yaml"),
        "tables:\n  rise:\n    form: y\n    cam: {length: 5, cyclic: false, interpolation: cubic}\n    points: [0, 9]\n"
    );
    bench.succeed("convert snippet.yaml back.csv");
    assert_eq!(values(&bench.read("back.csv")), points);
    // A snippet is replaced; a cell, and the description of a table, are not.
    bench.succeed("convert knife.csv snippet.yaml");
    bench.write("press.yaml", &format!("{CELL}{snippet}"));
    for file in ["press.yaml", "knife.yaml"] {
        let before = bench.read(file);
        let said = bench.fail(&format!("convert knife.csv {file}"));
        assert!(said.contains(&format!("{file} exists and is more than a table, so it is not replaced")), "{said}");
        assert_eq!(bench.read(file), before);
    }
    // Inside a whole cell.
    bench.write("whole.yaml", &format!("{CELL}{snippet}"));
    bench.succeed("convert whole.yaml cell.csv --name knife");
    assert_eq!(bench.read("cell.csv"), bench.read("back.csv"));
    bench.succeed("convert knife.csv places.csv --to xy --master 20000");
    let places = bench.read("places.csv");
    assert!(places.starts_with("# form xy, 1001 points\n0,0\n20,0\n") && places.ends_with("\n20000,0\n"), "{places}");
    bench.succeed("convert places.csv even.csv --form xy --to y");
    assert_eq!(values(&bench.read("even.csv")), points);
    bench.succeed("convert places.csv places.yaml --form xy --name cut");
    bench.succeed("convert places.yaml again.csv");
    assert_eq!(bench.read("again.csv"), places);

    let parts = "error: knife.csv: 1001 points divide a period of 20001 inc into parts of 20001/1000 inc; places are whole increments\n";
    assert_eq!(bench.fail("convert knife.csv p.csv --to xy --master 20001"), parts);
    bench.write("odd.csv", "0,0\n10,1\n21,2\n");
    let uneven = "error: odd.csv: place 21 of point 3 is 11 inc after the one before it, the first ones 10 inc; form y has equal \
                  distances\n";
    assert_eq!(bench.fail("convert odd.csv p.csv --form xy --to y"), uneven);
    bench.write("two.yaml", "tables:\n  rise: {form: y, points: [0, 1]}\n  fall: {form: y, points: [0, -1]}\n");
    let two = "two.yaml:2:3: tables has 2 entries; --name with one of rise, fall is needed\n";
    assert_eq!(bench.fail("convert two.yaml p.csv"), two);
    let unknown = "two.yaml:2:3: no table is called `ris`; rise, fall are known, did you mean `rise`?\n";
    assert_eq!(bench.fail("convert two.yaml p.csv --name ris"), unknown);
    let name = "error: `Knife 1` is no name; --name with a letter a..z, then a..z, 0..9 and _, at most 32 characters, is needed\n";
    std::fs::copy(bench.0.path().join("even.csv"), bench.0.path().join("Knife 1.csv")).expect("a copy");
    let output = Command::new(env!("CARGO_BIN_EXE_lineshaft"))
        .args(["table", "convert", "Knife 1.csv", "p.yaml"])
        .current_dir(&bench.0)
        .output()
        .expect("the program starts");
    assert_eq!(text(&output.stderr), name);
    let many: String = (0..300_000).map(|n| format!("{}\n", n % 9)).collect();
    bench.write("many.csv", &many);
    let said = bench.fail("convert many.csv p.yaml");
    assert!(said.starts_with("error: 300000 points are more than a cell holds (250000 values"), "{said}");
    assert!(!bench.0.path().join("p.yaml").exists() && !bench.0.path().join("p.csv").exists());
}

#[test]
fn both_kinds_of_file_are_drawn_the_same_each_time() {
    let bench = Bench::new();
    bench.succeed("make knife.yaml -o knife.csv");
    for source in ["knife.yaml", "knife.csv --master 20000"] {
        assert_eq!(bench.succeed(&format!("plot {source} -o a.svg")), "a.svg\n");
        let svg = bench.read("a.svg");
        for text in ["\nposition (inc)\n", "\nvelocity (inc/inc)\n", "\nmaster (inc)\n"] {
            assert!(svg.contains(text), "{source}: no {text}");
        }
        bench.succeed(&format!("plot {source} -o b.svg"));
        assert_eq!(bench.read("b.svg"), svg);
    }
    assert_eq!(bench.fail("plot knife.yaml -o knife.pdf"), "error: knife.pdf ends with neither .svg nor .png\n");
}

/// docs/cams.md shows the output and the drawing of the program.
#[test]
fn page_shows_the_output_of_check() {
    let bench = Bench::new();
    let page = std::fs::read_to_string(root("docs/cams.md")).expect("the page");
    let knife = bench.read("knife.yaml");
    let description = knife.split("\n\n").skip(1).collect::<Vec<_>>().join("\n\n");
    assert!(page.contains(&description), "the description is not that of the example");
    let (_, shown) = page
        .split_once("$ lineshaft table check knife.yaml --cell cell.yaml --axis knife --master-speed 18000\n")
        .expect("the command");
    let (shown, _) = shown.split_once("```").expect("its end");
    let output = bench.run("check knife.yaml --cell cell.yaml --axis knife --master-speed 18000");
    assert_eq!(text(&output.stdout) + &text(&output.stderr), shown);
    bench.succeed("plot knife.yaml -o knife.svg --width 900");
    let figure = std::fs::read_to_string(root("docs/images/table_knife.svg")).expect("the figure of the page");
    assert!(
        bench.read("knife.svg") == figure,
        "lineshaft table plot knife.yaml -o docs/images/table_knife.svg --width 900"
    );
}

#[test]
fn each_command_has_an_example_in_its_help() {
    let bench = Bench::new();
    for command in ["make", "check", "plot", "convert"] {
        let help = bench.succeed(&format!("{command} --help"));
        assert!(help.contains(&format!("lineshaft table {command} ")), "{help}");
    }
}

/// A million points are made, checked, converted and drawn.
#[test]
fn as_many_points_as_a_table_may_have() {
    let bench = Bench::new();
    bench.write("long.yaml", &bench.read("knife.yaml").replacen("points: 1001", "points: 1000000", 1));
    bench.succeed("make long.yaml -o long.csv");
    let points = values(&bench.read("long.csv"));
    assert_eq!((points.len(), points[0], points[999_999]), (1_000_000, 0, 0));
    bench.succeed("plot long.csv --master 20000 -o long.svg");
    assert!(bench.read("long.svg").len() < 1 << 20, "a figure does not grow with its points");
    bench.write("more.csv", &(bench.read("long.csv") + "0\n"));
    let said = bench.fail("check more.csv --master 20000");
    assert_eq!(said, "more.csv:1000005:1: this is point 1000001; 1000000 are possible\n");
}
