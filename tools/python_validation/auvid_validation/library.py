"""The folder of the repository, and the library in each precision for Python (dwarf.py)."""
import functools
import os
import pathlib

import numpy as np

from auvid_validation.user_error import UserError
from auvid_validation.dwarf import Binding

MARK = "lib/include/auvid/auvid.h"
#: Names of the 13 parameters, in the library's order.
PARAMETERS = "m_u m_v m_w m_r W-B X_u X_uu Y_v Y_vv Z_w Z_ww N_r N_rr".split()


@functools.cache
def root():
    """The repository: AUVID_ROOT, or above this file or the current directory."""
    places = [pathlib.Path(__file__).resolve(), pathlib.Path.cwd() / "here"]
    if "AUVID_ROOT" in os.environ:
        places = [pathlib.Path(os.environ["AUVID_ROOT"]) / "here"]
    for place in places:
        for folder in place.parents:
            if (folder / MARK).exists():
                return folder
    raise UserError(f"no {MARK} in any folder above: set AUVID_ROOT to the folder of auvid")


def built(path):
    """A file built by make."""
    if not (root() / path).exists():
        raise UserError(f"{path} is not built: run `make {path}`")
    return root() / path


@functools.cache
def load(precision="float"):
    """The library with the simulator and tests/support, "float" or "double"."""
    return Binding(built(f"build/validation/{precision}.so"))


def values(array):
    """A numpy view of a ctypes array of any dimensions, without a copy."""
    return np.ctypeslib.as_array(array)


def program():
    """build/auvid, for complete runs: demo, fit, replay."""
    return built("build/auvid")
