//! Responses that refuse a request before it becomes a command.

use lineshaft_msgs::foreign::controller_manager_msgs::srv::{SwitchControllerRequest, SwitchControllerResponse};
use lineshaft_msgs::foreign::lifecycle_msgs::srv::{ChangeStateRequest, ChangeStateResponse};
use lineshaft_msgs::foreign::rcl_interfaces::msg::SetParametersResult;
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    SetParametersAtomicallyRequest, SetParametersAtomicallyResponse, SetParametersRequest, SetParametersResponse,
};
use lineshaft_msgs::foreign::std_srvs::srv::{TriggerRequest, TriggerResponse};
use lineshaft_msgs::srv::{
    AxesCommandRequest, AxesCommandResponse, CommandFunctionRequest, CommandFunctionResponse, ImportParametersRequest,
    ImportParametersResponse, LoadProgramRequest, LoadProgramResponse, LoadTableRequest, LoadTableResponse,
    RecordRequest, RecordResponse, ResetParametersRequest, ResetParametersResponse, SdoReadRequest, SdoReadResponse,
    SdoWriteRequest, SdoWriteResponse, VocabularyRequest, VocabularyResponse,
};

/// Response to requests of type `Q`.
pub(super) trait RefusalResponse<Q> {
    /// Returns the response with the reason why nothing was done.
    fn refusing(request: &Q, sentence: String) -> Self;
}

/// Response that has only a result and a message.
pub(super) trait OutcomeResponse {
    /// Returns the response to a request that was executed, or refused with a message.
    fn of(outcome: Result<(), String>) -> Self;
}

/// Implements both for requests and their responses.
macro_rules! refusal_with_message {
    ($($request:ident, $response:ident;)*) => {$(
        impl $crate::surface::refusing::RefusalResponse<$request> for $response {
            fn refusing(_: &$request, message: String) -> Self {
                Self { success: false, message }
            }
        }

        impl $crate::surface::refusing::OutcomeResponse for $response {
            fn of(outcome: Result<(), String>) -> Self {
                Self { success: outcome.is_ok(), message: outcome.err().unwrap_or_default() }
            }
        }
    )*};
}

pub(super) use refusal_with_message;

refusal_with_message! {
    AxesCommandRequest, AxesCommandResponse;
    ImportParametersRequest, ImportParametersResponse;
    LoadProgramRequest, LoadProgramResponse;
    LoadTableRequest, LoadTableResponse;
    ResetParametersRequest, ResetParametersResponse;
    SdoWriteRequest, SdoWriteResponse;
    TriggerRequest, TriggerResponse;
    VocabularyRequest, VocabularyResponse;
}

impl RefusalResponse<RecordRequest> for RecordResponse {
    fn refusing(_: &RecordRequest, message: String) -> Self {
        Self { success: false, message, ..Self::default() }
    }
}

impl RefusalResponse<CommandFunctionRequest> for CommandFunctionResponse {
    fn refusing(_: &CommandFunctionRequest, message: String) -> Self {
        Self { success: false, message, ..Self::default() }
    }
}

impl RefusalResponse<SdoReadRequest> for SdoReadResponse {
    fn refusing(_: &SdoReadRequest, message: String) -> Self {
        Self { success: false, message, ..Self::default() }
    }
}

impl RefusalResponse<SwitchControllerRequest> for SwitchControllerResponse {
    fn refusing(_: &SwitchControllerRequest, message: String) -> Self {
        Self { ok: false, message }
    }
}

impl RefusalResponse<ChangeStateRequest> for ChangeStateResponse {
    /// The message of ROS has no field for the reason, which is only logged.
    fn refusing(_: &ChangeStateRequest, _: String) -> Self {
        Self { success: false }
    }
}

impl RefusalResponse<SetParametersRequest> for SetParametersResponse {
    fn refusing(request: &SetParametersRequest, reason: String) -> Self {
        let refused = SetParametersResult { successful: false, reason };
        // A request that cannot be read has no parameters here, and an empty list would read as success.
        Self { results: vec![refused; request.parameters.len().max(1)] }
    }
}

impl RefusalResponse<SetParametersAtomicallyRequest> for SetParametersAtomicallyResponse {
    fn refusing(_: &SetParametersAtomicallyRequest, reason: String) -> Self {
        Self { result: SetParametersResult { successful: false, reason } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_msgs::foreign::rcl_interfaces::msg::Parameter;

    #[test]
    fn refused_request_to_set_parameters_has_a_result_even_without_parameters() {
        let refused = SetParametersResult { successful: false, reason: "too late".to_owned() };
        for (given, results) in [(0, 1), (1, 1), (3, 3)] {
            let request = SetParametersRequest { parameters: vec![Parameter::default(); given] };
            let response = SetParametersResponse::refusing(&request, "too late".to_owned());
            assert_eq!(response, SetParametersResponse { results: vec![refused.clone(); results] });
        }
    }
}
