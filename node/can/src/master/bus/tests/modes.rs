//! Tests of drives that cannot map 6060h or 6061h to a PDO.

use super::super::super::fixtures::dictionary_without;
use super::*;

/// Returns a rig with drive 0, node 3, that cannot map these objects.
fn by_sdo(objects: &[&str]) -> Rig {
    let mut config = drive(0, 3, Monitoring::None);
    let known = dictionary_without(objects);
    config.layout = Layout::plan(node(3), DriveMode::Csp, Extras::default(), &config.terminals, Some(&known)).unwrap();
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    rig.outputs.drive[0] = DriveOutput { control: control::SWITCH_ON, mode: Mode::Position, ..Default::default() };
    rig
}

/// Simulated SDO server of node 3.
#[derive(Default)]
struct Server {
    mode: i8,
    /// Modes that were written.
    written: Vec<i8>,
    reads: usize,
}

impl Server {
    /// Answers the sent requests.
    fn serve(&mut self, rig: &Rig, sent: &[Frame]) {
        for frame in sent.iter().filter(|frame| frame.id().get() == 0x603) {
            let &[command, low, high, sub, data, ..] = frame.bytes() else { continue };
            match (command, u16::from_le_bytes([low, high])) {
                (0x40, 0x6061) => {
                    self.reads += 1;
                    rig.comes(0x583, &[0x4F, low, high, sub, self.mode.cast_unsigned(), 0, 0, 0]);
                    continue;
                }
                (0x2F, 0x6060) => {
                    self.mode = data.cast_signed();
                    self.written.push(self.mode);
                }
                (0x80, _) => continue,
                _ => {}
            }
            rig.comes(0x583, &[0x60, low, high, sub, 0, 0, 0, 0]);
        }
    }

    /// Runs a cycle in which the drive sends these values and answers. Returns the control word that it received.
    fn turn(&mut self, rig: &mut Rig, status: u16, position: i32) -> u8 {
        rig.answer(status, position, self.mode);
        rig.cycle();
        let sent = rig.sent();
        self.serve(rig, &sent);
        let asked = sent.iter().find(|frame| frame.id().get() == 0x203).expect("PDO 1 of the drive");
        asked.bytes()[0]
    }
}

fn mode_of(rig: &Rig) -> i8 {
    rig.inputs.drive[0].mode
}

/// 6060h is written, then 6061h is read; the mode is valid with the second status word after the answer. The drive is not enabled before
/// that, even if another client has changed the mode meanwhile.
#[test]
fn mode_by_sdo_is_confirmed_before_the_drive_is_enabled() {
    let (mut rig, mut server) = (by_sdo(&["6060", "6061"]), Server::default());
    let shown = [(); 6].map(|()| {
        server.turn(&mut rig, 0x0233, 0);
        mode_of(&rig)
    });
    assert_eq!(shown, [0, 0, 0, 8, 8, 8]);
    assert_eq!((server.written.as_slice(), server.reads), ([8].as_slice(), 1));
    server.mode = 3;
    rig.outputs.drive[0].control = control::ENABLE;
    let sent = [(); 6].map(|()| {
        let control = server.turn(&mut rig, 0x0233, 0);
        (control, mode_of(&rig))
    });
    assert_eq!(sent, [(7, 8), (7, 0), (7, 0), (15, 8), (15, 8), (15, 8)]);
    assert_eq!((server.written.as_slice(), server.mode), ([8, 8].as_slice(), 8));
    // An enabled drive receives its control word without delay.
    assert_eq!((server.turn(&mut rig, 0x1237, 0), server.reads), (15, 2));
}

/// The drive never changes to the mode, so it is never enabled.
#[test]
fn drive_in_another_mode_is_not_enabled() {
    let (mut rig, mut server) = (by_sdo(&["6060", "6061"]), Server::default());
    rig.outputs.drive[0].control = control::ENABLE;
    let begin = Instant::now();
    for _ in 0..50 {
        assert_eq!(server.turn(&mut rig, 0x0233, 0), 7);
        server.mode = 3;
        assert_ne!(mode_of(&rig), 8);
        std::thread::sleep(Duration::from_millis(1));
    }
    let most = begin.elapsed().as_millis() as usize / 10 + 1;
    assert!((2..=most).contains(&server.reads), "{} reads, one in 10 ms: others have their turn", server.reads);
}

/// Only 6060h cannot be mapped: 6061h is in TPDO 1.
#[test]
fn mapped_mode_display_is_not_read_by_sdo_in_cycles() {
    let (mut rig, mut server) = (by_sdo(&["6060"]), Server::default());
    rig.outputs.drive[0].control = control::ENABLE;
    let sent = [(); 3].map(|()| {
        let control = server.turn(&mut rig, 0x0233, 0);
        (control, mode_of(&rig))
    });
    // The mode that the server has accepted is in the next process data.
    assert_eq!(sent, [(7, 0), (15, 8), (15, 8)]);
    assert_eq!((server.written.as_slice(), server.reads), ([8].as_slice(), 0));
}

/// Only 6061h cannot be mapped: 6060h is in RPDO 1.
#[test]
fn mapped_mode_is_not_written_by_sdo() {
    let (mut rig, mut server) = (by_sdo(&["6061"]), Server { mode: 8, ..Server::default() });
    let shown = [(); 4].map(|()| {
        server.turn(&mut rig, 0x0233, 0);
        mode_of(&rig)
    });
    assert_eq!(shown, [0, 0, 8, 8]);
    assert_eq!((server.written.as_slice(), server.reads), ([].as_slice(), 1));
}

/// A read times out. Its answer arrives as the answer to the next read.
#[test]
fn late_answer_does_not_confirm_a_mode() {
    let (mut rig, mut server) = (by_sdo(&["6060", "6061"]), Server::default());
    let reads = |sent: &[Frame]| sent.iter().any(|frame| hex(frame) == "603#4061600000000000");
    server.turn(&mut rig, 0x0233, 0);
    rig.cycle();
    assert!(reads(&rig.sent()));
    std::thread::sleep(Duration::from_nanos(SDO_TIMEOUT_NS + 1_000_000));
    rig.cycle();
    let Ok(Report::ModeRefused(0, SdoError::Silent(object, _))) = rig.reports.pop() else { panic!("it is reported") };
    assert_eq!(object, objects::MODE_DISPLAY);
    std::thread::sleep(Duration::from_millis(12));
    rig.sent();
    rig.cycle();
    assert!(reads(&rig.sent()));
    rig.comes(0x583, &[0x4F, 0x61, 0x60, 0, 8, 0, 0, 0]);
    for _ in 0..4 {
        rig.answer(0x0233, 0, 0);
        rig.cycle();
        assert_eq!(mode_of(&rig), 0);
    }
}

/// The refusal is reported once, and another mode can be written.
#[test]
fn refused_mode_is_reported_once() {
    let mut rig = by_sdo(&["6060", "6061"]);
    for _ in 0..4 {
        rig.cycle();
        for _ in rig.sent().iter().filter(|frame| frame.id().get() == 0x603) {
            rig.comes(0x583, &[0x80, 0x60, 0x60, 0, 0x30, 0, 9, 6]);
        }
    }
    assert!(matches!(rig.reports.pop(), Ok(Report::ModeRefused(0, SdoError::Refused(..)))));
    assert!(rig.reports.pop().is_err());
    // The drive may accept the mode later: it is written again when the drive is enabled.
    rig.outputs.drive[0].control = control::ENABLE;
    rig.answer(0x0233, 0, 0);
    rig.cycle();
    let is_written = |frame: &Frame| hex(frame) == "603#2F60600008000000";
    assert!(rig.sent().iter().any(is_written));
}

/// The axis sees homing attained only once the drive is in mode 8 again, so that it cannot move before. Then bits 10 and 12 are reported,
/// with mode 6.
#[test]
fn homing_by_sdo_ends_after_return_to_cyclic_mode() {
    let (mut rig, mut server) = (by_sdo(&["6060", "6061"]), Server::default());
    rig.outputs.drive[0].control = control::ENABLE;
    (0..4).for_each(|_| assert_eq!(server.turn(&mut rig, 0x1237, 1000), 15));
    assert_eq!(mode_of(&rig), 8);
    rig.outputs.drive[0].mode = Mode::Homing(HOME);
    for _ in 0..12 {
        let status = if server.mode == MODE_HOMING { 0x0637 } else { 0x1237 };
        server.turn(&mut rig, status, 1000);
    }
    assert_eq!((mode_of(&rig), rig.inputs.drive[0].epoch), (MODE_HOMING, 0));
    rig.outputs.drive[0].control = control::ENABLE | control::START_HOMING;
    assert_eq!(server.turn(&mut rig, 0x0637, 1000), 0x1F);
    server.turn(&mut rig, 0x0237, 900);
    let mut seen = Vec::new();
    for _ in 0..7 {
        let status = if server.mode == MODE_HOMING { 0x1637 } else { 0x1237 };
        assert_eq!(server.turn(&mut rig, status, -3), 0x0F, "bit 4 means something else in other modes");
        let DriveInput { mode, status, count, epoch, .. } = rig.inputs.drive[0];
        seen.push((mode, status));
        assert_eq!((count, epoch), (-3, 1));
    }
    let (under_way, over) = ((MODE_HOMING, 0x0237), (MODE_HOMING, 0x1637));
    assert_eq!(seen, [under_way, under_way, under_way, under_way, over, over, over]);
    assert_eq!(server.written, [8, 6, 8]);
    rig.outputs.drive[0] = DriveOutput { control: control::ENABLE, mode: Mode::Position, ..Default::default() };
    for _ in 0..2 {
        server.turn(&mut rig, 0x1237, -3);
    }
    let DriveInput { mode, status, epoch, .. } = rig.inputs.drive[0];
    assert_eq!((mode, status, epoch), (MODE_CSP, 0x1237, 1));
}

/// 8 is commanded again before 6 was confirmed. The 8 that was read before is not reported, because the drive may be in 6; it is disabled.
#[test]
fn aborted_homing_disables_drive_until_return_to_cyclic_mode() {
    let (mut rig, mut server) = (by_sdo(&["6060", "6061"]), Server::default());
    rig.outputs.drive[0].control = control::ENABLE;
    (0..4).for_each(|_| assert_eq!(server.turn(&mut rig, 0x1237, 0), 15));
    assert_eq!(mode_of(&rig), 8);
    rig.outputs.drive[0].mode = Mode::Homing(HOME);
    while server.mode != MODE_HOMING {
        server.turn(&mut rig, 0x1237, 0);
    }
    rig.outputs.drive[0].mode = Mode::Position;
    let shown = [(); 5].map(|()| {
        let control = server.turn(&mut rig, 0x1237, 0);
        (control, mode_of(&rig), server.mode)
    });
    // The write of 8, its answer, two status words. Until then the drive could jump to the position of the axis, so its operation is
    // disabled.
    assert_eq!(shown, [(7, 0, 8), (7, 0, 8), (7, 0, 8), (15, 8, 8), (15, 8, 8)]);
}

/// A target velocity of the homing would move a drive that is not in mode homing yet.
#[test]
fn drive_in_csv_has_target_velocity_zero_while_a_homing_is_set_up() {
    let mut config = drive(0, 3, Monitoring::None);
    as_drive(&mut config).mode = DriveMode::Csv;
    config.layout = Layout::plan(node(3), DriveMode::Csv, Extras::default(), &config.terminals, None).unwrap();
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    for (mode, sent) in [(Mode::Velocity, 50_000_i32), (Mode::Homing(HOME), 0), (Mode::Velocity, 50_000)] {
        rig.outputs.drive[0] =
            DriveOutput { velocity: 50_000.0, control: control::ENABLE, mode, ..DriveOutput::default() };
        rig.cycle();
        let frames = rig.sent();
        let asked = frames.iter().find(|frame| frame.id().get() == 0x203).expect("PDO 1 of the drive").bytes();
        assert_eq!(asked[2..6], sent.to_le_bytes(), "{mode:?}");
    }
}

#[test]
fn mode_exchange_allocates_no_memory() {
    let (mut rig, mut server) = (by_sdo(&["6060", "6061"]), Server::default());
    server.written.reserve(100);
    let before = violation_count();
    for cycle in 0..200 {
        rig.outputs.drive[0].mode = if cycle % 40 < 20 { Mode::Position } else { Mode::Homing(HOME) };
        rig.answer(0x0237, cycle, 0);
        assert_no_alloc(|| rig.cycle());
        let sent = rig.sent();
        server.serve(&rig, &sent);
        while rig.reports.pop().is_ok() {}
    }
    assert!(server.written.len() >= 8, "{:?}", server.written);
    assert_eq!(violation_count(), before);
}
