//! `lineshaft jog`: streams velocities to one axis.
//!
//! Law      the velocity is published 50 times per second. The axis stops by itself when the stream ends for any
//!          reason, because the node uses no velocity for longer than `setpoint_timeout` (100 ms). At the end of the
//!          time, and on a signal, velocity 0 stops it immediately. A jog ends permanently as soon as anything else
//!          stops the axis (halt, disable, an error, a limit) or moves it, or if this program was frozen: it never
//!          starts the axis a second time
//! Writes   `~/setpoints`, with names of axes; `~/jog` has the same stream with joint names of the axes, which the
//!          interface does not report

use super::amount::Given;
use super::info::{AxisInfos, no_axis};
use super::node_log::NodeLog;
use super::output::{Progress, node_option, position_text, print, short, si_unit, with_commands};
use super::session::{Session, axis_states, own_end};
use super::state::error_line;
use super::stop::Stop;
use super::{Failure, Options};
use crate::recording::clean::clean;
use lineshaft_core::unit::{ScaleKind, Unit};
use lineshaft_msgs::msg::{AxisState, AxisStates, Event, Setpoints};
use lineshaft_ros::layer::{Publisher, Qos, Subscription};
use std::time::Duration;
use tokio::time::{Instant, Interval, MissedTickBehavior, interval, sleep_until, timeout};

/// Time between two messages.
const PERIOD: Duration = Duration::from_millis(20);
/// Number of messages with velocity 0 at the end.
const ZEROS: u32 = 3;
/// Time within which the axis must begin to move.
const BEGIN: Duration = Duration::from_secs(1);
/// Time without a state of the axis after which the jog ends.
const SILENCE: Duration = Duration::from_secs(1);
/// Maximum delay of the states, in periods.
const LATE_PERIODS: u32 = 3;
/// Time between two messages after which this program counts as frozen. The axis has stopped by then.
const FROZEN: Duration = Duration::from_millis(500);
/// `AxisState.reference` of an axis that follows a stream.
const BY_STREAM: u8 = 9;
/// Maximum time until the node reports why it has stopped the axis.
const REASON: Duration = Duration::from_millis(300);
/// Maximum time for the stop at the end.
const STOPPING: Duration = Duration::from_secs(60);

/// Parameters of a jog.
#[derive(Clone, Debug)]
pub(crate) struct Jog {
    pub(crate) axis: String,
    pub(crate) velocity: Given,
    /// Time after which it ends; `None` if it ends on a signal.
    pub(crate) time: Option<Duration>,
}

/// Moves the axis at the velocity, stops it, and prints its position.
///
/// # Errors
/// Returns an error if the axis does not follow, or if the node has ended.
pub(crate) async fn jog(options: &Options, jog: &Jog) -> Result<(), Failure> {
    let session = Session::open(options).await?;
    let node = node_option(session.target());
    let (kind, unit) = AxisInfos::open(&session)?.of(&session, &jog.axis).await?;
    let velocity = jog.velocity.si((kind, unit))?;
    if velocity == 0.0 {
        return Err(Failure::Usage(format!("VELOCITY: 0 does not move the axis; `lineshaft halt{node}` stops it")));
    }
    let mut states = axis_states(&session)?;
    let before = session.first_states(&mut states).await?;
    let axis = of_axis(&before, &jog.axis).ok_or_else(|| no_axis(&session, &jog.axis))?;
    if !axis.enabled {
        let name = &jog.axis;
        return Err(Failure::Failed(format!(
            "{name}: the axis is not enabled; `lineshaft enable {name}{node}` enables it"
        )));
    }
    let (log, events) = (NodeLog::open(&session)?, session.topic::<Event>("events", Qos::EVENTS)?);
    let setpoints = session.publisher::<Setpoints>("setpoints", Qos::STREAM)?;
    // Recorders and other tools may read the topic as well.
    session.matched(&setpoints.topic().to_string(), || setpoints.subscriptions().min(1)).await?;
    let mut ticks = interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let shown = Shown { kind, unit, progress: Progress::new() };
    let mut stream = Stream {
        session: &session,
        states,
        events,
        log,
        setpoints,
        ticks,
        stop: Stop::listen()?,
        axis: &jog.axis,
        shown,
        has_moved: false,
    };
    stream.log.skip().await;
    let end = stream.run(velocity, jog.time).await;
    // Also after a failure, because the axis may move.
    let stopped = stream.stop().await;
    end?;
    let state = stopped?;
    if let Some(error) = error_line(&state, session.target()) {
        return Err(Failure::Failed(error));
    }
    print(&format!("{}: {}", jog.axis, position_text(state.position, Some(kind), unit)));
    Ok(())
}

/// Returns the state of an axis.
fn of_axis<'a>(states: &'a AxisStates, axis: &str) -> Option<&'a AxisState> {
    states.axes.iter().find(|state| state.name == axis)
}

/// Returns the message with the velocity of an axis (in m/s or rad/s). It has no stamp, because the clocks of two hosts
/// may differ.
fn message(axis: &str, velocity: f64) -> Setpoints {
    Setpoints { axes: vec![axis.to_owned()], velocities: vec![velocity], ..Setpoints::default() }
}

/// Whether a refusal names an axis. Streams of other clients are refused on the same topic.
fn names(refusal: &str, axis: &str) -> bool {
    refusal.split(|sign: char| !(sign.is_alphanumeric() || sign == '_')).any(|word| word == axis)
}

/// Whether the new state in an event is another one than that of a jog.
fn ends_jog(state: &str) -> bool {
    !state.ends_with("CONTINUOUS_MOTION")
}

/// Line of the log of the node about the axis.
struct LogLine {
    received: Instant,
    text: String,
}

/// Returns the line if it is recent. An older one, such as a warning during the jog, is not the reason for its end.
fn recent(line: Option<LogLine>) -> Option<String> {
    line.filter(|line| line.received.elapsed() < SILENCE).map(|line| line.text)
}

/// Format of positions.
struct Shown {
    kind: ScaleKind,
    unit: Option<Unit>,
    progress: Progress,
}

/// Stream to one axis.
struct Stream<'a> {
    session: &'a Session,
    states: Subscription<AxisStates>,
    events: Subscription<Event>,
    log: NodeLog,
    setpoints: Publisher<Setpoints>,
    ticks: Interval,
    stop: Stop,
    axis: &'a str,
    shown: Shown,
    /// Whether the axis has followed the stream.
    has_moved: bool,
}

impl Stream<'_> {
    /// Publishes the velocity until the time has passed or a signal is received.
    async fn run(&mut self, velocity: f64, time: Option<Duration>) -> Result<(), Failure> {
        let session = self.session;
        let gone = session.gone();
        tokio::pin!(gone);
        let begun = Instant::now();
        let (mut heard, mut sent, mut silence) = (begun, begun, SILENCE);
        // The last line of the log about the axis.
        let mut line: Option<LogLine> = None;
        loop {
            tokio::select! {
                biased;
                () = self.stop.requested() => return Ok(()),
                _ = self.ticks.tick() => {
                    let frozen = sent.elapsed();
                    sent = Instant::now();
                    if frozen >= FROZEN {
                        return Err(self.frozen(frozen));
                    }
                    if time.is_some_and(|time| begun.elapsed() >= time) {
                        let fails = !self.has_moved && (line.is_some() || begun.elapsed() >= BEGIN);
                        return if fails { Err(self.does_not_move(line)) } else { Ok(()) };
                    }
                    if heard.elapsed() >= silence {
                        return Err(session.no_states().await);
                    }
                    self.setpoints.publish(&message(self.axis, velocity)).map_err(Failure::failed)?;
                    if !self.has_moved && begun.elapsed() >= BEGIN.max(silence) {
                        return Err(self.does_not_move(line));
                    }
                }
                states = self.states.next() => {
                    let states = states.ok_or_else(own_end)?;
                    let Some(state) = of_axis(&states, self.axis) else { return Err(no_axis(session, self.axis)) };
                    silence = silence.max(heard.elapsed() * LATE_PERIODS);
                    heard = Instant::now();
                    let follows = state.state == AxisState::CONTINUOUS_MOTION && state.reference == BY_STREAM;
                    self.show(state);
                    if self.has_moved && !follows {
                        let reason = self.reason(recent(line), None).await;
                        return Err(self.ended_by_other(reason));
                    }
                    self.has_moved |= follows;
                }
                // A halt may be shorter than the time between two states.
                event = self.events.next() => {
                    let event = event.ok_or_else(own_end)?;
                    let ends = event.kind == "error" || event.kind == "state" && ends_jog(&event.text);
                    if self.has_moved && event.source == self.axis && ends {
                        let known = if event.kind == "error" { Some(event.text.clone()) } else { recent(line) };
                        let reason = self.reason(known, Some(event.text)).await;
                        return Err(self.ended_by_other(reason));
                    }
                }
                text = self.log.next() => {
                    if let Some(refusal) = text.strip_prefix("setpoints: ")
                        && names(refusal, self.axis)
                    {
                        return Err(Failure::Failed(self.with_commands(refusal)));
                    }
                    if text.strip_prefix(self.axis).is_some_and(|rest| rest.starts_with(':')) {
                        let text = self.with_commands(&text);
                        eprintln!("{}", clean(&text));
                        line = Some(LogLine { received: Instant::now(), text });
                    }
                }
                failure = &mut gone => return Err(failure),
            }
        }
    }

    fn with_commands(&self, message: &str) -> String {
        with_commands(message, &[self.axis], self.session.target())
    }

    fn frozen(&self, time: Duration) -> Failure {
        Failure::Failed(format!(
            "{}: this command was frozen for {} ms; the jog has ended",
            self.axis,
            time.as_millis()
        ))
    }

    /// Returns the reason for the end of the jog: the known one, otherwise the one that the node reports soon, otherwise the new state of
    /// the axis, which is reported first.
    async fn reason(&mut self, known: Option<String>, mut state: Option<String>) -> Option<String> {
        if known.is_some() {
            return known;
        }
        let axis = self.axis;
        let reported = async {
            while let Some(event) = self.events.next().await {
                match event.kind.as_str() {
                    _ if event.source != axis => {}
                    "error" | "limit" | "warning" => return Some(event.text),
                    "state" if state.is_none() && ends_jog(&event.text) => state = Some(event.text),
                    _ => {}
                }
            }
            None
        };
        let reported = timeout(REASON, reported).await.ok().flatten();
        reported.or(state)
    }

    /// Returns the error for an axis that was stopped or moved otherwise.
    fn ended_by_other(&self, reason: Option<String>) -> Failure {
        let of = |reason: String| format!(" ({})", clean(&self.with_commands(&reason)));
        let reason = reason.map_or_else(String::new, of);
        Failure::Failed(format!("{}: the axis does not follow the jog any more{reason}; the jog has ended", self.axis))
    }

    fn does_not_move(&self, line: Option<LogLine>) -> Failure {
        let unknown =
            || format!("{}: the axis does not follow the velocity; `lineshaft state` shows its state", self.axis);
        Failure::Failed(line.map_or_else(unknown, |line| line.text))
    }

    fn show(&self, state: &AxisState) {
        let Shown { kind, unit, progress } = &self.shown;
        let position = position_text(state.position, Some(*kind), *unit);
        progress.show(&format!("{}: {position}, {} {}", self.axis, short(state.velocity), si_unit(Some(*kind), 1)));
    }

    /// Stops the axis, and returns its state at standstill.
    async fn stop(&mut self) -> Result<AxisState, Failure> {
        for _ in 0..ZEROS {
            self.ticks.tick().await;
            self.setpoints.publish(&message(self.axis, 0.0)).map_err(Failure::failed)?;
        }
        // This command does not move it, but another client may.
        if !self.has_moved {
            let states = self.session.first_states(&mut self.states).await?;
            return of_axis(&states, self.axis).cloned().ok_or_else(|| no_axis(self.session, self.axis));
        }
        // Discards earlier states, which do not show whether it is at standstill now.
        while matches!(timeout(Duration::ZERO, self.states.next()).await, Ok(Some(_))) {}
        let session = self.session;
        let gone = session.gone();
        tokio::pin!(gone);
        let limit = Instant::now() + STOPPING;
        loop {
            tokio::select! {
                states = self.states.next() => {
                    let states = states.ok_or_else(own_end)?;
                    let Some(state) = of_axis(&states, self.axis) else { return Err(no_axis(session, self.axis)) };
                    self.show(state);
                    let is_moved_by_other = state.state != AxisState::STOPPING && state.reference != BY_STREAM;
                    if is_moved_by_other || state.state != AxisState::CONTINUOUS_MOTION && state.command_velocity == 0.0 {
                        return Ok(state.clone());
                    }
                }
                () = self.stop.requested() => {
                    return Err(Failure::Failed(format!("ended by a second signal; {} may still be stopping", self.axis)));
                }
                failure = &mut gone => return Err(failure),
                () = sleep_until(limit) => {
                    let time = STOPPING.as_secs();
                    return Err(Failure::Failed(format!("{}: the axis still moves after {time} s", self.axis)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_node::{LONG, TestNode};
    use super::*;
    use lineshaft_msgs::cdr;
    use tokio::time::sleep;

    fn stream(session: &Session, setpoints: Publisher<Setpoints>, stop: Stop) -> Stream<'_> {
        Stream {
            session,
            states: axis_states(session).unwrap(),
            events: session.topic::<Event>("events", Qos::EVENTS).unwrap(),
            log: NodeLog::open(session).unwrap(),
            setpoints,
            ticks: interval(PERIOD),
            stop,
            axis: "x",
            shown: Shown { kind: ScaleKind::Linear, unit: None, progress: Progress::new() },
            has_moved: false,
        }
    }

    /// The state of the axis is reported before the reason.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn jog_that_the_node_ends_reports_its_reason() {
        let served = TestNode::start("jog_reason");
        let events = served.node.publisher::<Event>("~/events", Qos::EVENTS).unwrap();
        let session = served.session().await;
        let setpoints = session.publisher::<Setpoints>("setpoints", Qos::STREAM).unwrap();
        let (_signals, stop) = Stop::made();
        let mut stream = Stream { has_moved: true, ..stream(&session, setpoints, stop) };
        let matched = async {
            while events.subscriptions() == 0 {
                sleep(Duration::from_millis(2)).await;
            }
        };
        timeout(LONG, matched).await.expect("the jog reads the events");
        let event = |kind: &str, text: &str| Event {
            kind: kind.to_owned(),
            source: "x".to_owned(),
            text: text.to_owned(),
            ..Event::default()
        };
        // The jog may match the topic later than the node.
        let node = async {
            for _ in 0..1000 {
                events.publish(&event("state", "x: now DISCRETE_MOTION")).unwrap();
                events.publish(&event("warning", "x: streamed setpoints stopped coming")).unwrap();
                sleep(Duration::from_millis(20)).await;
            }
        };
        let end = tokio::select! {
            end = stream.run(0.5, None) => end.unwrap_err().to_string(),
            () = node => panic!("the jog goes on"),
        };
        let want =
            "x: the axis does not follow the jog any more (x: streamed setpoints stopped coming); the jog has ended";
        assert_eq!(end, want);
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn new_state_of_the_axis_is_the_reason_if_the_node_reports_no_other() {
        let served = TestNode::start("jog_state");
        let events = served.node.publisher::<Event>("~/events", Qos::EVENTS).unwrap();
        let session = served.session().await;
        let setpoints = session.publisher::<Setpoints>("setpoints", Qos::STREAM).unwrap();
        let (_signals, stop) = Stop::made();
        let mut stream = stream(&session, setpoints, stop);
        let event = |source: &str, text: &str| Event {
            kind: "state".to_owned(),
            source: source.to_owned(),
            text: text.to_owned(),
            ..Event::default()
        };
        let node = async {
            for _ in 0..1000 {
                events.publish(&event("x", "x: now CONTINUOUS_MOTION")).unwrap();
                events.publish(&event("y", "y: now STANDSTILL")).unwrap();
                events.publish(&event("x", "x: now STOPPING")).unwrap();
                sleep(Duration::from_millis(20)).await;
            }
        };
        // The first events may be lost.
        let reason = async {
            loop {
                if let Some(reason) = stream.reason(None, None).await {
                    return reason;
                }
            }
        };
        let reason = tokio::select! {
            reason = reason => reason,
            () = node => panic!("no state is reported"),
        };
        assert_eq!(reason, "x: now STOPPING");
    }

    #[test]
    fn old_line_of_the_log_is_not_the_reason_for_the_end() {
        let line = |received| Some(LogLine { received, text: "x: warning".to_owned() });
        let now = Instant::now();
        assert_eq!(recent(line(now)).as_deref(), Some("x: warning"));
        assert_eq!(recent(line(now - SILENCE)), None);
        assert_eq!(recent(None), None);
    }

    /// The signal and the first velocity are due at the same time.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn signal_before_the_first_velocity_lets_no_motion_begin() {
        let served = TestNode::start("jog_signal");
        let mut heard = served.node.subscription::<Setpoints>("~/setpoints", Qos::STREAM).unwrap();
        let session = served.session().await;
        let setpoints = session.publisher::<Setpoints>("setpoints", Qos::STREAM).unwrap();
        session.matched("setpoints", || setpoints.subscriptions().min(1)).await.unwrap();
        let (signals, stop) = Stop::made();
        signals.send(()).unwrap();
        let mut stream = stream(&session, setpoints, stop);
        stream.run(0.5, None).await.unwrap();
        stream.setpoints.publish(&message("x", 0.25)).unwrap();
        // Messages of a publisher keep their order: this one is the first.
        let first = timeout(LONG, heard.next()).await.unwrap().unwrap();
        assert_eq!(first.velocities, [0.25]);
    }

    #[test]
    fn message_names_the_axis_and_its_velocity_without_a_stamp() {
        let bytes = cdr::encode(&message("x", -0.25));
        // Stamp of 8 bytes, empty frame, 1 axis `x`, 1 velocity, aligned to 8.
        let begin =
            [&[0; 8][..], &[1, 0, 0, 0, 0, 0, 0, 0], &[1, 0, 0, 0, 2, 0, 0, 0], b"x\0\0\0", &[1, 0, 0, 0]].concat();
        assert_eq!(bytes[..begin.len()], begin);
        assert_eq!(bytes[begin.len()..], (-0.25_f64).to_le_bytes());
    }

    #[test]
    fn refusal_of_another_axis_is_no_refusal_of_this_one() {
        let refusal = "velocity 3 m/s (3000 mm/s) of x exceeds max_velocity 1.2 m/s (1200 mm/s)";
        assert!(names(refusal, "x") && !names(refusal, "y") && !names(refusal, "max"));
    }

    #[test]
    fn state_is_that_of_the_axis_with_this_name() {
        let axis = |name: &str| AxisState { name: name.to_owned(), ..AxisState::default() };
        let states = AxisStates { axes: vec![axis("x"), axis("x2")], ..AxisStates::default() };
        assert_eq!(of_axis(&states, "x2").map(|state| state.name.as_str()), Some("x2"));
        assert_eq!(of_axis(&states, "y"), None);
    }
}
