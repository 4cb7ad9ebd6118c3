"""One MCAP file as the storage plugin of rosbag2 reads it: by its indexes, in the order of time.

The plugin takes the chunks from the summary, the messages of a chunk from the message indexes behind it, and each
message from its offset in the chunk. It refuses a file whose first chunk has no message index, whatever the others
have. A file without a summary, or without any message index, is scanned and read in its own order.
"""
import heapq
import struct
from collections import Counter
from itertools import pairwise

from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, Message, MessageIndex
from mcap.stream_reader import StreamReader, breakup_chunk, get_chunk_data_stream

from report import Failure, show

CHUNK, MESSAGE, MESSAGE_INDEX = 0x06, 0x05, 0x07
HEAD = 9  # kind and length of a record


def indexed(a):
    """Every message of a file by the indexes, in the order of time; a file that was cut off in its own order."""
    with open(a.file, "rb") as f:
        summary = summary_of(f)
        topics, times, chunks = scanned(f) if summary is None else by_index(f, summary)
    counts = Counter(topics)
    show(counts=counts, messages=counts.total(), chunks=chunks, finished=summary is not None,
         start_ns=times[0] if times else None, end_ns=times[-1] if times else None,
         in_order=all(a <= b for a, b in pairwise(times)))
    if summary is not None:
        statistics = summary.statistics
        said = {summary.channels[i].topic: n for i, n in statistics.channel_message_counts.items()}
        if said != dict(counts):
            raise Failure(f"the statistics count {said}, the indexes lead to {dict(counts)}")
        span = (statistics.message_start_time, statistics.message_end_time)
        if times and span != (times[0], times[-1]):
            raise Failure(f"the statistics span {span}, the messages {(times[0], times[-1])}")


def summary_of(f):
    """The summary of a file; nothing where the file has no end."""
    try:
        return make_reader(f).get_summary()
    except (EndOfFile, McapError, struct.error):
        return None


def by_index(f, summary):
    indexes = sorted(summary.chunk_indexes, key=lambda index: index.chunk_start_offset)
    if not any(index.message_index_length for index in indexes):
        return scanned(f)
    if not indexes[0].message_index_length:
        raise Failure("cannot read MCAP in time order with no message indexes")
    jobs = []
    for index in indexes:
        f.seek(index.chunk_start_offset)
        kind, length = struct.unpack("<BQ", f.read(HEAD))
        if (kind, HEAD + length) != (CHUNK, index.chunk_length):
            raise Failure(f"no chunk of {index.chunk_length} bytes at {index.chunk_start_offset}")
        chunk = Chunk.read(ReadDataStream(f))
        jobs += [(time, index.chunk_start_offset, place, topic)
                 for time, place, topic in chunk_by_index(f, summary, index, chunk)]
    heapq.heapify(jobs)
    found = [heapq.heappop(jobs) for _ in range(len(jobs))]
    return [job[3] for job in found], [job[0] for job in found], len(indexes)


def chunk_by_index(f, summary, index, chunk):
    """Time, offset and topic of each message that the indexes behind a chunk name."""
    where = f"the chunk at {index.chunk_start_offset}"
    _, length = get_chunk_data_stream(chunk, validate_crc=True)
    held = sum(isinstance(record, Message) for record in breakup_chunk(chunk))
    if not held:
        raise Failure(f"{where} holds no message")
    data, _ = get_chunk_data_stream(chunk)
    data = data.read(length)
    found, at = [], index.chunk_start_offset + index.chunk_length
    end, offsets = at + index.message_index_length, {}
    while at < end:
        f.seek(at)
        kind, size = struct.unpack("<BQ", f.read(HEAD))
        if kind != MESSAGE_INDEX:
            raise Failure(f"expected only chunks and message indices behind {where}, found {kind}")
        messages = MessageIndex.read(ReadDataStream(f))
        offsets[messages.channel_id] = at
        for time, place in messages.records:
            kind, _, channel, _, log_time = struct.unpack_from("<BQHIQ", data, place)
            if (kind, channel, log_time) != (MESSAGE, messages.channel_id, time):
                raise Failure(f"{where}: no message of channel {messages.channel_id} at {time} ns stands at {place}")
            found.append((time, place, summary.channels[channel].topic))
        at += HEAD + size
    if (at, offsets) != (end, dict(index.message_index_offsets)):
        raise Failure(f"{where}: the indexes stand at {offsets}, the summary says {index.message_index_offsets}")
    if len(found) != held:
        raise Failure(f"{where} holds {held} messages, its indexes name {len(found)}")
    span = (min(found)[0], max(found)[0])
    for said in (index, chunk):
        if (said.message_start_time, said.message_end_time) != span:
            raise Failure(f"{where}: its messages span {span}, a {type(said).__name__} says "
                          f"{(said.message_start_time, said.message_end_time)}")
    return found


def scanned(f):
    """What stands before the torn end of a file, record by record."""
    topics, times, channels, chunks = [], [], {}, 0
    f.seek(0)
    try:
        for record in StreamReader(f, emit_chunks=True).records:
            if not isinstance(record, Chunk):
                continue
            chunks += 1
            for inner in breakup_chunk(record, validate_crc=True):
                if isinstance(inner, Channel):
                    channels[inner.id] = inner.topic
                elif isinstance(inner, Message):
                    topics.append(channels[inner.channel_id])
                    times.append(inner.log_time)
    except (EndOfFile, McapError, struct.error):
        pass
    return topics, times, chunks
