"""`make platforms`: the FMUs of `make fmus ALL=1` on their platforms, against those that `make test` runs.

Every library is read: exports, dependencies, oldest system. Those for Linux and Windows are run, if necessary under
    qemu or wine: a coupled collision, and each component alone. Each run happens twice in one process, with the
    libraries unloaded in between and afterwards, and the process has to end with exit code 0. Prints a line for each
    platform and FMU, then shows that each check fails on a planted fault, and exits with 1 if anything was wrong.
"""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import fmpy
import numpy as np
import ziglang

from .binaries import inspected
from .plan import Plan, read_outputs
from .reproduce import build_again, differing
from .runs import CONTROLLER, all_runs, replay

ROOT = Path(__file__).parents[2]
FMUS = ROOT / "out" / "fmus"
TESTED = ROOT / "build" / "fmus"
HOST = "x86_64-linux"
WORK = ROOT / "build" / "platforms" / "check"
HEADERS = Path(fmpy.__file__).parent / "c-code"
ZIG_CACHE = ROOT / "build" / "platforms" / "zig-cache"
MODELS = ("controller", "testbed", "drivetrain", "bumper")
# Platform -> command that starts its programs; a platform without an entry cannot be run here.
LAUNCHERS = {
    "x86_64-linux": [],
    "aarch64-linux": ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"],
    "x86_64-windows": ["/usr/lib/wine/wine64"],
}
TARGETS = {
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-darwin": "x86_64-macos.11.0",
    "aarch64-darwin": "aarch64-macos.11.0",
}
# SUNDIALS calls libm's pow when it chooses step sizes; its last bit may differ between C libraries.
PLANT_TOLERANCE = 1e-9

Outputs = Mapping[tuple[int, str], np.ndarray]


@dataclass
class Findings:
    """The faults found, in sentences."""

    faults: list[str] = field(default_factory=list)

    def say(self, subject: str, text: str, faults: Sequence[str]) -> None:
        print(f"{'FAIL' if faults else 'ok':5}{subject:32}{'; '.join(faults) if faults else text}", flush=True)
        self.faults += [f"{subject}: {fault}" for fault in faults]


def zig(*arguments: object) -> None:
    """Run zig's compiler."""
    binary = Path(ziglang.__file__).with_name("zig")
    cache = {"ZIG_GLOBAL_CACHE_DIR": str(ZIG_CACHE), "ZIG_LOCAL_CACHE_DIR": str(ZIG_CACHE)}
    subprocess.run([binary, *map(str, arguments)], check=True, env={**os.environ, **cache})


def _runner(platform: str) -> Path:
    """run_fmus for a platform."""
    path = WORK / platform / ("run_fmus.exe" if "windows" in platform else "run_fmus")
    path.parent.mkdir(parents=True, exist_ok=True)
    source = Path(__file__).with_name("run_fmus.c")
    options = [] if "windows" in platform else ["-ldl"]
    zig("cc", f"--target={TARGETS[platform]}", "-O1", "-s", f"-I{HEADERS}", source, "-o", path, *options)
    return path


def run(
    plan: Plan, name: str, platform: str, launcher: Sequence[str], runner: Path, others: Sequence[str] = ()
) -> Outputs:
    """The outputs of a plan on a platform; ``others``: libraries that are loaded and unloaded with those of the FMUs.

    RuntimeError if the process does not end with exit code 0.
    """
    folder = WORK / platform
    libraries = []
    for fmu in plan.fmus:
        library = fmu.library(platform, folder)
        libraries.append(os.path.relpath(library, folder))
        if "windows" not in platform:
            libraries[-1] = f"./{libraries[-1]}"
    path = folder / f"{name}.plan"
    plan.write(
        path, [library.replace("/", "\\") if "windows" in platform else library for library in libraries], others
    )
    environment = {**os.environ, "WINEPREFIX": str(WORK / "wine"), "WINEDEBUG": "-all", "DISPLAY": ""}
    command: list[str | Path] = [*launcher, runner, path.name]
    answer = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=600, check=False
    )
    if answer.returncode != 0:
        said = answer.stderr.strip() or "no message"
        raise RuntimeError(f"{name} on {platform} ended with exit code {answer.returncode}: {said}")
    return read_outputs(answer.stdout, plan)


def deviation(found: Outputs, expected: Outputs, instances: Sequence[int]) -> tuple[float, str]:
    """Largest difference of a real output relative to its peak, with its name; integers and booleans must be equal."""
    worst = (0.0, "")
    for (instance, name), values in expected.items():
        if instance not in instances:
            continue
        other = found[instance, name]
        if other.tobytes() == values.tobytes():
            error = 0.0
        elif values.dtype == np.float64 and np.isfinite(values).all() and np.isfinite(other).all():
            peak = float(np.max(np.abs(values)))
            difference = float(np.max(np.abs(other - values)))
            error = difference / peak if peak > 0 else difference
        else:
            error = float("inf")
        if error > worst[0]:
            worst = (error, name)
    return worst


def different_bits(found: Outputs, expected: Outputs) -> list[str]:
    """Names of outputs whose bits differ."""
    return [name for key, values in expected.items() for name in [key[1]] if found[key].tobytes() != values.tobytes()]


# Counts of the solver's work are not results.
_WORK = ("solver.steps", "solver.rhs_calls", "solver.jacobian_calls")


def results(outputs: Outputs) -> Outputs:
    return {key: values for key, values in outputs.items() if key[1] not in _WORK}


def check_runs(findings: Findings) -> None:
    """Every run on every platform that can run here, against the tested FMUs."""
    runner = _runner(HOST)
    expected = {name: run(plan, f"tested_{name}", HOST, [], runner) for name, plan in all_runs(TESTED).items()}
    if expected["collision"][CONTROLLER, "detection.count"][-1] < 1:
        findings.say("collision", "", ["nothing was detected: it was no collision"])
    alone = replay(TESTED, all_runs(TESTED)["collision"], expected["collision"])
    controller = run(alone, "tested_controller", HOST, [], runner)
    for platform, launcher in LAUNCHERS.items():
        runner = _runner(platform)
        plan = replay(FMUS, all_runs(FMUS)["collision"], expected["collision"])
        odd = different_bits(run(plan, "controller", platform, launcher, runner), controller)
        text = f"{len(controller)} outputs of {plan.steps} steps: the same bits"
        findings.say(f"{platform} controller", text, [f"other bits: {', '.join(odd[:3])}"] if odd else [])
        for name, plan in all_runs(FMUS).items():
            outputs = run(plan, name, platform, launcher, runner)
            model = "testbed" if name == "collision" else name
            error, worst = deviation(results(outputs), results(expected[name]), range(len(plan.fmus)))
            same = sum(outputs[key].tobytes() == values.tobytes() for key, values in expected[name].items())
            text = f"off by {error:.1e} {worst}; {same} of {len(outputs)} outputs the same bits"
            findings.say(f"{platform} {model}", text, [] if error <= PLANT_TOLERANCE else [text])
    plant_faults(findings, expected, controller)
    plant_late_code(findings)


def plant_late_code(findings: Findings) -> None:
    """The exit code of every runner must show a library that is called after it was unloaded."""
    for platform, launcher in LAUNCHERS.items():
        library = WORK / platform / ("late.dll" if "windows" in platform else "late.so")
        source = library.with_suffix(".c")
        source.write_text(_LATE_SOURCE)
        zig("cc", f"--target={TARGETS[platform]}", "-shared", source, "-o", library)
        runner, plan = _runner(platform), all_runs(FMUS)["bumper"]
        try:
            run(plan, "late", platform, launcher, runner, [f"./{library.name}"])
            findings.say(f"planted fault: late {platform}", "", ["code that runs after it is gone was not seen"])
        except RuntimeError as error:
            findings.say(f"planted fault: late {platform}", f"seen: {error}", [])


def plant_faults(findings: Findings, expected: Mapping[str, Outputs], controller: Outputs) -> None:
    """The comparisons must see a stiffness with an error of 1e-6, and a single torque with an error of 0.1 N m."""
    launcher, runner = LAUNCHERS[HOST], _runner(HOST)
    for name, plan in all_runs(FMUS, 1.0 + 1e-6).items():
        error, _ = deviation(results(run(plan, "planted", HOST, launcher, runner)), results(expected[name]), range(2))
        missed = [] if error > PLANT_TOLERANCE else [f"a stiffness 1e-6 off was not seen ({error:.1e})"]
        findings.say(f"planted fault: {name}", f"seen: off by {error:.1e}", missed)
    plan = replay(FMUS, all_runs(FMUS)["collision"], expected["collision"], nudge=0.1)
    odd = different_bits(run(plan, "planted", HOST, launcher, runner), controller)
    findings.say(
        "planted fault: controller", f"seen in {len(odd)} outputs", [] if odd else ["a torque off was not seen"]
    )


def _library(fmu: Path) -> bytes:
    """Of this machine's platform."""
    with zipfile.ZipFile(fmu) as archive:
        return archive.read(f"binaries/{HOST}/{fmu.stem.removesuffix('_fmi3')}.so")


def check_libraries(findings: Findings) -> None:
    """Every library of every FMU; both FMI versions hold the same."""
    fmus = [FMUS / f"giveway_{model}_fmi{version}.fmu" for model in MODELS for version in (2, 3)]
    seen: dict[tuple[str, str], object] = {}
    for entry in inspected(fmus, HEADERS):
        needed, faults = entry["needed"], entry["faults"]
        assert isinstance(needed, list)
        assert isinstance(faults, list)
        libraries = ", ".join(sorted({Path(str(name)).name.split("-l1-")[0] for name in needed}))
        text = f"{entry['exports']} exports, {entry['since']}, {entry['bytes']} bytes, needs {libraries}"
        subject = str(entry["fmu"]).removeprefix("giveway_").removesuffix(".fmu")
        model, platform = subject.split("_")[0], str(entry["platform"])
        if seen.setdefault((model, platform), entry["sha256"]) != entry["sha256"]:
            faults.append("is not the library of the other FMI version")
        findings.say(f"{subject} {entry['folder']}", text, faults)
    for model in MODELS:
        shipped, tested = (_library(folder / f"giveway_{model}_fmi3.fmu") for folder in (FMUS, TESTED))
        faults = [] if shipped == tested else ["is not the library that is tested"]
        findings.say(f"{model} {HOST}", "is the library that `make test` runs", faults)
    wanted = {(model, platform) for model in MODELS for platform in TARGETS}
    if set(seen) != wanted:
        findings.say("platforms", "", [f"missing: {sorted(wanted - set(seen))}"])


# Platform -> target, compiler options, expected findings.
_PLANTED = {
    "x86_64-linux": (
        "x86_64-linux-gnu.2.34",
        ["-Wl,--build-id"],
        ("glibc 2.34", "build id", "exports", "libother.so", "end of the process (__cxa_atexit)"),
    ),
    "aarch64-linux": ("x86_64-linux-gnu.2.17", [], ("processor",)),
    "x86_64-windows": (
        "x86_64-windows-gnu",
        ["-luser32"],
        ("exports", "needs libother.dll, USER32.dll", "(_crt_atexit)"),
    ),
    "x86_64-darwin": ("x86_64-macos.14.0", [], ("macOS 14.0", "exports", "needs", "own name", "(atexit)")),
    "aarch64-darwin": ("aarch64-linux-gnu.2.17", [], ("no library for darwin",)),
}
_PLANTED_SOURCE = """
#ifdef _WIN32
#include <windows.h>
__declspec(dllimport) int other(void);
int _crt_atexit(void (*)(void));
__declspec(dllexport) int planted(void) { return other() + MessageBoxA(0, "", "", 0) + _crt_atexit(0); }
#else
#include <pthread.h>
#include <stdlib.h>
int other(void);
#ifdef __APPLE__
static void late(void) {}
int planted(void) { return other() + atexit(late); }
#else
int __cxa_atexit(void (*)(void *), void *, void *);
int planted(void) { return other() + pthread_detach(pthread_self()) + __cxa_atexit(0, 0, 0); }
#endif
#endif
"""
# Registers a function for the end of the process, like a static object with a destructor. On Linux and Windows.
_LATE_SOURCE = """
static void late(void) {}
#ifdef _WIN32
#include <windows.h>
int _crt_atexit(void (*)(void));
BOOL WINAPI DllMain(HINSTANCE self, DWORD reason, void *reserved)
{
    return reason != DLL_PROCESS_ATTACH || _crt_atexit(late) == 0;
}
#else
int __cxa_atexit(void (*)(void *), void *, void *);
__attribute__((constructor)) static void start(void) { __cxa_atexit((void (*)(void *))late, 0, 0); }
#endif
"""


def plant_library_faults(findings: Findings) -> None:
    """A library for each platform with all faults that the check looks for."""
    folder = WORK / "planted"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "planted.c").write_text(_PLANTED_SOURCE)
    (folder / "other.c").write_text(
        "#ifdef _WIN32\n__declspec(dllexport)\n#endif\nint other(void) { return 1; }\n"
    )  # fmt: skip
    fmu = folder / "planted.fmu"
    with zipfile.ZipFile(fmu, "w") as archive:
        for platform, (target, options, _) in _PLANTED.items():
            suffix = {"linux": "so", "windows": "dll", "macos": "dylib"}[target.split("-")[1].split(".")[0]]
            other = folder / platform / f"libother.{suffix}"
            library = other.with_name(f"planted.{suffix}")
            other.parent.mkdir(exist_ok=True)
            common = ["cc", f"--target={target}", "-shared"]
            against = other.with_suffix(".lib") if suffix == "dll" else other
            implib = [f"-Wl,--out-implib,{against}"] if suffix == "dll" else []
            zig(*common, folder / "other.c", "-o", other, *implib)
            zig(*common, folder / "planted.c", against, *options, "-o", library)
            archive.write(library, f"binaries/{platform}/planted.{suffix}")
    for entry in inspected([fmu], HEADERS):
        said = "; ".join(map(str, entry["faults"])) if isinstance(entry["faults"], list) else ""
        missed = [f"not seen: {word}" for word in _PLANTED[str(entry["platform"])][2] if word not in said]
        findings.say(f"planted fault: {entry['platform']}", f"seen: {said}", missed)


def check_reproduction(findings: Findings) -> None:
    """A clean build in another folder gives the same files."""
    elsewhere = ROOT / "build" / "platforms" / "again" / "elsewhere"
    wall_s = build_again(ROOT, elsewhere)
    odd = differing(FMUS, elsewhere / "build" / "fmus_all")
    faults = [f"other bytes: {', '.join(odd)}"] if odd else []
    findings.say("another folder, from nothing", f"the same bytes, after {wall_s:.0f} s", faults)
    # The planted fault: a file name in a library, without the option that removes its folder.
    names = []
    for name in ("one", "two"):
        folder = WORK / "planted" / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "path.c").write_text("const char *path(void) { return __FILE__; }\n")
        zig("cc", "-shared", f"--target={TARGETS['x86_64-linux']}", folder / "path.c", "-o", folder / "path.fmu")
        names.append(folder)
    seen = differing(*names)
    findings.say("planted fault: a folder's name", f"seen in {seen}", [] if seen else ["not seen"])


def main() -> int:
    findings = Findings()
    check_reproduction(findings)
    check_libraries(findings)
    plant_library_faults(findings)
    check_runs(findings)
    print(f"{len(findings.faults)} faults")
    return 1 if findings.faults else 0


if __name__ == "__main__":
    sys.exit(main())
