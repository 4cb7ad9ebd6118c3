//! One vocabulary, whichever it is: a copy on which a step or a request is tried.

use super::amc::Amc;
use super::saia::Saia;
use super::wf::Wf;
use super::{Order, Problem, View};
use crate::event::Refusal;
use crate::parameter::{Row, Value};
use crate::state::Reference;

/// A copy of one.
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Vocabulary {
    Amc(Amc),
    Saia(Saia),
    Wf(Wf),
}

/// A parameter as a vocabulary has it from now on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Writes {
    /// Place of its row.
    pub row: u16,
    /// Its value.
    pub value: Value,
    /// What `reference` shows by it, where the vocabulary owns the axis.
    pub reference: Reference,
}

/// What a step asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Asked {
    /// What the axis has to do.
    pub order: Option<Order>,
    /// What could not be asked of the axis at all.
    pub problem: Option<Problem>,
    /// What it writes, where that is its own to write.
    pub writes: Option<Writes>,
}

impl Asked {
    fn of(order: Option<Order>) -> Self {
        Self { order, problem: None, writes: None }
    }
}

impl Vocabulary {
    /// One step at t_k, after the commands of the cycle.
    pub(crate) fn step(&mut self, view: &View<'_>) -> Asked {
        match self {
            Self::Amc(amc) => {
                let step = amc.step(view);
                Asked { order: step.order, problem: step.problem, writes: Some(Self::written(step.select)) }
            }
            Self::Saia(saia) => Asked::of(saia.step(view)),
            Self::Wf(wf) => Asked::of(wf.step(view)),
        }
    }

    /// The axis could not do what the step asked. Gives what is written then, and another order.
    pub(crate) fn order_failed(
        &mut self,
        before: Option<&Self>,
        asked: &Asked,
        view: &View<'_>,
        refusal: Refusal,
    ) -> (Option<Writes>, Option<Order>) {
        match (self, before) {
            (Self::Amc(amc), Some(Self::Amc(before))) => {
                let (select, stop) = match asked.order {
                    Some(Order::Home) if before.waits() => (amc.give_up(), None),
                    _ => amc.order_failed(before, view, refusal.code),
                };
                (Some(Self::written(select)), stop)
            }
            (Self::Saia(saia), _) => {
                saia.order_failed(refusal);
                (None, None)
            }
            (Self::Wf(wf), _) => {
                wf.order_failed(refusal);
                (None, None)
            }
            (Self::Amc(_), _) => (None, None),
        }
    }

    /// What the order of the step has made of the motion.
    pub(crate) fn follow(&mut self, view: &View<'_>) {
        if let Self::Amc(amc) = self {
            amc.follow_input(view);
        }
    }

    /// Does homing that it asked for wait for the axis to stand?
    pub(crate) fn waits(&self) -> bool {
        matches!(self, Self::Amc(amc) if amc.waits())
    }

    /// Did a velocity stay in force since that one?
    pub(crate) fn keeps_speed(&self, before: &Self) -> bool {
        matches!((self, before), (Self::Amc(amc), Self::Amc(before)) if amc.keeps_speed(before))
    }

    /// The homing that it asked for is done. Gives its last order and what it writes.
    pub(crate) fn end_homing(&mut self, view: &View<'_>) -> (Option<Order>, Option<Writes>) {
        match self {
            Self::Amc(amc) => (Some(amc.end_homing(view)), Some(Self::written(0))),
            Self::Saia(_) | Self::Wf(_) => (None, None),
        }
    }

    /// The reference that is selected from now on.
    pub(super) fn written(select: i64) -> Writes {
        let row = const { Row::place("amc.reference_select") };
        Writes { row, value: Value::Int(select), reference: Reference::selected(select) }
    }
}
