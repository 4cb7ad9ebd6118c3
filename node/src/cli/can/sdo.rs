//! `lineshaft can sdo`.

use super::Failure;
use super::args::{ReadArgs, WriteArgs};
use super::open::Known;
use crate::cli::say;
use crate::progress::{MOMENT, Progress};
use crate::recording::clean::clean;
use lineshaft_can::commission::{LONGEST, check_readable, decoded, encoded, label, type_of, writable};
use lineshaft_cia402::dictionary::{DataType, Value};
use lineshaft_cia402::texts::hex;
use lineshaft_ros::layer::open_file;
use std::io::Read;
use std::path::Path;

pub(super) fn read(args: &ReadArgs) -> Result<(), Failure> {
    let node = args.node.node;
    let known = Known::of(&args.node.bus)?.with_eds(node, args.node.eds.as_deref())?;
    let object = known.object(node, &args.object)?;
    let dictionary = known.dictionary(node);
    check_readable(object, dictionary)?;
    let data_type = type_of(object, args.kind, dictionary)?;
    // Block transfer is used for data that may be long.
    let is_long = matches!(data_type, Some(DataType::Domain | DataType::OctetString));
    let in_blocks = args.file.is_some() || is_long;
    let mut progress = Progress::new("bytes", MOMENT);
    let read = known.open()?.read_with(node, object, in_blocks, &mut |done, of| progress.set(done, of));
    drop(progress);
    let (bytes, label) = (read?, label(object, dictionary));
    if let Some(path) = &args.file {
        let file = path.display();
        std::fs::write(path, &bytes)
            .map_err(|error| Failure::Usage(format!("--file {file} cannot be written: {error}")))?;
        say(&clean(&format!("{label}: {} bytes to {file}", bytes.len())));
        return Ok(());
    }
    let Some(data_type) = data_type else {
        say(&clean(&format!("{label} = {}", raw(&bytes))));
        return Ok(());
    };
    match decoded(object, &bytes, data_type, dictionary) {
        Ok(value) => {
            say(&clean(&format!("{label} = {} ({data_type})", shown(&value))));
            Ok(())
        }
        Err(refusal) => Err(Failure::Bus(format!("{refusal}: {node} has answered {}", raw(&bytes)))),
    }
}

pub(super) fn write(args: &WriteArgs) -> Result<(), Failure> {
    let node = args.node.node;
    let known = Known::of(&args.node.bus)?.with_eds(node, args.node.eds.as_deref())?;
    let object = known.object(node, &args.object)?;
    let dictionary = known.dictionary(node);
    let given = args.kind;
    let (bytes, shown) = match (&args.file, &args.value) {
        (Some(path), _) => {
            writable(object, dictionary)?;
            let data_type = type_of(object, given, dictionary)?.unwrap_or(DataType::Domain);
            let bytes = from_file(path)?;
            decoded(object, &bytes, data_type, dictionary)?;
            let count = bytes.len();
            (bytes, format!("{count} bytes of {}", path.display()))
        }
        (None, value) => {
            let value = value.as_deref().unwrap_or_default();
            (encoded(object, value, given, dictionary)?, value.to_owned())
        }
    };
    let mut progress = Progress::new("bytes", MOMENT);
    let written = known.open()?.write_with(node, object, &bytes, &mut |done, of| progress.set(done, of));
    drop(progress);
    written?;
    say(&clean(&format!("{} is {shown} now", label(object, dictionary))));
    Ok(())
}

/// Formats a value; a positive number in hexadecimal as well.
fn shown(value: &Value) -> String {
    match value {
        Value::Unsigned(number) if *number > 9 => format!("{number}, {number:X}h"),
        // Texts are padded with zeros on the bus.
        Value::Text(text) => format!("{:?}", text.trim_end_matches('\0')),
        Value::Bytes(bytes) => hex(bytes),
        other => other.to_string(),
    }
}

/// Formats bytes of unknown type, with the number or the text that they may be.
fn raw(bytes: &[u8]) -> String {
    let number = bytes.iter().rev().fold(0_u64, |number, byte| number << 8 | u64::from(*byte));
    match bytes.len() {
        0 => "no bytes".to_owned(),
        1 | 2 | 4 | 8 => format!("{} ({number})", hex(bytes)),
        _ => match std::str::from_utf8(bytes).ok().filter(|text| text.chars().all(|letter| !letter.is_control())) {
            Some(text) => format!("{} ({text:?})", hex(bytes)),
            None => hex(bytes),
        },
    }
}

fn from_file(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let read = open_file(path).and_then(|file| file.take(LONGEST as u64 + 1).read_to_end(&mut bytes));
    let file = path.display();
    match read {
        Err(error) => Err(Failure::Usage(format!("--file {file} cannot be read: {error}"))),
        Ok(_) if bytes.len() > LONGEST => {
            Err(Failure::Usage(format!("--file {file} is longer than {LONGEST} bytes (16 MiB)")))
        }
        Ok(_) => Ok(bytes),
    }
}
