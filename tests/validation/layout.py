#!/usr/bin/env python3
"""Is the state plain data, and laid out alike everywhere?

usage: layout.py [--write] NAME=OBJECT...
OBJECT is auvid_checkpoint_layout.c, compiled with debugging information for a machine. Its lists of
blocks say what a checkpoint holds, and of which members the configuration's checksum is. In a block
there must be no pointer, no enumeration, no gap, and no scalar off a multiple of its width. The
layout of the state must be the one listed in layout.csv, whose checksum is in
auvid_checkpoint_layout_internal.h. For a NAME that ends in "sizes" (other sizes, or
double) it is not compared. Prints "ok" or "not ok" for each object, naming the member.
--write writes both files, after a change of the layout; checkpoints saved before are then refused.
"""
import pathlib
import re
import sys
import zlib

from elftools.elf.elffile import ELFFile

HERE = pathlib.Path(__file__).resolve().parent
LISTED = HERE / "layout.csv"
SOURCE = HERE / "../../lib/src/checkpoint/auvid_checkpoint_layout.c"
HEADER = SOURCE.with_name("auvid_checkpoint_layout_internal.h")
CHECKSUM = re.compile(r"(#define AUVID_CHECKPOINT_LAYOUT )0x([0-9a-f]{8})u")
BLOCK = re.compile(
    r"^    (?:OF_ID\(|BLOCK\(ROOT_\w+,\s*(auvid_\w+),)\s*([\w.]+),\s*([\w.]+),", re.M)
PLAIN = {"DW_TAG_const_type", "DW_TAG_volatile_type", "DW_TAG_typedef"}


def name_of(die):
    return die.attributes["DW_AT_name"].value.decode() if "DW_AT_name" in die.attributes else ""


def type_of(die):
    die = die.get_DIE_from_attribute("DW_AT_type")
    return type_of(die) if die.tag in PLAIN else die


def size_of(die):
    if die.tag == "DW_TAG_array_type":
        return size_of(type_of(die)) * count_of(die)
    return die.attributes["DW_AT_byte_size"].value


def count_of(array):
    count = 1
    for dimension in array.iter_children():
        count *= dimension.attributes["DW_AT_upper_bound"].value + 1
    return count


def members(struct):
    """(name, offset, type) of each member, those of unnamed structs and unions among them."""
    for member in struct.iter_children():
        if member.tag != "DW_TAG_member":
            continue
        at = member.attributes.get("DW_AT_data_member_location")
        at = at.value if at else 0
        if name_of(member):
            yield name_of(member), at, type_of(member)
        else:
            yield from ((n, at + o, t) for n, o, t in members(type_of(member)))


def leaves(die, path, at):
    """(path, offset, width, count, kind) of the scalars; of an array of structs those of the first,
    then the rest as one."""
    if die.tag == "DW_TAG_array_type" and type_of(die).tag == "DW_TAG_structure_type":
        inner = type_of(die)
        yield from leaves(inner, f"{path}[{count_of(die)}]", at)
        yield path + "[]", at + size_of(inner), size_of(inner), count_of(die) - 1, "rest"
    elif die.tag in ("DW_TAG_structure_type", "DW_TAG_union_type"):
        for name, offset, inner in members(die):
            longer = f"{path}.{name}".lstrip(".")
            yield from leaves(inner, longer, at + offset)
    else:
        array = die.tag == "DW_TAG_array_type"
        scalar = type_of(die) if array else die
        kind = scalar.tag.removeprefix("DW_TAG_").removesuffix("_type")
        yield path, at, size_of(scalar), count_of(die) if array else 1, kind


def layout(path, table):
    """{block: [(member, offset, width, count, kind)]} of a list of blocks, in its order."""
    with open(path, "rb") as file:
        types = {name_of(die): die for unit in ELFFile(file).get_dwarf_info().iter_CUs()
                 for die in unit.get_top_DIE().iter_children() if die.tag == "DW_TAG_typedef"}
        text = SOURCE.read_text()
        text = text[text.index(f"auvid_checkpoint_{table}["):]
        found = {}
        for root, first, last in BLOCK.findall(text[:text.index("};")]):
            root = root or "auvid_identifier_t"
            scalars = list(leaves(type_of(types[root]), "", 0))
            begin, end = (next(s for s in scalars if inside(s[0], name)) for name in (first, last))
            begin, end = begin[1], max(s[1] + s[2] * s[3] for s in scalars if inside(s[0], last))
            held = [s for s in scalars if begin <= s[1] < end and beside(s[0], first, last)]
            found[f"{root.removeprefix('auvid_').removesuffix('_t')}.{first}"] = [
                (s[0], s[1] - begin, *s[2:]) for s in held]
        return found


def inside(path, name):
    return re.sub(r"\[\d*\]", "", path + ".").startswith(name + ".")


def beside(path, first, last):
    """Does it belong to the same struct as both? Other members of a union do not."""
    common = first.split(".")
    for k, (a, b) in enumerate(zip(first.split("."), last.split("."))):
        if a != b:
            common = common[:k]
            break
    return inside(path, ".".join(common)) if common else path.split(".")[0] not in (
        "cfg", "refusal", "optimizer", "optimum", "confidence")


def faults(blocks):
    """What in the blocks is not plain data."""
    for name, scalars in blocks.items():
        end = 0
        for member, at, width, count, kind in scalars:
            if kind not in ("base", "rest"):
                yield f"{member} is of type {kind}"
            if at > end:
                yield f"{at - end} bytes before {member} are a gap"
            if kind == "base" and at % width:
                yield f"{member} is at {at}, not at a multiple of {width}"
            end = max(end, at + width * count)


def lines(blocks):
    return [f"{name},{member},{at},{width},{count}" for name, scalars in blocks.items()
            for member, at, width, count, _ in scalars]


def difference(listed, found):
    """The members that are new, or missing; else the first one that differs."""
    before, after = (dict(line.split(",", 2)[1:] for line in part) for part in (listed, found))
    changed = [f"{member} is new" for member in after if member not in before]
    changed += [f"{member} is missing" for member in before if member not in after]
    moved = [f"{member} is {after[member]}, listed as {before[member]}" for member in after
             if member in before and after[member] != before[member]]
    return "; ".join((changed or moved[:1])[:4])


def main():
    objects = dict(a.split("=") for a in sys.argv[1:] if a != "--write")
    found = {name: layout(path, "block") for name, path in objects.items()}
    if "--write" in sys.argv:
        text = "\n".join(lines(next(iter(found.values())))) + "\n"
        LISTED.write_text(text)
        number = f"{zlib.crc32(text.encode()):08x}"
        HEADER.write_text(CHECKSUM.sub(rf"\g<1>0x{number}u", HEADER.read_text()))
    text = LISTED.read_text()
    number = CHECKSUM.search(HEADER.read_text())[2]
    for name, blocks in found.items():
        what = "; ".join([*faults(blocks), *faults(layout(objects[name], "configured"))])
        if not what and not name.endswith("sizes"):
            what = difference(text.split(), lines(blocks))
        if not what and f"{zlib.crc32(text.encode()):08x}" != number:
            what = f"{HEADER.name} has the checksum of another layout.csv"
        members = sum(map(len, blocks.values()))
        print(f"not ok - {name}: {what}" if what else f"ok - {name}: {members} members")


main()
