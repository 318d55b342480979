"""auvid-validate peers: a whole search of the identifier against NLopt, scipy and CMA-ES, on the
cost of the same record: a Girona500 (13 parameters, linear), and a Girona500 in a current (15
parameters and a delay, not linear). Evaluations and time to 1.001 of the lowest cost known."""
import json
import time

import numpy as np

from auvid_validation.library import load, values
from auvid_validation.optimizer import count, shown
from auvid_validation.optimizer_problem import Capped, Counted, Reached, interval
from auvid_validation.user_error import output

SETS, SET_ROWS, BUDGET = 8, 60, 150
#: Most evaluations of a peer. One of the vehicle in a current takes a millisecond.
CAP = {False: 20_000, True: 2_000}
OURS = "auvid, identifier"
PEERS = ("NLopt LN_BOBYQA", "NLopt CRS2_LM (500), BOBYQA", "NLopt GN_CRS2_LM", "CMA-ES (cma)",
         "scipy Nelder-Mead, adaptive", "scipy differential_evolution")


def arguments(parser):
    parser.add_argument("--runs", type=count, default=10, help="records (10)")
    parser.add_argument("--json", metavar="FILE", type=output, help="write every run there")


class Record:
    """Eight sets of a simulated vehicle at 1 N, and the cost of its model on them. x is in -1..1 of
    the box."""

    def __init__(self, seed, in_current):
        self.lib = lib = load("large" if in_current else "float")
        self.config, self.chain = lib.chain_config_t(), lib.chain_t()
        lib.chain_defaults(self.config, 1000 + seed, SETS, 1.0)
        self.config.budget = 0
        if in_current:
            self.add_current(seed)
        assert lib.chain_run_sets(self.chain, self.config, SETS) == 0
        search = self.config.id.search
        size = len(values(search.lower))
        self.delayed = in_current
        self.free = [i for i in range(size) if self.config.id.metric.free >> i & 1]
        self.low = np.append(values(search.lower)[self.free], [0.0] * in_current)
        self.high = np.append(values(search.upper)[self.free], [0.6] * in_current)
        self.metric = lib.auvid_metric_t.from_buffer_copy(self.chain.id.metric)
        self.budget, self.pi = np.zeros(1, np.uint32), lib.zeros(size)
        lib.auvid_metric_merge_begin(self.metric)
        self.finish(lib.auvid_metric_merge)
        self.constant = 0.0 if in_current else self.metric.result.constant
        self.lowest = np.inf

    def add_current(self, seed):
        lib, config = self.lib, self.config
        angle = 2.4 * seed
        config.sim.current[:2] = [0.3 * np.cos(angle), 0.3 * np.sin(angle)]
        self.current = lib.auvid_current_t()
        self.rows = (lib.auvid_row_t * ((SETS + 1) * SET_ROWS))()
        assert lib.auvid_current_init(self.current, lib.auvid_girona500, False) == 0
        given = lib.auvid_identifier_config_t.from_buffer_copy(config.id)
        lib.auvid_identifier_defaults(config.id, self.current.vehicle)
        config.id.metric.rows = self.rows
        config.id.search.seed, config.id.exact_inputs = given.search.seed, True
        lower, upper = (lib.zeros(len(x)) for x in (given.search.lower, given.search.upper))
        lower[:], upper[:] = values(given.search.lower), values(given.search.upper)
        assert lib.auvid_current_bounds(self.current, 1.0, lower, upper) == 0
        config.id.search.lower[:], config.id.search.upper[:] = lower.tolist(), upper.tolist()

    def finish(self, step):
        self.budget[0] = 4_000_000_000
        assert step(self.metric, self.budget) == 0
        return 4_000_000_000 - int(self.budget[0])

    def cost(self, x):
        theta = self.low + 0.5 * (np.asarray(x) + 1.0) * (self.high - self.low)
        self.pi[self.free] = theta[:len(self.free)]
        delay = float(theta[-1]) if self.delayed else 0.0
        self.lib.auvid_metric_cost_begin(self.metric, self.pi, delay)
        self.units = self.finish(self.lib.auvid_metric_cost)
        cost = self.metric.result.cost + self.constant
        self.lowest = min(self.lowest, cost)
        return cost

    def identify(self):
        """Cost of the estimate; evaluations; all work in evaluations; seconds."""
        began = time.perf_counter()
        calls = self.lib.chain_finish(self.chain, BUDGET, 1_000_000)
        seconds = time.perf_counter() - began
        estimate = self.chain.id.estimate
        theta = values(estimate.pi)[self.free].astype(float)
        theta = np.append(theta, [max(values(estimate.delay_s))] * self.delayed)
        cost = self.cost(2.0 * (theta - self.low) / (self.high - self.low) - 1.0)
        return (cost, int(estimate.evaluations_crs + estimate.evaluations_line),
                calls * BUDGET / self.units, seconds)


def search_with(search, record, target, seed):
    """Evaluations to the target, and seconds; evaluations None if it was not reached."""
    n = len(record.low)
    counted = Counted(record.cost, np.ones(n), target, CAP[record.delayed])
    evaluations, began = None, time.perf_counter()
    try:
        search(counted, np.ones(n), seed)
    except Reached:
        evaluations = counted.evaluations
    except Capped:
        pass
    return evaluations, time.perf_counter() - began


def compare(runs, in_current):
    """{name: [(evaluations or None, seconds)]}, and all work of auvid in evaluations."""
    from auvid_validation.optimizer_peers import peers
    searches, lines, work = peers(), {OURS: []}, []
    for seed in range(runs):
        record = Record(seed, in_current)
        cost, evaluations, all_work, seconds = record.identify()
        found = {name: search_with(searches[name], record, 1.001 * cost, seed) for name in PEERS}
        good = cost <= 1.001 * record.lowest
        lines[OURS].append((evaluations if good else None, seconds))
        work.append(all_work)
        for name, result in found.items():
            lines.setdefault(name, []).append(result)
    return lines, work


def quantiles(told):
    told = sorted(np.inf if x is None else x for x in told)
    return told[len(told) // 2], told[min(len(told) - 1, int(0.95 * len(told)))]


def show(title, lines, work):
    print(f"\n{title}\n{'':32s}{'success':>9s}  {'95 %':<15s}{'median':>8s}{'p95':>8s}"
          f"{'seconds':>10s}")
    for name, runs in lines.items():
        good = sum(evaluations is not None for evaluations, _ in runs)
        low, high = (round(100 * p, 1) for p in interval(good, len(runs)))
        median, p95 = quantiles([evaluations for evaluations, _ in runs])
        print(f"  {name:30s}{100 * good / len(runs):7.0f} %  {f'[{low}, {high}]':<15s}"
              f"{shown(median)}{shown(p95)}{quantiles([s for _, s in runs])[0]:10.4f}")
    print(f"  All work of auvid, with merge, derivatives and standard errors, is that of "
          f"{np.median(work):.0f} evaluations.")


def run(options):
    told, good = {}, True
    for title, in_current in (("Girona500, 13 parameters, linear", False),
                              ("Girona500 in a current, 15 parameters and a delay", True)):
        lines, work = compare(options.runs, in_current)
        show(f"{title}, {options.runs} records: evaluations to 1.001 of the lowest cost, at most "
             f"{CAP[in_current]}; median seconds", lines, work)
        good = good and all(evaluations is not None for evaluations, _ in lines[OURS])
        told[title] = lines
    if options.json:
        json.dump(told, options.json, indent=1)
    return 0 if good else 1
