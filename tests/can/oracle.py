"""The codec against cantools, autosar-e2e and crccheck. Run by test_oracle.sh.

usage: oracle.py LIBRARY_FLOAT LIBRARY_DOUBLE
The libraries are lib/src/can/auvid_can*.c as shared objects. The structs are read from the
generated header, so a member with a wrong name, offset or type is detected, too.
Prints "ok - ..." or "not ok - ..." lines. 2e4 values and payloads per library; 1e6 with
AUVID_TEST_LONG.
"""
import ctypes
import math
import os
import pathlib
import random
import re
import struct
import sys
from fractions import Fraction

import cantools
import e2e.p02
from crccheck.crc import Crc8Autosar

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADER = (ROOT / "lib/include/auvid/can_messages.h").read_text()
DATABASE = cantools.database.load_file(ROOT / "lib/can/auvid.dbc")
MESSAGES = sorted(DATABASE.messages, key=lambda m: m.frame_id)
COUNT = 1_000_000 if os.environ.get("AUVID_TEST_LONG") else 20_000
OK, SATURATED, NOT_FINITE, RANGE, CHECKSUM = 0, 8, -2, -6, -18


class Frame(ctypes.Structure):
    _fields_ = [("t_us", ctypes.c_uint64), ("id", ctypes.c_uint16), ("length", ctypes.c_uint8),
                ("data", ctypes.c_uint8 * 8)]


class Sender(ctypes.Structure):
    _fields_ = [("ids", ctypes.c_uint16 * 2), ("counter", ctypes.c_uint8 * len(MESSAGES)),
                ("saturated", ctypes.c_uint32), ("refused", ctypes.c_uint32)]


class Signal:
    """A signal of the DBC in raw values, independent of the generator."""

    def __init__(self, signal):
        self.cantools, self.name = signal, signal.name
        self.real = signal.is_signed or signal.is_float
        self.is_float = signal.is_float
        self.per_unit = 1 if signal.is_float else round(1 / signal.scale)
        self.absent = None
        choices = [int(k) for k in signal.choices or {}]
        if signal.is_float:
            self.absent = math.nan
        elif signal.is_signed:
            self.absent = -(1 << (signal.length - 1))
        self.low, self.high = signal.minimum, signal.maximum
        if not self.real:
            self.high = max([signal.maximum, *choices])

    def raw(self, x):
        """The raw value of x according to cantools."""
        raw = self.cantools.conversion.numeric_scaled_to_raw(min(max(x, self.low), self.high))
        return struct.unpack("<f", struct.pack("<f", raw))[0] if self.is_float else raw

    def legal(self, raw):
        if self.is_float:
            return struct.pack("<f", raw) == struct.pack("<I", 0x7FC00000) or \
                self.low <= raw <= self.high
        return raw == self.absent or \
            Fraction(str(self.low)) <= Fraction(raw, self.per_unit) <= Fraction(str(self.high))


def signals_of(message):
    rest = [s for s in message.signals if not s.name.startswith(message.name + "_c")]
    return [Signal(s) for s in sorted(rest, key=lambda s: s.start)]


class Codec:
    """One of the two libraries."""

    def __init__(self, path, real, suffix):
        self.real, self.library = real, ctypes.CDLL(path)
        self.pack = getattr(self.library, "auvid_can_pack" + suffix)
        self.unpack = getattr(self.library, "auvid_can_unpack" + suffix)
        self.library.auvid_can_crc.restype = ctypes.c_uint8
        self.sender, self.frame = Sender(), Frame()
        getattr(self.library, "auvid_can_sender_init" + suffix)(ctypes.byref(self.sender), None)
        union = type("As", (ctypes.Union,), {
            "_fields_": [(m.name, self.struct(m)) for m in MESSAGES]})
        self.Message = type("Message", (ctypes.Structure,), {"_fields_": [
            ("kind", ctypes.c_int), ("counter", ctypes.c_uint8), ("absent", ctypes.c_uint32),
            ("as_", union)]})
        self.epsilon = 2.0 ** -23 if real is ctypes.c_float else 2.0 ** -52

    def struct(self, message):
        body = re.search(r"typedef struct \{([^}]*)\} auvid_can_%s_t;" % message.name, HEADER)[1]
        fields = []
        for kind, name, length in re.findall(r"^    (\w+) (\w+)(?:\[(\d+)\])?;", body, re.M):
            c = {"auvid_real_t": self.real, "uint32_t": ctypes.c_uint32}[kind]
            fields.append((name, c * int(length) if length else c))
        return type(message.name, (ctypes.Structure,), {"_fields_": fields})

    @staticmethod
    def where(holder, name):
        """(array, index) or (struct, name) of a signal's member."""
        if hasattr(holder, name):
            return None, name
        stem, number = name.rsplit("_", 1)
        return getattr(holder, stem), (int(number) - 1) % 4

    def put(self, holder, name, value):
        array, place = self.where(holder, name)
        if array is None:
            setattr(holder, place, value)
        else:
            array[place] = value

    def get(self, holder, name):
        array, place = self.where(holder, name)
        return getattr(holder, place) if array is None else array[place]

    def rounded(self, x):
        return self.real(x).value


def protect(data, data_id):
    data = bytearray(data)
    e2e.p02.e2e_p02_protect(data, bytes([data_id] * 16), increment_counter=False)
    return bytes(data)


def random_real(rng, s):
    kind = rng.randrange(8)
    if s.is_float:
        return [rng.uniform(-1000, 1000), struct.unpack("<f", rng.randbytes(4))[0], 0.0, -0.0,
                math.inf, -math.inf, rng.gauss(0, 1e38), 1e-40][kind]
    span = s.high - s.low
    step = 1 / s.per_unit
    raw = rng.randint(round(s.low / step), round(s.high / step))
    return [rng.uniform(s.low, s.high), rng.uniform(s.low - span, s.high + span), raw * step,
            (raw + 0.5) * step, (raw + rng.uniform(0.49, 0.51)) * step, rng.uniform(-step, step),
            rng.choice([math.inf, -math.inf, 3e38, -3e38, 2.0**31, -2.0**31, 1.5, -2.0]),
            rng.gauss(0, span / 100)][kind]


def random_integer(rng, s):
    return rng.choice([rng.randint(0, int(s.high)), rng.getrandbits(32), int(s.high), 0])


def compare_values(codec, rng):
    values = halves = 0
    while values < COUNT:
        kind = rng.randrange(len(MESSAGES))
        message, data_id = MESSAGES[kind], MESSAGES[kind].dbc.attributes["AuvidDataId"].value
        m, asked, raw = codec.Message(kind=kind), {}, {}
        saturated, unsure = 0, False
        holder = getattr(m.as_, message.name)
        for i, s in enumerate(signals_of(message)):
            x = codec.rounded(random_real(rng, s)) if s.real else random_integer(rng, s)
            if s.real and (math.isnan(x) or rng.random() < 0.05):
                m.absent |= 1 << i
                raw[s.name] = s.absent
            else:
                asked[s.name] = (s, x)
                raw[s.name] = s.raw(x)
                beyond = max(x - s.high, s.low - x, 0) * s.per_unit
                if abs(beyond - 0.5) > 0.01:
                    saturated += beyond > (0.5 if s.real else 0)
                else:
                    unsure = True
            codec.put(holder, s.name, x)
            values += 1
        raw[message.name + "_crc"] = 0
        raw[message.name + "_counter"] = codec.sender.counter[kind]
        expected = protect(message.encode(raw, scaling=False, strict=False), data_id)
        status = codec.pack(ctypes.byref(codec.sender), ctypes.byref(m), ctypes.byref(codec.frame))
        got = bytes(codec.frame.data)
        assert status in (OK, SATURATED), status
        assert unsure or (status == SATURATED) == (saturated > 0), (message.name, asked)
        assert codec.frame.id == message.frame_id and codec.frame.length == 8
        if got == expected:
            continue
        # Only a value halfway between two raw values, to the precision of the library, may differ.
        assert protect(got, data_id) == got, "CRC"
        ours = message.decode(got, scaling=False, decode_choices=False)
        for name, value in ours.items():
            if name.endswith("_crc") or value == raw[name] or value != value:
                continue
            s, x = asked[name]
            exact = Fraction(x) * s.per_unit
            assert abs(value - raw[name]) == 1, (message.name, name, x, value, raw[name])
            half = abs(abs(exact - math.floor(exact)) - Fraction(1, 2))
            assert half <= abs(exact) * Fraction(codec.epsilon) + Fraction(2.0 ** -22), (name, x)
            halves += 1
    return f"{values} values ({halves} halfway between two steps)"


def compare_payloads(codec, rng):
    accepted = refused = 0
    while accepted + refused < COUNT:
        kind = rng.randrange(len(MESSAGES))
        message, data_id = MESSAGES[kind], MESSAGES[kind].dbc.attributes["AuvidDataId"].value
        signals = signals_of(message)
        data = rng.randbytes(8)
        if rng.random() < 0.5:  # most random payloads of some messages are out of range: help
            raw = message.decode(data, scaling=False, decode_choices=False)
            for s in signals:
                if not s.legal(raw[s.name]):
                    raw[s.name] = s.raw(rng.uniform(s.low, min(s.high, 1e6)))
            data = message.encode(raw, scaling=False, strict=False)
        data = protect(data, data_id)
        raw = message.decode(data, scaling=False, decode_choices=False)
        scaled = message.decode(data, decode_choices=False)
        legal = all(s.legal(raw[s.name]) for s in signals)
        m, frame = codec.Message(), Frame(id=message.frame_id, length=8)
        frame.data[:] = data
        status = codec.unpack(None, ctypes.byref(frame), ctypes.byref(m))
        assert status == (OK if legal else RANGE), (message.name, raw, status)
        accepted, refused = accepted + legal, refused + (not legal)
        if not legal:
            continue
        assert m.kind == kind and m.counter == raw[message.name + "_counter"]
        for i, s in enumerate(signals):
            ours = codec.get(getattr(m.as_, message.name), s.name)
            absent = s.real and (raw[s.name] == s.absent or raw[s.name] != raw[s.name])
            assert absent == bool(m.absent >> i & 1), (message.name, s.name)
            if absent:
                assert math.isnan(ours)
                continue
            # cantools multiplies by the binary neighbour of a decimal factor.
            theirs = scaled[s.name] if s.is_float else round(scaled[s.name], 6)
            assert ours == codec.rounded(theirs) if s.real else ours == theirs, (s.name, ours)
        # And back: the same frame, in all bits that a signal uses.
        codec.sender.counter[kind] = m.counter
        assert codec.pack(ctypes.byref(codec.sender), ctypes.byref(m), ctypes.byref(frame)) == OK
        again = message.decode(bytes(frame.data), scaling=False, decode_choices=False)
        for s in signals:
            assert again[s.name] == raw[s.name] or again[s.name] != again[s.name], s.name
    return f"{accepted} payloads accepted, {refused} refused"


def compare_crcs(codec, rng):
    for _ in range(10_000):
        data, data_id = rng.randbytes(8), rng.getrandbits(8)
        ours = codec.library.auvid_can_crc((ctypes.c_uint8 * 8)(*data), data_id)
        assert ours == protect(data, data_id)[0]
        assert ours == Crc8Autosar.calc(data[1:] + bytes([data_id]))
    assert Crc8Autosar.calc(b"123456789") == 0xDF
    return "10000 CRCs"


def node_receives_what_the_dbc_says(codec, _):
    """Its messages are numbered from 0, in the order of their identifiers."""
    received = [m for m in MESSAGES if "node" in m.signals[0].receivers]
    for kind, message in enumerate(MESSAGES):
        expected = received.index(message) if message in received else len(received)
        assert codec.library.auvid_can_node_kind(kind) == expected, message.name
    assert codec.library.auvid_can_node_kind(len(MESSAGES)) == len(received)
    return f"{len(received)} of {len(MESSAGES)} messages"


def nan_is_refused(codec, _):
    tried = 0
    for kind, message in enumerate(MESSAGES):
        for s in (s for s in signals_of(message) if s.real):
            m = codec.Message(kind=kind)
            codec.put(getattr(m.as_, message.name), s.name, math.nan)
            before = bytes(codec.frame)
            assert codec.pack(ctypes.byref(codec.sender), ctypes.byref(m),
                              ctypes.byref(codec.frame)) == NOT_FINITE
            assert bytes(codec.frame) == before
            tried += 1
    return f"{tried} signals"


def limits_hold(codec, _):
    """+1.5, -2 and infinity in every real signal are sent as the limited value of cantools."""
    tried = 0
    for kind, message in enumerate(MESSAGES):
        for s in (s for s in signals_of(message) if s.real):
            for x in (1.5, -2.0, math.inf, -math.inf):
                m = codec.Message(kind=kind)
                codec.put(getattr(m.as_, message.name), s.name, x)
                status = codec.pack(ctypes.byref(codec.sender), ctypes.byref(m),
                                    ctypes.byref(codec.frame))
                assert status in (OK, SATURATED), (message.name, s.name, x, status)
                got = message.decode(bytes(codec.frame.data), scaling=False, decode_choices=False)
                raw = s.raw(x)
                raw = ctypes.c_float(raw).value if s.is_float else raw
                assert got[s.name] == raw, (message.name, s.name, x, got[s.name], raw)
                tried += 1
    return f"{tried} values"


def main():
    failed = False
    for path, real, suffix in zip(sys.argv[1:], (ctypes.c_float, ctypes.c_double),
                                  ("_f32", "_f64")):
        for name, check in (("values packed as by cantools", compare_values),
                            ("payloads unpacked as by cantools", compare_payloads),
                            ("CRC as by autosar-e2e and crccheck", compare_crcs),
                            ("a node receives what the DBC says", node_receives_what_the_dbc_says),
                            ("NaN refused in every signal", nan_is_refused),
                            ("+1.5, -2 and infinity limited in every signal", limits_hold)):
            try:
                said = check(Codec(path, real, suffix), random.Random(name))
                print(f"ok - {name}{suffix}: {said}", flush=True)
            except AssertionError as error:
                line = error.__traceback__.tb_next.tb_lineno
                print(f"not ok - {name}{suffix}: line {line}: {error}")
                failed = True
    sys.exit(failed)


main()
