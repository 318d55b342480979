"""auvid-validate optimizer: evaluations until the first cost <= 1.001 of the optimum, auvid against
NLopt, scipy and CMA-ES on the same cost, bounds and scaling; then on test functions of the
literature. Least squares is in the table with zero evaluations."""
import argparse
import collections
import concurrent.futures
import functools
import json
import os
import sys

import numpy as np

from auvid_validation.user_error import output
from auvid_validation.library import load

CAP = 20_000
LEAST_SQUARES = "least squares, closed form"
#: Target of the test functions, whose optimum is 0.
FUNCTION_TARGET = 1e-3
PRICE = "auvid CRS alone"


def count(text):
    if not text.isdigit() or not 1 <= int(text) <= 100_000:
        raise argparse.ArgumentTypeError(f"{text} is not a number of runs")
    return int(text)


def arguments(parser):
    parser.add_argument("--runs", type=count, default=50, help="of each optimizer (50)")
    parser.add_argument("--jobs", type=count, default=os.cpu_count(), help="processes (all cores)")
    parser.add_argument("--json", metavar="FILE", type=output,
                        help="write every run's evaluations there")


@functools.lru_cache(maxsize=8)
def problem(seed):
    from auvid_validation.optimizer_problem import Problem
    return Problem(seed)


def evaluations(search, counted, box, seed):
    """Evaluations to the target; None if it was not reached."""
    from auvid_validation.optimizer_problem import Capped, Reached
    try:
        search(counted, box, seed)
    except Reached:
        return counted.evaluations
    except Capped:
        pass
    return None


def identify(scaling, name, seed):
    """One run on the identification problem of a seed."""
    from auvid_validation.optimizer_peers import peers
    from auvid_validation.optimizer_problem import BOUND, N, Counted
    p = problem(seed)
    if name == LEAST_SQUARES:
        return 0 if p.cost(p.optimum[:N]) <= p.target else None
    unit = p.units[scaling]
    return evaluations(peers()[name], Counted(p.cost, unit, p.target, CAP), BOUND / unit, seed)


def on_function(family, n, name, seed):
    """One run on a test function, in units of half the box."""
    from auvid_validation.optimizer_functions import BOX, FAMILIES
    from auvid_validation.optimizer_peers import peers
    from auvid_validation.optimizer_problem import Counted
    counted = Counted(FAMILIES[family], BOX, FUNCTION_TARGET, CAP)
    return evaluations(peers()[name], counted, np.ones(n), seed)


def price(family, n, seed):
    """Algorithm 1 alone until a spread of 1e-6, as counted in the literature: 25 n points,
    omega 1e3. None if it did not end at the optimum."""
    from auvid_validation.optimizer_functions import BOX, FAMILIES
    lib = load("large")
    config, crs, theta = lib.auvid_search_config_t(), lib.auvid_optimizer_t(), lib.zeros(17)
    lib.auvid_search_defaults(config, n)
    config.phases = lib.AUVID_SEARCH_GLOBAL
    config.population, config.omega, config.epsilon_crs = 25 * n, 1e3, 1e-6
    config.seed, config.max_evaluations_crs = seed + 1, 100_000
    config.lower[:n], config.upper[:n] = [-BOX] * n, [BOX] * n
    assert lib.auvid_optimizer_init(crs, config, None) == 0
    best = np.inf
    while (status := lib.auvid_optimizer_ask(crs, theta)) in (lib.AUVID_OK, lib.AUVID_PENDING):
        if status == lib.AUVID_OK:
            value = FAMILIES[family](theta[:n])
            best = min(best, value)
            lib.auvid_optimizer_tell(crs, value)
    return int(crs.work.crs) if best <= FUNCTION_TARGET else None


def tasks(runs):
    """(table, line, function, arguments) of every run."""
    from auvid_validation.optimizer_functions import FAMILIES, PUBLISHED
    from auvid_validation.optimizer_peers import INVARIANT, peers
    for seed in range(runs):
        for scaling in ("box", "columns"):
            for name in [*peers(), LEAST_SQUARES]:
                if "25 n" not in name and not (scaling == "columns" and name in INVARIANT):
                    yield scaling, name, identify, (scaling, name, seed)
        for n in (4, 10):
            for name in peers():
                yield f"15^n, n = {n}", name, on_function, ("15^n", n, name, seed)
        for family in FAMILIES:
            for n in PUBLISHED:
                yield PRICE, (family, n), price, (family, n, seed)


def run_all(options):
    """{table: {line: evaluations of each run}}"""
    from auvid_validation.optimizer_peers import INVARIANT
    told = collections.defaultdict(lambda: collections.defaultdict(list))
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        futures = [(table, line, pool.submit(function, *given))
                   for table, line, function, given in tasks(options.runs)]
        for i, (table, line, future) in enumerate(futures):
            told[table][line].append(future.result())
            if sys.stderr.isatty():
                print(f"\r{i + 1} of {len(futures)} runs", end="", file=sys.stderr)
    for name in INVARIANT:
        told["columns"][name] = told["box"][name]
    return told


def summary(counts):
    """Successes, their interval, median and p95. A target not reached counts as infinite."""
    lib, runs = load("double"), len(counts)
    good = sum(c is not None for c in counts)
    part = [lib.binomial_lower(good, runs, 0.025), lib.binomial_upper(good, runs, 0.025)]
    sorted_counts = sorted(np.inf if c is None else c for c in counts)
    at = [sorted_counts[min(runs - 1, int(q * runs))] for q in (0.5, 0.95)]
    return good, [round(100 * p, 1) for p in part], at


def shown(value):
    return f"{value:8.0f}" if np.isfinite(value) else f"{'-':>8s}"


def rank(line):
    """Highest success first, then fewest evaluations."""
    good, _, at = summary(line[1])
    return -good, at


def show(title, lines):
    print(f"\n{title}\n{'':36s}{'success':>9s}  {'95 %':<15s}{'median':>8s}{'p95':>8s}")
    for name, counts in sorted(lines.items(), key=rank):
        good, part, at = summary(counts)
        print(f"  {name:34s}{100 * good / len(counts):7.0f} %  {f'[{part[0]}, {part[1]}]':<15s}"
              f"{shown(at[0])}{shown(at[1])}")


def show_price(lines):
    from auvid_validation.optimizer_functions import PUBLISHED
    print("\nControlled random search alone, m = 25 n, omega = 1e3, to a spread of 1e-6: mean "
          "evaluations (success).\nPublished: Brachetti et al. 1997, their test function 7, whose "
          "definition is not available; basic and with a quadratic\n"
          f"{'':8s}{'5^n':>16s}{'10^n':>16s}{'15^n':>16s}{'published':>16s}")
    for n, (basic, quadratic) in PUBLISHED.items():
        cells = []
        for family in ("5^n", "10^n", "15^n"):
            counts = [c for c in lines[family, n] if c is not None]
            mean = np.mean(counts) if counts else np.nan
            cells.append(f"{mean:.0f} ({100 * len(counts) / len(lines[family, n]):.0f} %)")
        print(f"  n ={n:3d}" + "".join(f"{c:>16s}" for c in [*cells, f"{basic}, {quadratic}"]))


def verdict(lines):
    """Lists the optimizers that always succeed with fewer evaluations than auvid."""
    from auvid_validation.optimizer_peers import OURS
    ours = summary(lines[OURS])
    fewer = [name for name, counts in lines.items() if name not in (OURS, LEAST_SQUARES)
             and summary(counts)[0] == len(counts) and summary(counts)[2][0] < ours[2][0]]
    print("  fewer than auvid, with every run a success: " + (", ".join(fewer) or "none"))
    return ours[0] == len(lines[OURS])


def run(options):
    for library in ("float", "double", "large"):
        load(library)
    told = run_all(options)
    good = True
    for scaling, of in (("box", "half the box"), ("columns", "column norms of the data")):
        show(f"Identification of a Girona500, 13 parameters, box [-1000, 1000], {options.runs} "
             f"records, scaled by {of}:\nevaluations to 1.001 of the optimum, at most {CAP}",
             told[scaling])
        good = verdict(told[scaling]) and good
    for n in (4, 10):
        show(f"A function with 15^n local minima, n = {n}: evaluations to {FUNCTION_TARGET}, at "
             f"most {CAP}", told[f"15^n, n = {n}"])
    show_price(told[PRICE])
    if options.json:
        plain = {table: {str(line): counts for line, counts in lines.items()}
                 for table, lines in told.items()}
        json.dump(plain, options.json, indent=1)
    return 0 if good else 1
