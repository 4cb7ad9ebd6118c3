//! Rule of software limits for all commands: an axis within its limits is never commanded beyond them.

use super::super::rig::Rig;
use super::AXES;
use crate::drive::Interface;
use crate::state::HomingPhase;
use proptest::prelude::*;

/// Commanded positions of the axes that are switched on, in closed loop and with an unchanged zero.
pub(super) type Places = [Option<f64>; 3];

pub(super) fn places(rig: &Rig) -> Places {
    AXES.map(|name| {
        let axis = rig.machine.config().axes.iter().find(|axis| axis.name == name)?;
        let is_on = rig.int(&format!("{name}.enabled")) == 1 && axis.interface != Interface::OpenLoop;
        let homes = rig.int(&format!("{name}.homing.phase")) != HomingPhase::None as i64;
        let whole = rig.int(&format!("{name}.command.position")) as f64;
        (is_on && !homes).then(|| whole + rig.real(&format!("{name}.command.fraction")))
    })
}

/// Checks the rule; `before` holds the positions of the last cycle and earlier.
pub(super) fn check_limits(rig: &Rig, before: Places) -> Result<(), TestCaseError> {
    let axes = rig.machine.state.axes.iter().zip(AXES);
    for ((axis, name), (before, now)) in axes.zip(before.into_iter().zip(places(rig))) {
        let (Some(before), Some(now)) = (before, now) else { continue };
        let low = axis.parameters.min_position.map_or(f64::MIN, |low| low as f64);
        let high = axis.parameters.max_position.map_or(f64::MAX, |high| high as f64);
        let kept = |place: f64| (low..=high).contains(&place);
        // The command of a drive that stops by itself is the actual position.
        let is_actual = name != "line" && now == rig.int(&format!("{name}.actual.position")) as f64;
        let place = format!("from {before} to {now} of {low} to {high}");
        prop_assert!(!kept(before) || kept(now) || is_actual, "{} goes {}, {}", name, place, rig.state(name));
    }
    Ok(())
}
