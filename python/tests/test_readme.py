"""The examples of the README and of the page docs/python.md run, and the type stubs are those of the compiled module."""

import doctest
import importlib.util
import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).parent.parent


@pytest.mark.parametrize("page", ["README.md", "../docs/python.md"])
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_examples(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failed, tried = doctest.testfile(str(FOLDER / page), module_relative=False, encoding="utf-8")
    assert failed == 0 and tried > 0


def test_an_example_that_fails_is_noticed(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(">>> 1 + 1\n3\n")
    assert doctest.testfile(str(page), module_relative=False, report=False, verbose=False).failed == 1


def test_stubs(tmp_path):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    command = [sys.executable, "-m", "mypy.stubtest", "--concise", "photonmap._photonmap"]
    result = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr


def test_types(tmp_path):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    program = "import photonmap as pm\nfilm: pm.Film = pm.render('cornell', size=8)\nfilm.save(3)\n"
    result = subprocess.run([sys.executable, "-m", "mypy", "-c", program], capture_output=True, text=True, cwd=tmp_path)
    # One error, which shows that types are seen.
    assert "save" in result.stdout and "Found 1 error" in result.stdout, result.stdout + result.stderr
