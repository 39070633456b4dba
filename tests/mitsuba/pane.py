"""Compares sunlight on glossy surfaces behind glass with the particle tracer of Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/pane.py target/release/photonmap

Parallel light falls through a tilted block of solid glass onto rough metal, whose reflection is stored in photon maps, and onto
plastic, whose reflection is followed by camera paths. No path from the camera finds this light; Mitsuba's particles are
connected with the camera at each surface. Its BSDF is that of gloss.py. Fails like surfaces.py.
"""

import math

import gloss
import pair

SUN = [0.35, -1.0, 0.25]
IRRADIANCE = [3.0, 2.6, 2.0]
# Name: base colour, metallic, alpha.
FLOORS = {"metal": ([0.8, 0.6, 0.4], 1.0, 0.3), "plastic": ([0.3, 0.5, 0.7], 0.0, 0.12)}
TILT = 0.35


def block():
    """Corners and faces, seen counter-clockwise from outside, of the block of glass."""
    corners = [(x, y, z) for x in (-1.0, 1.0) for y in (-0.15, 0.15) for z in (-0.8, 0.8)]
    faces = [[1, 2, 4, 3], [5, 7, 8, 6], [1, 5, 6, 2], [3, 4, 8, 7], [1, 3, 7, 5], [2, 6, 8, 4]]
    cos, sin = math.cos(TILT), math.sin(TILT)
    return [(cos * x - sin * y, sin * x + cos * y + 1.7, z) for x, y, z in corners], faces


def main():
    args = pair.arguments(__doc__, "out/pane", "llvm_ad_rgb", 2048)

    import mitsuba as mi
    import drjit as dr

    mi.set_variant(args.variant)
    gloss.make_bsdf(mi, dr)
    quad = [[1, 2, 3], [1, 3, 4]]
    parts = {
        "metal": ([(-4, 0, 4), (0.4, 0, 4), (0.4, 0, -6), (-4, 0, -6)], quad),
        "plastic": ([(0.4, 0, 4), (5, 0, 4), (5, 0, -6), (0.4, 0, -6)], quad),
        "glass": block(),
    }
    pair.write_meshes(args.folder, parts)
    eye, target, fov = [0.5, 1.3, 4.2], [0.5, 0.0, 1.4], 30.0
    lines = ["[materials]", 'glass = { kind = "glass", ior = 1.5 }']
    bsdfs = {"glass": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}}
    for name, (color, metallic, alpha) in FLOORS.items():
        kind = f'kind = "glossy", albedo = {color}, metallic = {metallic}, roughness = {alpha**0.5}'
        lines.append(f"{name} = {{ {kind} }}")
        texture = mi.load_dict({"type": "rgb", "value": color})
        bsdfs[name] = {"type": "glossy", "base_color": texture, "metallic": metallic, "alpha": alpha}
    lines += ["[[lights]]", 'type = "directional"', f"direction = {SUN}", f"irradiance = {IRRADIANCE}"]
    lines += ["[[cameras]]", 'name = "main"', f"from = {eye}", f"to = {target}", "up = [0, 1, 0]", f"fov_degrees = {fov}"]
    (args.folder / "scene.toml").write_text("\n".join(lines) + "\n")

    scene = {"type": "scene", "sensor": pair.sensor(mi, eye, target, fov)}
    light = {"type": "rgb", "value": IRRADIANCE}
    scene["sun"] = {"type": "directional", "direction": SUN, "irradiance": light}
    for name, bsdf in bsdfs.items():
        shape = {"type": "obj", "filename": str(args.folder / f"{name}.obj"), "face_normals": True, "bsdf": bsdf}
        scene[name] = shape
    pair.compare(*pair.render(args, mi.load_dict(scene), mi, integrator="ptracer"), args.folder)


if __name__ == "__main__":
    main()
