//! Time of a call: of a program that does nothing, of FB10, of a filter of 200 taps, and of the same filter as native
//! Rust.
//!
//! `cargo bench -p lineshaft-program`; the bench `instructions` of core counts the instructions of a slot with each of
//! them.

#![allow(unreachable_pub, reason = "the source of a module")]
#![allow(missing_docs, reason = "criterion makes what it runs")]

use criterion::{Criterion, criterion_group, criterion_main};
use lineshaft_program::{Command, Instance, Module};
use std::hint::black_box;

#[path = "../../launch-configs/functions/programs/fir.rs"]
mod fir;

const EMPTY: &str = "(module (memory 1) (global (export \"image\") i32 (i32.const 16)) \
                     (data (i32.const 16) \"\\b0\\03\") (func (export \"cycle\")))";
const FB10: &[u8] = include_bytes!("../../launch-configs/functions/programs/fb10.wasm");
const FIR: &[u8] = include_bytes!("../../launch-configs/functions/programs/fir.wasm");

/// Calls a program repeatedly, each time with another source.
fn calls(c: &mut Criterion, name: &str, bytes: &[u8]) {
    let module = Module::load(bytes).expect("it is taken");
    let mut instance = Instance::new(&module, 1);
    let mut source = 0;
    c.bench_function(name, |bench| {
        bench.iter(|| {
            source += 7;
            let mut image = instance.image(&module);
            image.set_command(Command::None);
            image.set_inputs(1);
            image.set_source(source, source);
            instance.call(&module, 100_000).expect("it comes to its end");
            black_box(instance.image(&module).sink())
        });
    });
}

fn programs(c: &mut Criterion) {
    calls(c, "empty", &wat::parse_str(EMPTY).expect("a module"));
    calls(c, "fb10", FB10);
    calls(c, "fir", FIR);
    let mut image = fir::lineshaft::Image::new(fir::State::BEGIN);
    let mut source = 0;
    c.bench_function("fir native", |bench| {
        bench.iter(|| {
            source += 7;
            (image.source, image.travel) = (source, source);
            fir::cycle(black_box(&mut image));
            black_box(image.sink)
        });
    });
}

criterion_group!(benches, programs);
criterion_main!(benches);
