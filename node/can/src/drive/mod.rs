//! CiA 402 drives: objects, PDOs, and their conversion to the signals of a machine cycle.

mod counter;
pub mod drive_type;
pub mod homing;
pub mod homing_end;
pub mod image;
pub mod layout;
pub mod mode;
pub mod mode_exchange;
pub mod objects;
pub mod probe;

pub use counter::PositionCounter;
pub use drive_type::DriveType;
pub use homing::HomingSetup;
pub use homing_end::HomingEnd;
pub use layout::{Layout, LayoutError};
pub use mode::{Commander, DriveMode};
pub use mode_exchange::{ModeExchange, ModeRequest};
