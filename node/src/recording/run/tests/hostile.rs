//! Tests files with wrong lengths and sizes.

use super::super::Run;
use super::{disk, read, refused, text};
use crate::recording::test_bags::{TestBag, options};
use mcap::records::op;
use proptest::prelude::*;
use std::io::Write;

/// Returns a record with any value as its length.
fn record(kind: u8, claimed: u64, body: &[u8]) -> Vec<u8> {
    [&[kind][..], &claimed.to_le_bytes(), body].concat()
}

/// Returns a file that looks finished.
fn file(records: &[Vec<u8>]) -> Vec<u8> {
    let header = record(op::HEADER, 8, &[0; 8]);
    let end = [record(op::DATA_END, 4, &[0; 4]), mcap::MAGIC.to_vec()].concat();
    [mcap::MAGIC, &header, &records.concat(), &end].concat()
}

fn whole(kind: u8, body: &[u8]) -> Vec<u8> {
    record(kind, body.len() as u64, body)
}

fn chunk(size: u64, compression: &str, content: &[u8]) -> Vec<u8> {
    let length = (compression.len() as u32).to_le_bytes();
    let parts: [&[u8]; 7] = [
        &[0; 16],
        &size.to_le_bytes(),
        &[0; 4],
        &length,
        compression.as_bytes(),
        &(content.len() as u64).to_le_bytes(),
        content,
    ];
    whole(op::CHUNK, &parts.concat())
}

#[test]
fn lengths_beyond_the_file_are_refused_without_taking_memory() {
    let cases = [
        (record(op::CHUNK, u64::MAX, &[]), "this record claims 18 446 744 073 709 551 615 bytes, 21 are left"),
        (record(op::METADATA, 1 << 40, &[]), "this record claims 1 099 511 627 776 bytes"),
        (whole(op::CHUNK, &[0xff; 60]), "the fields of this record do not fit into it"),
        (whole(op::ATTACHMENT, &[0xff; 60]), "the fields of this record do not fit into it"),
        (whole(op::METADATA, &[0xff; 60]), "the fields of this record do not fit into it"),
        (whole(op::SCHEMA, &[0xff; 60]), "the fields of this record do not fit into it"),
        (whole(op::CHANNEL, &[0xff; 3]), "the fields of this record do not fit into it"),
        (whole(op::MESSAGE, &[0xff; 3]), "the fields of this record do not fit into it"),
        (whole(op::MESSAGE, &[0xff; 30]), "a message is of channel 65535, which no record describes"),
        (whole(0x42, &[]), "no record begins with 0x42"),
        (whole(op::FOOTER, &[0; 20]), "the index begins before a record of the data's end"),
        (chunk(u64::MAX, "", &[]), "the content of this chunk would take 18 446 744 073 709 551 615 bytes, at most"),
        (chunk(10, "", &[1; 9]), "the content of this chunk is 9 bytes, 10 are announced"),
        (chunk(10, "bz2", &[1; 9]), "this chunk is compressed with `bz2`; zstd, lz4 or none is read"),
        (chunk(10, "lz4", &[1; 9]), "the content of this chunk does not decompress: "),
        (chunk(10, "zstd", &[1; 9]), "the content of this chunk does not decompress: "),
        (chunk(3, "", &[op::MESSAGE, 1, 1]), "the records within this chunk do not fit into it"),
        (chunk(9, "", &record(op::MESSAGE, u64::MAX, &[])), "the records within this chunk do not fit into it"),
        (chunk(9, "", &record(op::CHUNK, 0, &[])), "the records within this chunk do not fit into it"),
    ];
    for (record, sentence) in cases {
        let disk = disk(&file(&[record]));
        let said = refused(&disk.path);
        assert!(said.starts_with("run.mcap, byte 25: ") && said.contains(sentence), "{said}");
    }
    let disk = disk(&[mcap::MAGIC, &whole(op::DATA_END, &[0; 4]), mcap::MAGIC].concat());
    assert_eq!(refused(&disk.path), "run.mcap, byte 8: a header is expected as first record");
}

#[test]
fn a_chunk_that_unpacks_to_more_than_it_announces_is_refused() {
    let packed = zstd::bulk::compress(&[0; 1 << 20], 3).unwrap();
    assert!(packed.len() < 1000);
    let disk = disk(&file(&[chunk(64, "zstd", &packed)]));
    let said = refused(&disk.path);
    assert!(said.contains("the content of this chunk does not decompress: "), "{said}");
    std::fs::write(&disk.path, file(&[chunk(64, "lz4", &lz4(&[0; 1 << 20]))])).unwrap();
    let said = refused(&disk.path);
    assert!(said.contains("the content of this chunk is 65 bytes, 64 are announced"), "{said}");
}

fn lz4(content: &[u8]) -> Vec<u8> {
    let mut packer = lz4_flex::frame::FrameEncoder::new(Vec::new());
    packer.write_all(content).unwrap();
    packer.finish().unwrap()
}

proptest! {
    #[test]
    fn torn_compressed_content_never_panics(
        is_lz4 in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        size in 0..5000_u64,
    ) {
        let content: Vec<u8> = (0..2000_u32).map(|place| (place * place / 7) as u8).collect();
        let mut packed = if is_lz4 { lz4(&content) } else { zstd::bulk::compress(&content, 3).unwrap() };
        for (place, value) in changes {
            let place = place.index(packed.len());
            packed[place] = value;
        }
        let disk = disk(&file(&[chunk(size, if is_lz4 { "lz4" } else { "zstd" }, &packed)]));
        let _ = read(&disk.path);
    }
}

/// ROS 2 recorders write LZ4 if it is selected.
#[test]
fn chunks_in_lz4_are_read() {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let schema = [&[1, 0][..], &text("std_msgs/msg/String"), &text("ros2msg"), &text("")].concat();
    let channel = [&[7, 0, 1, 0][..], &text("/a"), &text("cdr"), &text("")].concat();
    let message = [&[7, 0][..], &[0; 4], &42_u64.to_le_bytes(), &[0; 8], b"data"].concat();
    let content = [whole(op::SCHEMA, &schema), whole(op::CHANNEL, &channel), whole(op::MESSAGE, &message)].concat();
    let disk = disk(&file(&[chunk(content.len() as u64, "lz4", &lz4(&content))]));
    let (messages, error) = read(&disk.path);
    assert!(error.is_none(), "{error:?}");
    assert_eq!(messages, [("/a".to_owned(), 42, b"data".to_vec())]);
}

#[test]
fn very_many_channels_and_attachments_are_read() {
    let mut bag = TestBag::with(options());
    for place in 0..5000 {
        bag.attach(&format!("a{place}"), b"x");
    }
    for channel in 0..65_534_u32 {
        bag.message(&format!("/t{channel}"), u64::from(channel), &text("x"));
    }
    let disk = disk(&bag.finish());
    let run = Run::open(&disk.path).unwrap();
    assert_eq!(run.files()[0].attachments.len(), 5000);
    assert_eq!(run.attachment("a4999").unwrap().unwrap(), b"x");
    let (messages, error) = read(&disk.path);
    assert!(error.is_none(), "{error:?}");
    assert_eq!(messages.len(), 65_534);
}

#[test]
fn names_without_end_are_refused() {
    let long = "x".repeat(1 << 20);
    let mut bag = TestBag::with(options());
    for topic in 0..20 {
        bag.message(&format!("/{topic}{long}"), 0, &text("x"));
    }
    let disk = disk(&bag.finish());
    let said = refused(&disk.path);
    assert!(
        said.contains("the names of all topics and types would take") && said.contains("at most 16 777 216"),
        "{said}"
    );
    let mut bag = TestBag::with(options());
    for place in 0..20 {
        bag.metadata(&format!("m{place}"), &[("k", &long)]);
    }
    std::fs::write(&disk.path, bag.finish()).unwrap();
    let said = refused(&disk.path);
    assert!(
        said.contains("what stands beside the messages would take") && said.contains("at most 16 777 216"),
        "{said}"
    );
}
