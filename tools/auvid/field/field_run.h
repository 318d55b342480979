/**
 * @file field_run.h
 * One run of a field vehicle (field.h) with an identifier: its results, and the correct ones.
 *
 * The identifier is fed directly, without frames. Its model is the Girona500 (Eq. 12-15) for all
 * vehicles, with averaged rows for fast ones (field_sheet_t). Excited runs play the plan of the
 * demo, with the limits of the guard off. In the other runs the identifier only records, for the
 * length in field_config_t.
 */
#ifndef PROGRAM_FIELD_RUN_H
#define PROGRAM_FIELD_RUN_H

#include "auvid/vehicle.h"
#include "auvid/actuation.h"
#include "auvid/uncertain.h"
#include "field_projection.h"

/** Drag forces with known truth, at fractions of the largest speed in each direction. */
enum { FIELD_PARTS = 3, FIELD_DIRECTIONS = 2 * FIELD_EQUATIONS };
extern const double field_part[FIELD_PARTS];

typedef struct {
    field_config_t field;
    /** Uncertainties of the identifier (auvid_uncertainty_t). Negative: the library's default. */
    double thrust_scale, dvl_scale, delay_s;
    bool uncertain; /**< with uncertain inputs (uncertain.h) */
    bool reference; /**< with the reference of the driver (uncertain.h); without uncertain
                         inputs these are exact */
    const auvid_vehicle_t *model; /**< NULL: as above; else the first parameters are Girona500's */
    /** With a model: completes its configuration; attaches what it needs. NULL: nothing. Returns
     * false if the library refuses it. */
    bool (*configure)(auvid_identifier_config_t *cfg);
    bool (*attach)(auvid_identifier_t *id);
    uint32_t sets; /**< excited: number of sets of 30 s; the plan is repeated as needed */
    /** Who drives for 600 s after the excitation; FIELD_EXCITED: the run ends with it. */
    field_driver_t then;
    uint32_t budget; /**< work units per tick */
} field_run_config_t;

/** A drag force at the fraction field_part of the largest speed of an equation and direction. */
typedef struct {
    double value; /**< estimated [N, Nm] */
    double half;  /**< its 95 % half-width; infinite: unknown */
    bool estimated, flagged;
} field_force_t;

/** The results of a run. */
typedef struct {
    uint64_t seed;
    double size[FIELD_MISMATCHES]; /**< sizes of the mismatches */
    double tau_max[FIELD_EQUATIONS];
    bool not_converged; /**< the search has not converged */
    uint32_t sets;      /**< recorded */
    uint32_t changed;   /**< alarms of the change test: AUVID_EVENT_CHANGED */
    uint32_t drifted;   /**< AUVID_EVENT_DRIFTED */
    double drifted_s;   /**< time of the first of these [s]; 0: none */
    double simulated_s;
    bool estimated[SIM_PARAMETERS];  /**< free, and its DoF sufficiently excited */
    bool flagged[SIM_PARAMETERS];    /**< identifiable */
    bool impossible[SIM_PARAMETERS]; /**< impossible value, which discredits its equation */
    uint8_t note[SIM_PARAMETERS];    /**< auvid_note_t */
    double pi[SIM_PARAMETERS];
    double sigma[SIM_PARAMETERS]; /**< infinite: unknown */
    double delay_s[FIELD_EQUATIONS];
    field_force_t force[FIELD_PARTS][FIELD_DIRECTIONS];   /**< direction 2 e: forward of equation e;
                                                             of one curve for both directions */
    field_force_t one_way[FIELD_PARTS][FIELD_DIRECTIONS]; /**< with the asymmetry */
    field_reference_t truth;
    double prior_scale;              /**< found scale of the priors of the uncertain inputs */
    auvid_causes_t causes;           /**< what is wrong with the inputs; all 0: not known */
    bool has_shift;                  /**< see field_causes.h */
    double shift[AUVID_CAUSE_COUNT]; /**< likewise */
} field_record_t;

/** Memory of a run. */
typedef struct {
    field_t field;
    auvid_averaged_t averaged;
    auvid_identifier_t id;
    auvid_change_detector_t change;
    auvid_allocation_t allocation;
    auvid_actuation_t actuation;
    auvid_uncertain_t uncertain;
    auvid_instruments_t instruments;
    field_projection_t projection;
} field_run_t;

/** Writes the defaults: field as configured, 8 sets, uncertainties and budget of the library. */
void field_run_defaults(field_run_config_t *config);

/** Writes the identifier configuration of a run.
 * @param averaged written for a fast vehicle; must outlive the identifier */
void field_run_identifier(const field_run_config_t *config, auvid_averaged_t *averaged,
                          auvid_identifier_config_t *cfg);

/** Writes the excitation of a run, with all limits of the guard off. */
void field_run_actuation(const field_run_config_t *config, auvid_actuation_config_t *cfg);

/** Does a run. Returns false if the simulator or the library refuses the configuration. */
bool field_run(field_run_t *run, const field_run_config_t *config, field_record_t *record);

#endif
