"""What a notebook shows: cells of recordings, selections, images and results; spool.show and spool.view."""
import base64
import contextlib
import json
import os
import pickle
import re
import struct

import numpy as np
import pytest

import spool
from spool.cells import results_html

HOSTILE = "</script><img src=x onerror=alert(1)>\"'&`"


def facts(page):
    return json.loads(re.search(r'id="report-data">(.*?)</script>', page.html, re.S)[1])


def table(page):
    """{row: [texts]} of the numbers below the viewer."""
    rows = re.findall(r'<tr><th scope="row">(.*?)</th>(.*?)</tr>', page.html)
    return {name: re.findall(r"<td[^>]*>(.*?)</td>", cells) for name, cells in rows}


def size_of_png(html):
    png = base64.b64decode(re.search(r"data:image/png;base64,([^\"]+)", html)[1])
    assert png.startswith(b"\x89PNG")
    return int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")


@contextlib.contextmanager
def raises(kind, *words):
    with pytest.raises(spool.SpoolError, match=".*".join(map(re.escape, words))) as caught:
        yield
    assert caught.value.code == {"usage": spool.USAGE, "io": spool.IO, "data": spool.DATA}[kind]


@pytest.fixture
def truth(dump):
    return dump.pixel("reference").astype(float)


@pytest.fixture
def image(dump):
    return spool.reconstruct(dump, spool.replay(dump, "uniform", 4), "box")


def test_an_image_is_an_array_that_shows_itself(image, truth):
    assert isinstance(image, spool.Image) and isinstance(image, np.ndarray)
    assert type(image.mean()) is np.float64 and type(image.sum(axis=2)) is np.ndarray and type(2 * image) is spool.Image
    assert np.array_equal(pickle.loads(pickle.dumps(image)), image)
    html = image._repr_html_()
    assert size_of_png(html) == (24, 20) and "24 x 20 pixels" in html and "<script" not in html
    luminance = float((image @ (0.2126, 0.7152, 0.0722)).mean())
    assert f"mean luminance {luminance:.4g}, values {image.min():.4g} to {image.max():.4g}" in html
    assert image[0]._repr_html_() is None and (image > 1)._repr_html_() is None  # shown as arrays
    bad = image.copy()
    bad[0, 0, 0] = np.nan
    assert "1 pixels not finite" in bad._repr_html_()
    assert "not finite" in (bad * np.nan)._repr_html_()


def test_a_large_image_is_shrunk_and_says_so():
    html = np.ones((3000, 1100, 3)).view(spool.Image)._repr_html_()
    assert size_of_png(html) == (184, 500) and "shrunk by 6 here" in html and len(html) < 100_000


def test_a_recording_says_what_it_is_and_what_is_verified(dump, path, layers, program):
    html = dump._repr_html_()
    assert size_of_png(html) == (24, 20) and "24 x 20 pixels" in html and "no: dumps/verify/verify.py" in html
    chess = os.path.join(os.environ["SPOOL_FORMAT_MODULES"], "..", "..", "dumps", "tiny", "chess.spool")
    with spool.open(chess) as verified:
        html = verified._repr_html_()
        assert "16 claims hold, 2 not known" in html and html.count("<li>") == 18
    held = spool.recording(layers["radiance"], name=HOSTILE.replace("/", ""))._repr_html_()
    assert "samples in memory" in held and "<img src=x" not in held and "mean of the samples" in held


def test_a_selection_shows_its_density(dump):
    selection = spool.replay(dump, "multiscale", 4)
    html = selection._repr_html_()
    assert size_of_png(html)[0] >= 300 and f"{selection.log['spent']} of a budget of" in html
    assert f"{selection.counts.min()} to {selection.counts.max()}" in html
    whole = spool.reconstruct(dump, selection, "directional", whole=True)._repr_html_()
    assert "level, dominant_direction" in whole and "data:image/png" in whole


def test_a_ratio_reads_one_only_where_it_is_one():
    entry = {"sampler": "multiscale", "filter": "box", "value": [0.1, 0.09, 0.11], "ratio": [1.00041, 1.00021, 1.00061], "letters": "b",
             "against_baseline": "worse"}
    shown = results_html([], {"conditions": [{"metric": "relmse", "dump": "a", "spp": 8, "ranking": [entry]}], "results": []})
    assert "1.0004 [1.0002, 1.001]" in shown and "0.1 [0.09, 0.11]" in shown


def test_results_show_claims_and_intervals_of_their_statistics(dump, tmp_path):
    claim = {"text": "<b>adaptive</b> wins", "better": "multiscale + box", "than": "uniform + box"}
    results = spool.evaluate({"recordings": [dump], "samplers": ["uniform", "multiscale"], "filters": ["box"], "spp": [2, 4],
                              "replicates": 3, "claim": [claim]}, output=tmp_path / "r")
    html = results._repr_html_()
    said, = results.statistics["claims"]
    assert html.index(said["verdict"]) < html.index("<table") and "&lt;b&gt;adaptive&lt;/b&gt; wins" in html
    for condition in results.statistics["conditions"]:
        if condition["metric"] == "relmse":
            for entry in condition["ranking"]:
                mean, low, high = entry["value"]
                assert f"{mean:.4g} [{low:.4g}, {high:.4g}]" in html
    verdicts = [entry.get("against_baseline") for condition in results.statistics["conditions"] if condition["metric"] == "relmse"
                for entry in condition["ranking"]]
    assert html.count("rgba(38, 128, 214, .28)") >= 2 * verdicts.count("better")
    one = spool.evaluate({"recordings": [dump], "samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 1})
    assert "uniform + box" in one._repr_html_()


def test_show_has_the_metrics_of_the_program(image, truth, dump):
    page = spool.show({"mine": image, "same": truth}, reference=dump)
    judged = spool.metrics(image, truth)
    for text, metric in zip(table(page)["mine"], ("relmse", "mse", "flip_ldr")):
        assert float(text) == pytest.approx(judged[metric], rel=1e-3)
    assert [float(text) for text in table(page)["same"][:3]] == [0, 0, 0]
    assert facts(page)["samplers"] == ["mine", "same"] and "2 images" in repr(page)
    html = page._repr_html_()
    assert html.startswith('<iframe sandbox="allow-scripts"') and "<script" not in html  # a document of its own


def test_show_takes_what_there_is(dump, image, truth, tmp_path, layers):
    from spool import exr
    exr.write(tmp_path / "file.exr", dict(zip("RGB", np.moveaxis(np.asarray(image, "f4"), 2, 0))))
    selection = spool.replay(dump, "uniform", 4)
    held = spool.recording(layers["radiance"], reference=layers["reference"])
    page = spool.show([tmp_path / "file.exr", selection, spool.reconstruct(dump, selection, "box", whole=True), dump, held,
                       image[..., 0], image.astype("f2"), tmp_path / "file.exr"], reference=held)
    assert facts(page)["samplers"] == ["file", "image 2", "image 3", "image 4", "image 5", "image 6", "image 7", "file (8)"]
    assert table(page)["image 2"] == table(page)["image 3"]
    assert facts(spool.show(image))["samplers"] == ["image 1"]
    assert facts(spool.show({HOSTILE: image, "\ud800": image, 3: image}))["samplers"] == [HOSTILE, "\\ud800", "3"]


def test_no_image_is_lost_to_another_of_its_name(image, tmp_path):
    from spool import exr
    assert facts(spool.show({1: image, "1": image}))["samplers"] == ["1", "1 (2)"]
    for folder in ("x", "y"):
        (tmp_path / folder).mkdir()
    files = [tmp_path / name for name in ("a (3).exr", "x/a.exr", "y/a.exr")]
    for file in files:
        exr.write(file, dict(zip("RGB", np.moveaxis(np.asarray(image, "f4"), 2, 0))))
    assert facts(spool.show(files))["samplers"] == ["a (3)", "a", "a (3) (3)"]


def test_what_a_file_has_besides_is_a_warning(image, tmp_path, recwarn):
    from spool import exr
    planes = dict(zip("RGB", np.moveaxis(np.asarray(image, "f4"), 2, 0)))
    exr.write(tmp_path / "plain.exr", planes)
    exr.write(tmp_path / "more.exr", {**planes, "albedo.R": planes["R"], "albedo.G": planes["R"], "albedo.B": planes["R"]})
    spool.show(tmp_path / "plain.exr")
    assert not recwarn
    for of in ({"images": tmp_path / "more.exr"}, {"images": image, "reference": tmp_path / "more.exr"}):
        with pytest.warns(UserWarning, match=r"more\.exr: .*albedo") as caught:
            spool.show(**of)
        assert [warning.filename for warning in caught] == [__file__]


def test_files_whose_pixels_lie_elsewhere_are_refused(image, tmp_path):
    from spool import exr
    files = []
    for left in (0, 7):
        files.append(tmp_path / f"from_{left}.exr")
        exr.write(files[-1], dict(zip("RGB", np.moveaxis(np.asarray(image, "f4"), 2, 0))))
        data = bytearray(files[-1].read_bytes())
        for name, window in ((b"dataWindow", (left, 0, left + 23, 19)), (b"displayWindow", (0, 0, 39, 29))):
            struct.pack_into("<4i", data, data.index(name + b"\0box2i\0") + len(name) + 7 + 4, *window)
        files[-1].write_bytes(data)
    spool.show([files[0], files[0], image])
    for of in ({"images": files}, {"images": files[0], "reference": files[1]}):
        with raises("data", "from_7.exr: shows x 7 to 30"):
            spool.show(**of)


def test_wrong_use(image, truth, tmp_path, layers):
    show = spool.show
    with raises("usage", "at least one"):
        show({})
    with raises("usage", "b: is 23 x 20 pixels, a is 24 x 20"):
        show({"a": image, "b": image[:, 1:]})
    with raises("usage", "the reference: is 1 x 20"):
        show(image, reference=truth[:, :1])
    for wrong in (image.astype(np.uint8), image > 1, image.astype(complex), image.astype(object), b"x", None,
                  image[0, 0], image[None], np.zeros((0, 3, 3)), np.ma.masked_array(image), [[1.0], [1.0, 2.0]], np.zeros(3, "f4,f4")):
        with pytest.raises(spool.SpoolError, match="^a: "):
            show({"a": wrong})
    with raises("io", "none.exr"):
        show(tmp_path / "none.exr")
    with raises("usage", "has none"):
        show(image, reference=spool.recording(layers["radiance"]))
    for crops in ([(1, 2, 3)], [(0, 0, 2.5, 2)], [3], ["abcd"], [(0, 0, 25, 1)], [(-1, 0, 1, 1)], [(0, 0, 2**40, 1)], [(0, 0, 0, 0)]):
        with raises("usage", "crop"):
            show(image, crops=crops)
    for megabytes in (0, -1, float("nan")):
        with raises("usage", "megabytes"):
            show(image, max_mb=megabytes)
    for exposure in (float("nan"), float("inf"), 1000):
        with raises("usage", "exposure"):
            show(image, exposure=exposure)
    with raises("usage", "at most 64"):
        show([image] * 65)


def test_odd_values(image, truth):
    bad = image.copy()
    bad[0, 0], bad[1, 1], bad[2, 2] = np.nan, np.inf, 1e300
    page = spool.show({"bad": bad, "nothing": image * np.nan, "negative": -image}, reference=truth)
    assert table(page)["bad"][0] == "not known" and table(page)["negative"][0] != "not known"
    assert "Pixels that are not finite: 482; magenta" in page.html
    assert table(spool.show(np.full((1, 1, 3), 0.5), reference=np.full((1, 1, 3), 0.5)))["image 1"][1] == "0"


def test_the_size_of_a_cell_is_bounded():
    large = np.random.default_rng(1).random((4096, 4096, 3), "f4")
    page = spool.show({"a": large}, max_mb=2)
    assert len(page.html) < 2.2e6 and "of 4096 x 4096 pixels" in page.html
    small = large[:700, :500]
    page = spool.show({"a": small}, reference=small, max_mb=1)
    assert len(page.html) < 1.2e6 and "of 500 x 700 pixels. Numbers and maps were made before." in page.html


def test_save_keeps_what_exists(image, tmp_path):
    page = spool.show(image)
    page.save(tmp_path / "p.html")
    assert (tmp_path / "p.html").read_text(encoding="utf-8") == page.html
    with raises("usage", "p.html"):
        page.save(tmp_path / "p.html")
    page.save(tmp_path / "p.html", force=True)
    with raises("io", "nowhere"):
        page.save(tmp_path / "nowhere" / "p.html")
    assert [path.name for path in tmp_path.glob("p*")] == ["p.html"]


def test_view_has_methods_of_ones_own_at_every_budget(dump, truth):
    @spool.filter
    def darker(statistics, share=0.5):
        return share * statistics.mean

    @spool.sampler(rounds=2)
    def even(statistics):
        return np.ones_like(statistics.luminance)

    page = spool.view(dump, sampler=even, filter=[darker, "directional"], spp=[2, 4])
    said = facts(page)
    assert said["samplers"] == ["uniform", "even"] and said["filters"] == ["box", "darker", "directional"] and said["all"] is False
    assert len(said["combinations"]) == 2 * 3 * 2 and {c["spp"] for c in said["combinations"]} == {2, 4}
    assert {"estimate", "squared_error", "flip", "density", "filter_size", "direction"} <= set(said["pictures"]["sets"][-1]["images"])
    numbers = re.findall(r'<th scope="row">uniform \+ darker</th>(.*?)</tr>', page.html)
    shown = [float(re.findall(r"<td[^>]*>(.*?)</td>", cells)[1]) for cells in numbers]
    made = [spool.metrics(spool.reconstruct(dump, spool.replay(dump, "uniform", spp), darker), truth)["relmse"] for spp in (2, 4)]
    assert shown == pytest.approx(made, rel=1e-3)
    assert len(facts(spool.view(dump))["combinations"]) == 3  # 1, 2 and 4 samples
    with raises("usage", "no budget"):
        spool.view(dump, spp=[])
    with raises("usage", "nonsense"):
        spool.view(dump, filter="nonsense")
