"""Where this project keeps one full run of every study."""

from pathlib import Path

import studies

PUBLISHED = Path(studies.__file__).parent / "published"
"""The folder of the published tables, one folder inside for each chapter."""
