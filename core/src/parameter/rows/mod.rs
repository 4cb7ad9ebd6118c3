//! The rows of the catalogue: native ones first, then those of each source.

/// Rows by their keys, each with the row from which it takes what it does not say itself.
///
/// `axis.field` is the field that `get` reads and `set` writes; the type of the field decides which values that are
/// ([`ParameterField`]). `clears other` leaves out the relative value that was given instead. `machine.field` is a field of the
/// parameters of the machine. A row that calculates its value has `get` and `set` among its entries.
macro_rules! rows {
    ($(
        $key:literal: $base:ident
        $(, axis $(.$field:ident)+ $([$index:literal])? $(, clears $($relative:ident).+)?)?
        $(, machine.$of_machine:ident)?
        { $($name:ident: $value:expr),+ $(,)? }
    )*) => {
        &[$(Row {
            key: $key,
            $(
                get: |p| $crate::parameter::rows::ParameterField::value(p$(.$field)+ $([$index])?),
                set: |p, v| {
                    $crate::parameter::rows::ParameterField::set(&mut p$(.$field)+ $([$index])?, v);
                    $(p$(.$relative)+ = None;)?
                },
            )?
            $(
                get_machine: |m| $crate::parameter::rows::ParameterField::value(m.$of_machine),
                set_machine: |m, v| $crate::parameter::rows::ParameterField::set(&mut m.$of_machine, v),
            )?
            $($name: $value,)+
            ..$base
        }),*]
    };
}

mod amc;
mod compensation;
mod encoder;
mod gantry;
mod homing;
mod macs;
mod native;
mod saia;
mod supervision;
mod virtual_master;
mod wf;

use super::{Applies, Bare, Effect, Group, Measure, PROBE_INPUTS, PROFILES, Range, Row, Storage, System, Value};

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

/// The type of a field that a row reads and writes.
trait ParameterField: Copy {
    /// Returns the value of the field.
    fn value(self) -> Value;

    /// Returns what the field is for a value; none for a value of another type.
    fn of(value: Value) -> Option<Self>;

    /// Sets the field; a value of another type, which [`Row::check`] refuses, changes nothing.
    fn set(&mut self, value: Value) {
        *self = Self::of(value).unwrap_or(*self);
    }
}

impl ParameterField for i64 {
    fn value(self) -> Value {
        Value::Int(self)
    }

    fn of(value: Value) -> Option<Self> {
        int(value)
    }
}

impl ParameterField for i32 {
    fn value(self) -> Value {
        Value::Int(self.into())
    }

    fn of(value: Value) -> Option<Self> {
        int(value).and_then(|number| number.try_into().ok())
    }
}

impl ParameterField for f64 {
    fn value(self) -> Value {
        Value::Real(self)
    }

    fn of(value: Value) -> Option<Self> {
        real(value)
    }
}

impl ParameterField for bool {
    fn value(self) -> Value {
        Value::Int(self.into())
    }

    fn of(value: Value) -> Option<Self> {
        int(value).map(|number| number == 1)
    }
}

/// None where the parameter is left out.
impl<T: ParameterField> ParameterField for Option<T> {
    fn value(self) -> Value {
        self.map_or(Value::Unset, T::value)
    }

    fn of(value: Value) -> Option<Self> {
        Some(T::of(value))
    }
}

/// What most rows have.
const BASE: Row = Row {
    key: "",
    system: System::Native,
    mnemonic: "",
    number: "",
    group: Group::Basic,
    view_of: "",
    measure: Measure::Integer,
    unit: "",
    range: POSITION,
    bare: Bare::Si,
    default: Value::Unset,
    default_text: "",
    required: false,
    storage: Storage::User,
    effect: Effect::AtOnce,
    applies: Applies::Any,
    by_axis: false,
    full_cycles: None,
    missing: "",
    description: "",
    source: "",
    note: "",
    get: |_| Value::Unset,
    set: |_, _| (),
    get_machine: |_| Value::Unset,
    set_machine: |_, _| (),
};

/// Every parameter: those of axes, of which each has the ones that apply to it, and those of the machine.
pub const ROWS: &[Row] = &join::<{ count(PARTS) }>(PARTS);

/// Rows with [`Row::by_axis`].
pub(super) const BY_AXIS: [&Row; count_with(RowMark::ByAxis)] = rows_with(RowMark::ByAxis);

/// Rows with [`Row::full_cycles`].
pub(super) const FULL_CYCLES: [&Row; count_with(RowMark::FullCycles)] = rows_with(RowMark::FullCycles);

/// Place of the sense of rotation, on which the meaning of others depends: [`PARTS`] begins with it.
pub(super) const SENSE_ROW: u16 = 0;

/// What the meaning of others depends on, native rows, then those of each source.
const PARTS: &[&[&[Row]]] = &[
    &[
        macs::SENSE,
        native::ROWS,
        homing::ROWS,
        encoder::ROWS,
        supervision::ROWS,
        gantry::ROWS,
        compensation::ROWS,
        virtual_master::ROWS,
    ],
    &macs::PARTS,
    &[amc::ROWS, saia::ROWS, wf::ROWS],
];

const fn count(parts: &[&[&[Row]]]) -> usize {
    let (mut part, mut count) = (0, 0);
    while part < parts.len() {
        let mut group = 0;
        while group < parts[part].len() {
            count += parts[part][group].len();
            group += 1;
        }
        part += 1;
    }
    count
}

const fn join<const N: usize>(parts: &[&[&[Row]]]) -> [Row; N] {
    let mut rows = [BASE; N];
    let (mut part, mut place) = (0, 0);
    while part < parts.len() {
        let mut group = 0;
        while group < parts[part].len() {
            let mut index = 0;
            while index < parts[part][group].len() {
                rows[place] = parts[part][group][index];
                index += 1;
                place += 1;
            }
            group += 1;
        }
        part += 1;
    }
    rows
}

/// What a row has whose rows are listed, so that no cycle searches them.
#[derive(Clone, Copy)]
enum RowMark {
    ByAxis,
    FullCycles,
}

const fn has(row: &Row, mark: RowMark) -> bool {
    match mark {
        RowMark::ByAxis => row.by_axis,
        RowMark::FullCycles => row.full_cycles.is_some(),
    }
}

const fn count_with(mark: RowMark) -> usize {
    let (mut place, mut count) = (0, 0);
    while place < ROWS.len() {
        count += has(&ROWS[place], mark) as usize;
        place += 1;
    }
    count
}

const fn rows_with<const N: usize>(mark: RowMark) -> [&'static Row; N] {
    let mut rows = [&ROWS[0]; N];
    let (mut place, mut count) = (0, 0);
    while place < ROWS.len() {
        if has(&ROWS[place], mark) {
            rows[count] = &ROWS[place];
            count += 1;
        }
        place += 1;
    }
    rows
}
