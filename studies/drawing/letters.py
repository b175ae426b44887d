"""Letters of every script in a picture: the fonts that have them, and boxes where none does."""

from collections.abc import Iterable, Mapping
from functools import cache

import matplotlib as mpl
from matplotlib.font_manager import findfont, fontManager, get_font
from matplotlib.ft2font import FT2Font

FONTS = (
    *("DejaVu Sans", "Noto Sans CJK JP", "Noto Sans JP", "IPAexGothic", "Yu Gothic"),
    *("Hiragino Sans", "Meiryo", "Microsoft YaHei", "PingFang SC", "WenQuanYi Zen Hei"),
    *("Malgun Gothic", "Noto Sans Devanagari", "Noto Sans Thai", "Noto Emoji"),
    *("Segoe UI Emoji", "Symbola"),
)
"""Fonts that are used where they are installed; the first comes with matplotlib."""


@cache
def _fonts() -> Mapping[str, FT2Font]:
    there = set(fontManager.get_font_names())
    return {name: get_font(findfont(name)) for name in FONTS if name in there}


def drawable(words: str) -> str:
    """Return words with a box for every letter that no font has."""
    if words.isascii():
        return words
    fonts = _fonts().values()
    return "".join(
        letter if any(font.get_char_index(ord(letter)) for font in fonts) else "□"
        for letter in words
    )


def families(words: Iterable[str]) -> list[str]:
    """Return the fonts that such words are drawn in, as rcParams["font.family"] takes them."""
    usual: list[str] = mpl.rcParams["font.family"]
    return usual if all(map(str.isascii, words)) else list(_fonts())
