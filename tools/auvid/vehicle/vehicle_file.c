#include "vehicle_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/fossen.h"
#include "../base/report_error.h"
#include "vehicle_calibration.h"
#include "vehicle_keys.h"
#include "vehicle_terms.h"
#include "vehicle_thrusters.h"

/* ---- defaults, sections ---- */

static void set_defaults(vehicle_t *v)
{
    auvid_guard_defaults(&v->guard);
    auvid_uncertain_defaults(&v->uncertain);
    auvid_allocation_defaults(&v->allocation_cfg);
    sim_defaults(&v->sim);
    v->allocation = &v->allocation_cfg;
}

/* Is this the section of a thruster or a group, or another one that is known? */
static bool is_known(const char *section)
{
    static const char *const others[] = {"parameters", "terms"};
    char *end = NULL;
    if (strncmp(section, "thruster.", 9) == 0) {
        long number = strtol(section + 9, &end, 10);
        return section[9] >= '1' && section[9] <= '9' && *end == '\0' &&
               number <= VEHICLE_THRUSTERS;
    }
    if (strncmp(section, "calibration.", 12) == 0) {
        return section[12] >= '1' && section[12] <= '0' + VEHICLE_CALIBRATIONS &&
               section[13] == '\0';
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; ++i) {
        if (strcmp(section, others[i]) == 0) {
            return true;
        }
    }
    for (int i = 0; i < KEYS_SECTIONS; ++i) {
        if (i != KEYS_THRUSTER && i != KEYS_GROUP && i != KEYS_CALIBRATION &&
            strcmp(section, vehicle_keys[i].section) == 0) {
            return true;
        }
    }
    return strncmp(section, "group.", 6) == 0 && section[6] != '\0' &&
           strlen(section + 6) < VEHICLE_WORD;
}

static bool check_sections(ini_t *ini)
{
    for (int i = 0; i < ini->entries; ++i) {
        const ini_entry_t *e = &ini->entry[i];
        if (e->key[0] == '\0' && !is_known(e->section)) {
            return ini_refuse(ini, e->line, e->key_column,
                              "unknown section [%s]; known: vehicle, parameters, terms, "
                              "thruster.1 .. thruster.%d, group.NAME, allocation, excitation, "
                              "guard, mount, uncertainty, uncertain, calibration.1 .. "
                              "calibration.%d, truth",
                              e->section, VEHICLE_THRUSTERS, VEHICLE_CALIBRATIONS);
        }
    }
    return true;
}

/* ---- model ---- */

static bool read_model(ini_t *ini, vehicle_t *v)
{
    const ini_entry_t *model = ini_find(ini, "vehicle", "model");
    const char *const only[] = {"parameters", "terms"};
    for (int i = 0; i < 2 && v->kind != VEHICLE_TERMS; ++i) {
        if (ini_find(ini, only[i], "") != NULL) {
            return ini_refuse(ini, ini_line(ini, only[i]), 1,
                              "section [%s] belongs to the model 'terms'; line %d has another one",
                              only[i], model->line);
        }
    }
    if (v->kind == VEHICLE_TERMS) {
        v->model = &v->table.terms.vehicle;
        return vehicle_terms_read(ini, v->title, &v->table);
    }
#if AUVID_MAX_PARAMETERS >= 22
    if (v->kind == VEHICLE_FOSSEN) {
        v->fossen = auvid_fossen;
        v->fossen.name = v->title;
        v->model = &v->fossen;
        return true;
    }
#endif
#if AUVID_MAX_PARAMETERS >= 13
    if (v->kind == VEHICLE_GIRONA500) {
        v->model = &auvid_girona500;
        return true;
    }
#endif
    return ini_refuse(ini, model->line, model->value_column,
                      "model: this program is built for %d parameters, too few for this model",
                      AUVID_MAX_PARAMETERS);
}

/* ---- uncertainties, truth ---- */

static bool read_uncertainty(ini_t *ini, vehicle_t *v)
{
    auvid_identifier_config_t cfg;
    auvid_identifier_defaults(&cfg, v->model);
    v->uncertainty = cfg.uncertainty;
    double given = 0.0;
    for (int i = 0; i < v->maps; ++i) {
        given = fmax(given, v->map[i].uncertainty);
    }
    if (given > 0.0) {
        v->uncertainty.thrust_scale = (auvid_real_t)given;
    }
    return vehicle_keys_section(ini, "uncertainty", KEYS_UNCERTAINTY, v) &&
           vehicle_keys_section(ini, "uncertain", KEYS_UNCERTAIN, v);
}

/* The diagonal stands in the first row; what is below the diagonal, also above it. */
static void spread_added_mass(double added[6][6])
{
    double diagonal[6];
    memcpy(diagonal, added[0], sizeof diagonal);
    memset(added[0], 0, sizeof added[0]);
    for (int i = 0; i < 6; ++i) {
        added[i][i] = diagonal[i];
        for (int j = 0; j < i; ++j) {
            added[j][i] = added[i][j];
        }
    }
}

static void simulate_mount(const auvid_nav_mount_t *mount, sim_config_t *sim)
{
    for (int i = 0; i < 3; ++i) {
        sim->dvl_arm_m[i] = (double)mount->dvl_lever[i];
        sim->dvl_euler[i] = (double)mount->dvl_euler[i];
        sim->imu_euler[i] = (double)mount->imu_euler[i];
    }
}

/* The simulated vehicle must start within the limits of the guard, or it is never excited. */
static bool check_start(ini_t *ini, const vehicle_t *v)
{
    const auvid_guard_config_t *g = &v->guard;
    bool no_low = g->surface || (g->off & AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN)) != 0;
    bool no_high = (g->off & AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX)) != 0;
    bool no_floor = (g->off & AUVID_GUARD_BIT(AUVID_GUARD_ALTITUDE)) != 0;
    double depth = v->sim.position[2], low = no_low ? 0.0 : (double)g->depth_min_m;
    double floor_m = v->sim.seabed_m - (no_floor ? 0.0 : (double)g->altitude_min_m);
    double high = no_high ? floor_m : fmin((double)g->depth_max_m, floor_m);
    const ini_entry_t *e = ini_find(ini, "truth", "depth_m");
    return (depth >= low && depth <= high) ||
           ini_refuse(ini, e != NULL ? e->line : ini_line(ini, "truth"), 1,
                      "depth_m: the simulation would start at %g m, outside of the guard's %g .. "
                      "%g m (seabed at %g m); set depth_m",
                      depth, low, high, v->sim.seabed_m);
}

/* A mass includes that of the water which moves along. */
static bool check_masses(ini_t *ini, const vehicle_t *v)
{
    static const char *const girona500[] = {"m_u", "m_v", "m_w"};
    for (int i = 0; i < 3 && v->kind == VEHICLE_GIRONA500; ++i) {
        if (v->sim.parameter[SIM_M_U + i] < (double)v->dry_mass_kg) {
            return ini_refuse_key(ini, "truth", girona500[i],
                                  "is below dry_mass_kg, but contains it and the added mass");
        }
    }
    return v->kind != VEHICLE_FOSSEN || v->sim.fossen.mass_kg >= (double)v->dry_mass_kg ||
           ini_refuse_key(ini, "truth", "mass_kg",
                          "is below dry_mass_kg, but contains it and the water inside");
}

static bool read_truth(ini_t *ini, vehicle_t *v)
{
    static const sim_model_t models[] = {SIM_GIRONA500, SIM_FOSSEN, SIM_VEHICLE};
    const vehicle_keys_t *table[] = {
        &vehicle_keys[KEYS_TRUTH],
        &vehicle_keys[v->kind == VEHICLE_FOSSEN ? KEYS_TRUTH_FOSSEN : KEYS_TRUTH_GIRONA500]};
    int tables = v->kind == VEHICLE_TERMS ? 1 : 2;
    sim_t *sim = NULL;
    v->has_truth = ini_find(ini, "truth", "") != NULL;
    v->sim.model = models[v->kind];
    v->sim.vehicle = v->model;
    simulate_mount(&v->mount, &v->sim);
    if (!v->has_truth) {
        return true;
    }
    if (v->guard.surface) {
        v->sim.position[2] = 0.0; /* its default */
    }
    if (!vehicle_keys_read(ini, "truth", table[0], v) ||
        (v->kind == VEHICLE_TERMS &&
         !vehicle_terms_truth(ini, &v->table, v->sim.vehicle_parameter)) ||
        (tables == 2 && !vehicle_keys_read(ini, "truth", table[1], v)) ||
        !vehicle_keys_unknown(ini, "truth", table, tables,
                              v->kind == VEHICLE_TERMS ? "those of [parameters], " : "") ||
        !check_masses(ini, v) || !check_start(ini, v)) {
        return false;
    }
    spread_added_mass(v->sim.fossen.added);
    sim = malloc(sizeof *sim);
    bool good = sim != NULL && sim_init(sim, &v->sim);
    free(sim);
    return good || ini_refuse(ini, ini_line(ini, "truth"), 1,
                              "[truth] cannot be simulated: its mass matrix is not positive "
                              "definite, or hold_Nm_rad needs thrusters that give all six degrees "
                              "of freedom");
}

/* ---- the file ---- */

static bool read_guard(ini_t *ini, vehicle_t *v)
{
    auvid_guard_t guard;
    if (!vehicle_keys_section(ini, "guard", KEYS_GUARD, v)) {
        return false;
    }
    return auvid_guard_init(&guard, &v->guard) >= 0 ||
           ini_refuse_key(ini, "guard", "depth_max_m", "must not be less than depth_min_m");
}

static bool read_all(ini_t *ini, vehicle_t *v)
{
    static const char *const needed[] = {"vehicle", "thruster.1"};
    if (!check_sections(ini)) { /* before what may only be misspelt is missing */
        return false;
    }
    for (int i = 0; i < 2; ++i) {
        if (ini_find(ini, needed[i], "") == NULL) {
            return ini_refuse(ini, 1, 1, "no section [%s]: add it", needed[i]);
        }
    }
    if (!vehicle_keys_section(ini, "vehicle", KEYS_VEHICLE, v) || !read_model(ini, v) ||
        !vehicle_thrusters_read(ini, v) ||
        !vehicle_keys_section(ini, "allocation", KEYS_ALLOCATION, v) ||
        !vehicle_allocation_check(ini, v) ||
        !vehicle_keys_section(ini, "excitation", KEYS_EXCITATION, v) || !read_guard(ini, v) ||
        !vehicle_keys_section(ini, "mount", KEYS_MOUNT, v) || !read_uncertainty(ini, v) ||
        !vehicle_calibrations_read(ini, v) || !read_truth(ini, v)) {
        return false;
    }
    vehicle_excitation_check(ini, v);
    /* Girona500 reports the parameters of the paper */
    v->linger_ticks =
        10u * (v->kind == VEHICLE_GIRONA500 ? SIM_PARAMETERS : (uint32_t)v->model->parameters);
    return true;
}

vehicle_t *vehicle_file_parse(const char *path, const char *text, size_t length, char *message,
                              size_t size)
{
    ini_t *ini = malloc(sizeof *ini);
    vehicle_t *v = calloc(1, sizeof *v);
    bool good = ini != NULL && v != NULL;
    (void)snprintf(message, size, "%s: not enough memory", path);
    if (good) {
        set_defaults(v);
        good = ini_parse(ini, path, text, length) && read_all(ini, v);
        (void)snprintf(message, size, "%s", ini->message);
    }
    free(ini);
    if (!good) {
        free(v);
        v = NULL;
    }
    return v;
}

vehicle_t *vehicle_file_read(const char *path)
{
    char message[INI_MESSAGE], *text = malloc(INI_BYTES + 1);
    FILE *file = text != NULL ? fopen(path, "rb") : NULL;
    vehicle_t *v = NULL;
    if (file != NULL) {
        size_t length = fread(text, 1, INI_BYTES + 1, file);
        if (ferror(file)) {
            (void)snprintf(message, sizeof message, "%s: %s", path, strerror(errno));
        } else {
            v = vehicle_file_parse(path, text, length, message, sizeof message);
        }
        (void)fclose(file);
    } else {
        (void)snprintf(message, sizeof message, "%s: %s", path, strerror(errno));
    }
    free(text);
    if (v == NULL) {
        report_error_line("%s", message);
    }
    return v;
}

double vehicle_file_thrust(const vehicle_t *vehicle, const thrust_map_t *map, int i, double command,
                           double voltage_V)
{
    const vehicle_thruster_t *t = &vehicle->thruster[i];
    return thrust_map_force(&map[t->map], t->forward_N, t->backward_N, command, voltage_V);
}

void vehicle_warn_mount(const vehicle_t *vehicle, const char *log)
{
    const auvid_real_t *lever = vehicle->mount.dvl_lever;
    if (fabs((double)lever[0]) + fabs((double)lever[1]) + fabs((double)lever[2]) > 0.0) {
        report_warning("%s: [mount] of the vehicle file is not applied to a log: its velocities "
                       "must be those of the body's origin: subtract omega x dvl_lever_m",
                       log);
    }
}
