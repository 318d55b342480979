"""Eq. 12-15 in plain Python and numpy, and motion simulated with them (with w p in Eq. 13)."""
from math import cos, sin

import numpy as np


def regressor(tilt, nu, rate):
    """Rows of Y(eta, nu, nu_dot) of Eq. 2 at many times at once: [n, 4, 13].

    tilt: [n, 4] phi theta p q; nu, rate: [n, 4] u v w r and derivatives.
    """
    (phi, theta, p, q), (u, v, w, r) = np.transpose(tilt), np.transpose(nu)
    y = np.zeros((len(u), 4, 13))
    y[:, 0, 0], y[:, 0, 1], y[:, 0, 2], y[:, 0, 4] = rate[:, 0], -v * r, w * q, np.sin(theta)
    y[:, 1, 0], y[:, 1, 1], y[:, 1, 2] = u * r, rate[:, 1], -w * p
    y[:, 1, 4] = -np.cos(theta) * np.sin(phi)
    y[:, 2, 0], y[:, 2, 1], y[:, 2, 2] = -u * q, v * p, rate[:, 2]
    y[:, 2, 4] = -np.cos(theta) * np.cos(phi)
    y[:, 3, 0], y[:, 3, 1], y[:, 3, 3] = -u * v, u * v, rate[:, 3]
    for dof, (velocity, column) in enumerate([(u, 5), (v, 7), (w, 9), (r, 11)]):
        y[:, dof, column], y[:, dof, column + 1] = -velocity, -np.abs(velocity) * velocity
    return y


def derivative(pi, masses, inverse, phi, theta, p, q, x, wrench):
    """Of u v w r depth. masses: m_u m_v m_w of the terms of C(nu); inverse: of all four masses."""
    m_u, m_v, m_w = masses
    wb, x_u, x_uu, y_v, y_vv, z_w, z_ww, n_r, n_rr = pi[4:]
    u, v, w, r, _ = x
    return (
        (wrench[0] + m_v * v * r - m_w * w * q - wb * sin(theta)
         + (x_u + x_uu * abs(u)) * u) * inverse[0],
        (wrench[1] + m_w * w * p - m_u * u * r + wb * cos(theta) * sin(phi)
         + (y_v + y_vv * abs(v)) * v) * inverse[1],
        (wrench[2] + m_u * u * q - m_v * v * p + wb * cos(theta) * cos(phi)
         + (z_w + z_ww * abs(w)) * w) * inverse[2],
        (wrench[3] + (m_u - m_v) * u * v + (n_r + n_rr * abs(r)) * r) * inverse[3],
        -sin(theta) * u + cos(theta) * (sin(phi) * v + cos(phi) * w),
    )


def simulate(pi, tilt, wrench, h, start, coupled=True, given=None):
    """Fourth-order Runge-Kutta, a step a row.

    tilt: [n, 4] phi theta p q at the ends of the steps, interpolated within them; wrench: [n, 4]
    constant during them; h: [n] or a number, their lengths [s]; start: u v w r depth at the end of
    step 0; coupled: with the terms of C(nu); given: [n, 4] velocities, of which those whose mass in
    pi is 0 are used. -> [n, 5]; NaN from where it diverges.
    """
    pi, tilt, wrench = [float(x) for x in pi], tilt.tolist(), wrench.tolist()
    h = np.broadcast_to(h, len(tilt)).tolist()
    held = [i for i in range(4) if pi[i] == 0]
    model = (pi, pi[:3] if coupled else [0.0] * 3, [1 / m if m else 0.0 for m in pi[:4]])
    out = np.full((len(tilt), 5), np.nan)
    x = out[0] = tuple(float(s) for s in start)

    def ahead(x, rate, by):
        return tuple(a + by * b for a, b in zip(x, rate))

    for k in range(1, len(tilt)):
        a, b, f, step = tilt[k - 1], tilt[k], wrench[k], h[k]
        middle = [(one + other) / 2 for one, other in zip(a, b)]
        k1 = derivative(*model, *a, x, f)
        k2 = derivative(*model, *middle, ahead(x, k1, step / 2), f)
        k3 = derivative(*model, *middle, ahead(x, k2, step / 2), f)
        k4 = derivative(*model, *b, ahead(x, k3, step), f)
        x = tuple(s + step / 6 * (c1 + 2 * c2 + 2 * c3 + c4)
                  for s, c1, c2, c3, c4 in zip(x, k1, k2, k3, k4))
        if held:
            x = tuple(given[k, i] if i in held else x[i] for i in range(5))
        if not max(abs(s) for s in x[:4]) < 1e3:
            break
        out[k] = x
    return out


def r2(measured, predicted):
    """Coefficient of determination; minus infinity if the prediction has diverged."""
    if not np.all(np.isfinite(predicted)):
        return -np.inf
    return 1 - np.sum((measured - predicted) ** 2) / np.sum((measured - np.mean(measured)) ** 2)
