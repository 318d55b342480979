# Shared by tests/vcan/test_*.sh, which source it first. Restarts the test where there is CAN, then
# defines the checks.
if [ -z "${VCAN_INSIDE:-}" ]; then
    why=$("$(dirname "$0")/run.sh" --missing) || exec "$(dirname "$0")/run.sh" "$0" "$@"
    echo "ok - $(basename "$0" .sh) # SKIP $why"
    exit
fi

set -uo pipefail
TOP=$PWD PEER=$PWD/build/release/tests/vcan/peer
PATH=$PATH:/usr/sbin:/sbin

# The end of each check's output.
show() {
    sed 's/^/# /' check.log | tail -n 20
}
# shellcheck source=tests/support/check.sh
. "$(dirname "${BASH_SOURCE[0]}")/../support/check.sh"

# listen INTERFACE [LOG]: starts a receiver and waits until it is open.
listen() {
    "$PEER" receive "$@" >received &
    listener=$!
    until grep -q ready received; do
        kill -0 "$listener" || exit 1
        sleep 0.02
    done
}

# check_received CONDITION...: ends the receiver and checks its output: each condition is an
# expression.
check_received() {
    local condition
    sleep 0.2
    kill -TERM "$listener"
    wait "$listener" || exit 1
    cat received
    for condition in "$@"; do
        holds "$condition" <received || exit 1
    done
}

# holds CONDITION: checks key=value words on standard input with awk, for instance v["received"] >
# 3.
holds() {
    awk -v RS='[ \n]' -F= 'NF == 2 { v[$1] = $2 + 0 } END { exit !('"$1"') }' || {
        echo "failed condition: $1"
        return 1
    }
}

# word KEY FILE: prints the value of a key.
word() {
    grep -o "\<$1=[^ ]*" "$2" | cut -d = -f 2
}

# within SECONDS COMMAND...: waits until the command succeeds. SECONDS hold for an idle machine; the
# limit is five times as long.
within() {
    local end=$((SECONDS + 5 * $1))
    shift
    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.05
    done
}

# listening INTERFACE N: succeeds if N sockets are open for all frames of the interface.
listening() {
    [ "$(grep -c "^ *$1 .* raw$" /proc/net/can/rcvlist_all)" = "$2" ]
}

# passed_by INTERFACE: prints the number of frames sent on it.
passed_by() {
    cat "/sys/class/net/$1/statistics/tx_packets"
}

# dump INTERFACE LOG: starts candump in the background, with its pid in $candump. The log also has a
# line "DROPCOUNT" when candump's socket lost frames.
dump() {
    candump -L -d -r 268435456 "$1" >"$2" &
    candump=$!
}

# witness LOG: candump logs all frames. all_seen LOG: waits until it has, and ends it.
witness() {
    passed=$(passed_by vcan0)
    dump vcan0 "$1"
}

has_all() {
    [ "$(grep -c '#' "$1")" = "$(($(passed_by vcan0) - passed))" ]
}

all_seen() {
    within 20 has_all "$1"
    kill "$candump"
    wait "$candump" || true
    has_all "$1"
}

# start NAME ARGUMENTS...: starts the program in the background, with its pid in $NAME.
start() {
    local name=$1
    shift
    "$AUVID" "$@" >"$name.out" 2>"$name.err" &
    printf -v "$name" '%s' $!
}

# estimates FILE: prints parameter, estimate, half-width and, where the report has it, true value.
estimates() {
    awk '$1 ~ /._|W-B/ {
        line = $1
        for (i = 2; i <= NF; i++) if ($i ~ /^-?[0-9]+\.[0-9]+$/) line = line " " $i
        print line }' "$1"
}

# compared: prints parameter, estimate, half-width and true value of the node's report node.out. The
# true values are in the report of the same run over the bus in memory.
compared() {
    [ -e memory.out ] || "$AUVID" node --bus memory --excite --sets 1 >memory.out || true
    estimates memory.out >memory.estimates
    estimates node.out | awk 'NR == FNR { truth[$1] = $4; next }
        $1 in truth { print $1, $2, $3, truth[$1] }' memory.estimates -
}
