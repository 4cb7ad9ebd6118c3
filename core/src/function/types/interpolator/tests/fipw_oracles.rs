//! Oracles of fipw.

use super::*;

/// Proves: AMK-FIPW-05, AMK-FIPW-06, AMK-FIPW-36, AMK-FIPW-42, AMK-FIPW-55, AMK-FIPW-O1
#[test]
fn a_cycle_follows_its_table_over_every_passage_and_back() {
    let tables = [y(&T)];
    let mut bench = fipw(&tables);
    bench.start(&by_way(2, &[("increments_per_rev", 20_000)]), 0);
    for (x, sink) in [
        (1250, 500),
        (2500, 1000),
        (10_000, 4000),
        (11_000, 5600),
        (19_999, 19_998),
        (20_000, 20_000),
        (21_250, 20_500),
        (-1, -2),
        (-20_000, -20_000),
        (60_000 + 1250, 60_500),
        (0, 0),
    ] {
        let out = bench.step(x - bench.travel, 0);
        assert_eq!((out.sink, out.outputs, out.writes), (sink, 0, 0), "{x}");
    }
}

/// Proves: AMK-FIPW-41, AMK-FIPW-44, AMK-FIPW-45, AMK-FIPW-54, AMK-FIPW-O5
#[test]
fn a_movement_by_time_ends_with_its_last_value() {
    let tables = [y(&[0, 1000, 4000])];
    let timed = |time| [("mode", 132), ("mult", 1), ("table_count", 1), ("sf_cycle", 2), ("cycle_time", time)];
    let mut bench = fipw(&tables);
    assert_eq!(bench.start(&timed(10), 0).outputs, 1);
    // The call of the edge has t = 0.
    let calls: Vec<_> = (0..8).map(|_| (0, 1)).collect();
    let wanted = [(0, 0), (400, 0), (800, 0), (1600, 0), (2800, 0), (4000, 1), (4000, 1), (4000, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // Another edge continues from there.
    assert_eq!(bench.run(&[(0, 0), (0, 1), (0, 1)]), [(4000, 1), (4000, 0), (4400, 0)]);
    let mut bench = fipw(&tables);
    bench.start(&timed(5), 0);
    assert_eq!(bench.run(&[(0, 1); 5]), [(0, 0), (800, 0), (2800, 0), (4000, 1), (4000, 1)]);
}

/// Proves: AMK-FIPW-08, AMK-FIPW-09
#[test]
fn time_runs_in_parts_of_a_call_where_that_is_no_half_millisecond() {
    let tables = [y(&[0, 1000, 4000])];
    let mut bench = fipw(&tables);
    bench.call_ns = 125_000;
    bench.start(&[("mode", 4), ("mult", 1), ("table_count", 1), ("cycle_time", 1)], 0);
    // 0.5 ms are four calls: 500, 1000, 2500, 4000, and the same again.
    assert_eq!(bench.run(&[(0, 0); 5]).iter().map(|call| call.0).collect::<Vec<_>>(), [500, 1000, 2500, 4000, 4500]);
}

/// Proves: AMK-FIPW-43, AMK-SYNC-01, AMK-SYNC-02, AMK-SYNC-O2
#[test]
fn a_zero_pulse_begins_a_cycle_where_it_was() {
    let tables = [y(&[0, 1000])];
    let mut bench = fipw(&tables);
    bench.sink = 70;
    bench.start(&by_way(2, &[("function", 4)]), 0);
    assert_eq!(bench.run(&[(250, 0), (250, 0)]), [(70, 0), (70, 0)]);
    bench.travel += 30;
    // The pulse was 10 inc ago: x = 10.
    let out = bench.function.step(&bench.seen(0, Some(520)));
    assert_eq!(out.sink, 70 + 100);
    assert_eq!(bench.run(&[(10, 0), (80, 0)]), [(270, 0), (1070, 0)]);
    let mut bench = fipw(&tables);
    // With an offset beyond the window the table begins at its next zero: 40 inc after the pulse.
    bench.start(&by_way(2, &[("function", 4), ("master_offset", 60)]), 0);
    bench.travel += 30;
    assert_eq!(bench.function.step(&bench.seen(0, Some(20))).sink, 0);
    assert_eq!(bench.run(&[(29, 0), (2, 0)]), [(0, 0), (10, 0)]);
}

/// Proves: AMK-FIPW-22, AMK-FIPW-23
#[test]
fn a_cycle_waits_for_its_window_and_is_locked_to_the_master() {
    let tables = [y(&[0, 1000])];
    let mut bench = fipw(&tables);
    // x = 40 is within 0..50: the table begins at once, and the sink catches up in the next call.
    assert_eq!(bench.start(&by_way(2, &[("master_offset", 40), ("start_angle", 50)]), 0).sink, 0);
    assert_eq!(bench.run(&[(0, 0), (1, 0)]), [(400, 0), (410, 0)]);
    let mut bench = fipw(&tables);
    bench.start(&by_way(2, &[("master_offset", 60), ("start_angle", 50)]), 0);
    assert_eq!(bench.run(&[(39, 0), (3, 0), (-10, 0)]), [(0, 0), (20, 0), (-80, 0)]);
}

/// Proves: AMK-FIPW-38, AMK-FIPW-40, AMK-FIPW-46, AMK-FIPW-47
#[test]
fn tables_run_one_after_the_other_once_e1_has_risen() {
    let tables = [y(&[0, 100]), y(&[0, 1000]), y(&[0, -50])];
    let mut bench = fipw(&tables);
    // E1 = 1 at START is no edge.
    assert_eq!(bench.start(&by_way(82, &[("table_count", 3)]), 1).outputs, 1);
    assert_eq!(bench.run(&[(150, 1), (0, 0)]), [(0, 1), (0, 1)]);
    // x is 50. The edge waits for the zero, where x is 10 already. Edges during the movement are ignored; a new edge
    // after it waits for the zero again.
    let calls = [(0, 0), (10, 1), (50, 0), (90, 1), (100, 0), (90, 0), (20, 1), (100, 1), (0, 0), (0, 1), (90, 1)];
    let wanted = [
        (0, 1),
        (0, 1),
        (10, 0),
        (100, 0),
        (1100, 0),
        (1055, 0),
        (1050, 1),
        (1050, 1),
        (1050, 1),
        (1050, 1),
        (1050, 0),
    ];
    assert_eq!(bench.run(&calls), wanted);
}

/// Proves: AMK-FIPW-48, AMK-FIPW-49, AMK-FIPW-50, AMK-FIPW-51, AMK-FIPW-52, AMK-FIPW-39
#[test]
fn a_master_is_coupled_in_and_out_by_tables() {
    let tables = [y(&[0, 50]), y(&[0, 100]), y(&[0, 40])];
    let mut bench = fipw(&tables);
    bench.start(&by_way(98, &[("table_count", 3), ("start_tables", 1)]), 0);
    // Clocked in at the zero: start table, working table twice, stop table; then clocked out.
    let calls = [(50, 1), (50, 1), (100, 1), (100, 1), (50, 1), (50, 0), (50, 0), (50, 0), (100, 0)];
    let wanted = [(0, 1), (0, 0), (50, 0), (150, 0), (200, 0), (250, 0), (270, 0), (290, 1), (290, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // The level of E1 is enough now; it falls while the start table runs: no working table.
    let calls = [(100, 1), (50, 0), (50, 0), (50, 0), (50, 0), (50, 0)];
    let wanted = [(290, 0), (315, 0), (340, 0), (360, 0), (380, 1), (380, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // E1 is 1 again while it clocks out: it clocks in at the same zero, A1 stays 0.
    let calls = [(50, 1), (100, 0), (50, 1), (50, 1)];
    assert_eq!(bench.run(&calls), [(380, 0), (430, 0), (450, 0), (470, 0)]);
    assert_eq!(bench.run(&[(50, 1)]), [(495, 0)]);
}

#[test]
fn a_stop_window_replaces_the_rest_of_a_pass() {
    let tables = [y(&[0, 100]), y(&[0, 40])];
    let values = by_way(98, &[("table_count", 2), ("stop_angle", 30)]);
    let mut bench = fipw(&tables);
    bench.start(&values, 0);
    // q = 0: the working table at once, at x = 0.
    assert_eq!(bench.run(&[(0, 1), (120, 1), (5, 0), (5, 0)]), [(0, 0), (120, 0), (110, 0), (112, 0)]);
    // Back before the zero: the working table again.
    assert_eq!(bench.run(&[(-40, 0), (20, 0), (110, 0)]), [(90, 0), (104, 0), (140, 1)]);
    // Without a stop table the window stops nothing.
    let mut bench = fipw(&tables);
    bench.start(&by_way(98, &[("table_count", 1), ("stop_angle", 30)]), 0);
    assert_eq!(bench.run(&[(0, 1), (20, 0), (79, 0), (1, 0), (5, 0)]), [(0, 0), (20, 0), (99, 0), (100, 1), (100, 1)]);
}

/// Proves: AMK-FIPW-37
#[test]
fn behind_its_first_table_a_movement_waits_for_the_master() {
    let tables = [y(&[0, 100])];
    let mut bench = fipw(&tables);
    bench.start(&by_way(26, &[]), 0);
    // x = 0 at the edge, wherever the master is.
    let calls = [(77, 1), (10, 1), (-30, 1), (10, 1), (15, 0), (-400, 0), (395, 1), (200, 1), (10, 1)];
    let wanted = [(0, 0), (10, 0), (0, 0), (0, 0), (5, 0), (0, 0), (0, 0), (100, 1), (100, 1)];
    assert_eq!(bench.run(&calls), wanted);
}

/// Proves: AMK-FIPW-01, AMK-FIPW-15, AMK-FIPW-16, AMK-FIPW-18, AMK-FIPW-20, AMK-FIPW-21, AMK-FIPW-24, AMK-FIPW-28, AMK-FIPW-29, AMK-FIPW-30,
/// AMK-FIPW-31, AMK-FIPW-32, AMK-FIPW-33, AMK-FIPW-34
#[test]
fn what_a_mode_does_not_use_is_refused() {
    let many: Vec<i64> = (0..128).collect();
    let tables = [y(&[0, 100]), y(&many), xy(&[(0, 0), (100, 5)]), y(&[1, 2])];
    let bench = fipw(&tables);
    let of = |mode, more: &[(&str, i64)]| bench.refused(&by_way(mode, more)).map(|fault| (fault.code, fault.field));
    let field = |name: &str| fipw::FIELDS.iter().position(|field| field.name == name).map(|place| place as u16);
    assert_eq!(of(3, &[]), Some((Code::AMK_NO_MODE, field("mode"))));
    let unused = |mode, name: &'static str, value| (of(mode, &[(name, value)]), field(name));
    for (mode, name, value) in [
        (2, "table_count", 2),
        (26, "table_count", 2),
        (82, "start_tables", 1),
        (26, "master_offset", 1),
        (26, "start_angle", 1),
        (2, "stop_angle", 1),
        (82, "stop_angle", 1),
        (2, "cycle_time", 1),
        (82, "function", 1),
        (2, "function", 2),
        (26, "function", 4),
    ] {
        let (refused, field) = unused(mode, name, value);
        assert_eq!(refused, Some((Code::AMK_MODE_FIELD, field)), "{mode} {name}");
    }
    for (mode, name, value) in [
        (98, "start_tables", 1),
        (2, "increments_per_rev", 49),
        (2, "master_offset", 100),
        (82, "start_angle", 100),
        (98, "stop_angle", 100),
    ] {
        let (refused, field) = unused(mode, name, value);
        assert_eq!(refused, Some((Code::AMK_BEYOND, field)), "{mode} {name}");
    }
    assert_eq!(of(98, &[("master_offset", 99), ("start_angle", 99), ("stop_angle", 99)]), None);
    assert_eq!(of(82, &[("table_count", 2)]), Some((Code::AMK_CURVE_POINTS, None)));
    assert_eq!(of(82, &[("table_count", 5)]), Some((Code::AMK_TABLES_FEW, None)));
    let time = |more: &[(&str, i64)]| {
        let values = [&[("mode", 100), ("mult", 1), ("table_count", 1)], more].concat();
        bench.refused(&values).map(|fault| (fault.code, fault.field))
    };
    assert_eq!(time(&[]), Some((Code::AMK_BEYOND, field("cycle_time"))));
    assert_eq!(time(&[("cycle_time", 65_534), ("master_offset", 65_533), ("stop_angle", 65_533)]), None);
    assert_eq!(time(&[("cycle_time", 65_535)]), Some((Code::AMK_BEYOND, field("cycle_time"))));
    assert_eq!(time(&[("cycle_time", 9), ("function", 4)]), Some((Code::AMK_MODE_FIELD, field("function"))));
    assert_eq!(time(&[("cycle_time", 9), ("sf_cycle", 3)]), Some((Code::AMK_CYCLE_MISMATCH, field("sf_cycle"))));
    let only = |table: usize| fipw(&tables[table..]).refused(&by_way(2, &[])).map(|fault| fault.code);
    assert_eq!(
        [only(1), only(2), only(3)],
        [Some(Code::AMK_CURVE_POINTS), Some(Code::AMK_CURVE_FORM), Some(Code::AMK_CURVE_FIRST)]
    );
}

/// Proves: AMK-FIPW-19, AMK-FIPW-17, AMK-FIPW-27
#[test]
fn a_scaled_value_keeps_32_bits() {
    let high: Vec<i64> = (0..127).map(|i| i * 32_767).collect();
    let tables = [y(&high)];
    let of = |mult, div_exp| {
        fipw(&tables).refused(&by_way(2, &[("mult", mult), ("div_exp", div_exp)])).map(|fault| fault.code)
    };
    // 126 * 32767 = 4128642; times 520 it is 2146893840, times 521 2151022482.
    assert_eq!(
        (of(520, 0), of(521, 0), of(521, 1), of(-521, 0)),
        (None, Some(Code::AMK_CURVE_SCALED), None, Some(Code::AMK_CURVE_SCALED))
    );
}

/// Proves: AMK-FIPW-13, AMK-FIPW-14, AMK-FIPW-25, AMK-FIPZ-06, AMK-FIPZ-07, AMK-FIPZ-08, AMK-FIPZ-09, AMK-FIPZ-10, AMK-FIPZ-11, AMK-FIPZ-12,
/// AMK-FIPZ-13, AMK-FIPZ-15, AMK-XFIPW-89, AMK-XFIPW-90, AMK-XFIPW-91, AMK-XFIPW-93, AMK-XFIPW-94, AMK-XFIPW-95, AMK-XFIPW-96, AMK-XFIPW-98,
/// AMK-XFIPW-99, AMK-XFIPW-100, AMK-XFIPW-101, AMK-XFIPW-102, AMK-XFIPW-104, AMK-XFIPW-105, AMK-XFIPW-107, AMK-XFIPW-108, AMK-XFIPW-109,
/// AMK-XFIPW-110, AMK-XFIPW-111, AMK-XFIPW-112, AMK-XFIPW-113, AMK-XFIPW-114, AMK-XFIPW-115, AMK-XFIPW-117, AMK-XFIPW-118,
/// AMK-XFIPW-119, AMK-XFIPW-120
#[test]
fn sets_have_the_fields_of_the_source() {
    let of = |fields: &[Field]| {
        let row = |field: &Field| format!("{} {} {} {}", field.name, field.min, field.max, field.count);
        fields.iter().map(row).collect::<Vec<_>>()
    };
    assert_eq!(
        of(fipw::FIELDS)[..14],
        [
            "function 0 7 1",
            "mode 0 132 1",
            "sak 0 32767 1",
            "sf_cycle 0 32767 1",
            "table_count 1 8 1",
            "start_tables 0 7 1",
            "div_exp 0 15 1",
            "sync_md_addr 0 0 1",
            "mult -32768 32767 1",
            "increments_per_rev 0 32767 1",
            "cycle_time 0 1073676289 1",
            "master_offset 0 1073676288 1",
            "start_angle 0 1073676288 1",
            "stop_angle 0 1073676288 1",
        ]
    );
    assert_eq!(
        of(fipz::FIELDS),
        [
            "mode 16 17 1",
            "sak 0 32767 1",
            "sf_cycle 0 32767 1",
            "table_count 1 8 1",
            "div_exp 0 15 1",
            "mult 1 32767 1",
            "cycle_time 0 32767 8",
        ]
    );
    assert_eq!(
        of(xfipw::FIELDS),
        [
            "function 0 63 1",
            "ba 0 133 1",
            "sak_factor 0 32767 1",
            "sf_cycle 0 32767 1",
            "tables_total 1 8 1",
            "tables_start 0 7 1",
            "div_exp 0 15 1",
            "ext_sync_md 0 0 1",
            "work_cycles 0 255 1",
            "mult -32768 32767 1",
            "incr_per_rev 0 32767 1",
            "cycle_time 0 32767 1",
            "master_offset -32767 32767 1",
            "start_angle 0 32767 1",
            "stop_angle 0 32767 1",
            "format_length 0 32767 1",
            "sensor_distance 0 2147483647 1",
            "sync_shift 0 32766 1",
            "valid_range 0 16383 1",
            "corr_start 0 32767 1",
            "corr_len 0 32767 1",
            "corr_md 0 0 1",
            "corr_weight 0 255 1",
            "corr_every 0 255 1",
            "output_value -2147483648 2147483647 1",
        ]
    );
}

#[test]
fn master_moving_back_into_window_starts_nothing() {
    let tables = [y(&[0, 1000]), y(&[0, 100])];
    let mut bench = fipw(&tables);
    bench.start(&by_way(82, &[("start_angle", 30)]), 0);
    assert_eq!(bench.run(&[(40, 0), (0, 1), (-20, 1), (1, 1)]), [(0, 1), (0, 1), (0, 1), (210, 0)]);
    // It does not stop anything either.
    let mut bench = fipw(&tables);
    bench.start(&by_way(98, &[("table_count", 2), ("stop_angle", 30)]), 0);
    assert_eq!(
        bench.run(&[(0, 1), (40, 1), (0, 0), (-20, 0), (1, 0)]),
        [(0, 0), (400, 0), (400, 0), (200, 0), (21, 0)]
    );
}

/// A restored state must belong to the active set.
#[test]
fn a_state_belongs_to_its_set() {
    let tables = [y(&[0, 1000])];
    let mut bench = fipw(&tables);
    bench.start(&by_way(2, &[]), 0);
    let runs_by = |values: &[(&str, i64)]| bench.function.runs_with(Words(&set(fipw::FIELDS, values)), bench.call_ns);
    assert!(runs_by(&by_way(2, &[])));
    for (name, value) in [("mult", 2), ("increments_per_rev", 101), ("mode", 26), ("master_offset", 1), ("sak", 1)] {
        assert!(!runs_by(&by_way(2, &[(name, value)])), "{name}");
    }
}
