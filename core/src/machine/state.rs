//! State of a machine: everything that its cycles change. A machine restored from it continues where the other one
//! ended.
//!
//! Law      restore(config, state of m) and m give the same outputs, signals and events for the same inputs and commands
//! Refuses  a state with other dimensions than the config: other axes, encoders, signals, drives

use super::Machine;
use super::panel::Panel;
use crate::axis::{Axis, Run};
use crate::config::{ConfigError, MachineConfig};
use crate::drive::AnalogDrive;
use crate::encoder::Encoder;
use crate::function::Slot;
use crate::gantry::Gantry;
use crate::parameter::{AxisParameters, MachineParameters};
use crate::signal::Board;
use crate::sync::{Leads, VirtualMaster};
use crate::table::Table;
use crate::trajectory::Stretch;
use lineshaft_program::Module;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Everything that the cycles of a machine change.
#[derive(Debug, Serialize, Deserialize)]
pub struct State {
    pub(super) board: Board,
    pub(super) axes: Vec<Axis>,
    /// Axes with two drives, in file order.
    pub(super) gantries: Vec<Gantry>,
    /// Drives without a bus, in file order of their axes.
    pub(super) analogs: Vec<AnalogDrive>,
    pub(super) encoders: Vec<Encoder>,
    /// Function slots, by their numbers.
    pub(super) slots: Vec<Slot>,
    /// Last loaded tables.
    #[serde(with = "crate::table::shared")]
    pub(super) tables: Vec<Arc<Table>>,
    /// Last loaded programs.
    #[serde(with = "lineshaft_program::shared")]
    pub(super) programs: Vec<Arc<Module>>,
    /// Axes, a leader before its followers.
    pub(super) order: Vec<u16>,
    pub(super) leads: Leads,
    pub(super) cycle: u64,
    pub(super) overruns: u64,
    /// Number of the next event.
    pub(super) next_event: u64,
    /// Whether axes may be switched on and moved.
    pub(super) active: bool,
    /// Sequence number of the active deactivation; its end is reported when every drive is switched off.
    pub(super) deactivating: Option<u64>,
    /// Layer User of the parameters, by axis.
    pub(super) user: Vec<AxisParameters>,
    /// Counter that increases with every change of a parameter or layer.
    pub(super) parameter_version: u64,
    /// Running trajectories, one per place; there are two places per axis and one more.
    pub(super) runs: Vec<Option<Run>>,
    /// Terminals, and the parameters of the machine.
    pub(super) panel: Panel,
    /// Source and state of the virtual master.
    pub(super) virtual_master: VirtualMaster,
}

/// Reason why a state does not match a machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// The configuration of the cell is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The number of some objects differs.
    #[error("the state holds {found} {what}; the cell has {expected}")]
    Shape {
        /// Kind of the objects.
        what: &'static str,
        /// Number in the state.
        found: usize,
        /// Number in the cell.
        expected: usize,
    },
    /// An axis has a different set-up.
    #[error("the state holds another set-up of axis {axis} than the cell")]
    Setup {
        /// Name of the axis.
        axis: String,
    },
    /// The state of an axis cannot result from any cycle.
    #[error("the state of axis {axis} is none that an axis can be in")]
    InvalidAxis {
        /// Name of the axis.
        axis: String,
    },
    /// The active state of the axes differs from that of the machine.
    #[error("the state holds axes that are active in a machine that is not, or the other way round")]
    Active,
    /// A trajectory is invalid or is not run by its axes.
    #[error("the state holds a trajectory that its axes do not run")]
    Trajectory,
    /// The inputs and outputs belong to another cell, or the parameters of the machine are invalid.
    #[error("the state holds inputs, outputs or parameters of the machine that the cell has not")]
    Panel,
    /// The virtual master does not match its parameters.
    #[error("the state holds a virtual master that its parameters and axes do not make")]
    VirtualMaster,
    /// The leader signals belong to other axes and encoders.
    #[error("the state holds leads of other axes or encoders than the cell")]
    Leads,
    /// The encoders have a different width.
    #[error("the state holds encoders of another width than the cell")]
    Encoders,
    /// The functions belong to another cell, or their state is invalid.
    #[error("the state holds functions that the cell has not, or a state that they cannot be in")]
    Functions,
    /// The tables have a different form.
    #[error("the state holds tables that are none of the cell")]
    Tables,
    /// The order does not contain all axes.
    #[error("the state holds an order of axes that names one twice, or one that is not there")]
    Order,
}

impl State {
    /// Returns the number of the next cycle.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Returns the parameters in force, by axis.
    pub fn parameters(&self) -> impl Iterator<Item = &AxisParameters> {
        self.axes.iter().map(|axis| &*axis.parameters)
    }

    /// Returns the parameters of the machine in force.
    pub fn machine_parameters(&self) -> &MachineParameters {
        &self.panel.parameters
    }

    /// Sets the state after power-on: everything as in `first`, except the cycle and event counters and the saved
    /// parameters. It allocates no memory.
    pub(super) fn power_up_from(&mut self, first: &Self) {
        // Each field is named, so that the compiler reports a missing one.
        let Self {
            board,
            axes,
            gantries,
            analogs,
            encoders,
            slots,
            tables,
            programs,
            order,
            leads,
            runs,
            panel,
            virtual_master,
            cycle: _,
            overruns: _,
            next_event: _,
            active: _,
            deactivating: _,
            user: _,
            parameter_version: _,
        } = first;
        self.board.copy_from(board);
        self.axes.clone_from(axes);
        self.gantries.clone_from(gantries);
        self.analogs.clone_from(analogs);
        self.encoders.clone_from(encoders);
        self.slots.clone_from(slots);
        // The caller that gave a table or program frees it: only reference counts change here.
        self.tables.clone_from(tables);
        self.programs.clone_from(programs);
        self.order.clone_from(order);
        self.leads.copy_from(leads);
        self.runs.clone_from(runs);
        self.panel.power_up_from(panel);
        self.virtual_master = *virtual_master;
        for (axis, user) in self.axes.iter_mut().zip(&self.user) {
            axis.begin_with(*user);
            axis.set_active(self.active);
        }
    }

    /// Checks that the state matches a newly created machine.
    fn check(&self, machine: &Machine) -> Result<(), StateError> {
        let fresh = &machine.state;
        let shape = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(StateError::Shape { what, found, expected }) }
        };
        shape("signals", self.board.len(), fresh.board.len())?;
        shape("axes", self.axes.len(), fresh.axes.len())?;
        shape("axes with two drives", self.gantries.len(), fresh.gantries.len())?;
        shape("drives without a bus", self.analogs.len(), fresh.analogs.len())?;
        shape("saved sets of parameters", self.user.len(), fresh.user.len())?;
        shape("encoders", self.encoders.len(), fresh.encoders.len())?;
        shape("functions", self.slots.len(), fresh.slots.len())?;
        shape("tables", self.tables.len(), fresh.tables.len())?;
        shape("programs", self.programs.len(), fresh.programs.len())?;
        shape("places for trajectories", self.runs.len(), fresh.runs.len())?;
        if !self.leads.has_shape_of(&fresh.leads) {
            return Err(StateError::Leads);
        }
        let mut order = self.order.clone();
        order.sort_unstable();
        if !order.iter().copied().eq(0..self.axes.len() as u16) {
            return Err(StateError::Order);
        }
        if self.axes.iter().any(|axis| axis.is_active() != self.active) {
            return Err(StateError::Active);
        }
        if !std::iter::zip(&self.encoders, &fresh.encoders)
            .all(|(mine, fresh)| mine.is_set_up_as(fresh) && mine.is_sound())
        {
            return Err(StateError::Encoders);
        }
        if !std::iter::zip(&self.tables, &fresh.tables)
            .all(|(mine, fresh)| (mine.form(), mine.cam_setting()) == (fresh.form(), fresh.cam_setting()))
            || machine.config.axes.iter().any(|axis| {
                let table = axis.pitch_error.and_then(|place| self.tables.get(usize::from(place)));
                table.is_some_and(|table| axis.check_pitch_error(table).is_err())
            })
        {
            return Err(StateError::Tables);
        }
        for ((mine, fresh), wires) in std::iter::zip(&self.slots, &fresh.slots).zip(&machine.wires) {
            if !(mine.is_set_up_as(fresh) && mine.is_sound(wires, (&self.tables, &self.programs))) {
                return Err(StateError::Functions);
            }
        }
        if let Some(unsound) = self.user.iter().position(|user| !user.is_sound()) {
            return Err(StateError::InvalidAxis { axis: machine.config.axes[unsound].name.clone() });
        }
        for ((mine, fresh), axis) in std::iter::zip(&self.axes, &fresh.axes).zip(&machine.config.axes) {
            if !mine.is_set_up_as(fresh) {
                return Err(StateError::Setup { axis: axis.name.clone() });
            }
            if !mine.is_sound() {
                return Err(StateError::InvalidAxis { axis: axis.name.clone() });
            }
        }
        for (mine, fresh) in std::iter::zip(&self.gantries, &fresh.gantries) {
            if !mine.is_sound(fresh) {
                let axis = machine.config.axes.get(usize::from(fresh.setup().axis));
                return Err(StateError::InvalidAxis { axis: axis.map_or_else(String::new, |axis| axis.name.clone()) });
            }
        }
        if !self.panel.fits(&fresh.panel) {
            return Err(StateError::Panel);
        }
        if !self.virtual_master.is_sound(&self.panel.parameters, self.axes.len()) {
            return Err(StateError::VirtualMaster);
        }
        if !self.has_valid_runs(machine.config.cycle_ns) {
            return Err(StateError::Trajectory);
        }
        Ok(())
    }

    /// Whether each trajectory is valid, and is run by its axes and by no others.
    fn has_valid_runs(&self, cycle_ns: u64) -> bool {
        let is_run = |slot: usize, run: &Run| {
            let mut tracks = run.trajectory.tracks().iter().enumerate();
            let axis = |index: u16| self.axes.get(usize::from(index));
            run.cycle_ns == cycle_ns
                && run.stretch >= Stretch::NONE
                && run.trajectory.is_sound()
                && (run.is_over
                    || tracks
                        .all(|(track, of)| axis(of.axis).is_some_and(|axis| axis.tracks(run.sequence, slot, track))))
        };
        let is_of = |run: Option<&Run>, track: usize, index: usize| {
            run.and_then(|run| run.trajectory.tracks().get(track)).is_some_and(|track| usize::from(track.axis) == index)
        };
        let run = |slot: usize| self.runs.get(slot).and_then(Option::as_ref);
        let is_known = |(index, axis): (usize, &Axis)| {
            let own = axis.tracked().is_none_or(|(sequence, slot, track)| {
                is_of(run(slot).filter(|run| !run.is_over && run.sequence == sequence), track, index)
            });
            let follows = |(slot, track)| is_of(run(slot).filter(|run| run.is_over), track, index);
            own && axis.follows_before().is_none_or(follows)
        };
        let runs = self.runs.iter().enumerate();
        runs.filter_map(|(slot, run)| run.as_ref().map(|run| (slot, run))).all(|(slot, run)| is_run(slot, run))
            && self.axes.iter().enumerate().all(is_known)
    }
}

impl Machine {
    /// Returns a machine that continues from `state`.
    ///
    /// # Errors
    /// The state does not match the config.
    pub fn restore(config: MachineConfig, state: State) -> Result<Self, StateError> {
        let mut machine = Self::new(config)?;
        state.check(&machine)?;
        machine.state = state;
        Ok(machine)
    }

    /// Returns the state between two cycles.
    pub fn state(&self) -> &State {
        &self.state
    }
}

impl Clone for State {
    fn clone(&self) -> Self {
        Self {
            board: self.board.clone(),
            axes: self.axes.clone(),
            gantries: self.gantries.clone(),
            analogs: self.analogs.clone(),
            encoders: self.encoders.clone(),
            slots: self.slots.clone(),
            tables: self.tables.clone(),
            programs: self.programs.clone(),
            order: self.order.clone(),
            leads: self.leads.clone(),
            user: self.user.clone(),
            runs: self.runs.clone(),
            panel: self.panel.clone(),
            ..*self
        }
    }

    /// Allocates no memory if both states belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        // Each field is named, so that the compiler reports a missing one.
        let Self {
            board,
            axes,
            gantries,
            analogs,
            encoders,
            slots,
            tables,
            programs,
            order,
            leads,
            cycle,
            overruns,
            next_event,
            active,
            deactivating,
            user,
            parameter_version,
            runs,
            panel,
            virtual_master,
        } = other;
        self.board.copy_from(board);
        self.axes.clone_from(axes);
        self.gantries.clone_from(gantries);
        self.analogs.clone_from(analogs);
        self.encoders.clone_from(encoders);
        self.slots.clone_from(slots);
        // The caller that gave a table or program frees it: only reference counts change here.
        self.tables.clone_from(tables);
        self.programs.clone_from(programs);
        self.order.clone_from(order);
        self.leads.copy_from(leads);
        self.user.clone_from(user);
        // The caller that gave a trajectory frees it: only reference counts change here.
        self.runs.clone_from(runs);
        self.panel.clone_from(panel);
        self.virtual_master = *virtual_master;
        (self.cycle, self.overruns, self.next_event) = (*cycle, *overruns, *next_event);
        self.parameter_version = *parameter_version;
        (self.active, self.deactivating) = (*active, *deactivating);
    }
}
