//! One axis: from the inputs of its drive to the outputs of its drive, once per cycle.
//!
//! Law      read the drive (all axes first) | supervise | advance the generator to t_k | use the latch of a search |
//!          check following error and encoder | execute the commands of this cycle | step the vocabularies | check
//!          arrival | command the drive
//! Reads    the inputs of the drive, the leaders that are earlier in the order, the commands for the axis
//! Writes   its signals, the outputs of its drive, events
//! Refuses  each command with a code and the numbers of its message; a refused command changes nothing
//! Source   PLCopen state diagram, CiA 402 states, MACS-ERR-02, contract sections 1 and 7

mod alarm;
mod analog;
mod brake;
mod buffer;
mod calm;
mod cam;
mod cam_marks;
mod compensation;
mod conditioning;
mod coupling;
mod course;
mod current;
mod direction;
mod effort;
mod engage;
mod feedback;
mod function;
mod gear_in;
mod generator;
mod goal;
mod homing;
mod in_force;
mod judge;
mod leave;
mod limit_switch;
mod limits;
mod marker;
mod master;
mod motion;
mod open_loop;
mod out_an;
mod overlay;
mod pair;
mod phase;
mod position_loop;
mod power;
mod probe;
mod publish;
mod reaction;
mod rhythm;
mod run;
mod runaway;
mod safety;
mod shown;
mod skew;
mod smooth;
mod source;
mod spread;
mod stops;
mod state;
mod stream;
mod stream_limit;
mod switches;
mod touch_probe;
mod track;
mod track_check;
mod track_query;
mod velocity_encoder;
mod vocabulary;
mod waiting;

pub use alarm::ErrorSnapshot;
pub use analog::may_be_analog;
pub use brake::{BrakeConfig, Edges};
pub use cam::no_cam;
pub use direction::{may_output_sign, may_turn_loop};
pub use feedback::Claim;
pub use function::MovedBy;
pub(crate) use homing::USES as COORDINATE_USES;
pub(crate) use homing::methods as homing_methods;
pub use in_force::InForce;
pub use master::may_name;
pub use position_loop::may_close_loop;
pub use reaction::stops_all;
pub use rhythm::Pace;
pub use run::{Excess, LagEstimate, LargestLag, Run, place as trajectory_place};
pub use safety::Safety;
pub(crate) use smooth::{Fallback, fallback};
pub use source::{Source, Wired, may_carry, may_read};
pub(crate) use stream::STREAM;
pub use switches::Switches;
pub(crate) use switches::assigned_input;
pub(crate) use touch_probe::{INDEX, MOST_RECORDS};
pub use track::Violation;
pub use velocity_encoder::may_find_velocity;
pub use waiting::MAX_WAITING;

use crate::code::Code;
use crate::command::{Action, Command, Level, Setpoints};
use crate::drive::{
    AnalogWiring, Capabilities, DriveInput, DriveOutput, EncoderInput, Inputs, Interface, SpeedOutputs,
};
use crate::encoder::{Encoder, Lead};
use crate::event::{Event, EventQueue};
use crate::gantry::Gantry;
use crate::modulo::Modulo;
use crate::object::Object;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::Motion;
use crate::regulator::Law;
use crate::signal::Signal;
use crate::state::{AxisState, HomingPhase, Reference};
use crate::sync::Leads;
use crate::table::Table;
use crate::vocabulary::{LatchView, Setting, Vocabularies, Wiring};
use brake::BrakeState;
use feedback::Sensor;
use generator::Generator;
use homing::Homing;
use judge::Supervision;
pub use power::ENABLE_TIMEOUT_NS;
use power::Power;
use serde::{Deserialize, Serialize};
pub use shown::MISSED_CYCLES;
use state::active_motion::ActiveMotion;
use state::alarm_state::AlarmState;
use state::command_state::CommandState;
use state::coupling_state::CouplingState;
use state::cycle_state::CycleState;
use state::drive_data::DriveData;
use state::loops::Loops;
use state::observed::Observed;
use state::pending::Pending;
use state::position_feedback::PositionFeedback;
use state::sources::Sources;
use state::status::Status;
use state::task::Task;
use state::travel::Travel;
use std::sync::Arc;

/// Longest delay of a drive in cycles.
pub const MAX_DELAY: u32 = 32;

/// Fixed properties of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisSetup {
    /// Index among the axes.
    pub index: u16,
    /// Index among the drives, and capabilities of the drive; none for a virtual axis.
    pub drive: Option<(usize, Capabilities)>,
    /// Index among the gantries, if it has two drives.
    pub gantry: Option<u16>,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Command interface of its drive.
    pub interface: Interface,
    /// Law of its position loop, if it is closed here.
    pub law: Law,
    /// Tolerated cycles without new data from its drive.
    pub missed_cycles: u32,
    /// Time within which its drive must switch on (ns).
    pub enable_timeout_ns: u64,
    /// Increments per axis unit.
    pub unit: f64,
    /// Wiring of its vocabularies.
    pub vocabularies: Wiring,
    /// Outputs of an open-loop axis.
    pub open_loop: SpeedOutputs,
    /// Wiring of its drive, if that is not on a bus.
    pub analog: Option<AnalogWiring>,
    /// Contacts of the cell that must be closed.
    pub safety: Safety,
    /// Index among the axes with a drive, and their number.
    pub round: (u32, u32),
    /// Source of its position.
    pub wired: Wired,
    /// Number of encoders of the machine.
    pub encoders: usize,
    /// Brake that the axis itself closes and opens.
    pub brake: Option<BrakeConfig>,
    /// Index of its pitch error among the tables.
    pub pitch_error: Option<u16>,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
}

impl AxisSetup {
    /// Returns the properties that its vocabularies need.
    pub fn setting(&self) -> Setting {
        let is_virtual = self.drive.is_none();
        let Self { modulo, unit, cycle_ns, vocabularies: wiring, .. } = *self;
        Setting { modulo, unit, cycle_ns, wiring, is_virtual }
    }
}

/// Data of a cycle for an axis.
pub struct Context<'a> {
    /// Cycle k.
    pub cycle: u64,
    /// Inputs of its drive.
    pub input: Option<&'a DriveInput>,
    /// All inputs of the cycle.
    pub inputs: &'a Inputs,
    /// Indices of the digital inputs in section `io`.
    pub digital_inputs: &'a [u16],
    /// The leaders, as far as they have been updated in this cycle.
    pub leads: &'a Leads,
    /// The tables of the machine.
    pub tables: &'a [Arc<Table>],
    /// The encoders in this cycle.
    pub encoders: &'a [Encoder],
    /// The latches of this cycle.
    pub latches: &'a [LatchView],
    /// New streamed setpoints.
    pub stream: Option<&'a Setpoints>,
    /// The active trajectories.
    pub runs: &'a [Option<Run>],
    /// The state of its two drives, if it has two.
    pub gantry: Option<&'a mut Gantry>,
    /// Queue of events.
    pub events: &'a mut EventQueue,
}

/// One axis. Parts that every cycle accesses come first in memory, up to `supervision` and the derived parameters. A
/// cycle accesses only some of the other parts, or none. The order of the fields in all parts is the format of stored
/// states.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub struct Axis {
    cycle: CycleState,
    status: Status,
    command: CommandState,
    feedback: PositionFeedback,
    drive_data: DriveData,
    travel: Travel,
    supervision: Supervision,
    /// Active parameters: they act from the next command on, or at once if the row requires that.
    pub parameters: InForce,
    setup: AxisSetup,
    sources: Sources,
    /// State of its own brake, and requests of inputs of the machine.
    brake: BrakeState,
    motion: ActiveMotion,
    homing: Homing,
    task: Task,
    observed: Observed,
    alarm: AlarmState,
    vocabularies: Vocabularies,
    coupling: CouplingState,
    pending: Pending,
    loops: Loops,
}

/// Bytes of an axis that each cycle accesses: its present motion, its supervision and its limits.
pub const HOT_BYTES: usize =
    std::mem::offset_of!(Axis, supervision) + Supervision::HOT_BYTES + size_of::<in_force::Derived>();
const _: () = assert!(HOT_BYTES <= 1024, "a cycle of an axis touches more than 1 KiB");

impl Axis {
    /// Returns an axis at rest, switched off; a virtual axis is always on.
    pub fn new(setup: AxisSetup, parameters: AxisParameters, signals: Signal) -> Self {
        let is_virtual = setup.drive.is_none();
        let delay = setup.drive.map_or(0, |(_, offers)| offers.delay.min(MAX_DELAY));
        let sensor = Sensor::new(setup.wired, setup.encoders, &parameters);
        Self {
            cycle: CycleState::new(signals),
            status: Status::new(is_virtual),
            command: CommandState::default(),
            feedback: PositionFeedback::new(sensor.reader(), is_virtual),
            drive_data: DriveData::new(is_virtual),
            travel: Travel::default(),
            supervision: Supervision::new(delay),
            parameters: parameters.into(),
            setup,
            sources: Sources::new(sensor),
            brake: BrakeState::default(),
            motion: ActiveMotion::default(),
            homing: Homing::default(),
            task: Task::default(),
            observed: Observed::new(parameters.velocity_override),
            alarm: AlarmState::default(),
            vocabularies: Vocabularies::default(),
            coupling: CouplingState::default(),
            pending: Pending::default(),
            loops: Loops::new(delay),
        }
    }

    /// Sets the parameters before its first cycle.
    pub fn begin_with(&mut self, parameters: AxisParameters) {
        self.parameters.set(parameters);
        self.observed.see_override(parameters.velocity_override);
    }

    /// Returns true if it has changed parameters by itself since the last call.
    pub fn take_own_change(&mut self) -> bool {
        self.parameters.take_own_change()
    }

    /// Whether the axis is off or, if it cannot be switched off, at rest without a goal.
    pub fn is_idle(&self) -> bool {
        match self.status.state() {
            AxisState::Disabled | AxisState::Stopping => self.status.power() == Power::Off && !self.is_virtual(),
            AxisState::Standstill => self.is_virtual(),
            _ => false,
        }
    }

    /// Whether the power may be removed now without ending a motion or a command.
    pub fn may_lose_power(&self) -> bool {
        let is_off = match self.status.state() {
            AxisState::Disabled | AxisState::ErrorStop => self.status.power() == Power::Off || self.is_virtual(),
            AxisState::Stopping => self.status.power() == Power::Off && !self.is_virtual(),
            AxisState::Standstill => self.is_virtual(),
            _ => false,
        };
        is_off && self.task.goal().is_none() && self.coupling.engagement().is_none() && self.pending.waiting().is_empty()
    }

    /// Executes the part of a cycle before its commands.
    pub fn begin_step(&mut self, cx: &mut Context<'_>) {
        self.take_shifts(cx);
        self.supervise_source(cx);
        self.alarm.spare_others();
        (self.brake.had_power, self.brake.asks_anew) = (self.is_on(), false);
        self.watch_contacts(cx);
        self.read_second(cx);
        self.supervise(cx);
        self.supervise_gantry(cx);
        self.supervise_current(cx);
        self.report_switches(cx);
        self.advance(cx);
        self.record_latches(cx);
        self.use_latch(cx);
        self.step_homing(cx);
        self.check_errors(cx);
        self.supervise_encoders(cx);
        self.supervise_recovery(cx);
        self.show_virtual(Position::ZERO);
    }

    /// Executes the part of a cycle after its commands.
    pub fn end_step(&mut self, cx: &mut Context<'_>) {
        self.follow_override(cx);
        self.leave_velocity(cx);
        self.step_vocabularies(cx);
        self.follow_stream(cx);
        self.follow_function(cx);
        self.engage(cx);
        self.leave(cx);
        self.end_cam(cx);
        self.execute_inputs(cx);
        self.apply_stop_priority(cx);
        self.check_arrival(cx);
        self.settle_step(cx);
        // Shows the effect of commands on the position since it was advanced.
        self.show_virtual(self.feedback.change());
    }

    /// Executes the part after everything that may stop or end a motion.
    fn settle_step(&mut self, cx: &mut Context<'_>) {
        self.settle_vocabularies(cx);
        self.settle_phase(cx);
        self.settle_leaving(cx);
        self.settle_conditioning();
        self.switch_drive(cx);
        if self.brake.had_power && !self.travel.at_limits().is_free() && !self.is_on() {
            self.note_stop_given_up();
        }
        self.command_brake(cx.cycle);
        self.settle_waiting(cx);
    }

    /// Sets the actual position of a virtual axis, or of a simulated encoder, to the command; `moved`: change of this
    /// cycle so far.
    #[inline]
    pub(super) fn show_virtual(&mut self, moved: Position) {
        if self.is_virtual() || self.is_simulated() && self.is_on() {
            let change = moved + (self.command.position() - self.feedback.position());
            let Motion { position, velocity, .. } = self.command.motion();
            self.feedback.show(Lead { position, change, velocity, uneven: 0.0, valid: true });
        }
    }

    /// Executes a command on this axis, and answers a command for this axis alone. Commands for several axes were
    /// admitted for all of them before.
    pub fn take(&mut self, cx: &mut Context<'_>, command: &Command) {
        let sequence = command.sequence;
        let result = match &command.action {
            Action::Enable(_) => return self.enable(cx, sequence),
            Action::Disable(_) => return self.disable(cx, sequence),
            Action::Halt(_) => return self.halt(cx, sequence),
            Action::Deactivate => return self.begin_disable(cx),
            Action::Abort => {
                self.stop_simulated_master(cx);
                return self.abort(cx, sequence);
            }
            Action::QuickStop(_) => return self.quick_stop(cx, sequence),
            Action::ResetErrors(_) => return self.reset(cx, sequence),
            Action::Move(request) => self.start_move(cx, sequence, request),
            Action::Probe(request) => self.start_probe(cx, sequence, request),
            Action::TouchProbe(request) => self.arm_touch_probe(cx, sequence, request),
            Action::AbortTrigger(request) => self.abort_trigger(cx, sequence, request),
            Action::QueryTrajectory(request) => self.query_trajectory(cx, sequence, request.at_ns),
            Action::HomeAxis(request) => self.start_homing(cx, sequence, request.method),
            Action::OutAn(request) => self.start_out_an(cx, sequence, *request),
            Action::SetPosition(request) => self.set_position(cx, sequence, request.position),
            Action::ShiftPosition(request) => self.shift_position(cx, sequence, request.distance),
            Action::SetMasterPosition(request) => self.set_master_position(cx, sequence, request.position),
            Action::Synchronize(request) => self.start_synchronize(cx, sequence, request),
            Action::Vocabulary(request) => self.run_request(cx, sequence, request),
            _ => return,
        };
        if let Err(refusal) = result {
            cx.events.push(Event { position: self.command.position(), ..refusal.event(sequence) });
        }
    }

    /// Whether its state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        let searches = self.task.goal().and_then(|goal| goal.search).is_none_or(|search| search.is_sound());
        let waits = self.pending.buffer().is_sound()
            && self.coupling.overlay().is_none_or(|overlay| overlay.is_sound())
            && self.coupling.phasing().is_none_or(|phasing| phasing.is_sound() && self.coupling().is_some())
            && self.coupling.conditioning().is_sound()
            && self.coupling.engagement().is_none_or(|engagement| engagement.is_sound())
            && self.coupling.leaving().is_none_or(|leaving| leaving.is_sound() && self.coupling().is_some());
        let fits = match *self.motion.generator() {
            Generator::Rest => true,
            Generator::Open { .. } | Generator::Coast { .. } => self.is_open_loop(),
            Generator::OutAn { level, .. } => {
                let is_one = self.closes_loop_here() && self.gantry().is_none() && self.task.goal().is_none();
                let runs = self.status.power() == Power::On && self.status.state() == AxisState::ContinuousMotion;
                is_one && runs && (level == Level::Setpoint || self.has_effort_command())
            }
            Generator::Plan(_) | Generator::Follow(_) => !self.is_open_loop(),
            Generator::Track(_) => !self.is_open_loop() && self.tracker().is_some(),
        };
        let tracks = self.trackers().all(|tracker| tracker.is_sound()) && self.task.left().is_none();
        let is_moved = self.task.function().is_none_or(|by| by.is_sound());
        fits && tracks
            && is_moved
            && self.is_sensor_sound()
            && self.motion.generator().is_sound()
            && self.homing.is_sound()
            && self.homing.is_running() == (self.status.state() == AxisState::Homing)
            && (!self.homing.is_running() || self.is_on() && !self.is_virtual())
            && self.parameters.is_sound()
            && self.loops.compensation().is_sound()
            && self.loops.position().is_sound()
            && self.loops.effort().is_sound(&self.parameters.amplifier, self.setup.cycle_ns)
            && self.loops.velocity_feedback().is_sound()
            && self.can_close_loop()
            && self.may_be_analog_with(&self.parameters).is_ok()
            && self.loops.recovery().is_sound()
            && self.vocabularies.is_sound()
            && self.pending.touch_probes().are_sound()
            && searches
            && waits
            && self.command.motion().is_sound()
            && self.observed.override_seen().is_finite()
            && self.fault().is_sound()
    }

    /// Whether it is the same axis of the same machine, in any state.
    pub fn is_set_up_as(&self, other: &Self) -> bool {
        let has_rings = self.supervision.has_ring_of(&other.supervision)
            && self.loops.compensation().has_ring_of(other.loops.compensation());
        self.setup == other.setup && self.cycle.signals() == other.cycle.signals() && has_rings
    }

    /// Returns the axis as an object.
    pub fn object(&self) -> Object {
        Object::Axis(self.setup.index)
    }

    /// Returns the index among the drives; none for a virtual axis.
    #[inline]
    pub fn drive(&self) -> Option<usize> {
        self.setup.drive.map(|(place, _)| place)
    }

    /// Returns its command position for followers: the motion of this cycle.
    #[inline]
    pub fn command(&self) -> Motion {
        self.command.motion()
    }

    /// Returns its actual position for followers.
    #[inline]
    pub fn actual(&self) -> Lead {
        self.feedback.lead()
    }

    /// Returns the position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64, encoders: &[Encoder]) -> i64 {
        self.turn_counts(self.locate_raw(count, encoders))
    }

    /// Returns the command to the drive.
    #[inline]
    pub fn output(&self) -> DriveOutput {
        *self.drive_data.output()
    }

    /// Returns the active error.
    #[inline]
    pub fn error(&self) -> Code {
        self.alarm.code()
    }

    /// Returns the snapshot of the axis at its last error.
    pub fn fault(&self) -> &ErrorSnapshot {
        self.alarm.fault()
    }

    /// Returns the leader to which a vocabulary may couple it at any time.
    pub fn master(&self) -> Option<crate::object::Leader> {
        self.setup.vocabularies.master()
    }

    /// Returns the length of a cycle (s).
    fn cycle_s(&self) -> f64 {
        self.setup.cycle_ns as f64 / 1e9
    }

    /// Changes the state and reports it. A state that a stop with lock replaces in the same cycle is not reported.
    fn set_state(&mut self, cx: &mut Context<'_>, state: AxisState) {
        let shown = (self.object(), self.command.position());
        self.status.enter(state, cx.events, shown);
    }

    /// Reads the drive and the source of the position. The inputs of all axes are read before any axis moves.
    pub fn sense(&mut self, input: Option<&DriveInput>, encoders: &[Encoder], raw: &[EncoderInput]) {
        let Some(input) = input else { return };
        let effort = self.reported_effort(input.effort);
        self.drive_data.shown_mut().read(input, effort);
        self.read_source(input, encoders, raw);
        self.read_velocity_encoder(input);
    }
}
