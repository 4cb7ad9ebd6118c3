//! Time to plan one axis from a random state with limited jerk, and to evaluate one cycle, compared with Ruckig.
//!
//! `cargo bench -p lineshaft-core --bench profile`: both get the same states, ours in increments, Ruckig's in metres.

use criterion::{Criterion, criterion_group, criterion_main};
use lineshaft_core::position::Position;
use lineshaft_core::profile::{self, Jerks, Limits, Motion, Plan, Shape};
use rsruckig::prelude::*;
use std::hint::black_box;

/// Increments per metre.
const SCALE: f64 = 1e6;
const CYCLE_NS: u64 = 1_000_000;
/// Number of states per run.
const COUNT: usize = 1024;

/// A state and its limits (m, s).
struct Task {
    velocity: f64,
    acceleration: f64,
    target: f64,
    top: f64,
    limit: f64,
    jerk: f64,
}

/// Random numbers (xorshift64*), the same in each run.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let unit = (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64;
        low + unit * (high - low)
    }
}

/// Returns states as in Ruckig's own benchmark: within their limits, with near and far targets.
fn tasks() -> Vec<Task> {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let task = |_| Task {
        velocity: random.between(-1.5, 1.5),
        acceleration: random.between(-1.5, 1.5),
        target: random.between(-16.0, 16.0),
        top: random.between(3.0, 12.0),
        limit: random.between(3.0, 12.0),
        jerk: random.between(3.0, 12.0),
    };
    (0..COUNT).map(task).collect()
}

struct Ours {
    start: Motion,
    target: Position,
    limits: Limits,
}

impl Ours {
    fn new(task: &Task) -> Self {
        let jerk = task.jerk * SCALE;
        let limits = Limits {
            velocity: task.top * SCALE,
            acceleration: task.limit * SCALE,
            deceleration: task.limit * SCALE,
            shape: Shape::Jerk(Jerks { rise: jerk, fall: jerk, brake_rise: jerk, brake_fall: jerk }),
        };
        let (velocity, acceleration) = (task.velocity * SCALE, task.acceleration * SCALE);
        let start = Motion { velocity, acceleration, ..Motion::default() };
        Self { start, target: Position::from_f64(task.target * SCALE), limits }
    }

    fn plan(&self) -> Plan {
        profile::to_rest(self.start, self.target, &self.limits, CYCLE_NS)
    }
}

fn theirs(task: &Task) -> InputParameter<1> {
    let mut input = InputParameter::new(None);
    input.current_velocity[0] = task.velocity;
    input.current_acceleration[0] = task.acceleration;
    input.target_position[0] = task.target;
    input.max_velocity[0] = task.top;
    input.max_acceleration[0] = task.limit;
    input.max_jerk[0] = task.jerk;
    input
}

fn plans(c: &mut Criterion) {
    let tasks = tasks();
    let mut group = c.benchmark_group("plan");
    let ours: Vec<_> = tasks.iter().map(Ours::new).collect();
    let mut next = ours.iter().cycle();
    group.bench_function("lineshaft", |b| {
        b.iter(|| {
            if let Some(task) = next.next() {
                black_box(&black_box(task).plan());
            }
        })
    });
    let inputs: Vec<_> = tasks.iter().map(theirs).collect();
    let mut ruckig = Ruckig::<1, ThrowErrorHandler>::new(None, 1e-3);
    let mut trajectory = Trajectory::new(None);
    let mut next = inputs.iter().cycle();
    group.bench_function("ruckig", |b| {
        b.iter(|| {
            if let Some(input) = next.next() {
                let _ = ruckig.calculate(black_box(input), &mut trajectory);
                black_box(&trajectory);
            }
        })
    });
    group.finish();
}

fn steps(c: &mut Criterion) {
    let tasks = tasks();
    let mut group = c.benchmark_group("step");
    let plans: Vec<_> = tasks.iter().take(64).map(|task| Ours::new(task).plan()).collect();
    let (mut index, mut cycle) = (0, 0);
    group.bench_function("lineshaft", |b| {
        b.iter(|| {
            black_box(&plans[index].at(cycle));
            cycle += 1;
            if cycle > plans[index].cycles() {
                (index, cycle) = ((index + 1) % plans.len(), 0);
            }
        })
    });
    let mut ruckig = Ruckig::<1, ThrowErrorHandler>::new(None, 1e-3);
    let trajectories: Vec<_> = tasks
        .iter()
        .take(64)
        .map(|task| {
            let mut trajectory = Trajectory::new(None);
            ruckig.calculate(&theirs(task), &mut trajectory).expect("a task that Ruckig can plan");
            trajectory
        })
        .collect();
    let (mut index, mut cycle) = (0, 0);
    let mut values = [(); 4].map(|()| DataArrayOrVec::<f64, 1>::new(None, 0.0));
    group.bench_function("ruckig", |b| {
        b.iter(|| {
            let time = f64::from(cycle) * 1e-3;
            let [position, velocity, acceleration, jerk] = &mut values;
            let mut section = None;
            trajectories[index].at_time(
                time,
                &mut Some(position),
                &mut Some(velocity),
                &mut Some(acceleration),
                &mut Some(jerk),
                &mut section,
            );
            cycle += 1;
            if time > trajectories[index].get_duration() {
                (index, cycle) = ((index + 1) % trajectories.len(), 0);
            }
            black_box(&values);
        })
    });
    group.finish();
}

criterion_group!(benches, plans, steps);
criterion_main!(benches);
