//! State of the controllers, and the effects of a deactivation.

use super::plan::Plan;
use crate::surface::host::SubmitError;
use crate::surface::trajectory::Joints;
use lineshaft_core::object::AxisSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Controller: the axes that one action and one topic move.
#[derive(Clone, Debug)]
pub(in crate::surface) struct Controller {
    /// Name of its group; without groups that of the node.
    pub name: String,
    pub joints: Arc<Joints>,
}

/// Controller manager that the cell names.
#[derive(Clone, Debug)]
pub(in crate::surface) struct Manager(String);

impl Manager {
    /// Returns its absolute name.
    pub(super) fn name(&self) -> &str {
        &self.0
    }

    /// Logs the name of the controller manager with which MoveIt finds the actions, if this one does not match.
    pub(super) fn log_names(&self, node: &str, controllers: &[Controller]) {
        let namespace = self.0.rsplit_once('/').map_or("", |(namespace, _)| namespace);
        let Some(missed) =
            controllers.iter().find(|one| one.joints.prefix(node) != format!("{namespace}/{}", one.name))
        else {
            return;
        };
        let prefix = missed.joints.prefix(node);
        let wanted = prefix.rsplit_once('/').map_or("", |(namespace, _)| namespace);
        tracing::info!(
            "controller_manager is {}: MoveIt looks for {namespace}/{}/follow_joint_trajectory, and the action is \
             {prefix}/follow_joint_trajectory; `controller_manager: {wanted}/controller_manager` makes them the same",
            self.0,
            missed.name
        );
    }
}

/// State of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    is_active: bool,
    /// Command number of its newest trajectory, until the machine has read it. A halt can overtake a trajectory that waits for its cycle.
    pending: Option<u64>,
}

/// All controllers, in the order of the groups.
#[derive(Debug)]
pub(in crate::surface) struct Controllers {
    manager: Option<Manager>,
    all: Vec<Controller>,
    states: Mutex<Vec<State>>,
}

impl Controllers {
    /// Creates a controller for each of `joints`; all are active. Without a manager they stay active. `node` is the name of the node.
    pub(in crate::surface) fn new(manager: Option<&str>, node: &str, joints: Vec<Joints>) -> Self {
        let named =
            |joints: Joints| Controller { name: joints.group().unwrap_or(node).to_owned(), joints: Arc::new(joints) };
        let all: Vec<_> = joints.into_iter().map(named).collect();
        let states = Mutex::new(vec![State { is_active: true, pending: None }; all.len()]);
        Self { manager: manager.map(|name| Manager(name.to_owned())), all, states }
    }

    pub(super) fn manager(&self) -> Option<&Manager> {
        self.manager.as_ref()
    }

    /// Returns all controllers, in the order of the groups.
    pub(in crate::surface) fn all(&self) -> &[Controller] {
        &self.all
    }

    fn states(&self) -> MutexGuard<'_, Vec<State>> {
        // After a panic of another thread the states are consistent, because each change is one step.
        self.states.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns for each controller whether it is active.
    pub(super) fn active(&self) -> Vec<bool> {
        self.states().iter().map(|state| state.is_active).collect()
    }

    /// Checks that the controller at this index accepts trajectories.
    ///
    /// # Errors
    /// It is inactive; the message says how to activate it.
    pub(in crate::surface) fn check(&self, place: usize) -> Result<(), String> {
        let is_active = self.states().get(place).is_none_or(|state| state.is_active);
        if is_active { Ok(()) } else { Err(self.refusal(place)) }
    }

    fn refusal(&self, place: usize) -> String {
        let (Some(manager), Some(controller)) = (&self.manager, self.all.get(place)) else { return String::new() };
        let (name, manager) = (&controller.name, manager.name());
        let what = if controller.joints.group().is_some() { "group" } else { "controller" };
        format!(
            "{what} {name} is inactive; activate it first (`ros2 control switch_controllers -c {manager} --activate {name}`)"
        )
    }

    /// Submits a trajectory of the controller at this index. No controller is switched meanwhile. `number` returns the number of the
    /// command.
    ///
    /// # Errors
    /// The controller is inactive; the message says how to activate it.
    pub(in crate::surface) fn while_active<T>(
        &self,
        place: usize,
        hand_over: impl FnOnce() -> T,
        number: impl FnOnce(&T) -> Option<u64>,
    ) -> Result<T, String> {
        let mut states = self.states();
        let Some(state) = states.get_mut(place).filter(|state| state.is_active) else {
            return Err(self.refusal(place));
        };
        let given = hand_over();
        if self.manager.is_some() {
            state.pending = number(&given).or(state.pending);
        }
        Ok(given)
    }

    /// Records that the machine has read a trajectory, and executes or refuses it.
    pub(in crate::surface) fn record_read(&self, place: usize, sequence: u64) {
        if let Some(state) = self.states().get_mut(place)
            && state.pending == Some(sequence)
        {
            state.pending = None;
        }
    }

    /// Returns true if trajectories of the topic must be tracked until they are read.
    pub(in crate::surface) fn has_manager(&self) -> bool {
        self.manager.is_some()
    }

    /// Switches all controllers of a plan, or none. `cancel` ends a trajectory that waits for its cycle, `halt` the motion of axes. Returns
    /// the result of `halt` if a controller was deactivated while cycles run.
    ///
    /// # Errors
    /// The machine accepts no further commands at present; no controller was switched.
    pub(super) fn switch<T>(
        &self,
        plan: &Plan,
        cancel: impl Fn(u64) -> Result<u64, SubmitError>,
        halt: impl FnOnce(AxisSet) -> Result<T, SubmitError>,
    ) -> Result<Option<T>, SubmitError> {
        let mut states = self.states();
        let (mut axes, mut pending) = (AxisSet::EMPTY, Vec::new());
        for place in &plan.deactivate {
            if let (Some(state), Some(controller)) = (states.get(*place), self.all.get(*place))
                && state.is_active
            {
                axes = axes.union(&controller.joints.axes.iter().copied().collect());
                pending.extend(state.pending);
            }
        }
        let halted = if axes.is_empty() { None } else { ignore_unconfigured(halt_all(&pending, cancel, axes, halt))? };
        for (places, is_active) in [(&plan.deactivate, false), (&plan.activate, true)] {
            for place in places {
                if let Some(state) = states.get_mut(*place) {
                    *state = State { is_active, ..*state };
                }
            }
        }
        Ok(halted)
    }
}

/// The machine reads cancels after waiting trajectories, but halts before them: both are needed.
fn halt_all<T>(
    pending: &[u64],
    cancel: impl Fn(u64) -> Result<u64, SubmitError>,
    axes: AxisSet,
    halt: impl FnOnce(AxisSet) -> Result<T, SubmitError>,
) -> Result<T, SubmitError> {
    for goal in pending {
        cancel(*goal)?;
    }
    halt(axes)
}

/// While no cycles run nothing moves, so there is nothing to halt.
fn ignore_unconfigured<T>(given: Result<T, SubmitError>) -> Result<Option<T>, SubmitError> {
    match given {
        Ok(given) => Ok(Some(given)),
        Err(SubmitError::Unconfigured) => Ok(None),
        Err(busy) => Err(busy),
    }
}
