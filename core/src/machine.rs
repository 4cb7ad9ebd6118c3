//! Control cycle of a machine.
//!
//! Law      order in a cycle: commands | inputs | encoders | function slots, ascending | axes, a leader before its
//!          followers | outputs | signals, events
//! Reads    [`Inputs`] of t_k, the commands that are due
//! Writes   [`Outputs`], the signal board, the events of the cycle
//! Refuses  commands, with one event each. The cycle itself cannot fail: faults are states
//! Source   contract section 1

mod activity;
mod analog;
mod commands;
mod encoders;
mod functions;
mod gantries;
mod order;
mod panel;
mod parameters;
mod reactions;
mod signals;
mod state;
mod trajectories;
mod trajectory_lag;
mod virtual_master;

use crate::axis::{Axis, Context, Edges, ErrorSnapshot, MAX_WAITING, MOST_RECORDS, Pace};
use crate::code::Code;
use crate::command::{Command, Commands, Setpoints};
use crate::config::{ConfigError, IoKind, MachineConfig, SlotConfig};
use crate::drive::{DriveOutput, EncoderInput, Inputs, MAX_LATCHES, Outputs};
use crate::encoder::{Encoder, Lead};
use crate::event::{Event, EventQueue, Kind, Number, Severity};
use crate::function::{Slot, Wires};
use crate::object::Object;
use crate::parameter::AxisParameters;
use crate::profile::Motion;
use crate::signal::{Board, Directory};
use crate::sync::{Leads, OfAxis, VirtualMaster, VirtualSource};
use crate::vocabulary::LatchView;
use analog::AnalogPlace;
use lineshaft_program::Module;
use order::Dependencies;
use panel::Panel;
use signals::Signals;
pub use state::{State, StateError};
use std::ops::Range;
use std::sync::Arc;

/// Maximum number of commands in one cycle. A caller with more commands keeps the rest for the next cycle; commands
/// beyond the maximum are refused.
pub const MAX_COMMANDS: usize = 64;

/// Inputs of a cycle apart from its commands.
#[derive(Clone, Copy)]
struct CycleInputs<'a> {
    inputs: &'a Inputs,
    /// New streamed setpoints.
    stream: Option<&'a Setpoints>,
}

/// A machine with its configuration and its state after the last cycle.
#[derive(Debug)]
pub struct Machine {
    config: MachineConfig,
    directory: Directory,
    signals: Signals,
    state: State,
    /// The state before cycle 0.
    first: State,
    events: EventQueue,
    /// Buffer for the parameters of the axes while a set of changes is checked.
    candidates: Vec<AxisParameters>,
    /// Latches of this cycle.
    latched: Vec<LatchView>,
    /// Indices of the digital inputs in section `io`.
    digital_inputs: Vec<u16>,
    /// Whether a coupling was requested in this cycle.
    couples: bool,
    /// Sequence number of the last command of this cycle that has set each encoder, or 0.
    set_by: Vec<u64>,
    /// Buffer for the conditioned inputs.
    seen: Inputs,
    /// Buffer for the inputs in which one drive replaces the two drives of a gantry, and which contain the drives
    /// without a bus.
    joined: Inputs,
    /// Drives without a bus.
    analog_places: Vec<AnalogPlace>,
    /// Axes on whose commands sinks and sums of masters depend.
    ways: Dependencies,
    /// Connections of the slots.
    wires: Vec<Wires>,
    /// Buffer for two parameter sets of a function.
    room: Vec<i64>,
    /// Slots that end on an error of the axis that they move, each with that axis.
    ended_by_errors: Vec<(u16, u16)>,
    /// Slots that have failed in this cycle, each with its axis and the reason.
    failed: Vec<(u16, u16, Code)>,
    /// The first axes that are moved by slots, each with its slot.
    movers: Vec<(usize, u16)>,
    /// Whether every axis runs the full cycle every time: reference for comparison with the fast paths.
    #[cfg(test)]
    pub(crate) steps_all: bool,
}

impl Machine {
    /// Returns a machine at rest, before cycle 0.
    ///
    /// # Errors
    /// The configuration is incomplete or invalid.
    pub fn new(mut config: MachineConfig) -> Result<Self, ConfigError> {
        config.set_absolute_sources();
        config.check()?;
        let mut directory = Directory::default();
        let signals = Signals::new(&mut directory, &config);
        let setups = config.setups();
        let axes: Vec<Axis> = std::iter::zip(&setups, &config.axes)
            .zip(&signals.axes)
            .map(|((&setup, axis), &first)| Axis::new(setup, axis.power_on(), first))
            .collect();
        let encoders: Vec<Encoder> =
            config.encoders.iter().map(|encoder| Encoder::new(encoder.form, encoder.check)).collect();
        let set_by = vec![0; encoders.len()];
        let wires = config.wires(&directory, &signals.slots)?;
        let programs: Vec<Arc<Module>> = config.programs.iter().map(|entry| Arc::clone(&entry.module)).collect();
        let new_slot = |(wires, slot): (&Wires, &SlotConfig)| {
            let module = wires.program.and_then(|place| programs.get(usize::from(place)));
            Slot::new(wires, &slot.values, slot.room, module.map(|module| &**module))
        };
        let slots: Vec<Slot> = wires.iter().zip(&config.slots).map(new_slot).collect();
        let widest = config.slots.iter().map(|slot| slot.values.len()).max();
        let command = Lead { valid: true, ..Lead::default() };
        let of_axis = |axis: &Axis| OfAxis { command, actual: axis.actual(), simulated: Lead::default() };
        let leads = Leads {
            of_axes: axes.iter().map(of_axis).collect(),
            encoders: encoders.iter().map(Encoder::lead).collect(),
            sinks: slots.iter().map(|slot| *slot.lead()).collect(),
            virtual_master: command,
            virtual_mark: None,
            sums: config.sums(),
        };
        let mut board = Board::new(&directory);
        signals.set_memory_initials(&mut board, &config);
        let state = State {
            board,
            order: (0..axes.len() as u16).collect(),
            leads,
            cycle: 0,
            overruns: 0,
            next_event: 0,
            user: axes.iter().map(|axis| *axis.parameters).collect(),
            parameter_version: 0,
            active: true,
            deactivating: None,
            // At most one trajectory runs and one waits before it per axis. One more starts before the trajectories
            // that it replaces end.
            runs: vec![None; 2 * axes.len() + 1],
            virtual_master: VirtualMaster::new(&config.global.power_on()),
            panel: Panel::new(&config),
            gantries: config.gantries(),
            analogs: analog::initial_states(&config),
            axes,
            encoders,
            slots,
            tables: config.tables.iter().map(|entry| Arc::clone(&entry.table)).collect(),
            programs,
        };
        let axes = &state.axes;
        let mut machine = Self {
            // Each command may cause an answer, and an end on each axis. Each axis may end all commands that wait for
            // it, and report more events. Each slot may report its state and a failure.
            events: EventQueue::new(
                MAX_COMMANDS * (4 + axes.len())
                    + (MAX_WAITING + 16 + MOST_RECORDS) * axes.len()
                    + 2 * state.slots.len(),
            ),
            candidates: axes.iter().map(|axis| *axis.parameters).collect(),
            latched: Vec::with_capacity(MAX_LATCHES),
            digital_inputs: config.digital_inputs().collect(),
            couples: false,
            set_by,
            seen: Inputs::default(),
            joined: Inputs::default(),
            analog_places: config.analog_places().collect(),
            ended_by_errors: functions::slots_ended_by_axis_errors(&wires),
            failed: Vec::with_capacity(wires.len()),
            movers: functions::slots_that_move_watched_axes(&wires),
            ways: Dependencies::of(&config),
            wires,
            room: vec![0; 2 * widest.unwrap_or(0)],
            #[cfg(test)]
            steps_all: false,
            first: state.clone(),
            state,
            signals,
            directory,
            config,
        };
        machine.seen = machine.inputs();
        if machine.joins_drives() {
            machine.joined = machine.inputs();
        }
        machine.sort_axes();
        Ok(machine)
    }

    /// Returns inputs with the dimensions of this machine and the values before the first read.
    pub fn inputs(&self) -> Inputs {
        let words = |kind| self.config.count_io(kind).div_ceil(64);
        Inputs {
            cycle: 0,
            missed: 0,
            digital: vec![0; words(IoKind::DigitalInput)],
            analog: vec![0.0; self.config.count_io(IoKind::AnalogInput)],
            encoder: vec![EncoderInput::default(); self.state.encoders.len()],
            drive: vec![Default::default(); self.config.count_drives()],
            latch: Vec::with_capacity(MAX_LATCHES),
            latches_lost: 0,
        }
    }

    /// Returns outputs with the dimensions of this machine.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            digital: vec![0; self.config.count_io(IoKind::DigitalOutput).div_ceil(64)],
            analog: vec![0.0; self.config.count_io(IoKind::AnalogOutput)],
            drive: vec![DriveOutput::default(); self.config.count_drives()],
        }
    }

    /// Runs one cycle. It does not allocate, lock or wait, and it cannot fail.
    pub fn cycle(&mut self, inputs: &Inputs, commands: Commands<'_>, outputs: &mut Outputs) {
        self.events.begin(self.state.cycle, self.state.next_event);
        self.count_overruns(inputs);
        let admitted = self.handle_machine_commands(commands);
        // `take` leaves empty lists, which own no memory.
        let mut room = std::mem::take(&mut self.seen);
        let read = self.signals.virtual_inputs(&self.state.board);
        let inputs = self.state.panel.condition(inputs, &self.config, read, self.state.cycle, &mut room);
        let mut joined = self.joins_drives().then(|| std::mem::take(&mut self.joined));
        let inputs = match &mut joined {
            None => inputs,
            Some(joined) => {
                joined.copy_from(inputs);
                self.join_drives(inputs, joined);
                self.write_analog_inputs(joined);
                joined
            }
        };
        self.run_cycle(CycleInputs { inputs, stream: commands.stream }, commands, admitted, outputs);
        if let Some(joined) = joined {
            self.write_second_drives(outputs);
            self.write_analog_references(outputs);
            self.joined = joined;
        }
        self.seen = room;
    }

    /// Whether the drives of the axes differ from those of the inputs.
    fn joins_drives(&self) -> bool {
        !self.state.gantries.is_empty() || !self.analog_places.is_empty()
    }

    fn run_cycle(&mut self, told: CycleInputs<'_>, commands: Commands<'_>, admitted: u64, outputs: &mut Outputs) {
        self.read_inputs(told.inputs, commands, admitted);
        let (is_calm, is_shown) = self.begin_axes(told);
        if !self.failed.is_empty() {
            self.report_failed_functions(told);
        }
        for command in commands_for_axes(commands, admitted) {
            self.carry_out(told, command);
        }
        if !is_shown {
            self.end_axes(told);
        }
        self.signals.publish_masters(&mut self.state.board, &self.state.leads);
        // If no axis runs a full cycle, no axis affects others, and the outputs keep their sources.
        if !is_calm {
            self.stop_others(told);
            self.reset_failed(told);
            self.share_shifts();
            self.monitor_trajectories(told);
            self.state.panel.update_output_functions(&self.state.axes);
        }
        if std::mem::take(&mut self.couples) {
            // New couplings apply to the order from the next cycle; this cycle still ran in the previous order.
            self.sort_axes();
        }
        self.state.panel.write(&self.signals, &mut self.state.board, outputs);
        self.write_outputs(told.inputs, outputs);
        self.settle_deactivation();
        let mut errors = self.state.axes.iter().map(Axis::error);
        let error = if is_calm { None } else { errors.find(|error| !error.is_none()) };
        let (active, overruns) = (self.state.active, self.state.overruns);
        self.signals.publish_machine(&mut self.state.board, error.unwrap_or(Code::NONE), active, overruns);
        self.state.cycle = self.state.cycle.wrapping_add(1);
        self.state.next_event = self.events.next();
    }

    fn write_outputs(&mut self, inputs: &Inputs, outputs: &mut Outputs) {
        let State { axes, board, panel, leads, .. } = &mut self.state;
        let count = axes.len();
        for (axis, shown) in axes.iter_mut().zip(&leads.of_axes) {
            let switches = axis.switches_outputs();
            if switches {
                let closed = panel.brake_of(axis);
                if closed.is_some() || axis.has_own_brake() {
                    self.signals.publish_brake(board, axis, closed, outputs);
                }
            }
            if let Some(output) = axis.drive().and_then(|drive| outputs.drive.get_mut(drive)) {
                *output = axis.output();
            }
            if switches && let Some(wiring) = axis.speed_outputs() {
                self.signals.publish_switching(board, wiring, axis.switching(), outputs);
            }
            if axis.pace() == Pace::Full {
                let input = axis.drive().and_then(|drive| inputs.drive.get(drive));
                axis.decide_pace(input, &shown.command, count);
            }
        }
    }

    /// Whether this cycle contains nothing that every axis must check.
    fn is_quiet(&self, inputs: &Inputs, commands: Commands<'_>) -> bool {
        #[cfg(test)]
        if self.steps_all {
            return false;
        }
        commands.is_empty() && inputs.latch.is_empty() && self.state.panel.equals_previous(&inputs.digital)
    }

    fn count_overruns(&mut self, inputs: &Inputs) {
        if inputs.missed > 0 {
            self.state.overruns = self.state.overruns.saturating_add(u64::from(inputs.missed));
            let event = Event::new(Severity::Warn, Kind::Overrun, Object::Machine, Code::OVERRUN);
            self.events.push(event.with(Number::Count(i64::from(inputs.missed)), Number::None));
        }
    }

    fn read_inputs(&mut self, inputs: &Inputs, commands: Commands<'_>, admitted: u64) {
        let cycle_s = self.config.cycle_ns as f64 / 1e9;
        let is_quiet = self.is_quiet(inputs, commands);
        self.signals.publish_io(&mut self.state.board, inputs);
        for index in 0..self.state.encoders.len() {
            let input = inputs.encoder.get(index).copied().unwrap_or_default();
            let told = self.state.encoders[index].step(&input, cycle_s);
            self.set_encoder(index, commands, admitted);
            let encoder = &self.state.encoders[index];
            let (lead, errors) = (encoder.lead(), encoder.errors());
            let problem = told.map_or(Code::NONE, encoders::code);
            self.signals.publish_encoder(&mut self.state.board, index, input, lead, problem, errors);
            self.state.leads.encoders[index] = lead;
            if let Some(told) = told {
                self.events.push(encoders::event(told, index as u16, errors));
            }
        }
        let State { axes, leads, encoders, .. } = &mut self.state;
        for (axis, of) in axes.iter_mut().zip(&mut leads.of_axes) {
            let drive = axis.drive().and_then(|drive| inputs.drive.get(drive));
            match axis.begin_cycle(is_quiet, drive) {
                Pace::Skipped => continue,
                Pace::Reduced => axis.sense_reduced(drive),
                Pace::Full => {
                    axis.sense(drive, encoders, &inputs.encoder);
                    axis.read_switches(inputs);
                }
            }
            of.actual = axis.actual();
            axis.simulate_master(&mut of.simulated);
        }
        self.step_slots(inputs);
        let edges = self.state.panel.edges(inputs);
        if edges != Edges::default() {
            self.state.axes.iter_mut().for_each(|axis| axis.set_edges(edges));
            if edges.interrupts {
                self.stop_virtual_master(None);
            }
        }
        self.report_latches(inputs);
    }

    /// Runs all axes up to their commands, a leader before its followers, with the virtual master among them. Returns
    /// whether no axis runs a full cycle, and whether the signals of all axes are published.
    #[inline]
    fn begin_axes(&mut self, told: CycleInputs<'_>) -> (bool, bool) {
        if self.state.virtual_master.source() != VirtualSource::Off {
            return self.begin_axes_and_virtual_master(told);
        }
        self.begin_axes_at(0..self.state.order.len(), told)
    }

    /// Does the same as [`begin_axes`](Self::begin_axes) for the axes at these places of the order.
    // Inlined because a second call, in addition to those around a virtual master, costs 50 instructions in each cycle.
    #[inline(always)]
    fn begin_axes_at(&mut self, places: Range<usize>, told: CycleInputs<'_>) -> (bool, bool) {
        // A machine without axes has no axis that reports when its outputs must be checked.
        let (mut is_calm, mut is_shown) = (!self.state.axes.is_empty(), true);
        for place in places {
            let State { axes, order, board, leads, cycle, tables, .. } = &mut self.state;
            let index = order.get(place).map_or(0, |index| usize::from(*index));
            let Some(axis) = axes.get_mut(index) else { continue };
            match axis.pace() {
                Pace::Skipped => axis.skip_cycle(),
                Pace::Reduced if axis.step_reduced(*cycle, leads, tables) => {
                    update_command_lead(leads, index, axis);
                    // Its master may follow in the order.
                    if axis.has_displayed_master() {
                        is_shown = false;
                    } else {
                        axis.publish_motion(board, leads);
                    }
                }
                _ => {
                    self.with_axis(index, told, Axis::begin_step);
                    self.update_lead(index);
                    (is_calm, is_shown) = (false, false);
                }
            }
        }
        (is_calm, is_shown)
    }

    /// Runs the rest of the full cycles, after the commands, and publishes the signals that are not published yet.
    fn end_axes(&mut self, told: CycleInputs<'_>) {
        for place in 0..self.state.order.len() {
            let State { axes, order, board, leads, .. } = &mut self.state;
            let index = order.get(place).map_or(0, |index| usize::from(*index));
            let Some(axis) = axes.get_mut(index) else { continue };
            match axis.pace() {
                Pace::Reduced if axis.has_displayed_master() => axis.publish_motion(board, leads),
                Pace::Full => {
                    self.with_axis(index, told, Axis::end_step);
                    self.apply_new_zero(index);
                    self.state.axes[index].publish(&mut self.state.board, &self.state.leads);
                }
                _ => {}
            }
        }
    }

    /// Runs a step of one axis in its cycle.
    fn with_axis<T>(
        &mut self,
        index: usize,
        told: CycleInputs<'_>,
        act: impl FnOnce(&mut Axis, &mut Context<'_>) -> T,
    ) -> Option<T> {
        let State { axes, gantries, cycle, leads, encoders, runs, tables, parameter_version, .. } = &mut self.state;
        let axis = axes.get_mut(index)?;
        let mut cx = Context {
            cycle: *cycle,
            input: axis.drive().and_then(|drive| told.inputs.drive.get(drive)),
            inputs: told.inputs,
            digital_inputs: &self.digital_inputs,
            leads,
            tables,
            encoders,
            latches: &self.latched,
            stream: told.stream,
            runs,
            gantry: axis.gantry().and_then(|place| gantries.get_mut(usize::from(place))),
            events: &mut self.events,
        };
        let result = act(axis, &mut cx);
        if axis.take_own_change() {
            *parameter_version = parameter_version.wrapping_add(1);
        }
        Some(result)
    }

    /// Runs an action on one axis that is not a step of its cycle. The next cycle of the axis is a full one.
    fn act_on<T>(
        &mut self,
        index: usize,
        told: CycleInputs<'_>,
        act: impl FnOnce(&mut Axis, &mut Context<'_>) -> T,
    ) -> Option<T> {
        self.state.axes.get_mut(index)?.require_full_cycle();
        self.with_axis(index, told, act)
    }

    /// Applies a new zero of an axis to its leader signals, so that its followers see no motion.
    #[inline]
    fn apply_new_zero(&mut self, index: usize) {
        if self.state.axes[index].has_moved() {
            self.shift_leads(index);
        }
    }

    fn shift_leads(&mut self, index: usize) {
        let moved = self.state.axes[index].take_moved();
        if let Some(of) = self.state.leads.of_axes.get_mut(index) {
            of.command.position += moved;
            of.actual = self.state.axes[index].actual();
        }
        self.keep_master_positions(index, moved);
    }

    /// Updates the leader signals of an axis.
    fn update_lead(&mut self, index: usize) {
        self.apply_new_zero(index);
        update_command_lead(&mut self.state.leads, index, &self.state.axes[index]);
    }

    /// Returns the number of the next cycle, which equals the number of cycles that have run.
    pub fn next_cycle(&self) -> u64 {
        self.state.cycle
    }

    /// Returns the configuration.
    pub fn config(&self) -> &MachineConfig {
        &self.config
    }

    /// Returns names and types of the signals.
    pub fn directory(&self) -> &Directory {
        &self.directory
    }

    /// Returns the signals after the last cycle.
    pub fn board(&self) -> &Board {
        &self.state.board
    }

    /// Returns the events of the last cycle.
    pub fn events(&self) -> &[Event] {
        self.events.as_slice()
    }

    /// Returns the recorded state of an axis at its last error.
    pub fn fault(&self, axis: u16) -> Option<&ErrorSnapshot> {
        self.state.axes.get(usize::from(axis)).map(Axis::fault)
    }

    /// Returns the parameters of an axis that are in force.
    pub fn parameters(&self, axis: u16) -> Option<&AxisParameters> {
        self.state.axes.get(usize::from(axis)).map(|axis| &*axis.parameters)
    }
}

/// Updates the command values in the leader signals of an axis for this cycle.
#[inline]
fn update_command_lead(leads: &mut Leads, index: usize, axis: &Axis) {
    let Some(of) = leads.of_axes.get_mut(index) else { return };
    let Motion { position, velocity, .. } = axis.command();
    of.command = Lead { position, change: position - of.command.position, velocity, uneven: 0.0, valid: true };
    if axis.shows_command() {
        // The change includes what commands added to the position after the advance of the last cycle, as it does for
        // the commanded position.
        of.actual = Lead { change: of.command.change, ..axis.actual() };
    }
}

/// Returns the commands that are left for the axes.
fn commands_for_axes(commands: Commands<'_>, admitted: u64) -> impl Iterator<Item = &Command> {
    let is_live = move |(place, command): (usize, _)| (admitted >> place & 1 == 1).then_some(command);
    commands.iter().take(MAX_COMMANDS).enumerate().filter_map(is_live)
}

#[cfg(test)]
pub(crate) mod rig;
#[cfg(test)]
mod tests;
