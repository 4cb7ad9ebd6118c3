//! A gear over very long distances, with all kinds of changes.

use super::direction::set;
use super::rig::{LINE, Rig, X, at, config, couple};
use crate::command::{Action, Move, Phase, PhaseShift, PhaseSide};
use crate::object::{AxisSet, Leader};
use crate::parameter::AxisParameters;
use crate::position::{Length, Position};
use crate::request::Amount;

const TO_LINE: Leader = Leader::AxisCommand(LINE);
/// Ratios with prime terms, of either sign.
const RATIOS: [(i64, i64); 5] = [(355, 113), (-104_729, 99_991), (1, 1_009), (-7, 3), (99_991, 31_337)];
const FASTEST: f64 = 2e11;

/// Pseudo-random numbers, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }

    fn between(&mut self, most: i64) -> i64 {
        self.next(2 * most as u64) as i64 - most
    }
}

/// Expected travel of x, in 2^-32 inc, and the number of roundings down.
struct Ledger {
    led: i128,
    roundings: i128,
    /// Position of the line at the last update.
    seen: Position,
}

impl Ledger {
    fn settle(&mut self, rig: &Rig, (numerator, denominator): (i64, i64)) {
        let now = place(rig, LINE);
        let way = (now - self.seen).raw() * i128::from(numerator);
        (self.led, self.roundings, self.seen) =
            (self.led + way.div_euclid(denominator.into()), self.roundings + 1, now);
    }
}

fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

fn phase(rig: &mut Rig, is_slave: bool, way: i64) {
    let given = PhaseShift { shift: Length::whole(way), velocity: 1e6, acceleration: 1e9 };
    let side = if is_slave {
        PhaseSide::Slave(given)
    } else {
        PhaseSide::Master { given: [Amount::default(); 3], by_scale: [(super::rig::scale(), given)].into() }
    };
    let goal = rig.give(Action::Phase(Phase { axis: X, side }));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    rig.run(20);
    assert_eq!((rig.real("x.phase.slave"), rig.real("x.phase.master")), (0.0, 0.0));
}

/// 10^12 increments of the master, up and down, 10^14 with LINESHAFT_LONG: ratios change in motion, both sides are
/// phase shifted, and offsets are set and removed. The slave is at the exact position, within 2^-32 of an increment for
/// each former ratio.
/// Proves: MACS-SYNC-02, MACS-SYNC-13
#[test]
fn a_million_millions_of_increments_leave_no_error() {
    let way = if std::env::var_os("LINESHAFT_LONG").is_some() { 1e14 } else { 1e12 };
    let mut config = config(0);
    for axis in &mut config.axes {
        axis.parameters = AxisParameters { error_reaction: 2, ..AxisParameters::new(1e15, 1e15) };
    }
    // The axis has no drive, which could not count at this velocity.
    config.axes[usize::from(X)].drive = None;
    let mut rig = Rig::of(config);
    rig.enable();
    let mut numbers = Numbers(2_026);
    let mut ratio = RATIOS[0];
    rig.give(Action::Synchronize(couple(X, TO_LINE, ratio.0, ratio.1)));
    let mut ledger = Ledger { led: 0, roundings: 0, seen: Position::ZERO };
    let (mut gone, mut changes, mut reversals, mut last) = (0.0, 0, 0, 0.0);
    while gone < way {
        let velocity = (numbers.between(1_000) as f64) / 1e3 * FASTEST;
        reversals += u32::from(velocity * last < 0.0);
        last = velocity;
        rig.give(Action::Move(Move { acceleration: 1e13, deceleration: 1e13, ..at(LINE, velocity) }));
        for _ in 0..numbers.next(300) {
            let before = place(&rig, LINE);
            rig.run(1);
            gone += (place(&rig, LINE) - before).to_f64().abs();
        }
        match numbers.next(4) {
            0 => {
                while rig.int("x.in_sync") == 0 {
                    rig.run(1);
                }
                let next = RATIOS[numbers.next(5) as usize];
                rig.give(Action::Synchronize(couple(X, TO_LINE, next.0, next.1)));
                // In the cycle of the command the previous gear is still active.
                ledger.settle(&rig, ratio);
                ratio = next;
                changes += 1;
                rig.run(60);
            }
            1 => {
                let by = numbers.between(5_000);
                phase(&mut rig, true, by);
                ledger.led += Position::whole(by).raw();
            }
            2 => {
                let by = numbers.between(5_000);
                phase(&mut rig, false, by);
                // Additional travel of the master.
                ledger.seen = ledger.seen - Position::whole(by);
            }
            _ => {
                // The part of an offset that was executed is removed with it.
                for offset in [numbers.between(20_000), 0] {
                    let given = set(&mut rig, &[("syncposoffs", offset)]);
                    assert!(rig.was_accepted(given), "{}", rig.refusal(given));
                    rig.run(40);
                }
            }
        }
    }
    rig.give(Action::Halt(AxisSet::one(LINE)));
    rig.run(200);
    assert_eq!((rig.real("line.command.velocity"), rig.int("x.in_sync"), rig.int("x.sync.error")), (0.0, 1, 0));
    ledger.settle(&rig, ratio);
    let off = place(&rig, X).raw() - ledger.led;
    println!(
        "{gone:.3e} inc, {changes} ratios, {reversals} reversals: {off} of 2^-32 inc beside, {} roundings",
        ledger.roundings
    );
    assert!((0..=ledger.roundings).contains(&off), "{off} of 2^-32 inc, {} roundings", ledger.roundings);
    assert!(changes > 3 && reversals > 3);
}
