//! Explains objects of CANopen devices by index or by name: `60FDh`, `0x6041`, `6099:01`, `Statusword`.
//!
//! Law      an index is hexadecimal. `603Fh` may also be the error code of a drive, which codes.rs explains; an object of
//!          CiA 402 that has a name here is not explained as an error code
//! Source   CiA 301, CiA 401, CiA 402-2 and CiA 406, object dictionaries

use super::section;

/// An object, or objects with consecutive indices and the same use.
struct Object {
    /// First and last index.
    indices: (u16, u16),
    /// Standard that defines it.
    standard: &'static str,
    /// Name of the standard.
    name: &'static str,
    /// Use in Lineshaft; empty: none.
    here: &'static str,
}

/// Indices of the objects of profiles, for the first axis of a device.
const PROFILE: std::ops::RangeInclusive<u16> = 0x6000..=0x67FE;

const fn object(index: u16, name: &'static str, here: &'static str) -> Object {
    Object { indices: (index, index), standard: "CiA 402", name, here }
}

const fn of(standard: &'static str, first: u16, last: u16, name: &'static str, here: &'static str) -> Object {
    Object { indices: (first, last), standard, name, here }
}

const HEARTBEAT: &str = "key `heartbeat` of the device";
const GUARDING: &str = "key `guarding` of the device";
const IDENTITY: &str = "compared with key `identity` of the device";
const SCALE: &str = "compared with key `feed` of the drive and with `scale` of the axis";
const PROBES: &str = "keys `probe_1` and `probe_2` of the drive";
const IN_DRIVE: &str = "homing in the drive, key `homing.in_drive`";
const BUS: &str = "CiA 301";
const MODULE: &str = "CiA 401";

/// All objects, by index.
const OBJECTS: &[Object] = &[
    of(BUS, 0x1000, 0x1000, "Device type", "compared at the start of the device: profile in the lower 16 bits"),
    of(BUS, 0x1001, 0x1001, "Error register", "part of each emergency message"),
    of(BUS, 0x1003, 0x1003, "Pre-defined error field", "printed by `lineshaft can info`"),
    of(BUS, 0x1005, 0x1005, "COB-ID SYNC", "written at the start of the device"),
    of(BUS, 0x1006, 0x1006, "Communication cycle period", "written at the start of the device: `cycle` of the cell"),
    of(BUS, 0x1007, 0x1007, "Synchronous window length", ""),
    of(BUS, 0x1008, 0x1008, "Manufacturer device name", "printed by `lineshaft can info`"),
    of(BUS, 0x1009, 0x1009, "Manufacturer hardware version", "printed by `lineshaft can info`"),
    of(BUS, 0x100A, 0x100A, "Manufacturer software version", "printed by `lineshaft can info`"),
    of(BUS, 0x100C, 0x100C, "Guard time", GUARDING),
    of(BUS, 0x100D, 0x100D, "Life time factor", GUARDING),
    of(BUS, 0x1010, 0x1010, "Store parameters", "written by `lineshaft can configure --store`"),
    of(BUS, 0x1011, 0x1011, "Restore default parameters", ""),
    of(BUS, 0x1014, 0x1014, "COB-ID EMCY", ""),
    of(BUS, 0x1015, 0x1015, "Inhibit time EMCY", ""),
    of(
        BUS,
        0x1016,
        0x1016,
        "Consumer heartbeat time",
        "written at the start: the device monitors key `master` of the bus",
    ),
    of(BUS, 0x1017, 0x1017, "Producer heartbeat time", HEARTBEAT),
    of(BUS, 0x1018, 0x1018, "Identity object", IDENTITY),
    of(BUS, 0x1019, 0x1019, "Synchronous counter overflow value", "key `sync_counter` of the bus"),
    of(BUS, 0x1020, 0x1020, "Verify configuration", "shows that the configuration of the device is unchanged"),
    of(BUS, 0x1029, 0x1029, "Error behaviour", ""),
    of(BUS, 0x1200, 0x127F, "SDO server parameter", ""),
    of(BUS, 0x1400, 0x15FF, "RPDO communication parameter", "written at the start of the device"),
    of(BUS, 0x1600, 0x17FF, "RPDO mapping parameter", "written at the start of the device"),
    of(BUS, 0x1800, 0x19FF, "TPDO communication parameter", "written at the start of the device"),
    of(BUS, 0x1A00, 0x1BFF, "TPDO mapping parameter", "written at the start of the device"),
    of(MODULE, 0x6000, 0x6000, "Read input 8-bit", "entries of `io` of type di at a module"),
    of("CiA 406", 0x6004, 0x6004, "Position value", "position of an encoder on CAN"),
    object(0x6007, "Abort connection option code", ""),
    object(0x603F, "Error code", "error code of a fault: axis error 65536 + 603Fh; `8611h` explains a value"),
    object(0x6040, "Controlword", "sent in each cycle; signal output.control"),
    object(0x6041, "Statusword", "received in each cycle; signal drive_state"),
    object(0x6042, "vl target velocity", "setpoint of the drive in mode vl"),
    object(0x6043, "vl velocity demand", ""),
    object(0x6044, "vl velocity actual value", ""),
    object(0x6046, "vl velocity min max amount", ""),
    object(0x6048, "vl velocity acceleration", ""),
    object(0x6049, "vl velocity deceleration", ""),
    object(0x605A, "Quick stop option code", ""),
    object(0x605B, "Shutdown option code", ""),
    object(0x605C, "Disable operation option code", ""),
    object(0x605D, "Halt option code", ""),
    object(0x605E, "Fault reaction option code", ""),
    object(
        0x6060,
        "Modes of operation",
        "keys `interface` and `mode` of the drive: 8 csp, 9 csv, 10 cst, ..; 6 for homing in the drive",
    ),
    object(0x6061, "Modes of operation display", "signal mode_of_operation"),
    object(0x6062, "Position demand value", ""),
    object(0x6063, "Position actual internal value", ""),
    object(0x6064, "Position actual value", "received in each cycle; signal actual.count"),
    object(0x6065, "Following error window", "monitored by the drive; that of the axis is `max_following_error`"),
    object(0x6066, "Following error time out", "monitored by the drive; that of the axis is `following_error_time`"),
    object(0x6067, "Position window", "monitored by the drive; that of the axis is `in_position_window`"),
    object(0x6068, "Position window time", ""),
    object(0x6069, "Velocity sensor actual value", ""),
    object(0x606B, "Velocity demand value", ""),
    object(0x606C, "Velocity actual value", ""),
    object(0x606D, "Velocity window", ""),
    object(0x606E, "Velocity window time", ""),
    object(0x606F, "Velocity threshold", ""),
    object(0x6070, "Velocity threshold time", ""),
    object(0x6071, "Target torque", "setpoint of the drive in modes cst and tq"),
    object(0x6072, "Max torque", "limit of the drive; set it in key `startup`"),
    object(0x6073, "Max current", ""),
    object(0x6074, "Torque demand", ""),
    object(0x6075, "Motor rated current", ""),
    object(0x6076, "Motor rated torque", "key `rated_effort` of the drive"),
    object(
        0x6077,
        "Torque actual value",
        "signal actual.effort, with key `rated_effort` of the drive or interface torque",
    ),
    object(0x6078, "Current actual value", ""),
    object(0x6079, "DC link circuit voltage", ""),
    object(0x607A, "Target position", "setpoint of the drive in modes csp and pp"),
    object(0x607B, "Position range limit", ""),
    object(0x607C, "Home offset", "must be 0 for homing in the drive; that of the axis is `homing.offset`"),
    object(
        0x607D,
        "Software position limit",
        "monitored by the drive; those of the axis are `min_position` and `max_position`",
    ),
    object(0x607E, "Polarity", ""),
    object(0x607F, "Max profile velocity", "limit of the drive; that of the axis is `max_velocity`"),
    object(0x6080, "Max motor speed", "limit of the drive; set it in key `startup` for modes cst and tq"),
    object(0x6081, "Profile velocity", "profile of the drive in mode pp; set it in key `startup`"),
    object(0x6082, "End velocity", ""),
    object(0x6083, "Profile acceleration", "profile of the drive in modes pp and pv; set it in key `startup`"),
    object(0x6084, "Profile deceleration", "profile of the drive in modes pp and pv; set it in key `startup`"),
    object(0x6085, "Quick stop deceleration", "ramp of a quick stop in the drive; set it in key `startup`"),
    object(0x6086, "Motion profile type", ""),
    object(0x6087, "Torque slope", "ramp of the drive in mode tq; set it in key `startup`"),
    object(0x608F, "Position encoder resolution", SCALE),
    object(0x6090, "Velocity encoder resolution", ""),
    object(0x6091, "Gear ratio", SCALE),
    object(0x6092, "Feed constant", SCALE),
    object(0x6098, "Homing method", IN_DRIVE),
    object(0x6099, "Homing speeds", IN_DRIVE),
    object(0x609A, "Homing acceleration", IN_DRIVE),
    object(0x60B0, "Position offset", ""),
    object(0x60B1, "Velocity offset", ""),
    object(0x60B2, "Torque offset", ""),
    object(0x60B8, "Touch probe function", PROBES),
    object(0x60B9, "Touch probe status", ""),
    object(0x60BA, "Touch probe 1 positive edge", PROBES),
    object(0x60BB, "Touch probe 1 negative edge", PROBES),
    object(0x60BC, "Touch probe 2 positive edge", PROBES),
    object(0x60BD, "Touch probe 2 negative edge", PROBES),
    object(0x60C0, "Interpolation sub mode select", ""),
    object(0x60C1, "Interpolation data record", "setpoint of the drive in mode ip"),
    object(0x60C2, "Interpolation time period", "written at the start of the drive: `cycle` of the cell"),
    object(0x60C5, "Max acceleration", ""),
    object(0x60C6, "Max deceleration", ""),
    object(0x60D5, "Touch probe 1 positive edge counter", PROBES),
    object(0x60D6, "Touch probe 1 negative edge counter", PROBES),
    object(0x60D7, "Touch probe 2 positive edge counter", PROBES),
    object(0x60D8, "Touch probe 2 negative edge counter", PROBES),
    object(0x60E0, "Positive torque limit value", ""),
    object(0x60E1, "Negative torque limit value", ""),
    object(0x60E3, "Supported homing methods", ""),
    object(0x60E6, "Additional position encoder resolution", ""),
    object(0x60F4, "Following error actual value", "of the drive; that of the axis is signal following_error"),
    object(0x60FA, "Control effort", ""),
    object(0x60FC, "Position demand internal value", ""),
    object(
        0x60FD,
        "Digital inputs",
        "bit 0 negative limit switch, 1 positive limit switch, 2 reference switch; each bit may be an entry of `io` of type di",
    ),
    object(0x60FE, "Digital outputs", "entries of `io` of type do at a drive"),
    object(0x60FF, "Target velocity", "setpoint of the drive in modes csv and pv"),
    of(MODULE, 0x6200, 0x6200, "Write output 8-bit", "entries of `io` of type do at a module"),
    of(MODULE, 0x6401, 0x6401, "Read analogue input 16-bit", "entries of `io` of type ai at a module"),
    of(MODULE, 0x6411, 0x6411, "Write analogue output 16-bit", "entries of `io` of type ao at a module"),
    object(0x6502, "Supported drive modes", "compared at the start of the drive with its mode"),
];

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let index = index(name);
    let is_it =
        |object: &&Object| index.is_some_and(|index| object.has(index)) || object.name.eq_ignore_ascii_case(name);
    let found: Vec<String> =
        OBJECTS.iter().filter(is_it).map(|object| text(object, index.unwrap_or(object.indices.0), width)).collect();
    match index {
        Some(index) if found.is_empty() && PROFILE.contains(&index) => vec![unnamed(index, width)],
        _ => found,
    }
}

pub(super) fn names() -> Vec<String> {
    OBJECTS.iter().map(|object| object.name.to_owned()).collect()
}

/// Whether the number is the index of an object of drives that is in the table. Objects of modules and encoders may also be error codes of
/// drives (6200h).
pub(super) fn is_of_drive_profile(index: u16) -> bool {
    PROFILE.contains(&index) && OBJECTS.iter().any(|object| object.standard == "CiA 402" && object.has(index))
}

impl Object {
    fn has(&self, index: u16) -> bool {
        (self.indices.0..=self.indices.1).contains(&index)
    }
}

/// Returns the index of an object: `60FDh`, `0x60FD`, `60FD`, each also with a subindex, `6099h:01`. Without `h`, `0x`
/// and subindex only an index of a profile is one, since other numbers are codes.
fn index(name: &str) -> Option<u16> {
    let small = name.to_lowercase();
    let (text, sub) = small.split_once(':').map_or((small.as_str(), None), |(text, sub)| (text, Some(sub)));
    let is_hex = |text: &str| text.chars().all(|digit| digit.is_ascii_hexdigit());
    if sub.is_some_and(|sub| !(1..=2).contains(&sub.len()) || !is_hex(sub)) {
        return None;
    }
    let marked = text.strip_prefix("0x").or_else(|| text.strip_suffix('h'));
    let digits = marked.unwrap_or(text);
    let number = u16::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 4 && is_hex(digits))?;
    (marked.is_some() || sub.is_some() || PROFILE.contains(&number)).then_some(number)
}

fn text(object: &Object, index: u16, width: usize) -> String {
    let facts: [(&str, &str); 3] = [("name", object.name), ("here", object.here), ("documented", "docs/can.md")];
    section(&format!("{index:04X}h: an object of {}", object.standard), &facts, width)
}

/// Explains an object of a profile without a name here. Error codes of drives are in the same range.
fn unnamed(index: u16, width: usize) -> String {
    let facts: [(&str, &str); 2] = [
        ("what", "an object that Lineshaft does not use, or an error code; the manual of the device has it"),
        ("documented", "docs/can.md"),
    ];
    section(&format!("{index:04X}h: an object of a device profile"), &facts, width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_can::can_objects;
    use lineshaft_cia402::objects as used;
    use std::path::Path;

    #[test]
    fn objects_are_sorted_and_there_once() {
        for pair in OBJECTS.windows(2) {
            assert!(pair[0].indices.1 < pair[1].indices.0, "{:04X}h", pair[1].indices.0);
        }
    }

    #[test]
    fn index_is_read_in_each_format() {
        for name in ["60FDh", "60fdh", "0x60FD", "60FD", "60FDh:00", "60FD:0", "0x60FD:1"] {
            assert_eq!(index(name), Some(0x60FD), "{name}");
        }
        assert_eq!((index("1018h"), index("1018:01"), index("1018")), (Some(0x1018), Some(0x1018), None));
        for none in ["", "h", "0x", "60FDhh", "+0FDh", "060FDh", "6FDh", "60FD:", "60FD:001", "60FD:x", "each", "8611"]
        {
            assert_eq!(index(none), None, "{none}");
        }
    }

    /// Names are those of the EDS file of the simulated drive.
    #[test]
    fn names_are_those_of_the_standard() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/can/cia402_sim.eds");
        let (eds, mut index, mut count) = (std::fs::read_to_string(path).unwrap(), None, 0);
        for line in eds.lines().map(str::trim) {
            if let Some(head) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
                index = u16::from_str_radix(head, 16).ok();
            } else if let Some((index, name)) = index.zip(line.strip_prefix("ParameterName="))
                && PROFILE.contains(&index)
            {
                let object = OBJECTS.iter().find(|object| object.has(index));
                assert_eq!(object.map(|object| object.name), Some(name), "{index:04X}h");
                count += 1;
            }
        }
        assert!(count > 50, "{count}");
    }

    #[test]
    fn objects_that_the_master_uses_are_explained() {
        let arrays = [used::ENCODER_RESOLUTION, used::GEAR_RATIO, used::FEED_CONSTANT].into_iter().flatten();
        let single = [
            used::DEVICE_TYPE,
            used::VENDOR,
            can_objects::MODULE_INPUTS,
            can_objects::MODULE_OUTPUTS,
            can_objects::MODULE_ANALOG_INPUTS,
            can_objects::MODULE_ANALOG_OUTPUTS,
            can_objects::ENCODER_POSITION,
            used::ERROR_CODE,
            used::CONTROL_WORD,
            used::STATUS_WORD,
            used::VL_TARGET_VELOCITY,
            used::MODE,
            used::MODE_DISPLAY,
            used::POSITION,
            used::VELOCITY,
            used::TARGET_TORQUE,
            used::TORQUE,
            used::TARGET_POSITION,
            used::HOMING_METHOD,
            used::HOMING_SEARCH,
            used::HOMING_ACCELERATION,
            used::TOUCH_PROBE_FUNCTION,
            used::TOUCH_PROBE_POSITION,
            used::TOUCH_PROBE_COUNT,
            used::INTERPOLATION_POSITION,
            used::INTERPOLATION_VALUE,
            used::DIGITAL_INPUTS,
            used::DIGITAL_OUTPUTS,
            used::TARGET_VELOCITY,
            used::SUPPORTED_MODES,
        ];
        for object in arrays.chain(single) {
            assert!(OBJECTS.iter().any(|known| known.has(object.index)), "{:04X}h", object.index);
        }
    }
}
