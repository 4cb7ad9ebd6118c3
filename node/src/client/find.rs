//! Finds the Lineshaft node of a command.
//!
//! Law      a node is a Lineshaft node if its service `~/halt` has the type AxesCommand. The given name is used; the
//!          default is `/lineshaft`. If that is missing after 2 s, a command that only reads uses the only other
//!          Lineshaft node
//! Refuses  to choose one of several nodes, and to choose for a command that acts: discovery may be slow, and another
//!          machine would move

use super::Failure;
use super::output::DEFAULT;
use super::session::{Options, POLL_INTERVAL};
use lineshaft_msgs::srv::AxesCommand;
use lineshaft_ros::layer::{Environment, Networks, Node, NodeNames, Qos, ServiceClient};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tokio::time::sleep;

/// Time after which all nodes are discovered.
const COMPLETE: Duration = Duration::from_secs(2);
/// Time from which the names of nodes are read. A reader that is created before its participant has discovered the
/// writers misses their first samples, and may wait for them for seconds.
const NAMES: Duration = Duration::from_millis(700);
/// Maximum number of other nodes that are checked.
const MOST: usize = 100;

/// The node that was found.
pub(super) struct Found {
    /// Full name.
    pub(super) name: String,
    /// Client of its service `~/halt`, which shows whether the node is present.
    pub(super) presence: ServiceClient<AxesCommand>,
}

/// Waits for the node.
///
/// # Errors
/// Returns an error if its name is not allowed, if it is not found in time, or if there are several candidates.
pub(super) async fn find(node: &Node, environment: &Environment, options: &Options) -> Result<Found, Failure> {
    let wanted = rooted(options.node.as_deref().unwrap_or(DEFAULT));
    let presence = halt_of(node, &wanted)?;
    let mut others = Others { names: None, asked: BTreeMap::new() };
    let begun = Instant::now();
    loop {
        if presence.servers() > 0 {
            return Ok(Found { name: wanted, presence });
        }
        if begun.elapsed() >= NAMES {
            others.ask(node, &wanted);
        }
        let found = others.found();
        if options.is_reading && options.node.is_none() && begun.elapsed() >= COMPLETE {
            match found.as_slice() {
                [] => {}
                [only] => {
                    if let Some(presence) = others.asked.remove(only) {
                        return Ok(Found { name: only.clone(), presence });
                    }
                }
                several => {
                    let all = several.join(", ");
                    return Err(Failure::Usage(format!("several Lineshaft nodes: {all}; choose one by --node")));
                }
            }
        }
        if begun.elapsed() >= options.timeout {
            return Err(Failure::Failed(no_answer(&wanted, environment, options.timeout, &found)));
        }
        sleep(POLL_INTERVAL).await;
    }
}

/// Nodes with other names.
struct Others {
    names: Option<NodeNames>,
    asked: BTreeMap<String, ServiceClient<AxesCommand>>,
}

impl Others {
    /// Checks the service `~/halt` of new nodes.
    fn ask(&mut self, node: &Node, wanted: &str) {
        for name in self.names.get_or_insert_with(|| node.node_names()).so_far() {
            let is_new = name != wanted && !is_hidden(&name) && !self.asked.contains_key(&name);
            if is_new && self.asked.len() < MOST {
                // A node whose name ROS does not allow is no Lineshaft node.
                if let Ok(client) = halt_of(node, &name) {
                    self.asked.insert(name, client);
                }
            }
        }
    }

    /// Returns the names of those that are Lineshaft nodes.
    fn found(&self) -> Vec<String> {
        self.asked.iter().filter(|(_, client)| client.servers() > 0).map(|(name, _)| name.clone()).collect()
    }
}

fn halt_of(node: &Node, name: &str) -> Result<ServiceClient<AxesCommand>, Failure> {
    node.client(&format!("{name}/halt"), Qos::SERVICE)
        .map_err(|error| Failure::Usage(format!("--node {name}: {error}")))
}

/// Returns the name with a leading slash.
fn rooted(name: &str) -> String {
    if name.starts_with('/') { name.to_owned() } else { format!("/{name}") }
}

/// Whether tools of ROS 2 hide a node of this name; commands of this program are such nodes.
fn is_hidden(name: &str) -> bool {
    name.rsplit('/').next().is_some_and(|word| word.starts_with('_'))
}

/// Returns domain and discovery range as text.
pub(super) fn domain_text(environment: &Environment) -> String {
    let networks = match &environment.networks {
        Networks::Loopback => "LOCALHOST: only this host",
        Networks::All | Networks::Only(_) => "SUBNET: all networks of this host",
    };
    format!("ROS_DOMAIN_ID {}, discovery range {networks}", environment.domain)
}

fn no_answer(name: &str, environment: &Environment, timeout: Duration, others: &[String]) -> String {
    let others = match others {
        [] => String::new(),
        others => format!("; other Lineshaft nodes are {}: choose one by --node", others.join(", ")),
    };
    format!(
        "no answer from node {name} within {} s ({}){others}; check that `lineshaft run` runs with the same domain and range, \
         that --node is its name, and that no firewall blocks UDP",
        timeout.as_secs_f64(),
        domain_text(environment)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_answer_names_node_domain_range_and_what_to_try() {
        let environment = Environment { domain: 65, networks: Networks::Loopback };
        let time = Duration::from_millis(1500);
        let sentence = no_answer("/lineshaft", &environment, time, &[]);
        let begin = "no answer from node /lineshaft within 1.5 s (ROS_DOMAIN_ID 65, discovery range LOCALHOST: \
                     only this host); check that `lineshaft run` runs";
        assert!(sentence.starts_with(begin), "{sentence}");
        let sentence = no_answer("/lineshaft", &environment, time, &["/cell/a".to_owned(), "/cell/b".to_owned()]);
        assert!(
            sentence.contains("; other Lineshaft nodes are /cell/a, /cell/b: choose one by --node; "),
            "{sentence}"
        );
    }

    #[test]
    fn name_may_leave_out_its_first_slash() {
        assert_eq!((rooted("cell/a"), rooted("/cell/a")), ("/cell/a".to_owned(), "/cell/a".to_owned()));
        assert!(is_hidden("/_lineshaft_client_7") && is_hidden("/cell/_hidden") && !is_hidden("/_cell/shown"));
    }
}
