//! Virtual master: its ramp, its source, its start and end, its marks.

use super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use super::sums::{copying, enabled, master, raw, start};
use crate::code::Code;
use crate::command::{Action, SetPosition};
use crate::config::{ConfigError, IoConfig, IoKind, MachineConfig, MemoryConfig, MemoryKind, SinkConfig, SourceConfig};
use crate::drive::{Edge, Latch};
use crate::event::Kind;
use crate::machine::{Machine, StateError};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Layer, MACHINE, MachineParameters, Row, Value};
use crate::position::Length;
use crate::sync::VirtualSource;
use proptest::prelude::*;

const VIRTUAL: Leader = Leader::Virtual;
const ALL: AxisSet = AxisSet::EMPTY;

fn sets(values: &[(&str, i64)]) -> Action {
    let change = |&(key, value): &(&str, i64)| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    Action::SetParameters(values.iter().map(change).collect())
}

#[track_caller]
fn set(rig: &mut Rig, values: &[(&str, i64)]) {
    let given = rig.give(sets(values));
    assert_eq!(rig.answer(given), Ok(()), "{values:?}");
}

#[track_caller]
fn refused(rig: &mut Rig, values: &[(&str, i64)]) -> String {
    let given = rig.give(sets(values));
    rig.refusal(given)
}

fn parameters(rig: &Rig) -> MachineParameters {
    rig.machine.state.panel.parameters
}

/// `stop` is i_break, `mark` latches, `edge` does not; x follows its leader without limits.
fn cell() -> MachineConfig {
    let input = |name: &str, latch| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch };
    let mut config = config(0);
    config.io = vec![input("stop", false), input("mark", true), input("edge", false)];
    config.global.parameters.i_break = 1;
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.max_velocity, p.max_acceleration) = (1e11, 1e14);
    config
}

fn couples(rig: &mut Rig, axis: u16, numerator: i64, denominator: i64) -> u64 {
    rig.give(Action::Synchronize(couple(axis, VIRTUAL, numerator, denominator)))
}

/// 100 inc/s more in each ms: 10 cycles up to 1000 inc/s, then 1 inc in each. x is twice as fast, in the same cycle.
///
/// Proves: MACS-VM-02, MACS-VM-08, MACS-CMD-33
#[test]
fn pulsvel_starts_and_pulsacc_ramps() {
    let mut rig = enabled(cell());
    let coupling = couples(&mut rig, X, 2, 1);
    assert!(rig.was_accepted(coupling));
    set(&mut rig, &[("pulsacc", 100_000)]);
    rig.run(5);
    assert_eq!((rig.int("machine.vmaster.position"), rig.real("machine.vmaster.velocity")), (0, 0.0));
    set(&mut rig, &[("pulsvel", 1_000)]);
    for cycle in 1_i64..=30 {
        let velocity = 100.0 * cycle.min(10) as f64;
        // 0.1 + 0.2 + .. 1, then 1 in each cycle.
        let tenths = if cycle < 10 { cycle * (cycle + 1) / 2 } else { 55 + 10 * (cycle - 10) };
        let exact = (i128::from(tenths) << 32).div_euclid(10);
        assert_eq!((rig.real("machine.vmaster.velocity"), raw(&rig, VIRTUAL)), (velocity, exact), "in cycle {cycle}");
        assert_eq!(rig.int("machine.vmaster.position"), tenths / 10);
        assert_eq!(raw(&rig, Leader::AxisCommand(X)), 2 * exact);
        assert_eq!(rig.real("x.master.velocity"), velocity);
        rig.run(1);
    }
    // Through 0 and back: 20 cycles with 100 inc/s less.
    set(&mut rig, &[("pulsvel", -1_000)]);
    rig.run(9);
    assert_eq!(rig.real("machine.vmaster.velocity"), 0.0);
    rig.run(10);
    assert_eq!((rig.real("machine.vmaster.velocity"), rig.real("x.command.velocity")), (-1_000.0, -2_000.0));
    // Half the ramp, at once.
    set(&mut rig, &[("pulsvel", 0), ("pulsacc", 50_000)]);
    assert_eq!(rig.real("machine.vmaster.velocity"), -950.0);
    rig.run(19);
    assert_eq!((rig.real("machine.vmaster.velocity"), rig.int("x.in_sync")), (0.0, 1));
}

/// It is at rest in the cycle of pulsacc 0, with any pulsvel, until pulsvel is set again, also to the same value.
///
/// Proves: MACS-VM-02
#[test]
fn pulsacc_0_ends_it() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("pulsvel", 5_000), ("pulsacc", 1_000_000)]);
    rig.run(100);
    let place = rig.int("machine.vmaster.position");
    assert!(place > 400);
    set(&mut rig, &[("pulsacc", 0)]);
    assert_eq!((rig.int("machine.vmaster.position"), rig.real("machine.vmaster.velocity")), (place, 0.0));
    set(&mut rig, &[("pulsacc", 1_000_000)]);
    rig.run(10);
    assert_eq!((rig.int("machine.vmaster.position"), parameters(&rig).pulsvel), (place, 5_000));
    set(&mut rig, &[("pulsvel", 5_000)]);
    assert_eq!(rig.real("machine.vmaster.velocity"), 1_000.0);
}

/// The velocity is reached in the cycle of its set, and reverses without a ramp; pulsvel has no effect.
///
/// Proves: MACS-VM-04, MACS-CMD-33
#[test]
fn setsys_15_is_the_velocity_with_pulsacc_minus_1() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("setsys_15", 3_000)]);
    rig.run(3);
    assert_eq!(rig.int("machine.vmaster.position"), 0);
    set(&mut rig, &[("pulsacc", -1)]);
    assert_eq!((rig.int("machine.vmaster.position"), rig.real("machine.vmaster.velocity")), (3, 3_000.0));
    set(&mut rig, &[("setsys_15", -7_000)]);
    assert_eq!((rig.int("machine.vmaster.position"), rig.real("machine.vmaster.velocity")), (-4, -7_000.0));
    let obsolete = "machine: pulsvel 9 starts the virtual master, and pulsacc is -1; above 0 is needed for that";
    assert_eq!(refused(&mut rig, &[("pulsvel", 9)]), obsolete);
    rig.run(1);
    assert_eq!(rig.real("machine.vmaster.velocity"), -7_000.0);
    // From the present velocity, with the ramp.
    set(&mut rig, &[("pulsacc", 1_000_000), ("pulsvel", 0)]);
    assert_eq!(rig.real("machine.vmaster.velocity"), -6_000.0);
    set(&mut rig, &[("pulsacc", -1), ("setsys_15", 0)]);
    assert_eq!(rig.real("machine.vmaster.velocity"), 0.0);
    // No start has been given yet.
    set(&mut rig, &[("setsys_15", 500)]);
    set(&mut rig, &[("pulsacc", 1_000_000)]);
    assert_eq!(rig.real("machine.vmaster.velocity"), 0.0);
}

/// y is after x in the file, and moves before it, from the cycle of the start on: x has the command of y of the same
/// cycle. A new zero of y is not a motion, and pulsvel moves nothing.
///
/// Proves: MACS-VM-01, MACS-VM-03, MACS-VM-08
#[test]
fn it_follows_the_command_of_an_axis_without_a_lag() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("pulsacc", (1 << 30) - 1), ("vmenctyp", 100_300)]);
    couples(&mut rig, X, 355, 113);
    rig.give(Action::Move(at(Y, 20_000.0)));
    rig.run(10);
    assert_eq!(raw(&rig, VIRTUAL), 0, "vmenctyp waits for pulsvel");
    set(&mut rig, &[("pulsvel", 0)]);
    rig.run(3);
    rig.mirror();
    let apart = raw(&rig, Leader::AxisCommand(Y)) - raw(&rig, VIRTUAL);
    for cycle in 0_i64..2_000 {
        if cycle % 150 == 0 {
            let place = cycle * 7_919 % 20_011 - 10_000;
            rig.give(Action::Move(to(Y, place)));
        } else if cycle == 1_000 {
            set(&mut rig, &[("pulsvel", 1_000)]);
        } else {
            rig.run(1);
        }
        let place = raw(&rig, VIRTUAL);
        assert_eq!(raw(&rig, Leader::AxisCommand(Y)) - place, apart, "in cycle {cycle}");
        assert_eq!(raw(&rig, Leader::AxisCommand(X)), (place * 355).div_euclid(113), "in cycle {cycle}");
    }
    rig.run_until("y.state", 1);
    let place = rig.int("machine.vmaster.position");
    rig.give(Action::SetPosition(SetPosition { axis: Y, position: Length::whole(77) }));
    rig.run(3);
    assert_eq!((rig.int("machine.vmaster.position"), rig.int("y.command.position")), (place, 77));
    // Another source is only applied by the next pulsvel.
    set(&mut rig, &[("vmenctyp", 0)]);
    rig.give(Action::Move(to(Y, 1_077)));
    rig.run_until("y.state", 1);
    assert_eq!(rig.int("machine.vmaster.position"), place + 1_000);
    set(&mut rig, &[("pulsvel", -1_000)]);
    rig.give(Action::Move(to(Y, 0)));
    rig.run(1);
    assert_eq!(rig.real("machine.vmaster.velocity"), -1_000.0);
}

/// line accelerates to 20 mm/s with 0.5 m/s^2, half of its limit; its follower with 0.1 m/s^2, 0.1 inc/cycle^2. The
/// distance that is lost by the ramp is not caught up: the follower ends with the velocity of the axis, not at its
/// position.
///
/// Proves: MACS-VM-03
#[test]
fn pulsacc_limits_what_it_follows() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("vmenctyp", 100), ("pulsacc", 100_000), ("pulsvel", 0)]);
    rig.give(Action::Move(at(LINE, 20_000.0)));
    let mut before = 0.0;
    for cycle in 0..199 {
        rig.run(1);
        let velocity = rig.real("machine.vmaster.velocity");
        assert!(velocity - before <= 100.0 + 1e-6, "in cycle {cycle}");
        before = velocity;
    }
    assert!(before < 20_000.0);
    rig.run(2);
    assert!((rig.real("machine.vmaster.velocity") - 20_000.0).abs() < 1e-4);
    let lost = |rig: &Rig| rig.int("line.command.position") - rig.int("machine.vmaster.position");
    // Half of the distance at 20 mm/s in the 200 ms of its ramp, less that of 40 ms: 1600 inc, within half a cycle of
    // 20 inc.
    let apart = lost(&rig);
    assert!((apart - 1_600).abs() <= 20, "{apart}");
    rig.run(500);
    assert!((lost(&rig) - apart).abs() <= 1);
}

/// A refused set reports the reason, and changes nothing.
///
/// Proves: MACS-VM-01, MACS-VM-03, MACS-VM-07
#[test]
fn invalid_sets_are_refused_and_change_nothing() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("pulsvel", 500), ("pulsacc", 1_000)]);
    set(&mut rig, &[("vmencres", 700)]);
    let (before, source) = (parameters(&rig), rig.machine.state.virtual_master.source());
    let version = rig.machine.parameter_version();
    let axes = "is not allowed; 100 n is, and 100000 more, with n 0 for pulsvel, 1 to 3 for an axis";
    for (values, sentence) in [
        (&[("vmenctyp", 400)][..], format!("machine: vmenctyp 400 {axes}")),
        (&[("vmenctyp", 207)], format!("machine: vmenctyp 207 {axes}")),
        (&[("vmenctyp", 200_000)], format!("machine: vmenctyp 200000 {axes}")),
        (
            &[("vmencres", 9), ("vmenctyp", 101)],
            "machine: vmenctyp 101 has an encoder of type 1 in the place of the virtual master while that is off; encoders have names here, and 0 as \
             the last two digits is allowed: it stands"
                .to_owned(),
        ),
        (&[("vmenctyp", -1)], "machine: vmenctyp is -1; 0 to 1073741823 is allowed".to_owned()),
        (&[("vmencmtyp", 42)], "machine: vmencmtyp needs input 4; the cell has 3 digital inputs".to_owned()),
        (
            &[("pulsvel", 7), ("pulsacc", 0)],
            "machine: pulsvel 7 starts the virtual master, and pulsacc is 0; above 0 is needed for that".to_owned(),
        ),
        (&[("pulsacc", -2)], "machine: pulsacc is -2; -1 to 1073741823 is allowed".to_owned()),
        (&[("pulsvel", 1 << 30)], "machine: pulsvel is 1073741824; -1073741823 to 1073741823 is allowed".to_owned()),
        (&[("vmencres", 65_536)], "machine: vmencres is 65536; 0 to 65535 is allowed".to_owned()),
    ] {
        assert_eq!(refused(&mut rig, values), sentence);
        assert_eq!((parameters(&rig), rig.machine.state.virtual_master.source()), (before, source), "{values:?}");
        assert_eq!(rig.machine.parameter_version(), version);
    }
    for marker in [2, 3, 4, 10, 14] {
        assert!(refused(&mut rig, &[("vmencmtyp", marker)]).starts_with(&format!("machine: vmencmtyp is {marker}; ")));
    }
    // Switched off, with an axis as its source: a start without a ramp, and a file with all parameters.
    set(&mut rig, &[("pulsacc", 0), ("pulsvel", 0), ("vmenctyp", 200)]);
    let sentence = "machine: pulsvel 0 starts the virtual master, and pulsacc is 0; above 0 is needed for that";
    assert_eq!(refused(&mut rig, &[("pulsvel", 0)]), sentence);
    set(&mut rig, &[("pulsacc", 0), ("pulsvel", 0)]);
    assert_eq!(rig.machine.state.virtual_master.source(), VirtualSource::Off);
}

/// Proves: MACS-VM-01, MACS-ERR-09
#[test]
fn a_cell_begins_with_a_virtual_master_that_stands() {
    let made = |p: MachineParameters, is_saved: bool| {
        let mut cell = cell();
        if is_saved {
            cell.global.saved = Some(p);
        } else {
            cell.global.parameters = p;
        }
        Machine::new(cell).map(|machine| machine.state.virtual_master.source()).map_err(|error| error.to_string())
    };
    let p = MachineParameters::default();
    for is_saved in [false, true] {
        let runs = |key: &str| {
            Err(format!(
                "machine: {key} is 1; 0 is allowed at the start, as no machine begins with a virtual master that runs"
            ))
        };
        assert_eq!(made(MachineParameters { pulsvel: 1, ..p }, is_saved), runs("pulsvel"));
        assert_eq!(made(MachineParameters { setsys_15: 1, ..p }, is_saved), runs("setsys_15"));
        assert!(made(MachineParameters { vmenctyp: 400, ..p }, is_saved).is_err());
        assert!(made(MachineParameters { vmencmtyp: 93, ..p }, is_saved).is_err());
        assert_eq!(made(MachineParameters { pulsacc: 5, vmenctyp: 300, ..p }, is_saved), Ok(VirtualSource::Off));
        assert_eq!(made(MachineParameters { pulsacc: -1, ..p }, is_saved), Ok(VirtualSource::Direct));
    }
    let mut cell = cell();
    cell.global.parameters.vmenctyp = 5;
    assert!(matches!(Machine::new(cell).err(), Some(ConfigError::VirtualMaster(_))));
}

/// Through a coupling, a sum and a sink, in any order.
///
/// Proves: MACS-VM-01
#[test]
fn loops_are_refused() {
    let masters = vec![master("sum", &[Leader::Encoder(0)], &[VIRTUAL])];
    let with = |slots| MachineConfig { masters: masters.clone(), slots, ..cell() };
    let follows = "x: the axis would follow itself";
    let names =
        "machine: vmenctyp 200 names an axis that follows the virtual master itself; one that does not is allowed";
    for leader in [VIRTUAL, Leader::Sum(0)] {
        let mut rig = enabled(with(Vec::new()));
        set(&mut rig, &[("vmenctyp", 200), ("pulsacc", 1_000)]);
        set(&mut rig, &[("pulsvel", 0)]);
        let given = rig.give(Action::Synchronize(couple(X, leader, 1, 1)));
        assert_eq!(rig.refusal(given), follows);
        // y may follow, and then x must not follow y.
        let given = rig.give(Action::Synchronize(couple(Y, leader, 1, 1)));
        assert!(rig.was_accepted(given));
        rig.run(1);
        let given = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(Y), 1, 1)));
        assert_eq!(rig.refusal(given), follows);
        // Switched off, it closes no loop.
        set(&mut rig, &[("pulsacc", 0)]);
        let given = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(Y), 1, 1)));
        assert!(rig.was_accepted(given));
        rig.run(1);
        set(&mut rig, &[("vmenctyp", 0)]);
        let before = parameters(&rig);
        assert_eq!(refused(&mut rig, &[("vmenctyp", 200), ("pulsacc", 1_000), ("pulsvel", 0)]), names);
        assert_eq!((parameters(&rig), rig.machine.state.virtual_master.source()), (before, VirtualSource::Off));
        set(&mut rig, &[("vmenctyp", 100), ("pulsacc", 1_000), ("pulsvel", 0)]);
    }
    let mut rig = enabled(with(vec![copying(VIRTUAL, SinkConfig::Axis(X))]));
    assert_eq!(refused(&mut rig, &[("vmenctyp", 200), ("pulsacc", 1), ("pulsvel", 0)]), names);
    // A function that reads one of its signals.
    let mut slot = copying(VIRTUAL, SinkConfig::Axis(X));
    slot.source = SourceConfig::Signal("machine.vmaster.velocity".to_owned());
    let mut rig = enabled(with(vec![slot]));
    assert_eq!(refused(&mut rig, &[("vmenctyp", 200), ("pulsacc", 1), ("pulsvel", 0)]), names);
    set(&mut rig, &[("vmenctyp", 300), ("pulsacc", 1), ("pulsvel", 0)]);
}

/// A selector that may couple at any time counts as if it did.
#[test]
fn a_selector_closes_loops_too() {
    let mut cell = cell();
    cell.axes[usize::from(X)].vocabularies.amc.master = Some(VIRTUAL);
    let mut rig = enabled(cell);
    let sentence = refused(&mut rig, &[("vmenctyp", 200), ("pulsacc", 1), ("pulsvel", 0)]);
    assert!(sentence.contains("vmenctyp 200 names an axis that follows"), "{sentence}");
    set(&mut rig, &[("vmenctyp", 300), ("pulsacc", 1), ("pulsvel", 0)]);
    assert_eq!(rig.machine.state.order, [LINE, Y, X]);
}

/// By input and by command, in that cycle: it is at rest, and only a new set starts it. The velocities are 0, which is
/// reported.
///
/// Proves: MACS-ERR-09
#[test]
fn an_abort_ends_it() {
    for by_input in [false, true] {
        for (values, key) in [
            (&[("pulsacc", 1_000_000), ("pulsvel", 5_000)][..], "pulsvel"),
            (&[("pulsacc", -1), ("setsys_15", 5_000)], "setsys_15"),
        ] {
            let mut rig = enabled(cell());
            couples(&mut rig, X, 1, 1);
            set(&mut rig, values);
            rig.run(100);
            rig.mirror();
            let place = rig.int("machine.vmaster.position");
            if by_input {
                rig.plant.set_digital(0, true);
                rig.run(1);
            } else {
                rig.give(Action::Abort);
            }
            assert_eq!((rig.int("machine.vmaster.position"), rig.real("machine.vmaster.velocity")), (place, 0.0));
            let row = Row::find(key).map(|(row, _)| row);
            let is_told = |event: &crate::event::Event| {
                event.kind == Kind::Parameter && event.source == Object::Machine && event.parameter == row
            };
            assert!(rig.machine.events().iter().any(is_told));
            assert_eq!((parameters(&rig).pulsvel, parameters(&rig).setsys_15), (0, 0));
            rig.run(200);
            assert_eq!((rig.int("machine.vmaster.position"), rig.state("x")), (place, "STOPPING"));
            rig.plant.set_digital(0, false);
            set(&mut rig, &[(key, 1_000)]);
            rig.run(10);
            assert!(rig.int("machine.vmaster.position") > place, "{key}");
        }
    }
}

/// A set of the same cycle does not start it again, in any order of the commands.
///
/// Proves: MACS-ERR-09
#[test]
fn an_abort_wins_over_a_start_in_its_cycle() {
    let starts: [&[(&str, i64)]; 3] = [
        &[("pulsacc", 1_000_000), ("pulsvel", 5_000)],
        &[("pulsacc", -1), ("setsys_15", 5_000)],
        &[("pulsacc", 1_000_000), ("vmenctyp", 300), ("pulsvel", 0)],
    ];
    for values in starts {
        for is_behind in [false, true] {
            let mut rig = enabled(cell());
            set(&mut rig, values);
            rig.give(Action::Move(at(Y, 20_000.0)));
            rig.run(100);
            let place = rig.int("machine.vmaster.position");
            assert!(place > 0);
            let mut both = vec![sets(values), Action::Abort];
            if is_behind {
                both.reverse();
            }
            let last = rig.give_all(both);
            assert!(rig.was_accepted(last) && rig.was_accepted(last - 1));
            let shown = |rig: &Rig| (rig.int("machine.vmaster.position"), rig.real("machine.vmaster.velocity"));
            assert_eq!(shown(&rig), (place, 0.0), "{values:?} {is_behind}");
            assert_eq!((parameters(&rig).pulsvel, parameters(&rig).setsys_15), (0, 0));
            rig.run(100);
            assert_eq!(shown(&rig), (place, 0.0), "{values:?} {is_behind}");
        }
    }
}

/// It follows an axis: switched off, it no longer does, and any order of the axes is possible.
///
/// Proves: MACS-ERR-09
#[test]
fn abort_ends_following_of_an_axis() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("vmenctyp", 300), ("pulsacc", 1_000_000), ("pulsvel", 0)]);
    couples(&mut rig, X, 1, 1);
    rig.run(1);
    assert_eq!(rig.machine.state.order, [LINE, Y, X]);
    rig.give(Action::Move(at(Y, 20_000.0)));
    rig.run(50);
    let place = rig.int("machine.vmaster.position");
    assert!(place > 0);
    rig.give(Action::Abort);
    rig.run(1);
    assert_eq!((rig.int("machine.vmaster.position"), rig.machine.state.virtual_master.axis()), (place, None));
}

/// 3 inc in each cycle, a pulse every 10 inc, from any time on.
///
/// Proves: MACS-VM-06
#[test]
fn the_index_counts_its_pulses() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("pulsacc", -1), ("vmencres", 10), ("setsys_15", 3_000)]);
    rig.run(99);
    // At 300.
    assert_eq!((rig.int("machine.vmaster.index.count"), rig.int("machine.vmaster.index.position")), (30, 300));
    set(&mut rig, &[("setsys_15", -4_000)]);
    rig.run(1);
    // 296, 292: from 300 backwards there is none.
    assert_eq!(rig.int("machine.vmaster.index.count"), 30);
    rig.run(1);
    assert_eq!((rig.int("machine.vmaster.index.count"), rig.int("machine.vmaster.index.position")), (31, 290));
    set(&mut rig, &[("vmencres", 100), ("setsys_15", 1_000_000)]);
    // 288 + 1000: 300, 400, .. 1200.
    assert_eq!((rig.int("machine.vmaster.index.count"), rig.int("machine.vmaster.index.position")), (41, 1_200));
    set(&mut rig, &[("vmencres", 0)]);
    rig.run(10);
    assert_eq!(rig.int("machine.vmaster.index.count"), 41);
}

/// A latch has its position within the cycle; an edge that is only read has that of the cycle.
///
/// Proves: MACS-VM-07
#[test]
fn the_index_counts_edges_of_an_input() {
    let mut rig = enabled(cell());
    let seen = |rig: &Rig| (rig.int("machine.vmaster.index.count"), rig.int("machine.vmaster.index.position"));
    set(&mut rig, &[("pulsacc", -1), ("setsys_15", 10_000), ("vmencmtyp", 22)]);
    rig.run(9);
    assert_eq!(seen(&rig), (0, 0));
    let latch = |edge, age_ns| Latch { object: Object::Io(1), edge, age_ns: Some(age_ns), position: None };
    rig.plant.add_latch(latch(Edge::Falling, 100_000));
    rig.plant.add_latch(latch(Edge::Rising, 300_000));
    rig.run(1);
    // At 110, 3 inc earlier.
    assert_eq!(seen(&rig), (1, 107));
    set(&mut rig, &[("vmencmtyp", 23)]);
    rig.plant.add_latch(latch(Edge::Falling, 950_000));
    rig.run(1);
    // At 130, 9.5 inc earlier: floor(120.5).
    assert_eq!(seen(&rig), (2, 120));
    rig.plant.set_digital(2, true);
    set(&mut rig, &[("vmencmtyp", 33)]);
    assert_eq!(seen(&rig), (2, 120));
    rig.plant.set_digital(2, false);
    rig.run(1);
    assert_eq!(seen(&rig), (3, 150));
    rig.plant.set_digital(2, true);
    rig.run(3);
    assert_eq!(seen(&rig), (3, 150));
    // Its own pulses again, every 500.
    set(&mut rig, &[("vmencmtyp", 1), ("setsys_15", 1_000_000)]);
    assert_eq!(seen(&rig), (5, 1_000));
}

/// Layers: the running state is not saved, but the source is.
///
/// Proves: MACS-VM-01
#[test]
fn a_reset_and_the_power_end_it() {
    for by_power in [false, true] {
        let mut cell = cell();
        cell.global.parameters.pulsacc = 7_000;
        let mut rig = Rig::of(cell);
        set(&mut rig, &[("pulsacc", 1_000_000), ("vmenctyp", 100)]);
        set(&mut rig, &[("vmenctyp", 0), ("pulsvel", 1_000)]);
        set(&mut rig, &[("vmenctyp", 100)]);
        let all = AxisSet::first(3).union(&ALL);
        let saved = rig.give(Action::SaveParameters(all));
        assert!(rig.was_accepted(saved));
        rig.run(100);
        assert_eq!(rig.real("machine.vmaster.velocity"), 1_000.0);
        let place = rig.int("machine.vmaster.position");
        let given = rig.give(if by_power {
            Action::PowerCycle
        } else {
            Action::ResetParameters { axes: all, layer: Layer::User }
        });
        assert!(rig.was_accepted(given));
        let p = parameters(&rig);
        assert_eq!((p.pulsvel, p.pulsacc, p.vmenctyp), (0, 7_000, 100));
        rig.run(200);
        assert_eq!(rig.real("machine.vmaster.velocity"), 0.0);
        if by_power {
            assert_eq!((raw(&rig, VIRTUAL), rig.machine.state.virtual_master.source()), (0, VirtualSource::Off));
        } else {
            // With the ramp of the cell: 7 inc/s less in each cycle, 143 cycles.
            assert!((rig.int("machine.vmaster.position") - place - 71).abs() <= 1);
        }
    }
}

/// line continues with 20 mm/s, and its follower stops: with the ramp of the cell, 10 inc/s less in each of 2000
/// cycles, or at once.
///
/// Proves: MACS-VM-01, MACS-VM-03
#[test]
fn a_reset_ends_following() {
    for (ramp, way) in [(10_000, 20_000), (0, 0)] {
        let mut cell = cell();
        cell.global.parameters.pulsacc = ramp;
        let mut rig = enabled(cell);
        set(&mut rig, &[("vmenctyp", 100), ("pulsacc", 1 << 29), ("pulsvel", 0)]);
        rig.give(Action::Move(at(LINE, 20_000.0)));
        rig.run(500);
        assert!((rig.real("machine.vmaster.velocity") - 20_000.0).abs() < 1e-3);
        let place = rig.int("machine.vmaster.position");
        let all = AxisSet::first(3);
        let given = rig.give(Action::ResetParameters { axes: all, layer: Layer::Init });
        assert!(rig.was_accepted(given));
        assert_eq!((parameters(&rig).vmenctyp, rig.machine.state.virtual_master.axis()), (0, None));
        rig.run(2_010);
        assert_eq!((rig.real("machine.vmaster.velocity"), rig.real("line.command.velocity")), (0.0, 20_000.0));
        let gone = rig.int("machine.vmaster.position") - place;
        assert!((gone - way).abs() <= 20, "{gone}");
        // line continues, and the virtual master does not follow it, also after a ramp is set again.
        set(&mut rig, &[("pulsacc", 1 << 29)]);
        rig.run(10);
        assert_eq!(rig.real("machine.vmaster.velocity"), 0.0);
    }
}

/// The previous level is discarded while another marker is selected: a change in the meantime is not an edge.
///
/// Proves: MACS-VM-07
#[test]
fn reselected_marker_ignores_previous_level() {
    for other in [0, 22] {
        let mut rig = enabled(cell());
        let count = |rig: &Rig| rig.int("machine.vmaster.index.count");
        set(&mut rig, &[("pulsacc", -1), ("setsys_15", 1_000), ("vmencres", 0), ("vmencmtyp", 32)]);
        rig.run(3);
        set(&mut rig, &[("vmencmtyp", other)]);
        rig.plant.set_digital(2, true);
        rig.run(3);
        set(&mut rig, &[("vmencmtyp", 32)]);
        rig.run(3);
        assert_eq!(count(&rig), 0, "{other}");
        rig.plant.set_digital(2, false);
        rig.run(1);
        rig.plant.set_digital(2, true);
        rig.run(1);
        assert_eq!(count(&rig), 1, "{other}");
    }
}

/// A mark has its position within the increment, and the newest of several latches is the last mark, in any order of
/// the latches: at 1.25 inc per cycle, 1/8 of a cycle before the tenth is 12.5 - 0.15625.
///
/// Proves: MACS-VM-07
#[test]
fn the_newest_latch_is_the_mark_to_its_fraction() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("pulsacc", -1), ("setsys_15", 1_250), ("vmencmtyp", 22)]);
    rig.run(8);
    let latch = |age_ns| Latch { object: Object::Io(1), edge: Edge::Rising, age_ns: Some(age_ns), position: None };
    rig.plant.add_latch(latch(125_000));
    rig.plant.add_latch(latch(900_000));
    rig.run(1);
    assert_eq!(raw(&rig, VIRTUAL), 25 << 31);
    let mark = rig.machine.state.leads.virtual_mark.map(|mark| mark.to_f64());
    assert_eq!((mark, rig.int("machine.vmaster.index.count")), (Some(12.5 - 0.156_25), 2));
    assert_eq!(rig.int("machine.vmaster.index.position"), 12);
}

/// A slot reads the values of the last cycle, a sum the present ones.
#[test]
fn functions_and_sums_read_it() {
    let masters = vec![master("sum", &[VIRTUAL], &[Leader::Encoder(0)])];
    let slots = vec![copying(VIRTUAL, SinkConfig::Memory(0))];
    let memory = vec![MemoryConfig { name: "m".into(), kind: MemoryKind::I64, initial: 0.0 }];
    let mut rig = enabled(MachineConfig { masters, slots, memory, ..cell() });
    set(&mut rig, &[("pulsacc", -1), ("setsys_15", 3_000)]);
    rig.give(start(0));
    for _ in 0..50 {
        let before = rig.int("machine.vmaster.position");
        rig.run(1);
        assert_eq!((rig.int("m"), rig.int("sum.position"), rig.int("sum.valid")), (before, before + 3, 1));
    }
}

#[test]
fn a_state_that_the_parameters_do_not_make_is_refused() {
    let mut rig = enabled(cell());
    set(&mut rig, &[("pulsacc", 1_000), ("vmenctyp", 300), ("pulsvel", 0)]);
    let restored = |rig: &Rig| {
        let image = postcard::to_allocvec(rig.machine.state()).unwrap();
        Machine::restore(cell(), postcard::from_bytes(&image).unwrap()).err()
    };
    assert_eq!(restored(&rig), None);
    rig.machine.state.panel.parameters.pulsacc = 0;
    assert_eq!(restored(&rig), Some(StateError::VirtualMaster));
    assert_eq!(Code::VIRTUAL_MASTER_SOURCE.0, 10_035);
}

#[derive(Clone, Debug)]
enum RandomEvent {
    Set(Vec<(&'static str, i64)>),
    Move(u16, i64),
    Couple(u16),
    Abort,
    Wait(u64),
}

fn random_event() -> impl Strategy<Value = RandomEvent> {
    let value = prop_oneof![
        (-90_000_i64..90_000).prop_map(|value| ("pulsvel", value)),
        prop::sample::select(vec![-1_i64, 0, 10, 5_000, 300_000, 80_000_000]).prop_map(|value| ("pulsacc", value)),
        (-90_000_i64..90_000).prop_map(|value| ("setsys_15", value)),
        prop::sample::select(vec![0_i64, 100, 200, 300, 100_300]).prop_map(|value| ("vmenctyp", value)),
        prop::sample::select(vec![0_i64, 7, 500]).prop_map(|value| ("vmencres", value)),
        prop::sample::select(vec![0_i64, 1, 22, 33]).prop_map(|value| ("vmencmtyp", value)),
    ];
    prop_oneof![
        4 => prop::collection::vec(value, 1..4).prop_map(RandomEvent::Set),
        2 => (0_u16..3, -20_000_i64..20_000).prop_map(|(axis, place)| RandomEvent::Move(axis, place)),
        1 => (0_u16..3).prop_map(RandomEvent::Couple),
        1 => Just(RandomEvent::Abort),
        4 => (1_u64..60).prop_map(RandomEvent::Wait),
    ]
}

proptest! {
    #![proptest_config(cases(24))]

    /// With any commands: each cycle changes the velocity by at most its ramp, if it has one and is not ended; its
    /// changes add up to its position; and a machine that was restored in between gives the same results.
    ///
    /// Proves: MACS-VM-02, MACS-VM-03
    #[test]
    fn changes_add_up_to_position_and_keep_the_ramp(
        happenings in prop::collection::vec(random_event(), 1..40),
        restored in 0_usize..40,
    ) {
        let mut rig = enabled(cell());
        let mut before = rig.machine.state.leads.virtual_master;
        for (place, happening) in happenings.into_iter().enumerate() {
            if place == restored {
                rig.mirror();
            }
            let (mut action, mut cycles) = (None, 0);
            match happening {
                RandomEvent::Set(values) => action = Some(sets(&values)),
                RandomEvent::Move(axis, place) => action = Some(Action::Move(to(axis, place))),
                RandomEvent::Couple(axis) => action = Some(Action::Synchronize(couple(axis, VIRTUAL, 1, 1))),
                RandomEvent::Abort => action = Some(Action::Abort),
                RandomEvent::Wait(count) => cycles = count,
            }
            while action.is_some() || cycles > 0 {
                match action.take() {
                    Some(action) => drop(rig.give(action)),
                    None => {
                        rig.run(1);
                        cycles -= 1;
                    }
                }
                let now = rig.machine.state.leads.virtual_master;
                prop_assert_eq!(before.position + now.change, now.position);
                prop_assert_eq!(rig.int("machine.vmaster.position"), now.position.floor());
                prop_assert_eq!(rig.real("machine.vmaster.fraction"), now.position.fraction());
                prop_assert_eq!(rig.real("machine.vmaster.velocity"), now.velocity);
                let most = parameters(&rig).pulsacc as f64 / 1e3;
                match rig.machine.state.virtual_master.source() {
                    VirtualSource::Off => prop_assert_eq!((now.velocity, now.change.raw()), (0.0, 0)),
                    VirtualSource::Direct => prop_assert_eq!(now.velocity, parameters(&rig).setsys_15 as f64),
                    _ => prop_assert!((now.velocity - before.velocity).abs() <= most + 1e-6),
                }
                // A change equals the velocity to the unit of 2^-32 inc.
                prop_assert!((now.change.to_f64() - now.velocity / 1e3).abs() < 1e-9);
                before = now;
            }
        }
    }
}
