"""What random_models.py puts into the scene of a seed."""

import numpy as np

import helmet
from model_lights import Model
from random_choices import LIGHT, Choices
from random_scenes import WALLS, box, quad, quaternion, sphere


def make(mi, seed, folder, without):
    """The scene in scene.gltf and environment.exr; the same for Mitsuba, its size, our options, and its description."""
    choices = Choices(seed, without)
    rng, on, scene, options = choices.rng(7), choices.on, Model(mi, choices), ["--max-plane-distance", "0.1"]
    # Of the scene as a whole; "instance", "camera-in-glass" and the units are noted where they have an effect.
    for name in on & {"room", "lights", "wide", "tall", "roll", "orthographic", "gather", "scattered-environment"}:
        choices.uses(name)
    is_room = "room" in on
    size = (80, 48) if "wide" in on else (48, 80) if "tall" in on else (56, 56)
    for number, (at, axis, angle) in enumerate(WALLS if is_room else WALLS[:1]):
        made = scene.mesh(number, quad(), "wall", False)
        scene.place(number, made, (2, 1, 2), quaternion(axis, angle), at)
    lights = [(-1.1, 3.3, 0.8), (0.9, 2.9, 1.2)] if is_room else [(-2, 4, 1.5), (2.5, 3.5, 2)]
    if "lights" in on:
        for number, at in enumerate(lights):
            scene.add_light(number, at, rng.uniform(-0.6, 0.6, 3) + [0, 0.4, 0])
    if is_room and "lights" not in on:
        emission = choices.rng(8).uniform(4, 10, 3).tolist()
        made = scene.mesh(LIGHT, quad(), "light", False, emission)
        if choices.has("both-sides", LIGHT):
            scene.ours["materials"][-1]["doubleSided"] = True
        scene.place(LIGHT, made, (0.8, 1, 0.8), quaternion([1, 0, 0], np.pi), [0.2, 3.2, -0.1])
    if not is_room:
        brightest = 4 if "lights" in on else 15
        cells = rng.uniform(0.2, 1, (16, 32, 3)).astype(np.float32) * (0.3 if "lights" in on else 1)
        for _ in range(6 if "scattered-environment" in on else 1):
            cells[rng.integers(2, 7), rng.integers(0, 32)] *= brightest
        mi.Bitmap(cells).write(str(folder / "environment.exr"))
        turned, scaled = float(rng.uniform(-180, 180)), float(rng.uniform(0.5, 2))
        environment = helmet.environment(mi, folder / "environment.exr")
        environment |= {"to_world": mi.ScalarTransform4f().rotate([0, 1, 0], turned), "scale": scaled}
        scene.theirs["environment"] = environment
        options += ["--environment", folder / "environment.exr", f"--environment-rotate={turned}"]
        options += [f"--environment-scale={scaled}"]
    made = None
    for number, (x, z) in enumerate([(-1, -1), (1, -0.9), (-0.9, 0.7), (1, 0.9)], 20):
        own = choices.rng(9, number)
        name, again = own.choice(["box", "sphere", "sheet"]), number == 23 and "instance" in on
        scale, turn, height = own.uniform(0.35, 0.55, 3), own.normal(size=4), own.uniform(0.9, 1.3)
        if choices.has("mirrored", number):
            scale *= [[-1, 1, 1], [1, -1, 1], [-1, -1, -1]][own.integers(3)]
        shape = {"box": box, "sphere": sphere, "sheet": quad}[name]()
        kind, emission = str(name), None
        if again:
            choices.uses("instance", number)
        else:
            smooth = bool(name == "sphere" and choices.has("smooth", number))
            if number == 21 and choices.has("emitter", number):
                emission = own.uniform(0.5, 3, 3).tolist()
            elif name != "sheet" and choices.has("glass", number):
                kind = "glass"
            elif name == "sheet" and choices.has("thin", number):
                kind = "thin"
            made = scene.mesh(number, shape, kind, smooth, emission)
        scene.place(number, made, scale, turn / np.linalg.norm(turn), [x, height, z])
        if kind == "glass" and choices.has("light-in-glass", number):
            inner = scene.mesh(number + 10, box(), "box", False, own.uniform(2, 6, 3).tolist())
            scene.place(number + 10, inner, [0.1, 0.1, 0.1], quaternion([0, 1, 0], 0.3), [x, height, z])
    if is_room:
        eye, target, fov, half = [rng.uniform(-1.2, 1.2), rng.uniform(1.5, 2.8), 1.85], [0.0, 1.1, -0.2], 65.0, 1.0
    else:
        eye, target, fov, half = [rng.uniform(-3, 3), rng.uniform(2.5, 5), 6.0], [0.0, 0.8, 0.0], 32.0, 1.8
    up = [0.3, 1.0, 0.2] if "roll" in on else [0, 1, 0]
    if "camera-in-glass" in on:
        choices.uses("camera-in-glass")
        around = scene.mesh(40, sphere(), "glass", False)
        scene.place(40, around, [0.12, 0.12, 0.12], quaternion([0, 1, 0], 0.5), eye)
    scene.add_camera(size, eye, target, up, fov, half)
    scene.write(folder / "scene.gltf")
    if "standard-units" in on:
        options += ["--light-units", "standard"]
        # Radiances of area lights and environments are the same in both units.
        if "lights" in on:
            choices.uses("standard-units")
    options += ["--indirect", "gather"] if "gather" in on else []
    volumes = scene.is_absorbing or ("lights" in on and on & {"mask", "blend"})
    integrator = "volpath" if volumes else "path"
    return mi.load_dict(scene.theirs, parallel=False), integrator, size, options, choices.described()
