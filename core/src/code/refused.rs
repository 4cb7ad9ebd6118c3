//! Why something was refused.

use super::codes;

codes! {
    ABOVE_MAX_POSITION = 10001, NoError, "target {asked} exceeds max_position {limit}", "The target exceeds max_position."
        => "Choose a target within the limits.";
    BELOW_MIN_POSITION = 10002, NoError, "target {asked} is below min_position {limit}", "The target is below min_position."
        => "Choose a target within the limits.";
    VELOCITY_TOO_HIGH = 10003, NoError, "velocity {asked} exceeds max_velocity {limit}", "The velocity exceeds max_velocity."
        => "Ask for less, or raise the parameter if the machine bears it.";
    ACCELERATION_TOO_HIGH = 10004, NoError, "acceleration {asked} exceeds max_acceleration {limit}",
        "The acceleration exceeds max_acceleration." => "Ask for less, or raise the parameter if the machine bears it.";
    DECELERATION_TOO_HIGH = 10005, NoError, "deceleration {asked} exceeds max_deceleration {limit}",
        "The deceleration exceeds max_deceleration." => "Ask for less, or raise the parameter if the machine bears it.";
    JERK_TOO_HIGH = 10006, NoError, "jerk {asked} exceeds max_jerk {limit}", "The jerk exceeds max_jerk."
        => "Ask for less, or raise the parameter if the machine bears it.";
    NOT_ENABLED = 10007, NoError, "the axis is not enabled; enable it first", "The axis is off." => "Enable it first.";
    IN_ERROR = 10008, NoError, "the axis stands in ERROR_STOP; reset_errors first", "The axis stands in ERROR_STOP."
        => "Remove the cause, then reset_errors.";
    QUICK_STOPPED = 10009, NoError, "quick_stop has locked the axis; reset_errors first", "quick_stop has locked the axis."
        => "reset_errors unlocks it.";
    BAD_NUMBER = 10010, NoError, "{what} {asked} is not allowed; a finite number that is not negative is",
        "A number is negative, NaN or infinite where that has no meaning." => "Give a finite number that is allowed.";
    POSITION_OUT_OF_RANGE = 10011, Search, "target {asked} is outside +-2^62 increments", "A position exceeds 2^62 increments."
        => "Give a nearer one.";
    CANNOT_STOP_BEFORE_MAX_POSITION = 10012, NoError, "with deceleration {asked} it would reach {limit}, beyond max_position, on its way",
        "With this deceleration the axis would pass max_position on its way." => "Ask for more deceleration, or for less velocity before.";
    CANNOT_STOP_BEFORE_MIN_POSITION = 10013, NoError, "with deceleration {asked} it would reach {limit}, beyond min_position, on its way",
        "With this deceleration the axis would pass min_position on its way." => "Ask for more deceleration, or for less velocity before.";
    LEADER_LOOP = 10014, NoError, "the axis would follow itself",
        "The axis would follow itself, directly or through others, or mencodertype names it." => "Choose another leader.",
        refusal: "names the axis itself; another one is allowed";
    BAD_RATIO = 10015, NoError, "ratio {asked} : {limit} is none; both parts must not be 0 and stay below 2^62",
        "A ratio with denominator 0, or one part 0 and the other not." => "Give two whole numbers that are not 0.";
    NOT_BUILT = 10016, NoError, "", "The command names something that this version does not have." => "See the page of its parameters.";
    UNKNOWN_GOAL = 10017, NoError, "goal {plain} is not active", "No goal of that number is active."
        => "It has ended already: its end was told.";
    PARAMETER_OUT_OF_RANGE = 10018, NoError, "", "A parameter value is outside its range."
        => "Give one within the range that the sentence names.";
    /// For example a limit above its counterpart, a default above its maximum.
    PARAMETERS_CONTRADICT = 10019, NoError, "", "Parameters contradict each other." => "Set both in one set, so that they agree.";
    GOAL_BEYOND_NEW_LIMITS = 10020, NoError, "{key} {asked} would leave out {limit}, which the motion under way reaches",
        "The motion under way would leave the new limits." => "Stop it first, or set wider limits.";
    TOO_MANY_WAITING = 10021, NoError, "too many commands wait; try again", "More commands wait than there is room for."
        => "Wait for answers; try again.";
    /// It was refused before it became a command; the text of its event says why.
    BAD_REQUEST = 10022, NoError, "the request is not understood", "A request was not understood." => "Compare it with docs/interfaces.md.";
    NOT_AT_STANDSTILL = 10023, NoError, "", "The axis moves or stops, and the command needs it at rest."
        => "Wait for its end, or halt it first.";
    PROBE_INPUT_ACTIVE = 10270, NoError, "probe input is already active; move the axis off it, or set probe_active_input to allow",
        "The input of probe_axis reads 1 before a search for its rising edge, or 0 before one for its falling edge. That edge cannot come: \
            the axis would drive on to the end of the search."
        => "Move the axis off the mark; check the wire of the sensor; name the other edge. Parameter probe_active_input: allow searches \
            for the next edge, which comes once the input has changed back.";
    TOO_MANY_TOUCH_PROBES = 10271, NoError, "{limit} touch probes are armed, allowed {limit}; abort one with abort_trigger",
        "A touch probe was to be armed for another trigger, and the axis has as many armed as it may have."
        => "Abort one with abort_trigger, or arm it for the trigger of one that is armed: that one gives way.";
    TOUCH_PROBE_WINDOW = 10272, NoError,
        "first_position {asked} exceeds last_position {limit}; only an axis with a modulo has a window across the end of its turn",
        "The window of a touch probe ends below its begin, and the axis has no turn." => "Exchange first_position and last_position.";
    TOUCH_PROBE_NOT_ARMED = 10273, NoError, "no touch probe is armed; arm one with touch_probe",
        "abort_trigger was asked for a trigger that no touch probe of the axis waits for: it has ended, or was never armed."
        => "Nothing, if it has recorded its latch.";
    COORDINATE_IN_USE = 10276, NoError, "something refers to the present coordinate of the axis; wait for its end, or end it first",
        "set_position of an axis that has a goal to a target, a trajectory, a goal that waits, a superimposed motion or phase shift, a \
            cam, a coupling at a pair of places or by marks, one that waits, a gear_out at a place of the axis, a motion of a vocabulary \
            or a function, or a touch probe with a window."
        => "Wait for its end, or end it: cancel, halt, abort_trigger. A velocity, streamed setpoints and a gear go on in the new \
            coordinate.";
    /// The acceleration may be a deceleration.
    RATE_TOO_LOW = 10024, NoError, "{asked} is too low; at least {limit} is allowed",
        "A velocity or acceleration is so low that the move would not end." => "Ask for more.";
    NOTHING_TO_WAIT_FOR = 10025, NoError, "a coupling has no end that a buffered goal could wait for",
        "A buffered goal behind a coupling, which has no end." => "Cancel the coupling, or give an aborting goal.";
    SUPERIMPOSED_TOO_MUCH = 10026, NoError, "{what} {asked} is more than the motion under way leaves: {limit}",
        "A superimposed motion asks for more than the motion under way leaves of the limits." => "Ask for less, or wait.";
    CAM_START = 10027, NoError, "its start is at {asked}; 0 up to {limit}, its end, is possible",
        "amc.cam_start_index and amc.cam_start_position are at or after the end of the table."
        => "Name a point before the last one, and a position within its segment.";
    PHASE_NO_COUPLING = 10046, NoError, "the axis is not coupled by position; a phase shift needs a leader, in mode POSITION or CAM",
        "A phase shift was asked of an axis that follows nothing, or keeps no position to what it follows."
        => "Couple the axis with synchronize in mode POSITION or CAM first.";
    PHASE_UNIT = 10047, NoError, "the shift has units that the leader of the axis has not; side MASTER is in those of the leader",
        "The amounts of a phase shift of the master have another dimension than its leader, or are beyond its range."
        => "Give shift, velocity and acceleration in units of the leader, or in increments of it.";
    PHASE_RATE = 10048, NoError,
        "a phase shift of the master of a cam needs its velocity and its acceleration, above 0, as its slope is another one everywhere",
        "A phase shift of the master left velocity or acceleration out, or gave next to nothing, and the axis is on a cam."
        => "Give both, in units of the leader.";
    PHASE_TOO_FAST = 10050, NoError,
        "the shift moves the master by {asked} increments in a cycle; {limit} is followed at most, with what it runs itself",
        "The velocity of a phase shift of the master is more than the length of the cam, or than any gear follows, in a cycle."
        => "Ask for a lower velocity.";
    SYNC_OFFSET_RANGE = 10060, NoError, "", "syncposoffs, either way, is more than 1073741823 / syncfacts."
        => "Give a smaller offset, or a gear factor in lower terms.",
        refusal: "is beyond its range; at most 1073741823 / syncfacts, either way, is allowed";
    MARK_NO_INPUT = 10037, NoError, "", "syncmtypm or syncmtyps names an input that the cell does not have, or that does not latch."
        => "Name a digital input by its number, in the order of the file, with key latch: true; its tens digit, or that of the encoder \
            without one.";
    MARK_NO_INDEX = 10038, NoError, "",
        "syncmtypm or syncmtyps asks for the index pulse of something that has none, or for its falling edge."
        => "Use an input (2, 3 and its number), or type 0 and an incremental encoder with key index, a drive with sim: {index: ..} or, on \
            CAN, with probe_1 or probe_2: index.";
    MARK_START = 10039, NoError, "syncmstart {asked} does not exist in mode MARKER; 0 to 7 and 1000 to 1007 do",
        "syncmstart 2000 belongs to cams." => "Use one that exists.";
    CAM_MARKS_PERIOD = 10067, NoError,
        "marks of a cam need a cyclic table, whose period is of whole increments of the side with the marks, by these scales",
        "A mode by marks of a cam was asked for, and its table is not cyclic, or a period of the side with the marks, scaled, is not of \
            whole increments."
        => "Use a cyclic table, and scales with which its length, or the travel of the slave in a period, is whole.";
    CAM_MARKS_STROKE = 10068, NoError, "marks of the slave need a cam that feeds; this one comes back to where its period began",
        "Mode CAM_SLAVE_MARKER with a table whose last value is its first one."
        => "Use marks of the master (CAM_MASTER_MARKER), or a table that feeds.";
    CAM_MARKS_DISTANCE = 10069, NoError,
        "the sensor of the marks is {asked} inc away; at most {limit} inc, 8 periods of the cam, is allowed",
        "syncmpulsm, with marks of the slave syncmpulss, is more than 8 periods." => "Give the distance from sensor to working place.";
    CAM_MARKS_START = 10070, NoError,
        "syncmstart 2000 begins a cam at the first mark of its master; cam_start RELATIVE and mode CAM_MASTER_MARKER are allowed with it",
        "syncmstart 2000 with ABSOLUTE or RAMP_IN, or with marks of the slave."
        => "Use RELATIVE, or another syncmstart, all of which take the nearest mark.";
    MARKS_SHIFT = 10029, NoError, "the axis is coupled by marks, which would take that back; parameter syncposoffs shifts it",
        "A phase shift or a superimposed move was asked of an axis that is coupled in mode MARKER." => "Set syncposoffs.";
    MARK_NO_DISTANCE = 10040, NoError, "syncmstart {asked} goes by the distance of the marks, and syncmpulsm is 0",
        "syncmstart is 3, 4, 5 or 7, and syncmpulsm is 0." => "Set syncmpulsm, or use another start.";
    MARK_DISTANCE = 10059, NoError,
        "syncmpulsm {asked} inc is too far for marks; at most {limit} inc is allowed with this syncfacts and syncmarkm",
        "syncmpulsm times syncmarkm times syncfacts is more than 2147483646."
        => "Give a smaller distance, or a gear factor in lower terms.";
    MARK_WINDOW = 10058, NoError, "", "syncmwinm is more than syncmpulsm, or syncmwins more than syncmpulss."
        => "Give a window of at most the distance of the marks, or 0, which takes marks anywhere.",
        refusal: "is larger than the distance of the marks; 0 to syncmpulsm, for syncmwins to syncmpulss, is allowed";
    MARKS_INACTIVE = 10057, NoError, "", "syncmfpar asks for an average of marks while no coupling by marks is under way."
        => "Leave 64 out; distances are averaged from the beginning of a coupling on.",
        refusal: "asks with 64 for marks of an axis that is not coupled; sums of 1, 2, 4 and 16 are allowed";
    ENGAGE_NO_CAM = 10049, NoError, "the axis is on no cam of that leader whose end could be waited for",
        "engage AT_END was asked of an axis that is on no cam, on one of another leader, or on one that has ended."
        => "Begin with engage IMMEDIATELY or AT_POSITION.";
    VIRTUAL_MASTER_SOURCE = 10035, NoError, "",
        "vmenctyp names an axis that the cell does not have, or an encoder that the virtual master would be while it is off."
        => "Give 100 times the number of an axis, or 0 for pulsvel.";
    VIRTUAL_MASTER_NO_RAMP = 10036, NoError, "", "pulsvel was to start the virtual master, and pulsacc is 0 or -1."
        => "Set pulsacc above 0 before pulsvel or together with it; with -1, set setsys_15.";
    OPEN_LOOP = 10030, NoError, "the axis runs in open loop; only commands of `wf` move it",
        "The axis runs in open loop, and the command needs a position loop." => "Use commands of `wf`.";
    CLOSED_LOOP = 10031, NoError, "the axis closes a position loop; a speed without one is for interface open_loop",
        "The axis closes a position loop, and the command is for one that does not." => "Use move_axis.";
    /// A virtual axis must be at rest.
    NOT_DISABLED = 10032, NoError, "", "It needs a disabled axis." => "Disable the axis first.";
    READ_ONLY = 10033, NoError, "", "The machine computes the parameter, or the cell gives it." => "Change the cell, and start again.";
    /// The set gives it by two names.
    GIVEN_TWICE = 10034, NoError, "", "A set gives one value twice, and not the same." => "Give it once.";
    /// Source: VM_AMC_POSITION_REF.
    AMC_OUTSIDE_TURN = 10041, NoError, "{key} {asked} is outside the turn, at most {limit} either way; amc.rotary_mode 4 to 6 takes more",
        "A position reference is outside the turn." => "Give one within it, or choose amc.rotary_mode 4 to 6.";
    AMC_TURN_CAPACITY = 10042, NoError, "{key} {asked} leads further than the {limit} turns that the integrators hold",
        "The reference leads further than the integrators hold turns." => "Come back within their range.";
    AMC_NO_MASTER = 10043, NoError, "{key} {asked} follows a master; give `amc: {master: ..}` in the cell",
        "The reference selector has no master." => "Give `amc: {master: ..}` in the cell.";
    AMC_NO_FREEZE = 10044, NoError, "{key} {asked} waits for a latch; give `amc: {freeze: ..}` in the cell",
        "The reference selector has nothing that freezes its master." => "Give `amc: {freeze: ..}` in the cell.";
    AMC_NO_CAM = 10045, NoError, "{key} {asked} follows a master by a table; give `amc: {cam: ..}` in the cell",
        "The reference selector has no table for its cam." => "Give `amc: {cam: ..}` in the cell.";
    REVERSE_FORBIDDEN = 10051, NoError, "", "The motion leads backwards, which revers forbids." => "Move forwards, or change revers.";
    LOOP_IN_DRIVE = 10052, NoError, "", "posdrct would invert a loop that the drive closes." => "Invert the sense in the drive.",
        refusal: "inverts the position loop, which a drive with interface position closes itself; 1, 11, -1 and -11 are allowed";
    NO_VELOCITY_LOOP = 10053, NoError, "", "posdrct would invert one of position and velocity loop alone, and both have one encoder."
        => "Use a value that inverts both.",
        refusal: "inverts one loop and not the other, and both have one encoder; 1, 2, 11, 22 and their negatives are allowed";
    LOOP_PERIOD = 10072, NoError, "", "timer is no whole number of cycles, so that the position loop cannot keep it."
        => "Give a timer that the cycle divides.",
        refusal: "is no whole number of cycles, and the position loop runs in cycles; a period that the cycle divides is allowed";
    EFFORT_MISSING = 10073, NoError, "", "max_effort is missing for an axis with interface torque or voltage."
        => "Give the effort that the full output is to ask for.",
        refusal: "is missing for an axis with interface torque or voltage; an effort above 0 is expected";
    NO_POWER_STAGE = 10074, NoError, "", "ampmode asks for a voltage, and a drive with interface torque closes its current loop itself."
        => "Use 0 (velocity loop here) or 2 (position loop alone), or interface voltage.",
        refusal: "asks for a voltage, and a drive with interface torque closes its current loop itself; 0 and 2 are allowed";
    NO_DAMPING = 10075, NoError, "",
        "With ampmode 2 the position loop makes the effort or the current itself, and without a derivative part it damps nothing."
        => "Use ampmode 0, or regulator pid with kder, integer with saia.kder.",
        refusal: "damps nothing, and with ampmode 2 the position loop makes the effort or the current itself; ampmode 0, or regulator pid \
            or integer with a derivative gain above 0, is allowed";
    ESTIMATOR_RANGE = 10076, NoError, "", "velocity_loop.acceleration is beyond what a Kalman filter finds at this cycle, in increments."
        => "Give an acceleration that moves the axis by a part of an increment up to some hundred of them in a cycle.",
        refusal: "is beyond what a Kalman filter finds at this cycle, from 1e-10 to 1000 times 0.29 inc by the square of the cycle";
    CURRENT_UNKNOWN = 10077, NoError, "",
        "ampmaxcur, i2tftime, i2tlimit or curftime is about a current, and without torque_constant none is known."
        => "Give torque_constant, the effort for each ampere.",
        refusal: "is about a current, and without torque_constant none is known; its default is allowed";
    CURRENT_LOOP = 10245, NoError, "",
        "torque_constant or full_current is missing for an axis with interface voltage, whose current loop (ampmode 0 and 2) needs both."
        => "Give torque_constant, the effort that the drive reports for each ampere, and full_current; or use ampmode 1 or 3.",
        refusal: "is missing for the current loop of an axis with interface voltage; a value above 0 is expected, or ampmode 1 or 3, which \
            have none";
    COMMUTATION = 10246, NoError, "",
        "ampcommtype names a motor that the power stage would have to commutate, and it has one voltage and no halls."
        => "Use 0, or 1 for a motor with brushes; let a drive with interface torque commutate the others.",
        refusal: "asks for a motor that is commutated here: there are no inputs for halls, no phases of a stepper and no second output; 0 \
            and 1 (brushes) are allowed";
    ANALOG_FULL = 10247, NoError, "{key} {asked} exceeds {limit}, which is what its drive does at 10 V",
        "max_velocity or max_effort exceeds what the drive of the axis does at 10 V, its full reference."
        => "Give less; or set the amplifier so that 10 V are more, and full_velocity or full_effort of the cell with it.",
        refusal: "exceeds what its drive does at 10 V; full_velocity or full_effort at most is allowed";
    ANALOG_SILENT = 10249, NoError, "",
        "ampencno, torque_constant or encodertype asks for what a drive on a bus reports, and this one is given a voltage."
        => "Give the axis an entry of encoders by feedback, and leave the others out.",
        refusal: "asks for what no drive that is given a voltage tells; an entry of encoders as feedback (encodertype 0), ampencno -1 and \
            torque_constant 0 are allowed";
    ANALOG_COASTS = 10250, NoError, "its drive takes a torque as a voltage, and coasts where it is left to its own stop",
        "out_an or error_reaction 4 was asked of an axis whose drive takes a torque as a voltage: without its position loop nothing brakes \
            it."
        => "Use move_axis and another error_reaction; or let the amplifier close its velocity loop, with interface velocity.",
        refusal: "leaves the axis to the stop of its drive, and one that takes a torque as a voltage coasts; 0, 1, 2, 3 and 5 are allowed";
    GAIN_RANGE = 10078, NoError, "", "A gain of the integer PID, which closes the loop of the axis, is beyond its register."
        => "Give 0 to 32767, of saia.sampi 0 to 255.",
        refusal: "is beyond the register of the integer PID, which closes the loop of the axis; 0 to 32767 is allowed, of saia.sampi 0 to \
            255";
    SIMULATED_EFFORT = 10079, NoError, "",
        "encodertype simulates the encoder of an axis with interface torque or voltage, whose loops need the motion of the motor."
        => "Use another encodertype.",
        refusal: "is a simulated encoder, which follows the command: an axis with interface torque or voltage would find no velocity of \
            its motor; another one is allowed";
    OUT_AN_NO_LOOP = 10080, NoError,
        "no loop below its position loop is closed here; `out_an` needs a drive with interface velocity, torque or voltage",
        "out_an opens the position loop that is closed here, and the drive closes that of this axis, or the axis has none."
        => "Use move_axis; tune the loops of such a drive in the drive.";
    VELOCITY_ENCODER_OTHER = 10084, NoError, "", "ampencno names the encoder of another axis, or of none."
        => "Give the number of the axis itself, whose drive has the encoder of its motor, or -1.",
        refusal: "names no encoder that its velocity loop reads: -1, that of the position loop, and the number of the axis itself, the \
            encoder of its drive, are allowed";
    VELOCITY_ENCODER_TURN = 10085, NoError, "", "ampencno gives the velocity loop an encoder of its own, and ampencres is not set."
        => "Give ampencres, the increments of that encoder in a turn, in the same set.",
        refusal: "gives no turn of the encoder that ampencno names; 1 to 1073741823 increments are allowed";
    VELOCITY_ENCODER_TWO_DRIVES = 10086, NoError, "", "ampencno names the encoder of one motor for an axis that two drives carry."
        => "Leave it out.",
        refusal: "names one encoder for an axis that two drives carry; -1 is allowed";
    OUT_AN_RUNS = 10088, NoError, "the position loop is open by `out_an`; a stop or disable ends that",
        "out_an has opened the position loop of the axis, and the command needs it." => "Halt or disable the axis, and enable it again.";
    OUT_AN_TWO_DRIVES = 10089, NoError, "the axis has two drives, which no position loop would keep square",
        "out_an was asked of an axis with two drives, which nothing would keep square."
        => "Tune such an axis with both drives in their position loops.";
    OUT_AN_NO_EFFORT = 10090, NoError, "level effort needs a drive with interface torque or voltage",
        "out_an was to give an effort to a drive that takes velocities." => "Use level setpoint.";
    NO_REVERSING_OUTPUTS = 10054, NoError, "", "revers names a node on a bus: key `node` of the drive in the cell does that."
        => "Use revers below 100: a rule, and outputs where the interface is velocity or open_loop.",
        refusal: "asks for a node on a bus, which key node of the drive does; below 100 is allowed";
    ENGAGE_TOO_SHORT = 10055, NoError,
        "start_distance_increments {plain} is too short for what the slave may do at the present speed of its leader; {bound} is enough",
        "Over the start distance of engage AT_POSITION the slave would exceed velocity or acceleration of its goal."
        => "Give a longer start distance, more velocity and acceleration, or let the leader run slower.";
    ENGAGE_PASSED = 10056, NoError,
        "the leader is past its start already: {plain} of the {bound} increments before master_increments are missing",
        "With engage AT_POSITION the leader moves towards master_increments, and is closer to it than the start distance."
        => "Give the goal earlier, or a shorter start distance.";
    TRAJECTORY_PATH_TOLERANCE = 10061, NoError, "off the path of its trajectory: {what} error {asked} exceeds tolerance {limit}",
        "An axis left the path of its trajectory by more than its tolerance."
        => "Give a slower trajectory or a wider tolerance; check the drive.";
    TRAJECTORY_GOAL_TOLERANCE = 10062, NoError, "not at the goal of its trajectory in time: {what} error {asked} exceeds tolerance {limit}",
        "An axis did not come within its goal tolerance in time." => "Give more goal_time_tolerance or a wider tolerance; check the drive.";
    TRAJECTORY_IN_THE_PAST = 10063, NoError, "the last point of the trajectory is at {asked}; it must be after the present time, {limit}",
        "No point of the trajectory is ahead." => "Check the clocks of both sides, and its start time.";
    TRAJECTORY_WITHOUT_TIME = 10251, NoError,
        "the last point of the trajectory is due at once, and {asked} away; {limit} at most is allowed",
        "All points of the trajectory are due at its start, and the axis is further from the last one than its goal tolerance allows, or \
            without one its in_position_window."
        => "Give the last point a time_from_start.";
    TRAJECTORY_UNDER_WAY = 10064, NoError,
        "the axis runs a trajectory; only an aborting goal, absolute, relative, additive or velocity, replaces it",
        "The axis runs a trajectory." => "Wait for its end, or replace it with an aborting goal.";
    TRAJECTORY_ABOVE_MAX_POSITION = 10065, NoError, "between its points the trajectory would reach {asked}, above max_position {limit}",
        "Between its points the trajectory would pass max_position." => "Give more points, or keep off the limit.";
    TRAJECTORY_START = 10420, NoError,
        "the first point of the trajectory is {asked} from the command; {limit} is allowed (start tolerance)",
        "The trajectory has a point at time 0 that differs from the command position of the axis by more than the start tolerance \
            (`constraints.<joint>.start`)."
        => "Plan again from the present position.";
    TRAJECTORY_TOO_LONG = 10261, NoError, "the trajectory takes {asked}; at most {limit} is allowed (max_duration)",
        "The trajectory, as it is stretched, would take longer than max_duration of its group, or has run that long without an end."
        => "Plan a shorter one, or raise max_duration.";
    TRAJECTORY_STEP = 10262, NoError, "the velocity of the trajectory steps by {asked}; an axis can do {limit} in a cycle",
        "Points without velocities make straight segments, whose velocity steps from one to the next by more than the axis can do, and \
            trajectory_limits.on_excess is refuse, or the trajectory ends in motion."
        => "Give velocities in the points.";
    TRAJECTORY_STOP_BEYOND_LIMIT = 10264, NoError, "the stop after the last point ends at {asked}, beyond the software limit {limit}",
        "The last point of the trajectory has a velocity, and the axis would come to rest beyond min_position or max_position."
        => "End slower, or further from the limit.";
    TRAJECTORY_OTHER_TIME = 10265, NoError, "the trajectory lasts {limit} from its start; {asked} after it was asked for",
        "query_state asked for a time before the start of the trajectory or after its last point."
        => "Ask for a time that the trajectory covers.";
    NO_TRAJECTORY = 10266, NoError, "the axis moves, and not by a trajectory",
        "query_state was asked while a joint moves otherwise, or stops." => "Wait until it stands, or ask while its trajectory runs.";
    TRAJECTORY_LAG = 10263, NoError, "the axis will lag up to {asked} behind, and the trajectory will end {limit} late",
        "Points without velocities make straight segments, whose velocity steps from one to the next by more than the axis can do. It lags \
            behind and catches up within its limits. The largest lag of all axes and the late end are computed from the limits."
        => "Give velocities in the points.";
    TRAJECTORY_STRETCHED = 10260, NoError, "the time of the trajectory is stretched",
        "A trajectory exceeds a limit by more than trajectory_limits.margin, and trajectory_limits.on_excess is scale: it takes longer, on \
            the same path."
        => "Nothing has to be done. Plan with lower limits, or with points closer together, to keep the planned time.";
    TRAJECTORY_BELOW_MIN_POSITION = 10066, NoError, "between its points the trajectory would reach {asked}, below min_position {limit}",
        "Between its points the trajectory would pass min_position." => "Give more points, or keep off the limit.";
    /// Nothing is switched on and nothing moves until it is activated.
    NOT_ACTIVE = 10071, NoError, "the machine is inactive; activate it first", "The machine is inactive." => "Activate it first.";
    STREAM_BUSY = 10081, NoError, "something else moves the axis, and a stream takes no axis over; halt it first",
        "Streamed setpoints come for an axis that something else moves." => "Halt it, then stream.";
    SETPOINT_NO_NUMBER = 10082, NoError, "the velocity is no finite number", "A streamed setpoint is NaN or infinite."
        => "Send finite numbers.";
    PITCH_TABLE = 10083, NoError, "the numbers are no pitch error, as which an axis reads the table, by point {asked} (0: by all of it)",
        "New numbers of a table that is the pitch error of an axis have fewer than 2 points, places that do not rise or leave the turn of \
            the axis, or an error that changes by more than a tenth of the way."
        => "Give points whose places rise and whose errors change by a tenth of the way at most.";
    CAM_FORM = 10091, NoError, "words of a data block are no cam; form y and form xy are", "The table of a cam has form words."
        => "Name a table of form y or xy.";
    CAM_POINTS = 10092, NoError, "it has {asked} points; its cam needs {limit} or more",
        "The table of a cam has too few points: two make a straight line, a spline needs three." => "Give more points.";
    CAM_NO_LENGTH = 10093, NoError, "it has form y and no length; a cam needs one, in increments of its master",
        "A table of form y says nothing about its master, and the cell gives it no `length`."
        => "Give the table a length in the cell, or places of its own with form xy.";
    CAM_LENGTH = 10094, NoError, "it is {asked} increments of its master long; 1 to 2147483647 are possible",
        "The last place of the table of a cam is outside its range." => "Give shorter tables, and a smaller master_scale.";
    CAM_PLACE = 10095, NoError, "point {asked} is at {limit}; the first is at 0, and each is after the one before it",
        "The places of the table of a cam do not begin at 0, or do not rise." => "Sort them; no two are equal.";
    CAM_VALUE = 10096, NoError, "point {asked} has the value {limit}; -1073741824 to 1073741824 are possible",
        "A value of the table of a cam is outside its range." => "Give smaller values, and a larger slave_scale.";
    CAM_PASSED = 10097, NoError, "the master is at {asked} of the cam, which runs from 0 to {limit}",
        "A cam that is not cyclic was asked for with its master behind its end, or out of all proportion before it."
        => "Bring the master before the end, shift it with master_offset, or begin with RELATIVE.";
    CAM_AWAY = 10098, NoError,
        "the cam asks for a place that is {asked} away; ABSOLUTE begins within syncaccuracy, {limit}, RAMP_IN leads there",
        "The slave is not where the table says, and the start ABSOLUTE does not move it there."
        => "Move the slave there, begin with RAMP_IN, or with RELATIVE where it is.";
    CAM_UNEVEN = 10099, NoError, "behind point {asked} its spline leaves -1073741824 to 1073741824",
        "Between its points the spline of a cam swings further than a value may be, as points at uneven distances make it."
        => "Space the points more evenly, give more of them, or take interpolation linear.";
    CAM_OTHER_LENGTH = 10100, NoError,
        "the new numbers are {asked} inc of the master long; an axis follows it over {limit}, and keeps its place in it",
        "New numbers of a cam that an axis follows have another length: its master would be elsewhere in it."
        => "Give numbers of the same length, or uncouple the axis first.";
}
