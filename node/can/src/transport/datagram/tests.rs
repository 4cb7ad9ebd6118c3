use super::*;
use proptest::prelude::*;

fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::data(Id::new(id).unwrap(), data).unwrap()
}

/// Datagram of python-can 4.6.1 for ID 201h with the data 0F 00 01 02, at time 0.
fn sample() -> Vec<u8> {
    let mut bytes = vec![0x8B];
    let entries: [(&str, &[u8]); 11] = [
        ("timestamp", &[0]),
        ("arbitration_id", &[0xCD, 0x02, 0x01]),
        ("is_extended_id", &[0xC2]),
        ("is_remote_frame", &[0xC2]),
        ("is_error_frame", &[0xC2]),
        ("channel", &[0xC0]),
        ("dlc", &[4]),
        ("data", &[0xC4, 4, 0x0F, 0, 1, 2]),
        ("is_fd", &[0xC2]),
        ("bitrate_switch", &[0xC2]),
        ("error_state_indicator", &[0xC2]),
    ];
    for (key, value) in entries {
        bytes.extend(text(key));
        bytes.extend(value);
    }
    bytes
}

fn text(text: &str) -> Vec<u8> {
    [&[0xA0 | text.len() as u8], text.as_bytes()].concat()
}

fn map(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut bytes = vec![0x80 | entries.len() as u8];
    for (key, value) in entries {
        bytes.extend(text(key));
        bytes.extend(*value);
    }
    bytes
}

#[test]
fn a_frame_is_the_datagram_that_python_can_writes() {
    assert_eq!(sample().len(), 150);
    assert_eq!(Datagram::of(&frame(0x201, &[0x0F, 0, 1, 2])).bytes(), sample());
    assert_eq!(frame_of(&sample()), Ok(Some(frame(0x201, &[0x0F, 0, 1, 2]))));
    assert_eq!(Datagram::of(&frame(0x7FF, &[0xFF; 8])).bytes().len(), 154, "the longest");
}

#[test]
fn any_integer_width_and_key_order_is_read_and_missing_keys_have_defaults() {
    let standard = ("is_extended_id", &[0xC2][..]);
    let widths: [&[u8]; 9] = [
        &[0x05],
        &[0xCC, 5],
        &[0xCD, 0, 5],
        &[0xCE, 0, 0, 0, 5],
        &[0xCF, 0, 0, 0, 0, 0, 0, 0, 5],
        &[0xD0, 5],
        &[0xD1, 0, 5],
        &[0xD2, 0, 0, 0, 5],
        &[0xD3, 0, 0, 0, 0, 0, 0, 0, 5],
    ];
    for width in widths {
        assert_eq!(frame_of(&map(&[("arbitration_id", width), standard])), Ok(Some(frame(5, &[]))));
        assert_eq!(frame_of(&map(&[standard, ("dlc", &[0]), ("arbitration_id", width)])), Ok(Some(frame(5, &[]))));
    }
    assert_eq!(frame_of(&map(&[standard])), Ok(Some(frame(0, &[]))));
    assert_eq!(frame_of(&map(&[])), Ok(None), "identifiers are extended by default");
    for stamp in [&[0xCB, 0x41, 0xD9, 0, 0, 0, 0, 0, 0][..], &[0xCA, 0, 0, 0, 0], &[0xE0], &[0xCE, 1, 2, 3, 4]] {
        assert_eq!(frame_of(&map(&[("timestamp", stamp), standard])), Ok(Some(frame(0, &[]))));
    }
    for channel in [&[0xC0][..], &[0xA2, b'l', b'o'], &[0xD9, 2, b'l', b'o'], &[0xDA, 0, 1, b'x'], &[7]] {
        assert_eq!(frame_of(&map(&[("channel", channel), standard])), Ok(Some(frame(0, &[]))));
    }
    for data in [&[0xC4, 1, 9][..], &[0xC5, 0, 1, 9], &[0xC6, 0, 0, 0, 1, 9]] {
        assert_eq!(frame_of(&map(&[("data", data), standard, ("dlc", &[0xC0])])), Ok(Some(frame(0, &[9]))));
    }
    let twice = map(&[standard, ("arbitration_id", &[1]), ("arbitration_id", &[2])]);
    assert_eq!(frame_of(&twice), Ok(Some(frame(2, &[]))));
    let remote = map(&[standard, ("is_remote_frame", &[0xC3]), ("dlc", &[3])]);
    assert_eq!(frame_of(&remote), Ok(Some(Frame::remote(Id::NMT, 3).unwrap())));
    for wide in [vec![0xDE, 0, 1], vec![0xDF, 0, 0, 0, 1]] {
        assert_eq!(frame_of(&[wide, map(&[standard])[1..].to_vec()].concat()), Ok(Some(frame(0, &[]))));
    }
}

#[test]
fn frames_that_canopen_does_not_use_are_none() {
    for key in ["is_error_frame", "is_fd"] {
        assert_eq!(frame_of(&map(&[("is_extended_id", &[0xC2]), (key, &[0xC3])])), Ok(None));
    }
    assert_eq!(frame_of(&map(&[("arbitration_id", &[0xCE, 0x1F, 0xFF, 0xFF, 0xFF])])), Ok(None));
}

#[test]
fn datagram_refused_by_python_can_is_invalid() {
    let standard = ("is_extended_id", &[0xC2][..]);
    let refused = [
        map(&[("priority", &[1])]),
        map(&[standard, ("arbitration_id", &[0xCD, 8, 0])]),
        map(&[standard, ("arbitration_id", &[0xFF])]),
        map(&[("arbitration_id", &[0xCE, 0x20, 0, 0, 0])]),
        map(&[("arbitration_id", &[0xCF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF])]),
        map(&[("arbitration_id", &[0xC0])]),
        map(&[standard, ("dlc", &[1])]),
        map(&[standard, ("dlc", &[9]), ("data", &[0xC4, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0])]),
        map(&[standard, ("is_remote_frame", &[0xC3]), ("data", &[0xC4, 1, 0])]),
        map(&[("is_remote_frame", &[0xC3]), ("is_fd", &[0xC3])]),
        map(&[("is_extended_id", &[0])]),
        map(&[("data", &[0xA1, b'x'])]),
        map(&[("channel", &[0x90])]),
        [map(&[standard]), vec![0]].concat(),
        map(&[standard])[..5].to_vec(),
        vec![0x81, 0xC4, 1, b'x', 0],
        vec![0xDF, 0xFF, 0xFF, 0xFF, 0xFF],
        b"t20140F000102\r".to_vec(),
        vec![],
    ];
    for datagram in refused {
        assert_eq!(frame_of(&datagram), Err(InvalidDatagram), "{datagram:02X?}");
    }
}

proptest! {
    #[test]
    fn each_frame_comes_back(id in 0_u16..0x800, data in prop::collection::vec(any::<u8>(), 0..=8), remote: bool) {
        let id = Id::new(id).unwrap();
        let frame = match remote {
            true => Frame::remote(id, data.len() as u8).unwrap(),
            false => Frame::data(id, &data).unwrap(),
        };
        prop_assert_eq!(frame_of(Datagram::of(&frame).bytes()), Ok(Some(frame)));
    }

    #[test]
    fn no_bytes_are_too_odd(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = frame_of(&bytes);
    }

    /// A few bytes of a valid datagram are changed, and its end is cut off.
    #[test]
    fn damaged_datagrams_cause_no_panic(changes in prop::collection::vec((0_usize..150, any::<u8>()), 1..4), length in 0_usize..=150) {
        let mut bytes = sample();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        let _ = frame_of(&bytes[..length]);
    }
}
