#!/usr/bin/env bash
# auvid fit from outside, with logs of the demo and modified copies.
. "$(dirname "$0")/common.sh"

"$AUVID" demo --json --seed 5 --disturbance 1 --csv train.csv >demo.json
"$AUVID" demo --json --seed 6 --disturbance 1 --csv test.csv >/dev/null

# change PYTHON <IN >OUT: runs code on h (header) and r (rows of numbers).
change() {
    python3 -c '
import csv, math, sys
rows = list(csv.reader(sys.stdin)); h = rows[0]; r = [[float(x) for x in y] for y in rows[1:]]
C = {n: i for i, n in enumerate(h)}
def drop(*names):
    global h, r
    keep = [i for i, n in enumerate(h) if n not in names]
    h = [h[i] for i in keep]; r = [[y[i] for i in keep] for y in r]
exec(sys.argv[1])
line = ",".join(["%.9g"] * len(h)) + "\n"
print(",".join(h)); sys.stdout.writelines(line % tuple(y) for y in r)' "$1"
}

check "a log is identified" exits 0 fit train.csv --plain --json --validate test.csv
cp out fit.json
check "its JSON has the documented keys" is fit.json '
assert list(d) == ["version", "status", "verdict", "seed", "model", "parameters",
                   "wrong_inputs", "exact_inputs_differ", "missing", "not_modelled",
                   "assumed", "drag", "drag_asymmetry",
                   "delay_s", "r2_force", "r2_validation", "r2_interval",
                   "change_test", "cell_s", "evaluations", "budget", "log", "held_out_log",
                   "log_findings", "velocity"], list(d)
assert all(set(p) == {"name", "unit", "dof", "kind", "estimate", "sigma", "half_width",
                      "sigma_told", "thrust_error", "dvl_error", "identifiable", "note"}
           for p in d["parameters"])
assert [p["name"] for p in d["parameters"]] == list(TRUTH)'
check "it describes the held-out log as the other one" is fit.json '
for key in "velocity_s", "gaps", "gap_s":
    assert d["held_out_log"][key] == d["log"][key] is not None, d["held_out_log"]'
check "parameters within 10 %, masses within 2 %" is fit.json '
assert all(error(n) < (0.02 if n[0] == "m" else 0.1) for n in TRUTH), {n: error(n) for n in TRUTH}'
check "every parameter is within four standard errors, W-B with exact thrust" is \
    fit.json '
assert all(p["identifiable"] == (p["note"] == "") == (n != "W-B") for n, p in P.items())
assert all(abs(p["estimate"] - TRUTH[n]) < 4 * p["sigma_told"] for n, p in P.items()), \
    {n: (P[n]["estimate"] - TRUTH[n]) / P[n]["sigma_told"] for n in P}
assert len(d["missing"]) == 1 and d["missing"][0].startswith("heave: W-B is known to ")
assert d["change_test"] is None'
check "with the thrust calibrated to 1 % every parameter is identifiable" \
    exits 0 fit train.csv --plain \
    --json --thrust-scale 0.01
check "  all are" is out '
assert all(p["identifiable"] for p in d["parameters"]) and d["missing"] == []
assert all(abs(p["thrust_error"] / p["estimate"] - 0.01) < 1e-6 for p in d["parameters"])'
check "the other log is predicted" is fit.json '
for k in "uvwr":
    low, high = d["r2_interval"][k]
    assert 0.98 < low < d["r2_validation"][k] < high <= 1, (k, d["r2_interval"])'
for log in train test; do
    change 'import random
random.seed(1)
moments = [y[C["N_Nm"]] for y in r]
random.shuffle(moments)
for y, moment in zip(r, moments): y[C["N_Nm"]] = moment' <$log.csv >$log.other.csv
done
# They are noise, as the wrench of a controller may be; what is left in yaw is their reverse.
check "with moments that say nothing of yaw" exits 0 fit train.other.csv --plain --json \
    --validate test.other.csv --open-loop yaw
check "  the others are predicted with the measured yaw" is out '
r2 = d["r2_validation"]
assert min(d["r2_force"].values()) < 0.2 and r2["r"] is None
assert all(r2[k] > 0.98 for k in "uvw"), r2'
check "no call works more than its budget" is fit.json \
    'assert 0 < d["budget"]["worst"] <= d["budget"]["limit"]'
exits 0 fit train.csv --plain --json --validate test.csv
check "same log, same output" cmp out fit.json
exits 0 fit train.csv --plain --json --seed 7
check "the seed of the search does not matter" is out '
first = {p["name"]: p["estimate"] for p in json.load(open("fit.json"))["parameters"]}
assert d["seed"] == 7
assert all(abs(P[n]["estimate"] / first[n] - 1) < 0.01 for n in TRUTH)'
check "without --validate there is no R2 of velocity" is out \
    'assert set(d["r2_validation"].values()) == {None} and "r2_interval" not in d'

# ---- errors of thrust and sensors ----
check "without a check of thrust and sensors" exits 3 fit train.csv --json
check "  the estimates are the same, and nothing is identifiable" is out '
first = {p["name"]: p["estimate"] for p in json.load(open("fit.json"))["parameters"]}
assert all(P[n]["estimate"] == first[n] for n in TRUTH)
assert not any(p["identifiable"] for p in d["parameters"])
assert P["m_u"]["note"] == "not checked for errors of thrust and sensors"
assert not any(f["identifiable"] for e in d["drag"].values() for f in e)
assert "not checked for errors of thrust and sensors" in d["missing"][0]'
check "with the thrusters of the vehicle" exits 0 fit train.csv --json --thrusters girona500
check "  masses are identifiable, and all estimates right" is out '
assert all(P[n]["identifiable"] for n in TRUTH if n[0] == "m")
assert all(abs(p["estimate"] - TRUTH[n]) < 2.5 * p["sigma"] for n, p in P.items())
assert d["wrong_inputs"] == [] and d["status"] == "ok"'
for stronger in 1.3 1.7 2.5; do
    change "for y in r: y[C['X_N']] *= $stronger if y[C['X_N']] < 0 else 1" \
        <train.csv >"weaker-$stronger.csv"
done
check "backward thrust that is a quarter weaker than supplied" exits 0 fit weaker-1.3.csv --json \
    --thrusters girona500
check "  is named, and masses are identifiable" is out '
assert d["wrong_inputs"], d["wrong_inputs"]
assert all(p["identifiable"] for n, p in P.items() if n[0] == "m")'
check "backward thrust that is 40 % weaker" exits 3 fit weaker-1.7.csv --json \
    --thrusters girona500
check "  is named, and makes the thrust scale too uncertain" is out '
assert d["wrong_inputs"], d["wrong_inputs"]
assert d["assumed"]["thrust_scale"] > 0.09
assert abs(d["assumed"]["thrust_scale"] / 0.05 - d["assumed"]["over_priors"] ** 2) < 0.01'
check "  the text says why" exits 3 fit weaker-1.7.csv --thrusters girona500
check "    the scale is so uncertain" grep -q 'times as large as their standard deviations' out
sed -nE "s/.*(X_uu|m_u) is known .*give --thrust-scale ([0-9.]+)$/\1 \2/p" out >wanted
check "  and how well the thrust must be known" test -s wanted
check "    after which the parameter is identified" sh -c "while read -r name scale; do
    '$AUVID' fit weaker-1.7.csv --thrusters girona500 --thrust-scale \$scale >better
    grep -E \"^  \$name .*[0-9] *\$\" better || exit 1; done <wanted"
exits 3 fit weaker-2.5.csv --thrusters girona500
check "  and which values exact inputs would change" grep -q \
    '^  exact inputs   (--plain) would give other values of m_r, N_r,$' out
check "    apart from what is wrong" sh -c '! sed -n "/wrong inputs/,/^$/p" out | grep exact'
check "thrusters of no vehicle" refuses "'mine' is not one of" fit train.csv --thrusters mine
check "--thrusters and --plain" refuses '--thrusters and --plain cannot be combined' \
    fit train.csv --thrusters girona500 --plain

# same FILE: fit of this log gives the same as fit of train.csv.
same() {
    exits 0 fit "$1" --plain --json "${@:2}" && is out '
first = {p["name"]: p["estimate"] for p in json.load(open("fit.json"))["parameters"]}
assert all(abs(P[n]["estimate"] / first[n] - 1) < 0.01 for n in TRUTH), \
    {n: P[n]["estimate"] / first[n] for n in TRUTH}'
}
change 'h = h[::-1]; r = [y[::-1] for y in r]' <train.csv >order.csv
check "columns may stand in any order" same order.csv
change 'h.append("note"); r = [y + [1e99] for y in r]' <train.csv >more.csv
check "other columns are ignored" same more.csv
check "  but listed" grep -qx 'auvid: more.csv: ignored columns: note' err
check "  once" test "$(wc -l <err)" = 1
change 'h = h + ["depth_m"]
z, before = 10, r[0][0]
for y in r:
    t, phi, theta, u, v, w = (y[C[n]] for n in
                              "t_s phi_rad theta_rad u_mps v_mps w_mps".split())
    z += (t - before) * (math.cos(theta) * (math.cos(phi) * w + math.sin(phi) * v)
                         - math.sin(theta) * u)
    before = t
    y.append(z)' <train.csv >depth.csv
check "a column that is compared with others is not ignored" same depth.csv
check "  nothing on stderr" test ! -s err
change 'for y in r: y[C["depth_m"]] *= -1' <depth.csv >height.csv
exits 3 fit height.csv --plain --json >height.said
check "  it is compared indeed" grep -q '^auvid: height.csv: depth_m changes against w_mps' err
change 'h = ["u_ms" if n == "u_mps" else n for n in h]; drop("X_N")' <train.csv >misspelt.csv
exits 0 fit misspelt.csv --plain --json >misspelt.said
check "a column that resembles a missing one is named" grep -qx \
    'auvid: misspelt.csv: ignored columns: u_ms (u_ms resembles u_mps)' err
change 'h.append("cmd_surge"); r = [y + [0.5] for y in r]' <train.csv >two_kinds.csv
check "commands in addition to forces are ignored" same two_kinds.csv
check "  and listed" grep -qx 'auvid: two_kinds.csv: ignored columns: cmd_surge' err
sed '1s/^/\xef\xbb\xbf/; s/$/\r/; s/,/ , /' train.csv >windows.csv
printf '\n\n' >>windows.csv
check "a byte order mark, CRLF, blanks and empty lines are accepted" same windows.csv
change 'for y in r: y[C["psi_rad"]] = (y[C["psi_rad"]] + 3) % (2 * math.pi)' <train.csv >wrapped.csv
check "yaw may be wrapped" same wrapped.csv
# A vehicle upside down, with a roll of about 180 degrees.
upside='for y in r: y[C["phi_rad"]] += math.pi'
change "$upside" <train.csv >upside.csv
change "$upside; y[C['phi_rad']] -= 2 * math.pi * (y[C['phi_rad']] > math.pi)" <train.csv >rolls.csv
exits 0 fit upside.csv --plain --json
mv out upside.json
exits 0 fit rolls.csv --plain --json
check "roll may be wrapped" is out '
first = {p["name"]: p["estimate"] for p in json.load(open("upside.json"))["parameters"]}
assert all(abs(P[n]["estimate"] / first[n] - 1) < 0.01 for n in TRUTH), \
    {n: P[n]["estimate"] / first[n] for n in TRUTH}'
change 'for y in r: y[C["psi_rad"]] += 300' <train.csv >turned.csv
check "yaw may begin after many revolutions" same turned.csv

# ---- a log with a truncated last line ----
head -n -1 train.csv >whole.csv
exits 0 fit whole.csv --plain --json
cp out whole.json
last=$(tail -n 1 train.csv)
for keep in 1 20 $((${#last} - 3)) "${#last}"; do # the last one is complete, but has no line end
    { cat whole.csv && printf '%s' "${last:0:keep}"; } >cut.csv
    check "cut after $keep characters of its last line: used up to there" \
    exits 0 fit cut.csv --plain --json
    check "  like the log without that line" same_result whole.json
    check "  with a warning" grep -Eqx \
        'auvid: warning: cut.csv:[0-9]+: the last line .*truncated: it is ignored' err
done
check "a test log may be cut, too" exits 0 fit train.csv --plain --json --validate cut.csv
check "  with a warning" grep -q 'auvid: warning: cut.csv:' err

# ---- degrees ----
degrees='
def scale(k, *names):
    for y in r:
        for n in names: y[C[n]] *= k
ANGLES, RATES = ("phi_rad", "theta_rad", "psi_rad"), ("p_radps", "q_radps", "r_radps")
D = 180 / math.pi
'
# in_degrees NAME CODE PATTERN: fit refuses a log changed by this code, with this message.
in_degrees() {
    change "$degrees$2" <train.csv >degrees.csv
    check "$1" rejects "$3" fit degrees.csv
    check "  in the test log, too" rejects "$3" fit train.csv --validate degrees.csv
}
in_degrees "attitude in degrees" 'scale(D, *ANGLES)' \
    'degrees.csv: theta_rad .*degrees.*radians'
in_degrees "attitude in degrees, of a vehicle that hardly pitches" \
    'scale(D, *ANGLES); scale(0.1, "phi_rad", "theta_rad"); drop("p_radps", "q_radps")' \
    'degrees.csv: psi_rad .*degrees.*radians'
in_degrees "attitude in degrees, slow" \
    'scale(D, *ANGLES); scale(0.1, *ANGLES); scale(0.1, *RATES)' \
    'degrees.csv: psi_rad .*degrees.*radians'
in_degrees "attitude in degrees, rates missing" \
    'scale(D, *ANGLES); drop(*RATES); drop("N_Nm", "theta_rad")
C = {n: i for i, n in enumerate(h)}
for y in r: y[C["psi_rad"]] = (y[C["psi_rad"]] + 300) % 360' 'psi_rad jumps by .*degrees.*radians'
in_degrees "rates in deg/s" 'scale(D, *RATES)' 'degrees.csv: .*r_radps .*deg/s.*rad/s'
in_degrees "rates in deg/s, slow" 'scale(D, *RATES); scale(0.1, *ANGLES); scale(0.1, *RATES)' \
    'degrees.csv: r_radps .*deg/s.*rad/s'
in_degrees "both in degrees" 'scale(D, *ANGLES); scale(D, *RATES)' 'degrees.csv: .*degrees'
in_degrees "rates in deg/s, attitude missing" 'scale(D, *RATES); drop(*ANGLES)' 'r_radps .*rad/s'
python3 -c '
import csv, sys
rows = list(csv.reader(open("train.csv")))
out = csv.writer(open("epoch.csv", "w"), lineterminator="\n"); out.writerow(rows[0])
out.writerows([["%.6f" % (float(y[0]) + 1.7e9)] + y[1:] for y in rows[1:]])'
check "time may count from 1970" same epoch.csv
change 'r = r[::20]' <train.csv >slow.csv
check "rows may be 0.4 s apart" exits 0 fit slow.csv --plain --json --input linear
check "  masses within 5 %" is out 'assert all(error(n) < 0.05 for n in TRUTH if n[0] == "m")'
change 'r = [y for y in r if not 60 < y[0] < 63 and not 100 < y[0] < 107]' <train.csv >gaps.csv
check "gaps are skipped" exits 0 fit gaps.csv --plain --json
check "  masses within 3 %" is out 'assert all(error(n) < 0.03 for n in TRUTH if n[0] == "m")'
change 'r = [y for i, y in enumerate(r) if i * i % 7 not in (1, 4)]' <train.csv >irregular.csv
check "times may be irregular" exits 0 fit irregular.csv --plain --json
check "  masses within 3 %" is out 'assert all(error(n) < 0.03 for n in TRUTH if n[0] == "m")'

change 'drop("N_Nm")' <train.csv >no_yaw.csv
check "a DoF without input is ignored" exits 0 fit no_yaw.csv --plain --json --validate test.csv
check "  its parameters are null, the others are estimated" is out '
for n in TRUTH:
    assert (P[n]["estimate"] is None) == (n in ("m_r", "N_r", "N_rr")), n
assert d["status"] == "ok" and d["delay_s"]["N"] is None and d["r2_validation"]["r"] is None
assert d["r2_validation"]["u"] > 0.98'
check "  and the report says why, and what to do" is out '
for n in TRUTH:
    left_out = n in ("m_r", "N_r", "N_rr")
    assert (P[n]["sigma"] is None) == (P[n]["sigma_told"] is None) == left_out, n
    assert n == "W-B" or P[n]["identifiable"] != left_out, n
    assert n == "W-B" or P[n]["note"] == ("no input column" if left_out else ""), n
assert d["missing"][0].startswith("yaw: unactuated") and len(d["missing"]) == 2'
change 'drop("Y_N")' <train.csv >no_sway.csv
check "its motion does not harm the others" \
    exits 0 fit no_sway.csv --plain --json --validate test.csv
check "  which are within 10 %, masses within 2 %" is out '
for n in TRUTH:
    assert (P[n]["estimate"] is None) == (n in ("m_v", "Y_v", "Y_vv")), n
    assert n in ("m_v", "Y_v", "Y_vv") or error(n) < (0.02 if n[0] == "m" else 0.1), (n, error(n))
assert min(d["r2_validation"][k] for k in "uwr") > 0.98, d["r2_validation"]'
change 'for y in r: y[C["u_mps"]] = y[C["v_mps"]] = y[C["w_mps"]] = 0' <train.csv >stuck.csv
check "a velocity that stands at zero while thrust acts" exits 0 fit stuck.csv --plain --json
check "  identifies only yaw" is out '
for n in TRUTH:
    known = n in ("m_r", "N_r", "N_rr")
    assert (P[n]["sigma"] is None) != known and (known or not P[n]["identifiable"]), n'
change 'for y in r: y[C["Y_N"]] = 5' <train.csv >constant.csv
check "a DoF with a constant input is not identified" exits 0 fit constant.csv --plain --json
check "  Y is ignored" is out 'assert P["m_v"]["estimate"] is None and d["r2_force"]["Y"] is None'
change 'for i, y in enumerate(r): y[C["Y_N"]] = 1e-13 * (i % 3)' <train.csv >dust.csv
check "nor is one whose input is rounding noise" exits 0 fit dust.csv --plain --json
check "  Y is ignored" is out 'assert P["m_v"]["estimate"] is None'
change 'drop("X_N", "Y_N", "Z_N", "K_Nm", "M_Nm"); drop("u_mps", "v_mps", "w_mps", "phi_rad")' \
    <train.csv >yaw.csv
check "yaw can be identified by itself" exits 0 fit yaw.csv --plain --json --coupling off
check "  and nothing else is" is out \
    'assert {n for n in TRUTH if P[n]["estimate"] is not None} == {"m_r", "N_r", "N_rr"}'
change 'for y in r: y[C["X_N"]] = y[C["Y_N"]] = y[C["Z_N"]] = y[C["N_Nm"]] = 0' <train.csv >rest.csv
check "nothing excited: exit 3" exits 3 fit rest.csv --plain --json
check "  and status not_excited" is out '
assert d["status"] == "not_excited" and all(p["estimate"] is None for p in d["parameters"])'
head -n 40 train.csv >short.csv
check "a log too short for one row: exit 3" exits 3 fit short.csv --plain --json
check "  and status not_excited" is out 'assert d["status"] == "not_excited"'
change 'r = r[::30]' <train.csv >sparse.csv
check "rows further apart than 0.5 s: exit 3" exits 3 fit sparse.csv --plain

change '
names = dict(X_N="cmd_surge", Y_N="cmd_sway", Z_N="cmd_heave", K_Nm="cmd_roll", M_Nm="cmd_pitch",
             N_Nm="cmd_yaw")
for y in r:
    for n in "XYZ": y[C[n + "_N"]] /= 200
    y[C["N_Nm"]] /= 200
h = [names.get(n, n) for n in h]' <train.csv >commands.csv
check "commands: parameters in units of command" exits 0 fit commands.csv --plain --json
check "  200 N per unit, with these units in the report" is out '
assert all(abs(200 * P[n]["estimate"] / TRUTH[n] - 1) < (0.02 if n[0] == "m" else 0.1)
           for n in TRUTH)
assert P["m_u"]["unit"] == "cmd s2/m" and P["W-B"]["unit"] == "cmd"'
check "thrusters of commands" rejects '--thrusters needs forces' \
    fit commands.csv --thrusters girona500
# another vehicle, which turns more slowly
sed 's/^N_r = .*/N_r = -200/; s/^N_rr = .*/N_rr = -900/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >other.ini
"$AUVID" demo --seed 7 --disturbance 1 --vehicle other.ini --csv other.csv >/dev/null 2>&1
check "a held-out log of another vehicle" exits 0 fit train.csv --plain --validate other.csv
check "  is not predicted, which the second line says" test "$(sed -n 2p out)" = \
    "does not predict the held-out log in yaw (R2 of the velocity below 0)"
check "one of this vehicle" exits 0 fit train.csv --plain --validate test.csv
check "  is" sh -c '! grep "does not predict" out'
# a vehicle that is loaded between two logs
sed 's/^W-B = .*/W-B = -5/; s/^m_u = .*/m_u = 330/; s/^X_uu = .*/X_uu = -250/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >loaded.ini
"$AUVID" demo --seed 5 --disturbance 1 --sets 8 --csv empty.csv >/dev/null
"$AUVID" demo --seed 6 --disturbance 1 --sets 8 --vehicle loaded.ini --csv full.csv >/dev/null 2>&1
check "two states of a vehicle in one fit" exits 0 fit empty.csv full.csv --vehicle girona500
check "  it says which part is in the estimate" \
    grep -Eq '^ +the vehicle changed: only what follows t_s [0-9.]+ of full.csv is in the est' out
check "  in JSON, too" exits 0 fit empty.csv full.csv --vehicle girona500 --json
check "  with the time in the log" is out '
c = d["log"]["changed"]
assert c["used_from_log"] == "full.csv" and 20 < c["used_from_t_s"] < 220'
check "one state" exits 0 fit empty.csv --vehicle girona500 --json
check "  has not changed" is out 'assert "changed" not in d["log"]'
check "training and test log must have the same kind of inputs" rejects 'test.csv:1:1: .*kind' \
    fit commands.csv --validate test.csv

check "--bias identifies constant forces too" exits 0 fit train.csv --plain --json --bias
check "  three more parameters, near zero" is out '
assert [p["name"] for p in d["parameters"]] == list(TRUTH) + ["X_0", "Y_0", "N_0"]
assert all(abs(P[n]["estimate"]) < 1.5 for n in ("X_0", "Y_0", "N_0"))'
change 'for y in r: y[C["X_N"]] -= 12' <train.csv >biased.csv
check "  a force of 12 N is found" exits 0 fit biased.csv --plain --json --bias
check "  in X_0" is out 'assert abs(P["X_0"]["estimate"] - 12) < 1.5, P["X_0"]'
check "--bounds hold" exits 0 fit train.csv --plain --json --bounds=-500,500
check "  m_w stops at its bound" is out 'assert abs(P["m_w"]["estimate"] - 500) < 1, P["m_w"]'
check "  and says so" is out 'assert [n for n in P if "at_bound" in P[n]] == ["m_w"]'
check "  names the bound and is not identifiable" is out '
assert "heave: m_w is at its upper bound of 500 kg: widen it" in d["missing"], d["missing"]
assert not P["m_w"]["identifiable"] and P["m_w"]["sigma"] is None'
check "another parameter that depends on a bound" \
    exits 0 fit train.csv --plain --json --bounds=-400,700
check "  is named with the bound" is out '
assert "sway: Y_vv at its bound also changes Y_v" in d["missing"], d["missing"]
assert P["Y_v"]["note"] == "depends on Y_vv, at its bound" and not P["Y_v"]["identifiable"]
assert error("Y_v") > 0.15 and P["m_v"]["identifiable"] and error("m_v") < 0.02'
check "with commands the message names the bound" \
    exits 0 fit commands.csv --plain --json --bounds=-500,3
check "  in units of command" is out '
assert "heave: m_w is at its upper bound of 3 cmd s2/m: widen it" in d["missing"], d["missing"]'
check "--bounds may be two words" exits 0 fit train.csv --plain --json --bounds -500,500
check "--coupling off: the model says so" exits 0 fit train.csv --plain --json --coupling off
check "  and is another" is out 'assert d["model"] == "Girona500, decoupled"'
check "--coupling auto selects the better prediction" is fit.json \
    'assert d["model"] == "Girona500, Eq. 12-15"'
check "--fix: a known parameter" exits 0 fit train.csv --plain --json --fix W-B=-37.3058 \
    --fix=X_u=-42
check "  is not identified, the others are" is out '
assert [n for n in TRUTH if n not in P] == ["W-B", "X_u"]
assert all(error(n) < (0.02 if n[0] == "m" else 0.1) for n in P)'
check "with uncertain inputs" exits 0 fit train.csv --vehicle girona500 --json \
    --fix X_uu=-125.3578
check "  the others are the same" is out '
assert "X_uu" not in P and P["m_u"]["identifiable"] and P["Z_ww"]["identifiable"]
assert all(error(n) < 0.06 for n in P if P[n]["identifiable"]), [(n, error(n)) for n in P]
assert all(abs(f["force"] / ((-42.4181 - 125.3578 * abs(f["speed"])) * f["speed"]) - 1) < 0.06
           for f in d["drag"]["X"]), d["drag"]["X"]'
check "--free: more parameters are identified" exits 0 fit biased.csv --plain --json --free X_0,Y_0
check "  a force of 12 N is found" is out '
assert list(P) == list(TRUTH) + ["X_0", "Y_0"] and abs(P["X_0"]["estimate"] - 12) < 1.5'

# ---- six degrees of freedom ----
"$AUVID" demo --vehicle bluerov2 --disturbance 0.2 --json --csv rov.csv >rov.json
"$AUVID" demo --vehicle bluerov2 --disturbance 0.2 --json --seed 2 --csv rov2.csv >/dev/null
ROV='T = {p["name"]: p["truth"] for p in json.load(open("rov.json"))["parameters"]}
off = {n: abs(P[n]["estimate"] - T[n]) for n in P if n in T}'
check "six degrees of freedom are identified" exits 0 fit rov.csv --plain --json --model bluerov2 \
    --validate rov2.csv
check "  identifiable parameters within four standard errors, masses within 3 %" is out "$ROV"'
assert list(P) == list(T) and sum(p["identifiable"] for p in d["parameters"]) >= 15
assert all(off[n] < 4 * P[n]["sigma"] for n in P if P[n]["identifiable"]), off
assert all(off[n] < 0.03 * T[n] for n in list(T)[:6]), off'
check "  another log is predicted" is out \
    'assert min(d["r2_validation"][k] for k in "uvwr") > 0.99, d["r2_validation"]'
cp out bluerov2.json
check "fossen is the same model without the settings of a fast vehicle" \
    exits 0 fit rov.csv --plain --json \
    --model fossen
check "  masses within 4 %" is out "$ROV"'
assert d["model"] == "Fossen, 6 DoF" and list(P) == list(T)
assert all(off[n] < 0.04 * T[n] for n in list(T)[:6]), off'
check "true zeros may be fixed" exits 0 fit rov.csv --plain --json --model bluerov2 --fix K_p=0 \
    --fix N_r=0 --fix Y_v=0
check "  which reduces the standard errors of the other drags" is out '
before = {p["name"]: p for p in json.load(open("bluerov2.json"))["parameters"]}
assert len(P) == 17
assert all(P[n]["sigma_told"] < 0.6 * before[n]["sigma_told"] for n in ("K_pp", "N_rr", "Y_vv"))'
change '
names = dict(X_N="cmd_surge", Y_N="cmd_sway", Z_N="cmd_heave", K_Nm="cmd_roll", M_Nm="cmd_pitch",
             N_Nm="cmd_yaw")
r = [y for y in r if 12 < y[0] < 52]
for y in r:
    for n in names: y[C[n]] /= 1e4
h = [names.get(n, n) for n in h]' <rov.csv >far.csv
for bounds in -1e5,1e5 -10,10; do
    check "a search in wide and narrow bounds, $bounds" exits 0 fit far.csv --plain --json \
        --model fossen "--bounds=$bounds"
    check "  ends at the minimum, in 121 evaluations or a few more" is out '
assert d["status"] == "ok" and min(d["r2_force"].values()) > 0.98, d["r2_force"]
assert 120 <= sum(d["evaluations"].values()) < 160, d["evaluations"]'
done
change 'drop("K_Nm")' <rov.csv >no_roll.csv
check "without its moment roll is not identified" \
    exits 0 fit no_roll.csv --plain --json --model bluerov2
check "  which is said" is out '
assert P["K_pp"]["note"] == "no input column" and P["K_pp"]["estimate"] is None
assert P["M_qq"]["estimate"] is not None and d["delay_s"]["K"] is None'
check "--bias: constant forces and moments except in heave" exits 0 fit rov.csv --plain --json \
    --model bluerov2 --bias
check "  near zero" is out '
names = ["X_0", "Y_0", "K_0", "M_0", "N_0"]
assert list(P)[20:] == names and all(abs(P[n]["estimate"]) < 0.3 for n in names)'

check "--literal works" exits 0 fit train.csv --plain --json --literal
check "  with larger errors" is out '
rms = lambda e: sum((e[n] / TRUTH[n] - 1) ** 2 for n in TRUTH)
mine = {n: P[n]["estimate"] for n in TRUTH}
default = {p["name"]: p["estimate"] for p in json.load(open("fit.json"))["parameters"]}
assert rms(mine) > 2 * rms(default) and set(d["delay_s"].values()) == {0}'
"$AUVID" demo --lag 0.15 --csv lag.csv >/dev/null 2>&1
check "a significant delay is used" exits 0 fit lag.csv --plain --json
check "  near 0.15 s" is out 'assert all(0.12 < x < 0.18 for x in d["delay_s"].values())'

change 'r = [y for y in r if y[0] < 32]' <train.csv >one_set.csv
check "half a minute does not identify everything" exits 0 fit one_set.csv --plain --json
check "  which the report says, with what is missing" is out '
unsure = [p for p in d["parameters"] if not p["identifiable"]]
assert 0 < len(unsure) < 13 and all(p["note"] for p in unsure) and len(d["missing"]) >= 1
assert all(error(p["name"]) < 0.2 for p in d["parameters"] if p["identifiable"])'
ln -s commands.csv same.csv
check "a training log validates nothing" exits 0 fit commands.csv --plain --validate same.csv
check "  which a warning says" grep -qx \
    'auvid: warning: same.csv: the estimate is from this log: this is no validation; .*' err
sed 2d commands.csv >other.csv
check "tables" exits 0 fit commands.csv --plain --validate other.csv
check "  no line is longer than 100 columns" awk 'length > 100 { exit 1 }' out
check "  name the unit of the parameters" grep -q 'units of command' out
check "  nothing on stderr" test ! -s err
# 800 kg with a time constant of 10 s, and velocity at 5 Hz with 6 cm/s of noise.
python3 - >ship.csv <<'END'
import random
random.seed(1)
print("t_s,u_mps,X_N")
u = thrust = until = 0
for k in range(100 * 900):
    t = k / 100
    if t >= until:
        thrust, until = random.choice([-150, -75, 0, 75, 150]), t + random.uniform(15, 45)
    if k % 20 == 0:
        print(f"{t:.2f},{random.gauss(u, 0.06):.4f},{thrust}")
    u += (thrust - 20 * u - 40 * u * abs(u)) / 800 / 100
END
check "a ship's log is identified" exits 0 fit ship.csv --plain --json
cp out ship.json
check "  with cells that suit it" is ship.json '
assert d["cell_s"] in (0.2, 0.4, 0.8) and d["r2_force"]["X"] > 0.95, (d["cell_s"], d["r2_force"])
assert abs(P["m_u"]["estimate"] / 800 - 1) < 0.05 and P["m_u"]["identifiable"], P["m_u"]'
check "  and the table says so" exits 0 fit ship.csv --plain
check "  in one sentence" grep -q "cells  *0.[248] s instead of 0.1 s: the vehicle is slow" out
python3 - >loop.csv <<'END'
# A controller that follows a speed, against a strong disturbance.
import random
random.seed(3)
print("t_s,u_mps,X_N,ref_surge")
u = force = wanted = smooth = total = thrust = until = 0
for k in range(50 * 1500):
    t = k / 50
    if k % 10 == 0:
        if t >= until:
            wanted, until = random.uniform(-1, 1), t + random.uniform(3, 15)
        smooth += 0.2 * (wanted - smooth)
        seen = random.gauss(u, 0.003)
        total += 10 * (smooth - seen)
        thrust = max(-300, min(300, 250 * (smooth - seen) + total))
        print(f"{t:.2f},{seen:.4f},{thrust:.3f},{smooth:.4f}")
    force += -force / 2 / 50 + 40 * random.gauss(0, 1) / 50**0.5
    u += (thrust + force - 120 * u) / 250 / 50
END
sed 's/ref_surge/other/' loop.csv >unreferred.csv
fix="--fix X_uu=0 --thrust-scale 0 --json"
check "a vehicle in closed loop is identified by its reference" exits 3 fit loop.csv $fix
check "  as it is" is out '
assert abs(P["m_u"]["estimate"] / 250 - 1) < 0.1 and abs(P["X_u"]["estimate"] / -120 - 1) < 0.1, P'
check "without it" exits 3 fit unreferred.csv $fix
check "  the closed loop is recognised: its mass is too small" is out '
assert P["m_u"]["note"] == "closed loop: the wrench is feedback", P["m_u"]
assert P["m_u"]["estimate"] < 0.9 * 250, P["m_u"]'

# Two propellers astern, none across. The residual of sway is no error of thrust, as there is none.
for seed in 1 2 3; do
    "$AUVID" demo --vehicle surface --seed $seed --disturbance 0.5 --lag 0.1 --csv craft-$seed.csv \
        >/dev/null 2>&1
    check "a surface craft" exits 0 fit craft-$seed.csv --vehicle surface --json
    check "  is not found too light" is out '
truth = {"m_u": 36, "m_v": 55, "m_r": 5.5, "X_uu": -15, "Y_vv": -80, "N_rr": -6}
errors = {n: P[n]["estimate"] / truth[n] - 1 for n in truth}
assert -0.1 < sum(errors.values()) / 6 < 0.1, errors
assert sum(p["identifiable"] for p in P.values()) >= 3, P'
done
check "a quick vehicle keeps its cells" is fit.json 'assert d["cell_s"] == 0.1'

finish
