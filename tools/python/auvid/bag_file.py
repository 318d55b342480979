"""Messages of ROS 2 bags (.db3, .mcap, a folder of them) and of BlueOS's recorder (.mcap)."""
import contextlib
import json
import sqlite3
from typing import NamedTuple

from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, \
    get_typestore

from auvid.log_error import LogError

#: marine_acoustic_msgs/msg/Dvl, for bags without definitions (names and order are those of the
#: interface, https://github.com/apl-ocean-engineering/marine_msgs).
DVL = """uint8 DVL_MODE_BOTTOM=1
uint8 DVL_MODE_WATER=2
std_msgs/Header header
uint8 velocity_mode
uint8 dvl_type
geometry_msgs/Vector3 velocity
float64[9] velocity_covar
float64 altitude
float64 course_gnd
float64 speed_gnd
uint8 num_good_beams
float32 sound_speed
bool beam_ranges_valid
bool beam_velocities_valid
geometry_msgs/Vector3[4] beam_unit_vec
float64[4] range
float32[4] range_covar
float32[4] beam_quality
float32[4] beam_velocity
float32[4] beam_velocity_covar
"""


class Sample(NamedTuple):
    """A message, undecoded. kind: its type, or "json"."""
    topic: str
    kind: str
    time_s: float
    data: bytes


class Types:
    """Decodes messages by the definitions in the bag, or else by those of ROS 2."""

    def __init__(self):
        self.store = get_typestore(Stores.ROS2_HUMBLE)
        self.store.register(get_types_from_msg(DVL, "marine_acoustic_msgs/msg/Dvl"))

    def define(self, kind, encoding, text):
        """Adds a definition, or replaces one that differs. One that cannot be read is ignored."""
        with contextlib.suppress(TypesysError):
            types = get_types_from_idl(text) if "idl" in encoding else \
                get_types_from_msg(text, kind)
            for name, fields in types.items():
                if self.store.fielddefs.get(name) != fields:
                    self.store.fielddefs.pop(name, None)
                    self.store.register({name: fields})

    def knows(self, kind):
        return kind in self.store.fielddefs

    def decode(self, sample):
        """The message, as an object with its fields, or as a dictionary from JSON."""
        try:
            if sample.kind == "json":
                return json.loads(sample.data)
            return self.store.deserialize_cdr(sample.data, sample.kind)
        except Exception as error:  # any exception of the parser on a damaged message
            raise LogError(f"{sample.topic}: a message cannot be decoded as {sample.kind}: the log "
                           "is damaged, or the type is another version") from error


def ros_name(kind):
    """pkg/Name, pkg.Name and pkg.msg.Name as pkg/msg/Name."""
    parts = kind.replace(".", "/").split("/")
    return "/".join([parts[0], "msg", parts[-1]]) if len(parts) > 1 else kind


def _database(path, types):
    uri = path.resolve().as_uri() + "?mode=ro"
    try:
        with contextlib.closing(sqlite3.connect(uri, uri=True)) as file:
            tables = {name for name, in file.execute("select name from sqlite_master")}
            if "topics" not in tables:
                raise LogError("no table of topics in this file: check that it is a .db3 of ROS 2")
            if "message_definitions" in tables:
                for row in file.execute("select topic_type, encoding, encoded_message_definition "
                                        "from message_definitions"):
                    types.define(*row)
            topics = {key: (name, ros_name(kind)) for key, name, kind in
                      file.execute("select id, name, type from topics")}
            for key, time, data in file.execute("select topic_id, timestamp, data from messages "
                                                "order by timestamp"):
                yield Sample(*topics[key], time * 1e-9, data)
    except LogError:
        raise
    except Exception as error:  # any exception on a damaged file
        raise LogError(f"the database cannot be read ({error}): it is cut off or damaged; try "
                       "sqlite3 FILE .recover") from error


def _mcap(path, types, notes):
    channels, schemas = {}, {}
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, record_size_limit=1 << 30).records:
                if isinstance(record, Schema):
                    schemas[record.id] = ros_name(record.name)
                    if record.encoding != "jsonschema":
                        types.define(schemas[record.id], record.encoding,
                                     record.data.decode("utf-8", "replace"))
                elif isinstance(record, Channel):
                    kind = schemas.get(record.schema_id, "")
                    channels[record.id] = (record.topic, "json" if record.message_encoding == "json"
                                           else kind)
                elif isinstance(record, Message) and record.channel_id in channels:
                    yield Sample(*channels[record.channel_id], record.log_time * 1e-9, record.data)
        except Exception as error:  # any exception of the parser on a damaged file
            if not channels:
                raise LogError("no message in this file: check that it is an .mcap") from error
            notes.append("the file is cut off: it ends within a record; what stands before is "
                         "converted")


def samples(path, types, notes):
    """Yields the Sample of each message. path: a file, or the folder of a bag."""
    files = [path] if path.is_file() else sorted(
        (f for f in path.iterdir() if f.suffix in (".db3", ".mcap")),
        key=lambda f: (len(f.name), f.name))
    if not files:
        raise LogError("no .db3 and no .mcap in this folder; decompress a .zstd with zstd -d")
    for file in files:
        yield from _mcap(file, types, notes) if file.suffix == ".mcap" else _database(file, types)
