use super::*;
use crate::cell::Cell;
use crate::scenario::{Options, Scenario, simulate};

/// One expectation that passes, one that fails, one whose step never happens; a command that is refused, one that is
/// refused as expected.
const SCENARIO: &str = "\
scenario: some of each
cycles: 20
steps:
  - {at: 3, do: {move_axis: {axis: x, position: 5 mm}}, refused: NOT_ENABLED}
  - {at: 4, do: {move_axis: {axis: x, position: 5 mm}}}
  - {name: late, when: {signal: x.state, is: HOMING}, do: {halt: {axes: [x]}}, optional: true}
expect:
  - {signal: x.command.position, is: 0 mm}
  - {signal: x.command.position, at: end, is: 7 mm}
  - {signal: x.command.position, since: late, from: 0, to: 1, is: 0 mm}
  - {event: {kind: refused}, count: 2}
";

fn played() -> Played {
    let cell = Cell::demo();
    let scenario =
        Scenario::parse("dir/s.scenario.yaml", SCENARIO, &cell).unwrap_or_else(|problems| panic!("{problems}"));
    let report = simulate(&cell, &scenario, &Options::default()).unwrap();
    let cell = Ok(PathBuf::from("dir/s.yaml"));
    Played::new(Path::new("dir/s.scenario.yaml"), cell, Some("a note".to_owned()), |_| Ok(report))
}

#[test]
fn object_of_a_scenario_has_its_expectations_and_failures() {
    let object = played().json();
    let text = |field: &str| object[field].as_str().unwrap_or_else(|| panic!("{object}"));
    assert_eq!((text("scenario_file"), text("cell_file")), ("dir/s.scenario.yaml", "dir/s.yaml"));
    assert_eq!((text("verdict"), text("name")), ("failed", "some of each"));
    assert_eq!((&object["cycles"], &object["cycle_ns"]), (&json!(20), &json!(1_000_000)));
    assert_eq!((&object["steps"], &object["steps_fired"]), (&json!(3), &json!(2)));
    assert!(object["wall_seconds"].as_f64().is_some_and(|wall| wall > 0.0), "{object}");
    assert_eq!(object["notes"], json!(["a note"]));
    let expectations = object["expectations"].as_array().unwrap();
    let rows: Vec<_> =
        expectations.iter().map(|row| (row["line"].as_u64().unwrap(), row["verdict"].as_str().unwrap())).collect();
    assert_eq!(rows, [(8, "passed"), (9, "failed"), (10, "not_judged"), (11, "passed")]);
    assert_eq!((&expectations[1]["file"], &expectations[1]["column"]), (&json!("dir/s.scenario.yaml"), &json!(5)));
    let message = expectations[1]["message"].as_str().unwrap();
    assert!(message.starts_with("x.command.position is 0 ") && message.ends_with(" was expected"), "{message}");
    assert_eq!(expectations[0]["message"], Json::Null);
    // The second move is refused unexpectedly; the first one is listed separately.
    let lines = |field: &str| {
        object[field].as_array().unwrap().iter().map(|row| row["line"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!((lines("failures"), lines("refused"), lines("not_fired")), (vec![5, 9], vec![4], vec![6]));
    assert_eq!(object["failures"][0]["hint"], Json::Null);
    assert_eq!((&object["problems"], &object["errors"]), (&json!([]), &json!([])));
}

#[test]
fn expectations_are_described_with_their_cycles() {
    let object = played().json();
    let text = |place: usize| object["expectations"][place]["text"].as_str().unwrap();
    assert!(text(0).starts_with("always x.command.position 0 ") && !text(0).contains(','), "{}", text(0));
    assert!(text(1).starts_with("always x.command.position ") && text(1).ends_with(", at the end"), "{}", text(1));
    assert!(text(2).ends_with(", from 0 cycles to 1 cycles, counted from step `late`"), "{}", text(2));
    assert_eq!(text(3), "event kind refused exactly 2 times");
}

#[test]
fn suite_has_a_case_for_each_expectation_and_one_for_the_steps() {
    let suite = played().suite();
    assert_eq!((suite.name.as_str(), suite.class.as_str()), ("dir/s.scenario.yaml", "dir.s"));
    assert_eq!(suite.properties, [("scenario", "some of each".to_owned()), ("cell", "dir/s.yaml".to_owned())]);
    assert_eq!(suite.cases.len(), 5);
    let begins = |place: usize, begin: &str| match &suite.cases[place].outcome {
        Outcome::Failed(text) | Outcome::Skipped(text) => assert!(text.starts_with(begin), "{text}"),
        other => panic!("{other:?}"),
    };
    assert_eq!(suite.cases[0].name, "steps and commands");
    begins(0, "dir/s.scenario.yaml:5:");
    assert_eq!(suite.cases[1].outcome, Outcome::Passed);
    begins(2, "dir/s.scenario.yaml:9:5: x.command.position is 0 ");
    begins(3, "dir/s.scenario.yaml:10:5: the step that it counts from never fired");
    assert!(matches!(suite.cases[3].outcome, Outcome::Skipped(_)));
    assert_eq!(suite.cases[4].outcome, Outcome::Passed);
    let source = |line| Some(Source { file: "dir/s.scenario.yaml".to_owned(), line: Some(line) });
    let sources: Vec<_> = suite.cases.iter().map(|case| case.source.clone()).collect();
    assert_eq!(sources, [5, 8, 9, 10, 11].map(source));
}

#[test]
fn scenario_with_errors_has_its_problems_and_one_case_with_an_error() {
    let problems = Problems::new("c.yaml");
    problems.push(Place { line: 3, col: 8 }, "cycle is 0", Some("write 1 ms".to_owned()));
    let played = Played::new(Path::new("s.scenario.yaml"), Err(problems), None, |_| panic!("there is no cell"));
    let object = played.json();
    assert_eq!(
        (&object["verdict"], &object["cell_file"], &object["cycles"]),
        (&json!("error"), &Json::Null, &Json::Null)
    );
    let problem = json!({"file": "c.yaml", "line": 3, "column": 8, "message": "cycle is 0", "hint": "write 1 ms"});
    assert_eq!(object["problems"], json!([problem]));
    assert_eq!(played.suite().cases[0].outcome, Outcome::Error("c.yaml:3:8: cycle is 0, write 1 ms".to_owned()));
    assert_eq!(played.suite().cases[0].source, Some(Source { file: "c.yaml".to_owned(), line: Some(3) }));
    assert_eq!(played.exit(), Exit::Usage);
}
