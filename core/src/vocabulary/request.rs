//! What commands ask of a vocabulary, and what comes of that.

use super::{Order, Owner, saia, wf};
use crate::event::Refusal;
use crate::parameter::Value;

/// A verb of a vocabulary, for one axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Registers and command flags (SAIA-CMD).
    Saia(Box<saia::Request>),
    /// Mode and blocks (WF-MOD-01).
    Wf(Box<wf::Request>),
}

impl Request {
    /// The axis.
    pub fn axis(&self) -> u16 {
        match self {
            Self::Saia(request) => request.axis,
            Self::Wf(request) => request.axis,
        }
    }

    /// Whose verb it is.
    pub(crate) fn owner(&self) -> Owner {
        match self {
            Self::Saia(_) => Owner::Saia,
            Self::Wf(_) => Owner::Wf,
        }
    }

    /// The parameters that it writes, by the places of their rows.
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

/// What a request did.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// What it asks of the axis.
    pub order: Option<Order>,
    /// The motion of its start, where that waits for the drive.
    pub coming: Option<Order>,
    /// Why it does something else than it was asked for.
    pub warning: Option<Refusal>,
    /// Why parts of it were not done, in their order.
    pub errors: [Option<Refusal>; saia::MOST],
}

impl Outcome {
    /// An order, and nothing to tell.
    pub(super) fn of(order: Option<Order>) -> Self {
        Self { order, coming: None, warning: None, errors: [None; saia::MOST] }
    }
}
