"""The readers against the libraries' own, and the arithmetic of attitudes against matrices."""
import os
import subprocess
import sys
import types

import numpy as np
import pytest

import log_writers
from auvid import advice, ardupilot, dataflash, frames, series, tlog, ulog, write_csv
from conftest import DIVES
from test_round_trip import write

LONG = os.environ.get("AUVID_TEST_LONG")
OPTIONS = types.SimpleNamespace(only=None, map=None, clock=None, frames=None)


@pytest.mark.skipif(not DIVES.exists(), reason="no real logs here")
def test_a_dataflash_log_is_read_as_pymavlink_reads_it():
    from pymavlink.DFReader import DFReader_binary
    path = DIVES / "ardusub_small.BIN"
    found_series = dataflash.read(path, OPTIONS).series
    fields = {"ATT": ("attitude", ["Roll", "Pitch", "Yaw"], np.pi / 180),
              "IMU": ("rates", ["GyrX", "GyrY", "GyrZ"], 1),
              "XKF1": ("velocity_ned", ["VN", "VE", "VD"], 1), "BAT": ("voltage", ["Volt"], 1),
              "RCOU": ("pwm", [f"C{k}" for k in range(1, 15)], 1)}
    log, rows = DFReader_binary(str(path), zero_time_base=True), {name: [] for name in fields}
    while (m := log.recv_match(type=list(fields))) is not None:
        name, names, unit = fields[m.get_type()]
        rows[m.get_type()].append([m.TimeUS * 1e-6, *(getattr(m, n) * unit for n in names)])
    for message, (name, _, _) in fields.items():
        found = np.column_stack([found_series[name].times, found_series[name].values])
        assert np.allclose(found, rows[message], rtol=1e-12, atol=1e-12) and len(found) > 200


@pytest.mark.skipif(not DIVES.exists(), reason="no real logs here")
def test_a_telemetry_log_is_read_as_pymavlink_reads_it(tmp_path):
    from pymavlink import mavutil
    path = tmp_path / "part.tlog"
    path.write_bytes((DIVES / "ardusub_small.tlog").read_bytes()[:200000])
    attitude = tlog.read(path, OPTIONS).series["attitude"]
    log, rows = mavutil.mavlink_connection(str(path)), []
    while (m := log.recv_match(type="ATTITUDE")) is not None:
        rows.append([m.time_boot_ms * 1e-3, m.roll, m.pitch, m.yaw])
    found = np.column_stack([attitude.times, attitude.values])
    assert np.allclose(found, rows[:len(found)], rtol=1e-12) and 300 < len(found) >= len(rows) - 1


def test_a_ulog_is_read_as_pyulog_reads_it(short, tmp_path):
    from pyulog import ULog
    path = tmp_path / "dive.ulg"
    path.write_bytes(log_writers.ulg_log(short))
    recording, log = ulog.read(path, OPTIONS), ULog(str(path))
    data = log.get_dataset("vehicle_attitude").data
    wanted = np.column_stack([data["timestamp_sample"] * 1e-6,
                              *(data[f"q[{k}]"] for k in range(4))])
    found = recording.series["quaternion"]
    assert np.array_equal(np.column_stack([found.times, found.values]), wanted)
    assert recording.parameters == log.initial_parameters


def random_attitudes(n=200):
    rng = np.random.default_rng(1)
    return rng.uniform([-np.pi, -1.5, -np.pi], [np.pi, 1.5, np.pi], (n, 3)), \
        rng.normal(size=(n, 3))


def test_attitudes_agree_with_rotation_matrices():
    angles, v = random_attitudes()
    q, body_to_ned = frames.to_quaternion(angles), log_writers.matrix(angles)
    assert np.allclose(frames.to_angles(q), angles, atol=1e-9)
    assert np.allclose(frames.to_body(q, v), np.einsum("nji,nj->ni", body_to_ned, v), atol=1e-12)


def test_rep_103_becomes_ned_and_frd():
    angles, v = random_attitudes()
    to_ned = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1.0]])       # from ENU, and back
    enu = to_ned @ log_writers.matrix(angles) @ np.diag([1, -1, -1.0])
    w = np.sqrt(np.maximum(1 + np.trace(enu, axis1=1, axis2=2), 0)) / 2
    keep = w > 0.1
    q = np.column_stack([w, (enu[:, 2, 1] - enu[:, 1, 2]) / (4 * w),
                         (enu[:, 0, 2] - enu[:, 2, 0]) / (4 * w),
                         (enu[:, 1, 0] - enu[:, 0, 1]) / (4 * w)])[keep]
    assert np.sum(keep) > 150
    assert np.allclose(frames.to_angles(frames.ned_frd(q)), angles[keep], atol=1e-9)


@pytest.mark.parametrize("frame", [1, 2])
def test_commands_of_the_axes_come_back_from_the_thrusters(frame):
    """What AP_Motors6DOF mixes is unmixed, for the frames whose factors are -1, 0, 1."""
    factors = np.array(ardupilot.FRAMES[frame], float)
    u = np.random.default_rng(2).uniform(-0.3, 0.3, 6)   # roll pitch yaw up forward right
    out = ardupilot.mixer(frame) @ (factors @ u)
    wanted = np.array([u[4], u[5], -u[3], u[0], u[1], u[2]])
    used = np.any(ardupilot.mixer(frame), axis=1)
    assert np.allclose(out[used], wanted[used]) and np.sum(used) == (5 if frame == 1 else 6)


def test_commands_from_the_geometry_of_px4_have_the_sign_of_the_wrench():
    """A rotor at x = 1 that pushes right gives sway and yaw; one that pushes down, heave."""
    p = {"CA_ROTOR_COUNT": 2}
    for k, (place, axis) in enumerate([((1, 0, 0), (0, 1, 0)), ((0, 0, 0), (0, 0, 1))]):
        p.update({f"CA_ROTOR{k}_P{c}": float(x) for c, x in zip("XYZ", place)})
        p.update({f"CA_ROTOR{k}_A{c}": float(x) for c, x in zip("XYZ", axis)})
    assert np.allclose(ulog.mixer(p), [[0, 0], [1, 0], [0, 1], [0, 0], [0, 0], [1, 0]])


def damaged(data, rng):
    """The log with some bytes changed, removed or cut off."""
    out, at = bytearray(data), int(rng.integers(len(data)))
    kind = rng.integers(3)
    if kind == 0:
        for k in rng.integers(len(out), size=20):
            out[k] = rng.integers(256)
    elif kind == 1:
        del out[at:at + int(rng.integers(1, 50))]
    else:
        del out[at:]
    return bytes(out)


@pytest.mark.parametrize("suffix", [".BIN", ".tlog", ".ulg", ".mcap", ".db3"])
def test_a_damaged_log_never_ends_in_a_trace(suffix, short, tmp_path, convert):
    short = log_writers.Run(*(values[:20] for values in short))
    whole, path = write(short, tmp_path / f"whole{suffix}"), tmp_path / f"dive{suffix}"
    rng, seen = np.random.default_rng(1), set()
    for _ in range(300 if LONG else 6):
        path.write_bytes(damaged(whole.read_bytes(), rng))
        status, said, _ = convert(path)
        seen.add(status)
        assert status in (0, 1) and said.endswith("\n") and "nan" not in said, said
    assert seen <= {0, 1}


def big_log(path, size):
    """A .BIN with the messages of a fast IMU between those that are used; time goes on."""
    kinds = ["ATT", "IMU", "VISO", "XKF1", "RCOU", "BAT"]
    second, offsets = [], []
    rng, at = np.random.default_rng(1), 0
    for i in range(1000):
        values = {"ATT": (0, 10, 0, 20, 0, 30, 0, 0), "IMU": (0, *rng.normal(size=6)),
                  "VISO": (0.1, 0, 0, 0, *rng.normal(size=3), 90), "BAT": (0, 16.0),
                  "XKF1": (0, 0, 0, 0, *np.zeros(7)), "RCOU": tuple(rng.integers(1400, 1600, 14))}
        for name in kinds if i % 100 == 0 else ["IMU"]:
            row = bytearray(log_writers.bin_message(name, 1000 * i, *values[name]))
            if name == "IMU" and i % 100:
                row[11] = 1        # a second IMU, which is not used
            second.append(bytes(row))
            offsets.append((at + 3, 1000 * i))
            at += len(row)
    block = np.frombuffer(b"".join(second), np.uint8).copy()
    where = np.array([o for o, _ in offsets])[:, None] + np.arange(8)
    base = np.array([t for _, t in offsets], "<u8")
    with path.open("wb") as file:
        file.write(b"".join(log_writers.bin_format(name) for name in log_writers.FORMATS))
        for name, value in log_writers.PARAMETERS.items():
            file.write(log_writers.bin_message("PARM", 0, name.encode(), value))
        for k in range(size // len(block)):
            block[where] = (base + np.uint64(1_000_000 * k)).view(np.uint8).reshape(-1, 8)
            file.write(block.tobytes())
    return size // len(block)


def test_series_in_files_give_the_same_csv(short, tmp_path, convert, monkeypatch):
    path = write(short, tmp_path / "dive.ulg")
    assert convert(path)[0] == 0
    in_memory = (tmp_path / "out.csv").read_bytes()
    monkeypatch.setattr(series, "BUFFER", 50)
    monkeypatch.setattr(write_csv, "WINDOW_S", 1.7)
    monkeypatch.setattr(advice, "WINDOW_S", 1.7)
    assert convert(path)[0] == 0 and (tmp_path / "out.csv").read_bytes() == in_memory


@pytest.mark.skipif(not LONG, reason="AUVID_TEST_LONG=1 runs it")
def test_memory_does_not_grow_with_the_log(tmp_path):
    """A log of 2 GB takes as much as one of 0.1 GB: 113 MB, with the libraries, which need 200 MB
    of address space. That is limited: how much of it is resident depends on the kernel's pages."""
    seconds = big_log(tmp_path / "dive.BIN", 2 << 30)
    code = "import resource, sys; resource.setrlimit(resource.RLIMIT_DATA, 2 * (230 << 20,)); " \
           "from auvid import cli; sys.exit(cli.main(sys.argv[1:]))"
    subprocess.run([sys.executable, "-c", code, tmp_path / "dive.BIN", "-o",
                    tmp_path / "dive.csv"], capture_output=True, text=True, check=True,
                   env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
    with (tmp_path / "dive.csv").open() as file:
        assert sum(1 for _ in file) == 1 + 10 * seconds
