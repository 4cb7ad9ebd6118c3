//! Every action that an interface creates can be written and read back bit by bit.

use super::*;
use lineshaft_core::parameter::{Layer, PROFILES, ParameterInput, ROWS};
use lineshaft_core::request::{
    CamRequest, MoveRequest, Named, NewVerb, PointRequest, Presence, REQUESTS, Rates, SetpointRequest,
    SynchronizeRequest, ToleranceRequest, TrajectoryRequest, UnitOf, Units, Verb, VerbFields, factor,
};
use lineshaft_core::trajectory::{OnExcess, TrajectoryLimits};
use lineshaft_core::unit::Fraction;
use lineshaft_core::vocabulary::saia::{self, Command as SaiaCommand, Register};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use std::ops::RangeInclusive;
use std::sync::LazyLock;

static DESK: LazyLock<Desk> = LazyLock::new(Desk::new);

const AXES: [&str; 5] = ["x", "turret", "odd", "fine", "coarse"];

/// Writes an action and reads it back. Debug shows every bit of an f64 except those of NaN, which is not equal to
/// itself.
fn round_trips(action: &Action) -> Result<(), TestCaseError> {
    let json = DESK.write(action);
    match DESK.read(&json) {
        Ok(read) => {
            prop_assert_eq!(format!("{:?}", &read), format!("{:?}", action), "{}", &json);
            prop_assert_eq!(&read, action, "{}", &json);
        }
        Err(sentence) => prop_assert!(false, "{json}: {sentence}"),
    }
    let plain: serde_json::Value = serde_json::from_str(&json).map_err(|e| TestCaseError::fail(e.to_string()))?;
    prop_assert_eq!(plain.as_object().map(serde_json::Map::len), Some(1), "JSON, one verb");
    Ok(())
}

/// Numbers that clients send, and any others.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e6..1e6_f64,
        2 => (-99_999_i64..99_999, 0..9).prop_map(|(digits, places)| digits as f64 / 10_f64.powi(places)),
        2 => (-1.0..1.0_f64, -40..20).prop_map(|(digits, places)| digits * 10_f64.powi(places)),
        1 => prop::sample::select(&[
            0.0, -0.0, 5e-324, -5e-324, f64::MIN_POSITIVE, 1e-24, 5e-25, 1e-22, 9.999999999999999e-23, 1e16, 1e22, 1e37,
            -1.7e38, 1e300, f64::MAX, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.1, 1.0 / 3.0, std::f64::consts::TAU,
        ][..]),
        1 => any::<u64>().prop_map(f64::from_bits),
    ]
}

fn quantity(order: u8) -> impl Strategy<Value = Option<Quantity>> {
    let suffix = ["", "/s", "/s^2", "/s^3"][usize::from(order)];
    let names: &[&str] = if order == 1 { &["mm/min", "rpm"] } else { &[] };
    let plain = ["nm", "mm", "m", "deg", "rad", "rev", "inc"].map(|name| format!("{name}{suffix}"));
    let units: Vec<String> = plain.into_iter().chain(names.iter().map(|name| (*name).to_owned())).collect();
    let digits = prop_oneof!["-?[0-9]{1,20}\\.[0-9]{1,18}", "-?[0-9]{1,17}e-?[0-3]?[0-9]", "-?[0-9]{1,4}"];
    (digits, prop::sample::select(units)).prop_map(move |(number, unit)| {
        let scale = DESK.config.axes[usize::from(unit.contains("deg") || unit.contains('r'))].scale;
        Quantity::parse(&format!("{number} {unit}"), &scale.dimensions(order)).ok()
    })
}

/// A value of a request, often 0, for which the field is left out.
fn amount(order: u8) -> impl Strategy<Value = Amount> {
    prop_oneof![
        3 => Just(Amount::default()),
        3 => number().prop_map(Amount::Number),
        1 => quantity(order).prop_map(|quantity| quantity.map_or(Amount::default(), Amount::Quantity)),
    ]
}

fn axis() -> impl Strategy<Value = String> {
    prop::sample::select(&AXES[..]).prop_map(str::to_owned)
}

fn units() -> impl Strategy<Value = Units> {
    prop::sample::select(&[Units::Si, Units::AxisUnit, Units::Increments][..])
}

/// Fills the fields of a request with values that are often valid.
struct Dice(TestRunner);

impl Dice {
    fn draw<T>(&mut self, strategy: impl Strategy<Value = T>) -> T {
        strategy.new_tree(&mut self.0).expect("a value").current()
    }

    /// Draws a value; often the default for a field that may be left out.
    fn often<T>(&mut self, presence: Presence, strategy: impl Strategy<Value = T>, value: &mut T) {
        if presence != Presence::Optional || self.draw(0..3) == 0 {
            *value = self.draw(strategy);
        }
    }

    /// Returns a request of a verb; the same for the same seed.
    fn request(verb: NewVerb, seed: &[u8; 32]) -> Box<dyn Verb> {
        let numbers = TestRng::from_seed(RngAlgorithm::ChaCha, seed);
        let mut request = verb();
        request.fields(&mut Self(TestRunner::new_with_rng(ProptestConfig::default(), numbers)));
        request
    }
}

impl VerbFields for Dice {
    fn has(&self, _: &str) -> bool {
        false
    }

    fn list_in_order(&mut self, _: &[&'static str]) {}

    fn id(&mut self) {}

    fn name(&mut self, key: &'static str, of: Named, _: Presence, value: &mut String) {
        let names: &[&str] = match of {
            Named::Axis => &AXES,
            Named::Position => &["x", "turret", "odd", "fine", "coarse", "belt", "x.master", "fine.master"],
            Named::Leader => &["", "x", "x.command", "turret.actual", "belt", "sum", "machine.vmaster"],
            Named::Other if key == "table" => &["", "knife"],
            Named::Other => &["", "mark", "belt"],
        };
        *value = self.draw(prop::sample::select(names)).to_owned();
    }

    fn choice(&mut self, _: &'static str, names: &[&'static str], presence: Presence, number: &mut u8) {
        self.often(presence, 0..names.len() as u8, number);
    }

    fn word(&mut self, _: &'static str, names: &[&'static str], number: &mut u8) {
        *number = self.draw(0..names.len() as u8);
    }

    fn units(&mut self, given: &mut Units) {
        *given = self.draw(units());
    }

    fn amount(&mut self, _: &'static str, order: u8, _: UnitOf, presence: Presence, value: &mut Amount) {
        self.often(presence, amount(order), value);
    }

    fn increments(&mut self, key: &'static str, _: UnitOf, value: &mut i64) {
        self.whole(key, i64::MIN..=i64::MAX, Presence::Optional, value);
    }

    fn whole(&mut self, _: &'static str, range: RangeInclusive<i64>, presence: Presence, value: &mut i64) {
        let (low, high) = range.into_inner();
        self.often(presence, prop_oneof![Just(0), -5..5_i64, low..=high], value);
    }

    fn real(&mut self, _: &'static str, range: RangeInclusive<f64>, value: &mut f64) {
        let (low, high) = range.into_inner();
        *value = self.draw(low..high);
    }

    fn boolean(&mut self, _: &'static str, _: bool, value: &mut bool) {
        *value = self.draw(any::<bool>());
    }

    fn fraction(&mut self, _: &'static str, value: &mut Fraction) {
        let parts = (-3000..3000_i128, prop::sample::select(vec![1, 7, 1000, 32_768, 1_000_000_000]));
        self.often(Presence::Optional, parts.prop_map(|(whole, parts)| Fraction::new(whole, parts)), value);
    }

    fn belongs(&mut self, _: &'static str, _: bool, _: &'static str) {}
}

fn cam_request() -> impl Strategy<Value = CamRequest> {
    let scale = (-3000_i64..3000, prop::sample::select(vec![1.0, 7.0, 1e3, 32_768.0, 1e9]))
        .prop_map(|(whole, parts)| factor("master_scale", whole as f64 / parts).expect("a finite number"));
    let table = prop::sample::select(vec!["knife", "spoon"]).prop_map(str::to_owned);
    (table, 0..3_u8, (scale.clone(), scale), (amount(0), amount(0))).prop_map(
        |(table, start, (master_scale, slave_scale), (master_offset, slave_offset))| CamRequest {
            table,
            start,
            master_scale,
            slave_scale,
            master_offset,
            slave_offset,
        },
    )
}

fn camming_request() -> impl Strategy<Value = SynchronizeRequest> {
    let engage = prop_oneof![Just((0_u8, 0)), Just((3, 0)), any::<i64>().prop_map(|place| (1, place))];
    (synchronize_request(), cam_request(), engage).prop_map(|(request, cam, (engage, place))| SynchronizeRequest {
        mode: 3,
        engage,
        master_increments: place,
        numerator: 0,
        denominator: 0,
        offset: Amount::default(),
        cam,
        ..request
    })
}

/// Gears at a pair of positions, of which mode velocity has one, and at a latch.
fn waiting_request() -> impl Strategy<Value = SynchronizeRequest> {
    let event = prop::sample::select(vec!["mark", "belt", "x"]).prop_map(str::to_owned);
    let distance = prop_oneof![Just(0), 1_i64..100_000, any::<i64>()];
    (synchronize_request(), any::<bool>(), event, (any::<i64>(), any::<i64>(), distance)).prop_map(
        |(request, by_event, event, (master_increments, slave, distance))| {
            if by_event {
                return SynchronizeRequest { engage: 2, event, ..request };
            }
            let (slave_increments, start_distance_increments) =
                if request.mode == 1 { (slave, distance) } else { (0, 0) };
            let offset = Amount::default();
            SynchronizeRequest {
                engage: 1,
                master_increments,
                slave_increments,
                start_distance_increments,
                offset,
                ..request
            }
        },
    )
}

fn synchronize_request() -> impl Strategy<Value = SynchronizeRequest> {
    let masters = ["x", "x.command", "turret.actual", "belt", "odd"];
    let master = prop::sample::select(masters.to_vec()).prop_map(str::to_owned);
    let part = prop_oneof![Just(0), -5_i64..5, any::<i64>()];
    (axis(), master, 0..2_u8, 0..2_u8, (part.clone(), part), (amount(0), amount(1), amount(2))).prop_map(
        |(axis, master, mode, disengage, (numerator, denominator), (offset, velocity, acceleration))| {
            SynchronizeRequest {
                axis,
                master,
                event: String::new(),
                mode,
                engage: 0,
                disengage,
                numerator,
                denominator,
                offset,
                velocity,
                acceleration,
                ..SynchronizeRequest::default()
            }
        },
    )
}

/// A trajectory of some axes, with or without velocities and accelerations.
fn trajectory_request() -> impl Strategy<Value = TrajectoryRequest<Amount>> {
    let handy = || {
        prop_oneof![
            8 => (-1e3..1e3_f64).prop_map(Amount::Number),
            8 => "-?[0-9]{1,3}\\.[0-9]{1,12} inc".prop_map(|text| {
                Amount::Quantity(Quantity::parse(&text, &DESK.config.axes[0].scale.dimensions(0)).expect("a quantity"))
            }),
            1 => number().prop_map(Amount::Number),
        ]
    };
    let rates =
        || prop::collection::vec(prop_oneof![Just(Amount::default()), (-1e3..1e3_f64).prop_map(Amount::Number)], 5);
    let point = move || (prop::collection::vec(handy(), 5), prop::option::of(rates()), prop::option::of(rates()));
    let some = || prop::option::of((0.0..1e3_f64).prop_map(Amount::Number));
    let tolerance = move || {
        (some(), some(), some()).prop_map(|(position, velocity, acceleration)| ToleranceRequest {
            position,
            velocity,
            acceleration,
        })
    };
    let tolerances = move || prop::option::of(prop::collection::vec(tolerance(), 5));
    let axes = prop::sample::subsequence(AXES.to_vec(), 1..=5).prop_shuffle();
    let times = (0..1_u64 << 40, 1..1_u64 << 40, any::<i64>(), prop::option::of(0..1_u64 << 62));
    let points = prop::collection::vec(point(), 1..5);
    let start = prop::option::of(prop::collection::vec(some(), 5));
    let limits = (0.0..0.1_f64, any::<bool>(), 1.0..10.0_f64);
    let settings = (prop::option::of(limits), any::<bool>(), prop::option::of(0..1_u64 << 62), any::<bool>());
    (axes, units(), times, points, tolerances(), tolerances(), (start, settings)).prop_map(
        |(axes, units, (first, step, start_ns, goal_time_ns), points, path, goal, (start, settings))| {
            let (limits, angle_wraparound, max_duration_ns, may_end_in_motion) = settings;
            let limits = limits.map(|(margin, scales, max_stretch)| TrajectoryLimits {
                margin,
                on_excess: if scales { OnExcess::Scale } else { OnExcess::Refuse },
                max_stretch,
            });
            let start = start.map(|list: Vec<_>| {
                let of = |position| ToleranceRequest { position, ..ToleranceRequest::default() };
                list.into_iter().map(of).collect::<Vec<_>>()
            });
            let (count, last) = (axes.len(), points.len() - 1);
            let of = |list: Option<Vec<Amount>>| list.map_or(Vec::new(), |list| list[..count].to_vec());
            let points =
                points.into_iter().enumerate().map(|(place, (positions, velocities, accelerations))| PointRequest {
                    time_ns: first + place as u64 * step,
                    positions: positions[..count].to_vec(),
                    velocities: of(velocities.filter(|_| place < last || may_end_in_motion)),
                    accelerations: of(accelerations),
                });
            let tolerances = |list: Option<Vec<_>>| list.map_or(Vec::new(), |list| list[..count].to_vec());
            TrajectoryRequest {
                axes: axes.iter().map(|axis| (*axis).to_owned()).collect(),
                joints: Vec::new(),
                units,
                start_ns,
                points: points.collect(),
                path: tolerances(path),
                goal: tolerances(goal),
                goal_time_ns,
                start: tolerances(start),
                limits: limits.unwrap_or_default(),
                angle_wraparound,
                max_duration_ns,
                may_end_in_motion,
            }
        },
    )
}

fn input() -> impl Strategy<Value = ParameterInput> {
    let time = (-99_999_i64..i64::MAX, prop::sample::select(vec!["ns", "us", "ms", "s", "min"]))
        .prop_map(|(number, unit)| Quantity::parse(&format!("{number} {unit}"), &[]));
    let time = time.prop_map(|time| match time {
        Ok(time) | Err(lineshaft_core::unit::UnitError::WrongDimension { given: time, .. }) => Some(time),
        Err(_) => None,
    });
    let quantity = prop_oneof![time, (0..4_u8).prop_flat_map(quantity)];
    prop_oneof![
        number().prop_map(ParameterInput::Number),
        prop_oneof![-9..9_i64, any::<i64>()].prop_map(ParameterInput::Integer),
        quantity.prop_map(|quantity| quantity.map_or(ParameterInput::Unset, ParameterInput::Quantity)),
        prop::sample::select(PROFILES).prop_map(|name| ParameterInput::Text(name.to_owned())),
        Just(ParameterInput::Unset),
    ]
}

/// A length that is rounded correctly.
fn length() -> impl Strategy<Value = Length> {
    let whole = (1_i64 << 62) - 1;
    let nearest = prop_oneof![-3..=3_i64, -whole..=whole, Just(whole), Just(-whole)];
    let half = 1_i128 << 31;
    let rest = prop_oneof![
        Just(0),
        -half..=half,
        prop::sample::select(vec![half, -half, half - 1, 1 - half, half - 2, 2 - half, 1, -1]),
    ];
    (nearest, rest).prop_map(move |(nearest, rest)| {
        // A half is rounded away from 0, so that the remainder points towards 0.
        let away = (rest == half && nearest >= 0) || (rest == -half && nearest <= 0);
        Length { nearest, rest: Position::from_raw(if away { 0 } else { rest }) }
    })
}

fn axes() -> impl Strategy<Value = AxisSet> {
    prop::collection::vec(0..AXES.len() as u16, 1..6).prop_map(|axes| axes.into_iter().collect())
}

fn plain() -> impl Strategy<Value = Action> {
    let finite = number().prop_filter("a real number", |value| value.is_finite()).boxed();
    let whole = prop_oneof![-9..9_i64, any::<i64>()];
    let memory = prop_oneof![
        (finite.clone(), any::<bool>(), 0..3_usize).prop_map(|(volts, bit, which)| {
            let [lamp, speed] = [(2, f64::from(u8::from(bit))), (3, volts.clamp(-10.0, 10.0))]
                .map(|(index, value)| OutputValue { index, value });
            Action::SetOutputs(
                [vec![lamp], vec![speed], vec![speed, lamp]].into_iter().nth(which).unwrap_or_default().into(),
            )
        }),
        finite.prop_map(|value| Action::set_memory(2, value)),
        any::<i16>().prop_map(|value| Action::set_memory(0, f64::from(value))),
        // The largest f64 below 2^63; i64::MAX would be rounded to 2^63.
        whole.prop_map(|value| Action::set_memory(1, (value as f64).min(9_223_372_036_854_774_784.0))),
        any::<bool>().prop_map(|bit| Action::set_memory(3, f64::from(u8::from(bit)))),
    ];
    let text = prop_oneof![
        "\\PC{0,80}",
        any::<String>(),
        "(?s).{0,2000}",
        "[\\x00-\\x7f\u{80}-\u{a0}\u{2028}\u{feff}\u{fffe}]{0,9}"
    ];
    prop_oneof![
        axes().prop_map(Action::Enable),
        axes().prop_map(Action::Disable),
        axes().prop_map(Action::Halt),
        axes().prop_map(Action::QuickStop),
        axes().prop_map(Action::ResetErrors),
        Just(Action::Activate),
        Just(Action::Deactivate),
        Just(Action::Abort),
        axes().prop_map(Action::SaveParameters),
        (axes(), prop::sample::select(&[Layer::User, Layer::Init][..]))
            .prop_map(|(axes, layer)| Action::ResetParameters { axes, layer }),
        axes().prop_map(Action::DeleteParameters),
        Just(Action::PowerCycle),
        any::<u64>().prop_map(|goal| Action::Cancel { goal }),
        memory,
        text.prop_map(|text| Action::Refuse(text.into())),
        (prop::sample::select(&Code::NOTES[..]), any::<i64>()).prop_map(|(code, number)| Action::Note { code, number }),
    ]
}

fn saia() -> impl Strategy<Value = Option<Action>> {
    let register = prop::sample::select(Register::ALL.to_vec()).prop_map(|(register, _)| register.name());
    let input = prop_oneof![
        2 => number().prop_map(ParameterInput::Number),
        3 => any::<i32>().prop_map(|number| ParameterInput::Integer(number.into())),
        1 => any::<i64>().prop_map(ParameterInput::Integer),
    ];
    let commands: Vec<&str> = SaiaCommand::ALL.iter().map(|(_, name)| *name).collect();
    let (set, commands) =
        (prop::collection::vec((register, input), 0..5), prop::collection::vec(prop::sample::select(commands), 0..8));
    (0..AXES.len() as u16, set, commands).prop_map(|(axis, set, commands)| {
        let mut request = saia::Request { axis, ..saia::Request::default() };
        for (name, input) in &set {
            let (register, value) = DESK.config.resolve_saia_register(name, input).ok()?;
            request = request.with(register, value);
        }
        for name in commands {
            request.commands.insert(DESK.config.resolve_saia_command(name).ok()?);
        }
        Some(Action::vocabulary(request))
    })
}

/// Returns the fraction of the requests of a strategy that become commands.
fn share<T: std::fmt::Debug>(strategy: impl Strategy<Value = T>, is_good: impl Fn(T) -> bool) -> f64 {
    let mut runner = TestRunner::deterministic();
    let made = (0..2000).filter(|_| is_good(strategy.new_tree(&mut runner).unwrap().current())).count();
    made as f64 / 2000.0
}

#[test]
fn enough_requests_become_commands_for_the_laws_to_mean_something() {
    let config = &DESK.config;
    for (verb, request) in REQUESTS {
        let made = share(any::<[u8; 32]>(), |seed| Dice::request(request, &seed).resolve(config, true).is_ok());
        let least = match verb {
            "synchronize" => 0.01,
            "home_axis" => 0.5,
            "move_axis" | "set_position" => 0.2,
            _ => 0.1,
        };
        assert!(made > least, "{verb}: {made}");
    }
    let couplings = share(synchronize_request(), |request| config.resolve_recorded_synchronize(&request).is_ok());
    let waiting = share(waiting_request(), |request| config.resolve_recorded_synchronize(&request).is_ok());
    let trajectories = share(trajectory_request(), |request| config.resolve_trajectory(&request).is_ok());
    assert!(trajectories > 0.2, "{trajectories}");
    let rows = (axis(), prop::sample::select(ROWS), input());
    let changes =
        share(rows, |(axis, row, input)| config.resolve_parameter(&format!("{axis}.{}", row.key), &input).is_ok());
    let verbs = share(verb(), |text| DESK.read(&text).is_ok());
    assert!(share(saia(), |action| action.is_some()) > 0.2);
    assert!(couplings > 0.2 && waiting > 0.2 && changes > 0.05 && verbs > 0.2);
}

/// A verb as a user may write it, with arguments that may be wrong.
fn verb() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        "-?[0-9]{1,6}",
        "-?[0-9]{0,20}\\.[0-9]{1,20}",
        "-?[0-9]{1,17}e-?[0-4]?[0-9]",
        "-?0\\.0{20,30}[0-9]{1,10}",
    ];
    let unit = |units: &'static [&'static str]| prop::sample::select(units);
    let value = |units| (number.clone(), unit(units)).prop_map(|(number, unit)| format!("{number} {unit}"));
    let position = value(&["inc", "inc", "mm", "nm", "m", ""]);
    let velocity = value(&["inc/s", "inc/s", "mm/s", "mm/min", "m/s", ""]);
    let acceleration = value(&["inc/s^2", "inc/s^2", "mm/s^2", "m/s^2", ""]);
    let linear = prop::sample::select(vec!["x", "fine", "coarse"]);
    let units = prop::sample::select(vec!["si", "axis_unit", "increments"]);
    let goal = (linear, units, position, velocity, acceleration).prop_map(|(axis, units, position, velocity, rate)| {
        format!(
            "move_axis: {{axis: {axis}, units: {units}, position: {position}, velocity: {velocity}, deceleration: {rate}}}"
        )
    });
    let cells = prop::sample::select(vec!["feed", "big", "gain", "flag"]);
    let memory = (cells, number.clone()).prop_map(|(cell, number)| format!("set_memory: {{{cell}: {number}}}"));
    let rows = prop::sample::select(vec!["max_velocity", "default_velocity"]);
    let rates = value(&["inc/s", "deg/s", "rev/s", "rpm", "rad/s"]);
    let change = (rows, rates).prop_map(|(row, value)| format!("set_parameters: {{turret.{row}: {value}}}"));
    prop_oneof![goal, memory, change]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5000, max_global_rejects: 100_000, ..ProptestConfig::default() })]

    #[test]
    fn every_request_that_is_a_verb(seed in any::<[u8; 32]>()) {
        for (verb, request) in REQUESTS {
            if let Ok(action) = Dice::request(request, &seed).resolve(&DESK.config, true) {
                let (described, again) = DESK.config.describe(&action).expect("a request");
                prop_assert_eq!(described, verb);
                prop_assert_eq!(again.resolve(&DESK.config, true), Ok(action.clone()));
                round_trips(&action)?;
            }
        }
    }

    #[test]
    fn every_coupling_that_a_request_makes(request in prop_oneof![synchronize_request(), camming_request(), waiting_request()]) {
        if let Ok(action) = DESK.config.resolve_recorded_synchronize(&request) {
            round_trips(&Action::Synchronize(action))?;
        }
    }

    #[test]
    fn every_trajectory_that_a_request_makes(request in trajectory_request()) {
        if let Ok(trajectory) = DESK.config.resolve_trajectory(&request) {
            round_trips(&Action::Trajectory(trajectory.into()))?;
        }
    }

    #[test]
    fn every_order_and_goal_of_a_function(
        values in prop::collection::btree_map(0_u16..8, any::<i64>(), 0..8),
        (order, ..) in prop::sample::select(Order::ALL.to_vec()),
    ) {
        let values: Box<[(u16, i64)]> = values.into_iter().collect();
        round_trips(&Action::RunFunction(RunFunction { slot: 0, values: values.clone() }))?;
        round_trips(&Action::CommandFunction(CommandFunction { slot: 0, order, values }))?;
    }

    #[test]
    fn every_set_of_parameters(
        requests in prop::collection::vec((axis(), prop::sample::select(ROWS), input()), 1..6)
    ) {
        let mut changes: Vec<Change> = Vec::new();
        for (axis, row, input) in requests {
            let change = DESK.config.resolve_parameter(&format!("{axis}.{}", row.key), &input);
            // Each parameter at most once.
            changes.extend(change.ok().filter(|new| changes.iter().all(|old| (old.axis, old.row) != (new.axis, new.row))));
        }
        if !changes.is_empty() {
            round_trips(&Action::SetParameters(changes.into()))?;
        }
    }

    #[test]
    fn every_verb_of_a_scenario(text in verb()) {
        if let Ok(action) = DESK.read(&text) {
            round_trips(&action)?;
        }
    }

    #[test]
    fn every_target_and_offset(target in length(), axis in 0..5_u16, mode in 0..4_usize) {
        let modes = [MoveMode::Absolute, MoveMode::Relative, MoveMode::Additive, MoveMode::Velocity];
        round_trips(&Action::Move(Move { mode: modes[mode], ..to(axis, target) }))?;
        round_trips(&Action::Synchronize(Coupling {
            axis,
            leader: Some(Leader::Encoder(0)),
            mode: SyncMode::Position,
            engage: Engage::Immediately,
            disengage: Disengage::Stop,
            numerator: 1,
            denominator: 1,
            offset: target,
            velocity: 0.0,
            acceleration: 0.0,
            cam: None,
        }))?;
    }

    #[test]
    fn every_verb_of_saia(action in saia()) {
        if let Some(action) = action {
            round_trips(&action)?;
        }
    }

    #[test]
    fn every_other_action(action in plain()) {
        round_trips(&action)?;
    }

    #[test]
    fn non_finite_number_never_becomes_a_command(
        value in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e39]), units in units(), field in 0..5
    ) {
        let mut request = MoveRequest { axis: "x".into(), units, ..MoveRequest::default() };
        let MoveRequest { position, rates: Rates { velocity, acceleration, deceleration, jerk }, .. } = &mut request;
        *[position, velocity, acceleration, deceleration, jerk][field as usize] = Amount::Number(value);
        prop_assert!(DESK.config.resolve_recorded_move(&request).is_err());
    }

    #[test]
    fn no_text_is_more_than_one_sentence(text in prop_oneof![any::<String>(), "[{}\\[\\]\":, a-z0-9_]{0,40}", verb()]) {
        if let Err(sentence) = DESK.read(&text) {
            prop_assert!(!sentence.contains('\n') && sentence.len() < 2000, "{}", sentence);
        }
    }
}

proptest! {
    /// Setpoints that an interface creates can be written and read back bit by bit, like commands.
    #[test]
    fn setpoints_come_back(
        given in prop::collection::vec((0..5_usize, number(), prop::option::of(any::<u64>())), 1..5),
        units in prop::sample::select(vec![Units::Si, Units::AxisUnit, Units::Increments]),
    ) {
        let of = |&(axis, velocity, duration): &(usize, f64, Option<u64>)| {
            SetpointRequest { axis: AXES[axis].to_owned(), velocity: Amount::Number(velocity), duration }
        };
        let requests: Vec<_> = given.iter().map(of).collect();
        if let Ok(set) = DESK.config.resolve_setpoints(Source::Ros, units, &requests) {
            let json = setpoints_to_json(&set, &DESK.config);
            let read = applied_from_json(&json, Source::Ros, &DESK.config, &DESK.directory);
            prop_assert_eq!(format!("{:?}", read), format!("{:?}", Ok::<_, String>(Applied::Stream(set))), "{}", json);
        }
    }
}
