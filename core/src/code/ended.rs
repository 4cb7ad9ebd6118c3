//! How goals ended, and what has failed.

use super::codes;

codes! {
    /// The axis stands in homing, and the command needs its zero, or would disturb it.
    HOMING_UNDER_WAY = 10301, NoError {
        says: "the axis is homing; wait for its end, or cancel it",
        cause: "The axis homes, and the command needs its zero, or would disturb it.",
        remedy: "Wait for the end of homing.",
    }

    /// Homing without a method: homing.method is 0.
    HOMING_NO_METHOD = 10302, NoError {
        says: "homing.method is 0: give the axis a method, or name one in the command",
        cause: "Homing was asked for, and homing.method is 0.",
        remedy: "Set homing.method, or name a method.",
    }

    /// A method that there is not.
    HOMING_UNKNOWN_METHOD = 10303, NoError {
        says: "scheme macs has no homing method {asked}; 0 to {limit}, its home_type, are allowed",
        cause: "There is no such method.",
        remedy: "Choose one of docs/homing.md.",
    }

    /// Homing with a velocity of 0.
    HOMING_NO_VELOCITY = 10304, NoError {
        says: "homing.velocity is 0; give one above 0, or below 0 for the other direction",
        cause: "Homing was asked for with a velocity of 0.",
        remedy: "Set homing.velocity (home_vel).",
    }

    /// Homing by a switch that is read nowhere.
    HOMING_NO_SWITCH = 10305, NoError {
        says: "",
        cause: "The homing method needs a switch that is not read: a home_type of MACS has no input at i_refswitch, or \
            the digital inputs of a drive on CAN (60FDh) are not read.",
        remedy: "Assign an input (i_refswitch, i_poslimitsw, i_neglimitsw), give the drive its `eds`, or choose a method \
            without a switch.",
    }

    /// The edge of the switch did not come within `homing.max_distance`.
    HOMING_SWITCH_MISSED = 10306, Search {
        says: "the switch did not change within homing.max_distance {limit}",
        cause: "Homing went homing.max_distance without finding its switch: a switch that is stuck, cut off or wired \
            to another input.",
        remedy: "Check the switch and its signal, then reset_errors and home again; or raise homing.max_distance.",
    }

    /// No index pulse within `homing.index_distance`.
    HOMING_INDEX_MISSED = 10307, Search {
        says: "no index pulse came within homing.index_distance {limit}",
        cause: "Homing went homing.index_distance without an index pulse: the encoder has none, or its track is cut.",
        remedy: "Check the encoder's index and its cable; or choose a method without an index; then reset_errors and \
            home again.",
    }

    /// A limit switch that the method has no use for ended the search.
    HOMING_AT_LIMIT = 10308, Search {
        says: "a limit switch ended the search for the reference",
        cause: "Homing ran onto a limit switch that its method has no use for.",
        remedy: "Check the reference switch, choose a method that turns round at the limit switches, then \
            reset_errors and home again.",
    }

    /// A virtual axis has no switches and no index.
    HOMING_NEEDS_DRIVE = 10309, NoError {
        says: "the axis is virtual, without switches and index: it needs homing method 35 or 37",
        cause: "Homing of a virtual axis was asked for, which has no switches, by another method than 35 and 37.",
        remedy: "Use set_position.",
    }

    /// The drive that homes by itself reports an error of homing.
    HOMING_IN_DRIVE_FAILED = 10310, Search {
        says: "the drive did not find its zero",
        cause: "The drive homes by itself and told that it failed.",
        remedy: "See the drive's own code, then reset_errors and home again.",
    }

    /// The drive did not take up mode homing.
    HOMING_IN_DRIVE_TIMEOUT = 10311, Search {
        says: "the drive did not take up mode 6, homing, or its own mode after it within 5 s",
        cause: "The drive did not take mode 6, left it before its homing was over, or did not return to its own mode after it.",
        remedy: "Check that it can home by itself; or set homing.in_drive to false.",
    }

    /// A sequence that no drive has, of an axis whose drive homes.
    HOMING_NOT_IN_DRIVE = 10312, NoError {
        says: "",
        cause: "A sequence of MACS was asked of a drive that homes by itself.",
        remedy: "Choose a method of CiA 402, or set homing.in_drive to false.",
    }

    /// What the zero depends on was changed.
    HOMING_LOST = 10313, Search {
        says: "the zero is no longer known; home the axis again",
        cause: "The zero is not known any more: the drive restarted its counts, or a parameter of encoder, direction or homing was \
            changed.",
        remedy: "Home the axis.",
    }

    /// A selection has ended homing.
    HOMING_LEFT = 10314, NoError {
        says: "another reference was selected, and that ended homing: the axis has no new zero",
        cause: "While reference 5 of the selector homed the axis, another reference was selected.",
        remedy: "Nothing, if that was meant; else select 5 again.",
    }

    /// Homing lasts for longer than `homing.max_time`.
    HOMING_TOO_LONG = 10315, Search {
        says: "homing has lasted for longer than homing.max_time {limit}",
        cause: "Homing did not find the zero within homing.max_time.",
        remedy: "Check the switches, and the homing of the drive where it homes by itself, then reset_errors and home again; or raise \
            homing.max_time.",
    }

    /// Homing in the drive lasts.
    HOMING_LASTS = 10316, NoError {
        says: "homing in the drive has lasted for {asked} and goes on; homing.max_time limits it",
        cause: "The drive homes by itself and has shown no end for a minute, two, and so on.",
        remedy: "Look at the axis: halt ends homing; set homing.max_time to have it end by itself.",
    }

    /// A drive in mode homing shows the bits of an earlier homing only.
    HOMING_NOT_BEGUN = 10317, Search {
        says: "the drive is in mode 6, homing, and has not begun within 5 s: bits 10 and 12 of 6041h are still those of an earlier homing",
        cause: "The drive is in mode 6 and has cleared neither bit 10 nor bit 12 of its status word (6041h) since bit 4 of the control word rose.",
        remedy: "Check that homing by bit 4 of the control word is enabled in the drive, and that it knows the method (6098h).",
    }

    /// ENCODERTYPE or MENCODERTYPE has no such number.
    ENCODER_UNKNOWN_TYPE = 10321, NoError {
        says: "",
        cause: "encodertype or mencodertype has a number that does not exist.",
        remedy: "Choose one of docs/encoders.md.",
    }

    /// ENCODERTYPE or MENCODERTYPE names a node of a bus, which an entry of `encoders` does here.
    ENCODER_NEEDS_BUS = 10322, NoError {
        says: "",
        cause: "encodertype or mencodertype names an encoder on a bus.",
        remedy: "Name an entry of encoders in feedback of the axis instead.",
    }

    /// ENCODERTYPE names an encoder terminal that the cell does not have.
    ENCODER_NO_TERMINAL = 10323, NoError {
        says: "",
        cause: "encodertype or mencodertype names an entry of encoders that the cell does not have.",
        remedy: "Add the entry, or choose 10, 20 or 30 as there are entries.",
    }

    /// The drive closes its position loop with its own encoder.
    ENCODER_LOOP_IN_DRIVE = 10324, NoError {
        says: "",
        cause: "The drive closes its position loop itself, with its own encoder.",
        remedy: "Use interface velocity, or leave the encoder to the drive.",
    }

    /// Two parameters, or one and the cell, name different encoders.
    ENCODER_CHOSEN_TWICE = 10325, NoError {
        says: "",
        cause: "Two places name different encoders for one axis.",
        remedy: "Leave out one of feedback, encodertype and wf.md4.",
    }

    /// The zero of an absolute encoder stands.
    ABSOLUTE_ZERO_STANDS = 10326, NoError {
        says: "encodertype {plain} says that its encoder is absolute, so that its zero stands; no homing, no index \
            and no set_position",
        cause: "Homing or a new position was asked of an axis with an absolute encoder, whose zero stands.",
        remedy: "Set the zero at the encoder, or choose an incremental encodertype.",
    }

    /// A bad word of an absolute encoder was replaced by an extrapolated one.
    ENCODER_SUBSTITUTED = 10327, NoError {
        says: "a bad word of the encoder was replaced by an extrapolated one; {plain} so far",
        cause: "A word of an absolute encoder could not be right and was replaced: noise on its line.",
        remedy: "Check shield and cable of the encoder before it fails.",
    }

    /// A new zero moved the axis alone and not its encoder, because another user of the encoder began to move.
    ENCODER_NOT_SHARED = 10328, NoError {
        says: "with its new zero a position or limit of the encoder or of an axis that reads it would leave +-2^62 \
            increments, so that only this axis has it",
        cause: "A new zero was to move an encoder with several users, and one of them began to move in the same \
            cycle, or would leave its range.",
        remedy: "Stand still with all users of the encoder, then set the position again.",
    }

    /// A coupling without a master, and MENCODERTYPE names none.
    NO_MASTER = 10329, NoError {
        says: "no master is named, and mencodertype {plain} names none that the cell has; name one, or set it to -n \
            (axis n), 10, 20, 30 (an entry of encoders) or 6 (a simulated one)",
        cause: "synchronize names no master, and neither does mencodertype of the axis; or mencodertype names an axis \
            that does not exist.",
        remedy: "Name a master, or set mencodertype.",
    }

    /// The zero of an absolute encoder that leads stands.
    MASTER_ZERO_STANDS = 10330, NoError {
        says: "the encoder is absolute, so that its zero stands: no set_position of it as a master",
        cause: "A new position was asked of a master that is an absolute encoder, whose zero stands.",
        remedy: "Set the zero at the encoder, or give a coupling an offset.",
    }

    /// MD4 asks for words that the drive would have to decode.
    WF_LOOP_IN_DRIVE = 10331, NoError {
        says: "",
        cause: "The drive closes its position loop itself, and wf.md4 asks the core to decode words.",
        remedy: "Use interface velocity, or leave wf.md4 incremental.",
    }

    /// ENCODERFREQ is no clock rate.
    ENCODER_NO_RATE = 10332, NoError {
        says: "",
        cause: "encoderfreq is a distance of marks, but encodertype is not 9.",
        remedy: "Set both in one command, or encoderfreq first to 39000 to 5000000 Hz.",
    }

    /// MD16 is no parity.
    WF_NO_PARITY = 10333, NoError {
        says: "",
        cause: "wf.md16 is a position, but with wf.md4 absolute it is the parity of the words.",
        remedy: "Set wf.md16 to 0, 1 or 2 inc together with wf.md4.",
    }

    /// I_BREAK ended the goal, an enable or a reset.
    INTERRUPTED = 10341, NoError {
        says: "i_break has stopped the axis; i_continue or reset_errors lets it go on",
        cause: "The input of i_break ended what ran or was to begin: a goal, an enable, a reset.",
        remedy: "Give the edge of i_continue, or reset_errors; then give the goal again.",
    }

    /// A parameter names a digital input that the cell has not.
    NO_SUCH_INPUT = 10342, NoError {
        says: "",
        cause: "A parameter names a digital input that the cell does not have.",
        remedy: "Name one of the entries of type di, counted from 1 in file order.",
    }

    /// A parameter names a digital output that the cell has not.
    NO_SUCH_OUTPUT = 10343, NoError {
        says: "",
        cause: "A parameter names a digital output that the cell does not have.",
        remedy: "Name one of the entries of type do, counted from 1 in file order.",
    }

    /// An output that an axis switches by itself.
    OUTPUT_TAKEN = 10344, NoError {
        says: "",
        cause: "The output is switched by an axis itself: its direction, its brake.",
        remedy: "Name another output.",
    }

    /// A value that an output cannot have.
    OUTPUT_VALUE = 10345, NoError {
        says: "{plain} is no value of this output; 0 and 1 of a do, -{bound} V to {bound} V of an ao are",
        cause: "An output was to have a value that it cannot have.",
        remedy: "Give 0 or 1 to digital outputs, a voltage within full_scale, or within 10 V, to analog ones.",
    }

    /// What is to be set is no output.
    NO_OUTPUT = 10346, NoError {
        says: "this is no output; a do or an ao may be set",
        cause: "set_output named an entry that is no output.",
        remedy: "Name an entry of type do or ao.",
    }

    /// REVERS asks for outputs of an axis whose drive gets positions.
    REVERSING_BY_POSITION = 10347, NoError {
        says: "",
        cause: "revers asks for outputs that show the sign of a velocity, and the drive gets positions.",
        remedy: "Use interface velocity or open_loop, or a revers of 0, 1 or 2.",
    }

    /// A parameter names an output that has another function already.
    OUTPUT_SHARED = 10356, NoError {
        says: "{key} names output {plain}, which has another function already",
        cause: "A parameter names an output that a brake, section wf or another parameter switches.",
        remedy: "Give each function an output of its own.",
    }

    /// A drive is to home by itself and cannot.
    HOMING_NOT_OFFERED = 10357, NoError {
        says: "homing.in_drive may not be true: the drive cannot home by itself",
        cause: "homing.in_drive is set, and the backend of the drive offers no homing.",
        remedy: "Leave homing.in_drive false: the axis homes with its own motion.",
    }

    /// A latch of a drive that has none is waited for.
    LATCH_NOT_OFFERED = 10358, NoError {
        says: "",
        cause: "A touch probe, or engage ON_EVENT, waits for a latch of a drive, and the backend of the drive offers none.",
        remedy: "Name an input that has `latch: true`, or an encoder.",
    }

    /// A drive has sent an emergency message.
    EMERGENCY = 10359, NoError {
        says: "",
        cause: "The drive has sent an emergency message: error code (as in 603Fh), error register (1001h), five bytes of its maker.",
        remedy: "Look the code up in the manual of the drive. An error of the axis follows only where the drive goes into fault.",
    }

    /// A node of a bus has booted, fallen silent, come back, changed its state.
    NODE_CHANGED = 10370, NoError {
        says: "a node of a bus has changed its state",
        cause: "A node on CAN, of a drive, a module or an encoder, has booted, is silent, is back, is configured and operational, sends no heartbeat, or was stopped by somebody (NMT).",
        remedy: "Nothing where it is operational. Else look at its power, its cable, and who else is on the bus; it is configured again by itself.",
    }

    /// A node that is no drive of the cell has sent an emergency message.
    FOREIGN_EMERGENCY = 10371, NoError {
        says: "a node that is no drive of the cell sends an emergency message",
        cause: "A node of a bus that is no drive of the cell has sent an emergency message: error code (as in 603Fh), error register (1001h).",
        remedy: "Look the code up in the manual of that device. No axis has an error by it.",
    }

    /// The system clock was set, and stamps follow it.
    CLOCK_STEPPED = 10372, NoError {
        says: "the system clock was set; stamps follow",
        cause: "The system clock was set by more than 50 ms: by NTP or a user, or the host was suspended. Stamps of messages follow it after this event. Motion does not.",
        remedy: "Nothing, if that was meant. On a host without a real-time clock start the node after the time is synchronized.",
    }

    /// A newer command took the axis over.
    REPLACED = 10101, NoError {
        says: "a newer command took the axis over",
        cause: "A newer command took the axis over.",
        remedy: "Nothing, if that was meant.",
    }

    /// gear_out has uncoupled the axis, as was asked for: its goal has succeeded.
    GEARED_OUT = 10240, NoError {
        says: "gear_out has uncoupled the axis",
        cause: "gear_out has ended the coupling, at once or where its place was passed; the goal of synchronize has succeeded.",
        remedy: "Nothing: that was asked for.",
    }

    /// gear_out of an axis that no goal of `synchronize` couples.
    NOT_COUPLED = 10241, NoError {
        says: "no goal of synchronize couples the axis: there is nothing to leave",
        cause: "gear_out was asked of an axis that no goal of synchronize couples: it waits to engage, stops already, or something else moves it.",
        remedy: "Couple it first; cancel a goal that waits to engage.",
    }

    /// The coordinate of a window is another one.
    COORDINATE_CHANGED = 10274, NoError {
        says: "the axis has another coordinate: the window of the touch probe is not valid any more; arm it again",
        cause: "Homing, a new position of a shared encoder, another source or direction, or a drive that restarts its counts have changed the coordinate of the axis while a touch \
            probe with a window was armed.",
        remedy: "Arm it again, with a window in the coordinate of now.",
    }

    /// A latch of a touch probe while the axis has no position.
    TOUCH_PROBE_NO_POSITION = 10275, NoError {
        says: "the position of the axis is not known: the latch is not recorded",
        cause: "What a touch probe waits for has latched while the drive of the axis is offline or its encoder is not valid.",
        remedy: "See why the axis has no position; the touch probe stays armed.",
    }

    /// Tuning found no gains.
    NOT_TUNED = 10248, NoError {
        says: "no gains were found",
        cause: "~/tune has no record of the axis, no model of it, or no gains for the model; its message says why.",
        remedy: "Do what the message says; the axis is as it was, and off.",
    }

    /// halt ended the goal.
    HALTED = 10102, NoError {
        says: "halt ended the goal",
        cause: "halt ended the goal.",
        remedy: "Give a new goal.",
    }

    /// The client cancelled the goal.
    CANCELLED = 10103, NoError {
        says: "the goal was cancelled",
        cause: "The client cancelled the goal.",
        remedy: "Give a new goal.",
    }

    /// quick_stop ended the goal, an enable or a reset.
    QUICK_STOP = 10104, NoError {
        says: "quick_stop has stopped the axis",
        cause: "quick_stop ended what ran or was to begin: a goal, an enable, a reset.",
        remedy: "reset_errors where the axis is locked, enable where it is off; then give the goal again.",
    }

    /// disable ended the goal.
    DISABLED = 10105, NoError {
        says: "the axis was switched off",
        cause: "disable ended the goal.",
        remedy: "Enable the axis, then give a new goal.",
    }

    /// The goal waited for one that did not reach its end.
    NOT_REACHED = 10106, NoError {
        says: "the goal before it did not reach its end",
        cause: "The goal before it did not reach its end.",
        remedy: "See how that one ended.",
    }

    /// The goal searched for a mark that did not come.
    PROBE_MISSED = 10107, NoError {
        says: "nothing latched until the end of the search",
        cause: "No mark came until the end of the search.",
        remedy: "Check the sensor; search longer.",
    }

    /// Following error beyond `max_following_error` (MACS position error, which has no number in the source).
    FOLLOWING_ERROR = 10201, Parameter {
        says: "following error {asked} exceeds max_following_error {limit}",
        cause: "The actual position is further behind its command than max_following_error, for longer than \
            following_error_time: a weak, blocked or badly tuned drive.",
        remedy: "Check load, brake and tuning; reduce acceleration or allow more; then reset_errors.",
    }

    /// The axis stopped at `max_position`.
    SOFTWARE_LIMIT_POSITIVE = 10202, SoftwareLimit {
        says: "",
        cause: "A motion without a target, or a coupled one, came to max_position and was stopped there. As an event `limit` alone: a jog or \
            stream, which jog_at_limit stop ends without an error.",
        remedy: "In ERROR_STOP, reset_errors first. Then move or jog away from the limit.",
    }

    /// The axis stopped at `min_position`.
    SOFTWARE_LIMIT_NEGATIVE = 10203, SoftwareLimit {
        says: "",
        cause: "A motion without a target, or a coupled one, came to min_position and was stopped there. As an event `limit` alone: a jog or \
            stream, which jog_at_limit stop ends without an error.",
        remedy: "In ERROR_STOP, reset_errors first. Then move or jog away from the limit.",
    }

    /// The drive left operation enabled by itself.
    DRIVE_DISABLED = 10204, Drive {
        says: "the drive left operation enabled by itself",
        cause: "The drive left operation enabled by itself: its own enable input, its safe torque off.",
        remedy: "Remove the cause, then reset_errors.",
    }

    /// The drive did not reach operation enabled, or did not show the commanded mode, in time.
    ENABLE_TIMEOUT = 10205, Drive {
        says: "the drive was not enabled in time",
        cause: "Within `enable_timeout` of the drive (5 s where the cell says nothing else) it did not reach operation enabled (6041h), or did \
            not show the mode that it is commanded in (6061h); the message says which.",
        remedy: "State: check supply and enable inputs of the drive. Mode: check that the drive offers it (6502h) and takes it (6060h). Then \
            reset_errors.",
    }

    /// An encoder gives no valid value.
    ENCODER_INVALID = 10206, Feedback {
        says: "the encoder gives no valid value",
        cause: "An encoder gives no valid value.",
        remedy: "Check its cable and supply, then reset_errors.",
    }

    /// What the axis follows is lost (its encoder is invalid or its drive is away).
    LEADER_LOST = 10207, Ends {
        says: "what the axis follows is lost",
        cause: "What the axis follows is lost: its encoder is invalid or its drive is away.",
        remedy: "Bring the leader back, reset_errors, couple again.",
    }

    /// A drive gave no new data for too long.
    DRIVE_STALE = 10208, Drive {
        says: "the drive sent nothing new for more than missed_cycles",
        cause: "The drive sent nothing new for more than `missed_cycles` of it: 10 where the cell says nothing else.",
        remedy: "Check the load of the bus and the cycle, then reset_errors.",
    }

    /// Streamed setpoints stopped coming.
    STREAM_TIMEOUT = 10209, NoError {
        says: "streamed setpoints stopped coming",
        cause: "Streamed setpoints stopped coming; the axis was stopped.",
        remedy: "Send them faster than setpoint_timeout.",
    }

    /// The encoder jumped further in one cycle than any motion explains.
    ENCODER_JUMP = 10210, Ends {
        says: "the encoder jumped by {asked} in one cycle; its axis moves {limit} at most",
        cause: "A leader or encoder jumped further in one cycle than any motion explains.",
        remedy: "Check the encoder, then reset_errors.",
    }

    /// Gear motion beyond `max_velocity` or `max_acceleration`: the axis lags and catches up.
    SYNC_LOST = 10211, NoError {
        says: "the leader is faster than the axis may be; it lags and catches up",
        cause: "The leader is faster than the axis may be; it lags and catches up.",
        remedy: "Slow the leader down, or raise the limits.",
    }

    /// No mark came by where it should.
    MARK_MISSED = 10230, NoError {
        says: "",
        cause: "A mark of the axis or of its master has stayed away; told once until the next one comes.",
        remedy: "Check sensor and marks, syncmpulsm, syncmpulss, and the windows.",
    }

    /// A mark came where none should.
    MARK_EXTRA = 10231, NoError {
        says: "",
        cause: "A mark of the axis or of its master came outside its window, and corrects nothing; told once until the next good one.",
        remedy: "Check sensor and marks, syncmpulsm, syncmpulss, and the windows.",
    }

    /// More pairs of marks in a row were inaccurate than are tolerated.
    MARK_FAULT = 10232, NoError {
        says: "the marks are {asked} inc apart, and more often in a row beyond {limit} inc than syncfault tolerates",
        cause: "More pairs of marks in a row than syncfault tolerates were further apart than syncaccuracy.",
        remedy: "Check marks and sensors, or let corrections be larger: syncmmaxcorr, syncmftime, syncofftime.",
    }

    /// A smooth start of a coupling by marks became start 5.
    SMOOTH_START_FALLBACK = 10243, NoError {
        says: "",
        cause: "The smooth start of a coupling by marks (syncmstart 7, 1007) could not begin, or its curve could not go on: syncmstart 5 (1005) took its place, which catches up within the limits of the axis.",
        remedy: "The sentence says why: let the leader run evenly before, move the axis over a mark first, or give the goal more acceleration.",
    }

    /// Cycles were missed.
    OVERRUN = 10212, NoError {
        says: "",
        cause: "Cycles were missed: the computer was busy.",
        remedy: "See docs/realtime.md.",
    }

    /// The drive did not leave its fault after the reset.
    RESET_FAILED = 10213, NoError {
        says: "the drive did not leave its fault within 5 s",
        cause: "The drive did not leave its fault within 5 s.",
        remedy: "Remove the cause of the fault, then reset_errors again.",
    }

    /// More events in one cycle than there is room for.
    EVENTS_LOST = 10214, NoError {
        says: "{plain} events of this cycle had no room",
        cause: "More events came in one cycle than there is room for.",
        remedy: "Give fewer commands in one cycle.",
    }

    /// More latches in one cycle than the inputs have room for.
    LATCHES_LOST = 10215, NoError {
        says: "{plain} latches of this cycle had no room",
        cause: "More latches came in one cycle than there is room for.",
        remedy: "Check the inputs for bouncing.",
    }

    /// Cycles are missing in the recording: the disk did not keep up.
    RECORD_LOST = 10216, NoError {
        says: "",
        cause: "The disk did not keep up: cycles are missing in the recording.",
        remedy: "Record to a faster disk.",
    }

    /// The recording stopped: the system refused to write it.
    RECORD_FAILED = 10217, NoError {
        says: "",
        cause: "The system refused to write the recording.",
        remedy: "Make room, check the rights; start a new recording.",
    }

    /// The flight recorder could not save its bag.
    FLIGHT_FAILED = 10218, NoError {
        says: "",
        cause: "The flight recorder could not save its bag.",
        remedy: "Make room, check the folder.",
    }

    /// The drive did not acknowledge a setpoint in time (profile position).
    SETPOINT_NOT_ACKNOWLEDGED = 10219, Drive {
        says: "the drive did not acknowledge a setpoint in time (mode pp, bit 12 of 6041h)",
        cause: "Mode pp: the drive did not acknowledge a setpoint within 500 ms (25 cycles, if a cycle is longer than 20 ms), or its acknowledgement \
            (bit 12 of 6041h) stayed from the setpoint before; the axis does not follow.",
        remedy: "Check that 6040h and 607Ah reach the drive and that it takes setpoints at once (bit 5 of 6040h); modes ip and csp need no \
            acknowledgement. Then reset_errors.",
    }

    /// The limit switch at the end of rising counts was reached.
    HARDWARE_LIMIT_POSITIVE = 10221, Switch {
        says: "the positive limit switch was reached",
        cause: "The limit switch at the end of rising counts was reached, or its wire is broken.",
        remedy: "reset_errors, then move back off the switch; where it cannot, push it back or unassign the switch \
            for that time.",
    }

    /// The limit switch at the end of falling counts was reached.
    HARDWARE_LIMIT_NEGATIVE = 10222, Switch {
        says: "the negative limit switch was reached",
        cause: "The limit switch at the end of falling counts was reached, or its wire is broken.",
        remedy: "reset_errors, then move back off the switch; where it cannot, push it back or unassign the switch \
            for that time.",
    }

    /// Both limit switches are actuated at once: a broken cable, or a stop contact that opens both lines.
    BOTH_LIMIT_SWITCHES = 10223, Switch {
        says: "both limit switches are actuated: a broken cable, or an open stop contact",
        cause: "Both limit switches are actuated at once: a broken cable, or a stop contact that opens both lines.",
        remedy: "Repair the cable, close the contact, then reset_errors.",
    }

    /// Another axis had a following error, which stops all.
    STOPPED_WITH_OTHER = 10224, Parameter {
        says: "stopped, because another axis has a following error",
        cause: "Another axis had a following error, and its following_error_stops_all is 1.",
        remedy: "Remove the cause at the axis that the sentence names, then reset_errors of all.",
    }

    /// The emergency stop input of the cell is open.
    EMERGENCY_STOP = 10225, EmergencyStop {
        says: "the emergency stop is open",
        cause: "The emergency stop input of the cell reads 0: pressed, or its wire is broken.",
        remedy: "Release it, then reset_errors; while it is open the error comes back.",
    }

    /// The interlock input of the cell is open.
    INTERLOCK = 10226, Interlock {
        says: "the interlock is open",
        cause: "The interlock input of the cell reads 0: a guard is open, or its wire is broken.",
        remedy: "Close the guard, then reset_errors; while it is open the error comes back.",
    }

    /// The goal has waited for its target window for longer than in_position_timeout.
    IN_POSITION_TIMEOUT = 10227, NoError {
        says: "the goal waits for its target window: {asked} from the target, {limit} is allowed",
        cause: "The axis does not come into its target window: the window is too small for what its drive leaves.",
        remedy: "Widen in_position_window, or tune the drive; halt ends the wait.",
    }

    /// The two drives of the axis are too far from square.
    SKEW = 10233, Skew {
        says: "the two drives are {asked} from square; max_skew {limit} is allowed",
        cause: "The second drive of an axis is further from square with the first one than max_skew: one of them is blocked, weak or has \
            slipped; or it was moved by hand while it was off.",
        remedy: "Free it and bring it square by hand, then reset_errors and home the axis.",
    }

    /// Homing finds the two drives further from square than it may bring them.
    NOT_SQUARE = 10234, Search {
        says: "the reference switches find the two drives {asked} from square; squaring_distance {limit} is allowed",
        cause: "The reference switch of one drive of an axis came more than squaring_distance after that of the other: it is stuck, cut \
            off or out of its place, or the axis is bent.",
        remedy: "Check both switches, bring the axis square by hand; or raise squaring_distance; then reset_errors and home again.",
    }

    /// The second drive of the axis tells no position.
    SECOND_UNREAD = 10235, Drive {
        says: "the second drive tells no position",
        cause: "The words of the second drive of an axis cannot be used, so it is unknown whether it is square.",
        remedy: "Check its encoder and cable, then reset_errors.",
    }

    /// What is square is where the drives stand.
    SQUARE_ASSUMED = 10236, NoError {
        says: "a drive counts anew; what was moved meanwhile counts as square",
        cause: "A drive of an axis with two restarted its counts, and the offset between both is unknown: their present positions count as \
            square.",
        remedy: "See to it that the axis is square, and home it.",
    }

    /// The loop that is closed here has lost its axis.
    RUNAWAY = 10237, Feedback {
        says: "the loop does not bring the axis back: following error {asked}, {limit} is allowed",
        cause: "After an error the loop that is closed here was to stop the axis, and its following error grew to twice what is allowed, or \
            became no smaller: motor or encoder are wired the wrong way, the encoder is dead, or the drive does not follow.",
        remedy: "Check the direction of motor and encoder (posdrct), the encoder and its cable, then reset_errors.",
    }

    /// The encoder stands while the loop that is closed here asks its drive to move.
    ENCODER_STANDS = 10239, Feedback {
        says: "the encoder has counted nothing while the drive was asked to move by {asked}; {limit} is allowed",
        cause: "The loop that is closed here asks its drive to move, and the encoder counts nothing: the encoder is dead, its cable cut, or the \
            axis is blocked.",
        remedy: "Free the axis, check the encoder and its cable, then reset_errors.",
    }

    /// Motor and load do not move together.
    ENCODERS_APART = 10087, Feedback {
        says: "the encoders of motor and load are {asked} apart; {limit} is allowed",
        cause: "The encoder of the velocity loop and that of the position loop did not move together: one of them is dead or counts the wrong \
            way, what is between motor and load is broken or slips, or ampencres, ampencrpm and max_velocity do not fit each other.",
        remedy: "Check both encoders, coupling or belt, the digits of posdrct, ampencres and ampencrpm, then reset_errors.",
    }

    /// Too fast while no position loop holds it.
    OVERSPEED = 10244, Ends {
        says: "the axis is too fast for one whose position loop is open: {asked}, {limit} is allowed",
        cause: "While out_an held the position loop open, the axis was faster than 1.2 max_velocity.",
        remedy: "Give smaller values, then reset_errors.",
    }

    /// The current comes near its limit.
    I2T_NEAR = 10238, NoError {
        says: "the motor is loaded near its I2t limit: {asked}, {limit} is allowed",
        cause: "The filtered squared current is above 90 % of i2tlimit.",
        remedy: "Reduce load or acceleration, or let the motor cool.",
    }

    /// A way of homing that squares nothing.
    GANTRY_HOMING = 10361, NoError {
        says: "",
        cause: "The method of homing does not square an axis with two drives.",
        remedy: "Choose one that seeks a reference switch, or 35 or 37, which take the zero where the axis stands.",
    }

    /// Another source of its position than the drives of an axis with two.
    GANTRY_SOURCE = 10362, NoError {
        says: "",
        cause: "A parameter names another source of the position than the words of both drives of the axis.",
        remedy: "Leave it out; give the form of the words in feedback.",
    }

    /// An axis with two drives and no limit of its skew.
    GANTRY_NO_LIMIT = 10363, NoError {
        says: "max_skew is missing; a distance above 0 is expected",
        cause: "An axis with two drives is to have no max_skew.",
        remedy: "Give it one.",
    }

    /// Homing in the drives of an axis with two.
    GANTRY_IN_DRIVE = 10364, NoError {
        says: "",
        cause: "The drives of an axis with two are to home by themselves: each would move alone.",
        remedy: "Leave homing.in_drive out.",
    }

    /// One input for the reference switches of both drives of an axis.
    GANTRY_ONE_SWITCH = 10365, NoError {
        says: "",
        cause: "The reference switches of both drives of an axis are to be one input, which does not show what is square.",
        remedy: "Give each drive a reference switch of its own.",
    }

    /// An abort ended the goal, and has locked the axis.
    ABORTED = 10228, NoError {
        says: "abort has stopped the axis; reset_errors lets it go on",
        cause: "abort, the Esc of MACS, ended what ran or was to begin, and has locked all axes that are on.",
        remedy: "reset_errors, which opens the brake of the axis; open one that o_brake names with set_output; enable \
            what is off. Then give the goal again.",
    }

    /// The master of a cam runs more than a period of it in a cycle.
    CAM_MASTER_TOO_FAST = 10229, Ends {
        says: "its master runs {asked} inc in one cycle; {limit} inc are its whole cam",
        cause: "The master of a cam moved by more than the length of its table in one cycle: the table says nothing then.",
        remedy: "Slow the master down, or choose a smaller master_scale, then reset_errors.",
    }
}
