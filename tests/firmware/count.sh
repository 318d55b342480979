#!/usr/bin/env bash
# Run an image in QEMU and count the instructions of its functions (count_plugin.c): ./count gets
# lines "function calls total most".
#
# usage: count.sh BOARD IMAGE       in a folder with what the image reads
set -euo pipefail
top=$(realpath "$(dirname "$0")/../..")
board=$top/port/cortex_m/board.sh
"$("$board" "$1" tools)nm" --defined-only "$2" >functions
timeout 1200 "$board" "$1" run "$2" \
    -plugin "$top/build/firmware/count_plugin.so,functions=functions,out=count"
