//! Network management (NMT): states of a device and commands that change them (CiA 301).
//!
//! Law      a device boots to pre-operational, and exchanges process data only while it is operational
//! Reads    boot-up messages, heartbeats, answers to node guarding: one byte with the toggle bit in bit 7
//! Refuses  other lengths and states
//! Source   CiA 301

use crate::{Frame, Id, NodeId};

/// NMT state of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmtState {
    /// The device has just booted, and is pre-operational from now on.
    BootUp,
    /// Only NMT and heartbeat.
    Stopped,
    /// All services.
    Operational,
    /// All services except process data.
    PreOperational,
}

/// NMT command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmtCommand {
    /// Change to operational.
    Start,
    /// Change to stopped.
    Stop,
    /// Change to pre-operational.
    EnterPreOperational,
    /// Reset and boot again.
    ResetNode,
    /// Reset communication and boot again.
    ResetCommunication,
}

impl NmtCommand {
    /// Returns the frame with the command for one node, or for all.
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

/// Sign of life of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignOfLife {
    /// State that the device reports.
    pub state: NmtState,
    /// Bit 7: alternates in answers to node guarding, is 0 in heartbeats.
    pub toggle: bool,
}

impl SignOfLife {
    /// Reads a frame on 700h + node; `None` if it is not a sign of life.
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

    /// Command bytes of CiA 301.
    #[test]
    fn nmt_command_addresses_one_node_or_all() {
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
    fn sign_of_life_has_one_byte() {
        let id = NodeId::new(3).unwrap().heartbeat();
        let life = |bytes: &[u8]| SignOfLife::of(&Frame::data(id, bytes).unwrap());
        let of = |state, toggle| Some(SignOfLife { state, toggle });
        assert_eq!(life(&[0x00]), of(NmtState::BootUp, false));
        assert_eq!(life(&[0x05]), of(NmtState::Operational, false));
        assert_eq!(life(&[0x85]), of(NmtState::Operational, true));
        assert_eq!(life(&[0xFF]), of(NmtState::PreOperational, true));
        assert_eq!(life(&[0x04]), of(NmtState::Stopped, false));
        assert_eq!((life(&[0x06]), life(&[]), life(&[5, 0])), (None, None, None));
        assert_eq!(SignOfLife::of(&Frame::remote(id, 1).unwrap()), None, "our own question");
    }
}
