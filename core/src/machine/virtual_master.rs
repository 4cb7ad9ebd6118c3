//! Virtual master of a machine: its execution order, its start and end, its index count.
//!
//! Law      the virtual master moves before the axes, or after the axis that it follows, which moves before all axes
//!          that follow the virtual master. Slots read the values of the last cycle. Setting pulsvel starts it in the
//!          cycle of the set and applies vmenctyp; pulsacc 0, i_break and abort end it in their cycle
//! Refuses  a source that closes a loop, a start without a ramp
//! Source   MACS-VM-01..08, MACS-ERR-09

use super::{CycleInputs, Machine, State};
use crate::code::Code;
use crate::config::IoKind;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::{AxisSet, Object};
use crate::parameter::{Change, MACHINE, MachineParameters, Marker, Row, Value, VirtualMasterProblem};
use crate::sync::{VirtualMaster, VirtualSource};

const PULSVEL: u16 = Row::place("pulsvel");
const PULSACC: u16 = Row::place("pulsacc");
const SETSYS_15: u16 = Row::place("setsys_15");

fn names(changes: &[Change], row: u16) -> bool {
    changes.iter().any(|change| change.axis == MACHINE && change.row == row)
}

/// Whether a set starts the virtual master.
fn starts(changes: &[Change]) -> bool {
    names(changes, PULSVEL)
}

fn refusal(problem: &VirtualMasterProblem) -> Refusal {
    let row = Row::find(problem.key).map(|(row, _)| row);
    let [asked, limit] = [problem.value, problem.limit].map(Number::Count);
    Refusal { parameter: row, ..Refusal::new(problem.code, Object::Machine).with(asked, limit) }
}

impl Machine {
    /// Checks that these machine parameters are allowed for the virtual master.
    pub(super) fn admit_virtual_master(
        &self,
        changes: &[Change],
        candidate: &MachineParameters,
    ) -> Result<(), Refusal> {
        candidate.check_virtual_source(self.state.axes.len()).map_err(|problem| refusal(&problem))?;
        if !starts(changes) {
            return Ok(());
        }
        candidate.check_virtual_start(names(changes, PULSACC)).map_err(|problem| refusal(&problem))?;
        match self.state.virtual_master.source().after(candidate, true) {
            VirtualSource::Axis(axis) if self.leaders_of(AxisSet::one(axis), Some(axis)).contains(axis) => {
                Err(refusal(&VirtualMasterProblem {
                    key: "vmenctyp",
                    value: candidate.vmenctyp,
                    code: Code::LEADER_LOOP,
                    limit: 0,
                }))
            }
            _ => Ok(()),
        }
    }

    /// Applies new machine parameters, set by these changes, to the virtual master.
    pub(super) fn apply_to_virtual_master(&mut self, changes: &[Change]) {
        let source = self.state.virtual_master.source().after(&self.state.panel.parameters, starts(changes));
        self.set_virtual_source(source);
    }

    /// Applies the machine parameters of a restored layer. They start nothing, and without a start the virtual master
    /// follows no axis.
    pub(super) fn reset_virtual_master(&mut self) {
        let source = self.state.virtual_master.source().after_reset(&self.state.panel.parameters);
        self.set_virtual_source(source);
    }

    /// Ends the virtual master on an abort (MACS-ERR-09).
    #[cold]
    #[inline(never)]
    pub(super) fn stop_virtual_master(&mut self, sequence: Option<u64>) {
        let parameters = &mut self.state.panel.parameters;
        for (row, velocity) in [(PULSVEL, &mut parameters.pulsvel), (SETSYS_15, &mut parameters.setsys_15)] {
            if std::mem::take(velocity) != 0 {
                let event = Event::new(Severity::Info, Kind::Parameter, Object::Machine, Code::NONE);
                let event = sequence.map_or(event, |sequence| event.of_command(sequence));
                let number = Change { axis: MACHINE, row, value: Value::Int(0) }.number();
                self.events.push(Event { parameter: Some(row), ..event.with(number, Number::None) });
                self.state.parameter_version = self.state.parameter_version.wrapping_add(1);
            }
        }
        // A virtual master without a ramp stops together with its velocity, which is 0 now.
        if self.state.virtual_master.source() != VirtualSource::Direct {
            self.set_virtual_source(VirtualSource::Off);
        }
    }

    fn set_virtual_source(&mut self, source: VirtualSource) {
        let before = self.state.virtual_master.axis();
        if source == self.state.virtual_master.source() {
            return;
        }
        self.state.virtual_master.take(source, &mut self.state.leads.virtual_master);
        self.state.leads.virtual_mark = None;
        self.publish_virtual_master();
        if before != self.state.virtual_master.axis() {
            // From this cycle on, the axis that it follows moves before all axes that follow the virtual master.
            self.sort_axes();
        }
    }

    /// Sets the state after power-on.
    pub(super) fn power_up_virtual_master(&mut self) {
        self.state.virtual_master = VirtualMaster::new(&self.state.panel.parameters);
    }

    /// Starts the axes of a cycle with the virtual master switched on: the axes before it, the virtual master, and the
    /// others.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_axes_and_virtual_master(&mut self, told: CycleInputs<'_>) -> (bool, bool) {
        let State { virtual_master, order, .. } = &self.state;
        let followed = virtual_master.axis().and_then(|axis| order.iter().position(|&other| other == axis));
        let (ahead, count) = (followed.map_or(0, |place| place + 1), order.len());
        let first = self.begin_axes_at(0..ahead, told);
        self.move_virtual_master(told);
        let second = self.begin_axes_at(ahead..count, told);
        (first.0 && second.0, first.1 && second.1)
    }

    fn move_virtual_master(&mut self, told: CycleInputs<'_>) {
        let State { virtual_master, leads, panel, .. } = &mut self.state;
        let (parameters, cycle_ns) = (&panel.parameters, self.config.cycle_ns);
        let axis = virtual_master.axis().and_then(|axis| leads.of_axes.get(usize::from(axis)));
        let change = axis.map_or_else(Default::default, |of| of.command.change);
        let lead = &mut leads.virtual_master;
        let marks = virtual_master.count;
        virtual_master.step(parameters, change, cycle_ns, lead);
        match parameters.virtual_marker() {
            Marker::Index => virtual_master.count_pulses(parameters.vmencres, lead),
            Marker::Input { place, rising } => {
                let entry = self.digital_inputs.get(place).copied().unwrap_or(u16::MAX);
                let is_latching = |io: &crate::config::IoConfig| io.kind == IoKind::DigitalInput && io.latch;
                if self.config.io.get(usize::from(entry)).is_some_and(is_latching) {
                    let of_input = |latch: &&crate::vocabulary::LatchView| {
                        latch.object == Object::Io(entry) && latch.rising == rising
                    };
                    let ages = self.latched.iter().filter(of_input).map(|latch| latch.age_ns);
                    virtual_master.count_latches(ages, cycle_ns, lead);
                } else {
                    virtual_master.count_level(parameters, told.inputs.digital(place), lead);
                }
            }
        }
        // If there are several marks, the last one counts.
        leads.virtual_mark = (virtual_master.count != marks).then_some(virtual_master.mark);
        self.publish_virtual_master();
    }

    fn publish_virtual_master(&mut self) {
        let State { virtual_master, leads, board, .. } = &mut self.state;
        self.signals.publish_virtual_master(board, &leads.virtual_master, virtual_master);
    }
}
