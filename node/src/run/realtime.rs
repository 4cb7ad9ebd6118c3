//! Requests real-time scheduling and locked memory from the operating system.

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, getrlimit};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// Priority of the cycle thread under SCHED_FIFO, 1 to 99: above usual real-time threads, below those of the kernel.
const PRIORITY: u8 = 80;

/// Processor of the cycle thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Processor {
    /// Last processor that the process may use.
    #[default]
    Last,
    /// Any processor.
    Any,
    /// Processor with this number.
    Number(usize),
}

/// Requests real-time scheduling of the calling thread and locked memory; returns the requests that were not granted,
/// each as part of a sentence.
pub fn claim(processor: Processor) -> Vec<String> {
    let mut refused = Vec::new();
    if let Err(error) = lock_memory() {
        refused.push(format!("memory is not locked ({error})"));
    }
    if let Err(error) = pin(processor) {
        refused.push(format!("no processor of its own ({error})"));
    }
    if let Err(error) = claim_fifo() {
        refused.push(format!("no SCHED_FIFO ({error})"));
    }
    refused
}

fn claim_fifo() -> Result<(), String> {
    let priority = PRIORITY.try_into().map(ThreadPriority::Crossplatform)?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), priority, policy).map_err(|error| match error {
        thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(code).to_string(),
        other => other.to_string(),
    })
}

fn lock_memory() -> Result<(), String> {
    // With a limit, later allocations would fail instead of only not being locked.
    if getrlimit(Resource::Memlock).current.is_some() {
        return Err("the limit of locked memory is not `unlimited`".to_owned());
    }
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| error.to_string())
}

fn pin(processor: Processor) -> Result<(), String> {
    let allowed = sched_getaffinity(None).map_err(|error| error.to_string())?;
    let wanted = match processor {
        Processor::Any => return Ok(()),
        Processor::Number(number) if number < CpuSet::MAX_CPU && allowed.is_set(number) => number,
        Processor::Number(number) => return Err(format!("processor {number} is not among those of this process")),
        Processor::Last => (0..CpuSet::MAX_CPU).rev().find(|&cpu| allowed.is_set(cpu)).unwrap_or(0),
    };
    let mut set = CpuSet::new();
    set.set(wanted);
    sched_setaffinity(None, &set).map_err(|error| error.to_string())
}
