#include "field_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../report/report.h"
#include "../report/statistics.h"

const double field_limit[FIELD_LIMITS] = {0.10, 0.15, 0.20, 0.25, 0.30, 0.40};

/* The limits, including that of the library. */
#define OWN_LIMIT 0.20

/* Error probability of an interval. */
#define ALPHA 0.05

static int class_of(int i)
{
    return i < SIM_WB               ? FIELD_MASSES
           : i == SIM_WB            ? FIELD_WEIGHT
           : (i - SIM_X_U) % 2 == 0 ? FIELD_LINEAR
                                    : FIELD_QUADRATIC;
}

/* Force error of parameter i at the largest motion of the run. */
static double error_force(const field_record_t *record, int i, double error)
{
    int e = field_equation(i);
    const field_reference_t *t = &record->truth;
    double speed = fmax(t->speed[e][0], t->speed[e][1]);
    switch (class_of(i)) {
    case FIELD_MASSES:
        return error * t->acceleration[e];
    case FIELD_LINEAR:
        return error * speed;
    case FIELD_QUADRATIC:
        return error * speed * speed;
    default:
        return error;
    }
}

bool field_is_wrong(const field_record_t *record, int i, const double *truth)
{
    double error = fabs(record->pi[i] - truth[i]);
    bool matters =
        !(error_force(record, i, error) <= FIELD_WRONG_FORCE * record->tau_max[field_equation(i)]);
    return matters && (i == SIM_WB || !(error <= FIELD_WRONG_RELATIVE * fabs(truth[i])));
}

/* ---- one run ---- */

static void add(field_ratio_t *to, double part, double whole)
{
    to->part += part;
    to->whole += whole;
}

/* Adds a result on parameter i to the figures of each of its groups. */
static void answer(field_ratio_t *run, int question, int i, double part)
{
    bool relative = question == FIELD_ERROR || question == FIELD_ERROR_FLAGGED;
    if (!(relative && i == SIM_WB)) {
        add(&run[FIELD_AT(question, FIELD_ALL)], part, 1.0);
    }
    if (i != SIM_WB) {
        add(&run[FIELD_AT(question, FIELD_BUT_WEIGHT)], part, 1.0);
    }
    add(&run[FIELD_AT(question, class_of(i))], part, 1.0);
    add(&run[FIELD_AT(question, FIELD_CLASSES + i)], part, 1.0);
}

static void take_parameter(field_ratio_t *run, const field_record_t *record, int i)
{
    double error = record->pi[i] - record->truth.si[i], off = fabs(error);
    double reported = fabs(record->pi[i] - record->truth.reported[i]);
    double scale = i == SIM_WB ? record->tau_max[field_equation(i)] : record->truth.si[i];
    double sigma = record->sigma[i], relative = error / scale;
    answer(run, FIELD_FLAGGED, i, record->flagged[i]);
    if (record->estimated[i]) {
        answer(run, FIELD_ERROR, i, relative * relative);
    }
    if (isfinite(sigma)) {
        answer(run, FIELD_WITHIN_1, i, off <= sigma);
        answer(run, FIELD_WITHIN_2, i, off <= 2.0 * sigma);
    }
    if (record->flagged[i]) {
        bool wrong = field_is_wrong(record, i, record->truth.si);
        answer(run, FIELD_WRONG, i, wrong);
        answer(run, FIELD_BEYOND, i, !(off <= HALF_WIDTH * sigma));
        answer(run, FIELD_OVER_SIGMA, i, error * error / (sigma * sigma));
        answer(run, FIELD_ERROR_FLAGGED, i, relative * relative);
        answer(run, FIELD_TOLD_WRONG, i, field_is_wrong(record, i, record->truth.reported));
        answer(run, FIELD_TOLD_BEYOND, i, !(reported <= HALF_WIDTH * sigma));
    }
}

/* Adds drag force k, d, at a speed that the vehicle has reached. */
static void take_force(field_ratio_t *to, const field_record_t *record, int k, int d,
                       const field_force_t *force, const double *parameter)
{
    int e = d / 2;
    double speed = field_part[k] * record->truth.speed[e][d % 2];
    double truth = field_drag(parameter, e, d % 2 == 0 ? speed : -speed);
    double error = fabs(force->value - truth);
    bool off = !(error <= FIELD_WRONG_RELATIVE * fabs(truth));
    if (!(speed > 0.0)) {
        return;
    }
    add(&to[FIELD_FORCE_FLAGGED * FIELD_PARTS], force->flagged, 1.0);
    if (force->estimated) {
        add(&to[FIELD_FORCE_OFF * FIELD_PARTS], off, 1.0);
    }
    if (isfinite(force->half)) {
        add(&to[FIELD_FORCE_WITHIN * FIELD_PARTS], error <= force->half, 1.0);
    }
    if (force->flagged) {
        bool matters = !(error <= FIELD_WRONG_FORCE * record->tau_max[e]);
        add(&to[FIELD_FORCE_WRONG * FIELD_PARTS], off && matters, 1.0);
        add(&to[FIELD_FORCE_BEYOND * FIELD_PARTS], !(error <= force->half), 1.0);
    }
}

/* Is an estimate in the equation of parameter i impossible? */
static bool is_discredited(const field_record_t *record, int i)
{
    bool found = false;
    for (int k = 0; k < SIM_PARAMETERS; ++k) {
        found = found || (record->impossible[k] && field_equation(k) == field_equation(i));
    }
    return found;
}

/* Would parameter i be flagged with another limit of the half-width? The flags of a narrower limit
 * are a subset of those of a wider one. W-B has a limit of its own. */
static bool is_flagged_at(const field_record_t *record, int i, double limit)
{
    bool narrow = HALF_WIDTH * record->sigma[i] <= limit * fabs(record->pi[i]);
    if (record->flagged[i]) {
        return i == SIM_WB || limit >= OWN_LIMIT || narrow;
    }
    switch ((auvid_note_t)record->note[i]) {
    case AUVID_NOTE_FIXED:
    case AUVID_NOTE_NOT_EXCITED:
    case AUVID_NOTE_AT_BOUND:
    case AUVID_NOTE_BESIDE_BOUND:
    case AUVID_NOTE_NOT_CONVERGED:
    case AUVID_NOTE_FEEDBACK:
        return false;
    case AUVID_NOTE_IMPLAUSIBLE:
    case AUVID_NOTE_DISCREDITED:
    case AUVID_NOTE_NONE:
    case AUVID_NOTE_NOISE:
    case AUVID_NOTE_SMALL:
    case AUVID_NOTE_UNCERTAIN:
    case AUVID_NOTE_COMBINATION:
    case AUVID_NOTE_THRUST_SCALE:
    case AUVID_NOTE_UNCHECKED:
    case AUVID_NOTE_INPUTS:
    case AUVID_NOTE_COUNT:
    default:
        return i != SIM_WB && limit > OWN_LIMIT && narrow && !is_discredited(record, i);
    }
}

static void take_curve(field_ratio_t *run, const field_record_t *record, int k)
{
    field_ratio_t *flagged = run + FIELD_AT_CURVE + k, *wrong = flagged + FIELD_LIMITS;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        bool flag = is_flagged_at(record, i, field_limit[k]);
        add(flagged, flag, 1.0);
        if (flag) {
            add(wrong, field_is_wrong(record, i, record->truth.si), 1.0);
        }
    }
}

void field_table_add(field_table_t *table, const field_record_t *record)
{
    field_ratio_t *run = table->each + (size_t)table->runs++ * FIELD_FIGURES;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        take_parameter(run, record, i);
        for (int note = 0; note < FIELD_NOTES; ++note) {
            add(&run[FIELD_AT_NOTE + note], record->note[i] == note, 1.0);
        }
    }
    for (int k = 0; k < FIELD_PARTS; ++k) {
        for (int d = 0; d < FIELD_DIRECTIONS; ++d) {
            take_force(run + FIELD_AT_FORCE + k, record, k, d, &record->force[k][d],
                       record->truth.si);
            take_force(run + FIELD_AT_ONE_WAY + k, record, k, d, &record->one_way[k][d],
                       record->truth.one_way[d % 2]);
        }
    }
    for (int k = 0; k < FIELD_LIMITS; ++k) {
        take_curve(run, record, k);
    }
    add(&run[FIELD_AT_WRONG_RUN], run[FIELD_AT(FIELD_WRONG, FIELD_ALL)].part > 0.0, 1.0);
    add(&run[FIELD_AT_CAPPED_RUN], record->not_converged, 1.0);
}

/* ---- all runs ---- */

bool field_table_begin(field_table_t *table, uint32_t runs)
{
    memset(table, 0, sizeof *table);
    table->room = runs;
    table->each = calloc((size_t)runs * FIELD_FIGURES, sizeof *table->each);
    return table->each != NULL;
}

void field_table_free(field_table_t *table)
{
    free(table->each);
    table->each = NULL;
}

static bool is_rms(int figure)
{
    int question = figure / FIELD_GROUPS;
    return question == FIELD_OVER_SIGMA || question == FIELD_ERROR_FLAGGED ||
           question == FIELD_ERROR;
}

static double value_of(int figure, field_ratio_t sum)
{
    double ratio = sum.part / sum.whole; /* NAN: none */
    return is_rms(figure) ? sqrt(ratio) : ratio;
}

/* P(X <= k) of n at probability p. */
static double binomial(uint32_t k, uint32_t n, double p)
{
    double sum = 0.0;
    for (uint32_t i = 0; i <= k; ++i) {
        double ways = lgamma(n + 1.0) - lgamma(i + 1.0) - lgamma(n - i + 1.0);
        sum += exp(ways + i * log(p) + (n - i) * log1p(-p));
    }
    return sum;
}

/* The probability p at which P(X <= k) falls to a level. */
static double quantile(uint32_t k, uint32_t n, double level)
{
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; ++i) {
        double middle = 0.5 * (low + high);
        *(binomial(k, n, middle) > level ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

void field_clopper_pearson(uint32_t k, uint32_t n, double interval[2])
{
    interval[0] = k == 0 ? 0.0 : quantile(k - 1, n, 1.0 - ALPHA / 2.0);
    interval[1] = k >= n ? 1.0 : quantile(k, n, ALPHA / 2.0);
}

/* Sums all figures over runs drawn with replacement. rng NULL: each run once. */
static void sum_runs(const field_table_t *table, sim_rng_t *rng, field_ratio_t *sum)
{
    memset(sum, 0, FIELD_FIGURES * sizeof *sum);
    for (uint32_t i = 0; i < table->runs; ++i) {
        size_t from = rng == NULL ? i : (size_t)(sim_rng_uniform(rng) * table->runs);
        const field_ratio_t *run = table->each + from * FIELD_FIGURES;
        for (int f = 0; f < FIELD_FIGURES; ++f) {
            add(&sum[f], run[f].part, run[f].whole);
        }
    }
}

/* Interval of figure f from the values of its resamples. */
static void find_interval(field_table_t *table, int f, field_ratio_t sum, double *value)
{
    field_figure_t *to = &table->figure[f];
    double interval[2] = {NAN, NAN};
    size_t known = 0;
    uint32_t runs = 0;
    for (uint32_t i = 0; i < table->runs; ++i) {
        runs += table->each[(size_t)i * FIELD_FIGURES + (size_t)f].whole > 0.0;
    }
    for (size_t k = 0; k < RESAMPLES; ++k) {
        if (!isnan(value[k])) {
            value[known++] = value[k];
        }
    }
    if (f == FIELD_AT_WRONG_RUN || f == FIELD_AT_CAPPED_RUN) {
        field_clopper_pearson((uint32_t)sum.part, runs, interval);
    } else if (!is_rms(f) && runs > 0 && (!(sum.part > 0.0) || sum.part >= sum.whole)) {
        field_clopper_pearson(sum.part > 0.0 ? runs : 0, runs, interval);
    } else if (known > 0) {
        interval[0] = statistics_quantile(value, known, 0.025);
        interval[1] = statistics_quantile(value, known, 0.975);
    }
    to->low = interval[0];
    to->high = interval[1];
}

bool field_table_finish(field_table_t *table, uint64_t seed)
{
    field_ratio_t sum[FIELD_FIGURES], drawn[FIELD_FIGURES];
    double(*value)[RESAMPLES] = malloc(FIELD_FIGURES * sizeof *value);
    sim_rng_t rng;
    if (value == NULL) {
        return false;
    }
    sim_rng_seed(&rng, seed, 0);
    for (int k = 0; k < RESAMPLES; ++k) {
        sum_runs(table, &rng, drawn);
        for (int f = 0; f < FIELD_FIGURES; ++f) {
            value[f][k] = value_of(f, drawn[f]);
        }
    }
    sum_runs(table, NULL, sum);
    for (int f = 0; f < FIELD_FIGURES; ++f) {
        table->figure[f].value = value_of(f, sum[f]);
        table->figure[f].whole = sum[f].whole;
        find_interval(table, f, sum[f], value[f]);
    }
    free(value);
    return true;
}
