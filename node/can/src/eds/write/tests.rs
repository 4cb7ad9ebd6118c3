use super::*;
use crate::eds::{ConfigureError, FindError, parse};
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::object::Object;
use proptest::prelude::*;

const OWN: &str = include_str!("../../../../../launch-configs/can/cia402_sim.eds");

/// Lines that cover every branch of the reader.
const LINES: [&str; 28] = [
    "[1018]",
    "[6060]",
    "[6060sub1]",
    "[2000]",
    "[2000sub0]",
    "[2000Name]",
    "[2000Value]",
    "[A0sub1]",
    "[DeviceComissioning]",
    "[Comments]",
    "AccessType=rw",
    "NodeID=7",
    "ObjectType=0x9",
    "ObjectType=8",
    "ObjectType=2",
    "CompactSubObj=0xFF",
    "CompactSubObj=3",
    "SubNumber=0xFFFFFFFF",
    "DataType=0x0009",
    "DataType=0x000B",
    "DataType=0x0011",
    "DataType=0x00A0",
    "DefaultValue=$NODEID+0xFFFFFFFFFFFFFFFF",
    "ParameterValue=$NODEID+1",
    "LowLimit=0x80000000",
    "HighLimit=-1",
    "1=\u{e4} ;",
    "ObjFlags=1",
];

fn at(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Checks that the written file is read as the same dictionary, without a warning.
fn comes_back(file: &[u8], node_id: Option<u8>) {
    let Ok(mut dictionary) = parse(file, node_id) else { return };
    dictionary.take_warnings();
    let text = dictionary.to_eds();
    let again = parse(text.as_bytes(), node_id).unwrap();
    assert_eq!(again.warnings().to_string(), "", "{text}");
    assert_eq!(again, dictionary, "{text}");
    // Other functions of the dictionary do not panic with an unusual file.
    let _ = dictionary.configured_values();
    for number in 0..6 {
        let _ = dictionary.pdo_mapping(Direction::Receive, number);
        let _ = dictionary.pdo_mapping(Direction::Transmit, number);
    }
}

#[test]
fn written_file_is_read_unchanged() {
    comes_back(OWN.as_bytes(), Some(5));
    comes_back(OWN.as_bytes(), None);
}

#[test]
fn compact_and_unusual_files_are_read_unchanged() {
    comes_back(
        b"[DeviceInfo]\nVendorNumber=0xFB\nBaudRate_100=1\nBaudRate_800=0\nCompactPDO=23\n[DeviceComissioning]\nNodeID=2\nNodeName=x = y;\n\
          [Comments]\nLines=9\nLine3=\nLine1=[a]\n[DummyUsage]\nDummy0005=1\nDummy001B=1\n\
          [3004]\nCompactSubObj=3\nParameterName=S\nObjectType=8\nDataType=0x8\nAccessType=rwr\nDefaultValue=5.2\nObjFlags=3\n\
          [3004Value]\n2=1e-7\n[3005]\nObjectType=0\n[3006]\nParameterName=a\nObjectType=8\n\
          [3007]\nDataType=0x000C\nAccessType=wo\nDefaultValue=01 00 00 00 00 01\nPDOMapping=1\nLowLimit=1\n\
          [3008]\nDataType=0x0001\nAccessType=const\nDefaultValue=1\n[3009sub7]\nDataType=0x000A\nDefaultValue=AB CD\n\
          [300A]\nDataType=0x0015\nAccessType=rww\nDefaultValue=$NODEID\nLowLimit=-5\nHighLimit=0x7\nParameterValue=0+$NODEID\n",
        None,
    );
}

#[test]
fn numbers_are_written_as_people_read_them() {
    let text = parse(OWN.as_bytes(), Some(5)).unwrap().to_eds();
    for line in ["DefaultValue=$NODEID+0x180", "DefaultValue=0x607A0020", "[1A00sub0]", "1=0x1000", "BaudRate_500=1"] {
        assert!(text.lines().any(|written| written == line), "{line}");
    }
}

#[test]
fn names_find_their_object_in_any_case() {
    let dictionary = parse(OWN.as_bytes(), Some(5)).unwrap();
    assert_eq!(dictionary.find("modes of OPERATION"), Ok(at(0x6060, 0)));
    assert_eq!(dictionary.find(" identity object.vendor-id "), Ok(at(0x1018, 1)));
    assert_eq!(dictionary.name(at(0x1018, 1)).unwrap(), "Identity object.Vendor-ID");
    assert_eq!(dictionary.find("Identity").unwrap_err().to_string(), "no object has the name \"Identity\"");
    let twice = "[DeviceInfo]\n[2000]\nParameterName=a\nDataType=5\n[2001]\nParameterName=A\nDataType=5\n";
    let error = parse(twice.as_bytes(), None).unwrap().find("a").unwrap_err();
    assert!(matches!(error, FindError::Ambiguous { .. }));
    assert_eq!(error.to_string(), "the name \"a\" is that of 2000h:00 and of 2001h:00: write the index");
}

#[test]
fn a_configuration_writes_what_can_be_written() {
    let mut dictionary = parse(OWN.as_bytes(), Some(5)).unwrap();
    assert_eq!(dictionary.configured_values(), Ok(vec![]));
    dictionary.set_parameter(at(0x6060, 0), Some(Value::Integer(-1))).unwrap();
    dictionary.set_parameter(at(0x1017, 0), Some(Value::Unsigned(100))).unwrap();
    dictionary.set_parameter(at(0x2001, 0), Some(Value::Text("ab".to_owned()))).unwrap();
    let written = vec![(at(0x1017, 0), vec![100, 0]), (at(0x2001, 0), b"ab".to_vec()), (at(0x6060, 0), vec![0xFF])];
    assert_eq!(dictionary.configured_values(), Ok(written));
    comes_back(dictionary.to_eds().as_bytes(), Some(5));
    dictionary.set_parameter(at(0x1017, 0), None).unwrap();
    assert_eq!(dictionary.configured_values().unwrap().len(), 2);
}

#[test]
fn values_that_no_device_or_no_file_takes_are_refused() {
    let mut dictionary = parse(OWN.as_bytes(), Some(5)).unwrap();
    let mut of = |index, value| dictionary.set_parameter(at(index, 0), Some(value)).unwrap_err().to_string();
    assert_eq!(of(0x7000, Value::Unsigned(1)), "7000h:00 does not exist in the dictionary");
    assert_eq!(of(0x6041, Value::Unsigned(1)), "6041h:00 cannot be written: its access is ro");
    assert_eq!(of(0x6060, Value::Integer(128)), "6060h:00: 128 is not within -128 and 127, as INTEGER8 is");
    for text in ["", " a", "a\nb", &"a".repeat(60_000)] {
        assert!(of(0x2001, Value::Text(text.to_owned())).contains("cannot stand in a file"), "{text}");
    }
}

#[test]
fn flagged_and_read_only_objects_are_not_written() {
    let file = "[DeviceInfo]\n[1010]\nDataType=7\nAccessType=rw\nObjFlags=1\nParameterValue=1\n\
        [1018]\nDataType=7\nAccessType=ro\nParameterValue=1\n[2000]\nDataType=7\nAccessType=rw\nParameterValue=$NODEID+1\n";
    assert_eq!(
        parse(file.as_bytes(), Some(5)).unwrap().configured_values(),
        Ok(vec![(at(0x2000, 0), vec![6, 0, 0, 0])])
    );
    let error = parse(file.as_bytes(), None).unwrap().configured_values().unwrap_err();
    assert_eq!(error, ConfigureError::NodeId(at(0x2000, 0)));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        comes_back(&bytes, Some(1));
    }

    #[test]
    fn lines_in_any_order_are_read_or_refused(picks in proptest::collection::vec(0..LINES.len(), 0..40)) {
        // With one valid object, most of the files have a dictionary.
        let first = ["[2000]", "DataType=0x0005", "[3000]"];
        let lines = first.into_iter().chain(picks.iter().map(|pick| LINES[*pick]));
        let file: String = lines.flat_map(|line| [line, "\n"]).collect();
        comes_back(file.as_bytes(), None);
    }

    #[test]
    fn file_with_random_lines_is_read_or_refused(
        changes in proptest::collection::vec((0..2114_usize, 0..LINES.len() + 2, "\\PC{0,20}"), 1..40),
    ) {
        let mut lines: Vec<String> = OWN.lines().map(str::to_owned).collect();
        for (number, pick, noise) in changes {
            let line = &mut lines[number];
            match LINES.get(pick) {
                Some(known) => *line = (*known).to_owned(),
                None if pick == LINES.len() => *line = noise,
                // The value of the line is replaced.
                None => *line = format!("{}={noise}", line.split('=').next().unwrap_or_default()),
            }
        }
        comes_back(lines.join("\n").as_bytes(), Some(127));
    }
}

/// Keys whose value is a number, in any notation.
const NUMBERS: [&str; 6] = ["DataType", "ObjectType", "SubNumber", "PDOMapping", "ObjFlags", "SupportedObjects"];
const VALUES: [&str; 3] = ["DefaultValue", "LowLimit", "HighLimit"];

/// Writes the same line in one of several ways, selected by `how`.
fn rewritten(line: &str, how: u16) -> String {
    let bit = |place: u16| how >> place & 1 == 1;
    let cased = |text: &str| if bit(0) { text.to_uppercase() } else { text.to_lowercase() };
    let remark = if bit(1) { " ; as [we] had it=1" } else { "" };
    let blank = if bit(2) { "\t " } else { "" };
    if let Some(section) = line.strip_prefix('[') {
        let name = section.trim_end_matches(']');
        return format!("{blank}[{blank}{}{blank}]{remark}", cased(name));
    }
    let Some((key, value)) = line.split_once('=') else { return format!("{blank}{line}") };
    let parsed = value.strip_prefix("0x").map_or_else(|| value.parse(), |digits| u64::from_str_radix(digits, 16));
    let hex = |number: u64| if bit(3) { format!("0x{number:x}") } else { format!("0X{number:08X}") };
    let value = match (parsed, value.strip_prefix("$NODEID+")) {
        (_, Some(summand)) if bit(4) => format!("{summand}{blank}+{blank}$NodeId{remark}"),
        (_, Some(summand)) => format!("$nodeid{blank}+{blank}{summand}{remark}"),
        (Ok(number), _) if NUMBERS.contains(&key) || key.parse::<u16>().is_ok() => {
            let notations = [number.to_string(), format!("0{number:o}"), hex(number), format!("+{number}")];
            format!("{}{remark}", notations[usize::from(how >> 5 & 3)])
        }
        // Hexadecimal digits may be the bits of a negative number, so they stay hexadecimal.
        (Ok(number), _) if VALUES.contains(&key) && value.starts_with("0x") => format!("{}{remark}", hex(number)),
        _ => value.to_owned(),
    };
    let between = if bit(7) { "; a line of somebody\n\n" } else { "" };
    format!("{between}{blank}{}{blank}={blank}{value}{blank}", cased(key))
}

proptest! {
    /// Case, blanks, comments, notations of numbers, order of sections and line ends do not change the meaning.
    #[test]
    fn equivalent_notation_gives_same_dictionary(
        ways in proptest::collection::vec(any::<u16>(), 1..200),
        first in any::<prop::sample::Index>(),
        is_of_windows: bool,
        has_mark: bool,
    ) {
        let mut sections: Vec<Vec<String>> = vec![vec![]];
        for (line, how) in OWN.lines().zip(ways.iter().cycle()) {
            if line.starts_with('[') {
                sections.push(vec![]);
            }
            sections.last_mut().unwrap().push(rewritten(line, *how));
        }
        // Lines before the first section are comments.
        let head = sections.remove(0);
        prop_assert!(head.iter().all(|line| line.trim().is_empty() || line.trim().starts_with(';')), "{head:?}");
        let first = first.index(sections.len());
        sections.rotate_left(first);
        let mut file = sections.concat().join("\n");
        if is_of_windows {
            file = file.replace('\n', "\r\n");
        }
        if has_mark {
            file.insert(0, '\u{FEFF}');
        }
        let (read, own) = (parse(file.as_bytes(), Some(5)).unwrap(), parse(OWN.as_bytes(), Some(5)).unwrap());
        prop_assert_eq!(read.warnings().to_string(), "");
        prop_assert_eq!(&read, &own);
        prop_assert_eq!(read.to_eds(), own.to_eds());
    }
}
