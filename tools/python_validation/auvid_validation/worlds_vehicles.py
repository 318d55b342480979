"""The four vehicles: what their user knows (drawings, data sheet, a vehicle file), and the true
vehicle, drawn for each run about a typical one.

Typical values. A: BlueROV2 (Wu 2018), top speed 1.5 m/s, T200 at 16 V. B: ROVs of the class of a
Falcon. C: hovering AUVs of 400 kg. D: REMUS 100 (Prestero 2001).
"""
from typing import NamedTuple

import numpy as np

from auvid_validation.worlds_physics import (G, PROPELLER, RHO, RUDDER, STERN_PLANE, Hull,
                                             Thrusters)

DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
HALF = np.sqrt(0.5)


class Vehicle(NamedTuple):
    title: str
    model: str
    fast: bool          # faster than its DVL
    mass: float         # [kg]
    box: tuple          # length, width, height [m]
    floating: float     # (B - W) / W
    bg: float           # righting arm [m]
    inertia: tuple      # diagonal
    added: tuple        # diagonal
    quadratic: tuple    # drag of X, Y, Z at 1 m/s
    linear: tuple       # of six axes
    level: tuple        # largest wrench that its user asks for
    thrusters: list     # (position, direction) of each
    full: tuple         # static thrust ahead and astern [N]
    gamma: float        # exponent of the thrust curve
    dead: float         # dead band
    n_d: float          # n D of the propeller at full speed [m/s]
    diameter: float     # of the propeller [m]
    battery: bool       # the voltage varies
    dofs: tuple         # that its user excites
    omega: float        # bandwidth of the autopilot [rad/s]
    speed: float        # of the survey [m/s]
    tether: float = 0.0     # its drag [N s2/m2]
    fin: float = 0.0        # rho S CLalpha / 2 of a pair
    x_fin: float = 0.0
    fin_angle: float = 0.0  # largest
    fin_speed: float = 0.0  # at which the user states the force of a fin


def vectored(x, y, z):
    """Four horizontal thrusters at 45 degrees."""
    return [((x, y, z), (HALF, -HALF, 0)), ((x, -y, z), (HALF, HALF, 0)),
            ((-x, y, z), (-HALF, -HALF, 0)), ((-x, -y, z), (-HALF, HALF, 0))]


VEHICLES = {
    "A": Vehicle("small ROV", "girona500", True, 11.2, (0.46, 0.34, 0.25), 0.015, 0.055,
                 (0.20, 0.24, 0.28), (5.8, 10.5, 15.5, 0.13, 0.14, 0.16), (60, 105, 165),
                 (4, 6, 8, 0.07, 0.08, 0.08), (35, 32, 34, 0, 0, 4.0),
                 vectored(0.15, 0.11, 0.03) + [((0, y, 0), (0, 0, -1)) for y in (0.11, -0.11)],
                 (51.5, 40.2), 1.6, 0.06, 4.4, 0.076, True, (0, 1, 2, 5), 1.2, 0.4, tether=12.0),
    "B": Vehicle("work ROV", "fossen", True, 35.0, (0.80, 0.55, 0.45), 0.008, 0.06,
                 (1.5, 2.2, 2.7), (19, 30, 46, 1.0, 1.4, 1.3), (135, 230, 330),
                 (8, 12, 16, 0.4, 0.5, 0.5), (90, 80, 100, 9, 10, 18),
                 vectored(0.28, 0.20, 0.04) + [((x, y, -0.05), (0, 0, -1))
                                               for x in (0.22, -0.22) for y in (0.24, -0.24)],
                 (110, 85), 2.0, 0.04, 4.7, 0.11, True, (0, 1, 2, 3, 4, 5), 1.0, 0.45, tether=16.0),
    "C": Vehicle("hovering AUV", "girona500", False, 400.0, (2.4, 0.9, 0.95), 0.004, 0.07,
                 (52, 165, 160), (55, 250, 320, 14, 70, 55), (115, 480, 590),
                 (12, 25, 30, 8, 12, 10), (150, 130, 150, 0, 0, 70),
                 [((-0.7, 0.42, 0), (1, 0, 0)), ((-0.7, -0.42, 0), (1, 0, 0)),
                  ((0.75, 0, 0), (0, 1, 0)), ((-0.8, 0, 0), (0, 1, 0)),
                  ((0.6, 0, -0.1), (0, 0, 1)), ((-0.6, 0, -0.1), (0, 0, 1))],
                 (150, 120), 2.0, 0.02, 4.0, 0.16, False, (0, 1, 2, 5), 0.4, 0.6),
    "D": Vehicle("torpedo AUV", "fossen", False, 33.0, (1.65, 0.19, 0.19), 0.004, 0.02,
                 (0.17, 4.2, 4.2), (1.0, 0, 0, 0.06, 0, 0), (3.6, 0, 0),
                 (1.0, 3, 3, 0.12, 1.5, 1.5), (18, 0, 0, 0, 2.2, 5.0),
                 [((-0.82, 0, 0), (1, 0, 0)), ((-0.68, 0, 0), (0, 1, 0)),
                  ((-0.68, 0, 0), (0, 0, 1))],
                 (20, 12), 2.0, 0.03, 3.4, 0.14, False, (0, 4, 5), 0.8, 1.4,
                 fin=18.0, x_fin=-0.68, fin_angle=0.26, fin_speed=1.5),
}


def data_sheet(vehicle):
    """Largest forces ahead and astern of all thrusters, and the matrix from them to the wrench."""
    forward, backward = (np.full(len(vehicle.thrusters), float(x)) for x in vehicle.full)
    if vehicle.fin:
        forward[1:] = backward[1:] = round(vehicle.fin * vehicle.fin_speed ** 2
                                           * vehicle.fin_angle, 1)
    matrix = np.array([np.r_[d, np.cross(p, d)] for p, d in vehicle.thrusters], float).T
    return forward, backward, matrix


def allocation(vehicle):
    """Matrix from wrench to forces. Each fin of the torpedo is asked for its moment."""
    matrix = data_sheet(vehicle)[2]
    out = np.zeros((matrix.shape[1], 6))
    if vehicle.fin:
        out[0, 0], out[1, 5], out[2, 4] = 1, 1 / vehicle.x_fin, -1 / vehicle.x_fin
    else:
        dofs = list(vehicle.dofs)
        out[:, dofs] = np.linalg.pinv(matrix[dofs])
    return out


def vehicle_file(name):
    """Text of the vehicle file of a user who has the drawings and the data sheet."""
    v = VEHICLES[name]
    forward, backward, _ = data_sheet(v)
    lines = ["[vehicle]", f"name = world_{name.lower()}", f"title = {v.title}",
             f"model = {v.model}", f"dry_mass_kg = {v.mass:g}"] + ["fast = yes"] * v.fast
    for i, (position, direction) in enumerate(v.thrusters):
        lines += ["", f"[thruster.{i + 1}]",
                  "position_m = " + " ".join(f"{x:g}" for x in position),
                  "direction = " + " ".join(f"{x:g}" for x in np.round(direction, 4)),
                  f"forward_N = {forward[i]:g}", f"backward_N = {backward[i]:g}",
                  "group = " + ("fins" if v.fin and i else "propellers")]
    lines += ["", "[group.propellers]", "map = signed-square"]
    lines += ["", "[group.fins]", "map = linear"] if v.fin else \
        ["", "[allocation]", "dofs = " + " ".join(DOFS[i] for i in v.dofs)]
    return "\n".join(lines) + "\n"


def around(rng, x, share=0.15):
    x = np.asarray(x, float)
    return x * rng.uniform(1 - share, 1 + share, x.shape)


def draw_box(vehicle, rng):
    """Elements of a frame or box: 3 x 2 x 2, of unequal share, and more drag astern than ahead."""
    position = np.array([(x, y, z) for x in (-0.42, 0, 0.42) for y in (-0.4, 0.4)
                         for z in (-0.4, 0.4)]) * vehicle.box
    share = rng.uniform(0.6, 1.4, position.shape)
    area = (share / share.sum(0) * around(rng, vehicle.quadratic))[:, :, None] * np.ones(2)
    area[:, :, 1] *= rng.uniform([0.9, 0.97, 0.85], [1.35, 1.03, 1.25])
    mix = rng.uniform(0, 0.4, (3, 3))
    np.fill_diagonal(mix, 1)
    exponent = float(rng.uniform(0, 0.15))
    m_a = np.diag(around(rng, vehicle.added))
    for i, j in ((0, 4), (1, 3), (1, 5), (2, 4)):
        m_a[i, j] = m_a[j, i] = rng.uniform(-0.12, 0.12) * np.sqrt(m_a[i, i] * m_a[j, j])
    lift = rng.uniform(0, 0.25) * vehicle.quadratic[1] * (vehicle.box[0] > 2)
    arm = np.array(vehicle.box)[[2, 0, 0]] / 2
    quadratic = np.r_[np.zeros(3), 0.3 * np.array(vehicle.quadratic)[[1, 2, 1]] * arm ** 3]
    return position, area, mix, exponent, m_a, lift, -0.2 * vehicle.box[0], quadratic


def draw_cylinder(vehicle, rng):
    """Fifteen strips of a body of revolution; its added masses are of slender-body theory."""
    length, diameter = around(rng, vehicle.box[0], 0.02), around(rng, vehicle.box[1], 0.05)
    x, dx = (np.arange(15) - 7) / 15 * length, length / 15
    taper = np.clip(np.minimum((length / 2 - x) / 0.22, (x + length / 2) / 0.45), 0, 1) ** 0.5
    d = diameter * taper
    area = np.zeros((15, 3, 2))
    area[:, 1:] = (0.5 * RHO * around(rng, 1.1) * d * dx)[:, None, None]
    area[7, 0] = around(rng, vehicle.quadratic[0]) * np.array([1, rng.uniform(1.0, 1.4)])
    mix = np.array([[1.0, 0, 0], [0, 1, 1], [0, 1, 1]])
    a = RHO * np.pi / 4 * d ** 2 * dx
    a[np.argmin(abs(x - vehicle.x_fin))] += around(rng, 1.2)  # fins
    m_a = np.diag(around(rng, vehicle.added))
    m_a[1, 1] = m_a[2, 2] = a.sum()
    m_a[4, 4] = m_a[5, 5] = (a * x * x).sum()
    m_a[1, 5] = m_a[5, 1] = (a * x).sum()
    m_a[2, 4] = m_a[4, 2] = -m_a[1, 5]
    lift = (0.5 * RHO * diameter ** 2 * 0.003 * length / diameter * 180 / np.pi
            * rng.uniform(0.6, 1.2))
    return np.c_[x, np.zeros((15, 2))], area, mix, 0.0, m_a, lift, -0.15 * length, np.zeros(6)


def draw_hull(vehicle, rng, perfect):
    """The true hull. perfect: in the form of auvid's models, diagonal, symmetric and r_G = 0."""
    mass, bg = around(rng, vehicle.mass, 0.02), around(rng, vehicle.bg)
    inertia, linear = np.diag(around(rng, vehicle.inertia)), around(rng, vehicle.linear)
    weight = mass * G
    buoyancy = weight * (1 + vehicle.floating * rng.uniform(0.3, 1.6))
    r_g = np.array([rng.normal(0, 0.003), rng.normal(0, 0.002), bg * rng.uniform(0.4, 0.7)])
    r_b = np.array([r_g[0] + rng.normal(0, 0.02) * bg, r_g[1] + rng.normal(0, 0.02) * bg,
                    r_g[2] - bg])
    fin = around(rng, vehicle.fin)
    position, area, mix, exponent, m_a, lift, x_lift, quadratic = \
        (draw_cylinder if vehicle.fin else draw_box)(vehicle, rng)
    munk = 0.0 if perfect or fin else rng.uniform(0.1, 0.5)
    if perfect:  # of the same size, without elements
        quadratic[:3] = area[:, :, 0].sum(0)
        for i, (j, k) in enumerate(((1, 2), (0, 2), (0, 1))):
            quadratic[3 + i] += (area[:, k, 0] * abs(position[:, j]) ** 3
                                 + area[:, j, 0] * abs(position[:, k]) ** 3).sum()
        if fin:  # their lift is linear in side slip at 1.5 m/s
            arms = np.array([0, 1, 1, 0, vehicle.x_fin ** 2, vehicle.x_fin ** 2])
            linear, fin = linear + fin * 1.5 * arms, 0.0
        area, m_a, lift, exponent = 0 * area, np.diag(np.diag(m_a)), 0.0, 0.0
        r_g, r_b = np.zeros(3), np.array([0, 0, -bg])
    s = np.cross(r_g, np.eye(3)).T  # r_g x, as a matrix
    m_rb = np.block([[mass * np.eye(3), -mass * s], [mass * s, inertia - mass * s @ s]])
    return Hull(m_rb, m_a, np.linalg.inv(m_rb + m_a), float(weight), float(buoyancy), r_g, r_b,
                float(buoyancy / RHO / G), linear, quadratic, position, area, mix, exponent,
                float(lift), float(x_lift), munk, float(fin), vehicle.x_fin)


def draw_thrusters(vehicle, hull, rng, perfect, still):
    """The true thrusters: weaker or stronger than the data sheet, late, and, unless still, slower
    in a stream."""
    n, e = len(vehicle.thrusters), 0.0 if perfect else 1.0
    forward, backward, _ = data_sheet(vehicle)
    kind = np.full(n, PROPELLER)
    common = 1 + e * (rng.normal(0, 0.04) - rng.uniform(0, 0.08))  # the second: thrust deduction
    forward = forward * common * (1 + e * rng.normal(0, 0.03, n))
    backward = backward * common * (1 + e * (rng.normal(0, 0.03) + rng.normal(0, 0.03, n)))
    if vehicle.fin:
        kind[1:] = RUDDER, STERN_PLANE
        forward[1:] = vehicle.fin_angle * (1 + e * (rng.normal(0, 0.06) + rng.normal(0, 0.03, 2)))
        forward[1:] *= vehicle.fin / (hull.fin or vehicle.fin)  # its user knows the area
        backward[1:] = vehicle.fin * vehicle.fin_angle
    position = np.array([p for p, _ in vehicle.thrusters], float)
    position += e * rng.normal(0, 0.008 * max(1, vehicle.box[0]), (n, 3))
    direction = np.array([d for _, d in vehicle.thrusters], float)
    direction += e * rng.normal(0, 0.02, (n, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    lag = rng.uniform(0.05, 0.3) * rng.uniform(0.9, 1.1, n)
    voltage = np.array([rng.normal(0, 0.015), rng.uniform(0.01, 0.06), rng.uniform(0, 0.03)])
    k_a, k_b = rng.uniform([0.65, 0.25], [0.9, 0.5]) * (not still)
    wake, hand = rng.uniform(0, 0.2), np.where(np.arange(n) % 2, 1.0, -1.0)
    return Thrusters(kind, position, direction, forward, backward,
                     float(vehicle.gamma * (1 + e * rng.normal(0, 0.03))),
                     float(max(0.0, vehicle.dead + e * rng.normal(0, 0.008))),
                     np.full(n, 0.021) if perfect else lag, k_a, k_b, vehicle.n_d, wake,
                     e * 0.13 * vehicle.diameter * hand, e * voltage * vehicle.battery)
