//! Supervision of the position differences of up to eight drives (SIDIFF).
//!
//! Law      corr = error - trunc(sak_share * ratio_mul / ratio_div); mean = trunc of the sliding mean of corr over
//!          `mean_n` values; the bit of a drive becomes 1 after `agreements` calls in a row with |mean| > threshold, 0
//!          after as many without
//! Reads    error and SAK compensation of the drives that are monitored or displayed; table 0 in the first call after
//!          START and after VALUE_NEW: a table that is loaded between them has no effect until then
//! Writes   An, the bit of each monitored drive; the sink: mean of the displayed drive (inc), or its previous value
//! Refuses  a table 0 of another form than words or too short for the drives, thresholds and dividers outside their
//!          range
//! Source   AMK-SIDIFF-01 to -17 with

use crate::code::Code;
use crate::function::guest::*;
use crate::function::window::Window;
use crate::table::{Form, Table};
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new("mode", 0, 3, "", "bit 0: of each error only its low 16 bits; bit 1 changes nothing", "AMK-SIDIFF-01"),
    Field::new("aw_mask", 0, 255, "", "bit n-1: drive n is monitored", "AMK-SIDIFF-02")
        .live()
        .within(CellBound::AxisMask),
    Field::new("display_aw", 0, 8, "", "the drive whose difference goes to the sink; 0 none", "AMK-SIDIFF-03")
        .live()
        .within(CellBound::AxisNumber),
    Field::new("mean_n", 0, LARGEST as i64, "", "so many values are averaged; 0 as 10", "AMK-SIDIFF-04").live().or(10),
    Field::new("agreements", 0, 255, "", "so many calls in a row change a bit; 0 as 5", "AMK-SIDIFF-05").live().or(5),
];

const MODE: usize = place(FIELDS, "mode");
const AW_MASK: usize = place(FIELDS, "aw_mask");
const DISPLAY_AW: usize = place(FIELDS, "display_aw");
const MEAN_N: usize = place(FIELDS, "mean_n");
const AGREEMENTS: usize = place(FIELDS, "agreements");

/// Maximum number of values of a mean.
const LARGEST: usize = 255;

/// Words per drive in table 0.
const WORDS: usize = 6;

/// Minimum divider of a ratio, apart from 0.
const LEAST_DIVIDER: i32 = 65_536;

/// Maximum threshold (inc).
const LARGEST_THRESHOLD: i32 = 32_767;

/// Threshold and ratio of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Limit {
    threshold: i32,
    divider: i32,
    multiplier: i32,
}

impl Limit {
    /// Limits without a table.
    const DEFAULT: Self = Self { threshold: 100, divider: 1, multiplier: 1 };

    /// Reads the limits of the drive with this number, from 0.
    fn read(table: Option<&Table>, drive: usize) -> Self {
        let Some(table) = table else { return Self::DEFAULT };
        let (threshold, divider, multiplier) = Self::raw_words(table, drive);
        Self {
            // The table may have been replaced after the check, so it may hold any values.
            threshold: threshold.clamp(0, LARGEST_THRESHOLD),
            divider: divider.max(1),
            multiplier: if multiplier == 0 { 1 } else { multiplier },
        }
    }

    /// Returns the raw words; the word after the threshold is 0, so that both are one number.
    fn raw_words(table: &Table, drive: usize) -> (i32, i32, i32) {
        let base = WORDS.saturating_mul(drive);
        let double = |offset| table.double(base.saturating_add(offset));
        (double(0), double(2), double(4))
    }

    /// Converts increments of the function to increments of the drive.
    #[inline]
    fn convert(self, share: i64) -> i64 {
        let (multiplier, divider) = (i64::from(self.multiplier), i64::from(self.divider));
        if share == 0 || multiplier == divider {
            return share;
        }
        if let Some(product) = share.checked_mul(multiplier) {
            return product.checked_div(divider).unwrap_or(0);
        }
        // A product of 64 and 32 bits fits 128; a result beyond 64 bits is no valid compensation.
        let exact = (i128::from(share) * i128::from(multiplier)).checked_div(divider.into());
        exact.and_then(|share| i64::try_from(share).ok()).unwrap_or(0)
    }
}

/// State of a monitored drive.
#[derive(Debug, Serialize, Deserialize)]
struct DriveMonitor {
    limit: Limit,
    values: Window,
    /// Output bit of the drive.
    is_above: bool,
    /// Number of consecutive calls that disagree with the bit.
    disagreements: u8,
}

impl DriveMonitor {
    fn new() -> Self {
        Self { limit: Limit::DEFAULT, values: Window::new(LARGEST), is_above: false, disagreements: 0 }
    }

    /// Adds a difference and returns the mean.
    #[inline]
    fn push(&mut self, drive: Drive, is_short: bool) -> i64 {
        // The cast keeps the low word, as the mode requires (AMK-SIDIFF-01). 64 bits are not cut to 32: a value that is
        // too large would look small.
        let error = if is_short { (drive.error as i16).into() } else { drive.error };
        self.values.push(error.saturating_sub(self.limit.convert(drive.sak_share)));
        let (sum, count) = self.values.mean();
        match (i64::try_from(sum), i64::try_from(count)) {
            (Ok(sum), Ok(count)) => sum.checked_div(count).unwrap_or(0),
            // A mean is between the values.
            _ => sum.checked_div(count).and_then(|mean| i64::try_from(mean).ok()).unwrap_or(0),
        }
    }

    /// Evaluates a mean and returns the bit.
    #[inline]
    fn evaluate(&mut self, mean: i64, agreements: u8) -> bool {
        let is_above = mean.unsigned_abs() > self.limit.threshold.unsigned_abs().into();
        self.disagreements = if is_above == self.is_above { 0 } else { self.disagreements.saturating_add(1) };
        if self.disagreements >= agreements {
            (self.is_above, self.disagreements) = (is_above, 0);
        }
        self.is_above
    }

    fn release(&mut self) {
        (self.is_above, self.disagreements) = (false, 0);
    }
}

impl Clone for DriveMonitor {
    fn clone(&self) -> Self {
        Self { values: self.values.clone(), ..*self }
    }

    /// Does not allocate if both functions belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        self.values.clone_from(&other.values);
        (self.limit, self.is_above, self.disagreements) = (other.limit, other.is_above, other.disagreements);
    }
}

/// Values that VALUE_NEW changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Live {
    aw_mask: u8,
    display_aw: u8,
    mean_n: u8,
    agreements: u8,
}

impl Live {
    fn of(words: Words<'_>) -> Self {
        // Their ranges are those of 8 bits.
        let byte = |place| words.get(place).clamp(0, u8::MAX.into()) as u8;
        let or = |place, default| if byte(place) == 0 { default } else { byte(place) };
        Self {
            aw_mask: byte(AW_MASK),
            display_aw: byte(DISPLAY_AW),
            mean_n: or(MEAN_N, 10),
            agreements: or(AGREEMENTS, 5),
        }
    }

    /// Returns the bit of the displayed drive.
    fn displayed(self) -> u8 {
        let shift = u32::from(self.display_aw).checked_sub(1);
        shift.and_then(|shift| 1_u8.checked_shl(shift)).unwrap_or(0)
    }

    /// Returns the bits of the averaged drives: a drive that is only displayed has no output, and is otherwise handled
    /// like the others.
    fn selected(self) -> u8 {
        self.aw_mask | self.displayed()
    }
}

/// State of the function.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::function) struct Sidiff {
    live: Live,
    is_short: bool,
    watches: [DriveMonitor; LINES],
    /// Whether table 0 has to be read.
    is_new: bool,
    /// Bits of drives that VALUE_NEW removed from the monitored ones.
    left: u8,
}

impl Sidiff {
    fn read_limits(&mut self, table: Option<&Table>) {
        for (drive, watch) in self.watches.iter_mut().enumerate() {
            watch.limit = Limit::read(table, drive);
        }
    }
}

impl Clone for Sidiff {
    fn clone(&self) -> Self {
        Self { watches: self.watches.clone(), ..*self }
    }

    /// Does not allocate if both functions belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        self.watches.clone_from(&other.watches);
        (self.live, self.is_short) = (other.live, other.is_short);
        (self.is_new, self.left) = (other.is_new, other.left);
    }
}

impl SlotType for Sidiff {
    const DESCRIPTION: Description = Description {
        outputs: 8,
        tables: 1,
        edits_tables: true,
        monitors: Monitored::Errors,
        amk: AmkLimits { table_words: 48, ..AmkLimits::USUAL },
        ..Description::of(Kind::Sidiff, "sidiff", "reports which drives have a larger difference than allowed", FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self {
            live: Live { aw_mask: 0, display_aw: 0, mean_n: 1, agreements: 1 },
            is_short: false,
            watches: std::array::from_fn(|_| DriveMonitor::new()),
            is_new: false,
            left: 0,
        }
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let Some(table) = setting.tables.first().copied().flatten() else { return Ok(()) };
        if table.form() != Form::Words {
            return Err(Fault::new(Code::AMK_TABLE_FORM));
        }
        let selected = Live::of(words).selected();
        let needed = WORDS * (u8::BITS - selected.leading_zeros()) as usize;
        if table.len() < needed {
            return Err(Fault::new(Code::AMK_TABLE_SHORT).with(table.len() as i64, needed as i64));
        }
        for drive in (0..LINES).filter(|drive| selected >> drive & 1 == 1) {
            let (threshold, divider, _) = Limit::raw_words(table, drive);
            if !(0..=LARGEST_THRESHOLD).contains(&threshold) {
                return Err(Fault::new(Code::AMK_THRESHOLD).with(threshold.into(), LARGEST_THRESHOLD.into()));
            }
            if divider != 0 && divider < LEAST_DIVIDER {
                return Err(Fault::new(Code::AMK_RATIO_DIVIDER).with(divider.into(), LEAST_DIVIDER.into()));
            }
        }
        Ok(())
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        (self.live, self.is_short) = (Live::of(words), words.get(MODE) & 1 != 0);
        (self.is_new, self.left) = (true, 0);
        for watch in &mut self.watches {
            watch.values.restart(self.live.mean_n.into());
            watch.release();
        }
        self.step(seen)
    }

    /// Bits, counts and means continue; a mean restarts if its length changes.
    fn apply_values(&mut self, words: Words<'_>) {
        let (old, new) = (self.live, Live::of(words));
        for (drive, watch) in self.watches.iter_mut().enumerate() {
            let is_new = |old: u8, new: u8| new & !old & (1 << drive) != 0;
            if old.mean_n != new.mean_n || is_new(old.selected(), new.selected()) {
                watch.values.restart(new.mean_n.into());
            }
            if is_new(old.aw_mask, new.aw_mask) {
                watch.release();
            }
        }
        // The output of a drive that is no longer monitored must not stay 1: it is written once more, as 0.
        self.left = (self.left | old.aw_mask) & !new.aw_mask;
        (self.live, self.is_new) = (new, true);
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        if std::mem::take(&mut self.is_new) {
            self.read_limits(seen.tables.get(0));
        }
        let Live { aw_mask, agreements, .. } = self.live;
        let (selected, displayed) = (self.live.selected(), self.live.displayed());
        let writes = aw_mask | std::mem::take(&mut self.left);
        let mut outcome = Outcome { sink: seen.sink, writes, ..Outcome::default() };
        let mut rest = selected;
        while rest != 0 {
            let (place, bit) = (rest.trailing_zeros() as usize, rest & rest.wrapping_neg());
            rest ^= bit;
            let (Some(watch), Some(drive)) = (self.watches.get_mut(place), seen.drives.get(place)) else { break };
            let mean = watch.push(*drive, self.is_short);
            if displayed & bit != 0 {
                outcome.sink = mean;
            }
            if aw_mask & bit != 0 && watch.evaluate(mean, agreements) {
                outcome.outputs |= bit;
            }
        }
        outcome
    }

    fn is_valid_state(&self) -> bool {
        let is_sound = |watch: &DriveMonitor| {
            watch.limit.divider > 0
                && watch.limit.threshold >= 0
                && watch.values.is_sound()
                && watch.values.capacity() == LARGEST
        };
        self.live.mean_n > 0
            && self.live.agreements > 0
            && self.live.display_aw <= 8
            && self.watches.iter().all(is_sound)
    }

    fn monitored_axes(words: Words<'_>) -> u8 {
        Live::of(words).selected()
    }
}

#[cfg(test)]
mod tests;
