//! Conversion of requests for the loops below the position loop.
//!
//! Law      the value is a fraction of full scale, independent of the unit of the axis
//! Reads    the names of the cell
//! Refuses  an unknown axis, values beyond 1, levels without a meaning
//! Source   MACS-AMP-02, MACS-CMD-28

use super::RequestError;
use crate::command::{Level, OutAn};
use crate::config::MachineConfig;
use crate::unit::number_to_text;

/// A value for the loops below the position loop, with names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutAnRequest {
    /// Name of the axis.
    pub axis: String,
    /// Value, -1 to 1.
    pub value: f64,
    /// Loop that receives the value.
    pub level: Level,
}

impl MachineConfig {
    /// Converts the request to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_out_an(&self, request: &OutAnRequest) -> Result<OutAn, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let OutAnRequest { value, level, .. } = *request;
        if !(-1.0..=1.0).contains(&value) {
            let (name, value, allowed) = ("value".to_owned(), number_to_text(value), "-1 to 1".to_owned());
            return Err(RequestError::BadParameter { name, value, allowed });
        }
        // A recording keeps no -0.
        Ok(OutAn { axis, value: value + 0.0, level })
    }
}
