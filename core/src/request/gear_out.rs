//! Conversion of requests to end a coupling at a position.
//!
//! Law      the position is in increments, as for `synchronize`: of the leader, which the machine determines when it
//!          executes the command, or of the axis
//! Reads    the names of the cell
//! Refuses  numbers without a meaning, a position beyond the range of positions, a position that is not used
//! Source   contract section 7, PLCopen (MC_GearOut, MC_CamOut)

use super::RequestError;
use super::synchronize::checked_position;
use crate::command::{DisengageAt, GearOut};
use crate::config::MachineConfig;
use crate::sync::Disengage;

/// A request to end a coupling, with names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GearOutRequest {
    /// Name of the following axis.
    pub axis: String,
    /// 0 now, 1 at a position of its master, 2 at a position of the axis.
    pub at: u8,
    /// That position (inc).
    pub increments: i64,
    /// 0 stop, 1 keep velocity, 2 as given in its goal.
    pub disengage: u8,
}

impl MachineConfig {
    /// Converts the end of a coupling to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_gear_out(&self, request: &GearOutRequest) -> Result<GearOut, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let choice = |field, value: i64, allowed| RequestError::BadChoice { field, value, allowed };
        let increments = request.increments;
        let at = match (request.at, increments) {
            (0, 0) => DisengageAt::Now,
            (0, given) => {
                return Err(choice("increments", given, "0 is allowed with at NOW, which waits for no place"));
            }
            (1, given) => DisengageAt::Leader(checked_position("increments", given)?),
            (2, given) => DisengageAt::Axis(checked_position("increments", given)?),
            (other, _) => {
                return Err(choice("at", other.into(), "0 NOW, 1 MASTER_POSITION, 2 POSITION are allowed"));
            }
        };
        let disengage = match request.disengage {
            0 => Some(Disengage::Stop),
            1 => Some(Disengage::KeepVelocity),
            2 => None,
            other => {
                let allowed = "0 STOP, 1 KEEP_VELOCITY, 2 AS_GOAL are allowed";
                return Err(choice("disengage", other.into(), allowed));
            }
        };
        Ok(GearOut { axis, at, disengage })
    }
}
