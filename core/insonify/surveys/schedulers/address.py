"""An existing cluster by the address of its scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from insonify.errors import SceneError
from insonify.surveys.schedulers import SchedulerKind

PATIENCE = 10.0  # s, until the scheduler answers


def connect_to(protocol: str) -> Callable[[str], AbstractContextManager[Any]]:
    """Return what connects to a scheduler by its address without the protocol."""

    @contextmanager
    def connect(rest: str) -> Iterator[Any]:
        from distributed import Client

        address = f"{protocol}:{rest}"
        try:
            client = Client(address, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise SceneError(
                f"--scheduler {address}: no scheduler answers there ({error}); start one with 'dask scheduler', or "
                "leave the option out"
            ) from None
        with client:
            yield client

    return connect


TCP = SchedulerKind("tcp", "tcp://HOST:PORT", connect_to("tcp"))
TLS = SchedulerKind("tls", "tls://HOST:PORT", connect_to("tls"))
