//! Writes a dictionary as the text of a file.
//!
//! Law      the written file is read as the same dictionary, without a warning
//! Source   CiA 306-1

use super::dictionary::Dictionary;
use super::object::{Entry, FileValue, ObjectType};
use lineshaft_cia402::dictionary::{DataType, Value};
use std::fmt::Write as _;

/// Returns true if an index belongs to the list of mandatory objects.
fn is_mandatory(index: u16) -> bool {
    matches!(index, 0x1000 | 0x1001 | 0x1018)
}

/// Returns true if an index is in the manufacturer area.
fn is_of_manufacturer(index: u16) -> bool {
    (0x2000..0x6000).contains(&index)
}

impl Dictionary {
    /// Returns the text of the file: an EDS file, or a DCF file if objects have configuration values.
    pub fn to_eds(&self) -> String {
        let mut text = String::new();
        self.write(&mut text);
        text
    }

    // Writing to a String cannot fail, so the results are ignored.
    fn write(&self, to: &mut String) {
        self.file.write_to(to);
        to.push('\n');
        self.device.write_to(to);
        if let Some(commissioning) = &self.commissioning {
            to.push('\n');
            commissioning.write_to(to);
        }
        let _ = writeln!(to, "\n[Comments]\nLines={}", self.comments.len());
        for (number, line) in (1..).zip(&self.comments) {
            let _ = writeln!(to, "Line{number}={line}");
        }
        let _ = writeln!(to, "\n[DummyUsage]");
        for number in (1..8).chain(self.dummies.iter().copied().filter(|number| !(1..8).contains(number))) {
            let _ = writeln!(to, "Dummy{number:04X}={}", u8::from(self.dummies.contains(&number)));
        }
        self.write_list("MandatoryObjects", is_mandatory, to);
        self.write_list("OptionalObjects", |index| !is_mandatory(index) && !is_of_manufacturer(index), to);
        self.write_list("ManufacturerObjects", is_of_manufacturer, to);
        for (index, head) in self.heads() {
            let (name, object_type) = (&head.name, head.object_type.number());
            let _ = writeln!(to, "\n[{index:04X}]\nParameterName={name}\nObjectType=0x{object_type:X}");
            if head.object_type.is_single() {
                self.entries_of(index).for_each(|(_, entry)| write_entry(entry, to));
            } else {
                let _ = writeln!(to, "SubNumber={}", self.entries_of(index).count());
                for (object, entry) in self.entries_of(index) {
                    let (sub, name) = (object.sub, &entry.name);
                    let object_type = ObjectType::Var.number();
                    let _ =
                        writeln!(to, "\n[{index:04X}sub{sub:X}]\nParameterName={name}\nObjectType=0x{object_type:X}");
                    write_entry(entry, to);
                }
            }
        }
    }

    fn write_list(&self, name: &str, is_of_it: fn(u16) -> bool, to: &mut String) {
        let indices: Vec<u16> = self.heads().map(|(index, _)| index).filter(|index| is_of_it(*index)).collect();
        let _ = writeln!(to, "\n[{name}]\nSupportedObjects={}", indices.len());
        for (number, index) in (1..).zip(indices) {
            let _ = writeln!(to, "{number}=0x{index:04X}");
        }
    }
}

fn write_entry(entry: &Entry, to: &mut String) {
    let data_type = entry.data_type;
    let _ = writeln!(to, "DataType=0x{:04X}\nAccessType={}", data_type.number(), entry.access.name());
    let values = [
        ("LowLimit", &entry.low),
        ("HighLimit", &entry.high),
        ("DefaultValue", &entry.default),
        ("ParameterValue", &entry.parameter),
    ];
    for (key, given) in values {
        if let Some(given) = given {
            let _ = writeln!(to, "{key}={}", said(given, data_type));
        }
    }
    let _ = writeln!(to, "PDOMapping={}", u8::from(entry.is_mappable));
    if entry.flags != 0 {
        let _ = writeln!(to, "ObjFlags={}", entry.flags);
    }
}

fn said(given: &FileValue, data_type: DataType) -> String {
    match given {
        FileValue::NodeId { plus } => format!("$NODEID+0x{plus:X}"),
        // COB-IDs and mapped objects are usually read in hexadecimal.
        FileValue::Value(Value::Unsigned(value)) if data_type.bits().is_some_and(|bits| bits > 16) => {
            format!("0x{value:X}")
        }
        FileValue::Value(value) => value.to_string(),
    }
}

#[cfg(test)]
mod tests;
