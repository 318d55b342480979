/*
 * Prints the members of the four configurations that a vehicle file sets, with their bits: for
 * test_vehicle_file.sh.
 */
#include <stdio.h>
#include <string.h>

#include "auvid/auvid.h"

static void real(const char *name, int i, auvid_real_t x)
{
    unsigned char byte[sizeof x];
    memcpy(byte, &x, sizeof x);
    printf("%s[%d] %.6g ", name, i, (double)x);
    for (size_t k = sizeof x; k-- > 0;) {
        printf("%02x", byte[k]);
    }
    printf("\n");
}

static void reals(const char *name, const auvid_real_t *x, int n)
{
    for (int i = 0; i < n; ++i) {
        real(name, i, x[i]);
    }
}

static void print_identifier(const auvid_identifier_config_t *c)
{
    const auvid_vehicle_t *v = c->vehicle;
    printf("parameters %d, free %lx\n", v->parameters, (unsigned long)v->free);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        printf("columns %lx, reads %x\n", (unsigned long)v->columns[j], v->reads[j]);
    }
    for (int i = 0; i < v->parameters; ++i) {
        const auvid_parameter_t *p = &v->parameter[i];
        printf("%s %s %d %d\n", p->name, p->unit, (int)p->dof, (int)p->kind);
    }
    reals("imu_euler", c->nav.mount.imu_euler, 3);
    reals("dvl_euler", c->nav.mount.dvl_euler, 3);
    reals("dvl_lever", c->nav.mount.dvl_lever, 3);
    reals("tau_max", c->metric.tau_max, AUVID_DOF_COUNT);
    real("thrust_scale", 0, c->uncertainty.thrust_scale);
    real("dvl_scale", 0, c->uncertainty.dvl_scale);
    real("delay_s", 0, c->uncertainty.delay_s);
    real("dry_mass_kg", 0, c->dry_mass_kg);
    reals("lower", c->search.lower, AUVID_MAX_PARAMETERS);
    reals("upper", c->search.upper, AUVID_MAX_PARAMETERS);
    printf("cells %lu %lu, half widths %d %d\n", (unsigned long)c->recorder.cell_us,
           (unsigned long)c->metric.max_cell_us, c->metric.half_width[0], c->metric.half_width[1]);
}

static void print_allocation(const auvid_allocation_config_t *c)
{
    printf("thrusters %d, dofs %x, priority %x\n", c->thrusters, c->dofs, c->priority);
    for (int i = 0; i < c->thrusters; ++i) {
        const auvid_thruster_t *t = &c->thruster[i];
        reals("wrench", t->wrench, AUVID_DOF_COUNT);
        real("min_N", i, t->min_N);
        real("max_N", i, t->max_N);
        real("gain_forward", i, t->gain_forward);
        real("gain_backward", i, t->gain_backward);
        printf("law %d\n", (int)t->law);
    }
}

static void print_uncertain(const auvid_uncertain_config_t *c)
{
    const auvid_real_t all[] = {c->backward,   c->dead_band,  c->curve,       c->inflow,
                                c->sag,        c->gain,       c->lag_s,       c->delay_s,
                                c->current,    c->asymmetry,  c->cross,       c->force,
                                c->arm_m,      c->dvl_late_s, c->gravity_m,   c->nominal_lag_s,
                                c->cross_flow, c->mount_rad,  c->response_s2, c->filter_s};
    reals("uncertain", all, (int)(sizeof all / sizeof all[0]));
    printf("fractions %d\n", c->fractions);
}

static void print_actuation(const auvid_actuation_config_t *c)
{
    const auvid_guard_config_t *g = &c->guard;
    const auvid_real_t limits[] = {
        g->depth_min_m, g->depth_max_m,  g->altitude_min_m, g->roll_max_rad, g->pitch_max_rad,
        g->speed_max,   g->yaw_rate_max, g->distance_max_m, g->rest_speed,   g->rest_rate};
    const uint32_t times[] = {g->run_max_s,
                              g->imu_stale_us,
                              g->velocity_stale_us,
                              g->depth_stale_us,
                              g->altitude_stale_us,
                              g->applied_stale_us,
                              g->saturation_us,
                              g->max_tick_us,
                              g->heartbeat_timeout_us,
                              g->rest_dwell_us,
                              g->settle_timeout_us,
                              g->repeat_us,
                              g->off};
    reals("guard", limits, (int)(sizeof limits / sizeof limits[0]));
    for (size_t i = 0; i < sizeof times / sizeof times[0]; ++i) {
        printf("guard %lu\n", (unsigned long)times[i]);
    }
    printf("guard %d %d %d\n", g->altitude_required, g->surface, g->water_lock);
    printf("segments %d, seed %lu\n", c->excitation.segments, (unsigned long)c->excitation.seed);
    for (int i = 0; i < c->excitation.segments; ++i) {
        const auvid_segment_t *s = &c->excitation.segment[i];
        const auvid_real_t all[] = {s->pause_s,    s->duration_s,   s->amplitude,         s->from,
                                    s->fade_s,     s->frequency_hz, s->frequency_high_hz, s->phase,
                                    s->hold_min_s, s->hold_max_s};
        printf("segment %d %d %d %d\n", (int)s->dof, (int)s->kind, s->sines, s->pairs);
        reals("segment", all, (int)(sizeof all / sizeof all[0]));
    }
    reals("excursion", c->excitation.excursion_limit, AUVID_DOF_COUNT);
    real("duration", 0, c->excitation.duration_s);
}
