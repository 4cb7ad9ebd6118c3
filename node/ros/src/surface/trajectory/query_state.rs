//! `~/query_state`: state that the trajectory of a group commands to its joints at a time.
//!
//! Law      the machine answers for each joint, from its present or waiting trajectory. A joint without one stays at its position
//! Refuses  a time that the trajectory does not cover; no trajectory at all; a joint in another motion; an inactive controller
//! Source   joint_trajectory_controller (Jazzy), which also answers at the time of its last point that the trajectory has ended

use super::TrajectoryReceiver;
use super::convert::seconds;
use crate::layer::{Request, ServiceServer};
use lineshaft_core::command::{Action, QueryTrajectory};
use lineshaft_core::event::{Event, Kind, Number};
use lineshaft_core::unit::Scale;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::control_msgs::srv::{QueryTrajectoryState, QueryTrajectoryStateResponse};
use tokio::task::JoinSet;

pub(super) async fn serve(mut server: ServiceServer<QueryTrajectoryState>, taker: TrajectoryReceiver) {
    // Waiting answers end with the service.
    let mut open = JoinSet::new();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let taker = taker.clone();
        open.spawn(async move {
            let response = taker.states(&message.time).await;
            let refusal = |message| QueryTrajectoryStateResponse { message, ..Default::default() };
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(response.unwrap_or_else(refusal)).await;
        });
    }
}

impl TrajectoryReceiver {
    /// Queries one joint after another, so that a refusal is reported once.
    async fn states(&self, time: &Time) -> Result<QueryTrajectoryStateResponse, String> {
        let Self { hub, controllers, joints, place } = self;
        controllers.check(*place)?;
        let (snapshot, config) = (hub.host.snapshot(), hub.host.config());
        let now_ns = snapshot.cycle.saturating_mul(config.cycle_ns);
        let at_ns = machine_ns(time, now_ns, hub.clock.stamp(snapshot.stamp_ns))?;
        let mut answers = Vec::with_capacity(joints.axes.len());
        for &axis in &joints.axes {
            let query = Action::QueryTrajectory(QueryTrajectory { axis, at_ns });
            let answer = hub.submit(query).map_err(|busy| busy.to_string())?.answer().await?;
            if answer.kind == Kind::Refused {
                return Err(joints.sentence(&answer, config));
            }
            answers.push(answer);
        }
        let axes = joints.axes.iter().filter_map(|&axis| config.axes.get(usize::from(axis)));
        let response = states(&answers, axes.map(|axis| axis.scale));
        Ok(QueryTrajectoryStateResponse { name: joints.names.clone(), ..response })
    }
}

/// Converts the requested time to time of the machine, in ns; `now_ns` is that of a cycle, `stamp_ns` its stamp.
fn machine_ns(time: &Time, now_ns: u64, stamp_ns: u64) -> Result<u64, String> {
    let asked_ns = i64::from(time.sec) * 1_000_000_000 + i64::from(time.nanosec);
    let at_ns = i128::from(now_ns) + i128::from(asked_ns) - i128::from(stamp_ns);
    u64::try_from(at_ns).map_err(|_| {
        let first = i128::from(stamp_ns) - i128::from(now_ns);
        let first = i64::try_from(first).unwrap_or(i64::MAX);
        format!("time is {} s, before the first cycle of the node at {} s", seconds(asked_ns), seconds(first))
    })
}

/// Returns the answers of the machine, in SI units, in the order of the joints.
fn states(answers: &[Event], scales: impl Iterator<Item = Scale>) -> QueryTrajectoryStateResponse {
    let mut response = QueryTrajectoryStateResponse::default();
    for (answer, scale) in answers.iter().zip(scales) {
        let rate = |number| match number {
            Number::Velocity(rate) | Number::Acceleration(rate) => scale.rate_to_si(rate),
            _ => 0.0,
        };
        let (whole, fraction) = (answer.position.floor(), answer.position.fraction());
        response.position.push(scale.position_to_si(whole, fraction));
        response.velocity.push(rate(answer.asked));
        response.acceleration.push(rate(answer.limit));
    }
    // Next point of the trajectory, the same for all joints that have one.
    let mut places = answers.iter().filter_map(|answer| answer.place);
    let first = places.next();
    response.message = match first {
        None => "no trajectory runs".to_owned(),
        Some(first) if places.any(|place| place != first) => {
            "the joints follow several trajectories, as one has been replaced; ask again".to_owned()
        }
        Some(_) => {
            response.success = true;
            String::new()
        }
    };
    response
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::code::Code;
    use lineshaft_core::event::{Severity, TrajectoryPlace};
    use lineshaft_core::object::Object;
    use lineshaft_core::position::Position;

    fn time(sec: i32, nanosec: u32) -> Time {
        Time { sec, nanosec }
    }

    /// The cycle at 2 s of the machine has the stamp 100 s.
    #[test]
    fn times_of_ros_become_times_of_the_machine() {
        let at = |time| machine_ns(&time, 2_000_000_000, 100_000_000_000);
        assert_eq!(at(time(100, 0)), Ok(2_000_000_000));
        assert_eq!(at(time(101, 7)), Ok(3_000_000_007));
        assert_eq!(at(time(98, 0)), Ok(0));
        let before = "time is 97.999999999 s, before the first cycle of the node at 98 s";
        assert_eq!(at(time(97, 999_999_999)), Err(before.to_owned()));
        assert_eq!(
            at(time(i32::MIN, 0)).unwrap_err(),
            "time is -2147483648 s, before the first cycle of the node at 98 s"
        );
    }

    fn answer(position: i64, rates: [f64; 2], point: Option<u32>) -> Event {
        let place = point.map(|point| TrajectoryPlace { point, time_ns: 1, stretch: 1.0, max_stretch: 1.0 });
        let event = Event::new(Severity::Info, Kind::Accepted, Object::Axis(0), Code::NONE);
        let position = Position::whole(position);
        Event { position, place, ..event.with(Number::Velocity(rates[0]), Number::Acceleration(rates[1])) }
    }

    #[test]
    fn answer_contains_moving_and_resting_joints() {
        let config = super::super::tests::config();
        let scales = || config.axes.iter().map(|axis| axis.scale);
        let si = |rate| config.axes[0].scale.rate_to_si(rate);
        let both = [answer(500, [20.0, -30.0], Some(1)), answer(7, [0.0; 2], None)];
        let state = states(&both, scales());
        assert_eq!((state.success, &*state.message), (true, ""));
        assert_eq!((state.position[0], state.velocity[0], state.acceleration[0]), (si(500.0), si(20.0), si(-30.0)));
        assert_eq!((state.position.len(), state.velocity[1], state.acceleration[1]), (2, 0.0, 0.0));
        let none = states(&both[1..], scales());
        assert_eq!((none.success, &*none.message, none.position.len()), (false, "no trajectory runs", 1));
        let several = states(&[both[0], answer(7, [0.0; 2], Some(2))], scales());
        assert!(!several.success && several.message.ends_with("ask again"), "{}", several.message);
    }
}
