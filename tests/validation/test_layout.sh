#!/usr/bin/env bash
# State is plain data, laid out alike on the host, Cortex-M4F and M0+: see layout.py. With
# --write, the present layout becomes the listed one.
set -euo pipefail
cd "$(dirname "$0")/../.."
to=build/validation/layout
mkdir -p $to
build() {
    local name=$1
    shift
    "$@" -std=c11 -g -fno-eliminate-unused-debug-types -Ilib/include -c -o "$to/$name.o" \
        lib/src/checkpoint/auvid_checkpoint_layout.c
}
build host "${CC:-gcc}"
for board in m4f m0plus; do
    read -ra compile < <(port/cortex_m/board.sh $board compile)
    build $board "${compile[@]}"
done
build double-sizes "${CC:-gcc}" -DAUVID_REAL_DOUBLE
build wide-sizes "${CC:-gcc}" -DAUVID_MAX_PARAMETERS=32
build odd-sizes "${CC:-gcc}" -DAUVID_MAX_PARAMETERS=14 -DAUVID_MAX_POPULATION=59 \
    -DAUVID_MAX_COMMANDS=3 -DAUVID_MAX_COLUMNS=42 -DAUVID_MAX_SETS=3 -DAUVID_MAX_OVERLAP=7
objects=()
for name in host m4f m0plus double-sizes wide-sizes odd-sizes; do
    objects+=("$name=$to/$name.o")
done
check=(third_party/validation/bin/python tests/validation/layout.py)
"${check[@]}" "$@" "${objects[@]}"

# Would it be noticed?
rm -rf $to/include
cp -r lib/include $to
sed -i 's/ bool depth_known; / uint8_t extra; &/' $to/include/auvid/guard.h
build changed "${CC:-gcc}" -I$to/include
case $("${check[@]}" changed=$to/changed.o) in
"not ok - changed: guard.extra is new") echo "ok - a new member is named" ;;
*) echo "not ok - a new member is not named" ;;
esac
