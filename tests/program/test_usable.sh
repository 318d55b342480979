#!/usr/bin/env bash
# "usable" or "not usable" of auvid check agrees with what fit makes of a log: logs of simulated
# vehicles, and of a real one where its data are (see test_tank.sh), decimated, shifted in time or
# quantised. Short form: in 60 % of 6 logs. Long form: in 90 % of 200; AUVID_TEST_SEED
# chooses others.
. "$(dirname "$0")/common.sh"
data=$(cd "$ROOT" && realpath -m "${AUVID_TANK_DATA:-../shared/data/bluerov2_tank}")
logs=6
[ -n "${AUVID_TEST_LONG:-}" ] && logs=200

cat >campaign.py <<'END'
"""usage: campaign.py PROGRAM LOGS SEED TANK_DATA"""
import csv, json, os, random, subprocess, sys
program, logs, seed, tank = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
random.seed(seed)
VELOCITY = ["u_mps", "v_mps", "w_mps"]
DRAG = {"X": ("X_u", "X_uu"), "Y": ("Y_v", "Y_vv"), "Z": ("Z_w", "Z_ww"), "K": ("K_p", "K_pp"),
        "M": ("M_q", "M_qq"), "N": ("N_r", "N_rr")}
INPUTS = ["X_N", "Y_N", "Z_N", "K_Nm", "M_Nm", "N_Nm"] + [
    "cmd_" + dof for dof in ("surge", "sway", "heave", "roll", "pitch", "yaw")]


def run(*arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def read(path):
    head, *rows = csv.reader(open(path))
    return head, [[float(x) for x in row] for row in rows]


def decimate(head, rows):
    """Rows further apart; a tank run has 0.16 s already."""
    step = 0.05 * 24 ** random.random()
    kept, due = [], rows[0][0]
    for row in rows:
        if row[0] >= due - 1e-6:
            kept.append(row)
            due = row[0] + step
    return "every %.2f s" % step, kept


def shift(head, rows):
    """Inputs later (positive) or earlier than they were."""
    by = random.uniform(-1.5, 2)
    at = [head.index(n) for n in INPUTS if n in head]
    out, k = [], 0
    for row in rows:
        while k + 1 < len(rows) and rows[k + 1][0] <= row[0] - by:
            k += 1
        new = list(row)
        for i in at:
            new[i] = rows[k][i]
        out.append(new)
    return "inputs %+.2f s" % by, out


def quantise(head, rows):
    """Velocities in steps, as parts of their standard deviation."""
    part = 0.02 * 300 ** random.random()
    out = [list(row) for row in rows]
    for i in [head.index(n) for n in VELOCITY]:
        column = [row[i] for row in rows]
        mean = sum(column) / len(column)
        step = part * (sum((x - mean) ** 2 for x in column) / len(column)) ** 0.5
        for row in out:
            row[i] = step * round(row[i] / step)
    return "steps of %.2g sigma" % part, out


def good(vehicle, truth, path, other):
    """Is there a flagged parameter or drag force, and are four of five within 20 % of the truth?
    Where that is not known: is half of the variance of the other run predicted?"""
    options = ["--vehicle", vehicle] if vehicle else ["--bias", "--validate", other]
    status, out = run("fit", path, *options, "--plain", "--json")
    if status not in (0, 3):
        return False
    result = json.loads(out)
    if not vehicle:
        r2 = [x for x in result["r2_validation"].values() if x is not None]
        return len(r2) > 0 and sum(r2) / len(r2) > 0.5
    right = [abs(p["estimate"] / truth[p["name"]] - 1) < 0.2 for p in result["parameters"]
             if p["identifiable"] and abs(truth.get(p["name"], 0)) > 0]
    for axis, forces in result["drag"].items():
        linear, quadratic = (truth[name] for name in DRAG[axis])
        right += [abs(f["force"] / (linear * f["speed"] + quadratic * abs(f["speed"]) * f["speed"])
                      - 1) < 0.2 for f in forces if f["identifiable"]]
    return len(right) > 0 and sum(right) >= 0.8 * len(right)


bases = []
for k in range(max(3, logs // 10)):
    vehicle = ("girona500", "bluerov2")[k % 2]
    name = "%d.csv" % k
    status, out = run("demo", "--vehicle", vehicle, "--sets", "4", "--disturbance",
                      str((0.2, 1)[k % 2 == 0]), "--seed", str(seed + k), "--csv", name, "--json")
    assert status == 0, out
    bases.append((vehicle, {p["name"]: p["truth"] for p in json.loads(out)["parameters"]}, name,
                  None))
runs = [os.path.join(tank, name) for name in ("run_a.csv", "run_b.csv")]
if os.path.exists(runs[0]):
    bases += [(None, {}, runs[0], runs[1]), (None, {}, runs[1], runs[0])]
agree = {}
for k in range(logs):
    vehicle, truth, path, other = bases[k % len(bases)]
    change = (decimate, shift, quantise)[k // len(bases) % 3 if logs > 6 else k % 3]
    head, rows = read(path)
    how, rows = change(head, rows)
    with open("log.csv", "w") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows([["%.9g" % x for x in row] for row in rows])
    usable = run("check", "log.csv")[0] == 0
    works = good(vehicle, truth, "log.csv", other)
    all_, same = agree.get(change.__name__, (0, 0))
    agree[change.__name__] = all_ + 1, same + (usable == works)
    if usable != works:
        print("%s, %s: check says %s, fit %s" % (os.path.basename(path), how,
              ("not usable", "usable")[usable], ("fails", "works")[works]))
total, same = (sum(x[i] for x in agree.values()) for i in (0, 1))
print("agree: %d of %d; %s" % (same, total, ", ".join(
    "%s %d of %d" % (name, b, a) for name, (a, b) in agree.items())))
sys.exit(same < (0.9 if logs > 6 else 0.6) * total)
END
check "check and fit agree in most of $logs logs" \
    python3 campaign.py "$AUVID" $logs "${AUVID_TEST_SEED:-1}" "$data"
grep -h '^agree' check.log | sed 's/^/# /'
[ -n "${AUVID_TEST_LONG:-}" ] && sed 's/^/# /' check.log
finish
