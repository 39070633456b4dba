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
    for wrong in (pm.Glass(scattering=-1), pm.Glass(scattering=1, anisotropy=-1), pm.Glass(thin=True, scattering=1)):
        with pytest.raises(pm.InputError, match="scattering|anisotropy"):
            scene().quad("milk", FLOOR, wrong).build()
