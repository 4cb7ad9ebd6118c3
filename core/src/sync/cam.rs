//! An electronic cam: a table of the machine between a lead and its follower.
//!
//! Law      follower(k) - follower(0) = slave_scale * (periods * way + y(x(k)) - y(x(0))), x = master_scale * (change
//!          of the lead) + x(0) within the length. Between its points y is a straight line, or a spline, rounded to
//!          2^-32 inc at each reading, so that no error accumulates
//! Reads    the table of the present cycle: new numbers act at once, and the follower reaches them within its limits
//! Refuses  nothing: table and scales were checked when it was coupled. The axis handles a lead that moves more than a
//!          length in a cycle
//! Source   contract section 10, PLCopen (MC_CamIn), AMK-FIPW-03 to -06

use super::gear::{Gear, Ratio};
use crate::position::Position;
use crate::table::{CamShape, Table, interval};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Units of a position in one increment.
const ONE: i128 = Position::whole(1).raw();

/// An active cam.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Cam {
    /// Index among the tables.
    table: u16,
    /// Index of the point before `place`, or of one near it.
    near: u32,
    /// Change of the slave per change of its lead at the present position.
    slope: f64,
    master: Gear,
    slave: Gear,
    /// Position of the scaled master in the table; outside the table for a cam that is not cyclic.
    place: Position,
    /// Value of the table at that position.
    value: Position,
    /// Smoothed change of the lead in a cycle (inc).
    mean: f64,
    /// Whether the slave rests at an end.
    rests: bool,
    /// Direction in which the last step has passed an end of a cyclic table: 1 up, -1 down.
    passed: i8,
}

/// Periods of a cam: that of the master has the sign of its scale, that of the slave the sign of its feed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Periods {
    /// Period of the master (inc of the master).
    pub master: Option<i64>,
    /// Period of the slave (inc of the slave).
    pub slave: Option<i64>,
}

/// Cycles over which the speed of a lead is smoothed.
const MEAN_CYCLES: f64 = 64.0;

impl Cam {
    /// Returns a cam with the scaled master at `place`; none if the table is no cam.
    pub fn new(table: u16, (master, slave): (Ratio, Ratio), place: Position, tables: &[Arc<Table>]) -> Option<Self> {
        let (master, slave) = (Gear::new(master), Gear::new(slave));
        let value = Position::ZERO;
        let mut cam =
            Self { table, near: 0, slope: 0.0, master, slave, place, value, mean: 0.0, rests: true, passed: 0 };
        let (table, shape) = cam.find(tables)?;
        cam.go(table, shape);
        cam.passed = 0;
        Some(cam)
    }

    /// Returns the position in a table of a lead at `position`, plus `offset` in scaled units.
    pub fn place_of(position: Position, ratio: Ratio, offset: Position, shape: CamShape) -> Position {
        let (numerator, denominator) = (i128::from(ratio.numerator()), i128::from(ratio.denominator()));
        let scaled = if shape.is_cyclic {
            // Below 2^63 times 2^62: the sum of two such numbers fits.
            let period = Position::whole(shape.length).raw() * denominator;
            multiply_modulo(position.raw().rem_euclid(period), numerator, period).div_euclid(denominator)
        } else {
            let end = Position::whole(Position::LIMIT - 1).raw();
            let product = position.raw().checked_mul(numerator);
            let end = if (position < Position::ZERO) == (numerator < 0) { end } else { -end };
            product.map_or(end, |product| product.div_euclid(denominator))
        };
        Position::from_raw(scaled) + offset
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        self.slope.is_finite()
            && self.mean.is_finite()
            && self.master.is_sound()
            && self.slave.is_sound()
            && self.place.is_legal()
            && self.value.is_legal()
    }

    /// Returns the index of its table among those of the machine.
    pub fn table(&self) -> u16 {
        self.table
    }

    /// Returns the change of the slave per change of its lead at the present position, or before its end.
    #[inline]
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Whether it moves backward through its table while its lead moves forward.
    pub fn is_turned(&self) -> bool {
        self.master.ratio().numerator() < 0
    }

    /// Returns the scaled value of its table at the present position (inc).
    pub fn scaled(&self) -> Position {
        Gear::new(self.slave.ratio()).step(self.value)
    }

    /// Returns the scaled value relative to the start of the table.
    pub fn from_start(&self, tables: &[Arc<Table>]) -> Position {
        let first = self.find(tables).and_then(|(table, _)| table.y().first().copied()).unwrap_or_default();
        Gear::new(self.slave.ratio()).step(self.value - Position::whole(first))
    }

    /// Returns the position of its master in a period (inc of the master, not scaled).
    pub fn master_place(&self) -> f64 {
        self.place.to_f64() / self.master.ratio().to_f64()
    }

    /// Returns the periods of a cyclic cam in increments of master and slave, if they are whole.
    pub fn periods(&self, tables: &[Arc<Table>]) -> Periods {
        self.find(tables).map_or_else(Periods::default, |(_, shape)| self.periods_in(shape))
    }

    /// Returns its periods with a table of that shape.
    pub fn periods_in(&self, shape: CamShape) -> Periods {
        if !shape.is_cyclic {
            return Periods::default();
        }
        let scaled = |way: i64, numerator: i64, denominator: i64| {
            let product = i128::from(way) * i128::from(numerator);
            let is_whole = denominator != 0 && product % i128::from(denominator) == 0;
            is_whole.then(|| i64::try_from(product / i128::from(denominator)).ok()).flatten()
        };
        let (master, slave) = (self.master.ratio(), self.slave.ratio());
        Periods {
            master: scaled(shape.length, master.denominator(), master.numerator()),
            slave: scaled(shape.travel, slave.numerator(), slave.denominator()),
        }
    }

    /// Returns the cam with its master moved back by that distance (inc of the master, in its direction through the
    /// table).
    #[must_use]
    pub fn moved_back(self, way: Position, tables: &[Arc<Table>]) -> Self {
        let ratio = self.master.ratio();
        let scaled = Gear::new(ratio).step(way);
        let scaled = if ratio.numerator() < 0 { -scaled } else { scaled };
        let place = self.place - scaled;
        Self::new(self.table, (ratio, self.slave.ratio()), place, tables)
            .map_or(self, |cam| Self { rests: self.rests, ..cam })
    }

    /// Whether it has passed the end of a table that is not cyclic.
    pub fn has_ended(&self, tables: &[Arc<Table>]) -> bool {
        self.find(tables).is_none_or(|(_, shape)| !shape.is_cyclic && self.place >= Position::whole(shape.length))
    }

    /// Returns the cam with a slave that continues at an end.
    #[must_use]
    pub fn continuing_at_end(self) -> Self {
        Self { rests: false, ..self }
    }

    /// Returns the cam with a slave that rests at an end.
    #[must_use]
    pub fn resting(self) -> Self {
        Self { rests: true, ..self }
    }

    /// Whether its last step has passed an end of its table. A cyclic table has one on either side.
    pub fn passes_end(&self, tables: &[Arc<Table>]) -> bool {
        self.passed != 0 || self.has_ended(tables)
    }

    /// Returns the cam with the remainders of `old` if the scales are equal, and with the mean of its lead.
    #[must_use]
    pub fn continued_from(self, old: &Self) -> Self {
        let kept = |mine: Gear, its: Gear| if mine.ratio() == its.ratio() { its } else { its.with_ratio(mine.ratio()) };
        Self { master: kept(self.master, old.master), slave: kept(self.slave, old.slave), mean: old.mean, ..self }
    }

    /// Returns the cam with another mean change of its lead in a cycle (inc).
    #[must_use]
    pub fn with_mean(self, mean: f64) -> Self {
        Self { mean, ..self }
    }

    /// Returns `next`, which is at its start, as replacement of this cam, whose last step has passed an end, and the
    /// change of the slave. `next` is moved as far into its table as this cam has passed the end. Remainders of the
    /// scales are kept.
    pub fn handed_over(&self, next: Self, tables: &[Arc<Table>]) -> Option<(Position, Self)> {
        let ((table, shape), (next_table, next_shape)) = (self.find(tables)?, next.find(tables)?);
        let is_back = self.passed < 0;
        let (end, value) = match (shape.is_cyclic, is_back) {
            (true, false) => (0, table.y().first()),
            (_, true) => (shape.length, table.y().last()),
            (false, false) => (shape.length, table.y().last()),
        };
        let over = self.place - Position::whole(end);
        let mut slave = self.slave;
        let back = slave.step(Position::whole(*value?) - self.value);
        let mut next = next.continued_from(&Self { slave, ..*self });
        let scaled = match self.master.ratio() {
            mine if mine == next.master.ratio() => over,
            mine => next.master.step(Gear::new(mine.inverse()?).step(over)),
        };
        // Backward it begins at its end; a scale of the opposite sign reverses it.
        let is_turned = (self.master.ratio().numerator() < 0) != (next.master.ratio().numerator() < 0);
        if is_back != is_turned {
            let end = Position::whole(next_shape.length);
            next.place = if next_shape.is_cyclic { next.place + end } else { end };
            next.go(next_table, next_shape);
        }
        let way = next.advance(scaled, next_table, next_shape);
        next.passed = 0;
        Some((back + way, next))
    }

    /// Returns the smoothed change of its lead in a cycle (inc).
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Removes from the mean the part of the last change that is no motion of its lead.
    pub(super) fn forget(&mut self, added: f64) {
        self.mean -= added / MEAN_CYCLES;
    }

    /// Returns the distance of the slave to an end at which it will rest, if the lead reaches the end within that
    /// number of cycles.
    pub fn distance_to_end(&self, change: Position, cycles: f64, tables: &[Arc<Table>]) -> Option<Position> {
        let (table, shape) = self.find(tables)?;
        let left = (Position::whole(shape.length) - self.place).to_f64();
        let ahead = change.to_f64() * self.master.ratio().to_f64() * cycles;
        let last = table.y().last().copied().filter(|_| !shape.is_cyclic && self.rests && left <= ahead)?;
        Some(Gear::new(self.slave.ratio()).step(Position::whole(last) - self.value))
    }

    /// Returns the largest allowed change of the lead in a cycle (inc).
    pub fn largest_change(&self, tables: &[Arc<Table>]) -> f64 {
        let length = self.find(tables).map_or(0, |(_, shape)| shape.length);
        length as f64 / self.master.ratio().to_f64().abs()
    }

    /// Whether the change of the lead is allowed. A change of more than a length is undefined in a table.
    #[inline]
    pub fn allows_change(&self, change: Position, tables: &[Arc<Table>]) -> bool {
        let length = self.find(tables).map_or(0, |(_, shape)| shape.length);
        let scaled = (change.to_f64() * self.master.ratio().to_f64()).abs();
        scaled <= length as f64
    }

    /// Returns the change of the slave.
    #[inline]
    pub fn step(&mut self, change: Position, tables: &[Arc<Table>]) -> Position {
        let Some((table, shape)) = self.find(tables) else { return Position::ZERO };
        self.mean += (change.to_f64() - self.mean) / MEAN_CYCLES;
        let scaled = self.master.step(change);
        self.advance(scaled, table, shape)
    }

    /// Returns the change of the slave for a change of the scaled master.
    #[inline]
    fn advance(&mut self, scaled: Position, table: &Table, shape: CamShape) -> Position {
        let before = self.value;
        self.place += scaled;
        let way = self.go(table, shape);
        self.slave.step(way + self.value - before)
    }

    /// Returns the change of the slave and the cam after it if no check is needed; an end needs a look ahead.
    #[inline]
    pub fn stepped(mut self, change: Position, tables: &[Arc<Table>]) -> Option<(Position, Self)> {
        i64::try_from(change.raw()).ok()?;
        let (_, shape) = self.find(tables)?;
        let step = (shape.is_cyclic && self.allows_change(change, tables)).then(|| self.step(change, tables))?;
        Some((step, self))
    }

    fn find<'a>(&self, tables: &'a [Arc<Table>]) -> Option<(&'a Table, CamShape)> {
        let table = tables.get(usize::from(self.table))?;
        table.cam().ok().map(|shape| (&**table, shape))
    }

    /// Moves into the present period and looks up the value. Returns the travel of the periods passed.
    #[inline]
    fn go(&mut self, table: &Table, shape: CamShape) -> Position {
        let length = Position::whole(shape.length);
        let is_inside = self.place >= Position::ZERO && self.place < length;
        let mut way = Position::ZERO;
        self.passed = 0;
        if !is_inside && shape.is_cyclic {
            // The position of the master is below 2^94, the length at least 2^32: with a feed of 31 bits the product
            // fits.
            let periods = self.place.raw().div_euclid(length.raw());
            self.place = Position::from_raw(self.place.raw() - periods * length.raw());
            way = Position::from_raw(periods.saturating_mul(Position::whole(shape.travel).raw()));
            self.passed = periods.signum() as i8;
        }
        self.look_up(table, shape, self.place.max(Position::ZERO).min(length).raw());
        way
    }

    /// Looks up the value at `x`, 0 <= x <= length, in units of 2^-32.
    #[inline]
    fn look_up(&mut self, table: &Table, shape: CamShape, x: i128) {
        let (places, values) = (table.x(), table.y());
        let last = values.len().saturating_sub(2);
        let near = (self.near as usize).min(last);
        // Index of the interval, position in it in units of `whole`, and length of an interval (inc).
        let (i, part, whole, wide) = if places.is_empty() {
            // Below 2^63 times 2^20.
            let count = last as i128 + 1;
            let (scaled, length) = (x * count, i128::from(shape.length) * ONE);
            let part = scaled - near as i128 * length;
            // The master usually stays in its interval: a division takes as long as everything else.
            let (i, part) = if (0..length).contains(&part) {
                (near, part)
            } else {
                let i = (scaled / length.max(1)).clamp(0, last as i128);
                (i as usize, scaled - i * length)
            };
            (i, part, shape.length, shape.length as f64 / count as f64)
        } else {
            let place = |i: usize| places.get(i).map_or(0, |place| i128::from(*place) * ONE);
            let i = interval(near, last, |i| x >= place(i));
            let wide = places.get(i + 1).zip(places.get(i)).map_or(1, |(after, at)| after - at).max(1);
            (i, x - place(i), wide, wide as f64)
        };
        let value = |i: usize| values.get(i).copied().unwrap_or(0);
        let y = value(i);
        self.near = i as u32;
        let ratio = self.master.ratio().to_f64() * self.slave.ratio().to_f64();
        let (rise, slope) = match table.spline() {
            None => {
                let rise = value(i + 1) - y;
                (share(rise, part, whole), rise as f64 / wide)
            }
            Some(spline) => {
                let u = to_f64(part) / (whole as f64 * ONE as f64);
                // At the end of a cam the value is exactly its last point.
                let rise =
                    if u < 1.0 { Position::from_f64(spline.rise(i, u)) } else { Position::whole(value(i + 1) - y) };
                (rise.raw(), spline.slope(i, u) / wide)
            }
        };
        self.value = Position::from_raw(i128::from(y) * ONE + rise);
        self.slope = slope * ratio;
    }
}

/// Returns `a * b` modulo `m`, 0 <= a < m < 2^126, by doubling: the product itself may have 190 bits.
fn multiply_modulo(a: i128, b: i128, m: i128) -> i128 {
    let reduced = |sum: i128| if sum >= m { sum - m } else { sum };
    let mut sum = 0;
    for bit in (0..64).rev() {
        sum = reduced(sum + sum);
        if b.unsigned_abs() >> bit & 1 == 1 {
            sum = reduced(sum + a);
        }
    }
    if b < 0 { reduced(m - sum) } else { sum }
}

/// Returns the nearest f64. With 64 bits, if they suffice, this takes a tenth of the time.
#[inline]
fn to_f64(part: i128) -> f64 {
    i64::try_from(part).map_or(part as f64, |part| part as f64)
}

/// Returns `rise * part / whole`, rounded down: `rise` has 32 bits, `part` fewer than 64, `whole` is above 0.
#[inline]
fn share(rise: i64, part: i128, whole: i64) -> i128 {
    // With 64 bits, if they suffice, a division takes a tenth of the time.
    match i64::try_from(part).ok().and_then(|part| rise.checked_mul(part)) {
        Some(product) => product.div_euclid(whole.max(1)).into(),
        None => (i128::from(rise) * part).div_euclid(whole.max(1).into()),
    }
}

#[cfg(test)]
mod tests;
