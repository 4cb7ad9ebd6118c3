//! The motion core of Lineshaft: one deterministic cycle of encoders, axes and signals.
//!
//! The core knows no ROS, no CAN, no file, no thread and no wall time: [`machine::Machine::cycle`] takes the inputs and commands of a
//! cycle and gives its outputs; nothing else changes it. Config, commands by cycle and inputs by cycle determine every
//! output bit. In the cycle nothing is allocated, locked or waited for, and integer arithmetic saturates, wraps or is
//! checked by intent.
#![forbid(unsafe_code)]

pub mod axis;
pub mod cam;
pub mod code;
pub mod command;
pub mod config;
pub mod drive;
pub mod encoder;
pub mod event;
pub mod function;
pub mod gantry;
pub mod law;
pub mod machine;
pub mod modulo;
pub mod object;
pub mod parameter;
pub mod position;
pub mod profile;
pub mod regulator;
pub mod request;
pub mod signal;
pub mod sim;
pub mod state;
pub mod sync;
pub mod table;
pub mod text;
pub mod trajectory;
pub mod unit;
pub mod vocabulary;
