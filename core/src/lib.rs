//! The motion core of Lineshaft.
