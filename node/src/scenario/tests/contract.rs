//! Tests the example in docs/contract.md.

use super::*;

/// Returns the code block with this number in docs/contract.md.
fn block(number: usize) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/contract.md");
    let contract = std::fs::read_to_string(path).unwrap();
    let block = contract.split("```yaml\n").nth(number).expect("the contract has that example");
    block.split("```").next().unwrap().to_owned()
}

/// Returns the cell in docs/contract.md.
fn example_cell() -> Cell {
    Cell::parse("cell.yaml", block(1)).unwrap_or_else(|problems| panic!("{problems}"))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("start.csv"), "cycle,start\n0,1\n1,0\n2,0\n").unwrap();
    folder
}

fn load(folder: &tempfile::TempDir, text: &str) -> Result<Scenario, String> {
    let path = folder.path().join("example.yaml");
    std::fs::write(&path, text).unwrap();
    let found = Scenario::load(&path, &example_cell());
    found.map_err(|problems| problems.to_string().replace(&path.display().to_string(), "example.yaml"))
}

#[test]
fn example_has_the_documented_results_and_refusals() {
    let folder = folder();
    let scenario = load(&folder, &block(2)).unwrap();
    assert!(scenario.needs_simulation().unwrap().ends_with(":5:5: drive needs a simulated plant, run with --sim"));
    let report = simulate(&example_cell(), &scenario, &Options::default()).unwrap();
    assert!(recorded::plays_the_same_as_json(&example_cell(), &scenario) > 3);
    assert!(report.failures.is_empty(), "{report}");
    assert_eq!(report.refused.len(), 1);
    assert!(report.refused[0].sentence.contains("target 900 mm exceeds max_position 850 mm"), "{report}");
}
