//! Reads the switches of an axis.

use crate::axis::state::{Axis, Switches};
use crate::drive::{Inputs, inputs};

impl Axis {
    /// Reads the switches of this cycle.
    pub fn read_switches(&mut self, all: &Inputs) {
        let drive = self.drive().and_then(|drive| all.drive.get(drive));
        self.observed.read_switches(Switches::read(drive, all, &self.parameters.assigned));
        if self.gantry().is_some() {
            // The input data of the drive already contain the switches of both drives.
            self.observed.set_home(drive.is_some_and(|drive| drive.inputs & inputs::HOME != 0));
        }
    }
}
