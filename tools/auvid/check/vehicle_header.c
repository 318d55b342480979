/*
 * A vehicle file as C for firmware.
 */
#include <stdio.h>
#include <string.h>

#include "auvid/config.h"
#include "../vehicle/vehicle_keys.h"
#include "../vehicle/vehicles.h"
#include "vehicle_output.h"

/* Longest real number as a literal. */
enum { LITERAL = 48 };
typedef char literal_text_t[LITERAL];

/* The shortest literal that gives exactly this number. */
static const char *literal_of(auvid_real_t x, literal_text_t text)
{
    vehicle_digits_t digits;
    vehicle_digits(x, digits);
    (void)snprintf(text, LITERAL, "AUVID_C(%s%s)", digits,
                   strpbrk(digits, ".e") == NULL ? ".0" : "");
    return text;
}

/* A list in braces, six numbers in a line. */
static void print_list(const auvid_real_t *x, int n)
{
    literal_text_t text;
    printf("{");
    for (int i = 0; i < n; ++i) {
        printf("%s%s", i == 0 ? "" : i % 6 == 0 ? ",\n         " : ", ", literal_of(x[i], text));
    }
    printf("}");
}

/* Assignments of all members of a table: "    cfg->guard.speed_max = AUVID_C(1.5);" */
static void print_members(vehicle_section_t section, const vehicle_t *v, const char *to)
{
    const vehicle_keys_t *keys = &vehicle_keys[section];
    literal_text_t text;
    for (int k = 0; k < keys->keys; ++k) {
        const vehicle_key_t *key = &keys->key[k];
        const void *from = (const char *)v + key->offset;
        const char *member = key->member != NULL ? key->member : key->key;
        if (key->kind == KEY_REAL) {
            int count = key->most > 0 ? key->most : 1;
            for (int i = 0; i < count; ++i) {
                printf("    cfg->%s%s", to, member);
                if (key->most > 0) {
                    printf("[%d]", i);
                }
                printf(" = %s;\n", literal_of(((const auvid_real_t *)from)[i], text));
            }
        } else if (key->kind == KEY_YES) {
            printf("    cfg->%s%s = %s;\n", to, member, *(const bool *)from ? "true" : "false");
        } else {
            printf("    cfg->%s%s = %luu;\n", to, member, (unsigned long)*(const uint32_t *)from);
        }
    }
}

static void print_begin(const vehicle_t *v)
{
    printf("/*\n * %s for firmware, by `auvid check --header` of version %s.\n"
           " * Change the vehicle file and write this again.\n",
           v->title, AUVID_VERSION_STRING);
    printf(" *\n *     static %s_storage_t storage;\n", v->word);
    printf(" *     %s_identifier(&storage, &identifier);   auvid_identifier_init\n", v->word);
    printf(" *     %s_allocation(&thrusters);              auvid_allocation_init\n", v->word);
    printf(" *     %s_uncertain(&inputs);                  auvid_identifier_attach_uncertain\n",
           v->word);
    if (v->has_excitation) {
        printf(" *     %s_actuation(30, 8, 1, &acting);        auvid_identifier_attach_actuation\n",
               v->word);
    }
    printf(" *\n * On a CAN bus: auvid_node_init takes identifier and thrusters, then\n"
           " * auvid_node_attach_uncertain%s.\n%s",
           v->has_excitation ? " and auvid_node_attach_actuation" : "",
           v->has_excitation ? ""
                             : " * The vehicle file has no [excitation]: nothing is excited.\n");
    if (v->calibrations > 0) {
        puts(" * [calibration.N] is not here: firmware says when a weight hangs, by\n"
             " * auvid_calibrated_force of estimate.h.");
    }
    printf(" */\n#ifndef VEHICLE_%s_H\n#define VEHICLE_%s_H\n\n#include \"auvid/auvid.h\"\n\n",
           v->word, v->word);
    int least = v->kind == VEHICLE_GIRONA500 ? 13
                : v->kind == VEHICLE_FOSSEN  ? 22
                                             : v->model->parameters;
    printf("#if AUVID_MAX_PARAMETERS < %d || AUVID_MAX_THRUSTERS < %d\n", least,
           v->allocation->thrusters);
    printf("#error \"%s: build with AUVID_MAX_PARAMETERS %d and AUVID_MAX_THRUSTERS %d or more\"\n"
           "#endif\n\n",
           v->word, least, v->allocation->thrusters);
}

/* The table of terms, for flash. */
static void print_table(const vehicle_t *v)
{
    const auvid_term_table_t *table = &v->table.table;
    printf("static const auvid_parameter_t %s_parameter[] = {\n", v->word);
    for (int i = 0; i < table->parameters; ++i) {
        const auvid_parameter_t *p = &table->parameter[i];
        printf("    {\"%s\", \"%s\", (auvid_dof_t)%d, (auvid_parameter_kind_t)%d},\n", p->name,
               p->unit, (int)p->dof, (int)p->kind);
    }
    printf("};\n\n/* parameter, equation, sign, factors */\n"
           "static const auvid_term_t %s_term[] = {\n",
           v->word);
    for (int i = 0; i < table->terms; ++i) {
        const auvid_term_t *t = &table->term[i];
        printf("    {%d, %d, %d, {%d, %d, %d}},\n", t->parameter, t->dof, t->sign, t->factor[0],
               t->factor[1], t->factor[2]);
    }
    printf("};\n\nstatic const auvid_term_table_t %s_table = {\"%s\", %s_parameter, %s_term, %d, "
           "%d};\n\n",
           v->word, v->title, v->word, v->word, table->terms, table->parameters);
}

static void print_identifier(const vehicle_t *v)
{
    literal_text_t text;
    printf("/** Holds the model while it is in use. */\ntypedef struct {\n");
    printf("    const auvid_vehicle_t *model;\n");
    printf("%s%s} %s_storage_t;\n\n", v->kind == VEHICLE_TERMS ? "    auvid_terms_t terms;\n" : "",
           v->fast ? "    auvid_averaged_t averaged;\n" : "", v->word);
    printf("/** Writes the configuration of the identifier. @return AUVID_OK, or why the model is\n"
           " * refused */\nstatic inline auvid_status_t %s_identifier(%s_storage_t *storage,\n"
           "    auvid_identifier_config_t *cfg)\n{\n    auvid_status_t status = AUVID_OK;\n",
           v->word, v->word);
    if (v->kind == VEHICLE_TERMS) {
        printf("    status = auvid_terms_init(&storage->terms, &%s_table, NULL);\n"
               "    if (status < 0) {\n        return status;\n    }\n"
               "    storage->terms.vehicle.free = 0x%lxu;\n"
               "    storage->model = &storage->terms.vehicle;\n",
               v->word, (unsigned long)v->model->free);
    } else {
        printf("    storage->model = &auvid_%s;\n",
               v->kind == VEHICLE_FOSSEN ? "fossen" : "girona500");
    }
    printf("    auvid_identifier_defaults(cfg, storage->model);\n");
    print_members(KEYS_MOUNT, v, "nav.mount.");
    print_members(KEYS_UNCERTAINTY, v, "uncertainty.");
    printf("    cfg->dry_mass_kg = %s;\n", literal_of(v->dry_mass_kg, text));
    if (vehicle_bound((double)v->dry_mass_kg) > vehicle_bound(0.0)) {
        printf("    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {\n"
               "        cfg->search.upper[i] = %s;\n"
               "        cfg->search.lower[i] = -cfg->search.upper[i];\n    }\n",
               literal_of((auvid_real_t)vehicle_bound((double)v->dry_mass_kg), text));
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (v->amplitude[j] > 0) {
            printf("    cfg->metric.tau_max[%d] = %s;\n", j, literal_of(v->amplitude[j], text));
        }
    }
    if (v->fast) { /* as vehicle_use_averaged_model */
        printf("    status = auvid_averaged_init(&storage->averaged, storage->model,\n"
               "        cfg->recorder.cell_us, 200000);\n"
               "    cfg->vehicle = cfg->metric.vehicle = &storage->averaged.vehicle;\n"
               "    cfg->metric.half_width[1] = 4;\n    cfg->metric.max_cell_us = 0;\n");
    }
    printf("    return status;\n}\n\n");
}

static void print_allocation(const vehicle_t *v)
{
    const auvid_allocation_config_t *a = v->allocation;
    printf("/** Writes the thrusters. */\n"
           "static inline void %s_allocation(auvid_allocation_config_t *cfg)\n{\n"
           "    /* X Y Z K M N per newton; min_N, max_N, gain_forward, gain_backward */\n"
           "    static const auvid_real_t thruster[%d][AUVID_DOF_COUNT + 4] = {\n",
           v->word, a->thrusters);
    for (int i = 0; i < a->thrusters; ++i) {
        const auvid_thruster_t *t = &a->thruster[i];
        auvid_real_t row[AUVID_DOF_COUNT + 4] = {0};
        memcpy(row, t->wrench, sizeof t->wrench);
        row[AUVID_DOF_COUNT] = t->min_N;
        row[AUVID_DOF_COUNT + 1] = t->max_N;
        row[AUVID_DOF_COUNT + 2] = t->gain_forward;
        row[AUVID_DOF_COUNT + 3] = t->gain_backward;
        printf("        ");
        print_list(row, AUVID_DOF_COUNT + 4);
        printf(",\n");
    }
    printf("    };\n    static const uint8_t law[%d] = {", a->thrusters);
    for (int i = 0; i < a->thrusters; ++i) {
        printf("%s%d", i == 0 ? "" : ", ", (int)a->thruster[i].law);
    }
    printf("};\n    auvid_allocation_defaults(cfg);\n    cfg->thrusters = %d;\n"
           "    cfg->dofs = %d;\n    cfg->priority = %d;\n    for (int i = 0; i < %d; ++i) {\n",
           a->thrusters, a->dofs, a->priority, a->thrusters);
    printf("        auvid_thruster_t *t = &cfg->thruster[i];\n"
           "        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {\n"
           "            t->wrench[j] = thruster[i][j];\n        }\n"
           "        t->min_N = thruster[i][AUVID_DOF_COUNT];\n"
           "        t->max_N = thruster[i][AUVID_DOF_COUNT + 1];\n"
           "        t->law = (auvid_thrust_law_t)law[i];\n"
           "        t->gain_forward = thruster[i][AUVID_DOF_COUNT + 2];\n"
           "        t->gain_backward = thruster[i][AUVID_DOF_COUNT + 3];\n    }\n}\n\n");
}

static void print_uncertain(const vehicle_t *v)
{
    printf("/** Writes uncertain inputs. */\n"
           "static inline void %s_uncertain(auvid_uncertain_config_t *cfg)\n{\n"
           "    auvid_uncertain_defaults(cfg);\n",
           v->word);
    print_members(KEYS_UNCERTAIN, v, "");
    printf("}\n\n");
}

static void print_actuation(const vehicle_t *v)
{
    printf("/** Writes guard and excitation: `sets` sets of set_s seconds. @return that of\n"
           " * auvid_excitation_plan */\n"
           "static inline auvid_status_t %s_actuation(auvid_real_t set_s, uint32_t sets,\n"
           "    uint64_t seed, auvid_actuation_config_t *cfg)\n{\n"
           "    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = ",
           v->word);
    print_list(v->amplitude, AUVID_DOF_COUNT);
    printf(";\n    auvid_actuation_defaults(cfg);\n");
    print_members(KEYS_GUARD, v, "guard.");
    printf("    auvid_status_t status =\n"
           "        auvid_excitation_plan(&cfg->excitation, amplitude, set_s, sets, seed);\n");
    if (v->fast) { /* as vehicle_use_fast_excitation */
        printf("    for (int i = 0; i < cfg->excitation.segments; ++i) {\n"
               "        auvid_segment_t *segment = &cfg->excitation.segment[i];\n"
               "        if (segment->dof >= AUVID_ROLL) {\n"
               "            segment->frequency_hz = AUVID_C(0.1);\n"
               "            segment->frequency_high_hz = AUVID_C(0.8);\n"
               "            segment->hold_min_s = AUVID_C(1.0);\n"
               "            segment->hold_max_s = AUVID_C(3.0);\n        }\n    }\n");
    }
    printf("    return status;\n}\n\n");
}

void vehicle_header(const vehicle_t *v)
{
    print_begin(v);
    if (v->kind == VEHICLE_TERMS) {
        print_table(v);
    }
    print_identifier(v);
    print_allocation(v);
    print_uncertain(v);
    if (v->has_excitation) {
        print_actuation(v);
    }
    puts("#endif");
}
