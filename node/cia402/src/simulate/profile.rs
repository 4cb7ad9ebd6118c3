//! Profile position (pp): set-points that a handshake transfers, each reached with a trapezoidal profile.
//!
//! Law      a rising edge of bit 4 of the control word transfers a set-point if bit 12 of the status word is 0. With bit 5 it applies at
//!          once, otherwise after the present one. Bit 12 falls when bit 4 is 0 and there is room for one more set-point. Bit 6: relative
//!          to the previous set-point. Bit 9: the previous set-point is passed at its velocity. Bit 8 halts. The highest velocity v that
//!          can still stop within a distance d by steps of D T satisfies v^2 / (2 D) + v T / 2 = d
//! Reads    the control word, 607Ah, 6081h, 6083h, 6084h
//! Writes   a position for each cycle, bits 10 and 12 of the status word
//! Source   CiA 402-2, profile position mode

/// Control word bit 4: new set-point.
const NEW_SETPOINT: u16 = 0x0010;
/// Control word bit 5: change set immediately, the new set-point replaces the present one at once.
const AT_ONCE: u16 = 0x0020;
/// Control word bit 6: relative set-point.
const RELATIVE: u16 = 0x0040;
/// Control word bit 8: halt.
pub(super) const HALT: u16 = 0x0100;
/// Control word bit 9: change on set-point, the previous set-point is passed without a stop.
const ON_THE_FLY: u16 = 0x0200;

/// Maximum acceleration and deceleration, in counts/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    pub(super) up: f64,
    pub(super) down: f64,
}

/// Returns a velocity after one more cycle on its ramp towards a target.
pub(super) fn velocity_on_ramp(velocity: f64, target: f64, ramp: Ramp, cycle_s: f64) -> f64 {
    let slows = target * velocity < 0.0 || target.abs() < velocity.abs();
    let most = if slows { ramp.down } else { ramp.up } * cycle_s;
    velocity + (target - velocity).clamp(-most, most)
}

/// Returns the position nearest to `reference` whose lower 32 bits are `word`: positions of a drive wrap.
pub(super) fn nearest(word: i32, reference: i64) -> i64 {
    reference.wrapping_add(word.wrapping_sub(reference as i32).into())
}

/// Set-point as the objects give it at present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SetpointCommand {
    /// Target position (607Ah).
    pub(super) target: i32,
    /// Profile velocity, in counts/s.
    pub(super) velocity: f64,
    pub(super) ramp: Ramp,
}

/// Transferred set-point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Setpoint {
    target: i64,
    velocity: f64,
    ramp: Ramp,
    /// Whether the previous set-point is passed without a stop.
    is_on_the_fly: bool,
}

/// Set-points of a drive, and its demand position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Positioner {
    /// Position demand value, in counts, and its fraction of a count.
    demand: i64,
    rest: f64,
    /// Velocity, in counts/s.
    velocity: f64,
    active: Option<Setpoint>,
    next: Option<Setpoint>,
    /// Last transferred target, in counts.
    last: i64,
    has_bit_4: bool,
    is_acknowledged: bool,
    is_halted: bool,
}

impl Positioner {
    /// Resets the positioner to position `count`. A bit 4 that is already 1 is not treated as an edge later.
    pub(super) fn rest_at(&mut self, count: i64, control: u16) {
        *self = Self { demand: count, last: count, has_bit_4: control & NEW_SETPOINT != 0, ..Self::default() };
    }

    /// Returns bit 12: the set-point is acknowledged, and there is no room for another one.
    pub(super) fn is_acknowledged(&self) -> bool {
        self.is_acknowledged
    }

    /// Returns bit 10: the target is reached; during halt: the drive is at rest.
    pub(super) fn is_reached(&self) -> bool {
        if self.is_halted { self.velocity == 0.0 } else { self.active.is_none() }
    }

    /// Advances by one cycle. Returns the position demand value.
    pub(super) fn step(&mut self, control: u16, order: SetpointCommand, cycle_s: f64) -> i64 {
        self.handle_handshake(control, order);
        self.is_halted = control & HALT != 0;
        if let Some(setpoint) = self.active {
            self.move_to(setpoint, cycle_s);
        }
        self.demand
    }

    /// Handles the handshake.
    fn handle_handshake(&mut self, control: u16, order: SetpointCommand) {
        let has_bit_4 = control & NEW_SETPOINT != 0;
        let had_bit_4 = std::mem::replace(&mut self.has_bit_4, has_bit_4);
        if !has_bit_4 {
            self.is_acknowledged &= self.next.is_some();
        } else if !had_bit_4 && !self.is_acknowledged {
            self.is_acknowledged = true;
            self.accept_setpoint(control, order);
        }
    }

    fn accept_setpoint(&mut self, control: u16, SetpointCommand { target, velocity, ramp }: SetpointCommand) {
        self.last = match control & RELATIVE {
            0 => nearest(target, self.demand),
            _ => self.last.wrapping_add(target.into()),
        };
        let is_on_the_fly = control & ON_THE_FLY != 0;
        let setpoint = Some(Setpoint { target: self.last, velocity, ramp, is_on_the_fly });
        if control & AT_ONCE != 0 || self.active.is_none() {
            (self.active, self.next) = (setpoint, None);
        } else {
            self.next = setpoint;
        }
    }

    fn move_to(&mut self, Setpoint { target, velocity, ramp, .. }: Setpoint, cycle_s: f64) {
        let left = target.wrapping_sub(self.demand) as f64 - self.rest;
        let passes = self.next.is_some_and(|next| next.is_on_the_fly);
        let speed = match (self.is_halted, passes) {
            (true, _) => 0.0,
            (false, true) => velocity,
            (false, false) => velocity.min(stopping_velocity(left.abs(), ramp.down, cycle_s)),
        };
        self.velocity = velocity_on_ramp(self.velocity, speed.copysign(left), ramp, cycle_s);
        let way = self.velocity * cycle_s;
        let arrives = !self.is_halted && way * left >= 0.0 && way.abs() >= left.abs();
        if arrives && !passes && self.velocity.abs() <= 2.0 * ramp.down * cycle_s {
            (self.demand, self.rest, self.velocity) = (target, 0.0, 0.0);
            self.active = self.next.take();
            return;
        }
        let moved = self.rest + way;
        // The conversion saturates.
        self.demand = self.demand.wrapping_add(moved.floor() as i64);
        self.rest = moved - moved.floor();
        if arrives && passes {
            self.active = self.next.take();
        }
    }
}

/// Returns the velocity that can be stopped within a distance by steps of `down` times the cycle.
fn stopping_velocity(distance: f64, down: f64, cycle_s: f64) -> f64 {
    let half = down * cycle_s / 2.0;
    (half * half + 2.0 * down * distance).sqrt() - half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 ms.
    const CYCLE_S: f64 = 0.01;
    /// 1000 counts/s^2.
    const RAMP: Ramp = Ramp { up: 1_000.0, down: 1_000.0 };

    /// 100 counts/s.
    fn order(target: i32) -> SetpointCommand {
        SetpointCommand { target, velocity: 100.0, ramp: RAMP }
    }

    fn at(count: i64) -> Positioner {
        let mut positioner = Positioner::default();
        positioner.rest_at(count, 0x0F);
        positioner
    }

    /// Runs cycles with one control word. Returns the positions.
    fn run(positioner: &mut Positioner, cycles: usize, control: u16, target: i32) -> Vec<i64> {
        (0..cycles).map(|_| positioner.step(control, order(target), CYCLE_S)).collect()
    }

    /// A trapezoidal profile of 100 counts: 0.1 s acceleration to 100 counts/s (5 counts), 0.9 s constant velocity, 0.1 s deceleration: 1.1
    /// s = 110 cycles. The position is 50 in the middle.
    #[test]
    fn set_point_is_reached_on_a_trapezoid_of_1_1_s() {
        let mut positioner = at(0);
        let way = run(&mut positioner, 112, 0x1F, 100);
        assert_eq!(way.last(), Some(&100));
        let arrival = way.iter().position(|position| *position == 100).unwrap() + 1;
        assert!((107..=112).contains(&arrival), "{arrival} cycles");
        assert!((48..=51).contains(&way[54]), "{}", way[54]);
        // At most 1 count per cycle, never backwards.
        assert!(way.windows(2).all(|pair| (0..=1).contains(&(pair[1] - pair[0]))), "{way:?}");
        assert!(positioner.is_reached());
    }

    /// Bit 12 rises with the rising edge of bit 4 and falls with its falling edge. While bit 4 stays 1, no set-point is transferred.
    #[test]
    fn set_point_is_acknowledged_once_per_edge_of_bit_4() {
        let mut positioner = at(7);
        run(&mut positioner, 1, 0x0F, 50);
        assert!(positioner.is_reached() && !positioner.is_acknowledged());
        run(&mut positioner, 1, 0x1F, 50);
        assert!(!positioner.is_reached() && positioner.is_acknowledged());
        run(&mut positioner, 300, 0x1F, 90);
        assert_eq!(positioner.demand, 50, "no edge");
        assert!(positioner.is_reached() && positioner.is_acknowledged());
        run(&mut positioner, 1, 0x0F, 90);
        assert!(!positioner.is_acknowledged());
        assert_eq!(run(&mut positioner, 300, 0x1F, 90).last(), Some(&90));
    }

    #[test]
    fn bit_4_that_is_set_before_the_mode_is_no_edge() {
        let mut positioner = Positioner::default();
        positioner.rest_at(0, 0x1F);
        assert_eq!(run(&mut positioner, 50, 0x1F, 90).last(), Some(&0));
    }

    /// Without bit 5 the second set-point waits: both are reached, and bit 12 stays 1 until the first one ends. With bit 5 it replaces the
    /// first one.
    #[test]
    fn second_set_point_waits_or_replaces_the_first() {
        let mut waits = at(0);
        run(&mut waits, 1, 0x1F, 50);
        run(&mut waits, 1, 0x0F, 50);
        run(&mut waits, 1, 0x1F, -20);
        run(&mut waits, 5, 0x0F, -20);
        assert!(waits.is_acknowledged(), "both places are taken");
        let way = run(&mut waits, 400, 0x0F, -20);
        assert_eq!((way.iter().max(), way.last()), (Some(&50), Some(&-20)));
        assert!(!waits.is_acknowledged());

        let mut replaces = at(0);
        run(&mut replaces, 1, 0x3F, 50);
        run(&mut replaces, 10, 0x2F, 50);
        let way = run(&mut replaces, 400, 0x3F, -20);
        assert!(way.iter().max().is_some_and(|most| *most < 20), "{way:?}");
        assert_eq!(way.last(), Some(&-20));
    }

    /// Bit 6: 30 after 50 is 80. Bit 9: the first target is passed at 100 counts/s, which is 1 count per cycle.
    #[test]
    fn relative_set_points_add_up_and_bit_9_passes_the_first() {
        let mut relative = at(10);
        run(&mut relative, 1, 0x5F, 40);
        run(&mut relative, 1, 0x4F, 40);
        assert_eq!(run(&mut relative, 400, 0x5F, 30).last(), Some(&80));

        let mut passes = at(0);
        run(&mut passes, 1, 0x1F, 50);
        run(&mut passes, 1, 0x0F, 50);
        let way = run(&mut passes, 400, 0x21F, 100);
        let near: Vec<_> =
            way.windows(2).filter(|pair| (45..55).contains(&pair[0])).map(|pair| pair[1] - pair[0]).collect();
        assert_eq!(near, [1; 10]);
        assert_eq!(way.last(), Some(&100));
    }

    /// Bit 8 stops the motion within the 5 counts of the ramp; after that it continues to its target.
    #[test]
    fn halt_stops_and_motion_resumes() {
        let mut positioner = at(0);
        let before = *run(&mut positioner, 40, 0x1F, 100).last().unwrap();
        let halted = *run(&mut positioner, 40, 0x11F, 100).last().unwrap();
        assert!((4..=6).contains(&(halted - before)), "{before} to {halted}");
        assert!(positioner.is_reached(), "at rest");
        assert_eq!(run(&mut positioner, 200, 0x1F, 100).last(), Some(&100));
    }

    /// 607Ah has 32 bits: the nearest position with these bits is used.
    #[test]
    fn targets_follow_counts_beyond_32_bits() {
        assert_eq!(nearest(5, (1 << 32) - 10), (1 << 32) + 5);
        assert_eq!(nearest(-1, 0), -1);
    }
}
