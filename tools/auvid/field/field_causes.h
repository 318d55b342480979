/**
 * @file field_causes.h
 * How often do the causes named by the identifier (auvid_uncertain_causes) match the mismatches?
 *
 * The first named cause of a run is *right* if a mismatch of its class is present. In mixtures most
 * classes are present. There the question is whether it is among the three classes that, each by
 * itself, shift the estimate without uncertain inputs most.
 */
#ifndef PROGRAM_FIELD_CAUSES_H
#define PROGRAM_FIELD_CAUSES_H

#include "field_report.h"

/** Writes record->shift: for each class the rms relative shift of masses and of drag forces at 0.6
 * of the largest speed, if only the mismatches of that class are added to those of no class. One
 * run for each class. Returns false if the configuration is refused. */
bool field_causes_shift(field_run_t *run, const field_run_config_t *config, field_record_t *record);

/** Print how often each class is named, and how often rightly. @param record [runs] */
void field_causes_table(const field_campaign_t *campaign, const field_record_t *record,
                        uint32_t runs);

/** The same as members of a JSON object; those of one run. */
void field_causes_json(const field_campaign_t *campaign, const field_record_t *record,
                       uint32_t runs);
void field_causes_json_run(const field_record_t *record);

#endif
