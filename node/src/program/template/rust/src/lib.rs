//! A program of a slot: copies the source into the sink while E1 is on, and tells it by A1.
#![cfg_attr(target_arch = "wasm32", no_std)]

pub mod lineshaft;

use lineshaft::{Image, START, program};

/// What is kept from call to call.
#[repr(C)]
#[derive(Default)]
pub struct State {
    /// The source less the sink.
    offset: i64,
}

program!(cycle, State, State { offset: 0 });

/// One call; each cycle has one.
pub fn cycle(image: &mut Image<State>) {
    if image.command == START || !image.input(1) {
        image.state.offset = image.source.wrapping_sub(image.sink);
    }
    image.sink = image.source.wrapping_sub(image.state.offset);
    image.set_output(1, image.input(1));
}
