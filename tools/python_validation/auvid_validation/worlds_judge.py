"""The truth of a dive by the names of auvid's parameters, and which answers are wrong.

Masses are M_RB + M_A. Drags are those that describe the true force of hull and tether best, in the
sense of least squares, along the true motion through the water: the pseudo-true values (Ljung 1999,
8.5). The drag force in one direction is that of the motion in this direction. An answer is wrong,
as in tools/auvid/field/field_table.h, if it is more than 20 % off and the force of its error, at
the largest motion of the dive, exceeds 2 % of the largest thrust.
"""
import numpy as np
from scipy.stats import beta

from auvid_validation.worlds_pilot import (ATTITUDE, FORCES, HULL_FORCE, NU_DOT, NU_R,
                                           TETHER_FORCE)
from auvid_validation.worlds_vehicles import DOFS, data_sheet

RELATIVE, FORCE = 0.2, 0.02
AXES, RATES = "XYZKMN", "uvwpqr"
MASSES = {"girona500": ("m_u", "m_v", "m_w", None, None, "m_r"),
          "fossen": ("m-X_udot", "m-Y_vdot", "m-Z_wdot", "Ix-K_pdot", "Iy-M_qdot", "Iz-N_rdot")}
NO_INPUT = ("input is always zero", "no input column")


def best_drags(v, force):
    """Linear and quadratic drag."""
    return np.linalg.lstsq(np.c_[v, np.abs(v) * v], force, rcond=None)[0].tolist()


def truth(vehicle, hull, motion):
    """Parameters; by axis drags ahead and astern, the largest speed, acceleration and thrust."""
    force = motion[:, HULL_FORCE] + motion[:, TETHER_FORCE]
    nu_r, masses = motion[:, NU_R], MASSES[vehicle.model]
    found, one_way = {"W-B": hull.weight - hull.buoyancy}, {}
    if vehicle.model == "fossen":
        found["zgW-zbB"] = hull.r_g[2] * hull.weight - hull.r_b[2] * hull.buoyancy
    for i, (axis, rate, mass) in enumerate(zip(AXES, RATES, masses)):
        if mass:
            v = nu_r[:, i]
            drags = best_drags(v, force[:, i])
            one_way[axis] = [best_drags(v[part], force[part, i]) if part.any() else drags
                             for part in (v > 0, v < 0)]
            found |= {mass: hull.m_rb[i, i] + hull.m_a[i, i], f"{axis}_{rate}": drags[0],
                      f"{axis}_{2 * rate}": drags[1]}
    wrench = motion[:, FORCES] @ data_sheet(vehicle)[2].T
    return {"parameters": {name: float(x) for name, x in found.items()}, "one_way": one_way,
            "speed": dict(zip(AXES, np.abs(nu_r).max(0).tolist())),
            "acceleration": dict(zip(AXES, np.abs(motion[:, NU_DOT]).max(0).tolist())),
            "thrust": dict(zip(AXES, np.abs(wrench).max(0).tolist())),
            "tilt": float(np.abs(motion[:, ATTITUDE][:, :2]).max())}


def force_of(kind, axis, value, true):
    """Force of a parameter's value at the largest motion."""
    v = true["speed"][axis]
    if kind in ("mass", "inertia"):
        return value * true["acceleration"][axis]
    return value * {"linear drag": v, "quadratic drag": v * v, "force": 1.0}.get(
        kind, np.sin(true["tilt"]))


def judged_parameters(found, true):
    """A dictionary of each parameter with an input."""
    rows = []
    for p in found.get("parameters", []):
        axis = AXES[DOFS.index(p["dof"])]
        limit = FORCE * true["thrust"][axis]
        row = {"name": p["name"], "identifiable": False, "wrong": False, "error_percent": None}
        if p["estimate"] is not None and p["name"] in true["parameters"]:
            if limit == 0:
                continue
            value, is_force = true["parameters"][p["name"]], p["kind"] == "force"
            error = p["estimate"] - value
            off = is_force or abs(error) > RELATIVE * abs(value)
            row |= {"identifiable": p["identifiable"],
                    "wrong": bool(off and abs(force_of(p["kind"], axis, error, true)) > limit)}
            if is_force or abs(force_of(p["kind"], axis, value, true)) > limit:
                whole = true["thrust"][axis] if is_force else value
                row["error_percent"] = 100 * float(error / whole)
        if p["note"] not in NO_INPUT:
            rows.append(row)
    return rows


def judged_drags(found, true):
    """Drag forces at 0.6 of the largest speed, ahead and astern."""
    rows = []
    for axis, points in found.get("drag", {}).items():
        for point in points[1::3]:
            if axis in true["one_way"] and point["force"] is not None:
                linear, quadratic = true["one_way"][axis][point["speed"] < 0]
                value = (linear + quadratic * abs(point["speed"])) * point["speed"]
                error = abs(point["force"] - value)
                rows.append({"identifiable": point["identifiable"],
                             "wrong": bool(error > RELATIVE * abs(value)
                                           and error > FORCE * true["thrust"][axis])})
    return rows


def share(parts, wholes):
    """[share of two sums over the runs, low, high, whole]: 95 % by bootstrap over the runs, or, if
    the share is 0 or 1 in all runs, by Clopper and Pearson (1934) over the runs that have any."""
    parts, wholes = np.array(parts), np.array(wholes)
    part, whole = parts.sum(), wholes.sum()
    if whole == 0:
        return [None, None, None, 0]
    if part in (0, whole):
        n = np.count_nonzero(wholes)
        edge = float(beta.ppf(0.975, 1, n))
        ends = (0.0, edge) if part == 0 else (1 - edge, 1.0)
    else:
        drawn = np.random.default_rng(1).integers(0, len(parts), (2000, len(parts)))
        sums = wholes[drawn].sum(1)
        ratio = parts[drawn].sum(1)[sums > 0] / sums[sums > 0]
        ends = np.percentile(ratio, [2.5, 97.5]).tolist()
    return [float(part / whole), *ends, int(whole)]


def flags(runs, kind):
    """Shares of a kind, parameters or drags: identifiable, and of these wrong."""
    seen = [len(run[kind]) for run in runs]
    known = [sum(row["identifiable"] for row in run[kind]) for run in runs]
    wrong = [sum(row["identifiable"] and row["wrong"] for row in run[kind]) for run in runs]
    return {"identifiable": share(known, seen), "wrong": share(wrong, known)}


def parameter_table(runs):
    """Of each parameter: dives, identifiable, of these wrong, and the errors [%] of all and of the
    identifiable ones: mean and standard error."""
    table = {}
    for row in (row for run in runs for row in run["parameters"]):
        table.setdefault(row["name"], []).append(row)
    for name, rows in table.items():
        known = [row for row in rows if row["identifiable"]]
        table[name] = {"dives": len(rows), "identifiable": len(known),
                       "wrong": sum(row["wrong"] for row in known)}
        for key, some in (("error_percent", rows), ("error_percent_identifiable", known)):
            e = [row["error_percent"] for row in some if row["error_percent"] is not None]
            table[name][key] = [float(np.mean(e)), float(np.std(e) / max(1, len(e) - 1) ** 0.5)] \
                if e else None
    return table
