//! Node ID and its identifiers (CiA 301, predefined connection set).

use crate::Id;
use std::fmt;

/// Node ID, 1 to 127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(u8);

impl NodeId {
    /// Highest node ID.
    pub const MAX: u8 = 127;

    /// Creates a node ID of 1 to 127; `None` for any other number.
    pub const fn new(number: u8) -> Option<Self> {
        if number >= 1 && number <= Self::MAX { Some(Self(number)) } else { None }
    }

    /// Returns the number.
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Returns the identifier of emergency messages, 080h + node.
    pub const fn emergency(self) -> Id {
        self.with(0x080)
    }

    /// Returns the default identifier of transmit PDO 1 to 4, 180h to 480h + node; `None` for any other number.
    pub const fn tpdo(self, number: u8) -> Option<Id> {
        self.pdo(0x180, number)
    }

    /// Returns the default identifier of receive PDO 1 to 4, 200h to 500h + node; `None` for any other number.
    pub const fn rpdo(self, number: u8) -> Option<Id> {
        self.pdo(0x200, number)
    }

    /// Returns the identifier of SDO requests to the node, 600h + node.
    pub const fn sdo_request(self) -> Id {
        self.with(0x600)
    }

    /// Returns the identifier of SDO answers of the node, 580h + node.
    pub const fn sdo_response(self) -> Id {
        self.with(0x580)
    }

    /// Returns the identifier of boot-up message, heartbeat and answer to node guarding, 700h + node.
    pub const fn heartbeat(self) -> Id {
        self.with(0x700)
    }

    const fn pdo(self, first: u16, number: u8) -> Option<Id> {
        match number {
            1..=4 => Some(self.with(first + 0x100 * (number as u16 - 1))),
            _ => None,
        }
    }

    /// The result is at most 77Fh.
    const fn with(self, function: u16) -> Id {
        Id::of_function(function, self.0)
    }
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node {}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table of CiA 301 for node 5.
    #[test]
    fn each_service_has_its_identifier() {
        let node = NodeId::new(5).unwrap();
        let own = [node.emergency(), node.sdo_request(), node.sdo_response(), node.heartbeat()];
        assert_eq!(own.map(Id::get), [0x085, 0x605, 0x585, 0x705]);
        let pdos = |of: fn(NodeId, u8) -> Option<Id>| [1, 2, 3, 4].map(|number| of(node, number).unwrap().get());
        assert_eq!(pdos(NodeId::tpdo), [0x185, 0x285, 0x385, 0x485]);
        assert_eq!(pdos(NodeId::rpdo), [0x205, 0x305, 0x405, 0x505]);
        assert_eq!((node.tpdo(0), node.rpdo(5)), (None, None));
        assert_eq!(
            [0, 1, 127, 128].map(|number| NodeId::new(number).map(NodeId::get)),
            [None, Some(1), Some(127), None]
        );
    }
}
