"""What a user must know of a converted log: rates, rest, gaps. A sentence each, with a remedy."""
import numpy as np

from auvid import modes
from auvid.series import ATTITUDE, QUATERNION, RATES
from auvid.streams import velocities
from auvid.write_csv import WINDOW_S

INPUT_HZ = 5.0     # a small vehicle settles in 0.2 s
VELOCITY_HZ = 2.0
GAP_S = 1.0
REST_MPS = 0.05    # root mean square of the speed
REST_INPUT = 0.02  # range of a command of -1..1, or of a force relative to 1 N


def _windows(stream):
    series = stream.series
    for k in range(int((series.last - series.first) // WINDOW_S) + 1):
        t, values = stream.between(series.first + k * WINDOW_S, series.first + (k + 1) * WINDOW_S)
        if len(t):
            yield t, values


def _span(stream):
    """Largest range of a column."""
    low, high = np.inf, -np.inf
    for _, values in _windows(stream):
        low, high = np.minimum(low, values.min(axis=0)), np.maximum(high, values.max(axis=0))
    return float(np.max(high - low))


def _speed(stream):
    total = sum(float(np.sum(values ** 2)) for _, values in _windows(stream))
    return np.sqrt(total / stream.series.count)


def _gaps(stream):
    """Number of gaps, and their total [s]."""
    last, count, total = stream.series.first, 0, 0.0
    for t, _ in _windows(stream):
        steps = np.diff(t, prepend=last)
        count += int(np.sum(steps > GAP_S))
        total += float(np.sum(steps[steps > GAP_S]))
        last = t[-1]
    return count, total


def _rest(streams, velocity):
    moves = _speed(velocity) > REST_MPS
    if any(_span(stream) > REST_INPUT for stream in streams if stream.is_input):
        return []
    return ["the commands never change: nothing to identify; drive each axis both ways"
            if moves else "vehicle at rest: nothing to identify; drive each axis both ways"]


def _missing(recording, streams):
    """What an identification does without, but worse."""
    given = {column for stream in streams for column in stream.columns}
    return [f"no {word} in this log: {effect}; {recording.remedies[word]}"
            for word, columns, effect in (
                ("attitude", ATTITUDE + QUATERNION, "roll and pitch are taken as zero"),
                ("rates", RATES, "roll, pitch and yaw cannot be identified"))
            if given.isdisjoint(columns)]


def advise(recording, streams):
    """-> sentences"""
    velocity = next(s for s in streams if s.series is recording.series[velocities(recording)[0]])
    said = _rest(streams, velocity) + _missing(recording, streams)
    inputs = [s for s in streams if s.is_input]
    slow = min(inputs, key=lambda s: s.series.rate_hz)
    if slow.series.rate_hz < INPUT_HZ:
        said.append(f"thruster commands at {slow.series.rate_hz:.2g} Hz in a "
                    f"{recording.path.suffix}: {recording.remedies['rate']}")
    rate = velocity.series.rate_hz
    if rate < VELOCITY_HZ:
        said.append(f"velocity at {rate:.2g} Hz: a small vehicle needs {VELOCITY_HZ:.0f} Hz or "
                    "more")
    said += modes.advise(recording.modes, velocity.series.first, velocity.series.last)
    count, total = _gaps(velocity)
    if count and rate >= VELOCITY_HZ:
        said.append(f"{velocity.series.label}: {count} gaps longer than {GAP_S:.0f} s, "
                    f"{total:.0f} s of {velocity.series.last - velocity.series.first:.0f} s")
    for series in recording.series.values():
        if series.unordered:
            said.append(f"{series.label}: {series.unordered} samples came late, after a newer one, "
                        "and are left out")
    return said
