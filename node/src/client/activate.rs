//! `lineshaft activate`: makes the lifecycle transitions of a node until it is active.
//!
//! Law      unconfigured: configure, then activate; inactive: activate. A transition in progress, such as that of
//!          `autostart`, is awaited. A transition that the node refuses, because another client has begun one, is requested again
//! Refuses  a finalized node, which has no transition

use super::node_log::NodeLog;
use super::output::{node_option, print};
use super::session::Session;
use super::{Failure, Options};
use lineshaft_msgs::foreign::lifecycle_msgs::msg::{State, Transition};
use lineshaft_msgs::foreign::lifecycle_msgs::srv::{ChangeState, ChangeStateRequest, GetState, GetStateRequest};
use lineshaft_ros::layer::{Qos, ServiceClient};
use std::time::Duration;
use tokio::time::{Instant, sleep, timeout};

/// Maximum time of all transitions. The node gives its backends 10 s to start, and its machine 10 s to accept a command.
const PATIENCE: Duration = Duration::from_secs(60);
/// Time between two queries of the state during a transition of another client.
const AGAIN: Duration = Duration::from_millis(100);
/// Maximum time until the log has the reason of a failure.
const REASON: Duration = Duration::from_millis(500);

/// A transition that this command makes: ID, label, and label of the state during it.
type Step = (u8, &'static str, &'static str);

const CONFIGURE: Step = (Transition::TRANSITION_CONFIGURE, "configure", "configuring");
const ACTIVATE: Step = (Transition::TRANSITION_ACTIVATE, "activate", "activating");

/// Configures the node if necessary, activates it, and prints its state.
///
/// # Errors
/// Returns an error if a transition fails, or if the node is finalized or does not answer.
pub(crate) async fn activate(options: &Options) -> Result<(), Failure> {
    let session = Session::open(options).await?;
    make_active(&session).await?;
    print(&format!("node {} is active", session.target()));
    Ok(())
}

/// Returns the command that activates the node of this full name.
pub(crate) fn activate_command(node: &str) -> String {
    format!("lineshaft activate{}", node_option(node))
}

/// Returns the end of a message about a node in this lifecycle state that runs no cycle; empty if it may run cycles.
pub(super) fn remedy(state: &str, node: &str) -> String {
    match state {
        "unconfigured" => format!("; `{}` starts it", activate_command(node)),
        _ => String::new(),
    }
}

async fn make_active(session: &Session) -> Result<(), Failure> {
    let node = session.target();
    let mut states = session.service::<GetState>("get_state", Qos::SERVICE)?;
    let mut transitions = session.service::<ChangeState>("change_state", Qos::SERVICE)?;
    let mut log = NodeLog::open(session)?;
    let begun = Instant::now();
    let mut refusal = None;
    loop {
        let State { id, label } = session.ask(&mut states, &GetStateRequest::default()).await?.current_state;
        match id {
            State::PRIMARY_STATE_ACTIVE => return Ok(()),
            State::PRIMARY_STATE_FINALIZED => {
                return Err(Failure::Failed(format!("node {node} is {label}; end the program and start it again")));
            }
            _ if begun.elapsed() >= PATIENCE => {
                let time = PATIENCE.as_secs();
                let unknown = || Failure::Failed(format!("node {node} is not active after {time} s; it is {label}"));
                return Err(refusal.unwrap_or_else(unknown));
            }
            State::PRIMARY_STATE_UNCONFIGURED | State::PRIMARY_STATE_INACTIVE => {
                let transition = if id == State::PRIMARY_STATE_INACTIVE { ACTIVATE } else { CONFIGURE };
                refusal = step(session, &mut transitions, &mut log, transition).await?;
                if refusal.is_some() {
                    sleep(AGAIN).await;
                }
            }
            _ => sleep(AGAIN).await,
        }
    }
}

/// Makes one transition. Returns the reason if the node has refused it, because its state has changed meanwhile.
///
/// # Errors
/// Returns an error with the reason from the log of the node if the transition has failed.
async fn step(
    session: &Session,
    transitions: &mut ServiceClient<ChangeState>,
    log: &mut NodeLog,
    (id, label, during): Step,
) -> Result<Option<Failure>, Failure> {
    log.skip().await;
    let service = transitions.name().to_string();
    session.matched(&service, || transitions.servers()).await?;
    let request = ChangeStateRequest { transition: Transition { id, label: label.to_owned() } };
    let number = transitions.send(&request).map_err(Failure::failed)?;
    let response = tokio::select! {
        reply = transitions.reply(number) => reply.map_err(Failure::failed)?,
        failure = session.gone() => return Err(failure),
        () = sleep(PATIENCE) => {
            let time = PATIENCE.as_secs();
            return Err(Failure::Failed(format!("{service}: {label} is not answered within {time} s; see the log of the node")));
        }
    };
    if response.success {
        return Ok(None);
    }
    let (failed, refused) = (format!("{during}: "), format!("change_state: transition `{label}` is refused: "));
    let find = async {
        loop {
            let line = log.next().await;
            if let Some(reason) = line.strip_prefix(&failed) {
                return (reason.to_owned(), false);
            }
            if let Some(reason) = line.strip_prefix(&refused) {
                return (reason.to_owned(), true);
            }
        }
    };
    let unknown = |_| ("the log of the node shows the reason".to_owned(), false);
    let (reason, is_refused) = timeout(REASON, find).await.unwrap_or_else(unknown);
    let failure = Failure::Failed(format!("node {}: {label} failed: {reason}", session.target()));
    if is_refused { Ok(Some(failure)) } else { Err(failure) }
}

#[cfg(test)]
mod tests {
    use super::super::test_node::TestNode;
    use super::*;
    use lineshaft_msgs::foreign::lifecycle_msgs::srv::{ChangeStateResponse, GetStateResponse};
    use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;
    use lineshaft_ros::layer::{Publisher, Request, ServiceServer};

    /// Lifecycle services of a node.
    struct Lifecycle {
        states: ServiceServer<GetState>,
        transitions: ServiceServer<ChangeState>,
        /// Present state; each transition leads to the next one: unconfigured 1, inactive 2, active 3.
        state: u8,
        /// ID of the transition that fails; 0 for none.
        fails: u8,
        /// Log of the node and the line with which it refuses the next transition.
        refusal: Option<(Publisher<Log>, Log)>,
        /// IDs of the requested transitions.
        asked: Vec<u8>,
    }

    impl Lifecycle {
        fn new(served: &TestNode, state: u8, fails: u8) -> Self {
            let states = served.node.service("~/get_state", Qos::SERVICE).unwrap();
            let transitions = served.node.service("~/change_state", Qos::SERVICE).unwrap();
            Self { states, transitions, state, fails, refusal: None, asked: Vec::new() }
        }

        async fn serve(&mut self) {
            loop {
                tokio::select! {
                    Some(Request { reply, .. }) = self.states.next() => {
                        let current_state = State { id: self.state, label: format!("state {}", self.state) };
                        reply.send_soon(GetStateResponse { current_state });
                        // A transition of another client ends.
                        if self.state == State::TRANSITION_STATE_CONFIGURING {
                            self.state = State::PRIMARY_STATE_INACTIVE;
                        }
                    }
                    Some(Request { message, reply }) = self.transitions.next() => {
                        let id = message.transition.id;
                        self.asked.push(id);
                        let success = id != self.fails && self.refusal.is_none();
                        self.state += u8::from(success);
                        reply.send_soon(ChangeStateResponse { success });
                        if let Some((log, line)) = self.refusal.take() {
                            // The first lines may be lost.
                            for _ in 0..20 {
                                log.publish(&line).unwrap();
                                sleep(Duration::from_millis(20)).await;
                            }
                        }
                    }
                    else => return,
                }
            }
        }
    }

    /// Returns the result of the command, and the IDs of the requested transitions.
    async fn run(name: &str, state: u8, fails: u8) -> (Result<(), Failure>, Vec<u8>) {
        let served = TestNode::start(name);
        let mut lifecycle = Lifecycle::new(&served, state, fails);
        let session = served.session().await;
        let end = tokio::select! {
            end = make_active(&session) => end,
            () = lifecycle.serve() => panic!("the node has ended"),
        };
        (end, lifecycle.asked)
    }

    /// Transition.msg: TRANSITION_CONFIGURE is 1, TRANSITION_ACTIVATE is 3.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn unconfigured_node_is_configured_and_activated() {
        assert_eq!(run("activate_unconfigured", 1, 0).await, (Ok(()), vec![1, 3]));
        assert_eq!(run("activate_inactive", 2, 0).await, (Ok(()), vec![3]));
        assert_eq!(run("activate_active", 3, 0).await, (Ok(()), vec![]));
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn transition_in_progress_is_awaited() {
        assert_eq!(run("activate_configuring", 10, 0).await, (Ok(()), vec![3]));
    }

    /// Another client has begun a transition after the query of the state.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn refused_transition_is_requested_again() {
        let served = TestNode::start("activate_refused");
        let mut lifecycle = Lifecycle::new(&served, 1, 0);
        let session = served.session().await;
        let log = served.node.publisher::<Log>("/rosout", Qos::ROSOUT).unwrap();
        let line = Log {
            name: session.target().trim_start_matches('/').to_owned(),
            msg: "change_state: transition `configure` is refused: the node is configuring".to_owned(),
            ..Log::default()
        };
        lifecycle.refusal = Some((log, line));
        let end = tokio::select! {
            end = make_active(&session) => end,
            () = lifecycle.serve() => panic!("the node has ended"),
        };
        assert_eq!((end, lifecycle.asked), (Ok(()), vec![1, 1, 3]));
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn failed_transition_is_reported_by_name() {
        let (end, asked) = run("activate_fails", 1, 3).await;
        assert_eq!(asked, [1, 3]);
        let sentence = end.unwrap_err().to_string();
        assert!(sentence.ends_with(": activate failed: the log of the node shows the reason"), "{sentence}");
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn finalized_node_must_be_started_again() {
        let (end, asked) = run("activate_finalized", 4, 0).await;
        assert!(asked.is_empty(), "{asked:?}");
        let sentence = end.unwrap_err().to_string();
        assert!(sentence.ends_with(" is state 4; end the program and start it again"), "{sentence}");
    }

    #[test]
    fn command_names_the_node_unless_it_is_the_default_one() {
        assert_eq!(activate_command("/lineshaft"), "lineshaft activate");
        assert_eq!(activate_command("/cell/a"), "lineshaft activate --node /cell/a");
        assert_eq!(remedy("unconfigured", "/cell/a"), "; `lineshaft activate --node /cell/a` starts it");
        assert_eq!(remedy("inactive", "/cell/a"), "", "its cycles run");
    }
}
