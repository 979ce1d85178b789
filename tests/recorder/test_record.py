"""The recorder with Blender: what it records, what it refuses, and that a kill costs nothing."""
import json
import os
import resource
import signal
import subprocess
import time
import zlib

import pytest
from conftest import SMALL, Folder, command, record


def one_line(text):
    lines = [line for line in text.splitlines() if line.startswith("record:")]
    assert len(lines) == 1, text
    return lines[0]


def test_recording_is_whole(recorded):
    assert recorded.names == ["radiance.R", "radiance.G", "radiance.B", "albedo.R", "albedo.G",
                              "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"]
    files = recorded.files()
    assert len(files) == 4 + 16
    for entry in recorded.entries:
        assert zlib.crc32(files[entry["file"]]) == entry["crc32"]
        assert len(files[entry["file"]]) == 4 * 16 * 16 * (10 if entry["kind"] == "pass" else 3)
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


@pytest.mark.parametrize("mode", ["shift", "iid", "sequence"])
def test_a_killed_recording_continues_bit_for_bit(mode, tmp_path):
    options = ("--scene", "chess", "--size", "16", "--samples", "128", "--reference", "64", "--mode", mode)
    whole = record(*options, "-o", tmp_path / "whole")
    assert whole.returncode == 0, whole.stderr
    torn = tmp_path / "torn"
    process = subprocess.Popen(command(*options, "-o", torn), stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    while not list(torn.glob("pass_00003.f32")) and time.monotonic() < deadline:
        time.sleep(0.001)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    left = len(list(torn.glob("*_?????.f32")))
    assert 0 < left < 192
    again = record(*options, "-o", torn)
    assert again.returncode == 0, again.stderr
    assert "(0 kept), reference" not in again.stdout
    assert Folder(torn).files() == Folder(tmp_path / "whole").files()


@pytest.mark.parametrize("first, second, batch", [(64, 130, 2), (130, 64, 1)])
def test_another_reference_is_begun_anew_and_says_so(first, second, batch, tmp_path):
    """Batches of one sample and of two, 64 and 65 of them; killed on the way to the second, which then goes on as any other."""
    options = ("--scene", "chess", "--size", "16", "--samples", "4", "--mode", "iid", "--channels", "radiance")
    whole, turned = tmp_path / "whole", tmp_path / "turned"
    for reference, folder in ((second, whole), (first, turned)):
        done = record(*options, "--reference", reference, "-o", folder)
        assert done.returncode == 0 and "anew" not in done.stderr, done.stderr
    process = subprocess.Popen(command(*options, "--reference", second, "-o", turned), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               text=True)
    told = process.stderr.readline()
    assert "the reference is begun anew: a batch now has %d samples, the %d batches there had %d" % (
        batch, 64 if first == 64 else 65, 3 - batch) in told
    deadline = time.monotonic() + 60
    while len(list(turned.glob("reference_?????.f32"))) < 3 and time.monotonic() < deadline:
        time.sleep(0.001)
    process.kill()
    process.communicate()
    assert 4 < len(Folder(turned).entries) < 4 + 64
    done = record(*options, "--reference", second, "-o", turned)
    assert done.returncode == 0 and "anew" not in done.stderr and "(0 kept)" not in done.stdout, done.stdout + done.stderr
    assert Folder(turned).files() == Folder(whole).files()
    assert [entry["samples"] for entry in Folder(turned).entries if entry["kind"] == "reference"] == [batch] * (second // batch)


def test_what_an_earlier_command_left_beside_the_wish_is_told(recorded):
    done = record(*SMALL[:4], "--mode", "shift", "--samples", "3", "--reference", "14", "-o", recorded.path)
    assert done.returncode == 0 and "the folder holds 1 passes and 2 batches more, and spool pack takes them too" in done.stdout


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_cancelled_recording_says_how_to_go_on(number, tmp_path):
    options = ("--scene", "chess", "--size", "16", "--samples", "2000", "--mode", "iid")
    torn = tmp_path / "torn"
    process = subprocess.Popen(command(*options, "-o", torn), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               text=True)
    deadline = time.monotonic() + 120
    while not list(torn.glob("pass_00003.f32")) and time.monotonic() < deadline:
        time.sleep(0.001)
    process.send_signal(number)
    told = process.communicate(timeout=120)[1]
    assert process.returncode == 3 and "of 2000 passes: run the same command again to go on" in one_line(told)
    left = len(list(torn.glob("pass_?????.f32")))
    assert 3 < left < 2000 and len(Folder(torn).entries) == left and not list(torn.glob("*.partial"))
    done = record(*options[:-4], "--samples", left, *options[-2:], "-o", torn)
    assert done.returncode == 0 and "%d passes (%d kept)" % (left, left) in done.stdout


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


def disk(path, size):
    """A real, small file system where we may mount one; else a limit on the size of a file."""
    path.mkdir()
    return subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % size, "tmpfs", path],
                          capture_output=True).returncode == 0


def test_a_full_disk_is_one_line_and_the_recording_goes_on_after_it(tmp_path):
    small = tmp_path / "small"
    options = ("--scene", "chess", "--size", "32", "--samples", "12", "--mode", "iid")
    mounted = disk(small, 256 * 1024)      # a pass has 40 KB
    try:
        if mounted:
            done = record(*options, "-o", small / "passes")
            words = "No space left on device"
        else:
            done = record(*options, "-o", small / "passes",
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (30000, 30000)))
            words = "File too large"
        assert done.returncode == 3, done.stderr
        assert words in one_line(done.stderr) and "free some space and run the same command again" in done.stderr
        assert not list(small.glob("passes/*.partial"))
        if mounted:
            kept = len(Folder(small / "passes").entries)
            assert 2 < kept < 12
            subprocess.run(["mount", "-o", "remount,size=4m", small], check=True)
        done = record(*options, "-o", small / "passes")
        assert done.returncode == 0, done.stderr
        if mounted:
            assert "12 passes (%d kept)" % kept in done.stdout
    finally:
        if mounted:
            subprocess.run(["umount", small], check=True)


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
    make_blend(blend, "pass")
    done = record("--blend", blend, "--size", "24x16", "--samples", "2", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    folder = Folder(tmp_path / "passes")
    assert folder.recording["scene"] == {"name": "cube.blend",
                                         "sha256": hashlib.sha256(blend.read_bytes()).hexdigest()}
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
        kept = Folder(tmp_path / size).recording["scene"].get("changes")
        assert (len(told) == 1 and words in told[0] and words in kept[0]) if words else told == [] and kept is None


def test_a_dry_run_tells_needs_and_price_and_writes_nothing(tmp_path):
    done = record("--scene", "chess", "--size", "16", "--dry-run", "-o", tmp_path / "passes",
                  "--reference", "64")
    assert done.returncode == 0, done.stderr
    for part in ("depth of field: yes, motion blur: no, volumes: no", "64 batches of 1 spp",
                 "minutes", "folder 852 kB"):
        assert part in done.stdout
    assert list(tmp_path.rglob("*.f32")) == []


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
