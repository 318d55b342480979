#!/usr/bin/env bash
# What a header says of the memory of its struct, "sizeof(auvid_x_t), 16 KiB", is its size with
# default sizes on a Cortex-M4F, rounded.
set -euo pipefail
cd "$(dirname "$0")/../.."
read -ra compile < <(port/cortex_m/board.sh m4f compile)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 - "$work" <<'END'
import glob
import json
import re
import sys

said = []
for path in sorted(glob.glob("lib/include/auvid/**/*.h", recursive=True)):
    text = re.sub(r"\n \* ?", " ", open(path).read())
    said += re.findall(r"sizeof\((auvid_\w+_t)\)(?: with[^.;]*?)?, ([\d.]+) (KiB|bytes)", text)
with open(f"{sys.argv[1]}/sizes.c", "w") as file:
    file.write('#include "auvid/auvid.h"\n')
    file.writelines(f"char {name}_bytes[sizeof({name})];\n" for name, _, _ in said)
json.dump(said, open(f"{sys.argv[1]}/said.json", "w"))
END
"${compile[@]}" -std=c11 -Ilib/include -c -o "$work/sizes.o" "$work/sizes.c"
"$(port/cortex_m/board.sh m4f tools)nm" -S -t d "$work/sizes.o" >"$work/symbols"
python3 - "$work" <<'END'
import json
import sys

size = {line.split()[3][:-6]: int(line.split()[1]) for line in open(f"{sys.argv[1]}/symbols")}
said = json.load(open(f"{sys.argv[1]}/said.json"))
for name, number, unit in said:
    places = len(number.partition(".")[2])
    exact = size[name] / (1024 if unit == "KiB" else 1)
    good = f"{exact:.{places}f}" == number
    print(f"{'' if good else 'not '}ok {name}: {number} {unit}; it has {exact:.3g}")
print(f"{'' if len(said) > 10 else 'not '}ok {len(said)} structs")
END
