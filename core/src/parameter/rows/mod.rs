//! The rows of the catalogue: native ones first, then those of each source.

mod amc;
mod native;
mod saia;
mod wf;

use super::{Bare, Effect, Measure, PROFILES, Range, Row, Value};

const POSITION: Range = Range::Int(-((1 << 62) - 1), (1 << 62) - 1);
const MLONG: i64 = (1 << 30) - 1;
/// Velocity and its derivatives: far beyond any machine, and small enough that no product overflows.
const REAL: Range = Range::PositiveUpTo(1e15);
const HOUR_NS: i64 = 3_600_000_000_000;

fn real(value: Value) -> Option<f64> {
    match value {
        Value::Real(number) => Some(number),
        _ => None,
    }
}

fn int(value: Value) -> Option<i64> {
    match value {
        Value::Int(number) => Some(number),
        _ => None,
    }
}

fn option(value: Option<f64>) -> Value {
    value.map_or(Value::Unset, Value::Real)
}

/// What most rows have.
const BASE: Row = Row {
    key: "",
    mnemonic: "",
    number: 0,
    measure: Measure::Integer,
    range: POSITION,
    bare: Bare::Si,
    default: Value::Unset,
    default_text: "",
    required: false,
    effect: Effect::AtOnce,
    built: None,
    description: "",
    source: "",
    get: |_| Value::Unset,
    set: |_, _| (),
};

/// Every parameter of an axis.
pub const ROWS: &[Row] = &join::<{ native::ROWS.len() + amc::ROWS.len() + saia::ROWS.len() + wf::ROWS.len() }>([
    native::ROWS,
    amc::ROWS,
    saia::ROWS,
    wf::ROWS,
]);

const fn join<const N: usize>(parts: [&[Row]; 4]) -> [Row; N] {
    let mut rows = [BASE; N];
    let (mut part, mut place) = (0, 0);
    while part < parts.len() {
        let mut index = 0;
        while index < parts[part].len() {
            rows[place] = parts[part][index];
            index += 1;
            place += 1;
        }
        part += 1;
    }
    rows
}
