"""Media around solids and within."""

import numpy as np
import pytest

import photonmap as pm

FLOOR = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]


def test_media():
    """Around solids and within: they are part of the scene, and wrong ones are refused."""

    def scene(**medium):
        lit = pm.Scene().quad("floor", FLOOR).point_light([0, 1, 0], 10)
        return lit.medium(**medium) if medium else lit

    assert scene(anisotropy=0.5).digest == scene().digest != scene(scattering=0.1).digest
    assert scene(scattering=0.1).digest != scene(scattering=0.1, anisotropy=0.5).digest
    air, fog = ({"scattering": 0.1, "phase": "rayleigh"}, {"scattering": 0.1, "phase": "mie", "droplet_micrometres": 10})
    assert len({scene(scattering=0.1).digest, scene(**air).digest, scene(**fog).digest}) == 3
    wrongs = ({**air, "anisotropy": 0.5}, {**air, "phase": "haze"}, {**air, "phase": "mie"}, {**fog, "droplet_micrometres": 60})
    for wrong in wrongs:
        with pytest.raises(pm.InputError, match="phase|between 5 and 50"):
            scene(**wrong).build()
    for wrong in ({"scattering": -1}, {"absorption": (0, np.inf, 0)}, {"scattering": 1, "anisotropy": 1}):
        with pytest.raises(pm.InputError, match="ambient medium: (scattering|absorption|anisotropy)"):
            scene(**wrong).build()
    milk = pm.Glass(1.35, scattering=(1, 2, 3), anisotropy=0.7)
    assert milk != pm.Glass(1.35) and scene().quad("milk", FLOOR, milk).digest != scene().quad("milk", FLOOR, pm.Glass(1.35)).digest
    assert pm.Glass(1.35, scattering=1, phase="rayleigh") != pm.Glass(1.35, scattering=1)
    with pytest.raises(pm.InputError, match="phase"):
        scene().quad("milk", FLOOR, pm.Glass(phase="rayleigh", anisotropy=0.1)).build()
    mist = pm.Boundary(scattering=1, absorption=0.5)
    assert scene().quad("mist", FLOOR, mist).digest != scene().quad("mist", FLOOR, pm.Boundary(scattering=2)).digest
    box = ((-1, 0, -1), (1, 2, 1))
    assert scene(scattering=0.1, box=box).digest != scene(scattering=0.1).digest
    with pytest.raises(pm.InputError, match="box"):
        scene(scattering=0.1, box=box[::-1]).build()
    with pytest.raises(pm.InputError, match="must have"):
        scene(scattering=0.1, box=box[0])
    pane = pm.Glass(thin=True, absorption=1)
    for wrong in (pm.Glass(scattering=-1), pm.Glass(scattering=1, anisotropy=-1), pm.Glass(thin=True, scattering=1), pane):
        with pytest.raises(pm.InputError, match="scattering|anisotropy|absorption"):
            scene().quad("milk", FLOOR, wrong).build()


def test_grids():
    """Densities inside a solid: of an array or a file, alike; and wrong ones are refused."""
    densities = np.arange(24, dtype=np.float32).reshape(2, 3, 4)

    def scene(**smoke):
        glass = pm.Glass(1, scattering=1, **smoke)
        return pm.Scene().quad("floor", FLOOR).point_light([0, 1, 0], 10).quad("smoke", FLOOR, glass)

    assert scene(grid=densities).digest != scene().digest
    assert scene(grid=densities).digest != scene(grid=densities, transform=np.diag([2.0, 1, 1, 1])).digest
    assert scene(grid=densities, density_scale=2).digest == scene(grid=2 * densities).digest
    wrong = (
        {"grid": -densities},
        {"grid": [1, 2]},
        {"grid": densities, "transform": np.zeros((4, 4))},
        {"grid": "absent.vol"},
        {"density_scale": 2},
    )
    for given in wrong:
        with pytest.raises(pm.Error, match="grid|transform|absent|density"):
            scene(**given).build()


def test_grid_files(tmp_path):
    densities = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    header = b"VOL\x03" + np.array([1, 4, 3, 2, 1], "<i4").tobytes() + np.array([0, 0, 0, 1, 1, 1], "<f4").tobytes()
    path = tmp_path / "a.vol"
    path.write_bytes(header + densities.tobytes())
    digests = [
        pm.Scene().quad("floor", FLOOR).point_light([0, 1, 0], 10).quad("smoke", FLOOR, pm.Glass(1, scattering=1, grid=grid)).digest
        for grid in (path, densities)
    ]
    assert digests[0] == digests[1]
