//! Keys of scenarios. docs/contract.md, section 5, has the verbs and their arguments.

use super::Shape::{Boolean, Choice, Integer, List, Map, Number, Quantity, Text};
use super::{File, Key, Shape};

const MAP: &[Shape] = &[Map];
const LIST: &[Shape] = &[List];
const TEXT: &[Shape] = &[Text];
/// Value in the unit of a signal, a state by its name, a code by its name.
const VALUE: &[Shape] = &[Text];
const CYCLES: i128 = 1_000_000_000_000;
const COUNT: &[Shape] = &[Integer(0, (u64::MAX >> 1) as i128)];
/// Number of cycles, or a time.
const SPAN: &[Shape] = &[Quantity("time"), Integer(0, CYCLES)];
/// Cycle or time from a start.
const MOMENT: &[Shape] = &[Quantity("time"), Integer(0, CYCLES), Choice(&["end"])];

const AT_LEAST_1: &str = "at least 1 cycle";
const OF_SIGNAL: &str = "a value in the unit of the signal";
const AMOUNT: &str = "cycles, or a time with its unit";
const WHEN: &str = "a cycle, a time with its unit, or end";

/// All keys, in the order of the reference.
pub(super) const KEYS: &[&[Key]] =
    &[GENERAL, DRIVE, STEPS, WHEN_CONDITION, WHEN_BOUNDS, EXPECT, EXPECT_CONDITION, CONDITION, CONDITION_BOUNDS];

const fn key(path: &'static str, shapes: &'static [Shape], texts: [&'static str; 4]) -> Key {
    Key::new(File::Scenario, path, shapes, texts)
}

/// Keys of a condition; an expectation has more.
macro_rules! condition {
    ($at:literal) => {
        [
            key(
                concat!($at, ".signal"),
                TEXT,
                ["a signal of the cell", "required, or `parameter`", "Signal that is tested.", "signal: x.state"],
            ),
            key(
                concat!($at, ".plus"),
                TEXT,
                ["a signal of the cell", "none", "Signal that is added.", "plus: y.actual.position"],
            ),
            key(
                concat!($at, ".minus"),
                TEXT,
                ["a signal of the cell", "none", "Signal that is subtracted.", "minus: x.target.position"],
            ),
            key(
                concat!($at, ".mask"),
                &[Integer(1, i64::MAX as i128)],
                ["", "all bits", "Bits of the signal that are tested.", "mask: 0x0F"],
            ),
            key(
                concat!($at, ".parameter"),
                TEXT,
                [
                    "a parameter of the cell",
                    "none",
                    "Parameter that is tested in place of a signal.",
                    "parameter: x.max_velocity",
                ],
            ),
            key(concat!($at, ".is"), VALUE, [OF_SIGNAL, "none", "The value must be this one.", "is: STANDSTILL"]),
            key(
                concat!($at, ".within"),
                VALUE,
                [OF_SIGNAL, "exact", "Largest deviation from `is` or `values`.", "within: 2 um"],
            ),
            key(concat!($at, ".not"), VALUE, [OF_SIGNAL, "none", "The value must not be this one.", "not: DISABLED"]),
            key(
                concat!($at, ".all"),
                LIST,
                ["", "none", "Conditions that must hold together.", "all: [{signal: x.homed, is: 1}]"],
            ),
            key(
                concat!($at, ".any"),
                LIST,
                ["", "none", "Conditions of which one must hold.", "any: [{signal: x.homed, is: 1}]"],
            ),
        ]
    };
}

/// Bounds of a value, or of the number of events.
macro_rules! bounds {
    ($at:literal) => {
        [
            key(
                concat!($at, ".min"),
                VALUE,
                [OF_SIGNAL, "none", "The value must be at least this one.", "min: 0.5 m/s"],
            ),
            key(
                concat!($at, ".max"),
                VALUE,
                [OF_SIGNAL, "none", "The value must be at most this one.", "max: 0.5 m/s"],
            ),
        ]
    };
}

const GENERAL: &[Key] = &[
    key("scenario", TEXT, ["any text", "required", "Name of the scenario.", "scenario: x moves"]).required(),
    key(
        "cell",
        TEXT,
        [
            "a file, relative to the scenario",
            "NAME.yaml next to NAME.scenario.yaml",
            "Cell of the scenario.",
            "cell: press.yaml",
        ],
    ),
    key("for", SPAN, [AT_LEAST_1, "required, or `cycles`", "Length of the scenario.", "for: 3 s"]),
    key("cycles", &[Integer(1, CYCLES)], ["", "required, or `for`", "Length of the scenario.", "cycles: 3000"]),
    key("trace", LIST, ["", "all signals", "Signals that are recorded.", "trace: [x.*]"]),
    key("trace[]", TEXT, ["a pattern such as x.*", "", "One pattern.", ""]),
    key("every", SPAN, [AT_LEAST_1, "1", "Cycles from one recorded row to the next.", "every: 10 ms"]),
];

const DRIVE: &[Key] = &[
    key(
        "drive",
        LIST,
        ["", "none", "Inputs of the simulated machine that are driven.", "drive: [{signal: start, values: [0, 1]}]"],
    ),
    key("drive[]", MAP, ["", "", "One driven signal, with one of values, csv, ramp and sine.", ""]),
    key(
        "drive[].signal",
        TEXT,
        ["an input, a memory cell, a count or a switch", "required", "Signal that is driven.", "signal: belt.count"],
    )
    .required(),
    key("drive[].at", MOMENT, [WHEN, "0", "First cycle in which it is driven.", "at: 100"]),
    key("drive[].values", LIST, ["", "none", "One value for each cycle.", "values: [0, 3, 6]"]),
    key("drive[].values[]", VALUE, [OF_SIGNAL, "", "One value.", ""]),
    key(
        "drive[].csv",
        MAP,
        ["", "none", "A column of a CSV file: one row for each cycle.", "csv: {file: start.csv, column: start}"],
    ),
    key("drive[].csv.file", TEXT, ["a file next to the scenario", "required", "The file.", "file: start.csv"])
        .required(),
    key("drive[].csv.column", TEXT, ["a name of the first row", "required", "The column.", "column: start"]).required(),
    key("drive[].ramp", MAP, ["", "none", "A ramp.", "ramp: {from: 0, per_cycle: 1/3, until: 500}"]),
    key("drive[].ramp.from", VALUE, [OF_SIGNAL, "0", "Value of the first cycle.", "from: 0"]),
    key(
        "drive[].ramp.per_cycle",
        &[Number],
        ["a number or a fraction", "required", "Change per cycle, in increments of a count.", "per_cycle: 1/3"],
    )
    .required(),
    key("drive[].ramp.until", VALUE, [OF_SIGNAL, "no end", "Value at which the ramp ends.", "until: 500"]),
    key(
        "drive[].ramp.wrap",
        &[Integer(2, 64)],
        ["2 to the bits of the signal", "none", "Bits after which the ramp wraps, as a counter does.", "wrap: 16"],
    ),
    key("drive[].sine", MAP, ["", "none", "A sine.", "sine: {amplitude: 100, period: 1 s}"]),
    key("drive[].sine.mean", VALUE, [OF_SIGNAL, "0", "Mean value.", "mean: 50"]),
    key("drive[].sine.amplitude", VALUE, [OF_SIGNAL, "required", "Amplitude.", "amplitude: 100"]).required(),
    key("drive[].sine.period", SPAN, [AMOUNT, "required", "Period.", "period: 1 s"]).required(),
    key(
        "drive[].then",
        &[Choice(&["hold", "repeat", "release"]), Map],
        ["", "hold", "Behaviour after the last value; a mapping holds it for a time.", "then: repeat"],
    ),
    key("drive[].then.hold", SPAN, [AT_LEAST_1, "required", "How long the last value is held.", "hold: 10 ms"])
        .required(),
];

const STEPS: &[Key] = &[
    key("steps", LIST, ["", "none", "Steps of the scenario.", "steps: [{at: 0, do: {enable: {}}}]"]),
    key("steps[]", MAP, ["", "", "One step, with `at` or `when`.", ""]),
    key("steps[].name", TEXT, ["any text, once", "none", "Name for `since` of an expectation.", "name: go"]),
    key(
        "steps[].do",
        &[Map, List],
        [
            "",
            "required",
            "A verb with its arguments, or a list of them; docs/contract.md, section 5, lists them.",
            "do: {enable: {axes: [x]}}",
        ],
    )
    .required(),
    key("steps[].at", MOMENT, [WHEN, "required, or `when`", "Cycle or time of the step.", "at: 1 s"]),
    key(
        "steps[].when",
        MAP,
        [
            "",
            "required, or `at`",
            "Condition that starts the step, once the step before has acted.",
            "when: {signal: x.state, is: STANDSTILL}",
        ],
    ),
    key("steps[].after", SPAN, [AMOUNT, "0", "Time from the condition to the step.", "after: 10 ms"]),
    key("steps[].every", SPAN, [AT_LEAST_1, "once", "Time from one repetition to the next.", "every: 10 ms"]),
    key(
        "steps[].count",
        &[Integer(1, CYCLES)],
        ["", "until the end", "How often a step with `every` acts.", "count: 5"],
    ),
    key(
        "steps[].refused",
        &[Text, Map],
        [
            "a part of the sentence, a name, or any",
            "accepted",
            "The commands of the step must be refused so.",
            "refused: max_position",
        ],
    ),
    key(
        "steps[].refused.code",
        TEXT,
        ["a number or a name of docs/errors.md", "any", "Code of the refusal.", "code: 98"],
    ),
    key("steps[].refused.text", TEXT, ["a part of the sentence", "any", "Text of the refusal.", "text: max_position"]),
    key("steps[].optional", &[Boolean], ["", "false", "Whether the step may never act.", "optional: true"]),
];

const WHEN_CONDITION: &[Key] = &condition!("steps[].when");
const WHEN_BOUNDS: &[Key] = &bounds!("steps[].when");

const EXPECT: &[Key] = &[
    key("expect", LIST, ["", "none", "Expectations on the run.", "expect: [{signal: x.error, is: 0}]"]),
    key("expect[]", MAP, ["", "", "One expectation: a condition, a list of values, or events.", ""]),
    key("expect[].since", TEXT, ["the name of a step", "cycle 0", "Step from which times are counted.", "since: go"]),
    key("expect[].from", RELATIVE, [WHEN, "0", "First cycle; after `since` it may be negative.", "from: 0.1 s"]),
    key("expect[].to", RELATIVE, [WHEN, "end", "Last cycle; after `since` it may be negative.", "to: end"]),
    key("expect[].at", RELATIVE, [WHEN, "`from` to `to`", "The only cycle.", "at: end"]),
    key(
        "expect[].mode",
        &[Choice(&["always", "eventually", "never"])],
        ["", "always; of events eventually", "How often the condition must hold.", "mode: eventually"],
    ),
    key(
        "expect[].values",
        LIST,
        ["", "none", "Values of the signal, one for each cycle from `from` on.", "values: [0, 3, 6]"],
    ),
    key("expect[].values[]", VALUE, [OF_SIGNAL, "", "One value.", ""]),
    key("expect[].every", SPAN, [AT_LEAST_1, "1", "Cycles from one of `values` to the next.", "every: 10"]),
    key(
        "expect[].event",
        MAP,
        ["", "none", "Events that are counted; without a key all of them.", "event: {kind: latch, source: mark}"],
    ),
    key(
        "expect[].event.kind",
        &[Choice(&[
            "accepted",
            "refused",
            "done",
            "state",
            "error",
            "reset",
            "latch",
            "mark",
            "limit",
            "homed",
            "parameter",
            "overrun",
            "warning",
        ])],
        ["", "any", "Kind of the event.", "kind: latch"],
    ),
    key(
        "expect[].event.source",
        TEXT,
        ["an object of the cell, or machine", "any", "Source of the event.", "source: mark"],
    ),
    key(
        "expect[].event.severity",
        &[Choice(&["info", "warn", "error"])],
        ["", "any", "Severity of the event.", "severity: error"],
    ),
    key(
        "expect[].event.code",
        TEXT,
        ["a number or a name of docs/errors.md", "any", "Code of the event.", "code: 10201"],
    ),
    key(
        "expect[].event.age_ns",
        &[Integer(0, u32::MAX as i128)],
        ["", "any", "Age of the event within its cycle (ns).", "age_ns: 350000"],
    ),
    key(
        "expect[].event.increments",
        VALUE,
        ["increments, or a position with its unit", "any", "Position of the event.", "increments: 120 mm"],
    ),
    key("expect[].event.text", TEXT, ["a part of the sentence", "any", "Text of the event.", "text: max_position"]),
    key("expect[].count", COUNT, ["", "none", "How many events there must be.", "count: 5"]),
    key(
        "expect[].min",
        VALUE,
        ["a value, or a number of events", "none", "Lowest value, or fewest events.", "min: 0.5 m/s"],
    ),
    key(
        "expect[].max",
        VALUE,
        ["a value, or a number of events", "none", "Highest value, or most events.", "max: 0.5 m/s"],
    ),
];

const EXPECT_CONDITION: &[Key] = &condition!("expect[]");
/// Entry of `all` and `any` at any depth.
const CONDITION: &[Key] = &condition!("condition");
const CONDITION_BOUNDS: &[Key] = &bounds!("condition");

/// Cycles relative to a step; they may be negative.
const RELATIVE: &[Shape] = &[Quantity("time"), Integer(-CYCLES, CYCLES), Choice(&["end"])];
