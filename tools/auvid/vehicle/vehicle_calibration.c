#include "vehicle_calibration.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "vehicle_keys.h"

static bool is_zero(const auvid_known_force_t *f)
{
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        sum += fabs((double)f->world[i]) + fabs((double)f->body[i]);
    }
    return sum <= 0.0;
}

/* In a log each force begins when the one before has ended: the library has one at a time. */
static bool check(ini_t *ini, const char *section, const vehicle_t *v, int i)
{
    const vehicle_calibration_t *c = &v->calibration[i];
    if (is_zero(&c->force)) {
        return ini_refuse(ini, ini_line(ini, section), 1,
                          "[%s] has no force: add weight_N, pull_N or pull_north_east_N", section);
    }
    if (!(c->to_s > c->from_s)) {
        return ini_refuse_key(ini, section, "to_s", "must be later than from_s");
    }
    for (int k = 0; k < i; ++k) {
        const vehicle_calibration_t *above = &v->calibration[k];
        if (strcmp(c->log, above->log) == 0 && c->from_s < above->to_s) {
            return ini_refuse_key(ini, section, "from_s",
                                  "must not be before the calibration above has ended");
        }
    }
    return true;
}

bool vehicle_calibrations_read(ini_t *ini, vehicle_t *v)
{
    for (int i = 0; i < VEHICLE_CALIBRATIONS; ++i) {
        char section[VEHICLE_WORD];
        (void)snprintf(section, sizeof section, "calibration.%d", i + 1);
        if (ini_find(ini, section, "") == NULL) {
            continue;
        }
        if (i != v->calibrations) {
            return ini_refuse(ini, ini_line(ini, section), 1, "[%s]: there is no [calibration.%d]",
                              section, i);
        }
        vehicle_calibration_t *c = &v->calibration[v->calibrations++];
        c->to_s = VEHICLE_TIME_S;
        c->number = v->calibrations;
        if (!vehicle_keys_section(ini, section, KEYS_CALIBRATION, c) ||
            !check(ini, section, v, i)) {
            return false;
        }
    }
    return true;
}

int vehicle_calibrations_of(const vehicle_t *v, const char *path, bool first,
                            vehicle_calibration_t to[VEHICLE_CALIBRATIONS])
{
    const char *slash = path != NULL ? strrchr(path, '/') : NULL;
    const char *name = slash != NULL ? slash + 1 : path;
    int count = 0;
    for (int i = 0; i < v->calibrations; ++i) {
        const vehicle_calibration_t *c = &v->calibration[i];
        if (c->log[0] == '\0' ? first : name != NULL && strcmp(c->log, name) == 0) {
            to[count++] = *c;
        }
    }
    return count;
}

bool vehicle_calibrations_miss(const vehicle_calibration_t *calibration, int count, double first_s,
                               double last_s, char *text, size_t size)
{
    for (int i = 0; i < count; ++i) {
        const vehicle_calibration_t *c = &calibration[i];
        if (c->from_s > last_s || c->to_s <= first_s) {
            (void)snprintf(
                text, size,
                "[calibration.%d] of the vehicle file is from %.12g to %.12g s, this log "
                "from %.12g to %.12g s: correct its times, or name its log: log = FILE",
                c->number, c->from_s, c->to_s, first_s, last_s);
            return true;
        }
    }
    return false;
}

auvid_known_force_t vehicle_known_force(const vehicle_calibration_t *calibration, int count,
                                        double t_s)
{
    for (int i = 0; i < count; ++i) {
        if (t_s >= calibration[i].from_s && t_s < calibration[i].to_s) {
            return calibration[i].force;
        }
    }
    return (auvid_known_force_t){0};
}

auvid_known_force_t vehicle_load(const vehicle_calibration_t *calibration, int count,
                                 vehicle_sim_t *vehicle_sim)
{
    sim_config_t *sim = &vehicle_sim->sim.cfg;
    auvid_known_force_t force =
        vehicle_known_force(calibration, count, 1e-6 * (double)vehicle_sim->seen.t_us);
    force.mass_kg = AUVID_C(0.0);
    for (int i = 0; i < 3; ++i) {
        sim->load_N[i] = (double)force.world[i];
        sim->load_body_N[i] = (double)force.body[i];
        sim->load_at_m[i] = (double)force.at[i];
    }
    return force;
}

auvid_status_t vehicle_use_known_force(auvid_identifier_config_t *cfg,
                                       const auvid_known_force_t *force,
                                       auvid_calibrated_t *calibrated)
{
    const uint32_t *columns = cfg->vehicle->columns;
    double most = -1.0;
    int dof = AUVID_HEAVE;
    for (int i = AUVID_HEAVE; i >= 0; --i) { /* level, nearly: down is down */
        double horizontal = i < 2 ? hypot((double)force->world[0], (double)force->world[1]) : 0.0;
        double size =
            fabs((double)force->body[i]) + (i < 2 ? horizontal : fabs((double)force->world[2]));
        if (columns[i] != 0 && size > most) {
            most = size;
            dof = i;
        }
    }
    auvid_status_t status = auvid_calibrated_init(calibrated, cfg->vehicle, (auvid_dof_t)dof);
    if (status == AUVID_OK) {
        cfg->vehicle = cfg->metric.vehicle = &calibrated->vehicle;
        cfg->metric.free |= 1u << calibrated->k;
        cfg->metric.fixed[calibrated->k] = AUVID_C(1.0);
        calibrated->dry_mass_kg = cfg->dry_mass_kg;
        cfg->dry_mass_kg = AUVID_C(0.0);
    }
    return status;
}
