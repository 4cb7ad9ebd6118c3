//! Creates the backends on CAN of a cell, with access to the objects and frames of their devices.

mod objects;

use super::backends::NewBackend;
use crate::cell::{Cell, left_out_of, mode_by_sdo_of};
use crate::document::Problems;
use lineshaft_can::config::BusConfig;
use lineshaft_core::drive::FrameSource;
pub use objects::CanObjects;
use std::path::Path;
use std::sync::Arc;

/// Creates the backends of the CAN buses of a cell, in the order of the cell. `file` is the path of the cell. Warnings
/// and remarks about the devices and their files are logged. `are_kept`: frames of the buses are recorded.
///
/// # Errors
/// Returns the problems of the files, or an error about inputs that homing needs and that are not read.
pub fn backends(cell: &Cell, file: Option<&Path>, are_kept: bool) -> Result<Vec<NewBackend>, String> {
    buses(cell, file)?.into_iter().map(|bus| backend(bus, cell, file, are_kept)).collect()
}

fn buses(cell: &Cell, file: Option<&Path>) -> Result<Vec<BusConfig>, String> {
    let sentences = |problems: Problems| problems.to_string().trim_end().to_owned();
    let (buses, warnings) = cell.on_can().buses_and_warnings(file).map_err(sentences)?;
    let unread = cell.on_can().unread(&buses, file).map_err(sentences)?;
    warnings.iter().chain(&unread).for_each(|warning| tracing::warn!("{warning}"));
    Ok(buses)
}

fn backend(bus: BusConfig, cell: &Cell, file: Option<&Path>, are_kept: bool) -> Result<NewBackend, String> {
    let lines = left_out_of(&bus).into_iter().chain(mode_by_sdo_of(&bus));
    lines.for_each(|line| tracing::info!("{line}"));
    let dictionaries = file.map(|file| cell.on_can().dictionaries(&bus.name, file)).transpose()?;
    let config = bus.clone();
    let (cyclic, mut service) = lineshaft_can::master::bus(bus);
    let objects = CanObjects::new(&config, service.objects(), dictionaries.unwrap_or_default());
    let frames = are_kept.then(|| Box::new(service.frames()) as Box<dyn FrameSource>);
    Ok(NewBackend {
        name: config.name,
        cyclic: Box::new(cyclic),
        service: Box::new(service),
        objects: Some(Arc::new(objects)),
        frames,
    })
}
