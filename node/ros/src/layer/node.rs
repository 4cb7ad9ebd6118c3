//! ROS node: the participant of this process in the ROS domain.

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
use crate::link::protocol::{EndpointKind, WireType};
use crate::link::qos::Qos;
use crate::link::{Link, LinkError, Loss, MemoryLimit, Settings, Side};

/// Callback for a loss of the ROS side.
pub type OnLoss = Arc<dyn Fn(&Loss) + Send + Sync>;

/// Options of the ROS side of a node.
#[derive(Clone)]
pub struct SideOptions {
    /// How the side is run.
    pub side: Side,
    /// Folder that records running participants, so that killed ones can be disposed; `None`: they are not recorded.
    pub participants: Option<PathBuf>,
    /// Callback for each loss, in a separate thread, before another side starts.
    pub on_loss: OnLoss,
    /// Maximum time without an answer, after which the side counts as lost.
    pub loss_timeout: Duration,
}

impl Default for SideOptions {
    fn default() -> Self {
        Self { side: Side::Thread, participants: None, on_loss: Arc::new(|_| {}), loss_timeout: Duration::from_secs(2) }
    }
}

/// Options of a node.
pub struct NodeOptions {
    /// Name of the node, and names of its topics, services and actions.
    pub names: Names,
    /// Parameter overrides; those of QoS are used by the node itself.
    pub overrides: Overrides,
    /// Whether log messages are published on `/rosout`.
    pub rosout: bool,
    /// Levels of the loggers.
    pub loggers: Loggers,
    /// Options of the ROS side.
    pub side: SideOptions,
    /// Maximum age of a request that is executed; default 2 s.
    pub request_timeout: Duration,
    /// System time for stamps; `None`: the system clock itself.
    pub host_clock: Option<HostClock>,
    /// Tap that copies published messages for a recorder; `None`: nothing is copied.
    pub tap: Option<Tap>,
}

/// Default of [`NodeOptions::request_timeout`].
const REQUEST_TIMEOUT: Duration = Duration::from_secs(2);

impl NodeOptions {
    /// Creates options with defaults for a node name.
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

/// Node in the ROS graph.
///
/// Dropping it removes it from the graph at once, and waits for its ROS side to end. Objects of the node remain safe to use: servers get no
/// further request, publishers return errors. If that matters, drop them first.
pub struct Node {
    // Declared first, so that it is dropped first and notifies the other objects.
    _open: watch::Sender<()>,
    _link: Link,
    handle: NodeHandle,
}

/// Creates objects of a node, without keeping it in the graph.
#[derive(Clone)]
pub struct NodeHandle {
    context: Context,
    given: Arc<AtStart>,
}

/// Options of the node, and objects that exist only once.
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
    /// The ROS side cannot be started.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    pub fn new(name: NodeName, environment: &Environment) -> Result<Self, LinkError> {
        Self::with(NodeOptions::plain(name), environment)
    }

    /// Joins the ROS graph with options. Its tasks run on the present runtime.
    ///
    /// # Errors
    /// The ROS side cannot be started.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
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
            growth: MemoryLimit::default(),
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
    /// Returns name and namespace.
    pub fn name(&self) -> &NodeName {
        self.context.names.node()
    }

    /// Returns the clock for stamps.
    pub fn clock(&self) -> &Clock {
        &self.context.clock
    }

    /// Returns the levels of the loggers.
    pub fn loggers(&self) -> &Loggers {
        &self.given.loggers
    }

    /// Creates a publisher of topic `name`, which is expanded and remapped by [`Names`], with the QoS override for it.
    ///
    /// # Errors
    /// The name or the QoS override is invalid.
    pub fn publisher<M: Message>(&self, name: &str, qos: Qos) -> Result<Publisher<M>, CreateError> {
        let topic = self.context.names.topic(name)?;
        let qos = self.given.qos.apply(&topic, "publisher", qos).map_err(CreateError::Given)?;
        let copies = self.tapped::<M>(name, qos);
        Ok(Publisher::new(&self.context, topic, qos, copies))
    }

    /// Creates a subscription of topic `name`.
    ///
    /// # Errors
    /// The name or the QoS override is invalid.
    pub fn subscription<M: Message>(&self, name: &str, qos: Qos) -> Result<Subscription<M>, CreateError> {
        let topic = self.context.names.topic(name)?;
        let qos = self.given.qos.apply(&topic, "subscription", qos).map_err(CreateError::Given)?;
        Ok(Subscription::new(&self.context, topic, qos))
    }

    /// Creates a server of service `name`, with [`Qos::SERVICE`] or [`Qos::PARAMETERS`].
    ///
    /// # Errors
    /// The name is invalid.
    pub fn service<S: Service>(&self, name: &str, qos: Qos) -> Result<ServiceServer<S>, CreateError> {
        Ok(ServiceServer::new(&self.context, self.context.names.service(name)?, qos))
    }

    /// Creates a server of action `name`.
    ///
    /// # Errors
    /// The name is invalid.
    pub fn action<A: Action>(&self, name: &str, options: ActionOptions) -> Result<ActionServer<A>, CreateError> {
        Ok(ActionServer::new(&self.context, self.context.names.action(name)?, options))
    }

    /// Creates a client of service `name` of another node, with [`Qos::SERVICE`] or [`Qos::PARAMETERS`].
    ///
    /// # Errors
    /// The name is invalid.
    pub fn client<S: Service>(&self, name: &str, qos: Qos) -> Result<ServiceClient<S>, CreateError> {
        Ok(ServiceClient::new(&self.context, self.context.names.service(name)?, qos))
    }

    /// Creates a client of action `name` of another node.
    ///
    /// # Errors
    /// The name is invalid.
    pub fn action_client<A: Action>(&self, name: &str) -> Result<ActionClient<A>, CreateError> {
        Ok(ActionClient::new(&self.context, self.context.names.action(name)?))
    }

    /// Collects the names of the nodes in the ROS graph from now on.
    pub fn node_names(&self) -> NodeNames {
        NodeNames::new(&self.context)
    }

    /// Creates the source of simulation time, topic `name`, which is not used before it is switched on.
    ///
    /// # Errors
    /// The name or the QoS override is invalid.
    pub fn time_source(&self, name: &'static str, qos: Qos) -> Result<TimeSource, CreateError> {
        // Checked here, because a later error could not be reported to the user.
        let topic = self.context.names.topic(name)?;
        self.given.qos.apply(&topic, "subscription", qos).map_err(CreateError::Given)?;
        let handle = self.clone();
        let subscribe = move || handle.subscription(name, qos);
        Ok(TimeSource::new(self.context.runtime.clone(), self.clock().clone(), subscribe))
    }

    /// Returns the publisher of log messages on `/rosout`; all callers share it.
    ///
    /// # Errors
    /// Cannot fail: the name is valid.
    pub fn rosout(&self) -> Result<Rosout, CreateError> {
        let mut made = self.given.rosout.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(rosout) = made.as_ref() {
            return Ok(rosout.clone());
        }
        let context = &self.context;
        let topic = context.names.topic("/rosout")?;
        let open = || context.open(EndpointKind::Publisher, &topic, WireType::message::<Log>(), Qos::ROSOUT).0;
        let writer = self.given.has_rosout.then(open);
        let copies = self.tapped::<Log>("/rosout", Qos::ROSOUT);
        let (clock, loggers) = (self.clock().clone(), self.loggers().clone());
        let rosout = Rosout::new(writer.map(|writer| (writer, copies)), self.name().logger(), clock, loggers);
        *made = Some(rosout.clone());
        Ok(rosout)
    }

    /// Returns a tap of a publisher, if the recorder selects it.
    fn tapped<M: Message>(&self, name: &str, qos: Qos) -> Option<TappedPublisher> {
        self.context.tap.as_ref()?.open(self.name(), name, (M::NAME, M::SCHEMA), qos)
    }

    /// Removes and returns the parameter overrides; a second call returns none.
    pub fn take_overrides(&self) -> Overrides {
        std::mem::take(&mut self.given.overrides.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the QoS of the topics so far, as parameters.
    pub fn qos_parameters(&self) -> Vec<(String, ParameterValue)> {
        self.given.qos.shown()
    }

    /// Returns QoS overrides that match no topic so far.
    pub fn unused_qos(&self) -> Overrides {
        self.given.qos.unused_overrides()
    }

    /// Returns all endpoints that were ever opened; further ones are added.
    #[cfg(test)]
    pub(crate) fn opened(&self) -> super::endpoint::Opened {
        Arc::clone(&self.context.opened)
    }

    #[cfg(test)]
    pub(super) fn context(&self) -> &Context {
        &self.context
    }
}
