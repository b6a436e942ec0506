"""Which engine the settings name."""

from __future__ import annotations

import pytest

from service.queue.engines import engine_of
from service.settings import Settings, SettingsError

BAD = [
    "nonsense",
    "foo://1.2.3.4:5",
    "host:8786",
    "http://host:8786",
    "tcp://host",
    "tcp://:8786",
    "tcp://host:x",
    "tcp://host:0",
    "tcp://host:99999",
    "tcp://host:8786/path",
    "tcp://host:8786?q",
    "tcp://a@host:8786",
]


@pytest.mark.parametrize("address", ["", "tcp://h h:1", *BAD])
def test_an_address_of_another_form_is_refused_at_the_start(address: str) -> None:
    with pytest.raises(SettingsError, match=r"--engine-address tcp://host:port or tls://host:port"):
        engine_of(Settings(engine="dask", engine_address=address))


@pytest.mark.parametrize("address", ["tcp://host:8786", "tls://10.0.0.1:8786", "tcp://[::1]:8786"])
def test_an_address_of_a_scheduler_is_accepted(address: str) -> None:
    assert engine_of(Settings(engine="dask", engine_address=address)) is not None


def test_none_computes_elsewhere() -> None:
    assert engine_of(Settings(engine="none")) is None
