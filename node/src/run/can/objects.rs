//! Objects of CAN devices for clients, by name or index.
//!
//! Law      the service of the bus executes the requests, one after the other
//! Reads    the object dictionaries of the devices of the cell
//! Refuses  unknown objects, accesses that the dictionary does not permit; for devices of the cell, writes to objects of
//!          the master, and to objects mapped in a PDO of a module
//! Source   CiA 301, CiA 306-1

use crate::cell::owner;
use lineshaft_can::NodeId;
use lineshaft_can::commission::{self, check_readable, decoded, encoded, label, type_of};
use lineshaft_can::config::{BusConfig, DeviceConfig};
use lineshaft_can::eds::Dictionary;
use lineshaft_can::master::{Access, LONGEST, ObjectAccessError, RequestHandle, SdoRequestQueue};
use lineshaft_cia402::dictionary::{DataType, Value, type_name};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::texts::hex;
use lineshaft_core::drive::{DeviceObjects, ObjectAnswer, ObjectIndex, ObjectOperation, ObjectText, WaitingRequest};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Objects of the devices of a bus.
#[derive(Debug)]
pub struct CanObjects {
    name: String,
    queue: SdoRequestQueue,
    /// Node ID of the program itself.
    own: Option<NodeId>,
    devices: Vec<Device>,
    dictionaries: BTreeMap<NodeId, Dictionary>,
}

/// Data of a device of the cell.
#[derive(Debug)]
struct Device {
    node: NodeId,
    /// Name for messages.
    name: String,
    /// Name of the axis of a drive.
    axis: Option<String>,
    mapped: Vec<Object>,
}

struct Waiting(RequestHandle);

impl WaitingRequest for Waiting {
    fn cancel(&self) -> bool {
        self.0.cancel()
    }
}

impl CanObjects {
    /// Creates the access to the objects of a bus with its queue, and with the object dictionaries of its devices.
    pub fn new(config: &BusConfig, queue: SdoRequestQueue, dictionaries: BTreeMap<NodeId, Dictionary>) -> Self {
        let device = |device: &DeviceConfig| Device {
            node: device.node,
            name: device.to_string(),
            axis: device.drive().map(|drive| drive.axis.clone()),
            mapped: device.layout.mapped().collect(),
        };
        let (name, own) = (config.name.clone(), config.master.map(|master| master.node));
        Self { name, queue, own, devices: config.devices.iter().map(device).collect(), dictionaries }
    }

    fn device(&self, device: u16) -> Option<&Device> {
        self.devices.iter().find(|known| u16::from(known.node.get()) == device)
    }

    fn dictionary(&self, device: u16) -> Option<&Dictionary> {
        self.dictionaries.get(&node(device)?)
    }
}

fn node(device: u16) -> Option<NodeId> {
    u8::try_from(device).ok().and_then(NodeId::new)
}

fn object(ObjectIndex { index, sub }: ObjectIndex) -> Object {
    Object { index, sub }
}

/// Returns the type with that name; `None` for an empty name.
fn given(type_name: &str) -> Option<DataType> {
    if type_name.is_empty() { None } else { type_name::named(type_name) }
}

fn sentence(refusal: commission::Refusal) -> String {
    refusal.to_string()
}

/// Formats a value, without the zeros that pad a text on the bus.
fn written(value: &Value) -> String {
    match value {
        Value::Text(text) => text.trim_end_matches('\0').to_owned(),
        other => other.to_string(),
    }
}

impl DeviceObjects for CanObjects {
    fn backend(&self) -> &str {
        &self.name
    }

    fn devices(&self) -> RangeInclusive<u16> {
        1..=NodeId::MAX.into()
    }

    fn is_own(&self, device: u16) -> bool {
        self.own.is_some_and(|own| u16::from(own.get()) == device)
    }

    fn device_name(&self, device: u16) -> String {
        self.device(device).map_or_else(|| format!("node {device}"), |device| device.name.clone())
    }

    fn drives_of(&self, axis: &str) -> Vec<u16> {
        let drives = self.devices.iter().filter(|device| device.axis.as_deref() == Some(axis));
        drives.map(|device| device.node.get().into()).collect()
    }

    fn check_type(&self, type_name: &str) -> Result<(), String> {
        if type_name.is_empty() || given(type_name).is_some() {
            return Ok(());
        }
        Err(format!("type is {type_name:?}; {} are allowed, or nothing", type_name::list()))
    }

    fn find(&self, device: u16, name: &str) -> Result<ObjectIndex, String> {
        let found = commission::object(name, self.dictionary(device));
        let Object { index, sub } = found.map_err(|error| error.to_string())?;
        Ok(ObjectIndex { index, sub })
    }

    fn label(&self, device: u16, of: ObjectIndex) -> String {
        label(object(of), self.dictionary(device))
    }

    fn check_read(&self, device: u16, of: ObjectIndex, type_name: &str) -> Result<(), String> {
        let (object, dictionary) = (object(of), self.dictionary(device));
        check_readable(object, dictionary).map_err(sentence)?;
        type_of(object, given(type_name), dictionary).map(|_| ()).map_err(sentence)
    }

    fn decode(&self, device: u16, of: ObjectIndex, type_name: &str, data: &[u8]) -> Result<Option<ObjectText>, String> {
        let dictionary = self.dictionary(device);
        let Some(kind) = type_of(object(of), given(type_name), dictionary).map_err(sentence)? else { return Ok(None) };
        match decoded(object(of), data, kind, None) {
            Ok(value) => Ok(Some(ObjectText { value: written(&value), type_name: type_name::name(kind) })),
            Err(refusal) => Err(format!("{refusal}; {} has answered {}", self.label(device, of), hex(data))),
        }
    }

    fn encode(&self, device: u16, of: ObjectIndex, type_name: &str, value: &str) -> Result<Vec<u8>, String> {
        encoded(object(of), value, given(type_name), self.dictionary(device)).map_err(sentence)
    }

    fn max_bytes(&self) -> usize {
        LONGEST
    }

    fn owner(&self, device: u16, of: ObjectIndex) -> Option<&'static str> {
        let device = self.device(device)?;
        let is_output = device.axis.is_none() && device.mapped.contains(&object(of));
        owner(of.index).or(is_output.then_some("an output or input of the cell"))
    }

    fn is_cyclic(&self, device: u16, of: ObjectIndex) -> bool {
        self.device(device).is_some_and(|device| device.mapped.contains(&object(of)))
    }

    fn submit(
        &self,
        device: u16,
        of: ObjectIndex,
        operation: ObjectOperation,
        answer: ObjectAnswer,
    ) -> Result<Box<dyn WaitingRequest>, String> {
        let Some(node) = node(device) else { return Err(format!("node is {device}; 1 to {} is allowed", NodeId::MAX)) };
        let access = match operation {
            ObjectOperation::Read => Access::Read,
            ObjectOperation::Write { data, without_power } => Access::Write { data, without_power },
        };
        let answer =
            move |result: Result<Vec<u8>, ObjectAccessError>| answer(result.map_err(|denied| denied.to_string()));
        let request = self.queue.submit(node, object(of), access, answer).map_err(|denied| denied.to_string())?;
        Ok(Box::new(Waiting(request)))
    }
}
