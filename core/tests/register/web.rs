//! A printed web: where its marks are, which of them the sensor sees, and what it takes for marks.

/// Marks that are printed.
pub(crate) const MARKS: usize = 10_000;
/// Way of the slave in a turn of the drum, which is the distance of marks where nothing stretches (inc).
pub(crate) const FORMAT: i64 = 60_000;
/// Where a mark belongs when the drum is at its zero, less whole formats (inc).
pub(crate) const PLACE: i64 = 10_000;
/// Of 10,000 marks so many are lost, and so many false ones come.
const LOST: usize = 200;
const FALSE: usize = 100;

/// Something that the sensor sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Mark {
    /// On the web (inc).
    pub place: i64,
    pub is_false: bool,
}

/// A web.
pub(crate) struct Web {
    /// Where each mark is printed (inc).
    pub printed: Vec<i64>,
    /// What the sensor sees, in the order in which it comes.
    pub seen: Vec<Mark>,
}

/// A small generator (splitmix64): the same web in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ mixed >> 31) % bound as u64) as usize
    }

    /// So many different marks.
    fn chosen(&mut self, count: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..MARKS).collect();
        (0..count).for_each(|i| all.swap(i, i + self.below(MARKS - i)));
        all.truncate(count);
        all
    }
}

impl Web {
    /// Every mark is seen, and so far (inc) from the one before it as `stretch` says, above the format.
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

    /// Of this web 2 % of the marks are lost; 1 % more come that are none, each anywhere in a format of its own.
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

/// A distance of marks that is 0.1 % (60 inc) too long, and goes to 0.05 % and 0.15 % and back in each thousand of them, evenly.
pub(crate) fn drift(n: usize) -> i64 {
    let part = |j: usize| (60 * j / 500) as i64 - 30;
    60 + match n % 1000 {
        j @ ..500 => part(j),
        j => -part(j - 500),
    }
}
