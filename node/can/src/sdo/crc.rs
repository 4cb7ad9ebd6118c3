//! Checksum of block transfers: CRC-16/XMODEM, polynomial 1021h, initial value 0.

/// Returns the checksum of bytes that follow bytes with checksum `before`.
pub(super) fn crc(before: u16, bytes: &[u8]) -> u16 {
    bytes.iter().fold(before, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte) << 8, |crc, _| {
            let shifted = crc << 1;
            if crc & 0x8000 == 0 { shifted } else { shifted ^ 0x1021 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::crc;

    /// Check value of the catalogue of parametrised CRC algorithms.
    #[test]
    fn nine_digits_have_the_check_value() {
        assert_eq!(crc(0, b"123456789"), 0x31C3);
        assert_eq!(crc(crc(0, b"1234"), b"56789"), 0x31C3);
        assert_eq!(crc(0, b""), 0);
    }
}
