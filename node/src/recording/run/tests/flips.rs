//! Files in which bytes were changed.

use super::super::{Damage, Run, RunError};
use super::{disk, every_form, read, small};
use proptest::prelude::*;
use std::fs::OpenOptions;
use std::os::unix::fs::FileExt;

/// Whatever byte of a finished file is changed: an error, or a cut, or the messages that were written. Only what stands in
/// no chunk may be read wrong, or a chunk be taken for another record, and then the checksum of all data says so in the end.
#[test]
fn a_changed_byte_is_noticed_or_changes_no_message() {
    for (options, is_chunked) in every_form().into_iter().zip([true, true, false]) {
        let bytes = small(options);
        // The record of the data's end is of 13 bytes; the checksum covers what stands before it.
        let covered = mcap::read::footer(&bytes).unwrap().summary_start - 13;
        let disk = disk(&bytes);
        let all = read(&disk.path).0;
        let file = OpenOptions::new().write(true).open(&disk.path).unwrap();
        for at in 0..bytes.len() {
            for change in [0x01, 0x10, 0x80, 0xff] {
                file.write_all_at(&[bytes[at] ^ change], at as u64).unwrap();
                let (messages, error) = read(&disk.path);
                let is_late = matches!(&error, Some(RunError::Damaged { damage: Damage::FileCrc { .. }, .. }));
                if !is_late {
                    assert!(all.starts_with(&messages), "byte {at}: {error:?}");
                } else if is_chunked {
                    assert!(messages.iter().all(|message| all.contains(message)), "byte {at}: {error:?}");
                }
                if error.is_none() {
                    let is_cut = Run::open(&disk.path).unwrap().cuts().count() > 0;
                    assert!(at as u64 >= covered || is_cut, "byte {at} of {} was not noticed", bytes.len());
                    assert!(messages.len() == all.len() || is_cut, "byte {at}");
                }
            }
            file.write_all_at(&[bytes[at]], at as u64).unwrap();
        }
    }
}

#[test]
fn a_chunk_with_a_wrong_checksum_is_refused_with_its_place() {
    let bytes = small(crate::recording::test_bags::options().compression(None));
    let place = bytes.windows(9).rposition(|window| window == b"message 5").unwrap();
    let mut changed = bytes;
    changed[place] ^= 0x20;
    let disk = disk(&changed);
    let (messages, error) = read(&disk.path);
    // The first chunk has four messages, the second one the changed one.
    assert_eq!(messages.len(), 4);
    let Some(RunError::Damaged { at, damage, .. }) = error else { panic!("{error:?}") };
    assert!(changed[at as usize] == mcap::records::op::CHUNK && (at as usize) < place);
    assert!(damage.to_string().starts_with("the content of this chunk has the checksum "), "{damage}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn many_changed_bytes_never_panic(
        form in 0..3_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
        length in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let mut bytes = small(every_form()[form].clone());
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if is_cut {
            bytes.truncate(length.index(bytes.len()));
        }
        let disk = disk(&bytes);
        let _ = read(&disk.path);
        if let Ok(run) = Run::open(&disk.path) {
            let _ = run.attachment("cell.yaml");
        }
    }

    #[test]
    fn anything_behind_the_mark_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let disk = disk(&[mcap::MAGIC, &bytes].concat());
        let _ = read(&disk.path);
    }
}
