"""Draws the diagrams of the guide as SVG: ``python3 docs/pictures/diagrams.py [NAME ...]``.

Only the standard library is needed.
"""

import csv
import math
import sys
import tomllib
from collections.abc import Callable, Iterable
from html import escape
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]

#: Colours of Okabe and Ito, for bodies as in the report.
INK, GREY, LIGHT, BLUE, ORANGE, GREEN = "#222222", "#777777", "#e4e4e4", "#0072B2", "#D55E00", "#007a5a"

Point = tuple[float, float]


class Drawing:
    """An SVG on a white ground; y points down, lengths are pixels at full width."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.parts: list[str] = []
        self.head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
            ' font-family="Roboto, \'DejaVu Sans\', Arial, Helvetica, sans-serif" font-size="20" role="img"'
            f' aria-label="{escape(title)}">'
        )
        self.parts.append(f'<rect width="{width}" height="{height}" fill="#ffffff"/>')

    def add(self, tag: str, **attributes: object) -> None:
        """Adds an element; ``_`` in names of attributes becomes ``-``."""
        text = " ".join(f'{name.replace("_", "-")}="{escape(str(value))}"' for name, value in attributes.items())
        self.parts.append(f"<{tag} {text}/>")

    def text(self, at: Point, words: str, *, fill: str = INK, anchor: str = "middle", **more: object) -> None:
        """Writes words on a white halo; ``~`` begins and ends italics."""
        spans = "".join(
            f'<tspan font-style="italic">{escape(part)}</tspan>' if index % 2 else escape(part)
            for index, part in enumerate(words.split("~"))
        )
        rest = "".join(f' {name.replace("_", "-")}="{escape(str(value))}"' for name, value in more.items())
        self.parts.append(
            f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}" fill="{fill}" stroke="#ffffff"'
            f' stroke-width="4" stroke-linejoin="round" paint-order="stroke"{rest}>{spans}</text>'
        )

    def line(self, *points: Point, stroke: str = INK, width: float = 2, dash: str = "") -> None:
        """Draws an open line."""
        more = {"stroke_dasharray": dash} if dash else {}
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.add("polyline", points=path, fill="none", stroke=stroke, stroke_width=width, **more)

    def arrow(
        self, a: Point, b: Point, *, stroke: str = INK, width: float = 2, both: bool = False, dash: str = ""
    ) -> None:
        """Draws a line with a head at ``b``, and one at ``a`` if ``both``."""
        size = 5 + 2.2 * width
        length = math.dist(a, b)
        ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        inset = 0.8 * size
        start = (a[0] + inset * ux, a[1] + inset * uy) if both else a
        self.line(start, (b[0] - inset * ux, b[1] - inset * uy), stroke=stroke, width=width, dash=dash)
        for tip, s in [(b, 1), (a, -1)] if both else [(b, 1)]:
            base = (tip[0] - s * size * ux, tip[1] - s * size * uy)
            side = (-0.42 * size * uy, 0.42 * size * ux)
            corners = [tip, (base[0] + side[0], base[1] + side[1]), (base[0] - side[0], base[1] - side[1])]
            self.add("polygon", points=" ".join(f"{x:.1f},{y:.1f}" for x, y in corners), fill=stroke)

    def polygon(self, points: Iterable[Point], *, fill: str = "none", stroke: str = INK, **more: object) -> None:
        """Draws a closed polygon."""
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.add("polygon", points=path, fill=fill, stroke=stroke, **{"stroke_width": 2.5, **more})

    def disc(self, at: Point, radius: float, *, fill: str, stroke: str = INK, **more: object) -> None:
        """Draws a circle."""
        place = {"cx": f"{at[0]:.1f}", "cy": f"{at[1]:.1f}", "r": f"{radius:.1f}"}
        self.add("circle", **place, fill=fill, stroke=stroke, **{"stroke_width": 2.5, **more})

    def box(self, at: Point, size: Point, lines: list[str], *, fill: str = "#ffffff", stroke: str = INK) -> None:
        """Draws a box with centred lines; the first is bold."""
        (x, y), (w, h) = at, size
        self.add("rect", x=x, y=y, width=w, height=h, rx=8, fill=fill, stroke=stroke, stroke_width=2)
        top = y + h / 2 - 13 * (len(lines) - 1) + 7
        for index, words in enumerate(lines):
            bold = {"font_weight": "bold"} if index == 0 else {"font_size": 18}
            self.text((x + w / 2, top + 26 * index), words, stroke_opacity=0, **bold)

    def svg(self) -> str:
        """Returns the file's text."""
        return "\n".join([self.head, *self.parts, "</svg>", ""])


def placed(points: Iterable[Point], pose: tuple[float, float, float]) -> list[Point]:
    """Points of a body's frame in the world."""
    x, y, theta = pose
    c, s = math.cos(theta), math.sin(theta)
    return [(x + c * px - s * py, y + s * px + c * py) for px, py in points]


def scene() -> str:
    """Draws the demo's scene 1.67 s after its start, with all frames."""
    folder = ROOT / "crates/cli/demo/turn-square-disc"
    text = tomllib.loads((folder / "scene.toml").read_text())
    with (folder / "truth.csv").open() as file:
        row = list(csv.DictReader(file))[50]
    pose = (float(row["x"]), float(row["y"]), float(row["theta"]))
    pusher = (float(row["pusher_x"]), float(row["pusher_y"]))
    d = Drawing(800, 610, "The demo scene from above with the frames of world, object and pusher")

    def at(x: float, y: float) -> Point:
        return 262 + 5900 * x, 300 - 5900 * y

    d.arrow(at(-0.042, 0), at(0.0895, 0), stroke=GREY)
    d.arrow(at(0, -0.0505), at(0, 0.0465), stroke=GREY)
    for k in (-40, -20, 20, 40, 60, 80):
        d.line(at(k / 1e3, -0.0008), at(k / 1e3, 0.0008), stroke=GREY)
        if k not in (-20, 20):
            d.text((at(k / 1e3, 0)[0], at(0, 0)[1] + 23), str(k), fill=GREY, font_size=17)
    for k in (-40, -20, 20, 40):
        d.line(at(-0.0008, k / 1e3), at(0.0008, k / 1e3), stroke=GREY)
        if k != 20:
            d.text((at(0, 0)[0] - 10, at(0, k / 1e3)[1] + 6), str(k), fill=GREY, anchor="end", font_size=17)
    square = placed(text["object"]["shape"][0]["polygon"], pose)
    d.polygon([at(*p) for p in square], fill=BLUE, stroke=BLUE, fill_opacity=0.13)
    radius = 5900 * text["pusher"]["shape"][0]["disc"]["radius"]
    d.disc(at(*pusher), radius, fill="#f3c9ac", stroke=ORANGE)
    for k, fixel in enumerate(text["fixel"], 1):
        x, y = fixel["position"]
        d.disc(at(x, y), radius, fill="#cccccc", stroke=INK)
        d.text((at(x, y)[0], at(x, y)[1] + 8), str(k), stroke_opacity=0, font_weight="bold", font_size=24)
        below = at(x, y)[1] + radius + 24
        d.text((at(x, y)[0] + 10, below), f"fixel {k}", font_weight="bold")
        d.text((at(x, y)[0] + 10, below + 23), f"({1e3 * x:.0f}, {1e3 * y:.0f})", font_size=18)

    # The world frame.
    d.text((at(0, 0)[0] + 14, 29), "~y~ of the world (mm)", anchor="start", fill=GREY)
    d.text((794, at(0, 0)[1] + 54), "~x~ of the world (mm)", anchor="end", fill=GREY)

    # The object's frame and its pose.
    centre, ahead, across = placed([(0, 0), (0.0165, 0), (0, 0.0145)], pose)
    d.line(at(*centre), at(centre[0] + 0.0385, centre[1]), stroke=GREY, width=1.5, dash="5 4")
    (start, _), (end, _) = at(*centre), at(0, 0)
    d.arrow(at(0, centre[1] + 0.0168), at(centre[0], centre[1] + 0.0168), both=True, width=1.5)
    d.line(at(centre[0], centre[1]), at(centre[0], centre[1] + 0.0180), stroke=GREY, width=1.5, dash="5 4")
    d.text(((start + end) / 2 + 6, at(0, centre[1] + 0.0168)[1] - 8), f"~x~ = {1e3 * pose[0]:.1f}")
    d.arrow(at(*centre), at(*ahead), stroke=BLUE, width=3)
    d.arrow(at(*centre), at(*across), stroke=BLUE, width=3)
    d.text((at(*ahead)[0] - 4, at(*ahead)[1] - 11), "~x~", fill=BLUE, font_weight="bold")
    d.text((at(*across)[0] + 15, at(*across)[1] + 4), "~y~", fill=BLUE, font_weight="bold")
    d.disc(at(*centre), 4, fill=BLUE, stroke=BLUE)
    d.line(at(centre[0] - 0.0065, centre[1]), at(*centre), stroke=GREY, width=1.5, dash="5 4")
    x = centre[0] - 0.0055
    d.arrow(at(x, centre[1] + 0.0062), at(x, centre[1]), width=1.5)
    d.arrow(at(x, -0.0062), at(x, 0), width=1.5)
    d.text((at(x, 0)[0], at(0, -0.0062)[1] + 20), f"~y~ = {1e3 * pose[1]:.1f}")
    reach = 0.033
    arc = [(centre[0] + reach * math.cos(a), centre[1] + reach * math.sin(a)) for a in (0, pose[2])]
    (x0, y0), (x1, y1) = at(*arc[0]), at(*arc[1])
    d.line(at(*ahead), at(centre[0] + 1.12 * reach * math.cos(pose[2]), centre[1] + 1.12 * reach * math.sin(pose[2])),
           stroke=BLUE, width=1.5, dash="5 4")  # fmt: skip
    r = 5900 * reach
    d.add("path", d=f"M{x0:.1f} {y0:.1f}A{r:.1f} {r:.1f} 0 0 0 {x1:.1f} {y1:.1f}", fill="none", stroke=INK, stroke_width=2)
    d.text((x0 + 14, (y0 + y1) / 2 + 6), f"~θ~ = {pose[2]:.3f} rad", anchor="start")
    label = placed([(0.0, -0.0172), (0.0, -0.0212)], pose)
    d.text(at(*label[0]), "object", fill=BLUE, font_weight="bold")
    d.text(at(*label[1]), "origin: centre of mass", fill=BLUE, font_size=18)

    # Lengths.
    a, b = placed([(-0.025, -0.0283), (0.025, -0.0283)], pose)
    d.arrow(at(*a), at(*b), both=True, width=1.5)
    low = placed([(0.0, -0.0325)], pose)[0]
    d.text(at(*low), "50 mm", transform=f"rotate({-math.degrees(pose[2]):.1f} {at(*low)[0]:.1f} {at(*low)[1]:.1f})")
    fixel = text["fixel"][0]["position"]
    touch = placed([(0.025, 0.0)], pose)[0]
    normal = (math.cos(pose[2]), math.sin(pose[2]))
    gap = sum((f - t) * n for f, t, n in zip(fixel, touch, normal, strict=True)) - 0.005
    near = (fixel[0] - 0.005 * normal[0], fixel[1] - 0.005 * normal[1])
    face = (near[0] - gap * normal[0], near[1] - gap * normal[1])
    d.line(at(*face), at(*near), stroke=GREEN, width=4)
    d.line(at((face[0] + near[0]) / 2, face[1] + 0.0008), at(0.054, 0.0375), stroke=GREEN, width=1.5)
    d.text((at(0.054, 0)[0] + 4, at(0, 0.0385)[1]), f"gap {1e3 * gap:.1f} mm", fill=GREEN, font_weight="bold", anchor="start")

    # The pusher.
    px, py = pusher
    d.arrow(at(px, py), at(px + 0.011, py), stroke=ORANGE, width=3)
    d.arrow(at(px, py), at(px, py + 0.011), stroke=ORANGE, width=3)
    d.text(at(px + 0.0105, py - 0.0045), "~x~", fill=ORANGE, font_weight="bold")
    d.text(at(px - 0.0028, py + 0.0095), "~y~", fill=ORANGE, font_weight="bold")
    d.text((16, at(0, py)[1] + 72), "pusher", fill=ORANGE, font_weight="bold", anchor="start")
    for k, words in enumerate(("radius 5 mm", "speed 20 mm/s")):
        d.text((16, at(0, py)[1] + 97 + 24 * k), words, fill=ORANGE, font_size=18, anchor="start")
    d.arrow(at(px - 0.021, py), at(px - 0.0062, py), stroke=ORANGE, width=5)
    return d.svg()


def tags_on_object() -> str:
    """Draws the object of the bag's guide with both tag frames in the body frame."""
    outline = [(-23.6, -23.6), (36.4, -23.6), (36.4, 1.4), (1.4, 1.4), (1.4, 36.4), (-23.6, 36.4)]
    d = Drawing(800, 560, "An L-shaped object from above with its body frame and the frames of two tags")

    def at(x: float, y: float) -> Point:
        return 240 + 8 * x, 325 - 8 * y

    d.polygon([at(*p) for p in outline], fill="#eeeeee")
    for name, pose, colour, label, words in (
        ("tag_7", (12, -4, 1.5), BLUE, (39.5, -6), ["12 mm, -4 mm, 1.5 rad", "[0.012, -0.004, 1.5]"]),
        ("tag36h11:8", (-20, 10, -0.5), ORANGE, (8, 31), ["-20 mm, 10 mm, -0.5 rad", "[-0.02, 0.01, -0.5]"]),
    ):
        tag = placed([(-6, -6), (6, -6), (6, 6), (-6, 6)], pose)
        d.polygon([at(*p) for p in tag], fill="#ffffff", stroke=colour)
        inner = placed([(-4.6, -4.6), (4.6, -4.6), (4.6, 4.6), (-4.6, 4.6)], pose)
        d.polygon([at(*p) for p in inner], fill=colour, stroke="none", fill_opacity=0.25)
        d.line(at(0, 0), at(pose[0], pose[1]), stroke=colour, dash="7 5")
        for tip, letter, text in (((11, 0), "~x~", (13, 0)), ((0, 11), "~y~", (0, 13))):
            end, place = placed([tip, text], pose)
            d.arrow(at(pose[0], pose[1]), at(*end), stroke=colour, width=3)
            d.text((at(*place)[0], at(*place)[1] + 7), letter, fill=colour, font_weight="bold")
        d.text(at(*label), name, fill=colour, anchor="start", font_weight="bold")
        for k, line in enumerate(words, 1):
            d.text((at(*label)[0], at(*label)[1] + 27 * k), line, fill=colour, anchor="start", font_size=18)
    d.arrow(at(0, 0), at(21, 0), width=3)
    d.arrow(at(0, 0), at(0, 21), width=3)
    d.disc(at(0, 0), 5, fill=INK)
    d.text((at(23, 0)[0], at(0, 0)[1] + 7), "~x~", font_weight="bold")
    d.text((at(0, 0)[0], at(0, 22.3)[1]), "~y~", font_weight="bold")
    d.text(at(-21, -14.5), "body frame", anchor="start", font_weight="bold")
    d.text(at(-21, -18), "origin: centre of mass", anchor="start", font_size=18)
    d.arrow(at(-7, -12.6), at(-0.8, -1.2), width=1.5)
    return d.svg()


def tag_geometry() -> str:
    """Draws the heights and tag frames of the guide's ``tags.toml``, from the side and from above."""
    d = Drawing(800, 640, "Object and pusher with their tags, from the side and from above")

    def side(x: float, z: float) -> Point:
        return 408 + 5.2 * x, 232 - 5.2 * z

    def top(x: float, y: float) -> Point:
        return 408 + 5.2 * x, 475 - 5.2 * y

    d.text((20, 34), "from the side", anchor="start", font_weight="bold")
    d.line(side(-80, 0), side(64, 0), stroke=GREY, width=3)
    d.text((20, 258), "table", anchor="start", fill=GREY)
    d.polygon([side(*p) for p in ((-15, 0), (35, 0), (35, 20), (-15, 20))], fill=BLUE, stroke=BLUE, fill_opacity=0.13)
    d.polygon([side(*p) for p in ((-23, 3), (-15, 3), (-15, 22), (-47, 22), (-47, 30), (-63, 30), (-63, 16), (-23, 16))],
              fill=ORANGE, stroke=ORANGE, fill_opacity=0.18)  # fmt: skip
    d.line(side(-4, 20.4), side(24, 20.4), width=7)
    d.line(side(-71, 30.4), side(-43, 30.4), width=7)
    d.arrow(side(43, 0), side(43, 20), both=True)
    d.line(side(36, 20), side(45, 20), stroke=GREY, width=1.5)
    d.text((side(44, 0)[0] + 6, side(0, 10)[1] + 7), "~height~ 20 mm", anchor="start", fill=BLUE)
    d.arrow(side(-74, 0), side(-74, 30), both=True)
    d.line(side(-76, 30), side(-71, 30), stroke=GREY, width=1.5)
    d.text((side(-74, 0)[0] + 10, side(0, 9)[1]), "~height~ 30 mm", anchor="start", fill=ORANGE)

    d.text((20, 316), "from above", anchor="start", font_weight="bold")
    d.polygon([top(*p) for p in ((-15, -25), (35, -25), (35, 25), (-15, 25))], fill=BLUE, stroke=BLUE, fill_opacity=0.13)
    d.polygon([top(*p) for p in ((-23, -20), (-15, -20), (-15, 20), (-23, 20))], fill=ORANGE, stroke=ORANGE, fill_opacity=0.18)
    d.polygon([top(*p) for p in ((-47, -3), (-23, -3), (-23, 3), (-47, 3))], fill=ORANGE, stroke=ORANGE, fill_opacity=0.18)
    for x, edge, colour in ((10, 28, BLUE), (-59, 24, ORANGE)):
        half, white = edge / 2, edge / 2 + 3
        d.polygon([top(x + a * white, b * white) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], fill="#ffffff", stroke=GREY, stroke_width=1.5)
        d.polygon([top(x + a * half, b * half) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], fill="#cfcfcf", stroke=INK)
        d.arrow(top(x, 0), top(x + 11.5, 0), stroke=colour, width=3)
        d.arrow(top(x, 0), top(x, 11.5), stroke=colour, width=3)
        d.text(top(x + 9.5, -4.3), "~x~", fill=colour, stroke_opacity=0, font_weight="bold")
        d.text(top(x - 2.4, 8.5), "~y~", fill=colour, stroke_opacity=0, font_weight="bold")
        d.disc(top(x, 0), 4, fill=colour, stroke=colour)
    d.arrow(top(-4, -21), top(24, -21), both=True)
    d.text((top(10, 0)[0], top(0, -21)[1] + 48), "~size~ 28 mm", fill=BLUE)
    d.arrow(top(-71, -19), top(-47, -19), both=True)
    d.text((top(-59, 0)[0], top(0, -19)[1] + 26), "~size~ 24 mm", fill=ORANGE)
    d.disc(top(-19, 0), 5, fill=ORANGE)
    d.arrow(top(-19, 23), top(-59, 23), width=2)
    d.line(top(-19, 0), top(-19, 24.5), stroke=GREY, width=1.5, dash="5 4")
    d.line(top(-59, 0), top(-59, 24.5), stroke=GREY, width=1.5, dash="5 4")
    d.text((top(-39, 0)[0], top(0, 25.2)[1]), "~pose~ -40 mm, 0, 0", fill=ORANGE)
    d.text((top(37, 0)[0], top(0, 18)[1]), "object:", anchor="start", fill=BLUE, font_weight="bold")
    d.text((top(37, 0)[0], top(0, 18)[1] + 25), "~pose~ 0, 0, 0", anchor="start", fill=BLUE)
    d.text((top(-34, 0)[0], top(0, -9)[1]), "pusher", fill=ORANGE, font_weight="bold")
    return d.svg()


def bag_flow() -> str:
    """Draws the way from a bag to a viewer."""
    d = Drawing(800, 430, "Data flow from a ROS 2 bag to estimate, report and viewers")
    d.box((20, 30), (220, 150), ["ROS 2 bag", "/tf, /tf_static", "/fixel_1/contact", "..."], fill="#e3f0f8", stroke=BLUE)
    d.box((290, 30), (220, 64), ["stickslip info", "topics, rates, gaps"])
    d.box((290, 116), (220, 64), ["stickslip check", "0 problems"])
    d.box((20, 260), (220, 120), ["scene.toml", "stickslip new,", "then your numbers"], fill="#e3f0f8", stroke=BLUE)
    d.box((290, 260), (220, 120), ["stickslip filter", "particle filter", "over contacts"])
    d.box((570, 30), (210, 100), ["report.html", "in a browser"], fill="#fbe9dd", stroke=ORANGE)
    d.box((570, 155), (210, 100), ["estimate.csv", "one row per log row"], fill="#fbe9dd", stroke=ORANGE)
    d.box((570, 280), (210, 120), ["estimate.mcap", "Rerun, Foxglove,", "RViz"], fill="#fbe9dd", stroke=ORANGE)
    d.arrow((240, 62), (288, 62))
    d.arrow((240, 148), (288, 148))
    d.line((240, 290), (265, 290), (265, 166))
    d.arrow((265, 166), (288, 166))
    d.line((240, 165), (252, 165), (252, 310))
    d.arrow((252, 310), (288, 310))
    d.arrow((240, 345), (288, 345))
    d.line((510, 320), (540, 320), (540, 80))
    d.arrow((540, 80), (568, 80))
    d.arrow((540, 205), (568, 205))
    d.arrow((540, 340), (568, 340))
    d.line((540, 320), (540, 340))
    return d.svg()


def live_flow() -> str:
    """Draws what goes into a live session and what comes out of it."""
    d = Drawing(800, 400, "Data flow of a live session")
    d.box((15, 50), (200, 110), ["camera, robot", "touch sensors"], fill="#e3f0f8", stroke=BLUE)
    d.box((310, 50), (170, 110), ["stickslip live", "500 particles"])
    d.box((605, 50), (180, 110), ["controller", "or planner"], fill="#fbe9dd", stroke=ORANGE)
    d.box((15, 270), (200, 90), ["scene.toml", "priors, bodies"], fill="#e3f0f8", stroke=BLUE)
    d.box((300, 270), (190, 90), ["--record FILE", ".mcap or .csv"], fill="#fbe9dd", stroke=ORANGE)
    d.box((605, 270), (180, 90), ["--page", "in a browser"], fill="#fbe9dd", stroke=ORANGE)
    d.arrow((215, 105), (308, 105), width=3)
    d.text((260, 88), "rows")
    d.text((260, 134), "JSON", font_size=18, fill=GREY)
    d.arrow((480, 105), (603, 105), width=3)
    d.text((540, 88), "estimates")
    d.text((540, 134), "JSON", font_size=18, fill=GREY)
    d.line((115, 270), (115, 215), (340, 215))
    d.arrow((340, 215), (340, 162))
    d.arrow((395, 160), (395, 268))
    d.text((407, 246), "rows", anchor="start", font_size=18)
    d.line((450, 160), (450, 215), (695, 215))
    d.arrow((695, 215), (695, 268))
    d.text((585, 204), "at most 30 rows/s", font_size=18)
    return d.svg()


DRAWINGS: dict[str, Callable[[], str]] = {
    "scene": scene,
    "tags-on-object": tags_on_object,
    "tag-geometry": tag_geometry,
    "bag-flow": bag_flow,
    "live-flow": live_flow,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or DRAWINGS:
        (HERE / f"{name}.svg").write_text(DRAWINGS[name]())
