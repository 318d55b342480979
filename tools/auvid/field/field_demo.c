/*
 * auvid demo with --field, --mismatch or --matched: statistics of vehicles with mismatches.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../commands.h"
#include "../base/report_error.h"
#include "field_causes.h"
#include "field_report.h"
#include "../base/progress.h"

/* Random stream of --matched. */
#define MATCHED_STREAM 1000

/* Memory of a campaign. */
typedef struct {
    field_run_t run;
    field_run_config_t cfg;
    field_campaign_t campaign;
    field_table_t table;
    field_record_t *record; /* [runs] */
    char world[600], driver[40];
} campaign_memory_t;

/* Applies NAME=SIZE. Returns 0, or EXIT_REFUSED after an error message. */
static int set_mismatch(const char *text, field_config_t *field)
{
    char name[64], *end = NULL;
    const char *equals = strchr(text, '=');
    size_t length = equals == NULL ? 0 : (size_t)(equals - text);
    if (length == 0 || length >= sizeof name) {
        return report_error("--mismatch: '%s' is neither NAME=SIZE nor list", text);
    }
    memcpy(name, text, length);
    name[length] = '\0';
    double size = strtod(equals + 1, &end);
    const field_mismatch_t *kind;
    for (int k = 0, count = field_mismatches(&kind); k < count; ++k) {
        if (strcmp(kind[k].name, name) == 0) {
            return end != equals + 1 && *end == '\0' && field_set(field, name, size)
                       ? 0
                       : report_error("--mismatch: '%s' is not a number from %g to %g", text,
                                      kind[k].min_size, kind[k].max_size);
        }
    }
    return report_error("--mismatch: '%s' is not a mismatch (see --mismatch list)", name);
}

/* Removes all mismatches of the thrust. */
static void perfect_thrust(field_config_t *field)
{
    const field_mismatch_t *kind;
    for (int k = 0, count = field_mismatches(&kind); k < count; ++k) {
        if (strncmp(kind[k].name, "thrust_", strlen("thrust_")) == 0) {
            field->size[k] = 0.0;
        }
    }
}

/* Draws only the two scales, with the standard deviations that the identifier is given. */
static void draw_matched(const auvid_uncertainty_t *u, field_config_t *field)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, field->seed, MATCHED_STREAM);
    field_draw(field, 0.0);
    (void)field_set(field, "thrust_common", (double)u->thrust_scale * sim_rng_gauss(&rng));
    (void)field_set(field, "dvl_scale", (double)u->dvl_scale * sim_rng_gauss(&rng));
}

/* Configures the run with this seed. */
static int make_world(const options_t *options, const auvid_uncertainty_t *u, uint64_t seed,
                      field_run_config_t *cfg)
{
    const options_field_t *f = &options->field;
    field_config_t *field = &cfg->field;
    int status = 0;
    field_defaults(field, f->vehicle, f->driver, seed);
    field->alternate_m = f->alternate_m;
    if (f->driver == FIELD_EXCITED) {
        field->length_s = 30.0 * options->sets;
    } else if (f->hours > 0.0) {
        field->length_s = 3600.0 * f->hours;
    }
    if (f->matched) {
        draw_matched(u, field);
    } else if (f->mixture) {
        field_draw(field, f->strength);
    }
    if (f->perfect_thrust) {
        perfect_thrust(field);
    }
    for (int k = 0; k < f->mismatches && status == 0; ++k) {
        status = set_mismatch(f->mismatch[k], field);
    }
    return status;
}

/* Describes the mismatches in words. */
static void describe(const options_field_t *f, char *text, size_t size)
{
    char mixture[64] = "";
    if (f->mixture) {
        (void)snprintf(mixture, sizeof mixture, "mixture of strength %g", f->strength);
    }
    size_t length = (size_t)snprintf(text, size, "%s%s", f->matched ? "matched" : mixture,
                                     f->perfect_thrust ? ", perfect thrust" : "");
    for (int k = 0; k < f->mismatches && length < size; ++k) {
        length += (size_t)snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "",
                                   f->mismatch[k]);
    }
}

static void begin(campaign_memory_t *m, const options_t *options)
{
    const options_field_t *f = &options->field;
    auvid_identifier_config_t *cfg = &m->run.id.cfg;
    field_run_defaults(&m->cfg);
    m->cfg.thrust_scale = options->thrust_scale;
    m->cfg.dvl_scale = options->dvl_scale;
    m->cfg.delay_s = options->delay_s;
    m->cfg.uncertain = !f->perfect_inputs && !options->plain;
    m->cfg.reference = f->reference;
    m->cfg.sets = options->sets;
    m->cfg.then = f->then;
    m->cfg.budget = options->budget;
    m->cfg.field.vehicle = f->vehicle;
    field_run_identifier(&m->cfg, &m->run.averaged, cfg);
    describe(f, m->world, sizeof m->world);
    bool goes_on = f->then != FIELD_EXCITED;
    (void)snprintf(m->driver, sizeof m->driver, "%s%s%s", options_drivers[f->driver],
                   goes_on ? ", then " : "", goes_on ? options_drivers[f->then] : "");
    m->campaign = (field_campaign_t){.vehicle = options_field_vehicles[f->vehicle],
                                     .drawn = f->vehicle == FIELD_ANY,
                                     .driver = m->driver,
                                     .world = m->world,
                                     .strength = f->mixture ? f->strength : -1.0,
                                     .matched = f->matched,
                                     .perfect_thrust = f->perfect_thrust,
                                     .uncertainty = cfg->uncertainty,
                                     .seed = options->seed};
}

static int run_all(campaign_memory_t *m, const options_t *options)
{
    progress_t progress;
    int status = 0;
    progress_begin(&progress, !options->json);
    for (uint32_t k = 0; k < options->runs && status == 0; ++k) {
        status = make_world(options, &m->campaign.uncertainty, options->seed + k, &m->cfg);
        if (status == 0 && !field_run(&m->run, &m->cfg, &m->record[k])) {
            status =
                report_error("demo: the simulator or the identifier refused its configuration");
        }
        if (status == 0 && options->field.shifts &&
            !field_causes_shift(&m->run, &m->cfg, &m->record[k])) {
            status = report_error("demo: the simulator refused a class of mismatches");
        }
        if (status == 0) {
            field_table_add(&m->table, &m->record[k]);
        }
        progress_bar(&progress, (double)(k + 1) / options->runs, "run %u of %u", (unsigned)(k + 1),
                     (unsigned)options->runs);
    }
    m->campaign.wall_s = progress_end(&progress);
    return status;
}

int field_demo(const options_t *options)
{
    for (int k = 0; k < options->field.mismatches; ++k) {
        if (strcmp(options->field.mismatch[k], "list") == 0) {
            field_report_mismatches();
            return 0;
        }
    }
    campaign_memory_t *m = calloc(1, sizeof *m);
    field_record_t *record = calloc(options->runs, sizeof *record);
    int status = 0;
    if (m == NULL || record == NULL || !field_table_begin(&m->table, options->runs)) {
        status = report_error("demo: not enough memory for %u runs", (unsigned)options->runs);
    } else {
        m->record = record;
        begin(m, options);
        status = run_all(m, options);
        if (status == 0 && !field_table_finish(&m->table, options->seed)) {
            status = report_error("demo: not enough memory for %u runs", (unsigned)options->runs);
        }
        if (status == 0) {
            (options->json ? field_report_json : field_report_tables)(&m->campaign, &m->table,
                                                                      record);
        }
        field_table_free(&m->table);
    }
    free(record);
    free(m);
    return status;
}
