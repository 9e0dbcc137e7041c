"""The schema of case files, made once: a message about a mistake asks for it anew for every table that it looks at."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import pytest

from easeoff.cases import Case


@contextmanager
def schema_made_once() -> Iterator[None]:
    """Context in which it is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Case, "model_json_schema", cache(Case.model_json_schema))
        yield
