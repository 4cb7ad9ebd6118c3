//! Reads log lines of the node on `/rosout`: replies of actions and streams have no field for the reason of a refusal.

use super::Failure;
use super::session::Session;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;
use lineshaft_ros::layer::{Qos, Subscription};
use std::time::Duration;
use tokio::time::timeout;

/// Log of one node.
pub(super) struct NodeLog {
    lines: Subscription<Log>,
    logger: String,
}

impl NodeLog {
    pub(super) fn open(session: &Session) -> Result<Self, Failure> {
        let logger = session.target().trim_start_matches('/').replace('/', ".");
        // A reader of the latched topic would get the lines of the last 10 s as well: reasons of earlier refusals.
        let qos = Qos { latched: false, ..Qos::ROSOUT };
        Ok(Self { lines: session.shared_topic("/rosout", qos)?, logger })
    }

    /// Skips the lines so far.
    pub(super) async fn skip(&mut self) {
        while timeout(Duration::ZERO, self.next()).await.is_ok() {}
    }

    /// Returns the next line of the node.
    pub(super) async fn next(&mut self) -> String {
        loop {
            match self.lines.next().await {
                Some(line) if line.name == self.logger => return line.msg,
                Some(_) => {}
                None => std::future::pending().await,
            }
        }
    }

    /// Returns the next line that begins with `prefix`, without the prefix, if there is one within `patience`.
    pub(super) async fn sentence(&mut self, prefix: &str, patience: Duration) -> Option<String> {
        let find = async {
            loop {
                if let Some(sentence) = self.next().await.strip_prefix(prefix) {
                    return sentence.to_owned();
                }
            }
        };
        timeout(patience, find).await.ok()
    }
}
