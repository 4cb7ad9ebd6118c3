//! Printed marks along a web.
//!
//! Law      mark n begins at first + n every + every stretch (sin w + sin 2w + .. + sin nw) + jitter u, with w = 2 pi /
//!          period and -1 <= u < 1, and is `width` long; an extra mark begins halfway to mark n + 1, both without
//!          jitter. u, lost and extra marks are a hash of seed and n: a mark is the same in every pass. An input is
//!          active from the beginning of a mark until its end; a mark without a width gives a rising edge, and no level
//! Refuses  marks that could overlap, see [`Marks::is_sound`]
//! Source   contract section 3, MACS-MARK-05, -07

use crate::drive::Edge;
use crate::position::Position;
use std::f64::consts::PI;

/// Maximum marks per cycle; more than any input can report.
const MOST_PASSED: i128 = 4_096;

/// Periodic stretch of the web.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Maximum stretch, as a fraction of the distance between two marks.
    pub share: f64,
    /// Marks per period, 2 and above.
    pub period: u32,
}

impl Stretch {
    /// Returns the displacement of mark n, in mark distances: the sum of the sines up to n.
    fn sum(self, n: i128) -> f64 {
        let half = PI / f64::from(self.period);
        let place = n.rem_euclid(i128::from(self.period).max(1)) as f64;
        self.share * (libm::cos(half) - libm::cos((2.0 * place + 1.0) * half)) / (2.0 * libm::sin(half))
    }

    /// Returns an upper bound of the displacement.
    fn max_displacement(self) -> f64 {
        self.share / libm::sin(PI / f64::from(self.period))
    }
}

/// Marks along a web.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Marks {
    /// Distance between marks (inc).
    pub every: Position,
    /// Beginning of mark 0 (inc).
    pub first: Position,
    /// Length of a mark (inc).
    pub width: Position,
    /// Maximum deviation of a mark from its place (inc).
    pub jitter: Position,
    /// Stretch of the web between marks.
    pub stretch: Option<Stretch>,
    /// Fraction of the marks that are missing.
    pub missing_share: f64,
    /// Fraction of the marks that are followed by an extra one.
    pub extra: f64,
    /// Seed of all random values.
    pub seed: u64,
}

/// Random property of a mark.
#[derive(Clone, Copy)]
enum RandomProperty {
    Jitter = 1,
    Lost = 2,
    Extra = 3,
}

/// The finalizer of splitmix64.
pub(super) fn mix(bits: u64) -> u64 {
    let bits = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let bits = (bits ^ bits >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ bits >> 31
}

impl Marks {
    /// Returns the minimum distance from a mark to the following object, halfway to the next mark.
    fn min_distance(&self) -> f64 {
        self.every.to_f64() * (1.0 - self.stretch.map_or(0.0, |stretch| stretch.share)) / 2.0
    }

    /// Returns true if no two marks can overlap.
    pub fn is_sound(&self) -> bool {
        let is_share = |share: f64| (0.0..=1.0).contains(&share);
        self.every >= Position::whole(1)
            && self.width >= Position::ZERO
            && self.jitter >= Position::ZERO
            && is_share(self.missing_share)
            && is_share(self.extra)
            && self.stretch.is_none_or(|stretch| is_share(stretch.share) && stretch.period >= 2)
            && self.width.to_f64() + self.jitter.to_f64() < self.min_distance()
    }

    /// Returns a random number of mark n, 0 <= number < 1.
    fn random(&self, n: i128, what: RandomProperty) -> f64 {
        // The lower half of 128 bits distinguishes any two marks of a web.
        let bits = mix(mix(mix(self.seed) ^ n as u64).wrapping_add(what as u64));
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns the beginning of mark n without jitter (2^-32 inc).
    fn place(&self, n: i128) -> i128 {
        let beside = self.stretch.map_or(0.0, |stretch| self.every.to_f64() * stretch.sum(n));
        let straight = self.every.raw().saturating_mul(n).saturating_add(self.first.raw());
        straight.saturating_add(Position::from_f64(beside).raw())
    }

    /// Returns the last mark that begins, without jitter, at or before a position.
    fn last_at(&self, place: i128) -> i128 {
        let near = place.saturating_sub(self.first.raw()).checked_div_euclid(self.every.raw()).unwrap_or(0);
        let beside = self.stretch.map_or(0, |stretch| libm::ceil(stretch.max_displacement()) as i128) + 1;
        let (mut low, mut high) = (near - beside, near + beside + 1);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if self.place(middle) <= place {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Returns beginning and end of mark n and of its extra mark.
    fn at(&self, n: i128) -> [Option<[i128; 2]>; 2] {
        let long = |from: i128| [from, from.saturating_add(self.width.raw())];
        let place = self.place(n);
        let itself = (self.random(n, RandomProperty::Lost) >= self.missing_share).then(|| {
            let jitter = self.jitter.to_f64() * (2.0 * self.random(n, RandomProperty::Jitter) - 1.0);
            long(place.saturating_add(Position::from_f64(jitter).raw()))
        });
        let extra = (self.random(n, RandomProperty::Extra) < self.extra).then(|| {
            let next = self.place(n.saturating_add(1));
            long(place.saturating_add(next.saturating_sub(place) / 2))
        });
        [itself, extra]
    }

    /// Returns true if an input detects a mark at the position.
    pub(super) fn is_detected(&self, place: i64) -> bool {
        let place = Position::whole(place).raw();
        // Everything of the next mark is after its place without jitter, minus the jitter.
        let last = self.last_at(place.saturating_add(self.jitter.raw()));
        self.at(last).iter().flatten().any(|[from, to]| (*from..*to).contains(&place))
    }

    /// Reports the edges between two positions in their order, each with the fraction of the travel that is left; in
    /// positive direction the first position is excluded.
    pub(super) fn pass(&self, from: i64, to: i64, mut tell: impl FnMut(f64, Edge)) {
        let is_forward = to > from;
        let [low, high, end] = [from.min(to), from.max(to), to].map(|place| Position::whole(place).raw());
        let [first, last] = [low, high].map(|place| self.last_at(place.saturating_add(self.jitter.raw())));
        for step in 0..=(last - first).min(MOST_PASSED) {
            let mark = self.at(if is_forward { first + step } else { last - step });
            let has_end = self.width > Position::ZERO;
            let edges = |mark: Option<[i128; 2]>| {
                mark.map_or([None; 2], |[from, to]| [Some((from, true)), has_end.then_some((to, false))])
            };
            let [[a, b], [c, d]] = mark.map(edges);
            let edges = if is_forward { [a, b, c, d] } else { [d, c, b, a] };
            for (place, begins) in edges.into_iter().flatten().filter(|(place, _)| low < *place && *place <= high) {
                let rises = begins == is_forward || !has_end;
                let left = end.saturating_sub(place) as f64 / end.saturating_sub(Position::whole(from).raw()) as f64;
                tell(left, if rises { Edge::Rising } else { Edge::Falling });
            }
        }
    }
}
