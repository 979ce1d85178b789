import json
import re

import numpy as np
import pytest
from made_results import make_rows, write_images, write_results

from tools.report.assets import ASSETS, load_asset, pinned_hashes
from tools.report.failure import Failure
from tools.report.image_packing import pack_counts, pack_half
from tools.report.page import build_page, json_for_html, script_for_html
from tools.report.report import main
from tools.report.file_names import dump_names, file_name_of
from tools.report import result_images
from tools.report.result_images import find_images, first_results, pack_images

HOSTILE = '</script><script>alert(1)</script>"&\'<img src=x onerror=alert(2)>'


def test_every_asset_is_pinned():
    pinned = pinned_hashes()
    assert set(pinned) == {file for asset in ASSETS for file in (asset.script, asset.licence)}
    assert all(re.fullmatch(r"[0-9a-f]{64}", digest) for digest in pinned.values())


def test_an_altered_asset_is_refused_and_a_missing_one_named(assets_cache):
    load_asset("tablesort.min.js")
    (assets_cache / "tablesort.min.js").write_bytes(b"altered")
    with pytest.raises(Failure, match="sha256 differs"):
        load_asset("tablesort.min.js")
    (assets_cache / "tablesort.min.js").unlink()
    with pytest.raises(Failure, match="fetch_assets.sh"):
        load_asset("tablesort.min.js")


def test_json_and_scripts_cannot_end_their_elements():
    text = json_for_html({"name": HOSTILE + "\u2028"})
    assert "<" not in text and json.loads(text)["name"] == HOSTILE + "\u2028"
    script = script_for_html("a = '</script>'; b = '<!-- x'; /<\\/script/")
    assert "</script" not in script and "<!--" not in script


def test_hostile_names_arrive_as_text(tmp_path, assets_cache):
    rows = make_rows(dumps=(f"x/{HOSTILE}.spool",), samplers=("uniform", HOSTILE), budgets=(8,))
    for row in rows:
        row["guards"] = f"<b>{HOSTILE.replace(' ', '_')}</b>=3"
        row["error"] = HOSTILE if row["replicate"] == "1" else ""
    write_results(tmp_path / "r", rows)
    (tmp_path / "r" / "manifest.json").write_text(json.dumps({"command": HOSTILE, "machine": {"a": HOSTILE}}))
    output = tmp_path / "out.html"
    assert main([str(tmp_path / "r"), "-o", str(output), "--title", HOSTILE]) == 0
    html = output.read_text()
    assert "<script>alert" not in html and "<img" not in html and "<b>" not in html.split("<main>")[0]
    # Every script element is one of ours: two bundles, the page's own, the figures.
    assert len(re.findall(r"<script", html)) == len(ASSETS) + 2
    assert len(re.findall(r"</script", html)) == len(ASSETS) + 2


def test_marks_of_direction_in_names_are_shown_and_turn_no_number_around(tmp_path, assets_cache):
    name, shown = "a\u202eb\u2066c\x9b\u2028\ufeff", "a\\u202eb\\u2066c\\u009b\\u2028\\ufeff"
    rows = make_rows(dumps=(f"x/{name}.spool",), samplers=("uniform", name), budgets=(8,))
    rows[0]["error"] = name
    write_results(tmp_path / "r", rows)
    (tmp_path / "r" / "manifest.json").write_text(json.dumps({"command": name}))
    for title in ([], ["--title", name]):
        assert main([str(tmp_path / "r"), "-o", str(tmp_path / "out.html"), "--force", *title]) == 0
        html = (tmp_path / "out.html").read_text()
        own = html.split("<script>")[0]
        assert not set(name) - {"a", "b", "c"} & set(own) and f"{shown}</h1>" in own and f"<title>{shown}" in own.replace("Spool report: ", "")
        data = json.loads(re.search(r'id="report-data">(.*?)</script>', html)[1])
        assert data["dumps"] == [shown] and data["samplers"] == ["uniform", shown]


def test_one_result_is_no_plural(tmp_path, assets_cache, capsys):
    write_results(tmp_path / "r", make_rows(dumps=("a.spool",), samplers=("uniform",), filters=("box",), budgets=(8,), replicates=1))
    assert main([str(tmp_path / "r"), "-o", str(tmp_path / "out.html")]) == 0
    assert ", 1 result, 0 images (" in capsys.readouterr().out


def test_claims_name_a_group_as_every_other_part_of_the_page_does(tmp_path, assets_cache):
    write_results(tmp_path / "r", make_rows(dumps=("day1.spool",), budgets=(8,)))
    data = json.loads((tmp_path / "r" / "statistics.json").read_text())
    data["scenes"][0]["group"] = "my group"
    data["claims"] = [{"text": "less", "better": "a", "than": "b", "metric": "relmse", "samples": "own", "below": 1, "verdict": "holds",
                       "counts": {"holds": 1}, "places": [{"dump": "day1.spool", "spp": 8, "verdict": "holds", "ratio": [0.5]}]}]
    (tmp_path / "r" / "statistics.json").write_text(json.dumps(data))
    assert main([str(tmp_path / "r"), "-o", str(tmp_path / "out.html")]) == 0
    claim = (tmp_path / "out.html").read_text().split('<details class="claim')[1].split("</details>")[0]
    assert '<th scope="row">my group</th>' in claim and "day1" not in claim


def test_where_every_result_failed_the_page_says_that_and_nothing_else(tmp_path, assets_cache):
    rows = make_rows(dumps=("a.spool",), samplers=("uniform",), filters=("box",), budgets=(8,), replicates=2)
    for row in rows:
        row.update({name: "" for name in list(row)[6:]}, error="not enough samples")
    write_results(tmp_path / "r", rows)
    assert main([str(tmp_path / "r"), "-o", str(tmp_path / "out.html")]) == 0
    text = (tmp_path / "out.html").read_text()
    assert "2 results failed" in text and "not ranked by" not in text and "or results that failed" in text


def test_a_page_says_what_it_lacks_without_scripts(assets_cache):
    report, shown = (build_page("t", [("a", heading, "")], {}, []) for heading in ("A", ""))
    assert "Charts, table and images need JavaScript; the summary" in report
    assert "Images need JavaScript." in shown and "Charts" not in shown.split("<main>")[0].split("<noscript>")[1]


def test_the_policy_allows_the_pages_own_scripts_only(assets_cache):
    html = build_page("t", [("a", "A", "<p>x</p>")], {}, [])
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', html).group(1)
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe-inline" not in policy.split("style-src")[0] and "http" not in policy
    assert policy.count("sha256-") == len(ASSETS) + 1


def test_errors_are_one_line_with_the_exit_codes_of_the_program(tmp_path, capsys, assets_cache):
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 3
    assert capsys.readouterr().err.count("\n") == 1
    write_results(tmp_path, make_rows())
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html"), "--metric", "beauty"]) == 2
    assert "no beauty" in capsys.readouterr().err
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 2
    assert "--force" in capsys.readouterr().err
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html"), "--force"]) == 0
    assert [p.name for p in tmp_path.iterdir() if "partial" in p.name] == []


def test_ten_thousand_results_make_a_small_page(tmp_path, assets_cache):
    rows = make_rows(dumps=[f"s{i}.spool" for i in range(10)], samplers=list("abcde"), filters=list("vwxyz"),
                     budgets=(2, 4, 8, 16, 32, 64, 96, 128))
    assert len(rows) == 10000
    write_results(tmp_path, rows)
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    assert (tmp_path / "a.html").stat().st_size < 5e6


def unpacked(packed):
    """What image_codec.js does."""
    import base64
    import zlib
    data = np.frombuffer(zlib.decompress(base64.b64decode(packed.text)), np.uint8).reshape(2, -1).T
    kind = "<f2" if packed.kind == "half" else "<u2"
    values = np.ascontiguousarray(data).view(kind).astype(np.float64) * packed.scale
    return np.moveaxis(values.reshape(packed.channels, packed.height, packed.width), 0, 2)


@pytest.mark.parametrize("magnitude", [1e-30, 1e-9, 1.0, 3e4, 1e9, 1e30])
@pytest.mark.parametrize("stretch", [False, True])
def test_packed_images_keep_eleven_bits_at_any_brightness(magnitude, stretch):
    image = (magnitude * np.random.default_rng(5).uniform(0.1, 1.0, (6, 5, 3))).astype("f4")
    image[1, 1] = np.nan
    np.testing.assert_allclose(unpacked(pack_half(image, stretch)), image, rtol=2.0 ** -10)


def test_counts_are_exact():
    counts = np.array([[0, 1, 2049], [4097, 65535, 3]], "f4")
    assert unpacked(pack_counts(counts))[..., 0].tolist() == counts.tolist()


def made_sets(tmp_path, size):
    from tools.report.aggregate import aggregate
    from tools.report.results_table import read_results
    from tools.report.statistics_file import read_statistics
    rows = make_rows(samplers=("uniform",), budgets=(4, 8), size=size)
    write_results(tmp_path, rows)
    write_images(tmp_path, rows, dump_names(dict.fromkeys(r["dump"] for r in rows)), file_name_of)
    return find_images(tmp_path, aggregate(read_results(tmp_path / "results.csv"), read_statistics(tmp_path)), [])


@pytest.mark.parametrize("megabytes", [10.0, 2.0, 0.2, 0.0])
def test_images_keep_to_their_budget_by_crops_then_by_links(tmp_path, megabytes):
    images = pack_images(made_sets(tmp_path, (200, 150)), tmp_path, megabytes)
    assert images.bytes == sum(p.size for p in images.packed) <= megabytes * 1e6
    assert len(images.sets) == 12 and all("estimate" in s.links for s in images.sets)
    assert bool(images.crops) == (megabytes < 5.0)
    assert (images.left_out > 0) == (megabytes < 0.5)
    for crop in images.crops.values():
        assert 96 <= crop.width <= 200 and crop.x + crop.width <= 200 and crop.y + crop.height <= 150


def test_of_many_results_the_first_methods_and_the_baseline_have_pictures(tmp_path, monkeypatch):
    from tools.report.aggregate import aggregate
    from tools.report.results_table import read_results
    from tools.report.statistics_file import read_statistics
    found = made_sets(tmp_path, (40, 30))
    statistics = read_statistics(tmp_path)
    combinations = aggregate(read_results(tmp_path / "results.csv"), statistics)
    assert first_results(found, combinations, statistics, "relmse") == found
    monkeypatch.setattr(result_images, "SMALL_BYTES", 1.0)
    monkeypatch.setattr(result_images, "FIRST_METHODS", 1)
    first = [combinations[entry.combination] for entry in first_results(found, combinations, statistics, "relmse")]
    best = {(c["dump"], c["spp"]): f"{c['ranking'][0]['sampler']} + {c['ranking'][0]['filter']}" for c in statistics.of_metric("relmse")}
    assert len(first) == 8 and {c.method for c in first} == {"uniform + box", *best.values()}
    assert all(c.method in ("uniform + box", best[c.dump, c.spp]) for c in first)


def test_the_reference_is_stored_once_per_recording(tmp_path):
    images = pack_images(made_sets(tmp_path, (40, 30)), tmp_path, 10.0)
    assert len({s.images["reference"] for s in images.sets}) == 2


def test_names_of_files_are_those_of_the_program():
    assert file_name_of("multiscale:paper{alpha=0.3}") == "multiscale_paper_alpha_0.3"
    assert file_name_of("gr\u00fcn 1") == "gr__n_1"
    assert dump_names(["a/chess.spool", "b/chess.spool", "b/x y.spool"]) == {
        "a/chess.spool": "chess", "b/chess.spool": "chess-2", "b/x y.spool": "x_y"}


def test_images_are_those_of_their_recording_where_a_group_has_names_alike(tmp_path):
    from tools.report.aggregate import aggregate
    from tools.report.results_table import read_results
    from tools.report.statistics_file import read_statistics
    rows = make_rows(samplers=("uniform",), budgets=(4,), size=(8, 6))
    write_results(tmp_path, rows)
    first, last = dict.fromkeys(row["dump"] for row in rows)
    alike = first.rpartition("/")[2].replace(".", "_.")  # another name, the same folder
    names = dump_names([alike, first, last])
    write_images(tmp_path, rows, names, file_name_of)
    moved = [f"elsewhere/{path.rpartition('/')[2]}" for path in (alike, first, last)]
    found = find_images(tmp_path, aggregate(read_results(tmp_path / "results.csv"), read_statistics(tmp_path)), moved)
    assert names[first].endswith("-2")
    assert {entry.dump for entry in found} == {first, last}
    assert all(entry.paths["estimate"].parent.name.startswith(names[entry.dump] + "_uniform") for entry in found)


def test_recordings_and_groups_are_called_as_they_are():
    from tools.report.statistics_file import Statistics
    scenes = [{"dump": "a/\u4e2d\u6587 <b>.spool", "group": "", "recordings": ["a/\u4e2d\u6587 <b>.spool"]},
              {"dump": "b/x.spool", "group": "my group", "recordings": ["b/x.spool", "b/y.spool"]}]
    found = Statistics({"scenes": scenes, "results": [], "conditions": [], "curves": [], "overall": []})
    assert found.labels() == {"a/\u4e2d\u6587 <b>.spool": "\u4e2d\u6587 <b>", "b/x.spool": "my group"}
    assert found.recordings() == ["a/\u4e2d\u6587 <b>.spool", "b/x.spool", "b/y.spool"]


def test_re_implementations_are_marked_beside_every_name(tmp_path, assets_cache):
    write_results(tmp_path, make_rows(samplers=("uniform", "mitchell", "mitchell{rounds=4}", "mitchells_own"), budgets=(8,)))
    manifest = {"plan": {"samplers": [{"name": "mitchell", "label": "mitchell", "by_description": True},
                                      {"name": "mitchells_own"}], "filters": [{"name": "box", "by_description": False}]}}
    (tmp_path / "manifest.json").write_text(json.dumps(manifest))
    page = tmp_path / "report.html"
    assert main([str(tmp_path), "-o", str(page)]) == 0
    text = page.read_text()
    assert '"mitchell [R]"' in text and '"mitchell{rounds=4} [R]"' in text and '"uniform"' in text
    assert "mitchells_own [R]" not in text and "box [R]" not in text
    assert '<th scope="row">mitchell [R] + box</th>' in text
    assert "[R] mitchell: re-implementation by description" in text
