//! Cells with randomly linked slots, with random events.

use super::programs::{WILD, module};
use super::{DISC, cell, field, with};
use crate::command::{Action, RunFunction};
use crate::config::{Line, MachineConfig, ProgramConfig, SinkConfig, SlotConfig, SourceConfig, TableConfig};
use crate::function::{Kind, OnAxisError, Order, Quantity, Requirement, TYPES, Width};
use crate::machine::tests::rig::{LINE, Rig, X, Y, at, cases, couple};
use crate::object::{AxisSet, Leader, Object};
use crate::sim::{Fixtures, Index};
use crate::table::{Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

/// Choices for one slot, as numbers that are reduced to the available options.
#[derive(Clone, Debug)]
struct Choice {
    kind: usize,
    source: usize,
    sink: usize,
    lines: [usize; 4],
    widths: [usize; 2],
    factor: u32,
    resets: bool,
    window: usize,
}

fn choice() -> impl Strategy<Value = Choice> {
    let n = || 0_usize..64;
    let lines = (n(), n(), n(), n()).prop_map(|(a, b, c, d)| [a, b, c, d]);
    let rest = (0_usize..3, 0_usize..3, 1_u32..4, any::<bool>(), 1_usize..40);
    (0..TYPES.len(), n(), n(), lines, rest).prop_map(|(kind, source, sink, lines, (a, b, factor, resets, window))| {
        Choice { kind, source, sink, lines, widths: [a, b], factor, resets, window }
    })
}

/// Returns a cell of these slots; a slot whose choice is already in use omits it.
fn linked(choices: &[Choice]) -> MachineConfig {
    let mut sinks = vec![SinkConfig::Axis(X), SinkConfig::Axis(DISC), SinkConfig::Output(2)];
    sinks.extend((0..4).map(SinkConfig::Memory));
    let mut outputs = vec![Object::Io(1), Object::Memory(4)];
    let count = choices.len();
    let slots = choices.iter().enumerate().map(|(place, choice)| {
        let row = &TYPES[choice.kind];
        let mut slot = SlotConfig::new(format!("f{place}"), place as u16 * 3, row.kind);
        slot.source = match choice.source % 9 {
            0 => SourceConfig::Lead(Leader::AxisCommand(LINE)),
            1 => SourceConfig::Lead(Leader::AxisActual(Y)),
            2 => SourceConfig::Lead(Leader::Encoder(0)),
            3 => SourceConfig::Signal("w".into()),
            4 => SourceConfig::Signal("d".into()),
            5 => SourceConfig::Signal("r".into()),
            6 => SourceConfig::Signal("y.following_error".into()),
            _ => SourceConfig::Lead(Leader::Sink((choice.source % count) as u16)),
        };
        if row.kind == Kind::Imes {
            slot.source = SourceConfig::Lead(Leader::Encoder(0));
        }
        if row.source == Requirement::Never {
            slot.source = SourceConfig::None;
        }
        let at = choice.sink % sinks.len().max(1);
        let fits = |sink: &SinkConfig| match sink {
            SinkConfig::Axis(axis) => row.moves_axes && (row.quantity != Quantity::Speed || *axis == DISC),
            _ => row.sink != Requirement::Never,
        };
        if sinks.get(at).is_some_and(fits) {
            slot.sink = sinks.remove(at);
        }
        for (nth, line) in choice.lines.iter().enumerate() {
            if nth < row.inputs {
                let object = [Object::Io(0), Object::Io(3), Object::Memory(4)][line % 3];
                slot.inputs[nth] = Some(Line { object, inverted: line % 2 == 0 });
            }
            if nth < row.outputs && line % 5 == 0 && !outputs.is_empty() {
                slot.outputs[nth] = Some(Line { object: outputs.remove(0), inverted: line % 2 == 1 });
            }
        }
        slot.tables[0] = (row.tables > 0 && choice.lines[0] % 4 != 0).then_some(0);
        if row.runs_program {
            (slot.program, slot.fuel) = (Some(0), 4000);
            slot.values[0] = i64::from(choice.factor);
        }
        for (nth, word) in slot.words.iter_mut().take(row.words.len()).enumerate() {
            *word = (choice.lines[1] >> nth & 1 == 0).then(|| ["w", "d"][nth].into());
        }
        let width = |nth: usize| [Width::W16, Width::W32, Width::W64][choice.widths[nth]];
        (slot.source_width, slot.sink_width) = (width(0), width(1));
        slot.factor = choice.factor;
        slot.on_axis_error = if choice.resets { OnAxisError::Reset } else { OnAxisError::Run };
        slot.room.mean = choice.window;
        interpolate(&mut slot, choice.window);
        let values: &[(&str, i64)] = match row.kind {
            Kind::Fipw | Kind::Fipz | Kind::Xfipw => &[],
            Kind::Dfkt => &[
                ("table_count", 7),
                ("div", 7),
                ("mult", 7),
                ("in_resolution", 7),
                ("in_final", 7),
                ("out_max", 7),
                ("ratio_max", 7),
                ("ratio_div", 7),
            ],
            // 30 inc per cycle, with an acceleration of 3 and a deceleration of 9.
            Kind::Epos => &[
                ("travel", 700),
                ("velocity", 18_000_000),
                ("acceleration", 3_000_000),
                ("stop_decel", 9_000_000),
                ("drive_resolution", 1000),
                ("master_resolution", 1000),
            ],
            _ => row.example,
        };
        for (name, value) in values {
            let (_, place) = row.find(name).expect("a field");
            slot.values[place] = *value;
        }
        slot
    });
    let mut config = cell(slots.collect());
    config.programs = vec![ProgramConfig { name: "wild".into(), module: module(WILD) }];
    let curve = Table::new(Form::Y, &[], &[0, 40, -25, 90]).expect("points");
    config.tables.push(TableConfig { name: "c".into(), table: Arc::new(curve) });
    // Long enough for the cams and points that the values below may count.
    let words: Vec<i64> =
        (0..96).map(|word| if word == 0 { 3 } else { i64::from(word % 7 == 4) * word * 10 }).collect();
    config.tables[0].table = Arc::new(Table::new(Form::Words, &[], &words).expect("words"));
    config
}

/// Sets values with which an interpolator starts.
fn interpolate(slot: &mut SlotConfig, choice: usize) {
    let modes = [2, 26, 4, 132];
    let mode = modes[choice % 4];
    let (way, time) = if choice % 4 < 2 { (150, 0) } else { (0, 30) };
    let values: &[(&str, i64)] = match slot.kind {
        Kind::Fipw => &[("mode", mode), ("table_count", 1), ("increments_per_rev", way), ("cycle_time", time)],
        Kind::Xfipw => &[("ba", mode), ("tables_total", 1), ("incr_per_rev", way), ("cycle_time", time)],
        Kind::Fipz => &[("mode", 16), ("table_count", 1), ("cycle_time", 30)],
        _ => return,
    };
    slot.tables[..3].fill(Some(1));
    for (name, value) in values.iter().chain(&[("mult", 1)]) {
        slot.values[usize::from(field(slot.kind, name))] = *value;
    }
}

#[derive(Clone, Debug)]
enum RandomEvent {
    Order(usize, Order, Vec<(usize, i64)>),
    Run(usize, i64),
    /// Cancels the goal that was given this many goals ago.
    Cancel(usize),
    Memory(u16, i64),
    Input(u8),
    Line(i64),
    Encoder(i64),
    Table(Vec<i64>),
    Program(bool),
    Axes(u8),
    Mirror,
    Cycles(u64),
}

fn random_event() -> impl Strategy<Value = RandomEvent> {
    let orders =
        [Order::Start, Order::Start, Order::Start, Order::Reset, Order::ValueNew, Order::ReadValue, Order::Stage];
    let value = prop_oneof![5 => 0_i64..4, 3 => -20_000_i64..20_000, 1 => any::<i64>()];
    let values = prop::collection::vec((0_usize..40, value), 0..4);
    let word = prop_oneof![2 => 0_i64..300, 1 => -32_768_i64..65_536];
    prop_oneof![
        8 => (0_usize..16, prop::sample::select(orders.to_vec()), values).prop_map(|(slot, order, values)| RandomEvent::Order(slot, order, values)),
        3 => (0_usize..16, -900_i64..900).prop_map(|(slot, travel)| RandomEvent::Run(slot, travel)),
        1 => (1_usize..4).prop_map(RandomEvent::Cancel),
        3 => (0_u16..5, prop_oneof![-200_i64..200, any::<i64>()]).prop_map(|(cell, value)| RandomEvent::Memory(cell, value)),
        3 => any::<u8>().prop_map(RandomEvent::Input),
        2 => (-60_000_i64..60_000).prop_map(RandomEvent::Line),
        2 => (-40_000_i64..40_000).prop_map(RandomEvent::Encoder),
        1 => prop::collection::vec(word, 1..100).prop_map(RandomEvent::Table),
        1 => any::<bool>().prop_map(RandomEvent::Program),
        1 => any::<u8>().prop_map(RandomEvent::Axes),
        1 => Just(RandomEvent::Mirror),
        6 => (1_u64..40).prop_map(RandomEvent::Cycles),
    ]
}

/// Checks that a function in RESET holds its sink, except that a speed is 0 then, and that a power cycle is allowed.
fn run(rig: &mut Rig, cycles: u64) {
    for _ in 0..cycles {
        check_sinks(rig, None, |rig| rig.run(1));
    }
}

/// Does the same during an action that may start this slot.
fn check_sinks<T>(rig: &mut Rig, starts: Option<usize>, act: impl FnOnce(&mut Rig) -> T) -> T {
    let slots = rig.machine.slots().iter().enumerate();
    let before: Vec<_> = slots.map(|(at, slot)| (slot.sink(), slot.is_active() || starts == Some(at))).collect();
    let result = act(rig);
    for (((before, ran), slot), config) in before.into_iter().zip(rig.machine.slots()).zip(&rig.machine.config().slots)
    {
        let is_speed = config.kind.description().quantity == Quantity::Speed && slot.sink() == 0;
        let resets = config.on_axis_error == OnAxisError::Reset;
        let has_program = config.kind.description().runs_program;
        // An error of its axis ends the function after its call of that cycle, even the first one. A program is then
        // called with RESET in the next cycle.
        let may_have_moved = is_speed || ran && (resets || has_program) || resets && has_program;
        assert!(
            slot.is_active() || slot.sink() == before || may_have_moved,
            "{:?} moved its sink in RESET",
            config.kind
        );
    }
    result
}

fn apply_event(rig: &mut Rig, what: &RandomEvent, goals: &mut Vec<u64>) {
    let count = rig.machine.slots().len();
    let axes = AxisSet::first(rig.machine.config().axes.len());
    match what {
        RandomEvent::Order(slot, order, values) => {
            let slot = slot % count;
            let row = rig.machine.config().slots[slot].kind.description();
            let values: Vec<_> = values.iter().map(|(place, value)| ((place % row.width()) as u16, *value)).collect();
            let before = rig.machine.slots()[slot].staged().to_vec();
            let starts = (*order == Order::Start).then_some(slot);
            let given = check_sinks(rig, starts, |rig| rig.give(with(slot as u16, *order, &values)));
            if rig.answer(given).is_err() {
                assert_eq!(rig.machine.slots()[slot].staged(), before, "a refused set was taken");
            }
        }
        RandomEvent::Run(slot, travel) => {
            let slot = (slot % count) as u16;
            let values = [(field(Kind::Epos, "travel"), *travel)];
            let takes = rig.machine.config().slots[usize::from(slot)].kind.description().takes_goals;
            let values = if takes { values.into() } else { [].into() };
            let given =
                check_sinks(rig, Some(slot.into()), |rig| rig.give(Action::RunFunction(RunFunction { slot, values })));
            assert!(takes || rig.answer(given).is_err());
            if rig.answer(given).is_ok() {
                goals.push(given);
            }
        }
        RandomEvent::Cancel(back) => {
            if let Some(&goal) = goals.len().checked_sub(*back).and_then(|place| goals.get(place)) {
                rig.give(Action::Cancel { goal });
            }
        }
        RandomEvent::Memory(index, value) => {
            rig.give(Action::set_memory(*index, *value as f64));
        }
        RandomEvent::Input(bits) => {
            rig.plant.set_digital(0, bits & 1 == 1);
            rig.plant.set_digital(1, bits & 2 == 2);
        }
        RandomEvent::Line(velocity) => {
            rig.give(Action::Move(at(LINE, *velocity as f64)));
        }
        RandomEvent::Encoder(by) => rig.plant.slip_encoder(0, *by),
        RandomEvent::Table(words) => {
            let table = Arc::new(Table::new(Form::Words, &[], words).expect("words"));
            rig.give(Action::LoadTable { index: 0, table });
        }
        RandomEvent::Program(keeps) => {
            rig.give(Action::LoadProgram { index: 0, module: module(WILD), keeps: *keeps });
        }
        RandomEvent::Axes(choice) => {
            rig.give(match choice % 7 {
                0 | 1 => Action::Enable(axes),
                2 => Action::Disable(axes),
                3 => Action::ResetErrors(axes),
                4 => Action::Halt(axes),
                5 => Action::Synchronize(couple(Y, Leader::Sink((usize::from(*choice) % count) as u16), 1, 3)),
                _ => Action::Deactivate,
            });
        }
        RandomEvent::Mirror => rig.mirror(),
        RandomEvent::Cycles(cycles) => run(rig, *cycles),
    }
    run(rig, 1);
}

proptest! {
    #![proptest_config(cases(64))]

    /// Proves: AMK-GEN-04, AMK-BCOM-02
    #[test]
    fn whatever_happens_to_slots_that_are_linked_at_random_is_the_same_after_a_restore(
        choices in prop::collection::vec(choice(), 1..12),
        happenings in prop::collection::vec(random_event(), 1..60),
    ) {
        let mut rig = Rig::of(linked(&choices));
        let index = Some(Index { every: 500, at: 300 });
        rig.plant.drive(0).expect("the drive of x").install_fixtures(Fixtures { index, ..Fixtures::default() });
        let mut goals = Vec::new();
        happenings.iter().for_each(|what| apply_event(&mut rig, what, &mut goals));
        run(&mut rig, 70);
        // Each goal ends once, at the latest with its function.
        for slot in 0..choices.len() as u16 {
            rig.give(with(slot, Order::Reset, &[]));
        }
        rig.run(2);
        for goal in goals {
            prop_assert_eq!(rig.done(goal).len(), 1, "{}", goal);
        }
        // The copy of a cycle is complete.
        let mut copy = crate::machine::Machine::new(linked(&choices)).expect("a machine").state().clone();
        copy.clone_from(rig.machine.state());
        let bytes = |state| postcard::to_allocvec(state).expect("a state has a form");
        prop_assert!(bytes(&copy) == bytes(rig.machine.state()));
    }
}
