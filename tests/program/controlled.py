"""A log of a body in surge for `fit`: python3 controlled.py loop|open >log.csv.

loop: a controller of its speed, whose reference changes every 15 to 40 s. open: a pilot, whose
stick moves every 2 to 8 s. A disturbance of 4 N acts in both.
"""
import math
import random
import sys

DT, MASS, LINEAR, QUADRATIC, MOST = 0.02, 400.0, 20.0, 120.0, 100.0


def main(kind):
    rng = random.Random(1)
    u = disturbance = wanted = integral = tau = until = 0.0
    print("t_s,phi_rad,theta_rad,u_mps,v_mps,w_mps,r_radps,X_N,Y_N,Z_N,N_Nm")
    for k in range(45000):
        t = k * DT
        if t >= until:
            wanted = rng.uniform(-1, 1)
            until = t + (rng.uniform(15, 40) if kind == "loop" else rng.uniform(2, 8))
        if k % 10 == 0:
            measured = u + rng.gauss(0, 0.005)
            error = 0.5 * wanted - measured
            integral += 0.009 * MASS * error
            tau = 0.5 * MASS * error + integral if kind == "loop" else 0.8 * MOST * wanted
            tau = max(-MOST, min(MOST, tau))
            print(f"{t:.2f},0,0,{measured:.5f},0,0,0,{tau:.3f},0,0,0")
        disturbance += -disturbance * DT / 3 + 4 * math.sqrt(2 * DT / 3) * rng.gauss(0, 1)
        u += (tau + disturbance - (LINEAR + QUADRATIC * abs(u)) * u) / MASS * DT


main(sys.argv[1])
