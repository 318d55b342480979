/*
 * Inputs of single thrusters. Their wrench, by the vehicle's thrust maps and allocation, is
 * compared with the motion as that of a log is (doctor_inputs.c). A thruster with the wrong sign,
 * or two that are exchanged or both reversed, explain the accelerations of all degrees of freedom
 * together, if they are the cause. Where a slip changes a single degree of freedom, that one is
 * named. Where thrusters act in a fixed ratio, a slip of one may only scale the wrench: then no
 * motion shows it.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "doctor.h"

#define MIN_LLR 20.0          /* as in doctor_inputs.c */
#define MIN_EXCHANGE_LLR 45.0 /* there are many pairs; strong mismatches reach 42 */
#define MIN_AGAINST 8.0       /* an axis that speaks so much against a slip excludes it */
#define MOST_LEFT 0.875       /* of the residual, by a slip, in one axis at least, .. */
#define MOST_TOLD 0.5    /* .. or what is told explains at most this part of what a slip does */
#define MIN_LEAD 8.0     /* of one thruster over the next one: else both are named */
#define MAX_REST 0.02    /* share of the wrench with a slip that is no multiple of the told one */
#define MIN_SCALING 0.05 /* by which a multiple differs from 1, if it is one */
#define MAX_SCALING 3.0  /* .. and at most: the masses that follow are not so wrong unnoticed */
#define NO_WRENCH 1e-3   /* share of the thrusters' own variances that is no wrench */

enum {
    MEAN = 5,                        /* of GAIN_TERMS */
    NO_SLIP = AUVID_MAX_THRUSTERS,   /* a thruster exchanged with itself */
    EXCHANGES = AUVID_MAX_THRUSTERS, /* first numbers: see slipped */
    DOUBLES = EXCHANGES + AUVID_MAX_THRUSTERS * AUVID_MAX_THRUSTERS,
    SLIPS = DOUBLES + AUVID_MAX_THRUSTERS * AUVID_MAX_THRUSTERS
};

static double effect(const doctor_t *d, int k, int j)
{
    return (double)d->use->allocation.cfg.thruster[k].wrench[j];
}

void doctor_use(doctor_t *d, const log_use_t *use)
{
    int thrusters = log_inputs(use);
    unsigned dofs = use->allocation.cfg.dofs;
    d->use = use;
    d->inputs = CSV_WRENCH;
    for (int j = 0; j < 6; ++j) {
        d->has[CSV_WRENCH + j] = false;
        d->has[CSV_COMMAND + j] = false;
        for (int k = 0; k < thrusters; ++k) {
            bool acts = (dofs == 0 || (dofs >> j & 1u) != 0) && fabs(effect(d, k, j)) > 0.0;
            d->has[CSV_WRENCH + j] = d->has[CSV_WRENCH + j] || acts;
        }
    }
    for (int k = 0; k < thrusters; ++k) {
        d->thruster[k] = NAN;
    }
}

void doctor_thrusters_row(doctor_t *d, csv_row_t *row, double force_N[AUVID_MAX_THRUSTERS])
{
    double wrench[AUVID_DOF_COUNT];
    auvid_real_t thrust[AUVID_MAX_THRUSTERS] = {0};
    bool known = true;
    for (int k = 0; k < log_inputs(d->use); ++k) {
        double now = row->value[log_input(d->use, k)];
        d->thruster[k] = isfinite(now) ? now : d->thruster[k];
        known = known && isfinite(d->thruster[k]);
    }
    double voltage_V = d->has[CSV_VOLTAGE] ? row->value[CSV_VOLTAGE] : 0.0;
    d->voltage_V = isfinite(voltage_V) ? voltage_V : d->voltage_V;
    if (known) {
        log_wrench(d->use, d->thruster, d->voltage_V, wrench, thrust);
    }
    for (int j = 0; j < 6; ++j) {
        row->value[CSV_WRENCH + j] = known ? wrench[j] : NAN;
    }
    for (int k = 0; k < AUVID_MAX_THRUSTERS; ++k) {
        force_N[k] = known ? (double)thrust[k] : NAN;
        d->largest_thrust_N = fmax(d->largest_thrust_N, fabs(force_N[k])); /* NaN does not count */
    }
}

/* The thrusters of a slip, by number: thruster n reversed, or those of pair n - EXCHANGES =
 * i AUVID_MAX_THRUSTERS + k exchanged, or those of n - DOUBLES both reversed. */
static void concerned(int slip, int *one, int *other)
{
    int pair = slip < DOUBLES ? slip - EXCHANGES : slip - DOUBLES;
    *one = slip < EXCHANGES ? slip : pair / AUVID_MAX_THRUSTERS;
    *other = slip < EXCHANGES ? slip : pair % AUVID_MAX_THRUSTERS;
}

/* Wrench per newton told of thruster k in DoF j, with a slip. */
static double slipped(const doctor_t *d, int slip, int k, int j)
{
    int one, other;
    concerned(slip, &one, &other);
    if (slip < EXCHANGES || slip >= DOUBLES) {
        return k == one || k == other ? -effect(d, k, j) : effect(d, k, j);
    }
    return effect(d, k == one ? other : k == other ? one : k, j);
}

/* Can the wrench of DoF j be compared with motion? */
static bool is_compared(const doctor_t *d, const doctor_sums_t *s, int j)
{
    bool moves = d->has[CSV_NU + j] && d->column[CSV_NU + j].changes > 0.0;
    return d->has[CSV_WRENCH + j] && moves && s->count[j] >= 1.0;
}

/* Does a slip change the wrench of DoF j? */
static bool changes(const doctor_t *d, int slip, int j)
{
    bool some = false;
    for (int k = 0; k < log_inputs(d->use); ++k) {
        double change = slipped(d, slip, k, j) - effect(d, k, j);
        some = some || fabs(change) > 0.05 * fabs(effect(d, k, j));
    }
    return some;
}

/* Does a slip change moments of roll and pitch only? Then the others' estimates do not depend on
 * it, and drag or weight that turns the hull may look like it. */
static bool only_tilts(const doctor_t *d, int slip)
{
    bool only = true;
    for (int j = 0; j < 6; ++j) {
        only = only && (j == AUVID_ROLL || j == AUVID_PITCH || !changes(d, slip, j));
    }
    return only;
}

/* Writes the products of the wrench of DoF j, with a slip, with each term. */
static void slip_products(const doctor_t *d, const doctor_sums_t *s, int slip, int j,
                          double products[GAIN_TERMS])
{
    int thrusters = log_inputs(d->use);
    double part[AUVID_MAX_THRUSTERS];
    for (int k = 0; k < thrusters; ++k) {
        part[k] = slipped(d, slip, k, j);
    }
    for (int k = 0; k < thrusters; ++k) {
        for (int a = 1; a < GAIN_TERMS; ++a) {
            products[a] += part[k] * s->thrust[j][k][a];
        }
        for (int i = 0; i < thrusters; ++i) {
            products[0] += part[k] * part[i] * s->both[j][k][i];
        }
    }
}

/* How well a slip explains DoF j, against what is told. Both at one lag, as others are not summed.
 * clear: does what is told explain little beside it? */
static double score_of(const doctor_t *d, const doctor_sums_t *s, int slip, int j, bool *clear)
{
    double products[GAIN_TERMS] = {0};
    doctor_gain_t g, told;
    slip_products(d, s, slip, j, products);
    doctor_regress(s, j, products, &g);
    doctor_regress(s, j, s->own[j][DOCTOR_EARLY + DOCTOR_USUAL], &told);
    double without = told.b > 0.0 ? told.with : told.without;
    double with = g.b > 0.0 && g.drag > 0.0 ? g.with : g.without;
    bool better =
        with < MOST_LEFT * without || told.without - without < MOST_TOLD * (g.without - with);
    *clear = better && doctor_moves(s, j, g.without - with);
    return doctor_gain_ratio(s, j, without, with);
}

/* A slip, and how much better it explains the whole log: columns do not change during a log. */
typedef struct {
    double llr;  /* of all DoF together; 0: it is excluded */
    double rank; /* the same with roll and pitch */
    int slip;
} explained_t;

/* Roll and pitch decide where nothing else changes. Else they only tell which slip it is: of a
 * vehicle that does not use them, any tilt by drag or weight looks like a slip that gives them a
 * moment. */
static explained_t explain_by(const doctor_t *d, const doctor_sums_t *s, int slip)
{
    explained_t found = {.slip = slip};
    bool tilts = only_tilts(d, slip), clear = false;
    for (int j = 0; j < 6; ++j) {
        bool decides = tilts == (j == AUVID_ROLL || j == AUVID_PITCH), clear_here;
        if (!changes(d, slip, j) || !is_compared(d, s, j)) {
            continue;
        }
        double score = score_of(d, s, slip, j, &clear_here);
        if (decides && score < -MIN_AGAINST) {
            return (explained_t){.slip = slip};
        }
        clear = clear || (decides && clear_here);
        found.llr += decides ? score : 0.0;
        found.rank += score;
    }
    return clear && found.llr > 0.0 ? found : (explained_t){.slip = slip};
}

/* Are two thrusters the same, so that to exchange them changes nothing? */
static bool are_equal(const doctor_t *d, int one, int other)
{
    double difference = 0.0, size = 0.0;
    for (int j = 0; j < 6; ++j) {
        difference += d->has[CSV_WRENCH + j] ? fabs(effect(d, one, j) - effect(d, other, j)) : 0.0;
        size += d->has[CSV_WRENCH + j] ? fabs(effect(d, one, j)) : 0.0;
    }
    return !(difference > 0.05 * size);
}

/* Names a slip. */
static void slip_name(const doctor_t *d, int slip, char text[40])
{
    int one, other;
    concerned(slip, &one, &other);
    if (one == other) {
        (void)snprintf(text, 40, "%s", csv_name[log_input(d->use, one)]);
    } else {
        (void)snprintf(text, 40, "%s and %s", csv_name[log_input(d->use, one)],
                       csv_name[log_input(d->use, other)]);
    }
}

/* Do two thrusters act in a DoF together with a further one? Else both reversed are no other slip
 * than a reversed force or velocity of each DoF. */
static bool are_some_of_more(const doctor_t *d, int one, int other)
{
    bool some = false;
    for (int j = 0; j < 6; ++j) {
        bool act = fabs(effect(d, one, j)) > 0.0 || fabs(effect(d, other, j)) > 0.0;
        for (int k = 0; d->has[CSV_WRENCH + j] && act && k < log_inputs(d->use); ++k) {
            some = some || (k != one && k != other && fabs(effect(d, k, j)) > 0.0);
        }
    }
    return some;
}

/* Is this the number of a slip that changes a wrench? */
static bool is_slip(const doctor_t *d, int slip)
{
    int thrusters = log_inputs(d->use), one, other;
    concerned(slip, &one, &other);
    if (one >= thrusters || other >= thrusters || (slip >= EXCHANGES && one >= other)) {
        return false;
    }
    return slip < EXCHANGES ||
           (slip < DOUBLES ? !are_equal(d, one, other) : are_some_of_more(d, one, other));
}

/* Finds the best explanation by slips first .. last - 1, and the next one. */
static void explain(const doctor_t *d, int first, int last, explained_t *best, explained_t *next)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int slip = first; slip < last; ++slip) {
        if (!is_slip(d, slip)) {
            continue;
        }
        explained_t now = explain_by(d, &all, slip);
        if (!(now.llr > 0.0)) {
            continue;
        }
        if (!(best->llr > 0.0) || now.rank > best->rank) {
            *next = *best;
            *best = now;
        } else if (!(next->llr > 0.0) || now.rank > next->rank) {
            *next = now;
        }
    }
}

bool doctor_thrust_is_wrong(const doctor_t *d)
{
    char text[LOG_THRUST_TEXT];
    return d->use != NULL && log_thrust_judge(d->use, d->largest_thrust_N, text, sizeof text) > 0;
}

/* Small forces may be those of one log of several. */
static bool find_size(doctor_t *d)
{
    char text[LOG_THRUST_TEXT];
    int wrong = log_thrust_judge(d->use, d->largest_thrust_N, text, sizeof text);
    if (wrong != 0) {
        doctor_add(d, wrong > 0 ? DOCTOR_ERROR : DOCTOR_WARNING, DOCTOR_SCALE, log_input(d->use, 0),
                   -1, NULL, "%s", text);
    }
    return wrong > 0;
}

/* Do both thrusters act in one DoF? */
static bool act_together(const doctor_t *d, int one, int other)
{
    bool together = false;
    for (int j = 0; j < 6; ++j) {
        together = together || (d->has[CSV_WRENCH + j] && fabs(effect(d, one, j)) > 0.0 &&
                                fabs(effect(d, other, j)) > 0.0);
    }
    return together;
}

/* A thruster that never runs beside one that does: it failed, or its column is not filled. */
static void find_idle(doctor_t *d)
{
    for (int k = 0; k < log_inputs(d->use); ++k) {
        int column = log_input(d->use, k), other = -1;
        for (int i = 0; i < log_inputs(d->use) && other < 0; ++i) {
            bool runs = d->column[log_input(d->use, i)].changes > 0.0;
            other = runs && act_together(d, k, i) ? log_input(d->use, i) : other;
        }
        if (other >= 0 && d->column[column].n > 1.0 && !(d->column[column].changes > 0.0)) {
            doctor_add(d, DOCTOR_WARNING, DOCTOR_STUCK, column, other, NULL,
                       "%s is always %g, but %s changes: if that thruster ran, log its input; "
                       "else leave it out of the vehicle file",
                       csv_name[column], d->column[column].last, csv_name[other]);
        }
    }
}

/* Two reversed thrusters are less likely than one slip. */
static void explain_best(const doctor_t *d, explained_t *best, explained_t *next)
{
    explained_t pair = {.llr = 0.0}, next_pair = {.llr = 0.0};
    explain(d, 0, DOUBLES, best, next);
    explain(d, DOUBLES, SLIPS, &pair, &next_pair);
    if (pair.llr > MIN_EXCHANGE_LLR && pair.rank > best->rank + MIN_LEAD) {
        *best = pair;
        *next = next_pair;
    }
}

/* Names the best explanation, and the next one if that is as good. */
static void add_slip(doctor_t *d, const explained_t *best, const explained_t *next)
{
    bool exchanged = best->slip >= EXCHANGES && best->slip < DOUBLES;
    bool two = best->slip >= DOUBLES;
    bool alike = (next->slip >= EXCHANGES) == (best->slip >= EXCHANGES);
    bool both = next->llr > 0.0 && best->rank - next->rank < MIN_LEAD && alike;
    char name[40], second[40];
    int column = log_input(d->use, 0), one, other, next_one, unused;
    concerned(best->slip, &one, &other);
    concerned(next->slip, &next_one, &unused);
    slip_name(d, best->slip, name);
    slip_name(d, next->slip, second);
    const char *between = !both ? "" : exchanged || two ? ", or " : " or ";
    bool tilts = exchanged && only_tilts(d, best->slip);
    doctor_add(
        d, tilts ? DOCTOR_WARNING : DOCTOR_ERROR,
        exchanged ? DOCTOR_THRUSTER_SWAP : DOCTOR_THRUSTER_SIGN, column + one,
        one != other ? column + other
        : both       ? column + next_one
                     : -1,
        NULL,
        tilts       ? "%s%s%s may be exchanged: roll and pitch follow better if they are exchanged "
                      "again, unless drag or weight turns the hull; the other axes do not depend "
                      "on it"
        : exchanged ? "%s%s%s are exchanged: the motion follows if they are exchanged again: "
                      "exchange the columns, or the thrusters in the vehicle file"
        : two       ? "%s%s%s have the wrong sign: the motion follows if both are reversed: "
                      "change their signs, or their directions in the vehicle file"
                    : "%s%s%s has the wrong sign: the motion follows if it is reversed: "
                      "change its sign, or its direction in the vehicle file",
        name, between, both ? second : "");
}

bool doctor_thrusters(doctor_t *d)
{
    explained_t best = {.llr = 0.0}, next = {.llr = 0.0};
    double axes = 0.0;
    if (find_size(d)) {
        return true;
    }
    find_idle(d);
    explain_best(d, &best, &next);
    for (int j = 0; j < 6; ++j) {
        axes += d->pushed[j].llr;
    }
    if (!(best.llr > (best.slip < EXCHANGES ? MIN_LLR : MIN_EXCHANGE_LLR) && best.llr > axes)) {
        return false;
    }
    if (best.llr < d->world_llr || d->yaw_is_wrong > 0) {
        return false;
    }
    d->in_world = d->in_enu = false; /* which explains less */
    add_slip(d, &best, &next);
    return true;
}

/* Covariance of the wrenches of DoF j with two slips. */
static double covariance(const doctor_t *d, const doctor_sums_t *s, int j, int a, int b)
{
    double sum = 0.0, n = s->count[j];
    for (int k = 0; k < log_inputs(d->use); ++k) {
        for (int i = 0; i < log_inputs(d->use); ++i) {
            double of_thrust =
                s->both[j][k][i] / n - s->thrust[j][k][MEAN] / n * (s->thrust[j][i][MEAN] / n);
            sum += slipped(d, a, k, j) * slipped(d, b, i, j) * of_thrust;
        }
    }
    return sum;
}

/* Sum of the variances of what each thruster does in DoF j. */
static double size_of_parts(const doctor_t *d, const doctor_sums_t *s, int j)
{
    double sum = 0.0, n = s->count[j];
    for (int k = 0; k < log_inputs(d->use); ++k) {
        double mean = s->thrust[j][k][MEAN] / n, part = effect(d, k, j);
        sum += part * part * (s->both[j][k][k] / n - mean * mean);
    }
    return sum;
}

/* Are all wrenches with a slip multiples of those without, so that no motion tells them apart?
 * Returns the DoF in which they are not the same, a bit each; 0: it is not hidden. */
static unsigned hidden(const doctor_t *d, const doctor_sums_t *s, int slip)
{
    unsigned scaled = 0;
    for (int j = 0; j < 6; ++j) {
        if (!is_compared(d, s, j)) {
            continue;
        }
        double told = covariance(d, s, j, NO_SLIP, NO_SLIP), with = covariance(d, s, j, slip, slip);
        double both = covariance(d, s, j, NO_SLIP, slip);
        if (!(fmax(told, with) > NO_WRENCH * size_of_parts(d, s, j))) {
            continue;
        }
        if (!(both > 0.0 && told * with - both * both < MAX_REST * told * with)) {
            return 0;
        }
        double scaling = both / told; /* the masses that follow are wrong by it */
        if (scaling > MAX_SCALING || scaling * MAX_SCALING < 1.0) {
            return 0;
        }
        scaled |= (unsigned)(d->answers[j] && fabs(scaling - 1.0) > MIN_SCALING) << j;
    }
    return scaled;
}

void doctor_thrusters_hidden(doctor_t *d)
{
    char list[200] = "";
    int column = -1;
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int slip = 0; slip < DOUBLES; ++slip) {
        unsigned dofs = is_slip(d, slip) ? hidden(d, &all, slip) : 0;
        size_t used = strlen(list);
        char name[40];
        if (dofs == 0 || used + sizeof name + 12 > sizeof list) {
            continue;
        }
        slip_name(d, slip, name);
        (void)snprintf(list + used, sizeof list - used, "%s%s %s", used > 0 ? ", " : "", name,
                       slip < EXCHANGES ? "reversed" : "exchanged");
        int one, other;
        concerned(slip, &one, &other);
        column = column < 0 ? log_input(d->use, one) : column;
    }
    if (column >= 0) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_THRUSTER_HIDDEN, column, -1, NULL,
                   "the thrusters always act together in this log, so that the motion would not "
                   "show these slips: %s; run each of them alone to see whether it is right",
                   list);
    }
}
