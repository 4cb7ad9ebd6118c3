//! Access to objects of devices by axis or node, and by name or index.
//!
//! Law      names of a request are resolved here; its backend then executes it outside of the cycles, one request after
//!          the other. Each request gets an answer: one that has waited for 5 s is cancelled
//! Refuses  what [`DeviceObjects`] refuses, data longer than its maximum; for devices of the cell, writes to objects with
//!          another owner, and to objects in the cyclic data of an enabled drive

use crate::cell::WITH_OBJECTS;
use lineshaft_core::drive::{DeviceObjects, ObjectIndex, ObjectOperation, ObjectText};
use lineshaft_msgs::srv::{SdoReadRequest, SdoReadResponse, SdoWriteRequest, SdoWriteResponse};
use lineshaft_ros::surface::host::{NO_BUS, PendingAnswer};
use std::fmt::Display;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::oneshot;

/// Maximum time that a request waits for other requests of the bus and for the configuration of drives.
const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum length of a name, in bytes.
const LONGEST_NAME: usize = 256;
/// Maximum length of a value as text, in bytes: three for each byte of the longest object, and room for spaces.
const LONGEST_VALUE: usize = 4096;

/// Access to the objects of all backends of a machine.
#[derive(Debug)]
pub struct ObjectAccess {
    buses: Vec<Arc<dyn DeviceObjects>>,
    /// Names of backends whose devices have objects, and that are simulated in this run.
    simulated: Vec<String>,
    patience: Duration,
}

impl Default for ObjectAccess {
    fn default() -> Self {
        Self { buses: Vec::new(), simulated: Vec::new(), patience: PATIENCE }
    }
}

/// Resolved object of a request, with its description.
struct ResolvedObject<'a> {
    bus: &'a Arc<dyn DeviceObjects>,
    device: u16,
    object: ObjectIndex,
    type_name: &'a str,
}

impl ObjectAccess {
    /// Creates an access without a bus. `simulated` are the names of backends whose devices have objects, and that are
    /// simulated.
    pub fn new(simulated: Vec<String>) -> Self {
        Self { simulated, ..Self::default() }
    }

    /// Returns true if there is no bus.
    pub fn is_empty(&self) -> bool {
        self.buses.is_empty()
    }

    /// Adds the objects of a bus.
    pub fn with_bus(mut self, objects: Arc<dyn DeviceObjects>) -> Self {
        self.buses.push(objects);
        self
    }

    /// Starts reading an object.
    ///
    /// # Errors
    /// Returns an error message of one sentence for an invalid request; nothing was sent to a device.
    pub fn read(&self, request: &SdoReadRequest) -> Result<PendingAnswer<SdoReadResponse>, String> {
        let SdoReadRequest { axis, backend, node, object, r#type } = request;
        let meant = self.meant([axis, backend, object, r#type], *node)?;
        let ResolvedObject { bus, device, object, type_name } = meant;
        bus.check_read(device, object, type_name).map_err(|refusal| meant.sentence(refusal))?;
        let (bus, who, type_name) = (Arc::clone(bus), meant.who(), type_name.to_owned());
        let asked = meant.ask(ObjectOperation::Read, self.patience)?;
        Ok(Box::pin(async move {
            let refused = |message: String| SdoReadResponse {
                message: format!("{who}: {message}"),
                ..SdoReadResponse::default()
            };
            let data = match asked.await {
                Ok(data) => data,
                Err(message) => return refused(message),
            };
            match bus.decode(device, object, &type_name, &data) {
                Ok(None) => SdoReadResponse { success: true, data, ..SdoReadResponse::default() },
                Ok(Some(ObjectText { value, type_name })) => {
                    SdoReadResponse { success: true, data, value, r#type: type_name, ..SdoReadResponse::default() }
                }
                Err(message) => SdoReadResponse { data, ..refused(message) },
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
        let ResolvedObject { bus, device, object, type_name } = meant;
        let name = bus.label(device, object);
        if let Some(owner) = bus.owner(device, object) {
            return Err(meant.sentence(format!("{name} is not for ~/sdo_write: {owner} says what it holds")));
        }
        let data = bus.encode(device, object, type_name, &value).map_err(|refusal| meant.sentence(refusal))?;
        let (bytes, most) = (data.len(), bus.max_bytes());
        if bytes > most {
            return Err(meant.sentence(format!("{name}: the value has {bytes} bytes; {most} at most are allowed")));
        }
        let without_power = bus.is_cyclic(device, object);
        let who = meant.who();
        let asked = meant.ask(ObjectOperation::Write { data, without_power }, self.patience)?;
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
    fn meant<'a>(
        &'a self,
        [axis, backend, object, type_name]: [&'a str; 4],
        node: u8,
    ) -> Result<ResolvedObject<'a>, String> {
        for (what, name) in [("axis", axis), ("backend", backend), ("object", object), ("type", type_name)] {
            short(what, name, LONGEST_NAME)?;
        }
        let node = u16::from(node);
        let (bus, device) = match axis {
            "" => {
                let bus = self.bus(backend)?;
                let numbers = bus.devices();
                if !numbers.contains(&node) {
                    let (low, high) = (numbers.start(), numbers.end());
                    return Err(format!("node is {node}; {low} to {high} is allowed, or 0 and the name of an axis"));
                }
                (bus, node)
            }
            axis => self.drive_of(axis, backend, node)?,
        };
        if bus.is_own(device) {
            return Err(format!("{}: node {device} is this program, which has no objects", bus.backend()));
        }
        bus.check_type(type_name)?;
        let found = bus.find(device, object).map_err(|error| sentence(bus.as_ref(), device, error))?;
        Ok(ResolvedObject { bus, device, object: found, type_name })
    }

    fn bus(&self, name: &str) -> Result<&Arc<dyn DeviceObjects>, String> {
        let names = || self.buses.iter().map(|bus| bus.backend()).collect::<Vec<_>>().join(", ");
        let found = match name {
            "" => self.buses.first().filter(|_| self.buses.len() == 1),
            name => self.buses.iter().find(|bus| bus.backend() == name),
        };
        let is_meant = |simulated: &&String| name.is_empty() || *simulated == name;
        match (found, self.simulated.iter().find(is_meant)) {
            (Some(bus), _) => Ok(bus),
            (None, Some(simulated)) => Err(format!("backend {simulated} is simulated: it has no bus and no objects")),
            (None, None) if self.buses.is_empty() => Err(NO_BUS.to_owned()),
            (None, None) if name.is_empty() => Err(format!("backend is empty, and there are several: {}", names())),
            (None, None) => Err(format!("no backend on {WITH_OBJECTS} is called {name:?}; there are {}", names())),
        }
    }

    fn drive_of(&self, axis: &str, backend: &str, node: u16) -> Result<(&Arc<dyn DeviceObjects>, u16), String> {
        if node != 0 {
            return Err(format!("axis is {axis:?} and node is {node}; give one of them, the node then as 0"));
        }
        if !backend.is_empty() || self.buses.is_empty() {
            self.bus(backend)?;
        }
        let buses = self.buses.iter().filter(|bus| backend.is_empty() || bus.backend() == backend);
        let mut drives = buses.flat_map(|bus| bus.drives_of(axis).into_iter().map(move |device| (bus, device)));
        match (drives.next(), drives.next()) {
            (Some(found), None) => Ok(found),
            (Some((first, one)), Some((second, other))) => {
                let (first, second) = (first.backend(), second.backend());
                Err(format!(
                    "{axis} has two drives, {first} node {one} and {second} node {other}; give backend and node of one"
                ))
            }
            (None, _) => Err(format!("no axis with a drive on {WITH_OBJECTS} is called {axis:?}")),
        }
    }
}

impl ResolvedObject<'_> {
    /// Returns bus, node and axis for a message.
    fn who(&self) -> String {
        who(self.bus.as_ref(), self.device)
    }

    fn sentence(&self, what: impl Display) -> String {
        sentence(self.bus.as_ref(), self.device, what)
    }

    /// Queues a request of the bus.
    fn ask(
        &self,
        operation: ObjectOperation,
        patience: Duration,
    ) -> Result<PendingAnswer<Result<Vec<u8>, String>>, String> {
        let (answer, mut answered) = oneshot::channel::<Result<Vec<u8>, String>>();
        let answer = Box::new(move |result| {
            // The caller may have gone.
            let _ = answer.send(result);
        });
        let request = self.bus.submit(self.device, self.object, operation, answer);
        let request = request.map_err(|denied| self.sentence(denied))?;
        Ok(Box::pin(async move {
            let answer = match tokio::time::timeout(patience, &mut answered).await {
                Ok(answer) => answer,
                Err(_) if request.cancel() => {
                    let s = patience.as_secs_f64();
                    return Err(format!("the bus had no time for it within {s} s; nothing was done"));
                }
                // It is being executed, and ends with or without an answer of the device.
                Err(_) => answered.await,
            };
            answer.map_err(|_| "the machine has stopped".to_owned())?
        }))
    }
}

/// Returns bus, node and axis for a message.
fn who(bus: &dyn DeviceObjects, device: u16) -> String {
    format!("{}: {}", bus.backend(), bus.device_name(device))
}

fn sentence(bus: &dyn DeviceObjects, device: u16, what: impl Display) -> String {
    format!("{}: {what}", who(bus, device))
}

fn short(what: &str, text: &str, most: usize) -> Result<(), String> {
    let bytes = text.len();
    if bytes > most { Err(format!("{what} is {bytes} bytes long; {most} are allowed")) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
