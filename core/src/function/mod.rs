//! Function slots: small programs beside the axes, stepped in each cycle between encoders and axes, in ascending order.
#![allow(dead_code)]
mod field;
mod program;
mod sak;
mod window;
