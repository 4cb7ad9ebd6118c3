//! Direction of counting of an axis, and its permission to reverse.
//!
//! Source   MACS-DIR-01, MACS-DIR-05 to MACS-DIR-10, A-07, A-08

use super::AxisParameters;
use crate::position::Position;

/// Values of POSDRCT (MACS-DIR-01): each is true if it is inverted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CountDirection {
    /// Whether the units of the user count against the encoder.
    pub units: bool,
    /// Whether a positive reference of the position loop moves the encoder in negative direction.
    pub position: bool,
    /// Whether a positive reference of the velocity loop moves the encoder in negative direction.
    pub velocity: bool,
}

impl CountDirection {
    /// Decodes POSDRCT; `None` for an invalid value.
    pub fn decode(posdrct: i64) -> Option<Self> {
        let digits = posdrct.unsigned_abs();
        let (tens, ones) = if digits < 10 { (digits, digits) } else { (digits / 10, digits % 10) };
        let inverted = |digit: u64| match digit {
            1 => Some(false),
            2 => Some(true),
            _ => None,
        };
        Some(Self { units: posdrct < 0, position: inverted(ones)?, velocity: inverted(tens)? })
    }

    /// Converts between encoder counts and counts of the user, in either direction (inc).
    #[inline]
    pub(crate) fn invert(self, counts: i64) -> i64 {
        if self.units { counts.wrapping_neg() } else { counts }
    }

    /// Converts a position in the same way.
    #[inline]
    pub(crate) fn invert_position(self, position: Position) -> Position {
        if self.units { -position } else { position }
    }

    /// Converts a velocity, an acceleration or an effort in the same way. Never returns -0.
    #[inline]
    pub(crate) fn invert_real(self, value: f64) -> f64 {
        if self.units { 0.0 - value } else { value }
    }
}

/// Condition for backward motion of an axis (MACS-DIR-06).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReversingRule {
    /// Always allowed.
    #[default]
    Always,
    /// Allowed while the master of its coupling moves backward, including the sign of the ratio; never without a
    /// coupling.
    WithMaster,
    /// Never allowed.
    Never,
}

/// Output of the sign of the reference, as set by REVERS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Polarity {
    /// The reference itself has a sign (MACS-DIR-08, output 0).
    #[default]
    Bipolar,
    /// This output shows the sign (MACS-DIR-08).
    Direction(u8),
    /// This output enables one direction, the next output the other (MACS-DIR-09).
    Enables(u8),
}

/// Values of REVERS (MACS-DIR-05, -09).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reversing {
    /// Condition for backward motion.
    pub rule: ReversingRule,
    /// Output of the sign to the drive.
    pub polarity: Polarity,
    /// Bus ID of the drive; 0: none (MACS-DIR-10).
    pub node: u8,
}

impl Reversing {
    /// Decodes REVERS: rule + 10 output + 100 node, or -10 to -90; `None` for an invalid value.
    pub fn decode(revers: i64) -> Option<Self> {
        if revers < 0 {
            let output = u8::try_from(revers.unsigned_abs() / 10).ok().filter(|output| (1..=9).contains(output))?;
            return (revers % 10 == 0).then_some(Self { polarity: Polarity::Enables(output), ..Self::default() });
        }
        let rule = match revers % 10 {
            0 => ReversingRule::Always,
            1 => ReversingRule::WithMaster,
            2 => ReversingRule::Never,
            _ => return None,
        };
        let polarity = match u8::try_from(revers / 10 % 10).ok()? {
            0 => Polarity::Bipolar,
            output => Polarity::Direction(output),
        };
        let node = u8::try_from(revers / 100).ok().filter(|node| *node <= 127)?;
        Some(Self { rule, polarity, node })
    }

    /// Returns true if all of it is implemented: rule and outputs.
    pub fn is_implemented(self) -> bool {
        self.node == 0
    }

    /// Returns the highest number of an output that it names; 0 for none.
    pub fn last_output(self) -> i64 {
        match self.polarity {
            Polarity::Bipolar => 0,
            Polarity::Direction(output) => output.into(),
            Polarity::Enables(output) => i64::from(output) + 1,
        }
    }
}

impl AxisParameters {
    /// Returns the values of POSDRCT.
    pub fn sense(&self) -> CountDirection {
        // The row accepts no other values.
        CountDirection::decode(self.macs.posdrct).unwrap_or_default()
    }

    /// Returns the values of REVERS.
    pub fn reversing(&self) -> Reversing {
        Reversing::decode(self.macs.revers).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sense(units: bool, position: bool, velocity: bool) -> Option<CountDirection> {
        Some(CountDirection { units, position, velocity })
    }

    /// The table of the source; 11 means 1, and every other value is invalid.
    ///
    /// Proves: MACS-DIR-01
    #[test]
    fn posdrct_decodes_by_its_table() {
        let table = [
            (1, sense(false, false, false)),
            (-1, sense(true, false, false)),
            (2, sense(false, true, true)),
            (-2, sense(true, true, true)),
            (12, sense(false, true, false)),
            (21, sense(false, false, true)),
            (22, sense(false, true, true)),
            (-12, sense(true, true, false)),
            (-21, sense(true, false, true)),
            (-22, sense(true, true, true)),
            (11, sense(false, false, false)),
            (-11, sense(true, false, false)),
        ];
        for value in -300..=300 {
            let expected = table.iter().find(|(known, _)| *known == value).and_then(|(_, sense)| *sense);
            assert_eq!(CountDirection::decode(value), expected, "{value}");
        }
        for value in [i64::MIN, i64::MAX, 112, 211] {
            assert_eq!(CountDirection::decode(value), None, "{value}");
        }
    }

    /// The row accepts exactly the values that can be decoded.
    ///
    /// Proves: MACS-DIR-01, MACS-DIR-05
    #[test]
    fn rows_take_what_decodes() {
        use crate::parameter::{Row, Value};
        let (_, posdrct) = Row::find("posdrct").unwrap();
        let (_, revers) = Row::find("revers").unwrap();
        for value in -200..=13_000 {
            let takes = |row: &Row| row.check(Value::Int(value)).is_ok();
            assert_eq!(takes(posdrct), CountDirection::decode(value).is_some(), "posdrct {value}");
            assert_eq!(takes(revers), Reversing::decode(value).is_some(), "revers {value}");
        }
    }

    /// rule + 10 output + 100 node, and the two enables.
    ///
    /// Proves: MACS-DIR-05
    #[test]
    fn revers_decodes_into_rule_output_and_node() {
        let of = |rule, polarity, node| Some(Reversing { rule, polarity, node });
        for (value, expected) in [
            (0, of(ReversingRule::Always, Polarity::Bipolar, 0)),
            (1, of(ReversingRule::WithMaster, Polarity::Bipolar, 0)),
            (2, of(ReversingRule::Never, Polarity::Bipolar, 0)),
            (3, None),
            (12, of(ReversingRule::Never, Polarity::Direction(1), 0)),
            // The example that the printed range omits.
            (20, of(ReversingRule::Always, Polarity::Direction(2), 0)),
            (300, of(ReversingRule::Always, Polarity::Bipolar, 3)),
            (12_702, of(ReversingRule::Never, Polarity::Bipolar, 127)),
            (12_792, of(ReversingRule::Never, Polarity::Direction(9), 127)),
            (12_793, None),
            (12_800, None),
            (-10, of(ReversingRule::Always, Polarity::Enables(1), 0)),
            (-90, of(ReversingRule::Always, Polarity::Enables(9), 0)),
            (-11, None),
            (-100, None),
            (i64::MIN, None),
            (i64::MAX, None),
        ] {
            assert_eq!(Reversing::decode(value), expected, "{value}");
        }
    }
}
