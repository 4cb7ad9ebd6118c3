//! Data of functions and tables outside the cycle: their sets and values in images.

use super::rig::Rig;
use crate::command::{Action, CommandFunction};
use crate::config::{MachineConfig, MemoryConfig, MemoryKind, SinkConfig, SlotConfig, TableConfig};
use crate::function::{Kind, Order};
use crate::parameter::Sets;
use crate::table::{Form, Table};
use std::sync::Arc;

fn table(words: &[i64]) -> Arc<Table> {
    Arc::new(Table::new(Form::Words, &[], words).expect("a sound table"))
}

/// Function `choose` of memory cell `feed`, and a table without users.
fn config() -> MachineConfig {
    let mut slot = SlotConfig::new("choose".into(), 0, Kind::Ecopy);
    slot.sink = SinkConfig::Memory(0);
    MachineConfig {
        memory: vec![MemoryConfig { name: "feed".into(), kind: MemoryKind::I32, initial: 0.0 }],
        tables: vec![TableConfig { name: "t".into(), table: table(&[1, 2]) }],
        slots: vec![slot],
        ..super::rig::config(0)
    }
}

fn order(order: Order, values: &[(u16, i64)]) -> Action {
    Action::CommandFunction(CommandFunction { slot: 0, order, values: values.into() })
}

#[test]
fn an_image_has_both_sets_of_each_function_and_its_version_grows_with_them() {
    let mut rig = Rig::of(config());
    let mut image = rig.machine.parameter_image();
    let mut is_new = |rig: &Rig, staged: [i64; 3], active: [i64; 3]| {
        let is_new = image.version != rig.machine.parameter_version();
        rig.machine.copy_parameters(&mut image);
        assert_eq!(image.functions, [Sets { staged: staged.into(), active: active.into() }]);
        assert_eq!(image, rig.machine.parameter_image());
        is_new
    };
    assert!(!is_new(&rig, [0; 3], [0; 3]));
    rig.give(order(Order::Stage, &[(0, 3), (1, 5)]));
    assert!(is_new(&rig, [3, 5, 0], [0; 3]));
    rig.give(order(Order::Start, &[]));
    assert!(is_new(&rig, [3, 5, 0], [3, 5, 0]));
    // Mode is not a live value.
    rig.give(order(Order::ValueNew, &[(0, 1), (2, -1)]));
    assert!(is_new(&rig, [1, 5, -1], [3, 5, -1]));
    // Values that are given together with READ_VALUE are staged, too.
    rig.give(order(Order::ReadValue, &[(2, 8)]));
    assert!(is_new(&rig, [1, 5, 8], [3, 5, -1]));
    rig.give(order(Order::ReadValue, &[]));
    assert!(!is_new(&rig, [1, 5, 8], [3, 5, -1]));
    let refused = rig.give(order(Order::ValueNew, &[(1, 6), (0, 4)]));
    assert_eq!(rig.refusal(refused), "choose: mode is 4; 0 to 3 is allowed");
    assert!(!is_new(&rig, [1, 5, 8], [3, 5, -1]));
    rig.give(order(Order::Reset, &[]));
    is_new(&rig, [1, 5, 8], [3, 5, -1]);
    // The set of the cell is in force again.
    rig.give(Action::PowerCycle);
    assert!(is_new(&rig, [0; 3], [0; 3]));
}

#[test]
fn an_image_shares_the_tables_that_were_loaded() {
    let mut rig = Rig::of(config());
    let mut image = rig.machine.parameter_image();
    let first = Arc::clone(&image.tables[0]);
    let second = table(&[3, 4, 5]);
    rig.give(Action::LoadTable { index: 0, table: Arc::clone(&second) });
    assert_ne!(image.version, rig.machine.parameter_version());
    rig.machine.copy_parameters(&mut image);
    assert!(Arc::ptr_eq(&image.tables[0], &second) && !Arc::ptr_eq(&first, &second));
}
