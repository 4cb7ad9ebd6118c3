//! Slow part of the backends: starting, stopping and health, in its own thread.
//!
//! Law      all backends are started before the first cycle, and none is stopped before the last one has finished; they
//!          are stopped in reverse order. Started backends do their periodic work while others are started or stopped,
//!          which may take seconds, because their devices supervise the master
//! Refuses  to let cycles run if a backend does not start; the started ones are then stopped

use super::gate::Gate;
use lineshaft_core::drive::{Health, Note, Service, ServiceError};
use lineshaft_ros::surface::host::BackendHealth;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Polling interval of the health of the backends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Starts, supervises and stops the backends.
pub struct Services {
    all: Vec<Box<dyn Service>>,
    gate: Arc<Gate>,
    board: HealthBoard,
}

/// Health of each backend, for display.
#[derive(Clone, Debug, Default)]
pub struct HealthBoard(Arc<Mutex<Vec<BackendHealth>>>);

impl HealthBoard {
    fn rows(&self) -> MutexGuard<'_, Vec<BackendHealth>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the health of all backends.
    pub fn read(&self) -> Vec<BackendHealth> {
        self.rows().clone()
    }

    fn set(&self, place: usize, health: Option<Health>) {
        if let Some(row) = self.rows().get_mut(place) {
            row.health = health;
        }
    }
}

impl Services {
    /// Creates the services of a machine; its gate waits for them from now on.
    pub fn new(all: Vec<Box<dyn Service>>, gate: Arc<Gate>) -> Self {
        gate.wait_for_services();
        let rows = all.iter().map(|service| BackendHealth {
            name: service.name().to_owned(),
            hardware: service.hardware(),
            health: None,
        });
        let board = HealthBoard(Arc::new(Mutex::new(rows.collect())));
        Self { all, gate, board }
    }

    /// Returns the display of their health.
    pub fn board(&self) -> HealthBoard {
        self.board.clone()
    }

    /// Runs until `stop` is set and no cycle runs; `tell` gets events of the devices.
    pub fn run(mut self, stop: &AtomicBool, tell: &(impl Fn(Note) + Sync)) {
        while !stop.load(Ordering::Relaxed) {
            if !self.gate.is_wanted() {
                std::thread::sleep(POLL_INTERVAL);
                continue;
            }
            if let Err(error) = self.start() {
                self.gate.fail(error.to_string());
                continue;
            }
            self.gate.set_ready();
            self.look_after_all(stop, tell);
            self.stop(self.all.len());
        }
    }

    fn start(&mut self) -> Result<(), ServiceError> {
        for place in 0..self.all.len() {
            let (started, others) = self.all.split_at_mut(place);
            if let Some(Err(error)) = others.first_mut().map(|next| run_during(started, || next.start())) {
                self.stop(place);
                return Err(error);
            }
        }
        Ok(())
    }

    /// Supervises all backends until no cycle runs any more. Each has its own thread, because it may wait for its
    /// devices.
    fn look_after_all(&mut self, stop: &AtomicBool, tell: &(impl Fn(Note) + Sync)) {
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let (is_over, board) = (&is_over, &self.board);
            for (place, service) in self.all.iter_mut().enumerate() {
                let show = move |mut health: Health| {
                    std::mem::take(&mut health.notes).into_iter().for_each(tell);
                    board.set(place, Some(health));
                };
                scope.spawn(move || look_after(service.as_mut(), is_over, show));
            }
            // The cycle thread ends first; the program ensures this.
            while !self.gate.end_of_cycles() && !stop.load(Ordering::Relaxed) {
                std::thread::sleep(POLL_INTERVAL);
            }
            is_over.store(true, Ordering::Relaxed);
        });
    }

    fn stop(&mut self, started: usize) {
        (0..started).for_each(|place| self.board.set(place, None));
        for place in (0..started).rev() {
            let (started, others) = self.all.split_at_mut(place);
            if let Some(last) = others.first_mut() {
                run_during(started, || last.stop());
            }
        }
    }
}

/// Calls `this` while the services of `started` do their periodic work, each in its own thread.
fn run_during<T>(started: &mut [Box<dyn Service>], this: impl FnOnce() -> T) -> T {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for service in started {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    service.poll_without_cycle();
                }
            });
        }
        // Also if it panics, because the scope waits for the threads.
        let _end = Over(&is_over);
        this()
    })
}

/// Sets the end flag when dropped.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Reports each problem once, and its end once.
fn look_after(service: &mut dyn Service, is_over: &AtomicBool, show: impl Fn(Health)) {
    let mut told: Vec<String> = Vec::new();
    while !is_over.load(Ordering::Relaxed) {
        let health = service.health_check();
        let (name, found) = (service.name(), &health.problems);
        for problem in found.iter().filter(|problem| !told.contains(problem)) {
            tracing::warn!("backend {name}: {problem}");
        }
        for problem in told.iter().filter(|problem| !found.contains(problem)) {
            tracing::info!("backend {name}: over: {problem}");
        }
        told.clone_from(found);
        show(health);
        std::thread::sleep(POLL_INTERVAL);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::code::Code;
    use lineshaft_ros::surface::host::GateState;
    use std::sync::atomic::AtomicUsize;

    type Diary = Arc<Mutex<Vec<String>>>;

    struct Fake {
        name: &'static str,
        /// Number of starts that fail.
        failures: usize,
        diary: Diary,
        idled: Arc<AtomicUsize>,
        /// Starting and stopping take until that service has worked for a while, or ten seconds.
        beside: Option<Arc<AtomicUsize>>,
    }

    impl Fake {
        fn take_time(&self) {
            let Some(beside) = &self.beside else { return std::thread::sleep(Duration::from_millis(20)) };
            let from = beside.load(Ordering::Relaxed);
            for _ in 0..10_000 {
                if beside.load(Ordering::Relaxed) > from + 2 {
                    break;
                }
                std::thread::sleep(Duration::from_millis(1));
            }
        }

        fn note(&self, what: &str) {
            self.diary.lock().unwrap().push(format!("{} {what}", self.name));
        }
    }

    impl Service for Fake {
        fn start(&mut self) -> Result<(), ServiceError> {
            if self.failures > 0 {
                self.failures -= 1;
                self.note("fails");
                return Err(ServiceError { backend: self.name.to_owned(), problem: "can0 is down".to_owned() });
            }
            // An absent drive takes time.
            self.take_time();
            self.note("starts");
            Ok(())
        }

        fn name(&self) -> &str {
            self.name
        }

        fn hardware(&self) -> String {
            "nothing".to_owned()
        }

        fn poll_without_cycle(&mut self) {
            self.idled.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(Duration::from_millis(1));
        }

        fn health_check(&mut self) -> Health {
            let notes = vec![Note { code: Code::NODE_CHANGED, number: 7 }];
            Health { problems: vec!["slow".to_owned()], notes, ..Health::default() }
        }

        fn stop(&mut self) {
            self.take_time();
            self.note("stops");
        }
    }

    /// A device goes into fault if its master is silent for a second.
    #[test]
    fn who_has_started_is_at_work_while_others_start_and_stop() {
        let idled = [Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0))];
        let fake = |place: usize| -> Box<dyn Service> {
            let beside = (place == 1).then(|| Arc::clone(&idled[0]));
            Box::new(Fake {
                name: "one",
                failures: 0,
                diary: Diary::default(),
                idled: Arc::clone(&idled[place]),
                beside,
            })
        };
        let mut services = Services::new(vec![fake(0), fake(1)], Arc::new(Gate::opening()));
        let count = || idled.each_ref().map(|idled| idled.load(Ordering::Relaxed));
        services.start().unwrap();
        let [first, second] = count();
        assert!(first > 2 && second == 0, "the second one starts last: {first}, {second}");
        services.stop(2);
        assert!(count()[0] > first + 2 && count()[1] == 0, "and stops first: {:?}", count());
    }

    fn until(mut holds: impl FnMut() -> bool) {
        while !holds() {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn cycles_run_between_the_last_start_and_the_first_stop() {
        let diary = Diary::default();
        let fake = |name, failures| -> Box<dyn Service> {
            Box::new(Fake { name, failures, diary: Arc::clone(&diary), idled: Arc::default(), beside: None })
        };
        let (gate, stop) = (Arc::new(Gate::opening()), Arc::new(AtomicBool::new(false)));
        let services = Services::new(vec![fake("a", 0), fake("b", 1)], Arc::clone(&gate));
        let board = services.board();
        let (of_services, of_cycles, end) = (Arc::clone(&stop), Arc::new(AtomicBool::new(false)), Arc::clone(&gate));
        let told = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&told);
        let tell = move |note| heard.lock().unwrap().push(note);
        let thread = std::thread::spawn(move || services.run(&of_services, &tell));
        // b is absent: a is stopped and nothing runs until the next request.
        until(|| gate.state() != GateState::Closed);
        assert_eq!(gate.state(), GateState::Failed("backend b: can0 is down".to_owned()));
        gate.open();
        let (cycles, written) = (Arc::clone(&of_cycles), Arc::clone(&diary));
        let cycle_thread = std::thread::spawn(move || {
            while end.wait(&cycles) {
                written.lock().unwrap().push("cycles begin".to_owned());
                until(|| !end.is_wanted() || cycles.load(Ordering::Relaxed));
                std::thread::sleep(2 * POLL_INTERVAL);
                written.lock().unwrap().push("cycles end".to_owned());
                end.set_closed();
            }
        });
        until(|| gate.state() == GateState::Open);
        until(|| board.read().iter().all(|row| row.health.as_ref().is_some_and(|health| health.problems == ["slow"])));
        gate.close();
        until(|| diary.lock().unwrap().iter().filter(|line| line.ends_with("stops")).count() == 3);
        of_cycles.store(true, Ordering::Relaxed);
        cycle_thread.join().unwrap();
        stop.store(true, Ordering::Relaxed);
        thread.join().unwrap();
        let expected = [
            "a starts",
            "b fails",
            "a stops",
            "a starts",
            "b starts",
            "cycles begin",
            "cycles end",
            "b stops",
            "a stops",
        ];
        assert_eq!(*diary.lock().unwrap(), expected);
        assert!(board.read().iter().all(|row| row.health.is_none()), "nobody looks any more");
        let told = told.lock().unwrap();
        assert!(!told.is_empty() && told.iter().all(|note| *note == Note { code: Code::NODE_CHANGED, number: 7 }));
    }
}
