"""Named series, each at its own times. What a reader fills and the writer reads.

A series that outgrows its buffer goes to a temporary file, so a log of any size needs the same
memory.
"""
import array
import math
import tempfile

import numpy as np

from auvid.log_error import LogError

DOFS = ["surge", "sway", "heave", "roll", "pitch", "yaw"]
ATTITUDE = ["phi_rad", "theta_rad", "psi_rad"]
QUATERNION = ["qw", "qx", "qy", "qz"]
RATES = ["p_radps", "q_radps", "r_radps"]
VELOCITY = ["u_mps", "v_mps", "w_mps"]
VELOCITY_NED = ["vn_mps", "ve_mps", "vd_mps"]
POSITION = ["north_m", "east_m", "depth_m"]
FORCE = ["fx_mps2", "fy_mps2", "fz_mps2"]
WRENCH = ["X_N", "Y_N", "Z_N", "K_Nm", "M_Nm", "N_Nm"]
COMMANDS = ["cmd_" + dof for dof in DOFS]
REFERENCE = ["ref_" + dof for dof in DOFS]
WEIGHT = ["weight_N"]  # of what hangs on the vehicle; it may be logged only when it changes

#: The series that readers give. Body axes are forward, right, down; the world is north, east, down.
COLUMNS = {
    "attitude": ATTITUDE,
    "quaternion": QUATERNION,
    "rates": RATES,
    "dvl": VELOCITY,                          # raw, in body axes
    "velocity": VELOCITY,                     # filtered, in body axes
    "velocity_ned": VELOCITY_NED,             # filtered; the writer rotates it
    "position": POSITION,
    "specific_force": FORCE,                  # of the accelerometers, in body axes
    "wrench": WRENCH,
    "commands": COMMANDS,
    "voltage": ["voltage_V"],
}

BUFFER = 1 << 17   # numbers held in memory by each series
JITTER_S = 1.0     # samples may be out of order by less than this
DAY_S = 86400.0    # a longer gap is an error of the clock


class Column:
    """Numbers in memory, or in a temporary file when they are many."""

    def __init__(self):
        self.buffer, self.file = array.array("d"), None

    def extend(self, numbers):
        self.buffer.extend(numbers)
        if len(self.buffer) > BUFFER:
            self._spill()

    def _spill(self):
        self.file = self.file or tempfile.TemporaryFile()
        self.buffer.tofile(self.file)
        self.buffer = array.array("d")

    def view(self):
        """All numbers, without a copy."""
        if self.file is None:
            return np.frombuffer(self.buffer, float)
        self._spill()
        self.file.flush()
        return np.memmap(self.file, float, "r")


class Series:
    """Samples at times [s] that increase. label: the message or topic, for the user."""

    def __init__(self, label, columns):
        self.label, self.columns = label, columns
        self.count = self.unordered = self.returns = 0
        self.first = self.last = self.returned = None
        self._times, self._values = Column(), Column()

    def add(self, t, values):
        """Appends a sample. One that is slightly older than the last is counted and dropped."""
        if self.last is not None and t <= self.last:
            if self.last - t > JITTER_S:
                self.returned = self.returned or (self.last, t)
                self.returns += 1
                self.last = t
            self.unordered += t < self.last
            return
        if self.last is not None and t - self.last > DAY_S:
            raise LogError(f"{self.label}: time jumps from {self.last:.3f} to {t:.3f} s: the clock "
                           "was set, or the log is damaged; split it, and convert each part")
        self.first = t if self.first is None else self.first
        self.last = t
        self.count += 1
        self._times.extend((t,))
        self._values.extend(values)

    def check_order(self):
        """Raises LogError if time went back: by a further recording or two, or all the time."""
        if self.returned is None:
            return
        first, t = self.returned
        often = self.returns > 1 + self.count // 100
        raise LogError(f"{self.label}: time goes back from {first:.3f} to {t:.3f} s: " + (
            f"it does so {self.returns} times; sort the rows by time" if often else
            f"the log holds {'two' if self.returns == 1 else self.returns + 1} recordings; split "
            "it, and convert each"))

    @property
    def times(self):
        return self._times.view()

    @property
    def values(self):
        """[count, columns]"""
        return self._values.view().reshape(self.count, len(self.columns))

    @property
    def rate_hz(self):
        """Samples per second between the first and the last one; 0 with fewer than two."""
        return (self.count - 1) / (self.last - self.first) if self.count > 1 else 0.0


class Recording:
    """What a reader found in a log.

    kind: the format, in words. series: by name. parameters: the autopilot's.
    notes: sentences about what the conversion would lose.
    mapped: the names of series that a map gives.
    derived: by the name of a series, (columns, function of its values) that replaces it.
    geometry: [thrusters, 6] axes along which each thruster of the log pushes, or None.
    modes: (t, name, degrees of freedom held; None: not known), where the mode changes.
    remedies: what to do about a missing series, by a word of the sentence.
    """

    def __init__(self, path, kind):
        self.path, self.kind = path, kind
        self.series, self.parameters = {}, {}
        self.modes, self.mapped = [], set()
        self.notes, self.derived, self.remedies, self.geometry = [], {}, {}, None

    def add(self, name, t, values, label, columns=None):
        """Appends a sample to a series. One with a value that is not finite is dropped."""
        if not all(map(math.isfinite, values)):
            return
        if name not in self.series:
            columns = columns or COLUMNS.get(name) or [f"{name}_{k + 1}" for k in
                                                       range(len(values))]
            self.series[name] = Series(label, columns)
        self.series[name].add(t, values)

    def add_mode(self, t, table, number):
        """The autopilot's mode, by its number in a table of modes.py."""
        mode = table.get(number, (f"mode {number}", None))
        if not self.modes or self.modes[-1][1:] != mode:
            self.modes.append((t, *mode))

    def first(self, *names):
        """The first of these series that the log has, by name; None if it has none."""
        return next((name for name in names if name in self.series), None)
