//! Tables in files: CSV, descriptions of motions by laws, demands on an axis, figures.
//!
//! It uses no machine and no cell: cells read `csv`, the rest is for `lineshaft table`.

pub(crate) mod csv;
pub(crate) mod description;
pub(crate) mod figure;
pub(crate) mod form;
pub(crate) mod limits;
pub(crate) mod motion;
