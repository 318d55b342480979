/*
 * Results as tables.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "report.h"

/* Longest note and sentence. */
enum { WORDS = 100 };

static double error_percent(const result_t *result, int i)
{
    return 100.0 * ((double)result->estimate.pi[i] / result->truth[i] - 1.0);
}

static void print_number(int width, int digits, double x)
{
    if (isfinite(x)) {
        printf("  %*.*f", width, digits, x);
    } else {
        printf("  %*s", width, "-");
    }
}

/* "?": not identifiable; "!": it is, but cannot be true. */
static char mark(const result_t *result, int i)
{
    const auvid_confidence_t *c = &result->estimate.confidence;
    if (!report_is_identified(result, i) || !(c->identifiable >> i & 1u)) {
        return '?';
    }
    return (c->implausible >> i & 1u) || report_is_at_bound(result, i) ? '!' : ' ';
}

/* Estimate, half-width, truth, error, note. */
static void parameter_row(const result_t *result, int i)
{
    bool known = report_is_identified(result, i);
    int digits = result->in_commands ? 5 : 3;
    char note[WORDS];
    report_note(result, i, note, sizeof note);
    print_number(10, digits, known ? (double)result->estimate.pi[i] : NAN);
    print_number(8, digits, HALF_WIDTH * report_sigma(result, i));
    if (result->has_truth) {
        print_number(9, 3, result->truth[i]);
        print_number(6, 2, known ? error_percent(result, i) : NAN);
        printf(known ? " %%" : "  ");
    }
    if (note[0] != '\0' || mark(result, i) != ' ') {
        printf("  %c %s", mark(result, i), note);
    }
}

/* Estimate and error, of all sets and of the last one. */
static void literal_row(const result_t *result, const result_t *last, int i)
{
    printf("  %10.3f  %10.3f  %8.2f %%    %10.3f  %8.2f %%", (double)result->estimate.pi[i],
           result->truth[i], error_percent(result, i), (double)last->estimate.pi[i],
           error_percent(last, i));
}

static void heading(const result_t *result, const result_t *last, int width)
{
    if (last != NULL) {
        printf("  %-20s  %-34s    %s\n", "", "all sets", "last set only");
        printf("  %-9s  %-*s  %10s  %10s  %10s    %10s  %10s\n", "parameter", width, "unit",
               "estimate", "truth", "error", "estimate", "error");
        return;
    }
    printf("  %-9s  %-*s  %10s  %8s", "parameter", width, "unit", "estimate", "+- 95 %");
    if (result->has_truth) {
        printf("  %9s  %8s", "truth", "error");
    }
    putchar('\n');
}

static void rms_row(const result_t *result, const result_t *last, int width)
{
    double rms = report_rms_percent(&result->estimate, result->truth);
    if (last != NULL) {
        printf("  %-9s  %-*s  %10s  %10s  %8.2f %%    %10s  %8.2f %%\n", "rms", width, "", "", "",
               rms, "", report_rms_percent(&last->estimate, last->truth));
    } else if (result->estimate.identified != 0) {
        printf("  %-9s  %-*s  %10s  %8s  %9s  %6.2f %%\n", "rms", width, "", "", "", "", rms);
    }
}

static void parameter_table(const result_t *result, const result_t *last)
{
    int width = result->in_commands || last != NULL ? 9 : 7;
    heading(result, last, width);
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (!(result->free >> i & 1u)) {
            continue;
        }
        printf("  %-9s  %-*s", result->vehicle->parameter[i].name, width, report_unit(result, i));
        if (last != NULL) {
            literal_row(result, last, i);
        } else {
            parameter_row(result, i);
        }
        putchar('\n');
    }
    if (result->has_truth) {
        rms_row(result, last, width);
    }
}

/* What the estimate does not know, and what to do about it. */
static void missing_list(const result_t *result)
{
    char text[WORDS];
    const char *separator = "\n  not modelled  ";
    for (unsigned k = 0; report_missing(result, k, text, sizeof text); ++k) {
        printf("%s    %s\n", k == 0 ? "\n  missing\n" : "", text);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!report_is_modelled(result, (auvid_dof_t)j)) {
            printf("%s%s", separator, report_dof_name[j]);
            separator = ", ";
        }
    }
    putchar('\n');
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

/* How the newest set was foretold. */
static void judgement_lines(const result_t *result)
{
    const auvid_judgement_t *judged = &result->judgement;
    double value[AUVID_DOF_COUNT];
    if (judged->set == 0) {
        return;
    }
    printf("  the newest set, foretold before it was used%s\n",
           judged->changed ? ": THE VEHICLE HAS CHANGED" : "");
    to_double(value, judged->variance_ratio);
    dof_line("  variance ratio of the force", 2, value, judged->driven);
    to_double(value, judged->change);
    dof_line("  evidence of a change (yes: > 1)", 2, value, judged->driven);
    to_double(value, judged->r2_velocity);
    dof_line("  R2 of its velocity", 4, value, judged->simulated & judged->driven);
}

static void guard_line(const result_t *result)
{
    const auvid_guard_trip_t *trip = &result->trip;
    if (!result->has_guard) {
        return;
    }
    printf("  guard  %s", auvid_guard_state_str(result->guard));
    if (result->guard == AUVID_GUARD_ABORTED) {
        printf(" at %.2f s: %s", 1e-6 * (double)trip->t_us, auvid_guard_cause_str(trip->cause));
        if (report_cause_unit(trip->cause)[0] != '\0') {
            printf(", %.3g %s (limit %.3g)", (double)trip->value, report_cause_unit(trip->cause),
                   (double)trip->limit);
        }
    }
    putchar('\n');
}

void report_result(const result_t *result, const result_t *last)
{
    const auvid_estimate_t *e = &result->estimate;
    parameter_table(result, last);
    missing_list(result);
    dof_table(result);
    judgement_lines(result);
    putchar('\n');
    guard_line(result);
    printf("  evaluations  %u in the global search, %u in the line search%s\n",
           (unsigned)e->evaluations_crs, (unsigned)e->evaluations_line,
           e->capped ? "; STOPPED AT A CAP: not converged" : "");
    printf("  largest work in a tick  %u units of a budget of %u\n", (unsigned)result->work_most,
           AUVID_DEFAULT_BUDGET);
}

static double part(uint32_t some, uint32_t all)
{
    return all > 0 ? 100.0 * some / all : 0.0;
}

static void campaign_summary(const campaign_t *c, const char *title)
{
    printf("%s\n", title);
    printf("  rms error    %8.2f %%   95 %% interval %.2f .. %.2f %%\n", c->rms_percent,
           c->interval[0], c->interval[1]);
    printf("  worst        %8.2f %%\n", c->worst_percent);
    printf("  failed       %8u     not converged, or a mass off by more than 10 %%\n",
           (unsigned)c->failed);
    printf("  coverage     %8.1f %%   within one standard error, %.1f %% within two\n",
           part(c->covered[0], c->known), part(c->covered[1], c->known));
    printf("  identifiable %8.1f %%   of all parameters; %u of %u more than 20 %% off\n",
           part(c->identifiable, c->runs * PARAMETERS), (unsigned)c->wrong,
           (unsigned)c->identifiable);
    printf("  evaluations  %8.0f     median of the last search; 95 %% need at most %.0f\n",
           c->evaluations_median, c->evaluations_p95);
    printf("  work         %8u     largest in any tick, budget %u\n", (unsigned)c->work_most,
           AUVID_DEFAULT_BUDGET);
}

void report_campaign(const result_t *first, const campaign_t *campaign, const campaign_t *last)
{
    printf("  %-9s  %-9s  %10s  %10s  %10s", "parameter", "unit", "truth", "rms error", "worst");
    if (last != NULL) {
        printf("    %10s  %10s", "last set", "worst");
    }
    putchar('\n');
    for (int i = 0; i < PARAMETERS; ++i) {
        const auvid_parameter_t *p = &auvid_girona500.parameter[i];
        printf("  %-9s  %-9s  %10.3f  %8.2f %%  %8.2f %%", p->name, p->unit, first->truth[i],
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
