//! Reads key `brake` of an axis, and derives its simulation.

use super::backends::Context;
use super::times::time;
use super::wiring;
use crate::document::Map;
use lineshaft_core::axis::BrakeConfig;
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::sim::SimBrake;

/// Reads the key; `None` if it has problems.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    is_virtual: bool,
    cx: &Context<'d>,
    io: &[Option<IoConfig>],
    taken: &mut wiring::Taken,
) -> Option<Option<BrakeConfig>> {
    let Some(value) = map.optional("brake") else { return Some(None) };
    if is_virtual {
        let sentence = "brake is for axes with a drive; this one is virtual";
        value.refuse(sentence, Some("leave it out".to_owned()));
        return None;
    }
    let mut map = value.map("brake")?;
    let output = map.required("output");
    let output = output.and_then(|value| wiring::place(&value, IoKind::DigitalOutput, cx, io, taken));
    let inverted = map.optional("inverted").map_or(Some(false), |value| value.boolean());
    let release = map.optional("release_delay").map_or(Some(0), |value| time(&value));
    let engage = map.optional("engage_delay").map_or(Some(0), |value| time(&value));
    map.finish();
    Some(Some(BrakeConfig { output: output?, closes_with_one: inverted?, release_ns: release?, engage_ns: engage? }))
}

/// Returns the simulated brake of the axis: its own, or the one that O_BRAKE names (`number`).
pub(super) fn simulated(
    own: Option<BrakeConfig>,
    number: i64,
    io: &[Option<IoConfig>],
    [opens_ns, closes_ns]: [u64; 2],
) -> Option<SimBrake> {
    let is_output = |entry: &&Option<IoConfig>| entry.as_ref().is_some_and(|io| io.kind == IoKind::DigitalOutput);
    let (output, closes_with_one) = match own {
        Some(brake) => (io.iter().take(brake.output.into()).filter(is_output).count(), brake.closes_with_one),
        None => (usize::try_from(number.unsigned_abs().checked_sub(1)?).ok()?, number > 0),
    };
    Some(SimBrake { output, closes_with_one, opens_ns, closes_ns })
}
