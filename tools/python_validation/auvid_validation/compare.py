"""One comparison: what auvid computes against what somebody else does."""
import dataclasses

import numpy as np

EPSILON = float(np.finfo(np.float32).eps)

#: What the double build may differ by, relative to the largest value compared.
DOUBLE = 1e-9


@dataclasses.dataclass
class Row:
    quantity: str
    reference: str
    difference: float  # the largest
    bound: float
    unit: str  # of both
    why: str  # the bound is what it is

    @property
    def passed(self):
        return bool(self.difference <= self.bound)  # NaN does not pass


def close(lib, quantity, reference, pairs, unit, roundings, why, rounding=EPSILON):
    """A row for pairs of arrays (ours, theirs). The bound in single precision is `roundings` times
    epsilon (or another `rounding`) times the largest |theirs| of the pair (a third of a triple:
    what stands in its place), in double precision 1e-9 times that. Differences and bound are in
    `unit`; they are relative to that largest value when it differs from pair to pair and unit says
    so ("relative ...")."""
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
    """A row for a comparison that is exact."""
    return Row(quantity, reference, wrong, 0, f"of {tried} {what}", "exact")
