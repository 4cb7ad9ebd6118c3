//! What takes the place of fb10 in motion: half the speed, with the same state.
#![cfg_attr(target_arch = "wasm32", no_std)]

#[path = "../../../node/src/program/template/rust/src/lineshaft.rs"]
pub mod lineshaft;

use lineshaft::{Image, NONE, RESET, program};

#[repr(C)]
pub struct State {
    pub md24: i64,
}

program!(cycle, State, State { md24: 0 });

pub fn cycle(image: &mut Image<State>) {
    image.sink = if image.command == NONE && image.input(1) {
        i64::from(image.source.wrapping_sub(image.state.md24) as i16) * 15_000 / 2
    } else {
        0
    };
    if image.command != RESET {
        image.state.md24 = image.source;
    }
}
