"""Renders a scene several times with photonmap and with Mitsuba 3, and compares the means of the pictures and of blocks
of pixels; used by surfaces.py and gloss.py.
"""

import argparse
import pathlib
import subprocess
import sys

import numpy as np

SIZE = 64
BLOCK = 8


def arguments(description, folder, variant, samples):
    """The command line, parsed; with the folder created."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the photonmap program")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path(folder))
    parser.add_argument("--variant", default=variant)
    parser.add_argument("--samples", type=int, default=samples, help="paths per pixel and run of Mitsuba")
    parser.add_argument("--runs", type=int, default=4, help="runs of each with different seeds, at least 2")
    parser.add_argument("--passes", type=int, default=64)
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help="further options of photonmap")
    args = parser.parse_args()
    if args.runs < 2:
        parser.error("at least 2 runs are needed")
    args.folder.mkdir(parents=True, exist_ok=True)
    return args


def sensor(mi, origin, target, fov):
    """A camera for pictures of SIZE x SIZE pixels, with +y up."""
    to_world = mi.ScalarTransform4f().look_at(origin=origin, target=target, up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    return {"type": "perspective", "fov": fov, "fov_axis": "y", "to_world": to_world, "film": film}


def write_meshes(folder, parts):
    """scene.obj of all `parts`, and NAME.obj of each: pairs of points and of faces, lists of numbers from 1 on."""
    whole, base = [], 0
    for name, (points, faces) in parts.items():
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
        alone = lines + ["f " + " ".join(map(str, face)) for face in faces]
        (folder / f"{name}.obj").write_text("\n".join(alone) + "\n")
        whole += [f"usemtl {name}", *lines, *("f " + " ".join(str(base + i) for i in face) for face in faces)]
        base += len(points)
    (folder / "scene.obj").write_text("\n".join(whole) + "\n")


def write_overrides(args, materials, sky, eye, target, fov):
    """scene.toml: tables of materials by name, an even sky, and a camera."""
    lines = ["[materials]", *(f"{name} = {material}" for name, material in materials.items())]
    lines += ["[environment]", f"radiance = [{sky}, {sky}, {sky}]"]
    lines += ["[[cameras]]", 'name = "main"', f"from = {eye}", f"to = {target}", "up = [0, 1, 0]", f"fov_degrees = {fov}"]
    (args.folder / "scene.toml").write_text("\n".join(lines) + "\n")


def scene_of_meshes(args, mi, bsdfs, light, sky, eye, target, fov):
    """The same for Mitsuba: NAME.obj with each BSDF, of which `light` emits, under an even sky."""
    scene = {"type": "scene", "sensor": sensor(mi, eye, target, fov)}
    scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": sky}}
    for name, bsdf in bsdfs.items():
        shape = {"type": "obj", "filename": str(args.folder / f"{name}.obj"), "face_normals": True, "bsdf": bsdf}
        if name == "light":
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": light}}
        scene[name] = shape
    return mi.load_dict(scene)


def render(args, scene, mi, name="scene.obj", integrator="path"):
    """Pictures of the folder's file `name` with scene.toml by photonmap, and of `scene` by Mitsuba."""
    path = mi.load_dict({"type": integrator, "max_depth": -1, "rr_depth": 32})
    ours, theirs = [], []
    for seed in range(args.runs):
        theirs.append(np.array(mi.render(scene, integrator=path, spp=args.samples, seed=seed), dtype=np.float64))
        picture = args.folder / f"ours-{seed}.exr"
        command = [args.program, "render", args.folder / name, "--overrides", args.folder / "scene.toml"]
        command += ["--size", f"{SIZE}x{SIZE}", "--passes", str(args.passes), "--seed", str(seed), "-o", picture]
        # Mitsuba's shadow rays start at the triangles.
        command += ["--no-terminator-offset"]
        done = subprocess.run([*map(str, command), *args.arguments], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{done.stderr}{args.program} failed")
        layers = dict(mi.Bitmap(str(picture)).split())
        ours.append(np.array(layers["<root>"], dtype=np.float64)[..., :3])
    return ours, theirs


def blocks(picture):
    return picture.reshape(SIZE // BLOCK, BLOCK, SIZE // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def compare(ours, theirs, folder):
    """Fails if the pictures differ."""
    means = [np.array([picture.mean(axis=(0, 1)) for picture in pictures]) for pictures in (ours, theirs)]
    ratio = means[0].mean(axis=0) / means[1].mean(axis=0)
    print("mean, ours / theirs:", ratio.round(4))
    cells = [np.array([blocks(picture) for picture in pictures]) for pictures in (ours, theirs)]
    middle = [cell.mean(axis=0) for cell in cells]
    error = np.sqrt(sum(cell.var(axis=0, ddof=1) / len(cell) for cell in cells)) / middle[1]
    off = middle[0] / middle[1] - 1
    worst = np.unravel_index(np.abs(off).argmax(), off.shape)
    print(f"blocks of {BLOCK} pixels: worst {off[worst]:+.4f} ± {error[worst]:.4f}, rms {np.sqrt((off**2).mean()):.4f}")
    # Not >: NaN differs too.
    if not (np.abs(ratio - 1).max() <= 0.01 and (np.abs(off) <= 0.03 + 4.5 * error).all()):
        np.save(folder / "off.npy", off)
        sys.exit("the pictures differ")
