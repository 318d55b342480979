"""The navigation filter against filterpy, and against one written from the paper's Eq. 3-8 in
numpy, in double: Jacobians by complex steps, all measurements of an instant as one vector."""
import functools

import numpy as np
from filterpy.kalman import KalmanFilter
from scipy.spatial.transform import Rotation

from auvid_validation.compare import close
from auvid_validation.library import values

TICKS = 3000  # a minute
DVL_YAW, DVL_LEVER = np.radians(225.0), (-0.75, 0.1, 0.2)  # Girona500's, and off its axis


@functools.lru_cache(maxsize=1)  # the Jacobians of a tick have one attitude
def rotation(*angles):
    return Rotation.from_euler("ZYX", angles[::-1]).as_matrix()


def body_to_world(attitude):
    return rotation(*attitude)


def make_run(lib, rng):
    """Ticks of 15-25 ms, each (t_us, attitude, rates, {sensor: value}), rounded as auvid sees
    them; a third of the DVL's samples lack an axis."""
    t_us, run = 1_000_000, []
    for k in range(TICKS):
        t_us += int(rng.integers(15_000, 25_001))
        t = 1e-6 * t_us
        attitude = [0.1 * np.sin(0.9 * t), 0.08 * np.cos(0.7 * t), 2 * np.sin(0.05 * t) + 0.3]
        rates = [0.09 * np.cos(0.9 * t), -0.056 * np.sin(0.7 * t), 0.1 * np.cos(0.05 * t)]
        seen = {}
        if k % 10 == 9:
            velocity = np.array([0.5 * np.sin(0.2 * t), 0.3 * np.cos(0.3 * t), 0.1])
            seen["dvl"] = lib.array(velocity + 0.007 * rng.normal(size=3))
            seen["axes"] = 7 if k % 30 else int(rng.integers(1, 7))
        if k % 5 == 2:
            seen["depth"] = float(lib.real.type(50 + 0.1 * t + 0.015 * rng.normal()))
        if k % 50 == 49:
            seen["gps"] = lib.array(np.array([0.2 * t, -0.1 * t]) + 1.5 * rng.normal(size=2))
        run.append((t_us, lib.array(attitude), lib.array(rates), seen))
    return run


class Auvid:
    """The filter under test, and its output after each tick."""

    def __init__(self, lib):
        self.lib, self.config, self.nav = lib, lib.auvid_nav_config_t(), lib.auvid_nav_t()
        c = self.config
        lib.auvid_nav_defaults(c)
        c.gate, c.gps_start, c.surface_depth, c.speed_limit = 0, 0, 1e5, 0
        c.mount.dvl_euler[2] = DVL_YAW
        c.mount.dvl_lever[:] = DVL_LEVER
        for i, sigma in enumerate((0.5, 1.0, 0.7)):
            c.sigma_acceleration[i] = sigma
        assert lib.auvid_nav_init(self.nav, c) == 0

    def tick(self, t_us, attitude, rates, seen):
        lib, nav = self.lib, self.nav
        lib.auvid_nav_imu(nav, t_us, attitude, rates)
        if "dvl" in seen:
            sample = lib.auvid_dvl_sample_t(t_us=t_us, valid=seen["axes"])
            sample.velocity[:] = seen["dvl"].tolist()
            assert lib.auvid_nav_dvl(nav, sample) == 0
        if "depth" in seen:
            assert lib.auvid_nav_depth(nav, t_us, seen["depth"]) == 0
        if "gps" in seen:
            assert lib.auvid_nav_gps(nav, t_us, *map(float, seen["gps"])) == 0
        state, covariance = lib.auvid_nav_state_t(), lib.zeros(6, 6)
        lib.auvid_nav_state(nav, state)
        lib.auvid_nav_covariance(nav, covariance)
        said = {"x": np.r_[values(state.position), values(state.velocity)].astype(float),
                "p": covariance.astype(float)}
        if seen.get("axes") == 7:
            d = nav.diagnostics[lib.AUVID_NAV_DVL_BOTTOM]
            said["dvl"] = (values(d.innovation).astype(float), values(d.variance).astype(float),
                           d.nis)
        return said


class Model:
    """Shared by both references: numbers of the configuration, H and R of each sensor."""

    def __init__(self, config):
        self.sigma = values(config.sigma_acceleration).astype(float)
        self.tick_s = float(config.reference_tick)
        self.r = {"dvl": config.sigma_dvl**2, "depth": config.sigma_depth**2,
                  "gps": config.sigma_gps**2}
        self.mount = body_to_world(values(config.mount.dvl_euler).astype(float))
        self.lever = values(config.mount.dvl_lever).astype(float)
        self.x = np.zeros(6)
        self.p = np.diag([config.sigma_position**2] * 3 + [config.sigma_velocity**2] * 3)

    def noise(self, t):
        """Variances of n: Eq. 5's for ticks of tick_s, scaled so that the tick does not matter."""
        return np.diag(self.sigma**2 * self.tick_s / t)

    def dvl(self, rates, seen):
        """z and H in the instrument's axes: M'(v + omega x lever)."""
        axes = [j for j in range(3) if seen["axes"] >> j & 1]
        h = np.hstack([np.zeros((3, 3)), self.mount.T])[axes]
        turning = self.mount.T @ np.cross(rates.astype(float), self.lever)
        return (seen["dvl"].astype(float) - turning)[axes], h

    def restart_depth(self, p):
        p[2], p[:, 2], p[2, 2] = 0, 0, self.r["depth"]


def by_filterpy(model, run):
    """A tick at a time; linear in the state for a given attitude."""
    kf = KalmanFilter(dim_x=6, dim_z=3)
    kf.x, kf.P = model.x.copy(), model.p.copy()
    before, depth_known = None, False
    for t_us, attitude, rates, seen in run:
        if before is not None:
            t, r = 1e-6 * (t_us - before), body_to_world(attitude.astype(float))
            f = np.eye(6)
            f[:3, 3:] = r * t
            g = np.vstack([r * t**2 / 2, np.eye(3) * t])
            kf.predict(F=f, Q=g @ model.noise(t) @ g.T)
        before, said = t_us, {}
        if "dvl" in seen:
            z, h = model.dvl(rates, seen)
            # In body axes, as auvid gives a full sample's innovation.
            turn = model.mount if len(z) == 3 else np.eye(len(z))
            kf.update(turn @ z, R=np.eye(len(z)) * model.r["dvl"], H=turn @ h)
            if len(z) == 3:
                said["dvl"] = (kf.y, np.diag(kf.S), kf.y @ kf.SI @ kf.y)
        if "depth" in seen and not depth_known:
            depth_known, kf.x[2] = True, seen["depth"]
            model.restart_depth(kf.P)
        elif "depth" in seen:
            kf.update(np.array([seen["depth"]]), R=np.eye(1) * model.r["depth"],
                      H=np.eye(6)[2:3])
        if "gps" in seen:
            kf.update(seen["gps"].astype(float), R=np.eye(2) * model.r["gps"], H=np.eye(6)[:2])
        yield {"x": kf.x.copy(), "p": kf.P.copy(), **said}


def f(x, n, u, t):
    """Eq. 5, as printed."""
    r = body_to_world(u)
    return np.r_[x[:3] + r @ (x[3:] * t + n * t**2 / 2), x[3:] + n * t]


def jacobian(function, at):
    steps = 1e-30j * np.eye(len(at))
    return np.array([function(at + step).imag for step in steps]).T / 1e-30


def by_equations(model, run):
    """Eq. 3-8; the measurements of a tick make one z and H (Eq. 7)."""
    x, p, before, depth_known = model.x.copy(), model.p.copy(), None, False
    for t_us, attitude, rates, seen in run:
        if before is not None:
            t, u, none = 1e-6 * (t_us - before), attitude.astype(float), np.zeros(3)
            a = jacobian(lambda y: f(y, none, u, t), x)
            w = jacobian(lambda n: f(x, n, u, t), none)
            x, p = f(x, none, u, t), a @ p @ a.T + w @ model.noise(t) @ w.T
        before, parts = t_us, []
        if "dvl" in seen:
            parts.append((*model.dvl(rates, seen), model.r["dvl"]))
        if "gps" in seen:
            parts.append((seen["gps"].astype(float), np.eye(6)[:2], model.r["gps"]))
        if "depth" in seen and depth_known:
            parts.append(([seen["depth"]], np.eye(6)[2:3], model.r["depth"]))
        if parts:
            z, h = np.concatenate([q[0] for q in parts]), np.vstack([q[1] for q in parts])
            s = h @ p @ h.T + np.diag(np.concatenate([[q[2]] * len(q[0]) for q in parts]))
            k = np.linalg.solve(s, h @ p).T
            x, p = x + k @ (z - h @ x), (np.eye(6) - k @ h) @ p
        if "depth" in seen and not depth_known:
            depth_known, x[2] = True, seen["depth"]
            model.restart_depth(p)
        yield {"x": x.copy(), "p": p.copy()}


def of_deviations(theirs):
    """sqrt(P_ii P_jj): what an entry of P is small or large against."""
    d = np.sqrt(np.diagonal(theirs["p"], axis1=-2, axis2=-1))
    return d[:, None] * d[None, :]


def comparisons(lib):
    auvid = Auvid(lib)
    run = make_run(lib, np.random.default_rng(1))
    ours = [auvid.tick(*tick) for tick in run]
    for name, reference in (("filterpy KalmanFilter", by_filterpy),
                            ("Eq. 3-8 in numpy, double", by_equations)):
        theirs = list(reference(Model(auvid.config), run))
        position = ([o["x"][:3] for o in ours], [t["x"][:3] for t in theirs])
        velocity = ([o["x"][3:] for o in ours], [t["x"][3:] for t in theirs])
        yield close(lib, "navigation, position, a minute", name, [position], "m", 1,
                    "stored as a sum of two numbers, read as one")
        yield close(lib, "navigation, velocity", name, [velocity], "m/s", 8,
                    "z - H x, a gain, a sum: each of the size of v")
        pairs = [(o["p"], t["p"], of_deviations(t)) for o, t in zip(ours, theirs)]
        yield close(lib, "navigation, covariance", name, pairs, "relative to sigma_i sigma_j", 100,
                    "4 roundings of P, of which the DVL leaves 1/25")
        if reference is by_equations:
            continue
        for i, (what, unit, roundings, why) in enumerate((
                ("innovation of the DVL", "m/s", 16, "that of the velocity, and of the turned z"),
                ("its variance S", "m2/s2", 16, "that of the covariance"),
                ("its NIS", "-", 60, "2 nu / S times that of the velocity"))):
            pairs = [tuple(np.array([s["dvl"][i] for s in side if "dvl" in s])
                           for side in (ours, theirs))]
            yield close(lib, f"navigation, {what}", name, pairs, unit, roundings, why)
