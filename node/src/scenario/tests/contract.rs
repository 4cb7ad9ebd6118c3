//! The example of the contract.

use super::*;

/// The block of the contract that holds an example, by its number.
fn block(number: usize) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/contract.md");
    let contract = std::fs::read_to_string(path).unwrap();
    let block = contract.split("```yaml\n").nth(number).expect("the contract has that example");
    block.split("```").next().unwrap().to_owned()
}

/// The cell of the contract without what does not exist yet: functions.
fn example_cell() -> Cell {
    let text = block(1);
    let functions = text.find("functions:").unwrap();
    let groups = text.find("groups:").unwrap();
    let text = format!("{}{}", &text[..functions], &text[groups..]);
    Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("start.csv"), "cycle,start\n0,1\n1,0\n2,1\n").unwrap();
    folder
}

fn load(folder: &tempfile::TempDir, text: &str) -> Result<Scenario, String> {
    let path = folder.path().join("example.yaml");
    std::fs::write(&path, text).unwrap();
    let found = Scenario::load(&path, &example_cell());
    found.map_err(|problems| problems.to_string().replace(&path.display().to_string(), "example.yaml"))
}

#[test]
fn the_example_is_refused_for_command_function_only() {
    let folder = folder();
    let problems = load(&folder, &block(2)).unwrap_err();
    assert_eq!(problems, "example.yaml:10:21: verb command_function does not exist yet\n");
}

#[test]
fn without_the_function_the_example_runs_and_fails_only_for_the_function() {
    let folder = folder();
    let text = block(2);
    let text = text.lines().filter(|line| !line.contains("command_function")).collect::<Vec<_>>().join("\n");
    let scenario = load(&folder, &text).unwrap();
    assert!(scenario.needs_simulation().unwrap().ends_with(":5:5: drive needs a simulated plant, run with --sim"));
    let report = simulate(&example_cell(), &scenario, &Options::default()).unwrap();
    assert!(recorded::plays_the_same_as_json(&example_cell(), &scenario) > 3);
    let failures: Vec<_> = report.failures.iter().map(|failure| failure.sentence.as_str()).collect();
    let expected = "turret.command.position is 0 inc (0 deg) in cycle 101 (0.101 s); 3 inc (0.03 deg) was expected, value 2 of \
                    3; 2 of 3 values differ";
    assert_eq!(failures, [expected]);
    assert_eq!(report.refused.len(), 1);
    assert!(report.refused[0].sentence.contains("target 900 mm lies above max_position 850 mm"), "{report}");
}
