//! Cell for random commands: travel ranges, contacts, outputs and drives.

use crate::axis::{BrakeConfig, Safety};
use crate::command::{Action, OutputValue};
use crate::config::{IoConfig, IoKind, MachineConfig, TableConfig};
use crate::drive::Interface;
use crate::regulator::Law;
use crate::sim::{Fixtures, Index, Model, TwoSpeed, VelocityLag};
use crate::table::{CamSetting, Form, Interpolation, Table};
use proptest::prelude::*;
use std::sync::Arc;

/// Adds two contacts of the cell, i_break, two outputs and the output of a brake of x.
pub(super) fn terminals(config: &mut MachineConfig, is_braked: bool) {
    let inputs = ["estop", "door", "break"].map(|name| (name, IoKind::DigitalInput));
    let outputs = ["lamp", "fan", "brake"].map(|name| (name, IoKind::DigitalOutput));
    let io = inputs.into_iter().chain(outputs);
    config.io = io.map(|(name, kind)| IoConfig { name: name.into(), kind, latch: false }).collect();
    config.safety = Safety { estop: Some(0), interlock: Some(1) };
    config.global.parameters.i_break = 3;
    config.global.parameters.o_error = 1;
    let (release_ns, engage_ns) = (20_000_000, 15_000_000);
    let brake = BrakeConfig { output: 5, closes_with_one: false, release_ns, engage_ns };
    config.axes[1].brake = Some(brake).filter(|_| is_braked);
}

pub(super) fn output() -> impl Strategy<Value = Action> {
    let value = prop::sample::select(vec![0.0, 1.0, 2.0, f64::INFINITY, f64::NAN]);
    let output = (0_u16..7, value).prop_map(|(index, value)| OutputValue { index, value });
    prop::collection::vec(output, 1..4).prop_map(|values| Action::SetOutputs(values.into()))
}

/// Returns the switches along the travel of x and y.
pub(super) fn fixtures() -> Fixtures {
    Fixtures {
        start: 0,
        index: Some(Index { every: 2_000, at: 300 }),
        home: Some((2_000, 4_000)),
        negative: Some(-70_000),
        positive: Some(70_000),
    }
}

pub(super) fn interface() -> impl Strategy<Value = Interface> {
    prop::sample::select(&[Interface::Position, Interface::Velocity, Interface::OpenLoop][..])
}

pub(super) fn law() -> impl Strategy<Value = Law> {
    prop::sample::select(&Law::ALL[..])
}

/// Any direction polarity; with interface position only that of the units.
pub(super) fn posdrct() -> impl Strategy<Value = i64> {
    prop::sample::select(vec![1_i64, -1, 2, -2])
}

/// Returns a drive model that matches the interface.
pub(super) fn model(interface: Interface) -> Model {
    let ms = 1_000_000;
    match interface {
        Interface::Velocity => Model::Velocity(VelocityLag::new(5 * ms, 1_000_000).unwrap()),
        Interface::OpenLoop => Model::TwoSpeed(TwoSpeed::new(50 * ms, 100 * ms, 1_000_000).unwrap()),
        _ => Model::Ideal,
    }
}

/// Number of tables.
pub(super) const TABLES: u16 = 4;

/// Returns a cam that feeds, one that goes out and back, or one with an end.
pub(super) fn table(number: u16) -> Arc<Table> {
    let table = match number {
        0 => Table::new(Form::Xy, &[0, 1000, 1600, 4000], &[0, 300, 1700, 2500]),
        1 => Table::new(Form::Xy, &[0, 2000, 5000], &[-40, 3000, -40]),
        // This cam passes its last value earlier, and rests on it at its end.
        2 => Table::new(Form::Xy, &[0, 1000, 2000, 3900, 4000], &[0, 2600, -300, 2000, 2000]),
        _ => Table::new(Form::Xy, &[0, 3000, 3001, 4000], &[0, 100, 900, 2000]),
    };
    let interpolation = if number == 1 { Interpolation::Cubic } else { Interpolation::Linear };
    let setting = CamSetting { length: None, is_cyclic: number < 2, interpolation };
    Arc::new(table.expect("points").with_cam(setting))
}

/// Returns the pitch error of a screw, within one revolution of y.
pub(super) fn screw() -> TableConfig {
    let points = Table::new(Form::Xy, &[0, 5_000, 10_000], &[0, 200, -100]).expect("points");
    TableConfig { name: "screw".into(), table: Arc::new(points) }
}

pub(super) fn tables() -> Vec<TableConfig> {
    (0..TABLES).map(|number| TableConfig { name: format!("cam{number}"), table: table(number) }).collect()
}
