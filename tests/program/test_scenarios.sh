#!/usr/bin/env bash
# auvid demo --scenario: the events of each scenario, its exit status, its JSON, and that a second
# run prints the same.
. "$(dirname "$0")/common.sh"

# tells NAME PATTERN...: NAME.txt contains these lines, in this order.
tells() {
    python3 - "$@" <<'END'
import re, sys
lines = open(sys.argv[1] + ".txt").read().split("\n")
at = 0
for pattern in sys.argv[2:]:
    found = [k for k in range(at, len(lines)) if re.search(pattern, lines[k])]
    assert found, (pattern, lines[at:])
    at = found[0] + 1
END
}

for name in payload heave-idle operator-abort current dvl-lost; do
    check "$name: exit 0" exits 0 demo --scenario "$name"
    cp out "$name.txt"
    check "$name: nothing on stderr" test ! -s err
    check "$name: no line is longer than 100 columns" awk 'length > 100 { exit 1 }' out
    exits 0 demo --scenario "$name"
    check "$name: a second run prints the same" cmp out "$name.txt"
    check "$name: --json" exits 0 demo --scenario "$name" --json
    cp out "$name.json"
    check "$name: is JSON" python3 -m json.tool out /dev/null
    exits 0 demo --scenario "$name" --json
    check "$name: the same JSON again" cmp out "$name.json"
    # the events in JSON are those in the text
    check "$name: has the same events in both" python3 - "$name" <<'END'
import json, sys
d = json.load(open(sys.argv[1] + ".json"))
events = ["  %7.2f s  %s" % (line["t_s"], line["text"]) for line in d["events"]]
text = open(sys.argv[1] + ".txt").read().split("\n")
assert d["scenario"] == sys.argv[1] and events and [l for l in text if l in events] == events
times = [line["t_s"] for line in d["events"]]
assert sys.argv[1] == "current" or times == sorted(times)
END
    check "$name: another seed" exits 0 demo --scenario "$name" --seed 2
    check "  ends the same way" test "$(tail -n 3 out | cut -c 1-12)" = \
        "$(tail -n 3 "$name.txt" | cut -c 1-12)"
done

check "payload: set 9 is predicted badly, older sets are dropped, a new search" tells payload \
    '250.00 s  PAYLOAD ABOARD' 'set 9, predicted' 'THE VEHICLE HAS CHANGED' 'estimate 16'
check "  against the new truth, all but W-B identifiable, rms below 5 %" is payload.json '
new = {n: TRUTH[n] * (1 if n == "W-B" else 1.1 if n[0] == "m" else 1.3) for n in TRUTH}
assert all(abs(P[n]["truth"] / new[n] - 1) < 1e-5 for n in TRUTH)
assert all(P[n]["identifiable"] for n in TRUTH if n != "W-B")
rms = (sum((P[n]["estimate"] / new[n] - 1) ** 2 for n in TRUTH) / 13) ** 0.5
assert rms < 0.05, rms
assert d["guard"]["state"] == "done" and d["change_test"]["changed"] == []'
check "  no other change is reported" test "$(grep -c CHANGED payload.txt)" = 1

check "heave-idle: says what is missing" tells heave-idle 'missing: heave: unactuated, and' \
    'm_w .* - .*\? unactuated' 'Z_w .*\? un' 'Z_ww .*\? un' '^  missing' \
    '^    heave: unactuated'
check "  heave null, the others there" is heave-idle.json '
for n in TRUTH:
    idle = n in ("m_w", "W-B", "Z_w", "Z_ww")
    assert (P[n]["estimate"] is None) == (P[n]["sigma"] is None) == idle
    assert P[n]["identifiable"] == (not idle) and (idle or error(n) < 0.1), (n, P[n])
assert len(d["missing"]) == 1 and d["change_test"]["variance_ratio"]["Z"] is None'

zero='in this tick: X 0.0, Y 0.0, Z 0.0 N, N 0.0 Nm'
check "operator-abort: zero in the next tick, latched, the estimate is kept" tells operator-abort \
    'estimate 2' '100.00 s  operator: abort' '100.02 s  guard: ABORTED: aborted by the operator' \
    '100.02 s .*in the previous tick: X -?[1-9]' "100.02 s .*$zero" 'latched: .* is refused' \
    'largest excitation since the abort: 0.0; estimate 3 is kept' 'guard  aborted at 100.00 s'
check "  in JSON too" is operator-abort.json '
assert d["guard"]["state"] == "aborted" and d["guard"]["cause"] == "aborted by the operator"
assert d["status"] == "ok" and max(error(n) for n in TRUTH) < 0.15'

check "dvl-lost: aborted a second later, with its cause" tells dvl-lost 'estimate 2' \
    '100.00 s  the DVL is lost' '101.0. s  guard: ABORTED: no velocity over ground, 1.0. s' \
    '101.0. s .*in the previous tick: X -?[1-9]' "101.0. s .*$zero" 'latched' 'estimate 3 is kept' \
    'guard  aborted at 101.0. s: no velocity'
check "  in JSON too" is dvl-lost.json '
g = d["guard"]
assert g["cause"] == "no velocity over ground" and g["limit"] == 1 and 1 < g["value"] < 1.3
assert 101 < g["t_s"] < 101.3 and d["status"] == "ok"'

check "current: from bottom lock, then from water lock" tells current 'DYNAMICS FROM BOTTOM LOCK' \
    'largest error by standard error: .* farthest from start' 'DYNAMICS FROM WATER LOCK' \
    'largest error by standard error: .* from start' '^  from bottom lock' '^  from water lock'
searched=$(sed -n 's/.*current identified too: rms error \([0-9.]*\) %; north 0.\(..\).*/\1 \2/p' \
    current.txt)
check "  the current identified too: below 5 %, and 0.3 m/s" awk -v said="$searched" \
    'BEGIN { split(said, s, " "); exit !(s[1] > 0 && s[1] < 5 && s[2] >= 29 && s[2] <= 31) }'
check "  the first has large errors and few flags, the second is right" is current.json '
bottom = {p["name"]: p for p in d["bottom_lock"]["parameters"]}
assert d["bottom_lock"]["rms_percent"] > 50
assert sum(p["identifiable"] for p in bottom.values()) <= 6
assert all(P[n]["identifiable"] for n in TRUTH if n != "W-B")
assert max(error(n) for n in TRUTH) < 0.15'

check "a disturbance may be chosen" exits 0 demo --scenario heave-idle --disturbance 0 --json
check "  without one the estimate is better" is out '
rms = lambda d: sum((p["estimate"] / p["truth"] - 1) ** 2 for p in d["parameters"] if p["estimate"])
assert rms(d) < rms(json.load(open("heave-idle.json")))'
check "an unexpected outcome: exit 1" exits 1 demo --scenario payload --disturbance 500
finish
