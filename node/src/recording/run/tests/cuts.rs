//! Tests files that were cut off.

use super::super::{Reason, Run};
use super::{Read, disk, every_form, read, read_all, small};
use crate::recording::test_bags::{TestBag, options};
use lineshaft_msgs::foreign::std_msgs::msg::String as Text;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use proptest::prelude::*;
use std::fs::OpenOptions;

/// Returns the end offset of each record of a complete file, and the number of messages before it, read with the crate
/// `mcap`.
fn ends(bytes: &[u8]) -> Vec<(u64, usize)> {
    let mut reader = LinearReader::new_with_options(LinearReaderOptions::default().with_emit_chunks(true));
    let (mut given, mut at, mut messages, mut ends) = (0, 8, 0, Vec::new());
    while let Some(event) = reader.next_event() {
        match event.unwrap() {
            LinearReadEvent::ReadRequest(length) => {
                let length = length.min(bytes.len() - given);
                reader.insert(length).copy_from_slice(&bytes[given..given + length]);
                reader.notify_read(length);
                given += length;
            }
            LinearReadEvent::Record { data, opcode } => {
                at += 9 + data.len() as u64;
                match mcap::parse_record(opcode, data).unwrap() {
                    mcap::records::Record::Message { .. } => messages += 1,
                    mcap::records::Record::Chunk { header, data } => {
                        let records = mcap::read::ChunkReader::new(header, &data).unwrap();
                        let records = records.map(Result::unwrap);
                        messages +=
                            records.filter(|record| matches!(record, mcap::records::Record::Message { .. })).count();
                    }
                    _ => {}
                }
                ends.push((at, messages));
            }
        }
    }
    ends
}

/// Checks the messages read from the first `length` bytes of a file whose complete records end at `ends`.
#[track_caller]
fn check_cut(length: u64, run: Run, ends: &[(u64, usize)], all: &[Read], data_end: u64) {
    let whole = ends.iter().rev().find(|(end, _)| *end <= length.min(data_end));
    let (end, count) = whole.copied().unwrap_or((0, 0));
    let cut = run.cuts().next().cloned();
    let (messages, error) = read_all(run);
    assert!(error.is_none(), "cut at {length}: {error:?}");
    assert_eq!(messages, all[..count], "cut at {length}");
    let cut = cut.unwrap_or_else(|| panic!("cut at {length}: not noticed"));
    // Without any record, the magic bytes may have been read.
    let read = if end == 0 { cut.read_bytes.min(8) } else { end };
    assert_eq!((cut.read_bytes, cut.file_bytes), (read, length), "{cut}");
    assert_eq!(cut.reason == Reason::Index, length >= data_end, "{cut}");
}

#[test]
fn a_small_file_is_read_to_its_last_whole_record_wherever_it_is_cut() {
    for options in every_form() {
        let bytes = small(options);
        let (ends, data_end) = (ends(&bytes), data_end(&bytes));
        let disk = disk(&bytes);
        let (all, error) = read(&disk.path);
        assert!(error.is_none() && all.len() == 12);
        let file = OpenOptions::new().write(true).open(&disk.path).unwrap();
        for length in (0..bytes.len() as u64).rev() {
            file.set_len(length).unwrap();
            check_cut(length, Run::open(&disk.path).unwrap(), &ends, &all, data_end);
        }
    }
}

/// Returns the offset after the record that ends the data.
fn data_end(bytes: &[u8]) -> u64 {
    let footer = mcap::read::footer(bytes).unwrap();
    footer.summary_start
}

/// Returns a file of many chunks with incompressible content.
fn large() -> Vec<u8> {
    let mut bag = TestBag::with(options().chunk_size(Some(4096)));
    let mut state = 1_u64;
    for time in 0..3000_u64 {
        let letters = (0..20).map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            char::from(b'a' + (state >> 33) as u8 % 26)
        });
        bag.message(["/a", "/b"][time as usize % 2], time, &Text { data: letters.collect() });
    }
    bag.finish()
}

#[test]
fn a_larger_file_is_read_to_its_last_whole_chunk_at_random_cuts() {
    let bytes = large();
    let (ends, data_end) = (ends(&bytes), data_end(&bytes));
    let all = read(&disk(&bytes).path).0;
    assert_eq!(all.len(), 3000);
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(300));
    let result = runner.run(&(0..bytes.len()), |length| {
        let disk = disk(&bytes[..length]);
        check_cut(length as u64, Run::open(&disk.path).unwrap(), &ends, &all, data_end);
        Ok(())
    });
    result.unwrap();
}

#[test]
fn zeros_at_the_end_are_a_cut() {
    let bytes = small(options());
    let ends = ends(&bytes);
    let (end, count) = *ends.iter().find(|(_, messages)| *messages == 8).unwrap();
    for zeros in [1, 8, 9, 20_000] {
        let mut torn = bytes[..end as usize].to_vec();
        torn.resize(torn.len() + zeros, 0);
        let disk = disk(&torn);
        let run = Run::open(&disk.path).unwrap();
        let cut = run.cuts().next().unwrap().clone();
        assert_eq!((cut.reason, cut.read_bytes), (Reason::Zeros, end));
        assert_eq!(read_all(run).0.len(), count);
    }
}

#[test]
fn the_sentence_of_a_cut_names_file_and_bytes() {
    let bytes = small(options());
    let disk = disk(&bytes[..bytes.len() - 1]);
    let run = Run::open(&disk.path).unwrap();
    let cut = run.cuts().next().unwrap().to_string();
    assert!(cut.contains("run.mcap: the file ends within its index, behind all messages; "), "{cut}");
    let chunk = ends(&bytes).iter().find(|(_, messages)| *messages == 4).unwrap().0;
    std::fs::write(&disk.path, &bytes[..chunk as usize - 1]).unwrap();
    let run = Run::open(&disk.path).unwrap();
    let cut = run.cuts().next().unwrap().to_string();
    assert!(cut.contains("run.mcap: the file ends within a chunk; "), "{cut}");
    std::fs::write(&disk.path, &bytes[..chunk as usize]).unwrap();
    let run = Run::open(&disk.path).unwrap();
    let cut = run.cuts().next().unwrap().to_string();
    assert!(cut.contains("run.mcap: the file ends without a record of its end; "), "{cut}");
    std::fs::write(&disk.path, b"").unwrap();
    let run = Run::open(&disk.path).unwrap();
    let cut = run.cuts().next().unwrap().to_string();
    assert!(cut.ends_with("run.mcap: the file ends before its first record; 0 of 0 bytes were read"), "{cut}");
}
