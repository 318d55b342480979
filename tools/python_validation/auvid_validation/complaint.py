"""What is wrong with the user's input, in one sentence: the command line prints it and exits 2."""
import argparse


class Complaint(Exception):
    """Its text is the one line that the user sees."""


def output(name):
    """Of an option: a file to write, opened before the work begins."""
    try:
        return open(name, "w", encoding="utf-8")
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{name}: {error.strerror}") from error
