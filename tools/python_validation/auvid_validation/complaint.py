"""What is wrong with the user's input, in one sentence: the command line prints it and exits 2."""


class Complaint(Exception):
    """Its text is the one line that the user sees."""
