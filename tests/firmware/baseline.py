#!/usr/bin/env python3
"""Compares figures with the committed ones.

usage: baseline.py CSV NEW
Both have lines "key,number", optionally after a header. Prints the keys whose number has grown by
more than 2 %, and those that only one file has. Exit status 1 if there are any. If the growth is
intended, cp NEW CSV and commit it with the reason.
"""
import csv
import sys

ALLOWED = 1.02


def read(path):
    with open(path, newline="") as file:
        return {key: float(number) for key, number in csv.reader(file) if key != "key"}


def main():
    old, new = read(sys.argv[1]), read(sys.argv[2])
    wrong = [f"{key}: {old[key]:g} -> {new[key]:g}, {100 * (new[key] / old[key] - 1):+.1f} %"
             if old[key] else f"{key}: 0 -> {new[key]:g}"
             for key in old.keys() & new.keys() if new[key] > ALLOWED * old[key]]
    wrong += [f"{key}: no longer there" for key in old.keys() - new.keys()]
    wrong += [f"{key}: not in {sys.argv[1]}" for key in new.keys() - old.keys()]
    print("\n".join(sorted(wrong)) or f"{len(new)} figures, none grown by more than 2 %")
    if wrong:
        print(f"if this is intended: cp {sys.argv[2]} {sys.argv[1]}, and commit it with the reason")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
