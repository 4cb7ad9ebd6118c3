//! Records and replays whole runs.

use super::*;
use crate::recording::Topic;
use crate::recording::bag::BagOptions;
use crate::recording::test_bags::TestBag;
use crate::scenario::{Options, Scenario, simulate};
use lineshaft_core::parameter::MachineParameters;
use lineshaft_msgs::cdr;
use lineshaft_msgs::msg::{AppliedCommand, Event, Signals};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Pseudorandom numbers that are the same in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

/// Returns a scenario for the demo cell with goals, stops, couplings, parameters and faults at random times.
fn random_scenario(seconds: u64, seed: u64) -> String {
    let mut numbers = Numbers(seed);
    let mut text = format!("scenario: anything\nfor: {seconds} s\nsteps:\n  - {{at: 0, do: {{enable: {{}}}}}}\n");
    let mut cycle = 100;
    while cycle < seconds * 1000 - 1 {
        let axis = ["line", "x", "y", "turret"][numbers.below(4) as usize];
        let millimetres = numbers.below(800);
        let verb = match numbers.below(16) {
            0..=5 => {
                format!("move_axis: {{axis: {axis}, mode: relative, units: axis_unit, position: {millimetres}.25}}")
            }
            6 => format!("move_axis: {{axis: {axis}, units: axis_unit, position: -{millimetres}.125}}"),
            7 => format!("move_axis: {{axis: {axis}, mode: velocity, velocity: 0.0{millimetres}}}"),
            8 | 9 => format!(
                "synchronize: {{axis: {axis}, master: line, mode: position, numerator: {millimetres}, denominator: 113}}"
            ),
            10 => format!("halt: {{axes: [{axis}]}}"),
            11 => format!("quick_stop: {{axes: [{axis}]}}"),
            12 => "reset_errors: {}".to_owned(),
            13 => format!("set_parameters: {{{axis}.max_velocity: {}}}", 1 + numbers.below(3)),
            14 if numbers.below(2) == 0 => {
                format!("setpoints: {{axes: {{{axis}: 0.0{millimetres}}}, duration: 70 ms}}")
            }
            14 => "inject: {fault: {axis: x, code: 4660}}".to_owned(),
            _ => "inject: {encoder_jump: {axis: y, by: 77 inc}}".to_owned(),
        };
        // It may be refused; the next line enables the axes again.
        writeln!(text, "  - {{at: {cycle}, do: {{{verb}}}}}").unwrap();
        writeln!(text, "  - {{at: {}, do: [{{reset_errors: {{}}}}, {{enable: {{}}}}]}}", cycle + 1).unwrap();
        cycle += 2 + numbers.below(600);
    }
    text
}

/// Records a scenario on the demo cell.
fn record(text: &str, path: &Path, max_duration_ns: Option<u64>) {
    let cell = Cell::demo();
    let scenario = Scenario::parse("random.yaml", text, &cell).unwrap();
    let record = Some(BagOptions { path: path.to_owned(), max_size: None, max_duration_ns });
    simulate(&cell, &scenario, &Options { record, ..Options::default() }).unwrap();
}

fn replayed(path: &Path) -> Report {
    replay(&mut Run::open(path).unwrap()).unwrap()
}

fn long() -> bool {
    std::env::var_os("LINESHAFT_LONG").is_some()
}

#[test]
fn minutes_of_random_goals_replay_without_difference() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let seconds = if long() { 600 } else { 60 };
    record(&random_scenario(seconds, 7), &path, None);
    let report = replayed(&path);
    assert_eq!(report.verdict, Verdict::Same, "{report}");
    assert_eq!((report.first, report.cycles), (0, seconds * 1000));
    assert!(report.notes.is_empty(), "{report}");
    assert!(report.values > 100 * report.cycles, "{report}");
    assert!(report.messages > report.cycles / 5, "{report}");
}

#[test]
fn a_split_bag_replays_as_a_whole_and_from_each_of_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag");
    record(&random_scenario(12, 11), &path, Some(3_000_000_000));
    assert_eq!(replayed(&path).cycles, 12_000);
    let mut files: Vec<PathBuf> = std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "mcap"));
    files.sort();
    assert_eq!(files.len(), 4);
    for (place, file) in (0..).zip(&files) {
        let report = replayed(file);
        assert_eq!(report.verdict, Verdict::Same, "{report}");
        assert_eq!((report.first, report.cycles), (place * 3000, 3000));
        let goes_on = report.notes.iter().any(|note| note.ends_with("goes on in a further file, which was not read"));
        assert_eq!(goes_on, place < 3, "{report}");
    }
}

/// Replays a recording after each cycle was changed by `edit`.
fn edited(path: &Path, mut edit: impl FnMut(&mut Group, u64)) -> Result<Option<Verdict>, ReplayError> {
    let mut player = Player::new(Cell::demo(), None, true, 0);
    let mut run = Run::open(path).unwrap();
    let mut group = Group::default();
    while let Some(message) = run.next_message().unwrap() {
        if !group.is_of(message.log_time) {
            let cycle = group.inputs.as_ref().unwrap().message.cycle;
            edit(&mut group, cycle);
            let verdict = player.play(&group, true)?;
            if verdict.is_some() {
                return Ok(verdict);
            }
            group.clear();
        }
        group.add(&message).unwrap();
    }
    Ok(None)
}

fn recorded(folder: &tempfile::TempDir) -> PathBuf {
    let path = folder.path().join("run.mcap");
    record(&random_scenario(3, 3), &path, None);
    path
}

#[test]
fn another_input_is_found_in_its_cycle_by_the_first_signal_that_differs() {
    let folder = tempfile::tempdir().unwrap();
    let verdict = edited(&recorded(&folder), |group, cycle| {
        if cycle == 1234 {
            group.inputs.as_mut().unwrap().message.drive_count[0] ^= 1 << 4;
        }
    });
    let Some(Verdict::Differs(difference)) = verdict.unwrap() else { panic!("no difference: nothing") };
    assert_eq!((difference.cycle, difference.what.as_str()), (1234, "x.actual.count"));
    let (recorded, replayed): (i64, i64) = (difference.recorded.parse().unwrap(), difference.replayed.parse().unwrap());
    assert_eq!((recorded - replayed).abs(), 16);
}

/// A manufacturer-specific bit of the status word (CiA 402) has no effect on the axis, but its change must be found.
#[test]
fn an_input_without_effect_is_found_by_its_checksum() {
    let folder = tempfile::tempdir().unwrap();
    let verdict = edited(&recorded(&folder), |group, cycle| {
        if cycle == 777 {
            let inputs = group.inputs.as_mut().unwrap();
            inputs.message.drive_status[0] ^= 1 << 14;
            inputs.crc = crc32fast::hash(&cdr::encode_with_header(&inputs.message));
        }
    });
    let Some(Verdict::Differs(difference)) = verdict.unwrap() else { panic!("no difference") };
    assert_eq!((difference.cycle, difference.what.as_str()), (777, "inputs"));
    assert!(difference.recorded.starts_with("CRC-32 ") && difference.recorded != difference.replayed);
}

#[test]
fn what_a_recording_of_ours_lacks_is_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(&folder);
    assert_eq!(edited(&path, |_, _| {}).unwrap(), None);
    for (topic, what) in [
        (Topic::Events, "lineshaft_msgs/msg/Event"),
        (Topic::Signals, "lineshaft_msgs/msg/Signals"),
        (Topic::AxisStates, "lineshaft_msgs/msg/AxisStates"),
        (Topic::JointStates, "sensor_msgs/msg/JointState"),
    ] {
        let verdict = edited(&path, |group, _| group.others.retain(|(of, _)| *of != topic)).unwrap();
        let Some(Verdict::Differs(difference)) = verdict else { panic!("{what} is not missed") };
        assert_eq!((difference.cycle, difference.what.as_str()), (0, what));
        assert!(difference.recorded.starts_with("0 message"), "{difference:?}");
    }
    let mut all = 0;
    let only_changes = edited(&path, |group, cycle| {
        if cycle == 0 {
            let (_, data) = group.others.iter_mut().find(|(topic, _)| *topic == Topic::Signals).unwrap();
            let mut signals: Signals = cdr::decode_with_header(data).unwrap();
            all = signals.index.len();
            signals.index.pop();
            signals.word.pop();
            *data = cdr::encode_with_header(&signals);
        }
    });
    let sentence = only_changes.unwrap_err().to_string();
    let expected = format!("holds {} of {all} signals; all of them are needed", all - 1);
    assert!(sentence.ends_with(&expected), "{sentence}");
}

/// Another version may have other texts of events; the code identifies the event.
#[test]
fn text_of_an_event_is_not_compared_and_its_code_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(&folder);
    let mut count = 0;
    let mut changed = |edit: fn(&mut Event)| {
        edited(&path, |group, _| {
            for (_, data) in group.others.iter_mut().filter(|(topic, _)| *topic == Topic::Events) {
                let mut event: Event = cdr::decode_with_header(data).unwrap();
                edit(&mut event);
                *data = cdr::encode_with_header(&event);
                count += 1;
            }
        })
        .unwrap()
    };
    assert_eq!(changed(|event| event.text.insert_str(0, "in other words: ")), None);
    let Some(Verdict::Differs(difference)) = changed(|event| event.code += 1) else { panic!("no difference") };
    assert!(difference.what.ends_with("Event.code"), "{difference:?}");
    assert!(count > 12, "{count} events");
}

#[test]
fn messages_that_are_not_cdr_are_left_out_or_refused() {
    let replayed = |kind: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let mut bag = TestBag::new();
        bag.attach("cell.yaml", Cell::demo().text.as_bytes());
        bag.raw("/other", kind, "json", 5, b"{}");
        std::fs::write(&path, bag.finish()).unwrap();
        replay(&mut Run::open(&path).unwrap()).unwrap_err().to_string()
    };
    assert!(replayed("foxglove.Pose").starts_with("there is no message of type lineshaft_msgs/msg/CycleInputs"));
    for kind in ["lineshaft_msgs/msg/CycleInputs", "lineshaft_msgs/msg/Signals", "lineshaft_msgs/msg/AppliedCommand"] {
        let said = replayed(kind);
        let sentence = "/other: the message recorded at 5 ns cannot be read: it is encoded as `json`; only cdr is read";
        assert_eq!(said, sentence, "{kind}");
    }
}

/// Setpoints are no commands with an answer, but they are inputs of a cycle too: the replay differs if one is missing.
#[test]
fn setpoints_replay_and_a_missing_one_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let steps = "- {at: 0, do: {enable: {}}}\n- {at: 1000, every: 50 ms, count: 60, do: {setpoints: {axes: {x: 20 mm/s}}}}\n\
        - {at: 1010, every: 30 ms, count: 20, do: {setpoints: {axes: {y: -10 mm/s, turret: 0.1}, duration: 20 ms}}}\n\
        expect:\n- {signal: x.command.velocity, at: 1500, is: 20 mm/s}\n- {event: {kind: warning, source: x}, from: 3950, to: 4060, count: 1}\n";
    // Files of 2 s: one begins during the stream of x.
    record(&format!("scenario: streams\nfor: 5 s\nsteps:\n{steps}"), &path, Some(2_000_000_000));
    let report = replayed(&path);
    assert_eq!((report.verdict, report.cycles), (Verdict::Same, 5000));
    let mut run = Run::open(&path).unwrap();
    let mut streamed = Vec::new();
    while let Some(message) = run.next_message().unwrap() {
        if message.topic.ends_with("/commands") {
            let applied: AppliedCommand = cdr::decode_with_header(message.data).unwrap();
            if applied.command.starts_with("{\"setpoints\"") {
                assert_eq!((applied.sequence, applied.source.as_str()), (0, "scenario"));
                streamed.push((applied.cycle, applied.command));
            }
        }
    }
    // In the four cycles from 1100 on in which both steps stream, one message has all axes.
    assert_eq!(streamed.len(), 60 + 20 - 4, "{streamed:?}");
    let both = &streamed.iter().find(|(cycle, _)| *cycle == 1100).unwrap().1;
    assert!(
        both.contains("\"x\":\"") && both.contains("\"y\":{\"velocity\":\"-") && both.contains("duration"),
        "{both}"
    );
    let without = edited(&path, |group, cycle| {
        if cycle == 1000 {
            group.commands.clear();
        }
    });
    let Some(Verdict::Differs(difference)) = without.unwrap() else { panic!("it is not missed") };
    assert_eq!(difference.cycle, 1000);
}

/// Stored parameters of the machine are in force in the replay as in the run, and are in parameters.yaml.
#[test]
fn saved_parameters_of_the_machine_are_there_in_a_replay() {
    let text = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io: {alarm: {type: do, backend: plant, address: 0}, lamp: {type: do, backend: plant, address: 1}}
machine: {o_error: 1}
axes:
  x: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0, interface: position},
      max_velocity: 1 m/s, max_acceleration: 1 m/s^2, sim: {model: ideal}}
";
    let mut cell = Cell::parse("cell.yaml", text).unwrap();
    cell.machine.global.saved = Some(MachineParameters { o_error: 2, ..cell.machine.global.parameters });
    let scenario = "{scenario: s, for: 2500 ms, steps: [{at: 0, do: {enable: {}}}, {at: 100, do: {inject: {fault: {axis: x, code: 1}}}},
                    {at: 1.2 s, do: {set_parameters: {machine.o_error: -1}}}],
                    expect: [{signal: lamp, at: 1 s, is: 1}, {signal: alarm, at: 1 s, is: 0}]}";
    let scenario = Scenario::parse("s", scenario, &cell).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag");
    let record = Some(BagOptions { path: path.clone(), max_size: None, max_duration_ns: Some(1_000_000_000) });
    let report = simulate(&cell, &scenario, &Options { record, ..Options::default() }).unwrap();
    assert!(report.passed(), "{report}");
    let run = Run::open(&path).unwrap();
    for (file, line) in [(0, "machine.o_error: 2"), (1, "machine.o_error: 2"), (2, "machine.o_error: -1")] {
        let text = String::from_utf8(run.attachment_of(file, "parameters.yaml").unwrap().unwrap()).unwrap();
        assert!(text.lines().any(|found| found == line), "{file}: {text}");
    }
    assert_eq!(replayed(&path).verdict, Verdict::Same);
    for file in ["bag_0.mcap", "bag_1.mcap", "bag_2.mcap"] {
        assert_eq!(replayed(&path.join(file)).verdict, Verdict::Same, "{file}");
    }
}
