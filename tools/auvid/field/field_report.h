/**
 * @file field_report.h
 * Field statistics as tables for people, or as one JSON object.
 */
#ifndef PROGRAM_FIELD_REPORT_H
#define PROGRAM_FIELD_REPORT_H

#include "field_table.h"

/** The campaign. */
typedef struct {
    const char *vehicle, *driver;
    bool drawn;        /**< another vehicle in each run, FIELD_ANY with the run's seed */
    const char *world; /**< in words: "mixture of strength 1, perfect thrust" */
    double strength;   /**< strength of the mixture; negative: none */
    bool matched, perfect_thrust;
    auvid_uncertainty_t uncertainty; /**< given to the identifier */
    uint64_t seed;
    double wall_s;
} field_campaign_t;

/** Prints the kinds of mismatch. */
void field_report_mismatches(void);

void field_report_tables(const field_campaign_t *campaign, const field_table_t *table,
                         const field_record_t *record);

/** Prints all figures, and for every run its sizes, its truth and its estimate.
 * @param record [table->runs] */
void field_report_json(const field_campaign_t *campaign, const field_table_t *table,
                       const field_record_t *record);

#endif
