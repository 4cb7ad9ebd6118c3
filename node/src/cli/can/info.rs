//! `lineshaft can info` and `lineshaft can pdo`.

mod object;

use super::Failure;
use super::args::{InfoArgs, NodeArgs};
use super::open::Known;
use super::table::{columns, word};
use crate::cli::command_output::Output;
use crate::cli::say;
use crate::recording::clean::{clean, clean_lines};
use lineshaft_can::commission::words::{nmt_state, transmission};
use lineshaft_can::commission::{Device, Drive, PdoConfiguration, ReportedState, label};
use lineshaft_can::eds::Dictionary;
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::texts::{self, drive_state};
use lineshaft_core::drive::DriveState;
use serde_json::Value as Json;

pub(super) fn info(args: &InfoArgs, output: &mut Output) -> Result<(), Failure> {
    let args = &args.node;
    let node = args.node;
    for field in ["device", "drive", "pdos"] {
        output.set(field, Json::Null);
    }
    let known = Known::of(&args.bus)?.with_eds(node, args.eds.as_deref())?;
    let mut session = known.open()?;
    let device = session.device(node)?;
    let drive = if device.is_drive() { Some(session.drive(node)?) } else { None };
    let pdos = session.pdos(node)?;
    let heard = session.nmt_state(node, device.heartbeat_ms)?;
    output.set("device", object::of_device(node, &device, heard));
    output.set("drive", drive.as_ref().map_or(Json::Null, object::of_drive));
    output.set("pdos", pdos.iter().map(|pdo| object::of_pdo(pdo, known.dictionary(node))).collect());
    let mut rows = of_device(&device, heard);
    if let Some(drive) = &drive {
        rows.extend(of_drive(drive));
    }
    let rows: Vec<_> = rows.into_iter().map(|(name, value)| vec![name, clean(&value).into_owned()]).collect();
    output.say(&format_args!("{node}\n{}\n\n{}", columns(&rows), clean_lines(&of_pdos(&pdos, known.dictionary(node)))));
    Ok(())
}

pub(super) fn pdo(args: &NodeArgs) -> Result<(), Failure> {
    let node = args.node;
    let known = Known::of(&args.bus)?.with_eds(node, args.eds.as_deref())?;
    let pdos = known.open()?.pdos(node)?;
    say(&clean_lines(&of_pdos(&pdos, known.dictionary(node))));
    Ok(())
}

type Row = (String, String);

fn row(name: &str, value: impl Into<String>) -> Row {
    (name.to_owned(), value.into())
}

fn of_device(device: &Device, heard: ReportedState) -> Vec<Row> {
    let text = |text: &Option<String>| text.clone().unwrap_or_else(|| "-".to_owned());
    let [vendor, product, revision, serial] = device.identity.map(word);
    let [name, hardware, software] = device.texts.each_ref().map(text);
    let kind = device.device_type.map_or_else(
        || "-".to_owned(),
        |device_type| format!("{device_type:08X}h, profile {}", texts::profile(device_type & 0xFFFF)),
    );
    let state = match heard {
        ReportedState::State(state) => nmt_state(state).to_owned(),
        ReportedState::None => "not told: it has no heartbeat (1017h is 0)".to_owned(),
        ReportedState::Silent => "not told: its heartbeat has not come".to_owned(),
    };
    let register = device.register.map(|bits| format!("{bits:02X}h ({})", texts::register(bits)));
    let mut rows = vec![
        row("name", name),
        row("hardware", hardware),
        row("software", software),
        row("device type", kind),
        row("vendor", vendor),
        row("product code", product),
        row("revision number", revision),
        row("serial number", serial),
        row("NMT state", state),
        row("error register", register.unwrap_or_else(|| "-".to_owned())),
    ];
    let errors = device.history.as_deref().unwrap_or_default();
    let error = |error: &u32| {
        let more = if error >> 16 == 0 { String::new() } else { format!(", of the vendor {:04X}h", error >> 16) };
        format!("{}{more}", texts::error(*error as u16))
    };
    match errors {
        [] => rows.push(row("error history", if device.history.is_some() { "none" } else { "-" })),
        [newest, older @ ..] => {
            rows.push(row("error history", error(newest)));
            rows.extend(older.iter().map(|older| row("", error(older))));
        }
    }
    rows
}

fn of_drive(drive: &Drive) -> Vec<Row> {
    let none = || "-".to_owned();
    let status = |status| format!("{} (6041h is {status:04X}h)", drive_state(DriveState::from_status(status)));
    let inputs = |bits| format!("{bits:08X}h ({})", texts::inputs(bits));
    let mut rows = vec![
        row("drive", drive.status.map_or_else(none, status)),
        row("supported modes", drive.modes.map_or_else(none, texts::modes)),
        row("mode", drive.mode.map_or_else(none, texts::mode)),
        row("error code", drive.error.map_or_else(none, texts::error)),
        row("position", drive.position.map_or_else(none, |position| format!("{position} (6064h, units of the drive)"))),
        row("digital inputs", drive.inputs.map_or_else(none, inputs)),
    ];
    for (index, what, values) in &drive.factors {
        let values = match values.as_slice() {
            [unit] if *index >= 0x60A8 => format!("{unit:08X}h"),
            several => several.iter().map(u32::to_string).collect::<Vec<_>>().join(" / "),
        };
        rows.push(row(what, format!("{values} ({index:04X}h)")));
    }
    rows
}

/// Returns a table of PDOs, with their objects below each other.
fn of_pdos(pdos: &[PdoConfiguration], dictionary: Option<&Dictionary>) -> String {
    if pdos.is_empty() {
        return "the device has no PDOs".to_owned();
    }
    let mut rows = vec![["PDO", "COB-ID", "valid", "type", "carries"].map(str::to_owned).to_vec()];
    for pdo in pdos {
        let letter = if pdo.direction == Direction::Transmit { 'T' } else { 'R' };
        let mut kind = pdo.transmission.map_or_else(|| "-".to_owned(), transmission);
        if let Some(inhibit) = pdo.inhibit.filter(|inhibit| *inhibit != 0) {
            kind.push_str(&format!(", inhibit {} us", inhibit * 100));
        }
        if let Some(timer) = pdo.event_timer.filter(|timer| *timer != 0) {
            kind.push_str(&format!(", timer {timer} ms"));
        }
        let mut first = vec![
            format!("{letter}PDO {}", pdo.number),
            format!("{:03X}h", pdo.cob_id.id()),
            if pdo.cob_id.is_valid() { "yes" } else { "no" }.to_owned(),
            kind,
        ];
        let mut carried =
            pdo.mapped.iter().map(|mapped| format!("{}, {} bits", label(mapped.object, dictionary), mapped.bits));
        first.push(carried.next().unwrap_or_else(|| "nothing".to_owned()));
        rows.push(first);
        rows.extend(carried.map(|carried| {
            let mut row = vec![String::new(); 4];
            row.push(carried);
            row
        }));
    }
    columns(&rows)
}
