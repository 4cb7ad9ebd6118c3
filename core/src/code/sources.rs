//! What MACS, WF and SAIA modules call an error by their own numbers.

use super::codes;

codes! {
    /// No error.
    NONE = 0, NoError {
        says: "",
        cause: "",
        remedy: "",
    }

    /// A motion command although homing is required and has not been done (MACS error 6).
    HOMING_REQUIRED = 6, NoError {
        says: "homing is required and has not been done; home the axis first",
        cause: "A motion was asked for, homing is required and has not been done since power-on.",
        remedy: "Home the axis; or set homing.required to false where no zero is needed.",
    }

    /// A drive, or another node that is guarded, does not answer (MACS error 88).
    DRIVE_LOST = 88, Drive {
        says: "the drive does not answer",
        cause: "The drive sends nothing any more: no power, a cable, another node with its address.",
        remedy: "Check supply, cable and address, then reset_errors; while it stays away the reset fails.",
    }

    /// The bus of a drive transmits nothing (MACS error 89).
    BUS_ERROR = 89, Drive {
        says: "the bus of the drive transmits nothing",
        cause: "The bus of the drive is off: by its own errors, a cut cable, an adapter that was pulled. The drives on it do what they \
            do without a master.",
        remedy: "Check cable, termination, shield, bit rate and adapter, then reset_errors; while the bus stays off the reset fails.",
    }

    /// Motion into a limit at which the axis stands already (MACS error 98, F_LIMIT_VIOLATION).
    LIMIT_VIOLATION = 98, Switch {
        says: "velocity {asked} leads further into the limit at {limit}",
        cause: "Motion was asked for towards a limit at which the axis stands already.",
        remedy: "Move the other way; or push the axis back by hand; or switch the limit off for the time being.",
    }

    /// The motor was loaded beyond its I²t limit (MACS error 99, F_I2TLIMIT).
    I2T_LIMIT = 99, NoError {
        says: "the motor was loaded beyond its I2t limit",
        cause: "The motor was loaded beyond its I2t limit.",
        remedy: "Let it cool, reduce load or acceleration, then reset_errors.",
    }

    /// WF alarm 9: no zero mark after the cam.
    WF_NO_ZERO_MARK = 1009, Search {
        says: "alarm 9: no zero mark within {limit} after the cam",
        cause: "Alarm 9: no zero mark came within a revolution after the cam of reference travel.",
        remedy: "Check the encoder's zero mark and its cable, then wf {reset: true} and travel again.",
    }

    /// WF alarm 7: the encoder gives no value, its cable may be broken.
    WF_ENCODER_CABLE = 1007, Drive {
        says: "alarm 7: the encoder gives no value; its cable may be broken",
        cause: "Alarm 7: the encoder gives no value: its cable is cut, missing or bent, or the encoder is dead.",
        remedy: "Mend cable or encoder, then wf {reset: true}; before, it is refused.",
    }

    /// WF alarm 8: pulses of the encoder are missing or too many.
    WF_PULSES = 1008, Drive {
        says: "alarm 8: pulses of the encoder are missing or too many: {asked} since the index, beyond {limit}",
        cause: "Alarm 8: between two zero marks the encoder counted too many or too few pulses: noise, a dirty scale, \
            a mark that stays away.",
        remedy: "Check shield, cable and encoder, then wf {reset: true} and reference travel.",
    }

    /// WF alarm 10: following error beyond `wf.max_following_error` in travel.
    WF_FOLLOWING_ERROR_IN_TRAVEL = 1010, Parameter {
        says: "alarm 10: following error {asked} lies beyond wf.max_following_error {limit} in travel",
        cause: "Alarm 10: the following error lies beyond wf.max_following_error in travel: a weak or blocked drive, \
            a coupling, an encoder.",
        remedy: "Check coupling, encoder and load, then wf {reset: true}.",
    }

    /// WF alarm 11: following error beyond `wf.max_following_error` at standstill.
    WF_FOLLOWING_ERROR_AT_STANDSTILL = 1011, Parameter {
        says: "alarm 11: following error {asked} lies beyond wf.max_following_error {limit} at standstill",
        cause: "Alarm 11: the following error lies beyond wf.max_following_error at standstill: the axis was pushed, \
            or its drive is off.",
        remedy: "Check drive and load, then wf {reset: true}.",
    }

    /// WF alarm 22: position not reached in time, or left again.
    WF_POSITION_NOT_REACHED = 1022, Parameter {
        says: "alarm 22: {asked} from the target, outside the position reached window {limit}",
        cause: "Alarm 22: the axis did not reach its position window in time, or left it again.",
        remedy: "Check the steps of the speed (wf.md42 to wf.md48), the window and the time wf.md30, then wf {reset: \
            true}.",
    }

    /// A program without blocks.
    WF_NO_BLOCKS = 1101, NoError {
        says: "there is no block; give one or more in `blocks`",
        cause: "A program without blocks was started.",
        remedy: "Give one or more in `blocks`.",
    }

    /// More blocks than the mode takes.
    WF_ONE_BLOCK = 1102, NoError {
        says: "mode mdi takes one block; {asked} are given",
        cause: "More blocks were given than the mode takes.",
        remedy: "Give one block, or choose mode automatic.",
    }

    /// A change of mode or blocks, or START, while the axis moves.
    WF_IN_MOTION = 1103, NoError {
        says: "the axis moves; mode, blocks and START wait for its end",
        cause: "Mode, blocks or START were given while the axis moves.",
        remedy: "Wait for its end, or stop it first.",
    }

    /// START or a value in a mode that has no use for it.
    WF_NOT_IN_THIS_MODE = 1104, NoError {
        says: "the mode has no use for that: `start` runs blocks, `value` belongs to mode actual_value",
        cause: "START or a value was given in a mode that has no use for it.",
        remedy: "Choose the mode that it belongs to.",
    }

    /// The controller enable request was taken back.
    WF_NO_REQUEST = 1105, NoError {
        says: "the controller enable request was taken back; give `enable: true` first",
        cause: "The controller enable request was taken back.",
        remedy: "Give `enable: true` first.",
    }

    /// An alarm waits to be acknowledged.
    WF_ALARM_WAITS = 1106, NoError {
        says: "alarm {asked} waits; give `reset: true` first",
        cause: "An alarm waits to be acknowledged.",
        remedy: "Remove its cause, then `reset: true`.",
    }

    /// A speed value that is 0 or too high.
    WF_BAD_SPEED = 1107, NoError {
        says: "",
        cause: "A speed value is 0 or too high.",
        remedy: "Give one within the range that the sentence names.",
    }

    /// A block that the program does not have.
    WF_NO_SUCH_BLOCK = 1108, NoError {
        says: "block {asked} does not exist; the program has {limit}",
        cause: "A block was named that the program does not have.",
        remedy: "Name one that it has.",
    }

    /// MD7 names no side of the cam.
    WF_NO_CAM_SIDE = 1109, NoError {
        says: "",
        cause: "wf.md7 is above 2 with an incremental encoder: it names no side of the cam.",
        remedy: "Set wf.md7 to 0, 1 or 2; with wf.md4 absolute it is the value of the first word.",
    }

    /// A SAIA command before `axinit`, on an axis that is off.
    SAIA_NOT_INITIALISED = 2001, Command {
        says: "axinit has not run and the axis is off; axinit or enable must come first",
        cause: "A SAIA command came before axinit, on an axis that is off.",
        remedy: "Give axinit, or enable the axis.",
    }

    /// A register holds more than its command takes.
    SAIA_REGISTER_OUT_OF_RANGE = 2002, Command {
        says: "a register holds more than its command takes",
        cause: "A register holds more than its command takes.",
        remedy: "Load a value within its range.",
    }

    /// A destination or break position beyond the range of counts.
    SAIA_POSITION_OUT_OF_RANGE = 2003, Command {
        says: "{key} with saia.mcfac makes {plain} counts; -1073741824 to 1073741823 is allowed",
        cause: "A destination or break position lies beyond the range of counts.",
        remedy: "Load a smaller one, or check saia.mcfac.",
    }

    /// A velocity beyond its register.
    SAIA_VELOCITY_OUT_OF_RANGE = 2004, Command {
        says: "saia.veloc with saia.mcfac makes {plain} in the velocity register; 0 to 1073741823 is allowed",
        cause: "A velocity lies beyond its register.",
        remedy: "Load a smaller one, or check saia.mcfac.",
    }

    /// An acceleration beyond its register.
    SAIA_ACCELERATION_OUT_OF_RANGE = 2005, Command {
        says: "saia.accel with saia.mcfac makes {plain} in the acceleration register; 0 to 1073741823 is allowed",
        cause: "An acceleration lies beyond its register.",
        remedy: "Load a smaller one, or check saia.mcfac.",
    }

    /// A relative load before the first `fstart` after `axinit`.
    SAIA_RELATIVE_TOO_EARLY = 2006, Command {
        says: "{key} cannot be loaded relatively before the first fstart after axinit",
        cause: "A relative load came before the first fstart after axinit.",
        remedy: "Load an absolute value first.",
    }

    /// `fstop` with none or several of the bits 8 to 10 of the control word.
    SAIA_BAD_STOP_BITS = 2007, Command {
        says: "fstop needs one of the bits 8 to 10 of saia.mcw",
        cause: "fstop came with none or several of the bits 8 to 10 of saia.mcw.",
        remedy: "Set exactly one of them.",
    }

    /// `fsetpe` with another low byte of the control word than 1BH or 1AH.
    SAIA_BAD_REACTION = 2008, Command {
        says: "saia.mcw names no reaction to position errors",
        cause: "fsetpe came with another low byte of saia.mcw than 1BH or 1AH.",
        remedy: "Give one of these.",
    }

    /// A single step in motion.
    SAIA_STEP_IN_MOTION = 2009, Command {
        says: "fsstepf and fsstepb need an axis at rest",
        cause: "A single step was asked for in motion.",
        remedy: "Wait until the axis rests.",
    }

    /// A single step beyond the range of counts.
    SAIA_STEP_AT_END = 2010, Command {
        says: "the destination is {plain} counts, the end of its range; no step goes further",
        cause: "A single step would leave the range of counts.",
        remedy: "Step the other way.",
    }

    /// `fstart` in motion while a new acceleration waits.
    SAIA_ACCELERATION_PENDING = 2011, Command {
        says: "a new acceleration waits; fstart has to wait until the motion under way has ended",
        cause: "fstart came in motion while a new acceleration waits.",
        remedy: "Start once the axis rests.",
    }

    /// A start with an acceleration register of 0 or above the velocity register.
    SAIA_ACCELERATION_ABOVE_VELOCITY = 2012, Command {
        says: "the acceleration register is {plain}; 1 to the velocity register, {bound}, is allowed",
        cause: "A start with an acceleration register of 0 or above the velocity register.",
        remedy: "Load an acceleration of 1 to the velocity register.",
    }

    /// A read whose value does not fit its register.
    SAIA_READ_OUT_OF_RANGE = 2013, Command {
        says: "with saia.mcfac {plain} what is read does not fit its register of 32 bits",
        cause: "What is read does not fit its register.",
        remedy: "Check saia.mcfac.",
    }
}
