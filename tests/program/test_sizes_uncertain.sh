#!/usr/bin/env bash
# AUVID_MAX_UNCERTAIN: which columns of uncertain inputs fit, and what is refused?
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cat >"$scratch/fits.c" <<'END_C'
#include <stdio.h>
#include <string.h>
#include "auvid/auvid.h"
static auvid_identifier_t id, before;
static auvid_uncertain_t uncertain;
static auvid_allocation_t thrusters;
int main(int count, char **option)
{
    auvid_identifier_config_t cfg;
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
#if AUVID_MAX_PARAMETERS >= 22
    static auvid_calibrated_t known;
    (void)auvid_calibrated_init(&known, &auvid_bluerov2_heavy, AUVID_HEAVE);
    bool force = count > 1 && strcmp(option[1], "force") == 0;
    auvid_identifier_defaults(&cfg, force ? &known.vehicle : &auvid_bluerov2_heavy);
    auvid_allocation_init(&thrusters, &auvid_allocation_bluerov2_heavy);
#else
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    auvid_allocation_init(&thrusters, &auvid_allocation_girona500);
#endif
    if (count > 1 && strcmp(option[1], "still") == 0) {
        inputs.current = 0;
    }
    if (count > 1 && strcmp(option[1], "exact") == 0) {
        inputs = (auvid_uncertain_config_t){.nominal_lag_s = AUVID_C(0.15)};
    }
    for (int i = 0; count > 1 && strcmp(option[1], "fixed") == 0 && i < cfg.vehicle->parameters;
         ++i) {
        bool constant = cfg.vehicle->parameter[i].kind == AUVID_PARAMETER_FORCE;
        cfg.metric.free &= ~((uint32_t)constant << i);
    }
    if (auvid_identifier_init(&id, &cfg) < 0) {
        return 1;
    }
    before = id;
    auvid_status_t status = auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &thrusters);
    printf("%s, %u bytes\n", auvid_status_str(status), (unsigned)sizeof uncertain);
    return status == AUVID_OK ? 0 : status == AUVID_ERR_SIZE && memcmp(&id, &before, sizeof id) == 0
           ? 2 : 1;
}
END_C

# report WHAT EXPECTED ACTUAL
report() {
    if [ "$2" = "$3" ]; then
        echo "ok - $1"
    else
        echo "not ok - $1: $3 instead of $2"
        cat "$scratch/output"
    fi
}
# The library without the bus and the models in one translation unit: it takes a second.
printf '#include "%s"\n' "$PWD"/lib/src/{base,navigation,metric,search}/*.c \
    "$PWD"/lib/src/{excitation,identifier,uncertain}/*.c "$scratch/fits.c" >"$scratch/unity.c"
build() {
    gcc -std=c11 -ffp-contract=off -O0 -Ilib/include "$@" -o "$scratch/fits" "$scratch/unity.c" \
        lib/src/models/*.c >"$scratch/output" 2>&1
    report "builds with sizes $*" 0 $?
}
attaches() {
    "$scratch/fits" "$@" >"$scratch/output" 2>&1
    echo $?
}
bytes() {
    "$scratch/fits" | sed 's/.*, \(.*\) bytes/\1/'
}

build -DAUVID_REAL_FLOAT
report "default: Girona500 with five thrusters" 0 "$(attaches)"
default=$(bytes)
build -DAUVID_MAX_UNCERTAIN=73
report "73 columns: refused" 2 "$(attaches)"
report "73 columns: all but the current" 0 "$(attaches still)"
report "73 columns: a tenth less memory" 1 $((10 * $(bytes) < 9 * default))
build -DAUVID_MAX_UNCERTAIN=78
report "78 columns: refused" 2 "$(attaches)"
build -DAUVID_MAX_UNCERTAIN=79
report "79 columns: Girona500 with five thrusters" 0 "$(attaches)"
build -DAUVID_MAX_UNCERTAIN=0
report "no columns: refused" 2 "$(attaches exact)"
report "no columns: a third of the memory" 1 $((3 * $(bytes) < default))
build -DAUVID_MAX_PARAMETERS=22 -DAUVID_MAX_UNCERTAIN=138
report "138 columns: too few for the BlueROV2 Heavy" 2 "$(attaches)"
build -DAUVID_MAX_PARAMETERS=22 -DAUVID_MAX_UNCERTAIN=139
report "139 columns: BlueROV2 Heavy in six degrees of freedom" 0 "$(attaches)"
tr -d '\n*' <lib/include/auvid/config.h >"$scratch/output"
report "config.h has these numbers" 1 "$(grep -Ec \
    'Girona500 and its five thrusters *need 79, .* ones 86, a BlueROV2 Heavy.* 139\.' \
    "$scratch/output")"
tr '\n' ' ' <lib/README.md >"$scratch/output"
report "  and the library's guide" 1 "$(grep -Ec \
    'five thrusters need 79 columns, .* thrusters 86, a BlueROV2 Heavy .* 139\.' "$scratch/output")"
build -DAUVID_MAX_PARAMETERS=22
report "default for 22 parameters: BlueROV2 Heavy in six degrees of freedom" 0 "$(attaches)"
report "the same with W-B fixed" 0 "$(attaches fixed)"
build -DAUVID_MAX_PARAMETERS=32 -DAUVID_MAX_UNCERTAIN=146
report "146 columns: the same with a known force" 0 "$(attaches force)"
