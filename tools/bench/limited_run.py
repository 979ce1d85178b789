"""A command in a process of its own, perhaps below a limit of memory: what it took."""
import contextlib
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GROUPS = {Path("/sys/fs/cgroup/memory"): "memory.limit_in_bytes", Path("/sys/fs/cgroup"): "memory.max"}


@contextlib.contextmanager
def control_group(limit):
    """A group with this limit of memory; None where none can be made."""
    for top, file in GROUPS.items():
        group = top / f"spool_bench_{os.getpid()}"
        try:
            if not (top / "cgroup.procs").exists():
                continue
            group.mkdir()
            (group / file).write_text(str(int(limit)), encoding="ascii")
        except OSError:
            if group.exists():
                group.rmdir()
            continue
        try:
            yield group
        finally:
            group.rmdir()
        return
    yield None


def status(process, name, file="status"):
    """A number of /proc; 0 once the process has ended."""
    try:
        for line in Path(f"/proc/{process}/{file}").read_text(encoding="ascii").splitlines():
            if line.startswith(name + ":"):
                return int(line.split()[1])
    except (OSError, ValueError):
        pass
    return 0


def run(command, group=None, addresses=None, environment=None, watched=lambda: 0):
    """Exit code, last line of standard error, wall and CPU seconds; at its most the resident bytes (its own, of libraries and of
    mapped files), those besides files, the bytes that it read, and what `watched` gives meanwhile."""
    def enter():
        if group:
            (group / "cgroup.procs").write_text(str(os.getpid()), encoding="ascii")
        if addresses:
            resource.setrlimit(resource.RLIMIT_AS, (addresses, addresses))

    began = time.monotonic()
    errors = tempfile.TemporaryFile("w+")
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL, stderr=errors, preexec_fn=enter,
                               env={**os.environ, **(environment or {})})
    most = {"resident": 0, "anonymous": 0, "read": 0, "watched": 0}
    while True:
        ended, code, used = os.wait4(process.pid, os.WNOHANG)
        if ended:
            break
        now = {"resident": 1024 * status(process.pid, "VmHWM"), "anonymous": 1024 * status(process.pid, "RssAnon"),
               "read": status(process.pid, "rchar", "io"), "watched": watched()}
        most = {key: max(value, now[key]) for key, value in most.items()}
        time.sleep(0.005)
    process.returncode = os.waitstatus_to_exitcode(code)
    with errors:
        errors.seek(0)
        told = errors.read().strip().splitlines()
    return {"code": process.returncode, "told": told[-1] if told else "", "wall": time.monotonic() - began,
            "cpu": used.ru_utime + used.ru_stime, **most}


def run_or_end(subject, command, group=None, addresses=None, **more):
    """As run(); the script ends where the command fails."""
    found = run(command, group, addresses, **more)
    if found["code"] != 0:
        sys.exit(f"{subject}: {' '.join(map(str, command))}: exit code {found['code']}: {found['told']}")
    return found
