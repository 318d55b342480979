#!/usr/bin/env python3
"""Compares the last estimate in a log of frames with the truth.

usage: estimates.py SENT.log NODE.json
SENT.log has the frames sent by the firmware's example. NODE.json is the output of `auvid node
--json` for the same vehicle. Prints "rms 1.2 % of 13 parameters, largest 3.4 % (Z_w)".
"""
import json
import math
import re
import struct
import sys


def main():
    truth = {p["name"]: p["truth"] for p in json.load(open(sys.argv[2]))["parameters"]}
    estimate = {}
    for data in re.findall(r" 40C#([0-9A-F]{16})$", open(sys.argv[1]).read(), re.M):
        word, value = struct.unpack("<If", bytes.fromhex(data))
        estimate[word >> 12 & 31] = word >> 17 & 127, value  # index: number, value
    newest = max(number for number, _ in estimate.values())
    assert all(number == newest for number, _ in estimate.values()), "the last is incomplete"
    error = {name: 100 * abs(estimate[i][1] / truth[name] - 1) for i, name in enumerate(truth)}
    rms = math.sqrt(sum(e * e for e in error.values()) / len(error))
    worst = max(error, key=error.get)
    print(f"rms {rms:.2f} % of {len(error)} parameters, largest {error[worst]:.2f} % ({worst}), "
          f"estimate {newest}")


main()
