"""Broken logs: for each, the sentence and the exit status."""
import datetime
import re
import sqlite3

import numpy as np
import pytest

import log_writers
from log_writers import Run, bag, bin_log, bin_message, tlog, ulg_log


def joined(*logs):
    return b"".join(logs)


def with_garbage(data, count=100):
    """The data with bytes of no message in the middle."""
    middle = data.find(b"\xa3\x95\x29", len(data) // 2)
    return data[:middle] + bytes(count) + data[middle:]


def clipped(run, count):
    return Run(*(values[:count] for values in run))


def without_parameters(run):
    return bin_log(run, parameters={"VISO_TYPE": 1})


FILES = [  # name of the file, bytes of a run, options, exit status, what is said
    ("empty.BIN", lambda run: b"", [], 1, "no DataFlash message in this file"),
    ("text.BIN", lambda run: b"FMT, 128, 89, FMT, BBnNZ\n" * 50, [], 1, "check that it is a .BIN"),
    ("cut.BIN", lambda run: bin_log(run)[:-10], [], 0, "the file is cut off: it ends within"),
    ("garbage.BIN", lambda run: with_garbage(bin_log(run)), [], 0,
     "100 bytes cannot be read and are skipped"),
    ("two_boots.BIN", lambda run: joined(bin_log(run), bin_log(run)), [], 1,
     "time goes back from 1"),
    ("no_command.BIN", lambda run: bin_log(run, skip=["RCOU"]), [], 1,
     "no command in this log; set bit 10 of LOG_BITMASK"),
    ("no_velocity.BIN", lambda run: bin_log(run, skip=["VISO", "XKF1"]), [], 1,
     "no velocity in this log; the log has neither VISO nor XKF1"),
    ("nothing.BIN", lambda run: bin_log(run, skip=["VISO", "XKF1", "RCOU"]), [], 1,
     "no velocity and no command in this log"),
    ("no_attitude.BIN", lambda run: bin_log(run, skip=["VISO", "ATT"]), [], 1,
     "no attitude in this log; set bit 0 of LOG_BITMASK"),
    ("dvl_only.BIN", lambda run: bin_log(run, skip=["ATT"]), [], 0,
     "no attitude in this log: roll and pitch are taken as zero; set bit 0 of LOG_BITMASK"),
    ("no_rates.BIN", lambda run: bin_log(run, skip=["IMU"]), [], 0,
     "no rates in this log: roll, pitch and yaw cannot be identified; set bit 7 of LOG_BITMASK"),
    ("format.BIN", lambda run: joined(log_writers.bin_format("ATT", 20), bin_log(run)), [], 1,
     "the format of ATT does not have the length"),
    ("other_clock.BIN", lambda run: bin_log(run, viso_shift=1e5), [], 1,
     "mixed clocks: "),
    ("jump.BIN", lambda run: joined(bin_log(run), bin_message("BAT", int(1e12), 0, 15.0)), [], 1,
     "BAT: time jumps from 1"),
    ("one.BIN", lambda run: joined(bin_log(run, skip=["BAT"]), bin_message(
        "BAT", int(110e6), 0, 15.0)), [], 0, "BAT: only one sample: left out"),
    ("no_parameters.BIN", without_parameters, [], 0, "SERVOn_FUNCTION) are not in the log"),
    ("two.tlog", lambda run: tlog(run, systems=(1, 7)), [], 1,
     "two vehicles in this log, system ids 1 and 7: choose one with --only 1"),
    ("two_chosen.tlog", lambda run: tlog(run, systems=(1, 7)), ["--only", "7"], 0, "the raw DVL"),
    ("absent.tlog", lambda run: tlog(run), ["--only", "3"], 1,
     "no vehicle with system id 3: this log has 1"),
    ("noise.tlog", lambda run: np.random.default_rng(1).bytes(5000), [], 1,
     "no heartbeat of an autopilot"),
    ("cut.tlog", lambda run: tlog(run)[:-5], [], 0, "the file is cut off"),
    ("flipped.tlog", lambda run: with_flipped_bit(tlog(run)), [], 0, "bytes cannot be read"),
    ("header.ulg", lambda run: b"PX4" + ulg_log(run), [], 1, "no ULog header in this file"),
    ("cut.ulg", lambda run: ulg_log(run)[:-3], [], 0, "the file is cut off"),
    ("definition.ulg", lambda run: ulg_log(run).replace(b"float[4] q;", b"flo_t[4] q;"), [], 1,
     "a definition of this ULog cannot be read"),
    ("no_attitude.ulg", lambda run: ulg_log(run, skip=["vehicle_attitude",
                                                       "vehicle_visual_odometry"]), [], 1,
     "no attitude in this log; log vehicle_attitude"),
    ("profile.ulg", lambda run: ulg_log(run, parameters={"SDLOG_PROFILE": 1}), [], 0,
     "set SDLOG_PROFILE=9 (it is 1)"),
    ("noise.mcap", lambda run: bytes(1000), [], 1, "no message in this file"),
    ("noise.db3", lambda run: bytes(range(256)) * 8, [], 1, "the database cannot be read"),
]


def with_flipped_bit(data):
    """One bit of an attitude in the middle."""
    out, middle = bytearray(data), len(data) // 2
    at = next(i for i in range(middle, len(data)) if data[i] == 0xFD and data[i + 7] == 30)
    out[at + 20] ^= 4
    return bytes(out)


@pytest.mark.parametrize("name,make", [("zeros.BIN", bin_log), ("zeros.tlog", tlog)])
def test_zeros_behind_the_last_message_are_skipped_and_are_no_cut(name, make, short, tmp_path,
                                                                  convert):
    (tmp_path / name).write_bytes(make(short) + bytes(200))
    status, said, rows = convert(tmp_path / name)
    assert status == 0 and len(np.unique(rows["t_s"])) >= 60, said
    assert "200 bytes cannot be read and are skipped" in said and "cut off" not in said, said


@pytest.mark.parametrize("name,make,options,status,sentence", FILES, ids=[f[0] for f in FILES])
def test_a_broken_file_is_told_in_a_sentence(name, make, options, status, sentence, short, tmp_path,
                                             convert):
    (tmp_path / name).write_bytes(make(short))
    found, said, _ = convert(tmp_path / name, *options)
    assert found == status and sentence in said, said
    assert status == 0 or (said.count("\n") == 1 and name in said), said


def extra(path, topic, kind, run):
    """A bag with one more topic, of a type that nobody defines."""
    whole = bag(run)
    whole.messages += [(topic, kind, m[2], m[3]) for m in whole.messages[:3]]
    whole.database(path)


def second(path, run):
    """A bag with two odometries."""
    whole = bag(run)
    whole.messages += [("/other" + m[0], *m[1:]) for m in whole.messages if m[0] == "/odom"]
    whole.mcap(path)


def cut(path, run):
    bag(run).mcap(path, chunk=4096)
    path.write_bytes(path.read_bytes()[:-path.stat().st_size // 2])


def no_topics(path, run):
    with sqlite3.connect(path) as file:
        file.execute("create table notes(id integer)")
    file.close()


def water(path, run):
    """The DVL has lost the bottom after the first samples."""
    whole, out = bag(run), log_writers.Bag()
    for topic, kind, ns, data in whole.messages:
        if topic == "/dvl" and ns > whole.messages[60][2]:
            message = whole.store.deserialize_cdr(data, kind)
            message.velocity_mode = 2
            data = bytes(whole.store.serialize_cdr(message, kind))
        out.messages.append((topic, kind, ns, data))
    out.mcap(path)


def without(topic):
    def write(path, run):
        whole = bag(run)
        whole.messages = [m for m in whole.messages if m[0] != topic]
        whole.mcap(path)
    return write


BAGS = [  # name, function of path and run, options, exit status, what is said
    ("cut.mcap", cut, [], 0, "the file is cut off: it ends within a record"),
    ("clocks.mcap", lambda path, run: bag(run, dvl_shift=-3600).mcap(path), [], 1,
     "mixed clocks: the stamps of /dvl are 3600.0 s behind the recording"),
    ("clocks_set.mcap", lambda path, run: bag(run, dvl_shift=-3600).mcap(path),
     ["--clock", "recording"], 0, "/dvl, the raw DVL; not used: /odom"),
    ("two.mcap", second, [], 1, "two topics with nav_msgs/msg/Odometry, /odom and /other/odom"),
    ("two_chosen.mcap", second, ["--only", "/odom,/wrench"], 0, "velocity: /odom, filtered"),
    ("unknown.db3", lambda path, run: extra(path, "/usbl", "my_msgs/msg/Fix", run), [], 0,
     "/usbl: type my_msgs/msg/Fix is not defined in this bag: not read"),
    ("other.db3", no_topics, [], 1, "no table of topics in this file"),
    ("no_command.mcap", without("/wrench"), [], 1, "no command in this log; record a Wrench"),
    ("water.mcap", water, [], 0, "samples of the DVL are relative to water, and are left out"),
    ("frames.mcap", lambda path, run: bag(run).mcap(path), [], 0,
     "/odom: its frame does not name its axes: taken as forward, left, up (REP 103)"),
    ("dvl_frame.mcap", lambda path, run: bag(run).mcap(path), [], 0,
     "/dvl: its frame does not name its axes: taken as forward, right, down; if they are "),
]


@pytest.mark.parametrize("name,make,options,status,sentence", BAGS, ids=[b[0] for b in BAGS])
def test_a_broken_bag_is_told_in_a_sentence(name, make, options, status, sentence, short, tmp_path,
                                            convert):
    make(tmp_path / name, clipped(short, 40))
    found, said, _ = convert(tmp_path / name, *options)
    assert found == status and sentence in said, said
    assert status == 0 or (said.count("\n") == 1 and name in said), said


MAP = """[t_s]
from = time
unit = ms
[u_mps]
from = vx
[v_mps]
from = vy
unit = cm/s
frame = enu
[psi_rad]
from = heading
unit = deg
frame = enu
[cmd_surge]
from = stick
sign = -1
"""
HEADER = "time,vx,vy,heading,stick\n"
ROWS = [f"{100 * i},{0.3 * (i % 5)},{2 * i},{i},{(-1) ** (i // 9)}\n" for i in range(99)]
TABLE = "".join([HEADER, *ROWS])


def test_a_table_is_read_by_its_map(tmp_path, convert):
    (tmp_path / "map.ini").write_text(MAP)
    (tmp_path / "dive.csv").write_text(TABLE)
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0, said
    i = np.arange(99)
    assert np.allclose(rows["t_s"], 0.1 * i) and np.allclose(rows["u_mps"], 0.3 * (i % 5))
    assert np.allclose(rows["v_mps"], -0.02 * i)
    assert np.allclose(rows["psi_rad"], np.pi / 2 - np.radians(i))
    assert np.array_equal(rows["cmd_surge"], -(-1.0) ** (i // 9))
    assert "note: no rates in this log" in said and "no attitude" not in said
    assert "velocity: vx, vy, as mapped\n" in said


def test_an_attitude_of_ros_is_turned_into_ned(tmp_path, convert):
    """Angles of the same attitude: roll as it is, pitch down, heading from the north."""
    names = ["qx", "qy", "qz", "qw"]
    (tmp_path / "map.ini").write_text("[u_mps]\nfrom = v\n[cmd_surge]\nfrom = v\n" + "".join(
        f"[{name}]\nfrom = {name}\nframe = enu\n" for name in names))
    lines = ["t_s,v," + ",".join(names)]
    for i in range(99):
        a, b, c = 0.1, -0.2, 0.03 * i  # half of roll, pitch, yaw in forward, left, up
        x, y, z = (np.array([np.cos(t), *(np.sin(t) * e)]) for t, e in zip((a, b, c), np.eye(3)))
        w = [_times(_times(z, y), x)[k] for k in (1, 2, 3, 0)]
        lines.append(f"{0.1 * i},{0.1 * (i % 5)}," + ",".join(f"{part:.9f}" for part in w))
    (tmp_path / "dive.csv").write_text("\n".join([*lines, ""]))
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0, said
    w, x, y, z = (rows[name] for name in ("qw", "qx", "qy", "qz"))
    assert np.allclose(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), 0.2)
    assert np.allclose(np.arcsin(2 * (w * y - z * x)), 0.4)
    heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    turn = heading - (np.pi / 2 - 0.06 * np.arange(99))
    assert np.allclose(np.cos(turn), 1)


def _times(a, b):
    return np.r_[a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])]


class Datetime310(datetime.datetime):
    """Reads no more than that of Python 3.10."""

    @classmethod
    def fromisoformat(cls, text):
        assert re.fullmatch(r"[\d-]+.[\d:]{8}(\.\d{3}(\d{3})?)?([+-]\d\d:\d\d)?", text), text
        return super().fromisoformat(text)


@pytest.mark.parametrize("form,separator", [
    ("2026-05-01T23:59:5{}.{}00Z", ","), ("2026-05-01 23:59:5{}.{}", ","),
    ("2026-05-02T01:59:5{},{}+02:00", ";")])
def test_times_may_be_iso_8601(form, separator, tmp_path, convert, monkeypatch):
    monkeypatch.setattr(datetime, "datetime", Datetime310)
    (tmp_path / "map.ini").write_text(MAP.replace("unit = ms", "unit = ISO 8601"))
    lines = [HEADER.split(",")] + [[form.format(*divmod(i, 10)), *row.split(",")[1:]]
                                   for i, row in enumerate(ROWS)]
    (tmp_path / "dive.csv").write_text("".join(separator.join(line) for line in lines))
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and np.allclose(rows["t_s"], 0.1 * np.arange(99), atol=1e-5), said


def test_semicolons_or_tabs_may_separate_columns_with_decimal_commas(tmp_path, convert):
    (tmp_path / "map.ini").write_text(MAP)
    for separator, point in ((",", "."), (";", "."), (";", ","), ("\t", ",")):
        (tmp_path / "dive.csv").write_text(
            TABLE.translate(str.maketrans({",": separator, ".": point})))
        status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
        assert status == 0 and np.allclose(rows["u_mps"], 0.3 * (np.arange(99) % 5)), said


@pytest.mark.parametrize("before", ["# my dive\n# the time, in ms\n", "# ", "# my dive\n#"])
def test_comments_before_the_header_are_skipped(before, tmp_path, convert):
    (tmp_path / "map.ini").write_text(MAP)
    (tmp_path / "dive.csv").write_text(before + TABLE)
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and np.allclose(rows["u_mps"], 0.3 * (np.arange(99) % 5)), said


@pytest.mark.parametrize("cut", [2, 6])  # within the last number, and within the row
def test_a_table_that_is_cut_off_is_read_up_to_the_cut(cut, tmp_path, convert):
    (tmp_path / "map.ini").write_text(MAP)
    (tmp_path / "dive.csv").write_text(TABLE[:-cut])
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and "note: the last line has no line end and may be cut off" in said, said
    assert len(rows["t_s"]) == 98


@pytest.mark.parametrize("resample", [[], ["--resample", "velocity"]])
def test_a_weight_that_is_logged_when_it_changes_holds_until_then(resample, tmp_path, convert):
    weight = {0: 0, 30: 2, 60: 0}  # by row
    first, *lines = TABLE.splitlines()
    (tmp_path / "map.ini").write_text(MAP + "[weight_N]\nfrom = ballast\nunit = kN\n")
    (tmp_path / "dive.csv").write_text("\n".join(
        [first + ",ballast", *(f"{line},{weight.get(i, '')}" for i, line in enumerate(lines)), ""]))
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"),
                                 *resample)
    assert status == 0 and len(rows["t_s"]) == 99, said
    on = (rows["t_s"] > 2.95) & (rows["t_s"] < 5.95)
    told = rows["weight_N"] if resample else rows["weight_N"][[*weight]]
    assert np.array_equal(told, np.where(on, 2000, 0) if resample else [0, 2000, 0])


NED = {"vn_mps": "VN", "ve_mps": "VE\nunit = cm/s", "vd_mps": "VD",
       "phi_rad": "Roll\nunit = deg", "theta_rad": "Pitch\nunit = deg",
       "psi_rad": "Yaw\nunit = deg", "cmd_surge": "stick"}


def _write_ned(folder, run, sections):
    """The run, as an autopilot's export has it: its filter's velocity, and degrees. And its map."""
    rows = np.column_stack([run.t, run.ned * [1, 100, 1], np.degrees(run.attitude),
                            np.sign(np.sin(run.t))])
    (folder / "dive.csv").write_text("t_s,VN,VE,VD,Roll,Pitch,Yaw,stick\n" + "".join(
        ",".join(f"{cell:.9f}" for cell in row) + "\n" for row in rows))
    (folder / "map.ini").write_text("".join(f"[{column}]\nfrom = {source}\n"
                                            for column, source in sections.items()))


@pytest.mark.parametrize("down", ["VD", "VD\nsign = -1\nframe = enu"])
def test_velocities_along_north_east_and_down_become_those_in_body_axes(down, short, tmp_path,
                                                                        convert):
    moved = Run(short.t, short.attitude + [0.2, -0.1, 1.0], *short[2:])
    _write_ned(tmp_path, moved, NED | {"vd_mps": down})
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and "velocity: VN, VE, VD, as mapped\n" in said, said
    found = np.column_stack([rows[name] for name in ("u_mps", "v_mps", "w_mps")])
    assert np.allclose(found, moved.nu[:, :3], atol=1e-6)


@pytest.mark.parametrize("without,status,sentence", [
    (["vd_mps"], 2, "north, east and down need all of vn_mps, ve_mps, vd_mps"),
    (["phi_rad"], 1, "no complete attitude in this log; name its columns in the map: phi_rad, "),
    (["phi_rad", "theta_rad", "psi_rad"], 1, "no attitude in this log; name its columns in the")])
def test_velocities_along_north_east_and_down_need_all_and_an_attitude(without, status, sentence,
                                                                       short, tmp_path, convert):
    _write_ned(tmp_path, short, {name: NED[name] for name in NED if name not in without})
    found, said, _ = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert found == status and sentence in said and said.count("\n") == 1, said


def test_pulse_widths_of_thrusters_stay_in_microseconds(tmp_path, convert):
    (tmp_path / "map.ini").write_text(
        MAP.replace("[cmd_surge]", "[thruster_1]").replace("sign = -1", "unit = us"))
    (tmp_path / "dive.csv").write_text("".join(
        [HEADER, *(row.rpartition(",")[0] + f",{1500 + 300 * (-1) ** (i // 9)}\n"
                   for i, row in enumerate(ROWS))]))
    status, said, rows = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and "never change" not in said, said
    assert np.array_equal(np.unique(rows["thruster_1"]), [1200, 1800])


def test_fields_of_a_bag_are_read_by_a_map(short, tmp_path, convert):
    (tmp_path / "map.ini").write_text("[u_mps]\nfrom = /odom twist.twist.linear.x\n"
                                      "[v_mps]\nfrom = /odom twist.twist.linear.y\nframe = enu\n")
    bag(short).mcap(tmp_path / "dive.mcap")
    status, said, rows = convert(tmp_path / "dive.mcap", "--map", str(tmp_path / "map.ini"),
                                 "--only", "/wrench")
    assert status == 0, said
    assert np.allclose(rows["u_mps"], short.nu[:, 0]) and np.allclose(rows["v_mps"], short.nu[:, 1])


def test_a_map_replaces_what_the_bag_has_and_a_column_given_twice_is_refused(short, tmp_path,
                                                                             convert):
    bag(short).mcap(tmp_path / "dive.mcap")
    (tmp_path / "map.ini").write_text("[u_mps]\nfrom = /odom twist.twist.linear.x\nsign = -1\n")
    status, said, rows = convert(tmp_path / "dive.mcap", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and np.allclose(rows["u_mps"], -short.nu[:, 0]), said
    assert "velocity: /odom, as mapped\n" in said, said
    (tmp_path / "map.ini").write_text("".join(
        f"[{name}]\nfrom = /odom {field}\n" for name, field in [
            *((f"q{k}", f"pose.pose.orientation.{k}") for k in "wxyz"),
            *((f"v{k}_mps", f"twist.twist.linear.{axis}") for k, axis in zip("ned", "xyz"))]))
    status, said, rows = convert(tmp_path / "dive.mcap", "--map", str(tmp_path / "map.ini"))
    assert status == 0 and "velocity: /odom, as mapped; not used: /dvl\n" in said, said
    (tmp_path / "map.ini").write_text("[X_N]\nfrom = /odom twist.twist.linear.x\n")
    status, said, _ = convert(tmp_path / "dive.mcap", "--map", str(tmp_path / "map.ini"))
    assert status == 1 and "X_N is given twice, by /wrench and /odom" in said, said


TABLES = [  # map, table, exit status, what is said
    (MAP, TABLE.replace("vx", "speed"), 1, "no column vx (for u_mps) in the header; its columns"),
    (MAP, TABLE.replace(",6,3,1", ",fast,3,1"), 1,
     "line 5: vy: 'fast' is not a number"),
    (MAP, "# my dive\n# a pool\n" + TABLE.replace(",6,3,1", ",fast,3,1"), 1,
     "line 7: vy: 'fast' is not a number"),
    (MAP, TABLE.replace(",6,3,1", ",6,3"), 1, "line 5: the row does not have the 5 columns of"),
    (MAP, TABLE + "".join(ROWS), 1,
     "time goes back from 9.800 to 0.000 s: the log holds two recordings; split it"),
    (MAP, TABLE + 2 * "".join(ROWS), 1, "the log holds 3 recordings; split it"),
    (MAP, "".join([HEADER, *reversed(ROWS)]), 1, "it does so 9 times; sort the rows by time"),
    (MAP.replace("[u_mps]", "[speed]"), TABLE, 2, "[speed] is no column of auvid"),
    (MAP.replace("cm/s", "furlong"), TABLE, 2, "[v_mps]: unit = furlong: use one of"),
    (MAP.replace("cm/s", "ISO 8601"), TABLE, 2, "[v_mps]: unit = ISO 8601: use one of"),
    (MAP.replace("cm/s", "mm"), TABLE, 2,
     "[v_mps]: unit = mm: use one of m/s, cm/s, mm/s, km/h, ft/s, kn\n"),
    (MAP.replace("deg", "m/s"), TABLE, 2, "[psi_rad]: unit = m/s: use one of rad, deg\n"),
    (MAP + "[thruster_1]\nfrom = vx\nunit = kn\n", TABLE, 2,
     "[thruster_1]: unit = kn: use one of 1, %, N, kN, kgf, rpm, us\n"),
    (MAP + "[thruster_1_N]\nfrom = vx\nunit = %\n", TABLE, 2,
     "[thruster_1_N]: unit = %: use one of N, kN, kgf\n"),
    (MAP + "[rpm_1]\nfrom = vx\nunit = %\n", TABLE, 2, "[rpm_1]: unit = %: use one of rpm\n"),
    (MAP + "[cmd_yaw]\nfrom = vx\nunit = us\n", TABLE, 2,
     "[cmd_yaw]: unit = us: use one of 1, %\n"),
    (MAP.replace("ms", "ISO 8601"), TABLE, 1, "line 2: time: '0' is not a time in ISO 8601"),
    (MAP.replace("sign", "scale"), TABLE, 2, "[cmd_surge]: unknown key scale"),
    (MAP + "[qw]\nfrom = vx\nframe = enu\n", TABLE, 2, "frame = enu of a quaternion needs all of"),
    ("", TABLE, 2, "no section: write one for each column"),
    (MAP.replace("from = vx", ""), TABLE, 2, "[u_mps]: no key from"),
]


@pytest.mark.parametrize("ini,table,status,sentence", TABLES)
def test_a_broken_table_or_map_is_told_in_a_sentence(ini, table, status, sentence, tmp_path,
                                                     convert):
    (tmp_path / "map.ini").write_text(ini)
    (tmp_path / "dive.csv").write_text(table)
    found, said, _ = convert(tmp_path / "dive.csv", "--map", str(tmp_path / "map.ini"))
    assert found == status and sentence in said and said.count("\n") == 1, said


def test_wrong_usage_is_told_in_a_line_with_status_2(tmp_path, convert):
    (tmp_path / "dive.xyz").write_text("")
    (tmp_path / "out.csv").write_text("t_s\n")
    for path, options, sentence in [
            ("dive.xyz", [], "unknown suffix"), ("none.BIN", [], "no such file"),
            ("dive.xyz", ["--resample", "fast"], "neither velocity nor a rate"),
            ("dive.xyz", ["--frames", "up"], "invalid choice")]:
        status, said, _ = convert(tmp_path / path, *options)
        assert status == 2 and sentence in said and said.count("\n") == 1, said
    (tmp_path / "dive.ulg").write_bytes(b"")
    for option, value in (("--only", "1"), ("--map", "map.ini"), ("--frames", "ned")):
        status, said, _ = convert(tmp_path / "dive.ulg", option, value)
        assert status == 2 and f"{option} is not for a .ulg" in said and said.count("\n") == 1, said
    (tmp_path / "dive.csv").write_text("t_s\n")
    status, said, _ = convert(tmp_path / "dive.csv")
    assert status == 2 and "a .csv needs --map" in said
    status, said, _ = convert(tmp_path / "dive.csv", "--map", "map.ini", "--vehicle", "mine.ini")
    assert status == 2 and "--vehicle is not for a .csv: give a thruster that" in said, said


def test_a_log_is_never_overwritten(tmp_path, short, capsys):
    from auvid import cli
    path = tmp_path / "dive.BIN"
    path.write_bytes(bin_log(short))
    with pytest.raises(SystemExit) as end:
        cli.main([str(path), "-o", str(path)])
    assert end.value.code == 2 and "is the log itself" in capsys.readouterr().err
    assert path.read_bytes() == bin_log(short)


def test_a_sample_of_the_dvl_without_lock_is_left_out(short, tmp_path, convert):
    end = log_writers.BASE_S + short.t[-1]
    lost = [bin_message("VISO", int((end + k / 10) * 1e6), 0.1, 0, 0, 0, 9.0, 0, 0, 0)
            for k in range(1, 5)]
    (tmp_path / "lost.BIN").write_bytes(joined(bin_log(short), *lost))
    rows = convert(tmp_path / "lost.BIN")[2]
    assert np.nanmax(rows["u_mps"]) < 5 and np.sum(np.isfinite(rows["u_mps"])) == len(short.t)


def test_a_log_that_starts_again_in_the_same_second_loses_only_late_samples(short, tmp_path,
                                                                            convert):
    late = bin_message("BAT", int((log_writers.BASE_S + short.t[-1] - 0.5) * 1e6), 0, 15.0)
    (tmp_path / "late.BIN").write_bytes(bin_log(short) + late)
    status, said, _ = convert(tmp_path / "late.BIN")
    assert status == 0 and "BAT: 1 samples came late" in said
