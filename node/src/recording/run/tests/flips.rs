//! Tests files with changed bytes.

use super::super::{Damage, Run, RunError};
use super::{disk, every_form, read, small};
use proptest::prelude::*;
use std::fs::OpenOptions;
use std::os::unix::fs::FileExt;

/// Changing any byte of a finished file gives an error, a cut, or the original messages. The exceptions are records
/// outside of chunks, and a chunk that is read as another record; the checksum of all data then reports an error at the
/// end.
#[test]
fn a_changed_byte_is_noticed_or_changes_no_message() {
    for (options, is_chunked) in every_form().into_iter().zip([true, true, false]) {
        let bytes = small(options);
        // The record that ends the data has 13 bytes; the checksum covers the bytes before it.
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
                    let run = Run::open(&disk.path).unwrap();
                    let is_cut = run.cuts().count() > 0;
                    let is_told = is_cut || run.flaws().count() > 0;
                    assert!(is_told, "byte {at} of {} was not noticed", bytes.len());
                    assert!(at as u64 >= covered || is_cut, "byte {at} is no matter of the index");
                    assert!(messages.len() == all.len() || is_cut, "byte {at}");
                }
            }
            file.write_all_at(&[bytes[at]], at as u64).unwrap();
        }
    }
}

/// Damage after the data affects no message but is still reported.
#[test]
fn damaged_index_and_trailing_bytes_are_reported() {
    let bytes = small(crate::recording::test_bags::options());
    let flaws = |bytes: &[u8]| {
        let disk = disk(bytes);
        let run = Run::open(&disk.path).unwrap();
        let cuts = run.cuts().count();
        let flaws: Vec<String> = run.flaws().map(|flaw| flaw.to_string()).collect();
        assert_eq!(read(&disk.path).0.len(), 12, "every message is read");
        (cuts, flaws)
    };
    assert_eq!(flaws(&bytes), (0, Vec::new()));
    let start = mcap::read::footer(&bytes).unwrap().summary_start as usize;
    let mut changed = bytes.clone();
    // The first record of the index keeps its kind and its length.
    changed[start + 20] ^= 0x5a;
    let (cuts, told) = flaws(&changed);
    assert!(cuts == 0 && told.len() == 1 && told[0].contains(": the index from here on has the checksum "), "{told:?}");
    for (more, text) in [(&b"junk"[..], "4".to_owned()), (&bytes, super::super::grouped(bytes.len() as u64))] {
        let (cuts, told) = flaws(&[&bytes, more].concat());
        let end = format!(": {text} bytes follow the end of the recording, they are not read");
        assert!(cuts == 0 && told.len() == 1 && told[0].ends_with(&end), "{told:?}");
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
    // The first chunk has four messages, the second one has the changed message.
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
