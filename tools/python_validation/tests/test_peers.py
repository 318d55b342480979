"""peers.py: the same cost for all, every evaluation counted, a lower minimum noticed."""
import importlib.metadata
import itertools
import time

import numpy as np
import pytest

from auvid_validation import optimizer_peers, peers, peers_record
from auvid_validation.library import root
from auvid_validation.optimizer_problem import Capped


def test_installed_packages_are_those_of_the_list():
    lines = (root() / "tools/python_validation/requirements.txt").read_text().splitlines()
    pinned = dict(line.split("==") for line in lines if not line.startswith("#"))
    assert {"nlopt", "scipy", "cma", "Py-BOBYQA"} <= set(pinned)
    assert pinned == {name: importlib.metadata.version(name) for name in pinned}


@pytest.fixture(scope="module")
def record():
    return peers_record.Record(peers_record.dead_band, 7, time.process_time)


@pytest.mark.parametrize("vehicle", [peers_record.in_current, peers_record.with_thrusters])
def test_squares_of_the_residuals_are_the_cost_and_the_estimate_is_at_a_minimum(vehicle):
    r = peers_record.Record(vehicle, 7, time.process_time)
    for x in np.random.default_rng(1).uniform(-1, 1, (5, len(r.low))):
        assert r.squares(x) == pytest.approx(r.cost(x), rel=1e-5)
    r.lowest = np.inf
    least = r.cost(r.found)
    for step in np.vstack([np.eye(len(r.low)), -np.eye(len(r.low))]):
        assert r.cost(r.found + 0.02 * step) > least


def test_each_difference_of_residuals_is_counted_and_the_cap_ends_the_search(record):
    box = np.ones(len(record.low))
    counted = peers.Residuals(record, box, -np.inf, 20)
    with pytest.raises(Capped):
        optimizer_peers.restarted(optimizer_peers.least_squares)(counted, box, 0)
    assert counted.evaluations == 20


def test_a_jacobian_takes_one_evaluation_for_each_parameter():
    points = []

    def residuals(x):
        points.append(x.copy())
        return x - 0.25
    optimizer_peers.least_squares(residuals, np.ones(3), 0)
    assert len({tuple(x) for x in points}) == len(points) and len(points) > 4
    assert np.allclose([np.abs(x - points[0]).sum() for x in points[1:4]], 1e-3)


def test_a_restarted_search_has_another_seed_each_time():
    seeds = []

    def search(_, __, seed):
        seeds.append(seed)
        if len(seeds) == 3:
            raise Capped
    with pytest.raises(Capped):
        optimizer_peers.restarted(search)(None, None, 5)
    assert len(set(seeds)) == 3


def test_work_of_the_search_on_board_never_falls_and_counts_each_point(record):
    work = [w for w, _, _ in record.history]
    assert work == sorted(work) and all(w >= k for k, w in enumerate(work[:-1], 1))
    e = record.identifier.estimate
    assert work[-1] >= e.evaluations_crs + e.evaluations_line > 0.9 * len(work)


def test_a_lower_minimum_of_another_optimizer_fails_auvid_and_renews_the_goal(record, monkeypatch):
    least, runs = record.cost(record.found), itertools.count()

    def lower(*_):
        next(runs)
        record.lowest = min(record.lowest, 0.9 * least)
    monkeypatch.setattr(peers, "PEERS", {"lower": (lower, "", "")})
    told, excess = peers.compare(record, 10, 0)
    assert next(runs) == 2  # with the goal of auvid, and with the lower one
    assert told[peers.END][0] is None and told[peers.OURS][0] is None
    assert excess == pytest.approx(1 / 0.9 - 1, rel=1e-3)
