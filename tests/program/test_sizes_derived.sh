#!/usr/bin/env bash
# Sizes that follow from AUVID_MAX_PARAMETERS: do the models of auvid fit, all parameters free?
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The largest model of so many parameters, and as many more as there is room for, in each equation.
cat >"$scratch/fits.c" <<'END_C'
#include <stdio.h>
#include "auvid/auvid.h"
int main(void)
{
#if AUVID_MAX_PARAMETERS >= 22
    const auvid_vehicle_t *hull = &auvid_fossen;
#else
    const auvid_vehicle_t *hull = &auvid_girona500;
#endif
    const int commands = AUVID_MAX_COMMANDS == 0 ? 0 : 33 + 3 * AUVID_MAX_COMMANDS;
    int factor = 0, columns = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int c = hull->columns[j] == 0 ? 0 : AUVID_MAX_PARAMETERS - hull->parameters + 3;
        for (uint32_t left = hull->columns[j]; left != 0; left &= left - 1) {
            ++c;
        }
        columns += c;
        factor += c * (c + 1) / 2;
    }
    columns = columns > commands ? columns : commands;
    printf("%d parameters: factor %d of %d, columns %d of %d, population %d\n",
           AUVID_MAX_PARAMETERS, factor, AUVID_MAX_FACTOR, columns, AUVID_MAX_COLUMNS,
           AUVID_MAX_POPULATION);
    return !(factor <= AUVID_MAX_FACTOR && columns <= AUVID_MAX_COLUMNS &&
             AUVID_MAX_POPULATION == 4 * AUVID_MAX_PARAMETERS);
}
END_C

# fits FLAG...: the program of these sizes, with models alone. Nothing calls the paths.
fits() {
    gcc -std=c11 -O1 -no-pie -Wl,--unresolved-symbols=ignore-all -Ilib/include "$@" \
        -o "$scratch/fits" "$scratch/fits.c" lib/src/models/*.c lib/src/base/*.c 2>"$scratch/log" &&
        "$scratch/fits" >"$scratch/output"
}
# report WHAT: "ok" or "not ok" by the last command's status.
report() {
    if [ $? = 0 ]; then echo "ok - $1"; else echo "not ok - $1" && cat "$scratch"/{log,output}; fi
}

for parameters in 13 15 16 17 19 21 22 24 26 29 32; do
    fits -DAUVID_MAX_PARAMETERS=$parameters -DAUVID_MAX_COMMANDS=0
    report "models of $parameters parameters fit"
done
# The same figures, to the number: what the defaults cost in memory.
fits && grep -q '^17 parameters: factor 210 of 210, columns 57 of 57, population 68$' \
    "$scratch/output"
report "default sizes"
fits -DAUVID_MAX_COMMANDS=0 && grep -q 'columns 39 of 39' "$scratch/output"
report "default sizes without commands"
fits -DAUVID_MAX_PARAMETERS=13 -DAUVID_MAX_COMMANDS=0 &&
    grep -q 'factor 171 of 171, columns 35 of 35' "$scratch/output"
report "13 parameters, no memory left over"
fits -DAUVID_MAX_PARAMETERS=22 && grep -q 'factor 369 of 369, columns 63 of 63' "$scratch/output"
report "22 parameters, no memory left over"
! fits -DAUVID_MAX_FACTOR=209
report "a size that is defined takes precedence"
