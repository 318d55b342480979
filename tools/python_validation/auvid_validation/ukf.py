"""A joint unscented Kalman filter: u v w r and the 13 parameters, as in the literature that the
paper refers to (van der Merwe and Wan 2001). It knows the noise of the sensors and the strength of
the unmodelled force, but not the parameters.
"""
import numpy as np

from auvid_validation.world import N, TICK_S

TICKS = 5  # a step is 0.1 s
STATES = 4 + N
ALPHA, BETA = 0.1, 2.0


def acceleration(x, tilt, wrench):
    """Eq. 12-15 for many sigma points at once; x: [17, points]."""
    (u, v, w, r), p = x[:4], x[4:]
    phi, theta, roll, pitch = tilt
    return np.array([
        (wrench[0] + p[1] * v * r - p[2] * w * pitch - p[4] * np.sin(theta)
         + (p[5] + p[6] * abs(u)) * u) / p[0],
        (wrench[1] + p[2] * w * roll - p[0] * u * r + p[4] * np.cos(theta) * np.sin(phi)
         + (p[7] + p[8] * abs(v)) * v) / p[1],
        (wrench[2] + p[0] * u * pitch - p[1] * v * roll + p[4] * np.cos(theta) * np.cos(phi)
         + (p[9] + p[10] * abs(w)) * w) / p[2],
        (wrench[3] + (p[0] - p[1]) * u * v + (p[11] + p[12] * abs(r)) * r) / p[3]])


def predicted(x, tilt, wrench, h):
    """Heun's rule."""
    k1 = acceleration(x, tilt, wrench)
    ahead = np.vstack([x[:4] + h * k1, x[4:]])
    return np.vstack([x[:4] + h / 2 * (k1 + acceleration(ahead, tilt, wrench)), x[4:]])


def joint(run, start, sigma):
    """Final parameters, or None if it diverges.

    start, sigma: [13] initial parameters and their standard deviations.
    """
    config, h = run.config.sim, TICKS * TICK_S
    lam = (ALPHA ** 2 - 1) * STATES
    mean_weight = np.full(2 * STATES + 1, 0.5 / (STATES + lam))
    weight = mean_weight.copy()
    mean_weight[0] = lam / (STATES + lam)
    weight[0] = mean_weight[0] + 1 - ALPHA ** 2 + BETA
    force = np.array([config.disturbance_N] * 3 + [config.disturbance_Nm])
    # white noise with the same long-term effect as the force
    driving = 2 * force ** 2 * config.disturbance_s * h / run.true_pi[:4] ** 2 + 1e-8
    noise = np.square([config.dvl_m_s] * 3 + [config.imu_rate_rad_s])
    (dvl, _), tilt = run.measured()[0], run.measured_tilt
    has_dvl = np.zeros(len(run.t), bool)
    has_dvl[dvl] = True
    seen = np.column_stack([run.seen["dvl"]["sample"]["velocity"],
                            run.seen["imu"]["rates"][:, 2]]).astype(float)
    x, c = np.r_[np.zeros(4), start], np.diag(np.r_[np.full(4, 1e-4), np.square(sigma)])
    first = int(dvl[0]) % TICKS
    with np.errstate(all="ignore"):
        for k in range(first + TICKS, run.complete, TICKS):
            try:
                root = np.linalg.cholesky((STATES + lam) * c)
            except np.linalg.LinAlgError:
                return None
            points = np.column_stack([x, x[:, None] + root, x[:, None] - root])
            step = slice(k - TICKS + 1, k + 1)
            points = predicted(points, tilt[step].mean(0), run.wrench[step].mean(0), h)
            if not np.all(np.isfinite(points)) or np.abs(points[:4]).max() > 1e4:
                return None
            x = points @ mean_weight
            off = points - x[:, None]
            c = (weight * off) @ off.T
            c[range(4), range(4)] += driving
            rows = [0, 1, 2, 3] if has_dvl[k] else [3]
            s = c[np.ix_(rows, rows)] + np.diag(noise[rows])
            gain = c[:, rows] @ np.linalg.inv(s)
            x = x + gain @ (seen[k, rows] - x[rows])
            c = c - gain @ s @ gain.T
            c = (c + c.T) / 2
    return x[4:] if np.all(np.isfinite(x)) else None


def starts(truth, random):
    """Initial values: name, (start, sigma) drawn again at each call."""
    def near(part):
        def draw():
            start = truth * (1 + part * random.uniform(-1, 1, N))
            return start, np.maximum(np.abs(start), 20) * part
        return draw

    def guess():
        return np.array([175, 175, 175, 50, 0] + [-10] * 8, float), np.full(N, 300.0)

    def signs():
        return np.sign(truth) * random.uniform(1, 1000, N), np.full(N, 577.0)

    def box():
        return random.uniform(-1000, 1000, N), np.full(N, 577.0)

    return {"truth +- 10 %": near(0.1), "truth +- 30 %": near(0.3), "truth +- 60 %": near(0.6),
            "dry mass, small drag": guess, "box, signs known": signs, "box": box}
