#!/usr/bin/env bash
# The guide's example of two tasks, under ThreadSanitizer: one mutex is enough, and without it the
# sanitizer reports a data race.
. "$(dirname "$0")/common.sh"

awk '/^## / { here = /^## Tasks/ } /^```c$/ { on = here; next } /^```$/ { on = 0 } on' \
    "$ROOT/lib/README.md" >tasks.c
cat >main.c <<'END'
/* The control task identifies a simulated vehicle, as fast as it can; another task works. */
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>

#include "auvid/auvid.h"
#include "simulator.h"

typedef pthread_mutex_t mutex_t;
#ifdef WITHOUT_MUTEX
#define mutex_lock(m) ((void)(m))
#define mutex_unlock(m) ((void)(m))
#else
#define mutex_lock(m) pthread_mutex_lock(m)
#define mutex_unlock(m) pthread_mutex_unlock(m)
#endif
static auvid_identifier_t id;
void control_tick_of_two(const auvid_input_t *in, auvid_output_t *out);
void background_step(void);
bool copy_estimate(auvid_estimate_t *estimate);
#include "tasks.c"

static atomic_bool ends;

static void *background(void *unused)
{
    while (!atomic_load(&ends)) {
        background_step();
        sched_yield();
    }
    return unused;
}

static void read_sensors(const sim_output_t *sensed, auvid_input_t *in)
{
    const sim_measurement_t *imu = &sensed->sensor[SIM_IMU], *dvl = &sensed->sensor[SIM_DVL];
    in->t_us = sensed->t_us;
    in->imu.present = imu->has;
    in->imu.t_us = imu->t_us;
    in->dvl.present = dvl->has;
    in->dvl.sample.t_us = dvl->t_us;
    in->dvl.sample.valid = AUVID_DVL_ALL;
    for (int i = 0; i < 3; ++i) {
        in->imu.attitude[i] = (auvid_real_t)imu->value[i];
        in->imu.rates[i] = (auvid_real_t)imu->value[3 + i];
        in->dvl.sample.velocity[i] = (auvid_real_t)dvl->value[i];
    }
}

/* Somebody drives in steps that jump, for a set; then it waits for the estimate. */
static void control(sim_t *sim, const sim_config_t *world)
{
    sim_output_t sensed;
    auvid_estimate_t estimate = {0};
    double wrench[6] = {0};
    for (int k = 0; k < 200000 && estimate.number == 0; ++k) {
        auvid_input_t in = {0};
        auvid_output_t out;
        if (k % 150 == 0) {
            for (int j = 0; j < 6; ++j) {
                double amplitude = j == 3 || j == 4 ? 0 : j == 5 ? 30 : 60;
                wrench[j] = k / 150 >> j & 1 ? amplitude : -amplitude;
            }
            wrench[2] -= world->parameter[SIM_WB];
        }
        sim_step(sim, NULL, wrench, &sensed);
        read_sensors(&sensed, &in);
        in.applied.present = true;
        for (int j = 0; j < 6; ++j) {
            in.applied.wrench[j] = (auvid_real_t)wrench[j];
        }
        control_tick_of_two(&in, &out);
        sched_yield();
        copy_estimate(&estimate);
    }
    printf("estimate %u of %u sets\n", (unsigned)estimate.number, (unsigned)estimate.sets);
}

int main(void)
{
    static auvid_identifier_config_t cfg;
    static sim_t sim;
    sim_config_t world;
    pthread_t worker;
    sim_defaults(&world);
    sim_init(&sim, &world);
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    if (auvid_identifier_init(&id, &cfg) < 0) {
        return 1;
    }
#ifndef WITHOUT_MUTEX
    pthread_mutex_init(&lock, NULL);
#endif
    pthread_create(&worker, NULL, background, NULL);
    control(&sim, &world);
    atomic_store(&ends, true);
    pthread_join(worker, NULL);
    return id.estimate.number > 0 ? 0 : 1;
}
END
build() { # PROGRAM [OPTION]
    gcc -std=gnu11 -O1 -g -fsanitize=thread -ffp-contract=off -Wall "${@:2}" -I"$ROOT/lib/include" \
        -I"$ROOT/tools/simulator" -I"$ROOT/lib/src" -I. -o "$1" main.c "$ROOT"/lib/src/*/*.c \
        "$ROOT"/tools/simulator/*.c -lm -pthread
}
check "the guide's example of two tasks compiles" build locked
check "it identifies, and there is no data race" \
    env TSAN_OPTIONS=halt_on_error=1 setarch -R ./locked
check "without the mutex it compiles" build bare -DWITHOUT_MUTEX
races() {
    ! TSAN_OPTIONS=halt_on_error=1 setarch -R ./bare >races 2>&1
    grep -q 'WARNING: ThreadSanitizer: data race' races
}
check "and there is a data race" races
exit "$failed"
