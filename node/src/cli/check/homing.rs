//! Axes that homing would leave outside their software limits.

use lineshaft_core::config::{AxisConfig, MachineConfig};

/// One warning for each axis that rests outside its software limits after homing.
pub(super) fn judge(machine: &MachineConfig) -> impl Iterator<Item = String> {
    machine.axes.iter().filter_map(outside)
}

/// A method of CiA 402 leaves the axis at its reference, which is `-offset` in the new coordinate; a sequence of MACS goes to the
/// zero. A drive that homes by itself has an offset of its own.
fn outside(axis: &AxisConfig) -> Option<String> {
    let p = &axis.parameters;
    if p.homing.method == 0 || p.homing.in_drive {
        return None;
    }
    let rest = if p.homing.method > 0 { p.homing.offset.saturating_neg() } else { 0 };
    let below = p.min_position.filter(|min| rest < *min).map(|min| ("is below min_position", min));
    let above = || p.max_position.filter(|max| rest > *max).map(|max| ("exceeds max_position", max));
    let (verb, limit) = below.or_else(above)?;
    let remedy = match p.homing.method {
        1.. => "change homing.offset or the limit",
        _ => "change the limit, as this sequence ends at the zero",
    };
    let text = |position| axis.scale.format_increments(position);
    Some(format!(
        "{}: homing ends at about {}, which {verb} {}: the axis is then outside its software limits; \
         {remedy}",
        axis.name,
        text(rest),
        text(limit)
    ))
}
