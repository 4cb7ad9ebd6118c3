mod rig;

mod anything;
mod edges;

mod limits;
mod moves;
mod parameters;
mod state;
mod stops;
mod synchronize;
