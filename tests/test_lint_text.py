"""The check of texts in `make lint` sees what it is for."""

from lint_text import findings

LONG = "word " * 30


def test_long_lines_are_named_and_tables_and_code_are_not() -> None:
    text = f"{LONG}\n\n| {LONG} |\n\n    {LONG}\n\n```\n{LONG}\n```\n"
    assert [one.split(": ")[0] for one in findings({"a.md": text})] == ["a.md:1"]
    assert [one.split(": ")[0] for one in findings({"a.py": f"x = 1\n# {LONG}\n"})] == ["a.py:2"]
    assert [one.split(": ")[0] for one in findings({"a.toml": f'x = "{LONG}"\n# {LONG}\n'})] == ["a.toml:2"]


def test_cited_files_have_to_exist() -> None:
    files = {"a/b.py": "x = 1  # as in physics.md, and in c.toml\n", "c.toml": "# NAME.py stands for any\n"}
    assert list(findings(files)) == ["a/b.py:1: cites physics.md, which is not in the repository"]
