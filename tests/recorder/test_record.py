"""The recorder with Blender: what it records, what it refuses and what it tells."""
import json
import os
import subprocess
import zlib

import pytest
from conftest import SMALL, Folder, command, one_line, record


def test_recording_is_whole(recorded):
    assert recorded.names == ["radiance.R", "radiance.G", "radiance.B", "albedo.R", "albedo.G",
                              "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"]
    files = recorded.files()
    assert len(files) == 4 + 16
    for entry in recorded.entries:
        assert zlib.crc32(files[entry["file"]]) == entry["crc32"]
        assert recorded.planes(entry["file"]).shape == (10 if entry["kind"] == "pass" else 3, 16, 16)
    assert len({entry["seed"] for entry in recorded.entries}) == 20
    assert recorded.recording["needs"] == {"depth_of_field": True, "motion_blur": False,
                                           "volumes": False}
    assert recorded.recording["settings"]["cycles.sample_clamp_indirect"] == 0.0


def test_passes_differ_and_features_make_sense(recorded):
    import numpy
    passes = [e["file"] for e in recorded.entries if e["kind"] == "pass"]
    first, second = (recorded.plane(name, "radiance.G") for name in passes[:2])
    assert (first != second).mean() > 0.9
    depth = recorded.plane(passes[0], "depth.Z")
    hit = depth > 0
    assert 0.5 < hit.mean() < 1 and depth.max() < 100
    length = numpy.sqrt(sum(recorded.plane(passes[0], "normal." + a).astype(float) ** 2 for a in "XYZ"))
    assert abs(length[hit] - 1).max() < 1e-3 and (length[~hit] == 0).all()
    # rows from the top: the sky is above, the board below
    assert (depth[0] == 0).mean() > (depth[-1] == 0).mean()


def test_pixels_by_file_and_by_engine_are_the_same_bits(recorded, tmp_path):
    done = record(*SMALL, "--mode", "shift", "--pixels", "file", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    assert Folder(tmp_path / "passes").files() == recorded.files()


def test_processes_that_share_a_recording_make_the_same_dump(recorded, tmp_path):
    """Two at the same time, each with its own passes and batches; packed together they are the whole."""
    shares = [("--samples", "1", "--first", "0", "--reference", "4", "--first-batch", "0"),
              ("--samples", "3", "--first", "1", "--reference", "12", "--first-batch", "4")]
    folders = [tmp_path / "a", tmp_path / "b"]
    running = [subprocess.Popen(command(*SMALL[:4], "--mode", "shift", *share, "-o", folder), stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True) for share, folder in zip(shares, folders)]
    for process in running:
        told = process.communicate(timeout=280)[1]
        assert process.returncode == 0, told
    together = {**Folder(folders[0]).files(), **Folder(folders[1]).files()}
    assert together == recorded.files()
    spool = os.environ.get("SPOOL", "")
    if not os.path.exists(spool):
        pytest.skip("NOT TESTED: the program spool is not built")
    for name, sources in (("whole", [recorded.path]), ("joined", folders)):
        packed = subprocess.run([spool, "pack", *sources, "-o", tmp_path / name], capture_output=True, text=True)
        assert packed.returncode == 0, packed.stderr
    told = [subprocess.run([spool, "info", tmp_path / name, "--json"], capture_output=True, text=True).stdout
            for name in ("whole", "joined")]
    whole, joined = (json.loads(text) for text in told)
    assert joined["samples_per_pixel"] == 4 and joined["meta"]["seeds"] == whole["meta"]["seeds"]
    assert joined["meta"]["reference"]["samples"] == 16
    overlap = subprocess.run([spool, "pack", recorded.path, folders[1], "-o", tmp_path / "twice"],
                             capture_output=True, text=True)
    assert overlap.returncode != 0 and not (tmp_path / "twice").exists()
    assert len(overlap.stderr.strip().splitlines()) == 1 and "seed" in overlap.stderr, overlap.stderr


def test_quiet_when_piped_and_one_line_at_the_end(recorded):
    done = record(*SMALL, "--mode", "shift", "-o", recorded.path)
    assert "aspect" not in done.stderr     # 16x16 beside the 1920x1080 of an empty file
    lines = [line for line in done.stdout.splitlines() if not line.startswith("Blender")]
    assert done.returncode == 0 and len(lines) == 1 and "4 passes (4 kept)" in lines[0]
    assert "\r" not in done.stderr


@pytest.mark.parametrize("other", [("--seed", "2"), ("--size", "17"), ("--mode", "iid"),
                                   ("--channels", "radiance")])
def test_another_recording_is_not_mixed_in(recorded, other):
    before = recorded.files()
    done = record(*SMALL, "--mode", "shift", "-o", recorded.path, *other)
    assert done.returncode == 2 and "another recording" in one_line(done.stderr)
    assert recorded.files() == before


@pytest.mark.parametrize("options, code, message", [
    (("--scene", "nowhere"), 2, "scene 'nowhere' is unknown: use balls, caustic, chess, fireflies"),
    ((), 2, "no scene"),
    (("--scene", "chess", "--channels", "radiance,heat"), 2, "channel 'heat' is unknown"),
    (("--scene", "chess", "--channels", "object"), 2, "use --mode shift"),
    (("--scene", "chess", "--channels", "lens"), 2, "Cycles does not tell where on the lens"),
    (("--scene", "balls", "--channels", "time"), 2, "Cycles does not tell at which moment"),
    (("--scene", "chess", "--channels", "film"), 2, "use --mode shift"),
    (("--scene", "chess", "--camera", "lamp"), 2, "camera 'lamp' is not in the scene (camera)"),
    (("--blend", "missing.blend"), 3, "missing.blend: No such file"),
    (("--scene", "chess", "--samples", "many"), 2, "samples"),
    (("--scene", "chess", "--size", "4", "--plan", "nowhere.toml"), 2, "--plan nowhere.toml: only a dry run reads it"),
])
def test_wrong_use_is_one_line(options, code, message, tmp_path):
    done = record(*options, "-o", tmp_path / "passes")
    assert done.returncode == code and message in one_line(done.stderr)


def test_a_broken_blend_file_is_one_line(tmp_path):
    broken = tmp_path / "broken.blend"
    broken.write_bytes(b"BLENDER-v304" + bytes(range(200)))
    done = record("--blend", broken, "-o", tmp_path / "passes")
    assert done.returncode == 1 and "cannot load" in one_line(done.stderr)


def make_blend(path, script):
    done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python-expr",
                           "import bpy\n%s\nbpy.ops.wm.save_as_mainfile(filepath=%r)" %
                           (script, str(path))], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_scene_without_a_camera_is_refused(tmp_path):
    make_blend(tmp_path / "blind.blend", "bpy.data.objects.remove(bpy.context.scene.camera)")
    done = record("--blend", tmp_path / "blind.blend", "-o", tmp_path / "passes")
    assert done.returncode == 1 and "has no camera" in one_line(done.stderr)


def test_a_blend_file_is_recorded_with_its_hash(tmp_path):
    import hashlib
    blend = tmp_path / "cube.blend"
    make_blend(blend, "bpy.context.scene.render.engine = 'CYCLES'")
    done = record("--blend", blend, "--size", "24x16", "--samples", "2", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    folder = Folder(tmp_path / "passes")
    assert folder.recording["scene"] == {
        "name": "cube.blend", "sha256": hashlib.sha256(blend.read_bytes()).hexdigest(),
        "changes": ["the denoiser is left out", "replaced, so that samples are independent and unclamped: adaptive sampling, clamp of indirect light, light "
                    "threshold, filter glossy, pixel filter",
                    "24x16 has another aspect than the scene's 1920x1080: the picture shows more or less of it"]}
    assert folder.plane("pass_00000.f32", "radiance.R").shape == (16, 24)
    # iid: depth by the mist pass; the default cube stands 11 units from the camera
    depth = folder.plane("pass_00000.f32", "depth.Z")
    assert 8 < depth[8, 12] < 12


def test_a_blend_file_at_another_aspect_is_remarked_and_the_remark_is_kept(tmp_path):
    blend = tmp_path / "cube.blend"
    make_blend(blend, "bpy.context.scene.render.resolution_percentage = 50")    # of 1920x1080
    for size, words in (("32", "32x32 has another aspect than the scene's 960x540"), ("32x18", None)):
        done = record("--blend", blend, "--size", size, "--samples", "1", "-o", tmp_path / size)
        assert done.returncode == 0, done.stderr
        told = [line for line in done.stderr.splitlines() if "another aspect" in line]
        kept = Folder(tmp_path / size).recording["scene"]["changes"][1:]          # the first: made for another engine
        assert (len(told) == 1 and words in told[0] and words in kept[0]) if words else told == kept == []


def test_a_dry_run_tells_needs_and_price_and_writes_nothing(tmp_path):
    done = record("--scene", "chess", "--size", "16", "--dry-run", "-o", tmp_path / "passes",
                  "--reference", "64")
    assert done.returncode == 0, done.stderr
    for part in ("depth of field: yes, motion blur: no, volumes: no", "64 batches of 1 spp",
                 "minutes", "folder 852 kB"):
        assert part in done.stdout
    assert list(tmp_path.rglob("*.f32")) == []


def test_a_dry_run_counts_the_batches_that_a_reference_without_a_length_keeps(tmp_path):
    done = record("--scene", "chess", "--size", "16", "--samples", "4", "--reference", "auto", "--channels", "radiance", "--dry-run")
    assert "folder 406 kB" in done.stdout, done.stdout + done.stderr      # 4 * 256 * 3 * (4 + 128) bytes


def test_a_dry_run_offers_a_smaller_reference_that_splits_into_batches(tmp_path):
    """A quarter of 257 batches of 128 samples is 64 of them and 32 samples more."""
    told = record("--scene", "chess", "--size", "16", "--samples", "1", "--reference", "32896", "--dry-run").stdout
    assert "its own noise adds 0.00304 % to the squared error of a mean of all 1 samples" in told
    assert "--reference 8192 would save " in told and "and add 0.0122 %" in told
    done = record("--scene", "chess", "--size", "16", "--samples", "1", "--dry-run", "--reference", "8192")
    assert done.returncode == 0, done.stderr
    none = record("--scene", "chess", "--size", "16", "--samples", "1", "--dry-run").stdout
    assert "no reference: methods can only be judged against the pool itself" in none


@pytest.mark.parametrize("scene, needs", [("balls", {"depth_of_field", "motion_blur"}), ("caustic", set()),
                                          ("fireflies", set()), ("mist", {"volumes"}), ("table", set())])
def test_every_scene_can_be_recorded(scene, needs, tmp_path):
    import numpy
    done = record("--scene", scene, "--size", "16", "--samples", "8", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    folder = Folder(tmp_path / "passes")
    assert {need for need, present in folder.recording["needs"].items() if present} == needs
    light = numpy.stack([folder.plane(e["file"], "radiance.G") for e in folder.entries])
    assert numpy.isfinite(light).all() and light.min() >= 0 and light.max() > 0
