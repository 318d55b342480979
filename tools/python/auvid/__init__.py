"""auvid in Python: from the log of a dive to the CSV that `auvid fit` reads."""
