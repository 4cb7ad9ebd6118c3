//! State of a program, as plain data: its memory and its variable globals.
//!
//! Law      a copy continues like the original; copying into an instance of the same size does not allocate
//! Reads    the module that it belongs to, at each call

use crate::image::{self, Image};
use crate::module::{MOST_GLOBALS, Module, PAGE};
use crate::run::{self, Stack};
use crate::trap::Trap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A program with its state.
#[derive(Debug)]
pub struct Instance {
    memory: Vec<u8>,
    globals: Vec<u64>,
    /// Reserved pages.
    room: usize,
    /// Stack; nothing in it is kept between calls.
    stack: Stack,
}

impl Instance {
    /// Creates an initialized instance, with memory for modules of that number of pages.
    pub fn new(module: &Module, pages: usize) -> Self {
        let mut instance = Self::with_room(pages.max(module.pages));
        instance.restart(module);
        instance
    }

    /// Creates an instance without a module, which cannot be called, with memory for a module of that number of pages.
    pub fn with_room(pages: usize) -> Self {
        let globals = Vec::with_capacity(MOST_GLOBALS);
        Self { memory: Vec::with_capacity(pages * PAGE), globals, room: pages, stack: Stack::default() }
    }

    /// Returns true if the memory is large enough for that module.
    pub fn has_room(&self, module: &Module) -> bool {
        module.pages <= self.room
    }

    /// Initializes the instance; does not allocate if the memory is large enough.
    pub fn restart(&mut self, module: &Module) {
        self.memory.resize(module.pages * PAGE, 0);
        module.fill(&mut self.memory);
        self.globals.clear();
        self.globals.extend(module.globals.iter().map(|(value, _)| *value));
    }

    /// Initializes the instance with another module. Values that the slot has written to the image are kept, and with
    /// `keeps` also the program's own part. Returns false, and changes nothing, if the own part has another length than
    /// that of the previous module, or if the memory is too small.
    pub fn exchange(&mut self, (module, before): (&Module, &Module), keeps: bool) -> bool {
        if keeps && !image::is_as_long(module, before) || !self.has_room(module) {
            return false;
        }
        let kept = self.memory.get(image::kept(before, keeps)).unwrap_or_default();
        let length = kept.len();
        let Some(beside) = self.stack.beside.get_mut(..length) else { return false };
        beside.copy_from_slice(kept);
        self.restart(module);
        let to = image::kept(module, keeps);
        // A restored memory may have been shorter than that of its module.
        if let (Some(beside), Some(to)) = (self.stack.beside.get(..length), self.memory.get_mut(to))
            && beside.len() == to.len()
        {
            to.copy_from_slice(beside);
        }
        true
    }

    /// Returns its image.
    pub fn image<'a>(&'a mut self, module: &Module) -> Image<'a> {
        Image::new(self.memory.get_mut(module.image.clone()).unwrap_or_default())
    }

    /// Executes one call with at most `fuel` instructions. Returns the number of executed instructions.
    ///
    /// # Errors
    /// The trap that ended the call, and the number of executed instructions.
    pub fn call(&mut self, module: &Module, fuel: u32) -> Result<u32, (Trap, u32)> {
        let mut left = fuel;
        let result = run::call(module, &mut self.memory, &mut self.globals, &mut self.stack, &mut left);
        let used = fuel - left;
        match result {
            Ok(()) if self.belongs_to(module) => Ok(used),
            Ok(()) => Err((Trap::ImageOverwritten, used)),
            Err(trap) => Err((trap, used)),
        }
    }

    /// Returns the reserved pages.
    pub fn room(&self) -> usize {
        self.room
    }

    /// Returns true if the state belongs to that module.
    pub fn belongs_to(&self, module: &Module) -> bool {
        let fits = |(value, (_, is_long)): (&u64, &(u64, bool))| *is_long || u32::try_from(*value).is_ok();
        self.memory.len() == module.pages * PAGE
            && self.globals.len() == module.globals.len()
            && self.globals.iter().zip(&module.globals).all(fits)
            && image::has_size(&self.memory, module.image.clone())
    }
}

impl PartialEq for Instance {
    fn eq(&self, other: &Self) -> bool {
        (&self.memory, &self.globals, self.room) == (&other.memory, &other.globals, other.room)
    }
}

impl Clone for Instance {
    fn clone(&self) -> Self {
        let mut copy = Self::with_room(self.room);
        copy.clone_from(self);
        copy
    }

    /// Does not allocate if the memory is large enough.
    fn clone_from(&mut self, other: &Self) {
        self.room = other.room;
        self.memory.clear();
        self.memory.extend_from_slice(&other.memory);
        self.globals.clear();
        self.globals.extend_from_slice(&other.globals);
    }
}

/// Serialized form: memory up to the last byte that is not 0.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Instance")]
struct SerializedInstance<M> {
    /// Reserved pages.
    room: u8,
    pages: u8,
    memory: M,
    globals: Vec<u64>,
}

impl Serialize for Instance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let used = self.memory.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        let count = |pages: usize| u8::try_from(pages).unwrap_or(u8::MAX);
        let memory = self.memory.get(..used).unwrap_or_default();
        let (room, pages) = (count(self.room), count(self.memory.len() / PAGE));
        SerializedInstance { room, pages, memory, globals: self.globals.clone() }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Instance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = SerializedInstance::<Vec<u8>>::deserialize(deserializer)?;
        let (room, pages) = (usize::from(written.room), usize::from(written.pages));
        let most = crate::module::MOST_PAGES;
        let is_good = pages <= room
            && room <= most
            && written.memory.len() <= pages * PAGE
            && written.globals.len() <= MOST_GLOBALS;
        if !is_good {
            return Err(serde::de::Error::custom("a program's memory is larger than its pages"));
        }
        let mut instance = Self::with_room(room);
        instance.memory.extend_from_slice(&written.memory);
        instance.memory.resize(pages * PAGE, 0);
        instance.globals.extend_from_slice(&written.globals);
        Ok(instance)
    }
}
