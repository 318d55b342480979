#!/usr/bin/env bash
# auvid fit --current: a Girona500 in a constant current, whose DVL measures velocity over ground.
# Each seed has its own current and motion, with noise of the DVL. Long form: 40 seeds.
. "$(dirname "$0")/common.sh"
seeds=1
[ -n "${AUVID_TEST_LONG:-}" ] && seeds=40

# dive.py SEED FILE SPEED: writes the log, prints the current. The parameters are those of `is`, but
# weight is buoyancy.
cat >dive.py <<'END'
import math, random, sys
seed, path, speed = int(sys.argv[1]), sys.argv[2], float(sys.argv[3])
random.seed(seed)
angle = random.uniform(0, 2 * math.pi)
c = speed * math.cos(angle), speed * math.sin(angle)
columns = "t_s phi_rad theta_rad psi_rad u_mps v_mps w_mps p_radps q_radps r_radps"
mass, linear = (249.5384, 367.7126, 659.9799, 74.9024), (42.4181, 75.7673, 44.0561, 20.5833)
quadratic, largest = (125.3578, 447.6195, 325.0138, 60.9373), (150, 150, 150, 50)
with open(path, "w") as out:
    print((columns + " X_N Y_N Z_N N_Nm").replace(" ", ","), file=out)
    nu, psi, tau, until = [0.0] * 4, 0.3, [0.0] * 4, [0.0] * 4
    for k in range(10 * 240):
        for j in range(4):
            if k / 10 >= until[j]:
                until[j] = k / 10 + random.uniform(2, 8)
                tau[j] = random.uniform(-1, 1) * largest[j]
        water = (c[0] * math.cos(psi) + c[1] * math.sin(psi),
                 c[1] * math.cos(psi) - c[0] * math.sin(psi), 0, 0)
        seen = [nu[j] + water[j] + random.gauss(0, 0.01 if j < 3 else 0) for j in range(4)]
        row = [k / 10, 0, 0, math.remainder(psi, 2 * math.pi), *seen[:3], 0, 0, seen[3], *tau]
        print(",".join("%.6g" % x for x in row), file=out)
        for _ in range(10):
            u, v, w, r = nu
            turn = (mass[1] * v * r, -mass[0] * u * r, 0, (mass[0] - mass[1]) * u * v)
            for j in range(4):
                drag = linear[j] * nu[j] + quadratic[j] * abs(nu[j]) * nu[j]
                nu[j] += 0.01 * (tau[j] + turn[j] - drag) / mass[j]
            psi += 0.01 * nu[3]
print(*c)
END
for seed in $(seq $seeds); do
    python3 dive.py "$seed" "$seed.csv" 0.25 >"$seed.truth"
    "$AUVID" fit "$seed.csv" --plain --current --fix W-B=0 --json >"$seed.json" 2>/dev/null
    "$AUVID" fit "$seed.csv" --plain --fix W-B=0 --coupling on --json >"$seed.still" 2>/dev/null
done
check "a current of 0.25 m/s within 3 mm/s, and masses within 4 %, in $seeds dives" \
    python3 - "$seeds" <<'END'
import json, sys
mass = {"m_u": 249.5384, "m_v": 367.7126, "m_w": 659.9799, "m_r": 74.9024}
current, covered, masses, still = [], 0, [], []
for seed in range(1, int(sys.argv[1]) + 1):
    truth = [float(x) for x in open("%d.truth" % seed).read().split()]
    d, without = json.load(open("%d.json" % seed)), json.load(open("%d.still" % seed))
    P, S = ({p["name"]: p for p in x["parameters"]} for x in (d, without))
    assert d["status"] == "ok" and d["parameters"][-1]["unit"] == "m/s", d["status"]
    for name, true in zip(("c_north", "c_east"), truth):
        current.append(abs(P[name]["estimate"] - true))
        covered += current[-1] <= P[name]["half_width"]
        assert P[name]["identifiable"] or abs(true) < 0.02, P[name]
    masses += [abs(P[n]["estimate"] / mass[n] - 1) for n in mass]
    still += [abs(S[n]["estimate"] / mass[n] - 1) for n in mass]
print("largest error of the current %.4f m/s, %d of %d within 95 %%; of a mass %.1f %%, without "
      "--current %.1f %%" % (max(current), covered, len(current), 100 * max(masses),
                             100 * max(still)))
assert max(current) < 0.003 and max(masses) < 0.04 < max(still)
END
sed 's/^/# /' check.log
check "the current in words" sh -c "'$AUVID' fit 1.csv --plain --current --fix W-B=0 >words &&
    grep -Eq '^  current  0\.2[45].* m/s, flows towards [0-9]+ degrees' words"
python3 dive.py 5 calm.csv 0 >/dev/null
check "without a current" exits 0 fit calm.csv --plain --current --fix W-B=0 --json
check "  it is zero within its interval" is out 'assert all(abs(P[n]["estimate"]) <
    1.5 * P[n]["half_width"] < 0.01 for n in ("c_north", "c_east")), P'
python3 dive.py 1 first.csv 0.25 >/dev/null
sed '2,1200d' first.csv >second.csv
check "the current is part of the prediction of another run" exits 0 fit first.csv \
    --validate second.csv --plain --current --fix W-B=0 --json
check "  and makes it right" is out 'assert min(d["r2_validation"][k] for k in "uv") > 0.97, \
    d["r2_validation"]'
cut -d, -f1-3,5- 1.csv >heading.csv
check "no heading" rejects 'heading.csv:1:1: no column psi_rad in the header: --current needs the' \
    fit heading.csv --plain --current
check "with thrusters" refuses '--current needs --plain' fit 1.csv --current --thrusters girona500
check "a model without room for it" refuses 'model Fossen, 6 DoF has [0-9]+ already, .* room for' \
    fit 1.csv --model fossen --plain --current
sed 's/^name = .*/&\nfast = yes/' "$ROOT/tools/auvid/vehicles/surface.ini" >craft.ini
check "a vehicle file with a table of terms, faster than its DVL" exits 0 fit 1.csv \
    --vehicle craft.ini --plain --current --json
check "  has a current within 1 cm/s" is out '
truth = dict(zip(("c_north", "c_east"), open("1.truth").read().split()))
assert all(abs(P[n]["estimate"] - float(x)) < 0.01 for n, x in truth.items()), P'
finish
