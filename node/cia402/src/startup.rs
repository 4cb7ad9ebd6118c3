//! Checks and values of a drive before its cycles, with its axis off.
//!
//! Law      an enabled drive is stopped on its quick stop ramp, then its voltage is disabled
//! Reads    6041h, 6502h, 608Fh, 6091h, 6092h
//! Refuses  a drive that does not support its mode, or that counts otherwise than the cell; the message gives the object and both values
//! Source   CiA 402-2

use crate::config::{DriveConfig, Write, interpolation_period};
use crate::object::Object;
use crate::sdo::{Abort, SdoError};
use crate::{objects, probe, texts};
use lineshaft_core::drive::{DriveState, Terminal, control};
use std::time::{Duration, Instant};

/// Time for a drive to stop.
const STOP_TIMEOUT: Duration = Duration::from_secs(5);

/// SDO access to a drive. The calls return after the answer.
pub trait ObjectAccess {
    /// Reads an object.
    ///
    /// # Errors
    /// The drive refuses or does not answer.
    fn read(&mut self, object: Object) -> Result<Vec<u8>, SdoError>;

    /// Writes an object.
    ///
    /// # Errors
    /// The drive refuses or does not answer.
    fn write(&mut self, object: Object, data: &[u8]) -> Result<(), SdoError>;

    /// Lets the bus run for the given time.
    fn wait(&mut self, time: Duration);
}

/// Reason why a drive is not started.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StartError {
    /// The drive refuses or does not answer.
    #[error(transparent)]
    Sdo(#[from] SdoError),
    /// The drive differs from the cell.
    #[error("{0}")]
    Wrong(String),
}

/// Returns a number of up to 4 bytes.
pub fn number_of(bytes: &[u8]) -> u32 {
    bytes.iter().take(4).rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

/// Returns true if the error means that the device lacks the object.
pub fn is_absent(error: &SdoError) -> bool {
    matches!(error, SdoError::Refused(_, Abort(0x0602_0000 | 0x0609_0011)))
}

/// Returns a number; `None` if the drive lacks the object.
///
/// # Errors
/// The drive refuses for another reason, or does not answer.
pub fn number(drive: &mut impl ObjectAccess, object: Object) -> Result<Option<u32>, SdoError> {
    match drive.read(object) {
        Ok(bytes) => Ok(Some(number_of(&bytes))),
        Err(error) if is_absent(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Stops an enabled drive on its quick stop ramp, and disables its voltage.
///
/// # Errors
/// The drive refuses or does not answer.
pub fn stop_and_disable<A: ObjectAccess>(drive: &mut A) -> Result<(), SdoError> {
    let state = |drive: &mut A| -> Result<DriveState, SdoError> {
        let bytes = drive.read(objects::STATUS_WORD)?;
        Ok(DriveState::from_status(number_of(&bytes) as u16))
    };
    let runs = |state| matches!(state, DriveState::Enabled | DriveState::QuickStop | DriveState::FaultReaction);
    if state(drive)? == DriveState::Enabled {
        drive.write(objects::CONTROL_WORD, &control::QUICK_STOP.to_le_bytes())?;
    }
    let begin = Instant::now();
    while runs(state(drive)?) && begin.elapsed() < STOP_TIMEOUT {
        drive.wait(Duration::from_millis(5));
    }
    // Even if the drive has not stopped, as no other measure is left.
    drive.write(objects::CONTROL_WORD, &control::DISABLE_VOLTAGE.to_le_bytes())
}

/// Checks that the drive has the same counts per shaft revolution as the cell.
///
/// # Errors
/// The counts differ, or the drive has no object that gives them; an answer is missing.
pub fn check_factors(drive: &mut impl ObjectAccess, config: &DriveConfig) -> Result<(), StartError> {
    let Some((counts, turns)) = config.counts_per_shaft_revolution else { return Ok(()) };
    let (found, of) = match fraction(drive, objects::FEED_CONSTANT)? {
        Some(feed) => (feed, "6092h"),
        None => {
            let Some((increments, turns)) = fraction(drive, objects::ENCODER_RESOLUTION)? else {
                let why = "key feed is given, but the drive has neither 6092h nor 608Fh: it cannot be compared";
                return Err(StartError::Wrong(why.to_owned()));
            };
            let (motor, shaft) = fraction(drive, objects::GEAR_RATIO)?.unwrap_or((1, 1));
            ((increments * motor, turns * shaft), "608Fh, 6091h")
        }
    };
    let same = u128::from(found.0) * u128::from(turns) == u128::from(found.1) * u128::from(counts);
    if same && found.1 != 0 {
        return Ok(());
    }
    let shown = |(counts, turns): (u64, u64)| match counts.checked_rem(turns) {
        Some(0) => (counts / turns).to_string(),
        _ => format!("{counts}/{turns}"),
    };
    Err(StartError::Wrong(format!(
        "the drive counts {} inc per revolution of its shaft ({of}); by scale and feed of the cell it is {} inc",
        shown(found),
        shown((counts, turns))
    )))
}

/// Returns numerator and denominator of a factor, 32 bits each; `None` if the drive lacks it.
fn fraction(
    drive: &mut impl ObjectAccess,
    [numerator, denominator]: [Object; 2],
) -> Result<Option<(u64, u64)>, SdoError> {
    let Some(numerator) = number(drive, numerator)? else { return Ok(None) };
    let denominator = number(drive, denominator)?.unwrap_or(1);
    Ok(Some((numerator.into(), denominator.into())))
}

/// Checks that the drive supports its mode (6502h). A drive without that object is accepted.
///
/// # Errors
/// The drive lacks the mode; an answer is missing.
pub fn check_modes(drive: &mut impl ObjectAccess, config: &DriveConfig) -> Result<(), StartError> {
    let Some(offered) = number(drive, objects::SUPPORTED_MODES)? else { return Ok(()) };
    let (mode, name) = (config.mode.number(), config.mode.name());
    if offered >> (mode - 1) & 1 == 1 {
        return Ok(());
    }
    let modes = texts::modes(offered);
    Err(StartError::Wrong(format!(
        "it does not offer mode {mode} ({name}; 6502h is {offered:08X}h: {modes}); key mode chooses another"
    )))
}

/// Returns the values of the profile that are written before the start. The flag marks objects that a drive may lack. `has_mode`: the mode
/// is reported in the cycles, as process data or by SDO; otherwise it is written once. `outputs` are the digital outputs of the machine at bits of 60FEh:01.
pub fn values(drive: &DriveConfig, cycle_ns: u64, has_mode: bool, outputs: &[Terminal]) -> Vec<(Write, bool)> {
    let mut writes = Vec::new();
    let mut add = |object: Object, data: &[u8], is_optional| {
        writes.push((Write { object, data: data.to_vec() }, is_optional));
    };
    // Without probes the object is not written.
    if drive.probes.iter().any(Option::is_some) {
        add(objects::TOUCH_PROBE_FUNCTION, &probe::function(drive.probes).to_le_bytes(), false);
    }
    if let Some((value, index)) = interpolation_period(cycle_ns) {
        add(objects::INTERPOLATION_VALUE, &[value], true);
        add(objects::INTERPOLATION_INDEX, &[index.cast_unsigned()], true);
    }
    if !has_mode {
        add(objects::MODE, &drive.mode.number().to_le_bytes(), false);
    }
    if !outputs.is_empty() {
        let mask = outputs.iter().fold(0, |mask, terminal| mask | 1_u32.unbounded_shl(terminal.address.into()));
        add(objects::DIGITAL_OUTPUT_MASK, &mask.to_le_bytes(), true);
    }
    writes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::DriveMode;
    use std::collections::{BTreeMap, VecDeque};

    /// A drive that reports these status words one after another, and lacks all other objects except `numbers`.
    #[derive(Default)]
    struct Rig {
        states: VecDeque<u16>,
        numbers: BTreeMap<Object, u32>,
        written: Vec<(Object, Vec<u8>)>,
    }

    impl ObjectAccess for Rig {
        fn read(&mut self, object: Object) -> Result<Vec<u8>, SdoError> {
            let missing = SdoError::Refused(object, Abort(0x0602_0000));
            if object == objects::STATUS_WORD {
                return self.states.pop_front().map(|word| word.to_le_bytes().to_vec()).ok_or(missing);
            }
            self.numbers.get(&object).map(|number| number.to_le_bytes().to_vec()).ok_or(missing)
        }

        fn write(&mut self, object: Object, data: &[u8]) -> Result<(), SdoError> {
            self.written.push((object, data.to_vec()));
            Ok(())
        }

        fn wait(&mut self, _: Duration) {}
    }

    /// Operation enabled, quick stop active, switch on disabled.
    #[test]
    fn enabled_drive_is_stopped_before_its_voltage_is_disabled() {
        let mut rig = Rig { states: [0x0637, 0x0617, 0x0617, 0x0640].into(), ..Rig::default() };
        assert_eq!(stop_and_disable(&mut rig), Ok(()));
        let words = [control::QUICK_STOP, control::DISABLE_VOLTAGE];
        assert_eq!(rig.written, words.map(|word| (objects::CONTROL_WORD, word.to_le_bytes().to_vec())));
        assert!(rig.states.is_empty(), "it is waited for");
    }

    /// 6502h: bit 7 is csp, bit 8 is csv.
    #[test]
    fn drive_without_its_mode_is_refused() {
        let mut drive = DriveConfig::plain(0);
        let mut rig = Rig::default();
        assert_eq!(check_modes(&mut rig, &drive), Ok(()), "the drive does not say");
        rig.numbers.insert(objects::SUPPORTED_MODES, 1 << 7);
        assert_eq!(check_modes(&mut rig, &drive), Ok(()));
        drive.mode = DriveMode::Csv;
        let message = check_modes(&mut rig, &drive).unwrap_err().to_string();
        assert!(message.starts_with("it does not offer mode 9 (csv; 6502h is 00000080h: csp)"), "{message}");
    }

    /// 1 ms is 1 times 10^-3 s. Bit 16 of 60FEh is used.
    #[test]
    fn values_depend_on_cell() {
        let mut drive = DriveConfig::plain(0);
        let written = |drive: &DriveConfig, has_mode, outputs: &[Terminal]| {
            let values = values(drive, 1_000_000, has_mode, outputs);
            values.into_iter().map(|(write, _)| (write.object, write.data)).collect::<Vec<_>>()
        };
        let period = [(objects::INTERPOLATION_VALUE, vec![1]), (objects::INTERPOLATION_INDEX, vec![0xFD])];
        assert_eq!(written(&drive, true, &[]), period);
        drive.probes = [Some(probe::Probe::Rising), None];
        let outputs = [Terminal { place: 0, address: 16 }];
        let all = [
            vec![(objects::TOUCH_PROBE_FUNCTION, vec![0x13, 0])],
            period.to_vec(),
            vec![(objects::MODE, vec![8]), (objects::DIGITAL_OUTPUT_MASK, vec![0, 0, 1, 0])],
        ];
        assert_eq!(written(&drive, false, &outputs), all.concat());
    }
}
