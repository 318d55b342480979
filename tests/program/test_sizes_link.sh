#!/usr/bin/env bash
# Code built with other sizes, or with the other arithmetic, than the library must fail to link,
# whatever it uses of it. Needs the library's objects in build/release (`make test` builds them).
set -uo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
config=lib/include/auvid/config.h

# Uses of auvid by a translation unit, each in a separate file.
cat >"$scratch/main.c" <<'END_C'
extern int use(void);
int main(void)
{
    return use();
}
END_C
cat >"$scratch/init.c" <<'END_C'
#include "auvid/identifier.h"
int use(void);
int use(void)
{
    return auvid_identifier_init(NULL, NULL) == AUVID_ERR_NULL ? 0 : 1;
}
END_C
cat >"$scratch/step.c" <<'END_C'
#include "auvid/identifier.h"
int use(void);
int use(void)
{
    static auvid_output_t out;
    return auvid_identifier_step(NULL, NULL, &out) == AUVID_ERR_NULL ? 0 : 1;
}
END_C
cat >"$scratch/defaults.c" <<'END_C'
#include "auvid/identifier.h"
int use(void);
int use(void)
{
    static auvid_identifier_config_t config;
    auvid_identifier_defaults(&config, NULL);
    return 0;
}
END_C
cat >"$scratch/model.c" <<'END_C'
#include "auvid/vehicle.h"
int use(void);
static void residual(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                     auvid_real_t *to)
{
    (void)context;
    to[AUVID_SURGE] = pi[0] * sample->nu_dot[AUVID_SURGE] - sample->tau[AUVID_SURGE];
}
static const auvid_parameter_t parameter = {.name = "m", .dof = AUVID_SURGE};
static const auvid_vehicle_t mine = {.built_for = AUVID_BUILD,
                                     .path = &auvid_path_residual,
                                     .parameters = 1,
                                     .parameter = &parameter,
                                     .columns = {[AUVID_SURGE] = 1},
                                     .residual = residual};
int use(void)
{
    return auvid_vehicle_check(&mine) == AUVID_OK ? 0 : 1;
}
END_C
cat >"$scratch/model.cpp" <<'END_C'
#include "auvid/vehicle.h"
extern "C" int use(void);
static void residual(const void *, const auvid_sample_t *sample, const auvid_real_t *pi,
                     auvid_real_t *to)
{
    to[AUVID_SURGE] = pi[0] * sample->nu_dot[AUVID_SURGE] - sample->tau[AUVID_SURGE];
}
static const auvid_parameter_t parameter = {"m", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS};
int use(void)
{
    auvid_vehicle_t mine = {};
    mine.built_for = AUVID_BUILD;
    mine.path = &auvid_path_residual;
    mine.parameters = 1;
    mine.parameter = &parameter;
    mine.columns[AUVID_SURGE] = 1;
    mine.residual = residual;
    return auvid_vehicle_check(&mine) == AUVID_OK ? 0 : 1;
}
END_C
cat >"$scratch/step.cpp" <<'END_C'
#include "auvid/auvid.h"
extern "C" int use(void);
int use(void)
{
    static auvid_output_t out;
    return auvid_identifier_step(nullptr, nullptr, &out) == AUVID_ERR_NULL ? 0 : 1;
}
END_C

# report WHAT: prints "ok" or "not ok" by the status of the last command.
report() {
    if [ $? = 0 ]; then echo "ok - $1"; else echo "not ok - $1"; fi
}

# compile FILE OUTPUT FLAGS...: compiles a translation unit.
compile() {
    local file=$1 output=$2 compiler=(gcc -std=c11)
    shift 2
    [ "${file##*.}" = c ] || compiler=(g++ -std=c++14)
    "${compiler[@]}" -Wall -Wextra -Werror -Ilib/include "$@" -c -o "$output" "$file"
}

# Ways to build and link: compiler flags, linker flags, and the library.
dead=(-Os -ffunction-sections -fdata-sections)
ar rc "$scratch/objects.a" build/release/lib/src/*/*.o
mkdir "$scratch/sections" "$scratch/lto"
# build NAME FLAGS...: builds the library as $scratch/NAME.a
build() {
    printf '%s\0' lib/src/*/*.c | (cd "$scratch/$1" && shift &&
        xargs -0 -P "$(nproc)" -I {} gcc -std=c11 -I"$OLDPWD/lib/include" "$@" -c "$OLDPWD/{}")
    gcc-ar rc "$scratch/$1.a" "$scratch/$1"/*.o
}
build sections "${dead[@]}"
build lto -O1 -flto

# links WAY FILE FLAGS...: does main, with FILE built with FLAGS, link? As $scratch/program.
links() {
    local way=$1 file=$2 flags=() linker=() library=()
    shift 2
    case $way in
    objects) library=(build/release/lib/src/*/*.o) ;;
    archive) library=("$scratch/objects.a") ;;
    sections) flags=("${dead[@]}") linker=(-Wl,--gc-sections) library=("$scratch/sections.a") ;;
    lto) flags=(-O1 -flto) linker=(-O1 -flto=1) library=("$scratch/lto.a") ;;
    esac
    compile "$scratch/main.c" "$scratch/main.o" "${flags[@]}" &&
        compile "$scratch/$file" "$scratch/file.o" "${flags[@]}" "$@" &&
        g++ "${linker[@]}" -o "$scratch/program" "$scratch/main.o" "$scratch/file.o" \
            "${library[@]}" >"$scratch/output" 2>&1
}

refused() {
    : >"$scratch/output" # a file that does not compile is not refused by the linker
    ! links "$@" && grep -q 'undefined reference to .auvid_' "$scratch/output"
}

for file in init.c step.c defaults.c model.c model.cpp step.cpp; do
    for way in objects archive sections lto; do
        links $way $file && "$scratch/program"
        report "$file, $way: built like the library it links and runs"
        refused $way $file -DAUVID_MAX_THRUSTERS=6
        report "$file, $way: built with fewer thrusters it does not link"
    done
done

# The sizes that the identifier depends on: those in the AUVID_SIZED macro, each increased by one.
sizes=$(sed -n '/define AUVID_SIZED(name)/,/^$/p' "$config" |
    grep -oE 'AUVID_(MAX|TOKEN)_[A-Z_]*' | sed 's/TOKEN/MAX/')
for file in step.c model.c; do
    for size in $sizes; do
        value=$(echo "$size" | gcc -E -P -Ilib/include -include auvid/config.h -)
        refused archive $file "-D$size=$((value + 1))"
        report "$file: $size differs: does not link"
    done
    refused archive $file -DAUVID_MAX_UNCERTAIN=0 # which is not the token of the default
    report "$file: no uncertain inputs: does not link"
    refused archive $file -DAUVID_REAL_DOUBLE
    report "$file: double beside float: does not link"
done

# The whole library in the caller's translation unit, linked with a file with other sizes.
{
    printf '#include "%s"\n' "$PWD"/lib/src/*/*.c
    cat "$scratch/main.c"
} >"$scratch/unity.c"
unity() {
    gcc -std=c11 -Os -Ilib/include -c -o "$scratch/unity.o" "$scratch/unity.c" &&
        compile "$scratch/model.c" "$scratch/file.o" "$@" &&
        gcc -o "$scratch/program" "$scratch/unity.o" "$scratch/file.o" >"$scratch/output" 2>&1
}
unity && "$scratch/program"
report "a unity build links and runs"
! unity -DAUVID_MAX_COMMANDS=7 && grep -q 'undefined reference to .auvid_build' "$scratch/output"
report "a unity build and a model of other sizes do not link"
