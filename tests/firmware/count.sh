#!/usr/bin/env bash
# Runs an image in QEMU and counts the instructions of its functions (count_plugin.c). Writes lines
# "function calls total max" to ./count.
#
# usage: count.sh BOARD IMAGE       in a folder with the files that the image reads
set -euo pipefail
top=$(realpath "$(dirname "$0")/../..")
board=$top/port/cortex_m/board.sh
"$("$board" "$1" tools)nm" --defined-only "$2" >functions
timeout 1200 "$board" "$1" run "$2" \
    -plugin "$top/build/firmware/count_plugin.so,functions=functions,out=count"
