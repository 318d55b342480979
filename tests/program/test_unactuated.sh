#!/usr/bin/env bash
# Two propellers astern and a vertical one: nothing moves the sway. A current of 8 cm/s, which is
# within its prior, must neither shrink the other masses nor make all inputs suspect.
. "$(dirname "$0")/common.sh"

awk '/^```ini/ { on = 1; next } /^```/ { if (on) exit } on' \
    "$ROOT/tools/auvid/README.md" >minnow.ini
drifts() { # SEED: the log of a dive in the current
    "$AUVID" demo --vehicle minnow.ini --lag 0.15 --disturbance 0.2 --seed "$1" \
        --csv still.csv >out 2>&1
    awk -F, -v OFS=, 'NR > 1 && $5 != "" { $5 += 0.06 * cos($4) + 0.05 * sin($4) }
        NR > 1 && $6 != "" { $6 += 0.05 * cos($4) - 0.06 * sin($4) } { print }' still.csv
}
for seed in 1 2 3 4 5 6; do
    drifts "$seed" >"log$seed.csv"
    "$AUVID" fit "log$seed.csv" --vehicle minnow.ini --json >"on$seed.json" 2>err
    "$AUVID" fit "log$seed.csv" --vehicle minnow.ini --coupling off --json >"off$seed.json" 2>err
done
all='
import json
def runs(name): return [json.load(open(f"{name}{seed}.json")) for seed in range(1, 7)]
def values(d): return {p["name"]: p for p in d["parameters"]}
'
check "masses are at most 20 % too small on average" python3 -c "$all
error = [values(d)[name]['estimate'] / truth - 1 for d in runs('on')
         for name, truth in (('m_u', 5), ('m_w', 10))]
assert -0.2 < sum(error) / len(error) < 0.2, error"
check "the errors of the inputs are within 1.5 times their priors in the median" python3 -c "$all
scale = sorted(d['assumed'].get('over_priors', 9) for d in runs('on'))
assert (scale[2] + scale[3]) / 2 < 1.5, scale"
check "a decoupled sway says nothing of W-B, which stays within its half-width" python3 -c "$all
trim = [values(d)['W-B'] for d in runs('off')]
assert all(abs(p['estimate'] + 0.5) < p['half_width'] and p['estimate'] < -0.2 for p in trim), trim"

# a drag that drives the sway, which only the coupling with surge and yaw moves
sed 's/^Y_v = -30/Y_v = 20/; s/^Y_vv = -80/Y_vv = -150/' \
    "$ROOT/tools/auvid/vehicles/surface.ini" >driven.ini
check "a craft whose sway has an impossible drag" exits 0 demo --vehicle driven.ini --csv driven.csv
check "  its log" exits 0 fit driven.csv --vehicle driven.ini --json
check "    no number of that equation is identifiable, all others are" is out '
assert P["Y_v"]["estimate"] > 10, P["Y_v"]
assert [n for n in P if not P[n]["identifiable"]] == ["m_v", "Y_v", "Y_vv"], P'
exit "$failed"
