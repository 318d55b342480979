#!/usr/bin/env python3
"""The golden vector of a result that the program printed, compared with the file of that name here.

usage: golden.py NAME RESULT.json [BUS.log]
RESULT.json is what `auvid fit --json` or `auvid replay --json` printed; BUS.log is a log of the bus
whose order of frames is part of the vector. GOLDEN=write in the environment writes the file.
The words in the file stay when a key of the JSON gets another name: those are all in vector().
"""
import json
import os
import pathlib
import re
import struct
import sys
import zlib

TICK_US, TICKS = 20000, 250


def real(x):
    """A float as hexadecimal, as golden.h has it."""
    if x is None:
        return "unknown"
    text = struct.unpack("f", struct.pack("f", x))[0].hex()
    return re.sub(r"\.?0*p", "p", text)


def dofs(numbers):
    """The values of an object by degree of freedom, from surge to yaw."""
    return [numbers[k] for k in sorted(numbers, key="XYZKMNuvwpqr".index)]


def vector(d):
    """What is recorded of the JSON: numbers and flags, no text."""
    yield f"seed {d['seed']}"
    yield "evaluations {crs} {line_search}".format(**d["evaluations"])
    yield "work {limit} {worst}".format(**d["budget"])
    for i, p in enumerate(d["parameters"]):
        yield (f"parameter {i} value {real(p['estimate'])} sigma {real(p['sigma'])} "
               f"sigma_as_told {real(p['sigma_told'])} thrust_scale {real(p['thrust_error'])} "
               f"dvl_scale {real(p['dvl_error'])} identifiable {p['identifiable']:d} "
               f"note {p['note'] != '':d}")
    yield f"missing {len(d['missing'])}"
    for key, word in ("delay_s", "delay"), ("r2_force", "r2"), ("r2_validation", "r2_validation"):
        yield " ".join([word, *map(real, dofs(d[key]))])
    for j, points in enumerate(dofs(d["drag"])):
        for p in points:
            yield (f"drag {j} speed {real(p['speed'])} force {real(p['force'])} "
                   f"half_width {real(p['half_width'])} identifiable {p['identifiable']:d}")
    test = d["change_test"]
    if test is not None:
        yield f"change_test set {test['set']} estimate {test['estimate']}"
        for key, word in (("variance_ratio",) * 2, ("change", "statistic"), ("r2_velocity",) * 2):
            yield " ".join([f"change_test {word}", *map(real, dofs(test[key]))])


def schedule(log):
    """The order of frames: identifier and tick, a hash for each 5 s; their counts."""
    frames = re.findall(r"^\((\d+)\.(\d{6})\) \S+ ([0-9A-F]{3})#", open(log).read(), re.M)
    begin, count, span, at = None, {}, 0, 0
    for seconds, us, kind in frames:
        t_us = int(seconds) * 1000000 + int(us)
        begin = t_us if begin is None else begin
        tick = (t_us - begin) // TICK_US
        if tick // TICKS != at:
            yield f"tick {(at + 1) * TICKS} frames {span:08x}"
            span, at = 0, tick // TICKS
        span = zlib.crc32(f"{tick} {kind}\n".encode(), span)
        count[kind] = count.get(kind, 0) + 1
    yield f"tick {(at + 1) * TICKS} frames {span:08x}"
    for kind in sorted(count):
        yield f"frame {kind.lower()} count {count[kind]}"


def difference(was, now):
    """The largest relative difference of the real numbers in two lines."""
    pairs = [(float.fromhex(a), float.fromhex(b)) for a, b in zip(was.split(), now.split())
             if "0x" in a and "0x" in b]
    return max((abs(a - b) / max(abs(a), abs(b)) for a, b in pairs if a != b), default=0.0)


def main():
    path = pathlib.Path(__file__).with_name(sys.argv[1] + ".txt")
    now = ["format 1", *vector(json.load(open(sys.argv[2])))]
    now += [line for log in sys.argv[3:] for line in schedule(log)]
    was = path.read_text().splitlines() if path.exists() else []
    rows = max(len(was), len(now))
    pairs = list(zip(was + [""] * (rows - len(was)), now + [""] * (rows - len(now))))
    differing = [i for i, (a, b) in enumerate(pairs) if a != b]
    if differing:
        a, b = pairs[differing[0]]
        print(f"{path.name}:{differing[0] + 1}:\n  recorded: {a}\n  now:      {b}")
        print(f"{path.name}: {len(differing)} lines differ, real numbers by up to "
              f"{max(difference(a, b) for a, b in pairs):.3g} of their value")
    if os.environ.get("GOLDEN") == "write":
        path.write_text("\n".join(now) + "\n")
        return 0
    return 1 if differing else 0


sys.exit(main())
