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
    I2T_LIMIT = 99, Parameter {
        says: "the motor was loaded beyond its I2t limit: {asked}, {limit} is allowed",
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
        remedy: "Repair cable or encoder, then wf {reset: true}; before, it is refused.",
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
        says: "alarm 10: following error {asked} exceeds wf.max_following_error {limit} in travel",
        cause: "Alarm 10: the following error exceeds wf.max_following_error in travel: a weak or blocked drive, \
            a coupling, an encoder.",
        remedy: "Check coupling, encoder and load, then wf {reset: true}.",
    }

    /// WF alarm 11: following error beyond `wf.max_following_error` at standstill.
    WF_FOLLOWING_ERROR_AT_STANDSTILL = 1011, Parameter {
        says: "alarm 11: following error {asked} exceeds wf.max_following_error {limit} at standstill",
        cause: "Alarm 11: the following error exceeds wf.max_following_error at standstill: the axis was pushed, \
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
        cause: "A destination or break position is outside the range of counts.",
        remedy: "Load a smaller one, or check saia.mcfac.",
    }

    /// A velocity beyond its register.
    SAIA_VELOCITY_OUT_OF_RANGE = 2004, Command {
        says: "saia.veloc with saia.mcfac makes {plain} in the velocity register; 0 to 1073741823 is allowed",
        cause: "A velocity exceeds its register.",
        remedy: "Load a smaller one, or check saia.mcfac.",
    }

    /// An acceleration beyond its register.
    SAIA_ACCELERATION_OUT_OF_RANGE = 2005, Command {
        says: "saia.accel with saia.mcfac makes {plain} in the acceleration register; 0 to 1073741823 is allowed",
        cause: "An acceleration exceeds its register.",
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

    /// START of a function that runs.
    FUNCTION_ACTIVE = 3001, NoError {
        says: "it is started already; RESET comes first",
        cause: "START was given to a function that is started (AMK-CMD-10).",
        remedy: "Give RESET first, or VALUE_NEW where its type takes that.",
    }

    /// VALUE_NEW of a function at rest.
    FUNCTION_AT_REST = 3002, NoError {
        says: "it is in RESET; VALUE_NEW needs a function that is started",
        cause: "VALUE_NEW was given to a function that is not started (AMK-CMD-12).",
        remedy: "Give START, with the values.",
    }

    /// VALUE_NEW of a type that has none.
    FUNCTION_NO_VALUE_NEW = 3003, NoError {
        says: "its type has no VALUE_NEW; values count from START on",
        cause: "The type of the function takes new values at START only (AMK-CMD-03).",
        remedy: "Give RESET, then START with the values.",
    }

    /// A value beyond the range of its field.
    FUNCTION_RANGE = 3004, NoError {
        says: "",
        cause: "A value of the set is outside the range of its field; `lineshaft functions TYPE` lists the ranges.",
        remedy: "Give a value within the range; nothing of the set was taken.",
    }

    /// A table that a started function reads.
    FUNCTION_USES_TABLE = 3005, NoError {
        says: "",
        cause: "The table is read by a started function whose type allows no edit (AMK-GEN-13).",
        remedy: "Give RESET to the function, load the table, start it again.",
    }

    /// A table of another form or kind than the one that it is to replace.
    FUNCTION_TABLE_FORM = 3006, NoError {
        says: "",
        cause: "A table keeps the form that the cell gives it.",
        remedy: "Load a table of that form.",
    }

    /// An output that a function writes.
    FUNCTION_WRITES = 3008, NoError {
        says: "",
        cause: "The output is one of a function, which sets it while it runs (AMK-GEN-09).",
        remedy: "Command the function, or take the output out of its list.",
    }

    /// A sink that is faster than its axis may be.
    FUNCTION_TOO_FAST = 3007, Ends {
        says: "its function asks for {asked}; max_velocity is {limit}",
        cause: "The sink of the function that moves the axis changed faster than max_velocity allows; it is followed exactly or not at all.",
        remedy: "Slow the source down, choose another ratio or raise max_velocity; then reset_errors, RESET and START.",
    }

    /// A cycle in a set of a function that is not the one of its slot.
    AMK_CYCLE_MISMATCH = 3020, NoError {
        says: "{asked} times 0.5 ms is not the cycle of the slot, {limit}",
        cause: "A set of a function names another cycle than its slot has.",
        remedy: "Leave it out, or give the cycle of the machine times `cycle_factor`, in units of 0.5 ms.",
    }

    /// No table where a function needs one.
    AMK_TABLE_MISSING = 3021, NoError {
        says: "the first table is missing; the function reads its points or cams there",
        cause: "A function that reads a table has none.",
        remedy: "Name a table of form words as the first of `tables`.",
    }

    /// A table of points where a data block is needed.
    AMK_TABLE_FORM = 3022, NoError {
        says: "the first table is not of form words",
        cause: "A function that reads a data block was given a table of form y or xy.",
        remedy: "Make it of form words, in the layout of the source's data block.",
    }

    /// A table that ends before its last cam or point.
    AMK_TABLE_SHORT = 3023, NoError {
        says: "the table has {asked} words; what is counted in it needs {limit}",
        cause: "A table ends before the last cam, point or drive that is counted.",
        remedy: "Add the missing words, or count fewer.",
    }

    /// DW0 of an output table counts no points, or too many.
    AMK_POINTS = 3024, NoError {
        says: "DW0 of the table is {asked}; points + 1, so 2 to {limit}, is possible",
        cause: "DW0 of an output table counts no points, or too many.",
        remedy: "Give the number of points + 1.",
    }

    /// Points that do not rise.
    AMK_POINT_ORDER = 3025, NoError {
        says: "DD{asked} of the table is not above the point before it, {limit}",
        cause: "The points of an output table do not rise.",
        remedy: "Sort them; no two are equal.",
    }

    /// A point that cannot be reached.
    AMK_POINT_NEGATIVE = 3026, NoError {
        says: "the first point of the table is {asked}; x runs from {limit} on",
        cause: "An output table has negative points, and in this mode x is never negative.",
        remedy: "Begin at 0 or above, or choose ba 0.",
    }

    /// A modulo of 0.
    AMK_NO_MODULO = 3027, NoError {
        says: "x begins anew at {asked}; {limit} or more is possible",
        cause: "The modulo of a cam controller, or the last point of an output table, is 0 in a mode that runs round.",
        remedy: "Give the increments, or the time, after which x begins again.",
    }

    /// A time of a table beyond its range.
    AMK_TIME_LONG = 3028, NoError {
        says: "DW{asked} of the table is a time above {limit} half milliseconds",
        cause: "A time in the table of a cam controller is outside its range.",
        remedy: "Give a shorter one; a negative word is none.",
    }

    /// A time of a table below a call.
    AMK_TIME_SHORT = 3029, NoError {
        says: "DW{asked} of the table is a time shorter than a call, {limit} ns",
        cause: "A time in the table of a cam controller is shorter than the time between two calls.",
        remedy: "Give a longer one; dead times and pulses may be 0.",
    }

    /// A mode word that joins bit and input in no way.
    AMK_TRACK_LOGIC = 3030, NoError {
        says: "mode {asked} has AND and OR at once, bits 2 and 3",
        cause: "The mode of a track has both bits of its logic.",
        remedy: "Set one of them, or none.",
    }

    /// A mean over more calls than there is room for.
    AMK_MEAN_LONG = 3031, NoError {
        says: "a mean over {asked} calls is asked for; there is room for {limit}",
        cause: "A mean over more calls was asked for than the cell leaves room for.",
        remedy: "Average over fewer calls, or make more room in the cell.",
    }

    /// Compensation of a dead time in a mode without it.
    AMK_DEAD_TIME_MODE = 3032, NoError {
        says: "fct 1 compensates a dead time in ba {limit} only; ba is {asked}",
        cause: "BINEA was to compensate a dead time in another mode than the incremental one.",
        remedy: "Set fct to 0, or ba to 1.",
    }

    /// A dead time that nothing compensates.
    AMK_DEAD_TIME_UNUSED = 3033, NoError {
        says: "a dead time of {asked} half milliseconds needs fct 1",
        cause: "BINEA was given a dead time without its compensation.",
        remedy: "Set fct to 1 with ba 1, or leave the dead time out.",
    }

    /// Cams of all tracks together.
    AMK_CAM_COUNT = 3034, NoError {
        says: "the tracks have {asked} cams together; up to {limit} are possible",
        cause: "The tracks of a cam controller have too many cams together.",
        remedy: "Use fewer, or a second function.",
    }

    /// A hysteresis that leaves no way between off and on.
    AMK_HYSTERESIS = 3035, NoError {
        says: "the hysteresis of {asked} inc is not below the {limit} inc from the end of a cam to its start",
        cause: "The hysteresis of a track is as long as the way from the end of one of its cams to its start, or longer.",
        remedy: "Choose a smaller hysteresis, or a shorter cam.",
    }

    /// A track that there is not.
    AMK_TRACK_SELECT = 3036, NoError {
        says: "DR1 of the table names track {asked}; 0 to {limit} are there",
        cause: "A cam table selects a track that does not exist for the offset in the sink.",
        remedy: "Name one of the tracks 0 to 7.",
    }

    /// A ratio by a word that the function does not have.
    AMK_NO_WORD = 3040, NoError {
        says: "mode 3 takes its ratio from a word; the function names none",
        cause: "Mode 3 of varsync was chosen, and the function names no word that holds the ratio.",
        remedy: "Name one in `word_addr`, or choose mode 0, 1 or 2.",
    }

    /// A threshold in a table that is no 15-bit number.
    AMK_THRESHOLD = 3043, NoError {
        says: "the first table has a threshold of {asked}; 0 to {limit} is possible",
        cause: "A threshold of a chosen drive is outside its range, or the word after it is not 0.",
        remedy: "Give one of 0 to 32767, and 0 after it.",
    }

    /// A divider of a ratio in a table that is too small.
    AMK_RATIO_DIVIDER = 3044, NoError {
        says: "the first table has a ratio divider of {asked}; 0 and {limit} or more are possible",
        cause: "The divider of a chosen drive's ratio is negative, or above 0 and below 65536.",
        remedy: "Give it as the drive has it, low word first; 0 and 0 is ratio 1.",
    }

    /// A measurement that is limited to both sides.
    AMK_LIMITATION = 3045, NoError {
        says: "{asked} limits the measurement to positive and to negative at once",
        cause: "Bits 2 and 3 of `ba` are both 1.",
        remedy: "Set one of them, or none.",
    }

    /// A mode that a type has not.
    AMK_NO_MODE = 3046, NoError {
        says: "no mode has number {asked}",
        cause: "A set of a function names a mode that its type does not have.",
        remedy: "fipw: 2, 26, 82 or 98 by way, 4, 132, 84 or 100 by time; xfipw: the same, or one more with sets of tables.",
    }

    /// A value that a mode has no use for.
    AMK_MODE_FIELD = 3047, NoError {
        says: "{asked} has no meaning in mode {limit}",
        cause: "A field of a function has a value that its mode does not use, or a function bit that this version or this mode lacks.",
        remedy: "Set the field to 0, table_count and tables_total to 1, or choose the mode that uses it.",
    }

    /// A value that the other fields leave no room for.
    AMK_BEYOND = 3048, NoError {
        says: "{asked} is not allowed; the bound is {limit}",
        cause: "A field violates the bound that the mode or the other fields of its set leave.",
        remedy: "Tables last 50 to 32767 inc, or 1 to 32767 calls; offsets and windows end before the table does, start_tables below table_count. \
            dfkt: active_table within table_count, with bit 2 of `ba` mult times last point / in_final within 32767. \
            epos: stop_decel no less than acceleration; with bit 1 of `ba` 1 to 9 ms between two calls, sf_cycle 2 to 18. \
            ecopy: values for an analog output within its full scale (mV). sidiff: display_aw within the axes of the cell.",
    }

    /// Fewer tables than a set counts.
    AMK_TABLES_FEW = 3049, NoError {
        says: "{asked} tables are counted; the function has {limit}",
        cause: "A set of a function counts more tables than the cell gives the function.",
        remedy: "Name more in `tables`, or count fewer.",
    }

    /// Tables that make no whole sets.
    AMK_TABLE_SETS = 3050, NoError {
        says: "{asked} tables are no whole sets of {limit}",
        cause: "Inputs were to select sets of tables, and the tables of the function are no multiple of tables_total.",
        remedy: "Name as many tables as the sets need together.",
    }

    /// A table without the points of a curve.
    AMK_CURVE_FORM = 3051, NoError {
        says: "Tab{asked} is of a form that the type does not read",
        cause: "An interpolator was given a table of form words, or a type one with places of its own where it takes none.",
        remedy: "fipw and fipz read form y, xfipw reads y and xy, dfkt y and words.",
    }

    /// Too many points, or too few.
    AMK_CURVE_POINTS = 3052, NoError {
        says: "Tab{asked} has {limit} points, more or fewer than the type takes",
        cause: "A table of an interpolator or of speeds has fewer than two points, or too many.",
        remedy: "fipw, fipz and dfkt take 2 to 127, xfipw 2 to 2000, of form xy 2 to 1000.",
    }

    /// A curve that does not begin at 0.
    AMK_CURVE_FIRST = 3053, NoError {
        says: "Tab{asked} begins at {limit} instead of 0",
        cause: "The first value of a table, or its first place, is not 0.",
        remedy: "Take the first value off all of them: the sink goes on from where it is.",
    }

    /// Places that do not rise.
    AMK_CURVE_ORDER = 3054, NoError {
        says: "point {limit} of Tab{asked} is not after the one before it",
        cause: "The places of a table of form xy do not rise.",
        remedy: "Sort them; no two are equal.",
    }

    /// A step that is too large.
    AMK_CURVE_STEP = 3055, NoError {
        says: "point {limit} of Tab{asked} is 32768 or more from the one before it",
        cause: "Two neighbouring values of a table differ by 32768 or more.",
        remedy: "Use more points, or a smaller table with `mult`.",
    }

    /// A table that is too long or too short.
    AMK_CURVE_LENGTH = 3056, NoError {
        says: "Tab{asked} ends at place {limit}; 50 to 32767 inc are possible, by time 1 to 32767",
        cause: "The last place of a table of form xy is outside its range.",
        remedy: "Give one within it.",
    }

    /// A scaled value without a place in 32 bits.
    AMK_CURVE_SCALED = 3057, NoError {
        says: "Tab{asked} reaches {limit} behind mult and div_exp; less than 2147483647 is possible",
        cause: "The largest value of a table, times mult and divided by 2 to the power of div_exp, has no place in 32 bits.",
        remedy: "Choose a smaller mult or a larger div_exp.",
    }

    /// A zero pulse of a source that has none.
    AMK_NO_ZERO_PULSE = 3058, NoError {
        says: "function {asked} waits for a zero pulse; the source is no encoder",
        cause: "Bit 2 of `function` is set, and the source of the function is no encoder, which alone has pulses.",
        remedy: "Choose an encoder as source, or leave bit 2 out.",
    }

    /// A mode by way without a source.
    AMK_NO_SOURCE = 3059, NoError {
        says: "mode {asked} runs by the way of a source; the function has none",
        cause: "A mode by way was chosen for a function whose source is none.",
        remedy: "Name a source, or choose a mode by time.",
    }
    /// Limits of a ratio that leave nothing between them.
    AMK_RATIO_LIMITS = 3060, NoError {
        says: "{asked} is not below ratio_max, {limit}",
        cause: "The least ratio of a dfkt is not below its largest one.",
        remedy: "Set ratio_min below ratio_max; -32767 and 32767 with ratio_div 1 limit hardly anything.",
    }

    /// A table that cannot go on below 0 so.
    AMK_CONTINUATION = 3061, NoError {
        says: "{asked} is no way to go on below 0; 0 holds the first point, 2 mirrors the table",
        cause: "cont_low of a dfkt is 1.",
        remedy: "Set it to 0 or 2.",
    }

    /// A last point that no ratio can be related to.
    AMK_LAST_POINT = 3062, NoError {
        says: "Tab{asked} ends at 0 rpm, and no ratio can be related to that",
        cause: "Bit 2 of `ba` relates the ratio of a dfkt to the last point of its table, which is 0.",
        remedy: "Leave bit 2 out, or end the table at another speed.",
    }

    /// A table in the place of one that the function would write.
    AMK_OUTPUT_TABLE = 3063, NoError {
        says: "Tab7 would be a table that the function writes, which does not exist here; Tab0 to Tab6 are read",
        cause: "A dfkt has an eighth table.",
        remedy: "Name seven at most; the signals of the function show what it does.",
    }

    /// A speed in a table beyond its range.
    AMK_SPEED_POINT = 3064, NoError {
        says: "point {limit} of Tab{asked} is not within -32767 to 32767 rpm",
        cause: "A point of a table of speeds is outside its range.",
        remedy: "Points are whole rpm; reach higher speeds by mult and div.",
    }

    /// New numbers for the table that runs.
    AMK_TABLE_IN_USE = 3065, NoError {
        says: "Tab{asked} is the one that runs, which gets no new numbers",
        cause: "The table that a started dfkt follows was to be loaded (AMK-DFKT-25).",
        remedy: "Load one that is not active and select that; or RESET, load, START.",
    }

    /// DW0 of a table of speeds counts too few points, or too many.
    AMK_SPEED_POINTS = 3066, NoError {
        says: "DW0 of Tab{asked} is {limit}; points + 1, so 3 to 128, is possible",
        cause: "DW0 of a table of speeds counts fewer than 2 points, or more than 127.",
        remedy: "Give the number of points + 1.",
    }

    /// A table of speeds that ends before its last point.
    AMK_SPEED_WORDS = 3067, NoError {
        says: "Tab{asked} has {limit} words, too few for the points that its DW0 counts",
        cause: "A table of speeds ends before its last point: point i is in DW 2 i.",
        remedy: "Add the missing words, or count fewer.",
    }

    /// Increments without the turn that they are of.
    AMK_NO_RESOLUTION = 3068, NoError {
        says: "{asked} increments make no turn; 1 to {limit} is possible where the input is a way",
        cause: "Bit 0 of `ba` makes a speed of the travel of the source, and in_resolution is 0.",
        remedy: "Set in_resolution to the increments of one turn of the master.",
    }

    /// An active table that the cell does not have.
    AMK_TABLE_NONE = 3069, NoError {
        says: "{asked} selects Tab{limit}, which the function does not have",
        cause: "active_table names a place of `tables` that is `none` or behind their end.",
        remedy: "Name a table there, or select another one.",
    }

    /// A value that is not optional where it is used.
    AMK_NOT_ZERO = 3070, NoError {
        says: "{asked} is no value of it in this `ba`; 1 to {limit} is possible",
        cause: "A field of a fgen or an epos that its `ba` uses is 0 or was left out, or is a negative velocity.",
        remedy: "fgen: give cycle_time where bit 0 of `ba` is 0, accel2 where bit 2 is 1. epos: give velocity, the direction of a relative order is \
            the sign of travel; with bit 0 master_resolution.",
    }

    /// A gain that lets nothing through.
    AMK_NO_GAIN = 3071, NoError {
        says: "a gain of {asked} lets nothing through; -32768 to -1 and 1 to {limit} are possible",
        cause: "gain_v of a regl is 0 or was left out.",
        remedy: "Give it; switch_mask or its inputs open the loop.",
    }

    /// A bit that counts from START on.
    AMK_BA_KEPT = 3072, NoError {
        says: "{asked} changes bits that count from START on; {limit} would change none of them",
        cause: "VALUE_NEW has changed more of `ba` than may change while the function runs.",
        remedy: "fgen takes bit 1, regl bits 2 and 3; RESET and START take all.",
    }

    /// A generator that goes too far in a call.
    AMK_CALL_WAY = 3073, NoError {
        says: "a call would go {asked} inc at the largest override; up to {limit} is possible",
        cause: "cycle_increments in cycle_time are 32768 inc or more between two calls of a fgen, with an override at its 200 %.",
        remedy: "Choose a longer cycle_time or fewer cycle_increments; counters of 16 bits would lose count.",
    }

    /// Two ways of positioning at once.
    AMK_MODULO_SUBSTITUTIONAL = 3080, NoError {
        says: "{asked} is substitutional and modulo at once, bits 1 and 4",
        cause: "Bits 1 and 4 of `ba` of an epos are both 1.",
        remedy: "Choose one of them.",
    }

    /// A reference that nothing gives.
    AMK_NO_REFERENCE = 3081, NoError {
        says: "{asked} runs to a zero pulse, bit 1; the sink is no axis with a drive, which alone has one",
        cause: "Bit 1 of `ba` of an epos is set, and its sink is memory, an output, an axis without a drive or none.",
        remedy: "Give it an axis as sink, or position relatively.",
    }

    /// An order that would go nowhere.
    AMK_NO_TRAVEL = 3082, NoError {
        says: "{asked} is no travel with ba {limit}: a reference is left behind, and a multiple has a length",
        cause: "travel of an epos is 0 with bit 1 or bit 4 of `ba`.",
        remedy: "Give it another value; only a relative order may be 0.",
    }

    /// An approach without a sense.
    AMK_NO_APPROACH = 3083, NoError {
        says: "{asked} has no sense to approach in; -2147483648 to -1 and 1 to {limit} are possible",
        cause: "velocity of an epos is 0 or was left out, with bit 1 of `ba`.",
        remedy: "Give it; its sign is the direction of the approach, also where the source is the velocity.",
    }

    /// An end that is not ahead.
    AMK_AGAINST_APPROACH = 3084, NoError {
        says: "{asked} is against the approach, whose velocity is {limit}; bit 2 of `ba` lets it turn round",
        cause: "travel and velocity of an epos have opposite signs with bit 1 of `ba` and without bit 2.",
        remedy: "Let it turn round with bit 2, or approach from the other side.",
    }

    /// A goal for a type whose orders do not end.
    FUNCTION_NO_GOALS = 3085, NoError {
        says: "run_function gives an order that ends; its type has none",
        cause: "A goal was given to a function of another type than epos.",
        remedy: "Give it its inputs, and its orders by command_function.",
    }

    /// A goal beside an order that is under way.
    FUNCTION_BUSY = 3086, NoError {
        says: "an order is under way; it has to end first, or its goal to be cancelled",
        cause: "A goal was given to a function that moves: by another goal, or by its inputs.",
        remedy: "Wait until its A1 is 1, cancel its goal, or stop it by E2.",
    }

    /// A goal without its axis.
    FUNCTION_LEFT = 3087, NoError {
        says: "something else moves or stops its axis, or has switched it off; RESET and START give it back",
        cause: "A function was given a goal, or had one, and the axis that it moves has left it: by a move, a halt, a stop, a loss of power.",
        remedy: "Free and enable the axis, then RESET and START, or a new goal behind RESET.",
    }

    /// A goal whose order an input has stopped.
    FUNCTION_STOPPED = 3088, NoError {
        says: "E2 has stopped its order, with {asked} left",
        cause: "E2 rose while a goal of run_function was under way.",
        remedy: "Give a new goal, or continue the order by E1.",
    }

    /// A goal whose function went.
    FUNCTION_RESET = 3089, NoError {
        says: "it was reset, with {asked} left",
        cause: "RESET was given to a function while a goal of run_function was under way.",
        remedy: "Give the goal again: it starts the function.",
    }

    /// More words than the image of a program has places for.
    AMK_DB_LONG = 3090, NoError {
        says: "its table has {asked} words; the image of a program takes {limit}",
        cause: "A function of type apsf was started with a longer table than a program can read.",
        remedy: "Give a shorter table, or several functions one each.",
    }

    /// A program that does not come to its end.
    AMK_OUT_OF_FUEL = 3091, Ends {
        says: "the program took more than {limit} instructions in a call",
        cause: "A program of the user has a loop without an end, or does more in a call than `fuel` of its function lets it.",
        remedy: "Fix the loop, do less in a call, or raise `fuel`; START restarts the program.",
    }

    /// A program that calls too deep.
    AMK_STACK = 3092, Ends {
        says: "the program calls itself too deep: 256 calls within each other and 8192 values are possible",
        cause: "A program of the user calls itself without an end, or has very large frames.",
        remedy: "Fix the recursion; START restarts the program.",
    }

    /// A program that gives up.
    AMK_UNREACHABLE = 3093, Ends {
        says: "the program came to what it says is never reached: a panic of its own",
        cause: "A program of the user panicked: an index beyond an array, an overflow, an `unwrap` of nothing, an abort.",
        remedy: "Try it with `lineshaft program run` and the same inputs; START restarts the program.",
    }

    /// A program that leaves its memory.
    AMK_MEMORY_BOUNDS = 3094, Ends {
        says: "the program read or wrote beside its memory",
        cause: "A program of the user has a wrong address.",
        remedy: "Try it with `lineshaft program run` and the same inputs; START restarts the program.",
    }

    /// A program that calls nothing.
    AMK_NO_FUNCTION = 3095, Ends {
        says: "the program called what is no function, or one of another signature",
        cause: "A program of the user has a wrong pointer to a function.",
        remedy: "Try it with `lineshaft program run` and the same inputs; START restarts the program.",
    }

    /// A program that divides by 0.
    AMK_DIVISION_BY_ZERO = 3096, Ends {
        says: "the program divided a whole number by 0",
        cause: "A program of the user divides by something that became 0.",
        remedy: "Look for 0 before it divides; START restarts the program.",
    }

    /// A program that leaves the range of a whole number.
    AMK_INTEGER_OVERFLOW = 3097, Ends {
        says: "the program got a whole number that does not fit: a quotient, or a float that it converted",
        cause: "A program of the user converts a float that is too large, or divides the least number by -1.",
        remedy: "Limit the value before it is converted; START restarts the program.",
    }

    /// A program that makes a whole number of NaN.
    AMK_NOT_A_NUMBER = 3098, Ends {
        says: "the program converted NaN to a whole number",
        cause: "A program of the user calculates 0 / 0, the root of something below 0, or the like.",
        remedy: "Look for it before the value is converted; START restarts the program.",
    }

    /// A program that writes over its image.
    AMK_IMAGE = 3099, Ends {
        says: "the program wrote over the first word of its image, which says how long that is",
        cause: "A program of the user writes where it should not.",
        remedy: "Try it with `lineshaft program run` and the same inputs; START restarts the program.",
    }

    /// A real that is none.
    AMK_NOT_FINITE = 3100, Ends {
        says: "the program left a memory cell NaN or infinite",
        cause: "A program of the user wrote a real number that is not finite into `writes` of its image.",
        remedy: "Limit the value before it is written; START restarts the program.",
    }

    /// State that no other program can keep.
    AMK_OTHER_LENGTH = 3101, NoError {
        says: "its image has {asked} bytes, that of the program which runs has {limit}: its state cannot be kept",
        cause: "A program was to be exchanged with its state, and its own part of the image has another length.",
        remedy: "Exchange it with `state: reset`, or leave the structure of the state as it is.",
    }

    /// A program that is too large for its slot.
    AMK_PROGRAM_LARGE = 3102, NoError {
        says: "it needs {asked} pages of memory; its functions have room for {limit}",
        cause: "A program was to be exchanged for one with more memory than its functions have room for: 4 pages, or as many as the first had.",
        remedy: "Link it with less memory, or begin with it.",
    }

    /// More outputs than there are behind the first.
    AMK_OUTPUTS_BEHIND = 3103, NoError {
        says: "{asked} outputs do not fit behind the first one; {limit} do",
        cause: "The first output of an apsf and `out_bits` from there on go beyond A8 (A-32).",
        remedy: "Wire the first output further in front, or let the program write fewer.",
    }

    /// A bit of an axis that the cell does not have.
    AMK_NO_AXIS = 3104, NoError {
        says: "{asked} has a bit of an axis that the cell does not have; it has {limit}",
        cause: "aw_mask of sidiff or fgen has a bit of an axis that the cell does not have.",
        remedy: "Leave the bit out: bit n-1 is the n-th axis of the cell.",
    }
}
