"""A run written as the log of each stack is read back, and identified as from its own CSV."""
import json
import subprocess

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg

import log_writers
from auvid import vehicle_file
from conftest import AUVID, INPUTS, ROOT

MOTION = "phi_rad theta_rad psi_rad u_mps v_mps w_mps p_radps q_radps r_radps".split()
#: Largest rounding: of an attitude [rad], of a velocity or rate, of a command.
ROUNDING = {".BIN": (0.5e-2 * np.pi / 180 + 1e-6, 1e-6, 1e-6), ".ulg": (1e-6, 1e-6, 1e-6),
            ".mcap": (1e-8, 1e-8, 1e-8), ".db3": (1e-8, 1e-8, 1e-8)}
WRENCH = "X_N Y_N Z_N K_Nm M_Nm N_Nm".split()


def write(run, path):
    """The run as a log of the kind that the suffix says."""
    if path.suffix == ".BIN":
        path.write_bytes(log_writers.bin_log(run))
    elif path.suffix == ".tlog":
        path.write_bytes(log_writers.tlog(run))
    elif path.suffix == ".ulg":
        path.write_bytes(log_writers.ulg_log(run))
    elif path.suffix == ".mcap":
        log_writers.bag(run).mcap(path)
    else:
        log_writers.bag(run).database(path)
    return path


def table(rows, names):
    return np.column_stack([rows[name] for name in names])


def fit(path):
    done = subprocess.run([AUVID, "fit", path, "--plain", "--bias", "--json"], capture_output=True,
                          text=True)
    found = json.loads(done.stdout)
    assert "error" not in found, found
    return found


def reference(run, path, inputs):
    """The CSV of the run itself."""
    np.savetxt(path, np.hstack([run.t[:, None], run.attitude, run.nu, run.commands]), "%.9g", ",",
               header=",".join(["t_s", *MOTION, *inputs]), comments="")
    return path


def turned(rows, run):
    """Difference of each angle, within half a turn."""
    return np.abs((table(rows, MOTION[:3]) - run.attitude + np.pi) % (2 * np.pi) - np.pi)


def compare(rows, run, suffix):
    """The rows are the run within the rounding of the format."""
    inputs = WRENCH if suffix in (".mcap", ".db3") else INPUTS["cmd"]
    attitude, motion, command = ROUNDING[suffix]
    assert np.allclose(rows["t_s"], run.t - run.t[0], rtol=0, atol=1e-6)
    if "qw" in rows.dtype.names:
        q = table(rows, ["qw", "qx", "qy", "qz"])
        q *= np.sign(np.sum(q * run.quaternion, axis=1, keepdims=True))
        assert np.abs(q - run.quaternion).max() <= attitude
    else:
        assert turned(rows, run).max() <= attitude
    assert np.abs(table(rows, MOTION[3:]) - run.nu).max() <= motion
    assert np.abs(table(rows, inputs) - run.commands).max() <= command
    place = table(rows, ["north_m", "east_m", "depth_m"])
    assert np.abs(place - run.position).max() <= motion


@pytest.mark.parametrize("suffix", [".BIN", ".ulg", ".mcap"])
def test_a_log_is_the_run_within_rounding_and_is_identified_as_the_run(suffix, run, tmp_path,
                                                                       convert):
    status, said, rows = convert(write(run, tmp_path / f"dive{suffix}"))
    assert status == 0 and "the raw DVL; not used: " in said, said
    compare(rows, run, suffix)
    found = fit(tmp_path / "out.csv")
    wanted = fit(reference(run, tmp_path / "run.csv", WRENCH if suffix == ".mcap" else
                           INPUTS["cmd"]))
    assert found["status"] == wanted["status"] == "ok"
    for a, b in zip(found["parameters"], wanted["parameters"], strict=True):
        assert a["name"] == b["name"] and a["identifiable"] == b["identifiable"]
        if b["sigma"]:  # rounding moves an estimate by a small part of its standard error
            assert abs(a["estimate"] - b["estimate"]) < 0.02 * b["sigma"], (a, b)


def test_a_database_is_read_as_the_run(short, tmp_path, convert):
    status, said, rows = convert(write(short, tmp_path / "dive.db3"), "--resample", "velocity")
    assert status == 0, said
    compare(rows, short, ".db3")


def test_a_telemetry_log_is_read_as_the_run(short, tmp_path, convert):
    """Times are in ms, and of the DVL those of reception, so attitudes are a little older."""
    rows = convert(write(short, tmp_path / "dive.tlog"), "--resample", "velocity")[2]
    assert np.allclose(rows["t_s"], short.t - short.t[0], rtol=0, atol=2e-3)
    assert np.abs(table(rows, MOTION[3:6]) - short.nu[:, :3]).max() < 1e-6
    assert turned(rows, short).max() < 2e-3


@pytest.mark.parametrize("suffix", [".BIN", ".ulg", ".mcap"])
def test_the_velocity_of_the_filter_is_rotated_into_body_axes(suffix, short, tmp_path, convert):
    """Without the raw DVL: what XKF1, vehicle_local_position and Odometry say is the same."""
    path = tmp_path / f"dive{suffix}"
    if suffix == ".BIN":
        path.write_bytes(log_writers.bin_log(short, skip=["VISO"]))
    elif suffix == ".ulg":
        path.write_bytes(log_writers.ulg_log(short, skip=["vehicle_visual_odometry"]))
    else:
        whole = log_writers.bag(short)
        whole.messages = [m for m in whole.messages if m[0] != "/dvl"]
        whole.mcap(path)
    status, said, rows = convert(path, "--resample", "velocity")
    assert status == 0 and "raw DVL" not in said
    bound = 3e-4 if suffix == ".BIN" else 1e-6  # attitude in hundredths of a degree
    assert np.abs(table(rows, MOTION[3:6]) - short.nu[:, :3]).max() <= bound


@pytest.mark.parametrize("suffix", [".mcap", ".db3"])
def test_a_type_that_only_the_bag_defines_is_read_by_a_map(suffix, short, tmp_path, convert):
    kind, path = "my_msgs/msg/Speed", tmp_path / f"dive{suffix}"
    whole = log_writers.bag(short)
    if kind not in whole.store.fielddefs:
        whole.store.register(get_types_from_msg("std_msgs/Header header\nfloat32[3] mm_s", kind))
    whole.messages = [m for m in whole.messages if m[0] != "/dvl"]
    for t, nu in zip(short.t + 1.7e9, short.nu):
        whole.put("/speed", t, whole.make(kind, header=whole.header(t), mm_s=np.array(
            1e3 * nu[:3], np.float32)))
    whole.messages.sort(key=lambda m: m[2])
    whole.mcap(path) if suffix == ".mcap" else whole.database(path, defined=[kind])
    (tmp_path / "map.ini").write_text("".join(
        f"[{name}]\nfrom = /speed mm_s[{k}]\nunit = mm/s\n" for k, name in enumerate(MOTION[3:6])))
    status, said, rows = convert(path, "--map", str(tmp_path / "map.ini"), "--resample", "velocity")
    assert status == 0, said
    assert np.abs(table(rows, MOTION[3:6]) - short.nu[:, :3]).max() < 1e-6


def test_frames_says_the_axes_of_a_dvl_that_does_not_name_them(short, tmp_path, convert):
    path = write(short, tmp_path / "dive.mcap")
    rows = convert(path, "--resample", "velocity", "--frames", "enu")[2]
    assert np.abs(table(rows, MOTION[3:6]) - short.nu[:, :3] * log_writers.TO_FLU).max() < 1e-8


def test_a_bag_in_several_files_is_one_log(short, tmp_path, convert):
    folder, whole = tmp_path / "dive", log_writers.bag(short)
    folder.mkdir()
    every, third = whole.messages, len(whole.messages) // 3
    for name, part in (("dive_0", every[:third]), ("dive_1", every[third:2 * third]),
                       ("dive_10", every[2 * third:])):
        whole.messages = part
        whole.mcap(folder / f"{name}.mcap")
    status, said, rows = convert(folder, "--resample", "velocity")
    assert status == 0, said
    compare(rows, short, ".mcap")


def test_a_row_per_sample_has_empty_cells_where_nothing_is_new(short, tmp_path, convert):
    """BlueOS: the DVL's samples and those of the autopilot have their own rows."""
    path = tmp_path / "recorder.mcap"
    log_writers.blueos(path, short)
    status, said, rows = convert(path)
    assert status == 0 and "recording of BlueOS" in said
    for name, wanted in zip(INPUTS["cmd"], short.commands.T):
        assert np.allclose(rows[name][np.isfinite(rows[name])], wanted, atol=1e-6)
    text = (tmp_path / "out.csv").read_text()
    assert "nan" not in text and np.all(np.diff(rows["t_s"]) > 0)


def test_thrusters_have_the_sign_of_their_direction(short, tmp_path, convert):
    path = tmp_path / "dive.BIN"
    path.write_bytes(log_writers.bin_log(short))
    rows = convert(path, "--resample", "velocity")[2]
    wanted = np.rint(400 * short.commands @ log_writers.HEAVY.T) / 400
    assert np.abs(table(rows, [f"thruster_{k + 1}" for k in range(8)]) - wanted).max() < 1e-6
    assert np.abs(wanted).max() > 0.1


def test_a_grid_interpolates_motion_and_holds_commands(short, tmp_path, convert):
    path = write(short, tmp_path / "dive.mcap")
    rows = convert(path, "--resample", "50")[2]
    t = rows["t_s"] + 1.7e9
    start = float(np.ceil(50 * (short.t[0] + 1.7e9)) / 50)
    assert np.allclose(np.diff(t), 0.02, atol=1e-5) and len(t) > 100
    at = rows["t_s"] + short.t[0]
    assert np.allclose(rows["u_mps"], np.interp(at, short.t, short.nu[:, 0]), atol=1e-5), start
    assert set(np.round(rows["X_N"], 6)) <= set(np.round(short.commands[:, 0], 6))


def test_thrusters_get_the_directions_of_a_vehicle_file(run, tmp_path, convert):
    """With the file of the BlueROV2 Heavy, the commands give the wrench that was asked for."""
    path, vehicle = tmp_path / "dive.BIN", ROOT / "tools/auvid/vehicles/bluerov2.ini"
    path.write_bytes(log_writers.bin_log(run))
    status, said, rows = convert(path, "--resample", "velocity", "--vehicle", str(vehicle))
    assert status == 0 and "push against their direction in the vehicle file" in said, said
    wrench = table(rows, [f"thruster_{k + 1}" for k in range(8)]) @ vehicle_file.wrenches(vehicle)
    for dof, command in enumerate(run.commands.T):
        if np.any(command):
            assert np.corrcoef(wrench[:, dof], command)[0, 1] > 0.999
    assert sum(np.any(c) for c in run.commands.T) >= 3


def test_a_vehicle_file_of_other_thrusters_is_refused(short, tmp_path, convert):
    path, text = tmp_path / "dive.BIN", (ROOT / "tools/auvid/vehicles/bluerov2.ini").read_text()
    path.write_bytes(log_writers.bin_log(short))
    moved = tmp_path / "moved.ini"
    swapped = text.replace("[thruster.1]", "[thruster.X]").replace("[thruster.5]", "[thruster.1]")
    moved.write_text(swapped.replace("[thruster.X]", "[thruster.5]"))
    status, said, _ = convert(path, "--vehicle", str(moved))
    assert status == 1 and "thruster 1 of this log does not push along the axes" in said, said
    status, said, _ = convert(path, "--vehicle",
                              str(ROOT / "tools/auvid/vehicles/bluerov2_standard.ini"))
    assert status == 1 and "this log has 8 thrusters, and the vehicle file 6" in said, said
