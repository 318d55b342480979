/**
 * @file field_report.h
 * Statistics of runs in the field as tables for people, or as one JSON object.
 */
#ifndef PROGRAM_FIELD_REPORT_H
#define PROGRAM_FIELD_REPORT_H

#include "field_table.h"

/** What was run. */
typedef struct {
    const char *vehicle, *driver;
    const char *world; /**< for people: "mixture of strength 1, perfect thrust" */
    double strength;   /**< of the mixture; negative: none */
    bool matched, perfect_thrust;
    auvid_uncertainty_t uncertainty; /**< that the identifier was told */
    uint64_t seed;
    double wall_s;
} field_campaign_t;

/** The kinds of mismatch. */
void field_report_mismatches(void);

void field_report_tables(const field_campaign_t *campaign, const field_table_t *table,
                         const field_record_t *record);

/** All figures, and every run: its sizes, its truth, its estimate.
 * @param record [table->runs] */
void field_report_json(const field_campaign_t *campaign, const field_table_t *table,
                       const field_record_t *record);

#endif
