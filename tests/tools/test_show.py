"""spool show: EXR images beside each other as one page, without a recording."""
import base64
import json
import os
import re
import zlib

import numpy as np
import OpenImageIO
import pytest

from spool import exr

HOSTILE = "</script><img src=x onerror=alert(1)>\"'&`"


def write(path, image):
    exr.write(path, dict(zip("RGB", np.moveaxis(np.asarray(image, np.float32), 2, 0))))
    return path


@pytest.fixture
def images(tmp_path):
    random = np.random.default_rng(1)
    truth = random.uniform(0.1, 2.0, (30, 40, 3)).astype(np.float32)
    for name in ("before", "after"):
        write(tmp_path / f"{name}.exr", truth * random.uniform(0.5, 1.5, truth.shape))
    return {"before": tmp_path / "before.exr", "after": tmp_path / "after.exr", "reference": write(tmp_path / "reference.exr", truth)}


def data_of(page):
    return json.loads(re.search(r'id="report-data">(.*?)</script>', page, re.S)[1])


def stored(page, place):
    """The values [y][x][c] of a picture of the page."""
    image = data_of(page)["pictures"]["images"][place]
    packed = zlib.decompress(base64.b64decode(re.search(f'id="image-{place}">(.*?)</script>', page, re.S)[1]))
    dtype = {"half": "<f2", "float": "<f4"}[image["kind"]]
    size = np.dtype(dtype).itemsize
    values = np.ascontiguousarray(np.frombuffer(packed, np.uint8).reshape(size, -1).T).view(dtype)
    return np.moveaxis(values.reshape(image["channels"], image["height"], image["width"]), 0, 2).astype(float) * image["scale"]


def numbers_of(page):
    """{image: {column: text}} of the table."""
    head = re.findall(r"<th style[^>]*>(.*?)</th>", page)
    rows = re.findall(r'<tr><th scope="row">(.*?)</th>(.*?)</tr>', page)
    return {name: dict(zip(head[1:], re.findall(r"<td[^>]*>(.*?)</td>", cells))) for name, cells in rows}


def test_a_page_has_the_numbers_of_metrics(good, images, tmp_path):
    said = good("show", images["before"], f"mine={images['after']}", "--reference", images["reference"], "-o", tmp_path / "p.html").out
    assert said.startswith(f"{tmp_path / 'p.html'}: ") and "2 images" in said
    same = good("show", images["before"], images["reference"], "--reference", images["reference"], "-o", tmp_path / "q.html")
    assert same.err.count("is the reference") == 1
    page = (tmp_path / "p.html").read_text(encoding="utf-8")
    numbers = numbers_of(page)
    for name, file in (("before", "before"), ("mine", "after")):
        metrics = good("metrics", images[file], images["reference"], "--json").json["metrics"]
        for column, metric in (("relMSE", "relmse"), ("MSE", "mse"), ("FLIP", "flip_ldr")):
            assert float(numbers[name][column]) == pytest.approx(metrics[metric]["value"], rel=1e-3), (name, metric)
    data = data_of(page)
    assert data["samplers"] == ["before", "mine"] and data["all"] is True and data["shrunk"] == 1
    assert [set(s["images"]) for s in data["pictures"]["sets"]] == [{"estimate", "squared_error", "flip", "reference"}] * 2
    assert "src=" not in page and "http" not in page.replace("http-equiv", "")  # everything is inline


def test_without_a_reference_there_are_no_errors(good, images, tmp_path):
    good("show", images["before"], "-o", tmp_path / "p.html", "--exposure", "-2", "--crop", "1,2,3,4", "--crop", "0,0,40,30")
    page = (tmp_path / "p.html").read_text(encoding="utf-8")
    data = data_of(page)
    assert set(data["pictures"]["sets"][0]["images"]) == {"estimate"} and data["pictures"]["scenes"][0]["exposure"] == -2
    assert data["crops"] == [{"x": 1, "y": 2, "width": 3, "height": 4}, {"x": 0, "y": 0, "width": 40, "height": 30}]
    assert "relMSE" not in numbers_of(page)["before"]


def test_names_are_text_and_told_apart(good, images, tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.exr").write_bytes(images["before"].read_bytes())
    odd = tmp_path / "k=v.exr"
    odd.write_bytes(images["before"].read_bytes())
    good("show", tmp_path / "a/x.exr", tmp_path / "b/x.exr", tmp_path / "b/x.exr", odd, f"{HOSTILE}={images['after']}", "--title", HOSTILE,
         "-o", tmp_path / "p.html")
    page = (tmp_path / "p.html").read_text(encoding="utf-8")
    assert data_of(page)["samplers"] == ["a/x", "b/x", "b/x-2", "k=v", HOSTILE]
    assert "<img src=x" not in page and page.count("</script>") == page.count("<script")


def test_values_that_are_not_finite_are_told_and_hide_no_others(good, tmp_path):
    image = np.full((8, 8, 3), 0.5, np.float32)
    image[1, 1], image[2, 2, 0], image[3, 3] = np.nan, np.inf, 1e30
    write(tmp_path / "a.exr", image)
    write(tmp_path / "nothing.exr", np.full((8, 8, 3), np.nan))
    write(tmp_path / "r.exr", np.full((8, 8, 3), 0.5))
    good("show", tmp_path / "a.exr", tmp_path / "nothing.exr", "--reference", tmp_path / "r.exr", "-o", tmp_path / "p.html")
    page = (tmp_path / "p.html").read_text(encoding="utf-8")
    assert "Pixels that are not finite: 66; magenta." in page
    numbers = numbers_of(page)
    assert numbers["a"]["relMSE"] == "not known" and numbers["a"]["pixels not finite"] == "2"
    assert numbers["nothing"]["mean luminance"] == "not known" and numbers["reference"]["mean luminance"] == "0.5"
    # A half that holds 1e30 holds no 0.5.
    assert stored(page, 0)[3, 3, 0] == np.float32(1e30) and (stored(page, 0)[4:] == 0.5).all() and np.isnan(stored(page, 0)[1, 1]).all()
    good("show", tmp_path / "a.exr", "--reference", tmp_path / "nothing.exr", "-o", tmp_path / "q.html")
    assert "nothing is judged there" in (tmp_path / "q.html").read_text(encoding="utf-8")


def test_a_page_is_bounded_and_says_so(good, tmp_path):
    image = np.random.default_rng(2).uniform(0, 1, (601, 900, 3)).astype(np.float32)
    write(tmp_path / "a.exr", image)
    good("show", tmp_path / "a.exr", "--reference", tmp_path / "a.exr", "--max-image-mb", "1", "--crop", "450,300,90,60", "-o",
         tmp_path / "p.html")
    page = (tmp_path / "p.html").read_text(encoding="utf-8")
    data = data_of(page)
    shrunk, scene = data["shrunk"], data["pictures"]["scenes"][0]
    assert shrunk > 1 and len(page) < 1.2e6
    assert f"Shrunk by {shrunk}: a pixel here is the mean of {shrunk} x {shrunk} of 900 x 601 pixels" in page
    assert (scene["width"], scene["height"]) == (-(-900 // shrunk), -(-601 // shrunk))
    assert data["crops"][0]["x"] == 450 // shrunk
    small = stored(page, 0)
    for y, x in ((0, 0), (7, 11), (scene["height"] - 1, scene["width"] - 1)):  # at the edges of fewer pixels
        block = image[y * shrunk:(y + 1) * shrunk, x * shrunk:(x + 1) * shrunk]
        assert small[y, x] == pytest.approx(block.mean(axis=(0, 1)), rel=1e-3)
    assert float(numbers_of(page)["a"]["MSE"]) == 0.0


def test_one_pixel(good, tmp_path):
    write(tmp_path / "a.exr", np.full((1, 1, 3), 0.25))
    good("show", tmp_path / "a.exr", "--reference", tmp_path / "a.exr", "-o", tmp_path / "p.html")
    assert numbers_of((tmp_path / "p.html").read_text())["a"]["mean luminance"] == "0.25"


def test_wrong_use(run, images, tmp_path):
    a, page = images["before"], tmp_path / "p.html"
    write(tmp_path / "small.exr", np.ones((3, 4, 3)))
    run("show", a, tmp_path / "small.exr", "-o", page).failed_with(2, "small: is 4 x 3 pixels, before is 40 x 30", "crop")
    run("show", a, "--reference", tmp_path / "small.exr", "-o", page).failed_with(2, "the reference: is 4 x 3")
    run("show", a, "-o", tmp_path / "p.exr").failed_with(2, "name it .html")
    run("show", "-o", page).failed_with(2, "IMAGES")
    run("show", tmp_path / "none.exr", "-o", page).failed_with(3, "none.exr")
    for crop in ("1,2,3", "1,2,3,4,5", "1,2,3,x", "1,2,3,99999999999"):
        run("show", a, f"--crop={crop}", "-o", page).failed_with(2, "--crop")
    for crop in ("-1,0,3,3", "38,0,3,3", "0,0,0,3", "0,0,41,1", "2147483647,0,2147483647,1"):
        run("show", a, f"--crop={crop}", "-o", page).failed_with(2, "crop", "40 x 30")
    run("show", *[a] * 65, "-o", page).failed_with(2, "65 images", "64")
    assert not page.exists()


def test_pictures_that_do_not_lie_on_each_other(run, good, tmp_path):
    """Of one size, cut out of a display window of 40 x 30 at two places."""
    image = np.full((10, 20, 3), 0.5, np.float32)
    for name, left in (("a", 0), ("same", 0), ("shifted", 7)):
        buffer = OpenImageIO.ImageBuf(image)
        buffer.set_origin(left, 0)
        buffer.set_full(0, 40, 0, 30, 0, 1)
        assert buffer.write(str(tmp_path / f"{name}.exr")), buffer.geterror()
    good("show", tmp_path / "a.exr", tmp_path / "same.exr", "-o", tmp_path / "p.html")
    for words in (("a.exr", "shifted.exr"), ("a.exr", "--reference", "shifted.exr")):
        run("show", *words, "--force", "-q", "-o", "p.html").failed_with(1, "shifted.exr: shows x 7 to 26", "first image x 0 to 19")


def test_what_exists_stays_without_force(run, good, images, tmp_path):
    page = tmp_path / "p.html"
    page.write_text("mine")
    run("show", images["before"], "-o", page).failed_with(2, "p.html", "--force")
    assert page.read_text() == "mine"
    good("show", images["before"], "--force", "-o", page)
    assert page.read_text().startswith("<!doctype html>")
    run("show", images["before"], "-o", tmp_path / "nowhere" / "p.html").failed_with(3, "nowhere")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["after.exr", "before.exr", "p.html", "reference.exr"]


def test_a_folder_that_cannot_be_written(run, images, tmp_path):
    if os.geteuid() == 0:
        run("show", images["before"], "-o", "/proc/p.html").failed_with(3, "/proc/p.html")
        return
    (tmp_path / "locked").mkdir(mode=0o500)
    run("show", images["before"], "-o", tmp_path / "locked" / "p.html").failed_with(3, "p.html")
