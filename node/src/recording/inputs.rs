//! Converts `Inputs` to the message `CycleInputs` and back.
//!
//! Law      reading a written message gives the same inputs, bit by bit, including NaN
//! Refuses  arrays that do not fit the machine, latches of unknown objects or without age and position

use super::run::Message;
use lineshaft_core::config::{IoKind, MachineConfig};
use lineshaft_core::drive::{BusState, DriveInput, Edge, Emergency, EncoderInput, Inputs, Latch, MAX_LATCHES};
use lineshaft_core::object::Object;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::cdr::decode_with_header;
use lineshaft_msgs::msg::CycleInputs;

/// Fills the message with the inputs of a cycle and reuses its memory.
pub(super) fn fill(message: &mut CycleInputs, inputs: &Inputs, config: &MachineConfig) {
    message.cycle = inputs.cycle;
    message.missed = inputs.missed;
    message.latches_lost = inputs.latches_lost;
    message.digital.clone_from(&inputs.digital);
    message.analog.clone_from(&inputs.analog);
    let encoders = || inputs.encoder.iter();
    set(&mut message.encoder_count, encoders().map(|encoder| encoder.count));
    set(&mut message.encoder_epoch, encoders().map(|encoder| encoder.epoch));
    set(&mut message.encoder_valid, encoders().map(|encoder| encoder.valid));
    set(&mut message.encoder_has_index, encoders().map(|encoder| encoder.index.is_some()));
    set(&mut message.encoder_index, encoders().map(|encoder| encoder.index.unwrap_or(0)));
    let drives = || inputs.drive.iter();
    set(&mut message.drive_count, drives().map(|drive| drive.count));
    set(&mut message.drive_epoch, drives().map(|drive| drive.epoch));
    set(&mut message.drive_velocity, drives().map(|drive| drive.velocity));
    set(&mut message.drive_effort, drives().map(|drive| drive.effort));
    set(&mut message.drive_status, drives().map(|drive| drive.status));
    set(&mut message.drive_mode, drives().map(|drive| drive.mode));
    set(&mut message.drive_fault, drives().map(|drive| drive.fault));
    set(&mut message.drive_online, drives().map(|drive| drive.online));
    set(&mut message.drive_fresh, drives().map(|drive| drive.fresh));
    set(&mut message.drive_inputs, drives().map(|drive| drive.inputs));
    set(&mut message.drive_has_index, drives().map(|drive| drive.index.is_some()));
    set(&mut message.drive_index, drives().map(|drive| drive.index.unwrap_or(0)));
    set(&mut message.drive_bus, drives().map(|drive| bus_number(drive.bus)));
    set(&mut message.drive_has_emergency, drives().map(|drive| drive.emergency.is_some()));
    let emergency = |drive: &DriveInput| drive.emergency.map_or(0, |sent| u64::from_le_bytes(sent.to_bytes()));
    set(&mut message.drive_emergency, drives().map(emergency));
    let has_missed = drives().any(|drive| drive.unacknowledged);
    set(&mut message.drive_unacknowledged, drives().filter(|_| has_missed).map(|drive| drive.unacknowledged));
    let latches = || inputs.latch.iter();
    set(&mut message.latch_object, latches().map(|latch| config.name(latch.object).to_owned()));
    set(&mut message.latch_edge, latches().map(|latch| edge_number(latch.edge)));
    set(&mut message.latch_has_age, latches().map(|latch| latch.age_ns.is_some()));
    set(&mut message.latch_age_ns, latches().map(|latch| latch.age_ns.unwrap_or(0)));
    set(&mut message.latch_has_position, latches().map(|latch| latch.position.is_some()));
    set(&mut message.latch_position, latches().map(|latch| latch.position.unwrap_or(0)));
}

fn set<T>(place: &mut Vec<T>, values: impl Iterator<Item = T>) {
    place.clear();
    place.extend(values);
}

fn edge_number(edge: Edge) -> u8 {
    match edge {
        Edge::Rising => CycleInputs::RISING,
        Edge::Falling => CycleInputs::FALLING,
    }
}

fn bus_number(state: BusState) -> u8 {
    match state {
        BusState::Active => CycleInputs::ACTIVE,
        BusState::Degraded => CycleInputs::PASSIVE,
        BusState::Off => CycleInputs::OFF,
    }
}

/// Decodes a message of a recording, also of an older one without the last array or the last four.
///
/// # Errors
/// Returns a message if it is not valid CDR or does not match its type.
pub(super) fn decode(message: &Message<'_>) -> Result<CycleInputs, String> {
    message.decode().or_else(|error| {
        // An empty array is a length of four bytes.
        let cdr = message.cdr()?;
        let padded = |missing: &[u8]| decode_with_header::<CycleInputs>(&[cdr, missing].concat()).ok();
        let without_last = padded(&[0; 4]).filter(|inputs| inputs.drive_unacknowledged.is_empty());
        without_last.or_else(|| padded(&[0; 16]).filter(is_of_before)).ok_or(error)
    })
}

fn is_of_before(message: &CycleInputs) -> bool {
    message.drive_bus.is_empty() && message.drive_has_emergency.is_empty() && message.drive_emergency.is_empty()
}

/// Reads a message into `inputs` and reuses their memory. After an error their content is undefined.
///
/// # Errors
/// Returns a message that names the value that does not fit the machine.
pub fn read_inputs(message: &CycleInputs, config: &MachineConfig, inputs: &mut Inputs) -> Result<(), String> {
    check_shape(message, config)?;
    inputs.cycle = message.cycle;
    inputs.missed = message.missed;
    inputs.latches_lost = message.latches_lost;
    inputs.digital.clone_from(&message.digital);
    inputs.analog.clone_from(&message.analog);
    inputs.encoder.clear();
    for place in 0..message.encoder_count.len() {
        inputs.encoder.push(encoder(message, place)?);
    }
    inputs.drive.clear();
    for place in 0..message.drive_count.len() {
        inputs.drive.push(drive(message, place)?);
    }
    inputs.latch.clear();
    for place in 0..message.latch_object.len() {
        inputs.latch.push(latch(message, place, config)?);
    }
    Ok(())
}

/// Checks that every array has a value at each index that is read.
fn check_shape(message: &CycleInputs, config: &MachineConfig) -> Result<(), String> {
    let (encoders, drives, latches) = (config.encoders.len(), config.count_drives(), message.latch_object.len());
    let added = if is_of_before(message) { 0 } else { drives };
    let missed = if message.drive_unacknowledged.is_empty() { 0 } else { drives };
    let lengths = [
        ("digital", message.digital.len(), config.count_io(IoKind::DigitalInput).div_ceil(64)),
        ("analog", message.analog.len(), config.count_io(IoKind::AnalogInput)),
        ("encoder_count", message.encoder_count.len(), encoders),
        ("encoder_epoch", message.encoder_epoch.len(), encoders),
        ("encoder_valid", message.encoder_valid.len(), encoders),
        ("encoder_has_index", message.encoder_has_index.len(), encoders),
        ("encoder_index", message.encoder_index.len(), encoders),
        ("drive_count", message.drive_count.len(), drives),
        ("drive_epoch", message.drive_epoch.len(), drives),
        ("drive_velocity", message.drive_velocity.len(), drives),
        ("drive_effort", message.drive_effort.len(), drives),
        ("drive_status", message.drive_status.len(), drives),
        ("drive_mode", message.drive_mode.len(), drives),
        ("drive_fault", message.drive_fault.len(), drives),
        ("drive_online", message.drive_online.len(), drives),
        ("drive_fresh", message.drive_fresh.len(), drives),
        ("drive_inputs", message.drive_inputs.len(), drives),
        ("drive_has_index", message.drive_has_index.len(), drives),
        ("drive_index", message.drive_index.len(), drives),
        ("drive_bus", message.drive_bus.len(), added),
        ("drive_has_emergency", message.drive_has_emergency.len(), added),
        ("drive_emergency", message.drive_emergency.len(), added),
        ("drive_unacknowledged", message.drive_unacknowledged.len(), missed),
        ("latch_edge", message.latch_edge.len(), latches),
        ("latch_has_age", message.latch_has_age.len(), latches),
        ("latch_age_ns", message.latch_age_ns.len(), latches),
        ("latch_has_position", message.latch_has_position.len(), latches),
        ("latch_position", message.latch_position.len(), latches),
    ];
    match lengths.into_iter().find(|(_, length, wanted)| length != wanted) {
        Some((field, length, wanted)) => Err(format!("{field} has {length} elements; {wanted} are needed")),
        None if latches > MAX_LATCHES => {
            Err(format!("latch_object has {latches} elements; at most {MAX_LATCHES} are allowed"))
        }
        None => Ok(()),
    }
}

fn encoder(message: &CycleInputs, place: usize) -> Result<EncoderInput, String> {
    Ok(EncoderInput {
        count: message.encoder_count[place],
        epoch: message.encoder_epoch[place],
        valid: message.encoder_valid[place],
        index: index("encoder", place, &message.encoder_has_index, &message.encoder_index)?,
    })
}

/// Returns the index pulse of the encoder or drive with this index.
fn index(what: &str, place: usize, has: &[bool], counts: &[i64]) -> Result<Option<i64>, String> {
    optional(has[place], counts[place])
        .ok_or_else(|| format!("{what}_index[{place}] is not 0, though {what}_has_index is false"))
}

fn drive(message: &CycleInputs, place: usize) -> Result<DriveInput, String> {
    Ok(DriveInput {
        count: message.drive_count[place],
        epoch: message.drive_epoch[place],
        velocity: message.drive_velocity[place],
        effort: message.drive_effort[place],
        status: message.drive_status[place],
        mode: message.drive_mode[place],
        fault: message.drive_fault[place],
        online: message.drive_online[place],
        fresh: message.drive_fresh[place],
        inputs: message.drive_inputs[place],
        bus: bus(message, place)?,
        emergency: emergency(message, place)?,
        index: index("drive", place, &message.drive_has_index, &message.drive_index)?,
        unacknowledged: message.drive_unacknowledged.get(place).is_some_and(|missed| *missed),
    })
}

fn bus(message: &CycleInputs, place: usize) -> Result<BusState, String> {
    match message.drive_bus.get(place).copied().unwrap_or(CycleInputs::ACTIVE) {
        CycleInputs::ACTIVE => Ok(BusState::Active),
        CycleInputs::PASSIVE => Ok(BusState::Degraded),
        CycleInputs::OFF => Ok(BusState::Off),
        other => Err(format!("drive_bus[{place}] is {other}; 0 (active), 1 (passive) and 2 (off) are allowed")),
    }
}

fn emergency(message: &CycleInputs, place: usize) -> Result<Option<Emergency>, String> {
    let has = message.drive_has_emergency.get(place).is_some_and(|has| *has);
    let bytes = message.drive_emergency.get(place).copied().unwrap_or(0);
    let sent = optional(has, bytes)
        .ok_or_else(|| format!("drive_emergency[{place}] is not 0, though drive_has_emergency is false"))?;
    Ok(sent.map(|bytes| Emergency::from_bytes(bytes.to_le_bytes())))
}

fn latch(message: &CycleInputs, place: usize, config: &MachineConfig) -> Result<Latch, String> {
    let name = &message.latch_object[place];
    let object = find(name, config).ok_or_else(|| {
        format!("latch_object is `{}`; the cell has no input, encoder or axis of that name", excerpt(name))
    })?;
    let edge = match message.latch_edge[place] {
        CycleInputs::RISING => Edge::Rising,
        CycleInputs::FALLING => Edge::Falling,
        other => return Err(format!("latch_edge of {name} is {other}; 0 (falling) and 1 (rising) are allowed")),
    };
    let age_ns = optional(message.latch_has_age[place], message.latch_age_ns[place])
        .ok_or_else(|| format!("latch_age_ns of {name} is not 0, though latch_has_age is false"))?;
    let position = optional(message.latch_has_position[place], message.latch_position[place])
        .ok_or_else(|| format!("latch_position of {name} is not 0, though latch_has_position is false"))?;
    if let Some(age) = age_ns.filter(|&age| u64::from(age) >= config.cycle_ns) {
        let last = config.cycle_ns.saturating_sub(1);
        return Err(format!("latch_age_ns of {name} is {age}; 0 to {last} is allowed"));
    }
    if age_ns.is_none() && position.is_none() {
        return Err(format!("the latch of {name} has neither age nor position"));
    }
    Ok(Latch { object, edge, age_ns, position })
}

/// Returns an optional value; `None` if a value is given although the flag is false.
fn optional<T: PartialEq + Default>(has: bool, value: T) -> Option<Option<T>> {
    match has {
        true => Some(Some(value)),
        false => (value == T::default()).then_some(None),
    }
}

/// Finds an object that can latch by its name.
fn find(name: &str, config: &MachineConfig) -> Option<Object> {
    let io = || config.io.iter().position(|entry| entry.name == name).map(|place| Object::Io(place as u16));
    let encoder =
        || config.encoders.iter().position(|entry| entry.name == name).map(|place| Object::Encoder(place as u16));
    let axis = || config.axes.iter().position(|entry| entry.name == name).map(|place| Object::Axis(place as u16));
    io().or_else(encoder).or_else(axis)
}

#[cfg(test)]
mod tests;
