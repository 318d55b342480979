"""Dives of another simulator: what `auvid fit` calls identifiable, compared with the truth.

The simulator (worlds_physics.py and the modules beside it) is written apart from the library and
from tools/simulator. Each dive draws its vehicle, its thrusters, its sensors and its water. --off
and --perfect leave errors out.
"""
import argparse
import functools
import json
import multiprocessing
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

from auvid_validation import (worlds_judge as judge, worlds_motions as motions,
                              worlds_sensors as sensors, worlds_vehicles as vehicles)
from auvid_validation.library import program
from auvid_validation.progress import Progress
from auvid_validation.user_error import UserError, at_least, folder, output
from auvid_validation.worlds_pilot import OPEN_LOOP, SURVEY, simulate

DT = 0.02
PARTS = ("hull", "thrusters", "inflow", "sensors", "environment")


def seeds(text):
    """Type of an option: 2001:2015, or 1,2,3."""
    first, colon, last = text.partition(":")
    whole = at_least(0)
    found = range(whole(first), whole(last) + 1) if colon else map(whole, text.split(","))
    if not (found := list(found)):
        raise argparse.ArgumentTypeError(f"'{text}' has no seed")
    return found


def some_of(names):
    """Type of an option: some of these names, separated by commas."""
    def chosen(text):
        for name in (found := text.split(",")):
            if name not in names:
                raise argparse.ArgumentTypeError(f"no '{name}': choose from {','.join(names)}")
        return found
    return chosen


def arguments(parser):
    parser.add_argument("--seeds", type=seeds, default="2001:2015",
                        help="FIRST:LAST, or A,B,..; default %(default)s")
    parser.add_argument("--vehicles", type=some_of(tuple(vehicles.VEHICLES)), default="A,B,C,D",
                        help="default %(default)s")
    parser.add_argument("--motion", type=some_of(tuple(motions.MOTIONS)),
                        default=",".join(motions.MOTIONS), help="default %(default)s")
    left_out = parser.add_mutually_exclusive_group()
    left_out.add_argument("--off", type=some_of(PARTS), default=(), metavar="PART,..",
                          help="without errors of " + ", ".join(PARTS))
    left_out.add_argument("--perfect", dest="off", action="store_const", const=PARTS,
                          help="without any error")
    parser.add_argument("--told", action="store_true", help="the user says which axes are in open "
                        "loop (excited, single), and which a controller holds")
    parser.add_argument("--fit", default="", metavar="OPTIONS",
                        help="more options of auvid fit, as in --fit='--plain --bias'")
    parser.add_argument("--auvid", type=pathlib.Path, help="program; default build/auvid")
    parser.add_argument("--jobs", type=at_least(1), default=1, help="processes; default 1")
    parser.add_argument("--out", type=folder, help="folder of logs and vehicle files, kept")
    parser.add_argument("--keep", action="store_true",
                        help="keep the logs, in a temporary folder whose name is printed")
    parser.add_argument("--json", type=output, metavar="FILE", help="also write all numbers")
    parser.add_argument("--details", action="store_true", help="also a table of each parameter")


def held_axes(vehicle, pilot):
    """Axes that a controller holds. A torpedo holds its depth with its pitch."""
    if pilot.mode == SURVEY:
        held = ["surge", "sway", "heave", "yaw"]
    else:
        held = ["heave"] * pilot.holds_depth + ["yaw"] * pilot.holds_heading
    if vehicle.fin:
        held = [{"heave": "pitch"}.get(axis, axis) for axis in held if axis != "sway"]
    return held


def dive(name, motion, seed, off=()):
    """One dive: columns of the log, the truth, and the axes that a controller holds."""
    vehicle, perfect = vehicles.VEHICLES[name], {part: part in off for part in PARTS}
    key = (seed, ord(name), tuple(motions.MOTIONS).index(motion))
    rng = [np.random.default_rng(key + (i,)) for i in range(6)]
    hull = vehicles.draw_hull(vehicle, rng[0], perfect["hull"])
    thrusters = vehicles.draw_thrusters(vehicle, hull, rng[1], perfect["thrusters"],
                                        perfect["inflow"])
    water, depth = motions.draw_water(vehicle, rng[2], perfect["environment"])
    pilot = motions.draw_pilot(vehicle, hull, rng[3], motion)
    reference = motions.lawnmower(vehicle, rng[3], DT, depth)
    plan = np.zeros((len(reference), 6))
    if motion != "survey":
        plan = getattr(motions, motion)(vehicle, rng[3], DT)
    noise = sensors.navigation_noise(rng[4], len(plan), DT, perfect["sensors"])
    y = np.zeros(13 + len(vehicle.thrusters))
    y[2], y[3] = depth, 1.0
    moved = simulate(hull, thrusters, water, pilot, plan, reference, noise, y, DT)
    rows = sensors.record(moved, DT, rng[5], perfect["sensors"])
    if vehicle.fin:
        sensors.scale_fins(rows, vehicle.fin_speed)
    true = judge.truth(vehicle, hull, moved[int(2 / DT):])
    return rows, true, held_axes(vehicle, pilot)


def fit(auvid, log, vehicle_file, more):
    """-> (answer, message) of auvid fit. The answer is {} if it refuses the log."""
    try:
        done = subprocess.run([auvid, "fit", log, "--json", "--vehicle", vehicle_file, *more],
                              capture_output=True, text=True, check=False)
    except OSError as error:
        raise UserError(f"--auvid {auvid}: {error.strerror}") from error
    answer = json.loads(done.stdout or "{}")
    if answer and "error" not in answer:
        return answer, ""
    words = done.stderr.strip().splitlines() or ["the program failed"]
    if done.returncode == 2 and str(log) not in words[-1]:  # the options, not the log
        raise UserError(words[-1].removeprefix("auvid: "))
    return {}, words[-1].removeprefix("auvid: ").replace(f"{log}: ", "")


def one(task, options, auvid, where):
    """Dives, identifies and judges; a dictionary for JSON."""
    name, motion, seed = task
    rows, true, held = dive(name, motion, seed, options.off)
    log, more = where / f"{name}_{motion}_{seed}.csv", options.fit.split()
    sensors.write_csv(log, rows)
    if options.told and motions.MOTIONS[motion] == OPEN_LOOP:
        vehicle = vehicles.VEHICLES[name]
        axes = (0, 1, 2, 4, 5) if vehicle.fin else vehicle.dofs  # a fin also pushes sideways
        more += ["--open-loop", ",".join(vehicles.DOFS[i] for i in axes)]
    elif options.told and held:
        more += ["--closed-loop", ",".join(held)]
    answer, refused = fit(auvid, log, where / f"{name}.ini", more)
    if not options.keep:
        log.unlink()
    return {"vehicle": name, "motion": motion, "seed": seed, "held": held, "refused": refused,
            "log_errors": [f["code"] for f in answer.get("log_findings", [])
                           if f["severity"] == "error"],
            "closed_loop": any("closed loop" in line for line in answer.get("missing", [])),
            "parameters": judge.judged_parameters(answer, true),
            "drags": judge.judged_drags(answer, true), "truth": true}


def results(tasks, work, jobs):
    """work() of each task, in their order."""
    if jobs == 1:
        yield from map(work, tasks)
    else:
        with multiprocessing.Pool(jobs) as pool:
            yield from pool.imap(work, tasks)


def tally(runs):
    """Numbers of one row of the table."""
    free = [run["closed_loop"] for run in runs if not run["held"]]
    held = [run["closed_loop"] for run in runs if run["held"]]
    nothing = sum(not any(row["identifiable"] for row in run["parameters"]) for run in runs)
    errors = sum(bool(run["log_errors"]) for run in runs)
    return {"logs": len(runs), "nothing": nothing, "log_errors": errors,
            "open_loop": [sum(free), len(free)], "held": [sum(held), len(held)],
            "parameters": judge.flags(runs, "parameters"),
            "drags": judge.flags(runs, "drags"), "each": judge.parameter_table(runs)}


def words(found):
    """A share with its interval."""
    value, low, high, _ = found
    return "-" if value is None else \
        f"{100 * value:.1f} % [{100 * low:.1f}, {100 * high:.1f}]"


def print_table(tallies):
    print("| vehicle, motion | logs | nothing identifiable | error of the log | closed loop, of "
          "free and held | parameters identifiable | wrong | drag identifiable | wrong |\n"
          "|---|---|---|---|---|---|---|---|---|")
    for name, t in tallies.items():
        loops = ", ".join(f"{k} of {n}" if n else "-" for k, n in (t["open_loop"], t["held"]))
        shares = [words(t[kind][key]) for kind in ("parameters", "drags")
                  for key in ("identifiable", "wrong")]
        print(f"| {name} | {t['logs']} | {t['nothing']} | {t['log_errors']} | {loops} | "
              f"{' | '.join(shares)} |")


def print_details(name, each):
    def error(found):
        return "-" if found is None else f"{found[0]:.1f} +- {found[1]:.1f}"
    print(f"\n| {name} | logs | identifiable | wrong | error [%] | of identifiable ones [%] |\n"
          "|---|---|---|---|---|---|")
    for parameter, t in each.items():
        print(f"| {parameter} | {t['dives']} | {t['identifiable']} | {t['wrong']} | "
              f"{error(t['error_percent'])} | {error(t['error_percent_identifiable'])} |")


def report(runs, options):
    groups = {}
    for run in runs:
        groups.setdefault(f"{run['vehicle']} {run['motion']}", []).append(run)
    if len(groups) > 1:
        groups["all"] = runs
    tallies = {name: tally(some) for name, some in groups.items()}
    print_table(tallies)
    if options.details:
        for name, t in tallies.items():
            print_details(name, t["each"])
    for run in runs:
        if run["refused"]:
            print(f"refused: {run['vehicle']} {run['motion']} {run['seed']}: {run['refused']}")
    if options.json:
        with options.json as file:
            json.dump({"rows": tallies, "runs": runs}, file, indent=1)


def run(options):
    auvid = options.auvid or program()
    where = options.out or pathlib.Path(tempfile.mkdtemp(prefix="worlds_"))
    try:
        for name in options.vehicles:
            (where / f"{name}.ini").write_text(vehicles.vehicle_file(name), encoding="utf-8")
        tasks = [(name, motion, seed) for name in options.vehicles for motion in options.motion
                 for seed in options.seeds]
        chosen = argparse.Namespace(off=options.off, told=options.told, fit=options.fit,
                                    keep=options.keep or options.out)
        work = functools.partial(one, options=chosen, auvid=auvid, where=where)
        progress, runs = Progress(len(tasks)), []
        for found in results(tasks, work, options.jobs):
            runs.append(found)
            progress()
        progress.done()
        report(runs, options)
    finally:
        if options.keep or options.out:
            print(f"logs: {where}")
        else:
            shutil.rmtree(where)
    return 0
