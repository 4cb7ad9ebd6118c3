//! Tests missing samples, at the ends and in between, and bags that were cut off.

use super::*;

/// Returns joint_states of a joint at constant velocity, 100 Hz for 8 s, without samples in the time ranges `lacks` (in
/// s).
fn steady(lacks: &[std::ops::Range<f64>]) -> TestBag {
    let mut bag = TestBag::new();
    for sample in 0..=800_u64 {
        let t = sample as f64 / 100.0;
        if !lacks.iter().any(|range| range.contains(&t)) {
            bag.message("/joint_states", sample * 10 * MS, &joints(sample * 10 * MS, &[("x", 0.25 * t)]));
        }
    }
    bag
}

const X: &str = "x.actual.position";

#[test]
fn two_samples_of_a_long_run_do_not_pass() {
    let lack = |end: f64| {
        let mut bag = TestBag::new();
        for t in [0.0, end] {
            let time = (t * 1e3) as u64 * MS;
            bag.message("/joint_states", time, &joints(time, &[("x", 0.25 * t)]));
        }
        bag
    };
    let short = report(lack(3.0), steady(&[]), &["*=1 um"]);
    let gap = "no sample for 3 s from 0 s on";
    assert_eq!(failures(&short, X), ["ends 5 s earlier than expected; 0.02 s is allowed", gap]);
    let whole = report(lack(8.0), steady(&[]), &["*=1 um"]);
    assert_eq!(failures(&whole, X), ["no sample for 8 s from 0 s on"]);
    assert!(report(lack(3.0), steady(&[]), &["*=1 um", "time=5 s"]).passed());
}

#[test]
fn a_gap_is_a_failure_unless_time_allows_it_or_it_is_expected() {
    let tolerance = "*=1 um";
    let run = || steady(&[1.205..6.195]);
    let failed = report(run(), steady(&[]), &[tolerance]);
    assert_eq!(failures(&failed, X), ["no sample for 5 s from 1.2 s on"]);
    assert!(failed.to_string().contains("FAIL: no sample for 5 s from 1.2 s on\n"), "{failed}");
    assert!(report(run(), steady(&[]), &[tolerance, "time=5 s"]).passed());
    assert!(!report(run(), steady(&[]), &[tolerance, "time=4.9 s"]).passed());
    assert!(report(run(), run(), &[tolerance]).passed());
    assert!(report(steady(&[]), run(), &[tolerance]).passed());
    let two = report(steady(&[1.205..2.195, 4.005..4.195]), steady(&[]), &[tolerance]);
    assert_eq!(failures(&two, X), ["no sample for 1 s from 1.2 s on, the longest of 2 gaps"]);
    // A few samples lost in different places are no gap.
    assert!(report(steady(&[1.205..1.235, 3.005..3.015]), steady(&[]), &[tolerance]).passed());
}

#[test]
fn a_gap_of_one_axis_is_seen() {
    let two = |lacks: std::ops::Range<u64>| {
        let mut bag = TestBag::new();
        for sample in 0..100 {
            let axis = |name: &str| AxisState { name: name.to_owned(), ..AxisState::default() };
            let y = Some("y").filter(|_| !lacks.contains(&sample));
            let all = ["x"].into_iter().chain(y).map(axis).collect();
            bag.message("/ls/axis_states", sample * 10 * MS, &axes(sample * 10 * MS, all));
        }
        bag
    };
    let report = report(two(40..60), two(0..0), &[]);
    assert_eq!(failures(&report, "y.state"), ["no sample for 0.21 s from 0.39 s on"]);
    assert!(failures(&report, "x.state").is_empty());
}

#[test]
fn truncated_bag_is_reported() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let bytes = |samples: u64| {
        let mut bag = TestBag::new();
        for sample in 0..samples {
            bag.message("/joint_states", 0, &joints(sample * 10 * MS, &[("x", 0.5)]));
            if sample % 10 == 9 {
                bag.end_chunk();
            }
        }
        bag.finish()
    };
    let whole = bytes(100);
    let chunks = mcap::Summary::read(&whole).unwrap().unwrap().chunk_indexes;
    std::fs::write(path("expected.mcap"), &whole).unwrap();
    let compare = |length: u64| {
        std::fs::write(path("run.mcap"), &whole[..length as usize]).unwrap();
        let open = |name: &str| Run::open(&path(name)).unwrap();
        validate(&mut open("run.mcap"), &mut open("expected.mcap"), &[], Align::Start).unwrap()
    };
    // Within the last chunk, and between two chunks.
    for (length, said) in [
        (chunks[9].chunk_start_offset + 20, "run.mcap: the file ends within a chunk; "),
        (chunks[9].chunk_start_offset, "run.mcap: the file ends without a record of its end; "),
    ] {
        let report = compare(length);
        assert_eq!(failures(&report, X), ["ends 0.1 s earlier than expected; 0.02 s is allowed"]);
        let text = report.to_string();
        let note = text.lines().find(|line| line.starts_with("note: ")).unwrap();
        assert!(note.contains(said), "{note}");
    }
}
