//! Events of slots.

use super::{Line, Order, Type, cell, order, slot};
use crate::event::Kind;
use crate::machine::tests::rig::Rig;
use crate::object::Object;

/// The state of a function is reported as an event: at its start, with each output, at its end. A bit that changes
/// continuously causes no flood.
#[test]
fn function_reports_start_outputs_and_end() {
    let line = |object, inverted| Some(Line { object, inverted });
    let mut watch = slot("f", 0, Type::Ecopy);
    watch.inputs[0] = line(Object::Io(0), false);
    watch.outputs[0] = line(Object::Io(1), true);
    let config = cell(vec![watch]);
    let mut rig = Rig::of(config.clone());
    let told = |rig: &mut Rig| {
        let events = std::mem::take(&mut rig.events);
        let states = events.into_iter().filter(|event| event.kind == Kind::State);
        states.map(|event| (event.cycle, crate::text::message(&event, &config))).collect::<Vec<_>>()
    };
    rig.run(3);
    rig.give(order(0, Order::Start));
    rig.run(3);
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(5);
    rig.give(order(0, Order::Reset));
    rig.run(3);
    let sentence = |text: &str| format!("f: {text}");
    assert_eq!(
        told(&mut rig),
        [
            (3, sentence("active, no output set")),
            (7, sentence("active, set: A1 (not lamp)")),
            (12, sentence("at rest, no output set")),
        ]
    );
    rig.give(order(0, Order::Start));
    for cycle in 0..3000 {
        rig.modify_inputs = if cycle % 2 == 0 { |_| {} } else { |inputs| inputs.digital[0] = 1 };
        rig.run(1);
    }
    rig.modify_inputs = |_| {};
    rig.run(8000);
    let flickers = told(&mut rig);
    assert!((8..=12).contains(&flickers.len()), "{flickers:?}");
    let last = &flickers.last().expect("some").1;
    assert!(last.starts_with("f: active, no output set; changes before that were not told: "), "{last}");
}
