//! Checks that the parameters of one axis in a file are consistent. Each problem quotes the values of the file.

use super::MOST;
use crate::document::Value;
use lineshaft_core::code::not_built_here;
use lineshaft_core::config::max_velocity_of_cycle;
use lineshaft_core::parameter::{self, AxisParameters, Contradiction, Row};
use lineshaft_core::text::{allowed_text, pair_text, value_text};
use lineshaft_core::unit::{Scale, excerpt};

/// Given keys, with their values.
type Given<'g, 'd> = &'g [(&'static str, Value<'d>)];

/// Refuses two keys that are views of one value, even if they agree; except if the view only stores a value that is
/// `off`.
pub(crate) fn double_views(given: Given<'_, '_>, off: impl Fn(&Row) -> bool) {
    for (key, value) in given {
        let Some((_, view)) = Row::find(key).filter(|(_, row)| row.is_view() && !off(row)) else { continue };
        if let Some((native, other)) = given.iter().find(|(key, _)| *key == view.view_of) {
            let place = other.place();
            let sentence = format!("{key} is another view of {native}, which is at {}:{}", place.line, place.col);
            value.refuse(sentence, Some("write one of them".to_owned()));
        }
    }
}

/// Refuses two keys of the same limit in inverted units: a limit of MACS is then the opposite native one, so that keys
/// which are no views of each other may set the same value. `set` are the values of the file, with their locations.
pub(crate) fn inverted_limits<'v, 'd: 'v>(
    parameters: &AxisParameters,
    set: impl Iterator<Item = (&'static Row, parameter::Value, &'v Value<'d>)>,
) {
    for (row, number, value) in set {
        if parameters.sense().units && row.root().ends_with("_position") && !parameters.has_value(row, number) {
            let sentence = format!("{} stands beside another key of the same limit: posdrct is below 0", row.key);
            value.refuse(sentence, Some("write one of them".to_owned()));
        }
    }
}

/// Refuses inconsistent values, each pair once, and derived values outside of their range.
pub(crate) fn contradictions(parameters: &AxisParameters, given: Given<'_, '_>, scale: &Scale, cycle_ns: Option<u64>) {
    let file = File { given, scale };
    let mut checked = *parameters;
    if let Some(highest) = cycle_ns.map(max_velocity_of_cycle) {
        file.check_velocity(&checked, highest);
    }
    while let Err(contradiction) = checked.check() {
        let key = match contradiction {
            Contradiction::Above(low, high) => {
                // A value that was replaced by a valid one below does not come from the file.
                if !is_made_here(parameters, &checked, low, high) {
                    file.refuse_pair(parameters, low, high);
                }
                low
            }
            Contradiction::OutOfRange(key) => {
                file.refuse_derived(&checked, key);
                key
            }
            Contradiction::NotBuilt(key, code) => {
                if let Some((_, value)) = given.iter().find(|(given, _)| *given == key) {
                    value.refuse(format!("{key} {} {}", value.peek().unwrap_or_default(), not_built_here(code)), None);
                }
                key
            }
        };
        // The value is replaced, so that the next check does not find the same contradiction.
        let harmless =
            [parameter::Value::Unset, parameter::Value::Real(MOST), parameter::Value::Int(0), parameter::Value::Int(1)];
        let is_gone = Row::find(key)
            .is_some_and(|(_, row)| harmless.into_iter().any(|value| row.assign(&mut checked, value).is_ok()));
        if !is_gone || checked.check() == Err(contradiction) {
            return;
        }
    }
}

/// Whether a pair contradicts only because one of its values was replaced.
fn is_made_here(parameters: &AxisParameters, checked: &AxisParameters, low: &str, high: &str) -> bool {
    let value = |key, of| Row::find(key).map(|(_, row)| row.value(of));
    let number = |key| match value(key, parameters) {
        Some(parameter::Value::Int(number)) => number as f64,
        Some(parameter::Value::Real(number)) => number,
        _ => f64::NAN,
    };
    let is_changed = [low, high].iter().any(|key| value(key, parameters) != value(key, checked));
    // Only position limits contradict each other if they are equal.
    let (below, above) = (number(low), number(high));
    is_changed && (below < above || below == above && low != "min_position")
}

/// Keys of an axis in a file, and its scale.
struct File<'g, 'd> {
    given: Given<'g, 'd>,
    scale: &'g Scale,
}

impl<'g, 'd> File<'g, 'd> {
    /// Returns the key that sets the value of a native key.
    fn of_root(&self, root: &str) -> Option<&'g (&'static str, Value<'d>)> {
        self.given.iter().find(|(key, _)| *key == root || Row::find(key).is_some_and(|(_, row)| row.root() == root))
    }

    fn text(&self, row: &Row, parameters: &AxisParameters) -> String {
        value_text(row, row.value(parameters), self.scale)
    }

    /// Refuses a velocity given by other parameters of MACS if it exceeds the maximum of a cycle.
    fn check_velocity(&self, parameters: &AxisParameters, highest: f64) {
        let Some((key, value)) = self.of_root("max_velocity").or(self.given.iter().find(|(key, _)| *key == "encoder"))
        else {
            return;
        };
        if parameters.max_velocity > highest {
            let velocity = self.scale.format_rate(parameters.max_velocity, 1);
            let highest = self.scale.format_bound(highest, 1, true);
            let said = said(key, value);
            let sentence = if *key == "max_velocity" {
                format!("{}; more than 0 up to {highest} is allowed", said.replacen(' ', " is ", 1))
            } else {
                format!("{said} makes max_velocity {velocity}; up to {highest} is allowed")
            };
            value.refuse(sentence, None);
        }
    }

    fn refuse_pair(&self, parameters: &AxisParameters, low: &'static str, high: &'static str) {
        let (Some((_, low_row)), Some((_, high_row))) = (Row::find(low), Row::find(high)) else { return };
        let [lower, higher] = [low_row, high_row].map(|row| (row, row.value(parameters)));
        let (low_text, high_text) = pair_text(lower, higher, self.scale);
        // If a limit follows from another key, that key is part of the message.
        let by =
            self.of_root(high).filter(|(key, _)| *key != high).map_or(String::new(), |(key, _)| format!(" ({key})"));
        let lies = if low_row.value(parameters) == high_row.value(parameters) {
            format!("equals {high} {high_text}{by}; below is allowed")
        } else {
            format!("exceeds {high} {high_text}{by}")
        };
        let of_low = self.of_root(low);
        let Some((key, value)) = of_low.or_else(|| self.of_root(high)).or(self.given.first()) else { return };
        let sentence = if *key == low || *key == high {
            format!("{low} {low_text} {lies}")
        } else if of_low.is_some() {
            format!("{} makes {low} {low_text}, which {lies}", said(key, value))
        } else {
            format!("{}: {low} {low_text} {lies}", said(key, value))
        };
        value.refuse(sentence, None);
    }

    /// Refuses a value that is derived from others and is outside of its range.
    fn refuse_derived(&self, parameters: &AxisParameters, native: &'static str) {
        // Without a velocity, values derived from it have no meaning; the missing velocity is reported already.
        if self.of_root("max_velocity").is_none() && parameters.max_velocity >= MOST {
            return;
        }
        let blamed = self.of_root(native).or_else(|| self.of_root("max_velocity")).or(self.given.first());
        let (Some((key, value)), Some((_, row))) = (blamed, Row::find(native)) else { return };
        let range = allowed_text(row, self.scale, None);
        let sentence =
            format!("{} makes {native} {}; {range} is allowed", said(key, value), self.text(row, parameters));
        value.refuse(sentence, None);
    }
}

/// Returns a key with its value as written.
fn said(key: &str, value: &Value<'_>) -> String {
    format!("{key} `{}`", excerpt(value.peek().unwrap_or_default()))
}
