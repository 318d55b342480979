#!/usr/bin/env bash
# Causes of a vehicle without thrusters in sway, which only its turns move there: errors that are
# small beside its thrust are not named, though they are a large part of the forces in sway.
. "$(dirname "$0")/common.sh"

cat >swim.py <<'EOF'
# A vehicle of 3 kg: surge, heave, yaw. Argument: how far the DVL is astern [m].
import math, random, sys
ARM = float(sys.argv[1])
R = random.Random(1)
M, MR = (4.7, 6.4, 7.2), 0.065
LINEAR, SQUARE = (1.5, 2.5, 2.5, 0.05), (14, 30, 35, 0.12)
THRUST = ((11, 8), (11, 8), (9, 9))
u = v = w = r = psi = 0.0
z, f, until, want = 8.0, [0.0] * 3, [0.0] * 3, [0.0] * 3
print("t_s,phi_rad,theta_rad,psi_rad,u_mps,v_mps,w_mps,p_radps,q_radps,r_radps,"
      "thruster_1,thruster_2,thruster_3")
for k in range(24000):
    t = 0.02 * k
    for i in range(3):
        if t >= until[i]:
            want[i], until[i] = R.uniform(-1, 1), t + R.choice((1.5, 3, 6))
    if z < 4 or z > 12:
        want[2] = 0.6 if z < 4 else -0.6
    cmd = [want[0] * 0.7 + want[1] * 0.3, want[0] * 0.7 - want[1] * 0.3, want[2]]
    if k % 5 == 0:
        n = lambda x, s: "%.4f" % (x + R.gauss(0, s))
        vel = [n(x, 0.005) for x in (u, v - ARM * r, w)] if k % 10 == 0 else [""] * 3
        yaw = math.remainder(psi, 2 * math.pi)
        print(",".join(["%.2f" % t, n(0, 0.005), n(0, 0.005), n(yaw, 0.004)] + vel +
                       [n(0, 0.002), n(0, 0.002), n(r, 0.002)] + ["%.4f" % c for c in cmd]))
    for i in range(3):
        c = cmd[i]
        c = 0 if abs(c) < 0.06 else math.copysign((abs(c) - 0.042) / 0.958, c)
        f[i] += (0.95 * c * abs(c) * THRUST[i][c < 0] - f[i]) * 0.02 / 0.08
    X, Z, N = f[0] + f[1], f[2], 0.09 * (f[1] - f[0])
    drag = lambda i, x: LINEAR[i] * x + SQUARE[i] * abs(x) * x
    du = (X - drag(0, u) + M[1] * v * r) / M[0]
    dv = (-drag(1, v) - M[0] * u * r) / M[1]
    dw = (Z - drag(2, w) * (1.1 if w < 0 else 1) - 0.4) / M[2]
    dr = (N - drag(3, r) - (M[1] - M[0]) * u * v) / MR
    u, v, w, r = u + 0.02 * du, v + 0.02 * dv, w + 0.02 * dw, r + 0.02 * dr
    psi, z = psi + 0.02 * r, z + 0.02 * w
EOF
{
    printf '[vehicle]\nname = small\ntitle = small\nmodel = girona500\ndry_mass_kg = 3.2\n'
    printf '[group.g]\nmap = signed-square\n'
    for thruster in '1 -0.12_0.09_0 1_0_0 11 8' '2 -0.12_-0.09_0 1_0_0 11 8' '3 0_0_0 0_0_1 9 9'; do
        # shellcheck disable=SC2086
        set -- $thruster
        printf '[thruster.%s]\nposition_m = %s\ndirection = %s\nforward_N = %s\nbackward_N = %s\n' \
            "$1" "${2//_/ }" "${3//_/ }" "$4" "$5"
        echo 'group = g'
    done
} >small.ini
python3 swim.py 0.0015 >near.csv
python3 swim.py 0.02 >far.csv
check "a log of a small vehicle" exits 0 fit near.csv --vehicle small.ini --json
check "  whose DVL is 1.5 mm astern" is out '
assert not [c for c in d["wrong_inputs"] if "DVL" in c]'
check "  most of it is identified" is out '
assert sum(p["identifiable"] for p in d["parameters"]) > 10'
check "of 20 mm" exits 0 fit far.csv --vehicle small.ini --json
check "  the DVL is named" is out '
words = "the DVL is further astern than configured, by 0.02 m"
assert [c for c in d["wrong_inputs"] if words in c]'
finish
