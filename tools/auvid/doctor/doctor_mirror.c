/*
 * An angle that is reversed with its rate, such as psi and r that are both positive to port. Each
 * follows the other, but the turn then tilts the vehicle to the wrong side:
 *   roll rate = p + tan(theta) (q sin(phi) + r cos(phi)), pitch rate = q cos(phi) - r sin(phi)
 * (Fossen 2011, Eq. 2.26) hold for roll and pitch only if psi is read as reversed (reading 2 of
 * the attitude). That is the same for each of the three pairs, and for all three together. Which
 * one it is, another identity has to tell: r and its input, depth, position, or the coupling of
 * surge and sway with the turn.
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define MIN_LLR 12.0      /* as in doctor_attitude.c */
#define MAX_DISCORD 0.6   /* of an axis that shows it */
#define BEST_DISCORD 0.02 /* sensors do not agree better */
#define MIN_COUPLING 5.0  /* standard errors */

static bool has_pair(const doctor_t *d, int axis)
{
    return d->has[CSV_ATTITUDE + axis] && d->has[CSV_NU + 3 + axis];
}

/* How much better roll and pitch turn with p and q if psi is read as reversed. */
static double mirror_score(const doctor_t *d, const doctor_sums_t *s)
{
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) {
        const doctor_pair_t *p = &s->turn[0][i][i], *mirrored = &s->turn[2][i][i];
        double as_told = doctor_discord(p, 1.0), with = doctor_discord(mirrored, 1.0);
        if (has_pair(d, i) && fmin(as_told, with) < MAX_DISCORD) {
            sum += doctor_ratio(p->n / DOCTOR_WINDOW, fmax(as_told, BEST_DISCORD),
                                fmax(with, BEST_DISCORD));
        }
    }
    return sum;
}

/* Is psi wrong with r (1), are both right (-1), or is that not known (0)? By roll and pitch and the
 * position; else by the coupling of surge and sway with r. */
static int heading_is_mirrored(const doctor_t *d, bool tilts)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    double llr = doctor_position_mirrored(d) + (tilts ? mirror_score(d, &all) : 0.0);
    if (fabs(llr) > MIN_LLR) {
        return llr > 0.0 ? 1 : -1;
    }
    bool moves = d->answers[0] && d->answers[1]; /* so u and v are right */
    double t = moves ? doctor_coupling(d, 0, d->blocks - 1) : 0.0;
    return t < -MIN_COUPLING ? 1 : t > MIN_COUPLING ? -1 : 0;
}

/* Of the whole log: axes do not change within it, and a part of real logs may say the opposite. */
void doctor_mirror_scan(doctor_t *d)
{
    doctor_sums_t all;
    for (int i = 0; i < 3; ++i) {
        if (d->turned[i].llr > 0.0) {
            return;
        }
    }
    if (d->reordered || d->degrees) {
        return;
    }
    doctor_sum(d, 0, d->blocks - 1, &all);
    double llr = mirror_score(d, &all);
    d->mirrored = (doctor_range_t){.llr = llr > MIN_LLR ? llr : 0.0, .last = d->blocks - 1};
    bool pitch = doctor_overlap(&d->mirrored, &d->sunk) && d->sunk.which == DOCTOR_PITCH_REVERSED;
    if (d->pushed[5].llr > 0.0) {
        d->yaw_is_wrong = pitch ? -1 : heading_is_mirrored(d, true);
    } else if (d->mirrored.llr > 0.0 && !pitch) {
        d->yaw_is_wrong = heading_is_mirrored(d, false) > 0 ? 1 : 0;
    }
    if (d->yaw_is_wrong > 0 && !(d->mirrored.llr > 0.0)) {
        d->mirrored = (doctor_range_t){.llr = MIN_LLR, .last = d->blocks - 1};
    }
    d->mirrored.which = pitch                 ? AUVID_PITCH - 3
                        : d->yaw_is_wrong > 0 ? AUVID_YAW - 3
                                              : DOCTOR_MIRROR_UNKNOWN;
}

bool doctor_mirror(doctor_t *d)
{
    const doctor_range_t *r = &d->mirrored;
    bool has_psi = d->has[CSV_ATTITUDE + 2], input = !(d->pushed[5].llr > 0.0) && d->answers[5];
    char where[48];
    if (!(r->llr > 0.0)) {
        return false;
    }
    doctor_where(d, r, where);
    if (r->which == AUVID_YAW - 3) {
        doctor_add(d, DOCTOR_ERROR, has_psi ? DOCTOR_FRAME : DOCTOR_RATE_SIGN,
                   has_psi ? CSV_ATTITUDE + 2 : CSV_NU + 5, has_psi ? CSV_NU + 5 : -1, r,
                   "%s positive to port%s%s: change %s",
                   !has_psi ? "r_radps is"
                   : input  ? "psi_rad, r_radps and the yaw input are all"
                            : "psi_rad and r_radps are both",
                   where, input ? "" : ": they agree, but r_radps accelerates against its input",
                   !has_psi ? "its sign"
                   : input  ? "the three signs"
                            : "both signs");
    } else if (r->which == AUVID_PITCH - 3) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_FRAME, CSV_ATTITUDE + 1, CSV_NU + 4, r,
                   "theta_rad and q_radps are both positive with the bow down%s: they agree, but "
                   "depth_m and u_mps contradict them: change both signs",
                   where);
    } else {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FRAME, CSV_ATTITUDE + 2, CSV_NU + 5, r,
                   "the attitude turns with p, q, r only if an angle and its rate are both "
                   "reversed%s: psi_rad and r_radps (with the yaw input), theta_rad and q_radps, "
                   "or phi_rad and p_radps: change the signs of that pair",
                   where);
    }
    return true;
}
