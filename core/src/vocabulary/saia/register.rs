//! Input registers of the module, in its own units.

use crate::parameter::{ROWS, Row};

/// An input register, by its offset in the memory of the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Register {
    /// KProp
    KProp,
    /// KInt
    KInt,
    /// KDer
    KDer,
    /// IntL
    IntL,
    /// SampI
    SampI,
    /// MCFac
    McFac,
    /// PosEr
    PosEr,
    /// DestP
    DestP,
    /// BrkP
    BrkP,
    /// Veloc
    Veloc,
    /// Accel
    Accel,
    /// StaFRR
    StaFrr,
    /// MCW
    Mcw,
}

/// Indices of the parameter rows, by offset.
const PLACES: [u16; Register::COUNT] = {
    let mut places = [0; Register::COUNT];
    let mut offset = 0;
    while offset < places.len() {
        places[offset] = Row::place(Register::ALL[offset].1);
        offset += 1;
    }
    places
};

impl Register {
    /// Number of registers.
    pub const COUNT: usize = 13;

    /// All registers with their parameters, by offset.
    pub const ALL: [(Register, &'static str); Self::COUNT] = [
        (Register::KProp, "saia.kprop"),
        (Register::KInt, "saia.kint"),
        (Register::KDer, "saia.kder"),
        (Register::IntL, "saia.intl"),
        (Register::SampI, "saia.sampi"),
        (Register::McFac, "saia.mcfac"),
        (Register::PosEr, "saia.poser"),
        (Register::DestP, "saia.destp"),
        (Register::BrkP, "saia.brkp"),
        (Register::Veloc, "saia.veloc"),
        (Register::Accel, "saia.accel"),
        (Register::StaFrr, "saia.stafrr"),
        (Register::Mcw, "saia.mcw"),
    ];

    /// Returns the name of the manual in lower case.
    pub fn name(self) -> &'static str {
        self.key().strip_prefix("saia.").unwrap_or_default()
    }

    /// Returns the register of that name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().map(|(register, _)| *register).find(|register| register.name() == name)
    }

    /// Returns the key of its parameter.
    pub fn key(self) -> &'static str {
        Self::ALL.get(self as usize).map_or("", |(_, key)| key)
    }

    /// Returns the index of its parameter row.
    pub fn place(self) -> u16 {
        PLACES.get(self as usize).copied().unwrap_or(u16::MAX)
    }

    /// Returns the index of its parameter row, and the row.
    pub fn row(self) -> Option<(u16, &'static Row)> {
        Some((self.place(), ROWS.get(usize::from(self.place()))?))
    }

    /// Returns the range that its commands accept; `None` if the range depends on the scaling (SAIA-REG-00..06).
    pub fn permitted(self) -> Option<(i64, i64)> {
        match self {
            Self::KProp | Self::KInt | Self::KDer | Self::IntL | Self::PosEr => Some((0, 32_767)),
            Self::SampI => Some((0, 255)),
            _ => None,
        }
    }
}
