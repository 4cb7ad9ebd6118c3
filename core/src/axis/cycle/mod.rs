//! The cycle of an axis: its steps, its pace, its signals, its parameters.

mod pace;
mod parameters;
mod publish;
mod reduced;
mod step;
