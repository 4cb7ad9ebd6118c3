//! CiA 402 drives for Lineshaft, independent of the bus: CANopen and EtherCAT (CoE) share this profile and its object dictionary.
//!
//! Law      a drive is a list of mapped objects with their values ([`mapping`], [`image`]), and requests for single objects ([`sdo`]). The
//!          crate of a bus packs the list into its process data and runs the requests; [`adapter`] translates between the values and the
//!          inputs and outputs of a machine cycle. This crate knows no frame, no identifier and no node number
//! Source   CiA 402-2, CiA 301, ETG.1000.6
#![forbid(unsafe_code)]

pub mod adapter;
pub mod config;
pub mod counter;
pub mod dictionary;
pub mod drive_type;
pub mod homing;
pub mod homing_end;
pub mod image;
pub mod mapping;
pub mod mode;
pub mod mode_exchange;
pub mod object;
pub mod objects;
pub mod probe;
pub mod sdo;
pub mod simulate;
pub mod startup;
pub mod terminals;
pub mod texts;
