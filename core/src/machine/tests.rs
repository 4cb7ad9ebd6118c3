mod rig;

mod limits;
mod moves;
mod parameters;
mod stops;
mod synchronize;
