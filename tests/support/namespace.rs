//! Runs one test in its own network namespace: only loopback, which also carries multicast.

use std::env;
use std::path::Path;
use std::process::Command;

/// Environment variable that marks a test inside the namespace.
const INSIDE: &str = "LINESHAFT_TEST_NAMESPACE";

/// Creates the namespace. By default loopback does not carry multicast, and a host without a route for it cannot join a
/// group.
const INTO: &str =
    "ip link set lo up && ip link set lo multicast on && ip route add 239.0.0.0/8 dev lo && exec \"$0\" \"$@\"";

/// Returns true inside the namespace. Outside, sets up the peers, because there is no external network inside, runs the
/// test with this full name inside and returns false: the test has run.
///
/// Panics if the test fails, with all its output, and if namespaces are not available, with the remedy.
#[track_caller]
pub(crate) fn is_inside(test: &str, peers: &[fn() -> &'static Path]) -> bool {
    if env::var_os(INSIDE).is_some() {
        return true;
    }
    for set_up in peers {
        set_up();
    }
    let mut unshare = Command::new("unshare");
    if !rustix::process::geteuid().is_root() {
        unshare.arg("--map-root-user");
    }
    let program = env::current_exe().expect("the system knows what runs");
    unshare.args(["--net", "sh", "-c", INTO]).arg(program).args(["--exact", test, "--nocapture"]).env(INSIDE, "1");
    let output =
        unshare.output().unwrap_or_else(|error| panic!("the tests need unshare (Debian: util-linux): {error}"));
    let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "{test} fails in a network namespace; where none can be made, run it as root or allow user namespaces (sysctl \
         kernel.unprivileged_userns_clone=1), and install iproute2:\n{text}"
    );
    assert!(text.contains("1 passed"), "there is no test {test}:\n{text}");
    false
}
