"""What Python fills into a page: nothing of it can end the script or reach the network."""

from __future__ import annotations

import base64
import json
import re

import numpy as np
import pytest
from giveway.report.page import packed, page

EVIL = "</script><script>alert(1)</script><!-- & \u2028"


def test_data_cannot_leave_its_script() -> None:
    text = page("studio", EVIL, {"text": EVIL})
    held = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert held
    assert json.loads(held[1]) == {"text": EVIL}
    assert not re.search("[<>&\u2028]", held[1])
    assert "alert(1)</script>" not in text
    assert text.count("<script") == 2


def test_the_policy_names_the_one_script() -> None:
    text = page("studio", "title", {})
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text)
    assert policy
    assert "default-src 'none'" in policy[1]
    assert re.search(r"script-src 'sha256-[\w+/=]+' 'wasm-unsafe-eval';", policy[1])
    assert "unsafe-eval" not in policy[1].replace("wasm-unsafe-eval", "")
    assert "http" not in re.sub(r"https?://[\w./-]*", "", policy[1])


def test_numbers_that_json_does_not_have_are_refused() -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        page("studio", "title", {"value": float("nan")})


@pytest.mark.parametrize(
    ("values", "kind"),
    [(np.array([0.1, np.nan]), "f8"), (np.array([3, -4]), "i4"), (np.array([True, False]), "u1")],
)
def test_arrays_keep_their_bits(values: np.ndarray, kind: str) -> None:
    text = packed(values)
    assert text.startswith(f"{kind}:")
    np.testing.assert_array_equal(np.frombuffer(base64.b64decode(text[3:]), f"<{kind}"), values)
    assert packed(np.array([0.5]), single=True) == "f4:AAAAPw=="
