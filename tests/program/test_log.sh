#!/usr/bin/env bash
# auvid-log: logs of ArduSub, PX4, ROS 2 and BlueOS to the CSV of auvid fit. The tests of the Python
# package (pytest), a test each of them; third_party/python is made by tests/support/setup.sh.
AUVID=$(realpath "${1:-${AUVID:-build/auvid}}")
export AUVID
cd "$(dirname "$0")/../../tools/python" || exit 1
set -o pipefail
../../third_party/python/bin/python -B -m pytest -q -p no:cacheprovider -rA 2>&1 |
    sed -e 's/^PASSED/ok -/' -e 's/^FAILED/not ok -/' -e 's/^ERROR/not ok -/'
