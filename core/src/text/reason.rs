//! Why something was refused, ended or failed: the sentence of each code.

use super::set::{
    contradict, given_twice, key, names_no_io, not_built, not_built_here, not_disabled, out_of_range, read_only,
    reverse_forbidden,
};
use super::{number_text, plain, row};
use crate::axis::AxisState;
use crate::code::Code;
use crate::config::MachineConfig;
use crate::event::{Event, Kind, Number};
use crate::object::Object;
use crate::vocabulary::saia::Register;

/// Why something was refused, ended or failed.
pub(super) fn reason(event: &Event, config: &MachineConfig) -> String {
    let asked = || number_text(event.asked, event.source, config);
    let limit = || number_text(event.limit, event.source, config);
    let fixed = |text: &str| text.to_owned();
    match event.code {
        Code::DRIVE_LOST => fixed("the drive does not answer"),
        Code::HOMING_REQUIRED => fixed("homing is required and has not been done; home the axis first"),
        Code::WF_NO_ZERO_MARK => {
            format!("alarm 9: no zero mark within {} after the cam", limit())
        }
        Code::LIMIT_VIOLATION if event.limit == Number::None && event.kind == Kind::Refused => {
            let is = |code: Code| event.asked == Number::Count(code.0.into());
            match () {
                () if is(Code::BOTH_LIMIT_SWITCHES) => fixed("both limit switches are actuated; neither way is open"),
                () if is(Code::HARDWARE_LIMIT_NEGATIVE) => {
                    fixed("the negative limit switch is actuated; only the way back is open")
                }
                () => fixed("the positive limit switch is actuated; only the way back is open"),
            }
        }
        Code::LIMIT_VIOLATION if event.limit == Number::None => fixed("motion towards an actuated limit switch"),
        Code::HARDWARE_LIMIT_POSITIVE => fixed("the positive limit switch was reached"),
        Code::HARDWARE_LIMIT_NEGATIVE => fixed("the negative limit switch was reached"),
        Code::BOTH_LIMIT_SWITCHES => fixed("both limit switches are actuated: a broken cable, or an open stop contact"),
        Code::STOPPED_WITH_OTHER => match event.asked {
            Number::Count(axis) if matches!(event.kind, Kind::Error | Kind::Reset) => {
                let other = u16::try_from(axis).map_or("another axis", |axis| config.name(Object::Axis(axis)));
                format!("stopped, because {other} has a following error")
            }
            _ => fixed("stopped, because another axis has a following error"),
        },
        Code::EMERGENCY_STOP => fixed("the emergency stop is open"),
        Code::INTERLOCK => fixed("the interlock is open"),
        Code::ABORTED => fixed("abort has stopped the axis; reset_errors lets it go on"),
        Code::IN_POSITION_TIMEOUT => {
            format!("the goal waits for its target window: {} from the target, {} is allowed", asked(), limit())
        }
        Code::BUS_ERROR => fixed("the field bus reports errors of communication"),
        Code::I2T_LIMIT => fixed("the motor was loaded beyond its I2t limit"),
        Code::LIMIT_VIOLATION => format!("velocity {} leads further into the limit at {}", asked(), limit()),
        Code::WF_FOLLOWING_ERROR_IN_TRAVEL => {
            format!("alarm 10: following error {} lies beyond wf.max_following_error {} in travel", asked(), limit())
        }
        Code::WF_FOLLOWING_ERROR_AT_STANDSTILL => {
            format!(
                "alarm 11: following error {} lies beyond wf.max_following_error {} at standstill",
                asked(),
                limit()
            )
        }
        Code::WF_POSITION_NOT_REACHED => {
            format!("alarm 22: {} from the target, outside the position reached window {}", asked(), limit())
        }
        Code::WF_NO_BLOCKS => fixed("there is no block; give one or more in `blocks`"),
        Code::WF_ONE_BLOCK => format!("mode mdi takes one block; {} are given", asked()),
        Code::WF_IN_MOTION => fixed("the axis moves; mode, blocks and START wait for its end"),
        Code::WF_NOT_IN_THIS_MODE => {
            fixed("the mode has no use for that: `start` runs blocks, `value` belongs to mode actual_value")
        }
        Code::WF_NO_REQUEST => fixed("the controller enable request was taken back; give `enable: true` first"),
        Code::WF_ALARM_WAITS => format!("alarm {} waits; give `reset: true` first", asked()),
        Code::WF_BAD_SPEED => format!(
            "{} {} is not allowed; above 0 up to {} is, in open loop as a whole number",
            row(event).map_or("speed value", |row| row.key),
            asked(),
            limit()
        ),
        Code::WF_NO_SUCH_BLOCK => format!("block {} does not exist; the program has {}", asked(), limit()),
        Code::SAIA_NOT_INITIALISED => fixed("axinit has not run and the axis is off; axinit or enable must come first"),
        Code::SAIA_REGISTER_OUT_OF_RANGE => match Register::ALL.iter().find(|(_, name)| *name == key(event)) {
            Some((register, name)) => {
                let (low, high) = register.permitted().unwrap_or_default();
                format!("{name} is {}; {low} to {high} is allowed", plain(event.asked))
            }
            None => fixed("a register holds more than its command takes"),
        },
        Code::SAIA_POSITION_OUT_OF_RANGE => {
            let range = "-1073741824 to 1073741823 is allowed";
            format!("{} with saia.mcfac makes {} counts; {range}", key(event), plain(event.asked))
        }
        Code::SAIA_VELOCITY_OUT_OF_RANGE => {
            let (asked, range) = (plain(event.asked), "0 to 1073741823 is allowed");
            format!("saia.veloc with saia.mcfac makes {asked} in the velocity register; {range}")
        }
        Code::SAIA_ACCELERATION_OUT_OF_RANGE => {
            let (asked, range) = (plain(event.asked), "0 to 1073741823 is allowed");
            format!("saia.accel with saia.mcfac makes {asked} in the acceleration register; {range}")
        }
        Code::SAIA_RELATIVE_TOO_EARLY => {
            format!("{} cannot be loaded relatively before the first fstart after axinit", key(event))
        }
        Code::SAIA_BAD_STOP_BITS => {
            let Number::Count(bits) = event.asked else {
                return fixed("fstop needs one of the bits 8 to 10 of saia.mcw");
            };
            format!(
                "saia.mcw has {bits:03b} in bits 10 to 8; fstop needs exactly one of them (001 off, 010 hard, 100 ramp)"
            )
        }
        Code::SAIA_BAD_REACTION => {
            let Number::Count(byte) = event.asked else {
                return fixed("saia.mcw names no reaction to position errors");
            };
            format!("saia.mcw has {byte:02X}H in bits 0 to 7; 1BH (flag) or 1AH (flag and regulator off) is allowed")
        }
        Code::SAIA_STEP_IN_MOTION => fixed("fsstepf and fsstepb need an axis at rest"),
        Code::SAIA_STEP_AT_END => {
            format!("the destination is {} counts, the end of its range; no step goes further", plain(event.asked))
        }
        Code::SAIA_ACCELERATION_PENDING => {
            fixed("a new acceleration waits; fstart has to wait until the motion under way has ended")
        }
        Code::SAIA_ACCELERATION_ABOVE_VELOCITY if event.limit == Number::Count(0) => {
            fixed("the velocity register is 0; fldva has to load one first")
        }
        Code::SAIA_ACCELERATION_ABOVE_VELOCITY => {
            let (acceleration, velocity) = (plain(event.asked), plain(event.limit));
            format!("the acceleration register is {acceleration}; 1 to the velocity register, {velocity}, is allowed")
        }
        Code::SAIA_READ_OUT_OF_RANGE => {
            format!("with saia.mcfac {} what is read does not fit its register of 32 bits", plain(event.asked))
        }
        Code::ABOVE_MAX_POSITION => format!("target {} lies above max_position {}", asked(), limit()),
        Code::BELOW_MIN_POSITION => format!("target {} lies below min_position {}", asked(), limit()),
        Code::VELOCITY_TOO_HIGH => format!("velocity {} lies above max_velocity {}", asked(), limit()),
        Code::ACCELERATION_TOO_HIGH => format!("acceleration {} lies above max_acceleration {}", asked(), limit()),
        Code::DECELERATION_TOO_HIGH => format!("deceleration {} lies above max_deceleration {}", asked(), limit()),
        Code::JERK_TOO_HIGH => format!("jerk {} lies above max_jerk {}", asked(), limit()),
        Code::NOT_ENABLED => fixed("the axis is not enabled; enable it first"),
        Code::IN_ERROR => fixed("the axis stands in ERROR_STOP; reset_errors first"),
        Code::QUICK_STOPPED => fixed("quick_stop has locked the axis; reset_errors first"),
        Code::BAD_NUMBER => {
            format!("{} {} is not allowed; a finite number that is not negative is", measured(event.asked), asked())
        }
        Code::POSITION_OUT_OF_RANGE if event.limit != Number::None => format!(
            "at position {} a software limit would be {}, which does not lie within +-2^62 increments",
            asked(),
            limit()
        ),
        Code::POSITION_OUT_OF_RANGE => format!("target {} does not lie within +-2^62 increments", asked()),
        Code::CANNOT_STOP_BEFORE_MAX_POSITION => {
            format!("with deceleration {} it would reach {}, beyond max_position, on its way", asked(), limit())
        }
        Code::CANNOT_STOP_BEFORE_MIN_POSITION => {
            format!("with deceleration {} it would reach {}, beyond min_position, on its way", asked(), limit())
        }
        Code::LEADER_LOOP | Code::NO_MASTER if event.parameter.is_some() => {
            format!("{} {} {}", key(event), plain(event.asked), not_built_here(event.code))
        }
        Code::LEADER_LOOP => fixed("the axis would follow itself"),
        Code::BAD_RATIO => {
            format!("ratio {} : {} is none; both parts must not be 0 and stay below 2^62", asked(), limit())
        }
        Code::NOT_BUILT => not_built(event, config),
        Code::READ_ONLY => read_only(event, config),
        Code::NOT_DISABLED => not_disabled(event, config),
        Code::REVERSE_FORBIDDEN => reverse_forbidden(event, config),
        Code::LOOP_IN_DRIVE | Code::NO_VELOCITY_LOOP | Code::NO_REVERSING_OUTPUTS => {
            format!("{} {} {}", key(event), plain(event.asked), not_built_here(event.code))
        }
        Code::INTERRUPTED => fixed("i_break has stopped the axis; i_continue or reset_errors lets it go on"),
        Code::NO_SUCH_INPUT | Code::NO_SUCH_OUTPUT => {
            names_no_io(key(event), &plain(event.asked), event.code == Code::NO_SUCH_OUTPUT, &plain(event.limit))
        }
        Code::OUTPUT_TAKEN => {
            let owner = match event.limit {
                Number::Count(axis) => u16::try_from(axis).ok().map(|axis| config.name(Object::Axis(axis))),
                _ => None,
            };
            let (owner, asked) = (owner.unwrap_or("an axis"), plain(event.asked));
            format!("{asked} may not be set, nor any value: {owner} switches this output by itself")
        }
        Code::OUTPUT_SHARED => {
            format!("{} names output {}, which has another function already", key(event), plain(event.asked))
        }
        Code::OUTPUT_VALUE => {
            format!(
                "{} is no value of this output; 0 and 1 of a do, a finite number of V of an ao are",
                plain(event.asked)
            )
        }
        Code::NO_OUTPUT => fixed("this is no output; a do or an ao may be set"),
        Code::REVERSING_BY_POSITION => format!("{} {} {}", key(event), plain(event.asked), not_built_here(event.code)),
        Code::UNKNOWN_GOAL => format!("goal {} is not active", plain(event.asked)),
        Code::PARAMETER_OUT_OF_RANGE => out_of_range(event, config),
        Code::PARAMETERS_CONTRADICT => contradict(event, config),
        Code::GIVEN_TWICE => given_twice(event, config),
        Code::GOAL_BEYOND_NEW_LIMITS => {
            format!("{} {} would leave out {}, which the motion under way reaches", key(event), asked(), limit())
        }
        Code::TOO_MANY_WAITING if event.kind == Kind::Done => {
            fixed("it is being done, but too many wait already to be told its end")
        }
        Code::TOO_MANY_WAITING => fixed("too many commands wait; try again"),
        Code::BAD_REQUEST => fixed("the request is not understood"),
        Code::RATE_TOO_LOW => format!("{} is too low; at least {} is allowed", asked(), limit()),
        Code::NOTHING_TO_WAIT_FOR => fixed("a coupling has no end that a buffered goal could wait for"),
        Code::SUPERIMPOSED_TOO_MUCH => {
            format!("{} {} is more than the motion under way leaves: {}", measured(event.asked), asked(), limit())
        }
        Code::PROBE_MISSED => fixed("nothing latched until the end of the search"),
        Code::NOT_REACHED => fixed("the goal before it did not reach its end"),
        Code::NOT_AT_STANDSTILL => not_at_standstill(event.asked),
        Code::NOT_ACTIVE => fixed("the machine is inactive; activate it first"),
        Code::OPEN_LOOP => fixed("the axis runs in open loop; only commands of `wf` move it"),
        Code::CLOSED_LOOP => fixed("the axis closes a position loop; a speed without one is for interface open_loop"),
        Code::AMC_OUTSIDE_TURN => {
            format!(
                "{} {} does not lie within the turn, at most {} either way; amc.rotary_mode 4 to 6 takes more",
                key(event),
                asked(),
                limit()
            )
        }
        Code::AMC_TURN_CAPACITY => {
            format!("{} {} leads further than the {} turns that the integrators hold", key(event), asked(), limit())
        }
        Code::AMC_NO_MASTER => {
            format!("{} {} follows a master; give `amc: {{master: ..}}` in the cell", key(event), asked())
        }
        Code::AMC_NO_FREEZE => {
            format!("{} {} waits for a latch; give `amc: {{freeze: ..}}` in the cell", key(event), asked())
        }
        Code::TRAJECTORY_PATH_TOLERANCE => {
            let what = measured(event.asked);
            format!("off the path of its trajectory: {what} error {} lies beyond tolerance {}", asked(), limit())
        }
        Code::TRAJECTORY_GOAL_TOLERANCE => {
            let what = measured(event.asked);
            format!(
                "not at the goal of its trajectory in time: {what} error {} lies beyond tolerance {}",
                asked(),
                limit()
            )
        }
        Code::TRAJECTORY_IN_THE_PAST => {
            let (last, now) = (plain(event.asked), plain(event.limit));
            format!("the last point of the trajectory is at {last}; it must lie after the present time, {now}")
        }
        Code::TRAJECTORY_UNDER_WAY => fixed(
            "the axis runs a trajectory; only an aborting goal, absolute, relative, additive or velocity, replaces it",
        ),
        Code::TRAJECTORY_ABOVE_MAX_POSITION => {
            format!("between its points the trajectory would reach {}, above max_position {}", asked(), limit())
        }
        Code::TRAJECTORY_BELOW_MIN_POSITION => {
            format!("between its points the trajectory would reach {}, below min_position {}", asked(), limit())
        }
        Code::HOMING_UNDER_WAY => fixed("the axis is homing; wait for its end, or cancel it"),
        Code::HOMING_NO_METHOD => fixed("homing.method is 0: give the axis a method, or name one in the command"),
        Code::HOMING_UNKNOWN_METHOD if event.limit == Number::None => {
            format!("scheme cia402 has no homing method {}; 1 to 14, 17 to 30, 33, 34, 35 and 37 are allowed", asked())
        }
        Code::HOMING_UNKNOWN_METHOD => {
            format!("scheme macs has no homing method {}; 0 to {}, its home_type, are allowed", asked(), limit())
        }
        Code::HOMING_NO_VELOCITY => fixed("homing.velocity is 0; give one above 0, or below 0 for the other direction"),
        Code::HOMING_NO_SWITCH => format!(
            "i_refswitch is 0, and {} needs a reference switch; n or -n, the n-th digital input, is allowed",
            method(event.asked)
        ),
        Code::HOMING_SWITCH_MISSED => format!("the switch did not change within homing.max_distance {}", limit()),
        Code::HOMING_INDEX_MISSED => format!("no index pulse came within homing.index_distance {}", limit()),
        Code::HOMING_AT_LIMIT => fixed("a limit switch ended the search for the reference"),
        Code::HOMING_NEEDS_DRIVE => match event.asked {
            Number::None => {
                "the axis is virtual, without switches and index: it needs homing method 35 or 37".to_owned()
            }
            asked => {
                format!("the axis is virtual, without switches and index for {}; 35 and 37 are allowed", method(asked))
            }
        },
        Code::HOMING_IN_DRIVE_FAILED => fixed("the drive did not find its zero"),
        Code::HOMING_IN_DRIVE_TIMEOUT => fixed("the drive did not take up mode 6, homing, within 5 s"),
        Code::HOMING_NOT_IN_DRIVE => format!(
            "homing.in_drive is true, and the drive has no {}; methods of CiA 402 are allowed",
            method(event.asked)
        ),
        Code::HOMING_LOST => fixed("the zero is no longer known; home the axis again"),
        Code::HOMING_LEFT => fixed("another reference was selected, and that ended homing: the axis has no new zero"),
        Code::REPLACED => fixed("a newer command took the axis over"),
        Code::HALTED => fixed("halt ended the goal"),
        Code::CANCELLED => fixed("the goal was cancelled"),
        Code::QUICK_STOP => fixed("quick_stop has stopped the axis"),
        Code::DISABLED => fixed("the axis was switched off"),
        Code::FOLLOWING_ERROR => format!("following error {} lies beyond max_following_error {}", asked(), limit()),
        Code::SOFTWARE_LIMIT_POSITIVE => format!("stopped at max_position {}", limit_of(event, config)),
        Code::SOFTWARE_LIMIT_NEGATIVE => format!("stopped at min_position {}", limit_of(event, config)),
        Code::DRIVE_DISABLED => fixed("the drive left operation enabled by itself"),
        Code::ENABLE_TIMEOUT => fixed("the drive did not reach operation enabled within 5 s"),
        Code::ENCODER_INVALID => fixed("the encoder gives no valid value"),
        Code::LEADER_LOST => fixed("what the axis follows is lost"),
        Code::DRIVE_STALE => fixed("the drive sent nothing new for more than 10 cycles"),
        Code::STREAM_BUSY => fixed("something else moves the axis, and a stream takes no axis over; halt it first"),
        Code::SETPOINT_NO_NUMBER => fixed("the velocity is no finite number"),
        Code::STREAM_TIMEOUT => fixed("streamed setpoints stopped coming"),
        Code::ENCODER_JUMP if event.limit == Number::None => format!("the leader jumped by {} in one cycle", asked()),
        Code::ENCODER_JUMP => {
            format!("the encoder jumped by {} in one cycle; its axis moves {} at most", asked(), limit())
        }
        Code::WF_ENCODER_CABLE => fixed("alarm 7: the encoder gives no value; its cable may be broken"),
        Code::WF_PULSES => {
            format!(
                "alarm 8: pulses of the encoder are missing or too many: {} since the index, beyond {}",
                asked(),
                limit()
            )
        }
        Code::WF_NO_CAM_SIDE
        | Code::ENCODER_UNKNOWN_TYPE
        | Code::ENCODER_NEEDS_BUS
        | Code::ENCODER_NO_TERMINAL
        | Code::ENCODER_LOOP_IN_DRIVE
        | Code::WF_LOOP_IN_DRIVE
        | Code::ENCODER_NO_RATE
        | Code::WF_NO_PARITY
        | Code::ENCODER_CHOSEN_TWICE => format!("{} {} {}", key(event), plain(event.asked), not_built_here(event.code)),
        Code::ABSOLUTE_ZERO_STANDS => format!(
            "encodertype {} says that its encoder is absolute, so that its zero stands; no homing, no index and no set_position",
            plain(event.asked)
        ),
        Code::MASTER_ZERO_STANDS => {
            fixed("the encoder is absolute, so that its zero stands: no set_position of it as a master")
        }
        Code::ENCODER_SUBSTITUTED => {
            format!("a bad word of the encoder was replaced by an extrapolated one; {} so far", plain(event.asked))
        }
        Code::NO_MASTER => format!(
            "no master is named, and mencodertype {} names none that the cell has; name one, or set it to -n (axis n), 10, 20, \
             30 (an entry of encoders) or 6 (a simulated one)",
            plain(event.asked)
        ),
        Code::ENCODER_NOT_SHARED => match event.asked {
            Number::Count(axis) => {
                let other = u16::try_from(axis).map_or("another axis", |axis| config.name(Object::Axis(axis)));
                format!("{other}, which reads the same encoder, began to move, so that only this axis has its new zero")
            }
            _ => fixed(
                "with its new zero a position or limit of the encoder or of an axis that reads it would leave +-2^62 increments, \
                 so that only this axis has it",
            ),
        },
        Code::SYNC_LOST => fixed("the leader is faster than the axis may be; it lags and catches up"),
        Code::RESET_FAILED => fixed("the drive did not leave its fault within 5 s"),
        Code::EVENTS_LOST => format!("{} events of this cycle had no room", plain(event.asked)),
        Code::LATCHES_LOST => format!("{} latches of this cycle had no room", plain(event.asked)),
        Code::RECORD_LOST => {
            let missing = match event.asked {
                Number::Count(1) => "1 cycle is missing".to_owned(),
                count => format!("{} cycles are missing", plain(count)),
            };
            format!("recording: {missing}, the recorder or the disk did not keep up; no replay goes beyond them")
        }
        Code::RECORD_FAILED => format!("recording stopped: {}", system_error(event.asked)),
        Code::FLIGHT_FAILED => format!("the flight recorder saved no bag: {}", system_error(event.asked)),
        Code(number) if number >= Code::DRIVE_FAULT => format!("drive fault {:04X}h", number - Code::DRIVE_FAULT),
        Code(number) => format!("code {number}"),
    }
}

/// What an axis does that has to stand first, by the number of its state.
fn not_at_standstill(state: Number) -> String {
    use AxisState::{ContinuousMotion, DiscreteMotion, Homing, SynchronizedMotion};
    let is = |known: AxisState| state == Number::Count(known as i64);
    if is(Homing) {
        return "the axis is homing; wait for its end, or halt it first".to_owned();
    }
    if is(ContinuousMotion) {
        return "the axis runs at a velocity (CONTINUOUS_MOTION); halt it first".to_owned();
    }
    if is(SynchronizedMotion) {
        return "the axis is coupled (SYNCHRONIZED_MOTION); halt it first".to_owned();
    }
    if is(DiscreteMotion) {
        return "the axis moves (DISCRETE_MOTION); wait for its end, or halt it first".to_owned();
    }
    "the axis is not at rest; wait until it stands".to_owned()
}

/// A method of homing, by the numbers of parameter `homing.method`.
fn method(number: Number) -> String {
    match number {
        Number::Count(macs) if macs < 0 => format!("home_type {}", -1 - macs),
        number => format!("homing method {}", plain(number)),
    }
}

/// An error of the system by its number (errno of Linux).
fn system_error(number: Number) -> String {
    let name = match number {
        Number::Count(0) | Number::None => return "the system does not say why".to_owned(),
        Number::Count(2) => "no such file or folder",
        Number::Count(5) => "input/output error",
        Number::Count(13) => "permission denied",
        Number::Count(27) => "the file is too large",
        Number::Count(28) => "no space left on device",
        Number::Count(30) => "the file system is read-only",
        Number::Count(122) => "disk quota exceeded",
        _ => return format!("system error {}", plain(number)),
    };
    format!("{name} (system error {})", plain(number))
}

/// What a number measures.
pub(super) fn measured(number: Number) -> &'static str {
    match number {
        Number::Velocity(_) => "velocity",
        Number::Acceleration(_) => "acceleration or deceleration",
        Number::Jerk(_) => "jerk",
        Number::Position(_) => "position",
        _ => "value",
    }
}

/// The limit's position, which limit events carry as theirs.
pub(super) fn limit_of(event: &Event, config: &MachineConfig) -> String {
    match event.limit {
        Number::None => number_text(Number::Position(event.position.floor()), event.source, config),
        limit => number_text(limit, event.source, config),
    }
}
