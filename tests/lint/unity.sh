#!/usr/bin/env bash
# Do these files compile as one translation unit? So names of statics and private macros are unique,
# and a drop-in build may include the library whole.
#
# usage: STRICT=FLAGS unity.sh FILE.c...
set -euo pipefail
for compiler in gcc clang; do
    printf '#include "%s"\n' "$@" |
        $compiler $STRICT -Wno-shadow -I. -fsyntax-only -xc - # parameters may be called as statics
done
