"""dwarf.py: what the library is, is what Python sees."""
import ctypes

import numpy as np
import pytest

from auvid_validation.library import PARAMETERS, load, values


@pytest.fixture(params=["float", "double"])
def lib(request):
    return load(request.param)


def test_the_real_number_is_that_of_the_build(lib):
    assert lib.real == (np.float32 if "float.so" in lib.path else np.float64)


def test_a_struct_has_the_size_that_the_library_states():
    lib = load("float")
    assert ctypes.sizeof(lib.auvid_can_sender_t) == 40  # can.h says so
    assert ctypes.sizeof(lib.auvid_nav_t) <= 1024  # and nav.h: AUVID_NAV_BYTES


def test_a_function_with_sizes_in_its_name_is_found_by_its_plain_name(lib):
    config, nav = lib.auvid_nav_config_t(), lib.auvid_nav_t()
    lib.auvid_nav_defaults(config)
    assert lib.auvid_nav_init(nav, config) == lib.AUVID_OK
    assert lib.auvid_nav_init(None, config) == lib.AUVID_ERR_NULL
    assert lib.auvid_nav_init(nav, config).name == "AUVID_OK"


def test_a_missing_name_is_an_attribute_error(lib):
    with pytest.raises(AttributeError, match="auvid_nonsense"):
        lib.auvid_nonsense()


def test_an_array_of_another_type_is_refused(lib):
    wrong = np.zeros(6, np.float64 if lib.real == np.float32 else np.float32)
    with pytest.raises(ctypes.ArgumentError):
        lib.auvid_kinematics(0, 0, 0, wrong, wrong)
    with pytest.raises(ctypes.ArgumentError):
        lib.auvid_kinematics(0, 0, 0, lib.zeros(6, 2)[:, 0], lib.zeros(6))
    with pytest.raises(ctypes.ArgumentError):
        lib.auvid_nav_defaults(lib.auvid_nav_t())


def test_parameter_names_are_those_of_the_library(lib):
    vehicle = lib.auvid_girona500
    assert [vehicle.parameter[i].name.decode() for i in range(13)] == PARAMETERS


def test_an_identification_runs_from_python(lib):
    config, chain = lib.chain_config_t(), lib.chain_t()
    lib.chain_defaults(config, 1, 4, 0.0)
    assert lib.chain_run_sets(chain, config, 4) == 0
    lib.chain_finish(chain, 1000, 100_000)
    errors = values(chain.id.estimate.pi)[:13] / values(chain.sim.cfg.parameter) - 1
    assert np.sqrt((errors**2).mean()) < 0.03
