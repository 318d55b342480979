"""The frames against cantools, autosar-e2e and crccheck. (tests/can/oracle.py adds limits,
values halfway between two steps, NaN and random payloads.)"""
import math

import cantools
import e2e.p02
import numpy as np
from crccheck.crc import Crc8Autosar

from auvid_validation.compare import Row, close, counted
from auvid_validation.library import root

FRAMES = 200  # of each message


def protect(data, data_id):
    data = bytearray(data)
    e2e.p02.e2e_p02_protect(data, bytes([data_id] * 16), increment_counter=False)
    return bytes(data)


def member(holder, name):
    """(array or struct, index or name) of a signal: thrust_3 is thrust[2]."""
    if hasattr(holder, name):
        return holder, name
    stem, number = name.rsplit("_", 1)
    return getattr(holder, stem), (int(number) - 1) % 4


def put(holder, name, value):
    place, key = member(holder, name)
    if isinstance(key, str):
        setattr(place, key, value)
    else:
        place[key] = value


def get(holder, name):
    place, key = member(holder, name)
    return getattr(place, key) if isinstance(key, str) else place[key]


def random_value(rng, signal):
    """Random valid values, not rounded to its steps; unsigned ones are whole numbers."""
    if signal.is_float:
        return float(np.float32(np.clip(rng.normal() * 100, signal.minimum, signal.maximum)))
    if signal.is_signed:
        return float(rng.uniform(signal.minimum, signal.maximum))
    if signal.choices:
        return int(rng.choice([int(k) for k in signal.choices]))
    return int(rng.integers(int(signal.minimum), int(signal.maximum) + 1))


class Frames:
    """Frames packed by auvid and read by cantools, and vice versa."""

    def __init__(self, lib, rng):
        self.lib, self.sender = lib, lib.auvid_can_sender_t()
        assert lib.auvid_can_sender_init(self.sender, None) == 0
        self.off = 0.0  # of packed values, beyond one rounding of value / step [steps]
        self.read = []  # (ours, theirs, scale) of unpacked values
        self.wrong = {"checksum": 0, "refused": 0, "again": 0}
        self.values = self.frames = 0
        database = cantools.database.load_file(root() / "lib/can/auvid.dbc")
        for kind, message in enumerate(sorted(database.messages, key=lambda m: m.frame_id)):
            for _ in range(FRAMES):
                self.one(rng, kind, message)

    def one(self, rng, kind, message):
        lib, message_id = self.lib, message.dbc.attributes["AuvidDataId"].value
        signals = [s for s in message.signals if not s.name.startswith(message.name + "_c")]
        m, frame = lib.auvid_can_message_t(kind=kind), lib.auvid_can_frame_t()
        holder = getattr(getattr(m, "as"), message.name)
        for s in signals:
            put(holder, s.name, random_value(rng, s))
        status = lib.auvid_can_pack(self.sender, m, frame)
        data = bytes(frame.data)
        assert status == 0 and frame.id == message.frame_id, (message.name, status)
        self.frames += 1
        self.wrong["checksum"] += protect(data, message_id) != data
        raw = message.decode(data, scaling=False, decode_choices=False)
        for s in signals:
            asked = get(holder, s.name)
            steps = asked / s.scale
            rounding = np.finfo(lib.real).eps * abs(steps) if s.is_signed else 0
            self.off = max(self.off, float(abs(raw[s.name] - steps) - rounding))
            self.values += 1
        # cantools packs the frame again from what it read; auvid reads the result.
        back = lib.auvid_can_message_t()
        frame.data[:] = protect(message.encode(raw, scaling=False), message_id)
        self.wrong["again"] += bytes(frame.data) != data
        self.wrong["refused"] += lib.auvid_can_unpack(None, frame, back) != 0
        holder = getattr(getattr(back, "as"), message.name)
        theirs = message.decode(data, decode_choices=False)
        for s in signals:
            ours, value = get(holder, s.name), float(theirs[s.name])
            if not math.isnan(value):
                self.read.append((ours, value, max(abs(value), 1e-30)))


def comparisons(lib):
    rng = np.random.default_rng(1)
    f = Frames(lib, rng)
    yield Row(f"CAN, {f.values} values packed", "cantools decode", f.off, 0.5 + 1e-9,
              "steps of the signal", "rounded to the nearest; beyond a rounding of value / step")
    sides = tuple(np.array(side) for side in zip(*f.read))
    yield close(lib, f"CAN, {len(f.read)} values unpacked", "cantools decode", [sides],
                "relative to itself", 1, "a quotient")
    yield counted("CAN, frames written by both", "cantools encode", f.wrong["again"], f.frames,
                  "frames differ")
    yield counted("CAN, frames of cantools accepted", "cantools encode", f.wrong["refused"],
                  f.frames, "frames refused")
    yield counted("CAN, checksum of frames", "autosar-e2e profile 2", f.wrong["checksum"],
                  f.frames, "checksums differ")
    wrong = 0
    for _ in range(5000):
        data, data_id = rng.bytes(8), int(rng.integers(256))
        ours = lib.auvid_can_crc(np.frombuffer(data, np.uint8).copy(), data_id)
        wrong += ours != Crc8Autosar.calc(data[1:] + bytes([data_id]))
    yield counted("CAN, CRC-8H2F", "crccheck Crc8Autosar", wrong, 5000, "checksums differ")
