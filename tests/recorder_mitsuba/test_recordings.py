"""Several recordings in one go, what is said at the end, and files of 16 bits."""
import os

import numpy as np
import pytest

import spool
from conftest import check_ok, record

pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")

OPTIONS = ["cornell-box", "--size", 16, "--samples", 32, "--reference", 64, "--channels", "radiance,film", "--chunk-lanes", 1 << 10]
SCENE = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><float name="fov" value="40"/><float name="far_clip" value="1e7"/>
<transform name="to_world"><lookat origin="0,0,-4" target="0,0,0" up="0,1,0"/></transform></sensor><shape type="sphere"/>%s</scene>"""
LAMP = '<emitter type="point"><point name="position" x="0" y="0" z="-4"/></emitter>'
FAR = """<emitter type="constant"/><shape type="rectangle"><transform name="to_world"><scale value="1e5"/><rotate y="1" angle="180"/>
<translate z="1e5"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.2,0.4,0.8"/></bsdf></shape>"""


def files_of(folder, stem="a"):
    return [folder / ("%s_%d.spool" % (stem, number)) for number in range(1, 5)]


@pytest.fixture(scope="module")
def four(tmp_path_factory):
    folder = tmp_path_factory.mktemp("four")
    told = check_ok(record(*OPTIONS, "--recordings", 4, "-o", folder / "a.spool")).stdout
    return folder, told


def test_recordings_share_the_reference_and_no_sample(four):
    folder, told = four
    assert sorted(folder.iterdir()) == files_of(folder)
    film, references, groups = [], set(), []
    for path in files_of(folder):
        assert spool.check(path).ok
        with spool.open(path) as dump:
            assert dump.spp == 8 and dump.meta["verification"]["holds"] is True and dump.meta["reference"]["samples"] == 64
            film.append(dump.read("film"))
            references.add(dump.pixel("reference").tobytes() + dump.pixel("reference_variance").tobytes())
            groups.append(dump.meta["group"])
            assert dump.meta["random_numbers"] == {"pool": 32 * 256, "pool_repeated": 0, "reference": 64 * 256, "reference_repeated": 0}
            assert dump.meta["cost_per_sample"] > 0
    assert len(references) == 1 and len({group["id"] for group in groups}) == 1
    assert [(group["recording"], group["of"], group["name"]) for group in groups] == [(n, 4, "a") for n in (1, 2, 3, 4)]
    places = np.concatenate(film, axis=2).reshape(256, 32, 2).view("<u8")
    assert all(len(np.unique(pixel)) == 32 for pixel in places)
    assert told.count(": 16x16, 8 samples a pixel, ") == told.count("claims on the samples hold, 0 fail, ") == 4
    assert told.splitlines()[-1].startswith("next: spool evaluate %s --spp" % " ".join(map(str, files_of(folder))))


def test_a_run_that_was_stopped_while_files_got_their_names_gives_them_all(four, tmp_path):
    out = tmp_path / "a.spool"
    files_of(tmp_path)[1].write_bytes(b"mine")
    refused = record(*OPTIONS, "--recordings", 4, "-o", out)
    assert refused.returncode == 2 and "a_2.spool: exists" in refused.stderr and os.listdir(tmp_path) == ["a_2.spool"]
    folder = tmp_path / "a.spool.recording"
    folder.mkdir()
    (folder / "named").touch()
    check_ok(record(*OPTIONS, "--recordings", 4, "-o", out))
    assert sorted(tmp_path.iterdir()) == files_of(tmp_path)
    for mine, theirs in zip(files_of(tmp_path), files_of(four[0])):
        with spool.open(mine) as one, spool.open(theirs) as two:
            assert (one.read("radiance") == two.read("radiance")).all()


@pytest.mark.parametrize("count, words", [(5, "32 samples do not split into 5 equal parts: give --samples 30"), (0, "outside 1 .. 64")])
def test_a_number_that_does_not_split_is_one_line(tmp_path, count, words):
    refused = record(*OPTIONS, "--recordings", count, "-o", tmp_path / "a.spool")
    assert refused.returncode == 2 and words in refused.stderr and refused.stderr.count("\n") == 1


@pytest.mark.parametrize("rest, kind", [(LAMP, "f2"), (FAR, "f4")])
def test_half_keeps_depth_in_16_bits_where_its_range_allows(tmp_path, rest, kind):
    """A ball in the dark, and one before a wall beyond 65504. Most of the first is black, which is remarked."""
    (tmp_path / "s.xml").write_text(SCENE % rest)
    told = check_ok(record(tmp_path / "s.xml", "--size", 16, "--samples", 8, "--half", "-o", tmp_path / "a.spool")).stdout
    with spool.open(tmp_path / "a.spool") as dump:
        assert dump.layers["depth"].dtype == np.dtype("<" + kind)
        picture = [entry for entry in dump.meta["verification"]["findings"] if entry["name"] == "picture"]
        assert len(picture) == told.count("exactly black in every sample") == (rest == LAMP)
