//! Machines with any number of slots of one type.

use super::{Shop, axis};
use lineshaft_core::command::{Action, CommandFunction};
use lineshaft_core::config::{
    EncoderConfig, IoConfig, IoKind, Line, MachineConfig, ProgramConfig, SinkConfig, SlotConfig, SourceConfig,
    TableConfig,
};
use lineshaft_core::encoder::Form;
use lineshaft_core::function::{Description, Kind, MemorySize, Order, Requirement};
use lineshaft_core::object::{Leader, Object};
use lineshaft_core::table::{Form as Numbering, Table};
use lineshaft_core::unit::Scale;
use lineshaft_program::Module;
use std::sync::Arc;

/// Usual values, by the names of their fields.
const VALUES: [(&str, i64); 34] = [
    ("m1", 12_345),
    ("sak", 4032),
    ("spacing", 10_000),
    ("tracks", 4),
    ("modulo", 20_000),
    ("aw_mask", 3),
    ("value_e1_0", 5),
    ("mean_n", 10),
    ("cams", 2),
    ("table_count", 1),
    ("active_table", 1),
    ("div", 1000),
    ("mult", 700),
    ("in_resolution", 20_000),
    ("in_final", 2000),
    ("out_max", 4000),
    ("out_min", -4000),
    ("ratio_max", 2),
    ("ratio_min", -2),
    ("ratio_div", 1),
    ("cycle_increments", 20_000),
    ("accel", 1_000_000),
    ("switch_mask", 7),
    ("kp", 512),
    ("ki", 128),
    ("kd", 64),
    ("y_max", 10_000_000),
    ("gain_v", 1000),
    ("i_max", 1_000_000),
    ("travel", 2_000_000_000),
    ("velocity", 1_000_000),
    ("acceleration", 200_000),
    ("stop_decel", 800_000),
    ("drive_resolution", 20_000),
];

/// Settings of interpolators, which read a curve.
const CURVES: [(Kind, [(&str, i64); 4]); 3] = [
    (Kind::Fipw, [("mode", 2), ("mult", 1), ("table_count", 1), ("increments_per_rev", 20_000)]),
    (Kind::Fipz, [("mode", 16), ("mult", 1), ("table_count", 1), ("cycle_time", 10_000)]),
    (Kind::Xfipw, [("ba", 2), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 20_000)]),
];

/// Programs by the names of their rows: speed from a foreign encoder (AMK-APSF-46), a filter of 200 taps, an empty
/// program.
pub(crate) const PROGRAMS: [(&str, Option<&[u8]>); 3] = [
    ("apsf", Some(include_bytes!("../../../launch-configs/functions/programs/fb10.wasm"))),
    ("apsf_fir", Some(include_bytes!("../../../launch-configs/functions/programs/fir.wasm"))),
    ("apsf_empty", None),
];

const EMPTY: &str = "(module (memory 1) (global (export \"image\") i32 (i32.const 16)) \
                     (data (i32.const 16) \"\\b0\\03\") (func (export \"cycle\")))";

/// Returns the program of that row, FB10 for any other type.
fn program(name: &str) -> Module {
    let found = PROGRAMS.iter().find(|(known, _)| *known == name).unwrap_or(&PROGRAMS[0]).1;
    let empty = || wat::parse_str(EMPTY).expect("a module");
    Module::load(&found.map_or_else(empty, <[u8]>::to_vec)).expect("it is taken")
}

/// Returns a machine with slots of that type, or of type apsf with a program of that name.
pub(crate) fn named(name: &str, count: u16, is_started: bool) -> Option<Shop> {
    let kind = if name.starts_with("apsf") { "apsf" } else { name };
    let row = Kind::find(kind)?.description();
    Some(with(row, count, is_started, program(name)))
}

/// Returns a machine with such slots, each with one input if the type has inputs, and without outputs; started if
/// requested.
pub(crate) fn slots(row: &Description, count: u16, is_started: bool) -> Shop {
    with(row, count, is_started, program(row.name))
}

fn with(row: &Description, count: u16, is_started: bool, module: Module) -> Shop {
    // Points of a binea, or cams: 2500 and 10000..11000.
    let words: Vec<i64> =
        (0..48).map(|word| [3, 0, 0, 0, 2500, 0, 1, 0, 20_000].get(word).copied().unwrap_or(0)).collect();
    let table = Table::new(Numbering::Words, &[], &words).expect("words");
    let points: Vec<i64> = (0..100).map(|point| point * 200).collect();
    let curve = Table::new(Numbering::Y, &[], &points).expect("points");
    let slot = |number: u16| {
        let mut slot = SlotConfig::new(format!("f{number}"), number, row.kind);
        if row.source != Requirement::Never && row.kind != Kind::Sidiff {
            slot.source = SourceConfig::Lead(Leader::Encoder(0));
        }
        slot.sink = SinkConfig::None;
        slot.inputs[0] = (row.inputs > 0).then_some(Line { object: Object::Io(0), inverted: false });
        slot.tables[0] = (row.tables > 0 && row.kind != Kind::Sidiff).then_some(0);
        slot.program = (row.runs_program).then_some(0);
        slot.room = MemorySize { mean: 64, cams: 0 };
        let has_values = VALUES.iter().any(|(name, _)| row.find(name).is_some());
        for (name, value) in row.example.iter().filter(|_| !has_values).chain(&VALUES) {
            if let Some((_, place)) = row.find(name) {
                slot.values[place] = *value;
            }
        }
        for (name, value) in CURVES.iter().filter(|(kind, _)| *kind == row.kind).flat_map(|(_, values)| values) {
            slot.tables[0] = Some(1);
            if let Some((_, place)) = row.find(name) {
                slot.values[place] = *value;
            }
        }
        if let (Kind::Binea | Kind::Cam | Kind::Dfkt, Some((_, ba))) = (row.kind, row.find("ba")) {
            slot.values[ba] = 1;
        }
        if let (Kind::Fgen, Some((_, time)), Some((_, fct))) = (row.kind, row.find("cycle_time"), row.find("fct")) {
            (slot.values[time], slot.values[fct]) = (4000, 1);
        }
        slot
    };
    let belt =
        EncoderConfig { name: "belt".into(), form: Form::Incremental(16), check: None, scale: Scale::increments() };
    // Axes of bits 0 and 1 of aw_mask; other types need none.
    let axes = if row.find("aw_mask").is_some() { 2 } else { 0 };
    let config = MachineConfig {
        cycle_ns: 1_000_000,
        axes: (0..axes).map(|index| axis(index, None)).collect(),
        io: vec![IoConfig { name: "e1".into(), kind: IoKind::DigitalInput, latch: false }],
        encoders: vec![belt],
        tables: [("t", table), ("c", curve)]
            .map(|(name, table)| TableConfig { name: name.into(), table: Arc::new(table) })
            .into(),
        programs: vec![ProgramConfig { name: "fb10".into(), module: Arc::new(module) }],
        slots: (0..count).map(slot).collect(),
        ..MachineConfig::default()
    };
    let mut shop = Shop::of(config);
    if is_started {
        let start = |slot| Action::CommandFunction(CommandFunction { slot, order: Order::Start, values: [].into() });
        shop.give(&(0..count).map(start).collect::<Vec<_>>());
        assert!(shop.machine.slots().iter().all(|slot| slot.is_active()), "{} refuses its START", row.name);
        if matches!(row.kind, Kind::Fgen | Kind::Epos) {
            // A rising edge of the input starts it.
            shop.set_input();
        }
    }
    shop
}
