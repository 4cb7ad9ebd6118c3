//! Module of a user: loading and checks.
//!
//! Law      a loaded module is valid WebAssembly whose every instruction is bounded in time and memory
//! Refuses  imports, a start function, threads, vectors, tables that change, no memory or one that is too large, bytes
//!          that are no module

use crate::code::{Function, Op};
use crate::image;
use crate::translate::{self, Translated};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::ops::Range;
use wasmparser::{
    BinaryReaderError, ConstExpr, Data, DataKind, Element, ElementItems, ElementKind, ExternalKind, FuncType,
    FuncValidator, FunctionBody, Operator, Parser, Payload, ValType, ValidPayload, Validator, ValidatorResources,
    WasmFeatures,
};

/// Name of the function that each cycle calls.
pub const ENTRY: &str = "cycle";
/// Name of the constant with the address of the image.
pub const IMAGE: &str = "image";
/// Size of a page of memory (bytes).
pub const PAGE: usize = 65_536;
/// Maximum pages of memory.
pub const MOST_PAGES: usize = 16;
/// Maximum size of a module (bytes).
pub const MOST_BYTES: usize = 1 << 20;
/// Maximum variable globals.
pub const MOST_GLOBALS: usize = 256;
/// Maximum operands of a function at the same time.
const MOST_OPERANDS: u32 = 1024;
/// Maximum tables.
const MOST_TABLES: usize = 16;
/// Maximum entries of all tables.
const MOST_ENTRIES: usize = 65_536;
/// Maximum characters of an external text in a message.
const MOST_TEXT: usize = 100;
/// Maximum constant globals.
const MOST_CONSTANTS: usize = 65_536;

/// Permitted features of WebAssembly: those that compilers use by default, and whose results are the same on every
/// machine.
const FEATURES: WasmFeatures = WasmFeatures::MUTABLE_GLOBAL
    .union(WasmFeatures::SIGN_EXTENSION)
    .union(WasmFeatures::SATURATING_FLOAT_TO_INT)
    .union(WasmFeatures::MULTI_VALUE)
    .union(WasmFeatures::BULK_MEMORY)
    // With this feature an index of a table may be longer than a byte, which compilers use.
    .union(WasmFeatures::REFERENCE_TYPES)
    .union(WasmFeatures::FLOATS)
    .union(WasmFeatures::GC_TYPES);

/// Reason why a module is rejected: one sentence without a full stop.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

impl From<BinaryReaderError> for Refused {
    fn from(error: BinaryReaderError) -> Self {
        // A message may contain a name of the module.
        let message: String = error.message().chars().take(MOST_TEXT).collect();
        Self(format!("it is no valid WebAssembly of this version at byte {}: {message}", error.offset()))
    }
}

/// Returns the beginning of a name.
fn shorten(name: &str) -> String {
    name.chars().take(MOST_TEXT).collect()
}

pub(crate) fn refuse<T>(sentence: impl Into<String>) -> Result<T, Refused> {
    Err(Refused(sentence.into()))
}

/// A global.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Global {
    /// A constant, with its bits.
    Constant(u64),
    /// Index among the variable globals.
    Variable(u32),
}

/// Exports of a module, by name.
pub(crate) type Exports = BTreeMap<String, (ExternalKind, u32)>;

/// A module that can be executed.
#[derive(Clone, Debug)]
pub struct Module {
    bytes: Box<[u8]>,
    pub(crate) ops: Vec<Op>,
    pub(crate) constants: Vec<u64>,
    pub(crate) functions: Vec<Function>,
    pub(crate) tables: Vec<Vec<Option<u32>>>,
    /// Initial values of variable globals, and whether they have 64 bits.
    pub(crate) globals: Vec<(u64, bool)>,
    places: Vec<Global>,
    pub(crate) pages: usize,
    data: Vec<(usize, Box<[u8]>)>,
    pub(crate) entry: u32,
    pub(crate) image: Range<usize>,
}

impl PartialEq for Module {
    fn eq(&self, other: &Self) -> bool {
        self.bytes == other.bytes
    }
}

/// State of loading a module.
#[derive(Default)]
struct ModuleLoader {
    kinds: Vec<FuncType>,
    /// First type of each group of equal types.
    known: BTreeMap<FuncType, u32>,
    /// For each type, the first one that equals it.
    canonical: Vec<u32>,
    functions: Vec<u32>,
    tables: Vec<Vec<Option<u32>>>,
    places: Vec<Global>,
    globals: Vec<(u64, bool)>,
    pages: Option<usize>,
    data: Vec<(usize, Box<[u8]>)>,
    exports: Exports,
    translated: Translated,
    bodies: Vec<Function>,
}

impl Module {
    /// Checks and translates a module.
    ///
    /// # Errors
    /// The reason why it is rejected.
    pub fn load(bytes: &[u8]) -> Result<Self, Refused> {
        if bytes.len() > MOST_BYTES {
            return refuse(format!("it has {} bytes; at most {MOST_BYTES} are possible", bytes.len()));
        }
        if !bytes.starts_with(b"\0asm") {
            return refuse("it is no WebAssembly: its first four bytes are others than \\0asm");
        }
        refuse_by_name(bytes)?;
        let (mut module, exports) = Self::read(bytes)?;
        module.find_entry(&exports)?;
        module.find_image(&exports)?;
        Ok(module)
    }

    /// Returns a valid module without an entry and an image, and its exports.
    pub(crate) fn read(bytes: &[u8]) -> Result<(Self, Exports), Refused> {
        let mut validator = Validator::new_with_features(FEATURES);
        let mut reading = ModuleLoader::default();
        for payload in Parser::new(0).parse_all(bytes) {
            let payload = payload?;
            if let ValidPayload::Func(function, body) = validator.payload(&payload)? {
                check_body(&mut function.into_validator(Default::default()), &body)?;
            }
            reading.take(payload)?;
        }
        let module = Self {
            bytes: bytes.into(),
            ops: reading.translated.ops,
            constants: reading.translated.constants,
            functions: reading.bodies,
            tables: reading.tables,
            globals: reading.globals,
            places: reading.places,
            pages: reading.pages.unwrap_or(0),
            data: reading.data,
            entry: 0,
            image: 0..0,
        };
        Ok((module, reading.exports))
    }

    fn find_entry(&mut self, exports: &Exports) -> Result<(), Refused> {
        self.entry = match exports.get(ENTRY) {
            Some((ExternalKind::Func, number)) => *number,
            Some(_) => return refuse(format!("its export `{ENTRY}` is no function")),
            None => return refuse(format!("it exports no function `{ENTRY}`")),
        };
        let function = self.functions.get(self.entry as usize);
        if function.is_none_or(|function| function.parameters > 0 || function.results > 0) {
            return refuse(format!("its function `{ENTRY}` has parameters or results; it takes and gives none"));
        }
        Ok(())
    }

    fn find_image(&mut self, exports: &Exports) -> Result<(), Refused> {
        if self.pages == 0 {
            return refuse("it has no memory of its own, where its image would be");
        }
        let at = match exports.get(IMAGE) {
            Some((ExternalKind::Global, number)) => match self.places.get(*number as usize) {
                Some(Global::Constant(at)) => usize::try_from(*at).unwrap_or(usize::MAX),
                _ => return refuse(format!("its export `{IMAGE}` is no constant")),
            },
            Some(_) => return refuse(format!("its export `{IMAGE}` is no address of data")),
            None => return refuse(format!("it exports no `{IMAGE}`, the address of its image")),
        };
        let mut memory = vec![0; self.pages * PAGE];
        self.fill(&mut memory);
        self.image = image::find(&memory, at)?;
        Ok(())
    }

    /// Returns the bytes from which it was loaded.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the pages of its memory.
    pub fn pages(&self) -> usize {
        self.pages
    }

    /// Returns the range of its image in its memory.
    pub fn image(&self) -> Range<usize> {
        self.image.clone()
    }

    /// Returns the number of translated instructions.
    pub fn instructions(&self) -> usize {
        self.ops.len()
    }

    /// Initializes the memory; `memory` must have the size of its pages.
    pub(crate) fn fill(&self, memory: &mut [u8]) {
        memory.fill(0);
        for (at, bytes) in &self.data {
            if let Some(to) = memory.get_mut(*at..*at + bytes.len()) {
                to.copy_from_slice(bytes);
            }
        }
    }
}

/// Validates a body, and rejects too many operands before their memory is allocated.
fn check_body(validator: &mut FuncValidator<ValidatorResources>, body: &FunctionBody<'_>) -> Result<(), Refused> {
    let mut reader = body.get_binary_reader();
    validator.read_locals(&mut reader)?;
    while !reader.eof() {
        let offset = reader.original_position();
        reader.visit_operator(&mut validator.visitor(offset))??;
        if validator.operand_stack_height() > MOST_OPERANDS {
            let number = validator.index();
            return refuse(format!("function {number} has more than {MOST_OPERANDS} operands at once (byte {offset})"));
        }
    }
    Ok(reader.finish_expression(&validator.visitor(reader.original_position()))?)
}

/// Rejects features that users are likely to try, by their names; the validator would only report the number of a byte.
fn refuse_by_name(bytes: &[u8]) -> Result<(), Refused> {
    for payload in Parser::new(0).parse_all(bytes) {
        match payload? {
            Payload::Version { encoding, .. } if encoding != wasmparser::Encoding::Module => {
                return refuse("it is a component; a core module is needed");
            }
            Payload::ImportSection(section) => {
                if let Some(import) = section.into_imports().next() {
                    let import = import?;
                    return refuse(format!(
                        "it imports `{}` of `{}`; a program has no imports: no timers, no calls, no stop of the machine",
                        shorten(import.name),
                        shorten(import.module)
                    ));
                }
            }
            Payload::StartSection { .. } => {
                return refuse("it has a start function; a program begins in `cycle`, with command 1");
            }
            Payload::TagSection(_) => return refuse("it has exceptions, which no program may use"),
            _ => {}
        }
    }
    Ok(())
}

impl ModuleLoader {
    fn take(&mut self, payload: Payload<'_>) -> Result<(), Refused> {
        match payload {
            Payload::TypeSection(section) => {
                for kind in section.into_iter_err_on_gc_types() {
                    let kind = kind?;
                    // A module has fewer than 2^32 of each item: the validator checks that.
                    let place = self.kinds.len() as u32;
                    self.canonical.push(*self.known.entry(kind.clone()).or_insert(place));
                    self.kinds.push(kind);
                }
            }
            Payload::FunctionSection(section) => {
                for kind in section {
                    self.functions.push(kind?);
                }
            }
            Payload::TableSection(section) => {
                for table in section {
                    let table = table?;
                    if !matches!(table.init, wasmparser::TableInit::RefNull) || !table.ty.element_type.is_func_ref() {
                        return refuse("a table of it holds something else than functions");
                    }
                    let size = usize::try_from(table.ty.initial).unwrap_or(usize::MAX);
                    if self.tables.len() == MOST_TABLES {
                        return refuse(format!("it has more than {MOST_TABLES} tables"));
                    }
                    let all = self.tables.iter().map(Vec::len).sum::<usize>();
                    if size > MOST_ENTRIES - all {
                        return refuse(format!("its tables have more than {MOST_ENTRIES} entries"));
                    }
                    self.tables.push(vec![None; size]);
                }
            }
            Payload::MemorySection(section) => {
                for memory in section {
                    let pages = usize::try_from(memory?.initial).unwrap_or(usize::MAX);
                    if pages > MOST_PAGES {
                        return refuse(format!(
                            "its memory has {pages} pages of 64 KiB; at most {MOST_PAGES} are possible (rustc: \
                             -C link-arg=-zstack-size=4096, clang: -Wl,-z,stack-size=4096)"
                        ));
                    }
                    self.pages = Some(pages);
                }
            }
            Payload::GlobalSection(section) => {
                for global in section {
                    let global = global?;
                    let value = constant(&global.init_expr)?;
                    self.places.push(if global.ty.mutable {
                        if self.globals.len() == MOST_GLOBALS {
                            return refuse(format!("it has more than {MOST_GLOBALS} globals that change"));
                        }
                        self.globals.push((value, matches!(global.ty.content_type, ValType::I64 | ValType::F64)));
                        Global::Variable(self.globals.len() as u32 - 1)
                    } else {
                        if self.places.len() - self.globals.len() == MOST_CONSTANTS {
                            return refuse(format!("it has more than {MOST_CONSTANTS} constant globals"));
                        }
                        Global::Constant(value)
                    });
                }
            }
            Payload::ExportSection(section) => {
                for export in section {
                    let export = export?;
                    self.exports.insert(export.name.to_owned(), (export.kind, export.index));
                }
            }
            Payload::ElementSection(section) => {
                for element in section {
                    self.element(element?)?;
                }
            }
            Payload::DataSection(section) => {
                for data in section {
                    self.data(&data?)?;
                }
            }
            Payload::CodeSectionEntry(body) => {
                let number = self.bodies.len();
                let kind = self.functions.get(number).copied().unwrap_or_default();
                let place = |sentence: Refused| Refused(format!("function {number}: {sentence}"));
                let known = translate::ModuleItems {
                    kinds: &self.kinds,
                    canonical: &self.canonical,
                    functions: &self.functions,
                    globals: &self.places,
                };
                let function = self.translated.function(&body, kind, &known).map_err(place)?;
                self.bodies.push(function);
            }
            _ => {}
        }
        Ok(())
    }

    fn element(&mut self, element: Element<'_>) -> Result<(), Refused> {
        let (table, offset) = match element.kind {
            ElementKind::Active { table_index, offset_expr } => {
                (table_index.unwrap_or(0) as usize, constant(&offset_expr)? as usize)
            }
            // A declared element is in no table.
            ElementKind::Declared => return Ok(()),
            ElementKind::Passive => return refuse("it fills a table later on; its tables must be constant"),
        };
        let mut functions = Vec::new();
        match element.items {
            ElementItems::Functions(items) => {
                for item in items {
                    functions.push(Some(item?));
                }
            }
            ElementItems::Expressions(_, items) => {
                for item in items {
                    functions.push(reference(&item?)?);
                }
            }
        }
        let entries = self.tables.get_mut(table).and_then(|table| table.get_mut(offset..)?.get_mut(..functions.len()));
        let Some(entries) = entries else { return refuse("its table is shorter than what fills it") };
        entries.copy_from_slice(&functions);
        Ok(())
    }

    fn data(&mut self, data: &Data<'_>) -> Result<(), Refused> {
        let DataKind::Active { offset_expr, .. } = &data.kind else {
            return refuse("it fills its memory later on (passive data); link it without --shared-memory");
        };
        let at = constant(offset_expr)? as usize;
        let end = at.checked_add(data.data.len());
        if end.is_none_or(|end| end > self.pages.unwrap_or(0) * PAGE) {
            return refuse("its memory is shorter than what fills it");
        }
        self.data.push((at, data.data.into()));
        Ok(())
    }
}

/// Returns the value of an expression without a calculation.
fn constant(expression: &ConstExpr<'_>) -> Result<u64, Refused> {
    match expression.get_operators_reader().read()? {
        // Bits, not numbers: the high bits of shorter types are 0.
        Operator::I32Const { value } => Ok(value.cast_unsigned().into()),
        Operator::I64Const { value } => Ok(value.cast_unsigned()),
        Operator::F32Const { value } => Ok(value.bits().into()),
        Operator::F64Const { value } => Ok(value.bits()),
        _ => refuse("a constant of it is calculated, or is no number"),
    }
}

/// Returns the function of a table entry.
fn reference(expression: &ConstExpr<'_>) -> Result<Option<u32>, Refused> {
    match expression.get_operators_reader().read()? {
        Operator::RefFunc { function_index } => Ok(Some(function_index)),
        Operator::RefNull { .. } => Ok(None),
        _ => refuse("an entry of its table is calculated"),
    }
}

/// Shared modules for serde.
pub mod shared {
    use super::Module;
    use serde::{Deserialize, Deserializer, Serializer};
    use std::sync::Arc;

    /// Writes each module as its bytes.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<S: Serializer>(modules: &[Arc<Module>], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(modules.iter().map(|module| &**module))
    }

    /// Reads and checks each module.
    ///
    /// # Errors
    /// Those of the deserializer; a module that is rejected.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Arc<Module>>, D::Error> {
        Ok(Vec::<Module>::deserialize(deserializer)?.into_iter().map(Arc::new).collect())
    }
}

impl Serialize for Module {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.bytes)
    }
}

impl<'de> Deserialize<'de> for Module {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let bytes = Vec::<u8>::deserialize(deserializer)?;
        Self::load(&bytes).map_err(serde::de::Error::custom)
    }
}
