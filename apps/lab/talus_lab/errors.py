"""What a user can put right."""

from __future__ import annotations

import difflib
from typing import Iterable


class ResultError(Exception):
    """Something given is not what it should be: a file that is no result, an unknown name, a fault of a config. The commands report it
    in one line and end with code 2."""


def nearest(name: object, known: Iterable[object]) -> str:
    """The end of a report about an unknown name: the one that was probably meant, or all there are."""
    known = [str(word) for word in known]
    close = difflib.get_close_matches(str(name), known, 1)
    return f"; did you mean {close[0]}?" if close else f"; there are {', '.join(known)}" if known else "; there are none"
