"""Drawing without a screen, and properties that try the same examples on every machine."""

import matplotlib
from hypothesis import settings

matplotlib.use("Agg")
settings.register_profile("still", derandomize=True, deadline=None, database=None, max_examples=60)
settings.load_profile("still")
