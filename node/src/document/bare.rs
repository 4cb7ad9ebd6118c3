//! Numbers that were read without a unit although people read the axis in another unit than SI.
//!
//! Law      a reader of an axis starts the record, reads the axis, and takes the record. It has each length and angle,
//!          and each derivative of them, that the file gives as a number other than 0 without a unit

use super::Place;
use lineshaft_core::unit::{Dimension, Quantity, Scale};
use std::sync::Arc;

/// A number without a unit.
#[derive(Clone, Debug)]
pub(crate) struct BareNumber {
    pub(super) file: Arc<str>,
    pub(super) place: Place,
    pub(super) label: String,
    /// The number as written.
    pub(super) text: String,
    /// The number as read, in SI.
    pub(super) quantity: Quantity,
}

impl BareNumber {
    /// Returns a warning with the value as it was read; `None` if an axis of that scale is read in SI, and for a value
    /// of another kind, such as an angle of a linear axis.
    pub(crate) fn warning(&self, scale: &Scale) -> Option<String> {
        let Self { file, place: Place { line, col }, label, text, quantity } = self;
        let given = quantity.unit();
        let (Dimension::Length(order) | Dimension::Angle(order)) = given.dimension() else { return None };
        let unit = scale.unit().unit().with_order(order);
        let is_of_axis = scale.kind().dimension(order) == given.dimension();
        (is_of_axis && unit != given).then(|| {
            format!("{file}:{line}:{col}: {label}: {text} is {quantity}; write {text} {unit} if that is meant")
        })
    }
}
