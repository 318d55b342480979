"""auvid-validate residuals and paper, from outside."""
import json
import os
import pathlib
import re
import subprocess

import can
import numpy as np
import pytest

from auvid_validation.cli import main
from auvid_validation.library import program, root
from auvid_validation.recorded import Log, Model, as_csv
from auvid_validation.residuals import agreement, whiteness

TANK = pathlib.Path(root(), os.environ.get("AUVID_TANK_DATA", "../shared/data/bluerov2_tank"))


def auvid(*arguments):
    subprocess.run([str(program()), *map(str, arguments)], check=True, capture_output=True)


def residuals(out, *arguments):
    """-> (exit status, numbers)"""
    with pytest.raises(SystemExit) as end:
        main(["residuals", *map(str, arguments), "--out", str(out)])
    return end.value.code, out / "residuals.json"


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """A CSV, one to validate on, and a log of the bus as .log, .asc and .blf."""
    at = tmp_path_factory.mktemp("logs")
    for name, seed in (("train", 1), ("test", 2)):
        auvid("demo", "--sets", 2, "--seed", seed, "--disturbance", 1, "--csv", at / f"{name}.csv")
    auvid("node", "--bus", "memory", "--excite", "--sets", 1, "--log", at / "bus.log")
    frames = list(can.LogReader(str(at / "bus.log")))
    for kind in ("asc", "blf"):
        with can.Logger(str(at / f"bus.{kind}")) as to:
            for frame in frames:
                to(frame)
    return at


def test_the_summary_has_r2_and_patterns_and_the_numbers_are_in_json(logs, tmp_path, capsys):
    status, path = residuals(tmp_path, logs / "train.csv", "--validate", logs / "test.csv",
                             "--both")
    said = capsys.readouterr().out
    assert not status and said.count("held-out R2") == 8 and said.count("pattern (p") + said.count(
        "pattern found (p") == 8 and len(list(tmp_path.glob("residuals_?.png"))) == 2
    for one in json.loads(path.read_text()):
        assert len(one["fit"]["parameters"]) == 13
        for symbol, value in one["judged"]["r2"].items():  # simulated twice, by two programs
            assert abs(value - one["fit"]["r2_validation"][symbol]) < 0.003


def test_frames_give_the_same_motion_in_every_format(logs, tmp_path):
    found = []
    for kind in ("log", "asc", "blf"):
        (tmp_path / kind).mkdir()
        found.append(as_csv(logs / f"bus.{kind}", tmp_path / kind).read_bytes())
    assert found[0] == found[1] == found[2] and found[0].count(b"\n") > 1500
    status, _ = residuals(tmp_path, logs / "bus.blf")
    assert not status


def change(path, to, edit):
    to.write_bytes(edit(path.read_bytes()))
    return to


BAD = {
    "no such file": ("there.csv", None, None),
    "no input column": ("x.csv", "train.csv", lambda b: b"\n".join(
        b",".join(line.split(b",")[:10]) for line in b.splitlines())),
    "not a finite number": ("x.csv", "train.csv",
                            lambda b: b.replace(b"\n0.220000,", b"\nnan,", 1)),
    "nothing to identify": ("x.csv", "train.csv", lambda b: b"\n".join(
        line if line.startswith(b"t_s") else line.split(b",")[0] + b",0" * 15
        for line in b.splitlines()) + b"\n"),
    "the row ends": ("x.csv", "train.csv", lambda b: b[:50000] + b"\n"),
    " line of": ("x.log", "bus.log", lambda b: b[:100000] + b"\n(1.0\n"),
    "is cut off": ("x.asc", "bus.asc", lambda b: b[:100000]),
    "x.blf: is cut off": ("x.blf", "bus.blf", lambda b: b[:-2000]),
    "no frame in it": ("x.asc", "bus.asc", lambda b: b"no log\n"),
    "cannot be read as blf": ("x.blf", "bus.log", lambda b: b),
    "no frame of auvid": ("x.log", "bus.log", lambda b: b"(1.000000) can0 123#11223344\n"),
}


@pytest.mark.parametrize("words", BAD)
def test_a_bad_log_gives_a_message_of_one_line_and_exit_status_2(words, logs, tmp_path, capsys):
    # `auvid fit` may have said before what is wrong with the log itself
    name, source, edit = BAD[words]
    path = change(logs / source, tmp_path / name, edit) if source else tmp_path / name
    status, _ = residuals(tmp_path / "out", path)
    *before, error = capsys.readouterr().err.splitlines()
    assert status == 2 and words in error and name in error
    assert all(line.startswith(f"auvid: {path}: ") for line in before)


def test_a_velocity_that_is_always_zero_is_left_out_and_said(logs, tmp_path, capsys):
    path = change(logs / "train.csv", tmp_path / "x.csv", lambda b: b"\n".join(
        line if line.startswith(b"t_s") else b",".join(
            b"0" if i == 6 else cell for i, cell in enumerate(line.split(b",")))
        for line in b.splitlines()) + b"\n")
    status, _ = residuals(tmp_path / "out", path)
    assert status == 0 and "w_mps is always 0" in capsys.readouterr().err


def test_a_log_with_a_byte_order_mark_is_read(logs, tmp_path):
    marked = change(logs / "train.csv", tmp_path / "x.csv", lambda b: b"\xef\xbb\xbf" + b)
    assert not residuals(tmp_path / "out", marked)[0]


@pytest.mark.parametrize("name", ["train.csv", "bus.log"])
def test_a_log_with_a_truncated_last_line_is_used_up_to_there_with_a_warning(
        name, logs, tmp_path, capsys):
    cut = change(logs / name, tmp_path / name, lambda b: b[:-5])
    assert not residuals(tmp_path / "out", cut)[0]
    assert "warning: " in (said := capsys.readouterr().err) and "the last line" in said


def test_can_fd_frames_in_a_log_are_skipped(logs, tmp_path):
    with can.Logger(str(tmp_path / "fd.asc")) as to:
        for frame in can.LogReader(str(logs / "bus.log")):
            to(frame)
            to(can.Message(frame.timestamp, 0x404, False, is_fd=True, data=bytes(64)))
    assert as_csv(tmp_path / "fd.asc", tmp_path).read_bytes() == \
        as_csv(logs / "bus.asc", tmp_path).read_bytes()


def test_a_log_too_short_to_validate_on_gives_a_message(logs, tmp_path, capsys):
    short = change(logs / "test.csv", tmp_path / "s.csv",
                   lambda b: b"".join(b.splitlines(True)[:6]))
    status, _ = residuals(tmp_path / "out", logs / "train.csv", "--validate", short)
    assert status == 2 and "s.csv: nothing to validate on" in capsys.readouterr().err


def test_both_needs_two_logs(logs, tmp_path, capsys):
    assert residuals(tmp_path, logs / "train.csv", "--both")[0] == 2


def test_the_two_logs_of_one_vehicle_agree_and_of_a_changed_one_do_not(logs, tmp_path, capsys):
    names, *rows = [line.split(",") for line in (logs / "test.csv").read_text().splitlines()]
    wrench = [name[-2:] in ("_N", "Nm") for name in names]
    heavier = [[str(1.4 * float(x)) if w else x for x, w in zip(row, wrench)] for row in rows]
    other = tmp_path / "other.csv"  # of a vehicle with 1.4 times the mass and drag
    other.write_text("".join(",".join(row) + "\n" for row in [names, *heavier]))
    for name, differ in ((logs / "test.csv", set()), (other, {"m_u", "m_v", "m_w", "m_r"})):
        status, path = residuals(tmp_path, logs / "train.csv", "--validate", name, "--both")
        a, b = json.loads(path.read_text())
        said = re.search(r"Do the two logs agree\? (Yes|No): (.*)", capsys.readouterr().out)
        differing = {p["name"] for p, q in zip(a["fit"]["parameters"], b["fit"]["parameters"])
                 if abs(p["estimate"] - q["estimate"]) > 2.1 * np.hypot(p["sigma"], q["sigma"])}
        assert not status and differ <= differing and bool(differing) == (said[1] == "No")
        assert differing == {p["name"] for p in a["fit"]["parameters"]
                         if re.search(rf"\b{p['name']}\b", said[2])}


def estimates(log, **of):
    """What agreement() reads of a log: (estimate, standard error) of each parameter."""
    return {"log": log, "fit": {"parameters": [
        {"name": name, "estimate": one[0], "sigma": one[1]} for name, one in of.items()]}}


def test_agreement_uses_the_joint_half_width():
    a = estimates("a.csv", m_u=(250.0, 3.0), X_u=(-42.0, 2.0), m_r=(75.0, None))
    near = estimates("b.csv", X_u=(-51.0, 4.0), m_u=(256.0, 3.0), m_r=(90.0, 1.0))
    far = estimates("b.csv", X_u=(-52.0, 4.0), m_u=(256.0, 3.0), m_r=(90.0, 1.0))
    assert "Yes: " in agreement([a, near]) and "all 2 parameters" in agreement([a, near])
    assert "No: X_u differs" in agreement([a, far])
    assert "m_r" not in agreement([a, far])
    nothing = agreement([a, estimates("b.csv", m_r=(75.0, 1.0))])
    assert "Yes" not in nothing and "No: " not in nothing and "Unknown: " in nothing


def test_white_noise_is_white_and_a_lasting_error_is_not():
    noise = np.random.default_rng(1).standard_normal((200, 400))
    false = sum(whiteness(one)["p"] < 0.05 for one in noise)
    assert 2 <= false <= 20  # 10 +- 3 standard deviations
    assert whiteness(noise[0, 1:] + 0.5 * noise[0, :-1])["p"] < 1e-3
    assert whiteness(np.zeros(400)) is None


def test_a_velocity_without_a_model_is_taken_from_the_record_and_a_gap_restarts(logs):
    log = Log(logs / "train.csv")
    log.t = log.t + (np.arange(len(log.t)) > 1000)
    parameters = [{"name": name, "estimate": value} for name, value in
                  (("m_u", 250.0), ("X_u", -42.0), ("X_uu", -125.0))]
    found = {"model": "Girona500, decoupled", "parameters": parameters,
             "delay_s": dict.fromkeys("XYZN")}
    out = Model(found, log).whole()
    assert np.array_equal(out[:, 1:], log.velocity[:, 1:])
    assert np.array_equal(out[[0, 1001], 0], log.velocity[[0, 1001], 0])
    assert not np.array_equal(out[:, 0], log.velocity[:, 0])


@pytest.mark.skipif(not (TANK / "run_a.csv").exists(), reason="no tank data")
def test_the_tank_data_both_directions(tmp_path):
    status, path = residuals(tmp_path, TANK / "run_a.csv", "--validate", TANK / "run_b.csv",
                             "--both", "--bias")
    assert not status
    # least squares of the same model, each axis alone, with a bias
    for one, reached in zip(json.loads(path.read_text()),
                            ((0.956, 0.946, 0.908), (0.90, 0.90, 0.86))):
        for symbol, baseline in zip("uvw", reached):
            assert one["fit"]["r2_validation"][symbol] > baseline - 0.04
            assert abs(one["judged"]["r2"][symbol] - one["fit"]["r2_validation"][symbol]) < 0.01


def test_the_papers_experiment_in_short(tmp_path, capsys):
    with pytest.raises(SystemExit) as end:
        main(["paper", "--sets", "4", "--validations", "2", "--starts", "1", "--out",
              str(tmp_path)])
    assert not end.value.code and "PASS" in capsys.readouterr().out
    numbers = json.loads((tmp_path / "paper.json").read_text())
    assert numbers["r2"]["largest_gap"] <= 0.002
    assert numbers["rms_percent"]["auvid"] < 4 < numbers["rms_percent"]["literal"]
    assert {p.stem for p in tmp_path.glob("*.png")} == {"velocities", "convergence", "cost",
                                                        "initialisation"}


@pytest.mark.parametrize("arguments", [
    ("paper", "--sets", "1"), ("paper", "--seed", "-1"), ("paper", "--out", "/dev/null/there"),
    ("paper", "--disturbance", "-1"), ("paper", "--sets", "100"), ("residuals",),
])
def test_bad_options_give_a_message_of_one_line(arguments, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("AUVID_ROOT", str(root()))
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2 and capsys.readouterr().err.count("\n") == 1


def test_between_samples_velocity_is_linear_inputs_are_held_and_a_lost_velocity_is_a_gap(tmp_path):
    rows = ["t_s,u_mps,X_N"]
    for k in range(40):
        sample = k % 2 == 0 and not 10 < k < 30
        rows.append(f"{0.1 * k:.1f},{k if sample else ''},{k if k % 4 == 0 else ''}")
    (path := tmp_path / "x.csv").write_text("\n".join(rows) + "\n")
    log = Log(path)
    assert np.allclose(log.velocity[:, 0], 10 * log.t)
    assert np.allclose(log.input[:, 0], np.round(10 * log.t) // 4 * 4)
    assert [log.t[p][-1] for p in log.pieces] == pytest.approx([1.0, 3.8])
