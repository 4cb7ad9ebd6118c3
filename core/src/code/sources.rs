//! What MACS, WF and SAIA modules call an error by their own numbers.

use super::codes;

codes! {
    /// No error.
    NONE = 0, NoError, "", "" => "";
    HOMING_REQUIRED = 6, NoError, "homing is required and has not been done; home the axis first",
        "A motion was asked for, homing is required and has not been done since power-on."
        => "Home the axis; or set homing.required to false where no zero is needed.";
    /// Also of another node that is guarded.
    DRIVE_LOST = 88, Drive, "the drive does not answer",
        "The drive sends nothing any more: no power, a cable, another node with its address."
        => "Check supply, cable and address, then reset_errors; while it stays away the reset fails.";
    BUS_ERROR = 89, Drive, "the bus of the drive transmits nothing",
        "The bus of the drive is off: by its own errors, a cut cable, an adapter that was pulled. The drives on it do what they do without \
            a master."
        => "Check cable, termination, shield, bit rate and adapter, then reset_errors; while the bus stays off the reset fails.";
    /// MACS: F_LIMIT_VIOLATION.
    LIMIT_VIOLATION = 98, Switch, "velocity {asked} leads further into the limit at {limit}",
        "Motion was asked for towards a limit at which the axis stands already."
        => "Move the other way; or push the axis back by hand; or switch the limit off for the time being.";
    /// MACS: F_I2TLIMIT.
    I2T_LIMIT = 99, Parameter, "the motor was loaded beyond its I2t limit: {asked}, {limit} is allowed",
        "The motor was loaded beyond its I2t limit." => "Let it cool, reduce load or acceleration, then reset_errors.";
    WF_NO_ZERO_MARK = 1009, Search, "alarm 9: no zero mark within {limit} after the cam",
        "Alarm 9: no zero mark came within a revolution after the cam of reference travel."
        => "Check the encoder's zero mark and its cable, then wf {reset: true} and travel again.";
    WF_ENCODER_CABLE = 1007, Drive, "alarm 7: the encoder gives no value; its cable may be broken",
        "Alarm 7: the encoder gives no value: its cable is cut, missing or bent, or the encoder is dead."
        => "Repair cable or encoder, then wf {reset: true}; before, it is refused.";
    WF_PULSES = 1008, Drive, "alarm 8: pulses of the encoder are missing or too many: {asked} since the index, beyond {limit}",
        "Alarm 8: between two zero marks the encoder counted too many or too few pulses: noise, a dirty scale, a mark that stays away."
        => "Check shield, cable and encoder, then wf {reset: true} and reference travel.";
    WF_FOLLOWING_ERROR_IN_TRAVEL = 1010, Parameter, "alarm 10: following error {asked} exceeds wf.max_following_error {limit} in travel",
        "Alarm 10: the following error exceeds wf.max_following_error in travel: a weak or blocked drive, a coupling, an encoder."
        => "Check coupling, encoder and load, then wf {reset: true}.";
    WF_FOLLOWING_ERROR_AT_STANDSTILL = 1011, Parameter,
        "alarm 11: following error {asked} exceeds wf.max_following_error {limit} at standstill",
        "Alarm 11: the following error exceeds wf.max_following_error at standstill: the axis was pushed, or its drive is off."
        => "Check drive and load, then wf {reset: true}.";
    WF_POSITION_NOT_REACHED = 1022, Parameter, "alarm 22: {asked} from the target, outside the position reached window {limit}",
        "Alarm 22: the axis did not reach its position window in time, or left it again."
        => "Check the steps of the speed (wf.md42 to wf.md48), the window and the time wf.md30, then wf {reset: true}.";
    WF_NO_BLOCKS = 1101, NoError, "there is no block; give one or more in `blocks`", "A program without blocks was started."
        => "Give one or more in `blocks`.";
    WF_ONE_BLOCK = 1102, NoError, "mode mdi takes one block; {asked} are given", "More blocks were given than the mode takes."
        => "Give one block, or choose mode automatic.";
    WF_IN_MOTION = 1103, NoError, "the axis moves; mode, blocks and START wait for its end",
        "Mode, blocks or START were given while the axis moves." => "Wait for its end, or stop it first.";
    WF_NOT_IN_THIS_MODE = 1104, NoError, "the mode has no use for that: `start` runs blocks, `value` belongs to mode actual_value",
        "START or a value was given in a mode that has no use for it." => "Choose the mode that it belongs to.";
    WF_NO_REQUEST = 1105, NoError, "the controller enable request was taken back; give `enable: true` first",
        "The controller enable request was taken back." => "Give `enable: true` first.";
    WF_ALARM_WAITS = 1106, NoError, "alarm {asked} waits; give `reset: true` first", "An alarm waits to be acknowledged."
        => "Remove its cause, then `reset: true`.";
    WF_BAD_SPEED = 1107, NoError, "", "A speed value is 0 or too high." => "Give one within the range that the sentence names.";
    WF_NO_SUCH_BLOCK = 1108, NoError, "block {asked} does not exist; the program has {limit}",
        "A block was named that the program does not have." => "Name one that it has.";
    WF_NO_CAM_SIDE = 1109, NoError, "", "wf.md7 is above 2 with an incremental encoder: it names no side of the cam."
        => "Set wf.md7 to 0, 1 or 2; with wf.md4 absolute it is the value of the first word.",
        refusal: "is no side of the cam; with an incremental encoder 0 (the one that JOG leads to), 1 (plus) and 2 (minus) are allowed";
    SAIA_NOT_INITIALISED = 2001, Command, "axinit has not run and the axis is off; axinit or enable must come first",
        "A SAIA command came before axinit, on an axis that is off." => "Give axinit, or enable the axis.";
    SAIA_REGISTER_OUT_OF_RANGE = 2002, Command, "a register holds more than its command takes",
        "A register holds more than its command takes." => "Load a value within its range.";
    SAIA_POSITION_OUT_OF_RANGE = 2003, Command, "{key} with saia.mcfac makes {plain} counts; -1073741824 to 1073741823 is allowed",
        "A destination or break position is outside the range of counts." => "Load a smaller one, or check saia.mcfac.";
    SAIA_VELOCITY_OUT_OF_RANGE = 2004, Command,
        "saia.veloc with saia.mcfac makes {plain} in the velocity register; 0 to 1073741823 is allowed", "A velocity exceeds its register."
        => "Load a smaller one, or check saia.mcfac.";
    SAIA_ACCELERATION_OUT_OF_RANGE = 2005, Command,
        "saia.accel with saia.mcfac makes {plain} in the acceleration register; 0 to 1073741823 is allowed",
        "An acceleration exceeds its register." => "Load a smaller one, or check saia.mcfac.";
    SAIA_RELATIVE_TOO_EARLY = 2006, Command, "{key} cannot be loaded relatively before the first fstart after axinit",
        "A relative load came before the first fstart after axinit." => "Load an absolute value first.";
    SAIA_BAD_STOP_BITS = 2007, Command, "fstop needs one of the bits 8 to 10 of saia.mcw",
        "fstop came with none or several of the bits 8 to 10 of saia.mcw." => "Set exactly one of them.";
    SAIA_BAD_REACTION = 2008, Command, "saia.mcw names no reaction to position errors",
        "fsetpe came with another low byte of saia.mcw than 1BH or 1AH." => "Give one of these.";
    SAIA_STEP_IN_MOTION = 2009, Command, "fsstepf and fsstepb need an axis at rest", "A single step was asked for in motion."
        => "Wait until the axis rests.";
    SAIA_STEP_AT_END = 2010, Command, "the destination is {plain} counts, the end of its range; no step goes further",
        "A single step would leave the range of counts." => "Step the other way.";
    SAIA_ACCELERATION_PENDING = 2011, Command, "a new acceleration waits; fstart has to wait until the motion under way has ended",
        "fstart came in motion while a new acceleration waits." => "Start once the axis rests.";
    SAIA_ACCELERATION_ABOVE_VELOCITY = 2012, Command,
        "the acceleration register is {plain}; 1 to the velocity register, {bound}, is allowed",
        "A start with an acceleration register of 0 or above the velocity register."
        => "Load an acceleration of 1 to the velocity register.";
    SAIA_READ_OUT_OF_RANGE = 2013, Command, "with saia.mcfac {plain} what is read does not fit its register of 32 bits",
        "What is read does not fit its register." => "Check saia.mcfac.";
    FUNCTION_ACTIVE = 3001, NoError, "it is started already; RESET comes first",
        "START was given to a function that is started (AMK-CMD-10)." => "Give RESET first, or VALUE_NEW where its type takes that.";
    FUNCTION_AT_REST = 3002, NoError, "it is in RESET; VALUE_NEW needs a function that is started",
        "VALUE_NEW was given to a function that is not started (AMK-CMD-12)." => "Give START, with the values.";
    FUNCTION_NO_VALUE_NEW = 3003, NoError, "its type has no VALUE_NEW; values count from START on",
        "The type of the function takes new values at START only (AMK-CMD-03)." => "Give RESET, then START with the values.";
    FUNCTION_RANGE = 3004, NoError, "", "A value of the set is outside the range of its field; `lineshaft functions TYPE` lists the ranges."
        => "Give a value within the range; nothing of the set was taken.";
    FUNCTION_USES_TABLE = 3005, NoError, "", "The table is read by a started function whose type allows no edit (AMK-GEN-13)."
        => "Give RESET to the function, load the table, start it again.";
    FUNCTION_TABLE_FORM = 3006, NoError, "", "A table keeps the form that the cell gives it." => "Load a table of that form.";
    FUNCTION_WRITES = 3008, NoError, "", "The output is one of a function, which sets it while it runs (AMK-GEN-09)."
        => "Command the function, or take the output out of its list.";
    FUNCTION_TOO_FAST = 3007, Ends, "its function asks for {asked}; max_velocity is {limit}",
        "The sink of the function that moves the axis changed faster than max_velocity allows; it is followed exactly or not at all."
        => "Slow the source down, choose another ratio or raise max_velocity; then reset_errors, RESET and START.";
    AMK_CYCLE_MISMATCH = 3020, NoError, "{asked} times 0.5 ms is not the cycle of the slot, {limit}",
        "A set of a function names another cycle than its slot has."
        => "Leave it out, or give the cycle of the machine times `cycle_factor`, in units of 0.5 ms.";
    AMK_TABLE_MISSING = 3021, NoError, "the first table is missing; the function reads its points or cams there",
        "A function that reads a table has none." => "Name a table of form words as the first of `tables`.";
    AMK_TABLE_FORM = 3022, NoError, "the first table is not of form words",
        "A function that reads a data block was given a table of form y or xy."
        => "Make it of form words, in the layout of the source's data block.";
    AMK_TABLE_SHORT = 3023, NoError, "the table has {asked} words; what is counted in it needs {limit}",
        "A table ends before the last cam, point or drive that is counted." => "Add the missing words, or count fewer.";
    AMK_POINTS = 3024, NoError, "DW0 of the table is {asked}; points + 1, so 2 to {limit}, is possible",
        "DW0 of an output table counts no points, or too many." => "Give the number of points + 1.";
    AMK_POINT_ORDER = 3025, NoError, "DD{asked} of the table is not above the point before it, {limit}",
        "The points of an output table do not rise." => "Sort them; no two are equal.";
    AMK_POINT_NEGATIVE = 3026, NoError, "the first point of the table is {asked}; x runs from {limit} on",
        "An output table has negative points, and in this mode x is never negative." => "Begin at 0 or above, or choose ba 0.";
    AMK_NO_MODULO = 3027, NoError, "x begins anew at {asked}; {limit} or more is possible",
        "The modulo of a cam controller, or the last point of an output table, is 0 in a mode that runs round."
        => "Give the increments, or the time, after which x begins again.";
    AMK_TIME_LONG = 3028, NoError, "DW{asked} of the table is a time above {limit} half milliseconds",
        "A time in the table of a cam controller is outside its range." => "Give a shorter one; a negative word is none.";
    AMK_TIME_SHORT = 3029, NoError, "DW{asked} of the table is a time shorter than a call, {limit} ns",
        "A time in the table of a cam controller is shorter than the time between two calls."
        => "Give a longer one; dead times and pulses may be 0.";
    AMK_TRACK_LOGIC = 3030, NoError, "mode {asked} has AND and OR at once, bits 2 and 3", "The mode of a track has both bits of its logic."
        => "Set one of them, or none.";
    AMK_MEAN_LONG = 3031, NoError, "a mean over {asked} calls is asked for; there is room for {limit}",
        "A mean over more calls was asked for than the cell leaves room for." => "Average over fewer calls, or make more room in the cell.";
    AMK_DEAD_TIME_MODE = 3032, NoError, "fct 1 compensates a dead time in ba {limit} only; ba is {asked}",
        "BINEA was to compensate a dead time in another mode than the incremental one." => "Set fct to 0, or ba to 1.";
    AMK_DEAD_TIME_UNUSED = 3033, NoError, "a dead time of {asked} half milliseconds needs fct 1",
        "BINEA was given a dead time without its compensation." => "Set fct to 1 with ba 1, or leave the dead time out.";
    AMK_CAM_COUNT = 3034, NoError, "the tracks have {asked} cams together; up to {limit} are possible",
        "The tracks of a cam controller have too many cams together." => "Use fewer, or a second function.";
    AMK_HYSTERESIS = 3035, NoError, "the hysteresis of {asked} inc is not below the {limit} inc from the end of a cam to its start",
        "The hysteresis of a track is as long as the way from the end of one of its cams to its start, or longer."
        => "Choose a smaller hysteresis, or a shorter cam.";
    AMK_TRACK_SELECT = 3036, NoError, "DR1 of the table names track {asked}; 0 to {limit} are there",
        "A cam table selects a track that does not exist for the offset in the sink." => "Name one of the tracks 0 to 7.";
    AMK_NO_WORD = 3040, NoError, "mode 3 takes its ratio from a word; the function names none",
        "Mode 3 of varsync was chosen, and the function names no word that holds the ratio."
        => "Name one in `word_addr`, or choose mode 0, 1 or 2.";
    AMK_THRESHOLD = 3043, NoError, "the first table has a threshold of {asked}; 0 to {limit} is possible",
        "A threshold of a chosen drive is outside its range, or the word after it is not 0." => "Give one of 0 to 32767, and 0 after it.";
    AMK_RATIO_DIVIDER = 3044, NoError, "the first table has a ratio divider of {asked}; 0 and {limit} or more are possible",
        "The divider of a chosen drive's ratio is negative, or above 0 and below 65536."
        => "Give it as the drive has it, low word first; 0 and 0 is ratio 1.";
    AMK_LIMITATION = 3045, NoError, "{asked} limits the measurement to positive and to negative at once", "Bits 2 and 3 of `ba` are both 1."
        => "Set one of them, or none.";
    AMK_NO_MODE = 3046, NoError, "no mode has number {asked}", "A set of a function names a mode that its type does not have."
        => "fipw: 2, 26, 82 or 98 by way, 4, 132, 84 or 100 by time; xfipw: the same, or one more with sets of tables.";
    AMK_MODE_FIELD = 3047, NoError, "{asked} has no meaning in mode {limit}",
        "A field of a function has a value that its mode does not use, or a function bit that this version or this mode lacks."
        => "Set the field to 0, table_count and tables_total to 1, or choose the mode that uses it.";
    AMK_BEYOND = 3048, NoError, "{asked} is not allowed; the bound is {limit}",
        "A field violates the bound that the mode or the other fields of its set leave."
        => "Tables last 50 to 32767 inc, or 1 to 32767 calls; offsets and windows end before the table does, start_tables below \
            table_count. dfkt: active_table within table_count, with bit 2 of `ba` mult times last point / in_final within 32767. epos: \
            stop_decel no less than acceleration; with bit 1 of `ba` 1 to 9 ms between two calls, sf_cycle 2 to 18. ecopy: values for an \
            analog output within its full scale (mV). sidiff: display_aw within the axes of the cell.";
    AMK_TABLES_FEW = 3049, NoError, "{asked} tables are counted; the function has {limit}",
        "A set of a function counts more tables than the cell gives the function." => "Name more in `tables`, or count fewer.";
    AMK_TABLE_SETS = 3050, NoError, "{asked} tables are no whole sets of {limit}",
        "Inputs were to select sets of tables, and the tables of the function are no multiple of tables_total."
        => "Name as many tables as the sets need together.";
    AMK_CURVE_FORM = 3051, NoError, "Tab{asked} is of a form that the type does not read",
        "An interpolator was given a table of form words, or a type one with places of its own where it takes none."
        => "fipw and fipz read form y, xfipw reads y and xy, dfkt y and words.";
    AMK_CURVE_POINTS = 3052, NoError, "Tab{asked} has {limit} points, more or fewer than the type takes",
        "A table of an interpolator or of speeds has fewer than two points, or too many."
        => "fipw, fipz and dfkt take 2 to 127, xfipw 2 to 2000, of form xy 2 to 1000.";
    AMK_CURVE_FIRST = 3053, NoError, "Tab{asked} begins at {limit} instead of 0",
        "The first value of a table, or its first place, is not 0."
        => "Take the first value off all of them: the sink goes on from where it is.";
    AMK_CURVE_ORDER = 3054, NoError, "point {limit} of Tab{asked} is not after the one before it",
        "The places of a table of form xy do not rise." => "Sort them; no two are equal.";
    AMK_CURVE_STEP = 3055, NoError, "point {limit} of Tab{asked} is 32768 or more from the one before it",
        "Two neighbouring values of a table differ by 32768 or more." => "Use more points, or a smaller table with `mult`.";
    AMK_CURVE_LENGTH = 3056, NoError, "Tab{asked} ends at place {limit}; 50 to 32767 inc are possible, by time 1 to 32767",
        "The last place of a table of form xy is outside its range." => "Give one within it.";
    AMK_CURVE_SCALED = 3057, NoError, "Tab{asked} reaches {limit} behind mult and div_exp; less than 2147483647 is possible",
        "The largest value of a table, times mult and divided by 2 to the power of div_exp, has no place in 32 bits."
        => "Choose a smaller mult or a larger div_exp.";
    AMK_NO_ZERO_PULSE = 3058, NoError, "function {asked} waits for a zero pulse; the source is no encoder",
        "Bit 2 of `function` is set, and the source of the function is no encoder, which alone has pulses."
        => "Choose an encoder as source, or leave bit 2 out.";
    AMK_NO_SOURCE = 3059, NoError, "mode {asked} runs by the way of a source; the function has none",
        "A mode by way was chosen for a function whose source is none." => "Name a source, or choose a mode by time.";
    AMK_RATIO_LIMITS = 3060, NoError, "{asked} is not below ratio_max, {limit}", "The least ratio of a dfkt is not below its largest one."
        => "Set ratio_min below ratio_max; -32767 and 32767 with ratio_div 1 limit hardly anything.";
    AMK_CONTINUATION = 3061, NoError, "{asked} is no way to go on below 0; 0 holds the first point, 2 mirrors the table",
        "cont_low of a dfkt is 1." => "Set it to 0 or 2.";
    AMK_LAST_POINT = 3062, NoError, "Tab{asked} ends at 0 rpm, and no ratio can be related to that",
        "Bit 2 of `ba` relates the ratio of a dfkt to the last point of its table, which is 0."
        => "Leave bit 2 out, or end the table at another speed.";
    AMK_OUTPUT_TABLE = 3063, NoError, "Tab7 would be a table that the function writes, which does not exist here; Tab0 to Tab6 are read",
        "A dfkt has an eighth table." => "Name seven at most; the signals of the function show what it does.";
    AMK_SPEED_POINT = 3064, NoError, "point {limit} of Tab{asked} is not within -32767 to 32767 rpm",
        "A point of a table of speeds is outside its range." => "Points are whole rpm; reach higher speeds by mult and div.";
    AMK_TABLE_IN_USE = 3065, NoError, "Tab{asked} is the one that runs, which gets no new numbers",
        "The table that a started dfkt follows was to be loaded (AMK-DFKT-25)."
        => "Load one that is not active and select that; or RESET, load, START.";
    AMK_SPEED_POINTS = 3066, NoError, "DW0 of Tab{asked} is {limit}; points + 1, so 3 to 128, is possible",
        "DW0 of a table of speeds counts fewer than 2 points, or more than 127." => "Give the number of points + 1.";
    AMK_SPEED_WORDS = 3067, NoError, "Tab{asked} has {limit} words, too few for the points that its DW0 counts",
        "A table of speeds ends before its last point: point i is in DW 2 i." => "Add the missing words, or count fewer.";
    AMK_NO_RESOLUTION = 3068, NoError, "{asked} increments make no turn; 1 to {limit} is possible where the input is a way",
        "Bit 0 of `ba` makes a speed of the travel of the source, and in_resolution is 0."
        => "Set in_resolution to the increments of one turn of the master.";
    AMK_TABLE_NONE = 3069, NoError, "{asked} selects Tab{limit}, which the function does not have",
        "active_table names a place of `tables` that is `none` or behind their end." => "Name a table there, or select another one.";
    AMK_NOT_ZERO = 3070, NoError, "{asked} is no value of it in this `ba`; 1 to {limit} is possible",
        "A field of a fgen or an epos that its `ba` uses is 0 or was left out, or is a negative velocity."
        => "fgen: give cycle_time where bit 0 of `ba` is 0, accel2 where bit 2 is 1. epos: give velocity, the direction of a relative \
            order is the sign of travel; with bit 0 master_resolution.";
    AMK_NO_GAIN = 3071, NoError, "a gain of {asked} lets nothing through; -32768 to -1 and 1 to {limit} are possible",
        "gain_v of a regl is 0 or was left out." => "Give it; switch_mask or its inputs open the loop.";
    AMK_BA_KEPT = 3072, NoError, "{asked} changes bits that count from START on; {limit} would change none of them",
        "VALUE_NEW has changed more of `ba` than may change while the function runs."
        => "fgen takes bit 1, regl bits 2 and 3; RESET and START take all.";
    AMK_CALL_WAY = 3073, NoError, "a call would go {asked} inc at the largest override; up to {limit} is possible",
        "cycle_increments in cycle_time are 32768 inc or more between two calls of a fgen, with an override at its 200 %."
        => "Choose a longer cycle_time or fewer cycle_increments; counters of 16 bits would lose count.";
    AMK_MODULO_SUBSTITUTIONAL = 3080, NoError, "{asked} is substitutional and modulo at once, bits 1 and 4",
        "Bits 1 and 4 of `ba` of an epos are both 1." => "Choose one of them.";
    AMK_NO_REFERENCE = 3081, NoError, "{asked} runs to a zero pulse, bit 1; the sink is no axis with a drive, which alone has one",
        "Bit 1 of `ba` of an epos is set, and its sink is memory, an output, an axis without a drive or none."
        => "Give it an axis as sink, or position relatively.";
    AMK_NO_TRAVEL = 3082, NoError, "{asked} is no travel with ba {limit}: a reference is left behind, and a multiple has a length",
        "travel of an epos is 0 with bit 1 or bit 4 of `ba`." => "Give it another value; only a relative order may be 0.";
    AMK_NO_APPROACH = 3083, NoError, "{asked} has no sense to approach in; -2147483648 to -1 and 1 to {limit} are possible",
        "velocity of an epos is 0 or was left out, with bit 1 of `ba`."
        => "Give it; its sign is the direction of the approach, also where the source is the velocity.";
    AMK_AGAINST_APPROACH = 3084, NoError, "{asked} is against the approach, whose velocity is {limit}; bit 2 of `ba` lets it turn round",
        "travel and velocity of an epos have opposite signs with bit 1 of `ba` and without bit 2."
        => "Let it turn round with bit 2, or approach from the other side.";
    FUNCTION_NO_GOALS = 3085, NoError, "run_function gives an order that ends; its type has none",
        "A goal was given to a function of another type than epos." => "Give it its inputs, and its orders by command_function.";
    FUNCTION_BUSY = 3086, NoError, "an order is under way; it has to end first, or its goal to be cancelled",
        "A goal was given to a function that moves: by another goal, or by its inputs."
        => "Wait until its A1 is 1, cancel its goal, or stop it by E2.";
    FUNCTION_LEFT = 3087, NoError, "something else moves or stops its axis, or has switched it off; RESET and START give it back",
        "A function was given a goal, or had one, and the axis that it moves has left it: by a move, a halt, a stop, a loss of power."
        => "Free and enable the axis, then RESET and START, or a new goal behind RESET.";
    FUNCTION_STOPPED = 3088, NoError, "E2 has stopped its order, with {asked} left", "E2 rose while a goal of run_function was under way."
        => "Give a new goal, or continue the order by E1.";
    FUNCTION_RESET = 3089, NoError, "it was reset, with {asked} left",
        "RESET was given to a function while a goal of run_function was under way." => "Give the goal again: it starts the function.";
    AMK_DB_LONG = 3090, NoError, "its table has {asked} words; the image of a program takes {limit}",
        "A function of type apsf was started with a longer table than a program can read."
        => "Give a shorter table, or several functions one each.";
    AMK_OUT_OF_FUEL = 3091, Ends, "the program took more than {limit} instructions in a call",
        "A program of the user has a loop without an end, or does more in a call than `fuel` of its function lets it."
        => "Fix the loop, do less in a call, or raise `fuel`; START restarts the program.";
    AMK_STACK = 3092, Ends, "the program calls itself too deep: 256 calls within each other and 8192 values are possible",
        "A program of the user calls itself without an end, or has very large frames." => "Fix the recursion; START restarts the program.";
    AMK_UNREACHABLE = 3093, Ends, "the program came to what it says is never reached: a panic of its own",
        "A program of the user panicked: an index beyond an array, an overflow, an `unwrap` of nothing, an abort."
        => "Try it with `lineshaft program run` and the same inputs; START restarts the program.";
    AMK_MEMORY_BOUNDS = 3094, Ends, "the program read or wrote beside its memory", "A program of the user has a wrong address."
        => "Try it with `lineshaft program run` and the same inputs; START restarts the program.";
    AMK_NO_FUNCTION = 3095, Ends, "the program called what is no function, or one of another signature",
        "A program of the user has a wrong pointer to a function."
        => "Try it with `lineshaft program run` and the same inputs; START restarts the program.";
    AMK_DIVISION_BY_ZERO = 3096, Ends, "the program divided a whole number by 0",
        "A program of the user divides by something that became 0." => "Look for 0 before it divides; START restarts the program.";
    AMK_INTEGER_OVERFLOW = 3097, Ends, "the program got a whole number that does not fit: a quotient, or a float that it converted",
        "A program of the user converts a float that is too large, or divides the least number by -1."
        => "Limit the value before it is converted; START restarts the program.";
    AMK_NOT_A_NUMBER = 3098, Ends, "the program converted NaN to a whole number",
        "A program of the user calculates 0 / 0, the root of something below 0, or the like."
        => "Look for it before the value is converted; START restarts the program.";
    AMK_IMAGE = 3099, Ends, "the program wrote over the first word of its image, which says how long that is",
        "A program of the user writes where it should not."
        => "Try it with `lineshaft program run` and the same inputs; START restarts the program.";
    AMK_NOT_FINITE = 3100, Ends, "the program left a memory cell NaN or infinite",
        "A program of the user wrote a real number that is not finite into `writes` of its image."
        => "Limit the value before it is written; START restarts the program.";
    AMK_OTHER_LENGTH = 3101, NoError, "its image has {asked} bytes, that of the program which runs has {limit}: its state cannot be kept",
        "A program was to be exchanged with its state, and its own part of the image has another length."
        => "Exchange it with `state: reset`, or leave the structure of the state as it is.";
    AMK_PROGRAM_LARGE = 3102, NoError, "it needs {asked} pages of memory; its functions have room for {limit}",
        "A program was to be exchanged for one with more memory than its functions have room for: 4 pages, or as many as the first had."
        => "Link it with less memory, or begin with it.";
    AMK_OUTPUTS_BEHIND = 3103, NoError, "{asked} outputs do not fit behind the first one; {limit} do",
        "The first output of an apsf and `out_bits` from there on go beyond A8 (A-32)."
        => "Wire the first output further in front, or let the program write fewer.";
    AMK_NO_AXIS = 3104, NoError, "{asked} has a bit of an axis that the cell does not have; it has {limit}",
        "aw_mask of sidiff or fgen has a bit of an axis that the cell does not have."
        => "Leave the bit out: bit n-1 is the n-th axis of the cell.";
}
