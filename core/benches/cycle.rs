//! Time of a cycle by the number of moving axes, each with a drive that follows at once.
//!
//! `cargo bench -p lineshaft-core`: the figure per element is the time per axis and cycle. For comparison, group `step`
//! of the bench `profile`, in the same run, has the step of Ruckig.

mod shop;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lineshaft_core::command::{Action, Commands, MoveMode};
use lineshaft_core::function::TYPES;
use lineshaft_core::table::Interpolation;
use shop::{Loops, Shop, couple, goal, on_cam};

fn enabled(axes: u16) -> Shop {
    let mut shop = Shop::new(0, axes);
    shop.enable();
    shop
}

fn velocity(axis: u16) -> Action {
    Action::Move(goal(axis, MoveMode::Velocity, 0, 1e5))
}

fn cycles(c: &mut Criterion) {
    let mut group = c.benchmark_group("cycle");
    for axes in [1_u16, 8, 64, 512] {
        group.throughput(Throughput::Elements(axes.into()));
        for (name, follows) in [("profiles", velocity as fn(u16) -> Action), ("gears", couple), ("cams", on_cam)] {
            let mut shop = Shop::new(0, axes).with_cam(Interpolation::Linear);
            shop.enable();
            shop.give(&[velocity(0)]);
            for axis in 1..axes {
                shop.give(&[follows(axis)]);
            }
            group.bench_function(BenchmarkId::new(name, axes), |b| b.iter(|| shop.cycle(Commands::default())));
        }
    }
    group.finish();
}

/// Measures axes whose loops are closed here.
fn loops(c: &mut Criterion) {
    let mut group = c.benchmark_group("loops");
    for axes in [1_u16, 64] {
        group.throughput(Throughput::Elements(axes.into()));
        for (name, loops) in Loops::ALL {
            let mut shop = Shop::new(0, axes).with_loops(loops);
            shop.enable();
            (0..axes).for_each(|axis| shop.give(&[velocity(axis)]));
            group.bench_function(BenchmarkId::new(name, axes), |b| b.iter(|| shop.cycle(Commands::default())));
        }
    }
    group.finish();
}

/// Measures the additional time of a key cycle of a recording, in which the state of the machine is copied.
fn key_cycles(c: &mut Criterion) {
    let mut group = c.benchmark_group("key_cycle");
    for axes in [64_u16, 512] {
        group.throughput(Throughput::Elements(axes.into()));
        let shop = enabled(axes);
        let mut copy = shop.machine.state().clone();
        group.bench_function(BenchmarkId::new("copy", axes), |b| {
            b.iter(|| copy.clone_from(std::hint::black_box(shop.machine.state())))
        });
    }
    group.finish();
}

/// Measures slots of each type: the figure per element is the time per slot and cycle.
fn slots(c: &mut Criterion) {
    let mut group = c.benchmark_group("slots");
    for row in TYPES {
        for count in [64_u16, 256] {
            group.throughput(Throughput::Elements(count.into()));
            let mut shop = shop::slots::slots(row, count, true);
            group.bench_function(BenchmarkId::new(row.name, count), |b| b.iter(|| shop.cycle(Commands::default())));
        }
    }
    for (name, _) in shop::slots::PROGRAMS.iter().skip(1) {
        let mut shop = shop::slots::named(name, 64, true).expect("a row");
        group.throughput(Throughput::Elements(64));
        group.bench_function(BenchmarkId::new(*name, 64), |b| b.iter(|| shop.cycle(Commands::default())));
    }
    group.finish();
}

criterion_group!(benches, cycles, loops, key_cycles, slots);
criterion_main!(benches);
