#!/usr/bin/env bash
# Figures of campaigns in the documentation. Long form: runs the command of each figure and compares
# its output. Short form: checks that the figures and commands are in the expected places.
. "$(dirname "$0")/common.sh"

cat >figures.py <<'END'
import json, os, re, subprocess, sys
root, auvid, what = sys.argv[1:]
LONG = bool(os.environ.get("AUVID_TEST_LONG"))
NUMBER, SIGNED, INTERVAL = r"([\d.]+)", r"([-+][\d.]+)", r"([\d.]+) \[([\d.]+), ([\d.]+)\]"
FIGURE = r"([\d.]+) % \[([\d.]+), ([\d.]+)\]"


def document(name):
    """The text in one line, without the stars of a comment."""
    return re.sub(r"\s+", " ", re.sub(r"\n \* ", " ", open(os.path.join(root, name)).read()))


def stated(text, pattern):
    """The numbers that a pattern finds. It must occur once."""
    found = re.findall(pattern, text)
    assert len(found) == 1, (len(found), pattern)
    return [float(x) for x in (found[0] if isinstance(found[0], tuple) else found)]


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, cwd=root)
    print(" ".join(command), "exit status", done.returncode)
    assert done.returncode in (0, 1), done.stderr[-500:]
    return done.stdout


def program(name, pattern, text):
    """Runs the long form of a test program named in the text; returns the matches in its output."""
    assert name in text
    if not LONG:
        return None
    out = run(os.path.join(root, name))
    assert re.search(r"\d+ Tests 0 Failures", out), out[-500:]
    return [[float(x) for x in line] for line in re.findall(pattern, out)]


def demo(disturbance, *options):
    return json.loads(run(auvid, "demo", "--runs", "200", "--disturbance", disturbance, "--json",
                          "--thrust-scale", "0", "--dvl-scale", "0", "--delay", "0",
                          *options))


def accuracy():
    """README: rms errors of 200 runs, each within its interval."""
    text = document("README.md")
    assert "build/auvid demo --runs 200 --disturbance 1 [--lag 0.15] [--literal]" in text
    off = stated(text, rf"Of these, {NUMBER}, {NUMBER} and {NUMBER} are more than 20 % off "
                       rf"\({NUMBER} with")
    few = stated(text, rf"No run failed, .*?`--literal`: {NUMBER} to {NUMBER} of 200")
    known = [100, 100, *stated(text, "all 2600 parameters identifiable without disturbance and "
                                     rf"at 1 N, and {NUMBER} % at 3 N")]
    for k, (name, newtons) in enumerate((("none", "0"), ("1 N", "1"), ("3 N", "3"))):
        row = stated(text, rf"\| {name} \| {FIGURE} \| {FIGURE} \| {FIGURE} \| {NUMBER} % \|")
        if not LONG:
            continue
        plain, lag = demo(newtons), demo(newtons, "--lag", "0.15")
        literal = demo(newtons, "--literal")
        for d, (_, low, high) in zip((plain, lag, literal), (row[0:3], row[3:6], row[6:9])):
            print(name, d["rms_percent"], d["failed"], d["identifiable"], d["identifiable_wrong"])
            assert low <= d["rms_percent"] <= high
        print("last set only", literal["last_set"]["rms_percent"])
        assert abs(literal["last_set"]["rms_percent"] - row[9]) <= 0.5
        assert plain["failed"] == lag["failed"] == 0 and few[0] <= literal["failed"] <= few[1]
        assert round(100 * plain["identifiable"] / 2600) == known[k]
        assert plain["identifiable_wrong"] == off[k]
        assert name != "3 N" or lag["identifiable_wrong"] == off[3]


def field():
    """README: flags in the field; of other seeds, and the intervals of wrong flags overlap."""
    text = document("README.md")
    pair = rf"{NUMBER} % \| {FIGURE}"
    for options in ("--field 0.5", "--field 1", "--field 2",
                    "--field 2 --mismatch thrust_common=0 --mismatch thrust_each=0",
                    "--field 1 --plain", "--field 1 --driver joystick",
                    "--field 1 --mismatch thrust_shapes=1"):
        shown = options + " --runs 1200 --seed 940001" * ("--field 2" in options)
        row = stated(text, rf"\| `{shown}` \| {pair} \| {pair} \| {pair} \|")
        for vehicle, (flagged, _, low, high) in (("girona500", row[:4]), ("rov20", row[4:8]),
                                                 ("any", row[8:])):
            if LONG:
                d = json.loads(run(auvid, "demo", *options.split(), "--vehicle", vehicle, "--runs",
                                   "400", "--seed", "600001", "--json"))
                found, wrong = 100 * d["flagged"]["all"]["value"], d["wrong"]["all"]
                print(options, vehicle, found, wrong)
                assert abs(found - flagged) < 3
                assert low <= 100 * wrong["high"] and 100 * wrong["low"] <= high


def frames():
    """lib/can/README.md: what the frames cost, within its interval."""
    text = document("lib/can/README.md")
    change = stated(text, rf"error with frames differs by {SIGNED}, {SIGNED}, {SIGNED} %")
    half = stated(text, rf"% \(\+- {NUMBER}, {NUMBER}, {NUMBER}\)")
    found = program("build/release/tests/unit/can/test_can_accuracy",
                    rf"N, 200 seeds, .* mean square {SIGNED} % \(\+- {NUMBER}\)",
                    text)
    assert not LONG or len(found) == 3
    for (value, _), middle, width in zip(found or [], change, half):
        print(value, middle, width)
        assert abs(value - middle) <= width


def current():
    """lib/README.md, CHANGELOG.md: the error in a current over that in still water."""
    text = document("lib/README.md")
    times = stated(document("CHANGELOG.md"), rf"is {NUMBER} times that in still water")
    rows = [stated(text, rf"\| {name} \| {NUMBER} % \| {INTERVAL} \| {INTERVAL} \| {NUMBER} mm/s")
            for name in ("none", "1 N", "3 N")]
    found = program("build/wide/tests/vehicles/test_current",
                    rf"{NUMBER} N, 100 seeds, .* m/s: {NUMBER} % .* of the current: {NUMBER} mm/s.*"
                    rf"\n  over .*: {NUMBER} \[.*\n  over .*: {NUMBER} \[", text)
    assert not LONG or len(found) == 3
    for newtons, rms, speed, hull, same in found or []:
        row = rows[{0: 0, 1: 1, 3: 2}[newtons]]
        print(newtons, rms, speed, hull, same)
        assert abs(rms / row[0] - 1) < 0.1 and abs(speed / row[7] - 1) < 0.1
        assert row[2] <= hull <= row[3] and row[5] <= same <= row[6]
    assert min(row[1] for row in rows) <= times[0] <= max(row[1] for row in rows)


def guard():
    """guard.h: the largest overshoot."""
    text = document("lib/include/auvid/guard.h")
    worlds, part = stated(text, rf"In {NUMBER} worlds of the test .*? was {NUMBER} of what they")
    assert "build/release/tests/unit/excitation/test_guard_runs" in text
    if LONG:
        out = run(os.path.join(root, "build/release/tests/unit/excitation/test_guard_runs"))
        assert int(re.search(r"(\d+) runs, \d+ excited", out)[1]) == worlds
        found = [float(x) for x in re.findall(r"largest overshoot (-?[\d.]+) of what", out)]
        print(found)
        assert max(found) == part


{"accuracy": accuracy, "field": field, "frames": frames, "current": current, "guard": guard}[what]()
END
check "README: accuracy" python3 figures.py "$ROOT" "$AUVID" accuracy
check "README: in the field" python3 figures.py "$ROOT" "$AUVID" field
check "lib/can/README.md: what the frames cost" python3 figures.py "$ROOT" "$AUVID" frames
check "lib/README.md, CHANGELOG.md: in a current" python3 figures.py "$ROOT" "$AUVID" current
check "guard.h: the largest overshoot" python3 figures.py "$ROOT" "$AUVID" guard
finish
