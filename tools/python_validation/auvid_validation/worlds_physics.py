"""A rigid body in water: six degrees of freedom after Fossen (2021), chapters 3, 6, 8 and 10.

The state is position (NED), quaternion (body to NED), nu (body), and the speed of each thruster as
a fraction of its largest. The hull is a set of Morison elements: each has a drag area in each body
axis and sees its own velocity through the water. So cross-flow drag (strip theory), the coupling of
sway and yaw, and moments of drag follow from the elements.
"""
from collections import namedtuple

import numpy as np
from numba import njit

RHO, G = 1025.0, 9.81

# linear, quadratic: diagonal drags; position, area: of the elements, area[k, axis, 0 ahead,
# 1 astern] = rho Cd A / 2; mix: whose velocities count in the drag of an axis; exponent: of Cd over
# the Reynolds number; lift, x_lift: of the body; munk: lost share of the Munk moment; fin:
# rho S CLalpha / 2 of a pair at x_fin, 0 for none
Hull = namedtuple("Hull", "m_rb m_a m_inverse weight buoyancy r_g r_b volume linear quadratic "
                  "position area mix exponent lift x_lift munk fin x_fin")
# kind: propeller, rudder or stern plane; forward, backward: static thrust at full speed [N], of a
# fin its largest angle [rad]; k_a, k_b: open-water curve; n_d: n D at full speed [m/s]; torque:
# over thrust [m]; voltage: offset, fall over the run, fall at full load
Thrusters = namedtuple("Thrusters", "kind position direction forward backward gamma dead lag "
                       "k_a k_b n_d wake torque voltage")
# Components of the water's velocity; a current has k = 0. tether: its drag [N s2/m2] at `attached`,
# and its pull [N, NED]
Water = namedtuple("Water", "omega k_north k_east k north east down phase tether attached pull")
PROPELLER, RUDDER, STERN_PLANE = 0, 1, 2


@njit(cache=True)
def rotation(q):
    """Matrix from body to NED of a quaternion."""
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


@njit(cache=True)
def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]])


@njit(cache=True)
def coriolis(m, nu):
    """C(nu) nu of Kirchhoff's equations for a symmetric 6x6 mass."""
    p = m @ nu
    out = np.empty(6)
    out[:3] = cross(nu[3:], p[:3])
    out[3:] = cross(nu[3:], p[3:]) + cross(nu[:3], p[:3])
    return out


@njit(cache=True)
def fin_force(hull, v, rudder, stern):
    """Rudder and stern plane: linear lift with stall, and the drag that it induces."""
    out = np.zeros(6)
    for axis, turn, sign, angle in ((1, 5, 1.0, rudder), (2, 4, -1.0, stern)):
        side = v[axis] + sign * hull.x_fin * v[turn]
        speed = np.sqrt(v[0] ** 2 + side ** 2) + 1e-9
        attack = 0.35 * np.tanh((angle * v[0] - side) / speed / 0.35)
        force = hull.fin * speed ** 2 * attack
        out[axis] = force
        out[turn] = sign * hull.x_fin * force
        out[0] -= 0.4 * hull.fin * v[0] * np.abs(v[0]) * attack ** 2
    return out


@njit(cache=True)
def hull_force(hull, v):
    """Viscous force on the hull with its fins amidships; v is relative to the water."""
    out = -hull.linear * v - hull.quadratic * np.abs(v) * v
    f, s = np.empty(3), np.empty(3)
    for k in range(hull.position.shape[0]):
        x, y, z = hull.position[k]
        s[0] = v[0] + v[4] * z - v[5] * y
        s[1] = v[1] + v[5] * x - v[3] * z
        s[2] = v[2] + v[3] * y - v[4] * x
        for i in range(3):
            mix = hull.mix[i]
            c = np.sqrt(mix[0] * s[0] ** 2 + mix[1] * s[1] ** 2 + mix[2] * s[2] ** 2)
            if hull.exponent > 0:  # Cd is that of the area at 0.5 m/s, and larger below
                c = c * ((c + 0.01) / 0.5) ** -hull.exponent
            f[i] = -hull.area[k, i, 0 if s[i] > 0 else 1] * c * s[i]
        out[:3] += f
        out[3] += y * f[2] - z * f[1]
        out[4] += z * f[0] - x * f[2]
        out[5] += x * f[1] - y * f[0]
    if hull.lift > 0:
        x = hull.x_lift * np.tanh(v[0] / 0.05)
        side, down = -hull.lift * np.abs(v[0]) * v[1], -hull.lift * np.abs(v[0]) * v[2]
        out[1] += side
        out[5] += x * side
        out[2] += down
        out[4] -= x * down
    if hull.munk > 0:  # the wake takes a part of the moment of potential flow
        out[3:] += hull.munk * cross(v[:3], np.diag(hull.m_a)[:3] * v[:3])
    if hull.fin > 0:
        out += fin_force(hull, v, 0.0, 0.0)
    return out


@njit(cache=True)
def water_velocity(water, t, position):
    """Velocity and acceleration of the water (NED): linear deep-water waves, and a slow current."""
    v, a = np.zeros(3), np.zeros(3)
    for j in range(water.omega.shape[0]):
        omega = water.omega[j]
        phase = (water.k_north[j] * position[0] + water.k_east[j] * position[1] - omega * t
                 + water.phase[j])
        decay = np.exp(-water.k[j] * max(position[2], 0.5))
        c, s = decay * np.cos(phase), decay * np.sin(phase)
        v[0] += water.north[j] * c
        v[1] += water.east[j] * c
        v[2] -= water.down[j] * s
        a[0] += omega * water.north[j] * s
        a[1] += omega * water.east[j] * s
        a[2] += omega * water.down[j] * c
    return v, a


@njit(cache=True)
def thruster_force(thrusters, hull, n, v):
    """Wrench of all thrusters: K_T(J) = K_0 (1 - a J - b J^2) (Carlton 2019, chapter 6), so
    T = K n |n| - K a |n| V_a / (n D) - K b V_a |V_a| / (n D)^2, and the propeller's torque."""
    out = np.zeros(6)
    rudder, stern = 0.0, 0.0
    for i in range(len(n)):
        d, p = thrusters.direction[i], thrusters.position[i]
        if thrusters.kind[i] != PROPELLER and hull.fin == 0:  # an ideal fin
            f = thrusters.backward[i] * n[i] * v[0] ** 2 * d
            out[:3] += f
            out[3:] += cross(p, f)
        elif thrusters.kind[i] == RUDDER:
            rudder = thrusters.forward[i] * n[i]
        elif thrusters.kind[i] == STERN_PLANE:
            stern = thrusters.forward[i] * n[i]
        else:
            inflow = np.dot(v[:3] + cross(v[3:], p), d) * (1 - thrusters.wake)
            k = thrusters.forward[i] if n[i] > 0 else thrusters.backward[i]
            j = inflow / thrusters.n_d
            loss = thrusters.k_a * abs(n[i]) * j + thrusters.k_b * j * abs(j)
            f = (k * n[i] * abs(n[i]) - thrusters.forward[i] * loss) * d
            out[:3] += f
            out[3:] += cross(p, f) - thrusters.torque[i] * f
    if hull.fin > 0:
        out += fin_force(hull, v, rudder, stern) - fin_force(hull, v, 0.0, 0.0)
    return out


@njit(cache=True)
def derivative(hull, thrusters, water, t, y, target):
    """Time derivative of the state, the velocity through the water, and the tether's drag."""
    dy = np.empty_like(y)
    q, nu, n = y[3:7], y[7:13], y[13:]
    omega = nu[3:]
    r = rotation(q)
    r_t = np.ascontiguousarray(r.T)
    flow, flow_rate = water_velocity(water, t, y[:3])
    flow, flow_rate = r_t @ flow, r_t @ flow_rate
    nu_r = nu.copy()
    nu_r[:3] -= flow
    f = (hull_force(hull, nu_r) + thruster_force(thrusters, hull, n, nu_r)
         - coriolis(hull.m_rb, nu) - coriolis(hull.m_a, nu_r))
    seen = np.zeros(6)
    seen[:3] = flow_rate - cross(omega, flow)
    f += hull.m_a @ seen
    froude_krylov = RHO * hull.volume * flow_rate  # of the water that the hull displaces
    f[:3] += (hull.weight - hull.buoyancy) * r[2] + froude_krylov
    f[3:] += (cross(hull.r_g * hull.weight - hull.r_b * hull.buoyancy, r[2])
              + cross(hull.r_b, froude_krylov))
    rope = np.zeros(6)
    if water.tether > 0:
        v = nu_r[:3] + cross(omega, water.attached)
        rope[:3] = -water.tether * np.sqrt(np.dot(v, v)) * v
        rope[3:] = cross(water.attached, rope[:3])
        pull = r_t @ water.pull
        f[:3] += rope[:3] + pull
        f[3:] += rope[3:] + cross(water.attached, pull)
    dy[:3] = r @ nu[:3]
    dy[3] = -0.5 * (q[1] * omega[0] + q[2] * omega[1] + q[3] * omega[2])
    dy[4] = 0.5 * (q[0] * omega[0] + q[2] * omega[2] - q[3] * omega[1])
    dy[5] = 0.5 * (q[0] * omega[1] + q[3] * omega[0] - q[1] * omega[2])
    dy[6] = 0.5 * (q[0] * omega[2] + q[1] * omega[1] - q[2] * omega[0])
    dy[7:13] = hull.m_inverse @ f
    dy[13:] = (target - n) / thrusters.lag
    return dy, nu_r, rope


@njit(cache=True)
def rk4(hull, thrusters, water, t, y, target, dt):
    """The next state after Runge and Kutta; of this one the acceleration, the velocity through the
    water and the tether's drag."""
    k1, nu_r, rope = derivative(hull, thrusters, water, t, y, target)
    k2 = derivative(hull, thrusters, water, t + dt / 2, y + dt / 2 * k1, target)[0]
    k3 = derivative(hull, thrusters, water, t + dt / 2, y + dt / 2 * k2, target)[0]
    k4 = derivative(hull, thrusters, water, t + dt, y + dt * k3, target)[0]
    out = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    out[3:7] /= np.sqrt(np.sum(out[3:7] ** 2))
    return out, k1[7:13], nu_r, rope
