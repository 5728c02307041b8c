"""Imports between modules run without circles, and stand at the top of a module unless a comment says why not."""

import ast
import importlib
import re
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[2]
LAZY = "# lazy:"  # begins the comment above a function's imports, or behind one


def project_modules():
    modules = {}
    for root in ("core", "app"):
        for path in sorted((ROOT / root).rglob("*.py")):
            parts = path.relative_to(ROOT / root).with_suffix("").parts
            modules[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return modules


MODULES = project_modules()


@cache
def tree_of(name):
    return ast.parse(MODULES[name].read_text(encoding="utf-8"))


def imported(node):
    """Project modules that one import statement names."""
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    else:
        names = [f"{node.module}.{alias.name}" for alias in node.names]
        names = [name if name in MODULES else node.module for name in names]
    return {name for name in names if name in MODULES}


def executed_imports(tree):
    """Import statements of a module and of its functions, but for those that only type checkers read."""
    pending = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            yield node
        elif not (isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING"):
            pending.extend(ast.iter_child_nodes(node))


def test_no_module_imports_itself_through_others():
    graph = {
        name: sorted({other for node in executed_imports(tree_of(name)) for other in imported(node)} - {name})
        for name in MODULES
    }
    assert sum(map(len, graph.values())) > 500
    TopologicalSorter(graph).prepare()  # which names the modules of a circle


def hidden_imports(tree, lines):
    """Lines of imports of project modules in functions without a comment that begins with ``LAZY``."""
    functions = [node for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    for block in (child for function in functions for child in ast.walk(function)):
        for body in (getattr(block, field, None) for field in ("body", "orelse", "finalbody")):
            said = False
            for node in body if isinstance(body, list) else ():
                if not isinstance(node, (ast.Import, ast.ImportFrom)):
                    said = False
                    continue
                said = said or lines[node.lineno - 2].strip().startswith(LAZY)
                if imported(node) and not said and LAZY not in lines[node.lineno - 1]:
                    yield node.lineno


def test_an_import_in_a_function_says_why():
    silent = {
        name: found
        for name, path in MODULES.items()
        if (found := sorted({*hidden_imports(tree_of(name), path.read_text(encoding="utf-8").splitlines())}))
    }
    assert silent == {}


# What a package sees beside the standard library and itself.
SEEN = {
    "insonify.kernels": "numpy numba insonify.compiler",
    "insonify.compiler": "numba llvmlite platformdirs insonify.child_process insonify.cores insonify.foreign_settings "
    "insonify.operating_system",
}


def test_kernels_and_their_compiler_see_nothing_of_other_packages():
    for name in (name for name in MODULES if name.startswith(tuple(SEEN))):
        package = ".".join(name.split(".")[:2])
        for node in executed_imports(tree_of(name)):
            for module in [node.module] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]:
                seen = module.startswith((package, *SEEN[package].split()))
                assert seen or module.partition(".")[0] in sys.stdlib_module_names, (name, module)


def test_functions_that_the_page_which_code_makes_it_names_exist():
    page = (ROOT / "docs/architecture/which-code.md").read_text(encoding="utf-8")
    names = set(re.findall(r"`(kernels\.[a-z_.]+)`", page))
    assert len(names) >= 20
    for name in names:
        module, function = f"insonify.{name}".rsplit(".", 1)
        assert callable(getattr(importlib.import_module(module), function)), name
    for row in re.findall(r"^\|(?! what|---).*\|$", page, re.MULTILINE):
        assert max(cell.count("`kernels.") for cell in row.split("|")) <= 2, row
    loose = set(re.findall(r"`([a-z]+_[a-z_]+)`", page))
    assert loose <= {name.rsplit(".", 1)[1] for name in names} | {"note_whole_segments"}
