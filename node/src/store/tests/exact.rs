//! Tests that reading gives exactly the written values.

use super::*;
use lineshaft_core::parameter::{Measure, ROWS, Range, Row, Value};
use proptest::prelude::*;

/// Any value that a row accepts, and some that it does not.
fn value(row: &'static Row) -> BoxedStrategy<Value> {
    let whole = match row.range {
        Range::Int(low, high) => (low..=high).prop_map(Value::Int).boxed(),
        Range::Among(ranges) => {
            let (low, high) = ranges.first().zip(ranges.last()).map_or((0, 0), |(first, last)| (first.0, last.1));
            (low..=high).prop_map(Value::Int).boxed()
        }
        Range::PositiveUpTo(high) => prop_oneof![(1e-9..1e9), (0.0..high)].prop_map(Value::Real).boxed(),
        Range::Real(low, high) => (low..=high).prop_map(Value::Real).boxed(),
    };
    let small = match row.measure {
        Measure::Velocity | Measure::Acceleration | Measure::Jerk | Measure::Number => {
            (1..1_000_000_i64).prop_map(|number| Value::Real(number as f64 / 7.0)).boxed()
        }
        _ => (-100..10_000_i64).prop_map(Value::Int).boxed(),
    };
    prop_oneof![2 => whole, 3 => small, 1 => Just(row.default), 1 => Just(Value::Unset)].boxed()
}

fn sets() -> impl Strategy<Value = Vec<(usize, usize, Value)>> {
    let change = (0..2_usize, 0..ROWS.len()).prop_flat_map(|(axis, row)| (Just(axis), Just(row), value(&ROWS[row])));
    prop::collection::vec(change, 0..40)
}

/// Makes the changes that apply and are consistent, like a machine.
fn change(config: &MachineConfig, user: &mut [AxisParameters], changes: Vec<(usize, usize, Value)>) {
    for (axis, row, value) in changes {
        let row = &ROWS[row];
        let mut candidate = user[axis];
        let entry = &config.axes[axis];
        let is_good = row.applies.to(entry)
            && row.change(&mut candidate, value).is_ok()
            && candidate.is_sound()
            && lineshaft_core::vocabulary::check(&candidate, &config.setting(entry)).is_ok();
        if is_good {
            user[axis] = candidate;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    /// Rows of all systems, in any order, through both views of a value.
    ///
    /// Proves: MACS-STO-04, MACS-STO-06, MACS-STO-07
    #[test]
    fn values_round_trip_exactly(before in sets(), after in sets()) {
        let mut config = config();
        // The cell may have any values, too.
        let mut init: Vec<_> = config.axes.iter().map(|axis| axis.parameters).collect();
        change(&config.clone(), &mut init, before);
        for (axis, init) in config.axes.iter_mut().zip(&init) {
            axis.parameters = *init;
        }
        let mut user = init.clone();
        change(&config, &mut user, after);
        let user: Vec<_> = std::iter::zip(&user, &init).map(|(user, init)| user.saved(init)).collect();

        let bodies: Vec<_> = std::iter::zip(&config.axes, &user).collect();
        let text = text::whole(3, &text::body(&bodies));
        let text = text::checked(text.into_bytes()).unwrap();
        let stored = read_store("p.yaml", &text, &config).map_err(|problems| TestCaseError::fail(problems.to_string()))?;
        let read: Vec<_> = std::iter::zip(stored.sets, &init).map(|(set, init)| set.unwrap_or(*init)).collect();
        // -0 equals 0 with `==`, but has another bit.
        let bits = |sets: &[AxisParameters]| postcard::to_allocvec(sets).unwrap();
        prop_assert_eq!(&read, &user);
        prop_assert_eq!(bits(&read), bits(&user), "{}", text);
        prop_assert_eq!(stored.generation, 3);
    }
}

/// An edit of the cell applies to values that were never saved, and a value that MACS gave as a time is still a time.
///
/// Proves: MACS-STO-02
#[test]
fn what_was_not_saved_follows_the_cell() {
    let bench = Bench::new();
    let mut user: Vec<_> = bench.config.axes.iter().map(|axis| axis.parameters).collect();
    let set = |parameters: &mut AxisParameters, key: &str, value| {
        Row::find(key).unwrap().1.change(parameters, value).unwrap();
    };
    set(&mut user[1], "rampmin", Value::Int(250_000_000));
    bench.open().unwrap().keep(&bench.config, &user).unwrap();
    let text = fs::read_to_string(bench.path("p.yaml")).unwrap();
    assert!(text.contains("parameters:\n  table.rampmin: "), "{text}");
    assert_eq!(text.lines().filter(|line| line.starts_with("  table.")).count(), 1, "{text}");

    let edited = CELL.replace("velmax: 1000", "velmax: 1200");
    let mut config = Cell::parse("cell.yaml", edited).unwrap().machine;
    bench.open().unwrap().load(&mut config).unwrap();
    let table = config.axes[1].saved.unwrap();
    // 1200 rpm with 2000 counts: 40000 inc/s, in 250 ms.
    assert_eq!((table.max_velocity, table.max_acceleration), (40_000.0, 160_000.0));
    assert_eq!(config.axes[0].saved, None);
}

/// A limit outside of the range of NEGLIMIT, switched off by MACS: the position that is stored is within that range.
#[test]
fn a_wide_limit_that_was_switched_off_can_be_saved() {
    let bench = Bench::new();
    let mut user: Vec<_> = bench.config.axes.iter().map(|axis| axis.parameters).collect();
    for (key, value) in [
        ("min_position", Value::Int(-(1 << 40))),
        ("max_position", Value::Int(1 << 40)),
        ("swneglimact", Value::Int(0)),
        ("swposlimact", Value::Int(0)),
    ] {
        Row::find(key).unwrap().1.change(&mut user[0], value).unwrap();
    }
    bench.open().unwrap().keep(&bench.config, &user).unwrap();
    let mut config = bench.config.clone();
    bench.open().unwrap().load(&mut config).unwrap();
    assert_eq!(config.axes[0].saved, Some(user[0]));
    assert_eq!((user[0].min_position, user[0].macs.neglimit), (None, -((1 << 30) - 1)));
}
