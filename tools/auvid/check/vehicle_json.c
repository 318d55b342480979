/*
 * A vehicle file as JSON.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/config.h"
#include "../base/json_string.h"
#include "../vehicle/vehicle_keys.h"
#include "vehicle_output.h"
#include "vehicle_sim.h"
#include "../vehicle/vehicle_terms.h"

static const char *const kinds[] = {"girona500", "fossen", "terms"};

void vehicle_digits(auvid_real_t x, vehicle_digits_t digits)
{
    for (int precision = 6; precision <= 17; ++precision) {
        (void)snprintf(digits, sizeof(vehicle_digits_t), "%.*g", precision, (double)x);
        auvid_real_t again = (auvid_real_t)strtod(digits, NULL);
        if (again >= x && again <= x) {
            return;
        }
    }
}

static void print_real(const char *separator, auvid_real_t x)
{
    vehicle_digits_t digits;
    vehicle_digits(x, digits);
    printf("%s%s", separator, digits);
}

/* Numbers of the member, in the file's unit. */
static void print_numbers(const vehicle_key_t *key, const char *base)
{
    double factor = key->factor > 0.0 ? key->factor : 1.0;
    const void *from = base + key->offset;
    int count = key->most > 0 ? key->most : 1;
    if (key->count_offset > 0) {
        count = *(const int *)(const void *)(base + key->count_offset);
    }
    if (key->most > 0) {
        printf("[");
    }
    for (int i = 0; i < count; ++i) {
        const char *separator = i == 0 ? "" : ", ";
        if (key->kind == KEY_REAL) {
            auvid_real_t x = ((const auvid_real_t *)from)[i];
            print_real(separator, (auvid_real_t)((double)x / factor));
        } else if (key->kind == KEY_WHOLE) {
            printf("%s%lu", separator, (unsigned long)((const uint32_t *)from)[i]);
        } else {
            printf("%s%.15g", separator, ((const double *)from)[i]);
        }
    }
    if (key->most > 0) {
        printf("]");
    }
}

/* The words whose bits are set. */
static void print_words(const vehicle_key_t *key, uint32_t bits)
{
    const char *separator = "";
    printf("[");
    for (int i = 0; key->words[i] != NULL; ++i) {
        if (bits >> i & 1u) {
            printf("%s\"%s\"", separator, key->words[i]);
            separator = ", ";
        }
    }
    printf("]");
}

static void print_value(const vehicle_key_t *key, const char *base)
{
    const void *from = base + key->offset;
    switch (key->kind) {
    case KEY_WORD:
    case KEY_TITLE:
        json_string(stdout, from);
        break;
    case KEY_YES:
        printf(*(const bool *)from ? "true" : "false");
        break;
    case KEY_CHOICE:
        printf("\"%s\"", key->words[*(const int *)from]);
        break;
    case KEY_BITS:
        print_words(key, *(const uint8_t *)from);
        break;
    case KEY_CAUSES:
        print_words(key, *(const uint32_t *)from >> AUVID_GUARD_DEPTH_MIN);
        break;
    case KEY_REAL:
    case KEY_DOUBLE:
    case KEY_WHOLE:
        print_numbers(key, base);
        break;
    }
}

/* "a": 1, "b": 2 */
static void print_keys(vehicle_section_t section, const void *base)
{
    const vehicle_keys_t *keys = &vehicle_keys[section];
    for (int k = 0; k < keys->keys; ++k) {
        printf("%s\"%s\": ", k == 0 ? "" : ", ", keys->key[k].key);
        print_value(&keys->key[k], base);
    }
}

static void print_section(vehicle_section_t section, const vehicle_t *v)
{
    printf(",\n  \"%s\": {", vehicle_keys[section].section);
    print_keys(section, v);
    printf("}");
}

static void print_parameters(const auvid_vehicle_t *model)
{
    printf(",\n  \"parameters\": [");
    for (int i = 0; i < model->parameters; ++i) {
        const auvid_parameter_t *p = &model->parameter[i];
        printf("%s\n    {\"name\": \"%s\", \"unit\": ", i == 0 ? "" : ",", p->name);
        json_string(stdout, p->unit);
        printf(", \"dof\": \"%s\", \"kind\": \"%s\"}", vehicle_dofs[p->dof],
               vehicle_kinds[p->kind]);
    }
    printf("]");
}

static void print_terms(const auvid_term_table_t *table)
{
    printf(",\n  \"terms\": [");
    for (int i = 0; i < table->terms; ++i) {
        const auvid_term_t *t = &table->term[i];
        printf("%s\n    {\"parameter\": \"%s\", \"dof\": \"%s\", \"sign\": %d, \"factors\": [",
               i == 0 ? "" : ",", table->parameter[t->parameter].name, vehicle_dofs[t->dof],
               t->sign);
        const char *separator = "";
        for (int k = 0; k < 3; ++k) {
            if (t->factor[k] != AUVID_FACTOR_ONE) {
                printf("%s\"%s\"", separator, vehicle_factors[t->factor[k]]);
                separator = ", ";
            }
        }
        printf("]}");
    }
    printf("]");
}

static void print_thrusters(const vehicle_t *v)
{
    printf(",\n  \"thrusters\": [");
    for (int i = 0; i < v->allocation->thrusters; ++i) {
        printf("%s\n    {", i == 0 ? "" : ",");
        print_keys(KEYS_THRUSTER, &v->thruster[i]);
        printf(", \"wrench\": [");
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            print_real(j == 0 ? "" : ", ", v->allocation->thruster[i].wrench[j]);
        }
        printf("]}");
    }
    printf("],\n  \"groups\": {");
    for (int i = 0; i < v->maps; ++i) {
        printf("%s\n    \"%s\": {", i == 0 ? "" : ",", v->group[i]);
        print_keys(KEYS_GROUP, &v->map[i]);
        printf("}");
    }
    printf("}");
}

static void print_calibrations(const vehicle_t *v)
{
    printf(",\n  \"calibrations\": [");
    for (int i = 0; i < v->calibrations; ++i) {
        printf("%s\n    {", i == 0 ? "" : ",");
        print_keys(KEYS_CALIBRATION, &v->calibration[i]);
        printf("}");
    }
    printf("]");
}

static void print_capacity(const vehicle_t *v)
{
    auvid_allocation_t allocation;
    (void)auvid_allocation_init(&allocation, v->allocation); /* as when the file was read */
    printf(",\n  \"largest_wrench\": {");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t low = 0, high = 0;
        (void)auvid_allocation_capacity(&allocation, (auvid_dof_t)j, &low, &high);
        printf("%s\"%s\": [", j == 0 ? "" : ", ", vehicle_dofs[j]);
        print_real("", low);
        print_real(", ", high);
        printf("]");
    }
    printf("}");
}

/* The truth in the model's parameters. */
static void print_truth(const vehicle_t *v)
{
    static vehicle_sim_t simulated;
    double truth[VEHICLE_SIM_PARAMETERS];
    if (!v->has_truth) {
        printf(",\n  \"truth\": null");
        return;
    }
    simulated.sim.cfg = v->sim;
    vehicle_sim_truth(&simulated, truth);
    printf(",\n  \"truth\": {");
    print_keys(KEYS_TRUTH, v);
    for (int i = 0; i < v->model->parameters; ++i) {
        printf(", \"%s\": %.15g", v->model->parameter[i].name, truth[i]);
    }
    printf("}");
}

void vehicle_json(const vehicle_t *v, const char *path)
{
    printf("{\n  \"version\": \"%s\",\n  \"file\": ", AUVID_VERSION_STRING);
    json_string(stdout, path);
    printf(",\n  \"name\": \"%s\",\n  \"title\": ", v->word);
    json_string(stdout, v->title);
    printf(",\n  \"model\": \"%s\",\n  \"fast\": %s", kinds[v->kind], v->fast ? "true" : "false");
    printf(",\n  \"dry_mass_kg\": ");
    print_real("", v->dry_mass_kg);
    print_parameters(v->model);
    if (v->kind == VEHICLE_TERMS) {
        print_terms(&v->table.table);
    }
    print_thrusters(v);
    print_section(KEYS_ALLOCATION, v);
    print_capacity(v);
    print_section(KEYS_EXCITATION, v);
    print_section(KEYS_GUARD, v);
    print_section(KEYS_MOUNT, v);
    print_section(KEYS_UNCERTAINTY, v);
    print_section(KEYS_UNCERTAIN, v);
    print_calibrations(v);
    print_truth(v);
    printf("\n}\n");
}
