"""The Cramer-Rao bound of a recorded run: the best accuracy of any unbiased estimator.

Known: applied wrench, phi, theta, p, q, and the covariance of the unmodelled force (2 s). Unknown:
the 13 parameters, the initial velocities, the initial depth. Measured: velocity (DVL), yaw rate,
depth. Linearised about the motion without the unmodelled force,
x = [u v w r depth | that force's X Y Z N]:
    x(k+1) = Phi(k) x(k) + Gamma(k) pi + w(k),   y = x_i + noise,
and E, the error of this system's Kalman filter per unit of each unknown:
    tick: E <- Phi E + Gamma;   measurement: information += E_i' E_i / s, then E <- E - K E_i.
An additional column carries the measurements of the run: their whitened innovations have variance
one if the assumed noise is correct. tests/reference/bound.h computes the same bound independently
in C++. Both ignore the information in the covariance of the measurements.
"""
import numpy as np

from auvid_validation.model import regressor, simulate
from auvid_validation.world import N, TICK_S

YAW_RATE, DEPTH, FORCE, STATES, INITIAL = 3, 4, 5, 9, 5
UNKNOWNS = N + INITIAL


def linearised(run, motion):
    """Phi [n, 9, 9] and Gamma [n, 9, 13] of the ticks that end at 1 .. n; parameters relative."""
    pi, config = run.true_pi, run.config.sim
    tilt = (run.tilt[1:] + run.tilt[:-1]) / 2
    nu = (motion[1:, :4] + motion[:-1, :4]) / 2
    rate = (motion[1:, :4] - motion[:-1, :4]) / TICK_S
    mobility, step = 1 / pi[:4], 1e-3
    a = np.zeros((len(nu), STATES, STATES))
    for i in range(4):  # nearly all terms are quadratic: the difference is exact
        by = step * np.eye(4)[i]
        change = (regressor(tilt, nu + by, rate) - regressor(tilt, nu - by, rate)) @ pi
        a[:, :4, i] = -mobility * change / (2 * step)
        a[:, i, FORCE + i] = mobility[i]
        a[:, FORCE + i, FORCE + i] = -1 / config.disturbance_s
    phi, theta = tilt[:, 0], tilt[:, 1]
    a[:, DEPTH, 0] = -np.sin(theta)
    a[:, DEPTH, 1] = np.cos(theta) * np.sin(phi)
    a[:, DEPTH, 2] = np.cos(theta) * np.cos(phi)
    a *= TICK_S
    series = np.eye(STATES) + a / 2 + a @ a / 6
    b = np.zeros((len(nu), STATES, N))
    b[:, :4] = -mobility[:, None] * regressor(tilt, nu, rate) * pi
    return np.eye(STATES) + a @ series, TICK_S * series @ b


def samples(run):
    """[(state, value), ...] of each tick."""
    found = [[] for _ in run.t]
    for state, (ticks, seen) in enumerate(run.measured()):
        for k, value in zip(ticks.tolist(), seen.tolist()):
            found[k].append((state, value))
    for k in np.flatnonzero(run.seen["depth"]["present"]).tolist():
        found[k].append((DEPTH, float(run.seen["depth"]["depth_m"][k])))
    return found


def bound(run):
    """-> (standard deviations [13] relative to the parameters, mean square of the whitened
    innovations) of a run until its last set is complete."""
    config = run.config.sim
    start = [*run.nu[0], run.truth["position"][0][2]]
    motion = simulate(run.true_pi, run.tilt, run.wrench, TICK_S, start)
    deviation = [config.dvl_m_s] * 3 + [config.imu_rate_rad_s, config.depth_m]
    noise = np.square(deviation).tolist()
    force = np.array([config.disturbance_N] * 3 + [config.disturbance_Nm]) ** 2
    driving = (1 - np.exp(-2 * TICK_S / config.disturbance_s)) * force
    phi, gamma = linearised(run, motion)
    e = np.zeros((STATES, UNKNOWNS + 1))
    e[:INITIAL, N:UNKNOWNS] = np.eye(INITIAL)
    c, rows = np.zeros((STATES, STATES)), []
    forces = np.arange(FORCE, STATES)
    c[forces, forces] = force
    measured = samples(run)
    for k in range(1, run.complete):
        e = phi[k - 1] @ e
        e[:, :N] += gamma[k - 1]
        c = phi[k - 1] @ c @ phi[k - 1].T
        c[forces, forces] += driving
        for state, value in measured[k]:
            row = e[state].copy()
            row[-1] += value - motion[k, state]
            s = c[state, state] + noise[state]
            gain = c[:, state] / s
            rows.append(row / np.sqrt(s))
            e -= np.outer(gain, row)
            c -= np.outer(gain, gain * s)
    total = np.transpose(rows) @ rows
    information = total[:UNKNOWNS, :UNKNOWNS]
    scale = 1 / np.sqrt(np.diag(information))  # initial values are known much less accurately
    variance = np.diag(np.linalg.inv(information * np.outer(scale, scale))) * scale ** 2
    return np.sqrt(variance[:N]), total[-1, -1] / len(rows)
