//! Tests stores that do not fit the cell: each is refused with its location, and nothing changes.

use super::*;
use lineshaft_core::parameter::{Row, Value};

/// Returns the problems of a store with these lines, each after its location.
fn problems(axes: &str, parameters: &str) -> Vec<String> {
    problems_of(&format!("lineshaft_store: 1\ngeneration: 4\naxes:\n{axes}parameters:\n{parameters}"), &config())
}

fn problems_of(text: &str, config: &MachineConfig) -> Vec<String> {
    let problems = read_store("p.yaml", text, config).expect_err("it fits").to_string();
    problems.lines().map(str::to_owned).collect()
}

const X: &str = "  x: 1000000 inc/m\n";

#[test]
fn each_problem_has_its_place() {
    let cases = [
        (
            "  z: 1 inc/m\n",
            "  z.max_velocity: 1 inc/s\n",
            "p.yaml:4:3: the cell has no axis `z`; its axes are x, table",
        ),
        (
            "  x: 999 inc/m\n",
            "  x.max_velocity: 1 inc/s\n",
            "p.yaml:4:6: x was saved with a scale of 999 inc/m, and has 1000000 inc/m in the cell: its increments mean something else",
        ),
        (
            "  x: 1000000 inc/rev\n",
            "",
            "p.yaml:4:6: x was saved with a scale of 1000000 inc/rev, and has 1000000 inc/m in the cell: its increments mean \
             something else",
        ),
        (
            X,
            "  x.max_velocty: 1 inc/s\n",
            "p.yaml:6:3: no parameter is called `x.max_velocty`, did you mean `x.max_velocity`?",
        ),
        (X, "  x.error_reaction: 6\n", "p.yaml:6:21: x: error_reaction is 6; 0 to 5 is allowed"),
        (X, "  x.max_velocity: -1 inc/s\n", "p.yaml:6:19: x: max_velocity is -0.001 mm/s; "),
        (X, "  x.velmaxqc: 6\n", "p.yaml:6:15: x: velmaxqc "),
        (
            X,
            "  x.velocity_override: 50\n",
            "p.yaml:6:3: x: velocity_override begins anew with each start and is never saved",
        ),
        (
            X,
            "  x.min_position: 2000000 inc\n",
            "p.yaml:6:19: x: min_position 2000 mm must be below max_position 1000 mm",
        ),
        (
            X,
            "  x.max_velocity: 10000 inc/s\n  x.default_velocity: 20000 inc/s\n",
            "p.yaml:7:23: x: default_velocity 20 mm/s must not exceed max_velocity 10 mm/s",
        ),
        (X, "  x.amc.reference_select: 1\n  x.amc.speed_reference: 2000000 inc/s\n", "p.yaml:7:26: x: "),
    ];
    for (axes, parameters, expected) in cases {
        let found = problems(axes, parameters);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with(expected), "{}\n{expected}", found[0]);
    }
}

/// The cell was edited: it contradicts the saved values.
#[test]
fn a_limit_of_the_cell_that_contradicts_what_was_saved_is_named() {
    let text = format!("lineshaft_store: 1\ngeneration: 4\naxes:\n{X}parameters:\n  x.max_position: 400000 inc\n");
    let edited = CELL.replace("min_position: 0 mm", "min_position: 500 mm");
    let config = Cell::parse("cell.yaml", edited).unwrap().machine;
    assert_eq!(problems_of(&text, &config), ["p.yaml:6:19: x: max_position 400 mm must be above min_position 500 mm"]);
}

/// The cell reversed the direction of rotation: a saved limit would apply to another position.
#[test]
fn positions_that_count_the_other_way_are_refused() {
    let turned = |posdrct: i64| {
        let cell = CELL.replace("min_position: 0 mm", &format!("posdrct: {posdrct}, min_position: 0 mm"));
        Cell::parse("cell.yaml", cell).unwrap().machine
    };
    let saved_by = |config: &MachineConfig, posdrct: i64| {
        let mut user = config.axes[0].parameters;
        for (key, value) in [("posdrct", Value::Int(posdrct)), ("max_position", Value::Int(2_000_000))] {
            Row::find(key).unwrap().1.change(&mut user, value).unwrap();
        }
        (text::whole(1, &text::body(&[(&config.axes[0], &user)])), user)
    };
    let sets = |text: &str, config: &MachineConfig| read_store("p.yaml", text, config).map(|stored| stored.sets[0]);
    let (text, user) = saved_by(&turned(1), 1);
    assert_eq!(sets(&text, &turned(1)).unwrap(), Some(user));
    assert_eq!(
        problems_of(&text, &turned(-1)),
        [
            "p.yaml:6:6: x was saved with posdrct above 0, and the cell has posdrct -1: its positions count the other way"
        ]
    );
    let (text, user) = saved_by(&turned(-1), -1);
    assert!(text.contains("\n  x: -1000000 inc/m\n"), "{text}");
    assert_eq!(sets(&text, &turned(-1)).unwrap(), Some(user));
    assert_eq!(problems_of(&text, &turned(11)).len(), 1);
    // A saved direction of rotation is kept, whatever the cell has.
    let (text, user) = saved_by(&turned(1), -1);
    assert_eq!(sets(&text, &turned(1)).unwrap(), Some(user));
    assert_eq!(sets(&text, &turned(-11)).unwrap().unwrap().max_position, Some(2_000_000));
}

#[test]
fn another_format_and_missing_keys_are_refused() {
    let config = config();
    let found = problems_of("lineshaft_store: 2\nsomething: else\n", &config);
    assert_eq!(found, ["p.yaml:1:18: lineshaft_store is `2`; format version 1 is allowed"]);
    let found = problems_of("lineshaft_store: 1\naxes:\nbogus: 1\n", &config);
    assert_eq!(found.len(), 3, "{found:?}");
    for missing in ["generation", "parameters"] {
        assert!(found.iter().any(|line| line.contains(&format!("missing key `{missing}`"))), "{found:?}");
    }
    assert!(found.iter().any(|line| line.contains("unknown key `bogus`")), "{found:?}");
}

/// All problems at once, the remedy, and the unchanged cell.
#[test]
fn what_does_not_fit_changes_nothing() {
    let bench = Bench::new();
    let body = format!("axes:\n{X}parameters:\n  x.error_reaction: 9\n  x.in_position_window: -4 inc\n");
    fs::write(bench.path("p.yaml"), text::whole(4, &body)).unwrap();
    let mut config = bench.config.clone();
    let error = bench.open().unwrap().load(&mut config).unwrap_err().to_string();
    let lines: Vec<_> = error.lines().collect();
    assert_eq!(lines.len(), 3, "{error}");
    // After two lines of comments.
    assert!(
        lines[0].contains("p.yaml:8:21: x: error_reaction is 9")
            && lines[1].contains("p.yaml:9:25: x: in_position_window")
    );
    assert!(lines[2].contains("mend the cell, name another file with --store, or delete this one"), "{error}");
    assert_eq!(config, bench.config);
}
