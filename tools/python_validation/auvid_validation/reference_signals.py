"""Excitation and recorder against numpy, random numbers and campaign bounds against scipy.stats."""
import numpy as np
from scipy import stats

from auvid_validation.compare import Row, close
from auvid_validation.library import values

US = 1e-6


def play(lib, segments, fade_s=0.0, tick_us=20_000, seed=1):
    """(state, times [s], wrench (n, 6)) of a table of segments, each a dict of fields."""
    config, e = lib.auvid_excitation_config_t(), lib.auvid_excitation_t()
    lib.auvid_excitation_defaults(config)
    config.segments, config.fade_s, config.seed = len(segments), fade_s, seed
    for i, fields in enumerate(segments):
        for name, value in fields.items():
            setattr(config.segment[i], name, value)
    assert lib.auvid_excitation_init(e, config) == 0
    lib.auvid_excitation_start(e, 0)
    out, k, first = [], 0, None
    while True:
        wrench = lib.zeros(6)
        if lib.auvid_excitation_step(e, k * tick_us, wrench) != 0:
            break
        if first is None:  # the values drawn for the sums of sines
            first = {j: (float(c.scale), values(c.frequency_hz).astype(float),
                         values(c.cycles).astype(float)) for j, c in enumerate(e.channel)}
        out.append(wrench)
        k += 1
    return first, US * tick_us * np.arange(k), np.array(out)


def raised_cosine(s, duration, fade):
    """Of a segment of `duration`, at s: 0 at its ends, 1 from `fade` on."""
    ends = np.minimum(np.minimum(s, duration - s) / fade, 1)
    return 0.5 - 0.5 * np.cos(np.pi * ends)


def excitation(lib):
    sine = {"dof": 0, "kind": lib.AUVID_SEGMENT_SINE, "duration_s": 30, "amplitude": 100,
            "frequency_hz": 0.13, "phase": 0.7, "fade_s": 2}
    ramp = {"dof": 1, "kind": lib.AUVID_SEGMENT_RAMP, "duration_s": 30, "amplitude": 80,
            "from": -20}
    _, t, wrench = play(lib, [sine, ramp], fade_s=3)
    frequency, phase = (float(lib.real.type(x)) for x in (0.13, 0.7))
    run = raised_cosine(t, 30, 3)
    reference = run * raised_cosine(t, 30, 2) * 100 * np.sin(2 * np.pi * frequency * t + phase)
    yield close(lib, "excitation, sine with fades", "numpy sin, cos", [(wrench[:, 0], reference)],
                "N", 40, "25 rad of phase, rounded once; fades")
    yield close(lib, "excitation, ramp with fade", "numpy interp",
                [(wrench[:, 1], run * np.interp(t, [0, 30], [-20, 80]))], "N", 8, "a few roundings")
    sums, peaks, tones = [], [], []
    for seed in range(10):
        table = [{"dof": j, "kind": lib.AUVID_SEGMENT_SINES, "duration_s": 60, "amplitude": 100,
                  "frequency_hz": 0.03, "frequency_high_hz": 0.25, "sines": 5} for j in (0, 1, 5)]
        drawn, t, wrench = play(lib, table, tick_us=50_000, seed=seed)
        for j in (0, 1, 5):
            scale, frequency, cycles = drawn[j]
            angle = 2 * np.pi * (np.outer(t, frequency) + cycles)
            sums.append((wrench[:, j], 100 * scale * np.sin(angle).sum(1), 100.0))
            peaks.append(np.abs(wrench[:, j]).max())
            # All its power is at the drawn frequencies: a fit of sines has no residual.
            basis = np.hstack([np.sin(angle), np.cos(angle)])
            fit = np.linalg.lstsq(basis, wrench[:, j].astype(float))[0]
            tones.append((np.hypot(fit[:5], fit[5:]), np.full(5, 100 * scale), 500.0 * scale))
    yield close(lib, "excitation, sums of five sines", "numpy sin", sums, "relative to amplitude",
                60, "5 x 15 cycles, rounded once")
    yield close(lib, "excitation, amplitude of each sine", "numpy.linalg.lstsq", tones,
                "relative to their sum", 60, "that of the sum")
    yield Row("excitation, peak of 30 sums of sines", "numpy max", max(max(peaks) - 100, 0),
              100 * 4 * np.finfo(np.float32).eps, "N beyond amplitude", "rounding alone")
    yield Row("excitation, peak that is not reached", "numpy max", 100 - min(peaks), 7, "N of 100",
              "at least 0.93: excitation.h")


def recorder(lib):
    """Cell means of broken lines, by numpy: exact integrals by the trapezoidal rule on all
    corners."""
    config, r = lib.auvid_recorder_config_t(), lib.auvid_recorder_t()
    lib.auvid_recorder_defaults(config)
    assert lib.auvid_recorder_init(r, config) == 0
    rng = np.random.default_rng(2)
    cell, begin, cells = 100_000, 1_000_000, 120
    streams = {}
    for name, period, width in (("attitude", 20_000, 6), ("velocity", 200_000, 3),
                                ("input", 20_000, 6)):
        t = begin + np.cumsum(rng.integers(period * 3 // 4, period * 5 // 4, 3000))
        t = np.r_[begin, t[t < begin + (cells + 10) * cell]]
        streams[name] = t, lib.array(np.cumsum(0.1 * rng.normal(size=(len(t), width)), axis=0))
    events = sorted((t, name, i) for name, (times, _) in streams.items()
                    for i, t in enumerate(times))
    ours = []
    for t, name, i in events:
        x = streams[name][1][i].copy()
        if name == "attitude":
            assert lib.auvid_recorder_attitude(r, int(t), x[:3].copy(), x[3:].copy()) == 0
        elif name == "velocity":
            assert lib.auvid_recorder_velocity(r, int(t), x, 7) == 0
        else:
            assert lib.auvid_recorder_input(r, int(t), x, None) == 0
        sample = lib.auvid_sample_t()
        while lib.auvid_recorder_pop(r, sample) == 0:
            ours.append(sample)
            sample = lib.auvid_sample_t()

    def integral(name, at):
        """Of each channel from `begin` to `at` [us]."""
        t, x = streams[name]
        x = x.astype(float)
        if name == "input":  # holds
            steps = np.vstack([np.zeros(x.shape[1]), np.cumsum(x[:-1] * np.diff(t)[:, None], 0)])
            k = np.searchsorted(t, at, "right") - 1
            return steps[k] + x[k] * (at - t[k])[:, None]
        whole = np.vstack([np.zeros(x.shape[1]),
                           np.cumsum((x[1:] + x[:-1]) / 2 * np.diff(t)[:, None], 0)])
        k = np.searchsorted(t, at, "right") - 1
        slope = (x[k + 1] - x[k]) / (t[k + 1] - t[k])[:, None]
        d = (at - t[k])[:, None]
        return whole[k] + x[k] * d + slope * d**2 / 2

    # Cells lie on a grid; the first popped has two before it.
    first = int(ours[0].t_us) - cell // 2
    edges = first + cell * np.arange(-2, len(ours) + 3)
    means = {name: np.diff(integral(name, edges), axis=0) / cell for name in streams}
    own = slice(2, -2)
    nu = np.hstack([means["velocity"], means["attitude"][:, 3:]])
    rates = (8 * (nu[3:-1] - nu[1:-3]) - (nu[4:] - nu[:-4])) / 1.2
    pairs = [(np.array([values(s.nu) for s in ours]), nu[own]),
             (np.array([values(s.tau) for s in ours]), means["input"][own]),
             (np.array([[s.phi, s.theta, s.psi] for s in ours]), means["attitude"][own, :3])]
    yield close(lib, f"recorder, means of {len(ours)} cells", "numpy, exact integrals", pairs,
                "relative to the largest", 8, "a dozen samples a cell")
    yield close(lib, "recorder, accelerations", "numpy, fourth order",
                [(np.array([values(s.nu_dot) for s in ours]), rates,
                  18 / 1.2 * np.abs(nu).max())], "relative to 15 max|nu| / s", 8,
                "that of the means")


def kolmogorov(quantity, reference, sample, distribution):
    n = len(sample)
    statistic = stats.kstest(sample, distribution).statistic
    bound = stats.kstwo.isf(1e-3, n)
    return Row(quantity, reference, statistic, bound, f"distance, {n} values", "p = 0.001")


def statistics(lib):
    rng = lib.auvid_rng_t()
    lib.auvid_rng_seed(rng, 1)
    uniform = [lib.auvid_rng_uniform(rng) for _ in range(20_000)]
    yield kolmogorov("random numbers, uniform", "scipy.stats.kstest", uniform, "uniform")
    counts = np.bincount([lib.auvid_rng_below(rng, 13) for _ in range(20_000)], minlength=13)
    statistic = stats.chisquare(counts).statistic
    yield Row("random numbers, one of 13", "scipy.stats.chisquare", statistic,
              stats.chi2.isf(1e-3, 12), "chi2 of 12, 20000 values", "p = 0.001")
    lags = [1, 2, 5]
    u = np.array(uniform) - np.mean(uniform)
    worst = max(abs(np.corrcoef(u[:-k], u[k:])[0, 1]) for k in lags)
    yield Row("random numbers, correlation of neighbours", "numpy.corrcoef", worst,
              stats.norm.isf(1e-3 / 6) / np.sqrt(len(u)), "at 1, 2 and 5", "p = 0.001")
    if lib.real == np.float64:  # in double in both libraries
        yield from campaign(lib)


def campaign(lib):
    noise = lib.sim_rng_t()
    lib.sim_rng_seed(noise, 1, 0)
    gauss = [lib.sim_rng_gauss(noise) for _ in range(20_000)]
    yield kolmogorov("simulator, noise", "scipy.stats.kstest", gauss, "norm")
    config, sim, out = lib.sim_config_t(), lib.sim_t(), lib.sim_output_t()
    lib.sim_defaults(config)
    config.disturbance_N = 3.0
    assert lib.sim_init(sim, config)
    force = []
    for _ in range(100_000):
        lib.sim_step(sim, None, None, out)
        force.append(values(sim.truth.disturbance)[:3].copy())
    force = np.array(force)
    # 2000 s of correlation time 2 s: 1000 independent values of each square, three components.
    rms = np.sqrt((force**2).mean())
    yield Row("simulator, disturbance, rms", "3 N asked for", abs(rms - 3),
              3 * 3.3 / np.sqrt(2 * 3 * 1000), "N", "p = 0.001, 3000 independent squares")
    correlation = (force[100:] * force[:-100]).mean() / rms**2
    yield Row("simulator, disturbance, correlation at 2 s", "exp(-1)",
              abs(correlation - np.exp(-1)), 3.3 / np.sqrt(3000), "-",
              "p = 0.001, 3000 independent products")
    pairs = []
    for k, n in ((0, 200), (3, 200), (190, 200), (200, 200), (7, 40), (999, 1000)):
        upper = stats.beta.ppf(0.95, k + 1, n - k) if k < n else 1.0
        lower = stats.beta.ppf(0.05, k, n - k + 1) if k > 0 else 0.0
        pairs.append(([lib.binomial_upper(k, n, 0.05), lib.binomial_lower(k, n, 0.05)],
                      [upper, lower], 1.0))
    yield close(lib, "campaigns, Clopper-Pearson bounds", "scipy.stats.beta", pairs, "probability",
                1, "bisection")


def comparisons(lib):
    for part in (excitation, recorder, statistics):
        yield from part(lib)
