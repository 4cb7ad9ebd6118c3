use super::*;
use crate::event::Number;
use crate::function::program::SourceValue;
use crate::function::trial::tab0;
use crate::function::trial::{at_rest, setting, with_memory};
use crate::table::{Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

fn table(head: &[(usize, i64)], cams: &[(i32, i32)]) -> Arc<Table> {
    let mut words = vec![0; 32];
    for (place, value) in head {
        words[*place] = *value;
    }
    for x in cams.iter().flat_map(|(on, off)| [*on, *off]) {
        words.extend([x as u16, (x >> 16) as u16].map(i64::from));
    }
    Arc::new(Table::new(Form::Words, &[], &words).expect("words"))
}

/// The example of the manual: four tracks of two cams, of which the second one is always off.
fn example(head: &[(usize, i64)]) -> Arc<Table> {
    table(head, &[10_000, 11_000, 12_000, 13_000].map(|on| [(on, on + 1000), (0, 0)]).concat())
}

fn set(fields: &[(usize, i64)]) -> Vec<i64> {
    let mut words = vec![0; crate::function::field::width(FIELDS)];
    words[MODULO] = 20_000;
    for (place, value) in fields {
        words[*place] = *value;
    }
    words
}

const EXAMPLE: [(usize, i64); 6] = [(BA, 1), (SF_CYCLE, 2), (CAMS, 2), (CAMS + 1, 2), (CAMS + 2, 2), (CAMS + 3, 2)];

/// One track of one cam, incremental.
const ONE: [(usize, i64); 2] = [(BA, 1), (CAMS, 1)];

fn with(fields: &[(usize, i64)], more: &[(usize, i64)]) -> Vec<i64> {
    set(&[fields, more].concat())
}

/// A function with its table, 1 ms per call.
struct Bench {
    table: Arc<Table>,
    cam: Cam,
    call_ns: u64,
    inputs: u8,
}

impl Bench {
    fn new(table: Arc<Table>) -> Self {
        Self { table, cam: Cam::new(&with_memory(100, MOST_CAMS)), call_ns: 1_000_000, inputs: 0 }
    }

    fn check(&self, words: &[i64]) -> Result<(), Fault> {
        let mut tables = [None; LINES];
        tables[0] = Some(&*self.table);
        self.cam.check(Words(words), &setting(self.call_ns, tables))
    }

    fn call(&mut self, words: Option<&[i64]>, value: i64) -> Outcome {
        if let Some(words) = words {
            assert_eq!(self.check(words), Ok(()));
        }
        let tables = tab0(&self.table);
        let source = SourceValue { value, travel: value, mark: None };
        let (call_ns, inputs, drives) = (self.call_ns, self.inputs, crate::function::NO_DRIVES);
        let seen = CallInputs { call_ns, source, inputs, sink: 77, words: [0; 2], tables, drives, ..at_rest() };
        match words {
            Some(words) => self.cam.start(Words(words), &seen),
            None => self.cam.step(&seen),
        }
    }

    fn start(&mut self, words: &[i64], value: i64) -> u8 {
        self.call(Some(words), value).outputs
    }

    fn step(&mut self, value: i64) -> u8 {
        self.call(None, value).outputs
    }

    fn steps(&mut self, values: &[i64]) -> String {
        values.iter().map(|value| if self.step(*value) & 1 == 1 { '1' } else { '0' }).collect()
    }
}

/// Proves: AMK-CAM-O1, AMK-CAM-04, AMK-CAM-06, AMK-CAM-43, AMK-CAM-44, AMK-CAM-46
#[test]
fn the_example_of_the_manual_switches_where_it_says() {
    let mut bench = Bench::new(example(&[]));
    // Cam 0 of track 1 is the third one, cam 1 of track 3 the eighth.
    assert_eq!((bench.table.double(40), bench.table.double(42), bench.table.double(60)), (11_000, 12_000, 0));
    assert_eq!(bench.start(&set(&EXAMPLE), 700), 0, "x is 0 where the source stands at START");
    let at = [
        (9_999, 0),
        (10_000, 1),
        (10_999, 1),
        (11_000, 2),
        (12_000, 4),
        (13_999, 8),
        (14_000, 0),
        (30_000, 1),
        (-10_000, 1),
    ];
    for (x, outputs) in at {
        assert_eq!(bench.step(700 + x), outputs, "x {x}");
    }
    // Offset 500 on track 0.
    let mut bench = Bench::new(example(&[(8, 500)]));
    bench.start(&set(&EXAMPLE), 0);
    assert_eq!([9_499, 9_500, 9_600, 10_499, 10_500].map(|x| bench.step(x)), [0, 1, 1, 1, 0]);
    // 19800 plus offset is 300.
    bench.table = table(&[(8, 500)], &[(300, 301)]);
    bench.start(&set(&ONE), 0);
    assert_eq!(bench.steps(&[19_799, 19_800, 19_801]), "010");
}

/// Proves: AMK-CAM-O3, AMK-CAM-05, AMK-CAM-38
#[test]
fn a_turn_in_time_takes_the_cycle_time_of_the_table() {
    let mut bench = Bench::new(example(&[(0, 10_000)]));
    let mut outputs = vec![bench.start(&with(&EXAMPLE, &[(BA, 2)]), 0) & 1];
    outputs.extend((1..10_000).map(|k| bench.step(k) & 1));
    // 2.50 s up to 2.75 s of each 5 s, 1 ms per call.
    let expected = (0..10_000).map(|k| u8::from((2500..2750).contains(&(k % 5000)))).collect::<Vec<_>>();
    assert_eq!(outputs, expected);
}

/// 100 inc in 1.5 ms, 0.5 ms per call: 33 1/3 inc per call do not drift; then in 2 ms: 25 inc per call.
/// Proves: AMK-CAM-05, AMK-CAM-01
#[test]
fn fractions_of_a_turn_in_time_are_kept() {
    let cams = [(0, 1)];
    let mut bench = Bench { call_ns: 500_000, ..Bench::new(table(&[(0, 3)], &cams)) };
    let words = set(&[(BA, 2), (MODULO, 100), (CAMS, 1)]);
    assert_eq!(bench.start(&words, 0), 1);
    assert_eq!(bench.steps(&[0; 9]), "001001001");
    bench.step(0);
    bench.table = table(&[(0, 4)], &[(8, 9)]);
    // 33 1/3 + 25 * 3 = 108 1/3.
    assert_eq!(bench.steps(&[0; 4]), "0010");
    // 33 1/3 + 25 * 4 = 133 1/3, then with 33 1/3 again: 166 2/3, 200: no fraction was lost.
    bench.table = table(&[(0, 3)], &[(0, 1)]);
    assert_eq!(bench.steps(&[0; 5]), "01001");
}

/// Proves: AMK-CAM-03
#[test]
fn the_absolute_mode_ends_where_32_bits_end() {
    let (first, last) = (i64::from(i32::MIN), i64::from(i32::MAX));
    let mut bench = Bench::new(table(&[(8, 100)], &[(i32::MAX, i32::MIN), (-5, 5), (i32::MIN, i32::MIN + 50)]));
    let words = set(&[(BA, 0), (MODULO, 0), (CAMS, 3)]);
    assert_eq!(bench.start(&words, 0), 0);
    // With offset 100, x is limited from 2^31 - 101 on; at the lower end likewise.
    assert_eq!(bench.steps(&[-106, -105, -96, -95, last - 101, last - 100, last, i64::MAX]), "01100111");
    assert_eq!(bench.steps(&[first - 200, first - 50, first]), "000");
    bench.table = table(&[(8, -100)], &[(i32::MIN, i32::MIN + 50), (0, 0), (0, 0)]);
    assert_eq!(bench.steps(&[i64::MIN, first, first + 149, first + 150]), "1110");
}

/// Proves: AMK-CAM-07, AMK-CAM-08
#[test]
fn cams_of_a_track_are_one_where_they_overlap() {
    let mut bench = Bench::new(table(&[], &[(100, 200), (150, 300), (500, 500), (19_000, 25_000), (19_900, 50)]));
    bench.start(&set(&[(BA, 1), (CAMS, 5)]), 0);
    assert_eq!(bench.steps(&[49, 50, 99, 100, 199, 299, 300, 500, 18_999, 19_000, 19_999]), "10011100011");
}

/// Proves: AMK-CAM-09, AMK-CAM-39, AMK-CAM-40, AMK-CAM-48
#[test]
fn an_offset_is_the_sum_of_all_changes_and_one_is_shown() {
    let mut bench = Bench::new(example(&[(1, 3), (8 + 3, -100)]));
    let sink = |bench: &mut Bench, word: i64| {
        bench.table = example(&[(1, 3), (8 + 3, word)]);
        bench.call(None, 0).sink
    };
    assert_eq!(bench.call(Some(&set(&EXAMPLE)), 0).sink, 19_900, "within the modulo");
    assert_eq!([-100, 0, 150, 32_767].map(|word| sink(&mut bench, word)), [19_900, 0, 150, 12_767]);
    // Across the end of 16 bits: 2 more.
    assert_eq!(sink(&mut bench, -32_767), 12_769);
    assert_eq!(bench.step(800) & 8, 8, "13569");

    let absolute = with(&EXAMPLE, &[(BA, 0)]);
    assert_eq!(bench.call(Some(&absolute), 0).sink, -32_767);
    assert_eq!([0, 32_767, -32_767, 0].map(|word| sink(&mut bench, word)), [0, 32_767, 32_769, 65_536]);
    // A track without cams can be selected as well; the high byte of the word is ignored.
    bench.table = example(&[(1, 0x0705), (8 + 5, 9)]);
    assert_eq!(bench.call(None, 0).sink, 9);
}

/// A brake cam: it switches 10 ms before its position, from either direction.
/// Proves: AMK-CAM-10, AMK-CAM-11, AMK-CAM-41
#[test]
fn a_brake_cam_leads_with_the_velocity_and_turns_with_it() {
    let mut bench = Bench::new(table(&[(16, 20)], &[(10_000, 11_000)]));
    let words = with(&ONE, &[(DEAD_TIME_MEAN, 2)]);
    // 100 inc per ms, 10 ms: 1000 ahead.
    assert_eq!(bench.start(&words, 0), 0);
    for k in 1..=89 {
        assert_eq!(bench.step(100 * k), 0, "{k}");
    }
    assert_eq!(bench.steps(&[9_000, 9_100]), "11");
    // The press stops: mean 50, 500 ahead, then no lead.
    assert_eq!(bench.steps(&[9_100, 9_100]), "00");
    // A jump: the mean is 700 in two calls, 7000 ahead; then it rests on the cam.
    assert_eq!(bench.steps(&[10_500, 10_500, 10_500]), "001");
    // In negative direction, 100 inc per ms: on below 12000, where the lead reaches 11000, off below 11000.
    bench.steps(&[13_000, 13_000, 13_000]);
    let back = (1..=21).map(|k| 13_000 - 100 * k).collect::<Vec<_>>();
    assert_eq!(bench.steps(&back), "000000000011111111110");
    // The direction changes: a mean of -25 is still 250 back from 10950, then +50 is 500 ahead of 11000.
    assert_eq!(bench.steps(&[10_950, 11_000]), "10");
    // Across the wrap: 1000 back from -900 is 18100.
    bench.table = table(&[(16, 20)], &[(18_100, 18_101)]);
    bench.start(&words, 0);
    assert_eq!(bench.steps(&(1..=10).map(|k| -100 * k).collect::<Vec<_>>()), "0000000010");
}

/// Proves: AMK-CAM-10
#[test]
fn the_absolute_mode_and_the_time_mode_lead_as_well() {
    let mut bench = Bench::new(table(&[(16, 4)], &[(400, 401)]));
    let words = set(&[(CAMS, 1)]);
    bench.start(&words, 100);
    // 100 inc per ms, 2 ms: 200 ahead.
    assert_eq!(bench.steps(&[200, 300]), "10");
    // 100 inc in 1.5 ms, 0.5 ms per call: 33 1/3 inc, a lead of 2 ms = 133 1/3.
    let mut bench = Bench { call_ns: 500_000, ..Bench::new(table(&[(0, 3), (16, 4)], &[(66, 67), (0, 1)])) };
    bench.start(&set(&[(BA, 2), (MODULO, 100), (CAMS, 2)]), 0);
    // 166 2/3, exactly 200, 233 1/3, 266 2/3.
    assert_eq!(bench.steps(&[0; 4]), "1101");
}

/// The lead of track 0, which has a dead time; track 1 has the same position without one.
fn lead(bench: &Bench) -> i64 {
    let lanes = bench.cam.course.as_ref().expect("a started cam").lanes;
    (lanes[0].x - lanes[1].x).rem_euclid(20_000)
}

/// A turn of 20000 inc in 200 ms, then in 20 ms: 100 and 1000 inc per call, and a dead time of one call. Of 20 calls, n
/// have the new velocity: the mean is 100 + 45 n.
///
/// Proves: AMK-CAM-05, AMK-CAM-10, AMK-CAM-11
#[test]
fn time_mode_averages_the_velocity_when_the_cycle_time_changes() {
    let timed = |cycle_time| table(&[(0, cycle_time), (16, 2)], &[(0, 1), (0, 1)]);
    let leads = |mean: i64, calls: i64| {
        let mut bench = Bench::new(timed(400));
        bench.start(&set(&[(BA, 2), (DEAD_TIME_MEAN, mean), (CAMS, 1), (CAMS + 1, 1)]), 0);
        assert_eq!(lead(&bench), 0, "it has not moved yet");
        for _ in 0..30 {
            bench.step(0);
            assert_eq!(lead(&bench), 100, "the mean of the calls since START");
        }
        bench.table = timed(40);
        let step = |bench: &mut Bench| {
            bench.step(0);
            lead(bench)
        };
        (0..calls).map(|_| step(&mut bench)).collect::<Vec<_>>()
    };
    let rising: Vec<i64> = (1..=20).map(|n| 100 + 45 * n).chain([1000, 1000]).collect();
    assert_eq!(leads(0, 22), rising, "0 is 20");
    assert_eq!(leads(20, 22), rising);
    assert_eq!(leads(2, 3), [550, 1000, 1000]);
    assert_eq!(leads(1, 2), [1000, 1000], "without a mean");
}

/// 33 1/3 inc per call, then 25, a mean of 3 calls and a dead time of 4: 166 2/3 and 200; then 91 2/3 + 122 2/9, 116 2/3 + 111 1/9, 141 2/3 + 100.
///
/// Proves: AMK-CAM-05, AMK-CAM-11
#[test]
fn time_mode_keeps_fractions_in_the_mean() {
    let timed = |cycle_time| table(&[(0, cycle_time), (16, 4)], &[(0, 1)]);
    let mut bench = Bench { call_ns: 500_000, ..Bench::new(timed(3)) };
    bench.start(&set(&[(BA, 2), (MODULO, 100), (DEAD_TIME_MEAN, 3), (CAMS, 1)]), 0);
    let mut places = Vec::new();
    for cycle_time in [3, 3, 4, 4, 4] {
        bench.table = timed(cycle_time);
        bench.step(0);
        places.push(bench.cam.course.as_ref().expect("a started cam").lanes[0].x);
    }
    assert_eq!(places, [66, 0, 13, 27, 41]);
    assert!(bench.cam.is_valid_state());
}

/// Proves: AMK-CAM-13, AMK-CAM-14, AMK-CAM-34, AMK-CAM-42
#[test]
fn pulses_logic_and_disabled_tracks_are_as_their_mode_says() {
    // 5 half milliseconds: 3 calls.
    let mut bench = Bench::new(table(&[(24, 5)], &[(100, 110), (0, 20_000), (0, 20_000), (0, 20_000)]));
    let modes = [(MODE, 16), (MODE + 1, 4), (MODE + 2, 32), (MODE + 4, 1), (MODE + 5, 1)];
    let counts = [(BA, 1), (CAMS, 1), (CAMS + 1, 1), (CAMS + 2, 1), (CAMS + 4, 1)];
    let outcome = bench.call(Some(&with(&counts, &modes)), 0);
    // Tracks 3 and 5 have no cams; 2 is disabled; 4 is always on, inverted.
    assert_eq!((outcome.writes, outcome.outputs), (0b1_0011, 0));
    bench.inputs = 0b10;
    assert_eq!([105, 120, 120, 120].map(|x| bench.step(x)), [0b11, 0b11, 0b11, 0b10]);
}

/// Each stage uses the result of the previous one: any other order would change the outputs of a call.
/// Proves: AMK-CAM-02
#[test]
fn a_track_goes_from_the_place_to_the_output_in_the_order_of_its_stages() {
    // Offset 500 and 10 ms ahead, 1000 inc at 100 inc per ms; a pulse of 3 calls; the second track has neither offset
    // nor lead.
    let mut bench = Bench::new(table(&[(8, 500), (16, 20), (24, 5)], &[(1_800, 2_800), (300, 400)]));
    let logic = 16 + 4 + 2 + 1;
    let sets = [(DEAD_TIME_MEAN, 1), (CAMS + 1, 1), (HYSTERESIS, 15), (MODE, logic)];
    assert_eq!(bench.start(&with(&ONE, &sets), 0), 0b01);
    let calls = [
        (100, 0, 0b01),
        (200, 0, 0b01),
        // 300 + 500 + 1000: the cam begins, and its pulse; the input, inverted, suppresses it in this call only.
        (300, 1, 0b11),
        (400, 0, 0b00),
        (500, 0, 0b00),
        (600, 0, 0b01),
        // The master rests: 1100 is within the hysteresis, so that 2200 is no new edge.
        (600, 0, 0b01),
        (700, 0, 0b01),
        // The direction changes: 600 + 500 - 1000 is below 300, and the motion in positive direction starts a pulse
        // again.
        (600, 0, 0b01),
        (700, 0, 0b00),
        (800, 0, 0b00),
        (900, 0, 0b00),
        (1_000, 0, 0b01),
    ];
    for (x, input, outputs) in calls {
        bench.inputs = input;
        assert_eq!(bench.step(x), outputs, "{x}");
    }
    // A disabled track is not written, whatever its stages give.
    bench.start(&with(&[ONE[0], ONE[1], (CAMS + 1, 1)], &[(MODE, 32 + logic)]), 0);
    let outcome = bench.call(None, 100);
    assert_eq!((outcome.writes, outcome.outputs), (0b10, 0));
}

/// The transitions of the state machine in increments of the table, through the function.
/// Proves: AMK-CAM-15, AMK-CAM-36
#[test]
fn hysteresis_is_given_in_hundreds() {
    let mut bench = Bench::new(table(&[], &[(10_000, 11_000), (15_000, 16_000)]));
    bench.start(&set(&[(BA, 1), (CAMS, 2), (HYSTERESIS, 3)]), 0);
    assert_eq!(bench.steps(&[9_000, 10_000, 9_700, 9_699, 9_999, 10_000]), "011001");
    assert_eq!(bench.steps(&[11_000, 10_700, 10_699, 11_000, 11_300, 10_999]), "001001");
    // The second cam has a state of its own.
    assert_eq!(bench.steps(&[10_000, 9_000, 15_500, 16_000, 15_700, 15_699]), "101001");
}

/// Proves: AMK-CAM-01
#[test]
fn edited_cam_restarts_and_others_continue() {
    let mut bench = Bench::new(table(&[], &[(10_000, 11_000), (12_000, 13_000)]));
    bench.start(&set(&[(BA, 1), (CAMS, 1), (CAMS + 1, 1), (HYSTERESIS, 5), (HYSTERESIS + 1, 5)]), 0);
    // Both are off, within their hysteresis or beyond: the first is passed, the second was reached from below.
    assert_eq!([10_500, 12_100, 11_900].map(|x| bench.step(x)), [1, 2, 2]);
    // The first one now ends at 12000: it is on at once, reached from below. The second one stays on.
    bench.table = table(&[], &[(10_000, 12_000), (12_000, 13_000)]);
    assert_eq!([11_900, 12_000, 11_500, 11_499].map(|x| bench.step(x)), [3, 2, 2, 1]);
    // A word outside the cams restarts nothing: the cam stays on down to 9500.
    bench.table = table(&[(1, 4)], &[(10_000, 12_000), (12_000, 13_000)]);
    assert_eq!([9_500, 9_499].map(|x| bench.step(x)), [1, 0]);
    // An edit without hysteresis takes effect at once.
    bench.start(&set(&ONE), 0);
    bench.table = table(&[], &[(0, 1)]);
    assert_eq!(bench.step(0), 1);
}

/// Proves: AMK-CAM-16, AMK-CAM-31, AMK-CAM-33, AMK-CAM-35, AMK-CAM-38, AMK-CAM-39, AMK-CAM-41, AMK-CAM-42
#[test]
fn what_is_no_set_is_refused_with_its_field_or_word() {
    let refused = |table: Arc<Table>, fields: &[(usize, i64)]| Bench::new(table).check(&set(fields)).err();
    let of = |code, name, asked, limit| Some(Fault::new(code).of(number(FIELDS, name)).with(asked, limit));
    let word = |code, asked, limit| Some(Fault::new(code).with(asked, limit));
    let one = |head: &[(usize, i64)]| table(head, &[(10_000, 11_000)]);

    assert_eq!(
        refused(one(&[]), &[(BA, 1), (SF_CYCLE, 3)]),
        Some(Fault {
            asked: Number::Count(3),
            limit: Number::Time(1_000_000),
            ..Fault::new(Code::AMK_CYCLE_MISMATCH).of(number(FIELDS, "sf_cycle"))
        })
    );
    assert_eq!(refused(one(&[]), &[(MODE + 3, 12)]), of(Code::AMK_TRACK_LOGIC, "mode", 12, 12));
    assert_eq!(refused(one(&[]), &[(BA, 2), (MODULO, 0)]), of(Code::AMK_NO_MODULO, "modulo", 0, 1));
    assert_eq!(refused(one(&[]), &[(CAMS, 1000), (CAMS + 7, 25)]), of(Code::AMK_CAM_COUNT, "cams", 1025, 1024));
    assert_eq!(refused(one(&[]), &[(CAMS, 1), (CAMS + 1, 1)]), word(Code::AMK_TABLE_SHORT, 36, 40));
    let most = table(&[], &[(1, 2); 1024]);
    assert_eq!(refused(most, &[(CAMS, 1000), (CAMS + 7, 24)]), None);

    assert_eq!(refused(one(&[(1, 8)]), &ONE), word(Code::AMK_TRACK_SELECT, 8, 7));
    assert_eq!(refused(one(&[(0, 1)]), &[(BA, 2), (CAMS, 1)]), word(Code::AMK_TIME_SHORT, 0, 1_000_000));
    assert_eq!(refused(one(&[(0, -1)]), &[(BA, 2), (CAMS, 1)]), word(Code::AMK_TIME_LONG, 0, 32_767));
    assert_eq!(refused(one(&[(0, 1)]), &ONE), None, "only the time mode reads it");
    assert_eq!(refused(one(&[(16, 1)]), &ONE), word(Code::AMK_TIME_SHORT, 16, 1_000_000));
    assert_eq!(refused(one(&[(17, 1), (24, 1)]), &ONE), None, "track 1 has no cams, track 0 no pulse");
    assert_eq!(refused(one(&[(24, 1)]), &[(BA, 1), (CAMS, 1), (MODE, 16)]), word(Code::AMK_TIME_SHORT, 24, 1_000_000));
    assert_eq!(refused(one(&[(24, 32_768)]), &[(BA, 1), (CAMS, 1), (MODE, 16)]), word(Code::AMK_TIME_LONG, 24, 32_767));

    let hysteresis = |on, off, count| refused(table(&[], &[(on, off)]), &[(BA, 1), (CAMS, 1), (HYSTERESIS, count)]);
    assert_eq!(hysteresis(10_000, 11_001, 189), None);
    assert_eq!(hysteresis(10_000, 11_001, 190), word(Code::AMK_HYSTERESIS, 19_000, 18_999));
    assert_eq!(hysteresis(10_000, 9_000, 9), None);
    assert_eq!(hysteresis(10_000, 9_000, 10), word(Code::AMK_HYSTERESIS, 1000, 1000));
    assert_eq!(hysteresis(5, 5, 65_535), None, "a parked cam");
    let absolute = |on, off| refused(table(&[], &[(on, off)]), &[(CAMS, 1), (HYSTERESIS, 65_535)]);
    assert_eq!((absolute(0, 10), absolute(6_553_500, 0)), (None, word(Code::AMK_HYSTERESIS, 6_553_500, 6_553_500)));

    let none = setting(1, [None; LINES]);
    assert_eq!(check_table(Words(&set(&ONE)), &none).unwrap_err().code, Code::AMK_TABLE_MISSING);
    let xy = Arc::new(Table::new(Form::Xy, &[0], &[0]).unwrap());
    assert_eq!(refused(xy, &ONE).unwrap().code, Code::AMK_TABLE_FORM);
}

/// Proves: AMK-CAM-32
#[test]
fn a_mean_needs_room() {
    let cam = Cam::new(&with_memory(19, MOST_CAMS));
    let check = |mean| cam.check_mean(Words(&set(&[(DEAD_TIME_MEAN, mean)])));
    let fault = |asked| Err(Fault::new(Code::AMK_MEAN_LONG).of(number(FIELDS, "dead_time_mean")).with(asked, 19));
    assert_eq!([check(0), check(1), check(19), check(30_000)], [fault(20), Ok(()), Ok(()), fault(30_000)]);
}

#[test]
fn a_state_from_outside_may_hold_anything() {
    let mut bench = Bench::new(example(&[(16, 32_767), (17, 9)]));
    let words = with(&EXAMPLE, &[(HYSTERESIS, 50), (HYSTERESIS + 1, 50)]);
    assert!(bench.cam.is_valid_state());
    bench.start(&words, 0);
    assert!(bench.cam.is_valid_state());
    for value in [i64::MIN, i64::MAX, 0, 1] {
        bench.step(value);
    }
    assert!(bench.cam.is_valid_state());
    for overrun in [i64::MAX, i64::MIN] {
        bench.cam.overruns[0] = HysteresisState::at(overrun);
        assert!(!bench.cam.is_valid_state());
        bench.step(-10_000);
    }
    let course = bench.cam.course.as_mut().unwrap();
    (course.lanes[0].count, course.lanes[1].x, course.lanes[2].offset) = (u16::MAX, i64::MIN, i64::MAX);
    assert!(!bench.cam.is_valid_state());
    bench.step(i64::MAX);
}

#[test]
fn a_copy_takes_the_place_of_another_one() {
    let mut bench = Bench::new(example(&[]));
    bench.start(&with(&EXAMPLE, &[(HYSTERESIS, 3)]), 0);
    bench.step(10_000);
    let mut copy = Cam::new(&with_memory(100, MOST_CAMS));
    copy.clone_from(&bench.cam);
    let outputs = bench.steps(&[9_700, 9_699]);
    bench.cam = copy;
    assert_eq!((outputs.as_str(), bench.steps(&[9_700, 9_699]).as_str()), ("10", "10"));
}

/// Returns true if a cam is on, by stepping through its increments from its start.
fn is_on(cam: (i32, i32), x: i64, modulo: i64) -> bool {
    let mut place = i64::from(cam.0);
    while place != i64::from(cam.1) {
        if place == x {
            return true;
        }
        place = (place + 1) % modulo;
    }
    false
}

proptest! {
    /// Tracks without hysteresis are on where stepping from the start of a cam to its end meets x.
    #[test]
    fn plain_tracks_equal_stepping_along_their_cams(
        cams in proptest::collection::vec((0_i32..300, 0_i32..300), 1..20),
        split in 0_usize..20,
        offset in -500_i64..500,
        ways in proptest::collection::vec(-700_i64..700, 1..30),
    ) {
        let split = split.min(cams.len());
        let mut bench = Bench::new(table(&[(8, offset)], &cams));
        let counts = [(CAMS, split as i64), (CAMS + 1, (cams.len() - split) as i64)];
        bench.start(&with(&counts, &[(BA, 1), (MODULO, 300)]), 0);
        let mut place = 0;
        for way in ways {
            place += way;
            let any = |cams: &[(i32, i32)], x: i64| cams.iter().any(|cam| is_on(*cam, x.rem_euclid(300), 300));
            let expected = u8::from(any(&cams[..split], place + offset)) | u8::from(any(&cams[split..], place)) << 1;
            prop_assert_eq!(bench.step(place), expected);
            prop_assert!(bench.cam.is_valid_state());
        }
    }
}
