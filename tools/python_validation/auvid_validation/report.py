"""Identifies a vehicle from a log: a page with figures, and the numbers as JSON.

LOG is a CSV as `auvid fit` reads it (auvid --help lists the columns), or frames of auvid's bus:
candump -L (.log), .asc or .blf. The identification is that of `auvid fit`; the simulation and the
residuals are computed here.
"""
import html
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
    parser.add_argument("--out", type=folder, default="build/validation/report",
                        help="folder of report.html and report.json; default %(default)s")
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


def velocity_figure(numbers, drawn):
    log, predicted, _, _ = drawn
    shown = list(numbers["r2"])
    fig, axes = style.figure(len(shown), 1, height=0.9 + 1.7 * len(shown), sharex=True)
    for axis, symbol in zip(axes[:, 0], shown):
        i = "uvwr".index(symbol)
        for k, piece in enumerate(log.pieces):
            axis.plot(log.t[piece], log.velocity[piece, i], color=style.LIGHT, linewidth=3.2,
                      label=None if k else "measured")
            axis.plot(log.t[piece], predicted[piece, i], color=style.BLACK, linewidth=1,
                      label=None if k else "simulated with the estimate")
        axis.set_ylabel(f"{symbol} [{UNITS[symbol]}]")
        axis.set_title(f"{NAMES[symbol].capitalize()}: R² {number(numbers['r2'][symbol], 3)}")
    axes[-1, 0].set_xlabel("time [s]")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    return fig


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


def parameter_figure(found):
    known = [p for p in found["parameters"] if p["estimate"] and p["sigma"] is not None]
    half = [min(half_width(p) / abs(p["estimate"]) * 100, 100) for p in known]
    fig, axes = style.figure(1, 1, width=8, height=2.6)
    bars = axes[0, 0].bar([p["name"] for p in known], half, width=0.6, edgecolor=style.BLUE,
                          color=[style.BLUE if p["identifiable"] else "white" for p in known])
    axes[0, 0].bar_label(bars, [f"{h:.1f}" if h < 100 else "> 100" for h in half], fontsize=7.5)
    axes[0, 0].axhline(20, color=style.BLACK, linestyle=":", linewidth=1)
    axes[0, 0].set_ylabel("95 % half-width\n[% of the estimate]")
    axes[0, 0].grid(axis="x", visible=False)
    axes[0, 0].tick_params(axis="x", labelsize=8)
    axes[0, 0].set_title("Half-widths: filled is identifiable, dotted is the limit")
    return fig


def number(x, digits=4):
    return "-" if x is None else f"{x:.{digits}g}"


def half_width(p):
    return None if p["sigma"] is None or p["estimate"] is None else 2.1 * p["sigma"]


def rounded(p):
    """Estimate and half-width, rounded to the second digit of the half-width."""
    half = half_width(p)
    if not half:
        return number(p["estimate"])
    digits = max(0, 1 - int(np.floor(np.log10(half))))
    return f"{p['estimate']:.{digits}f} ± {half:.{digits}f}".replace(" ", "\N{NO-BREAK SPACE}")


def meaning(name):
    """Meaning of a parameter in words."""
    if name == "W-B":
        return "weight minus buoyancy"
    kind, of = name.split("_")
    dof = NAMES[of[0]] if kind == "m" else NAMES["uvwr"["XYZN".index(kind)]]
    if kind == "m":
        return f"{dof}: {'moment of inertia' if dof == 'yaw' else 'mass'}"
    if of == "0":
        return f"{dof}: constant {'moment' if dof == 'yaw' else 'force'}"
    return f"{dof}: {'quadratic' if len(of) == 2 else 'linear'} drag"


def table(head, rows):
    figures = [all(c[:1] in "-[0123456789" for c in column) for column in zip(*rows)]

    def row(cells, tag):
        return "<tr>" + "".join(
            f"<{tag}{' class=n' if right else ''}>{html.escape(c)}</{tag}>"
            for c, right in zip(cells, figures)) + "</tr>"
    return "<table>" + row(head, "th") + "".join(row(r, "td") for r in rows) + "</table>"


def parameters_html(found):
    rows = []
    for p in found["parameters"]:
        rows.append((p["name"], meaning(p["name"]), rounded(p),
                     p["unit"].replace("s2", "s²").replace("m2", "m²"),
                     "yes" if p["identifiable"] else "no",
                     p["note"] + (" (at its bound)" if p.get("at_bound") else "")))
    return table(("parameter", "of", "estimate ± 95 %", "unit", "identifiable", "note"), rows)


def white_words(numbers):
    out = []
    for symbol, found in numbers["one_second_ahead"].items():
        if not found:
            out.append(f"{NAMES[symbol]}: too short for a test")
        elif found["p"] >= 0.05:
            out.append(f"{NAMES[symbol]}: no pattern found (p {found['p']:.2g})")
        else:
            first = found["autocorrelation"][1]
            cause = ("consecutive errors are similar: a lasting unmodelled force, or "
                     "a wrong term" if first > found["band"] else
                     "consecutive errors have opposite signs: noise of the measured velocity"
                     if first < -found["band"] else "at longer lags")
            out.append(f"{NAMES[symbol]}: there is a pattern (p {found['p']:.2g}); {cause}")
    return bullets(out)


def bullets(sentences):
    return "<ul>" + "".join(f"<li>{html.escape(words)}</li>" for words in sentences) + "</ul>"


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
    return f"{fitted:.3f} [{low:.3f},\N{NO-BREAK SPACE}{high:.3f}]"


def in_short(found):
    """Summary: how well the motion is predicted, and how many parameters are identifiable."""
    shown = [s for s in NAMES if any(s in one["judged"]["r2"] for one in found)]
    rows = [(one["log"], one["validate"] or "itself", *(explained(one, s) for s in shown),
             sure(one)) for one in found]
    return table(("from", "validated on", *(f"R² {NAMES[s]}" for s in shown), "identifiable"),
                 rows)


def agreement(found):
    """Two logs of one vehicle should give the same parameters, within their joint half-widths."""
    rows, differing = [], []
    other = {p["name"]: p for p in found[1]["fit"]["parameters"]}
    for a in found[0]["fit"]["parameters"]:
        b = other.get(a["name"])
        if b and half_width(a) and half_width(b):
            near = abs(a["estimate"] - b["estimate"]) <= np.hypot(half_width(a), half_width(b))
            differing += [] if near else [a["name"]]
            rows.append((a["name"], rounded(a), rounded(b), "yes" if near else "no"))
    if not rows:
        return ("<h2>Do the two logs agree?</h2><p>Unknown: no parameter is known from both "
                "logs.</p>")
    if not differing:
        answer = (f"Yes: the estimates of all {len(rows)} parameters known from both logs differ "
                  "by less than their joint half-width.")
    else:
        ending = "s" if len(differing) == 1 else ""
        answer = (f"No: {', '.join(differing)} differ{ending} by more than the joint half-width, "
                  f"{len(differing)} of {len(rows)} parameters. One in twenty "
                  "differs by chance. If more differ, the half-widths are too small: a term is "
                  "missing in the model, a disturbance lasted, or the vehicle changed in between.")
    return (f"<h2>Do the two logs agree?</h2><p>{answer}</p>"
            + table(("parameter", *(f"{one['log']} ± 95 %" for one in found), "agree"), rows))


def delays(found):
    known = {axis: d for axis, d in found["delay_s"].items() if d is not None}
    if not any(known.values()):
        return "no delay from the input to the motion"
    return "delay from the input to the motion " + ", ".join(
        f"{axis} {number(d, 3)} s" for axis, d in known.items())


UNITS_OF_COMMAND = (
    "<p>The inputs of this log are commands, not forces. One cmd is the force of a command of 1. "
    "Multiply the parameters by this force in newtons (yaw: newton metres) to get SI units.</p>")


def section(one, drawn, chosen):
    found, numbers = one["fit"], one["judged"]
    what = f"held-out log {one['validate']}" if one["validate"] else \
        f"log {one['log']} itself: no held-out log was given"
    residuals = residual_figure(numbers, drawn)
    terms = ("each degree of freedom by itself" if "decoupled" in found["model"] else
             "with the terms between degrees of freedom (Eq. 12-15)")
    if chosen:
        terms += ", selected by cross-validation"
    commands = any("cmd" in p["unit"] for p in found["parameters"])
    return "\n".join([
        f"<h2>Identified from {html.escape(one['log'])}</h2>",
        f"<p>{one['rows']} rows, {one['seconds']:.0f} s. Model: {terms}. Found: "
        f"{html.escape(delays(found))}. The search took {found['evaluations']['crs']} + "
        f"{found['evaluations']['line_search']} evaluations (status "
        f"{html.escape(found['status'])}).</p>",
        UNITS_OF_COMMAND if commands else "",
        parameters_html(found), style.inline(parameter_figure(found), "half-widths"),
        "<h3>Missing excitation</h3>",
        bullets(found["missing"] or ["nothing: every parameter is identifiable"]),
        f"<h3>Simulated velocity, {html.escape(what)}</h3>",
        "<p>The equations of motion under the recorded input, from the measured initial velocity, "
        "restarted only after a gap of the log; attitude, p and q as recorded. R² here is of this "
        "simulation, which is independent of auvid fit above.</p>",
        style.inline(velocity_figure(numbers, drawn), "velocities"),
        "<h3>Residuals: is there a pattern?</h3>",
        "<p>The measurement minus its prediction one second before, from the velocity measured at "
        "that time. For a complete model these errors are noise without a pattern: points around "
        "zero, and in the right column nothing beyond the grey band. p is the probability of as "
        "much pattern by chance (Ljung-Box test).</p>",
        white_words(numbers),
        style.inline(residuals, "residuals") if residuals else ""])


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>auvid: {title}</title><style>
body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 54rem; margin: 2rem auto; padding: 0 1rem;
       color: #1a1a1a; }}
h2 {{ margin-top: 2.5rem; border-bottom: 2px solid #1f5f99; }} img {{ max-width: 100%; }}
table {{ border-collapse: collapse; font-size: 14px; margin: 1rem 0; }}
th, td {{ padding: .15rem .8rem; text-align: left; border-bottom: 1px solid #e3e6ea; }}
th {{ border-bottom: 2px solid #b8bec6; }}
td {{ white-space: nowrap; }} td.n, td:last-child {{ white-space: normal; }}
.n {{ text-align: right; }}
</style></head><body><h1>{title}</h1>
{short}
<p>R² is the share of the variance of a measured velocity that a simulation with the estimate
explains: 1 is all of it, 0 no more than the mean. Intervals are 95 %; those of R² are by bootstrap
over blocks of 10 s. A parameter is identifiable if its degree of freedom was excited and its 95 %
half-width is at most 20 % of it. Do not use the values of other parameters by themselves, only the
motion that all predict together. Masses include added mass. By auvid {version}.</p>
{agreement}
{sections}
<script type="application/json" id="numbers">{numbers}</script>
</body></html>
"""


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
        print(f"  {NAMES[symbol]:<6} {kind} " + explained(one, symbol).replace("\xa0", " ")
              + (f", simulated independently {number(value, 3)}" if one["validate"] else ""))


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
    (options.out / "report.json").write_text(json.dumps(numbers, indent=1) + "\n")
    page = PAGE.format(title="Identification from " + html.escape(
                           " and ".join(one["log"] for one in numbers)),
                       version=numbers[0]["fit"]["version"],
                       short=in_short(numbers),
                       agreement=agreement(numbers) if options.both else "",
                       sections="\n".join(section(*each, options.coupling in (None, "auto"))
                                          for each in found),
                       numbers=json.dumps(numbers).replace("<", "\\u003c"))
    (options.out / "report.html").write_text(page)
    for one in numbers:
        print_summary(one)
    print(f"{options.out}/report.html, {options.out}/report.json")
    return 0
