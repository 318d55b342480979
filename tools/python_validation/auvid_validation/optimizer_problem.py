"""The cost for the comparison of optimizers, with a count of its evaluations."""
import numpy as np

from auvid_validation.library import load

N, BOUND = 13, 1000.0


class Reached(Exception):
    """The cost is within 1.001 of the optimum: the count ends."""


class Capped(Exception):
    """Too many evaluations."""


class Problem:
    """The R factor of the metric of a simulated Girona500: 8 sets of 30 s, 1 N of disturbance, the
    sensors of README; a different record for each seed. The cost is that of auvid, in float32."""

    def __init__(self, seed):
        self.lib = lib = load("float")
        config, chain = lib.chain_config_t(), lib.chain_t()
        lib.chain_defaults(config, 1000 + seed, 8, 1.0)
        config.budget = 0  # record only
        assert lib.chain_run_sets(chain, config, 8) == 0
        self.chain, self.metric = chain, chain.id.metric
        self.budget = np.zeros(1, np.uint32)
        lib.auvid_metric_merge_begin(self.metric)
        self.finish(lib.auvid_metric_merge)
        self.optimum = lib.zeros(17)
        assert lib.auvid_metric_least_squares(self.metric, 0x1FFF, self.optimum) == 0
        scale = lib.zeros(17)
        lib.auvid_metric_scale(self.metric, scale)
        self.units = {"box": np.full(N, BOUND), "columns": scale[:N].astype(float)}
        self.pi = lib.zeros(17)
        # The cost excludes the residual that no single degree of freedom explains.
        least = self.cost(self.optimum[:N])
        self.target = least + 1e-3 * (least + self.metric.result.constant)

    def finish(self, step):
        self.budget[0] = 1_000_000
        assert step(self.metric, self.budget) == 0

    def cost(self, pi):
        """Without the constant."""
        self.pi[:N] = pi
        self.lib.auvid_metric_cost_begin(self.metric, self.pi, 0)
        self.finish(self.lib.auvid_metric_cost)
        return self.metric.result.cost


class Counted:
    """A cost of x = pi / unit that counts, and ends the search by an exception."""

    def __init__(self, cost, unit, target, cap):
        self.cost, self.unit, self.target, self.cap = cost, unit, target, cap
        self.evaluations = 0

    def __call__(self, x, *_):
        if self.evaluations >= self.cap:
            raise Capped
        self.evaluations += 1
        value = float(self.cost(np.asarray(x) * self.unit))
        if value <= self.target:
            raise Reached
        return value


def interval(good, runs):
    """Clopper-Pearson, 95 %."""
    lib = load("double")
    return lib.binomial_lower(good, runs, 0.025), lib.binomial_upper(good, runs, 0.025)
