//! `~/errors`: the last errors and resets, for subscribers that join later.

use super::host::Host;
use super::messages::AxisView;
use super::table;
use crate::layer::{CreateError, Node, Publisher};
use lineshaft_core::event::{Event as CoreEvent, Kind};
use lineshaft_core::object::Object;
use lineshaft_core::signal::Board;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::msg::Event;

/// Publisher of errors and resets.
pub(super) struct History {
    publisher: Publisher<Event>,
    views: Vec<AxisView>,
}

impl History {
    pub(super) fn start(node: &Node, host: &dyn Host) -> Result<Self, CreateError> {
        let publisher = table::ERRORS.publisher(node)?;
        Ok(Self { publisher, views: AxisView::all(host.config(), host.directory()) })
    }

    /// Publishes an error or a reset, with the state of the axis and the recommended action.
    pub(super) fn keep(&self, host: &dyn Host, event: &CoreEvent, message: &Event) {
        if !matches!(event.kind, Kind::Error | Kind::Reset) {
            return;
        }
        let mut text = message.text.clone();
        if event.kind == Kind::Error {
            if let Some(stood) = self.axis_state_at(host, event) {
                text.push_str(&stood);
            }
            if let Some(row) = event.code.row() {
                text = format!("{text}. {}", row.remedy);
            }
        }
        if let Err(error) = self.publisher.publish(&Event { text, ..message.clone() }) {
            tracing::warn!("{error}");
        }
    }

    /// Returns the state of the axis at the error, if no newer error has occurred since.
    fn axis_state_at(&self, host: &dyn Host, event: &CoreEvent) -> Option<String> {
        let Object::Axis(axis) = event.source else { return None };
        let view = self.views.get(usize::from(axis))?;
        let snapshot = host.snapshot();
        let board = &snapshot.board;
        let is_it = view.int(board, AxisSignal::FaultCycle).cast_unsigned() == event.cycle
            && view.int(board, AxisSignal::FaultCode) == i64::from(event.code.0);
        is_it.then(|| format!(" ({})", error_state_text(view, board)))
    }
}

/// Returns the state of an axis at its last error.
pub(super) fn error_state_text(view: &AxisView, board: &Board) -> String {
    let length = |signal| view.length_text(board, signal);
    format!(
        "cycle {}: command {} at {}, actual {}, following error {}",
        view.int(board, AxisSignal::FaultCycle),
        length(AxisSignal::FaultCommand),
        view.velocity_text(board, AxisSignal::FaultVelocity),
        length(AxisSignal::FaultActual),
        length(AxisSignal::FaultFollowingError),
    )
}
