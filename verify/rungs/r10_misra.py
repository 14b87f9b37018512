"""MISRA C:2012: no finding in c_core except the deviations listed in c_core/MISRA.md."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from verify.context import Context, Tool
from verify.rung import Figure, Rung, RungFailed, Value, planted

CPPCHECK = Tool("cppcheck", package="verify/requirements.lock")

# A deviation names its rule and its anchor on the line before: /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 why */
# Many lines stand between cppcheck-suppress-begin with the same text and cppcheck-suppress-end.
DEVIATION = re.compile(r"cppcheck-suppress(?:-begin)? (misra-c2012-[\d.]+) ; (DEV-\d\d) \S")
END = re.compile(r"cppcheck-suppress-end misra-c2012-[\d.]+ \*/")
SUPPRESSION = re.compile(r"cppcheck-suppress")
ANCHOR = re.compile(r"^### (DEV-\d\d): rule ([\d.]+) \((?:mandatory|required|advisory)\)$", re.MULTILINE)
PLACES = re.compile(r"^Places: (.*)$", re.MULTILINE)
# The two rules that the checker does not cover (3.2, 12.5) concern these.
UNCOVERED = re.compile(r"//|\bsizeof\b")


def check(context: Context) -> Figure:
    findings = sorted({line for double in (0, 1) for line in _findings(context, context.core, double)})
    _refuse(findings)
    deviations = _count(context)
    faults = _check_planted(context)
    return Figure(
        f"0 findings but {deviations['deviating_lines']} lines under {deviations['deviations']} listed deviations; "
        f"float and double; {faults} planted faults reported",
        {"findings": 0, **deviations, "planted_faults": faults},
    )


def _count(context: Context) -> dict[str, Value]:
    lines = _deviations(context.core)
    return {"deviations": len({anchor for _, anchor in lines}), "deviating_lines": len(lines)}


def _refuse(findings: list[str]) -> None:
    if findings:
        raise RungFailed("\n".join([f"{len(findings)} findings", *findings]))


def _findings(context: Context, core: Path, double: int, sources: str = "src") -> list[str]:
    """Findings of cppcheck and its MISRA addon in the files that a user copies, for one real type."""
    caller = context.work / "caller.c"
    caller.write_text(_caller(core))
    common = (
        "--std=c99",
        "--language=c",
        "--platform=unix32",  # int and pointers of 32 bits, as on the microcontrollers
        "--suppress=checkersReport",
        "--suppress=normalCheckLevelMaxBranches",  # the analysis below has no limit of configurations
        "--template={file}:{line}: {id}: {message}",
        "--quiet",
        "-DFLT_EVAL_METHOD=0",
        f"-DGW_REAL_DOUBLE={double}",
        f"-I{core / 'include'}",
        str(core / sources),
    )
    cppcheck = context.which(CPPCHECK)
    misra = ("--addon=misra", "--enable=style,information", "--inline-suppr")
    analysis = ("--check-level=exhaustive", "--enable=warning,style,performance,portability")
    reports = [context.run(cppcheck, *misra, *common, caller), context.run(cppcheck, *analysis, *common)]
    lines = [line for report in reports for line in (report.stdout + report.stderr).splitlines()]
    return [line.removeprefix(f"{core}/") for line in lines if not line.startswith(str(caller))]


def _caller(core: Path) -> str:
    """A program that uses the whole interface: without it all names of a library would be unused (8.7, 2.5)."""
    functions: set[str] = set()
    constants: set[str] = set()
    for path in sorted((core / "include").rglob("*.h")):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
        functions |= set(re.findall(r"\b(gw_\w+)\(", text))
        constants |= set(re.findall(r"#define (GW_\w+) ", text))
    uses = [f"    (void)&{name};" for name in sorted(functions)] + [f"    (void){name};" for name in sorted(constants)]
    return "\n".join(['#include "giveway/giveway.h"', "void caller(void);", "void caller(void)", "{", *uses, "}", ""])


def _deviations(core: Path) -> list[tuple[str, str]]:
    """(rule, anchor) of every deviating line; `RungFailed` unless MISRA.md lists exactly those, with their files."""
    listed, places = _listed(core)
    wrong = []
    used: list[tuple[str, str]] = []
    found: dict[str, set[str]] = {anchor: set() for anchor in listed}
    for path in sorted(core.rglob("*.[ch]")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            place = f"{path.relative_to(core)}:{number}"
            if UNCOVERED.search(line):
                wrong.append(f"{place}: neither // (rule 3.2) nor sizeof (rule 12.5): the checker does not cover them")
            if not SUPPRESSION.search(line) or END.search(line):
                continue
            match = DEVIATION.search(line)
            if match is None:
                wrong.append(f"{place}: a suppression has to read: cppcheck-suppress misra-c2012-R ; DEV-NN why")
            elif f"misra-c2012-{listed.get(match[2])}" != match[1]:
                wrong.append(f"{place}: MISRA.md lists no {match[2]} for {match[1]}")
            else:
                used.append((match[1], match[2]))
                found[match[2]].add(path.name)
    for anchor in listed:
        if not found[anchor]:
            wrong.append(f"MISRA.md: {anchor} is used nowhere")
        elif found[anchor] != places[anchor]:
            wrong.append(f"MISRA.md: {anchor} is used in {sorted(found[anchor])}, listed for {sorted(places[anchor])}")
    if wrong:
        raise RungFailed("\n".join(wrong))
    return used


def _listed(core: Path) -> tuple[dict[str, str], dict[str, set[str]]]:
    """The rule and the files of each anchor of MISRA.md."""
    text = (core / "MISRA.md").read_text()
    starts = list(ANCHOR.finditer(text))
    ends = [start.start() for start in starts[1:]] + [len(text)]
    rules = {start[1]: start[2] for start in starts}
    places = {
        start[1]: {
            name for line in PLACES.findall(text[start.end() : end]) for name in re.findall(r"`(\w+\.[ch])`", line)
        }
        for start, end in zip(starts, ends, strict=True)
    }
    return rules, places


# Appended to gw_sum.c: one fault per kind of check that the rung relies on.
PLANTED = {
    "two exits": (
        "extern int32_t planted(int32_t x);\nint32_t planted(int32_t x) { if (x > 0) { return 1; } return 0; }\n",
        r"misra-c2012-15\.5",
    ),
    "implicit narrowing": (
        "extern uint8_t planted(uint32_t x);\nuint8_t planted(uint32_t x) { uint8_t y = x; return y; }\n",
        r"misra-c2012-10\.3",
    ),
    "division by zero": (
        "extern int32_t planted(void);\nint32_t planted(void) { const int32_t zero = 0; return 1 / zero; }\n",
        r"zerodiv",
    ),
    "stale deviation": (
        "extern int32_t planted(int32_t x);\n"
        "/* cppcheck-suppress misra-c2012-15.5 ; DEV-01 there is one exit */\n"
        "int32_t planted(int32_t x) { return x; }\n",
        r"unmatchedSuppression",
    ),
}


def _check_planted(context: Context) -> int:
    for name, (code, shows) in PLANTED.items():
        core = _copy(context, name)
        with (core / "src" / "gw_sum.c").open("a") as source:
            source.write(code)
        with planted(name, shows=shows):
            _refuse(_findings(context, core, 0, "src/gw_sum.c"))
    unlisted = _copy(context, "unlisted deviation")
    with (unlisted / "src" / "gw_sum.c").open("a") as source:
        source.write("/* cppcheck-suppress misra-c2012-12.1 ; DEV-99 nobody listed this */\n")
    with planted("unlisted deviation", shows="MISRA.md lists no DEV-99"):
        _deviations(unlisted)
    unused = _copy(context, "unused anchor")
    with (unused / "MISRA.md").open("a") as document:
        document.write("\n### DEV-98: rule 1.1 (required)\n")
    with planted("an anchor that no line uses", shows="DEV-98 is used nowhere"):
        _deviations(unused)
    return len(PLANTED) + 2


def _copy(context: Context, name: str) -> Path:
    core = context.work / "planted" / name.replace(" ", "_")
    shutil.copytree(context.core, core)
    return core


RUNG = Rung("MISRA C:2012 with listed deviations only", (CPPCHECK,), check, remeasure=_count)
