//! Measures how long a component that answers regularly has been silent, and distinguishes a fault from a lack of processor time.
//!
//! Law      silence is the time since the last answer, minus the delay of the monitoring thread or the time for which the answering threads
//!          waited for a processor, whichever is longer. Threads that are stopped or wait for a lock do not wait for a processor. Without
//!          an answer for `MOST` times the timeout, waits for a processor are no longer deducted
//! Reads    `/proc/<process>/task/*/schedstat` of Linux, only while an answer is overdue. Without it nothing is deducted

use std::collections::HashMap;
use std::fs;
use std::time::{Duration, Instant};

/// Number of timeouts after which waits for a processor are no longer deducted.
const MOST: u32 = 5;

/// Threads that have to answer.
#[derive(Clone, Debug)]
pub enum Threads {
    /// All threads of a process, by its ID.
    Process(u32),
    /// Threads of this process with this name.
    Own(&'static str),
}

/// Silence of one component.
#[derive(Debug)]
pub struct Silence {
    threads: Threads,
    timeout: Duration,
    /// Time between two checks.
    period: Duration,
    answered: Instant,
    checked: Instant,
    /// Total delay of the checks since the last answer.
    late: Duration,
    overdue: Option<Overdue>,
}

/// State while an answer is overdue.
#[derive(Debug)]
struct Overdue {
    /// Previous waiting time for a processor of each thread, in ns, by thread ID.
    before: HashMap<u32, u64>,
    was_reported: bool,
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Check {
    /// No action is necessary.
    Good,
    /// Half of the timeout has passed; reported once, with the duration and the state of each thread.
    Overdue(String),
    /// The silence exceeds the timeout.
    Silent,
}

impl Silence {
    /// Creates the silence of these threads, which starts now. [`Silence::check`] must be called every `period`.
    pub fn new(threads: Threads, timeout: Duration, period: Duration) -> Self {
        let now = Instant::now();
        Self { threads, timeout, period, answered: now, checked: now, late: Duration::ZERO, overdue: None }
    }

    /// Records an answer.
    pub fn answered(&mut self) {
        self.answered = Instant::now();
        self.late = Duration::ZERO;
        self.overdue = None;
    }

    /// Returns the time since the last answer, minus the delay of the checks, because this process may have been suspended.
    pub fn since(&self) -> Duration {
        self.less(Duration::ZERO)
    }

    /// Returns the silence if threads have waited for a processor for this time.
    fn less(&self, starved: Duration) -> Duration {
        self.answered.elapsed().saturating_sub(self.late.max(starved))
    }

    /// Checks how long the silence lasts.
    pub fn check(&mut self) -> Check {
        self.late += self.checked.elapsed().saturating_sub(2 * self.period);
        self.checked = Instant::now();
        if self.since() < self.timeout / 4 {
            return Check::Good;
        }
        let threads = self.threads.read();
        let overdue = self.overdue.get_or_insert_with(|| {
            let before = threads.iter().map(|thread| (thread.id, thread.waited_ns)).collect();
            Overdue { before, was_reported: false }
        });
        let waited =
            |thread: &Thread| thread.waited_ns.saturating_sub(overdue.before.get(&thread.id).copied().unwrap_or(0));
        // A thread that waited less than before has the reused ID of an ended one.
        let starved = Duration::from_nanos(threads.iter().map(waited).max().unwrap_or(0));
        let silence = self.less(starved);
        if silence >= self.timeout || self.since() >= MOST * self.timeout {
            return Check::Silent;
        }
        let is_overdue = silence >= self.timeout / 2;
        if is_overdue && let Some(overdue) = self.overdue.as_mut().filter(|overdue| !overdue.was_reported) {
            overdue.was_reported = true;
            let doing: Vec<String> = threads.iter().map(Thread::doing).collect();
            return Check::Overdue(format!("{} ms; its threads: {}", silence.as_millis(), doing.join(", ")));
        }
        Check::Good
    }
}

/// Thread, as the system reports it.
#[derive(Debug)]
struct Thread {
    id: u32,
    name: String,
    /// State: R runs or waits for a processor, S and D wait, T is stopped.
    state: char,
    /// Kernel function in which the thread waits; empty if it does not wait or the system does not report it.
    place: String,
    /// Total waiting time for a processor, in ns.
    waited_ns: u64,
}

impl Threads {
    /// Returns the threads that the system reports.
    fn read(&self) -> Vec<Thread> {
        let folder = match self {
            Self::Process(id) => format!("/proc/{id}/task"),
            Self::Own(_) => "/proc/self/task".to_owned(),
        };
        let tasks = fs::read_dir(folder).into_iter().flatten().flatten();
        let threads = tasks.filter_map(|task| Thread::read(&task.path()));
        threads.filter(|thread| matches!(self, Self::Process(_)) || self.has(&thread.name)).collect()
    }

    fn has(&self, name: &str) -> bool {
        // The system stores 15 bytes of a name.
        matches!(self, Self::Own(of) if of.get(..15).unwrap_or(of) == name)
    }
}

impl Thread {
    fn read(task: &std::path::Path) -> Option<Self> {
        let text = |file: &str| fs::read_to_string(task.join(file)).map(|text| text.trim().to_owned());
        let (stat, schedstat) = (text("stat").ok()?, text("schedstat").unwrap_or_default());
        // The name is in brackets, and may contain brackets.
        let state = stat.rsplit_once(") ").and_then(|(_, rest)| rest.chars().next())?;
        Some(Self {
            id: task.file_name()?.to_str()?.parse().ok()?,
            name: text("comm").ok()?,
            state,
            place: text("wchan").ok().filter(|place| place != "0").unwrap_or_default(),
            waited_ns: schedstat.split(' ').nth(1).and_then(|waited| waited.parse().ok()).unwrap_or(0),
        })
    }

    fn doing(&self) -> String {
        match (self.state, self.place.as_str()) {
            ('T' | 't', _) => format!("`{}` is stopped", self.name),
            ('R', _) => format!("`{}` runs", self.name),
            (state, "") => format!("`{}` waits ({state})", self.name),
            (_, place) => format!("`{}` waits in {place}", self.name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    const PERIOD: Duration = Duration::from_millis(5);

    fn checks_until_silent(silence: &mut Silence) -> Vec<Check> {
        let mut checks = Vec::new();
        while checks.last() != Some(&Check::Silent) {
            std::thread::sleep(PERIOD);
            checks.extend(Some(silence.check()).filter(|check| *check != Check::Good));
        }
        checks
    }

    #[test]
    fn a_thread_that_waits_for_a_lock_is_silent_and_its_wait_is_reported_once() {
        let (held, released) = channel::<()>();
        let thread = std::thread::Builder::new().name("answers nothing".to_owned());
        let thread = thread.spawn(move || released.recv().is_err()).unwrap();
        let timeout = Duration::from_millis(200);
        let mut silence = Silence::new(Threads::Own("answers nothing"), timeout, PERIOD);
        let begun = Instant::now();
        let checks = checks_until_silent(&mut silence);
        assert!(begun.elapsed() >= timeout);
        let [Check::Overdue(text), Check::Silent] = checks.as_slice() else { panic!("{checks:?}") };
        assert!(text.contains("ms; its threads: `answers nothing` waits"), "{text}");
        silence.answered();
        assert_eq!(silence.check(), Check::Good);
        drop(held);
        assert!(thread.join().unwrap());
    }

    #[test]
    fn the_time_for_which_the_watch_itself_came_late_is_deducted() {
        let mut silence = Silence::new(Threads::Own("nobody"), Duration::from_millis(100), PERIOD);
        std::thread::sleep(Duration::from_millis(300));
        assert_eq!(silence.check(), Check::Good);
        assert_eq!(checks_until_silent(&mut silence).last(), Some(&Check::Silent));
        let since = silence.since().as_millis();
        assert!((100..250).contains(&since), "{since} ms");
    }

    #[test]
    fn the_longer_of_lateness_and_of_waiting_for_a_processor_is_deducted() {
        let ms = Duration::from_millis;
        let mut silence = Silence::new(Threads::Own("nobody"), ms(100), PERIOD);
        silence.answered = Instant::now() - ms(1000);
        silence.late = ms(300);
        let near = |silence: Duration, expected| (expected..expected + ms(100)).contains(&silence);
        assert!(near(silence.less(ms(200)), ms(700)) && near(silence.less(ms(400)), ms(600)));
        assert_eq!(silence.less(ms(2000)), Duration::ZERO);
        assert!(near(silence.since(), ms(700)));
        // Regardless of how long threads wait for a processor.
        silence.overdue = Some(Overdue { before: HashMap::new(), was_reported: true });
        assert_eq!(silence.check(), Check::Silent, "700 ms are more than 5 times 100 ms");
    }

    #[test]
    fn the_system_tells_how_long_each_thread_has_waited_for_a_processor() {
        let waited = || {
            let threads = Threads::Process(std::process::id()).read();
            threads.iter().map(|thread| thread.waited_ns).sum::<u64>()
        };
        let before = waited();
        (0..100).for_each(|_| std::thread::sleep(Duration::from_micros(100)));
        assert!(waited() > before);
    }
}
