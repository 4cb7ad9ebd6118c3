//! Why something was refused.

use super::codes;

codes! {
    /// The goal's target exceeds `max_position`.
    ABOVE_MAX_POSITION = 10001, NoError {
        says: "target {asked} exceeds max_position {limit}",
        cause: "The target exceeds max_position.",
        remedy: "Choose a target within the limits.",
    }

    /// The goal's target is below `min_position`.
    BELOW_MIN_POSITION = 10002, NoError {
        says: "target {asked} is below min_position {limit}",
        cause: "The target is below min_position.",
        remedy: "Choose a target within the limits.",
    }

    /// Velocity beyond `max_velocity`.
    VELOCITY_TOO_HIGH = 10003, NoError {
        says: "velocity {asked} exceeds max_velocity {limit}",
        cause: "The velocity exceeds max_velocity.",
        remedy: "Ask for less, or raise the parameter if the machine bears it.",
    }

    /// Acceleration beyond `max_acceleration`.
    ACCELERATION_TOO_HIGH = 10004, NoError {
        says: "acceleration {asked} exceeds max_acceleration {limit}",
        cause: "The acceleration exceeds max_acceleration.",
        remedy: "Ask for less, or raise the parameter if the machine bears it.",
    }

    /// Deceleration beyond `max_deceleration`.
    DECELERATION_TOO_HIGH = 10005, NoError {
        says: "deceleration {asked} exceeds max_deceleration {limit}",
        cause: "The deceleration exceeds max_deceleration.",
        remedy: "Ask for less, or raise the parameter if the machine bears it.",
    }

    /// Jerk beyond `max_jerk`.
    JERK_TOO_HIGH = 10006, NoError {
        says: "jerk {asked} exceeds max_jerk {limit}",
        cause: "The jerk exceeds max_jerk.",
        remedy: "Ask for less, or raise the parameter if the machine bears it.",
    }

    /// The axis is disabled.
    NOT_ENABLED = 10007, NoError {
        says: "the axis is not enabled; enable it first",
        cause: "The axis is off.",
        remedy: "Enable it first.",
    }

    /// The axis stands in ERROR_STOP: reset_errors first.
    IN_ERROR = 10008, NoError {
        says: "the axis stands in ERROR_STOP; reset_errors first",
        cause: "The axis stands in ERROR_STOP.",
        remedy: "Remove the cause, then reset_errors.",
    }

    /// The axis is locked by quick_stop: reset_errors first.
    QUICK_STOPPED = 10009, NoError {
        says: "quick_stop has locked the axis; reset_errors first",
        cause: "quick_stop has locked the axis.",
        remedy: "reset_errors unlocks it.",
    }

    /// A number is negative, NaN or infinite where that has no meaning.
    BAD_NUMBER = 10010, NoError {
        says: "{what} {asked} is not allowed; a finite number that is not negative is",
        cause: "A number is negative, NaN or infinite where that has no meaning.",
        remedy: "Give a finite number that is allowed.",
    }

    /// |position| must stay below 2^62 increments.
    POSITION_OUT_OF_RANGE = 10011, Search {
        says: "target {asked} is outside +-2^62 increments",
        cause: "A position exceeds 2^62 increments.",
        remedy: "Give a nearer one.",
    }

    /// On its way the move cannot stop before `max_position` with this deceleration.
    CANNOT_STOP_BEFORE_MAX_POSITION = 10012, NoError {
        says: "with deceleration {asked} it would reach {limit}, beyond max_position, on its way",
        cause: "With this deceleration the axis would pass max_position on its way.",
        remedy: "Ask for more deceleration, or for less velocity before.",
    }

    /// On its way the move cannot stop before `min_position` with this deceleration.
    CANNOT_STOP_BEFORE_MIN_POSITION = 10013, NoError {
        says: "with deceleration {asked} it would reach {limit}, beyond min_position, on its way",
        cause: "With this deceleration the axis would pass min_position on its way.",
        remedy: "Ask for more deceleration, or for less velocity before.",
    }

    /// The axis would follow itself, directly or through others.
    LEADER_LOOP = 10014, NoError {
        says: "the axis would follow itself",
        cause: "The axis would follow itself, directly or through others, or mencodertype names it.",
        remedy: "Choose another leader.",
    }

    /// A ratio with denominator 0, or one part 0 and the other not.
    BAD_RATIO = 10015, NoError {
        says: "ratio {asked} : {limit} is none; both parts must not be 0 and stay below 2^62",
        cause: "A ratio with denominator 0, or one part 0 and the other not.",
        remedy: "Give two whole numbers that are not 0.",
    }

    /// The command names a mode that this version does not have.
    NOT_BUILT = 10016, NoError {
        says: "",
        cause: "The command names something that this version does not have.",
        remedy: "See the page of its parameters.",
    }

    /// No goal of that number is active.
    UNKNOWN_GOAL = 10017, NoError {
        says: "goal {plain} is not active",
        cause: "No goal of that number is active.",
        remedy: "It has ended already: its end was told.",
    }

    /// A parameter value is outside its range.
    PARAMETER_OUT_OF_RANGE = 10018, NoError {
        says: "",
        cause: "A parameter value is outside its range.",
        remedy: "Give one within the range that the sentence names.",
    }

    /// Parameters contradict each other (a limit above its counterpart, a default above its maximum).
    PARAMETERS_CONTRADICT = 10019, NoError {
        says: "",
        cause: "Parameters contradict each other.",
        remedy: "Set both in one set, so that they agree.",
    }

    /// The active goal would leave the limits that the parameters ask for.
    GOAL_BEYOND_NEW_LIMITS = 10020, NoError {
        says: "{key} {asked} would leave out {limit}, which the motion under way reaches",
        cause: "The motion under way would leave the new limits.",
        remedy: "Stop it first, or set wider limits.",
    }

    /// Too many commands wait for this axis.
    TOO_MANY_WAITING = 10021, NoError {
        says: "too many commands wait; try again",
        cause: "More commands wait than there is room for.",
        remedy: "Wait for answers; try again.",
    }

    /// A request was refused before it became a command (its text says why).
    BAD_REQUEST = 10022, NoError {
        says: "the request is not understood",
        cause: "A request was not understood.",
        remedy: "Compare it with docs/interfaces.md.",
    }

    /// The axis does not stand still, and the command needs that.
    NOT_AT_STANDSTILL = 10023, NoError {
        says: "",
        cause: "The axis moves or stops, and the command needs it at rest.",
        remedy: "Wait for its end, or halt it first.",
    }

    /// The input of a probe has the level already that the edge would bring.
    PROBE_INPUT_ACTIVE = 10270, NoError {
        says: "probe input is already active; move the axis off it, or set probe_active_input to allow",
        cause: "The input of probe_axis reads 1 before a search for its rising edge, or 0 before one for its falling edge. That edge cannot come: \
            the axis would drive on to the end of the search.",
        remedy: "Move the axis off the mark; check the wire of the sensor; name the other edge. Parameter probe_active_input: allow searches for the \
            next edge, which comes once the input has changed back.",
    }

    /// More touch probes of one axis than there is room for.
    TOO_MANY_TOUCH_PROBES = 10271, NoError {
        says: "{limit} touch probes are armed, allowed {limit}; abort one with abort_trigger",
        cause: "A touch probe was to be armed for another trigger, and the axis has as many armed as it may have.",
        remedy: "Abort one with abort_trigger, or arm it for the trigger of one that is armed: that one gives way.",
    }

    /// The window of a touch probe ends before it begins.
    TOUCH_PROBE_WINDOW = 10272, NoError {
        says: "first_position {asked} exceeds last_position {limit}; only an axis with a modulo has a window across the end of its turn",
        cause: "The window of a touch probe ends below its begin, and the axis has no turn.",
        remedy: "Exchange first_position and last_position.",
    }

    /// abort_trigger without a touch probe.
    TOUCH_PROBE_NOT_ARMED = 10273, NoError {
        says: "no touch probe is armed; arm one with touch_probe",
        cause: "abort_trigger was asked for a trigger that no touch probe of the axis waits for: it has ended, or was never armed.",
        remedy: "Nothing, if it has recorded its latch.",
    }

    /// set_position while something refers to the coordinate as it is.
    COORDINATE_IN_USE = 10276, NoError {
        says: "something refers to the present coordinate of the axis; wait for its end, or end it first",
        cause: "set_position of an axis that has a goal to a target, a trajectory, a goal that waits, a superimposed motion or phase shift, a cam, a coupling at a \
            pair of places or by marks, one that waits, a gear_out at a place of the axis, a motion of a vocabulary or a function, or a touch probe with a window.",
        remedy: "Wait for its end, or end it: cancel, halt, abort_trigger. A velocity, streamed setpoints and a gear go on in the new coordinate.",
    }

    /// Velocity, acceleration or deceleration so low that a move would not end.
    RATE_TOO_LOW = 10024, NoError {
        says: "{asked} is too low; at least {limit} is allowed",
        cause: "A velocity or acceleration is so low that the move would not end.",
        remedy: "Ask for more.",
    }

    /// A buffered goal behind a coupling, which has no end of its own.
    NOTHING_TO_WAIT_FOR = 10025, NoError {
        says: "a coupling has no end that a buffered goal could wait for",
        cause: "A buffered goal behind a coupling, which has no end.",
        remedy: "Cancel the coupling, or give an aborting goal.",
    }

    /// A superimposed motion asks for more than the motion under way leaves of the axis' limits.
    SUPERIMPOSED_TOO_MUCH = 10026, NoError {
        says: "{what} {asked} is more than the motion under way leaves: {limit}",
        cause: "A superimposed motion asks for more than the motion under way leaves of the limits.",
        remedy: "Ask for less, or wait.",
    }

    /// A cam of the reference selector that starts behind its end.
    CAM_START = 10027, NoError {
        says: "its start is at {asked}; 0 up to {limit}, its end, is possible",
        cause: "amc.cam_start_index and amc.cam_start_position are at or after the end of the table.",
        remedy: "Name a point before the last one, and a position within its segment.",
    }

    /// A phase shift of an axis that keeps no position to a leader.
    PHASE_NO_COUPLING = 10046, NoError {
        says: "the axis is not coupled by position; a phase shift needs a leader, in mode POSITION or CAM",
        cause: "A phase shift was asked of an axis that follows nothing, or keeps no position to what it follows.",
        remedy: "Couple the axis with synchronize in mode POSITION or CAM first.",
    }

    /// A phase shift of the master in units that its leader has not.
    PHASE_UNIT = 10047, NoError {
        says: "the shift has units that the leader of the axis has not; side MASTER is in those of the leader",
        cause: "The amounts of a phase shift of the master have another dimension than its leader, or are beyond its range.",
        remedy: "Give shift, velocity and acceleration in units of the leader, or in increments of it.",
    }

    /// A phase shift of the master of a cam without its own velocity and acceleration.
    PHASE_RATE = 10048, NoError {
        says: "a phase shift of the master of a cam needs its velocity and its acceleration, above 0, as its slope is another one everywhere",
        cause: "A phase shift of the master left velocity or acceleration out, or gave next to nothing, and the axis is on a cam.",
        remedy: "Give both, in units of the leader.",
    }

    /// A phase shift that moves the master further in a cycle than it may run.
    PHASE_TOO_FAST = 10050, NoError {
        says: "the shift moves the master by {asked} increments in a cycle; {limit} is followed at most, with what it runs itself",
        cause: "The velocity of a phase shift of the master is more than the length of the cam, or than any gear follows, in a cycle.",
        remedy: "Ask for a lower velocity.",
    }

    /// SYNCPOSOFFS beyond what SYNCFACTS allows.
    SYNC_OFFSET_RANGE = 10060, NoError {
        says: "",
        cause: "syncposoffs, either way, is more than 1073741823 / syncfacts.",
        remedy: "Give a smaller offset, or a gear factor in lower terms.",
    }

    /// Marks of an input that the cell has not, or whose edges are not latched.
    MARK_NO_INPUT = 10037, NoError {
        says: "",
        cause: "syncmtypm or syncmtyps names an input that the cell does not have, or that does not latch.",
        remedy: "Name a digital input by its number, in the order of the file, with key latch: true; its tens digit, or that of the encoder without one.",
    }

    /// Marks by an index pulse that is not there.
    MARK_NO_INDEX = 10038, NoError {
        says: "",
        cause: "syncmtypm or syncmtyps asks for the index pulse of something that has none, or for its falling edge.",
        remedy: "Use an input (2, 3 and its number), or type 0 and an incremental encoder with key index, a drive with sim: {index: ..} or, on CAN, with probe_1 or probe_2: index.",
    }

    /// A start by marks that does not exist.
    MARK_START = 10039, NoError {
        says: "syncmstart {asked} does not exist in mode MARKER; 0 to 7 and 1000 to 1007 do",
        cause: "syncmstart 2000 belongs to cams.",
        remedy: "Use one that exists.",
    }

    /// Marks of a cam whose periods are not whole.
    CAM_MARKS_PERIOD = 10067, NoError {
        says: "marks of a cam need a cyclic table, whose period is of whole increments of the side with the marks, by these scales",
        cause: "A mode by marks of a cam was asked for, and its table is not cyclic, or a period of the side with the marks, scaled, is not of whole increments.",
        remedy: "Use a cyclic table, and scales with which its length, or the travel of the slave in a period, is whole.",
    }

    /// Marks of a slave that its cam does not feed.
    CAM_MARKS_STROKE = 10068, NoError {
        says: "marks of the slave need a cam that feeds; this one comes back to where its period began",
        cause: "Mode CAM_SLAVE_MARKER with a table whose last value is its first one.",
        remedy: "Use marks of the master (CAM_MASTER_MARKER), or a table that feeds.",
    }

    /// A sensor of marks of a cam too far away.
    CAM_MARKS_DISTANCE = 10069, NoError {
        says: "the sensor of the marks is {asked} inc away; at most {limit} inc, 8 periods of the cam, is allowed",
        cause: "syncmpulsm, with marks of the slave syncmpulss, is more than 8 periods.",
        remedy: "Give the distance from sensor to working place.",
    }

    /// A cam that counts from a mark on, and does not begin where it is.
    CAM_MARKS_START = 10070, NoError {
        says: "syncmstart 2000 begins a cam at the first mark of its master; cam_start RELATIVE and mode CAM_MASTER_MARKER are allowed with it",
        cause: "syncmstart 2000 with ABSOLUTE or RAMP_IN, or with marks of the slave.",
        remedy: "Use RELATIVE, or another syncmstart, all of which take the nearest mark.",
    }

    /// A shift of an axis that is coupled by marks.
    MARKS_SHIFT = 10029, NoError {
        says: "the axis is coupled by marks, which would take that back; parameter syncposoffs shifts it",
        cause: "A phase shift or a superimposed move was asked of an axis that is coupled in mode MARKER.",
        remedy: "Set syncposoffs.",
    }

    /// A start that goes by the distance of marks, and there is none.
    MARK_NO_DISTANCE = 10040, NoError {
        says: "syncmstart {asked} goes by the distance of the marks, and syncmpulsm is 0",
        cause: "syncmstart is 3, 4, 5 or 7, and syncmpulsm is 0.",
        remedy: "Set syncmpulsm, or use another start.",
    }

    /// A distance of marks beyond what the gear factor allows.
    MARK_DISTANCE = 10059, NoError {
        says: "syncmpulsm {asked} inc is too far for marks; at most {limit} inc is allowed with this syncfacts and syncmarkm",
        cause: "syncmpulsm times syncmarkm times syncfacts is more than 2147483646.",
        remedy: "Give a smaller distance, or a gear factor in lower terms.",
    }

    /// A window of marks that is larger than their distance.
    MARK_WINDOW = 10058, NoError {
        says: "",
        cause: "syncmwinm is more than syncmpulsm, or syncmwins more than syncmpulss.",
        remedy: "Give a window of at most the distance of the marks, or 0, which takes marks anywhere.",
    }

    /// SYNCMFPAR 64: marks of an axis that is not coupled.
    MARKS_INACTIVE = 10057, NoError {
        says: "",
        cause: "syncmfpar asks for an average of marks while no coupling by marks is under way.",
        remedy: "Leave 64 out; distances are averaged from the beginning of a coupling on.",
    }

    /// A cam that was to begin at the end of another one, which is not there.
    ENGAGE_NO_CAM = 10049, NoError {
        says: "the axis is on no cam of that leader whose end could be waited for",
        cause: "engage AT_END was asked of an axis that is on no cam, on one of another leader, or on one that has ended.",
        remedy: "Begin with engage IMMEDIATELY or AT_POSITION.",
    }

    /// A source of the virtual master that is not there.
    VIRTUAL_MASTER_SOURCE = 10035, NoError {
        says: "",
        cause: "vmenctyp names an axis that the cell does not have, or an encoder that the virtual master would be while it is off.",
        remedy: "Give 100 times the number of an axis, or 0 for pulsvel.",
    }

    /// A start of the virtual master that has no ramp.
    VIRTUAL_MASTER_NO_RAMP = 10036, NoError {
        says: "",
        cause: "pulsvel was to start the virtual master, and pulsacc is 0 or -1.",
        remedy: "Set pulsacc above 0 before pulsvel or together with it; with -1, set setsys_15.",
    }

    /// The axis runs in open loop, and the command needs a position loop.
    OPEN_LOOP = 10030, NoError {
        says: "the axis runs in open loop; only commands of `wf` move it",
        cause: "The axis runs in open loop, and the command needs a position loop.",
        remedy: "Use commands of `wf`.",
    }

    /// The axis closes a position loop, and the command is for one that does not.
    CLOSED_LOOP = 10031, NoError {
        says: "the axis closes a position loop; a speed without one is for interface open_loop",
        cause: "The axis closes a position loop, and the command is for one that does not.",
        remedy: "Use move_axis.",
    }

    /// Something that needs a disabled axis, or one that stands if it is virtual.
    NOT_DISABLED = 10032, NoError {
        says: "",
        cause: "It needs a disabled axis.",
        remedy: "Disable the axis first.",
    }

    /// A parameter that the machine computes, or that stands in the cell.
    READ_ONLY = 10033, NoError {
        says: "",
        cause: "The machine computes the parameter, or the cell gives it.",
        remedy: "Change the cell, and start again.",
    }

    /// A set that gives one value twice, by two names, and not the same.
    GIVEN_TWICE = 10034, NoError {
        says: "",
        cause: "A set gives one value twice, and not the same.",
        remedy: "Give it once.",
    }

    /// A position reference that is outside the turn (VM_AMC_POSITION_REF).
    AMC_OUTSIDE_TURN = 10041, NoError {
        says: "{key} {asked} is outside the turn, at most {limit} either way; amc.rotary_mode 4 to 6 takes \
            more",
        cause: "A position reference is outside the turn.",
        remedy: "Give one within it, or choose amc.rotary_mode 4 to 6.",
    }

    /// The integrators of the reference selector would differ by more turns than they hold.
    AMC_TURN_CAPACITY = 10042, NoError {
        says: "{key} {asked} leads further than the {limit} turns that the integrators hold",
        cause: "The reference leads further than the integrators hold turns.",
        remedy: "Come back within their range.",
    }

    /// The reference selector has no master to follow.
    AMC_NO_MASTER = 10043, NoError {
        says: "{key} {asked} follows a master; give `amc: {master: ..}` in the cell",
        cause: "The reference selector has no master.",
        remedy: "Give `amc: {master: ..}` in the cell.",
    }

    /// The reference selector has nothing that freezes its master.
    AMC_NO_FREEZE = 10044, NoError {
        says: "{key} {asked} waits for a latch; give `amc: {freeze: ..}` in the cell",
        cause: "The reference selector has nothing that freezes its master.",
        remedy: "Give `amc: {freeze: ..}` in the cell.",
    }

    /// The reference selector has no cam to follow its master by.
    AMC_NO_CAM = 10045, NoError {
        says: "{key} {asked} follows a master by a table; give `amc: {cam: ..}` in the cell",
        cause: "The reference selector has no table for its cam.",
        remedy: "Give `amc: {cam: ..}` in the cell.",
    }

    /// A motion backwards, which REVERS forbids.
    REVERSE_FORBIDDEN = 10051, NoError {
        says: "",
        cause: "The motion leads backwards, which revers forbids.",
        remedy: "Move forwards, or change revers.",
    }

    /// POSDRCT would turn over a position loop that the drive closes.
    LOOP_IN_DRIVE = 10052, NoError {
        says: "",
        cause: "posdrct would invert a loop that the drive closes.",
        remedy: "Invert the sense in the drive.",
    }

    /// POSDRCT would turn over the velocity loop alone.
    NO_VELOCITY_LOOP = 10053, NoError {
        says: "",
        cause: "posdrct would invert one of position and velocity loop alone, and both have one encoder.",
        remedy: "Use a value that inverts both.",
    }

    /// TIMER is no whole number of cycles.
    LOOP_PERIOD = 10072, NoError {
        says: "",
        cause: "timer is no whole number of cycles, so that the position loop cannot keep it.",
        remedy: "Give a timer that the cycle divides.",
    }

    /// The full effort is not given.
    EFFORT_MISSING = 10073, NoError {
        says: "",
        cause: "max_effort is missing for an axis with interface torque or voltage.",
        remedy: "Give the effort that the full output is to ask for.",
    }

    /// AMPMODE asks for a voltage.
    NO_POWER_STAGE = 10074, NoError {
        says: "",
        cause: "ampmode asks for a voltage, and a drive with interface torque closes its current loop itself.",
        remedy: "Use 0 (velocity loop here) or 2 (position loop alone), or interface voltage.",
    }

    /// A proportional position loop without a velocity loop.
    NO_DAMPING = 10075, NoError {
        says: "",
        cause: "With ampmode 2 the position loop makes the effort or the current itself, and without a derivative part it damps nothing.",
        remedy: "Use ampmode 0, or regulator pid with kder, integer with saia.kder.",
    }

    /// An estimator that the cycle cannot run.
    ESTIMATOR_RANGE = 10076, NoError {
        says: "",
        cause: "velocity_loop.acceleration is beyond what a Kalman filter finds at this cycle, in increments.",
        remedy: "Give an acceleration that moves the axis by a part of an increment up to some hundred of them in a cycle.",
    }

    /// Currents are not known.
    CURRENT_UNKNOWN = 10077, NoError {
        says: "",
        cause: "ampmaxcur, i2tftime, i2tlimit or curftime is about a current, and without torque_constant none is known.",
        remedy: "Give torque_constant, the effort for each ampere.",
    }

    /// A current loop that does not know its currents.
    CURRENT_LOOP = 10245, NoError {
        says: "",
        cause: "torque_constant or full_current is missing for an axis with interface voltage, whose current loop (ampmode 0 and 2) needs both.",
        remedy: "Give torque_constant, the effort that the drive reports for each ampere, and full_current; or use ampmode 1 or 3.",
    }

    /// AMPCOMMTYPE asks for a motor that is not commutated here.
    COMMUTATION = 10246, NoError {
        says: "",
        cause: "ampcommtype names a motor that the power stage would have to commutate, and it has one voltage and no halls.",
        remedy: "Use 0, or 1 for a motor with brushes; let a drive with interface torque commutate the others.",
    }

    /// More than a voltage of 10 V asks for.
    ANALOG_FULL = 10247, NoError {
        says: "{key} {asked} exceeds {limit}, which is what its drive does at 10 V",
        cause: "max_velocity or max_effort exceeds what the drive of the axis does at 10 V, its full reference.",
        remedy: "Give less; or set the amplifier so that 10 V are more, and full_velocity or full_effort of the cell with it.",
    }

    /// A drive without a bus tells nothing.
    ANALOG_SILENT = 10249, NoError {
        says: "",
        cause: "ampencno, torque_constant or encodertype asks for what a drive on a bus reports, and this one is given a voltage.",
        remedy: "Give the axis an entry of encoders by feedback, and leave the others out.",
    }

    /// A drive that does not stop by itself.
    ANALOG_COASTS = 10250, NoError {
        says: "its drive takes a torque as a voltage, and coasts where it is left to its own stop",
        cause: "out_an or error_reaction 4 was asked of an axis whose drive takes a torque as a voltage: without its position loop nothing brakes it.",
        remedy: "Use move_axis and another error_reaction; or let the amplifier close its velocity loop, with interface velocity.",
    }

    /// A register of the integer PID that no command would load.
    GAIN_RANGE = 10078, NoError {
        says: "",
        cause: "A gain of the integer PID, which closes the loop of the axis, is beyond its register.",
        remedy: "Give 0 to 32767, of saia.sampi 0 to 255.",
    }

    /// A simulated encoder for an axis that is given efforts.
    SIMULATED_EFFORT = 10079, NoError {
        says: "",
        cause: "encodertype simulates the encoder of an axis with interface torque or voltage, whose loops need the motion of the motor.",
        remedy: "Use another encodertype.",
    }

    /// The loops below the position loop cannot be had alone.
    OUT_AN_NO_LOOP = 10080, NoError {
        says: "no loop below its position loop is closed here; `out_an` needs a drive with interface velocity, torque or voltage",
        cause: "out_an opens the position loop that is closed here, and the drive closes that of this axis, or the axis has none.",
        remedy: "Use move_axis; tune the loops of such a drive in the drive.",
    }

    /// An encoder for the velocity loop that it does not read.
    VELOCITY_ENCODER_OTHER = 10084, NoError {
        says: "",
        cause: "ampencno names the encoder of another axis, or of none.",
        remedy: "Give the number of the axis itself, whose drive has the encoder of its motor, or -1.",
    }

    /// Its turn is not given.
    VELOCITY_ENCODER_TURN = 10085, NoError {
        says: "",
        cause: "ampencno gives the velocity loop an encoder of its own, and ampencres is not set.",
        remedy: "Give ampencres, the increments of that encoder in a turn, in the same set.",
    }

    /// Two motors.
    VELOCITY_ENCODER_TWO_DRIVES = 10086, NoError {
        says: "",
        cause: "ampencno names the encoder of one motor for an axis that two drives carry.",
        remedy: "Leave it out.",
    }

    /// The position loop is open.
    OUT_AN_RUNS = 10088, NoError {
        says: "the position loop is open by `out_an`; a stop or disable ends that",
        cause: "out_an has opened the position loop of the axis, and the command needs it.",
        remedy: "Halt or disable the axis, and enable it again.",
    }

    /// Two drives of one axis.
    OUT_AN_TWO_DRIVES = 10089, NoError {
        says: "the axis has two drives, which no position loop would keep square",
        cause: "out_an was asked of an axis with two drives, which nothing would keep square.",
        remedy: "Tune such an axis with both drives in their position loops.",
    }

    /// An effort for a drive that takes none.
    OUT_AN_NO_EFFORT = 10090, NoError {
        says: "level effort needs a drive with interface torque or voltage",
        cause: "out_an was to give an effort to a drive that takes velocities.",
        remedy: "Use level setpoint.",
    }

    /// REVERS names a node on a bus, as key `node` of the drive does.
    NO_REVERSING_OUTPUTS = 10054, NoError {
        says: "",
        cause: "revers names a node on a bus: key `node` of the drive in the cell does that.",
        remedy: "Use revers below 100: a rule, and outputs where the interface is velocity or open_loop.",
    }

    /// A way to a pair of places that is too short for the slave.
    ENGAGE_TOO_SHORT = 10055, NoError {
        says: "start_distance_increments {plain} is too short for what the slave may do at the present speed of its leader; {bound} is enough",
        cause: "Over the start distance of engage AT_POSITION the slave would exceed velocity or acceleration of its goal.",
        remedy: "Give a longer start distance, more velocity and acceleration, or let the leader run slower.",
    }

    /// A leader that is on its way to a place already, past where the slave would have begun.
    ENGAGE_PASSED = 10056, NoError {
        says: "the leader is past its start already: {plain} of the {bound} increments before master_increments are missing",
        cause: "With engage AT_POSITION the leader moves towards master_increments, and is closer to it than the start distance.",
        remedy: "Give the goal earlier, or a shorter start distance.",
    }

    /// An axis left the path of its trajectory by more than its tolerance.
    TRAJECTORY_PATH_TOLERANCE = 10061, NoError {
        says: "off the path of its trajectory: {what} error {asked} exceeds tolerance {limit}",
        cause: "An axis left the path of its trajectory by more than its tolerance.",
        remedy: "Give a slower trajectory or a wider tolerance; check the drive.",
    }

    /// An axis did not come within its goal tolerance in time.
    TRAJECTORY_GOAL_TOLERANCE = 10062, NoError {
        says: "not at the goal of its trajectory in time: {what} error {asked} exceeds tolerance {limit}",
        cause: "An axis did not come within its goal tolerance in time.",
        remedy: "Give more goal_time_tolerance or a wider tolerance; check the drive.",
    }

    /// No point of the trajectory is ahead.
    TRAJECTORY_IN_THE_PAST = 10063, NoError {
        says: "the last point of the trajectory is at {asked}; it must be after the present time, {limit}",
        cause: "No point of the trajectory is ahead.",
        remedy: "Check the clocks of both sides, and its start time.",
    }

    /// A trajectory that has no time left ends where an axis is not.
    TRAJECTORY_WITHOUT_TIME = 10251, NoError {
        says: "the last point of the trajectory is due at once, and {asked} away; {limit} at most is allowed",
        cause: "All points of the trajectory are due at its start, and the axis is further from the last one than its goal tolerance \
            allows, or without one its in_position_window.",
        remedy: "Give the last point a time_from_start.",
    }

    /// A superimposed or waiting goal on an axis that runs a trajectory.
    TRAJECTORY_UNDER_WAY = 10064, NoError {
        says: "the axis runs a trajectory; only an aborting goal, absolute, relative, additive or velocity, replaces \
            it",
        cause: "The axis runs a trajectory.",
        remedy: "Wait for its end, or replace it with an aborting goal.",
    }

    /// Between its points the trajectory would go beyond `max_position`.
    TRAJECTORY_ABOVE_MAX_POSITION = 10065, NoError {
        says: "between its points the trajectory would reach {asked}, above max_position {limit}",
        cause: "Between its points the trajectory would pass max_position.",
        remedy: "Give more points, or keep off the limit.",
    }

    /// The first point of a trajectory, due at its start, is too far from where an axis is commanded to be.
    TRAJECTORY_START = 10420, NoError {
        says: "the first point of the trajectory is {asked} from the command; {limit} is allowed (start tolerance)",
        cause: "The trajectory has a point at time 0 that differs from the command position of the axis by more than the start tolerance \
            (`constraints.<joint>.start`).",
        remedy: "Plan again from the present position.",
    }

    /// A trajectory takes longer than it may.
    TRAJECTORY_TOO_LONG = 10261, NoError {
        says: "the trajectory takes {asked}; at most {limit} is allowed (max_duration)",
        cause: "The trajectory, as it is stretched, would take longer than max_duration of its group, or has run that long without an end.",
        remedy: "Plan a shorter one, or raise max_duration.",
    }

    /// Straight segments of a trajectory ask for a step of velocity.
    TRAJECTORY_STEP = 10262, NoError {
        says: "the velocity of the trajectory steps by {asked}; an axis can do {limit} in a cycle",
        cause: "Points without velocities make straight segments, whose velocity steps from one to the next by more than the axis can do, and \
            trajectory_limits.on_excess is refuse, or the trajectory ends in motion.",
        remedy: "Give velocities in the points.",
    }

    /// An axis that stops after the end of its trajectory would come to rest beyond a software limit.
    TRAJECTORY_STOP_BEYOND_LIMIT = 10264, NoError {
        says: "the stop after the last point ends at {asked}, beyond the software limit {limit}",
        cause: "The last point of the trajectory has a velocity, and the axis would come to rest beyond min_position or max_position.",
        remedy: "End slower, or further from the limit.",
    }

    /// The trajectory of an axis does not cover a time that was asked for.
    TRAJECTORY_OTHER_TIME = 10265, NoError {
        says: "the trajectory lasts {limit} from its start; {asked} after it was asked for",
        cause: "query_state asked for a time before the start of the trajectory or after its last point.",
        remedy: "Ask for a time that the trajectory covers.",
    }

    /// An axis has no trajectory, and does not stand.
    NO_TRAJECTORY = 10266, NoError {
        says: "the axis moves, and not by a trajectory",
        cause: "query_state was asked while a joint moves otherwise, or stops.",
        remedy: "Wait until it stands, or ask while its trajectory runs.",
    }

    /// Straight segments of a trajectory make an axis lag.
    TRAJECTORY_LAG = 10263, NoError {
        says: "the axis will lag up to {asked} behind, and the trajectory will end {limit} late",
        cause: "Points without velocities make straight segments, whose velocity steps from one to the next by more than the axis can do. It lags \
            behind and catches up within its limits. The largest lag of all axes and the late end are computed from the limits.",
        remedy: "Give velocities in the points.",
    }

    /// The time of a trajectory is stretched, so that it stays within the limits of its axes.
    TRAJECTORY_STRETCHED = 10260, NoError {
        says: "the time of the trajectory is stretched",
        cause: "A trajectory exceeds a limit by more than trajectory_limits.margin, and trajectory_limits.on_excess is scale: it takes \
            longer, on the same path.",
        remedy: "Nothing has to be done. Plan with lower limits, or with points closer together, to keep the planned time.",
    }

    /// Between its points the trajectory would go beyond `min_position`.
    TRAJECTORY_BELOW_MIN_POSITION = 10066, NoError {
        says: "between its points the trajectory would reach {asked}, below min_position {limit}",
        cause: "Between its points the trajectory would pass min_position.",
        remedy: "Give more points, or keep off the limit.",
    }

    /// The machine is inactive: nothing is switched on and nothing moves until it is activated.
    NOT_ACTIVE = 10071, NoError {
        says: "the machine is inactive; activate it first",
        cause: "The machine is inactive.",
        remedy: "Activate it first.",
    }

    /// Streamed setpoints come for an axis that something else moves.
    STREAM_BUSY = 10081, NoError {
        says: "something else moves the axis, and a stream takes no axis over; halt it first",
        cause: "Streamed setpoints come for an axis that something else moves.",
        remedy: "Halt it, then stream.",
    }

    /// A streamed setpoint is no number.
    SETPOINT_NO_NUMBER = 10082, NoError {
        says: "the velocity is no finite number",
        cause: "A streamed setpoint is NaN or infinite.",
        remedy: "Send finite numbers.",
    }

    /// New numbers of the pitch error of an axis are none.
    PITCH_TABLE = 10083, NoError {
        says: "the numbers are no pitch error, as which an axis reads the table, by point {asked} (0: by all of it)",
        cause: "New numbers of a table that is the pitch error of an axis have fewer than 2 points, places that do not rise or leave the turn of \
                the axis, or an error that changes by more than a tenth of the way.",
        remedy: "Give points whose places rise and whose errors change by a tenth of the way at most.",
    }

    /// A data block as a cam.
    CAM_FORM = 10091, NoError {
        says: "words of a data block are no cam; form y and form xy are",
        cause: "The table of a cam has form words.",
        remedy: "Name a table of form y or xy.",
    }

    /// A cam with too few points.
    CAM_POINTS = 10092, NoError {
        says: "it has {asked} points; its cam needs {limit} or more",
        cause: "The table of a cam has too few points: two make a straight line, a spline needs three.",
        remedy: "Give more points.",
    }

    /// A table of form y that does not say how long it is.
    CAM_NO_LENGTH = 10093, NoError {
        says: "it has form y and no length; a cam needs one, in increments of its master",
        cause: "A table of form y says nothing about its master, and the cell gives it no `length`.",
        remedy: "Give the table a length in the cell, or places of its own with form xy.",
    }

    /// A length beyond its range.
    CAM_LENGTH = 10094, NoError {
        says: "it is {asked} increments of its master long; 1 to 2147483647 are possible",
        cause: "The last place of the table of a cam is outside its range.",
        remedy: "Give shorter tables, and a smaller master_scale.",
    }

    /// Places that do not rise from 0.
    CAM_PLACE = 10095, NoError {
        says: "point {asked} is at {limit}; the first is at 0, and each is after the one before it",
        cause: "The places of the table of a cam do not begin at 0, or do not rise.",
        remedy: "Sort them; no two are equal.",
    }

    /// A value beyond its range.
    CAM_VALUE = 10096, NoError {
        says: "point {asked} has the value {limit}; -1073741824 to 1073741824 are possible",
        cause: "A value of the table of a cam is outside its range.",
        remedy: "Give smaller values, and a larger slave_scale.",
    }

    /// The master is behind the end of a cam that has one.
    CAM_PASSED = 10097, NoError {
        says: "the master is at {asked} of the cam, which runs from 0 to {limit}",
        cause: "A cam that is not cyclic was asked for with its master behind its end, or out of all proportion before it.",
        remedy: "Bring the master before the end, shift it with master_offset, or begin with RELATIVE.",
    }

    /// The slave of an absolute cam is elsewhere.
    CAM_AWAY = 10098, NoError {
        says: "the cam asks for a place that is {asked} away; ABSOLUTE begins within syncaccuracy, {limit}, RAMP_IN leads there",
        cause: "The slave is not where the table says, and the start ABSOLUTE does not move it there.",
        remedy: "Move the slave there, begin with RAMP_IN, or with RELATIVE where it is.",
    }

    /// No spline goes through the points.
    CAM_UNEVEN = 10099, NoError {
        says: "behind point {asked} its spline leaves -1073741824 to 1073741824",
        cause: "Between its points the spline of a cam swings further than a value may be, as points at uneven distances make it.",
        remedy: "Space the points more evenly, give more of them, or take interpolation linear.",
    }

    /// Another length of a cam that runs.
    CAM_OTHER_LENGTH = 10100, NoError {
        says: "the new numbers are {asked} inc of the master long; an axis follows it over {limit}, and keeps its place in it",
        cause: "New numbers of a cam that an axis follows have another length: its master would be elsewhere in it.",
        remedy: "Give numbers of the same length, or uncouple the axis first.",
    }
}
