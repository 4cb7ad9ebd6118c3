//! Parameter changes at run time: sets, layers, power cycle.
//!
//! Law      A set applies as a whole or not at all. Its values are checked together, against each other and against the
//!          active motions. Their order does not matter
//! Refuses  values outside their range, values of functions that do not exist, values of the structure; contradictory
//!          sets
//! Source   MACS-STO-02..08

use super::Machine;
use crate::axis::{may_carry, may_name};
use crate::code::Code;
use crate::command::Command;
use crate::config::{IoCounts, NoSuchIo, OutputShared, max_velocity_of_cycle};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::function::Slot;
use crate::object::{AxisSet, Object};
use crate::parameter::{
    AxisParameters, Change, Contradiction, Effect, Layer, MACHINE, MachineParameters, ParameterImage, ROWS, Refused,
    Row, Value, in_order,
};

impl Machine {
    /// Sets all of the changes, or none.
    pub(super) fn set_parameters(&mut self, command: &Command, changes: &[Change]) -> Result<(), Refusal> {
        let missing = Refusal::new(Code::BAD_REQUEST, Object::Machine);
        let mut machine = self.state.panel.parameters;
        for change in changes.iter().filter(|change| change.axis != MACHINE) {
            let axis = self.state.axes.get(usize::from(change.axis)).ok_or(missing)?;
            self.candidates[usize::from(change.axis)] = *axis.parameters;
        }
        for change in in_order(changes) {
            let row = change.row().ok_or(missing)?;
            let result = match self.candidates.get_mut(usize::from(change.axis)) {
                Some(candidate) => row.change(candidate, change.value),
                None => row.assign_to_machine(&mut machine, change.value),
            };
            result.map_err(|refused| refusal_of(change, refused))?;
            self.check_may_change_now(change, row)?;
        }
        changes.iter().try_for_each(|change| self.check_single_view(change))?;
        self.check_machine(changes, &machine)?;
        for change in changes.iter().filter(|change| change.axis != MACHINE) {
            self.check_candidate(usize::from(change.axis), changes)?;
        }
        self.check_functions(machine.o_error, |index| changes.iter().any(|change| usize::from(change.axis) == index))?;
        for change in changes.iter().filter(|change| change.axis != MACHINE) {
            let index = usize::from(change.axis);
            self.put_in_force(index, self.candidates[index]);
        }
        self.state.panel.parameters = machine;
        self.apply_to_virtual_master(changes);
        self.count_change();
        self.accept(command, changes.first().map_or(Object::Machine, Change::object));
        changes.iter().for_each(|change| self.report_parameter(command, change));
        Ok(())
    }

    /// Saves the parameters that are in force (MACS-STO-06).
    pub(super) fn save_parameters(&mut self, command: &Command, axes: AxisSet) -> Result<(), Refusal> {
        self.check_axes(axes)?;
        self.check_kept_functions(axes)?;
        for index in axes.iter().map(usize::from) {
            let kept = self.state.axes[index].parameters_to_keep();
            self.state.user[index] = kept.saved(&self.config.axes[index].parameters);
        }
        if self.are_all(axes) {
            self.state.panel.user = self.state.panel.parameters.saved(&self.config.global.parameters);
        }
        self.count_change();
        self.accept(command, Object::Machine);
        Ok(())
    }

    /// Restores a layer (MACS-STO-03..05).
    pub(super) fn reset_parameters(&mut self, command: &Command, axes: AxisSet, layer: Layer) -> Result<(), Refusal> {
        self.check_axes(axes)?;
        for index in axes.iter().map(usize::from) {
            let layer = match layer {
                Layer::User => self.state.user[index],
                Layer::Init => self.config.axes[index].parameters,
            };
            self.candidates[index] = self.state.axes[index].kept_parameters(layer);
        }
        for index in axes.iter().map(usize::from) {
            self.check_reset(index)?;
        }
        let o_error = match layer {
            _ if !self.are_all(axes) => self.state.panel.parameters.o_error,
            Layer::User => self.state.panel.user.o_error,
            Layer::Init => self.config.global.parameters.o_error,
        };
        self.check_functions(o_error, |index| axes.contains(index as u16))?;
        self.count_change();
        self.accept(command, Object::Machine);
        for index in axes.iter() {
            let new = self.candidates[usize::from(index)];
            let old = *self.state.axes[usize::from(index)].parameters;
            self.put_in_force(usize::from(index), new);
            for (row, entry) in ROWS.iter().enumerate().filter(|(_, row)| row.is_stored()) {
                let value = entry.value(&new);
                if value != entry.value(&old) {
                    self.report_parameter(command, &Change { axis: index, row: row as u16, value });
                }
            }
        }
        if self.are_all(axes) {
            self.reset_machine(command, layer);
        }
        Ok(())
    }

    /// Deletes the saved parameters: those of the cell are in force again (MACS-STO-03).
    pub(super) fn delete_parameters(&mut self, command: &Command, axes: AxisSet) -> Result<(), Refusal> {
        self.reset_parameters(command, axes, Layer::Init)?;
        for index in axes.iter().map(usize::from) {
            self.state.user[index] = self.config.axes[index].parameters;
        }
        if self.are_all(axes) {
            self.state.panel.user = self.config.global.parameters;
        }
        Ok(())
    }

    /// Sets the machine to its state after power-on: layer User is in force, positions start again (MACS-STO-04,
    /// MACS-STO-05).
    pub(super) fn power_cycle(&mut self, command: &Command) -> Result<(), Refusal> {
        if let Some(index) = self.state.axes.iter().position(|axis| !axis.may_lose_power()) {
            return Err(Refusal::new(Code::NOT_DISABLED, Object::Axis(index as u16)));
        }
        self.accept(command, Object::Machine);
        self.state.axes.iter_mut().for_each(|axis| axis.lose_touch_probes(&mut self.events));
        self.state.power_up_from(&self.first);
        self.power_up_virtual_master();
        self.count_change();
        Ok(())
    }

    /// Returns all parameters, for clients that show and store them.
    pub fn parameter_image(&self) -> ParameterImage {
        let mut image = ParameterImage {
            version: self.state.parameter_version,
            effective: self.candidates.clone(),
            user: self.state.user.clone(),
            functions: self.state.slots.iter().map(Slot::sets).collect(),
            tables: self.state.tables.clone(),
            ..ParameterImage::default()
        };
        self.copy_parameters(&mut image);
        image
    }

    /// Updates an image of this machine. It allocates no memory.
    pub fn copy_parameters(&self, image: &mut ParameterImage) {
        image.version = self.state.parameter_version;
        image.machine = [self.state.panel.parameters, self.state.panel.user];
        for (copy, axis) in image.effective.iter_mut().zip(&self.state.axes) {
            *copy = *axis.parameters;
        }
        for (copy, user) in image.user.iter_mut().zip(&self.state.user) {
            *copy = *user;
        }
        for (copy, slot) in image.functions.iter_mut().zip(&self.state.slots) {
            slot.copy_sets(copy);
        }
        // The caller that gave a table keeps a reference until no other reference exists, including images; so nothing
        // is freed here.
        for (copy, table) in image.tables.iter_mut().zip(&self.state.tables) {
            copy.clone_from(table);
        }
    }

    /// Returns the value in force of the parameter at index `row` of [`ROWS`], of an axis or of [`MACHINE`]. Returns
    /// [`Value::Unset`] for a parameter that is not set.
    pub fn parameter(&self, axis: u16, row: u16) -> Value {
        let Some(entry) = ROWS.get(usize::from(row)) else { return Value::Unset };
        if axis == MACHINE {
            return entry.machine_value(&self.state.panel.parameters);
        }
        self.state.axes.get(usize::from(axis)).map_or(Value::Unset, |axis| entry.value(&axis.parameters))
    }

    /// Returns a counter that increases with every change of a parameter or layer.
    pub fn parameter_version(&self) -> u64 {
        self.state.parameter_version
    }

    /// Applies a set to an axis. If the set inverts its direction, the axis stays in place and the followers of its
    /// command see no motion.
    fn put_in_force(&mut self, index: usize, parameters: AxisParameters) {
        if self.state.axes[index].take_parameters(parameters) {
            let leads = &mut self.state.leads;
            let Some(of) = leads.of_axes.get_mut(index) else { return };
            let before = of.command.position;
            of.command.position = -before;
            of.actual.position = self.state.axes[index].actual().position;
            self.keep_master_positions(index, -before - before);
        }
    }

    /// Whether these are all axes. If so, saving and reset also apply to the machine.
    fn are_all(&self, axes: AxisSet) -> bool {
        axes.iter().count() == self.state.axes.len()
    }

    fn reset_machine(&mut self, command: &Command, layer: Layer) {
        let new = match layer {
            Layer::User => self.state.panel.user,
            Layer::Init => self.config.global.parameters,
        };
        let old = std::mem::replace(&mut self.state.panel.parameters, new);
        self.reset_virtual_master();
        for (row, entry) in ROWS.iter().enumerate().filter(|(_, row)| row.is_kept_by_machine()) {
            let value = entry.machine_value(&new);
            if value != entry.machine_value(&old) {
                self.report_parameter(command, &Change { axis: MACHINE, row: row as u16, value });
            }
        }
    }

    /// Checks the values of the machine in a set: each value is given once, and refers only to existing inputs and
    /// outputs.
    fn check_machine(&self, changes: &[Change], candidate: &MachineParameters) -> Result<(), Refusal> {
        let of_machine = || changes.iter().filter(|change| change.axis == MACHINE);
        for change in of_machine() {
            let Some(row) = change.row() else { continue };
            let other = Change { value: row.machine_value(candidate), ..*change };
            if other.value != change.value {
                return Err(refusal_of_change(change, Code::GIVEN_TWICE).with(change.number(), other.number()));
            }
        }
        if of_machine().next().is_none() {
            return Ok(());
        }
        let counts = IoCounts::of(&self.config);
        counts.check_machine(candidate).map_err(|missing| no_such_io(MACHINE, missing))?;
        self.admit_virtual_master(changes, candidate)
    }

    /// Checks that each output has one function if the candidates of some axes come into force.
    fn check_functions(&self, o_error: i64, is_new: impl Fn(usize) -> bool) -> Result<(), Refusal> {
        let of = |index: usize| {
            let now: &AxisParameters = &self.state.axes[index].parameters;
            if is_new(index) { self.candidates[index].output_functions() } else { now.output_functions() }
        };
        self.config.check_functions(o_error, of, &is_new).map_err(shared_output)
    }

    /// Checks that each output would also have one function after a power cycle, if these axes save their parameters.
    fn check_kept_functions(&self, axes: AxisSet) -> Result<(), Refusal> {
        let panel = &self.state.panel;
        let machine = if self.are_all(axes) { &panel.parameters } else { &panel.user };
        let of = |index: usize| {
            let saves = axes.contains(index as u16);
            let kept = if saves { &*self.state.axes[index].parameters } else { &self.state.user[index] };
            kept.output_functions()
        };
        let is_new = |index: usize| axes.contains(index as u16);
        self.config.check_functions(machine.o_error, of, is_new).map_err(shared_output)
    }

    pub(super) fn count_change(&mut self) {
        self.state.parameter_version = self.state.parameter_version.wrapping_add(1);
    }

    /// Checks that all of these axes exist.
    pub(super) fn check_axes(&self, axes: AxisSet) -> Result<(), Refusal> {
        if axes.iter().any(|axis| usize::from(axis) >= self.state.axes.len()) {
            return Err(Refusal::new(Code::BAD_REQUEST, Object::Machine));
        }
        Ok(())
    }

    fn report_parameter(&mut self, command: &Command, change: &Change) {
        let event = Event::new(Severity::Info, Kind::Parameter, change.object(), Code::NONE);
        let event = event.of_command(command.sequence).with(change.number(), Number::None);
        self.events.push(Event { parameter: Some(change.row), ..event });
    }

    /// Checks that a parameter may change now.
    fn check_may_change_now(&self, change: &Change, row: &Row) -> Result<(), Refusal> {
        let Some(axis) = self.state.axes.get(usize::from(change.axis)) else { return Ok(()) };
        let is_new = row.value(&self.candidates[usize::from(change.axis)]) != row.value(&axis.parameters);
        if row.effect == Effect::Disabled && is_new && !axis.is_idle() {
            return Err(refusal_of_change(change, Code::NOT_DISABLED));
        }
        Ok(())
    }

    /// Checks that a set contains no second view of the same value, which would make its order matter.
    fn check_single_view(&self, change: &Change) -> Result<(), Refusal> {
        let (Some(row), Some(candidate)) = (change.row(), self.candidates.get(usize::from(change.axis))) else {
            return Ok(());
        };
        if candidate.has_value(row, change.value) {
            return Ok(());
        }
        let other = Change { value: row.value(candidate), ..*change };
        Err(refusal_of_change(change, Code::GIVEN_TWICE).with(change.number(), other.number()))
    }

    /// Checks that the whole set of an axis is consistent, in itself and with the state of the axis.
    fn check_candidate(&self, index: usize, changes: &[Change]) -> Result<(), Refusal> {
        let super::State { axes, cycle, leads, tables, .. } = &self.state;
        axes[index].admits_vocabularies(&self.candidates[index], *cycle, (leads, tables))?;
        let candidate = &self.candidates[index];
        self.state.axes[index].check_sense(candidate)?;
        self.state.axes[index].admits_source(candidate)?;
        self.check_master_exists(index)?;
        self.check_drive_capabilities(index)?;
        self.check_two_drives(index)?;
        self.state.axes[index].admits_zero(candidate)?;
        IoCounts::of(&self.config).check_axis(candidate).map_err(|missing| no_such_io(index as u16, missing))?;
        let of_axis = || changes.iter().filter(|change| usize::from(change.axis) == index);
        let is = |change: &Change, key: &str| change.row().is_some_and(|row| row.key == key || row.root() == key);
        // Blames a change of one of the two parameters, otherwise the first change of the axis, because the conflict
        // results from it.
        let guilty = |keys: [&str; 2]| {
            let named = of_axis().find(|change| keys.iter().any(|&key| is(change, key)));
            named.or_else(|| of_axis().next()).copied()
        };
        if let Err(contradiction) = candidate.check() {
            let keys = match contradiction {
                Contradiction::Above(low, high) => [low, high],
                Contradiction::OutOfRange(key) => {
                    let change = Change { axis: index as u16, row: find(key), value: Value::Unset };
                    let change = Change { value: value_of(&change, candidate), ..change };
                    return Err(refusal_of_change(&change, Code::PARAMETER_OUT_OF_RANGE));
                }
                Contradiction::NotBuilt(key, code) => {
                    let change = Change { axis: index as u16, row: find(key), value: Value::Unset };
                    return Err(refusal_of_change(&Change { value: value_of(&change, candidate), ..change }, code));
                }
            };
            let other = |change: &Change| match change.row().map(|row| row.key) {
                // In inverted units the native limits are swapped.
                Some("neglimit" | "swneglimact") => "poslimit",
                Some("poslimit" | "swposlimact") => "neglimit",
                _ if is(change, keys[0]) => keys[1],
                _ => keys[0],
            };
            return Err(guilty(keys).map_or(Refusal::new(Code::PARAMETERS_CONTRADICT, Object::Machine), |change| {
                let limit = Change { row: find(other(&change)), ..change };
                let limit = Change { value: value_of(&limit, candidate), ..limit };
                refusal_of_change(&change, Code::PARAMETERS_CONTRADICT).with(change.number(), limit.number())
            }));
        }
        let highest = max_velocity_of_cycle(self.config.cycle_ns);
        let is_new = candidate.max_velocity != self.state.axes[index].parameters.max_velocity;
        if is_new && candidate.max_velocity > highest {
            let change = guilty(["max_velocity"; 2]);
            return Err(change.map_or(Refusal::new(Code::PARAMETER_OUT_OF_RANGE, Object::Machine), |change| {
                refusal_of_change(&change, Code::PARAMETER_OUT_OF_RANGE)
                    .with(change.number(), Number::Velocity(highest))
            }));
        }
        match self.position_outside_limits(index) {
            Some(place) => Err(guilty(["min_position", "max_position"]).map_or(
                Refusal::new(Code::GOAL_BEYOND_NEW_LIMITS, Object::Machine),
                |change| {
                    refusal_of_change(&change, Code::GOAL_BEYOND_NEW_LIMITS)
                        .with(change.number(), Number::Position(place))
                },
            )),
            None => Ok(()),
        }
    }

    /// Checks that a layer may be restored on an axis.
    fn check_reset(&self, index: usize) -> Result<(), Refusal> {
        let (axis, candidate) = (&self.state.axes[index], &self.candidates[index]);
        let refuse = |row, code| {
            let change = Change { axis: index as u16, row, value: Value::Unset };
            let change = Change { value: value_of(&change, candidate), ..change };
            refusal_of_change(&change, code)
        };
        let starting = candidate.vocabularies.starts_motion(&axis.parameters.vocabularies);
        if let Some(row) = starting.filter(|_| !axis.is_idle()) {
            return Err(refuse(row, Code::NOT_DISABLED));
        }
        let changes_now = |row: &&Row| row.effect == Effect::Disabled && row.is_stored();
        let differs = |row: &&Row| row.value(candidate) != row.value(&axis.parameters);
        if let Some(row) = ROWS.iter().position(|row| changes_now(&row) && differs(&row))
            && !axis.is_idle()
        {
            return Err(refuse(row as u16, Code::NOT_DISABLED));
        }
        axis.admits_vocabularies(candidate, self.state.cycle, (&self.state.leads, &self.state.tables))?;
        axis.check_sense(candidate)?;
        axis.admits_source(candidate)?;
        self.check_master_exists(index)?;
        self.check_drive_capabilities(index)?;
        self.check_two_drives(index)?;
        axis.admits_zero(candidate)?;
        match self.position_outside_limits(index) {
            Some(place) => {
                let is_low = candidate.min_position.is_some_and(|low| place < low);
                let [low, high] = const { [Row::place("min_position"), Row::place("max_position")] };
                let refusal = refuse(if is_low { low } else { high }, Code::GOAL_BEYOND_NEW_LIMITS);
                Err(refusal.with(refusal.asked, Number::Position(place)))
            }
            None => Ok(()),
        }
    }

    /// Checks that the master that the candidate names exists in the cell.
    fn check_master_exists(&self, index: usize) -> Result<(), Refusal> {
        let candidate = &self.candidates[index];
        may_name(index, self.state.axes.len(), self.state.encoders.len(), candidate).map_err(|(key, code)| {
            let change = Change { axis: index as u16, row: find(key), value: Value::Unset };
            refusal_of_change(&Change { value: value_of(&change, candidate), ..change }, code)
        })
    }

    /// Checks that the drive offers what the candidate requires.
    fn check_drive_capabilities(&self, index: usize) -> Result<(), Refusal> {
        let offers = self.config.axes.get(index).and_then(|axis| axis.drive);
        if !self.candidates[index].homing.in_drive || offers.is_none_or(|offers| offers.homes) {
            return Ok(());
        }
        let change = Change { axis: index as u16, row: const { Row::place("homing.in_drive") }, value: Value::Int(1) };
        Err(refusal_of_change(&change, Code::HOMING_NOT_OFFERED))
    }

    /// Checks that the candidate is allowed for an axis with two drives.
    fn check_two_drives(&self, index: usize) -> Result<(), Refusal> {
        let Some(axis) = self.config.axes.get(index).filter(|axis| axis.second.is_some()) else { return Ok(()) };
        let candidate = &self.candidates[index];
        may_carry(axis.wired, candidate).map_err(|(key, code)| {
            let change = Change { axis: index as u16, row: find(key), value: Value::Unset };
            refusal_of_change(&Change { value: value_of(&change, candidate), ..change }, code)
        })
    }

    /// Returns a position that the active motion reaches and that would be outside new limits.
    fn position_outside_limits(&self, index: usize) -> Option<i64> {
        let (axis, candidate) = (&self.state.axes[index], &self.candidates[index]);
        let inside = |end: i64| {
            candidate.min_position.is_none_or(|low| end >= low) && candidate.max_position.is_none_or(|high| end <= high)
        };
        let limits = |p: &AxisParameters| (p.min_position, p.max_position);
        // While an axis returns from outside its limits, it accepts any other change.
        let reach = axis.reach().filter(|_| limits(candidate) != limits(&axis.parameters));
        reach.and_then(|(low, high)| [low, high].into_iter().find(|&place| !inside(place)))
    }
}

/// Returns the refusal of a parameter that names a missing input or output.
fn no_such_io(axis: u16, missing: NoSuchIo) -> Refusal {
    let change = Change { axis, row: find(missing.key), value: Value::Int(missing.number) };
    let code = if missing.is_output { Code::NO_SUCH_OUTPUT } else { Code::NO_SUCH_INPUT };
    refusal_of_change(&change, code).with(change.number(), Number::Count(missing.count as i64))
}

/// Returns the refusal of a parameter that names an output that already has another function.
fn shared_output(shared: OutputShared) -> Refusal {
    let (key, number) = shared.function;
    let change = Change { axis: shared.axis, row: find(key), value: Value::Int(number.saturating_abs()) };
    refusal_of_change(&change, Code::OUTPUT_SHARED)
}

/// Returns the index of a row that exists.
fn find(key: &str) -> u16 {
    Row::find(key).map_or(u16::MAX, |(row, _)| row)
}

fn value_of(change: &Change, parameters: &AxisParameters) -> Value {
    change.row().map_or(Value::Unset, |row| row.value(parameters))
}

fn refusal_of_change(change: &Change, code: Code) -> Refusal {
    let refusal = Refusal::new(code, change.object()).with(change.number(), Number::None);
    Refusal { parameter: Some(change.row), ..refusal }
}

fn refusal_of(change: &Change, refused: Refused) -> Refusal {
    refusal_of_change(
        change,
        match refused {
            Refused::NotBuilt => Code::NOT_BUILT,
            Refused::ReadOnly => Code::READ_ONLY,
            Refused::OutOfRange | Refused::WrongType => Code::PARAMETER_OUT_OF_RANGE,
        },
    )
}
