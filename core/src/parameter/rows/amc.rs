//! Parameters of the Unidrive M advanced motion controller, menu 34 (spec/amc.md); a bare number is in the axis unit.

use super::{Applies, BASE, Bare, Group, Measure, Range, Row, Storage, System, Value};
use crate::table::{MAX_LENGTH, MAX_NUMBERS};

const NUMBER: Row = Row { system: System::Amc, group: Group::Menu, default: Value::Int(0), ..BASE };

pub(super) const ROWS: &[Row] = rows! {
    "amc.stop_mode": NUMBER, axis.vocabularies.amc.stop_mode {
        mnemonic: "Stop Mode", number: "34.001", range: Range::Int(0, 3),
        description: "How reference 0 stops: 0 with the profile, 1 without it, at once where the axis is; 2 and 3 the same, and a \
            following error beyond amc.following_error_window selects reference 0.",
        source: "AMC-PAR-01, AMC-STP-02..06" }
    "amc.stop_reference": NUMBER {
        mnemonic: "Stop Reference", number: "34.002", measure: Measure::Position, bare: Bare::AxisUnit, default: Value::Unset,
        default_text: "where the axis would stop", storage: Storage::Signal("amc.stop_reference"),
        description: "Where the axis would stop now, as amc.stop_mode says; frozen while reference 0 is selected.",
        source: "AMC-PAR-02, AMC-STP-01" }
    "amc.position_reference": NUMBER, axis.vocabularies.amc.position_reference {
        mnemonic: "Position Reference", number: "34.003", measure: Measure::Position, bare: Bare::AxisUnit,
        description: "Position of reference 1, distance of reference 6.", source: "AMC-PAR-03, AMC-PAR-12" }
    "amc.rotary_mode": NUMBER, axis.vocabularies.amc.rotary_mode {
        mnemonic: "Rotary Mode", number: "34.005", range: Range::Int(0, 6),
        description: "Which way a change of position goes on an axis with a modulo: 0 shortest, 1 forward, 2 reverse, 3 no rollover, 4 to \
            6 over several turns forward, reverse, as the sign says.",
        source: "AMC-PAR-05, AMC-ROT-10..16" }
    "amc.speed_reference": NUMBER, axis.vocabularies.amc.speed_reference {
        mnemonic: "Speed Reference", number: "34.006", measure: Measure::Velocity, range: Range::Real(-1e15, 1e15),
        bare: Bare::AxisUnitPerMs, default: Value::Real(0.0),
        description: "Velocity of reference 2, at most max_velocity either way.", source: "AMC-PAR-06" }
    "amc.reference_select": NUMBER, axis.vocabularies.amc.reference_select {
        mnemonic: "Reference Select", number: "34.007", range: Range::Int(0, 7), by_axis: true,
        description: "What commands the axis: 0 stop, 1 absolute position, 2 speed, 3 cam, 4 gear, 5 home, 6 relative position, 7 the last \
            target position. The machine writes it back where it changes by itself: 0 when anything else takes the axis, and at any end of \
            homing; disable leaves others for the next enable.",
        source: "AMC-PAR-07, AMC-SEL-00..09" }
    "amc.action_on_event": NUMBER, axis.vocabularies.amc.action_on_event {
        mnemonic: "Action On Event", number: "34.008", range: Range::Int(0, 2),
        description: "What a rising latch of amc.freeze does: 0 nothing, 1 starts the cam, 2 starts the gear.",
        source: "AMC-PAR-08, AMC-EVT-02" }
    "amc.reference_select_trigger": NUMBER, axis.vocabularies.amc.reference_select_trigger {
        mnemonic: "Reference Select Trigger", number: "34.009", range: Range::Int(0, 7), storage: Storage::Volatile,
        description: "Each change of it is written to amc.reference_select.", source: "AMC-PAR-09, AMC-TRG-01" }
    "amc.cam_start_index": NUMBER, axis.vocabularies.amc.cam_start_index {
        mnemonic: "Cam Start Index", number: "35.001", range: Range::Int(0, MAX_NUMBERS as i64),
        description: "Point of the table of amc.cam at which the cam starts, from 0.", source: "AMC-PAR-11, AMC-SEL-03" }
    "amc.cam_start_position": NUMBER, axis.vocabularies.amc.cam_start_position {
        mnemonic: "Cam Start Position In Segment", number: "35.002", range: Range::Int(0, MAX_LENGTH),
        description: "Increments of the master behind the point amc.cam_start_index at which the cam starts.",
        source: "AMC-PAR-11, AMC-SEL-03" }
    "amc.following_error_window": NUMBER, axis.vocabularies.amc.following_error_window {
        mnemonic: "Following Error Window", number: "41.007", measure: Measure::Distance, range: Range::Int(0, (1 << 62) - 1),
        bare: Bare::AxisUnit, default: Value::Unset, default_text: "as max_following_error", applies: Applies::Drive,
        description: "Following error beyond which amc.stop_mode 2 and 3 select reference 0.", source: "AMC-PAR-11, AMC-STP-06" }
    "amc.software_limit_stop_mode": NUMBER, axis.vocabularies.amc.software_limit_stop_mode {
        mnemonic: "Software Limit Stop Mode", number: "41.024", range: Range::Int(0, 3),
        description: "Amc.stop_mode while the axis is at a software limit.", source: "AMC-PAR-11, AMC-STP-07" }
};
