//! Drives of a machine: the drive of each axis that has one, in file order, followed by the second drives of gantry
//! axes.

use super::{AxisConfig, ConfigError, GantryProblem, MachineConfig};
use crate::axis::{MAX_DELAY, Source};
use crate::drive::{Backend, Capabilities, Interface};
use crate::gantry::{Gantry, GantrySetup};

/// Checks that the drive of an axis has the capabilities that the axis needs.
pub(super) fn check_drive(axis: &AxisConfig, offers: &Capabilities) -> Result<(), ConfigError> {
    let name = || axis.name.clone();
    if offers.delay > MAX_DELAY {
        return Err(ConfigError::Delay { axis: name(), delay: offers.delay });
    }
    if !offers.offers(axis.interface) {
        return Err(ConfigError::NotOffered { axis: name(), interface: axis.interface });
    }
    let homes = [Some(axis.parameters), axis.saved].into_iter().flatten().any(|p| p.homing.in_drive);
    if homes && !offers.homes {
        return Err(ConfigError::HomingNotOffered { axis: name() });
    }
    Ok(())
}

/// Checks that the second drive of an axis can form a gantry with the first.
pub(super) fn check_gantry(axis: &AxisConfig, offers: &Capabilities) -> Result<(), ConfigError> {
    let problem = match axis.drive {
        None => GantryProblem::NoFirst,
        Some(_) if axis.interface != Interface::Position => GantryProblem::Interface(axis.interface),
        Some(first) if first.delay != offers.delay => GantryProblem::Delays(first.delay, offers.delay),
        Some(_) => return Ok(()),
    };
    Err(ConfigError::Gantry { axis: axis.name.clone(), problem })
}

impl MachineConfig {
    /// Checks that each drive belongs to exactly one of these backends, with the capabilities of the cell. Call it
    /// before they start.
    ///
    /// # Errors
    /// The first drive without a backend, or with other capabilities than the cell describes.
    pub fn check_backends(&self, backends: &[&dyn Backend]) -> Result<(), ConfigError> {
        for (place, (_, axis, expected)) in self.drives().enumerate() {
            // Its signals are outputs; it has no backend of its own.
            if axis.analog.is_some() {
                continue;
            }
            let mut offers = backends.iter().filter_map(|backend| backend.capabilities(place));
            let name = axis.name.clone();
            match (offers.next(), offers.next()) {
                (None, _) => return Err(ConfigError::NoBackend { axis: name }),
                (_, Some(_)) => return Err(ConfigError::TwoBackends { axis: name }),
                (offers, None) if offers != Some(expected) => return Err(ConfigError::DriveMismatch { axis: name }),
                _ => {}
            }
        }
        Ok(())
    }

    /// Returns the number of drives: the first drives of all axes in file order, then the second ones.
    pub fn count_drives(&self) -> usize {
        self.count_driven() + self.axes.iter().filter(|axis| axis.second.is_some()).count()
    }

    /// Returns the number of axes with a drive.
    pub(super) fn count_driven(&self) -> usize {
        self.axes.iter().filter(|axis| axis.drive.is_some()).count()
    }

    /// Returns the axes of the drives with their capabilities, in the order of the drives.
    pub fn drives(&self) -> impl Iterator<Item = (u16, &AxisConfig, Capabilities)> {
        let of = |offers: fn(&AxisConfig) -> Option<Capabilities>| {
            (0..).zip(&self.axes).filter_map(move |(index, axis)| Some((index, axis, offers(axis)?)))
        };
        of(|axis| axis.drive).chain(of(|axis| axis.second))
    }

    /// Returns the index of the second drive of an axis; `None` for an axis with one drive.
    pub fn second_drive(&self, axis: u16) -> Option<usize> {
        let behind = |(_, (index, ..)): &(usize, (u16, &AxisConfig, Capabilities))| *index == axis;
        self.drives().enumerate().skip(self.count_driven()).find(behind).map(|(place, _)| place)
    }

    /// Returns the axes with two drives, in file order.
    pub(crate) fn gantries(&self) -> Vec<Gantry> {
        let first = |of: u16| self.drives().position(|(index, ..)| index == of);
        let seconds = self.drives().enumerate().skip(self.count_driven());
        let made = seconds.filter_map(|(second, (axis, config, _))| {
            let Ok(Source::Drive(form)) = Source::of(config.wired, self.encoders.len(), &config.power_on()) else {
                return None;
            };
            let drives = [first(axis)?, second];
            let delay = config.drive?.delay;
            Some(Gantry::new(GantrySetup { axis, drives, form, cycle_ns: self.cycle_ns, delay }))
        });
        made.collect()
    }
}
