//! Tests of devices with terminals, and of missing process data.

use super::*;

/// A module with 16 inputs and 8 outputs, an analog input and an analog output, at node 3. Its outputs are sent in each cycle, and its
/// inputs are the last received ones. They are invalid until both of its PDOs have arrived, and after a boot-up.
#[test]
fn module_maps_inputs_and_outputs_of_machine() {
    let terminal = |place, address| Terminal { place, address };
    let analog = |place, address| AnalogTerminal { terminal: terminal(place, address), volts_at_full_scale: 10.0 };
    let terminals = Terminals {
        digital_inputs: vec![terminal(0, 15)],
        digital_outputs: vec![terminal(1, 7)],
        analog_inputs: vec![analog(0, 0)],
        analog_outputs: vec![analog(0, 1)],
        ..Terminals::default()
    };
    let mut config = drive(0, 3, Monitoring::None);
    config.role = Role::Module;
    config.layout = Layout::module(node(3), &terminals).unwrap();
    config.terminals = terminals;
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    (rig.inputs.digital, rig.inputs.analog) = (vec![0], vec![0.0]);
    (rig.outputs.digital, rig.outputs.analog) = (vec![0b10], vec![-5.0]);
    let seen = |rig: &Rig| (rig.inputs.digital[0], rig.inputs.analog[0]);
    rig.comes(0x183, &[0x00, 0x80]);
    rig.cycle();
    assert_eq!(seen(&rig), (0, 0.0), "its analog word has not come");
    rig.comes(0x283, &[0xFF, 0x7F]);
    rig.sent();
    assert_no_alloc(|| rig.cycle());
    assert_eq!(seen(&rig), (1, 10.0));
    let sent: Vec<_> = rig.sent().iter().map(hex).collect();
    // -5 V of 10 V are -16383.5 of 32767, rounded away from 0: C000h.
    assert_eq!(sent, ["203#80", "303#000000C0", "205#00000000000000", "080#"]);
    rig.comes(0x703, &[0]);
    rig.cycle();
    assert_eq!(seen(&rig), (0, 0.0));
    assert_eq!(rig.sent().iter().map(hex).collect::<Vec<_>>(), ["205#00000000000000", "080#"]);
    assert_eq!(violation_count(), 0);
}

/// An encoder starts a new coordinate system after a boot-up, and counts on after a silence.
#[test]
fn booted_encoder_starts_new_epoch() {
    let mut config = drive(0, 3, Monitoring::None);
    config.role = Role::Encoder;
    config.layout = Layout::encoder(node(3)).unwrap();
    config.terminals = Terminals { encoders: vec![Encoder { place: 0, is_absolute: false }], ..Terminals::default() };
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    rig.inputs.encoder = vec![EncoderInput::default()];
    let mut seen = Vec::new();
    for boots in [false, false, true] {
        if boots {
            rig.comes(0x703, &[0]);
            rig.cycle();
            assert!(!rig.inputs.encoder[0].valid);
        }
        rig.order(Order::Prepare { device: 0 });
        rig.order(Order::Begin { device: 0, fault: 0 });
        rig.cycle();
        rig.comes(0x283, &[7, 0, 0, 0]);
        rig.cycle();
        assert!(rig.inputs.encoder[0].valid);
        seen.push(rig.inputs.encoder[0].epoch);
    }
    assert_eq!(seen, [1, 1, 2]);
}

/// Efforts are per mille of rated torque, as 16 bits in both directions.
#[test]
fn torque_drive_uses_per_mille_of_rated_torque() {
    let mut config = drive(0, 3, Monitoring::None);
    config.layout = Layout::plan(node(3), DriveMode::Cst, Extras::default(), &config.terminals, None).unwrap();
    as_drive(&mut config).mode = DriveMode::Cst;
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    for (effort, word) in [
        (250.4, 250),
        (250.6, 251),
        (-250.4, -250),
        (-250.6, -251),
        (0.0, 0),
        (1e9, i16::MAX),
        (-1e9, i16::MIN),
        (f64::NAN, 0),
    ] {
        rig.comes(0x283, &(-137_i16).to_le_bytes());
        rig.answer(0x0237, 100, 10);
        rig.outputs.drive[0].effort = effort;
        rig.cycle();
        assert_eq!(rig.inputs.drive[0].effort, -137.0);
        let sent = rig.sent();
        let asked = sent.iter().find(|frame| frame.id().get() == 0x203).expect("PDO 1 of the drive").bytes();
        assert_eq!(i16::from_le_bytes([asked[2], asked[3]]), word, "{effort}");
    }
}

/// 100 counts per cycle: while process data is missing, the position stays or is extrapolated, for the configured number of cycles. One per
/// mille of rated torque is 2 mNm.
#[test]
fn missing_process_data_is_held_or_extrapolated() {
    for (extrapolates, expected) in [(false, [200; 4]), (true, [300, 400, 500, 500])] {
        let mut config = drive(0, 3, Monitoring::None);
        let extras = Extras { torque: true, ..Extras::default() };
        config.layout = Layout::plan(node(3), DriveMode::Csp, extras, &config.terminals, None).unwrap();
        as_drive(&mut config).missed = MissingDataBehaviour { cycles: 3, extrapolates };
        as_drive(&mut config).rated_effort = Some(2.0);
        let mut rig = Rig::running(Monitoring::None);
        rig.replace_first(&config);
        rig.comes(0x283, &(-500_i16).to_le_bytes());
        for position in [100, 200] {
            rig.answer(0x0237, position, MODE_CSP);
            rig.cycle();
        }
        assert_eq!((rig.inputs.drive[0].count, rig.inputs.drive[0].effort), (200, -1.0));
        let held = expected.map(|_| {
            rig.cycle();
            assert_eq!((rig.inputs.drive[0].fresh, rig.inputs.drive[0].velocity), (false, 100_000.0));
            rig.inputs.drive[0].count
        });
        assert_eq!(held, expected);
        rig.answer(0x0237, 450, MODE_CSP);
        rig.cycle();
        assert_eq!((rig.inputs.drive[0].fresh, rig.inputs.drive[0].count), (true, 450));
    }
}

/// Bits of 60FDh and 60FEh:01 of a drive, and its counts as an encoder of the machine.
#[test]
fn drive_inputs_and_outputs_are_terminals() {
    let terminal = |place, address| Terminal { place, address };
    let terminals = Terminals {
        digital_inputs: vec![terminal(0, 17)],
        digital_outputs: vec![terminal(0, 16)],
        encoders: vec![Encoder { place: 0, is_absolute: false }],
        ..Terminals::default()
    };
    let mut config = drive(0, 3, Monitoring::None);
    config.layout = Layout::plan(node(3), DriveMode::Csp, Extras::default(), &terminals, None).unwrap();
    config.terminals = terminals;
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    (rig.inputs.digital, rig.inputs.encoder) = (vec![0], vec![EncoderInput::default()]);
    rig.outputs.digital = vec![1];
    rig.answer(0x0231, -7, MODE_CSP);
    rig.comes(0x283, &[0, 0, 2, 0]);
    rig.cycle();
    let encoder = EncoderInput { count: -7, epoch: 0, valid: true, index: None };
    assert_eq!((rig.inputs.digital[0], rig.inputs.encoder[0]), (1, encoder));
    let sent: Vec<_> = rig.sent().iter().map(hex).collect();
    assert_eq!(sent[..2], ["203#00000000000000", "303#00000100"]);
    (0..11).for_each(|_| rig.cycle());
    assert_eq!((rig.inputs.digital[0], rig.inputs.encoder[0].valid), (0, false), "silent for more than 10 cycles");
}
