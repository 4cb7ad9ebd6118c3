//! Reads the messages of one file, chunk by chunk.

use super::error::{Damage, RunError};
use super::fields::{Chunk, Fields, MessageHead};
use super::outline::Outline;
use super::records::{Frame, HEAD, MAX_RECORD, Records, op};
use lineshaft_core::unit::excerpt;
use std::collections::HashMap;
use std::io::Read;
use std::ops::Range;
use zstd::bulk::Decompressor;

/// Maximum size of all names of topics and types in one file, in bytes.
const MAX_NAMES: u64 = 16 << 20;

/// A topic of a file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Channel {
    pub topic: String,
    pub kind: String,
    pub encoding: String,
}

/// Location of the last message.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub head: MessageHead,
    data: Range<usize>,
}

/// Reads the messages of one file in their order.
pub(super) struct Messages {
    records: Records,
    /// CRC written after the data.
    crc: Option<u32>,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    /// Size of the names, in bytes.
    names: u64,
    /// Body of a record as in the file.
    body: Vec<u8>,
    /// Records of the current chunk, and its offset in the file.
    content: Vec<u8>,
    chunk_at: u64,
    /// Offset of the next record in `content`.
    next: usize,
    unpacker: Option<Decompressor<'static>>,
}

impl Messages {
    pub(super) fn open(outline: &Outline) -> Result<Self, RunError> {
        let mut records = Records::open(&outline.path, &outline.name, outline.end, outline.crc.is_some())?;
        let mut magic = [0; mcap::MAGIC.len()];
        if records.left() >= magic.len() as u64 {
            records.take(&mut magic)?;
        }
        Ok(Self {
            records,
            crc: outline.crc,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            names: 0,
            body: Vec::new(),
            content: Vec::new(),
            chunk_at: 0,
            next: 0,
            unpacker: None,
        })
    }

    /// Returns the offset of the next byte of the file.
    pub(super) fn at(&self) -> u64 {
        self.records.at()
    }

    /// Goes to the next message; returns `None` at the end of the file.
    pub(super) fn advance(&mut self) -> Result<Option<Place>, RunError> {
        loop {
            let place = if self.next < self.content.len() {
                self.inside().map_err(|damage| self.records.damaged(self.chunk_at, damage))?
            } else {
                let Some(frame) = self.records.next()? else { return Ok(None) };
                self.outside(frame)?
            };
            if place.is_some() {
                return Ok(place);
            }
        }
    }

    /// Returns the topic of a message, and its bytes.
    pub(super) fn message(&self, place: &Place) -> (Option<&Channel>, &[u8]) {
        (self.channels.get(&place.head.channel), self.content.get(place.data.clone()).unwrap_or_default())
    }

    /// Reads the next record of the current chunk.
    fn inside(&mut self) -> Result<Option<Place>, Damage> {
        let rest = self.content.get(self.next..).unwrap_or_default();
        let (head, rest) = rest.split_first_chunk::<{ HEAD as usize }>().ok_or(Damage::ChunkRecords)?;
        let [kind, length @ ..] = *head;
        let length = usize::try_from(u64::from_le_bytes(length)).map_err(|_| Damage::ChunkRecords)?;
        let body = rest.get(..length).ok_or(Damage::ChunkRecords)?;
        let start = self.next + HEAD as usize;
        self.next = start + length;
        match kind {
            op::MESSAGE => self.place(start..start + length).map(Some),
            op::SCHEMA | op::CHANNEL => {
                let body = body.to_owned();
                self.describe(kind, &body).map(|()| None)
            }
            op::CHUNK | 0 => Err(Damage::ChunkRecords),
            _ => Ok(None),
        }
    }

    /// Reads a record outside of a chunk, or a chunk itself.
    fn outside(&mut self, frame: Frame) -> Result<Option<Place>, RunError> {
        let damaged = |records: &Records, damage| records.damaged(frame.at, damage);
        match frame.kind {
            op::CHUNK => {
                self.records.body(frame, &mut self.body)?;
                (self.chunk_at, self.next) = (frame.at, 0);
                self.unpack().map_err(|damage| damaged(&self.records, damage))?;
                Ok(None)
            }
            op::MESSAGE => {
                self.records.body(frame, &mut self.content)?;
                self.next = self.content.len();
                let place = self.place(0..self.content.len());
                place.map(Some).map_err(|damage| damaged(&self.records, damage))
            }
            op::SCHEMA | op::CHANNEL => {
                let mut body = std::mem::take(&mut self.body);
                self.records.body(frame, &mut body)?;
                let described = self.describe(frame.kind, &body);
                self.body = body;
                described.map(|()| None).map_err(|damage| damaged(&self.records, damage))
            }
            op::DATA_END => match (self.crc, self.records.crc_before()) {
                (Some(written), Some(found)) if written != found => {
                    Err(damaged(&self.records, Damage::FileCrc { found, written }))
                }
                _ => self.records.skip_to(frame.end()).map(|()| None),
            },
            _ => self.records.skip_to(frame.end()).map(|()| None),
        }
    }

    /// Unpacks the chunk in `body` to `content`.
    fn unpack(&mut self) -> Result<(), Damage> {
        let chunk = Chunk::read(&self.body)?;
        let content = &mut self.content;
        content.clear();
        if chunk.size > MAX_RECORD {
            let what = "the content of this chunk";
            return Err(Damage::TooLong { what, bytes: chunk.size, most: MAX_RECORD });
        }
        match chunk.compression {
            "" => content.extend_from_slice(chunk.packed),
            _ if chunk.size == 0 => {}
            "zstd" => {
                content.reserve_exact(chunk.size as usize);
                let failed = |error: std::io::Error| Damage::Decompression(error.to_string());
                let unpacker = match self.unpacker.take() {
                    Some(unpacker) => self.unpacker.insert(unpacker),
                    None => self.unpacker.insert(Decompressor::new().map_err(failed)?),
                };
                unpacker.decompress_to_buffer(chunk.packed, content).map_err(failed)?;
            }
            "lz4" => {
                // One byte more than the given size reveals additional data.
                let mut unpacked = lz4_flex::frame::FrameDecoder::new(chunk.packed).take(chunk.size + 1);
                unpacked.read_to_end(content).map_err(|error| Damage::Decompression(error.to_string()))?;
            }
            other => return Err(Damage::Compression(excerpt(other))),
        }
        if content.len() as u64 != chunk.size {
            return Err(Damage::Size { found: content.len() as u64, announced: chunk.size });
        }
        let found = crc32fast::hash(content);
        if chunk.crc != 0 && chunk.crc != found {
            content.clear();
            return Err(Damage::ChunkCrc { found, written: chunk.crc });
        }
        Ok(())
    }

    /// Returns the location of the message whose record body is at `body`.
    fn place(&self, body: Range<usize>) -> Result<Place, Damage> {
        let head = MessageHead::read(self.content.get(body.clone()).unwrap_or_default())?;
        if !self.channels.contains_key(&head.channel) {
            return Err(Damage::Channel(head.channel));
        }
        Ok(Place { head, data: body.start + MessageHead::LENGTH..body.end })
    }

    /// Stores a schema or a channel.
    fn describe(&mut self, kind: u8, body: &[u8]) -> Result<(), Damage> {
        let mut fields = Fields::new(body);
        let id = fields.u16()?;
        if kind == op::SCHEMA {
            let name = fields.text()?;
            let known = self.schemas.get(&id);
            if known.is_some_and(|known| known != name) {
                return Err(Damage::Conflict { what: "schema", id });
            }
            if known.is_none() {
                self.count_names(name.len())?;
                self.schemas.insert(id, name.to_owned());
            }
            return Ok(());
        }
        let (schema, topic, encoding) = (fields.u16()?, fields.text()?, fields.text()?);
        let kind = match schema {
            0 => "",
            _ => self.schemas.get(&schema).ok_or_else(|| Damage::Schema { topic: excerpt(topic), schema })?,
        };
        match self.channels.get(&id) {
            Some(known) if known.topic == topic && known.kind == kind && known.encoding == encoding => Ok(()),
            Some(_) => Err(Damage::Conflict { what: "channel", id }),
            None => {
                let (topic, kind, encoding) = (topic.to_owned(), kind.to_owned(), encoding.to_owned());
                self.count_names(topic.len() + kind.len() + encoding.len())?;
                let channel = Channel { topic, kind, encoding };
                self.channels.insert(id, channel);
                Ok(())
            }
        }
    }

    fn count_names(&mut self, bytes: usize) -> Result<(), Damage> {
        self.names += bytes as u64;
        if self.names > MAX_NAMES {
            let what = "the names of all topics and types";
            return Err(Damage::TooLong { what, bytes: self.names, most: MAX_NAMES });
        }
        Ok(())
    }
}
