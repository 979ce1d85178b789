"""`spool view`: what it answers, and to whom."""

import contextlib
import csv
import json
import os
import signal
import socket
import threading

import numpy as np
import pytest

from served_view import Served, needs_assets, small_scene
import spool
from spool import exr

pytestmark = needs_assets


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return small_scene(tmp_path_factory.mktemp("view"))


@pytest.fixture(scope="module")
def served(scene):
    server = Served(scene)
    yield server
    server.process.kill()
    server.process.communicate()


def test_it_listens_here_only_at_an_address_nobody_guesses(served):
    assert served.host == "127.0.0.1" and len(served.root.strip("/")) == 32
    for path in ("/", "/choices", "/" + "0" * 32 + "/", "/" + "0" * 32 + "/choices", served.root[:-2] + "/choices"):
        assert served.ask(path).status == 403, path
    other = Served(served.process.args[3])
    assert other.root != served.root
    assert other.end()[0] == 130
    with socket.socket() as elsewhere, pytest.raises(OSError):
        elsewhere.settimeout(2)
        elsewhere.connect((socket.gethostbyname(socket.gethostname()), served.port))
        if elsewhere.getpeername()[0] == "127.0.0.1":
            raise OSError("this machine's name is 127.0.0.1")


def test_another_host_is_refused_even_with_the_token(served):
    for host in ("evil.example", f"evil.example:{served.port}", "127.0.0.1", f"127.0.0.1:{served.port + 1}", ""):
        assert served.ask(served.root + "choices", headers={"Host": host}).status == 403, host
    assert served.ask(served.root + "choices", headers={"Host": f"localhost:{served.port}"}).status == 200


def test_only_get_and_no_word_that_lets_others_read(served):
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH", "HEAD"):
        assert served.ask(served.root + "choices", method=method).status == 405, method
    answer = served.ask(served.root + "choices", headers={"Origin": "http://evil.example"})
    names = {name.lower() for name, _ in answer.getheaders()}
    assert not any(name.startswith("access-control") for name in names)
    assert answer.getheader("X-Content-Type-Options") == "nosniff" and answer.getheader("Cache-Control") == "no-store"
    assert answer.getheader("Cross-Origin-Resource-Policy") == "same-origin"


def test_an_answer_to_head_has_no_body(served):
    with socket.create_connection((served.host, served.port), timeout=20) as client:
        client.sendall(f"HEAD {served.root} HTTP/1.1\r\nHost: {served.host}:{served.port}\r\n\r\n".encode())
        with client.makefile("rb") as file:
            head, body = file.read().split(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 405") and body == b""


def test_nothing_is_served_but_what_the_page_names(served, scene):
    for path in ("../../../../etc/passwd", "..%2f..%2fetc%2fpasswd", "%2e%2e/%2e%2e/etc/passwd", "s.spool", str(scene), "choices/",
                 "choices/../../etc/passwd", "choices%00.html"):
        answer = served.ask(served.root + path)
        assert answer.status in (400, 403, 404), path
        assert b"root:" not in answer.content
    assert served.ask(served.root.rstrip("/")).status == 404  # where the page's own questions would go astray


def test_what_is_too_large_or_no_number_is_refused_and_the_server_goes_on(served):
    assert served.ask(served.root + "choices?" + "a" * 20000).status in (400, 414)
    assert served.ask(served.root + "choices", method="POST", body=b"x" * 3000).status == 405
    with contextlib.suppress(ConnectionError):  # a longer body is not read to its end
        assert served.ask(served.root + "choices", method="POST", body=b"x" * 3000000).status == 405
    for query in ("recording=9&x=0&y=0", "recording=0&x=24&y=0", "recording=0&x=-1&y=0", "recording=zero&x=0&y=0",
                  "recording=0&x=99999999999999&y=0", "recording=0&x=1e3&y=1"):
        answer = served.ask(f"{served.root}pixel?{query}")
        assert answer.status == 400 and "error" in json.loads(answer.content), query
    for query in ("recording=0&sampler=0&filter=0&spp=nan", "recording=0&sampler=0&filter=0&spp=1e300", "recording=0&spp=4",
                  "recording=0&sampler=99&filter=0&spp=4", "recording=0&sampler=0&filter=99&spp=4"):
        assert served.ask(f"{served.root}replay?{query}").status == 400, query
    answer = served.ask(f"{served.root}replay?recording=0&sampler=0&filter=0&spp=400")
    assert answer.status == 422 and "record more" in json.loads(answer.content)["error"]
    assert served.json("choices")["recordings"][0]["width"] == 24


def test_a_replay_is_that_of_the_program(served, good, scene, tmp_path):
    for sampler, filter_, spp in (("uniform", "box", 4), ("multiscale", "directional", 6.5)):
        said, planes = served.planes("replay?" + served.key(sampler, filter_, spp))
        good("replay", scene, "--sampler", sampler, "--spp", str(spp), "-o", tmp_path / "n.exr", "-q", "--force")
        good("reconstruct", scene, "--selection", tmp_path / "n.exr", "--filter", filter_, "-o", tmp_path / "i.exr", "-q", "--force")
        counts, image = exr.read(tmp_path / "n.exr")["n"], exr.read(tmp_path / "i.exr")
        assert said["spent"] == counts.sum() and said["relmse"] > 0
        np.testing.assert_array_equal(planes["density"][..., 0], counts)
        for c, name in enumerate("RGB"):
            np.testing.assert_array_equal(planes["estimate"][..., c], image[name].astype("f4"))


def test_a_pixel_is_that_of_the_program(served, good, scene):
    told = served.json("pixel?x=7&y=5&" + served.key("multiscale", "directional", 6))
    asked, = good("pixel", scene, "--at", "7,5", "--sampler", "multiscale", "--spp", "6", "--filter", "directional", "--json").json
    assert {name: value for name, value in asked.items() if name not in ("sampler", "filter")} == told
    plain, = good("pixel", scene, "--at", "7,5", "--json").json
    assert served.json("pixel?recording=0&x=7&y=5") == plain
    _, planes = served.planes("reference?recording=0")
    assert planes["reference"].shape == (16, 24, 3) and np.isfinite(planes["reference"]).all()


def test_two_at_a_time_get_the_same_answers(served):
    keys = [served.key(sampler, filter_, spp) for sampler in ("uniform", "multiscale") for filter_ in ("gaussian", "nl_means")
            for spp in (2, 3, 5)]
    alone = [served.ask(f"{served.root}replay?{key}").content for key in keys]
    fresh = Served(served.process.args[3])
    got = [[None] * len(keys) for _ in range(2)]

    def client(i):
        for k, key in enumerate(keys):
            got[i][k] = fresh.ask(f"{fresh.root}replay?{key}").content

    threads = [threading.Thread(target=client, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert fresh.end()[0] == 130
    assert got[0] == alone and got[1] == alone


def test_a_replay_that_its_page_has_asked_past_is_given_up(served):
    old = "replay?" + served.key("multiscale", "directional", 7) + "&page=p&turn=1"
    new = "replay?" + served.key("multiscale", "directional", 8) + "&page=p&turn=2"
    assert served.ask(served.root + new).status == 200
    answer = served.ask(served.root + old)
    assert answer.status == 409 and json.loads(answer.content)["error"] == "superseded"
    assert served.ask(served.root + old.replace("page=p", "page=q")).status == 200


def test_ctrl_c_ends_it_and_a_taken_port_is_no_failure(scene):
    first = Served(scene)
    second = Served(scene, "--port", first.port)
    assert second.port != first.port
    code, said = first.end()
    assert code == 130 and "no longer served" in said and said.count("\n") == 1
    assert second.end(signal.SIGTERM)[0] == 143


def test_results_serve_their_report_and_only_methods_of_the_program(good, scene, tmp_path, monkeypatch):
    good("evaluate", os.path.relpath(scene, tmp_path), "--samplers", "uniform,multiscale", "--filters", "box,directional", "--spp", "4", "--replicates", "2",
         "--seed", "9", "-o", tmp_path / "r", "-q")
    table = (tmp_path / "r" / "results.csv").read_text().splitlines()
    row = table[1].replace("uniform", "exec:touch " + str(tmp_path / "ran"))
    (tmp_path / "r" / "results.csv").write_text("\n".join([*table, row]) + "\n")
    monkeypatch.chdir("/")  # from where the recording's name in results.csv leads nowhere
    server = Served(tmp_path / "r")
    try:
        choices = server.json("choices")
        assert choices["samplers"] == ["uniform", "multiscale"] and choices["filters"] == ["box", "directional"]
        page = server.ask(server.root)
        assert page.status == 200 and b"connect-src 'self'" in page.content and b'id="headline-area"' in page.content
        assert server.ask(server.root + "live").status == 200
        _, planes = server.planes("replay?" + server.key("multiscale", "directional", 4))
        estimate = exr.read(tmp_path / "r" / "s_multiscale_directional_4spp" / "estimate.exr")
        np.testing.assert_allclose(planes["estimate"][..., 1], estimate["G"], rtol=1e-6)
        assert not (tmp_path / "ran").exists()
    finally:
        assert server.end()[0] == 130


@pytest.mark.parametrize("options", [["--set", "pool.firefly_limit=1"], ["--set", "metrics.rel_scale=none"], ["--reference", "holdout", "--holdout", "12"],
                                     ["--reference", "holdout_pair"], ["--reference", "leave_selected_out"], ["--reference", "pool"],
                                     ["--reference", "crossfit"]])
def test_a_replay_of_results_is_judged_as_they_are(good, scene, tmp_path, options):
    good("evaluate", scene, "--samplers", "multiscale", "--filters", "box", "--spp", "4", "--replicates", "1", *options, "-o", tmp_path / "r", "-q")
    row, = csv.DictReader((tmp_path / "r" / "results.csv").open())
    server = Served(tmp_path / "r")
    try:
        said, _ = server.planes("replay?" + server.key("multiscale", "box", 4))
        if "crossfit" in options:
            assert "relmse" not in said and server.json("choices")["left_out"] == "not replayed: the error (by crossfit, of two replays)"
        else:
            assert said["relmse"] == pytest.approx(float(row["relmse"]), rel=1e-5) and not server.json("choices")["left_out"]
        offered = server.json("choices")["recordings"][0]["spp"]
        assert offered == 32 - {"holdout": 12, "holdout_pair": 16, "leave_selected_out": 3}.get(options[1], 0)
    finally:
        assert server.end()[0] == 130


@pytest.mark.parametrize("options, why", [(["--pieces", "2"], "in pieces of pixels"), (["--decision-split"], "by split decisions"), ([], "no file ")])
def test_a_recording_that_is_not_replayed_is_named_with_its_reason(good, scene, tmp_path, options, why):
    film = np.random.default_rng(1).random((16, 24, 32, 2), "f4")
    with spool.open(scene) as dump:
        spool.write(tmp_path / "own.spool", dump.read("radiance"), film=film, reference=dump.pixel("reference"))
    good("evaluate", tmp_path / "own.spool", "--filters", "box", "--spp", "4", "--replicates", "1", *options, "-o", tmp_path / "r", "-q")
    if not options:
        (tmp_path / "own.spool").unlink()
    server = Served(tmp_path / "r")
    try:
        choices = server.json("choices")
        assert not choices["recordings"] and choices["left_out"].startswith(f"not replayed: own ({why}")
    finally:
        code, said = server.end()
        assert code == 130 and choices["left_out"] in said


def test_the_page_and_the_program_call_a_recording_by_one_name_without_marks_of_direction(good, scene, tmp_path):
    name, shown = "s\u202ex", "s\\u202ex"
    (tmp_path / f"{name}.spool").write_bytes(scene.read_bytes())
    good("evaluate", tmp_path / f"{name}.spool", "--spp", "4", "--replicates", "2", "-o", tmp_path / "r", "-q")
    for target in (tmp_path / f"{name}.spool", tmp_path / "r"):
        server = Served(target)
        try:
            assert [recording["label"] for recording in server.json("choices")["recordings"]] == [shown]
            page = server.ask(server.root).content.decode()
            assert "\u202e" not in page and shown in page
            assert target.suffix or f'"dumps":{json.dumps([shown])}' in page
        finally:
            assert server.end()[0] == 130


def test_commands_are_offered_and_run_only_where_the_user_allows_it(good, scene, tmp_path):
    (tmp_path / "den").write_text(f"#!/bin/sh\ntouch {tmp_path}/ran\ncp {tmp_path}/image.exr \"$2\"\n")
    (tmp_path / "den").chmod(0o755)
    exr.write(tmp_path / "image.exr", {c: np.full((16, 24), 0.5, "f4") for c in "RGB"})
    words = (scene, "--filters", f"box,den=exec:{tmp_path}/den,mine=directional", "--spp", "4", "--replicates", "1", "--samplers",
             f"uniform,loop=cross_halves{{filter=exec:{tmp_path}/den}}")
    inside = ("--filters", f"ensemble:box+exec:{tmp_path}/den", "--spp", "4", "--dry-run")
    for dry in (words + ("--dry-run",), (scene, *inside)):
        assert "run commands of the plan" in good("evaluate", *dry).out and not (tmp_path / "ran").exists()
    good("evaluate", *words, "-o", tmp_path / "r", "-q")
    (tmp_path / "ran").unlink()
    for words, filters in (((), ["box", "mine"]), (("--allow-commands",), ["box", "den", "mine"])):
        server = Served(tmp_path / "r", *words)
        try:
            choices = server.json("choices")
            assert choices["filters"] == filters and not (tmp_path / "ran").exists()
            assert choices["samplers"] == ["uniform", "loop"][:1 + bool(words)]
            apart = "loop (a command: --allow-commands), den (a command: --allow-commands)"
            assert choices["left_out"] == ("" if words else f"not replayed: {apart}")
            if words:
                _, planes = server.planes("replay?" + server.key("uniform", "den", 4))
                assert (planes["estimate"] == 0.5).all() and (tmp_path / "ran").exists()
        finally:
            code, said = server.end()
            assert code == 130 and ("not replayed: loop" in said) == (not words)


def test_a_recording_offers_what_the_user_names_beside_the_methods_of_the_program(run, scene, tmp_path):
    (tmp_path / "den.sh").write_text(f"cp {tmp_path}/image.exr \"$2\"\n")
    exr.write(tmp_path / "image.exr", {c: np.full((16, 24), 0.5, "f4") for c in "RGB"})
    server = Served(scene, "--filters", f"box,exec:sh {tmp_path}/den.sh,wide=gaussian{{sigma=3}}")
    try:
        filters = server.json("choices")["filters"]
        assert filters[-2:] == ["den", "wide"] and filters.count("box") == 1
        _, planes = server.planes("replay?" + server.key("uniform", "den", 4))
        assert (planes["estimate"] == 0.5).all()
    finally:
        assert server.end()[0] == 130
    run("view", scene, "--filters", "gausian").failed_with(2, "did you mean 'gaussian'")
    run("view", scene, "--samplers", "box").failed_with(2, "is a filter, not a sampler")


def test_a_folder_without_its_plan_is_served_with_the_methods_of_the_program(good, scene, tmp_path):
    good("evaluate", scene, "--filters", "box,mine=directional", "--spp", "4", "--replicates", "1", "-o", tmp_path / "r", "-q")
    (tmp_path / "r" / "plan.toml").unlink()
    server = Served(f"{tmp_path}/r/")
    try:
        assert b"<title>Spool: r</title>" in server.ask(server.root + "live").content
        choices = server.json("choices")
        assert {"uniform", "multiscale"} <= set(choices["samplers"]) and "mine" not in choices["filters"]
    finally:
        code, said = server.end()
        assert code == 130 and "no plan.toml" in said


def test_what_cannot_be_served_is_said_before(run, tmp_path):
    run("view", tmp_path / "none.spool").failed_with(3, "none.spool")
    (tmp_path / "empty").mkdir()
    run("view", tmp_path / "empty").failed_with(3, "results.csv")
