"""The page of `spool show`: images beside each other, by the report's viewer.

usage: run.py show_page    reads what the program made of the images (tools/show/shown_images.h) from stdin, prints the page
"""

import json
import struct
import sys
from html import escape

import numpy as np

from tools.report.failure import guarded
from tools.report.image_packing import pack_counts, pack_half
from tools.report.number_text import number_text
from tools.report.page import build_page

COLOUR = ("estimate", "reference")
COLUMNS = (("relmse", "relMSE"), ("mse", "MSE"), ("flip_ldr", "FLIP"), ("luminance", "mean luminance"), ("smallest", "smallest value"),
           ("largest", "largest value"), ("not_finite", "pixels not finite"))


def main():
    return guarded(lambda: page(sys.stdin.buffer.read()))


def page(told):
    said, planes = unpack(told)
    packed = [_packed(name, plane, said["shrunk"]) for name, plane in planes.items()]
    data = page_data(said, list(planes), packed)
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in notes_of(said))
    sections = [("images", "", notes + '<div id="image-area"></div>'), ("numbers", "", numbers_html(said))]
    return build_page(said["title"], sections, data, packed, viewer_only=True)


def unpack(told):
    """What is said of the planes, and {name: [y][x] or [y][x][c]}."""
    length, = struct.unpack_from("<I", told)
    said = json.loads(told[4:4 + length])
    planes, at = {}, 4 + length
    for plane in said["planes"]:
        shape = (said["height"], said["width"], plane["channels"])
        values = np.frombuffer(told, "<f4", shape[0] * shape[1] * shape[2], at).reshape(shape)
        planes[plane["name"]] = values if plane["channels"] == 3 else values[..., 0]
        at += values.nbytes
    return said, planes


def _packed(name, plane, shrunk):
    layer = name.split()[-1]
    if layer == "density" and shrunk == 1:
        return pack_counts(plane)
    return pack_half(plane, stretch=layer == "squared_error")


def page_data(said, names, packed):
    """As report_data.py makes it, of images that no evaluation made."""
    images = said["images"]
    samplers = list(dict.fromkeys(image["name"] for image in images))
    filters = list(dict.fromkeys(image["filter"] for image in images if image["filter"]))
    combinations, sets = [], []
    for place, image in enumerate(images):
        stored = {name.split()[1]: i for i, name in enumerate(names) if name.split()[0] == str(place)}
        if "reference" in names:
            stored["reference"] = names.index("reference")
        sets.append({"combination": place, "images": stored, "links": {}, "said": _said(image["statistics"])})
        combinations.append({"dump": 0, "sampler": samplers.index(image["name"]),
                             "filter": filters.index(image["filter"]) if image["filter"] else -1, "spp": image["spp"],
                             "replicates": 1, "failed": 0, "values": [], "ranks": {}, "loses": 0})
    scene = {"dump": 0, "exposure": said["exposure"], "mean": said["mean"], "width": said["width"], "height": said["height"],
             "crop": None}
    crops = [dict(zip(("x", "y", "width", "height"), crop)) for crop in said["crops"]]
    last = images[-1]
    return {"dumps": [said["title"]], "samplers": samplers, "filters": filters, "metric": "relmse", "metrics": [], "quantities": [],
            "combinations": combinations, "overall": [], "budget": None, "baseline": "uniform + box", "own": [], "conditions": [], "pixels": [], "all": not filters,
            "first": f"{last['name']} + {last['filter']}", "crops": crops or None, "shrunk": said["shrunk"],
            "pictures": {"scenes": [scene], "sets": sets,
                         "images": [p.header() for p in packed]}}


def _said(statistics):
    relmse = statistics.get("relmse")
    return "" if relmse is None else f": relMSE {number_text(relmse)}"


def notes_of(said):
    width, height = said["whole"]
    if said["shrunk"] > 1:
        yield (f"Shrunk by {said['shrunk']}: a pixel here is the mean of {said['shrunk']} x {said['shrunk']} of {width} x {height} "
               "pixels. Numbers and maps were made before.")
    bad = sum(image["statistics"]["not_finite"] for image in said["images"])
    if bad:
        yield f"Pixels that are not finite: {bad}; magenta. Errors of such an image are not known."
    if said["reference"] and said["reference"]["not_finite"]:
        yield f"The reference has {said['reference']['not_finite']} pixels that are not finite: nothing is judged there."


def numbers_html(said):
    images = [(" + ".join(filter(None, (image["name"], image["filter"]))), image["spp"], image["statistics"])
              for image in said["images"]]
    if said["reference"]:
        images.append(("reference", 0, said["reference"]))
    columns = [(key, name) for key, name in COLUMNS if any(key in statistics for _, _, statistics in images)]
    spp = any(budget for _, budget, _ in images)

    def cell(statistics, key):
        value = statistics.get(key)
        return "" if key not in statistics else "not known" if value is None else number_text(value)

    head = "".join(f'<th style="text-align: {"left" if i == 0 else "right"}">{name}</th>' for i, name in enumerate(["image", *(["spp"] if spp else []), *(name for _, name in columns)]))
    rows = "".join(
        f"<tr><th scope=\"row\">{escape(name)}</th>" + (f'<td class="number">{number_text(budget) if budget else ""}</td>' if spp else "")
        + "".join(f'<td class="number">{cell(statistics, key)}</td>' for key, _ in columns) + "</tr>"
        for name, budget, statistics in images)
    table = f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'
    return f"<details{'' if len(images) > 12 else ' open'}><summary>Numbers</summary>{table}</details>"
