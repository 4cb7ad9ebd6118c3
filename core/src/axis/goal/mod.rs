//! Goals, streams, trajectories, touch probes and stops of an axis.

mod buffer;
mod function;
mod moves;
pub(super) mod probe;
mod stops;
pub(super) mod stream;
mod stream_limit;
pub(super) mod touch_probe;
pub(super) mod track;
mod track_check;
mod track_query;
