//! Blocks of signals per axis: a macro that generates the enum and its table from one list.

/// Generates an enum of signals and its table: `Name "text" type, measure[, drivable]; "help"`.
macro_rules! signal_block {
    ($(#[doc = $doc:literal])+ $block:ident; $($name:ident $text:literal $kind:expr, $measure:ident $(, $drivable:ident)?; $help:literal)*) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum $block {
            $(#[doc = $help] $name,)*
        }

        impl $block {
            /// Number of signals in the block.
            pub const COUNT: usize = [$($text),*].len();

            /// Returns the signal on the board, given the first signal of the block.
            pub fn of(self, first: crate::signal::Signal) -> crate::signal::Signal {
                first.plus(self as usize)
            }

            /// Adds the block of axis `name` and returns its first signal.
            pub(crate) fn add_all(directory: &mut crate::signal::Directory, name: &str) -> crate::signal::Signal {
                let first = directory.next();
                $(directory.add(crate::signal::Entry {
                    name: format!("{name}.{}", $text),
                    kind: $kind,
                    measure: crate::signal::Measure::$measure,
                    drivable: signal_block!(@ $($drivable)?),
                    help: $help,
                });)*
                first
            }
        }
    };
    (@ drivable) => { true };
    (@) => { false };
}

pub(crate) use signal_block;
