#!/usr/bin/env bash
# The program on a bus without a kernel with CAN: the bus in memory, logs, refusals.
. "$(dirname "$0")/common.sh"

if [ "$(uname -s)" != Linux ]; then
    echo "ok - skipped: the bus needs Linux"
    finish
fi

# ---- identification over the bus in memory, frames and all ----
check "the node identifies" exits 0 node --bus memory --excite --sets 2 --log run.log --json
cp out node.json
check "its estimate is right" is node.json '
assert all(error(n) < 0.1 for n in P), {n: error(n) for n in P}
assert d["status"] == "ok", d["status"]'
check "a BlueROV2 in six degrees of freedom is identified" \
    exits 0 node --bus memory --excite --vehicle bluerov2 --json
check "  with uncertain inputs: most is identifiable, and none of it wrong" is out '
known = [p for p in d["parameters"] if p["identifiable"]]
assert len(known) >= 15, [p["name"] for p in known]
assert all(abs(p["estimate"] / p["truth"] - 1) < 0.15 for p in known), known
assert d["wrong_inputs"] == []'
check "it has sent thruster commands" grep -q ' 042#' run.log
check "a listening node ends" exits 1 node --bus memory --sets 1 --log passive.log
check "and has sent no commands" sh -c '! grep -Eq " 04[23]#" passive.log'
check "the same seed, the same estimate" exits 0 node --bus memory --excite --sets 2 --json
check "to the last digit" cmp out node.json

held=(--closed-loop heave,yaw --sets 2)
check "a node with depth and heading held" exits 0 node --bus memory --excite --log held.log \
    --json "${held[@]}"
check "  identifies the other axes" is out '
for p in d["parameters"]:
    loop = p["note"] == "closed loop: the wrench is feedback"
    assert loop == (p["dof"] in ("heave", "yaw")) and not (loop and p["identifiable"]), p'
check "  its log replays" exits 0 replay held.log "${held[@]}"
check "  with this option only" exits 1 replay held.log --sets 2

# ---- replay ----
check "a log replays" exits 0 replay run.log --sets 2 --json
check "to the same estimate" is out '
n = json.load(open("node.json"))
assert [p["estimate"] for p in d["parameters"]] == [p["estimate"] for p in n["parameters"]]'
check "and says that all frames are the same" exits 0 replay run.log --sets 2 --csv motion.csv
check "none different" grep -Eq 'estimate frames: [1-9][0-9]* as in the log, 0 different' out
check "fit reads the motion" exits 3 fit motion.csv --json
check "and finds masses" is out '
assert all(error(n) < 0.1 for n in ("m_u", "m_v", "m_w")), {n: error(n) for n in P}'
sed -E 's/^\(([0-9.]+)\)/(\1)/; s/ memory / can7 /' run.log | awk '{ $1 = "(7.000000)"; print }' \
    >late.log
check "times of arrival do not matter" exits 0 replay late.log --sets 2
check "no frame differs" grep -q ' 0 different' out
# a lost sensor frame changes the estimate, and replay says so
awk '/ 404#/ && ++n % 50 == 0 { next } { print }' run.log >lossy.log
check "a log with frames missing differs from its estimates" exits 1 replay lossy.log --sets 2
grep -v ' 404#' run.log >no_dvl.log
check "a log without a DVL differs, too" exits 1 replay no_dvl.log --sets 2
check "  and says what never came" grep -qx \
    "  never received, but needed: dvl_bottom (or dvl_water)" out
check "by a number of frames" grep -Eq '[1-9][0-9]* different' out

# ---- wrong inputs ----
late="thrust acts later than stamped, by 0.2 s or so; check time stamps and the propellers' lag"
check "thrusters that lag are found" exits 0 \
    node --bus memory --excite --lag 0.45 --log lag.log --json
check "  and said by the vehicle, which has read it from frames" is out \
    "assert d['wrong_inputs'][0] == \"$late\", d['wrong_inputs']"
# bits 17 to 21 of a wrong_input frame: timing_delay; from bit 32 on: the size
check "  in the frames" python3 -c '
import re, struct
frames = [bytes.fromhex(data) for data in re.findall(" 414#(\w+)", open("lag.log").read())]
sizes = [struct.unpack("<f", data[4:])[0] for data in frames
         if int.from_bytes(data, "little") >> 17 & 31 == 15]
assert 0.15 < sizes[-1] < 0.25, sizes'
check "  a replay of the log finds the same" exits 0 replay lag.log --json
check "  in the same words" is out "assert d['wrong_inputs'][0] == \"$late\", d['wrong_inputs']"
check "  its frames are the same" exits 0 replay lag.log --csv lag.csv
check "  none different" grep -Eq ' as in the log, 0 different' out
check "  fit of the motion" exits 0 fit lag.csv --thrusters girona500 --json
check "  has shifted the inputs before" is out "
assert d['log']['input_shift_s'][0] > 0.1, d['log']
assert all(w.startswith('thrust ') for w in d['wrong_inputs']), d['wrong_inputs']"
check "without uncertain inputs a node" exits 0 \
    node --bus memory --excite --sets 1 --plain --log plain.log
check "  does not speak of them" sh -c '! grep -q " 41[34]#" plain.log'
check "a lag of a real vehicle" refuses 'node: --lag needs --bus memory' node --bus can0 --lag 0.4

# ---- signals ----
# ended SIGNAL: a node that excites in real time gets a signal; the last frames in its log are
# commands of zero for both halves of the thrusters.
ended() {
    local node commands status=0
    env --default-signal "$AUVID" node --bus memory --excite --sets 1 --realtime --log "$1.log" \
        >"$1.out" 2>&1 &
    node=$!
    for ((k = 0; k < 600; ++k)); do
        commands=$(grep -c ' 042#' "$1.log" 2>/dev/null)
        [ "${commands:-0}" -lt 20 ] || break
        sleep 0.1
    done
    kill -"$1" "$node"
    wait "$node" || status=$?
    grep -E ' 04[23]#' "$1.log" | tail -n 2 >"$1.last"
    cat "$1.out" "$1.last"
    [ "$status" -le 2 ] && [ "$(grep -Ec ' 04[23]#..0.0{12}$' "$1.last")" = 2 ]
}

for signal in INT TERM HUP PIPE XFSZ; do
    ended $signal >$signal.said 2>&1 && echo ended >>$signal.said &
done
wait
for signal in INT TERM HUP PIPE XFSZ; do
    check "SIG$signal ends a node that excites with a command of zero" \
        eval "cat $signal.said && grep -q ended $signal.said"
done

# ---- refusals ----
# ./filtered is the program with a real kernel that answers EPERM to socket(AF_CAN, ...), by
# seccomp; ./as_nobody is the program without privileges.
cp "$AUVID" program
cat >filtered <<'END'
#!/usr/bin/env python3
import ctypes, os, platform, struct, sys
LOAD, EQUAL, RETURN = 0x20, 0x15, 0x06  # of BPF; the number lies at 0, the argument at 16
SOCKET, AF_CAN, EPERM = {"x86_64": 41, "aarch64": 198}[platform.machine()], 29, 1
code = [(LOAD, 0, 0, 0), (EQUAL, 0, 3, SOCKET), (LOAD, 0, 0, 16), (EQUAL, 0, 1, AF_CAN),
        (RETURN, 0, 0, 0x50000 | EPERM), (RETURN, 0, 0, 0x7FFF0000)]
rules = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *line) for line in code))
program = ctypes.create_string_buffer(struct.pack("HxxxxxxP", len(code), ctypes.addressof(rules)))
libc = ctypes.CDLL(None, use_errno=True)
if libc.prctl(38, 1, 0, 0, 0) or libc.prctl(22, 2, program, 0, 0):  # NO_NEW_PRIVS, SECCOMP
    sys.exit(os.strerror(ctypes.get_errno()))
os.execv("./program", sys.argv)
END
cat >as_nobody <<'END'
#!/bin/sh
[ "$(id -u)" != 0 ] || exec setpriv --reuid 65534 --regid 65534 --clear-groups ./program "$@"
exec ./program "$@"
END
mkdir locked
chmod 755 . filtered as_nobody
chmod 555 locked

check "node without a bus" refuses 'node: no --bus given' node
check "vehicle without a bus" refuses 'vehicle: no --bus given' vehicle
check "no such interface, or no CAN" refuses 'node: .*(no interface|no CAN|nope0)' \
    node --bus nope0
AUVID=./filtered check "no permission for a socket" refuses \
    "node: no permission to open a CAN socket: run as root, or give the program CAP_NET_RAW" \
    node --bus can0
check "an interface with too long a name" refuses 'vehicle: ' \
    vehicle --bus a-name-that-is-longer-than-any
check "unknown option of node" refuses 'node: unknown option --no-arm' node --bus memory --no-arm
check "unknown option of vehicle" refuses 'vehicle: unknown option --excite' vehicle --excite
check "unknown option of replay" refuses 'replay: unknown option --bus' replay --bus=x a.log
check "another clock" refuses "'sun' is not one of bus, own" node --clock sun
check "a clock of its own in lock step" refuses 'cannot be combined' \
    node --bus can0 --clock own --lock-step
check "a log that cannot be written" refuses 'none/x.log' \
    node --bus memory --sets 1 --log none/x.log
check "a log that is a directory" refuses 'cannot create \.: Is a directory' \
    node --bus memory --sets 1 --log .
AUVID=./as_nobody check "a log in a directory of another's" \
    refuses 'cannot create locked/x.log: Permission denied' \
    node --bus memory --sets 1 --log locked/x.log
# Its reader ends after the first estimate: the report is written all the same.
half_read() {
    local status=0
    mkfifo half
    head -n 24000 half >half.log &
    sleep 0.5
    (trap '' PIPE; exec "$AUVID" node --bus memory --excite --sets 2 --log half) >half.out \
        2>half.err || status=$?
    [ "$status" = 2 ] && grep -q 'Broken pipe' half.err && grep -q '^  m_u  *kg  *2' half.out
}
check "a log that fails does not take the result away" half_read
mkfifo unread
check "a log into a pipe that nobody reads" refuses 'start the reader' \
    node --bus memory --sets 1 --log unread
check "a closed stdout is no log" sh -c '! "$0" node --bus memory --sets 1 --log c.log --json \
    >&- 2>c.err && grep -q "standard output" c.err && ! grep -q "{" c.log' "$AUVID"
check "a log that is full" refuses '/dev/full' node --bus memory --sets 1 --log /dev/full
check "no log" refuses 'replay: no FILE.log given' replay
check "a log that is not there" refuses 'none.log: No such file' replay none.log

# The prior record of one dive starts the next one.
dives() {
    "$AUVID" node --bus memory --excite --sets 2 --seed 1 --save first.avw &&
        "$AUVID" node --bus memory --excite --sets 2 --seed 2 --prior first.avw --log warm.log \
            --save second.avw &&
        [ "$(wc -c <first.avw)" = 236 ] && [ "$(wc -c <second.avw)" = 236 ] &&
        ! cmp -s first.avw second.avw && [ ! -e first.avw.new ]
} >dives.out 2>&1

# A record that cannot be used: one line says so, and the dive is made.
cold() {
    "$AUVID" node --bus memory --excite --sets 1 --seed 1 --prior "$2" >cold.out 2>cold.err || true
    [ "$(wc -l <cold.err)" = 1 ] && grep -q "$1: starting without a prior" cold.err &&
        grep -q ' m_u ' cold.out
}

check "a dive starts with the prior record of the previous one" dives
check "its log, replayed with the record, gives the same estimates" \
    exits 0 replay warm.log --seed 2 --sets 2 --prior first.avw
check "without the record it does not" exits 1 replay warm.log --seed 2 --sets 2
check "replay without its record is refused" refuses 'none.avw: No such file' \
    replay warm.log --seed 2 --sets 2 --prior none.avw
head -c 235 first.avw >short.avw
head -c 235 first.avw | tr '\0' '\1' >torn.avw
echo >>torn.avw
check "no record yet" cold 'No such file or directory' none.avw
check "a truncated record" cold 'not a prior record' short.avw
check "a damaged record" cold 'a damaged prior record' torn.avw
check "that of another vehicle is discarded, and this is told" sh -c "'$AUVID' node --bus memory \
    --excite --sets 2 --vehicle bluerov2_standard --prior first.avw 2>&1 >/dev/null |
    grep -q 'the data contradict this prior record, and it was discarded'"
check "a record that cannot be written is refused at the start" refuses \
    'cannot write none/x.avw: No such file' node --bus memory --excite --save none/x.avw
mkdir folder
check "so is a folder" refuses 'cannot write folder: Is a directory' \
    node --bus memory --excite --save folder
check "what was saved stays where the next record is not written" sh -c "cp first.avw kept.avw &&
    '$AUVID' node --bus memory --sets 1 --save kept.avw >/dev/null 2>&1; cmp first.avw kept.avw"
(cat "$ROOT/tools/auvid/vehicles/girona500.ini"
    printf '[guard]\nroll_max_rad = 0.0001\n') >level.ini
"$AUVID" node --bus memory --excite --vehicle level.ini >aborted.out
check "an early abort is the reason why nothing is identified" grep -q \
    '^nothing identified: the excitation ended after 0.0 s, .*: too much roll' aborted.out
# used PATTERN LOG: the log replays, and one line on stderr says what was ignored.
used() {
    "$AUVID" replay "$2" --sets 2 --json >used.out 2>used.err
    cat used.err
    [ "$(wc -l <used.err)" = 1 ] && grep -Eq "$1" used.err &&
        is used.out 'assert d["status"] == "ok"'
}
head -n -1 run.log >whole.log
{ cat whole.log && printf '(9999.000000) memory 404#11'; } >cut.log
check "a truncated log is used up to its last whole line" \
    used 'warning: cut.log:[0-9]+: the last line is truncated' cut.log
exits 0 replay whole.log --sets 2 --json
check "  as if the cut line were not there" same_result used.out
check "a log cut within its only line" refuses 'no frame of auvid' replay <(printf '(1.000000) ca')
# frames of other nodes on the bus
sed '5i (0.000000) memory 404##1112233\n(0.000000) memory 00000404#11\n(0.000000) memory 404#R8' \
    run.log >others.log
check "CAN FD, extended and remote frames of others are skipped" exits 0 replay others.log --sets 2
check "  no frame differs" grep -q ' 0 different' out
check "  and none is refused" grep -q ' 0 refused' out
# flips a digit of the first DVL frame's data, and doubles the second
awk '/ 404#/ { ++n } n == 1 && / 404#/ { sub(/.$/, /0$/ ? "1" : "0") } { print }
    n == 2 && / 404#/ { print; ++n }' run.log >refused.log
"$AUVID" replay refused.log --sets 2 >refused.out 2>refused.err
check "refused frames are reported" grep -Eq ' 2 refused' refused.out
causes='refused.log: 2 frames of auvid are refused: 1 with a wrong checksum, .*, 1 repeated, 0 '
check "  with their causes" grep -Eq "$causes" refused.err
"$AUVID" replay refused.log --sets 2 --json >refused.json 2>refused.err
check "  with --json, too" grep -q ': 2 frames of auvid are refused' refused.err
printf 't_s,u\n0,1\n' >other.log
check "a file of another kind" refuses 'other.log:1: is not a line of' replay other.log
printf '(1.000000) can0 123#00\n' >foreign.log
check "a log of another bus" refuses 'foreign.log: no frame of auvid' replay foreign.log
grep ' 400#' run.log | head -n 9 >tickless.log
check "a log without ticks" refuses 'tickless.log: no tick frame' replay tickless.log
: >empty.log
check "an empty log" refuses 'empty.log is empty' replay empty.log
check "a CSV that cannot be written" refuses 'none/x.csv' replay run.log --csv none/x.csv
finish
