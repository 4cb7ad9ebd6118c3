//! Tests verb `follow_joint_trajectory` with a plan in a file.

use super::*;

/// Output of `ros2 topic echo --once` of a trajectory of x and the turret, 4 mm and 0.01 rad in 400 ms.
const ECHO: &str = "\
header:
  stamp:
    sec: 1700000000
    nanosec: 250000000
  frame_id: world
joint_names:
- x
- turret
points:
- positions:
  - 0.0
  - -0.0
  velocities: []
  accelerations: []
  effort: []
  time_from_start:
    sec: 0
    nanosec: 0
- positions:
  - 0.004
  - 1.0e-02
  velocities:
  - 0.0
  - 0.0
  accelerations: []
  effort: []
  time_from_start:
    sec: 0
    nanosec: 400000000
---
";

/// The same trajectory in JSON, within a RobotTrajectory.
const JSON: &str = r#"{"joint_trajectory": {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
	"joint_names": ["x", "turret"],
	"points": [{"positions": [0.0, 0.0], "velocities": [], "accelerations": [], "effort": [], "time_from_start": {"sec": 0, "nanosec": 0}},
		{"positions": [4e-3, 1.0E-2], "velocities": [0, 0.0], "accelerations": [], "effort": [], "time_from_start": {"sec": 0, "nanosec": 400000000}}]},
 "multi_dof_joint_trajectory": {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "joint_names": [], "points": []}}"#;

/// The same points in the verb.
const INLINE: &str = "joints: [x, turret], points: [{time: 0, positions: [0, 0]}, {time: 0.4 s, positions: [4 mm, 0.01 rad], velocities: [0, 0]}]";

struct Bench(tempfile::TempDir);

impl Bench {
    /// Creates a folder with a plan.
    fn with(plan: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("plan.yaml"), plan).unwrap();
        Self(folder)
    }

    /// Reads a scenario in the folder with this verb in the step at line 4.
    fn read(&self, verb: &str, rest: &str) -> Result<Scenario, String> {
        let text = format!(
            "scenario: s\ncycles: 1000\nsteps:\n- {{at: 100, do: {{follow_joint_trajectory: {verb}}}{rest}}}\n- {{at: 0, do: {{enable: {{axes: [x, turret]}}}}}}\n"
        );
        let path = self.0.path().join("s.yaml");
        std::fs::write(&path, text).unwrap();
        let problems = Scenario::load(&path, &cell());
        problems.map_err(|problems| problems.to_string().replace(&format!("{}/", self.0.path().display()), ""))
    }

    /// Returns the problems of the plan.
    fn problems(&self) -> String {
        self.read("{file: plan.yaml}", "").unwrap_err()
    }
}

fn commands(scenario: &Scenario) -> String {
    format!("{:?}", scenario.0.acts.iter().map(|act| &act.deed).collect::<Vec<_>>())
}

#[test]
fn plan_in_any_of_its_forms_is_the_same_as_points_in_the_verb() {
    let tolerances = "path_tolerance: {x: 1 mm}, goal_tolerance: {turret: 1 deg}, goal_time: 1 s, start: 5 ms";
    let expected = Bench::with("").read(&format!("{{{INLINE}, {tolerances}}}"), "").unwrap();
    let indented = |text: &str| text.lines().map(|line| format!("  {line}\n")).collect::<String>();
    let robot = format!("joint_trajectory:\n{}", indented(ECHO.trim_end_matches("---\n")));
    let display = format!(
        "model_id: arm\ntrajectory:\n-{}trajectory_start: {{joint_state: {{}}}}\n---\n",
        &indented(&robot)[1..]
    );
    for plan in [ECHO, JSON, &robot, &display] {
        let bench = Bench::with(plan);
        let scenario = bench
            .read(&format!("{{file: plan.yaml, {tolerances}}}"), "")
            .unwrap_or_else(|problems| panic!("{problems}{plan}"));
        assert_eq!(commands(&scenario), commands(&expected), "{plan}");
    }
}

#[test]
fn plan_is_played_and_recorded_with_its_points() {
    let scenario = Bench::with(ECHO).read("{file: plan.yaml, id: a}", "").unwrap();
    let report = simulate(&cell(), &scenario, &Options::default()).unwrap();
    assert!(report.passed(), "{report}");
    assert!(recorded::plays_the_same_as_json(&cell(), &scenario) >= 2);
}

#[test]
fn errors_of_a_plan_are_reported_with_file_and_line() {
    let wrong = |from: &str, to: &str| Bench::with(&ECHO.replacen(from, to, 1)).problems();
    assert_eq!(wrong("- x\n", "- z\n"), "plan.yaml:7:3: joint_names has the joint `z`; there are x, turret\n");
    assert_eq!(wrong("- turret\n", "- x\n"), "plan.yaml:7:3: joint_names has the joint `x` twice; once is expected\n");
    assert_eq!(
        wrong("  - -0.0\n", ""),
        "plan.yaml:10:3: points[0].positions has 1 number; one for each joint (2) is expected\n"
    );
    assert_eq!(
        wrong("  - 0.004\n", "  - .nan\n"),
        "plan.yaml:20:5: points[1].positions[0] is `.nan`; a finite number is expected\n"
    );
    assert_eq!(
        wrong("  - 0.004\n", "  - 4 mm\n"),
        "plan.yaml:20:5: points[1].positions[0] is `4 mm`; a finite number is expected\n"
    );
    assert_eq!(
        wrong("nanosec: 400000000", "nanosec: 0"),
        "plan.yaml:19:3: points[1].time_from_start is 0 s; more than 0 s, the time of the point before it, is expected\n"
    );
    assert_eq!(
        wrong("sec: 0\n    nanosec: 4", "sec: -1\n    nanosec: 4"),
        "plan.yaml:28:5: points[1].time_from_start is -0.6 s; 0 s or more is expected\n"
    );
    assert_eq!(
        wrong("  - 0.0\n  - 0.0\n", "  - 0.0\n  - 0.5\n"),
        "plan.yaml:19:3: the velocity of `turret` in the last point is 0.5 rad/s (28.6478898 deg/s); 0 is expected, or set \
         allow_nonzero_velocity_at_trajectory_end\n"
    );
    assert_eq!(
        wrong("  effort: []\n", "  effort: [1.0, 1.0]\n"),
        "plan.yaml:15:11: points[0].effort is not empty; positions, velocities and accelerations are followed\n"
    );
    assert_eq!(
        wrong("points:", "point:"),
        "plan.yaml:9:1: unknown key `point` in the trajectory, did you mean `points`?\n"
    );
    assert_eq!(
        wrong("---\n", "---\nheader: {}\n"),
        "plan.yaml:30:1: a second document starts here; a file holds one\n"
    );
}

/// Without `--full-length` lists end after 128 items.
#[test]
fn plan_that_was_cut_off_is_refused() {
    let cut = |from: &str, to: &str| Bench::with(&ECHO.replacen(from, to, 1)).problems();
    let hint = "print it with `ros2 topic echo --full-length`";
    assert_eq!(cut("---\n", "- '...'\n"), format!("plan.yaml:10:3: points was cut off after 2 items, {hint}\n"));
    assert_eq!(
        cut("- turret\n", "- '...'\n"),
        format!("plan.yaml:7:3: joint_names was cut off after 1 items, {hint}\n")
    );
}

#[test]
fn plan_that_lacks_joints_of_its_group_is_refused_unless_that_is_allowed() {
    let one =
        |text: &str| text.replacen("- turret\n", "", 1).replacen("  - -0.0\n", "", 1).replacen("  - 1.0e-02\n", "", 1);
    let bench = Bench::with(&one(ECHO).replacen("  - 0.0\n  - 0.0\n", "  - 0.0\n", 1));
    let sentence = "plan.yaml:7:3: joint_names has 1 of x, turret; all are expected, or some with allow_partial_joints_goal: true\n";
    assert_eq!(bench.problems(), sentence);
    assert!(bench.read("{file: plan.yaml, allow_partial_joints_goal: true}", "").is_ok());
    assert!(bench.read("{file: plan.yaml, allow_partial_joints_goal: false}", "").is_err());
    assert!(problem("steps", "{at: 0, do: {follow_joint_trajectory: {joints: [x], points: [{time: 1 s, positions: [0]}], ^allow_partial_joints_goal: true}}}").starts_with("unknown key"));
}

#[test]
fn plan_with_conflicting_keys_and_invalid_files_are_refused() {
    let bench = Bench::with(ECHO);
    assert_eq!(
        bench.read("{file: plan.yaml, joints: [x], units: si}", "").unwrap_err(),
        "s.yaml:4:69: joints conflicts with file `plan.yaml`, which has it, leave it out\n\
         s.yaml:4:81: units conflicts with file `plan.yaml`, which has it, leave it out\n"
    );
    let missing = bench.read("{file: none.yaml}", "").unwrap_err();
    assert!(missing.starts_with("none.yaml:1:1: cannot read the file: "), "{missing}");
    let two = format!("trajectory: [{0}, {0}]", JSON.replace('\n', " "));
    assert_eq!(Bench::with(&two).problems(), "plan.yaml:1:13: trajectory is a list of 2; one trajectory is expected\n");
    let floating = JSON.replace("\"joint_names\": [], \"points\": []", "\"points\": [{}]");
    assert!(
        Bench::with(&floating)
            .problems()
            .ends_with("multi_dof_joint_trajectory has points; only joint_trajectory is followed\n")
    );
}

#[test]
fn problems_of_a_plan_and_its_step_are_reported_together() {
    let bench = Bench::with(&ECHO.replacen("  - 0.004\n", "  - x\n", 1));
    assert_eq!(
        bench.read("{file: plan.yaml, path_tolerance: {y: 1 mm}}", "").unwrap_err(),
        "plan.yaml:20:5: points[1].positions[0] is `x`; a finite number is expected\n\
         s.yaml:4:78: `y` is no joint of this trajectory, joints are x, turret\n"
    );
}

#[test]
fn plan_that_a_step_expects_to_be_refused_is_refused() {
    let double = ECHO.replacen("- turret\n", "- x\n", 1);
    assert!(Bench::with(&double).read("{file: plan.yaml}", ", refused: the joint `x` twice").is_ok());
    let wrong = Bench::with(&double).read("{file: plan.yaml}", ", refused: the joint `y` twice").unwrap_err();
    assert!(wrong.starts_with("plan.yaml:7:3: joint_names has the joint `x` twice"), "{wrong}");
    // A violation of limits is found in the cycle, as for points in the verb.
    let fast = ECHO.replacen("- 0.004", "- 0.5", 1);
    let scenario = Bench::with(&fast).read("{file: plan.yaml}", ", refused: max_velocity").unwrap();
    assert!(simulate(&cell(), &scenario, &Options::default()).unwrap().passed());
}
