//! Inputs that detect printed marks.
//!
//! Law      the edges of a cycle are interpolated linearly in its travel, and each is a latch with its age; the level
//!          is that of t_k
//! Reads    the travel of a drive, or of an encoder without slip: a mark is on the material
//! Writes   latches and levels of digital inputs
//! Refuses  marks that may overlap; inputs that do not latch
//! Source   contract section 3, MACS-MARK-05

use super::{Bus, Marks, Plant, age};
use crate::drive::{Inputs, Latch};
use crate::object::Object;

/// Carrier of marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// A drive, by its index.
    Drive(usize),
    /// An encoder, by its index.
    Encoder(usize),
}

/// An input that detects marks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sensor {
    /// Index among the digital inputs.
    pub input: usize,
    pub carrier: Carrier,
    pub marks: Marks,
    /// Last position; `None` before the first cycle.
    pub at: Option<i64>,
}

impl Plant {
    /// Prints marks on a carrier, for a digital input of the cell that detects them, by its index. Returns false if the
    /// marks may overlap, or the input is not of this plant or does not latch.
    pub fn print(&mut self, input: usize, carrier: Carrier, marks: Marks) -> bool {
        let is_ours = |bus: &Bus| bus.objects.digital_inputs.iter().any(|terminal| terminal.place == input);
        let latches = self.latching.get(input).is_some_and(Option::is_some);
        let can_be_seen = marks.is_sound() && latches && self.buses.iter().any(is_ours);
        if can_be_seen {
            self.sensors.push(Sensor { input, carrier, marks, at: None });
        }
        can_be_seen
    }

    /// Reports the marks that have passed their inputs, after the update of drives and encoders.
    pub(super) fn report_marks(&mut self, inputs: &mut Inputs) {
        for index in 0..self.sensors.len() {
            let Some(&Sensor { input, carrier, marks, at }) = self.sensors.get(index) else { continue };
            let seen = match carrier {
                Carrier::Drive(place) => {
                    let drive = self.drives.get(place).and_then(Option::as_ref);
                    drive.map(|drive| (drive.place(), drive.has_jumped()))
                }
                Carrier::Encoder(place) => {
                    self.encoders.get(place).map(|encoder| (encoder.way(), encoder.is_elsewhere()))
                }
            };
            let (Some((way, is_elsewhere)), Some(Some(entry))) = (seen, self.latching.get(input)) else { continue };
            if at == Some(way) {
                continue;
            }
            let object = Object::Io(*entry);
            if let Some(at) = at.filter(|_| !is_elsewhere && !self.is_bus_off(object)) {
                marks.pass(at, way, |left, edge| {
                    let age_ns = Some(age(left, self.cycle_ns));
                    inputs.add_latch(Latch { object, edge, age_ns, position: None });
                });
            }
            self.put_digital(input, marks.is_detected(way));
            if let Some(sensor) = self.sensors.get_mut(index) {
                sensor.at = Some(way);
            }
        }
    }
}
