//! Axes with backlash and a given ratio of inertias: gains for both regimes, tried on the simulated coupling with its
//! backlash.

use super::catalogue::{all, coupled};
use super::fastest;
use super::simulator::{Axis, excite, figures, permitted, run_until, trapezoid};
use lineshaft_core::regulator::VelocityMethod;
use lineshaft_tune::{Design, DesignSpec, Identified, Law, Loops, PositionLaw, Targets, design, identify};
use std::fmt;

/// Random figures of an axis with backlash.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RandomAxis {
    /// Inertia of the load relative to that of the motor.
    pub(crate) ratio: f64,
    /// Backlash, in increments of 8192 per turn.
    pub(crate) play: f64,
    /// Coulomb friction of the motor and of the load relative to the maximum effort.
    pub(crate) friction: (f64, f64),
    /// Delay, in cycles.
    pub(crate) delay: f64,
    /// Frequency of the coupling in contact (Hz), and its damping.
    pub(crate) coupling: (f64, f64),
    /// Given ratio relative to the true one.
    pub(crate) told: f64,
}

/// Maximum time after a command, and time for which the motor has to rest (s).
const LONG: f64 = 120.0;
const RESTS: f64 = 10.0;

/// Result of a simulation.
#[derive(Clone, Copy)]
struct Moved {
    /// Whether there is no limit cycle after a step and after a move.
    rests: bool,
    /// Overshoot of the step (%).
    overshoot: f64,
    /// Settling time after the step and after the move, within the backlash and 3 inc (s).
    settled: [Option<f64>; 2],
    /// Following error of the move (inc).
    error: f64,
}

impl fmt::Display for Moved {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rests, overshoot, settled, error } = self;
        write!(
            out,
            "rests {rests}, overshoot {overshoot:.0} %, settled {settled:.2?} s, following error {error:.0} inc"
        )
    }
}

impl RandomAxis {
    fn axis(&self) -> Axis {
        coupled(self)
    }

    fn wish(&self, law: Law, velocity: Option<VelocityMethod>) -> DesignSpec {
        let encoder = self.axis().encoder;
        DesignSpec {
            law,
            velocity,
            max_velocity: 45.0 * encoder,
            max_acceleration: 100.0 * encoder,
            inertia_ratio: self.told * self.ratio,
            targets: Targets::default(),
        }
    }

    fn identified(&self) -> Result<Identified, String> {
        let axis = self.axis();
        let record = excite(axis, permitted(&axis), |_| 0.0).record;
        let found = identify(&record).map_err(|refusal| refusal.to_string())?;
        Ok(found)
    }

    fn moved(&self, loops: &Loops) -> Moved {
        let (step, to) = (self.step(), self.to());
        let window = self.play + 3.0;
        let (axis, is_held) = (self.axis(), !has_integral(loops));
        let rests = |way: &[(f64, f64)]| rests(way, axis.cycle, window, is_held);
        let ways = [&step, &to].map(|motion| motion.run(axis, loops, rests));
        let [(overshoot, settled, _), (_, moved, error)] =
            [0, 1].map(|i| figures(&ways[i], [&step, &to][i].distance, [&step, &to][i].end, window, axis.cycle));
        Moved { rests: ways.iter().all(|way| rests(way)), overshoot, settled: [settled, moved], error }
    }

    /// Returns true if backlash makes a limit cycle worse, by more than itself and 3 inc. A motor whose static friction
    /// exceeds its Coulomb friction has a slow limit cycle with an integral term, with or without backlash.
    fn backlash_worsens_limit_cycle(&self, loops: &Loops) -> bool {
        let twin = Self { play: 0.0, ..*self };
        [self.step(), self.to()].iter().any(|motion| {
            let [with, without] = [self, &twin].map(|drawn| swing(&motion.run(drawn.axis(), loops, |_| false)));
            println!("  hunts by {with:.1} inc, without play by {without:.1} inc");
            with > without + self.play + 3.0
        })
    }

    fn step(&self) -> Motion {
        let size = 0.02 * self.axis().encoder;
        Motion { distance: size, end: 0.1, rates: None }
    }

    /// Three turns with two fifths of the effort for the whole inertia.
    fn to(&self) -> Motion {
        let inc = self.axis().encoder;
        let acceleration = (636.0 / (1.0 + self.ratio)).min(200.0);
        let (way, velocity) = (3.0 * inc, fastest(acceleration) * inc);
        let acceleration = acceleration * inc;
        Motion {
            distance: way,
            end: 0.1 + velocity / acceleration + way / velocity,
            rates: Some((velocity, acceleration)),
        }
    }
}

/// A step at 0.1 s, or a move that begins then (inc, s).
struct Motion {
    distance: f64,
    end: f64,
    /// Velocity and acceleration of a move.
    rates: Option<(f64, f64)>,
}

impl Motion {
    fn run(&self, axis: Axis, loops: &Loops, is_over: impl Fn(&[(f64, f64)]) -> bool) -> Vec<(f64, f64)> {
        let (distance, until) = (self.distance, self.end + LONG);
        match self.rates {
            None => run_until(
                axis,
                loops,
                until,
                |time| if time < 0.1 { (0.0, 0.0, 0.0) } else { (distance, 0.0, 0.0) },
                is_over,
            ),
            Some((velocity, acceleration)) => {
                run_until(axis, loops, until, trapezoid(distance, velocity, acceleration), is_over)
            }
        }
    }
}

/// Returns the lowest and highest error (inc) in the last seconds; `None` if the command still moves.
fn late(way: &[(f64, f64)], cycles: usize) -> Option<(f64, f64)> {
    assert!(way.iter().all(|(asked, place)| asked.is_finite() && place.is_finite()), "a plant that is nowhere");
    let last = way.last()?.0;
    let late = way.get(way.len().checked_sub(cycles + 1)?..)?;
    let ends = |(low, high): (f64, f64), (_, place): &(f64, f64)| (low.min(place - last), high.max(place - last));
    (late[0].0 == last).then(|| late.iter().fold((f64::MAX, f64::MIN), ends))
}

/// Returns true if the motor oscillates by at most the window, at its target, or at any position if it is held.
fn rests(way: &[(f64, f64)], cycle: f64, window: f64, is_held: bool) -> bool {
    late(way, (RESTS / cycle) as usize)
        .is_some_and(|(low, high)| high - low <= window && (high.max(-low) <= window || is_held))
}

/// Returns the oscillation in the second half.
fn swing(way: &[(f64, f64)]) -> f64 {
    late(way, way.len() / 2).map_or(f64::INFINITY, |(low, high)| high - low)
}

fn has_integral(loops: &Loops) -> bool {
    let outer = matches!(loops.position, PositionLaw::Pid { gains, .. } if gains.integral != 0);
    outer || loops.velocity.is_some_and(|inner| inner.gains.integral != 0)
}

fn laws() -> [(Law, Option<VelocityMethod>); 3] {
    let filtered = Some(VelocityMethod::Filtered { time: 0.001 });
    [(Law::Proportional, filtered), (Law::Pid { timer: 1 }, filtered), (Law::Pid { timer: 1 }, None)]
}

/// Checks that gains leave no oscillation beyond the backlash and 3 inc; failures are reported.
fn judge(drawn: &RandomAxis, failed: &mut Vec<String>) -> [Option<(Design, Moved)>; 3] {
    let found = match drawn.identified() {
        Ok(found) => found,
        Err(sentence) => {
            println!("{drawn:?}: {sentence}");
            return [None, None, None];
        }
    };
    laws().map(|(law, velocity)| {
        let design = match design(&found.for_design(drawn.told * drawn.ratio), &drawn.wish(law, velocity)) {
            Ok(design) => design,
            Err(error) => {
                println!("{drawn:?} {law:?} {}: {error}", velocity.is_some());
                return None;
            }
        };
        let moved = drawn.moved(&design.loops);
        let line = format!(
            "{drawn:?} {law:?} {}: {moved}; {:.0} deg, {:.0} dB; {:?} {:?}",
            velocity.is_some(),
            design.position.phase,
            design.velocity.map_or(design.position.gain, |inner| inner.gain.min(design.position.gain)),
            design.loops.position,
            design.loops.velocity.map(|inner| inner.gains)
        );
        println!("{line}");
        if !moved.rests && (drawn.friction.0 == 0.0 || drawn.backlash_worsens_limit_cycle(&design.loops)) {
            failed.push(line);
        }
        Some((design, moved))
    })
}

#[test]
fn gains_of_both_regimes_do_not_swing() {
    let (mut failed, mut count) = (Vec::new(), [0; 3]);
    let mut most = [0.0_f64; 3];
    // Only a third of them, with each delay equally often, unless all are requested.
    let is_long = std::env::var_os("LINESHAFT_LONG").is_some();
    let mut number = 0;
    for ratio in [1.0, 3.0, 10.0, 30.0] {
        for play in [3.0, 20.0, 100.0] {
            for friction in [(0.0, 0.0), (0.02, 0.0), (0.1, 0.0), (0.0, 0.02), (0.0, 0.1)] {
                number += 1;
                for delay in [0.0, 1.0, 2.0] {
                    if !is_long && number % 3 != delay as usize {
                        continue;
                    }
                    let drawn = RandomAxis { ratio, play, friction, delay, coupling: (150.0, 0.03), told: 1.0 };
                    for (law, found) in judge(&drawn, &mut failed).into_iter().enumerate() {
                        count[law] += usize::from(found.is_some());
                        most[law] = most[law].max(found.map_or(0.0, |(_, moved)| moved.overshoot));
                    }
                }
            }
        }
    }
    println!("{count:?} of {} each, overshoot up to {most:.0?} %", if is_long { 180 } else { 60 });
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
    assert!(count.iter().all(|count| 4 * count > if is_long { 180 } else { 60 }), "{count:?}");
}

/// Random numbers between 0 and 1 from a seed.
struct RandomNumbers(u64);

impl RandomNumbers {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    fn drawn(&mut self) -> RandomAxis {
        let size = [0.0, 0.1 * self.next()][usize::from(self.next() > 0.25)];
        let on_motor = self.next().round();
        RandomAxis {
            ratio: self.between(1.0, 30.0),
            play: self.between(3.0, 100.0),
            friction: (size * on_motor, size * (1.0 - on_motor)),
            delay: 2.0 * self.next(),
            coupling: (self.between(60.0, 400.0), self.between(0.02, 0.1)),
            told: 0.8 + 0.4 * self.next(),
        }
    }
}

/// New axes, with a ratio that is wrong by up to a fifth: no limit of the design was tuned to them.
#[test]
fn axes_that_are_drawn_do_not_swing() {
    let mut chance = RandomNumbers(0xD1B5_4A32_D192_ED03);
    let (mut failed, mut count) = (Vec::new(), [0; 3]);
    for _ in 0..64 {
        let drawn = chance.drawn();
        for (law, found) in judge(&drawn, &mut failed).into_iter().enumerate() {
            count[law] += usize::from(found.is_some());
        }
    }
    println!("{count:?} of 64 each");
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
    // A test that rejects all axes would prove nothing.
    assert!(count.iter().all(|count| 4 * count > 64), "{count:?}");
}

/// Without a ratio all axes have the gains of the time before the ratio was introduced.
#[test]
fn without_a_ratio_nothing_changes() {
    let expected = [
        ("1:1", 121.9, 1165, 40, 125),
        ("1:5", 117.7, 3414, 115, 44),
        ("1:30", 61.5, 8678, 140, 36),
        ("elastic", 30.4, 490, 3, 1667),
    ];
    for (name, kv, proportional, integral, limit) in expected {
        let named = all().into_iter().find(|named| named.name == name).expect("an axis");
        let record = excite(named.axis, permitted(&named.axis), |_| 0.0).record;
        let found = identify(&record).expect("a model");
        assert_eq!(found.for_design(0.0), found.model);
        let tried = named.loops.iter().find(|tried| tried.law == Law::Proportional).expect("a cascade");
        let (max_velocity, max_acceleration) = (45.0 * named.axis.encoder, 100.0 * named.axis.encoder);
        let targets = Targets::default();
        let wish = DesignSpec {
            law: tried.law,
            velocity: tried.velocity,
            max_velocity,
            max_acceleration,
            inertia_ratio: 0.0,
            targets,
        };
        let loops = design(&found.model, &wish).expect("gains").loops;
        let (PositionLaw::Proportional { kv: found }, Some(inner)) = (loops.position, loops.velocity) else { panic!() };
        assert!((found - kv).abs() <= 0.06, "{name}: {found}");
        let gains = inner.gains;
        assert_eq!((gains.proportional, gains.integral, gains.limit), (proportional, integral, limit), "{name}");
    }
}

/// Backlash hides up to 0.7 cycles of the delay of these axes; the model for the design contains all of it, to the 50
/// us of any model.
#[test]
fn a_hidden_delay_counts() {
    for ratio in [1.0, 3.0, 10.0] {
        for delay in [1.0, 2.0] {
            let drawn =
                RandomAxis { ratio, play: 20.0, friction: (0.0, 0.0), delay, coupling: (150.0, 0.03), told: 1.0 };
            let found = drawn.identified().expect("a model");
            let (counts, truth) = (found.for_design(ratio).delay, drawn.axis().delay);
            assert!(counts >= truth - 5e-5, "1:{ratio}, {truth} s: {counts}");
        }
    }
}
