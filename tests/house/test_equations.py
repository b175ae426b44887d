"""What a docstring cites of EQUATIONS.md stands there under that heading."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_every_heading_that_is_cited_exists():
    page = (ROOT / "analytic/EQUATIONS.md").read_text()
    headings = set(re.findall(r"^(?:## |\*\*)([^*\n]+?)\.?(?:\*\*|$)", page, re.MULTILINE))
    sources = [path for name in ("analytic", "engines") for path in (ROOT / name).rglob("*.py")]
    named = re.compile(r'EQUATIONS\.md(?:,\s+"([^"]+)")?')
    cited = {heading for path in sources for heading in named.findall(path.read_text())}
    assert cited and {" ".join(heading.split()) for heading in cited} <= headings
