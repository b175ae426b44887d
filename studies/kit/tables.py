"""Tables as text."""

import pandas as pd


def left_aligned(table: pd.DataFrame) -> str:
    """Return a table of words."""
    width = {name: max(len(str(name)), int(table[name].str.len().max())) for name in table}
    lines = [{name: str(name) for name in table}, *table.to_dict("records")]
    return "\n".join(
        "  ".join(str(line[name]).ljust(width[name]) for name in table).rstrip() for line in lines
    )
