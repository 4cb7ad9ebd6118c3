//! The modules of the examples have the same results as their sources compiled for this machine, call for call.

#![allow(
    unreachable_pub,
    clippy::duplicate_mod,
    reason = "sources of modules, each with the image that it is compiled with"
)]

use lineshaft_program::{Command, Instance, Module};
use proptest::prelude::*;

#[path = "../../launch-configs/functions/programs/ab216.rs"]
mod ab216;
#[path = "../../launch-configs/functions/programs/fb10.rs"]
mod fb10;
#[path = "../../launch-configs/functions/programs/fir.rs"]
mod fir;
#[path = "../../launch-configs/functions/programs/half.rs"]
mod half;
#[path = "../../node/src/program/template/rust/src/lib.rs"]
mod template;

/// Command, inputs, source.
type Call = (u8, u8, i64);

fn calls() -> impl Strategy<Value = Vec<Call>> {
    let command = prop_oneof![1 => Just(0), 1 => Just(1), 8 => Just(255)];
    // Without the value for which ab216 panics.
    let source = prop_oneof![-70_000_i64..70_000, any::<i64>()].prop_filter("a panic", |source| *source as u8 != 0xEE);
    prop::collection::vec((command, any::<u8>(), source), 1..60)
}

/// Returns sink and outputs after each call of a module.
fn of_module(bytes: &[u8], calls: &[Call]) -> Vec<(i64, u8)> {
    let module = Module::load(bytes).expect("it is taken");
    let mut instance = Instance::new(&module, 1);
    let mut after = Vec::new();
    for &(command, inputs, source) in calls {
        let mut image = instance.image(&module);
        image.set_command(match command {
            0 => Command::Reset,
            1 => Command::Start,
            _ => Command::None,
        });
        image.set_inputs(inputs);
        image.set_source(source, source);
        instance.call(&module, 100_000).expect("it comes to its end");
        let image = instance.image(&module);
        after.push((image.sink(), image.outputs()));
    }
    after
}

/// Returns sink and outputs after each call of the native code.
macro_rules! natively {
    ($program:ident, $begin:expr, $calls:expr) => {{
        let mut image = $program::lineshaft::Image::new($begin);
        let mut after = Vec::new();
        for &(command, inputs, source) in $calls {
            (image.command, image.inputs, image.source, image.travel) = (command, inputs, source, source);
            $program::cycle(&mut image);
            after.push((image.sink, image.outputs));
        }
        after
    }};
}

macro_rules! module {
    ($name:literal) => {
        include_bytes!(concat!("../../launch-configs/functions/programs/", $name, ".wasm"))
    };
}

proptest! {
    /// Proves: AMK-APSF-46
    #[test]
    fn the_modules_are_their_sources(calls in calls()) {
        prop_assert_eq!(of_module(module!("fb10"), &calls), natively!(fb10, fb10::State { md24: 0 }, &calls));
        prop_assert_eq!(of_module(module!("half"), &calls), natively!(half, half::State { md24: 0 }, &calls));
        prop_assert_eq!(of_module(module!("ab216"), &calls), natively!(ab216, (), &calls));
        prop_assert_eq!(of_module(module!("fir"), &calls), natively!(fir, fir::State::BEGIN, &calls));
        prop_assert_eq!(of_module(include_bytes!("modules/template.wasm"), &calls), natively!(template, template::State::default(), &calls));
        prop_assert_eq!(of_module(include_bytes!("modules/template_c.wasm"), &calls), natively!(template, template::State::default(), &calls));
    }
}
