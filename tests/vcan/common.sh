# Shared by tests/vcan/test_*.sh, sourced first: goes where there is CAN, then offers checks.
if [ -z "${VCAN_INSIDE:-}" ]; then
    why=$("$(dirname "$0")/run.sh" --missing) || exec "$(dirname "$0")/run.sh" "$0" "$@"
    echo "ok - $(basename "$0" .sh) # SKIP $why"
    exit
fi

set -uo pipefail
TOP=$PWD PEER=$PWD/build/release/tests/vcan/peer
PATH=$PATH:/usr/sbin:/sbin
cd "$(mktemp -d)" || exit 1
trap 'rm -rf "$PWD"' EXIT
failed=0

# check NAME COMMAND...: one test; it passes when the command, run in a shell of its own that stops
# at the first failure, succeeds. Not inside `if`: there that shell would not stop.
check() {
    local name=$1 status
    shift
    (
        set -e
        "$@"
    ) >check.log 2>&1
    status=$?
    if [ "$status" = 0 ]; then
        echo "ok - $name"
    else
        echo "not ok - $name"
        failed=1
    fi
    sed 's/^/# /' check.log | tail -n 20
}

# listen INTERFACE [LOG]: starts a receiver; it is open when this returns.
listen() {
    "$PEER" receive "$@" >received &
    listener=$!
    until grep -q ready received; do
        kill -0 "$listener" || exit 1
        sleep 0.02
    done
}

# hear CONDITION...: ends the receiver and checks what it saw, each an expression over its words.
hear() {
    local condition
    sleep 0.2
    kill -TERM "$listener"
    wait "$listener" || exit 1
    cat received
    for condition in "$@"; do
        saw "$condition" <received || exit 1
    done
}

# saw CONDITION: of key=value words on standard input, as awk: v["received"] > 3.
saw() {
    awk -v RS='[ \n]' -F= 'NF == 2 { v[$1] = $2 + 0 } END { exit !('"$1"') }' || {
        echo "not so: $1"
        return 1
    }
}

# word KEY FILE: the value of a word.
word() {
    grep -o "\<$1=[^ ]*" "$2" | cut -d = -f 2
}

# within SECONDS COMMAND...: waits until the command succeeds.
within() {
    local end=$((SECONDS + $1))
    shift
    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.05
    done
}

# listening INTERFACE N: so many sockets are open for all its frames.
listening() {
    [ "$(grep -c "^ *$1 .* raw$" /proc/net/can/rcvlist_all)" = "$2" ]
}

# passed_by INTERFACE: frames that have been sent on it.
passed_by() {
    cat "/sys/class/net/$1/statistics/tx_packets"
}

# dump INTERFACE LOG: candump in the background, its pid in $candump.
dump() {
    candump -L -r 268435456 "$1" >"$2" &
    candump=$!
}

# witness LOG: candump writes down all that passes. all_seen LOG: it has, and has ended.
witness() {
    passed=$(passed_by vcan0)
    dump vcan0 "$1"
}

has_all() {
    [ "$(wc -l <"$1")" = "$(($(passed_by vcan0) - passed))" ]
}

all_seen() {
    within 20 has_all "$1"
    kill "$candump"
    wait "$candump" || true
    has_all "$1"
}

# start NAME ARGUMENTS...: the program in the background, its pid in $NAME.
start() {
    local name=$1
    shift
    "$AUVID" "$@" >"$name.out" 2>"$name.err" &
    printf -v "$name" '%s' $!
}

finish() {
    exit "$failed"
}
