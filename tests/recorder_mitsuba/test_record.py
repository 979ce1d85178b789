"""Real recordings with Mitsuba at small size. Run with the Python that has mitsuba (tools/dev.sh test does)."""
import os
import resource
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import spool
from conftest import RECORD, ROOT, check_ok, record

pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")

LENS = """<scene version="3.0.0"><integrator type="path"/>
<sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.3"/>
<float name="focus_distance" value="4"/><float name="shutter_close" value="0.5"/>
<transform name="to_world"><lookat origin="0,0,-4" target="0,0,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film></sensor>
<shape type="sphere" id="ball"><bsdf type="diffuse"><rgb name="reflectance" value="0.8,0.4,0.2"/></bsdf></shape>
<emitter type="constant"><rgb name="radiance" value="1,1,1"/></emitter></scene>"""


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    path = tmp_path_factory.mktemp("box") / "box.spool"
    check_ok(record("cornell-box", "-o", path, "--size", 32, "--samples", 24, "--reference", 512,
                    "--channels", "all", "--chunk-lanes", 1 << 13))
    return path


def test_every_layer_is_there_and_the_file_is_sound(box):
    assert spool.check(box).ok
    with spool.open(box) as dump:
        assert {"radiance", "direct", "albedo", "normal", "depth", "position", "film", "shape", "reference",
                "reference_variance"} <= set(dump.layers)
        assert "lens" not in dump.layers and "time" not in dump.layers  # the box needs neither
        assert dump.sample_order == "exchangeable"
        assert dump.meta["cost_per_sample"] > 0
        assert dump.meta["verification"]["holds"] is True
        film = dump.read("film")
        assert film.min() >= 0 and film.max() < 1
        assert 0.27 < film.std() < 0.31  # uniform: 0.2887; the pixel-centre trap: 0
        indirect = dump.read("radiance") - dump.read("direct")
        assert indirect.min() > -1e-5 and indirect.max() > 0
        normal = np.linalg.norm(dump.read("normal").astype(float), axis=-1)
        assert np.abs(normal[normal > 0] - 1).max() < 2e-3
        assert len(np.unique(dump.read("shape"))) > 3


def test_pool_is_what_the_renderer_renders(box):
    """The same seeds through the renderer's own loop give the same image, to float32 summation."""
    import mitsuba as mi
    from dumps.mitsuba.variant import force_good_llvm
    with spool.open(box) as dump:
        if not dump.meta["renderer"]["variant"].startswith("llvm"):
            pytest.skip("the scalar fallback draws other numbers than its renderer")
        force_good_llvm()
        mi.set_variant(dump.meta["renderer"]["variant"])
        from dumps.mitsuba.scene import Wishes, load_scene
        scene = load_scene(mi, "cornell-box", Wishes(size=(32, 32))).scene
        step = dump.meta["seeds"]["chunk_samples"]
        first = dump.read("radiance", 0, 0, 32, 32, 0, step).astype(float).mean(axis=2)
        rendered = np.array(mi.render(scene, spp=step, seed=dump.meta["seeds"]["pool_first"]))
        assert np.abs(first - rendered).max() < 1e-4 * rendered.max()


def test_pool_and_reference_agree_within_their_errors(box):
    with spool.open(box) as dump:
        radiance = dump.read("radiance").astype(float)
        # The reference's own samples say what a pool mean should vary by: 24 samples of a skewed quantity
        # underestimate it exactly where their mean is low.
        single = dump.pixel("reference_variance") * dump.meta["reference"]["samples"]
        variance = single / radiance.shape[2] + dump.pixel("reference_variance")
        difference = radiance.mean(axis=2) - dump.pixel("reference")
        lit = variance > 1e-12
        chi2 = (difference[lit] ** 2 / variance[lit]).mean()
        assert 0.85 < chi2 < 1.15
        z = difference.sum() / np.sqrt(variance.sum())
        assert abs(z) < 4  # two-sided 6e-5


def test_lens_and_time_are_recorded_where_the_scene_has_them(tmp_path):
    scene, out = tmp_path / "lens.xml", tmp_path / "lens.spool"
    scene.write_text(LENS)
    check_ok(record(scene, "-o", out, "--samples", 8, "--reference", 64))
    with spool.open(out) as dump:
        assert (dump.width, dump.height) == (24, 16)
        lens = dump.read("lens").astype(float)
        radius2 = (lens ** 2).sum(axis=-1)
        assert radius2.max() <= 1 + 1e-6 and abs(radius2.mean() - 0.5) < 4 * 0.289 / np.sqrt(radius2.size)  # uniform
        assert abs(lens.mean(axis=(0, 1, 2))).max() < 4 * 0.5 / np.sqrt(radius2.size)
        shutter = dump.read("time")
        assert 0 <= shutter.min() < 0.1 and 0.9 < shutter.max() <= 1
        assert dump.meta["shutter"] == [0, 0.5] and dump.meta["scene"]["name"] == "%s/lens.xml" % tmp_path.name


def test_scenes_of_the_tree_that_mitsuba_is_taught_are_built_from_their_scripts(tmp_path):
    """Camera, meshes, normals and the ruled paper are Blender's: the features agree with a recording of Cycles.
    On glass the two say different things (dumps/tiny/caustic.spool: 0), so the albedo is compared beside it."""
    out = tmp_path / "caustic.spool"
    check_ok(record("caustic", "-o", out, "--size", 64, "--samples", 16, "--channels", "albedo,normal,film,shape"))
    with spool.open(out) as found, spool.open(os.path.join(ROOT, "dumps", "tiny", "caustic.spool")) as cycles:
        glass = [1 + i for i, name in enumerate(found.meta["scene"]["shapes"]) if name.startswith(("ball", "ring"))]
        on_glass = np.isin(found.read("shape")[..., 0], glass)
        assert on_glass.any() and (found.read("albedo")[on_glass] == 1).all()
        beside = ~on_glass.any(axis=2) & (cycles.read("albedo") > 0).all(axis=(2, 3))
        assert beside.mean() > 0.3
        for layer, largest in (("albedo", 0.04), ("normal", 0.01)):
            one, two = found.read(layer).astype(float).mean(axis=2), cycles.read(layer).astype(float).mean(axis=2)
            difference = (one - two)[beside] if layer == "albedo" else (one - two).reshape(-1, 3)
            assert np.abs(difference).mean() < largest, layer  # of noise: 16 positions in a pixel
            assert np.abs(difference.mean(axis=0)).max() < 0.003, layer
    result = record("chess", "-o", tmp_path / "chess.spool")
    assert result.returncode == 2 and "needs more than Mitsuba is taught" in result.stderr


def test_scalar_fallback_agrees_with_the_wavefront(tmp_path):
    out = tmp_path / "scalar.spool"
    check_ok(record("cornell-box", "-o", out, "--size", 12, "--samples", 24, "--variant", "scalar_rgb",
                    "--channels", "all"))
    fast = tmp_path / "fast.spool"
    check_ok(record("cornell-box", "-o", fast, "--size", 12, "--samples", 24, "--reference", 4096, "--channels", "all"))
    with spool.open(out) as a, spool.open(fast) as b:
        for layer in ("albedo", "normal", "depth", "position"):
            one, two = a.read(layer).astype(float).mean(axis=(0, 1, 2)), b.read(layer).astype(float).mean(axis=(0, 1, 2))
            assert np.abs(one - two).max() < 0.05 * max(1, np.abs(two).max()), layer
        radiance = a.read("radiance").astype(float)
        variance = radiance.var(axis=2, ddof=1).sum() / radiance.shape[2] + b.pixel("reference_variance").sum()
        assert abs((radiance.mean(axis=2) - b.pixel("reference")).sum()) < 4 * np.sqrt(variance)


def test_killed_recording_goes_on_and_gives_the_same_bits(tmp_path):
    whole, cut = tmp_path / "whole.spool", tmp_path / "cut.spool"
    options = ["--size", 32, "--samples", 64, "--reference", 256, "--chunk-lanes", 1 << 11]
    check_ok(record("cornell-box", "-o", whole, *options))
    process = subprocess.Popen([sys.executable, RECORD, "cornell-box", "-o", str(cut), *map(str, options)],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    folder = str(cut) + ".recording"
    for _ in range(600):
        if os.path.isdir(folder) and sum(name.startswith("chunk_") for name in os.listdir(folder)) >= 5:
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not cut.exists()
    kept = sorted(name for name in os.listdir(folder) if name.endswith(".npz"))
    assert kept
    changed = record("cornell-box", "-o", cut, *options[:-1], 1 << 12)
    assert changed.returncode == 2 and "chunk_samples differs" in changed.stderr
    check_ok(record("cornell-box", "-o", cut, *options))
    with spool.open(whole) as a, spool.open(cut) as b:
        for layer in ("radiance", "albedo", "film"):
            assert np.array_equal(a.read(layer), b.read(layer)), layer
        assert np.array_equal(a.pixel("reference"), b.pixel("reference"))
    assert not os.path.exists(folder)


def start_and_wait(arguments, out, chunks):
    """A running recorder that has finished this many chunks."""
    process = subprocess.Popen([sys.executable, RECORD, *map(str, arguments), "-o", str(out)], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    folder = str(out) + ".recording"
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        if os.path.isdir(folder) and sum(name.startswith("chunk_") for name in os.listdir(folder)) >= chunks:
            break
        time.sleep(0.01)
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_cancelled_recording_says_how_to_go_on(tmp_path, number):
    options = ["cornell-box", "--size", 32, "--samples", 512, "--chunk-lanes", 1 << 10]
    process = start_and_wait(options, tmp_path / "cut.spool", 2)
    process.send_signal(number)
    told = process.communicate(timeout=120)[1]
    assert process.returncode == 3 and told == "stopped: run the same command again to go on\n"
    assert not (tmp_path / "cut.spool").exists()
    assert 2 <= len(os.listdir(str(tmp_path / "cut.spool.recording"))) < 513


def test_full_disk_is_one_line_and_the_recording_goes_on_after_it(tmp_path):
    """On a real, small file system where we may mount one; else with a limit on the size of a file."""
    small = tmp_path / "small"
    small.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", small], capture_output=True).returncode == 0
    options = ["cornell-box", "-o", small / "box.spool", "--size", 32, "--samples", 12, "--chunk-lanes", 1 << 11]
    limit = None if mounted else lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))
    try:
        result = subprocess.run([sys.executable, RECORD, *map(str, options)], capture_output=True, text=True,
                                preexec_fn=limit)
        assert result.returncode == 3 and len(result.stderr.strip().splitlines()) == 1, result.stderr
        assert ("No space left" if mounted else "File too large") in result.stderr
        assert "make room and run the same command again" in result.stderr
        if mounted:
            subprocess.run(["mount", "-o", "remount,size=8m", small], check=True)
        check_ok(record(*options))
        assert spool.check(small / "box.spool").ok
    finally:
        if mounted:
            subprocess.run(["umount", small], check=True)


def test_frames_larger_than_a_chunk_are_cut_into_bands(tmp_path):
    """A chunk never has more lanes than was asked for, and the picture is the same."""
    out = tmp_path / "bands.spool"
    check_ok(record("cornell-box", "-o", out, "--size", "40x36", "--samples", 20, "--reference", 300, "--chunk-lanes", 500,
                    "--channels", "albedo,film"))
    whole = tmp_path / "whole.spool"
    check_ok(record("cornell-box", "-o", whole, "--size", "40x36", "--samples", 20, "--reference", 300,
                    "--channels", "albedo"))
    with spool.open(out) as bands, spool.open(whole) as one:
        assert bands.meta["seeds"]["chunk_samples"] == 1 and bands.meta["seeds"]["chunk_rows"] == 12
        assert bands.meta["verification"]["holds"] is True
        rows = [d.read("albedo").astype(float).mean(axis=(1, 2)) for d in (bands, one)]
        assert np.abs(rows[0] - rows[1]).max() < 0.02
        difference = (bands.pixel("reference") - one.pixel("reference")).astype(float)
        variance = bands.pixel("reference_variance").astype(float) + one.pixel("reference_variance")
        assert abs(difference.sum()) < 4 * np.sqrt(variance.sum())
        lit = variance > 1e-12
        assert 0.85 < (difference[lit] ** 2 / variance[lit]).mean() < 1.15


def test_dry_run_tells_needs_and_price_and_writes_nothing(tmp_path):
    (tmp_path / "lens.xml").write_text(LENS)
    result = check_ok(record(tmp_path / "lens.xml", "--dry-run", "--samples", 100, "--channels", "radiance,needed"))
    for words in ("needs depth of field: yes, motion blur: yes, volumes: no", "24x16", "minutes", "recording at most 922 kB",
                  "channels radiance lens time, 24 bytes"):
        assert words in result.stdout, result.stdout
    assert "channels radiance, 12 bytes" in check_ok(record(tmp_path / "lens.xml", "--dry-run", "--channels", "radiance")).stdout
    assert os.listdir(tmp_path) == ["lens.xml"]


@pytest.mark.parametrize("arguments, code, words", [
    (["missing.xml", "-o", "x.spool"], 3, "no such file"),
    (["cornell-box"], 2, "give -o"),
    (["cornell-box", "-o", "x.spool", "--channels", "radiance,smell"], 2, "unknown channel 'smell'"),
    (["cornell-box", "-o", "x.spool", "--size", "0x9"], 2, "--size"),
    (["cornell-box", "-o", "x.spool", "--plan", "nowhere.toml"], 2, "--dry-run only"),
    (["cornell-box", "-o", "x.spool", "--integrator", "ptracer"], 1, "no samples of a pixel"),
    (["cornell-box", "-o", "x.spool", "--seed", "5000"], 2, "outside"),
    (["cornell-box", "-o", "x.spool", "--nonsense"], 2, "unrecognized arguments: --nonsense"),
    (["cornell-box", "-o", "x.spool", "--samples", "many"], 2, "invalid int value: 'many'"),
    (["cornell-box", "-o", "x.spool", "--variant", "foo"], 2, "--variant foo: use one of scalar_rgb, llvm_ad_rgb"),
])
def test_bad_input_is_one_line_and_a_code(tmp_path, arguments, code, words):
    result = subprocess.run([sys.executable, RECORD, *arguments], cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == code, result.stderr
    assert words in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_help_and_readme_say_the_exit_codes():
    told = check_ok(record("--help")).stdout
    with open(os.path.join(ROOT, "dumps", "mitsuba", "README.md")) as stream:
        text = stream.read()
    for words in ("0 recorded, 1 the scene cannot be recorded or its samples fail their tests, 2 wrong use", "or the run was stopped"):
        assert words in told.replace("\n", " ") and words in text.replace("\n", " ")
    assert "exit codes: " in told and "Exit codes: " in text


def test_an_integrator_that_differentiates_is_refused(tmp_path):
    result = record("cornell-box", "-o", tmp_path / "x.spool", "--size", 4, "--samples", 1, "--integrator", "prb", "--variant", "llvm_ad_rgb")
    if result.returncode == 3:
        pytest.skip("no LLVM here")
    assert result.returncode == 1 and len(result.stderr.strip().splitlines()) == 1, result.stderr
    assert "PRBIntegrator differentiates" in result.stderr and not os.listdir(tmp_path)


def test_missing_mitsuba_is_one_line(tmp_path):
    (tmp_path / "mitsuba.py").write_text("raise ImportError('no such thing')")
    result = subprocess.run([sys.executable, RECORD, "cornell-box", "-o", "x.spool"], cwd=tmp_path, capture_output=True,
                            text=True, env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert result.returncode == 3 and len(result.stderr.strip().splitlines()) == 1, result.stderr
    assert "pip install -r dumps/mitsuba/requirements.txt" in result.stderr


def test_scene_without_a_camera_and_broken_xml(tmp_path):
    for text, words in (("<scene version='3.0.0'><integrator type='path'/></scene>", "no sensor"), ("<scene", "cannot load")):
        scene = tmp_path / "bad.xml"
        scene.write_text(text)
        result = record(scene, "-o", tmp_path / "bad.spool")
        assert result.returncode == 1 and words in result.stderr
