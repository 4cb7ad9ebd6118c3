//! Section `drive`: replaces the values of signals in each cycle.
//!
//! Law      n = cycle - at, from n = 0 on:
//!          values, csv: row n; after the last row `then`: hold it, repeat from the first row, release the signal, or
//!          hold it for N more cycles and then release it
//!          ramp: from + n per_cycle, exact; integer signals get the floor. It ends at `until`, which is reached exactly,
//!          and then holds, repeats or releases. With `wrap: N` the signal gets the lower N bits of that as a signed
//!          number, like a counter of N bits; from and until are values of the sum, which does not wrap
//!          the entry of a signal that started last applies, also after it has released the signal: a value held by an
//!          earlier entry does not return
//!          sine: mean + amplitude sin(2 pi n T / period); the phase is an exact fraction of the period, so that zeros
//!          and peaks are exact and there is no drift; integer signals get the nearest value, half away from zero
//! Writes   inputs before the machine reads them; memory cells by commands
//! Refuses  signals that are neither inputs nor memory cells, two drives of one signal from the same cycle, values
//!          outside of the range of the signal, also those of a ramp or a sine
//! Source   contract section 5

mod ramp;

use super::moment::{Moment, positive_cycles};
use super::names::Names;
use super::ruler::{ALL_WHOLE, ValueFormat};
use super::{csv, moment};
use crate::document::{Map, Place, Problems, Value};
use lineshaft_core::config::{IoKind, MemoryKind};
use lineshaft_core::drive::{self, Inputs};
use lineshaft_core::object::Object;
use lineshaft_core::signal::{Signal, Type, Value as Number};
use lineshaft_core::unit::Fraction;
use ramp::{Ramp, cycles_between, exact, most_bits, wrap_bits, wrapped};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// Integers that an f64 represents exactly; a command has the value of a memory cell as f64. Only some integers beyond
/// this range are exact.
const EXACT: (i64, i64) = (-(1 << 53), 1 << 53);

/// One entry of the section.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    pub place: Place,
    pub name: String,
    pub signal: Signal,
    pub kind: Type,
    pub target: Target,
    pub at: u64,
    /// Cycle from which another entry drives the signal.
    end: u64,
    source: Source,
    then: Then,
    /// Minimum and maximum of the signal, if it is an integer.
    range: (i64, i64),
}

/// Driven object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Digital(usize),
    Analog(usize),
    Encoder(usize),
    Drive(usize),
    /// Bits of the digital inputs of a drive.
    Switch(usize, u32),
    Memory(u16),
}

#[derive(Clone, Debug)]
enum Source {
    Rows(Vec<Number>),
    Ramp(Ramp),
    Sine(Sine),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Then {
    Hold,
    Repeat,
    Release,
    /// Hold for this number of cycles, then release.
    HoldFor(u64),
}

#[derive(Clone, Copy, Debug)]
struct Sine {
    mean: f64,
    amplitude: f64,
    period_ns: u64,
    cycle_ns: u64,
    is_real: bool,
}

impl Sine {
    fn at(&self, n: u64) -> Number {
        let period = u128::from(self.period_ns);
        // The sine is calculated by quarters, because libm is exact at their ends.
        let quarters = u128::from(n) * u128::from(self.cycle_ns) % period * 4;
        let angle = (quarters % period) as f64 / period as f64 * FRAC_PI_2;
        let sine = match quarters / period {
            0 => libm::sin(angle),
            1 => libm::cos(angle),
            2 => -libm::sin(angle),
            _ => -libm::cos(angle),
        };
        let value = self.mean + self.amplitude * sine;
        // Rounds half away from zero; the cast saturates.
        if self.is_real { Number::Real(value) } else { Number::Int(libm::round(value) as i64) }
    }
}

impl Drive {
    /// Returns the value in a cycle; `None` before it starts, after it has released the signal, and once another entry
    /// drives it.
    pub(super) fn value(&self, cycle: u64) -> Option<Number> {
        let n = cycle.checked_sub(self.at).filter(|_| cycle < self.end)?;
        let length = match &self.source {
            Source::Rows(rows) => rows.len() as u64,
            Source::Ramp(Ramp { end: Some((reached, _)), .. }) => reached.saturating_add(1),
            Source::Ramp(_) | Source::Sine(_) => u64::MAX,
        };
        let n = match self.then {
            _ if n < length => n,
            Then::Hold => length - 1,
            Then::Repeat => n % length,
            Then::HoldFor(cycles) if n - length < cycles => length - 1,
            Then::Release | Then::HoldFor(_) => return None,
        };
        match &self.source {
            Source::Rows(rows) => usize::try_from(n).ok().and_then(|n| rows.get(n)).copied(),
            Source::Ramp(ramp) => Some(ramp.at(n)),
            Source::Sine(sine) => Some(sine.at(n)),
        }
    }

    /// Replaces an input; does nothing for a memory cell.
    pub(super) fn replace(&self, inputs: &mut Inputs, value: Number) {
        let whole = || match value {
            Number::Int(value) => value,
            Number::Real(value) => value as i64,
        };
        match self.target {
            Target::Digital(place) => inputs.set_digital(place, value.to_f64() != 0.0),
            Target::Analog(place) => {
                if let Some(input) = inputs.analog.get_mut(place) {
                    *input = value.to_f64();
                }
            }
            Target::Encoder(place) => {
                if let Some(input) = inputs.encoder.get_mut(place) {
                    input.count = whole();
                }
            }
            Target::Drive(place) => {
                if let Some(input) = inputs.drive.get_mut(place) {
                    input.count = whole();
                }
            }
            Target::Switch(place, bit) => {
                if let Some(input) = inputs.drive.get_mut(place) {
                    input.inputs = input.inputs & !bit | if value.to_f64() != 0.0 { bit } else { 0 };
                }
            }
            Target::Memory(_) => {}
        }
    }
}

/// Data for reading the entries.
pub(super) struct Reader<'a> {
    pub names: &'a Names<'a>,
    /// Folder to which file names are relative.
    pub folder: &'a Path,
    /// Collects the problems of those files.
    pub problems: &'a Problems,
    pub cycle_ns: u64,
    /// Length of the scenario, in cycles.
    pub cycles: u64,
}

impl Reader<'_> {
    /// Reads the section; an entry that starts later replaces an earlier one of the same signal.
    pub(super) fn read(&self, section: &Value<'_>) -> Vec<Drive> {
        let mut drives: Vec<Drive> = Vec::new();
        for item in section.list().unwrap_or_default() {
            let Some(drive) = self.read_one(&item) else { continue };
            if drives.iter().any(|other| other.signal == drive.signal && other.at == drive.at) {
                let when = moment::text(drive.at, self.cycle_ns);
                item.refuse(format!("{} is driven twice from {when} on", drive.name), None);
            }
            drives.push(drive);
        }
        drives.sort_by_key(|drive| drive.at);
        for index in 0..drives.len() {
            let (earlier, later) = drives.split_at_mut(index);
            let [later, ..] = later else { continue };
            for drive in earlier.iter_mut().filter(|drive| drive.signal == later.signal) {
                drive.end = drive.end.min(later.at);
            }
        }
        drives.iter().for_each(|drive| self.refuse_beyond(drive));
        drives
    }

    /// Refuses a ramp that leaves the range of its signal while it drives it. Its end was checked when it was read.
    fn refuse_beyond(&self, drive: &Drive) {
        let Source::Ramp(ramp @ Ramp { wrap: None, is_real: false, .. }) = &drive.source else { return };
        let reached = ramp.end.map_or(u64::MAX, |(reached, _)| reached);
        let last = drive.end.min(self.cycles).min(drive.at.saturating_add(reached));
        let last = last.checked_sub(drive.at.saturating_add(1));
        let Some(n) = last.and_then(|last| ramp.first_beyond(last, drive.range)) else { return };
        let (value, (low, high)) = (ramp.floor(n), drive.range);
        let when = moment::text(drive.at + n, self.cycle_ns);
        let sentence = format!("{} gets to {value} in {when}; {low}..{high} is allowed", drive.name);
        let most = if matches!(drive.target, Target::Memory(_)) { most_bits(EXACT) } else { i64::BITS };
        let bits = most_bits(drive.range).min(most);
        let hint = format!("`wrap: {bits}` makes the ramp a counter that wraps");
        self.problems.push(drive.place, sentence, Some(hint));
    }

    fn read_one(&self, item: &Value<'_>) -> Option<Drive> {
        let mut map = item.map("an entry of drive")?;
        let signal = map.required("signal").and_then(|value| self.signal(&value));
        let at = map.optional("at").map_or(Some(0), |value| self.start(&value));
        let ruler = signal.as_ref().map(|(signal, target)| self.ruler(*signal, *target));
        let source = self.source(&mut map, ruler.as_ref());
        let then = map.optional("then").map(|value| (value.place(), self.then(&value, source.as_ref())));
        map.finish();
        let (signal, target) = signal?;
        let entry = self.names.directory.entry(signal);
        let then = match then {
            None => Then::Hold,
            Some((_, then)) => then?,
        };
        let (name, kind, place) = (entry.name.clone(), entry.kind, item.place());
        let ruler = ruler?;
        let range = match &source {
            Some(Source::Ramp(ramp)) if ruler.in_f64 => ramp.exact_range(),
            _ => ruler.range,
        };
        Some(Drive { place, name, signal, kind, target, at: at?, end: u64::MAX, source: source?, then, range })
    }

    /// Returns the ruler of a signal; values of a memory cell are limited by its type.
    fn ruler(&self, signal: Signal, target: Target) -> ValueFormat {
        let ruler = ValueFormat::of(self.names, signal);
        let Target::Memory(index) = target else { return ruler };
        let kind = self.names.config.memory.get(usize::from(index)).map(|memory| memory.kind);
        let range = kind.and_then(MemoryKind::whole_range).unwrap_or(ALL_WHOLE);
        ValueFormat { in_f64: kind == Some(MemoryKind::I64), ..ruler.within(range) }
    }

    fn start(&self, value: &Value<'_>) -> Option<u64> {
        let at = Moment::read(value, self.cycle_ns)?.after(0, self.cycles - 1);
        super::refuse_beyond_end(value, at, self.cycles, self.cycle_ns).then_some(at)
    }

    fn signal(&self, value: &Value<'_>) -> Option<(Signal, Target)> {
        let signal = self.names.signal(value)?;
        let entry = self.names.directory.entry(signal);
        let target = if entry.drivable { self.target(&entry.name) } else { None };
        if target.is_none() {
            let io = self.names.find(&entry.name);
            let reads_output = matches!(io, Some(Object::Io(index)) if self.names.reads_output(index));
            let why = if reads_output { "reads an output of the machine and " } else { "" };
            let sentence = format!("{} {why}cannot be driven", entry.name);
            let rule =
                "inputs, memory cells, ENCODER.count, and of axes with a drive AXIS.actual.count and its switches can";
            value.refuse(format!("{sentence}; {rule}"), None);
        }
        target.map(|target| (signal, target))
    }

    fn target(&self, name: &str) -> Option<Target> {
        let config = self.names.config;
        if let Some(axis) = name.strip_suffix(".actual.count") {
            let index = config.axes.iter().position(|entry| entry.name == axis)?;
            return self.names.drive_of(index as u16).map(Target::Drive);
        }
        let second = |axis: &str| {
            let index = config.axes.iter().position(|entry| entry.name == axis)?;
            config.second_drive(index as u16)
        };
        if let Some(axis) = name.strip_suffix(".second.count") {
            return second(axis).map(Target::Drive);
        }
        if let Some(axis) = name.strip_suffix(".second.reference_switch") {
            return second(axis).map(|place| Target::Switch(place, drive::inputs::HOME));
        }
        let switches = [
            (".limit.positive", drive::inputs::POSITIVE_LIMIT),
            (".limit.negative", drive::inputs::NEGATIVE_LIMIT),
            (".reference_switch", drive::inputs::HOME),
        ];
        for (suffix, bit) in switches {
            if let Some(axis) = name.strip_suffix(suffix) {
                let index = config.axes.iter().position(|entry| entry.name == axis)?;
                return self.names.drive_of(index as u16).map(|place| Target::Switch(place, bit));
            }
        }
        if let Some(encoder) = name.strip_suffix(".count") {
            let place = config.encoders.iter().position(|entry| entry.name == encoder);
            return place.map(Target::Encoder);
        }
        match self.names.find(name)? {
            Object::Memory(index) => Some(Target::Memory(index)),
            Object::Io(index) => match self.names.io(index)? {
                (IoKind::DigitalInput, place) => Some(Target::Digital(place)),
                (IoKind::AnalogInput, place) => Some(Target::Analog(place)),
                _ => None,
            },
            _ => None,
        }
    }

    fn source(&self, map: &mut Map<'_>, ruler: Option<&ValueFormat>) -> Option<Source> {
        let given = ["values", "csv", "ramp", "sine"].map(|key| map.optional(key));
        if given.iter().flatten().count() != 1 {
            map.refuse("one of values, csv, ramp, sine is expected", None);
            return None;
        }
        let [values, csv, ramp, sine] = given;
        let ruler = ruler?;
        if let Some(values) = values {
            return rows(&values, ruler).map(Source::Rows);
        }
        if let Some(value) = csv {
            return csv::read(&value, self.folder, ruler, self.problems).map(Source::Rows);
        }
        let value = ramp.as_ref().or(sine.as_ref())?;
        if ruler.kind == Type::Bit {
            value.refuse(format!("a bit has no {}; values and csv are possible", value.label()), None);
            return None;
        }
        if ramp.is_some() {
            self.ramp(value, ruler).map(Source::Ramp)
        } else {
            self.sine(value, &all_exact(ruler)).map(Source::Sine)
        }
    }

    fn then(&self, value: &Value<'_>, source: Option<&Source>) -> Option<Then> {
        let then = if value.is_map() {
            let mut map = value.map("then")?;
            let cycles = map.required("hold").map(|value| positive_cycles(&value, self.cycle_ns));
            map.finish();
            Then::HoldFor(cycles??)
        } else {
            value.choice(&[("hold", Then::Hold), ("repeat", Then::Repeat), ("release", Then::Release)])?
        };
        let endless = match source {
            Some(Source::Sine(_)) => "a sine",
            Some(Source::Ramp(Ramp { end: None, .. })) => "a ramp without until",
            _ => return Some(then),
        };
        value.refuse(format!("{endless} has no end, so nothing comes then"), None);
        None
    }

    fn ramp(&self, value: &Value<'_>, ruler: &ValueFormat) -> Option<Ramp> {
        let mut map = value.map("ramp")?;
        let wrap = map.optional("wrap");
        // For a counter, from and until are values of the sum, which does not wrap.
        let bounds = if wrap.is_some() { ValueFormat { in_f64: false, ..ruler.within(ALL_WHOLE) } } else { *ruler };
        let from = map.optional("from").map_or(Some(zero(ruler)), |value| bounds.read(&value));
        let per_cycle = map.required("per_cycle").and_then(|value| value.fraction());
        let until = map.optional("until").map(|value| (bounds.read(&value), value));
        map.finish();
        let wrap = match wrap {
            None => None,
            Some(value) => Some(wrap_bits(&value, &all_exact(ruler))?),
        };
        let (from, per_cycle) = (from?, per_cycle?);
        let until = match until {
            None => None,
            Some((until, value)) => Some((until?, value)),
        };
        let Some(ramp) = self.exact_ramp(from, per_cycle, ruler) else {
            value.refuse("per_cycle and from have too many digits for an exact ramp of this length", None);
            return None;
        };
        let ramp = Ramp { wrap, ..ramp };
        let Some((until, value)) = until else { return Some(ramp) };
        let Some(reached) = cycles_between(from, until, &per_cycle) else {
            let (from, until) = (ruler.text(from), ruler.text(until));
            let sentence = format!("a ramp from {from} by {per_cycle} per cycle never gets to {until}");
            value.refuse(sentence, None);
            return None;
        };
        let end = match until {
            Number::Int(until) => Number::Int(wrapped(until.into(), wrap)),
            Number::Real(_) => until,
        };
        Some(Ramp { end: Some((reached, end)), ..ramp })
    }

    /// Converts start and step to a common denominator; returns `None` if a sum could exceed 128 bits within the
    /// scenario.
    fn exact_ramp(&self, from: Number, per_cycle: Fraction, ruler: &ValueFormat) -> Option<Ramp> {
        let from = exact(from)?;
        let denominator = from.denom().checked_mul(*per_cycle.denom())?;
        let start = from.numer().checked_mul(*per_cycle.denom())?;
        let step = per_cycle.numer().checked_mul(*from.denom())?;
        let way = step.checked_abs()?.checked_mul(self.cycles.into())?;
        start.checked_abs()?.checked_add(way)?;
        Some(Ramp { start, step, denominator, end: None, wrap: None, is_real: ruler.kind == Type::Real })
    }

    fn sine(&self, value: &Value<'_>, ruler: &ValueFormat) -> Option<Sine> {
        let mut map = value.map("sine")?;
        let mean = map.optional("mean").map_or(Some(zero(ruler)), |value| ruler.read(&value));
        let amplitude = map.required("amplitude").and_then(|value| ruler.read(&value));
        let period = map.required("period").and_then(|value| self.period(&value));
        map.finish();
        let (mean, amplitude) = (mean?, amplitude?);
        if let (Number::Int(mean), Number::Int(amplitude)) = (mean, amplitude) {
            let (middle, swing) = (i128::from(mean), i128::from(amplitude).abs());
            let (least, most, (low, high)) = (middle - swing, middle + swing, ruler.range);
            if least < i128::from(low) || most > i128::from(high) {
                value.refuse(format!("the sine runs from {least} to {most}; {low}..{high} is allowed"), None);
                return None;
            }
        }
        let (mean, amplitude) = (mean.to_f64(), amplitude.to_f64());
        if !(mean.abs() + amplitude.abs()).is_finite() {
            value.refuse("mean and amplitude together exceed what f64 holds, 1.8e308", None);
            return None;
        }
        Some(Sine { mean, amplitude, period_ns: period?, cycle_ns: self.cycle_ns, is_real: ruler.kind == Type::Real })
    }

    /// Reads a period; a time need not be a multiple of the cycle.
    fn period(&self, value: &Value<'_>) -> Option<u64> {
        let ns = if value.is_integer() {
            positive_cycles(value, self.cycle_ns)?.checked_mul(self.cycle_ns)
        } else {
            Some(moment::nanoseconds(value)?)
        };
        if ns.is_none_or(|ns| ns == 0) {
            value.refuse("period is none; more than 0 up to 292 years is allowed", None);
        }
        ns.filter(|ns| *ns > 0)
    }
}

/// Returns the ruler without ranges in which some integers are not exact in a command.
fn all_exact(ruler: &ValueFormat) -> ValueFormat {
    if ruler.in_f64 { ruler.within(EXACT) } else { *ruler }
}

fn zero(ruler: &ValueFormat) -> Number {
    if ruler.kind == Type::Real { Number::Real(0.0) } else { Number::Int(0) }
}

/// Reads a list of values; it must not be empty.
pub(super) fn rows(values: &Value<'_>, ruler: &ValueFormat) -> Option<Vec<Number>> {
    let items = values.list()?;
    if items.is_empty() {
        values.refuse(format!("{} is empty; one value or more is expected", values.label()), None);
        return None;
    }
    let rows: Vec<_> = items.iter().map(|item| ruler.read(item)).collect();
    rows.into_iter().collect()
}
