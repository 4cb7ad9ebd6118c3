#!/usr/bin/env bash
# Real CAN sockets: a kernel of its own (user-mode Linux, an ordinary process) has virtual CAN interfaces, which the kernel of a build
# machine seldom has. In it run the simulated drives on vcan0 and the tests that are ignored elsewhere.
# Exit status: 0 passed, 77 not tested, anything else failed.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$(cargo metadata --format-version 1 --no-deps --locked | python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
uml=$target/uml

not_tested() { echo "socketcan: not tested: $*" >&2; exit 77; }
fail() { echo "socketcan: $*" >&2; exit 1; }

[[ $uml != *[[:space:]]* ]] || not_tested "the kernel takes no path with blanks: $uml"
[ "$(uname -m)" = x86_64 ] || not_tested "user-mode Linux is for x86_64"
command -v ip >/dev/null && command -v tc >/dev/null || not_tested "ip and tc are not installed (Debian: apt-get install iproute2)"

# The packages are unpacked and not installed. Package lists that are missing or too old are renewed where that is allowed.
kernel=(user-mode-linux busybox-static)
if ! [ -e "$uml/image/complete" ]; then
    rm -rf "$uml"; mkdir -p "$uml/debs" "$uml/image"
    fetch() { (cd "$uml/debs" && apt-get -qq download "${kernel[@]}" >/dev/null 2>&1); }
    fetch || { apt-get -qq update >/dev/null 2>&1 && fetch; } ||
        not_tested "the packages ${kernel[*]} cannot be downloaded (Debian: apt-get update as root, with a network)"
    for deb in "$uml"/debs/*.deb; do dpkg -x "$deb" "$uml/image" || fail "$deb cannot be unpacked"; done
    touch "$uml/image/complete"
fi

# Built here, and the Python environment made, by a test that needs no CAN: the kernel in there has no network.
# The whole workspace, as `cargo test --workspace` has built it: for a single package cargo chooses other features and builds again.
built=$(cargo test --workspace --locked --no-run --message-format=json)
binary() { # binary FILE
    printf '%s\n' "$built" | python3 -c 'import json, sys; print(*[m["executable"] for m in map(json.loads, sys.stdin) if m.get("executable") and m["profile"]["test"] and m["target"]["src_path"].endswith("/" + sys.argv[1])])' "$1"
}
drives=$(binary tests/end_to_end.rs)
sockets=$(binary can/src/lib.rs)
memory=$(binary can/tests/no_alloc.rs)
"$drives" --quiet --exact can_transports::drives_are_reached_over_slcan_behind_tcp >"$uml/log" 2>&1 || { cat "$uml/log" >&2; fail "the drives do not run outside, either"; }

modules=$(echo "$uml"/image/usr/lib/uml/modules/*/kernel)
mkdir -p "$uml/tmp"; rm -f "$uml/status"
cat >"$uml/init.sh" <<INIT
#!/bin/sh
[ \$\$ = 1 ] || exit 1 # for that kernel alone
export PATH=$PATH TMPDIR=$uml/tmp HOME=$uml/tmp PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-20261122}
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devpts devpts /dev/pts 2>/dev/null
run() {
    set -e
    for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan net/sched/sch_netem; do
        $uml/image/bin/busybox insmod $modules/\$module.ko
    done
    ip link set lo up; ip link add vcan0 type vcan; ip link set vcan0 up
    $sockets --ignored
    $memory --ignored
    $drives --ignored vcan
}
(run) >$uml/log 2>&1
echo \$? >$uml/status
sync
$uml/image/bin/busybox poweroff -f
INIT
chmod +x "$uml/init.sh"
# It writes nothing outside the target folder. Its own status does not say how the tests ended: a file does.
TMPDIR=$uml/tmp timeout -k 10 300 "$uml/image/usr/bin/linux.uml" mem=512M rootfstype=hostfs rootflags=/ rw init="$uml/init.sh" uml_dir="$uml/tmp" \
    con=null con0=fd:0,fd:1 con1=null quiet </dev/null >"$uml/console" 2>&1 || true
[ -e "$uml/status" ] || { tail -n 30 "$uml/console" >&2; fail "the kernel has not come to the end of the tests in 300 s"; }
cat "$uml/log"
[ "$(cat "$uml/status")" = 0 ] || fail "the tests on CAN interfaces fail, as shown above"
