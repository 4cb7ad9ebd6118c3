//! What this program and its slot tell each other. The slot fills it before each call and reads it behind.
//!
//! This file is the same for all programs: write yours in lib.rs.
#![allow(dead_code, unused_macros, unused_imports)]

/// `command` in the call of RESET: bring sink and outputs to rest.
pub const RESET: u8 = 0;
/// `command` in the first call, and behind an exchange that keeps no state.
pub const START: u8 = 1;
/// `command` in every other call.
pub const NONE: u8 = 255;

/// The image, 944 bytes and the program's own state.
#[repr(C, align(8))]
pub struct Image<State> {
    /// Bytes of the image; never write it.
    pub size: u32,
    /// `RESET`, `START` or `NONE`.
    pub command: u8,
    /// E1 in bit 0 to E8 in bit 7.
    pub inputs: u8,
    /// A1 in bit 0 to A8 in bit 7, as they are; what is left here they become.
    pub outputs: u8,
    reserved: u8,
    /// The source, as wide as the cell says, sign-extended.
    pub source: i64,
    /// The way of the source since START, which never wraps.
    pub travel: i64,
    /// The sink, as it is; what is left here it becomes.
    pub sink: i64,
    /// Time between two calls (ns).
    pub call_ns: i64,
    /// The signals of `reads` in the cell.
    pub reads: [Word; 16],
    /// The memory cells of `writes` in the cell, as they are; what is left here they become.
    pub writes: [Word; 16],
    /// `parameter` of the set, from START on.
    pub parameters: [i64; 16],
    /// Words of the table of the cell; 0 without one.
    pub db_words: u32,
    reserved_too: u32,
    /// Its words, from START on.
    pub db: [u16; 256],
    /// What the program keeps from call to call. An exchange with `state: keep` takes it over into a program whose state is as long.
    pub state: State,
}

/// A signal: a whole number or a bit as i64, a real as f64, as the signal is.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Word(u64);

impl Word {
    /// Of a signal that is a whole number or a bit.
    pub fn int(self) -> i64 {
        self.0 as i64
    }

    /// Of a signal that is real.
    pub fn real(self) -> f64 {
        f64::from_bits(self.0)
    }

    /// For a memory cell that is a whole number or a bit.
    pub fn of_int(value: i64) -> Self {
        Self(value as u64)
    }

    /// For a memory cell that is real.
    pub fn of_real(value: f64) -> Self {
        Self(value.to_bits())
    }
}

impl<State> Image<State> {
    /// An image as it begins.
    pub const fn new(state: State) -> Self {
        Self {
            size: core::mem::size_of::<Self>() as u32,
            command: NONE,
            inputs: 0,
            outputs: 0,
            reserved: 0,
            source: 0,
            travel: 0,
            sink: 0,
            call_ns: 0,
            reads: [Word(0); 16],
            writes: [Word(0); 16],
            parameters: [0; 16],
            db_words: 0,
            reserved_too: 0,
            db: [0; 256],
            state,
        }
    }

    /// An input, E1 by 1.
    pub fn input(&self, number: u8) -> bool {
        self.inputs >> (number - 1) & 1 == 1
    }

    /// Sets an output, A1 by 1.
    pub fn set_output(&mut self, number: u8, on: bool) {
        let bit = 1 << (number - 1);
        self.outputs = if on { self.outputs | bit } else { self.outputs & !bit };
    }
}

/// Exports a function of the image as the program, with the state that it begins with.
macro_rules! program {
    ($function:path, $state:ty, $begin:expr) => {
        #[cfg(target_arch = "wasm32")]
        mod exports {
            use super::*;

            #[export_name = "image"]
            pub static mut IMAGE: $crate::lineshaft::Image<$state> = $crate::lineshaft::Image::new($begin);

            #[export_name = "cycle"]
            pub extern "C" fn call() {
                // SAFETY: the slot makes one call at a time, and nobody else has the image.
                $function(unsafe { &mut *core::ptr::addr_of_mut!(IMAGE) });
            }

            #[panic_handler]
            fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
                core::arch::wasm32::unreachable()
            }
        }
    };
}
pub(crate) use program;
