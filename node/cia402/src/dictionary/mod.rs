//! Object dictionary of a device: data types, values as text and as bytes, mapping of PDOs. CANopen and EtherCAT (CoE) share it.
//!
//! Source   CiA 301; ETG.1000.6

mod data_type;
pub mod number;
mod pdo;
mod quote;
pub mod type_name;
mod value;

pub use data_type::DataType;
pub use pdo::{Direction, Mapped};
pub use quote::{MOST_QUOTED, quoted};
pub use value::{Value, ValueError};
