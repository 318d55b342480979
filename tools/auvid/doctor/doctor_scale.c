/*
 * Velocities, forces and positions of thrusters in other units. The rates of position and depth and
 * the accelerometer show the unit of a velocity. The mass that follows from a force and a velocity
 * contains the dry mass: if it is smaller, one of them is in another unit. If it is many times
 * larger, too.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "doctor.h"
#include "../vehicle/vehicle_thrusters.h"

#define TOLERANCE 0.08 /* of a unit */
#define SURE 1.35      /* largest ratio of the limits of a factor */
#define USUAL 1.25     /* factors up to this are errors of scale */
#define KGF 9.81
#define HEAVY_KGF 0.25 /* masses relative to the dry mass: below with forces in kgf .. */
#define LIGHT_KGF 0.08 /* .. and above */
#define HEAVY_KNOT 0.8 /* the same of velocities in knots; thrust is known to a fifth */
#define LIGHT_KNOT 0.45
#define HEAVIEST                                                                                   \
    4.0 /* added mass along the long axis of a vehicle is less than thrice the dry mass */
#define PLATEAU 0.01 /* share of the samples at the limit of a thruster */
#define MIN_WINDOWS 300.0

static const struct {
    double factor;
    const char *name, *times;
} unit[] = {{1.9438, "knots", "0.5144"},
            {3.2808, "ft/s", "0.3048"},
            {3.6, "km/h", "0.2778"},
            {100.0, "cm/s", "0.01"},
            {1000.0, "mm/s", "0.001"}};

enum { UNITS = sizeof unit / sizeof unit[0] };

/* The factor of a velocity (b) to a rate (a) lies between two slopes. Returns the unit, or -1. */
static int unit_of(const doctor_pair_t *p)
{
    double n = fmax(p->n, 1.0), aa = p->aa - p->a * p->a / n, bb = p->bb - p->b * p->b / n;
    double ab = p->ab - p->a * p->b / n;
    if (!(p->n > MIN_WINDOWS && ab > 0.0 && aa * bb < SURE * ab * ab)) {
        return -1;
    }
    double factor = sqrt(bb / aa);
    for (int k = 0; k < UNITS; ++k) {
        if (fabs(factor / unit[k].factor - 1.0) < TOLERANCE && ab / aa > USUAL) {
            return k;
        }
    }
    return -1;
}

/* Unit of velocity i by position or depth, or by the accelerometer; -1: m/s, or not known. */
static int unit_of_velocity(const doctor_t *d, const doctor_sums_t *all, int i, const char **by)
{
    bool position = d->has[CSV_POSITION] && d->has[CSV_POSITION + 1] && i < 2 &&
                    !doctor_depth_has_other_unit(d);
    bool force = d->has[CSV_SPECIFIC_FORCE + i] && fabs(d->unit - 1.0) < TOLERANCE;
    if (position && doctor_is_fast(&all->ground[0][i][i])) {
        *by = "the rates of north_m and east_m";
        return unit_of(&all->ground[0][i][i]);
    }
    doctor_pair_t p = doctor_depth(d, all);
    if (i == 2 && d->has[CSV_POSITION + 2] && doctor_is_fast(&p)) {
        *by = "the rate of depth_m";
        return unit_of(&p);
    }
    p = all->inertial[i];
    *by = "what the accelerometer says";
    p = (doctor_pair_t){.n = p.n, .a = p.b, .b = p.a, .aa = p.bb, .bb = p.aa, .ab = p.ab};
    return force ? unit_of(&p) : -1;
}

static bool find_velocities(doctor_t *d, const doctor_sums_t *all)
{
    char names[48] = "";
    const char *by = "", *last = "";
    int found = -1, column = -1;
    for (int i = 0; i < 3; ++i) {
        int k = d->has[CSV_NU + i] ? unit_of_velocity(d, all, i, &last) : -1;
        if (k >= 0 && (found < 0 || k == found)) {
            size_t used = strlen(names);
            (void)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "",
                           csv_name[CSV_NU + i]);
            column = found < 0 ? CSV_NU + i : column;
            by = found < 0 ? last : by;
            found = k;
        }
    }
    if (found >= 0) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_SCALE, column, -1, NULL,
                   "%s: %.3g times %s, as if in %s: multiply by %s", names, unit[found].factor, by,
                   unit[found].name, unit[found].times);
    }
    return found >= 0;
}

/* Do the thrusters stop at their largest forces, divided by 9.81? */
static bool limits_are_kgf(const doctor_t *d)
{
    int stops = 0,
        thrusters = d->use != NULL && d->use->kind == INPUT_THRUST ? log_inputs(d->use) : 0;
    for (int k = 0; k < thrusters; ++k) {
        const doctor_column_t *c = &d->column[log_input(d->use, k)];
        const vehicle_thruster_t *t = &d->use->vehicle->thruster[k];
        bool forward = fabs(KGF * c->max / t->forward_N - 1.0) < TOLERANCE;
        bool backward = fabs(-KGF * c->min / t->backward_N - 1.0) < TOLERANCE;
        stops += forward && backward && c->at_limit > PLATEAU * c->n;
    }
    return 2 * stops > thrusters && thrusters > 0;
}

/* Mass in surge, sway or heave that follows from its force, over the dry mass; 0: not known. */
static double mass_of(const doctor_t *d, const doctor_sums_t *all, int j)
{
    double clean, against;
    doctor_gain_t g;
    bool known = d->dry_mass_kg > 0.0 && d->inputs == CSV_WRENCH && d->answers[j];
    if (!known) {
        return 0.0;
    }
    doctor_usual(all, j, &clean, &against, &g);
    bool driven = 0.5 * log(g.without / g.with) > DOCTOR_DRIVEN; /* also in a short log */
    return g.b > 0.0 && driven ? 1.0 / (g.b * d->dry_mass_kg) : 0.0;
}

/* What the log, or its vehicle, calls the forces. */
static const char *words_of_forces(const doctor_t *d)
{
    return d->use == NULL                 ? "X_N, Y_N, Z_N and the moments"
           : d->use->kind == INPUT_THRUST ? "the forces of the thrusters"
                                          : "forward_N, backward_N of the vehicle";
}

/* What makes them too small or too large. */
static const char *causes_of_scale(const doctor_t *d)
{
    return d->use != NULL && d->use->kind != INPUT_THRUST
               ? "forward_N, backward_N of the vehicle or the commands"
               : words_of_forces(d);
}

/* Finds forces in kilograms-force; least: smallest mass over the dry mass. */
static bool find_kgf(doctor_t *d, double least, int column)
{
    bool light = least < HEAVY_KGF && least > LIGHT_KGF;
    char why[96] = "they stop at a tenth of the largest forces of the vehicle";
    if (!light && !limits_are_kgf(d)) {
        return false;
    }
    if (light) {
        (void)snprintf(why, sizeof why, "the mass that follows is %.2g of the dry mass", least);
    }
    doctor_add(d, DOCTOR_ERROR, DOCTOR_SCALE, column, -1, NULL,
               "%s look like kilograms-force (%s): multiply them by 9.81%s", words_of_forces(d),
               why, light ? ", or correct the dry mass if it is too large" : "");
    return true;
}

/* Finds a mass of surge that velocities in knots may explain. */
static bool find_knots(doctor_t *d, const double mass[3], int column)
{
    bool slow = mass[0] > LIGHT_KNOT && mass[0] < HEAVY_KNOT;
    bool heave = mass[2] > 0.0 && mass[2] > 1.0;
    if (slow) {
        doctor_add(
            d, DOCTOR_WARNING, DOCTOR_SCALE, CSV_NU, column, NULL,
            "the mass that follows from u_mps and its force is %.2g of the dry mass%s: if "
            "%s in knots, multiply them by 0.5144; else %s too small, or the dry mass too large",
            mass[0], heave ? ", that of heave is not too small" : "",
            heave ? "u_mps and v_mps are" : "the velocities are",
            heave ? "the horizontal forces are" : "the forces are");
    }
    return slow;
}

/* Names a mass of DoF j that is impossible, and that no unit explains. */
static void add_light(doctor_t *d, double mass, int j, int column)
{
    bool sure = mass < LIGHT_KNOT && !d->known_force;
    doctor_add(
        d, sure ? DOCTOR_ERROR : DOCTOR_WARNING, DOCTOR_SCALE, CSV_NU + j, column, NULL,
        "the mass that follows from %s and its force is %.2g of the dry mass, but no vehicle "
        "has less than its dry mass: %s are too small, %s is too large, or the dry mass is",
        csv_name[CSV_NU + j], mass, causes_of_scale(d), csv_name[CSV_NU + j]);
}

/* Forces that are too large enlarge all masses. The smallest one decides, and only if surge is
 * among them: a flat hull may carry more water than its own mass across, not along its length. */
static void find_forces(doctor_t *d, const doctor_sums_t *all)
{
    double mass[3], least = HUGE_VAL;
    int lightest = 0, column = d->use == NULL ? CSV_WRENCH : log_input(d->use, 0);
    for (int j = 0; j < 3; ++j) {
        mass[j] = mass_of(d, all, j);
        if (mass[j] > 0.0 && mass[j] < least) {
            least = mass[j];
            lightest = j;
        }
    }
    if (find_kgf(d, least, column) || (least > LIGHT_KNOT && find_knots(d, mass, column))) {
        return;
    }
    if (least < HEAVY_KNOT) {
        add_light(d, least, lightest, column);
    } else if (mass[0] > 0.0 && least > HEAVIEST) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_SCALE, column, -1, NULL,
                   "the smallest mass that follows from velocities and forces is %.2g times the "
                   "dry mass, more than water adds: %s are too large, the velocities too small, or "
                   "the dry mass is",
                   least, causes_of_scale(d));
    }
}

static void find_positions(doctor_t *d)
{
    char text[200];
    if (d->use != NULL &&
        vehicle_far_thruster(d->use->vehicle, d->dry_mass_kg, text, sizeof text)) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_SCALE, -1, -1, NULL, "%s", text);
    }
}

void doctor_scale(doctor_t *d)
{
    doctor_sums_t all;
    find_positions(d);
    for (int i = 0; i < d->findings; ++i) {
        if (d->finding[i].severity == DOCTOR_ERROR) {
            return; /* which may be the cause */
        }
    }
    doctor_sum(d, 0, d->blocks - 1, &all);
    if (!find_velocities(d, &all)) {
        find_forces(d, &all);
    }
}

void doctor_dry_mass(doctor_t *d, double dry_mass_kg, bool known_force)
{
    d->known_force = known_force;
    d->dry_mass_kg = dry_mass_kg;
}
