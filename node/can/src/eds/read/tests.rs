use super::*;
use crate::eds::{Access, FileValue};
use lineshaft_cia402::dictionary::{DataType, Value};

const OWN: &[u8] = include_bytes!("../../../../../launch-configs/can/cia402_sim.eds");

fn at(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Reads a file with these sections after the minimum that a file needs.
fn read(sections: &str) -> Dictionary {
    parse(format!("[DeviceInfo]\n{sections}").as_bytes(), Some(5)).unwrap()
}

fn warnings(dictionary: &Dictionary) -> Vec<String> {
    let unlisted = |text: &&String| !text.contains("stand in no list");
    dictionary
        .warnings()
        .kept()
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .iter()
        .filter(unlisted)
        .cloned()
        .collect()
}

fn errors(sections: &str) -> String {
    parse(format!("[DeviceInfo]\n{sections}").as_bytes(), Some(5)).unwrap_err().to_string()
}

#[test]
fn our_own_file_is_read_without_a_warning() {
    let dictionary = parse(OWN, Some(5)).unwrap();
    assert_eq!(dictionary.warnings().to_string(), "");
    // Counted in the file: 100 sections of an index, 30 of them with a SubNumber, and 162 sections of a subindex.
    assert_eq!((dictionary.heads().count(), dictionary.entries().count()), (100, 100 - 30 + 162));
    assert_eq!(dictionary.file.eds_version, "4.2");
    let device = &dictionary.device;
    assert_eq!(device.vendor_name, "cia402-sim (test peer)");
    assert_eq!((device.vendor_number, device.product_number), (Some(65535), Some(0x4020_0001)));
    assert_eq!(device.revision_number, Some(0x1_0000));
    assert_eq!(device.baud_rates.iter().copied().collect::<Vec<_>>(), [125, 250, 500, 1000]);
    assert_eq!((device.receive_pdos, device.transmit_pdos, device.has_lss), (Some(4), Some(4), false));
    assert!(device.is_boot_up_slave && !device.is_boot_up_master);
    assert_eq!(dictionary.commissioning, None);
    assert!(dictionary.dummies.is_empty());
}

#[test]
fn objects_of_our_own_file_are_what_it_says() {
    let dictionary = parse(OWN, Some(5)).unwrap();
    let mode = dictionary.entry(at(0x6060, 0)).unwrap();
    assert_eq!((mode.data_type, mode.access, mode.is_mappable), (DataType::Integer8, Access::Rww, true));
    assert_eq!(dictionary.default_value(at(0x6060, 0)), Some(Value::Integer(0)));
    assert_eq!(dictionary.default_value(at(0x1008, 0)), Some(Value::Text("cia402-sim".to_owned())));
    assert_eq!(dictionary.default_value(at(0x6085, 0)), Some(Value::Unsigned(2_000_000)));
    assert_eq!(dictionary.default_value(at(0x1018, 4)), Some(Value::Unsigned(0x5005)));
    assert_eq!(dictionary.entry(at(0x2100, 0)).unwrap().data_type, DataType::Domain);
    assert_eq!(dictionary.default_value(at(0x2100, 0)), None);
    assert_eq!(dictionary.index_description(0x607D).unwrap().object_type, ObjectType::Array);
    assert_eq!(dictionary.entry(at(0x607D, 3)), None);
    assert_eq!(dictionary.entries_of(0x607D).count(), 3);
}

#[test]
fn without_a_node_its_values_are_not_known() {
    let dictionary = parse(OWN, None).unwrap();
    assert_eq!(dictionary.node_id(), None);
    assert_eq!(dictionary.default_value(at(0x1800, 1)), None);
    assert_eq!(dictionary.entry(at(0x1800, 1)).unwrap().default, Some(FileValue::NodeId { plus: 0x180 }));
    assert_eq!(dictionary.default_value(at(0x1800, 2)), Some(Value::Unsigned(255)));
}

#[test]
fn given_node_id_overrides_that_of_file() {
    let file = b"[DeviceInfo]\n[DeviceComissioning]\nNodeID=2\nBaudrate=500\nLSS_SerialNumber=0x29001321\n\
        [1014]\nParameterName=COB-ID EMCY\nDataType=7\nAccessType=ro\nDefaultValue=$NODEID+0x80\n";
    let dictionary = parse(file, None).unwrap();
    let commissioning = dictionary.commissioning.clone().unwrap();
    assert_eq!((commissioning.baud_rate, commissioning.lss_serial_number), (Some(500), Some(0x2900_1321)));
    assert_eq!(dictionary.value(at(0x1014, 0)), Some(Value::Unsigned(0x82)));
    assert_eq!(parse(file, Some(127)).unwrap().value(at(0x1014, 0)), Some(Value::Unsigned(0xFF)));
    let twice = String::from_utf8(file.to_vec()).unwrap().replace("Comis", "Commis");
    assert_eq!(parse(twice.as_bytes(), None).unwrap().node_id(), Some(2));
}

#[test]
fn parameter_value_overrides_default() {
    let dictionary = read(
        "[1017]\nParameterName=a\nDataType=0x6\nAccessType=RW\nDefaultValue=0\nParameterValue=100\n\
         [1018]\nParameterName=b\nDataType=0x7\nAccessType=ro\nParameterValue=0x000000FB\n",
    );
    assert_eq!(dictionary.default_value(at(0x1017, 0)), Some(Value::Unsigned(0)));
    assert_eq!(dictionary.value(at(0x1017, 0)), Some(Value::Unsigned(100)));
    assert_eq!(dictionary.default_value(at(0x1018, 0)), None);
    assert_eq!(dictionary.value(at(0x1018, 0)), Some(Value::Unsigned(251)));
}

#[test]
fn compact_sub_obj_creates_objects_with_names_and_values() {
    let dictionary = read(
        "[3004]\nCompactSubObj=0x3\nParameterName=Sensor\nObjectType=8\nDataType=0x0006\nAccessType=rw\nDefaultValue=3\n\
         [3004Name]\nNrOfEntries=1\n2=Second\n[3004Value]\nNrOfEntries=2\n1=7\n3=9\n[3004ObjectLinks]\nObjectLinks=0\n",
    );
    let all: Vec<_> = dictionary.entries_of(0x3004).map(|(object, entry)| (object.sub, entry.name.as_str())).collect();
    assert_eq!(all, [(0, "NrOfObjects"), (1, "Sensor1"), (2, "Second"), (3, "Sensor3")]);
    assert_eq!(dictionary.value(at(0x3004, 0)), Some(Value::Unsigned(3)));
    assert_eq!(dictionary.value(at(0x3004, 1)), Some(Value::Unsigned(7)));
    assert_eq!(dictionary.value(at(0x3004, 2)), Some(Value::Unsigned(3)));
    assert_eq!(dictionary.parameter_value(at(0x3004, 2)), None);
    assert_eq!(dictionary.parameter_value(at(0x3004, 3)), Some(Value::Unsigned(9)));
    assert_eq!(warnings(&dictionary), [""; 0]);
}

/// The device would keep another value, and no client would notice it.
#[test]
fn unreadable_parameter_value_is_an_error() {
    assert_eq!(
        errors("[2000]\nParameterName=a\nDataType=0x5\nAccessType=rw\nDefaultValue=1\nParameterValue=256\n"),
        "line 7: [2000] ParameterValue=256: 256 is not within 0 and 255, as UNSIGNED8 is"
    );
    assert_eq!(
        errors("[2000]\nParameterName=a\nDataType=0x5\nAccessType=wo\nParameterValue=$NODEID+129\n"),
        "line 6: [2000] ParameterValue=$NODEID+129: 256 is not within 0 and 255, as UNSIGNED8 is"
    );
    assert_eq!(
        errors(
            "[3004]\nCompactSubObj=3\nParameterName=a\nObjectType=8\nDataType=6\nAccessType=rw\n[3004Value]\n3=70000\n"
        ),
        "line 9: [3004Value] 3=70000: 70000 is not within 0 and 65535, as UNSIGNED16 is"
    );
}

/// An unreadable value of an object that a configuration does not write causes a warning: an object that the device only sends, or that
/// ObjFlags excludes.
#[test]
fn unreadable_value_that_is_not_written_is_a_warning() {
    let dictionary = read(
        "[2000]\nParameterName=a\nDataType=5\nAccessType=ro\nParameterValue=256\n\
         [2001]\nParameterName=a\nDataType=5\nAccessType=rw\nObjFlags=1\nParameterValue=x\n\
         [2002]\nParameterName=a\nObjectType=2\nDownloadFile=a.bin\n",
    );
    assert_eq!(
        warnings(&dictionary),
        [
            "line 6: [2000] ParameterValue=256: 256 is not within 0 and 255, as UNSIGNED8 is; passed over",
            "line 12: [2001] ParameterValue=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); passed over",
            "line 16: [2002] DownloadFile=a.bin: the value is in a file, which is not read: write it with `can sdo write --file`; \
             passed over",
        ]
    );
}

#[test]
fn parameter_value_without_object_is_an_error() {
    let compact = "[3004]\nCompactSubObj=2\nParameterName=a\nObjectType=8\nDataType=6\nAccessType=rw\n";
    let of_keys = "no object takes the value; allowed are the subindices 1 to 2 that have no section of their own, in decimal digits";
    let of_index =
        "the index has no value of its own; allowed are sections of its subindices, or [xxxxValue] with CompactSubObj";
    let stray = "the section is that of no object; allowed are names like [2000] and [2000sub1]";
    for (sections, expected) in [
        (format!("{compact}[3004Value]\nNrOfEntries=1\n1=4\n3=5\n"), format!("line 11: [3004Value] 3=5: {of_keys}")),
        (format!("{compact}[3004Value]\n01=5\n2=\n"), format!("line 9: [3004Value] 01=5: {of_keys}")),
        (
            format!("{compact}[3005Value]\n1=5\n"),
            "line 9: [3005Value] 1=5: no object takes the value: CompactSubObj of the index makes none".to_owned(),
        ),
        (
            format!("{compact}[2000]\nParameterName=a\nDataType=5\nAccessType=rw\n[2000Value]\n1=5\n"),
            "line 13: [2000Value] 1=5: no object takes the value: CompactSubObj of the index makes none".to_owned(),
        ),
        (format!("{compact}ParameterValue=7\n"), format!("line 8: [3004] ParameterValue=7: {of_index}")),
        (
            "[2000]\nParameterName=a\nAccessType=rw\nParameterValue=7\n".to_owned(),
            "line 5: [2000] ParameterValue=7: the section has no DataType, without which the value cannot be read".to_owned(),
        ),
        (
            "[2000]\nParameterName=a\nDataType=5\nParameterValue=7\n".to_owned(),
            "line 5: [2000] ParameterValue=7: the section has no AccessType, without which it is not known whether to write it"
                .to_owned(),
        ),
        (format!("{compact}[0x2000]\nParameterValue=7\n"), format!("line 9: [0x2000] ParameterValue=7: {stray}")),
        (format!("{compact}[200]\nParameterValue=7\n"), format!("line 9: [200] ParameterValue=7: {stray}")),
        (format!("{compact}[3004 sub1]\nParameterValue=7\n"), format!("line 9: [3004 sub1] ParameterValue=7: {stray}")),
    ] {
        assert_eq!(errors(&sections), expected);
    }
    let module = read(&format!("{compact}[M1SubExt6000]\nParameterValue=7\n"));
    assert_eq!(
        warnings(&module),
        ["line 9: [M1SubExt6000] ParameterValue=7: the section is that of a module; passed over"]
    );
}

#[test]
fn compact_object_has_at_most_254_subindices() {
    let dictionary =
        read("[1003]\nParameterName=a\nObjectType=0x8\nCompactSubObj=255\nDataType=0x0007\nAccessType=ro\n");
    assert_eq!(dictionary.entries_of(0x1003).last().unwrap().0, at(0x1003, 254));
}

#[test]
fn invalid_value_is_ignored_alone() {
    let dictionary = read(
        "[2000]\nParameterName=a\nDataType=0x5\nAccessType=rw\nDefaultValue=256\nLowLimit=x\nHighLimit=9 ; remark\nPDOMapping=2\n\
         [2001]\nParameterName=b\nDataType=0x2\nAccessType=rw\nDefaultValue=0x-80\nLowLimit=0x80\nHighLimit=0x7F\nPDOMapping=1\n\
         [2002]\nParameterName=c\nDataType=0x2\nAccessType=rw\nLowLimit=3\nHighLimit=1\n",
    );
    assert_eq!(
        warnings(&dictionary),
        [
            "line 6: [2000] DefaultValue=256: 256 is not within 0 and 255, as UNSIGNED8 is; passed over",
            "line 7: [2000] LowLimit=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); passed over",
            "line 9: [2000] PDOMapping=2: 2 is not within 0 and 1; passed over",
            "line 22: [2002] LowLimit=3: the limit is above HighLimit, and neither of them counts; passed over",
        ]
    );
    assert_eq!(dictionary.default_value(at(0x2000, 0)), None);
    assert_eq!(dictionary.high_limit(at(0x2000, 0)), Some(Value::Unsigned(9)));
    assert_eq!(dictionary.default_value(at(0x2001, 0)), Some(Value::Integer(-128)));
    assert_eq!(dictionary.low_limit(at(0x2001, 0)), Some(Value::Integer(-128)));
    assert_eq!(dictionary.high_limit(at(0x2001, 0)), Some(Value::Integer(127)));
    assert_eq!(dictionary.high_limit(at(0x2002, 0)), None);
}

#[test]
fn a_value_of_the_node_fits_for_every_node_or_not_at_all() {
    let file =
        |plus: u32| format!("[2000]\nParameterName=a\nDataType=0x5\nAccessType=rw\nDefaultValue=$NODEID+{plus}\n");
    assert_eq!(read(&file(128)).default_value(at(0x2000, 0)), Some(Value::Unsigned(133)));
    assert_eq!(
        warnings(&read(&file(129))),
        ["line 6: [2000] DefaultValue=$NODEID+129: 256 is not within 0 and 255, as UNSIGNED8 is; passed over"]
    );
}

#[test]
fn all_errors_are_reported_together() {
    assert_eq!(
        errors(
            "[1000]\nParameterName=a\nObjectType=3\nDataType=7\nAccessType=ro\nParameterValue=1\n\
             [1001]\nParameterName=b\nDataType=five\nAccessType=r\nParameterValue=1\n\
             [1018\n[1018sub100]\n"
        ),
        "line 4: [1000] ObjectType=3: allowed are 0 (NULL), 2 (DOMAIN), 5 (DEFTYPE), 6 (DEFSTRUCT), 7 (VAR), 8 (ARRAY), 9 (RECORD)\n\
         line 10: [1001] DataType=five: \"five\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); allowed is the number \
         of a data type, like 0x0007 for UNSIGNED32\n\
         line 11: [1001] AccessType=r: allowed are ro, wo, rw, rwr, rww and const\n\
         line 13: the section \"[1018\" does not end in ]\n\
         line 14: the section \"1018sub100\" has no subindex within 0 and FF"
    );
}

/// Files of vendors have such keys. Only a configuration value would be lost with the object.
#[test]
fn invalid_object_without_parameter_value_is_left_out() {
    let good = "[2000]\nParameterName=a\nDataType=5\nAccessType=rw\n";
    let dictionary = read(&format!(
        "{good}[2001]\nParameterName=b\nDataType=5\nAccessType=UNKNOWN\nDefaultValue=1\n\
         [2002]\nParameterName=c\nDataType=0x0007 # 32 bits\nAccessType=rw\n\
         [2003]\nParameterName=d\nObjectType=0x7 # one value\nDataType=5\nAccessType=rw\n\
         [2004]\nParameterName=e\nObjectType=8\nSubNumber=2\n\
         [2004sub0]\nParameterName=n\nDataType=5\nAccessType=ro # count\n[2004sub1]\nParameterName=f\nDataType=5\nAccessType=rw\n"
    ));
    let kinds = "allowed are 0 (NULL), 2 (DOMAIN), 5 (DEFTYPE), 6 (DEFSTRUCT), 7 (VAR), 8 (ARRAY), 9 (RECORD)";
    let accesses = "allowed are ro, wo, rw, rwr, rww and const";
    let no_number = "is no number: decimal (12), hexadecimal (0x0C) or octal (014)";
    assert_eq!(
        warnings(&dictionary),
        [
            format!("line 9: [2001] AccessType=UNKNOWN: {accesses}; the object is left out"),
            format!(
                "line 13: [2002] DataType=0x0007 # 32 bits: \"0x0007 # 32 bits\" {no_number}; allowed is the number of a data type, \
                 like 0x0007 for UNSIGNED32; the object is left out"
            ),
            format!("line 17: [2003] ObjectType=0x7 # one value: {kinds}; the object is left out"),
            format!("line 27: [2004sub0] AccessType=ro # count: {accesses}; the object is left out"),
        ]
    );
    let objects: Vec<_> = dictionary.entries().map(|(object, _)| object).collect();
    assert_eq!(objects, [at(0x2000, 0), at(0x2004, 1)]);
    // A value in any section of the index is lost with the ObjectType.
    let odd = "[2003]\nParameterName=d\nObjectType=0x7 # one value\n";
    for value in
        ["DataType=5\nAccessType=rw\nParameterValue=1\n", "[2003sub1]\nParameterValue=1\n", "[2003Value]\n1=1\n"]
    {
        let expected = format!("line 8: [2003] ObjectType=0x7 # one value: {kinds}");
        assert_eq!(errors(&format!("{good}{odd}{value}")), expected, "{value}");
    }
    let no_values = format!("{good}{odd}[2003Value]\nNrOfEntries=0\n1=\n");
    assert_eq!(warnings(&read(&no_values)).len(), 1);
    // Values of a compact array are lost with its access type.
    let compact =
        "[2003]\nParameterName=d\nObjectType=8\nCompactSubObj=2\nDataType=5\nAccessType=UNKNOWN\n[2003Value]\n1=1\n";
    let lost = "line 13: [2003Value] 1=1: no object takes the value: CompactSubObj of the index makes none";
    let expected = format!("line 11: [2003] AccessType=UNKNOWN: {accesses}\n{lost}");
    assert_eq!(errors(&format!("{good}{compact}")), expected);
}

#[test]
fn a_file_without_objects_and_one_that_is_too_large_are_refused() {
    let of = |bytes: &[u8]| parse(bytes, None).unwrap_err().to_string();
    assert_eq!(of(b""), "the file has no objects: there is no section like [1000]");
    assert_eq!(of(&vec![b'\n'; LARGEST_FILE + 1]), "the file has 16777217 bytes; 16777216 (16 MiB) are allowed");
    assert_eq!(of(b"\xFF\xFE[\0"), "the file is UTF-16; UTF-8 and Latin-1 are allowed");
    assert_eq!(parse(OWN, Some(128)).unwrap_err().to_string(), "the node id 128 is not within 1 and 127");
    assert_eq!(parse(OWN, Some(0)).unwrap_err().to_string(), "the node id 0 is not within 1 and 127");
}

#[test]
fn number_of_objects_of_small_file_is_limited() {
    let one = |index: u32| {
        format!("[{index:04X}]\nParameterName=a\nObjectType=8\nDataType=5\nAccessType=ro\nCompactSubObj=254\n")
    };
    let file: String = (0x1000..0x2000).map(one).collect();
    assert!(errors(&file).ends_with("the file has more than 100000 objects"));
}

#[test]
fn long_names_and_long_values_for_many_objects_are_cut() {
    let (name, value) = ("n".repeat(300), "d".repeat(256));
    let dictionary = read(&format!(
        "[2000]\nParameterName={name}\nObjectType=8\nDataType=9\nAccessType=ro\nCompactSubObj=254\nDefaultValue={value}\n"
    ));
    assert_eq!(dictionary.index_description(0x2000).unwrap().name.len(), 255);
    // A name with a number is not longer than any other name.
    assert_eq!(dictionary.entry(at(0x2000, 254)).unwrap().name, format!("{}254", "n".repeat(252)));
    assert_eq!(dictionary.default_value(at(0x2000, 254)), None);
    let warnings = warnings(&dictionary);
    assert_eq!(warnings[0], "line 3: the name is longer than 255 characters, and is cut");
    assert!(warnings[1].ends_with("a value for many objects has at most 255 bytes; passed over"), "{warnings:?}");
}

#[test]
fn all_keys_of_a_device_and_of_its_place_are_read() {
    let dictionary = read(
        "VendorName=a\nVendorNumber=0x000000FB\nProductName=b\nProductNumber=0x61500000\nRevisionNumber=0x01700000\nOrderCode=c\n\
         BaudRate_1000=1\nBaudRate_10=0\nBaudRate_x=1\nSimpleBootUpMaster=1\nSimpleBootUpSlave=1\nGranularity=8\n\
         DynamicChannelsSupported=2\nCompactPDO=23\nGroupMessaging=1\nNrOfRXPDO=4\nNrOfTXPDO=513\nLSS_Supported=1\n\
         [DeviceComissioning]\nNodeID=128\nNodeName=d\nBaudrate=1000\nNetNumber=3\nNetworkName=e\nCANopenManager=1\n\
         LSS_SerialNumber=7\n[1000]\nParameterName=f\nDataType=7\nAccessType=ro\n",
    );
    let device = DeviceInfo {
        vendor_name: "a".to_owned(),
        vendor_number: Some(0xFB),
        product_name: "b".to_owned(),
        product_number: Some(0x6150_0000),
        revision_number: Some(0x0170_0000),
        order_code: "c".to_owned(),
        baud_rates: BTreeSet::from([1000]),
        denied_baud_rates: BTreeSet::from([10]),
        is_boot_up_master: true,
        is_boot_up_slave: true,
        granularity: Some(8),
        dynamic_channels: Some(2),
        compact_pdo: Some(23),
        has_group_messaging: true,
        receive_pdos: Some(4),
        transmit_pdos: None,
        has_lss: true,
    };
    assert_eq!(dictionary.device, device);
    let place = Commissioning {
        node_id: None,
        node_name: "d".to_owned(),
        baud_rate: Some(1000),
        net_number: Some(3),
        network_name: "e".to_owned(),
        is_manager: true,
        lss_serial_number: Some(7),
    };
    assert_eq!(dictionary.commissioning, Some(place));
    assert_eq!(
        warnings(&dictionary),
        [
            "line 10: [DeviceInfo] BaudRate_x=1: the key is not BaudRate_ and a number of kbit/s; passed over",
            "line 18: [DeviceInfo] NrOfTXPDO=513: 513 is not within 0 and 512; passed over",
            "line 21: [DeviceComissioning] NodeID=128: 128 is not within 1 and 127; passed over",
        ]
    );
}

#[test]
fn missing_keys_have_safe_defaults() {
    let dictionary = read(
        "[2000]\nDataType=5\n[2001]\nParameterName=a\nAccessType=rw\n[2002]\nParameterName=Data\nObjectType=2\n\
         [2003sub1]\nParameterName=b\nDataType=5\nAccessType=ro\n[2004]\nParameterName=c\nObjectType=8\nDataType=8\n",
    );
    assert_eq!(
        warnings(&dictionary),
        [
            "line 2: the section \"2000\" has no AccessType; ro is taken",
            "line 2: the section \"2000\" has no ParameterName",
            "line 4: the section \"2001\" has no DataType; the object is left out",
            "line 10: the section [2003] is missing; the object is taken as a RECORD",
            "line 14: the section \"2004\" has no SubNumber, and 0 subindices",
        ]
    );
    assert_eq!(dictionary.index_description(0x2000).unwrap().name, "2000h");
    assert_eq!(dictionary.entry(at(0x2000, 0)).unwrap().access, Access::Ro);
    assert_eq!(dictionary.index_description(0x2001), None);
    let domain = dictionary.entry(at(0x2002, 0)).unwrap();
    assert_eq!((domain.data_type, domain.access), (DataType::Domain, Access::Rw));
    assert!(dictionary.entry(at(0x2003, 1)).is_some());
}

#[test]
fn wrong_object_lists_are_reported_and_ignored() {
    let dictionary = read(
        "[MandatoryObjects]\nSupportedObjects=0x7FFFFFFF\n1=0x1000\n2=0x1001\n[ManufacturerObjects]\nSupportedObjects=0\n1=x\n\
         [1000]\nParameterName=a\nDataType=7\nAccessType=ro\n[2000]\nParameterName=a\nDataType=7\nAccessType=ro\n",
    );
    assert_eq!(
        dictionary.warnings().to_string(),
        "1 objects stand in no list of objects: 2000h; they are taken\n\
         line 3: [MandatoryObjects] SupportedObjects=0x7FFFFFFF: the list has 2 objects; passed over\n\
         line 5: [MandatoryObjects] 2=0x1001: there is no section [1001]; passed over\n\
         line 7: [ManufacturerObjects] SupportedObjects=0: the list has 1 objects; passed over\n\
         line 8: [ManufacturerObjects] 1=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); passed over"
    );
    assert_eq!(dictionary.entries().count(), 2);
}

#[test]
fn latin_1_and_windows_lines_make_no_difference() {
    let file = b"[DeviceInfo]\r\nVendorName=M\xFCller\r\n[2000]\r\nParameterName=L\xE4nge\r\nDataType=0x0009\r\nAccessType=rw\r\nDefaultValue=5 \xB5m;x\r\n";
    let dictionary = parse(file, None).unwrap();
    assert_eq!(dictionary.device.vendor_name, "Müller");
    assert_eq!(dictionary.find("länge"), Ok(at(0x2000, 0)));
    let value = dictionary.default_value(at(0x2000, 0)).unwrap();
    assert_eq!(value.to_bytes(DataType::VisibleString).unwrap(), b"5 \xB5m;x");
}

#[test]
fn file_and_device_information_is_kept() {
    let dictionary = read(
        "[Comments]\nLines=3\nLine1=| Don't panic |\nLine10=c\nLine2=\n[DummyUsage]\nDummy0001=0\nDummy0003=1\nDummy0005=1\n\
         [ToolInfos]\nToolVersion=1\n[1000]\nDataType=7\n",
    );
    assert_eq!(dictionary.comments, ["| Don't panic |", "", "c"]);
    assert_eq!(dictionary.dummies.iter().copied().collect::<Vec<_>>(), [3, 5]);
}

/// Forms of lines in files of maxon, Technosoft, Elmo and Danfoss, and of tools; the values are our own.
#[test]
fn lines_as_vendors_write_them_are_understood() {
    let dictionary = read(
        "\n;*****\n[2000]\nParameterName=COB-ID\nObjectType=0x7\n;StorageLocation=RAM\nDataType=0x7\nAccessType=RW\n\
         DefaultValue=$NODEID + 0x80000300\nPDOMapping=0\nObjFlags=1\n \n\
         [2001]\nParameterName=Inhibit time\nObjectType=7\nDataType=6\nAccessType=rw ; at any time\nDefaultValue=0x012C\nPDOMapping=0x0\n\
         [2002]\nSubNumber=3\nParameterName=Restore\nObjectType=0x8\n\
         [2002Sub0]\nParameterName=Highest\nDataType=0x5\nAccessType=ro\nDefaultValue=4\n\
         [2002sub1]\nParameterName=All\nDataType=0x7\nAccessType=rww\nDefaultValue=\n\
         [2002subA]\nParameterName=Factory\nDataType=0x04\nAccessType=rww\nLowLimit=-2147483648\nHighLimit=0x7FFFFFFF\n\
         [2003]\nParameterName=Command\nDataType=0x000a\nAccessType=wo\nDefaultValue=\n\
         [2004]\nParameterName=Reset\nDataType=0x0007\nAccessType=wo\nDefaultValue=0.0\n",
    );
    assert_eq!(
        warnings(&dictionary),
        [
            "line 50: [2004] DefaultValue=0.0: \"0.0\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); passed over"
        ]
    );
    assert_eq!(dictionary.default_value(at(0x2000, 0)), Some(Value::Unsigned(0x8000_0305)));
    assert!(!dictionary.entry(at(0x2000, 0)).unwrap().is_configurable());
    assert_eq!(dictionary.default_value(at(0x2001, 0)), Some(Value::Unsigned(300)));
    let subs: Vec<u8> = dictionary.entries_of(0x2002).map(|(object, _)| object.sub).collect();
    assert_eq!(subs, [0, 1, 10]);
    assert_eq!(dictionary.low_limit(at(0x2002, 10)), Some(Value::Integer(i64::from(i32::MIN))));
    assert_eq!(dictionary.high_limit(at(0x2002, 10)), Some(Value::Integer(i64::from(i32::MAX))));
    assert_eq!(dictionary.entry(at(0x2003, 0)).unwrap().data_type, DataType::OctetString);
}

#[test]
fn canfestival_type_definition_is_resolved() {
    let dictionary = read(
        "[A0]\nParameterName=limits\n[A0sub1]\nDefaultValue=0x3\n[2000]\nParameterName=a\nDataType=0x00A0\nAccessType=rw\nDefaultValue=-3\n\
         [2001]\nParameterName=b\nDataType=0x40\nAccessType=rw\nDefaultValue=0x0\n",
    );
    assert_eq!(dictionary.entry(at(0x2000, 0)).unwrap().data_type, DataType::Integer16);
    assert_eq!(dictionary.default_value(at(0x2000, 0)), Some(Value::Integer(-3)));
    assert_eq!(dictionary.entry(at(0x2001, 0)).unwrap().data_type, DataType::Other(0x40));
    assert_eq!(
        warnings(&dictionary),
        [
            "line 15: [2001] DefaultValue=0x0: \"0x0\" cannot be read: values of data type 0040h are not known; passed over"
        ]
    );
}
