"""The plot: error over processor time, a row of panels for each scene."""

from .errors import ToolMissing
from .table import MEASURES, ladders

TITLES = {"all": "all pixels", "caustic": "caustic pixels", "median": "median pixel"}
COLOURS = {"ours": "#c0392b", "mitsuba": "#2471a3", "lux": "#7d8c3a", "povray": "#7d3c98"}
DASHES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1))]
MARKERS = "osD^v"
# Labels of the axis of time.
SECONDS = (1, 2, 5, 10, 20)


def styles(variants):
    """Colour by renderer, dash and marker by method."""
    seen, found = {}, {}
    for variant in variants:
        renderer = variant.split("-")[0]
        count = seen[renderer] = seen.get(renderer, -1) + 1
        found[variant] = {"color": COLOURS[renderer], "linestyle": DASHES[count % 5], "marker": MARKERS[count % 5]}
    return found


def draw(entries, path):
    """Writes the plot. Runs whose means differ from the reference have hollow markers."""
    try:
        import matplotlib
        from PIL import Image
    except ImportError:
        raise ToolMissing("matplotlib is not installed", "pip install matplotlib") from None
    matplotlib.use("agg")
    matplotlib.rcParams["font.size"] = 8
    from matplotlib import pyplot

    scenes = sorted({entry.row.scene for entry in entries})
    style = styles(sorted({entry.row.variant for entry in entries}))
    differ = {(e.row.scene, e.row.variant, e.row.net) for e in entries if e.means.verdict in ("differs", "shifted")}
    figure, panels = pyplot.subplots(len(scenes), 3, figsize=(9.0, 2.6 * len(scenes)), squeeze=False, sharex=True)
    for column, measure in enumerate(MEASURES):
        found = ladders(entries, measure)
        for panel, scene in zip(panels[:, column], scenes):
            for (name, variant), points in found.items():
                if name != scene:
                    continue
                line = {**style[variant], "linewidth": 1.6 if variant.startswith("ours") else 1.0}
                panel.plot(*zip(*points), **{**line, "marker": ""})
                fills = ["white" if (scene, variant, s) in differ else line["color"] for s, _ in points]
                places = {"marker": line["marker"], "s": 14, "facecolors": fills, "edgecolors": line["color"]}
                panel.scatter(*zip(*points), **places, zorder=3)
            panel.set(xscale="log", yscale="log", title=f"{scene}, {TITLES[measure]}")
            panel.set_xticks(SECONDS, map(str, SECONDS))
            panel.minorticks_off()
            panel.grid(linewidth=0.3)
            if not panel.lines:
                panel.set_axis_off()
                panel.set_title("")
        panels[-1, column].set_xlabel("processor seconds")
    for panel in panels[:, 0]:
        panel.set_ylabel("squared relative error")
    handles = [pyplot.Line2D([], [], label=variant, ms=4, **each) for variant, each in style.items()]
    figure.legend(handles=handles, loc="lower center", ncols=5, frameon=False)
    figure.tight_layout(rect=(0.0, 0.06 + 0.04 / len(scenes), 1.0, 1.0))
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    # A palette makes it a third of the size.
    Image.open(path).convert("RGB").quantize(48, dither=Image.Dither.NONE).save(path, optimize=True)
