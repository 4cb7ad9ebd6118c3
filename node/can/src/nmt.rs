//! Network management: which state a device is in, and how it is brought into another one (CiA 301).
//!
//! Law      a device boots, is pre-operational, and exchanges process data only while it is operational
//! Reads    boot-up messages, heartbeats, answers to guarding: one byte, bit 7 of it a toggle
//! Refuses  other lengths and states
//! Source   CiA 301

use crate::{Frame, Id, NodeId};

/// The state of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmtState {
    /// It has just started, and is pre-operational from now on.
    BootUp,
    /// Network management and heartbeat alone.
    Stopped,
    /// All services.
    Operational,
    /// All services but process data.
    PreOperational,
}

/// What a device is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmtCommand {
    /// Operational.
    Start,
    /// Stopped.
    Stop,
    /// Pre-operational.
    EnterPreOperational,
    /// Boots anew.
    ResetNode,
    /// Boots its communication anew.
    ResetCommunication,
}

impl NmtCommand {
    /// The frame that tells one device, or all of them.
    pub fn frame(self, node: Option<NodeId>) -> Frame {
        let command = match self {
            Self::Start => 0x01,
            Self::Stop => 0x02,
            Self::EnterPreOperational => 0x80,
            Self::ResetNode => 0x81,
            Self::ResetCommunication => 0x82,
        };
        Frame::short(Id::NMT, [command, node.map_or(0, NodeId::get)])
    }
}

/// A sign of life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Life {
    /// The state that the device shows.
    pub state: NmtState,
    /// Bit 7: alternates in answers to guarding, 0 in heartbeats.
    pub toggle: bool,
}

impl Life {
    /// Reads a frame on 700h + node; none where it is no sign of life.
    pub fn of(frame: &Frame) -> Option<Self> {
        let &[byte] = frame.bytes() else { return None };
        let state = match byte & 0x7F {
            0x00 => NmtState::BootUp,
            0x04 => NmtState::Stopped,
            0x05 => NmtState::Operational,
            0x7F => NmtState::PreOperational,
            _ => return None,
        };
        Some(Self { state, toggle: byte & 0x80 != 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The command bytes of CiA 301.
    #[test]
    fn a_command_names_one_device_or_all() {
        let node = NodeId::new(3);
        let commands = [
            (NmtCommand::Start, 0x01),
            (NmtCommand::Stop, 0x02),
            (NmtCommand::EnterPreOperational, 0x80),
            (NmtCommand::ResetNode, 0x81),
            (NmtCommand::ResetCommunication, 0x82),
        ];
        for (command, byte) in commands {
            assert_eq!((command.frame(node).id(), command.frame(node).bytes()), (Id::NMT, &[byte, 3][..]));
            assert_eq!(command.frame(None).bytes(), [byte, 0]);
        }
    }

    #[test]
    fn signs_of_life_are_one_byte() {
        let id = NodeId::new(3).unwrap().heartbeat();
        let life = |bytes: &[u8]| Life::of(&Frame::data(id, bytes).unwrap());
        let of = |state, toggle| Some(Life { state, toggle });
        assert_eq!(life(&[0x00]), of(NmtState::BootUp, false));
        assert_eq!(life(&[0x05]), of(NmtState::Operational, false));
        assert_eq!(life(&[0x85]), of(NmtState::Operational, true));
        assert_eq!(life(&[0xFF]), of(NmtState::PreOperational, true));
        assert_eq!(life(&[0x04]), of(NmtState::Stopped, false));
        assert_eq!((life(&[0x06]), life(&[]), life(&[5, 0])), (None, None, None));
        assert_eq!(Life::of(&Frame::remote(id, 1).unwrap()), None, "our own question");
    }
}
