//! Homing on a travel range with switches and an index.

mod conditions;
mod edges;
mod ends;
mod in_drive;
mod index;
mod matrix;
mod meetings;
mod selector;
mod travel;
mod vocabularies;
mod zero;

use super::rig::{Rig, X, config};
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::event::{Event, Kind, Number};
use crate::parameter::{AxisParameters, Row, Value};
use crate::sim::{Fixtures, Index, Model};

/// Far outside both ends.
const FAR: i64 = i64::MAX / 4;
/// Positions of the ends of travel, where the limit switches are actuated.
const LEFT_END: i64 = -20_000;
const RIGHT_END: i64 = 20_000;

/// Pulses at 300 + 2000 n, which is a revolution of 500 lines; limit switches at both ends.
fn travel_range(start: i64, home: (i64, i64)) -> Fixtures {
    Fixtures {
        start,
        index: Some(Index { every: 2_000, at: 300 }),
        home: Some(home),
        negative: Some(LEFT_END),
        positive: Some(RIGHT_END),
    }
}

fn assign(p: &mut AxisParameters, key: &str, value: Value) {
    let (_, row) = Row::find(key).unwrap_or_else(|| panic!("no row {key}"));
    assert_eq!(row.assign(p, value), Ok(()), "{key}");
}

/// Returns a cell with 10 inc per cycle to the switch and 1 inc per cycle in the last approach, with one digital input,
/// in which sequences of MACS are allowed.
fn cell(delay: u32) -> MachineConfig {
    let mut config = config(delay);
    config.io = vec![IoConfig { name: "mark".into(), kind: IoKind::DigitalInput, latch: true }];
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "homing.velocity", Value::Real(10_000.0));
    assign(p, "homing.index_velocity", Value::Real(1_000.0));
    assign(p, "homing.max_distance", Value::Int(60_000));
    assign(p, "i_refswitch", Value::Int(1));
    config
}

fn rig_with(config: MachineConfig, model: Model, fixtures: Fixtures) -> Rig {
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    if let Some(drive) = rig.plant.drive(0) {
        drive.install_fixtures(fixtures);
    }
    rig.enable();
    rig
}

fn rig(fixtures: Fixtures) -> Rig {
    rig_with(cell(0), Model::Ideal, fixtures)
}

fn method(number: i64) -> HomingMethod {
    let name = |number: i64| i8::try_from(number).unwrap_or(0);
    if number < 0 { HomingMethod::Macs(name(-1 - number)) } else { HomingMethod::Cia402(name(number)) }
}

fn home(rig: &mut Rig, number: i64) -> u64 {
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: method(number) }))
}

/// Runs until the goal has ended and the axis is at rest. Returns the end of the goal.
fn run_to_end(rig: &mut Rig, sequence: u64) -> Event {
    for _ in 0..100_000 {
        if let [done] = rig.done(sequence)[..]
            && !matches!(rig.state("x"), "HOMING" | "DISCRETE_MOTION")
        {
            return done;
        }
        rig.run(1);
    }
    panic!("homing never ended: phase {}, at {}", rig.int("x.homing.phase"), rig.int("x.actual.position"));
}

/// Returns the position of the axis on its travel range.
fn place(rig: &Rig, start: i64) -> i64 {
    start + rig.int("x.actual.count")
}

/// Returns the position of the zero on the travel range.
fn zero(rig: &Rig, start: i64) -> i64 {
    place(rig, start) - rig.int("x.actual.position")
}

fn homed_events(rig: &Rig) -> Vec<Number> {
    rig.events.iter().filter(|event| event.kind == Kind::Homed).map(|event| event.asked).collect()
}
