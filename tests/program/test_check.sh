#!/usr/bin/env bash
# auvid check on a log of the demo and on 36 broken copies of it: the sentence for each, the exit
# status, and that fit prints the same. AUVID_TEST_LONG: does the verdict agree with what fit makes
# of a log?
. "$(dirname "$0")/common.sh"

"$AUVID" demo --json --sets 4 --seed 3 --disturbance 1 --csv whole.csv >/dev/null

python3 - <<'END'
import csv, math
rows = list(csv.reader(open("whole.csv")))
h, whole = rows[0], [[float(x) for x in y] for y in rows[1:]][::5]
C = {n: i for i, n in enumerate(h)}

def write(name, rows, head=None):
    with open(name + ".csv", "w") as out:
        out.write(",".join(head or h) + "\n")
        out.writelines(",".join("" if x is None else "%.9g" % x for x in y) + "\n" for y in rows)

def change(name, each):
    rows = [list(y) for y in whole]
    for k, y in enumerate(rows):
        each(k, y)
    write(name, rows)

def scale(factor, *names):
    def each(k, y):
        for n in names:
            y[C[n]] *= factor
    return each

def swap(a, b):
    def each(k, y):
        y[C[a]], y[C[b]] = y[C[b]], y[C[a]]
    return each

def late(by, *names):
    def each(k, y):
        for n in names:
            y[C[n]] = whole[max(k - by, 0)][C[n]]
    return each

def part(each):
    return lambda k, y: each(k, y) if k >= 2 * len(whole) // 3 else None

ATTITUDE, RATES, V = h[1:4], h[7:10], h[4:7]
write("clean", whole)
change("heading_degrees", scale(180 / math.pi, "psi_rad"))
change("rates_degrees", scale(180 / math.pi, *RATES))
change("rates_degrees_part", part(scale(180 / math.pi, *RATES)))
change("heading_reversed", scale(-1, "psi_rad"))
change("yaw_rate_reversed", scale(-1, "r_radps"))
change("moment_reversed", scale(-1, "N_Nm"))
change("sway_reversed", scale(-1, "v_mps"))
change("force_reversed", scale(-1, "Y_N"))
change("heave_reversed", scale(-1, "w_mps"))
change("forces_exchanged", swap("X_N", "Y_N"))
change("velocities_exchanged", swap("u_mps", "v_mps"))
change("rates_exchanged", swap("q_radps", "r_radps"))
change("attitude_enu", scale(-1, "theta_rad", "psi_rad"))
change("velocities_flu", scale(-1, "v_mps", "w_mps", "q_radps", "r_radps"))
change("attitude_late", late(4, *ATTITUDE))
change("motion_late", late(13, *(ATTITUDE + V + RATES)))
change("motion_early", late(7, *h[10:16]))
change("held", lambda k, y: [late(k % 4, n)(k, y) for n in V])
change("outage", lambda k, y: [late(k - 300, n)(k, y) for n in V] if 300 <= k < 400 else None)
change("millimetres", scale(1000, *V))
change("milliseconds", scale(1000, "t_s"))
change("marked", lambda k, y: scale(0, *V)(k, y) or [y.__setitem__(C[n], -999) for n in V]
       if k % 50 < 5 else None)
change("no_lock", lambda k, y: scale(0, *V)(k, y) if k % 50 < 5 else None)
change("outliers", lambda k, y: y.__setitem__(C["u_mps"], 25) if k in (700, 701) else None)
change("sway_zero", scale(0, "v_mps"))
change("attitude_zero", scale(0, *ATTITUDE))
change("coarse", lambda k, y: y.__setitem__(C["u_mps"], round(y[C["u_mps"]] / 0.3) * 0.3))
write("slow", whole[::12])
change("sway_mm", scale(1000, "v_mps"))
write("inputs_slow", [y[:10] + (y[10:16] if k % 6 == 0 else [None] * 6) + y[16:]
                      for k, y in enumerate(whole)])
write("short", whole[:80])
write("gap", whole[:400] + whole[450:])
write("sag", [y + [16.8 - 4 * k / len(whole)] for k, y in enumerate(whole)], h + ["voltage_V"])
for name, column in (("no_pitch", "theta_rad"), ("no_surge", "u_mps")):
    keep = [i for i, n in enumerate(h) if n != column]
    write(name, [[y[i] for i in keep] for y in whole], [h[i] for i in keep])
write("degree_names", whole, [n.replace("rad", "deg") for n in h])
top = [max(abs(y[i]) for y in whole) or 1 for i in range(16)]
pwm = {"X_N": "cmd_surge", "Y_N": "cmd_sway", "Z_N": "cmd_heave", "N_Nm": "cmd_yaw"}
keep = [i for i, n in enumerate(h) if n not in ("K_Nm", "M_Nm")]
write("pwm", [[round(1500 + 400 * y[i] / top[i]) if h[i] in pwm else y[i] for i in keep]
              for y in whole], [pwm.get(h[i], h[i]) for i in keep])
north = east = 0.0
place = []
for k, y in enumerate(whole):
    psi, u, v = (y[C[n]] for n in ("psi_rad", "u_mps", "v_mps"))
    step = y[0] - whole[max(k - 1, 0)][0]
    north += step * (u * math.cos(psi) - v * math.sin(psi))
    east += step * (u * math.sin(psi) + v * math.cos(psi))
    place.append([north, east])
with_place = h + ["north_m", "east_m"]
knots = [list(y) for y in whole]
world = [list(y) for y in whole]
biased = [list(y) for y in whole]
for y, turned, wrong in zip(knots, world, biased):
    psi, u, v = (y[C[n]] for n in ("psi_rad", "u_mps", "v_mps"))
    turned[C["u_mps"]] = u * math.cos(psi) - v * math.sin(psi)
    turned[C["v_mps"]] = u * math.sin(psi) + v * math.cos(psi)
    wrong[C["u_mps"]] += 0.1
    for n in V[:2]:
        y[C[n]] *= 1.9438
write("knots", [y + p for y, p in zip(knots, place)], with_place)
write("knots_alone", knots)
write("offset", [y + p for y, p in zip(biased, place)], with_place)
write("world", world)
change("kgf", scale(1 / 9.81, *h[10:16]))
xyzw = []
for y in whole:
    c, s = ([f(0.5 * y[C[n]]) for n in ATTITUDE] for f in (math.cos, math.sin))
    xyzw.append([y[0], s[0] * c[1] * c[2] - c[0] * s[1] * s[2], c[0] * s[1] * c[2] +
                 s[0] * c[1] * s[2], c[0] * c[1] * s[2] - s[0] * s[1] * c[2],
                 c[0] * c[1] * c[2] + s[0] * s[1] * s[2]] + y[4:])
write("quaternion", xyzw, h[:1] + ["qw", "qx", "qy", "qz"] + h[4:])
back = [list(y) for y in whole]
back[700][0] -= 5
write("time_back", back)
END

# says STATUS LOG SENTENCE: the status of auvid check, and a line of its output.
says() {
    local status=0
    "$AUVID" check "$2.csv" >said 2>&1 || status=$?
    cat said
    [ "$status" = "$1" ] && grep -Eq -- "$3" said
}

check "a good log is usable" says 0 clean '^usable for identification: surge, sway, heave, yaw$'
check "  with nothing but notes" test "$(grep -Ec '^  (error|warning)' said || true)" = 0
while read -r status log sentence; do
    check "$log" says "$status" "$log" "$sentence"
done <<'END'
1 heading_degrees error +psi_rad looks like degrees \(its rate is 57 times r_radps\): convert it to
1 rates_degrees error +r_radps looks like degrees per second \(57 times the rate of psi_rad\):
1 rates_degrees_part error +r_radps looks like degrees per second .*, from t_s [0-9]+ to [0-9]+:
1 heading_reversed error +psi_rad has the wrong sign: it changes against r_radps.*: change its sign
1 yaw_rate_reversed error +r_radps has the wrong sign: it runs against psi_rad and against its
1 moment_reversed error +N_Nm has the wrong sign: r_radps accelerates against it: change its sign
1 sway_reversed error +v_mps has the wrong sign: it accelerates against Y_N.*: change its sign
1 force_reversed error +Y_N has the wrong sign: v_mps accelerates against it: change its sign
1 heave_reversed error +w_mps accelerates against Z_N: one of them has the wrong sign: change it
1 forces_exchanged error +u_mps follows Y_N, and v_mps follows X_N: the two inputs are exchanged
1 velocities_exchanged error +u_mps follows Y_N, and v_mps follows X_N: the two velocities are
1 rates_exchanged error +theta_rad changes with r_radps, and psi_rad with q_radps: .* exchanged:
1 attitude_enu error .* as if the attitude were in ENU and FLU axes: change the signs of theta_rad
1 velocities_flu error +v_mps, w_mps and r_radps accelerate against their inputs, u_mps with its
0 attitude_late warning +the attitude trails p, q, r by 0\.4[0-9]* s: give each column the time
0 motion_late warning +the velocities follow their inputs by 1\.[2-6] s, .*; fit shifts the inputs
0 motion_early warning +the velocities change before their inputs by 0\.[5-9] s, .*; fit shifts the
0 held warning +the velocity repeats each value for about 0\.40 s, as if held .*: leave its cells
0 outage warning +u_mps, v_mps and w_mps keep their values for up to 9\.9 s .*: leave those rows out
1 millimetres error +u_mps reaches [0-9]+.* m/s, as if it were in mm/s or cm/s: convert it to m/s
1 milliseconds error +the rows are about [0-9]+.* s apart, as if t_s were in milliseconds: give
1 marked error +v_mps is -999 in [0-9]+ rows, a mark of missing samples: leave these cells empty
1 no_lock error +the velocities drop from motion to exactly 0 [0-9]+ times, .*: leave these cells
1 outliers error +u_mps jumps 2 times by up to 2[4-6].* m/s .*: leave cells of outliers empty
0 sway_zero warning +v_mps is always 0, but Y_N acts: both are left out: log the measured
1 attitude_zero error +the attitude never changes, but the rates do: log the measured attitude
0 coarse warning +u_mps has steps of 0\.3, coarse against its variation .*: log more digits
1 slow error +the rows are about 1\.[0-9]+ s apart, more than the 0\.5 s that fit bridges: log at 5
1 sway_mm error +v_mps reaches [0-9]+.* m/s, as if it were in mm/s or cm/s: convert it to m/s
1 inputs_slow warning +X_N comes every 0\.[56][0-9]* s on average, .*: log inputs at 5
1 no_surge error +u_mps is missing, but X_N is there: fit needs both: add the velocity, or leave
1 short error +too little motion: .*: excite each axis for a minute or more
0 gap note +1 gap over 0\.5 s, the longest of 5\.[0-9] s after t_s [0-9.]+: each one ends a record
0 sag warning +voltage_V falls from 16\.8 to 12\.8: .*: log the thrust computed with the voltage
0 no_pitch warning +theta_rad is missing and counts as zero: .*: add the column
1 degree_names error +r_radps is missing, but N_Nm is there: .*: make it of r_degps, which is in deg
1 degree_names warning +phi_rad is missing and counts as zero: .*: make it of phi_deg, which is in
1 pwm error +cmd_surge looks like pulse widths in microseconds \(1100 to 1900\): subtract .* divide
1 knots error +u_mps, v_mps: 1\.94 times the rates of north_m and east_m, as if in knots: multiply
1 world error +u_mps and v_mps look like velocities to the north and east: .*: turn them into body
1 quaternion error +qw, qx, qy, qz look like x, y, z, w: .*: name the columns qx, qy, qz, qw
0 offset warning +u_mps has an offset of \+0\.10[0-9] m/s against the rates of north_m and east_m:
2 time_back time_back.csv:702:[0-9]+: t_s: '[0-9.]+' goes back by more than a second: split
END

sed "s/^model = .*/&\ndry_mass_kg = 200/" "$ROOT/tools/auvid/vehicles/girona500.ini" >dry.ini
check "forces in kgf, if the dry mass is known" exits 1 check kgf.csv --vehicle dry.ini
check "  are named" grep -Eq 'X_N, Y_N, .* look like kilograms-force .*: multiply them by 9\.81' out
check "  by fit, too" sh -c "'$AUVID' fit kgf.csv --plain --dry-mass 200 2>&1 |
    grep -q 'kgf.csv: X_N, Y_N, Z_N and the moments look like kilograms-force'"
check "velocities in knots without position" exits 0 check knots_alone.csv --vehicle dry.ini
check "  may be the cause of a small mass" grep -q 'if u_mps and v_mps are in knots, multiply' out
check "forces in newtons are not accused" exits 0 check clean.csv --vehicle dry.ini
check "  indeed" test "$(grep -Ec '^  (error|warning)' out || true)" = 0
check "as JSON" says 1 heading_degrees .
"$AUVID" check heading_degrees.csv --json >out.json
check "  with code, column and verdict" python3 -c '
import json
d = json.load(open("out.json"))
f = d["findings"][0]
assert not d["usable"] and d["verdict"].startswith("not usable")
assert (f["severity"], f["code"], f["column"]) == ("error", "angle_degrees", "psi_rad"), f
assert "degrees" in f["sentence"] and d["usable_motion_s"]["surge"] > 60'
# decodes COMMAND...: its output is UTF-8 and JSON.
decodes() {
    "$@" | python3 -c 'import json, sys; json.loads(sys.stdin.buffer.read().decode())'
}
cp clean.csv $'\xff\xed\xa0\x80\xf4\x90\x80\x80.csv'
cp whole.csv $'\xe0\x80\x80.csv'
LC_ALL=C sed 's/^title = .*/title = Caf\xe9 500/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >latin.ini
check "JSON of a file whose name is no UTF-8" decodes "$AUVID" check --json \
    $'\xff\xed\xa0\x80\xf4\x90\x80\x80.csv'
check "  of fit" decodes "$AUVID" fit --json --plain $'\xe0\x80\x80.csv'
check "  of a vehicle whose title is Latin-1" decodes "$AUVID" check --json latin.ini

check "fit prints errors before its result" exits 3 fit moment_reversed.csv --plain --json
check "  on stderr" grep -q 'moment_reversed.csv: N_Nm has the wrong sign' err
check "  and identifies nothing from such a log, though motion would do" python3 -c '
import json
text = open("out").read()
assert "\"identifiable\": true" not in text
d = json.loads(text)
assert {p["note"] for p in d["parameters"]} == {"the log has an error"}
assert d["verdict"].startswith("nothing identified: N_Nm has the wrong sign"), d["verdict"]'
check "fit names slow inputs" exits 3 fit inputs_slow.csv --plain
check "  and not the length of the log" grep -q 'the log: inputs are up to 0.60 s apart, 0.5' out
check "  which a longer gap bridges" exits 0 fit inputs_slow.csv --plain --max-gap 0.7
check "fit refuses mm/s" rejects 'v_mps reaches [0-9.]+ m/s, as if it were in mm/s' \
    fit sway_mm.csv --plain
check "fit refuses a mark" rejects 'u_mps is -999 in [0-9]+ rows, a mark' fit marked.csv --plain
check "fit asks for no motion while the log is wrong" exits 3 fit force_reversed.csv
check "  its first line says what is" grep -q '^nothing identified: Y_N has the wrong sign' out
check "  and nothing else is missing" test "$(sed -n '/^  missing/,/^$/p' out | wc -l)" = 3
check "a vehicle without its thrusters' inputs" exits 0 check clean.csv --vehicle girona500
check "  is examined with forces" grep -q 'no columns thruster_1 ..: forces and moments are' err
check "fit prints nothing of a good log" exits 0 fit clean.csv --plain
check "  indeed" test ! -s err
sed 's/^roll_Nm = .*//; s/^pitch_Nm = .*//' "$ROOT/tools/auvid/vehicles/bluerov2.ini" >held.ini
"$AUVID" demo --vehicle held.ini --sets 4 --disturbance 0.5 --seed 6 --csv rov.csv --json >rov.json
check "a small vehicle that a controller holds upright against disturbances" exits 0 check rov.csv
check "  is not accused of wrong signs" sh -c '! grep -q "error" out'

check "no log" refuses 'check: no LOG.csv or FILE.ini given' check
check "no such log" refuses 'missing.csv: No such file' check missing.csv
check "unknown option" refuses 'check: unknown option --yes' check clean.csv --yes

tank=$(cd "$ROOT" && realpath -m "${AUVID_TANK_DATA:-../shared/data/bluerov2_tank}")
for run in a b; do
    if [ -e "$tank/run_$run.csv" ]; then
        cp "$tank/run_$run.csv" "tank_$run.csv"
        check "real run $run is usable, without false error" says 0 "tank_$run" \
            '^usable for identification: surge, sway, heave$'
    fi
done
finish
