use super::*;
use crate::eds::parse;

const OWN: &[u8] = include_bytes!("../../../../../launch-configs/can/cia402_sim.eds");

fn mapped(index: u16, bits: u8) -> Mapped {
    Mapped { object: Object { index, sub: 0 }, bits }
}

#[test]
fn the_pdos_of_our_own_file_are_those_of_cia_402() {
    let dictionary = parse(OWN, Some(5)).unwrap();
    // Identifiers: predefined connection set. Mapping: CiA 402-3, as the file lists it.
    let rows = [
        (Direction::Receive, 1, 0x205, vec![mapped(0x6040, 16)]),
        (Direction::Receive, 2, 0x305, vec![mapped(0x6040, 16), mapped(0x6060, 8)]),
        (Direction::Receive, 3, 0x405, vec![mapped(0x6040, 16), mapped(0x607A, 32)]),
        (Direction::Receive, 4, 0x505, vec![mapped(0x6040, 16), mapped(0x60FF, 32)]),
        (Direction::Transmit, 1, 0x185, vec![mapped(0x6041, 16)]),
        (Direction::Transmit, 2, 0x285, vec![mapped(0x6041, 16), mapped(0x6061, 8)]),
        (Direction::Transmit, 3, 0x385, vec![mapped(0x6041, 16), mapped(0x6064, 32)]),
        (Direction::Transmit, 4, 0x485, vec![mapped(0x6041, 16), mapped(0x606C, 32)]),
    ];
    for (direction, number, cob_id, mapped) in rows {
        let pdo = dictionary.pdo_mapping(direction, number).unwrap();
        assert_eq!(pdo, PdoMapping { cob_id: CobId(cob_id), transmission_type: Some(255), mapped });
    }
}

#[test]
fn incomplete_pdo_is_refused_with_reason() {
    let dictionary = parse(OWN, Some(5)).unwrap();
    let of = |number| dictionary.pdo_mapping(Direction::Receive, number).unwrap_err().to_string();
    assert_eq!(of(0), "PDO 0 does not exist: PDOs have the numbers 1 to 512");
    assert_eq!(of(513), "PDO 513 does not exist: PDOs have the numbers 1 to 512");
    assert_eq!(of(5), "1404h:01 does not exist in the dictionary");
    let error = parse(OWN, None).unwrap().pdo_mapping(Direction::Transmit, 1).unwrap_err();
    assert_eq!(error.to_string(), "1800h:01 has no value in the dictionary, as the node id is not known");
}

/// Reads a receive PDO with the values of 1400h:01, 1600h:00 and 1600h:01.
fn pdo(cob_id: &str, count: &str, first: &str) -> Result<PdoMapping, PdoError> {
    let one = |section: &str, data_type: u8, value: &str| {
        format!("[{section}]\nParameterName=a\nDataType={data_type}\nAccessType=rw\nDefaultValue={value}\n")
    };
    let heads = "[DeviceInfo]\n[1400]\nObjectType=9\n[1600]\nObjectType=9\n";
    let file = [
        heads,
        &one("1400sub1", 7, cob_id),
        &one("1600sub0", 5, count),
        &one("1600sub1", 7, first),
        &one("1600sub2", 7, first),
    ];
    parse(file.concat().as_bytes(), Some(1)).unwrap().pdo_mapping(Direction::Receive, 1)
}

#[test]
fn flag_bits_are_not_part_of_identifier() {
    let cob_id = pdo("$NODEID+0x80000200", "0", "").unwrap().cob_id;
    assert_eq!((cob_id.is_valid(), cob_id.allows_remote(), cob_id.id()), (false, true, 0x201));
    let cob_id = pdo("0x7ABCDEF0", "0", "").unwrap().cob_id;
    assert_eq!((cob_id.is_valid(), cob_id.allows_remote(), cob_id.is_extended()), (true, false, true));
    assert_eq!(cob_id.id(), 0x1ABC_DEF0);
}

#[test]
fn mapping_beyond_64_bits_is_refused() {
    let of = |count, first| pdo("0x200", count, first).map_err(|error| error.to_string());
    assert_eq!(of("2", "0x60640120").unwrap().mapped[1], Mapped { object: Object { index: 0x6064, sub: 1 }, bits: 32 });
    assert_eq!(
        of("2", "0x60640021").unwrap_err(),
        "the objects that 1600h:00 lists have 66 bits together; a PDO has 64"
    );
    assert_eq!(of("3", "0x60640010").unwrap_err(), "1600h:03 does not exist in the dictionary");
    assert_eq!(of("65", "0x60640010").unwrap_err(), "1600h:00 is 65, which is no value of this object");
    assert_eq!(of("2", "").unwrap_err(), "1600h:01 has no value in the dictionary");
    assert_eq!(of("", "").unwrap_err(), "1600h:00 has no value in the dictionary");
}
