//! `cargo run -p rust_client -- /lineshaft x 0.05`: enables an axis and moves it to a position (m or rad).

use rust_client::Lineshaft;
use std::env;
use std::process::ExitCode;

#[tokio::main]
async fn main() -> ExitCode {
    match run().await {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("{sentence}");
            ExitCode::FAILURE
        }
    }
}

async fn run() -> Result<(), String> {
    let words: Vec<String> = env::args().skip(1).collect();
    let [node, axis, position] = words.as_slice() else {
        return Err("usage: rust_client NODE AXIS POSITION, such as /lineshaft x 0.05".to_owned());
    };
    let position: f64 = position.parse().map_err(|_| format!("POSITION is {position}; a number is needed"))?;
    let domain = env::var("ROS_DOMAIN_ID").unwrap_or_else(|_| "0".to_owned());
    let domain = domain.parse().map_err(|_| format!("ROS_DOMAIN_ID is {domain}; 0 to 232 is allowed"))?;
    let loopback = env::var("ROS_AUTOMATIC_DISCOVERY_RANGE").is_ok_and(|range| range == "LOCALHOST");

    let lineshaft = Lineshaft::open(domain, loopback, node)?;
    lineshaft.wait().await?;
    lineshaft.enable(&[axis]).await?;
    let moved = lineshaft.move_to(axis, position).await?;
    for feedback in &moved.feedback {
        println!("at {:.6}, {:.6} to go", feedback.position, feedback.distance_to_go);
    }
    println!("{:?} at {:.6}; joint_states says {:.6}", moved.status, moved.result.position, moved.joint);
    if moved.result.code == 0 { Ok(()) } else { Err(moved.result.message) }
}
