//! Tables as people write them: CSV files, descriptions of motions by laws, what they ask of an axis, figures.
//!
//! No machine and no cell: `csv` is what cells read, the rest is for `lineshaft table`.

pub(crate) mod csv;
pub(crate) mod description;
pub(crate) mod figure;
pub(crate) mod form;
pub(crate) mod limits;
pub(crate) mod motion;
