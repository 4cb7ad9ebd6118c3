//! Sixty-four slots of all types with random links from a seed: identical bytes in every run, from any state, and no
//! allocation.

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use lineshaft_core::command::{Action, Command, CommandFunction, Commands, Source};
use lineshaft_core::config::{
    AxisConfig, EncoderConfig, IoConfig, IoKind, Line, MachineConfig, MemoryConfig, MemoryKind, ProgramConfig,
    SinkConfig, SlotConfig, SourceConfig, TableConfig,
};
use lineshaft_core::drive::Inputs;
use lineshaft_core::encoder::Form;
use lineshaft_core::function::{Kind, MemorySize, Order, Requirement, TYPES};
use lineshaft_core::machine::{MAX_COMMANDS, Machine};
use lineshaft_core::object::{Leader, Object};
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::table::{Form as Numbering, Table};
use lineshaft_core::unit::Scale;
use lineshaft_program::Module;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const SLOTS: u16 = 64;
const WORDS: u16 = 40;
const BITS: u16 = 40;

/// A random number generator with the same numbers in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

/// Sets an interpolator to one of its movements: endless, at once, in and out, by time.
fn interpolate(slot: &mut SlotConfig, movement: usize) {
    let several = i64::from(movement == 2) + 1;
    let (way, time) = if movement == 3 { (0, 70) } else { (900, 0) };
    let mode = [2, 26, 98, 132][movement];
    let values: &[(&str, i64)] = match slot.kind {
        Kind::Fipw => &[
            ("mode", mode),
            ("table_count", several),
            ("start_tables", several - 1),
            ("increments_per_rev", way),
            ("cycle_time", time),
        ],
        Kind::Xfipw => &[
            ("ba", mode + several % 2),
            ("tables_total", several),
            ("tables_start", several - 1),
            ("incr_per_rev", way),
            ("cycle_time", time),
        ],
        Kind::Fipz => &[("mode", 16), ("table_count", 1), ("cycle_time", 80)],
        _ => return,
    };
    slot.tables[..2].fill(Some(1));
    for (name, value) in values.iter().chain(&[("mult", 3), ("div_exp", 2)]) {
        let (_, place) = slot.kind.description().find(name).expect("a field");
        slot.values[place] = *value;
    }
}

/// Returns the cell of a seed: each type at least four times, with random sources and sinks.
fn cell(numbers: &mut Numbers) -> MachineConfig {
    let memory = |name: String, kind| MemoryConfig { name, kind, initial: 0.0 };
    let words = (0..WORDS).map(|n| memory(format!("w{n}"), if n % 2 == 0 { MemoryKind::I16 } else { MemoryKind::I32 }));
    let bits = (0..BITS).map(|n| memory(format!("b{n}"), MemoryKind::Bit));
    let io = |n: u16| IoConfig { name: format!("e{n}"), kind: IoKind::DigitalInput, latch: false };
    // Two points of a binea; cams and thresholds of zeros.
    let table: Vec<i64> =
        (0..64).map(|word| [3, 0, 0, 0, 2500, 0, 1, 0, 20_000, 0, 2].get(word).copied().unwrap_or(0)).collect();
    let table = Table::new(Numbering::Words, &[], &table).expect("words");
    let curve = Table::new(Numbering::Y, &[], &[0, 300, -200, 1700]).expect("points");
    let wild = wat::parse_str(include_str!("programs/wild.wat")).expect("a module");
    let wild = Module::load(&wild).expect("it is taken");
    let (mut free_words, mut free_bits) = ((0..WORDS).collect::<Vec<_>>(), (0..BITS).collect::<Vec<_>>());
    let slots = (0..SLOTS).map(|number| {
        let row = &TYPES[usize::from(number) % TYPES.len()];
        let mut slot = SlotConfig::new(format!("f{number}"), number, row.kind);
        let source = match numbers.below(3) {
            0 => SourceConfig::Lead(Leader::Encoder(0)),
            1 => SourceConfig::Lead(Leader::Sink(numbers.below(SLOTS.into()) as u16)),
            _ => SourceConfig::Signal(format!("w{}", numbers.below(WORDS.into()))),
        };
        slot.source = match (row.source, row.kind) {
            (Requirement::Never, _) => SourceConfig::None,
            (_, Kind::Imes) => SourceConfig::Lead(Leader::Encoder(0)),
            _ => source,
        };
        if row.sink != Requirement::Never && numbers.below(2) == 0 {
            slot.sink = free_words.pop().map_or(SinkConfig::None, SinkConfig::Memory);
        }
        for line in slot.inputs.iter_mut().take(row.inputs) {
            let object = match numbers.below(2) {
                0 => Object::Io(numbers.below(4) as u16),
                _ => Object::Memory(WORDS + numbers.below(BITS.into()) as u16),
            };
            *line = Some(Line { object, inverted: numbers.below(2) == 0 });
        }
        for line in slot.outputs.iter_mut().take(row.outputs.min(2)) {
            let bit = if numbers.below(2) == 0 { free_bits.pop() } else { None };
            *line = bit.map(|bit| Line { object: Object::Memory(WORDS + bit), inverted: numbers.below(2) == 0 });
        }
        slot.tables[0] = (row.tables > 0 && row.kind != Kind::Sidiff).then_some(0);
        slot.program = (row.runs_program).then_some(0);
        slot.room = MemorySize { mean: 64, cams: 0 };
        for (name, value) in [
            ("m1", 12_345),
            ("m2", -777),
            ("sak", 400),
            ("spacing", 900),
            ("tracks", 2),
            ("modulo", 20_000),
            ("speed", 5),
            ("table_count", 1),
            ("active_table", 1),
            ("div", 2),
            ("mult", 3),
            ("in_resolution", 5000),
            ("in_final", 900),
            ("out_max", 3000),
            ("out_min", -3000),
            ("ratio_max", 5),
            ("ratio_min", -5),
            ("ratio_div", 1),
        ] {
            if let Some((_, place)) = row.find(name) {
                slot.values[place] = value;
            }
        }
        if let Some((_, ba)) = row.find("ba").filter(|_| row.kind != Kind::Imes) {
            // A dfkt by distance, and by its inputs; a fgen by the travel of its source, a regl with switches at its
            // inputs.
            slot.values[ba] = if row.kind == Kind::Dfkt { 3 } else { 1 };
        }
        let more: &[(&str, i64)] = match row.kind {
            Kind::Fgen => &[("fct", 7), ("cycle_increments", 900), ("accel", 90_000_000), ("aw_mask", 3)],
            Kind::Regl => &[("kp", 300), ("ki", 20), ("kd", 9), ("y_max", 900_000), ("gain_v", -30), ("i_max", 5000)],
            // By the travel of its source, added.
            Kind::Epos => &[
                ("ba", 9),
                ("travel", 9000),
                ("velocity", 9_000_000),
                ("acceleration", 900_000),
                ("stop_decel", 9_000_000),
                ("drive_resolution", 1000),
                ("master_resolution", 900),
            ],
            Kind::Fipw | Kind::Fipz | Kind::Xfipw | Kind::Dfkt => &[],
            _ => row.example,
        };
        for (name, value) in more {
            let (_, place) = row.find(name).expect("a field");
            slot.values[place] = *value;
        }
        interpolate(&mut slot, numbers.below(4) as usize);
        slot
    });
    let axis = |name: &str| {
        AxisConfig::new(name.into(), Scale::increments(), None, AxisParameters::new(1_000_000.0, 10_000_000.0))
    };
    MachineConfig {
        cycle_ns: 1_000_000,
        // Axes of bits 0 and 1 of a mask.
        axes: ["a", "b"].map(axis).into(),
        slots: slots.collect(),
        programs: vec![ProgramConfig { name: "wild".into(), module: Arc::new(wild) }],
        io: (0..4).map(io).collect(),
        memory: words.chain(bits).collect(),
        encoders: vec![EncoderConfig {
            name: "belt".into(),
            form: Form::Incremental(16),
            check: None,
            scale: Scale::increments(),
        }],
        tables: [("t", table), ("c", curve)]
            .map(|(name, table)| TableConfig { name: name.into(), table: Arc::new(table) })
            .into(),
        ..MachineConfig::default()
    }
}

/// Sets random inputs of a cycle, and returns random orders: bits, the belt, the index that imes measures.
fn outside(numbers: &mut Numbers, inputs: &mut Inputs, cycle: u64) -> Vec<Command> {
    inputs.begin(cycle, 0);
    inputs.digital[0] ^= 1 << numbers.below(24);
    let belt = &mut inputs.encoder[0];
    (belt.count, belt.valid) = (belt.count.wrapping_add(numbers.below(900) as i64 - 300) & 0xFFFF, true);
    belt.index = (numbers.below(9) == 0).then_some(belt.count);
    let orders = if cycle == 0 { u64::from(SLOTS) } else { numbers.below(40).saturating_sub(38) };
    let order = |place: u64| {
        let all = [Order::Start, Order::Start, Order::Reset, Order::ValueNew];
        let (slot, order) = if cycle == 0 {
            (place, Order::Start)
        } else {
            (numbers.below(SLOTS.into()), all[numbers.below(4) as usize])
        };
        let action = Action::CommandFunction(CommandFunction { slot: slot as u16, order, values: [].into() });
        Command { sequence: cycle + 1, source: Source::Scenario, action }
    };
    (0..orders.min(MAX_COMMANDS as u64)).map(order).collect()
}

/// Runs that number of cycles and returns a digest of all signals of all cycles. With `restores` the run continues from
/// its saved state at half time.
fn run(seed: u64, cycles: u64, restores: bool) -> u64 {
    let mut numbers = Numbers(seed);
    let config = cell(&mut numbers);
    let mut machine = Machine::new(config.clone()).expect("a legal machine");
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let signals: Vec<_> = machine.directory().iter().map(|(signal, _)| signal).collect();
    let (mut digest, mut moved) = (0xCBF2_9CE4_8422_2325_u64, 0_u64);
    let before = violation_count();
    for cycle in 0..cycles {
        if restores && cycle == cycles / 2 {
            let image = postcard::to_allocvec(machine.state()).expect("a state has a form");
            let state = postcard::from_bytes(&image).expect("it reads back");
            machine = Machine::restore(config.clone(), state).expect("its own state");
        }
        let commands = outside(&mut numbers, &mut inputs, cycle);
        assert_no_alloc(|| machine.cycle(&inputs, Commands::queue(&commands), &mut outputs));
        let last = digest;
        for signal in &signals {
            digest = (digest ^ machine.board().word(*signal)).wrapping_mul(0x100_0000_01B3);
        }
        moved += u64::from(last != digest);
    }
    assert_eq!(violation_count(), before);
    let active = machine.slots().iter().filter(|slot| slot.is_active()).count();
    assert!(active > 16 && moved > cycles / 2, "{active} slots run; a run in which little happens proves little");
    digest
}

/// Proves: AMK-GEN-05, AMK-CTX-01
#[test]
fn sixty_four_slots_linked_at_random_do_the_same_in_every_run_and_from_their_state() {
    let long = std::env::var_os("LINESHAFT_LONG").is_some();
    let (seeds, cycles) = if long { (10, 1_000_000) } else { (3, 10_000) };
    for seed in 1..=seeds {
        let first = run(seed, cycles, false);
        assert_eq!(first, run(seed, cycles, false), "seed {seed}: a second run");
        assert_eq!(first, run(seed, cycles, true), "seed {seed}: from its state");
    }
    assert_ne!(run(1, 2_000, false), run(2, 2_000, false));
}
