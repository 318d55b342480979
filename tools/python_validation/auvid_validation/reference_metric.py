"""The metric against the pipeline of metric.h in numpy, in double: scipy's Savitzky-Golay filters,
all rows kept, every least-squares problem by numpy.linalg.lstsq or scipy.optimize.

The data are cells of a simulated Girona500 without delay, two sets of them; bands are weighted as
metric.h says (each by its own residual)."""
import numpy as np
from scipy.optimize import least_squares
from scipy.signal import savgol_coeffs

from auvid_validation import girona500
from auvid_validation.compare import close
from auvid_validation.library import values

SETS, CELL_S = 2, 0.1


def record(lib, rng, cells):
    """Sums of sines in all degrees of freedom, the wrench they take and a coloured force."""
    t = CELL_S * np.arange(cells)
    size = np.array([0.4, 0.2, 0.15, 0.02, 0.03, 0.25])
    frequency = np.array([0.050, 0.043, 0.061, 0.30, 0.25, 0.057])
    nu, nu_dot = np.zeros((2, cells, 6))
    for j in range(6):
        for part, times in ((1.0, 1.0), (0.6, 2.3), (0.4, 0.41)):
            w, phase = 2 * np.pi * frequency[j] * times, rng.uniform(0, 6)
            nu[:, j] += size[j] * part * np.sin(w * t + phase)
            nu_dot[:, j] += size[j] * part * w * np.cos(w * t + phase)
    force, out = np.zeros(4), []
    for i in range(cells):
        s = lib.auvid_sample_t(t_us=int(1e5 * i))
        s.phi, s.theta = 0.05 * np.sin(0.9 * t[i]), 0.04 * np.cos(0.7 * t[i])
        force = 0.95 * force + rng.normal(size=4) * [0.3, 0.3, 0.3, 0.1]
        s.nu[:], s.nu_dot[:] = nu[i].tolist(), nu_dot[i].tolist()
        tau = girona500.wrench(girona500.TRUTH, s.phi, s.theta, nu[i], nu_dot[i]) + force
        for k, dof in enumerate(girona500.DRIVEN):
            s.tau[dof] = tau[k]
        out.append(s)
    return out


class Pipeline:
    """metric.h's rows: for each of X Y Z N the two bands of [Y, tau], and their weights."""

    def __init__(self, config, cells):
        y = np.array([girona500.regressor(c.phi, c.theta, values(c.nu).astype(float),
                                          values(c.nu_dot).astype(float)) for c in cells])
        tau = np.array([values(c.tau)[girona500.DRIVEN] for c in cells], float)
        self.bands, self.kernels, self.weight = [], [], []
        spread = min((1e-6 * config.velocity_us)**2 / 12 / CELL_S**2, 0.5)
        taps = 4 * max(config.half_width) + 3
        for k, dof in enumerate(girona500.DRIVEN):
            moment = int(dof >= 3)
            once = savgol_coeffs(2 * config.half_width[moment] + 1, config.order)
            smooth = np.convolve(once, once)
            smooth = np.pad(smooth, (taps - len(smooth)) // 2)
            triangle = [0, 1, 0] if moment else [spread, 1 - 2 * spread, spread]
            # The cells that a row spans, from the sixth: wrench is wanted at all delays.
            begin = np.arange(6, len(cells) - taps + 1, config.row_cells)
            of_motion = np.array([smooth @ y[b:b + taps, k] for b in begin])
            of_wrench = np.array([np.convolve(smooth, triangle, "same") @ tau[b:b + taps, k]
                                  for b in begin])
            rows = np.column_stack([of_motion, of_wrench])[:SETS * config.set_rows]
            lag = config.lag[moment]
            self.bands.append(((rows[lag:] + rows[:-lag]) / 2, (rows[lag:] - rows[:-lag]) / 2))
            self.kernels.append(smooth)
            self.weight.append(1 / (config.tau_max[dof]**2 * SETS * config.set_rows))
        self.ratio, self.rows = [], []  # of the low band's weight to the high one's
        for (low, high), weight in zip(self.bands, self.weight):
            pi = self.solve([low, high])
            self.ratio.append(np.clip(self.left(high, pi) / self.left(low, pi), 1e-3, 1e3))
            root = self.ratio[-1]**0.25
            self.rows.append(np.sqrt(weight) * np.vstack([low * root, high / root]))
        self.a, self.b = np.vstack(self.rows)[:, :-1], np.vstack(self.rows)[:, -1]

    @staticmethod
    def solve(parts):
        stack = np.vstack(parts)
        return np.linalg.lstsq(stack[:, :-1], stack[:, -1])[0]

    @staticmethod
    def left(rows, pi):
        return ((rows[:, :-1] @ pi - rows[:, -1])**2).sum()

    def cost(self, pi):
        return ((self.a @ pi - self.b)**2).sum()

    def unexplained(self):
        """The part of the cost that no pi explains, each degree of freedom by itself."""
        return sum(self.left(r, self.solve([r])) for r in self.rows)


def finish(step, metric):
    assert step(metric, np.array([1_000_000], np.uint32)) == 0


def make(lib, rng):
    config, metric = lib.auvid_metric_config_t(), lib.auvid_metric_t()
    lib.auvid_metric_defaults(config, lib.auvid_girona500)
    config.estimate_delay = False
    assert lib.auvid_metric_init(metric, config) == 0
    taps = 4 * max(config.half_width) + 3
    cells = record(lib, rng, 6 + taps + config.row_cells * (SETS * config.set_rows - 1))
    for cell in cells:
        assert lib.auvid_metric_add(metric, cell) >= 0
    lib.auvid_metric_merge_begin(metric)
    finish(lib.auvid_metric_merge, metric)
    assert metric.sets_recorded == SETS and metric.driven == 0b100111
    return config, metric, cells


def comparisons(lib):
    rng = np.random.default_rng(1)
    config, metric, cells = make(lib, rng)
    reference = Pipeline(config, cells)
    taps = metric.taps
    kernels = [(values(metric.kernel)[int(dof >= 3), :taps], kernel)
               for dof, kernel in zip(girona500.DRIVEN, reference.kernels)]
    yield close(lib, "metric, filter of rows", "scipy savgol_coeffs, twice", kernels,
                "relative to the largest", 8, "42 products, at random")
    weights = [(metric.band_weight[0][dof] / metric.band_weight[1][dof], ratio)
               for dof, ratio in zip(girona500.DRIVEN, reference.ratio)]
    yield close(lib, "metric, weights of the bands", "numpy.linalg.lstsq residuals", weights,
                "relative to itself", 600, "4 of a wrench 73 times its residual, squared")
    ours, theirs = [], []
    for _ in range(200):
        pi = lib.zeros(17)
        pi[:13] = girona500.TRUTH * rng.uniform(0.5, 1.5, 13)
        lib.auvid_metric_cost_begin(metric, pi, 0)
        finish(lib.auvid_metric_cost, metric)
        ours.append(metric.cost + metric.constant)
        theirs.append(reference.cost(pi[:13].astype(float)))
    yield close(lib, "metric, cost, 200 candidates", "numpy, all rows", [(ours, theirs, theirs)],
                "relative to itself", 600, "that of the bands' weights")
    yield close(lib, "metric, what no candidate explains", "numpy.linalg.lstsq",
                [(metric.constant, reference.unexplained())], "-", 600,
                "that of the bands' weights")
    pi = lib.zeros(17)
    assert lib.auvid_metric_least_squares(metric, 0x1FFF, pi) == 0
    optimum = np.linalg.lstsq(reference.a, reference.b)[0]
    scale = np.linalg.norm(reference.a, axis=0)
    condition = np.linalg.cond(reference.a / scale)
    yield close(lib, "metric, least-squares optimum", "numpy.linalg.lstsq",
                [(pi[:13], optimum, condition * np.linalg.norm(reference.b) / scale)],
                "relative to condition |z| / |column|", 8, "orthogonal rotations")
    start = girona500.TRUTH * 1.5
    found = least_squares(lambda x: reference.a @ (x / scale) - reference.b, start * scale,
                          jac=lambda x: reference.a / scale, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    yield close(lib, "metric, optimum of its cost", "scipy least_squares (trf)",
                [(pi[:13], found.x / scale, condition * np.linalg.norm(reference.b) / scale)],
                "relative to condition |z| / |column|", 8, "orthogonal rotations")
    ours = lib.zeros(17)
    lib.auvid_metric_scale(metric, ours)
    yield close(lib, "metric, scale of the parameters", "numpy.linalg.norm of columns",
                [(ours[:13], 1 / scale, 1 / scale)], "relative to itself", 600,
                "that of the bands' weights")

