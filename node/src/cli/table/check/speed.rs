//! Option `--master-speed`.
//!
//! Law      a number without a unit is in inc/s. A unit of length or angle needs the scale of the leader
//! Refuses  a speed that is not greater than 0, a unit that does not fit the leader

use super::Master;
use lineshaft_core::unit::{Dimension, Quantity, Unit, excerpt, parse_decimal};

/// Maximum speed, in inc/s.
const MOST: f64 = 1e12;

/// Returns the speed of the master, in inc/s: as given, otherwise the maximum of the leader, if known.
///
/// # Errors
/// Returns an error if the text is no speed, or if its unit needs a leader.
pub(super) fn master_speed(text: Option<&str>, leader: Option<&Master>) -> Result<Option<f64>, String> {
    let Some(text) = text else { return Ok(leader.and_then(|leader| leader.max_velocity)) };
    let speed = read(text, leader).map_err(|sentence| format!("--master-speed: {sentence}"))?;
    if speed > 0.0 && speed <= MOST {
        return Ok(Some(speed));
    }
    Err(format!("--master-speed is `{}`; a speed above 0, up to {MOST:e} inc/s, is allowed", excerpt(text)))
}

fn read(text: &str, leader: Option<&Master>) -> Result<f64, String> {
    let increments = Dimension::Increments(1);
    if parse_decimal(text.trim()).is_ok() {
        let speed = Quantity::parse(text, &[increments]).map_err(|error| error.message_with_hint())?;
        return Ok(speed.si());
    }
    let Some(scale) = leader.and_then(|leader| leader.scale) else {
        let all = [increments, Dimension::Length(1), Dimension::Angle(1)];
        let speed =
            Quantity::parse(text, &all).map_err(|error| error.message_with_example(increments, Unit::INCREMENT))?;
        if speed.unit().dimension() == increments {
            return Ok(speed.si());
        }
        let why = match leader {
            Some(leader) => format!("needs a scale, which {} lacks: give the speed in inc/s", leader.name),
            None => "needs the scale of the master: name it by --leader, or give the speed in inc/s".to_owned(),
        };
        return Err(format!("`{}` {why}", excerpt(text)));
    };
    let (expected, unit) = (scale.kind().dimension(1), scale.unit().unit());
    let speed =
        Quantity::parse(text, &[expected, increments]).map_err(|error| error.message_with_example(expected, unit))?;
    scale.rate(&speed, 1).map_err(|error| error.message_with_hint())
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::unit::{Fraction, Scale};

    /// 1000 inc are one millimetre.
    fn web() -> Master {
        let one = |unit| Quantity::new(Fraction::from(1), unit);
        let scale =
            Scale::new(Fraction::from(1000), one(Unit::MILLIMETRE)).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
        Master { name: "web".to_owned(), scale: Some(scale), max_velocity: Some(500_000.0) }
    }

    #[test]
    fn speed_has_a_unit_or_is_in_increments() {
        let web = web();
        for leader in [None, Some(&web)] {
            assert_eq!(master_speed(Some("40000"), leader), Ok(Some(40_000.0)));
            assert_eq!(master_speed(Some("40000 inc/s"), leader), Ok(Some(40_000.0)));
        }
        assert_eq!(master_speed(Some("300 mm/s"), Some(&web)), Ok(Some(300_000.0)));
        assert_eq!(master_speed(Some("18 m/min"), Some(&web)), Ok(Some(300_000.0)));
    }

    #[test]
    fn speed_is_max_velocity_of_the_leader_without_another_one() {
        let web = web();
        assert_eq!(master_speed(None, Some(&web)), Ok(Some(500_000.0)));
        assert_eq!(master_speed(None, Some(&Master { max_velocity: None, ..web })), Ok(None));
        assert_eq!(master_speed(None, None), Ok(None));
    }

    #[test]
    fn speed_that_makes_no_sense_is_refused_by_name() {
        let (web, counter) = (web(), Master { name: "ratio.sink".to_owned(), scale: None, max_velocity: None });
        for (text, leader, sentence) in [
            ("300 mm/s", Some(&counter), ": `300 mm/s` needs a scale, which ratio.sink lacks: give the speed in inc/s"),
            (
                "300 mm/s",
                None,
                ": `300 mm/s` needs the scale of the master: name it by --leader, or give the speed in inc/s",
            ),
            ("30 deg/s", Some(&web), ": `30 deg/s` is an angular velocity; a velocity such as `30 mm/s` is expected"),
            ("300 mm", Some(&web), ": `300 mm` is a length; a velocity such as `300 mm/s` is expected"),
            ("300mm/s", Some(&web), ": `300mm/s` has no blank between number and unit; write `300 mm/s`"),
            ("fast", Some(&web), ": `fast` is not a number; a velocity such as `1 mm/s` is expected"),
            ("fast", None, ": `fast` is not a number; a velocity in increments such as `1 inc/s` is expected"),
            ("0", None, " is `0`; a speed above 0, up to 1e12 inc/s, is allowed"),
            ("-5 mm/s", Some(&web), " is `-5 mm/s`; a speed above 0, up to 1e12 inc/s, is allowed"),
            ("1e13", None, " is `1e13`; a speed above 0, up to 1e12 inc/s, is allowed"),
        ] {
            assert_eq!(master_speed(Some(text), leader), Err(format!("--master-speed{sentence}")), "{text}");
        }
    }
}
