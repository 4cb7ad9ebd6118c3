//! Do the parameters of one axis agree that stand in one file? Each problem names what was written there.

use super::MOST;
use crate::document::Value;
use lineshaft_core::code::not_built_here;
use lineshaft_core::config::max_velocity_of_cycle;
use lineshaft_core::parameter::{self, AxisParameters, Contradiction, Row};
use lineshaft_core::text::{allowed_text, pair_text, value_text};
use lineshaft_core::unit::{Scale, excerpt};

/// Keys that stand in the file, with their values.
type Given<'g, 'd> = &'g [(&'static str, Value<'d>)];

/// One value, two views: both in one file are an error, also where they agree; but where the view only keeps what is `off`.
pub(crate) fn double_views(given: Given<'_, '_>, off: impl Fn(&Row) -> bool) {
    for (key, value) in given {
        let Some((_, view)) = Row::find(key).filter(|(_, row)| row.is_view() && !off(row)) else { continue };
        if let Some((native, other)) = given.iter().find(|(key, _)| *key == view.view_of) {
            let place = other.place();
            let sentence = format!("{key} is another view of {native}, which stands at {}:{}", place.line, place.col);
            value.refuse(sentence, Some("write one of them".to_owned()));
        }
    }
}

/// In inverted units a limit of MACS is the other native one, so that two names which are no views of each other may give one
/// value. `set` is what the file gives, with its place.
pub(crate) fn turned_views<'v, 'd: 'v>(
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

/// Refuses what cannot stand together, every pair once, and what follows from values and leaves its range.
pub(crate) fn contradictions(parameters: &AxisParameters, given: Given<'_, '_>, scale: &Scale, cycle_ns: Option<u64>) {
    let file = File { given, scale };
    let mut checked = *parameters;
    if let Some(highest) = cycle_ns.map(max_velocity_of_cycle) {
        file.check_velocity(&checked, highest);
    }
    while let Err(contradiction) = checked.check() {
        let key = match contradiction {
            Contradiction::Above(low, high) => {
                // What was made harmless here is nothing that anybody wrote.
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
        // The next look must not find the same.
        let harmless =
            [parameter::Value::Unset, parameter::Value::Real(MOST), parameter::Value::Int(0), parameter::Value::Int(1)];
        let is_gone = Row::find(key)
            .is_some_and(|(_, row)| harmless.into_iter().any(|value| row.assign(&mut checked, value).is_ok()));
        if !is_gone || checked.check() == Err(contradiction) {
            return;
        }
    }
}

/// Does a pair contradict only since one of the two was made harmless?
fn is_made_here(parameters: &AxisParameters, checked: &AxisParameters, low: &str, high: &str) -> bool {
    let value = |key, of| Row::find(key).map(|(_, row)| row.value(of));
    let number = |key| match value(key, parameters) {
        Some(parameter::Value::Int(number)) => number as f64,
        Some(parameter::Value::Real(number)) => number,
        _ => f64::NAN,
    };
    let is_changed = [low, high].iter().any(|key| value(key, parameters) != value(key, checked));
    // Only limits of the way contradict where they are the same.
    let (below, above) = (number(low), number(high));
    is_changed && (below < above || below == above && low != "min_position")
}

/// The keys of an axis in a file, and its scale.
struct File<'g, 'd> {
    given: Given<'g, 'd>,
    scale: &'g Scale,
}

impl<'g, 'd> File<'g, 'd> {
    /// What gives the value of a native key.
    fn of_root(&self, root: &str) -> Option<&'g (&'static str, Value<'d>)> {
        self.given.iter().find(|(key, _)| *key == root || Row::find(key).is_some_and(|(_, row)| row.root() == root))
    }

    fn text(&self, row: &Row, parameters: &AxisParameters) -> String {
        value_text(row, row.value(parameters), self.scale)
    }

    /// A velocity that MACS gives by other numbers may be beyond what a cycle can do.
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
        // A limit that follows from another key is told with it.
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

    /// A value that follows from others has left its range.
    fn refuse_derived(&self, parameters: &AxisParameters, native: &'static str) {
        // Without a velocity of its own nothing that follows from one means anything; that is told already.
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

/// A key with its value as it was written.
fn said(key: &str, value: &Value<'_>) -> String {
    format!("{key} `{}`", excerpt(value.peek().unwrap_or_default()))
}
