#!/usr/bin/env bash
# The example in README compiles without a warning, runs, and identifies; the demo prints what
# README shows.
. "$(dirname "$0")/common.sh"

awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$ROOT/README.md" >example.c
cat >main.c <<'END'
/* What the example leaves to the integrator: a simulated vehicle, driven by somebody else. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/auvid.h"
#include "simulator.h"

static void fault(const char *what)
{
    puts(what);
    exit(1);
}

static sim_output_t sensed;
static auvid_estimate_t last;
static auvid_real_t driven[AUVID_DOF_COUNT];

static void read_sensors(auvid_input_t *in)
{
    const sim_measurement_t *imu = &sensed.sensor[SIM_IMU], *dvl = &sensed.sensor[SIM_DVL];
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

static void thrust_now(auvid_real_t *wrench)
{
    memcpy(wrench, driven, sizeof driven);
}

static void add_to_controller(const auvid_real_t *wrench)
{
    (void)wrench;
}

static void telemetry(const auvid_estimate_t *estimate)
{
    last = *estimate;
}

void control_init(void);
void control_tick(uint64_t now_us);
#include "example.c"

int main(void)
{
    sim_config_t world;
    sim_t sim;
    auvid_excitation_config_t plan;
    auvid_excitation_t pilot;
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    sim_defaults(&world);
    sim_init(&sim, &world);
    auvid_excitation_defaults(&plan);
    auvid_excitation_plan(&plan, amplitude, 30, 4, 1);
    auvid_excitation_init(&pilot, &plan);
    auvid_excitation_start(&pilot, 0);
    control_init();
    for (int tick = 0; tick < 150 * 50; ++tick) {
        double wrench[6];
        for (int j = 0; j < 6; ++j) {
            wrench[j] = (double)driven[j];
        }
        sim_step(&sim, NULL, wrench, &sensed);
        auvid_excitation_step(&pilot, sensed.t_us, driven);
        driven[AUVID_HEAVE] += (auvid_real_t)-world.parameter[SIM_WB];
        control_tick(sensed.t_us);
    }
    for (int i = 0; i < 13; ++i) {
        double error = (double)(last.pi[i] / auvid_girona500_paper[i]) - 1.0;
        printf("%s %g %%\n", auvid_girona500.parameter[i].name, 100.0 * error);
        if (!(error < 0.2 && error > -0.2)) {
            return 1;
        }
    }
    return last.sets == 4 ? 0 : 1;
}
END
check "README's example compiles without a warning" \
    gcc -std=c11 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror -I"$ROOT/lib/include" \
    -I"$ROOT/tools/simulator" -I. -o example main.c \
    "$ROOT"/lib/src/*.c "$ROOT"/tools/simulator/*.c -lm
check "README's example identifies a vehicle that somebody else drives" ./example

# Everything but the last line, the time it took.
awk '/^```text$/ { on = 1; next } /^```$/ { on = 0 } on' "$ROOT/README.md" | sed '$d' >shown
"$AUVID" demo 2>/dev/null | sed '$d' >printed
check "README shows what the demo prints" diff shown printed
finish
