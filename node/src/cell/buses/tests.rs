use super::*;

#[test]
fn a_frame_has_its_bits() {
    // 135 and 55 are the figures of the field for 8 bytes and none.
    assert_eq!((frame_bits(8), frame_bits(0)), (135, 55));
}
