"""An error of the user's input in one sentence. The command line prints it and exits with 2."""
import argparse
import pathlib


class UserError(Exception):
    """Its text is the line that the user sees."""


def output(name):
    """Type of an option: a file to write, opened before the work starts."""
    try:
        return open(name, "w", encoding="utf-8")
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{name}: {error.strerror}") from error


def folder(name):
    """Type of an option: an output folder, created before the work starts."""
    try:
        pathlib.Path(name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{name}: {error.strerror}") from error
    return pathlib.Path(name)


def at_least(low):
    """Type of an option: a whole number with a lower limit."""
    def whole(text):
        if not text.isascii() or not text.isdecimal() or int(text) < low:
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from {low}")
        return int(text)
    return whole
