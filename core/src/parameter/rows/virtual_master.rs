//! What runs the virtual master of the machine: commands of MACS, parameters here.

use super::{Applies, BASE, Group, MLONG, Range, Row, Storage, Value};

const MASTER_ROW: Row =
    Row { group: Group::Global, default: Value::Int(0), storage: Storage::Volatile, applies: Applies::Machine, ..BASE };

pub(super) const ROWS: &[Row] = rows! {
    "pulsvel": MASTER_ROW, machine.pulsvel {
        unit: "inc/s", range: Range::Int(-MLONG, MLONG),
        description: "PULSVEL of MACS: velocity of machine.vmaster, below 0 backwards. Its set starts it, also one of the same value, and \
            takes vmenctyp over; i_break and abort set it to 0 and end it. In a cell it is 0.",
        source: "MACS-VM-02, MACS-VM-08, MACS-ERR-09" }
    "pulsacc": MASTER_ROW, machine.pulsacc {
        unit: "inc/s^2", range: Range::Int(-1, MLONG),
        description: "PULSACC of MACS: acceleration of machine.vmaster. 0 ends it, and it stands; above 0 no cycle changes its velocity by \
            more; -1: setsys_15 is its velocity.",
        source: "MACS-VM-02, MACS-VM-03, MACS-VM-04" }
    "setsys_15": MASTER_ROW, machine.setsys_15 {
        unit: "inc/s", range: Range::Int(-MLONG, MLONG),
        description: "SETSYS 15 of MACS: velocity of machine.vmaster with pulsacc -1, at once and without a ramp; i_break and abort set it \
            to 0. In a cell it is 0.",
        source: "MACS-VM-04, MACS-ERR-09" }
};
