//! A filter of 200 taps: the mean of the last 200 ways of the source, weighted by a triangle, as a speed.
#![cfg_attr(target_arch = "wasm32", no_std)]

#[path = "../../../node/src/program/template/rust/src/lineshaft.rs"]
pub mod lineshaft;

use lineshaft::{Image, START, program};

pub const TAPS: usize = 200;

/// The last ways, and where the oldest stands.
#[repr(C)]
pub struct State {
    ways: [f64; TAPS],
    next: u64,
    travel: i64,
}

impl State {
    pub const BEGIN: Self = Self { ways: [0.0; TAPS], next: 0, travel: 0 };
}

program!(cycle, State, State::BEGIN);

pub fn cycle(image: &mut Image<State>) {
    let state = &mut image.state;
    if image.command == START {
        *state = State { travel: image.travel, ..State::BEGIN };
    }
    let place = state.next as usize % TAPS;
    state.ways[place] = image.travel.wrapping_sub(state.travel) as f64;
    state.travel = image.travel;
    state.next = (place + 1) as u64;
    let (mut sum, mut weights) = (0.0, 0.0);
    for tap in 0..TAPS {
        let age = if tap <= place { place - tap } else { place + TAPS - tap };
        let weight = (TAPS - age) as f64;
        sum += weight * state.ways[tap];
        weights += weight;
    }
    image.sink = (sum / weights * 1000.0) as i64;
}
