"""The notebook in `examples` runs, shows pictures, and its caustic becomes sharper."""

import base64
import importlib.util
import os
import pathlib
import re

import pytest

NOTEBOOK = pathlib.Path(__file__).parent.parent / "examples" / "caustic.ipynb"


def executed(source):
    """The outputs of the cells of a notebook, run from the top; it is saved to the folder PHOTONMAP_NOTEBOOKS, if set."""
    for module in ("nbclient", "ipykernel"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed")
    import nbclient
    import nbformat

    notebook = nbformat.reads(source, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    if folder := os.environ.get("PHOTONMAP_NOTEBOOKS"):
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook, pathlib.Path(folder) / NOTEBOOK.name)
    return [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]


def test_a_caustic_forms():
    outputs = executed(NOTEBOOK.read_text(encoding="utf-8"))
    pictures = [output["data"]["image/png"] for output in outputs if "image/png" in output.get("data", {})]
    assert len(pictures) == 4
    assert all(base64.b64decode(picture).startswith(b"\x89PNG") for picture in pictures)
    assert len(set(pictures)) == 4
    text = "".join(output.get("text", "") for output in outputs)
    differences = [int(percent) for percent in re.findall(r"differs by (\d+)%", text)]
    assert len(differences) == 3 and differences == sorted(differences, reverse=True), text


def test_a_notebook_that_fails_is_noticed():
    source = NOTEBOOK.read_text(encoding="utf-8").replace("import photonmap as pm", "import photonmap_is_not_there as pm")
    with pytest.raises(Exception, match="photonmap_is_not_there"):
        executed(source)
