#!/usr/bin/env bash
# Vehicle files: what is refused, with its sentence; the ready vehicles; a vehicle of the user, from
# the guide to the configuration of its firmware. Long form: that on an emulated Cortex-M4F, too.
# Needs the program's objects in build/wide (`make` builds them).
. "$(dirname "$0")/common.sh"
CC=${CC:-gcc}
tools=$ROOT/tools/auvid

block() {
    awk -v kind="$1" '$0 == "```" kind { on = 1; next } /^```$/ { on = 0 } on' "$tools/README.md"
}
block ini >minnow.ini

# ---- the ready vehicles ----
embedded() {
    ready=$(grep -o '{"[a-z0-9_]*\.ini"' "$tools/vehicle/vehicles_ready.c" | tr -d '{"')
    [ "$(echo "$ready" | sort)" = "$(cd "$tools/vehicles" && ls -- *.ini)" ] &&
        cd "$tools/vehicles" &&
        # shellcheck disable=SC2086
        ../embed.py --check ../vehicle/vehicles_ready.c vehicles_ready $ready
}
check "the program contains vehicles/*.ini as they are" embedded
same() {
    "$AUVID" demo --json --sets 1 --vehicle "$1" >named.json
    "$AUVID" demo --json --sets 1 --vehicle "$tools/vehicles/$1.ini" >file.json
    cmp named.json file.json
}
for name in bluerov2_standard torpedo surface; do
    check "$name: identified" exits 0 demo --vehicle "$name" --sets 4 --json
    check "  every identifiable parameter within 15 %" is out '
sure = [p for p in d["parameters"] if p["identifiable"] and p["truth"] != 0]
assert len(sure) >= 8 and d["guard"]["state"] == "done", (len(sure), d["guard"])
assert all(abs(p["estimate"] / p["truth"] - 1) < 0.15 for p in sure), sure'
done
check "a file and the ready vehicle of the same text are the same" same bluerov2

# ---- refused files: edit EXPRESSION changes the file with sed ----
edit() { sed -E "$1" minnow.ini >bad.ini; }
bad() { # NAME PATTERN
    check "$1" refuses "bad\.ini:$2" check bad.ini
}
edit 's/^model = .*/&\nmodel = fossen/'
bad "a key twice" "5:1: duplicate key 'model': it stands in line 4 already; keep one"
edit 's/^\[guard\]/[excitation]/'
bad "a section twice" "[0-9]+:2: duplicate section 'excitation'"
edit 's/^forward_N = 8/forwards_N = 8/'
bad "a key that is missing" "[0-9]+:1: \[thruster\.3\] has no key 'forward_N': add it"
edit 's/^group = propellers/&\ncolour = red/'
bad "an unknown key" \
    "13:1: unknown key 'colour' in \[thruster\.1\]; known: position_m, direction, forward_N"
edit 's/^\[guard\]/[guards]/'
bad "an unknown section" "[0-9]+:2: unknown section \[guards\]; known: vehicle, "
edit '/^\[vehicle\]/,/^dry/d'
bad "a section that is missing" "1:1: no section \[vehicle\]: add it"
edit 's/^dry_mass_kg = .*/dry_mass_kg = 0/'
bad "a mass of zero" "5:15: dry_mass_kg: 0 is not from 0.001 to 1e\+06"
edit 's/^m_u = 5/m_u = -5/'
bad "a negative mass" "[0-9]+:7: m_u: -5 is not from 1e-06"
for word in inf nan 0x10 5kg; do
    edit "s/^m_u = 5/m_u = $word/"
    bad "'$word' for a number" "[0-9]+:[78]: m_u: '.*' is not a finite decimal number"
done
edit 's/^m_u = 5/m_u = 5,1/'
bad "a decimal comma" "[0-9]+:8: m_u: a comma: separate numbers by blanks, decimals by a point"
edit 's/^\[vehicle\]/[Vehicle]/'
bad "a section in capitals" "1:2: unknown section \[Vehicle\]; known: vehicle, "
edit 's/^m_u = /mu = /; /^N_rr/d'
bad "several keys that are missing, one misspelt" \
    "[0-9]+:1: \[truth\] has no keys 'm_u', 'N_rr': add them; 'mu' in line [0-9]+ is unknown"
edit 's/^m_v = 9/m_v = 3/'
bad "a true mass below the dry mass" "[0-9]+:1: m_v is below dry_mass_kg, but contains it"
edit '$a [allocation]\ndofs = surge heave yaw sway'
bad "a controlled degree of freedom without thruster" \
    "[0-9]+:1: dofs names a degree of freedom in which no thruster acts"
edit '$a [allocation]\npriority = roll'
bad "a priority that is not controlled" "[0-9]+:1: priority names a degree of freedom that"
edit 's/^map = .*/map = table\ncommand = -1 0 1\nforce_N = 9 0 12/; /^voltage/d'
bad "a table without minus" "[0-9]+:1: force_N pushes the same way at both ends of the table"
edit 's/^m_u = 5/m_u = 1e999/'
bad "a number that is too large" "[0-9]+:7: m_u: '1e999' is too large"
edit 's/^position_m = 0 0 0/position_m = 0 0/'
bad "two of three numbers" "[0-9]+:14: position_m: 2 numbers, separated by blanks, but it needs 3"
edit 's/^position_m = 0 0 0/position_m = 0 0 0 0/'
bad "four of three numbers" "[0-9]+:20: position_m: more than 3 numbers"
edit 's/^direction = 0 0 1/direction = 0 0 0/'
bad "a direction of length zero" "[0-9]+:13: direction: its length is 0"
edit 's/^position_m = -0.15 -0.1 0/position_m = 3 0.1 0/'
bad "two thrusters on a line" "14:1: \[thruster\.2\] acts along the same line as \[thruster\.1\]"
edit 's/^yaw_Nm = .*/&\nsway_N = 3/'
bad "a wrench that the thrusters do not give" \
    "[0-9]+:1: sway_N is a wrench that the thrusters cannot"
edit 's/^yaw_Nm = .*/&\nroll_Nm = 3/'
bad "a wrench that is not modelled" \
    "[0-9]+:1: roll_Nm is of a degree of freedom that the model has no"
edit 's/^surge_N = .*/surge_N = 60/'
bad "a wrench that is too large" \
    "[0-9]+:1: surge_N is more than the thrusters give .*by 0\.[0-9]+ or less"
edit 's/^group = propellers/group = propeller/'
bad "a group that does not exist" "12:9: group: there is no section \[group\.propeller\]"
edit 's/^map = .*/map = cubic/'
bad "an unknown map" \
    "[0-9]+:7: map: 'cubic' is not one of newton, linear, signed-square, rpm, table"
edit 's/^map = .*/map = rpm/; /^voltage/d'
bad "rpm without the full speed" "[0-9]+:1: full_command is missing: add the speed"
edit 's/^map = .*/map = table\ncommand = -1 0 0\nforce_N = -9 0 12/; /^voltage/d'
bad "a table that goes back" "[0-9]+:1: command must increase"
edit '/^voltage_V/d'
bad "an exponent without its voltage" "[0-9]+:1: voltage_V is missing"
edit 's/^depth_max_m = 20/depth_max_m = 0.5/'
bad "limits the wrong way round" "[0-9]+:1: depth_max_m must not be less"
edit 's/^depth_m = 10/depth_m = 30/'
bad "a start outside of the limits" "[0-9]+:1: depth_m: the simulation would start at 30 m"
edit 's/^name = .*/name = My ROV/'
bad "a name with a blank" "2:8: name: 'My ROV' is not a name"
edit 's/^\[thruster.3\]/[thruster.4]/'
bad "a number left out" "21:1: \[thruster\.4\] without \[thruster\.3\]"
edit 's/^\[thruster.3\]/[thruster.3/'
bad "a bracket that is missing" "21:12: a section is \[name\]"
edit '1s/^/key = 1\n/'
bad "a key before the first section" "1:1: a key before the first \[section\]"
edit 's/^name = .*/name =/'
bad "a key without value" "2:7: the key has no value"
edit 's/^name = .*/name minnow/'
bad "a line without =" "2:6: expected \[section\] or key = value"
{ head -n 3 minnow.ini; head -c 65536 /dev/zero | tr '\0' x; } >bad.ini
bad "a line of 64 KB" "4:513: the line has more than 512 characters"
{
    cat minnow.ini
    yes '# a comment of fifty characters, again and again ..' | head -n 1300
} >bad.ini
bad "a file of 64 KB" "[0-9]+:1: the file has more than 65535 bytes"
{ head -n 3 minnow.ini; printf 'a = \0\n'; } >bad.ini
bad "a binary file" "4:5: a control character"
edit 's/^model = .*/model = terms/'
bad "a model of terms without terms" "1:1: no section \[parameters\], which the model 'terms' needs"
cp "$tools/vehicles/surface.ini" surface.ini
terms() { sed -E "$1" surface.ini >bad.ini; }
terms 's/^m_r = yaw .*/m_r = yaw + r_dots/'
bad "a factor that does not exist" "[0-9]+:13: m_r: 'r_dots' is not one of 1, u, .*, r_dot, "
terms 's/^m_r = inertia/m_r = moment/'
bad "a kind that does not exist" \
    "[0-9]+:7: m_r: 'moment' is not one of other, mass, inertia, linear_drag, quadratic_drag, force"
terms 's/^m_r = yaw .*/m_r = yaw + r_dot u_dot/'
bad "two accelerations in a term" "[0-9]+:1: m_r: a term has two accelerations, but at most one"
terms 's/^m_r = yaw .*/m_r = yaw + r_dot, yaw + r_dot/'
bad "a term twice" "[0-9]+:1: m_r: a term stands twice in the same equation: keep one$"
terms 's/^X_uu = surge -/X_uu = surge +/'
bad "a quadratic drag that accelerates" \
    "[0-9]+:8: X_uu: a drag has the sign - in its own equation: its parameter is negative$"
terms 's/^N_r = yaw -/N_r = surge + u r, yaw +/'
bad "a linear one" "[0-9]+:7: N_r: a drag has the sign - in its own equation"
terms 's/^m_v = sway \+/m_v = sway -/'
bad "a mass that is negative" "[0-9]+:7: m_v: a mass or an inertia has the sign \+ before its own"
terms 's/^m_u = surge \+ u_dot/m_u = surge - v r w, surge + u_dot/'
check "other terms of a mass have any sign" exits 0 check bad.ini --json
terms 's/^m_r = yaw .*/m_r = surge + r_dot/'
bad "no term in its own equation" \
    "[0-9]+:1: m_r: \[terms\] has no term of it in the equation of its degree of freedom, yaw: add"
terms 's/^X_u = surge - u/X_v = surge - u/'
bad "a term of no parameter" "[0-9]+:7: X_v: is no key of \[parameters\]"
terms 's/^Y_v = -30/Y_x = -30/'
bad "a parameter without its truth" "[0-9]+:1: \[truth\] has no key 'Y_v'"
check "no such file" refuses 'none.ini: No such file' check none.ini
check "a directory" refuses '\./: Is a directory' demo --vehicle ./
check "no such log" refuses 'x.csv: No such file' check x.csv
edit 's/^map = .*/map = table\ncommand = -1 0 1\nforce_N = -9 0 15/; /^voltage/d'
check "a table beyond the largest force" exits 0 check bad.ini
check "  is told" grep -q 'force_N is beyond forward_N or backward_N of a thruster' out
sed -E '/^\[(truth|excitation)\]/,/^$/d
    s/^position_m = -0.15 (-?)0.1 0/position_m = -15 \110 0/' minnow.ini >far.ini
check "positions in centimetres" exits 0 check far.ini
check "  are told" grep -q '^    \[thruster\.1\] position_m: it is 18 m from the origin, too' out
sed -i '/^dry_mass_kg/d' far.ini
check "  not without the dry mass" sh -c "'$AUVID' check far.ini >out; ! grep -q 'too far' out"
sed -i 's/^position_m = -15 /position_m = -25 /' far.ini
check "  unless they are beyond 20 m" sh -c "'$AUVID' check far.ini | grep -q 'too far for a veh'"
check "--json with --header" refuses 'cannot be combined' check minnow.ini --json --header

# ---- the vehicle of the guide ----
check "check reports" exits 0 check minnow.ini
check "  the largest wrench" grep -Eq '^  surge +-18\.0 +24\.0 N +6\.0 N' out
check "  what cannot be given" grep -Eq '^  sway +not possible without another force or moment' out
check "  what is missing" grep -q 'dvl_lever_m: on board the DVL is taken to be at' out
check "  and what would help" \
    grep -Eq '^ +[0-9.]+ %  0.5 N of weight in water for 60 s' out
check "check --json" exits 0 check minnow.ini --json
check "  has what the file says" python3 -c '
import json
d = json.load(open("out"))
assert d["name"] == "minnow" and d["model"] == "girona500" and d["dry_mass_kg"] == 3.4
assert [t["wrench"][5] for t in d["thrusters"]] == [-0.1, 0.1, 0]
assert d["groups"]["propellers"]["map"] == "signed-square"
assert d["groups"]["propellers"]["voltage_V"] == 11.1
surge = d["largest_wrench"]["surge"]
assert abs(surge[0] + 18) < 1e-4 and abs(surge[1] - 24) < 1e-4
assert d["excitation"]["yaw_Nm"] == 0.5
assert d["guard"]["depth_max_m"] == 20 and d["guard"]["depth_min_m"] == 1
assert d["truth"]["m_w"] == 10 and d["uncertainty"]["thrust_scale"] == 0.05, d'
check "demo identifies it" exits 0 demo --vehicle minnow.ini --lag 0.15 --csv minnow.csv --json
check "  its masses, and that of the sway, which its turns move" is out '
assert all(abs(P[n]["estimate"] / P[n]["truth"] - 1) < 0.1 and P[n]["identifiable"]
           for n in ("m_u", "m_v", "m_w", "m_r")), P
assert d["guard"]["state"] == "done", d["guard"]'
check "fit identifies its log" exits 0 fit minnow.csv --vehicle minnow.ini --json
check "  its masses" is out 'assert all(abs(P[n]["estimate"] / t - 1) < 0.15
           for n, t in {"m_u": 5, "m_w": 10, "m_r": 0.09}.items()), P'
check "node identifies it over the bus" \
    exits 0 node --bus memory --excite --vehicle minnow.ini --log minnow.log --sets 4 --json
cp out node.json
check "replay reads the bus" exits 0 replay minnow.log --vehicle minnow.ini --sets 4 --json
check "  and finds the same" is out '
n = json.load(open("node.json"))
assert [p["estimate"] for p in d["parameters"]] == [p["estimate"] for p in n["parameters"]]'
replay_unnamed() {
    "$AUVID" replay minnow.log --sets 4 >out 2>err || true
    sed -n 1p err | grep -q 'minnow.log: the log is compared with the vehicle girona500, because'
}
check "  without its vehicle it says first which it takes" replay_unnamed
sed '/^\[truth\]/,$d' minnow.ini >real.ini
check "without truth: fit" exits 0 fit minnow.csv --vehicle real.ini --json
for command in "demo" "vehicle --bus vcan0" "node --bus memory"; do
    # shellcheck disable=SC2086
    check "  but not $command" refuses "the vehicle 'minnow' has no section \[truth\]" \
        $command --vehicle real.ini
done
sed '/^\[excitation\]/,/^yaw/d' minnow.ini >passive.ini
sed 's/^surge_N = .*/surge_N = 60/' minnow.ini >strong.ini
for file in passive strong; do
    check "$file.ini, which cannot be excited: fit" exits 0 fit minnow.csv --vehicle $file.ini
    check "  gives the bits of one that can" sh -c \
        '"$0" fit minnow.csv --vehicle minnow.ini >first && cmp first out' "$AUVID"
    check "  nothing on stderr" test ! -s err
    check "  auvid-log can read it" exits 0 check $file.ini --json
done
check "without [excitation]: check says what that means" exits 0 check passive.ini
check "  in one sentence" grep -q '^    \[excitation\]: without it a log can be checked and' out
for command in "demo" "vehicle --bus vcan0" "node --bus memory --excite"; do
    # shellcheck disable=SC2086
    check "  but not $command" refuses 'passive.ini:1:1: no section \[excitation\]: add it' \
        $command --vehicle passive.ini
done
check "  a node that does not excite" exits 1 node --bus memory --vehicle passive.ini --sets 1
check "  listens" grep -q '^auvid .* node on memory, passive$' out
check "  a replay of one that did, whose estimates differ in digits" \
    exits 1 replay minnow.log --vehicle passive.ini --sets 4 --json
check "  identifies its masses" is out 'assert all(abs(P[n]["estimate"] / t - 1) < 0.15
           for n, t in {"m_u": 5, "m_w": 10, "m_r": 0.09}.items()), P'
listens() {
    "$AUVID" check passive.ini --header >minnow.h
    grep -q 'no \[excitation\]: nothing is excited' minnow.h
    ! grep -q actuation minnow.h
    block c | sed '/acting\|actuation/d; s/^    return status .*/    return status;/' >listens.c
    echo 'int main(void) { return control_init() == AUVID_OK ? 0 : 1; }' >>listens.c
    "$CC" -std=c11 -DAUVID_MAX_PARAMETERS=32 -DAUVID_MAX_UNCERTAIN=146 -I"$ROOT/lib/include" -I. \
        -Wall -Wextra -Werror listens.c "$ROOT"/build/wide/lib/src/*/*.o -o listens && ./listens
}
check "  its header is of firmware that listens" listens
for command in "demo" "replay minnow.log" "node --bus memory --excite"; do
    # shellcheck disable=SC2086
    check "more than the thrusters give: not $command" refuses \
        'strong.ini:[0-9]+:1: surge_N is more than the thrusters give' $command --vehicle strong.ini
done
cp minnow.ini mounted.ini
printf '\n[mount]\ndvl_lever_m = -0.1 0 0.1\ndvl_euler_deg = 0 0 45\n' >>mounted.ini
echo 'imu_euler_deg = 3 -2 90' >>mounted.ini
check "mounted askew: demo identifies the same vehicle" exits 0 demo --vehicle mounted.ini --json \
    --csv mounted.csv
check "  its masses" is out 'assert all(abs(P[n]["estimate"] / P[n]["truth"] - 1) < 0.1
           for n in ("m_u", "m_w", "m_r")), P'
check "  a log has velocities of the origin" exits 0 fit mounted.csv --vehicle mounted.ini --plain
check "    no warning with --plain" sh -c '! grep -q mount err'
exits 3 fit mounted.csv --vehicle mounted.ini --thrusters mounted.ini
check "    else fit says that it must" grep -q '\[mount\] of the vehicle file is not applied' err
awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "psi_rad") at = i }
    NR > 1 { $at = -$at } { print }' mounted.csv >wrong.csv
check "    check says it of a log with errors" exits 1 check wrong.csv --vehicle mounted.ini
check "      as fit does" grep -q '\[mount\] of the vehicle file is not applied' err
sed '/^\[excitation\]/,/^$/d' minnow.ini >log_only.ini
check "a file for logs needs no lever arm" exits 0 check log_only.ini
check "  indeed" sh -c '! grep -q dvl_lever_m out'

# ---- a vehicle of 1200 kg ----
sed -E 's/^dry_mass_kg = .*/dry_mass_kg = 1200/; s/^(forward|backward)_N = .*/\1_N = 400/
    s/^surge_N = .*/surge_N = 300/; s/^heave_N = .*/heave_N = 150/; s/^yaw_Nm = .*/yaw_Nm = 25/
    s/^m_u = .*/m_u = 1500/; s/^m_v = .*/m_v = 2000/; s/^m_w = .*/m_w = 2200/
    s/^m_r = .*/m_r = 90/; s/^X_uu = .*/X_uu = -300/; s/^Z_ww = .*/Z_ww = -1100/
    s/^N_r = .*/N_r = -20/; s/^N_rr = .*/N_rr = -40/' minnow.ini >heavy.ini
check "a vehicle of 1200 kg is identified" exits 0 demo --vehicle heavy.ini --csv heavy.csv --json
check "  with masses above 1000 kg" is out 'assert all(P[n]["identifiable"] and
    abs(P[n]["estimate"] / P[n]["truth"] - 1) < 0.1 for n in ("m_u", "m_w")), P'
check "  by fit, too" exits 0 fit heavy.csv --vehicle heavy.ini --json
check "  with masses above 1000 kg" is out \
    'assert P["m_u"]["estimate"] > 1300 and P["m_w"]["estimate"] > 1900 and d["status"] == "ok", P'
check "  within the bounds that are given" rejects \
    'the dry mass, 1200 kg, is not below the upper bound of the masses, 1000: widen --bounds' \
    fit heavy.csv --vehicle heavy.ini --bounds=-1000,1000
check "a light one has the bounds of the library" \
    sh -c '"$0" check minnow.ini --header >light.h && ! grep -q search light.h' "$AUVID"

# ---- the header ----
cp "$ROOT/tests/program/vehicle_config.h" .
cat >from_header.c <<'END'
#include "vehicle_config.h"
#include "vehicle.h"
#define PASTE(a, b) a##b
#define OF(name, what) PASTE(name, what)
int main(void)
{
    static OF(NAME, _storage_t) storage;
    static auvid_identifier_config_t identifier;
    static auvid_allocation_config_t allocation;
    static auvid_uncertain_config_t uncertain;
    static auvid_actuation_config_t actuation;
    if (OF(NAME, _identifier)(&storage, &identifier) < 0 ||
        OF(NAME, _actuation)(30, 4, 7, &actuation) < 0) {
        return 1;
    }
    OF(NAME, _allocation)(&allocation);
    OF(NAME, _uncertain)(&uncertain);
    print_identifier(&identifier);
    print_allocation(&allocation);
    print_uncertain(&uncertain);
    print_actuation(&actuation);
    return 0;
}
END
cat >from_program.c <<'END'
#include "vehicle_config.h"
#include "vehicle/vehicles.h"
int main(int count, char **word)
{
    static auvid_identifier_config_t identifier;
    static auvid_actuation_config_t actuation;
    const vehicle_t *vehicle = count == 2 ? vehicle_chosen("test", word[1]) : NULL;
    if (vehicle == NULL) {
        return 1;
    }
    vehicle_identifier(vehicle, 1, &identifier);
    vehicle_actuation(vehicle, 30, 4, 7, 0, &actuation);
    print_identifier(&identifier);
    print_allocation(vehicle->allocation);
    print_uncertain(&vehicle->uncertain);
    print_actuation(&actuation);
    return 0;
}
END
wide=(-std=c11 -O1 -DAUVID_MAX_PARAMETERS=32 -DAUVID_MAX_UNCERTAIN=146 -I"$ROOT/lib/include" -I.)
objects=("$ROOT"/build/wide/lib/src/*/*.o)
of_tools=("$ROOT"/build/wide/tools/auvid/vehicle/*.o
    "$ROOT"/build/wide/tools/auvid/base/{ini,json_string,report_error}.o)
check "the program's configuration, as text" "$CC" "${wide[@]}" -I"$tools" \
    -I"$ROOT/tools/simulator" -I"$ROOT/lib/src" from_program.c "${of_tools[@]}" \
    "$ROOT"/build/wide/tools/simulator/*.o "${objects[@]}" -lm -o from_program
configured() { # NAME FILE
    "$AUVID" check "$2" --header >vehicle.h
    "$CC" "${wide[@]}" -Wall -Wextra -Wconversion -Werror -DNAME="$1" from_header.c \
        "${objects[@]}" -o from_header
    ./from_header >"$1.header"
    ./from_program "$2" >"$1.program"
    [ "$(wc -l <"$1.header")" -gt 100 ] && cmp "$1.header" "$1.program"
}
cp mounted.ini inputs.ini
printf '\n[uncertain]\narm_m = 0.2\nmount_rad = 0.02\ndvl_late_s = 0.03\n' >>inputs.ini
for name in minnow:inputs.ini minnow:heavy.ini bluerov2:bluerov2 surface:surface; do
    check "$name: the header gives the same bits" configured "${name%%:*}" "${name#*:}"
done
sed 's/^\[guard\]/&\noff = altitude/' inputs.ini >deep.ini
check "what is assumed, and the limits" exits 0 check deep.ini
check "  of the DVL" grep -q 'DVL: lever arm 0.2 m, 0.03 s late' out
check "  none that is off" sh -c 'grep -q "roll at most" out && ! grep -q "the bottom" out'
guide() {
    "$AUVID" check minnow.ini --header >minnow.h
    block c >guide.c
    grep -q control_init guide.c
    echo 'int main(void) { return control_init() == AUVID_OK ? 0 : 1; }' >>guide.c
    g++ -std=c++14 -xc++ -Wall -Wextra -Werror -fsyntax-only "${wide[@]:1}" guide.c
    "$CC" "${wide[@]}" -Wall -Wextra -Werror guide.c "${objects[@]}" -o guide && ./guide
}
check "the guide's firmware starts" guide
smallest() { # NAME FILE
    local sizes
    "$AUVID" check "$2" --header >"$1.h"
    sizes=$(grep '^#error' "$1.h" | grep -o 'AUVID_[A-Z_]* [0-9]*' | sed 's/^/-D/; s/ /=/')
    sed "s/minnow/$1/g" guide.c >smallest.c
    # shellcheck disable=SC2086
    "$CC" -std=c11 $sizes -I"$ROOT/lib/include" -I. smallest.c "$ROOT"/lib/src/*/*.c -o smallest
    [[ "$sizes" == *THRUSTERS=* ]] && ./smallest
}
for name in minnow:minnow.ini bluerov2_standard:bluerov2_standard surface:surface; do
    check "${name%%:*}: the sizes that the header asks for are enough" \
        smallest "${name%%:*}" "${name#*:}"
done

# ---- on a Cortex-M4F ----
on_m4f() {
    local board=$ROOT/port/cortex_m/board.sh flags=(-std=c11 -O2 -ffp-contract=off
        -ffunction-sections -I"$ROOT/lib/include" -I"$ROOT/port/cortex_m" -I.)
    "$AUVID" check surface --header >vehicle.h
    # shellcheck disable=SC2046
    $("$board" m4f link) --specs=rdimon.specs "${flags[@]}" -DNAME=surface -o m4f.elf \
        from_header.c "$ROOT"/lib/src/*/*.c "$ROOT"/port/cortex_m/*.c
    "$board" m4f run "$PWD/m4f.elf" >surface.m4f
    cmp surface.m4f surface.header
}
if [ -n "${AUVID_TEST_LONG:-}" ]; then
    check "surface: a Cortex-M4F with the header has the same bits" on_m4f
fi
finish
