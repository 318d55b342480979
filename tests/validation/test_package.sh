#!/usr/bin/env bash
# The Python package's own tests (pytest), a test each of them.
cd "$(dirname "$0")/../../tools/python_validation" || exit 1
set -o pipefail
../../third_party/validation/bin/python -m pytest -q -p no:cacheprovider -rA 2>&1 |
    sed -e 's/^PASSED/ok -/' -e 's/^FAILED/not ok -/' -e 's/^ERROR/not ok -/'
