/*
 * Results as JSON.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "report.h"

/* Longest note and sentence. */
enum { WORDS = 200 };

/* Nine digits represent a float exactly. JSON has no infinity. */
static void json_number(double x)
{
    if (isfinite(x)) {
        printf("%.9g", x);
    } else {
        printf("null");
    }
}

static void json_parameter(const result_t *result, int i)
{
    bool known = report_is_identified(result, i);
    bool sure = known && (result->estimate.confidence.identifiable >> i & 1u) != 0;
    char note[WORDS];
    report_note(result, i, note, sizeof note);
    printf(", \"estimate\": ");
    json_number(known ? (double)result->estimate.pi[i] : NAN);
    printf(", \"sigma\": ");
    json_number(report_sigma(result, i));
    printf(", \"sigma_told\": ");
    json_number(report_sigma_told(result, i));
    printf(", \"thrust_error\": ");
    json_number(known ? (double)result->estimate.confidence.thrust_error[i] : NAN);
    printf(", \"dvl_error\": ");
    json_number(known ? (double)result->estimate.confidence.dvl_error[i] : NAN);
    printf(", \"identifiable\": %s, \"note\": \"%s\"", sure ? "true" : "false", note);
    if (known && report_is_at_bound(result, i)) {
        printf(", \"at_bound\": true");
    }
    if (result->has_truth) {
        printf(", \"truth\": ");
        json_number(result->truth[i]);
    }
}

static void json_parameters(const result_t *result)
{
    const char *separator = "";
    printf("[");
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (!(result->free >> i & 1u)) {
            continue;
        }
        printf("%s\n    {\"name\": \"%s\", \"unit\": \"%s\"", separator,
               result->vehicle->parameter[i].name, report_unit(result, i));
        json_parameter(result, i);
        printf("}");
        separator = ",";
    }
    printf("\n  ]");
}

/* An object with a value, or [low, high], per modelled degree of freedom. */
static void json_dofs(const result_t *result, const char *key, const char *const *names,
                      const double *low, const double *high, uint32_t mask)
{
    auvid_dof_t dof[AUVID_DOF_COUNT];
    int dofs = report_dofs(result->vehicle, dof);
    printf(",\n  \"%s\": {", key);
    for (int k = 0; k < dofs; ++k) {
        auvid_dof_t j = dof[k];
        printf("%s\"%s\": ", k == 0 ? "" : ", ", names[j]);
        if (!(mask >> j & 1u)) {
            printf("null");
        } else if (high == NULL) {
            json_number(low[j]);
        } else {
            printf("[");
            json_number(low[j]);
            printf(", ");
            json_number(high[j]);
            printf("]");
        }
    }
    printf("}");
}

static const char *const force[AUVID_DOF_COUNT] = {"X", "Y", "Z", "K", "M", "N"};
static const char *const velocity[AUVID_DOF_COUNT] = {"u", "v", "w", "p", "q", "r"};

/* The same from numbers of the library. */
static void json_reals(const result_t *result, const char *key, const char *const *names,
                       const auvid_real_t *value, uint32_t mask)
{
    double copy[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        copy[j] = (double)value[j];
    }
    json_dofs(result, key, names, copy, NULL, mask);
}

static void json_dof_values(const result_t *result)
{
    uint32_t excited = result->estimate.number > 0 ? result->estimate.excited : 0u;
    json_reals(result, "delay_s", force, result->estimate.delay_s, excited);
    json_reals(result, "r2_force", force, result->estimate.r2_force, excited);
    json_dofs(result, "r2_validation", velocity, result->r2, NULL,
              result->has_validation ? result->validated : 0u);
    if (result->has_interval) {
        json_dofs(result, "r2_interval", velocity, result->r2_low, result->r2_high,
                  result->validated);
    }
}

static void json_drag_force(const result_t *result, auvid_dof_t j, const auvid_drag_t *drag)
{
    double known = drag->half_width < AUVID_LARGEST ? (double)drag->half_width : NAN;
    printf("{\"speed\": ");
    json_number((double)drag->speed);
    printf(", \"force\": ");
    json_number((double)drag->force);
    printf(", \"half_width\": ");
    json_number(known);
    printf(", \"identifiable\": %s", drag->identifiable ? "true" : "false");
    if (result->has_truth) {
        printf(", \"truth\": ");
        json_number(report_true_drag(result, j, (double)drag->speed));
    }
    printf("}");
}

/* The known drag forces of each modelled degree of freedom, forward, then backward. */
static void json_drag(const result_t *result)
{
    auvid_dof_t dof[AUVID_DOF_COUNT];
    int dofs = report_dofs(result->vehicle, dof);
    printf(",\n  \"drag\": {");
    for (int k = 0; k < dofs; ++k) {
        const char *separator = "";
        printf("%s\n    \"%s\": [", k == 0 ? "" : ",", force[dof[k]]);
        for (int i = 0; i < 2 * REPORT_DRAG_PARTS; ++i) {
            bool backward = i >= REPORT_DRAG_PARTS;
            auvid_drag_t drag;
            if (report_drag(result, dof[k], backward, i % REPORT_DRAG_PARTS, &drag)) {
                printf("%s\n      ", separator);
                json_drag_force(result, dof[k], &drag);
                separator = ",";
            }
        }
        printf("]");
    }
    printf("}");
}

static void json_missing(const result_t *result)
{
    char text[WORDS];
    const char *separator = "";
    printf(",\n  \"wrong_inputs\": [");
    for (unsigned k = 0; report_cause(result, k, text, sizeof text); ++k) {
        printf("%s\n    \"%s\"", k == 0 ? "" : ",", text);
    }
    printf("],\n  \"missing\": [");
    for (unsigned k = 0; report_missing(result, k, text, sizeof text); ++k) {
        printf("%s\n    \"%s\"", k == 0 ? "" : ",", text);
    }
    printf("],\n  \"not_modelled\": [");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!report_is_modelled(result, (auvid_dof_t)j)) {
            printf("%s\"%s\"", separator, report_dof_name[j]);
            separator = ", ";
        }
    }
    printf("],\n  \"assumed\": {\"thrust_scale\": ");
    json_number((double)result->estimate.confidence.uncertainty.thrust_scale);
    printf(", \"dvl_scale\": ");
    json_number((double)result->estimate.confidence.uncertainty.dvl_scale);
    printf(", \"heading\": 0}");
}

/* The names of the degrees of freedom in a mask. */
static void json_dof_names(const char *key, uint32_t mask)
{
    const char *separator = "";
    printf(",\n  \"%s\": [", key);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (mask >> j & 1u) {
            printf("%s\"%s\"", separator, report_dof_name[j]);
            separator = ", ";
        }
    }
    printf("]");
}

/* null: no set was predicted. */
static void json_change_test(const result_t *result)
{
    const auvid_change_test_t *test = &result->change_test;
    if (test->set == 0) {
        printf(",\n  \"change_test\": null");
        return;
    }
    printf(",\n  \"change_test\": {\"set\": %u, \"estimate\": %u", (unsigned)test->set,
           (unsigned)test->estimate);
    json_reals(result, "variance_ratio", force, test->variance_ratio, test->excited);
    json_reals(result, "change", force, test->change, test->excited);
    json_reals(result, "drift", force, test->drift, test->excited);
    json_reals(result, "r2_velocity", velocity, test->r2_velocity, test->simulated & test->excited);
    json_dof_names("changed", test->changed);
    json_dof_names("drifted", test->drifted);
    printf("}");
}

static void json_names(const result_t *result, const char *key, uint32_t mask)
{
    const char *separator = "";
    printf(", \"%s\": [", key);
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (mask >> i & 1u) {
            printf("%s\"%s\"", separator, result->vehicle->parameter[i].name);
            separator = ", ";
        }
    }
    printf("]");
}

static void json_adaptive(const result_t *result)
{
    if (result->excited_s > 0.0) {
        printf(",\n  \"adaptive\": {\"excited_s\": ");
        json_number(result->excited_s);
        json_names(result, "given_up", result->given_up);
        json_names(result, "missing", result->still_missing);
        printf("}");
    }
}

static void json_guard(const result_t *result)
{
    const auvid_guard_trip_t *trip = &result->trip;
    if (!result->has_guard) {
        return;
    }
    printf(",\n  \"guard\": {\"state\": \"%s\", \"cause\": ", auvid_guard_state_str(result->guard));
    if (result->guard != AUVID_GUARD_ABORTED) {
        printf("null}");
        return;
    }
    printf("\"%s\", \"t_s\": ", auvid_guard_cause_str(trip->cause));
    json_number(1e-6 * (double)trip->t_us);
    printf(", \"value\": ");
    json_number((double)trip->value);
    printf(", \"limit\": ");
    json_number((double)trip->limit);
    printf("}");
}

static void json_event_log(const event_log_t *events)
{
    printf(",\n  \"scenario\": \"%s\",\n  \"events\": [", events->name);
    for (int k = 0; k < events->lines; ++k) {
        printf("%s\n    {\"t_s\": %.2f, \"text\": \"%s\"}", k == 0 ? "" : ",", events->line[k].t_s,
               events->line[k].text);
    }
    printf("\n  ]");
}

static void json_campaign(const campaign_t *c)
{
    printf(",\n  \"runs\": %u,\n  \"rms_percent\": ", (unsigned)c->runs);
    json_number(c->rms_percent);
    printf(",\n  \"rms_interval\": [");
    json_number(c->interval[0]);
    printf(", ");
    json_number(c->interval[1]);
    printf("],\n  \"worst_percent\": ");
    json_number(c->worst_percent);
    printf(",\n  \"failed\": %u", (unsigned)c->failed);
    printf(",\n  \"known\": %u,\n  \"within_sigma\": [%u, %u]", (unsigned)c->known,
           (unsigned)c->covered[0], (unsigned)c->covered[1]);
    printf(",\n  \"identifiable\": %u,\n  \"identifiable_wrong\": %u", (unsigned)c->identifiable,
           (unsigned)c->wrong);
}

static void json_estimates(const estimates_t *estimates)
{
    printf(",\n  \"estimates\": [");
    for (uint32_t k = 0; k < estimates->count; ++k) {
        printf("%s\n    {\"t_s\": %.2f, \"sets\": %u}", k == 0 ? "" : ",", estimates->at[k].t_s,
               (unsigned)estimates->at[k].sets);
    }
    printf("]");
}

static void json_second_result(const second_result_t *second)
{
    const result_t *result = second->result;
    double rms = report_rms_percent(&result->estimate, result->truth);
    printf(",\n  \"%s\": {\"rms_percent\": ", second->key);
    json_number(second->campaign == NULL ? rms : second->campaign->rms_percent);
    printf(", \"parameters\": ");
    json_parameters(result);
    printf("}");
}

void report_json(const result_t *result, const campaign_t *campaign, const second_result_t *second,
                 const event_log_t *events)
{
    const char *status = report_status(result);
    uint32_t worst = campaign == NULL ? result->max_work : campaign->max_work;
    if (campaign != NULL && campaign->not_converged) {
        status = "not_converged";
    }
    printf("{\n  \"version\": \"%s\",\n  \"status\": \"%s\",\n  \"seed\": %llu,\n",
           AUVID_VERSION_STRING, status, (unsigned long long)result->seed);
    printf("  \"model\": \"%s\",\n  \"parameters\": ", result->vehicle->name);
    json_parameters(result);
    json_missing(result);
    json_drag(result);
    json_dof_values(result);
    json_change_test(result);
    json_guard(result);
    json_adaptive(result);
    printf(",\n  \"cell_s\": ");
    json_number(result->cell_s);
    printf(",\n  \"evaluations\": {\"crs\": %u, \"line_search\": %u}",
           (unsigned)result->estimate.evaluations_crs, (unsigned)result->estimate.evaluations_line);
    printf(",\n  \"budget\": {\"limit\": %u, \"worst\": %u}", (unsigned)result->budget,
           (unsigned)worst);
    if (campaign == NULL && result->estimates != NULL) {
        json_estimates(result->estimates);
    }
    if (campaign != NULL) {
        json_campaign(campaign);
    }
    if (second != NULL) {
        json_second_result(second);
    }
    if (events != NULL) {
        json_event_log(events);
    }
    printf("\n}\n");
}
