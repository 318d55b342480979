"""ROS 2 bags and BlueOS's recordings as series."""
import re

from auvid import ardupilot, bag_file, frames
from auvid.column_map import Fields
from auvid.log_error import LogError
from auvid.mavlink import NAMES, Vehicle
from auvid.series import QUATERNION, RATES, Recording

MAVLINK = re.compile(r"/?mavlink/(\d+)/(\d+)/(\w+)$")
THRUSTER = re.compile(r"thrust\w*?[/_]*(\d+)\b")
STAMP_S = 1.0      # a larger difference of stamp and recording time is another clock
WATER = 2          # velocity_mode of a Dvl


def _xyz(v, flip=False):
    values = [v.x, v.y, v.z]
    return list(frames.FLIP * values) if flip else values


class Reader:
    """Adds decoded messages to the series."""

    def __init__(self, recording, options):
        self.recording, self.options = recording, options
        self.topics = {}      # handler -> its topic
        self.delay = {}       # topic -> stamp against recording time
        self.water = 0
        self.assumed = {}     # topic -> the axes it is taken in
        self.thrusters = {}   # topic -> number in its name

    def flips(self, topic, *names, usual="enu"):
        """Is the message in ENU and FLU (REP 103)? By its frames, or --frames, or as usual."""
        text = " ".join(names).lower()
        named = "ned" if re.search(r"ned|frd", text) else "enu" if re.search(r"enu|flu", text) \
            else None
        if named is None:
            named = self.assumed[topic] = self.options.frames or usual
        return named == "enu"

    def time(self, sample, header):
        """The stamp of the message, or its recording time if it has none."""
        stamp = header.stamp.sec + header.stamp.nanosec * 1e-9
        if stamp == 0 or self.options.clock == "recording":
            return sample.time_s
        self.delay.setdefault(sample.topic, sample.time_s - stamp)
        return stamp

    def take(self, sample, types):
        """Adds a message. Raises LogError if a second topic has the same contents."""
        handler = HANDLERS[sample.kind]
        topic = self.topics.setdefault(handler, sample.topic)
        if topic != sample.topic and handler not in MANY:
            raise LogError(f"two topics with {sample.kind}, {topic} and {sample.topic}: choose "
                           "topics by --only PREFIX[,PREFIX..]")
        handler(self, sample, types.decode(sample))

    def dvl(self, sample, m):
        if m.velocity_mode == WATER:
            self.water += 1
            return
        flip = self.flips(sample.topic, m.header.frame_id, usual="ned")  # Dvl.msg: z is down
        self.recording.add("dvl", self.time(sample, m.header), _xyz(m.velocity, flip),
                           sample.topic)

    def odometry(self, sample, m):
        t = self.time(sample, m.header)
        flip = self.flips(sample.topic, m.header.frame_id, m.child_frame_id)
        q, place = m.pose.pose.orientation, _xyz(m.pose.pose.position)
        add, topic = self.recording.add, sample.topic
        q = [q.w, q.x, q.y, q.z]
        add("quaternion", t, list(frames.ned_frd(q)) if flip else q, topic)
        add("position", t, [place[1], place[0], -place[2]] if flip else place, topic)
        add("velocity", t, _xyz(m.twist.twist.linear, flip), topic)
        add("odometry_rates", t, _xyz(m.twist.twist.angular, flip), topic, RATES)

    def imu(self, sample, m):
        t, flip = self.time(sample, m.header), self.flips(sample.topic, m.header.frame_id)
        self.recording.add("rates", t, _xyz(m.angular_velocity, flip), sample.topic)
        self.recording.add("specific_force", t, _xyz(m.linear_acceleration, flip), sample.topic)
        if m.orientation_covariance[0] >= 0:
            q = [m.orientation.w, m.orientation.x, m.orientation.y, m.orientation.z]
            self.recording.add("imu_quaternion", t, list(frames.ned_frd(q)) if flip else q,
                               sample.topic, QUATERNION)

    def wrench(self, sample, m):
        has_header = hasattr(m, "header")
        t = self.time(sample, m.header) if has_header else sample.time_s
        flip = self.flips(sample.topic, m.header.frame_id if has_header else "")
        w = m.wrench if has_header else m
        self.recording.add("wrench", t, _xyz(w.force, flip) + _xyz(w.torque, flip), sample.topic)

    def battery(self, sample, m):
        self.recording.add("voltage", self.time(sample, m.header), [m.voltage], sample.topic)

    def number(self, sample, m):
        found = THRUSTER.search(sample.topic)
        if found:
            k = self.thrusters.setdefault(sample.topic, int(found.group(1)))
            name = f"thruster_{k}"
            self.recording.add(name, sample.time_s, [m.data], sample.topic, [name])


HANDLERS = {
    "marine_acoustic_msgs/msg/Dvl": Reader.dvl,
    "nav_msgs/msg/Odometry": Reader.odometry,
    "sensor_msgs/msg/Imu": Reader.imu,
    "geometry_msgs/msg/Wrench": Reader.wrench,
    "geometry_msgs/msg/WrenchStamped": Reader.wrench,
    "sensor_msgs/msg/BatteryState": Reader.battery,
    "std_msgs/msg/Float32": Reader.number,
    "std_msgs/msg/Float64": Reader.number,
}
MANY = {Reader.number}  # of these a vehicle has one topic per thruster


def _check_clocks(reader):
    delays = sorted(reader.delay.items(), key=lambda item: item[1])
    if delays and delays[-1][1] - delays[0][1] > STAMP_S:
        (near, a), (far, b) = delays[0], delays[-1]
        raise LogError(f"mixed clocks: the stamps of {far} are {b:.1f} s behind the recording, "
                       f"those of {near} {a:.1f} s; correct the clocks, or use --clock recording")


def _notes(reader, unknown):
    recording = reader.recording
    if reader.water:
        recording.notes.append(f"{reader.water} samples of the DVL are relative to water, and are "
                               "left out")
    axes = {"enu": "forward, left, up (REP 103)", "ned": "forward, right, down"}
    for topic, frame in sorted(reader.assumed.items()):
        other = "ned" if frame == "enu" else "enu"
        recording.notes.append(f"{topic}: its frame does not name its axes: taken as "
                               f"{axes[frame]}; if they are {axes[other]}, use --frames {other}")
    for topic, kind in sorted(unknown.items()):
        recording.notes.append(f"{topic}: type {kind} is not defined in this bag: not read; record "
                               "an .mcap, which holds definitions")


def _finish(recording):
    """One source of rates and attitude; numbers of thrusters from 1."""
    for name, other in (("rates", "odometry_rates"), ("quaternion", "imu_quaternion")):
        spare = recording.series.pop(other, None)
        if spare is not None and name not in recording.series:
            recording.series[name] = spare
    if "thruster_0" in recording.series:
        names = [n for n in recording.series if n.startswith("thruster_")]
        moved = {f"thruster_{int(n[9:]) + 1}": recording.series.pop(n) for n in names}
        for name, series in moved.items():
            series.columns = [name]
        recording.series.update(moved)
        recording.notes.append("thrusters are numbered from 0 in the bag, and from 1 in the CSV")


def _wanted(sample, only):
    return not only or any(sample.topic.strip("/").startswith(prefix.strip("/"))
                           for prefix in only.split(","))


def read(path, options):
    """-> Recording"""
    recording = Recording(path, "ROS 2 bag")
    types, unknown = bag_file.Types(), {}
    reader = Reader(recording, options)
    vehicle = Vehicle(recording, int(options.only) if (options.only or "").isdecimal() else None)
    only = None if vehicle.system is not None else options.only
    mapped = Fields(options.map or {})
    for sample in bag_file.samples(path, types, recording.notes):
        if sample.topic in mapped.by_topic:
            if sample.kind != "json" and not types.knows(sample.kind):
                raise LogError(f"{sample.topic}: type {sample.kind} is not defined in this bag: "
                               "record an .mcap, which holds definitions")
            message = types.decode(sample)
            t = reader.time(sample, message.header) if hasattr(message, "header") else sample.time_s
            mapped.take(recording, t, sample, message)
        elif sample.kind == "json":
            found = MAVLINK.match(sample.topic)
            if found and found.group(3) in NAMES:
                fields = types.decode(sample).get("message", {})
                vehicle.take(int(found.group(1)), int(found.group(2)), found.group(3), fields,
                             sample.time_s)
        elif _wanted(sample, only):
            if sample.kind in HANDLERS:
                reader.take(sample, types)
            elif not types.knows(sample.kind):
                unknown[sample.topic] = sample.kind
    recording.remedies.update(
        rate="publish and record them at 10 Hz or more",
        velocity="record marine_acoustic_msgs/Dvl or nav_msgs/Odometry, or name its topic by --map",
        command="record a Wrench, or a Float64 per thruster, or name its topic by --map",
        attitude="record nav_msgs/Odometry or sensor_msgs/Imu",
        rates="record nav_msgs/Odometry or sensor_msgs/Imu")
    _check_clocks(reader)
    _notes(reader, unknown)
    if vehicle.seen:
        recording.kind = "recording of BlueOS"
        ardupilot.finish(recording)
    _finish(recording)
    mapped.replace(recording)
    return recording
