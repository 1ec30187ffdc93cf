"""Draws the figures of the guide: ``python3 docs/pictures/figures.py WORK [NAME ...]``.

WORK is a folder with the outputs of the commands in README.md here. Needs matplotlib and Pillow,
the package ``stickslip`` for ``tracked``, ``rollout`` and ``plan``, and the program for
``tag-status``.
"""

import csv
import io
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Ellipse, Polygon
from numpy.typing import NDArray
from PIL import Image, ImageFilter

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
DEMO = ROOT / "crates/cli/demo/turn-square-disc"
WORK = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
INK, GREY, BLUE, ORANGE, GREEN, YELLOW = "#222222", "#888888", "#0072B2", "#D55E00", "#009E73", "#F0E442"

Points = NDArray[np.float64]

matplotlib.use("svg")
plt.rcParams.update({"font.size": 14, "font.family": "DejaVu Sans", "axes.spines.top": False, "axes.spines.right": False})


def save_svg(figure: plt.Figure, name: str) -> None:
    """Writes a figure as SVG without ids that nothing refers to."""
    plt.rcParams["svg.hashsalt"] = name
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    svg = text.getvalue()
    used = set(re.findall(r'(?:url\(|href=")#([^")]+)', svg))
    svg = re.sub(r' id="([^"]+)"', lambda found: found.group(0) if found.group(1) in used else "", svg)
    (HERE / f"{name}.svg").write_text(re.sub(r"<\?xml.*?<svg ", "<svg ", svg, flags=re.DOTALL))


def save_png(image: Image.Image, name: str, greys: int = 32, accents: tuple[str, ...] = (ORANGE,)) -> None:
    """Writes an image as PNG with a palette: greys, and each accent mixed with them."""
    levels = np.linspace(0, 255, greys).round()
    colours = [np.repeat(level, 3) for level in levels]
    for accent in accents:
        pure = 255 * np.array(matplotlib.colors.to_rgb(accent))
        colours += [share * pure + (1 - share) * ground for share in (1, 0.75, 0.5, 0.25) for ground in (20, 128, 255)]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.array(colours).round().astype(np.uint8).ravel().tolist())
    image.convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE).save(HERE / f"{name}.png", optimize=True)


def png_of(figure: plt.Figure, dpi: int = 130) -> Image.Image:
    """Renders a figure."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=dpi)
    plt.close(figure)
    return Image.open(data)


class Camera:
    """A calibrated camera, as ``calibration.toml`` describes it."""

    def __init__(self, path: Path) -> None:
        text = tomllib.loads(path.read_text())
        self.lens, table = text["lens"], text["table"]
        self.rotation, self.translation = np.array(table["rotation"]), np.array(table["translation"])

    def pixels(self, points: Points) -> Points:
        """Pixels of points (N, 3) in the world."""
        seen = points @ self.rotation.T + self.translation
        x, y = seen[:, 0] / seen[:, 2], seen[:, 1] / seen[:, 2]
        (k1, k2, *_), (p1, p2) = self.lens["radial"], self.lens["tangential"]
        r2 = x * x + y * y
        radial = 1 + k1 * r2 + k2 * r2 * r2
        across = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        down = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        return np.column_stack([across, down]) * self.lens["focal"] + self.lens["centre"]


def placed(points: Points, pose: Points) -> Points:
    """Points of a body's frame in the world."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


def tracked_tags(row: int) -> tuple[Image.Image, Camera, dict[str, Points], dict[str, Points], dict[str, str]]:
    """A rendered frame, its camera, outer corners of both tags, their covariance, and the row's text."""
    camera = Camera(WORK / "rendered/calibration.toml")
    tags = tomllib.loads((WORK / "rendered/tags.toml").read_text())
    with (WORK / "rendered/poses.csv").open() as file:
        text = list(csv.DictReader(file))[row]
    corners, covariances = {}, {}
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    for body in ("object", "pusher"):
        at = {key: float(text[f"{body}_{key}"]) for key in ("x", "y", "theta", "var_x", "var_y", "var_theta")}
        tag = placed(tags[body]["size"] * square, np.array(tags[body]["pose"]))
        world = placed(tag, np.array([at["x"], at["y"], at["theta"]]))
        corners[body] = np.column_stack([world, np.full(4, tags[body]["height"])])
        cov = [float(text[f"{body}_cov_{key}"]) for key in ("x_y", "x_theta", "y_theta")]
        covariances[body] = np.array(
            [[at["var_x"], cov[0], cov[1]], [cov[0], at["var_y"], cov[2]], [cov[1], cov[2], at["var_theta"]]]
        )
    return Image.open(WORK / f"rendered/frames/{row:06d}.png"), camera, corners, covariances, text


def picture_axes(width: float, height: float, cut: tuple[float, float, float, float]) -> tuple[plt.Figure, plt.Axes]:
    """Axes that an image fills; ``cut`` is left, right, bottom, top in pixels."""
    figure = plt.figure(figsize=(width, height))
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set_axis_off()
    ax.set(xlim=cut[:2], ylim=cut[2:])
    return figure, ax


def label(ax: plt.Axes, at: Points, words: str, colour: str, **more: object) -> None:
    """Writes words on a dark box."""
    box = {"facecolor": "black", "alpha": 0.65, "edgecolor": "none", "pad": 3}
    ax.text(*at, words, color=colour, bbox=box, fontsize=18, **more)


def frame() -> None:
    """A camera frame with the tracked tags and the world axes."""
    image, camera, corners, _, text = tracked_tags(100)
    figure, ax = picture_axes(8, 5.9, (180, 639, 405, 66))
    ax.imshow(image, cmap="gray", vmin=0, vmax=255, extent=(-0.5, 639.5, 479.5, -0.5))
    for body, colour in (("object", "#56B4E9"), ("pusher", "#E69F00")):
        pixels = camera.pixels(corners[body])
        ax.add_patch(Polygon(pixels, fill=False, edgecolor=colour, linewidth=3))
        x, y, theta = (float(text[f"{body}_{key}"]) for key in ("x", "y", "theta"))
        words = f"{body}\n{1e3 * x:.2f} mm, {1e3 * y:.2f} mm\n{round(theta, 3) + 0.0:.3f} rad"
        place = np.array([pixels[:, 0].mean() + (20 if body == "pusher" else -10), 100.0 if body == "object" else 340.0])
        label(ax, place, words, colour, ha="center", va="center")
    axes = camera.pixels(np.array([[0, 0, 0], [0.04, 0, 0], [0, -0.04, 0]], dtype=float) * [1, -1, 1])
    for k, name in ((1, "x"), (2, "y")):
        ax.annotate("", axes[k], axes[0], arrowprops={"arrowstyle": "-|>", "color": YELLOW, "linewidth": 3, "shrinkA": 0})
    label(ax, axes[1] + [-14, 19], "x, world", YELLOW, ha="center", va="center")
    label(ax, axes[2] + [12, 6], "y, world", YELLOW, ha="left", va="center")
    save_png(png_of(figure, 125), "frame", 64, ("#56B4E9", "#E69F00", YELLOW))


def board() -> None:
    """The calibration board, as printed and as the camera sees it in the hand."""
    figure = plt.figure(figsize=(9, 7.1))
    ax = figure.add_axes((0.02, 0.35, 0.96, 0.64))
    printed = np.asarray(Image.open(WORK / "board.png").convert("L"))
    scale = 297 / printed.shape[1]
    ink = np.argwhere(printed[: int(190 / scale)] < 80)
    left, bottom = ink[:, 1].min() * scale, ink[:, 0].max() * scale
    ax.imshow(printed, cmap="gray", extent=(0, 297, printed.shape[0] * scale, 0))
    ax.set_axis_off()
    ax.set(xlim=(left - 26, left + 240), ylim=(bottom + 22, bottom - 160))
    for dx, dy, name, at in ((45, 0, "x", (50, 12)), (0, -45, "y", (-10, -42))):
        arrow = {"arrowstyle": "-|>", "color": ORANGE, "linewidth": 3, "shrinkA": 0}
        ax.annotate("", (left + dx, bottom + dy), (left, bottom), arrowprops=arrow)
        ax.text(left + at[0], bottom + at[1], name, color=ORANGE, fontsize=18, ha="center", va="center", style="italic")
    ax.plot(left, bottom, "o", color=ORANGE, markersize=8)
    ax.text(left - 22, bottom + 12, "origin", color=ORANGE, fontsize=15, ha="left", va="center")
    for number in (100, 101, 106, 107, 134):
        row, column = divmod(number - 100, 7)
        box = {"facecolor": "white", "edgecolor": ORANGE, "pad": 3}
        at = (left + 12 + 32 * column, bottom - 12 - 32 * row)
        ax.text(*at, str(number), color=ORANGE, fontsize=14, ha="center", va="center", bbox=box)
    for k, name in enumerate(("003", "007", "012")):
        view = figure.add_axes((0.015 + 0.327 * k, 0.01, 0.317, 0.31))
        view.imshow(Image.open(WORK / f"rendered/board/{name}.png"), cmap="gray", vmin=0, vmax=255)
        view.set_axis_off()
    save_png(png_of(figure, 110), "board", 32)


def edited_frames(folder: Path) -> None:
    """Writes a frame as it is, with the hand over the tag or its edge, and with a second tag."""
    folder.mkdir(parents=True, exist_ok=True)
    plain = Image.open(WORK / "rendered/frames/000100.png")
    hand = Image.open(WORK / "rendered/frames/000140.png").crop((460, 115, 640, 400))
    mask = hand.point(lambda grey: 255 if grey > 140 else 0).filter(ImageFilter.GaussianBlur(0.7))
    frames = [plain.copy() for _ in range(4)]
    frames[1].paste(hand, (420, 115), mask)
    frames[2].paste(hand, (452, 115), mask)
    frames[3].paste(plain.crop((409, 196, 482, 269)), (429, 346))
    for k, image in enumerate(frames):
        image.save(folder / f"{k:03d}.png")
    lines = [f"{k / 30:.4f},{k:03d}.png\n" for k in range(4)]
    (folder / "frames.csv").write_text("time,file\n" + "".join(lines))


def tag_status() -> None:
    """Four crops of frames with the status that ``track`` gives the object's tag."""
    edited_frames(WORK / "status/frames")
    known = ["--calibration", "rendered/calibration.toml", "--tags", "rendered/tags.toml"]
    subprocess.run(["stickslip", "track", "status/frames", *known, "--out", "status"], cwd=WORK, check=True)
    with (WORK / "status/poses.csv").open() as file:
        rows = list(csv.DictReader(file))
    figure = plt.figure(figsize=(6, 6.6))
    for k, row in enumerate(rows):
        ax = figure.add_axes((0.01 + 0.5 * (k % 2), 0.51 - 0.5 * (k // 2), 0.48, 0.436))
        x, y, size = (390, 180, 110) if k < 3 else (345, 182, 250)
        image = Image.open(WORK / f"status/frames/{k:03d}.png").crop((x, y, x + size, y + size))
        ax.imshow(image, cmap="gray", vmin=0, vmax=255)
        ax.set_axis_off()
        ax.set_title(row["object_seen"], fontsize=19, pad=5, family="DejaVu Sans Mono")
    save_png(png_of(figure, 110), "tag-status", 56, ())


def tag_corners() -> None:
    """One tag in pixels with the fitted edges and the uncertainty of its corners."""
    image, camera, corners, covariances, text = tracked_tags(100)
    points = corners["object"]
    pixels = camera.pixels(points)
    low, high = pixels.min(axis=0) - 9, pixels.max(axis=0) + 9
    figure, ax = picture_axes(8, 8 * (high[1] - low[1]) / (high[0] - low[0]), (low[0], high[0], high[1], low[1]))
    ax.imshow(image, cmap="gray", vmin=0, vmax=255, extent=(-0.5, 639.5, 479.5, -0.5), interpolation="nearest")
    ax.add_patch(Polygon(pixels, fill=False, edgecolor=ORANGE, linewidth=3))
    pose = np.array([float(text[f"object_{key}"]) for key in ("x", "y")])
    for point, pixel in zip(points, pixels, strict=True):
        arm = point[:2] - pose
        moved = np.array([[1, 0, -arm[1]], [0, 1, arm[0]]])
        step = 1e-5
        near = camera.pixels(point + step * np.eye(3)[:2])
        jacobian = (near - pixel).T / step
        spread = jacobian @ moved @ covariances["object"] @ moved.T @ jacobian.T
        values, vectors = np.linalg.eigh(spread)
        angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
        axes = 2 * 500 * np.sqrt(values)
        ax.add_patch(Ellipse(pixel, axes[1], axes[0], angle=angle, fill=False, edgecolor="#56B4E9", linewidth=3))
        ax.plot(*pixel, "o", color="#56B4E9", markersize=5)
    save_png(png_of(figure, 84), "tag-corners", 32, (ORANGE, "#56B4E9"))


def rows_of_table(page: str, first: str) -> list[list[str]]:
    """Cells of a page's table rows whose first cell begins with ``first``."""
    lines = [line for line in (ROOT / "docs/guide" / page).read_text().splitlines() if line.startswith(f"| {first}")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def blur() -> None:
    """Bias and spread of x, from the table in camera.md."""
    figure, panels = plt.subplots(1, 2, figsize=(9, 4.2), sharey=True, layout="constrained")
    for ax, first, words in zip(panels, ("blur", "moved by"), ("blur (px)", "motion in the exposure (px)"), strict=True):
        for body, colour, mark in (("object", BLUE, "o"), ("pusher", ORANGE, "s")):
            cells = [row for row in rows_of_table("camera.md", first) if row[0].endswith(body)]
            at = [float(re.findall(r"[\d.]+", row[0])[0]) for row in cells]
            for column, style, name in ((3, "-", "spread"), (2, "--", "|bias|")):
                values = [max(abs(float(row[column].split(",")[0])), 0.1) for row in cells]
                ax.plot(at, values, style, color=colour, marker=mark, label=f"{name}, {body}")
        ax.set(xlabel=words, yscale="log")
        ax.grid(axis="y", color="#dddddd")
    panels[0].set_ylabel("error of x (µm)")
    panels[0].legend(fontsize=12, loc="upper left")
    save_svg(figure, "blur")


def response() -> None:
    """Response times of the three loads, from the table in live.md."""
    rows = rows_of_table("live.md", "none") + rows_of_table("live.md", "two busy")
    rows = [row for row in rows if re.match(r"[\d.]+, [\d.]+, [\d.]+$", row[1])]
    figure, ax = plt.subplots(figsize=(9, 3.6), layout="constrained")
    loads = ["no other load", "two busy loops", "two busy loops\nand builds"]
    for k, row in enumerate(rows):
        median, most, longest = map(float, row[1].split(","))
        y = len(rows) - 1 - k
        ax.plot([median, longest], [y, y], color="#bbbbbb", linewidth=3, zorder=1)
        for value, colour, mark, name in (
            (median, BLUE, "o", "median"), (most, ORANGE, "s", "99 %"), (longest, INK, "D", "longest"),
        ):  # fmt: skip
            ax.plot(value, y, mark, color=colour, markersize=10, label=name if k == 0 else None, linestyle="none")
    ax.axvline(8, color=GREEN, linestyle="--", linewidth=2, label="deadline, 8 ms")
    ax.set(xscale="log", xlabel="response time (ms)", ylim=(-0.5, 2.5), xlim=(0.4, 700), yticks=[2, 1, 0], yticklabels=loads)
    ax.set_xticks([1, 10, 100], labels=["1", "10", "100"])
    figure.legend(loc="outside upper center", ncols=4, fontsize=13, frameon=False)
    save_svg(figure, "response")


def fit() -> None:
    """Errors on pushes left out, before and after a fit, from fit.json."""
    pushes = json.loads((WORK / "fitted/fit.json").read_text())["cross_validation"]["pushes"]
    pushes = sorted(pushes, key=lambda push: -push["final_mm"][0])
    figure, ax = plt.subplots(figsize=(8, 6.4), layout="constrained")
    for k, push in enumerate(pushes):
        before, after = push["final_mm"]
        ax.plot([before, after], [k, k], color="#bbbbbb", linewidth=3, zorder=1)
        ax.plot(before, k, "o", color=GREY, markersize=9, label="first guesses" if k == 0 else None)
        ax.plot(after, k, "D", color=BLUE, markersize=8, label="fitted to other pushes" if k == 0 else None)
    ax.set(yticks=range(len(pushes)), xlabel="error of the final position (mm)", xlim=(0, None))
    ax.set_yticklabels([push["push"].removeprefix("tri_") for push in pushes], fontsize=12)
    ax.invert_yaxis()
    ax.grid(axis="x", color="#dddddd")
    ax.legend(loc="lower right", frameon=False)
    save_svg(figure, "fit-errors")


def tracked() -> None:
    """The first figures of ``stickslip.plot``: poses, and the error with its band."""
    import stickslip
    from stickslip import plot

    scene = stickslip.load_scene(DEMO / "scene.toml")
    log, truth = stickslip.load_log(DEMO / "log.csv"), stickslip.load_truth(DEMO / "truth.csv")
    estimate = stickslip.filter(log, scene, occlude=60)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.4), layout="constrained", width_ratios=(1, 0.9))
    plot.poses(estimate, scene, log=log, ax=left)
    plot.errors(estimate, truth, ax=right)
    left.xaxis.set_major_locator(plt.MultipleLocator(0.04))
    right.set_ylim(0, 3)
    right.legend(loc="upper left", fontsize=12)
    save_svg(figure, "tracked")


def coloured(figure: plt.Figure, ax: plt.Axes, values: Points, words: str) -> Callable[[float], tuple[float, ...]]:
    """Adds a colour bar; returns the colour of a value."""
    colours = matplotlib.cm.ScalarMappable(plt.Normalize(values.min(), values.max()), "viridis")
    figure.colorbar(colours, ax=ax, label=words)
    return colours.to_rgba


def rollout() -> None:
    """End poses of the rollout in python.md, coloured by the pusher's friction."""
    import stickslip
    from stickslip import plot

    scene = stickslip.load_scene(DEMO / "scene.toml")
    friction = np.linspace(0.1, 0.6, 1000)
    push = np.linspace([-0.035, -0.018, 0.0], [0.010, -0.018, 0.0], 61)
    ends = stickslip.rollout(scene, np.zeros((1000, 3)), push, {"mu_p": friction})["pose"][:, -1]
    figure, ax = plt.subplots(figsize=(8, 5.4), layout="constrained")
    plot.scene(scene, object=(0, 0, 0), pusher=push[0], ax=ax)
    plot.scene(scene, pusher=push[-1], ax=ax)
    colour = coloured(figure, ax, friction, "friction of the pusher, mu_p")
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.025
    for value, end in list(zip(friction, ends, strict=True))[::12]:
        ax.add_patch(Polygon(placed(corners, end), fill=False, edgecolor=colour(value), linewidth=1))
    ax.scatter(ends[:, 0], ends[:, 1], s=5, c=friction, cmap="viridis", zorder=3)
    ax.annotate("", push[-1, :2], push[0, :2], arrowprops={"arrowstyle": "-|>", "color": ORANGE, "linewidth": 2})
    ax.text(-0.024, 0.018, "start", color=BLUE)
    ax.autoscale_view()
    png_of(figure, 120).convert("RGB").quantize(200).save(HERE / "rollout.png", optimize=True)


def plan() -> None:
    """Candidates of the notebook plan.py, the best one, and its end poses."""
    import stickslip
    from stickslip import plan, plot

    text = (ROOT / "docs/notebooks/plan.py").read_text()
    scene = stickslip.Scene(re.search(r'Scene\("""(.*?)"""', text, flags=re.DOTALL).group(1))
    here, goal = (0.0, 0.0, 0.0), (0.035, -0.010, -0.3)
    pushes = plan.straight_pushes(scene, here, 500, length=0.05)
    outcome = plan.predict(scene, here, pushes, plan.prior(scene, 20))
    best = outcome.nearest(goal, jam_below=0.05)
    figure, ax = plt.subplots(figsize=(8, 5.4), layout="constrained")
    for path in pushes[:60]:
        ax.annotate("", path[-1, :2], path[0, :2], arrowprops={"arrowstyle": "->", "color": "#c8c8c8", "linewidth": 1})
    plot.scene(scene, object=here, pusher=pushes[best, 0], ax=ax)
    for end in outcome.pose[best]:
        ax.add_patch(Polygon(placed(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.025, end), fill=False, edgecolor=BLUE, alpha=0.5))
    ax.add_patch(Polygon(placed(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.025, np.array(goal)), fill=False, edgecolor=GREEN, linewidth=3, linestyle="--"))
    ax.plot(*goal[:2], "+", color=GREEN, markersize=14, markeredgewidth=3)
    ax.annotate("", pushes[best, -1, :2], pushes[best, 0, :2], arrowprops={"arrowstyle": "-|>", "color": ORANGE, "linewidth": 3})
    ax.set(xlim=(-0.055, 0.11), ylim=(-0.055, 0.05))
    save_svg(figure, "plan")


FIGURES: dict[str, Callable[[], None]] = {
    "frame": frame,
    "board": board,
    "tag-status": tag_status,
    "tag-corners": tag_corners,
    "blur": blur,
    "response": response,
    "fit": fit,
    "tracked": tracked,
    "rollout": rollout,
    "plan": plan,
}

if __name__ == "__main__":
    for name in sys.argv[2:] or FIGURES:
        FIGURES[name]()
