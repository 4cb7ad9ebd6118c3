//! Rule of error locks for all commands: only a reset ends an error, and an axis whose power was removed gets no power
//! before it.

use super::super::rig::Rig;
use super::AXES;
use crate::event::Kind;
use crate::object::Object;
use proptest::prelude::*;

/// Bit "enable voltage" of the control word (CiA 402).
const VOLTAGE: i64 = 2;

#[derive(Clone, Default)]
struct Shown {
    state: String,
    has_voltage: bool,
}

/// Values that the axes showed in the previous cycle.
#[derive(Default)]
pub(super) struct Locks {
    before: [Shown; 3],
    told: usize,
}

impl Locks {
    /// Returns an empty history for the next cycle.
    pub(super) fn after(rig: &Rig) -> Self {
        Self { told: rig.events.len(), ..Self::default() }
    }

    /// Checks the rule after a cycle.
    pub(super) fn check(&mut self, rig: &Rig) -> Result<(), TestCaseError> {
        let news = &rig.events[self.told..];
        for (index, (name, before)) in AXES.into_iter().zip(&mut self.before).enumerate() {
            let has_voltage = index == 0 || rig.int(&format!("{name}.output.control")) & VOLTAGE != 0;
            let now = Shown { state: rig.state(name).into(), has_voltage };
            let locked = |state: &str| ["ERROR_STOP", "STOPPING"].contains(&state);
            let (was, is) = (before.state.as_str(), now.state.as_str());
            let object = Object::Axis(index as u16);
            let resets = news.iter().any(|event| event.kind == Kind::Reset && event.source == object);
            prop_assert!(was != "ERROR_STOP" || was == is || resets, "{} is {}, and nothing was reset", name, is);
            let returns = locked(was) && locked(is) && !before.has_voltage && has_voltage;
            prop_assert!(!returns, "{} is {}, and has its power back", name, is);
            let has_error = rig.int(&format!("{name}.error")) != 0;
            prop_assert!(is != "ERROR_STOP" || has_error, "{} has an error that nobody knows", name);
            let is_on = rig.int(&format!("{name}.enabled")) == 1;
            prop_assert!(is != "STANDSTILL" || is_on, "{} stands, and is off", name);
            prop_assert!(is != "DISABLED" || !is_on, "{} is off, and on", name);
            *before = now;
        }
        self.told = rig.events.len();
        Ok(())
    }
}
