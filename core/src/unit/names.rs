//! Units in files, and their dimensions.

use super::{Fraction, Quantity};
use std::fmt;

/// Physical dimension of a number. Lengths, angles and increments have the order of their time derivative, 0..=3:
/// position, velocity, acceleration, jerk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// Linear travel and its derivatives; SI m/s^n.
    Length(u8),
    /// Rotary travel and its derivatives; SI rad/s^n.
    Angle(u8),
    /// Encoder increments and their derivatives; inc/s^n.
    Increments(u8),
    /// A time; SI s.
    Time,
    /// A plain number, also as percent.
    Ratio,
    /// A frequency; SI Hz.
    Frequency,
    /// A mass; SI kg.
    Mass,
    /// A moment of inertia; SI kg*m^2.
    Inertia,
    /// A force; SI N.
    Force,
    /// A torque; SI Nm.
    Torque,
    /// A current; SI A.
    Current,
    /// A voltage; SI V.
    Voltage,
    /// Torque per angle; SI Nm/rad.
    Stiffness,
    /// Torque per angular velocity; SI Nm*s/rad.
    ViscousFriction,
    /// A resistance; SI Ohm.
    Resistance,
    /// An inductance; SI H.
    Inductance,
    /// Torque per current; SI Nm/A.
    TorqueConstant,
    /// Voltage per angular velocity; SI V*s/rad.
    VoltageConstant,
}

impl Dimension {
    /// Returns the unit of a number without a unit. A derivative order above 3 counts as 3.
    pub fn si_unit(self) -> Unit {
        let (base, order) = match self {
            Self::Length(order) => (Base::Metre, order),
            Self::Angle(order) => (Base::Radian, order),
            Self::Increments(order) => (Base::Increment, order),
            Self::Time => (Base::Second, 0),
            Self::Ratio => (Base::One, 0),
            Self::Frequency => (Base::Hertz, 0),
            Self::Mass => (Base::Kilogram, 0),
            Self::Inertia => (Base::KilogramSquareMetre, 0),
            Self::Force => (Base::Newton, 0),
            Self::Torque => (Base::NewtonMetre, 0),
            Self::Current => (Base::Ampere, 0),
            Self::Voltage => (Base::Volt, 0),
            Self::Stiffness => (Base::NewtonMetrePerRadian, 0),
            Self::ViscousFriction => (Base::NewtonMetreSecondPerRadian, 0),
            Self::Resistance => (Base::Ohm, 0),
            Self::Inductance => (Base::Henry, 0),
            Self::TorqueConstant => (Base::NewtonMetrePerAmpere, 0),
            Self::VoltageConstant => (Base::VoltSecondPerRadian, 0),
        };
        Unit { base, rate: Rate::per_second(order) }
    }

    /// Returns the most common unit: mm, deg, and per s, s^2, s^3; SI for all others.
    pub fn usual_unit(self) -> Unit {
        match self {
            Self::Length(order) => Unit::MILLIMETRE.with_order(order),
            Self::Angle(order) => Unit::DEGREE.with_order(order),
            other => other.si_unit(),
        }
    }

    /// Returns the derivative of `unit` of this dimension, such as `mm/s` of `mm`; the most common unit if `unit` is of
    /// another kind.
    pub fn unit_like(self, unit: Unit) -> Unit {
        let like = unit.with_order(self.order());
        if like.dimension() == self { like } else { self.usual_unit() }
    }

    /// Returns the dimension with an example, for messages: a velocity such as 1 mm/s. The example is in the unit of
    /// the axis, if given.
    pub fn such_as(self, unit: Option<Unit>) -> String {
        let unit = unit.map_or_else(|| self.usual_unit(), |unit| self.unit_like(unit));
        format!("{} such as `{}`", self.article(), Quantity::new(Fraction::from(1), unit))
    }

    /// Returns the dimension with its article, for messages: `an acceleration`.
    pub fn article(self) -> &'static str {
        match self {
            Self::Length(0) => "a length",
            Self::Length(1) => "a velocity",
            Self::Length(2) => "an acceleration",
            Self::Length(_) => "a jerk",
            Self::Angle(0) => "an angle",
            Self::Angle(1) => "an angular velocity",
            Self::Angle(2) => "an angular acceleration",
            Self::Angle(_) => "an angular jerk",
            Self::Increments(0) => "a number of increments",
            Self::Increments(1) => "a velocity in increments",
            Self::Increments(2) => "an acceleration in increments",
            Self::Increments(_) => "a jerk in increments",
            Self::Time => "a time",
            Self::Ratio => "a ratio",
            Self::Frequency => "a frequency",
            Self::Mass => "a mass",
            Self::Inertia => "an inertia",
            Self::Force => "a force",
            Self::Torque => "a torque",
            Self::Current => "a current",
            Self::Voltage => "a voltage",
            Self::Stiffness => "a stiffness",
            Self::ViscousFriction => "a viscous friction",
            Self::Resistance => "a resistance",
            Self::Inductance => "an inductance",
            Self::TorqueConstant => "a torque constant",
            Self::VoltageConstant => "a voltage constant",
        }
    }

    /// Returns the units of this dimension, for messages: `nm, um, mm, cm, m`.
    pub fn units(self) -> String {
        let rate = Rate::per_second(self.order());
        let units = BASES.iter().filter_map(|row| {
            let plain = Unit { base: row.base, rate: Rate::None };
            [plain, Unit { rate, ..plain }].into_iter().find(|unit| unit.is_valid() && unit.dimension() == self)
        });
        units
            .map(|unit| if unit.base == Base::One { "no unit".to_owned() } else { unit.to_string() })
            .collect::<Vec<_>>()
            .join(", ")
    }

    pub(super) fn order(self) -> u8 {
        match self {
            Self::Length(order) | Self::Angle(order) | Self::Increments(order) => order,
            _ => 0,
        }
    }
}

/// A unit, such as `mm`, `deg/s^2` or `rpm`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Unit {
    base: Base,
    rate: Rate,
}

impl Unit {
    /// m
    pub const METRE: Self = Self::plain(Base::Metre);
    /// mm
    pub const MILLIMETRE: Self = Self::plain(Base::Millimetre);
    /// rad
    pub const RADIAN: Self = Self::plain(Base::Radian);
    /// deg
    pub const DEGREE: Self = Self::plain(Base::Degree);
    /// rev: one turn
    pub const REVOLUTION: Self = Self::plain(Base::Revolution);
    /// inc: one encoder increment
    pub const INCREMENT: Self = Self::plain(Base::Increment);
    /// s
    pub const SECOND: Self = Self::plain(Base::Second);
    /// ms
    pub const MILLISECOND: Self = Self::plain(Base::Millisecond);

    const fn plain(base: Base) -> Self {
        Self { base, rate: Rate::None }
    }

    /// Returns the unit of that name, exactly as written in the contract; `None` for any other text.
    pub fn parse(text: &str) -> Option<Self> {
        // A unit that contains a slash itself, and no rate.
        if let Some(row) = BASES.iter().find(|row| row.name == text && text.contains('/')) {
            return Some(Self { base: row.base, rate: Rate::None });
        }
        let (name, suffix) = text.find('/').map_or((text, ""), |slash| text.split_at(slash));
        let row = BASES.iter().find(|row| row.name == name && !name.is_empty())?;
        let rate = RATES.iter().find(|(text, _)| *text == suffix)?.1;
        Some(Self { base: row.base, rate }).filter(|unit| unit.is_valid())
    }

    /// Returns the dimension of this unit.
    pub fn dimension(self) -> Dimension {
        match self.row().dimension {
            Dimension::Length(order) => Dimension::Length(order + self.rate.order()),
            Dimension::Angle(order) => Dimension::Angle(order + self.rate.order()),
            Dimension::Increments(order) => Dimension::Increments(order + self.rate.order()),
            other => other,
        }
    }

    /// Returns the same length, angle or increment per second to the power `order` (0..=3): `mm` with 2 is `mm/s^2`;
    /// rpm counts as rev. Other units do not change.
    #[must_use]
    pub fn with_order(self, order: u8) -> Self {
        match self.row().dimension {
            Dimension::Length(_) | Dimension::Angle(_) | Dimension::Increments(_) => {
                let base = if self.base == Base::Rpm { Base::Revolution } else { self.base };
                Self { base, rate: Rate::per_second(order) }
            }
            _ => self,
        }
    }

    /// Returns one of this unit in the exact base unit of its dimension: SI, but revolutions for angles; times are per
    /// second. `None` for radians, which have no exact ratio to a revolution.
    pub(super) fn in_base(self) -> Option<Fraction> {
        let row = self.row();
        let (numerator, denominator) = row.in_base?;
        Some(Fraction::new(numerator, denominator * if self.rate == Rate::PerMinute { 60 } else { 1 }))
    }

    /// Returns the unit that was probably meant by a text that is no unit, for the expected dimension.
    pub fn meant(text: &str, expected: Dimension) -> Option<&'static str> {
        let plain: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let known = |name: &str| ALL_UNITS.iter().copied().find(|unit| *unit == name);
        let lower = plain.to_lowercase().replace("sec", "s").replace("s²", "s^2").replace("s³", "s^3");
        let lower = lower.replace("s2", "s^2").replace("s3", "s^3").replace("**", "^");
        let renamed = ALIASES.iter().find(|(alias, _)| *alias == lower).map(|(_, unit)| *unit);
        let (name, suffix) = lower.find('/').map_or((lower.as_str(), ""), |slash| lower.split_at(slash));
        let base = ALIASES.iter().find(|(alias, _)| *alias == name).map(|(_, unit)| *unit);
        let mut same: Vec<_> = ALL_UNITS.iter().copied().filter(|unit| unit.to_lowercase() == lower).collect();
        // NM is nanometres if a length is expected, newton metres if a torque is.
        same.sort_by_key(|name| Unit::parse(name).is_none_or(|unit| unit.dimension() != expected));
        known(&plain).or(renamed).or(same.first().copied()).or_else(|| known(&format!("{}{suffix}", base?)))
    }

    fn is_valid(self) -> bool {
        let derivable =
            matches!(self.row().dimension, Dimension::Length(0) | Dimension::Angle(0) | Dimension::Increments(0));
        self.rate == Rate::None || derivable
    }

    fn row(self) -> &'static Row {
        &BASES[self.base as usize]
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)?;
        RATES.iter().find(|(_, rate)| *rate == self.rate).map_or(Ok(()), |(text, _)| f.write_str(text))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Rate {
    None,
    PerSecond,
    PerSecond2,
    PerSecond3,
    PerMinute,
}

impl Rate {
    fn per_second(order: u8) -> Self {
        match order {
            0 => Self::None,
            1 => Self::PerSecond,
            2 => Self::PerSecond2,
            _ => Self::PerSecond3,
        }
    }

    fn order(self) -> u8 {
        match self {
            Self::None => 0,
            Self::PerSecond | Self::PerMinute => 1,
            Self::PerSecond2 => 2,
            Self::PerSecond3 => 3,
        }
    }
}

const RATES: [(&str, Rate); 5] = [
    ("", Rate::None),
    ("/s", Rate::PerSecond),
    ("/s^2", Rate::PerSecond2),
    ("/s^3", Rate::PerSecond3),
    ("/min", Rate::PerMinute),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Base {
    Nanometre,
    Micrometre,
    Millimetre,
    Centimetre,
    Metre,
    Degree,
    Radian,
    Revolution,
    Rpm,
    Increment,
    Nanosecond,
    Microsecond,
    Millisecond,
    Second,
    Minute,
    One,
    Percent,
    Gram,
    Kilogram,
    KilogramSquareMetre,
    Newton,
    NewtonMetre,
    Milliampere,
    Ampere,
    Millivolt,
    Volt,
    Hertz,
    Kilohertz,
    NewtonMetrePerRadian,
    NewtonMetreSecondPerRadian,
    Ohm,
    Millihenry,
    Henry,
    NewtonMetrePerAmpere,
    VoltSecondPerRadian,
}

struct Row {
    base: Base,
    name: &'static str,
    dimension: Dimension,
    in_base: Option<(i128, i128)>,
}

const fn row(base: Base, name: &'static str, dimension: Dimension, numerator: i128, denominator: i128) -> Row {
    Row { base, name, dimension, in_base: Some((numerator, denominator)) }
}

/// In the order of [`Base`].
const BASES: [Row; 35] = [
    row(Base::Nanometre, "nm", Dimension::Length(0), 1, 1_000_000_000),
    row(Base::Micrometre, "um", Dimension::Length(0), 1, 1_000_000),
    row(Base::Millimetre, "mm", Dimension::Length(0), 1, 1000),
    row(Base::Centimetre, "cm", Dimension::Length(0), 1, 100),
    row(Base::Metre, "m", Dimension::Length(0), 1, 1),
    row(Base::Degree, "deg", Dimension::Angle(0), 1, 360),
    Row { base: Base::Radian, name: "rad", dimension: Dimension::Angle(0), in_base: None },
    row(Base::Revolution, "rev", Dimension::Angle(0), 1, 1),
    row(Base::Rpm, "rpm", Dimension::Angle(1), 1, 60),
    row(Base::Increment, "inc", Dimension::Increments(0), 1, 1),
    row(Base::Nanosecond, "ns", Dimension::Time, 1, 1_000_000_000),
    row(Base::Microsecond, "us", Dimension::Time, 1, 1_000_000),
    row(Base::Millisecond, "ms", Dimension::Time, 1, 1000),
    row(Base::Second, "s", Dimension::Time, 1, 1),
    row(Base::Minute, "min", Dimension::Time, 60, 1),
    row(Base::One, "", Dimension::Ratio, 1, 1),
    row(Base::Percent, "%", Dimension::Ratio, 1, 100),
    row(Base::Gram, "g", Dimension::Mass, 1, 1000),
    row(Base::Kilogram, "kg", Dimension::Mass, 1, 1),
    row(Base::KilogramSquareMetre, "kg*m^2", Dimension::Inertia, 1, 1),
    row(Base::Newton, "N", Dimension::Force, 1, 1),
    row(Base::NewtonMetre, "Nm", Dimension::Torque, 1, 1),
    row(Base::Milliampere, "mA", Dimension::Current, 1, 1000),
    row(Base::Ampere, "A", Dimension::Current, 1, 1),
    row(Base::Millivolt, "mV", Dimension::Voltage, 1, 1000),
    row(Base::Volt, "V", Dimension::Voltage, 1, 1),
    row(Base::Hertz, "Hz", Dimension::Frequency, 1, 1),
    row(Base::Kilohertz, "kHz", Dimension::Frequency, 1000, 1),
    row(Base::NewtonMetrePerRadian, "Nm/rad", Dimension::Stiffness, 1, 1),
    row(Base::NewtonMetreSecondPerRadian, "Nm*s/rad", Dimension::ViscousFriction, 1, 1),
    row(Base::Ohm, "Ohm", Dimension::Resistance, 1, 1),
    row(Base::Millihenry, "mH", Dimension::Inductance, 1, 1000),
    row(Base::Henry, "H", Dimension::Inductance, 1, 1),
    row(Base::NewtonMetrePerAmpere, "Nm/A", Dimension::TorqueConstant, 1, 1),
    row(Base::VoltSecondPerRadian, "V*s/rad", Dimension::VoltageConstant, 1, 1),
];

/// Every unit by name, for suggestions.
const ALL_UNITS: [&str; 66] = [
    "nm", "um", "mm", "cm", "m", "deg", "rad", "rev", "rpm", "inc", "ns", "us", "ms", "s", "min", "%", "g", "kg",
    "kg*m^2", "N", "Nm", "mA", "A", "mV", "V", "Hz", "kHz", "nm/s", "um/s", "mm/s", "cm/s", "m/s", "nm/s^2", "um/s^2",
    "mm/s^2", "cm/s^2", "m/s^2", "um/s^3", "mm/s^3", "cm/s^3", "m/s^3", "mm/min", "cm/min", "m/min", "deg/s", "rad/s",
    "rev/s", "deg/s^2", "rad/s^2", "rev/s^2", "deg/s^3", "rad/s^3", "rev/s^3", "deg/min", "rad/min", "rev/min",
    "inc/s", "inc/s^2", "inc/s^3", "Nm/rad", "Nm*s/rad", "Ohm", "mH", "H", "Nm/A", "V*s/rad",
];

/// Other common spellings, in lower case.
const ALIASES: [(&str, &str); 31] = [
    ("µm", "um"),
    ("μm", "um"),
    ("µs", "us"),
    ("μs", "us"),
    ("meter", "m"),
    ("metre", "m"),
    ("meters", "m"),
    ("°", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("grad", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("turn", "rev"),
    ("turns", "rev"),
    ("u", "rev"),
    ("u/min", "rpm"),
    ("1/min", "rpm"),
    ("/min", "rpm"),
    ("1/s", "Hz"),
    ("count", "inc"),
    ("counts", "inc"),
    ("qc", "inc"),
    ("second", "s"),
    ("seconds", "s"),
    ("minute", "min"),
    ("minutes", "min"),
    ("kgm2", "kg*m^2"),
    ("kgm^2", "kg*m^2"),
    ("n*m", "Nm"),
    ("ω", "Ohm"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_is_in_order_of_enum() {
        for (index, row) in BASES.iter().enumerate() {
            assert_eq!(row.base as usize, index, "{}", row.name);
        }
    }

    #[test]
    fn every_unit_of_the_contract_reads_and_writes_itself() {
        for text in ALL_UNITS {
            assert_eq!(Unit::parse(text).unwrap_or_else(|| panic!("{text}")).to_string(), text);
        }
    }

    #[test]
    fn an_example_is_in_the_unit_of_the_axis_where_that_fits() {
        let such_as = |dimension: Dimension, unit| dimension.such_as(unit);
        assert_eq!(such_as(Dimension::Length(2), None), "an acceleration such as `1 mm/s^2`");
        assert_eq!(such_as(Dimension::Length(1), Some(Unit::METRE)), "a velocity such as `1 m/s`");
        assert_eq!(such_as(Dimension::Angle(0), Some(Unit::METRE)), "an angle such as `1 deg`");
        assert_eq!(such_as(Dimension::Time, Some(Unit::METRE)), "a time such as `1 s`");
        assert_eq!(such_as(Dimension::Ratio, None), "a ratio such as `1`");
        assert_eq!(Dimension::Angle(3).unit_like(Unit::REVOLUTION).to_string(), "rev/s^3");
        assert_eq!(Dimension::Torque.usual_unit().to_string(), "Nm");
    }

    #[test]
    fn a_rate_needs_a_length_an_angle_or_increments() {
        for text in [
            "", "/s", "s/s", "rpm/s", "kg/s", "Nm/rad/s", "Nm/s", "Ohm/s", "%/s", "mm/ms", "mm/s^4", "mm/min^2", "mm/",
            "mm/s ", "MM", "Mm",
        ] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
    }

    #[test]
    fn dimensions_follow_the_rate() {
        for (text, dimension) in [
            ("mm/min", Dimension::Length(1)),
            ("rev/s^2", Dimension::Angle(2)),
            ("rpm", Dimension::Angle(1)),
            ("inc/s^3", Dimension::Increments(3)),
            ("kg*m^2", Dimension::Inertia),
            ("Nm", Dimension::Torque),
            ("Nm/rad", Dimension::Stiffness),
            ("Nm*s/rad", Dimension::ViscousFriction),
            ("mH", Dimension::Inductance),
        ] {
            assert_eq!(Unit::parse(text).unwrap().dimension(), dimension);
        }
    }

    #[test]
    fn other_spellings_are_understood_as_suggestions() {
        for (text, unit) in [
            ("MM", "mm"),
            ("mm / s", "mm/s"),
            ("m/s2", "m/s^2"),
            ("m/s²", "m/s^2"),
            ("mm/sec", "mm/s"),
            ("µm", "um"),
            ("°", "deg"),
            ("°/s", "deg/s"),
            ("degrees/sec", "deg/s"),
            ("1/min", "rpm"),
            ("hz", "Hz"),
            ("sec", "s"),
            ("NM", "Nm"),
            ("N*m/rad", "Nm/rad"),
            ("nm / rad", "Nm/rad"),
            ("ohm", "Ohm"),
            ("Ω", "Ohm"),
        ] {
            assert_eq!(Unit::meant(text, Dimension::Torque), Some(unit), "{text}");
        }
        assert_eq!(Unit::meant("NM", Dimension::Length(0)), Some("nm"));
        assert_eq!(Unit::meant("furlong", Dimension::Length(0)), None);
    }

    #[test]
    fn a_dimension_lists_its_units() {
        assert_eq!(Dimension::Length(0).units(), "nm, um, mm, cm, m");
        assert_eq!(Dimension::Angle(1).units(), "deg/s, rad/s, rev/s, rpm");
        assert_eq!(Dimension::Ratio.units(), "no unit, %");
        assert_eq!(Dimension::Time.units(), "ns, us, ms, s, min");
        assert_eq!(Dimension::Inductance.units(), "mH, H");
        assert_eq!(Dimension::ViscousFriction.units(), "Nm*s/rad");
    }
}
