//! Encoders, by native names.

use super::{Applies, BASE, Group, Measure, Range, Row, Storage, Value};

pub(super) const ROWS: &[Row] = rows! {
    "master_simulation_velocity": BASE, axis.encoder.master_velocity {
        group: Group::Encoder, measure: Measure::Velocity, range: Range::Real(-1e9, 1e9), default: Value::Real(0.0),
        storage: Storage::Volatile, applies: Applies::Drive, by_axis: true,
        description: "Velocity of the simulated master that mencodertype 6 asks for, in increments of the axis; i_break and abort stop it. \
            Where it is, x.master.position shows.",
        source: "MACS-ENC-16, MACS-ERR-09" }
    "max_encoder_jump": BASE, axis.encoder.max_jump {
        group: Group::Encoder, measure: Measure::Distance, range: Range::Int(1, (1 << 62) - 1), default_text: "not supervised",
        applies: Applies::Drive,
        description: "Most that the encoder of the axis may move from one cycle to the next. Beyond it the encoder has jumped: the axis \
            stops by error_reaction in that cycle, whatever following_error_time says, and its zero is lost.",
        source: "MACS-ENC-08, WF-ABS-04" }
};
