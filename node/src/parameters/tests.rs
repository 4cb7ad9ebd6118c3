//! Every row at every door, files that are imported, and the catalogue as it is shown.

mod doors;
mod import;
mod page;
mod rig;
