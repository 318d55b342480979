/*
 * Results as JSON.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "report.h"
#include "../base/json_string.h"

/* Longest note and sentence. */
enum { WORDS = 300 };

/* Nine digits represent a float exactly. JSON has no infinity. */
static void json_number(FILE *out, double x)
{
    if (isfinite(x)) {
        fprintf(out, "%.9g", x);
    } else {
        fprintf(out, "null");
    }
}

/* Words for auvid_parameter_kind_t. */
static const char *const kind[] = {[AUVID_PARAMETER_OTHER] = "other",
                                   [AUVID_PARAMETER_MASS] = "mass",
                                   [AUVID_PARAMETER_INERTIA] = "inertia",
                                   [AUVID_PARAMETER_LINEAR_DRAG] = "linear drag",
                                   [AUVID_PARAMETER_QUADRATIC_DRAG] = "quadratic drag",
                                   [AUVID_PARAMETER_FORCE] = "force",
                                   [AUVID_PARAMETER_UNSCALED] = "other"};

static void json_parameter(FILE *out, const result_t *result, int i)
{
    const auvid_parameter_t *parameter = &result->vehicle->parameter[i];
    bool known = report_is_identified(result, i);
    bool sure = known && (result->estimate.confidence.identifiable >> i & 1u) != 0;
    char note[WORDS];
    report_note(result, i, note, sizeof note);
    fprintf(out, ", \"dof\": \"%s\", \"kind\": \"%s\"", report_dof_name[parameter->dof],
            kind[parameter->kind]);
    fprintf(out, ", \"estimate\": ");
    json_number(out, known ? (double)result->estimate.pi[i] : NAN);
    fprintf(out, ", \"sigma\": ");
    json_number(out, report_sigma(result, i));
    fprintf(out, ", \"half_width\": ");
    json_number(out, HALF_WIDTH * report_sigma(result, i));
    fprintf(out, ", \"sigma_told\": ");
    json_number(out, report_sigma_told(result, i));
    fprintf(out, ", \"thrust_error\": ");
    json_number(out, known ? (double)result->estimate.confidence.thrust_error[i] : NAN);
    fprintf(out, ", \"dvl_error\": ");
    json_number(out, known ? (double)result->estimate.confidence.dvl_error[i] : NAN);
    fprintf(out, ", \"identifiable\": %s, \"note\": ", sure ? "true" : "false");
    json_string(out, note);
    if (known && report_is_at_bound(result, i)) {
        fprintf(out, ", \"at_bound\": true");
    }
    if (result->has_truth) {
        fprintf(out, ", \"truth\": ");
        json_number(out, result->truth[i]);
    }
}

static void json_parameters(FILE *out, const result_t *result)
{
    const char *separator = "";
    fprintf(out, "[");
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (!(result->free >> i & 1u)) {
            continue;
        }
        fprintf(out, "%s\n    {\"name\": ", separator);
        json_string(out, result->vehicle->parameter[i].name);
        fprintf(out, ", \"unit\": ");
        json_string(out, report_unit(result, i));
        json_parameter(out, result, i);
        fprintf(out, "}");
        separator = ",";
    }
    fprintf(out, "\n  ]");
}

/* An object with a value, or [low, high], per modelled degree of freedom. */
static void json_dofs(FILE *out, const result_t *result, const char *key, const char *const *names,
                      const double *low, const double *high, uint32_t mask)
{
    auvid_dof_t dof[AUVID_DOF_COUNT];
    int dofs = report_dofs(result->vehicle, dof);
    fprintf(out, ",\n  \"%s\": {", key);
    for (int k = 0; k < dofs; ++k) {
        auvid_dof_t j = dof[k];
        fprintf(out, "%s\"%s\": ", k == 0 ? "" : ", ", names[j]);
        if (!(mask >> j & 1u)) {
            fprintf(out, "null");
        } else if (high == NULL) {
            json_number(out, low[j]);
        } else {
            fprintf(out, "[");
            json_number(out, low[j]);
            fprintf(out, ", ");
            json_number(out, high[j]);
            fprintf(out, "]");
        }
    }
    fprintf(out, "}");
}

static const char *const force[AUVID_DOF_COUNT] = {"X", "Y", "Z", "K", "M", "N"};
static const char *const velocity[AUVID_DOF_COUNT] = {"u", "v", "w", "p", "q", "r"};

/* The same from numbers of the library. */
static void json_reals(FILE *out, const result_t *result, const char *key, const char *const *names,
                       const auvid_real_t *value, uint32_t mask)
{
    double copy[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        copy[j] = (double)value[j];
    }
    json_dofs(out, result, key, names, copy, NULL, mask);
}

static void json_dof_values(FILE *out, const result_t *result)
{
    uint32_t excited = result->estimate.number > 0 ? result->estimate.excited : 0u;
    json_reals(out, result, "delay_s", force, result->estimate.delay_s, excited);
    json_reals(out, result, "r2_force", force, result->estimate.r2_force, excited);
    json_dofs(out, result, "r2_validation", velocity, result->r2, NULL,
              result->has_validation ? result->validated : 0u);
    if (result->has_interval) {
        json_dofs(out, result, "r2_interval", velocity, result->r2_low, result->r2_high,
                  result->validated);
    }
}

static void json_drag_force(FILE *out, const result_t *result, auvid_dof_t j,
                            const auvid_drag_t *drag)
{
    double known = drag->half_width < AUVID_LARGEST ? (double)drag->half_width : NAN;
    fprintf(out, "{\"speed\": ");
    json_number(out, (double)drag->speed);
    fprintf(out, ", \"force\": ");
    json_number(out, (double)drag->force);
    fprintf(out, ", \"half_width\": ");
    json_number(out, known);
    fprintf(out, ", \"identifiable\": %s", drag->identifiable ? "true" : "false");
    if (result->has_truth) {
        fprintf(out, ", \"truth\": ");
        json_number(out, report_true_drag(result, j, (double)drag->speed));
    }
    fprintf(out, "}");
}

/* The known drag forces of each modelled degree of freedom, forward, then backward. */
static void json_drag(FILE *out, const result_t *result)
{
    auvid_dof_t dof[AUVID_DOF_COUNT];
    int dofs = report_dofs(result->vehicle, dof);
    fprintf(out, ",\n  \"drag\": {");
    for (int k = 0; k < dofs; ++k) {
        const char *separator = "";
        fprintf(out, "%s\n    \"%s\": [", k == 0 ? "" : ",", force[dof[k]]);
        for (int i = 0; i < 2 * REPORT_DRAG_PARTS; ++i) {
            bool backward = i >= REPORT_DRAG_PARTS;
            auvid_drag_t drag;
            if (report_drag(result, dof[k], backward, i % REPORT_DRAG_PARTS, &drag)) {
                fprintf(out, "%s\n      ", separator);
                json_drag_force(out, result, dof[k], &drag);
                separator = ",";
            }
        }
        fprintf(out, "]");
    }
    fprintf(out, "}");
}

/* By how much the drag is larger forward than the mean of both directions, relative to that. */
static void json_asymmetry(FILE *out, const result_t *result)
{
    const auvid_causes_t *causes = &result->causes;
    const char *separator = "";
    fprintf(out, ",\n  \"drag_asymmetry\": {");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (causes->asymmetry_sigma[j] > AUVID_C(0.0)) {
            fprintf(out, "%s\"%s\": {\"value\": ", separator, force[j]);
            json_number(out, (double)causes->asymmetry[j]);
            fprintf(out, ", \"sigma\": ");
            json_number(out, (double)causes->asymmetry_sigma[j]);
            fprintf(out, "}");
            separator = ", ";
        }
    }
    fprintf(out, "}");
}

/* The names of the degrees of freedom in a mask. */
static void json_dof_names(FILE *out, const char *key, uint32_t mask)
{
    const char *separator = "";
    fprintf(out, ",\n  \"%s\": [", key);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (mask >> j & 1u) {
            fprintf(out, "%s\"%s\"", separator, report_dof_name[j]);
            separator = ", ";
        }
    }
    fprintf(out, "]");
}

static void json_missing(FILE *out, const result_t *result)
{
    char text[WORDS];
    const char *separator = "";
    fprintf(out, ",\n  \"wrong_inputs\": [");
    for (unsigned k = 0; report_cause(result, k, text, sizeof text); ++k) {
        fprintf(out, k == 0 ? "\n    " : ",\n    ");
        json_string(out, text);
    }
    fprintf(out, "],\n  \"exact_inputs_differ\": [");
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (report_differs(result) >> i & 1u) {
            fprintf(out, "%s\"%s\"", separator, result->vehicle->parameter[i].name);
            separator = ", ";
        }
    }
    separator = "";
    fprintf(out, "],\n  \"missing\": [");
    for (unsigned k = 0; report_missing(result, k, text, sizeof text); ++k) {
        fprintf(out, k == 0 ? "\n    " : ",\n    ");
        json_string(out, text);
    }
    fprintf(out, "],\n  \"not_modelled\": [");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!report_is_modelled(result, (auvid_dof_t)j)) {
            fprintf(out, "%s\"%s\"", separator, report_dof_name[j]);
            separator = ", ";
        }
    }
    fprintf(out, "],\n  \"assumed\": {\"thrust_scale\": ");
    json_number(out, (double)result->estimate.confidence.uncertainty.thrust_scale);
    fprintf(out, ", \"dvl_scale\": ");
    json_number(out, (double)result->estimate.confidence.uncertainty.dvl_scale);
    fprintf(out, ", \"heading\": 0, \"inputs\": \"%s\"",
            result->estimate.confidence.unchecked ? "unchecked"
            : result->inputs_estimated            ? "estimated"
                                                  : "exact");
    if (result->over_priors > 0.0) {
        fprintf(out, ", \"over_priors\": ");
        json_number(out, result->over_priors);
    }
    json_dof_names(out, "closed_loop", result->closed_loop);
    json_dof_names(out, "open_loop", result->open_loop);
    fprintf(out, "}");
    if (report_thrust(result, text, sizeof text)) {
        fprintf(out, ",\n  \"thrust\": ");
        json_string(out, text);
    }
}

/* null: no set was predicted. */
static void json_change_test(FILE *out, const result_t *result)
{
    const auvid_change_test_t *test = &result->change_test;
    if (test->set == 0) {
        fprintf(out, ",\n  \"change_test\": null");
        return;
    }
    fprintf(out, ",\n  \"change_test\": {\"set\": %u, \"estimate\": %u", (unsigned)test->set,
            (unsigned)test->estimate);
    json_reals(out, result, "variance_ratio", force, test->variance_ratio, test->excited);
    json_reals(out, result, "change", force, test->change, test->excited);
    json_reals(out, result, "drift", force, test->drift, test->excited);
    json_reals(out, result, "r2_velocity", velocity, test->r2_velocity,
               test->simulated & test->excited);
    json_dof_names(out, "changed", test->changed);
    json_dof_names(out, "drifted", test->drifted);
    fprintf(out, "}");
}

static void json_names(FILE *out, const result_t *result, const char *key, uint32_t mask)
{
    const char *separator = "";
    fprintf(out, ", \"%s\": [", key);
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (mask >> i & 1u) {
            fprintf(out, "%s", separator);
            json_string(out, result->vehicle->parameter[i].name);
            separator = ", ";
        }
    }
    fprintf(out, "]");
}

static void json_adaptive(FILE *out, const result_t *result)
{
    if (result->excited_s > 0.0) {
        fprintf(out, ",\n  \"adaptive\": {\"excited_s\": ");
        json_number(out, result->excited_s);
        json_names(out, result, "given_up", result->given_up);
        json_names(out, result, "missing", result->still_missing);
        fprintf(out, "}");
    }
}

static void json_guard(FILE *out, const result_t *result)
{
    const auvid_guard_trip_t *trip = &result->trip;
    if (!result->has_guard) {
        return;
    }
    fprintf(out, ",\n  \"guard\": {\"state\": \"%s\", \"cause\": ",
            auvid_guard_state_str(result->guard));
    if (result->guard != AUVID_GUARD_ABORTED) {
        fprintf(out, "null}");
        return;
    }
    fprintf(out, "\"%s\", \"t_s\": ", auvid_guard_cause_str(trip->cause));
    json_number(out, 1e-6 * (double)trip->t_us);
    fprintf(out, ", \"value\": ");
    json_number(out, (double)trip->value);
    fprintf(out, ", \"limit\": ");
    json_number(out, (double)trip->limit);
    fprintf(out, "}");
}

static void json_event_log(FILE *out, const event_log_t *events)
{
    fprintf(out, ",\n  \"scenario\": \"%s\",\n  \"events\": [", events->name);
    for (int k = 0; k < events->lines; ++k) {
        fprintf(out, "%s\n    {\"t_s\": %.2f, \"text\": \"%s\"}", k == 0 ? "" : ",",
                events->line[k].t_s, events->line[k].text);
    }
    fprintf(out, "\n  ]");
}

static void json_campaign(FILE *out, const campaign_t *c)
{
    fprintf(out, ",\n  \"runs\": %u,\n  \"rms_percent\": ", (unsigned)c->runs);
    json_number(out, c->rms_percent);
    fprintf(out, ",\n  \"rms_interval\": [");
    json_number(out, c->interval[0]);
    fprintf(out, ", ");
    json_number(out, c->interval[1]);
    fprintf(out, "],\n  \"worst_percent\": ");
    json_number(out, c->worst_percent);
    fprintf(out, ",\n  \"failed\": %u", (unsigned)c->failed);
    fprintf(out, ",\n  \"known\": %u,\n  \"within_sigma\": [%u, %u]", (unsigned)c->known,
            (unsigned)c->covered[0], (unsigned)c->covered[1]);
    fprintf(out, ",\n  \"identifiable\": %u,\n  \"identifiable_wrong\": %u",
            (unsigned)c->identifiable, (unsigned)c->wrong);
}

static void json_estimates(FILE *out, const estimates_t *estimates)
{
    fprintf(out, ",\n  \"estimates\": [");
    for (uint32_t k = 0; k < estimates->count; ++k) {
        fprintf(out, "%s\n    {\"t_s\": %.2f, \"sets\": %u}", k == 0 ? "" : ",",
                estimates->at[k].t_s, (unsigned)estimates->at[k].sets);
    }
    fprintf(out, "]");
}

static void json_log(FILE *out, const char *key, const report_log_t *log)
{
    if (log->paths == 0) {
        return;
    }
    fprintf(out, ",\n  \"%s\": {\"paths\": [", key);
    for (int i = 0; i < log->paths; ++i) {
        fprintf(out, i == 0 ? "" : ", ");
        json_string(out, log->path[i]);
    }
    fprintf(out, "]");
    for (int i = 0; i < log->paths && log->shift_s != NULL; ++i) {
        fprintf(out, "%s%.1f%s", i == 0 ? ", \"input_shift_s\": [" : ", ", log->shift_s[i],
                i == log->paths - 1 ? "]" : "");
    }
    fprintf(out, ", \"rows\": %zu, \"duration_s\": ", log->rows);
    json_number(out, log->duration_s);
    fprintf(out, ", \"velocity_s\": ");
    json_number(out, log->velocity_s > 0.0 ? log->velocity_s : NAN);
    fprintf(out, ", \"gaps\": %zu, \"gap_s\": ", log->gaps);
    json_number(out, log->gap_s > 0.0 ? log->gap_s : NAN);
    if (log->changed_path != NULL) {
        fprintf(out, ", \"changed\": {\"used_from_log\": ");
        json_string(out, log->changed_path);
        fprintf(out, ", \"used_from_t_s\": %.2f}", log->changed_s);
    }
    fprintf(out, "}");
}

/* What is wrong with the logs, errors first. Nothing: no log was examined. */
static void json_findings(FILE *out, const report_findings_t *findings)
{
    const char *separator = "";
    if (findings == NULL) {
        return;
    }
    fprintf(out, ",\n  \"log_findings\": [");
    for (int warnings = 0; warnings < 2; ++warnings) {
        for (int i = 0; i < findings->count; ++i) {
            const report_finding_t *f = &findings->at[i];
            if (f->error == (warnings != 0)) {
                continue;
            }
            fprintf(out, "%s\n    {\"log\": ", separator);
            json_string(out, f->log);
            fprintf(out, ", \"severity\": \"%s\", \"code\": \"%s\", \"sentence\": ",
                    f->error ? "error" : "warning", f->code);
            json_string(out, f->sentence);
            fprintf(out, "}");
            separator = ",";
        }
    }
    fprintf(out, "]");
}

/* The comparison of maps from commands to forces. */
static void json_maps(FILE *out, const report_maps_t *maps)
{
    if (maps == NULL) {
        return;
    }
    fprintf(out,
            ",\n  \"map\": {\"used\": \"%s\", \"as_told\": \"%s\", \"best\": \"%s\", "
            "\"held_out\": \"%s\", \"blocks\": %zu, \"tried\": [",
            maps->map[maps->used].name, maps->map[0].name, maps->map[maps->best].name,
            maps->other_log ? "log" : "parts", maps->blocks);
    for (int i = 0; i < maps->count; ++i) {
        const report_map_t *map = &maps->map[i];
        bool known = map->judged && maps->map[0].judged;
        fprintf(out, "%s\n    {\"map\": \"%s\", \"error\": ", i > 0 ? "," : "", map->name);
        json_number(out, map->judged ? map->error : NAN);
        fprintf(out, ", \"difference\": ");
        json_number(out, known ? map->difference : NAN);
        fprintf(out, ", \"interval\": [");
        json_number(out, known ? map->low : NAN);
        fprintf(out, ", ");
        json_number(out, known ? map->high : NAN);
        fprintf(out, "]}");
    }
    fprintf(out, "]}");
}

/* Four digits are enough for a plot. null interrupts the line: not measured, or a gap. */
static void json_plot(FILE *out, const trace_t *trace, int j, bool predicted)
{
    fprintf(out, "\"%s\": [", predicted ? "predicted" : "measured");
    for (uint32_t k = 0; k < trace->points; ++k) {
        const trace_point_t *point = &trace->point[k];
        double x = (double)(predicted ? point->predicted : point->measured)[j];
        fprintf(out, k == 0 ? "" : ",");
        if (point->after_gap || !isfinite(x)) {
            fprintf(out, "null");
        } else {
            fprintf(out, "%.4g", x);
        }
    }
    fprintf(out, "]");
}

/* Measured and predicted velocities of the held-out run. */
static void json_trace(FILE *out, const result_t *result)
{
    const trace_t *trace = result->trace;
    if (trace == NULL || trace->points == 0) {
        return;
    }
    fprintf(out, ",\n  \"velocity\": {\n    \"t_s\": [");
    for (uint32_t k = 0; k < trace->points; ++k) {
        fprintf(out, "%s%.2f", k == 0 ? "" : ",", trace->point[k].t_s);
    }
    fprintf(out, "]");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (report_is_modelled(result, (auvid_dof_t)j) && (result->validated >> j & 1u)) {
            fprintf(out, ",\n    \"%s\": {", velocity[j]);
            json_plot(out, trace, j, false);
            fprintf(out, ",\n      ");
            json_plot(out, trace, j, true);
            fprintf(out, "}");
        }
    }
    fprintf(out, "}");
}

static void json_second_result(FILE *out, const second_result_t *second)
{
    const result_t *result = second->result;
    double rms = report_rms_percent(&result->estimate, result->truth);
    fprintf(out, ",\n  \"%s\": {\"rms_percent\": ", second->key);
    json_number(out, second->campaign == NULL ? rms : second->campaign->rms_percent);
    fprintf(out, ", \"parameters\": ");
    json_parameters(out, result);
    fprintf(out, "}");
}

void report_json(FILE *out, const result_t *result, const campaign_t *campaign,
                 const second_result_t *second, const event_log_t *events)
{
    const char *status = report_status(result);
    uint32_t worst = campaign == NULL ? result->max_work : campaign->max_work;
    if (campaign != NULL && campaign->not_converged) {
        status = "not_converged";
    }
    fprintf(out, "{\n  \"version\": \"%s\",\n  \"status\": \"%s\",\n", AUVID_VERSION_STRING,
            status);
    if (result->verdict != NULL) {
        fprintf(out, "  \"verdict\": ");
        json_string(out, result->verdict);
        fprintf(out, ",\n");
    }
    fprintf(out, "  \"seed\": %llu,\n", (unsigned long long)result->seed);
    fprintf(out, "  \"model\": ");
    json_string(out, result->vehicle->name);
    fprintf(out, ",\n  \"parameters\": ");
    json_parameters(out, result);
    json_missing(out, result);
    json_drag(out, result);
    json_asymmetry(out, result);
    json_dof_values(out, result);
    json_change_test(out, result);
    json_guard(out, result);
    json_adaptive(out, result);
    fprintf(out, ",\n  \"cell_s\": ");
    json_number(out, result->cell_s);
    fprintf(out, ",\n  \"evaluations\": {\"crs\": %u, \"line_search\": %u}",
            (unsigned)result->estimate.evaluations_crs,
            (unsigned)result->estimate.evaluations_line);
    fprintf(out, ",\n  \"budget\": {\"limit\": %u, \"worst\": %u}", (unsigned)result->budget,
            (unsigned)worst);
    if (campaign == NULL && result->estimates != NULL) {
        json_estimates(out, result->estimates);
    }
    if (campaign != NULL) {
        json_campaign(out, campaign);
    }
    if (second != NULL) {
        json_second_result(out, second);
    }
    json_log(out, "log", &result->log);
    json_log(out, "held_out_log", &result->held_out);
    json_findings(out, result->findings);
    json_maps(out, result->maps);
    json_trace(out, result);
    if (events != NULL) {
        json_event_log(out, events);
    }
    fprintf(out, "\n}\n");
}
