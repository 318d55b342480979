"""Complete runs in simulation: the library aboard the simulated Girona500 (tests/support/chain.h).

A world is a dictionary that can be written to a file and sent to another machine:
    seed            of noise, disturbance, excitation and search
    sets            of 30 s; default 8
    disturbance_N   rms of the unmodelled force, 0.4 times this in Nm; default 0
    lag_s           of the thrusters, unknown to the identifier; default 0
    literal         literal smoothing of the paper; default False
    strength        of the excitation, relative to 100 N and 40 Nm; default 1
    one_by_one      one degree of freedom after the other; default False: all at once
    sim             other fields of sim_config_t
"""
import ctypes
import dataclasses

import numpy as np

from auvid_validation.user_error import UserError
from auvid_validation.library import PARAMETERS, load, values

TICK_S = 0.02
KEYS = {"seed", "sets", "disturbance_N", "lag_s", "literal", "strength", "one_by_one", "sim"}
#: The modelled degrees of freedom among the six: surge, sway, heave, yaw.
DOFS = [0, 1, 2, 5]
N = len(PARAMETERS)


def configured(lib, world):
    """chain_config_t of a world."""
    if set(world) - KEYS:
        raise ValueError(f"unknown keys of a world: {set(world) - KEYS}")
    seed, sets = world["seed"], world.get("sets", 8)
    config = lib.chain_config_t()
    lib.chain_defaults(config, seed, sets, world.get("disturbance_N", 0.0))
    config.sim.lag_s = world.get("lag_s", 0.0)
    for name, value in world.get("sim", {}).items():
        setattr(config.sim, name, value)
    one_by_one, strength = world.get("one_by_one", False), world.get("strength", 1.0)
    if one_by_one or strength != 1:
        amplitude = lib.array([100, 100, 100, 0, 0, 40]) * lib.real.type(strength)
        planned = sets // len(DOFS) if one_by_one else sets  # it takes four times as long
        lib.auvid_excitation_schedule(config.acting.excitation, amplitude, 30, planned, seed, 0,
                                      one_by_one)
    if world.get("literal", False):
        config.id.recorder.cell_us = int(TICK_S * 1e6)
        config.literal = ctypes.pointer(lib.literal_t())
        config.id.metric.row_cells = 25  # a row every half second, as by default
    return config


@dataclasses.dataclass
class Estimate:
    sets: int
    pi: np.ndarray
    sigma: np.ndarray
    identifiable: np.ndarray
    evaluations: tuple  # global phase, local phase
    not_converged: bool

    @classmethod
    def of(cls, estimate):
        sigma = values(estimate.confidence.sigma)[:N].astype(float)
        bits = estimate.confidence.identifiable
        return cls(estimate.sets, values(estimate.pi)[:N].astype(float), sigma,
                   np.array([bits >> i & 1 for i in range(N)], bool),
                   (estimate.evaluations_crs, estimate.evaluations_line), estimate.not_converged)


def truth_of(config):
    return values(config.sim.parameter)[:N].astype(float)


def identify(world):
    """Runs a world. -> (its last estimate, the 13 true parameters)"""
    lib = load("float")
    config, chain = configured(lib, world), lib.chain_t()
    status = lib.chain_run_sets(chain, config, world.get("sets", 8))
    if status < 0:
        raise UserError(f"this world is refused ({status.name}): {world}")
    lib.chain_finish(chain, 1000, 100000)
    return Estimate.of(chain.id.estimate), truth_of(config)


class Run:
    """A run that stores every tick: rows of `truth` and `seen` are the ends of ticks."""

    def __init__(self, world, work=True):
        lib = load("float")
        self.world, self.lib = world, lib
        self.config, self.chain = configured(lib, world), lib.chain_t()
        self.estimates, self.complete = [], 0  # the tick of the last set
        truth, seen, wrench, sets = [], [], [], world.get("sets", 8)
        chain = self.chain

        def before(_, given):
            truth.append(bytes(chain.sim.truth))
            seen.append(ctypes.string_at(given, ctypes.sizeof(lib.auvid_input_t)))
            wrench.append(bytes(chain.wrench))

        def after(_, status, out):
            events = out.contents.events
            if events & lib.AUVID_EVENT_ESTIMATE:
                self.estimates.append(Estimate.of(chain.id.estimate))
            if events & lib.AUVID_EVENT_SET and chain.id.metric.sets.recorded == sets:
                self.complete = len(truth)

        self.config.before = lib.chain_before_t(before)
        self.config.after = lib.chain_after_t(after)
        self.config.budget = self.config.budget if work else 0
        status = lib.chain_run_sets(chain, self.config, sets)
        if status < 0:
            raise UserError(f"this world is refused ({status.name}): {world}")
        if work:
            lib.chain_finish(chain, 1000, 100000)
            self.estimates.append(Estimate.of(chain.id.estimate))
        self.true_pi = truth_of(self.config)
        self.truth = np.frombuffer(b"".join(truth), np.dtype(lib.sim_truth_t))
        self.seen = np.frombuffer(b"".join(seen), np.dtype(lib.auvid_input_t))
        self.wrench = np.frombuffer(b"".join(wrench), lib.real).reshape(-1, 6)[:, DOFS]
        self.wrench = self.wrench.astype(float)  # X Y Z N during the tick
        self.t = self.truth["t_us"] * 1e-6

    @property
    def estimate(self):
        return self.estimates[-1]

    @property
    def nu(self):
        """True u v w r at the ends of ticks."""
        return self.truth["nu"][:, DOFS]

    @property
    def tilt(self):
        """True phi, theta, p, q."""
        return np.column_stack([self.truth["euler"][:, :2], self.truth["nu"][:, 3:5]])

    @property
    def measured_tilt(self):
        imu = self.seen["imu"]
        return np.column_stack([imu["attitude"][:, :2], imu["rates"][:, :2]]).astype(float)

    def measured(self):
        """[(ticks, values)] of u, v, w (DVL) and r (IMU)."""
        dvl = np.flatnonzero(self.seen["dvl"]["present"])
        imu = np.flatnonzero(self.seen["imu"]["present"])
        velocity = self.seen["dvl"]["sample"]["velocity"]
        return [(dvl, velocity[dvl, i].astype(float)) for i in range(3)] + [
            (imu, self.seen["imu"]["rates"][imu, 2].astype(float))]
