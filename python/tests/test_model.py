"""Models as people have them: what they lack is supplied with a warning; environments; denoising."""

import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import warnings

import numpy as np
import pytest

import photonmap as pm

QUICK = {"size": (16, 12), "passes": 2, "photons": 3000}
ROOT = pathlib.Path(__file__).parent.parent.parent


@pytest.fixture
def model(tmp_path):
    """A file without light, whose material names a texture that is missing."""
    (tmp_path / "floor.mtl").write_text("newmtl floor\nKd 0.5 0.5 0.5\nmap_Kd gone.png\n")
    path = tmp_path / "floor.obj"
    path.write_text("mtllib floor.mtl\nusemtl floor\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n")
    return path


def quietly(call):
    """Warnings are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return call()


def test_a_model_without_light_is_seen_and_what_is_lost_is_told(model):
    with pytest.warns(pm.SceneWarning) as caught:
        film = pm.render(model, shadow_rays=256, **QUICK)
    texts = [str(each.message) for each in caught]
    assert len(texts) == 2 and all(each.filename == __file__ for each in caught), texts
    assert "gone.png" in texts[0] and texts[0].startswith("floor.obj: ")
    assert "no light" in texts[1] and "environment=" in texts[1]
    # Lambert(0.5), facing upwards, under the gradient: 1/2 (1 + 2/3 · 0.9 d_y), neither darker nor brighter.
    expected = 0.5 * (1 + 0.6 * 4 / 29**0.5)
    assert film.alpha.max() == 1 and abs(film.beauty[film.alpha == 1].mean() - expected) < 0.02
    with pytest.warns(pm.SceneWarning):
        scene = pm.Scene.load(model)
    assert scene.warnings == [texts[1].removeprefix("floor.obj: ")] and any("gone.png" in line for line in scene.report)
    # Once: not again where it is rendered, nor by a worker.
    quietly(scene.build)
    quietly(pickle.loads(pickle.dumps(scene)).build)
    with pytest.warns(pm.SceneWarning, match="no light"):
        pm.trace(pm.Scene().mesh("triangle", np.eye(3), [[0, 1, 2]]), photons=100)


def test_environments_by_text(model, tmp_path, monkeypatch):
    (tmp_path / "sky.hdr").write_bytes(b"#?RADIANCE\n\n-Y 16 +X 32\n" + bytes([128, 128, 128, 128]) * 512)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pm.SceneWarning)
        dark = pm.Scene.load(model)
        for given, same in [
            ("gradient", None),
            ("constant", 1.0),
            ("constant:1", 1.0),
            ("constant:0.2, 0.3, 0.4", (0.2, 0.3, 0.4)),
            ("sky:30,3", "sky:30,3"),
            (str(tmp_path / "sky.hdr"), tmp_path / "sky.hdr"),
        ]:
            scene = pm.Scene.load(model, environment=given)
            expected = dark if same is None else pm.Scene.load(model).environment(same)
            assert scene.digest == expected.digest and scene.warnings == []
            film = pm.render(model, environment=given, **QUICK)
            np.testing.assert_array_equal(film.beauty, pm.render(scene, **QUICK).beauty)
        assert pm.Scene.load(model, environment="constant:2").digest != dark.digest
    with pytest.raises(pm.FileError, match="none.exr"):
        pm.render("cornell", environment="none.exr", **QUICK)
    # Beside the lights of a built-in scene; by name relative to the folder, and kept in a pickle.
    assert pm.render("ring", environment="constant:5", **QUICK).beauty.sum() > pm.render("ring", **QUICK).beauty.sum()
    monkeypatch.chdir(tmp_path)
    scene = pm.Scene.builtin("ring").environment("sky.hdr")
    data = pickle.dumps(scene)
    monkeypatch.undo()
    assert pickle.loads(data).digest == scene.digest


@pytest.fixture
def denoiser(tmp_path, monkeypatch):
    """A library with the interface of Open Image Denoise that makes twice the colour plus the albedo plus the normal."""
    library = tmp_path / "libOpenImageDenoise.so"
    source = ROOT / "crates/photonmap-cli/tests/program/denoise/oidn.c"
    if shutil.which("cc") is None or not source.exists():
        pytest.skip("no C compiler, or not in the repository")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)
    monkeypatch.setenv("PHOTON_OIDN", str(library))


def test_pictures_are_denoised(denoiser, tmp_path):
    film = pm.render("cornell", **QUICK)
    denoised = film.denoise()
    np.testing.assert_array_equal(denoised, 2 * film.beauty + film.albedo + film.normal)
    film.save(tmp_path / "a.png")
    film.save(tmp_path / "b.png", denoise=True)
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()
    film.save(tmp_path / "a.exr", denoise=True)
    assert b"Open Image Denoise 2.3.4" in (tmp_path / "a.exr").read_bytes()
    # Within the claimed errors, as means of RGB, up to rounding.
    film = pm.render("cornell", **{**QUICK, "passes": 8}, errors=True)
    bound, difference = film.error_bound, np.abs((film.denoise() - film.beauty).mean(-1))
    claimed = np.isfinite(bound)
    assert claimed.any() and (difference[claimed] <= bound[claimed] * (1 + 1e-5) + 1e-6).all()
    with pytest.raises(pm.InputError, match="a.film"):
        film.save(tmp_path / "a.film", denoise=True)
    with pytest.raises(pm.InputError, match="transparent"):
        pm.render("cornell", transparent_background=True, **QUICK).denoise()


def test_without_the_denoiser_the_error_says_what_installs_it(monkeypatch):
    monkeypatch.setenv("PHOTON_OIDN", "/no/such/library.so")
    with pytest.raises(pm.DeviceError, match="pip install pyoidn"):
        pm.render("cornell", **QUICK).denoise()


def test_auto_and_gpu_are_no_software_driver():
    """In a process without PHOTON_VK_DEVICE, which may name one."""
    program = """
import photonmap as pm
job = dict(size=8, passes=1, photons=1000)
print(pm.render("cornell", **job)._raw.backends()[0])
assert pm.render("cornell", grain=1, **job)._raw.backends() == ["cpu"]
try:
    print(pm.render("cornell", device="gpu", **job)._raw.backends()[0])
except pm.DeviceError as why:
    print(why)
"""
    env = {name: value for name, value in os.environ.items() if name != "PHOTON_VK_DEVICE"}
    ended = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True, check=True)
    auto, gpu = ended.stdout.splitlines()
    if auto == "vulkan":
        assert gpu == "vulkan"
    else:
        assert auto == "cpu" and "no GPU can be used" in gpu and 'device="cpu"' in gpu and "gpu:0" in gpu
        assert "--" not in gpu
    if "llvmpipe" in gpu:
        assert "llvmpipe" in gpu and "is a software driver" in gpu
