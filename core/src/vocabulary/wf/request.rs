//! Requests of the vocabulary.

use crate::position::{Length, Position};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Maximum blocks of a program.
pub const MAX_BLOCKS: usize = 16;
/// Maximum speed value of a closed-loop axis: `max_velocity`.
pub const FULL_SPEED: f64 = 100.0;
/// Maximum speed value of an open-loop axis: two decimal digits (WF-DAC-02).
pub const MOST_BCD: f64 = 99.0;
/// Number of setup speeds that the fixed-speed bits select.
pub const FIXED_SPEEDS: u8 = 3;

/// Mode of operation (WF-MOD-01).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Manual data input: START runs the only block of the program.
    #[default]
    Mdi = 0,
    /// Single block: START runs the selected block, each time the same one.
    Single = 1,
    /// Automatic single block: START runs the next block of the program.
    Automatic = 2,
    /// Automatic continuous: START runs all blocks, with change on the fly.
    Continuous = 3,
    /// Setup: JOG+ and JOG- run the axis as long as they are set.
    Jog = 4,
    /// Actual value preset: the given value becomes the position of the axis.
    ActualValue = 5,
    /// Reference travel: JOG+ or JOG- moves the axis across the cam to the zero mark, as long as it is set.
    Reference = 6,
}

/// Names of [`Mode`], by number.
pub const MODES: &[&str] = &["MDI", "SINGLE", "AUTOMATIC", "CONTINUOUS", "JOG", "ACTUAL_VALUE", "REFERENCE"];

/// The inputs JOG+ and JOG-.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Jog {
    /// Neither is set.
    #[default]
    None,
    /// JOG+
    Plus,
    /// JOG-
    Minus,
    /// Both: the same as neither.
    Both,
}

impl Jog {
    /// Returns 1, -1, or 0 if the inputs select no direction.
    pub fn direction(self) -> i8 {
        match self {
            Jog::Plus => 1,
            Jog::Minus => -1,
            Jog::None | Jog::Both => 0,
        }
    }
}

/// Programmed speed of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Speed {
    /// Hundredths of `max_velocity`, each of them 0.1 V.
    Value(f64),
    /// Velocity (inc/s).
    Velocity(f64),
}

impl Default for Speed {
    fn default() -> Self {
        Speed::Value(0.0)
    }
}

impl Speed {
    /// Returns the velocity (inc/s).
    pub fn velocity(self, max_velocity: f64) -> f64 {
        match self {
            Speed::Value(value) => value / FULL_SPEED * max_velocity,
            Speed::Velocity(velocity) => velocity,
        }
    }

    /// Returns the speed value in hundredths of `max_velocity`.
    pub fn value(self, max_velocity: f64) -> f64 {
        match self {
            Speed::Value(value) => value,
            Speed::Velocity(velocity) => velocity / max_velocity * FULL_SPEED,
        }
    }
}

/// One positioning block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Position (G90) or distance (G91) (inc), before rounding to whole increments.
    pub position: Position,
    /// Programmed speed.
    pub speed: Speed,
    /// Whether the position is absolute (G90), not a distance (G91).
    pub absolute: bool,
}

/// A program of up to [`MAX_BLOCKS`] blocks.
#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    list: [Block; MAX_BLOCKS],
    count: u8,
}

impl fmt::Debug for Blocks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.as_slice()).finish()
    }
}

impl Blocks {
    /// Returns a program of these blocks; `None` if there are too many.
    pub fn new(blocks: &[Block]) -> Option<Self> {
        let mut list = [Block::default(); MAX_BLOCKS];
        list.get_mut(..blocks.len())?.copy_from_slice(blocks);
        Some(Self { list, count: blocks.len() as u8 })
    }

    /// Returns the blocks in their order.
    pub fn as_slice(&self) -> &[Block] {
        self.list.get(..usize::from(self.count)).unwrap_or(&self.list)
    }

    /// Returns the number of blocks.
    pub fn count(&self) -> u8 {
        self.count
    }

    /// Returns the block of that index, from 0.
    pub fn get(&self, place: u8) -> Option<&Block> {
        self.as_slice().get(usize::from(place))
    }

    pub(super) fn is_sound(&self) -> bool {
        let good = |block: &Block| {
            let speed = match block.speed {
                Speed::Value(value) => value,
                Speed::Velocity(velocity) => velocity,
            };
            block.position.is_legal() && speed.is_finite() && speed >= 0.0
        };
        usize::from(self.count) <= MAX_BLOCKS && self.list.iter().all(good)
    }
}

/// One request for one axis; a field that is `None` changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The axis.
    pub axis: u16,
    /// Mode of operation.
    pub mode: Option<Mode>,
    /// Replaces the program.
    pub blocks: Option<Blocks>,
    /// First block of the next START, from 1.
    pub block: Option<u8>,
    /// START
    pub start: bool,
    /// JOG+ and JOG-: run the axis in mode jog, select the direction of approach of a rotary axis in all other modes.
    pub jog: Option<Jog>,
    /// Deceleration cam of mode reference if `wf.md15` is interface; kept until the next request that sets it.
    pub cam: Option<bool>,
    /// Fixed-speed bits: the setup speed of mode jog, 1 to [`FIXED_SPEEDS`].
    pub fixed_speed: Option<u8>,
    /// Controller enable request.
    pub enable: Option<bool>,
    /// Reset bit, for this cycle: ends the motion and acknowledges the alarm. Must be the only field.
    pub reset: bool,
    /// New position of the axis, in mode actual_value.
    pub value: Option<Length>,
}
