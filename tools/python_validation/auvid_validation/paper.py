"""The paper's experiment, in simulation: its Girona500 as truth, bounds [-1000, 1000].

Prints the table of parameters, R2 on held-out runs compared with that of the truth, and the results
of a joint UKF from good and bad initial values. Writes figures like Figs. 3 to 6 of the paper.
"""
import json

import numpy as np

from auvid_validation import style, ukf
from auvid_validation.user_error import at_least, folder
from auvid_validation.library import PARAMETERS, values
from auvid_validation.model import r2, simulate
from auvid_validation.progress import Progress
from auvid_validation.world import N, TICK_S, Run, identify

VELOCITIES = [("u", "surge", "m/s"), ("v", "sway", "m/s"), ("w", "heave", "m/s"),
              ("r", "yaw", "rad/s")]
UNITS = ["kg"] * 3 + ["kg m2", "N"] + ["N s/m", "N s2/m2"] * 3 + ["Nm s", "Nm s2"]
#: Offset of the seeds of validation runs from those of identified runs.
APART = 1000000
OURS = "auvid, from the box"
#: Largest error of a successful run.
SUCCESS = 0.2


def arguments(parser):
    parser.add_argument("--out", type=folder, default="build/validation/paper",
                        help="folder of figures and numbers; default %(default)s")
    parser.add_argument("--seed", type=at_least(0), default=1, help="of the first run; default 1")
    parser.add_argument("--disturbance", type=float, default=1.0, metavar="N",
                        help="rms of an unknown force [N]; default %(default)g")
    parser.add_argument("--sets", type=int, choices=range(2, 9), default=8,
                        help="of 30 s; default %(default)s")
    parser.add_argument("--validations", type=at_least(1), default=20, metavar="N",
                        help="held-out runs, each with its own identification; "
                        "default %(default)s")
    parser.add_argument("--starts", type=at_least(1), default=20, metavar="N",
                        help="UKF runs per kind of start, each on another run; default %(default)s")


def least_squares(run):
    """The optimum of the metric in closed form."""
    lib, metric = run.lib, run.chain.id.metric
    pi = np.zeros_like(values(run.chain.id.estimate.pi))
    status = lib.auvid_metric_least_squares(metric, lib.auvid_metric_active(metric), pi)
    if status != 0:
        raise ValueError(status.name)
    return pi[:N].astype(float)


def held_out(world, **others):
    """Motion not used for the identification: another seed, 120 s of other steps and sines."""
    return Run(dict(world, seed=world["seed"] + APART, sets=4, literal=False, **others), work=False)


def predict(run, pi):
    """u v w r by Eq. 12-15 from the first sample on; attitude, p and q as they were measured."""
    start = [values_[0] for _, values_ in run.measured()] + [0]
    return simulate(pi, run.measured_tilt, run.wrench, TICK_S, start)[:, :4]


def judged(run, predicted):
    """R2 of u v w r against the measured and against the true velocity."""
    return ([r2(seen, predicted[k, i]) for i, (k, seen) in enumerate(run.measured())],
            [r2(run.nu[:, i], predicted[:, i]) for i in range(4)])


def search(world):
    """Excess cost, relative to the residual that no parameters explain, after each evaluation of
    a search that starts when all sets are complete: [(evaluations, excess, phase)]."""
    run = Run(world, work=False)
    lib, id_, steps = run.lib, run.chain.id, []
    cost, last = lib.zeros(1), -1
    while lib.auvid_identifier_work(id_, 60) == lib.AUVID_PENDING:
        if id_.work.phase not in (lib.AUVID_WORK_ASK, lib.AUVID_WORK_COST):
            continue
        work = id_.optimizer.work
        if work.crs + work.line_search == last or \
                not lib.auvid_optimizer_best(id_.optimizer, cost):
            continue
        last = work.crs + work.line_search
        steps.append((last, float(cost[0]), work.line_search > 0))
    floor = min(cost for _, cost, _ in steps)
    constant = id_.metric.result.constant
    return [(k, (cost - floor) / constant, local) for k, cost, local in steps]


def initialisation(world, count, progress):
    """Largest error of a parameter in each run, by method and initial values.
    Infinite: diverged."""
    worst, random = {}, np.random.default_rng(world["seed"])
    for k in range(count):
        run = Run(dict(world, seed=world["seed"] + k))
        ends = {name: ukf.joint(run, *draw())
                for name, draw in ukf.starts(run.true_pi, random).items()}
        ends[OURS] = run.estimate.pi
        for name, end in ends.items():
            error = np.inf if end is None else float(np.max(np.abs(end / run.true_pi - 1)))
            worst.setdefault(name, []).append(error)
        progress(f"starts of run {k + 1}")
    return worst


def validate(world, count, progress):
    """Held-out runs: R2[run, method, measured or true, velocity], of estimate, truth, literal."""
    found = []
    for k in range(count):
        one = dict(world, seed=world["seed"] + k)
        literal = identify(dict(one, literal=True))[0].pi
        estimate, truth = identify(one)
        run = held_out(one)
        found.append([judged(run, predict(run, pi)) for pi in (estimate.pi, truth, literal)])
        progress(f"held-out run {k + 1}")
    return np.array(found)


def table(out, columns, truth, sigma):
    head = "parameter  unit    " + "".join(f"{name:>12}" for name in columns)
    out(head + f"{'truth':>12}{'sigma':>9}")
    for i, name in enumerate(PARAMETERS):
        row = "".join(f"{pi[i]:12.3f}" for pi in columns.values()).replace("nan", "  -")
        out(f"{name:<10} {UNITS[i]:<8}" + row + f"{truth[i]:12.4f}{sigma[i]:9.3f}")
    rms = [100 * np.sqrt(np.mean((pi / truth - 1) ** 2)) for pi in columns.values()]
    out(f"{'rms error':<19}" + "".join(f"{r:10.2f} %" for r in rms).replace("nan %", "    -"))
    return dict(zip(columns, rms))


def velocity_figure(run, predicted):
    fig, axes = style.figure(4, 1, height=8, sharex=True)
    measured, truth = judged(run, predicted)
    for i, (symbol, name, unit) in enumerate(VELOCITIES):
        ticks, seen = run.measured()[i]
        axis = axes[i, 0]
        axis.plot(run.t[ticks], seen, color=style.LIGHT, linewidth=3.2, label="measured")
        axis.plot(run.t, predicted[:, i], color=style.BLACK, linewidth=1, label="predicted")
        axis.set_ylabel(f"{symbol} [{unit}]")
        axis.set_title(f"{name.capitalize()}: R² {measured[i]:.4f} of the measured velocity, "
                       f"{truth[i]:.4f} of the true one")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    axes[3, 0].set_xlabel("time [s]")
    axes[3, 0].set_xlim(0, run.t[-1])
    return fig


def convergence_figure(run):
    estimates = {e.sets: e for e in run.estimates}  # the last with so many sets
    sets = np.array(list(estimates))
    fig, axes = style.figure(4, 4, width=10, height=7.5, sharex=True)
    for i, axis in enumerate(axes.flat):
        if i >= N:
            axis.set_visible(False)
            continue
        pi = np.array([e.pi[i] for e in estimates.values()])
        sigma = np.array([e.sigma[i] for e in estimates.values()])
        truth = run.true_pi[i]
        axis.fill_between(sets, pi - sigma, pi + sigma, color=style.LIGHT, alpha=0.7, linewidth=0)
        axis.plot(sets, pi, color=style.BLUE, marker="o")
        axis.axhline(truth, color=style.BLACK, linestyle="--", linewidth=1)
        # the band of the second set may be wide, that of the first is not representative
        half = 1.4 * max(np.max(np.abs(pi[1:] - truth) + sigma[1:]), 0.01 * abs(truth))
        axis.set_ylim(truth - half, truth + half)
        axis.set_title(f"{PARAMETERS[i]} [{UNITS[i]}]")
    for axis in (axes[3, 0], *axes[2, 1:]):
        axis.set_xlabel("sets of 30 s")
        axis.xaxis.set_tick_params(labelbottom=True)
    axes[0, 0].plot([], [], color=style.LIGHT, linewidth=6, label="one sigma")
    axes[0, 0].plot([], [], color=style.BLUE, marker="o", label="estimate")
    axes[0, 0].plot([], [], color=style.BLACK, linestyle="--", linewidth=1, label="truth")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="lower right",
               bbox_to_anchor=(0.98, 0.12), ncols=3)
    return fig


def cost_figure(steps):
    fig, axes = style.figure(1, 1, width=7, height=3.4)
    axis, k = axes[0, 0], np.array([s[0] for s in steps])
    excess, local = np.maximum([s[1] for s in steps], 1e-7), np.array([s[2] for s in steps])
    begin = k[local][0]
    for part, kind, name in ((~local, 0, "Algorithm 1: controlled random search"),
                             (local, 1, "Algorithm 2: line search")):
        axis.semilogy(k[part], excess[part], color=style.KINDS[kind]["color"],
                      linestyle=style.KINDS[kind]["linestyle"], linewidth=2, label=name)
    axis.axvline(begin, color=style.LIGHT)
    axis.axhline(1e-3, color=style.BLACK, linestyle=":", linewidth=1)
    axis.annotate("a thousandth of the residual", (k[-1], 1.3e-3), ha="right", va="bottom",
                  fontsize=8)
    axis.set_ylim(1e-6, None)
    axis.set_xlim(0, k[-1])
    axis.set_xlabel("evaluations of the cost")
    axis.set_ylabel("best cost above the optimum\n[parts of the residual's]")
    axis.set_title(f"Cost by phase, {N} parameters in [-1000, 1000]")
    axis.legend(loc="upper right")
    return fig


def initialisation_figure(worst):
    fig, axes = style.figure(1, 1, width=7, height=3)
    axis = axes[0, 0]
    right = [int(np.sum(np.array(errors) < SUCCESS)) for errors in worst.values()]
    total = len(worst[OURS])
    bars = axis.barh(list(worst), [100 * n / total for n in right], height=0.65,
                     color=[style.BLUE if name == OURS else style.LIGHT for name in worst])
    axis.bar_label(bars, [f" {n} of {total}" for n in right], fontsize=8)
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set_xlim(0, 115)
    axis.set_xticks(range(0, 101, 20))
    axis.set_xlabel("runs in which every parameter ends within 20 % of the truth [%]")
    axis.set_title("A joint UKF by its initial values, and the search, which needs none")
    return fig


def report_initialisation(out, worst):
    out("\njoint UKF, with known noise of all sensors and of the force, by initial values, on "
        f"{len(worst[OURS])} runs:")
    out("  start                  every parameter within 20 %   diverged   median largest error")
    for name, errors in worst.items():
        right, median = int(np.sum(np.array(errors) < SUCCESS)), np.median(errors)
        error = f"{100 * median:18.1f} %" if median < np.inf else f"{'-':>18}"
        out(f"  {name:<24} {right:12d} of {len(errors):<10d} {errors.count(np.inf):10d} {error}")


def report_r2(out, found, world):
    """-> passed"""
    worst = -np.inf
    out(f"R2 of simulated velocity, median of {len(found)} held-out runs of 120 s, "
        f"d = {world['disturbance_N']:g} N, each with its own identification")
    out("                         u        v        w        r")
    for against, name in ((0, "measured"), (1, "true")):
        median = np.median(found[:, :, against], axis=0)
        for method, who in ((0, "estimate"), (1, "truth itself"), (2, "literal")):
            row = "".join(f"{x:9.4f}" for x in median[method])
            out(f"  {name:<8} {who:<12}" + row)
        worst = max(worst, float(np.max(median[1] - median[0])))
    passed = worst <= 0.002
    out(f"  largest gap of a median to that of the truth: {worst:.4f} (goal 0.002) "
        f"{'PASS' if passed else 'FAIL'}")
    return passed, worst


def run(options):
    world = {"seed": options.seed, "sets": options.sets, "disturbance_N": options.disturbance}
    progress = Progress(options.validations + options.starts + 2)
    train = Run(world)
    progress("identification")
    columns = {"auvid": train.estimate.pi, "literal": identify(dict(world, literal=True))[0].pi,
               "least sq.": least_squares(train)}
    drawn = ukf.starts(train.true_pi, np.random.default_rng(options.seed))
    for name, kind in (("UKF 30 %", "truth +- 30 %"), ("UKF box", "box")):
        end = ukf.joint(train, *drawn[kind]())
        columns[name] = np.full(N, np.nan) if end is None else end
    rms = table(print, columns, train.true_pi, train.estimate.sigma)
    progress("least squares")
    found = validate(world, options.validations, progress)
    print()
    passed, gap = report_r2(print, found, world)
    worst = initialisation(world, options.starts, progress)
    report_initialisation(print, worst)
    shown = held_out(world)
    steps = search(world)
    figures = {"velocities": velocity_figure(shown, predict(shown, train.estimate.pi)),
               "convergence": convergence_figure(train), "cost": cost_figure(steps),
               "initialisation": initialisation_figure(worst)}
    for name, fig in figures.items():
        style.save(fig, options.out / f"{name}.png")
    numbers = {"world": world, "parameters": PARAMETERS, "truth": train.true_pi.tolist(),
               "sigma": train.estimate.sigma.tolist(),
               "methods": {name: np.where(np.isnan(pi), None, pi).tolist()
                           for name, pi in columns.items()},
               "rms_percent": {name: None if np.isnan(r) else r for name, r in rms.items()},
               "r2": {"axes": "run, auvid | truth | literal, measured | true, u v w r",
                      "runs": np.where(np.isfinite(found), found, None).tolist(),
                      "largest_gap": gap},
               "largest_error": {name: [e if e < np.inf else None for e in errors]
                                 for name, errors in worst.items()},
               "evaluations": {"global": next(k for k, _, local in steps if local) - 1,
                               "all": steps[-1][0]}}
    (options.out / "paper.json").write_text(json.dumps(numbers, indent=1) + "\n")
    progress.done()
    print(f"\nfigures and numbers: {options.out}")
    return 0 if passed else 1
