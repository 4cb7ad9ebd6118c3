//! Oracles of fipz.

use super::*;

/// Proves: AMK-FIPZ-02, AMK-FIPZ-04, AMK-FIPZ-16, AMK-FIPZ-17, AMK-FIPZ-18, AMK-FIPZ-19, AMK-FIPZ-O2
#[test]
fn each_input_starts_its_table() {
    let tables: Vec<Arc<Table>> = (1..6).map(|n| y(&[0, 1000 * n])).collect();
    let mut bench = fipz(&tables);
    bench.call_ns = 4 * HALF;
    let mut values = set(fipz::FIELDS, &[("mode", 16), ("sf_cycle", 4), ("table_count", 5), ("mult", 1)]);
    let place = values.len() - LINES;
    values[place..place + 5].copy_from_slice(&[2000, 4000, 6000, 8000, 10_000]);
    assert!(bench.function.check(Words(&values), &setting(bench.call_ns, bench.found())).is_ok());
    assert_eq!(bench.function.start(Words(&values), &bench.seen(1, None)).outputs, 1);
    // E1 stays 1: no edge. Then E3 and E2 at once: the lower one counts. 4000 half milliseconds are 1000 calls.
    assert_eq!(bench.run(&[(0, 1), (0, 0b111)]), [(0, 1), (0, 0)]);
    let calls: Vec<_> = bench.run(&[(0, 0b1001); 1000]);
    assert_eq!((calls[0], calls[499], calls[998], calls[999]), ((2, 0), (1000, 0), (1998, 0), (2000, 1)));
    // The edge of E4 while it ran is ignored; Table 0 takes 500 calls.
    assert_eq!(bench.run(&[(0, 0b1001), (0, 0), (0, 1)]), [(2000, 1), (2000, 1), (2000, 0)]);
    let calls: Vec<_> = bench.run(&[(0, 0); 500]);
    assert_eq!((calls[498].1, calls[499]), (0, (3000, 1)));
    // A table beyond the count, or without a time.
    assert_eq!(bench.run(&[(0, 0b10_0000)]), [(3000, 1)]);
}

/// Proves: AMK-FIPZ-03, AMK-FIPZ-O1
#[test]
fn one_input_starts_the_table_that_the_others_name() {
    let tables: Vec<Arc<Table>> = (0..8).map(|n| y(&[0, 100 + n])).collect();
    // Inputs from E1 on, and the table.
    for (inputs, table) in [(0b1011, 5), (0b1101, 6), (0b0001, 0), (0b1111, 7)] {
        let mut bench = fipz(&tables);
        let mut values = set(fipz::FIELDS, &[("mode", 17), ("table_count", 8), ("mult", 1)]);
        let place = values.len() - LINES;
        values[place..].copy_from_slice(&[2; LINES]);
        bench.function.start(Words(&values), &bench.seen(inputs & !1, None));
        assert_eq!(bench.run(&[(0, inputs), (0, 0)]), [(0, 0), (100 + table, 1)], "{inputs:b}");
    }
}

#[test]
fn an_edge_of_a_table_without_a_time_hides_no_other() {
    let tables = [y(&[0, 100]), y(&[0, 200])];
    let mut bench = fipz(&tables);
    let mut values = set(fipz::FIELDS, &[("mode", 16), ("table_count", 2), ("mult", 1)]);
    let place = values.len() - LINES;
    values[place + 1] = 2;
    bench.function.start(Words(&values), &bench.seen(0, None));
    assert_eq!(bench.run(&[(0, 0b11), (0, 0)]), [(0, 0), (200, 1)]);
    assert_eq!(bench.run(&[(0, 0b101)]), [(200, 1)]);
}
