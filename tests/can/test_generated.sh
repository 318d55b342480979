#!/usr/bin/env bash
# Do the committed files match the DBC, and does `make can-check` detect a difference?
. "$(dirname "$0")/../program/common.sh"

PYTHON=$ROOT/third_party/venv/bin/python
CODEGEN=$ROOT/tools/can_codegen/can_codegen.py
DBC=lib/can/auvid.dbc
cp -r "$ROOT/lib" lib || exit 1

# The generator's packages take longer to start than its work: one process has loaded them, and each
# line of arguments that it reads is run in a copy of it. It answers with the exit status.
coproc GENERATOR { "$PYTHON" -c '
import os, sys
sys.path.insert(0, os.path.dirname(sys.argv[1]))
import can_codegen
for line in sys.stdin:
    copy = os.fork()
    if copy == 0:
        for stream in 1, 2:
            file = os.open("codegen.%d" % stream, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(file, stream)
        sys.argv[1:] = line.split()
        can_codegen.main()
    print(os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1]), flush=True)
' "$CODEGEN"; }
exec 3>&"${GENERATOR[1]}" 4<&"${GENERATOR[0]}" # a check, in its subshell, has these

codegen() {
    local status=99
    echo "--root . $*" >&3
    read -r status <&4
    cat codegen.1
    cat codegen.2 >&2
    return "$status"
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
    sed -i 's/0x/0X/; s/| 0X040/| 0x041/; s/{12, /{13, /; s/^# Written/# Made/' "$1"
    codegen --check || status=$?
    cp "$ROOT/$1" "$1"
    [ "$status" = 1 ]
}

regenerated() {
    rm lib/include/auvid/can_messages.h lib/src/can/auvid_can_table.c
    codegen && diff -r "$ROOT/lib" lib
}

check "the committed files match the DBC" "$PYTHON" "$CODEGEN" --root . --check
check "generated again they are the same" regenerated
check "another cycle time is detected" touched 1 's/("GenMsgCycleTime" BO_ 1031) 100/\1 50/'
check "another comment is detected" touched 1 's/Positive down/Positive upwards/'
protocol=$(sed -n 's/^BA_ "AuvidProtocol" \([0-9]*\);/\1/p' "$ROOT/$DBC")
higher="s/^(BA_ \"AuvidProtocol\") .*/\1 $((protocol + 1));/"
check "another protocol version is detected" touched 1 "$higher"
for file in lib/include/auvid/can_messages.h lib/src/can/auvid_can_table.c lib/can/README.md \
    lib/can/published.txt; do
    check "a change of ${file##*/} is detected" spoiled "$file"
done
check "a gap in the identifiers is refused" touched 2 's/1040/1041/g'
check "two messages with one data id are refused" touched 2 's/("AuvidDataId" BO_ 1031) 14/\1 15/'
check "a message without a data id is refused" touched 2 '/"AuvidDataId" BO_ 1031/d'
check "overlapping signals are refused" touched 2 's/theta : 26/theta : 25/'
check "a signal without comment is refused" touched 2 '/CM_ SG_ 1031 depth/d'
check "two receivers of one message are refused" touched 2 's/(depth : .*) node/\1 vehicle/'
check "an age that is not the last signal is refused" touched 2 \
    's/altitude : 12\|20/altitude : 22|20/; /^BO_ 1030/,/^$/s/age : 54/age : 12/'
check "a scale that is not 1/n is refused" touched 2 's/(phi : [^(]*\()0.0004/\10.0003/'
check "a signal without a value for not available is refused" touched 2 '/VAL_ 1031 depth/d'
check "a crc in another place is refused" touched 2 's/(gps_crc : )0/\11/'
check "more than a fifth of the bus is refused" touched 2 \
    's/("GenMsgCycleTime" BO_ 10[0-9]+) 100/\1 5/'
# republished STATUS SED [PATTERN]: `make can` with the DBC so changed must exit with STATUS and say
# what matches the pattern. Refused, it writes nothing. Accepted, it agrees with itself.
republished() {
    local status=0
    sed -E "$2" "$ROOT/$DBC" >$DBC
    if cmp -s $DBC "$ROOT/$DBC"; then
        echo "sed changed nothing"
        return 1
    fi
    cp -r lib refused
    codegen 2>message || status=$?
    cat message
    grep -Eq "${3:-^}" message || [ -z "${3:-}" ]
    [ "$status" = "$1" ]
    if [ "$status" = 0 ]; then
        codegen --check
    else
        [ "$(wc -l <message)" = 1 ]
        diff -r lib refused
    fi
}

# refused WHAT SED [PATTERN]: not without a higher number, yet with it.
refused() {
    check "$1: refused" republished 2 "$2" "$3.*set AuvidProtocol to $((protocol + 1))"
    afresh
    check "$1: accepted with a higher number" republished 0 "$2
        $higher"
    afresh
}

# accepted WHAT SED [PATTERN]: the number stays.
accepted() {
    check "$1: accepted" republished 0 "$2" "${3:-}"
    afresh
}

afresh() {
    rm -rf lib refused
    cp -r "$ROOT/lib" lib
}

last=$(grep -oE '^BO_ [0-9]+' "$ROOT/$DBC" | tail -n 1 | tr -dc 0-9) # message
changed='layout of this published message has changed'
refused "another scale" 's/\(0\.0004,0\) \[-3\.2764\|3\.2764\]/(0.0005,0) [-4.0955|4.0955]/' \
    "imu_attitude: the $changed"
refused "another size" 's/index : 12\|5/index : 12|4/; s/\[0\|31\]/[0|15]/' ": the $changed"
refused "another place" 's/load : 32/load : 33/' "tick_done: the $changed"
refused "another sign" \
    's/sequence : (.*)@1\+ \(1,0\) \[0.1048575]/sequence : \1@1- (1,0) [-524287|524287]/
     $a VAL_ 65 sequence -524288 "not_available" ;\nVAL_ 69 sequence -524288 "not_available" ;' \
    "tick: the $changed"
refused "another range" 's/guard : (.*)\[0.5\]/guard : \1[0|6]/' "progress: the $changed"
refused "another unit" 's/"m\/s" node/"km\/h" node/' "dvl_bottom: the $changed"
refused "values exchanged" 's/1 "arm" 2 "stop"/1 "stop" 2 "arm"/' "arm: the $changed"
refused "one value more" 's/2 "monitor"/2 "monitor" 3 "tool"/' "heartbeat: the $changed"
refused "one signal more" \
    '/ SG_ load : 32.8/a\ SG_ rest : 40|8@1+ (1,0) [0|255] "" vehicle
     /CM_ SG_ 69 load/a CM_ SG_ 69 rest "What is left.";' "tick_done: the $changed"
refused "a signal removed" '/ SG_ load : 32.8/d; /CM_ SG_ 69 load/d' "tick_done: the $changed"
refused "signals exchanged" \
    '/^BO_ 1028/,/^BO_ 1029/{s/ u : 12/ x : 12/; s/ v : 26/ u : 26/; s/ x : 12/ v : 12/}' \
    'dvl_bottom: signals .* exchanged their names'
refused "a message renamed" 's/dvl_altitude/dvl_height/g' 'dvl_altitude: .* removed or renamed'
refused "the last message removed" "/^BO_ $last/,/^\$/d; / $last /d" ': .* removed or renamed'
refused "messages that exchange their identifiers" \
    '/^BA_ /!{s/\<1041\>/last/; s/\<1042\>/1041/; s/\<last\>/1042/}' "drag: the $changed"
next=$((last + 1))
# extra ID DATA_ID RECEIVER: sed that adds a message.
extra() {
    printf '%s\n' "/^BO_ $last/i BO_ $1 extra: 8 node\\n\\" \
        " SG_ extra_crc : 0|8@1+ (1,0) [0|255] \"\" $3\\n\\" \
        " SG_ extra_counter : 8|4@1+ (1,0) [0|15] \"\" $3\\n\\" \
        " SG_ n : 12|8@1+ (1,0) [0|255] \"\" $3\\n" \
        "/^BA_DEF_ BO_ \"Gen/i CM_ BO_ $1 \"Extra.\";\\nCM_ SG_ $1 n \"Number.\";" \
        "\$a BA_ \"AuvidDataId\" BO_ $1 $2;"
}
next_data_id=$(($(grep -c '^BO_ ' "$ROOT/$DBC") + 1))
accepted "a message at the end of the second block" "$(extra $next $next_data_id vehicle)"
accepted "a message at the end of the first block" "$(extra 70 246 vehicle)"
accepted "a message that a node receives" "$(extra $next $next_data_id node)"
check "a message behind a gap is refused" touched 2 "$(extra $((next + 1)) $next_data_id node)"
check "a message with another data id is refused" touched 2 "$(extra 70 $next_data_id node)"
accepted "another comment" 's/Positive down/Positive upwards/'
accepted "another cycle time" 's/("GenMsgCycleTime" BO_ 1031) 100/\1 50/'
accepted "a signal renamed" 's/\<altitude :/height :/; s/1030 altitude/1030 height/' \
    'dvl_altitude.altitude is now height: note it in CHANGELOG'
accepted "a higher number alone" "$higher"
check "a lower number: refused" republished 2 "${higher/$((protocol + 1))/$((protocol - 1))}" \
    "$protocol is published already"
afresh
check "a file that is not a DBC is refused" touched 2 's/^BO_ /BO /'
finish
