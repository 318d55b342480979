#!/usr/bin/env python3
"""The files of the passive examples' driver, port/cortex_m/passive/driver_qemu.c.

usage: passive.py log CSV >dive.log
       passive.py error estimates.log JSON
log: from the CSV of `auvid demo --csv`. The DVL measures every tenth row, depth every fifth; depth
is the integral of w. error: compares the last estimate with the truth of `auvid demo --json`; exit
status 1 if the rms error exceeds 3 %, or a standard error is not positive.
"""
import array
import csv
import json
import math
import struct
import sys


def write_log(path):
    with open(path, newline="") as file:
        rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    depth_m = 5.0
    for number, row in enumerate(rows):
        depth_m += 0.02 * row[6]
        sensors = (number % 10 == 0) + 2 * (number % 5 == 0)
        sys.stdout.buffer.write(struct.pack("<17f", *row[1:16], depth_m, sensors))


def error(log, path):
    truth = [p["truth"] for p in json.load(open(path))["parameters"]]
    numbers = array.array("f", open(log, "rb").read())
    size = 17  # AUVID_MAX_PARAMETERS
    last, sigma = numbers[-2 * size:-size], numbers[-size:]
    rms = math.sqrt(sum((e / t - 1) ** 2 for e, t in zip(last, truth)) / len(truth))
    print(f"{len(numbers) // (2 * size)} estimates, rms error of the last {100 * rms:.2f} % of "
          f"{len(truth)} parameters")
    return not (rms < 0.03 and min(sigma[:len(truth)]) > 0)


if sys.argv[1] == "log":
    write_log(sys.argv[2])
else:
    sys.exit(error(*sys.argv[2:]))
