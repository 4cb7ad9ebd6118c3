//! How goals ended, and what has failed.

use super::codes;

codes! {
    HOMING_UNDER_WAY = 10301, NoError, "the axis is homing; wait for its end, or cancel it",
        "The axis homes, and the command needs its zero, or would disturb it." => "Wait for the end of homing.";
    HOMING_NO_METHOD = 10302, NoError, "homing.method is 0: give the axis a method, or name one in the command",
        "Homing was asked for, and homing.method is 0." => "Set homing.method, or name a method.";
    HOMING_UNKNOWN_METHOD = 10303, NoError, "scheme macs has no homing method {asked}; 0 to {limit}, its home_type, are allowed",
        "There is no such method." => "Choose one of docs/homing.md.";
    HOMING_NO_VELOCITY = 10304, NoError, "homing.velocity is 0; give one above 0, or below 0 for the other direction",
        "Homing was asked for with a velocity of 0." => "Set homing.velocity (home_vel).";
    HOMING_NO_SWITCH = 10305, NoError, "",
        "The homing method needs a switch that is not read: a home_type of MACS has no input at i_refswitch, or the digital inputs of a \
            drive on CAN (60FDh) are not read."
        => "Assign an input (i_refswitch, i_poslimitsw, i_neglimitsw), give the drive its `eds`, or choose a method without a switch.";
    HOMING_SWITCH_MISSED = 10306, Search, "the switch did not change within homing.max_distance {limit}",
        "Homing went homing.max_distance without finding its switch: a switch that is stuck, cut off or wired to another input."
        => "Check the switch and its signal, then reset_errors and home again; or raise homing.max_distance.";
    HOMING_INDEX_MISSED = 10307, Search, "no index pulse came within homing.index_distance {limit}",
        "Homing went homing.index_distance without an index pulse: the encoder has none, or its track is cut."
        => "Check the encoder's index and its cable; or choose a method without an index; then reset_errors and home again.";
    HOMING_AT_LIMIT = 10308, Search, "a limit switch ended the search for the reference",
        "Homing ran onto a limit switch that its method has no use for."
        => "Check the reference switch, choose a method that turns round at the limit switches, then reset_errors and home again.";
    HOMING_NEEDS_DRIVE = 10309, NoError, "the axis is virtual, without switches and index: it needs homing method 35 or 37",
        "Homing of a virtual axis was asked for, which has no switches, by another method than 35 and 37." => "Use set_position.";
    HOMING_IN_DRIVE_FAILED = 10310, Search, "the drive did not find its zero", "The drive homes by itself and told that it failed."
        => "See the drive's own code, then reset_errors and home again.";
    HOMING_IN_DRIVE_TIMEOUT = 10311, Search, "the drive did not take up mode 6, homing, or its own mode after it within 5 s",
        "The drive did not take mode 6, left it before its homing was over, or did not return to its own mode after it."
        => "Check that it can home by itself; or set homing.in_drive to false.";
    HOMING_NOT_IN_DRIVE = 10312, NoError, "", "A sequence of MACS was asked of a drive that homes by itself."
        => "Choose a method of CiA 402, or set homing.in_drive to false.";
    HOMING_LOST = 10313, Search, "the zero is no longer known; home the axis again",
        "The zero is not known any more: the drive restarted its counts, or a parameter of encoder, direction or homing was changed."
        => "Home the axis.";
    HOMING_LEFT = 10314, NoError, "another reference was selected, and that ended homing: the axis has no new zero",
        "While reference 5 of the selector homed the axis, another reference was selected."
        => "Nothing, if that was meant; else select 5 again.";
    HOMING_TOO_LONG = 10315, Search, "homing has lasted for longer than homing.max_time {limit}",
        "Homing did not find the zero within homing.max_time."
        => "Check the switches, and the homing of the drive where it homes by itself, then reset_errors and home again; or raise \
            homing.max_time.";
    HOMING_LASTS = 10316, NoError, "homing in the drive has lasted for {asked} and goes on; homing.max_time limits it",
        "The drive homes by itself and has shown no end for a minute, two, and so on."
        => "Look at the axis: halt ends homing; set homing.max_time to have it end by itself.";
    HOMING_NOT_BEGUN = 10317, Search,
        "the drive is in mode 6, homing, and has not begun within 5 s: bits 10 and 12 of 6041h are still those of an earlier homing",
        "The drive is in mode 6 and has cleared neither bit 10 nor bit 12 of its status word (6041h) since bit 4 of the control word rose."
        => "Check that homing by bit 4 of the control word is enabled in the drive, and that it knows the method (6098h).";
    ENCODER_UNKNOWN_TYPE = 10321, NoError, "", "encodertype or mencodertype has a number that does not exist."
        => "Choose one of docs/encoders.md.",
        refusal: "is no type of encoder";
    ENCODER_NEEDS_BUS = 10322, NoError, "", "encodertype or mencodertype names an encoder on a bus."
        => "Name an entry of encoders in feedback of the axis instead.",
        refusal: "names a node of a bus, which an entry of encoders does (key feedback of the axis reads it); the types 0 to 5, 9, 10, 20, \
            30 exist, for a master 0, 1, 2, 5, 6, 10, 20, 30 and -1 to -999";
    ENCODER_NO_TERMINAL = 10323, NoError, "", "encodertype or mencodertype names an entry of encoders that the cell does not have."
        => "Add the entry, or choose 10, 20 or 30 as there are entries.",
        refusal: "names an entry of section encoders that the cell does not have: 10 is the first one";
    ENCODER_LOOP_IN_DRIVE = 10324, NoError, "", "The drive closes its position loop itself, with its own encoder."
        => "Use interface velocity, or leave the encoder to the drive.",
        refusal: "names an encoder that a drive with interface position does not close its loop with; 0, 1, 2, 5 and 9 are allowed";
    ENCODER_CHOSEN_TWICE = 10325, NoError, "", "Two places name different encoders for one axis."
        => "Leave out one of feedback, encodertype and wf.md4.",
        refusal: "names another encoder than key feedback of the axis or its wf.md4 does; one of them may choose";
    ABSOLUTE_ZERO_STANDS = 10326, NoError,
        "encodertype {plain} says that its encoder is absolute, so that its zero stands; no homing, no index and no set_position",
        "Homing or a new position was asked of an axis with an absolute encoder, whose zero stands."
        => "Set the zero at the encoder, or choose an incremental encodertype.";
    ENCODER_SUBSTITUTED = 10327, NoError, "a bad word of the encoder was replaced by an extrapolated one; {plain} so far",
        "A word of an absolute encoder could not be right and was replaced: noise on its line."
        => "Check shield and cable of the encoder before it fails.";
    ENCODER_NOT_SHARED = 10328, NoError,
        "with its new zero a position or limit of the encoder or of an axis that reads it would leave +-2^62 increments, so that only this \
            axis has it",
        "A new zero was to move an encoder with several users, and one of them began to move in the same cycle, or would leave its range."
        => "Stand still with all users of the encoder, then set the position again.";
    NO_MASTER = 10329, NoError,
        "no master is named, and mencodertype {plain} names none that the cell has; name one, or set it to -n (axis n), 10, 20, 30 (an \
            entry of encoders) or 6 (a simulated one)",
        "synchronize names no master, and neither does mencodertype of the axis; or mencodertype names an axis that does not exist."
        => "Name a master, or set mencodertype.",
        refusal: "names an axis that the cell does not have: -1 is the first one";
    MASTER_ZERO_STANDS = 10330, NoError, "the encoder is absolute, so that its zero stands: no set_position of it as a master",
        "A new position was asked of a master that is an absolute encoder, whose zero stands."
        => "Set the zero at the encoder, or give a coupling an offset.";
    WF_LOOP_IN_DRIVE = 10331, NoError, "", "The drive closes its position loop itself, and wf.md4 asks the core to decode words."
        => "Use interface velocity, or leave wf.md4 incremental.",
        refusal: "asks for words in Gray code, which a drive with interface position decodes itself; 0 (incremental) is allowed";
    ENCODER_NO_RATE = 10332, NoError, "", "encoderfreq is a distance of marks, but encodertype is not 9."
        => "Set both in one command, or encoderfreq first to 39000 to 5000000 Hz.",
        refusal: "is no clock rate; 39000 to 5000000 Hz are allowed, or with encodertype 9 any distance of marks above 0";
    WF_NO_PARITY = 10333, NoError, "", "wf.md16 is a position, but with wf.md4 absolute it is the parity of the words."
        => "Set wf.md16 to 0, 1 or 2 inc together with wf.md4.",
        refusal: "is no parity; with wf.md4 absolute 0 inc (none), 1 inc (even) and 2 inc (odd) are allowed";
    INTERRUPTED = 10341, NoError, "i_break has stopped the axis; i_continue or reset_errors lets it go on",
        "The input of i_break ended what ran or was to begin: a goal, an enable, a reset."
        => "Give the edge of i_continue, or reset_errors; then give the goal again.";
    NO_SUCH_INPUT = 10342, NoError, "", "A parameter names a digital input that the cell does not have."
        => "Name one of the entries of type di, counted from 1 in file order.";
    NO_SUCH_OUTPUT = 10343, NoError, "", "A parameter names a digital output that the cell does not have."
        => "Name one of the entries of type do, counted from 1 in file order.";
    OUTPUT_TAKEN = 10344, NoError, "", "The output is switched by an axis itself: its direction, its brake." => "Name another output.";
    OUTPUT_VALUE = 10345, NoError, "{plain} is no value of this output; 0 and 1 of a do, -{bound} V to {bound} V of an ao are",
        "An output was to have a value that it cannot have."
        => "Give 0 or 1 to digital outputs, a voltage within full_scale, or within 10 V, to analog ones.";
    NO_OUTPUT = 10346, NoError, "this is no output; a do or an ao may be set", "set_output named an entry that is no output."
        => "Name an entry of type do or ao.";
    REVERSING_BY_POSITION = 10347, NoError, "", "revers asks for outputs that show the sign of a velocity, and the drive gets positions."
        => "Use interface velocity or open_loop, or a revers of 0, 1 or 2.",
        refusal: "asks for outputs, which tell the sign of a velocity to drives with interface velocity or open_loop; 0, 1 and 2 are \
            allowed";
    OUTPUT_SHARED = 10356, NoError, "{key} names output {plain}, which has another function already",
        "A parameter names an output that a brake, section wf or another parameter switches." => "Give each function an output of its own.";
    HOMING_NOT_OFFERED = 10357, NoError, "homing.in_drive may not be true: the drive cannot home by itself",
        "homing.in_drive is set, and the backend of the drive offers no homing."
        => "Leave homing.in_drive false: the axis homes with its own motion.";
    LATCH_NOT_OFFERED = 10358, NoError, "",
        "A touch probe, or engage ON_EVENT, waits for a latch of a drive, and the backend of the drive offers none."
        => "Name an input that has `latch: true`, or an encoder.";
    EMERGENCY = 10359, NoError, "",
        "The drive has sent an emergency message: error code (as in 603Fh), error register (1001h), five bytes of its maker."
        => "Look the code up in the manual of the drive. An error of the axis follows only where the drive goes into fault.";
    NODE_CHANGED = 10370, NoError, "a node of a bus has changed its state",
        "A node on CAN, of a drive, a module or an encoder, has booted, is silent, is back, is configured and operational, sends no \
            heartbeat, or was stopped by somebody (NMT)."
        => "Nothing where it is operational. Else look at its power, its cable, and who else is on the bus; it is configured again by \
            itself.";
    FOREIGN_EMERGENCY = 10371, NoError, "a node that is no drive of the cell sends an emergency message",
        "A node of a bus that is no drive of the cell has sent an emergency message: error code (as in 603Fh), error register (1001h)."
        => "Look the code up in the manual of that device. No axis has an error by it.";
    CLOCK_STEPPED = 10372, NoError, "the system clock was set; stamps follow",
        "The system clock was set by more than 50 ms: by NTP or a user, or the host was suspended. Stamps of messages follow it after this \
            event. Motion does not."
        => "Nothing, if that was meant. On a host without a real-time clock start the node after the time is synchronized.";
    REPLACED = 10101, NoError, "a newer command took the axis over", "A newer command took the axis over." => "Nothing, if that was meant.";
    GEARED_OUT = 10240, NoError, "gear_out has uncoupled the axis",
        "gear_out has ended the coupling, at once or where its place was passed; the goal of synchronize has succeeded."
        => "Nothing: that was asked for.";
    NOT_COUPLED = 10241, NoError, "no goal of synchronize couples the axis: there is nothing to leave",
        "gear_out was asked of an axis that no goal of synchronize couples: it waits to engage, stops already, or something else moves it."
        => "Couple it first; cancel a goal that waits to engage.";
    COORDINATE_CHANGED = 10274, NoError,
        "the axis has another coordinate: the window of the touch probe is not valid any more; arm it again",
        "Homing, a new position of a shared encoder, another source or direction, or a drive that restarts its counts have changed the \
            coordinate of the axis while a touch probe with a window was armed."
        => "Arm it again, with a window in the coordinate of now.";
    TOUCH_PROBE_NO_POSITION = 10275, NoError, "the position of the axis is not known: the latch is not recorded",
        "What a touch probe waits for has latched while the drive of the axis is offline or its encoder is not valid."
        => "See why the axis has no position; the touch probe stays armed.";
    NOT_TUNED = 10248, NoError, "no gains were found",
        "~/tune has no record of the axis, no model of it, or no gains for the model; its message says why."
        => "Do what the message says; the axis is as it was, and off.";
    HALTED = 10102, NoError, "halt ended the goal", "halt ended the goal." => "Give a new goal.";
    CANCELLED = 10103, NoError, "the goal was cancelled", "The client cancelled the goal." => "Give a new goal.";
    QUICK_STOP = 10104, NoError, "quick_stop has stopped the axis", "quick_stop ended what ran or was to begin: a goal, an enable, a reset."
        => "reset_errors where the axis is locked, enable where it is off; then give the goal again.";
    DISABLED = 10105, NoError, "the axis was switched off", "disable ended the goal." => "Enable the axis, then give a new goal.";
    NOT_REACHED = 10106, NoError, "the goal before it did not reach its end", "The goal before it did not reach its end."
        => "See how that one ended.";
    PROBE_MISSED = 10107, NoError, "nothing latched until the end of the search", "No mark came until the end of the search."
        => "Check the sensor; search longer.";
    /// MACS: position error, which has no number in the source.
    FOLLOWING_ERROR = 10201, Parameter, "following error {asked} exceeds max_following_error {limit}",
        "The actual position is further behind its command than max_following_error, for longer than following_error_time: a weak, blocked \
            or badly tuned drive."
        => "Check load, brake and tuning; reduce acceleration or allow more; then reset_errors.";
    SOFTWARE_LIMIT_POSITIVE = 10202, SoftwareLimit, "",
        "A motion without a target, or a coupled one, came to max_position and was stopped there. As an event `limit` alone: a jog or \
            stream, which jog_at_limit stop ends without an error."
        => "Move or jog away from the limit; in ERROR_STOP after reset_errors.";
    SOFTWARE_LIMIT_NEGATIVE = 10203, SoftwareLimit, "",
        "A motion without a target, or a coupled one, came to min_position and was stopped there. As an event `limit` alone: a jog or \
            stream, which jog_at_limit stop ends without an error."
        => "Move or jog away from the limit; in ERROR_STOP after reset_errors.";
    DRIVE_DISABLED = 10204, Drive, "the drive left operation enabled by itself",
        "The drive left operation enabled by itself: its own enable input, its safe torque off." => "Remove the cause, then reset_errors.";
    ENABLE_TIMEOUT = 10205, Drive, "the drive was not enabled in time",
        "Within `enable_timeout` of the drive (5 s where the cell says nothing else) it did not reach operation enabled (6041h), or did \
            not show the mode that it is commanded in (6061h); the message says which."
        => "State: check supply and enable inputs of the drive. Mode: check that the drive offers it (6502h) and takes it (6060h). Then \
            reset_errors.";
    ENCODER_INVALID = 10206, Feedback, "the encoder gives no valid value", "An encoder gives no valid value."
        => "Check its cable and supply, then reset_errors.";
    LEADER_LOST = 10207, Ends, "what the axis follows is lost",
        "What the axis follows is lost: its encoder is invalid or its drive is away."
        => "Bring the leader back, reset_errors, couple again.";
    DRIVE_STALE = 10208, Drive, "the drive sent nothing new for more than missed_cycles",
        "The drive sent nothing new for more than `missed_cycles` of it: 10 where the cell says nothing else."
        => "Check the load of the bus and the cycle, then reset_errors.";
    STREAM_TIMEOUT = 10209, NoError, "streamed setpoints stopped coming", "Streamed setpoints stopped coming; the axis was stopped."
        => "Send them faster than setpoint_timeout.";
    ENCODER_JUMP = 10210, Ends, "the encoder jumped by {asked} in one cycle; its axis moves {limit} at most",
        "A leader or encoder jumped further in one cycle than any motion explains." => "Check the encoder, then reset_errors.";
    /// Its gear asks for more than `max_velocity` or `max_acceleration`.
    SYNC_LOST = 10211, NoError, "the leader is faster than the axis may be; it lags and catches up",
        "The leader is faster than the axis may be; it lags and catches up." => "Slow the leader down, or raise the limits.";
    MARK_MISSED = 10230, NoError, "", "A mark of the axis or of its master has stayed away; told once until the next one comes."
        => "Check sensor and marks, syncmpulsm, syncmpulss, and the windows.";
    MARK_EXTRA = 10231, NoError, "",
        "A mark of the axis or of its master came outside its window, and corrects nothing; told once until the next good one."
        => "Check sensor and marks, syncmpulsm, syncmpulss, and the windows.";
    MARK_FAULT = 10232, NoError, "the marks are {asked} inc apart, and more often in a row beyond {limit} inc than syncfault tolerates",
        "More pairs of marks in a row than syncfault tolerates were further apart than syncaccuracy."
        => "Check marks and sensors, or let corrections be larger: syncmmaxcorr, syncmftime, syncofftime.";
    SMOOTH_START_FALLBACK = 10243, NoError, "",
        "The smooth start of a coupling by marks (syncmstart 7, 1007) could not begin, or its curve could not go on: syncmstart 5 (1005) \
            took its place, which catches up within the limits of the axis."
        => "The sentence says why: let the leader run evenly before, move the axis over a mark first, or give the goal more acceleration.";
    OVERRUN = 10212, NoError, "", "Cycles were missed: the computer was busy." => "See docs/realtime.md.";
    RESET_FAILED = 10213, NoError, "the drive did not leave its fault within 5 s", "The drive did not leave its fault within 5 s."
        => "Remove the cause of the fault, then reset_errors again.";
    EVENTS_LOST = 10214, NoError, "{plain} events of this cycle had no room", "More events came in one cycle than there is room for."
        => "Give fewer commands in one cycle.";
    LATCHES_LOST = 10215, NoError, "{plain} latches of this cycle had no room", "More latches came in one cycle than there is room for."
        => "Check the inputs for bouncing.";
    RECORD_LOST = 10216, NoError, "", "The disk did not keep up: cycles are missing in the recording." => "Record to a faster disk.";
    RECORD_FAILED = 10217, NoError, "", "The system refused to write the recording."
        => "Make room, check the rights; start a new recording.";
    FLIGHT_FAILED = 10218, NoError, "", "The flight recorder could not save its bag." => "Make room, check the folder.";
    SETPOINT_NOT_ACKNOWLEDGED = 10219, Drive, "the drive did not acknowledge a setpoint in time (mode pp, bit 12 of 6041h)",
        "Mode pp: the drive did not acknowledge a setpoint within 500 ms (25 cycles, if a cycle is longer than 20 ms), or its \
            acknowledgement (bit 12 of 6041h) stayed from the setpoint before; the axis does not follow."
        => "Check that 6040h and 607Ah reach the drive and that it takes setpoints at once (bit 5 of 6040h); modes ip and csp need no \
            acknowledgement. Then reset_errors.";
    HARDWARE_LIMIT_POSITIVE = 10221, Switch, "the positive limit switch was reached",
        "The limit switch at the end of rising counts was reached, or its wire is broken."
        => "reset_errors, then move back off the switch; where it cannot, push it back or unassign the switch for that time.";
    HARDWARE_LIMIT_NEGATIVE = 10222, Switch, "the negative limit switch was reached",
        "The limit switch at the end of falling counts was reached, or its wire is broken."
        => "reset_errors, then move back off the switch; where it cannot, push it back or unassign the switch for that time.";
    BOTH_LIMIT_SWITCHES = 10223, Switch, "both limit switches are actuated: a broken cable, or an open stop contact",
        "Both limit switches are actuated at once: a broken cable, or a stop contact that opens both lines."
        => "Repair the cable, close the contact, then reset_errors.";
    STOPPED_WITH_OTHER = 10224, Parameter, "stopped, because another axis has a following error",
        "Another axis had a following error, and its following_error_stops_all is 1."
        => "Remove the cause at the axis that the sentence names, then reset_errors of all.";
    EMERGENCY_STOP = 10225, EmergencyStop, "the emergency stop is open",
        "The emergency stop input of the cell reads 0: pressed, or its wire is broken."
        => "Release it, then reset_errors; while it is open the error comes back.";
    INTERLOCK = 10226, Interlock, "the interlock is open",
        "The interlock input of the cell reads 0: a guard is open, or its wire is broken."
        => "Close the guard, then reset_errors; while it is open the error comes back.";
    IN_POSITION_TIMEOUT = 10227, NoError, "the goal waits for its target window: {asked} from the target, {limit} is allowed",
        "The axis does not come into its target window: the window is too small for what its drive leaves."
        => "Widen in_position_window, or tune the drive; halt ends the wait.";
    SKEW = 10233, Skew, "the two drives are {asked} from square; max_skew {limit} is allowed",
        "The second drive of an axis is further from square with the first one than max_skew: one of them is blocked, weak or has slipped; \
            or it was moved by hand while it was off."
        => "Free it and bring it square by hand, then reset_errors and home the axis.";
    NOT_SQUARE = 10234, Search, "the reference switches find the two drives {asked} from square; squaring_distance {limit} is allowed",
        "The reference switch of one drive of an axis came more than squaring_distance after that of the other: it is stuck, cut off or \
            out of its place, or the axis is bent."
        => "Check both switches, bring the axis square by hand; or raise squaring_distance; then reset_errors and home again.";
    SECOND_UNREAD = 10235, Drive, "the second drive tells no position",
        "The words of the second drive of an axis cannot be used, so it is unknown whether it is square."
        => "Check its encoder and cable, then reset_errors.";
    SQUARE_ASSUMED = 10236, NoError, "a drive counts anew; what was moved meanwhile counts as square",
        "A drive of an axis with two restarted its counts, and the offset between both is unknown: their present positions count as square."
        => "See to it that the axis is square, and home it.";
    RUNAWAY = 10237, Feedback, "the loop does not bring the axis back: following error {asked}, {limit} is allowed",
        "After an error the loop that is closed here was to stop the axis, and its following error grew to twice what is allowed, or \
            became no smaller: motor or encoder are wired the wrong way, the encoder is dead, or the drive does not follow."
        => "Check the direction of motor and encoder (posdrct), the encoder and its cable, then reset_errors.";
    ENCODER_STANDS = 10239, Feedback, "the encoder has counted nothing while the drive was asked to move by {asked}; {limit} is allowed",
        "The loop that is closed here asks its drive to move, and the encoder counts nothing: the encoder is dead, its cable cut, or the \
            axis is blocked."
        => "Free the axis, check the encoder and its cable, then reset_errors.";
    ENCODERS_APART = 10087, Feedback, "the encoders of motor and load are {asked} apart; {limit} is allowed",
        "The encoder of the velocity loop and that of the position loop did not move together: one of them is dead or counts the wrong \
            way, what is between motor and load is broken or slips, or ampencres, ampencrpm and max_velocity do not fit each other."
        => "Check both encoders, coupling or belt, the digits of posdrct, ampencres and ampencrpm, then reset_errors.";
    OVERSPEED = 10244, Ends, "the axis is too fast for one whose position loop is open: {asked}, {limit} is allowed",
        "While out_an held the position loop open, the axis was faster than 1.2 max_velocity." => "Give smaller values, then reset_errors.";
    I2T_NEAR = 10238, NoError, "the motor is loaded near its I2t limit: {asked}, {limit} is allowed",
        "The filtered squared current is above 90 % of i2tlimit." => "Reduce load or acceleration, or let the motor cool.";
    GANTRY_HOMING = 10361, NoError, "", "The method of homing does not square an axis with two drives."
        => "Choose one that seeks a reference switch, or 35 or 37, which take the zero where the axis stands.",
        refusal: "does not square an axis with two drives; 0, 3 to 14, 19 to 30, 35, 37 and -1 to -4 are allowed";
    GANTRY_SOURCE = 10362, NoError, "", "A parameter names another source of the position than the words of both drives of the axis."
        => "Leave it out; give the form of the words in feedback.",
        refusal: "names another source than the two drives of the axis, which close their loops themselves";
    GANTRY_NO_LIMIT = 10363, NoError, "max_skew is missing; a distance above 0 is expected",
        "An axis with two drives is to have no max_skew." => "Give it one.",
        refusal: "is missing for an axis with two drives; a distance above 0 is expected";
    GANTRY_IN_DRIVE = 10364, NoError, "", "The drives of an axis with two are to home by themselves: each would move alone."
        => "Leave homing.in_drive out.",
        refusal: "would let each of two drives of the axis move alone; false is allowed";
    GANTRY_ONE_SWITCH = 10365, NoError, "",
        "The reference switches of both drives of an axis are to be one input, which does not show what is square."
        => "Give each drive a reference switch of its own.",
        refusal: "names the input of i_refswitch; each of two drives has a reference switch of its own";
    ABORTED = 10228, NoError, "abort has stopped the axis; reset_errors lets it go on",
        "abort, the Esc of MACS, ended what ran or was to begin, and has locked all axes that are on."
        => "reset_errors, which opens the brake of the axis; open one that o_brake names with set_output; enable what is off. Then give \
            the goal again.";
    CAM_MASTER_TOO_FAST = 10229, Ends, "its master runs {asked} inc in one cycle; {limit} inc are its whole cam",
        "The master of a cam moved by more than the length of its table in one cycle: the table says nothing then."
        => "Slow the master down, or choose a smaller master_scale, then reset_errors.";
}
