"""ArduSub's DataFlash log (.BIN). pymavlink knows the formats; the file is read as a stream."""
import struct

from pymavlink.DFReader import FORMAT_TO_STRUCT, DFFormat

from auvid import ardupilot, modes
from auvid.log_error import LogError
from auvid.series import Recording

HEAD = b"\xa3\x95"
FMT = 0x80
CHUNK = 1 << 20
WANTED = {"ATT", "IMU", "VISO", "XKF1", "RCOU", "BAT", "MODE", "PARM"}
DEGREE = 0.017453292519943295


class Reader:
    """Messages of a file in their order.

    unreadable: bytes that are in no message. cut: bytes of a last message that is not complete.
    """

    def __init__(self, file):
        self.file, self.data, self.at = file, b"", 0
        self.length = {FMT: 89}
        self.form = {FMT: DFFormat(FMT, "FMT", 89, "BBnNZ", "Type,Length,Name,Format,Columns")}
        self.unreadable = self.cut = 0

    def _has(self, size):
        """Reads on until so many bytes are there. False at the end of the file."""
        while len(self.data) - self.at < size:
            more = self.file.read(CHUNK)
            if not more:
                return False
            self.data, self.at = self.data[self.at:] + more, 0
        return True

    def messages(self):
        """Yields the format and the values of each message in WANTED."""
        while self._has(3):
            kind = self.data[self.at + 2]
            length = self.length.get(kind)
            if self.data[self.at:self.at + 2] != HEAD or length is None:
                self._resynchronise()
                continue
            if not self._has(length):
                break
            form = self.form.get(kind)
            if form is not None:
                values = struct.unpack(form.msg_struct, self.data[self.at + 3:self.at + length])
                if kind == FMT:
                    self._define(*values)
                else:
                    yield form, values
            self.at += length
        rest = len(self.data) - self.at
        if HEAD.startswith(self.data[self.at:self.at + 2]):
            self.cut = rest
        else:
            self.unreadable += rest

    def _resynchronise(self):
        found = self.data.find(HEAD, self.at + 1)
        found = found if found >= 0 else len(self.data) - 1  # the last byte may begin a message
        self.unreadable += found - self.at
        self.at = found

    def _define(self, kind, length, *texts):
        name, letters, columns = (text.split(b"\0")[0].decode("ascii", "replace")
                                  for text in texts)
        if kind == FMT or length < 3:
            return
        self.length[kind] = length
        if name in WANTED:
            known = all(letter in FORMAT_TO_STRUCT for letter in letters)
            form = DFFormat(kind, name, length, letters if known else "", columns)
            if 3 + struct.calcsize(form.msg_struct) != length:
                raise LogError(f"the format of {name} does not have the length that the log gives: "
                               "the log is damaged; copy it from the vehicle again")
            self.form[kind] = form


def _fields(form, values):
    """The values by name, in the units of the log."""
    out = {}
    for name, value, factor in zip(form.columns, values, form.msg_mults):
        out[name] = value * factor if factor is not None else value
    return out


def _take(recording, name, m):
    """Adds a message to the series or the parameters."""
    t = m["TimeUS"] * 1e-6
    if name == "PARM":
        recording.parameters[m["Name"].split(b"\0")[0].decode("ascii", "replace")] = m["Value"]
    elif name == "MODE":
        recording.add_mode(t, modes.ARDUSUB, m["ModeNum"])
    elif name == "ATT":
        recording.add("attitude", t, [m[k] * DEGREE for k in ("Roll", "Pitch", "Yaw")], "ATT")
    elif name == "IMU" and m.get("I", 0) == 0:
        recording.add("rates", t, [m["GyrX"], m["GyrY"], m["GyrZ"]], "IMU")
        recording.add("specific_force", t, [m["AccX"], m["AccY"], m["AccZ"]], "IMU")
    elif name == "VISO" and m["dt"] > 0:
        ardupilot.add_dvl(recording, t, m["dt"], [m["PosDX"], m["PosDY"], m["PosDZ"]], m["conf"],
                          "VISO")
    elif name == "XKF1" and m.get("C", 0) == 0:
        recording.add("velocity_ned", t, [m["VN"], m["VE"], m["VD"]], "XKF1")
        recording.add("position", t, [m["PN"], m["PE"], m["PD"]], "XKF1")
    elif name == "RCOU":
        recording.add("pwm", t, [m.get(f"C{k}", 0) for k in range(1, 15)], "RCOU")
    elif name == "BAT" and m.get("Instance", m.get("Inst", 0)) == 0:
        recording.add("voltage", t, [m["Volt"]], "BAT")


def read(path, options):
    """-> Recording"""
    recording = Recording(path, "ArduSub DataFlash log")
    with path.open("rb") as file:
        reader = Reader(file)
        for form, values in reader.messages():
            try:
                _take(recording, form.name, _fields(form, values))
            except KeyError as error:
                raise LogError(f"{form.name} has no field {error}: the log is damaged, or of "
                               "another version of ArduSub") from error
    if len(reader.length) == 1:
        raise LogError("no DataFlash message in this file: check that it is a .BIN of ArduSub")
    if reader.cut:
        recording.notes.append("the file is cut off: it ends within a message; what stands before "
                               "is converted")
    if reader.unreadable:
        recording.notes.append(f"{reader.unreadable} bytes cannot be read and are skipped: copy "
                               "the log from the vehicle again if they are many")
    ardupilot.finish(recording)
    return recording
