"""Accuracy: many simulated runs, and their errors compared with the Cramer-Rao bound.

Each run is one line of OUT/runs.jsonl, written when the run is complete. Runs in the file are not
repeated. Runs are executed on all cores by dask, on a cluster with --scheduler, or in this process
with --workers 1, with the same numbers.
"""
import json
import os
import threading

import numpy as np

from auvid_validation import style
from auvid_validation.bound import bound
from auvid_validation.user_error import UserError, at_least, folder
from auvid_validation.library import PARAMETERS
from auvid_validation.progress import Progress
from auvid_validation.world import N, Run, identify

NOISY = {"dvl_m_s": 0.021, "imu_angle_rad": 0.0105, "imu_rate_rad_s": 0.00524, "depth_m": 0.045}
#: Name: the world without its seed, and the goal of its rms error [%], or None.
WORLDS = {
    "calm": ({"disturbance_N": 0.0}, 1.3),
    "1 N": ({"disturbance_N": 1.0}, 2.4),
    "3 N": ({"disturbance_N": 3.0}, 5.0),
    "1 N, 120 s": ({"disturbance_N": 1.0, "sets": 4}, None),
    "1 N, 60 s": ({"disturbance_N": 1.0, "sets": 2}, None),
    "1 N, 120 s, lag": ({"disturbance_N": 1.0, "sets": 4, "lag_s": 0.15}, None),
    "1 N, half thrust": ({"disturbance_N": 1.0, "strength": 0.5}, None),
    "1 N, one by one": ({"disturbance_N": 1.0, "one_by_one": True}, None),
    "1 N, noise x 3": ({"disturbance_N": 1.0, "sim": NOISY}, None),
    "1 N, literal": ({"disturbance_N": 1.0, "literal": True}, None),
}
_one_at_a_time = threading.Lock()  # a worker may have several threads


def arguments(parser):
    parser.add_argument("--runs", type=at_least(2), default=200,
                        help="of each world; default %(default)s")
    parser.add_argument("--worlds", metavar="A;B", help="of these, separated by semicolons; "
                        f"default all: {'; '.join(WORLDS)}")
    parser.add_argument("--seed", type=at_least(0), default=100000,
                        help="first; default %(default)s")
    parser.add_argument("--out", type=folder, default="build/validation/campaign",
                        help="folder; existing runs are kept; default %(default)s")
    parser.add_argument("--workers", type=at_least(1), default=os.cpu_count(),
                        help="processes on this machine; default: all cores")
    parser.add_argument("--scheduler", metavar="ADDRESS",
                        help="of a dask cluster (tcp://host:8786), whose workers also have auvid")


def one(world):
    """Does a run and returns its line of the file."""
    with _one_at_a_time:
        line = {"world": world}
        # the bound assumes a known wrench
        if world.get("lag_s", 0) == 0 and not world.get("literal", False):
            run = Run(world)
            estimate, truth = run.estimate, run.true_pi
            # the last digits of linear algebra depend on the machine
            line["bound"] = [float(f"{b:.9g}") for b in bound(run)[0]]
        else:
            estimate, truth = identify(world)
        known = estimate.sigma < 1e30
        line |= {"error": (estimate.pi / truth - 1).tolist(),
                 "sigma": [s if k else None for s, k in
                           zip((estimate.sigma / np.abs(truth)).tolist(), known)],
                 "identifiable": estimate.identifiable.tolist(),
                 "not_converged": bool(estimate.not_converged),
                 "evaluations": list(estimate.evaluations)}
        return line


def key(world):
    return json.dumps(world, sort_keys=True)


def read(path):
    """Lines of the file by world, without a truncated line."""
    found = {}
    if path.exists():
        for text in path.read_text().splitlines():
            try:
                line = json.loads(text)
                found[key(line["world"])] = line
            except (ValueError, KeyError, TypeError):
                continue
    return found


def results(tasks, options):
    """one() of each task, in order of completion."""
    if options.workers == 1 and not options.scheduler:
        yield from map(one, tasks)
        return
    try:
        import distributed
    except ImportError:
        if options.scheduler:
            raise UserError("--scheduler needs dask: pip install 'auvid-validation[campaign]'")
        import concurrent.futures as futures
        with futures.ProcessPoolExecutor(options.workers) as pool:
            yield from (f.result() for f in futures.as_completed(
                [pool.submit(one, task) for task in tasks]))
        return
    if options.scheduler:
        try:
            client = distributed.Client(options.scheduler, timeout=10)
        except (OSError, ValueError) as error:
            raise UserError(f"--scheduler: no cluster at {options.scheduler} ({error})")
    else:
        client = distributed.Client(n_workers=options.workers, threads_per_worker=1,
                                    dashboard_address=None)
    with client:  # another worker repeats the runs of a lost one
        for future in distributed.as_completed(client.map(one, tasks, pure=False, retries=3)):
            yield future.result()
            future.release()


def gather(worlds, options):
    """Does the missing runs. -> {name: lines in the order of their seeds}"""
    path = options.out / "runs.jsonl"
    found = read(path)
    wanted = {name: [dict(WORLDS[name][0], seed=options.seed + k) for k in range(options.runs)]
              for name in worlds}
    missing = [w for some in wanted.values() for w in some if key(w) not in found]
    whole = "".join(json.dumps(line) + "\n" for line in found.values())
    path.with_suffix(".new").write_text(whole)  # without a truncated line
    path.with_suffix(".new").replace(path)
    total = options.runs * len(worlds)
    progress = Progress(total, total - len(missing))
    with path.open("a") as file:
        for line in results(missing, options) if missing else ():
            file.write(json.dumps(line) + "\n")
            file.flush()
            found[key(line["world"])] = line
            progress()
    progress.done()
    return {name: [found[key(w)] for w in some] for name, some in wanted.items()}


def resampled(rows):
    """Means over all runs, then over 2000 bootstrap samples of the runs, which are the same for
    all rows."""
    drawn = np.random.default_rng(1).integers(0, len(rows), (2000, len(rows)))
    return np.concatenate([rows.mean(axis=0, keepdims=True), rows[drawn].mean(axis=1)])


def interval(statistic):
    """-> [value, low, high]: 95 % percentile bootstrap of values computed from resampled()."""
    return [float(statistic[0]), *np.percentile(statistic[1:], [2.5, 97.5]).tolist()]


def proportion(hits, count):
    """-> [value, low, high]: Wilson, 95 %."""
    z, p = 1.96, hits / count
    middle, half = p + z * z / (2 * count), z * np.sqrt(p * (1 - p) / count + (z / 2 / count) ** 2)
    scale = 1 + z * z / count
    return [p, float((middle - half) / scale), float((middle + half) / scale)]


def tally(lines, goal):
    error = np.array([line["error"] for line in lines])
    sigma = np.array([line["sigma"] for line in lines], float)
    count, squares = len(lines), resampled(error ** 2)
    known = np.isfinite(sigma)
    failed = [line["not_converged"] or np.max(np.abs(line["error"][:4])) > 0.1 for line in lines]
    evaluations = [sum(line["evaluations"]) for line in lines]
    found = {
        "runs": count, "goal_percent": goal,
        "rms_percent": interval(100 * np.sqrt(squares.mean(axis=1))),
        "success": proportion(count - int(np.sum(failed)), count),
        "coverage": {str(k): interval(resampled(
            ((np.abs(error) <= k * sigma) & known).sum(axis=1)) / resampled(known.sum(axis=1)))
            for k in (1, 2)},
        "identifiable": float(np.mean([line["identifiable"] for line in lines])),
        "evaluations": np.percentile(evaluations, [50, 95]).tolist(),
        "parameters": []}
    has_bound = "bound" in lines[0]
    if has_bound:
        limit = np.mean(np.square([line["bound"] for line in lines]), axis=0)
        found["bound_percent"] = float(100 * np.sqrt(limit.mean()))
        ratios = np.sqrt(squares / limit)
        found["efficiency"] = interval(np.exp(np.log(ratios).mean(axis=1)))
        found["worst"] = interval(ratios.max(axis=1))
    for i, name in enumerate(PARAMETERS):
        half = 1.96 * np.std(error[:, i], ddof=1) / np.sqrt(count) if count > 1 else np.nan
        row = {"name": name, "bias_percent": [100 * float(error[:, i].mean()), 100 * float(half)],
               "rmse_percent": interval(100 * np.sqrt(squares[:, i])),
               "within_sigma": [float(np.mean(np.abs(error[:, i]) <= k * sigma[:, i]))
                                for k in (1, 2)]}
        if has_bound:
            row["bound_percent"] = float(100 * np.sqrt(limit[i]))
            row["ratio"] = [x / row["bound_percent"] for x in row["rmse_percent"]]
        found["parameters"].append(row)
    return found


def show(interval_, digits=2):
    value, low, high = interval_
    return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def print_tables(tallies):
    print("rms over the 13 parameters, percent of the truth; intervals 95 %; 1, 2 sigma: errors "
          "within one or two sigma")
    print(f"{'world':<18}{'runs':>5} {'rms error %':>19} {'goal':>5} {'bound':>6} "
          f"{'RMSE / bound':>19} {'1 sigma':>8} {'2 sigma':>8} {'success':>8} {'evaluations':>12}")
    for name, t in tallies.items():
        efficiency = show(t["efficiency"]) if "efficiency" in t else "-"
        limit = f"{t['bound_percent']:.2f}" if "efficiency" in t else "-"
        print(f"{name:<18}{t['runs']:5d} {show(t['rms_percent']):>19} {t['goal_percent'] or '-':>5}"
              f" {limit:>6} {efficiency:>19} {100 * t['coverage']['1'][0]:6.1f} %"
              f" {100 * t['coverage']['2'][0]:6.1f} % {100 * t['success'][0]:6.1f} %"
              f" {t['evaluations'][0]:5.0f} /{t['evaluations'][1]:5.0f}")
    for name, t in tallies.items():
        print(f"\n{name}: percent of the truth\n  parameter          bias"
              "                 RMSE  bound         RMSE / bound")
        for row in t["parameters"]:
            bias, half = row["bias_percent"]
            limit = f"{row['bound_percent']:6.2f} {show(row['ratio']):>20}" if "ratio" in row \
                else "     -"
            print(f"  {row['name']:<8} {bias:7.2f} +- {half:4.2f} {show(row['rmse_percent']):>20} "
                  + limit)


def judge(tallies):
    """The accuracy lines. A goal is reached if the upper end of the interval reaches it."""
    print()
    lines = [(f"{name}: rms error", t["rms_percent"], t["goal_percent"], " %")
             for name, t in tallies.items() if t["goal_percent"]]
    short = tallies.get("1 N, 120 s")
    if short:
        lines += [("1 N, 120 s: RMSE / bound, geometric mean", short["efficiency"], 1.15, ""),
                  ("1 N, 120 s: RMSE / bound, worst parameter", short["worst"], 1.6, "")]
        lagged = tallies.get("1 N, 120 s, lag")
        if lagged:
            ratio = [x / short["rms_percent"][0] for x in lagged["rms_percent"]]
            lines.append(("with the lag, relative to the run without", ratio, 1.25, ""))
    for what, value, goal, unit in lines:
        print(f"{what:<48} {show(value)}{unit}, goal {goal}{unit}: "
              f"{'reached' if value[2] <= goal else 'not reached'}")


def accuracy_figure(tallies):
    shown = {name: t for name, t in tallies.items() if "efficiency" in t}
    shown = {n: shown[n] for n in ("calm", "1 N", "3 N", "1 N, 120 s") if n in shown} or \
        dict(list(shown.items())[:4])
    fig, axes = style.figure(len(shown), 1, height=0.7 + 1.7 * max(1, len(shown)), sharex=True)
    for axis, (name, t) in zip(axes[:, 0], shown.items()):
        x, rows = np.arange(N), t["parameters"]
        value = np.array([row["rmse_percent"] for row in rows])
        axis.bar(x, [row["bound_percent"] for row in rows], color=style.LIGHT, width=0.6,
                 label="Cramer-Rao bound")
        axis.errorbar(x, value[:, 0], [value[:, 0] - value[:, 1], value[:, 2] - value[:, 0]],
                      fmt="o", color=style.BLUE, capsize=2.5, label="RMSE, 95 %")
        axis.plot(x, [abs(row["bias_percent"][0]) for row in rows], "_", color=style.BLACK,
                  markersize=11, label="|bias|")
        axis.set_ylabel("of the truth [%]")
        axis.set_ylim(0, None)
        axis.grid(axis="x", visible=False)
        axis.set_title(f"{name}: {t['runs']} runs, rms {t['rms_percent'][0]:.2f} %, "
                       f"RMSE / bound {t['efficiency'][0]:.2f}")
    axes[-1, 0].set_xticks(range(N), PARAMETERS)
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=3)
    return fig


def coverage_figure(tallies):
    fig, axes = style.figure(1, 2, height=0.9 + 0.27 * len(tallies), sharey=True)
    y = np.arange(len(tallies))
    for k, color, marker in (("1", style.BLUE, "o"), ("2", style.ORANGE, "s")):
        value = 100 * np.array([t["coverage"][k] for t in tallies.values()])
        axes[0, 0].errorbar(value[:, 0], y, xerr=[value[:, 0] - value[:, 1],
                                                  value[:, 2] - value[:, 0]], fmt=marker,
                            color=color, capsize=2.5, label=f"errors within {k} sigma")
        axes[0, 0].axvline({"1": 68.3, "2": 95.4}[k], color=color, linestyle=":", linewidth=1)
    axes[0, 0].set_yticks(y, tallies)
    axes[0, 0].invert_yaxis()
    axes[0, 0].set_xlim(40, 101)
    axes[0, 0].set_xlabel("errors covered [%]; dotted: normal distribution")
    axes[0, 0].set_title("Coverage of the sigmas")
    value = np.array([t["rms_percent"] for t in tallies.values()])
    axes[0, 1].errorbar(value[:, 0], y, xerr=[value[:, 0] - value[:, 1], value[:, 2] - value[:, 0]],
                        fmt="o", color=style.BLUE, capsize=2.5, label="rms error, 95 %")
    limit = [t.get("bound_percent", np.nan) for t in tallies.values()]
    axes[0, 1].plot(limit, y, "|", color=style.BLACK, markersize=10, label="Cramer-Rao bound")
    axes[0, 1].set_xscale("log")
    axes[0, 1].set_xticks([0.2, 0.5, 1, 2, 5, 10], ["0.2", "0.5", "1", "2", "5", "10"])
    axes[0, 1].set_xlabel("over the 13 parameters [% of the truth]")
    axes[0, 1].set_title("Accuracy")
    both = [h + l for h, l in zip(*(a.get_legend_handles_labels() for a in axes[0]))]
    fig.legend(*both, loc="outside lower center", ncols=4)
    return fig


def run(options):
    worlds = [w.strip() for w in options.worlds.split(";")] if options.worlds else list(WORLDS)
    for name in worlds:
        if name not in WORLDS:
            raise UserError(f"--worlds: no world '{name}': choose from {'; '.join(WORLDS)}")
    lines = gather(worlds, options)
    tallies = {name: tally(some, WORLDS[name][1]) for name, some in lines.items()}
    print_tables(tallies)
    judge(tallies)
    (options.out / "campaign.json").write_text(json.dumps(tallies, indent=1) + "\n")
    if any("efficiency" in t for t in tallies.values()):
        style.save(accuracy_figure(tallies), options.out / "accuracy.png")
    style.save(coverage_figure(tallies), options.out / "coverage.png")
    print(f"\nfigures and numbers: {options.out}")
    return 0
