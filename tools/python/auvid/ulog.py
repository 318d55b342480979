"""PX4's ULog (.ulg). pyulog knows the definitions; the data are read as a stream."""
import struct

import numpy as np
from pyulog import ULog

from auvid import modes
from auvid.log_error import LogError
from auvid.series import COMMANDS, Recording

SYSTEM_IDENTIFICATION = 8  # bit 3 of SDLOG_PROFILE
MOTORS = 12        # of actuator_motors
BODY_FRD, NED = 3, 1       # velocity_frame of vehicle_odometry
THRUST = {"vehicle_thrust_setpoint": "surge sway heave", "vehicle_torque_setpoint":
          "roll pitch yaw"}
WANTED = {"vehicle_attitude", "vehicle_angular_velocity", "vehicle_acceleration",
          "vehicle_local_position", "vehicle_odometry", "vehicle_visual_odometry",
          "actuator_motors", "battery_status", "vehicle_status", *THRUST}


class _Topic:
    """A subscription: offset and format of each field."""

    def __init__(self, added):
        self.name, self.multi, self.fields = added.message_name, added.multi_id, {}
        at = 0
        for field in added.field_data:
            letter, size, _ = ULog._UNPACK_TYPES[field.type_str]
            self.fields[field.field_name] = struct.Struct("<" + letter), at
            at += size
        self.size = at

    def unpack(self, data):
        """The fields by name, unpacked as they are asked for."""
        return _Message(self.fields, data)


class _Message:
    def __init__(self, fields, data):
        self.fields, self.data = fields, data

    def get(self, name, default=None):
        if name not in self.fields:
            return default
        form, at = self.fields[name]
        return form.unpack_from(self.data, at)[0]

    def three(self, names):
        """Three fields; nan for one that is not there."""
        return [self.get(name, np.nan) for name in names]

    def four(self, name):
        return [self.get(f"{name}[{k}]", np.nan) for k in range(4)]


class Reader:
    """Messages of a file in their order. The definitions are decoded by pyulog."""

    def __init__(self, file, parameters):
        self.file, self.parameters = file, parameters
        self.formats, self.topics, self.dropouts = {}, {}, 0
        self.cut = False

    def messages(self):
        """Yields name, instance, message of each topic in WANTED."""
        if self.file.read(16)[:7] != ULog.HEADER_BYTES:
            raise LogError("no ULog header in this file: check that it is a .ulg of PX4")
        header = ULog._MessageHeader()
        while len(head := self.file.read(3)) == 3:
            header.initialize(head)
            data = self.file.read(header.msg_size)
            if len(data) < header.msg_size:
                break
            if header.msg_type == ULog.MSG_TYPE_DATA:
                topic = self.topics.get(int.from_bytes(data[:2], "little"))
                if topic and len(data) - 2 >= topic.size:
                    yield topic.name, topic.multi, topic.unpack(data[2:])
            else:
                self._define(header, data)
        else:
            self.cut = len(head) > 0
            return
        self.cut = True

    def _define(self, header, data):
        try:
            if header.msg_type == ULog.MSG_TYPE_FORMAT:
                form = ULog.MessageFormat(data, header)
                self.formats[form.name] = form
            elif header.msg_type == ULog.MSG_TYPE_PARAMETER:
                info = ULog._MessageInfo(data, header)
                self.parameters[info.key] = info.value
            elif header.msg_type == ULog.MSG_TYPE_ADD_LOGGED_MSG:
                added = ULog._MessageAddLogged(data, header, self.formats)
                if added.message_name in WANTED:
                    self.topics[added.msg_id] = _Topic(added)
            elif header.msg_type == ULog.MSG_TYPE_DROPOUT:
                self.dropouts += 1
        except (KeyError, ValueError, IndexError, struct.error) as error:
            raise LogError("a definition of this ULog cannot be read: the log is damaged; copy it "
                           "from the vehicle again") from error


def _odometry(recording, t, m, name, raw):
    frame = m.get("velocity_frame", NED)
    velocity = m.three([f"velocity[{k}]" for k in range(3)] if "velocity[0]" in m.fields
                       else ["vx", "vy", "vz"])
    if frame == BODY_FRD:
        recording.add("dvl" if raw else "velocity", t, velocity, name)
    elif frame == NED and not raw:
        recording.add("velocity_ned", t, velocity, name)


def _take(recording, name, m):
    """Adds a message to the series."""
    t = (m.get("timestamp_sample") or m.get("timestamp", 0)) * 1e-6
    add = recording.add
    if name == "vehicle_attitude":
        add("quaternion", t, m.four("q"), name)
    elif name == "vehicle_angular_velocity":
        add("rates", t, m.three([f"xyz[{k}]" for k in range(3)]), name)
    elif name == "vehicle_acceleration":
        add("specific_force", t, m.three([f"xyz[{k}]" for k in range(3)]), name)
    elif name == "vehicle_local_position":
        if m.get("v_xy_valid", 1) and m.get("v_z_valid", 1):
            add("local_velocity", t, m.three(["vx", "vy", "vz"]), name)
        add("position", t, m.three(["x", "y", "z"]), name)
    elif name in ("vehicle_odometry", "vehicle_visual_odometry"):
        _odometry(recording, t, m, name, raw=name == "vehicle_visual_odometry")
    elif name == "actuator_motors":
        values = [m.get(f"control[{k}]", np.nan) for k in range(MOTORS)]
        add("motors", t, [0.0 if x != x else x for x in values], name)
    elif name in THRUST:
        columns = ["cmd_" + dof for dof in THRUST[name].split()]
        add(name, t, m.three([f"xyz[{k}]" for k in range(3)]), name, columns)
    elif name == "vehicle_status" and "nav_state" in m.fields:
        recording.add_mode(t, modes.PX4, m.get("nav_state"))
    elif name == "battery_status":
        add("voltage", t, [m.get("voltage_v", np.nan)], name)


def mixer(parameters):
    """[6, rotors]: commands of the degrees of freedom, from CA_ROTORn_*. None without them."""
    count = min(int(parameters.get("CA_ROTOR_COUNT", 0)), MOTORS)
    if count == 0 or "CA_ROTOR0_AX" not in parameters:
        return None

    def read(k, name, default):
        return float(parameters.get(f"CA_ROTOR{k}_{name}", default))
    columns = []
    for k in range(count):
        axis = np.array([read(k, "AX", 0), read(k, "AY", 0), read(k, "AZ", -1)])
        place = np.array([read(k, "PX", 0), read(k, "PY", 0), read(k, "PZ", 0)])
        force = read(k, "CT", 6.5) * axis / max(np.linalg.norm(axis), 1e-9)
        columns.append([*force, *(np.cross(place, force) - read(k, "KM", 0) * force)])
    rows = np.array(columns).T
    total = np.sum(np.abs(rows), axis=1, keepdims=True)
    return np.where(total > 1e-6 * total.max(), rows / np.maximum(total, 1e-12), 0.0)


def _commands(recording):
    """Thrusters from the motors; commands from the setpoints, or from the motors' geometry."""
    setpoints = [name for name in THRUST if name in recording.series]
    if "motors" not in recording.series:
        return
    count = min(int(recording.parameters.get("CA_ROTOR_COUNT", 0)) or MOTORS, MOTORS)
    matrix, columns = mixer(recording.parameters), [f"thruster_{k + 1}" for k in range(count)]
    recording.geometry = None if matrix is None else matrix.T
    used = [] if matrix is None or setpoints else [j for j in range(6) if np.any(matrix[j])]
    columns += [COMMANDS[j] for j in used]
    recording.derived["motors"] = (columns, lambda u: np.hstack(
        [u[:, :count], u[:, :count] @ matrix[used].T]) if used else u[:, :count])
    if not setpoints and matrix is None:
        recording.notes.append("no CA_ROTORn_* parameters and no vehicle_thrust_setpoint: no "
                               "commands cmd_surge .. cmd_yaw, only thruster_1 ..")


def _settings(recording):
    profile = recording.parameters.get("SDLOG_PROFILE")
    if profile is not None and not int(profile) & SYSTEM_IDENTIFICATION:
        recording.notes.append(
            f"before the next dive set SDLOG_PROFILE={int(profile) | SYSTEM_IDENTIFICATION} (it is "
            f"{int(profile)}): it logs actuator_motors and rates in full, for identification")


def read(path, options):
    """-> Recording"""
    recording = Recording(path, "PX4 ULog")
    with path.open("rb") as file:
        reader = Reader(file, recording.parameters)
        for name, instance, message in reader.messages():
            if instance == 0:
                _take(recording, name, message)
    if "local_velocity" in recording.series:  # estimated by the same filter as the odometry
        recording.series["velocity_ned"] = recording.series.pop("local_velocity")
    if reader.cut:
        recording.notes.append("the file is cut off: it ends within a message; what stands before "
                               "is converted")
    if reader.dropouts:
        recording.notes.append(f"{reader.dropouts} dropouts: the card was too slow; use a faster "
                               "one, or log less")
    recording.remedies.update(
        rate="set SDLOG_PROFILE to include system identification (8)",
        velocity="log vehicle_local_position, and enable the external velocity in EKF2",
        command="set SDLOG_PROFILE to include system identification (8)",
        attitude="log vehicle_attitude", rates="log vehicle_angular_velocity")
    _commands(recording)
    _settings(recording)
    return recording
