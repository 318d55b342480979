#include "field_causes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Classes with a shift of at least that of this rank are the largest. */
#define LARGEST 3

static const char *const names[AUVID_CAUSE_COUNT] = {
    [AUVID_CAUSE_CURVE] = "thrust_curve",  [AUVID_CAUSE_INFLOW] = "inflow",
    [AUVID_CAUSE_TIMING] = "timing",       [AUVID_CAUSE_MOUNTING] = "mounting",
    [AUVID_CAUSE_ASYMMETRY] = "asymmetry", [AUVID_CAUSE_SAG] = "sag",
    [AUVID_CAUSE_CURRENT] = "current"};

/* The class of each kind of mismatch; those not listed have none. */
static const struct {
    const char *mismatch;
    auvid_cause_class_t class;
} classes[] = {{"thrust_backward", AUVID_CAUSE_CURVE},
               {"thrust_exponent", AUVID_CAUSE_CURVE},
               {"thrust_dead_band", AUVID_CAUSE_CURVE},
               {"thrust_advance", AUVID_CAUSE_INFLOW},
               {"drag_exponent", AUVID_CAUSE_INFLOW},
               {"cross_flow", AUVID_CAUSE_INFLOW},
               {"thrust_lag", AUVID_CAUSE_TIMING},
               {"thrust_force_lag", AUVID_CAUSE_TIMING},
               {"thrust_late", AUVID_CAUSE_TIMING},
               {"dvl_latency", AUVID_CAUSE_TIMING},
               {"filter_tau", AUVID_CAUSE_TIMING},
               {"attitude_delay", AUVID_CAUSE_TIMING},
               {"imu_roll", AUVID_CAUSE_MOUNTING},
               {"imu_pitch", AUVID_CAUSE_MOUNTING},
               {"dvl_arm_x", AUVID_CAUSE_MOUNTING},
               {"dvl_arm_y", AUVID_CAUSE_MOUNTING},
               {"dvl_arm_z", AUVID_CAUSE_MOUNTING},
               {"dvl_yaw", AUVID_CAUSE_MOUNTING},
               {"dvl_roll", AUVID_CAUSE_MOUNTING},
               {"dvl_pitch", AUVID_CAUSE_MOUNTING},
               {"cross", AUVID_CAUSE_MOUNTING},
               {"cg_x", AUVID_CAUSE_MOUNTING},
               {"cg_y", AUVID_CAUSE_MOUNTING},
               {"drag_asymmetry", AUVID_CAUSE_ASYMMETRY},
               {"thrust_sag", AUVID_CAUSE_SAG},
               {"battery", AUVID_CAUSE_SAG},
               {"fouling", AUVID_CAUSE_SAG},
               {"current", AUVID_CAUSE_CURRENT},
               {"cable", AUVID_CAUSE_CURRENT}};

static auvid_cause_class_t class_of_mismatch(int k)
{
    const field_mismatch_t *kind;
    (void)field_mismatches(&kind);
    for (size_t i = 0; i < sizeof classes / sizeof classes[0]; ++i) {
        if (strcmp(classes[i].mismatch, kind[k].name) == 0) {
            return classes[i].class;
        }
    }
    return AUVID_CAUSE_COUNT;
}

/* ---- shift of the estimate ---- */

static double relative_shift(const field_record_t *one, const field_record_t *base)
{
    double squares = 0.0;
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        double shift = one->pi[i] / base->pi[i] - 1.0;
        squares += shift * shift;
    }
    for (int d = 0; d < FIELD_DIRECTIONS; ++d) {
        double shift = one->force[1][d].value / base->force[1][d].value - 1.0;
        squares += isfinite(shift) ? shift * shift : 0.0;
    }
    return sqrt(squares / (SIM_M_R - SIM_M_U + 1 + FIELD_DIRECTIONS));
}

bool field_causes_shift(field_run_t *run, const field_run_config_t *config, field_record_t *record)
{
    field_record_t base, one;
    field_run_config_t plain = *config;
    plain.uncertain = false;
    for (int class = AUVID_CAUSE_COUNT; class >= 0; --class) { /* first without any */
        for (int k = 0; k < FIELD_MISMATCHES; ++k) {
            bool is_kind = fabs(config->field.size[k]) > 0.0;
            auvid_cause_class_t of = is_kind ? class_of_mismatch(k) : AUVID_CAUSE_COUNT;
            bool kept = of == AUVID_CAUSE_COUNT || (int)of == class;
            plain.field.size[k] = kept ? config->field.size[k] : 0.0;
        }
        if (!field_run(run, &plain, class == AUVID_CAUSE_COUNT ? &base : &one)) {
            return false;
        }
        if (class < AUVID_CAUSE_COUNT) {
            record->shift[class] = relative_shift(&one, &base);
        }
    }
    record->has_shift = true;
    return true;
}

/* ---- counts ---- */

typedef struct {
    uint32_t first[AUVID_CAUSE_COUNT], named[AUVID_CAUSE_COUNT];
    uint32_t any, right, shifted, among_largest; /* runs */
} counts_t;

static bool is_present(const field_record_t *record, auvid_cause_class_t class)
{
    bool present = false;
    for (int k = 0; k < FIELD_MISMATCHES; ++k) {
        present = present || (fabs(record->size[k]) > 0.0 && class_of_mismatch(k) == class);
    }
    return present;
}

static bool is_among_largest(const field_record_t *record, auvid_cause_class_t class)
{
    int larger = 0;
    for (int k = 0; k < AUVID_CAUSE_COUNT; ++k) {
        larger += record->shift[k] > record->shift[class];
    }
    return larger < LARGEST;
}

static void count(const field_record_t *record, uint32_t runs, counts_t *to)
{
    memset(to, 0, sizeof *to);
    for (uint32_t k = 0; k < runs; ++k) {
        const auvid_causes_t *causes = &record[k].causes;
        for (int i = 0; i < causes->named; ++i) {
            ++to->named[causes->order[i]];
        }
        if (causes->named > 0) {
            auvid_cause_class_t first = (auvid_cause_class_t)causes->order[0];
            ++to->any;
            ++to->first[first];
            to->right += is_present(&record[k], first);
            to->shifted += record[k].has_shift;
            to->among_largest += record[k].has_shift && is_among_largest(&record[k], first);
        }
    }
}

/* ---- reports ---- */

static void print_share(const char *name, uint32_t part, uint32_t whole)
{
    double interval[2];
    field_clopper_pearson(part, whole, interval);
    printf("  %-28s %5.1f (%5.1f-%5.1f)\n", name, 100.0 * part / whole, 100.0 * interval[0],
           100.0 * interval[1]);
}

void field_causes_table(const field_campaign_t *campaign, const field_record_t *record,
                        uint32_t runs)
{
    counts_t n;
    char text[200];
    count(record, runs, &n);
    puts("\n  share of the runs with a cause named [%]   first    at all");
    for (int class = 0; class < AUVID_CAUSE_COUNT; ++class) {
        if (n.named[class] > 0) {
            printf("  %-40s %6.1f    %6.1f\n", names[class], 100.0 * n.first[class] / runs,
                   100.0 * n.named[class] / runs);
        }
    }
    print_share("any", n.any, runs);
    if (campaign->strength <= 0.0) {
        print_share("the first is right", n.right, runs);
        print_share("the first is wrong", n.any - n.right, runs);
    }
    if (n.shifted > 0) {
        print_share("among the three that matter", n.among_largest, n.shifted);
    }
    for (unsigned i = 0;
         auvid_causes_sentence(&record->causes, &auvid_girona500, i, text, sizeof text) == AUVID_OK;
         ++i) {
        printf("%s    %s\n", i == 0 ? "  what the first run says\n" : "", text);
    }
}

void field_causes_json(const field_campaign_t *campaign, const field_record_t *record,
                       uint32_t runs)
{
    counts_t n;
    count(record, runs, &n);
    printf(",\n  \"causes\": {\"any\": %u", (unsigned)n.any);
    if (campaign->strength <= 0.0) {
        printf(", \"right\": %u, \"wrong\": %u", (unsigned)n.right, (unsigned)(n.any - n.right));
    }
    if (n.shifted > 0) {
        printf(", \"among_largest\": %u", (unsigned)n.among_largest);
    }
    for (int class = 0; class < AUVID_CAUSE_COUNT; ++class) {
        printf(",\n    \"%s\": {\"first\": %u, \"named\": %u}", names[class],
               (unsigned)n.first[class], (unsigned)n.named[class]);
    }
    printf("}");
}

void field_causes_json_run(const field_record_t *record)
{
    char text[200];
    printf(", \"prior_scale\": %.4g, \"causes\": [", record->prior_scale);
    for (int i = 0; i < record->causes.named; ++i) {
        (void)auvid_causes_sentence(&record->causes, &auvid_girona500, (unsigned)i, text,
                                    sizeof text);
        const auvid_cause_t *cause = &record->causes.cause[record->causes.order[i]];
        printf("%s{\"class\": \"%s\", \"value\": %.9g, \"sigma\": %.9g, \"share\": %.9g, "
               "\"sentence\": \"%s\"}",
               i == 0 ? "" : ", ", names[record->causes.order[i]], (double)cause->value,
               (double)cause->sigma, (double)cause->share, text);
    }
    printf("]");
    for (int class = 0; class < AUVID_CAUSE_COUNT && record->has_shift; ++class) {
        printf("%s\"%s\": %.9g", class == 0 ? ", \"shift\": {" : ", ", names[class],
               record->shift[class]);
    }
    printf("%s", record->has_shift ? "}" : "");
}
