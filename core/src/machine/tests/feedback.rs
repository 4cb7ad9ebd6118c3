//! Position sources: encoders that are absolute, shared, replaced, disturbed or cut.

mod cable;
mod disturbed;
mod kept;
mod marks;
mod pulses;
mod shared;
mod sources;
mod words;
mod zeros;

use super::rig::{Rig, X, config};
use crate::axis::Wired;
use crate::command::{Action, SetPosition};
use crate::config::MachineConfig;
use crate::drive::Interface;
use crate::encoder::{Absolute, Form, WordCode};
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use crate::position::Length;

/// The loop of x is closed in the core.
fn velocity_config() -> MachineConfig {
    let mut config = config(0);
    config.axes[1].interface = Interface::Velocity;
    config.axes[1].parameters.max_following_error = 20_000;
    config
}

/// The loops of x and y are closed in the core, and both use the encoder of the belt; x moves it.
fn shared_config() -> MachineConfig {
    let mut config = velocity_config();
    config.axes[2].interface = Interface::Velocity;
    config.axes[2].parameters.max_following_error = 1 << 40;
    for axis in [1, 2] {
        config.axes[axis].wired = Wired::Encoder(0);
    }
    config
}

fn gray(steps: u32, turns: u32) -> Absolute {
    Absolute { turns, code: WordCode::Gray, ..Absolute::single_turn(steps) }
}

/// Returns a rig in which x has an absolute encoder with MACS error correction.
fn corrected() -> Rig {
    let mut config = velocity_config();
    config.axes[1].wired = Wired::Drive(Form::Absolute(Absolute { turns: 4096, ..gray(8192, 1) }));
    config.axes[1].parameters.encoder.encodertype = 3;
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn change(axis: u16, key: &str, value: i64) -> Change {
    Change { axis, row: Row::find(key).unwrap_or_else(|| panic!("no row {key}")).0, value: Value::Int(value) }
}

fn set(rig: &mut Rig, changes: &[(&str, i64)]) -> u64 {
    let changes = changes.iter().map(|(key, value)| change(X, key, *value)).collect();
    rig.give(Action::SetParameters(changes))
}

fn off(rig: &mut Rig, axis: u16) {
    rig.give(Action::Disable(AxisSet::one(axis)));
    rig.run(5);
}

fn zero(axis: u16, position: i64) -> Action {
    Action::SetPosition(SetPosition { axis, position: Length::whole(position) })
}

/// Returns a rig in which x runs at the returned velocity (inc/s), on an encoder that y, which is off, also reads.
pub(super) fn moving_zero() -> (Rig, f64) {
    let mut rig = Rig::of(shared_config());
    rig.run(2);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(40);
    rig.give(Action::Move(super::rig::at(X, 20_000.0)));
    rig.run(200);
    (rig, 20_000.0)
}

fn error(rig: &Rig) -> i64 {
    rig.int("x.error")
}
