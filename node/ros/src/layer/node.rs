//! A ROS node: the one member of the DDS domain that this process is.

use std::future::poll_fn;
use std::sync::{Arc, Weak};
use std::task::Poll;

use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;
use lineshaft_msgs::{Action, Message, Service};
use tokio::runtime::Handle;
use tokio::sync::watch;

use super::action::{ActionOptions, ActionServer};
use super::dds::{DdsError, Participant};
use super::endpoint::{Context, CreateError};
use super::environment::Environment;
use super::graph::Graph;
use super::matches::Matches;
use super::name::NodeName;
use super::publisher::Publisher;
use super::qos::Qos;
use super::rosout::Rosout;
use super::service::ServiceServer;

/// A node in the ROS graph.
///
/// Dropping it takes it from the graph at once; it waits for the threads of the DDS library to end. What was made of it
/// stays harmless: servers have no next request, publishers refuse. Drop those first, where it matters.
pub struct Node {
    // Before all others: it tells them.
    _open: watch::Sender<()>,
    _participant: Arc<Participant>,
    context: Context,
    name: NodeName,
}

impl Node {
    /// Joins the ROS graph. Its tasks run on the present runtime.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    pub fn new(name: NodeName, environment: &Environment) -> Result<Self, DdsError> {
        let runtime = Handle::current();
        let participant = Arc::new(Participant::new(environment.domain, environment.networks.addresses())?);
        let matches = Arc::new(Matches::new());
        runtime.spawn(follow(Arc::downgrade(&participant), matches.clone()));
        let graph = Arc::new(Graph::new(&runtime, &participant, &name)?);
        let (open, closed) = watch::channel(());
        let context = Context { participant: Arc::downgrade(&participant), graph, matches, runtime, closed };
        Ok(Self { _open: open, _participant: participant, context, name })
    }

    /// Name and namespace.
    pub fn name(&self) -> &NodeName {
        &self.name
    }

    /// Publishes the topic `name`, which is expanded as [`NodeName::expand`] says.
    pub fn publisher<M: Message>(&self, name: &str, qos: Qos) -> Result<Publisher<M>, CreateError> {
        Publisher::new(&self.context, self.name.expand(name)?, qos)
    }

    /// Serves `name`, with [`Qos::SERVICE`] or [`Qos::PARAMETERS`].
    pub fn service<S: Service>(&self, name: &str, qos: Qos) -> Result<ServiceServer<S>, CreateError> {
        ServiceServer::new(&self.context, self.name.expand(name)?, qos)
    }

    /// Serves the action `name`.
    pub fn action<A: Action>(&self, name: &str, options: ActionOptions) -> Result<ActionServer<A>, CreateError> {
        ActionServer::new(&self.context, self.name.expand(name)?, options)
    }

    /// Publishes log lines of the node on `/rosout`.
    pub fn rosout(&self) -> Result<Rosout, CreateError> {
        let topic = self.name.expand("/rosout")?.topic();
        let writer = self.context.writer(&topic, Log::DDS_NAME, Qos::ROSOUT)?;
        Ok(Rosout::start(&self.context.runtime, writer, self.name.logger()))
    }

    #[cfg(test)]
    pub(super) fn context(&self) -> &Context {
        &self.context
    }
}

/// Notes all matches for as long as the participant lives.
async fn follow(participant: Weak<Participant>, matches: Arc<Matches>) {
    // Only for the moment of each poll does it hold the participant: that goes with its node.
    let next = || {
        poll_fn(|context| match participant.upgrade() {
            Some(participant) => participant.poll_discovery(context),
            None => Poll::Ready(None),
        })
    };
    while let Some(change) = next().await {
        matches.note(change);
    }
}
