"""Where this project keeps one full run of every study."""

from pathlib import Path

PUBLISHED = Path(__file__).parents[1] / "published"
"""The folder of the published tables, one folder inside for each chapter."""
