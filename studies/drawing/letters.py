"""Letters of every script in a picture: the fonts that have them; where none does, boxes."""

from collections.abc import Iterable

import matplotlib as mpl
from matplotlib.font_manager import fontManager

FONTS = (
    *("DejaVu Sans", "Noto Sans CJK JP", "Noto Sans JP", "IPAexGothic", "Yu Gothic"),
    *("Hiragino Sans", "Meiryo", "Microsoft YaHei", "PingFang SC", "WenQuanYi Zen Hei"),
    *("Malgun Gothic", "Noto Sans Devanagari", "Noto Sans Thai", "Noto Emoji"),
    *("Segoe UI Emoji", "Symbola"),
)
"""Fonts that are used where they are installed; the first comes with matplotlib."""


def families(words: Iterable[str]) -> list[str]:
    """Return the fonts that such words are drawn in, as rcParams["font.family"] takes them."""
    usual: list[str] = mpl.rcParams["font.family"]
    there = set(fontManager.get_font_names())
    return usual if all(map(str.isascii, words)) else [name for name in FONTS if name in there]
