//! A rotary axis that runs at a speed from a table.

use super::*;

/// Returns a rig whose disc follows cell `l` (0.0001 rpm) by table t, 0 to 100 to 0 rpm at 0, 50 and 100 rpm, without
/// inputs.
pub(in crate::machine::tests) fn follows() -> Rig {
    let mut slot = slot("wind", 0, Type::Dfkt);
    (slot.source, slot.sink) = (SourceConfig::Signal("l".into()), SinkConfig::Axis(DISC));
    slot.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    (slot.tables[0], slot.tables[1]) = (Some(0), Some(1));
    for (name, value) in [
        ("table_count", 2),
        ("active_table", 1),
        ("div", 1),
        ("mult", 1),
        ("in_final", 100),
        ("out_max", 80),
        ("out_min", -80),
        ("ratio_max", 10),
        ("ratio_min", -10),
        ("ratio_div", 1),
    ] {
        slot.values[usize::from(field(Type::Dfkt, name))] = value;
    }
    let mut config = cell(vec![slot]);
    let y = |points: &[i64]| Arc::new(Table::new(Form::Y, &[], points).expect("points"));
    config.tables = vec![
        TableConfig { name: "t".into(), table: y(&[0, 100, 0]) },
        TableConfig { name: "flat".into(), table: y(&[30, 30]) },
    ];
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// Proves: AMK-DFKT-02, AMK-DFKT-03, AMK-DFKT-35, AMK-DFKT-42, AMK-BCOM-27, AMK-BCOM-37
#[test]
fn a_rotary_axis_runs_a_speed_by_a_table_and_reset_ends_it() {
    let mut rig = follows();
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    assert_eq!((rig.int("wind.sink"), rig.state("disc"), rig.int("disc.reference")), (0, "STANDSTILL", 8));
    // 15 rpm: 30 rpm of 600 inc/s each, accelerated by 500 inc/s per cycle.
    rig.give(Action::set_memory(2, 150_000.0));
    rig.run(10);
    assert_eq!(rig.int("wind.sink"), 300_000);
    assert!(rig.real("disc.command.velocity") <= 5_500.0, "on its ramp");
    rig.run(60);
    assert_eq!((rig.real("disc.command.velocity"), rig.int("disc.in_velocity")), (18_000.0, 1));
    // 50 rpm would be 100, limited to 80; above the peak of the table the speed decreases.
    rig.give(Action::set_memory(2, 500_000.0));
    rig.run(200);
    assert_eq!((rig.int("wind.sink"), rig.real("disc.command.velocity")), (800_000, 48_000.0));
    rig.give(Action::set_memory(2, 900_000.0));
    rig.run(200);
    assert_eq!((rig.int("wind.sink"), rig.real("disc.command.velocity")), (200_000, 12_000.0));
    assert_eq!((rig.int("wind.out1"), rig.int("lamp")), (0, 0), "without inputs there are no outputs");
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("wind.sink"), rig.int("wind.active"), rig.int("lamp")), (0, 0, 0));
    rig.run(100);
    assert_eq!((rig.real("disc.command.velocity"), rig.state("disc")), (0.0, "STANDSTILL"));
}

/// 50 rpm are 100 by the table, limited to 80 by out_max; 110 rpm are beyond its end, and -1 rpm before its start.
/// Proves: AMK-DFKT-52, AMK-DFKT-53, AMK-DFKT-54
#[test]
fn signals_show_the_limits_ratio_and_table_of_a_speed_by_a_table() {
    let shown = |rig: &Rig| {
        ["limit.out_max", "limit.table_high", "limit.table_low", "ratio.mult", "ratio.div", "table"]
            .map(|name| rig.int(&format!("wind.{name}")))
    };
    let mut rig = follows();
    assert_eq!(shown(&rig), [0; 6]);
    rig.give(order(0, Order::Start));
    assert_eq!(shown(&rig), [0, 0, 0, 1, 1, 1]);
    for (input, expected) in [(500_000.0, [1, 0, 0]), (1_100_000.0, [0, 1, 0]), (-10_000.0, [0, 0, 1])] {
        rig.give(Action::set_memory(2, input));
        rig.run(1);
        assert_eq!(shown(&rig)[..3], expected, "{input}");
    }
    rig.give(with(0, Order::ValueNew, &[(field(Type::Dfkt, "active_table"), 2), (field(Type::Dfkt, "mult"), -7)]));
    rig.run(1);
    assert_eq!(shown(&rig)[3..], [-7, 1, 2]);
    rig.give(order(0, Order::Reset));
    assert_eq!(shown(&rig), [0; 6]);
}

/// Proves: AMK-DFKT-35, AMK-DFKT-36, AMK-DFKT-40, AMK-DFKT-46, AMK-DFKT-47
#[test]
fn an_input_runs_and_stops_it_and_a1_stands_for_rest() {
    let mut rig = follows();
    rig.give(Action::set_memory(2, 150_000.0));
    // No input is wired: the function never runs.
    rig.give(with(0, Order::Start, &[(field(Type::Dfkt, "ba"), 2)]));
    rig.run(5);
    assert_eq!((rig.int("wind.sink"), rig.int("lamp"), rig.int("wind.out1")), (0, 1, 1));
    let mut config = rig.machine.config().clone();
    config.slots[0].inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    config.slots[0].values[0] = 2;
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::set_memory(2, 150_000.0));
    rig.give(order(0, Order::Start));
    assert_eq!((rig.int("wind.sink"), rig.int("lamp")), (0, 1));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(60);
    assert_eq!((rig.int("wind.sink"), rig.int("lamp"), rig.real("disc.command.velocity")), (300_000, 0, 18_000.0));
    rig.modify_inputs = |inputs| inputs.digital[0] = 0;
    rig.run(1);
    assert_eq!((rig.int("wind.sink"), rig.int("lamp")), (0, 1), "the ramp is that of the axis");
    rig.run(60);
    assert_eq!(rig.real("disc.command.velocity"), 0.0);
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("lamp"), rig.int("wind.out1")), (1, 1));
}

/// Proves: AMK-DFKT-01, AMK-DFKT-25
#[test]
fn tables_that_do_not_run_get_new_numbers() {
    let mut rig = follows();
    rig.give(Action::set_memory(2, 150_000.0));
    let load = |index, points: &[i64]| {
        let table = Arc::new(Table::new(Form::Y, &[], points).expect("points"));
        Action::LoadTable { index, table }
    };
    // In the cycle of START, too.
    let last = rig.give_all(vec![order(0, Order::Start), load(0, &[0, 10]), load(1, &[20, 20])]);
    assert_eq!(rig.answer(last - 1).expect_err("it runs from now on").code, Code::AMK_TABLE_IN_USE);
    assert!(rig.was_accepted(last - 2) && rig.was_accepted(last));
    rig.run(1);
    assert_eq!(rig.int("wind.sink"), 300_000);
    let refused = rig.give(load(0, &[0, 10]));
    assert!(rig.refusal(refused).ends_with("Tab0 is the one that runs, which gets no new numbers"));
    let refused = rig.give(load(1, &[0, 40_000]));
    assert_eq!(rig.answer(refused).expect_err("no speed").code, Code::AMK_SPEED_POINT);
    rig.give(with(0, Order::ValueNew, &[(field(Type::Dfkt, "active_table"), 2)]));
    assert_eq!(rig.int("wind.sink"), 200_000);
    let taken = rig.give(load(0, &[0, 10]));
    assert!(rig.was_accepted(taken), "{:?}", rig.answer(taken));
    // A machine restored from here has the same tables.
    rig.mirror();
    rig.run(60);
    assert_eq!((rig.int("wind.sink"), rig.real("disc.command.velocity")), (200_000, 12_000.0));
}

/// Proves: AMK-DFKT-11, AMK-DFKT-25
#[test]
fn the_table_of_a_start_counts_in_its_cycle_also_where_inputs_choose() {
    let mut rig = follows();
    let start = with(0, Order::Start, &[(field(Type::Dfkt, "ba"), 2)]);
    let load = |index| {
        let table = Arc::new(Table::new(Form::Y, &[], &[0, 10]).expect("points"));
        Action::LoadTable { index, table }
    };
    let last = rig.give_all(vec![start, load(0), load(1)]);
    assert_eq!(rig.answer(last - 1).expect_err("it is active").code, Code::AMK_TABLE_IN_USE);
    assert!(rig.was_accepted(last));
    // A VALUE_NEW in that cycle belongs to START.
    rig.give(order(0, Order::Reset));
    let [start, active] = [field(Type::Dfkt, "ba"), field(Type::Dfkt, "active_table")];
    let beyond = with(0, Order::ValueNew, &[(active, 3)]);
    let last = rig.give_all(vec![with(0, Order::Start, &[(start, 2)]), beyond.clone()]);
    assert_eq!(rig.answer(last).expect_err("two tables count").code, Code::AMK_BEYOND);
    let taken = rig.give(beyond);
    assert!(rig.was_accepted(taken), "active_table is not evaluated from then on");
}

/// Proves: AMK-DFKT-01
#[test]
fn an_eighth_table_is_refused_at_start() {
    let mut config = follows().machine.config().clone();
    config.slots[0].tables[7] = Some(1);
    let mut rig = Rig::of(config);
    let refused = rig.give(order(0, Order::Start));
    assert_eq!(rig.answer(refused).expect_err("nothing writes tables").code, Code::AMK_OUTPUT_TABLE);
    assert!(rig.refusal(refused).contains("Tab7 would be a table that the function writes"));
}
