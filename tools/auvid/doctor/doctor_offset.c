/*
 * Constant offsets of the horizontal velocities, such as the bias of a DVL: against the rates of
 * the position, or where no input acts.
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define MIN_OFFSET_MPS 0.04
#define SHARE 0.08       /* of the rms speed: errors of scale and mounting */
#define CORRELATED 100.0 /* windows for which errors are correlated */
#define MIN_REST 200.0   /* windows */
#define STEADY 2.0       /* offset at rest, in standard deviations */

/* Mean of a signal, and its standard error. */
static double mean(double n, double sum, double square, double *error)
{
    double m = sum / fmax(n, 1.0);
    *error = sqrt(fmax(square / fmax(n, 1.0) - m * m, 0.0) * CORRELATED / fmax(n, CORRELATED));
    return m;
}

/* Against the position, in body axes. An offset in world axes instead is a current: the velocity
 * is through the water. */
static void find_by_position(doctor_t *d, const doctor_sums_t *all)
{
    double offset[2], error[2], speed = 0.0, drift[2], unused;
    drift[0] = mean(all->drift.n, all->drift.a, all->drift.aa, &unused);
    drift[1] = mean(all->drift.n, all->drift.b, all->drift.bb, &unused);
    for (int i = 0; i < 2; ++i) {
        const doctor_pair_t *p = &all->ground[0][i][i];
        offset[i] = mean(p->n, p->b - p->a, p->bb - 2.0 * p->ab + p->aa, &error[i]);
        speed = fmax(speed, sqrt(p->bb / fmax(p->n, 1.0)));
    }
    bool turns = hypot(drift[0], drift[1]) < 0.7 * hypot(offset[0], offset[1]);
    for (int i = 0; i < 2 && turns; ++i) {
        if (fabs(offset[i]) > fmax(fmax(MIN_OFFSET_MPS, SHARE * speed), 5.0 * error[i])) {
            doctor_finding_t *f = doctor_add(
                d, DOCTOR_WARNING, DOCTOR_OFFSET, CSV_NU + i, CSV_POSITION, NULL,
                "%s has an offset of %+.3f m/s against the rates of north_m and east_m: subtract "
                "it",
                csv_name[CSV_NU + i], offset[i]);
            if (f != NULL) {
                f->value = offset[i];
            }
        }
    }
}

static void find_at_rest(doctor_t *d, const doctor_pair_t *rest)
{
    const double sum[2] = {rest->a, rest->b}, square[2] = {rest->aa, rest->bb};
    for (int i = 0; i < 2 && rest->n > MIN_REST; ++i) {
        double error, offset = mean(rest->n, sum[i], square[i], &error);
        double deviation = sqrt(fmax(square[i] / rest->n - offset * offset, 0.0));
        if (fabs(offset) > fmax(MIN_OFFSET_MPS, STEADY * deviation)) {
            doctor_finding_t *f = doctor_add(
                d, DOCTOR_WARNING, DOCTOR_OFFSET, CSV_NU + i, -1, NULL,
                "%s is %+.3f m/s on average in %.0f s without input: if the vehicle was at rest, "
                "subtract it; if a current carried it, give fit --current",
                csv_name[CSV_NU + i], offset, rest->n * DOCTOR_CELL_S);
            if (f != NULL) {
                f->value = offset;
            }
        }
    }
}

void doctor_offset(doctor_t *d)
{
    doctor_sums_t all;
    bool position = d->has[CSV_POSITION] && d->has[CSV_POSITION + 1] && d->has[CSV_ATTITUDE + 2] &&
                    !doctor_depth_has_other_unit(d);
    for (int i = 0; i < d->findings; ++i) {
        if (d->finding[i].severity == DOCTOR_ERROR) {
            return; /* which may be the cause */
        }
    }
    doctor_sum(d, 0, d->blocks - 1, &all);
    int before = d->findings;
    if (position && d->has[CSV_NU] && d->has[CSV_NU + 1]) {
        find_by_position(d, &all);
    }
    if (d->findings == before) {
        find_at_rest(d, &all.rest);
    }
}
