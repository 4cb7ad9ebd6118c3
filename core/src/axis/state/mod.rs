//! The parts of which the state of an axis consists: what a cycle changes.
//!
//! Law      the fields of the parts in `axis.rs` that a cycle changes are private; smaller structs inside them may have
//!          fields that all behaviour reads and writes. Methods need nothing but their arguments. One part alone writes
//!          the state, the source of the command, the command and the generator
//! Reads    nothing; the behaviour in the other folders of this room reads and changes the parts
//! Refuses  what `source.rs`, `waiting.rs` and `buffer.rs` say
//! Source   docs/ARCHITECTURE.md

pub(in crate::axis) mod active_motion;
pub(in crate::axis) mod alarm;
pub(in crate::axis) mod alarm_state;
pub(in crate::axis) mod at_limits;
pub(in crate::axis) mod axis;
pub(in crate::axis) mod brake_state;
pub(in crate::axis) mod buffer;
pub(in crate::axis) mod cam_marks;
pub(in crate::axis) mod command_state;
pub(in crate::axis) mod conditioning;
pub(in crate::axis) mod context;
pub(in crate::axis) mod coupling_state;
pub(in crate::axis) mod current_stage;
pub(in crate::axis) mod cycle_state;
pub(in crate::axis) mod drive_data;
pub(in crate::axis) mod drive_shown;
pub(in crate::axis) mod effort_loops;
pub(in crate::axis) mod engagement;
pub(in crate::axis) mod failure;
pub(in crate::axis) mod generator;
pub(in crate::axis) mod goal;
pub(in crate::axis) mod homing;
pub(in crate::axis) mod in_force;
pub(in crate::axis) mod leaving;
pub(in crate::axis) mod loops;
pub(in crate::axis) mod mark_path;
pub(in crate::axis) mod master_view;
pub(in crate::axis) mod moved_by;
pub(in crate::axis) mod observed;
pub(in crate::axis) mod overlay;
pub(in crate::axis) mod pace;
pub(in crate::axis) mod pair;
pub(in crate::axis) mod pending;
pub(in crate::axis) mod phasing;
pub(in crate::axis) mod planned_motion;
pub(in crate::axis) mod position_feedback;
pub(in crate::axis) mod position_loop;
pub(in crate::axis) mod power;
pub(in crate::axis) mod probe_search;
pub(in crate::axis) mod recovery;
pub(in crate::axis) mod run;
pub(in crate::axis) mod safety;
pub(in crate::axis) mod seen_marks;
pub(in crate::axis) mod sensor;
pub(in crate::axis) mod setup;
pub(in crate::axis) mod smooth;
pub(in crate::axis) mod source;
pub(in crate::axis) mod sources;
pub(in crate::axis) mod spread;
pub(in crate::axis) mod status;
pub(in crate::axis) mod streamed;
pub(in crate::axis) mod supervision;
pub(in crate::axis) mod switches;
pub(in crate::axis) mod task;
pub(in crate::axis) mod touch_probes;
pub(in crate::axis) mod tracker;
pub(in crate::axis) mod travel;
pub(in crate::axis) mod velocity_feedback;
pub(in crate::axis) mod waiting;

pub(in crate::axis) use alarm::{ErrorSnapshot, Numbers};
pub(in crate::axis) use at_limits::{Beyond, Stopped};
pub(in crate::axis) use axis::Axis;
pub(in crate::axis) use brake_state::{BrakeConfig, Edges};
pub(in crate::axis) use buffer::Next;
pub(in crate::axis) use cam_marks::{CamPosition, CamSide};
pub(in crate::axis) use conditioning::Conditioning;
pub(in crate::axis) use context::Context;
pub(in crate::axis) use current_stage::CurrentStage;
pub(in crate::axis) use engagement::Engagement;
pub(in crate::axis) use failure::{Failure, Moment};
pub(in crate::axis) use generator::{Coupling, Generator};
pub(in crate::axis) use goal::Goal;
pub(in crate::axis) use homing::Stage;
pub(in crate::axis) use homing::in_drive::InDrive;
pub(in crate::axis) use homing::methods::{Leg, Switch};
pub(in crate::axis) use leaving::Leaving;
pub(in crate::axis) use mark_path::MarkPath;
pub(in crate::axis) use master_view::MasterView;
pub(in crate::axis) use moved_by::MovedBy;
pub(in crate::axis) use overlay::Overlay;
pub(in crate::axis) use pace::{CyclePace, Pace};
pub(in crate::axis) use pair::Started;
pub(in crate::axis) use phasing::Phasing;
pub(in crate::axis) use planned_motion::{Aim, PlannedMotion};
pub(in crate::axis) use position_loop::PositionLoop;
pub(in crate::axis) use power::Power;
pub(in crate::axis) use recovery::Recovery;
pub(in crate::axis) use run::Excess;
pub(in crate::axis) use seen_marks::Seen;
pub(in crate::axis) use sensor::{Claim, Found, Sensor};
pub(in crate::axis) use smooth::{Curve, Smooth};
pub(in crate::axis) use source::{Source, Wired};
pub(in crate::axis) use streamed::Streamed;
pub(in crate::axis) use switches::Switches;
pub(in crate::axis) use touch_probes::Armed;
pub(in crate::axis) use tracker::Tracker;
