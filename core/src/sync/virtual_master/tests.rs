use super::*;
use proptest::prelude::*;

const MS: u64 = 1_000_000;

fn running(pulsvel: i64, pulsacc: i64) -> (VirtualMaster, MachineParameters, Lead) {
    let parameters = MachineParameters { pulsvel, pulsacc, ..MachineParameters::default() };
    let mut master = VirtualMaster::new(&parameters);
    let mut lead = Lead { valid: true, ..Lead::default() };
    master.take(master.source().after(&parameters, true), &mut lead);
    (master, parameters, lead)
}

/// 1 inc/s more in each ms: after 1 s the distance is that of 1 + 2 + .. + 1000 inc/s, one ms each.
///
/// Proves: MACS-VM-02, MACS-VM-08
#[test]
fn a_thousand_is_reached_within_a_second() {
    let (mut master, parameters, mut lead) = running(1_000, 1_000);
    for cycle in 1..=1_000_i128 {
        master.step(&parameters, Position::ZERO, MS, &mut lead);
        let exact = ((cycle * (cycle + 1) / 2) << 32).div_euclid(1_000);
        assert_eq!((lead.velocity, lead.position.raw()), (cycle as f64, exact), "in cycle {cycle}");
    }
    assert_eq!((lead.position.to_f64(), lead.velocity), (500.5, 1_000.0));
    master.step(&parameters, Position::ZERO, MS, &mut lead);
    assert_eq!((lead.change, lead.velocity, lead.uneven, lead.valid), (Position::whole(1), 1_000.0, 0.0, true));
}

/// Proves: MACS-VM-04
#[test]
fn without_a_ramp_the_velocity_is_there_at_once() {
    let parameters = MachineParameters { pulsacc: -1, pulsvel: 77, ..MachineParameters::default() };
    let (mut master, mut lead) = (VirtualMaster::new(&parameters), Lead::default());
    for velocity in [0, 250_000, -250_000, 0] {
        let parameters = MachineParameters { setsys_15: velocity, ..parameters };
        master.step(&parameters, Position::ZERO, MS, &mut lead);
        assert_eq!((lead.change, lead.velocity), (Position::whole(velocity / 1_000), velocity as f64));
    }
    assert_eq!(lead.position, Position::ZERO);
}

/// Proves: MACS-VM-02, MACS-VM-04, MACS-VM-08
#[test]
fn parameters_select_the_source_of_velocity() {
    use VirtualSource::{Axis, Direct, Off, Own};
    let of = |pulsacc, vmenctyp| MachineParameters { pulsacc, vmenctyp, ..MachineParameters::default() };
    for before in [Off, Own, Axis(3), Direct] {
        for starts in [false, true] {
            assert_eq!(before.after(&of(0, 200), starts), Off);
            assert_eq!(before.after(&of(-1, 200), starts), Direct);
        }
        assert_eq!(before.after(&of(1, 0), true), Own);
        assert_eq!(before.after(&of(1, 100_200), true), Axis(1));
        let goes_on = if before == Direct { Off } else { before };
        assert_eq!(before.after(&of(1, 200), false), goes_on);
        // A layer starts nothing, and only a start makes it follow an axis.
        let after_reset = if before == Axis(3) { Own } else { goes_on };
        assert_eq!([-1, 0, 1].map(|pulsacc| before.after_reset(&of(pulsacc, 200))), [Direct, Off, after_reset]);
    }
}

/// It stops at once at its position, and starts again from rest.
#[test]
fn when_off_it_is_at_rest() {
    let (mut master, parameters, mut lead) = running(1_000_000, 1_000_000_000);
    (0..10).for_each(|_| master.step(&parameters, Position::ZERO, MS, &mut lead));
    let position = lead.position;
    assert_eq!((position, lead.velocity), (Position::whole(10_000), 1e6));
    assert!(master.is_sound(&parameters, 0));
    master.take(VirtualSource::Off, &mut lead);
    assert_eq!(lead, Lead { position, valid: true, ..Lead::default() });
    assert!(master.is_sound(&parameters, 0));
    assert!(!VirtualMaster { rate: 1, ..master }.is_sound(&parameters, 0));
    assert!(!VirtualMaster { rest: -1, ..master }.is_sound(&parameters, 0));
    assert!(!VirtualMaster { source: VirtualSource::Own, ..master }.is_sound(&MachineParameters::default(), 0));
    let axis = VirtualMaster { source: VirtualSource::Axis(2), ..master };
    assert_eq!([2, 3].map(|axes| axis.is_sound(&parameters, axes)), [false, true]);
}

fn counted(distance: i64, places: &[i64]) -> (i64, i64) {
    let mut master = VirtualMaster::default();
    for pair in places.windows(2) {
        let [from, to] =
            [pair[0], pair[1]].map(|thousandths| Position::from_raw((i128::from(thousandths) << 32) / 1_000));
        let lead = Lead { position: to, change: to - from, valid: true, ..Lead::default() };
        master.count_pulses(distance, &lead);
    }
    (master.count, master.mark.floor())
}

/// Positions in thousandths of an inc.
///
/// Proves: MACS-VM-06
#[test]
fn pulses_are_come_to_from_either_side() {
    // From 0, which is not reached but left, to the first pulse, beyond it, and back.
    assert_eq!(counted(500, &[0, 499_999]), (0, 0));
    assert_eq!(counted(500, &[0, 500_000]), (1, 500));
    assert_eq!(counted(500, &[0, 500_000, 500_500]), (1, 500));
    assert_eq!(counted(500, &[0, 500_500, 499_500]), (2, 500));
    assert_eq!(counted(500, &[0, 500_500, 500_000, 499_500]), (2, 500));
    // Two pulses, then 0 and -500.
    assert_eq!(counted(500, &[0, 1_200_000]), (2, 1_000));
    assert_eq!(counted(500, &[0, 1_200_000, -600_000]), (2 + 4, -500));
    // It reverses on the pulse, which is reached once.
    assert_eq!(counted(500, &[100, 500_000, 100]), (1, 500));
    assert_eq!(counted(0, &[0, 1_000_000]), (0, 0));
}

/// Proves: MACS-VM-07
#[test]
fn edges_and_latches_use_the_position_of_their_time() {
    let lead = Lead { position: Position::whole(100), change: Position::whole(10), valid: true, ..Lead::default() };
    let counted = |vmencmtyp, levels: &[bool]| {
        let parameters = MachineParameters { vmencmtyp, ..MachineParameters::default() };
        let mut master = VirtualMaster::default();
        levels.iter().for_each(|&level| master.count_level(&parameters, level, &lead));
        (master.count, master.mark.floor())
    };
    // The first level is no edge.
    assert_eq!(counted(12, &[true, true]), (0, 0));
    assert_eq!(counted(12, &[true, false, true, true]), (1, 100));
    assert_eq!(counted(13, &[true, false, true, false]), (2, 100));
    assert_eq!(counted(0, &[true, false, true]), (0, 0));
    // Nor is the first level of another input.
    let mut master = VirtualMaster::default();
    let of = |vmencmtyp| MachineParameters { vmencmtyp, ..MachineParameters::default() };
    master.count_level(&of(12), false, &lead);
    master.count_level(&of(22), true, &lead);
    assert_eq!(master.count, 0);
    // A quarter of a cycle before: 2.5 inc back.
    master.count_latches([250_000].into_iter(), MS, &lead);
    assert_eq!((master.count, master.mark), (1, Position::from_raw((97 << 32) + (1 << 31))));
    master.count_latches([200_000].into_iter(), MS, &lead);
    assert_eq!((master.count, master.mark), (2, Position::whole(98)));
    master.count_latches(std::iter::empty(), MS, &lead);
    assert_eq!((master.count, master.mark), (2, Position::whole(98)));
}

/// In any order: the newest latch, 1 inc before the end of the cycle, is the last mark.
///
/// Proves: MACS-VM-07
#[test]
fn of_several_latches_the_newest_is_the_mark() {
    let lead = Lead { position: Position::whole(100), change: Position::whole(10), valid: true, ..Lead::default() };
    for ages in [[100_000, 500_000, 900_000], [900_000, 500_000, 100_000], [500_000, 100_000, 900_000]] {
        let mut master = VirtualMaster::default();
        master.count_latches(ages.into_iter(), MS, &lead);
        assert_eq!((master.count, master.mark), (3, Position::whole(99)), "{ages:?}");
    }
}

proptest! {
    /// In each cycle the velocity approaches the setpoint by exactly pulsacc T at most, and the position is the sum of
    /// all changes, rounded once.
    ///
    /// Proves: MACS-VM-02
    #[test]
    fn no_cycle_changes_the_velocity_by_more_than_the_ramp(
        asked in prop::collection::vec((-1_000_000_i64..=1_000_000, 1_i64..=100_000_000, 1_usize..40), 1..12),
        cycle_ns in prop::sample::select(vec![125_000_u64, 333_333, 1_000_000, 20_000_000]),
    ) {
        let (mut master, _, mut lead) = running(0, 1);
        // Velocities in 10^-9 inc/s, distances in 10^-18 inc.
        let (mut velocity, mut way) = (0_i128, 0_i128);
        for (pulsvel, pulsacc, cycles) in asked {
            let parameters = MachineParameters { pulsvel, pulsacc, ..MachineParameters::default() };
            for _ in 0..cycles {
                let step = i128::from(pulsacc) * i128::from(cycle_ns);
                let left = i128::from(pulsvel) * 1_000_000_000 - velocity;
                velocity += if left.abs() <= step { left } else { step * left.signum() };
                way += velocity * i128::from(cycle_ns);
                let before = lead;
                master.step(&parameters, Position::ZERO, cycle_ns, &mut lead);
                prop_assert_eq!(lead.position.raw(), (way << 32).div_euclid(1_000_000_000_000_000_000));
                prop_assert_eq!(before.position + lead.change, lead.position);
                prop_assert!((lead.velocity - velocity as f64 / 1e9).abs() <= 1e-9 * lead.velocity.abs());
                let most = pulsacc as f64 * cycle_ns as f64 / 1e9;
                prop_assert!((lead.velocity - before.velocity).abs() <= most * (1.0 + 1e-9) + 1e-9);
            }
        }
        let parameters = MachineParameters { pulsacc: 1, ..MachineParameters::default() };
        prop_assert!(master.is_sound(&parameters, 0));
    }

    /// Once the ramp has reached the axis, it is followed exactly, to the unit; the distance lost before remains lost.
    ///
    /// Proves: MACS-VM-03
    #[test]
    fn an_axis_that_no_ramp_holds_back_is_followed_exactly(
        changes in prop::collection::vec(-(1_i64 << 40)..(1_i64 << 40), 1..60),
        slow in 1_i64..1_000,
    ) {
        let (mut master, mut parameters, mut lead) = running(0, slow);
        master.take(VirtualSource::Axis(0), &mut lead);
        for _ in 0..7 {
            master.step(&parameters, Position::from_raw(1 << 62), MS, &mut lead);
        }
        // 2^30 inc/s^2 is 2^30 / 10^6 inc more in each cycle, above 2 * 2^40 / 2^32.
        parameters.pulsacc = (1 << 30) - 1;
        for _ in 0..3 {
            master.step(&parameters, Position::ZERO, MS, &mut lead);
        }
        for change in changes {
            let change = Position::from_raw(change.into());
            master.step(&parameters, change, MS, &mut lead);
            prop_assert_eq!(lead.change, change);
        }
    }

    /// With any input the resulting state is valid.
    #[test]
    fn nothing_makes_it_panic(raw: i128, position: i128, pulsvel: i64, distance in 0_i64..=65_535, age: u32) {
        let (mut master, parameters, mut lead) = running(pulsvel.clamp(-(1 << 30), 1 << 30), 1 << 30);
        master.take(VirtualSource::Axis(0), &mut lead);
        lead.position = Position::from_raw(position);
        for cycle_ns in [125_000, 20_000_000] {
            master.step(&parameters, Position::from_raw(raw), cycle_ns, &mut lead);
            master.count_pulses(distance, &lead);
            master.count_latches([age].into_iter(), cycle_ns, &lead);
            prop_assert!(master.is_sound(&parameters, 1));
        }
    }
}
