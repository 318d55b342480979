#!/usr/bin/env bash
# Do these files compile as one translation unit? So names of statics and private macros are unique,
# and a drop-in build may include the library whole.
#
# usage: STRICT=FLAGS unity.sh FILE.c...
set -euo pipefail
# -Wno-shadow: parameters may be called as statics.
for compiler in gcc clang; do
    for size in '' -DAUVID_MAX_PARAMETERS=32; do # some models need more than the default
        printf '#include "%s"\n' "$@" |
            $compiler $STRICT $size -Wno-shadow -I. -fsyntax-only -xc -
    done
done
