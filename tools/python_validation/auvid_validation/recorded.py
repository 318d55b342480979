"""Logs of a real vehicle: read in any format, identified by `auvid fit`, simulated here."""
import json
import pathlib
import subprocess
import sys

import numpy as np

from auvid_validation.user_error import UserError
from auvid_validation.library import PARAMETERS, program
from auvid_validation.model import simulate
from auvid_validation.world import DOFS

ATTITUDE = ["phi_rad", "theta_rad"]
RATES = ["p_radps", "q_radps"]
VELOCITIES = ["u_mps", "v_mps", "w_mps", "r_radps"]
WRENCH = ["X_N", "Y_N", "Z_N", "K_Nm", "M_Nm", "N_Nm"]
COMMANDS = ["cmd_surge", "cmd_sway", "cmd_heave", "cmd_roll", "cmd_pitch", "cmd_yaw"]
GAP_S = 0.5  # a longer gap ends the record


def auvid(*arguments):
    """The JSON object that the program prints. Its error messages are errors of the user."""
    done = subprocess.run([str(program()), *map(str, arguments), "--json"], capture_output=True,
                          text=True)
    found = json.loads(done.stdout or "{}")
    if not found or "error" in found:
        words = done.stderr.strip().splitlines() or ["the program failed"]
        raise UserError(words[-1].removeprefix("auvid: "))
    sys.stderr.write(done.stderr)  # warnings, and unused parts of a log
    return found


def as_candump(path, to):
    """Converts a .asc or .blf to the format of candump -L."""
    import can
    frames = 0
    try:
        with can.LogReader(str(path)) as log, to.open("w") as file:
            for frame in log:
                frames += 1
                if frame.is_error_frame or frame.is_remote_frame or frame.is_fd:
                    continue
                digits = 8 if frame.is_extended_id else 3
                file.write(f"({frame.timestamp:.6f}) can0 {frame.arbitration_id:0{digits}X}#"
                           f"{bytes(frame.data).hex().upper()}\n")
            cut_off = getattr(log, "file_size", 0) > path.stat().st_size  # of a .blf: as its header
    except Exception as error:  # any exception of the parser on a damaged file
        raise UserError(f"{path}: cannot be read as {path.suffix[1:]}: {error}")
    if frames == 0:
        raise UserError(f"{path}: no frame in it: check that it is a {path.suffix} file")
    if path.suffix == ".asc":
        text = path.read_text().lower()
        cut_off = "begin triggerblock" in text and "end triggerblock" not in text
    if cut_off:
        raise UserError(f"{path}: is cut off")


def as_csv(path, folder):
    """The log in the format of `auvid fit`: itself, or converted into the folder."""
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    if path.suffix in (".asc", ".blf"):
        candump = folder / (path.stem + ".log")
        as_candump(path, candump)
        try:
            return as_csv(candump, folder)
        except UserError as error:
            raise UserError(str(error).replace(str(candump), str(path)))
    if path.suffix != ".log":
        return path
    to = folder / (path.stem + ".csv")
    auvid("replay", path, "--csv", to)
    return to


def fit(train, test, arguments):
    """The result of `auvid fit --json`. With nothing to identify it is an error of the input."""
    more = ["--validate", test] if test else []
    found = auvid("fit", train, *more, *arguments)
    if found["status"] == "not_excited":
        raise UserError(f"{train}: nothing to identify: the log is too short, or no degree of "
                        "freedom has an input that varies")
    return found


def sampled(t, column):
    """Linear between samples; an empty cell is none. NaN outside, and between samples too far
    apart."""
    at = t[known := np.isfinite(column)]
    if len(at) < 2:
        return column
    after = np.clip(np.searchsorted(at, t), 1, len(at) - 1)
    values = np.interp(t, at, column[known], left=np.nan, right=np.nan)
    return np.where(at[after] - at[after - 1] <= GAP_S, values, np.nan)


def held(column):
    """The last input before an empty cell."""
    last = np.maximum.accumulate(np.where(np.isfinite(column), np.arange(len(column)), 0))
    return column[last]


class Log:
    """Columns of a CSV that `auvid fit` has accepted: the rows at which all are known."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        with self.path.open(encoding="utf-8-sig") as file:  # as auvid fit: a mark may come first
            names = [name.strip() for name in file.readline().split(",")]
            lines = [line for line in file if line.endswith("\n")]  # the last may be truncated
            data = np.genfromtxt(lines, delimiter=",", comments=None).reshape(-1, len(names))
        column = dict(zip(names, data.T))
        t = column["t_s"]

        def take(wanted, fill):
            return np.column_stack([fill(column[name]) if name in column else np.zeros(len(t))
                                    for name in wanted])

        tilt = take(ATTITUDE + RATES, lambda x: sampled(t, x))
        velocity = take(VELOCITIES, lambda x: sampled(t, x))
        self.in_commands = not any(name in column for name in WRENCH)
        inputs = take(COMMANDS if self.in_commands else WRENCH, held)[:, DOFS]
        known = np.isfinite(np.column_stack([t, tilt, velocity, inputs])).all(axis=1)
        self.t, self.tilt, self.velocity = t[known] - t[known][0], tilt[known], velocity[known]
        self.input = inputs[known]

    @property
    def pieces(self):
        """Slices without a gap."""
        ends = [0, *(np.flatnonzero(np.diff(self.t) > GAP_S) + 1), len(self.t)]
        return [slice(a, b) for a, b in zip(ends[:-1], ends[1:]) if b - a > 1]


class Model:
    """The result of `auvid fit`, ready to simulate a log."""

    def __init__(self, found, log):
        pi = {p["name"]: p["estimate"] or 0.0 for p in found["parameters"]}
        self.log, self.coupled = log, "decoupled" not in found["model"]
        self.pi = [pi.get(name, 0.0) for name in PARAMETERS]
        # held until the next row, and delayed: the input of a row acts in the step that ends there
        self.input = np.empty_like(log.input)
        for j, axis in enumerate("XYZN"):
            since = log.t - (found["delay_s"][axis] or 0.0)
            row = np.searchsorted(log.t, since - 1e-9) - 1
            self.input[:, j] = log.input[np.maximum(row, 0), j] + pi.get(f"{axis}_0", 0.0)

    def run(self, part):
        """u v w r in a slice, from the measured velocity at its start."""
        log = self.log
        start, h = [*log.velocity[part.start], 0], np.diff(log.t[part], prepend=log.t[part.start])
        return simulate(self.pi, log.tilt[part], self.input[part], h, start, self.coupled,
                        log.velocity[part])[:, :4]

    def whole(self):
        """u v w r, restarted only after each gap."""
        out = np.full((len(self.log.t), 4), np.nan)
        for piece in self.log.pieces:
            out[piece] = self.run(piece)
        return out

    def ahead(self, seconds=1.0):
        """-> (times, [m, 4] errors of consecutive predictions over that horizon)"""
        t, ends, errors = self.log.t, [], []
        for piece in self.log.pieces:
            begin = piece.start
            while (end := int(np.searchsorted(t, t[begin] + seconds - 1e-9))) < piece.stop:
                errors.append(self.log.velocity[end] - self.run(slice(begin, end + 1))[-1])
                ends.append(end)
                begin = end
        return t[ends], np.array(errors).reshape(-1, 4)
