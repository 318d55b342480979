#!/usr/bin/env bash
# Every module against tools that others wrote: tools/python_validation. A test each comparison.
cd "$(dirname "$0")/../.." || exit 1
set -o pipefail
third_party/validation/bin/auvid-validate references |
    sed -e 's/^PASS/ok -/' -e 's/^FAIL/not ok -/'
