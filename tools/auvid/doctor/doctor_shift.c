/*
 * Inputs that are early or late against the motion, by the regression of doctor_inputs.c with the
 * input at other lags.
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define MIN_EACH 8.0 /* as in doctor_inputs.c */
#define MIN_SHIFT_LLR 25.0
#define SHIFT_PER_WINDOW 0.05
#define FIRST_LAG (DOCTOR_EARLY - 1) /* usual lags */
#define LAST_LAG (DOCTOR_EARLY + DOCTOR_MOST_USUAL)
#define SHORT_LAG (DOCTOR_EARLY + 1) /* usual lags that fit finds in any log */
#define USUAL_S 0.15                 /* motion may lead by this: stamps */
#define USUAL_LAG_S 0.1              /* .. and follows its input by this */
#define FOUND_EARLY_S 0.45           /* fit finds the delay of motion that leads by less .. */
#define FOUND_LATE_S 0.85            /* .. or follows by less */
#define MIN_LATE_S 0.25 /* of velocities against r: more than filters of sensors need */
#define EARLY_S (DOCTOR_EARLY * DOCTOR_CELL_S)

enum { LAGS = DOCTOR_EARLY + DOCTOR_LATE + 1 };

/* Of all DoF together, because all inputs have one clock. which: lag [cells] + DOCTOR_EARLY. */
static double shift_score(const doctor_t *d, const doctor_sums_t *s, int unused, int *which)
{
    double score[DOCTOR_EARLY + DOCTOR_LATE + 1] = {0}, best = 0.0;
    (void)unused;
    for (int j = 0; j < 6; ++j) {
        double clean, against;
        doctor_gain_t g;
        if (!doctor_has_input(d, j) || s->count[j] < 1.0) {
            continue;
        }
        doctor_usual(s, j, &clean, &against, &g);
        clean = fmin(clean, doctor_reversed(s, j, DOCTOR_FEEDBACK_FIRST, DOCTOR_FEEDBACK_LAST));
        for (int k = 0; k <= DOCTOR_EARLY + DOCTOR_LATE; ++k) {
            doctor_regress(s, j, s->own[j][k], &g);
            score[k] +=
                doctor_gain_ratio(s, j, clean, g.b > 0.0 && g.drag > 0.0 ? g.with : g.without);
        }
    }
    for (int k = 0; k <= DOCTOR_EARLY + DOCTOR_LATE; ++k) {
        if ((k < FIRST_LAG || k > LAST_LAG) && score[k] > best) {
            best = score[k];
            *which = k;
        }
    }
    return best;
}

/* Least ratio for a shift: it explains more than a controller, whose output is also correlated with
 * motion far from the usual lags. */
static double least_shift(const doctor_t *d, const doctor_range_t *range)
{
    doctor_sums_t sum;
    double windows = 0.0;
    doctor_sum(d, range->first, range->last, &sum);
    for (int j = 0; j < 6; ++j) {
        windows += doctor_has_input(d, j) ? sum.count[j] / DOCTOR_WINDOW : 0.0;
    }
    return SHIFT_PER_WINDOW * windows;
}

/* Which velocities follow their shifted inputs? */
static void shift_answers(doctor_t *d, const doctor_range_t *range)
{
    doctor_sums_t sum;
    doctor_sum(d, range->first, range->last, &sum);
    for (int j = 0; j < 6; ++j) {
        doctor_gain_t g = {0};
        if (doctor_has_input(d, j)) {
            doctor_regress(&sum, j, sum.own[j][range->which], &g);
        }
        d->answers[j] =
            g.b > 0.0 && g.drag > 0.0 && doctor_gain_ratio(&sum, j, g.without, g.with) > MIN_EACH;
    }
}

/* How well the inputs of DoF first .. last explain the whole log at each lag, and the best lag from
 * the usual ones on. driven: the inputs move the vehicle there, all DoF together. */
static int best_lag(const doctor_t *d, int first, int last, double score[LAGS], bool *driven)
{
    doctor_sums_t all;
    int best = FIRST_LAG;
    double windows = 0.0;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int j = first; j <= last; ++j) {
        windows += doctor_has_input(d, j) ? all.count[j] / DOCTOR_WINDOW : 0.0;
    }
    for (int k = 0; k < LAGS; ++k) {
        score[k] = 0.0;
        for (int j = first; j <= last; ++j) {
            doctor_gain_t g;
            if (doctor_has_input(d, j) && all.count[j] >= 1.0) {
                doctor_regress(&all, j, all.own[j][k], &g);
                double with = g.b > 0.0 && g.drag > 0.0 ? g.with : g.without;
                score[k] += doctor_gain_ratio(&all, j, g.without, with);
            }
        }
        best = k > FIRST_LAG && score[k] > score[best] ? k : best;
    }
    *driven = score[best] > DOCTOR_DRIVEN * windows;
    return best;
}

/* The inputs have one clock, and all velocities follow them equally: if they do not, a part of them
 * has other time stamps. */
bool doctor_late_velocity(doctor_t *d)
{
    double velocity[LAGS], rate[LAGS];
    bool moved, turned;
    int of_velocity = best_lag(d, 0, 2, velocity, &moved);
    int of_rate = best_lag(d, 5, 5, rate, &turned);
    double later_s = (of_velocity - of_rate) * DOCTOR_CELL_S;
    bool differ = fmin(velocity[of_velocity] - velocity[of_rate],
                       rate[of_rate] - rate[of_velocity]) > MIN_SHIFT_LLR;
    if (!differ || !moved || !turned || fabs(later_s) < MIN_LATE_S) {
        return false;
    }
    bool late = later_s > 0.0;
    doctor_finding_t *f = doctor_add(
        d, DOCTOR_WARNING, DOCTOR_VELOCITY_SHIFT, late ? CSV_NU : CSV_NU + 5,
        late ? CSV_NU + 5 : CSV_NU, NULL,
        "%s later than %s by %.1f s: the time stamps of %s are late: give each column the time at "
        "which it was measured",
        late ? "u_mps, v_mps, w_mps are" : "r_radps is", late ? "r_radps" : "u_mps, v_mps, w_mps",
        fabs(later_s), late ? "the DVL" : "the gyroscope");
    if (f != NULL) {
        f->value = later_s;
    }
    return true;
}

bool doctor_shift(doctor_t *d, double sign_llr)
{
    doctor_range_t r = doctor_scan(d, shift_score, 0);
    char where[48];
    double lag_s = (r.which - DOCTOR_EARLY) * DOCTOR_CELL_S;
    /* Between rows the input is not known. */
    double row_s = doctor_interval_quantile(d, 0.5), late_s = LAST_LAG * DOCTOR_CELL_S;
    bool usual = lag_s > -USUAL_S - row_s && lag_s < late_s - EARLY_S + row_s;
    bool stays = r.first == 0 || r.last == d->blocks - 1; /* a clock is set, but not set back */
    bool likely = r.llr > fmax(MIN_SHIFT_LLR, least_shift(d, &r)) && !(r.llr < sign_llr);
    if (!likely || !stays || usual) {
        return false;
    }
    bool whole = doctor_where(d, &r, where)[0] == '\0';
    bool found = lag_s > -FOUND_EARLY_S && lag_s < FOUND_LATE_S;
    doctor_finding_t *f =
        doctor_add(d, whole || found ? DOCTOR_WARNING : DOCTOR_ERROR, DOCTOR_INPUT_SHIFT, d->inputs,
                   CSV_NU, &r,
                   "the velocities %s their inputs by %.1f s%s, %s%s: give all columns the time at "
                   "which they were measured",
                   lag_s < 0.0 ? "change before" : "follow", fabs(lag_s), where,
                   lag_s < 0.0 ? "which no vehicle does" : "more than thrusters need",
                   whole ? "; fit shifts the inputs by that" : "");
    if (f != NULL) {
        f->value = lag_s;
    }
    if (whole) {
        d->shift_s = lag_s - USUAL_LAG_S;
        shift_answers(d, &r);
    }
    return true;
}

/* A lag that is usual, but long: fit finds it only where the disturbances are small. */
void doctor_long_lag(doctor_t *d)
{
    doctor_range_t all = {.last = d->blocks - 1};
    doctor_sums_t sum;
    double score[LAST_LAG + 3] = {0};
    int best = SHORT_LAG;
    doctor_sum(d, all.first, all.last, &sum);
    for (int j = 0; j < 6; ++j) {
        double of_short = HUGE_VAL;
        for (int k = FIRST_LAG; doctor_has_input(d, j) && k <= LAST_LAG + 2; ++k) {
            doctor_gain_t g;
            doctor_regress(&sum, j, sum.own[j][k], &g);
            double with = g.b > 0.0 && g.drag > 0.0 ? g.with : g.without;
            of_short = k <= SHORT_LAG ? fmin(of_short, with) : of_short;
            score[k] += k > SHORT_LAG ? doctor_gain_ratio(&sum, j, of_short, with) : 0.0;
        }
    }
    for (int k = SHORT_LAG + 1; k <= LAST_LAG + 2; ++k) {
        best = score[k] > score[best] ? k : best;
    }
    if (score[best] > fmax(MIN_SHIFT_LLR, least_shift(d, &all))) {
        double lag_s = (best - DOCTOR_EARLY) * DOCTOR_CELL_S;
        doctor_finding_t *f = doctor_add(
            d, DOCTOR_NOTE, DOCTOR_INPUT_SHIFT, d->inputs, CSV_NU, &all,
            "the velocities follow their inputs by %.1f s; fit shifts the inputs by that", lag_s);
        if (f != NULL) {
            f->value = lag_s;
        }
        d->shift_s = lag_s - USUAL_LAG_S;
    }
}
