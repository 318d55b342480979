"""Real logs: what is said of them, and the kinematic identities that a wrong axis would break."""
import types

import numpy as np
import pytest

from auvid import tlog
from auvid.series import Series
from auvid.streams import streams_of
from conftest import DIVES
from log_writers import matrix

pytestmark = pytest.mark.skipif(not DIVES.exists(), reason="no real logs here")
GPS = "no DVL (VISO), EK3_SRC1_VELXY=3: velocity is of GPS at the surface"


def test_the_dataflash_log_is_of_a_vehicle_at_rest_without_a_dvl(convert):
    status, said, rows = convert(DIVES / "ardusub_small.BIN")
    assert status == 0 and len(rows) > 1000
    assert GPS in said and "vehicle at rest: nothing to identify" in said
    assert "velocity: XKF1, filtered" in said and "thruster commands at" not in said
    assert "LOG_BITMASK=176127 (it is 176126)" in said and "LOG_DISARMED=1" in said


def test_the_telemetry_log_has_commands_at_2_hz(convert):
    status, said, _ = convert(DIVES / "ardusub_small.tlog")
    assert status == 0 and GPS in said and "at rest:" not in said
    assert "thruster commands at 2 Hz in a .tlog: use the .BIN, 10 Hz" in said


def agreement(predicted, measured):
    """Gain and correlation of what an identity predicts and of what was measured."""
    return (np.sum(predicted * measured) / np.sum(predicted ** 2),
            np.corrcoef(predicted, measured)[0, 1])


def identities(recording):
    """-> {name: (gain, correlation)} of d(phi, theta, psi)/dt, and of the rate of the position."""
    by_name = {s.columns[0]: s.between(-np.inf, np.inf) for s in streams_of(recording)}
    (t, angle), (_, rate) = by_name["phi_rad"], by_name["p_radps"]
    angle = np.unwrap(angle, axis=0)
    p, q, r = ((rate[1:] + rate[:-1]) / 2).T
    phi, theta, _ = ((angle[1:] + angle[:-1]) / 2).T
    yawing = q * np.sin(phi) + r * np.cos(phi)
    euler = [p + yawing * np.tan(theta), q * np.cos(phi) - r * np.sin(phi), yawing / np.cos(theta)]
    turned = (np.diff(angle, axis=0) / np.diff(t)[:, None]).T
    (t_place, place), (t_body, body) = by_name["north_m"], by_name["u_mps"]
    attitude = np.column_stack([np.interp(t_body, t, a) for a in angle.T])
    ned = np.einsum("nij,nj->ni", matrix(attitude), body)
    moved = (np.diff(place, axis=0) / np.diff(t_place)[:, None]).T
    return {name: agreement(a, b) for name, a, b in zip(
        ("phi", "theta", "psi", "x", "y", "z"), [*euler, *((ned[1:] + ned[:-1]) / 2).T],
        [*turned, *moved])}


def broken(recording):
    """Names of the identities that do not hold. At the surface the filter corrects the position by
    GPS, so of its rate only the sign is tested (correlation, of 791 steps)."""
    return [name for name, (gain, correlation) in identities(recording).items() if not (
        correlation > 0.3 if name in "xyz" else 0.9 < gain < 1.1 and correlation > 0.9)]


@pytest.fixture(scope="module")
def telemetry():
    return tlog.read(DIVES / "ardusub_small.tlog", types.SimpleNamespace(only=None))


def test_the_identities_hold_on_the_telemetry_log(telemetry):
    assert broken(telemetry) == []


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("name", ["attitude", "rates", "velocity_ned", "position"])
def test_a_reader_with_one_axis_flipped_breaks_an_identity(name, axis, telemetry):
    right, wrong = telemetry.series[name], Series(name, telemetry.series[name].columns)
    signs = np.where(np.arange(3) == axis, -1.0, 1.0)
    for t, values in zip(right.times, right.values * signs):
        wrong.add(t, values)
    telemetry.series[name] = wrong
    found = broken(telemetry)
    telemetry.series[name] = right
    assert found
