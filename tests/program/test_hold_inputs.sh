#!/usr/bin/env bash
# A log that has its inputs only where they change.
. "$(dirname "$0")/common.sh"

"$AUVID" demo --sets 2 --csv whole.csv --json >whole.json
python3 - <<'EOF'
rows = [line.rstrip("\n").split(",") for line in open("whole.csv") if line[0] != "#"]
inputs = [k for k, name in enumerate(rows[0]) if name[1:] in ("_N", "_Nm")]
filled, changed = [rows[0]], [rows[0]]
for n, row in enumerate(rows[1:]):
    if n % 60 == 0:
        held = [row[k] for k in inputs]
    for k, value in zip(inputs, held):
        row[k] = value
    filled.append(row)
    changed.append([v if k not in inputs or n % 60 == 0 else "" for k, v in enumerate(row)])
for name, all in ("filled", filled), ("changed", changed), ("late", [changed[0]] + changed[100:]):
    open(name + ".csv", "w").write("".join(",".join(row) + "\n" for row in all))
EOF
check "such a log is not usable as it is" exits 1 check changed.csv
check "  its verdict" grep -q '^not usable .* as it is: the inputs are too far apart' out
check "  and the remedy" grep -q 'or give --hold-inputs if the log has them only where they' out
check "fit identifies nothing" exits 3 fit changed.csv --plain
check "  and says what to do" grep -q 'the log: inputs are up to .* or give --hold-inputs if' out
check "  not what does not help" sh -c '! grep -q max-gap out'
"$AUVID" fit filled.csv --plain --json >filled.json 2>err
"$AUVID" check filled.csv --json >filled.check
check "with held inputs check prints the same as of a filled log" sh -c \
    '"$1" check changed.csv --hold-inputs --json | sed s/changed/filled/ | diff - filled.check' \
    - "$AUVID"
check "and fit the same" sh -c \
    '"$1" fit changed.csv --plain --hold-inputs --json | sed s/changed/filled/ |
    diff - filled.json' - "$AUVID"
check "nothing is held before the first input" exits 0 fit late.csv --plain --hold-inputs
check "no vehicle has inputs" refuses 'check: --hold-inputs is for a log, but girona500 is' \
    check girona500 --hold-inputs
check "it takes no value" refuses -- '--hold-inputs takes no value' fit x.csv --hold-inputs=yes
finish
