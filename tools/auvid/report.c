#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "complain.h"

const auvid_dof_t report_dof[MODELLED] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};

const char *report_status(const result_t *result)
{
    if (result->estimate.number == 0 || result->estimate.identified == 0) {
        return "not_driven";
    }
    return result->estimate.capped ? "capped" : "ok";
}

int report_exit(const result_t *result)
{
    return strcmp(report_status(result), "ok") == 0 ? 0 : 1;
}

double report_truth(int i)
{
    return (double)auvid_girona500_paper[i];
}

/* Relative error of parameter i. */
static double error_of(const auvid_estimate_t *estimate, int i)
{
    return (double)estimate->pi[i] / report_truth(i) - 1.0;
}

double report_rms_percent(const auvid_estimate_t *estimate)
{
    double squares = 0.0;
    for (int i = 0; i <= AUVID_G500_N_RR; ++i) {
        squares += error_of(estimate, i) * error_of(estimate, i);
    }
    return 100.0 * sqrt(squares / (AUVID_G500_N_RR + 1));
}

double report_worst_percent(const auvid_estimate_t *estimate)
{
    double worst = 0.0;
    for (int i = 0; i <= AUVID_G500_N_RR; ++i) {
        worst = fmax(worst, fabs(error_of(estimate, i)));
    }
    return 100.0 * worst;
}

/* Unit of parameter i. Where the inputs are commands, a force is measured in commands. */
static const char *unit(const result_t *result, int i)
{
    static const char *const commands[AUVID_G500_COUNT] = {
        [AUVID_G500_M_U] = "cmd s2/m",   [AUVID_G500_M_V] = "cmd s2/m",
        [AUVID_G500_M_W] = "cmd s2/m",   [AUVID_G500_M_R] = "cmd s2",
        [AUVID_G500_W_B] = "cmd",        [AUVID_G500_X_U] = "cmd s/m",
        [AUVID_G500_X_UU] = "cmd s2/m2", [AUVID_G500_Y_V] = "cmd s/m",
        [AUVID_G500_Y_VV] = "cmd s2/m2", [AUVID_G500_Z_W] = "cmd s/m",
        [AUVID_G500_Z_WW] = "cmd s2/m2", [AUVID_G500_N_R] = "cmd s",
        [AUVID_G500_N_RR] = "cmd s2",    [AUVID_G500_X_0] = "cmd",
        [AUVID_G500_Y_0] = "cmd",        [AUVID_G500_Z_0] = "cmd",
        [AUVID_G500_N_0] = "cmd"};
    return result->in_commands ? commands[i] : result->vehicle->parameter[i].unit;
}

static bool is_free(const result_t *result, int i)
{
    return (result->free >> i & 1u) != 0;
}

static bool is_identified(const result_t *result, int i)
{
    return result->estimate.number > 0 && (result->estimate.identified >> i & 1u) != 0;
}

static bool is_driven(const result_t *result, auvid_dof_t j)
{
    return result->estimate.number > 0 && (result->estimate.driven >> j & 1u) != 0;
}

/* Within a thousandth of the bounds' distance? */
static bool is_at_bound(const result_t *result, int i)
{
    double x = (double)result->estimate.pi[i], near = 1e-3 * (result->upper - result->lower);
    return near > 0.0 && (x < result->lower + near || x > result->upper - near);
}

/* ---- tables ---- */

static void parameter_row(const result_t *result, const result_t *last, int i)
{
    const auvid_parameter_t *parameter = &result->vehicle->parameter[i];
    printf("  %-9s  %-9s", parameter->name, unit(result, i));
    if (!is_identified(result, i)) {
        const char *why = result->why[parameter->dof];
        printf("  %10s   %s\n", "-", why == NULL ? "not identified" : why);
        return;
    }
    printf(result->in_commands ? "  %10.5f" : "  %10.3f", (double)result->estimate.pi[i]);
    if (result->has_truth) {
        printf("  %10.3f  %8.2f %%", report_truth(i), 100.0 * error_of(&result->estimate, i));
    }
    if (is_at_bound(result, i)) {
        printf("   at its bound");
    }
    if (last != NULL) {
        printf("    %10.3f  %8.2f %%", (double)last->estimate.pi[i],
               100.0 * error_of(&last->estimate, i));
    }
    putchar('\n');
}

static void parameter_table(const result_t *result, const result_t *last)
{
    if (last != NULL) {
        printf("  %-20s  %-34s    %s\n", "", "all sets", "last set only");
    }
    printf("  %-9s  %-9s  %10s", "parameter", "unit", "estimate");
    if (result->has_truth) {
        printf("  %10s  %10s", "truth", "error");
    }
    if (last != NULL) {
        printf("    %10s  %10s", "estimate", "error");
    }
    putchar('\n');
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (is_free(result, i)) {
            parameter_row(result, last, i);
        }
    }
    if (result->has_truth) {
        printf("  %-9s  %-9s  %10s  %10s  %8.2f %%", "rms", "", "", "",
               report_rms_percent(&result->estimate));
        if (last != NULL) {
            printf("    %10s  %8.2f %%", "", report_rms_percent(&last->estimate));
        }
        putchar('\n');
    }
}

/* One line with a value for each modelled degree of freedom; "-" where mask has no bit. */
static void dof_line(const char *title, int digits, const double *value, uint32_t mask)
{
    printf("  %-34s", title);
    for (int k = 0; k < MODELLED; ++k) {
        if (mask >> report_dof[k] & 1u) {
            printf("  %8.*f", digits, value[report_dof[k]]);
        } else {
            printf("  %8s", "-");
        }
    }
    putchar('\n');
}

static void to_double(double *to, const auvid_real_t *from)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        to[j] = (double)from[j];
    }
}

static void dof_table(const result_t *result)
{
    double value[AUVID_DOF_COUNT];
    uint32_t driven = result->estimate.driven;
    printf("\n  %-34s  %8s  %8s  %8s  %8s\n", "", "X, u", "Y, v", "Z, w", "N, r");
    to_double(value, result->estimate.delay_s);
    dof_line("delay from input to response [s]", 3, value, driven);
    if (result->estimate.lagged & driven) {
        printf("  %-34s", "  which is that of a");
        for (int k = 0; k < MODELLED; ++k) {
            bool lag = (result->estimate.lagged >> report_dof[k] & 1u) != 0;
            printf("  %8s", driven >> report_dof[k] & 1u ? (lag ? "lag" : "shift") : "-");
        }
        putchar('\n');
    }
    to_double(value, result->estimate.r2_force);
    dof_line("R2 of the force", 4, value, driven);
    if (result->has_validation) {
        dof_line("R2 of held-out velocity", 4, result->r2, result->validated);
    }
    if (result->has_interval) {
        dof_line("  95 % interval from", 4, result->r2_low, result->validated);
        dof_line("                to", 4, result->r2_high, result->validated);
    }
    if (result->has_r2_truth) {
        dof_line("  with the true parameters", 4, result->r2_truth, result->validated);
    }
}

void report_result(const result_t *result, const result_t *last)
{
    const auvid_estimate_t *e = &result->estimate;
    parameter_table(result, last);
    dof_table(result);
    printf("\n  evaluations  %u in the global search, %u in the line search%s\n",
           (unsigned)e->evaluations_crs, (unsigned)e->evaluations_line,
           e->capped ? "; STOPPED AT A CAP: not converged" : "");
    printf("  largest work in a tick  %u units of a budget of %u\n", (unsigned)result->work_most,
           AUVID_DEFAULT_BUDGET);
}

static void campaign_summary(const campaign_t *c, const char *title)
{
    printf("%s\n", title);
    printf("  rms error    %8.2f %%   95 %% interval %.2f .. %.2f %%\n", c->rms_percent,
           c->interval[0], c->interval[1]);
    printf("  worst        %8.2f %%\n", c->worst_percent);
    printf("  failed       %8u     not converged, or a mass off by more than 10 %%\n",
           (unsigned)c->failed);
    printf("  evaluations  %8.0f     median of the last search; 95 %% need at most %.0f\n",
           c->evaluations_median, c->evaluations_p95);
    printf("  work         %8u     largest in any tick, budget %u\n", (unsigned)c->work_most,
           AUVID_DEFAULT_BUDGET);
}

void report_campaign(const campaign_t *campaign, const campaign_t *last)
{
    printf("  %-9s  %-9s  %10s  %10s  %10s", "parameter", "unit", "truth", "rms error", "worst");
    if (last != NULL) {
        printf("    %10s  %10s", "last set", "worst");
    }
    putchar('\n');
    for (int i = 0; i <= AUVID_G500_N_RR; ++i) {
        const auvid_parameter_t *p = &auvid_girona500.parameter[i];
        printf("  %-9s  %-9s  %10.3f  %8.2f %%  %8.2f %%", p->name, p->unit, report_truth(i),
               campaign->parameter_rms[i], campaign->parameter_worst[i]);
        if (last != NULL) {
            printf("    %8.2f %%  %8.2f %%", last->parameter_rms[i], last->parameter_worst[i]);
        }
        putchar('\n');
    }
    putchar('\n');
    campaign_summary(campaign, last == NULL ? "  13 parameters, all runs" : "  all sets");
    if (last != NULL) {
        campaign_summary(last, "\n  last set only");
    }
    printf("\n  %-34s  %8s  %8s  %8s  %8s\n", "", "u", "v", "w", "r");
    dof_line("R2 of held-out velocity, median", 4, campaign->r2_median, UINT32_MAX);
    dof_line("  with the true parameters", 4, campaign->r2_truth_median, UINT32_MAX);
}

/* ---- JSON ---- */

/* Nine digits give a float back exactly. JSON knows no infinity. */
static void json_number(double x)
{
    if (isfinite(x)) {
        printf("%.9g", x);
    } else {
        printf("null");
    }
}

static void json_parameters(const result_t *result)
{
    const char *separator = "";
    printf("[");
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (!is_free(result, i)) {
            continue;
        }
        printf("%s\n    {\"name\": \"%s\", \"unit\": \"%s\", \"estimate\": ", separator,
               result->vehicle->parameter[i].name, unit(result, i));
        json_number(is_identified(result, i) ? (double)result->estimate.pi[i] : NAN);
        if (is_identified(result, i) && is_at_bound(result, i)) {
            printf(", \"at_bound\": true");
        }
        if (result->has_truth) {
            printf(", \"truth\": ");
            json_number(report_truth(i));
        }
        printf("}");
        separator = ",";
    }
    printf("\n  ]");
}

/* An object with a value, or [low, high], for each modelled degree of freedom. */
static void json_dofs(const char *key, const char *const *names, const double *low,
                      const double *high, uint32_t mask)
{
    printf(",\n  \"%s\": {", key);
    for (int k = 0; k < MODELLED; ++k) {
        auvid_dof_t j = report_dof[k];
        printf("%s\"%s\": ", k == 0 ? "" : ", ", names[k]);
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

static void json_dof_values(const result_t *result)
{
    static const char *const force[MODELLED] = {"X", "Y", "Z", "N"};
    static const char *const velocity[MODELLED] = {"u", "v", "w", "r"};
    double value[AUVID_DOF_COUNT];
    uint32_t driven = 0;
    for (int k = 0; k < MODELLED; ++k) {
        driven |= (uint32_t)is_driven(result, report_dof[k]) << report_dof[k];
    }
    to_double(value, result->estimate.delay_s);
    json_dofs("delay_s", force, value, NULL, driven);
    to_double(value, result->estimate.r2_force);
    json_dofs("r2_force", force, value, NULL, driven);
    json_dofs("r2_validation", velocity, result->r2, NULL,
              result->has_validation ? result->validated : 0u);
    if (result->has_interval) {
        json_dofs("r2_interval", velocity, result->r2_low, result->r2_high, result->validated);
    }
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
}

void report_json(const result_t *result, const campaign_t *campaign, const result_t *last,
                 const campaign_t *last_campaign)
{
    const char *status = report_status(result);
    uint32_t worst = campaign == NULL ? result->work_most : campaign->work_most;
    if (campaign != NULL && campaign->capped) {
        status = "capped";
    }
    printf("{\n  \"version\": \"%s\",\n  \"status\": \"%s\",\n  \"seed\": %llu,\n",
           AUVID_VERSION_STRING, status, (unsigned long long)result->seed);
    printf("  \"model\": \"%s\",\n  \"parameters\": ", result->vehicle->name);
    json_parameters(result);
    json_dof_values(result);
    printf(",\n  \"evaluations\": {\"crs\": %u, \"line_search\": %u}",
           (unsigned)result->estimate.evaluations_crs, (unsigned)result->estimate.evaluations_line);
    printf(",\n  \"budget\": {\"limit\": %u, \"worst\": %u}", AUVID_DEFAULT_BUDGET,
           (unsigned)worst);
    if (campaign != NULL) {
        json_campaign(campaign);
    }
    if (last != NULL) {
        printf(",\n  \"last_set\": {\"rms_percent\": ");
        json_number(last_campaign == NULL ? report_rms_percent(&last->estimate)
                                          : last_campaign->rms_percent);
        printf(", \"parameters\": ");
        json_parameters(last);
        printf("}");
    }
    printf("\n}\n");
}

int report_finish(int status)
{
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout)) {
        return complain("standard output: cannot be written: %s", strerror(errno));
    }
    return status;
}
