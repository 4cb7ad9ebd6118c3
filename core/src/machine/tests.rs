mod rig;

mod activity;
mod amc;
mod anything;
mod buffer;
mod changes;
mod direction;
mod edges;
mod layers;

mod limits;
mod loops;
mod moments;
mod moves;
mod open_loop;
mod parameters;
mod probe;
mod state;
mod stops;
mod stream;
mod superimposed;
mod synchronize;
mod together;
mod trajectory;
