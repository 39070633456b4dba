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
    for wrong in ({"scattering": -1}, {"absorption": (0, np.inf, 0)}, {"scattering": 1, "anisotropy": 1}):
        with pytest.raises(pm.InputError, match="ambient medium: (scattering|absorption|anisotropy)"):
            scene(**wrong).build()
    milk = pm.Glass(1.35, scattering=(1, 2, 3), anisotropy=0.7)
    assert milk != pm.Glass(1.35) and scene().quad("milk", FLOOR, milk).digest != scene().quad("milk", FLOOR, pm.Glass(1.35)).digest
    for wrong in (pm.Glass(scattering=-1), pm.Glass(scattering=1, anisotropy=-1), pm.Glass(thin=True, scattering=1)):
        with pytest.raises(pm.InputError, match="scattering|anisotropy"):
            scene().quad("milk", FLOOR, wrong).build()
