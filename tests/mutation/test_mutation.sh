#!/usr/bin/env bash
# In the files between an order and a thruster a unit test notices every change, or survivors.txt
# says why no caller can tell. Part of `make test-long`.
set -euo pipefail
cd "$(dirname "$0")/../.."
unset MAKEFLAGS MFLAGS MAKELEVEL # of the make that runs this

for module in guard actuation node node_step can_receiver; do
    if nice make --no-print-directory mutate FILE="$(echo lib/src/*/"auvid_$module.c")"; then
        echo "ok every change of auvid_$module.c is noticed, or listed"
    else
        echo "not ok every change of auvid_$module.c is noticed, or listed"
    fi
done
