//! Speed from a foreign encoder: the way of the source in a call is the speed of the sink (AMK-APSF-46, FB10).
#![cfg_attr(target_arch = "wasm32", no_std)]

#[path = "../../../node/src/program/template/rust/src/lineshaft.rs"]
pub mod lineshaft;

use lineshaft::{Image, NONE, RESET, program};

/// Flag double word 24 of the source.
#[repr(C)]
pub struct State {
    pub md24: i64,
}

program!(cycle, State, State { md24: 0 });

/// In 0.0001 rpm, of an encoder with 20,000 increments a turn, in calls of 2 ms.
pub fn cycle(image: &mut Image<State>) {
    image.sink = if image.command == NONE && image.input(1) {
        i64::from(image.source.wrapping_sub(image.state.md24) as i16) * 30_000 / 2
    } else {
        0
    };
    if image.command != RESET {
        image.state.md24 = image.source;
    }
}
