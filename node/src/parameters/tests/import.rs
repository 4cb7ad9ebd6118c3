//! Tests files of parameters: their values, errors and effects.

use super::rig::Rig;
use crate::cell::Cell;
use crate::document::Document;
use crate::parameters::{Filter, Import, check_import, differences, export_text, read_changes, values};
use lineshaft_core::config::IoKind;
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::{AxisParameters, MachineParameters, ParameterImage, Row, Value};
use lineshaft_ros::surface::host::ParameterSelection;

fn read(text: &str) -> Result<AxisParameters, String> {
    check(text).map(|import| import.parameters[1])
}

fn check(text: &str) -> Result<Import, String> {
    let rig = Rig::new();
    let machine = rig.machine();
    let import = check_import(Document::parse("p", text), rig.config(), machine.directory());
    // The reader for a running machine gives the same result, except for contradictions to the values in force.
    let changes = read_changes("p", text, rig.config(), machine.directory());
    if let Ok(import) = &import {
        assert_eq!(changes.expect("good"), import.changes);
    }
    import.map_err(|problems| problems.to_string())
}

fn refused(text: &str) -> String {
    read(text).expect_err("it is refused")
}

/// a value that some firmware has in us is converted to ms in a file, but nowhere else.
///
/// Proves: MACS-PROF-05
#[test]
fn proftime_may_be_in_microseconds_in_a_file() {
    let (_, row) = Row::find("proftime").unwrap();
    for (text, ms) in [("1", 1), ("5", 5), ("1000", 1), ("2000", 2), ("5000", 5)] {
        assert_eq!(row.value(&read(&format!("x.proftime: {text}")).unwrap()), Value::Int(ms), "{text}");
    }
    assert_eq!(
        refused("x.proftime: 1500"),
        "p:1:13: proftime is `1500`; 1 to 5 (ms), or 1000, 2000 .. 5000 (us), is allowed\n"
    );
    for text in ["0", "6", "999", "5001"] {
        assert_eq!(refused(&format!("x.proftime: {text}")), format!("p:1:13: proftime is {text}; 1 to 5 is allowed\n"));
    }
}

/// A controller reports 255 once it has been homed; it has the effect of 1, and is shown as in the file.
///
/// Proves: MACS-HOME-09
#[test]
fn compulsory_and_done_is_compulsory_in_a_file() {
    for (force, required) in [(0, false), (1, true), (255, true)] {
        let read = read(&format!("x.HOME_FORCE: {force}")).unwrap();
        assert_eq!((read.homing.required, read.home_force()), (required, force));
    }
    assert_eq!(refused("x.HOME_FORCE: 2"), "p:1:15: home_force is 2; 0 to 1, 255 is allowed\n");
}

/// the spellings of the manual.
#[test]
fn names_may_be_written_as_macs_writes_and_misprints_them() {
    let p = read("x.SYNCFAC_T_M: 3\nx.SYNCFACTS: 2\nx.Maxvel: 60 \nx.POSERRTIM: 5\n").unwrap();
    assert_eq!((p.sync_master, p.sync_slave, p.following_error_time), (3, 2, 5_000_000));
    // 500 lines, 4 edges, one revolution per second.
    assert_eq!(p.max_velocity, 2000.0);
    assert_eq!(refused("x.syncfactm: 3\nx.SYNCFAC_T_M: 3\n"), "p:2:1: syncfactm is at 1:14 already, write it once\n");
}

#[test]
fn all_errors_are_reported_at_once_with_their_places() {
    let text = "x.max_velocty: 1 m/s\nq.kprop: 30\nx.encoderclock: 0\nline.encoderclock: 1\n\nx.error_reaction: 6\nx.profile: round\n\
                x.in_position_window: 5 s\nx.velmaxqc: 5\nx.posfact_z: 5\nkprop: 30\nx.max_jerk: -1\nmachine.cannr: 128\n";
    assert_eq!(
        refused(text),
        "p:1:1: no parameter is called `x.max_velocty`, did you mean `x.max_velocity`?\n\
         p:2:1: no axis is called `q`; there are line, x, v, o, p, t, u, g\n\
         p:3:17: encoderclock is 0: a serial interface whose clock could be left to another one does not exist yet; only 1 is allowed\n\
         p:4:1: line.encoderclock is not there; it is for axes with a drive\n\
         p:6:19: error_reaction is 6; 0 to 5 is allowed\n\
         p:7:12: x.profile is `round`; one of trapezoid, s_ramp, jerk is expected\n\
         p:8:23: x.in_position_window: `5 s` is a time; a length such as `5 mm` is expected\n\
         p:9:13: velmaxqc is computed from other parameters\n\
         p:10:14: posfact_z is part of the cell; it changes with the file and a new start\n\
         p:11:1: no parameter is called `kprop`; parameters are written axis.key\n\
         p:12:13: max_jerk is -1000 mm/s^3; more than 0 up to 1000000000000 mm/s^3 is allowed\n\
         p:13:16: cannr is 128; 0 to 127, 9999 is allowed\n"
    );
    assert_eq!(refused(""), "p:1:1: no parameter stands there; lines `axis.key: value` are expected\n");
    assert!(refused("[1]").contains("a mapping is expected"));
    assert!(refused("p.kprop: 30\np.kprop: 30\n").contains("p:2:1: "));
}

#[test]
fn one_value_by_two_names_is_refused() {
    assert_eq!(
        refused("x.velmax: 60\nx.max_velocity: 2 mm/s\nline.max_velocity: 5 mm/s\n"),
        "p:1:11: velmax is another view of max_velocity, which is at 2:17, write one of them\n"
    );
    // The MACS name of a limit that is off has its position; an export has both.
    let p = read("x.min_position: ~\nx.neglimit: -500\n").unwrap();
    assert_eq!((p.min_position, p.macs.neglimit), (None, -500));
    assert!(refused("x.min_position: -5 mm\nx.neglimit: -500\n").contains("p:2:13: neglimit is another view"));
    assert!(refused("x.min_position: ~\nx.swneglimact: 1\n").contains("p:2:16: swneglimact is another view"));
    // Position and switch of a limit are separate values.
    assert_eq!(read("x.swneglimact: 1\nx.neglimit: -500\n").unwrap().min_position, Some(-500));
    assert_eq!(read("x.neglimit: -500\nx.swneglimact: 1\n").unwrap().min_position, Some(-500));
}

#[test]
fn what_contradicts_the_cell_or_the_file_names_what_was_written() {
    for (text, expected) in [
        ("x.default_velocity: 101 mm/s", "1:21: default_velocity 101 mm/s exceeds max_velocity 100 mm/s"),
        ("x.dfltvel: 150", "1:12: dfltvel 150 exceeds velres 100"),
        (
            "x.velmax: 60\nx.default_velocity: 3 mm/s",
            "2:21: default_velocity 3 mm/s exceeds max_velocity 2 mm/s (velmax)",
        ),
        (
            "x.min_position: 5 mm\nx.max_position: 5 mm",
            "1:17: min_position 5 mm equals max_position 5 mm; below is allowed",
        ),
        ("o.wf.md43: 5", "1:12: wf.md43 5 exceeds wf.md42 0"),
        ("x.max_velocity: 3 km/s", "1:17: x.max_velocity: `3 km/s` has no unit that is known"),
        (
            "x.max_velocity: 3000000 m/s",
            "1:17: max_velocity is `3000000 m/s`; more than 0 up to 2147483648 mm/s is allowed",
        ),
        (
            "x.encoder: 1073741823\nx.velmax: 65535",
            "2:11: velmax `65535` makes max_velocity 4691178020 mm/s; up to 2147483648 mm/s is allowed",
        ),
    ] {
        let said = refused(text);
        let place = expected.split_once(": ").unwrap().0;
        assert!(said.starts_with(&format!("p:{place}: ")), "{said}, not {expected}");
        if !expected.contains("that is known") {
            assert_eq!(said, format!("p:{expected}\n"));
        }
    }
    // Both together are consistent again, in either order.
    for text in
        ["x.max_velocity: 1 m/s\nx.dfltvel: 100", "x.dfltvel: 150\nx.velres: 200", "x.velres: 200\nx.dfltvel: 150"]
    {
        read(text).unwrap_or_else(|said| panic!("{said}"));
    }
}

/// An export is exact and can be imported; the import changes nothing.
#[test]
fn an_export_is_imported_and_changes_nothing() {
    for cell in [Cell::demo(), Rig::new().cell] {
        let machine = lineshaft_core::machine::Machine::new(cell.machine.clone()).unwrap();
        let axes = AxisSet::first(cell.machine.axes.len());
        for what in [ParameterSelection::All, ParameterSelection::NotDefault] {
            let text = export_text(&cell.machine, &machine.parameter_image(), axes, what);
            let import = check_import(Document::parse("p", text), &cell.machine, machine.directory());
            let import = import.unwrap_or_else(|problems| panic!("{problems}"));
            assert_eq!(differences(&cell.machine, &import), "");
            let before: Vec<_> = cell.machine.axes.iter().map(|axis| axis.parameters).collect();
            assert_eq!(import.parameters, before);
        }
    }
}

#[test]
fn changes_of_a_file_are_listed_by_name_in_the_axis_unit() {
    let rig = Rig::new();
    let import = check("x.velmax: 1500\nx.poslimit: 5000\nx.max_following_error: 1 mm\nline.profile: jerk").unwrap();
    assert_eq!(
        differences(rig.config(), &import),
        "line.profile: trapezoid -> jerk\n\
         x.max_velocity: 100 mm/s -> 50 mm/s\n\
         x.velmax: 3000 rpm -> 1500 rpm\n\
         x.poslimit: 500000 inc -> 5000 inc\n"
    );
}

/// In inverted units POSLIMIT stores the position of the lower native limit if that is off.
#[test]
fn an_export_of_inverted_units_is_read_back() {
    for limit in ["min_position: -5 mm", "max_position: 100 mm", "neglimit: -7, swneglimact: 1", "poslimit: 9"] {
        for posdrct in [1, -1] {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\naxes:\n  x: {{type: linear, unit: mm, scale: \
                 {{increments: 1000, per: 1 mm}}, drive: {{backend: plant, address: 0}}, max_velocity: 1 m/s, \
                 max_acceleration: 1 m/s^2, sim: {{model: ideal}}, posdrct: {posdrct}, {limit}}}\n"
            );
            let config = Cell::parse("cell.yaml", &*text).unwrap_or_else(|problems| panic!("{problems}")).machine;
            let machine = lineshaft_core::machine::Machine::new(config.clone()).unwrap();
            let exported = export_text(&config, &machine.parameter_image(), AxisSet::first(1), ParameterSelection::All);
            let import = check_import(Document::parse("p", &*exported), &config, machine.directory());
            let import = import.unwrap_or_else(|problems| panic!("{limit}, {posdrct}: {problems}"));
            assert_eq!(import.parameters, [config.axes[0].parameters], "{limit}, {posdrct}");
            assert!(read_changes("p", &exported, &config, machine.directory()).is_ok());
        }
    }
}

/// In inverted units POSLIMIT and the lower native limit are one value.
#[test]
fn two_names_of_one_limit_in_inverted_units_are_refused() {
    let rig = Rig::new();
    let machine = rig.machine();
    let import = |text: &str| check_import(Document::parse("p", text), rig.config(), machine.directory());
    let refused = import("x.posdrct: -1\nx.min_position: -3 mm\nx.swposlimact: 1\nx.poslimit: 5\n").unwrap_err();
    assert!(
        refused.to_string().starts_with(
            "p:2:17: min_position stands beside another key of the same limit: posdrct is below 0, write one of them\n"
        ),
        "{refused}"
    );
    assert!(
        import("x.posdrct: -1\nx.max_position: 3 mm\nx.swposlimact: 1\nx.poslimit: 5\n").is_err(),
        "the rule of names"
    );
    assert!(import("x.min_position: -3 mm\nx.swposlimact: 1\nx.poslimit: 5\n").is_ok());
}

/// The parameters of the machine are handled like those of the axes: shown, changed, and checked with the inputs of the
/// cell.
#[test]
fn the_machine_is_shown_and_changed_as_an_axis_is() {
    let cell = include_str!("../../../../launch-configs/io.yaml");
    let cell = Cell::parse("io.yaml", cell).expect("a good cell");
    let machine = Machine::new(cell.machine.clone()).expect("a machine");
    let import = |text: &str| check_import(Document::parse("p", text), &cell.machine, machine.directory());
    let shown = |pattern: &str| {
        let filter = Filter::new(Some(pattern), None).expect("a good pattern");
        let text = values(&cell.machine, &machine.parameter_image().effective, &filter, false);
        text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>()
    };
    assert_eq!(shown("machine.ainftime"), ["machine.ainftime * 10 samples default 0"]);
    assert_eq!(shown("machine.i_*").len(), 3);
    let good = import("machine.AINFTIME: 5\nmachine.o_error: 0\n").expect("good");
    assert_eq!(
        differences(&cell.machine, &good),
        "machine.o_error: 1 -> 0\nmachine.ainftime: 10 samples -> 5 samples\n"
    );
    let same = import("machine.ainftime: 10\n").expect("good");
    assert_eq!(differences(&cell.machine, &same), "");
    let io = &cell.machine.io;
    let outputs = io.iter().filter(|entry| entry.kind == IoKind::DigitalOutput).count();
    let refused = import("machine.o_error: 8\n").unwrap_err().to_string();
    assert!(refused.starts_with(&format!("p:1:18: o_error is 8; the cell has {outputs} digital outputs")), "{refused}");
    let refused = import("machine.vmenctyp: 9900\n").unwrap_err().to_string();
    assert!(refused.starts_with("p:1:19: vmenctyp 9900 is not allowed; 100 n is"), "{refused}");
    // A file starts no motion: 0 does not start one, and any other value is refused.
    let rests = "machine.vmenctyp: 100\nmachine.pulsacc: 5\nmachine.pulsvel: 0\nmachine.setsys_15: 0\n";
    assert_eq!(import(rests).expect("good").changes.len(), 2);
    for (line, place) in
        [("machine.pulsvel: 7", "1:18: pulsvel is 7"), ("machine.setsys_15: -7", "1:20: setsys_15 is -7")]
    {
        let refused = import(&format!("{line}\nmachine.pulsacc: 5\n")).unwrap_err().to_string();
        let expected = format!("p:{place}; 0 is allowed in a text of parameters, as reading one starts no motion");
        assert!(refused.starts_with(&expected), "{refused}");
    }
    let moving = MachineParameters { pulsvel: 7, pulsacc: 5, setsys_15: 9, ..MachineParameters::default() };
    let image = ParameterImage { machine: [moving; 2], ..machine.parameter_image() };
    let all = AxisSet::first(cell.machine.axes.len());
    for what in [ParameterSelection::All, ParameterSelection::NotDefault, ParameterSelection::NotCell] {
        let text = export_text(&cell.machine, &image, all, what);
        assert!(text.contains("machine.pulsacc: 5\n"), "{text}");
        assert!(!text.contains("pulsvel") && !text.contains("setsys"), "{text}");
        assert!(import(&text).is_ok());
    }
    // The outputs of revers: only for a velocity, and only those of the cell.
    let refused = import("slide.revers: 10\n").unwrap_err().to_string();
    assert!(refused.starts_with("p:1:15: revers 10 asks for outputs, which tell the sign of a velocity"), "{refused}");
    let text = include_str!("../../../../launch-configs/io.yaml").replace("node: 4}", "node: 4, interface: velocity}");
    let cell =
        Cell::parse("io.yaml", text.replace("sim: {model: ideal}", "sim: {model: velocity}")).expect("a good cell");
    let machine = Machine::new(cell.machine.clone()).expect("a machine");
    let import = |text: &str| check_import(Document::parse("p", text), &cell.machine, machine.directory());
    assert!(import("slide.revers: 50\n").is_ok());
    let refused = import("slide.revers: -50\n").unwrap_err().to_string();
    assert!(refused.starts_with("p:1:15: revers needs output 6; the cell has 5 digital outputs"), "{refused}");
    // Output 3 is the brake of lift, output 2 signals its motion: other axes may use output 2 for the same function,
    // but for no other one.
    for line in
        ["machine.o_error: 3", "slide.o_axmove: 3", "slide.o_brake: 2", "slide.o_axmove: -2", "lift.o_axmove: 1"]
    {
        let refused = import(&format!("{line}\n")).unwrap_err().to_string();
        assert!(refused.contains(", which has another function already"), "{line}: {refused}");
        assert!(refused.starts_with("p:1:"), "{line}: {refused}");
    }
    import("slide.o_axmove: 2\n").expect("two axes share it");
}
