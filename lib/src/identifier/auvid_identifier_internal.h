/**
 * @file auvid_identifier_internal.h
 * Private: declarations shared by the files of the identifier.
 */
#ifndef AUVID_IDENTIFIER_INTERNAL_H
#define AUVID_IDENTIFIER_INTERNAL_H

#include "auvid/allocation.h"
#include "auvid/identifier.h"
#include "../metric/auvid_metric_internal.h"

/** Set each scale of the wrench that the configuration leaves to auvid to what the thrusters give
 * (metric_config.h). Only before the first wrench is recorded. */
void auvid_identifier_set_scale(auvid_identifier_t *id, const auvid_allocation_t *allocation);

/** Units that the start of a search costs. */
enum { SEARCH_START_COST = 25 };

/** How often the steps of Gauss-Newton continue from a better point, in one search. */
enum { WORK_CONTINUATIONS = 3 };

/** How many searches of neighbouring minima may follow one search. */
enum { WORK_NEIGHBOURS = 6 };

/** Values of work.spent. */
enum {
    WORK_OPTIMUM = 1, /* the start of the search is being found */
    WORK_START,
    WORK_LAST_SPENT = WORK_START + SEARCH_START_COST - 1
};

/** The model; NULL before init. */
static inline const auvid_vehicle_t *identifier_vehicle(const auvid_identifier_t *id)
{
    return id->metric.cfg.vehicle;
}

/** Who is told of commands and sets; NULL: nobody. */
static inline const auvid_listener_t *identifier_listener(const auvid_identifier_t *id)
{
    return AUVID_MAX_COMMANDS > 0 ? id->attached.listener : NULL;
}

/** Move what `search` says of the parameters in `active` to the front: bounds and good values. Sets
 * n; of[] receives their numbers in the model. */
void auvid_identifier_select(auvid_search_config_t *search, uint32_t active, uint8_t *of);

/** Has init succeeded? The functions must not run on an uninitialised identifier. */
static inline bool identifier_is_ready(const auvid_identifier_t *id)
{
    return identifier_vehicle(id) != NULL;
}

/** The estimate that the user reads; all zeros: there is none yet. */
static inline const auvid_estimate_t *identifier_read_estimate(const auvid_identifier_t *id)
{
    const auvid_estimate_t *e = auvid_identifier_estimate(id);
    return e != NULL ? e : &id->estimate;
}

/** Set the events for a status of the metric that concerns a set. */
static inline void identifier_take_set(auvid_identifier_t *id, auvid_status_t status)
{
    if (status == AUVID_SET_COMPLETE) {
        id->work.set_pending = true;
        id->events |= AUVID_EVENT_SET;
    } else if (status == AUVID_SET_IDLE) {
        id->events |= AUVID_EVENT_SET | AUVID_EVENT_NOT_EXCITED;
    }
}

/** A phase of the work. */
typedef struct {
    /** Continues it; one of the two is NULL. @return AUVID_OK: it is complete; AUVID_PENDING; < 0:
     * the work ends */
    auvid_status_t (*metric)(auvid_metric_t *metric, uint32_t *budget);
    auvid_status_t (*run)(auvid_identifier_t *id, uint32_t *budget);
    void (*next)(auvid_identifier_t *id);    /**< it is complete: begins what follows */
    void (*restart)(auvid_identifier_t *id); /**< a set has replaced the oldest; NULL: as before */
} auvid_work_phase_row_t;

/** What the identifier calls of the change test, if it is attached. */
typedef struct auvid_change_functions {
    /** Begins to test the oldest set not yet tested. @return false: there is none */
    bool (*begin)(auvid_identifier_t *id);
    auvid_work_phase_row_t phases[AUVID_WORK_CHANGE_TEST - AUVID_WORK_PREPARE + 1];
} auvid_change_functions_t;

/** What the identifier calls of the uncertain inputs, if they are attached. */
typedef struct auvid_uncertain_functions {
    /** Adds the last cell to the rows, if it waits. @return false: the next one may come */
    bool (*add_cell)(auvid_identifier_t *id);
    /** No cell is complete: there is time for rows that wait. */
    void (*rotate)(auvid_identifier_t *id);
    /** After a search without them. @return true: a solution with them has begun; false: there are
     * too few rows, or it is complete, and only the sets were measured again */
    bool (*begin)(auvid_identifier_t *id);
    /** Continues it. @return AUVID_OK: it is complete; AUVID_PENDING */
    auvid_status_t (*solve)(auvid_identifier_t *id, uint32_t *budget);
    /** The estimate without them is published: publishes the one with them, if they are solved. */
    void (*publish)(auvid_identifier_t *id);
    /** Returns the estimate with uncertain inputs; NULL: there is none. */
    const auvid_estimate_t *(*estimate)(const auvid_identifier_t *id);
    /** The change test accepts the estimate without them. */
    void (*accept)(auvid_identifier_t *id);
    /** The vehicle has changed: discards the rows and the estimate. */
    void (*change_vehicle)(auvid_identifier_t *id);
    /** Returns the share of the thrust that is lost from set to set; 0: none is certain. */
    auvid_real_t (*sag)(const auvid_identifier_t *id);
    /** Drag force of the estimate at a speed; see auvid_causes_drag. */
    auvid_status_t (*drag)(const auvid_identifier_t *id, auvid_dof_t dof, auvid_real_t speed,
                           auvid_drag_t *drag);
} auvid_uncertain_functions_t;

static inline void identifier_accept_uncertain(auvid_identifier_t *id)
{
    if (id->attached.uncertain_functions != NULL) {
        id->attached.uncertain_functions->accept(id);
    }
}

static inline void identifier_discard_uncertain(auvid_identifier_t *id)
{
    if (id->attached.uncertain_functions != NULL) {
        id->attached.uncertain_functions->change_vehicle(id);
    }
}

/** A linear combination of parameters, sum of a_i pi_i. */
typedef struct {
    uint8_t terms, index[AUVID_MAX_PARAMETERS]; /* of parameters with a standard error */
    auvid_real_t a[AUVID_MAX_PARAMETERS];
    auvid_real_t value;
    auvid_real_t variance;    /* if thrust and DVL scale are exact */
    auvid_real_t thrust, dvl; /* change by one standard deviation of each scale */
    bool known;               /* the variance is; true without terms */
} auvid_combination_t;

/** Add a pi_i. A fixed parameter is exact. */
void auvid_identifier_add_term(auvid_combination_t *sum, const auvid_estimate_t *estimate,
                               const auvid_vehicle_t *vehicle, int i, auvid_real_t a);

/** Drag force of the estimate that the user reads, with uncertain inputs in one direction. */
static inline auvid_status_t identifier_drag(const auvid_identifier_t *id, auvid_dof_t dof,
                                             auvid_real_t speed, auvid_drag_t *drag)
{
    const auvid_uncertain_functions_t *uncertain = id->attached.uncertain_functions;
    return uncertain != NULL
               ? uncertain->drag(id, dof, speed, drag)
               : auvid_estimate_drag(&id->estimate, id->metric.cfg.vehicle, dof, speed, drag);
}

/** Compare the last estimate, which is accepted, with the first one. Writes change_test. */
void auvid_identifier_test_drift(auvid_identifier_t *id);

/** The vehicle has changed: the next accepted estimate is the first. */
void auvid_identifier_restart_drift(auvid_identifier_t *id);

/** Test the last estimate with the oldest set not yet tested; if there is none, merge. */
void auvid_identifier_begin_tests(auvid_identifier_t *id);

/** May something be attached now? `attached`: what is, NULL if nothing is. @return AUVID_OK;
 * AUVID_ERR_STATE; AUVID_ERR_ATTACHED; AUVID_ERR_STARTED */
auvid_status_t auvid_identifier_check_attach(const auvid_identifier_t *id, const void *attached);

/** How a path finds the point at which a search starts, and what the search has to confirm. */
struct auvid_path_start {
    /** The sets are merged, and work.active is known: begins it. After a refutation it begins at
     * work.candidate and work.delay_s. */
    void (*begin)(auvid_identifier_t *id);
    /** Continues it.
     * @return AUVID_OK: the point is in work.candidate and work.delay_s, its cost in work.minimum;
     * AUVID_COST_FAILED: there is none; AUVID_PENDING */
    auvid_status_t (*run)(auvid_identifier_t *id, uint32_t *budget);
    /** Writes the scale of each parameter, then that of the delay; 0: not known. */
    void (*scale)(const auvid_identifier_t *id, auvid_real_t *scale);
    /** A search has ended: lets that of a neighbouring minimum begin (MERGE, with work.searching
     * and the optimizer as they are). work.not_converged is that of the best end. NULL: never.
     * @return false: there is none; the best end is in work.candidate, work.delay_s, work.cost */
    bool (*next_neighbour)(auvid_identifier_t *id, bool converged);
    /** Begins it: the optimizer still holds the last one. @return as auvid_optimizer_init */
    auvid_status_t (*begin_neighbour)(auvid_identifier_t *id);
};

/** Neighbouring minima of a model with kinks (auvid_identifier_neighbour.c): see above. */
bool auvid_identifier_next_neighbour(auvid_identifier_t *id, bool converged);
auvid_status_t auvid_identifier_begin_neighbour(auvid_identifier_t *id);

/** Is the delay one of the parameters of the search? Then it is the last one. */
static inline bool identifier_searches_delay(const auvid_identifier_t *id)
{
    return auvid_metric_stores_rows(&id->metric) && id->metric.cfg.estimate_delay;
}

/** Is the minimum a certificate, or only a good point? Steps of Gauss-Newton may end at a kink. */
static inline bool identifier_certifies(const auvid_identifier_t *id)
{
    return !auvid_metric_stores_rows(&id->metric) || identifier_vehicle(id)->smooth;
}

/** Write all parameters of the model to work.candidate, those of the search from theta; the others
 * have their fixed value. The same for work.delay_s.
 * @param n number of values in theta */
void auvid_identifier_expand(auvid_identifier_t *id, const auvid_real_t *theta, int n);

/** Regressor path: begin to find the minimum cost of the parameters in work.active within the
 * bounds, from pi. This overwrites the optimizer, and sets work.parameter_of. */
void auvid_identifier_begin_optimum(auvid_identifier_t *id, const auvid_real_t *pi);

/** Spend a unit on a row or a step of a minimum of n parameters, which cost n (n + 24) / 40.
 * @return is it paid? */
bool auvid_identifier_pays(auvid_bounded_ls_t *ls);

/** Continue the work begun by auvid_identifier_begin_optimum.
 * @return AUVID_OK: it is in work.candidate and work.minimum; AUVID_PENDING */
auvid_status_t auvid_identifier_optimum(auvid_identifier_t *id, uint32_t *budget);

/** A minimum, and the largest excess of a result's cost: 1e-3 of it and of a constant cost. For
 * data without noise that is almost zero: then 1e-8 of the cost of all-zero parameters. A cost that
 * is no number of a search is no minimum (AUVID_COST_FAILED). */
auvid_minimum_t auvid_identifier_minimum(auvid_real_t cost, auvid_real_t constant,
                                         auvid_real_t zero);

/** Returns the minimum found in id->optimum, and writes its parameters to pi, by their number in
 * the model. `constant`: further cost. */
auvid_minimum_t auvid_identifier_take_optimum(auvid_identifier_t *id, auvid_real_t constant,
                                              auvid_real_t *pi);

/** Entries of the scale of a search: each parameter of the model, and the delay. */
enum { SCALES = AUVID_MAX_PARAMETERS + 1 };

/** Begin a search of the parameters in work.active. This sets work.parameter_of. On the residual
 * path, a search with a known point and a minimum consists of the local phase.
 * @param scale [SCALES] units of the steps, by the parameters' number in the model; overwritten
 * @param last a known point; NULL: none
 * @param minimum of the cost, at pi; NULL: not known
 * @param delay_s of this minimum or, if it is not known, of `last` */
auvid_status_t auvid_identifier_begin_search(auvid_identifier_t *id, auvid_real_t *scale,
                                             const auvid_real_t *last,
                                             const auvid_minimum_t *minimum, const auvid_real_t *pi,
                                             auvid_real_t delay_s);

/** What the identifier calls of the simulation of velocity, if something is attached. */
typedef struct auvid_simulate_functions {
    void (*cell)(auvid_identifier_t *id, const auvid_sample_t *cell); /**< NULL: a gap */
    bool (*advance)(auvid_identifier_t *id); /**< the cell that waits. @return false: none does */
    void (*restart)(
        auvid_identifier_t *id);            /**< simulate subsequent cells with the last estimate */
    void (*finish)(auvid_identifier_t *id); /**< a set is complete: publish, then restart */
} auvid_simulate_functions_t;

/** Simulate subsequent cells with the last estimate. */
static inline void identifier_simulate(auvid_identifier_t *id)
{
    if (id->attached.simulate != NULL) {
        id->attached.simulate->restart(id);
    }
}

/** Begin the search of the merged sets: its start is found. */
auvid_status_t auvid_identifier_begin_sets_search(auvid_identifier_t *id);

/** The optimizer's search is over: take its best point, the cost and the work. */
void auvid_identifier_end_search(auvid_identifier_t *id);

/** A cost is known. If the line search has found a better point than the one that it had to
 * confirm, continue the steps of Gauss-Newton there or, if that has not helped, search. */
void auvid_identifier_check_start(auvid_identifier_t *id);

/** Returns the point from which a search starts: after a refutation the better point, else the last
 * estimate; NULL: none is known. Its delay is written only if it is known. */
const auvid_real_t *auvid_identifier_known_point(const auvid_identifier_t *id,
                                                 auvid_real_t *delay_s);

/** Delay of an estimate on the residual path, where it is common to all excited DoF [s]. */
auvid_real_t auvid_identifier_common_delay(const auvid_estimate_t *estimate);

#endif
