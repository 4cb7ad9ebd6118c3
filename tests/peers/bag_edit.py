"""Bags with one thing changed, written anew with the library mcap: what else is in it, chunks and order, stays."""
import functools

import numpy as np
from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.writer import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from bags import AXIS_STATES, INPUTS, JOINT_STATE
from report import Failure, show


def flip(a):
    """Turns over one bit of one field of one message."""
    rewrite(a.file, a.out, once(a, lambda schema, data: flipped(schema, data, a.field, a.bit)))


def drop(a):
    """Leaves out one message."""
    rewrite(a.file, a.out, once(a, lambda schema, data: None))


def topics_only(a):
    """Keeps two topics and nothing beside them, as `ros2 bag record` would."""
    def kept(schema, channel, data):
        wanted = channel.topic in a.topic if a.topic else schema.name in (AXIS_STATES, JOINT_STATE)
        return data if wanted else None
    rewrite(a.file, a.out, kept, whole=False)


def once(a, change):
    """A change of the one message of cycle `a.cycle`; the others pass."""
    def changed(schema, channel, data):
        is_topic = channel.topic == a.topic if a.topic else schema.name == INPUTS
        if not is_topic or cycle_of(schema, data) != a.cycle:
            return data
        return change(schema, data)
    return changed


@functools.cache
def store_of(name, text):
    """The types that a schema tells."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text.decode(), name))
    return store


def cycle_of(schema, data):
    message = store_of(schema.name, schema.data).deserialize_cdr(data, schema.name)
    if not hasattr(message, "cycle"):
        raise Failure(f"{schema.name} has no cycle")
    return message.cycle


def flipped(schema, data, field, bit):
    """The message with bit `bit` of `field` turned over; what else is in it stays as it is, bit for bit."""
    store = store_of(schema.name, schema.data)
    message = store.deserialize_cdr(data, schema.name)
    if bytes(store.serialize_cdr(message, schema.name)) != data:
        raise Failure(f"rosbags writes a message of {schema.name} differently: nothing can be flipped")
    name, _, index = field.rstrip("]").partition("[")
    try:
        value = getattr(message, name)
        if index:
            value = value.copy()  # what rosbags gives out cannot be written
            value[int(index)] = turned(value[int(index)], bit)
        else:
            value ^= 1 << bit
    except (AttributeError, IndexError) as e:
        raise Failure(f"{schema.name} has no {field}: {e}") from e
    setattr(message, name, value)
    result = bytes(store.serialize_cdr(message, schema.name))
    count = (int.from_bytes(data, "little") ^ int.from_bytes(result, "little")).bit_count()
    if count != 1 or len(result) != len(data):
        raise Failure(f"{count} bits differ after bit {bit} of {field} was turned over")
    return result


def turned(value, bit):
    """An element of an array, one bit of it turned over."""
    if isinstance(value, (bool, np.bool_)):
        return not value
    raw = np.array([value]).view(f"u{value.dtype.itemsize}")
    raw[0] ^= raw.dtype.type(1 << bit)
    return raw.view(value.dtype)[0]


def rewrite(source, target, change, whole=True):
    """Copies an MCAP file record by record, chunk by chunk. `change` takes schema, channel and data of each message and
    returns its data, or None for a message that is left out. Not `whole`: messages only, and topics that have some."""
    schemas, channels, ids, changed, left_out = {}, {}, {}, 0, 0

    def register(channel):
        schema = schemas[channel.schema_id]
        schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
        ids[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, schema_id, channel.metadata)

    with open(target, "wb") as out:
        writer = Writer(out, chunk_size=2**40)  # a chunk ends where its original ends, not by its size
        for record in StreamReader(source, emit_chunks=True, validate_crcs=True).records:
            if isinstance(record, DataEnd):
                break
            if isinstance(record, Header):
                writer.start(record.profile, record.library)
            elif isinstance(record, Attachment) and whole:
                writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)
            elif isinstance(record, Metadata) and whole:
                writer.add_metadata(record.name, record.metadata)
            for r in breakup_chunk(record, validate_crc=True) if isinstance(record, Chunk) else [record]:
                if isinstance(r, Schema):
                    schemas[r.id] = r
                elif isinstance(r, Channel) and r.id not in channels:
                    channels[r.id] = r
                    if whole:
                        register(r)
                elif isinstance(r, Message):
                    channel = channels[r.channel_id]
                    data = change(schemas[channel.schema_id], channel, r.data)
                    if data is None:
                        left_out += 1
                        continue
                    changed += data != r.data
                    if channel.id not in ids:
                        register(channel)
                    writer.add_message(ids[channel.id], r.log_time, data, r.publish_time, r.sequence)
            if isinstance(record, Chunk):
                writer.flush()
        writer.finish()
    show(changed=changed, left_out=left_out, out=target)
    if changed + left_out == 0:
        raise Failure("nothing was changed: the file has no such message")
