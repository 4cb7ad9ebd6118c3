//! Cause and remedy of every code, for diagnostics and docs/errors.md.

use crate::code::Code;

/// What to know of a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Where it comes from.
    pub cause: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

/// Cause and remedy of a code; none for one that is not known.
pub fn advice(code: Code) -> Option<Advice> {
    let known = TABLE.iter().find(|(known, ..)| *known == code);
    match known {
        Some(&(_, cause, remedy)) => Some(Advice { cause, remedy }),
        None if code.0 >= Code::DRIVE_FAULT => Some(DRIVE_FAULT),
        None => None,
    }
}

/// Of the drives' own codes.
pub const DRIVE_FAULT: Advice = Advice {
    cause: "The drive reports a fault; the last four hexadecimal digits are its object 603Fh.",
    remedy: "Look the code up in the manual of the drive, remove the cause, then reset_errors, which resets the drive too.",
};

const REDUCE: &str = "Ask for less, or raise the parameter if the machine bears it.";
const RESET: &str = "Remove the cause, then reset_errors.";

type Line = (Code, &'static str, &'static str);

const TABLE: &[Line] = &[
    (
        Code::HOMING_REQUIRED,
        "A motion was asked for, homing is required and has not been done since power-on.",
        "Home the axis; or set homing.required to false where no zero is needed.",
    ),
    (
        Code::DRIVE_LOST,
        "The drive sends nothing any more: no power, a cable, another node with its address.",
        "Check supply, cable and address, then reset_errors; while it stays away the reset fails.",
    ),
    (
        Code::BUS_ERROR,
        "The field bus reports errors of communication.",
        "Check termination, shield and bit rate of the bus, then reset_errors.",
    ),
    (
        Code::LIMIT_VIOLATION,
        "Motion was asked for towards a limit at which the axis stands already.",
        "Move the other way; or push the axis back by hand; or switch the limit off for the time being.",
    ),
    (
        Code::I2T_LIMIT,
        "The motor was loaded beyond its I2t limit.",
        "Let it cool, reduce load or acceleration, then reset_errors.",
    ),
    (
        Code::WF_ENCODER_CABLE,
        "Alarm 7: the encoder gives no value: its cable is cut, missing or bent, or the encoder is dead.",
        "Mend cable or encoder, then wf {reset: true}; before, it is refused.",
    ),
    (
        Code::WF_PULSES,
        "Alarm 8: between two zero marks the encoder counted too many or too few pulses: noise, a dirty scale, a mark that stays away.",
        "Check shield, cable and encoder, then wf {reset: true} and reference travel.",
    ),
    (
        Code::WF_NO_ZERO_MARK,
        "Alarm 9: no zero mark came within a revolution after the cam of reference travel.",
        "Check the encoder's zero mark and its cable, then wf {reset: true} and travel again.",
    ),
    (
        Code::WF_FOLLOWING_ERROR_IN_TRAVEL,
        "Alarm 10: the following error lies beyond wf.max_following_error in travel: a weak or blocked drive, a coupling, an encoder.",
        "Check coupling, encoder and load, then wf {reset: true}.",
    ),
    (
        Code::WF_FOLLOWING_ERROR_AT_STANDSTILL,
        "Alarm 11: the following error lies beyond wf.max_following_error at standstill: the axis was pushed, or its drive is off.",
        "Check drive and load, then wf {reset: true}.",
    ),
    (
        Code::WF_POSITION_NOT_REACHED,
        "Alarm 22: the axis did not reach its position window in time, or left it again.",
        "Check the steps of the speed (wf.md42 to wf.md48), the window and the time wf.md30, then wf {reset: true}.",
    ),
    (Code::WF_NO_BLOCKS, "A program without blocks was started.", "Give one or more in `blocks`."),
    (Code::WF_ONE_BLOCK, "More blocks were given than the mode takes.", "Give one block, or choose mode automatic."),
    (
        Code::WF_IN_MOTION,
        "Mode, blocks or START were given while the axis moves.",
        "Wait for its end, or stop it first.",
    ),
    (
        Code::WF_NOT_IN_THIS_MODE,
        "START or a value was given in a mode that has no use for it.",
        "Choose the mode that it belongs to.",
    ),
    (Code::WF_NO_REQUEST, "The controller enable request was taken back.", "Give `enable: true` first."),
    (Code::WF_ALARM_WAITS, "An alarm waits to be acknowledged.", "Remove its cause, then `reset: true`."),
    (Code::WF_BAD_SPEED, "A speed value is 0 or too high.", "Give one within the range that the sentence names."),
    (Code::WF_NO_SUCH_BLOCK, "A block was named that the program does not have.", "Name one that it has."),
    (
        Code::SAIA_NOT_INITIALISED,
        "A SAIA command came before axinit, on an axis that is off.",
        "Give axinit, or enable the axis.",
    ),
    (
        Code::SAIA_REGISTER_OUT_OF_RANGE,
        "A register holds more than its command takes.",
        "Load a value within its range.",
    ),
    (
        Code::SAIA_POSITION_OUT_OF_RANGE,
        "A destination or break position lies beyond the range of counts.",
        "Load a smaller one, or check saia.mcfac.",
    ),
    (
        Code::SAIA_VELOCITY_OUT_OF_RANGE,
        "A velocity lies beyond its register.",
        "Load a smaller one, or check saia.mcfac.",
    ),
    (
        Code::SAIA_ACCELERATION_OUT_OF_RANGE,
        "An acceleration lies beyond its register.",
        "Load a smaller one, or check saia.mcfac.",
    ),
    (
        Code::SAIA_RELATIVE_TOO_EARLY,
        "A relative load came before the first fstart after axinit.",
        "Load an absolute value first.",
    ),
    (
        Code::SAIA_BAD_STOP_BITS,
        "fstop came with none or several of the bits 8 to 10 of saia.mcw.",
        "Set exactly one of them.",
    ),
    (Code::SAIA_BAD_REACTION, "fsetpe came with another low byte of saia.mcw than 1BH or 1AH.", "Give one of these."),
    (Code::SAIA_STEP_IN_MOTION, "A single step was asked for in motion.", "Wait until the axis rests."),
    (Code::SAIA_STEP_AT_END, "A single step would leave the range of counts.", "Step the other way."),
    (
        Code::SAIA_ACCELERATION_PENDING,
        "fstart came in motion while a new acceleration waits.",
        "Start once the axis rests.",
    ),
    (
        Code::SAIA_ACCELERATION_ABOVE_VELOCITY,
        "A start with an acceleration register of 0 or above the velocity register.",
        "Load an acceleration of 1 to the velocity register.",
    ),
    (Code::SAIA_READ_OUT_OF_RANGE, "What is read does not fit its register.", "Check saia.mcfac."),
    (Code::ABOVE_MAX_POSITION, "The target lies above max_position.", "Choose a target within the limits."),
    (Code::BELOW_MIN_POSITION, "The target lies below min_position.", "Choose a target within the limits."),
    (Code::VELOCITY_TOO_HIGH, "The velocity lies beyond max_velocity.", REDUCE),
    (Code::ACCELERATION_TOO_HIGH, "The acceleration lies beyond max_acceleration.", REDUCE),
    (Code::DECELERATION_TOO_HIGH, "The deceleration lies beyond max_deceleration.", REDUCE),
    (Code::JERK_TOO_HIGH, "The jerk lies beyond max_jerk.", REDUCE),
    (Code::NOT_ENABLED, "The axis is off.", "Enable it first."),
    (Code::IN_ERROR, "The axis stands in ERROR_STOP.", RESET),
    (Code::QUICK_STOPPED, "quick_stop has locked the axis.", "reset_errors unlocks it."),
    (
        Code::BAD_NUMBER,
        "A number is negative, NaN or infinite where that has no meaning.",
        "Give a finite number that is allowed.",
    ),
    (Code::POSITION_OUT_OF_RANGE, "A position lies beyond 2^62 increments.", "Give a nearer one."),
    (
        Code::CANNOT_STOP_BEFORE_MAX_POSITION,
        "With this deceleration the axis would pass max_position on its way.",
        "Ask for more deceleration, or for less velocity before.",
    ),
    (
        Code::CANNOT_STOP_BEFORE_MIN_POSITION,
        "With this deceleration the axis would pass min_position on its way.",
        "Ask for more deceleration, or for less velocity before.",
    ),
    (
        Code::LEADER_LOOP,
        "The axis would follow itself, directly or through others, or mencodertype names it.",
        "Choose another leader.",
    ),
    (
        Code::BAD_RATIO,
        "A ratio with denominator 0, or one part 0 and the other not.",
        "Give two whole numbers that are not 0.",
    ),
    (
        Code::NOT_BUILT,
        "The command names something that this version does not have.",
        "See the page of its parameters.",
    ),
    (Code::UNKNOWN_GOAL, "No goal of that number is active.", "It has ended already: its end was told."),
    (
        Code::PARAMETER_OUT_OF_RANGE,
        "A parameter value lies outside its range.",
        "Give one within the range that the sentence names.",
    ),
    (Code::PARAMETERS_CONTRADICT, "Parameters contradict each other.", "Set both in one set, so that they agree."),
    (
        Code::GOAL_BEYOND_NEW_LIMITS,
        "The motion under way would leave the new limits.",
        "Stop it first, or set wider limits.",
    ),
    (Code::TOO_MANY_WAITING, "More commands wait than there is room for.", "Wait for answers; try again."),
    (Code::BAD_REQUEST, "A request was not understood.", "Compare it with docs/interfaces.md."),
    (
        Code::NOT_AT_STANDSTILL,
        "The axis moves or stops, and the command needs it at rest.",
        "Wait for its end, or halt it first.",
    ),
    (Code::RATE_TOO_LOW, "A velocity or acceleration is so low that the move would not end.", "Ask for more."),
    (
        Code::NOTHING_TO_WAIT_FOR,
        "A buffered goal behind a coupling, which has no end.",
        "Cancel the coupling, or give an aborting goal.",
    ),
    (
        Code::SUPERIMPOSED_TOO_MUCH,
        "A superimposed motion asks for more than the motion under way leaves of the limits.",
        "Ask for less, or wait.",
    ),
    (Code::OPEN_LOOP, "The axis runs in open loop, and the command needs a position loop.", "Use commands of `wf`."),
    (Code::CLOSED_LOOP, "The axis closes a position loop, and the command is for one that does not.", "Use move_axis."),
    (Code::NOT_DISABLED, "It needs a disabled axis.", "Disable the axis first."),
    (Code::READ_ONLY, "The machine computes the parameter, or the cell gives it.", "Change the cell, and start anew."),
    (Code::GIVEN_TWICE, "A set gives one value twice, and not the same.", "Give it once."),
    (
        Code::AMC_OUTSIDE_TURN,
        "A position reference does not lie within the turn.",
        "Give one within it, or choose amc.rotary_mode 4 to 6.",
    ),
    (
        Code::AMC_TURN_CAPACITY,
        "The reference leads further than the integrators hold turns.",
        "Come back within their range.",
    ),
    (Code::AMC_NO_MASTER, "The reference selector has no master.", "Give `amc: {master: ..}` in the cell."),
    (
        Code::AMC_NO_FREEZE,
        "The reference selector has nothing that freezes its master.",
        "Give `amc: {freeze: ..}` in the cell.",
    ),
    (Code::REVERSE_FORBIDDEN, "The motion leads backwards, which revers forbids.", "Move forwards, or change revers."),
    (Code::LOOP_IN_DRIVE, "posdrct would invert a loop that the drive closes.", "Invert the sense in the drive."),
    (
        Code::NO_VELOCITY_LOOP,
        "posdrct would invert the velocity loop alone, which does not exist yet.",
        "Use a value that inverts both.",
    ),
    (
        Code::NO_REVERSING_OUTPUTS,
        "revers names a node on a bus, which does not exist yet.",
        "Use revers below 100: a rule, and outputs where the interface is velocity or open_loop.",
    ),
    (
        Code::TRAJECTORY_PATH_TOLERANCE,
        "An axis left the path of its trajectory by more than its tolerance.",
        "Give a slower trajectory or a wider tolerance; check the drive.",
    ),
    (
        Code::TRAJECTORY_GOAL_TOLERANCE,
        "An axis did not come within its goal tolerance in time.",
        "Give more goal_time_tolerance or a wider tolerance; check the drive.",
    ),
    (
        Code::TRAJECTORY_IN_THE_PAST,
        "No point of the trajectory lies ahead.",
        "Check the clocks of both sides, and its start time.",
    ),
    (
        Code::TRAJECTORY_UNDER_WAY,
        "The axis runs a trajectory.",
        "Wait for its end, or replace it with an aborting goal.",
    ),
    (
        Code::TRAJECTORY_ABOVE_MAX_POSITION,
        "Between its points the trajectory would pass max_position.",
        "Give more points, or keep off the limit.",
    ),
    (
        Code::TRAJECTORY_BELOW_MIN_POSITION,
        "Between its points the trajectory would pass min_position.",
        "Give more points, or keep off the limit.",
    ),
    (
        Code::HOMING_UNDER_WAY,
        "The axis homes, and the command needs its zero, or would disturb it.",
        "Wait for the end of homing.",
    ),
    (Code::HOMING_NO_METHOD, "Homing was asked for, and homing.method is 0.", "Set homing.method, or name a method."),
    (Code::HOMING_UNKNOWN_METHOD, "There is no such method.", "Choose one of docs/homing.md."),
    (Code::HOMING_NO_VELOCITY, "Homing was asked for with a velocity of 0.", "Set homing.velocity (home_vel)."),
    (
        Code::HOMING_NO_SWITCH,
        "A home_type of MACS needs a reference switch, and no input is assigned.",
        "Set i_refswitch, or choose a method without a switch.",
    ),
    (
        Code::HOMING_SWITCH_MISSED,
        "Homing went homing.max_distance without finding its switch: a switch that is stuck, cut off or wired to another input.",
        "Check the switch and its signal, then reset_errors and home again; or raise homing.max_distance.",
    ),
    (
        Code::HOMING_INDEX_MISSED,
        "Homing went homing.index_distance without an index pulse: the encoder has none, or its track is cut.",
        "Check the encoder's index and its cable; or choose a method without an index; then reset_errors and home again.",
    ),
    (
        Code::HOMING_AT_LIMIT,
        "Homing ran onto a limit switch that its method has no use for.",
        "Check the reference switch, choose a method that turns round at the limit switches, then reset_errors and home again.",
    ),
    (
        Code::HOMING_NEEDS_DRIVE,
        "Homing of a virtual axis was asked for, which has no switches, by another method than 35 and 37.",
        "Use set_position.",
    ),
    (
        Code::HOMING_IN_DRIVE_FAILED,
        "The drive homes by itself and told that it failed.",
        "See the drive's own code, then reset_errors and home again.",
    ),
    (
        Code::HOMING_IN_DRIVE_TIMEOUT,
        "The drive did not take mode 6 or did not start.",
        "Check that it can home by itself; or set homing.in_drive to false.",
    ),
    (
        Code::HOMING_NOT_IN_DRIVE,
        "A sequence of MACS was asked of a drive that homes by itself.",
        "Choose a method of CiA 402, or set homing.in_drive to false.",
    ),
    (
        Code::HOMING_LOST,
        "The zero is not known any more: the drive counts anew, or a parameter of encoder, sense or homing was changed.",
        "Home the axis.",
    ),
    (
        Code::HOMING_LEFT,
        "While reference 5 of the selector homed the axis, another reference was selected.",
        "Nothing, if that was meant; else select 5 again.",
    ),
    (Code::NOT_ACTIVE, "The machine is inactive.", "Activate it first."),
    (Code::STREAM_BUSY, "Streamed setpoints come for an axis that something else moves.", "Halt it, then stream."),
    (Code::SETPOINT_NO_NUMBER, "A streamed setpoint is NaN or infinite.", "Send finite numbers."),
    (Code::REPLACED, "A newer command took the axis over.", "Nothing, if that was meant."),
    (Code::HALTED, "halt ended the goal.", "Give a new goal."),
    (Code::CANCELLED, "The client cancelled the goal.", "Give a new goal."),
    (
        Code::QUICK_STOP,
        "quick_stop ended what ran or was to begin: a goal, an enable, a reset.",
        "reset_errors where the axis is locked, enable where it is off; then give the goal again.",
    ),
    (Code::DISABLED, "disable ended the goal.", "Enable the axis, then give a new goal."),
    (Code::NOT_REACHED, "The goal before it did not reach its end.", "See how that one ended."),
    (Code::PROBE_MISSED, "No mark came until the end of the search.", "Check the sensor; search longer."),
    (
        Code::FOLLOWING_ERROR,
        "The actual position is further behind its command than max_following_error, for longer than following_error_time: a weak, blocked or badly tuned drive.",
        "Check load, brake and tuning; reduce acceleration or allow more; then reset_errors.",
    ),
    (
        Code::SOFTWARE_LIMIT_POSITIVE,
        "A motion without a target, or a coupled one, came to max_position and was stopped there.",
        "reset_errors, then move back.",
    ),
    (
        Code::SOFTWARE_LIMIT_NEGATIVE,
        "A motion without a target, or a coupled one, came to min_position and was stopped there.",
        "reset_errors, then move back.",
    ),
    (
        Code::DRIVE_DISABLED,
        "The drive left operation enabled by itself: its own enable input, its safe torque off.",
        RESET,
    ),
    (
        Code::ENABLE_TIMEOUT,
        "The drive did not reach operation enabled within 5 s.",
        "Check supply and enable inputs of the drive, then reset_errors.",
    ),
    (Code::ENCODER_INVALID, "An encoder gives no valid value.", "Check its cable and supply, then reset_errors."),
    (
        Code::LEADER_LOST,
        "What the axis follows is lost: its encoder is invalid or its drive is away.",
        "Bring the leader back, reset_errors, couple again.",
    ),
    (
        Code::DRIVE_STALE,
        "The drive sent nothing new for more than 10 cycles.",
        "Check the load of the bus and the cycle, then reset_errors.",
    ),
    (
        Code::STREAM_TIMEOUT,
        "Streamed setpoints stopped coming; the axis was stopped.",
        "Send them faster than setpoint_timeout.",
    ),
    (
        Code::ENCODER_JUMP,
        "A leader or encoder jumped further in one cycle than any motion explains.",
        "Check the encoder, then reset_errors.",
    ),
    (
        Code::SYNC_LOST,
        "The leader is faster than the axis may be; it lags and catches up.",
        "Slow the leader down, or raise the limits.",
    ),
    (Code::OVERRUN, "Cycles were missed: the computer was busy.", "See docs/realtime.md."),
    (
        Code::RESET_FAILED,
        "The drive did not leave its fault within 5 s.",
        "Remove the cause of the fault, then reset_errors again.",
    ),
    (Code::EVENTS_LOST, "More events came in one cycle than there is room for.", "Give fewer commands in one cycle."),
    (Code::LATCHES_LOST, "More latches came in one cycle than there is room for.", "Check the inputs for bouncing."),
    (Code::RECORD_LOST, "The disk did not keep up: cycles are missing in the recording.", "Record to a faster disk."),
    (
        Code::RECORD_FAILED,
        "The system refused to write the recording.",
        "Make room, check the rights; start a new recording.",
    ),
    (Code::FLIGHT_FAILED, "The flight recorder could not save its bag.", "Make room, check the folder."),
    (
        Code::HARDWARE_LIMIT_POSITIVE,
        "The limit switch at the end of rising counts was reached, or its wire is broken.",
        "reset_errors, then move back off the switch; where it cannot, push it back or unassign the switch for that time.",
    ),
    (
        Code::HARDWARE_LIMIT_NEGATIVE,
        "The limit switch at the end of falling counts was reached, or its wire is broken.",
        "reset_errors, then move back off the switch; where it cannot, push it back or unassign the switch for that time.",
    ),
    (
        Code::BOTH_LIMIT_SWITCHES,
        "Both limit switches are actuated at once: a broken cable, or a stop contact that opens both lines.",
        "Repair the cable, close the contact, then reset_errors.",
    ),
    (
        Code::STOPPED_WITH_OTHER,
        "Another axis had a following error, and its following_error_stops_all is 1.",
        "Remove the cause at the axis that the sentence names, then reset_errors of all.",
    ),
    (
        Code::EMERGENCY_STOP,
        "The emergency stop input of the cell reads 0: pressed, or its wire is broken.",
        "Release it, then reset_errors; while it is open the error comes back.",
    ),
    (
        Code::INTERLOCK,
        "The interlock input of the cell reads 0: a guard is open, or its wire is broken.",
        "Close the guard, then reset_errors; while it is open the error comes back.",
    ),
    (
        Code::ABORTED,
        "abort, the Esc of MACS, ended what ran or was to begin, and has locked all axes that are on.",
        "reset_errors, which opens the brake of the axis; open one that o_brake names with set_output; enable what is off. Then give the goal again.",
    ),
    (
        Code::IN_POSITION_TIMEOUT,
        "The axis does not come into its target window: the window is too small for what its drive leaves.",
        "Widen in_position_window, or tune the drive; halt ends the wait.",
    ),
    (
        Code::NO_MASTER,
        "synchronize names no master, and neither does mencodertype of the axis; or mencodertype names an axis that there is not.",
        "Name a master, or set mencodertype.",
    ),
    (
        Code::WF_NO_CAM_SIDE,
        "wf.md7 is above 2 with an incremental encoder: it names no side of the cam.",
        "Set wf.md7 to 0, 1 or 2; with wf.md4 absolute it is the value of the first word.",
    ),
    (
        Code::ENCODER_UNKNOWN_TYPE,
        "encodertype or mencodertype has a number that there is not.",
        "Choose one of docs/encoders.md.",
    ),
    (
        Code::ENCODER_NEEDS_BUS,
        "encodertype or mencodertype names an encoder on a bus.",
        "Name an entry of encoders in feedback of the axis instead.",
    ),
    (
        Code::ENCODER_NO_TERMINAL,
        "encodertype or mencodertype names an entry of encoders that the cell does not have.",
        "Add the entry, or choose 10, 20 or 30 as there are entries.",
    ),
    (
        Code::ENCODER_LOOP_IN_DRIVE,
        "The drive closes its position loop itself, with its own encoder.",
        "Use interface velocity, or leave the encoder to the drive.",
    ),
    (
        Code::ENCODER_CHOSEN_TWICE,
        "Two places name different encoders for one axis.",
        "Leave out one of feedback, encodertype and wf.md4.",
    ),
    (
        Code::ABSOLUTE_ZERO_STANDS,
        "Homing or a new position was asked of an axis with an absolute encoder, whose zero stands.",
        "Set the zero at the encoder, or choose an incremental encodertype.",
    ),
    (
        Code::WF_LOOP_IN_DRIVE,
        "The drive closes its position loop itself, and wf.md4 asks the core to decode words.",
        "Use interface velocity, or leave wf.md4 incremental.",
    ),
    (
        Code::ENCODER_NO_RATE,
        "encoderfreq is a distance of marks, but encodertype is not 9.",
        "Set both in one command, or encoderfreq first to 39000 to 5000000 Hz.",
    ),
    (
        Code::WF_NO_PARITY,
        "wf.md16 is a position, but with wf.md4 absolute it is the parity of the words.",
        "Set wf.md16 to 0, 1 or 2 inc together with wf.md4.",
    ),
    (
        Code::MASTER_ZERO_STANDS,
        "A new position was asked of a master that is an absolute encoder, whose zero stands.",
        "Set the zero at the encoder, or give a coupling an offset.",
    ),
    (
        Code::ENCODER_SUBSTITUTED,
        "A word of an absolute encoder could not be right and was replaced: noise on its line.",
        "Check shield and cable of the encoder before it fails.",
    ),
    (
        Code::ENCODER_NOT_SHARED,
        "A new zero was to move an encoder with several users, and one of them began to move in the same cycle, or would leave its range.",
        "Stand still with all users of the encoder, then set the position again.",
    ),
    (
        Code::INTERRUPTED,
        "The input of i_break ended what ran or was to begin: a goal, an enable, a reset.",
        "Give the edge of i_continue, or reset_errors; then give the goal again.",
    ),
    (
        Code::NO_SUCH_INPUT,
        "A parameter names a digital input that the cell does not have.",
        "Name one of the entries of type di, counted from 1 in file order.",
    ),
    (
        Code::NO_SUCH_OUTPUT,
        "A parameter names a digital output that the cell does not have.",
        "Name one of the entries of type do, counted from 1 in file order.",
    ),
    (Code::OUTPUT_TAKEN, "The output is switched by an axis itself: its direction, its brake.", "Name another output."),
    (
        Code::OUTPUT_SHARED,
        "A parameter names an output that a brake, section wf or another parameter switches.",
        "Give each function an output of its own.",
    ),
    (
        Code::OUTPUT_VALUE,
        "An output was to have a value that it cannot have.",
        "Give 0 or 1 to digital outputs, a voltage to analog ones.",
    ),
    (Code::NO_OUTPUT, "set_output named an entry that is no output.", "Name an entry of type do or ao."),
    (
        Code::REVERSING_BY_POSITION,
        "revers asks for outputs that tell the sign of a velocity, and the drive gets positions.",
        "Use interface velocity or open_loop, or a revers of 0, 1 or 2.",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_a_cause_and_a_remedy_once() {
        for (name, code) in Code::ALL.iter().filter(|(_, code)| !code.is_none()) {
            assert_eq!(TABLE.iter().filter(|(known, ..)| known == code).count(), 1, "{name}");
        }
        for (code, cause, remedy) in TABLE {
            assert!(cause.ends_with('.') && remedy.ends_with('.'), "{code:?}");
            assert!(!cause.contains('|') && !remedy.contains('|'), "{code:?}: the page has columns");
        }
        assert_eq!(advice(Code::drive_fault(0x8611)), Some(DRIVE_FAULT));
        assert_eq!(advice(Code(777)), None);
    }
}
