#!/usr/bin/env python3
"""cantools decodes every frame of a log that candump wrote.

usage: decode.py LOG DBC
Prints the last estimates ("value sigma", one line per identified parameter), and on standard error
"frames=N undecoded=N".
"""
import math
import sys

import cantools


def main():
    log, dbc = sys.argv[1:]
    messages = {m.frame_id: m for m in cantools.database.load_file(dbc).messages}
    frames = undecoded = 0
    value, sigma = {}, {}
    for line in open(log, encoding="ascii"):
        identifier, data = line.split()[2].split("#")
        frames += 1
        try:
            message = messages[int(identifier, 16)]
            signals = message.decode(bytes.fromhex(data), decode_choices=False)
        except (KeyError, cantools.database.DecodeError):
            undecoded += 1
            continue
        if message.name == "estimate":
            value[signals["index"]] = signals["value"]
        elif message.name == "estimate_sigma":
            sigma[signals["index"]] = signals["sigma"]
    for index in sorted(i for i in sigma if not math.isnan(sigma[i])):
        print(f"{value[index]:.9g} {sigma[index]:.9g}")
    print(f"frames={frames} undecoded={undecoded}", file=sys.stderr)


main()
