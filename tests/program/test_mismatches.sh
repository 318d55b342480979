#!/usr/bin/env bash
# auvid demo --field 0 --mismatch: one mismatch at a time, for both vehicles. A row is 50 runs of a
# mismatch at half, one or two times its standard deviation: that of the prior of uncertain.h, or
# else the rms of its range in --mismatch list. Half of the runs have the negative size where there
# is one. Long form: the table of all rows, and what it must fulfil.
. "$(dirname "$0")/common.sh"

cat >rows.py <<'END'
import json, os, random, subprocess, sys

RUNS, SEED = 50, 6001
VEHICLES = ("girona500", "rov20")
SIZES = (("small", 0.5), ("medium", 1.0), ("large", 2.0))
LAG_S = 0.15  # nominal: a thrust_lag deviates from it
RMS = 3 ** -0.5  # of a uniform distribution, over its end

# Largest force of a thruster, tau_max of surge, and scale of forces in the list.
MAX_N = {"girona500": 153.8, "rov20": 40.0}
TAU_MAX_N = {"girona500": 100.0, "rov20": 30.0}
FORCES = {"girona500": 1.0, "rov20": 0.3}


def mismatches(vehicle):
    """Name: standard deviation, both signs?"""
    force = FORCES[vehicle]
    return {
        # of the priors
        "thrust_backward": (0.05, True), "thrust_dead_band": (0.012 * MAX_N[vehicle], False),
        "thrust_exponent": (0.05, True), "thrust_advance": (0.18, False),
        "thrust_sag": (0.05, True), "thrust_each": (0.05, False), "thrust_common": (0.05, True),
        "thrust_lag": (0.06, True), "thrust_late": (0.04, True), "dvl_latency": (0.04, False),
        "dvl_scale": (0.005, True), "current": (0.05, False), "drag_asymmetry": (0.12, True),
        "cross": (0.15, False), "cable": (0.03 * TAU_MAX_N[vehicle], True),
        "cg_x": (0.01, True), "cg_y": (0.01, True),
        # of the list
        "imu_roll": (1.0, True), "imu_pitch": (1.0, True), "imu_yaw": (1.0, True),
        "gyro_bias": (0.1, False), "attitude_delay": (0.03 * RMS, False),
        "dvl_arm_x": (0.05, True), "dvl_arm_y": (0.03, True), "dvl_arm_z": (0.05, True),
        "dvl_yaw": (1.0, True), "dvl_roll": (0.7, True), "dvl_pitch": (0.7, True),
        "dvl_lost": (0.1 * RMS, False), "dvl_outliers": (0.01 * RMS, False),
        "dvl_partial": (0.05 * RMS, False), "drag_exponent": (0.15 * RMS, True),
        "waves": (3.2 * force, False), "disturbance": (1.3 * force, False),
    }


def demo(vehicle, runs, seed, *options):
    """Flags and wrong flags of each run, and the share that is flagged."""
    out = subprocess.run([os.environ["AUVID"], "demo", "--field", "0", "--vehicle", vehicle,
                          "--runs", str(runs), "--seed", str(seed), "--json", *options],
                         capture_output=True, check=True, text=True)
    d = json.loads(out.stdout)
    return [(sum(run["flagged"]), sum(run["wrong"]), len(run["flagged"]))
            for run in d["each"]]


def row(vehicle, name, sigma, signed, times, runs, *options):
    """The runs of a row, by seed."""
    size, start = sigma * times, LAG_S if name == "thrust_lag" else 0.0
    parts = [(runs - runs // 2, SEED, size), (runs // 2, SEED + runs - runs // 2, -size)]
    result = []
    for count, seed, value in parts if signed else [(runs, SEED, size)]:
        result += demo(vehicle, count, seed, *options, "--mismatch", f"{name}={start + value:.6g}")
    return result


def share(runs, of=0):
    """Wrong flags among flags (of=0), flags among parameters (of=2), with a bootstrap's ends."""
    part, whole = (1, 0) if of == 0 else (0, 2)
    draw = random.Random(1)
    ratio = lambda rows: sum(r[part] for r in rows) / max(1, sum(r[whole] for r in rows))
    drawn = sorted(ratio(draw.choices(runs, k=len(runs))) for _ in range(1000))
    return ratio(runs), drawn[25], drawn[974]


def table():
    worst, few, total, medium = [], [], 0, {}
    for vehicle in VEHICLES:
        perfect = share(demo(vehicle, 200, SEED), 2)[0]
        print(f"{vehicle}: no mismatch, 200 runs: flagged {100 * perfect:.1f} %", flush=True)
        print(f"{'mismatch':17} {'size':9}" + "".join(
            f"  {name:>6}: flagged  wrong [95 %]      " for name, _ in SIZES))
        for name, (sigma, signed) in mismatches(vehicle).items():
            print(f"{name:17} {'+-' if signed else '  '}{sigma:<7.3g}", end="")
            for size, times in SIZES:
                runs = row(vehicle, name, sigma, signed, times, RUNS)
                wrong, low, high = share(runs)
                flagged = share(runs, 2)[0]
                total += 1
                if wrong > 0.05:
                    worst.append(f"{vehicle} {name} {size}: {100 * wrong:.1f} %")
                if flagged < 0.5 * perfect:
                    few.append(f"{vehicle} {name} {size}: {100 * flagged:.1f} %")
                for k, run in enumerate(runs if size == "medium" else []):
                    medium.setdefault((vehicle, k), []).append(run)
                print(f"          {100 * flagged:5.1f}  {100 * wrong:5.1f} "
                      f"[{100 * low:4.1f}, {100 * high:4.1f}]", end="")
            print(flush=True)
    # The same seeds in all rows: a vehicle's seed is one case.
    pooled = share([tuple(map(sum, zip(*runs))) for runs in medium.values()])
    print(f"rows with more than 5 % wrong: {len(worst)} of {total}", *worst, sep="\n  ")
    print(f"rows with less than half of the flags: {len(few)} of {total}", *few, sep="\n  ")
    print("medium rows pooled: wrong %.2f %% [%.2f, %.2f]" % tuple(100 * x for x in pooled))
    assert len(worst) <= 0.05 * total and len(few) <= 0.2 * total and pooled[2] <= 0.03


def short():
    listed = subprocess.run([os.environ["AUVID"], "demo", "--mismatch", "list"],
                            capture_output=True, check=True, text=True).stdout.splitlines()[1:]
    names = {line.split()[0] for line in listed if "not in mixtures" not in line}
    for vehicle in VEHICLES:
        assert set(mismatches(vehicle)) == names - {"hull"}, names
        for name, (sigma, signed) in mismatches(vehicle).items():
            assert len(row(vehicle, name, sigma, signed, 2.0, 2, "--sets", "1")) == 2


if __name__ == "__main__":
    {"table": table, "short": short}[sys.argv[1]]()
END

export AUVID
check "the rows have all mismatches of a mixture, with sizes that exist" python3 rows.py short
if [ -n "${AUVID_TEST_LONG:-}" ]; then
    long() {
        python3 rows.py table >table.txt
    }
    check "one mismatch: few flags are wrong, and most remain" long
    sed 's/^/# /' table.txt
fi
finish
