//! Homing by a simulated drive itself: without ramps, increment by increment, so that it is exact at any velocity.
//!
//! Law      the phases of the method, one increment after the other; afterwards the reference is the zero of the counts
//! Source   CiA 402-2, homing mode

use super::Fixtures;
use crate::axis::homing_methods::{Leg, Speed, Switch, Until, legs};
use crate::drive::inputs;

/// Maximum increments per cycle.
const MOST: f64 = 1e6;

/// Homing by a drive, or its result.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DriveHoming {
    method: i8,
    leg: usize,
    turned: bool,
    /// Reference that was found; the counts restart in the next cycle, in which the axis rests.
    found: Option<i64>,
    /// Whether homing runs.
    pub runs: bool,
    pub attained: bool,
    pub failed: bool,
}

/// Switches and index along the travel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    pub fixtures: Fixtures,
    pub has_index: bool,
    /// Stuck bits of the digital inputs, and their values.
    pub stuck: (u32, u32),
}

impl Track {
    fn is_on(&self, place: i64, switch: Switch) -> bool {
        let (mask, value) = self.stuck;
        let bit = match switch {
            Switch::Home => inputs::HOME,
            Switch::Positive => inputs::POSITIVE_LIMIT,
            Switch::Negative => inputs::NEGATIVE_LIMIT,
        };
        (self.fixtures.inputs(place) & !mask | value) & bit != 0
    }
}

impl DriveHoming {
    /// Starts homing at the rising start bit.
    pub(super) fn start(method: i8) -> Self {
        Self { method, runs: true, ..Self::default() }
    }

    fn leg(&self) -> Option<&'static Leg> {
        legs(self.method.into()).get(self.leg)
    }

    /// Executes one cycle from `place`, with the increments of the search and of the approach to the zero: returns the
    /// new position, and the reference once it is found.
    pub(super) fn step(&mut self, place: i64, [search, zero]: [f64; 2], way: &Track) -> (i64, Option<i64>) {
        if let Some(reference) = self.found {
            (self.runs, self.attained) = (false, true);
            return (place, Some(reference));
        }
        if matches!(self.method, 35 | 37) {
            (self.runs, self.attained) = (false, true);
            return (place, Some(place));
        }
        let Some(leg) = self.leg() else {
            (self.runs, self.failed) = (false, true);
            return (place, None);
        };
        let step = if leg.speed == Speed::Slow { zero } else { search };
        let count = step.abs().clamp(1.0, MOST) as i64;
        let mut here = place;
        for _ in 0..count {
            let Some(leg) = self.leg().filter(|_| self.runs && self.found.is_none()) else { break };
            let next = here.wrapping_add(i64::from(if self.turned { -leg.way } else { leg.way }));
            self.found = self.find_reference(leg, here, next, way);
            here = next;
        }
        (here, None)
    }

    /// Returns the reference if the step from `here` to `next` finds it.
    fn find_reference(&mut self, leg: &Leg, here: i64, next: i64, way: &Track) -> Option<i64> {
        let is_on = |place: i64, switch: Switch| way.is_on(place, switch);
        let (edge, place) = match leg.until {
            Until::On(switch) if self.leg == 0 && is_on(here, switch) => (true, here),
            Until::On(switch) => (!is_on(here, switch) && is_on(next, switch), next),
            Until::Off(switch) => (is_on(here, switch) && !is_on(next, switch), here),
            Until::Index => (way.has_index && way.fixtures.index_passed(here, next).is_some(), next),
        };
        if edge {
            (self.leg, self.turned) = (self.leg + 1, false);
            return self.leg().is_none().then_some(place);
        }
        let ahead = if next > here { Switch::Positive } else { Switch::Negative };
        let is_target = matches!(leg.until, Until::On(switch) | Until::Off(switch) if switch == ahead);
        if !is_target && is_on(next, ahead) {
            (self.runs, self.failed) = if leg.turns && !self.turned { (true, false) } else { (false, true) };
            self.turned = true;
        }
        None
    }
}
