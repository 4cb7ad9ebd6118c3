//! Writes the homing parameters of a drive before mode homing is commanded.
//!
//! Law      method, speeds and acceleration are written one after another; only then mode 6 is commanded
//! Refuses  a homing command of which the drive refused an object: mode 6 is not commanded, and the axis ends its homing by timeout
//! Source   CiA 402-2, homing mode (6098h, 6099h, 609Ah)

use crate::config::VelocityFactor;
use crate::object::Object;
use crate::objects;
use lineshaft_core::drive::{HomingOrder, Mode};

/// Bytes of the longest object.
const LONGEST: usize = 4;

/// Progress of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// The object is to be written next.
    #[default]
    Next,
    /// The object was written; its answer is pending.
    Asked,
    /// The drive has refused the object.
    Refused,
}

/// State of the homing setup.
#[derive(Clone, Debug)]
pub struct HomingSetup {
    command: Option<HomingOrder>,
    at: usize,
    stage: Stage,
    factor: VelocityFactor,
    /// Data buffer. It is passed along with each write and returned with its answer.
    room: Option<Vec<u8>>,
}

/// Objects in the order in which they are written.
const STEPS: [Object; 4] =
    [objects::HOMING_METHOD, objects::HOMING_SEARCH, objects::HOMING_ZERO, objects::HOMING_ACCELERATION];

impl HomingSetup {
    /// Creates a setup without a homing command.
    pub fn new(factor: VelocityFactor) -> Self {
        Self { command: None, at: 0, stage: Stage::Next, factor, room: Some(Vec::with_capacity(LONGEST)) }
    }

    /// Returns the mode that may be commanded: mode homing only after all objects are written, before that `before`, the previous mode.
    pub fn allowed_mode(&mut self, mode: Mode, before: i8) -> i8 {
        let Mode::Homing(order) = mode else {
            self.command = None;
            return mode.number();
        };
        if self.command != Some(order) {
            // The answer of a pending write still arrives, but it does not belong to this command.
            (self.command, self.at) = (Some(order), 0);
            if self.stage == Stage::Refused {
                self.stage = Stage::Next;
            }
        }
        if self.at >= STEPS.len() { mode.number() } else { before }
    }

    /// Returns the object that is to be written now, with its data.
    pub fn next_object(&mut self) -> Option<(Object, Vec<u8>)> {
        let object = *STEPS.get(self.at)?;
        let order = self.command.filter(|_| self.stage == Stage::Next)?;
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

    /// Returns the data of a write that could not be started; it is repeated.
    pub fn return_buffer(&mut self, data: Vec<u8>) {
        (self.room, self.stage) = (Some(data), Stage::Next);
    }

    /// Returns true if the answer to a write of this object is pending.
    pub fn is_pending(&self, object: Object) -> bool {
        self.stage == Stage::Asked && STEPS.contains(&object)
    }

    /// Handles the answer to a write.
    pub fn handle_answer(&mut self, object: Object, data: Vec<u8>, is_good: bool) {
        self.room = Some(data);
        let is_of_step = STEPS.get(self.at) == Some(&object);
        self.stage = match (is_of_step, is_good) {
            (true, false) => Stage::Refused,
            (true, true) => {
                self.at += 1;
                Stage::Next
            }
            // Answer that belongs to the previous command.
            (false, _) => Stage::Next,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: HomingOrder =
        HomingOrder { method: -3, search_velocity: 20_000.4, zero_velocity: 0.2, acceleration: 500_000.0 };

    /// Writes the next object and passes the answer.
    fn answer(setup: &mut HomingSetup, is_good: bool) -> (Object, Vec<u8>) {
        let (object, data) = setup.next_object().expect("something is next");
        assert!(setup.is_pending(object) && setup.next_object().is_none(), "one at a time");
        setup.handle_answer(object, data.clone(), is_good);
        (object, data)
    }

    /// 6098h, 6099h:01, 6099h:02, 609Ah; a speed is at least 1.
    #[test]
    fn mode_6_is_commanded_after_all_objects_are_written() {
        let mut setup = HomingSetup::new(VelocityFactor::default());
        assert_eq!((setup.allowed_mode(Mode::Position, 0), setup.next_object()), (8, None));
        let expected = [
            (objects::HOMING_METHOD, vec![0xFD]),
            (objects::HOMING_SEARCH, 20_000_u32.to_le_bytes().to_vec()),
            (objects::HOMING_ZERO, 1_u32.to_le_bytes().to_vec()),
            (objects::HOMING_ACCELERATION, 500_000_u32.to_le_bytes().to_vec()),
        ];
        for written in expected {
            assert_eq!(setup.allowed_mode(Mode::Homing(ORDER), 8), 8);
            assert_eq!(answer(&mut setup, true), written);
        }
        assert_eq!((setup.allowed_mode(Mode::Homing(ORDER), 8), setup.next_object()), (6, None));
        assert_eq!(setup.allowed_mode(Mode::Position, 6), 8);
        assert_eq!(setup.allowed_mode(Mode::Homing(ORDER), 8), 8, "a second homing is set up anew");
    }

    #[test]
    fn refused_object_prevents_mode_6() {
        let mut setup = HomingSetup::new(VelocityFactor::default());
        setup.allowed_mode(Mode::Homing(ORDER), 8);
        answer(&mut setup, false);
        assert_eq!((setup.next_object(), setup.allowed_mode(Mode::Homing(ORDER), 8)), (None, 8));
        let other = HomingOrder { method: 17, ..ORDER };
        setup.allowed_mode(Mode::Position, 8);
        setup.allowed_mode(Mode::Homing(other), 8);
        assert_eq!(answer(&mut setup, true).1, [17]);
    }

    /// The answer that belongs to the previous command is ignored.
    #[test]
    fn new_homing_command_restarts_setup() {
        let mut setup = HomingSetup::new(VelocityFactor::default());
        setup.allowed_mode(Mode::Homing(ORDER), 8);
        answer(&mut setup, true);
        let (object, data) = setup.next_object().unwrap();
        setup.allowed_mode(Mode::Homing(HomingOrder { method: 17, ..ORDER }), 8);
        assert_eq!(setup.next_object(), None, "its answer has not come");
        setup.handle_answer(object, data, true);
        assert_eq!(answer(&mut setup, true), (objects::HOMING_METHOD, vec![17]));
    }
}
