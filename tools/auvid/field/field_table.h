/**
 * @file field_table.h
 * Statistics over field runs (field_run.h): how often the results of the identifier are correct.
 *
 * A flag says that a parameter is identifiable. A flag is *wrong* if the error of the parameter is
 * above 20 % and the force of that error, at the largest motion of the run, above 2 % of tau_max.
 * For W-B only the force counts. *Beyond*: the error exceeds the 95 % half-width.
 *
 * Every figure is a ratio of two sums over the runs. 95 % intervals are by bootstrap over the runs,
 * or by Clopper-Pearson over the runs where a share is 0 or 1 in all of them.
 */
#ifndef PROGRAM_FIELD_TABLE_H
#define PROGRAM_FIELD_TABLE_H

#include "field_run.h"

/** A flag is wrong above this relative error and above this fraction of tau_max. */
#define FIELD_WRONG_RELATIVE 0.2
#define FIELD_WRONG_FORCE 0.02

/** Groups of parameters: classes, then each parameter by itself. */
enum {
    FIELD_ALL,
    FIELD_BUT_WEIGHT, /* all except W-B */
    FIELD_MASSES,
    FIELD_WEIGHT, /* W-B */
    FIELD_LINEAR,
    FIELD_QUADRATIC,
    FIELD_CLASSES,
    FIELD_GROUPS = FIELD_CLASSES + SIM_PARAMETERS
};

/** Questions about each group. */
enum {
    FIELD_FLAGGED,       /* share of the parameters */
    FIELD_WRONG,         /* share of the flags */
    FIELD_BEYOND,        /* share of the flags */
    FIELD_OVER_SIGMA,    /* rms of error / sigma of the flagged */
    FIELD_ERROR_FLAGGED, /* rms of the relative error of the flagged; W-B: fraction of tau_max, not
                            in FIELD_ALL */
    FIELD_ERROR,         /* the same of all estimated parameters */
    FIELD_WITHIN_1,      /* share of the parameters with a sigma, within one sigma */
    FIELD_WITHIN_2,      /* within two sigma */
    FIELD_TOLD_WRONG,    /* as wrong and beyond, by the truth in reported newtons */
    FIELD_TOLD_BEYOND,
    FIELD_QUESTIONS
};

/** Questions about the drag forces at each fraction of the largest speeds. */
enum {
    FIELD_FORCE_OFF,     /* share of all estimated, flagged or not, with an error above 20 % */
    FIELD_FORCE_FLAGGED, /* share of all directions */
    FIELD_FORCE_WRONG,   /* share of the flags */
    FIELD_FORCE_BEYOND,  /* share of the flags */
    FIELD_FORCE_WITHIN,  /* share of those with a half-width, within it, flagged or not */
    FIELD_FORCE_QUESTIONS
};

/** Number of half-width limits of the curve; largest number of notes. */
enum { FIELD_LIMITS = 6, FIELD_NOTES = 16 };
extern const double field_limit[FIELD_LIMITS];

/** Index of the first figure of each kind. */
enum {
    FIELD_AT_FORCE = FIELD_QUESTIONS * FIELD_GROUPS,
    FIELD_AT_ONE_WAY = FIELD_AT_FORCE + FIELD_FORCE_QUESTIONS * FIELD_PARTS, /* one direction */
    FIELD_AT_CURVE = FIELD_AT_ONE_WAY + FIELD_FORCE_QUESTIONS * FIELD_PARTS,
    FIELD_AT_NOTE = FIELD_AT_CURVE + 2 * FIELD_LIMITS, /* after flagged at each limit, then wrong */
    FIELD_AT_WRONG_RUN = FIELD_AT_NOTE + FIELD_NOTES,
    FIELD_AT_CAPPED_RUN,
    FIELD_FIGURES
};

/** Index of a question about a group. */
#define FIELD_AT(question, group) ((question)*FIELD_GROUPS + (group))

typedef struct {
    double part, whole;
} field_ratio_t;

typedef struct {
    double value, low, high; /**< NAN: none */
    double whole;            /**< size of the whole */
} field_figure_t;

typedef struct {
    uint32_t runs, room;
    field_ratio_t *each; /* [room][FIELD_FIGURES] */
    field_figure_t figure[FIELD_FIGURES];
} field_table_t;

/** Is the flag of parameter i wrong? @param truth record->truth.si or .reported */
bool field_is_wrong(const field_record_t *record, int i, const double *truth);

/** Starts a table of so many runs. Returns false if there is no memory. */
bool field_table_begin(field_table_t *table, uint32_t runs);
void field_table_add(field_table_t *table, const field_record_t *record);
/** Computes table->figure with a seeded bootstrap. Returns false if there is no memory. */
bool field_table_finish(field_table_t *table, uint64_t seed);
void field_table_free(field_table_t *table);

/** 95 % interval of a probability from k of n cases (Clopper and Pearson 1934). */
void field_clopper_pearson(uint32_t k, uint32_t n, double interval[2]);

#endif
