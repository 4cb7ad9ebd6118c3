//! Inputs, outputs and encoders of the machine at the terminals of a device.
//!
//! Law      an input has the value of its last word, for as many cycles as the axes believe a drive that is silent; then, and while its
//!          device takes no part, it is not there: digital 0, analog 0 V, an encoder invalid. An output has its value in each cycle
//! Reads    words of PDOs, the outputs of a cycle
//! Writes   the inputs of a cycle, words of PDOs
//! Source   CiA 401-1 (6000h, 6200h, 6401h, 6411h), CiA 402-2 (60FDh, 60FEh), CiA 406 (6004h); contract section 8

use super::drive::Drive;
use crate::config;
use crate::drive::layout::{Asked, Told};
use lineshaft_core::axis::MISSED_CYCLES;
use lineshaft_core::drive::{EncoderInput, Inputs, Outputs, bit};

/// What full scale is in words.
const FULL_SCALE: f64 = 0x7FFF as f64;
/// Analog channels of a module that PDOs have room for.
pub const ANALOG_CHANNELS: usize = 12;

/// The terminals.
#[derive(Clone, Debug)]
pub(crate) struct Terminals {
    config: config::Terminals,
    /// Bits of all digital inputs.
    digital: u64,
    analog: [i16; ANALOG_CHANNELS],
    /// Word of an encoder, and how often its coordinate was set anew.
    encoder: (u32, u32),
    /// Cycles since each PDO came; none of one that has not come since the device was started.
    ages: Vec<Option<u32>>,
}

impl Terminals {
    /// Those of a device that sends so many PDOs.
    pub(super) fn new(config: &config::Terminals, pdos: usize) -> Self {
        Self {
            config: config.clone(),
            digital: 0,
            analog: [0; ANALOG_CHANNELS],
            encoder: (0, 0),
            ages: vec![None; pdos],
        }
    }

    /// The device is about to be started; `counts_on`: it was only away.
    pub(super) fn listen(&mut self, counts_on: bool) {
        if !counts_on {
            // An epoch that comes around differs from the one before, which is all that counts.
            self.encoder.1 = self.encoder.1.wrapping_add(1);
        }
        self.ages.fill(None);
        (self.digital, self.analog) = (0, [0; ANALOG_CHANNELS]);
    }

    /// Takes the words of the PDO at a place.
    pub(super) fn take(&mut self, place: usize, words: impl Iterator<Item = (Told, i64)>) {
        for (word, value) in words {
            match word {
                Told::Inputs => self.digital = u64::from(value as u32),
                Told::Digital(group) => {
                    let at = u32::from(group.min(7)) * 8;
                    self.digital = self.digital & !(0xFF << at) | u64::from(value as u8) << at;
                }
                Told::Analog(channel) => {
                    if let Some(word) = self.analog.get_mut(usize::from(channel)) {
                        *word = value as i16;
                    }
                }
                Told::Encoder => self.encoder.0 = value as u32,
                _ => {}
            }
        }
        if let Some(age) = self.ages.get_mut(place) {
            *age = Some(0);
        }
    }

    /// What they show in this cycle; `drive`: what the device is as one.
    pub(super) fn read(&mut self, inputs: &mut Inputs, is_there: bool, drive: Option<&Drive>) {
        // All PDOs of a module or encoder go with each SYNC.
        let is_late = |age: &Option<u32>| age.is_none_or(|age| age > MISSED_CYCLES);
        let is_heard = drive.map_or_else(|| !self.ages.iter().any(is_late), Drive::is_heard);
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
        for config::Analog { terminal, full_scale } in &self.config.analog_inputs {
            let word = self.analog.get(usize::from(terminal.address)).copied().unwrap_or_default();
            if let Some(volts) = inputs.analog.get_mut(terminal.place) {
                *volts = f64::from(word) / FULL_SCALE * full_scale;
            }
        }
        for encoder in &self.config.encoders {
            let (count, epoch) = match drive {
                Some(drive) => drive.counts(),
                None if encoder.is_absolute => (self.encoder.0.into(), 0),
                // What is counted goes both ways from 0.
                None => (self.encoder.0.cast_signed().into(), self.encoder.1),
            };
            if let Some(input) = inputs.encoder.get_mut(encoder.place) {
                *input = EncoderInput { count, epoch, valid: true, index: None };
            }
        }
    }

    /// A word of the outputs.
    pub(super) fn value(&self, word: Asked, outputs: &Outputs) -> i64 {
        let digital = |first: u16, bits: u16| {
            let ours = self.config.digital_outputs.iter().filter(|terminal| bit(&outputs.digital, terminal.place));
            let bits = ours.filter_map(|terminal| terminal.address.checked_sub(first).filter(|at| *at < bits));
            bits.fold(0, |word, at| word | 1_i64 << at)
        };
        match word {
            Asked::Outputs => digital(0, 32),
            Asked::Digital(group) => digital(u16::from(group) * 8, 8),
            Asked::Analog(channel) => {
                let is_it = |analog: &&config::Analog| analog.terminal.address == u16::from(channel);
                let ours = self.config.analog_outputs.iter().find(is_it);
                let Some(config::Analog { terminal, full_scale }) = ours else { return 0 };
                let volts = outputs.analog.get(terminal.place).copied().unwrap_or_default();
                // A value that is no number is 0 V; others saturate.
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

    fn analog(place: usize, address: u16, full_scale: f64) -> config::Analog {
        config::Analog { terminal: terminal(place, address), full_scale }
    }

    fn inputs() -> Inputs {
        Inputs {
            digital: vec![0; 2],
            analog: vec![0.0; 3],
            encoder: vec![EncoderInput::default(); 2],
            ..Inputs::default()
        }
    }

    /// One PDO of two groups, one of an analog channel.
    fn module() -> Terminals {
        let config = config::Terminals {
            digital_inputs: vec![terminal(70, 9), terminal(1, 0)],
            digital_outputs: vec![terminal(65, 0), terminal(2, 9), terminal(0, 31)],
            analog_inputs: vec![analog(2, 1, 10.0)],
            analog_outputs: vec![analog(1, 1, 5.0)],
            encoders: Vec::new(),
        };
        Terminals::new(&config, 2)
    }

    #[test]
    fn inputs_stand_at_their_places() {
        let mut module = module();
        module.listen(false);
        module.take(0, [(Told::Digital(0), 0x01), (Told::Digital(1), -1)].into_iter());
        let mut seen = inputs();
        module.read(&mut seen, true, None);
        assert_eq!(seen, inputs(), "the analog PDO has not come");
        module.take(1, [(Told::Analog(0), 77), (Told::Analog(1), -0x7FFF)].into_iter());
        module.read(&mut seen, true, None);
        assert_eq!(
            (seen.digital.as_slice(), seen.analog.as_slice()),
            ([1 << 1, 1 << 6].as_slice(), [0.0, 0.0, -10.0].as_slice())
        );
        module.take(0, [(Told::Digital(0), 0xFE), (Told::Digital(1), 0xFD_u8.into())].into_iter());
        let mut seen = inputs();
        module.read(&mut seen, true, None);
        assert_eq!(seen.digital, [0; 2]);
    }

    /// More than 10 cycles without a word, and a device that takes no part.
    #[test]
    fn inputs_of_a_silent_module_are_not_there() {
        let mut module = module();
        module.listen(false);
        module.take(0, [(Told::Digital(0), 1)].into_iter());
        module.take(1, [(Told::Analog(1), 0x7FFF)].into_iter());
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
    fn outputs_are_gathered() {
        let module = module();
        let mut outputs = Outputs { digital: vec![0; 2], analog: vec![9.0, -2.5], ..Outputs::default() };
        let words = |outputs: &Outputs| {
            [Asked::Digital(0), Asked::Digital(1), Asked::Outputs, Asked::Analog(0), Asked::Analog(1)]
                .map(|word| module.value(word, outputs))
        };
        assert_eq!(words(&outputs), [0, 0, 0, 0, -16_384]);
        outputs.digital = vec![0b101, 0b10];
        outputs.analog[1] = f64::INFINITY;
        assert_eq!(words(&outputs), [1, 2, 1 << 31 | 1 << 9 | 1, 0, 32_767]);
        outputs.analog[1] = f64::NAN;
        assert_eq!(words(&outputs)[4], 0);
    }

    /// One that was away may count anew, unless its words are absolute.
    #[test]
    fn an_encoder_that_has_booted_counts_anew() {
        for (is_absolute, count, epochs) in [(false, -2, [1, 1, 2]), (true, 0xFFFF_FFFE, [0, 0, 0])] {
            let encoders = vec![config::Encoder { place: 1, is_absolute }];
            let mut encoder = Terminals::new(&config::Terminals { encoders, ..config::Terminals::default() }, 1);
            let mut shown = |boots: bool| {
                encoder.listen(!boots);
                encoder.take(0, [(Told::Encoder, -2)].into_iter());
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
