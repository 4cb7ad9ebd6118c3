//! Laws for every plan, checked by its evaluated motion.

use super::*;
use proptest::prelude::*;

/// Cycle time (s).
const CYCLE: f64 = 1e-3;
/// Relative rounding error.
const ROUNDING: f64 = 1e-9;

/// Magnitudes for the rounding errors of f64: distance from the start or the end (inc), and time (s).
#[derive(Clone, Copy, Debug)]
struct Digits {
    way: f64,
    time: f64,
}

impl Digits {
    fn of(plan: &Plan) -> Self {
        let (low, high) = plan.extent();
        Self { way: distance(low, high), time: plan.duration() }
    }
}

#[derive(Clone, Copy, Debug)]
struct Case {
    start: Motion,
    target: Position,
    end_velocity: f64,
    limits: Limits,
}

impl Case {
    fn plan(&self) -> Plan {
        to_pass(self.start, self.target, self.end_velocity, &self.limits, MS)
    }

    fn jerks(&self) -> Option<Jerks> {
        if let Shape::Jerk(jerks) = self.limits.shape { Some(jerks) } else { None }
    }

    fn greatest_jerk(&self) -> f64 {
        let jerks = self.jerks().expect("a plan with jerks");
        jerks.rise.max(jerks.fall).max(jerks.brake_rise).max(jerks.brake_fall)
    }

    fn greatest_acceleration(&self) -> f64 {
        let start = if self.limits.shape == Shape::Trapezoid { 0.0 } else { self.start.acceleration.abs() };
        self.limits.acceleration.max(self.limits.deceleration).max(start)
    }

    /// Returns the cycles to check: all, or the first and the last ones of a long plan; the last ones only if the time
    /// still resolves a cycle.
    fn cycles(plan: &Plan) -> impl Iterator<Item = u64> {
        let (most, all) = (1500, plan.cycles());
        let last = if plan.duration() < 1e5 { all } else { 0 };
        (1..=all.min(most)).chain(all.saturating_sub(most).max(most + 1)..=last)
    }

    /// Returns which limits apply: those of increasing and of decreasing |velocity|; both if the velocity is rounding.
    fn sides(&self, now: Motion) -> (bool, bool) {
        let is_rest = now.velocity.abs() <= 1e-7 * self.limits.velocity;
        let grows = now.velocity * now.acceleration >= 0.0;
        (is_rest || grows, is_rest || !grows)
    }

    fn check_limits(&self, now: Motion) -> Result<(), TestCaseError> {
        let Limits { velocity: top, acceleration, deceleration, shape } = self.limits;
        let more = 1.0 + ROUNDING;
        let (grows, brakes) = self.sides(now);
        let of = |grow: f64, brake: f64| (if grows { grow } else { 0.0_f64 }).max(if brakes { brake } else { 0.0 });
        let limit = of(acceleration, deceleration);
        let is_beyond = now.acceleration.abs() > limit * more;
        if shape == Shape::Trapezoid {
            prop_assert!(!is_beyond, "{now:?} beyond {limit}");
        } else if is_beyond {
            prop_assert!(now.jerk * now.acceleration < 0.0, "{now:?} beyond {limit} and not falling");
        }
        if now.velocity.abs() > top * more {
            let falls = now.velocity * now.acceleration <= 0.0;
            let eases = now.velocity * now.jerk < 0.0;
            prop_assert!(falls || eases, "{now:?} beyond {top} and not falling");
        }
        if let Shape::Jerk(jerks) = shape {
            let limit = if now.acceleration.abs() <= 1e-7 * limit {
                self.greatest_jerk()
            } else if now.jerk * now.acceleration > 0.0 {
                of(jerks.rise, jerks.brake_rise)
            } else {
                of(jerks.fall, jerks.brake_fall)
            };
            prop_assert!(now.jerk.abs() <= limit * more, "{now:?}: jerk beyond {limit}");
        }
        Ok(())
    }

    /// Checks that position and velocity are the integrals of velocity and acceleration from one cycle to the next.
    fn check_step(&self, digits: Digits, before: Motion, now: Motion) -> Result<(), TestCaseError> {
        let way = distance(before.position, now.position);
        let by_velocity = 0.5 * (before.velocity + now.velocity) * CYCLE;
        let change = now.velocity - before.velocity;
        let by_acceleration = 0.5 * (before.acceleration + now.acceleration) * CYCLE;
        let fastest = before.velocity.abs().max(now.velocity.abs());
        let rounding = 3e-6 + 1e-15 * (digits.way + fastest * digits.time);
        let (position_error, velocity_error) = if self.jerks().is_some() {
            let jerk = self.greatest_jerk();
            let step = (now.acceleration - before.acceleration).abs();
            prop_assert!(step <= jerk * CYCLE * (1.0 + 1e-6) + ROUNDING, "{before:?} {now:?}: acceleration");
            (jerk * CYCLE * CYCLE * CYCLE / 12.0, jerk * CYCLE * CYCLE / 4.0)
        } else {
            let most = self.greatest_acceleration();
            (most * CYCLE * CYCLE / 4.0, 2.0 * most * CYCLE)
        };
        let top = self.limits.velocity.max(before.velocity.abs());
        prop_assert!(
            (way - by_velocity).abs() <= position_error * (1.0 + 1e-6) + rounding,
            "{before:?} {now:?}: way {way} instead of {by_velocity}, allowed {position_error}"
        );
        prop_assert!(
            (change - by_acceleration).abs() <= velocity_error * (1.0 + 1e-6) + ROUNDING * top,
            "{before:?} {now:?}: velocity"
        );
        Ok(())
    }

    /// Checks that the rest of the motion is within the extent that the plan returns from there.
    fn check_ahead(&self, plan: &Plan, digits: Digits) -> Result<(), TestCaseError> {
        if self.end_velocity != 0.0 || plan.cycles() > 2000 {
            return Ok(());
        }
        let rounding = Position::from_f64(1e-6 + 1e-15 * digits.way);
        let (mut low, mut high) = (plan.end(), plan.end());
        for k in (0..plan.cycles()).rev() {
            let now = plan.at(k).position;
            (low, high) = (low.min(now), high.max(now));
            if k % 16 == 0 {
                let (least, most) = plan.extent_from(now);
                prop_assert!(least <= low + rounding && most >= high - rounding, "cycle {k}: {low:?} {high:?}");
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), TestCaseError> {
        let plan = self.plan();
        prop_assert!(plan.duration().is_finite() && plan.is_sound());
        let digits = Digits::of(&plan);
        let (low, high) = plan.extent();
        self.check_ahead(&plan, digits)?;
        let first = plan.at(0);
        prop_assert_eq!(first.position, self.start.position);
        let mut before = self.start;
        if self.limits.shape == Shape::Trapezoid || plan.cycles() == 0 {
            before.acceleration = first.acceleration;
        }
        let start_is_smooth = (first.velocity - before.velocity).abs() <= ROUNDING * self.limits.velocity
            && (first.acceleration - before.acceleration).abs() <= 1e-6 * self.greatest_acceleration();
        // An S-ramp drops an acceleration for whose end there is no room.
        prop_assert!(start_is_smooth || self.limits.shape == Shape::SRamp, "{before:?} {first:?}");
        for k in Self::cycles(&plan) {
            let now = plan.at(k);
            self.check_limits(now)?;
            if self.end_velocity == 0.0 {
                let beyond = distance(now.position, low).max(distance(high, now.position));
                prop_assert!(beyond <= 1e-6 + 1e-15 * digits.way, "cycle {k}: {now:?} beyond {low:?} {high:?}");
            }
            let last = if k == 1 { before } else { plan.at(k - 1) };
            self.check_step(digits, last, now).map_err(|e| TestCaseError::fail(format!("cycle {k}: {e}")))?;
        }
        let end = plan.at(plan.cycles());
        let over = Position::from_f64(self.end_velocity * plan.overshoot(plan.cycles()));
        prop_assert_eq!(end.position, self.target + over);
        prop_assert_eq!((end.velocity, end.acceleration, end.jerk), (self.end_velocity, 0.0, 0.0));
        Ok(())
    }

    /// Checks that the same task, planned again during the motion, takes the same time.
    fn check_replanned(&self, share: f64) -> Result<(), TestCaseError> {
        let plan = self.plan();
        let k = (share * plan.cycles() as f64) as u64;
        let again = Case { start: plan.at(k), ..*self }.plan();
        let left = plan.duration() - k as f64 * CYCLE;
        // A cycle must exceed the rounding error of the time.
        if k < plan.cycles() && plan.duration() < 1e4 {
            let difference = (again.duration() - left).abs();
            prop_assert!(difference < CYCLE, "cycle {k}: {} s instead of {left} s", again.duration());
        }
        Ok(())
    }

    fn check_stop(&self) -> Result<(), TestCaseError> {
        let plan = stop(self.start, &self.limits, MS);
        let way = distance(self.start.position, plan.end());
        let told = stopping_distance(self.start, &self.limits);
        prop_assert!((way - told).abs() <= 1e-6 + 1e-12 * way.abs(), "way {way}, told {told}");
        let digits = Digits::of(&plan);
        for k in Self::cycles(&plan) {
            let now = plan.at(k);
            self.check_limits(now)?;
            self.check_step(digits, plan.at(k - 1), now)?;
        }
        prop_assert_eq!(plan.at(plan.cycles()), Motion::at_rest(plan.end()));
        Ok(())
    }

    fn check_velocity(&self) -> Result<(), TestCaseError> {
        let plan = to_velocity(self.start, self.end_velocity, &self.limits, MS);
        let digits = Digits::of(&plan);
        let beyond = plan.cycles().saturating_add(1)..plan.cycles().saturating_add(4);
        for k in Self::cycles(&plan).chain(beyond) {
            let now = plan.at(k);
            self.check_limits(now)?;
            self.check_step(digits, plan.at(k - 1), now)?;
        }
        prop_assert_eq!(plan.at(plan.cycles().saturating_add(7)).velocity, self.end_velocity);
        Ok(())
    }
}

fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(libm::exp10)
}

/// A number up to 1: usually any, sometimes a special one.
fn share() -> impl Strategy<Value = f64> {
    prop_oneof![6 => -1.0..1.0_f64, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(-1.0), 1 => -1e-12..1e-12_f64]
}

fn shape() -> impl Strategy<Value = Shape> {
    let jerk = || magnitude(2.0, 8.0);
    let even = jerk().prop_map(|rise| Jerks { rise, fall: rise, brake_rise: rise, brake_fall: rise });
    let uneven = (jerk(), jerk(), jerk(), jerk()).prop_map(|(rise, fall, brake_rise, brake_fall)| Jerks {
        rise,
        fall,
        brake_rise,
        brake_fall,
    });
    prop_oneof![
        1 => Just(Shape::Trapezoid),
        1 => Just(Shape::SRamp),
        3 => even.prop_map(Shape::Jerk),
        3 => uneven.prop_map(Shape::Jerk),
    ]
}

prop_compose! {
    /// `excess`: largest factor by which a start may exceed its limits; 1: within them.
    fn case(excess: f64, ends: bool)(
        shape in shape(),
        (velocity, acceleration, deceleration) in (magnitude(1.0, 6.0), magnitude(1.0, 7.0), magnitude(1.0, 7.0)),
        even in any::<bool>(),
        (v, a, end) in (share(), share(), share()),
        start in -1e6..1e6_f64,
        way in prop_oneof![(share(), magnitude(0.0, 7.0)).prop_map(|(s, m)| s * m), Just(0.0), Just(1.0)],
    ) -> Case {
        let limits = Limits { velocity, acceleration, deceleration: if even { acceleration } else { deceleration }, shape };
        let position = Position::from_f64(start);
        Case {
            start: Motion { position, velocity: v * excess * velocity, acceleration: a * excess * acceleration, jerk: 0.0 },
            target: Position::whole((start + way) as i64),
            end_velocity: if ends { 0.0 } else { end * velocity },
            limits,
        }
    }
}

/// Returns the requested number of cases, or a number for some seconds.
fn config(cases: u32) -> ProptestConfig {
    let long = std::env::var_os("LINESHAFT_LONG").is_some();
    ProptestConfig::with_cases(if long { 30_000 } else { cases })
}

proptest! {
    #![proptest_config(config(600))]

    /// Proves: MACS-PROF-07, MACS-PROF-08, MACS-PROF-09, MACS-PROF-10, MACS-PROF-11
    #[test]
    fn a_move_keeps_its_limits_and_lands(case in case(1.0, true)) {
        case.check()?;
    }

    #[test]
    fn a_pass_keeps_its_limits_and_lands(case in case(1.0, false)) {
        case.check()?;
    }

    #[test]
    fn values_beyond_their_limits_return(case in case(3.0, false)) {
        case.check()?;
    }

    #[test]
    fn replanned_task_takes_the_same_time(case in case(1.5, true), share in 0.0..1.0_f64) {
        if case.limits.shape != Shape::SRamp {
            case.check_replanned(share)?;
        }
    }

    #[test]
    fn replanned_pass_takes_the_same_time(case in case(1.0, false), share in 0.0..1.0_f64) {
        if case.limits.shape != Shape::SRamp {
            case.check_replanned(share)?;
        }
    }

    /// Proves: MACS-PROF-13
    #[test]
    fn stop_keeps_its_limits_and_reports_its_distance(case in case(2.0, true)) {
        case.check_stop()?;
    }

    #[test]
    fn a_change_of_velocity_keeps_its_limits(case in case(2.0, false)) {
        case.check_velocity()?;
    }
}

prop_compose! {
    /// Numbers from 1e-6 to 1e15, in any ratio, and distances of up to 2^62 increments.
    fn extreme()(
        values in prop::array::uniform10(magnitude(-6.0, 15.0)),
        even in any::<bool>(),
        jerks in any::<u8>(),
        (v, a, end) in (share(), share(), share()),
        way in prop_oneof![(share(), magnitude(0.0, 18.6)).prop_map(|(s, m)| s * m), Just(0.0)],
    ) -> Case {
        let [velocity, acceleration, deceleration, rise, fall, brake_rise, brake_fall, fast, strong, _] = values;
        let uneven = Jerks { rise, fall, brake_rise, brake_fall };
        let all = Jerks { rise, fall: rise, brake_rise: rise, brake_fall: rise };
        let shape = match jerks % 8 {
            0 => Shape::Trapezoid,
            1 => Shape::SRamp,
            number => Shape::Jerk(if number % 2 == 0 { all } else { uneven }),
        };
        let limits = Limits { velocity, acceleration, deceleration: if even { acceleration } else { deceleration }, shape };
        let start = Motion { velocity: v * fast, acceleration: a * strong, ..Motion::default() };
        Case { start, target: Position::from_f64(way), end_velocity: end * velocity, limits }
    }
}

impl Case {
    /// Checks the properties that remain if rounding may be any number of cycles.
    fn check_extreme(&self, plan: &Plan, at_target: bool) -> Result<(), TestCaseError> {
        prop_assert!(plan.duration().is_finite() && plan.duration() >= 0.0, "{}", plan.duration());
        let end = plan.at(plan.cycles());
        if at_target {
            let over = Position::from_f64(self.end_velocity * plan.overshoot(plan.cycles()));
            prop_assert_eq!(end.position, self.target + over);
        }
        let (low, high) = plan.extent();
        prop_assert!(low <= plan.end() && plan.end() <= high);
        for share in 0..64_u64 {
            let now = plan.at(plan.cycles() / 64 * share + share);
            prop_assert!(now.velocity.is_finite() && now.acceleration.is_finite() && now.jerk.is_finite(), "{now:?}");
            let run_out = match self.jerks() {
                // The part that the acceleration adds in any plan.
                Some(jerks) => {
                    0.5 * self.start.acceleration * self.start.acceleration / jerks.fall.min(jerks.brake_fall)
                }
                None => 0.0,
            };
            let most = self.limits.velocity.max(self.start.velocity.abs() + run_out);
            // The accuracy of the time is that of f64.
            let digits = now.acceleration.abs() * 1e-15 * plan.duration();
            prop_assert!(now.velocity.abs() <= most * (1.0 + 1e-6) + digits, "{now:?} beyond {most}");
            let most = self.limits.acceleration.max(self.limits.deceleration).max(self.start.acceleration.abs());
            prop_assert!(now.acceleration.abs() <= most * (1.0 + 1e-6), "{now:?} beyond {most}");
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn numbers_of_any_size_stay_within_limits(case in extreme()) {
        case.check_extreme(&case.plan(), true)?;
        case.check_extreme(&to_velocity(case.start, case.end_velocity, &case.limits, MS), false)?;
        case.check_extreme(&stop(case.start, &case.limits, MS), false)?;
        prop_assert!(stopping_distance(case.start, &case.limits).is_finite());
    }
}
