//! Reduction steps of an open-loop axis: the allowed speed by the distance to the target.
//!
//! Law      v = min(present, speeds of all steps whose distance is reached); MD48: 0. Reached: <= MD45, < MD46, MD47,
//!          MD48
//! Reads    the distance to go, signed: below 0 the target is passed, and the output is off
//! Writes   the step to apply, if any
//! Source   WF-OLC-06 to 08, WF-LIM-02, W06

use super::State;
use crate::parameter::AxisParameters;

/// The steps of one axis: MD42 to 44 and MD45 to 48.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Steps {
    /// Speed values of steps 1, 2, 3.
    pub speeds: [i64; 3],
    /// Distances before the target at which steps 1, 2, 3 and the switch-off begin (inc).
    pub distances: [i64; 4],
}

/// States that begin at the distances.
const STATES: [State; 4] = [State::Step1, State::Step2, State::Step3, State::Settle];

impl Steps {
    pub(super) fn of(parameters: &AxisParameters) -> Self {
        let wf = &parameters.vocabularies.wf;
        Self { speeds: [wf.md42, wf.md43, wf.md44], distances: [wf.md45, wf.md46, wf.md47, wf.md48] }
    }

    /// Returns true if the distance of that index is reached with that distance to go.
    fn is_reached(&self, place: usize, left: i64) -> bool {
        let distance = self.distances.get(place).copied().unwrap_or(0);
        match place {
            0 => left <= distance,
            // Beyond the target the output is off, whatever the distance is and however far the axis moves in a cycle.
            3 => left < distance || left <= 0,
            _ => left < distance,
        }
    }

    /// Returns the slowest of the reached steps if it is slower than the present speed; [`State::Settle`] is off.
    pub(super) fn step_at(&self, present: i64, left: i64) -> Option<(State, i64)> {
        let mut due = None;
        let speeds = self.speeds.into_iter().chain([0]);
        for (place, (speed, state)) in speeds.zip(STATES).enumerate() {
            let slower = due.map_or(present, |(_, speed)| speed);
            if speed < slower && self.is_reached(place, left) {
                due = Some((if speed == 0 { State::Settle } else { state }, speed));
            }
        }
        due
    }

    /// Returns speed and state at the begin of a programmed speed.
    pub(super) fn begin(&self, programmed: i64, left: i64) -> (State, i64) {
        self.step_at(programmed, left).unwrap_or((State::Run, programmed))
    }
}
