//! Execution of a function: one instruction after the other, each for one unit of fuel.
//!
//! Law      a call ends: at its end, in a trap, or when its fuel is used up. Moving large amounts of memory costs fuel
//!          in proportion to their size
//! Reads    and writes only memory, globals and stack; does not allocate

use crate::code::{Code, Function};
use crate::image::MOST_KEPT;
use crate::module::{Module, PAGE};
use crate::number::{Float, I32, I64, U32, U64, max, min, result, truncate};
use crate::trap::Trap;
use std::fmt;
use std::ops::Range;

/// Maximum slots of all frames.
const SLOTS: usize = 8192;
/// Maximum nested calls.
const FRAMES: usize = 256;
/// Bytes that are moved per unit of fuel.
const BYTES_PER_FUEL: u32 = 32;

/// Return information of a call.
#[derive(Clone, Copy, Debug, Default)]
struct Frame {
    /// Position in the code to continue at.
    at: usize,
    /// First slot of the frame of the caller.
    base: usize,
}

/// Working memory of a call; nothing in it is kept afterwards.
pub(crate) struct Stack {
    slots: Box<[u64]>,
    frames: Box<[Frame]>,
    /// Buffer for the memory during an exchange.
    pub beside: Box<[u8]>,
}

impl Default for Stack {
    fn default() -> Self {
        Self {
            slots: vec![0; SLOTS].into(),
            frames: vec![Frame::default(); FRAMES].into(),
            beside: vec![0; MOST_KEPT].into(),
        }
    }
}

impl fmt::Debug for Stack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Stack")
    }
}

/// Returns the quotient, or the trap if there is none.
#[inline(always)]
fn divide<T>(quotient: Option<T>, is_by_zero: bool) -> Result<T, Trap> {
    quotient.ok_or(if is_by_zero { Trap::DivisionByZero } else { Trap::IntegerOverflow })
}

/// Returns the remainder; that of the smallest number by -1 is 0.
#[inline(always)]
fn remainder<T: Default>(is_divided: bool, remainder: Option<T>) -> Result<T, Trap> {
    if is_divided { Ok(remainder.unwrap_or_default()) } else { Err(Trap::DivisionByZero) }
}

/// Returns the bytes at an address.
#[inline(always)]
fn bytes<const N: usize>(memory: &[u8], address: u64, offset: u32) -> Result<[u8; N], Trap> {
    let at = place(address, offset);
    memory.get(at..).and_then(|bytes| bytes.first_chunk()).copied().ok_or(Trap::MemoryOutOfBounds)
}

#[inline(always)]
fn put<const N: usize>(memory: &mut [u8], address: u64, offset: u32, bytes: [u8; N]) -> Result<(), Trap> {
    let at = place(address, offset);
    let to = memory.get_mut(at..).and_then(|bytes| bytes.first_chunk_mut()).ok_or(Trap::MemoryOutOfBounds)?;
    *to = bytes;
    Ok(())
}

/// Returns the sum of an address of 32 bits and an offset of 32 bits: 33 bits.
#[inline(always)]
fn place(address: u64, offset: u32) -> usize {
    usize::try_from((address & u64::from(u32::MAX)) + u64::from(offset)).unwrap_or(usize::MAX)
}

/// Returns a range of bytes in memory, from an address on.
fn range(from: u32, length: u32, memory: &[u8]) -> Result<Range<usize>, Trap> {
    let (from, length) = (u64::from(from), u64::from(length));
    match (usize::try_from(from), usize::try_from(from + length)) {
        (Ok(from), Ok(end)) if end <= memory.len() => Ok(from..end),
        _ => Err(Trap::MemoryOutOfBounds),
    }
}

/// Consumes fuel.
#[inline(always)]
fn consume(fuel: &mut u32, by: u32) -> Result<(), Trap> {
    match fuel.checked_sub(by) {
        Some(left) => {
            *fuel = left;
            Ok(())
        }
        None => {
            *fuel = 0;
            Err(Trap::OutOfFuel)
        }
    }
}

/// Prepares the frame of a function: its parameters are there already, its other locals become 0.
#[inline(always)]
fn enter<'s>(function: &Function, slots: &'s mut [u64], base: usize, fuel: &mut u32) -> Result<&'s mut [u64], Trap> {
    let end = base + usize::from(function.slots);
    let frame = slots.get_mut(base..end).ok_or(Trap::StackOverflow)?;
    if let Some(locals) = frame.get_mut(function.parameters.into()..function.locals.into()) {
        consume(fuel, fuel_of_move(8 * locals.len()))?;
        locals.fill(0);
    }
    Ok(frame)
}

/// Returns the additional fuel for moving that number of bytes; a frame has at most 32 KiB.
#[inline(always)]
fn fuel_of_move(bytes: usize) -> u32 {
    u32::try_from(bytes).unwrap_or(u32::MAX) / BYTES_PER_FUEL
}

/// Executes the function that each cycle calls.
pub(crate) fn call(
    module: &Module,
    memory: &mut [u8],
    globals: &mut [u64],
    stack: &mut Stack,
    fuel: &mut u32,
) -> Result<(), Trap> {
    let Stack { slots, frames, .. } = stack;
    let ops = module.ops.as_slice();
    // A loaded module has its entry: `load` has checked that.
    let Some(first) = module.functions.get(module.entry as usize) else { return Err(Trap::Unreachable) };
    let (mut base, mut depth, mut at) = (0, 0, first.entry as usize);
    let mut frame = enter(first, slots, base, fuel)?;
    loop {
        let Some(op) = ops.get(at) else { return Err(Trap::Unreachable) };
        at += 1;
        consume(fuel, 1)?;
        macro_rules! u64 {
            ($slot:expr) => {
                frame.get(usize::from($slot)).copied().unwrap_or_default()
            };
        }
        // The low 32 bits are the value.
        macro_rules! u32 {
            ($slot:expr) => {
                u64!($slot) as u32
            };
        }
        macro_rules! f32 {
            ($slot:expr) => {
                f32::of(u64!($slot))
            };
        }
        macro_rules! f64 {
            ($slot:expr) => {
                f64::of(u64!($slot))
            };
        }
        macro_rules! set {
            ($value:expr) => {{
                let value: u64 = $value;
                if let Some(slot) = frame.get_mut(usize::from(op.to)) {
                    *slot = value;
                }
            }};
        }
        macro_rules! load {
            ($as:ty, $bytes:ident => $value:expr) => {{
                let $bytes = bytes::<{ size_of::<$as>() }>(memory, u64!(op.a), op.imm)?;
                let $bytes = <$as>::from_le_bytes($bytes);
                set!($value)
            }};
        }
        macro_rules! call {
            ($number:expr) => {{
                let Some(function) = module.functions.get($number as usize) else { return Err(Trap::NoFunction) };
                let Some(from) = frames.get_mut(depth) else { return Err(Trap::StackOverflow) };
                *from = Frame { at, base };
                depth += 1;
                base += usize::from(op.a);
                at = function.entry as usize;
                frame = enter(function, slots, base, fuel)?;
            }};
        }
        match op.code {
            Code::Unreachable => return Err(Trap::Unreachable),
            Code::Jump => at = op.imm as usize,
            Code::JumpIfZero => {
                if u32!(op.a) == 0 {
                    at = op.imm as usize;
                }
            }
            Code::JumpIfNot => {
                if u32!(op.a) != 0 {
                    at = op.imm as usize;
                }
            }
            Code::JumpBy => at += u32!(op.a).min(op.imm) as usize,
            Code::Call => call!(op.imm),
            Code::CallBy => {
                let entry = module.tables.get(usize::from(op.to)).and_then(|table| table.get(u32!(op.b) as usize));
                let number = entry.copied().flatten().ok_or(Trap::NoFunction)?;
                if module.functions.get(number as usize).is_none_or(|function| function.kind != op.imm) {
                    return Err(Trap::SignatureMismatch);
                }
                call!(number)
            }
            Code::Return => {
                let from = usize::from(op.a);
                consume(fuel, fuel_of_move(8 * op.imm as usize))?;
                if from > 0 {
                    for nth in 0..op.imm as usize {
                        let value = frame.get(from + nth).copied().unwrap_or_default();
                        if let Some(slot) = frame.get_mut(nth) {
                            *slot = value;
                        }
                    }
                }
                let Some(before) = depth.checked_sub(1) else { return Ok(()) };
                depth = before;
                let Frame { at: back, base: of } = frames.get(depth).copied().unwrap_or_default();
                (at, base) = (back, of);
                // The slice extends beyond the frame of the caller, but its code does not access slots after its end.
                frame = slots.get_mut(base..).ok_or(Trap::StackOverflow)?;
            }
            Code::Copy => set!(u64!(op.a)),
            Code::Constant => set!(module.constants.get(op.imm as usize).copied().unwrap_or_default()),
            Code::Select => {
                let condition = frame.get(op.imm as usize).copied().unwrap_or_default() as u32;
                set!(if condition != 0 { u64!(op.a) } else { u64!(op.b) });
            }
            Code::GlobalGet => set!(globals.get(op.imm as usize).copied().unwrap_or_default()),
            Code::GlobalSet => {
                let value = u64!(op.a);
                if let Some(global) = globals.get_mut(op.imm as usize) {
                    *global = value;
                }
            }
            Code::Load8U => load!(u8, value => value.into()),
            Code::Load8S32 => load!(i8, value => i32::from(value).cast_unsigned().into()),
            Code::Load8S64 => load!(i8, value => i64::from(value).cast_unsigned()),
            Code::Load16U => load!(u16, value => value.into()),
            Code::Load16S32 => load!(i16, value => i32::from(value).cast_unsigned().into()),
            Code::Load16S64 => load!(i16, value => i64::from(value).cast_unsigned()),
            Code::Load32U => load!(u32, value => value.into()),
            Code::Load32S64 => load!(i32, value => i64::from(value).cast_unsigned()),
            Code::Load64 => load!(u64, value => value),
            Code::Store8 => put(memory, u64!(op.a), op.imm, (u64!(op.b) as u8).to_le_bytes())?,
            Code::Store16 => put(memory, u64!(op.a), op.imm, (u64!(op.b) as u16).to_le_bytes())?,
            Code::Store32 => put(memory, u64!(op.a), op.imm, u32!(op.b).to_le_bytes())?,
            Code::Store64 => put(memory, u64!(op.a), op.imm, u64!(op.b).to_le_bytes())?,
            Code::MemorySize => set!((memory.len() / PAGE) as u64),
            // Growing by zero pages always succeeds.
            Code::MemoryGrow => {
                set!(if u32!(op.a) == 0 { (memory.len() / PAGE) as u64 } else { u64::from(u32::MAX) });
            }
            Code::MemoryCopy => {
                let length = u32!(op.to);
                consume(fuel, length / BYTES_PER_FUEL)?;
                let (from, to) = (range(u32!(op.b), length, memory)?, range(u32!(op.a), length, memory)?);
                memory.copy_within(from, to.start);
            }
            Code::MemoryFill => {
                let length = u32!(op.to);
                consume(fuel, length / BYTES_PER_FUEL)?;
                let value = u32!(op.b) as u8;
                let to = range(u32!(op.a), length, memory)?;
                memory.get_mut(to).ok_or(Trap::MemoryOutOfBounds)?.fill(value);
            }
            Code::I32Eqz => set!(u64::from(u32!(op.a) == 0)),
            Code::I32Eq => set!(u64::from(u32!(op.a) == u32!(op.b))),
            Code::I32Ne => set!(u64::from(u32!(op.a) != u32!(op.b))),
            Code::I32LtS => set!(u64::from(u32!(op.a).cast_signed() < u32!(op.b).cast_signed())),
            Code::I32LtU => set!(u64::from(u32!(op.a) < u32!(op.b))),
            Code::I32GtS => set!(u64::from(u32!(op.a).cast_signed() > u32!(op.b).cast_signed())),
            Code::I32GtU => set!(u64::from(u32!(op.a) > u32!(op.b))),
            Code::I32LeS => set!(u64::from(u32!(op.a).cast_signed() <= u32!(op.b).cast_signed())),
            Code::I32LeU => set!(u64::from(u32!(op.a) <= u32!(op.b))),
            Code::I32GeS => set!(u64::from(u32!(op.a).cast_signed() >= u32!(op.b).cast_signed())),
            Code::I32GeU => set!(u64::from(u32!(op.a) >= u32!(op.b))),
            Code::I32Clz => set!(u32!(op.a).leading_zeros().into()),
            Code::I32Ctz => set!(u32!(op.a).trailing_zeros().into()),
            Code::I32Popcnt => set!(u32!(op.a).count_ones().into()),
            Code::I32Add => set!(u64::from(u32!(op.a).wrapping_add(u32!(op.b)))),
            Code::I32Sub => set!(u64::from(u32!(op.a).wrapping_sub(u32!(op.b)))),
            Code::I32Mul => set!(u64::from(u32!(op.a).wrapping_mul(u32!(op.b)))),
            Code::I32DivS => set!(u64::from(
                divide(u32!(op.a).cast_signed().checked_div(u32!(op.b).cast_signed()), u32!(op.b) == 0)?
                    .cast_unsigned()
            )),
            Code::I32DivU => set!(u64::from(divide(u32!(op.a).checked_div(u32!(op.b)), true)?)),
            Code::I32RemS => set!(u64::from(
                remainder(u32!(op.b) != 0, u32!(op.a).cast_signed().checked_rem(u32!(op.b).cast_signed()))?
                    .cast_unsigned()
            )),
            Code::I32RemU => set!(u64::from(divide(u32!(op.a).checked_rem(u32!(op.b)), true)?)),
            Code::I32And => set!(u64::from(u32!(op.a) & u32!(op.b))),
            Code::I32Or => set!(u64::from(u32!(op.a) | u32!(op.b))),
            Code::I32Xor => set!(u64::from(u32!(op.a) ^ u32!(op.b))),
            Code::I32Shl => set!(u64::from(u32!(op.a).wrapping_shl(u32!(op.b)))),
            Code::I32ShrS => set!(u64::from(u32!(op.a).cast_signed().wrapping_shr(u32!(op.b)).cast_unsigned())),
            Code::I32ShrU => set!(u64::from(u32!(op.a).wrapping_shr(u32!(op.b)))),
            Code::I32Rotl => set!(u64::from(u32!(op.a).rotate_left(u32!(op.b) % u32::BITS))),
            Code::I32Rotr => set!(u64::from(u32!(op.a).rotate_right(u32!(op.b) % u32::BITS))),
            Code::I64Eqz => set!(u64::from(u64!(op.a) == 0)),
            Code::I64Eq => set!(u64::from(u64!(op.a) == u64!(op.b))),
            Code::I64Ne => set!(u64::from(u64!(op.a) != u64!(op.b))),
            Code::I64LtS => set!(u64::from(u64!(op.a).cast_signed() < u64!(op.b).cast_signed())),
            Code::I64LtU => set!(u64::from(u64!(op.a) < u64!(op.b))),
            Code::I64GtS => set!(u64::from(u64!(op.a).cast_signed() > u64!(op.b).cast_signed())),
            Code::I64GtU => set!(u64::from(u64!(op.a) > u64!(op.b))),
            Code::I64LeS => set!(u64::from(u64!(op.a).cast_signed() <= u64!(op.b).cast_signed())),
            Code::I64LeU => set!(u64::from(u64!(op.a) <= u64!(op.b))),
            Code::I64GeS => set!(u64::from(u64!(op.a).cast_signed() >= u64!(op.b).cast_signed())),
            Code::I64GeU => set!(u64::from(u64!(op.a) >= u64!(op.b))),
            Code::I64Clz => set!(u64!(op.a).leading_zeros().into()),
            Code::I64Ctz => set!(u64!(op.a).trailing_zeros().into()),
            Code::I64Popcnt => set!(u64!(op.a).count_ones().into()),
            Code::I64Add => set!(u64!(op.a).wrapping_add(u64!(op.b))),
            Code::I64Sub => set!(u64!(op.a).wrapping_sub(u64!(op.b))),
            Code::I64Mul => set!(u64!(op.a).wrapping_mul(u64!(op.b))),
            Code::I64DivS => set!(
                divide(u64!(op.a).cast_signed().checked_div(u64!(op.b).cast_signed()), u64!(op.b) == 0)?
                    .cast_unsigned()
            ),
            Code::I64DivU => set!(divide(u64!(op.a).checked_div(u64!(op.b)), true)?),
            Code::I64RemS => set!(
                remainder(u64!(op.b) != 0, u64!(op.a).cast_signed().checked_rem(u64!(op.b).cast_signed()))?
                    .cast_unsigned()
            ),
            Code::I64RemU => set!(divide(u64!(op.a).checked_rem(u64!(op.b)), true)?),
            Code::I64And => set!(u64!(op.a) & u64!(op.b)),
            Code::I64Or => set!(u64!(op.a) | u64!(op.b)),
            Code::I64Xor => set!(u64!(op.a) ^ u64!(op.b)),
            Code::I64Shl => set!(u64!(op.a).wrapping_shl(u64!(op.b) as u32)),
            Code::I64ShrS => set!(u64!(op.a).cast_signed().wrapping_shr(u64!(op.b) as u32).cast_unsigned()),
            Code::I64ShrU => set!(u64!(op.a).wrapping_shr(u64!(op.b) as u32)),
            Code::I64Rotl => set!(u64!(op.a).rotate_left(u64!(op.b) as u32 % u64::BITS)),
            Code::I64Rotr => set!(u64!(op.a).rotate_right(u64!(op.b) as u32 % u64::BITS)),
            Code::F32Eq => set!(u64::from(f32!(op.a) == f32!(op.b))),
            Code::F32Ne => set!(u64::from(f32!(op.a) != f32!(op.b))),
            Code::F32Lt => set!(u64::from(f32!(op.a) < f32!(op.b))),
            Code::F32Gt => set!(u64::from(f32!(op.a) > f32!(op.b))),
            Code::F32Le => set!(u64::from(f32!(op.a) <= f32!(op.b))),
            Code::F32Ge => set!(u64::from(f32!(op.a) >= f32!(op.b))),
            Code::F32Add => set!(result(f32!(op.a) + f32!(op.b))),
            Code::F32Sub => set!(result(f32!(op.a) - f32!(op.b))),
            Code::F32Mul => set!(result(f32!(op.a) * f32!(op.b))),
            Code::F32Div => set!(result(f32!(op.a) / f32!(op.b))),
            Code::F32Ceil => set!(result(f32!(op.a).ceil())),
            Code::F32Floor => set!(result(f32!(op.a).floor())),
            Code::F32Trunc => set!(result(f32!(op.a).trunc())),
            Code::F32Nearest => set!(result(f32!(op.a).round_ties_even())),
            Code::F32Sqrt => set!(result(f32!(op.a).sqrt())),
            Code::F32Abs => set!(f32!(op.a).abs().bits()),
            Code::F32Neg => set!((-f32!(op.a)).bits()),
            Code::F32Copysign => set!(f32!(op.a).copysign(f32!(op.b)).bits()),
            Code::F32Min => set!(min(f32!(op.a), f32!(op.b))),
            Code::F32Max => set!(max(f32!(op.a), f32!(op.b))),
            Code::F64Eq => set!(u64::from(f64!(op.a) == f64!(op.b))),
            Code::F64Ne => set!(u64::from(f64!(op.a) != f64!(op.b))),
            Code::F64Lt => set!(u64::from(f64!(op.a) < f64!(op.b))),
            Code::F64Gt => set!(u64::from(f64!(op.a) > f64!(op.b))),
            Code::F64Le => set!(u64::from(f64!(op.a) <= f64!(op.b))),
            Code::F64Ge => set!(u64::from(f64!(op.a) >= f64!(op.b))),
            Code::F64Add => set!(result(f64!(op.a) + f64!(op.b))),
            Code::F64Sub => set!(result(f64!(op.a) - f64!(op.b))),
            Code::F64Mul => set!(result(f64!(op.a) * f64!(op.b))),
            Code::F64Div => set!(result(f64!(op.a) / f64!(op.b))),
            Code::F64Ceil => set!(result(f64!(op.a).ceil())),
            Code::F64Floor => set!(result(f64!(op.a).floor())),
            Code::F64Trunc => set!(result(f64!(op.a).trunc())),
            Code::F64Nearest => set!(result(f64!(op.a).round_ties_even())),
            Code::F64Sqrt => set!(result(f64!(op.a).sqrt())),
            Code::F64Abs => set!(f64!(op.a).abs().bits()),
            Code::F64Neg => set!((-f64!(op.a)).bits()),
            Code::F64Copysign => set!(f64!(op.a).copysign(f64!(op.b)).bits()),
            Code::F64Min => set!(min(f64!(op.a), f64!(op.b))),
            Code::F64Max => set!(max(f64!(op.a), f64!(op.b))),
            Code::I32TruncF32S => set!(u64::from((truncate(f32!(op.a), I32.0, I32.1)? as i32).cast_unsigned())),
            Code::I32TruncSatF32S => set!(u64::from((f32!(op.a) as i32).cast_unsigned())),
            Code::I32TruncF32U => set!(u64::from(truncate(f32!(op.a), U32.0, U32.1)? as u32)),
            Code::I32TruncSatF32U => set!(u64::from(f32!(op.a) as u32)),
            Code::I32TruncF64S => set!(u64::from((truncate(f64!(op.a), I32.0, I32.1)? as i32).cast_unsigned())),
            Code::I32TruncSatF64S => set!(u64::from((f64!(op.a) as i32).cast_unsigned())),
            Code::I32TruncF64U => set!(u64::from(truncate(f64!(op.a), U32.0, U32.1)? as u32)),
            Code::I32TruncSatF64U => set!(u64::from(f64!(op.a) as u32)),
            Code::I64TruncF32S => set!((truncate(f32!(op.a), I64.0, I64.1)? as i64).cast_unsigned()),
            Code::I64TruncSatF32S => set!((f32!(op.a) as i64).cast_unsigned()),
            Code::I64TruncF32U => set!(truncate(f32!(op.a), U64.0, U64.1)? as u64),
            Code::I64TruncSatF32U => set!(f32!(op.a) as u64),
            Code::I64TruncF64S => set!((truncate(f64!(op.a), I64.0, I64.1)? as i64).cast_unsigned()),
            Code::I64TruncSatF64S => set!((f64!(op.a) as i64).cast_unsigned()),
            Code::I64TruncF64U => set!(truncate(f64!(op.a), U64.0, U64.1)? as u64),
            Code::I64TruncSatF64U => set!(f64!(op.a) as u64),
            Code::F32ConvertI32S => set!((u32!(op.a).cast_signed() as f32).bits()),
            Code::F32ConvertI32U => set!((u32!(op.a) as f32).bits()),
            Code::F64ConvertI32S => set!((u32!(op.a).cast_signed() as f64).bits()),
            Code::F64ConvertI32U => set!((u32!(op.a) as f64).bits()),
            Code::F32ConvertI64S => set!((u64!(op.a).cast_signed() as f32).bits()),
            Code::F32ConvertI64U => set!((u64!(op.a) as f32).bits()),
            Code::F64ConvertI64S => set!((u64!(op.a).cast_signed() as f64).bits()),
            Code::F64ConvertI64U => set!((u64!(op.a) as f64).bits()),
            Code::F32DemoteF64 => set!(result(f64!(op.a) as f32)),
            Code::F64PromoteF32 => set!(result(f64::from(f32!(op.a)))),
            Code::I32WrapI64 => set!(u64::from(u32!(op.a))),
            Code::I64ExtendI32S => set!(i64::from(u32!(op.a).cast_signed()).cast_unsigned()),
            Code::I32Extend8S => set!(u64::from(i32::from(u64!(op.a) as i8).cast_unsigned())),
            Code::I32Extend16S => set!(u64::from(i32::from(u64!(op.a) as i16).cast_unsigned())),
            Code::I64Extend8S => set!(i64::from(u64!(op.a) as i8).cast_unsigned()),
            Code::I64Extend16S => set!(i64::from(u64!(op.a) as i16).cast_unsigned()),
            Code::I64Extend32S => set!(i64::from(u64!(op.a) as i32).cast_unsigned()),
        }
    }
}
