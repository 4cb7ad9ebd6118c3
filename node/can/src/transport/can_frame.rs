//! Frames of the CAN sockets of Linux, `struct can_frame`.
//!
//! Law      16 bytes: identifier with its flags (32 bits in native byte order), length, 3 bytes of padding, 8 bytes of data
//! Reads    16 bytes; the state of the controller comes in error frames: passive, active, off, restarted, overrun
//! Refuses  nothing: frames with an extended identifier are reported as others
//! Source   Linux `linux/can.h`, `linux/can/error.h`

use crate::{Frame, Id};
use lineshaft_core::drive::BusState;

pub(super) const SIZE: usize = 16;

const EXTENDED: u32 = 1 << 31;
const REMOTE: u32 = 1 << 30;
const ERROR: u32 = 1 << 29;

/// Error classes (CAN_ERR_CRTL, CAN_ERR_BUSOFF, CAN_ERR_RESTARTED).
const CONTROLLER: u32 = 0x004;
const BUS_OFF: u32 = 0x040;
const RESTARTED: u32 = 0x100;
/// The frame has error counters (CAN_ERR_CNT): transmit in byte 6, receive in byte 7.
const COUNTERS: u32 = 0x200;
/// Error classes that are evaluated.
pub(super) const ERRORS: u32 = CONTROLLER | BUS_OFF | RESTARTED;

/// Bits of byte 1 of class CONTROLLER (CAN_ERR_CRTL_*), for both directions.
const OVERFLOW: u8 = 0x03;
const WARNING: u8 = 0x0C;
const PASSIVE: u8 = 0x30;
const ACTIVE: u8 = 0x40;

/// Content of a received frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReceivedContent {
    Frame(Frame),
    /// Report of the controller: state of the bus if it has changed; whether frames were lost; error counters if it reports them.
    Controller {
        state: Option<BusState>,
        has_lost: bool,
        errors: Option<(u8, u8)>,
    },
    Other,
}

/// Returns the bytes that send a frame.
pub(super) fn bytes_of(frame: &Frame) -> [u8; SIZE] {
    let flag = if frame.is_remote() { REMOTE } else { 0 };
    let [a, b, c, d] = (u32::from(frame.id().get()) | flag).to_ne_bytes();
    let mut bytes = [a, b, c, d, frame.length(), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    for (place, byte) in bytes.iter_mut().skip(8).zip(frame.bytes()) {
        *place = *byte;
    }
    bytes
}

/// Returns the content of received bytes.
pub(super) fn decode(&[a, b, c, d, length, _, _, _, ref data @ ..]: &[u8; SIZE]) -> ReceivedContent {
    let word = u32::from_ne_bytes([a, b, c, d]);
    if word & ERROR != 0 {
        return controller(word, *data);
    }
    if word & EXTENDED != 0 {
        return ReceivedContent::Other;
    }
    let Ok(id) = Id::new((word & 0x7FF) as u16) else { return ReceivedContent::Other };
    let frame = match data.get(..usize::from(length)) {
        _ if word & REMOTE != 0 => Frame::remote(id, length),
        Some(data) => Frame::data(id, data),
        None => return ReceivedContent::Other,
    };
    frame.map_or(ReceivedContent::Other, ReceivedContent::Frame)
}

fn controller(classes: u32, [_, detail, _, _, _, _, transmit, receive]: [u8; 8]) -> ReceivedContent {
    let errors = (classes & COUNTERS != 0).then_some((transmit, receive));
    let detail = if classes & CONTROLLER != 0 { detail } else { 0 };
    let state = match () {
        () if classes & BUS_OFF != 0 => Some(BusState::Off),
        () if detail & PASSIVE != 0 => Some(BusState::Degraded),
        // Many errors, but fewer than for passive: the state when errors decrease.
        () if classes & RESTARTED != 0 || detail & (ACTIVE | WARNING) != 0 => Some(BusState::Active),
        () => None,
    };
    ReceivedContent::Controller { state, has_lost: detail & OVERFLOW != 0, errors }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bytes(word: u32, length: u8, data: [u8; 8]) -> [u8; SIZE] {
        let mut bytes = [0; SIZE];
        bytes[..4].copy_from_slice(&word.to_ne_bytes());
        bytes[4] = length;
        bytes[8..].copy_from_slice(&data);
        bytes
    }

    #[test]
    fn frame_layout_matches_kernel() {
        let id = Id::new(0x201).unwrap();
        let frame = Frame::data(id, &[0x0F, 0, 1]).unwrap();
        assert_eq!(bytes_of(&frame), bytes(0x201, 3, [0x0F, 0, 1, 0, 0, 0, 0, 0]));
        assert_eq!(bytes_of(&Frame::remote(id, 2).unwrap()), bytes(0x4000_0201, 2, [0; 8]));
        assert_eq!(decode(&bytes(0x8000_0201, 1, [0; 8])), ReceivedContent::Other, "extended");
        assert_eq!(decode(&bytes(0x201, 9, [0; 8])), ReceivedContent::Other, "longer than a frame");
    }

    #[test]
    fn the_controller_tells_how_the_bus_does() {
        let tells = |classes, detail| decode(&bytes(ERROR | classes, 8, [0, detail, 0, 0, 0, 0, 130, 7]));
        let state = |state| ReceivedContent::Controller { state, has_lost: false, errors: None };
        assert_eq!(tells(BUS_OFF, 0), state(Some(BusState::Off)));
        assert_eq!(tells(CONTROLLER, 0x10), state(Some(BusState::Degraded)));
        assert_eq!(tells(CONTROLLER, 0x20 | 0x04), state(Some(BusState::Degraded)));
        assert_eq!(tells(CONTROLLER, 0x08), state(Some(BusState::Active)));
        assert_eq!(tells(CONTROLLER, 0x40), state(Some(BusState::Active)));
        assert_eq!(tells(RESTARTED, 0x10), state(Some(BusState::Active)), "the detail is of another class");
        assert_eq!(tells(0x2, 0), state(None));
        let errors = Some((130, 7));
        assert_eq!(
            tells(CONTROLLER | COUNTERS, 0x01),
            ReceivedContent::Controller { state: None, has_lost: true, errors }
        );
    }

    proptest! {
        #[test]
        fn each_frame_comes_back(id in 0_u16..0x800, data in prop::collection::vec(any::<u8>(), 0..=8), remote: bool) {
            let id = Id::new(id).unwrap();
            let frame = match remote {
                true => Frame::remote(id, data.len() as u8).unwrap(),
                false => Frame::data(id, &data).unwrap(),
            };
            prop_assert_eq!(decode(&bytes_of(&frame)), ReceivedContent::Frame(frame));
        }

        #[test]
        fn no_bytes_are_too_odd(bytes: [u8; SIZE]) {
            decode(&bytes);
        }
    }
}
