//! A printed web: positions of its marks, marks that the sensor sees, and false marks.

/// Number of printed marks.
pub(crate) const MARKS: usize = 10_000;
/// Travel of the slave in a turn of the drum, which is the distance between marks without stretch (inc).
pub(crate) const FORMAT: i64 = 60_000;
/// Nominal position of a mark when the drum is at its zero, without whole formats (inc).
pub(crate) const PLACE: i64 = 10_000;
/// Numbers of lost and of false marks among 10,000.
const LOST: usize = 200;
const FALSE: usize = 100;

/// A mark that the sensor sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Mark {
    /// Position on the web (inc).
    pub place: i64,
    pub is_false: bool,
}

/// A web.
pub(crate) struct Web {
    /// Position of each printed mark (inc).
    pub printed: Vec<i64>,
    /// Marks that the sensor sees, in their order.
    pub seen: Vec<Mark>,
}

/// A random number generator (splitmix64): the same web in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ mixed >> 31) % bound as u64) as usize
    }

    /// Returns `count` different marks.
    fn chosen(&mut self, count: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..MARKS).collect();
        (0..count).for_each(|i| all.swap(i, i + self.below(MARKS - i)));
        all.truncate(count);
        all
    }
}

impl Web {
    /// Returns a web whose marks are all seen, with distances that exceed the format by `stretch` (inc).
    pub(crate) fn stretched(stretch: impl Fn(usize) -> i64) -> Self {
        let printed: Vec<i64> = (0..MARKS)
            .scan(PLACE, |next, n| {
                let place = *next;
                *next += FORMAT + stretch(n);
                Some(place)
            })
            .collect();
        let seen = printed.iter().map(|place| Mark { place: *place, is_false: false }).collect();
        Self { printed, seen }
    }

    /// Removes 2 % of the marks and adds 1 % false ones, each anywhere in a format of its own.
    pub(crate) fn disturbed(mut self, seed: u64) -> Self {
        let mut numbers = Numbers(seed);
        let (lost, formats) = (numbers.chosen(LOST), numbers.chosen(FALSE));
        let mut is_lost = vec![false; MARKS];
        lost.into_iter().for_each(|n| is_lost[n] = true);
        let mut kept = is_lost.iter();
        self.seen.retain(|_| kept.next() == Some(&false));
        for n in formats {
            let behind = 1 + numbers.below(FORMAT as usize - 1) as i64;
            self.seen.push(Mark { place: self.printed[n] + behind, is_false: true });
        }
        self.seen.sort();
        self
    }
}

/// Returns the stretch of a distance between marks: 0.1 % (60 inc), which varies linearly to 0.05 % and 0.15 % and back
/// in each thousand of them.
pub(crate) fn drift(n: usize) -> i64 {
    let part = |j: usize| (60 * j / 500) as i64 - 30;
    60 + match n % 1000 {
        j @ ..500 => part(j),
        j => -part(j - 500),
    }
}
