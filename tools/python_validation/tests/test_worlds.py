"""worlds.py: the physics of the other simulator, its logs, and what is judged."""
import argparse
import json

import numpy as np
import pytest

from auvid_validation import worlds, worlds_judge, worlds_motions, worlds_sensors, worlds_vehicles
from auvid_validation.cli import main
from auvid_validation.library import program
from auvid_validation.worlds_physics import coriolis, hull_force, rk4, rotation, thruster_force


def at_rest(name, seed=1):
    """Vehicle, hull without weight in water, thrusters, still water, state."""
    vehicle, rng = worlds_vehicles.VEHICLES[name], np.random.default_rng(seed)
    hull = worlds_vehicles.draw_hull(vehicle, rng, False)
    hull = hull._replace(buoyancy=hull.weight)
    thrusters = worlds_vehicles.draw_thrusters(vehicle, hull, rng, False, False)
    water, _ = worlds_motions.draw_water(vehicle, rng, True)
    y = np.zeros(13 + len(thrusters.forward))
    y[2], y[3] = 20, 1
    return vehicle, hull, thrusters, water, y


def energy(hull, y):
    """Kinetic, with that of the added mass, and potential of the righting moment."""
    arm = hull.r_g * hull.weight - hull.r_b * hull.buoyancy
    return (0.5 * y[7:13] @ (hull.m_rb + hull.m_a) @ y[7:13] - arm @ rotation(y[3:7])[2]
            + np.linalg.norm(arm))


def drift(hull, thrusters, water, y):
    """Energies of 20 s without thrust, relative to the first."""
    still = thrusters._replace(k_a=0.0, k_b=0.0)  # the propellers do not windmill
    y[7:13] = 0.4, 0.3, -0.3, 0.2, 0.2, -0.4
    energies = [energy(hull, y)]
    for k in range(1000):
        y = rk4(hull, still, water, k * 0.02, y, np.zeros(len(still.forward)), 0.02)[0]
        energies.append(energy(hull, y))
    return np.array(energies) / energies[0]


@pytest.mark.parametrize("name", "ABCD")
def test_energy_does_not_grow_without_thrust(name):
    energies = drift(*at_rest(name)[1:])
    assert np.diff(energies).max() < 1e-6 and energies[-1] < 0.8


@pytest.mark.parametrize("name", "ABCD")
def test_energy_is_kept_without_drag(name):
    _, hull, thrusters, water, y = at_rest(name)
    bare = hull._replace(linear=0 * hull.linear, quadratic=0 * hull.quadratic, area=0 * hull.area,
                         lift=0.0, munk=0.0, fin=0.0)
    assert np.abs(drift(bare, thrusters, water, y) - 1).max() < 1e-3


@pytest.mark.parametrize("name", "ABCD")
def test_thrust_and_drag_balance_at_terminal_velocity(name):
    vehicle, hull, thrusters, water, y = at_rest(name)
    hull = hull._replace(r_g=np.array([0, 0, 5.0]), r_b=np.zeros(3))  # keeps its attitude
    target = 0.5 * np.sign(np.round(worlds_vehicles.allocation(vehicle)[:, 0], 2))
    for _ in range(6000):
        y, nu_dot, nu_r, _ = rk4(hull, thrusters, water, 0.0, y, target, 0.02)
    thrust = thruster_force(thrusters, hull, y[13:], nu_r)[0]
    drag = hull_force(hull, nu_r)[0] - coriolis(hull.m_rb + hull.m_a, nu_r)[0]
    assert y[7] > 0.3 and thrust > 1
    assert abs(thrust + drag) < 0.02 * thrust and abs(nu_dot[0]) < 0.02


def test_the_same_seed_gives_the_same_log_byte_for_byte(tmp_path):
    for k, seed in enumerate((1, 1, 2)):
        worlds_sensors.write_csv(tmp_path / str(k), worlds.dive("D", "joystick", seed)[0])
    first, same, other = ((tmp_path / str(k)).read_bytes() for k in range(3))
    assert first == same and first != other


@pytest.mark.parametrize("name", "AC")
def test_a_perfect_world_is_recovered_and_called_open_loop(name, tmp_path):
    (tmp_path / f"{name}.ini").write_text(worlds_vehicles.vehicle_file(name))
    options = argparse.Namespace(off=worlds.PARTS, told=False, fit="", keep=False)
    run = worlds.one((name, "excited", 1), options, program(), tmp_path)
    masses = [row for row in run["parameters"] if row["name"].startswith("m_")]
    assert len(masses) == 4 and all(abs(row["error_percent"]) < 5 for row in masses)
    assert not run["closed_loop"] and not run["held"] and not run["refused"]
    assert not any(row["wrong"] for row in run["parameters"] + run["drags"])
    assert not list(tmp_path.glob("*.csv"))


def test_the_common_scale_of_a_torpedo_does_not_drift(tmp_path):
    (tmp_path / "D.ini").write_text(worlds_vehicles.vehicle_file("D"))
    options = argparse.Namespace(off=worlds.PARTS, told=True, fit="", keep=False)
    rows = worlds.one(("D", "excited", 2003), options, program(), tmp_path)["parameters"]
    masses = [row for row in rows if row["name"] in ("m-X_udot", "m-Y_vdot", "m-Z_wdot")]
    assert len(masses) == 3 and all(abs(row["error_percent"]) < 8 for row in masses)
    assert sum(row["identifiable"] for row in rows) >= 10


def test_an_answer_is_wrong_if_it_is_far_off_by_a_force_that_matters():
    true = {"parameters": {"m_u": 10.0}, "speed": {"X": 1.0}, "acceleration": {"X": 0.5},
            "thrust": {"X": 40.0}, "tilt": 0.1}  # 2 % of the thrust are 0.8 N

    def wrong(estimate, true=true):
        answer = {"name": "m_u", "dof": "surge", "kind": "mass", "estimate": estimate,
                  "identifiable": True, "note": ""}
        return worlds_judge.judged_parameters({"parameters": [answer]}, true)[0]["wrong"]
    assert wrong(12.1) and wrong(7.9) and not wrong(11.9)
    assert not wrong(12.1, true | {"acceleration": {"X": 0.3}})


def test_a_drag_force_is_judged_by_that_of_its_direction():
    v, ahead, astern = np.linspace(-1, 1, 41), [-10.0, -30.0], [-12.0, -36.0]
    drags = np.where(v > 0, *((a + b * np.abs(v)) * v for a, b in (ahead, astern)))
    for part, true in (v > 0, ahead), (v < 0, astern):
        assert worlds_judge.best_drags(v[part], drags[part]) == pytest.approx(true)
    true = {"one_way": {"X": [ahead, astern]}, "thrust": {"X": 40.0}}

    def wrong(speed, force):
        point = {"speed": speed, "force": force, "identifiable": True}
        found = {"drag": {"X": [point] * 3}}
        return [row["wrong"] for row in worlds_judge.judged_drags(found, true)]
    assert wrong(0.5, -12.5) == [False] and wrong(0.5, -15.1) == [True]
    assert wrong(-0.5, 15.0) == [False] and wrong(-0.5, 11.9) == [True]


def test_shares_have_intervals_over_the_runs():
    value, low, high, whole = worlds_judge.share([1, 0, 2, 0], [10, 10, 10, 10])
    assert value == 0.075 and 0 <= low < value < high < 0.2 and whole == 40
    assert worlds_judge.share([0, 0, 0], [5, 0, 5])[:3] == pytest.approx([0, 0, 1 - 0.025 ** 0.5])
    assert worlds_judge.share([0, 0], [0, 0]) == [None, None, None, 0]


@pytest.mark.parametrize("arguments", [
    ("--seeds", "many"), ("--seeds", "2:1"), ("--vehicles", "A,E"), ("--motion", "nonsense"),
    ("--off", "nonsense"), ("--off", "hull", "--perfect"), ("--jobs", "0"),
    ("--json", "/nonsense/worlds.json"), ("--out", "/dev/null/nonsense"),
    ("--seeds", "1", "--vehicles", "D", "--motion", "single", "--auvid", "/nonsense/auvid"),
    ("--seeds", "1", "--vehicles", "D", "--motion", "single", "--fit=--nonsense")])
def test_a_user_error_is_one_line_and_exit_status_2(arguments, capsys):
    with pytest.raises(SystemExit) as left:
        main(["worlds", *arguments])
    shown = capsys.readouterr()
    assert left.value.code == 2 and shown.out == ""
    assert shown.err.startswith("auvid-validate") and shown.err.count("\n") == 1


def test_the_table_has_a_row_for_each_vehicle_and_motion_and_one_for_all(capsys, tmp_path):
    with pytest.raises(SystemExit) as left:
        main(["worlds", "--seeds", "1", "--vehicles", "C,D", "--motion", "single", "--told",
              "--jobs", "2", "--details", "--out", str(tmp_path), "--json", str(tmp_path / "json")])
    lines = capsys.readouterr().out.splitlines()
    assert left.value.code == 0
    assert [line.split(" | ")[0] for line in lines[2:5]] == ["| C single", "| D single", "| all"]
    assert {line.count("|") for line in lines[:5]} == {10} and any("| m_u |" in x for x in lines)
    assert set(json.loads((tmp_path / "json").read_text())["rows"]) == {"C single", "D single",
                                                                       "all"}
    assert (tmp_path / "D_single_1.csv").exists()
