//! Print mark control with 10,000 marks of a web with stretch, lost marks and false marks; figures and drawing of
//! docs/cams.md.

#[path = "register/page.rs"]
mod page;
#[path = "register/press.rs"]
mod press;
#[allow(dead_code, reason = "the drawings of homing need more of it")]
#[path = "../../tests/drawing/svg.rs"]
mod svg;
#[path = "register/web.rs"]
mod web;

use press::{Control, Pass, Run, Taken, run};
use web::{MARKS, Mark, Web, drift};

const OFF: Control = Control { weight: 32, range: 200 };
/// Half of a deviation, within 20 mm.
const WIDE: Control = Control { weight: 1, range: 200 };
/// Half of a deviation, within 5 mm.
const NARROW: Control = Control { weight: 1, range: 50 };

const SEED: u64 = 20_261_122;

fn disturbed(control: Control) -> Run {
    run(&Web::stretched(drift).disturbed(SEED), control)
}

/// With e = 60 inc per format (0.1 %), and half of each deviation corrected, 2 e remain at the sensor, and e at the
/// knife. The drum counts in steps of 3 inc of the slave: a mark with error d is seen at d - (10000 + d) mod 3, and
/// d' = d - trunc(seen / 2) + 60, from 0 on. 120 and 121 are never seen, so it ends with 121 and 122 in turn.
///
/// Proves: AMK-PMC-06, AMK-PMC-22, AMK-PMC-23
#[test]
fn error_after_constant_drift_equals_closed_form() {
    let passes = run(&Web::stretched(|_| 60), WIDE).passes;
    let first = passes[..10].iter().map(|pass| (pass.off, pass.deviation, pass.correction)).collect::<Vec<_>>();
    let by_hand = [
        (0, -1, 0),
        (60, 59, 29),
        (91, 89, 44),
        (107, 107, 53),
        (114, 113, 56),
        (118, 116, 58),
        (120, 119, 59),
        (121, 119, 59),
        (122, 122, 61),
        (121, 119, 59),
    ];
    assert_eq!(first, by_hand);
    for pair in passes[8..].chunks_exact(2) {
        let [even, odd] = [0, 1].map(|i| (pair[i].off, pair[i].error));
        assert_eq!((even, odd), ((122, 61), (121, 62)));
    }
    // e / F, within the resolution of the drum and whole increments.
    for (weight, stays) in [(0, 60), (2, 240), (3, 480)] {
        let passes = run(&Web::stretched(|_| 60), Control { weight, ..WIDE }).passes;
        let off =
            passes[100..].iter().all(|pass| (stays - (1 << weight)..=stays + 3 + (1 << weight)).contains(&pass.off));
        assert!(off, "{weight}: {:?}", passes.last());
    }
}

/// The mean distance between marks is 60 inc too long, so each thousand of them moves the register by 60,000 inc, a
/// whole format. The error of the last one is 9999 * 60 inc, less the difference between 60 and the 31 inc of the
/// 10,000th distance: 599,969 inc, 3 m.
#[test]
fn without_control_the_error_leaves_by_the_drift() {
    let run = disturbed(OFF);
    let errors: Vec<i64> = run.passes.iter().map(|pass| pass.error).collect();
    assert!((0..10).all(|n| errors[1000 * n] == 60_000 * n as i64));
    assert_eq!((errors.len(), errors.last()), (MARKS, Some(&599_969)));
    assert!(errors.is_sorted(), "each distance is too long");
    assert!(run.passes.iter().all(|pass| pass.correction == 0));
}

/// Returns the bounds of the error of the next mark at the sensor, from the law alone: e is 30 to 90 inc. Seen is d - 2
/// to d, so C is d/2 - 3/2 to d/2 + 1/2 (whole increments, towards 0), and d' = d - C + e. Without a mark C is 0, and
/// with a false one -limit to +limit.
fn next(taken: Taken, (low, high): (f64, f64), limit: i64) -> (f64, f64) {
    let limit = limit as f64;
    match taken {
        Taken::Printed => (low / 2.0 - 0.5 + 30.0, high / 2.0 + 1.5 + 90.0),
        Taken::Nothing => (low + 30.0, high + 90.0),
        Taken::False => (low - limit + 30.0, high + limit + 90.0),
    }
}

/// Checks the errors. Undisturbed, `next` ends between 59 and 183 inc; half of it remains at the knife.
fn assert_within_the_law(passes: &[Pass], limit: i64) {
    let mut bounds = (0.0, 0.0);
    for (n, pass) in passes.iter().enumerate() {
        let off = pass.off as f64;
        assert!(bounds.0 <= off && off <= bounds.1, "mark {n}: {off} is not within {bounds:?}");
        assert_eq!(pass.error, pass.off - pass.correction, "mark {n}");
        bounds = next(pass.taken, bounds, limit);
    }
    // Twelve marks halve the rest of a disturbance of 4096 inc to an increment.
    for (n, around) in passes.windows(13).enumerate() {
        if around.iter().all(|pass| pass.taken == Taken::Printed) {
            let Pass { off, error, .. } = around[12];
            assert!((58..=184).contains(&off) && (28..=94).contains(&error), "mark {}: {off}, {error}", n + 12);
        }
    }
    // A false mark acts at once; the next marks correct its effect by halves.
    for (n, pair) in passes.windows(2).enumerate() {
        let moved = pair[1].off - pair[0].off;
        if pair[0].taken == Taken::False {
            assert!((30 - limit..=90 + limit).contains(&moved), "mark {n}: {moved}");
        }
    }
}

/// Proves: AMK-PMC-01, AMK-PMC-13, AMK-PMC-22, AMK-PMC-23
#[test]
fn ten_thousand_marks_are_held_in_register() {
    for (control, limit) in [(WIDE, 2000), (NARROW, 500)] {
        let run = disturbed(control);
        assert_eq!(control.limit(), limit);
        assert_within_the_law(&run.passes, limit);
        let count = run.count;
        // 2 % are lost, 1 % are false: 9,800 and 100 are seen, and each has one of these results.
        assert_eq!(count.printed + count.wrong + count.outside + count.second + count.strayed, 9_900);
        assert_eq!(count.strayed, 0, "the control loses no printed mark");
        assert!(count.wrong > 0 && count.outside > 50 && count.second > 0, "{count:?}");
        assert!((9_780..=9_800).contains(&count.printed), "{count:?}");
    }
}

/// A false mark at the edge of the range W = 1000 inc, 60 inc of drift per format. F = 1/2: 120 inc remain, 500 and 60
/// are added: 680. F = 1: 60 remain, 1000 and 60 are added, and the next mark is beyond the range.
#[test]
fn a_false_mark_at_the_edge_of_the_range_is_survived_by_half_a_correction() {
    for (weight, before, holds) in [(1, 1110, true), (0, 1050, false)] {
        let mut web = Web::stretched(|_| 60);
        web.seen.push(Mark { place: web.printed[100] - before, is_false: true });
        web.seen.sort();
        let run = run(&web, Control { weight, ..NARROW });
        assert_eq!((run.count.wrong, run.passes[100].taken), (1, Taken::False));
        assert!((-1000..=-980).contains(&run.passes[100].deviation), "{:?}", run.passes[100]);
        let next = run.passes[101];
        assert_eq!((next.taken == Taken::Printed, next.off <= 1000, run.count.strayed == 0), (holds, holds, holds));
    }
}

/// `LINESHAFT_RENEW=1 cargo test -p lineshaft-core --test register` regenerates both.
#[test]
fn the_figures_and_the_drawing_in_docs_are_those_of_the_run() {
    let rows = [("without control", OFF), ("marks within 20 mm", WIDE), ("marks within 5 mm", NARROW)];
    page::check(&rows.map(|(name, control)| (name, disturbed(control))));
}
