//! Finds parameter sets of functions that START would refuse, and sets with which a sink never moves.
//!
//! A client may set the fields that the cell leaves out, so these cause warnings. A key of the cell that makes a set
//! invalid is an error at that key.

use crate::cell::Cell;
use crate::document::{Document, Problems, Value};
use lineshaft_core::config::SlotConfig;
use lineshaft_core::event::{Number, Refusal};
use lineshaft_core::function::{Field, Kind};
use lineshaft_core::machine::Machine;
use lineshaft_core::text::message;

/// Returns the errors, with their locations in the file `name`, and the warnings.
pub(super) fn judge(name: &str, cell: &Cell, machine: &Machine) -> (Problems, Vec<String>) {
    let document = Document::parse(name, cell.text.as_str());
    let mut warnings = Vec::new();
    if let Some(section) = document.root("the cell").and_then(|root| at(&root, "functions")) {
        for (place, slot) in (0_u16..).zip(&cell.machine.slots) {
            let Some(entry) = at(&section, &slot.name) else { continue };
            warnings.extend(refuse_start(&Trial { machine, place, slot, entry: &entry }, cell));
        }
        for slot in &cell.machine.slots {
            let Some(entry) = at(&section, &slot.name) else { continue };
            warnings.extend(idle(slot, &entry));
        }
    }
    (document.into_problems(), warnings)
}

/// Returns the value of a key.
fn at<'d>(value: &Value<'d>, key: &str) -> Option<Value<'d>> {
    value.entries()?.into_iter().find(|(known, _)| known.peek() == Some(key)).map(|(_, value)| value)
}

/// A function whose parameter sets are checked.
struct Trial<'t, 'd> {
    machine: &'t Machine,
    place: u16,
    slot: &'t SlotConfig,
    entry: &'t Value<'d>,
}

impl Trial<'_, '_> {
    fn fields(&self) -> &'static [Field] {
        self.slot.kind.description().fields
    }

    fn is_given(&self, number: u16) -> bool {
        self.fields().get(usize::from(number)).is_some_and(|field| at(self.entry, field.name).is_some())
    }

    fn refusal(&self, set: &[i64]) -> Option<Refusal> {
        self.machine.refused_start(self.place, set)
    }

    /// Sets a field that the cell leaves out to a value that removes a refusal. Returns false, with the set unchanged,
    /// if there is no such value.
    fn gives(&self, set: &mut [i64], number: u16, refusal: &Refusal) -> bool {
        let Some(field) = self.fields().get(usize::from(number)) else { return false };
        let Some((_, first)) = self.slot.kind.description().find(field.name) else { return false };
        let near = |number: Number| match number {
            Number::Count(value) => [value, value.saturating_add(1), value.saturating_sub(1)],
            _ => [1, 2, -1],
        };
        let values = [field.min, field.max, 1, 2, -1].into_iter().chain(near(refusal.asked)).chain(near(refusal.limit));
        let before = set.to_vec();
        for value in values.filter(|value| (field.min..=field.max).contains(value)) {
            set.iter_mut().skip(first).take(field.count).for_each(|word| *word = value);
            if self.is_gone(refusal, self.refusal(set).as_ref(), number) {
                return true;
            }
            set.copy_from_slice(&before);
        }
        false
    }

    /// Returns true if a refusal is removed after a field got another value. A new refusal must not come from that
    /// value.
    fn is_gone(&self, old: &Refusal, new: Option<&Refusal>, changed: u16) -> bool {
        let Some(new) = new else { return true };
        let is_other = (new.code, new.parameter) != (old.code, old.parameter) && new.parameter != Some(changed);
        is_other && new.parameter.is_some_and(|number| old.parameter == Some(changed) || self.is_given(number))
    }
}

/// Refuses the set of a function at the key that makes it invalid. If a field that the cell leaves out does so, returns
/// a warning and continues with a value for it, so that the field hides no error.
fn refuse_start(trial: &Trial<'_, '_>, cell: &Cell) -> Vec<String> {
    let (mut set, mut warned, mut warnings) = (trial.slot.values.to_vec(), Vec::new(), Vec::new());
    let fields = trial.fields();
    // After the next refusal, a field may need a value other than its first one.
    for _ in 0..=2 * fields.len() {
        let Some(refusal) = trial.refusal(&set) else { break };
        let text = message(&refusal.event(0), &cell.machine);
        let own = refusal.parameter.filter(|number| !trial.is_given(*number));
        let others = (0_u16..).zip(fields).map(|(number, _)| number).filter(|number| !trial.is_given(*number));
        let found = own.into_iter().chain(others).find(|number| trial.gives(&mut set, *number, &refusal));
        let Some((number, field)) = found.or(own).and_then(|number| Some((number, fields.get(usize::from(number))?)))
        else {
            let key = refusal.parameter.and_then(|number| fields.get(usize::from(number)));
            let given = at(trial.entry, key.map_or("tables", |field| field.name));
            given.as_ref().unwrap_or(trial.entry).refuse(format!("{text}; START refuses this set"), None);
            break;
        };
        if !warned.contains(&number) {
            warned.push(number);
            let key = field.name;
            warnings.push(format!("{text}; {key} is left out: START is refused unless its command gives it"));
        }
        if found.is_none() {
            break;
        }
    }
    warnings
}

fn idle(slot: &SlotConfig, entry: &Value<'_>) -> Vec<String> {
    let fields = slot.kind.description().fields.iter().filter(|field| at(entry, field.name).is_none());
    let idle = fields.filter_map(|Field { name, idle, .. }| {
        Some(format!("{}: {name} is left out, which is 0: {}", slot.name, idle.as_ref()?))
    });
    idle.chain(no_ratio(slot, entry)).collect()
}

/// Returns a warning about a varsync without any ratio that its mode can select (AMK-VARSYNC-04 to -06).
fn no_ratio(slot: &SlotConfig, entry: &Value<'_>) -> Option<String> {
    if slot.kind != Kind::Varsync {
        return None;
    }
    let (_, place) = slot.kind.description().find("mode")?;
    let last = match slot.values.get(place)? {
        0 => 2,
        1 => 8,
        2 => 3,
        _ => return None,
    };
    let has_none = (1..=last).all(|number| at(entry, &format!("m{number}")).is_none());
    has_none.then(|| format!("{}: m1 to m{last} are left out, which are 0: its sink never moves", slot.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "\
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io: {speed: {type: ao, backend: plant, address: 0}}
encoders:
  belt: {backend: plant, address: 0, bits: 16, type: linear, scale: {increments: 40, per: 1 mm}}
axes:
  x: {type: linear, drive: virtual, scale: {increments: 1000, per: 1 mm}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}
tables:
  rise: {form: y, points: [0, 10, 20, 30, 40]}
  late: {form: y, points: [5, 10, 20, 30, 40]}
  segments: {form: words, words: [2, 0, 0, 0, 100, 0, 1, 0]}
functions:
";

    /// Returns the errors and warnings about a function, which begins in line 14 after four characters.
    fn judged(function: &str) -> (String, Vec<String>) {
        judged_in(HEAD, function)
    }

    fn judged_in(head: &str, function: &str) -> (String, Vec<String>) {
        let text = format!("{head}  f: {function}\n");
        let cell = Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        let machine = Machine::new(cell.machine.clone()).unwrap();
        let (problems, warnings) = judge("c.yaml", &cell, &machine);
        (problems.to_string(), warnings)
    }

    /// Checks the error about a function; `^` marks its location.
    #[track_caller]
    fn refused(function: &str, sentence: &str) {
        let column = function.find('^').unwrap() + 1 + "  f: ".len();
        let (problems, warnings) = judged(&function.replacen('^', "", 1));
        assert_eq!(problems, format!("c.yaml:14:{column}: {sentence}\n"));
        assert_eq!(warnings, [""; 0]);
    }

    #[test]
    fn set_that_start_would_refuse_is_an_error_at_its_key() {
        refused(
            "{slot: 0, type: imes, source: belt, sink: none, ba: ^12, spacing: 10000, window: 2000, blocked: 1000}",
            "f: ba: 12 limits the measurement to positive and to negative at once; START refuses this set",
        );
        refused(
            "{slot: 0, type: binea, source: belt, tables: [segments], ba: 1, tracks: 1, sf_cycle_time: ^3}",
            "f: sf_cycle_time: 3 times 0.5 ms is not the cycle of the slot, 1 ms; START refuses this set",
        );
        refused(
            "^{slot: 0, type: binea, source: belt, ba: 1, tracks: 1}",
            "f: the first table is missing; the function reads its points or cams there; START refuses this set",
        );
        refused(
            "{slot: 0, type: fipw, source: belt, sink: none, mode: 98, table_count: 5, start_tables: 1, mult: 1, \
             increments_per_rev: 20000, tables: ^[rise, rise, rise]}",
            "f: 5 tables are counted; the function has 3; START refuses this set",
        );
        refused(
            "{slot: 0, type: fipw, source: belt, sink: none, mode: 2, table_count: 1, mult: 1, increments_per_rev: 20000, \
             tables: ^[late]}",
            "f: Tab0 begins at 5 instead of 0; START refuses this set",
        );
        refused(
            "{slot: 0, type: fipw, source: belt, sink: none, mode: ^3, table_count: 1, mult: 1, increments_per_rev: 20000, \
             tables: [rise]}",
            "f: mode: no mode has number 3; 2, 4, 26, 82, 84, 98, 100, 132 are allowed; START refuses this set",
        );
    }

    #[test]
    fn field_that_is_left_out_and_that_start_needs_is_a_warning() {
        let (problems, warnings) = judged("{slot: 0, type: epos, acceleration: 1, stop_decel: 1, drive_resolution: 1}");
        let warning = "f: velocity: 0 is no value of it in this `ba`; 1 to 2147483647 is possible; velocity is left out: \
                       START is refused unless its command gives it";
        assert_eq!((problems.as_str(), warnings), ("", vec![warning.to_owned()]));
    }

    /// A search for the reference needs 1 to 9 ms between two calls, and `sf_cycle` must be the cycle of the slot
    /// itself (AMK-EPOS-44, -50).
    #[test]
    fn cycle_in_which_no_epos_can_search_is_an_error_at_its_mode() {
        let head = HEAD.replace("cycle: 1 ms", "cycle: 500 us").replace(
            "drive: virtual,",
            "drive: {backend: plant, address: 1, interface: position}, sim: {model: ideal},",
        );
        let rest = "travel: 5, velocity: 1, acceleration: 1, stop_decel: 1, drive_resolution: 1}";
        let function = format!("{{slot: 0, type: epos, sink: x, ba: 2, {rest}");
        let column = function.find("2,").unwrap() + 1 + "  f: ".len();
        let (problems, warnings) = judged_in(&head, &function);
        let sentence = "f: ba: 0.5 ms between two calls is below the minimum 1 ms; START refuses this set";
        assert_eq!((problems, warnings), (format!("c.yaml:14:{column}: {sentence}\n"), Vec::new()));
    }

    #[test]
    fn field_that_is_left_out_hides_no_error() {
        let function = "{slot: 0, type: epos, sink: none, ba: 18, velocity: 1, stop_decel: 1, drive_resolution: 1}";
        let (problems, warnings) = judged(function);
        let column = function.find("18").unwrap() + 1 + "  f: ".len();
        assert!(problems.starts_with(&format!("c.yaml:14:{column}: f: ")), "{problems}");
        assert!(problems.ends_with("START refuses this set\n") && problems.lines().count() == 1, "{problems}");
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(warnings[0].ends_with("acceleration is left out: START is refused unless its command gives it"));
    }

    /// START with `table_count: 1` or `ratio_max: 2` is valid.
    #[test]
    fn value_beyond_a_field_that_is_left_out_is_a_warning() {
        let follower = "{slot: 0, type: dfkt, source: belt, sink: none, ba: 1, div: 1, in_resolution: 20000, in_final: 3000, \
                        ratio_div: 1, mult: 1, out_max: 3000, out_min: 0";
        let left_out = "is left out: START is refused unless its command gives it";
        for (rest, key) in [
            ("ratio_max: 2, ratio_min: -2, tables: [speeds], active_table: 1", "table_count"),
            ("ratio_min: 1", "ratio_max"),
        ] {
            let head = HEAD.replace("functions:", "  speeds: {form: y, points: [0, 10, 20]}\nfunctions:");
            let (problems, warnings) = judged_in(&head, &format!("{follower}, {rest}}}"));
            assert_eq!((problems.as_str(), warnings.len()), ("", 1), "{warnings:?}");
            assert!(warnings[0].ends_with(&format!("; {key} {left_out}")), "{warnings:?}");
        }
    }

    #[test]
    fn mask_with_a_bit_of_a_missing_axis_is_an_error() {
        refused(
            "{slot: 0, type: sidiff, sink: none, aw_mask: ^3, display_aw: 1, mean_n: 1}",
            "f: aw_mask: 3 has bit 1 for axis 2; the cell has 1 axis; START refuses this set",
        );
        refused(
            "{slot: 0, type: sidiff, sink: none, aw_mask: 1, display_aw: ^2, mean_n: 1}",
            "f: display_aw: 2 exceeds the maximum 1; START refuses this set",
        );
        let good = judged("{slot: 0, type: sidiff, sink: none, aw_mask: 1, display_aw: 1, mean_n: 1}");
        assert_eq!(good, (String::new(), Vec::new()));
    }

    #[test]
    fn value_beyond_the_full_scale_of_an_analog_output_is_an_error() {
        refused(
            "{slot: 0, type: ecopy, sink: speed, mode: 3, value_e1_0: ^12000, value_e1_1: 5000}",
            "f: value_e1_0: 12000 mV exceeds the full scale of the analog output; -10000 to 10000 mV is allowed; \
             START refuses this set",
        );
        refused(
            "{slot: 0, type: ecopy, sink: speed, mode: 3, value_e1_0: 0, value_e1_1: ^-10001}",
            "f: value_e1_1: -10001 mV exceeds the full scale of the analog output; -10000 to 10000 mV is allowed; \
             START refuses this set",
        );
        for good in [
            "mode: 3, value_e1_0: 10000, value_e1_1: -10000",
            "mode: 2, value_e1_0: 12000",
            "mode: 1, value_e1_1: 12000",
        ] {
            let good = judged(&format!("{{slot: 0, type: ecopy, sink: speed, {good}}}"));
            assert_eq!(good, (String::new(), Vec::new()));
        }
    }

    #[test]
    fn factor_or_limit_that_is_left_out_and_keeps_the_sink_at_rest_is_a_warning() {
        let interpolator = "{slot: 0, type: fipw, source: belt, sink: none, mode: 2, table_count: 1, \
                            increments_per_rev: 20000, tables: [rise]";
        let (problems, warnings) = judged(&format!("{interpolator}}}"));
        assert_eq!(
            (problems.as_str(), warnings),
            ("", vec!["f: mult is left out, which is 0: its sink never moves".to_owned()])
        );
        assert_eq!(judged(&format!("{interpolator}, mult: 1}}")), (String::new(), Vec::new()));
        // Mode 0 selects m1 or m2, mode 1 one of eight, mode 2 one of three, mode 3 uses a word.
        for (given, last) in [("", Some(2)), (", m3: 1", Some(2)), (", m2: 1", None)].into_iter().chain([
            (", mode: 1", Some(8)),
            (", mode: 1, m8: 1", None),
            (", mode: 2, m4: 1", Some(3)),
        ]) {
            let (problems, warnings) = judged(&format!("{{slot: 0, type: varsync, source: belt, sink: none{given}}}"));
            let expected =
                last.map(|last: u8| format!("f: m1 to m{last} are left out, which are 0: its sink never moves"));
            assert_eq!((problems.as_str(), warnings), ("", Vec::from_iter(expected)), "{given}");
        }
        let follower = "{slot: 0, type: dfkt, source: belt, sink: none, ba: 1, div: 1, in_resolution: 20000, in_final: 3000, \
                        ratio_max: 2, ratio_min: -2, ratio_div: 1";
        let (problems, warnings) = judged(&format!("{follower}}}"));
        let expected = [
            "f: mult is left out, which is 0: the function gives no speed",
            "f: out_max is left out, which is 0: the function gives no speed above 0",
            "f: out_min is left out, which is 0: the function gives no speed below 0",
        ];
        assert_eq!((problems.as_str(), warnings), ("", expected.map(str::to_owned).to_vec()));
        assert_eq!(judged(&format!("{follower}, mult: 1, out_max: 3000, out_min: 0}}")), (String::new(), Vec::new()));
    }
}
