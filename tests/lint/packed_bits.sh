#!/usr/bin/env bash
# Bits packed into a narrower integer, or beside others in a word: does what no longer fits refuse
# to compile? Each case adds something to a copy of the library.
set -euo pipefail
cd "$(dirname "$0")/../.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
broken=0

# compiles FILE: exit status of the compiler; what it says is in $scratch/output.
compiles() {
    gcc -std=c11 -fsyntax-only -I"$scratch/lib/include" $DEFINES "$scratch/lib/src/$1" \
        >"$scratch/output" 2>&1
}

# refused ASSERTION FILE SED HEADER: with HEADER so changed, FILE stops at this assertion; without
# the change it compiles.
refused() {
    rm -rf "$scratch/lib"
    cp -r lib "$scratch"
    if ! compiles "$2"; then
        echo "packed bits: $2 does not compile"
        broken=1
    fi
    sed -i -E "$3" "$scratch/lib/$4"
    if cmp -s "lib/$4" "$scratch/lib/$4"; then
        echo "packed bits: nothing changed in $4: $3"
        broken=1
    elif compiles "$2" || ! grep -Fq "static assertion failed: \"$1" "$scratch/output"; then
        echo "packed bits: '$1' in $2 does not refuse: $3"
        sed 's/^/    /' "$scratch/output" | head -n 5
        broken=1
    fi
}

DEFINES=
# before NAME: sed that puts enumerators before this one; many N: that many without a value.
before() {
    printf '/^ *%s\\b/i %s' "$1" "$2"
}
many() {
    seq -f 'EXTRA_%g,' "$1" | tr '\n' ' '
}
public=include/auvid
refused 'a row for each sensor' navigation/auvid_nav.c \
    's/(AUVID_NAV_SENSOR_COUNT) = (.*)/\1 = \2 + 1/' $public/nav.h
refused 'auvid_nav_held_t.sensors' navigation/auvid_nav_late.c \
    's/(AUVID_NAV_SENSOR_COUNT) = .*/\1 = 9/' $public/nav.h
refused 'auvid_nav_t.flags' navigation/auvid_nav.c \
    "$(before AUVID_NAV_FLAG_END 'AUVID_NAV_EXTRA = 1 << 16,')" $public/nav.h
refused 'nav_position.flags' can/auvid_node_report.c \
    "$(before AUVID_NAV_FLAG_END 'AUVID_NAV_EXTRA = 1 << 10,')" $public/nav.h
refused 'auvid_recorder_t.measured' navigation/auvid_recorder.c \
    's/VELOCITY \+ 3, STREAMS/VELOCITY + 9, STREAMS/' src/navigation/auvid_recorder.c
refused 'an enumerator of C11' identifier/auvid_identifier_step.c \
    "$(before AUVID_EVENT_END 'AUVID_EVENT_EXTRA = 1u << 31,')" $public/identifier.h
refused 'AUVID_GUARD_BIT' excitation/auvid_guard.c \
    "$(before AUVID_GUARD_CAUSE_COUNT "$(many 11)")" $public/guard.h
refused 'abort.cause' can/auvid_node_report.c \
    "$(before AUVID_GUARD_CAUSE_COUNT 'EXTRA,')" $public/guard.h
refused 'progress.guard' can/auvid_node_report.c \
    "$(before AUVID_GUARD_STATE_COUNT 'EXTRA,')" $public/guard.h
refused 'a bit of `with_sentence`' metric/auvid_confidence_words.c \
    "$(before AUVID_NOTE_COUNT "$(many 20)")" $public/estimate.h
refused 'estimate_sigma.note' can/auvid_node_report.c \
    "$(before AUVID_NOTE_COUNT 'EXTRA,')" $public/estimate.h
refused 'progress.work' can/auvid_node_report.c \
    "$(before AUVID_WORK_PHASE_COUNT 'EXTRA,')" $public/identifier.h
refused 'masks of degrees of freedom' base/auvid_math.c \
    's/(AUVID_DOF_COUNT) = 6/\1 = 9/' $public/types.h
refused 'progress.excited' can/auvid_node_report.c \
    's/(AUVID_DOF_COUNT) = 6/AUVID_EXTRA = 6, \1 = 7/' $public/types.h
refused 'drag.point' can/auvid_node_report.c \
    's/AUVID_C\(0\.3\), AUVID_C\(0\.6\)/AUVID_C(0.2), &/' src/can/auvid_node_report.c
refused 'a bit of `used`' identifier/auvid_thrusters.c \
    's/(AUVID_THRUSTERS_GROUPS) 4/\1 32/' $public/thrusters.h
refused 'AUVID_CAN_DATA_ID' can/auvid_can.c 's/(AUVID_CAN_KINDS) = .*/\1 = 256/' \
    $public/can_messages.h
refused 'auvid_checkpoint_block_t.parts' checkpoint/auvid_checkpoint_layout.c \
    "$(before PART_END 'PART_EXTRA = 65536,')" src/checkpoint/auvid_checkpoint_layout_internal.h
# More parameters than bits, past the range that config.h refuses.
more='s/#if AUVID_MAX_PARAMETERS < 1 .*/#undef AUVID_MAX_PARAMETERS\
#define AUVID_MAX_PARAMETERS 33\
#if 0/'
DEFINES=-DAUVID_MAX_PARAMETERS=32
refused 'the record has room' identifier/auvid_prior.c "$more" $public/config.h
refused 'estimate.index' can/auvid_node_report.c "$more" $public/config.h
exit "$broken"
