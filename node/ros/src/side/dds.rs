//! The only file that uses the DDS library: participant, raw readers, raw writers, discovery.
//!
//! Samples are passed as bytes. Writing never blocks the caller; it returns an error if the writer is full.

use std::convert::Infallible;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4};
use std::pin::pin;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::task::{Context, Poll};
use std::time::Duration;

use bytes::Bytes;
use futures::{Stream, StreamExt};
use lineshaft_msgs::cdr::Endian;
use rustdds::no_key::{
    self, DataWriter, Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter, SimpleDataReader,
};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, DomainParticipantStatusEvent, DomainParticipantStatusListener, GUID,
    LostReason, QosPolicies, QosPolicyBuilder, RTPSEntity, RepresentationIdentifier, SampleIdentity, SequenceNumber,
    StatusEvented, Timestamp, Topic, TopicKind, WriteOptionsBuilder, policy,
};

use super::guid::{Guid, Prefix};
use super::ports;
use super::requests::Related;
use super::sedp::Endpoint;
use super::spdp::own_port;
use crate::link::protocol::{ReplyFailure, SampleId};
use crate::link::qos::Qos;

/// Log targets of the library that log the same messages repeatedly without a fault, and the level to keep for each.
pub(super) const NOISE: &[(&str, &str)] = &[
    // On loopback without multicast: 30 messages per second about the participant itself.
    ("rustdds::rtps::writer", "error"),
    ("rustdds::network", "error"),
    // At exit: groups that were never joined. An error that prevents the start of a participant is returned, not only logged.
    ("rustdds::network::udp_listener", "off"),
    // Acknowledgements of a reader that has missed many samples; the library truncates them.
    ("rustdds::structure::sequence_number", "off"),
    // A refused write; the caller reports it.
    ("rustdds::dds::with_key::datawriter", "error"),
    // The system clock was set back: many messages per second, until the side hands over.
    ("rustdds::structure::dds_cache", "off"),
    // Endpoints that outlive their participant.
    ("rustdds::dds::pubsub", "off"),
];

/// Maximum number of attempts to join with a data port that no other program uses.
const TRIES: u32 = 5;

/// The library could not create an object.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("DDS cannot make {what}: {reason}")]
pub(super) struct DdsError {
    what: String,
    reason: String,
}

impl DdsError {
    fn new(what: impl Into<String>, reason: impl std::fmt::Debug) -> Self {
        Self { what: what.into(), reason: format!("{reason:?}") }
    }
}

/// A sample as the library returns it.
#[derive(Clone, Debug)]
pub(super) struct Taken {
    pub(super) id: SampleId,
    pub(super) related: Option<Related>,
    /// Source timestamp by the clock of its writer, in ticks of 2^-32 s since 1970.
    pub(super) written: Option<u64>,
    pub(super) is_big_endian: bool,
    pub(super) bytes: Bytes,
}

impl Taken {
    pub(super) fn endian(&self) -> Endian {
        if self.is_big_endian { Endian::Big } else { Endian::Little }
    }
}

/// Discovery event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Discovery {
    /// One of our writers has matched a remote reader.
    Matched {
        writer: Guid,
        reader: Guid,
    },
    /// One of our readers has matched a remote writer.
    Heard {
        writer: Guid,
        reader: Guid,
    },
    Lost {
        reader: Guid,
    },
    Silent {
        writer: Guid,
    },
    Found {
        participant: Prefix,
    },
    /// A participant was disposed, or its lease has expired (`is_silent`).
    Gone {
        participant: Prefix,
        is_silent: bool,
    },
}

/// A participant of the DDS domain. When it is dropped, it leaves the domain.
pub(super) struct Participant {
    publisher: rustdds::Publisher,
    subscriber: rustdds::Subscriber,
    listener: DomainParticipantStatusListener,
    participant: DomainParticipant,
    /// Number of announcements and disposals of readers so far.
    readers_told: AtomicI64,
    /// Number of the newest sample of each writer.
    written: Mutex<Vec<(Guid, Weak<AtomicI64>)>>,
}

impl Participant {
    /// Joins `domain` on the networks of these addresses; `None`: on all networks of the host.
    pub(super) fn new(domain: u16, networks: Option<&[Ipv4Addr]>) -> Result<Self, DdsError> {
        let participant = Self::join(domain, networks)?;
        let fail = |error| DdsError::new(format!("a participant in domain {domain}"), error);
        let defaults = QosPolicyBuilder::new().build();
        Ok(Self {
            publisher: participant.create_publisher(&defaults).map_err(fail)?,
            subscriber: participant.create_subscriber(&defaults).map_err(fail)?,
            listener: participant.status_listener(),
            participant,
            readers_told: AtomicI64::new(0),
            written: Mutex::default(),
        })
    }

    /// Creates the participant, on a data port that no other program uses.
    fn join(domain: u16, networks: Option<&[Ipv4Addr]>) -> Result<DomainParticipant, DdsError> {
        let what = format!("a participant in domain {domain}");
        let mut port = 0;
        for _ in 0..TRIES {
            let mut builder = DomainParticipantBuilder::new(domain);
            if let Some(addresses) = networks {
                builder = builder.with_only_networks(addresses.iter().copied().map(IpAddr::V4));
            }
            let occupied = ports::occupy(domain);
            let participant = builder.build().map_err(|error| DdsError::new(&*what, error))?;
            drop(occupied);
            port = ports::data_port(domain, participant.participant_id());
            if ports::is_own(port) != Some(false) {
                return Ok(participant);
            }
            // Another program has bound the port at this moment.
        }
        Err(DdsError { what, reason: format!("UDP port {port} is in use") })
    }

    pub(super) fn guid(&self) -> Guid {
        self.participant.guid().into()
    }

    fn topic(&self, name: &str, type_name: &str, policies: &QosPolicies) -> Result<Topic, DdsError> {
        self.participant
            .create_topic(name.to_owned(), type_name.to_owned(), policies, TopicKind::NoKey)
            .map_err(|error| DdsError::new(format!("topic {name}"), error))
    }

    pub(super) fn writer(&self, topic: &str, type_name: &str, qos: Qos) -> Result<Writer, DdsError> {
        let made = self.topic(topic, type_name, &policies(qos, qos.window))?;
        match self.publisher.create_datawriter_no_key(&made, None) {
            Ok(inner) => {
                let writer = Writer { inner, last: Arc::default() };
                let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
                written.push((writer.guid(), Arc::downgrade(&writer.last)));
                Ok(writer)
            }
            Err(error) => Err(DdsError::new(format!("a writer of {topic}"), error)),
        }
    }

    /// Returns the writers that have written samples, each with the number of its newest sample.
    pub(super) fn written(&self) -> Vec<(Guid, i64)> {
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        written.retain(|(_, last)| last.strong_count() > 0);
        let last = |(guid, last): &(Guid, Weak<AtomicI64>)| Some((*guid, last.upgrade()?.load(Ordering::Relaxed)));
        written.iter().filter_map(last).filter(|(_, last)| *last > 0).collect()
    }

    pub(super) fn reader(&self, topic: &str, type_name: &str, qos: Qos) -> Result<Reader, DdsError> {
        // The library keeps this number of samples of a reader, also those that were read. Without a limit it keeps all of them.
        let made = self.topic(topic, type_name, &policies(qos, i32::from(qos.depth)))?;
        match self.subscriber.create_simple_datareader_no_key(&made, None) {
            Ok(inner) => {
                self.readers_told.fetch_add(1, Ordering::Relaxed);
                Ok(Reader { inner })
            }
            Err(error) => Err(DdsError::new(format!("a reader of {topic}"), error)),
        }
    }

    /// Returns the sequence number that the library will give to the disposal of a reader that is dropped now.
    pub(super) fn end_of_reader(&self) -> i64 {
        self.readers_told.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// Returns the next discovery event. If there is none, it is pending, and the waker is registered.
    pub(super) fn poll_discovery(&self, context: &mut Context<'_>) -> Poll<Option<Discovery>> {
        let mut events = pin!(self.listener.as_async_status_stream());
        loop {
            match events.as_mut().poll_next(context) {
                Poll::Pending => return Poll::Pending,
                Poll::Ready(None) => return Poll::Ready(None),
                Poll::Ready(Some(event)) => {
                    if let Some(change) = discovery(&event) {
                        return Poll::Ready(Some(change));
                    }
                }
            }
        }
    }

    pub(super) fn barrier(&self) -> Result<Barrier, DdsError> {
        let fail = |error| DdsError::new("a barrier", error);
        // Each sample waits until the previous one was sent. Best-effort, because no program needs to read this topic.
        let qos = Qos { reliable: false, depth: 1, latched: false, lifespan: None, window: 1 };
        let topic = self.participant.create_topic(
            // Without the prefix of ROS 2 topics, so that the ROS 2 tools do not list it.
            "lineshaft/barrier".to_owned(),
            "lineshaft::Barrier".to_owned(),
            &policies(qos, 1),
            TopicKind::NoKey,
        );
        let writer = self.publisher.create_datawriter_no_key(&topic.map_err(fail)?, None).map_err(fail)?;
        Ok(Barrier { writer })
    }

    /// Returns the loopback address on which the library reads the announcements of other participants.
    pub(super) fn discovery_address(&self) -> SocketAddrV4 {
        SocketAddrV4::new(
            Ipv4Addr::LOCALHOST,
            own_port(self.participant.domain_id(), self.participant.participant_id()),
        )
    }

    /// Returns the loopback address on which the library reads data.
    pub(super) fn data_address(&self) -> SocketAddrV4 {
        let port = ports::data_port(self.participant.domain_id(), self.participant.participant_id());
        SocketAddrV4::new(Ipv4Addr::LOCALHOST, port)
    }

    /// Returns the addresses on which a remote reader reads.
    pub(super) fn addresses_of_reader(&self, reader: Guid) -> Vec<SocketAddrV4> {
        let readers = self.participant.discovered_readers().into_iter();
        let found = readers.map(|r| r.reader_proxy).find(|proxy| Guid::from(proxy.remote_reader_guid) == reader);
        ipv4(found.map(|proxy| proxy.unicast_locator_list.into_iter().map(Into::into).collect()))
    }

    /// Whether a remote reader gets the samples that were written before it joined (transient local). Returns false if the reader is
    /// unknown.
    pub(super) fn keeps_for(&self, reader: Guid) -> bool {
        let readers = self.participant.discovered_readers().into_iter();
        let found = readers.into_iter().find(|r| Guid::from(r.reader_proxy.remote_reader_guid) == reader);
        is_latched(found.and_then(|found| found.subscription_topic_data.qos().durability()))
    }

    /// Whether a remote reader is best-effort, and sends no acknowledgements.
    pub(super) fn is_best_effort(&self, reader: Guid) -> bool {
        let readers = self.participant.discovered_readers();
        let found = readers.iter().find(|r| Guid::from(r.reader_proxy.remote_reader_guid) == reader);
        found.is_some_and(|found| !found.subscription_topic_data.qos().is_reliable())
    }

    /// Whether a remote writer keeps samples for readers that join later.
    pub(super) fn is_latched_writer(&self, writer: Guid) -> bool {
        let writers = self.participant.discovered_writers();
        let found = writers.iter().find(|w| Guid::from(w.writer_proxy.remote_writer_guid) == writer);
        is_latched(found.and_then(|found| found.publication_topic_data.qos().durability()))
    }

    /// Returns the addresses on which a remote writer listens.
    pub(super) fn addresses_of_writer(&self, writer: Guid) -> Vec<SocketAddrV4> {
        let writers = self.participant.discovered_writers().into_iter();
        let found = writers.map(|w| w.writer_proxy).find(|proxy| Guid::from(proxy.remote_writer_guid) == writer);
        ipv4(found.map(|proxy| proxy.unicast_locator_list.into_iter().map(Into::into).collect()))
    }

    /// Returns the endpoints of a remote participant.
    pub(super) fn endpoints_of(&self, participant: Prefix) -> Vec<Endpoint> {
        let readers = self.participant.discovered_readers().into_iter().map(|reader| {
            let (proxy, data) = (reader.reader_proxy, reader.subscription_topic_data);
            Endpoint {
                guid: proxy.remote_reader_guid.into(),
                topic: data.topic_name().clone(),
                type_name: data.type_name().clone(),
                reliable: data.qos().is_reliable(),
                latched: is_latched(data.qos().durability()),
                addresses: ipv4(Some(proxy.unicast_locator_list.into_iter().map(Into::into).collect())),
                user_data: octets(&reader.user_data).to_vec(),
            }
        });
        let writers = self.participant.discovered_writers().into_iter().map(|writer| {
            let (proxy, data) = (writer.writer_proxy, writer.publication_topic_data);
            let qos = data.qos();
            Endpoint {
                guid: proxy.remote_writer_guid.into(),
                topic: data.topic_name,
                type_name: data.type_name,
                reliable: qos.is_reliable(),
                latched: is_latched(qos.durability()),
                addresses: ipv4(Some(proxy.unicast_locator_list.into_iter().map(Into::into).collect())),
                user_data: octets(&writer.user_data).to_vec(),
            }
        });
        readers.chain(writers).filter(|endpoint| endpoint.guid.prefix() == participant).collect()
    }

    /// Returns the readers of `topic` on the participant of `client`, which is a writer. If its user data has a client ID
    /// (rmw_cyclonedds marks both endpoints of a client with it), only the readers with the same ID are returned.
    pub(super) fn readers_beside(&self, client: Guid, topic: &str) -> Vec<Guid> {
        let writers = self.participant.discovered_writers();
        let mark = writers.iter().find(|w| Guid::from(w.writer_proxy.remote_writer_guid) == client);
        let mark = mark.and_then(|w| client_mark(octets(&w.user_data)));
        let same: Vec<_> = (self.participant.discovered_readers().into_iter())
            .filter(|r| r.subscription_topic_data.topic_name() == topic)
            .map(|r| (Guid::from(r.reader_proxy.remote_reader_guid), r.user_data))
            .filter(|(reader, _)| reader.prefix() == client.prefix())
            .collect();
        let is_its = |data: &[u8]| mark.is_none() || client_mark(octets(data)) == mark;
        same.into_iter().filter(|(_, data)| is_its(data)).map(|(reader, _)| reader).collect()
    }
}

fn is_latched(durability: Option<policy::Durability>) -> bool {
    !matches!(durability, None | Some(policy::Durability::Volatile))
}

fn ipv4(addresses: Option<Vec<SocketAddr>>) -> Vec<SocketAddrV4> {
    let address = |address| match address {
        SocketAddr::V4(address) => Some(address),
        SocketAddr::V6(_) => None,
    };
    addresses.unwrap_or_default().into_iter().filter_map(address).collect()
}

/// Waits until the library's thread has finished its present work.
///
/// The library (0.15.1) reports a match of a writer before it has finished the match: it still sends the reader a heartbeat with
/// the number of the writer's newest sample. If another thread writes a sample right after the report, that heartbeat may already
/// include the sample, and is sent before it. A volatile reader of Cyclone DDS treats all samples that its first heartbeat includes
/// as old, and never delivers them.
pub(super) struct Barrier {
    writer: DataWriter<Raw, Raw>,
}

impl Barrier {
    /// Far longer than the library's thread ever needs if it works.
    const PATIENCE: Duration = Duration::from_millis(500);

    /// Returns true as soon as the library's thread has finished its present work, or false if the thread does not work any more.
    pub(super) async fn pass(&self) -> bool {
        // The thread sends the first sample after that work. The second sample has no space until the first one is sent.
        let both = async {
            for _ in 0..2 {
                let sample = Raw { is_big_endian: false, bytes: Bytes::new() };
                let options = WriteOptionsBuilder::new().best_effort_may_block(true).build();
                if let Err(error) = self.writer.async_write_with_options(sample, options).await {
                    tracing::debug!("the DDS library is not waited for: {}", error.forget_data());
                }
            }
        };
        let is_alive = tokio::time::timeout(Self::PATIENCE, both).await.is_ok();
        if !is_alive {
            tracing::debug!("the DDS library does not do anything for {:?}", Self::PATIENCE);
        }
        is_alive
    }
}

/// Returns the octets of a parameter that is an octet sequence: the library (0.15.1) does not remove the length before the octets and
/// the padding after them.
fn octets(parameter: &[u8]) -> &[u8] {
    let Some((number, octets)) = parameter.split_first_chunk::<4>() else { return &[] };
    // The byte order of the list is unknown. The smaller value is the length, because no list is longer than 64 kB.
    let number = u32::from_le_bytes(*number).min(u32::from_be_bytes(*number));
    octets.get(..number as usize).unwrap_or(octets)
}

/// Returns the entry `clientid=..;` of an endpoint's user data. rmw_cyclonedds sets it for each client.
fn client_mark(user_data: &[u8]) -> Option<&[u8]> {
    user_data.split(|byte| *byte == b';').find(|entry| entry.starts_with(b"clientid="))
}

fn discovery(event: &DomainParticipantStatusEvent) -> Option<Discovery> {
    match event {
        DomainParticipantStatusEvent::RemoteReaderMatched { local_writer, remote_reader } => {
            Some(Discovery::Matched { writer: (*local_writer).into(), reader: (*remote_reader).into() })
        }
        DomainParticipantStatusEvent::RemoteWriterMatched { local_reader, remote_writer } => {
            Some(Discovery::Heard { writer: (*remote_writer).into(), reader: (*local_reader).into() })
        }
        DomainParticipantStatusEvent::ReaderLost { guid, .. } => Some(Discovery::Lost { reader: (*guid).into() }),
        DomainParticipantStatusEvent::WriterLost { guid, .. } => Some(Discovery::Silent { writer: (*guid).into() }),
        DomainParticipantStatusEvent::ParticipantDiscovered { dpd } => {
            Some(Discovery::Found { participant: Guid::from(dpd.guid).prefix() })
        }
        DomainParticipantStatusEvent::ParticipantLost { id, reason } => {
            let mut prefix = [0; 12];
            prefix.copy_from_slice(id.as_ref());
            let participant = Prefix(prefix);
            let is_silent = match reason {
                LostReason::Timeout { lease, .. } => {
                    tracing::warn!(
                        "nothing was heard of DDS participant {participant} for {} s: it counts as gone until it is heard",
                        lease.to_std().as_secs_f64()
                    );
                    true
                }
                LostReason::Disposed => false,
            };
            Some(Discovery::Gone { participant, is_silent })
        }
        _ => None,
    }
}

/// Returns the QoS policies of an endpoint that holds at most `most` samples.
fn policies(qos: Qos, most: i32) -> QosPolicies {
    let depth = i32::from(qos.depth);
    let mut builder = QosPolicyBuilder::new()
        .reliability(match qos.reliable {
            true => policy::Reliability::Reliable { max_blocking_time: rustdds::Duration::ZERO },
            false => policy::Reliability::BestEffort,
        })
        .durability(if qos.latched { policy::Durability::TransientLocal } else { policy::Durability::Volatile })
        .history(policy::History::KeepLast { depth })
        .resource_limits(policy::ResourceLimits {
            max_samples: most,
            max_instances: i32::MAX,
            max_samples_per_instance: i32::MAX,
        });
    if let Some(lifespan) = qos.lifespan {
        builder = builder.lifespan(policy::Lifespan { duration: rustdds::Duration::from_std(lifespan) });
    }
    builder.build()
}

/// Writes samples of one topic.
pub(super) struct Writer {
    inner: DataWriter<Raw, Raw>,
    /// Number of the newest sample.
    last: Arc<AtomicI64>,
}

/// Destination of a reply, and the request that it answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Address {
    pub(super) reader: Guid,
    /// Request that is answered, for clients that identify their replies by it (`related_sample_identity`). If this is set, the sample
    /// must not be longer than [`LONGEST_IDENTIFIED`].
    pub(super) answers: Option<SampleId>,
}

impl Writer {
    pub(super) fn guid(&self) -> Guid {
        self.inner.guid().into()
    }

    /// Writes to all matched readers. Returns the sample's number.
    pub(super) fn write(&self, bytes: impl Into<Bytes>) -> Result<i64, ReplyFailure> {
        self.write_with(bytes.into(), WriteOptionsBuilder::new())
    }

    /// Writes to one reader, which must be matched. Returns the sample's number.
    pub(super) fn write_to(&self, bytes: impl Into<Bytes>, address: Address) -> Result<i64, ReplyFailure> {
        let (bytes, options) = (bytes.into(), WriteOptionsBuilder::new().to_single_reader(address.reader.into()));
        let Some(answers) = address.answers else { return self.write_with(bytes, options) };
        let answers = SampleIdentity {
            writer_guid: answers.writer.into(),
            sequence_number: SequenceNumber::from(answers.number),
        };
        self.write_with(bytes, options.related_sample_identity(answers))
    }

    fn write_with(&self, bytes: Bytes, options: WriteOptionsBuilder) -> Result<i64, ReplyFailure> {
        let (options, bytes) = (options.source_timestamp(Timestamp::now()).build(), padded(bytes));
        match self.inner.write_with_options(Raw { is_big_endian: false, bytes }, options) {
            Ok(written) => {
                let number = written.sequence_number.into();
                self.last.fetch_max(number, Ordering::Relaxed);
                Ok(number)
            }
            Err(rustdds::dds::WriteError::WouldBlock { .. }) => Err(ReplyFailure::Full),
            Err(error) => Err(ReplyFailure::Broken(error.forget_data().to_string())),
        }
    }
}

/// Maximum length in bytes of a sample with a `related_sample_identity` that is sent without fragmentation on every network. In
/// fragments of such a sample the library (0.15.1) writes one byte too many before the inline QoS: receivers cannot read them, and in
/// a debug build the library's thread panics. It fragments samples that exceed the network's datagrams. It reserves 48 bytes for the
/// headers of lower layers, 32 for a heartbeat and 48 for its own headers; 4 are the encapsulation. The MTU of Ethernet is 1500 bytes,
/// that of tunnels at least 1280.
pub(super) const LONGEST_IDENTIFIED: usize = 1280 - 48 - 32 - 48 - 4;

/// Pads a sample to the next multiple of 4 bytes, which readers expect. The library pads unfragmented samples itself, but not the last
/// fragment of a long one, so the next submessage in the same datagram would not be aligned.
pub(super) fn padded(bytes: Bytes) -> Bytes {
    let length = bytes.len().next_multiple_of(4);
    if length == bytes.len() {
        return bytes;
    }
    let mut longer = Vec::from(bytes);
    longer.resize(length, 0);
    longer.into()
}

/// Reads samples of one topic.
pub(super) struct Reader {
    inner: SimpleDataReader<Raw, Raw>,
}

impl Reader {
    pub(super) fn guid(&self) -> Guid {
        self.inner.guid().into()
    }

    /// Returns the next sample, or the reason why it could not be read. No sample is lost if the future is dropped.
    pub(super) async fn next(&mut self) -> Result<Taken, String> {
        let mut samples = pin!(self.inner.as_async_stream());
        match samples.next().await {
            Some(Ok(change)) => Ok(taken(&change)),
            Some(Err(error)) => Err(error.to_string()),
            // The library's streams never end. If one does, there is nothing more to read.
            None => std::future::pending().await,
        }
    }
}

fn taken(change: &no_key::DeserializedCacheChange<Raw>) -> Taken {
    let related = change.related_sample_identity().map(|related| Related {
        guid: related.writer_guid.into(),
        number: Some(related.sequence_number).filter(|n| *n != SequenceNumber::UNKNOWN).map(i64::from),
    });
    Taken {
        id: SampleId { writer: change.writer_guid.into(), number: change.sequence_number.into() },
        related,
        written: change.source_timestamp().map(|written| written.to_ticks()),
        is_big_endian: change.sample.is_big_endian,
        bytes: change.sample.bytes.clone(),
    }
}

/// Returns the time of this host's clock in the format of source timestamps: ticks of 2^-32 s since 1970.
pub(super) fn now_ticks() -> u64 {
    Timestamp::now().to_ticks()
}

impl From<GUID> for Guid {
    fn from(guid: GUID) -> Self {
        Self(guid.to_bytes())
    }
}

impl From<Guid> for GUID {
    fn from(guid: Guid) -> Self {
        Self::from_bytes(guid.0)
    }
}

/// Bytes that the library passes unchanged, and their adapter.
#[derive(Clone, Debug)]
struct Raw {
    is_big_endian: bool,
    bytes: Bytes,
}

#[derive(Clone)]
struct Pass;

impl DeserializerAdapter<Raw> for Raw {
    type Error = Infallible;
    type Decoded = Self;
    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[RepresentationIdentifier::CDR_LE, RepresentationIdentifier::CDR_BE]
    }
    fn transform_decoded(decoded: Self) -> Self {
        decoded
    }
}

impl DefaultDecoder<Raw> for Raw {
    type Decoder = Pass;
    const DECODER: Pass = Pass;
}

impl Decode<'_, Raw> for Pass {
    type Error = Infallible;
    fn decode_bytes(self, bytes: &[u8], encoding: RepresentationIdentifier) -> Result<Raw, Infallible> {
        let is_big_endian = encoding == RepresentationIdentifier::CDR_BE;
        Ok(Raw { is_big_endian, bytes: Bytes::copy_from_slice(bytes) })
    }
}

impl SerializerAdapter<Raw> for Raw {
    type Error = Infallible;
    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }
    fn to_bytes(value: &Self) -> Result<Bytes, Infallible> {
        Ok(value.bytes.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_end_at_a_multiple_of_four_bytes() {
        for (length, wanted) in [(0, 0), (1, 4), (3, 4), (4, 4), (70_001, 70_004)] {
            let sample = padded(vec![7; length].into());
            assert_eq!((sample.len(), sample.iter().filter(|byte| **byte == 7).count()), (wanted, length));
        }
    }

    #[test]
    fn the_mark_of_a_client_stands_among_other_user_data() {
        assert_eq!(client_mark(b"clientid=01.0f;typehash=RIHS01_ab;"), Some(b"clientid=01.0f".as_slice()));
        assert_eq!(client_mark(b"typehash=RIHS01_ab;clientid=7;"), Some(b"clientid=7".as_slice()));
        assert_eq!(client_mark(b"typehash=RIHS01_ab;"), None);
        assert_eq!(client_mark(b""), None);
    }

    #[test]
    fn user_data_stands_behind_its_length_and_before_padding() {
        let data = b"clientid=01.0f;";
        let parameter = |number: [u8; 4]| [number.as_slice(), data, &[0]].concat();
        assert_eq!(octets(&parameter(15_u32.to_le_bytes())), data);
        assert_eq!(octets(&parameter(15_u32.to_be_bytes())), data);
        assert_eq!(octets(&[0, 0, 0, 0]), b"");
        assert_eq!((octets(b""), octets(b"cli"), octets(&[9, 0, 0, 0, 7])), (&b""[..], &b""[..], &[7][..]));
    }
}
