"""Who drives: a plan in open loop, a pilot whose depth or heading may be held, or a survey; and the
loop of the simulation, because feedback is a part of it."""
from collections import namedtuple

import numpy as np
from numba import njit

from auvid_validation.worlds_physics import PROPELLER, hull_force, rk4, rotation

OPEN_LOOP, PILOT, SURVEY = 0, 1, 2
# kp, ki, kd, limit: of each degree of freedom; depth_rate, heading_rate: of the set points at full
# stick; trim: heave; allocation: wrench to forces of the thrusters; forward, backward, gamma, dead:
# their data sheet
Pilot = namedtuple("Pilot", "mode has_fins holds_depth holds_heading kp ki kd limit depth_rate "
                   "heading_rate trim allocation forward backward gamma dead")
# Columns of a motion. The forces of the thrusters follow.
POSITION, ATTITUDE, NU, NU_DOT, NU_R = (slice(a, b) for a, b in
                                        ((0, 3), (3, 6), (6, 12), (12, 18), (18, 24)))
HULL_FORCE, TETHER_FORCE, FORCES = slice(24, 30), slice(30, 36), slice(36, None)


@njit(cache=True)
def euler(r):
    """ZYX angles of a matrix from body to NED."""
    return np.array([np.arctan2(r[2, 1], r[2, 2]), -np.arcsin(min(1.0, max(-1.0, r[2, 0]))),
                     np.arctan2(r[1, 0], r[0, 0])])


@njit(cache=True)
def wrap(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


@njit(cache=True)
def clip(x, limit):
    return min(limit, max(-limit, x))


@njit(cache=True)
def pid(pilot, i, memory, error, rate, dt):
    """PID with a limited integral."""
    memory[i] = clip(memory[i] + error * dt, 0.5 * pilot.limit[i] / max(pilot.ki[i], 1e-9))
    return pilot.kp[i] * error + pilot.ki[i] * memory[i] - pilot.kd[i] * rate


@njit(cache=True)
def open_loop(pilot, step, plan, depth, memory):
    """The plan, and every 30 s a constant push of 20 % if the depth is 4 m off."""
    tau = plan.copy()
    if step % 1500 == 0:
        memory[2] = 0.2 * np.sign(memory[6] - depth) * (abs(memory[6] - depth) > 4)
    if pilot.has_fins:
        tau[4] -= 0.6 * memory[2] * pilot.limit[4]
    else:
        tau[2] += pilot.trim + memory[2] * pilot.limit[2]
    return tau


@njit(cache=True)
def control(pilot, plan, reference, position, attitude, nu, down_rate, memory, dt):
    """Wrench that pilot and autopilot ask for. memory: six integrals, set points of depth and
    heading. reference: north, east, depth, heading, speed."""
    tau, depth_error, heave = plan.copy(), 0.0, 4 if pilot.has_fins else 2
    if pilot.mode == PILOT:
        if pilot.holds_heading:
            memory[7] += pilot.heading_rate * plan[5] / pilot.limit[5] * dt
            tau[5] = pid(pilot, 5, memory, wrap(memory[7] - attitude[2]), nu[5], dt)
        if pilot.holds_depth:
            memory[6] += pilot.depth_rate * plan[heave] / pilot.limit[heave] * dt
            depth_error = memory[6] - position[2]
        elif abs(memory[6] - position[2]) > 2.5:  # a pilot looks at the depth now and then
            error = memory[6] - position[2]
            depth_error = 0.3 * (error - 2.5 * np.sign(error))
    else:
        north, east, psi = reference[0] - position[0], reference[1] - position[1], reference[3]
        ahead = np.cos(psi) * north + np.sin(psi) * east
        aside = -np.sin(psi) * north + np.cos(psi) * east
        psi += np.arctan(aside / 6) if pilot.has_fins else 0.0
        tau[5] = pid(pilot, 5, memory, wrap(psi - attitude[2]), nu[5], dt)
        speed = reference[4] + clip(0.1 * ahead, 0.3) * (not pilot.has_fins)
        tau[0] = pid(pilot, 0, memory, speed - nu[0], 0.0, dt)
        if not pilot.has_fins:
            tau[1] = pid(pilot, 1, memory, clip(aside, 1.0), nu[1], dt)
        depth_error = reference[2] - position[2]
    held = pilot.mode == SURVEY or pilot.holds_depth
    if pilot.has_fins:
        if held or depth_error != 0:
            memory[2] = clip(memory[2] + depth_error * dt, 8.0)
            pitch = clip(-0.12 * depth_error - 0.006 * memory[2] * held, 0.35)
            tau[4] = pid(pilot, 4, memory, pitch - attitude[1], nu[4], dt)
    elif held:
        tau[2] = pilot.trim + pid(pilot, 2, memory, clip(depth_error, 1.5), down_rate, dt)
    else:
        tau[2] += pilot.trim + clip(depth_error, 0.4) * pilot.limit[2]
    return np.minimum(pilot.limit, np.maximum(-pilot.limit, tau))


@njit(cache=True)
def commands(pilot, thrusters, force):
    """Shares of full command: the firmware inverts the curve of the data sheet. Forces within its
    dead band become 0."""
    share = np.zeros(len(force))
    for i in range(len(force)):
        x = force[i] / (pilot.forward[i] if force[i] > 0 else pilot.backward[i])
        if thrusters.kind[i] != PROPELLER:
            share[i] = x
        elif abs(x) < 0.002:
            force[i] = 0
        else:
            share[i] = np.sign(x) * (pilot.dead + (1 - pilot.dead) * abs(x) ** (1 / pilot.gamma))
    return share


@njit(cache=True)
def speeds(thrusters, share, run):
    """Speeds that true thrusters approach: dead band, curve, and the battery. run: its share that
    is over."""
    load = np.mean(np.abs(share) ** 1.5)
    v = thrusters.voltage
    voltage = (1 + v[0] - v[1] * run - v[2] * load) ** 0.75
    out = np.empty(len(share))
    for i in range(len(share)):
        out[i] = share[i]
        if thrusters.kind[i] == PROPELLER:
            x = max(abs(share[i]) - thrusters.dead, 0.0) / (1 - thrusters.dead)
            out[i] = np.sign(share[i]) * x ** (thrusters.gamma / 2) * voltage
    return out


@njit(cache=True)
def simulate(hull, thrusters, water, pilot, plan, reference, noise, y, dt):
    """A motion: a row for each step, with the columns above. noise: of the position, attitude and
    velocity that the autopilot sees."""
    n, count = len(plan), len(thrusters.forward)
    out = np.zeros((n, 36 + count))
    memory = np.zeros(8)
    memory[6], memory[7] = y[2], euler(rotation(y[3:7]))[2]
    for k in range(n):
        r = rotation(y[3:7])
        attitude = euler(r)
        position, nu = y[:3] + noise[k, :3], y[7:13] + noise[k, 6:]
        if pilot.mode == OPEN_LOOP:
            tau = open_loop(pilot, k, plan[k], position[2], memory)
        else:
            tau = control(pilot, plan[k], reference[k], position, attitude + noise[k, 3:6], nu,
                          np.dot(r[2], nu[:3]), memory, dt)
        force = np.minimum(pilot.forward, np.maximum(-pilot.backward, pilot.allocation @ tau))
        target = speeds(thrusters, commands(pilot, thrusters, force), k / n)
        following, nu_dot, nu_r, rope = rk4(hull, thrusters, water, k * dt, y, target, dt)
        out[k, :3], out[k, 3:6], out[k, 6:12], out[k, 12:18] = y[:3], attitude, y[7:13], nu_dot
        out[k, 18:24], out[k, 24:30], out[k, 30:36] = nu_r, hull_force(hull, nu_r), rope
        out[k, 36:] = force
        y = following
    return out
