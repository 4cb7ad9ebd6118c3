mod rig;

mod amc;
mod anything;
mod buffer;
mod changes;
mod edges;

mod limits;
mod loops;
mod moves;
mod open_loop;
mod parameters;
mod probe;
mod state;
mod stops;
mod superimposed;
mod synchronize;
mod together;
