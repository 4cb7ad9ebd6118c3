//! Outputs as the source says: its low byte is AB 216 (AMK-APSF-O1). A byte of 0xEE is what it never expects.
#![cfg_attr(target_arch = "wasm32", no_std)]

#[path = "../../../node/src/program/template/rust/src/lineshaft.rs"]
pub mod lineshaft;

use lineshaft::{Image, program};

program!(cycle, (), ());

pub fn cycle(image: &mut Image<()>) {
    assert!(image.source as u8 != 0xEE);
    image.outputs = image.source as u8;
}
