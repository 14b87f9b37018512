"""The drawing of a robot file as a picture, or as one page with what was found."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.errors import GivewayError
from giveway.base.files import replace_file, write_text
from giveway.base.version import VERSION
from giveway.base.words import counted
from giveway.own_robot.drawing import draw

if TYPE_CHECKING:
    from giveway.own_robot.checked import Checked

__all__ = ["ENDINGS", "check_ending", "summary", "write"]

ENDINGS = (".html", ".svg", ".png")


def check_ending(field: str, path: Path) -> None:
    """Refuse a file of another kind, before any work is done."""
    if path.suffix.lower() not in ENDINGS:
        raise GivewayError(field, path, f"a file ending in {', '.join(ENDINGS)}")


def summary(checked: Checked) -> str:
    """One sentence: how much is implausible, and how much assumed."""
    entries = sum(1 for _ in checked.robot.entries())
    origins = ", ".join(f"{len(found)} {provenance}" for provenance, found in checked.origins())
    return f"{counted(len(checked.doubts), 'doubt')}; {entries} numbers: {origins}."


def write(path: Path, checked: Checked) -> None:
    """The page or picture of a robot that can be used, atomically."""
    from matplotlib.style import context

    from giveway.report.inline_svg import inline_svg
    from giveway.report.style import STYLE

    assert checked.numbers is not None
    name = checked.robot.name or checked.robot.path.stem
    figure = draw(checked.numbers, name)
    with context(STYLE):
        if path.suffix.lower() != ".html":
            with replace_file(path) as temporary:
                metadata = {"Date": None} if path.suffix.lower() == ".svg" else None
                figure.savefig(temporary, dpi=150, metadata=metadata)
            return
        drawing = inline_svg(figure, "robot-")
    write_text(path, _html(checked, name, drawing))


def _html(checked: Checked, name: str, drawing: str) -> str:
    import jinja2

    from giveway.report.page import page

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("giveway.report", "templates"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    assert checked.numbers is not None
    body = environment.get_template("robot_check.html.j2").render(
        name=name,
        file=checked.robot.path.name,
        version=VERSION,
        summary=summary(checked),
        drawing=drawing,
        height_is_stated=checked.numbers.height_is_stated,
        doubts=checked.doubts,
        origins=list(checked.origins()),
    )
    return page("report", f"{name}: robot file", {"figures": []}, body=body)
