//! A ROS node: the one member of the DDS domain that this process is.

use std::ops::Deref;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use lineshaft_msgs::foreign::rcl_interfaces::msg::{Log, ParameterValue};
use lineshaft_msgs::{Action, Message, Service};
use tokio::runtime::Handle;
use tokio::sync::watch;

use super::action::{ActionOptions, ActionServer};
use super::arguments::{Names, Overrides};
use super::client::{ActionClient, NodeNames, ServiceClient};
use super::clock::{Clock, HostClock};
use super::endpoint::{Context, CreateError};
use super::environment::Environment;
use super::loggers::Loggers;
use super::name::NodeName;
use super::publisher::Publisher;
use super::qos_overrides::QosOverrides;
use super::rosout::Rosout;
use super::service::ServiceServer;
use super::subscription::Subscription;
use super::tap::{Tap, TappedPublisher};
use super::time_source::TimeSource;
use crate::link::protocol::WireType;
use crate::link::qos::Qos;
use crate::link::{Growth, Link, LinkError, Loss, Settings, Side};

/// What is told of a loss of the ROS side.
pub type OnLoss = Arc<dyn Fn(&Loss) + Send + Sync>;

/// The ROS side of a node.
#[derive(Clone)]
pub struct SideOptions {
    /// What it runs in.
    pub side: Side,
    /// Where it is written down which participants live, so that a good-bye can be said for those that were killed; nothing: nowhere.
    pub participants: Option<PathBuf>,
    /// Told of each loss, on a thread of its own, before another side starts.
    pub on_loss: OnLoss,
    /// Maximum time without an answer, after which it is lost.
    pub loss_timeout: Duration,
}

impl Default for SideOptions {
    fn default() -> Self {
        Self { side: Side::Thread, participants: None, on_loss: Arc::new(|_| {}), loss_timeout: Duration::from_secs(2) }
    }
}

/// What a node is given at its start.
pub struct NodeOptions {
    /// Its name, and how it calls its topics, services and actions.
    pub names: Names,
    /// Values of its parameters; those of QoS it takes itself.
    pub overrides: Overrides,
    /// Whether its log lines go to `/rosout`.
    pub rosout: bool,
    /// Levels of its loggers.
    pub loggers: Loggers,
    /// Its ROS side.
    pub side: SideOptions,
    /// How old a request may be that is carried out; default 2 s.
    pub request_timeout: Duration,
    /// The system's time for stamps; none: the system clock itself.
    pub host_clock: Option<HostClock>,
    /// Copies what it publishes, for a recorder; none: nothing is copied.
    pub tap: Option<Tap>,
}

/// Default of [`NodeOptions::request_timeout`].
const REQUEST_TIMEOUT: Duration = Duration::from_secs(2);

impl NodeOptions {
    /// A node of that name to which nothing was given.
    pub fn plain(name: NodeName) -> Self {
        let (names, overrides) = (Names::plain(name), Overrides::default());
        Self {
            names,
            overrides,
            rosout: true,
            loggers: Loggers::default(),
            side: SideOptions::default(),
            request_timeout: REQUEST_TIMEOUT,
            host_clock: None,
            tap: None,
        }
    }
}

/// A node in the ROS graph.
///
/// Dropping it takes it from the graph at once; it waits for its ROS side to end. What was made of it
/// stays harmless: servers have no next request, publishers refuse. Drop those first, where it matters.
pub struct Node {
    // Before all others: it tells them.
    _open: watch::Sender<()>,
    _link: Link,
    handle: NodeHandle,
}

/// Makes what belongs to a node, and does not keep it in the graph.
#[derive(Clone)]
pub struct NodeHandle {
    context: Context,
    given: Arc<AtStart>,
}

/// What a node was given, and what was made of it once.
struct AtStart {
    overrides: Mutex<Overrides>,
    qos: QosOverrides,
    has_rosout: bool,
    rosout: Mutex<Option<Rosout>>,
    loggers: Loggers,
}

impl Deref for Node {
    type Target = NodeHandle;
    fn deref(&self) -> &NodeHandle {
        &self.handle
    }
}

impl Node {
    /// Joins the ROS graph. Its tasks run on the present runtime.
    ///
    /// # Errors
    /// There is no ROS side.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    pub fn new(name: NodeName, environment: &Environment) -> Result<Self, LinkError> {
        Self::with(NodeOptions::plain(name), environment)
    }

    /// Likewise, with what was given to it.
    ///
    /// # Errors
    /// Likewise.
    ///
    /// # Panics
    /// Likewise.
    pub fn with(options: NodeOptions, environment: &Environment) -> Result<Self, LinkError> {
        let NodeOptions { names, mut overrides, rosout, loggers, side, request_timeout, host_clock, tap } = options;
        let runtime = Handle::current();
        let link = Link::start(Settings {
            side: side.side,
            domain: environment.domain,
            networks: environment.networks.addresses().map(<[_]>::to_vec),
            namespace: names.node().namespace().to_owned(),
            name: names.node().name().to_owned(),
            participants: side.participants,
            on_loss: side.on_loss,
            loss_timeout: side.loss_timeout,
            growth: Growth::default(),
        })?;
        let (open, closed) = watch::channel(());
        let (names, clock) = (Arc::new(names), Clock::of(host_clock));
        let context = Context {
            opener: link.opener(),
            runtime,
            names,
            clock,
            request_timeout,
            tap,
            closed,
            #[cfg(test)]
            opened: super::endpoint::Opened::default(),
        };
        let qos = QosOverrides::new(&mut overrides);
        let (overrides, made) = (Mutex::new(overrides), Mutex::default());
        let given = AtStart { overrides, qos, has_rosout: rosout, rosout: made, loggers };
        Ok(Self { _open: open, _link: link, handle: NodeHandle { context, given: Arc::new(given) } })
    }
}

impl NodeHandle {
    /// Name and namespace.
    pub fn name(&self) -> &NodeName {
        self.context.names.node()
    }

    /// The clock of its stamps.
    pub fn clock(&self) -> &Clock {
        &self.context.clock
    }

    /// The levels of its loggers.
    pub fn loggers(&self) -> &Loggers {
        &self.given.loggers
    }

    /// Publishes the topic `name`, which is expanded and remapped as [`Names`] say, with the QoS that was given for it.
    ///
    /// # Errors
    /// The name, or the QoS that was given.
    pub fn publisher<M: Message>(&self, name: &str, qos: Qos) -> Result<Publisher<M>, CreateError> {
        let topic = self.context.names.topic(name)?;
        let qos = self.given.qos.apply(&topic, "publisher", qos).map_err(CreateError::Given)?;
        let copies = self.tapped::<M>(name, qos);
        Ok(Publisher::new(&self.context, topic, qos, copies))
    }

    /// Reads the topic `name`.
    ///
    /// # Errors
    /// Likewise.
    pub fn subscription<M: Message>(&self, name: &str, qos: Qos) -> Result<Subscription<M>, CreateError> {
        let topic = self.context.names.topic(name)?;
        let qos = self.given.qos.apply(&topic, "subscription", qos).map_err(CreateError::Given)?;
        Ok(Subscription::new(&self.context, topic, qos))
    }

    /// Serves `name`, with [`Qos::SERVICE`] or [`Qos::PARAMETERS`].
    ///
    /// # Errors
    /// The name.
    pub fn service<S: Service>(&self, name: &str, qos: Qos) -> Result<ServiceServer<S>, CreateError> {
        Ok(ServiceServer::new(&self.context, self.context.names.service(name)?, qos))
    }

    /// Serves the action `name`.
    ///
    /// # Errors
    /// Likewise.
    pub fn action<A: Action>(&self, name: &str, options: ActionOptions) -> Result<ActionServer<A>, CreateError> {
        Ok(ActionServer::new(&self.context, self.context.names.action(name)?, options))
    }

    /// Calls the service `name` of another node, with [`Qos::SERVICE`] or [`Qos::PARAMETERS`].
    ///
    /// # Errors
    /// The name.
    pub fn client<S: Service>(&self, name: &str, qos: Qos) -> Result<ServiceClient<S>, CreateError> {
        Ok(ServiceClient::new(&self.context, self.context.names.service(name)?, qos))
    }

    /// Sends goals to the action `name` of another node.
    ///
    /// # Errors
    /// Likewise.
    pub fn action_client<A: Action>(&self, name: &str) -> Result<ActionClient<A>, CreateError> {
        Ok(ActionClient::new(&self.context, self.context.names.action(name)?))
    }

    /// Collects the names of the nodes in the ROS graph from now on.
    pub fn node_names(&self) -> NodeNames {
        NodeNames::new(&self.context)
    }

    /// What sets the clock by the topic `name`, once it is switched on.
    ///
    /// # Errors
    /// The name, or the QoS that was given.
    pub fn time_source(&self, name: &'static str, qos: Qos) -> Result<TimeSource, CreateError> {
        // Told now: later nobody would be there to correct it.
        let topic = self.context.names.topic(name)?;
        self.given.qos.apply(&topic, "subscription", qos).map_err(CreateError::Given)?;
        let handle = self.clone();
        let subscribe = move || handle.subscription(name, qos);
        Ok(TimeSource::new(self.context.runtime.clone(), self.clock().clone(), subscribe))
    }

    /// Publishes log lines of the node on `/rosout`; all that ask get the same publisher.
    ///
    /// # Errors
    /// Never: its name is allowed.
    pub fn rosout(&self) -> Result<Rosout, CreateError> {
        let mut made = self.given.rosout.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(rosout) = made.as_ref() {
            return Ok(rosout.clone());
        }
        let context = &self.context;
        let topic = context.names.topic("/rosout")?.topic();
        let writer = self.given.has_rosout.then(|| context.writer(&topic, WireType::message::<Log>(), Qos::ROSOUT));
        let copies = self.tapped::<Log>("/rosout", Qos::ROSOUT);
        let (clock, loggers) = (self.clock().clone(), self.loggers().clone());
        let rosout = Rosout::new(writer.map(|writer| (writer, copies)), self.name().logger(), clock, loggers);
        *made = Some(rosout.clone());
        Ok(rosout)
    }

    /// Copies a publisher for the recorder, if that wants it.
    fn tapped<M: Message>(&self, name: &str, qos: Qos) -> Option<TappedPublisher> {
        self.context.tap.as_ref()?.open(self.name(), name, (M::NAME, M::SCHEMA), qos)
    }

    /// Takes the values that were given for its parameters; a second time there are none.
    pub fn take_overrides(&self) -> Overrides {
        std::mem::take(&mut self.given.overrides.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The QoS of its topics so far, as parameters.
    pub fn qos_parameters(&self) -> Vec<(String, ParameterValue)> {
        self.given.qos.shown()
    }

    /// QoS that was given for no topic that it has so far.
    pub fn unused_qos(&self) -> Overrides {
        self.given.qos.unused()
    }

    /// All that was ever opened, and what will be.
    #[cfg(test)]
    pub(crate) fn opened(&self) -> super::endpoint::Opened {
        Arc::clone(&self.context.opened)
    }

    #[cfg(test)]
    pub(super) fn context(&self) -> &Context {
        &self.context
    }
}
