"""Attitudes and axes, as arrays. Quaternions are w x y z, from body to world."""
import numpy as np

#: forward, left, up -> forward, right, down, and the reverse
FLIP = np.array([1.0, -1.0, -1.0])


def ned_frd(q):
    """An attitude in ENU and FLU (REP 103) as one in NED and FRD."""
    w, x, y, z = np.moveaxis(np.asarray(q, float), -1, 0)
    return np.stack([w + z, x + y, x - y, w - z], axis=-1) / np.sqrt(2.0)


def to_quaternion(angles):
    """Roll, pitch, yaw [rad] as a quaternion."""
    half = np.asarray(angles, float) / 2
    (cx, cy, cz), (sx, sy, sz) = np.moveaxis(np.cos(half), -1, 0), np.moveaxis(np.sin(half), -1, 0)
    return np.stack([cx * cy * cz + sx * sy * sz, sx * cy * cz - cx * sy * sz,
                     cx * sy * cz + sx * cy * sz, cx * cy * sz - sx * sy * cz], axis=-1)


def to_angles(q):
    """A quaternion as roll, pitch, yaw [rad]."""
    w, x, y, z = np.moveaxis(np.asarray(q, float), -1, 0)
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    return np.stack([np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), pitch,
                     np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))], axis=-1)


def to_body(q, world):
    """A vector of the world in body axes."""
    v, axis = np.asarray(world, float), -np.asarray(q, float)[..., 1:]
    turned = 2 * np.cross(axis, v)
    return v + np.asarray(q, float)[..., :1] * turned + np.cross(axis, turned)


def _neighbours(t, times):
    """Indices of the samples before and after each time, and how far it is between them."""
    after = np.clip(np.searchsorted(times, t), min(1, len(times) - 1), len(times) - 1)
    before = np.maximum(after - 1, 0)
    gap = np.maximum(times[after] - times[before], 1e-12)
    return before, after, np.clip((t - times[before]) / gap, 0, 1)[:, None]


def interpolate(t, times, values):
    """Values at the times t: linear; beyond both ends, the first and the last."""
    before, after, part = _neighbours(t, times)
    return values[before] + part * (values[after] - values[before])


def interpolate_attitude(t, times, q):
    """The same of quaternions: the shorter way, normalised."""
    before, after, part = _neighbours(t, times)
    near, far = q[before], q[after]
    far = np.where(np.sum(near * far, axis=1, keepdims=True) < 0, -far, far)
    mean = near + part * (far - near)
    return mean / np.linalg.norm(mean, axis=1, keepdims=True)


def hold(t, times, values):
    """The last value at or before each time; before the first sample, the first."""
    return values[np.maximum(np.searchsorted(times, t, side="right") - 1, 0)]
