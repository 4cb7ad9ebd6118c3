//! The ROS side: the only process that uses the DDS library.
//!
//! It executes the orders of the program (`link/protocol`) and is independent of message types and axes. A fault of the library ends with
//! this process, whose memory is limited; the program then starts another one.
//!
//! It alone knows the middleware, DDS: `dds_names` maps names and types of ROS to it, and `requests` recognizes the RMW of a client.
//! `dds` is the only file that imports the library. docs/dds-library.md lists what the library (0.15.1) cannot do, and the files that work
//! around it.

mod acknowledge;
mod age;
mod dds;
mod dds_names;
mod dispose;
mod graph;
mod guid;
mod hashes;
mod keeper;
mod latched;
mod library_lines;
mod lines;
mod listeners;
mod long_reply;
mod matches;
mod member;
mod ports;
mod preemptive;
mod presence;
mod probe;
mod replies;
mod requests;
mod returning;
mod rtps;
mod sedp;
mod socket;
mod spdp;

use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use rustix::process::{Resource, Rlimit, setrlimit};

use crate::link::frame;
use crate::link::protocol::{Order, Report};
use member::Member;

pub use library_lines::log_filter;
#[cfg(any(test, feature = "fuzz"))]
pub use requests::any_request;

/// Memory limit of the process in bytes. Requests that the DDS library keeps need memory: 256 for each topic.
const MEMORY: u64 = 2 << 30;
/// Maximum time for which the DDS library may leave the domain.
const GOOD_BYE: Duration = Duration::from_secs(1);

/// Runs the process. Its standard input is its end of the link.
pub fn main() -> ExitCode {
    let stream = match std::io::stdin().as_fd().try_clone_to_owned() {
        Ok(stream) => UnixStream::from(stream),
        Err(error) => {
            eprintln!("lineshaft ros-side: no standard input: {error}");
            return ExitCode::from(2);
        }
    };
    if stream.peer_addr().is_err() {
        eprintln!("lineshaft ros-side: it is started by lineshaft itself, with a link as its standard input");
        return ExitCode::from(2);
    }
    // If the system refuses the limit, the probes still detect a fault.
    let _ = setrlimit(Resource::Data, Rlimit { current: Some(MEMORY), maximum: Some(MEMORY) });
    let (reports, queue) = channel();
    lines::start(reports.clone());
    run(stream, reports, queue, true);
    ExitCode::SUCCESS
}

/// Runs a ROS side on this thread.
pub(crate) fn serve(stream: UnixStream) {
    let (reports, queue) = channel();
    run(stream, reports, queue, false);
}

/// Runs until the link ends. `is_process`: whether the process ends then, too.
fn run(stream: UnixStream, reports: Sender<Report>, queue: Receiver<Report>, is_process: bool) {
    let Ok(mut writing) = stream.try_clone() else { return };
    let writer = std::thread::Builder::new().name("ros reports".to_owned()).spawn(move || {
        while let Ok(report) = queue.recv() {
            if frame::write(&mut writing, &report).is_err() {
                return;
            }
        }
    });
    if writer.is_err() {
        return;
    }
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(1)
        .thread_name("side")
        .enable_io()
        .enable_time()
        .build();
    let Ok(runtime) = runtime else { return };
    follow(stream, &reports, runtime.handle(), is_process);
    // Replies that still wait for their readers are dropped.
    runtime.shutdown_background();
}

/// Executes the orders in sequence.
fn follow(mut stream: UnixStream, reports: &Sender<Report>, runtime: &tokio::runtime::Handle, is_process: bool) {
    let mut buffer = Vec::new();
    let Ok(Order::Join(join)) = frame::read(&mut stream, &mut buffer) else { return };
    dispose::dispose_all(&join.dead);
    let mut member = match Member::join(&join, reports.clone(), runtime.clone()) {
        Ok(member) => member,
        Err(error) => {
            // Fails if the program has ended.
            let _ = reports.send(Report::Failed(error));
            // The report must be sent before the link ends.
            let _ = frame::read::<Order>(&mut stream, &mut buffer);
            return;
        }
    };
    while let Ok(order) = frame::read(&mut stream, &mut buffer) {
        member.follow(order);
    }
    if member.is_replaced() {
        // A client may send a request at this moment. The request is still read, and the successor replies.
        dispose::dispose_repeatedly(&member.departed());
        if is_process {
            // Otherwise the library would announce itself to new clients while it leaves.
            std::mem::forget(member);
            return;
        }
    }
    leave(member);
}

/// Leaves the domain and disposes the participant, even if the library hangs: a hanging thread of it would keep the process running.
fn leave(member: Member) {
    let departed = member.departed();
    let (done, is_done) = channel();
    let leaving = std::thread::Builder::new().name("ros leave".to_owned()).spawn(move || {
        drop(member);
        // Fails if the wait has timed out.
        let _ = done.send(());
    });
    if leaving.is_ok() {
        // A timeout makes no difference for the next step.
        let _ = is_done.recv_timeout(GOOD_BYE);
    }
    // Once more, because datagrams get lost.
    dispose::dispose(&departed);
}

#[cfg(test)]
mod tests;
