/*
 * The rate of the attitude in body axes against p, q, r. Both are noisy, so agreement is measured
 * by concordance (Lin 1989): 1 - R = 2 g cov(a, b) / (var a + g^2 var b) for a gain g. Of two
 * explanations, the logarithm of the ratio of likelihoods is n/2 ln(R_1 / R_2).
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define DEGREES 57.29577951308232 /* in a radian */
#define MIN_LLR 12.0 /* of a slip: chance e^-12 in each of some 500 ranges that overlap */
#define MIN_SHIFT_LLR 20.0
#define MIN_EACH 5.0 /* of each of two exchanged axes */
#define MIN_SHIFT_S 0.08
#define MIN_AGREEMENT 4.0 /* of a slip, in standard deviations of chance: noise, in hours of rest */
#define BEST_DISCORD 0.02 /* sensors do not agree better; else a range never grows */
#define MAX_EXCHANGED 0.95 /* of exchanged axes */
#define MAX_DISCORD 0.6    /* of a slip, but of the sign of roll or pitch, which may hardly move */
#define MAX_TWO_SLIPS 0.3  /* of a wrong sign beside another slip */
#define STEEP 0.01         /* share of pitch beyond a right angle */

static const char *angle_name(int axis)
{
    return csv_name[CSV_ATTITUDE + axis];
}

static const char *rate_name(int axis)
{
    return csv_name[CSV_NU + 3 + axis];
}

static bool has_pair(const doctor_t *d, int axis)
{
    return d->has[CSV_ATTITUDE + axis] && d->has[CSV_NU + 3 + axis];
}

/* Does an explanation explain more than chance? */
static bool explains(const doctor_pair_t *p, double discord)
{
    return (1.0 - discord) * sqrt(p->n) > MIN_AGREEMENT;
}

static double ratio(const doctor_pair_t *p, double without, double with)
{
    return explains(p, with) ? doctor_ratio(p->n / DOCTOR_WINDOW, without, fmax(with, BEST_DISCORD))
                             : 0.0;
}

/* Of the better sign: a second slip must not hide the first. */
static double of_either_sign(const doctor_pair_t *p, double gain)
{
    return fmin(doctor_discord(p, gain), doctor_discord(p, -gain));
}

static double sign_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    const doctor_pair_t *p = &s->turn[0][axis][axis];
    double with = doctor_discord(p, -1.0);
    (void)d;
    *which = 0;
    return axis == 2 && with > MAX_DISCORD ? 0.0 : ratio(p, doctor_discord(p, 1.0), with);
}

/* The same of roll or pitch, which the turn changes, too. A reversed heading, or another angle that
 * is reversed with its rate, reverses that part (doctor_mirror.c). In a vehicle that hardly rolls
 * it is the larger part, and roll alone would seem reversed. So both readings are compared, each
 * with what it leaves in the other axis, whatever the sign of that. */
static double tilt_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    static const int reading[2] = {0, 2};
    int other = 1 - axis;
    double with = 1.0, sum[2] = {HUGE_VAL, HUGE_VAL}; /* logarithms: as told, reversed */
    *which = 0;
    for (int k = 0; k < 2; ++k) {
        const doctor_pair_t *own = &s->turn[reading[k]][axis][axis];
        double rest = of_either_sign(&s->turn[reading[k]][other][other], 1.0);
        double beside = has_pair(d, other) ? log(fmax(rest, BEST_DISCORD)) : 0.0;
        double discord = doctor_discord(own, -1.0);
        sum[0] = fmin(sum[0], log(doctor_discord(own, 1.0)) + beside);
        if (log(fmax(discord, BEST_DISCORD)) + beside < sum[1]) {
            sum[1] = log(fmax(discord, BEST_DISCORD)) + beside;
            with = discord;
        }
    }
    const doctor_pair_t *p = &s->turn[0][axis][axis];
    return explains(p, with) ? doctor_ratio(p->n / DOCTOR_WINDOW, exp(sum[0]), exp(sum[1])) : 0.0;
}

/* which: 0 the angle is in degrees, 1 the rate is, 2 both are. */
static double unit_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    const doctor_pair_t *radians = &s->turn[0][axis][axis], *degrees = &s->turn[1][axis][axis];
    double best = 0.0, clean = fmin(of_either_sign(radians, 1.0), 1.0);
    const doctor_pair_t *pair[3] = {degrees, radians, degrees};
    const double gain[3] = {1.0, 1.0 / DEGREES, 1.0 / DEGREES};
    const doctor_column_t *pitch = &d->column[CSV_ATTITUDE + 1];
    bool steep = pitch->beyond > STEEP * pitch->n;
    for (int k = 0; k < (steep ? 3 : 2); ++k) {
        double usual = doctor_discord(pair[k], gain[k]);
        double reversed = doctor_discord(pair[k], -gain[k]);
        bool found = usual < MAX_DISCORD || reversed < MAX_TWO_SLIPS;
        double llr = ratio(pair[k], clean, fmin(usual, reversed));
        if (llr > best && found) {
            best = llr;
            *which = k;
        }
    }
    return best;
}

/* axis: the one that keeps its place; the others are exchanged. */
static double exchange_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    double each[2];
    (void)d;
    *which = 0;
    for (int k = 0; k < 2; ++k) {
        const doctor_pair_t *own = &s->turn[0][k == 0 ? i : j][k == 0 ? i : j];
        const doctor_pair_t *other = &s->turn[0][k == 0 ? i : j][k == 0 ? j : i];
        double clean = of_either_sign(own, 1.0), discord = of_either_sign(other, 1.0);
        each[k] = discord < MAX_EXCHANGED ? ratio(own, clean, discord) : 0.0;
    }
    return each[0] > MIN_EACH && each[1] > MIN_EACH ? each[0] + each[1] : 0.0;
}

/* Of all axes together. which: the lag in cells, plus DOCTOR_LAGS. */
static double shift_at(const doctor_sums_t *s, int k)
{
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        double without = doctor_discord(&s->lag[DOCTOR_LAGS][i], 1.0);
        double with = doctor_discord(&s->lag[k][i], 1.0);
        if (explains(&s->lag[k][i], with)) {
            sum += doctor_ratio(s->lag[k][i].n / DOCTOR_WINDOW, without, with);
        }
    }
    return sum;
}

static double shift_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    double best = 0.0;
    (void)d;
    (void)axis;
    for (int k = 0; k <= 2 * DOCTOR_LAGS; ++k) {
        double score = shift_at(s, k);
        if (score > best) {
            best = score;
            *which = k;
        }
    }
    return best;
}

/* Are qw .. qz x, y, z, w? Of all axes together, and of the whole log. gain: of the rates. */
static bool is_reordered(const doctor_t *d, double gain)
{
    doctor_sums_t all;
    double llr = 0.0;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int i = 0; i < 3; ++i) {
        const doctor_pair_t *p = &all.turn[3][i][i];
        double told = of_either_sign(&all.turn[0][i][i], gain);
        llr += ratio(p, fmin(told, 1.0), of_either_sign(p, gain));
    }
    double yaw = doctor_discord(&all.turn[3][2][2], gain);
    return llr > MIN_LLR && (yaw < MAX_DISCORD || 2.0 - yaw < MAX_TWO_SLIPS);
}

/* Does the quaternion turn from world to body? Of all axes together, and of the whole log. To first
 * order of the angles it is the same if p, q, r are all reversed: their inputs tell. */
static bool is_conjugated(const doctor_t *d)
{
    doctor_sums_t all;
    double llr = 0.0, of_rates = 0.0;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int i = 0; i < 3; ++i) {
        const doctor_pair_t *told = &all.turn[0][i][i], *p = &all.turn[4][i][i];
        double without = doctor_discord(told, 1.0);
        if (has_pair(d, i)) {
            llr += ratio(p, without, doctor_discord(p, 1.0));
            of_rates += ratio(told, without, doctor_discord(told, -1.0));
        }
    }
    return llr > MIN_LLR && llr > of_rates - MIN_LLR &&
           doctor_discord(&all.turn[4][2][2], 1.0) < MAX_DISCORD;
}

void doctor_attitude_scan(doctor_t *d)
{
    char text[UNITS_TEXT];
    d->reordered = d->has[CSV_QUATERNION] && has_pair(d, 2) &&
                   (is_reordered(d, 1.0) || is_reordered(d, 1.0 / DEGREES));
    d->conjugated = d->has[CSV_QUATERNION] && has_pair(d, 2) && !d->reordered && is_conjugated(d);
    d->degrees = units_angle_judge(&d->units, text, sizeof text) >= 0;
    if (d->reordered || d->degrees) {
        return; /* there is no attitude */
    }
    for (int i = 2; i >= 0; --i) {
        if (has_pair(d, i)) {
            d->turned[i] = doctor_scan(d, i < 2 ? tilt_score : sign_score, i);
        }
        if (!(d->turned[i].llr > MIN_LLR)) {
            d->turned[i].llr = 0.0;
        }
    }
}

static bool find_units(doctor_t *d)
{
    bool found = false;
    for (int i = 2; i >= 0; --i) {
        doctor_range_t r = has_pair(d, i) ? doctor_scan(d, unit_score, i) : (doctor_range_t){0};
        char where[48];
        const char *angle = angle_name(i), *rate = rate_name(i);
        if (!(r.llr > MIN_LLR)) {
            continue;
        }
        found = true;
        d->turned[i].llr = 0.0;
        doctor_where(d, &r, where);
        if (r.which != 1) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_ANGLE_DEGREES, CSV_ATTITUDE + i, CSV_NU + 3 + i, &r,
                       "%s looks like degrees (its rate is 57 times %s%s)%s: convert it to radians",
                       angle, rate, r.which == 2 ? " in radians" : "", where);
        }
        if (r.which != 0) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_RATE_DEGREES, CSV_NU + 3 + i, CSV_ATTITUDE + i, &r,
                       "%s looks like degrees per second (57 times the rate of %s)%s: convert it "
                       "to radians per second",
                       rate, angle, where);
        }
    }
    return found;
}

/* Degrees that show in one column, or in both of a pair: as fit says it. */
static bool find_degrees(doctor_t *d)
{
    char text[UNITS_TEXT];
    int column = units_angle_judge(&d->units, text, sizeof text);
    if (column >= 0) {
        doctor_add(d, DOCTOR_ERROR, column < CSV_NU ? DOCTOR_ANGLE_DEGREES : DOCTOR_RATE_DEGREES,
                   column, -1, NULL, "%s", text);
    }
    return column >= 0;
}

/* shift_llr: of a shift in time, which explains such a log as well. */
static bool find_exchange(doctor_t *d, double shift_llr)
{
    doctor_range_t best = {0};
    int axis = 0;
    for (int k = 0; k < 3; ++k) {
        doctor_range_t r = has_pair(d, (k + 1) % 3) && has_pair(d, (k + 2) % 3)
                               ? doctor_scan(d, exchange_score, k)
                               : (doctor_range_t){0};
        if (r.llr > best.llr) {
            best = r;
            axis = k;
        }
    }
    if (!(best.llr > MIN_LLR && best.llr > shift_llr)) {
        return false;
    }
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    char where[48];
    doctor_add(d, DOCTOR_ERROR, DOCTOR_RATE_EXCHANGED, CSV_NU + 3 + (i < j ? i : j),
               CSV_NU + 3 + (i < j ? j : i), &best,
               "%s changes with %s, and %s with %s%s: the two rates, or the two angles, are "
               "exchanged: exchange the columns",
               angle_name(i), rate_name(j), angle_name(j), rate_name(i),
               doctor_where(d, &best, where));
    d->turned[i].llr = d->turned[j].llr = 0.0;
    return true;
}

static bool find_shift(doctor_t *d, const doctor_range_t *range)
{
    const doctor_range_t r = *range;
    doctor_sums_t sum;
    char where[48];
    if (!(r.llr > MIN_SHIFT_LLR)) {
        return false;
    }
    doctor_sum(d, r.first, r.last, &sum);
    double middle = r.llr, before = r.which > 0 ? shift_at(&sum, r.which - 1) : 0.0;
    double after = r.which < 2 * DOCTOR_LAGS ? shift_at(&sum, r.which + 1) : 0.0;
    double curve = before - 2.0 * middle + after;
    double shift = r.which - DOCTOR_LAGS + (curve < 0.0 ? 0.5 * (before - after) / curve : 0.0);
    shift *= DOCTOR_CELL_S;
    if (!(fabs(shift) > MIN_SHIFT_S)) {
        return false;
    }
    doctor_finding_t *f = doctor_add(
        d, DOCTOR_WARNING, DOCTOR_ATTITUDE_SHIFT, CSV_ATTITUDE + 2, CSV_NU + 5, &r,
        "the attitude %s p, q, r by %.2f s%s: give each column the time at which it was measured",
        shift > 0.0 ? "trails" : "leads", fabs(shift), doctor_where(d, &r, where));
    if (f != NULL) {
        f->value = shift;
    }
    return true;
}

/* Signs. Yaw: its input tells which of the two columns is wrong. */
static void find_signs(doctor_t *d)
{
    const doctor_range_t *t = d->turned;
    char where[48];
    bool rates = doctor_overlap(&t[2], &d->pushed[5]);
    bool pitch = doctor_overlap(&t[1], &t[2]) ||
                 (doctor_overlap(&d->sunk, &t[2]) && d->sunk.which == DOCTOR_PITCH_REVERSED);
    if (pitch && !(t[0].llr > 0.0)) {
        doctor_add(
            d, DOCTOR_ERROR, DOCTOR_FRAME, CSV_ATTITUDE + 2, CSV_NU + 5, &t[2],
            "theta_rad and psi_rad are reversed against the other columns, phi_rad is not%s, "
            "as if the %s were in ENU and FLU axes: change the signs of %s",
            doctor_where(d, &t[2], where),
            rates           ? "rates"
            : d->answers[5] ? "attitude"
                            : "attitude, or the rates,",
            rates           ? "q_radps and r_radps"
            : d->answers[5] ? "theta_rad and psi_rad"
                            : "the wrong ones");
        return;
    }
    for (int i = 0; i < 3; ++i) {
        if (!(t[i].llr > 0.0)) {
            continue;
        }
        doctor_where(d, &t[i], where);
        if (i == 2 && rates) {
            doctor_add(
                d, DOCTOR_ERROR, DOCTOR_RATE_SIGN, CSV_NU + 5, CSV_ATTITUDE + 2, &t[i],
                "r_radps has the wrong sign: it runs against psi_rad and against its input%s:"
                " change its sign",
                where);
        } else if (i == 2 && d->answers[5]) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_ANGLE_SIGN, CSV_ATTITUDE + 2, -1, &t[i],
                       "psi_rad has the wrong sign: it changes against r_radps, which follows its "
                       "input%s: change its sign",
                       where);
        } else {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_ANGLE_SIGN, CSV_ATTITUDE + i, CSV_NU + 3 + i, &t[i],
                       "%s changes against %s%s: one of them has the wrong sign: change it",
                       angle_name(i), rate_name(i), where);
        }
    }
}

/* Contradictions without explanation: neither column follows the other, whichever is noisy. */
static void find_unexplained(doctor_t *d)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int i = 0; i < 3; ++i) {
        const doctor_pair_t *p = &all.turn[0][i][i];
        double n = p->n / DOCTOR_WINDOW, c = doctor_correlation(p);
        double aa = p->aa - p->a * p->a / fmax(p->n, 1.0);
        double bb = p->bb - p->b * p->b / fmax(p->n, 1.0);
        if (!has_pair(d, i) || n < DOCTOR_MIN_WINDOWS || !(aa * bb > 0.0)) {
            continue;
        }
        double error = 5.0 / sqrt(n), ab = c * sqrt(bb / aa), ba = c * sqrt(aa / bb);
        if (ab + error * sqrt(bb / aa) < 0.5 && ba + error * sqrt(aa / bb) < 0.5) {
            doctor_add(
                d, DOCTOR_WARNING, DOCTOR_ATTITUDE, CSV_ATTITUDE + i, CSV_NU + 3 + i, NULL,
                "%s and %s contradict each other (correlation of the rates %.2f), unexplained:"
                " see whether they are of the same vehicle, time and axis",
                angle_name(i), rate_name(i), c);
        }
    }
}

void doctor_attitude(doctor_t *d)
{
    if (d->reordered) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_QUATERNION, CSV_QUATERNION, CSV_NU + 5, NULL,
                   "qw, qx, qy, qz look like x, y, z, w: the attitude turns with p, q, r only in "
                   "that order: name the columns qx, qy, qz, qw");
        return;
    }
    if (d->conjugated && !(d->pushed[5].llr > 0.0)) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_QUATERNION, CSV_QUATERNION, CSV_NU + 5, NULL,
                   "qw, qx, qy, qz turn from world to body: the attitude turns against p, q, r: "
                   "change the signs of qx, qy, qz");
        return;
    }
    /* A reversed psi disturbs the other axes, and so what is said about them. */
    bool found = d->turned[2].llr > 0.0 || doctor_mirror(d) || find_units(d) || find_degrees(d);
    doctor_range_t shift = doctor_scan(d, shift_score, 0);
    found = found || find_exchange(d, shift.llr) || find_shift(d, &shift);
    int before = d->findings;
    find_signs(d);
    if (!found && d->findings == before) {
        find_unexplained(d);
    }
}
