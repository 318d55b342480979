"""MAVLink messages of ArduSub, from a .tlog or a recording of BlueOS, as series."""
import math

from auvid import ardupilot, modes
from auvid.log_error import LogError

#: Messages that are used.
NAMES = {"ATTITUDE", "LOCAL_POSITION_NED", "SERVO_OUTPUT_RAW", "VISION_POSITION_DELTA",
         "BATTERY_STATUS", "PARAM_VALUE", "HEARTBEAT"}
AUTOPILOT = 1      # component
SUBMARINE = (12, {"type": "MAV_TYPE_SUBMARINE"})  # of a frame, and of JSON


class Vehicle:
    """Takes the messages of one vehicle. system: its id; None: the only one in the log."""

    def __init__(self, recording, system):
        self.recording, self.system, self.seen = recording, system, set()
        self.offset = None  # the vehicle's clock against that of the log

    def take(self, system, component, name, m, received_s):
        """m: the fields by name, as attributes have them in pymavlink."""
        if name == "HEARTBEAT" and component == AUTOPILOT:
            self.seen.add(system)
        if self.system is None and len(self.seen) > 1:
            a, b = sorted(self.seen)[:2]
            raise LogError(f"two vehicles in this log, system ids {a} and {b}: choose one with "
                           f"--only {a}")
        chosen = self.system is None or system == self.system
        if not chosen or (component != AUTOPILOT and name != "VISION_POSITION_DELTA"):
            return
        if name == "PARAM_VALUE":
            name = "".join(m["param_id"]).rstrip("\0")  # in JSON, a list of characters
            self.recording.parameters[name] = float(m["param_value"])
        elif name != "HEARTBEAT":
            self._sample(name, m, received_s)
        elif m.get("type") in SUBMARINE and "custom_mode" in m:
            t = self._time(m, received_s)
            self.recording.add_mode(-math.inf if t is None else t, modes.ARDUSUB, m["custom_mode"])

    def _time(self, m, received_s):
        """The vehicle's time of a message; of one without, from the offset to the log's clock."""
        if "time_boot_ms" in m:
            t = m["time_boot_ms"] * 1e-3
            self.offset = t - received_s
            return t
        return received_s + self.offset if self.offset is not None else None

    def _sample(self, name, m, received_s):
        t, add = self._time(m, received_s), self.recording.add
        if t is None:
            return
        if name == "ATTITUDE":
            add("attitude", t, [m["roll"], m["pitch"], m["yaw"]], name)
            add("rates", t, [m["rollspeed"], m["pitchspeed"], m["yawspeed"]], name)
        elif name == "LOCAL_POSITION_NED":
            add("velocity_ned", t, [m["vx"], m["vy"], m["vz"]], name)
            add("position", t, [m["x"], m["y"], m["z"]], name)
        elif name == "SERVO_OUTPUT_RAW":
            pwm = [float(m.get(f"servo{k}_raw", 0)) for k in range(1, 15)]
            add("pwm", m["time_usec"] * 1e-6, pwm, name)
        elif name == "VISION_POSITION_DELTA":  # its own time is that of another computer
            ardupilot.add_dvl(self.recording, t, m["time_delta_usec"] * 1e-6,
                              m["position_delta"], m["confidence"], name)
        elif name == "BATTERY_STATUS" and m.get("id", 0) == 0 and 0 < m["voltages"][0] < 65535:
            volts = sum(v for v in m["voltages"] if 0 < v < 65535) * 1e-3
            add("voltage", t, [volts], name)
