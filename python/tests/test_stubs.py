"""The stubs declare what the module has: every public name, every member, every argument."""

import ast
import inspect
from pathlib import Path

import pytest

import alula

STUB = Path(alula.__file__).with_name("__init__.pyi")
TREE = ast.parse(STUB.read_text())
CLASSES = {node.name: node for node in TREE.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")}
FUNCTIONS = {node.name: node for node in TREE.body if isinstance(node, ast.FunctionDef)}


def test_the_package_is_typed():
    assert STUB.with_name("py.typed").is_file()
    assert STUB.read_text() == (Path(__file__).parents[1] / "package/alula/__init__.pyi").read_text()


def test_every_public_name_is_in_both():
    assert set(CLASSES) | set(FUNCTIONS) | {"__version__"} == set(alula.__all__)


def declared(arguments):
    """Names of arguments, with stars where they count."""
    names = [a.arg for a in arguments.posonlyargs + arguments.args if a.arg not in ("self", "cls")]
    names += ["*" + a.arg for a in arguments.kwonlyargs]
    return names + (["**" + arguments.kwarg.arg] if arguments.kwarg else [])


def actual(callable):
    kinds = {inspect.Parameter.KEYWORD_ONLY: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    parameters = inspect.signature(callable).parameters.values()
    return [kinds.get(p.kind, "") + p.name for p in parameters if p.name != "self"]


def optional(arguments):
    """Names of the arguments that may be left out."""
    ordered = arguments.posonlyargs + arguments.args
    names = [a.arg for a in ordered[len(ordered) - len(arguments.defaults) :]]
    return names + [a.arg for a, default in zip(arguments.kwonlyargs, arguments.kw_defaults) if default]


def same_arguments(node, callable):
    assert declared(node.args) == actual(callable), node.name
    parameters = inspect.signature(callable).parameters.values()
    left_out = [p.name for p in parameters if p.default is not inspect.Parameter.empty]
    assert optional(node.args) == left_out, node.name


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_have_the_arguments_that_are_declared(name):
    same_arguments(FUNCTIONS[name], getattr(alula, name))
    assert getattr(alula, name).__doc__


@pytest.mark.parametrize("name", CLASSES)
def test_classes_have_the_members_that_are_declared(name):
    cls, node = getattr(alula, name), CLASSES[name]
    assert cls.__doc__
    if issubclass(cls, Exception):
        # Their attributes are those of an instance, which the tests of errors look at.
        assert [base.id for base in node.bases] == [cls.__base__.__name__]
        return
    methods = {n.name: n for n in node.body if isinstance(n, ast.FunctionDef)}
    public = {n for n in vars(cls) if not n.startswith("_")}
    assert {n for n in methods if not n.startswith("_")} == public
    for member, function in methods.items():
        decorators = {ast.unparse(d) for d in function.decorator_list}
        found = inspect.getattr_static(cls, member)
        if decorators & {"property", "state.setter"}:
            assert inspect.isdatadescriptor(found) and found.__doc__, member
        elif member == "__new__":
            same_arguments(function, cls)
        elif not member.startswith("__"):
            assert isinstance(found, staticmethod) == ("staticmethod" in decorators), member
            same_arguments(function, getattr(cls, member))
            assert getattr(cls, member).__doc__
        else:
            assert member in vars(cls), member
