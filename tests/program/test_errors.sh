#!/usr/bin/env bash
# Refused input: exit 2, one line on stderr that names the place, nothing on stdout.
. "$(dirname "$0")/common.sh"

# ---- usage ----
check "no command" refuses 'no command'
check "unknown command" refuses "unknown command 'fly'" fly
check "unknown option of demo" refuses 'demo: unknown option --bias' demo --bias
check "unknown option of fit" refuses 'fit: unknown option --runs' fit x.csv --runs=3
check "unexpected argument" refuses "demo: unexpected argument 'x'" demo x
check "no training log" refuses 'fit: no TRAIN.csv' fit --json
# shellcheck disable=SC2046
check "more training logs than it takes" refuses "unexpected argument 'x.csv'" fit \
    $(printf 'x.csv %.0s' $(seq 65))
check "a missing value" refuses -- '--seed needs a value' demo --seed
check "an empty value" refuses -- '--csv needs a value' demo --csv=
check "a flag with a value" refuses -- '--json takes no value' demo --json=yes
for bad in -1 1.5 x 99999999999999999999 0x10 ' 1' ''; do
    check "--seed '$bad'" refuses -- '--seed' demo "--seed=$bad"
done
check "--seed of 64 bits is taken" exits 0 demo --json --sets 1 --seed 18446744073709551615
for bad in -1 nan inf 1e99 1x; do
    check "--disturbance $bad" refuses -- '--disturbance' demo "--disturbance=$bad"
    check "--lag $bad" refuses -- '--lag' demo "--lag=$bad"
done
for bad in 0 -1 1001 1.5; do
    check "--sets $bad" refuses -- '--sets' demo "--sets=$bad"
done
check "--runs 0" refuses -- '--runs' demo --runs 0
check "an unknown scenario" refuses "'storm' is not one of payload, heave" demo --scenario storm
for other in "--runs 3" "--sets 4" "--csv x.csv" --literal --adaptive; do
    # shellcheck disable=SC2086
    check "--scenario with $other" refuses -- "--scenario and ${other%% *} cannot be combined" \
        demo --scenario payload $other
done
check "--adaptive with --literal" refuses -- '--adaptive and --literal' demo --adaptive --literal
check "--adaptive for too long" refuses -- 'takes at most 120 sets' demo --adaptive --sets 121
for bad in 1 1, ,1 1,2,3 a,b nan,1 -inf,inf -1e9,1 '1;2'; do
    check "--bounds=$bad" refuses 'is not LO,HI' fit x.csv "--bounds=$bad"
done
check "--bounds reversed" refuses 'lower bound is not below' fit x.csv --bounds=1,-1
check "--bounds of no width" refuses 'lower bound is not below' fit x.csv --bounds=1,1
check "--input of another kind" refuses "'cubic' is not one of hold, linear" fit x.csv --input cubic
check "an unknown vehicle" refuses "'rov' is not one of girona500, bluerov2" demo --vehicle rov
check "--scenario with another vehicle" refuses -- '--scenario and --vehicle cannot be combined' \
    demo --vehicle bluerov2 --scenario payload
check "an unknown model" refuses "'x' is not one of girona500, fossen" fit x.csv --model x
check "--coupling off of another model" refuses '--coupling off needs the model of' \
    fit x.csv --model surface --coupling off
check "--fix without a value" refuses "'K_p' is not NAME=VALUE" fit x.csv --fix K_p
check "--free with a value" refuses "'K_p=1' is not NAME,NAME" fit x.csv --free K_p=1
for bad in X_u= X_u=x X_u=nan X_u=1e9 X_u=1x; do
    check "--fix $bad" refuses 'is not a number within' fit x.csv "--fix=$bad"
done
check "--fix of an unknown parameter" refuses "'K_p' is not a parameter of the model Girona500" \
    fit x.csv --fix K_p=0
check "--free of an unknown parameter" refuses "'' is not a parameter" fit x.csv --free X_0,,Y_0
check "--coupling of another kind" refuses "'no' is not one of auto, on, off" \
    fit x.csv --coupling no

# ---- logs ----
header=t_s,u_mps,X_N
log() { printf '%s\n' "$@" >log.csv; }
check "no such file" rejects 'none.csv: No such file' fit none.csv
check "a directory" rejects '\.: Is a directory' fit .
: >log.csv
check "empty file" rejects 'log.csv:1:1: the file is empty' fit log.csv
printf '\n\n' >log.csv
check "nothing but empty lines" rejects 'log.csv:1:1: the file is empty' fit log.csv
log '# my dive' '# in the pool'
check "nothing but comments" rejects 'log.csv:2:1: no header after the comments' fit log.csv
log '# my dive' '# t, in s' t_s,u_mps,X_N 0,0,0 0.1,fast,0
check "comments count as lines" rejects "log.csv:5:5: u_mps: 'fast' is not a number" fit log.csv
check "  of check, too" refuses "log.csv:5:5: u_mps: 'fast' is not a number" check log.csv
log "$header"
check "a header and no row" rejects 'log.csv:1:1: no row after the header' fit log.csv
log "$header" 0,0,0
check "one row" rejects 'log.csv:2:1: only one row' fit log.csv
log u_mps,X_N 0,0 1,1
check "no column t_s" rejects \
    'log.csv:1:1: no column t_s .*auvid-log --map .*; its columns are: u_mps, X_N$' fit log.csv
log t,u_mps,X_N 0,0,0 1,1,1
check "  one that resembles it is named" rejects 'no column t_s .*; t resembles it$' fit log.csv
log 't_s;u_mps;X_N' '0;0;0' '0.1;0;0'
check "semicolons between the columns" rejects \
    'log.csv:1:1: no column t_s .*separated by semicolons; separate them by commas$' fit log.csv
log 't_s;u_mps;X_N' '0,0;0;0' '0,1;0;0'
check "  and decimal commas in the numbers" rejects \
    'separated by semicolons, its numbers have decimal commas: write points, then' fit log.csv
log "$(printf 't_s\tu_mps\tX_N')" "$(printf '0\t0\t0')"
check "tabs between the columns" rejects \
    'no column t_s .*separated by tabs; .*by commas' fit log.csv
log "u_mps,$(seq -s , 1 400)" 0 1
check "a list of many columns is cut" rejects \
    'its columns are: u_mps, 1, 2, .*, \.\.\.$' fit log.csv
log t_s,X_N 0,0 1,1
check "a force without its velocity" rejects \
    'log.csv:1:1: no column u_mps in the header, but X_N: ' fit log.csv
log t_s,u_ms,X_N 0,0,0 1,1,1
check "  a column that resembles it is named" rejects 'but X_N: .*; u_ms resembles it$' fit log.csv
log t_s,r_degps,N_Nm 0,0,0 1,1,1
check "  and is in degrees" rejects '; r_degps resembles it, but is in degrees$' fit log.csv
for other in 'u_mps [m/s]' 'U_MPS' 'u'; do
    log "t_s,$other,X_N" 0,0,0 1,1,1
    check "  so is '$other'" rejects ' resembles it$' fit log.csv
done
for other in v_mps x_m speed; do
    log "t_s,$other,X_N" 0,0,0 1,1,1
    check "  but not $other" rejects "X_N: [^;]*$" fit log.csv
done
log t_s,u_mps,N_Nm 0,0,0 1,1,1
check "a moment without its rate" rejects 'log.csv:1:1: no column r_radps in the header, but N_Nm' \
    fit log.csv
log t_s,u_mps,X_N,K_Nm 0,0,0,0 1,1,1,1
check "  in roll, too, where the model has it" rejects 'no column p_radps in the header, but K_Nm' \
    fit log.csv --model fossen
check "  and not where it has none" exits 3 fit log.csv
log t_s,u_mps,cmd_surge,cmd_yaw 0,0,0,0 1,1,1,1
check "a command without its rate" rejects \
    'no column r_radps in the header, but cmd_yaw' fit log.csv
log t_s,u_mps 0,0 1,1
check "no input column" rejects 'log.csv:1:1: no input column' fit log.csv
check "  the message names those of six degrees of freedom" \
    rejects ' Z_N K_Nm M_Nm N_Nm, .* cmd_roll cmd_pitch cmd_yaw' fit log.csv --model fossen
log t_s,u_mps,X_N,u_mps 0,0,0,0 1,1,1,1
check "a second column of the same name" rejects 'log.csv:1:15: duplicate column u_mps' fit log.csv
log "$header" 0,0,0 0.1,fast,0 0.2,0,0
check "text in a number" rejects "log.csv:3:5: u_mps: 'fast' is not a number" fit log.csv
log t_s,u_mps,X_N 2026-05-01T12:00:00.25Z,0,0 2026-05-01T12:00:01Z,0,0
check "a date in t_s" rejects 'log.csv:2:1: t_s: .* is a date, .*: auvid-log --map converts it' \
    fit log.csv
log t_s,u_mps,X_N 0,0, 0,,1 0.1,1,
check "rows of one time that fill different columns" rejects \
    "log.csv:3:1: t_s: '0' is that of the row before, .* other columns: merge the rows of one" \
    fit log.csv
log "$header" 0,0,0 0.1,0,1.2.3
check "two points in a number" rejects "log.csv:3:7: X_N: '1.2.3' is not a number" fit log.csv
log "$header" 0,0,0 0.1,0,1e5N
check "a unit after a number" rejects "log.csv:3:7: X_N: '1e5N' is not a number" fit log.csv
log "$header" 0,0,0 0.1,0,0x10
check "a hexadecimal number" rejects "log.csv:3:7: X_N: '0x10' is not a number" fit log.csv
for bad in nan NaN inf -inf Infinity 1e999; do
    log "$header" 0,0,0 "0.1,$bad,0"
    check "$bad" rejects "log.csv:3:5: u_mps: '$bad' is not a finite number" fit log.csv
done
log "$header" 0,0,0 ,0,0
check "an empty time" rejects "log.csv:3:1: t_s: '' is empty" fit log.csv
log "$header" 0,,0 0.1,,0
check "a column that is empty in all rows" rejects \
    'log.csv:1:1: the column u_mps has no value in any row' fit log.csv
log "$header" 0,0,0 0.1,2e6,0
check "a value that is too large" rejects 'log.csv:3:5: u_mps: .* beyond' fit log.csv
log "$header" 0,0,0 nan,0,0
check "a time that is not finite" rejects 'log.csv:3:1: t_s: .*not a finite' fit log.csv
log "$header" 0,0,0 0.2,0,0 0.1,0,0
check "time that goes back" rejects \
    "log.csv:4:1: t_s: '0.1' goes back: sort the rows by time, or split the log here$" fit log.csv
log "$header" 50,0,0 50.1,0,0 0.1,0,0 0.2,0,0
check "a clock that is set back" rejects \
    "log.csv:4:1: t_s: '0.1' goes back by more than a second: split the log here$" fit log.csv
log u_mps,t_s,X_N 0,0,0 0,0.2,0 0,0.2,0
check "time that stands still" rejects \
    "log.csv:4:3: t_s: '0.2' does not advance: remove repeated rows, or log more digits" fit log.csv
log "$header" 0,0,0 2e9,0,0
check "a gap of decades" rejects "log.csv:3:1: t_s: '2e9' is more than 1e9 s" fit log.csv
log "$header" 0,0,0 0.1,0 0.2,0,0
check "a row too short" rejects 'log.csv:3:6: the row ends after 2 of 3 columns' fit log.csv
log "$header" 0,0,0 0.1,0,0,0
check "a row too long" rejects 'log.csv:3:9: the row has more than 3 columns' fit log.csv
log "$header" 0,0,0 '' 0.1,x,0
check "empty lines count as lines" rejects 'log.csv:4:5: u_mps' fit log.csv
printf '%s\n0,0,0\n0.1,0\0,0\n' "$header" >log.csv
check "a binary file" rejects 'log.csv: not a text file' fit log.csv
log "$header" 0,0,0 "$(printf '0.1,a\033[31m,0')"
check "control characters do not reach the terminal" rejects "'a\?\[31m'" fit log.csv

# ---- forms of a log ----
q=t_s,qw,qx,qy,qz,u_mps,X_N
log $q 0,1,0,0,0,0,0 0.1,2,0,0,0,1,1
check "a quaternion of a norm far from 1" rejects \
    'log.csv:3:1: the quaternion qw qx qy qz has the norm 2, not 1' fit log.csv
log $q 0,1,0,0,0,0,0 0.1,1,0,,0,1,1
check "a quaternion with an empty part" rejects 'log.csv:3:1: the quaternion is incomplete' \
    fit log.csv
log t_s,qw,qx,qz,u_mps,X_N 0,1,0,0,0,0 0.1,1,0,0,1,1
check "a quaternion without a part" rejects 'no column qy in the header: a quaternion needs' \
    fit log.csv
log t_s,u_mps,thruster_1,thruster_2 0,0,0,0 0.1,1,1,1
check "thrusters of an unknown vehicle" rejects \
    'log.csv:1:1: the inputs are those of thrusters: name their vehicle' fit log.csv
check "a thruster is missing" rejects 'no column thruster_3 in the header: girona500 has 5' \
    fit log.csv --thrusters girona500
v=t_s,u_mps,v_mps,w_mps,r_radps
throttle=thruster_1,thruster_2,thruster_3,thruster_4,thruster_5
log "$v,$throttle,thruster_6" 0,0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,1,1,1,1,1,1
check "a thruster too many" rejects 'there is a column thruster_6: girona500 has 5 thrusters' \
    fit log.csv --thrusters girona500
check "  check refuses it, too" refuses 'there is a column thruster_6: girona500 has 5 thrusters' \
    check log.csv --vehicle girona500
log "$v,${throttle//,/_N,}_N" 0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,1,1,1,1,1
check "commands in the columns of newtons" rejects \
    'largest force of a thruster is 1 N, .* up to 154 N: are the columns .* in newtons' \
    fit log.csv --thrusters girona500
sed 's/^forward_N = .*/forward_N = 5/' "$ROOT/tools/auvid/vehicles/girona500.ini" >astern.ini
log "$v,${throttle//,/_N,}_N" 0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,-90,1,1,1,1
check "forces astern of thrusters that are stronger there" exits 3 \
    fit log.csv --vehicle astern.ini
log "$v,$throttle" 0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,90,1,1,1,1
check "newtons in the columns of commands" rejects 'give zero_command and full_command of' \
    fit log.csv --thrusters girona500
log "$v,$throttle" 0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,1.2,1,1,1,1
check "commands beyond the full one" rejects \
    'is 221 N, but those of girona500 have up to 154 N: correct full_command, or forward_N and' \
    fit log.csv --thrusters girona500
check "  are an error of check, too" exits 1 check log.csv --vehicle girona500
sed 's/^map = .*/map = signed-square\nvoltage_V = 16\nvoltage_exponent = 2/' \
    "$ROOT/tools/auvid/vehicles/girona500.ini" >full.ini
check "  but a full battery may give such a force" exits 3 fit log.csv --vehicle full.ini
log "$v,$throttle" 0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,1.03,1,1,1,1
check "a full command with noise" exits 3 fit log.csv --thrusters girona500
log "$v,${throttle//,/_N,}_N" 0,0,0,0,0,0,0,0,0,0 1,1,1,1,1,180,1,1,1,1
check "newtons beyond the vehicle's" rejects \
    'is 180 N, but .* up to 154 N: correct forward_N and backward_N in the vehicle file, or' \
    fit log.csv --thrusters girona500
log "${v%,*},$throttle" 0,0,0,0,0,0,0,0,0 1,1,1,1,1,1,1,1,1
check "thrusters without a rate" rejects 'no column r_radps in the header, but the thrusters: a' \
    fit log.csv --thrusters girona500
printf '%s\n0,0,0\n0.1,%070000d,0\n' "$header" 0 >log.csv
check "a line of 70 KB" rejects 'log.csv:3:1: the line is longer than 65535 characters' fit log.csv
printf '%s\n0,0,0\n' "$header" >good.csv
log "$header" 0,0,0 1,1,1
check "a second training log is read as strictly" rejects 'good.csv:2:1: only one row' \
    fit log.csv good.csv
{ cat log.csv && echo 2,1,1; } >more.csv
check "and a third that is missing" rejects "none.csv: No such file" fit log.csv more.csv none.csv
for bad in surge surge= surge=x surge=0 surge=-1 surge=nan =5 north=5; do
    check "--gain $bad" refuses 'is not AXIS=NEWTONS' fit log.csv "--gain=$bad"
done
for bad in jaw heave, heave,yaw, 4; do
    check "--closed-loop '$bad'" refuses 'is not AXIS,AXIS' fit log.csv "--closed-loop=$bad"
    check "--open-loop '$bad'" refuses 'is not AXIS,AXIS' fit log.csv "--open-loop=$bad"
done
check "one axis in both loops" refuses 'not both' fit log.csv --open-loop surge,yaw \
    --closed-loop yaw
for bad in 0 0.05 2 x; do
    check "--max-gap $bad" refuses "--max-gap: '$bad' is .* from 0.1 to 1$" \
        fit log.csv --max-gap $bad
done
"$AUVID" demo --json --sets 1 --csv good.csv >/dev/null
check "a dry mass above the bounds" rejects \
    'the dry mass, 300 kg, is not below the upper bound of the masses, 200: widen --bounds' \
    fit good.csv --dry-mass 300 --bounds=-200,200
log t_s,u_mps,X_N 0,0,0 0.1,x,0
check "an error in the test log names it" rejects 'log.csv:3:5: u_mps' \
    fit good.csv --validate log.csv
check "no such test log" rejects 'none.csv: No such file' fit good.csv --validate none.csv
# as_json STATUS ARGUMENTS...: stdout is an object with the line of stderr.
as_json() {
    exits "$@" --json && [ "$(wc -l <err)" = 1 ] && python3 -c '
import json
d = json.load(open("out"))
assert sorted(d) == ["error", "version"] and "auvid: " + d["error"] + "\n" == open("err").read(), d'
}
check "a log that is refused, as JSON" as_json 1 fit log.csv
check "  of two" as_json 1 fit good.csv --validate log.csv
check "  by check" as_json 2 check log.csv
check "  by replay" as_json 2 replay log.csv
check "  which is not there" as_json 2 replay none.log
check "a vehicle that is refused, as JSON" as_json 2 check none.ini
check "an option of a log that is refused, as JSON" as_json 2 fit good.csv --fix m_x=1
full() {
    ! "$AUVID" "$@" >/dev/full 2>err && [ "$(wc -l <err)" = 1 ] && grep -q 'standard output' err
}
check "standard output that is full" full fit good.csv --json

check "--help" exits 0 --help
check "  names the options" grep -q -- '--disturbance' out
cp out help
exits 0 help
check "help is the same" cmp out help
for command in demo fit check node vehicle replay; do
    check "help $command" exits 0 help "$command"
    check "  shows its usage" grep -q "^usage: auvid $command " out
    check "  and its options only" test "$(grep -c "^options of .*$command" out)" = \
        "$(grep -c '^options of ' out)"
    cp out of_command
    exits 0 "$command" --help
    check "$command --help is the same" cmp out of_command
    # every line that is in it is a line of the whole help
    check "  part of the whole" test -z "$(sed 's/^usage: /       /' out | grep -vxF -f help |
        grep -v "^       auvid $command")"
done
check "help fit lists the columns" grep -q '^columns of a log' <("$AUVID" help fit)
check "help of an unknown command" refuses "help: unknown command 'fly': use .*demo" help fly
check "help of two commands" refuses "help: unexpected argument 'fit'" help demo fit
check "--version" exits 0 --version
version=$(sed -n 's/#define AUVID_VERSION_STRING "\(.*\)"/\1/p' "$ROOT/lib/include/auvid/config.h")
check "  is that of the library" grep -qx "auvid $version" out
finish
