"""The thrusters of a vehicle file, and the signs that turn an autopilot's commands into theirs."""
import json
import os
import shutil
import subprocess

import numpy as np

from auvid.log_error import LogError, UsageError


def wrenches(path):
    """[thrusters, 6]: wrench of each thruster per newton. The program `auvid` reads the file."""
    program = os.environ.get("AUVID") or shutil.which("auvid")
    if program is None:
        raise UsageError("--vehicle needs the program auvid: export PATH=.../auvid/build:$PATH, or "
                         "AUVID=.../auvid/build/auvid")
    done = subprocess.run([program, "check", str(path), "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        raise UsageError(f"--vehicle: {done.stderr.strip().removeprefix('auvid: ')}")
    return np.array([t["wrench"] for t in json.loads(done.stdout)["thrusters"]], float)


def signs(geometry, wrench):
    """Sign of each thruster of the file against that of the log. Both are [thrusters, 6].

    Only the signs along the axes are compared. A thruster of the log must push along those of the
    same thruster of the file: all the same way, or all the other way.
    """
    if len(geometry) != len(wrench):
        raise LogError(f"this log has {len(geometry)} thrusters, and the vehicle file "
                       f"{len(wrench)}")
    out = []
    for k, (a, b) in enumerate(zip(np.sign(np.round(geometry, 6)), np.sign(np.round(wrench, 6)))):
        both = (a * b)[a != 0]  # an autopilot may leave small moments of a thruster out
        if len(both) == 0 or abs(np.sum(both)) != len(both):
            raise LogError(f"thruster {k + 1} of this log does not push along the axes of thruster "
                           f"{k + 1} of the vehicle file: give the file the autopilot's order")
        out.append(both[0])
    return np.array(out)


def turn(recording, path):
    """Makes thruster_1 .. positive along the directions of the vehicle file. -> the signs"""
    if recording.geometry is None:
        raise LogError("this log does not say how its thrusters push (FRAME_CONFIG, CA_ROTORn_*): "
                       "--vehicle cannot compare them; leave it out")
    sign = signs(recording.geometry, wrenches(path))
    for name, (columns, function) in list(recording.derived.items()):
        factor = np.ones(len(columns))
        factor[:len(sign)] = sign
        recording.derived[name] = columns, lambda u, f=function, s=factor: f(u) * s + 0.0
    other = [str(k + 1) for k in np.flatnonzero(sign < 0)]
    if other:
        recording.notes.append(f"thrusters {', '.join(other)} push against their direction in "
                               "the vehicle file: the sign of their commands was changed")
