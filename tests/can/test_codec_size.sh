#!/usr/bin/env bash
# Does the codec with all messages fit into 1700 bytes of flash (code and tables, Cortex-M4F, -Os)?
# Counted is all that packing and unpacking of any message links, except memcpy and memset.
. "$(dirname "$0")/../program/common.sh"

LARGEST=1700
ARM="arm-none-eabi-gcc -std=c11 -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -Os
    -ffunction-sections -fdata-sections -I$ROOT/lib/include"

if ! command -v arm-none-eabi-gcc >/dev/null; then
    echo "ok - codec size # SKIP arm-none-eabi-gcc is missing"
    finish
fi

fits() {
    local keep=-Wl,--gc-sections,-e,auvid_can_pack_f32 name text
    for name in auvid_can_sender_init_f32 auvid_can_unpack_f32; do
        keep+=,-u,$name
    done
    # shellcheck disable=SC2086
    $ARM -nostdlib -r $keep -o codec.o "$ROOT"/lib/src/can/auvid_can{,_table}.c || return 1
    text=$(size codec.o | awk 'NR == 2 { print $1 + $2 + $3 }')
    echo "$text bytes" | tee text
    [ "$text" -gt 0 ] && [ "$text" -le "$LARGEST" ]
}

check "codec with all messages is at most $LARGEST bytes of text on a Cortex-M4F" fits
sed 's/^/# /' text
finish
