#include "vehicles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/fossen.h"
#include "auvid/vehicle.h"
#include "../base/ini.h"
#include "../base/report_error.h"
#include "vehicles_ready.h"

/* Interval of the DVL samples. */
#define DVL_US 200000u

/* Bound of every parameter, and the dry mass up to which it is the same [kg]. */
#define BOUND 1000.0
#define BOUND_MASS_KG 250.0

/* Vehicles in use: the ready ones, each read when it is needed, and those of files. */
enum { READY = 8, FILES = 8 };
static vehicle_t *vehicle_ready[READY], *vehicle_of_file[FILES];

/* Reads a ready vehicle. NULL if this build is too small for it. */
static vehicle_t *read_ready(const embedded_t *file)
{
    char message[INI_MESSAGE], *text = calloc(1, INI_BYTES);
    vehicle_t *v = NULL;
    size_t length = 0;
    for (const char *const *piece = file->piece; text != NULL && *piece != NULL; ++piece) {
        size_t more = strlen(*piece);
        memcpy(text + length, *piece, more);
        length += more;
    }
    if (text != NULL) {
        v = vehicle_file_parse(file->name, text, length, message, sizeof message);
    }
    free(text);
    return v;
}

/* Is this the file of the vehicle with this name? */
static bool is_file_of(const embedded_t *file, const char *word)
{
    size_t length = strlen(word);
    return strncmp(file->name, word, length) == 0 && strcmp(file->name + length, ".ini") == 0;
}

const vehicle_t *vehicle_named(const char *word)
{
    for (int i = 0; i < READY && vehicles_ready[i].name != NULL; ++i) {
        if (is_file_of(&vehicles_ready[i], word)) {
            vehicle_ready[i] =
                vehicle_ready[i] != NULL ? vehicle_ready[i] : read_ready(&vehicles_ready[i]);
            return vehicle_ready[i];
        }
    }
    return NULL;
}

const vehicle_t *vehicle_default(void)
{
    return vehicle_named("girona500");
}

const char *vehicle_words(void)
{
    static char words[READY * VEHICLE_WORD];
    words[0] = '\0';
    for (int i = 0; i < READY && vehicles_ready[i].name != NULL; ++i) {
        char word[VEHICLE_WORD] = "";
        size_t at = strlen(words);
        (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(vehicles_ready[i].name, "."),
                       vehicles_ready[i].name);
        if (vehicle_named(word) != NULL) {
            (void)snprintf(words + at, sizeof words - at, "%s%s", at > 0 ? ", " : "", word);
        }
    }
    return words;
}

static bool is_path(const char *word)
{
    size_t length = strlen(word);
    return strchr(word, '/') != NULL || (length >= 4 && strcmp(word + length - 4, ".ini") == 0);
}

const vehicle_t *vehicle_chosen(const char *who, const char *word)
{
    if (is_path(word)) {
        for (int i = 0; i < FILES; ++i) {
            if (vehicle_of_file[i] == NULL) {
                return vehicle_of_file[i] = vehicle_file_read(word);
            }
        }
        report_error_line("%s: more than %d vehicle files", who, FILES);
        return NULL;
    }
    const vehicle_t *v = vehicle_named(word);
    if (v == NULL) {
        report_error_line("%s: '%s' is not one of %s, and no FILE.ini", who, word, vehicle_words());
    }
    return v;
}

const auvid_vehicle_t *vehicle_model(const char *who, const char *word)
{
    const vehicle_t *v = is_path(word) ? vehicle_chosen(who, word) : vehicle_named(word);
#if AUVID_MAX_PARAMETERS >= 22
    if (strcmp(word, "fossen") == 0) {
        return &auvid_fossen;
    }
#endif
    if (v == NULL && !is_path(word)) {
        report_error_line("%s: '%s' is not one of girona500, fossen, %s, and no FILE.ini", who,
                          word, vehicle_words() + strlen("girona500, "));
    }
    return v != NULL ? v->model : NULL;
}

void vehicle_simulation(const vehicle_t *vehicle, vehicle_sim_config_t *cfg)
{
    vehicle_sim_defaults(cfg);
    cfg->sim = vehicle->sim;
    cfg->allocation = vehicle->allocation;
}

static bool is_fast(const vehicle_t *const *vehicle, int count, const auvid_vehicle_t *model)
{
    for (int i = 0; i < count; ++i) {
        if (vehicle[i] != NULL && vehicle[i]->fast && vehicle[i]->model == model) {
            return true;
        }
    }
    return false;
}

static void average(auvid_identifier_config_t *cfg, uint32_t mean_us)
{
    static auvid_averaged_t averaged; /* of the vehicle that is identified */
    if (auvid_averaged_init(&averaged, cfg->vehicle, mean_us, DVL_US) == AUVID_OK) {
        cfg->vehicle = cfg->metric.vehicle = &averaged.vehicle;
        cfg->metric.half_width[1] = 4;
        cfg->metric.max_cell_us = 0; /* the average is over cells of this length */
    }
}

void vehicle_use_averaged_model(auvid_identifier_config_t *cfg, bool residual)
{
    if (is_fast((const vehicle_t *const *)vehicle_ready, READY, cfg->vehicle) ||
        is_fast((const vehicle_t *const *)vehicle_of_file, FILES, cfg->vehicle)) {
        cfg->metric.row_cells = residual ? 2 : cfg->metric.row_cells;
        average(cfg, (residual ? 2u : 1u) * cfg->recorder.cell_us);
    }
}

void vehicle_use_fast_excitation(auvid_excitation_config_t *excitation)
{
    for (int i = 0; i < excitation->segments; ++i) {
        auvid_segment_t *segment = &excitation->segment[i];
        if (segment->dof >= AUVID_ROLL) {
            segment->frequency_hz = AUVID_C(0.1);
            segment->frequency_high_hz = AUVID_C(0.8);
            segment->hold_min_s = 1;
            segment->hold_max_s = 3;
        }
    }
}

double vehicle_bound(double dry_mass_kg)
{
    double factor = dry_mass_kg / BOUND_MASS_KG;
    return factor > 1.0 ? BOUND * factor * factor : BOUND;
}

void vehicle_bounds(double dry_mass_kg, auvid_identifier_config_t *cfg)
{
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        cfg->search.upper[i] = (auvid_real_t)vehicle_bound(dry_mass_kg);
        cfg->search.lower[i] = -cfg->search.upper[i];
    }
}

void vehicle_identifier(const vehicle_t *vehicle, uint64_t seed, auvid_identifier_config_t *cfg)
{
    auvid_identifier_defaults(cfg, vehicle->model);
    cfg->search.seed = seed;
    cfg->exact_inputs = true; /* those of the simulated vehicles are */
    cfg->nav.mount = vehicle->mount;
    cfg->uncertainty = vehicle->uncertainty;
    cfg->dry_mass_kg = vehicle->dry_mass_kg;
    vehicle_bounds((double)vehicle->dry_mass_kg, cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (vehicle->amplitude[j] > 0) {
            cfg->metric.tau_max[j] = vehicle->amplitude[j];
        }
    }
    if (vehicle->fast) {
        average(cfg, cfg->recorder.cell_us);
    }
}

void vehicle_actuation(const vehicle_t *vehicle, auvid_real_t set_s, uint32_t sets, uint64_t seed,
                       uint8_t idle, auvid_actuation_config_t *cfg)
{
    auvid_real_t amplitude[AUVID_DOF_COUNT];
    auvid_actuation_defaults(cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        amplitude[j] = (idle >> j & 1u) ? AUVID_C(0.0) : vehicle->amplitude[j];
    }
    (void)auvid_excitation_plan(&cfg->excitation, amplitude, set_s, sets, seed);
    if (vehicle->fast) {
        vehicle_use_fast_excitation(&cfg->excitation);
    }
    cfg->guard = vehicle->guard;
}
