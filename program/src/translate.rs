//! Translation of function bodies to instructions on slots.
//!
//! WebAssembly pushes and pops operands; their number is known at each position, so each operand has a slot of its
//! frame. Pushing a local or a constant needs no instruction: the instruction that pops it reads it directly, and it is
//! copied to its slot only where branches join.

use crate::code::{Code, Function, Op};
use crate::module::{Global, Refused, refuse};
use wasmparser::{BlockType, FuncType, FunctionBody, MemArg, Operator, ValType};

/// Maximum slots of a frame.
const MOST_SLOTS: usize = 4096;
/// Maximum instructions of a module.
const MOST_OPS: usize = 1 << 20;

/// Items that a body refers to.
pub(crate) struct ModuleItems<'a> {
    pub kinds: &'a [FuncType],
    pub canonical: &'a [u32],
    pub functions: &'a [u32],
    pub globals: &'a [Global],
}

/// Result of the translation so far.
#[derive(Default)]
pub(crate) struct Translated {
    pub ops: Vec<Op>,
    pub constants: Vec<u64>,
}

/// Location of an operand.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operand {
    /// In the slot of its depth.
    Slot,
    Local(u16),
    Constant(u64),
}

/// An open block.
struct Open {
    is_loop: bool,
    /// Number of operands below it.
    height: usize,
    parameters: usize,
    results: usize,
    /// Beginning of a loop.
    begin: usize,
    /// Instructions that jump to its end.
    to_end: Vec<usize>,
    /// Instruction that jumps to its `else`.
    to_else: Option<usize>,
}

impl Open {
    /// Returns the number of operands that a branch to it keeps.
    fn arity(&self) -> usize {
        if self.is_loop { self.parameters } else { self.results }
    }
}

/// State of the translation of one body.
struct Body<'a> {
    to: &'a mut Translated,
    known: &'a ModuleItems<'a>,
    locals: usize,
    operands: Vec<Operand>,
    open: Vec<Open>,
    most: usize,
    /// Number of blocks that were opened in unreachable code.
    dead: Option<usize>,
    /// Position of the last join: instructions before it must not be changed.
    label: usize,
}

impl Translated {
    /// Translates a valid body.
    pub(crate) fn function(
        &mut self,
        body: &FunctionBody<'_>,
        kind: u32,
        known: &ModuleItems<'_>,
    ) -> Result<Function, Refused> {
        let Some(signature) = known.kinds.get(kind as usize) else { return refuse("its type is unknown") };
        let (parameters, results) = (signature.params().len(), signature.results().len());
        let mut locals = parameters;
        for group in body.get_locals_reader()? {
            let (count, kind) = group?;
            if matches!(kind, ValType::Ref(_)) {
                return refuse("it has references as locals, which no program may use");
            }
            locals = locals.saturating_add(count as usize);
        }
        if locals > MOST_SLOTS {
            return refuse(format!("it has {locals} locals; at most {MOST_SLOTS} are possible"));
        }
        let entry = self.ops.len();
        let whole =
            Open { is_loop: false, height: 0, parameters: 0, results, begin: entry, to_end: Vec::new(), to_else: None };
        let mut translation = Body {
            to: self,
            known,
            locals,
            operands: Vec::new(),
            open: vec![whole],
            most: 0,
            dead: None,
            label: entry,
        };
        let mut operators = body.get_operators_reader()?;
        while !operators.eof() {
            let offset = operators.original_position();
            translation.operator(operators.read()?).map_err(|refused| Refused(format!("{refused} (byte {offset})")))?;
        }
        let slots = (locals + translation.most).max(results);
        if slots > MOST_SLOTS {
            return refuse(format!(
                "it needs {slots} slots for locals and operands; at most {MOST_SLOTS} are possible"
            ));
        }
        if self.ops.len() > MOST_OPS {
            return refuse(format!("the module has more than {MOST_OPS} instructions up to here"));
        }
        // All of them are at most MOST_SLOTS, and code is at most MOST_OPS.
        let (parameters, results) = (parameters as u16, results as u16);
        let (locals, slots) = (locals as u16, slots as u16);
        let kind = known.canonical.get(kind as usize).copied().unwrap_or_default();
        Ok(Function { kind, parameters, results, locals, slots, entry: entry as u32 })
    }
}

impl Body<'_> {
    /// Returns the slot of the operand at that depth, from the bottom. Too large depths are rejected after the body.
    fn slot(&self, depth: usize) -> u16 {
        u16::try_from(self.locals + depth).unwrap_or(u16::MAX)
    }

    fn emit(&mut self, op: Op) -> Result<usize, Refused> {
        if self.to.ops.len() > MOST_OPS {
            return refuse(format!("the module has more than {MOST_OPS} instructions up to here"));
        }
        self.to.ops.push(op);
        Ok(self.to.ops.len() - 1)
    }

    fn push(&mut self, operand: Operand) {
        self.operands.push(operand);
        self.most = self.most.max(self.operands.len());
    }

    /// Returns the index of a constant of the module.
    fn constant(&mut self, value: u64) -> u32 {
        // Only the last ones are searched: a search of all would make loading of a long module slow.
        let from = self.to.constants.len().saturating_sub(64);
        let found = self.to.constants.get(from..).and_then(|last| last.iter().position(|known| *known == value));
        let place = found.map_or(self.to.constants.len(), |place| from + place);
        if found.is_none() {
            self.to.constants.push(value);
        }
        place as u32
    }

    /// Copies the operand at that depth to its slot.
    fn store_to_slot(&mut self, depth: usize) -> Result<(), Refused> {
        let to = self.slot(depth);
        match self.operands.get_mut(depth).map(|operand| std::mem::replace(operand, Operand::Slot)) {
            Some(Operand::Local(a)) => drop(self.emit(Op { a, to, ..Op::new(Code::Copy) })?),
            Some(Operand::Constant(value)) => {
                let imm = self.constant(value);
                self.emit(Op { to, imm, ..Op::new(Code::Constant) })?;
            }
            Some(Operand::Slot) | None => {}
        }
        Ok(())
    }

    /// Copies the topmost operands to their slots.
    fn store_top_to_slots(&mut self, count: usize) -> Result<(), Refused> {
        let height = self.operands.len();
        (height.saturating_sub(count)..height).try_for_each(|depth| self.store_to_slot(depth))
    }

    /// Returns the number of operands, from the bottom, that are in their slots: those below the innermost block.
    fn settled(&self) -> usize {
        self.open.last().map_or(0, |block| block.height)
    }

    fn settle_all(&mut self) -> Result<(), Refused> {
        (self.settled()..self.operands.len()).try_for_each(|depth| self.store_to_slot(depth))
    }

    /// Pops the topmost operand. Returns the slot from which it can be read.
    fn pop(&mut self) -> Result<u16, Refused> {
        let depth = self.operands.len().saturating_sub(1);
        if let Some(Operand::Constant(_)) = self.operands.last() {
            self.store_to_slot(depth)?;
        }
        match self.operands.pop() {
            Some(Operand::Local(local)) => Ok(local),
            Some(_) => Ok(self.slot(depth)),
            None => refuse("an operand is missing"),
        }
    }

    /// Pushes a result. Returns its slot.
    fn result(&mut self) -> u16 {
        self.push(Operand::Slot);
        self.slot(self.operands.len() - 1)
    }

    /// Emits an instruction with that number of operands and one result.
    fn calculate(&mut self, code: Code, operands: usize) -> Result<(), Refused> {
        let b = if operands == 2 { self.pop()? } else { 0 };
        let a = self.pop()?;
        let to = self.result();
        self.emit(Op { a, b, to, ..Op::new(code) })?;
        Ok(())
    }

    fn load(&mut self, code: Code, of: &MemArg) -> Result<(), Refused> {
        let a = self.pop()?;
        let to = self.result();
        // Memory has 32-bit addresses: the validator rejects longer offsets.
        self.emit(Op { a, to, imm: of.offset as u32, ..Op::new(code) })?;
        Ok(())
    }

    fn store(&mut self, code: Code, of: &MemArg) -> Result<(), Refused> {
        let (b, a) = (self.pop()?, self.pop()?);
        self.emit(Op { a, b, imm: of.offset as u32, ..Op::new(code) })?;
        Ok(())
    }

    /// Sets a local to the topmost operand.
    fn set(&mut self, local: u16) -> Result<(), Refused> {
        for depth in self.settled()..self.operands.len().saturating_sub(1) {
            if self.operands.get(depth) == Some(&Operand::Local(local)) {
                self.store_to_slot(depth)?;
            }
        }
        let depth = self.operands.len().saturating_sub(1);
        let (is_slot, slot) = (self.operands.last() == Some(&Operand::Slot), self.slot(depth));
        let is_open = self.label < self.to.ops.len();
        if let Some(last) = self.to.ops.last_mut()
            && is_slot
            && is_open
            && last.to == slot
            && writes(last.code)
        {
            // The result of the last instruction is written to the local directly.
            last.to = local;
            self.operands.pop();
            return Ok(());
        }
        if let Some(Operand::Constant(value)) = self.operands.last().copied() {
            self.operands.pop();
            let imm = self.constant(value);
            self.emit(Op { to: local, imm, ..Op::new(Code::Constant) })?;
            return Ok(());
        }
        let a = self.pop()?;
        if a != local {
            self.emit(Op { a, to: local, ..Op::new(Code::Copy) })?;
        }
        Ok(())
    }

    /// Marks a position at which branches join.
    fn mark_join(&mut self) -> usize {
        self.label = self.to.ops.len();
        self.label
    }

    fn aim(&mut self, from: &[usize], at: usize) {
        for from in from {
            if let Some(op) = self.to.ops.get_mut(*from) {
                // Code is at most MOST_OPS long.
                op.imm = at as u32;
            }
        }
    }

    fn signature(&self, kind: BlockType) -> Result<(usize, usize), Refused> {
        Ok(match kind {
            BlockType::Empty => (0, 0),
            BlockType::Type(_) => (0, 1),
            BlockType::FuncType(kind) => match self.known.kinds.get(kind as usize) {
                Some(kind) => (kind.params().len(), kind.results().len()),
                None => return refuse("a block of it has no type"),
            },
        })
    }

    fn begin(&mut self, kind: BlockType, is_loop: bool, to_else: Option<usize>) -> Result<(), Refused> {
        let (parameters, results) = self.signature(kind)?;
        let height = self.operands.len().saturating_sub(parameters);
        let begin = if is_loop { self.mark_join() } else { self.to.ops.len() };
        self.open.push(Open { is_loop, height, parameters, results, begin, to_end: Vec::new(), to_else });
        Ok(())
    }

    /// Sets the operands to those at a join.
    fn set_operands_at_join(&mut self, height: usize) {
        self.operands.truncate(height);
        while self.operands.len() < height {
            self.push(Operand::Slot);
        }
        let settled = self.settled();
        self.operands.iter_mut().skip(settled).for_each(|operand| *operand = Operand::Slot);
    }

    fn end(&mut self) -> Result<(), Refused> {
        let is_dead = self.dead.take().is_some();
        let Some(block) = self.open.pop() else { return refuse("it ends once too often") };
        if !is_dead {
            self.store_top_to_slots(block.results)?;
        }
        let at = self.mark_join();
        self.aim(&block.to_end, at);
        self.aim(block.to_else.as_slice(), at);
        self.set_operands_at_join(block.height + block.results);
        if self.open.is_empty() {
            self.emit(Op { a: self.slot(0), imm: block.results as u32, ..Op::new(Code::Return) })?;
        }
        Ok(())
    }

    fn otherwise(&mut self) -> Result<(), Refused> {
        let is_dead = self.dead.take().is_some();
        let results = self.open.last().map_or(0, |block| block.results);
        if !is_dead {
            self.store_top_to_slots(results)?;
            let jump = self.emit(Op::new(Code::Jump))?;
            if let Some(block) = self.open.last_mut() {
                block.to_end.push(jump);
            }
        }
        let at = self.mark_join();
        let to_else = self.open.last_mut().and_then(|block| block.to_else.take());
        self.aim(to_else.as_slice(), at);
        let height = self.open.last().map_or(0, |block| block.height + block.parameters);
        self.set_operands_at_join(height);
        Ok(())
    }

    /// Returns the block of a branch, and arity and lowest depth of the operands that it keeps.
    fn target(&self, depth: u32) -> Result<(usize, usize, usize), Refused> {
        let place = self.open.len().checked_sub(1 + depth as usize);
        match place.and_then(|place| self.open.get(place).map(|block| (place, block))) {
            Some((place, block)) => Ok((place, block.arity(), block.height)),
            None => refuse("it branches to no block"),
        }
    }

    /// Jumps to a block; the kept operands are in their slots.
    fn jump(&mut self, depth: u32) -> Result<(), Refused> {
        let (place, arity, height) = self.target(depth)?;
        let from = self.operands.len().saturating_sub(arity);
        if from != height {
            for nth in 0..arity {
                let (a, to) = (self.slot(from + nth), self.slot(height + nth));
                self.emit(Op { a, to, ..Op::new(Code::Copy) })?;
            }
        }
        self.jump_by(place, Op::new(Code::Jump))
    }

    /// Jumps to a block with that instruction.
    fn jump_by(&mut self, place: usize, op: Op) -> Result<(), Refused> {
        let at = self.emit(op)?;
        if let Some(block) = self.open.get_mut(place) {
            if block.is_loop {
                let begin = block.begin;
                self.aim(&[at], begin);
            } else {
                block.to_end.push(at);
            }
        }
        Ok(())
    }

    fn branch_if(&mut self, depth: u32) -> Result<(), Refused> {
        let a = self.pop()?;
        let (place, arity, height) = self.target(depth)?;
        self.store_top_to_slots(arity)?;
        if arity == 0 || self.operands.len() - arity == height {
            return self.jump_by(place, Op { a, ..Op::new(Code::JumpIfNot) });
        }
        let past = self.emit(Op { a, ..Op::new(Code::JumpIfZero) })?;
        self.jump(depth)?;
        let at = self.mark_join();
        self.aim(&[past], at);
        Ok(())
    }

    fn branch_by(&mut self, targets: &wasmparser::BrTable<'_>) -> Result<(), Refused> {
        let a = self.pop()?;
        let (_, arity, _) = self.target(targets.default())?;
        self.store_top_to_slots(arity)?;
        let mut depths = targets.targets().collect::<Result<Vec<_>, _>>()?;
        depths.push(targets.default());
        let first = self.emit(Op { a, imm: targets.len(), ..Op::new(Code::JumpBy) })? + 1;
        for _ in &depths {
            self.emit(Op::new(Code::Jump))?;
        }
        for (nth, depth) in depths.into_iter().enumerate() {
            let at = self.mark_join();
            self.aim(&[first + nth], at);
            self.jump(depth)?;
        }
        self.dead = Some(0);
        Ok(())
    }

    /// Emits a call with the topmost operands as parameters; `b` and `to` depend on the instruction.
    fn call(&mut self, kind: u32, op: Op) -> Result<(), Refused> {
        let Some(signature) = self.known.kinds.get(kind as usize) else { return refuse("it calls what has no type") };
        let (parameters, results) = (signature.params().len(), signature.results().len());
        self.store_top_to_slots(parameters)?;
        let base = self.operands.len().saturating_sub(parameters);
        self.operands.truncate(base);
        self.emit(Op { a: self.slot(base), ..op })?;
        for _ in 0..results {
            self.push(Operand::Slot);
        }
        Ok(())
    }

    fn give_back(&mut self) -> Result<(), Refused> {
        let results = self.open.first().map_or(0, |whole| whole.results);
        self.store_top_to_slots(results)?;
        let from = self.operands.len().saturating_sub(results);
        self.emit(Op { a: self.slot(from), imm: results as u32, ..Op::new(Code::Return) })?;
        self.dead = Some(0);
        Ok(())
    }

    /// Returns true if an operator is in unreachable code, which is omitted.
    fn is_omitted(&mut self, operator: &Operator<'_>) -> bool {
        let Some(depth) = self.dead.as_mut() else { return false };
        match operator {
            Operator::Block { .. } | Operator::Loop { .. } | Operator::If { .. } => *depth += 1,
            Operator::End if *depth > 0 => *depth -= 1,
            Operator::Else if *depth > 0 => {}
            Operator::End | Operator::Else => return false,
            _ => {}
        }
        true
    }

    fn operator(&mut self, operator: Operator<'_>) -> Result<(), Refused> {
        use Operator as O;
        if self.is_omitted(&operator) {
            return Ok(());
        }
        match operator {
            O::Nop => {}
            O::Unreachable => {
                self.emit(Op::new(Code::Unreachable))?;
                self.dead = Some(0);
            }
            O::Block { blockty } => {
                self.settle_all()?;
                self.begin(blockty, false, None)?;
            }
            O::Loop { blockty } => {
                self.settle_all()?;
                self.begin(blockty, true, None)?;
            }
            O::If { blockty } => {
                let a = self.pop()?;
                self.settle_all()?;
                let to_else = self.emit(Op { a, ..Op::new(Code::JumpIfZero) })?;
                self.begin(blockty, false, Some(to_else))?;
            }
            O::Else => self.otherwise()?,
            O::End => self.end()?,
            O::Br { relative_depth } => {
                let (_, arity, _) = self.target(relative_depth)?;
                self.store_top_to_slots(arity)?;
                self.jump(relative_depth)?;
                self.dead = Some(0);
            }
            O::BrIf { relative_depth } => self.branch_if(relative_depth)?,
            O::BrTable { targets } => self.branch_by(&targets)?,
            O::Return => self.give_back()?,
            O::Call { function_index } => {
                let kind = self.known.functions.get(function_index as usize).copied().unwrap_or(u32::MAX);
                self.call(kind, Op { imm: function_index, ..Op::new(Code::Call) })?;
            }
            O::CallIndirect { type_index, table_index } => {
                let b = self.pop()?;
                let imm = self.known.canonical.get(type_index as usize).copied().unwrap_or(u32::MAX);
                let Ok(to) = u16::try_from(table_index) else { return refuse("it has more than 65536 tables") };
                self.call(type_index, Op { b, to, imm, ..Op::new(Code::CallBy) })?;
            }
            O::Drop => drop(self.operands.pop()),
            O::Select | O::TypedSelect { .. } => {
                let (condition, b, a) = (self.pop()?, self.pop()?, self.pop()?);
                let to = self.result();
                self.emit(Op { a, b, to, imm: condition.into(), code: Code::Select })?;
            }
            // There are fewer locals than MOST_SLOTS.
            O::LocalGet { local_index } => self.push(Operand::Local(local_index as u16)),
            O::LocalSet { local_index } => self.set(local_index as u16)?,
            O::LocalTee { local_index } => {
                self.set(local_index as u16)?;
                self.push(Operand::Local(local_index as u16));
            }
            O::GlobalGet { global_index } => match self.known.globals.get(global_index as usize) {
                Some(Global::Constant(value)) => self.push(Operand::Constant(*value)),
                Some(Global::Variable(imm)) => {
                    let (imm, to) = (*imm, self.result());
                    self.emit(Op { to, imm, ..Op::new(Code::GlobalGet) })?;
                }
                None => return refuse("it reads a global that it has not"),
            },
            O::GlobalSet { global_index } => {
                let a = self.pop()?;
                let Some(Global::Variable(imm)) = self.known.globals.get(global_index as usize).copied() else {
                    return refuse("it writes a global that does not change");
                };
                self.emit(Op { a, imm, ..Op::new(Code::GlobalSet) })?;
            }
            O::I32Const { value } => self.push(Operand::Constant(value.cast_unsigned().into())),
            O::I64Const { value } => self.push(Operand::Constant(value.cast_unsigned())),
            O::F32Const { value } => self.push(Operand::Constant(value.bits().into())),
            O::F64Const { value } => self.push(Operand::Constant(value.bits())),
            O::MemorySize { .. } => {
                let to = self.result();
                self.emit(Op { to, ..Op::new(Code::MemorySize) })?;
            }
            O::MemoryGrow { .. } => self.calculate(Code::MemoryGrow, 1)?,
            O::MemoryCopy { .. } => self.move_memory(Code::MemoryCopy)?,
            O::MemoryFill { .. } => self.move_memory(Code::MemoryFill)?,
            other => return self.number(&other),
        }
        Ok(())
    }

    fn move_memory(&mut self, code: Code) -> Result<(), Refused> {
        let (to, b, a) = (self.pop()?, self.pop()?, self.pop()?);
        self.emit(Op { a, b, to, ..Op::new(code) })?;
        Ok(())
    }

    /// Translates loads, stores and calculations.
    fn number(&mut self, operator: &Operator<'_>) -> Result<(), Refused> {
        if let Some((code, memarg)) = loads(operator) {
            return self.load(code, memarg);
        }
        if let Some((code, memarg)) = stores(operator) {
            return self.store(code, memarg);
        }
        match calculation(operator) {
            // A slot holds 32 bits with zeros above them, and the bits of a float: no instruction is needed.
            Some((Code::Copy, _)) => Ok(()),
            Some((code, operands)) => self.calculate(code, operands),
            None => refuse(format!("it uses {}, which no program may use", name(operator))),
        }
    }
}

/// Returns the name of an operator without its arguments.
fn name(operator: &Operator<'_>) -> String {
    format!("{operator:?}").chars().take_while(|sign| sign.is_alphanumeric()).collect()
}

/// Returns true if its result is in `to`.
fn writes(code: Code) -> bool {
    !matches!(
        code,
        Code::Unreachable
            | Code::Jump
            | Code::JumpIfZero
            | Code::JumpIfNot
            | Code::JumpBy
            | Code::Call
            | Code::CallBy
            | Code::Return
            | Code::GlobalSet
            | Code::Store8
            | Code::Store16
            | Code::Store32
            | Code::Store64
            | Code::MemoryCopy
            | Code::MemoryFill
    )
}

fn loads<'m>(operator: &'m Operator<'_>) -> Option<(Code, &'m MemArg)> {
    use Operator as O;
    Some(match operator {
        O::I32Load { memarg } | O::F32Load { memarg } | O::I64Load32U { memarg } => (Code::Load32U, memarg),
        O::I64Load { memarg } | O::F64Load { memarg } => (Code::Load64, memarg),
        O::I32Load8U { memarg } | O::I64Load8U { memarg } => (Code::Load8U, memarg),
        O::I32Load16U { memarg } | O::I64Load16U { memarg } => (Code::Load16U, memarg),
        O::I32Load8S { memarg } => (Code::Load8S32, memarg),
        O::I64Load8S { memarg } => (Code::Load8S64, memarg),
        O::I32Load16S { memarg } => (Code::Load16S32, memarg),
        O::I64Load16S { memarg } => (Code::Load16S64, memarg),
        O::I64Load32S { memarg } => (Code::Load32S64, memarg),
        _ => return None,
    })
}

fn stores<'m>(operator: &'m Operator<'_>) -> Option<(Code, &'m MemArg)> {
    use Operator as O;
    Some(match operator {
        O::I32Store8 { memarg } | O::I64Store8 { memarg } => (Code::Store8, memarg),
        O::I32Store16 { memarg } | O::I64Store16 { memarg } => (Code::Store16, memarg),
        O::I32Store { memarg } | O::F32Store { memarg } | O::I64Store32 { memarg } => (Code::Store32, memarg),
        O::I64Store { memarg } | O::F64Store { memarg } => (Code::Store64, memarg),
        _ => return None,
    })
}

/// Maps operators to instructions of the same name.
macro_rules! same_names {
    ($operator:expr, one: [$($one:ident)*], two: [$($two:ident)*]) => {
        match $operator {
            $(Operator::$one => Some((Code::$one, 1)),)*
            $(Operator::$two => Some((Code::$two, 2)),)*
            _ => None,
        }
    };
}

/// Returns an instruction and its number of operands.
#[rustfmt::skip]
fn calculation(operator: &Operator<'_>) -> Option<(Code, usize)> {
    match operator {
        Operator::I64ExtendI32U | Operator::I32ReinterpretF32 | Operator::F32ReinterpretI32
        | Operator::I64ReinterpretF64 | Operator::F64ReinterpretI64 => return Some((Code::Copy, 1)),
        _ => {}
    }
    same_names!(operator,
        one: [I32Eqz I64Eqz I32Clz I32Ctz I32Popcnt I64Clz I64Ctz I64Popcnt
            F32Abs F32Neg F32Ceil F32Floor F32Trunc F32Nearest F32Sqrt F64Abs F64Neg F64Ceil F64Floor F64Trunc F64Nearest F64Sqrt
            I32WrapI64 I32TruncF32S I32TruncF32U I32TruncF64S I32TruncF64U
            I64ExtendI32S I64TruncF32S I64TruncF32U I64TruncF64S I64TruncF64U
            F32ConvertI32S F32ConvertI32U F32ConvertI64S F32ConvertI64U F32DemoteF64
            F64ConvertI32S F64ConvertI32U F64ConvertI64S F64ConvertI64U F64PromoteF32
            I32Extend8S I32Extend16S I64Extend8S I64Extend16S I64Extend32S
            I32TruncSatF32S I32TruncSatF32U I32TruncSatF64S I32TruncSatF64U
            I64TruncSatF32S I64TruncSatF32U I64TruncSatF64S I64TruncSatF64U],
        two: [I32Eq I32Ne I32LtS I32LtU I32GtS I32GtU I32LeS I32LeU I32GeS I32GeU
            I64Eq I64Ne I64LtS I64LtU I64GtS I64GtU I64LeS I64LeU I64GeS I64GeU
            F32Eq F32Ne F32Lt F32Gt F32Le F32Ge F64Eq F64Ne F64Lt F64Gt F64Le F64Ge
            I32Add I32Sub I32Mul I32DivS I32DivU I32RemS I32RemU I32And I32Or I32Xor I32Shl I32ShrS I32ShrU I32Rotl I32Rotr
            I64Add I64Sub I64Mul I64DivS I64DivU I64RemS I64RemU I64And I64Or I64Xor I64Shl I64ShrS I64ShrU I64Rotl I64Rotr
            F32Add F32Sub F32Mul F32Div F32Min F32Max F32Copysign F64Add F64Sub F64Mul F64Div F64Min F64Max F64Copysign]
    )
}
