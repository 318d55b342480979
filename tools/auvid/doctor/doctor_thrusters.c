/*
 * Inputs of single thrusters. Their wrench, by the vehicle's thrust maps and allocation, is
 * compared with the motion as that of a log is (doctor_inputs.c). A thruster with the wrong sign
 * explains the accelerations of all degrees of freedom together, if it is the cause.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "doctor.h"

#define MIN_LLR 20.0 /* as in doctor_inputs.c */
#define MIN_LEAD 8.0 /* of one thruster over the next one: else both are named */

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
    }
}

/* Of all DoF together, thruster `flipped` reversed. Both at one lag, as others are not summed. */
static double flip_score(const doctor_t *d, const doctor_sums_t *s, int flipped, int *which)
{
    int thrusters = log_inputs(d->use);
    double sum = 0.0;
    *which = 0;
    for (int j = 0; j < 6; ++j) {
        double products[GAIN_TERMS] = {0}, part[AUVID_MAX_THRUSTERS];
        doctor_gain_t g, clean;
        bool moves = d->has[CSV_NU + j] && d->column[CSV_NU + j].changes > 0.0;
        if (!d->has[CSV_WRENCH + j] || !moves || s->count[j] < 1.0) {
            continue;
        }
        for (int k = 0; k < thrusters; ++k) {
            part[k] = (k == flipped ? -1.0 : 1.0) * effect(d, k, j);
        }
        for (int k = 0; k < thrusters; ++k) {
            for (int a = 1; a < GAIN_TERMS; ++a) {
                products[a] += part[k] * s->thrust[j][k][a];
            }
            for (int i = 0; i < thrusters; ++i) {
                products[0] += part[k] * part[i] * s->both[j][k][i];
            }
        }
        doctor_regress(s, j, products, &g);
        doctor_regress(s, j, s->own[j][DOCTOR_EARLY + DOCTOR_USUAL], &clean);
        sum += doctor_ratio(s->count[j] / DOCTOR_WINDOW, clean.b > 0.0 ? clean.with : clean.without,
                            g.b > 0.0 && g.drag > 0.0 ? g.with : g.without);
    }
    return sum;
}

bool doctor_thrusters(doctor_t *d)
{
    doctor_range_t best = {0}, next = {0};
    int which = 0, other = 0;
    double axes = 0.0;
    for (int k = 0; k < log_inputs(d->use); ++k) {
        doctor_range_t r = doctor_scan(d, flip_score, k);
        if (r.llr > best.llr) {
            next = best;
            other = which;
            best = r;
            which = k;
        } else if (r.llr > next.llr) {
            next = r;
            other = k;
        }
    }
    for (int j = 0; j < 6; ++j) {
        axes += d->pushed[j].llr;
    }
    if (!(best.llr > MIN_LLR && best.llr > axes)) {
        return false;
    }
    bool both = best.llr - next.llr < MIN_LEAD;
    char where[48];
    const char *name = csv_name[log_input(d->use, which)];
    const char *second = csv_name[log_input(d->use, other)];
    doctor_add(d, DOCTOR_ERROR, DOCTOR_THRUSTER_SIGN, log_input(d->use, which),
               both ? log_input(d->use, other) : -1, &best,
               "%s%s%s has the wrong sign: the motion follows if it is reversed%s: change its "
               "sign, or its direction in the vehicle file",
               name, both ? " or " : "", both ? second : "", doctor_where(d, &best, where));
    return true;
}
