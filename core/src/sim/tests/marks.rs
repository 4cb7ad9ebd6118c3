//! Printed marks, and the inputs that detect them.

use super::*;
use crate::config::{EncoderConfig, IoConfig};
use crate::drive::EncoderInput;
use crate::encoder::{Form, PulseCheck};
use crate::position::Position;
use crate::unit::Scale;
use proptest::prelude::*;

/// Every 100 inc from 50 on, 10 long.
fn plain() -> Marks {
    Marks { every: Position::whole(100), first: Position::whole(50), width: Position::whole(10), ..Marks::default() }
}

/// Returns the edges between two positions, each with the fraction of the travel that is left.
fn edges(marks: &Marks, from: i64, to: i64) -> Vec<(f64, Edge)> {
    let mut edges = vec![];
    marks.pass(from, to, |left, edge| edges.push((left, edge)));
    edges
}

/// Returns the beginnings of marks in positive direction (inc), passed in pieces.
fn begins(marks: &Marks, from: i64, to: i64) -> Vec<f64> {
    let mut places = vec![];
    for from in (from..to).step_by(4_000) {
        let to = to.min(from + 4_000);
        let rising = edges(marks, from, to).into_iter().filter(|(_, edge)| *edge == Edge::Rising);
        places.extend(rising.map(|(left, _)| to as f64 - left * (to - from) as f64));
    }
    places
}

#[test]
fn a_mark_rises_at_its_first_edge_either_way() {
    use Edge::{Falling, Rising};
    let up = [(0.75, Rising), (0.7, Falling), (0.25, Rising), (0.2, Falling)];
    let down = [(0.8, Rising), (0.75, Falling), (0.3, Rising), (0.25, Falling)];
    assert_eq!((edges(&plain(), 0, 200), edges(&plain(), 200, 0)), (up.to_vec(), down.to_vec()));
    // It is detected at its beginning, but not at its end.
    assert_eq!([49, 50, 59, 60].map(|place| plain().is_detected(place)), [false, true, true, false]);
    assert_eq!(edges(&plain(), 40, 50), [(0.0, Rising)]);
    assert_eq!(edges(&plain(), 50, 60), [(0.0, Falling)]);
    assert_eq!(edges(&plain(), 60, 50), [(1.0, Rising)]);
    assert_eq!(edges(&plain(), 50, 49), [(1.0, Falling)]);
    assert_eq!((edges(&plain(), 7, 7), edges(&plain(), 61, 149)), (vec![], vec![]));
    // Without a width there is an edge, and no level.
    let thin = Marks { width: Position::ZERO, ..plain() };
    assert_eq!((edges(&thin, 0, 100), edges(&thin, 100, 0)), (vec![(0.5, Rising)], vec![(0.5, Rising)]));
    assert!(!thin.is_detected(50));
}

/// A distance of 1000 inc that stretches by 10 % and back, in four marks: 1100, 1000, 900, 1000.
#[test]
fn a_web_stretches_and_comes_back() {
    let stretch = Some(Stretch { share: 0.1, period: 4 });
    let marks =
        Marks { every: Position::whole(1_000), width: Position::ZERO, first: Position::ZERO, stretch, ..plain() };
    let expected = [-2_900.0, -1_900.0, -1_000.0, 0.0, 1_100.0, 2_100.0, 3_000.0, 4_000.0, 5_100.0];
    let places = begins(&marks, -3_500, 5_500);
    assert!(places.iter().zip(expected).all(|(place, expected)| (place - expected).abs() < 1e-6), "{places:?}");
    assert_eq!(places.len(), expected.len());
    // Halfway between two marks at a distance of 1100.
    let doubled = Marks { extra: 1.0, ..marks };
    let places = begins(&doubled, 1, 1_200);
    assert!(places.len() == 2 && (places[0] - 550.0).abs() < 1e-6 && (places[1] - 1_100.0).abs() < 1e-6, "{places:?}");
    assert_eq!(begins(&Marks { missing_share: 1.0, ..marks }, -3_500, 5_500), []);
}

/// Of 100,000 marks 2 % are missing and 1 % are followed by an extra one, within four standard deviations (177 and
/// 126); the jitter is uniform.
#[test]
fn shares_of_lost_and_extra_marks_are_as_configured() {
    let marks = Marks {
        missing_share: 0.02,
        extra: 0.01,
        jitter: Position::whole(5),
        width: Position::ZERO,
        seed: 7,
        ..plain()
    };
    let places = begins(&marks, -5_000_000, 5_000_000);
    let beside = |place: &f64| (place - 50.0 + 25.0).rem_euclid(100.0) - 25.0;
    let (own, extra): (Vec<_>, Vec<_>) = places.iter().map(beside).partition(|beside| *beside < 25.0);
    assert!((own.len() as i64 - 98_000).abs() < 177 && (extra.len() as i64 - 1_000).abs() < 126, "{}", own.len());
    assert!(extra.iter().all(|beside| *beside == 50.0) && own.iter().all(|beside| (-5.0..5.0).contains(beside)));
    let mean = own.iter().sum::<f64>() / own.len() as f64;
    let square = own.iter().map(|beside| beside * beside).sum::<f64>() / own.len() as f64;
    // Uniform distribution: 5^2 / 3.
    assert!(mean.abs() < 0.04 && (square - 25.0 / 3.0).abs() < 0.1, "{mean} {square}");
    assert_eq!(places, begins(&marks, -5_000_000, 5_000_000));
    assert_ne!(places, begins(&Marks { seed: 8, ..marks }, -5_000_000, 5_000_000));
}

#[test]
fn marks_that_could_overlap_are_not_sound() {
    let stretch = |share, period| Some(Stretch { share, period });
    for (marks, is_sound) in [
        (plain(), true),
        (Marks { width: Position::whole(50), ..plain() }, false),
        (Marks { jitter: Position::whole(39), ..plain() }, true),
        (Marks { jitter: Position::whole(40), ..plain() }, false),
        (Marks { stretch: stretch(0.79, 2), ..plain() }, true),
        (Marks { stretch: stretch(0.8, 2), ..plain() }, false),
        (Marks { stretch: stretch(0.1, 1), ..plain() }, false),
        (Marks { width: Position::whole(-1), ..plain() }, false),
        (Marks { jitter: Position::whole(-1), ..plain() }, false),
        (Marks { missing_share: 1.01, ..plain() }, false),
        (Marks { extra: f64::NAN, ..plain() }, false),
        (Marks { every: Position::ZERO, width: Position::ZERO, ..plain() }, false),
    ] {
        assert_eq!(marks.is_sound(), is_sound, "{marks:?}");
    }
}

/// A free encoder with marks for the second of two inputs, of which only that one latches.
fn plant(marks: Marks) -> Plant {
    let input = |name: &str, latch| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch };
    let belt =
        EncoderConfig { name: "belt".into(), form: Form::Incremental(32), check: None, scale: Scale::increments() };
    let io = vec![input("gate", false), input("product", true)];
    let config = MachineConfig { cycle_ns: MS, io, encoders: vec![belt], ..MachineConfig::default() };
    let mut plant = Plant::new(&config, &[]);
    assert!(!plant.print(0, Carrier::Encoder(0), marks), "it latches nothing");
    assert!(!plant.print(2, Carrier::Encoder(0), marks), "there is none");
    assert!(!plant.print(1, Carrier::Encoder(0), Marks { missing_share: 2.0, ..marks }));
    assert!(plant.print(1, Carrier::Encoder(0), marks));
    plant
}

fn read(plant: &mut Plant) -> Inputs {
    let latch = Vec::with_capacity(MAX_LATCHES);
    let mut inputs = Inputs { digital: vec![0], encoder: vec![EncoderInput::default()], latch, ..Inputs::default() };
    plant.read(&mut inputs);
    inputs
}

/// Proves: MACS-MARK-05
#[test]
fn input_latches_passing_marks() {
    let mut plant = plant(plain());
    let seen = |plant: &mut Plant, by: i64| {
        plant.jump_encoder(0, by);
        let inputs = read(plant);
        assert!(inputs.latch.iter().all(|latch| latch.object == Object::Io(1) && latch.position.is_none()));
        let latches: Vec<_> = inputs.latch.iter().map(|latch| (latch.edge, latch.age_ns)).collect();
        (latches, inputs.digital(1))
    };
    use Edge::{Falling, Rising};
    let mut see = |by| seen(&mut plant, by);
    // The level at the start is no edge.
    assert_eq!(see(55), (vec![], true));
    assert_eq!(see(0), (vec![], true));
    assert_eq!(see(15), (vec![(Falling, Some(666_667))], false));
    // 120 inc in the cycle: 150 comes after 80, 160 after 90.
    assert_eq!(see(120), (vec![(Rising, Some(333_333)), (Falling, Some(250_000))], false));
    assert_eq!(see(-30), (vec![], false));
    // From 160: an age is below a cycle.
    assert_eq!(see(-5), (vec![(Rising, Some(999_999))], true));
    // A slip of the encoder does not move the web.
    plant.slip_encoder(0, 1_000);
    let inputs = read(&mut plant);
    assert_eq!((inputs.encoder[0].count, inputs.latch.len(), inputs.digital(1)), (1_155, 0, true));
    // An input that is stuck detects no more marks.
    plant.set_digital(1, false);
    plant.jump_encoder(0, 1_000);
    let inputs = read(&mut plant);
    assert_eq!((inputs.latch.len(), inputs.digital(1)), (0, false));
}

/// Ten marks with two edges: 16 are reported, 4 counted.
#[test]
fn more_than_fit_are_counted() {
    let mut plant = plant(plain());
    read(&mut plant);
    plant.jump_encoder(0, 1_000);
    let inputs = read(&mut plant);
    assert_eq!((inputs.latch.len(), inputs.latches_lost), (16, 4));
    // At most the marks that an input can report are evaluated, for any travel.
    plant.jump_encoder(0, i64::MAX - 1_000);
    assert_eq!(read(&mut plant).latches_lost, 2 * 4_096 - 16);
}

#[test]
fn bus_that_is_off_reports_no_marks() {
    let mut plant = plant(plain());
    read(&mut plant);
    assert!(plant.switch_off_bus(0));
    plant.jump_encoder(0, 155);
    let inputs = read(&mut plant);
    assert_eq!((inputs.latch.len(), inputs.latches_lost, inputs.digital(1)), (0, 0, false));
}

/// A drive has marks relative to its start position.
#[test]
fn a_drive_carries_marks_by_its_place() {
    let mut drive = switched_on(Model::Ideal, 0);
    drive.read();
    drive.install_fixtures(Fixtures { start: 40, ..Fixtures::default() });
    let io = vec![IoConfig { name: "label".into(), kind: IoKind::DigitalInput, latch: true }];
    let mut plant = Plant::new(&MachineConfig { cycle_ns: MS, io, ..MachineConfig::default() }, &[]);
    plant.drives.push(Some(drive));
    assert!(plant.print(0, Carrier::Drive(0), plain()));
    assert_eq!(read(&mut plant).latch, []);
    plant.drives[0].as_mut().unwrap().write(output(20, control::ENABLE));
    plant.drives[0].as_mut().unwrap().read();
    let inputs = read(&mut plant);
    // From 40 to 60: the end of the mark is reached.
    let told: Vec<_> = inputs.latch.iter().map(|latch| (latch.edge, latch.age_ns)).collect();
    assert_eq!(told, [(Edge::Rising, Some(500_000)), (Edge::Falling, Some(0))]);
    assert!(!inputs.digital(0));
}

/// 16 bits, an index each 100 inc, marks from 50 on: counts of a scenario define the travel past them, also across the
/// wrap.
#[test]
fn index_and_marks_follow_the_counts_that_a_scenario_gives() {
    use Edge::{Falling, Rising};
    let check = Some(PulseCheck { every: 100, tolerance: 0 });
    let belt = EncoderConfig { name: "belt".into(), form: Form::Incremental(16), check, scale: Scale::increments() };
    let io = vec![IoConfig { name: "label".into(), kind: IoKind::DigitalInput, latch: true }];
    let config = MachineConfig { cycle_ns: MS, io, encoders: vec![belt], ..MachineConfig::default() };
    let mut plant = Plant::new(&config, &[]);
    assert!(plant.print(0, Carrier::Encoder(0), plain()));
    let mut see = |given: Option<i64>, turned: i64| {
        if let Some(raw) = given {
            plant.replace_encoder_count(0, raw);
        }
        plant.jump_encoder(0, turned);
        let inputs = read(&mut plant);
        let latches: Vec<_> = inputs.latch.iter().map(|latch| (latch.edge, latch.age_ns)).collect();
        (inputs.encoder[0].index, latches, inputs.digital(0))
    };
    // The first count passes nothing.
    assert_eq!(see(Some(55), 0), (None, vec![], true));
    assert_eq!(see(Some(40), 0), (None, vec![(Falling, Some(666_667))], false));
    assert_eq!(see(Some(60), 0), (None, vec![(Rising, Some(500_000)), (Falling, Some(0))], false));
    assert_eq!(see(Some(120), 0), (Some(100), vec![], false));
    // 65526 is -10 in 16 bits: 130 inc back, past 60 and 50, and past the index at 100 and at 0.
    assert_eq!(see(Some(65_526), 0), (Some(0), vec![(Rising, Some(538_462)), (Falling, Some(461_538))], false));
    // The change back to its own count, 0, is no motion. Then the encoder is turned.
    assert_eq!(see(None, 0), (None, vec![], false));
    assert_eq!(see(None, 55), (None, vec![(Rising, Some(90_909))], true));
}

/// An axis that starts at 40 has its index at count 90.
#[test]
fn the_index_of_a_drive_follows_the_counts_that_a_scenario_gives() {
    let mut drive = switched_on(Model::Ideal, 0);
    drive.read();
    drive.install_fixtures(Fixtures { start: 40, index: Some(Index { every: 100, at: 30 }), ..Fixtures::default() });
    let mut see = |given: Option<i64>, slip: i64| {
        if let Some(raw) = given {
            drive.replace_count(raw);
        }
        drive.jump(slip);
        (drive.read().index, drive.place())
    };
    assert_eq!(see(Some(80), 0), (None, 120));
    assert_eq!(see(Some(100), 0), (Some(90), 140));
    assert_eq!(see(Some(100), 0), (None, 140));
    assert_eq!(see(Some(85), 0), (Some(90), 125));
    // A slip of its own counts moves neither the given ones nor the axis.
    assert_eq!(see(Some(85), 7), (None, 125));
    assert_eq!(see(Some(100), 0), (Some(90), 140));
    assert_eq!(see(None, 0), (None, 40));
}

fn any_marks() -> impl Strategy<Value = Marks> {
    let stretch =
        prop_oneof![Just(None), (0.0..0.4, 2_u32..2_000).prop_map(|(share, period)| Some(Stretch { share, period }))];
    (2.0..5_000.0, -1e4..1e4, 0.0..0.49, 0.0..0.49, stretch, 0.0..=1.0, 0.0..=1.0, any::<u64>()).prop_map(
        |(every, first, width, jitter, stretch, lost, extra, seed)| {
            // Within the free distance between two marks.
            let room = every * (1.0 - stretch.map_or(0.0, |stretch: Stretch| stretch.share)) / 2.0;
            let [every, first, width, jitter] = [every, first, width * room, jitter * room].map(Position::from_f64);
            Marks { every, first, width, jitter, stretch, missing_share: lost, extra, seed }
        },
    )
}

proptest! {
    /// For any travel: an input detects a mark if it has passed one more beginning than ends, edges alternate, and two
    /// parts of a travel pass the same marks as the whole.
    #[test]
    fn edges_make_the_level(
        marks in any_marks(), from in -1_000_000_i64..1_000_000, ways in prop::collection::vec(-3_000_i64..3_000, 1..20),
    ) {
        prop_assert!(marks.is_sound());
        let has_width = marks.width > Position::ZERO;
        let mut at = from;
        for way in ways {
            let to = at + way;
            let passed = edges(&marks, at, to);
            let middle = at + way / 3;
            let pieces = [edges(&marks, at, middle), edges(&marks, middle, to)].concat();
            let kinds = |edges: &[(f64, Edge)]| edges.iter().map(|(_, edge)| *edge).collect::<Vec<_>>();
            prop_assert_eq!(kinds(&passed), kinds(&pieces));
            prop_assert!(passed.is_sorted_by(|a, b| a.0 >= b.0) && passed.iter().all(|(left, _)| (0.0..=1.0).contains(left)));
            let mut back = edges(&marks, to, at);
            back.reverse();
            prop_assert_eq!(back.len(), passed.len());
            for ((there, edge), (again, other)) in passed.iter().zip(&back) {
                prop_assert!((there + again - 1.0).abs() < 1e-12);
                prop_assert_eq!(edge == other, !has_width);
            }
            if has_width {
                let mut level = marks.is_detected(at);
                for (_, edge) in &passed {
                    prop_assert_eq!(*edge == Edge::Rising, !level);
                    level = !level;
                }
                prop_assert_eq!(level, marks.is_detected(to));
            }
            at = to;
        }
    }

    /// Marks are at the sum of the distances before them, for any stretch.
    #[test]
    fn places_are_the_distances_added_up(
        every in 2.0..5_000.0_f64, first in -1e4..1e4_f64, share in 0.0..0.9_f64, period in 2_u32..500,
    ) {
        let stretch = Some(Stretch { share, period });
        let [every, first] = [every, first].map(Position::from_f64);
        let marks = Marks { every, first, stretch, ..Marks::default() };
        let (mut place, mut expected) = (first.to_f64(), vec![]);
        for n in 1..=1_000 {
            expected.push(place);
            let phase = std::f64::consts::TAU * f64::from(n) / f64::from(period);
            place += every.to_f64() * (1.0 + share * libm::sin(phase));
        }
        let (from, to) = (first.floor() - 1, place.floor() as i64 - 1);
        let places = begins(&marks, from, to);
        // The first one may be mark -1, which is not expected here.
        let places = &places[usize::from(places[0] < first.to_f64() - 1e-3)..];
        prop_assert!(places.len() >= 999, "{}", places.len());
        prop_assert!(places.iter().zip(&expected).all(|(place, expected)| (place - expected).abs() < 1e-5));
    }
}
