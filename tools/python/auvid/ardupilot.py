"""What ArduSub's logs have in common: thrusters, the DVL, and parameters that limit a log."""
import numpy as np

from auvid.series import COMMANDS

#: Factors of roll, pitch, yaw, throttle (up), forward, lateral (right) in the output of each
#: motor, by FRAME_CONFIG: AP_Motors6DOF::setup_motors of ArduSub.
_SIMPLE = [(0, 0, -1, 0, 1, 0), (0, 0, 1, 0, 1, 0), (0, 0, 0, -1, 0, 0), (0, 0, 0, -1, 0, 0),
           (0, 0, 0, 0, 0, 1)]
_CORNERS = [(0, 0, 1, 0, -1, 1), (0, 0, -1, 0, -1, -1), (0, 0, -1, 0, 1, 1), (0, 0, 1, 0, 1, -1)]
FRAMES = {
    0: [(0, 0, -1, 0, 1, 0), (0, 0, 1, 0, 1, 0), (-.5, .5, 0, .45, 0, 0), (.5, .5, 0, .45, 0, 0),
        (0, -1, 0, 1, 0, 0), (-.25, 0, 0, 0, 0, 1)],
    1: [*_CORNERS, (1, 0, 0, -1, 0, 0), (-1, 0, 0, -1, 0, 0)],
    2: [*_CORNERS, (1, -1, 0, -1, 0, 0), (-1, -1, 0, -1, 0, 0), (1, 1, 0, -1, 0, 0),
        (-1, 1, 0, -1, 0, 0)],
    3: [(1, 1, 0, 1, 0, 0), (0, 0, 1, 0, 1, 0), (1, -1, 0, 1, 0, 0), (0, 0, 0, 0, 0, 1),
        (0, 0, 0, 0, 0, 1), (-1, 1, 0, 1, 0, 0), (0, 0, -1, 0, 1, 0), (-1, -1, 0, 1, 0, 0)],
    4: _SIMPLE[:3], 5: _SIMPLE[:4], 6: _SIMPLE,
}
#: SERVOn_FUNCTION of the motors 1 to 12.
MOTOR = {**{33 + k: k + 1 for k in range(8)}, **{82 + k: k + 9 for k in range(4)}}
GPS = 3            # EK3_SRC1_VELXY
LOG_BITS = {0: "attitude and motion at the rate of the loop", 7: "the IMU", 9: "the battery",
            10: "thruster outputs"}


def add_dvl(recording, t, dt, moved, confidence, origin):
    """A sample of the DVL: the way [m] moved in dt [s], in body axes. Confidence 0: no lock."""
    if dt > 0 and confidence > 0:
        recording.add("dvl", t, [way / dt for way in moved], origin)


def mixer(frame):
    """[6, motors]: commands of the degrees of freedom from those of the motors."""
    roll, pitch, yaw, up, forward, right = np.array(FRAMES[frame], float).T
    rows = np.stack([forward, right, -up, roll, pitch, yaw])
    return rows / np.maximum(np.sum(rows * rows, axis=1, keepdims=True), 1e-9)


def _outputs(recording):
    """Output of each motor, from 0, and its direction. Without parameters: as the outputs are."""
    p = recording.parameters
    output = {MOTOR[int(p[f"SERVO{n + 1}_FUNCTION"])]: n for n in range(14)
              if int(p.get(f"SERVO{n + 1}_FUNCTION", 0)) in MOTOR}
    motors = max(output, default=0)
    sign = [p.get(f"MOT_{k}_DIRECTION", 1.0) for k in range(1, motors + 1)]
    return [output.get(k) for k in range(1, motors + 1)], sign


def _thrusters(recording):
    """Replaces the outputs [us] by commands of thrusters (-1..1) and of degrees of freedom."""
    output, sign = _outputs(recording)
    if None in output or not output:
        recording.notes.append(
            "the parameters of the outputs (SERVOn_FUNCTION) are not in the log: outputs 1 to 8 "
            "are taken for thrusters 1 to 8, as wired; log the parameters to have their directions")
        output, sign = list(range(8)), [1.0] * 8
    frame = int(recording.parameters.get("FRAME_CONFIG", -1))
    known = frame in FRAMES and len(FRAMES[frame]) == len(output)
    if not known:
        recording.notes.append(
            f"FRAME_CONFIG is {frame if frame >= 0 else 'not in the log'}, with {len(output)} "
            "thrusters: no commands cmd_surge .. cmd_yaw, only thruster_1 .. ; they need a vehicle "
            "file")
    matrix = mixer(frame) if known else np.zeros((0, len(output)))
    used = [np.any(row) for row in matrix]
    recording.geometry = matrix.T if known else None
    columns = [f"thruster_{k + 1}" for k in range(len(output))] + \
        [name for name, use in zip(COMMANDS, used) if use]

    def function(pwm):
        pwm = pwm[:, output]
        u = np.where(pwm > 0, (pwm - 1500) / 400, 0.0) * sign + 0.0  # an output of 0 is off
        return np.hstack([u, u @ matrix[used].T]) if known else u
    recording.derived["pwm"] = (columns, function)


def _sources(recording):
    """What is said of the velocity."""
    p, viso = recording.parameters, recording.parameters.get("VISO_TYPE", 0)
    if "dvl" in recording.series:
        return
    source = p.get("EK3_SRC1_VELXY")
    what = f"no DVL ({'VISO' if viso == 0 else 'no sample of VISO'})"
    if source == GPS:
        recording.notes.append(f"{what}, EK3_SRC1_VELXY=3: velocity is of GPS at the surface; "
                               "with a DVL set VISO_TYPE=1 and EK3_SRC1_VELXY=6")
    else:
        setting = "" if source is None else f", EK3_SRC1_VELXY={source:.0f}"
        recording.notes.append(f"{what}{setting}: velocity is the filter's, not measured; "
                               "with a DVL set VISO_TYPE=1 and EK3_SRC1_VELXY=6")


def _settings(recording):
    """What to set before the next dive."""
    p, mask = recording.parameters, recording.parameters.get("LOG_BITMASK")
    if mask is not None:
        lacking = [bit for bit in LOG_BITS if not int(mask) >> bit & 1]
        if lacking:
            better = int(mask) | sum(1 << bit for bit in lacking)
            recording.notes.append(
                f"before the next dive set LOG_BITMASK={better} (it is {mask:.0f}): "
                f"logs {', '.join(LOG_BITS[bit] for bit in lacking)}")
    if p.get("LOG_DISARMED") == 0:
        recording.notes.append("before the next dive set LOG_DISARMED=1: the log then has the "
                               "vehicle at rest before it is armed")


def finish(recording):
    """Turns outputs into commands, and adds the notes."""
    is_bin = recording.path.suffix.lower() == ".bin"
    recording.remedies.update(
        rate="log them at 10 Hz" if is_bin else "use the .BIN, 10 Hz",
        velocity="the log has neither VISO nor XKF1: log them (a DVL with VISO_TYPE=1, EKF3)",
        command="set bit 10 of LOG_BITMASK, which logs the outputs",
        attitude="set bit 0 of LOG_BITMASK, which logs the attitude",
        rates="set bit 7 of LOG_BITMASK, which logs the IMU")
    if "pwm" in recording.series:
        _thrusters(recording)
    _sources(recording)
    _settings(recording)
