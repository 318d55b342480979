"""One comparison of a result of auvid with an independent one."""
import dataclasses

import numpy as np

EPSILON = float(np.finfo(np.float32).eps)

#: Largest difference of the double build, relative to the largest compared value.
DOUBLE = 1e-9


@dataclasses.dataclass
class Row:
    quantity: str
    reference: str
    difference: float  # the largest
    bound: float
    unit: str  # of both
    why: str  # the bound is given

    @property
    def passed(self):
        return bool(self.difference <= self.bound)  # NaN fails


def close(lib, quantity, reference, pairs, unit, roundings, why, rounding=EPSILON):
    """A row for pairs of arrays (ours, theirs). The bound in single precision is `roundings` times
    epsilon (or another `rounding`) times the largest |theirs| of the pair (of a triple: its
    third element instead), in double precision 1e-9 times that. Differences and bound are in
    `unit`; they are relative to that largest value if it differs between pairs and unit says so
    ("relative ...")."""
    share = roundings * rounding
    if lib.real == np.float64:
        share, why = DOUBLE, f"{DOUBLE:.0e} of it"
    worst = (-1.0, 0.0, 0.0)
    for ours, theirs, *scale in pairs:
        ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
        if ours.shape != theirs.shape:
            raise ValueError(f"{quantity}: shapes {ours.shape} and {theirs.shape}")
        scale = np.max(np.abs(theirs)) if not scale else np.asarray(scale[0], float)
        off = np.abs(ours - theirs)
        part = np.where(off == 0, 0.0, off / scale)
        at = np.unravel_index(np.argmax(part), part.shape) if part.ndim else ()
        here = (float(part[at]), float(off[at]),
                float(np.broadcast_to(scale, part.shape)[at]))
        if not here[0] <= worst[0]:
            worst = here
    relative, off, scale = worst
    if unit.startswith("relative"):
        off, scale = relative, 1.0
    return Row(quantity, reference, off, share * scale, unit, why)


def counted(quantity, reference, wrong, tried, what):
    """A row for an exact comparison."""
    return Row(quantity, reference, wrong, 0, f"of {tried} {what}", "exact")
