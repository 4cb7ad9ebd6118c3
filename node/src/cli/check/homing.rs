//! Finds axes that would be outside their software limits after homing.

use lineshaft_core::config::{AxisConfig, MachineConfig};

/// Returns one warning for each axis whose position after homing is outside its software limits.
pub(super) fn judge(machine: &MachineConfig) -> impl Iterator<Item = String> {
    machine.axes.iter().filter_map(outside)
}

/// A CiA 402 method leaves the axis at its reference, which is `-offset` in the new coordinates; a sequence of MACS
/// moves to zero. A drive that homes by itself has its own offset.
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
