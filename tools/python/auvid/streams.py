"""From the series of a log to the streams of the CSV: the velocity chosen and in body axes."""
import re

import numpy as np

from auvid import frames
from auvid.log_error import LogError
from auvid.series import ATTITUDE, QUATERNION, VELOCITY, WEIGHT

#: Sources, best first. The raw DVL comes before a filtered velocity.
VELOCITIES = ("dvl", "velocity", "velocity_ned")
ATTITUDES = ("attitude", "quaternion")
INPUT = re.compile(r"cmd_|thruster_|rpm_|[XYZ]_N$|[KMN]_Nm$")


def velocities(recording):
    """The names of its velocities, best first; those of a map come before all others."""
    return sorted((name for name in VELOCITIES if name in recording.series),
                  key=lambda name: name not in recording.mapped)


def source(recording):
    """Where the velocity is from, in words."""
    used, *spare = velocities(recording)
    label = recording.series[used].label
    kind = "as mapped" if used in recording.mapped else \
        "the raw DVL" if used == "dvl" else "filtered"
    unused = ", ".join(recording.series[name].label for name in spare)
    return f"{label}, {kind}" + (f"; not used: {unused}" if unused else "")


class Stream:
    """Columns of the CSV: a series, and the function that makes its values those columns."""

    def __init__(self, series, columns=None, convert=None):
        self.series, self.columns = series, columns or series.columns
        self.convert = convert or (lambda t, values: values)
        self.is_input = bool(INPUT.match(self.columns[0]))

    def between(self, begin, end):
        """Times and values in [begin, end)."""
        a, b = np.searchsorted(self.series.times, [begin, end])
        t = np.array(self.series.times[a:b])
        return t, self.convert(t, self.series.values[a:b])

    def at(self, t):
        """Values at other times: an input or a weight is held, a motion interpolated."""
        part = around(self.series, t)
        times = np.array(self.series.times[part])
        values = self.convert(times, self.series.values[part])
        if self.is_input or self.columns == WEIGHT:
            return frames.hold(t, times, values)
        if self.columns in (QUATERNION, ATTITUDE):
            is_angles = self.columns == ATTITUDE
            q = frames.to_quaternion(values) if is_angles else values
            q = frames.interpolate_attitude(t, times, q)
            return frames.to_angles(q) if is_angles else q
        return frames.interpolate(t, times, values)


def around(series, t):
    """The slice of a series that holds the neighbours of all these times, which increase."""
    a, b = np.searchsorted(series.times, [t[0], t[-1]])
    return slice(max(a - 1, 0), b + 2)


def _rotation(attitude):
    """From north, east, down to body axes."""
    def convert(t, values):
        if len(t) == 0:
            return values
        part = around(attitude, t)
        q = attitude.values[part]
        q = q if attitude.columns == QUATERNION else frames.to_quaternion(q)
        return frames.to_body(frames.interpolate_attitude(t, attitude.times[part], q), values)
    return convert


def _check(recording, velocity, attitude, inputs):
    lacking = [word for word, found in (("velocity", velocity), ("command", inputs)) if not found]
    if velocity == "velocity_ned" and not attitude:
        lacking.append("attitude")
    elif velocity == "velocity_ned" and \
            recording.series[attitude].columns not in (ATTITUDE, QUATERNION):
        lacking.append("complete attitude")
    if lacking:
        words = [word.split()[-1] for word in lacking]
        remedies = [recording.remedies[word] for word in words if word in recording.remedies]
        raise LogError("; ".join([f"no {' and no '.join(lacking)} in this log", *remedies]))


def streams_of(recording):
    """The streams of the CSV. Raises LogError if a series is missing, or not in order."""
    for series in recording.series.values():
        series.check_order()
    for name in [name for name, series in recording.series.items()
                 if series.count < 2 and name not in WEIGHT]:
        recording.notes.append(f"{recording.series.pop(name).label}: only one sample: left out")
    velocity, attitude = next(iter(velocities(recording)), None), recording.first(*ATTITUDES)
    unused = {*VELOCITIES, *ATTITUDES} - {velocity, attitude}
    out = []
    for name, series in recording.series.items():
        if name == "velocity_ned" and name not in unused and attitude:
            out.append(Stream(series, VELOCITY, _rotation(recording.series[attitude])))
        elif name in recording.derived:
            columns, function = recording.derived[name]
            out.append(Stream(series, columns, lambda t, values, f=function: f(values)))
        elif name not in unused:
            out.append(Stream(series))
    _check(recording, velocity, attitude, [s for s in out if s.is_input])
    given = {}
    for stream in out:
        for column in stream.columns:
            if column in given:
                raise LogError(f"{column} is given twice, by {given[column]} and "
                               f"{stream.series.label}: choose topics by --only")
            given[column] = stream.series.label
    return out
