"""The paper's vehicle, Eq. 12-15 with Fossen's m_w w p in Eq. 13, in numpy and double: written
from the matrices of Eq. 1, M nu' + C(nu) nu + D(nu) nu + g = tau, not from the library."""
import numpy as np

#: The paper's 13 estimates, in its order.
TRUTH = np.array([249.5384, 367.7126, 659.9799, 74.9024, -37.3058, -42.4181, -125.3578, -75.7673,
                  -447.6195, -44.0561, -325.0138, -20.5833, -60.9373])
#: The modelled degrees of freedom.
DRIVEN = np.array([0, 1, 2, 5])


def cross(a, b):
    """a x b. numpy's takes ten times as long for three numbers."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]])


def forces(pi, phi, theta, nu):
    """C(nu) nu + D(nu) nu + g of X, Y, Z, N."""
    mass, weight = np.diag(pi[:3]), pi[4]
    momentum, omega = mass @ nu[:3], nu[3:]
    # Fossen 2011, Eq. 3.57 for a diagonal mass: omega x (M v), and v x (M v) of yaw.
    coriolis = np.r_[cross(omega, momentum), cross(nu[:3], momentum)[2]]
    up = np.array([np.sin(theta), -np.cos(theta) * np.sin(phi), -np.cos(theta) * np.cos(phi), 0])
    moved = nu[DRIVEN]
    return coriolis + weight * up - (pi[5::2] + pi[6::2] * np.abs(moved)) * moved


def wrench(pi, phi, theta, nu, nu_dot):
    """Eq. 2: the X, Y, Z, N of this motion."""
    return pi[:4] * nu_dot[DRIVEN] + forces(pi, phi, theta, nu)


def acceleration(pi, phi, theta, nu, tau):
    """u', v', w', r' under tau."""
    return (tau[DRIVEN] - forces(pi, phi, theta, nu)) / pi[:4]


def regressor(phi, theta, nu, nu_dot):
    """The rows with wrench = row . pi, (4, 13): the wrench is linear in pi."""
    return np.array([wrench(one, phi, theta, nu, nu_dot) for one in np.eye(13)]).T
