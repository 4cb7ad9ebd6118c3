//! Printing mark control: corrects the position of the slave so that a mark reaches its setpoint position.
//!
//! Law      c = ((V - D) mod FL) * Ye / FL; dXM = Y(x_mark) - c, wrapped into (-Ye / 2, Ye / 2], valid within W * Ye /
//!          FL, then truncated to whole increments; C = trunc(dXM * F); corr(x) = trunc(C * clamp((x - SK) / LK, 0,
//!          1)), then C permanently
//! Reads    the mark of a call, in passes of the working table only; the first valid one of a pass counts
//! Writes   the correction that is added to the sink; whether the last pass had a valid mark
//! Source   AMK-PMC-01 to -26, AMK-XFIPW-69 to -85; A-32 to -35, A-23 to -28

use crate::cam::{Curve, Scale};
use serde::{Deserialize, Serialize};

/// Bit of `function` that enables printing mark control.
pub(super) const MARKS: i64 = 1 << 0;
/// Bit of `function`: the compensation includes the correction.
pub(super) const BEFORE_SAK: i64 = 1 << 1;
/// Bit of the weight that inverts the direction.
const INVERTED: i64 = 1 << 7;
/// Weight without any correction.
const SUPPRESSED: i64 = 1 << 5;

/// Settings of printing mark control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Marks {
    /// Format length FL; 0: no control.
    pub format: i64,
    /// Distance of the sensor, D.
    pub distance: i64,
    /// Synchronous shift V.
    pub shift: i64,
    /// Valid range W.
    pub range: i64,
    /// Start and length of the correction, SK and LK.
    pub window: (i64, i64),
    /// Weight k.
    pub weight: i64,
    /// Every n-th valid mark is corrected.
    pub every: i64,
    /// Whether the compensation includes the correction.
    pub before_sak: bool,
}

impl Marks {
    /// Returns the settings of the word `function` and the fields FL, D, V, W, SK, LK, k and n; empty if that bit is 0.
    pub(super) fn of(function: i64, values: [i64; 8]) -> Self {
        if function & MARKS == 0 {
            return Self::default();
        }
        let [format, distance, shift, range, start, wide, weight, every] = values;
        let before_sak = function & BEFORE_SAK != 0;
        Self { format, distance, shift, range, window: (start, wide), weight, every, before_sak }
    }

    #[inline]
    pub(super) fn is_on(&self) -> bool {
        self.format > 0
    }

    /// Returns SK and LK, or their defaults if both are 0 (AMK-PMC-16).
    fn window(&self, length: i64) -> (i64, i64) {
        if self.window == (0, 0) { (length * 3 / 4, length / 8) } else { self.window }
    }

    /// Returns dXM at a position of the working table, in whole increments; `None` if it is not valid.
    fn deviation(&self, curve: &Curve<'_>, x: i64, scale: Scale) -> Option<i64> {
        let point = curve.at(x, &mut 0);
        let wide = i128::from;
        let (mult, format) = (wide(scale.mult), wide(self.format));
        // All in parts of whole * FL * 2^n: factors of 31, 31, 16 and 15 bits.
        let unit = (wide(point.whole) * format) << scale.div_exp;
        let position = (wide(point.y) * wide(point.whole) + wide(point.rise) * wide(point.part)) * mult * format;
        let step = wide(curve.end()) * mult * wide(point.whole);
        let command = wide(self.shift - self.distance).rem_euclid(format) * step;
        let turn = (step * format).abs();
        let mut off = (position - command).checked_rem_euclid(turn)?;
        if 2 * off > turn {
            off -= turn;
        }
        let is_valid = self.range == 0 || off.abs() <= wide(self.range) * step.abs();
        is_valid.then(|| (off / unit) as i64)
    }

    /// Returns C of a deviation: a fraction of it, or its negative.
    fn correction(&self, deviation: i64) -> i64 {
        let share = match self.weight & !INVERTED {
            SUPPRESSED => 0,
            k => deviation / (1_i64 << k.clamp(0, 31)),
        };
        if self.weight & INVERTED == 0 { share } else { -share }
    }
}

/// State of the control of a working table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MarkControl {
    /// dXM of the last mark; 0 if the last pass had none.
    deviation: i64,
    /// Whether this pass has had a valid mark.
    is_marked: bool,
    /// Whether the last pass had a valid mark.
    was_marked: bool,
    /// Number of valid marks.
    count: i64,
    /// C that waits for SK.
    waiting: Option<i64>,
    /// C that is applied in this pass, and its window.
    active_correction: Option<(i64, (i64, i64))>,
    /// Whether SK was passed in this pass.
    is_open: bool,
    /// Sum of C applied before this pass.
    done: i64,
}

impl MarkControl {
    /// Evaluates a mark at x of the present pass; a negative x is in the previous pass, which had that length.
    pub(super) fn mark(&mut self, marks: &Marks, curve: &Curve<'_>, x: i64, scale: Scale) {
        if x >= 0 {
            // A correction that waited before the mark is applied first.
            self.open(marks, x, curve.length());
        }
        let place = if x < 0 { x.saturating_add(curve.length()) } else { x };
        let is_of_last = x < 0;
        if !(0..curve.length()).contains(&place) || self.is_marked && !is_of_last || self.was_marked && is_of_last {
            return;
        }
        let Some(deviation) = marks.deviation(curve, place, scale) else { return };
        self.deviation = deviation;
        if is_of_last {
            self.was_marked = true;
        } else {
            self.is_marked = true;
        }
        self.count = self.count.wrapping_add(1);
        if marks.every < 2 || self.count.checked_rem(marks.every) == Some(0) {
            self.waiting = Some(marks.correction(deviation));
        }
    }

    /// Returns the correction at x.
    pub(super) fn at(&mut self, marks: &Marks, x: i64, length: i64) -> i64 {
        self.open(marks, x, length);
        let Some((all, (start, wide))) = self.active_correction else { return self.done };
        // C has 32 bits, positions have 15.
        let part = if x >= start.saturating_add(wide) {
            all
        } else {
            all.saturating_mul((x - start).max(0)).checked_div(wide).unwrap_or(all)
        };
        self.done.wrapping_add(part)
    }

    /// Starts the waiting correction when the pass reaches SK.
    fn open(&mut self, marks: &Marks, x: i64, length: i64) {
        if !self.is_open && x >= marks.window(length).0 {
            self.is_open = true;
            self.active_correction = self.waiting.take().map(|all| (all, marks.window(length)));
        }
    }

    /// Ends a pass: its correction has been applied completely.
    pub(super) fn pass(&mut self) {
        let all = if self.is_open { self.active_correction.take().map(|(all, _)| all) } else { self.waiting.take() };
        self.done = self.done.wrapping_add(all.unwrap_or(0));
        self.was_marked = std::mem::take(&mut self.is_marked);
        if !self.was_marked {
            self.deviation = 0;
        }
        self.is_open = false;
    }

    /// Leaves the working table at x: the applied correction stays, and a waiting one is dropped.
    pub(super) fn end_working_table(&mut self, marks: &Marks, x: i64, length: i64) {
        if self.active_correction.is_some() {
            self.done = self.at(marks, x, length);
        }
        (self.active_correction, self.waiting, self.is_open, self.is_marked) = (None, None, false, false);
    }

    /// Returns to the previous pass: the correction of this pass waits for the next one, and the mark belongs to the
    /// previous one.
    pub(super) fn return_to_previous_pass(&mut self) {
        let taken = self.active_correction.take().map(|(all, _)| all);
        self.waiting = self.waiting.or(taken);
        (self.is_open, self.is_marked) = (true, self.was_marked);
    }

    /// Returns the sum of the corrections so far, while no pass of the working table runs.
    pub(super) fn applied(&self) -> i64 {
        self.done
    }

    /// Returns dXM, in increments.
    pub(super) fn deviation(&self) -> i64 {
        self.deviation
    }

    /// Returns true if the last pass had a valid mark.
    pub(super) fn was_marked(&self) -> bool {
        self.was_marked
    }
}
