# Shared by the common.sh of tests/program and tests/vcan: a temporary directory, checks. Each of
# them defines `show STATUS`, which prints what is worth showing of a check's output, check.log.
set -uo pipefail
cd "$(mktemp -d)" || exit 1
trap 'rm -rf "$PWD"' EXIT
failed=0

# check NAME COMMAND...: runs one test, which passes if the command succeeds. The command runs in a
# subshell that stops at the first failure. Not inside `if`: there the subshell would not stop.
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
    show "$status"
}

finish() {
    exit "$failed"
}
