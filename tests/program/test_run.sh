#!/usr/bin/env bash
# tests/run.sh counts these cases as failures.
. "$(dirname "$0")/common.sh"

# counts SUMMARY STATUS PROGRAM...: run.sh of these programs ends with this line and exit status.
counts() {
    local summary=$1 wanted=$2 status=0
    shift 2
    CI='' TEST_RESUME=${RESUME:-} TEST_LOGS=$PWD/logs TEST_LIMIT=2 \
        "$ROOT/tests/run.sh" "$@" >run.out 2>&1 || status=$?
    cat run.out
    [ "$status" = "$wanted" ] && [ "$(tail -n 1 run.out)" = "$summary" ]
}

# program NAME: writes a script from standard input.
program() {
    { echo '#!/bin/sh' && cat; } >"$1"
    chmod +x "$1"
}
program good <<<'echo "ok - one"'
program bad <<<'echo "not ok - one"'
program silent <<<'true'
program crash <<<'echo "ok - one"; kill -SEGV $$'
program hang <<<'echo "ok - one"; sleep 1000'
program deaf <<<'trap "" TERM; echo "ok - one"; while :; do sleep 0.2; done'
program skipping <<<'echo "ok - one # SKIP none here"'

check "a program that passes" counts '1 passed, 0 failed' 0 "$PWD/good"
check "a program that fails" counts '1 passed, 1 failed' 1 "$PWD/good" "$PWD/bad"
check "a program without a report" counts '0 passed, 1 failed' 1 "$PWD/silent"
check "a crash after a passed test" counts '1 passed, 1 failed' 1 "$PWD/crash"
check "a program that was not built" counts '0 passed, 1 failed' 1 "$PWD/none"
check "a program that hangs is stopped, even if it ignores signals" \
    counts '2 passed, 2 failed' 1 "$PWD/hang" "$PWD/deaf"
check "a program that is skipped" counts '0 passed, 0 failed, 1 skipped' 1 "$PWD/skipping"

# resumed SUMMARY STATUS: so ends a run of three programs that goes on with an earlier one.
resumed() {
    RESUME=1 counts "$1" "$2" "$PWD/passed" "$PWD/failed" "$PWD/stopped"
}

# What passed is not run again until it is newer than its result; what failed or was stopped is.
resumes() {
    local name
    for name in passed failed stopped; do
        program $name <<END
cd $PWD && echo $name >>runs && { [ $name != failed ] || [ -e mended ]; } && echo "ok - one"
END
    done
    rm -rf logs
    resumed '2 passed, 1 failed' 1 || return
    rm logs/*stopped.count && touch mended
    resumed '3 passed, 0 failed' 0 && [ "$(sort runs | uniq -c | xargs)" = \
        '2 failed 1 passed 2 stopped' ] || return
    touch -d '1 minute' passed
    resumed '3 passed, 0 failed' 0 && [ "$(grep -c passed runs)" = 2 ]
}
check "a run that was stopped goes on" resumes
finish
