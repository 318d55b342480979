"""Logs of each stack from one run, for the tests. Nothing here comes from the readers.

A run has t, attitude [rad], nu (u v w p q r), commands (of -1..1, surge .. yaw), position (NED) and
voltage, in rows.
"""
import functools
import json
import sqlite3
import struct
from typing import NamedTuple

import numpy as np

BASE_S = 100.0     # time of the autopilot at the start of a run


class Run(NamedTuple):
    t: np.ndarray
    attitude: np.ndarray
    nu: np.ndarray
    commands: np.ndarray
    position: np.ndarray

    @property
    def quaternion(self):
        """w x y z, by the product of three rotations about one axis."""
        out = np.tile([1.0, 0, 0, 0], (len(self.t), 1))
        for axis in (2, 1, 0):
            turn = np.zeros((len(self.t), 4))
            turn[:, 0] = np.cos(self.attitude[:, axis] / 2)
            turn[:, 1 + axis] = np.sin(self.attitude[:, axis] / 2)
            out = quaternion_product(out, turn)
        return out

    @property
    def ned(self):
        """The velocity along north, east, down, by the matrix of each row."""
        return np.einsum("nij,nj->ni", matrix(self.attitude), self.nu[:, :3])


def quaternion_product(a, b):
    w, v, s, u = a[:, :1], a[:, 1:], b[:, :1], b[:, 1:]
    return np.hstack([w * s - np.sum(v * u, axis=1, keepdims=True), w * u + s * v + np.cross(v, u)])


def matrix(attitude):
    """Rotation matrices from body to NED: Fossen 2011, Eq. 2.18."""
    (cf, ct, cp), (sf, st, sp) = np.cos(attitude).T, np.sin(attitude).T
    rows = [[cp * ct, -sp * cf + cp * st * sf, sp * sf + cp * cf * st],
            [sp * ct, cp * cf + sf * st * sp, -cp * sf + st * sp * cf],
            [-st, ct * sf, ct * cf]]
    return np.array(rows).transpose(2, 0, 1)


#: Signs of surge, sway, heave (down), roll, pitch, yaw in the thrusters of a BlueROV2 Heavy.
HEAVY = np.array([[-1, 1, 0, 0, 0, 1], [-1, -1, 0, 0, 0, -1], [1, 1, 0, 0, 0, -1],
                  [1, -1, 0, 0, 0, 1], [0, 0, 1, 1, -1, 0], [0, 0, 1, -1, -1, 0],
                  [0, 0, 1, 1, 1, 0], [0, 0, 1, -1, 1, 0]], float)
DIRECTION = [-1, -1, 1, -1, -1, 1, 1, -1]
PARAMETERS = {"FRAME_CONFIG": 2, "VISO_TYPE": 1, "EK3_SRC1_VELXY": 6, "LOG_BITMASK": 176127,
              "LOG_DISARMED": 1, **{f"SERVO{k + 1}_FUNCTION": 33 + k for k in range(8)},
              **{f"MOT_{k + 1}_DIRECTION": d for k, d in enumerate(DIRECTION)}}


def pwm_of(run):
    """[rows, 14]: outputs [us] of eight thrusters, and six that are off."""
    pulses = 1500 + np.rint(400 * run.commands @ HEAVY.T) * DIRECTION
    return np.hstack([pulses, np.zeros((len(run.t), 6))]).astype(int)


FORMATS = {  # name: type, letters, columns
    "PARM": (40, "QNf", "TimeUS,Name,Value"),
    "ATT": (41, "QccccCCCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw"),
    "IMU": (42, "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"),
    "VISO": (43, "Qffffffff", "TimeUS,dt,AngDX,AngDY,AngDZ,PosDX,PosDY,PosDZ,conf"),
    "XKF1": (44, "QBccCfffffff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD"),
    "RCOU": (45, "Q" + 14 * "H", "TimeUS," + ",".join(f"C{k}" for k in range(1, 15))),
    "BAT": (46, "QBf", "TimeUS,Inst,Volt"),
    "MODE": (47, "QMBB", "TimeUS,Mode,ModeNum,Rsn"),
}
LETTERS = {"Q": "Q", "N": "16s", "f": "f", "c": "h", "C": "H", "B": "B", "H": "H", "M": "B"}


def bin_format(name, length=None):
    kind, letters, columns = FORMATS[name]
    form = "<" + "".join(LETTERS[c] for c in letters)
    return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", kind, length or 3 + struct.calcsize(form),
                                         name.encode(), letters.encode(), columns.encode())


def bin_message(name, *values):
    kind, letters, _ = FORMATS[name]
    form = "<" + "".join(LETTERS[c] for c in letters)
    return b"\xa3\x95" + bytes([kind]) + struct.pack(form, *values)


def degrees(angle):
    return int(np.rint(np.degrees(angle) * 100))


def bin_log(run, skip=(), parameters=PARAMETERS, base=BASE_S, viso_shift=0.0, modes=()):
    """The bytes of a .BIN. skip: messages that are not logged. modes: (row, number) of changes."""
    out, pwm, ned = [bin_format(name) for name in FORMATS], pwm_of(run), run.ned
    out += [bin_message("PARM", int(base * 1e6), k.encode(), v) for k, v in parameters.items()]
    for i, t in enumerate(run.t):
        us = int(np.rint((base + t) * 1e6))
        out += [bin_message("MODE", us, mode, mode, 1) for row, mode in modes if row == i]
        roll, pitch, yaw = run.attitude[i]
        rows = {"ATT": (0, degrees(roll), 0, degrees(pitch), 0, degrees(yaw % (2 * np.pi)), 0, 0),
                "IMU": (0, *run.nu[i, 3:], 0, 0, -9.8),
                "VISO": (0.125, 0, 0, 0, *(run.nu[i, :3] * 0.125), 90.0),
                "XKF1": (0, 0, 0, 0, *ned[i], 0, *run.position[i]), "RCOU": tuple(pwm[i]),
                "BAT": (0, 16.0)}
        for name, values in rows.items():
            if name not in skip:
                shift = int(viso_shift * 1e6) if name == "VISO" else 0
                out.append(bin_message(name, us + shift, *values))
    return b"".join(out)


def tlog(run, systems=(1,), heartbeat=True, parameters=PARAMETERS, modes=(), vehicle=12):
    """The bytes of a .tlog, with the DVL, from a vehicle of each system id. modes: as bin_log."""
    from pymavlink.dialects.v20 import ardupilotmega as dialect
    out, pwm, ned = [], pwm_of(run), run.ned

    def put(t, system, component, message):
        codec = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
        out.append(struct.pack(">Q", int((1.7e9 + t) * 1e6)) + message.pack(codec))
    for system in systems:
        if heartbeat:
            put(0, system, 1, dialect.MAVLink_heartbeat_message(12, 3, 81, 19, 5, 3))
        for name, value in parameters.items():
            put(0, system, 1, dialect.MAVLink_param_value_message(name.encode(), value, 9, 99, 0))
    for i, t in enumerate(run.t):
        ms = int(np.rint((BASE_S + t) * 1e3))
        for system in systems:
            for mode in [mode for row, mode in modes if row <= i][-1:]:
                put(t, system, 1, dialect.MAVLink_heartbeat_message(vehicle, 3, 81, mode, 5, 3))
            put(t, system, 1, dialect.MAVLink_attitude_message(ms, *run.attitude[i],
                                                               *run.nu[i, 3:]))
            put(t, system, 1, dialect.MAVLink_local_position_ned_message(
                ms, *run.position[i], *ned[i]))
            put(t, system, 1, dialect.MAVLink_servo_output_raw_message(ms * 1000, 0, *pwm[i, :8]))
            put(t, system, 194, dialect.MAVLink_vision_position_delta_message(
                5, 125000, [0, 0, 0], list(run.nu[i, :3] * 0.125), 90.0))
    return b"".join(out)


TOPICS = {  # name: fields of a ULog message
    "vehicle_attitude": "uint64_t timestamp;uint64_t timestamp_sample;float[4] q;",
    "vehicle_angular_velocity": "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;",
    "vehicle_local_position": "uint64_t timestamp;uint64_t timestamp_sample;float x;float y;"
                              "float z;float vx;float vy;float vz;bool v_xy_valid;bool v_z_valid;",
    "vehicle_visual_odometry": "uint64_t timestamp;uint64_t timestamp_sample;float[3] velocity;"
                               "uint8_t velocity_frame;",
    "actuator_motors": "uint64_t timestamp;uint64_t timestamp_sample;float[12] control;",
    "vehicle_thrust_setpoint": "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;",
    "vehicle_torque_setpoint": "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;",
    "battery_status": "uint64_t timestamp;float voltage_v;",
    "vehicle_status": "uint64_t timestamp;uint8_t nav_state;",
}


def ulg_record(kind, data):
    return struct.pack("<HB", len(data), ord(kind)) + data


def ulg_log(run, skip=(), parameters=None, modes=()):
    """The bytes of a .ulg. modes: (row, number) of changes."""
    out = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0),
           ulg_record("B", bytes(40))]
    for name, fields in TOPICS.items():
        out.append(ulg_record("F", f"{name}:{fields}".encode()))
    for name, value in (parameters or {"SDLOG_PROFILE": 9}).items():
        kind = "float" if isinstance(value, float) else "int32_t"
        key = f"{kind} {name}".encode()
        out.append(ulg_record("P", bytes([len(key)]) + key +
                              struct.pack("<f" if kind == "float" else "<i", value)))
    number = {name: k for k, name in enumerate(TOPICS)}
    for name, k in number.items():
        out.append(ulg_record("A", struct.pack("<BH", 0, k) + name.encode()))
    motors, ned, q = run.commands @ HEAVY.T, run.ned, run.quaternion
    for i, t in enumerate(run.t):
        us = int(np.rint((BASE_S + t) * 1e6))
        stamp = struct.pack("<QQ", us + 500, us)
        floats = {"vehicle_attitude": q[i], "vehicle_angular_velocity": run.nu[i, 3:],
                  "vehicle_local_position": [*run.position[i], *ned[i]],
                  "vehicle_visual_odometry": run.nu[i, :3],
                  "actuator_motors": [*motors[i], *(4 * [np.nan])],
                  "vehicle_thrust_setpoint": run.commands[i, :3],
                  "vehicle_torque_setpoint": run.commands[i, 3:]}
        for name, values in floats.items():
            tail = {"vehicle_local_position": b"\1\1", "vehicle_visual_odometry": b"\3"}
            if name not in skip:
                out.append(ulg_record("D", struct.pack("<H", number[name]) + stamp +
                                      struct.pack(f"<{len(values)}f", *values) +
                                      tail.get(name, b"")))
        out.append(ulg_record("D", struct.pack("<HQf", number["battery_status"], us, 16.0)))
        out += [ulg_record("D", struct.pack("<HQB", number["vehicle_status"], us, mode))
                for row, mode in modes if row == i]
    return b"".join(out)


@functools.lru_cache
def store():
    """The types of ROS 2, and the DVL's."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    from auvid.bag_file import DVL
    types = get_typestore(Stores.ROS2_HUMBLE)
    types.register(get_types_from_msg(DVL, "marine_acoustic_msgs/msg/Dvl"))
    return types


class Bag:
    """Messages of a ROS 2 bag; then written as .mcap or .db3."""

    def __init__(self):
        self.store = store()
        self.messages = []  # topic, type, recorded [ns], bytes
        self.zeros = {}     # type -> message

    def make(self, kind, **fields):
        """A message with these fields; all others are zero."""
        names = self.store.fielddefs[kind][1]
        values = [fields[name] if name in fields else self._zero(form) for name, form in names]
        return self.store.types[kind](*values)

    def _zero(self, form):
        kind, what = form
        if kind.name == "NAME":
            if what not in self.zeros:
                self.zeros[what] = self.make(what)
            return self.zeros[what]
        if kind.name == "BASE":
            return "" if what[0] == "string" else 0
        element, count = what
        if element[0].name == "BASE":
            kinds = {"float64": float, "float32": np.float32}
            return np.zeros(count, kinds.get(element[1][0], int))
        return [self._zero(element) for _ in range(count)]

    def header(self, t, frame=""):
        ns = int(np.rint(t * 1e9))
        stamp = self.make("builtin_interfaces/msg/Time", sec=ns // 10**9, nanosec=ns % 10**9)
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)

    def vector(self, values, kind="geometry_msgs/msg/Vector3"):
        return self.make(kind, **dict(zip("xyz", map(float, values))))

    def put(self, topic, t, message):
        kind = message.__msgtype__
        data = bytes(self.store.serialize_cdr(message, kind))
        self.messages.append((topic, kind, int(np.rint(t * 1e9)), data))

    def mcap(self, path, chunk=1 << 16):
        from mcap.writer import Writer
        with path.open("wb") as file:
            writer, channels = Writer(file, chunk_size=chunk), {}
            writer.start(profile="ros2", library="test")
            for topic, kind, ns, data in self.messages:
                if topic not in channels:
                    text = self.store.generate_msgdef(kind, ros_version=2)[0]
                    schema = writer.register_schema(kind, "ros2msg", text.encode())
                    channels[topic] = writer.register_channel(topic, "cdr", schema)
                writer.add_message(channels[topic], ns, data, ns)
            writer.finish()

    def database(self, path, defined=()):
        """defined: types whose definition is in the file."""
        with sqlite3.connect(path) as file:
            file.execute("create table topics(id integer primary key, name, type, "
                         "serialization_format, offered_qos_profiles)")
            file.execute("create table messages(id integer primary key, topic_id integer, "
                         "timestamp integer, data blob)")
            file.execute("create table message_definitions(id integer primary key, topic_type, "
                         "encoding, encoded_message_definition, type_description_hash)")
            for kind in defined:
                text = self.store.generate_msgdef(kind, ros_version=2)[0]
                file.execute("insert into message_definitions(topic_type, encoding, "
                             "encoded_message_definition) values(?, 'ros2msg', ?)", (kind, text))
            number = {}
            for topic, kind, ns, data in self.messages:
                if topic not in number:
                    number[topic] = len(number) + 1
                    file.execute("insert into topics values(?, ?, ?, 'cdr', '')",
                                 (number[topic], topic, kind))
                file.execute("insert into messages(topic_id, timestamp, data) values(?, ?, ?)",
                             (number[topic], ns, data))
        file.close()


TO_FLU = np.array([1.0, -1.0, -1.0])


def bag(run, dvl_shift=0.0, odometry=True):
    """The run in ENU and FLU (REP 103): odometry, DVL, a wrench with the commands, thrusters."""
    out, half = Bag(), np.sqrt(0.5)
    n = len(run.t)
    to_enu = np.tile([0, half, half, 0], (n, 1))     # NED to ENU
    to_frd = np.tile([0, 1.0, 0, 0], (n, 1))         # FLU to FRD
    enu = quaternion_product(quaternion_product(to_enu, run.quaternion), to_frd)
    for i, t in enumerate(run.t + 1.7e9):
        twist = out.make("geometry_msgs/msg/Twist", linear=out.vector(run.nu[i, :3] * TO_FLU),
                         angular=out.vector(run.nu[i, 3:] * TO_FLU))
        orientation = out.make("geometry_msgs/msg/Quaternion", **dict(zip("wxyz", enu[i])))
        north, east, down = run.position[i]
        pose = out.make("geometry_msgs/msg/Pose", orientation=orientation, position=out.vector(
            [east, north, -down], "geometry_msgs/msg/Point"))
        if odometry:
            out.put("/odom", t, out.make(
                "nav_msgs/msg/Odometry", header=out.header(t), child_frame_id="base_link",
                pose=out.make("geometry_msgs/msg/PoseWithCovariance", pose=pose),
                twist=out.make("geometry_msgs/msg/TwistWithCovariance", twist=twist)))
        out.put("/dvl", t, out.make("marine_acoustic_msgs/msg/Dvl", velocity_mode=1,
                                    header=out.header(t + dvl_shift, "dvl_link"),
                                    velocity=out.vector(run.nu[i, :3])))
        wrench = out.make("geometry_msgs/msg/Wrench",
                          force=out.vector(run.commands[i, :3] * TO_FLU),
                          torque=out.vector(run.commands[i, 3:] * TO_FLU))
        out.put("/wrench", t, out.make("geometry_msgs/msg/WrenchStamped", wrench=wrench,
                                       header=out.header(t, "base_link_flu")))
    return out


def blueos(path, run):
    """A recording of BlueOS: MAVLink messages as JSON."""
    from mcap.writer import Writer
    pwm, ned = pwm_of(run), run.ned
    with path.open("wb") as file:
        writer, channels = Writer(file), {}
        writer.start()

        def put(t, component, name, **fields):
            topic = f"mavlink/1/{component}/{name}"
            if topic not in channels:
                schema = writer.register_schema(topic.replace("/", "."), "jsonschema", b"{}")
                channels[topic] = writer.register_channel(topic, "json", schema)
            ns = int((1.7e9 + t) * 1e9)
            writer.add_message(channels[topic], ns, json.dumps(
                {"header": {"system_id": 1}, "message": {"type": name, **fields}}).encode(), ns)
        put(0, 1, "HEARTBEAT")
        for name, value in PARAMETERS.items():
            put(0, 1, "PARAM_VALUE", param_id=list(name.ljust(16, "\0")), param_value=value)
        for i, t in enumerate(run.t):
            ms = int(np.rint((BASE_S + t) * 1e3))
            keys = ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
            put(t, 1, "ATTITUDE", time_boot_ms=ms,
                **dict(zip(keys, [*run.attitude[i], *run.nu[i, 3:]])))
            put(t, 1, "LOCAL_POSITION_NED", time_boot_ms=ms,
                **dict(zip(("x", "y", "z", "vx", "vy", "vz"), [*run.position[i], *ned[i]])))
            put(t, 1, "SERVO_OUTPUT_RAW", time_usec=ms * 1000,
                **{f"servo{k + 1}_raw": int(pwm[i, k]) for k in range(8)})
        writer.finish()
