"""What release notes say of what may move a rocking block, kept by hand."""

from collections.abc import Mapping
from typing import NamedTuple

from studies.versions.releases import Release


class Note(NamedTuple):
    """A note of a release: what it says in short, and where it stands."""

    release: str
    text: str
    link: str


NOTES: Mapping[str, tuple[Note, ...]] = {}
"""Engine -> notes on its releases."""


def notes_between(before: Release, after: Release) -> list[Note]:
    """Return the notes on the releases after one, up to another."""
    return [
        note
        for note in NOTES.get(after.engine, ())
        if before.order < Release(after.engine, note.release).order <= after.order
    ]
