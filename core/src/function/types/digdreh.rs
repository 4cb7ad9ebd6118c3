//! Speed that binary inputs switch on and off.
//!
//! Law      a rising E2 while E1 = 1 and E3 = 0 makes the speed n_e; E3 = 1 or E1 = 0 makes it 0, with priority over
//!          E2; no ramp; A1 = 1 while the speed is 0
//! Reads    E1 enable, E2 start, E3 stop; E2 = 1 at START is no edge
//! Writes   the sink (0.0001 rpm), A1
//! Refuses  only values outside the ranges of the fields
//! Source   AMK-DIGDREH-01 to -08 with

use crate::function::guest::*;
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new("speed", i32::MIN as i64, i32::MAX as i64, "0.0001 rpm", "speed n_e while it runs", "AMK-DIGDREH-03")
        .idle("the function gives no speed"),
    Field::new("mode", 0, 0, "", "not used", "AMK-DIGDREH-03"),
];

const ENABLE: u8 = 1 << 0;
const BEGIN: u8 = 1 << 1;
const STOP: u8 = 1 << 2;

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct SpeedSwitch {
    speed: i64,
    runs: bool,
    /// Inputs of the last call.
    last_inputs: u8,
}

impl SlotType for SpeedSwitch {
    const DESCRIPTION: Description = Description {
        source: Requirement::Never,
        quantity: Quantity::Speed,
        moves_axes: true,
        inputs: 3,
        outputs: 1,
        rests: 1,
        amk: AmkLimits { sink_widths: &[Width::W32], ..AmkLimits::USUAL },
        ..Description::of(Kind::Digdreh, "digdreh", "switches a speed on and off by inputs", FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self::default()
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        *self = Self { speed: words.get(place(FIELDS, "speed")), runs: false, last_inputs: seen.inputs };
        self.step(seen)
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let rising = seen.inputs & !std::mem::replace(&mut self.last_inputs, seen.inputs);
        let may_run = seen.inputs & (ENABLE | STOP) == ENABLE;
        self.runs = may_run && (self.runs || rising & BEGIN != 0);
        let sink = if self.runs { self.speed } else { 0 };
        // n_e may be 0: then the speed is 0 and A1 is 1 (AMK-DIGDREH-02).
        Outcome { sink, outputs: (sink == 0).into(), writes: 1, ..Outcome::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::function::trial::{at_rest, set};
    use proptest::prelude::*;

    const RPM: i64 = 10_000;

    /// Returns speed and A1 of each call; the first one is START.
    fn switched(speed: i64, inputs: &[u8]) -> Vec<(i64, u8)> {
        let (words, mut digdreh) = (set(FIELDS, &[("speed", speed)]), SpeedSwitch::new(&SlotSetup::default()));
        let mut given = Vec::new();
        for (k, inputs) in inputs.iter().enumerate() {
            let seen = CallInputs { inputs: *inputs, ..at_rest() };
            let outcome = if k == 0 { digdreh.start(Words(&words), &seen) } else { digdreh.step(&seen) };
            assert_eq!(outcome.writes, 1);
            given.push((outcome.sink, outcome.outputs));
        }
        given
    }

    const REST: (i64, u8) = (0, 1);
    const RUN: (i64, u8) = (1000 * RPM, 0);

    /// Proves: AMK-DIGDREH-01, AMK-DIGDREH-02, AMK-DIGDREH-05, AMK-DIGDREH-06, AMK-DIGDREH-07, AMK-DIGDREH-O1
    #[test]
    fn a_start_edge_runs_until_a_stop_or_the_end_of_enable() {
        let (speed, unit) = (10_000_000, FIELDS.first().map(|field| field.unit));
        assert_eq!(unit, Some("0.0001 rpm"));
        // Enabled, start, start released: it keeps running.
        assert_eq!(switched(speed, &[0b000, 0b001, 0b011, 0b001]), [REST, REST, RUN, RUN]);
        // Stop; a start that stays 1 does not start again.
        assert_eq!(switched(speed, &[0b001, 0b011, 0b111, 0b011, 0b001, 0b011]), [REST, RUN, REST, REST, REST, RUN]);
        // Enable is switched off and on again: a new edge is needed.
        assert_eq!(switched(speed, &[0b001, 0b011, 0b010, 0b011, 0b001, 0b011]), [REST, RUN, REST, REST, REST, RUN]);
    }

    #[test]
    fn stop_wins_over_start_and_an_edge_without_enable_is_lost() {
        assert_eq!(switched(1, &[0b101, 0b111, 0b011]), [REST; 3]);
        assert_eq!(switched(1, &[0b000, 0b010, 0b011]), [REST; 3]);
        // Both are set in one call: the edge counts.
        assert_eq!(switched(1000 * RPM, &[0b000, 0b011]), [REST, RUN]);
    }

    #[test]
    fn a_start_that_stands_at_the_first_call_is_no_edge() {
        assert_eq!(switched(1, &[0b011, 0b011]), [REST; 2]);
    }

    #[test]
    fn the_limits_of_the_speed_pass_and_a_speed_of_0_is_rest() {
        assert_eq!(switched(i32::MIN.into(), &[1, 3])[1], (-2_147_483_648, 0));
        assert_eq!(switched(i32::MAX.into(), &[1, 3])[1], (2_147_483_647, 0));
        assert_eq!(switched(0, &[1, 3])[1], REST);
    }

    proptest! {
        /// It runs if there was an edge with enable and without stop, and neither condition has changed since then.
        #[test]
        fn runs_if_last_valid_edge_follows_last_stop(
            inputs in proptest::collection::vec(0_u8..8, 1..60),
        ) {
            let is_free = |k: usize| inputs[k] & 0b101 == 0b001;
            let is_edge = |k: usize| k > 0 && inputs[k] & 2 != 0 && inputs[k - 1] & 2 == 0;
            for (k, given) in switched(RPM, &inputs).into_iter().enumerate() {
                let since = (0..=k).rev().take_while(|at| is_free(*at)).last().unwrap_or(k + 1);
                let runs = (since..=k).any(is_edge);
                prop_assert_eq!(given, if runs { (RPM, 0) } else { (0, 1) });
            }
        }
    }
}
