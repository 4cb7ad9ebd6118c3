//! Tests the set-up of the end-to-end tests itself: the peers can be installed, and they discover each other on
//! loopback.

use std::process::Command;

use crate::support::{
    domain::Domain,
    peer::Peer,
    setup::{fastdds_peer, python},
};

#[test]
fn the_python_environment_has_cyclone_dds() {
    let output = Command::new(python()).args(["-c", "import cyclonedds.domain; print('works')"]).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), "works\n", "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_fast_dds_peer_explains_itself() {
    let output = Command::new(fastdds_peer()).arg("--help").output().unwrap();
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("usage: fastdds_peer COMMAND"));
}

#[test]
fn tests_never_share_a_domain() {
    let taken: Vec<_> = (0..20).map(|_| Domain::take()).collect();
    let mut ids: Vec<_> = taken.iter().map(ToString::to_string).collect();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), taken.len());
}

#[test]
fn both_peers_see_the_joint_states_of_a_third() {
    let domain = Domain::take();
    let mut talker = Peer::cyclone(&domain);
    let listeners = [Peer::cyclone(&domain), Peer::fastdds(&domain)];
    talker.tell("talk --seconds 60"); // the end of the test ends it
    for mut listener in listeners {
        let seen = listener.run("joint-states --count 20 --seconds 20");
        assert_eq!(seen["received"], 20);
        assert_eq!(seen["last"]["name"][0], "peer");
        assert_eq!(seen["last"]["position"][0], 1.5);
    }
}

#[test]
fn the_peers_refuse_what_they_do_not_know() {
    let domain = Domain::take();
    for mut peer in [Peer::cyclone(&domain), Peer::fastdds(&domain)] {
        let error = peer.fails("dance /lineshaft");
        assert!(error.contains("dance"), "{error}");
    }
}
