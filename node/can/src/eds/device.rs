//! Sections of an EDS file about the file, the device and its commissioning.
//!
//! Reads    `[FileInfo]`, `[DeviceInfo]`, `[DeviceComissioning]` (the standard's spelling) and `[DeviceCommissioning]`
//! Refuses  nothing: invalid entries are ignored with a warning
//! Source   CiA 306-1

use super::ini::{Section, Sections};
use super::notes::{Diagnostics, LAST_NODE};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// A section with texts, numbers and flags.
trait Table {
    fn texts(&mut self) -> Vec<(&'static str, &mut String)>;
    /// Key, number, minimum and maximum.
    fn numbers(&mut self) -> Vec<(&'static str, &mut Option<u32>, u32, u32)>;
    fn flags(&mut self) -> Vec<(&'static str, &mut bool)>;

    fn read(&mut self, section: &Section<'_>, notes: &mut Diagnostics) {
        for (key, text) in self.texts() {
            *text = section.get(&key.to_lowercase()).map(|item| item.value.to_owned()).unwrap_or_default();
        }
        for (key, number, least, most) in self.numbers() {
            *number = notes.number(section, &key.to_lowercase(), least, most);
        }
        for (key, flag) in self.flags() {
            *flag = notes.flag(section, &key.to_lowercase());
        }
    }

    fn write(mut self, name: &str, to: &mut String)
    where
        Self: Sized,
    {
        // Writing to a String cannot fail.
        let _ = writeln!(to, "[{name}]");
        for (key, text) in self.texts() {
            if !text.is_empty() {
                let _ = writeln!(to, "{key}={text}");
            }
        }
        for (key, number, ..) in self.numbers() {
            if let Some(number) = number {
                let _ = writeln!(to, "{key}={number}");
            }
        }
        for (key, flag) in self.flags() {
            let _ = writeln!(to, "{key}={}", u8::from(*flag));
        }
    }
}

/// `[FileInfo]` as written; empty texts if keys are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are those of the keys")]
pub struct FileInfo {
    pub file_name: String,
    pub file_version: String,
    pub file_revision: String,
    pub eds_version: String,
    pub description: String,
    pub creation_time: String,
    pub creation_date: String,
    pub created_by: String,
    pub modification_time: String,
    pub modification_date: String,
    pub modified_by: String,
    pub last_eds: String,
}

impl Table for FileInfo {
    fn texts(&mut self) -> Vec<(&'static str, &mut String)> {
        vec![
            ("FileName", &mut self.file_name),
            ("FileVersion", &mut self.file_version),
            ("FileRevision", &mut self.file_revision),
            ("EDSVersion", &mut self.eds_version),
            ("Description", &mut self.description),
            ("CreationTime", &mut self.creation_time),
            ("CreationDate", &mut self.creation_date),
            ("CreatedBy", &mut self.created_by),
            ("ModificationTime", &mut self.modification_time),
            ("ModificationDate", &mut self.modification_date),
            ("ModifiedBy", &mut self.modified_by),
            ("LastEDS", &mut self.last_eds),
        ]
    }

    fn numbers(&mut self) -> Vec<(&'static str, &mut Option<u32>, u32, u32)> {
        vec![]
    }

    fn flags(&mut self) -> Vec<(&'static str, &mut bool)> {
        vec![]
    }
}

/// `[DeviceInfo]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Name of the vendor.
    pub vendor_name: String,
    /// Vendor ID, as in 1018h:01.
    pub vendor_number: Option<u32>,
    /// Name of the product.
    pub product_name: String,
    /// Product code, as in 1018h:02.
    pub product_number: Option<u32>,
    /// Revision number, as in 1018h:03.
    pub revision_number: Option<u32>,
    /// Order code.
    pub order_code: String,
    /// Supported bit rates, in kbit/s.
    pub baud_rates: BTreeSet<u16>,
    /// Bit rates that the file excludes with `BaudRate_..=0`, in kbit/s.
    pub denied_baud_rates: BTreeSet<u16>,
    /// Whether the device is a simple boot-up master.
    pub is_boot_up_master: bool,
    /// Whether the device is a simple boot-up slave.
    pub is_boot_up_slave: bool,
    /// Minimum number of bits that can be mapped.
    pub granularity: Option<u32>,
    /// `DynamicChannelsSupported`.
    pub dynamic_channels: Option<u32>,
    /// `CompactPDO`: PDO objects that exist without a section.
    pub compact_pdo: Option<u32>,
    /// Whether the device supports multiplexed PDOs.
    pub has_group_messaging: bool,
    /// Number of PDOs that the device receives.
    pub receive_pdos: Option<u32>,
    /// Number of PDOs that the device sends.
    pub transmit_pdos: Option<u32>,
    /// Whether the device supports LSS.
    pub has_lss: bool,
}

impl Table for DeviceInfo {
    fn texts(&mut self) -> Vec<(&'static str, &mut String)> {
        vec![
            ("VendorName", &mut self.vendor_name),
            ("ProductName", &mut self.product_name),
            ("OrderCode", &mut self.order_code),
        ]
    }

    fn numbers(&mut self) -> Vec<(&'static str, &mut Option<u32>, u32, u32)> {
        vec![
            ("VendorNumber", &mut self.vendor_number, 0, u32::MAX),
            ("ProductNumber", &mut self.product_number, 0, u32::MAX),
            ("RevisionNumber", &mut self.revision_number, 0, u32::MAX),
            ("Granularity", &mut self.granularity, 0, 64),
            ("DynamicChannelsSupported", &mut self.dynamic_channels, 0, u32::MAX),
            ("CompactPDO", &mut self.compact_pdo, 0, u32::MAX),
            ("NrOfRXPDO", &mut self.receive_pdos, 0, 512),
            ("NrOfTXPDO", &mut self.transmit_pdos, 0, 512),
        ]
    }

    fn flags(&mut self) -> Vec<(&'static str, &mut bool)> {
        vec![
            ("SimpleBootUpMaster", &mut self.is_boot_up_master),
            ("SimpleBootUpSlave", &mut self.is_boot_up_slave),
            ("GroupMessaging", &mut self.has_group_messaging),
            ("LSS_Supported", &mut self.has_lss),
        ]
    }
}

/// `[DeviceComissioning]` of a device configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Commissioning {
    /// Node ID, 1 to 127.
    pub node_id: Option<u32>,
    /// Name of the node.
    pub node_name: String,
    /// Bit rate, in kbit/s.
    pub baud_rate: Option<u32>,
    /// Number of the network.
    pub net_number: Option<u32>,
    /// Name of the network.
    pub network_name: String,
    /// Whether the device is the CANopen manager.
    pub is_manager: bool,
    /// Serial number for LSS.
    pub lss_serial_number: Option<u32>,
}

impl Table for Commissioning {
    fn texts(&mut self) -> Vec<(&'static str, &mut String)> {
        vec![("NodeName", &mut self.node_name), ("NetworkName", &mut self.network_name)]
    }

    fn numbers(&mut self) -> Vec<(&'static str, &mut Option<u32>, u32, u32)> {
        vec![
            ("NodeID", &mut self.node_id, 1, u32::from(LAST_NODE)),
            ("Baudrate", &mut self.baud_rate, 0, 1000),
            ("NetNumber", &mut self.net_number, 0, u32::MAX),
            ("LSS_SerialNumber", &mut self.lss_serial_number, 0, u32::MAX),
        ]
    }

    fn flags(&mut self) -> Vec<(&'static str, &mut bool)> {
        vec![("CANopenManager", &mut self.is_manager)]
    }
}

impl FileInfo {
    pub(super) fn of(sections: &Sections<'_>, notes: &mut Diagnostics) -> Self {
        let mut info = Self::default();
        if let Some(section) = sections.get("fileinfo") {
            info.read(section, notes);
        }
        info
    }

    pub(super) fn write_to(&self, to: &mut String) {
        self.clone().write("FileInfo", to);
    }
}

impl DeviceInfo {
    /// Returns true if the file excludes a bit rate, in kbit/s: with `BaudRate_..=0`, or because it lists only others.
    pub fn denies(&self, rate: u32) -> bool {
        let is_in = |rates: &BTreeSet<u16>| rates.iter().any(|listed| u32::from(*listed) == rate);
        is_in(&self.denied_baud_rates) || (!self.baud_rates.is_empty() && !is_in(&self.baud_rates))
    }

    pub(super) fn of(sections: &Sections<'_>, notes: &mut Diagnostics) -> Self {
        let mut info = Self::default();
        let Some(section) = sections.get("deviceinfo") else {
            notes.warnings.add(None, "the section [DeviceInfo] is missing: vendor and product are not known");
            return info;
        };
        info.read(section, notes);
        for (key, item) in &section.items {
            let Some(rate) = key.strip_prefix("baudrate_") else { continue };
            match rate.parse::<u16>() {
                Ok(rate) => match notes.number(section, key, 0, 1) {
                    Some(0) => {
                        info.denied_baud_rates.insert(rate);
                    }
                    Some(_) => {
                        info.baud_rates.insert(rate);
                    }
                    None => {}
                },
                Err(_) => notes.warning(section, *item, "the key is not BaudRate_ and a number of kbit/s"),
            }
        }
        info
    }

    pub(super) fn write_to(&self, to: &mut String) {
        self.clone().write("DeviceInfo", to);
        for (rates, flag) in [(&self.baud_rates, 1), (&self.denied_baud_rates, 0)] {
            for rate in rates {
                let _ = writeln!(to, "BaudRate_{rate}={flag}");
            }
        }
    }
}

impl Commissioning {
    pub(super) fn of(sections: &Sections<'_>, notes: &mut Diagnostics) -> Option<Self> {
        let section = sections.get("devicecomissioning").or_else(|| sections.get("devicecommissioning"))?;
        let mut commissioning = Self::default();
        commissioning.read(section, notes);
        Some(commissioning)
    }

    pub(super) fn write_to(&self, to: &mut String) {
        self.clone().write("DeviceComissioning", to);
    }
}
