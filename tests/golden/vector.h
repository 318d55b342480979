/**
 * @file vector.h
 * What golden vectors hold of an identifier. The fields that they read are named here and nowhere
 * else; the words in the files stay when a field gets another name.
 *
 * Numbers, class A: estimates and the change test. Schedule, class B: the tick of each estimate,
 * event and state of the guard; for each 5 s a hash of what every tick excited and worked.
 */
#ifndef VECTOR_H
#define VECTOR_H

#include "auvid/identifier.h"
#include "golden.h"

enum { VECTOR_TICK_US = 20000, VECTOR_TICKS = 250 };

static uint32_t vector_ticks, vector_hash;    /* of the 5 s under way */
static uint32_t vector_number, vector_events; /* of the last estimate, of the last tick */
static int vector_guard;                      /* its last state */

static inline unsigned vector_tick(uint64_t t_us)
{
    return (unsigned)(t_us / VECTOR_TICK_US);
}

/** One estimate in one line. */
static inline void vector_brief(const auvid_estimate_t *e, int parameters)
{
    size_t bytes = (size_t)parameters * sizeof e->pi[0];
    uint32_t hash = golden_hash(golden_hash(0, e->pi, bytes), e->confidence.sigma, bytes);
    golden_put("estimate %u tick %u sets %u evaluations %u %u numbers %08x", (unsigned)e->number,
               vector_tick(e->t_us), (unsigned)e->sets, (unsigned)e->evaluations_crs,
               (unsigned)e->evaluations_line, (unsigned)hash);
    golden_number("cost", (float)e->cost);
    golden_put("\n");
}

static inline void vector_parameter(const auvid_estimate_t *e, int i)
{
    const auvid_confidence_t *c = &e->confidence;
    golden_put("parameter %d", i);
    golden_number("value", (float)e->pi[i]);
    golden_number("sigma", (float)c->sigma[i]);
    golden_number("thrust_scale", (float)c->thrust_error[i]);
    golden_number("dvl_scale", (float)c->dvl_error[i]);
    golden_number("bound", (float)c->bound[i]);
    golden_put(" note %d %d identifiable %d implausible %d\n", c->note[i], c->partner[i],
               (int)(c->identifiable >> i & 1u), (int)(c->implausible >> i & 1u));
}

static inline void vector_dof(const auvid_estimate_t *e, int j)
{
    const auvid_confidence_t *c = &e->confidence;
    golden_put("dof %d lag %d lost %d", j, e->first_order_lag >> j & 1, c->lost[j]);
    golden_number("delay", (float)e->delay_s[j]);
    golden_number("r2", (float)e->r2_force[j]);
    golden_number("noise", (float)c->effective_noise[j]);
    golden_number("residual", (float)c->residual_rms[j]);
    golden_number("speed", (float)e->speed[j][0]);
    golden_number("back", (float)e->speed[j][1]);
    golden_put("\n");
}

/* How the newest set was predicted. */
static inline void vector_change_test(const auvid_change_test_t *to)
{
    golden_put("change_test set %u estimate %u excited %02x changed %02x simulated %02x\n",
               (unsigned)to->set, (unsigned)to->estimate, to->excited, to->changed, to->simulated);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!(to->excited >> j & 1)) {
            continue;
        }
        golden_put("change_test dof %d", j);
        golden_number("variance_ratio", (float)to->variance_ratio[j]);
        golden_number("statistic", (float)to->change[j]);
        golden_number("r2_velocity", (float)to->r2_velocity[j]);
        golden_put("\n");
    }
}

/** All of the last estimate. */
static inline void vector_whole(const auvid_identifier_t *id)
{
    const auvid_estimate_t *e = &id->estimate;
    int n = id->metric.cfg.vehicle->parameters;
    size_t entries = (size_t)(n * (n + 1) / 2);
    vector_brief(e, n);
    golden_put("identified %08x accepted %d evaluation_limit %d covariance %08x\n",
               (unsigned)e->identified, e->accepted, e->not_converged,
               (unsigned)golden_hash(0, e->covariance, entries * sizeof e->covariance[0]));
    for (int i = 0; i < n; ++i) {
        vector_parameter(e, i);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (e->excited >> j & 1) {
            vector_dof(e, j);
        }
    }
    vector_change_test(&id->change_test);
}

/** Before an identifier's first tick. */
static inline void vector_restart(void)
{
    vector_ticks = vector_hash = vector_number = vector_events = 0;
    vector_guard = AUVID_GUARD_DISARMED;
}

static inline void vector_begin(uint64_t seed)
{
    vector_restart();
    golden_begin(seed);
}

/** Add what a tick did to the hash of its 5 s. */
static inline void vector_add(const void *data, size_t bytes)
{
    vector_hash = golden_hash(vector_hash, data, bytes);
}

/* A state of the guard, and why it aborted. */
static inline void vector_state(const auvid_guard_t *guard, unsigned tick)
{
    golden_put("tick %u guard %d cause %d", tick, (int)guard->state, (int)guard->trip.cause);
    golden_number("value", (float)guard->trip.value);
    golden_number("limit", (float)guard->trip.limit);
    golden_put("\n");
    vector_guard = (int)guard->state;
}

/** Look at the identifier, once in each tick. @param events of its step */
static inline void vector_look(const auvid_identifier_t *id, uint32_t events)
{
    unsigned tick = vector_tick(id->t_us);
    vector_add(&id->work.last_units, sizeof id->work.last_units);
    vector_add(&events, sizeof events);
    if (events != vector_events && events != 0) {
        golden_put("tick %u events %x\n", tick, (unsigned)events);
    }
    vector_events = events;
    if (id->actuation != NULL && (int)id->actuation->guard.state != vector_guard) {
        vector_state(&id->actuation->guard, tick);
    }
    if (id->estimate.number != vector_number) {
        vector_number = id->estimate.number;
        vector_brief(&id->estimate, id->metric.cfg.vehicle->parameters);
    }
    if (++vector_ticks % VECTOR_TICKS == 0) {
        golden_put("tick %u schedule %08x\n", tick, (unsigned)vector_hash);
        vector_hash = 0;
    }
}

/** The same behind a step: what it excites belongs to the schedule. */
static inline void vector_step(const auvid_identifier_t *id, const auvid_output_t *out)
{
    vector_add(out->excitation, sizeof out->excitation);
    const auvid_allocation_t *allocation = id->actuation->allocation;
    size_t thrusters = allocation != NULL ? allocation->cfg.thrusters : 0;
    vector_add(out->thruster_N, thrusters * sizeof out->thruster_N[0]);
    vector_look(id, out->events);
}

#endif
