//! State and reference of an axis for each source of motion, as defined by docs/motion.md and the interface.

use super::functions::{geared, order, speeds};
use super::rig::{LINE, Rig, X, at, cam, config, couple, to};
use super::trajectory::track;
use crate::command::{Action, HomeAxis, HomingMethod, Move, MoveMode, Synchronize};
use crate::function::Order;
use crate::object::{AxisSet, Leader};
use crate::state::{AXIS_STATES, REFERENCES};
use crate::sync::CamStart;
use crate::table::{CamSetting, Form, Table};
use crate::trajectory::Trajectory;
use std::sync::Arc;

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))).expect("a file of the repository")
}

/// Returns three cells of each row: the source of motion, the state, the reference.
fn rows(page: &str) -> Vec<[String; 3]> {
    let lines = page.lines().skip_while(|line| !line.starts_with("| the axis is moved by |")).skip(2);
    let rows = lines.take_while(|line| line.starts_with('|')).map(|line| {
        let cells: Vec<_> = line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
        cells.try_into().expect("three cells")
    });
    rows.collect()
}

fn x_after(action: Action) -> (Rig, &'static str) {
    let mut config = config(0);
    let table = Table::new(Form::Xy, &[0, 8_000, 16_000], &[0, 8_000, 0]).expect("points");
    let table = Arc::new(table.with_cam(CamSetting::default()));
    config.tables = vec![crate::config::TableConfig { name: "knife".into(), table }];
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run(50);
    let sequence = rig.give(action);
    assert!(rig.was_accepted(sequence), "{:?}", rig.answer(sequence));
    rig.run(20);
    (rig, "x")
}

/// Returns a machine in which this source moves an axis, and the name of the axis.
fn moved_by(what: &str) -> (Rig, &'static str) {
    let gear = couple(X, Leader::AxisCommand(LINE), 1, 1);
    match what {
        "`~/move_axis`, ABSOLUTE" => x_after(Action::Move(to(X, 50_000))),
        "`~/move_axis`, RELATIVE or ADDITIVE" => {
            let (rig, _) = x_after(Action::Move(Move { mode: MoveMode::Additive, ..to(X, 50_000) }));
            assert_eq!(shown(&rig, "x"), ("DISCRETE_MOTION", "POSITION_RELATIVE"));
            x_after(Action::Move(Move { mode: MoveMode::Relative, ..to(X, 50_000) }))
        }
        "`~/move_axis`, VELOCITY" => x_after(Action::Move(at(X, 20_000.0))),
        "`~/follow_joint_trajectory`" => {
            let tracks = vec![track(X, &[(10_000, Some(0.0), None)])];
            let trajectory =
                Trajectory::new(0, Box::from([400_000_000_u64]), tracks.into(), None).expect("a sound one");
            x_after(Action::Trajectory(Arc::new(trajectory)))
        }
        "`~/jog` or `~/setpoints`" => {
            let mut rig = Rig::enabled();
            (0..20).for_each(|_| rig.stream(X, 20_000.0));
            (rig, "x")
        }
        "`~/synchronize`, a gear" => x_after(Action::Synchronize(gear)),
        "`~/synchronize`, a cam" => {
            x_after(Action::Synchronize(Synchronize { cam: Some(cam(0, CamStart::Relative)), ..gear }))
        }
        "a function slot with positions" => {
            let mut rig = geared();
            rig.give(order(0, Order::Start));
            rig.run(20);
            (rig, "x")
        }
        "a function slot with speeds" => {
            let mut rig = speeds::follows();
            rig.give(order(0, Order::Start));
            rig.give(Action::set_memory(2, 150_000.0));
            rig.run(20);
            (rig, "disc")
        }
        "`~/home_axis`" => x_after(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(34) })),
        "a halt" => {
            let (mut rig, axis) = x_after(Action::Move(at(X, 20_000.0)));
            rig.give(Action::Halt(AxisSet::one(X)));
            rig.run(5);
            (rig, axis)
        }
        other => panic!("the page names `{other}`, which no test moves"),
    }
}

fn shown(rig: &Rig, axis: &str) -> (&'static str, &'static str) {
    (rig.state(axis), REFERENCES[rig.int(&format!("{axis}.reference")) as usize])
}

#[test]
fn each_motion_shows_the_state_and_reference_of_the_table_in_motion_md() {
    let rows = rows(&read("docs/motion.md"));
    assert_eq!(rows.len(), 11, "rows of the table");
    for [what, state, reference] in &rows {
        let (rig, axis) = moved_by(what);
        assert_ne!(rig.real(&format!("{axis}.command.velocity")), 0.0, "{what}: it moves");
        assert_eq!(shown(&rig, axis), (state.as_str(), reference.as_str()), "{what}");
    }
}

/// The comment of a constant in the message names the sources of motion in that state; no other comment names them.
#[test]
fn the_message_names_each_motion_at_its_state() {
    let message = read("msg/msg/AxisState.msg");
    let lines: Vec<_> = message.lines().collect();
    let comment = |state: &str| {
        let place = lines.iter().position(|line| line.starts_with(&format!("uint8 {state}="))).expect("a constant");
        lines[place - 1]
    };
    for (word, state) in [
        ("trajectory", "DISCRETE_MOTION"),
        ("halt", "DISCRETE_MOTION"),
        ("jog", "CONTINUOUS_MOTION"),
        ("stream", "CONTINUOUS_MOTION"),
        ("slot with speeds", "CONTINUOUS_MOTION"),
        ("gear", "SYNCHRONIZED_MOTION"),
        ("cam", "SYNCHRONIZED_MOTION"),
        ("slot with positions", "SYNCHRONIZED_MOTION"),
    ] {
        let naming: Vec<_> = AXIS_STATES.iter().filter(|state| comment(state).contains(word)).collect();
        assert_eq!(naming, [&state], "{word}");
    }
}
