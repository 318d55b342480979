#!/usr/bin/env bash
# auvid demo --field, --mismatch, --matched: statistics of the results for vehicles with usual
# mismatches. Long form: the table of all worlds, 300 runs each, and its properties.
. "$(dirname "$0")/common.sh"

cat >figures.py <<'END'
import json, math, os, re, subprocess, sys
NAMES = "m_u m_v m_w m_r W-B X_u X_uu Y_v Y_vv Z_w Z_ww N_r N_rr".split()
EQUATION = [0, 1, 2, 3, 2, 0, 0, 1, 1, 2, 2, 3, 3]
WB = 4
near = lambda a, b: math.isclose(a, b, rel_tol=1e-6, abs_tol=1e-8)


def is_wrong(run, i, tau_max, truth="truth"):
    """More than 20 % off, and by a force of more than 2 % of tau_max; W-B: the latter."""
    e, error = EQUATION[i], abs(run["estimate"][i] - run[truth][i])
    speed = max(run["speed"][2 * e:2 * e + 2])
    motion = (1 if i == WB else run["acceleration"][e] if i < WB else
              speed if (i - WB) % 2 == 1 else speed ** 2)
    return error * motion > 0.02 * tau_max[e] and (i == WB or error > 0.2 * abs(run[truth][i]))


def recount(d):
    """The shares once more, from the runs."""
    flags = [(run, i) for run in d["each"] for i in range(13) if run["flagged"][i]]
    tau_max = lambda run: run["vehicle"]["tau_max"] if d["vehicle"] == "any" else d["tau_max"]
    assert all(run["wrong"][i] == is_wrong(run, i, tau_max(run)) for run, i in flags)
    assert near(d["flagged"]["all"]["value"], len(flags) / (13 * d["runs"]))
    for truth, told in (("truth", ""), ("told_truth", "told_")):
        wrong = sum(is_wrong(run, i, tau_max(run), truth) for run, i in flags)
        beyond = sum(abs(run["estimate"][i] - run[truth][i]) > 2.1 * run["sigma"][i]
                     for run, i in flags)
        for name, count in (("wrong", wrong), ("beyond", beyond)):
            f = d[told + name]["all"]
            assert f["of"] == len(flags)
            assert f["value"] is None if not flags else near(f["value"], count / len(flags)), f
    runs = sum(any(run["flagged"][i] and is_wrong(run, i, tau_max(run)) for i in range(13))
               for run in d["each"])
    assert near(d["runs_with_wrong_flag"]["value"], runs / d["runs"])


def whole(d, runs):
    """Everything is there, and is what the runs say."""
    assert d["runs"] == len(d["each"]) == runs and d["parameters"] == NAMES
    assert [run["seed"] for run in d["each"]] == [d["seed"] + k for k in range(runs)]
    assert d["flagged"]["all"]["of"] == 13 * runs and d["flagged"]["masses"]["of"] == 4 * runs
    assert near(sum(f["value"] for f in d["said"].values()), 1)
    shares = [point["flagged"]["value"] for point in d["curve"]]
    assert [point["limit"] for point in d["curve"]] == [0.1, 0.15, 0.2, 0.25, 0.3, 0.4]
    assert shares == sorted(shares) and near(shares[2], d["flagged"]["all"]["value"])
    for forces in d["drag_force"], d["drag_force_one_way"]:
        assert set(forces) == {"off", "flagged", "wrong", "beyond", "within"}
    for question in ("flagged", "wrong", "beyond", "error_over_sigma", "rms_error"):
        for f in d[question].values():
            assert f["value"] is None or f["low"] - 1e-9 <= f["value"] <= f["high"] + 1e-9, f
    recount(d)


if __name__ == "__main__":
    d = json.load(open(sys.argv[1]))
    V = lambda question, group="all": d[question][group]["value"]
    exec(sys.argv[2])
END

# holds FILE CODE: runs Python with the JSON object in FILE as d.
holds() {
    python3 figures.py "$@"
}

# ---- refused arguments ----
check "a mismatch without a size" refuses 'neither NAME=SIZE nor list' demo --mismatch cg_x
check "an unknown mismatch" refuses "'storm' is not a mismatch \(see" demo --mismatch storm=1
for bad in '' x nan 9 0.1m; do
    check "--mismatch cg_x=$bad" refuses 'is not a number from -0.1 to 0.1' \
        demo "--mismatch=cg_x=$bad"
done
for bad in -1 11 nan x; do
    check "--field $bad" refuses -- '--field: .* is not a number from 0 to 10' demo "--field=$bad"
done
drivers="excited, joystick, assisted, lawnmower, station"
check "an unknown driver" refuses "'cat' is not one of $drivers" demo --field 1 --driver cat
for other in "--driver joystick" "--vehicle rov20" "--vehicle any" --perfect-inputs \
    --perfect-thrust; do
    # shellcheck disable=SC2086
    check "$other without field statistics" refuses \
        "demo: ${other%% *}.* needs --field, --mismatch or --matched" demo $other
done
for other in "--scenario payload" "--csv x.csv" --literal --adaptive "--disturbance 1" "--lag 1"; do
    # shellcheck disable=SC2086
    check "--field with $other" refuses -- "--field and ${other%% *} cannot be combined" \
        demo --field 1 $other
done
check "--field with another vehicle" refuses \
    'the vehicles of --field are girona500, rov20 and any' demo --field 1 --vehicle bluerov2
check "--sets of a passive run" refuses -- '--sets needs --driver excited' \
    demo --field 1 --driver joystick --sets 4
check "--then after no excitation" refuses -- '--then needs --driver excited' \
    demo --field 1 --driver joystick --then station
check "--then excited" refuses -- "--then: 'excited' is the driver until then" \
    demo --field 1 --then excited
check "--matched beside a mixture" refuses -- '--matched and --field, .* cannot be combined' \
    demo --matched --field 1
for vehicle in rov20 any; do
    check "$vehicle on a bus" refuses "'$vehicle' is not one of" \
        vehicle --bus memory --vehicle $vehicle
done

# ---- the reports ----
check "--mismatch list" exits 0 demo --mismatch list
check "  names, units, sizes" grep -Eq '^thrust_lag +s +0\.05 \.\. 0\.25 +first-order lag' out
check "tables" exits 0 demo --field 1 --runs 2
check "  contain every part" python3 -c '
text = open("out").read()
for line in ("mismatches   mixture of strength 1", "uncertainty  thrust scale", "  masses   ",
             "  quadratic drag", "for reported thrust", "at 0.6", "half-width limit", "each note"):
    assert line in text, (line, text)'
check "  no line is longer than 100 columns" awk 'length > 100 { exit 1 }' out
for vehicle in girona500 rov20 any; do
    for driver in excited joystick assisted lawnmower station; do
        check "$vehicle, $driver" exits 0 demo --field 1 --vehicle "$vehicle" --driver "$driver" \
            --runs 2 --seed 11 --json
        check "  the figures are those of the runs" holds out "whole(d, 2)"
    done
done
exits 0 demo --field 1 --runs 4 --sets 4 --json
cp out four
exits 0 demo --field 1 --runs 4 --sets 4 --json
check "the same seeds, the same figures" cmp out four
exits 0 demo --field 1 --runs 2 --seed 3 --sets 4 --json
check "seeds are consecutive: runs may be divided among processes" holds out '
assert d["each"] == json.load(open("four"))["each"][2:]'

# ---- a vehicle that is drawn ----
anything="demo --field 1 --vehicle any --runs 3 --seed 5 --sets 4"
# shellcheck disable=SC2086
check "a drawn vehicle" exits 0 $anything --json
cp out drawn
check "  is another one in each run" holds out '
assert d["vehicle"] == "any" and "tau_max" not in d
vehicles = [run["vehicle"] for run in d["each"]]
assert len({v["dry_kg"] for v in vehicles}) == len({v["tau_max"][0] for v in vehicles}) == 3
for run, v in zip(d["each"], vehicles):
    assert 8 <= v["dry_kg"] <= 450 and v["thrusters"] in (5, 6)
    assert v["thruster_max_N"] > 0 and 0.3 < v["length_m"] < 2.4
    assert 1.25 * 0.85 < run["truth"][0] / v["dry_kg"] < 1.6 * 1.15'
exits 0 $anything --json
check "  is the same one for the same seed" cmp out drawn
exits 0 demo --field 1 --vehicle any --runs 1 --seed 7 --sets 4 --json
check "  is that of its seed, in any campaign" holds out '
assert d["each"] == json.load(open("drawn"))["each"][2:]'
exits 0 $anything
check "  is named in the tables" grep -q "^  vehicles     another one in each run" out
exits 0 demo --field 1 --runs 1 --sets 1
check "  and the usual one has no such line" [ "$(grep -c "^  vehicles " out)" = 0 ]
exits 0 demo --field 1 --runs 2 --sets 1 --vehicle rov20 --json
check "  and no vehicle of each run" holds out '
assert d["tau_max"] == [30, 30, 30, 6] and all("vehicle" not in run for run in d["each"])'

# ---- after the excitation ----
rov="demo --field 1 --vehicle rov20 --runs 12 --seed 21 --json"
exits 0 $rov
cp out alone
for driver in station joystick; do
    # shellcheck disable=SC2086
    check "$driver after the excitation" exits 0 $rov --then $driver
    check "  adds sets, raises no alarm, and spoils no estimate" holds out '
sets = [run["sets"] for run in d["each"]]
assert d["driver"] == "excited, then '$driver'" and min(sets) >= 8 + 18, sets
assert all(run["changed"] == run["drifted"] == 0 for run in d["each"])
drag = [o["drag_force"]["flagged"]["0.6"]["value"] for o in (json.load(open("alone")), d)]
assert drag[1] >= 0.9 * drag[0] > 0.5, drag'
done
exits 0 demo --field 1 --runs 4 --seed 21 --json --then lawnmower
check "in closed loop no drift is reported" holds out '
assert all(run["drifted"] == 0 for run in d["each"])'

# ---- a pilot with depth and heading held ----
exits 0 demo --field 1 --driver assisted --runs 4 --json
check "numbers of surge and sway are flagged, of heave and yaw none" holds out '
free = {0, 1, 5, 6, 7, 8}
for run in d["each"]:
    assert sum(run["flagged"]) >= 2 and sum(run["wrong"]) == 0, run
    for i, (flag, note) in enumerate(zip(run["flagged"], run["note"])):
        assert i in free or (not flag and note == 13), (i, note)'

# ---- the reference of a controller ----
loop="demo --field 0 --driver lawnmower --alternate 0.5 --runs 4 --json"
exits 0 demo --field 1 --driver lawnmower --runs 4 --json
check "in closed loop nothing is flagged" holds out '
assert sum(sum(run["flagged"]) for run in d["each"]) == 0'
exits 0 $loop
check "where the model leaves little, what is flagged is right" holds out '
assert sum(sum(run["wrong"]) for run in d["each"]) == 0'
exits 0 $loop --reference
check "with its reference more than half is, and right" holds out '
assert sum(sum(run["flagged"]) for run in d["each"]) > 0.5 * 4 * 13
assert sum(sum(run["wrong"]) for run in d["each"]) == 0'
check "only a controller has a reference" refuses "needs --driver lawnmower or station" \
    demo --field 0 --reference

# ---- causes ----
exits 0 demo --mismatch thrust_backward=0.1 --runs 4 --json
check "weaker backward thrust is named, with a sentence" holds out '
assert d["causes"]["right"] == d["causes"]["any"] == 4 and d["causes"]["wrong"] == 0
assert d["causes"]["thrust_curve"] == {"first": 4, "named": 4}
for run in d["each"]:
    cause = run["causes"][0]
    assert cause["class"] == "thrust_curve" and abs(cause["value"] - 0.1) < 4 * cause["sigma"]
    assert re.match("backward thrust is weaker than supplied, by (9|10|11) % or so; ",
                    cause["sentence"]), cause'
exits 0 demo --field 0 --runs 8 --json
check "nothing is named in a perfect world" holds out '
assert d["causes"]["any"] == 0 and all(run["causes"] == [] for run in d["each"])'
exits 0 demo --mismatch thrust_advance=0.3 --mismatch cg_x=0.001 --runs 2 --shifts --json
check "--shifts: the loss with speed moves the estimate most" holds out '
assert d["causes"]["among_largest"] == d["causes"]["inflow"]["first"] == 2
for run in d["each"]:
    shift = run["shift"]
    assert len(shift) == 7 and shift["inflow"] == max(shift.values()) > 0.05
    assert shift["sag"] == shift["timing"] == 0'
check "--shifts without field statistics" refuses "--shifts needs --field" demo --shifts
check "tables name the cause" exits 0 demo --mismatch thrust_backward=0.1 --runs 1
check "  with its sentence" grep -q "^    backward thrust is weaker than supplied, by 10 %" out

# ---- correctness ----
perfect="demo --field 0 --perfect-inputs --json"
for vehicle in girona500 rov20 any; do
    # shellcheck disable=SC2086
    check "no mismatch, $vehicle" exits 0 $perfect --vehicle $vehicle --runs 8
    check "  no flag is wrong, >= 95 % are flagged" holds out '
assert V("wrong") == 0 and V("flagged") >= 0.95 and V("rms_error") < 0.03
assert all(f["value"] == 1 for part, f in d["drag_force"]["flagged"].items() if part != "1.0")
assert all(f["value"] == 0 for f in d["drag_force"]["wrong"].values())
assert all(f["value"] == 0 for f in d["drag_force"]["off"].values())
assert all(abs(g - 1) < 1e-9 for run in d["each"] for g in run["told_gain"])
assert all(r < 0.1 for run in d["each"] for r in run["residual"])'
done
check "thrust that is 20 % too weak" exits 0 \
    demo --mismatch thrust_common=-0.2 --perfect-inputs --runs 3 --json
check "  masses are wrong in newtons, and right in reported newtons" holds out '
assert V("wrong", "masses") == 1 and V("told_wrong", "all_but_W-B") == 0
assert all(abs(g - 0.8) < 0.01 for run in d["each"] for g in run["told_gain"])
assert all(run["mismatch"] == {"thrust_common": -0.2} for run in d["each"])'
check "perfect thrust" exits 0 demo --field 2 --perfect-thrust --runs 2 --sets 2 --json
check "  is delivered as reported" holds out '
assert all(abs(g - 1) < 1e-3 for run in d["each"] for g in run["told_gain"])
assert all("cross" in run["mismatch"] for run in d["each"])'
check "a mismatch overrides that of a mixture" exits 0 \
    demo --field 1 --mismatch thrust_sag=0 --mismatch ballast=2 --runs 2 --sets 2 --json
check "  in every run" holds out '
assert all(run["mismatch"]["ballast"] == 2 and "thrust_sag" not in run["mismatch"]
           and "thrust_lag" in run["mismatch"] for run in d["each"])'
check "the matched world" exits 0 demo --matched --thrust-scale 0.05 --dvl-scale 0.01 --runs 12 \
    --sets 2 --json
check "  has the given scale errors and no other mismatch" holds out '
assert all(set(run["mismatch"]) == {"thrust_common", "dvl_scale", "hull"} for run in d["each"])
for name, sigma in (("thrust_common", 0.05), ("dvl_scale", 0.01)):
    z = [run["mismatch"][name] / sigma for run in d["each"]]
    assert 0.3 < sum(x * x for x in z) / len(z) < 2.2, z'

# ---- the table ----
table() {
    AUVID="$AUVID" python3 - >table.txt <<'END'
import os, subprocess, sys
sys.path.insert(0, ".")
from figures import json, whole
RUNS, SEED, D = 300, 20001, {}
WORLDS = [("excited", "0"), ("excited", "0.5"), ("excited", "1"), ("excited", "2"),
          ("joystick", "1"), ("lawnmower", "0"), ("lawnmower", "1"), ("station", "1")]
show = lambda f: "-" if f["value"] is None else "%.1f [%.1f, %.1f]" % tuple(
    100 * f[k] for k in ("value", "low", "high"))
for vehicle in ("girona500", "rov20"):
    for driver, strength in WORLDS:
        out = subprocess.run([os.environ["AUVID"], "demo", "--field", strength, "--driver", driver,
                              "--vehicle", vehicle, "--perfect-inputs", "--runs", str(RUNS),
                              "--seed", str(SEED), "--json"], capture_output=True, check=True)
        d = D[vehicle, driver, strength] = json.loads(out.stdout)
        whole(d, RUNS)
        print(vehicle, driver, strength, "flagged", show(d["flagged"]["all"]), "wrong",
              show(d["wrong"]["all"]), "beyond", show(d["beyond"]["all"]), "force at 0.6 off",
              show(d["drag_force"]["off"]["0.6"]), flush=True)
    wrong = [D[vehicle, "excited", f]["wrong"]["all"] for f in ("0", "0.5", "1", "2")]
    flagged = [D[vehicle, "excited", f]["flagged"]["all"] for f in ("0", "0.5", "1", "2")]
    assert wrong[0]["value"] == 0 and flagged[0]["low"] > 0.95
    for less, more in zip(range(3), range(1, 4)):  # more mismatch: fewer flags, more of them wrong
        assert wrong[less]["high"] < wrong[more]["low"], wrong
        assert flagged[less]["low"] > flagged[more]["high"], flagged
    for driver in ("lawnmower", "station"):  # closed loop, without a reference
        closed = D[vehicle, driver, "1"]["flagged"]["all"]
        assert closed["high"] < 0.02, closed
END
}
if [ -n "${AUVID_TEST_LONG:-}" ]; then
    check "the table of all worlds" table
    sed 's/^/# /' table.txt
fi
finish
