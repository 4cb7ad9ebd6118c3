//! Measures the speed of a scenario: simulated time of the demo cell, and of a cell with eight moving axes, without
//! CSV.
//!
//! `cargo bench -p lineshaft --bench simulation`: an element is a millisecond of simulated time, so `thrpt` in Kelem/s is
//! simulated seconds per second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lineshaft::cell::Cell;
use lineshaft::scenario::{Options, Scenario, simulate};
use std::fmt::Write;

/// 10 s at 1 ms.
const CYCLES: u64 = 10_000;

fn eight_axes() -> Cell {
    let mut text = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n".to_owned();
    for axis in 0..8 {
        let limits = "max_velocity: 1 m/s, max_acceleration: 5 m/s^2, max_following_error: 50 mm";
        let drive = format!("drive: {{backend: plant, address: {axis}, interface: position}}");
        let scale = "scale: {increments: 100000, per: 10 mm}";
        let line = format!("  a{axis}: {{type: linear, {scale}, {drive}, {limits}, sim: {{model: second_order}}}}\n");
        text.write_str(&line).expect("writing to a string does not fail");
    }
    Cell::parse("eight.yaml", text).expect("a good cell")
}

fn scenario(cell: &Cell) -> Scenario {
    let mut text =
        format!("scenario: all axes back and forth\ncycles: {CYCLES}\nsteps:\n  - {{at: 0, do: {{enable: {{}}}}}}\n");
    for axis in &cell.machine.axes {
        for (at, velocity) in [(100, 0.1), (4_000, -0.1)] {
            let goal = format!("{{axis: {}, mode: velocity, velocity: {velocity}}}", axis.name);
            let line = format!("  - {{at: {at}, every: 5000, count: 2, do: {{move_axis: {goal}}}}}\n");
            text.write_str(&line).expect("writing to a string does not fail");
        }
    }
    Scenario::parse("bench.yaml", &text, cell).expect("a good scenario")
}

fn simulations(c: &mut Criterion) {
    let mut group = c.benchmark_group("simulate");
    group.throughput(Throughput::Elements(CYCLES)).sample_size(20);
    for (name, cell) in [("demo", Cell::demo()), ("eight axes", eight_axes())] {
        let scenario = scenario(&cell);
        let options = Options::default();
        let report = simulate(&cell, &scenario, &options).expect("a simulation without files");
        assert!(report.passed(), "{report}");
        group.bench_function(name, |b| b.iter(|| simulate(&cell, &scenario, &options)));
    }
    group.finish();
}

criterion_group!(benches, simulations);
criterion_main!(benches);
