#!/usr/bin/env bash
# auvid fit of several dives: more data must make an estimate better. What is left of the inputs'
# errors pulls along the common scale of thrust, masses and drag, in proportion to the rows, and
# only the priors hold that scale.
. "$(dirname "$0")/common.sh"

DIVES=6

# dives VEHICLE OPTIONS...: simulates them as VEHICLE_1.csv ..
dives() {
    local name=$1
    shift
    for ((k = 1; k <= DIVES; ++k)); do
        "$AUVID" demo --vehicle "$name" --seed "$k" "$@" --json --csv "${name}_$k.csv" >"$name.json"
    done
}
# Fits of the first dive and of all; CODE sees the parameters of both by name, and the truth.
compare() { # VEHICLE CODE
    "$AUVID" fit "${1}_1.csv" --vehicle "$1" --json >one.json &&
        "$AUVID" fit "${1}"_?.csv --vehicle "$1" --json >all.json && python3 -c "
import json
one, many, truth = ({p['name']: p for p in json.load(open(f))['parameters']}
                    for f in ('one.json', 'all.json', '$1.json'))
error = lambda fit, n: fit[n]['estimate'] / truth[n]['truth'] - 1
$2"
}

dives surface --lag 0.15
check "$DIVES dives of a surface craft: all parameters of one dive are identifiable" \
    compare surface 'assert all(p["identifiable"] for p in one.values()), one'
check "  so they are of all dives" \
    compare surface 'assert all(p["identifiable"] for p in many.values()), many'
check "  with half-widths that are not larger" compare surface '
for n in many: assert many[n]["half_width"] < 1.1 * one[n]["half_width"], many[n]'
dives bluerov2_standard --lag 0.15 --disturbance 0.6
check "$DIVES dives of an ROV, with a disturbance: masses within 12 %" compare bluerov2_standard '
for n in ("m_u", "m_v", "m_w", "m_r"): assert abs(error(many, n)) < 0.12, many[n]'
check "  what is identifiable is right" compare bluerov2_standard '
for n in many: assert not many[n]["identifiable"] or abs(error(many, n)) < 0.2, many[n]'
finish
