//! Tests values that scenarios store.

use super::*;
use crate::scenario::simulate_with;
use crate::store::Store;
use std::fs;

/// Stores values that are stored already, in cycle 10.
const AGAIN: &str = "steps:\n- {at: 10, do: {save_parameters: {}}}\n";

#[test]
fn a_save_without_a_change_puts_back_what_others_have_spoilt() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.yaml");
    let cell = cell();
    let play = |steps: &str| {
        let scenario = Scenario::parse("s.yaml", &format!("scenario: saves\nfor: 50 ms\n{steps}"), &cell).unwrap();
        let mut cell = cell.clone();
        let store = Store::open(&path).unwrap();
        store.load(&mut cell.machine).unwrap();
        (scenario, cell, store)
    };
    let set =
        "steps:\n- {at: 5, do: {set_parameters: {x.max_velocity: 50 mm/s}}}\n- {at: 10, do: {save_parameters: {}}}\n";
    let (scenario, loaded, store) = play(set);
    assert!(simulate_with(&loaded, &scenario, &Options::default(), Some(store)).unwrap().passed());
    let good = fs::read_to_string(&path).unwrap();
    let body = |text: &str| text.lines().filter(|line| line.contains("max_velocity")).collect::<Vec<_>>().join("\n");
    assert!(body(&good).contains("50000"), "{good}");
    let spoil: [&dyn Fn(); 2] = [&|| fs::write(&path, "garbage").unwrap(), &|| fs::remove_file(&path).unwrap()];
    for spoil in spoil {
        let (scenario, loaded, store) = play(AGAIN);
        spoil();
        assert!(simulate_with(&loaded, &scenario, &Options::default(), Some(store)).unwrap().passed());
        let now = fs::read_to_string(&path).unwrap();
        assert_eq!(body(&now), body(&good), "{now}");
    }
}

#[test]
fn trace_into_a_pipe_without_reader_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pipe");
    rustix::fs::mkfifoat(rustix::fs::CWD, &path, rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR).unwrap();
    let scenario = Scenario::parse("s.yaml", "scenario: s\nfor: 5 ms\ntrace: [x.state]\n", &cell()).unwrap();
    let options = Options { csv: Some(path.clone()), ..Options::default() };
    let error = simulate(&cell(), &scenario, &options).unwrap_err().to_string();
    let expected = format!("cannot write the trace {}: it is a named pipe that nobody reads", path.display());
    assert_eq!(error, expected);
    let (of_reader, opened) = (path.clone(), std::sync::Arc::new(std::sync::Barrier::new(2)));
    let read = std::thread::spawn({
        let opened = std::sync::Arc::clone(&opened);
        move || {
            // With both ends, opening does not block, and the writer finds a reader.
            let both = fs::File::options().read(true).write(true).open(of_reader).unwrap();
            opened.wait();
            let mut text = [0; 64];
            let count = std::io::Read::read(&mut &both, &mut text).unwrap();
            String::from_utf8_lossy(&text[..count]).into_owned()
        }
    });
    opened.wait();
    assert!(simulate(&cell(), &scenario, &options).unwrap().passed());
    assert!(read.join().unwrap().starts_with("cycle,time_s,x.state\n0,"), "a trace that somebody reads is written");
}
