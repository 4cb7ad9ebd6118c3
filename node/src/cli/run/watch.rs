//! Supervises the surface.
//!
//! Law      about 20 times per second a task runs through the runtime of the surface and takes the locks that every
//!          request takes. If no task finishes for `loss_timeout`, the surface is silent; after 10 s it is lost. Time
//!          in which its threads or this one had no processor does not count

use lineshaft_ros::silence::{Check, Silence, Threads};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::runtime::Handle;

/// Name of the threads of the surface.
pub(super) const SURFACE: &str = "surface";
/// Time between two tasks.
const PULSES: Duration = Duration::from_millis(50);

/// Times without a finished task after which the machine reacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timeouts {
    pub(super) silent: Duration,
    pub(super) lost: Duration,
}

impl Timeouts {
    pub(super) fn until(silent: Duration) -> Self {
        Self { silent, lost: Duration::from_secs(10) }
    }
}

/// Change of state of a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// No task has finished for half of the time: duration, and what its threads do.
    Overdue(String),
    /// No task has finished for this time.
    Silent(Duration),
    /// Tasks finish again.
    Back,
    /// No task will ever finish; supervision has ended.
    Lost,
}

/// Supervision of a surface until it is dropped.
pub(super) struct Watch {
    is_closed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Starts supervision: `pulse` runs as a task of `runtime`, `tell` in a separate thread.
    ///
    /// # Errors
    /// Returns an error if no thread can be created.
    pub(super) fn start(
        runtime: Handle,
        patience: Timeouts,
        pulse: impl Fn() + Send + Sync + 'static,
        tell: impl Fn(Change) + Send + 'static,
    ) -> std::io::Result<Self> {
        let is_closed = Arc::<AtomicBool>::default();
        let closed = Arc::clone(&is_closed);
        let watch = move || watch(&runtime, patience, &Arc::new(pulse), &closed, &tell);
        let thread = Some(std::thread::Builder::new().name("surface watch".to_owned()).spawn(watch)?);
        Ok(Self { is_closed, thread })
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has ended, too.
            let _ = thread.join();
        }
    }
}

fn watch(
    runtime: &Handle,
    patience: Timeouts,
    pulse: &Arc<impl Fn() + Send + Sync + 'static>,
    is_closed: &AtomicBool,
    tell: &impl Fn(Change),
) {
    let (mut sent, came) = (0, Arc::<AtomicU64>::default());
    let (mut silence, mut is_silent) = (Silence::new(Threads::Own(SURFACE), patience.silent, PULSES), false);
    while !is_closed.load(Ordering::Acquire) {
        let check = silence.check();
        if came.load(Ordering::Acquire) == sent {
            silence.answered();
            if std::mem::take(&mut is_silent) {
                tell(Change::Back);
            }
            sent += 1;
            let (pulse, came) = (Arc::clone(pulse), Arc::clone(&came));
            runtime.spawn(async move {
                pulse();
                came.fetch_add(1, Ordering::Release);
            });
        } else if silence.since() > patience.lost {
            return tell(Change::Lost);
        } else if check == Check::Silent && !is_silent {
            is_silent = true;
            tell(Change::Silent(silence.since()));
        } else if let Check::Overdue(doing) = check {
            tell(Change::Overdue(doing));
        }
        std::thread::sleep(PULSES);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::mpsc::channel;

    #[test]
    fn a_surface_that_hangs_is_silent_then_back_or_lost() {
        let runtime =
            tokio::runtime::Builder::new_multi_thread().worker_threads(1).thread_name(SURFACE).build().unwrap();
        let patience = Timeouts { silent: Duration::from_millis(700), lost: Duration::from_secs(2) };
        let (taken_by_all, (told, changes)) = (Arc::<Mutex<()>>::default(), channel());
        let taken = Arc::clone(&taken_by_all);
        let pulse = move || drop(taken.lock());
        let watch = Watch::start(runtime.handle().clone(), patience, pulse, move |change| told.send(change).unwrap());
        let held = taken_by_all.lock().unwrap();
        let silent = || {
            let Ok(Change::Overdue(doing)) = changes.recv() else { panic!("overdue first") };
            assert!(doing.contains("`surface` waits"), "{doing}");
            let Ok(Change::Silent(time)) = changes.recv() else { panic!("silent") };
            assert!(time >= patience.silent, "{time:?}");
        };
        silent();
        drop(held);
        assert_eq!(changes.recv(), Ok(Change::Back));
        let held = taken_by_all.lock().unwrap();
        silent();
        assert_eq!(changes.recv(), Ok(Change::Lost));
        assert!(changes.recv().is_err(), "it watches no more");
        drop((held, watch));
    }
}
