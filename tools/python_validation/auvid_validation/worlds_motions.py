"""What the vehicle does, and the water about it: excitation, sticks, a lawnmower's track."""
import numpy as np

from auvid_validation.worlds_physics import G, Water
from auvid_validation.worlds_pilot import OPEN_LOOP, PILOT, SURVEY, Pilot
from auvid_validation.worlds_vehicles import allocation, data_sheet

MOTIONS = {"excited": OPEN_LOOP, "joystick": PILOT, "survey": SURVEY, "single": OPEN_LOOP}
BLOCK_S, LONG_S = 30, 600


def steps(rng, n, dt):
    """Steps of 4 to 8 s, each followed by its opposite, so that the vehicle comes back."""
    out = []
    while len(out) < n:
        k = int(rng.uniform(4, 8) / dt)
        a = rng.choice([0.33, 0.67, 1.0]) * rng.choice([-1, 1])
        out += [a] * k + [-a] * k
    return np.array(out[:n])


def triangles(rng, n, dt):
    t = np.arange(n) * dt
    return 2 / np.pi * np.arcsin(np.sin(2 * np.pi * t / rng.uniform(8, 15))) * rng.choice([-1, 1])


def sines(rng, n, dt):
    """One sine, or a sum of three to five, of 0.05 to 0.3 Hz."""
    k = rng.choice([1, 3, 4, 5])
    f = rng.uniform(0.08 if k == 1 else 0.05, 0.3, k)
    t = np.arange(n)[:, None] * dt
    s = np.sin(2 * np.pi * f * t + rng.uniform(0, 2 * np.pi, k)).sum(1)
    return s / np.abs(s).max()


def any_shape(vehicle, rng, n, dt, dof):
    shape = [steps, triangles, sines, sines][rng.integers(4)]
    return shape(rng, n, dt) * vehicle.level[dof] * rng.uniform(0.6, 1)


def excited(vehicle, rng, dt):
    """Four to eight minutes in blocks of 30 s; in each most of the axes are excited."""
    blocks, n = int(rng.integers(8, 17)), int(BLOCK_S / dt)
    plan = np.zeros((blocks, n, 6))
    for block in plan:
        for i in vehicle.dofs:
            if rng.random() < 0.8:
                block[:, i] = any_shape(vehicle, rng, n, dt, i)
    if vehicle.fin:  # steps of thrust about a cruise, zigzags of the rudder
        for block in plan:
            cruise = np.clip(0.55 + 0.4 * steps(rng, n, dt), 0.12, 1)
            block[:, 0] = vehicle.level[0] * cruise
            zigzag = (steps if rng.random() < 0.5 else sines)(rng, n, dt)
            block[:, 5] = vehicle.level[5] * rng.uniform(0.5, 1) * zigzag
            block[:, 4] *= 0.6
    return plan.reshape(-1, 6)


def single(vehicle, rng, dt):
    """The same shapes for six minutes, but one axis at a time."""
    n = int(BLOCK_S / dt)
    plan = np.zeros((12, n, 6))
    for b, block in enumerate(plan):
        i = vehicle.dofs[b % len(vehicle.dofs)]
        block[:, i] = any_shape(vehicle, rng, n, dt, i)
    if vehicle.fin:
        plan[:, :, 0] = vehicle.level[0] * 0.55 + 0.4 * plan[:, :, 0]
    return plan.reshape(-1, 6)


def stick(rng, n, dt, rest):
    """A stick that is held at random places, and moved there within 0.3 s."""
    out = []
    while len(out) < n:
        a = 0.0 if rng.random() < rest else rng.uniform(0.2, 1) * rng.choice([-1, 1])
        out += [a] * int(min(rng.exponential(3) + 0.6, 12) / dt)
    k = int(0.3 / dt)
    return np.convolve(np.array(out[:n]), np.ones(k) / k, "same")


def joystick(vehicle, rng, dt):
    """Ten minutes of a pilot."""
    n = int(LONG_S / dt)
    plan = np.zeros((n, 6))
    for i in vehicle.dofs:
        if i in (0, 1, 2, 5) or vehicle.fin:
            rest = 0.55 if i in (2, 4) else 0.35
            plan[:, i] = stick(rng, n, dt, rest) * vehicle.level[i] * (0.5 if i == 4 else 1)
    if vehicle.fin:
        top = vehicle.level[0]
        plan[:, 0] = top * np.clip(0.6 + 0.5 * plan[:, 0] / top, 0.12, 1)
    return plan


def lawnmower(vehicle, rng, dt, depth):
    """Reference of a survey of ten minutes: north, east, depth, heading and speed at each step."""
    n = int(LONG_S / dt)
    leg, gap = (60.0, 14.0) if vehicle.fin else (rng.uniform(12, 25), rng.uniform(2, 4))
    s = np.arange(n) * dt * vehicle.speed
    k, along = np.divmod(s, leg + gap)
    even = k % 2 == 0
    x = np.where(along < leg, np.where(even, along, leg - along), np.where(even, leg, 0))
    y = k * gap + np.clip(along - leg, 0, gap)
    psi = np.where(along < leg, np.where(even, 0, np.pi), np.pi / 2)
    depth = depth + 1.0 * (k % 2) + 0.3 * np.sin(2 * np.pi * s / 40)
    return np.c_[x, y, depth, psi, np.full(n, vehicle.speed)]


def draw_pilot(vehicle, hull, rng, motion):
    """The driver. The gains of its PID are from masses within 20 %."""
    m = np.diag(hull.m_rb + hull.m_a) * rng.uniform(0.8, 1.2)
    omega, mode = vehicle.omega, MOTIONS[motion]
    kp, kd = m * omega * omega, 1.6 * m * omega
    kp[0], kd[0] = m[0] * omega, 0.0
    kp[4] += 6.0 * (vehicle.fin > 0)
    hold = (rng.random(2) < (0.6, 0.4)) & (mode == PILOT)
    forward, backward, _ = data_sheet(vehicle)
    trim = (hull.buoyancy - hull.weight) * rng.uniform(0.8, 1.2) * (vehicle.fin == 0)
    return Pilot(mode, int(vehicle.fin > 0), int(hold[0]), int(hold[1]), kp, kp * omega * 0.15, kd,
                 np.array(vehicle.level, float) * 1.3, 0.3, 0.6, float(trim), allocation(vehicle),
                 forward, backward, vehicle.gamma, vehicle.dead)


def draw_current(rng):
    """A mean and three slow changes: angular frequency, amplitude and heading of each."""
    speed, heading = rng.uniform(0.03, 0.15), rng.uniform(0, 2 * np.pi)
    omega = np.r_[0.0, 2 * np.pi / rng.uniform(120, 900, 3)]
    return omega, speed * np.r_[1.0, rng.uniform(0, 0.25, 3)], \
        heading + np.r_[0.0, rng.normal(0, 0.8, 3)]


def draw_waves(rng):
    """JONSWAP, gamma 3.3, deep water (Fossen 2021, 10.2): angular frequency, amplitude of velocity
    and heading of 24 components; and the depth of the dive."""
    height, period, depth = rng.uniform(0.1, 0.6), rng.uniform(4, 8), rng.uniform(5, 10)
    peak = 2 * np.pi / period
    edge = np.linspace(0.6, 2.3, 25) * peak
    width = np.diff(edge)
    o = edge[:-1] + rng.uniform(0, 1, 24) * width
    sigma = np.where(o < peak, 0.07, 0.09)
    s = (o ** -5.0 * np.exp(-1.25 * (peak / o) ** 4)
         * 3.3 ** np.exp(-((o / peak - 1) / sigma) ** 2 / 2))
    s *= (height / 4) ** 2 / (s * width).sum()
    heading = rng.uniform(0, 2 * np.pi) + rng.normal(0, 0.3, 24)
    return o, np.sqrt(2 * s * width) * o, heading, depth


def draw_water(vehicle, rng, perfect):
    """The water and the depth of the dive: current in 40 % of the runs, waves in 25 %, a tether in
    40 % of those of an ROV."""
    has_current, has_waves, has_tether = (rng.random(3) < (0.4, 0.25, 0.4)) & (not perfect)
    depth = rng.uniform(15, 40)
    omega, amplitude, heading = draw_current(rng) if has_current else np.zeros((3, 1))
    down, k = 0 * amplitude, 0 * amplitude
    if has_waves:
        o, a, h, depth = draw_waves(rng)
        omega, amplitude, heading = np.r_[omega, o], np.r_[amplitude, a], np.r_[heading, h]
        down, k = np.r_[down, a], np.r_[k, o * o / G]
    phase = np.where(omega > 0, rng.uniform(0, 2 * np.pi, len(omega)), 0.0)
    tether = vehicle.tether * rng.uniform(0.4, 1.2) * has_tether
    pull = np.r_[rng.normal(0, 0.4, 2), rng.uniform(-0.5, 0.5)] * vehicle.mass / 15
    north, east = np.cos(heading), np.sin(heading)
    return Water(omega, k * north, k * east, k, amplitude * north, amplitude * east, down, phase,
                 float(tether), np.array([-0.4, 0, -0.3]) * vehicle.box, pull), depth
