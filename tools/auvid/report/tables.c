/*
 * Results as tables for people.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "report.h"

/* Longest note and sentence. */
enum { WORDS = 300 };

static double error_percent(const result_t *result, int i)
{
    return 100.0 * ((double)result->estimate.pi[i] / result->truth[i] - 1.0);
}

/* Width of the column of names. */
static int name_width(const result_t *result)
{
    size_t width = 9;
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        size_t length = strlen(result->vehicle->parameter[i].name);
        width = (result->free >> i & 1u) && length > width ? length : width;
    }
    return (int)width;
}

static void print_number(int width, int digits, double x)
{
    if (isfinite(x)) {
        printf("  %*.*f", width, digits, x);
    } else {
        printf("  %*s", width, "-");
    }
}

/* "?": not identifiable. "!": identifiable, but physically impossible. */
static char mark(const result_t *result, int i)
{
    const auvid_confidence_t *c = &result->estimate.confidence;
    if (!report_is_identified(result, i) || !(c->identifiable >> i & 1u)) {
        return '?';
    }
    return (c->implausible >> i & 1u) ? '!' : ' ';
}

/* Prints the relative error of an estimate. A truth of 0 has none. */
static void print_error(const result_t *result, int i, int width, bool known)
{
    if (fabs(result->truth[i]) <= 0.0) {
        printf("  %*s", width + 2, "-");
    } else {
        print_number(width, 2, known ? error_percent(result, i) : NAN);
        printf(known ? " %%" : "  ");
    }
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
        print_error(result, i, 6, known);
    }
    if (note[0] != '\0' || mark(result, i) != ' ') {
        printf("  %c %s", mark(result, i), note);
    }
}

/* Estimate and error, from all sets and from the last set only. */
static void literal_row(const result_t *result, const result_t *last, int i)
{
    printf("  %10.3f  %10.3f", (double)result->estimate.pi[i], result->truth[i]);
    print_error(result, i, 8, true);
    printf("    %10.3f", (double)last->estimate.pi[i]);
    print_error(last, i, 8, true);
}

static void heading(const result_t *result, const result_t *last, int width)
{
    int names = name_width(result);
    if (last != NULL) {
        printf("  %-*s  %-34s    %s\n", names + 11, "", "all sets", "last set only");
        printf("  %-*s  %-*s  %10s  %10s  %10s    %10s  %10s\n", names, "parameter", width, "unit",
               "estimate", "truth", "error", "estimate", "error");
        return;
    }
    printf("  %-*s  %-*s  %10s  %8s", names, "parameter", width, "unit", "estimate", "+- 95 %");
    if (result->has_truth) {
        printf("  %9s  %8s", "truth", "error");
    }
    putchar('\n');
}

static void rms_row(const result_t *result, const result_t *last, int width)
{
    int names = name_width(result), zeros = 0;
    double rms = report_rms_percent(&result->estimate, result->truth);
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        zeros += (result->free >> i & 1u) && fabs(result->truth[i]) <= 0.0;
    }
    const char *note = zeros > 0 ? "  of those whose truth is not 0" : "";
    if (last != NULL) {
        printf("  %-*s  %-*s  %10s  %10s  %8.2f %%    %10s  %8.2f %%%s\n", names, "rms", width, "",
               "", "", rms, "", report_rms_percent(&last->estimate, last->truth), note);
    } else if (result->estimate.identified != 0) {
        printf("  %-*s  %-*s  %10s  %8s  %9s  %6.2f %%%s\n", names, "rms", width, "", "", "", "",
               rms, note);
    }
}

static void parameter_table(const result_t *result, const result_t *last)
{
    int width = result->in_commands || last != NULL ? 9 : 7;
    int names = name_width(result);
    heading(result, last, width);
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (!(result->free >> i & 1u)) {
            continue;
        }
        printf("  %-*s  %-*s", names, result->vehicle->parameter[i].name, width,
               report_unit(result, i));
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

/* Forces in one direction, each with its half-width, and "?" if not identifiable. */
static void drag_row(const result_t *result, auvid_dof_t j, bool backward)
{
    int digits = result->in_commands ? 4 : 2;
    auvid_drag_t drag;
    for (int part = 0; part < REPORT_DRAG_PARTS; ++part) {
        if (!report_drag(result, j, backward, part, &drag)) {
            return;
        }
        if (part == 0) {
            printf("  %-5s  %-8s  %7.3f", report_dof_name[j], backward ? "backward" : "forward",
                   (double)result->estimate.speed[j][backward]);
        }
        print_number(8, digits, (double)drag.force);
        print_number(7, digits, drag.half_width < AUVID_LARGEST ? (double)drag.half_width : NAN);
        bool last = part == REPORT_DRAG_PARTS - 1;
        printf("%s", !drag.identifiable ? "?" : (last ? "" : " "));
    }
    putchar('\n');
}

/* The forces above contain it. */
static void print_asymmetry(const result_t *result)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double part = (double)result->causes.asymmetry[j];
        double sigma = (double)result->causes.asymmetry_sigma[j];
        if (sigma > 0.0 && fabs(part) > (double)AUVID_CAUSE_SIGMAS * sigma) {
            printf("  %-5s  the drag is %.0f %% %s forward and %s backward (+- %.0f %%)\n",
                   report_dof_name[j], 100.0 * fabs(part), part > 0.0 ? "larger" : "smaller",
                   part > 0.0 ? "smaller" : "larger", 100.0 * HALF_WIDTH * sigma);
        }
    }
}

static void drag_table(const result_t *result)
{
    printf("\n  drag force [%s] at fractions of the largest speed seen [m/s, rad/s]\n",
           result->in_commands ? "cmd" : "N, Nm");
    printf("  %-15s  %7s", "", "largest");
    for (int part = 0; part < REPORT_DRAG_PARTS; ++part) {
        printf("%s  %8.1f  %7s", part > 0 ? " " : "", report_drag_part[part], "+- 95 %");
    }
    putchar('\n');
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int backward = 0; backward < 2; ++backward) {
            drag_row(result, (auvid_dof_t)j, backward != 0);
        }
    }
    print_asymmetry(result);
}

/* The degrees of freedom of a mask, a bit each, if there are any. */
static void print_axes(const char *title, uint32_t mask)
{
    const char *before = "";
    if (mask == 0) {
        return;
    }
    printf("  %-15s", title);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if ((mask >> j & 1u) != 0) {
            printf("%s%s", before, report_dof_name[j]);
            before = ", ";
        }
    }
    printf("\n");
}

/* The estimates that inputs taken as exact would change. */
static void print_differs(const result_t *result)
{
    const char *before = "\n  exact inputs   (--plain) would give other values of ";
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (report_differs(result) >> i & 1u) {
            printf("%s%s", before, result->vehicle->parameter[i].name);
            before = ", ";
        }
    }
    if (report_differs(result) != 0) {
        puts(",\n                 by more than both half-widths: use the values above, which allow "
             "for errors\n                 of thrust and sensors");
    }
}

/* What is wrong with the inputs, what is missing for a complete estimate, what to do about it, and
 * what no motion shows. */
static void missing_list(const result_t *result)
{
    char text[WORDS];
    bool all = true;
    for (unsigned k = 0; report_cause(result, k, text, sizeof text); ++k) {
        printf("%s    %s\n", k == 0 ? "\n  wrong inputs\n" : "", text);
    }
    print_differs(result);
    for (unsigned k = 0; report_missing(result, k, text, sizeof text); ++k) {
        printf("%s    %s\n", k == 0 ? "\n  missing\n" : "", text);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!report_is_modelled(result, (auvid_dof_t)j)) {
            printf("%s%s", all ? "\n  not modelled  " : ", ", report_dof_name[j]);
            all = false;
        }
    }
    if (!all) {
        putchar('\n');
    }
    if (report_thrust(result, text, sizeof text)) {
        printf("  thrust         %s\n", text);
    }
    const auvid_uncertainty_t *u = &result->estimate.confidence.uncertainty;
    if (result->estimate.number > 0) {
        printf("  assumed        thrust scale to %.3g %%, DVL scale to %.3g %% (1 sigma); heading "
               "exact\n",
               100.0 * (double)u->thrust_scale, 100.0 * (double)u->dvl_scale);
        if (result->over_priors > 1.05) {
            printf("                 (errors of thrust and sensors are %.1f times as large as "
                   "their standard deviations:\n                 so the scales are less certain "
                   "than configured, by the square of it)\n",
                   result->over_priors);
        }
    }
    print_axes("closed loop", result->closed_loop);
    print_axes("open loop", result->open_loop);
}

/* One line with a value per modelled degree of freedom, "-" where the bit of mask is 0. */
static void dof_line(const result_t *result, const char *title, int digits, const double *value,
                     uint32_t mask)
{
    auvid_dof_t dof[AUVID_DOF_COUNT];
    int dofs = report_dofs(result->vehicle, dof);
    printf("  %-34s", title);
    for (int k = 0; k < dofs; ++k) {
        if (mask >> dof[k] & 1u) {
            printf("  %8.*f", digits, value[dof[k]]);
        } else {
            printf("  %8s", "-");
        }
    }
    putchar('\n');
}

/* The headings of the modelled degrees of freedom above such lines. */
static void dof_heading(const result_t *result, const char *const word[AUVID_DOF_COUNT])
{
    auvid_dof_t dof[AUVID_DOF_COUNT];
    int dofs = report_dofs(result->vehicle, dof);
    printf("\n  %-34s", "");
    for (int k = 0; k < dofs; ++k) {
        printf("  %8s", word[dof[k]]);
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
    static const char *const words[] = {"X, u", "Y, v", "Z, w", "K, p", "M, q", "N, r"};
    double value[AUVID_DOF_COUNT];
    uint32_t excited = result->estimate.excited;
    dof_heading(result, words);
    to_double(value, result->estimate.delay_s);
    dof_line(result, "delay from input to response [s]", 3, value, excited);
    if (result->estimate.first_order_lag & excited) {
        printf("  %-34s", "  modelled as");
        auvid_dof_t dof[AUVID_DOF_COUNT];
        int dofs = report_dofs(result->vehicle, dof);
        for (int k = 0; k < dofs; ++k) {
            bool lag = (result->estimate.first_order_lag >> dof[k] & 1u) != 0;
            printf("  %8s", excited >> dof[k] & 1u ? (lag ? "lag" : "delay") : "-");
        }
        putchar('\n');
    }
    to_double(value, result->estimate.r2_force);
    dof_line(result, "R2 of the force", 4, value, excited);
    if (result->has_validation) {
        dof_line(result, "R2 of held-out velocity", 4, result->r2, result->validated);
    }
    if (result->has_interval) {
        dof_line(result, "  95 % interval from", 4, result->r2_low, result->validated);
        dof_line(result, "                to", 4, result->r2_high, result->validated);
    }
    if (result->has_r2_truth) {
        dof_line(result, "  with the true parameters", 4, result->r2_truth, result->validated);
    }
}

/* How well the newest set was predicted. */
static void change_test_lines(const result_t *result)
{
    const auvid_change_test_t *test = &result->change_test;
    double value[AUVID_DOF_COUNT];
    if (test->set == 0) {
        return;
    }
    printf("  newest data set, predicted before it was used%s%s\n",
           test->changed ? ": THE VEHICLE HAS CHANGED" : "",
           test->drifted ? ": THE VEHICLE HAS DRIFTED since the first accepted estimate" : "");
    to_double(value, test->variance_ratio);
    dof_line(result, "  variance ratio of the force", 2, value, test->excited);
    to_double(value, test->change);
    dof_line(result, "  change statistic (changed: > 1)", 2, value, test->excited);
    to_double(value, test->drift);
    dof_line(result, "  drift statistic (drifted: > 1)", 2, value, test->excited);
    to_double(value, test->r2_velocity);
    dof_line(result, "  R2 of the velocity", 4, value, test->simulated & test->excited);
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
        bool measured = trip->limit > 0 || trip->value > 0 || trip->value < 0;
        if (measured && report_cause_unit(trip->cause)[0] != '\0') {
            printf(", %.3g %s (limit %.3g)", (double)trip->value, report_cause_unit(trip->cause),
                   (double)trip->limit);
        }
    }
    putchar('\n');
}

/* Length of the recorder's cells if the metric does not choose longer ones. */
#define DEFAULT_CELL_S 0.1

void report_result(const result_t *result, const result_t *last)
{
    const auvid_estimate_t *e = &result->estimate;
    parameter_table(result, last);
    if (last == NULL && e->excited != 0) {
        drag_table(result);
    }
    missing_list(result);
    dof_table(result);
    change_test_lines(result);
    putchar('\n');
    guard_line(result);
    if (result->cell_s > DEFAULT_CELL_S) {
        printf(
            "  cells        %.1f s instead of %.1f s: the vehicle is slow, and a shorter smoother\n"
            "               passes mostly noise\n",
            result->cell_s, DEFAULT_CELL_S);
    }
    printf("  evaluations  %u in the global search, %u in the line search%s\n",
           (unsigned)e->evaluations_crs, (unsigned)e->evaluations_line,
           e->not_converged ? "; NOT CONVERGED" : "");
    printf("  largest work per tick   %u units of a budget of %u\n", (unsigned)result->max_work,
           (unsigned)result->budget);
}

static double part(uint32_t some, uint32_t all)
{
    return all > 0 ? 100.0 * some / all : 0.0;
}

static void campaign_summary(const campaign_t *c, const char *title, uint32_t budget)
{
    printf("%s\n", title);
    printf("  rms error    %8.2f %%   95 %% interval %.2f .. %.2f %%\n", c->rms_percent,
           c->interval[0], c->interval[1]);
    printf("  worst        %8.2f %%\n", c->worst_percent);
    printf("  failed       %8u     not converged, or an error of a mass above 10 %%\n",
           (unsigned)c->failed);
    printf("  coverage     %8.1f %%   within one standard error, %.1f %% within two\n",
           part(c->covered[0], c->known), part(c->covered[1], c->known));
    printf("  identifiable %8.1f %%   of all parameters; errors above 20 %%: %u of %u\n",
           part(c->identifiable, c->runs * (uint32_t)c->parameters), (unsigned)c->wrong,
           (unsigned)c->identifiable);
    printf("  evaluations  %8.0f     median of the last search, 95th percentile %.0f\n",
           c->evaluations_median, c->evaluations_p95);
    printf("  work         %8u     largest of any tick, budget %u\n", (unsigned)c->max_work,
           (unsigned)budget);
}

/* Errors of one parameter: relative, or absolute where the truth is 0. */
static void campaign_errors(const result_t *first, const campaign_t *campaign, int i)
{
    if (fabs(first->truth[i]) > 0.0) {
        printf("  %8.2f %%  %8.2f %%", campaign->parameter_rms[i], campaign->parameter_worst[i]);
    } else {
        printf("  %8.3f    %8.3f  ", campaign->parameter_rms[i], campaign->parameter_worst[i]);
    }
}

void report_campaign(const result_t *first, const campaign_t *campaign, const campaign_t *last)
{
    static const char *const words[] = {"u", "v", "w", "p", "q", "r"};
    char title[WORDS] = "  all sets";
    int names = name_width(first);
    printf("  %-*s  %-9s  %10s  %10s  %10s", names, "parameter", "unit", "truth", "rms error",
           "worst");
    if (last != NULL) {
        printf("    %10s  %10s", "last set", "worst");
    }
    putchar('\n');
    for (int i = 0; i < first->vehicle->parameters; ++i) {
        const auvid_parameter_t *p = &first->vehicle->parameter[i];
        if (!(first->free >> i & 1u)) {
            continue;
        }
        printf("  %-*s  %-9s  %10.3f", names, p->name, p->unit, first->truth[i]);
        campaign_errors(first, campaign, i);
        if (last != NULL) {
            printf("  ");
            campaign_errors(first, last, i);
        }
        putchar('\n');
    }
    putchar('\n');
    if (last == NULL) {
        int length =
            snprintf(title, sizeof title, "  %d parameters, all runs", campaign->parameters);
        if (campaign->relative < campaign->parameters) {
            (void)snprintf(title + length, sizeof title - (size_t)length,
                           "; errors of the %d whose truth is not 0", campaign->relative);
        }
    }
    campaign_summary(campaign, title, first->budget);
    if (last != NULL) {
        campaign_summary(last, "\n  last set only", first->budget);
    }
    dof_heading(first, words);
    dof_line(first, "R2 of held-out velocity, median", 4, campaign->r2_median, UINT32_MAX);
    dof_line(first, "  with the true parameters", 4, campaign->r2_truth_median, UINT32_MAX);
}
