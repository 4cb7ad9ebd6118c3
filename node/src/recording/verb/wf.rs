//! Writes a verb `wf` as text.

use super::write::{Entries, Scalar, length, rate};
use crate::scenario::{WF_JOGS, WF_MODES};
use lineshaft_core::position::Length;
use lineshaft_core::request::NAMELESS;
use lineshaft_core::vocabulary::wf::{Block, Request, Speed};

/// Returns the arguments of the verb; default values are left out.
pub(super) fn wf(request: &Request, axis: &str) -> Entries {
    let number = |value: u8| Scalar::Whole(value.into());
    let yes = |holds: bool| holds.then_some(Scalar::Truth(true));
    Entries::some([
        ("axis", Some(axis.into())),
        ("mode", request.mode.map(|mode| name(&WF_MODES, mode))),
        ("blocks", request.blocks.map(|blocks| Scalar::List(blocks.as_slice().iter().map(block).collect()))),
        ("block", request.block.map(number)),
        ("start", yes(request.start)),
        ("jog", request.jog.map(|jog| name(&WF_JOGS, jog))),
        ("cam", request.cam.map(Scalar::Truth)),
        ("fixed_speed", request.fixed_speed.map(number)),
        ("enable", request.enable.map(Scalar::Truth)),
        ("reset", yes(request.reset)),
        ("value", request.value.map(|value| Scalar::Text(length(value)))),
    ])
}

fn name<T: PartialEq>(names: &[(&str, T)], value: T) -> Scalar {
    names.iter().find(|(_, known)| *known == value).map_or(NAMELESS, |(name, _)| name).into()
}

fn block(block: &Block) -> Scalar {
    let velocity = match block.speed {
        Speed::Value(value) => Scalar::Real(value),
        Speed::Velocity(velocity) => Scalar::Text(rate(velocity, 1)),
    };
    let position = length(Length { nearest: 0, rest: block.position });
    Scalar::Entries(Entries::some([
        ("position", Some(Scalar::Text(position))),
        ("velocity", Some(velocity)),
        ("absolute", (!block.absolute).then_some(Scalar::Truth(false))),
    ]))
}
