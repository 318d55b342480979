"""The autopilot's modes: what is said of the degrees of freedom that it holds."""
import pytest

import log_writers

WRITERS = {".BIN": log_writers.bin_log, ".tlog": log_writers.tlog, ".ulg": log_writers.ulg_log}
NUMBERS = {".BIN": (19, 2, 4), ".tlog": (19, 2, 4), ".ulg": (0, 1, 14)}  # manual, depth, guided
NAMES = {".BIN": ("MANUAL", "ALT_HOLD", "GUIDED"), ".tlog": ("MANUAL", "ALT_HOLD", "GUIDED"),
         ".ulg": ("MANUAL", "ALTCTL", "OFFBOARD")}
HELD = "the autopilot holds heave, roll, pitch, yaw; auvid fit --closed-loop " \
       "heave,roll,pitch,yaw identifies the others"


@pytest.fixture(params=WRITERS)
def said(request, short, tmp_path, convert):
    """said(which mode from which row on) -> what is said; names; percent of time until a row."""
    def call(*changes):
        path = tmp_path / f"dive{request.param}"
        modes = [(row, NUMBERS[request.param][which]) for row, which in changes]
        path.write_bytes(WRITERS[request.param](short, modes=modes))
        status, text, _ = convert(path)
        assert status == 0
        return text
    t = short.t
    return call, NAMES[request.param], lambda row: 100 * (t[row] - t[0]) / (t[-1] - t[0])


def test_of_depth_hold_the_option_of_fit_is_named(said):
    call, (manual, depth, _), until = said
    a, b = until(15), 100 - until(15)
    assert f"note: {depth} ({b:.0f} %): {HELD}; a CSV cut to {manual} ({a:.0f} %) needs no option" \
        in call((0, 0), (15, 1))


def test_of_an_autopilot_that_drives_nothing_is_identifiable(said):
    call, (_, depth, driven), until = said
    text = call((0, 1), (30, 2))
    assert f"note: {driven} ({100 - until(30):.0f} %): the autopilot drives all degrees" in text
    assert f"note: {depth} ({until(30):.0f} %): {HELD}\n" in text


def test_of_a_pilot_who_drives_nothing_is_said(said):
    call, *_ = said
    assert "autopilot" not in call((0, 0))


def test_a_mode_that_is_not_known_is_named(short, tmp_path, convert):
    path = tmp_path / "dive.BIN"
    path.write_bytes(log_writers.bin_log(short, modes=[(0, 99)]))
    assert "note: mode 99 (100 %): not known to auvid-log; name what it holds" in convert(path)[1]


def test_modes_of_a_vehicle_that_is_no_submarine_are_not_read(short, tmp_path, convert):
    path = tmp_path / "dive.tlog"
    path.write_bytes(log_writers.tlog(short, modes=[(0, 2)], vehicle=2))
    assert "autopilot" not in convert(path)[1]
