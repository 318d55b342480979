"""From a motion to the log of `auvid fit`: IMU, DVL, depth, and the thrust that the firmware
supplies. An empty cell is no new sample."""
import numpy as np

from auvid_validation.worlds_pilot import ATTITUDE, FORCES, NU

ROW_S = 0.04
FORMATS = {"t_s": "%.3f", "depth_m": "%.2f"}


def gauss_markov(rng, n, dt, sigma, tau):
    a = np.exp(-dt / tau)
    e = rng.normal(0, sigma * np.sqrt(1 - a * a), n)
    e[0] = rng.normal(0, sigma)
    for i in range(1, n):
        e[i] += a * e[i - 1]
    return e


def matrices(attitude):
    """From body to NED of ZYX angles, one in each row."""
    c, s = np.cos(attitude.T), np.sin(attitude.T)
    return np.moveaxis(np.array([
        [c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]],
        [s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]],
        [-s[1], c[1] * s[0], c[1] * c[0]]]), 2, 0)


def navigation_noise(rng, n, dt, perfect):
    """Errors of what the autopilot sees: position, attitude and velocity."""
    e = np.zeros((n, 12))
    if not perfect:
        for i, sigma in enumerate((0.05, 0.05, 0.02)):
            e[:, i] = gauss_markov(rng, n, dt, sigma, 5.0)
        for i in range(3, 6):
            e[:, i] = gauss_markov(rng, n, dt, 0.005, 20.0)
        e[:, 6:] = rng.normal(0, (0.01, 0.01, 0.01, 0.004, 0.004, 0.004), (n, 6))
    return e


def interpolated(times, t, columns):
    return np.array([np.interp(times, t, c) for c in columns.T]).T


def record_imu(rng, attitude, rate, e):
    """Attitude and rates with the errors of mounting, filter, bias and noise, times e."""
    n = len(attitude)
    mount = matrices(e * rng.normal(0, np.radians(0.8), (1, 3)))[0]
    m = matrices(attitude) @ mount
    seen = np.c_[np.arctan2(m[:, 2, 1], m[:, 2, 2]), -np.arcsin(m[:, 2, 0]),
                 np.arctan2(m[:, 1, 0], m[:, 0, 0])]
    wander = [gauss_markov(rng, n, ROW_S, *x) for x in ((0.3, 90), (0.3, 90), (1.0, 200))]
    seen += e * np.radians(np.array(wander).T)
    seen += e * np.radians(rng.normal(0, 0.06, (n, 3)))
    bias = rng.normal(0, 0.08, (1, 3))
    return seen, rate @ mount + e * np.radians(bias + rng.normal(0, 0.12, (n, 3)))


def record_dvl(rng, ping, nu, t, rate, e):
    """Velocity at each ping, and the row of the log at which it arrives: the DVL has its own frame
    and place, and is corrected by the lever arm of the drawing. Row -1: it is lost."""
    lever = rng.normal(0, (0.15, 0.03, 0.08))
    error = e * rng.normal(0, 0.015, 3)
    v = nu[:, :3] + np.cross(nu[:, 3:], lever + error)
    v = v @ matrices(e * rng.normal(0, np.radians(0.7), (1, 3)))[0]
    v = v * (1 + e * rng.normal(0, 0.004))
    sigma = rng.uniform(0.003, 0.01)
    v += e * rng.normal(0, 1, v.shape) * (sigma + 0.003 * abs(v))
    v -= np.cross(interpolated(ping, t, rate), lever)
    v += e * rng.normal(0, 0.4, v.shape) * (rng.random((len(v), 1)) < 0.001)
    lost = rng.random(len(v)) < 0.03
    for _ in range(2):
        lost |= abs(ping - rng.uniform(0, ping[-1])) < rng.uniform(0.5, 2)
    late = rng.uniform(0.03, 0.15) + rng.uniform(0, 0.02, len(v))
    row = np.searchsorted(t, ping + e * late)
    return v, np.where((row < len(t)) & ~(lost & (e > 0)), row, -1)


def record(motion, dt, rng, perfect):
    """Columns of the log by name. motion: of `simulate`."""
    e = 0.0 if perfect else 1.0
    t_true = np.arange(len(motion)) * dt
    t = np.arange(ROW_S, t_true[-1] - ROW_S, ROW_S)
    n = len(t)
    t = t + e * rng.uniform(-0.002, 0.002, n)
    attitude = interpolated(t, t_true, np.unwrap(motion[:, ATTITUDE], axis=0))
    rate = interpolated(t, t_true, motion[:, NU])[:, 3:]
    attitude, rate = record_imu(rng, attitude, rate, e)
    rows = {"t_s": t, "phi_rad": attitude[:, 0], "theta_rad": attitude[:, 1],
            "psi_rad": (attitude[:, 2] + np.pi) % (2 * np.pi) - np.pi}
    ping = np.arange(0.3, t_true[-1] - 1, 1 / rng.choice([4.0, 5.0, 5.0, 7.0]))
    v, row = record_dvl(rng, ping, interpolated(ping, t_true, motion[:, NU]), t, rate, e)
    for i, name in enumerate(("u_mps", "v_mps", "w_mps")):
        rows[name] = np.full(n, np.nan)
        rows[name][row[row >= 0]] = v[row >= 0, i]
    rows |= {name: rate[:, i] for i, name in enumerate(("p_radps", "q_radps", "r_radps"))}
    depth = np.interp(t, t_true, motion[:, 2])
    rows["depth_m"] = depth + e * (rng.normal(0, 0.01, n) + rng.normal(0, 0.05))
    rows["depth_m"][np.arange(n) % 4 > 0] = np.nan
    held = np.clip(np.floor(t / dt).astype(int), 0, len(motion) - 1)
    for i, force in enumerate(motion[held, FORCES].T):
        rows[f"thruster_{i + 1}_N"] = force
    return rows


def scale_fins(rows, speed):
    """A fin has its nominal force at a nominal speed: at another one its user scales by u^2."""
    known = ~np.isnan(rows["u_mps"])
    u = np.interp(rows["t_s"], rows["t_s"][known], rows["u_mps"][known])
    for name in ("thruster_2_N", "thruster_3_N"):
        rows[name] = rows[name] * np.maximum(u, 0) ** 2 / speed ** 2


def write_csv(path, rows):
    form = FORMATS | {k: "%.4f" for k in rows if "rad" in k or "mps" in k}
    columns = [[form.get(k, "%.2f") % x if x == x else "" for x in rows[k]] for k in rows]
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(rows) + "\n")
        file.writelines(",".join(cells) + "\n" for cells in zip(*columns))
