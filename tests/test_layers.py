"""The import contracts: who breaks one is named."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
LINT = "from importlinter.cli import lint_imports as l; raise SystemExit(l(no_cache=True))"
FORBIDDEN = {
    "analytic.simulate": "from analytic import simulate",
    "analytic": "import analytic",
    "analytic.maps": "import analytic.maps as here, json",
    "analytic.criteria": "from analytic.criteria import quarter_period",
    "analytic.conditioning": "from analytic import conditioning",
    "analytic.kernels.excursions": "from analytic.kernels.excursions import march",
    "analytic.kernels.swings": "from analytic.kernels import swings",
    "analytic.models": "def later():\n    from analytic.models import MODELS",
}
"""The modules that know the answer, and ways for an adapter to come to one."""
ALLOWED = (
    "from analytic import block, checks, motion, record\nfrom analytic.response import Response"
)


def test_an_adapter_that_would_see_the_answer_is_named(tmp_path):
    for name in ("analytic", "engines", "studies"):
        kept = shutil.ignore_patterns("__pycache__", "published")
        shutil.copytree(ROOT / name, tmp_path / name, ignore=kept)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    (tmp_path / "engines" / "pymunk" / "allowed.py").write_text(ALLOWED)
    for number, statement in enumerate(FORBIDDEN.values()):
        (tmp_path / "engines" / "pymunk" / f"forbidden_{number}.py").write_text(statement)
    done = subprocess.run(
        [sys.executable, "-c", LINT],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "COLUMNS": "200"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1, done.stderr
    assert "1 broken" in done.stdout
    named = re.findall(r"(engines\.\S+) -> (analytic\S*) \(l", done.stdout)
    expected = [
        (f"engines.pymunk.forbidden_{number}", module) for number, module in enumerate(FORBIDDEN)
    ]
    assert sorted(named) == sorted(expected)
