//! Requests of commands to a vocabulary, and their outcomes.

use super::{Order, Owner, saia, wf};
use crate::event::Refusal;
use crate::parameter::Value;

/// A request to a vocabulary, for one axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Registers and command flags (SAIA-CMD).
    Saia(Box<saia::Request>),
    /// Mode and blocks (WF-MOD-01).
    Wf(Box<wf::Request>),
}

impl Request {
    /// Returns the axis.
    pub fn axis(&self) -> u16 {
        match self {
            Self::Saia(request) => request.axis,
            Self::Wf(request) => request.axis,
        }
    }

    /// Returns the vocabulary of the request.
    pub(crate) fn owner(&self) -> Owner {
        match self {
            Self::Saia(_) => Owner::Saia,
            Self::Wf(_) => Owner::Wf,
        }
    }

    /// Returns the parameters that it writes, by the indices of their rows.
    pub(crate) fn writes(&self) -> impl Iterator<Item = (u16, Value)> + Clone + '_ {
        let registers = match self {
            Self::Saia(request) => Some(request.registers()),
            Self::Wf(_) => None,
        };
        registers.into_iter().flatten().map(|(register, value)| (register.place(), value))
    }
}

impl From<saia::Request> for Request {
    fn from(request: saia::Request) -> Self {
        Self::Saia(Box::new(request))
    }
}

impl From<wf::Request> for Request {
    fn from(request: wf::Request) -> Self {
        Self::Wf(Box::new(request))
    }
}

/// Outcome of a request.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Order to the axis.
    pub order: Option<Order>,
    /// Motion of a start that waits for the drive.
    pub coming: Option<Order>,
    /// Reason why it does something else than requested.
    pub warning: Option<Refusal>,
    /// Errors of parts that were not executed, in their order.
    pub errors: [Option<Refusal>; saia::MOST],
}

impl Outcome {
    /// Returns an outcome with an order only.
    pub(super) fn of(order: Option<Order>) -> Self {
        Self { order, coming: None, warning: None, errors: [None; saia::MOST] }
    }
}
