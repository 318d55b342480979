# Shared by tests/program/test_*.sh: the program under test, a temporary directory, checks.
# usage of each test: test_x.sh [PROGRAM]     (default $AUVID, else build/auvid)
set -uo pipefail
AUVID=$(realpath "${1:-${AUVID:-build/auvid}}")
ROOT=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")

# The output of a check that fails, from its beginning.
show() {
    [ "$1" = 0 ] || sed 's/^/# /' check.log | head -n 20
}
. "$ROOT/tests/support/check.sh"

# is FILE CODE: runs Python with the JSON object in FILE as d; passes if no assertion fails.
is() {
    python3 - "$1" "$2" <<'END'
import json, math, sys
d = json.load(open(sys.argv[1]))
P = {p["name"]: p for p in d["parameters"]}
error = lambda n: abs(P[n]["estimate"] / TRUTH[n] - 1)
TRUTH = dict(zip("m_u m_v m_w m_r W-B X_u X_uu Y_v Y_vv Z_w Z_ww N_r N_rr".split(),
    [249.5384, 367.7126, 659.9799, 74.9024, -37.3058, -42.4181, -125.3578, -75.7673, -447.6195,
     -44.0561, -325.0138, -20.5833, -60.9373]))
exec(sys.argv[2])
END
}

# same_result FILE: the JSON object in the file out is that in FILE, but for what it says of the
# log.
same_result() {
    local of_log='^  "log(_findings)?": |^    \{"log": '
    cmp <(grep -Ev "$of_log" out) <(grep -Ev "$of_log" "$1")
}

# refuses PATTERN ARGUMENTS...: exit 2, nothing on stdout, exactly one line on stderr, which
# matches the extended regular expression. rejects: the same with exit 1, of fit for a bad log.
refuses() {
    one_line 2 "$@"
}
rejects() {
    one_line 1 "$@"
}
one_line() {
    local wanted=$1 pattern=$2 status=0
    shift 2
    "$AUVID" "$@" >refuse.out 2>refuse.err </dev/null || status=$?
    cat refuse.err
    [ "$status" = "$wanted" ] && [ ! -s refuse.out ] && [ "$(wc -l <refuse.err)" = 1 ] &&
        grep -Eq -- "$pattern" refuse.err
}

# exits STATUS ARGUMENTS...: the output of the program is in the files out and err.
exits() {
    local wanted=$1 status=0
    shift
    "$AUVID" "$@" >out 2>err </dev/null || status=$?
    head -n 3 err
    [ "$status" = "$wanted" ]
}
