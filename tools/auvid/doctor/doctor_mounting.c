/*
 * A DVL that is mounted at an angle about the vertical: it measures R(u, v) for the velocity (u, v)
 * of the vehicle. The forces X and Y are known, and
 *   acceleration of R(u, v) = B (X, Y) + drag + coupling + constant, B = R diag(1 / m_u, 1 / m_v).
 * Each column of B shows the angle of R by itself. A fault of thrusters turns both columns in
 * opposite directions; after an exchange or a single wrong sign they differ by 180 degrees.
 */
#include <math.h>
#include <string.h>

#include "doctor.h"

#define DEGREE (3.14159265358979323846 / 180.0)
#define TURN (360.0 * DEGREE)
#define MAX_ERROR (5.0 * DEGREE)       /* standard error of each angle */
#define MAX_DIFFERENCE (20.0 * DEGREE) /* of the two */
#define MIN_ANGLE (15.0 * DEGREE)      /* masses that are identified at less err by less than 7 % */
#define BACKWARDS (165.0 * DEGREE)

enum { FORCES = 2, ACCELERATION = DOCTOR_MOUNT_TERMS - 2 };

/* The angle to starboard by which force k shows the DVL to be turned. Returns false if the force
 * does not determine it. m: swept, over n independent windows. */
static bool find_angle(double m[DOCTOR_MOUNT_TERMS][DOCTOR_MOUNT_TERMS], int k, double n,
                       double *angle)
{
    double u = m[k][ACCELERATION], v = m[k][ACCELERATION + 1];
    double left = fmax(m[ACCELERATION][ACCELERATION], m[ACCELERATION + 1][ACCELERATION + 1]);
    double variance = left / n * m[k][k];
    *angle = k == 0 ? atan2(-v, u) : atan2(u, v);
    return variance < MAX_ERROR * MAX_ERROR * (u * u + v * v);
}

/* The angle to starboard by which the DVL is turned against the forces; 0: none that is certain. */
static double angle_against_forces(const doctor_t *d)
{
    double m[DOCTOR_MOUNT_TERMS][DOCTOR_MOUNT_TERMS], before[DOCTOR_MOUNT_TERMS], angle[FORCES];
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    memcpy(m, all.mount, sizeof m);
    double windows = m[ACCELERATION - 1][ACCELERATION - 1] / DOCTOR_WINDOW;
    for (int k = 0; k < ACCELERATION; ++k) {
        before[k] = m[k][k];
    }
    for (int k = ACCELERATION - 1; k >= 0; --k) {
        bool swept = doctor_sweep(&m[0][0], DOCTOR_MOUNT_TERMS, k, before[k]);
        if (!swept && k < FORCES) {
            return 0.0;
        }
    }
    for (int k = 0; k < FORCES; ++k) {
        if (!find_angle(m, k, windows, &angle[k])) {
            return 0.0;
        }
    }
    double difference = remainder(angle[1] - angle[0], TURN);
    double middle = remainder(angle[0] + 0.5 * difference, TURN);
    bool certain = windows >= DOCTOR_MIN_WINDOWS && fabs(difference) < MAX_DIFFERENCE &&
                   fabs(middle) > MIN_ANGLE;
    return certain ? middle : 0.0;
}

void doctor_mounting_scan(doctor_t *d)
{
    bool others = d->pushed[2].llr > 0.0 || d->pushed[5].llr > 0.0; /* are reversed */
    bool has = d->inputs >= 0 && d->has[CSV_NU] && d->has[CSV_NU + 1];
    double angle = !has || d->in_world ? 0.0 : angle_against_forces(d);
    bool inputs = fabs(angle) > BACKWARDS && others;
    d->mounted = inputs || doctor_position_turns(d, angle) < 0 ? 0.0 : angle;
}

void doctor_mounting(doctor_t *d)
{
    double c = cos(d->mounted), s = sin(d->mounted);
    bool position = doctor_position_turns(d, d->mounted) > 0;
    bool reversed = position || doctor_depth_reverses_surge(d);
    if (fabs(d->mounted) > BACKWARDS) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_MOUNTING, CSV_NU, CSV_NU + 1, NULL,
                   reversed ? "u_mps and v_mps accelerate against their forces, and u_mps runs "
                              "against %s: the DVL is mounted backwards: change the signs of u_mps "
                              "and v_mps"
                            : "u_mps and v_mps both accelerate against their forces: the DVL is "
                              "mounted backwards, or both forces have the wrong sign: change the "
                              "signs of u_mps and v_mps, or of the forces",
                   position ? "the position" : "depth_m");
    } else if (fabs(d->mounted) > 0.0) {
        doctor_add(
            d, DOCTOR_ERROR, DOCTOR_MOUNTING, CSV_NU, CSV_NU + 1, NULL,
            "u_mps and v_mps are turned by about %.0f degrees to %s against the forces: the DVL "
            "is mounted at an angle: rotate the two columns: u_mps becomes "
            "%.2f u_mps %c %.2f v_mps, v_mps becomes %.2f v_mps %c %.2f u_mps",
            fabs(d->mounted) / DEGREE, s > 0.0 ? "starboard" : "port", c, s > 0.0 ? '-' : '+',
            fabs(s), c, s > 0.0 ? '+' : '-', fabs(s));
    }
}
