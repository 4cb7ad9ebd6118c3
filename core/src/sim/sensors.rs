//! Inputs that see printed marks.
//!
//! Law      the edges of a cycle lie on the straight line of the way in it, and each is a latch with its age; the level is that of t_k
//! Reads    the way of a drive, or of an encoder before it slips: a mark lies on the material
//! Writes   latches and levels of digital inputs
//! Refuses  marks that are not sound; inputs that latch nothing
//! Source   contract section 3, MACS-MARK-05

use super::{Bus, Marks, Plant, age};
use crate::drive::{Inputs, Latch};
use crate::object::Object;

/// What carries marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// A drive, by its place among the drives.
    Drive(usize),
    /// An encoder, by its place.
    Encoder(usize),
}

/// An input that sees the marks of a way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sensor {
    /// By its place among the digital inputs.
    pub input: usize,
    pub carrier: Carrier,
    pub marks: Marks,
    /// Where the way was; none before the first cycle.
    pub at: Option<i64>,
}

impl Plant {
    /// Prints marks on what carries them, for a digital input that sees them by its place among those of the cell. False where they are not
    /// sound, or the input is not of this plant or latches nothing.
    pub fn print(&mut self, input: usize, carrier: Carrier, marks: Marks) -> bool {
        let is_ours = |bus: &Bus| bus.objects.digital_inputs.iter().any(|terminal| terminal.place == input);
        let latches = self.latching.get(input).is_some_and(Option::is_some);
        let can_be_seen = marks.is_sound() && latches && self.buses.iter().any(is_ours);
        if can_be_seen {
            self.sensors.push(Sensor { input, carrier, marks, at: None });
        }
        can_be_seen
    }

    /// Marks that have passed the inputs that see them, once drives and encoders are where they are.
    pub(super) fn see_marks(&mut self, inputs: &mut Inputs) {
        for index in 0..self.sensors.len() {
            let Some(&Sensor { input, carrier, marks, at }) = self.sensors.get(index) else { continue };
            let seen = match carrier {
                Carrier::Drive(place) => {
                    let drive = self.drives.get(place).and_then(Option::as_ref);
                    drive.map(|drive| (drive.place(), drive.is_elsewhere()))
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
            if let Some(at) = at.filter(|_| !is_elsewhere && !self.is_cut_off(object)) {
                marks.pass(at, way, |left, edge| {
                    let age_ns = Some(age(left, self.cycle_ns));
                    inputs.add_latch(Latch { object, edge, age_ns, position: None });
                });
            }
            self.put_digital(input, marks.is_seen(way));
            if let Some(sensor) = self.sensors.get_mut(index) {
                sensor.at = Some(way);
            }
        }
    }
}
