//! Signals of the vocabulary.

use super::request::MODES;
use super::{STATES, State};
use crate::signal::Type::{Bit, Enum, Int, Real};
use crate::signal::signal_block;

signal_block! {
    /// A signal of the vocabulary, by its index in the block.
    WfSignal;

    Active "wf.active" Bit, None; "the vocabulary commands the axis"
    Mode "wf.mode" Enum(MODES), None; "mode of operation"
    State "wf.state" Enum(STATES), None; "state of the block or of the jog (WF-OST)"
    Block "wf.block" Int, None; "block that runs or ran last, from 1; 0: none"
    Speed "wf.speed" Real, None; "speed value that is put out, in hundredths of max_velocity; closed loop: that of the block"
    Dac "wf.dac" Real, Voltage; "open loop: speed value as a voltage, with the sign of the direction"
    Q "wf.q" Bit, None; "open loop: output of the axis, from START to the switch-off"
    F "wf.f" Bit, None; "open loop: runs forwards; switched off: the target lies in plus direction"
    B "wf.b" Bit, None; "open loop: runs backwards; switched off: the target lies in minus direction"
    G "wf.g" Bit, None; "open loop: the speed value may be read, three module cycles (12 ms) after START"
    Enable "wf.enable" Bit, None; "controller enable (WF-IF-03); open loop: with the output only"
    Ready "wf.ready" Bit, None; "the drive is on"
    Peh "wf.peh" Bit, None; "position reached and held"
    Synchronized "wf.synchronized" Bit, None; "positions refer to a zero that was set"
    Alarm "wf.alarm" Int, None; "number of the alarm that waits for a reset: 7, 8, 10, 11, 22; 0: none"
    FollowingError "wf.fe" Int, Position; "set position minus actual position; open loop: way to the end of the block"
    DistanceToGo "wf.distance_to_go" Int, Position; "way to the end of the block, of the next one from where that is considered"
}

impl State {
    /// Returns the number of the state in signal `x.wf.state`.
    pub(super) fn word(self) -> u64 {
        self as u64
    }
}
