//! Decodes CAN frames to text.
//!
//! Law      identifiers have the meaning of the predefined connection set, unless a PDO was assigned to an identifier. Values have names
//!          and types if a dictionary is known for their node
//! Refuses  nothing: an unknown frame is described as unknown
//! Source   CiA 301, CiA 305 (LSS)

use super::allowed::label;
use super::exchange::Exchange;
use super::words::nmt_state;
use crate::eds::Dictionary;
use crate::{Frame, Id, NmtState, NodeId, SignOfLife};
use lineshaft_cia402::dictionary::{DataType, Direction, Mapped, Value};
use lineshaft_cia402::texts::{drive_state, error, hex, register};
use lineshaft_core::drive::DriveState;
use std::collections::BTreeMap;

/// PDO of an identifier.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssignedPdo {
    /// Node that sends or receives it.
    pub node: NodeId,
    /// Direction, from the view of the device.
    pub direction: Direction,
    /// PDO number, from 1.
    pub number: u16,
    /// Mapped objects; empty if the mapping is unknown.
    pub mapped: Vec<Mapped>,
}

/// Decodes frames to text.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    dictionaries: BTreeMap<NodeId, Dictionary>,
    pdos: BTreeMap<Id, AssignedPdo>,
    exchanges: BTreeMap<NodeId, Exchange>,
}

impl Decoder {
    /// Adds the dictionary of a node, and its PDOs, except those that were assigned before.
    pub fn add_dictionary(&mut self, node: NodeId, dictionary: Dictionary) {
        for direction in [Direction::Receive, Direction::Transmit] {
            for number in 1..=4 {
                let Ok(pdo) = dictionary.pdo_mapping(direction, number) else { continue };
                let id = u16::try_from(pdo.cob_id.id()).ok().and_then(|id| Id::new(id).ok());
                if let Some(id) = id.filter(|_| pdo.cob_id.is_valid() && !pdo.cob_id.is_extended()) {
                    self.pdos.entry(id).or_insert(AssignedPdo { node, direction, number, mapped: pdo.mapped });
                }
            }
        }
        self.dictionaries.insert(node, dictionary);
    }

    /// Assigns a PDO to an identifier.
    pub fn assign_pdo(&mut self, id: Id, pdo: AssignedPdo) {
        self.pdos.insert(id, pdo);
    }

    /// Returns true if a frame is from or to the node.
    pub fn is_of_node(&self, frame: &Frame, node: NodeId) -> bool {
        match (frame.id(), frame.bytes()) {
            (Id::NMT, [_, of]) => *of == 0 || *of == node.get(),
            (id, _) => self.pdos.get(&id).map_or_else(|| owner(id), |pdo| Some(pdo.node)) == Some(node),
        }
    }

    /// Returns the text of a frame.
    pub fn words(&mut self, frame: &Frame) -> String {
        let id = frame.id();
        if let Some(pdo) = self.pdos.get(&id) {
            return if frame.is_remote() { format!("{} is asked for", name(pdo)) } else { self.pdo_text(pdo, frame) };
        }
        match (id.get(), owner(id)) {
            _ if id == Id::LSS_MASTER => lss("LSS master", frame.bytes()),
            _ if id == Id::LSS_SLAVE => lss("LSS slave", frame.bytes()),
            (0, _) => nmt(frame.bytes()),
            (0x80, _) => match frame.bytes() {
                [counter] => format!("SYNC {counter}"),
                _ => "SYNC".to_owned(),
            },
            _ if id == Id::TIME => time(frame.bytes()),
            (_, Some(node)) if frame.is_remote() => match id == node.heartbeat() {
                true => format!("node {} is asked for its state", node.get()),
                false => "remote frame".to_owned(),
            },
            (number, Some(node)) => self.of_node(number, node, frame),
            (_, None) if frame.is_remote() => "remote frame".to_owned(),
            (_, None) => "not known".to_owned(),
        }
    }

    fn of_node(&mut self, id: u16, node: NodeId, frame: &Frame) -> String {
        let known = self.dictionaries.get(&node);
        match id & 0x780 {
            0x080 => emergency(node, frame.bytes()),
            0x580 => self.exchanges.entry(node).or_default().response(node, frame, known),
            0x600 => self.exchanges.entry(node).or_default().request(node, frame, known),
            0x700 => heartbeat_text(node, frame),
            function => {
                let number = (function - 0x180) / 0x100 + 1;
                let is_told = function & 0x80 != 0;
                format!("{}PDO {number} of node {}", if is_told { 'T' } else { 'R' }, node.get())
            }
        }
    }

    /// Returns a PDO with its values as text.
    fn pdo_text(&self, pdo: &AssignedPdo, frame: &Frame) -> String {
        let known = self.dictionaries.get(&pdo.node);
        let mut wide = [0; 8];
        for (to, from) in wide.iter_mut().zip(frame.bytes()) {
            *to = *from;
        }
        let (all, mut at) = (u64::from_le_bytes(wide), 0_u32);
        let mut values = Vec::new();
        for Mapped { object, bits } in &pdo.mapped {
            let bits = u32::from(*bits);
            if bits == 0 || at + bits > u32::from(frame.length()) * 8 {
                values.push("too short for what it carries".to_owned());
                break;
            }
            let value = all >> at & (u64::MAX >> (64 - bits.min(64)));
            at += bits;
            // A dummy entry, which only fills bits.
            if object.index < 0x1000 {
                continue;
            }
            let data_type = known.and_then(|known| known.entry(*object)).map(|entry| entry.data_type);
            values.push(format!("{} {}", label(*object, known), value_text(object.index, value, bits, data_type)));
        }
        if values.is_empty() { name(pdo) } else { format!("{}: {}", name(pdo), values.join(", ")) }
    }
}

fn name(pdo: &AssignedPdo) -> String {
    let letter = if pdo.direction == Direction::Transmit { 'T' } else { 'R' };
    format!("{letter}PDO {} of node {}", pdo.number, pdo.node.get())
}

/// Returns the node to which an identifier belongs in the predefined connection set.
fn owner(id: Id) -> Option<NodeId> {
    let node = NodeId::new((id.get() & 0x7F) as u8)?;
    matches!(id.get() & 0x780, 0x080 | 0x180..=0x600 | 0x700).then_some(node)
}

/// Returns a value of a PDO as text. Words of bits are shown in hexadecimal.
fn value_text(index: u16, value: u64, bits: u32, data_type: Option<DataType>) -> String {
    let digits = bits.div_ceil(4) as usize;
    let word = format!("{value:0digits$X}h");
    match index {
        0x6041 => format!("{word} ({})", drive_state(DriveState::from_status(value as u16))),
        0x603F => error(value as u16),
        0x6040 | 0x60FD | 0x60FE => word,
        _ => {
            let bytes = value.to_le_bytes();
            let of_type = data_type.filter(|data_type| data_type.bits() == Some(bits));
            let read = |data_type| Value::from_bytes(data_type, bytes.get(..bits.div_ceil(8) as usize)?).ok();
            of_type.and_then(read).map_or(word, |value| value.to_string())
        }
    }
}

fn nmt(bytes: &[u8]) -> String {
    let &[command, node] = bytes else { return "NMT of another length".to_owned() };
    let whom = if node == 0 { "all nodes".to_owned() } else { format!("node {node}") };
    match command {
        0x01 => format!("NMT start {whom}"),
        0x02 => format!("NMT stop {whom}"),
        0x80 => format!("NMT pre-operational {whom}"),
        0x81 => format!("NMT reset {whom}"),
        0x82 => format!("NMT reset the communication of {whom}"),
        other => format!("NMT {other:02X}h {whom}"),
    }
}

fn heartbeat_text(node: NodeId, frame: &Frame) -> String {
    let node = node.get();
    match SignOfLife::of(frame) {
        Some(SignOfLife { state: NmtState::BootUp, toggle: false }) => format!("node {node} has booted"),
        Some(SignOfLife { state, toggle: false }) => format!("node {node} is {}", nmt_state(state)),
        Some(SignOfLife { state, toggle: true }) => format!("node {node} is {} (toggle 1)", nmt_state(state)),
        None => format!("node {node} shows no state that is known"),
    }
}

fn emergency(node: NodeId, bytes: &[u8]) -> String {
    let node = node.get();
    let &[low, high, bits, ref vendor @ ..] = bytes else { return format!("EMCY of node {node}, too short") };
    let code = u16::from_le_bytes([low, high]);
    let text = format!("EMCY of node {node}: {}, error register {bits:02X}h ({})", error(code), register(bits.into()));
    if vendor.iter().all(|byte| *byte == 0) { text } else { format!("{text}, {}", hex(vendor)) }
}

/// Returns the time of a TIME frame: milliseconds of the day, and days since 1984-01-01.
fn time(bytes: &[u8]) -> String {
    let &[a, b, c, d, low, high] = bytes else { return "TIME of another length".to_owned() };
    let ms = u32::from_le_bytes([a, b, c, d]) & 0x0FFF_FFFF;
    let (s, days) = (ms / 1000, u16::from_le_bytes([low, high]));
    format!("TIME {:02}:{:02}:{:02}.{:03}, day {days} since 1984-01-01", s / 3600, s / 60 % 60, s % 60, ms % 1000)
}

fn lss(who: &str, bytes: &[u8]) -> String {
    let Some(command) = bytes.first() else { return who.to_owned() };
    let words = match command {
        4 => "switch state of all",
        17 => "node id",
        19 => "bit rate",
        21 => "activate the bit rate",
        23 => "store",
        64..=67 => "switch state of one",
        68 => "state of one is switched",
        70..=75 => "identify a slave",
        76 => "identify slaves without a node id",
        79 => "a slave is identified",
        80 => "a slave without a node id is identified",
        81 => "fastscan",
        90..=93 => "identity",
        94 => "node id is asked for",
        _ => "command that is not known",
    };
    format!("{who}: {words} ({command})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eds;
    use lineshaft_cia402::object::Object;

    fn node() -> NodeId {
        NodeId::new(3).unwrap()
    }

    fn frame(id: u16, bytes: &[u8]) -> Frame {
        Frame::data(Id::new(id).unwrap(), bytes).unwrap()
    }

    fn words(id: u16, bytes: &[u8]) -> String {
        Decoder::default().words(&frame(id, bytes))
    }

    fn knowing() -> Decoder {
        let mut decoder = Decoder::default();
        let known = eds::parse(include_bytes!("../../../../launch-configs/can/cia402_sim.eds"), Some(3)).unwrap();
        decoder.add_dictionary(node(), known);
        decoder
    }

    #[test]
    fn frames_are_decoded_without_dictionary() {
        let rows: [(u16, &[u8], &str); 17] = [
            (0x000, &[1, 0], "NMT start all nodes"),
            (0x000, &[0x82, 5], "NMT reset the communication of node 5"),
            (0x080, &[], "SYNC"),
            (0x080, &[7], "SYNC 7"),
            (
                0x083,
                &[0x11, 0x86, 0x21, 0, 0, 0, 0, 0],
                "EMCY of node 3: 8611h following error, error register 21h (generic, profile)",
            ),
            (
                0x083,
                &[0, 0, 0, 1, 2, 0, 0, 0],
                "EMCY of node 3: 0000h no error, error register 00h (none), 01 02 00 00 00",
            ),
            (0x100, &[0x78, 0x56, 0x34, 0x02, 0x10, 0x3A], "TIME 10:16:24.440, day 14864 since 1984-01-01"),
            (0x183, &[1], "TPDO 1 of node 3"),
            (0x503, &[1], "RPDO 4 of node 3"),
            (0x703, &[0], "node 3 has booted"),
            (0x703, &[5], "node 3 is operational"),
            (0x703, &[0x85], "node 3 is operational (toggle 1)"),
            (0x703, &[9], "node 3 shows no state that is known"),
            (0x7E5, &[81, 0, 0, 0, 0, 0, 0, 0], "LSS master: fastscan (81)"),
            (0x7E4, &[79, 0, 0, 0, 0, 0, 0, 0], "LSS slave: a slave is identified (79)"),
            (0x680, &[], "not known"),
            (0x603, &[0x40], "SDO 3 request of another length"),
        ];
        for (id, bytes, expected) in rows {
            assert_eq!(words(id, bytes), expected);
        }
        let question = Frame::remote(node().heartbeat(), 1).unwrap();
        assert_eq!(Decoder::default().words(&question), "node 3 is asked for its state");
    }

    /// TPDO 3 of the dictionary carries 6041h and 6064h.
    #[test]
    fn pdo_values_have_names_and_types_of_dictionary() {
        let mut decoder = knowing();
        assert_eq!(
            decoder.words(&frame(0x383, &[0x37, 0x06, 0xFE, 0xFF, 0xFF, 0xFF])),
            "TPDO 3 of node 3: 6041h:00 Statusword 0637h (operation enabled), 6064h:00 Position actual value -2"
        );
        assert_eq!(
            decoder.words(&frame(0x383, &[0x37, 0x06])),
            "TPDO 3 of node 3: 6041h:00 Statusword 0637h (operation enabled), too short for what it carries"
        );
        assert_eq!(decoder.words(&frame(0x203, &[0x0F, 0])), "RPDO 1 of node 3: 6040h:00 Controlword 000Fh");
    }

    #[test]
    fn assigned_pdo_has_precedence_and_needs_no_dictionary() {
        let mut decoder = Decoder::default();
        let mapped = vec![
            Mapped { object: Object { index: 0x0005, sub: 0 }, bits: 8 },
            Mapped { object: Object { index: 0x6064, sub: 0 }, bits: 32 },
        ];
        let id = Id::new(0x1F0).unwrap();
        decoder.assign_pdo(id, AssignedPdo { node: node(), direction: Direction::Transmit, number: 1, mapped });
        assert_eq!(decoder.words(&frame(0x1F0, &[9, 1, 0, 0, 0])), "TPDO 1 of node 3: 6064h:00 00000001h");
        assert!(decoder.is_of_node(&frame(0x1F0, &[]), node()));
    }

    #[test]
    fn frames_of_node_are_recognized() {
        let decoder = knowing();
        for (id, bytes) in [(0x183, &[][..]), (0x603, &[]), (0x703, &[5]), (0x083, &[]), (0, &[1, 0]), (0, &[1, 3])] {
            assert!(decoder.is_of_node(&frame(id, bytes), node()), "{id:X}");
        }
        for (id, bytes) in [(0x184, &[][..]), (0x080, &[]), (0, &[1, 4]), (0x7E5, &[]), (0x683, &[])] {
            assert!(!decoder.is_of_node(&frame(id, bytes), node()), "{id:X}");
        }
    }

    proptest::proptest! {
        /// Every frame gets a text, and none causes a panic.
        #[test]
        fn every_frame_is_decoded_without_panic(frames in proptest::collection::vec((0_u16..0x800, proptest::collection::vec(proptest::prelude::any::<u8>(), 0..=8)), 0..40)) {
            let mut decoder = knowing();
            for (id, bytes) in frames {
                assert!(!decoder.words(&frame(id, &bytes)).is_empty());
            }
        }
    }
}
