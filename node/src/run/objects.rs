//! Access to objects of CAN devices by axis or node, and by name or index.
//!
//! Law      names of a request are resolved here; the service of its bus then executes it outside of the cycles, one
//!          request after the other. Each request gets an answer: one that has waited for 5 s is cancelled
//! Reads    the object dictionaries of the devices of the cell
//! Refuses  unknown objects, accesses that the dictionary does not permit, data longer than a block; for devices of the
//!          cell, writes to objects of the master, and to objects mapped in a PDO of a module or of an enabled drive
//! Source   CiA 301, CiA 306-1

use crate::cell::owner;
use lineshaft_can::NodeId;
use lineshaft_can::commission::{self, check_readable, decoded, encoded, label, type_of};
use lineshaft_can::config::{BusConfig, DeviceConfig};
use lineshaft_can::eds::Dictionary;
use lineshaft_can::master::{Access, LONGEST, ObjectAccessError, SdoRequestQueue};
use lineshaft_cia402::dictionary::{DataType, Value, type_name};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::texts::hex;
use lineshaft_msgs::srv::{SdoReadRequest, SdoReadResponse, SdoWriteRequest, SdoWriteResponse};
use lineshaft_ros::surface::host::{NO_BUS, PendingAnswer};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::time::Duration;
use tokio::sync::oneshot;

/// Maximum time that a request waits for other requests of the bus and for the configuration of drives.
const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum length of a name, in bytes.
const LONGEST_NAME: usize = 256;
/// Maximum length of a value as text, in bytes: three for each byte of the longest object, and room for spaces.
const LONGEST_VALUE: usize = 4096;

/// Access to the objects of all buses of a machine.
#[derive(Debug)]
pub struct ObjectAccess {
    buses: Vec<Bus>,
    /// Names of backends on CAN that are simulated in this run.
    simulated: Vec<String>,
    patience: Duration,
}

impl Default for ObjectAccess {
    fn default() -> Self {
        Self { buses: Vec::new(), simulated: Vec::new(), patience: PATIENCE }
    }
}

/// Data of a bus.
#[derive(Debug)]
struct Bus {
    name: String,
    objects: SdoRequestQueue,
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

/// Resolved object of a request, with its description.
struct ResolvedObject<'a> {
    bus: &'a Bus,
    node: NodeId,
    device: Option<&'a Device>,
    object: Object,
    given: Option<DataType>,
}

impl ObjectAccess {
    /// Creates an access without a bus. `simulated` are the names of backends on CAN that are simulated.
    pub fn new(simulated: Vec<String>) -> Self {
        Self { simulated, ..Self::default() }
    }

    /// Returns true if there is no bus.
    pub fn is_empty(&self) -> bool {
        self.buses.is_empty()
    }

    /// Adds a bus, the access to its objects, and the object dictionaries of its devices.
    pub fn with_bus(
        mut self,
        config: &BusConfig,
        objects: SdoRequestQueue,
        dictionaries: BTreeMap<NodeId, Dictionary>,
    ) -> Self {
        let device = |device: &DeviceConfig| Device {
            node: device.node,
            name: device.to_string(),
            axis: device.drive().map(|drive| drive.axis.clone()),
            mapped: device.layout.mapped().collect(),
        };
        let (name, own) = (config.name.clone(), config.master.map(|master| master.node));
        let devices = config.devices.iter().map(device).collect();
        self.buses.push(Bus { name, objects, own, devices, dictionaries });
        self
    }

    /// Starts reading an object.
    ///
    /// # Errors
    /// Returns an error message of one sentence for an invalid request; nothing was sent to a device.
    pub fn read(&self, request: &SdoReadRequest) -> Result<PendingAnswer<SdoReadResponse>, String> {
        let SdoReadRequest { axis, backend, node, object, r#type } = request;
        let meant = self.meant([axis, backend, object, r#type], *node)?;
        let dictionary = meant.dictionary();
        let refuse = |refusal: commission::Refusal| meant.sentence(refusal);
        check_readable(meant.object, dictionary).map_err(refuse)?;
        let kind = type_of(meant.object, meant.given, dictionary).map_err(refuse)?;
        let (who, object, name) = (meant.who(), meant.object, label(meant.object, dictionary));
        let asked = meant.ask(Access::Read, self.patience)?;
        Ok(Box::pin(async move {
            let refused = |message: String| SdoReadResponse {
                message: format!("{who}: {message}"),
                ..SdoReadResponse::default()
            };
            let data = match asked.await {
                Ok(data) => data,
                Err(message) => return refused(message),
            };
            match kind.map(|kind| (kind, decoded(object, &data, kind, None))) {
                None => SdoReadResponse { success: true, data, ..SdoReadResponse::default() },
                Some((kind, Ok(value))) => SdoReadResponse {
                    success: true,
                    data,
                    value: written(&value),
                    r#type: type_name::name(kind),
                    ..SdoReadResponse::default()
                },
                Some((_, Err(refusal))) => {
                    let message = format!("{refusal}; {name} has answered {}", hex(&data));
                    SdoReadResponse { data, ..refused(message) }
                }
            }
        }))
    }

    /// Starts writing an object.
    ///
    /// # Errors
    /// Returns an error message of one sentence for an invalid request; nothing was sent to a device.
    pub fn write(&self, request: &SdoWriteRequest) -> Result<PendingAnswer<SdoWriteResponse>, String> {
        let SdoWriteRequest { axis, backend, node, object, r#type, value } = request;
        let meant = self.meant([axis, backend, object, r#type], *node)?;
        short("value", value, LONGEST_VALUE)?;
        let value = value.clone();
        let (object, dictionary) = (meant.object, meant.dictionary());
        let name = label(object, dictionary);
        if let Some(owner) = meant.device.and_then(|device| device.owner(object)) {
            return Err(meant.sentence(format!("{name} is not for ~/sdo_write: {owner} says what it holds")));
        }
        let refuse = |refusal: commission::Refusal| meant.sentence(refusal);
        let data = encoded(object, &value, meant.given, dictionary).map_err(refuse)?;
        if data.len() > LONGEST {
            let bytes = data.len();
            return Err(meant.sentence(format!("{name}: the value has {bytes} bytes; {LONGEST} at most are allowed")));
        }
        let without_power = meant.device.is_some_and(|device| device.mapped.contains(&object));
        let who = meant.who();
        let asked = meant.ask(Access::Write { data, without_power }, self.patience)?;
        Ok(Box::pin(async move {
            match asked.await {
                Ok(_) => {
                    tracing::info!("{who}: {name} was written by ~/sdo_write: {value:?}");
                    SdoWriteResponse { success: true, message: String::new() }
                }
                Err(message) => SdoWriteResponse { success: false, message: format!("{who}: {message}") },
            }
        }))
    }

    /// Resolves a request: axis, backend, object and type by their names.
    fn meant(&self, [axis, backend, object, given]: [&str; 4], node: u8) -> Result<ResolvedObject<'_>, String> {
        for (what, name) in [("axis", axis), ("backend", backend), ("object", object), ("type", given)] {
            short(what, name, LONGEST_NAME)?;
        }
        let (bus, node) = match axis {
            "" => {
                let bus = self.bus(backend)?;
                let node = NodeId::new(node).ok_or_else(|| {
                    format!("node is {node}; 1 to {} is allowed, or 0 and the name of an axis", NodeId::MAX)
                })?;
                (bus, node)
            }
            axis => self.drive_of(axis, backend, node)?,
        };
        if bus.own == Some(node) {
            return Err(format!("{}: {node} is this program, which has no objects", bus.name));
        }
        let device = bus.devices.iter().find(|device| device.node == node);
        let known_type = || format!("type is {given:?}; {} are allowed, or nothing", type_name::list());
        let given = if given.is_empty() { None } else { Some(type_name::named(given).ok_or_else(known_type)?) };
        let mut meant = ResolvedObject { bus, node, device, object: Object { index: 0, sub: 0 }, given };
        meant.object = commission::object(object, meant.dictionary()).map_err(|error| meant.sentence(error))?;
        Ok(meant)
    }

    fn bus(&self, name: &str) -> Result<&Bus, String> {
        let names = || self.buses.iter().map(|bus| bus.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = match name {
            "" => self.buses.first().filter(|_| self.buses.len() == 1),
            name => self.buses.iter().find(|bus| bus.name == name),
        };
        let is_meant = |simulated: &&String| name.is_empty() || *simulated == name;
        match (found, self.simulated.iter().find(is_meant)) {
            (Some(bus), _) => Ok(bus),
            (None, Some(simulated)) => Err(format!("backend {simulated} is simulated: it has no bus and no objects")),
            (None, None) if self.buses.is_empty() => Err(NO_BUS.to_owned()),
            (None, None) if name.is_empty() => Err(format!("backend is empty, and there are several: {}", names())),
            (None, None) => Err(format!("no backend on CAN is called {name:?}; there are {}", names())),
        }
    }

    fn drive_of(&self, axis: &str, backend: &str, node: u8) -> Result<(&Bus, NodeId), String> {
        if node != 0 {
            return Err(format!("axis is {axis:?} and node is {node}; give one of them, the node then as 0"));
        }
        if !backend.is_empty() || self.buses.is_empty() {
            self.bus(backend)?;
        }
        let devices = self.buses.iter().flat_map(|bus| bus.devices.iter().map(move |device| (bus, device)));
        let mut devices = devices.filter(|(bus, _)| backend.is_empty() || bus.name == backend);
        let is_it = |device: &Device| device.axis.as_deref() == Some(axis);
        let found = devices.find(|(_, device)| is_it(device)).map(|(bus, device)| (bus, device.node));
        if let Some((other, second)) = devices.find(|(_, device)| is_it(device)) {
            let first = found.map_or_else(String::new, |(bus, node)| format!("{} {node}", bus.name));
            return Err(format!(
                "{axis} has two drives, {first} and {} {}; give backend and node of one",
                other.name, second.node
            ));
        }
        found.ok_or_else(|| format!("no axis with a drive on CAN is called {axis:?}"))
    }
}

impl Device {
    /// Returns the source of the value of an object, if it is not the client.
    fn owner(&self, object: Object) -> Option<&'static str> {
        let is_output = self.axis.is_none() && self.mapped.contains(&object);
        owner(object.index).or(is_output.then_some("an output or input of the cell"))
    }
}

impl<'a> ResolvedObject<'a> {
    fn dictionary(&self) -> Option<&'a Dictionary> {
        self.bus.dictionaries.get(&self.node)
    }

    /// Returns bus, node and axis for a message.
    fn who(&self) -> String {
        let name = self.device.map_or_else(|| self.node.to_string(), |device| device.name.clone());
        format!("{}: {name}", self.bus.name)
    }

    fn sentence(&self, what: impl Display) -> String {
        format!("{}: {what}", self.who())
    }

    /// Queues a request of the bus.
    fn ask(&self, access: Access, patience: Duration) -> Result<PendingAnswer<Result<Vec<u8>, String>>, String> {
        let (answer, mut answered) = oneshot::channel::<Result<Vec<u8>, ObjectAccessError>>();
        let ticket = self.bus.objects.submit(self.node, self.object, access, move |result| {
            // The caller may have gone.
            let _ = answer.send(result);
        });
        let ticket = ticket.map_err(|denied| self.sentence(denied))?;
        Ok(Box::pin(async move {
            let answer = match tokio::time::timeout(patience, &mut answered).await {
                Ok(answer) => answer,
                Err(_) if ticket.cancel() => {
                    let s = patience.as_secs_f64();
                    return Err(format!("the bus had no time for it within {s} s; nothing was done"));
                }
                // It is being executed, and ends with or without an answer of the device.
                Err(_) => answered.await,
            };
            answer.map_err(|_| "the machine has stopped".to_owned())?.map_err(|denied| denied.to_string())
        }))
    }
}

fn short(what: &str, text: &str, most: usize) -> Result<(), String> {
    let bytes = text.len();
    if bytes > most { Err(format!("{what} is {bytes} bytes long; {most} are allowed")) } else { Ok(()) }
}

/// Formats a value, without the zeros that pad a text on the bus.
fn written(value: &Value) -> String {
    match value {
        Value::Text(text) => text.trim_end_matches('\0').to_owned(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests;
