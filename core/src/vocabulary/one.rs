//! A single vocabulary of any type: a copy on which a step or a request is tried.

use super::amc::Amc;
use super::saia::Saia;
use super::wf::Wf;
use super::{Order, Problem, View};
use crate::event::Refusal;
use crate::parameter::{Row, Value};
use crate::state::Reference;

/// A copy of one vocabulary.
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Vocabulary {
    Amc(Amc),
    Saia(Saia),
    Wf(Wf),
}

/// A parameter that a vocabulary has changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParameterChange {
    /// Index of its row.
    pub row: u16,
    /// New value.
    pub value: Value,
    /// Value of `reference`, if the vocabulary owns the axis.
    pub reference: Reference,
}

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepResult {
    /// Order to the axis.
    pub order: Option<Order>,
    /// Error that prevents an order.
    pub problem: Option<Problem>,
    /// Parameter to write, if it belongs to the vocabulary.
    pub writes: Option<ParameterChange>,
}

impl StepResult {
    fn of(order: Option<Order>) -> Self {
        Self { order, problem: None, writes: None }
    }
}

impl Vocabulary {
    /// Executes one step at t_k, after the commands of the cycle.
    pub(crate) fn step(&mut self, view: &View<'_>) -> StepResult {
        match self {
            Self::Amc(amc) => {
                let step = amc.step(view);
                StepResult {
                    order: step.order,
                    problem: step.problem,
                    writes: Some(Self::selection_change(step.select)),
                }
            }
            Self::Saia(saia) => StepResult::of(saia.step(view)),
            Self::Wf(wf) => StepResult::of(wf.step(view)),
        }
    }

    /// Handles an order that the axis rejected. Returns the parameter to write, and another order.
    pub(crate) fn order_failed(
        &mut self,
        before: Option<&Self>,
        asked: &StepResult,
        view: &View<'_>,
        refusal: Refusal,
    ) -> (Option<ParameterChange>, Option<Order>) {
        match (self, before) {
            (Self::Amc(amc), Some(Self::Amc(before))) => {
                let (select, stop) = match asked.order {
                    Some(Order::Home) if before.waits_for_rest() => (amc.give_up(), None),
                    _ => amc.order_failed(before, view, refusal.code),
                };
                (Some(Self::selection_change(select)), stop)
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

    /// Updates the state after the order of the step has changed the motion.
    pub(crate) fn follow(&mut self, view: &View<'_>) {
        if let Self::Amc(amc) = self {
            amc.follow_input(view);
        }
    }

    /// Returns true if its homing waits for the axis to come to rest.
    pub(crate) fn waits(&self) -> bool {
        matches!(self, Self::Amc(amc) if amc.waits_for_rest())
    }

    /// Returns true if a velocity has been active since then.
    pub(crate) fn keeps_speed(&self, before: &Self) -> bool {
        matches!((self, before), (Self::Amc(amc), Self::Amc(before)) if amc.keeps_speed(before))
    }

    /// Handles the end of its homing. Returns the last order and the parameter to write.
    pub(crate) fn end_homing(&mut self, view: &View<'_>) -> (Option<Order>, Option<ParameterChange>) {
        match self {
            Self::Amc(amc) => (Some(amc.end_homing(view)), Some(Self::selection_change(0))),
            Self::Saia(_) | Self::Wf(_) => (None, None),
        }
    }

    /// Returns the change of the selected reference.
    pub(super) fn selection_change(select: i64) -> ParameterChange {
        let row = const { Row::place("amc.reference_select") };
        ParameterChange { row, value: Value::Int(select), reference: Reference::selected(select) }
    }
}
