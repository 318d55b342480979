"""The run that all logs are written from: the tank's where it is, else a simulated one."""
import os
import pathlib
import subprocess

import numpy as np
import pytest

from auvid import cli
from log_writers import Run

ROOT = pathlib.Path(__file__).resolve().parents[3]
AUVID = pathlib.Path(os.environ.setdefault("AUVID", str(ROOT / "build/auvid")))
SHARED = ROOT.parent / "shared/data"
TANK = pathlib.Path(os.environ.get("AUVID_TANK_DATA", SHARED / "bluerov2_tank"))
DIVES = SHARED / "dive_logs"
INPUTS = {"cmd": "cmd_surge cmd_sway cmd_heave cmd_roll cmd_pitch cmd_yaw".split()}


def _tank(name):
    rows = np.genfromtxt(TANK / f"{name}.csv", delimiter=",", names=True)

    def take(names):
        return np.column_stack([rows[n] for n in names.split()])
    return Run(rows["t_s"], take("phi_rad theta_rad psi_rad"),
               take("u_mps v_mps w_mps p_radps q_radps r_radps"), take(" ".join(INPUTS["cmd"])),
               take("x_m y_m z_m"))


def _simulated(folder):
    """The demo at 5 Hz, with the wrench as commands that a PWM can hold."""
    path = folder / "demo.csv"
    subprocess.run([AUVID, "demo", "--sets", "3", "--csv", path], check=True, capture_output=True)
    rows = np.genfromtxt(path, delimiter=",", skip_header=1)[::10]
    tau = rows[:, 10:16] / np.maximum(np.abs(rows[:, 10:16]).max(axis=0), 1) / 3
    return Run(rows[:, 0], rows[:, 1:4], rows[:, 4:10], np.rint(tau * 400) / 400,
               np.zeros((len(rows), 3)))


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    if (TANK / "run_a.csv").exists():
        return _tank("run_a")
    return _simulated(tmp_path_factory.mktemp("demo"))


@pytest.fixture
def short(run):
    """The first rows of the run, for logs that need not be fitted."""
    return Run(*(values[:60] for values in run))


@pytest.fixture
def convert(tmp_path, capsys):
    """convert(path, option..) -> exit status, what was said, [rows of the CSV by column]."""
    def call(path, *options):
        output, status = tmp_path / "out.csv", 0
        output.unlink(missing_ok=True)
        try:
            cli.main([str(path), "-o", str(output), *options])
        except SystemExit as end:
            status = end.code
        said = capsys.readouterr()
        rows = np.genfromtxt(output, delimiter=",", names=True) if output.exists() else None
        assert (status == 0) == (rows is not None)
        return status, said.out + said.err, rows
    return call
