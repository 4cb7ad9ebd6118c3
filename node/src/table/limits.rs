//! Checks whether an axis can follow a table, and calculates the maximum speed of its master.
//!
//! Law      at a master speed w a slave has velocity y' w, acceleration y'' w^2, jerk y''' w^3; the maximum speed is
//!          the minimum of v / |y'|, sqrt(a / |y''|), sqrt(d / |y''|) for decelerations, cbrt(j / |y'''|). A jump is
//!          infinite in the next derivative
//! Reads    the derivatives of a table, the limits of an axis; the master runs forward

use super::motion::Extremes;
use lineshaft_core::law::{Jump, Peak};
use lineshaft_core::parameter::AxisParameters;

/// A limit of an axis, and the demand of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Demand {
    /// Key of the limit.
    pub(crate) key: &'static str,
    /// 1 velocity, 2 acceleration, 3 jerk.
    pub(crate) order: u8,
    /// Limit, in inc/s^order.
    pub(crate) limit: f64,
    /// Maximum of the table, per increment of the master; infinite at a jump.
    pub(crate) peak: Peak,
}

impl Demand {
    /// Returns the demand at a speed of the master, in inc/s.
    pub(crate) fn at(&self, speed: f64) -> f64 {
        self.peak.value * speed.powi(self.order.into())
    }

    /// Returns the maximum speed of the master that it permits, in inc/s.
    pub(crate) fn fastest(&self) -> f64 {
        let ratio = self.limit / self.peak.value;
        match self.order {
            1 => ratio,
            2 => ratio.sqrt(),
            _ => ratio.cbrt(),
        }
    }

    /// Whether the table respects the limit. At the maximum speed it does, whatever the rounding errors are.
    pub(crate) fn is_met(&self, speed: f64) -> bool {
        self.at(speed) <= self.limit * (1.0 + 1e-12)
    }
}

/// Returns the demands of a table on the limits of an axis; without `max_jerk` any jerk is permitted.
pub(crate) fn demands(extremes: &Extremes, parameters: &AxisParameters) -> Vec<Demand> {
    let of = |key, order, limit, peak| Demand { key, order, limit, peak };
    let (mut faster, mut slower, mut jerk) = (extremes.acceleration, extremes.deceleration, extremes.jerk);
    for jump in &extremes.jumps {
        let endless = Peak { value: f64::INFINITY, at: jump.at };
        if jump.derivative > 1 {
            jerk = if jerk.value.is_infinite() { jerk } else { endless };
            continue;
        }
        if is_faster(jump) && faster.value.is_finite() {
            faster = endless;
        }
        if !is_faster(jump) && slower.value.is_finite() {
            slower = endless;
        }
    }
    let mut demands = vec![
        of("max_velocity", 1, parameters.max_velocity, extremes.velocity),
        of("max_acceleration", 2, parameters.max_acceleration, faster),
        of("max_deceleration", 2, parameters.deceleration_limit(), slower),
    ];
    demands.extend(parameters.max_jerk.map(|limit| of("max_jerk", 3, limit, jerk)));
    demands
}

/// Whether the slave is faster after a jump of its velocity.
fn is_faster(jump: &Jump) -> bool {
    jump.after.abs() > jump.before.abs()
}

/// Returns the demand that limits the speed most.
pub(crate) fn binding(demands: &[Demand]) -> Option<&Demand> {
    demands.iter().min_by(|a, b| a.fastest().total_cmp(&b.fastest()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn extremes([velocity, acceleration, deceleration, jerk]: [f64; 4]) -> Extremes {
        let [velocity, acceleration, deceleration, jerk] =
            [velocity, acceleration, deceleration, jerk].map(|value| Peak { value, at: 7.0 });
        Extremes { velocity, acceleration, deceleration, jerk, jumps: Vec::new() }
    }

    fn axis(limits: [f64; 4]) -> AxisParameters {
        let [velocity, acceleration, deceleration, jerk] = limits;
        let parameters = AxisParameters::new(velocity, acceleration);
        AxisParameters { max_deceleration: Some(deceleration), max_jerk: Some(jerk), ..parameters }
    }

    #[test]
    fn each_limit_binds_where_it_is_the_least() {
        let asked = extremes([2.0, 0.01, 0.02, 1e-4]);
        for (limits, key, fastest) in [
            ([1000.0, 1e9, 1e9, 1e12], "max_velocity", 500.0),
            ([1e6, 10_000.0, 1e9, 1e12], "max_acceleration", 1000.0),
            ([1e6, 1e9, 20_000.0, 1e12], "max_deceleration", 1000.0),
            ([1e6, 1e9, 1e9, 100.0], "max_jerk", 100.0),
        ] {
            let demands = demands(&asked, &axis(limits));
            let bound = binding(&demands).expect("four of them");
            assert_eq!((bound.key, (bound.fastest() - fastest).abs() < 1e-9), (key, true), "{bound:?}");
        }
        let without = AxisParameters { max_jerk: None, ..axis([1.0; 4]) };
        assert_eq!(demands(&asked, &without).len(), 3);
    }

    #[test]
    fn a_jump_has_no_speed_that_is_slow_enough() {
        let jump = |derivative, before, after| {
            let jumps = vec![Jump { at: 3.0, derivative, before, after }];
            let asked = Extremes { jumps, ..extremes([1.0, 0.0, 0.0, 0.0]) };
            let demands = demands(&asked, &axis([1.0; 4]));
            let bound = *binding(&demands).expect("four of them");
            (bound.key, bound.fastest(), bound.peak.at, bound.is_met(1e-9))
        };
        assert_eq!(jump(1, 0.0, 1.0), ("max_acceleration", 0.0, 3.0, false));
        assert_eq!(jump(1, -1.0, 0.0), ("max_deceleration", 0.0, 3.0, false));
        assert_eq!(jump(2, 0.0, 1.0), ("max_jerk", 0.0, 3.0, false));
    }

    #[test]
    fn what_stands_still_runs_at_any_speed() {
        let demands = demands(&extremes([0.0; 4]), &axis([1.0; 4]));
        assert!(binding(&demands).expect("four of them").fastest().is_infinite());
        assert!(demands.iter().all(|demand| demand.is_met(1e12)));
    }

    proptest! {
        /// At the maximum speed all limits are respected, slightly above it one is not.
        #[test]
        fn the_fastest_speed_is_the_edge(asked in proptest::array::uniform4(1e-6_f64..10.0), limits in proptest::array::uniform4(1.0_f64..1e9)) {
            let demands = demands(&extremes(asked), &axis(limits));
            let fastest = binding(&demands).expect("four of them").fastest();
            prop_assert!(demands.iter().all(|demand| demand.is_met(fastest)));
            prop_assert!(demands.iter().any(|demand| !demand.is_met(fastest * 1.000_001)));
        }
    }
}
