//! How a drive is told to home before it is put into mode homing.
//!
//! Law      method, speeds and acceleration are written one after the other; only then mode 6 is asked for
//! Refuses  an order of which an object was refused: mode 6 is never asked for then, and the axis ends its homing in time
//! Source   CiA 402-2, homing mode (6098h, 6099h, 609Ah)

use super::objects;
use crate::config::VelocityFactor;
use crate::sdo::Object;
use lineshaft_core::drive::{HomingOrder, Mode};

/// Bytes of the longest object.
const LONGEST: usize = 4;

/// How far it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// This object is next.
    #[default]
    Next,
    /// Its answer has not come.
    Asked,
    /// The drive has refused it.
    Refused,
}

/// The setting up of a homing.
#[derive(Clone, Debug)]
pub struct HomingSetup {
    order: Option<HomingOrder>,
    at: usize,
    stage: Stage,
    factor: VelocityFactor,
    /// Goes with each object and comes back with its answer.
    room: Option<Vec<u8>>,
}

/// In their order.
const STEPS: [Object; 4] =
    [objects::HOMING_METHOD, objects::HOMING_SEARCH, objects::HOMING_ZERO, objects::HOMING_ACCELERATION];

impl HomingSetup {
    /// None under way.
    pub fn new(factor: VelocityFactor) -> Self {
        Self { order: None, at: 0, stage: Stage::Next, factor, room: Some(Vec::with_capacity(LONGEST)) }
    }

    /// What the drive may be asked for, where that is asked of it: no mode homing before all is set up. `before`: the mode until then.
    pub fn allow(&mut self, mode: Mode, before: i8) -> i8 {
        let Mode::Homing(order) = mode else {
            self.order = None;
            return mode.number();
        };
        if self.order != Some(order) {
            // The answer of an object that is under way still comes, and is not that of this order.
            (self.order, self.at) = (Some(order), 0);
            if self.stage == Stage::Refused {
                self.stage = Stage::Next;
            }
        }
        if self.at >= STEPS.len() { mode.number() } else { before }
    }

    /// The object that is to be written now.
    pub fn next_object(&mut self) -> Option<(Object, Vec<u8>)> {
        let object = *STEPS.get(self.at)?;
        let order = self.order.filter(|_| self.stage == Stage::Next)?;
        let mut data = self.room.take()?;
        data.clear();
        let speed = |value: f64| u32::try_from(self.factor.to_drive(value)).unwrap_or(u32::MAX).max(1).to_le_bytes();
        match self.at {
            0 => data.push(order.method.cast_unsigned()),
            1 => data.extend(speed(order.search_velocity)),
            2 => data.extend(speed(order.zero_velocity)),
            _ => data.extend(speed(order.acceleration)),
        }
        self.stage = Stage::Asked;
        Some((object, data))
    }

    /// The object could not be asked for; it is tried again.
    pub fn give_back(&mut self, data: Vec<u8>) {
        (self.room, self.stage) = (Some(data), Stage::Next);
    }

    /// Does it wait for an answer of this object?
    pub fn awaits(&self, object: Object) -> bool {
        self.stage == Stage::Asked && STEPS.contains(&object)
    }

    /// Takes the answer.
    pub fn take(&mut self, object: Object, data: Vec<u8>, is_good: bool) {
        self.room = Some(data);
        let is_of_step = STEPS.get(self.at) == Some(&object);
        self.stage = match (is_of_step, is_good) {
            (true, false) => Stage::Refused,
            (true, true) => {
                self.at += 1;
                Stage::Next
            }
            // Of the order before.
            (false, _) => Stage::Next,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: HomingOrder =
        HomingOrder { method: -3, search_velocity: 20_000.4, zero_velocity: 0.2, acceleration: 500_000.0 };

    /// Writes what is next; gives the answer.
    fn answer(setup: &mut HomingSetup, is_good: bool) -> (Object, Vec<u8>) {
        let (object, data) = setup.next_object().expect("something is next");
        assert!(setup.awaits(object) && setup.next_object().is_none(), "one at a time");
        setup.take(object, data.clone(), is_good);
        (object, data)
    }

    /// 6098h, 6099h:01, 6099h:02, 609Ah; a speed is at least 1.
    #[test]
    fn mode_6_is_asked_for_once_all_is_written() {
        let mut setup = HomingSetup::new(VelocityFactor::default());
        assert_eq!((setup.allow(Mode::Position, 0), setup.next_object()), (8, None));
        let expected = [
            (objects::HOMING_METHOD, vec![0xFD]),
            (objects::HOMING_SEARCH, 20_000_u32.to_le_bytes().to_vec()),
            (objects::HOMING_ZERO, 1_u32.to_le_bytes().to_vec()),
            (objects::HOMING_ACCELERATION, 500_000_u32.to_le_bytes().to_vec()),
        ];
        for written in expected {
            assert_eq!(setup.allow(Mode::Homing(ORDER), 8), 8);
            assert_eq!(answer(&mut setup, true), written);
        }
        assert_eq!((setup.allow(Mode::Homing(ORDER), 8), setup.next_object()), (6, None));
        assert_eq!(setup.allow(Mode::Position, 6), 8);
        assert_eq!(setup.allow(Mode::Homing(ORDER), 8), 8, "a second homing is set up anew");
    }

    #[test]
    fn a_refused_object_keeps_mode_6_away() {
        let mut setup = HomingSetup::new(VelocityFactor::default());
        setup.allow(Mode::Homing(ORDER), 8);
        answer(&mut setup, false);
        assert_eq!((setup.next_object(), setup.allow(Mode::Homing(ORDER), 8)), (None, 8));
        let other = HomingOrder { method: 17, ..ORDER };
        setup.allow(Mode::Position, 8);
        setup.allow(Mode::Homing(other), 8);
        assert_eq!(answer(&mut setup, true).1, [17]);
    }

    /// The answer of the order before counts for nothing.
    #[test]
    fn another_order_begins_anew() {
        let mut setup = HomingSetup::new(VelocityFactor::default());
        setup.allow(Mode::Homing(ORDER), 8);
        answer(&mut setup, true);
        let (object, data) = setup.next_object().unwrap();
        setup.allow(Mode::Homing(HomingOrder { method: 17, ..ORDER }), 8);
        assert_eq!(setup.next_object(), None, "its answer has not come");
        setup.take(object, data, true);
        assert_eq!(answer(&mut setup, true), (objects::HOMING_METHOD, vec![17]));
    }
}
