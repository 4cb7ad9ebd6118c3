//! Connection of a command to one Lineshaft node.

use super::Failure;
use super::activate::remedy;
use super::find::{Found, domain_text, find};
use lineshaft_msgs::foreign::lifecycle_msgs::srv::{GetState, GetStateRequest};
use lineshaft_msgs::msg::AxisStates;
use lineshaft_msgs::srv::AxesCommand;
use lineshaft_msgs::{Action, Message, Service};
use lineshaft_ros::layer::{
    ActionClient, Environment, Loss, Node, NodeName, NodeOptions, OnLoss, Publisher, Qos, ServiceClient, Side,
    SideOptions, Subscription,
};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;
use tokio::time::{sleep, timeout};

/// Polling interval for matches.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(10);
/// Time after the first match within which a second node of the same name is found.
const SETTLE: Duration = Duration::from_millis(100);
/// Time after which a request that changes nothing, or a stop, is repeated.
pub(super) const ASK_AGAIN: Duration = Duration::from_secs(2);
/// Time after which a node that is not matched any more counts as ended.
const GONE: Duration = Duration::from_secs(1);

/// Name of the node, and timeout.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// Name of the node; `None`: `/lineshaft`, or for a command that only reads, the only Lineshaft node.
    pub(crate) node: Option<String>,
    /// Maximum time to find it and for a first answer.
    pub(crate) timeout: Duration,
    /// Whether the command only reads, so that a wrong node causes no damage.
    pub(crate) is_reading: bool,
    /// Whether the command only stops axes; it is sent to all nodes of the name.
    pub(crate) is_stop: bool,
}

/// Connection to one Lineshaft node.
pub(super) struct Session {
    presence: ServiceClient<AxesCommand>,
    node: Node,
    target: String,
    environment: Environment,
    timeout: Duration,
    is_stop: bool,
    /// Reason why the DDS library has ended.
    loss: watch::Receiver<Option<String>>,
}

impl Session {
    /// Joins the DDS domain and waits for the node.
    ///
    /// # Errors
    /// Returns an error if the environment is invalid, or unless exactly one node answers.
    pub(super) async fn open(options: &Options) -> Result<Self, Failure> {
        let environment = Environment::read().map_err(Failure::usage)?;
        // Tools of ROS 2 hide nodes whose name begins with an underscore.
        let name = format!("_lineshaft_client_{}", std::process::id());
        Self::open_in(environment, Side::of_this_program(), &name, options).await
    }

    /// Does the same in this environment, with this ROS side, as a node of this name.
    pub(super) async fn open_in(
        environment: Environment,
        side: Side,
        name: &str,
        options: &Options,
    ) -> Result<Self, Failure> {
        let (lost, loss) = watch::channel(None);
        let on_loss: OnLoss = Arc::new(move |why: &Loss| {
            lost.send_replace(Some(why.reason.clone()));
        });
        let side = SideOptions { side, on_loss, ..SideOptions::default() };
        let name = NodeName::new("/", name).map_err(Failure::failed)?;
        let options_of_node = NodeOptions { side, rosout: false, ..NodeOptions::plain(name) };
        let node = Node::with(options_of_node, &environment)
            .map_err(|error| Failure::Failed(format!("the DDS domain cannot be joined: {error}")))?;
        let Found { name: target, presence } = find(&node, &environment, options).await?;
        let session =
            Self { presence, node, target, environment, timeout: options.timeout, is_stop: options.is_stop, loss };
        sleep(SETTLE).await;
        session.matched(&session.target, || session.presence.servers()).await?;
        Ok(session)
    }

    /// Returns the full name of the node.
    pub(super) fn target(&self) -> &str {
        &self.target
    }

    /// Returns the maximum time for a first answer.
    pub(super) fn timeout(&self) -> Duration {
        self.timeout
    }

    fn below(&self, name: &str) -> String {
        format!("{}/{name}", self.target)
    }

    /// Creates a client of a service of the node.
    pub(super) fn service<S: Service>(&self, name: &str, qos: Qos) -> Result<ServiceClient<S>, Failure> {
        self.node.client(&self.below(name), qos).map_err(Failure::failed)
    }

    /// Creates a client of an action of the node.
    pub(super) fn action<A: Action>(&self, name: &str) -> Result<ActionClient<A>, Failure> {
        self.node.action_client(&self.below(name)).map_err(Failure::failed)
    }

    /// Creates a subscription of a topic of the node.
    pub(super) fn topic<M: Message>(&self, name: &str, qos: Qos) -> Result<Subscription<M>, Failure> {
        self.node.subscription(&self.below(name), qos).map_err(Failure::failed)
    }

    /// Creates a subscription of a topic that all nodes share, by its full name.
    pub(super) fn shared_topic<M: Message>(&self, name: &str, qos: Qos) -> Result<Subscription<M>, Failure> {
        self.node.subscription(name, qos).map_err(Failure::failed)
    }

    /// Creates a publisher of a topic that the node reads.
    pub(super) fn publisher<M: Message>(&self, name: &str, qos: Qos) -> Result<Publisher<M>, Failure> {
        self.node.publisher(&self.below(name), qos).map_err(Failure::failed)
    }

    /// Waits until exactly one server or reader is matched.
    ///
    /// # Errors
    /// Returns an error if none is matched in time, or if several are.
    pub(super) async fn matched(&self, what: &str, count: impl Fn() -> usize) -> Result<(), Failure> {
        let begun = Instant::now();
        loop {
            self.check_loss()?;
            match count() {
                1 => return Ok(()),
                // While a node hands over its ROS side there are two for some seconds. Stopping twice is harmless.
                2.. if self.is_stop => return Ok(()),
                0 if begun.elapsed() >= self.timeout => return Err(Failure::Failed(self.missing(what))),
                several if begun.elapsed() >= self.timeout => {
                    return Err(Failure::Usage(several_nodes(several, &self.target)));
                }
                _ => sleep(POLL_INTERVAL).await,
            }
        }
    }

    fn missing(&self, what: &str) -> String {
        format!(
            "{what} is not found within {} s ({}); nothing was sent; the node may be starting or of another version",
            self.timeout.as_secs_f64(),
            domain_text(&self.environment)
        )
    }

    /// Calls a service that changes nothing; the request is repeated if there is no answer, because the first one to a
    /// new client may be lost.
    ///
    /// # Errors
    /// Returns an error if there is no answer in time, or if the node has ended.
    pub(super) async fn ask<S: Service>(
        &self,
        client: &mut ServiceClient<S>,
        request: &S::Request,
    ) -> Result<S::Response, Failure> {
        let begun = Instant::now();
        loop {
            let left = self.timeout.saturating_sub(begun.elapsed());
            let reply = self.reply_within(client, request, left.min(ASK_AGAIN)).await;
            let is_late = begun.elapsed() >= self.timeout;
            match reply {
                Ok(Some(response)) => return Ok(response),
                Ok(None) if is_late => {
                    let (name, time) = (client.name(), self.timeout.as_secs_f64());
                    return Err(Failure::Failed(format!(
                        "{name}: no answer within {time} s; the node was found, but does not answer"
                    )));
                }
                Err(failure) if is_late => return Err(failure),
                Err(_) => {
                    self.check_loss()?;
                    sleep(POLL_INTERVAL).await;
                }
                Ok(None) => {}
            }
        }
    }

    /// Sends a request and waits for its reply; returns `None` if there is none within `patience`.
    ///
    /// # Errors
    /// Returns an error if there is no server, or if the node has ended.
    async fn reply_within<S: Service>(
        &self,
        client: &mut ServiceClient<S>,
        request: &S::Request,
        patience: Duration,
    ) -> Result<Option<S::Response>, Failure> {
        let name = client.name().to_string();
        self.matched(&name, || client.servers()).await?;
        let number = client.send(request).map_err(Failure::failed)?;
        tokio::select! {
            reply = client.reply(number) => reply.map(Some).map_err(Failure::failed),
            failure = self.gone() => Err(failure),
            () = sleep(patience) => Ok(None),
        }
    }

    /// Waits until the node or the DDS library has ended, and returns the reason.
    pub(super) async fn gone(&self) -> Failure {
        let mut absent: Option<Instant> = None;
        loop {
            if let Err(failure) = self.check_loss() {
                return failure;
            }
            if self.presence.servers() > 0 {
                absent = None;
            } else if absent.get_or_insert_with(Instant::now).elapsed() >= GONE {
                return Failure::Failed(format!(
                    "node {} has ended or is not reached any more, so it is not known what its axes do",
                    self.target
                ));
            }
            sleep(POLL_INTERVAL).await;
        }
    }

    fn check_loss(&self) -> Result<(), Failure> {
        let loss = self.loss.borrow().clone();
        loss.map_or(Ok(()), |reason| Err(Failure::Failed(format!("the DDS library of this command {reason}"))))
    }

    /// Returns the first message of `~/axis_states`.
    ///
    /// # Errors
    /// Returns an error with the lifecycle state of the node if there is no message in time.
    pub(super) async fn first_states(&self, states: &mut Subscription<AxisStates>) -> Result<AxisStates, Failure> {
        tokio::select! {
            message = timeout(self.timeout, states.next()) => match message {
                Ok(Some(message)) => Ok(message),
                Ok(None) => Err(own_end()),
                Err(_) => Err(self.no_states().await),
            },
            failure = self.gone() => Err(failure),
        }
    }

    /// Returns the reason why there is no message of `~/axis_states`.
    pub(super) async fn no_states(&self) -> Failure {
        let label = match self.life_cycle().await {
            Ok(label) => label,
            Err(failure) => return failure,
        };
        Failure::Failed(format!(
            "no message of {} within {} s; the node is {label}, and publishes them only where its machine runs and \
             axis_states_rate of the cell is not 0{}",
            self.below("axis_states"),
            self.timeout.as_secs_f64(),
            remedy(&label, &self.target)
        ))
    }

    async fn life_cycle(&self) -> Result<String, Failure> {
        let mut client = self.service::<GetState>("get_state", Qos::SERVICE)?;
        let response = self.ask(&mut client, &GetStateRequest::default()).await?;
        Ok(response.current_state.label)
    }
}

/// Returns the message that several nodes have the name of the command's node.
fn several_nodes(count: usize, name: &str) -> String {
    format!(
        "{count} nodes are called {name}; nothing was sent; give each another name \
         (`lineshaft run CELL --ros-args -r __node:=NAME`)"
    )
}

/// Returns the error for the end of the command's own node.
pub(super) fn own_end() -> Failure {
    Failure::Failed("the node of this command has ended".to_owned())
}

/// Creates a subscription of the states of all axes.
pub(super) fn axis_states(session: &Session) -> Result<Subscription<AxisStates>, Failure> {
    session.topic("axis_states", Qos::STREAM)
}

#[cfg(test)]
mod tests {
    use super::super::test_node::{TIMEOUT, TestNode};
    use super::*;

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn end_of_the_dds_library_ends_a_query_at_once() {
        let served = TestNode::start("library_end");
        let mut session = served.session().await;
        let mut client = session.service::<GetState>("get_state", Qos::SERVICE).unwrap();
        (_, session.loss) = watch::channel(Some("has ended".to_owned()));
        let begun = Instant::now();
        let end = session.ask(&mut client, &GetStateRequest::default()).await;
        assert_eq!(end, Err(Failure::Failed("the DDS library of this command has ended".to_owned())));
        assert!(begun.elapsed() < TIMEOUT, "{:?}", begun.elapsed());
    }

    #[test]
    fn hint_for_several_nodes_of_one_name_is_a_command_that_is_accepted() {
        let sentence = several_nodes(2, "/lineshaft");
        let begin = "2 nodes are called /lineshaft; nothing was sent; give each another name (`";
        let hint = sentence.strip_prefix(begin).and_then(|rest| rest.strip_suffix("`)")).expect("a command");
        assert_eq!(crate::cli::parses(hint.split(' ').map(str::to_owned)), Ok(()), "{hint}");
    }
}
