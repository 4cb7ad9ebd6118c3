//! `~/functions`: all function slots, ten times per second and on change.

use crate::layer::{CreateError, Node, Publisher};
use crate::surface::hub::Hub;
use crate::surface::messages::header;
use crate::surface::table;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::function::LINES;
use lineshaft_core::signal::{Board, Directory, Signal};
use lineshaft_msgs::msg::{FunctionState, FunctionStates};
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::MissedTickBehavior;

/// Time between two checks, and the minimum time between two messages.
const CHECK_PERIOD: Duration = Duration::from_millis(20);
/// Number of checks after which a message is published without a change.
const MAX_CHECKS: u32 = 5;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    if hub.host.config().slots.is_empty() {
        return Ok(());
    }
    let publisher = table::FUNCTIONS.publisher(node)?;
    tasks.spawn(publish(publisher, Arc::clone(hub)));
    Ok(())
}

async fn publish(publisher: Publisher<FunctionStates>, hub: Arc<Hub>) {
    let views = View::all(hub.host.config(), hub.host.directory());
    let mut ticks = tokio::time::interval(CHECK_PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (mut rhythm, mut failed) = (PublishTimer::default(), 0_u64);
    loop {
        ticks.tick().await;
        let snapshot = hub.host.snapshot();
        let functions: Vec<_> = views.iter().map(|view| view.state(&snapshot.board)).collect();
        if !rhythm.is_due(snapshot.stamp_ns, &functions) {
            continue;
        }
        let header = header(hub.clock.stamp(snapshot.stamp_ns));
        if let Err(error) = publisher.publish(&FunctionStates { header, cycle: snapshot.cycle, functions }) {
            failed += 1;
            if failed.is_power_of_two() {
                tracing::warn!("{error} ({failed} so far)");
            }
        }
    }
}

/// Decides when a message is published.
#[derive(Default)]
struct PublishTimer {
    /// Cycle time stamp t_k of the last check, in ns.
    seen: u64,
    /// Number of checks since the last message.
    looks: u32,
    said: Vec<FunctionState>,
}

impl PublishTimer {
    /// Returns true if a message is due for this cycle. While the machine is not running, no message is published.
    fn is_due(&mut self, stamp_ns: u64, functions: &[FunctionState]) -> bool {
        if std::mem::replace(&mut self.seen, stamp_ns) == stamp_ns {
            return false;
        }
        self.looks += 1;
        let is_due =
            self.looks >= MAX_CHECKS || !functions.iter().map(change_values).eq(self.said.iter().map(change_values));
        if is_due {
            (self.looks, self.said) = (0, functions.to_vec());
        }
        is_due
    }
}

/// Returns the values whose change triggers a message: a moving sink would change in each cycle.
fn change_values(state: &FunctionState) -> (bool, u32, u8, u8) {
    (state.active, state.error_code, state.inputs, state.outputs)
}

/// Signals of a function on the board.
#[derive(Clone)]
pub(in crate::surface) struct View {
    name: String,
    kind: &'static str,
    slot: u16,
    sink: Signal,
    active: Signal,
    error: Signal,
    inputs: [Signal; LINES],
    outputs: [Signal; LINES],
    sak_share: Option<Signal>,
}

impl View {
    /// Returns the views of all functions, in the order of their slots.
    pub(super) fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self> {
        let view = |slot: &lineshaft_core::config::SlotConfig| {
            let find = |signal: &str| directory.find(&format!("{}.{signal}", slot.name));
            let lines = |kind: &str| -> Option<[Signal; LINES]> {
                let found: Option<Vec<_>> = (1..=LINES).map(|line| find(&format!("{kind}{line}"))).collect();
                found?.try_into().ok()
            };
            Some(Self {
                name: slot.name.clone(),
                kind: slot.kind.name(),
                slot: slot.number,
                sink: find("sink")?,
                active: find("active")?,
                error: find("error")?,
                inputs: lines("in")?,
                outputs: lines("out")?,
                sak_share: find("sak_share"),
            })
        };
        config.slots.iter().filter_map(view).collect()
    }

    /// Returns the value of the sink.
    pub(super) fn sink(&self, board: &Board) -> i64 {
        board.int(self.sink)
    }

    pub(super) fn state(&self, board: &Board) -> FunctionState {
        let bits = |lines: &[Signal; LINES]| {
            lines.iter().zip(0..).fold(0, |bits, (line, nth)| bits | u8::from(board.bit(*line)) << nth)
        };
        FunctionState {
            name: self.name.clone(),
            r#type: self.kind.to_owned(),
            slot: self.slot,
            active: board.bit(self.active),
            // Codes are created as u32.
            error_code: board.int(self.error) as u32,
            sink: board.int(self.sink),
            inputs: bits(&self.inputs),
            outputs: bits(&self.outputs),
            sak_share: self.sak_share.map_or(0, |signal| board.int(signal)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::code::Code;
    use lineshaft_core::command::{Action, Command, CommandFunction, Commands, Source};
    use lineshaft_core::config::{Line, MemoryConfig, MemoryKind, SinkConfig, SlotConfig};
    use lineshaft_core::function::{Kind, Order};
    use lineshaft_core::machine::Machine;
    use lineshaft_core::object::Object;

    /// Function `choose` writes 7 or -7, selected by a bit.
    fn config() -> MachineConfig {
        let memory = |name: &str, kind| MemoryConfig { name: name.to_owned(), kind, initial: 0.0 };
        let mut slot = SlotConfig::new("choose".to_owned(), 9, Kind::Ecopy);
        slot.sink = SinkConfig::Memory(0);
        slot.inputs[0] = Some(Line { object: Object::Memory(1), inverted: true });
        slot.values = [3, -7, 7].into();
        MachineConfig {
            cycle_ns: 1_000_000,
            memory: vec![memory("feed", MemoryKind::I16), memory("up", MemoryKind::Bit)],
            slots: vec![slot],
            ..MachineConfig::default()
        }
    }

    #[test]
    fn a_state_shows_what_the_slot_published() {
        let config = config();
        let mut machine = Machine::new(config.clone()).expect("a sound machine");
        let [view] = View::all(&config, machine.directory()).try_into().unwrap_or_else(|_| panic!("one function"));
        let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
        let mut give = |machine: &mut Machine, order| {
            let action = Action::CommandFunction(CommandFunction { slot: 0, order, values: [].into() });
            let commands = [Command { sequence: 1, source: Source::Ros, action }];
            machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
            view.state(machine.board())
        };
        let state = give(&mut machine, Order::Start);
        let expected = FunctionState {
            name: "choose".to_owned(),
            r#type: "ecopy".to_owned(),
            slot: 9,
            active: true,
            sink: 7,
            inputs: 1,
            outputs: 1,
            ..FunctionState::default()
        };
        assert_eq!(state, expected);
        // A running function cannot be started.
        let refused = give(&mut machine, Order::Start);
        assert_eq!(refused, FunctionState { error_code: Code::FUNCTION_ACTIVE.0, ..expected });
    }

    #[test]
    fn a_message_goes_out_with_each_change_and_each_fifth_look_while_cycles_run() {
        let at_rest = vec![FunctionState::default()];
        let moved = |sink| vec![FunctionState { sink, ..FunctionState::default() }];
        let started = vec![FunctionState { active: true, ..FunctionState::default() }];
        let mut rhythm = PublishTimer::default();
        assert!(rhythm.is_due(1, &at_rest), "the first one");
        assert_eq!(
            [2, 3, 4, 5, 6, 7].map(|stamp| rhythm.is_due(stamp, &moved(5))),
            [false, false, false, false, true, false]
        );
        assert!(rhythm.is_due(8, &started) && rhythm.is_due(9, &at_rest));
        assert!((0..20).all(|_| !rhythm.is_due(9, &started)), "the machine stands");
    }
}
