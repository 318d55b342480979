#!/usr/bin/env bash
# Calibration dives: a vehicle file with a known force, the column weight_N, and the advice of
# auvid check. The log's thrust is made 20 % too strong, as a wrong data sheet tells it.
# Long form (AUVID_TEST_LONG): 50 dives instead of one.
. "$(dirname "$0")/common.sh"

weight() { # FROM TO FILE [NEWTONS]: Girona500 with a weight
    cp "$ROOT/tools/auvid/vehicles/girona500.ini" "$3"
    printf '\n[calibration.1]\nweight_N = %s\nfrom_s = %s\nto_s = %s\n' "${4:-20}" "$1" "$2" >>"$3"
}
too_strong() { # the thrust of a log; with a column weight_N, if the times of the weight are given
    awk -F, -v OFS=, -v from="${1:-}" -v to="${2:-}" '
        NR > 1 { for (i = 11; i <= 16; ++i) $i *= 1.2 }
        from == "" { print; next }
        { print $0, (NR == 1 ? "weight_N" : $1 >= from && $1 < to ? 20 : 0) }'
}
weight 90 150 dive.ini
weight 90 150 up.ini -20

# ---- the figure ----
dives=1
[ -z "${AUVID_TEST_LONG:-}" ] || dives=50
for seed in $(seq 1 $dives); do
    "$AUVID" demo --vehicle dive.ini --seed "$seed" --disturbance 1 --csv log.csv --json >demo.json
    too_strong <log.csv >"strong$seed.csv"
    check "seed $seed: W-B and m_w within 8 %" \
        exits 0 fit "strong$seed.csv" --vehicle dive.ini --json
    check "  indeed" is out '
assert error("W-B") < 0.08 and error("m_w") < 0.08, (error("W-B"), error("m_w"))
assert P["m_w"]["identifiable"] and P["k_tau"]["identifiable"] and 1.06 < P["k_tau"]["estimate"]
assert "weaker than supplied" in d["thrust"], d["thrust"]'
done
check "the demo identifies its own vehicle" is demo.json '
assert error("m_w") < 0.08 and abs(P["k_tau"]["estimate"] - 1) < 0.08, P["k_tau"]
assert P["k_tau"]["truth"] == 1 and d["thrust"].startswith("the known force "), d["thrust"]'
exits 1 fit strong1.csv --vehicle girona500 --json >/dev/null
check "without the known force m_w is 15 to 25 % too large" is out '
assert 0.15 < P["m_w"]["estimate"] / TRUTH["m_w"] - 1 < 0.25 and "thrust" not in d, P["m_w"]'
awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "N_Nm") at = i }
    NR > 1 { $at = -$at } { print }' strong1.csv >reversed.csv
check "a known force makes nothing of a wrong log identifiable" \
    exits 3 fit reversed.csv --vehicle dive.ini --json
check "  nor any drag force" sh -c '! grep -q "\"identifiable\": true" out'

# ---- the dry mass is in SI, like the weight ----
"$AUVID" demo --vehicle dive.ini --seed 1 --disturbance 1 --csv log.csv --json >demo.json
awk -F, -v OFS=, 'NR > 1 { for (i = 11; i <= 16; ++i) $i *= 0.5 } { print }' log.csv >half.csv
sed 's/^model = .*/&\ndry_mass_kg = 240/' dive.ini >dry.ini
check "thrust told half as strong, with the dry mass" exits 0 fit half.csv --vehicle dry.ini --json
check "  makes no mass impossible" is out '
assert error("m_w") < 0.08 and P["m_w"]["identifiable"], P["m_w"]
assert "so much is rare" in d["thrust"], d["thrust"]'
sed 's/^weight_N = .*/weight_N = 10/' dry.ini >kilograms.ini
check "a weight given as half of it" exits 3 fit log.csv --vehicle kilograms.ini --json
check "  contradicts the dry mass" is out '
assert d["thrust"].startswith("the known force contradicts"), d["thrust"]'

# ---- the column of the log ----
exits 0 fit strong1.csv --vehicle dive.ini --json >/dev/null
cp out file.json
"$AUVID" demo --vehicle dive.ini --seed 1 --disturbance 1 --csv log.csv --json >demo.json
too_strong 90 150 <log.csv >column.csv
check "weight_N in the log" exits 0 fit column.csv --vehicle girona500 --json
check "  gives the same bits as the vehicle file" same_result file.json
check "  of a held-out log, too" \
    exits 0 fit column.csv --vehicle girona500 --validate column.csv --json
check "  which is predicted in units of the supplied thrust" is out '
assert min(d["r2_validation"].values()) > 0.99, d["r2_validation"]'
too_strong <log.csv >without.csv
exits 0 fit column.csv --vehicle girona500 --validate without.csv --json >/dev/null
check "  but not without its weight" is out 'assert d["r2_validation"]["w"] < 0.95, d'

# ---- several logs ----
sed 's/^to_s.*/&\nlog = strong1.csv/' dive.ini >named.ini
"$AUVID" demo --seed 2 --disturbance 1 --csv log.csv >demo.out 2>&1
too_strong <log.csv >second.csv
check "a weight in the second log only" \
    exits 0 fit second.csv strong1.csv --vehicle named.ini --json
check "  calibrates" is out 'assert error("W-B") < 0.08 and error("m_w") < 0.08, P["k_tau"]'
check "  nothing to say of its name" sh -c '! grep calibration err'
cp out both.json
check "  the same of a column" exits 0 fit second.csv column.csv --vehicle girona500 --json
check "  to the same bits" same_result both.json
check "a weight that names no log" exits 3 fit second.csv strong1.csv --vehicle dive.ini --json
check "  contradicts the motion in the wrong one" is out '
assert d["thrust"].startswith("the known force contradicts the motion"), d["thrust"]'
check "  acts in the first one, and fit says so" grep -q \
    '^auvid: \[calibration\.1\] of the vehicle file acts in the first log, second.csv' err
check "a weight of another log" exits 0 fit second.csv --vehicle named.ini --json
check "  has no effect, and fit says so" grep -q \
    '^auvid: \[calibration\.1\] of the vehicle file is of strong1.csv, which is not fitted' err
weight 900 950 outside.ini
check "a weight at no time of the log" rejects \
    'strong1.csv: \[calibration\.1\] of the vehicle file is from 900 to 950 s, this log from 0.2' \
    fit strong1.csv --vehicle outside.ini
awk -F, -v OFS=, '{ for (i = 1; i <= 5; ++i) $(NF + 1) = NR == 1 ? "thruster_" i "_N" : sin(NR / i)
                    print }' strong1.csv >thrusters.csv
check "  or of a log that is checked" refuses \
    'thrusters.csv: \[calibration\.1\] of the vehicle file is from 900 to 950 s, this log' \
    check thrusters.csv --vehicle outside.ini

# ---- on a bus: the same file, times from the first tick ----
check "the node identifies its own vehicle" \
    exits 0 node --bus memory --excite --vehicle dive.ini --log run.log --json
check "  with the supplied thrust" is out '
assert error("m_w") < 0.08 and abs(P["k_tau"]["estimate"] - 1) < 0.08, P["k_tau"]
assert P["k_tau"]["truth"] == 1 and d["thrust"].startswith("the known force agrees"), d["thrust"]'
cp out node.json
check "a replay finds the same" exits 0 replay run.log --vehicle dive.ini --json
check "  to the last digit" is out '
n = json.load(open("node.json"))
assert d["thrust"] == n["thrust"]
assert [p["estimate"] for p in d["parameters"]] == [p["estimate"] for p in n["parameters"]]'
# frames carry thrust as a part of the largest force
sed -E 's/^((for|back)ward_N = )[0-9.]+/\1184.56/' dive.ini >strong.ini
grep -Ev ' (40C|40D|413|414)#' run.log >without.log
check "thrust told 20 % too strong" \
    exits 0 replay without.log --vehicle strong.ini --csv run.csv --json
check "  is found from frames: W-B and m_w within 8 %" is out '
assert error("W-B") < 0.08 and error("m_w") < 0.08, (error("W-B"), error("m_w"))
assert abs(P["k_tau"]["estimate"] / 1.2 - 1) < 0.08, P["k_tau"]'
check "a weight at no time of the replay" exits 1 replay run.log --vehicle outside.ini
check "  is told" grep -q 'warning: run.log: \[calibration.1\] of the vehicle file is from 900' err
check "fit of the motion finds it, too" exits 0 fit run.csv --vehicle strong.ini --json
check "  at the same times" is out '
assert error("W-B") < 0.08 and error("m_w") < 0.08, (error("W-B"), error("m_w"))'

# ---- what does not calibrate ----
weight -1 1e6 always.ini
for seed in 1 2 3 4; do
    "$AUVID" demo --vehicle dive.ini --seed "$seed" --disturbance 1 --csv log.csv --json >demo.json
    too_strong <log.csv >strong.csv
    check "seed $seed: a weight that never changes" exits 0 fit strong.csv --vehicle always.ini
    check "  does not show the thrust" \
        grep -q 'known force does not show the scale of the thrust' out
done
check "a weight that pulls up" exits 3 fit strong1.csv --vehicle up.ini
check "  contradicts the motion" grep -q 'contradicts the motion (k_tau -' out
check "  says the first line" grep -q '^nothing identified: the known force contradicts the' out
check "  is the only thing to correct" test "$(sed -n '/^  missing/,/^$/p' out)" = \
    "$(printf '  missing\n    the known force: check its sign, size and time first')"
exits 3 fit strong1.csv --vehicle up.ini --json
check "  is the note of all parameters that it makes uncertain" is out '
assert {p["note"] for p in d["parameters"]} == {"the known force contradicts the motion"}, P'
check "weight twice" rejects 'known twice: by weight_N and by \[calibration.1\]' \
    fit column.csv --vehicle dive.ini
sed '1s/X_N,Y_N,Z_N,K_Nm,M_Nm,N_Nm/cmd_surge,cmd_sway,cmd_heave,cmd_roll,cmd_pitch,cmd_yaw/' \
    column.csv >commands.csv
check "commands without gain" rejects 'a known force needs thrust in newtons: give --gain' \
    fit commands.csv
check "literal smoothing" rejects 'literal has no known force: remove weight_N' \
    fit column.csv --literal
check "  nor in the demo" refuses 'literal has no known force: remove \[calibration.1\]' \
    demo --vehicle dive.ini --literal

# ---- the vehicle file ----
bad() { # NAME SED PATTERN
    sed -E "$2" dive.ini >bad.ini
    check "$1" refuses "bad\.ini:[0-9]+:[0-9]+: $3" check bad.ini
}
bad "no force" '/^weight_N/d' '\[calibration\.1\] has no force: add weight_N, pull_N or'
bad "an end before its begin" 's/^to_s = .*/to_s = 80/' 'to_s must be later than from_s'
bad "no begin" '/^from_s/d' "\[calibration\.1\] has no key 'from_s': add it"
bad "the second without the first" 's/calibration\.1/calibration.2/' \
    '\[calibration\.2\]: there is no \[calibration\.1\]'
bad "too many" 's/calibration\.1/calibration.5/' 'unknown section \[calibration\.5\]; known: '
bad "an overlap" '$a [calibration.2]\npull_N = 1 0 0\nfrom_s = 140' \
    'from_s must not be before the calibration above has ended'
"$AUVID" check dive.ini --header >dive.h
check "the header says how firmware tells it" grep -q 'auvid_calibrated_force of estimate.h' dive.h
check "--json has it" exits 0 check dive.ini --json
check "  as in the file" python3 -c '
import json
c = json.load(open("out"))["calibrations"]
assert len(c) == 1 and c[0]["weight_N"] == 20 and c[0]["from_s"] == 90 and c[0]["to_s"] == 150, c'

# ---- the advice ----
for name in bluerov2 torpedo; do
    check "$name: advice" exits 0 check "$name"
    check "  a known force halves the error, nearly" python3 -c '
import re
text = open("out").read()
now = float(re.search(r"standard error of \S+, now ([\d.]+) %", text)[1])
after = dict((b, float(a)) for a, b in re.findall(r"^ +([\d.]+) %  (.*)$", text, re.M))
known = next(v for k, v in after.items() if "for 60 s" in k)
assert len(after) == 2 and known < 0.62 * now and known == min(after.values()), (now, after)
assert all(v <= now for v in after.values()), (now, after)'
done
finish
