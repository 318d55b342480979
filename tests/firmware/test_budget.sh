#!/usr/bin/env bash
# The costs of auvid_budget.c are those of instructions.csv, rounded up by 1 % at most, and no tick
# of the example takes more than they say for its budget of 150.
set -euo pipefail
cd "$(dirname "$0")/../.."
python3 - <<'END'
import csv
import re

number = {row[0]: float(row[1]) for row in csv.reader(open("tests/firmware/instructions.csv"))
          if row[0] != "key"}
cores = re.findall(r'= \{"(\w+)", (\d+), (\d+),', open("lib/src/identifier/auvid_budget.c").read())
for core, *cost in cores:
    step, report, take, work = (
        number[f"{core}-Os auvid_{name} most"]
        for name in ("node_step", "node_report", "node_take", "identifier_work"))
    measured = step + report + 16 * take, work / 150
    tick, unit = map(int, cost)
    good = all(m <= c <= 1.01 * m for c, m in zip((tick, unit), measured))
    good &= number[f"{core}-Os a tick: take step work report most"] <= tick + 150 * unit
    print(f"{'' if good else 'not '}ok {core}: {tick} and {unit} instructions; "
          f"measured {measured[0]:.0f} and {measured[1]:.0f}")
print(f"{'' if len(cores) == 6 else 'not '}ok six cores")
END
