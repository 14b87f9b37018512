"""Finds and plants small faults in Python. mutmut does both: its mutants are copies of a function behind a trampoline
that chooses one of them at run time.

Runs in the environment of verify/requirements.lock, which has mutmut.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

import libcst
from libcst.metadata import MetadataWrapper, PositionProvider
from mutmut.mutation.file_mutation import Mutation, combine_mutations_to_source, create_mutations
from mutmut.mutation.trampoline_templates import trampoline_imports

from verify.mutation.mutants import Key, Mutant

__all__ = ["PythonPlaces"]

OUR_TRAMPOLINE = "\nfrom giveway_mutants import MutantDict, trampoline as _mutmut_mutated\n"


class PythonPlaces:
    """The mutants of the files in ``folders`` (below ``searched``, which is on Python's path), without ``left_out``."""

    def __init__(self, root: Path, folders: Iterable[str], searched: Iterable[str], left_out: Iterable[str]) -> None:
        self.root = root
        self.searched = [root / folder for folder in searched]
        self.parsed: dict[Path, tuple[libcst.Module, dict[Mutant, Mutation]]] = {}
        avoided = [root / place for place in left_out]
        for path in sorted(path for folder in folders for path in (root / folder).rglob("*.py")):
            if not any(path.is_relative_to(place) for place in avoided):
                self.parsed[path] = self._parse(path)

    @property
    def mutants(self) -> list[Mutant]:
        return [mutant for _, mutations in self.parsed.values() for mutant in mutations]

    def plant(self, numbers: Mapping[Mutant, int], tree: Path) -> dict[str, int]:
        """Write the files with mutants below ``tree``; the number of each trampoline's function."""
        names: dict[str, int] = {}
        for path, (module, mutations) in self.parsed.items():
            chosen = [mutant for mutant in mutations if mutant in numbers]
            if chosen:
                planted = combine_mutations_to_source(module, [mutations[mutant] for mutant in chosen])
                module_name = self._module_name(path)
                for mutant, name in zip(chosen, planted.mutant_names, strict=True):
                    names[f"{module_name}.{name}"] = numbers[mutant]
                assert planted.code.count(trampoline_imports.strip()) == 1
                text = planted.code.replace(trampoline_imports.strip(), OUR_TRAMPOLINE.strip())
                (tree / path.relative_to(self.root)).write_text(text, encoding="utf-8")
        return names

    def _module_name(self, path: Path) -> str:
        folder = next(folder for folder in self.searched if path.is_relative_to(folder))
        parts = path.relative_to(folder).with_suffix("").parts
        return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)

    def _parse(self, path: Path) -> tuple[libcst.Module, dict[Mutant, Mutation]]:
        text = path.read_text(encoding="utf-8")
        module, mutations, _, _ = create_mutations(str(path), text)
        functions = _functions(module)
        positions = MetadataWrapper(module, unsafe_skip_copy=True).resolve(PositionProvider)
        lines = text.splitlines()
        seen: Counter[tuple[str, str, str]] = Counter()
        found: dict[Mutant, Mutation] = {}
        for mutation in mutations:
            function = functions.get(mutation.contained_by_top_level_function)
            if function is None or not _tells(mutation):
                continue
            number = positions[mutation.original_node].start.line
            line = " ".join(lines[number - 1].split())
            before, after = (module.code_for_node(node) for node in (mutation.original_node, mutation.mutated_node))
            change = " ".join(f"{before} -> {after}".split())
            seen[function, line, change] += 1
            name = path.relative_to(self.root).as_posix()
            key = Key(name, function, line, change, seen[function, line, change])
            found[Mutant(key, path, number, 0, 0, after)] = mutation
        return module, found


def _tells(mutation: Mutation) -> bool:
    """Leaves out mutants of texts, which people have to judge, and of removed values or arguments: those crash as soon
    as they are reached, so they tell no more than line coverage."""
    if isinstance(mutation.original_node, libcst.BaseString | libcst.Assign | libcst.AnnAssign | libcst.Lambda):
        return False
    if isinstance(mutation.original_node, libcst.Call):
        return bool(mutation.original_node.args == mutation.mutated_node.args)  # it is a different function
    return True


def _functions(module: libcst.Module) -> dict[libcst.CSTNode | None, str]:
    """Those that mutmut gives a trampoline, with their names."""
    found: dict[libcst.CSTNode | None, str] = {}
    for node in module.body:
        if isinstance(node, libcst.FunctionDef):
            found[node] = node.name.value
        elif isinstance(node, libcst.ClassDef) and isinstance(node.body, libcst.IndentedBlock):
            for member in node.body.body:
                if isinstance(member, libcst.FunctionDef):
                    found[member] = f"{node.name.value}.{member.name.value}"
    return found
