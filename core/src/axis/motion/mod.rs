//! The motion of an axis in a cycle: planned, superimposed, in open loop, within its limits.

mod advance;
mod limit_switch;
mod limits;
mod open_loop;
mod out_an;
mod overlay;
mod planning;
mod reversing;
