//! Quality of service (QoS) profiles, with the terms of ROS 2.

use std::time::Duration;

use serde::{Deserialize, Serialize};

/// How samples of a topic are delivered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Qos {
    /// Whether lost samples are sent again (`reliable` in ROS 2, otherwise `best_effort`).
    pub reliable: bool,
    /// Number of samples that are kept for a reader; at least 1.
    pub depth: u16,
    /// Whether readers that join later get the kept samples (`transient_local` in ROS 2, otherwise `volatile`).
    pub latched: bool,
    /// Age after which readers drop a sample; `None`: never.
    pub lifespan: Option<Duration>,
    /// Maximum number of unacknowledged samples of a writer; it refuses more. A reader holds `depth` samples.
    pub window: i32,
}

impl Qos {
    /// State that is published periodically.
    pub const STREAM: Self = Self::volatile(10);
    /// Events, which must not be lost in a burst.
    pub const EVENTS: Self = Self::volatile(1000);
    /// Requests and replies.
    pub const SERVICE: Self = Self::volatile(10);
    /// Requests and replies of the parameter services, and parameter events.
    pub const PARAMETERS: Self = Self::volatile(1000);
    /// One current value, also for readers that join later.
    pub const STATUS: Self = Self { latched: true, ..Self::volatile(1) };
    /// Latest values of a topic that is published rarely, also for readers that join later.
    pub const HISTORY: Self = Self { latched: true, ..Self::volatile(32) };
    /// Log messages.
    pub const ROSOUT: Self =
        Self { latched: true, lifespan: Some(Duration::from_secs(10)), window: 1000, ..Self::volatile(1000) };

    /// Simulation time: only the newest sample matters, and it is published often.
    pub const CLOCK: Self = Self { reliable: false, ..Self::volatile(1) };

    const fn volatile(depth: u16) -> Self {
        // With a finite window, every reader that joins later would block the writer until its first acknowledgement:
        // the DDS layer counts all samples ever written as unacknowledged by that reader. A suspended reader holds samples
        // until its lease expires, after 10 to 20 s.
        Self { reliable: true, depth, latched: false, lifespan: None, window: i32::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_those_of_ros_2() {
        // rmw/qos_profiles.h, rcl/logging_rosout.h, rcl_action/default_qos.h
        assert_eq!((Qos::STREAM.depth, Qos::STREAM.latched), (10, false));
        assert_eq!((Qos::SERVICE.depth, Qos::SERVICE.latched), (10, false));
        assert_eq!((Qos::PARAMETERS.depth, Qos::PARAMETERS.latched), (1000, false));
        assert_eq!((Qos::STATUS.depth, Qos::STATUS.latched), (1, true));
        assert_eq!((Qos::HISTORY.depth, Qos::HISTORY.latched), (32, true));
        assert_eq!((Qos::ROSOUT.depth, Qos::ROSOUT.latched), (1000, true));
        assert_eq!(Qos::ROSOUT.lifespan, Some(Duration::from_secs(10)));
    }
}
