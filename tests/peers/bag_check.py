#!/usr/bin/env python3
"""Bags seen by libraries that are not this project's: rosbags, mcap, mcap-ros2-support. JSON lines, exit 1 on failure.

    pip install -r requirements.txt
    bag_check.py rosbags FOLDER
    bag_check.py mcap FILE
    bag_check.py metadata FOLDER
    bag_check.py torn FILE  # a file whose writer was killed
    bag_check.py against-csv BAG CSV --scale x=1/104857600 --scale turret=2pi/36000
    bag_check.py flip FILE OUT --cycle 100 --field drive_count[0] --bit 3
    bag_check.py drop FILE OUT --cycle 100
    bag_check.py topics-only FILE OUT
    bag_check.py layout LAYOUT BAG
"""
import argparse
import hashlib
import struct
import sys
from collections import Counter
from pathlib import Path

from mcap.exceptions import EndOfFile, McapError
from mcap.records import Channel, Chunk, DataEnd, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from rosbags.rosbag2 import Reader, ReaderError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from ruamel.yaml.error import YAMLError

import bag_edit
import bags
from bag_compare import against_csv
from bag_index import indexed
from bag_layout import layout
from report import Failure, show


def rosbags(a):
    """Every message of every topic through rosbags, with the types that stand in the bag, and metadata.yaml judged."""
    counts, ends = Counter(), []
    with Reader(a.folder) as reader:
        store = types_of(reader.connections)
        for connection, stamp, data in reader.messages():
            store.deserialize_cdr(data, connection.msgtype)
            counts[connection.topic] += 1
            ends = [min(ends[0], stamp), max(ends[1], stamp)] if ends else [stamp, stamp]
        said = {c.topic: c.msgcount for c in reader.connections}
        types = {c.topic: c.msgtype for c in reader.connections}
        hashes = {c.topic: (c.digest, store.hash_rihs01(c.msgtype)) for c in reader.connections if c.digest}
        total, begin, end = reader.message_count, reader.start_time, reader.end_time - 1
    told = bags.information(a.folder)
    show(counts=counts, types=types, start_ns=ends[0] if ends else None, end_ns=ends[1] if ends else None,
         files=told["relative_file_paths"], messages=counts.total(), hashes=len(hashes), version=told["version"])
    want = {topic: counts[topic] for topic in said}
    require(said == want, f"metadata.yaml counts {said}, the files hold {want}")
    require(total == counts.total(), f"metadata.yaml counts {total} messages, the files hold {counts.total()}")
    require(not ends or [begin, end] == ends, f"metadata.yaml says {begin} to {end} ns, the messages say {ends}")
    wrong = {topic: pair for topic, pair in hashes.items() if pair[0] != pair[1]}
    require(not wrong, f"type hashes in metadata.yaml, and what they are: {wrong}")
    for file in told["files"]:
        file_agrees(Path(a.folder), file)


def types_of(connections):
    """A type store with nothing in it but the types of the bag's own schemas."""
    store = get_typestore(Stores.EMPTY)
    types = {}
    for c in connections:
        types.update(get_types_from_msg(c.msgdef.data, c.msgtype))
    store.register(types)
    return store


def file_agrees(folder, said):
    """Judges what metadata.yaml says of one file."""
    with Reader(folder / Path(said["path"]).name) as reader:
        begin, count = said["starting_time"]["nanoseconds_since_epoch"], said["message_count"]
        told = (count, begin, begin + said["duration"]["nanoseconds"])
        holds = (reader.message_count, reader.start_time, reader.end_time - 1)
    require(told == holds, f"{said['path']} holds {holds} (messages, first ns, last ns), metadata.yaml says {told}")


def mcap(a):
    """Every message, attachment and metadata record through mcap-ros2-support, and the file's own statistics judged."""
    counts, types, times = Counter(), {}, []
    for item in bags.items(a.file):
        counts[item.topic] += 1
        types[item.topic] = item.type
        times.append(item.log_time)
    with open(a.file, "rb") as f:
        reader = bags.reader(f)
        header, summary = reader.get_header(), reader.get_summary()
        attached = [{"name": x.name, "media_type": x.media_type, "size": len(x.data), "log_time": x.log_time,
                     "sha256": hashlib.sha256(x.data).hexdigest()} for x in reader.iter_attachments()]
        records = [{"record": x.name, **x.metadata} for x in reader.iter_metadata()]
    require(summary is not None, "the file has no summary: it was not finished")
    said = {summary.channels[i].topic: n for i, n in summary.statistics.channel_message_counts.items()}
    show(profile=header.profile, library=header.library, counts=counts, types=types, messages=len(times),
         start_ns=min(times, default=None), end_ns=max(times, default=None), in_order=times == sorted(times),
         attachments=attached, records=records, chunks=len(summary.chunk_indexes),
         compression=sorted({c.compression for c in summary.chunk_indexes}),
         schema_encoding=sorted({s.encoding for s in summary.schemas.values()}),
         message_encoding=sorted({c.message_encoding for c in summary.channels.values()}),
         channels={c.topic: c.metadata for c in summary.channels.values()})
    require(said == dict(counts), f"the statistics count {said}, the file holds {dict(counts)}")
    told = (summary.statistics.attachment_count, summary.statistics.metadata_count)
    require(told == (len(attached), len(records)),
            f"the statistics count {told} attachments and metadata records, the file holds "
            f"{(len(attached), len(records))}")


def metadata(a):
    """Whether a folder has a metadata.yaml; one that is there must be whole."""
    name = Path(a.folder) / "metadata.yaml"
    if not name.exists():
        show(there=False)
        return
    try:
        told = bags.information(a.folder)
        show(there=True, messages=told["message_count"], files=told["relative_file_paths"],
             topics=len(told["topics_with_message_count"]))
    except (YAMLError, KeyError, TypeError) as e:
        raise Failure(f"{name} is torn: {e}") from e


def torn(a):
    """What stands in the whole chunks of a file that may end anywhere."""
    topics, schemas, counts, chunks, last = {}, {}, Counter(), 0, None
    try:
        for record in StreamReader(a.file, emit_chunks=True, validate_crcs=True).records:
            if isinstance(record, DataEnd):
                break
            chunks += isinstance(record, Chunk)
            for r in breakup_chunk(record, validate_crc=True) if isinstance(record, Chunk) else [record]:
                if isinstance(r, Schema):
                    schemas[r.id] = r.name
                elif isinstance(r, Channel):
                    topics[r.id] = schemas[r.schema_id]
                elif isinstance(r, Message):
                    counts[topics[r.channel_id]] += 1
                    last = r.log_time
        with open(a.file, "rb") as f:
            finished = bags.reader(f).get_summary() is not None
    except (EndOfFile, McapError, struct.error):
        # The library lets the last one through where a message index is torn.
        finished = False
    show(chunks=chunks, counts=counts, cycles=counts[bags.INPUTS], last_ns=last, finished=finished,
         size=Path(a.file).stat().st_size)


def require(condition, sentence):
    if not condition:
        raise Failure(sentence)


def parser():
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = top.add_subparsers(dest="command", required=True)

    def command(name, run, *places):
        p = sub.add_parser(name, help=run.__doc__)
        p.set_defaults(run=run)
        for place in places:
            p.add_argument(place)
        return p
    command("rosbags", rosbags, "folder")
    command("mcap", mcap, "file")
    command("metadata", metadata, "folder")
    command("torn", torn, "file")
    command("indexed", indexed, "file")
    p = command("against-csv", against_csv, "bag", "csv")
    p.add_argument("--scale", action="append", default=[], metavar="AXIS=SI",
                   help="m or rad per increment as a fraction, such as x=1/104857600 or turret=2pi/36000")
    p.add_argument("--encoder", action="append", default=[], help="name of an encoder, in file order")
    p.add_argument("--digital", action="append", default=[], help="name of a digital input, in file order")
    p.add_argument("--analog", action="append", default=[], help="name of an analog input, in file order")
    p = command("flip", bag_edit.flip, "file", "out")
    p.add_argument("--topic", help="left out: the topic of the type CycleInputs")
    p.add_argument("--cycle", type=int, required=True)
    p.add_argument("--field", required=True, help="such as missed, or drive_count[0]")
    p.add_argument("--bit", type=int, required=True)
    p = command("drop", bag_edit.drop, "file", "out")
    p.add_argument("--topic", help="left out: the topic of the type CycleInputs")
    p.add_argument("--cycle", type=int, required=True)
    p = command("topics-only", bag_edit.topics_only, "file", "out")
    p.add_argument("--topic", action="append", help="keep this one; left out: joint_states and axis_states")
    command("layout", layout, "layout", "bag")
    return top


def main():
    a = parser().parse_args()
    try:
        a.run(a)
    except (Failure, McapError, ReaderError) as e:
        show(error=str(e) or type(e).__name__)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
