"""A log that cannot be converted, in one sentence: what is wrong, where, what to do."""


class LogError(Exception):
    """Its text is the line that the user sees; `auvid-log` then exits with 1."""


class UsageError(Exception):
    """A wrong option or file name; `auvid-log` then exits with 2."""
