//! Access to the objects of the devices of a backend while cycles run, outside of the cycle thread.
//!
//! Law      an object has an index and a sub-index in the dictionary of its device (CiA 301, also for CoE); its value is
//!          bytes. The backend knows the dictionaries, converts between bytes and text, and executes requests one after
//!          the other. Each request that was accepted is answered once, cancelled before it began, or dropped when the
//!          backend ends
//! Refuses  each method with a message of one sentence, without the names of backend and device

use std::fmt::Debug;
use std::ops::RangeInclusive;

/// Position of an object in the dictionary of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ObjectIndex {
    /// Index.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
}

/// Operation on an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ObjectOperation {
    /// The object is read.
    Read,
    /// The object is written.
    Write {
        /// Bytes of the value.
        data: Vec<u8>,
        /// Whether the write requires that the drive is not under power.
        without_power: bool,
    },
}

/// Value of an object as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjectText {
    /// The value.
    pub value: String,
    /// Name of its type.
    pub type_name: String,
}

/// Receiver of the bytes that were read (none after a write), or of a message of one sentence.
pub type ObjectAnswer = Box<dyn FnOnce(Result<Vec<u8>, String>) + Send>;

/// A request that waits for its execution.
pub trait WaitingRequest: Send {
    /// Cancels the request. Returns false if it has already begun; it is then answered.
    fn cancel(&self) -> bool;
}

/// Objects of the devices of one backend: their descriptions, and access to their values.
pub trait DeviceObjects: Debug + Send + Sync {
    /// Returns the name of the backend.
    fn backend(&self) -> &str;

    /// Returns the numbers that devices may have.
    fn devices(&self) -> RangeInclusive<u16>;

    /// Whether this number is that of the program itself, which has no objects.
    fn is_own(&self, device: u16) -> bool;

    /// Returns a device as text, with its axis or its role if the cell has it.
    fn device_name(&self, device: u16) -> String;

    /// Returns the devices that are drives of that axis.
    fn drives_of(&self, axis: &str) -> Vec<u16>;

    /// Checks the name of a type; an empty name is the type in the dictionary.
    ///
    /// # Errors
    /// Returns an error if the type is unknown.
    fn check_type(&self, type_name: &str) -> Result<(), String>;

    /// Returns the object with that name, or with that index and sub-index as text.
    ///
    /// # Errors
    /// Returns an error if there is no such object, or several.
    fn find(&self, device: u16, name: &str) -> Result<ObjectIndex, String>;

    /// Returns an object as text, with its name if it is known.
    fn label(&self, device: u16, object: ObjectIndex) -> String;

    /// Checks that an object may be read as that type.
    ///
    /// # Errors
    /// Returns an error if the dictionary does not permit it.
    fn check_read(&self, device: u16, object: ObjectIndex, type_name: &str) -> Result<(), String>;

    /// Converts the bytes of an object that may be read to text; `None` if its type is unknown.
    ///
    /// # Errors
    /// Returns an error if the bytes are no value of the type.
    fn decode(
        &self,
        device: u16,
        object: ObjectIndex,
        type_name: &str,
        data: &[u8],
    ) -> Result<Option<ObjectText>, String>;

    /// Converts a value for an object from text to bytes.
    ///
    /// # Errors
    /// Returns an error if the dictionary does not permit the access or the value, or if the type is unknown.
    fn encode(&self, device: u16, object: ObjectIndex, type_name: &str, value: &str) -> Result<Vec<u8>, String>;

    /// Returns the maximum size of a value that is read or written, in bytes.
    fn max_bytes(&self) -> usize;

    /// Returns the source of the value of an object, if it is not the client.
    fn owner(&self, device: u16, object: ObjectIndex) -> Option<&'static str>;

    /// Whether an object is part of the cyclic data of its device.
    fn is_cyclic(&self, device: u16, object: ObjectIndex) -> bool;

    /// Queues a request; does not block. `answer` is called on another thread, or dropped if the backend ends.
    ///
    /// # Errors
    /// Returns an error if the queue is full, or if the backend has ended; `answer` is not called then.
    fn submit(
        &self,
        device: u16,
        object: ObjectIndex,
        operation: ObjectOperation,
        answer: ObjectAnswer,
    ) -> Result<Box<dyn WaitingRequest>, String>;
}
