//! One cycle of it all.
//!
//! Law      commands | inputs | encoders | function slots, ascending | axes, a leader before its followers | outputs | signals, events
//! Reads    [`Inputs`] of t_k, the commands that are due
//! Writes   [`Outputs`], the signal board, the events of the cycle
//! Refuses  commands, each by one event; the cycle itself cannot fail: faults are states
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

use crate::axis::{Axis, Context, Edges, Fault, MAX_WAITING, MOST_RECORDS, Pace};
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
use crate::vocabulary::Latched;
use analog::AnalogPlace;
use lineshaft_program::Module;
use order::Ways;
use panel::Panel;
use signals::Signals;
pub use state::{State, StateError};
use std::ops::Range;
use std::sync::Arc;

/// Most commands of one cycle. Whoever has more keeps them for the next one; what is given beyond that is refused.
pub const MAX_COMMANDS: usize = 64;

/// What a cycle is told from outside, beside its commands.
#[derive(Clone, Copy)]
struct Told<'a> {
    inputs: &'a Inputs,
    /// Streamed setpoints that are new.
    stream: Option<&'a Setpoints>,
}

/// A machine, as far as it has run.
#[derive(Debug)]
pub struct Machine {
    config: MachineConfig,
    directory: Directory,
    signals: Signals,
    state: State,
    /// The state before cycle 0.
    first: State,
    events: EventQueue,
    /// Room for the parameters of axes while a set of changes is checked.
    candidates: Vec<AxisParameters>,
    /// The latches of this cycle.
    latched: Vec<Latched>,
    /// Places of the digital inputs in section `io`.
    digital_inputs: Vec<u16>,
    /// A coupling was asked for in this cycle.
    couples: bool,
    /// The last command of this cycle that has set each encoder, or 0.
    set_by: Vec<u64>,
    /// Room for the inputs as the machine sees them.
    seen: Inputs,
    /// Room for the inputs with one drive in the place of two, and with the words of drives without a bus.
    joined: Inputs,
    /// Drives without a bus.
    analog_places: Vec<AnalogPlace>,
    /// Through which axes sinks and masters lead.
    ways: Ways,
    /// What the slots are wired to.
    wires: Vec<Wires>,
    /// Room for two sets of a function.
    room: Vec<i64>,
    /// Slots that an error of the axis ends which they move, and that axis.
    ended_by_errors: Vec<(u16, u16)>,
    /// Slots that have failed in this cycle, the axis of each, and why.
    failed: Vec<(u16, u16, Code)>,
    /// The first axes that slots move, and those slots.
    movers: Vec<(usize, u16)>,
    /// It passes over nothing: what others are compared with.
    #[cfg(test)]
    pub(crate) steps_all: bool,
}

impl Machine {
    /// A machine at rest, before cycle 0.
    ///
    /// # Errors
    /// What the config lacks.
    pub fn new(mut config: MachineConfig) -> Result<Self, ConfigError> {
        config.tell_sources();
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
            // Each axis has one and follows one before it at most; and one more is begun before those end that it replaces.
            runs: vec![None; 2 * axes.len() + 1],
            virtual_master: VirtualMaster::new(&config.global.power_on()),
            panel: Panel::new(&config),
            gantries: config.gantries(),
            analogs: analog::at_rest(&config),
            axes,
            encoders,
            slots,
            tables: config.tables.iter().map(|entry| Arc::clone(&entry.table)).collect(),
            programs,
        };
        let axes = &state.axes;
        let mut machine = Self {
            // Each command may be answered, and ended by each axis; each axis may end all that wait for it, and tell of more;
            // each slot may tell how it stands, and that it failed.
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
            ended_by_errors: functions::ended_by_errors(&wires),
            failed: Vec::with_capacity(wires.len()),
            movers: functions::movers(&wires),
            ways: Ways::of(&config),
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

    /// Inputs of the machine's shape, as before anything was read.
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

    /// Outputs of the machine's shape.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            digital: vec![0; self.config.count_io(IoKind::DigitalOutput).div_ceil(64)],
            analog: vec![0.0; self.config.count_io(IoKind::AnalogOutput)],
            drive: vec![DriveOutput::default(); self.config.count_drives()],
        }
    }

    /// One cycle. Allocates nothing, locks nothing, waits for nothing, cannot fail.
    pub fn cycle(&mut self, inputs: &Inputs, commands: Commands<'_>, outputs: &mut Outputs) {
        self.events.begin(self.state.cycle, self.state.next_event);
        self.count_overruns(inputs);
        let admitted = self.admit(commands);
        // Taking it leaves empty lists, which hold no memory.
        let mut room = std::mem::take(&mut self.seen);
        let read = self.signals.virtual_inputs(&self.state.board);
        let inputs = self.state.panel.condition(inputs, &self.config, read, self.state.cycle, &mut room);
        let mut joined = self.joins_drives().then(|| std::mem::take(&mut self.joined));
        let inputs = match &mut joined {
            None => inputs,
            Some(joined) => {
                joined.copy_from(inputs);
                self.join_drives(inputs, joined);
                self.tell_analog(joined);
                joined
            }
        };
        self.run_cycle(Told { inputs, stream: commands.stream }, commands, admitted, outputs);
        if let Some(joined) = joined {
            self.lead_seconds(outputs);
            self.lead_analog(outputs);
            self.joined = joined;
        }
        self.seen = room;
    }

    /// Are the drives of its axes others than those of the inputs?
    fn joins_drives(&self) -> bool {
        !self.state.gantries.is_empty() || !self.analog_places.is_empty()
    }

    fn run_cycle(&mut self, told: Told<'_>, commands: Commands<'_>, admitted: u64, outputs: &mut Outputs) {
        self.read_inputs(told.inputs, commands, admitted);
        let (is_calm, is_shown) = self.begin_axes(told);
        if !self.failed.is_empty() {
            self.fail_moved(told);
        }
        for command in live(commands, admitted) {
            self.carry_out(told, command);
        }
        if !is_shown {
            self.end_axes(told);
        }
        self.signals.publish_masters(&mut self.state.board, &self.state.leads);
        // Where no axis has a full cycle, none has anything for others, and outputs follow what they followed before.
        if !is_calm {
            self.stop_others(told);
            self.reset_failed(told);
            self.share_shifts();
            self.judge_trajectories(told);
            self.state.panel.follow(&self.state.axes);
        }
        if std::mem::take(&mut self.couples) {
            // New couplings move first in the next cycle; this one still ran in the order of the old ones.
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
            if switches && let Some(wiring) = axis.wiring() {
                self.signals.publish_switching(board, wiring, axis.switching(), outputs);
            }
            if axis.pace() == Pace::Full {
                let input = axis.drive().and_then(|drive| inputs.drive.get(drive));
                axis.note_rhythm(input, &shown.command, count);
            }
        }
    }

    /// Is there nothing in this cycle that all axes have to look at?
    fn is_quiet(&self, inputs: &Inputs, commands: Commands<'_>) -> bool {
        #[cfg(test)]
        if self.steps_all {
            return false;
        }
        commands.is_empty() && inputs.latch.is_empty() && self.state.panel.has_read(&inputs.digital)
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
                Pace::Passed => continue,
                Pace::Calm => axis.sense_calmly(drive),
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
            self.state.axes.iter_mut().for_each(|axis| axis.take_edges(edges));
            if edges.interrupts {
                self.stop_virtual_master(None);
            }
        }
        self.take_latches(inputs);
    }

    /// All axes as far as their commands, a leader before its followers, and the virtual master among them. Has none of them a full cycle, and are
    /// the signals of all of them written?
    #[inline]
    fn begin_axes(&mut self, told: Told<'_>) -> (bool, bool) {
        if self.state.virtual_master.source() != VirtualSource::Off {
            return self.begin_around_virtual_master(told);
        }
        self.begin_some(0..self.state.order.len(), told)
    }

    /// The same of those that stand at these places of their order.
    // A call of it, beside those around a virtual master, costs each cycle 50 instructions.
    #[inline(always)]
    fn begin_some(&mut self, places: Range<usize>, told: Told<'_>) -> (bool, bool) {
        // A machine without axes has nothing that tells when its outputs are to be looked at.
        let (mut is_calm, mut is_shown) = (!self.state.axes.is_empty(), true);
        for place in places {
            let State { axes, order, board, leads, cycle, tables, .. } = &mut self.state;
            let index = order.get(place).map_or(0, |index| usize::from(*index));
            let Some(axis) = axes.get_mut(index) else { continue };
            match axis.pace() {
                Pace::Passed => axis.pass_over(),
                Pace::Calm if axis.step_calmly(*cycle, leads, tables) => {
                    note_command(leads, index, axis);
                    // Its master may stand behind it in the order.
                    if axis.sees_a_master() {
                        is_shown = false;
                    } else {
                        axis.publish_motion(board, leads);
                    }
                }
                _ => {
                    self.with_axis(index, told, Axis::begin_step);
                    self.note_lead(index);
                    (is_calm, is_shown) = (false, false);
                }
            }
        }
        (is_calm, is_shown)
    }

    /// The rest of the full cycles, behind the commands, and the signals that are not written yet.
    fn end_axes(&mut self, told: Told<'_>) {
        for place in 0..self.state.order.len() {
            let State { axes, order, board, leads, .. } = &mut self.state;
            let index = order.get(place).map_or(0, |index| usize::from(*index));
            let Some(axis) = axes.get_mut(index) else { continue };
            match axis.pace() {
                Pace::Calm if axis.sees_a_master() => axis.publish_motion(board, leads),
                Pace::Full => {
                    self.with_axis(index, told, Axis::end_step);
                    self.note_zero(index);
                    self.state.axes[index].publish(&mut self.state.board, &self.state.leads);
                }
                _ => {}
            }
        }
    }

    /// Does something with one axis in its cycle.
    fn with_axis<T>(
        &mut self,
        index: usize,
        told: Told<'_>,
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

    /// Does something with one axis that is none of the steps of its cycle: the next one is a full one.
    fn act_on<T>(
        &mut self,
        index: usize,
        told: Told<'_>,
        act: impl FnOnce(&mut Axis, &mut Context<'_>) -> T,
    ) -> Option<T> {
        self.state.axes.get_mut(index)?.disturb();
        self.with_axis(index, told, act)
    }

    /// Who follows an axis does not follow a coordinate that was set anew.
    #[inline]
    fn note_zero(&mut self, index: usize) {
        if self.state.axes[index].has_moved() {
            self.move_leads(index);
        }
    }

    fn move_leads(&mut self, index: usize) {
        let moved = self.state.axes[index].take_moved();
        if let Some(of) = self.state.leads.of_axes.get_mut(index) {
            of.command.position += moved;
            of.actual = self.state.axes[index].actual();
        }
        self.count_on(index, moved);
    }

    /// What others see of an axis.
    fn note_lead(&mut self, index: usize) {
        self.note_zero(index);
        note_command(&mut self.state.leads, index, &self.state.axes[index]);
    }

    /// The cycle that comes next: how many have run.
    pub fn next_cycle(&self) -> u64 {
        self.state.cycle
    }

    /// What it is made of.
    pub fn config(&self) -> &MachineConfig {
        &self.config
    }

    /// Names and types of its signals.
    pub fn directory(&self) -> &Directory {
        &self.directory
    }

    /// The signals as the last cycle left them.
    pub fn board(&self) -> &Board {
        &self.state.board
    }

    /// The events of the last cycle.
    pub fn events(&self) -> &[Event] {
        self.events.as_slice()
    }

    /// How an axis stood when its last error came.
    pub fn fault(&self, axis: u16) -> Option<&Fault> {
        self.state.axes.get(usize::from(axis)).map(Axis::fault)
    }

    /// Parameters in force.
    pub fn parameters(&self, axis: u16) -> Option<&AxisParameters> {
        self.state.axes.get(usize::from(axis)).map(|axis| &*axis.parameters)
    }
}

/// What others see of the motion of an axis in this cycle.
#[inline]
fn note_command(leads: &mut Leads, index: usize, axis: &Axis) {
    let Some(of) = leads.of_axes.get_mut(index) else { return };
    let Motion { position, velocity, .. } = axis.command();
    of.command = Lead { position, change: position - of.command.position, velocity, uneven: 0.0, valid: true };
    if axis.shows_command() {
        // What a command made of the position behind the advance of the last cycle is in the change, as in that of the command.
        of.actual = Lead { change: of.command.change, ..axis.actual() };
    }
}

/// The commands that are left for the axes.
fn live(commands: Commands<'_>, admitted: u64) -> impl Iterator<Item = &Command> {
    let is_live = move |(place, command): (usize, _)| (admitted >> place & 1 == 1).then_some(command);
    commands.iter().take(MAX_COMMANDS).enumerate().filter_map(is_live)
}

#[cfg(test)]
pub(crate) mod rig;
#[cfg(test)]
mod tests;
