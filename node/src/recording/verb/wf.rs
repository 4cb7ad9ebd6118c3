//! Writes a verb `wf` as text.

use super::write::{length, rate};
use lineshaft_core::position::{Length, Position};
use lineshaft_core::vocabulary::wf::{self, Jog, Mode, Request, Speed};
use serde::Serialize;

/// Arguments of the verb.
#[derive(Serialize)]
pub(super) struct Wf<'a> {
    axis: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    blocks: Option<Vec<Block>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    block: Option<u8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    jog: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cam: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fixed_speed: Option<u8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    enable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reset: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<String>,
}

#[derive(Serialize)]
struct Block {
    position: String,
    velocity: Velocity,
    #[serde(skip_serializing_if = "Option::is_none")]
    absolute: Option<bool>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Velocity {
    Value(f64),
    Rate(String),
}

impl Block {
    fn of(block: &wf::Block) -> Self {
        let velocity = match block.speed {
            Speed::Value(value) => Velocity::Value(value),
            Speed::Velocity(velocity) => Velocity::Rate(rate(velocity, 1)),
        };
        Self { position: position(block.position), velocity, absolute: (!block.absolute).then_some(false) }
    }
}

/// Returns the arguments of the verb; default values are left out.
pub(super) fn wf<'a>(request: &Request, axis: &'a str) -> Wf<'a> {
    Wf {
        axis,
        mode: request.mode.map(mode),
        blocks: request.blocks.map(|blocks| blocks.as_slice().iter().map(Block::of).collect()),
        block: request.block,
        start: request.start.then_some(true),
        jog: request.jog.map(jog),
        cam: request.cam,
        fixed_speed: request.fixed_speed,
        enable: request.enable,
        reset: request.reset.then_some(true),
        value: request.value.map(length),
    }
}

fn position(exact: Position) -> String {
    length(Length { nearest: 0, rest: exact })
}

fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Mdi => "mdi",
        Mode::Single => "single",
        Mode::Automatic => "automatic",
        Mode::Continuous => "continuous",
        Mode::Jog => "jog",
        Mode::ActualValue => "actual_value",
        Mode::Reference => "reference",
    }
}

fn jog(jog: Jog) -> &'static str {
    match jog {
        Jog::None => "none",
        Jog::Plus => "plus",
        Jog::Minus => "minus",
        Jog::Both => "both",
    }
}
