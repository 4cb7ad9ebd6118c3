//! Couplings of an axis to a leader: gears, cams, registration marks.

pub(super) mod cam;
mod cam_marks;
mod conditioning;
mod engage;
mod gear_in;
mod leave;
mod marker;
pub(super) mod master;
mod phase;
pub(super) mod smooth;
mod synchronize;
