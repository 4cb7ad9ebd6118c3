//! The master of an axis: selected by parameters (MENCODERTYPE), the simulated master, and its displayed position.
//!
//! Law      simulated: position(k) = position(k-1) + master_simulation_velocity * T, to 2^-32 inc per cycle. It counts
//!          from 0 as long as mencodertype is 6, also without followers, and stops otherwise.
//!          displayed position = position of the leader + offset. A new zero of a leading axis is no motion: the
//!          displayed position continues from its former value, also if the axis is a member of a sum, with its sign. A
//!          new value of an encoder applies to all its users. Another leader is shown with its own position, or
//!          continues from that of the former leader (MENCCONTROL bit 0)
//! Reads    mencodertype, master_simulation_velocity, menccontrol, mencoder, the ratio
//! Writes   a leader that is not counted, so it is as smooth as a command; the displayed position of the leader
//! Refuses  numbers of masters that do not exist; a new value for a lost leader, or an absolute encoder
//! Source   MACS-ENC-10, -11, -14, -15, -16, A-13, MACS-CMD-17, MACS-UNIT-09, MACS-ERR-09

use crate::axis::state::master_view::master_unit;
use crate::axis::state::{Axis, Claim, Context, MasterView, Pace};
use crate::code::Code;
use crate::command::MasterPosition;
use crate::encoder::Lead;
use crate::encoder::source::Master;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::{Leader, Object};
use crate::parameter::{AxisParameters, Row, Value};
use crate::position::Position;
use crate::sync::Leads;

/// Checks whether the parameters of axis `own` of `axes` name an existing master; the cell has `encoders` encoders.
///
/// # Errors
/// MENCODERTYPE names the axis itself, or a master that the cell does not have (MACS-ENC-14, A-13).
pub fn may_name(own: usize, axes: usize, encoders: usize, p: &AxisParameters) -> Result<(), (&'static str, Code)> {
    let wrong = match Master::decode(p.encoder.mencodertype) {
        Some(Master::Axis(number)) if usize::from(number) == own.saturating_add(1) => Code::LEADER_LOOP,
        Some(Master::Axis(number)) if usize::from(number) > axes => Code::NO_MASTER,
        Some(Master::Terminal(number)) if usize::from(number) > encoders => Code::ENCODER_NO_TERMINAL,
        _ => return Ok(()),
    };
    Err(("mencodertype", wrong))
}

/// Displayed values of the master, in increments or master units.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::axis) struct Shown {
    pub position: f64,
    pub velocity: f64,
}

impl Axis {
    /// Returns the leader that a command names with `asked`, or MENCODERTYPE; the machine has `axes` axes.
    ///
    /// # Errors
    /// MENCODERTYPE names nothing that the cell has.
    pub fn leader_of(&self, asked: Option<Leader>, axes: usize) -> Result<Leader, Refusal> {
        let kind = self.parameters.encoder.mencodertype;
        let named = match self.parameters.derived.master {
            Some(Master::Axis(number)) if usize::from(number) <= axes => number.checked_sub(1).map(Leader::AxisCommand),
            Some(Master::Terminal(number)) if usize::from(number) <= self.setup.encoders => {
                number.checked_sub(1).map(|place| Leader::Encoder(place.into()))
            }
            Some(Master::Simulation) => Some(Leader::Simulated(self.setup.index)),
            _ => None,
        };
        let refusal = || self.refuse(Code::NO_MASTER).with(Number::Count(kind), Number::None);
        asked.or(named).ok_or_else(refusal)
    }

    /// Returns the leader that the axis follows, or may follow.
    fn displayed_leader(&self, axes: usize) -> Result<Leader, Refusal> {
        self.leader().map_or_else(|| self.leader_of(self.master(), axes), Ok)
    }

    /// Whether the axis displays a master.
    pub(in crate::axis) fn shows_a_master(&self, axes: usize) -> bool {
        self.displayed_leader(axes).is_ok() || self.sources.master().claim.is_some()
    }

    /// Whether the axis has displayed a master.
    #[inline]
    pub fn has_displayed_master(&self) -> bool {
        self.sources.master().leader.is_some()
    }

    /// Returns the encoder that a new value of its master would move for all users (MACS-ENC-11).
    pub fn shares_master(&self, axes: usize) -> Option<u16> {
        match self.displayed_leader(axes) {
            Ok(Leader::Encoder(place)) if self.parameters.encoder.menccontrol & 2 == 0 => Some(place),
            _ => None,
        }
    }

    /// Updates the displayed values of its master in this cycle; none without master.
    pub(in crate::axis) fn watch_master(&mut self, leads: &Leads) -> Option<Shown> {
        let leader = self.displayed_leader(leads.axes()).ok()?;
        let lead = leads.get(leader);
        if self.sources.master().leader != Some(leader) {
            let is_soft = self.sources.master().leader.is_some() && self.parameters.encoder.menccontrol & 1 == 1;
            let offset = if is_soft { self.sources.master().last - lead.position } else { Position::ZERO };
            let view = self.sources.master_mut();
            *view = MasterView { leader: Some(leader), offset, claim: None, ..*view };
        }
        self.sources.master_mut().last = lead.position + self.sources.master().offset;
        // Multiplication comes first, so that whole turns of the master stay whole units. A negative ratio makes -0.0
        // of 0, so 0.0 is added.
        let (increments, units) = master_unit(&self.parameters);
        let shown = |value: f64| value * units / increments;
        let position = self.parameters.derived.grid.decimal(shown(self.sources.master().last.to_f64()));
        Some(Shown { position: position + 0.0, velocity: shown(lead.velocity) + 0.0 })
    }

    /// Continues the displayed position when the coordinate of axis `axis` increases by `by` (MACS-ENC-15).
    pub fn continue_with_axis(&mut self, leads: &Leads, axis: u16, by: Position) {
        let is_its_own = |leader| matches!(leader, Leader::AxisCommand(of) | Leader::AxisActual(of) if of == axis);
        self.subtract_from_view(leads, by, is_its_own);
    }

    /// Continues the displayed position when the sink of a function is set to a new position.
    pub fn continue_with_sink(&mut self, leads: &Leads, slot: u16, by: Position) {
        self.subtract_from_view(leads, by, |leader| leader == Leader::Sink(slot));
    }

    /// Subtracts `by` from the displayed position for leaders for which `holds` is true.
    fn subtract_from_view(&mut self, leads: &Leads, by: Position, holds: impl Fn(Leader) -> bool) {
        if let Some(leader) = self.sources.master().leader {
            self.sources.master_mut().offset = self.sources.master().offset - leads.share(leader, by, holds);
        }
    }

    /// Sets the displayed position of the master (DEFMORIGIN, SETMORIGIN).
    pub(in crate::axis) fn set_master_position(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        position: MasterPosition,
    ) -> Result<(), Refusal> {
        let axes = cx.leads.axes();
        let leader = self.displayed_leader(axes)?;
        let encoder = match leader {
            Leader::Encoder(place) => cx.encoders.get(usize::from(place)).map(|encoder| (place, encoder)),
            _ => None,
        };
        if let Some((place, _)) = encoder.filter(|(_, encoder)| encoder.is_absolute()) {
            return Err(Refusal::new(Code::MASTER_ZERO_STANDS, Object::Encoder(place)));
        }
        if !cx.leads.get(leader).valid {
            return Err(self.refuse(Code::LEADER_LOST));
        }
        if matches!(position, MasterPosition::Shown(value) if !value.is_finite()) {
            return Err(self.refuse(Code::BAD_NUMBER));
        }
        let wanted = match position {
            MasterPosition::Increments(length) => length.exact(),
            MasterPosition::Shown(value) => {
                let (increments, units) = master_unit(&self.parameters);
                Position::from_f64(value * increments / units)
            }
        };
        if !wanted.is_legal() {
            return Err(self
                .refuse(Code::POSITION_OUT_OF_RANGE)
                .with(Number::Position(wanted.nearest()), Number::None));
        }
        let event = Event::new(Severity::Info, Kind::Accepted, self.object(), Code::NONE);
        cx.events.push(event.of_command(sequence));
        self.watch_master(cx.leads);
        let by = wanted - self.sources.master().last;
        self.sources.master_mut().offset += by;
        if encoder.is_some() {
            let claim = Claim { sequence, by: by.floor(), is_soft: self.shares_master(axes).is_none() };
            self.sources.master_mut().claim = Some(claim.after(self.sources.master().claim));
        }
        Ok(())
    }

    /// Returns its new zero of this cycle if its leader is that encoder.
    pub(in crate::axis) fn master_claim(&self, encoder: u16) -> Option<Claim> {
        self.sources.master().claim.filter(|_| self.sources.master().leader == Some(Leader::Encoder(encoder)))
    }

    pub(in crate::axis) fn forget_master_claim(&mut self) {
        self.sources.master_mut().claim = None;
    }

    /// Notes that the leading encoder was moved: the displayed position stays.
    pub fn share_master(&mut self, by: i64) {
        self.sources.master_mut().offset = self.sources.master().offset - Position::whole(by);
    }

    /// Advances its simulated master by one cycle.
    #[inline]
    pub fn simulate_master(&self, lead: &mut Lead) {
        let velocity = self.parameters.encoder.master_velocity;
        if self.parameters.derived.master == Some(Master::Simulation) {
            let change = Position::from_f64(velocity * self.cycle_s());
            *lead = Lead { position: lead.position + change, change, velocity, uneven: 0.0, valid: true };
        } else if self.pace() == Pace::Full {
            // A full cycle sets the velocity to 0.
            *lead = Lead { position: lead.position, ..Lead::default() };
        }
    }

    /// Stops it after an abort (MACS-ERR-09).
    pub(in crate::axis) fn stop_simulated_master(&mut self, cx: &mut Context<'_>) {
        if self.parameters.encoder.master_velocity == 0.0 {
            return;
        }
        let row = const { Row::place("master_simulation_velocity") };
        self.write_own(cx, None, std::iter::once((row, Value::Real(0.0))));
    }
}
