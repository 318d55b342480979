#!/usr/bin/env bash
# Do the committed files match the DBC, and does `make can-check` detect a difference?
. "$(dirname "$0")/../program/common.sh"

PYTHON=$ROOT/third_party/venv/bin/python
CODEGEN=$ROOT/tools/can_codegen/can_codegen.py
DBC=lib/can/auvid.dbc
cp -r "$ROOT/lib" lib || exit 1

codegen() {
    "$PYTHON" "$CODEGEN" --root . "$@"
}

# touched STATUS SED: with the DBC changed by SED, the check must exit with STATUS.
touched() {
    local status=0
    sed -E "$2" "$ROOT/$DBC" >touched.dbc
    if cmp -s touched.dbc "$ROOT/$DBC"; then
        echo "sed changed nothing"
        return 1
    fi
    codegen --check --dbc touched.dbc || status=$?
    echo "exit status $status"
    [ "$status" = "$1" ]
}

# spoiled FILE: with that output changed, the check must fail.
spoiled() {
    local status=0
    sed -i 's/0x/0X/; s/| 0X040/| 0x041/; s/{12, /{13, /' "$1"
    codegen --check || status=$?
    cp "$ROOT/$1" "$1"
    [ "$status" = 1 ]
}

regenerated() {
    rm lib/include/auvid/can_messages.h lib/src/can/auvid_can_table.c
    codegen && diff -r "$ROOT/lib" lib
}

check "the committed files match the DBC" codegen --check
check "generated again they are the same" regenerated
check "another scale is detected" touched 1 \
    's/\(0\.0004,0\) \[-3\.2764\|3\.2764\]/(0.0005,0) [-4.0955|4.0955]/'
check "another start bit is detected" touched 1 's/index : 12\|5/index : 12|4/; s/\[0\|31\]/[0|15]/'
check "another name is detected" touched 1 's/dvl_altitude/dvl_height/g'
check "another cycle time is detected" touched 1 's/("GenMsgCycleTime" BO_ 1031) 100/\1 50/'
check "another comment is detected" touched 1 's/Positive down/Positive upwards/'
check "another protocol version is detected" touched 1 's/"AuvidProtocol" 1/"AuvidProtocol" 2/'
for file in lib/include/auvid/can_messages.h lib/src/can/auvid_can_table.c lib/can/README.md; do
    check "a change of ${file##*/} is detected" spoiled "$file"
done
check "a gap in the identifiers is refused" touched 2 's/1040/1041/g'
check "two messages with one data id are refused" touched 2 's/("AuvidDataId" BO_ 1031) 14/\1 15/'
check "overlapping signals are refused" touched 2 's/theta : 26/theta : 25/'
check "a signal without comment is refused" touched 2 '/CM_ SG_ 1031 depth/d'
check "a scale that is not 1/n is refused" touched 2 's/(phi : [^(]*\()0.0004/\10.0003/'
check "a signal without a value for not available is refused" touched 2 '/VAL_ 1031 depth/d'
check "a crc in another place is refused" touched 2 's/(gps_crc : )0/\11/'
check "more than a fifth of the bus is refused" touched 2 \
    's/("GenMsgCycleTime" BO_ 10[0-9]+) 100/\1 5/'
check "a file that is not a DBC is refused" touched 2 's/^BO_ /BO /'
finish
