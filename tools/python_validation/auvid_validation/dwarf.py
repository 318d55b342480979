"""C types, enumerations and functions of a shared library for ctypes, read from the debugging
information of the library (DWARF): nothing is written twice, so nothing can be out of date.

    binding = Binding("build/validation/float.so")
    config = binding.auvid_nav_config_t()           a struct, by its typedef or tag
    binding.auvid_nav_defaults(config)              a function; structs are passed by reference
    binding.auvid_nav_init(nav, config)             ... whose link-time name has a suffix of sizes
    binding.AUVID_DVL_ALL                           an enumerator
    binding.auvid_girona500.parameters              a variable

A function takes numpy arrays (of the element's type, contiguous) and sequences for pointers to
numbers. Sequences are copied, so outputs must be arrays. An enumeration is returned as an
IntEnum.
"""
import ctypes
import enum
import re

import numpy as np
from elftools.elf.elffile import ELFFile

INTEGERS = {(1, True): ctypes.c_int8, (2, True): ctypes.c_int16, (4, True): ctypes.c_int32,
            (8, True): ctypes.c_int64, (1, False): ctypes.c_uint8, (2, False): ctypes.c_uint16,
            (4, False): ctypes.c_uint32, (8, False): ctypes.c_uint64}
FLOATS = {4: ctypes.c_float, 8: ctypes.c_double, 16: ctypes.c_longdouble}
ADDRESS, BOOLEAN, FLOAT, SIGNED, SIGNED_CHAR = 1, 2, 4, 5, 6  # DW_ATE_...
TYPES = {"DW_TAG_typedef", "DW_TAG_structure_type", "DW_TAG_union_type", "DW_TAG_enumeration_type"}
QUALIFIERS = {"DW_TAG_const_type", "DW_TAG_volatile_type", "DW_TAG_restrict_type",
              "DW_TAG_typedef"}


def name_of(die):
    return die.attributes["DW_AT_name"].value.decode() if "DW_AT_name" in die.attributes else None


def value_of(die, attribute, default=None):
    return die.attributes[attribute].value if attribute in die.attributes else default


def type_of(die):
    """The DIE of its type; None for void."""
    return die.get_DIE_from_attribute("DW_AT_type") if "DW_AT_type" in die.attributes else None


class Binding:
    def __init__(self, path):
        self.path = str(path)
        self.library = ctypes.CDLL(self.path)
        self._classes, self._enums, self._incomplete = {}, {}, {}
        self._functions, self._variables, self._constants = {}, {}, {}
        self._named, self._typedefs = {}, {}
        self._file = open(self.path, "rb")  # DIEs are read on demand
        for unit in ELFFile(self._file).get_dwarf_info().iter_CUs():
            for die in unit.get_top_DIE().iter_children():
                self._note(die)

    def _note(self, die):
        name = name_of(die)
        if die.tag == "DW_TAG_enumeration_type":
            for entry in die.iter_children():
                self._constants[name_of(entry)] = value_of(entry, "DW_AT_const_value")
        if die.tag in TYPES and name and "DW_AT_declaration" not in die.attributes:
            self._named.setdefault(name, die)
            if die.tag == "DW_TAG_typedef" and type_of(die) is not None:
                self._typedefs[type_of(die).offset] = name
        elif die.tag == "DW_TAG_subprogram" and "DW_AT_external" in die.attributes:
            self._functions.setdefault(name, die)
        elif die.tag == "DW_TAG_variable" and "DW_AT_external" in die.attributes:
            self._variables.setdefault(name, die)

    def __getattr__(self, name):
        """Finds a type, an enumerator, a function or a variable, once."""
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._constants:
            found = self._constants[name]
        elif name in self._named:
            die = self._bare(self._named[name])
            found = self._enum(die) if die.tag == "DW_TAG_enumeration_type" else self._whole(die)
        else:
            sized = re.compile(re.escape(name) + r"(_f(32|64)(_\d+)*)?$")
            hits = [n for n in [*self._functions, *self._variables] if sized.match(n)]
            if len(hits) != 1:
                raise AttributeError(f"{self.path} has {len(hits)} of {name}")
            linked = hits[0]
            if linked in self._functions:
                found = self._function(linked)
            else:
                found = self._whole(type_of(self._variables[linked])).in_dll(self.library, linked)
        setattr(self, name, found)
        return found

    @property
    def real(self):
        """The numpy name of auvid_real_t."""
        return np.dtype(self.auvid_real_t)

    def zeros(self, *shape):
        return np.zeros(shape, self.real)

    def array(self, values):
        return np.ascontiguousarray(values, self.real)

    def pointer(self, array):
        """The value of a struct member for an array of auvid_real_t. The array must outlive the
        struct."""
        if array.dtype != self.real or not array.flags.c_contiguous:
            raise TypeError(f"an array of {array.dtype} where {self.real} is needed")
        return array.ctypes.data_as(ctypes.POINTER(self.auvid_real_t))

    @staticmethod
    def _bare(die):
        while die is not None and die.tag in QUALIFIERS:
            die = type_of(die)
        return die

    def _whole(self, die):
        c = self._ctype(die)
        while self._incomplete:
            self._complete(next(iter(self._incomplete)))
        return c

    def _ctype(self, die):
        die = self._bare(die)
        if die is None:
            return None
        size = value_of(die, "DW_AT_byte_size")
        if die.tag == "DW_TAG_base_type":
            encoding = value_of(die, "DW_AT_encoding")
            if encoding == FLOAT:
                return FLOATS[size]
            if encoding == BOOLEAN:
                return ctypes.c_bool
            if encoding == SIGNED_CHAR and name_of(die) == "char":
                return ctypes.c_char
            return INTEGERS[size, encoding in (SIGNED, SIGNED_CHAR)]
        if die.tag == "DW_TAG_enumeration_type":
            return INTEGERS[size, min(e.value for e in self._enum(die)) < 0]
        if die.tag == "DW_TAG_array_type":
            return self._array(die)
        if die.tag == "DW_TAG_pointer_type":
            return self._pointer(self._bare(type_of(die)))
        if die.tag in ("DW_TAG_structure_type", "DW_TAG_union_type"):
            declared = "DW_AT_declaration" in die.attributes  # complete in another unit
            return self._struct(self._named[name_of(die)] if declared else die)
        raise TypeError(f"no ctypes type for {die.tag}")

    def _array(self, die):
        c = self._ctype(type_of(die))
        self._complete(c)
        for dimension in reversed(list(die.iter_children())):
            bound = value_of(dimension, "DW_AT_upper_bound")
            c = c * (value_of(dimension, "DW_AT_count", 0) if bound is None else bound + 1)
        return c

    def _pointer(self, target):
        if target is None or value_of(target, "DW_AT_declaration"):  # opaque
            return ctypes.c_void_p
        if target.tag == "DW_TAG_subroutine_type":
            arguments = [self._ctype(type_of(a)) for a in target.iter_children()]
            return ctypes.CFUNCTYPE(self._ctype(type_of(target)), *arguments)
        c = self._ctype(target)
        return ctypes.c_char_p if c is ctypes.c_char else ctypes.POINTER(c)

    def _struct(self, die):
        """A class for each struct, the same for all translation units that have it."""
        members = [m for m in die.iter_children() if m.tag == "DW_TAG_member"]
        # File numbers differ between translation units: the members distinguish structs.
        key = (value_of(die, "DW_AT_decl_line"), value_of(die, "DW_AT_decl_column"),
               value_of(die, "DW_AT_byte_size"), tuple(name_of(m) for m in members))
        if key in self._classes:
            return self._classes[key]
        base = ctypes.Structure if die.tag == "DW_TAG_structure_type" else ctypes.Union
        c = self._classes[key] = type(self._name(die), (base,), {})
        self._incomplete[c] = (die, members)
        return c

    def _complete(self, c):
        """Sets its fields after its name, because a struct may contain a pointer to itself."""
        if c not in self._incomplete:
            return
        die, members = self._incomplete.pop(c)
        names = [name_of(m) or f"_unnamed{i}" for i, m in enumerate(members)]
        types = [self._ctype(type_of(m)) for m in members]
        for held in types:
            self._complete(held)
        c._anonymous_ = [n for n in names if n.startswith("_unnamed")]
        c._fields_ = list(zip(names, types))
        offsets = [value_of(m, "DW_AT_data_member_location", 0) for m in members]
        if ctypes.sizeof(c) != value_of(die, "DW_AT_byte_size") or \
                offsets != [getattr(c, n).offset for n in names]:
            raise TypeError(f"ctypes lays {c.__name__} out differently")

    def _name(self, die):
        return name_of(die) or self._typedefs.get(die.offset, "unnamed")

    def _enum(self, die):
        entries = {name_of(e): value_of(e, "DW_AT_const_value") for e in die.iter_children()}
        key = tuple(entries.items())
        if key not in self._enums:
            self._enums[key] = enum.IntEnum(self._name(die), entries)
        return self._enums[key]

    def _function(self, linked):
        die, function = self._functions[linked], getattr(self.library, linked)
        arguments = [a for a in die.iter_children() if a.tag == "DW_TAG_formal_parameter"]
        function.argtypes = [self._argument(self._bare(type_of(a))) for a in arguments]
        result = self._bare(type_of(die))
        function.restype = self._whole(result)
        if result is not None and result.tag == "DW_TAG_enumeration_type":
            values = self._enum(result)
            function.errcheck = lambda number, *_: values(number)
        return function

    def _argument(self, die):
        if die.tag != "DW_TAG_pointer_type":
            return self._ctype(die)
        target = self._bare(type_of(die))
        c = self._ctype(die)
        if target is None or target.tag == "DW_TAG_subroutine_type" or c is ctypes.c_char_p:
            return c
        element = self._ctype(target)
        while issubclass(element, ctypes.Array):
            element = element._type_
        return type("pointer", (), {"from_param": classmethod(
            lambda _, given: by_reference(given, element))})


def by_reference(given, element):
    """Converts an argument for a pointer to `element`."""
    if given is None:
        return None
    if isinstance(given, np.ndarray):
        if given.dtype != np.dtype(element) or not given.flags.c_contiguous:
            raise TypeError(f"an array of {given.dtype} where {element.__name__} is needed")
        return ctypes.c_void_p(given.ctypes.data)
    if isinstance(given, (list, tuple)):
        return (element * len(given))(*given)
    inner = type(given)
    while issubclass(inner, ctypes.Array):
        inner = inner._type_
    if inner is element:
        return ctypes.byref(given)
    if isinstance(given, ctypes._Pointer) and type(given)._type_ is element:
        return given
    raise TypeError(f"{type(given).__name__} where {element.__name__} is needed")
