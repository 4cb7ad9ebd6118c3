//! `~/get_logger_levels` and `~/set_logger_levels`, as a node of rclcpp with logger services answers them.

use super::table;
use crate::layer::{CreateError, Loggers, NodeHandle, Request};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{LoggerLevel, SetLoggerLevelsResult};
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    GetLoggerLevelsRequest, GetLoggerLevelsResponse, SetLoggerLevelsRequest, SetLoggerLevelsResponse,
};
use tokio::task::JoinSet;

pub(super) fn start(node: &NodeHandle, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let (mut server, loggers) = (table::GET_LOGGER_LEVELS.server(node)?, node.loggers().clone());
    tasks.spawn(async move {
        while let Some(Request { message, reply }) = server.next().await {
            reply.send_soon(get(&loggers, message));
        }
    });
    let (mut server, loggers) = (table::SET_LOGGER_LEVELS.server(node)?, node.loggers().clone());
    tasks.spawn(async move {
        while let Some(Request { message, reply }) = server.next().await {
            reply.send_soon(set(&loggers, message));
        }
    });
    Ok(())
}

/// Returns the levels; a logger without a level has level unknown.
fn get(loggers: &Loggers, request: GetLoggerLevelsRequest) -> GetLoggerLevelsResponse {
    let level = |name: String| LoggerLevel { level: loggers.get(&name).into(), name };
    GetLoggerLevelsResponse { levels: request.names.into_iter().map(level).collect() }
}

/// Sets each level separately, in their order.
fn set(loggers: &Loggers, request: SetLoggerLevelsRequest) -> SetLoggerLevelsResponse {
    let one = |LoggerLevel { name, level }: LoggerLevel| {
        let outcome = loggers.set_number(&name, level);
        match &outcome {
            Ok(()) => tracing::debug!("level of logger `{name}` is {level}"),
            Err(reason) => tracing::debug!("level of logger `{name}`: {reason}"),
        }
        SetLoggerLevelsResult { successful: outcome.is_ok(), reason: outcome.err().unwrap_or_default() }
    };
    SetLoggerLevelsResponse { results: request.levels.into_iter().map(one).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_set_one_by_one_and_unknown_where_none_is() {
        let loggers = Loggers::new("shaft".to_owned(), None, |_| Ok(()));
        let level = |name: &str, level| LoggerLevel { name: name.to_owned(), level };
        let levels = vec![level("shaft", 40), level("other", 7), level("third", 10)];
        let results = set(&loggers, SetLoggerLevelsRequest { levels }).results;
        assert_eq!(results.iter().map(|result| result.successful).collect::<Vec<_>>(), [true, false, true]);
        assert!(results[0].reason.is_empty() && results[1].reason.starts_with("level is 7; "), "{results:?}");
        let names = ["shaft", "other", "third", ""].map(str::to_owned).to_vec();
        let seen = get(&loggers, GetLoggerLevelsRequest { names }).levels;
        assert_eq!(seen, [level("shaft", 40), level("other", 0), level("third", 10), level("", 20)]);
    }
}
