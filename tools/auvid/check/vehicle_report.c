/*
 * A vehicle file as a report: what it says, what is missing, what is assumed.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/config.h"
#include "../report/report.h"
#include "../base/report_error.h"
#include "vehicle_output.h"
#include "../bus/world.h"

/* A calibration of the thrust that a known weight allows, relative (1 sigma). */
#define CALIBRATED 0.02
/* Sets of the simulated identification. */
#define SETS 8

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
    puts("\n  largest wrench  backward   forward         excited by");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t low = 0, high = 0;
        const char *unit = units[j >= AUVID_ROLL];
        (void)auvid_allocation_capacity(allocation, (auvid_dof_t)j, &low, &high);
        if (!(high > 0)) {
            printf("  %-14s none without another wrench%s\n", report_dof_name[j],
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

/* Lines of the report on what the file leaves out. */
static void print_missing(const vehicle_t *v)
{
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
        {!v->has_truth, "[truth]: rough parameters, so that demo can simulate it"},
        {newtons, "[group.NAME] map: without it thruster commands are read as newtons"},
        {!voltage, "[group.NAME] voltage_V, voltage_exponent: thrust follows the battery"},
        {is_zero(v->mount.dvl_lever, 3),
         "[mount] dvl_lever_m: the DVL is taken to be at the origin of the body"},
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

static void print_assumed(const vehicle_t *v)
{
    const auvid_guard_config_t *g = &v->guard;
    const auvid_uncertain_config_t *u = &v->uncertain;
    printf("\n  assumed (1 sigma)\n    thrust scale %.3g %%, DVL scale %.3g %%, delay %.3g s\n",
           100.0 * (double)v->uncertainty.thrust_scale, 100.0 * (double)v->uncertainty.dvl_scale,
           (double)v->uncertainty.delay_s);
    printf("    thrusters: backward %.3g %%, dead band %.3g %%, each gain %.3g %%, lag %.3g s "
           "about %.3g s\n",
           100.0 * (double)u->backward, 100.0 * (double)u->dead_band, 100.0 * (double)u->gain,
           (double)u->lag_s, (double)u->nominal_lag_s);
    printf("    hull: asymmetry of drag %.3g %%; water: current %.3g m/s\n",
           100.0 * (double)u->asymmetry, (double)u->current);
    printf("  limits of the excitation\n    %s%.3g .. %.3g m deep, %.3g m above the bottom, "
           "%.3g m from where it was armed\n    roll %.3g, pitch %.3g rad, %.3g m/s, %.3g rad/s, "
           "%u s\n",
           g->surface ? "at the surface, or " : "", (double)g->depth_min_m, (double)g->depth_max_m,
           (double)g->altitude_min_m, (double)g->distance_max_m, (double)g->roll_max_rad,
           (double)g->pitch_max_rad, (double)g->speed_max, (double)g->yaw_rate_max,
           (unsigned)g->run_max_s);
}

/* ---- which measurement helps most ---- */

/* Runs the excitation of the file on the simulated vehicle. @return NULL if it did not finish */
static const auvid_identifier_t *simulate(const vehicle_t *v)
{
    static world_t world;
    const world_config_t config = {.vehicle = v, .seed = 1, .sets = SETS};
    bool busy = true;
    if (!world_begin(&world, &config)) {
        return NULL;
    }
    while (busy || world.node[0].id.metric.sets.recorded < SETS) {
        if (world_time_s(&world) > 2.0 * SETS * WORLD_SET_S) {
            return NULL;
        }
        world_tick(&world);
        busy = world_work(&world, AUVID_DEFAULT_BUDGET);
    }
    return &world.node[0].id;
}

/* Relative standard error of parameter i, with the variances of data, thrust scale and DVL scale
 * multiplied by these factors (considered parameters; Schmidt 1966). */
static double error_with(const result_t *r, int i, double data, double thrust, double dvl)
{
    const auvid_confidence_t *c = &r->estimate.confidence;
    double told = report_sigma_told(r, i), t = (double)c->thrust_error[i];
    double d = (double)c->dvl_error[i];
    return sqrt(data * told * told + thrust * t * t + dvl * d * d) /
           fabs((double)r->estimate.pi[i]);
}

/* Variance factors of the measurements, one row each: data, thrust scale, DVL scale. */
static void print_best(const result_t *r, double thrust_scale)
{
    double gain = thrust_scale > CALIBRATED ? pow(CALIBRATED / thrust_scale, 2.0) : 1.0;
    const struct {
        const char *text;
        double factor[3];
    } all[] = {
        {"a known force, e.g. a weight in water, that gives the thrust scale to 2 %",
         {1.0, gain, 1.0}},
        {"a run over a known distance that halves the error of the DVL scale", {1.0, 1.0, 0.25}},
        {"twice as many sets", {0.5, 1.0, 1.0}}};
    int best = -1, shown = -1;
    double best_gain = 0.0, worst = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double *f = all[k].factor;
        double sum = 0.0;
        for (int i = 0; i < r->vehicle->parameters; ++i) {
            bool known = report_is_identified(r, i) && isfinite(report_sigma_told(r, i)) &&
                         r->vehicle->parameter[i].kind == AUVID_PARAMETER_MASS;
            double now = known ? error_with(r, i, 1.0, 1.0, 1.0) : 0.0;
            sum += known ? log(now / error_with(r, i, f[0], f[1], f[2])) : 0.0;
            shown = known && now > worst ? i : shown;
            worst = known && now > worst ? now : worst;
        }
        best = sum > best_gain ? k : best;
        best_gain = sum > best_gain ? sum : best_gain;
    }
    if (best < 0 || shown < 0) {
        puts("\n  a measurement that would help\n    none of those known here: no mass was "
             "identified");
        return;
    }
    const double *f = all[best].factor;
    printf("\n  a measurement that would help most (of a simulated identification of %d sets)\n"
           "    %s:\n    takes the standard error of %s from %.2g to %.2g %%\n",
           SETS, all[best].text, r->vehicle->parameter[shown].name, 100.0 * worst,
           100.0 * error_with(r, shown, f[0], f[1], f[2]));
}

int vehicle_report(const vehicle_t *v, const char *path)
{
    static result_t result;
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
    if (v->has_truth) {
        const auvid_identifier_t *id = simulate(v);
        if (id == NULL) {
            return report_error("check: %s: the simulated vehicle could not be excited to the end: "
                                "see auvid demo --vehicle %s",
                                path, path);
        }
        report_gather(&result, id, 1);
        print_best(&result, (double)v->uncertainty.thrust_scale);
    }
    return 0;
}
