"""Comparison of auvid with independent tools, the paper's experiment, and recorded logs."""
