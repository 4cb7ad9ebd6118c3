//! Regimes of an axis that may have backlash between motor and load, with its encoder on the motor.
//!
//! Law      in contact the motor turns the whole inertia: the model. Within the backlash it turns alone, and the same
//!          effort accelerates it 1 + inertia_ratio times as much, with none or all of the friction, as its
//!          distribution is unknown. Between the regimes the coupling acts: the load oscillates on it, and backlash
//!          makes it appear softer, so the oscillation may have any frequency
//! Reads    a model in contact, the inertia of the load relative to that of the motor
//! Writes   models, the one in contact first, and only that one without a ratio; the limit of the open loop of the
//!          motor alone for such an oscillation
//! Refuses  a ratio outside 0 to 1000, and a ratio for a velocity drive, which itself controls its motor through
//!          backlash
//!
//! Such a load multiplies the response of the motor alone by (1 + R s^2 / (s^2 + 2 z w s + w^2)) / (1 + R). Over all w
//! the second term is a circle from 0 over j / (2 z) to 1. So in the direction of -1 an open loop L of the motor alone
//! is raised to Im(L) R / ((1 + R) 2 z) if its phase is beyond -180 degrees, and to less than 1 otherwise: a limit of
//! Im(L) keeps the gain margin at any stiffness.

use super::DesignSpec;
use crate::model::{Dynamics, Model, ModelError, judge};

/// Maximum inertia of a load relative to that of the motor.
pub const MOST_INERTIA_RATIO: f64 = 1000.0;

/// Minimum damping of a load that oscillates on a coupling, relative to the critical one: that of steel and its joints.
pub const COUPLING_DAMPING: f64 = 0.02;

/// Maximum viscous friction of a model (1/s).
const MOST_VISCOUS: f64 = 1e4;

/// Returns the models of the regimes, the one in contact first; `inertia_ratio` 0: not given.
///
/// # Errors
/// A ratio outside its range.
pub fn regimes(model: &Model, inertia_ratio: f64) -> Result<Vec<Model>, ModelError> {
    const UNIT: &str = "times the motor's";
    judge("inertia_ratio", inertia_ratio, UNIT, 0.0, MOST_INERTIA_RATIO)?;
    if inertia_ratio == 0.0 {
        return Ok(vec![*model]);
    }
    let Dynamics::Effort { acceleration, viscous, coulomb, load, .. } = model.dynamics else {
        return judge("inertia_ratio", inertia_ratio, UNIT, 0.0, 0.0).map(|()| vec![*model]);
    };
    let times = 1.0 + inertia_ratio;
    let with = |part: f64| Dynamics::Effort {
        acceleration: times * acceleration,
        viscous: (part * times * viscous).min(MOST_VISCOUS),
        coulomb: part * times * coulomb,
        load: times * load,
        resonance: None,
    };
    let alone = |part| Model { dynamics: with(part), ..*model };
    Ok(if viscous > 0.0 { vec![*model, alone(0.0), alone(1.0)] } else { vec![*model, alone(0.0)] })
}

/// Returns the maximum imaginary part of the open loop of a motor alone, beyond its crossover; `None` without a ratio.
pub(super) fn max_imaginary(wish: &DesignSpec) -> Option<f64> {
    let share = wish.inertia_ratio / (1.0 + wish.inertia_ratio);
    let margin = libm::exp10(-wish.targets.gain_margin / 20.0);
    (share > 0.0).then(|| margin * 2.0 * COUPLING_DAMPING / share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Resonance;

    fn model(viscous: f64) -> Model {
        let resonance = Some(Resonance { frequency: 50.0, damping: 0.05, inertia_ratio: 4.0 });
        let dynamics = Dynamics::Effort { acceleration: 1e6, viscous, coulomb: 2e4, load: -1e4, resonance };
        Model { cycle: 1e-3, delay: 2e-3, dynamics }
    }

    /// A sixth of the inertia: all is six times as large, with no friction or six times the friction.
    #[test]
    fn a_motor_alone_is_faster_by_the_inertia_that_it_leaves() {
        let found = regimes(&model(2.0), 5.0).unwrap();
        let alone = |viscous, coulomb| Model {
            dynamics: Dynamics::Effort { acceleration: 6e6, viscous, coulomb, load: -6e4, resonance: None },
            ..model(2.0)
        };
        assert_eq!(found, [model(2.0), alone(0.0, 0.0), alone(12.0, 12e4)]);
        assert_eq!(regimes(&model(0.0), 5.0).unwrap().len(), 2);
        assert_eq!(regimes(&model(2.0), 0.0).unwrap(), [model(2.0)]);
        // 1001 times 20 1/s exceeds the range of a model.
        assert_eq!(regimes(&model(20.0), 1000.0).unwrap()[2].check(), Ok(()));
    }
}
