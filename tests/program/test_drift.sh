#!/usr/bin/env bash
# A vehicle that changes slowly raises the alarm of drift, a constant one does not. Perfect world:
# the vehicle as in its data sheet, with an unmodelled force. Long form: thrust that sags by 15 % in
# two hours and drag that grows by 30 % in ten, two vehicles, excited and with a joystick; 20000
# constant sets, and mixtures of mismatches.
. "$(dirname "$0")/common.sh"

cat >drift.py <<'END'
import json, math, os, subprocess, sys

NOISE = {"girona500": "disturbance=1", "rov20": "disturbance=0.3"}
LENGTH = {"thrust_sag": 2, "fouling": 10}  # hours
SIZE = {"thrust_sag": 0.15, "fouling": 0.3}


def runs(vehicle, driver, hours, number, *more, seed=1):
    out = subprocess.run([os.environ["AUVID"], "demo", "--vehicle", vehicle, "--driver", driver,
                          "--hours", str(hours), "--runs", str(number), "--seed", str(seed),
                          "--json", *more], capture_output=True, check=True)
    return json.loads(out.stdout)["each"]


def perfect(vehicle):
    return ["--mismatch", NOISE[vehicle]]


def shift(kind, part):
    """Relative change of the parameters for reported thrust, after this part of the run."""
    size = SIZE[kind] * part
    return size if kind == "fouling" else 1 / (1 - size) - 1


def upper(k, n):
    """Upper end of the two-sided 95 % Clopper-Pearson interval."""
    low, high = k / n, 1.0
    for _ in range(60):
        p = (low + high) / 2
        below = sum(math.exp(math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) +
                             i * math.log(p) + (n - i) * math.log1p(-p)) for i in range(k + 1))
        low, high = (p, high) if below > 0.025 else (low, p)
    return high


def noticed(vehicle, driver, kind, number, seed):
    """Every run raises the alarm before the parameters have changed by 10 %."""
    each = runs(vehicle, driver, LENGTH[kind], number, *perfect(vehicle), "--mismatch",
                "%s=%g" % (kind, SIZE[kind]), seed=seed)
    at = sorted(shift(kind, run["drifted_s"] / 3600 / LENGTH[kind]) if run["drifted"] else 9
                for run in each)
    print("%-9s %-8s %-10s %3d runs: noticed at a change of %.1f %% (median), %.1f %% at most" %
          (vehicle, driver, kind, number, 100 * at[number // 2], 100 * at[-1]), flush=True)
    assert at[-1] < 0.1


def constant(vehicle, driver, number, *world, seed):
    each = runs(vehicle, driver, 2, number, *world, seed=seed)
    sets = sum(run["sets"] for run in each)
    drifted = sum(run["drifted"] for run in each)
    changed = sum(run["changed"] for run in each)
    print("%-9s %-8s %-32s %d sets: drift %d (95 %%: up to %.3f %%), change %d (%.3f %%)" %
          (vehicle, driver, " ".join(world[1::2]), sets, drifted, 100 * upper(drifted, sets),
           changed, 100 * upper(changed, sets)), flush=True)
    return sets, drifted, changed
END

cat >short.py <<'END'
from drift import *
for vehicle in NOISE:
    world = ["--mismatch", "thrust_sag=0.15"]
    sags = runs(vehicle, "excited", 0.4, 1, *perfect(vehicle), *world)
    stays = runs(vehicle, "excited", 0.4, 1, *perfect(vehicle))
    print(vehicle, sags[0]["drifted_s"], stays[0]["drifted"])
    assert sags[0]["drifted"] > 0
    assert shift("thrust_sag", sags[0]["drifted_s"] / 1440) < 0.1
    assert stays[0]["drifted"] == stays[0]["changed"] == 0 and stays[0]["sets"] == 48
END

cat >long.py <<'END'
from drift import *
mixture = ["--field", "1", "--mismatch", "thrust_sag=0"]  # no drift
for vehicle in NOISE:
    for kind, number in (("thrust_sag", 30), ("fouling", 6)):
        noticed(vehicle, "excited", kind, number, 31001)
        noticed(vehicle, "joystick", kind, number // 3, 31001)
worlds = ((lambda vehicle: perfect(vehicle), 5000), (lambda vehicle: mixture, 500))
for world, one_in in worlds:
    counts = [constant(vehicle, driver, number, *world(vehicle), seed=32001)
              for vehicle in NOISE for driver, number in (("excited", 43), ("joystick", 43))]
    sets, drifted, changed = (sum(column) for column in zip(*counts))
    print("all: 1 drift in %g sets, 1 change in %g" % (sets / max(drifted, 1),
                                                       sets / max(changed, 1)))
    assert sets >= 20000 and drifted <= sets / one_in
END

campaign() {
    AUVID="$AUVID" python3 long.py >long.txt
}

AUVID="$AUVID" check "in 24 min: sagging thrust is a drift, constant thrust is none" \
    python3 short.py
if [ -n "${AUVID_TEST_LONG:-}" ]; then
    check "slow changes are noticed in time, and seldom without reason" campaign
    sed 's/^/# /' long.txt
fi
finish
