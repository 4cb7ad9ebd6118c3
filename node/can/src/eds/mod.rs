//! Electronic data sheets and device configurations of CANopen devices (EDS and DCF files).

pub mod concise;
