//! The ROS side: the process that alone knows the DDS library.
//!
//! It executes the orders of the program (`link/protocol`) and knows neither messages nor axes. A fault of the library ends with this
//! process, whose memory is limited; the program then starts another one.
//!
//! `dds` is the only file that imports the library. docs/dds-library.md lists what the library (0.15.1) cannot do, and the files that
//! work around it.

mod acknowledge;
mod age;
mod dds;
mod dispose;
mod graph;
mod keeper;
mod latched;
mod lines;
mod listeners;
mod long_reply;
mod matches;
mod member;
mod preemptive;
mod presence;
mod probe;
mod replies;
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

pub(crate) use dds::NOISE;

/// Memory that the process may fill (bytes): requests that the DDS library keeps take it, 256 of each topic.
const MEMORY: u64 = 2 << 30;
/// How long the DDS library may take for its good-bye.
const GOOD_BYE: Duration = Duration::from_secs(1);

/// The process: standard input is its end of the link.
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
    // Where the system refuses it, the probes are left.
    let _ = setrlimit(Resource::Data, Rlimit { current: Some(MEMORY), maximum: Some(MEMORY) });
    let (reports, queue) = channel();
    lines::start(reports.clone());
    run(stream, reports, queue, true);
    ExitCode::SUCCESS
}

/// Likewise, on this thread.
pub(crate) fn serve(stream: UnixStream) {
    let (reports, queue) = channel();
    run(stream, reports, queue, false);
}

/// Works until the link ends. `is_process`: the process ends then, too.
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
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_io().enable_time().build();
    let Ok(runtime) = runtime else { return };
    follow(stream, &reports, runtime.handle(), is_process);
    // A reply that still looks for its reader finds none any more.
    runtime.shutdown_background();
}

/// Does one order after the other.
fn follow(mut stream: UnixStream, reports: &Sender<Report>, runtime: &tokio::runtime::Handle, is_process: bool) {
    let mut buffer = Vec::new();
    let Ok(Order::Join(join)) = frame::read(&mut stream, &mut buffer) else { return };
    dispose::dispose_all(&join.dead);
    let mut member = match Member::join(&join, reports.clone(), runtime.clone()) {
        Ok(member) => member,
        Err(error) => {
            // Without a program there is nobody to tell.
            let _ = reports.send(Report::Failed(error));
            // It must have gone out before the link ends.
            let _ = frame::read::<Order>(&mut stream, &mut buffer);
            return;
        }
    };
    while let Ok(order) = frame::read(&mut stream, &mut buffer) {
        member.follow(order);
    }
    if member.is_replaced() {
        // A client may be sending a request at this moment: it is still read, and the successor replies.
        dispose::dispose_repeatedly(&member.departed());
        if is_process {
            // The library would announce itself to new clients while it leaves.
            std::mem::forget(member);
            return;
        }
    }
    leave(member);
}

/// Says good-bye, also where the library does not: a thread of it that hangs would keep the process.
fn leave(member: Member) {
    let departed = member.departed();
    let (done, is_done) = channel();
    let leaving = std::thread::Builder::new().name("ros leave".to_owned()).spawn(move || {
        drop(member);
        // Nobody waits any more.
        let _ = done.send(());
    });
    if leaving.is_ok() {
        // Late or not: what follows holds in both cases.
        let _ = is_done.recv_timeout(GOOD_BYE);
    }
    // Datagrams get lost: once more.
    dispose::dispose(&departed);
}
