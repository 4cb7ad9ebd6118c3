"""Bags as this project writes them, read with libraries that it did not write: mcap and mcap-ros2-support."""
from collections import namedtuple
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from ruamel.yaml import YAML

from report import Failure

Item = namedtuple("Item", "file topic type schema log_time publish_time data ros")

AXIS_STATES = "lineshaft_msgs/msg/AxisStates"
COMMAND = "lineshaft_msgs/msg/AppliedCommand"
EVENT = "lineshaft_msgs/msg/Event"
INPUTS = "lineshaft_msgs/msg/CycleInputs"
JOINT_STATE = "sensor_msgs/msg/JointState"
SIGNALS = "lineshaft_msgs/msg/Signals"


def information(folder):
    """What metadata.yaml says."""
    with open(Path(folder) / "metadata.yaml", encoding="utf-8") as f:
        return YAML(typ="safe").load(f)["rosbag2_bagfile_information"]


def files(path):
    """The MCAP files of a bag in the order of its metadata.yaml; `path` is a file or a folder."""
    path = Path(path)
    if path.is_file():
        return [path]
    return [path / name for name in information(path)["relative_file_paths"]]


def reader(file):
    return make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])


def items(path):
    """Every message of a bag, decoded, in the order of its files."""
    for number, name in enumerate(files(path)):
        with open(name, "rb") as f:
            for schema, channel, m, ros in reader(f).iter_decoded_messages(log_time_order=False):
                yield Item(number, channel.topic, schema.name, schema.data.decode(), m.log_time, m.publish_time, m.data,
                           ros)


def records(path):
    """The metadata records of the first file of a bag: name, then key, then text."""
    with open(files(path)[0], "rb") as f:
        return {record.name: dict(record.metadata) for record in reader(f).iter_metadata()}


def cycle_ns(path):
    """The length of a cycle, from the record `lineshaft`."""
    try:
        return int(records(path)["lineshaft"]["cycle_ns"])
    except KeyError as e:
        raise Failure(f"{path} has no metadata record lineshaft with cycle_ns: {e} is missing") from e


def nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec
