"""What is wrong with the user's input, in one sentence: the command line prints it and exits 2."""
import argparse
import pathlib


class Complaint(Exception):
    """Its text is the one line that the user sees."""


def output(name):
    """Of an option: a file to write, opened before the work begins."""
    try:
        return open(name, "w", encoding="utf-8")
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{name}: {error.strerror}") from error


def folder(name):
    """Of an option: a folder to write into, made before the work begins."""
    try:
        pathlib.Path(name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{name}: {error.strerror}") from error
    return pathlib.Path(name)


def at_least(low):
    """Of an option: a whole number from there on."""
    def whole(text):
        if not text.isascii() or not text.isdecimal() or int(text) < low:
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from {low}")
        return int(text)
    return whole
