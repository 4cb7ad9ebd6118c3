//! Finds inputs of a drive on CAN that the master does not read although the axis may need them: limit switches, the
//! reference switch, index pulses.
//!
//! Law      the switches of a drive are bits of 60FDh, which a PDO has if the file of the drive can map it or an entry
//!          of `io` names a bit; its index pulses come from a touch probe. A switch with its own digital input is read
//!          from that
//! Refuses  a homing method whose switch or index pulse is not read: the axis would not stop at it
//! Source   CiA 402-2 (60FDh, homing methods)

use super::super::can::CellDrive;
use super::super::names::quote;
use lineshaft_can::config::DeviceConfig;
use lineshaft_cia402::mapping::ReportedValue;
use lineshaft_cia402::probe::Probe;
use lineshaft_core::axis::Source;
use lineshaft_core::config::AxisConfig;

/// A drive, and the objects of it that the master maps.
pub(super) struct Unread<'a> {
    pub(super) axis: &'a AxisConfig,
    /// Whether it is the second of two drives of its axis.
    pub(super) is_second: bool,
    /// Number of encoders of the machine.
    pub(super) encoders: usize,
    /// Keys of the drive in the cell.
    pub(super) described: &'a CellDrive,
    pub(super) device: &'a DeviceConfig,
}

impl Unread<'_> {
    /// Returns a message for each switch and index pulse that homing needs and that is not read.
    pub(super) fn of_homing(&self) -> impl Iterator<Item = String> {
        [self.switch_of_homing(), self.index_of_homing()].into_iter().flatten()
    }

    /// Returns a message if limit switches at the drive do not stop the axis. An axis with a modulo has no ends.
    pub(super) fn limit_switches(&self) -> Option<String> {
        let assigned = self.axis.power_on().assigned;
        let (switches, keys) = match (assigned.poslimitsw, assigned.neglimitsw) {
            (0, 0) => ("limit switches", "i_poslimitsw and i_neglimitsw"),
            (0, _) => ("the positive limit switch", "i_poslimitsw"),
            (_, 0) => ("the negative limit switch", "i_neglimitsw"),
            _ => return None,
        };
        if self.reads_inputs() || self.axis.modulo.is_some() {
            return None;
        }
        let (name, node, (why, how)) = (&self.axis.name, self.device.node, self.reason());
        Some(format!(
            "{name}: switches at the drive ({node}) are not read, so {switches} there cannot stop the axis: {why}; {how}assign inputs with {keys}"
        ))
    }

    /// Whether a PDO has the digital inputs of the drive (60FDh).
    fn reads_inputs(&self) -> bool {
        self.device.layout.told.iter().flat_map(|pdo| &pdo.fields).any(|field| field.word == ReportedValue::Inputs)
    }

    /// Returns the reason why 60FDh is in no PDO, and how to map it.
    fn reason(&self) -> (String, &'static str) {
        match (self.described.drive_type, &self.described.device.eds) {
            (Some(_), _) => ("key `drivetype` fixes the process data".to_owned(), ""),
            (None, None) => (
                "the cell names no EDS or DCF file of it".to_owned(),
                "give `eds`, or an entry of io of type di at this node, which maps 60FDh; or ",
            ),
            (None, Some((file, _))) => {
                (format!("eds {} does not let 60FDh be mapped", quote(file)), "correct 60FDh in that file; or ")
            }
        }
    }

    /// Returns a message if homing uses a switch that is not read.
    fn switch_of_homing(&self) -> Option<String> {
        let p = self.axis.power_on();
        let (switch, key) = if self.is_second {
            // Homing squares a gantry axis with the reference switch of each of its two drives.
            let is_sought = p.gantry.second_refswitch == 0 && self.axis.seeks_reference_switch();
            is_sought.then_some(("reference switch", "i_refswitch_second"))?
        } else {
            self.axis.switch_at_drive()?
        };
        if self.reads_inputs() {
            return None;
        }
        let (name, node, (why, how)) = (&self.axis.name, self.device.node, self.reason());
        Some(format!(
            "{name}: homing.method {} needs the {switch}, and switches at the drive ({node}) are not read: {why}; {how}assign an input with \
             {key}",
            p.homing.method
        ))
    }

    /// Returns a message if homing uses an index pulse that is not read.
    fn index_of_homing(&self) -> Option<String> {
        let p = self.axis.power_on();
        let needs_index = matches!(p.homing.method, 1..=14 | 33 | 34 | -1 | -3) && !p.homing.in_drive;
        let is_own = matches!(Source::of(self.axis.wired, self.encoders, &p), Ok(Source::Drive(_)));
        let is_read = self.described.probes.contains(&Some(Probe::Index));
        if !needs_index || !is_own || is_read || self.is_second {
            return None;
        }
        let (name, node) = (&self.axis.name, self.device.node);
        Some(format!(
            "{name}: homing.method {} needs the index pulse, and index pulses of the drive ({node}) are not read; give it `probe_1: index` or \
             `probe_2: index`, or choose a method without index, or homing.in_drive",
            p.homing.method
        ))
    }
}
