//! Laws of the positioning for all sets and inputs.

use super::*;
use proptest::prelude::*;

/// Event of a call.
#[derive(Clone, Debug)]
enum Happening {
    Inputs(u8),
    Travel(i64),
    Velocity(i64),
    Ramps(i64, i64),
    Words(i64, i64),
    Calls(usize),
}

fn happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        4 => (0_u8..4).prop_map(Happening::Inputs),
        1 => prop_oneof![-3000_i64..3000, Just(0)].prop_map(Happening::Travel),
        1 => (1_i64..20_000_000).prop_map(Happening::Velocity),
        1 => (1_000_i64..1_000_000, 0_i64..1_000_000).prop_map(|(up, more)| Happening::Ramps(up, up + more)),
        1 => (-100_i64..3000, -100_i64..1200).prop_map(|(velocity, acceleration)| Happening::Words(velocity, acceleration)),
        3 => (1_usize..80).prop_map(Happening::Calls),
    ]
}

proptest! {
    /// From any state: the end is the sum of the orders, no call is faster than the velocity before or the target, and
    /// no call changes the velocity by more than a ramp, except where a flatter ramp would pass the end.
    #[test]
    fn orders_end_exactly_at_their_sum(
        retriggers in any::<bool>(),
        resolution in 1_i64..100_000,
        happenings in prop::collection::vec(happening(), 1..60),
    ) {
        let mut bench = started(&[("ba", if retriggers { 8 } else { 0 }), ("travel", 500), ("drive_resolution", resolution)]);
        let (mut inputs, mut before, mut end) = (0, 0, 0);
        for what in happenings.into_iter().chain([Happening::Words(1024, 1024), Happening::Inputs(0), Happening::Inputs(1)]) {
            let mut calls = 1;
            match what {
                Happening::Inputs(bits) => inputs = bits,
                Happening::Travel(travel) => bench.value_new(&[("travel", travel)]),
                Happening::Velocity(velocity) => bench.value_new(&[("velocity", velocity)]),
                Happening::Ramps(up, stop) => bench.value_new(&[("acceleration", up), ("stop_decel", stop)]),
                Happening::Words(velocity, acceleration) => bench.words = [velocity, acceleration],
                Happening::Calls(more) => calls = more,
            }
            for _ in 0..calls {
                let was = bench.epos.clone();
                let goes = inputs & !before & (E1 | E2) == E1;
                before = inputs;
                let adds = goes && (was.phase == Phase::Idle || was.phase == Phase::Run && retriggers);
                if adds {
                    end += bench.epos.live.travel;
                }
                let (sink, outputs) = bench.step(inputs);
                let epos = &bench.epos;
                // The travel of the call: the velocity is 0 at the end.
                let way = whole(epos.position - was.position) + epos.rest - was.rest;
                let from = was.velocity;
                let stops = was.phase == Phase::Stopping || was.phase == Phase::Run && inputs & !was.before & E2 != 0;
                let ramp = if stops { epos.ramps.1 } else { epos.ramps.0 };
                let is_tight = !is_long_enough(from.abs() - ramp, was.left.abs(), ramp);
                prop_assert!((way - from).abs() <= ramp || way.abs() < from.abs() && is_tight, "{:?} {:?}", was, epos);
                let ends = epos.phase == Phase::Idle && way != 0;
                prop_assert!(!ends || way.abs() <= ramp || is_tight, "{:?} {:?}", was, epos);
                let wanted = epos.target_velocity(0, bench.words[0]);
                prop_assert!(way.abs() <= from.abs().max(wanted));
                if epos.phase == Phase::Idle {
                    prop_assert_eq!((sink, outputs), (end, A1));
                    prop_assert_eq!(epos.rest, 0);
                }
            }
        }
        bench.is_sound();
        // At 100 % every order ends: a stopped one continues with the last edge, or another edge starts it again.
        for _ in 0..3 {
            if bench.epos.phase != Phase::Idle {
                bench.run(0, 1);
                if bench.epos.phase == Phase::Run { bench.until_rest(0); }
                if bench.epos.phase == Phase::Halted { bench.step(E1); }
                while !matches!(bench.epos.phase, Phase::Idle | Phase::Halted) { bench.step(0); }
            }
        }
        prop_assert_eq!(bench.epos.phase, Phase::Idle);
        prop_assert_eq!(bench.sink, end);
    }

    /// Fields at their limits, and calls of any length: nothing wraps, and the state stays valid.
    #[test]
    fn sets_at_their_bounds_have_room(
        ba in 0_i64..32,
        travel in prop::sample::select(vec![i64::from(i32::MIN), -1, 1, i64::from(i32::MAX)]),
        velocity in prop::sample::select(vec![i64::from(i32::MIN), 1, i64::from(i32::MAX)]),
        rates in prop::sample::select(vec![(1, 1), (1, STEEPEST), (STEEPEST, STEEPEST)]),
        turns in prop::sample::select(vec![(1, 1), (i64::from(i32::MAX), 1), (1, i64::from(i32::MAX))]),
        call_ns in prop::sample::select(vec![1, 62_500, MS, 9 * MS, u64::MAX]),
        calls in prop::collection::vec((0_u8..4, any::<i64>(), prop::option::of(any::<i64>()), any::<[i64; 2]>()), 1..100),
    ) {
        let mut bench = example(&[
            ("ba", ba), ("sf_cycle", 0), ("travel", travel), ("velocity", velocity), ("acceleration", rates.0), ("stop_decel", rates.1),
            ("drive_resolution", turns.0), ("master_resolution", turns.1),
        ]);
        bench.call_ns = call_ns;
        prop_assume!(bench.checked(&[]).is_ok());
        bench.start(0);
        for (inputs, source, mark, words) in calls {
            (bench.travel, bench.words) = (source, words);
            let seen = bench.seen(inputs, mark);
            let told = bench.epos.step(&seen);
            bench.sink = told.sink;
            bench.is_sound();
        }
    }

    /// A reference at any position, with stops on the way: the motion ends at the travel, counted from the reference.
    #[test]
    fn a_reference_is_the_zero_of_its_end(
        turns_round in any::<bool>(),
        travel in 1_i64..4000,
        behind in -200_i64..600,
        at in 1_usize..60,
        stops in prop::collection::vec(1_usize..120, 0..4),
    ) {
        let mut bench = started(&[("ba", if turns_round { 6 } else { 2 }), ("travel", travel), ("velocity", 1_000_000)]);
        bench.run(E1, at);
        bench.mark(0, behind);
        for calls in stops {
            bench.run(0, calls);
            bench.step(E2);
            while bench.epos.phase == Phase::Stopping { bench.step(0); }
            if bench.epos.phase == Phase::Halted {
                bench.step(0);
                bench.step(E1);
            }
        }
        for _ in 0..2 {
            if bench.epos.phase == Phase::Run { bench.until_rest(0); }
        }
        prop_assert_eq!((bench.sink, bench.epos.phase), (travel, Phase::Idle));
    }
}
