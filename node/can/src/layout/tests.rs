//! Tests of layouts: what is mapped with and without a dictionary, and what is refused.

use super::*;
use crate::eds;
use lineshaft_cia402::mapping::Unmapped;
use lineshaft_cia402::probe::{self, Slot};

fn node() -> NodeId {
    NodeId::new(3).expect("1 to 127")
}

fn told(layout: &Layout) -> Vec<(u8, u16, u8, Vec<ReportedValue>)> {
    let of = |pdo: &Pdo<ReportedValue>| {
        let words = pdo.fields.iter().map(|field| field.word).collect();
        (pdo.number, pdo.id.get(), pdo.transmission.number(), words)
    };
    layout.told.iter().map(of).collect()
}

/// Process data of each cycle has 7 bytes in each direction.
#[test]
fn only_required_objects_are_mapped_without_dictionary() {
    let layout = Layout::plan(node(), DriveMode::Csp, Extras::default(), &Terminals::default(), None).unwrap();
    assert_eq!(
        told(&layout),
        [(1, 0x183, 1, vec![ReportedValue::Status, ReportedValue::Position, ReportedValue::Mode])]
    );
    let [asked] = layout.asked.as_slice() else { panic!("{:?}", layout.asked) };
    assert_eq!((asked.number, asked.id.get(), asked.bytes()), (1, 0x203, 7));
    let objects: Vec<_> = asked.fields.iter().map(|field| field.object.index).collect();
    assert_eq!(objects, [0x6040, 0x607A, 0x6060]);
    let velocity = Layout::plan(node(), DriveMode::Csv, Extras::default(), &Terminals::default(), None).unwrap();
    assert_eq!(velocity.asked[0].fields[1].object.index, 0x60FF);
}

/// Digital inputs and error code are sent on change if the drive has them.
#[test]
fn mappable_optional_objects_are_mapped() {
    let text = include_bytes!("../../../../launch-configs/can/cia402_sim.eds");
    let known = eds::parse(text, Some(3)).unwrap();
    let layout = Layout::plan(node(), DriveMode::Csp, Extras::default(), &Terminals::default(), Some(&known)).unwrap();
    let cyclic = (1, 0x183, 1, vec![ReportedValue::Status, ReportedValue::Position, ReportedValue::Mode]);
    assert_eq!(told(&layout), [cyclic, (2, 0x283, 255, vec![ReportedValue::Inputs, ReportedValue::Fault])]);
}

/// 60FDh is UNSIGNED32, 603Fh is UNSIGNED16 (CiA 402-2). With entries of `io`, 60FDh is required, and `check` refuses its type.
#[test]
fn optional_object_with_wrong_type_or_access_is_not_mapped() {
    let text = include_str!("../../../../launch-configs/can/cia402_sim.eds");
    let seldom = |section: &str, from: &str, to: &str| {
        let at = text.find(&format!("[{section}]")).unwrap();
        let text = format!("{}{}", &text[..at], text[at..].replacen(from, to, 1));
        let known = eds::parse(text.as_bytes(), Some(3)).unwrap();
        let plan = |terminals: &Terminals| {
            Layout::plan(node(), DriveMode::Csp, Extras::default(), terminals, Some(&known)).unwrap()
        };
        let needed = plan(&Terminals { digital_inputs: vec![terminal(16)], ..Terminals::default() });
        assert_eq!(told(&needed)[1], (2, 0x283, 1, vec![ReportedValue::Inputs]), "{section}");
        told(&plan(&Terminals::default())).swap_remove(1)
    };
    let both = (2, 0x283, 255, vec![ReportedValue::Inputs, ReportedValue::Fault]);
    assert_eq!(seldom("60FD", "DataType=0x0007", "DataType=0x0004"), both, "the sign makes no difference");
    for (from, to) in [("DataType=0x0007", "DataType=0x0006"), ("AccessType=ro", "AccessType=wo")] {
        assert_eq!(seldom("60FD", from, to), (2, 0x283, 255, vec![ReportedValue::Fault]), "{to}");
    }
    for (from, to) in [("DataType=0x0006", "DataType=0x0007"), ("AccessType=ro", "AccessType=wo")] {
        assert_eq!(seldom("603F", from, to), (2, 0x283, 255, vec![ReportedValue::Inputs]), "{to}");
    }
}

/// A drive with torque interface reports its torque in each cycle, whatever extras are selected.
#[test]
fn torque_interface_maps_target_and_actual_torque() {
    for mode in [DriveMode::Cst, DriveMode::Tq] {
        let plan = |dictionary| Layout::plan(node(), mode, Extras::default(), &Terminals::default(), dictionary);
        let layout = plan(None).unwrap();
        let words: Vec<_> = layout.asked[0].fields.iter().map(|field| (field.object.index, field.bits)).collect();
        assert_eq!(words, [(0x6040, 16), (0x6071, 16), (0x6060, 8)]);
        let cyclic = (1, 0x183, 1, vec![ReportedValue::Status, ReportedValue::Position, ReportedValue::Mode]);
        assert_eq!(told(&layout), [cyclic, (2, 0x283, 1, vec![ReportedValue::Torque])]);
        let known = dictionary_without(&["6077"]);
        let refused = MappingError::NotMappable(objects::TORQUE, Unmapped::NotMappable, mode.name()).into();
        assert_eq!(plan(Some(&known)).err(), Some(refused));
    }
}

/// Servostar: control word and reference of 4 bytes; status word and position of 4 bytes. AKD: fields of 2, 4, 2 bytes; 2, 2, 2, 2
/// bytes.
///
/// Proves: MACS-CAN-11, MACS-CAN-12
#[test]
fn pdo_1_has_fields_of_drive_type() {
    let lengths = |value| {
        let layout = Layout::of_drive_type(node(), DriveType::decode(value).unwrap()).unwrap();
        let (asked, told) = (&layout.asked[0], &layout.told[0]);
        let bits = |fields: &mut dyn Iterator<Item = u32>| fields.map(|bits| bits / 8).collect::<Vec<_>>();
        assert_eq!((asked.id.get(), told.id.get(), asked.is_mapped), (0x203, 0x183, told.is_mapped));
        let asked_bits = bits(&mut asked.fields.iter().map(|field| field.bits));
        (asked_bits, bits(&mut told.fields.iter().map(|field| field.bits)), asked.is_mapped)
    };
    assert_eq!(lengths(2), (vec![2, 4], vec![2, 4], true));
    assert_eq!(lengths(-4), lengths(3));
    assert_eq!(lengths(11), (vec![2, 4], vec![2, 4], false));
    assert_eq!(lengths(-13), (vec![2, 4, 2], vec![2, 2, 2, 2], false));
}

/// 64 bits fit in a PDO; one more bit needs a second PDO.
#[test]
fn pdo_is_filled_to_64_bits() {
    let lengths = |bits: &[u32]| {
        let field = |bits: &u32| Field::reported(ReportedValue::Status, objects::STATUS_WORD, *bits);
        let fields: Vec<_> = bits.iter().map(field).collect();
        pack(&fields, Transmission::EachSync, 1, |number| node().tpdo(number))
            .map(|pdos| pdos.iter().map(Pdo::bits).collect::<Vec<_>>())
    };
    assert_eq!(lengths(&[32, 32, 8]), Ok(vec![64, 8]));
    assert_eq!(lengths(&[32, 33]), Ok(vec![32, 33]));
    assert_eq!(lengths(&[64; 4]), Ok(vec![64; 4]));
    assert_eq!(lengths(&[64; 5]), Err(LayoutError::TooMany));
}

#[test]
fn a_drive_that_cannot_map_its_target_is_refused() {
    let known = dictionary_without(&["607A"]);
    let error =
        Layout::plan(node(), DriveMode::Csp, Extras::default(), &Terminals::default(), Some(&known)).unwrap_err();
    let sentence =
        "607Ah:00 cannot be mapped to a PDO, by the dictionary of the drive; mode csp needs it in each cycle";
    assert_eq!(error.to_string(), sentence);
    assert!(Layout::plan(node(), DriveMode::Csv, Extras::default(), &Terminals::default(), Some(&known)).is_ok());
}

/// Returns the file of the simulated drive with PDOMapping=0 for the given objects.
fn without_mapping(objects: &[&str]) -> String {
    let mut text = include_str!("../../../../launch-configs/can/cia402_sim.eds").to_owned();
    for object in objects {
        let at = text.find(&format!("[{object}]")).unwrap();
        text = format!("{}{}", &text[..at], text[at..].replacen("PDOMapping=0x1", "PDOMapping=0", 1));
    }
    text
}

/// Returns the dictionary of the simulated drive with objects that cannot be mapped and that no default PDO carries.
fn dictionary_without(objects: &[&str]) -> Dictionary {
    let mut text = without_mapping(objects);
    for object in objects {
        for bits in ["08", "10", "20"] {
            text = text.replace(&format!("DefaultValue=0x{object}00{bits}\n"), "DefaultValue=0\n");
        }
    }
    eds::parse(text.as_bytes(), Some(3)).unwrap()
}

/// By default RPDO 3 carries 607Ah, RPDO 2 carries 6060h, TPDO 3 carries 6064h (CiA 402-3). A PDO of the other direction does not
/// count.
#[test]
fn object_in_default_pdo_needs_no_pdo_mapping_flag() {
    let plan = |text: &str| {
        let known = eds::parse(text.as_bytes(), Some(3)).unwrap();
        Layout::plan(node(), DriveMode::Csp, Extras::default(), &Terminals::default(), Some(&known))
    };
    let text = without_mapping(&["607A", "6060", "6064"]);
    let layout = plan(&text).unwrap();
    let objects: Vec<_> = layout.asked[0].fields.iter().map(|field| field.object).collect();
    // The mode is exchanged by SDO, which needs no mapping.
    assert_eq!(objects, [objects::CONTROL_WORD, objects::TARGET_POSITION]);
    assert_eq!(layout.mode_by_sdo, ModeBySdo { writes: true, reads: false });
    let other = text.replace("DefaultValue=0x606C0020\n", "DefaultValue=0x607A0020\n");
    let other = other.replacen("DefaultValue=0x607A0020\n", "DefaultValue=0\n", 1);
    let refused = MappingError::NotMappable(objects::TARGET_POSITION, Unmapped::NotMappable, "csp").into();
    assert_eq!(plan(&other), Err(refused));
    // ParameterValue has precedence over DefaultValue.
    let configured = other.replacen("[1600sub1]\n", "[1600sub1]\nParameterValue=0x607A0020\n", 1);
    assert!(plan(&configured).is_ok());
}

/// Returns the dictionary of the simulated drive without an object.
fn dictionary_lacking(object: &str) -> Dictionary {
    let text = include_str!("../../../../launch-configs/can/cia402_sim.eds");
    let (from, to) = (format!("[{object}"), format!("[2F{}", &object[2..]));
    assert!(text.contains(&from), "{object}");
    eds::parse(text.replace(&from, &to).as_bytes(), Some(3)).unwrap()
}

#[test]
fn object_that_the_file_lacks_is_named_as_missing() {
    let terminals = Terminals { digital_outputs: vec![terminal(16)], ..Terminals::default() };
    let torque = Extras { torque: true, ..Extras::default() };
    let probes = |probes| Extras { probes, ..Extras::default() };
    let (rising, falling) = (Some(probe::Probe::Rising), Some(probe::Probe::Falling));
    let none = Terminals::default();
    for (object, mode, extras, terminals, sentence) in [
        (
            "6042",
            DriveMode::Vl,
            Extras::default(),
            &none,
            "6042h:00 is missing in the eds; mode vl needs it in each cycle",
        ),
        (
            "60FE",
            DriveMode::Csp,
            Extras::default(),
            &terminals,
            "60FEh:01 is missing in the eds; entries of io need it",
        ),
        ("6077", DriveMode::Csp, torque, &none, "6077h:00 is missing in the eds; rated_effort needs it"),
        (
            "60D5",
            DriveMode::Csp,
            probes([rising, None]),
            &none,
            "the eds lacks 60D5h (number of edges), which probe_1 needs",
        ),
        (
            "60BD",
            DriveMode::Csp,
            probes([None, falling]),
            &none,
            "the eds lacks 60BDh (position of an edge), which probe_2 needs",
        ),
    ] {
        let known = dictionary_lacking(object);
        let refused = Layout::plan(node(), mode, extras, terminals, Some(&known)).unwrap_err();
        assert_eq!(refused.to_string(), sentence);
    }
    let known = dictionary_without(&["60D5"]);
    let refused = Layout::plan(node(), DriveMode::Csp, probes([rising, None]), &none, Some(&known)).unwrap_err();
    let sentence = "60D5h:00 cannot be mapped to a PDO, by the dictionary of the drive; probe_1 needs it";
    assert_eq!(refused.to_string(), sentence);
}

/// Mapping of 6060h and 6061h is optional (CiA 402): they are then exchanged by SDO. Missing process data of each cycle is still
/// refused.
#[test]
fn unmappable_mode_is_exchanged_by_sdo() {
    let plan = |unmappable: &[&str]| {
        let known = dictionary_without(unmappable);
        Layout::plan(node(), DriveMode::Csp, Extras::default(), &Terminals::default(), Some(&known))
    };
    let cases: [(&[&str], bool, bool); 4] =
        [(&[], false, false), (&["6060"], true, false), (&["6061"], false, true), (&["6060", "6061"], true, true)];
    for (unmappable, writes, reads) in cases {
        let layout = plan(unmappable).unwrap();
        assert_eq!(layout.mode_by_sdo, ModeBySdo { writes, reads }, "{unmappable:?}");
        let lengths = (layout.asked[0].bytes(), layout.told[0].bytes());
        assert_eq!(lengths, (if writes { 6 } else { 7 }, if reads { 6 } else { 7 }), "{unmappable:?}");
        // Another client that writes 6060h changes the commanded mode, whether it is in a PDO or not.
        assert!(layout.mapped().any(|object| object == objects::MODE), "{unmappable:?}");
    }
    let refused = plan(&["6060", "607A"]).unwrap_err();
    assert_eq!(refused, MappingError::NotMappable(objects::TARGET_POSITION, Unmapped::NotMappable, "csp").into());
}

/// A captured position and its count belong to the same capture only if they are in one PDO.
#[test]
fn captured_position_and_count_are_in_one_pdo() {
    let rising = Extras { probes: [Some(probe::Probe::Rising), None], torque: false };
    let both = Extras { probes: [Some(probe::Probe::Rising), Some(probe::Probe::Index)], torque: false };
    for extras in [rising, both, Extras { torque: true, ..rising }, Extras { torque: true, ..both }] {
        let cases: [&[&str]; 2] = [&[], &["6061"]];
        for unmappable in cases {
            for digital_inputs in [vec![], vec![terminal(16)]] {
                let known = dictionary_without(unmappable);
                let terminals = Terminals { digital_inputs, ..Terminals::default() };
                // Four PDOs may be too few.
                let Ok(layout) = Layout::plan(node(), DriveMode::Csp, extras, &terminals, Some(&known)) else {
                    continue;
                };
                for pdo in &layout.told {
                    let slots = |of: fn(&ReportedValue) -> Option<Slot>| {
                        pdo.fields.iter().filter_map(|field| of(&field.word)).collect::<Vec<_>>()
                    };
                    let caught =
                        slots(|word| if let ReportedValue::Captured(slot) = word { Some(*slot) } else { None });
                    let counts =
                        slots(|word| if let ReportedValue::Captures(slot) = word { Some(*slot) } else { None });
                    assert_eq!(caught, counts, "{:?}", told(&layout));
                }
            }
        }
    }
}

fn terminal(address: u16) -> Terminal {
    Terminal { place: 0, address }
}

/// Bits of 60FDh and 60FEh that entries of `io` use are sent in each cycle, after the values that the interface needs: 11 bytes are two
/// PDOs.
#[test]
fn inputs_and_outputs_of_drive_are_sent_in_each_cycle() {
    let terminals =
        Terminals { digital_inputs: vec![terminal(16)], digital_outputs: vec![terminal(16)], ..Terminals::default() };
    let text = include_str!("../../../../launch-configs/can/cia402_sim.eds");
    let known = eds::parse(text.as_bytes(), Some(3)).unwrap();
    let layout = Layout::plan(node(), DriveMode::Csp, Extras::default(), &terminals, Some(&known)).unwrap();
    let cyclic = [
        (1, 0x183, 1, vec![ReportedValue::Status, ReportedValue::Position, ReportedValue::Mode]),
        (2, 0x283, 1, vec![ReportedValue::Inputs]),
    ];
    assert_eq!(told(&layout), [cyclic.as_slice(), &[(3, 0x383, 255, vec![ReportedValue::Fault])]].concat());
    let asked: Vec<_> = layout.asked.iter().map(|pdo| (pdo.number, pdo.bytes())).collect();
    assert_eq!(asked, [(1, 7), (2, 4)]);
    let at = text.find("[60FD]").unwrap();
    let text = format!("{}{}", &text[..at], text[at..].replacen("PDOMapping=0x1", "PDOMapping=0", 1));
    let known = eds::parse(text.as_bytes(), Some(3)).unwrap();
    let error = Layout::plan(node(), DriveMode::Csp, Extras::default(), &terminals, Some(&known)).unwrap_err();
    let sentence = "60FDh:00 cannot be mapped to a PDO, by the dictionary of the drive; entries of io need it";
    assert_eq!(error.to_string(), sentence);
}

/// Digital inputs and outputs are in PDO 1, analog ones from PDO 2, four in each (CiA 401).
#[test]
fn a_module_has_its_default_pdos() {
    let analog = |address| AnalogTerminal { terminal: terminal(address), volts_at_full_scale: 10.0 };
    let terminals = Terminals {
        digital_inputs: vec![terminal(12), terminal(3)],
        digital_outputs: vec![terminal(63)],
        analog_inputs: vec![analog(4)],
        analog_outputs: vec![analog(11)],
        ..Terminals::default()
    };
    let layout = Layout::module(node(), &terminals).unwrap();
    let analog = |from, to| (from..to).map(ReportedValue::Analog).collect::<Vec<_>>();
    let expected = [
        (1, 0x183, 1, vec![ReportedValue::Digital(0), ReportedValue::Digital(1)]),
        (2, 0x283, 1, analog(0, 4)),
        (3, 0x383, 1, analog(4, 5)),
    ];
    assert_eq!(told(&layout), expected);
    let objects =
        |pdo: &Pdo<CommandedValue>| pdo.fields.iter().map(|field| field.object.to_string()).collect::<Vec<_>>();
    let asked: Vec<_> = layout.asked.iter().map(|pdo| (pdo.number, pdo.id.get(), objects(pdo))).collect();
    let numbers: Vec<_> = asked.iter().map(|(number, id, objects)| (*number, *id, objects.len())).collect();
    assert_eq!(numbers, [(1, 0x203, 8), (2, 0x303, 4), (3, 0x403, 4), (4, 0x503, 4)]);
    assert_eq!([&asked[0].2[7], &asked[3].2[3]], ["6200h:08", "6411h:0C"]);
}

/// Proves: MACS-CAN-18
#[test]
fn encoder_position_is_in_tpdo_2() {
    let layout = Layout::encoder(node()).unwrap();
    assert_eq!((told(&layout), layout.asked.len()), (vec![(2, 0x283, 1, vec![ReportedValue::Encoder])], 0));
    assert_eq!(layout.told[0].fields[0].object.to_string(), "6004h:00");
}
