"""world.py, model.py, bound.py, ukf.py: what paper and campaign are made of."""
import numpy as np
import pytest

from auvid_validation import girona500, ukf
from auvid_validation.bound import bound
from auvid_validation.model import derivative, r2, regressor, simulate
from auvid_validation.world import TICK_S, Run, identify

WORLD = {"seed": 5, "sets": 2, "disturbance_N": 1.0}


@pytest.fixture(scope="module")
def run():
    return Run(WORLD)


def test_equations_equal_those_of_the_matrices():
    random = np.random.default_rng(1)
    pi, tau = girona500.TRUTH, random.normal(0, 50, 6)
    phi, theta = random.normal(0, 0.3, 2)
    nu, nu_dot = random.normal(0, 1, 6), random.normal(0, 1, 6)
    dofs = girona500.DRIVEN
    y = regressor(np.array([[phi, theta, *nu[3:5]]]), nu[None, dofs], nu_dot[None, dofs])[0]
    assert np.allclose(y @ pi, girona500.wrench(pi, phi, theta, nu, nu_dot), rtol=1e-12)
    rate = derivative(pi, pi[:3], 1 / pi[:4], phi, theta, *nu[3:5], [*nu[dofs], 0], tau[dofs])
    assert np.allclose(rate[:4], girona500.acceleration(pi, phi, theta, nu, tau), rtol=1e-12)


def test_motion_simulated_with_the_truth_equals_the_simulator():
    run = Run(dict(WORLD, disturbance_N=0.0), work=False)
    out = simulate(run.true_pi, run.tilt, run.wrench, TICK_S, [*run.nu[0], 50])
    assert all(r2(run.nu[:, i], out[:, i]) > 1 - 1e-6 for i in range(4))


def test_an_observed_run_gives_the_same_estimate(run):
    estimate, truth = identify(WORLD)
    assert np.array_equal(estimate.pi, run.estimate.pi)
    assert np.array_equal(estimate.sigma, run.estimate.sigma)
    assert np.array_equal(truth, girona500.TRUTH)
    assert [e.sets for e in run.estimates][-1] == 2


def test_a_misspelt_world_is_refused():
    with pytest.raises(ValueError, match="sed"):
        identify({"sed": 1})


def test_one_degree_of_freedom_after_the_other_takes_as_long():
    run = Run({"seed": 1, "sets": 4, "one_by_one": True}, work=False)
    during = run.t < 25
    moved = [np.ptp(run.wrench[during, i]) > 1 for i in range(4)]
    assert sum(moved) == 1 and all(np.ptp(run.wrench[:, i]) > 1 for i in range(4))


def test_the_noise_of_the_bound_is_that_of_the_run_and_the_bound_scales_with_it(run):
    full, innovations = bound(run)
    assert abs(innovations - 1) < 0.04  # 4 standard errors of 22000 measurements
    names = ["dvl_m_s", "imu_rate_rad_s", "depth_m", "disturbance_N", "disturbance_Nm"]
    for name in names:  # the same run, held against half of its noise
        setattr(run.config.sim, name, getattr(run.config.sim, name) / 2)
    half, innovations = bound(run)
    for name in names:
        setattr(run.config.sim, name, getattr(run.config.sim, name) * 2)
    assert np.allclose(half, full / 2, rtol=1e-6)
    assert abs(innovations - 4) < 0.16


def test_the_filter_finds_the_parameters_from_near_the_truth(run):
    end = ukf.joint(run, 1.1 * run.true_pi, 0.2 * np.abs(run.true_pi))
    assert np.all(np.abs(end / run.true_pi - 1) < 0.2)


def test_the_equations_of_the_filter_are_those_of_the_model():
    random = np.random.default_rng(2)
    pi, nu, tilt, tau = girona500.TRUTH, *(random.normal(0, 0.5, 4) for _ in range(3))
    expected = derivative(pi, pi[:3], 1 / pi[:4], *tilt, [*nu, 0], tau)[:4]
    assert np.allclose(ukf.acceleration(np.r_[nu, pi], tilt, tau), expected, rtol=1e-12)
