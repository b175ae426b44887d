"""Lines of JSON that show whether they are still what was once written."""

import json
import re
import zlib
from collections.abc import Mapping
from typing import Any

_LINE = re.compile(rb'\{"crc": "([0-9a-f]{8})", (.*\})', re.DOTALL)


def seal(entry: Mapping[str, Any]) -> bytes:
    """Return an entry as a line of JSON whose first member is the checksum of the others."""
    text = json.dumps(entry).encode()[1:]
    return b'{"crc": "%08x", %b\n' % (zlib.crc32(text), text)


def unseal(line: bytes) -> dict[str, Any]:
    """Return the entry of a line, which comes without its end.

    Raises
    ------
    ValueError
        If the line is not what `seal` made. Every change of a single bit is noticed, and of two,
        and of any within four bytes.
    """
    match = _LINE.fullmatch(line)
    if match is None or int(match[1], 16) != zlib.crc32(match[2]):
        raise ValueError("the line is damaged")
    return dict(json.loads(b"{" + match[2]))
