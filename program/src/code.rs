//! Target code of the translation: instructions on the slots of a frame.
//!
//! A frame holds the parameters, the other locals, and then the operands by their depth, 64 bits each. An i32 or f32 is
//! in the low 32 bits, the high ones are 0.

/// One instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Op {
    pub code: Code,
    /// Slots of its operands.
    pub a: u16,
    pub b: u16,
    /// Slot of its result; for some instructions a third operand.
    pub to: u16,
    /// A position in the code, an offset, the number of a function or of a constant, depending on the instruction.
    pub imm: u32,
}

impl Op {
    pub(crate) fn new(code: Code) -> Self {
        Self { code, a: 0, b: 0, to: 0, imm: 0 }
    }
}

/// Operation of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[rustfmt::skip]
pub(crate) enum Code {
    /// Traps.
    Unreachable,
    /// Continues at `imm`.
    Jump,
    /// Continues at `imm` if `a` is 0; if it is not 0.
    JumpIfZero, JumpIfNot,
    /// Continues at one of the `imm` + 1 jumps that follow, the one with number `a`, at most the last.
    JumpBy,
    /// Calls function `imm`, whose parameters and results begin at slot `a`.
    Call,
    /// Calls the function at index `b` of table `to`, with type `imm`, with the slots from `a` on.
    CallBy,
    /// Ends the function; its `imm` results begin at slot `a`.
    Return,
    /// The slot `a`; constant number `imm`; `a` if the slot `imm` is not 0, else `b`.
    Copy, Constant, Select,
    /// Global number `imm`.
    GlobalGet, GlobalSet,
    /// `a` is an address, `imm` the offset; `b` is the value of a store.
    Load8U, Load8S32, Load8S64, Load16U, Load16S32, Load16S64, Load32U, Load32S64, Load64,
    Store8, Store16, Store32, Store64,
    /// Size in pages; memory cannot grow: -1.
    MemorySize, MemoryGrow,
    /// To address `a`, from address `b` or with the byte `b`; the length is in `to`.
    MemoryCopy, MemoryFill,
    I32Eqz, I32Eq, I32Ne, I32LtS, I32LtU, I32GtS, I32GtU, I32LeS, I32LeU, I32GeS, I32GeU,
    I64Eqz, I64Eq, I64Ne, I64LtS, I64LtU, I64GtS, I64GtU, I64LeS, I64LeU, I64GeS, I64GeU,
    F32Eq, F32Ne, F32Lt, F32Gt, F32Le, F32Ge, F64Eq, F64Ne, F64Lt, F64Gt, F64Le, F64Ge,
    I32Clz, I32Ctz, I32Popcnt, I32Add, I32Sub, I32Mul, I32DivS, I32DivU, I32RemS, I32RemU,
    I32And, I32Or, I32Xor, I32Shl, I32ShrS, I32ShrU, I32Rotl, I32Rotr,
    I64Clz, I64Ctz, I64Popcnt, I64Add, I64Sub, I64Mul, I64DivS, I64DivU, I64RemS, I64RemU,
    I64And, I64Or, I64Xor, I64Shl, I64ShrS, I64ShrU, I64Rotl, I64Rotr,
    F32Abs, F32Neg, F32Ceil, F32Floor, F32Trunc, F32Nearest, F32Sqrt, F32Add, F32Sub, F32Mul, F32Div, F32Min, F32Max, F32Copysign,
    F64Abs, F64Neg, F64Ceil, F64Floor, F64Trunc, F64Nearest, F64Sqrt, F64Add, F64Sub, F64Mul, F64Div, F64Min, F64Max, F64Copysign,
    I32WrapI64, I32TruncF32S, I32TruncF32U, I32TruncF64S, I32TruncF64U,
    I64ExtendI32S, I64TruncF32S, I64TruncF32U, I64TruncF64S, I64TruncF64U,
    F32ConvertI32S, F32ConvertI32U, F32ConvertI64S, F32ConvertI64U, F32DemoteF64,
    F64ConvertI32S, F64ConvertI32U, F64ConvertI64S, F64ConvertI64U, F64PromoteF32,
    I32Extend8S, I32Extend16S, I64Extend8S, I64Extend16S, I64Extend32S,
    I32TruncSatF32S, I32TruncSatF32U, I32TruncSatF64S, I32TruncSatF64U,
    I64TruncSatF32S, I64TruncSatF32U, I64TruncSatF64S, I64TruncSatF64U,
}

/// A function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Function {
    /// Number of its type; equal types have the same number.
    pub kind: u32,
    pub parameters: u16,
    pub results: u16,
    /// Number of locals, including the parameters.
    pub locals: u16,
    /// Number of slots in its frame.
    pub slots: u16,
    /// Start of its code.
    pub entry: u32,
}
