#!/usr/bin/env bash
# auvid fit on two runs of a real BlueROV2 in a tank, each validated on the other. The data are not
# part of the project: AUVID_TANK_DATA names their directory. Without it, make skips this test.
#
# The reference is least squares of the same equations, decoupled with bias, on the same data:
# v(t + 1 s) - v(t) on the integrals of command, v, |v| v and 1, simulated open loop on the other.
. "$(dirname "$0")/common.sh"
data=$(cd "$ROOT" && realpath -m "${AUVID_TANK_DATA:-../shared/data/bluerov2_tank}")

# within TRAIN TEST "U V W": 20 seeds, R2 of each velocity at least this.
within() {
    for seed in $(seq 20); do
        "$AUVID" fit "$data/$1.csv" --validate "$data/$2.csv" --bias --plain --seed "$seed" --json \
            >"$seed.json" || return 1
    done
    python3 - "$3" <<'END'
import json, sys
least = [float(x) - 0.03 for x in sys.argv[1].split()]
runs = [json.load(open("%d.json" % s)) for s in range(1, 21)]
for d in runs:
    got = [d["r2_validation"][k] for k in "uvw"]
    print(d["seed"], d["model"], got)
    assert d["status"] == "ok" and d["r2_validation"]["r"] is None
    assert d["not_modelled"] == ["roll", "pitch"]
    for p in d["parameters"]:
        yaw = p["name"] in ("m_r", "N_r", "N_rr", "N_0")
        assert (p["sigma"] is None) == yaw and bool(p["note"]) != p["identifiable"], p
        constant = p["name"] in ("W-B", "X_0", "Y_0")
        assert not p["identifiable"] or constant or 4 * p["sigma"] < 0.5 * abs(p["estimate"]), p
        assert not yaw or (not p["identifiable"] and p["note"] == "input is always zero"), p
    known = {p["name"] for p in d["parameters"] if p["identifiable"]}
    assert known and known <= {"m_u", "m_v", "m_w", "X_u", "X_uu", "Y_v", "Y_vv", "Z_w",
                               "W-B", "X_0", "Y_0"}, known
    assert any(s.startswith("yaw: unactuated") for s in d["missing"])
    assert all(g >= l for g, l in zip(got, least)), (got, least)
    assert d["budget"]["worst"] <= d["budget"]["limit"]
    assert all(d["r2_interval"][k][0] < d["r2_validation"][k] < d["r2_interval"][k][1]
               for k in "uvw")
for k in "uvw":
    r2 = [d["r2_validation"][k] for d in runs]
    assert max(r2) - min(r2) < 1e-3, r2
END
}
for run in run_a run_b; do
    check "the log doctor finds nothing wrong with $run" exits 0 check "$data/$run.csv"
    check "  its pose has other names" grep -q 'x_m resembles north_m, .* z_m resembles depth_m' err
    sed '1s/x_m,y_m,z_m/north_m,east_m,depth_m/' "$data/$run.csv" >pose.csv
    check "  with which it agrees with the velocity, too" exits 0 check pose.csv
    check "  without error or warning" sh -c '! grep -Eq "^  (error|warning)" out'
done
for test in run_a:run_b run_b:run_a; do
    "$AUVID" fit "$data/${test%:*}.csv" --validate "$data/${test#*:}.csv" --bias --plain \
        --map auto --json >"${test%:*}.map" 2>/dev/null
done
check "its commands give their force linearly: --map auto keeps it" python3 -c '
import json
for run in "run_a.map", "run_b.map":
    m = json.load(open(run))["map"]
    assert m["used"] == m["best"] == "linear" and m["tried"][1]["interval"][0] > 0, m'
check "run a predicts run b within 0.03 of least squares, 20 seeds" within run_a run_b \
    "0.956 0.946 0.908"
check "run b predicts run a within 0.03 of least squares, 20 seeds" within run_b run_a \
    "0.90 0.90 0.86"
finish
