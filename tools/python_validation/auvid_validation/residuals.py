"""Identifies a vehicle from a log, and asks whether the residuals have a pattern.

LOG is a CSV as `auvid fit` reads it (auvid --help lists the columns), or frames of auvid's bus:
candump -L (.log), .asc or .blf. The identification is that of `auvid fit`, whose --report is a page
for people; the simulation and the residuals are computed here.
"""
import json
import pathlib
import tempfile

import numpy as np
from scipy.special import gammaincc

from auvid_validation import style
from auvid_validation.user_error import UserError, folder
from auvid_validation.model import r2
from auvid_validation.recorded import Log, Model, as_csv, fit

NAMES = {"u": "surge", "v": "sway", "w": "heave", "r": "yaw"}
UNITS = {"u": "m/s", "v": "m/s", "w": "m/s", "r": "rad/s"}
LAGS = 20


def arguments(parser):
    parser.add_argument("log", type=pathlib.Path, metavar="LOG", help=".csv, .log, .asc or .blf")
    parser.add_argument("--validate", type=pathlib.Path, metavar="LOG2",
                        help="held-out log, of the same kinds")
    parser.add_argument("--both", action="store_true",
                        help="also the other direction: identify from LOG2, validate on LOG")
    parser.add_argument("--out", type=folder, default="build/validation/residuals",
                        help="folder of residuals.json and figures; default %(default)s")
    for flag in ("--bias", "--literal"):
        parser.add_argument(flag, action="store_true", help="as for auvid fit")
    for option in ("--bounds", "--input", "--coupling"):
        parser.add_argument(option, help="as for auvid fit")


def passed_on(options):
    """Arguments of `auvid fit`."""
    found = [f"--{name}" for name in ("bias", "literal") if getattr(options, name)]
    for name in ("bounds", "input", "coupling"):
        if getattr(options, name):
            found.append(f"--{name}={getattr(options, name)}")
    return found


def whiteness(errors):
    """Autocorrelation of the errors up to LAGS, with the Ljung-Box test."""
    n, lags = len(errors), min(LAGS, len(errors) // 4)
    if lags < 1 or np.std(errors) == 0:
        return None
    e = errors - np.mean(errors)
    rho = np.array([np.sum(e[k:] * e[:n - k]) for k in range(lags + 1)]) / np.sum(e * e)
    q = n * (n + 2) * np.sum(rho[1:] ** 2 / (n - np.arange(1, lags + 1)))
    return {"predictions": n, "rms": float(np.sqrt(np.mean(errors ** 2))),
            "mean": float(np.mean(errors)), "autocorrelation": rho.tolist(),
            "band": 1.96 / np.sqrt(n), "ljung_box": float(q),
            "p": float(gammaincc(lags / 2, q / 2))}


def judged(log, found):
    """-> (numbers, data of the figures) of an identification on a log."""
    model = Model(found, log)
    predicted, (times, errors) = model.whole(), model.ahead()
    there = np.all(np.isfinite(log.velocity), axis=1) & np.any(np.isfinite(predicted), axis=1)
    numbers = {"r2": {}, "one_second_ahead": {}}
    for i, (symbol, axis) in enumerate(zip("uvwr", "XYZN")):
        if found["r2_force"][axis] is not None:
            measured = log.velocity[there, i]
            value = r2(measured, predicted[there, i]) if np.ptp(measured) > 0 else -np.inf
            numbers["r2"][symbol] = float(value) if np.isfinite(value) else None
            numbers["one_second_ahead"][symbol] = whiteness(errors[:, i])
    return numbers, (log, predicted, times, errors)


def residual_figure(numbers, drawn):
    _, _, times, errors = drawn
    shown = [s for s, found in numbers["one_second_ahead"].items() if found]
    if not shown:
        return None
    fig, axes = style.figure(len(shown), 2, height=0.6 + 1.6 * len(shown), sharex="col",
                             width_ratios=[2, 1])
    for (left, right), symbol in zip(axes, shown):
        found = numbers["one_second_ahead"][symbol]
        left.plot(times, errors[:, "uvwr".index(symbol)], ".", color=style.BLUE, markersize=3.5)
        left.axhline(0, color=style.BLACK, linewidth=0.8)
        left.set_ylabel(f"{symbol} [{UNITS[symbol]}]")
        left.set_title(f"{NAMES[symbol].capitalize()}: measured minus predicted 1 s before, "
                       f"rms {found['rms']:.2g}")
        rho = found["autocorrelation"]
        right.axhspan(-found["band"], found["band"], color=style.LIGHT, alpha=0.6, linewidth=0)
        right.vlines(range(1, len(rho)), 0, rho[1:], color=style.BLUE)
        right.plot(range(1, len(rho)), rho[1:], "o", color=style.BLUE)
        right.axhline(0, color=style.BLACK, linewidth=0.8)
        right.set_ylim(-1, 1)
        right.set_title(f"autocorrelation, p {found['p']:.2g}")
    axes[-1, 0].set_xlabel("time [s]")
    axes[-1, 1].set_xlabel("lag [s]; grey: 95 % of noise")
    return fig


def number(x, digits=4):
    return "-" if x is None else f"{x:.{digits}g}"


def half_width(p):
    return None if p["sigma"] is None or p["estimate"] is None else 2.1 * p["sigma"]


def white_words(numbers):
    for symbol, found in numbers["one_second_ahead"].items():
        if not found:
            yield f"{NAMES[symbol]}: too short for a test"
        elif found["p"] >= 0.05:
            yield f"{NAMES[symbol]}: no pattern found (p {found['p']:.2g})"
        else:
            first = found["autocorrelation"][1]
            cause = ("consecutive errors are similar: a lasting unmodelled force, or "
                     "a wrong term" if first > found["band"] else
                     "consecutive errors have opposite signs: noise of the measured velocity"
                     if first < -found["band"] else "at longer lags")
            yield f"{NAMES[symbol]}: there is a pattern (p {found['p']:.2g}); {cause}"


def sure(one):
    parameters = one["fit"]["parameters"]
    excited = sum(p["estimate"] is not None for p in parameters)
    still = len(parameters) - excited
    return (f"{sum(p['identifiable'] for p in parameters)} of {excited}"
            + (f", {still} not excited" if still else ""))


def explained(one, symbol):
    """R2 with its interval, if there is a held-out log with motion."""
    own = one["judged"]["r2"].get(symbol)
    if not one["validate"]:
        return number(own, 3)
    fitted = one["fit"]["r2_validation"][symbol]
    if own is None or fitted is None:
        return "-"
    low, high = one["fit"]["r2_interval"][symbol]
    return f"{fitted:.3f} [{low:.3f}, {high:.3f}]"


def agreement(found):
    """Two logs of one vehicle should give the same parameters, within their joint half-widths."""
    differing, both = [], 0
    other = {p["name"]: p for p in found[1]["fit"]["parameters"]}
    for a in found[0]["fit"]["parameters"]:
        b = other.get(a["name"])
        if b and half_width(a) and half_width(b):
            near = abs(a["estimate"] - b["estimate"]) <= np.hypot(half_width(a), half_width(b))
            differing += [] if near else [a["name"]]
            both += 1
    if both == 0:
        return "Unknown: no parameter is known from both logs."
    if not differing:
        return (f"Yes: the estimates of all {both} parameters known from both logs differ by less "
                "than their joint half-width.")
    ending = "s" if len(differing) == 1 else ""
    return (f"No: {', '.join(differing)} differ{ending} by more than the joint half-width, "
            f"{len(differing)} of {both} parameters. One in twenty differs by chance. If more "
            "differ, the half-widths are too small: a term is missing in the model, a disturbance "
            "lasted, or the vehicle changed in between.")


def direction(log, test, names, options):
    """Identifies from one CSV, validates on the other or on itself."""
    try:
        found = fit(log, test, passed_on(options))
    except UserError as error:  # which may name the converted log
        words = str(error)
        for path, name in zip((log, test), names):
            words = words.replace(str(path), str(name)) if path else words
        raise UserError(words)
    read = Log(log)
    numbers, drawn = judged(Log(test) if test else read, found)
    one = {"log": names[0], "validate": names[1], "rows": len(read.t),
           "seconds": float(read.t[-1]), "fit": found, "judged": numbers}
    if test and all(explained(one, symbol) == "-" for symbol in NAMES):
        raise UserError(f"{names[1]}: nothing to validate on: the log is too short or without "
                        "motion")
    return one, drawn


def print_summary(one):
    print(f"{one['log']}: {one['fit']['model']}; identifiable {sure(one)}")
    for symbol, value in one["judged"]["r2"].items():
        kind = "held-out R2" if one["validate"] else "R2 on the log itself"
        print(f"  {NAMES[symbol]:<6} {kind} {explained(one, symbol)}"
              + (f", simulated independently {number(value, 3)}" if one["validate"] else ""))
    print("  pattern in the errors of predictions one second ahead?")
    for words in white_words(one["judged"]):
        print(f"    {words}")


def run(options):
    if options.both and not options.validate:
        raise UserError("--both needs --validate LOG2")
    with tempfile.TemporaryDirectory() as made:
        folders = [pathlib.Path(made, name) for name in "ab"]  # two logs may have the same name
        given = [options.log, options.validate] if options.validate else [options.log]
        logs = []
        for path, into in zip(given, folders):
            into.mkdir()
            logs.append((as_csv(path, into), path.name))
        logs = logs + [(None, None)] if len(logs) == 1 else logs
        pairs = [logs, logs[::-1]] if options.both else [logs]
        found = [direction(a[0], b[0], (a[1], b[1]), options) for a, b in pairs]
    numbers = [one for one, _ in found]
    (options.out / "residuals.json").write_text(json.dumps(numbers, indent=1) + "\n")
    for k, (one, drawn) in enumerate(found):
        print_summary(one)
        fig = residual_figure(one["judged"], drawn)
        if fig:
            print(f"  {style.save(fig, options.out / f'residuals_{k + 1}.png')}")
    if options.both:
        print(f"Do the two logs agree? {agreement(numbers)}")
    return 0
