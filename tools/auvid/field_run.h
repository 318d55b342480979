/**
 * @file field_run.h
 * One run of a vehicle in the field (field.h) with an identifier aboard: what it said, and what
 * would have been right.
 *
 * The identifier is fed directly, without frames: its model is the Girona500's (Eq. 12-15) for
 * both vehicles, with averaged rows for the ROV of 20 kg. Excited runs play the demo's plan, with
 * the guard's limits off; the others record, while somebody else drives.
 */
#ifndef PROGRAM_FIELD_RUN_H
#define PROGRAM_FIELD_RUN_H

#include "auvid/averaged.h"
#include "auvid/identifier.h"
#include "field_projection.h"

/** Length of a passive run [s]. */
#define FIELD_PASSIVE_S 600.0

/** Drag forces whose truth is known: parts of the largest speed in each direction. */
enum { FIELD_PARTS = 3, FIELD_DIRECTIONS = 2 * FIELD_EQUATIONS };
extern const double field_part[FIELD_PARTS];

typedef struct {
    field_config_t field;
    /** Of the identifier: auvid_uncertainty_t. Negative: the library's default. */
    double thrust_scale, dvl_scale, delay_s;
    uint32_t sets;   /**< excited: of 30 s */
    uint32_t budget; /**< of work in a tick [units] */
} field_run_config_t;

/** A drag force: at field_part of the largest speed forward and backward of each equation. */
typedef struct {
    double value; /**< estimated [N, Nm] */
    double half;  /**< its 95 % half-width; infinite: not known */
    bool estimated, flagged;
} field_force_t;

/** What a run gave. */
typedef struct {
    uint64_t seed;
    double size[FIELD_MISMATCHES]; /**< of the mismatches */
    double tau_max[FIELD_EQUATIONS];
    bool not_converged; /**< the search has not converged */
    uint32_t sets;      /**< recorded */
    double simulated_s;
    bool estimated[SIM_PARAMETERS];  /**< free, and its DoF excited enough */
    bool flagged[SIM_PARAMETERS];    /**< identifiable */
    bool impossible[SIM_PARAMETERS]; /**< its equation is discredited for it */
    uint8_t note[SIM_PARAMETERS];    /**< auvid_note_t */
    double pi[SIM_PARAMETERS];
    double sigma[SIM_PARAMETERS]; /**< infinite: not known */
    double delay_s[FIELD_EQUATIONS];
    field_force_t force[FIELD_PARTS][FIELD_DIRECTIONS]; /**< direction 2 e: forward */
    field_reference_t truth;
} field_record_t;

/** Memory of a run. */
typedef struct {
    field_t field;
    auvid_averaged_t averaged;
    auvid_identifier_t id;
    field_projection_t projection;
} field_run_t;

/** The defaults: field as configured, 8 sets, the library's uncertainties and budget. */
void field_run_defaults(field_run_config_t *config);

/** What the identifier of a run is configured like.
 * @param averaged written for the ROV; must outlive the identifier */
void field_run_identifier(const field_run_config_t *config, auvid_averaged_t *averaged,
                          auvid_identifier_config_t *cfg);

/** Do a run. False: the simulator or the library refuses the configuration. */
bool field_run(field_run_t *run, const field_run_config_t *config, field_record_t *record);

#endif
