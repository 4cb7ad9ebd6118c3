//! Finds axes whose homing cannot work, or that would be outside their software limits after it.
//!
//! Source   CiA 402-2 (homing methods), MACS-HOME-03

use crate::cell::Cell;
use lineshaft_core::axis::Wired;
use lineshaft_core::config::AxisConfig;
use lineshaft_core::drive::inputs;
use lineshaft_core::sim::{Fixtures, Mechanics};

/// Returns the warnings about homing.
pub(super) fn judge(cell: &Cell) -> Vec<String> {
    let axes = &cell.machine.axes;
    let mut warnings: Vec<String> = axes.iter().filter_map(outside).collect();
    warnings.extend(axes.iter().filter_map(refused));
    let driven = axes.iter().zip(cell.real_axes()).filter(|(axis, _)| axis.drive.is_some());
    let simulated = driven.zip(&cell.mechanics).filter(|((_, is_real), _)| !is_real);
    for ((axis, _), mechanics) in simulated {
        warnings.extend(without_switch(axis, mechanics));
        warnings.extend(without_index(axis, mechanics));
    }
    warnings
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

/// Returns a warning about homing that is refused: without a method, and a sequence of MACS without its input.
fn refused(axis: &AxisConfig) -> Option<String> {
    let (name, homing) = (&axis.name, &axis.parameters.homing);
    // max_distance and index_distance also limit the reference travel of WF, which needs no method.
    let is_described = homing.velocity.is_some()
        || homing.index_velocity.is_some()
        || homing.acceleration.is_some()
        || homing.offset != 0
        || homing.in_drive;
    match homing.method {
        0 if is_described => Some(format!(
            "{name}: homing has no method: a home command that names none is refused (10302); give homing.method"
        )),
        method @ ..0 if axis.parameters.assigned.refswitch == 0 && !homing.in_drive => Some(format!(
            "{name}: home_type {} needs an input for the reference switch: a home command is refused (10305); \
             give i_refswitch",
            -1 - method
        )),
        _ => None,
    }
}

/// Returns a warning about a method that searches for a switch that is neither simulated nor read from an input.
fn without_switch(axis: &AxisConfig, mechanics: &Mechanics) -> Option<String> {
    let p = &axis.parameters;
    let Fixtures { home, negative, positive, .. } = mechanics.fixtures;
    let (switch, bit, is_simulated) = match p.homing.method {
        1 | 17 => ("negative limit switch", inputs::NEGATIVE_LIMIT, negative.is_some()),
        2 | 18 => ("positive limit switch", inputs::POSITIVE_LIMIT, positive.is_some()),
        3..=14 | 19..=30 => ("reference switch", inputs::HOME, home.is_some()),
        _ => return None,
    };
    let (fixture, key, input) = match bit {
        inputs::NEGATIVE_LIMIT => ("negative_limit_switch", "i_neglimitsw", p.assigned.neglimitsw),
        inputs::POSITIVE_LIMIT => ("positive_limit_switch", "i_poslimitsw", p.assigned.poslimitsw),
        _ => ("home_switch", "i_refswitch", p.assigned.refswitch),
    };
    // A switch that is wired to an input does not read at the drive.
    let is_wired = !p.homing.in_drive && mechanics.wires.iter().flatten().any(|wire| wire.switch == bit);
    if input != 0 || is_simulated && !is_wired {
        return None;
    }
    let (name, method) = (&axis.name, p.homing.method);
    let why = if is_simulated {
        format!("sim.{fixture} is wired to an input that the axis does not read; give {key}")
    } else {
        format!("the simulated axis has none; give sim.{fixture}")
    };
    Some(format!("{name}: homing.method {method} does not find the {switch}: {why}"))
}

/// Returns a warning about a method that searches for an index pulse that is not simulated.
fn without_index(axis: &AxisConfig, mechanics: &Mechanics) -> Option<String> {
    let (name, method) = (&axis.name, axis.parameters.homing.method);
    let seeks = matches!(method, 1..=14 | 33 | 34 | -1 | -3);
    let is_own = matches!(axis.wired, Wired::Drive(_));
    (seeks && is_own && mechanics.fixtures.index.is_none()).then(|| {
        format!(
            "{name}: homing.method {method} does not find an index pulse: the simulated axis has none; give sim.index"
        )
    })
}
