//! A node in this process, for tests of commands.

use super::session::{Options, Session};
use lineshaft_msgs::srv::AxesCommand;
use lineshaft_ros::layer::{Environment, Networks, Node, NodeName, Qos, ServiceServer, Side};
use std::time::Duration;

/// Much longer than any operation in the tests.
pub(super) const LONG: Duration = Duration::from_secs(30);
/// Maximum time for a first answer.
pub(super) const TIMEOUT: Duration = Duration::from_secs(5);

/// A node that commands can find, because it has the service `~/halt`.
pub(super) struct TestNode {
    pub(super) node: Node,
    environment: Environment,
    name: String,
    _halt: ServiceServer<AxesCommand>,
}

impl TestNode {
    pub(super) fn start(name: &str) -> Self {
        // Tests with other programs use domains 10 to 101; parallel runs of these tests rarely have the same one.
        let domain = 201 + u16::try_from(std::process::id() % 32).unwrap();
        let environment = Environment { domain, networks: Networks::Loopback };
        let name = format!("{name}_{}", std::process::id());
        let node = Node::new(NodeName::new("/", &name).unwrap(), &environment).unwrap();
        let halt = node.service::<AxesCommand>("~/halt", Qos::SERVICE).unwrap();
        Self { node, environment, name, _halt: halt }
    }

    /// Connects a command to it.
    pub(super) async fn session(&self) -> Session {
        self.connect(false).await
    }

    /// Connects a command that only stops axes, also if several nodes have the name.
    pub(super) async fn session_to_stop(&self) -> Session {
        self.connect(true).await
    }

    async fn connect(&self, is_stop: bool) -> Session {
        let options = Options { node: Some(self.name.clone()), timeout: TIMEOUT, is_reading: false, is_stop };
        let name = format!("_client_of_{}", self.name);
        Session::open_in(self.environment.clone(), Side::Thread, &name, &options).await.unwrap()
    }
}
