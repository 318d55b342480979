#!/usr/bin/env bash
# Whole searches of the identifier beside scipy, NLopt, Py-BOBYQA and CMA-ES: none may find a lower
# cost.
cd "$(dirname "$0")/../.." || exit 1
if third_party/validation/bin/auvid-validate peers --runs 3; then
    echo "ok - every search ends within 1.001 of the lowest cost that any optimizer finds"
else
    echo "not ok - every search ends within 1.001 of the lowest cost that any optimizer finds"
fi
