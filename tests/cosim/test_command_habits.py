"""What all commands have in common: `--json`, `--quiet`, exit codes, colours."""

from __future__ import annotations

import ast
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import giveway
import pytest
import typer
from cosim_helpers import Cli, folder_content
from giveway.base import native
from giveway.base.table_document import Shown, table_document
from giveway.base.terminal import EXIT_CODES, FAILED, INTERRUPTED, WRONG_INPUT
from giveway.cli import app
from giveway.doctor import findings
from giveway.simulation import runner
from rich.text import Text
from terminal_process import at_a_terminal

PACKAGE = Path(giveway.__file__).parent
RUN = ("run", "motionless", "--duration", "0.5", "--engine", "native", "--out", "run")


def documents(text: str) -> dict[str, Any]:
    found = json.loads(text)
    assert found["schema_version"] == 1
    return found


def commands(command: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    inner = getattr(command, "commands", {})
    if not inner or command.params:
        yield path, command
    for name, one in inner.items():
        yield from commands(one, f"{path} {name}".strip())


def test_every_command_has_both_options() -> None:
    found = dict(commands(typer.main.get_command(app)))
    assert {"", "run", "study show", "crowd", "crowd endurance", "new robot", "robot new", "replay"} <= set(found)
    for path, command in found.items():
        names = [name for parameter in command.params for name in parameter.opts]
        assert names.count("--json") == names.count("--quiet") == names.count("-q") == 1, path


def test_a_run_as_json(cli: Cli, tmp_path: Path) -> None:
    answer = cli(*RUN, "--json")
    assert answer.returncode == 0, answer.stderr
    found = documents(answer.stdout)
    rows = {row["name"]: row for row in found["tables"][0]["rows"]}
    run = giveway.load(tmp_path / "run")
    assert rows["peak force of the run"] == {
        "name": "peak force of the run",
        "unit": "N",
        "magnetic": run.metric("peak force of the run").value,
    }
    direction = run.metric("force direction")
    assert rows["force direction"]["magnetic"] == {"value": direction.value, "truth": direction.truth}
    assert found["warnings"] == [one.text for one in run.warnings]
    assert found["written"] == ["run/report.html"]


@pytest.mark.parametrize("place", ["before", "behind"])
def test_the_option_stands_before_or_behind(place: str, cli: Cli) -> None:
    line = ("variables", "testbed", "--grep", "wall.distance")
    found = documents(cli(*(("--json", *line) if place == "before" else (*line, "--json"))).stdout)
    [row] = found["tables"][0]["rows"]
    assert row["allowed"] == {"type": "real", "unit": "m", "minimum": 1e-6, "maximum": 10.0}
    assert (row["name"], row["start"]) == ("wall.distance", 0.001)


def test_it_stands_between_a_group_and_its_command(cli: Cli) -> None:
    """`giveway crowd` has options of its own, which belong behind: those are refused there, this is not."""
    options = ("endurance", "--hours", "0.01", "--group", "planar")
    found = documents(cli("crowd", "--json", *options).stdout)
    assert found["tables"][0]["title"] == "Motion without contact"
    done = cli("crowd", "--json", "--threads", "1", *options)
    assert (done.returncode, done.stdout) == (2, "")
    assert "--threads: 1 is not allowed; allowed: behind `endurance`" in done.stderr


def test_lists_are_rows(cli: Cli) -> None:
    robots = documents(cli("robot", "list", "--json").stdout)["tables"][0]
    assert {row["name"] for row in robots["rows"]} == set(native.robots())
    assert robots["units"] == {"mass": "kg"}
    experiments = documents(cli("list", "--json").stdout)["tables"][0]["rows"]
    assert {"name": "motionless", "single run": True}.items() <= experiments[0].items() | {
        ("name", one["name"]) for one in experiments
    }


def test_commands_without_tables_say_what_they_wrote(cli: Cli, tmp_path: Path) -> None:
    found = documents(cli("new", "scenario", "--json").stdout)
    assert (found["tables"], found["written"]) == ([], ["scenario.toml"])
    assert found["notes"] == ["run it with: giveway run scenario.toml --out out/first"]
    assert folder_content(tmp_path) == ["scenario.toml"]


def test_errors_leave_stdout_empty(cli: Cli) -> None:
    answer = cli("run", "motionles", "--out", "run", "--json")
    assert (answer.returncode, answer.stdout) == (2, "")
    assert answer.stderr.count("\n") == 1


def test_the_next_command_prints_again(cli: Cli) -> None:
    assert cli("list", "--quiet").stdout == ""
    assert cli("list", "--json").stdout.startswith("{")
    assert "motionless:" in cli("list").stdout


def test_quiet_is_quiet_but_for_errors(process: Cli, cli: Cli, tmp_path: Path) -> None:
    answer = process(*RUN, "--quiet")
    assert (answer.returncode, answer.stdout, answer.stderr) == (0, "", "")
    assert (tmp_path / "run/report.html").exists()
    assert "motionles" in cli("run", "motionles", "--out", "other", "--quiet").stderr


def test_quiet_studies_tell_no_progress(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("giveway.study.messages.SAY_EVERY_S", 0.0)
    line = ("crowd", "--robots", "1", "--no-imu", "--out")
    assert "runs" in cli(*line, "loud").stderr
    assert cli(*line, "quiet", "--quiet").stderr == ""


def test_json_and_quiet(cli: Cli) -> None:
    answer = cli(*RUN, "--json", "--quiet")
    assert (answer.returncode, answer.stderr) == (0, "")
    assert documents(answer.stdout)["tables"]


def test_a_document_of_its_own_is_alone_and_not_silenced(cli: Cli) -> None:
    answer = cli("fmu", "check", str(native.file("giveway_bumper_fmi3.fmu")), "--json", "--quiet")
    assert documents(answer.stdout)["files"][0]["faults"] == 0


def test_cells() -> None:
    header = ("", "force, N", "min (ms)", "price [EUR]", "margin, %", "%", "")
    rows = [("speed, m/s", "1,234.5", "3", "12 N/mm", "-", "9 of 12", Shown("1.2", 1.23)), ("a, b", "", "007", *"abcd")]
    found = table_document("t", header, rows)
    assert found == {
        "title": "t",
        "units": {"force": "N", "min": "ms", "margin": "%"},
        "rows": [
            {
                **{"name": "speed", "unit": "m/s", "force": 1234.5, "min": 3},
                **{"price [EUR]": {"value": 12, "unit": "N/mm"}, "margin": None, "%": "9 of 12", "column 7": 1.23},
            },
            {"name": "a, b", "force": None, "min": "007", "price [EUR]": "a", "margin": "b", "%": "c", "column 7": "d"},
        ],
    }
    assert json.loads(json.dumps(found)) == found


def test_exit_codes_are_those_of_the_table(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    returned = {cli("list").returncode, cli("frob").returncode, cli("run", "motionles", "--out", "x").returncode}
    with monkeypatch.context() as patch:
        patch.setattr(findings, "examine", lambda: iter([findings.Finding("x", findings.WRONG, "y")]))
        found = cli("doctor").returncode
        assert found == FAILED
        returned.add(found)

    def interrupt(*_arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "run", interrupt)
    assert cli(*RUN).returncode == INTERRUPTED
    assert {*returned, INTERRUPTED} == set(EXIT_CODES)
    assert cli("run").returncode == WRONG_INPUT


def exits() -> Iterator[tuple[str, str]]:
    """File and code of every `typer.Exit(...)`."""
    for path in sorted(path for path in PACKAGE.rglob("*.py") if "typer.Exit(" in path.read_text(encoding="utf-8")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "typer.Exit":
                yield str(path.relative_to(PACKAGE)), ast.unparse(node.args[0])


def test_no_command_ends_with_another_code() -> None:
    found = list(exits())
    assert len(found) > 5
    assert {code for _, code in found} <= {"FAILED", "WRONG_INPUT", "INTERRUPTED"}, found


def test_exit_codes_are_told(cli: Cli) -> None:
    said = " ".join(cli("--help").stdout.split())
    assert all(f"{code}: {words}" in said for code, words in EXIT_CODES.items())


def test_help_keeps_its_brackets() -> None:
    """Rich takes what stands in brackets for markup, unless a backslash is before it."""
    for path, command in commands(typer.main.get_command(app)):
        for text in (command.help or "", *(getattr(one, "help", "") or "" for one in command.params)):
            assert Text.from_markup(text).plain == text.replace("\\[", "["), f"{path}: {text}"


def shown_at_a_terminal(*arguments: str, **environment: str) -> bytes:
    kept = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR")}
    code, shown = at_a_terminal(arguments, "stdout", environment={**kept, "TERM": "xterm-256color", **environment})
    assert code == 0
    return shown


def test_colours_are_for_terminals_that_want_them(process: Cli) -> None:
    line = ("variables", "testbed", "--grep", "wall")
    assert b"\x1b[" in shown_at_a_terminal(*line)
    assert b"\x1b" not in shown_at_a_terminal(*line, NO_COLOR="1")
    assert b"\x1b" not in shown_at_a_terminal(*line, "--json")
    assert "\x1b" not in process(*line).stdout + process("--help").stdout
    assert not re.search(rb"\x1b\[[\d;]*(3|4|9)\d", shown_at_a_terminal("--help", NO_COLOR="1"))


def test_a_new_robot_by_either_name(cli: Cli, tmp_path: Path) -> None:
    sizes = ("--mass", "20 kg", "--wheel-radius", "4 in", "--wheel-distance", "0.2", "--outline", "circle 0.5")
    assert cli("new", "robot", "mine.toml", *sizes, "--height", "0.4").returncode == 0
    assert "[wheel.radius]" in (tmp_path / "mine.toml").read_text(encoding="utf-8")
    found = dict(commands(typer.main.get_command(app)))
    assert [one.opts for one in found["new robot"].params] == [one.opts for one in found["robot new"].params]
