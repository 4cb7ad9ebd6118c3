//! Forwards a TCP connection between the program and an adapter; the connection can be cut and restored.

use std::io;
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Interval of polling for new connections.
const LOOK: Duration = Duration::from_millis(2);

/// Forwards all data in both directions.
pub(crate) struct Proxy {
    from: SocketAddr,
    to: String,
    is_cut: Arc<AtomicBool>,
    streams: Arc<Mutex<Vec<TcpStream>>>,
    listener: Option<JoinHandle<()>>,
}

impl Proxy {
    /// Creates a proxy to this host and port.
    pub(crate) fn to(address: &str) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("loopback has a free port");
        let from = listener.local_addr().expect("it is bound");
        let mut proxy =
            Self { from, to: address.to_owned(), is_cut: Arc::default(), streams: Arc::default(), listener: None };
        proxy.listen(listener);
        proxy
    }

    /// Returns host and port of the near end.
    pub(crate) fn address(&self) -> String {
        self.from.to_string()
    }

    /// Ends existing connections and accepts no new ones.
    pub(crate) fn cut(&mut self) {
        self.is_cut.store(true, Ordering::Relaxed);
        if let Some(listener) = self.listener.take() {
            listener.join().expect("it does not panic");
        }
        for stream in self.streams.lock().expect("nobody panics with it").drain(..) {
            // The other end may have been closed.
            let _ = stream.shutdown(Shutdown::Both);
        }
    }

    /// Accepts connections again, at the same port.
    pub(crate) fn restore(&mut self) {
        self.is_cut.store(false, Ordering::Relaxed);
        self.listen(TcpListener::bind(self.from).expect("the port is still free"));
    }

    fn listen(&mut self, listener: TcpListener) {
        listener.set_nonblocking(true).expect("sockets can");
        let (is_cut, streams, to) = (Arc::clone(&self.is_cut), Arc::clone(&self.streams), self.to.clone());
        self.listener = Some(thread::spawn(move || {
            while !is_cut.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((near, _)) => join(near, &to, &streams).expect("the other side is there"),
                    Err(_) => thread::sleep(LOOK),
                }
            }
        }));
    }
}

impl Drop for Proxy {
    fn drop(&mut self) {
        self.is_cut.store(true, Ordering::Relaxed);
    }
}

/// Forwards data in both directions until one side closes.
fn join(near: TcpStream, to: &str, streams: &Mutex<Vec<TcpStream>>) -> io::Result<()> {
    let far = TcpStream::connect(to)?;
    near.set_nonblocking(false)?;
    let mut kept = streams.lock().expect("nobody panics with it");
    for (from, to) in [(near.try_clone()?, far.try_clone()?), (far.try_clone()?, near.try_clone()?)] {
        to.set_nodelay(true)?;
        kept.push(from.try_clone()?);
        thread::spawn(move || {
            let (mut from, mut to) = (from, to);
            // However one direction ends, the other one ends, too.
            let _ = io::copy(&mut from, &mut to);
            let _ = from.shutdown(Shutdown::Both);
            let _ = to.shutdown(Shutdown::Both);
        });
    }
    Ok(())
}
