#!/usr/bin/env bash
# The code in README and in the library's guide compiles without a warning, runs, and identifies a
# vehicle, passively and with excitation. The commands there print the output shown. After a change
# of the output, README_BLOCKS=write tests/program/test_readme.sh updates it. Needs the library's
# objects in build/release (`make test` builds them).
. "$(dirname "$0")/common.sh"

blocks() {
    awk -v six="$1" '/^## / { here = /^## Six degrees/ ? 1 : /^## Tasks/ ? 2 : 0 }
        /^```c$/ { on = here == six; next } /^```$/ { on = 0 } on' "$ROOT/README.md" \
        "$ROOT/lib/README.md"
}
blocks 0 >example.c
cat >main.c <<'END'
/* The part that the example leaves to the integrator: a simulated vehicle with a pilot. */
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
static auvid_real_t pilot_wrench[AUVID_DOF_COUNT], added[AUVID_DOF_COUNT];

static void read_sensors(auvid_input_t *in)
{
    const sim_measurement_t *imu = &sensed.sensor[SIM_IMU], *dvl = &sensed.sensor[SIM_DVL];
    in->imu.present = imu->has;
    in->imu.t_us = imu->t_us;
    in->dvl.present = dvl->has;
    in->dvl.sample.t_us = dvl->t_us;
    in->depth.present = sensed.sensor[SIM_DEPTH].has;
    in->depth.t_us = sensed.sensor[SIM_DEPTH].t_us;
    in->depth.depth_m = (auvid_real_t)sensed.sensor[SIM_DEPTH].value[0];
    in->dvl.sample.valid = AUVID_DVL_ALL;
    for (int i = 0; i < 3; ++i) {
        in->imu.attitude[i] = (auvid_real_t)imu->value[i];
        in->imu.rates[i] = (auvid_real_t)imu->value[3 + i];
        in->dvl.sample.velocity[i] = (auvid_real_t)dvl->value[i];
    }
}

static void thrust_now(auvid_real_t *force_N)
{
    static auvid_allocation_t thrusters;
    auvid_allocation_result_t result;
    if (auvid_allocation_init(&thrusters, &auvid_allocation_girona500) < 0 ||
        auvid_allocation_solve(&thrusters, pilot_wrench, &result) < 0) {
        fault("thrust");
    }
    memcpy(force_N, result.force_N, sizeof result.force_N);
}

static void add_to_controller(const auvid_real_t *wrench)
{
    memcpy(added, wrench, sizeof added);
}

static void telemetry(const auvid_estimate_t *estimate)
{
    last = *estimate;
}

static uint8_t flash[1 << 16];
static uint32_t flashed;

static void flash_write(const uint8_t *page, uint32_t bytes)
{
    memcpy(flash + flashed, page, bytes);
    flashed += bytes;
}

void control_init(void);
void control_tick(uint64_t now_us);
void my_configure(auvid_identifier_config_t *cfg);
auvid_status_t configure_in_current(auvid_identifier_config_t *cfg);
auvid_status_t my_thrusters(auvid_identifier_config_t *cfg);
auvid_status_t my_model(auvid_refusal_t *refusal);
bool plan(void);
bool begin(void);
#include "example.c"

/* Is parameter i within 20 % of Girona500's g? */
static bool is_close(const auvid_vehicle_t *vehicle, int i, int g)
{
    double error = (double)(last.pi[i] / auvid_girona500_paper[g]) - 1.0;
    printf("%s %g %%\n", vehicle->parameter[i].name, 100.0 * error);
    return error < 0.2 && error > -0.2;
}

/* X_u u + X_uu u^2 at 0.4 m/s: 37.0 N. */
static bool holds_speed(void)
{
    double thrust = (double)thrust_to_hold(0.4f);
    printf("drag force %g N\n", thrust);
    return thrust > 0.95 * 37.02 && thrust < 1.05 * 37.02 && !(thrust_to_hold(5.0f) > 0);
}

static int check_estimate(void)
{
    bool good = holds_speed();
    for (int i = 0; i < 13; ++i) {
        good = is_close(&auvid_girona500, i, i) && good;
    }
    return good ? 0 : 1;
}

static int check_own_estimate(void)
{
    static const int same[MINE] = {
        [M_U] = AUVID_G500_M_U, [M_V] = AUVID_G500_M_V, [M_R] = AUVID_G500_M_R,
        [X_U] = AUVID_G500_X_U, [X_UU] = AUVID_G500_X_UU, [Y_V] = AUVID_G500_Y_V,
        [Y_VV] = AUVID_G500_Y_VV, [N_R] = AUVID_G500_N_R, [N_RR] = AUVID_G500_N_RR};
    bool good = true;
    for (int i = 0; i < MINE; ++i) {
        good = is_close(&my_vehicle, i, same[i]) && good;
    }
    return good ? 0 : 1;
}

static sim_config_t world;
static sim_t sim;

static void begin_world(void)
{
    sim_init(&sim, &world);
    memset(pilot_wrench, 0, sizeof pilot_wrench);
    auvid_allocation_init(&allocation, &auvid_allocation_girona500);
}

static void tick(void)
{
    double wrench[6];
    for (int j = 0; j < 6; ++j) {
        wrench[j] = (double)pilot_wrench[j];
    }
    sim_step(&sim, NULL, wrench, &sensed);
}

/* A checkpoint, and then the power fails. */
static void restart(void)
{
    save();
    auvid_status_t status;
    while ((status = save_next_page()) == AUVID_PENDING) {
    }
    if (status < 0) {
        fault("the checkpoint does not end");
    }
    memset(&id, 0, sizeof id);
    control_init();
    if (!resume(flash, flashed)) {
        fault("restart");
    }
}

static int restart_at = -1;

/* A pilot drives for four sets. */
static bool pilot(const auvid_real_t *amplitude)
{
    auvid_excitation_config_t sequence;
    auvid_excitation_t stick;
    begin_world();
    auvid_excitation_defaults(&sequence);
    auvid_excitation_plan(&sequence, amplitude, 30, 4, 1);
    auvid_excitation_init(&stick, &sequence);
    auvid_excitation_start(&stick, 0);
    for (int k = 0; k < 150 * 50; ++k) {
        tick();
        auvid_excitation_step(&stick, sensed.t_us, pilot_wrench);
        pilot_wrench[AUVID_HEAVE] += (auvid_real_t)-world.parameter[SIM_WB];
        control_tick(sensed.t_us);
        if (k == restart_at) {
            restart();
        }
    }
    return last.sets == 4;
}

static int passive(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    static auvid_estimate_t first;
    control_init();
    if (!pilot(amplitude)) {
        return 1;
    }
    first = id.estimate;
    restart_at = 3100;
    control_init();
    if (!pilot(amplitude) || memcmp(first.pi, id.estimate.pi, sizeof first.pi) != 0) {
        fault("another estimate after a restart");
    }
    return check_estimate();
}

static int own_vehicle(void)
{
    static auvid_identifier_config_t cfg;
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 0, 0, 0, 40};
    const auvid_real_t typical[MINE] = {250, 370, 75, -40, -125, -75, -450, -20, -60};
    my_configure(&cfg);
    if (auvid_vehicle_selftest(&my_vehicle, typical, 0, 0, NULL) < 0 ||
        auvid_identifier_init(&id, &cfg) < 0) {
        return 1;
    }
    return pilot(amplitude) ? check_own_estimate() : 1;
}

/* The table of terms gives the estimate of the hand-written model. */
static int own_table(void)
{
    static auvid_identifier_config_t cfg;
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 0, 0, 0, 40};
    const auvid_real_t typical[MINE] = {250, 370, 75, -40, -125, -75, -450, -20, -60};
    if (own_vehicle() != 0 || my_model(NULL) < 0 ||
        auvid_vehicle_selftest(&my_terms.vehicle, typical, 0, 0, NULL) < 0) {
        return 1;
    }
    auvid_estimate_t by_hand = last;
    my_configure(&cfg);
    cfg.vehicle = cfg.metric.vehicle = &my_terms.vehicle;
    return auvid_identifier_init(&id, &cfg) == AUVID_OK && pilot(amplitude) &&
                   memcmp(by_hand.pi, last.pi, sizeof last.pi) == 0
               ? 0
               : 1;
}

/* No depth sensor: the craft is armed and excited, and the guard is done. */
static int surface(void)
{
    static auvid_identifier_config_t cfg;
    auvid_actuation_config_t acting;
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 0, 0, 0, 40};
    bool begun = false;
    double largest = 0;
    my_configure(&cfg);
    auvid_actuation_defaults(&acting);
    auvid_excitation_plan(&acting.excitation, amplitude, 30, 2, 1);
    acting.guard.surface = true;
    begin_world();
    if (auvid_identifier_init(&id, &cfg) < 0 ||
        auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL) < 0) {
        return 1;
    }
    for (int k = 0; k < 100 * 50; ++k) {
        tick();
        sensed.sensor[SIM_DEPTH].has = false;
        control_tick(sensed.t_us);
        largest = (double)added[0] > largest ? (double)added[0] : largest;
        memcpy(pilot_wrench, added, sizeof pilot_wrench);
        pilot_wrench[AUVID_HEAVE] += (auvid_real_t)-world.parameter[SIM_WB];
        begun = begun || begin();
    }
    printf("sets %u, guard %s, %g N\n", last.sets, auvid_guard_state_str(actuation.guard.state),
           largest);
    return last.sets == 2 && actuation.guard.state == AUVID_GUARD_DONE && largest > 50 ? 0 : 1;
}

static int own_thrusters(void)
{
    static auvid_identifier_config_t cfg;
    return my_thrusters(&cfg) == AUVID_OK && auvid_identifier_init(&id, &cfg) == AUVID_OK ? 0 : 1;
}

static int exciting(bool adaptive)
{
    static auvid_identifier_config_t cfg;
    bool begun = false;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.exact_inputs = true;
    begin_world();
    if (auvid_identifier_init(&id, &cfg) < 0 || !plan() || (adaptive && !plan_adaptive())) {
        return 1;
    }
    for (int k = 0; k < 300 * 50; ++k) {
        tick();
        control_tick(sensed.t_us);
        memcpy(pilot_wrench, added, sizeof pilot_wrench);
        pilot_wrench[AUVID_HEAVE] += (auvid_real_t)-world.parameter[SIM_WB];
        begun = begun || begin();
    }
    printf("sets %u, guard %s\n", last.sets, auvid_guard_state_str(actuation.guard.state));
    bool good = last.sets >= (adaptive ? 2 : 8) && actuation.guard.state == AUVID_GUARD_DONE;
    return good ? check_estimate() : 1;
}

int main(int count, char **argument)
{
    sim_defaults(&world);
    if (count < 2) {
        return passive();
    }
    if (strcmp(argument[1], "own-vehicle") == 0) {
        return own_vehicle();
    }
    if (strcmp(argument[1], "own-table") == 0) {
        return own_table();
    }
    if (strcmp(argument[1], "surface") == 0) {
        return surface();
    }
    if (strcmp(argument[1], "own-thrusters") == 0) {
        return own_thrusters();
    }
    return exciting(strcmp(argument[1], "adaptive") == 0);
}
END
# Those of the present sources: a file that was renamed leaves its object.
objects=$(cd "$ROOT" && printf '%s\n' lib/src/*/*.c tools/simulator/*.c |
    sed "s|^|$ROOT/build/release/|; s|c\$|o|")
# shellcheck disable=SC2086
check "README's example compiles without a warning" \
    gcc -std=c11 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror -I"$ROOT/lib/include" \
    -I"$ROOT/lib/src" -I"$ROOT/tools/simulator" -I. -o example main.c $objects -lm
check "README's example identifies a vehicle passively, with a restart" ./example
check "README's own vehicle is identified" ./example own-vehicle
check "README's table of terms gives the same estimate" ./example own-table
check "README's surface craft is armed and excited without a depth sensor" ./example surface
check "README's own thrusters are accepted" ./example own-thrusters
check "README's plan excites and identifies it, and the guard is done" ./example exciting
check "README's adaptive excitation identifies it, and the guard is done" ./example adaptive

# The section on six degrees of freedom needs other sizes.
cat >six.c <<'END'
#include <string.h>

#include "auvid/auvid.h"

auvid_status_t configure_bluerov2(auvid_identifier_config_t *cfg, auvid_actuation_config_t *acting);
#include "blocks.c"

static auvid_identifier_t id;
static auvid_actuation_t actuation;
static auvid_allocation_t allocation;

int main(void)
{
    auvid_actuation_config_t acting;
    const auvid_allocation_config_t *to = &auvid_allocation_bluerov2_heavy;
    bool good = configure_bluerov2(&id.cfg, &acting) == AUVID_OK &&
                auvid_identifier_init(&id, &id.cfg) == AUVID_OK &&
                auvid_allocation_init(&allocation, to) == AUVID_OK &&
                auvid_identifier_attach_actuation(&id, &actuation, &acting, &allocation) == 0;
    return good ? 0 : 1;
}
END
blocks 1 >blocks.c
sizes=$(grep -o '`AUVID_MAX_[A-Z]*=[0-9]*`' "$ROOT/lib/README.md" | tr -d '`' | sed 's/^/-D/')
check "README's vehicle in six degrees of freedom compiles at the sizes it names" \
    gcc -std=c11 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror $sizes -I"$ROOT/lib/include" \
    -I. -c six.c
accepted() {
    gcc -std=c11 $sizes -I"$ROOT/lib/include" -o six six.o "$ROOT"/lib/src/*/*.c
    ./six
}
check "README's vehicle in six degrees of freedom is accepted" accepted

# The main loop of the Linux port.
port=$ROOT/port/linux_socketcan
awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$port/README.md" |
    sed 's/"can0"/"none-such"/' >loop.c
check "the main loop of the Linux port compiles" gcc -std=c11 -Wall -Wextra -Wconversion -Werror \
    -I"$port" -o loop loop.c "$port"/*.c
check "  and says why there is no such bus" \
    sh -c '! timeout 10 ./loop 2>err && [ "$(wc -l <err)" = 1 ]'

# Every block below "<!-- output of: COMMAND -->" is the output of the command, except wall times.
cat >blocks.py <<'END'
import os, re, subprocess, sys
root, name, auvid, mode = sys.argv[1:]
readme = os.path.join(root, name)
text = open(readme).read()
found = re.findall(r"<!-- output of: (.*?) -->\n```text\n(.*?)```\n", text, re.S)
assert len(found) == text.count("```text\n") > 0, len(found)
plain = lambda lines: [l for l in lines.splitlines() if not l.startswith("  time  ")]
for command, shown in found:
    run = ["bash", "-c", command.replace("build/auvid", auvid, 1)]
    printed = subprocess.run(run, capture_output=True, text=True, check=True,
                             cwd=root).stdout
    if mode == "write":
        text = text.replace("output of: %s -->\n```text\n%s" % (command, shown),
                            "output of: %s -->\n```text\n%s" % (command, printed))
        continue
    assert plain(printed) == plain(shown) != [], (command, printed)
if mode == "write":
    open(readme, "w").write(text)
END
for name in README.md lib/README.md port/cortex_m/README.md tools/auvid/README.md; do
    check "$name shows what its commands print" python3 blocks.py "$ROOT" "$name" "$AUVID" \
        "${README_BLOCKS:-check}"
done

# Every link to a file or heading of the project has a target.
cat >links.py <<'END'
import pathlib, re, sys
root = pathlib.Path(sys.argv[1])
slug = lambda h: re.sub(r"[^\w\- ]", "", h.strip().lower()).replace(" ", "-")
ours = lambda p: not {"build", "third_party"} & set(p.relative_to(root).parts)
pages = [p for p in root.rglob("*.md") if ours(p)]
bad, links = [], 0
for page in pages:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if re.match(r"[a-z]+:", target):
            continue
        links += 1
        name, _, heading = target.partition("#")
        at = (page.parent / name) if name else page
        there = at.exists() and (not heading or heading in
                                 [slug(h) for h in re.findall(r"^#+ (.*)$", at.read_text(), re.M)])
        bad += [] if there else [f"{page}: {target}"]
print("\n".join(bad))
assert links > 20 and not bad
END
check "links in the documentation have targets" python3 links.py "$ROOT"
# The guide of the program names each key of its JSON.
cat >keys.py <<'END'
import json, pathlib, re, sys
guide = pathlib.Path(sys.argv[1]).read_text()
section = guide.split("\n## JSON\n")[1].split("\n## ")[0]
words = lambda text: {w for code in re.findall(r"`([^`\n]+)`", text)
                      for w in re.findall(r"[\w-]+", code)}
axes = set("XYZKMNuvwpqr") | {"surge", "sway", "heave", "roll", "pitch", "yaw"}

def keys(d, named=()):
    """All keys of objects, but for those that are names: of axes, groups, parameters."""
    if isinstance(d, list):
        return set().union(*(keys(x) for x in d)) if d else set()
    if not isinstance(d, dict):
        return set()
    names = {p["name"] for p in d.get("parameters", [])} if not named else named
    out = set(d) - axes - names
    for key, value in d.items():
        values = value.values() if key == "groups" else [value]
        out = out.union(*(keys(x, names if key == "truth" else ()) for x in values))
    return out

for name in sys.argv[2:]:
    d = json.load(open(name))
    documented = words(section)
    if "thrusters" in d:  # the keys of a vehicle file are in the guide's other sections, and in C
        d = {k: v for k, v in d.items() if k not in ("guard", "uncertainty", "uncertain")}
        documented |= words(guide)
    assert keys(d) and keys(d) <= documented, (name, sorted(keys(d) - documented))
END
known_keys() {
    "$AUVID" demo --json --sets 2 --csv whole.csv >1.json
    "$AUVID" demo --json --sets 1 --literal >2.json
    "$AUVID" demo --json --sets 1 --adaptive >3.json
    "$AUVID" demo --json --sets 1 --runs 2 >4.json 2>err
    "$AUVID" demo --json --scenario operator-abort >5.json
    "$AUVID" demo --json --scenario current >6.json
    sed '1s/X_N,Y_N,Z_N,K_Nm,M_Nm,N_Nm/cmd_surge,cmd_sway,cmd_heave,cmd_roll,cmd_pitch,cmd_yaw/' \
        whole.csv >commands.csv
    "$AUVID" fit commands.csv --json --plain --map auto --validate commands.csv >7.json 2>err
    "$AUVID" fit whole.csv --json --thrusters girona500 >8.json 2>err || true
    "$AUVID" fit none.csv --json >9.json 2>err || true
    "$AUVID" check whole.csv --json >10.json
    "$AUVID" check surface --json >11.json
    python3 keys.py "$ROOT/tools/auvid/README.md" ./*.json
}
check "the guide of the program names each key of its JSON" known_keys
finish
