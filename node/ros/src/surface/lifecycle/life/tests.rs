//! Tests of transitions with machines and backends that do not behave as they should.

use super::super::states::{ACTIVE, FINALIZED, INACTIVE, UNCONFIGURED};
use super::*;
use crate::layer::{Environment, Networks, Node, NodeName};
use crate::surface::JointNames;
use crate::surface::host::{Host, ParameterSelection, Snapshot, StampedEvent, Statistics};
use crate::surface::parameters::fake;
use crate::surface::table;
use lineshaft_core::code::Code;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Event;
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::signal::Directory;
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use tokio::sync::mpsc::UnboundedSender;
use tokio::sync::oneshot;
use tokio::task::JoinSet;

/// Behaviour of the machine.
#[derive(Clone, Copy, Debug, Default)]
struct Script {
    /// Whether its backends do not start.
    no_backend: bool,
    /// Whether it refuses activation.
    refuses: bool,
    /// Number of deactivations that never end.
    stuck: u64,
    /// Whether its cycles do not end.
    runs_on: bool,
}

struct Fake {
    config: MachineConfig,
    joint_names: JointNames,
    directory: Directory,
    script: Script,
    gate: Mutex<GateState>,
    /// Number of commands so far, and number of deactivations among them.
    given: Mutex<(u64, u64)>,
    events: UnboundedSender<StampedEvent>,
}

impl Host for Fake {
    fn config(&self) -> &MachineConfig {
        &self.config
    }

    fn joint_names(&self) -> &JointNames {
        &self.joint_names
    }

    fn directory(&self) -> &Directory {
        &self.directory
    }

    fn submit(&self, action: Action) -> Result<u64, SubmitError> {
        let mut given = self.given.lock().unwrap_or_else(PoisonError::into_inner);
        given.0 += 1;
        given.1 += u64::from(action == Action::Deactivate);
        let tell = |kind, code| {
            let severity = lineshaft_core::event::Severity::Info;
            let event = Event::new(severity, kind, Object::Machine, code).of_command(given.0);
            self.events.send(StampedEvent { event, stamp_ns: 1 }).expect("the hub hears");
        };
        match action {
            Action::Activate if self.script.refuses => tell(Kind::Refused, Code::TOO_MANY_WAITING),
            Action::Deactivate => {
                tell(Kind::Accepted, Code::NONE);
                if given.1 > self.script.stuck {
                    tell(Kind::Done, Code::NONE);
                }
            }
            _ => tell(Kind::Accepted, Code::NONE),
        }
        Ok(given.0)
    }

    fn stream(&self, _: &lineshaft_core::command::Setpoints) -> Result<(), SubmitError> {
        Err(SubmitError::Unconfigured)
    }

    fn is_active_at_start(&self) -> bool {
        false
    }

    fn open(&self) {
        let failed = GateState::Failed("no bus".to_owned());
        *self.gate.lock().unwrap_or_else(PoisonError::into_inner) =
            if self.script.no_backend { failed } else { GateState::Open };
    }

    fn resume_commands(&self) {}

    fn close(&self) {
        if !self.script.runs_on {
            *self.gate.lock().unwrap_or_else(PoisonError::into_inner) = GateState::Closed;
        }
    }

    fn gate(&self) -> GateState {
        self.gate.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn statistics(&self) -> Statistics {
        Statistics::default()
    }

    fn hardware(&self, _: u16) -> Option<&str> {
        None
    }

    fn read_vocabulary(&self, _: &str, _: &str, _: &str) -> Result<Action, String> {
        Err("nobody asks".to_owned())
    }

    fn read_parameters(&self, _: &str) -> Result<Action, String> {
        Err("nobody asks".to_owned())
    }

    fn write_parameters(&self, _: AxisSet, _: ParameterSelection) -> String {
        String::new()
    }

    fn store_parameters(&self, _: oneshot::Sender<Result<(), String>>) {}

    fn record(&self, _: RecordRequest, _: oneshot::Sender<RecordResponse>) {}

    fn snapshot(&self) -> Arc<Snapshot> {
        Arc::default()
    }

    fn parameters(&self) -> Arc<ParameterImage> {
        Arc::default()
    }
}

/// The lifecycle of a simulated machine.
struct Bench {
    life: NodeLifecycle,
    host: Arc<Fake>,
    _tasks: JoinSet<()>,
    _node: Node,
}

impl Bench {
    fn new(script: Script) -> Self {
        // A domain that tests with other peers (10 to 101) do not use.
        let domain = 201 + u16::try_from(std::process::id() % 32).expect("a small number");
        let environment = Environment { domain, networks: Networks::Loopback };
        let node = Node::new(NodeName::new("/", "life").expect("a name"), &environment).expect("a node");
        let (events, heard) = tokio::sync::mpsc::unbounded_channel();
        let (gate, given) = (Mutex::new(GateState::Closed), Mutex::default());
        let host = Arc::new(Fake {
            config: fake::config(),
            joint_names: JointNames::default(),
            directory: Directory::default(),
            script,
            gate,
            given,
            events,
        });
        let mut tasks = JoinSet::new();
        let hub = Hub::start(&node, host.clone(), heard, &mut tasks).expect("a hub");
        let life = NodeLifecycle::new(
            hub,
            node.name().to_string(),
            table::TRANSITION_EVENT.publisher(&node).expect("a topic"),
        );
        Self { life, host, _tasks: tasks, _node: node }
    }

    async fn change(&self, label: &str) -> bool {
        let wanted = msg::Transition { id: 0, label: label.to_owned() };
        let begun = self.life.begin_change(&wanted).expect("it is possible");
        assert!(self.life.begin_change(&wanted).is_none(), "one at a time");
        self.life.end_change(begun).await
    }
}

#[tokio::test(start_paused = true)]
async fn a_good_machine_goes_through_all_states() {
    let bench = Bench::new(Script::default());
    for (label, state) in [
        ("configure", INACTIVE),
        ("activate", ACTIVE),
        ("deactivate", INACTIVE),
        ("cleanup", UNCONFIGURED),
        ("configure", INACTIVE),
        ("activate", ACTIVE),
        ("shutdown", FINALIZED),
    ] {
        assert!(bench.change(label).await, "{label}");
        assert_eq!(
            (bench.life.state(), bench.host.gate() == GateState::Open),
            (state, state == ACTIVE || state == INACTIVE)
        );
    }
}

#[tokio::test(start_paused = true)]
async fn a_backend_that_does_not_start_leaves_the_node_unconfigured() {
    let bench = Bench::new(Script { no_backend: true, ..Script::default() });
    assert!(!bench.change("configure").await);
    assert_eq!((bench.life.state(), bench.host.gate()), (UNCONFIGURED, GateState::Closed));
}

#[test]
fn failed_transition_says_how_to_try_again() {
    let configure = "; remove the cause, then `lineshaft activate --node /a/b`, or `ros2 lifecycle set /a/b configure` and \
                     `ros2 lifecycle set /a/b activate`";
    let activate = "; remove the cause, then `lineshaft activate --node /a/b`, or `ros2 lifecycle set /a/b activate`";
    let restart = "; remove the cause, then end the program and start it again";
    for (end, advice) in [(UNCONFIGURED, configure), (INACTIVE, activate), (FINALIZED, restart)] {
        assert_eq!(remedy(end, "/a/b").as_deref(), Some(advice));
    }
    // The processing of the error has not ended yet.
    assert_eq!(remedy(states::ERROR_PROCESSING, "/a/b"), None);
    assert_eq!(remedy(ACTIVE, "/a/b"), None);
}

#[tokio::test(start_paused = true)]
async fn a_refused_activation_leaves_it_inactive() {
    let bench = Bench::new(Script { refuses: true, ..Script::default() });
    assert!(bench.change("configure").await);
    assert!(!bench.change("activate").await);
    assert_eq!(bench.life.state(), INACTIVE);
}

#[tokio::test(start_paused = true)]
async fn a_drive_that_stays_on_is_an_error_which_ends_unconfigured_or_finalized() {
    for label in ["deactivate", "shutdown"] {
        for (stuck, state) in [(1, UNCONFIGURED), (9, FINALIZED)] {
            let bench = Bench::new(Script { stuck, ..Script::default() });
            assert!(bench.change("configure").await && bench.change("activate").await);
            assert!(!bench.change(label).await, "{label}");
            assert_eq!((bench.life.state(), bench.host.gate()), (state, GateState::Closed), "{label}, {stuck} stuck");
        }
    }
}

#[tokio::test(start_paused = true)]
async fn cycles_that_do_not_end_are_an_error() {
    let bench = Bench::new(Script { runs_on: true, ..Script::default() });
    assert!(bench.change("configure").await);
    assert!(!bench.change("cleanup").await);
    assert_eq!(bench.life.state(), FINALIZED);
}
