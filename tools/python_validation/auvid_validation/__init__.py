"""auvid against tools that others wrote, the paper's experiment, and recorded logs."""
