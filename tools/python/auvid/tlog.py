"""A ground station's telemetry log (.tlog): a time and a MAVLink frame, again and again."""
import struct

from pymavlink.dialects.v20 import ardupilotmega as dialect

from auvid import ardupilot
from auvid.log_error import LogError
from auvid.mavlink import NAMES, Vehicle
from auvid.series import Recording

CHUNK = 1 << 20
STAMP = 8          # bytes of the time before each frame
WANTED = {kind for kind, message in dialect.mavlink_map.items() if message.msgname in NAMES}


def _length(data, at):
    """Bytes of the frame that begins there, and its message id; 0: there is no frame."""
    if data[at] == 0xFD:
        signature = 13 if data[at + 2] & 1 else 0
        return 12 + data[at + 1] + signature, int.from_bytes(data[at + 7:at + 10], "little")
    if data[at] == 0xFE:
        return 8 + data[at + 1], data[at + 5]
    return 0, 0


def frames(file, lost):
    """Yields time [s] and message of each frame in WANTED. lost: counts bytes, by the reason."""
    codec = dialect.MAVLink(None)
    codec.robust_parsing = False
    data, at, more = b"", 0, True
    while True:
        if len(data) - at < 512 and more:  # longer than any frame
            new = file.read(CHUNK)
            more, data, at = bool(new), data[at:] + new, 0
        if len(data) - at < STAMP + 10:
            break
        length, kind = _length(data, at + STAMP)
        if length == 0:
            lost["unreadable"] += 1
            at += 1
            continue
        if len(data) - at < STAMP + length:
            break
        if kind in WANTED:
            frame = data[at + STAMP:at + STAMP + length]
            try:
                yield struct.unpack(">Q", data[at:at + STAMP])[0] * 1e-6, \
                    codec.decode(bytearray(frame))
            except dialect.MAVError:
                lost["unreadable"] += 1
                at += 1
                continue
        at += STAMP + length
    rest = data[at:]
    is_cut = len(rest) <= STAMP or rest[STAMP] in (0xFE, 0xFD)
    lost["cut" if is_cut else "unreadable"] += len(rest)


def read(path, options):
    """-> Recording"""
    if options.only is not None and not options.only.isdecimal():
        raise LogError(f"--only {options.only}: for a .tlog give a system id, as --only 1")
    recording = Recording(path, "MAVLink telemetry log")
    vehicle = Vehicle(recording, None if options.only is None else int(options.only))
    lost = {"unreadable": 0, "cut": 0}
    with path.open("rb") as file:
        for received, message in frames(file, lost):
            vehicle.take(message.get_srcSystem(), message.get_srcComponent(), message.get_type(),
                         message.to_dict(), received)
    if not vehicle.seen:
        raise LogError("no heartbeat of an autopilot in this file: check that it is a .tlog"
                       if vehicle.system is None else f"no vehicle with system id {vehicle.system}")
    if vehicle.system is not None and vehicle.system not in vehicle.seen:
        ids = ", ".join(map(str, sorted(vehicle.seen)))
        raise LogError(f"no vehicle with system id {vehicle.system}: this log has {ids}")
    if lost["cut"]:
        recording.notes.append("the file is cut off: it ends within a message; what stands before "
                               "is converted")
    if lost["unreadable"]:
        recording.notes.append(f"{lost['unreadable']} bytes cannot be read and are skipped")
    ardupilot.finish(recording)
    return recording
