#!/usr/bin/env bash
# A model names its path (vehicle.h). The linker drops the other one, and neither init nor step
# needs any. What is not attached to the identifier is not linked either.
cd "$(dirname "$0")/../.." || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# report NAME [0]: passes if the status of the last command, or the one given, is 0.
report() {
    [ "${2:-$?}" = 0 ] && echo "ok - $1" || echo "not ok - $1"
}

# program NAME PATH FUNCTION SIZES OTHER: main with a model on that path; no PATH: without a model.
program() {
    cat >"$scratch/$1.c" <<END
#include "auvid/identifier.h"
static auvid_identifier_t id;
static auvid_row_t rows[9 * 60];
void residual(const void *c, const auvid_sample_t *s, const auvid_real_t *pi, auvid_real_t *e);
void residual(const void *c, const auvid_sample_t *s, const auvid_real_t *pi, auvid_real_t *e)
{
    (void)c;
    e[AUVID_SURGE] = pi[0] * s->nu_dot[AUVID_SURGE] - s->tau[AUVID_SURGE];
}
void regressor(const void *c, const auvid_sample_t *s, const auvid_real_t *pi,
               auvid_regressor_t *y);
void regressor(const void *c, const auvid_sample_t *s, const auvid_real_t *pi, auvid_regressor_t *y)
{
    (void)c, (void)pi;
    y->row[AUVID_SURGE][0] = s->nu_dot[AUVID_SURGE];
}
int main(void)
{
    static const auvid_parameter_t mass = {"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS};
    static const auvid_vehicle_t mine = {.built_for = AUVID_BUILD, .parameters = 1,
        .parameter = &mass, .columns = {1}, $2 $3};
    auvid_identifier_config_t cfg;
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    auvid_identifier_defaults(&cfg, &mine);
    cfg.metric.rows = rows;
    cfg.metric.row_slots = sizeof rows / sizeof rows[0];
    auvid_status_t status = auvid_identifier_init(&id, &cfg);
#ifdef CHANGE
    static auvid_change_detector_t change;
    status |= auvid_identifier_attach_change_test(&id, &change);
#endif
    (void)auvid_identifier_step(&id, &in, &out);
    (void)auvid_identifier_work(&id, 100);
    return -(int)status;
}
END
    # shellcheck disable=SC2086
    gcc -std=c11 -Os -ffunction-sections -fdata-sections -Wl,--gc-sections -Ilib/include $4 $5 \
        -o "$scratch/$1" "$scratch/$1.c" "$scratch/lib${4:+0}.a" &&
        nm "$scratch/$1" >"$scratch/$1.nm"
}

library() {
    mkdir "$scratch/lib"
    printf '%s\0' lib/src/*/*.c | xargs -0 -P 2 -I {} sh -c \
        "gcc -std=c11 -Os -ffunction-sections -fdata-sections -ffp-contract=off -Ilib/include \
        -c -o $scratch/lib/\$(basename {} .c).o {}" &&
        ar rcs "$scratch/lib.a" "$scratch/lib"/*.o
}

only_regressor='metric_add_equations|metric_take_row|metric_evaluate_factor|auvid_path_regressor'
only_regressor+='|auvid_start_optimum'
only_residual='metric_add_motion|metric_store_row|metric_sample_cost|metric_begin_samples'
only_residual+='|auvid_path_residual|auvid_metric_linearise_sets'
only_residual+='|auvid_start_newton|auvid_gauss_newton_tell'
only_change='auvid_metric_change|auvid_metric_change_begin|identifier_end_test'
only_change+='|identifier_change_functions'

attached='auvid_(prior|validation|guard|excitation|allocation|adaptive)_.*|simulate_cell'

# holds NAME PATTERN COUNT: so many of these symbols are in the program.
holds() {
    [ "$(grep -cE " ($2)(_|\$)" "$scratch/$1.nm")" = "$3" ]
}

library
report "the library is built"
program linear '.path = &auvid_path_regressor,' '.regressor = regressor'
report "a linear model links"
holds linear "$only_regressor" 5
report "  with all of its path"
holds linear "$only_residual" 0
report "  and nothing of the residual path"
holds linear "$only_change" 0
report "  and nothing of the change test"
holds linear "$attached" 0
report "  nor of the prior, the simulation and the acting half"
"$scratch/linear"
report "  it initialises"
program tested '.path = &auvid_path_regressor,' '.regressor = regressor' "" -DCHANGE
holds tested "$only_change" 4
report "with a change test attached all of it is linked"
"$scratch/tested"
report "  and it initialises"
program other '.path = &auvid_path_residual,' '.residual = residual'
report "a model on the residual path links"
holds other "$only_residual" 8
report "  with all of its path"
holds other "$only_regressor" 0
report "  and nothing of the regressor path"
"$scratch/other"
report "  it initialises"
program none '' '.residual = residual'
holds none "$only_regressor|$only_residual" 0
report "without a path nothing of either is linked"
"$scratch/none"
[ $? = 16 ]
report "  and the model is refused (AUVID_ERR_MODEL)"
# In this one nothing is dropped: one translation unit takes a tenth of the time.
printf '#include "%s"\n' lib/src/*/*.c |
    gcc -std=c11 -ffp-contract=off -DAUVID_MAX_COMMANDS=0 -Ilib/include -I. \
        -c -o "$scratch/lib0.o" -xc - && ar rcs "$scratch/lib0.a" "$scratch/lib0.o"
program small '.path = &auvid_path_residual,' '.residual = residual' -DAUVID_MAX_COMMANDS=0
"$scratch/small"
[ $? = 10 ]
report "without memory for the residual path its models are refused (AUVID_ERR_SIZE)"
