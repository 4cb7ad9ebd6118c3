//! Printing mark control of fipw and xfipw.

use super::*;

/// Proves: AMK-PMC-01, AMK-PMC-06, AMK-PMC-11, AMK-PMC-13, AMK-PMC-16, AMK-PMC-18, AMK-PMC-19, AMK-PMC-21, AMK-PMC-22, AMK-PMC-23, AMK-PMC-O1,
/// AMK-PMC-O2
#[test]
fn a_mark_that_is_late_lengthens_the_way() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    for (weight, total) in [(0, 200), (1, 100), (129, -100), (128, -200), (32, 0), (160 - 1, 0)] {
        let mut bench = fipw(&tables);
        bench.start(&registered(&[("weight", weight)]), 0);
        // At x = 3400 the slave is at 10200 instead of 10000; W is 4000 there. The mark is reported 100 inc later.
        let seen = marked(&mut bench, 3500, 100);
        assert_eq!((seen.sink, seen.deviation, seen.correction), (10_500, 200, 0), "{weight}");
        // SK 15000, LK 2500.
        let at = |bench: &mut Bench<'_, Fipw>, x: i64| {
            let out = bench.step(x - bench.travel, 0);
            assert_eq!(out.sink, 3 * x + out.correction, "{weight} {x}");
            out.correction
        };
        let parts = [15_000, 15_625, 16_250, 17_500, 19_999].map(|x| at(&mut bench, x));
        assert_eq!(parts, [0, total / 4, total / 2, total, total], "{weight}");
        // The correction stays, and without a mark the deviation is 0.
        assert_eq!(at(&mut bench, 20_000 + 17_000), total);
        assert_eq!((at(&mut bench, 40_100), bench.step(0, 0).deviation), (total, 0));
    }
}

/// Proves: AMK-PMC-14, AMK-PMC-15, AMK-PMC-20
#[test]
fn a_mark_behind_the_window_waits_for_the_next_one() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let with = |more: &[(&'static str, i64)]| {
        let mut bench = fipw(&tables);
        bench.start(&registered(&[&[("corr_start", 1000), ("corr_length", 0)], more].concat()), 0);
        bench
    };
    let mut bench = with(&[]);
    assert_eq!(marked(&mut bench, 3500, 100).correction, 0);
    // LK = 0: the whole correction in the first call at or after SK. A second mark of the pass is ignored.
    assert_eq!(marked(&mut bench, 1, 3).correction, 0);
    assert_eq!([16_400, 1000, 99, 1].map(|way| bench.step(way, 0).correction), [0, 0, 200, 200]);
    // Every second mark.
    let mut bench = with(&[("count_n", 2)]);
    let mut pass = || (marked(&mut bench, 3400, 0).correction, bench.step(16_600, 0).correction);
    assert_eq!([pass(), pass(), pass(), pass()], [(0, 0), (0, 0), (200, 200), (200, 200)]);
    // A step over the whole window.
    let mut bench = with(&[("corr_start", 18_000)]);
    assert_eq!((marked(&mut bench, 3400, 0).correction, bench.step(40_000, 0).correction), (0, 200));
}

/// Proves: AMK-PMC-24
#[test]
fn a_correction_stands_behind_the_compensation_or_before_it() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let shares = [1, 3].map(|function| {
        let mut bench = fipw(&tables);
        bench.start(&registered(&[("function", function), ("sak", 128)]), 0);
        marked(&mut bench, 3400, 0);
        bench.step(11_600, 0);
        // 625 inc: 1875 of the table, 50 of the correction.
        bench.step(625, 0).sak_share
    });
    assert_eq!(shares, [1875, 1925]);
}

/// Proves: AMK-PMC-03, AMK-PMC-05, AMK-PMC-12
#[test]
fn marks_have_modes_and_bounds() {
    let tables = [y(&[0, 1000])];
    let field = |name: &str| fipw::FIELDS.iter().position(|field| field.name == name).map(|place| place as u16);
    let of = |more: &[(&str, i64)]| fipw(&tables).refused(&registered(more)).map(|fault| (fault.code, fault.field));
    assert_eq!(of(&[]), None);
    assert_eq!(of(&[("mode", 98)]), None);
    for more in [&[("mode", 82)][..], &[("mode", 26)], &[("function", 5)], &[("function", 2)]] {
        assert_eq!(of(more), Some((Code::AMK_MODE_FIELD, field("function"))), "{more:?}");
    }
    for (name, value) in [
        ("format_length", 0),
        ("sync_shift", 3000),
        ("valid_range", 1501),
        ("corr_start", 20_001),
        ("corr_length", 20_001),
        ("weight", 33),
        ("weight", 160),
    ] {
        assert_eq!(of(&[(name, value)]), Some((Code::AMK_BEYOND, field(name))), "{name}");
    }
    let words = set(fipw::FIELDS, &registered(&[]));
    let bench = fipw(&tables);
    let blind = Setting { has_mark: false, ..setting(bench.call_ns, bench.found()) };
    assert_eq!(bench.function.check(Words(&words), &blind).map_err(|fault| fault.code), Err(Code::AMK_NO_ZERO_PULSE));
}

/// Proves: AMK-XFIPW-69, AMK-XFIPW-72, AMK-XFIPW-73, AMK-XFIPW-74, AMK-XFIPW-76, AMK-XFIPW-77, AMK-XFIPW-81, AMK-XFIPW-87, AMK-XFIPW-O8
#[test]
fn the_extended_control_tells_valid_marks_and_takes_other_values_while_it_runs() {
    let tables = [xy(&[(0, 0), (10_000, 15_000), (20_000, 30_000)])];
    let values = |more: &[(&'static str, i64)]| {
        let set = [
            ("function", 1),
            ("incr_per_rev", 0),
            ("format_length", 3000),
            ("sensor_distance", 1000),
            ("valid_range", 200),
        ];
        extended(2, &[&set[..], more].concat())
    };
    let tables = [xy(&[(0, 0), (19_000, 28_500), (20_000, 30_000)]), tables[0].clone()];
    // The points are too far apart for one table: it takes more of them.
    assert_eq!(xfipw(&tables[..1]).refused(&values(&[])).map(|fault| fault.code), None);
    for (weight, total) in [(0, 400), (1, 200), (129, -200), (32, 0)] {
        let mut bench = xfipw(&tables[..1]);
        bench.start(&values(&[("corr_weight", weight)]), 0);
        assert_eq!(marked(&mut bench, 13_600, 0).deviation, 400);
        assert_eq!([1400, 2500, 2499].map(|way| bench.step(way, 0).correction), [0, total, total]);
        let out = bench.step(1, 0);
        assert_eq!((out.outputs, out.writes, out.deviation), (1, 1, 400));
        // 17998.5 is outside 18000 to 22000, the ends are inside.
        marked(&mut bench, 11_999, 0);
        let out = bench.step(8001, 0);
        assert_eq!((out.outputs, out.deviation, out.correction), (0, 0, total));
        // The position of the mark is shifted by 50 units of 10 inc.
        let words = set(xfipw::FIELDS, &values(&[("corr_weight", weight), ("sync_shift", 50)]));
        bench.function.apply_values(Words(&words));
        assert_eq!(marked(&mut bench, 13_600, 0).deviation, -100);
    }
}

/// Proves: AMK-XFIPW-75, AMK-XFIPW-79
#[test]
fn the_extended_control_counts_marks_and_has_both_places() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let set = |more: &[(&'static str, i64)]| {
        let set = [
            ("function", 1),
            ("incr_per_rev", 20_000),
            ("format_length", 3000),
            ("sensor_distance", 2500),
            ("corr_start", 4000),
        ];
        extended(2, &[&set[..], more].concat())
    };
    let mut bench = xfipw(&tables);
    bench.start(&set(&[("corr_every", 3)]), 0);
    let passes: Vec<_> = (0..4).map(|_| (marked(&mut bench, 3400, 0), bench.step(16_600, 0).correction).1).collect();
    assert_eq!(passes, [0, 0, 200, 200]);
    let shares = [1, 3].map(|function| {
        let mut bench = xfipw(&tables);
        bench.start(&set(&[("function", function), ("sak_factor", 256)]), 0);
        marked(&mut bench, 3400, 0);
        bench.step(600, 0).sak_share
    });
    assert_eq!(shares, [3600, 4000]);
}

/// Proves: AMK-FIPW-O6, AMK-PMC-04, AMK-SYNC-03, AMK-XFIPW-70, AMK-XFIPW-125
#[test]
fn the_set_of_the_manual_is_one_on_a_source_with_marks() {
    let tables = [y(&[0, 300]), y(&[0, 3000]), y(&[0, 300])];
    let set_of_it = [
        ("function", 1),
        ("mode", 98),
        ("sf_cycle", 4),
        ("table_count", 3),
        ("start_tables", 1),
        ("mult", 1),
        ("increments_per_rev", 20_000),
        ("format_length", 3000),
        ("sensor_distance", 1000),
        ("valid_range", 200),
        ("corr_start", 5000),
        ("corr_length", 10_000),
    ];
    let mut bench = fipw(&tables);
    bench.call_ns = 2_000_000;
    assert_eq!(bench.refused(&set_of_it), None);
    let words = set(fipw::FIELDS, &set_of_it);
    let without = |has_source, has_mark| {
        let setting = Setting { has_source, has_mark, ..setting(bench.call_ns, bench.found()) };
        bench.function.check(Words(&words), &setting).map_err(|fault| fault.code)
    };
    assert_eq!(without(true, false), Err(Code::AMK_NO_ZERO_PULSE));
    assert_eq!(without(false, false), Err(Code::AMK_NO_SOURCE));
}

#[test]
fn the_ends_of_the_valid_range_belong_to_it() {
    let tables = [xy(&[(0, 0), (19_000, 28_500), (20_000, 30_000)])];
    let set = [
        ("function", 1),
        ("incr_per_rev", 0),
        ("format_length", 3000),
        ("sensor_distance", 1000),
        ("valid_range", 200),
    ];
    for (x, deviation) in [(11_999, 0), (12_000, -2000), (14_666, 1999), (14_667, 0)] {
        let mut bench = xfipw(&tables);
        bench.start(&extended(2, &set), 0);
        assert_eq!(marked(&mut bench, x, 0).deviation, deviation, "{x}");
    }
}

#[test]
fn a_correction_keeps_the_window_that_it_began_with() {
    let tables = [xy(&[(0, 0), (19_000, 28_500), (20_000, 30_000)])];
    let set_of = |window: [(&'static str, i64); 2]| {
        let set = [("function", 1), ("incr_per_rev", 0), ("format_length", 3000), ("sensor_distance", 1000)];
        extended(2, &[&set[..], &window].concat())
    };
    for (x, there) in [(16_250, 200), (17_600, 400)] {
        let mut bench = xfipw(&tables);
        bench.start(&set_of([("corr_start", 15_000), ("corr_len", 2500)]), 0);
        marked(&mut bench, 13_600, 0);
        assert_eq!(bench.step(x - 13_600, 0).correction, there);
        let words = set(xfipw::FIELDS, &set_of([("corr_start", 19_000), ("corr_len", 1000)]));
        bench.function.apply_values(Words(&words));
        assert_eq!(bench.step(0, 0).correction, there);
        // The end of its own window; the next correction has the new window.
        assert_eq!([17_600 - x, 2399, 1].map(|way| bench.step(way, 0).correction), [400; 3]);
        marked(&mut bench, 13_600, 0);
        assert_eq!([5400, 500, 500].map(|way| bench.step(way, 0).correction), [400, 600, 800]);
    }
}

#[test]
fn master_oscillating_at_zero_loses_no_mark() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let mut bench = fipw(&tables);
    bench.start(&registered(&[("corr_start", 1000), ("corr_length", 0)]), 0);
    marked(&mut bench, 3400, 0);
    let seen = [16_603, -5, 5, 996, 1].map(|way| bench.step(way, 0)).map(|out| (out.deviation, out.correction));
    assert_eq!(seen, [(200, 0), (200, 0), (200, 0), (200, 0), (200, 200)]);
    // A correction that is removed by moving back before its window is applied again in it.
    let mut bench = fipw(&tables);
    bench.start(&registered(&[]), 0);
    marked(&mut bench, 3400, 0);
    let seen = [14_200, -17_610, 17_610, 2400, 17_600].map(|way| bench.step(way, 0).correction);
    assert_eq!(seen, [200, 0, 200, 200, 200]);
}

#[test]
fn a_mark_counts_in_the_call_in_which_its_pass_begins_or_ends() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let set = [("function", 1), ("incr_per_rev", 20_000), ("format_length", 3000), ("sensor_distance", 2500)];
    // At the end: 10 inc before it; 59970 on the slave has the setpoint 10000, and is 10030 before that of the next
    // turn.
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &set), 0);
    bench.step(0, 1);
    bench.step(19_950, 1);
    let out = marked(&mut bench, 100, 60);
    assert_eq!((out.outputs, out.deviation, out.sink), (0b11, -10_030, 60_000));
    // At the beginning: 20 inc after it.
    let mut bench = fipw(&tables);
    bench.start(&registered(&[("mode", 98), ("valid_range", 0)]), 0);
    bench.step(19_950, 0);
    bench.travel += 100;
    let out = bench.function.step(&bench.seen(1, Some(bench.travel - 30)));
    assert_eq!((out.sink, out.deviation), (150, 60 - 10_000));
}
