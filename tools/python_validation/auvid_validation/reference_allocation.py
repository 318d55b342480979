"""Thruster allocation against numpy: pseudo-inverse, forces, saturation, limits of a thruster."""
import numpy as np

from auvid_validation.compare import close
from auvid_validation.library import values


def thrusters(lib, rng, rank=6):
    """Six to eight thrusters at random places; of rank 3 for motion in a plane."""
    config, a = lib.auvid_allocation_config_t(), lib.auvid_allocation_t()
    lib.auvid_allocation_defaults(config)
    config.thrusters, config.priority = int(rng.integers(6, 9)), 0
    matrix = rng.uniform(-1, 1, (6, config.thrusters))
    if rank == 3:
        matrix[[2, 3, 4]] = 0
    for i in range(config.thrusters):
        thruster = config.thruster[i]
        thruster.wrench[:] = matrix[:, i]
        thruster.min_N, thruster.max_N = -rng.uniform(20, 100), rng.uniform(20, 100)
    assert lib.auvid_allocation_init(a, config) == 0
    n = config.thrusters
    exact = np.array([values(config.thruster[i].wrench) for i in range(n)], float).T
    low = np.array([config.thruster[i].min_N for i in range(n)])
    high = np.array([config.thruster[i].max_N for i in range(n)])
    return a, exact, low, high


def comparisons(lib):
    rng = np.random.default_rng(1)
    inverses, forces, wrenches, parts, largest = [], [], [], [], []
    for k in range(300):
        a, t, low, high = thrusters(lib, rng, 3 if k % 3 == 0 else 6)
        acts = np.abs(t).sum(1) > 0
        if np.linalg.cond(t[acts]) > 100:
            continue
        n = t.shape[1]
        condition = np.linalg.cond(t[acts])
        inverse = np.linalg.pinv(t)
        most = np.abs(inverse).max()
        inverses.append((values(a.inverse)[:n], inverse, condition * most))
        wrench = lib.array(np.where(acts, rng.uniform(-20, 20, 6), 0))
        result = lib.auvid_allocation_result_t()
        assert lib.auvid_allocation_solve(a, wrench, result) >= 0
        asked = inverse @ wrench.astype(float)
        scale = min(1, np.min(np.where(asked > 0, high, low) / asked))
        size = condition * most * np.abs(wrench).sum()
        forces.append((values(result.force_N)[:n], scale * asked, size))
        parts.append((result.scale, scale, condition * max(1, most * np.abs(wrench).sum()
                                                            / np.abs(asked).max())))
        got, force = lib.zeros(6), lib.array(rng.uniform(-100, 100, n))
        assert lib.auvid_allocation_wrench(a, force, got) == 0
        wrenches.append((got, t @ force.astype(float), np.abs(t).sum(1).max() * 100))
        dof = 5
        one = inverse[:, dof]
        ends = lib.zeros(2)
        assert lib.auvid_allocation_capacity(a, dof, ends[:1], ends[1:]) == 0
        up = np.min(np.where(one > 0, high, low) / one)
        down = -np.min(np.where(one > 0, low, high) / -one)
        largest.append((ends, [down, up], condition * max(up, -down) * most / np.abs(one).max()))
    n = len(inverses)
    yield close(lib, f"allocation, pseudo-inverse, {n} sets", "numpy.linalg.pinv", inverses,
                "relative to condition times largest", 4, "a solve: a few roundings a step")
    yield close(lib, "allocation, forces within limits", "pinv, scaled in numpy", forces,
                "relative to condition |T+||tau|", 4, "that of the inverse")
    yield close(lib, "allocation, part of the wrench made", "pinv, limits in numpy", parts,
                "relative to condition", 8, "that of the largest force")
    yield close(lib, "allocation, wrench of forces", "numpy matmul", wrenches,
                "relative to sum|T||f|", 4, "eight terms, at random")
    yield close(lib, "allocation, largest moment in yaw", "pinv, limits in numpy", largest,
                "relative to condition times largest", 8, "that of the inverse")
