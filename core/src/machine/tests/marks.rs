//! Coupling by marks: products on a belt, labels on a roll with twice the travel.

use super::direction::set;
use super::rig::{Rig, X, config, couple};
use crate::code::Code;
use crate::command::{Action, Synchronize};
use crate::config::{IoConfig, IoKind, MachineConfig, TableConfig};
use crate::drive::{Edge, Latch};
use crate::event::Kind;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::Value;
use crate::sync::SyncMode;

mod disturbed;
mod sources;

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
