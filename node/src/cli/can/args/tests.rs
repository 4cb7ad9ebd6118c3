use super::*;
use crate::cli::Line;
use clap::{CommandFactory, Parser};

fn parse(line: &str) -> Result<CanCommand, String> {
    let words = ["lineshaft", "can"].into_iter().chain(line.split(' '));
    match Line::try_parse_from(words).map_err(|error| error.to_string())?.command {
        Some(crate::cli::Command::Can(command)) => Ok(command),
        other => panic!("{other:?}"),
    }
}

#[test]
fn values_may_be_negative_and_options_stand_anywhere() {
    for line in [
        "sdo write 3 607A -5 --bus socketcan:can0 --type i32",
        "sdo write --bus socketcan:can0 --type i32 3 607A -5",
        "sdo write 3 607A -0x05 --type i32 --bus socketcan:can0",
    ] {
        let Ok(CanCommand::Sdo(SdoCommand::Write(args))) = parse(line) else { panic!("{line}: {:?}", parse(line)) };
        assert!(args.value.is_some_and(|value| value.starts_with('-') && value.ends_with('5')), "{line}");
        assert!(args.kind.is_some());
    }
    let line = "sdo write 3 2100 --file firmware.bin --bus socketcan:can0";
    let Ok(CanCommand::Sdo(SdoCommand::Write(args))) = parse(line) else { panic!("{:?}", parse(line)) };
    assert_eq!((args.value, args.file), (None, Some("firmware.bin".into())));
}

#[test]
fn a_bus_or_a_cell_is_needed_and_not_both() {
    assert!(parse("scan").unwrap_err().contains("--bus <ADDRESS>"));
    assert!(parse("scan --bus socketcan:can0 --cell a.yaml").unwrap_err().contains("cannot be used with"));
    assert!(parse("scan --cell a.yaml --bitrate 500000").unwrap_err().contains("cannot be used with"));
    assert!(parse("scan --bus socketcan:can0 --backend a").unwrap_err().contains("cannot be used with"));
    assert!(parse("scan --backend a").unwrap_err().contains("--bus <ADDRESS>"));
    assert!(parse("scan --cell a.yaml --backend a").is_ok());
}

#[test]
fn words_beyond_their_range_are_refused_with_it() {
    let rows = [
        ("info 128 --bus socketcan:can0", "\"128\" is no node; 1 to 127 is allowed"),
        ("nmt every start --bus socketcan:can0", "\"every\" is no node; 1 to 127 is allowed, or all"),
        ("scan --bus socketcan:can0 --bitrate 9999", "\"9999\" is no bit rate; 10000 to 1000000 bit/s is allowed"),
        ("scan --bus socketcan:can0 --bitrate 1M", "\"1M\" is no bit rate"),
        (
            "scan --bus slcan:/dev/ttyUSB0 --serial-baudrate 115201",
            "\"115201\" is no baud rate of a serial line; 9600, 19200, 38400, ",
        ),
        ("scan --bus can0", "'can0' is no CAN bus; allowed are slcan:/dev/ttyACM0"),
        ("scan --bus socketcan:can0 --timeout 0.009", "0.009 is not allowed; 10 ms to 60 s is"),
        ("monitor --bus socketcan:can0 --for 0", "0 is not allowed; 1 ms to 86400 s is"),
        ("monitor --bus socketcan:can0 --eds a.eds", "--node <NODE>"),
        (
            "nmt 3 begin --bus socketcan:can0",
            "[possible values: start, stop, pre-operational, reset-node, reset-communication]",
        ),
        (
            "sdo read 3 6064 --type u9 --bus socketcan:can0",
            "u8, u16, u32, u64, i8, i16, i32, i64, f32, f64, string, bytes, domain",
        ),
        ("lss store --bus socketcan:can0 --vendor 1", "--product <NUMBER>"),
        ("lss bit-rate 100000 --bus socketcan:can0", "\"100000\" is no bit rate of LSS; 1000000, 800000, 500000, "),
        ("scna", "a similar subcommand exists: 'scan'"),
    ];
    for (line, sentence) in rows {
        let error = parse(line).unwrap_err();
        assert!(error.contains(sentence), "{line}: {error}");
    }
}

#[test]
fn times_have_units() {
    assert_eq!(timeout("500 ms"), Ok(Duration::from_millis(500)));
    assert_eq!(timeout("0.01"), Ok(Duration::from_millis(10)));
    assert!(timeout("5 mm").is_err());
    assert_eq!(for_time("10 s"), Ok(Duration::from_secs(10)));
}

#[test]
fn identities_are_decimal_or_hexadecimal() {
    for (text, value) in [("251", 251), ("0xFB", 251), ("0000FFFFh", 0xFFFF), ("0xFFFFFFFF", u32::MAX), ("0", 0)] {
        assert_eq!(number(text), Ok(value));
    }
    for text in ["", "FB", "-1", "+0x1", "0x+1", "0x100000000", "1.5", "h"] {
        assert!(number(text).is_err_and(|sentence| sentence.ends_with("or 0x0 to 0xFFFFFFFF")), "{text}");
    }
}

/// Each help text describes the command, with an example and its exit codes.
#[test]
fn every_help_has_an_example() {
    let line = Line::command();
    let can = line.find_subcommand("can").unwrap();
    let (groups, single): (Vec<_>, Vec<_>) =
        can.get_subcommands().filter(|command| command.get_name() != "help").partition(|one| one.has_subcommands());
    for command in single.into_iter().chain(groups.into_iter().flat_map(|group| group.get_subcommands())) {
        let help = command.clone().render_long_help().to_string();
        let has_example =
            ["Example:", "Examples:"].iter().any(|head| help.contains(&format!("{head}\n  lineshaft can ")));
        assert!(has_example && help.contains("Exit codes: 0 "), "{help}");
    }
}
