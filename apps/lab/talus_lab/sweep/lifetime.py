"""Processes that end with the one that started them, however that ends."""

from __future__ import annotations

import ctypes

_LIBC = ctypes.CDLL(None)  # here: nothing may be loaded between fork and exec
_PR_SET_PDEATHSIG = 1


def end_with_parent(signal: int) -> None:
    """Sends this process the signal when its parent ends. On Linux; elsewhere it runs on, in vain but harmless."""
    if hasattr(_LIBC, "prctl"):
        _LIBC.prctl(_PR_SET_PDEATHSIG, int(signal))
