"""auvid-validate from outside: what is wrong is told in one line, exit status 2."""
import subprocess
import sys

import numpy as np
import pytest

from auvid_validation import reference_smoother
from auvid_validation.compare import Row, close
from auvid_validation.library import load


def auvid_validate(*arguments, **environment):
    return subprocess.run([sys.executable, "-m", "auvid_validation", *arguments],
                          capture_output=True, text=True, env=environment or None, check=False)


@pytest.mark.parametrize("arguments", [
    (), ("nonsense",), ("references", "--only", "nonsense"), ("references", "--nonsense"),
    ("references", "--only", "allocation", "--json", "/nonsense/rows.json"),
    ("optimizer", "--json", "/nonsense/runs.json"),
    ("optimizer", "--runs", "0"), ("optimizer", "--runs", "many"),
    ("peers", "--only", "nonsense"), ("peers", "--first", "-1"),
])
def test_bad_input_is_one_line_and_exit_status_2(arguments):
    done = auvid_validate(*arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("auvid-validate") and done.stderr.count("\n") == 1


def test_a_folder_without_auvid_gives_a_message(tmp_path):
    done = auvid_validate("references", AUVID_ROOT=str(tmp_path))
    assert done.returncode == 2 and "AUVID_ROOT" in done.stderr and done.stderr.count("\n") == 1


def test_a_library_that_is_not_built_gives_the_command_that_builds_it(tmp_path):
    (tmp_path / "lib/include/auvid").mkdir(parents=True)
    (tmp_path / "lib/include/auvid/auvid.h").touch()
    done = auvid_validate("references", "--only", "can", AUVID_ROOT=str(tmp_path))
    assert done.returncode == 2 and "make build/validation/float.so" in done.stderr


def test_a_difference_beyond_the_bound_fails():
    lib, exact = load("float"), np.array([1.0, -3.0])
    assert close(lib, "", "", [(exact * (1 + 1e-7), exact)], "m", 1, "").passed
    assert not close(lib, "", "", [(exact * (1 + 2e-7), exact)], "m", 1, "").passed
    assert not close(lib, "", "", [(exact + [0, np.nan], exact)], "m", 1, "").passed
    assert not close(load("double"), "", "", [(exact * (1 + 2e-9), exact)], "m", 1, "").passed
    assert not Row("", "", np.nan, 1, "", "").passed


def test_a_wrong_coefficient_is_found(monkeypatch):
    lib = load("float")
    right = reference_smoother.coefficients

    def wrong(*arguments):
        c = right(*arguments)
        c[0] *= 1 + 1e-6
        return c
    monkeypatch.setattr(reference_smoother, "coefficients", wrong)
    rows = list(reference_smoother.comparisons(lib))
    assert not all(row.passed for row in rows)
