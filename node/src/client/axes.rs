//! `lineshaft enable`, `disable`, `halt`, `reset`: services that do one thing with axes.

use super::output::print;
use super::session::Session;
use super::{Failure, Options};
use crate::recording::clean::clean;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandRequest, AxesCommandResponse};
use lineshaft_ros::layer::Qos;
use std::time::Duration;

/// Maximum time for an answer. The node answers within 60 s: a drive may take long to switch on, and an axis to stop.
const PATIENCE: Duration = Duration::from_secs(65);

/// A service of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxesService {
    Enable,
    Disable,
    Halt,
    ResetErrors,
}

impl AxesService {
    fn name(self) -> &'static str {
        match self {
            Self::Enable => "enable",
            Self::Disable => "disable",
            Self::Halt => "halt",
            Self::ResetErrors => "reset_errors",
        }
    }
}

/// Calls the service for these axes, or for all if none is named, and prints the answer of the node.
///
/// # Errors
/// Returns an error if the node refuses the request or does not answer.
pub(crate) async fn command_axes(options: &Options, service: AxesService, axes: &[String]) -> Result<(), Failure> {
    let is_stop = matches!(service, AxesService::Halt | AxesService::Disable);
    let session = Session::open(&Options { is_stop, ..options.clone() }).await?;
    let mut client = session.service::<AxesCommand>(service.name(), Qos::SERVICE)?;
    let AxesCommandResponse { success, message } = session.call(&mut client, &request(axes), PATIENCE).await?;
    if !success {
        return Err(Failure::Failed(message));
    }
    print(&clean(&message));
    Ok(())
}

fn request(axes: &[String]) -> AxesCommandRequest {
    AxesCommandRequest { axes: axes.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_msgs::cdr;

    #[test]
    fn request_is_the_sequence_of_names() {
        assert_eq!(cdr::encode(&request(&[])), [0; 4], "all axes");
        // CDR: the number of strings; each with its length, its characters and a zero, at a multiple of 4.
        let bytes = [&[2, 0, 0, 0, 2, 0, 0, 0][..], b"x\0", &[0, 0, 3, 0, 0, 0], b"y2\0"].concat();
        assert_eq!(cdr::encode(&request(&["x".to_owned(), "y2".to_owned()])), bytes);
    }
}
