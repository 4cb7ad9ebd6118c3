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
use crate::encoder::{Encoder, Lead, Reader};
use crate::event::{Event, EventQueue, Kind, Number, Severity};
use crate::gantry::Gantry;
use crate::modulo::Modulo;
use crate::object::Object;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::Motion;
use crate::regulator::{Compensator, Law};
use crate::signal::Signal;
use crate::state::{AxisState, HomingPhase, Reference};
use crate::sync::Leads;
use crate::table::Table;
use crate::vocabulary::{LatchView, Owner, Setting, Vocabularies, Wiring};
use alarm::ActiveError;
use brake::BrakeState;
use buffer::Buffer;
use conditioning::Conditioning;
use effort::EffortLoops;
use engage::Engagement;
use feedback::Sensor;
use generator::Generator;
use goal::Goal;
use homing::Homing;
use judge::Supervision;
use leave::Leaving;
use limits::AtLimits;
use master::MasterView;
use overlay::Overlay;
use phase::Phasing;
use position_loop::PositionLoop;
pub use power::ENABLE_TIMEOUT_NS;
use power::Power;
use rhythm::CyclePace;
use runaway::Recovery;
use serde::{Deserialize, Serialize};
use shown::DriveShown;
pub use shown::MISSED_CYCLES;
use std::sync::Arc;
use stream::Streamed;
use touch_probe::TouchProbes;
use velocity_encoder::VelocityFeedback;
use waiting::Waiting;

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

/// One axis. Fields that every cycle accesses come first in memory, up to `judge` and the derived parameters. A cycle
/// accesses only a part of the other fields, or none.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub struct Axis {
    #[serde(skip)]
    rhythm: CyclePace,
    /// First of its signals.
    signals: Signal,
    state: AxisState,
    reference: Reference,
    power: Power,
    /// Whether the command of this cycle came from a leader or an encoder, so that its acceleration is that of single
    /// counts.
    is_led: bool,
    /// Whether the reference of the drive is below 0; outputs may have to show that.
    is_backwards: bool,
    brake: bool,
    owner: Owner,
    streamed: Streamed,
    command: Motion,
    actual: Lead,
    counter: Reader,
    /// Counts of its coordinate minus raw count, both in the direction of the drive.
    origin: i64,
    /// Data reported by the drive.
    shown: DriveShown,
    output: DriveOutput,
    /// Sign of the last motion, for direction CURRENT.
    last_direction: f64,
    /// State at the software limits.
    at_limits: AtLimits,
    judge: Supervision,
    /// Active parameters: they act from the next command on, or at once if the row requires that.
    pub parameters: InForce,
    setup: AxisSetup,
    sensor: Sensor,
    sight: MasterView,
    /// State of its own brake, and requests of inputs of the machine.
    holding: BrakeState,
    generator: Generator,
    homing: Homing,
    goal: Option<Goal>,
    /// The function that moves it whenever it is on.
    function: Option<function::MovedBy>,
    /// Whether the machine is active, so that the axis may be switched on and moved.
    active: bool,
    watch: power::Watch,
    /// Its limit and reference switches.
    switches: Switches,
    /// The switches of the cycle before.
    switches_before: Switches,
    /// Number of index pulses so far, and position of the last one.
    index: (u32, Position),
    /// Move of its coordinate that followers have not taken into account yet: it is no motion.
    moved: Position,
    /// The trajectory that it has left in this cycle, and the reason.
    #[serde(skip)]
    left: Option<(u64, Code, alarm::Numbers)>,
    /// The cycle in which an error has ended the motion of a vocabulary, and that vocabulary.
    #[serde(skip)]
    lost: Option<(u64, Owner)>,
    /// The override of the active plan (%).
    override_seen: f64,
    /// Its error.
    alarm: ActiveError,
    /// The code of the open contact that prevents motion.
    open_contact: Code,
    /// Whether an error of this cycle stops the other axes, too.
    stops_others: bool,
    vocabularies: Vocabularies,
    overlay: Option<Overlay>,
    phasing: Option<Phasing>,
    conditioning: Conditioning,
    engagement: Option<Engagement>,
    leaving: Option<Leaving>,
    touch_probes: TouchProbes,
    buffer: Buffer,
    waiting: Waiting,
    compensation: Compensator,
    position_loop: PositionLoop,
    effort_loops: EffortLoops,
    velocity_feedback: VelocityFeedback,
    recovery: Recovery,
}

/// Bytes of an axis that each cycle accesses: its present motion, its supervision and its limits.
pub const HOT_BYTES: usize =
    std::mem::offset_of!(Axis, judge) + Supervision::HOT_BYTES + size_of::<in_force::Derived>();
const _: () = assert!(HOT_BYTES <= 1024, "a cycle of an axis touches more than 1 KiB");

impl Axis {
    /// Returns an axis at rest, switched off; a virtual axis is always on.
    pub fn new(setup: AxisSetup, parameters: AxisParameters, signals: Signal) -> Self {
        let is_virtual = setup.drive.is_none();
        let delay = setup.drive.map_or(0, |(_, offers)| offers.delay.min(MAX_DELAY));
        let sensor = Sensor::new(setup.wired, setup.encoders, &parameters);
        Self {
            setup,
            signals,
            parameters: parameters.into(),
            state: if is_virtual { AxisState::Standstill } else { AxisState::Disabled },
            reference: Reference::Stop,
            power: if is_virtual { Power::On } else { Power::Off },
            active: true,
            shown: DriveShown::new(is_virtual),
            watch: power::Watch::default(),
            switches: Switches::default(),
            switches_before: Switches::default(),
            index: (0, Position::ZERO),
            homing: Homing::default(),
            moved: Position::ZERO,
            counter: sensor.reader(),
            sensor,
            sight: MasterView::default(),
            origin: 0,
            actual: Lead { valid: is_virtual, ..Lead::default() },
            command: Motion::default(),
            is_led: false,
            generator: Generator::Rest,
            goal: None,
            function: None,
            left: None,
            lost: None,
            overlay: None,
            phasing: None,
            conditioning: Conditioning::default(),
            engagement: None,
            leaving: None,
            touch_probes: TouchProbes::default(),
            buffer: Buffer::default(),
            override_seen: parameters.velocity_override,
            waiting: Waiting::default(),
            compensation: Compensator::new(delay),
            position_loop: PositionLoop::default(),
            effort_loops: EffortLoops::default(),
            velocity_feedback: VelocityFeedback::default(),
            recovery: Recovery::default(),
            judge: Supervision::new(delay),
            at_limits: AtLimits::default(),
            alarm: ActiveError::default(),
            open_contact: Code::NONE,
            stops_others: false,
            brake: false,
            holding: BrakeState::default(),
            is_backwards: false,
            last_direction: 0.0,
            streamed: Streamed::default(),
            owner: Owner::Native,
            vocabularies: Vocabularies::default(),
            output: DriveOutput::default(),
            rhythm: CyclePace::default(),
        }
    }

    /// Sets the parameters before its first cycle.
    pub fn begin_with(&mut self, parameters: AxisParameters) {
        self.parameters.set(parameters);
        self.override_seen = parameters.velocity_override;
    }

    /// Returns true if it has changed parameters by itself since the last call.
    pub fn take_own_change(&mut self) -> bool {
        self.parameters.take_own_change()
    }

    /// Whether the axis is off or, if it cannot be switched off, at rest without a goal.
    pub fn is_idle(&self) -> bool {
        match self.state {
            AxisState::Disabled | AxisState::Stopping => self.power == Power::Off && !self.is_virtual(),
            AxisState::Standstill => self.is_virtual(),
            _ => false,
        }
    }

    /// Whether the power may be removed now without ending a motion or a command.
    pub fn may_lose_power(&self) -> bool {
        let is_off = match self.state {
            AxisState::Disabled | AxisState::ErrorStop => self.power == Power::Off || self.is_virtual(),
            AxisState::Stopping => self.power == Power::Off && !self.is_virtual(),
            AxisState::Standstill => self.is_virtual(),
            _ => false,
        };
        is_off && self.goal.is_none() && self.engagement.is_none() && self.waiting.is_empty()
    }

    /// Executes the part of a cycle before its commands.
    pub fn begin_step(&mut self, cx: &mut Context<'_>) {
        self.take_shifts(cx);
        self.supervise_source(cx);
        self.stops_others = false;
        (self.holding.had_power, self.holding.asks_anew) = (self.is_on(), false);
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
        self.show_virtual(self.actual.change);
    }

    /// Executes the part after everything that may stop or end a motion.
    fn settle_step(&mut self, cx: &mut Context<'_>) {
        self.settle_vocabularies(cx);
        self.settle_phase(cx);
        self.settle_leaving(cx);
        self.settle_conditioning();
        self.switch_drive(cx);
        if self.holding.had_power && !self.at_limits.is_free() && !self.is_on() {
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
            let change = moved + (self.command.position - self.actual.position);
            let Motion { position, velocity, .. } = self.command;
            self.actual = Lead { position, change, velocity, uneven: 0.0, valid: true };
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
            cx.events.push(Event { position: self.command.position, ..refusal.event(sequence) });
        }
    }

    /// Whether its state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        let searches = self.goal.and_then(|goal| goal.search).is_none_or(|search| search.is_sound());
        let waits = self.buffer.is_sound()
            && self.overlay.is_none_or(|overlay| overlay.is_sound())
            && self.phasing.is_none_or(|phasing| phasing.is_sound() && self.coupling().is_some())
            && self.conditioning.is_sound()
            && self.engagement.is_none_or(|engagement| engagement.is_sound())
            && self.leaving.is_none_or(|leaving| leaving.is_sound() && self.coupling().is_some());
        let fits = match self.generator {
            Generator::Rest => true,
            Generator::Open { .. } | Generator::Coast { .. } => self.is_open_loop(),
            Generator::OutAn { level, .. } => {
                let is_one = self.closes_loop_here() && self.gantry().is_none() && self.goal.is_none();
                let runs = self.power == Power::On && self.state == AxisState::ContinuousMotion;
                is_one && runs && (level == Level::Setpoint || self.has_effort_command())
            }
            Generator::Plan(_) | Generator::Follow(_) => !self.is_open_loop(),
            Generator::Track(_) => !self.is_open_loop() && self.tracker().is_some(),
        };
        let tracks = self.trackers().all(|tracker| tracker.is_sound()) && self.left.is_none();
        let is_moved = self.function.is_none_or(|by| by.is_sound());
        fits && tracks
            && is_moved
            && self.is_sensor_sound()
            && self.generator.is_sound()
            && self.homing.is_sound()
            && self.homing.is_running() == (self.state == AxisState::Homing)
            && (!self.homing.is_running() || self.is_on() && !self.is_virtual())
            && self.parameters.is_sound()
            && self.compensation.is_sound()
            && self.position_loop.is_sound()
            && self.effort_loops.is_sound(&self.parameters.amplifier, self.setup.cycle_ns)
            && self.velocity_feedback.is_sound()
            && self.can_close_loop()
            && self.may_be_analog_with(&self.parameters).is_ok()
            && self.recovery.is_sound()
            && self.vocabularies.is_sound()
            && self.touch_probes.are_sound()
            && searches
            && waits
            && self.command.is_sound()
            && self.override_seen.is_finite()
            && self.fault().is_sound()
    }

    /// Whether it is the same axis of the same machine, in any state.
    pub fn is_set_up_as(&self, other: &Self) -> bool {
        let has_rings = self.judge.has_ring_of(&other.judge) && self.compensation.has_ring_of(&other.compensation);
        self.setup == other.setup && self.signals == other.signals && has_rings
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
        self.command
    }

    /// Returns its actual position for followers.
    #[inline]
    pub fn actual(&self) -> Lead {
        self.actual
    }

    /// Returns the position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64, encoders: &[Encoder]) -> i64 {
        self.turn_counts(self.locate_raw(count, encoders))
    }

    /// Returns the command to the drive.
    #[inline]
    pub fn output(&self) -> DriveOutput {
        self.output
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
        if self.state != state {
            self.state = state;
            let object = self.object();
            let event = Event::new(Severity::Info, Kind::State, object, Code::NONE);
            let event = event.with(Number::Count(state as i64), Number::None);
            let locks = matches!(state, AxisState::Stopping | AxisState::ErrorStop);
            let is_outdated = |last: &Event| locks && last.kind == Kind::State && last.source == object;
            cx.events.push_over(Event { position: self.command.position, ..event }, is_outdated);
        }
    }

    /// Reads the drive and the source of the position. The inputs of all axes are read before any axis moves.
    pub fn sense(&mut self, input: Option<&DriveInput>, encoders: &[Encoder], raw: &[EncoderInput]) {
        let Some(input) = input else { return };
        self.shown.read(input, self.reported_effort(input.effort));
        self.read_source(input, encoders, raw);
        self.read_velocity_encoder(input);
    }
}
