"""The metric against the pipeline of detail/metric.h in numpy, in double: scipy's Savitzky-Golay
filters, all rows kept, every least-squares problem by numpy.linalg.lstsq or scipy.optimize.

The data are cells of a simulated Girona500 without delay, two sets of them; bands are weighted as
metric.h says (each by its own residual)."""
import numpy as np
from scipy.optimize import least_squares
from scipy.signal import savgol_coeffs

from auvid_validation import girona500
from auvid_validation.compare import close
from auvid_validation.library import values

SETS, CELL_S = 2, 0.1
#: Of literal smoothing [cells].
HALF_WIDTH = 5

#: Completed sets are stored in 16 bits: half a unit of the largest entry of a column.
STORED = 2.0**-16


def record(lib, rng, cells):
    """Sums of sines in all degrees of freedom, their wrench and a coloured force."""
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


def motion(cell):
    return cell.phi, cell.theta, values(cell.nu).astype(float), values(cell.nu_dot).astype(float)


def taps_of(config):
    """Of the filter: two passes and the spread of forces."""
    return 4 * max(config.half_width) + 3


def windows(config, cells, taps):
    """The cells of each row, from the seventh on: the wrench is needed at all delays."""
    return [slice(b, b + taps) for b in range(6, len(cells) - taps + 1, config.row_cells)]


class Pipeline:
    """detail/metric.h's rows: for X Y Z N the two bands of [Y, tau], and their weights."""

    def __init__(self, config, cells, literal):
        self.kernels, self.ratio, self.rows = [], [], []
        every = self.of_states(config, cells) if literal else self.of_rows(config, cells)
        for dof, rows in zip(girona500.DRIVEN, every):
            rows = rows[:SETS * config.set_rows]
            lag = config.lag[int(dof >= 3)]
            low, high = (rows[lag:] + rows[:-lag]) / 2, (rows[lag:] - rows[:-lag]) / 2
            pi = self.solve([low, high])
            # The low band's weight over the high one's.
            ratio = 1 if literal else np.clip(self.left(high, pi) / self.left(low, pi), 1e-3, 1e3)
            weight = 1 / (config.tau_max[dof]**2 * SETS * config.set_rows)
            self.rows.append(np.sqrt(weight) * np.vstack([low * ratio**0.25, high / ratio**0.25]))
            self.ratio.append(ratio)
        self.a, self.b = np.vstack(self.rows)[:, :-1], np.vstack(self.rows)[:, -1]

    def of_rows(self, config, cells):
        """Rows of unsmoothed cells; rows and wrench with the same filter, forces also spread."""
        y = np.array([girona500.regressor(*motion(c)) for c in cells])
        tau = np.array([values(c.tau)[girona500.DRIVEN] for c in cells], float)
        spread = min((1e-6 * config.velocity_us)**2 / 12 / CELL_S**2, 0.5)
        for k, dof in enumerate(girona500.DRIVEN):
            once = savgol_coeffs(2 * config.half_width[int(dof >= 3)] + 1, 2)
            smooth = np.convolve(once, once)
            smooth = np.pad(smooth, (taps_of(config) - len(smooth)) // 2)
            self.kernels.append(smooth)
            triangle = [0, 1, 0] if dof >= 3 else [spread, 1 - 2 * spread, spread]
            of_wrench = np.convolve(smooth, triangle, "same")
            yield np.array([np.r_[smooth @ y[w, k], of_wrench @ tau[w, k]]
                            for w in windows(config, cells, taps_of(config))])

    @staticmethod
    def of_states(config, cells):
        """Literal smoothing: smoothed states, their smoothed derivative, raw wrench."""
        h, order = HALF_WIDTH, 3
        smooth = savgol_coeffs(2 * h + 1, order, use="dot")
        derivative = savgol_coeffs(2 * h + 1, order, 1, CELL_S, use="dot")
        x = np.array([np.r_[c.phi, c.theta, values(c.nu)] for c in cells], float)
        every = []
        for w in windows(config, cells, 2 * h + 1):
            phi, theta, *nu = smooth @ x[w]
            y = girona500.regressor(phi, theta, np.array(nu), derivative @ x[w, 2:])
            tau = values(cells[w.start + h].tau)[girona500.DRIVEN]
            every.append(np.column_stack([y, tau]))
        return np.array(every).swapaxes(0, 1)

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
        """The part of the cost that no pi explains, by degree of freedom."""
        return sum(self.left(r, self.solve([r])) for r in self.rows)


def finish(step, metric):
    assert step(metric, np.array([1_000_000], np.uint32)) == 0


def make(lib, rng, literal=False):
    config, metric = lib.auvid_metric_config_t(), lib.auvid_metric_t()
    lib.auvid_metric_defaults(config, lib.auvid_girona500)
    config.estimate_delay = False
    smoother = lib.literal_t()
    taps = 2 * HALF_WIDTH + 1 if literal else taps_of(config)
    if literal:
        assert lib.literal_metric(smoother, config) == 0
        lib.literal_attach(smoother, metric)
    assert lib.auvid_metric_init(metric, config) == 0
    rows = SETS * config.set_rows
    cells = record(lib, rng, 6 + taps + config.row_cells * (rows - 1))
    for cell in cells:
        assert (lib.literal_add(smoother, cell) if literal else
                lib.auvid_metric_add(metric, cell)) >= 0
    lib.auvid_metric_merge_begin(metric)
    finish(lib.literal_merge if literal else lib.auvid_metric_merge, metric)
    assert metric.sets.recorded == SETS and metric.result.excited == 0b100111
    metric.smoother = smoother  # which must outlive it
    return metric, Pipeline(config, cells, literal)


def costs(lib, rng, metric, reference):
    """(ours, theirs, scale) at 200 candidates."""
    ours, theirs = [], []
    for _ in range(200):
        pi = lib.zeros(17)
        pi[:13] = girona500.TRUTH * rng.uniform(0.5, 1.5, 13)
        lib.auvid_metric_cost_begin(metric, pi, 0)
        finish(lib.auvid_metric_cost, metric)
        ours.append(metric.result.cost + metric.result.constant)
        theirs.append(reference.cost(pi[:13].astype(float)))
    return ours, theirs, theirs


def comparisons(lib):
    rng = np.random.default_rng(1)
    metric, reference = make(lib, rng)
    kernels = [(values(metric.layout.kernel)[int(dof >= 3), :metric.layout.taps], kernel)
               for dof, kernel in zip(girona500.DRIVEN, reference.kernels)]
    yield close(lib, "metric, filter of rows", "scipy savgol_coeffs, twice", kernels,
                "relative to the largest", 8, "42 products, at random")
    weights = [(metric.evaluator.band_weight[0][dof] / metric.evaluator.band_weight[1][dof], ratio)
               for dof, ratio in zip(girona500.DRIVEN, reference.ratio)]
    yield close(lib, "metric, weights of the bands", "numpy.linalg.lstsq residuals", weights,
                "relative to itself", 600, "4 of a wrench 73 times its residual, squared", STORED)
    yield close(lib, "metric, cost, 200 candidates", "numpy, all rows",
                [costs(lib, rng, metric, reference)], "relative to itself", 600,
                "that of the bands' weights", STORED)
    yield close(lib, "metric, what no candidate explains", "numpy.linalg.lstsq",
                [(metric.result.constant, reference.unexplained())], "-", 600,
                "that of the bands' weights", STORED)
    pi = lib.zeros(17)
    assert lib.auvid_metric_least_squares(metric, 0x1FFF, pi) == 0
    optimum = np.linalg.lstsq(reference.a, reference.b)[0]
    scale = np.linalg.norm(reference.a, axis=0)
    condition = np.linalg.cond(reference.a / scale)
    yield close(lib, "metric, least-squares optimum", "numpy.linalg.lstsq",
                [(pi[:13], optimum, condition * np.linalg.norm(reference.b) / scale)],
                "relative to condition |z| / |column|", 1, "sets stored in 16 bits", STORED)
    start = girona500.TRUTH * 1.5
    found = least_squares(lambda x: reference.a @ (x / scale) - reference.b, start * scale,
                          jac=lambda x: reference.a / scale, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    yield close(lib, "metric, optimum of its cost", "scipy least_squares (trf)",
                [(pi[:13], found.x / scale, condition * np.linalg.norm(reference.b) / scale)],
                "relative to condition |z| / |column|", 1, "sets stored in 16 bits", STORED)
    ours = lib.zeros(17)
    lib.auvid_metric_scale(metric, ours)
    yield close(lib, "metric, scale of the parameters", "numpy.linalg.norm of columns",
                [(ours[:13], 1 / scale, 1 / scale)], "relative to itself", 600,
                "that of the bands' weights", STORED)
    metric, reference = make(lib, rng, literal=True)
    yield close(lib, "metric, literal smoothing, cost", "scipy savgol, numpy, all rows",
                [costs(lib, rng, metric, reference)], "relative to itself", 600,
                "4 of a wrench 73 times its residual, squared", STORED)
