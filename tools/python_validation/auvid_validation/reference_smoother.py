"""The smoother against scipy.signal and numpy.polynomial."""
import numpy as np
from numpy.polynomial import legendre
from scipy.signal import savgol_coeffs, savgol_filter

from auvid_validation.compare import close

WIDTHS = (1, 2, 3, 5, 7, 10, 25, 50)
DT = 0.02


def filters(derivative):
    """(half-width, order) supported by scipy and auvid."""
    return [(h, order) for h in WIDTHS for order in range(derivative, 6) if order <= 2 * h]


def coefficients(lib, h, order, derivative, position):
    c = lib.zeros(2 * h + 1)
    assert lib.auvid_smoother_coefficients(h, order, derivative, DT, position, c) == 0
    return c


def smoothed(lib, x, h, order, derivative):
    """The whole record, including its edges."""
    config, smoother = lib.auvid_smoother_config_t(), lib.auvid_smoother_t()
    config.half_width, config.order, config.derivative, config.dt_s = h, order, derivative, DT
    assert lib.auvid_smoother_init(smoother, config) == 0
    out, one = [], lib.zeros(1)
    for k in range(len(x) + 1):
        if k < len(x):
            lib.auvid_smoother_push(smoother, x[k])
        else:
            lib.auvid_smoother_end(smoother)
        while lib.auvid_smoother_take(smoother, None, one) == 0:
            out.append(one[0])
    return np.array(out)


def by_legendre(h, order, derivative, dt, position):
    """savgol_coeffs, anywhere in the window: scipy's powers of up to 2 h + 1 lose digits."""
    fit = np.linalg.pinv(legendre.legvander(np.arange(-h, h + 1) / h, order))
    basis = legendre.legder(np.eye(order + 1), derivative)
    return legendre.legval(position / h, basis) @ fit / (h * dt) ** derivative


def comparisons(lib):
    dt = float(lib.real.type(DT))
    for derivative, what in enumerate(("value", "first derivative", "second derivative")):
        pairs, edges, records = [], [], []
        rng = np.random.default_rng(derivative)
        for h, order in filters(derivative):
            for position in (0, -h, h // 2, h):
                theirs = by_legendre(h, order, derivative, dt, position)
                edges.append((coefficients(lib, h, order, derivative, position), theirs))
            if h**order > 1e6:  # here scipy is no longer accurate to 1e-9
                continue
            theirs = savgol_coeffs(2 * h + 1, order, derivative, dt, use="dot")
            pairs.append((coefficients(lib, h, order, derivative, 0), theirs))
            x = lib.array(np.cumsum(rng.normal(size=6 * h + 5)))
            theirs = savgol_filter(x.astype(float), 2 * h + 1, order, derivative, dt)
            # The accuracy of an output is that of the sum of its inputs.
            gain = max(np.abs(t).sum() for _, t in edges[-4:])
            records.append((smoothed(lib, x, h, order, derivative), theirs,
                            gain * np.abs(x).max()))
        yield close(lib, f"smoother, coefficients, {what}", "scipy savgol_coeffs", pairs,
                    "relative to the largest", 3, "the bound of smoother.h")
        yield close(lib, f"smoother, four places, {what}", "numpy legvander, pinv",
                    edges, "relative to the largest", 3, "as above")
        yield close(lib, f"smoother, record with both edges, {what}",
                    "scipy savgol_filter(interp)", records, "relative to sum|c| max|x|", 4,
                    "the bound of smoother.h")
