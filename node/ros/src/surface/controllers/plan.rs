//! Checks a request of `switch_controller`.

use super::switches::Controller;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::foreign::controller_manager_msgs::srv::SwitchControllerRequest as Asked;

/// Controllers to switch, by index.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Plan {
    pub activate: Vec<usize>,
    pub deactivate: Vec<usize>,
    /// Unknown names that BEST_EFFORT skips.
    skipped: Vec<String>,
}

impl Plan {
    /// Checks a request. AUTO and FORCE_AUTO mean BEST_EFFORT, as in controller_manager of Jazzy: there are no chains, and no controller
    /// blocks another one.
    ///
    /// # Errors
    /// The strictness is invalid; a controller is in both lists; a name is unknown with STRICT; a list contains only unknown names.
    pub(super) fn of(known: &[Controller], asked: &Asked) -> Result<Self, String> {
        if !(0..=Asked::FORCE_AUTO).contains(&asked.strictness) {
            let given = asked.strictness;
            return Err(format!(
                "strictness is {given}; BEST_EFFORT (1), STRICT (2), AUTO (3), FORCE_AUTO (4) or 0 is allowed"
            ));
        }
        let mut plan = Self::default();
        let is_strict = asked.strictness == Asked::STRICT;
        plan.activate = plan.read(known, "activate_controllers", &asked.activate_controllers, is_strict)?;
        plan.deactivate = plan.read(known, "deactivate_controllers", &asked.deactivate_controllers, is_strict)?;
        let in_both = plan.activate.iter().find(|place| plan.deactivate.contains(place));
        match in_both.and_then(|place| known.get(*place)) {
            Some(controller) => Err(format!(
                "controller {} is in activate_controllers and in deactivate_controllers; one of them is allowed",
                controller.name
            )),
            None => Ok(plan),
        }
    }

    /// Returns the indices of the controllers of a list.
    fn read(
        &mut self,
        known: &[Controller],
        list: &str,
        names: &[String],
        is_strict: bool,
    ) -> Result<Vec<usize>, String> {
        let mut places = Vec::new();
        for name in names {
            match known.iter().position(|controller| controller.name == *name) {
                Some(place) if places.contains(&place) => {}
                Some(place) => places.push(place),
                None if is_strict => return Err(unknown(known, list, name)),
                None => self.skipped.push(excerpt(name)),
            }
        }
        match names.first() {
            Some(name) if places.is_empty() => Err(unknown(known, list, name)),
            _ => Ok(places),
        }
    }

    /// Returns a message about the controllers that were switched.
    pub(super) fn summary(&self, known: &[Controller]) -> String {
        /// Maximum number of skipped names in the message.
        const MOST: usize = 4;
        let names = |places: &[usize]| {
            let names: Vec<_> =
                places.iter().filter_map(|place| known.get(*place)).map(|known| known.name.as_str()).collect();
            names.join(", ")
        };
        let mut parts = Vec::new();
        for (places, state) in [(&self.activate, "active"), (&self.deactivate, "inactive")] {
            match places.as_slice() {
                [] => {}
                [_] => parts.push(format!("controller {} is {state}", names(places))),
                _ => parts.push(format!("controllers {} are {state}", names(places))),
            }
        }
        if !self.skipped.is_empty() {
            let skipped: Vec<_> = self.skipped.iter().take(MOST).map(String::as_str).collect();
            let more = if self.skipped.len() > MOST { ", .." } else { "" };
            parts.push(format!("skipped because unknown: {}{more}", skipped.join(", ")));
        }
        if parts.is_empty() { "no controller was named".to_owned() } else { parts.join("; ") }
    }
}

fn unknown(known: &[Controller], list: &str, name: &str) -> String {
    let names: Vec<_> = known.iter().map(|controller| controller.name.as_str()).collect();
    let names = if names.is_empty() { "there is none".to_owned() } else { format!("known are {}", names.join(", ")) };
    format!("{list}: controller `{}` is unknown, {names}", excerpt(name))
}
