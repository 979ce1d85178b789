"""`spool view` and other users of the machine: they can connect, but have no token."""

import contextlib
import os
import resource
import socket
import subprocess
import time

import pytest
from served_view import Served, needs_assets, small_scene

pytestmark = needs_assets
MB = 1 << 20
SLACK = float(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return small_scene(tmp_path_factory.mktemp("view"))


@pytest.fixture
def served(scene):
    server = Served(scene)
    server.json("choices")
    yield server
    server.process.kill()
    server.process.communicate()


def peak_memory(server):
    with open(f"/proc/{server.process.pid}/status", encoding="ascii") as status:
        return 1024 * int(next(line for line in status if line.startswith("VmHWM")).split()[1])


def threads(server):
    return len(os.listdir(f"/proc/{server.process.pid}/task"))


def connected(server):
    return socket.create_connection((server.host, server.port), timeout=30)


def what_comes(connection):
    said = b""
    with contextlib.suppress(ConnectionError):
        while piece := connection.recv(65536):
            said += piece
    return said


def asked_raw(server, text):
    with connected(server) as connection:
        with contextlib.suppress(ConnectionError):
            connection.sendall(text)
        return what_comes(connection)


def flood(server, start, piece, most):
    """Bytes that could be sent before the server had enough."""
    sent = 0
    with connected(server) as connection, contextlib.suppress(ConnectionError):
        connection.sendall(start)
        while sent < most:
            sent += connection.send(piece)
    return sent


@pytest.mark.parametrize("start, piece", [
    (b"GET / HTTP/1.1\r\n", b"X1: a\r\n" * 10000), (b"GET /", b"a" * 65536), (b"GET / HTTP/1.1\r\nX: ", b"a" * 65536),
    (b"", b"\r\n" * 32768), (b"GET / HTTP/1.1\r\nContent-Length: 999999999\r\n\r\n", b"a" * 65536),
    (b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n", b"ffff\r\n" + b"a" * 65535 + b"\r\n")],
    ids=["headers", "address", "a header", "line ends", "body", "chunks"])
def test_a_flood_is_cut_off_and_takes_no_memory(served, start, piece):
    before = peak_memory(served)
    assert flood(served, start, piece, 100 * MB) < 20 * MB  # what the buffers of two sockets hold
    assert peak_memory(served) < before + 4 * MB
    assert served.ask(served.root + "choices").status == 200


def test_a_request_that_is_too_long_gets_told_so(served):
    for length, status in ((5000, 404), (9000, 414), (70000, 431)):
        answer = asked_raw(served, f"GET {served.root}{'a' * length} HTTP/1.1\r\nHost: {served.host}:{served.port}\r\n\r\n".encode())
        assert answer.startswith(f"HTTP/1.1 {status} ".encode()), answer[:80]


def test_slow_clients_hold_neither_threads_nor_the_page(served):
    before, slow = threads(served), []
    for i in range(300):  # more than there may be
        slow.append(connected(served))
        slow[-1].sendall(b"G" if i % 2 else b"")
    begin = time.monotonic()
    for _ in range(20):
        assert served.ask(served.root + "choices").status == 200
    assert time.monotonic() - begin < 5 * SLACK
    assert threads(served) == before
    for connection in slow:
        connection.close()


def test_answered_clients_that_stay_make_room(served):
    stay = []
    for _ in range(300):  # each is told 405 and sends no body
        stay.append(connected(served))
        stay[-1].sendall(f"POST {served.root} HTTP/1.1\r\nHost: {served.host}:{served.port}\r\nContent-Length: 9\r\n\r\n".encode())
    for _ in range(20):
        assert served.ask(served.root + "choices").status == 200
    for connection in stay:
        connection.close()


def test_a_request_has_ten_seconds_however_steadily_it_arrives(served):
    with connected(served) as steady, connected(served) as silent:
        begin, text = time.monotonic(), b"GET / HTTP/1.1\r\nHost: " + b"a" * 1000
        with pytest.raises(ConnectionError):
            for byte in text:
                steady.sendall(bytes([byte]))
                time.sleep(0.2)
        assert 9 < time.monotonic() - begin < 14 * SLACK
        assert what_comes(silent) == b""


def test_a_reader_that_does_not_read_is_left(scene):
    server = Served(scene)
    try:
        with connected(server) as lazy:
            lazy.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
            lazy.sendall(f"GET {server.root} HTTP/1.1\r\nHost: {server.host}:{server.port}\r\n\r\n".encode())
            until(lambda: sockets_of(server) == 2)  # the connection is taken ...
            until(lambda: sockets_of(server) == 1)  # ... and left, but for the one that listens
    finally:
        server.end()


def until(holds):
    deadline = time.monotonic() + 30 * SLACK
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.1)


def sockets_of(server):
    folder = f"/proc/{server.process.pid}/fd"
    found = 0
    for name in os.listdir(folder):
        with contextlib.suppress(OSError):
            found += os.readlink(f"{folder}/{name}").startswith("socket:")
    return found


@pytest.mark.parametrize("wanted", ["bytes=0-99999999", "bytes=700-2000", "bytes=-5", "bytes=0-0,2-3", "bytes=99999999-",
                                    "bytes=18446744073709551615-", "bytes=x", "lines=1-2"])
def test_a_range_changes_nothing(served, wanted):
    for name in ("choices", "replay?" + served.key("uniform", "box", 4), ""):
        whole = served.ask(served.root + name)
        part = served.ask(served.root + name, headers={"Range": wanted})
        assert part.status == 200 and part.content == whole.content and "Content-Range" not in part.headers


def test_what_is_no_request_is_refused_and_the_server_goes_on(served):
    host = f"Host: {served.host}:{served.port}\r\n"
    for text in ("\x00" * 100, "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET /\x01 HTTP/1.1\r\n\r\n", f"G\x80T {served.root} HTTP/1.1\r\n{host}\r\n",
                 "GET / HTTP/1.1\r\nHost\r\n\r\n", "POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
                 "POST / HTTP/1.1\r\nContent-Length: 99999999999999999999999\r\n\r\n",
                 f"GET {served.root}choices HTTP/1.1\r\nHost: evil\r\n{host}\r\n", f"GET {served.root}choices HTTP/1.0\r\n\r\n",
                 f"GET http://{served.host}:{served.port}{served.root}choices HTTP/1.1\r\n{host}\r\n"):
        answer = asked_raw(served, text.encode("latin-1"))
        assert answer.split(b" ")[1] in (b"400", b"403"), (text, answer)
        assert b"recordings" not in answer
    two = asked_raw(served, f"GET {served.root}choices HTTP/1.1\r\n{host}\r\n".encode() * 2)
    assert two.count(b"HTTP/1.1 200") == 1  # a connection is one request
    assert served.ask(served.root + "choices").status == 200


def test_many_at_once_all_get_their_answer(served):
    connections = [connected(served) for _ in range(100)]
    for connection in connections:
        connection.sendall(f"GET {served.root}pixel?recording=0&x=1&y=1 HTTP/1.1\r\nHost: localhost:{served.port}\r\n\r\n".encode())
    assert {what_comes(connection).split(b"\r\n")[0] for connection in connections} == {b"HTTP/1.1 200 OK"}


def test_few_file_handles_stop_no_server(scene):
    server = Served(scene)
    connected(server).close()  # UBSan looks at a type, the first time it meets it, through a pipe: at none later, when handles are short
    assert server.ask(server.root + "choices").status == 200
    resource.prlimit(server.process.pid, resource.RLIMIT_NOFILE, (40, 40))
    try:
        held = [connected(server) for _ in range(60)]
        assert server.ask(server.root + "choices").status == 200
        for connection in held:
            connection.close()
    finally:
        server.end()


@pytest.mark.parametrize("how", ["> /dev/full", ">&-"])
def test_an_address_that_cannot_be_printed_ends_it(scene, how):
    done = subprocess.run(["sh", "-c", f'"$0" view "$1" {how}', os.environ["SPOOL_PROGRAM"], str(scene)], capture_output=True,
                          text=True, timeout=60, check=False)
    assert done.returncode == 3 and done.stderr.startswith("spool: stdout: ") and done.stderr.count("\n") == 1


@pytest.mark.parametrize("name", ["results.csv", "statistics.json", "manifest.json"])
def test_a_fifo_among_the_results_is_not_waited_for(run, good, scene, tmp_path, name):
    good("evaluate", scene, "--samplers", "uniform", "--filters", "box", "--spp", "4", "-o", tmp_path / "r", "-q")
    (tmp_path / "r" / name).unlink()
    os.mkfifo(tmp_path / "r" / name)
    for verb in (["view"], ["report", "-o", tmp_path / "p.html"], ["figure", "-o", tmp_path / "f"]):
        run(*verb, tmp_path / "r").failed_with(3, f"{name}: is no regular file")
