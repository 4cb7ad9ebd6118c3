//! States and transitions of a lifecycle node, with the IDs and labels of the default state machine of rcl_lifecycle.

use lineshaft_msgs::foreign::lifecycle_msgs::msg::{self, State as Ids, Transition as Edges};

/// Lifecycle state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct State {
    pub id: u8,
    pub label: &'static str,
}

/// Lifecycle transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Transition {
    pub id: u8,
    pub label: &'static str,
    pub start: State,
    pub goal: State,
}

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Success,
    Failure,
    Error,
}

const fn state(id: u8, label: &'static str) -> State {
    State { id, label }
}

pub(super) const UNKNOWN: State = state(Ids::PRIMARY_STATE_UNKNOWN, "unknown");
pub(super) const UNCONFIGURED: State = state(Ids::PRIMARY_STATE_UNCONFIGURED, "unconfigured");
pub(super) const INACTIVE: State = state(Ids::PRIMARY_STATE_INACTIVE, "inactive");
pub(super) const ACTIVE: State = state(Ids::PRIMARY_STATE_ACTIVE, "active");
pub(super) const FINALIZED: State = state(Ids::PRIMARY_STATE_FINALIZED, "finalized");
pub(super) const CONFIGURING: State = state(Ids::TRANSITION_STATE_CONFIGURING, "configuring");
pub(super) const CLEANING_UP: State = state(Ids::TRANSITION_STATE_CLEANINGUP, "cleaningup");
pub(super) const SHUTTING_DOWN: State = state(Ids::TRANSITION_STATE_SHUTTINGDOWN, "shuttingdown");
pub(super) const ACTIVATING: State = state(Ids::TRANSITION_STATE_ACTIVATING, "activating");
pub(super) const DEACTIVATING: State = state(Ids::TRANSITION_STATE_DEACTIVATING, "deactivating");
pub(super) const ERROR_PROCESSING: State = state(Ids::TRANSITION_STATE_ERRORPROCESSING, "errorprocessing");

/// All states, in the order of rcl_lifecycle.
pub(super) const STATES: [State; 11] = [
    UNKNOWN,
    UNCONFIGURED,
    INACTIVE,
    ACTIVE,
    FINALIZED,
    CONFIGURING,
    CLEANING_UP,
    SHUTTING_DOWN,
    ACTIVATING,
    DEACTIVATING,
    ERROR_PROCESSING,
];

const SUCCESS: &str = "transition_success";
const FAILURE: &str = "transition_failure";
const ERROR: &str = "transition_error";

const fn edge(id: u8, label: &'static str, start: State, goal: State) -> Transition {
    Transition { id, label, start, goal }
}

/// All transitions, in the order of rcl_lifecycle.
pub(super) const TRANSITIONS: [Transition; 25] = [
    edge(Edges::TRANSITION_CONFIGURE, "configure", UNCONFIGURED, CONFIGURING),
    edge(Edges::TRANSITION_ON_CONFIGURE_SUCCESS, SUCCESS, CONFIGURING, INACTIVE),
    edge(Edges::TRANSITION_ON_CONFIGURE_FAILURE, FAILURE, CONFIGURING, UNCONFIGURED),
    edge(Edges::TRANSITION_ON_CONFIGURE_ERROR, ERROR, CONFIGURING, ERROR_PROCESSING),
    edge(Edges::TRANSITION_CLEANUP, "cleanup", INACTIVE, CLEANING_UP),
    edge(Edges::TRANSITION_ON_CLEANUP_SUCCESS, SUCCESS, CLEANING_UP, UNCONFIGURED),
    edge(Edges::TRANSITION_ON_CLEANUP_FAILURE, FAILURE, CLEANING_UP, INACTIVE),
    edge(Edges::TRANSITION_ON_CLEANUP_ERROR, ERROR, CLEANING_UP, ERROR_PROCESSING),
    edge(Edges::TRANSITION_ACTIVATE, "activate", INACTIVE, ACTIVATING),
    edge(Edges::TRANSITION_ON_ACTIVATE_SUCCESS, SUCCESS, ACTIVATING, ACTIVE),
    edge(Edges::TRANSITION_ON_ACTIVATE_FAILURE, FAILURE, ACTIVATING, INACTIVE),
    edge(Edges::TRANSITION_ON_ACTIVATE_ERROR, ERROR, ACTIVATING, ERROR_PROCESSING),
    edge(Edges::TRANSITION_DEACTIVATE, "deactivate", ACTIVE, DEACTIVATING),
    edge(Edges::TRANSITION_ON_DEACTIVATE_SUCCESS, SUCCESS, DEACTIVATING, INACTIVE),
    edge(Edges::TRANSITION_ON_DEACTIVATE_FAILURE, FAILURE, DEACTIVATING, ACTIVE),
    edge(Edges::TRANSITION_ON_DEACTIVATE_ERROR, ERROR, DEACTIVATING, ERROR_PROCESSING),
    edge(Edges::TRANSITION_UNCONFIGURED_SHUTDOWN, "shutdown", UNCONFIGURED, SHUTTING_DOWN),
    edge(Edges::TRANSITION_INACTIVE_SHUTDOWN, "shutdown", INACTIVE, SHUTTING_DOWN),
    edge(Edges::TRANSITION_ACTIVE_SHUTDOWN, "shutdown", ACTIVE, SHUTTING_DOWN),
    edge(Edges::TRANSITION_ON_SHUTDOWN_SUCCESS, SUCCESS, SHUTTING_DOWN, FINALIZED),
    edge(Edges::TRANSITION_ON_SHUTDOWN_FAILURE, FAILURE, SHUTTING_DOWN, FINALIZED),
    edge(Edges::TRANSITION_ON_SHUTDOWN_ERROR, ERROR, SHUTTING_DOWN, ERROR_PROCESSING),
    edge(Edges::TRANSITION_ON_ERROR_SUCCESS, SUCCESS, ERROR_PROCESSING, UNCONFIGURED),
    edge(Edges::TRANSITION_ON_ERROR_FAILURE, FAILURE, ERROR_PROCESSING, FINALIZED),
    edge(Edges::TRANSITION_ON_ERROR_ERROR, ERROR, ERROR_PROCESSING, FINALIZED),
];

impl State {
    /// Returns the transitions from this state.
    pub(super) fn transitions(self) -> impl Iterator<Item = Transition> {
        TRANSITIONS.into_iter().filter(move |transition| transition.start == self)
    }

    /// Returns the transition that a client requests. A label has precedence over the ID, which is 0 if it was not given.
    pub(super) fn requested_transition(self, wanted: &msg::Transition) -> Option<Transition> {
        let mut from_here = self.transitions();
        match wanted.label.as_str() {
            "" => from_here.find(|transition| transition.id == wanted.id),
            label => from_here.find(|transition| transition.label == label),
        }
    }

    /// Returns the transition at the end of a step in this state.
    pub(super) fn after(self, outcome: Outcome) -> Option<Transition> {
        let label = match outcome {
            Outcome::Success => SUCCESS,
            Outcome::Failure => FAILURE,
            Outcome::Error => ERROR,
        };
        self.transitions().find(|transition| transition.label == label)
    }

    pub(super) fn message(self) -> msg::State {
        msg::State { id: self.id, label: self.label.to_owned() }
    }
}

impl Transition {
    pub(super) fn message(self) -> msg::Transition {
        msg::Transition { id: self.id, label: self.label.to_owned() }
    }

    pub(super) fn description(self) -> msg::TransitionDescription {
        msg::TransitionDescription {
            transition: self.message(),
            start_state: self.start.message(),
            goal_state: self.goal.message(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn ask(state: State, id: u8, label: &str) -> Option<(u8, &'static str)> {
        let wanted = msg::Transition { id, label: label.to_owned() };
        state.requested_transition(&wanted).map(|transition| (transition.id, transition.goal.label))
    }

    #[test]
    fn ids_are_unique_and_each_state_can_be_reached() {
        let ids: BTreeSet<u8> = TRANSITIONS.iter().map(|transition| transition.id).collect();
        assert_eq!(ids.len(), TRANSITIONS.len());
        let states: BTreeSet<u8> = STATES.iter().map(|state| state.id).collect();
        assert_eq!(states.into_iter().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 10, 11, 12, 13, 14, 15]);
        for state in STATES {
            let reached = TRANSITIONS.iter().any(|transition| transition.goal == state);
            assert!(reached || state == UNKNOWN, "{state:?}");
            // Each step has all three results.
            let ends = [Outcome::Success, Outcome::Failure, Outcome::Error].map(|outcome| state.after(outcome));
            assert_eq!(ends.iter().all(Option::is_some), state.id >= Ids::TRANSITION_STATE_CONFIGURING, "{state:?}");
        }
    }

    #[test]
    fn label_has_precedence_over_id() {
        assert_eq!(ask(UNCONFIGURED, 1, ""), Some((1, "configuring")));
        assert_eq!(ask(UNCONFIGURED, 0, "configure"), Some((1, "configuring")));
        assert_eq!(ask(INACTIVE, 2, "activate"), Some((3, "activating")));
        for (state, id) in [(UNCONFIGURED, 5), (INACTIVE, 6), (ACTIVE, 7)] {
            assert_eq!(ask(state, 0, "shutdown"), Some((id, "shuttingdown")));
            assert_eq!(ask(state, id, ""), Some((id, "shuttingdown")));
        }
        for (state, id, label) in [
            (UNCONFIGURED, 3, ""),
            (UNCONFIGURED, 0, ""),
            (UNCONFIGURED, 1, "activate"),
            (ACTIVE, 1, ""),
            (ACTIVE, 0, "Deactivate"),
            (ACTIVE, 30, "transition_success"),
            (FINALIZED, 0, "shutdown"),
            (FINALIZED, 8, "destroy"),
        ] {
            assert_eq!(ask(state, id, label), None, "{} {id} {label}", state.label);
        }
    }
}
