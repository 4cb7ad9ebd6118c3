//! Compares motion laws, plans and splines with scipy: `peers/cams.py` calculates them by other methods.

use crate::support::machine::share;
use std::{
    io::Write,
    process::{Command, Stdio},
};

use crate::support::setup;
use lineshaft_core::law::{Derivatives, Ends, Law, Peaks, Plan, Segment, Spline};
use serde_json::{Value, json};

/// Tolerance as a fraction of the stroke.
const WITHIN: f64 = 1e-12;

/// Returns the answers of scipy to questions of one kind.
fn asked(kind: &str, questions: &[Value]) -> Vec<Value> {
    let _machine = share();
    let mut command = Command::new(setup::python());
    command.arg("-B").arg(setup::sources().join("cams.py")).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut script = command.spawn().expect("the interpreter was just found");
    let question = json!({ kind: questions }).to_string();
    script.stdin.take().expect("it is a pipe").write_all(question.as_bytes()).expect("the script reads all of it");
    let output = script.wait_with_output().expect("it was started");
    assert!(output.status.success(), "cams.py ended with {}", output.status);
    let mut answers: Value = serde_json::from_slice(&output.stdout).expect("an answer in JSON");
    let answers: Vec<Value> = serde_json::from_value(answers[kind].take()).expect("a list");
    assert_eq!(answers.len(), questions.len());
    answers
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// Returns a pseudorandom number from 0 to 1, the same each time.
fn chance(seed: usize) -> f64 {
    let mixed = (seed as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    (mixed >> 11) as f64 / (1_u64 << 53) as f64
}

fn chances(seed: usize, count: usize) -> Vec<f64> {
    (0..count).map(|i| chance(seed * 10_007 + i)).collect()
}

/// Compares a value and the derivatives that scipy has: the value relative to the stroke, each derivative relative to
/// the largest of its kind.
fn assert_same(what: &str, ours: &[Derivatives], theirs: &Value, stroke: f64) {
    let ours: Vec<_> = ours.iter().map(|now| [now.s, now.v, now.a, now.j]).collect();
    let theirs: Vec<_> = theirs["at"].as_array().expect("a list").iter().map(numbers).collect();
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let largest = |k: usize| theirs.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
    for k in 0..theirs[0].len() {
        let within = if k == 0 { WITHIN * stroke } else { 1e-10 * largest(k) };
        for (i, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let difference = (ours[k] - theirs[k]).abs();
            assert!(difference <= within, "{what}: derivative {k} at place {i} is {}, in scipy {}", ours[k], theirs[k]);
        }
    }
}

fn assert_same_peaks(what: &str, ours: Peaks, theirs: &Value) {
    let ours = [ours.v.value, ours.a.value, ours.j.value];
    for (k, (ours, theirs)) in ours.iter().zip(numbers(&theirs["peaks"])).enumerate() {
        assert!(
            (ours - theirs).abs() <= 1e-10 * theirs,
            "{what}: peak of derivative {} is {ours}, in scipy {theirs}",
            k + 1
        );
    }
}

#[test]
fn laws_are_those_of_scipy() {
    let laws: Vec<_> = Law::ALL.iter().filter(|(law, _)| *law != Law::Dwell).collect();
    let mut places = chances(1, 200);
    places.extend([0.0, 0.125, 0.375, 0.5, 0.625, 0.875, 1.0]);
    let questions: Vec<_> = laws.iter().map(|(_, name)| json!({"law": name, "at": places})).collect();
    for ((law, name), answer) in laws.iter().zip(asked("laws", &questions)) {
        let ours: Vec<_> = places.iter().map(|z| law.at(*z)).collect();
        assert_same(name, &ours, &answer, 1.0);
        assert_same_peaks(name, law.peaks(), &answer);
    }
}

/// Polynomials of both degrees between straight lines, dwells and each other, forward and back, cyclic and not.
#[test]
fn polynomials_next_to_lines_match_scipy() {
    let plans: Vec<_> = (0..20).map(chances_of_a_plan).collect();
    let questions = plans.iter().map(|(segments, is_cyclic, places)| {
        let segments: Vec<_> = segments.iter().map(|one| json!([one.to, one.travel, one.law.name()])).collect();
        json!({"segments": segments, "is_cyclic": is_cyclic, "at": places})
    });
    let questions: Vec<_> = questions.collect();
    for (i, ((segments, is_cyclic, places), answer)) in plans.iter().zip(asked("plans", &questions)).enumerate() {
        let plan = Plan::new(segments, *is_cyclic).expect("a plan");
        let ours: Vec<_> = places.iter().map(|x| plan.at(*x)).collect();
        let (low, high) = ours.iter().fold((0.0_f64, 0.0_f64), |(low, high), now| (low.min(now.s), high.max(now.s)));
        assert_same(&format!("plan {i}"), &ours, &answer, high - low);
        assert_same_peaks(&format!("plan {i}"), plan.peaks(), &answer);
    }
}

fn chances_of_a_plan(i: usize) -> (Vec<Segment>, bool, Vec<f64>) {
    let is_cyclic = i.is_multiple_of(2);
    let mut to = 0.0;
    let mut segments = Vec::new();
    for (k, pair) in chances(100 + i, 24).chunks(2).enumerate() {
        to += 1.0 + 9.0 * pair[0];
        // Every second or third one is a line.
        let law = match k % (2 + i % 2) {
            0 => Law::Straight,
            _ if chance(i * 77 + k) < 0.5 => Law::Polynomial5,
            _ => Law::Polynomial7,
        };
        segments.push(Segment { to, travel: 200.0 * pair[1] - 100.0, law });
    }
    let places = chances(200 + i, 300).iter().map(|place| place * to).collect();
    (segments, is_cyclic, places)
}

#[test]
fn splines_are_those_of_scipy() {
    let mut ours = Vec::new();
    let mut questions = Vec::new();
    for (i, count) in [7, 8, 13, 40, 300].into_iter().enumerate() {
        let steps = chances(300 + i, count);
        // The shortest distance to the longest is one to ten.
        let x = steps.iter().scan(-3.0, |place, step| {
            *place += 0.2 + 1.8 * step;
            Some(*place)
        });
        let x: Vec<_> = x.collect();
        let y: Vec<_> = chances(400 + i, count).iter().map(|value| 1000.0 * value).collect();
        let stroke = y.iter().copied().fold(0.0, f64::max) - y.iter().copied().fold(1000.0, f64::min);
        let (first, last) = ([70.0, -40.0], [-20.0, 90.0]);
        let at = |u: f64| x.windows(2).map(move |pair| pair[0] + u * (pair[1] - pair[0]));
        let places: Vec<_> = [0.02, 0.3, 0.5, 0.8].into_iter().flat_map(at).collect();
        for (ends, cubic, quintic) in [
            ("natural", Ends::Natural, Ends::Natural),
            ("clamped", Ends::Clamped { first: [first[0]], last: [last[0]] }, Ends::Clamped { first, last }),
            ("periodic", Ends::Periodic, Ends::Periodic),
        ] {
            for (degree, spline) in [(3, Spline::cubic(&x, &y, &cubic)), (5, Spline::quintic(&x, &y, &quintic))] {
                let spline = spline.expect("a spline");
                let at = places.iter().map(|place| {
                    let i = x.partition_point(|x| x <= place) - 1;
                    let length = x[i + 1] - x[i];
                    let now = spline.at(i, (place - x[i]) / length, length);
                    Derivatives { s: y[i] + now.s, ..now }
                });
                ours.push((format!("{ends}, degree {degree}, {count} points"), at.collect::<Vec<_>>(), stroke));
                questions.push(json!({
                    "x": x, "y": y, "degree": degree, "ends": ends, "first": first, "last": last, "at": places,
                }));
            }
        }
    }
    for ((what, ours, stroke), answer) in ours.iter().zip(asked("splines", &questions)) {
        assert_same(what, ours, &answer, *stroke);
    }
}
