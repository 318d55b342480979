#!/usr/bin/env bash
# auvid fit: forms of a log beside the usual one. Each is written from the same simulated dive, and
# its estimates must be those of the usual form. And: memory, which must not depend on the length.
. "$(dirname "$0")/common.sh"

"$AUVID" demo --json --seed 5 --disturbance 1 --sets 2 --csv train.csv >/dev/null

# change PYTHON <IN >OUT: runs code on h (header) and r (rows of numbers; None: an empty cell).
change() {
    python3 -c '
import csv, math, sys
rows = list(csv.reader(sys.stdin)); h = rows[0]; r = [[float(x) for x in y] for y in rows[1:]]
C = {n: i for i, n in enumerate(h)}
ANGLES, RATES = ["phi_rad", "theta_rad", "psi_rad"], ["p_radps", "q_radps", "r_radps"]
VELOCITY, WRENCH = ["u_mps", "v_mps", "w_mps"], ["X_N", "Y_N", "Z_N", "K_Nm", "M_Nm", "N_Nm"]
def drop(*names):
    global h, r
    keep = [i for i, n in enumerate(h) if n not in names]
    h = [h[i] for i in keep]; r = [[y[i] for i in keep] for y in r]
def add(names, values):
    global h, r
    h = h + names; r = [y + list(values(y)) for y in r]
def empty(names, where):
    for i, y in enumerate(r):
        for n in names:
            if where(i): y[C[n]] = None
def thrust(y):
    X, Y, Z, N = (y[C[n]] for n in ("X_N", "Y_N", "Z_N", "N_Nm"))
    return [-X / 2 - N / 0.8, -X / 2 + N / 0.8, -Z / 2, -Z / 2, Y]
exec(sys.argv[1])
out = csv.writer(sys.stdout, lineterminator="\n"); out.writerow(h)
out.writerows([["" if x is None else "%.12g" % x for x in y] for y in r])' "$1"
}

# equals REFERENCE TOLERANCE: the estimates in the file out are those of the reference.
equals() {
    is out "
first = {p['name']: p['estimate'] for p in json.load(open('$1'))['parameters']}
assert all(abs(P[n]['estimate'] / first[n] - 1) < $2 for n in TRUTH), \\
    {n: P[n]['estimate'] / first[n] - 1 for n in TRUTH}"
}
# form STATUS REFERENCE TOLERANCE ARGUMENTS...
form() {
    local status=$1 reference=$2 tolerance=$3
    shift 3
    exits "$status" fit "$@" --json && equals "$reference" "$tolerance"
}

check "the usual form" exits 0 fit train.csv --plain --json
cp out plain.json
check "  with its thrusters" exits 0 fit train.csv --thrusters girona500 --json
cp out thrusters.json

# ---- attitude ----
change '
def quaternion(y):
    (a, b), (c, d), (e, f) = ((math.cos(y[C[n]] / 2), math.sin(y[C[n]] / 2)) for n in ANGLES)
    q = [a*c*e + b*d*f, b*c*e - a*d*f, a*d*e + b*c*f, a*c*f - b*d*e]
    return [0.97 * x * (1 if int(y[0]) % 2 else -1) for x in q]
add(["qw", "qx", "qy", "qz"], quaternion); drop(*ANGLES)' <train.csv >quaternion.csv
check "a quaternion of either sign and of a norm near 1" \
    form 0 plain.json 1e-4 quaternion.csv --plain
change 'empty(ANGLES, lambda i: i % 5)' <train.csv >slow_attitude.csv
check "attitude slower than its rates, which propagate it" \
    form 0 plain.json 3e-3 slow_attitude.csv --plain

# ---- each sensor at its own rate ----
change '
parts = [ANGLES + RATES, VELOCITY, WRENCH]
r = [[y[0] + 1e-6 * k if n == "t_s" else y[i] if n in part else None for i, n in enumerate(h)]
     for y in r for k, part in enumerate(parts)]' <train.csv >parts.csv
check "a row for each sensor" form 0 plain.json 1e-3 parts.csv --plain
change 'empty(VELOCITY, lambda i: i % 10)' <train.csv >empty.csv
check "a velocity at 5 Hz, with empty cells in between" exits 0 fit empty.csv --plain --json
cp out empty.json
check "  masses within 2 %" is out 'assert all(error(n) < 0.02 for n in TRUTH if n[0] == "m")'
change '
for i, y in enumerate(r):
    for n in VELOCITY: y[C[n]] = r[i - i % 10][C[n]]' <train.csv >held.csv
check "a velocity at 5 Hz, held in between" exits 0 fit held.csv --plain --json
check "  is recognised" grep -q 'held.csv: the velocity is held .* each 0.2 s, rows each 0.02 s' err
check "  gives the bits of that with empty cells" same_result empty.json
change '
import random
random.seed(1)
late = {50 * k + random.randrange(0, 9) for k in range(len(r) // 50)}
empty(VELOCITY, lambda i: i not in late)' <train.csv >slow.csv
check "a velocity at 1 Hz, not quite regular" exits 0 fit slow.csv --plain --json
check "  masses within 10 %" is out 'assert all(error(n) < 0.1 for n in TRUTH if n[0] == "m")'
change '
for i, y in enumerate(r):
    for n in VELOCITY: y[C[n]] = 0 if i % 1000 < 300 else round(y[C[n]], 3)' <train.csv >rests.csv
exits 3 fit rests.csv --plain --json >rests.said
check "a vehicle that rests, with velocities of 1 mm/s resolution, is not held" \
    sh -c '! grep -q "is held" err'
change '
for y in r:
    for n in VELOCITY: y[C[n]] = round(y[C[n]] * 0.05, 3)' <train.csv >slow.csv
exits 0 fit slow.csv --plain --json >slow.said
check "a slow vehicle with velocities of 1 mm/s resolution is not held" test ! -s err
"$AUVID" demo --vehicle bluerov2_standard --lag 0.15 --disturbance 0.5 --csv quick.csv >out 2>err
awk -F, -v OFS=, 'NR > 1 && NR % 50 != 2 { $5 = $6 = $7 = "" } { print }' quick.csv >seldom.csv
check "a quick vehicle with a velocity at 1 Hz" exits 0 fit seldom.csv \
    --vehicle bluerov2_standard --json
check "  its wrench is smoothed as the velocity is" is out '
assert d["log"]["velocity_s"] == 1
for name, truth in (("m_u", 17.9), ("m_v", 18.6), ("m_w", 30.2)):
    assert abs(P[name]["estimate"] - truth) < P[name]["half_width"] < 0.3 * truth, P[name]'
python3 - <<'END'
import csv, random
head, *rows = csv.reader(open("quick.csv"))
at = {n: i for i, n in enumerate(head)}
velocity = [at[n] for n in ("u_mps", "v_mps", "w_mps")]
inputs = [i for n, i in at.items() if n.endswith(("_N", "_Nm"))]
def write(name, rows):
    csv.writer(open(name, "w", newline="")).writerows([head, *rows])
def thin(keep):
    return [[x if j not in velocity or keep(k) else "" for j, x in enumerate(r)]
            for k, r in enumerate(rows)]
random.seed(1)
lost = {k for k in range(0, len(rows), 10) if random.random() < 0.4}
usual = thin(lambda k: k % 10 == 0)
write("usual.csv", usual)
write("lost.csv", thin(lambda k: k % 10 == 0 and k not in lost))
late = usual[10:] + usual[-1:] * 10
write("early.csv", [[late[k][j] if j in inputs else x for j, x in enumerate(r)]
                    for k, r in enumerate(usual)])
parked = []
for k in range(6000):  # two minutes
    row = [f"{0.02 * k - 120:.2f}", *["0"] * (len(head) - 1)]
    for j in velocity:
        row[j] = f"{random.gauss(0, 0.005):.4f}" if k % 10 == 0 else ""
    parked.append(row)
write("parked.csv", [[f"{float(r[0]) + 120:.2f}", *r[1:]] for r in parked + usual])
END
for log in usual lost early parked; do
    "$AUVID" fit "$log.csv" --vehicle bluerov2_standard --json >"$log.json" 2>"$log.err"
done
fitted='
import json
def parameter(log, name):
    return {p["name"]: p["estimate"] for p in json.load(open(log + ".json"))["parameters"]}[name]
def drag(log): return [x["force"] for x in json.load(open(log + ".json"))["drag"]["X"]]
'
check "a DVL that loses samples leaves the mass of a quick vehicle right" python3 -c "$fitted
assert abs(parameter('lost', 'm_w') / 30.2 - 1) < 0.04, parameter('lost', 'm_w')"
check "thrust that acts 0.2 s after its stamp leaves the drag right" python3 -c "$fitted
for late, force in zip(drag('early'), drag('usual')):
    assert abs(late / force - 1) < 0.03, (late, force)"
check "  its inputs are shifted" grep -q '"input_shift_s": .0\.[12]' early.json
check "two minutes at rest without thrust leave W-B as it is" python3 -c "$fitted
assert abs(parameter('parked', 'W-B') - parameter('usual', 'W-B')) < 0.1"

# ---- inputs of another clock ----
late() { # CELLS OUT: motion and attitude so much later than the inputs, or earlier
    change "
later = $1; n = [C[x] for x in ANGLES + VELOCITY + RATES]; old = [list(y) for y in r]
r = r[max(later, 0):len(r) + min(later, 0)]
for i, y in enumerate(r):
    for c in n: y[c] = old[max(i - min(later, 0), i)][c]" <train.csv >"$2"
}
# shifted FILE: masses within 2 %, drag at 0.6 of the largest speed within 5 %
shifted() {
    exits 0 fit "$@" --plain --json && is out '
assert all(error(n) < 0.02 for n in TRUTH if n[0] == "m"), {n: error(n) for n in TRUTH}
for axis, (a, b) in (("X", ("X_u", "X_uu")), ("Y", ("Y_v", "Y_vv")), ("Z", ("Z_w", "Z_ww")),
                     ("N", ("N_r", "N_rr"))):
    f = d["drag"][axis][1]
    assert abs(f["force"] / f["speed"] / (TRUTH[a] + TRUTH[b] * abs(f["speed"])) - 1) < 0.05, axis'
}
late 65 later.csv
check "motion 1.3 s late" shifted later.csv
check "  is shifted by that" is out 'assert 1.1 <= d["log"]["input_shift_s"][0] <= 1.3'
exits 0 fit later.csv --plain >/dev/null
check "  which the report says" grep -q '^ *later.csv: they act 1.[123] s later than logged' out
late -40 earlier.csv
check "motion 0.8 s early" shifted earlier.csv
check "  is shifted by that" is out 'assert -1.0 <= d["log"]["input_shift_s"][0] <= -0.8'
check "logs of two clocks" shifted later.csv earlier.csv
check "and the held-out log has a third" \
    exits 0 fit later.csv --validate earlier.csv --plain --json
check "  whose motion is predicted" is out '
assert min(x for x in d["r2_validation"].values() if x is not None) > 0.98, d["r2_validation"]
assert d["held_out_log"]["input_shift_s"][0] < -0.7'

# ---- velocities of few steps ----
change '
for y in r:
    y[C["v_mps"]] = 0.5 * round(y[C["v_mps"]] / 0.5)' <train.csv >steps.csv
check "a velocity of few steps is left out" exits 0 fit steps.csv --plain --json
check "  with a warning" grep -q 'v_mps has steps of 0.5, too coarse .*, and is left out' err
check "  and the reason; the others are identified, without advice on sway" is out '
assert all((P[n]["estimate"] is None) == (n in ("m_v", "Y_v", "Y_vv")) for n in TRUTH)
assert P["m_v"]["note"] == "velocity is too coarse, or stuck", P["m_v"]
assert error("m_w") < 0.03 and P["m_w"]["identifiable"]
assert not any("sway" in sentence for sentence in d["missing"]), d["missing"]'
change '
for y in r:
    for n in ANGLES + RATES + VELOCITY: y[C[n]] = 2 * round(y[C[n]] / 2)' <train.csv >signs.csv
check "all too coarse: exit 3" exits 3 fit signs.csv --plain --json
check "  in words" sh -c '"$0" fit signs.csv --plain 2>/dev/null |
    grep -q "^nothing identified: the velocities are too coarse, or stuck"' "$AUVID"

# ---- thrusters ----
change 'add(["thruster_%d_N" % k for k in range(1, 6)], thrust); drop(*WRENCH)' \
    <train.csv >newtons.csv
check "thrusters without their vehicle" exits 0 check newtons.csv
check "  are not checked, which the verdict says" \
    grep -q '^usable for identification; thruster columns are not checked without --vehicle$' out
check "thrusters with their vehicle" exits 0 check newtons.csv --vehicle girona500
check "  are" grep -q '^usable for identification: surge, sway, heave, yaw$' out
check "forces of thrusters" form 0 thrusters.json 1e-3 newtons.csv --thrusters girona500
# fins also push sideways, where nothing is controlled
"$AUVID" demo --vehicle torpedo --lag 0.15 --csv torpedo.csv >/dev/null 2>&1
change '
def fins(y): return [y[C["X_N"]], -y[C["N_Nm"]] / 0.65, y[C["M_Nm"]] / 0.65]
add(["thruster_%d_N" % k for k in (1, 2, 3)], fins); drop(*WRENCH)' <torpedo.csv >fins.csv
check "a torpedo" exits 0 fit torpedo.csv --vehicle torpedo --json
cp out torpedo.json
check "  by the forces of its fins" exits 0 fit fins.csv --vehicle torpedo --json
check "  which push sideways, too" is out "
first = {p['name']: p['estimate'] for p in json.load(open('torpedo.json'))['parameters']}
same = [n for n in first if first[n] and abs(P[n]['estimate'] / first[n] - 1) < 1e-3]
assert len(same) >= 16 and 'Y_vv' in same, same"
commands='
def commands(y):
    return [math.copysign(math.sqrt(abs(f) / 153.8), f) for f in thrust(y)]'
change "$commands"'
add(["thruster_%d" % k for k in range(1, 6)], commands); drop(*WRENCH)' <train.csv >throttle.csv
check "commands of thrusters" form 0 thrusters.json 1e-3 throttle.csv --thrusters girona500
check "  without estimating their errors" form 0 plain.json 1e-3 throttle.csv \
    --vehicle girona500 --plain
sed 's/^map = signed-square/map = rpm\nfull_command = 1200/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >speed.ini
change "$commands"'
add(["rpm_%d" % k for k in range(1, 6)], lambda y: [1200 * c for c in commands(y)])
drop(*WRENCH)' <train.csv >speed.csv
sed '1s/thruster_/rpm_/g' throttle.csv >speeds.csv
other_map='the log has rpm_1 .., but the thrusters of girona500 need thruster_1 ..: .*map = rpm'
check "speeds, but the file has another map" one_line 1 "$other_map" \
    fit speeds.csv --vehicle girona500
check "  of a log that is checked" one_line 2 "$other_map" check speeds.csv --vehicle girona500
check "speeds of propellers" form 0 plain.json 1e-3 speed.csv --vehicle speed.ini --plain
sed 's/^map = signed-square/map = signed-square\nvoltage_V = 16\nvoltage_exponent = 2/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >voltage.ini
change "$commands"'
sag = lambda y: 14 + y[0] % 2
add(["thruster_%d" % k for k in range(1, 6)], lambda y: [c * 16 / sag(y) for c in commands(y)])
add(["voltage_V"], lambda y: [sag(y)]); drop(*WRENCH)' <train.csv >voltage.csv
check "commands at a voltage that sags" \
    form 0 plain.json 1e-3 voltage.csv --vehicle voltage.ini --plain
voltage() { "$AUVID" check voltage.csv --vehicle "$1" | grep -c 'warning  *voltage_V falls'; }
check "  and no warning where the file knows the voltage" \
    test "$(voltage girona500) $(voltage voltage.ini)" = "1 0"
# no_voltage COMMAND: it warns of a voltage that is missing, or zero.
no_voltage() {
    "$AUVID" "$1" "$2" --vehicle voltage.ini >out 2>&1
    grep -q 'warning.* voltage_V is missing, or always 0: the thrust is that of 16 V, and not' out
}
change 'drop("voltage_V")' <voltage.csv >no_voltage.csv
change 'for y in r: y[C["voltage_V"]] = 0' <voltage.csv >zero_voltage.csv
change 'for y in r: y[C["voltage_V"]] *= 1000' <voltage.csv >millivolts.csv
for log in no zero; do
    check "${log}_voltage.csv: check says that thrust is not corrected" \
        no_voltage check "${log}_voltage.csv"
    check "  fit, too" no_voltage fit "${log}_voltage.csv"
done
check "a voltage in millivolts" rejects 'voltage_V is up to 1[56][0-9]+, but .* to 16 V: give' \
    fit millivolts.csv --vehicle voltage.ini
check "  of check" exits 1 check millivolts.csv --vehicle voltage.ini
check "  is the error, and not the commands" sh -c \
    'grep -Eq "error +voltage_V is up to 1[56][0-9]+" out && ! grep -q zero_command out'
sed 's/^map = signed-square/map = signed-square\ndelay_s = 0.1/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >late.ini
change "$commands"'
add(["thruster_%d" % k for k in range(1, 6)], commands); drop(*WRENCH)
for i in range(len(r) - 5): r[i][-5:] = r[i + 5][-5:]' <train.csv >late.csv
check "commands that act 0.1 s later, as the vehicle file says" \
    form 0 plain.json 1e-2 late.csv --vehicle late.ini --plain

change "$commands"'
add(["thruster_%d" % k for k in range(1, 6)], commands); drop(*WRENCH)
for y in r: y[h.index("thruster_2")] *= -1' <train.csv >reversed.csv
check "thrusters are compared with the motion" exits 0 check throttle.csv --vehicle girona500
check "  a reversed one is named" exits 1 check reversed.csv --vehicle girona500
check "  with the remedy" grep -q 'error    thruster_2 has the wrong sign: .*: change its sign' out
check "  by fit, too" sh -c "
    '$AUVID' fit reversed.csv --vehicle girona500 --json 2>err >reversed.out
    grep -q '^auvid: reversed.csv: thruster_2 has the wrong sign' err"
check "  and a log" refuses '--vehicle is for a log' check girona500 --vehicle girona500

# A second pair of thrusters that turns the vehicle, always with the first one.
python3 - "$ROOT/tools/auvid/vehicles/girona500.ini" >tunnels.ini <<'END'
import re, sys
text = re.sub(r"\[thruster\.5\].*?(?=\n\[)", "", open(sys.argv[1]).read(), flags=re.S)
for k, x in ((5, 0.5), (6, -0.5)):
    text += f"\n[thruster.{k}]\nposition_m = {x} 0 0\ndirection = 0 1 0\n"
    text += "forward_N = 153.8\nbackward_N = 153.8\ngroup = all\n"
print(text)
END
tunnels() { # OUT SHARE: the first pair has this share of the yaw moment
    change "
def pairs(y):
    X, Y, Z, N = (y[C[n]] for n in ('X_N', 'Y_N', 'Z_N', 'N_Nm'))
    share = $2
    f = share * N / 0.8
    return [-X / 2 - f, -X / 2 + f, -Z / 2, -Z / 2, Y / 2 + N - share * N, Y / 2 - N + share * N]
add(['thruster_%d_N' % k for k in range(1, 7)], pairs); drop(*WRENCH)" <train.csv >"$1"
    sed '1s/thruster_1/other/; 1s/thruster_2/thruster_1/; 1s/other/thruster_2/' "$1" >"exchanged-$1"
}
tunnels together.csv 0.3
tunnels apart.csv '(0.9 if y[0] < 25 else 0.3)'
slips='act together in this log, .*: thruster_1_N and thruster_2_N exchanged; run each of them'
for log in together.csv exchanged-together.csv; do
    check "$log: a slip that motion cannot show" exits 0 check $log --vehicle tunnels.ini
    check "  is said" grep -q "warning  the thrusters always $slips" out
done
check "  by fit, too" sh -c "'$AUVID' fit together.csv --vehicle tunnels.ini 2>err >fit.said
    grep -q 'warning: together.csv: the thrusters always $slips' err"
check "where the pairs act apart" exits 0 check apart.csv --vehicle tunnels.ini
check "  nothing is said" sh -c '! grep -q "these slips" out'
check "  since the exchange is found" exits 1 check exchanged-apart.csv --vehicle tunnels.ini
check "  and named" grep -q 'error    thruster_1_N and thruster_2_N are exchanged' out
check "vehicles whose thrusters are checked" exits 0 check throttle.csv --vehicle girona500
check "  no such sentence" sh -c '! grep -q "these slips" out'

sed '1s/u_mps/U_mps/' throttle.csv >capital.csv
check "a velocity in capitals" exits 1 check capital.csv --vehicle girona500
check "  is missing to the thrusters, which have no column X_N" grep -q \
    'u_mps is missing, but the surge force of the thrusters is there: .*: make it of U_mps$' out
change 'for y in r: y[C["r_radps"]] = 0' <throttle.csv >still.csv
check "a rate that is stuck" exits 0 check still.csv --vehicle girona500
check "  likewise" grep -q 'r_radps is always 0, but the yaw moment of the thrusters acts' out
sed 's/^position_m = 0 0.4/position_m = 0 40/' "$ROOT/tools/auvid/vehicles/girona500.ini" >far.ini
check "a position in another unit" exits 0 check throttle.csv --vehicle far.ini
check "  is named" grep -Eq \
    'warning  \[thruster\.[0-9]\] position_m: it is [0-9.]+ m from the origin, too far for' out

# ---- which map ----
sed 's/^map = signed-square/map = linear/' "$ROOT/tools/auvid/vehicles/girona500.ini" >linear.ini
sed 's/^map = signed-square/map = table\ncommand = -1 -0.5 0 0.5 1\nforce_N = -140 -38 0 38 140/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >table.ini
check "a vehicle file with a wrong map: --map auto takes the right one" \
    form 0 plain.json 1e-3 throttle.csv --vehicle linear.ini --plain --map auto
check "  and says so, with the differences and their intervals" is out '
m = d["map"]
assert (m["as_told"], m["best"], m["used"]) == ("linear", "signed-square", "signed-square"), m
told, other = m["tried"]
assert told["interval"] == [0, 0] and other["interval"][1] < 0 and m["held_out"] == "parts"
assert other["error"] < 0.02 < told["error"] and m["blocks"] >= 8, m
assert abs(other["error"] - told["error"] - other["difference"]) < 1e-6'
check "  in words" sh -c "'$AUVID' fit throttle.csv --vehicle linear.ini --plain --map auto |
    grep -A 4 '  map  ' >words; grep -q 'signed-square instead of linear (as configured)' words &&
    grep -q 'difference -.*, 95 % interval -.* to -' words"
"$AUVID" demo --seed 5 --disturbance 1 --sets 4 --csv four.csv >/dev/null
change "$commands"'
add(["thruster_%d" % k for k in range(1, 6)], commands); drop(*WRENCH)' <four.csv >four-throttle.csv
check "without it, the inputs are contradicted" exits 3 fit four-throttle.csv --vehicle linear.ini
check "  says the first line" grep -q '^nothing identified: the motion contradicts the inputs' out
check "  and the only advice" test "$(sed -n '/^  missing/,/^$/p' out)" = "  missing
    the inputs: correct them first; compare thrust maps: --map auto"
check "  of no map, if one was chosen" exits 3 fit four-throttle.csv --vehicle linear.ini \
    --map linear
check "  indeed" grep -q '^    the inputs: correct them first$' out
check "a right one is kept" exits 0 fit throttle.csv --vehicle girona500 --plain --map auto --json
check "  and better than the other" is out 'm = d["map"]
assert m["used"] == m["best"] == m["as_told"] == "signed-square", m
assert m["tried"][1]["interval"][0] > 0, m'
# the motion of most of this log is unstable, so that an estimate of it diverges in the rest
change "$commands"'
for y in r:
    u = y[C["u_mps"]]
    if y[0] < 0.8 * r[-1][0]: y[C["X_N"]] -= 142 * u + 125 * u * abs(u)
add(["thruster_%d" % k for k in range(1, 6)], commands); drop(*WRENCH)' <train.csv >unstable.csv
check "the error of a simulation that diverges is bounded" exits 0 fit unstable.csv \
    --vehicle girona500 --plain --map auto --json
check "  to that of no motion" is out '
assert all(t["error"] < 1 for t in d["map"]["tried"]), d["map"]'
# one part of five contradicts the others
"$AUVID" demo --json --seed 5 --disturbance 1 --sets 9 --csv long.csv >/dev/null
change "$commands"'
def mixed(y):
    middle = 0.4 < y[0] / r[-1][0] < 0.6
    return [1.2 * f / 153.8 if middle else c for f, c in zip(thrust(y), commands(y))]
add(["thruster_%d" % k for k in range(1, 6)], mixed); drop(*WRENCH)' <long.csv >mixed.csv
"$AUVID" fit mixed.csv --vehicle girona500 --plain --map auto >mixed.out 2>&1
check "no map is called the best if the parts disagree" \
    grep -q 'map  .*signed-square, as configured: no other map is better beyond doubt' mixed.out
check "three maps, judged on another log" exits 0 fit throttle.csv --vehicle table.ini --plain \
    --map auto --json --validate throttle.csv
check "  a table that is nearly right" is out 'm = d["map"]; e = [t["error"] for t in m["tried"]]
assert m["held_out"] == "log" and e[0] < 0.02 < e[1] and e[2] < 0.02, m
assert [t["map"] for t in m["tried"]] == ["table", "linear", "signed-square"]'
change "$commands"'
r = [y for y in r if y[0] < 40]
add(["thruster_%d" % k for k in range(1, 6)], commands); drop(*WRENCH)' <train.csv >short.csv
"$AUVID" fit short.csv --vehicle linear.ini --plain --map auto >short.out 2>&1
check "too short a log: as configured, and it says so" grep -q 'linear, as configured: .*' short.out
check "--map names one" form 0 plain.json 1e-3 throttle.csv --vehicle linear.ini --plain \
    --map signed-square
check "a map of forces" rejects 'train.csv: --map needs commands .*, but the log has forces' \
    fit train.csv --map auto
check "a map of thrusters in newtons" rejects 'newtons' fit newtons.csv --vehicle girona500 \
    --map linear

# ---- commands of the axes ----
change '
names = dict(X_N="cmd_surge", Y_N="cmd_sway", Z_N="cmd_heave", K_Nm="cmd_roll", M_Nm="cmd_pitch",
             N_Nm="cmd_yaw")
for y in r:
    for n in names: y[C[n]] /= 50 if n == "N_Nm" else 200
h = [names.get(n, n) for n in h]' <train.csv >commands.csv
gains="--gain surge=200 --gain sway=200 --gain heave=200 --gain=yaw=50"
# shellcheck disable=SC2086
check "the doctor needs the inputs of the thrusters, or forces" refuses \
    'no input column of the thrusters of girona500 \(thruster_1 .*merge the files by t_s' \
    check commands.csv --vehicle girona500
check "commands with a gain for each axis" form 0 plain.json 1e-3 commands.csv --plain $gains
check "  have the units of forces" is out 'assert P["m_u"]["unit"] == "kg"'
check "a gain is missing" rejects 'cmd_yaw has no gain' fit commands.csv --gain surge=1 \
    --gain sway=1 --gain heave=1
change 'for y in r: y[C["cmd_yaw"]] = 0' <commands.csv >straight.csv
check "  a command that is always zero needs none" exits 0 fit straight.csv --plain --json \
    --gain surge=200 --gain sway=200 --gain heave=200
check "  and its axis is not identified" is out '
assert P["m_r"]["note"] == "input is always zero" and P["m_u"]["unit"] == "kg", P'
check "gains of forces" rejects '--gain needs commands' fit train.csv --gain surge=1
check "--dry-mass of commands" rejects '--dry-mass needs forces' fit commands.csv --dry-mass 9
check "--dry-mass" exits 0 fit train.csv --plain --json --dry-mass 300
check "  a smaller mass is marked" is out '
assert {P[n]["note"] for n in ("m_u", "X_u", "X_uu")} == {"m_u is impossible"}, P'

for kind in loop open; do
    python3 "$ROOT/tests/program/controlled.py" $kind >$kind.csv
done
check "a log of a controller" exits 3 fit loop.csv --plain --json
check "  nothing of it is identifiable" is out '
assert not any(p["identifiable"] for p in P.values())
assert P["m_u"]["note"] == P["X_uu"]["note"] == "closed loop: the wrench is feedback", P'
check "  and what to do if there was no controller" is out '
assert d["missing"][0].startswith("closed loop: the wrench is feedback of a controller; "), d
assert d["missing"][0].endswith("; if no controller drove it: --open-loop AXIS,.."), d["missing"]'
awk -F, -v OFS=, 'NR > 1 { $8 += 60 } { print }' loop.csv >biased.csv
exits 3 fit biased.csv --thrusters girona500 --json >biased.said
check "  nor with inputs that contradict the motion, and the controller is named" is out '
assert d["wrong_inputs"][0].startswith("thrust, time stamps or sensors are far less exact"), d
assert P["m_u"]["note"] == "closed loop: the wrench is feedback", P["m_u"]
assert d["missing"][0].startswith("closed loop: "), d["missing"]'
check "a log of a pilot" exits 0 fit open.csv --plain --json
check "  is none of a controller" is out '
assert P["m_u"]["identifiable"] and P["X_uu"]["identifiable"]'
check "--open-loop: it is not tested" exits 0 fit loop.csv --plain --json --open-loop surge,sway \
    --open-loop heave,yaw
check "  and said so" is out '
assert P["m_u"]["note"] != "closed loop: the wrench is feedback"
assert d["assumed"]["open_loop"] == ["surge", "sway", "heave", "yaw"], d["assumed"]'
check "--closed-loop" exits 0 fit train.csv --plain --json --closed-loop heave,yaw
check "  nothing of these is identifiable, the others are" is out '
for n, p in P.items():
    loop = p["note"] == "closed loop: the wrench is feedback"
    assert loop == (n in ("m_w", "m_r", "W-B", "Z_w", "Z_ww", "N_r", "N_rr")), (n, p)
    assert not (loop and p["identifiable"]) and (n != "m_u" or p["identifiable"])
assert "yaw: closed loop; drive it in open loop" in d["missing"], d["missing"]'

# ---- six degrees of freedom without coupling ----
python3 - >axes.csv <<'END'
import random
random.seed(2)
names = "u_mps v_mps w_mps p_radps q_radps r_radps X_N Y_N Z_N K_Nm M_Nm N_Nm".split()
print(",".join(["t_s"] + names))
nu, thrust, until = [0.0] * 6, [0.0] * 6, [0.0] * 6
for k in range(20 * 120):
    for j in range(6):
        if k / 20 >= until[j]:
            until[j] = k / 20 + random.uniform(1, 6)
            thrust[j] = random.choice([-20, -10, 10, 20]) * (1 if j < 3 else 0.2)
    print(",".join("%.6g" % x for x in [k / 20] + nu + thrust))
    for j in range(6):
        mass, drag = (20 + j, 30) if j < 3 else (j - 1, 4)
        for _ in range(10):
            nu[j] += (thrust[j] - drag * nu[j]) / mass / 200
END
check "six axes that do not act on each other" exits 0 fit axes.csv --plain --json --model fossen \
    --coupling off
check "  have their masses within 2 %" is out '
assert d["model"] == "Fossen, 6 DoF, decoupled"
masses = [P[n]["estimate"] for n in list(P)[:6]]
assert all(abs(x / y - 1) < 0.02 for x, y in zip(masses, [20, 21, 22, 2, 3, 4])), masses'

# ---- a DVL ahead of the origin ----
change '
for y in r: y[C["v_mps"]] += 0.4 * y[C["r_radps"]]; y[C["w_mps"]] -= 0.4 * y[C["q_radps"]]' \
    <train.csv >lever.csv
check "a lever arm that is not in the velocities" \
    sh -c "'$AUVID' fit lever.csv --thrusters girona500 >out 2>err || true"
check "  is named" grep -q 'the DVL is further ahead than configured, by .* its lever arm' out
check "  with what a log needs, once" test "$(grep -c 'subtract omega x arm' err)" = 1

# ---- comments ----
{ printf '# my dive\n\n# t_s is in seconds\n'; cat train.csv; } >comments.csv
check "comments before the header" form 0 plain.json 1e-9 comments.csv --plain
sed '1s/^/# /' train.csv >hash.csv
check "a header that begins with #" form 0 plain.json 1e-9 hash.csv --plain

# ---- several logs ----
change 'for y in r: y[C["Y_N"]] = -y[C["Y_N"]]' <train.csv >sign.csv
check "a log with an error beside one without" exits 0 fit sign.csv train.csv --plain --json
check "  is left out" same_result plain.json
check "  with a warning" grep -q 'warning: sign.csv: left out, because of its errors' err
exits 0 fit sign.csv train.csv --plain >/dev/null
check "  and a line in the heading" grep -q '^ *left out, because of errors: 1 more' out
change 'r = [y for y in r if y[0] < 60]' <train.csv >first.csv
change 'r = [y for y in r if y[0] >= 60]' <train.csv >second.csv
change '
end = max(y[0] for y in r if y[0] < 60); start = min(y[0] for y in r if y[0] >= 60)
for y in r: y[0] += (10 + end - start) if y[0] >= 60 else 0' <train.csv >gap.csv
exits 0 fit gap.csv --plain --json
cp out gap.json
check "two logs" exits 0 fit first.csv second.csv --plain --json
check "  are one with a gap" same_result gap.json
check "  of the same kind of inputs" rejects 'commands.csv:1:1: no input column of the same kind' \
    fit first.csv commands.csv
ln -s first.csv link.csv && cp first.csv copy.csv
for log in first link copy; do
    check "  $log.csv is first.csv, given twice" rejects \
        "$log.csv: the estimate is from this log already \(first.csv\): this is no further log" \
        fit first.csv second.csv $log.csv --plain
done
check "  each named in the heading" exits 0 fit first.csv second.csv --plain
check "  which says how many gaps" grep -q 'fit: first.csv, second.csv$' out
change 'r = [y for y in r if y[0] % 10 > 0.7]' <train.csv >outages.csv
check "gaps of 0.7 s" exits 0 fit outages.csv --plain
check "  are gaps" grep -q ' [1-9] gaps over 0.5 s' out
check "  or not" exits 0 fit outages.csv --plain --max-gap 0.8
check "  by --max-gap" grep -q ' 0 gaps over 0.8 s' out

# A DVL of 5 Hz that loses half of its samples: the rows go on.
change '
import random
random.seed(4)
kept = {k for k in range(0, 100000, 10) if random.random() < 0.5}
empty(VELOCITY, lambda k: k not in kept)' <train.csv >lossy.csv
check "half of the velocities of 5 Hz are lost" exits 0 fit lossy.csv --plain --json
check "  which costs a part of the log" is out '
assert d["log"]["gaps"] == 0
assert all(P[n]["identifiable"] for n in ("m_u", "m_v", "m_w")), P
assert all(error(n) < 0.1 for n in ("m_u", "m_v", "m_w"))'
check "  of the log that is bridged for half a second" exits 3 fit lossy.csv --plain --max-gap 0.4
check "  nothing is left, and the remedy is --max-gap" grep -Eq \
    'the log: the velocity .* has [0-9]+ gaps over 0.4 s .*: fit --max-gap [01].* bridges most' out
lacks() {
    ! grep -Eq "$1" "$2"
}
check "  not a longer log" lacks 'too short|record for longer' out
check "check says what is lost" exits 0 check lossy.csv
check "  by gaps between velocities" grep -Eq \
    'the velocity \(u_mps \.\.\) has [0-9]+ gaps over 1 s \(usually a sample each 0\.[2-4]' out
change 'r = [y for y in r if y[0] % 8 > 0.8]
empty(VELOCITY, lambda k: k % 10)' <train.csv >no_rows.csv
check "gaps of 0.8 s in the rows" exits 0 fit no_rows.csv --plain --json
check "  end a record, also where velocities are as far apart" is out '
assert any("rows were lost to gaps" in m for m in d["missing"]), d["missing"]'

# ---- any length ----
piped() {
    cat train.csv | "$AUVID" fit /dev/stdin --plain --json >out && same_result plain.json
}
check "a pipe is read as often as a file" piped
awk -F, 'NR == 1 { print; next } { t[NR] = $1; sub(/^[^,]*/, ""); rest[NR] = $0 }
    END { for (k = 0; k < 56; ++k) for (i = 2; i <= NR; ++i)
              printf "%.6f%s\n", t[i] + k * (t[NR] - t[2] + 1), rest[i] }' train.csv >hour.csv
check "a log of an hour" python3 - "$AUVID" <<'END'
import resource, subprocess, sys
rows = sum(1 for _ in open("hour.csv"))
assert rows > 50 * 3600, rows
subprocess.run([sys.argv[1], "fit", "hour.csv", "--validate", "hour.csv", "--coupling", "on",
                "--plain", "--json"], check=True, stdout=subprocess.DEVNULL)
kilobytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
print(kilobytes)
assert kilobytes <= 32 * 1024, kilobytes
END
finish
