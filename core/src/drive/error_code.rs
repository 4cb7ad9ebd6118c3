//! Texts of error codes of emergency messages and of 603Fh.
//!
//! Law      a code of the standards has its own text; any other code has the text of its class. Manufacturer-specific codes
//!          have only the text of their class: their meaning is in the manual of the device, and EDS files have no field
//!          for it
//! Source   CiA 301, table of emergency error codes; CiA 402-2, error codes

/// Codes with their own texts.
const CODES: [(u16, &str); 34] = [
    (0x0000, "no error"),
    (0x2310, "over-current at the output"),
    (0x2320, "short circuit at the output"),
    (0x3110, "mains over-voltage"),
    (0x3120, "mains under-voltage"),
    (0x3210, "DC link over-voltage"),
    (0x3220, "DC link under-voltage"),
    (0x4110, "excess ambient temperature"),
    (0x4210, "excess device temperature"),
    (0x4310, "excess drive temperature"),
    (0x5112, "24 V supply"),
    (0x5113, "5 V supply"),
    (0x5530, "data storage (EEPROM)"),
    (0x6010, "software reset (watchdog)"),
    (0x6320, "parameter error"),
    (0x7121, "motor blocked"),
    (0x7300, "sensor"),
    (0x7305, "incremental sensor 1"),
    (0x7380, "position sensor"),
    (0x7500, "communication"),
    (0x8110, "CAN overrun"),
    (0x8120, "CAN error passive"),
    (0x8130, "life guard or heartbeat"),
    (0x8140, "recovered from bus-off"),
    (0x8150, "COB-ID collision"),
    (0x8210, "PDO not processed, wrong length"),
    (0x8220, "PDO too long"),
    (0x8240, "SYNC of an unexpected length"),
    (0x8250, "RPDO missed"),
    (0x8400, "velocity controller"),
    (0x8500, "position controller"),
    (0x8611, "following error"),
    (0x8612, "reference limit"),
    (0x8700, "sync controller"),
];

/// Classes: mask, value, text.
const CLASSES: [(u16, u16, &str); 22] = [
    (0xFF00, 0x0000, "no error"),
    (0xFF00, 0x2100, "current at the input"),
    (0xFF00, 0x2200, "current inside the device"),
    (0xFF00, 0x2300, "current at the output"),
    (0xF000, 0x2000, "current"),
    (0xFF00, 0x3100, "mains voltage"),
    (0xFF00, 0x3200, "voltage inside the device"),
    (0xFF00, 0x3300, "output voltage"),
    (0xF000, 0x3000, "voltage"),
    (0xFF00, 0x4100, "ambient temperature"),
    (0xFF00, 0x4200, "device temperature"),
    (0xF000, 0x4000, "temperature"),
    (0xF000, 0x5000, "device hardware"),
    (0xF000, 0x6000, "device software"),
    (0xF000, 0x7000, "additional modules"),
    (0xFF00, 0x8100, "communication"),
    (0xFF00, 0x8200, "protocol"),
    (0xF000, 0x8000, "monitoring"),
    (0xF000, 0x9000, "external error"),
    (0xFF00, 0xF000, "additional functions"),
    (0xFF00, 0xFF00, "of the vendor"),
    (0xF000, 0x1000, "generic error"),
];

/// Returns the text of an error code (603Fh, emergency messages, 1003h); `None` for a code of no class.
pub fn error_text(code: u16) -> Option<&'static str> {
    let own = CODES.iter().find(|row| row.0 == code).map(|row| row.1);
    own.or_else(|| CLASSES.iter().find(|row| code & row.0 == row.1).map(|row| row.2))
}

/// Bits of the error register (1001h), from bit 0.
const REGISTER: [&str; 8] =
    ["generic", "current", "voltage", "temperature", "communication", "profile", "reserved", "vendor"];

/// Returns the texts of the error register (1001h), one for each bit that is set.
pub fn register_texts(bits: u32) -> impl Iterator<Item = &'static str> {
    REGISTER.iter().enumerate().filter(move |(bit, _)| bits >> bit & 1 == 1).map(|(_, name)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_has_its_own_text_or_that_of_its_class() {
        assert_eq!(error_text(0x8611), Some("following error"));
        assert_eq!(error_text(0x8613), Some("monitoring"));
        assert_eq!(error_text(0x2315), Some("current at the output"));
        assert_eq!(error_text(0x5441), Some("device hardware"));
        assert_eq!(error_text(0xFF12), Some("of the vendor"));
        assert_eq!(error_text(0x1000), Some("generic error"));
        assert_eq!(error_text(0xA000), None);
    }
}
