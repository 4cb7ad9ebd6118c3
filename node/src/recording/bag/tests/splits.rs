//! Tests bags of several files.

use super::*;

fn names(summary: &Summary) -> Vec<String> {
    summary.files.iter().map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect()
}

#[test]
fn each_file_begins_at_a_key_cycle_and_replays_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a b: c");
    let options = BagOptions { max_duration_ns: Some(1_500_000_000), ..at(path.clone()) };
    let mut bag = Bag::create(&options, subject()).unwrap();
    for encoded in &run().encoded {
        bag.write(encoded).unwrap();
    }
    let summary = bag.finish().unwrap();
    assert_eq!(names(&summary), ["a b: c_0.mcap", "a b: c_1.mcap"]);
    assert_eq!((summary.cycles, summary.replayable), (3500, true));
    assert_eq!(summary.size, summary.files.iter().map(|path| fs::metadata(path).unwrap().len()).sum::<u64>());
    let files: Vec<Found> = summary.files.iter().map(|path| find(&fs::read(path).unwrap())).collect();
    assert_eq!(files[0].messages, messages(&run().encoded[..2000]));
    assert_eq!(files[1].messages, messages(&run().encoded[2000..]));
    assert!(!files[0].attachments.contains_key("machine_state"));
    assert_eq!(files[1].attachments["machine_state"], b"state before 2000");
    assert_eq!(files[1].attachments["parameters.yaml"], b"parameters before 2000");
    assert_eq!(files[1].attachments["cell.yaml"], files[0].attachments["cell.yaml"]);
    assert_eq!(files[1].records["lineshaft"], files[0].records["lineshaft"]);
    let continued: Vec<&str> = files.iter().map(|file| &*file.records["lineshaft_end"]["continued"]).collect();
    assert_eq!(continued, ["true", "false"]);
    let signals = files[1].messages.iter().find(|(topic, _, _)| topic == "/lineshaft/signals").unwrap();
    let all = run().encoded[0].messages().find(|(topic, _)| *topic == Topic::Signals).unwrap();
    assert_eq!(
        decode_with_header::<Signals>(&signals.2).unwrap().index,
        decode_with_header::<Signals>(all.1).unwrap().index
    );

    let text = fs::read_to_string(path.join(FILE_NAME)).unwrap();
    assert!(text.contains("  relative_file_paths:\n    - \"a b: c_0.mcap\"\n    - \"a b: c_1.mcap\"\n"), "{text}");
    let counts = files.iter().map(|file| file.messages.len()).collect::<Vec<_>>();
    for count in [counts[0], counts[1], counts[0] + counts[1]] {
        assert!(text.contains(&format!("message_count: {count}\n")), "{count} in {text}");
    }
}

#[test]
fn files_end_at_their_size() {
    let folder = tempfile::tempdir().unwrap();
    let one = write(&at(folder.path().join("one")), &run().encoded).size;
    let options = BagOptions { max_size: Some(one / 3), ..at(folder.path().join("some")) };
    let summary = write(&options, &run().encoded);
    assert_eq!(summary.files.len(), 2, "{one} bytes in one file");
    let options = BagOptions { max_size: Some(0), ..at(folder.path().join("many")) };
    let summary = write(&options, &run().encoded);
    assert_eq!(summary.files.len(), 4, "one for each key cycle");
    let options = BagOptions { max_size: Some(one), ..at(folder.path().join("again")) };
    assert_eq!(write(&options, &run().encoded).files.len(), 1);
}

#[test]
fn a_key_cycle_without_its_state_begins_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let options = BagOptions { max_duration_ns: Some(1), ..at(folder.path().join("run")) };
    let mut cycles = run().encoded.clone();
    cycles[1000].state = None;
    let summary = write(&options, &cycles);
    assert_eq!(names(&summary), ["run_0.mcap", "run_1.mcap", "run_2.mcap"]);
    assert_eq!(find(&fs::read(&summary.files[1]).unwrap()).messages, messages(&cycles[2000..3000]));
}

#[test]
fn what_is_missing_in_one_file_does_not_count_in_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let options = BagOptions { max_duration_ns: Some(1), ..at(folder.path().join("run")) };
    let mut bag = Bag::create(&options, subject()).unwrap();
    run().encoded.iter().filter(|encoded| encoded.cycle != 1500).for_each(|encoded| bag.write(encoded).unwrap());
    let summary = bag.finish().unwrap();
    assert_eq!((summary.lost, summary.replayable), (1, false));
    let lost = summary.files.iter().map(|path| find(&fs::read(path).unwrap()).records["lineshaft_end"]["lost"].clone());
    assert_eq!(lost.collect::<Vec<_>>(), ["0", "1", "0", "0"]);
}
