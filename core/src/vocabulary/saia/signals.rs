//! Signals of the vocabulary.

use crate::signal::Type::{Bit, Enum, Int, Word};
use crate::signal::signal_block;

/// Names of the states, by number (SAIA-FSM-01).
pub const STATES: &[&str] = &["PWR", "OFF", "HOLD", "POS", "VEL", "RAMP"];

signal_block! {
    /// A signal of the vocabulary, by its index in the block.
    SaiaSignal;

    Active "saia.active" Bit, None; "the vocabulary commands the axis"
    State "saia.state" Enum(STATES), None; "state of the vocabulary"
    OnDest "saia.ondest" Bit, None; "status flag: no profile runs"
    IPuls "saia.ipuls" Bit, None; "status flag: index caught"
    WrapOc "saia.wrapoc" Bit, None; "status flag: position wrapped in velocity mode"
    ExcPEr "saia.excper" Bit, None; "status flag: position error beyond PosEr"
    BrkPos "saia.brkpos" Bit, None; "status flag: break position passed"
    RActP "saia.ractp" Int, None; "register: actual position (units), by frdap"
    RSetP "saia.rsetp" Int, None; "register: position of the profile (units), by frdsp"
    RActV "saia.ractv" Int, None; "register: actual velocity (units/s), by frdav"
    RSetV "saia.rsetv" Int, None; "register: velocity of the profile (units/s), by frdsv"
    RIndP "saia.rindp" Int, None; "register: index position (units), by frdip"
    RIntTs "saia.rintts" Int, None; "register: integral part of the regulator, by frdits"
    RSigB "saia.rsigb" Word, None; "register: signal register, by frdsr"
    RegulatorOff "saia.regulator_off" Bit, None; "signal bit 7: the regulator is off"
    ProfileDone "saia.profile_done" Bit, None; "signal bit 10: the profile is computed to its end"
    VelocityMode "saia.velocity_mode" Bit, None; "signal bit 11: velocity control is started"
    Forward "saia.forward" Bit, None; "signal bit 12: direction of velocity control that is started"
    AccelerationPending "saia.acceleration_pending" Bit, None; "signal bit 14: an acceleration is loaded and not started"
    IndexArmed "saia.index_armed" Bit, None; "signal bit 0: the next index will be caught"
    StopLatch "saia.stop_latch" Bit, None; "a stop has to be followed by a load before fstart moves"
    Position "saia.position" Int, Position; "actual position from the vocabulary's zero"
    Destination "saia.destination" Int, Position; "destination that was started last, from the vocabulary's zero"
    VelocityRegister "saia.velocity_register" Int, None; "velocity that was started last (2^-16 counts per sample)"
    AccelerationRegister "saia.acceleration_register" Int, None; "acceleration that was started last (2^-16 counts per sample^2)"
    Output "saia.output" Int, None; "what the regulator would put out: 12 bit, with imode 5 8 bit"
    Integral "saia.integral" Int, None; "integral part of the regulator, as it stands"
    Error "saia.error" Int, None; "code of the last command error"
    CommandErrors "saia.command_errors" Int, None; "commands that failed three times"
    Tries "saia.tries" Int, None; "failed tries of commands"
}
