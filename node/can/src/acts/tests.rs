use super::*;
use crate::eds;

fn at(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Returns the indices that are left out for a reason in at least one of subindices 0 to 3.
fn all(profile: Option<u16>, wanted: LeftOutReason) -> Vec<u16> {
    let is_it = |index: &u16| (0..=3).any(|sub| reason(at(*index, sub), profile) == Some(wanted));
    (0x1000..=0xFFFF).filter(is_it).collect()
}

/// Objects from CiA 301 (1003h, 1010h, 1011h, 1013h, 1023h to 1026h), CiA 302-2 (1F82h, 1F83h) and CiA 302-3 (1F25h, 1F50h, 1F51h).
#[test]
fn objects_that_act_in_each_device_are_left_out() {
    let acting: [u16; 12] =
        [0x1003, 0x1010, 0x1011, 0x1023, 0x1024, 0x1025, 0x1026, 0x1F25, 0x1F50, 0x1F51, 0x1F82, 0x1F83];
    // The tests below cover the objects that a profile adds.
    let common = |profile| all(profile, Acts).into_iter().filter(|index| *index < 0x2000).collect::<Vec<_>>();
    for profile in [None, Some(401), Some(402), Some(406), Some(404)] {
        assert_eq!(common(profile), acting, "{profile:?}");
        assert_eq!(reason(at(0x1013, 0), profile), Some(Setpoint), "{profile:?}");
        // Heartbeat, SYNC, identity, 1020h, PDOs, boot of an NMT master, the concise DCF: they store values.
        for index in [0x1005, 0x1014, 0x1016, 0x1017, 0x1018, 0x1019, 0x1020, 0x1400, 0x1A00, 0x1F22, 0x1F80, 0x1F81] {
            assert_eq!(reason(at(index, 0), profile), None, "{profile:?} {index:04X}h");
        }
        // Manufacturer objects, and objects above the profile area.
        for index in [0x2000, 0x2040, 0x5FFF, 0xA000, 0xA040, 0xFFFF] {
            assert_eq!(reason(at(index, 0), profile), None, "{profile:?} {index:04X}h");
        }
    }
    assert_eq!(reason(at(0x1003, 1), None), None, "only the number of errors clears the history");
    assert_eq!(reason(at(0x1010, 4), Some(402)), Some(Acts), "each of its subindices");
}

/// CiA 402-2: up to 8 axes, each 800h higher.
#[test]
fn control_word_and_setpoints_of_all_axes_of_a_drive_are_left_out() {
    let of_axis: [u16; 9] = [0x6042, 0x6071, 0x607A, 0x60B0, 0x60B1, 0x60B2, 0x60C1, 0x60FE, 0x60FF];
    let axes = (0..8_u16).map(|axis| axis * 0x800);
    let setpoints: Vec<u16> = axes.clone().flat_map(|begin| of_axis.map(|index| index + begin)).collect();
    let found = |wanted| all(Some(402), wanted).into_iter().filter(|index| *index >= 0x6000).collect::<Vec<_>>();
    assert_eq!(found(Setpoint), setpoints);
    assert_eq!(found(Acts), axes.map(|begin| 0x6040 + begin).collect::<Vec<_>>());
    // 60FEh:02 is the mask of the outputs; 6410h contains motor data in a drive.
    for object in [at(0x60FE, 2), at(0x68FE, 2), at(0x6410, 1), at(0x6003, 0), at(0x6200, 1), at(0x6060, 0)] {
        assert_eq!(reason(object, Some(402)), None, "{object}");
    }
}

/// CiA 401: outputs, but neither their error reactions (6206h, 6207h, 6443h, 6444h) nor filters (6003h).
#[test]
fn outputs_of_module_are_left_out_and_error_reactions_are_written() {
    let outputs: [u16; 16] = [
        0x6200, 0x6220, 0x6221, 0x6222, 0x6223, 0x6224, 0x6225, 0x6226, 0x6227, 0x6300, 0x6320, 0x6410, 0x6411, 0x6412,
        0x6413, 0x6414,
    ];
    let found: Vec<u16> =
        all(Some(401), Setpoint).into_iter().filter(|index| (0x6000..0x6800).contains(index)).collect();
    assert_eq!(found, outputs);
    for index in [0x6003, 0x6040, 0x60FF, 0x6206, 0x6207, 0x6240, 0x6423, 0x6443, 0x6444] {
        assert_eq!(reason(at(index, 1), Some(401)), None, "{index:04X}h");
    }
}

/// CiA 406: a write of a preset changes the position. 6200h is the cyclic timer, 6320h a cam limit.
#[test]
fn presets_of_encoder_are_left_out_and_cyclic_timer_is_written() {
    let found: Vec<u16> = all(Some(406), Acts).into_iter().filter(|index| (0x6000..0x6800).contains(index)).collect();
    assert_eq!(found, [0x6003_u16, 0x6009, 0x6010]);
    for index in [0x6000, 0x6001, 0x6002, 0x6200, 0x6300, 0x6320] {
        assert_eq!(reason(at(index, 0), Some(406)), None, "{index:04X}h");
    }
}

#[test]
fn objects_that_act_in_any_profile_are_left_out_for_unknown_profile() {
    for profile in [None, Some(408)] {
        for (object, expected) in [
            (at(0x6040, 0), Some(Acts)),
            (at(0x60FF, 0), Some(Setpoint)),
            (at(0x6200, 1), Some(Setpoint)),
            (at(0x6003, 0), Some(Acts)),
            (at(0x6083, 0), None),
        ] {
            assert_eq!(reason(object, profile), expected, "{profile:?} {object}");
        }
    }
}

/// A drive whose second logical device is an output module. The dictionary has no device type for the third one.
#[test]
fn each_logical_device_has_its_own_profile() {
    assert_eq!(device_type(0x5FFF), None);
    assert_eq!(device_type(0xA000), None);
    assert_eq!(device_type(0x67FF), Some(at(0x1000, 0)));
    assert_eq!(device_type(0x6800), Some(at(0x6FFF, 0)));
    assert_eq!(device_type(0x9FFF), Some(at(0x9FFF, 0)));
    assert_eq!([profile_number(0xFFFF_0192), profile_number(0x0002_0000)], [Some(402), None]);
    let file = "[DeviceInfo]\n[6FFF]\nDataType=7\nAccessType=ro\nDefaultValue=0x00020191\n";
    let dictionary = eds::parse(file.as_bytes(), Some(3)).expect("it is right");
    let of = |index| profile_of(&dictionary, index, Some(402));
    assert_eq!([of(0x6040), of(0x6A00), of(0x7040), of(0x2000)], [Some(402), Some(401), Some(402), Some(402)]);
    assert_eq!(reason(at(0x6A00, 1), of(0x6A00)), Some(Setpoint));
    assert_eq!(reason(at(0x6840, 0), of(0x6840)), None);
    assert_eq!(reason(at(0x7040, 0), of(0x7040)), Some(Acts));
}

#[test]
fn display_lists_left_out_objects_with_reasons() {
    let acting = [at(0x1010, 1), at(0x1010, 2), at(0x1010, 3), at(0x1011, 4), at(0x6040, 0)];
    let setpoints = [at(0x607A, 0), at(0x60FE, 1), at(0x60FF, 0)];
    let of = |objects: &[Object]| {
        objects.iter().map(|object| (*object, reason(*object, Some(402)).unwrap())).collect::<Vec<_>>()
    };
    let both = LeftOut(of(&[&acting[..], &setpoints[..]].concat()));
    let line = "as objects that act: 1010h:01 to 03, 1011h:04, 6040h:00; as setpoints: 607Ah:00, 60FEh:01, 60FFh:00";
    assert_eq!(both.to_string(), line);
    assert_eq!(LeftOut(of(&setpoints[1..])).to_string(), "as setpoints: 60FEh:01, 60FFh:00");
    assert!(LeftOut::default().is_empty() && !both.is_empty());
}
