"""Writes the CSV of `auvid fit`: a window of time after the other, so memory does not grow."""
import os

import numpy as np

from auvid import frames
from auvid.log_error import LogError, UsageError
from auvid.series import ATTITUDE, QUATERNION, VELOCITY, WEIGHT

WINDOW_S = 60.0


def _sparse(streams, begin, end):
    """One row per time of any stream; nan means: no new sample."""
    parts = [stream.between(begin, end) for stream in streams]
    ticks = [np.round(t * 1e6).astype(np.int64) for t, _ in parts]
    times, where = np.unique(np.concatenate(ticks), return_inverse=True)
    table = np.full((len(times), sum(len(s.columns) for s in streams)), np.nan)
    row = column = 0
    for stream, (t, values) in zip(streams, parts):
        table[where[row:row + len(t)], column:column + len(stream.columns)] = values
        row, column = row + len(t), column + len(stream.columns)
    return times * 1e-6, table


def _resampled(streams, t):
    """All streams at these times; quaternions as angles."""
    if len(t) == 0:
        return t, np.empty((0, 0))
    values = [stream.at(t) for stream in streams]
    return t, np.hstack([frames.to_angles(v) if s.columns == QUATERNION else v
                         for s, v in zip(streams, values)])


def _times(streams, resample, begin, end, common):
    """The times of resampled rows in a window: the velocity's, or a grid."""
    begin, end = max(begin, common[0]), min(end, np.nextafter(common[1], np.inf))
    if resample == "velocity":
        return next(s for s in streams if s.columns[0] in VELOCITY).between(begin, end)[0]
    first, last = np.ceil(begin * resample - 1e-6), np.ceil(end * resample - 1e-6)
    return np.arange(first, max(last, first)) / resample


def names(streams, resample):
    """The header."""
    return ["t_s", *(name for s in streams for name in
                     (ATTITUDE if resample and s.columns == QUATERNION else s.columns))]


def common_time(streams):
    """First and last time at which every stream has begun and none has ended. A weight holds until
    it changes."""
    streams = [s for s in streams if s.columns != WEIGHT]
    begin, end = max(s.series.first for s in streams), min(s.series.last for s in streams)
    if begin >= end:
        late = max(streams, key=lambda s: s.series.first).series
        early = min(streams, key=lambda s: s.series.last).series
        raise LogError(f"mixed clocks: {early.label} is from {early.first:.3f} to {early.last:.3f} "
                       f"s, {late.label} from {late.first:.3f} to {late.last:.3f} s: they have no "
                       "time in common; correct the clock, or use --clock recording")
    return begin, end


def _rows(streams, resample):
    common = common_time(streams)
    start = common[0] if resample else min(s.series.first for s in streams)
    stop = common[1] if resample else max(s.series.last for s in streams)
    for k in range(int((stop - start) // WINDOW_S) + 1):
        begin, end = start + k * WINDOW_S, start + (k + 1) * WINDOW_S
        if resample:
            t, table = _resampled(streams, _times(streams, resample, begin, end, common))
        else:
            t, table = _sparse(streams, begin, end)
        yield t - start, table


def write(streams, path, resample=None):
    """Writes the file, or nothing. resample: None, "velocity", or a rate [Hz]. -> rows written."""
    count, part = 0, path.with_name(path.name + ".part")
    try:
        with part.open("w", encoding="ascii") as file:
            file.write(",".join(names(streams, resample)) + "\n")
            for times, table in _rows(streams, resample):
                for t, row in zip(times.tolist(), table.tolist()):
                    cells = ["" if x != x else f"{x:.9g}" for x in row]
                    file.write(f"{t:.6f},{','.join(cells)}\n")
                count += len(times)
        os.replace(part, path)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        part.unlink(missing_ok=True)
    return count
