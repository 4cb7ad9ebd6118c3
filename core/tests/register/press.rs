//! A drum, a slot of type fipw that feeds the web to it, and the sensor; each cycle is compared with the law.

use crate::web::{FORMAT, Mark, PLACE, Web};
use lineshaft_core::command::{Action, Command, CommandFunction, Commands, Source};
use lineshaft_core::config::{
    EncoderConfig, MachineConfig, MemoryConfig, MemoryKind, SinkConfig, SlotConfig, SourceConfig, TableConfig,
};
use lineshaft_core::drive::{Edge, Inputs, Latch, Outputs};
use lineshaft_core::encoder::Form;
use lineshaft_core::function::{Kind, Order};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::{Leader, Object};
use lineshaft_core::signal::Signal;
use lineshaft_core::table::{Form as Numbering, Table};
use lineshaft_core::unit::Scale;
use std::sync::Arc;

/// A turn of the drum (inc).
const TURN: i64 = 20_000;
/// Travel of the drum in a cycle: fifty cycles per turn.
const WAY: i64 = 400;
/// Increments of the slave per increment of the drum.
const RATIO: i64 = FORMAT / TURN;
/// The user's unit, a tenth of a millimetre (inc).
const UNIT: i64 = 20;
/// Start of a correction, and travel of the drum over which it is moved: SK = LK = 0.
const WINDOW: (i64, i64) = (TURN * 3 / 4, TURN / 8);
/// Distance from the position of a mark at the sensor to the knife, which cuts at the zero of the drum (inc).
const KNIFE: i64 = FORMAT - PLACE;

/// Settings of the control.
#[derive(Clone, Copy)]
pub(crate) struct Control {
    /// k; 32: no correction.
    pub weight: i64,
    /// W (user's units).
    pub range: i64,
}

impl Control {
    /// Returns C of a deviation: trunc(dXM * 2^-k).
    fn share(self, deviation: i64) -> i64 {
        if self.weight == 32 { 0 } else { deviation / (1 << self.weight) }
    }

    /// Returns the largest correction.
    pub(crate) fn limit(self) -> i64 {
        self.share(self.range * UNIT)
    }
}

/// Result of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Taken {
    Nothing,
    Printed,
    False,
}

/// Values at the end of a turn of the drum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    pub taken: Taken,
    /// dXM as published by the slot (inc).
    pub deviation: i64,
    /// Correction moved in it (inc).
    pub correction: i64,
    /// Distance of the mark of this pass from its nominal position at the sensor (inc).
    pub off: i64,
    /// Distance from the knife at the cut (inc): the register error.
    pub error: i64,
}

/// Results of all marks that the sensor saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Count {
    /// The first mark within the valid range of its pass: printed, false.
    pub printed: usize,
    pub wrong: usize,
    /// Beyond the valid range: false, printed.
    pub outside: usize,
    pub strayed: usize,
    /// Within the range, after the mark that counted, or together with another one in the same cycle.
    pub second: usize,
}

pub(crate) struct Run {
    pub passes: Vec<Pass>,
    pub count: Count,
}

/// Signals of the slot.
#[derive(Clone, Copy)]
struct Shown {
    sink: i64,
    correction: i64,
    deviation: i64,
}

struct Press {
    machine: Machine,
    inputs: Inputs,
    outputs: Outputs,
    signals: [Signal; 3],
    cycle: u64,
}

/// Returns a machine of one slot, with the settings of launch-configs/functions/13_register.yaml.
fn config(control: Control) -> MachineConfig {
    let mut slot = SlotConfig::new("register".into(), 0, Kind::Fipw);
    slot.source = SourceConfig::Lead(Leader::Encoder(0));
    slot.sink = SinkConfig::Memory(0);
    slot.tables[0] = Some(0);
    for (name, value) in [
        ("function", 1),
        ("mode", 2),
        ("table_count", 1),
        ("mult", 1),
        ("increments_per_rev", TURN),
        ("format_length", FORMAT / UNIT),
        ("sensor_distance", KNIFE / UNIT),
        ("valid_range", control.range),
        ("weight", control.weight),
    ] {
        let (_, place) = Kind::Fipw.description().find(name).expect("a field");
        slot.values[place] = value;
    }
    let table = Table::new(Numbering::Y, &[], &[0, 20_000, 40_000, FORMAT]).expect("points");
    MachineConfig {
        cycle_ns: 1_000_000,
        slots: vec![slot],
        memory: vec![MemoryConfig { name: "web".into(), kind: MemoryKind::I32, initial: 0.0 }],
        encoders: vec![EncoderConfig {
            name: "drum".into(),
            form: Form::Incremental(32),
            check: None,
            scale: Scale::increments(),
        }],
        tables: vec![TableConfig { name: "format".into(), table: Arc::new(table) }],
        ..MachineConfig::default()
    }
}

impl Press {
    fn new(control: Control) -> Self {
        let machine = Machine::new(config(control)).expect("a legal machine");
        let signal = |name| machine.directory().find(&format!("register.{name}")).expect("a signal of the slot");
        let signals = ["sink", "correction", "deviation"].map(signal);
        let (inputs, outputs) = (machine.inputs(), machine.outputs());
        let mut press = Self { machine, inputs, outputs, signals, cycle: 0 };
        let start = CommandFunction { slot: 0, order: Order::Start, values: [].into() };
        let start = Command { sequence: 1, source: Source::Scenario, action: Action::CommandFunction(start) };
        press.step(0, &[], &[start]);
        press.step(0, &[], &[]);
        assert!(press.machine.slots().iter().all(|slot| slot.is_active()));
        press
    }

    /// Runs a cycle at whose end the drum is at `count`, and in which the sensor latched at these positions of the
    /// drum.
    fn step(&mut self, count: i64, marks: &[i64], commands: &[Command]) -> Shown {
        self.inputs.begin(self.cycle, 0);
        (self.inputs.encoder[0].count, self.inputs.encoder[0].valid) = (count, true);
        for mark in marks {
            let object = Object::Encoder(0);
            self.inputs.add_latch(Latch { object, edge: Edge::Rising, age_ns: None, position: Some(*mark) });
        }
        assert_eq!(self.inputs.latches_lost, 0);
        self.machine.cycle(&self.inputs, Commands::queue(commands), &mut self.outputs);
        self.cycle += 1;
        let [sink, correction, deviation] = self.signals.map(|signal| self.machine.board().int(signal));
        Shown { sink, correction, deviation }
    }
}

/// Returns the distance of the slave from the nominal position of a mark, for a position of the drum.
fn deviation(drum: i64) -> i64 {
    let off = (RATIO * drum - PLACE).rem_euclid(FORMAT);
    if 2 * off > FORMAT { off - FORMAT } else { off }
}

/// Runs a turn of the drum for each mark. The web is at the position of the sink; in a cycle it moves by the table, and
/// by the correction at the end of the cycle.
///
/// Law      of the marks in a turn the first one within the valid range gives C; of several in a cycle the last one is
///          seen. C is moved within the window of this turn, evenly, to an increment in each cycle; nothing else
///          changes the correction
pub(crate) fn run(web: &Web, control: Control) -> Run {
    let mut press = Press::new(control);
    let mut run = Run { passes: Vec::new(), count: Count::default() };
    let (mut drum, mut coming) = (0, web.seen.iter().peekable());
    let mut last = Shown { sink: 0, correction: 0, deviation: 0 };
    let step = (control.limit() * WAY).div_euclid(WINDOW.1) + 1;
    for (turn, printed) in (0..).zip(&web.printed) {
        let zero = turn * TURN;
        let (before, mut taken) = (last.correction, None);
        while drum < zero + TURN {
            let mut marks: Vec<(i64, Mark)> = Vec::new();
            while let Some(mark) = coming.next_if(|mark| mark.place <= last.sink + RATIO * WAY) {
                marks.push((drum + (mark.place - last.sink).max(0) / RATIO, *mark));
            }
            for (place, (at, mark)) in (1..).zip(&marks) {
                if deviation(*at).abs() > control.range * UNIT {
                    run.count.outside += usize::from(mark.is_false);
                    run.count.strayed += usize::from(!mark.is_false);
                } else if place < marks.len() || taken.is_some() {
                    run.count.second += 1;
                } else {
                    taken = Some((deviation(*at), mark.is_false));
                }
            }
            drum += WAY;
            let at: Vec<i64> = marks.iter().map(|(at, _)| *at).collect();
            let now = press.step(drum, &at, &[]);
            let (x, change) = (drum - zero, now.correction - last.correction);
            assert_eq!(now.sink, RATIO * drum + now.correction, "turn {turn} at {x}");
            assert!(change.abs() <= step, "turn {turn} at {x}: {change} inc in a cycle");
            let is_in_window = x > WINDOW.0 && x - WAY < WINDOW.0 + WINDOW.1;
            assert!(change == 0 || is_in_window, "turn {turn} at {x}: {change} inc outside the window");
            last = now;
        }
        let (correction, off) = (last.correction - before, printed - before - turn * FORMAT - PLACE);
        let seen = taken.map_or(0, |(deviation, _)| deviation);
        assert_eq!((last.deviation, correction), (seen, control.share(seen)), "turn {turn}");
        assert!(correction.abs() <= control.limit(), "turn {turn}: {correction} inc");
        let taken = match taken {
            None => Taken::Nothing,
            Some((_, false)) => Taken::Printed,
            Some((_, true)) => Taken::False,
        };
        run.count.printed += usize::from(taken == Taken::Printed);
        run.count.wrong += usize::from(taken == Taken::False);
        let error = printed + KNIFE - last.sink;
        run.passes.push(Pass { taken, deviation: last.deviation, correction, off, error });
    }
    run
}
