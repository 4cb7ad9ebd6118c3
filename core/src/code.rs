//! Codes of errors, refusals and ends of goals.
//!
//! Ranges (contract section 2): 0 none, MACS numbers as they are, 1000 + WF, 10000 + own, 0x10000 + drive (object 603Fh).

use serde::{Deserialize, Serialize};

/// Why something was refused, ended or failed. The numbers are part of the interface and never change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Code(pub u32);

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $number:literal;)*) => {
        impl Code {
            $($(#[doc = $doc])+ pub const $name: Code = Code($number);)*

            /// Every code of this program but those of drives, with its name.
            pub const ALL: &'static [(&'static str, Code)] = &[$((stringify!($name), Code::$name)),*];
        }
    };
}

codes! {
    /// No error.
    NONE = 0;
    /// A motion command although homing is required and has not been done (MACS error 6).
    HOMING_REQUIRED = 6;
    /// A drive, or another node that is guarded, does not answer (MACS error 88).
    DRIVE_LOST = 88;
    /// A field bus reports errors of communication (MACS error 89).
    BUS_ERROR = 89;
    /// Motion into a limit at which the axis stands already (MACS error 98, F_LIMIT_VIOLATION).
    LIMIT_VIOLATION = 98;
    /// The motor was loaded beyond its I²t limit (MACS error 99, F_I2TLIMIT).
    I2T_LIMIT = 99;

    /// WF alarm 9: no zero mark after the cam.
    WF_NO_ZERO_MARK = 1009;
    /// WF alarm 7: the encoder gives no value, its cable may be broken.
    WF_ENCODER_CABLE = 1007;
    /// WF alarm 8: pulses of the encoder are missing or too many.
    WF_PULSES = 1008;
    /// WF alarm 10: following error beyond `wf.max_following_error` in travel.
    WF_FOLLOWING_ERROR_IN_TRAVEL = 1010;
    /// WF alarm 11: following error beyond `wf.max_following_error` at standstill.
    WF_FOLLOWING_ERROR_AT_STANDSTILL = 1011;
    /// WF alarm 22: position not reached in time, or left again.
    WF_POSITION_NOT_REACHED = 1022;
    /// A program without blocks.
    WF_NO_BLOCKS = 1101;
    /// More blocks than the mode takes.
    WF_ONE_BLOCK = 1102;
    /// A change of mode or blocks, or START, while the axis moves.
    WF_IN_MOTION = 1103;
    /// START or a value in a mode that has no use for it.
    WF_NOT_IN_THIS_MODE = 1104;
    /// The controller enable request was taken back.
    WF_NO_REQUEST = 1105;
    /// An alarm waits to be acknowledged.
    WF_ALARM_WAITS = 1106;
    /// A speed value that is 0 or too high.
    WF_BAD_SPEED = 1107;
    /// A block that the program does not have.
    WF_NO_SUCH_BLOCK = 1108;
    /// MD7 names no side of the cam.
    WF_NO_CAM_SIDE = 1109;
    /// A SAIA command before `axinit`, on an axis that is off.
    SAIA_NOT_INITIALISED = 2001;
    /// A register holds more than its command takes.
    SAIA_REGISTER_OUT_OF_RANGE = 2002;
    /// A destination or break position beyond the range of counts.
    SAIA_POSITION_OUT_OF_RANGE = 2003;
    /// A velocity beyond its register.
    SAIA_VELOCITY_OUT_OF_RANGE = 2004;
    /// An acceleration beyond its register.
    SAIA_ACCELERATION_OUT_OF_RANGE = 2005;
    /// A relative load before the first `fstart` after `axinit`.
    SAIA_RELATIVE_TOO_EARLY = 2006;
    /// `fstop` with none or several of the bits 8 to 10 of the control word.
    SAIA_BAD_STOP_BITS = 2007;
    /// `fsetpe` with another low byte of the control word than 1BH or 1AH.
    SAIA_BAD_REACTION = 2008;
    /// A single step in motion.
    SAIA_STEP_IN_MOTION = 2009;
    /// A single step beyond the range of counts.
    SAIA_STEP_AT_END = 2010;
    /// `fstart` in motion while a new acceleration waits.
    SAIA_ACCELERATION_PENDING = 2011;
    /// A start with an acceleration register of 0 or above the velocity register.
    SAIA_ACCELERATION_ABOVE_VELOCITY = 2012;
    /// A read whose value does not fit its register.
    SAIA_READ_OUT_OF_RANGE = 2013;

    /// The goal's target lies above `max_position`.
    ABOVE_MAX_POSITION = 10001;
    /// The goal's target lies below `min_position`.
    BELOW_MIN_POSITION = 10002;
    /// Velocity beyond `max_velocity`.
    VELOCITY_TOO_HIGH = 10003;
    /// Acceleration beyond `max_acceleration`.
    ACCELERATION_TOO_HIGH = 10004;
    /// Deceleration beyond `max_deceleration`.
    DECELERATION_TOO_HIGH = 10005;
    /// Jerk beyond `max_jerk`.
    JERK_TOO_HIGH = 10006;
    /// The axis is disabled.
    NOT_ENABLED = 10007;
    /// The axis stands in ERROR_STOP: reset_errors first.
    IN_ERROR = 10008;
    /// The axis is locked by quick_stop: reset_errors first.
    QUICK_STOPPED = 10009;
    /// A number is negative, NaN or infinite where that has no meaning.
    BAD_NUMBER = 10010;
    /// |position| must stay below 2^62 increments.
    POSITION_OUT_OF_RANGE = 10011;
    /// On its way the move cannot stop before `max_position` with this deceleration.
    CANNOT_STOP_BEFORE_MAX_POSITION = 10012;
    /// On its way the move cannot stop before `min_position` with this deceleration.
    CANNOT_STOP_BEFORE_MIN_POSITION = 10013;
    /// The axis would follow itself, directly or through others.
    LEADER_LOOP = 10014;
    /// A ratio with denominator 0, or one part 0 and the other not.
    BAD_RATIO = 10015;
    /// The command names a mode that this version does not have.
    NOT_BUILT = 10016;
    /// No goal of that number is active.
    UNKNOWN_GOAL = 10017;
    /// A parameter value lies outside its range.
    PARAMETER_OUT_OF_RANGE = 10018;
    /// Parameters contradict each other (a limit above its counterpart, a default above its maximum).
    PARAMETERS_CONTRADICT = 10019;
    /// The active goal would leave the limits that the parameters ask for.
    GOAL_BEYOND_NEW_LIMITS = 10020;
    /// Too many commands wait for this axis.
    TOO_MANY_WAITING = 10021;
    /// A request was refused before it became a command (its text says why).
    BAD_REQUEST = 10022;
    /// The axis does not stand still, and the command needs that.
    NOT_AT_STANDSTILL = 10023;
    /// Velocity, acceleration or deceleration so low that a move would not end.
    RATE_TOO_LOW = 10024;
    /// A buffered goal behind a coupling, which has no end of its own.
    NOTHING_TO_WAIT_FOR = 10025;
    /// A superimposed motion asks for more than the motion under way leaves of the axis' limits.
    SUPERIMPOSED_TOO_MUCH = 10026;
    /// The axis runs in open loop, and the command needs a position loop.
    OPEN_LOOP = 10030;
    /// The axis closes a position loop, and the command is for one that does not.
    CLOSED_LOOP = 10031;

    /// Something that needs a disabled axis, or one that stands if it is virtual.
    NOT_DISABLED = 10032;
    /// A parameter that the machine computes, or that stands in the cell.
    READ_ONLY = 10033;
    /// A set that gives one value twice, by two names, and not the same.
    GIVEN_TWICE = 10034;

    /// A position reference that does not lie within the turn (VM_AMC_POSITION_REF).
    AMC_OUTSIDE_TURN = 10041;
    /// The integrators of the reference selector would differ by more turns than they hold.
    AMC_TURN_CAPACITY = 10042;
    /// The reference selector has no master to follow.
    AMC_NO_MASTER = 10043;
    /// The reference selector has nothing that freezes its master.
    AMC_NO_FREEZE = 10044;

    /// A motion backwards, which REVERS forbids.
    REVERSE_FORBIDDEN = 10051;
    /// POSDRCT would turn over a position loop that the drive closes.
    LOOP_IN_DRIVE = 10052;
    /// POSDRCT would turn over the velocity loop alone, which does not exist yet.
    NO_VELOCITY_LOOP = 10053;
    /// REVERS asks for outputs or a node, which do not exist yet.
    NO_REVERSING_OUTPUTS = 10054;

    /// An axis left the path of its trajectory by more than its tolerance.
    TRAJECTORY_PATH_TOLERANCE = 10061;
    /// An axis did not come within its goal tolerance in time.
    TRAJECTORY_GOAL_TOLERANCE = 10062;
    /// No point of the trajectory lies ahead.
    TRAJECTORY_IN_THE_PAST = 10063;
    /// A superimposed or waiting goal on an axis that runs a trajectory.
    TRAJECTORY_UNDER_WAY = 10064;
    /// Between its points the trajectory would go beyond `max_position`.
    TRAJECTORY_ABOVE_MAX_POSITION = 10065;
    /// Between its points the trajectory would go beyond `min_position`.
    TRAJECTORY_BELOW_MIN_POSITION = 10066;
    /// The axis stands in homing, and the command needs its zero, or would disturb it.
    HOMING_UNDER_WAY = 10301;
    /// Homing without a method: homing.method is 0.
    HOMING_NO_METHOD = 10302;
    /// A method that there is not.
    HOMING_UNKNOWN_METHOD = 10303;
    /// Homing with a velocity of 0.
    HOMING_NO_VELOCITY = 10304;
    /// A homing sequence of MACS without the input of its switch.
    HOMING_NO_SWITCH = 10305;
    /// The edge of the switch did not come within `homing.max_distance`.
    HOMING_SWITCH_MISSED = 10306;
    /// No index pulse within `homing.index_distance`.
    HOMING_INDEX_MISSED = 10307;
    /// A limit switch that the method has no use for ended the search.
    HOMING_AT_LIMIT = 10308;
    /// A virtual axis has no switches and no index.
    HOMING_NEEDS_DRIVE = 10309;
    /// The drive that homes by itself reports an error of homing.
    HOMING_IN_DRIVE_FAILED = 10310;
    /// The drive did not take up mode homing.
    HOMING_IN_DRIVE_TIMEOUT = 10311;
    /// A sequence that no drive has, of an axis whose drive homes.
    HOMING_NOT_IN_DRIVE = 10312;
    /// What the zero depends on was changed.
    HOMING_LOST = 10313;
    /// A selection has ended homing.
    HOMING_LEFT = 10314;
    /// ENCODERTYPE or MENCODERTYPE has no such number.
    ENCODER_UNKNOWN_TYPE = 10321;
    /// ENCODERTYPE or MENCODERTYPE names a node of a bus, which does not exist yet.
    ENCODER_NEEDS_BUS = 10322;
    /// ENCODERTYPE names an encoder terminal that the cell does not have.
    ENCODER_NO_TERMINAL = 10323;
    /// The drive closes its position loop with its own encoder.
    ENCODER_LOOP_IN_DRIVE = 10324;
    /// Two parameters, or one and the cell, name different encoders.
    ENCODER_CHOSEN_TWICE = 10325;
    /// The zero of an absolute encoder stands.
    ABSOLUTE_ZERO_STANDS = 10326;
    /// A bad word of an absolute encoder was replaced by an extrapolated one.
    ENCODER_SUBSTITUTED = 10327;
    /// A new zero moved the axis alone and not its encoder, because another user of the encoder began to move.
    ENCODER_NOT_SHARED = 10328;
    /// A coupling without a master, and MENCODERTYPE names none.
    NO_MASTER = 10329;
    /// The zero of an absolute encoder that leads stands.
    MASTER_ZERO_STANDS = 10330;
    /// MD4 asks for words that the drive would have to decode.
    WF_LOOP_IN_DRIVE = 10331;
    /// ENCODERFREQ is no clock rate.
    ENCODER_NO_RATE = 10332;
    /// MD16 is no parity.
    WF_NO_PARITY = 10333;
    /// I_BREAK ended the goal, an enable or a reset.
    INTERRUPTED = 10341;
    /// A parameter names a digital input that the cell has not.
    NO_SUCH_INPUT = 10342;
    /// A parameter names a digital output that the cell has not.
    NO_SUCH_OUTPUT = 10343;
    /// An output that an axis switches by itself.
    OUTPUT_TAKEN = 10344;
    /// A value that an output cannot have.
    OUTPUT_VALUE = 10345;
    /// What is to be set is no output.
    NO_OUTPUT = 10346;
    /// REVERS asks for outputs of an axis whose drive gets positions.
    REVERSING_BY_POSITION = 10347;
    /// A parameter names an output that has another function already.
    OUTPUT_SHARED = 10356;
    /// The machine is inactive: nothing is switched on and nothing moves until it is activated.
    NOT_ACTIVE = 10071;
    /// Streamed setpoints come for an axis that something else moves.
    STREAM_BUSY = 10081;
    /// A streamed setpoint is no number.
    SETPOINT_NO_NUMBER = 10082;

    /// A newer command took the axis over.
    REPLACED = 10101;
    /// halt ended the goal.
    HALTED = 10102;
    /// The client cancelled the goal.
    CANCELLED = 10103;
    /// quick_stop ended the goal, an enable or a reset.
    QUICK_STOP = 10104;
    /// disable ended the goal.
    DISABLED = 10105;
    /// The goal waited for one that did not reach its end.
    NOT_REACHED = 10106;
    /// The goal searched for a mark that did not come.
    PROBE_MISSED = 10107;

    /// Following error beyond `max_following_error` (MACS position error, which has no number in the source).
    FOLLOWING_ERROR = 10201;
    /// The axis stopped at `max_position`.
    SOFTWARE_LIMIT_POSITIVE = 10202;
    /// The axis stopped at `min_position`.
    SOFTWARE_LIMIT_NEGATIVE = 10203;
    /// The drive left operation enabled by itself.
    DRIVE_DISABLED = 10204;
    /// The drive did not reach operation enabled in time.
    ENABLE_TIMEOUT = 10205;
    /// An encoder gives no valid value.
    ENCODER_INVALID = 10206;
    /// What the axis follows is lost (its encoder is invalid or its drive is away).
    LEADER_LOST = 10207;
    /// A drive gave no new data for too long.
    DRIVE_STALE = 10208;
    /// Streamed setpoints stopped coming.
    STREAM_TIMEOUT = 10209;
    /// The encoder jumped further in one cycle than any motion explains.
    ENCODER_JUMP = 10210;
    /// Gear motion beyond `max_velocity` or `max_acceleration`: the axis lags and catches up.
    SYNC_LOST = 10211;
    /// Cycles were missed.
    OVERRUN = 10212;
    /// The drive did not leave its fault after the reset.
    RESET_FAILED = 10213;
    /// More events in one cycle than there is room for.
    EVENTS_LOST = 10214;
    /// More latches in one cycle than the inputs have room for.
    LATCHES_LOST = 10215;
    /// Cycles are missing in the recording: the disk did not keep up.
    RECORD_LOST = 10216;
    /// The recording stopped: the system refused to write it.
    RECORD_FAILED = 10217;
    /// The flight recorder could not save its bag.
    FLIGHT_FAILED = 10218;
    /// The limit switch at the end of rising counts was reached.
    HARDWARE_LIMIT_POSITIVE = 10221;
    /// The limit switch at the end of falling counts was reached.
    HARDWARE_LIMIT_NEGATIVE = 10222;
    /// Both limit switches are actuated at once: a broken cable, or a stop contact that opens both lines.
    BOTH_LIMIT_SWITCHES = 10223;
    /// Another axis had a following error, which stops all.
    STOPPED_WITH_OTHER = 10224;
    /// The emergency stop input of the cell is open.
    EMERGENCY_STOP = 10225;
    /// The interlock input of the cell is open.
    INTERLOCK = 10226;
    /// The goal has waited for its target window for longer than in_position_timeout.
    IN_POSITION_TIMEOUT = 10227;
    /// An abort ended the goal, and has locked the axis.
    ABORTED = 10228;
}

impl Code {
    /// What the recorder has to say: cycles that are missing, the number of the system's error (0 where it is not known).
    pub const NOTES: [Code; 3] = [Code::RECORD_LOST, Code::RECORD_FAILED, Code::FLIGHT_FAILED];

    /// First code of drive faults: 0x10000 + object 603Fh.
    pub const DRIVE_FAULT: u32 = 0x1_0000;

    /// A drive's own fault code (603Fh).
    pub const fn drive_fault(fault: u16) -> Self {
        Self(Self::DRIVE_FAULT + fault as u32)
    }

    /// An alarm of a positioning module: 1000 + its number.
    pub const fn is_alarm(self) -> bool {
        self.0 > 1000 && self.0 < 1100
    }

    /// True where nothing is wrong.
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_stands_twice() {
        let mut seen: Vec<_> = Code::ALL.iter().map(|(_, code)| code.0).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), Code::ALL.len());
    }

    /// Proves: MACS-ERR-01
    #[test]
    fn the_numbers_of_macs_are_kept_as_they_are() {
        let codes = [Code::HOMING_REQUIRED, Code::DRIVE_LOST, Code::BUS_ERROR, Code::LIMIT_VIOLATION, Code::I2T_LIMIT];
        assert_eq!(codes.map(|code| code.0), [6, 88, 89, 98, 99]);
    }

    #[test]
    fn a_drive_fault_keeps_its_603f_code() {
        assert_eq!(Code::drive_fault(0x8611).0, 0x1_8611);
    }
}
