//! Laws of motion of VDI 2143: the motion of a slave over a segment of its master, both from 0 to 1.
//!
//! Law      s = f(z), 0 <= z <= 1; v, a, j are its first three derivatives by z. For each law except the dwell
//!          f(1 - z) = 1 - f(z)
//! Reads    z; outside the cycle, when a table is made: its numbers are rounded to whole ones for a cam
//! Refuses  nothing: a z out of range counts as the nearest end
//! Source   VDI 2143 part 1

use libm::{cos, sin, sqrt};
use std::f64::consts::PI;

/// A law of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// f = 0: the slave is at rest.
    Dwell,
    /// f = z. Velocity 1 throughout: next to a rest it jumps.
    Straight,
    /// f = (1 - cos(pi z)) / 2. Acceleration is pi^2/2 at the start and -pi^2/2 at the end: next to a rest it jumps.
    SimpleSine,
    /// a = A sin(4 pi z) up to z = 1/8, A sin(4 pi z / 3 + pi / 3) up to 7/8, then A sin(4 pi z) again; A = 4 pi^2
    /// / (4 + pi). The jerk jumps only at the ends.
    ModifiedSine,
    /// a = A sin(4 pi z) up to z = 1/8, A up to 3/8, -A sin(4 pi z) up to 5/8, -A up to 7/8, then A sin(4 pi z) again;
    /// A = 8 pi / (2 + pi). The jerk jumps only at the ends.
    ModifiedTrapezoid,
    /// f = 10 z^3 - 15 z^4 + 6 z^5. The jerk jumps only at the ends.
    Polynomial5,
    /// f = 35 z^4 - 84 z^5 + 70 z^6 - 20 z^7. The jerk is 0 at the ends.
    Polynomial7,
}

/// A position and its derivatives by the position of the master.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// Position.
    pub s: f64,
    /// Velocity, ds/dz.
    pub v: f64,
    /// Acceleration, d2s/dz2.
    pub a: f64,
    /// Jerk, d3s/dz3.
    pub j: f64,
}

/// Largest magnitude of a derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Magnitude.
    pub value: f64,
    /// First position of the master with this value.
    pub at: f64,
}

/// Largest magnitudes of velocity, acceleration and jerk. A jump counts with the values on either side of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Peak of the velocity; for a law Cv.
    pub v: Peak,
    /// Peak of the acceleration; for a law Ca.
    pub a: Peak,
    /// Peak of the jerk; for a law Cj.
    pub j: Peak,
}

impl Peaks {
    /// Returns the larger peak of each, or this one if equal.
    pub(super) fn or(self, other: Self) -> Self {
        let larger = |one: Peak, other: Peak| if other.value > one.value { other } else { one };
        Self { v: larger(self.v, other.v), a: larger(self.a, other.a), j: larger(self.j, other.j) }
    }

    /// Converts peaks by z to those over a section of a master that begins at `from` with the given length, with
    /// `travel` times the position.
    pub(super) fn over(self, from: f64, length: f64, travel: f64) -> Self {
        let [v, a, j] = rates(length, [self.v, self.a, self.j].map(|peak| peak.value * travel.abs()));
        let place = |value: f64, peak: Peak| Peak { value, at: from + length * peak.at };
        Self { v: place(v, self.v), a: place(a, self.a), j: place(j, self.j) }
    }
}

impl Derivatives {
    /// Converts values by z to those over a section of a master with the given length, with a position from `y` and
    /// `travel` times that of z.
    pub(super) fn over(self, y: f64, length: f64, travel: f64) -> Self {
        let [v, a, j] = rates(length, [self.v, self.a, self.j].map(|rate| rate * travel));
        Self { s: y + self.s * travel, v, a, j }
    }
}

/// Converts derivatives by z to those by the position of a master, with `length` for z = 1.
fn rates(length: f64, [v, a, j]: [f64; 3]) -> [f64; 3] {
    [v / length, a / length / length, j / length / length / length]
}

impl Law {
    /// All laws with their names.
    pub const ALL: [(Law, &'static str); 7] = [
        (Law::Dwell, "dwell"),
        (Law::Straight, "straight"),
        (Law::SimpleSine, "simple_sine"),
        (Law::ModifiedSine, "modified_sine"),
        (Law::ModifiedTrapezoid, "modified_trapezoid"),
        (Law::Polynomial5, "polynomial_5"),
        (Law::Polynomial7, "polynomial_7"),
    ];

    /// Returns the name in descriptions of tables.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(law, _)| *law == self).map_or("", |(_, name)| name)
    }

    /// Returns position and derivatives at `z`.
    pub fn at(self, z: f64) -> Derivatives {
        let z = z.clamp(0.0, 1.0);
        if self == Self::Dwell {
            return Derivatives::default();
        }
        if z <= 0.5 {
            return self.first_half(z);
        }
        // Mirrored, so that the position at the end is exact, bit by bit.
        let Derivatives { s, v, a, j } = self.first_half(1.0 - z);
        Derivatives { s: 1.0 - s, v, a: -a, j }
    }

    fn first_half(self, z: f64) -> Derivatives {
        match self {
            Self::Dwell => Derivatives::default(),
            Self::Straight => Derivatives { s: z, v: 1.0, a: 0.0, j: 0.0 },
            Self::SimpleSine => {
                let half = sin(PI * z / 2.0);
                let (sin, cos) = (sin(PI * z), cos(PI * z));
                Derivatives { s: half * half, v: PI / 2.0 * sin, a: PI * PI / 2.0 * cos, j: -PI * PI * PI / 2.0 * sin }
            }
            Self::ModifiedSine => modified_sine(z),
            Self::ModifiedTrapezoid => modified_trapezoid(z),
            Self::Polynomial5 => Derivatives {
                s: z * z * z * (10.0 + z * (-15.0 + z * 6.0)),
                v: 30.0 * z * z * (1.0 - z) * (1.0 - z),
                a: 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z),
                j: 60.0 + z * (-360.0 + z * 360.0),
            },
            Self::Polynomial7 => {
                let p = z * (1.0 - z);
                Derivatives {
                    s: z * z * z * z * (35.0 + z * (-84.0 + z * (70.0 - z * 20.0))),
                    v: 140.0 * p * p * p,
                    a: 420.0 * p * p * (1.0 - 2.0 * z),
                    j: 840.0 * p * (1.0 - 5.0 * p),
                }
            }
        }
    }

    /// Returns Cv, Ca and Cj in closed form.
    pub fn peaks(self) -> Peaks {
        let of = |v, a, j| {
            let [v, a, j] = [v, a, j].map(|(value, at)| Peak { value, at });
            Peaks { v, a, j }
        };
        match self {
            Self::Dwell => Peaks::default(),
            Self::Straight => of((1.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
            Self::SimpleSine => of((PI / 2.0, 0.5), (PI * PI / 2.0, 0.0), (PI * PI * PI / 2.0, 0.5)),
            Self::ModifiedSine => {
                let part = PI / (4.0 + PI);
                of((4.0 * part, 0.5), (4.0 * PI * part, 0.125), (16.0 * PI * PI * part, 0.0))
            }
            Self::ModifiedTrapezoid => {
                let part = PI / (2.0 + PI);
                of((2.0, 0.5), (8.0 * part, 0.125), (32.0 * PI * part, 0.0))
            }
            Self::Polynomial5 => of((1.875, 0.5), (10.0 / sqrt(3.0), (3.0 - sqrt(3.0)) / 6.0), (60.0, 0.0)),
            Self::Polynomial7 => of((2.1875, 0.5), (84.0 * sqrt(5.0) / 25.0, (5.0 - sqrt(5.0)) / 10.0), (52.5, 0.5)),
        }
    }
}

/// Returns the first half, integrated from its acceleration; with k = 1 / (4 + pi) the position at 1/2 is 1/2.
fn modified_sine(z: f64) -> Derivatives {
    let k = 1.0 / (4.0 + PI);
    if z <= 0.125 {
        let (sin, cos) = (sin(4.0 * PI * z), cos(4.0 * PI * z));
        return Derivatives {
            s: k * (PI * z - sin / 4.0),
            v: k * PI * (1.0 - cos),
            a: k * 4.0 * PI * PI * sin,
            j: k * 16.0 * PI * PI * PI * cos,
        };
    }
    let phase = (4.0 * z + 1.0) * PI / 3.0;
    let (sin, cos) = (sin(phase), cos(phase));
    Derivatives {
        s: k * (2.0 + PI * z - 2.25 * sin),
        v: k * PI * (1.0 - 3.0 * cos),
        a: k * 4.0 * PI * PI * sin,
        j: k * 16.0 / 3.0 * PI * PI * PI * cos,
    }
}

/// Returns the first half, integrated from its acceleration; with k = 1 / (2 + pi) the position at 1/2 is 1/2.
fn modified_trapezoid(z: f64) -> Derivatives {
    let k = 1.0 / (2.0 + PI);
    let (sin, cos) = (sin(4.0 * PI * z), cos(4.0 * PI * z));
    if z <= 0.125 {
        return Derivatives {
            s: k * (2.0 * z - sin / (2.0 * PI)),
            v: k * 2.0 * (1.0 - cos),
            a: k * 8.0 * PI * sin,
            j: k * 32.0 * PI * PI * cos,
        };
    }
    if z <= 0.375 {
        return Derivatives {
            s: k * (z * (2.0 - PI + 4.0 * PI * z) + PI / 16.0 - 1.0 / (2.0 * PI)),
            v: k * (2.0 - PI + 8.0 * PI * z),
            a: k * 8.0 * PI,
            j: 0.0,
        };
    }
    Derivatives {
        s: k * ((2.0 + 2.0 * PI) * z - PI / 2.0 + sin / (2.0 * PI)),
        v: k * (2.0 + 2.0 * PI + 2.0 * cos),
        a: -k * 8.0 * PI * sin,
        j: -k * 32.0 * PI * PI * cos,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MOVING: [Law; 6] =
        [Law::Straight, Law::SimpleSine, Law::ModifiedSine, Law::ModifiedTrapezoid, Law::Polynomial5, Law::Polynomial7];

    fn near(one: f64, other: f64, within: f64) -> bool {
        (one - other).abs() <= within
    }

    #[test]
    fn every_law_has_a_name_of_its_own() {
        let names = Law::ALL.map(|(law, name)| (law.name() == name, name));
        let expected =
            ["dwell", "straight", "simple_sine", "modified_sine", "modified_trapezoid", "polynomial_5", "polynomial_7"];
        assert_eq!(names, expected.map(|name| (true, name)));
    }

    /// Values of VDI 2143, to its digits.
    #[test]
    fn peaks_are_those_of_the_source() {
        for (law, cv, ca, cj) in [
            (Law::Dwell, 0.0, 0.0, 0.0),
            (Law::Straight, 1.0, 0.0, 0.0),
            (Law::SimpleSine, PI / 2.0, 4.9348, 15.5031),
            (Law::ModifiedSine, 1.7596, 5.5280, 69.4663),
            (Law::ModifiedTrapezoid, 2.0, 4.8881, 61.4255),
            (Law::Polynomial5, 1.875, 5.7735, 60.0),
            (Law::Polynomial7, 2.1875, 7.5132, 52.5),
        ] {
            let Peaks { v, a, j } = law.peaks();
            assert!(
                near(v.value, cv, 1e-4) && near(a.value, ca, 1e-4) && near(j.value, cj, 1e-3),
                "{law:?}: {v:?} {a:?} {j:?}"
            );
            for (peak, reached) in [(v, law.at(v.at).v), (a, law.at(a.at).a), (j, law.at(j.at).j)] {
                assert!(near(reached.abs(), peak.value, 1e-12 * peak.value), "{law:?}: {reached} at {peak:?}");
            }
        }
    }

    /// Velocity, acceleration and jerk at z = 0; at z = 1 the acceleration has the opposite sign.
    #[test]
    fn ends_are_as_each_law_promises() {
        let pi = PI;
        for (law, v, a, j) in [
            (Law::Straight, 1.0, 0.0, 0.0),
            (Law::SimpleSine, 0.0, pi * pi / 2.0, 0.0),
            (Law::ModifiedSine, 0.0, 0.0, 16.0 * pi * pi * pi / (4.0 + pi)),
            (Law::ModifiedTrapezoid, 0.0, 0.0, 32.0 * pi * pi / (2.0 + pi)),
            (Law::Polynomial5, 0.0, 0.0, 60.0),
            (Law::Polynomial7, 0.0, 0.0, 0.0),
        ] {
            for (z, s, a) in [(0.0, 0.0, a), (-1.0, 0.0, a), (1.0, 1.0, -a), (1.5, 1.0, -a)] {
                let end = law.at(z);
                assert_eq!((end.s, end.v), (s, v), "{law:?} at {z}");
                assert!(near(end.a, a, 1e-12) && near(end.j, j, 1e-12), "{law:?} at {z}: {end:?}");
            }
        }
        assert_eq!([0.0, 0.3, 1.0].map(|z| Law::Dwell.at(z)), [Derivatives::default(); 3]);
    }

    /// Between the pieces of a law its acceleration is continuous, and its jerk, too.
    #[test]
    fn pieces_meet() {
        for law in MOVING {
            for z in [0.125, 0.375, 0.5, 0.625, 0.875_f64] {
                let (before, after) = (law.at(z.next_down()), law.at(z.next_up()));
                let pairs = [(before.s, after.s), (before.v, after.v), (before.a, after.a), (before.j, after.j)];
                assert!(pairs.iter().all(|(before, after)| near(*before, *after, 1e-12)), "{law:?} at {z}: {pairs:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn a_law_is_symmetric(z in 0.0_f64..=1.0) {
            for law in MOVING {
                let (one, other) = (law.at(z), law.at(1.0 - z));
                prop_assert!(near(one.s + other.s, 1.0, 1e-15), "{:?}: {} {}", law, one.s, other.s);
                prop_assert!(near(one.v, other.v, 1e-14) && near(one.a, -other.a, 1e-13) && near(one.j, other.j, 1e-12));
            }
        }

        #[test]
        fn no_value_exceeds_its_peak(z in 0.0_f64..=1.0) {
            for (law, _) in Law::ALL {
                let (now, peaks) = (law.at(z), law.peaks());
                for (value, peak) in [(now.v, peaks.v), (now.a, peaks.a), (now.j, peaks.j)] {
                    prop_assert!(value.abs() <= peak.value * (1.0 + 1e-14), "{:?}: {} beyond {:?}", law, value, peak);
                }
            }
        }

        /// Each is the derivative of the one before, compared with the difference over 2e-5, whose error is its square
        /// times a third derivative.
        #[test]
        fn derivatives_belong_together(z in 1e-5_f64..=1.0 - 1e-5) {
            for law in MOVING {
                let (before, now, after) = (law.at(z - 1e-5), law.at(z), law.at(z + 1e-5));
                let slope = |before: f64, after: f64| (after - before) / 2e-5;
                prop_assert!(near(slope(before.s, after.s), now.v, 1e-8), "{:?}: {:?}", law, now);
                prop_assert!(near(slope(before.v, after.v), now.a, 1e-7), "{:?}: {:?}", law, now);
                // The slope of the jerk jumps inside the modified laws, by less than 16 pi^2 A.
                prop_assert!(near(slope(before.a, after.a), now.j, 1e-2), "{:?}: {:?}", law, now);
            }
        }
    }
}
