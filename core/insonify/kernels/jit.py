"""How every kernel is compiled."""

from __future__ import annotations

from numba import njit

# Every licence that keeps NaN and infinity meaningful: guards against them must survive.
FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}

# Division by zero gives infinity, as in NumPy: Python's check would cost the vector units and could only raise.
kernel = njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
