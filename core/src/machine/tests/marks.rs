//! Coupling by marks: products on a belt, labels on a roll with twice the travel.

use super::direction::set;
use super::rig::{LINE, Rig, X, config, couple};
use crate::code::Code;
use crate::command::{Action, Move, Phase, PhaseShift, PhaseSide, Synchronize};
use crate::config::{IoConfig, IoKind, MachineConfig, TableConfig};
use crate::drive::{Edge, Latch};
use crate::encoder::PulseCheck;
use crate::event::Kind;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, MACHINE, Row, Value};
use crate::position::Length;
use crate::sim::{Fixtures, Index};
use crate::sync::SyncMode;
use proptest::prelude::*;

const TO_BELT: Leader = Leader::Encoder(0);
const T_NS: f64 = 1e6;
/// The first input for products, the second one for labels; rising edges.
const TYPES: [(&str, i64); 2] = [("syncmtypm", 12), ("syncmtyps", 22)];

/// Simulated belt and roll: a sensor for products on the belt, and one for labels on x.
pub(super) struct BeltAndRoll {
    pub(super) rig: Rig,
    /// Positions of products that have not passed yet, and the position of the belt.
    pub(super) products: Vec<f64>,
    pub(super) belt: i64,
    /// Distance of the labels, and position of the first one.
    labels: (f64, f64),
    /// Position of x in the next cycle, and in the last one.
    x: [i64; 2],
    /// Count direction of belt and x: 1 or -1.
    pub(super) sense: (f64, f64),
    /// Times of the last product and label (cycles).
    product_at: f64,
    label_at: f64,
}

fn marked(changes: &[(&str, i64)]) -> Rig {
    marked_with(vec![], changes)
}

fn marked_with(tables: Vec<TableConfig>, changes: &[(&str, i64)]) -> Rig {
    let input = |name: &str, latch| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch };
    let io = vec![input("product", true), input("label", true), input("gate", false)];
    let mut rig = Rig::of(MachineConfig { io, tables, ..config(0) });
    rig.enable();
    for changes in [&TYPES[..], &[("syncmpulsm", 1_000), ("syncmpulss", 2_000)], changes] {
        let given = set(&mut rig, changes);
        assert!(rig.was_accepted(given));
    }
    rig
}

fn by_marks() -> Action {
    Action::Synchronize(Synchronize { mode: SyncMode::Marker, ..couple(X, TO_BELT, 2, 1) })
}

impl BeltAndRoll {
    /// Returns a world with products every 1000 inc from `first` on, and labels every 2000 from 300 on.
    pub(super) fn new(first: f64, changes: &[(&str, i64)]) -> Self {
        Self::of(marked(changes), first)
    }

    pub(super) fn with_tables(tables: Vec<TableConfig>, first: f64, changes: &[(&str, i64)]) -> Self {
        Self::of(marked_with(tables, changes), first)
    }

    fn of(rig: Rig, first: f64) -> Self {
        let products = (0..400).map(|place| first + f64::from(place) * 1_000.0).collect();
        let (x, labels) = ([0; 2], (2_000.0, 300.0));
        let (product_at, label_at, sense) = (f64::NAN, f64::NAN, (1.0, 1.0));
        Self { rig, products, belt: 0, labels, x, sense, product_at, label_at }
    }

    pub(super) fn couple(&mut self) -> u64 {
        let goal = self.rig.give(by_marks());
        self.record_position();
        goal
    }

    pub(super) fn record_position(&mut self) {
        self.x = [self.x[1], self.rig.int("x.output.position")];
    }

    fn latch(&mut self, input: u16, edge: Edge, share: f64) {
        let age_ns = Some(((1.0 - share) * T_NS) as u32);
        assert!(self.rig.plant.add_latch(Latch { object: Object::Io(input), edge, age_ns, position: None }));
    }

    /// Runs one cycle in which the belt moves by `change` (inc).
    pub(super) fn cycle(&mut self, change: i64) {
        let now = self.rig.machine.next_cycle() as f64;
        self.rig.plant.jump_encoder(0, change);
        let belt = self.belt as f64 * self.sense.0;
        self.belt += change;
        let there = self.belt as f64 * self.sense.0;
        while let Some(product) = self.products.first().copied().filter(|place| *place <= there) {
            let share = (product - belt) / (there - belt);
            self.products.remove(0);
            self.product_at = now - 1.0 + share;
            self.latch(0, Edge::Rising, share);
        }
        let [before, after] = self.x.map(|place| place as f64 * self.sense.1);
        let (every, first) = self.labels;
        let label = ((after - first) / every).floor() * every + first;
        if label > before && after > before {
            let share = (label - before) / (after - before);
            self.label_at = now - 1.0 + share;
            self.latch(1, Edge::Rising, share);
        }
        self.rig.run(1);
        self.record_position();
    }

    pub(super) fn run(&mut self, cycles: usize, change: i64) {
        for _ in 0..cycles {
            self.cycle(change);
        }
    }

    /// Returns the distance of the last label after the last product, in increments of x at 20 inc per cycle.
    fn apart(&self) -> f64 {
        (self.label_at - self.product_at) * 20.0
    }

    pub(super) fn events(&self, code: Code) -> usize {
        self.rig.events.iter().filter(|event| event.kind == Kind::Warning && event.code == code).count()
    }
}

/// Products at 500, 1500 and so on, labels at 300: without marks a label passes 700 inc before its product, or 1300 inc
/// after it. With marks both pass together, with any pair selected by the start, and after the expected correction
/// distance.
/// Proves: MACS-MARK-01, MACS-MARK-13, MACS-MARK-14, MACS-CMD-12
#[test]
fn labels_meet_their_products() {
    for (start, ahead) in [(6, -700.0), (2, -700.0), (3, 1_300.0), (4, -700.0), (5, -700.0), (1, -700.0), (0, 1_300.0)]
    {
        let mut world = BeltAndRoll::new(500.0, &[("syncmstart", start)]);
        world.couple();
        assert_eq!(world.rig.int("x.in_sync"), 0, "no marks yet");
        world.run(1_500, 10);
        assert!(world.apart().abs() < 1.0, "{start}: {}", world.apart());
        assert!(world.rig.real("x.marker.error").abs() < 1.0);
        assert_eq!((world.rig.int("x.in_sync"), world.rig.int("x.sync.error")), (1, 0));
        let way = (world.rig.int("x.command.position") - 2 * world.belt) as f64;
        // The lag of the drive, one cycle, is included.
        assert!((way - ahead).abs() <= 40.0, "{start}: {way}");
        assert_eq!(world.events(Code::SYNC_LOST), 0);
    }
}

/// With a time the correction is a superimposed trapezoid: 1000 inc of the master in 400 ms are 3125 inc/s of the
/// master, 6250 of x.
/// Proves: MACS-MARK-13, MACS-SYNC-14
#[test]
fn a_correction_in_its_time_leaves_the_axis_synchronized() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncofftime", 400)]);
    world.couple();
    world.run(50, 10);
    let pair = world.rig.events.iter().find(|event| event.kind == Kind::Mark).expect("a pair");
    let sentence = crate::text::message(pair, world.rig.machine.config());
    // The distance still to be caught up is not part of the mark error.
    assert!(
        sentence.starts_with("x: marks -") && sentence.ends_with(" inc apart, corrected by -679.500 inc"),
        "{sentence}"
    );
    let mut fastest = [f64::INFINITY, f64::NEG_INFINITY];
    for k in 0..3_000 {
        world.cycle(10);
        if k > 100 {
            let velocity = world.rig.real("x.command.velocity");
            fastest = [fastest[0].min(velocity), fastest[1].max(velocity)];
        }
    }
    assert!(world.apart().abs() < 1.0, "{}", world.apart());
    assert!(fastest[0] >= 20_000.0 - 6_250.0 - 30.0 && fastest[0] <= 15_000.0, "{fastest:?}");
    assert_eq!(world.rig.int("x.sync.error"), 0);
}

/// Filtered: 1000 ms of offset time are 10 marks at this speed, so each mark corrects a tenth of an error, after the
/// start correction is split over ten marks.
/// Proves: MACS-MARK-12, MACS-MARK-13
#[test]
fn filtered_corrections_settle() {
    let time = [("syncmstart", 6), ("syncmftime", 2_000), ("syncofftime", 1_000), ("syncmfpar", 2)];
    let mut world = BeltAndRoll::new(500.0, &time);
    world.run(100, 10);
    // The axis is coupled in motion.
    world.rig.plant.jump_encoder(0, 10);
    world.belt += 10;
    world.couple();
    let mut all = vec![];
    for _ in 0..12_000 {
        let before = world.rig.real("x.marker.error");
        world.cycle(10);
        let (error, correction) = (world.rig.real("x.marker.error"), world.rig.real("x.marker.correction"));
        if error != before {
            all.push((error, correction));
        }
    }
    // Detected one cycle late, the label is 20 inc ahead of its command.
    let (first, split) = all[0];
    assert!(first < 0.0 && (split * 10.0 + 680.0).abs() <= 21.0, "{first} {split}");
    assert!(all.iter().skip(1).take(8).all(|(_, correction)| (correction - split).abs() < 30.0), "{all:?}");
    assert!(world.apart().abs() < 2.0, "{}", world.apart());
}

/// 10 inc per ms: 20 marks pass in syncmftime, of which MARKERFILTER is a third, and 10 in syncofftime, over which the
/// start correction is split. A product that is 60 inc late is 120 inc of the axis, of which the filter takes its share
/// in the pair of that product.
/// Proves: MACS-MARK-09, MACS-MARK-12, MACS-MARK-13
#[test]
fn filters_and_start_correction_of_marks_are_signals() {
    let time = [("syncmstart", 6), ("syncmftime", 2_000), ("syncofftime", 1_000), ("syncmfpar", 2)];
    let mut world = BeltAndRoll::new(500.0, &time);
    world.run(100, 10);
    // The axis is coupled in motion.
    world.rig.plant.jump_encoder(0, 10);
    world.belt += 10;
    world.couple();
    let shown = |world: &BeltAndRoll| {
        ["filter", "correction_filter", "start_left", "distance_error"]
            .map(|name| world.rig.real(&format!("x.marker.{name}")))
    };
    assert_eq!(shown(&world), [0.0; 4]);
    for _ in 0..400 {
        world.cycle(10);
        if world.rig.real("x.marker.correction") != 0.0 {
            break;
        }
    }
    let split = world.rig.real("x.marker.correction");
    let [filter, correction_filter, left, error] = shown(&world);
    assert!((filter - 20.0 / 3.0).abs() < 1e-6 && (correction_filter - 10.0).abs() < 1e-6, "{:?}", shown(&world));
    assert!(split < -60.0 && (left - 9.0 * split).abs() < 0.1 && error.abs() < 0.1, "{split}: {:?}", shown(&world));
    world.run(1_400, 10);
    assert!(shown(&world)[2].abs() < 1e-9, "{:?}", shown(&world));
    world.products[0] += 60.0;
    let mut most = 0.0_f64;
    for _ in 0..400 {
        world.cycle(10);
        most = most.min(shown(&world)[3]);
    }
    assert!((most + 120.0 / (20.0 / 3.0)).abs() < 0.5, "{most}");
    // Without `syncmftime` the signals are 0 at once: no further pair is needed.
    assert!(shown(&world)[0] > 1.0 && shown(&world)[1] > 1.0, "{:?}", shown(&world));
    world.rig.set("syncmftime", Value::Int(0));
    assert_eq!(shown(&world), [0.0; 4]);
    world.rig.give(Action::Halt(AxisSet::one(X)));
    world.rig.run(50);
    assert_eq!(shown(&world), [0.0; 4]);
}

/// Products a quarter of an increment after 500, labels at 300.
/// Proves: MACS-CMD-20
#[test]
fn places_of_marks_have_fractions() {
    let mut world = BeltAndRoll::new(500.25, &[("syncmstart", 6)]);
    world.couple();
    world.run(1_500, 10);
    let place = |name: &str, fraction: &str| world.rig.int(name) as f64 + world.rig.real(fraction);
    let master = place("x.marker.master", "x.marker.master.fraction");
    let last = ((world.belt as f64 - 500.25) / 1_000.0).floor() * 1_000.0 + 500.25;
    assert!((master - last).abs() < 1e-3, "{master}, not {last}");
    let beyond = (place("x.marker.position", "x.marker.fraction") - 300.0 + 1.0).rem_euclid(2_000.0) - 1.0;
    assert!(beyond.abs() < 1e-3, "{beyond}");
}

/// Products with a 1 % larger distance: the average detects this, and the gear is corrected by it, so that no error is
/// left for the marks.
/// Proves: MACS-MARK-10, MACS-MARK-11, MACS-SYS-01
#[test]
fn the_gear_follows_the_average_distance() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmftime", 2_000)]);
    world.products = (0..700).map(|place| 500.0 + f64::from(place) * 1_010.0).collect();
    world.couple();
    world.run(300, 10);
    world.run(40_000, 10);
    assert!((world.rig.real("x.marker.distance") - 1_010.0).abs() < 0.1, "{}", world.rig.real("x.marker.distance"));
    assert!(world.rig.real("x.marker.error").abs() < 1.0, "{}", world.rig.real("x.marker.error"));
    let velocity = world.rig.real("x.command.velocity");
    assert!((velocity - 20_000.0 / 1.01).abs() < 25.0, "{velocity}");
}

/// A mark outside its window and a missing mark correct nothing, and are reported once.
/// Proves: MACS-MARK-07
#[test]
fn lost_and_extra_marks_correct_nothing() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmwinm", 100), ("syncmwins", 200)]);
    world.couple();
    world.run(1_000, 10);
    assert_eq!((world.rig.int("x.marker.missed"), world.rig.int("x.marker.extra")), (0, 0));
    // Two additional marks in between, one after the other, and one that is missing.
    let next = world.products[0];
    world.products.splice(0..1, [next - 600.0, next - 400.0]);
    let way = |world: &BeltAndRoll| world.rig.int("x.command.position") - 2 * world.belt;
    let before = way(&world);
    world.run(105, 10);
    assert_eq!((world.rig.int("x.marker.extra"), world.events(Code::MARK_EXTRA)), (2, 1));
    world.run(20, 10);
    assert_eq!((world.rig.int("x.marker.missed"), world.events(Code::MARK_MISSED)), (1, 1));
    assert_eq!(world.rig.int("x.sync.status") & 0b1_1000, 0b0_1000);
    world.run(500, 10);
    assert_eq!((world.rig.int("x.sync.status") & 0b1_1000, world.rig.int("x.marker.missed")), (0, 1));
    assert!((way(&world) - before).abs() <= 1);
    // A missing label counts as a missing mark of the axis.
    world.labels.1 += 2_000_000.0 + 1_000.0;
    world.run(150, 10);
    assert_eq!(world.rig.int("x.sync.status") & 0b1_1000, 0b1_0000);
    assert!((way(&world) - before).abs() <= 1);
}

/// No correction exceeds its bound; a negative bound disables corrections.
/// Proves: MACS-MARK-18
#[test]
fn corrections_stay_within_their_bound() {
    for (largest, most) in [(50, 50.0), (-1, 0.0)] {
        let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmmaxcorr", largest)]);
        world.couple();
        for _ in 0..1_500 {
            world.cycle(10);
            assert!(world.rig.real("x.marker.correction").abs() <= most);
        }
        let way = (world.rig.int("x.command.position") - 2 * world.belt).abs();
        // About 15 pairs.
        assert!(if largest > 0 { (500..=750).contains(&way) } else { way <= 40 }, "{way}");
    }
}

/// The offset refers to the master, and is in force with the first pair, or with start 1000 more once its correction is
/// done.
/// Proves: MACS-SYNC-13, MACS-MARK-14
#[test]
fn labels_are_put_beside_their_products() {
    for start in [6, 1_006] {
        let mut world = BeltAndRoll::new(500.0, &[("syncmstart", start), ("syncposoffs", 40)]);
        world.couple();
        world.run(2_000, 10);
        // Ahead of the product, by 40 inc of the master.
        assert!((world.apart() + 80.0).abs() < 1.5, "{start}: {}", world.apart());
        set(&mut world.rig, &[("syncposoffs", -25)]);
        world.record_position();
        world.run(1_000, 10);
        assert!((world.apart() - 50.0).abs() < 1.5, "{start}: {}", world.apart());
        assert!(world.rig.real("x.marker.error").abs() < 1.5);
    }
}

/// READY and FAULT are bits of the status, and a fault is reported once.
/// Proves: MACS-MARK-20, MACS-MARK-21, MACS-SYNC-16
#[test]
fn pairs_make_ready_and_fault() {
    let accuracy = [("syncmstart", 6), ("syncaccuracy", 20), ("syncready", 3), ("syncfault", 2)];
    let mut world = BeltAndRoll::new(500.0, &accuracy);
    world.couple();
    world.run(1_000, 10);
    assert_eq!(world.rig.int("x.sync.status") & 0b110, 0b010);
    // Products that alternate by more than the accuracy.
    let jumping = world.products.iter().enumerate().map(|(place, at)| at + if place % 2 == 0 { 60.0 } else { 0.0 });
    world.products = jumping.collect();
    world.run(600, 10);
    assert_eq!((world.rig.int("x.sync.status") & 0b110, world.events(Code::MARK_FAULT)), (0b100, 1));
}

/// Marks count while the third input is high (300), or low (-300).
/// Proves: MACS-MARK-05
#[test]
fn a_condition_lets_marks_count() {
    for (condition, counts) in [(312, false), (-312, true)] {
        let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmtypm", condition)]);
        world.couple();
        world.run(1_000, 10);
        assert_eq!(world.rig.int("x.in_sync") == 1, counts, "{condition}");
        if !counts {
            world.rig.plant.set_digital(2, true);
            world.run(500, 10);
            assert_eq!(world.rig.int("x.in_sync"), 1);
        }
    }
}

/// Index pulses of belt and drive.
/// Proves: MACS-MARK-05, MACS-MARK-06, MACS-CMD-20
#[test]
fn index_pulses_are_marks() {
    let mut config = config(0);
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 10 });
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 2_000, at: 300 }), ..Fixtures::default() });
    rig.enable();
    set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 5)]);
    let goal = rig.give(by_marks());
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    for _ in 0..1_500 {
        rig.plant.jump_encoder(0, 10);
        rig.run(1);
    }
    assert_eq!((rig.int("x.in_sync"), rig.real("x.marker.error").abs() < 1.0), (1, true));
    // IPOS and MIPOS: the last index of each.
    let (x, belt) = (rig.int("x.marker.position"), rig.int("x.marker.master"));
    assert_eq!((x.rem_euclid(2_000), belt % 1_000, belt), (300, 0, rig.int("belt.position") / 1_000 * 1_000));
    assert!((0..2_000).contains(&(rig.int("x.actual.position") - x)), "{x}");
    // Position 0 of the belt is 300 at x, as seen one cycle later.
    let way = rig.int("x.actual.position") - rig.int("belt.position") * 2;
    assert!((way - 300).abs() <= 1, "{way}");
}

/// An encoder without index pulses, and a drive without them, give no marks: a coupling that waits for them would wait
/// forever.
/// Proves: MACS-MARK-05
#[test]
fn an_index_pulse_of_what_has_none_is_refused() {
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    let coupled = |types: [i64; 2], without: &[Object]| {
        let mut config = MachineConfig { io: vec![input("product"), input("label")], ..config(0) };
        config.global.without_index = without.to_vec();
        let mut rig = Rig::of(config);
        rig.enable();
        set(&mut rig, &[("syncmtypm", types[0]), ("syncmtyps", types[1])]);
        set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000)]);
        let goal = rig.give(by_marks());
        rig.answer(goal).err().map(|_| rig.refusal(goal))
    };
    let (belt, drive) = (Object::Encoder(0), Object::Axis(X));
    for (types, without, key) in [([0, 22], belt, "syncmtypm"), ([12, 0], drive, "syncmtyps")] {
        let refused = coupled(types, &[without]).unwrap_or_default();
        assert!(refused.starts_with(&format!("x: {key} 0 asks for an index pulse that there is not")), "{refused}");
        assert_eq!(coupled(types, &[]), None);
        assert_eq!(coupled([12, 22], &[without]), None);
    }
}

/// The virtual master gives a mark every vmencres, at which the index of the drive occurs.
/// Proves: MACS-VM-06, MACS-MARK-05
#[test]
fn the_virtual_master_has_marks() {
    let mut rig = Rig::new();
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 2_000, at: 300 }), ..Fixtures::default() });
    rig.enable();
    set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 5)]);
    let of_machine = |key, value| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    let starts =
        [("vmencres", 1_000), ("pulsacc", 20_000), ("pulsvel", 10_000)].map(|(key, value)| of_machine(key, value));
    let given = rig.give(Action::SetParameters(starts.into()));
    assert!(rig.was_accepted(given), "{}", rig.refusal(given));
    let line = Synchronize { mode: SyncMode::Marker, ..couple(X, Leader::Virtual, 2, 1) };
    let goal = rig.give(Action::Synchronize(line));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    rig.run(3_000);
    assert_eq!((rig.int("x.in_sync"), rig.real("x.marker.error").abs() < 1.0), (1, true));
    let way = rig.int("x.actual.position") - rig.int("machine.vmaster.position") * 2;
    assert!((way - 300).rem_euclid(2_000).min((300 - way).rem_euclid(2_000)) <= 1, "{way}");
}

/// The virtual master is not an encoder with an input of its own, and an index without counts gives no mark; an
/// assigned input does.
/// Proves: MACS-MARK-05, MACS-VM-07
#[test]
fn a_virtual_master_without_marks_is_refused() {
    let of_machine = |key, value| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    let input = "x: syncmtypm names digital input 0, which the cell does not have, or which has not latch: true";
    let index = "x: syncmtypm 0 asks for an index pulse that there is not";
    for (master_type, distance, marker, sentence) in [
        (2, 500, 0, Some(input)),
        (3, 500, 12, Some(input)),
        (0, 0, 0, Some(index)),
        (0, 0, 1, Some(index)),
        (0, 0, 12, None),
        (0, 500, 0, None),
        (12, 0, 0, None),
    ] {
        let mut rig = marked(&[("syncmtypm", master_type)]);
        let given = rig.give(Action::SetParameters(
            [("vmencres", distance), ("vmencmtyp", marker)].map(|(key, value)| of_machine(key, value)).into(),
        ));
        assert!(rig.was_accepted(given));
        let line = Synchronize { mode: SyncMode::Marker, ..couple(X, Leader::Virtual, 2, 1) };
        let goal = rig.give(Action::Synchronize(line));
        let refused = rig.answer(goal).err().map(|_| rig.refusal(goal));
        match sentence {
            Some(sentence) => assert!(refused.as_ref().is_some_and(|said| said.starts_with(sentence)), "{refused:?}"),
            None => assert_eq!(refused, None, "{master_type} {distance} {marker}"),
        }
    }
}

/// Sources that cannot give marks, and unknown starts, are refused by name.
/// Proves: MACS-MARK-14
#[test]
fn source_without_marks_is_refused() {
    for (changes, sentence) in [
        (
            ("syncmtypm", 42),
            "x: syncmtypm names digital input 4, which the cell does not have, or which has not latch: true",
        ),
        (
            ("syncmtyps", 33),
            "x: syncmtyps names digital input 3, which the cell does not have, or which has not latch: true",
        ),
        (("syncmtypm", 512), "x: syncmtypm names digital input 5, which the cell"),
        (("syncmtypm", 1), "x: syncmtypm 1 asks for an index pulse that there is not"),
        (("syncmstart", 2_000), "x: syncmstart 2000 does not exist in mode MARKER; 0 to 7 and 1000 to 1007 do"),
    ] {
        let mut rig = marked(&[changes]);
        let goal = rig.give(by_marks());
        assert!(rig.refusal(goal).starts_with(sentence), "{}", rig.refusal(goal));
        assert_eq!(rig.state("x"), "STANDSTILL");
    }
    let mut rig = marked(&[("syncmtypm", 0)]);
    let line = Synchronize { mode: SyncMode::Marker, ..couple(X, Leader::AxisCommand(LINE), 1, 1) };
    let goal = rig.give(Action::Synchronize(line));
    assert!(rig.refusal(goal).contains("syncmtypm 0 asks for an index pulse"), "{}", rig.refusal(goal));
    let mut large = marked(&[("syncfacts", 2_147_484)]);
    let given = Synchronize { mode: SyncMode::Marker, ..couple(X, TO_BELT, 0, 0) };
    let goal = large.give(Action::Synchronize(given));
    let sentence = "x: syncmpulsm 1000 inc is too far for marks; at most 999 inc is allowed";
    assert!(large.refusal(goal).starts_with(sentence), "{}", large.refusal(goal));
    let refused = set(&mut rig, &[("syncmfpar", 64)]);
    assert!(rig.refusal(refused).contains("syncmfpar 64 asks with 64"), "{}", rig.refusal(refused));
}

/// Shifts that marks would correct away are refused: a superimposed move and a phase shift.
#[test]
fn nothing_else_shifts_an_axis_on_marks() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6)]);
    world.couple();
    let over = Move { mode: crate::command::MoveMode::Superimposed, ..super::rig::to(X, 100) };
    let shift = PhaseShift { shift: Length::whole(5), velocity: 0.0, acceleration: 0.0 };
    for action in [Action::Move(over), Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift) })] {
        let goal = world.rig.give(action);
        assert!(
            world.rig.refusal(goal).contains("coupled by marks, which would take that back"),
            "{}",
            world.rig.refusal(goal)
        );
    }
    let mut rig = marked(&[("syncmpulsm", 0), ("syncmstart", 3)]);
    let goal = rig.give(by_marks());
    assert_eq!(rig.refusal(goal), "x: syncmstart 3 goes by the distance of the marks, and syncmpulsm is 0");
}

/// The same with a gear that inverts the belt, with a belt that runs backwards, and in cycles of 4 ms.
/// Proves: MACS-MARK-13, MACS-SYNC-14
#[test]
fn marks_meet_in_all_directions_and_cycle_times() {
    for (ratio, way) in [(-2, 10), (2, -10), (-2, -10)] {
        for changes in [&[][..], &[("syncmftime", 1_000)], &[("syncofftime", 300)], &[("syncvftime", -10_000)]] {
            let mut world = BeltAndRoll::new(500.0, &[&[("syncmstart", 5)], changes].concat());
            world.sense = (f64::from(way) / 10.0, f64::from(way * ratio).signum());
            world.rig.give(Action::Synchronize(Synchronize {
                mode: SyncMode::Marker,
                ..couple(X, TO_BELT, ratio.into(), 1)
            }));
            world.record_position();
            world.run(12_000, way.into());
            assert!(world.apart().abs() < 3.0, "{ratio} {way} {changes:?}: {}", world.apart());
        }
    }
}

/// A correction that is spread over the travel of the belt pauses while the belt is at rest.
/// Proves: MACS-MARK-13
#[test]
fn a_spread_correction_stands_with_its_belt() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmftime", 1_000), ("syncmfpar", 16)]);
    world.couple();
    world.run(1_500, 10);
    for product in &mut world.products {
        *product += 60.0;
    }
    while world.rig.int("x.sync.error") == 0 {
        world.cycle(10);
    }
    world.run(20, 10);
    let left = world.rig.int("x.sync.error");
    assert!((80..=100).contains(&left), "{left}");
    // At rest, no part of the correction is executed.
    world.run(400, 0);
    assert_eq!((world.rig.real("x.command.velocity"), world.rig.int("x.sync.error")), (0.0, left));
    world.run(1_000, 10);
    assert!(world.apart().abs() < 2.0);
}

/// A machine restored from any point of a recording gives the same results.
#[test]
fn a_coupling_by_marks_is_restored() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmftime", 1_000), ("syncvftime", -10_000)]);
    world.couple();
    world.run(333, 10);
    world.rig.mirror();
    world.run(500, 10);
}

/// Stopped together with its belt it stays at rest; uncoupled, no signals of marks are shown any more.
#[test]
fn belt_at_rest_causes_no_correction() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmftime", 1_000)]);
    world.couple();
    world.run(777, 10);
    world.run(300, 0);
    let place = world.rig.int("x.command.position");
    world.run(500, 0);
    assert_eq!((world.rig.int("x.command.position"), world.rig.state("x")), (place, "SYNCHRONIZED_MOTION"));
    world.rig.give(Action::Halt(AxisSet::one(X)));
    world.rig.run(20);
    assert_eq!((world.rig.real("x.marker.error"), world.rig.int("x.sync.status") & 0b1_1110), (0.0, 0));
}

/// Distance of labels from their products (inc of the master): mean and maximum of the second half of all.
#[derive(Debug)]
struct Register {
    mean: f64,
    peak: f64,
    missed: i64,
    extra: i64,
}

/// Runs `count` products on a web that stretches by up to 0.1 % back and forth; of 100 marks 2 are lost, and 1 is
/// false.
fn register(count: u32, changes: &[(&str, i64)], mode: SyncMode) -> Register {
    let mut draw = 0x2545_F491_4F6C_DD1D_u64;
    let mut per_cent = move || {
        draw ^= draw << 13;
        draw ^= draw >> 7;
        draw ^= draw << 17;
        draw % 100
    };
    let (mut places, mut seen, mut at) = (vec![], vec![], 500.0);
    for place in 0..count {
        at += 1_000.0 * (1.0 + 0.001 * libm::sin(f64::from(place) / 200.0));
        places.push(at);
        match per_cent() {
            0 | 1 => {}
            2 => seen.extend([at - 300.0, at]),
            _ => seen.push(at),
        }
    }
    let mut world = BeltAndRoll::new(0.0, changes);
    world.products = seen;
    world.rig.give(Action::Synchronize(Synchronize { mode, ..couple(X, TO_BELT, 2, 1) }));
    world.record_position();
    let mut errors = vec![];
    let (mut label, mut places) = (world.label_at, places.into_iter().peekable());
    while places.peek().is_some() {
        world.cycle(10);
        if world.label_at != label {
            label = world.label_at;
            // Position of the web when the label passes.
            let web = world.belt as f64 - (world.rig.machine.next_cycle() as f64 - 1.0 - label) * 10.0;
            while places.peek().is_some_and(|place| *place < web - 500.0) {
                places.next();
            }
            errors.extend(places.peek().map(|place| web - place));
        }
        world.rig.events.clear();
    }
    let late = &errors[errors.len() / 2..];
    Register {
        mean: late.iter().map(|error| error.abs()).sum::<f64>() / late.len() as f64,
        peak: late.iter().fold(0.0, |most, error| most.max(error.abs())),
        missed: world.rig.int("x.marker.missed"),
        extra: world.rig.int("x.marker.extra"),
    }
}

/// Without marks a stretching web leaves labels anywhere; with marks they stay on their products, also with lost and
/// false marks. 10,000 products with LINESHAFT_LONG.
/// Proves: MACS-MARK-07, MACS-MARK-13
#[test]
fn a_register_is_kept_on_a_web_that_stretches() {
    let count = if std::env::var_os("LINESHAFT_LONG").is_some() { 10_000 } else { 1_000 };
    let windows = [("syncmwinm", 60), ("syncmwins", 120), ("syncmmaxcorr", 100), ("syncmstart", 5)];
    let without = register(count, &[], SyncMode::Position);
    let at_once = register(count, &windows, SyncMode::Marker);
    let filtered = [&windows[..], &[("syncmftime", 3_000), ("syncofftime", 300)]].concat();
    let filtered = register(count, &filtered, SyncMode::Marker);
    println!("{without:?}\n{at_once:?}\n{filtered:?}");
    assert!(without.peak > 100.0, "{without:?}");
    assert!(at_once.peak < 8.0 && at_once.mean < 2.0, "{at_once:?}");
    assert!(filtered.peak < 20.0 && filtered.mean < 5.0, "{filtered:?}");
    let (lost, false_ones) = (i64::from(count) / 50, i64::from(count) / 100);
    assert!((at_once.missed - lost).abs() < lost && (at_once.extra - false_ones).abs() < false_ones, "{at_once:?}");
}

proptest! {
    #![proptest_config(super::rig::cases(12))]
    /// With marks that jitter, are lost or are added, at any velocity of the belt: no velocity step exceeds the limit
    /// of the axis, and once the marks are regular again, labels pass with their products.
    /// Proves: MACS-MARK-13
    #[test]
    fn marks_settle_whatever_they_did(
        jitter in prop::collection::vec((-60.0..60.0_f64, 0_u8..20), 40),
        speeds in prop::collection::vec(0_i64..20, 10),
        start in prop_oneof![Just(0_i64), Just(1), Just(2), Just(3), Just(4), Just(5), Just(6), Just(1_005)],
        time in prop_oneof![Just(0_i64), Just(200)],
        filter in prop_oneof![Just(0_i64), Just(500), Just(3_000)],
        tau in prop_oneof![Just(0_i64), Just(-20_000)],
        bits in prop_oneof![Just(0_i64), Just(1), Just(2), Just(4), Just(16), Just(20)],
    ) {
        let changes = [
            ("syncmstart", start), ("syncofftime", time), ("syncmftime", filter), ("syncvftime", tau), ("syncmfpar", bits),
            ("syncmwinm", 150), ("syncmwins", 300),
        ];
        let mut world = BeltAndRoll::new(500.0, &changes);
        let mut products = vec![];
        for (place, (by, kind)) in jitter.iter().enumerate() {
            let at = 500.0 + place as f64 * 1_000.0;
            match kind {
                0 => {}
                1 => products.extend([at + by, at + 400.0]),
                _ => products.push(at + by),
            }
        }
        products.extend((40..2_000).map(|place| 500.0 + f64::from(place) * 1_000.0));
        world.products = products;
        world.couple();
        let mut before = world.rig.real("x.command.velocity");
        let mut check = |world: &BeltAndRoll| {
            let velocity = world.rig.real("x.command.velocity");
            // The resolution of one count of the belt is added.
            let fits = (velocity - before).abs() <= 1_000.0 + 2_000.0 * 1.2 && velocity.abs() <= 100_000.0 + 2_400.0;
            before = velocity;
            fits
        };
        for speed in speeds {
            for _ in 0..300 {
                world.cycle(speed);
                prop_assert!(check(&world));
            }
        }
        for _ in 0..30_000 {
            world.cycle(10);
            prop_assert!(check(&world));
        }
        prop_assert!(world.apart().abs() < 3.0 || (world.apart().abs() - 2_000.0).abs() < 3.0, "{}", world.apart());
        prop_assert_eq!(world.rig.int("x.in_sync"), 1);
    }
}
