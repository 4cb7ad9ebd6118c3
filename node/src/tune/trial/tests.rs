//! Tests axes of cells that are tuned as in `lineshaft tune`, and moved with the gains found.

use super::super::{Bounds, Ended, Findings, Setting, Subject, Trial, Unfit, settings, try_simulated};
use crate::cell::Cell;
use crate::cell_file::{Edited, edited};
use crate::scenario::{Options, Scenario, simulate};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Commands, Source};
use lineshaft_core::drive::Backend;
use lineshaft_core::machine::Machine;
use lineshaft_core::sim::Plant;
use lineshaft_tune::{Abort, Dynamics, Record, Refusal};
use std::path::Path;

/// Returns a cell: 2e-4 kg m^2 and 2 Nm; full speed 45 rev/s; 8192 inc per revolution, or another number.
fn torque(drive: &str, counts: u32, sim: &str, keys: &str) -> String {
    format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\naxes:\n  x:\n    type: rotary\n    unit: rev\n    \
         scale: {{increments: {counts}, per: 1 rev}}\n    drive: {{backend: plant, address: 0, {drive}}}\n    max_velocity: 45 rev/s\n    \
         max_acceleration: 100 rev/s^2\n    max_following_error: 2 rev\n    in_position_window: 20 inc\n{keys}    sim:\n      model: motor\n      \
         inertia: 2e-4 kg*m^2\n      rated_torque: 2 Nm\n      max_torque: 2 Nm\n      dead_time: 250 us\n      \
         viscous_friction: 1e-4 Nm*s/rad\n      counts_per_turn: {counts} inc\n{sim}"
    )
}

const PID: &str = "interface: torque, regulator: pid";
const EFFORT: &str = "    max_effort: 1000\n";

fn subject(cell: &Cell) -> Subject {
    let axis = &cell.machine.axes[0];
    Subject::of(axis, &axis.power_on())
}

fn setting(cell: &Cell, bounds: Bounds) -> Result<Setting, Unfit> {
    let config = &cell.machine;
    Setting::of(config, "x", |place| config.axes[place].power_on(), &bounds)
}

fn tried(text: &str, bounds: Bounds, prepare: impl FnOnce(&mut Plant)) -> (Setting, Ended, Record) {
    let cell = Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
    let setting = setting(&cell, bounds).expect("an axis that can be tuned");
    let (ended, record) = try_simulated(&cell, setting, None, prepare).expect("a trial");
    (setting, ended, record)
}

fn found(text: &str, bounds: Bounds) -> Findings {
    let (setting, ended, record) = tried(text, bounds, |_| {});
    assert_eq!(ended, Ended::Done);
    let cell = Cell::parse("cell.yaml", text).expect("a cell");
    Findings::find(subject(&cell), &record, &setting.wish, &setting.before).expect("a model")
}

/// Moves three revolutions with the gains in the cell; checks the maximum following error, and the remaining error at
/// the end (in inc).
fn moves(text: &str, findings: &Findings, most: i64, left: i64) {
    let gains = settings("x", &findings.gains).expect("gains of a cell");
    let Edited { cell, .. } = edited(Path::new("cell.yaml"), text, &gains).expect("a cell with these gains");
    let scenario = format!(
        "scenario: move\nfor: 4 s\nsteps:\n  - {{at: 0, do: {{enable: {{axes: [x]}}}}}}\n  - {{name: move, at: 0.5 s, do: {{move_axis: {{axis: x, \
         mode: relative, position: 3 rev, velocity: 10 rev/s, acceleration: 40 rev/s^2, deceleration: 40 rev/s^2}}}}}}\nexpect:\n  \
         - {{signal: x.following_error, from: 0.5 s, to: end, is: 0, within: {most} inc}}\n  \
         - {{signal: x.following_error, from: 3 s, to: end, is: 0, within: {left} inc}}\n  - {{signal: x.state, at: end, is: STANDSTILL}}\n"
    );
    let scenario = Scenario::parse("move.yaml", &scenario, &cell).unwrap_or_else(|problems| panic!("{problems}"));
    let report = simulate(&cell, &scenario, &Options::default()).expect("a run");
    assert!(report.passed(), "{report}");
}

/// Inertia, friction, a constant load, an elastic shaft, one with backlash, a coarse encoder: the model is that of the
/// plant, the loops are stable with 60 deg and 6 dB, and they move the axis. 2 Nm on 2e-4 kg m^2 with (1 + ratio) times
/// as much, in 8192 inc/rev.
#[test]
fn gains_of_a_trial_move_the_axis() {
    // The last number is the fraction of a revolution permitted as following error.
    let plants = [
        ("1:1", 8192, "      inertia_ratio: 1\n      coulomb_friction: 0.06 Nm\n", 2.0, 4),
        ("1:5", 8192, "      inertia_ratio: 5\n      coulomb_friction: 0.06 Nm\n", 6.0, 4),
        ("1:30", 8192, "      inertia_ratio: 30\n      coulomb_friction: 0.06 Nm\n", 31.0, 2),
        ("friction", 8192, "      inertia_ratio: 5\n      coulomb_friction: 0.5 Nm\n", 6.0, 4),
        ("coarse", 500, "      inertia_ratio: 5\n      coulomb_friction: 0.06 Nm\n", 6.0, 4),
    ];
    for (name, counts, sim, bodies, part) in plants {
        let text = torque(PID, counts, sim, EFFORT);
        let bounds = Bounds { effort: Some(0.6), ..Bounds::default() };
        let findings = found(&text, bounds);
        println!("{name}\n{}", findings.text());
        let Dynamics::Effort { acceleration, .. } = findings.identified.model.dynamics else { panic!("{name}") };
        let truth = 2.0 / (2e-4 * bodies) / std::f64::consts::TAU * f64::from(counts);
        assert!((acceleration / truth - 1.0).abs() < 0.02, "{name}: {acceleration} of {truth}");
        let after = findings.after.as_ref().unwrap_or_else(|sentence| panic!("{name}: {sentence}"));
        assert!(after.is_stable() && after.position.margins.phase >= 60.0, "{name}");
        moves(&text, &findings, i64::from(counts) / part, i64::from(counts) / 100);
    }
}

/// One degree of backlash before twice the inertia, 23 inc: without the ratio a message asks for it; with it there are
/// gains, and they move the axis.
#[test]
fn play_asks_for_the_ratio_of_inertias() {
    let sim = "      inertia_ratio: 2\n      load_coulomb_friction: 0.02 Nm\n      stiffness: 130 Nm/rad\n      \
               coupling_damping: 0.01 Nm*s/rad\n      backlash: 1 deg\n";
    let text = torque("interface: torque", 8192, sim, EFFORT);
    // In a short travel, the backlash is a larger fraction.
    let short = Bounds { velocity: Some(8.0 * 8192.0), effort: Some(0.6), ..Bounds::default() };
    let without = found(&text, short);
    assert!(without.gains.is_empty(), "{}", without.text());
    let said = without.warnings();
    assert!(said.iter().any(|line| line.contains("there is play before the load")), "{said:?}");
    assert_eq!(
        said.last().map(String::as_str),
        Some(
            "Where there is play, tell the inertia of the load by the motor's: --inertia-ratio, or inertia_ratio of ~/tune."
        )
    );
    let with = found(&text, Bounds { inertia_ratio: Some(2.0), ..short });
    println!("{}", with.text());
    let after = with.after.as_ref().expect("loops");
    assert!(after.is_stable() && after.margins.phase >= 60.0 && after.margins.gain >= 6.0);
    let inner = after.velocity_margins.expect("a velocity loop");
    assert!(inner.phase >= 60.0 && inner.gain >= 6.0);
    // The worse ones: those of the motor alone differ from those in contact.
    assert!(inner.gain < after.velocity.as_ref().expect("a velocity loop").margins.gain);
    assert!(
        with.warnings()
            .iter()
            .any(|line| line.starts_with("The load was told to have 2 times the inertia of the motor"))
    );
    moves(&text, &with, 3 * 8192, 60);
}

/// A drive with interface velocity.
#[test]
fn a_drive_of_velocities_is_tuned() {
    for drive in ["interface: velocity", "interface: velocity, regulator: pid"] {
        let text = torque(drive, 8192, "      inertia_ratio: 3\n      coulomb_friction: 0.05 Nm\n", "");
        let findings = found(&text, Bounds::default());
        println!("{drive}\n{}", findings.text());
        let Dynamics::Velocity { gain, .. } = findings.identified.model.dynamics else { panic!("{drive}") };
        // The full reference is max_velocity.
        assert!((gain / (45.0 * 8192.0) - 1.0).abs() < 0.01, "{drive}: {gain}");
        assert!(findings.after.as_ref().expect("loops").is_stable());
        moves(&text, &findings, 8192, 50);
    }
}

/// The excitation stays within its bounds, and the axis is off at the end.
#[test]
fn a_trial_keeps_its_bounds() {
    let text = torque(PID, 8192, "      inertia_ratio: 3\n      coulomb_friction: 0.06 Nm\n", EFFORT);
    let bounds = Bounds {
        travel: Some(8192.0),
        velocity: Some(40_960.0),
        effort: Some(0.5),
        duration: Some(3.0),
        ..Bounds::default()
    };
    let (_, ended, record) = tried(&text, bounds, |_| {});
    assert_eq!(ended, Ended::Done);
    let start = record.positions[0];
    let farthest = record.positions.iter().map(|place| (place - start).abs()).max().unwrap();
    assert!((800..=8192).contains(&farthest), "{farthest}");
    let fastest = record.positions.windows(8).map(|all| (all[7] - all[0]).abs()).max().unwrap();
    assert!(fastest as f64 <= 1.1 * 40_960.0 * 0.007, "{fastest}");
    assert!(record.commands.iter().all(|command| command.abs() <= 0.5));
}

/// No room, or less than the default.
#[test]
fn software_limits_make_the_travel_shorter() {
    let limits = |low: &str, high: &str| format!("{EFFORT}    min_position: {low}\n    max_position: {high}\n");
    let text = |low, high| torque(PID, 8192, "      coulomb_friction: 0.06 Nm\n", &limits(low, high));
    let (_, ended, record) = tried(&text("-0.5 rev", "0.5 rev"), Bounds::default(), |_| {});
    assert_eq!(ended, Ended::Done);
    let farthest = record.positions.iter().map(|place| place.abs()).max().unwrap();
    assert!(farthest < 4096, "{farthest}");
    let (_, ended, _) = tried(&text("-0.01 rev", "3 rev"), Bounds::default(), |_| {});
    // 81 inc, of which a fifth is margin.
    assert!(matches!(ended, Ended::NoRoom(travel) if (64.0..66.0).contains(&travel)), "{ended:?}");
    let bounds = Bounds { travel: Some(8192.0), ..Bounds::default() };
    let (_, ended, _) = tried(&text("-0.5 rev", "0.5 rev"), bounds, |_| {});
    assert!(matches!(ended, Ended::NoRoom(_)), "{ended:?}");
}

/// Plants that cannot be identified: a blocked axis, one that moves against its effort, one without effort.
#[test]
fn an_axis_that_is_stuck_reversed_or_open_is_refused() {
    let text = torque(PID, 8192, "      coulomb_friction: 0.06 Nm\n", EFFORT);
    let (_, ended, _) = tried(&text, Bounds::default(), |plant| plant.drive(0).expect("a drive").jam(true));
    let said = |ended: Ended| matches!(ended, Ended::Aborted(Abort::Stuck { .. }));
    assert!(said(ended), "{ended:?}");
    let (_, ended, _) =
        tried(&text.replace("model: motor\n", "model: motor\n      inverted: true\n"), Bounds::default(), |_| {});
    assert!(matches!(ended, Ended::Aborted(Abort::Against { .. })), "{ended:?}");
    // A phase is open: a thousandth of the torque remains.
    let weak = text.replace("max_torque: 2 Nm", "max_torque: 2e-3 Nm");
    let (_, ended, _) = tried(&weak, Bounds::default(), |_| {});
    assert!(said(ended), "{ended:?}");
}

/// An error of the axis ends it, and is reported.
#[test]
fn an_error_of_the_axis_ends_a_trial() {
    let text = torque(PID, 8192, "      coulomb_friction: 0.06 Nm\n", EFFORT);
    let (_, ended, _) = tried(&text, Bounds::default(), |plant| plant.drive(0).expect("a drive").inject_fault(0x2310));
    assert!(matches!(ended, Ended::Failed(event) if event.code != Code::NONE), "{ended:?}");
    let unhomed = format!("{EFFORT}    homing: {{required: true}}\n");
    let text = torque(PID, 8192, "      coulomb_friction: 0.06 Nm\n", &unhomed);
    let (_, ended, _) = tried(&text, Bounds::default(), |_| {});
    assert_eq!(ended, Ended::NotHomed);
}

#[test]
fn axes_that_cannot_be_tuned_are_refused_by_name() {
    let refused = |drive: &str, keys: &str, bounds: Bounds| {
        let text = torque(drive, 8192, "", keys);
        let cell = Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        setting(&cell, bounds).expect_err("a refusal").to_string()
    };
    assert_eq!(
        refused("interface: velocity, regulator: integer", "", Bounds::default()),
        "x: regulator is integer, whose gains are those of its module; proportional and pid can be tuned"
    );
    let bounds = Bounds { velocity: Some(400_000.0), ..Bounds::default() };
    assert_eq!(
        refused("interface: velocity", "", bounds),
        "x: velocity is 400000 inc/s; 368.64 to 368640 inc/s is allowed"
    );
    let bounds = Bounds { effort: Some(f64::NAN), ..Bounds::default() };
    assert!(refused(PID, EFFORT, bounds).starts_with("x: effort is NaN"));
    for (ratio, value) in [(-1.0, "-1"), (f64::NAN, "NaN"), (1000.5, "1000.5"), (f64::INFINITY, "inf")] {
        let bounds = Bounds { inertia_ratio: Some(ratio), ..Bounds::default() };
        assert_eq!(
            refused(PID, EFFORT, bounds),
            format!("x: inertia_ratio is {value}; 0 to 1000 times the inertia of the motor is allowed")
        );
    }
    let bounds = Bounds { inertia_ratio: Some(5.0), ..Bounds::default() };
    assert_eq!(
        refused("interface: velocity", "", bounds),
        "x: inertia_ratio suits a drive that takes efforts; this one takes velocities, and closes its velocity loop through play itself"
    );
    let table = include_str!("../../../../launch-configs/dual.yaml").replace("ampencno", "# ampencno");
    let cell = Cell::parse("dual.yaml", table.replace("ampencres", "# ampencres").replace("ampencrpm", "# ampencrpm"));
    let said =
        setting(&cell.unwrap_or_else(|problems| panic!("{problems}")), bounds).expect_err("a refusal").to_string();
    assert!(
        said.starts_with("x: inertia_ratio suits an axis whose encoder sits on its motor and is told by its drive; its position comes from encoder "),
        "{said}"
    );
    let two = format!("{EFFORT}    ampencno: 1\n    ampencres: 65536\n");
    assert_eq!(
        refused(PID, &two, Bounds::default()),
        "x: ampencno 1 gives its velocity loop another encoder than its position loop has, and a model knows one; an axis with \
         ampencno -1 can be tuned"
    );
    let text = include_str!("../../../../launch-configs/voltage.yaml").to_owned();
    assert_eq!(
        setting(&Cell::parse("voltage.yaml", text).expect("a cell"), Bounds::default())
            .expect_err("a refusal")
            .to_string(),
        "x: interface is voltage, and no model here is one of a winding; interface velocity or torque can be tuned"
    );
    let analog = Cell::parse("analog.yaml", include_str!("../../../../launch-configs/analog.yaml")).expect("a cell");
    let config = &analog.machine;
    let of = |name: &str| Setting::of(config, name, |place| config.axes[place].power_on(), &Bounds::default());
    assert!(of("x").is_ok(), "one of velocities brakes at 0 V");
    let said = of("y").expect_err("a refusal").to_string();
    assert!(said.starts_with("y: its drive takes a torque as a voltage, and coasts where a trial leaves it"), "{said}");
    let demo = Cell::demo();
    let config = &demo.machine;
    let of = |name: &str| Setting::of(config, name, |place| config.axes[place].power_on(), &Bounds::default());
    assert!(of("nobody").expect_err("a refusal").to_string().starts_with("no axis is called `nobody`; there are "));
    for axis in &config.axes {
        let sentence = of(&axis.name).expect_err("a refusal").to_string();
        assert!(sentence.contains("no loop of it is closed here"), "{sentence}");
    }
}

/// A record with too little information is refused with its own message.
#[test]
fn a_record_without_motion_has_no_model() {
    let text = torque(PID, 8192, "      coulomb_friction: 0.06 Nm\n", EFFORT);
    let (setting, _, mut record) = tried(&text, Bounds::default(), |_| {});
    record.positions.fill(5);
    let cell = Cell::parse("cell.yaml", text).expect("a cell");
    let subject = subject(&cell);
    let refusal = Findings::find(subject, &record, &setting.wish, &setting.before).expect_err("a refusal");
    assert!(matches!(refusal, Refusal::Stuck { .. }), "{refusal}");
}

/// 30 % of 45 rev/s need 13.5^2 / (2 * 5) = 18.225 rev to stop at 5 rev/s^2, which is 0.4 of the travel: 45.5625 rev,
/// and a shorter one is refused. Half of the room halves everything.
#[test]
fn the_travel_leaves_a_way_to_stop() {
    let slow = |keys: &str| {
        torque("interface: velocity", 8192, "", keys)
            .replace("max_acceleration: 100 rev/s^2", "max_acceleration: 5 rev/s^2")
    };
    let cell = |text: String| Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
    let permitted = setting(&cell(slow("")), Bounds::default()).expect("bounds").permitted;
    assert_eq!((permitted.travel, permitted.velocity), (45.5625 * 8192.0, 13.5 * 8192.0));
    let bounds = Bounds { travel: Some(8192.0), ..Bounds::default() };
    let sentence = setting(&cell(slow("")), bounds).expect_err("too short").to_string();
    assert!(sentence.starts_with("x: travel is 8192 inc; 37324"), "{sentence}");
    let limits = "    min_position: -28.4765625 rev\n    max_position: 28.4765625 rev\n";
    let shorter = setting(&cell(slow(limits)), Bounds::default()).expect("bounds").at(0).expect("room");
    assert_eq!((shorter.travel, shorter.velocity), (permitted.travel / 2.0, permitted.velocity / 2.0));
    assert!((shorter.command - permitted.command / 2.0).abs() < 1e-12);
}

/// Ten cycles per second are missed, one or three in a row: the record contains them, and the model is the same. More
/// than ten end the trial.
#[test]
fn missed_cycles_are_in_the_record() {
    let text = torque(PID, 8192, "", EFFORT);
    let run = |row: u32| {
        let cell = Cell::parse("cell.yaml", &text).expect("a cell");
        let setting = setting(&cell, Bounds::default()).expect("fit");
        let (mut plant, mut machine) = (cell.plant(), Machine::new(cell.machine.clone()).expect("a machine"));
        let trial = Trial::new(setting, Source::Cli, machine.config(), machine.directory()).expect("a trial");
        let mut trial = trial.of_real();
        let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
        let mut number = 0;
        while trial.ended().is_none() {
            let missed = if machine.next_cycle() % 200 == 199 { row } else { 0 };
            for _ in 0..missed {
                // The plant continues with its last command.
                inputs.begin(machine.next_cycle(), 0);
                plant.read(&mut inputs);
                plant.write(&outputs);
            }
            inputs.begin(machine.next_cycle(), missed);
            plant.read(&mut inputs);
            let command = (machine.next_cycle() > 1).then(|| trial.before(&machine, || number + 1)).flatten();
            number += u64::from(command.is_some());
            machine.cycle(&inputs, Commands::queue(command.as_slice()), &mut outputs);
            plant.write(&outputs);
        }
        let findings = Findings::find(subject(&cell), trial.record(), &setting.wish, &setting.before);
        (trial.ended(), findings.ok().map(|found| found.identified.model.dynamics))
    };
    let gain = |dynamics: Option<Dynamics>| match dynamics {
        Some(Dynamics::Effort { acceleration, .. }) => acceleration,
        other => panic!("{other:?}"),
    };
    let (whole, one, three) = (run(0), run(1), run(3));
    assert_eq!([whole.0, one.0, three.0], [Some(Ended::Done); 3]);
    for (_, dynamics) in [one, three] {
        assert!((gain(dynamics) / gain(whole.1) - 1.0).abs() < 0.02, "{dynamics:?} {:?}", whole.1);
    }
    assert_eq!(run(11).0, Some(Ended::Missed(11)));
}
