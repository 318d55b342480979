#!/usr/bin/env python3
"""cantools as a listener on a real bus: it decodes every frame on arrival.

usage: listen.py INTERFACE DBC
Prints "ready" when it listens. On SIGTERM it decodes the queued frames, then prints the last
estimates ("value sigma", one line per identified parameter), and on standard error "frames=N
undecoded=N".
"""
import contextlib
import math
import signal
import socket
import struct
import sys

import cantools

SO_RCVBUFFORCE = 33
stopping = False


def stop(*_):
    global stopping
    stopping = True


def main():
    interface, path = sys.argv[1:]
    messages = {m.frame_id: m for m in cantools.database.load_file(path).messages}
    bus = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    with contextlib.suppress(PermissionError):
        bus.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 1 << 28)
    bus.settimeout(0.2)
    bus.bind((interface,))
    signal.signal(signal.SIGTERM, stop)
    print("ready", file=sys.stderr, flush=True)
    frames = undecoded = 0
    value, sigma = {}, {}
    while True:
        try:
            identifier, length, data = struct.unpack("=IB3x8s", bus.recv(16))
        except TimeoutError:
            if stopping:
                break
            continue
        frames += 1
        try:
            message = messages[identifier]
            signals = message.decode(data[:length], decode_choices=False)
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
