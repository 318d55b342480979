/*
 * The rates of depth and position against the velocity, turned into their axes; by concordance, as
 * in doctor_attitude.c. A constant offset, such as a vertical current, does not matter.
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define MIN_LLR 12.0
#define MIN_RATE                                                                                   \
    0.05 /* rms [m/s]: a sensor that is mounted 2 degrees askew gives 0.02 at 0.5 m/s */
#define MAX_DISCORD 0.5
#define ABOVE_M 1.0 /* further above the surface a vehicle cannot be */
#define ALIKE 0.8   /* correlation of velocities that agree */
#define UNLIKE 0.5  /* .. and of those that do not */
#define WINDOW_CELLS (2 * DOCTOR_WINDOW)

#define SURE 0.86 /* correlation that shows the unit: of two slopes, one is 1.35 of the other */
#define TOLERANCE 0.08 /* of a unit */
#define LEAST 1e-9     /* of a residual, as in doctor_discord */

/* Units of a depth, or of the pressure of sea water; one of fresh water is 2.5 % lighter. */
static const struct {
    double in_a_metre;
    const char *name, *times;
} unit[] = {{3.2808, "feet", "0.3048"},
            {100.0, "centimetres or millibars", "0.01"},
            {1000.0, "millimetres", "0.001"},
            {0.1, "bars", "10"},
            {10.0, "decimetres or kilopascals", "0.1"}};
enum { DEPTH_UNITS = sizeof unit / sizeof unit[0] };

enum { ONE, FROM_U, FROM_V, FROM_W, DEPTH_RATE, TOGETHER };

/* Signs of the parts from u, v, w. */
enum {
    AS_TOLD,
    HEAVE_REVERSED,
    PITCH_REVERSED = DOCTOR_PITCH_REVERSED,
    DEPTH_REVERSED,
    DEPTH_CASES
};
static const double depth_sign[DEPTH_CASES][3] = {
    {1.0, 1.0, 1.0}, {1.0, 1.0, -1.0}, {-1.0, 1.0, 1.0}, {-1.0, -1.0, -1.0}};

/* The rate of the depth, of which this is a metre, and that of the velocities with these signs. */
static doctor_pair_t depth_pair(const doctor_sums_t *s, const double sign[3], double metre)
{
    doctor_pair_t p = {.n = s->depth[ONE][ONE],
                       .a = s->depth[ONE][DEPTH_RATE] / metre,
                       .aa = s->depth[DEPTH_RATE][DEPTH_RATE] / (metre * metre)};
    for (int i = 0; i < 3; ++i) {
        p.b += sign[i] * s->depth[ONE][FROM_U + i];
        p.ab += sign[i] * s->depth[DEPTH_RATE][FROM_U + i] / metre;
        for (int j = 0; j < 3; ++j) {
            p.bb += sign[i] * sign[j] * s->depth[FROM_U + i][FROM_U + j];
        }
    }
    return p;
}

doctor_pair_t doctor_depth(const doctor_t *d, const doctor_sums_t *s)
{
    return depth_pair(s, depth_sign[AS_TOLD], d->depth_scale);
}

bool doctor_depth_has_other_unit(const doctor_t *d)
{
    return fabs(d->depth_scale - 1.0) > 0.0;
}

bool doctor_is_fast(const doctor_pair_t *p)
{
    double n = fmax(p->n, 1.0), least = MIN_RATE * MIN_RATE * n;
    return p->aa - p->a * p->a / n > least && p->bb - p->b * p->b / n > least;
}

/* An error of scale, such as that of cells that are zero between samples, may be smaller with other
 * signs. So an explanation must also be better if each one has its best scale: then 1 - correlation
 * is the concordance. */
static double depth_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    doctor_pair_t clean = doctor_depth(d, s);
    double best = 0.0, clean_scaled = fmax(1.0 - doctor_correlation(&clean), LEAST);
    (void)axis;
    for (int k = 1; k < DEPTH_CASES; ++k) {
        doctor_pair_t p = depth_pair(s, depth_sign[k], d->depth_scale);
        double discord = doctor_discord(&p, 1.0), windows = p.n / WINDOW_CELLS;
        double scaled = fmax(1.0 - doctor_correlation(&p), LEAST);
        double llr = fmin(doctor_ratio(windows, doctor_discord(&clean, 1.0), discord),
                          doctor_ratio(windows, clean_scaled, scaled));
        if (llr > best && discord < MAX_DISCORD && doctor_is_fast(&p)) {
            best = llr;
            *which = k;
        }
    }
    return best;
}

/* The unit of depth_m, by the scale of its rate against the velocities, with the signs that fit
 * best. The scale lies between two slopes. */
static double depth_unit(const doctor_t *d, const doctor_sums_t *all)
{
    doctor_pair_t best = doctor_depth(d, all);
    for (int k = 1; k < DEPTH_CASES; ++k) {
        doctor_pair_t p = depth_pair(all, depth_sign[k], d->depth_scale);
        best = doctor_correlation(&p) > doctor_correlation(&best) ? p : best;
    }
    double n = fmax(best.n, 1.0), aa = best.aa - best.a * best.a / n;
    double bb = best.bb - best.b * best.b / n, scale = sqrt(aa / bb);
    bool sure = best.n > DOCTOR_MIN_WINDOWS * WINDOW_CELLS && bb > MIN_RATE * MIN_RATE * n &&
                doctor_correlation(&best) > SURE;
    for (int k = 0; sure && k < DEPTH_UNITS; ++k) {
        if (fabs(scale / unit[k].in_a_metre - 1.0) < TOLERANCE) {
            return unit[k].in_a_metre;
        }
    }
    return 1.0;
}

static double ground_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    const doctor_pair_t *p = &s->ground[0][axis][axis];
    (void)d;
    *which = 0;
    return doctor_is_fast(p)
               ? doctor_ratio(p->n / WINDOW_CELLS, doctor_discord(p, 1.0), doctor_discord(p, -1.0))
               : 0.0;
}

bool doctor_depth_reverses_surge(const doctor_t *d)
{
    bool attitude = d->turned[1].llr > 0.0 || d->turned[2].llr > 0.0 || d->mirrored.llr > 0.0;
    return d->sunk.llr > 0.0 && d->sunk.which == PITCH_REVERSED && !attitude;
}

static bool has_depth(const doctor_t *d)
{
    return !d->reordered && !d->degrees && !d->in_world && d->has[CSV_POSITION + 2] &&
           d->has[CSV_NU + 2];
}

static bool has_position(const doctor_t *d)
{
    bool sound = !d->reordered && !d->degrees && !doctor_depth_has_other_unit(d);
    return sound && !d->in_world && d->has[CSV_POSITION] && d->has[CSV_POSITION + 1] &&
           d->has[CSV_ATTITUDE + 2] && d->has[CSV_NU] && d->has[CSV_NU + 1];
}

int doctor_position_turns(const doctor_t *d, double angle)
{
    doctor_sums_t all;
    double product[2][2];
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int i = 0; i < 4; ++i) {
        const doctor_pair_t *p = &all.ground[0][i / 2][i % 2];
        product[i / 2][i % 2] = p->ab - p->a * p->b / fmax(p->n, 1.0);
    }
    bool known = has_position(d) && doctor_is_fast(&all.ground[0][0][0]) &&
                 doctor_is_fast(&all.ground[0][1][1]);
    /* The sums of squares of velocities and of rates do not depend on the angle. */
    double as_told = product[0][0] + product[1][1];
    double turned = cos(angle) * as_told + sin(angle) * (product[1][0] - product[0][1]);
    return !known ? 0 : turned > as_told ? 1 : -1;
}

double doctor_position_mirrored(const doctor_t *d)
{
    doctor_sums_t all;
    double sum = 0.0;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int i = 0; i < 2 && has_position(d); ++i) {
        const doctor_pair_t *p = &all.ground[0][i][i];
        if (doctor_is_fast(p)) {
            sum += doctor_ratio(p->n / WINDOW_CELLS, doctor_discord(p, 1.0),
                                doctor_discord(&all.ground[1][i][i], 1.0));
        }
    }
    return sum;
}

void doctor_travel_scan(doctor_t *d)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    if (has_depth(d)) {
        d->depth_scale = !doctor_velocity_drops(d) ? depth_unit(d, &all) : 1.0;
        d->sunk = doctor_scan(d, depth_score, 0);
    }
    for (int i = 0; i < 2 && has_position(d); ++i) {
        d->gone[i] = doctor_scan(d, ground_score, i);
        d->gone[i].llr = d->gone[i].llr > MIN_LLR ? d->gone[i].llr : 0.0;
    }
    d->sunk.llr = d->sunk.llr > MIN_LLR ? d->sunk.llr : 0.0;
}

/* The sign of depth against heave velocity. If the latter follows its input, depth may be wrong, or
 * heave and its input, alone or with all other columns of a log in axes with z up. */
static void find_depth(doctor_t *d)
{
    const doctor_range_t *r = &d->sunk;
    char where[48];
    bool named = fabs(d->mounted) > 0.0 || doctor_overlap(r, &d->pushed[0]) ||
                 doctor_has_finding(d, DOCTOR_VELOCITY_EXCHANGED, CSV_NU);
    if (!(r->llr > 0.0) || d->pushed[2].llr > 0.0 || (r->which == PITCH_REVERSED && named)) {
        return; /* the latter two: see doctor_inputs.c */
    }
    doctor_where(d, r, where);
    if (r->which == PITCH_REVERSED &&
        (d->turned[1].llr > 0.0 || d->turned[2].llr > 0.0 || d->mirrored.llr > 0.0)) {
        return; /* see doctor_attitude.c, doctor_mirror.c */
    }
    if (r->which == PITCH_REVERSED) {
        doctor_add(
            d, DOCTOR_ERROR, DOCTOR_ANGLE_SIGN, CSV_ATTITUDE + 1, CSV_NU, r,
            "depth_m changes as w_mps says, but not as theta_rad and u_mps do%s: one of these "
            "two has the wrong sign, or depth_m, w_mps and the heave input are all positive "
            "upwards: change the wrong ones",
            where);
    } else if (d->answers[2]) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, CSV_NU + 2, r,
                   "depth_m changes against w_mps, which follows its input%s: if depth_m is a "
                   "height, change its sign; if w_mps and its input are positive upwards, give "
                   "them, and all other columns that are in FLU and ENU axes, in FRD and NED",
                   where);
    } else {
        doctor_add(
            d, DOCTOR_ERROR, DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, CSV_NU + 2, r,
            "depth_m changes against w_mps%s: one of them is positive upwards: change its sign",
            where);
    }
}

static void find_unit(doctor_t *d)
{
    for (int k = 0; k < DEPTH_UNITS && doctor_depth_has_other_unit(d); ++k) {
        if (!(fabs(d->depth_scale - unit[k].in_a_metre) > 0.0)) {
            doctor_add(d, DOCTOR_WARNING, DOCTOR_SCALE, CSV_POSITION + 2, CSV_NU + 2, NULL,
                       "depth_m changes %.4g times as fast as u_mps, v_mps and w_mps say, as if in "
                       "%s: convert it to metres (times %s)",
                       unit[k].in_a_metre, unit[k].name, unit[k].times);
        }
    }
}

static bool contradicts(const doctor_pair_t *p)
{
    double n = p->n / WINDOW_CELLS, c = doctor_correlation(p);
    double aa = p->aa - p->a * p->a / fmax(p->n, 1.0), bb = p->bb - p->b * p->b / fmax(p->n, 1.0);
    if (n < DOCTOR_MIN_WINDOWS || !doctor_is_fast(p)) {
        return false;
    }
    double error = 5.0 / sqrt(n), ab = c * sqrt(bb / aa), ba = c * sqrt(aa / bb);
    return ab + error * sqrt(bb / aa) < 0.5 && ba + error * sqrt(aa / bb) < 0.5;
}

/* Does the position change as the velocity says only after a reflection: of east, or that of NED
 * into ENU? No other heading does that. psi reversed turns the reflected position. */
static bool is_reflected(const doctor_sums_t *s)
{
    const doctor_pair_t(*as_told)[2] = s->ground[0], (*p)[2] = s->ground[1];
    bool of_east = doctor_correlation(&p[0][0]) > ALIKE && doctor_correlation(&p[1][1]) < -ALIKE;
    bool agrees =
        doctor_correlation(&as_told[0][0]) > UNLIKE && doctor_correlation(&as_told[1][1]) > UNLIKE;
    bool exchanged = doctor_correlation(&p[0][1]) > ALIKE && doctor_correlation(&p[1][0]) > ALIKE;
    return p[0][0].n > DOCTOR_MIN_WINDOWS * WINDOW_CELLS && !agrees && (of_east || exchanged);
}

/* A log in which all is of axes with z up does not contradict itself. */
static void find_height(doctor_t *d)
{
    const doctor_column_t *c = &d->column[CSV_POSITION + 2];
    if (has_depth(d) && !(d->sunk.llr > 0.0) && c->n > 0.0 && c->max < -ABOVE_M * d->depth_scale) {
        doctor_add(
            d, DOCTOR_WARNING, DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, CSV_NU + 2, NULL,
            "depth_m is negative in all rows (%.1f to %.1f), above the surface: if it is a height, "
            "see whether the log is in axes with z up (ENU, FLU): give all columns in NED and FRD",
            c->min, c->max);
    }
}

/* Position against velocity. A velocity that runs against its input, too, is named there. */
static void find_position(doctor_t *d, const doctor_sums_t *all)
{
    bool named = d->turned[2].llr > 0.0 || d->yaw_is_wrong > 0;
    for (int i = 0; i < 2; ++i) {
        named = named || (d->gone[i].llr > 0.0 && d->pushed[i].llr > 0.0);
    }
    bool reflected = is_reflected(all);
    if (named || !has_position(d) ||
        !(reflected || contradicts(&all->ground[0][0][0]) || contradicts(&all->ground[0][1][1]))) {
        return;
    }
    bool reversed = doctor_correlation(&all->ground[1][0][0]) > ALIKE &&
                    doctor_correlation(&all->ground[1][1][1]) > ALIKE;
    doctor_add(d, DOCTOR_WARNING, DOCTOR_POSITION, CSV_POSITION, CSV_NU, NULL,
               "north_m, east_m and the velocity contradict each other%s",
               reversed ? "; they agree if the sign of psi_rad or of east_m is changed"
               : reflected
                   ? ", as if one were in NED and FRD axes (z down), the other in ENU and FLU (z "
                     "up): give all columns in NED and FRD"
                   : ", unexplained: see whether they are north and east");
}

void doctor_travel(doctor_t *d)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    find_unit(d);
    int before = d->findings;
    find_depth(d);
    bool turned = fabs(d->mounted) > 0.0; /* u and v contradict depth and position */
    if (has_depth(d) && d->findings == before && !(d->sunk.llr > 0.0) && !turned) {
        doctor_pair_t p = doctor_depth(d, &all);
        if (contradicts(&p)) {
            doctor_add(
                d, DOCTOR_WARNING, DOCTOR_DEPTH, CSV_POSITION + 2, CSV_NU + 2, NULL,
                "depth_m and the velocity contradict each other (correlation %.2f), unexplained: "
                "see whether they are of the same vehicle, time and axis",
                doctor_correlation(&p));
        }
    }
    find_height(d);
    if (!turned) {
        find_position(d, &all);
    }
}
