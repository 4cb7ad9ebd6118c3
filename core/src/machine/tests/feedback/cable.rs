//! Encoder cable that stays cut.

use super::super::rig::{Rig, X};
use super::{error, shared_config};
use crate::code::Code;
use crate::command::Action;
use crate::vocabulary::wf::Request;

/// Alarm 7 remains as long as its cause.
///
/// Proves: WF-MON-06
#[test]
fn alarm_7_can_be_acknowledged_after_cable_is_repaired() {
    let mut config = shared_config();
    config.axes[1].parameters.encoder.monitored = 1;
    let mut rig = Rig::of(config);
    rig.enable();
    rig.run(100);
    rig.modify_inputs = |inputs| inputs.encoder[0].valid = false;
    rig.run(1);
    assert_eq!((error(&rig), rig.int("x.wf.alarm")), (i64::from(Code::WF_ENCODER_CABLE.0), 7));
    let reset = Request { axis: X, reset: true, ..Request::default() };
    let refused = rig.give(Action::vocabulary(reset.clone()));
    assert_eq!(rig.refusal(refused), "x: alarm 7: the encoder gives no value; its cable may be broken");
    rig.run(10);
    assert_eq!((rig.int("x.wf.alarm"), rig.state("x"), rig.int("x.wf.enable")), (7, "ERROR_STOP", 0));
    rig.modify_inputs = |_| ();
    rig.run(2);
    let sequence = rig.give(Action::vocabulary(reset));
    assert!(rig.was_accepted(sequence));
    assert_eq!((rig.int("x.wf.alarm"), error(&rig), rig.state("x")), (0, 0, "DISABLED"));
}
