use super::*;
use crate::table::{CamSetting, Form, Interpolation};
use proptest::prelude::*;

/// The cam `knife` of the contract, section 10.
const KNIFE: [(i64, i64); 3] = [(0, 0), (5000, 1200), (20_000, 20_000)];

fn xy(points: &[(i64, i64)]) -> Vec<Arc<Table>> {
    let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
    vec![Arc::new(Table::new(Form::Xy, &x, &y).expect("points"))]
}

fn even(y: &[i64], length: i64, is_cyclic: bool) -> Vec<Arc<Table>> {
    let setting = CamSetting { length: Some(length), is_cyclic, ..CamSetting::default() };
    vec![Arc::new(Table::new(Form::Y, &[], y).expect("points").with_cam(setting))]
}

fn ratio(numerator: i64, denominator: i64) -> Ratio {
    Ratio::new(numerator, denominator).expect("legal")
}

fn cam(tables: &[Arc<Table>], place: i64) -> Cam {
    Cam::new(0, (Ratio::ONE, Ratio::ONE), Position::whole(place), tables).expect("a cam")
}

/// y(2500) = 600; y(12500) = 1200 + 18800 / 2 = 10600; a period is 20000.
#[test]
fn the_slave_is_where_the_table_says_period_by_period() {
    let tables = xy(&KNIFE);
    let mut cam = cam(&tables, 0);
    let mut slave = Position::ZERO;
    for (step, wanted) in
        [(2500, 600), (2500, 1200), (7500, 10_600), (7500, 20_000), (2500, 20_600), (-5000, 15_000 + 1866)]
    {
        slave += cam.step(Position::whole(step), &tables);
        // 20000 - 2500 = 17500: 1200 + 18800 * 12500 / 15000 = 16866 and 2/3.
        assert_eq!(slave.floor(), wanted);
    }
    assert!((slave.fraction() - 2.0 / 3.0).abs() < 1e-9, "{slave:?}");
    for _ in 0..1_000_000 {
        slave += cam.step(Position::whole(20_000), &tables);
    }
    assert_eq!(slave.floor(), 20_000_000_000 + 16_866);
}

/// A million changes of the table, each at an end, in both directions: position and travel are equal to the sums, bit
/// by bit.
#[test]
fn change_of_table_keeps_remainders() {
    let tables = [xy(&KNIFE), xy(&[(0, 0), (2000, -500), (7000, -1234)])].concat();
    let (master, slave) = (ratio(5, 7), ratio(-3, 4));
    let new = |table| Cam::new(table, (master, slave), Position::ZERO, &tables).expect("a cam");
    let shape = |table: u16| tables[usize::from(table)].cam().expect("a cam");
    let scaled =
        |sum: i128, ratio: Ratio| (sum * i128::from(ratio.numerator())).div_euclid(i128::from(ratio.denominator()));
    let (mut table, mut cam, mut changes, mut backwards) = (0, new(0), 0, 0);
    let (mut lead, mut way, mut origin, mut before) = (Position::ZERO, Position::ZERO, 0, 0);
    let mut k = 0_i128;
    while changes < 1_000_000 {
        k += 1;
        let turned = if k % 11 == 3 { -9_000 } else { 7_000 + k % 1013 };
        let change = Position::from_raw((turned << 32) + k * 7_919 % 1_000_003);
        lead += change;
        way += cam.step(change, &tables);
        if cam.passes_end(&tables) {
            let (old, next) = (table, 1 - table);
            let is_back = cam.passed < 0;
            let (corrected, handed) = cam.handed_over(new(next), &tables).expect("both are cams");
            way += corrected;
            (table, cam) = (next, handed);
            let (sign, of) = if is_back { (-1, shape(next)) } else { (1, shape(old)) };
            origin += sign * Position::whole(of.length).raw();
            before += sign * Position::whole(of.travel).raw();
            (changes, backwards) = (changes + 1, backwards + usize::from(is_back));
        }
        assert_eq!(cam.place.raw(), scaled(lead.raw(), master) - origin, "{k}");
        assert_eq!(way.raw(), scaled(before + cam.value.raw(), slave), "{k}");
    }
    assert!(backwards > 10_000, "{backwards}");
}

#[test]
fn places_before_points_and_between_increments_count() {
    // Three points over 3 increments: intervals of 1.5; at 1 it is 2/3 of the first, at 2 1/3 of the second.
    let tables = even(&[0, 6, -6], 3, true);
    let mut cam = cam(&tables, 0);
    let half = Position::from_f64(0.5);
    let places = (0..6).scan(Position::ZERO, |slave, _| {
        *slave += cam.step(half, &tables);
        Some(slave.to_f64())
    });
    assert_eq!(places.collect::<Vec<_>>(), [2.0, 4.0, 6.0, 2.0, -2.0, -6.0]);
}

#[test]
fn one_that_is_not_cyclic_rests_at_its_end_and_waits_before_its_beginning() {
    let tables = even(&[5, 105], 100, false);
    let mut cam = cam(&tables, 0);
    let mut slave = Position::ZERO;
    for (step, wanted, ended) in
        [(-50, 0, false), (30, 0, false), (40, 20, false), (79, 99, false), (1, 100, true), (900, 100, true)]
    {
        slave += cam.step(Position::whole(step), &tables);
        assert_eq!((slave.floor(), cam.has_ended(&tables)), (wanted, ended), "{step}");
    }
    slave += cam.step(Position::whole(-950), &tables);
    assert_eq!((slave.floor(), cam.has_ended(&tables)), (50, false));
}

/// By exactly the difference of both tables at that position.
#[test]
fn another_table_moves_the_slave_by_what_both_differ_there() {
    let (first, second) = (xy(&[(0, 0), (100, 1000)]), xy(&[(0, 0), (50, 700), (100, 1000)]));
    let mut cam = cam(&first, 0);
    let mut slave = cam.step(Position::whole(49), &first);
    slave += cam.step(Position::whole(1), &second);
    assert_eq!(slave.floor(), 700);
    slave += cam.step(Position::whole(50), &second);
    assert_eq!(slave.floor(), 1000);
}

#[test]
fn change_of_more_than_a_length_is_not_allowed() {
    let tables = xy(&KNIFE);
    let fast = Cam::new(0, (ratio(2, 1), Ratio::ONE), Position::ZERO, &tables).expect("a cam");
    assert!(fast.allows_change(Position::whole(-10_000), &tables));
    assert!(!fast.allows_change(Position::whole(10_001), &tables));
    assert!(!fast.allows_change(Position::ZERO + Position::whole(1 << 40), &[]));
}

#[test]
fn a_lead_far_away_is_somewhere_in_the_table() {
    let shape = CamShape { length: 1000, travel: 0, is_cyclic: true };
    let place =
        |position, scale, shape| Cam::place_of(Position::whole(position), scale, Position::whole(7), shape).floor();
    assert_eq!(place(2300, Ratio::ONE, shape), 307);
    assert_eq!(place(-1, Ratio::ONE, shape), 1006);
    // 2300 * -3 / 2 = -3450: 550 in its period.
    assert_eq!(place(2300, ratio(-3, 2), shape), 557);
    // 2^61 = 2305843009213693952, times 999999999 / 1000000000: 2305843006907850942.990786306048.
    assert_eq!(place(1 << 61, ratio(999_999_999, 1_000_000_000), shape), 942 + 7);
    let once = CamShape { is_cyclic: false, ..shape };
    assert_eq!(place(-1, Ratio::ONE, once), 6);
    assert_eq!(place(1 << 61, ratio(Ratio::LIMIT - 1, 1), once), Position::LIMIT - 1 + 7);
    assert_eq!(place(1 << 61, ratio(1 - Ratio::LIMIT, 1), once), 1 - Position::LIMIT + 7);
}

fn splined(tables: &[Arc<Table>], interpolation: Interpolation) -> Vec<Arc<Table>> {
    let with = |table: &Arc<Table>| {
        let setting = CamSetting { interpolation, ..table.cam_setting() };
        Arc::new((**table).clone().with_cam(setting))
    };
    tables.iter().map(with).collect()
}

/// 1000 (1 - cos x) / 2 at 8 points of a turn of 4000 inc: between them a periodic spline is exact to 1 % of its
/// stroke, straight lines to 3.8 %.
#[test]
fn a_spline_goes_through_its_points_and_does_not_jump_at_the_period() {
    let linear = even(&[0, 146, 500, 854, 1000, 854, 500, 146, 0], 4000, true);
    for (interpolation, most) in
        [(Interpolation::Cubic, 0.004), (Interpolation::Quintic, 0.001), (Interpolation::Linear, 0.04)]
    {
        let tables = splined(&linear, interpolation);
        let mut cam = cam(&tables, 0);
        let mut slave = Position::ZERO;
        let mut steps = Vec::new();
        let mut worst = 0.0_f64;
        for x in 1..=12_000 {
            let step = cam.step(Position::whole(1), &tables);
            slave += step;
            steps.push(step.to_f64());
            let turn = f64::from(x) / 4000.0 * std::f64::consts::TAU;
            worst = worst.max((slave.to_f64() - 500.0 * (1.0 - libm::cos(turn))).abs());
            if x % 500 == 0 {
                let point = [0, 146, 500, 854, 1000, 854, 500, 146][x as usize / 500 % 8];
                assert_eq!(slave, Position::whole(point), "{x}");
            }
        }
        assert!(worst < most * 1000.0, "{interpolation:?} misses by {worst}");
        let jump = steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        // 500 (2 pi / 4000)^2 = 0.0012 is the acceleration; a corner of straight lines changes the velocity by 0.4.
        let is_smooth = jump < 0.003;
        assert_eq!(is_smooth, interpolation != Interpolation::Linear, "{interpolation:?} jumps by {jump}");
    }
}

#[test]
fn a_spline_with_an_end_rests_on_its_last_point() {
    let tables = splined(&even(&[0, 33, 7, 101], 100, false), Interpolation::Quintic);
    let mut cam = cam(&tables, 0);
    let slave = cam.step(Position::whole(100), &tables);
    assert_eq!((slave, cam.has_ended(&tables)), (Position::whole(101), true));
}

fn any_ratio() -> impl Strategy<Value = Ratio> {
    prop_oneof![
        Just((1, 1)),
        (-32_767_i64..=32_767, 0_u32..=15).prop_map(|(k, n)| (k, 1 << n)),
        (-1_000_000_i64..1_000_000, 1_i64..1_000_000),
    ]
    .prop_filter_map("0 is none", |(numerator, denominator)| Ratio::new(numerator, denominator))
}

fn any_tables() -> impl Strategy<Value = Vec<Arc<Table>>> {
    tables_within(1 << 30)
}

fn tables_within(most: i64) -> impl Strategy<Value = Vec<Arc<Table>>> {
    let points = prop::collection::vec((1_i64..5000, -most..=most), 1..60);
    let far = points.prop_map(|steps| {
        let places = steps.iter().scan(0, |x, (wide, y)| {
            *x += wide;
            Some((*x, *y))
        });
        xy(&std::iter::once((0, 3)).chain(places).collect::<Vec<_>>())
    });
    let values = prop::collection::vec(-most..=most, 2..60);
    prop_oneof![far, (values, 1_i64..100_000).prop_map(|(y, length)| even(&y, length, true))]
}

/// Returns the value of the table from its start, over whole periods, in units of 2^-32.
fn total(table: &Table, x: i128) -> i128 {
    let shape = table.cam().expect("a cam");
    let length = i128::from(shape.length) << 32;
    let (periods, x) = (x.div_euclid(length), x.rem_euclid(length));
    let points: Vec<(i128, i128)> = match table.form() {
        Form::Xy => std::iter::zip(table.x(), table.y()).map(|(x, y)| (i128::from(*x) << 32, i128::from(*y))).collect(),
        _ => return periods * (i128::from(shape.travel) << 32) + even_value(table, x, length),
    };
    let after = points.iter().position(|(place, _)| *place > x).expect("within");
    let ((from, y), (to, end)) = (points[after - 1], points[after]);
    periods * (i128::from(shape.travel) << 32) + (y << 32) + ((end - y) * (x - from)).div_euclid((to - from) >> 32)
}

fn even_value(table: &Table, x: i128, length: i128) -> i128 {
    let y: Vec<i128> = table.y().iter().map(|y| i128::from(*y)).collect();
    let scaled = x * (y.len() as i128 - 1);
    let i = (scaled / length) as usize;
    (y[i] << 32) + ((y[i + 1] - y[i]) * (scaled - i as i128 * length)).div_euclid(length >> 32)
}

proptest! {
    #![proptest_config(crate::machine::rig::cases(300))]

    /// For any ratios, table and reversals: the travel depends only on the position, to 2^-32.
    #[test]
    fn rounding_does_not_accumulate(
        tables in any_tables(),
        (master, slave) in (any_ratio(), any_ratio()),
        start in 0.0_f64..1.0,
        steps in prop::collection::vec(-1.0_f64..1.0, 1..200),
    ) {
        let table = &tables[0];
        let length = table.cam().expect("a cam").length;
        let first = Position::from_f64(start * length as f64);
        let mut cam = Cam::new(0, (master, slave), first, &tables).expect("a cam");
        let (mut way, mut lead) = (Position::ZERO, Position::ZERO);
        for step in steps {
            let change = Position::from_f64((step * length as f64 / master.to_f64()).clamp(-2e9, 2e9));
            prop_assume!(cam.allows_change(change, &tables));
            way += cam.step(change, &tables);
            lead += change;
        }
        let scaled = |position: i128, ratio: Ratio| {
            (position * i128::from(ratio.numerator())).div_euclid(i128::from(ratio.denominator()))
        };
        let from = first.raw();
        let x = from + scaled(lead.raw(), master);
        prop_assert_eq!(way.raw(), scaled(total(table, x) - total(table, from), slave));
        prop_assert!(cam.is_sound());
    }

    /// The same for splines, whose value depends only on the position.
    #[test]
    fn rounding_does_not_accumulate_between_spline_points(
        tables in tables_within(1 << 12),
        interpolation in prop::sample::select(vec![Interpolation::Cubic, Interpolation::Quintic]),
        slave in any_ratio(),
        steps in prop::collection::vec(-1.0_f64..1.0, 1..200),
    ) {
        let tables = splined(&tables, interpolation);
        prop_assume!(tables[0].cam().is_ok());
        let shape = tables[0].cam().expect("a cam");
        let mut cam = Cam::new(0, (Ratio::ONE, slave), Position::ZERO, &tables).expect("a cam");
        let (first, mut way, mut lead) = (cam.value, Position::ZERO, Position::ZERO);
        for step in steps {
            let change = Position::from_f64(step * shape.length as f64);
            way += cam.step(change, &tables);
            lead += change;
        }
        let length = Position::whole(shape.length).raw();
        let there = Cam::new(0, (Ratio::ONE, slave), lead, &tables).expect("a cam");
        let total = lead.raw().div_euclid(length) * Position::whole(shape.travel).raw() + there.value.raw() - first.raw();
        let scaled = (total * i128::from(slave.numerator())).div_euclid(i128::from(slave.denominator()));
        prop_assert_eq!(way.raw(), scaled);
    }

    /// The hint for the search does not change the result.
    #[test]
    fn a_hint_changes_nothing(tables in any_tables(), near in any::<u32>(), place in 0.0_f64..1.0, step in -1.0_f64..1.0) {
        let length = tables[0].cam().expect("a cam").length as f64;
        let mut fresh = cam(&tables, (place * length) as i64);
        let mut misled = Cam { near, ..fresh };
        let change = Position::from_f64(step * length);
        prop_assert_eq!(fresh.step(change, &tables), misled.step(change, &tables));
        prop_assert_eq!(fresh.near, misled.near);
    }

    /// A state from outside may contain any values, and a table may be replaced by any other.
    #[test]
    fn nothing_panics(
        tables in (any_tables(), tables_within(1 << 12)),
        interpolation in prop::sample::select(Interpolation::ALL.map(|(_, each)| each).to_vec()),
        raw in (any::<i128>(), any::<i128>(), any::<u32>()),
        changes in prop::collection::vec(any::<i64>(), 4),
    ) {
        let tables = [tables.0, splined(&tables.1, interpolation)];
        prop_assume!(tables[1][0].cam().is_ok());
        let start = cam(&tables[0], 0);
        let far = Cam { place: Position::from_raw(raw.0), value: Position::from_raw(raw.1), near: raw.2, ..start };
        let mut cam = if far.is_sound() { far } else { start };
        for (nth, change) in changes.into_iter().enumerate() {
            cam.step(Position::from_raw(change.into()), &tables[nth % 2]);
        }
        cam.step(Position::whole(1), &[]);
    }

    #[test]
    fn a_product_modulo_is_that_of_the_numbers(a in 0_i128..1 << 60, b in any::<i64>(), m in 1_i128..1 << 60) {
        prop_assert_eq!(multiply_modulo(a % m, b.into(), m), ((a % m) * i128::from(b)).rem_euclid(m));
    }
}
