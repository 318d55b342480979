#!/usr/bin/env bash
# A caller built with other sizes, or the other arithmetic, than the library must fail to link.
# Needs the library's objects in build/release (`make test` builds them first).
set -uo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cat >"$scratch/caller.c" <<'END'
#include "auvid/identifier.h"
int main(void)
{
    return auvid_identifier_init(NULL, NULL) == AUVID_ERR_NULL ? 0 : 1;
}
END

links() {
    gcc -std=c11 -Werror -Ilib/include "$@" -o "$scratch/caller" "$scratch/caller.c" \
        build/release/lib/src/*.o >"$scratch/output" 2>&1
}

refused() {
    ! links "$@" && grep -q 'undefined reference to .auvid_identifier_init_' "$scratch/output"
}

# report WHAT: "ok" or "not ok" by the last command's status.
report() {
    if [ $? = 0 ]; then echo "ok - $1"; else echo "not ok - $1"; fi
}

links && "$scratch/caller"
report "a caller built like the library links and runs"

# The sizes the identifier depends on: those in the AUVID_SIZED macro, each one larger (more
# commands would want more columns: one fewer).
config=lib/include/auvid/config.h
sizes=$(sed -n '/define AUVID_SIZED(name)/,/^$/p' $config |
    grep -oE 'AUVID_(MAX_[A-Z_]*|REGRESSOR_ONLY)')
for size in $sizes; do
    value=$(awk -v size="$size" '$1 == "#define" && $2 == size { value = $3 }
        END { print value }' $config)
    step=1
    [ "$size" != AUVID_MAX_COMMANDS ] || step=-1
    refused "-D$size=$((value + step))"
    report "$size differs: does not link"
done
refused -DAUVID_REAL_DOUBLE
report "double calls float: does not link"
