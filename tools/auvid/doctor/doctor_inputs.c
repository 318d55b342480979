/*
 * Each velocity against its input:
 *   acceleration = b input(t - lag) + drag + coupling + constant,
 * by least squares over a range, with the input, or without it. A slip explains the log better if
 * the residual sum of squares is smaller: n/2 ln(S_1 / S_2). Without slip b > 0 and the motion
 * follows within 0.6 s: thrusters, and delays of the instruments. A slip must leave drag that
 * dissipates: where rows are slow for a quick axis, its input is proportional to its velocity, and
 * the signs of both terms are uncertain together.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "doctor.h"
#include "../report/statistics.h"

#define MIN_LLR 20.0 /* more than for the attitude: the disturbance is correlated over seconds */
#define MIN_EACH 8.0
#define MIN_COUPLING 5.0 /* standard errors */
#define QUIET 0.15       /* standard deviation of an input in a block, relative to the median, .. */
#define UNEXCITED 0.15   /* .. and to the whole log */
#define MIN_SHARE 0.08   /* of the acceleration's variance: other terms are known to a quarter */

enum { INPUT, SPEED, QUADRATIC, COUPLING };
enum { ACCELERATION = GAIN_TERMS - 1 };

typedef doctor_gain_t gain_t;

static const char *const axis_name[6] = {"surge", "sway", "heave", "roll", "pitch", "yaw"};

const char *doctor_input_name(const doctor_t *d, int j)
{
    static const char *const of_thrusters[6] = {
        "the surge force of the thrusters",  "the sway force of the thrusters",
        "the heave force of the thrusters",  "the roll moment of the thrusters",
        "the pitch moment of the thrusters", "the yaw moment of the thrusters"};
    return d->use != NULL ? of_thrusters[j] : csv_name[d->inputs + j];
}

bool doctor_has_input(const doctor_t *d, int j)
{
    /* see doctor_world.c, doctor_mounting.c */
    bool other_axes = (j < 2 && (d->in_world || fabs(d->mounted) > 0.0)) || (j == 2 && d->in_enu);
    return !other_axes && d->inputs >= 0 && d->has[d->inputs + j] && d->has[CSV_NU + j] &&
           d->column[d->inputs + j].changes > 0.0 && d->column[CSV_NU + j].changes > 0.0;
}

static double input_variance(const doctor_sums_t *s, int j)
{
    const double *own = s->own[j][DOCTOR_EARLY];
    double n = fmax(s->count[j], 1.0), mean = own[ACCELERATION - 1] / n;
    return own[0] / n - mean * mean;
}

bool doctor_moves(const doctor_sums_t *s, int j, double explained)
{
    double n = fmax(s->count[j], 1.0), sum = s->fixed[j][ACCELERATION - 1][ACCELERATION];
    return explained > MIN_SHARE * (s->fixed[j][ACCELERATION][ACCELERATION] - sum * sum / n);
}

/* A controller opposes the motion that it measures: its output is the input reversed, but later
 * than the motion. Then the log shows no sign. */
static double sign_score(const doctor_t *d, const doctor_sums_t *s, int j, int *which)
{
    double clean, unused;
    gain_t g;
    *which = 0;
    doctor_usual(s, j, &clean, &unused, &g);
    double feedback = doctor_reversed(s, j, DOCTOR_FEEDBACK_FIRST, DOCTOR_FEEDBACK_LAST);
    double against = doctor_reversed(s, j, d->lag[j] > DOCTOR_EARLY ? d->lag[j] - 1 : DOCTOR_EARLY,
                                     d->lag[j] > DOCTOR_EARLY ? d->lag[j] + 1 : DOCTOR_EARLY + 1);
    bool excited = input_variance(s, j) > UNEXCITED * UNEXCITED * d->input_variance[j];
    return excited && doctor_moves(s, j, g.without - against)
               ? doctor_gain_ratio(s, j, fmin(clean, feedback), against)
               : 0.0;
}

/* pair: 6 i + j. */
static double exchange_score(const doctor_t *d, const doctor_sums_t *s, int pair, int *which)
{
    const int axis[2] = {pair / 6, pair % 6};
    double each[2];
    (void)d;
    *which = 0;
    for (int k = 0; k < 2; ++k) {
        int j = axis[k];
        double clean, against;
        gain_t g;
        doctor_usual(s, j, &clean, &against, &g);
        doctor_regress(s, j, s->cross[j][axis[1 - k]], &g);
        each[k] = doctor_gain_ratio(s, j, fmin(clean, against), g.b > 0.0 ? g.with : g.without);
    }
    return each[0] > MIN_EACH && each[1] > MIN_EACH ? each[0] + each[1] : 0.0;
}

static void clear_input(doctor_sums_t *s, int j)
{
    for (int k = DOCTOR_WORLD + j; j < 2 && k < DOCTOR_AXES; k += 2) {
        s->count[k] = 0.0;
        memset(s->fixed[k], 0, sizeof s->fixed[k]);
        memset(s->own[k], 0, sizeof s->own[k]);
    }
    s->count[j] = 0.0;
    memset(s->fixed[j], 0, sizeof s->fixed[j]);
    memset(s->own[j], 0, sizeof s->own[j]);
    memset(s->cross[j], 0, sizeof s->cross[j]);
    memset(s->thrust[j], 0, sizeof s->thrust[j]);
    memset(s->both[j], 0, sizeof s->both[j]);
}

/* Leaves out blocks in which an input hardly varies. What does vary there is feedback of noise in
 * the measured motion, against which that motion seems to accelerate. */
static void leave_out_quiet_blocks(doctor_t *d)
{
    double variance[DOCTOR_BLOCKS], sorted[DOCTOR_BLOCKS];
    for (int j = 0; j < 6 && d->blocks > 0; ++j) {
        for (int k = 0; k < d->blocks; ++k) {
            variance[k] = sorted[k] = input_variance(&d->block[k].sums, j);
        }
        double usual_variance = statistics_quantile(sorted, (size_t)d->blocks, 0.5);
        for (int k = 0; k < d->blocks; ++k) {
            if (variance[k] < QUIET * QUIET * usual_variance) {
                clear_input(&d->block[k].sums, j);
            }
        }
    }
}

void doctor_inputs_scan(doctor_t *d)
{
    doctor_sums_t all;
    leave_out_quiet_blocks(d);
    doctor_world_scan(d);
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int j = 0; j < 6; ++j) {
        double clean, against;
        gain_t g;
        if (!doctor_has_input(d, j)) {
            continue;
        }
        doctor_usual(&all, j, &clean, &against, &g);
        against =
            fmin(against, doctor_reversed(&all, j, DOCTOR_FEEDBACK_FIRST, DOCTOR_FEEDBACK_LAST));
        /* also of a short log */
        double windows = all.count[j] / DOCTOR_WINDOW;
        d->answers[j] = clean > 0.0 && 0.5 * windows * log(against / clean) > MIN_EACH;
        if (d->answers[j]) {
            d->time_constant_s[j] = g.drag > 0.0 ? 1.0 / g.drag : 0.0;
        }
        d->lag[j] = doctor_best_lag(d, j);
        d->input_variance[j] = input_variance(&all, j);
        d->pushed[j] = doctor_scan(d, sign_score, j);
        if (!(d->pushed[j].llr > MIN_LLR)) {
            d->pushed[j].llr = 0.0;
        }
    }
    doctor_mounting_scan(d);
    if (fabs(d->mounted) > 0.0) {
        d->pushed[0].llr = d->pushed[1].llr = 0.0;
    }
}

/* As doctor_coupling, of surge and sway with the inputs of these columns. An input with the wrong
 * sign does not change them, a velocity does. */
static double coupling(const doctor_t *d, const doctor_range_t *r, const int column[2])
{
    doctor_sums_t sum;
    double total = 0.0;
    doctor_sum(d, r->first, r->last, &sum);
    for (int j = 0; j < 2; ++j) {
        gain_t g;
        doctor_regress(
            &sum, j,
            column[j] == j ? sum.own[j][DOCTOR_EARLY + DOCTOR_USUAL] : sum.cross[j][column[j]], &g);
        total += j == 0 ? g.t[COUPLING] : -g.t[COUPLING];
    }
    return total;
}

double doctor_coupling(const doctor_t *d, int first, int last)
{
    static const int own[2] = {0, 1};
    doctor_range_t range = {.first = first, .last = last};
    return coupling(d, &range, own);
}

/* Do both its force and the depth of a pitched hull say that u has the wrong sign? */
static bool depth_reverses_surge(const doctor_t *d)
{
    return doctor_depth_reverses_surge(d) && doctor_overlap(&d->pushed[0], &d->sunk);
}

/* Is the velocity of DoF j wrong (1), its input (-1), or is that not known (0)? */
static int velocity_is_wrong(const doctor_t *d, int j)
{
    static const int own[2] = {0, 1};
    const doctor_range_t *r = &d->pushed[j];
    if (j == 2) {
        bool pitch = d->turned[1].llr > 0.0 || d->turned[2].llr > 0.0 || d->mirrored.llr > 0.0;
        bool explained = d->sunk.which == DOCTOR_PITCH_REVERSED && pitch; /* w and depth agree */
        return d->has[CSV_POSITION + 2] && doctor_overlap(r, &d->sunk) ? (explained ? -1 : 1) : 0;
    }
    if ((j < 2 && doctor_overlap(r, &d->gone[j])) || (j == 0 && depth_reverses_surge(d))) {
        return 1;
    }
    if (j < 2 && !(d->turned[2].llr > 0.0) && !(d->pushed[5].llr > 0.0) && d->yaw_is_wrong <= 0) {
        double t = coupling(d, r, own);
        return t > MIN_COUPLING ? -1 : t < -MIN_COUPLING ? 1 : 0;
    }
    return j == 5 && d->has[CSV_ATTITUDE + 2] ? d->yaw_is_wrong : 0;
}

/* Are the moments those of the thrusters, about an axis that the model has not? A few millimetres
 * in their positions make them. */
static bool moment_is_incidental(const doctor_t *d, int j)
{
    return d->use != NULL && d->use->vehicle != NULL && (j == 3 || j == 4) &&
           d->use->vehicle->model->columns[j] == 0;
}

static void find_sign(doctor_t *d, int j)
{
    const doctor_range_t *r = &d->pushed[j];
    const char *input = doctor_input_name(d, j), *velocity = csv_name[CSV_NU + j];
    int wrong = velocity_is_wrong(d, j);
    char where[48];
    doctor_where(d, r, where);
    if (wrong > 0 && j == 2 && d->sunk.which == DOCTOR_PITCH_REVERSED) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_VELOCITY_SIGN, CSV_NU + j, CSV_POSITION + 2, r,
                   "w_mps and depth_m are both positive upwards%s: they agree, but w_mps "
                   "accelerates against %s, and depth_m changes against u_mps and theta_rad: "
                   "change both signs",
                   where, input);
    } else if (wrong > 0) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_VELOCITY_SIGN, CSV_NU + j, d->inputs + j, r,
                   "%s has the wrong sign: it accelerates against %s, and %s%s: change its sign",
                   velocity, input,
                   j == 2                              ? "runs against depth"
                   : j == 0 && depth_reverses_surge(d) ? "runs against the depth in a dive"
                                                       : "its coupling with the turn is reversed",
                   where);
    } else if (wrong < 0) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_INPUT_SIGN, d->inputs + j, CSV_NU + j, r,
                   "%s has the wrong sign: %s accelerates against it%s: %s", input, velocity, where,
                   d->use != NULL ? "reverse its thrusters, or exchange them" : "change its sign");
    } else if (moment_is_incidental(d, j)) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_EITHER_SIGN, d->inputs + j, CSV_NU + j, r,
                   "%s accelerates against %s%s: its sign is wrong, or the positions of the "
                   "thrusters are not exact; the model does not need it",
                   velocity, input, where);
    } else if (j == 5 && d->has[CSV_ATTITUDE + 2]) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_EITHER_SIGN, d->inputs + j, CSV_NU + j, r,
                   "%s accelerates against %s%s: its sign is wrong, or psi_rad and r_radps are "
                   "both positive to port: change the wrong ones",
                   velocity, input, where);
    } else {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_EITHER_SIGN, d->inputs + j, CSV_NU + j, r,
                   "%s accelerates against %s%s: one of them has the wrong sign: change it",
                   velocity, input, where);
    }
}

/* The signs of v, w, r, but not of u, are reversed: axes with y to port and z up. */
static bool find_frame(doctor_t *d)
{
    const doctor_range_t *p = d->pushed;
    char where[48];
    if (!doctor_overlap(&p[1], &p[2]) || p[0].llr > 0.0 || !d->answers[0]) {
        return false;
    }
    doctor_add(d, DOCTOR_ERROR, DOCTOR_FRAME, CSV_NU + 1, d->inputs + 1, &p[1],
               "v_mps%s w_mps%s accelerate against their inputs, u_mps with its own%s, as if "
               "velocities and inputs were in different axes (FRD: y to starboard, z down; FLU: y "
               "to port, z up): give both in FRD",
               p[5].llr > 0.0 ? "," : " and", p[5].llr > 0.0 ? " and r_radps" : "",
               doctor_where(d, &p[1], where));
    return true;
}

static bool find_exchange(doctor_t *d)
{
    doctor_range_t best = {0};
    int i = 0, j = 0;
    for (int pair = 0; pair < 36; ++pair) {
        if (pair / 6 < pair % 6 && doctor_has_input(d, pair / 6) && doctor_has_input(d, pair % 6)) {
            doctor_range_t r = doctor_scan(d, exchange_score, pair);
            if (r.llr > best.llr) {
                best = r;
                i = pair / 6;
                j = pair % 6;
            }
        }
    }
    if (!(best.llr > MIN_LLR)) {
        return false;
    }
    static const int crossed[2] = {1, 0};
    double t = i == 0 && j == 1 && !(d->turned[2].llr > 0.0) ? coupling(d, &best, crossed) : 0.0;
    bool inputs = t > MIN_COUPLING, velocities = t < -MIN_COUPLING;
    char where[48];
    doctor_add(d, DOCTOR_ERROR,
               inputs       ? DOCTOR_INPUT_EXCHANGED
               : velocities ? DOCTOR_VELOCITY_EXCHANGED
                            : DOCTOR_EITHER_EXCHANGED,
               (velocities ? CSV_NU : d->inputs) + i, (velocities ? CSV_NU : d->inputs) + j, &best,
               "%s follows %s, and %s follows %s%s: %s", csv_name[CSV_NU + i],
               doctor_input_name(d, j), csv_name[CSV_NU + j], doctor_input_name(d, i),
               doctor_where(d, &best, where),
               inputs && d->use != NULL
                   ? "thrusters are reversed or exchanged: compare each with the vehicle file"
               : inputs     ? "the two inputs are exchanged: exchange the columns"
               : velocities ? "the two velocities are exchanged: exchange the columns"
               : d->use != NULL
                   ? "the two velocities are exchanged, or thrusters are reversed or exchanged: "
                     "compare each with the vehicle file"
                   : "the two inputs, or the two velocities, are exchanged: exchange the columns");
    d->pushed[i].llr = d->pushed[j].llr = 0.0;
    return true;
}

/* Is the rate of DoF j known to be wrong from the attitude? */
static bool rate_is_wrong(const doctor_t *d, int j)
{
    int axis = j - 3;
    if (j == 5 && d->yaw_is_wrong > 0) {
        return true; /* see doctor_mirror.c */
    }
    return axis >= 0 && doctor_overlap(&d->pushed[j], &d->turned[axis]);
}

void doctor_inputs(doctor_t *d)
{
    double sign_llr = 0.0;
    /* Forces that are stamped late seem reversed to a quick vehicle; those of a DVL that is mounted
     * backwards leave heave and yaw without a shift. */
    if (fabs(d->mounted) > 0.0 && doctor_shift(d, 0.0)) {
        return;
    }
    doctor_mounting(d);
    bool sound = !(fabs(d->mounted) > 0.0) && !depth_reverses_surge(d); /* u and v */
    if (d->use != NULL && sound && doctor_thrusters(d)) {
        return; /* which explains what is wrong in each DoF */
    }
    for (int j = 0; j < 6; ++j) {
        sign_llr += d->pushed[j].llr;
    }
    bool exchanged = find_exchange(d);
    bool frame = find_frame(d);
    /* One shift of all inputs does not mend a part of the motion that is late. */
    bool late = !exchanged && doctor_late_velocity(d);
    bool shifted = !exchanged && !late && doctor_shift(d, sign_llr);
    if (!exchanged && !late && !shifted && !frame && !(sign_llr > 0.0)) {
        doctor_long_lag(d);
    }
    if (d->use != NULL && sound && !exchanged && !frame && !(sign_llr > 0.0)) {
        doctor_thrusters_hidden(d);
    }
    for (int j = 0; j < 6; ++j) {
        bool pushed = d->pushed[j].llr > 0.0;
        if (doctor_has_input(d, j) && pushed && !shifted && !rate_is_wrong(d, j) &&
            !(frame && (j == 1 || j == 2 || j >= 4))) {
            find_sign(d, j);
        } else if (doctor_has_input(d, j) && !d->answers[j] && !exchanged && !pushed && !shifted) {
            doctor_add(d, DOCTOR_NOTE, DOCTOR_INPUT_WITHOUT_EFFECT, d->inputs + j, CSV_NU + j, NULL,
                       "%s does not visibly follow %s: %s is not identified from this log",
                       csv_name[CSV_NU + j], doctor_input_name(d, j), axis_name[j]);
        }
    }
}
