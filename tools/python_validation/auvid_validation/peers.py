"""auvid-validate peers: a whole search of the identifier, as on board, against scipy, NLopt,
Py-BOBYQA and CMA-ES, on the cost of the same record: a Girona500 (linear), and three models given
as functions: a Girona500 in a current, one with its thrusters, and a user's model with kinks.
Evaluations and time to 1.001 of the lowest cost that any of them finds."""
import json
import time

import numpy as np

from auvid_validation import optimizer_peers as search, peers_record
from auvid_validation.library import load
from auvid_validation.optimizer import count, shown
from auvid_validation.optimizer_problem import Capped, Counted, Reached, interval
from auvid_validation.user_error import at_least, output

GOAL = 1.001
#: Two points whose costs differ by less are at the same minimum.
SAME = 1e-4
#: Name: vehicle, title, most evaluations of a peer.
VEHICLES = {
    "linear": (peers_record.linear, "Girona500, 13 parameters, linear", 20_000),
    "current": (peers_record.in_current,
                "Girona500 in a current, 15 parameters and a delay", 5_000),
    "thrusters": (peers_record.with_thrusters,
                  "Girona500 with its thrusters, 16 parameters", 5_000),
    "dead-band": (peers_record.dead_band,
                  "surge with a dead band (kinks), 5 parameters and a delay", 5_000),
}
OURS, END = "auvid, as on board", "auvid, until its search ends"
LEAST_SQUARES, PY_BOBYQA = "scipy least_squares (trf), restarted", "Py-BOBYQA, restarted"
#: Most evaluations of Py-BOBYQA, which takes 10 to 30 ms of its own for each.
PY_CAP = 300
#: Name: search, where it looks, what it uses beside the cost.
PEERS = {
    LEAST_SQUARES: (search.restarted(search.least_squares), "local", "residuals, differences"),
    "NLopt LN_BOBYQA, restarted": (search.restarted(search.bobyqa), "local", "-"),
    PY_BOBYQA: (search.restarted(search.py_bobyqa), "local", "-"),
    "NLopt CRS2_LM (500), LN_BOBYQA": (search.restarted(search.crs2_bobyqa(500)), "both", "-"),
    "NLopt GN_CRS2_LM": (search.restarted(search.crs2), "global", "-"),
    "CMA-ES (cma), restarted": (search.restarted(search.cma_es), "global", "-"),
    "scipy differential_evolution": (search.differential_evolution, "global", "-"),
}
KIND = {OURS: ("both", "residuals, derivatives, structure"), END: ("", ""),
        **{name: rest for name, (_, *rest) in PEERS.items()}}
NOTES = """
All have the same cost, in single precision, and the same bounds. The others begin at a random
point, and know what auvid cannot: the goal, where they end. auvid also has to confirm the minimum:
until its search ends. It is given no point, but it knows in which parameters a model is affine
(structure; not the one with kinks). Derivatives are counted: for least squares each difference of
residuals is an evaluation; for auvid all work after the merge is converted to evaluations, and
never below the number of its points. Seconds are medians, of the processor; where the goal was not
reached, until the most evaluations."""


def arguments(parser):
    parser.add_argument("--runs", type=count, default=10, help="records of each vehicle (10)")
    parser.add_argument("--first", type=at_least(0), default=0, help="seed of the first (0)")
    parser.add_argument("--only", metavar="VEHICLE", choices=VEHICLES,
                        help=f"one of {', '.join(VEHICLES)}")
    parser.add_argument("--json", metavar="FILE", type=output, help="write every run there")


class Residuals(Counted):
    """Counts, and returns the residuals instead of the cost."""

    def __init__(self, record, *rest):
        super().__init__(record.squares, *rest)
        self.record = record

    def __call__(self, x, *_):
        super().__call__(x)
        return self.record.residuals


def search_with(name, record, target, cap, seed):
    """Evaluations to the target, and seconds; evaluations None if it was not reached."""
    box, cap = np.ones(len(record.low)), min(cap, PY_CAP) if name == PY_BOBYQA else cap
    counted = (Residuals(record, box, target, cap) if name == LEAST_SQUARES else
               Counted(record.cost, box, target, cap))
    evaluations, began = None, time.process_time()
    try:
        PEERS[name][0](counted, box, seed)
    except Reached:
        evaluations = counted.evaluations
    except Capped:
        pass
    return evaluations, time.process_time() - began


def polish(record):
    """Lowers record.lowest: what auvid leaves above the minimum."""
    box = np.ones(len(record.found))
    uncounted = Residuals(record, box, -np.inf, np.inf)
    search.least_squares(uncounted, box, None, np.clip(record.found, -box, box))


def compare(record, cap, seed):
    """{name: (evaluations or None, seconds)} of a record, and auvid's excess cost"""
    goal, found, history = np.inf, {}, record.history
    names = [name for name in PEERS if record.rows or name != LEAST_SQUARES]  # a closed form
    if record.rows:
        polish(record)
    while record.lowest < (1 - SAME) * goal:  # a lower minimum than the last time
        goal = record.lowest
        found = {name: search_with(name, record, GOAL * goal, cap, seed) for name in names}
    (end, cost, seconds), limit = history[-1], GOAL * record.lowest
    at = next(((round(k), s) for k, point, s in history if point <= limit), (None, seconds))
    return ({OURS: at, END: (round(end) if cost <= limit else None, seconds), **found},
            cost / record.lowest - 1)


def quantiles(told):
    told = sorted(np.inf if x is None else x for x in told)
    return told[len(told) // 2], told[min(len(told) - 1, int(0.95 * len(told)))]


def show(lines, excess):
    print(f"{'':40s}{'looks':8s}{'uses beside the cost':35s}{'success':>9s}  {'95 %':<15s}"
          f"{'median':>8s}{'p95':>8s}{'seconds':>10s}")
    for name, runs in lines.items():
        good = sum(evaluations is not None for evaluations, _ in runs)
        low, high = (round(100 * p, 1) for p in interval(good, len(runs)))
        median, p95 = quantiles([evaluations for evaluations, _ in runs])
        print(f"  {name:38s}{KIND[name][0]:8s}{KIND[name][1]:35s}{100 * good / len(runs):7.0f} %  "
              f"{f'[{low}, {high}]':<15s}{shown(median)}{shown(p95)}"
              f"{quantiles([s for _, s in runs])[0]:10.4f}")
    print(f"  auvid's excess cost: at most {max(excess):.1e}", flush=True)


def run(options):
    load("wide")
    told, good = {}, True
    for name in [options.only] if options.only else VEHICLES:
        of, title, cap = VEHICLES[name]
        lines, excess = {}, []
        for seed in range(options.first, options.first + options.runs):
            found, ours = compare(peers_record.Record(of, seed, time.process_time), cap, seed)
            excess.append(ours)
            for line, result in found.items():
                lines.setdefault(line, []).append(result)
        print(f"\n{title}, {options.runs} records: evaluations to {GOAL} of the lowest cost, "
              f"at most {cap} (Py-BOBYQA {PY_CAP})")
        show(lines, excess)
        good = good and all(evaluations is not None for evaluations, _ in lines[END])
        told[name] = {"runs": lines, "auvid_excess": excess}
    print(NOTES)
    if options.json:
        json.dump(told, options.json, indent=1)
    return 0 if good else 1
