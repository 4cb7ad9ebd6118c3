//! Compares durations with those of Ruckig, which finds the fastest plan under symmetric limits by another method.

use super::*;
use rsruckig::prelude::*;

/// Increments per unit of Ruckig, whose tolerances are absolute, for metres or radians.
const UNIT: f64 = 1e6;
/// Cycle time (s).
const CYCLE: f64 = 1e-3;

/// Random numbers (xorshift64*), the same in each run.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, bound: f64) -> f64 {
        (2.0 * self.unit() - 1.0) * bound
    }

    /// Returns a number between 10^low and 10^high.
    fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        libm::exp10(low + self.unit() * (high - low))
    }
}

/// A task in units of Ruckig.
#[derive(Clone, Copy, Debug)]
struct Task {
    velocity: f64,
    acceleration: f64,
    target: f64,
    end_velocity: f64,
    top: f64,
    limit: f64,
    jerk: f64,
}

impl Task {
    /// `excess`: largest factor by which the start may exceed its limits; 1: within them.
    fn random(random: &mut Random, passes: bool, excess: f64) -> Self {
        let top = random.magnitude(-1.0, 1.5);
        let limit = top * random.magnitude(-0.5, 1.5);
        let jerk = limit * random.magnitude(-0.5, 2.0);
        let calm = random.unit() < 0.2;
        Task {
            velocity: if random.unit() < 0.1 { 0.0 } else { random.within(excess * top) },
            acceleration: if calm { 0.0 } else { random.within(excess * limit) },
            target: random.within(1.0) * top * random.magnitude(-2.0, 1.0),
            end_velocity: if passes { random.within(top) } else { 0.0 },
            top,
            limit,
            jerk,
        }
    }

    /// Whether the acceleration at the start leads beyond the velocity limit in any plan.
    fn overruns(&self) -> bool {
        let run_out = self.velocity + self.acceleration * self.acceleration.abs() / (2.0 * self.jerk);
        run_out.abs() > self.top || self.velocity.abs() > self.top || self.acceleration.abs() > self.limit
    }

    fn ours(&self) -> Plan {
        let start =
            Motion { velocity: self.velocity * UNIT, acceleration: self.acceleration * UNIT, ..Motion::default() };
        let limits = jerk_limits(self.top * UNIT, self.limit * UNIT, self.jerk * UNIT);
        to_pass(start, Position::from_f64(self.target * UNIT), self.end_velocity * UNIT, &limits, MS)
    }

    fn theirs(&self, ruckig: &mut Ruckig<1, ThrowErrorHandler>) -> Option<f64> {
        let mut input = InputParameter::new(None);
        input.current_velocity[0] = self.velocity;
        input.current_acceleration[0] = self.acceleration;
        input.target_position[0] = Position::from_f64(self.target * UNIT).to_f64() / UNIT;
        input.target_velocity[0] = self.end_velocity;
        input.max_velocity[0] = self.top;
        input.max_acceleration[0] = self.limit;
        input.max_jerk[0] = self.jerk;
        let mut trajectory = Trajectory::new(None);
        ruckig.calculate(&input, &mut trajectory).ok().map(|_| trajectory.get_duration())
    }
}

/// Returns the number of compared states, more of them in long tests.
fn count() -> usize {
    if std::env::var_os("LINESHAFT_LONG").is_some() { 100_000 } else { 5_000 }
}

/// Compares states until there are enough; for some of them Ruckig has no plan.
fn compare(seed: u64, passes: bool, excess: f64, judge: impl Fn(&Task, f64, f64) -> bool) {
    let mut random = Random(seed);
    let mut ruckig = Ruckig::<1, ThrowErrorHandler>::new(None, CYCLE);
    let (mut judged, mut failed, mut worst) = (0, 0, 0.0_f64);
    while judged < count() {
        let task = Task::random(&mut random, passes, excess);
        if let Some(theirs) = task.theirs(&mut ruckig) {
            let ours = task.ours().duration();
            if judge(&task, ours, theirs) {
                judged += 1;
                worst = worst.max(ours - theirs);
            }
        } else {
            failed += 1;
        }
    }
    println!("{judged} states, none for which Ruckig is faster by more than {worst:e} s; it failed in {failed}");
    assert!(failed * 1000 < judged, "Ruckig failed in {failed} states");
}

fn is_equal(task: &Task, ours: f64, theirs: f64) -> bool {
    assert!(task.overruns() || (ours - theirs).abs() < CYCLE, "{ours} s, Ruckig {theirs} s: {task:?}");
    !task.overruns()
}

/// Proves: MACS-PROF-10
#[test]
fn a_move_to_rest_takes_the_time_of_ruckig() {
    compare(1, false, 1.0, is_equal);
}

#[test]
fn a_move_through_a_target_takes_the_time_of_ruckig() {
    compare(2, true, 1.0, is_equal);
}

/// Beyond its limits Ruckig brakes until it is below them, and then accelerates again.
#[test]
fn a_start_beyond_the_limits_takes_no_longer_than_with_ruckig() {
    for passes in [false, true] {
        compare(3, passes, 2.0, |task, ours, theirs| {
            assert!(ours < theirs + CYCLE, "{ours} s, Ruckig {theirs} s: {task:?}");
            task.overruns()
        });
    }
}
