/*
 * A vehicle file as a report: what it says, what is missing, what is assumed.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/config.h"
#include "../report/report.h"
#include "../base/report_error.h"
#include "vehicle_output.h"
#include "../bus/world.h"
#include "../vehicle/vehicle_thrusters.h"

/* Sets of the simulated identification. */
#define SETS 8

/* A table may exceed a largest force by this factor: rounding. */
#define BEYOND 1.05

static const char *const units[2] = {"N", "Nm"};

static void print_thrusters(const vehicle_t *v)
{
    const auvid_allocation_config_t *a = v->allocation;
    puts("  thruster              X       Y       Z       K       M       N    backward  forward");
    for (int i = 0; i < a->thrusters; ++i) {
        const auvid_thruster_t *t = &a->thruster[i];
        printf("  %-2d %-12.12s", i + 1, v->thruster[i].group);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            printf(" %7.3f", (double)t->wrench[j]);
        }
        printf("  %8.1f %8.1f N\n", (double)t->min_N, (double)t->max_N);
    }
}

static void print_capacity(const vehicle_t *v, const auvid_allocation_t *allocation)
{
    puts("\n  largest wrench  backward   forward         excitation");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t low = 0, high = 0;
        const char *unit = units[j >= AUVID_ROLL];
        (void)auvid_allocation_capacity(allocation, (auvid_dof_t)j, &low, &high);
        if (!(high > 0)) {
            printf("  %-14s not possible without another force or moment%s\n", report_dof_name[j],
                   v->model->columns[j] == 0 ? "; not modelled" : "");
            continue;
        }
        printf("  %-14s %9.1f %9.1f %-2s", report_dof_name[j], (double)low, (double)high, unit);
        if (v->amplitude[j] > 0) {
            printf("   %9.1f %s\n", (double)v->amplitude[j], unit);
        } else {
            puts(v->model->columns[j] == 0 ? "   not modelled" : "   not excited");
        }
    }
}

static bool is_zero(const auvid_real_t *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        sum += fabs((double)x[i]);
    }
    return sum <= 0.0;
}

/* Does the table of a group reach beyond the largest force of one of its thrusters? */
static bool is_beyond(const vehicle_t *v)
{
    bool any = false;
    for (int i = 0; i < v->allocation->thrusters; ++i) {
        const vehicle_thruster_t *t = &v->thruster[i];
        const thrust_map_t *map = &v->map[t->map];
        for (int k = 0; k < map->forces; ++k) {
            any = any || map->force_N[k] > BEYOND * t->forward_N ||
                  -map->force_N[k] > BEYOND * t->backward_N;
        }
    }
    return any;
}

/* Lines of the report on what the file leaves out, and on what is hardly right. */
static void print_missing(const vehicle_t *v)
{
    char far[200];
    bool newtons = false, voltage = true, any = false;
    for (int i = 0; i < v->maps; ++i) {
        newtons = newtons || v->map[i].kind == THRUST_MAP_NEWTON;
        bool needs = v->map[i].kind != THRUST_MAP_NEWTON && v->map[i].kind != THRUST_MAP_RPM;
        voltage = voltage && (!needs || v->map[i].voltage_V > 0.0);
    }
    const struct {
        bool missing;
        const char *text;
    } all[] = {
        {!(v->dry_mass_kg > 0), "[vehicle] dry_mass_kg: weigh it; a smaller mass is then refused"},
        {!v->has_excitation,
         "[excitation]: without it a log can be checked and fitted, but nothing is excited"},
        {!v->has_truth, "[truth]: rough parameters, so that demo can simulate it"},
        {newtons, "[group.NAME] map: without it thruster commands are read as newtons"},
        {!voltage, "[group.NAME] voltage_V, voltage_exponent: thrust follows the battery"},
        {is_beyond(v),
         "[group.NAME] force_N is beyond forward_N or backward_N of a thruster: which "
         "one is right?"},
        {vehicle_far_thruster(v, (double)v->dry_mass_kg, far, sizeof far), far},
        {v->has_excitation && is_zero(v->mount.dvl_lever, 3),
         "[mount] dvl_lever_m: on board the DVL is taken to be at the origin of the body"},
    };
    puts("\n  missing");
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i) {
        if (all[i].missing) {
            printf("    %s\n", all[i].text);
            any = true;
        }
    }
    if (!any) {
        puts("    nothing");
    }
}

/* Those that the guard watches. */
static void print_limits(const auvid_guard_config_t *g)
{
    const struct {
        const char *what, *unit;
        auvid_guard_cause_t cause;
        auvid_real_t limit;
    } limits[] = {{"depth at least", "m", AUVID_GUARD_DEPTH_MIN, g->depth_min_m},
                  {"depth at most", "m", AUVID_GUARD_DEPTH_MAX, g->depth_max_m},
                  {"above the bottom at least", "m", AUVID_GUARD_ALTITUDE, g->altitude_min_m},
                  {"from where it was armed at most", "m", AUVID_GUARD_DISTANCE, g->distance_max_m},
                  {"roll at most", "rad", AUVID_GUARD_ROLL, g->roll_max_rad},
                  {"pitch at most", "rad", AUVID_GUARD_PITCH, g->pitch_max_rad},
                  {"speed at most", "m/s", AUVID_GUARD_SPEED, g->speed_max},
                  {"yaw rate at most", "rad/s", AUVID_GUARD_YAW_RATE, g->yaw_rate_max},
                  {"time at most", "s", AUVID_GUARD_RUN_TIME, (auvid_real_t)g->run_max_s}};
    puts("  limits of the excitation");
    for (size_t i = 0; i < sizeof limits / sizeof *limits; ++i) {
        uint32_t off = g->off | (g->surface ? AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN) : 0u);
        if ((off & AUVID_GUARD_BIT(limits[i].cause)) == 0) {
            printf("    %s %.4g %s\n", limits[i].what, (double)limits[i].limit, limits[i].unit);
        }
    }
}

static void print_assumed(const vehicle_t *v)
{
    const auvid_uncertain_config_t *u = &v->uncertain;
    printf("\n  assumed (1 sigma)\n    thrust scale %.3g %%, DVL scale %.3g %%, delay %.3g s\n",
           100.0 * (double)v->uncertainty.thrust_scale, 100.0 * (double)v->uncertainty.dvl_scale,
           (double)v->uncertainty.delay_s);
    printf("    thrusters: backward %.3g %%, dead band %.3g %%, each gain %.3g %%, lag %.3g s "
           "about %.3g s, response %.3g s^2\n",
           100.0 * (double)u->backward, 100.0 * (double)u->dead_band, 100.0 * (double)u->gain,
           (double)u->lag_s, (double)u->nominal_lag_s, (double)u->response_s2);
    printf(
        "    hull: asymmetry of drag %.3g %%, centre of gravity %.3g m; water: current %.3g m/s\n",
        100.0 * (double)u->asymmetry, (double)u->gravity_m, (double)u->current);
    printf("    DVL: lever arm %.3g m, ", (double)u->arm_m);
    if ((v->model->columns[AUVID_ROLL] | v->model->columns[AUVID_PITCH]) != 0) {
        printf("turned %.3g rad, ", (double)u->mount_rad);
    }
    printf("%.3g s late, filtered %.3g s\n", (double)u->dvl_late_s, (double)u->filter_s);
    print_limits(&v->guard);
}

/* ---- which measurement helps most ---- */

/* How long the trial force acts, and from when [s]. */
#define TRIAL_S 60.0
#define TRIAL_FROM_S (0.4 * SETS * WORLD_SET_S)
/* Part of the excitation's force that it is, about. */
#define TRIAL_PART 0.2

/* A measurement that would help. */
typedef struct {
    char text[100];
    double dvl;           /* factor of its variance; 0: see with */
    const result_t *with; /* identified with it */
    double gain;          /* sum of the logarithms by which it divides the masses' errors */
} measurement_t;

/* Runs the excitation of the file on the simulated vehicle, with this known force; NULL: none.
 * Returns false if it did not finish. */
static bool simulate(const vehicle_t *v, const vehicle_calibration_t *known, result_t *result)
{
    static world_t world;
    static auvid_uncertain_t uncertain;
    const world_config_t config = {.vehicle = v,
                                   .seed = 1,
                                   .sets = SETS,
                                   .calibration = known,
                                   .calibrations = known != NULL ? 1 : 0};
    bool busy = true;
    if (!world_begin(&world, &config)) {
        return false;
    }
    (void)world_uncertain(&world.node[0], &uncertain, v); /* if there is room for them */
    while (busy || world.node[0].id.metric.sets.recorded < SETS) {
        if (world_time_s(&world) > 2.0 * SETS * WORLD_SET_S) {
            return false;
        }
        world_tick(&world);
        busy = world_work(&world, AUVID_DEFAULT_BUDGET);
    }
    report_gather(result, &world.node[0].id, 1);
    if (known != NULL) {
        report_calibrate(result, &world.calibrated);
    }
    return true;
}

/* Is parameter i a mass that was identified? */
static bool is_known_mass(const result_t *r, int i)
{
    return report_is_identified(r, i) && isfinite(report_sigma_told(r, i)) &&
           r->vehicle->parameter[i].kind == AUVID_PARAMETER_MASS;
}

/* Relative standard error of parameter i after a measurement. By its factor: considered parameters
 * (Schmidt 1966). */
static double error_after(const measurement_t *m, const result_t *r, int i)
{
    const auvid_confidence_t *c = &r->estimate.confidence;
    double told = report_sigma_told(r, i), t = (double)c->thrust_error[i];
    double d = (double)c->dvl_error[i];
    if (m->with != NULL) {
        return report_sigma(m->with, i) / fabs((double)m->with->estimate.pi[i]);
    }
    return sqrt(told * told + t * t + m->dvl * d * d) / fabs((double)r->estimate.pi[i]);
}

/* 1, 2 or 5 times a power of ten, not above x > 0. */
static double round_down(double x)
{
    double unit = pow(10.0, floor(log10(x)));
    return unit * (x >= 5.0 * unit ? 5.0 : x >= 2.0 * unit ? 2.0 : 1.0);
}

/* Chooses a known force for the vehicle: a weight, or without heave a pull. */
static void choose_trial(const vehicle_t *v, vehicle_calibration_t *trial, char *text, size_t size)
{
    bool heave = v->amplitude[AUVID_HEAVE] > 0;
    double largest = (double)v->amplitude[heave ? AUVID_HEAVE : AUVID_SURGE];
    double force = largest > 0.0 ? round_down(TRIAL_PART * largest) : 1.0;
    *trial = (vehicle_calibration_t){.from_s = TRIAL_FROM_S, .to_s = TRIAL_FROM_S + TRIAL_S};
    if (heave) {
        trial->force.world[2] = (auvid_real_t)force;
        (void)snprintf(text, size, "%g N of weight in water for %g s", force, TRIAL_S);
    } else {
        trial->force.body[0] = (auvid_real_t)-force;
        (void)snprintf(text, size, "a pull of %g N astern for %g s", force, TRIAL_S);
    }
}

static int by_gain(const void *a, const void *b)
{
    double x = ((const measurement_t *)a)->gain, y = ((const measurement_t *)b)->gain;
    return (x < y) - (x > y);
}

/* Lists the measurements, best first, for the mass that is known worst. */
static void print_measurements(const result_t *r, measurement_t *all, size_t count)
{
    const measurement_t none = {.dvl = 1.0};
    int shown = -1;
    for (int i = 0; i < r->vehicle->parameters; ++i) {
        if (!is_known_mass(r, i)) {
            continue;
        }
        double now = error_after(&none, r, i);
        shown = shown < 0 || now > error_after(&none, r, shown) ? i : shown;
        for (size_t k = 0; k < count; ++k) {
            all[k].gain += log(now / error_after(&all[k], r, i));
        }
    }
    if (shown < 0) {
        puts("\n  measurements that would help\n    none of those known here: no mass was "
             "identified");
        return;
    }
    qsort(all, count, sizeof *all, by_gain);
    printf("\n  measurements that would help, best first (of a simulated identification of %d s)\n"
           "    standard error of %s, now %.2g %%, after\n",
           SETS * WORLD_SET_S, r->vehicle->parameter[shown].name,
           100.0 * error_after(&none, r, shown));
    for (size_t k = 0; k < count; ++k) {
        printf("    %6.2g %%  %s\n", 100.0 * error_after(&all[k], r, shown), all[k].text);
    }
}

/* Simulates the vehicle with and without a known force. Returns false if it did not finish. */
static bool advise(const vehicle_t *v)
{
    static result_t plain, calibrated;
    vehicle_calibration_t trial;
    measurement_t all[2] = {{.dvl = 0.25}, {.with = &calibrated}};
    (void)snprintf(all[0].text, sizeof all[0].text,
                   "a run over a known distance that halves the error of the DVL scale");
    choose_trial(v, &trial, all[1].text, sizeof all[1].text);
    if (!simulate(v, NULL, &plain)) {
        return false;
    }
    bool seen = simulate(v, &trial, &calibrated) && calibrated.calibration == REPORT_CALIBRATED;
    print_measurements(&plain, all, seen ? 2 : 1);
    return true;
}

int vehicle_report(const vehicle_t *v, const char *path)
{
    auvid_allocation_t allocation;
    if (auvid_allocation_init(&allocation, v->allocation) < 0) {
        return report_error("check: %s: the thrusters are refused", path);
    }
    printf("auvid %s check: %s (%s), model %s with %d parameters, %d thrusters\n\n",
           AUVID_VERSION_STRING, v->title, path, v->model->name, v->model->parameters,
           v->allocation->thrusters);
    print_thrusters(v);
    print_capacity(v, &allocation);
    print_missing(v);
    print_assumed(v);
    return !v->has_truth || !v->has_excitation || advise(v)
               ? 0
               : report_error("check: %s: the simulated vehicle could not be excited to the end: "
                              "see auvid demo --vehicle %s",
                              path, path);
}
