#include "field_report.h"

#include "field_causes.h"

#include <math.h>
#include <stdio.h>

static const char *const group_names[FIELD_CLASSES] = {"all", "all but W-B", "masses",
                                                       "W-B", "linear drag", "quadratic drag"};
static const char *const group_keys[FIELD_CLASSES] = {"all", "all_but_W-B", "masses",
                                                      "W-B", "linear_drag", "quadratic_drag"};
static const char *const question_names[FIELD_QUESTIONS] = {
    "flagged",   "wrong",        "beyond",         "error_over_sigma", "rms_error_flagged",
    "rms_error", "within_sigma", "within_2_sigma", "told_wrong",       "told_beyond"};
static const char *const force_names[FIELD_FORCE_QUESTIONS] = {"off", "flagged", "wrong", "beyond",
                                                               "within"};

static const char *parameter_name(int i)
{
    return auvid_girona500.parameter[i].name;
}

/* Describes how a mixture draws a kind of mismatch. */
static void describe_draw(const field_mismatch_t *kind, char *text, size_t size)
{
    char chance[32] = "";
    if (kind->chance < 1.0) {
        (void)snprintf(chance, sizeof chance, ", in %g %%", 100.0 * kind->chance);
    }
    if (kind->draw == FIELD_ALONE) {
        (void)snprintf(text, size, "not in mixtures");
    } else if (kind->draw == FIELD_NORMAL) {
        (void)snprintf(text, size, "+- %g%s", kind->high, chance);
    } else if (!(kind->low < kind->high)) {
        (void)snprintf(text, size, "%g%s", kind->high, chance);
    } else {
        (void)snprintf(text, size, "%g .. %g%s", kind->low, kind->high, chance);
    }
}

void field_report_mismatches(void)
{
    const field_mismatch_t *kind;
    int count = field_mismatches(&kind);
    printf("%-18s %-6s %-18s %s\n", "name", "unit", "in a mixture of 1", "about");
    for (int k = 0; k < count; ++k) {
        char drawn[64];
        describe_draw(&kind[k], drawn, sizeof drawn);
        printf("%-18s %-6s %-18s %s\n", kind[k].name, kind[k].unit, drawn, kind[k].about);
    }
}

/* ---- tables ---- */

/* Prints "12.3 ( 8.1- 16.0)" in 19 columns; shares in per cent. */
static void print_share(const field_figure_t *f)
{
    if (isnan(f->value)) {
        printf("  %-19s", "     -");
    } else {
        printf("  %5.1f (%5.1f-%5.1f)", 100.0 * f->value, 100.0 * f->low, 100.0 * f->high);
    }
}

static void print_value(const field_figure_t *f, double unit)
{
    if (isnan(f->value)) {
        printf("      -");
    } else {
        printf("  %5.*f", unit > 1.0 ? 1 : 2, unit * f->value);
    }
}

static void print_groups(const field_table_t *table)
{
    const field_figure_t *f = table->figure;
    printf("  %-15s%5s%11s%21s%22s%17s %s\n", "share [%]", "of", "flagged", "wrong", "beyond",
           "rms/sigma", "rms[%]");
    for (int g = 0; g < FIELD_CLASSES; ++g) {
        printf("  %-15s%5.0f", group_names[g], f[FIELD_AT(FIELD_FLAGGED, g)].whole);
        print_share(&f[FIELD_AT(FIELD_FLAGGED, g)]);
        print_share(&f[FIELD_AT(FIELD_WRONG, g)]);
        print_share(&f[FIELD_AT(FIELD_BEYOND, g)]);
        print_value(&f[FIELD_AT(FIELD_OVER_SIGMA, g)], 1.0);
        print_value(&f[FIELD_AT(FIELD_ERROR_FLAGGED, g)], 100.0);
        putchar('\n');
    }
    printf("  %-20s%21s", "for reported thrust", "");
    print_share(&f[FIELD_AT(FIELD_TOLD_WRONG, FIELD_ALL)]);
    print_share(&f[FIELD_AT(FIELD_TOLD_BEYOND, FIELD_ALL)]);
    printf("\n  %-15s%5u", "runs with wrong", (unsigned)table->runs);
    printf("%21s", "");
    print_share(&f[FIELD_AT_WRONG_RUN]);
    printf("\n  rms error of all estimates");
    print_value(&f[FIELD_AT(FIELD_ERROR, FIELD_ALL)], 100.0);
    printf(" %%; within 1 and 2 sigma");
    print_value(&f[FIELD_AT(FIELD_WITHIN_1, FIELD_ALL)], 100.0);
    print_value(&f[FIELD_AT(FIELD_WITHIN_2, FIELD_ALL)], 100.0);
    printf(" %%\n  runs not converged");
    print_value(&f[FIELD_AT_CAPPED_RUN], 100.0);
    puts(" %");
}

static void print_forces(const field_table_t *table, const char *title, int first)
{
    printf("\n  %-13s%13s%19s%21s%22s\n", title, "error > 20 %", "flagged", "wrong", "beyond");
    for (int k = 0; k < FIELD_PARTS; ++k) {
        printf("  at %.1f      ", field_part[k]);
        for (int q = 0; q <= FIELD_FORCE_BEYOND; ++q) {
            print_share(&table->figure[first + q * FIELD_PARTS + k]);
        }
        putchar('\n');
    }
}

static void print_curve(const field_table_t *table)
{
    static const char *const names[] = {"  flagged          ", "  wrong            "};
    const field_figure_t *f = table->figure + FIELD_AT_CURVE;
    printf("\n  half-width limit ");
    for (int k = 0; k < FIELD_LIMITS; ++k) {
        printf("%9.0f %%", 100.0 * field_limit[k]);
    }
    for (int row = 0; row < 2; ++row) {
        printf("\n%s", names[row]);
        for (int k = 0; k < FIELD_LIMITS; ++k) {
            printf("    ");
            print_value(&f[row * FIELD_LIMITS + k], 100.0);
        }
    }
    putchar('\n');
}

static const char *note_name(int note)
{
    return note == AUVID_NOTE_NONE ? "nothing: it is identifiable"
                                   : auvid_note_str((auvid_note_t)note);
}

static void print_notes(const field_table_t *table)
{
    puts("\n  share of the parameters with each note [%]");
    for (int note = 0; note < FIELD_NOTES; ++note) {
        const field_figure_t *f = &table->figure[FIELD_AT_NOTE + note];
        if (f->value > 0.0) {
            printf("  %5.1f  %s\n", 100.0 * f->value, note_name(note));
        }
    }
}

static void print_alarms(const field_table_t *table, const field_record_t *record)
{
    uint32_t changed = 0, drifted = 0, runs = 0, sets = 0;
    for (uint32_t k = 0; k < table->runs; ++k) {
        changed += record[k].changed;
        drifted += record[k].drifted;
        runs += record[k].drifted > 0;
        sets += record[k].sets;
    }
    printf("\n  alarms in %u sets: %u of a change, %u of drift (in %u runs)\n", (unsigned)sets,
           (unsigned)changed, (unsigned)drifted, (unsigned)runs);
}

void field_report_tables(const field_campaign_t *campaign, const field_table_t *table,
                         const field_record_t *record)
{
    const auvid_uncertainty_t *u = &campaign->uncertainty;
    printf("auvid %s demo: field statistics of %s, %s, seeds %llu .. %llu\n", AUVID_VERSION_STRING,
           campaign->vehicle, campaign->driver, (unsigned long long)campaign->seed,
           (unsigned long long)(campaign->seed + table->runs - 1));
    if (campaign->drawn) {
        puts("  vehicles     another one in each run, drawn from its seed");
    }
    printf("  mismatches   %s\n", campaign->world);
    printf("  uncertainty  thrust scale %g, DVL scale %g, delay %g s\n", (double)u->thrust_scale,
           (double)u->dvl_scale, (double)u->delay_s);
    printf("  time         %u runs of %.0f s simulated in %.1f s\n\n", (unsigned)table->runs,
           record->simulated_s, campaign->wall_s);
    print_groups(table);
    print_forces(table, "drag force", FIELD_AT_FORCE);
    print_forces(table, "one way", FIELD_AT_ONE_WAY);
    print_curve(table);
    print_notes(table);
    print_alarms(table, record);
    field_causes_table(campaign, record, table->runs);
}

/* ---- JSON ---- */

static void json_number(double x)
{
    if (isfinite(x)) {
        printf("%.9g", x);
    } else {
        printf("null");
    }
}

static void json_list(const char *key, const double *value, int n)
{
    printf(", \"%s\": [", key);
    for (int i = 0; i < n; ++i) {
        printf("%s", i == 0 ? "" : ", ");
        json_number(value[i]);
    }
    printf("]");
}

static void json_figure(const char *separator, const char *name, const field_figure_t *f)
{
    printf("%s\"%s\": {\"value\": ", separator, name);
    json_number(f->value);
    printf(", \"low\": ");
    json_number(f->low);
    printf(", \"high\": ");
    json_number(f->high);
    printf(", \"of\": %.0f}", f->whole);
}

static void json_groups(const field_table_t *table)
{
    for (int q = 0; q < FIELD_QUESTIONS; ++q) {
        printf(",\n  \"%s\": {", question_names[q]);
        for (int g = 0; g < FIELD_GROUPS; ++g) {
            bool class = g < FIELD_CLASSES;
            if (class || g != FIELD_CLASSES + SIM_WB) { /* W-B is a class of its own */
                json_figure(g == 0 ? "\n    " : ",\n    ",
                            class ? group_keys[g] : parameter_name(g - FIELD_CLASSES),
                            &table->figure[FIELD_AT(q, g)]);
            }
        }
        printf("}");
    }
}

static void json_forces(const field_table_t *table, const char *key, int first)
{
    printf(",\n  \"%s\": {", key);
    for (int q = 0; q < FIELD_FORCE_QUESTIONS; ++q) {
        printf("%s\n    \"%s\": {", q == 0 ? "" : ",", force_names[q]);
        for (int k = 0; k < FIELD_PARTS; ++k) {
            char part[8];
            (void)snprintf(part, sizeof part, "%.1f", field_part[k]);
            json_figure(k == 0 ? "" : ", ", part, &table->figure[first + q * FIELD_PARTS + k]);
        }
        printf("}");
    }
    printf("}");
}

static void json_curve(const field_table_t *table)
{
    printf(",\n  \"curve\": [");
    for (int k = 0; k < FIELD_LIMITS; ++k) {
        const field_figure_t *f = &table->figure[FIELD_AT_CURVE + k];
        printf("%s\n    {\"limit\": %g", k == 0 ? "" : ",", field_limit[k]);
        json_figure(", ", "flagged", f);
        json_figure(", ", "wrong", f + FIELD_LIMITS);
        printf("}");
    }
    printf("],\n  \"said\": {");
    for (int note = 0, said = 0; note < FIELD_NOTES; ++note) {
        const field_figure_t *f = &table->figure[FIELD_AT_NOTE + note];
        if (f->value > 0.0) {
            json_figure(said++ == 0 ? "\n    " : ",\n    ", note_name(note), f);
        }
    }
    printf("}");
}

/* The vehicle of a run. */
static void json_vehicle(const field_record_t *record)
{
    field_sheet_t sheet;
    field_sheet(FIELD_ANY, record->seed, &sheet);
    printf(", \"vehicle\": {\"dry_kg\": ");
    json_number(sheet.dry_kg);
    printf(", \"length_m\": ");
    json_number(sheet.length_m);
    printf(", \"thrusters\": %d, \"thruster_max_N\": ", sheet.thrusters);
    json_number(sheet.thruster_max_N);
    printf(", \"fast\": %s", sheet.fast ? "true" : "false");
    json_list("tau_max", record->tau_max, FIELD_EQUATIONS);
    printf("}");
}

static void json_record(const field_record_t *record, bool drawn)
{
    const field_mismatch_t *kind;
    const field_reference_t *truth = &record->truth;
    double note[SIM_PARAMETERS], flagged[SIM_PARAMETERS], wrong[SIM_PARAMETERS];
    double force[FIELD_DIRECTIONS];
    int count = field_mismatches(&kind);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        note[i] = record->note[i];
        flagged[i] = record->flagged[i];
        wrong[i] = record->flagged[i] && field_is_wrong(record, i, truth->si);
    }
    for (int d = 0; d < FIELD_DIRECTIONS; ++d) {
        force[d] = record->force[1][d].value;
    }
    printf("{\"seed\": %llu, \"sets\": %u, \"simulated_s\": %g", (unsigned long long)record->seed,
           (unsigned)record->sets, record->simulated_s);
    if (drawn) {
        json_vehicle(record);
    }
    printf(", \"changed\": %u, \"drifted\": %u, \"drifted_s\": ", (unsigned)record->changed,
           (unsigned)record->drifted);
    json_number(record->drifted > 0 ? record->drifted_s : NAN);
    json_list("estimate", record->pi, SIM_PARAMETERS);
    json_list("sigma", record->sigma, SIM_PARAMETERS);
    json_list("flagged", flagged, SIM_PARAMETERS);
    json_list("wrong", wrong, SIM_PARAMETERS);
    json_list("note", note, SIM_PARAMETERS);
    json_list("truth", truth->si, SIM_PARAMETERS);
    json_list("told_truth", truth->reported, SIM_PARAMETERS);
    json_list("told_gain", truth->gain, FIELD_EQUATIONS);
    json_list("residual", truth->residual, FIELD_EQUATIONS);
    json_list("speed", truth->speed[0], FIELD_DIRECTIONS);
    json_list("acceleration", truth->acceleration, FIELD_EQUATIONS);
    json_list("delay_s", record->delay_s, FIELD_EQUATIONS);
    json_list("drag_force_06", force, FIELD_DIRECTIONS);
    field_causes_json_run(record);
    printf(", \"mismatch\": {");
    for (int k = 0, shown = 0; k < count; ++k) {
        if (fabs(record->size[k]) > 0.0) {
            printf("%s\"%s\": ", shown++ == 0 ? "" : ", ", kind[k].name);
            json_number(record->size[k]);
        }
    }
    printf("}}");
}

void field_report_json(const field_campaign_t *campaign, const field_table_t *table,
                       const field_record_t *record)
{
    const auvid_uncertainty_t *u = &campaign->uncertainty;
    printf("{\n  \"version\": \"%s\",\n  \"vehicle\": \"%s\",\n  \"driver\": \"%s\",\n",
           AUVID_VERSION_STRING, campaign->vehicle, campaign->driver);
    printf("  \"world\": \"%s\",\n  \"strength\": ", campaign->world);
    json_number(campaign->strength >= 0.0 ? campaign->strength : NAN);
    printf(",\n  \"matched\": %s,\n  \"perfect_thrust\": %s,\n",
           campaign->matched ? "true" : "false", campaign->perfect_thrust ? "true" : "false");
    printf("  \"uncertainty\": {\"thrust_scale\": %g, \"dvl_scale\": %g, \"delay_s\": %g},\n",
           (double)u->thrust_scale, (double)u->dvl_scale, (double)u->delay_s);
    printf("  \"seed\": %llu,\n  \"runs\": %u", (unsigned long long)campaign->seed,
           (unsigned)table->runs);
    json_figure(",\n  ", "runs_with_wrong_flag", &table->figure[FIELD_AT_WRONG_RUN]);
    json_figure(",\n  ", "runs_not_converged", &table->figure[FIELD_AT_CAPPED_RUN]);
    json_groups(table);
    json_forces(table, "drag_force", FIELD_AT_FORCE);
    json_forces(table, "drag_force_one_way", FIELD_AT_ONE_WAY);
    json_curve(table);
    field_causes_json(campaign, record, table->runs);
    if (!campaign->drawn) { /* else each run has its own */
        json_list("tau_max", record[0].tau_max, FIELD_EQUATIONS);
    }
    printf(",\n  \"parameters\": [");
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        printf("%s\"%s\"", i == 0 ? "" : ", ", parameter_name(i));
    }
    printf("],\n  \"each\": [");
    for (uint32_t k = 0; k < table->runs; ++k) {
        printf("%s\n    ", k == 0 ? "" : ",");
        json_record(&record[k], campaign->drawn);
    }
    printf("]\n}\n");
}
