#!/usr/bin/env bash
# auvid fit on two runs of a real BlueROV2 in a tank, each judged on the other. The data are not
# part of the project: AUVID_TANK_DATA names their directory, and make leaves this test out where
# there is none.
#
# The yardstick is least squares of the same equations, decoupled with bias, on the same data:
# v(t + 1 s) - v(t) on the integrals of command, v, |v| v and 1, simulated open loop on the other.
. "$(dirname "$0")/common.sh"
data=$(cd "$ROOT" && realpath -m "${AUVID_TANK_DATA:-../shared/data/bluerov2_tank}")

# within TRAIN TEST "U V W": 20 seeds, R2 of each velocity at least this.
within() {
    for seed in $(seq 20); do
        "$AUVID" fit "$data/$1.csv" --validate "$data/$2.csv" --bias --seed "$seed" --json \
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
    assert all(g >= l for g, l in zip(got, least)), (got, least)
    assert d["budget"]["worst"] <= d["budget"]["limit"]
    assert all(d["r2_interval"][k][0] < d["r2_validation"][k] < d["r2_interval"][k][1]
               for k in "uvw")
for k in "uvw":
    r2 = [d["r2_validation"][k] for d in runs]
    assert max(r2) - min(r2) < 1e-3, r2
END
}
check "run a predicts run b within 0.03 of least squares, 20 seeds" within run_a run_b \
    "0.956 0.946 0.908"
check "run b predicts run a within 0.03 of least squares, 20 seeds" within run_b run_a \
    "0.90 0.90 0.86"
finish
