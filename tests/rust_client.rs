//! Tests the example of a client in Rust: docs/rust_client.md.

use crate::support::{domain::Domain, program::Program};
use rust_client::Lineshaft;

/// The node answers both mappings of services; `ros2-client` uses one of them.
#[test]
fn a_client_in_rust_enables_an_axis_moves_it_and_reads_its_joint() {
    let domain = Domain::take();
    let mut program = Program::start(&["run"], &domain);
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().expect("threads");
    runtime.block_on(async {
        let number = domain.to_string().parse().expect("the number of a domain");
        let lineshaft = Lineshaft::open(number, true, "/lineshaft").expect("a node");
        lineshaft.wait().await.expect("the node");
        assert_eq!(
            lineshaft.enable(&["nobody"]).await,
            Err("no axis is called `nobody`; there are line, x, y, turret".to_owned())
        );
        lineshaft.enable(&["x"]).await.expect("it is enabled");

        let moved = lineshaft.move_to("x", 0.05).await.expect("it is moved");
        assert_eq!((moved.status as i8, moved.result.code, moved.result.message.as_str()), (4, 0, ""));
        // 1048576 inc are 10 mm.
        assert_eq!(moved.result.position_increments, 5_242_880);
        assert!((moved.joint - 0.05).abs() < 1e-5, "{}", moved.joint);
        let way: Vec<f64> = moved.feedback.iter().map(|feedback| feedback.distance_to_go).collect();
        assert!(way.len() >= 2 && way.is_sorted_by(|before, after| before >= after), "{way:?}");

        // Beyond its limit: accepted, and aborted with the message.
        let beyond = lineshaft.move_to("x", 9.0).await.expect("an answer");
        assert_eq!(beyond.status as i8, 6);
        assert!(beyond.result.message.contains("max_position"), "{}", beyond.result.message);
        let nobody = lineshaft.move_to("nobody", 0.0).await.expect_err("no such axis");
        assert_eq!(nobody, "the goal was rejected; /rosout says why");
    });
    program.end();
}
