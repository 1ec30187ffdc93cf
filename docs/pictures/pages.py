"""Cuts pictures from report pages: ``python3 docs/pictures/pages.py WORK [NAME ...]``.

WORK is a folder with the outputs of the commands in README.md here. Needs Pillow, playwright and a
Chromium, named in CHROMIUM; ``live-page`` needs ``stickslip`` on the path.
"""

import csv
import io
import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont
from playwright.sync_api import sync_playwright

HERE = Path(__file__).resolve().parent
DEMO = HERE.parents[1] / "crates/cli/demo/turn-square-disc"
WORK = Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
GROUND = (252, 251, 248)

#: Selectors of the first and the last element in a cut, and which of each.
Cut = tuple[str, int, str, int]


def cuts(address: str, *wanted: Cut, scale: float = 1, wait: int = 1500) -> list[Image.Image]:
    """Returns parts of a page that is 1280 pixels wide, ``wait`` ms old, with 12 pixels around them."""
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=os.environ.get("CHROMIUM"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900}, device_scale_factor=scale)
        page.goto(address)
        page.wait_for_timeout(wait)
        images = []
        for first, at, last, end in wanted:
            boxes = [page.locator(selector).nth(k).bounding_box() for selector, k in ((first, at), (last, end))]
            low = [min(box[key] for box in boxes) - 12 for key in ("x", "y")]
            size = [max(box[key] + box[length] for box in boxes) + 12 - least
                    for key, length, least in (("x", "width", low[0]), ("y", "height", low[1]))]  # fmt: skip
            clip = {"x": low[0], "y": low[1], "width": size[0], "height": size[1]}
            images.append(Image.open(io.BytesIO(page.screenshot(clip=clip, full_page=True))).convert("RGB"))
        browser.close()
    return images


def save(image: Image.Image, name: str) -> None:
    """Writes an image as PNG with a palette."""
    palette = image.quantize(256, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    palette.save(HERE / f"{name}.png", optimize=True)


def below(*images: Image.Image, gap: int = 12) -> Image.Image:
    """Puts images one below the other."""
    whole = Image.new("RGB", (max(i.width for i in images), sum(i.height + gap for i in images) - gap), GROUND)
    top = 0
    for image in images:
        whole.paste(image, (0, top))
        top += image.height + gap
    return whole


def report() -> None:
    """Player and verdicts of the demo's report."""
    save(*cuts(f"file://{WORK}/turn/report.html", (".player", 0, ".fates", 0)), "report")


def compare() -> None:
    """Errors of twenty rigs, and each method against the particle filter."""
    save(*cuts(f"file://{WORK}/compare.html", ("figure", 0, "figure", 1)), "compare")


def bag_report() -> None:
    """Player, verdicts and friction of the bag's report."""
    save(below(*cuts(f"file://{WORK}/report.html", (".player", 0, ".fates", 0), ("figure", 5, "figure", 5))), "bag-report")


def fit_report() -> None:
    """Posteriors, values and errors on pushes left out, from a fit's report."""
    parts = cuts(f"file://{WORK}/fit.html", ("h2", 0, "table", 0), ("h2", 1, "table", 1))
    save(below(*parts), "fit-report")


def bifurcation() -> None:
    """Particles of experiment 5 at the end, without and with touch."""
    font = ImageFont.truetype("DejaVuSans.ttf", 26)
    panels = []
    for name in ("no-touch", "touch"):
        (image,) = cuts(f"file://{WORK}/paper-5/{name}.html", ("figure >> nth=1 >> svg.figure", 0,) * 2, scale=1.25)
        panels.append(image.crop((image.width // 2 + 10, 10, image.width, image.height - 18)))
    whole = Image.new("RGB", (sum(panel.width for panel in panels), panels[0].height + 44), GROUND)
    for k, (panel, words) in enumerate(zip(panels, ("without touch", "with touch"), strict=True)):
        whole.paste(panel, (k * panels[0].width, 44))
        place = ((k + 0.5) * panels[0].width, 12)
        ImageDraw.Draw(whole).text(place, words, "black", font, anchor="ma")
    save(whole, "bifurcation")


def live_page() -> None:
    """The live page while rows of the demo come, with the camera off from row 60 on."""
    with (DEMO / "log.csv").open() as file:
        rows = [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]
    command = ["stickslip", "live", "my/scene.toml", "--page"]
    with subprocess.Popen(command, cwd=WORK, stdin=-1, stdout=-1, stderr=-1, text=True) as live:
        address = next(found for line in live.stderr if (found := re.search(r"http://\S+", line)))

        def feed() -> None:
            for index, row in enumerate(rows):
                seen = {key: value for key, value in row.items() if index < 60 or not key.startswith("object")}
                live.stdin.write(json.dumps(seen) + "\n")
                live.stdin.flush()
                live.stdout.readline()
                time.sleep(1 / 30)

        source = threading.Thread(target=feed)
        source.start()
        save(*cuts(address.group(0), (".player", 0, ".player", 0), wait=3000), "live-page")
        source.join()
        live.communicate()


PICTURES: dict[str, Callable[[], None]] = {
    "report": report,
    "compare": compare,
    "bag-report": bag_report,
    "fit-report": fit_report,
    "bifurcation": bifurcation,
    "live-page": live_page,
}

if __name__ == "__main__":
    for name in sys.argv[2:] or PICTURES:
        PICTURES[name]()
