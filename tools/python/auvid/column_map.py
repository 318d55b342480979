"""--map columns.ini: which column or field of a log is which column of the CSV.

    [t_s]              ; only for a .csv: without it the column t_s
    from = time_us
    unit = us          ; or ISO 8601: 2026-05-01T12:00:00.25Z

    [v_mps]
    from = /dvl/data velocity.y     ; topic and field of a bag; in a .csv, the name of a column
    unit = mm/s
    sign = -1
    frame = enu                     ; forward, left, up and ENU (REP 103); default ned

Velocities along north, east and down are vn_mps, ve_mps and vd_mps: they become those in body axes.
"""
import configparser
import csv
import datetime
import itertools
import math
import re
from typing import Callable, NamedTuple

from auvid.log_error import LogError, UsageError
from auvid.series import ATTITUDE, COMMANDS, FORCE, POSITION, QUATERNION, RATES, REFERENCE, \
    VELOCITY, VELOCITY_NED, WEIGHT, WRENCH, Recording
from auvid.streams import INPUT

ISO_TIME = "ISO 8601"
RATIO = {"1": 1, "%": 0.01}
SPEED = {"m/s": 1, "cm/s": 0.01, "mm/s": 1e-3, "km/h": 1 / 3.6, "ft/s": 0.3048, "kn": 1852 / 3600}
TURN_RATE = {"rad/s": 1, "deg/s": math.pi / 180}
NEWTONS = {"N": 1, "kN": 1e3, "kgf": 9.80665}
ROTATION = {"rpm": 1}
#: Of a thruster: us is the width of its pulses, which the vehicle file's map takes as it is.
THRUSTER = {**RATIO, **NEWTONS, **ROTATION, "us": 1}
#: Columns, and the factor of each unit that fits them.
DIMENSIONS = (
    (["t_s"], {"s": 1, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, ISO_TIME: 1}),
    (VELOCITY + VELOCITY_NED + REFERENCE[:3], SPEED), (RATES + REFERENCE[3:], TURN_RATE),
    (ATTITUDE, {"rad": 1, "deg": math.pi / 180}), (QUATERNION, RATIO), (COMMANDS, RATIO),
    (POSITION, {"m": 1, "cm": 0.01, "mm": 1e-3, "ft": 0.3048}),
    (FORCE, {"m/s2": 1, "g": 9.80665}), (WRENCH[:3] + WEIGHT, NEWTONS), (WRENCH[3:], {"Nm": 1}),
    (["voltage_V"], {"V": 1, "mV": 1e-3}))
UNITS = {column: units for columns, units in DIMENSIONS for column in columns}
GROUPS = {"dvl": VELOCITY, "velocity_ned": VELOCITY_NED, "attitude": ATTITUDE,
          "quaternion": QUATERNION, "rates": RATES, "position": POSITION, "specific_force": FORCE}
#: Columns that change their sign between forward, left, up and forward, right, down.
TURNED = {"v_mps", "w_mps", "vd_mps", "q_radps", "r_radps", "theta_rad", "depth_m", "fy_mps2",
          "fz_mps2", "Y_N", "Z_N", "M_Nm", "N_Nm",
          *(kind + dof for kind in ("cmd_", "ref_") for dof in ("sway", "heave", "pitch", "yaw"))}


class Entry(NamedTuple):
    """A column is factor * source + offset; number: of the text of a cell; enu: it is one of a
    quaternion that turns forward, left, up to ENU."""
    source: str
    factor: float
    offset: float
    number: Callable[[str], float] = float
    enu: bool = False


def _units(column):
    """The units that fit a column; without a unit it is in that of its name."""
    of_input = ROTATION if column.startswith("rpm_") else \
        NEWTONS if column.endswith("_N") else THRUSTER
    return {"": 1, **UNITS.get(column, of_input)}


def _entry(path, column, section):
    unknown = set(section) - {"from", "unit", "sign", "frame"}
    if unknown:
        raise UsageError(f"{path}: [{column}]: unknown key {sorted(unknown)[0]}; the keys are "
                         "from, unit, sign, frame")
    if "from" not in section:
        raise UsageError(f"{path}: [{column}]: no key from: name the source of the column")
    unit, sign = section.get("unit", ""), section.get("sign", "1")
    frame = section.get("frame", "ned")
    units = _units(column)
    for key, value, allowed in (("unit", unit, units), ("sign", sign, ("1", "+1", "-1")),
                                ("frame", frame, ("ned", "enu"))):
        if value not in allowed:
            raise UsageError(f"{path}: [{column}]: {key} = {value}: use one of "
                             f"{', '.join(filter(None, allowed))}")
    factor = units[unit] * int(sign)
    if frame == "enu" and column in QUATERNION:
        return Entry(section["from"], factor, 0.0, enu=True)
    if frame == "enu" and column == "psi_rad":
        return Entry(section["from"], -factor, math.pi / 2)
    return Entry(section["from"], -factor if frame == "enu" and column in TURNED else factor, 0.0,
                 _iso_time if unit == ISO_TIME else float)


def load(path):
    """-> {column: Entry}"""
    parser = configparser.ConfigParser(inline_comment_prefixes=(";", "#"), interpolation=None)
    parser.optionxform = str
    try:
        with open(path, encoding="utf-8") as file:
            parser.read_file(file)
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: cannot be read: {getattr(error, 'strerror', error)}") from error
    except configparser.Error as error:
        raise UsageError(f"{path}: {str(error).splitlines()[0]}") from error
    for column in parser.sections():
        if column not in UNITS and not INPUT.match(column):
            raise UsageError(f"{path}: [{column}] is no column of auvid; they are "
                             f"{', '.join(sorted(UNITS))}, thruster_1 .., rpm_1 ..")
    if not parser.sections():
        raise UsageError(f"{path}: no section: write one for each column, as [u_mps]")
    entries = {column: _entry(path, column, parser[column]) for column in parser.sections()}
    if len({c in entries for c in VELOCITY_NED}) > 1:
        raise UsageError(f"{path}: velocities along north, east and down need all of "
                         f"{', '.join(VELOCITY_NED)}")
    if len({c in entries and entries[c].enu for c in QUATERNION}) > 1:
        raise UsageError(f"{path}: frame = enu of a quaternion needs all of "
                         f"{', '.join(QUATERNION)} with it")
    return entries


def grouped(entries):
    """-> [(name of the series, columns)]: vectors together, everything else by itself."""
    out = [(name, [c for c in columns if c in entries]) for name, columns in GROUPS.items()]
    single = [c for c in entries if c != "t_s" and not any(c in g for g in GROUPS.values())]
    return [(name, columns) for name, columns in out if columns] + [(c, [c]) for c in single]


def _in_ned(columns, entries, values):
    """The values of a group. A quaternion from forward, left, up to ENU becomes one from forward,
    right, down to NED: both frames are turned, by half a turn each."""
    if tuple(columns) != tuple(QUATERNION) or not all(entry.enu for entry in entries):
        return values
    w, x, y, z = (math.sqrt(0.5) * value for value in values)
    return [w + z, x + y, x - y, w - z]


def _iso_time(text):
    """Seconds of a date and time, as 2026-05-01T12:00:00.25Z; without a zone it is UTC. Python 3.10
    reads no Z, and only fractions of 3 or 6 digits."""
    text = re.sub(r"\.(\d+)", lambda fraction: f".{fraction[1]:0<6.6}", text.strip())
    time = datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))
    return (time if time.tzinfo else time.replace(tzinfo=datetime.timezone.utc)).timestamp()


def _number(line, entry, text):
    try:
        return entry.number(text)
    except ValueError:
        what = "number" if entry.number is float else "time in " + ISO_TIME
        raise LogError(f"line {line}: {entry.source}: '{text[:24]}' is not a {what}") from None


def _whole_lines(file, recording):
    """The lines of a table, but for a last one without line end."""
    for line in file:
        if line.endswith(("\n", "\r")):
            yield line
        else:
            recording.notes.append("the last line has no line end and may be cut off: it is left "
                                   "out")


def _header(lines, time):
    """The header of a table, past comments: lines that begin with #. One with the column of the
    time is the header: some programs write it so. -> (number of comments, header)"""
    comments, line = 0, next(lines, "")
    while line.startswith("#"):
        header = line.lstrip("# ")
        if time in (name.strip() for name in re.split("[,;\t]", header)):
            return comments, header
        comments, line = comments + 1, next(lines, "")
    return comments, line


def read_csv(path, options):
    """A .csv by its map. An empty cell means: no new sample. -> Recording"""
    recording, entries = Recording(path, "CSV"), options.map
    recording.remedies.update(rate="record them at 10 Hz or more",
                              attitude="name its columns in the map: phi_rad, theta_rad and "
                              "psi_rad, or a quaternion",
                              rates="name their columns in the map, as [r_radps]")
    entries.setdefault("t_s", Entry("t_s", 1.0, 0.0))
    with path.open(encoding="utf-8-sig", newline="") as file:
        lines = _whole_lines(file, recording)
        comments, first = _header(lines, entries["t_s"].source)
        separator = max(",;\t", key=first.count)
        rows = csv.DictReader(itertools.chain([first], lines), skipinitialspace=True,
                              delimiter=separator)
        header = [name.strip() for name in rows.fieldnames or []]
        rows.fieldnames = header
        for column, entry in entries.items():
            if entry.source not in header:
                raise LogError(f"no column {entry.source} (for {column}) in the header; its "
                               f"columns are {', '.join(header)[:300]}")

        def value(row, column):
            entry = entries[column]
            text = row[entry.source]
            if separator != ",":
                text = text.replace(",", ".")  # a decimal comma
            return entry.factor * _number(comments + rows.line_num, entry, text) + entry.offset
        groups = grouped(entries)
        recording.mapped.update(name for name, _ in groups)
        for row in rows:
            if None in row.values() or None in row:
                raise LogError(f"line {comments + rows.line_num}: the row does not have the "
                               f"{len(header)} columns of the header: correct it, or remove it")
            t = value(row, "t_s")
            for name, columns in groups:
                if all(row[entries[c].source].strip() for c in columns):
                    values = _in_ned(columns, [entries[c] for c in columns],
                                     [value(row, c) for c in columns])
                    recording.add(name, t, values,
                                  ", ".join(entries[c].source for c in columns), columns)
    return recording


class Fields:
    """Fields of the messages of a bag."""

    def __init__(self, entries):
        self.by_topic = {}
        for name, columns in grouped(entries):
            sources = [entries[c].source.split() for c in columns]
            if any(len(source) != 2 for source in sources):
                raise UsageError(f"--map: [{columns[0]}]: from needs a topic and a field, as "
                                 "from = /dvl/data velocity.x")
            if len({topic for topic, _ in sources}) > 1:
                raise UsageError(f"--map: {', '.join(columns)} must come from one topic")
            fields = [(field.split("."), entries[c]) for (_, field), c in zip(sources, columns)]
            self.by_topic.setdefault(sources[0][0], []).append((name, columns, fields))

    def take(self, recording, t, sample, message):
        """Adds the fields of a message, apart from the series that the bag has by itself."""
        for name, columns, fields in self.by_topic[sample.topic]:
            values = [entry.factor * _field(message, path, sample.topic) + entry.offset
                      for path, entry in fields]
            values = _in_ned(columns, [entry for _, entry in fields], values)
            recording.add("map " + name, t, values, sample.topic, columns)

    @staticmethod
    def replace(recording):
        """Puts the mapped series in the places of the others."""
        for name in [name for name in recording.series if name.startswith("map ")]:
            recording.series[name[4:]] = recording.series.pop(name)
            recording.mapped.add(name[4:])


def _field(message, path, topic):
    for part in path:
        name, _, index = part.partition("[")
        found = message.get(name) if isinstance(message, dict) else getattr(message, name, None)
        if found is None:
            raise LogError(f"{topic} has no field {'.'.join(path)}")
        message = found[int(index.rstrip("]"))] if index else found
    return float(message)
