/**
 * @file field_table.h
 * Statistics over runs in the field (field_run.h): was what the identifier said right?
 *
 * A flag says that a parameter is identifiable. It is *wrong* when the parameter is more than 20 %
 * off and the force of that error, at the largest motion of the run, is above 2 % of tau_max. For
 * W-B the latter decides. *Beyond*: off by more than its own 95 % half-width.
 *
 * Every figure is a ratio of two sums over the runs. Intervals (95 %) are by bootstrap over the
 * runs; where a share is 0 or 1 in all of them, by Clopper-Pearson over the runs.
 */
#ifndef PROGRAM_FIELD_TABLE_H
#define PROGRAM_FIELD_TABLE_H

#include "field_run.h"

/** A flag is wrong beyond this relative error, and beyond this part of tau_max. */
#define FIELD_WRONG_RELATIVE 0.2
#define FIELD_WRONG_FORCE 0.02

/** Which parameters a figure is about: classes, then each by itself. */
enum {
    FIELD_ALL,
    FIELD_BUT_WEIGHT, /* all but W-B */
    FIELD_MASSES,
    FIELD_WEIGHT, /* W-B */
    FIELD_LINEAR,
    FIELD_QUADRATIC,
    FIELD_CLASSES,
    FIELD_GROUPS = FIELD_CLASSES + SIM_PARAMETERS
};

/** What is asked of each group. */
enum {
    FIELD_FLAGGED,       /* share of the parameters */
    FIELD_WRONG,         /* share of the flags */
    FIELD_BEYOND,        /* share of the flags */
    FIELD_OVER_SIGMA,    /* rms of error / sigma of the flagged */
    FIELD_ERROR_FLAGGED, /* rms of the relative error of the flagged; W-B: part of tau_max, and not
                            in FIELD_ALL */
    FIELD_ERROR,         /* the same of all that are estimated */
    FIELD_WITHIN_1,      /* share of the parameters with a sigma, within one of it */
    FIELD_WITHIN_2,      /* and within two */
    FIELD_TOLD_WRONG,    /* as wrong and beyond, by the told truth */
    FIELD_TOLD_BEYOND,
    FIELD_QUESTIONS
};

/** And of the drag forces at each part of the largest speeds. */
enum {
    FIELD_FORCE_OFF,     /* share of those estimated, more than 20 % off, flagged or not */
    FIELD_FORCE_FLAGGED, /* share of all directions */
    FIELD_FORCE_WRONG,   /* share of the flags */
    FIELD_FORCE_BEYOND,  /* share of the flags */
    FIELD_FORCE_WITHIN,  /* share of those with a half-width, within it, flagged or not */
    FIELD_FORCE_QUESTIONS
};

/** Half-width limits of the curve; room for notes. */
enum { FIELD_LIMITS = 6, FIELD_NOTES = 16 };
extern const double field_limit[FIELD_LIMITS];

/** Figures, one after the other: place of each kind's first. */
enum {
    FIELD_AT_FORCE = FIELD_QUESTIONS * FIELD_GROUPS,
    FIELD_AT_CURVE = FIELD_AT_FORCE + FIELD_FORCE_QUESTIONS * FIELD_PARTS,
    FIELD_AT_NOTE = FIELD_AT_CURVE + 2 * FIELD_LIMITS, /* flagged at each limit, then wrong */
    FIELD_AT_WRONG_RUN = FIELD_AT_NOTE + FIELD_NOTES,
    FIELD_AT_CAPPED_RUN,
    FIELD_FIGURES
};

/** Place of a question about a group. */
#define FIELD_AT(question, group) ((question)*FIELD_GROUPS + (group))

typedef struct {
    double part, whole;
} field_ratio_t;

typedef struct {
    double value, low, high; /**< NAN: there is none */
    double whole;            /**< of how many */
} field_figure_t;

typedef struct {
    uint32_t runs, room;
    field_ratio_t *each; /* [room][FIELD_FIGURES] */
    field_figure_t figure[FIELD_FIGURES];
} field_table_t;

/** Is parameter i wrong? @param truth record->truth.si or .told */
bool field_is_wrong(const field_record_t *record, int i, const double *truth);

/** Begin, for so many runs. False: no memory. */
bool field_table_begin(field_table_t *table, uint32_t runs);
void field_table_add(field_table_t *table, const field_record_t *record);
/** Compute table->figure; the bootstrap is seeded. False: no memory. */
bool field_table_finish(field_table_t *table, uint64_t seed);
void field_table_free(field_table_t *table);

/** 95 % interval of a probability of which k of n were seen (Clopper and Pearson 1934). */
void field_clopper_pearson(uint32_t k, uint32_t n, double interval[2]);

#endif
