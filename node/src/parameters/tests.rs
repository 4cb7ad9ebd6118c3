//! Tests every row with every interface, imported files, and the description of the catalogue.

mod doors;
mod import;
mod page;
mod rig;
