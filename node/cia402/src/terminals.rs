//! Inputs, outputs and encoders of the machine at a device.
//!
//! Law      an input keeps its last value for as many cycles as an axis tolerates missing data of a drive. After that, and while its device
//!          takes no part, it is invalid: digital 0, analog 0 V, encoder invalid. Outputs are sent in each cycle
//! Reads    values of PDOs, the outputs of a cycle
//! Writes   the inputs of a cycle, values of PDOs
//! Source   CiA 401-1 (6000h, 6200h, 6401h, 6411h), CiA 402-2 (60FDh, 60FEh), CiA 406 (6004h); contract section 8

use crate::adapter::DriveAdapter;
use crate::config;
use crate::mapping::{CommandedValue, ReportedValue};
use lineshaft_core::axis::MISSED_CYCLES;
use lineshaft_core::drive::{EncoderInput, Inputs, Outputs, bit};

/// Value of an analog channel at full scale.
const FULL_SCALE: f64 = 0x7FFF as f64;

/// State of the terminals of a device.
#[derive(Clone, Debug)]
pub struct TerminalAdapter {
    config: config::Terminals,
    /// Bits of all digital inputs.
    digital: u64,
    /// Words of the analog inputs, by channel, up to the last one that is used.
    analog: Vec<i16>,
    /// Position word of an encoder, and the epoch of its coordinate system.
    encoder: (u32, u32),
    /// Cycles since each PDO was received; `None` if it was not received since the start of the device.
    ages: Vec<Option<u32>>,
}

impl TerminalAdapter {
    /// Creates the state for a device that sends `pdos` PDOs.
    pub fn new(config: &config::Terminals, pdos: usize) -> Self {
        let channels = config.analog_inputs.iter().map(|analog| usize::from(analog.terminal.address) + 1).max();
        let channels = channels.unwrap_or_default();
        Self { config: config.clone(), digital: 0, analog: vec![0; channels], encoder: (0, 0), ages: vec![None; pdos] }
    }

    /// Starts reception before the device is started; `counts_on`: the device was only offline.
    pub fn listen(&mut self, counts_on: bool) {
        if !counts_on {
            // An epoch that wraps still differs from the previous one, which is all that matters.
            self.encoder.1 = self.encoder.1.wrapping_add(1);
        }
        self.ages.fill(None);
        self.digital = 0;
        self.analog.fill(0);
    }

    /// Handles the values of the PDO at a place.
    pub fn take(&mut self, place: usize, words: impl Iterator<Item = (ReportedValue, i64)>) {
        for (word, value) in words {
            match word {
                ReportedValue::Inputs => self.digital = u64::from(value as u32),
                ReportedValue::Digital(group) => {
                    let at = u32::from(group.min(7)) * 8;
                    self.digital = self.digital & !(0xFF << at) | u64::from(value as u8) << at;
                }
                ReportedValue::Analog(channel) => {
                    if let Some(word) = self.analog.get_mut(usize::from(channel)) {
                        *word = value as i16;
                    }
                }
                ReportedValue::Encoder => self.encoder.0 = value as u32,
                _ => {}
            }
        }
        if let Some(age) = self.ages.get_mut(place) {
            *age = Some(0);
        }
    }

    /// Writes the inputs of this cycle; `drive`: state of the drive, if the device is one.
    pub fn read(&mut self, inputs: &mut Inputs, is_there: bool, drive: Option<&DriveAdapter>) {
        // All PDOs of a module or encoder are sent in each cycle.
        let is_late = |age: &Option<u32>| age.is_none_or(|age| age > MISSED_CYCLES);
        let is_heard = drive.map_or_else(|| !self.ages.iter().any(is_late), DriveAdapter::is_heard);
        for age in self.ages.iter_mut().flatten() {
            *age = age.saturating_add(1);
        }
        if !(is_there && is_heard) {
            return;
        }
        for terminal in &self.config.digital_inputs {
            let on = 1_u64.checked_shl(terminal.address.into()).is_some_and(|mask| self.digital & mask != 0);
            inputs.set_digital(terminal.place, on);
        }
        for config::AnalogTerminal { terminal, volts_at_full_scale: full_scale } in &self.config.analog_inputs {
            let word = self.analog.get(usize::from(terminal.address)).copied().unwrap_or_default();
            if let Some(volts) = inputs.analog.get_mut(terminal.place) {
                *volts = f64::from(word) / FULL_SCALE * full_scale;
            }
        }
        for encoder in &self.config.encoders {
            let (count, epoch) = match drive {
                Some(drive) => drive.counts(),
                None if encoder.is_absolute => (self.encoder.0.into(), 0),
                // An incremental position counts in both directions from 0.
                None => (self.encoder.0.cast_signed().into(), self.encoder.1),
            };
            if let Some(input) = inputs.encoder.get_mut(encoder.place) {
                *input = EncoderInput { count, epoch, valid: true, index: None };
            }
        }
    }

    /// Returns the value of a commanded field.
    pub fn value(&self, word: CommandedValue, outputs: &Outputs) -> i64 {
        let digital = |first: u16, bits: u16| {
            let ours = self.config.digital_outputs.iter().filter(|terminal| bit(&outputs.digital, terminal.place));
            let bits = ours.filter_map(|terminal| terminal.address.checked_sub(first).filter(|at| *at < bits));
            bits.fold(0, |word, at| word | 1_i64 << at)
        };
        match word {
            CommandedValue::Outputs => digital(0, 32),
            CommandedValue::Digital(group) => digital(u16::from(group) * 8, 8),
            CommandedValue::Analog(channel) => {
                let is_it = |analog: &&config::AnalogTerminal| analog.terminal.address == u16::from(channel);
                let ours = self.config.analog_outputs.iter().find(is_it);
                let Some(config::AnalogTerminal { terminal, volts_at_full_scale: full_scale }) = ours else { return 0 };
                let volts = outputs.analog.get(terminal.place).copied().unwrap_or_default();
                // NaN becomes 0 V; other values saturate.
                (volts / full_scale * FULL_SCALE).round().clamp(-FULL_SCALE, FULL_SCALE) as i64
            }
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::drive::Terminal;

    fn terminal(place: usize, address: u16) -> Terminal {
        Terminal { place, address }
    }

    fn analog(place: usize, address: u16, full_scale: f64) -> config::AnalogTerminal {
        config::AnalogTerminal { terminal: terminal(place, address), volts_at_full_scale: full_scale }
    }

    fn inputs() -> Inputs {
        Inputs {
            digital: vec![0; 2],
            analog: vec![0.0; 3],
            encoder: vec![EncoderInput::default(); 2],
            ..Inputs::default()
        }
    }

    /// One PDO with two groups of digital inputs, and one with an analog input.
    fn module() -> TerminalAdapter {
        let config = config::Terminals {
            digital_inputs: vec![terminal(70, 9), terminal(1, 0)],
            digital_outputs: vec![terminal(65, 0), terminal(2, 9), terminal(0, 31)],
            analog_inputs: vec![analog(2, 1, 10.0)],
            analog_outputs: vec![analog(1, 1, 5.0)],
            encoders: Vec::new(),
        };
        TerminalAdapter::new(&config, 2)
    }

    #[test]
    fn inputs_are_at_their_places() {
        let mut module = module();
        module.listen(false);
        module.take(0, [(ReportedValue::Digital(0), 0x01), (ReportedValue::Digital(1), -1)].into_iter());
        let mut seen = inputs();
        module.read(&mut seen, true, None);
        assert_eq!(seen, inputs(), "the analog PDO has not come");
        module.take(1, [(ReportedValue::Analog(0), 77), (ReportedValue::Analog(1), -0x7FFF)].into_iter());
        module.read(&mut seen, true, None);
        assert_eq!(
            (seen.digital.as_slice(), seen.analog.as_slice()),
            ([1 << 1, 1 << 6].as_slice(), [0.0, 0.0, -10.0].as_slice())
        );
        module.take(0, [(ReportedValue::Digital(0), 0xFE), (ReportedValue::Digital(1), 0xFD_u8.into())].into_iter());
        let mut seen = inputs();
        module.read(&mut seen, true, None);
        assert_eq!(seen.digital, [0; 2]);
    }

    /// More than 10 cycles without a PDO, and a device that takes no part.
    #[test]
    fn inputs_of_silent_module_are_invalid() {
        let mut module = module();
        module.listen(false);
        module.take(0, [(ReportedValue::Digital(0), 1)].into_iter());
        module.take(1, [(ReportedValue::Analog(1), 0x7FFF)].into_iter());
        let mut shown = |is_there| {
            let mut seen = inputs();
            module.read(&mut seen, is_there, None);
            (seen.digital(1), seen.analog[2])
        };
        assert_eq!(shown(false), (false, 0.0));
        for cycle in 1..=10 {
            assert_eq!(shown(true), (true, 10.0), "{cycle}");
        }
        assert_eq!(shown(true), (false, 0.0));
    }

    #[test]
    fn outputs_are_packed() {
        let module = module();
        let mut outputs = Outputs { digital: vec![0; 2], analog: vec![9.0, -2.5], ..Outputs::default() };
        let words = |outputs: &Outputs| {
            [
                CommandedValue::Digital(0),
                CommandedValue::Digital(1),
                CommandedValue::Outputs,
                CommandedValue::Analog(0),
                CommandedValue::Analog(1),
            ]
            .map(|word| module.value(word, outputs))
        };
        assert_eq!(words(&outputs), [0, 0, 0, 0, -16_384]);
        outputs.digital = vec![0b101, 0b10];
        outputs.analog[1] = f64::INFINITY;
        assert_eq!(words(&outputs), [1, 2, 1 << 31 | 1 << 9 | 1, 0, 32_767]);
        outputs.analog[1] = f64::NAN;
        assert_eq!(words(&outputs)[4], 0);
    }

    /// The coordinate system of a device that was offline may be a new one, unless its position is absolute.
    #[test]
    fn booted_encoder_counts_from_new_epoch() {
        for (is_absolute, count, epochs) in [(false, -2, [1, 1, 2]), (true, 0xFFFF_FFFE, [0, 0, 0])] {
            let encoders = vec![config::Encoder { place: 1, is_absolute }];
            let mut encoder = TerminalAdapter::new(&config::Terminals { encoders, ..config::Terminals::default() }, 1);
            let mut shown = |boots: bool| {
                encoder.listen(!boots);
                encoder.take(0, [(ReportedValue::Encoder, -2)].into_iter());
                let mut seen = inputs();
                encoder.read(&mut seen, true, None);
                assert_eq!(seen.encoder[0], EncoderInput::default());
                seen.encoder[1]
            };
            let expected = epochs.map(|epoch| EncoderInput { count, epoch, valid: true, index: None });
            assert_eq!([shown(true), shown(false), shown(true)], expected);
        }
    }
}
