//! Oracles of xfipw, and its differences from fipw.

use super::*;

/// Proves: AMK-XFIPW-13, AMK-XFIPW-26, AMK-XFIPW-40, AMK-XFIPW-O1
#[test]
fn both_forms_run_through_the_same_curve() {
    let places: Vec<_> = T.iter().enumerate().map(|(i, y)| (2500 * i as i64, *y)).collect();
    let (even, uneven) = ([y(&T)], [xy(&places)]);
    let (mut a, mut b) = (xfipw(&even), xfipw(&uneven));
    a.start(&extended(2, &[("incr_per_rev", 20_000)]), 0);
    b.start(&extended(2, &[("incr_per_rev", 0)]), 0);
    for (x, sink) in
        [(3750, 1250), (10_000, 4000), (11_250, 6000), (20_000, 20_000), (22_500, 21_000), (45_000, 41_500)]
    {
        let way = x - a.travel;
        assert_eq!((a.step(way, 0).sink, b.step(way, 0).sink), (sink, sink), "{x}");
    }
    let mut scaled = xfipw(&even);
    scaled.start(&extended(2, &[("incr_per_rev", 20_000), ("mult", 3), ("div_exp", 1)]), 0);
    assert_eq!((scaled.step(3750, 0).sink, scaled.step(6250, 0).sink), (1875, 6000));
}

/// Proves: AMK-XFIPW-44, AMK-XFIPW-64, AMK-XFIPW-65, AMK-XFIPW-66, AMK-XFIPW-88, AMK-XFIPW-O3
#[test]
fn slave_starts_at_position_of_master() {
    let tables = [y(&T)];
    let mut bench = xfipw(&tables);
    bench.call_ns = 4 * HALF;
    let values =
        |offset| extended(2, &[("function", 8), ("sf_cycle", 4), ("incr_per_rev", 20_000), ("master_offset", offset)]);
    let read = |bench: &Bench<'_, Xfipw>, offset| {
        let words = set(xfipw::FIELDS, &values(offset));
        bench
            .function
            .read(Words(&words), &setting(bench.call_ns, bench.found()))
            .map(|found| found.map(|(_, value)| value))
    };
    assert_eq!(read(&bench, 10_000), Ok(Some(4000)));
    // Y(-x) = Y(Xme - x) - Ye.
    assert_eq!(read(&bench, -10_000), Ok(Some(4000 - 20_000)));
    assert_eq!(bench.start(&values(10_000), 0).sink, 0);
    assert_eq!(bench.step(1250, 0).sink, 2000);
    // 1250 behind the master.
    let mut bench = xfipw(&tables);
    bench.sink = 7;
    bench.start(&extended(2, &[("function", 8), ("incr_per_rev", 20_000), ("master_offset", -1250)]), 0);
    assert_eq!((bench.step(1250, 0).sink, bench.step(1250, 0).sink), (7 + 2500, 7 + 3000));
}

/// Proves: AMK-XFIPW-37, AMK-XFIPW-45, AMK-XFIPW-48, AMK-XFIPW-49, AMK-XFIPW-67, AMK-XFIPW-68, AMK-XFIPW-27, AMK-XFIPW-39
#[test]
fn a_movement_takes_its_passes_and_a_stored_edge_the_next_one() {
    let tables = [y(&[0, 100])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("work_cycles", 2)]), 0);
    // An edge while it runs is ignored.
    let calls = [(9, 1), (150, 0), (40, 1), (20, 1), (20, 1), (0, 0), (0, 1), (5, 1)];
    let wanted = [(0, 0), (150, 0), (190, 0), (200, 1), (200, 1), (200, 1), (200, 0), (205, 0)];
    assert_eq!(bench.run(&calls), wanted);
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("function", 16)]), 0);
    // The edge is stored, and E1 is 1 at the end: the next movement follows without a rest, at the distance of x beyond
    // the end.
    let calls = [(0, 1), (50, 0), (30, 1), (30, 1), (50, 0), (20, 1), (10, 0), (20, 0)];
    let wanted = [(0, 0), (50, 0), (80, 0), (110, 0), (160, 0), (180, 0), (190, 0), (200, 1)];
    assert_eq!(bench.run(&calls), wanted);
}

/// Proves: AMK-XFIPW-29, AMK-XFIPW-46, AMK-XFIPW-47, AMK-XFIPW-50, AMK-XFIPW-51, AMK-XFIPW-52, AMK-XFIPW-53
#[test]
fn a_level_alone_clocks_nothing_in_again() {
    let tables = [y(&[0, 50]), y(&[0, 100]), y(&[0, 40])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(98, &[("tables_total", 3), ("tables_start", 1)]), 0);
    // E1 falls before the zero: the start is cancelled.
    assert_eq!(bench.run(&[(50, 1), (20, 0), (40, 0), (90, 1)]), [(0, 1), (0, 1), (0, 1), (0, 0)]);
    assert_eq!(
        bench.run(&[(100, 1), (100, 0), (50, 1), (50, 1), (100, 1)]),
        [(50, 0), (150, 0), (170, 0), (190, 1), (190, 1)]
    );
    assert_eq!(bench.run(&[(0, 0), (0, 1), (100, 1)]), [(190, 1), (190, 0), (240, 0)]);
}

/// Proves: AMK-XFIPW-56, AMK-XFIPW-57, AMK-XFIPW-58, AMK-XFIPW-59, AMK-XFIPW-60
#[test]
fn inputs_switch_the_set_where_the_table_is_repeated() {
    let tables = [y(&[0, 100]), y(&[0, 200]), y(&[0, 300])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(3, &[]), 0);
    // E1 enables, E2 and E3 select: set 1 from the next zero on.
    assert_eq!(bench.run(&[(50, 0), (10, 0b011), (40, 0b011), (50, 0b011)]), [(50, 0), (60, 0), (100, 1), (200, 1)]);
    // Set 2, in one step over two zeros; set 3 does not exist.
    assert_eq!(bench.run(&[(200, 0b101), (50, 0b111), (50, 0b111)]), [(750, 1), (900, 0), (1050, 0)]);
    // Without enable the set is kept.
    assert_eq!(bench.run(&[(100, 0)]), [(1350, 0)]);
}

/// Proves: AMK-XFIPW-O7
#[test]
fn sets_are_whole() {
    let tables: Vec<Arc<Table>> = (0..8).map(|n| y(&[0, n])).collect();
    let refused = |count: usize, ba, more: &[(&str, i64)]| {
        xfipw(&tables[..count]).refused(&extended(ba, more)).map(|fault| fault.code)
    };
    let three = [("tables_total", 3), ("tables_start", 1)];
    assert_eq!(refused(6, 99, &three), None);
    assert_eq!(refused(7, 99, &three), Some(Code::AMK_TABLE_SETS));
    assert_eq!(refused(7, 98, &three), None);
    assert_eq!(refused(2, 99, &three), Some(Code::AMK_TABLES_FEW));
    assert_eq!(refused(8, 3, &[]), None);
}

/// Proves: AMK-XFIPW-92, AMK-XFIPW-97, AMK-XFIPW-122, AMK-XFIPW-123, AMK-XFIPW-16, AMK-XFIPW-24
#[test]
fn field_unused_by_extended_mode_is_refused() {
    let (many, more): (Vec<i64>, Vec<i64>) = ((0..2000).collect(), (0..2001).collect());
    let places: Vec<(i64, i64)> = (0..1001).map(|i| (i, i)).collect();
    let one = |table: Arc<Table>, values: &[(&str, i64)]| xfipw(&[table]).refused(values).map(|fault| fault.code);
    assert_eq!(one(y(&many), &extended(2, &[])), None);
    assert_eq!(one(y(&more), &extended(2, &[])), Some(Code::AMK_CURVE_POINTS));
    assert_eq!(one(xy(&places[..1000]), &extended(2, &[("incr_per_rev", 0)])), None);
    assert_eq!(one(xy(&places), &extended(2, &[("incr_per_rev", 0)])), Some(Code::AMK_CURVE_POINTS));
    assert_eq!(one(xy(&[(0, 0), (49, 5)]), &extended(2, &[])), Some(Code::AMK_CURVE_LENGTH));
    assert_eq!(one(xy(&[(0, 0), (32_768, 5)]), &extended(2, &[])), Some(Code::AMK_CURVE_LENGTH));
    for (ba, name, value, code) in [
        (24, "mult", 1, Code::AMK_NO_MODE),
        (2, "function", 16, Code::AMK_MODE_FIELD),
        (26, "function", 8, Code::AMK_MODE_FIELD),
        (82, "function", 32, Code::AMK_MODE_FIELD),
        (2, "work_cycles", 2, Code::AMK_MODE_FIELD),
        (26, "tables_start", 1, Code::AMK_MODE_FIELD),
        (26, "master_offset", -1, Code::AMK_MODE_FIELD),
        (82, "stop_angle", 1, Code::AMK_MODE_FIELD),
        (2, "master_offset", 100, Code::AMK_BEYOND),
        (2, "master_offset", -100, Code::AMK_BEYOND),
        (98, "stop_angle", 100, Code::AMK_BEYOND),
    ] {
        assert_eq!(one(y(&[0, 1]), &extended(ba, &[(name, value)])), Some(code), "{ba} {name}");
    }
}

/// Proves: AMK-XFIPW-28, AMK-XFIPW-38, AMK-XFIPW-34, AMK-XFIPW-43
#[test]
fn a_sequence_repeats_its_working_table_and_a_last_one_ends_with_its_pass() {
    let tables = [y(&[0, 10]), y(&[0, 100]), y(&[0, 30])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(82, &[("tables_total", 3), ("tables_start", 1), ("work_cycles", 2)]), 0);
    // The edge is kept while E1 falls again; the first table, the working table twice, the last table.
    let calls = [(40, 1), (30, 0), (30, 0), (100, 0), (100, 0), (100, 0), (50, 0), (50, 0), (100, 0)];
    let wanted = [(0, 1), (0, 1), (0, 0), (10, 0), (110, 0), (210, 0), (225, 0), (240, 1), (240, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // Without stop tables the window ends nothing: the pass runs to its end.
    let mut bench = xfipw(&tables[..2]);
    bench.start(&extended(98, &[("tables_total", 2), ("tables_start", 1), ("stop_angle", 60)]), 0);
    assert_eq!(
        bench.run(&[(0, 1), (100, 1), (50, 0), (49, 0), (1, 0)]),
        [(0, 0), (10, 0), (60, 0), (109, 0), (110, 1)]
    );
}

/// Proves: AMK-XFIPW-30, AMK-XFIPW-31, AMK-XFIPW-32, AMK-XFIPW-33, AMK-XFIPW-106
#[test]
fn modes_by_time_are_those_by_way_with_the_calls_as_master() {
    let tables = [y(&[0, 10]), y(&[0, 100]), y(&[0, 30])];
    let several = [("tables_total", 3), ("tables_start", 1)];
    for (way, time, more) in
        [(2, 4, &[][..]), (26, 132, &[("work_cycles", 3)]), (82, 84, &several), (98, 100, &several)]
    {
        let values = |ba, length: (&'static str, i64)| {
            let mut values = extended(ba, more);
            values.retain(|(name, _)| *name != "incr_per_rev");
            values.push(length);
            values
        };
        // 25 half milliseconds in calls of 2; the same as 50 inc in steps of 4.
        let (mut by_way, mut by_time) = (xfipw(&tables), xfipw(&tables));
        by_way.start(&values(way, ("incr_per_rev", 50)), 0);
        by_time.start(&values(time, ("cycle_time", 25)), 0);
        for call in 0..200_i64 {
            let e1 = u8::from(call % 70 > 8 && call % 70 < 40);
            let (a, b) = (by_way.step(4, e1), by_time.step(0, e1));
            assert_eq!((a.sink, a.outputs), (b.sink, b.outputs), "{time}: call {call}");
        }
        assert_ne!(by_time.sink, 0, "{time}");
    }
}

/// Proves: AMK-XFIPW-35, AMK-XFIPW-36
#[test]
fn windows_are_those_of_the_tables_that_they_belong_to() {
    // Tables of 100 (start), 200 (working) and 60 (stop).
    let tables = [xy(&[(0, 0), (100, 50)]), xy(&[(0, 0), (200, 200)]), xy(&[(0, 0), (60, 30)])];
    let values =
        [("tables_total", 3), ("tables_start", 1), ("incr_per_rev", 0), ("start_angle", 20), ("stop_angle", 150)];
    let mut bench = xfipw(&tables);
    bench.start(&extended(98, &values), 0);
    // x = 20 is in the window; the sink catches up 10 of 50.
    assert_eq!(bench.run(&[(20, 0), (0, 1), (80, 1)]), [(0, 1), (10, 0), (50, 0)]);
    // x = 150 of the working table, then E1 = 0: that is 30 of the stop table.
    assert_eq!(bench.run(&[(150, 1), (0, 0), (30, 0)]), [(200, 0), (65, 0), (80, 1)]);
    assert_eq!(
        xfipw(&tables).refused(&extended(98, &[&values[..4], &[("stop_angle", 200)]].concat())).map(|fault| fault.code),
        Some(Code::AMK_BEYOND)
    );
}

/// Proves: AMK-XFIPW-41, AMK-XFIPW-42, AMK-XFIPW-61
#[test]
fn an_extended_movement_waits_for_the_zero_of_its_master() {
    let tables = [y(&[0, 1000])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("function", 4)]), 0);
    // No movement before the pulse, and the edge has to follow it.
    assert_eq!(bench.run(&[(30, 1), (30, 0)]), [(0, 1), (0, 1)]);
    marked(&mut bench, 10, 5);
    assert_eq!(bench.run(&[(0, 1), (10, 1)]), [(0, 0), (100, 0)]);
    // x is set at the pulse: only the travel of the master after it moves the slave.
    let mut bench = xfipw(&tables);
    bench.start(&extended(2, &[("function", 12), ("master_offset", 40)]), 0);
    assert_eq!((bench.step(30, 0).sink, marked(&mut bench, 10, 4).sink, bench.step(6, 0).sink), (0, 40, 100));
}

/// Proves: AMK-XFIPW-02, AMK-XFIPW-03, AMK-XFIPW-04, AMK-XFIPW-23, AMK-TAB-04
#[test]
fn eight_tables_of_both_forms_run_one_after_the_other() {
    let tables: Vec<Arc<Table>> = (1..=8)
        .map(|n| if n % 2 == 0 { y(&[0, 5 * n, 10 * n]) } else { xy(&[(0, 0), (30, 5 * n), (50 * n, 10 * n)]) })
        .collect();
    let mut bench = xfipw(&tables);
    bench.start(&extended(82, &[("tables_total", 8), ("tables_start", 7), ("incr_per_rev", 60)]), 0);
    bench.step(0, 1);
    let mut ends = Vec::new();
    for n in 1..=8 {
        ends.push(bench.step(if n % 2 == 0 { 60 } else { 50 * n }, 0).sink);
    }
    assert_eq!(ends, [10, 30, 60, 100, 150, 210, 280, 360]);
    assert_eq!(bench.step(0, 0).outputs, 1);
}

/// Proves: AMK-XFIPW-17, AMK-XFIPW-19, AMK-XFIPW-21, AMK-XFIPW-22, AMK-XFIPW-71, AMK-XFIPW-82, AMK-XFIPW-85, AMK-XFIPW-124, AMK-XFIPW-126
#[test]
fn tables_and_marks_of_the_extended_type_have_their_ranges() {
    // The largest table: 2000 points of 32767 inc each.
    let high: Vec<i64> = (0..2000).map(|i| i * 32_767).collect();
    let one = |table: Arc<Table>, values: &[(&str, i64)]| xfipw(&[table]).refused(values).map(|fault| fault.code);
    assert_eq!(one(y(&high), &extended(2, &[])), None);
    assert_eq!(one(xy(&[(0, 0), (32_767, -32_767)]), &extended(2, &[("incr_per_rev", 0)])), None);
    assert_eq!(
        one(Arc::new(Table::new(Form::Words, &[], &[3, 0]).expect("words")), &extended(2, &[])),
        Some(Code::AMK_CURVE_FORM)
    );
    // By time, a last position of 1 is long enough.
    let time = [("ba", 4), ("mult", 1), ("tables_total", 1)];
    assert_eq!(one(xy(&[(0, 0), (1, 5)]), &time), None);
    // Format and sensor are enough for marks; sak may be 0. Not by time, not with sets.
    let marks = [("function", 1), ("format_length", 3000), ("sensor_distance", 1000)];
    for (ba, code) in [(2, None), (26, None), (82, None), (98, None), (3, Some(Code::AMK_MODE_FIELD))] {
        assert_eq!(one(y(&[0, 1000]), &extended(ba, &marks)), code, "{ba}");
    }
    assert_eq!(
        one(y(&[0, 1000]), &[&time[..], &marks[..1], &[("cycle_time", 9)]].concat()),
        Some(Code::AMK_MODE_FIELD)
    );
}

#[test]
fn a_set_whose_first_table_ends_before_the_window_ends_with_it() {
    let tables = [xy(&[(0, 0), (1000, 1000)]), xy(&[(0, 0), (100, 50)])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(83, &[("incr_per_rev", 0), ("start_angle", 900)]), 0);
    // E1 starts, E2 enables, E3 selects set 1.
    let out = (bench.step(500, 0b110), bench.step(0, 0b111)).1;
    assert_eq!((out.sink, out.outputs & 1), (50, 1));
}

#[test]
fn an_edge_in_the_call_of_the_zero_pulse_counts() {
    let tables = [y(&[0, 1000])];
    // The travel is 20, the pulse was 5 ago. Mode 26 begins in that call at x = 0; modes 82 and 98 begin at the pulse,
    // so that x is 5.
    let pulse = |bench: &mut Bench<'_, Xfipw>| {
        bench.travel += 20;
        bench.function.step(&bench.seen(1, Some(bench.travel - 5))).outputs
    };
    for (ba, first, later) in [(26, 0, 100), (82, 0, 150), (98, 0, 150)] {
        let mut bench = xfipw(&tables);
        bench.start(&extended(ba, &[("function", 4)]), 0);
        assert_eq!(pulse(&mut bench), first, "{ba}");
        assert_eq!(bench.step(10, 1).sink, later, "{ba}");
    }
}

#[test]
fn a_place_without_32_bits_is_not_read() {
    let points: Vec<i64> = (0..2000).map(|i| i * 32_767).collect();
    let tables = [y(&points)];
    let read = |offset| {
        let values = extended(2, &[("incr_per_rev", 50), ("mult", 32), ("master_offset", offset)]);
        let words = set(xfipw::FIELDS, &values);
        let bench = xfipw(&tables);
        bench.function.read(Words(&words), &setting(bench.call_ns, bench.found())).map_err(|fault| fault.code)
    };
    assert!(matches!(read(49), Ok(Some((_, 1..)))));
    assert_eq!(read(32_767), Err(Code::AMK_BEYOND));
}

#[test]
fn calls_of_any_length_run_a_set_by_time() {
    let tables = [y(&[0, 1000])];
    let mut bench = xfipw(&tables);
    bench.call_ns = 333_333;
    let time = [("ba", 4), ("mult", 1), ("tables_total", 1), ("cycle_time", 100), ("work_cycles", 1)];
    bench.start(&time, 0);
    // 100 times 0.5 ms are 50 ms: 150 calls are 49.99995 ms.
    let sinks: Vec<i64> = (0..151).map(|_| bench.step(0, 0).sink).collect();
    assert_eq!((sinks[0], sinks[149], sinks[150]), (6, 999, 1006));
}

#[test]
fn a_stored_edge_counts_once() {
    let tables = [y(&[0, 100])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("function", 16)]), 0);
    // Two edges in the first movement cause one more; E1 stays 1.
    let calls = [(0, 1), (20, 0), (20, 1), (20, 0), (20, 1), (20, 1), (99, 1), (1, 1), (10, 1)];
    let wanted = [(0, 0), (20, 0), (40, 0), (60, 0), (80, 0), (100, 0), (199, 0), (200, 1), (200, 1)];
    assert_eq!(bench.run(&calls), wanted);
}
