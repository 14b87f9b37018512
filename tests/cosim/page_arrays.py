"""What the script of a page unpacks, in Python."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["data_of", "page_array", "page_values"]

KINDS = {"f8": "<f8", "f4": "<f4", "i4": "<i4", "u1": "u1"}


def page_values(text: str) -> NDArray[Any]:
    """The numbers of a text of `giveway.report.page.packed`."""
    kind, _, content = text.partition(":")
    return np.frombuffer(base64.b64decode(content), KINDS[kind])


def page_array(data: Mapping[str, Any], number: int) -> NDArray[Any]:
    """An array of a study's page by its number."""
    stored = data["arrays"][number]
    if isinstance(stored, str):
        return page_values(stored)
    return page_values(stored["levels"])[page_values(stored["codes"])]


def data_of(page: str) -> Any:
    """What a page's script is given."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1], parse_constant=_refused)


def _refused(constant: str) -> Any:
    raise AssertionError(f"{constant} is no JSON")
