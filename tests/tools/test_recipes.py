"""The recipes of tools/recipes with the engines that are there; merged results are the bits of a single run's."""
import contextlib
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from conftest import PROGRAM, samples, write_dump
from results_comparison import assert_same_results, cell_lines
from test_plans import PLAN

RECIPES = Path(__file__).resolve().parents[2] / "tools/recipes"
SNAKEMAKE = os.environ.get("SPOOL_SNAKEMAKE") or shutil.which("snakemake")
ENVIRONMENT = {**os.environ, "SPOOL": PROGRAM}


def needs(program):
    return pytest.mark.skipif(not program or not shutil.which(program), reason="not installed")


@pytest.fixture
def plan(good, tmp_path, dump):
    write_dump(tmp_path / "other.spool", samples(seed=2)[0])
    (tmp_path / "plan.toml").write_text(PLAN)
    good("evaluate", "plan.toml", "-o", "whole")
    return "plan.toml"


def start(folder, *command):
    return subprocess.run([*map(str, command)], cwd=folder, env=ENVIRONMENT, text=True, capture_output=True,
                          timeout=300)


@needs("parallel")
def test_shards_by_parallel(plan, tmp_path):
    for _ in range(2):  # again: nothing is left to do
        finished = start(tmp_path, RECIPES / "parallel.sh", plan, "many", 5, "--jobs", 3)
        assert finished.returncode == 0, finished.stderr
    assert_same_results(tmp_path / "whole", tmp_path / "many", images=True)


@needs("parallel")
def test_names_with_spaces_by_parallel(plan, tmp_path):
    (tmp_path / plan).rename(tmp_path / "the plan.toml")
    finished = start(tmp_path, RECIPES / "parallel.sh", "the plan.toml", "the results", 2)
    assert finished.returncode == 0, finished.stderr
    assert_same_results(tmp_path / "whole", tmp_path / "the results", images=True)


def by_snakemake(shards, folder="many"):
    return [SNAKEMAKE, "--snakefile", RECIPES / "Snakefile", "--cores", 2, "--config", "plan=plan.toml", f"folder={folder}",
            f"shards={shards}", f"spool={PROGRAM}"]


@needs(SNAKEMAKE)
def test_shards_by_snakemake(plan, tmp_path):
    finished = start(tmp_path, *by_snakemake(3, "many/"))
    assert finished.returncode == 0, finished.stderr
    assert_same_results(tmp_path / "whole", tmp_path / "many", images=True)
    assert "Nothing to be done" in start(tmp_path, *by_snakemake(3)).stderr


@needs(SNAKEMAKE)
def test_another_plan_and_another_number_of_shards_are_run_by_snakemake(plan, good, tmp_path):
    assert start(tmp_path, *by_snakemake(3)).returncode == 0
    (tmp_path / plan).write_text(PLAN.replace("replicates = 2", "replicates = 3"))
    good("evaluate", plan, "-o", "whole", "--force")
    finished = start(tmp_path, *by_snakemake(3))
    assert finished.returncode == 0, finished.stderr
    assert_same_results(tmp_path / "whole", tmp_path / "many", images=True)
    shutil.rmtree(tmp_path / "many")
    finished = start(tmp_path, *by_snakemake(2))
    assert finished.returncode == 0, finished.stderr
    assert_same_results(tmp_path / "whole", tmp_path / "many", images=True)


SLURM = """
ClusterName=spool
SlurmctldHost=localhost
SlurmctldPort=17000
SlurmUser=root
AuthType=auth/none
AuthInfo=cred_expire=3
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
SlurmdTimeout=5
ReturnToService=2
MpiDefault=none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmdPidFile={folder}/%n.pid
SlurmctldPidFile={folder}/controller.pid
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/%n.log
NodeName=n[1-2] NodeHostname=localhost Port=[17001-17002] CPUs=1 State=UNKNOWN
PartitionName=cpu Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def kill_tree(number):
    children = subprocess.run(["ps", "--ppid", str(number), "-o", "pid="], text=True, capture_output=True).stdout
    with contextlib.suppress(ProcessLookupError):
        os.kill(number, signal.SIGKILL)
    for child in children.split():
        kill_tree(int(child))


class Slurm:
    """A cluster of two nodes on this machine."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "state").mkdir(parents=True)
        configuration = folder / "slurm.conf"
        configuration.write_text(SLURM.format(folder=folder))
        self.environment = {**ENVIRONMENT, "SLURM_CONF": str(configuration)}
        self.daemons = {"controller": self.daemon("slurmctld", "-D")}
        for node in ("n1", "n2"):
            (folder / node).mkdir()
            self.daemons[node] = self.daemon("slurmd", "-D", "-N", node)

    def daemon(self, *command):
        return subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def run(self, *command, cwd=None):
        finished = subprocess.run([*map(str, command)], env=self.environment, cwd=cwd, text=True, capture_output=True,
                                  timeout=60)
        assert finished.returncode == 0, finished.stderr
        return finished.stdout

    def jobs(self):
        return self.run("squeue", "--noheader", "--format", "%i %T %N").splitlines()

    def lose(self, node):
        """The node's daemon and whatever it runs end at once, as when its power fails."""
        daemon = self.daemons.pop(node)
        daemon.kill()
        daemon.wait()
        for step, script in self.steps_of(node):
            kill_tree(step)  # before the script, or it would report
            kill_tree(script)

    def steps_of(self, node):
        """(step daemon, job script) of what the node runs."""
        listed = subprocess.run(["ps", "-eo", "pid=,ppid=,args="], text=True, capture_output=True, check=True).stdout
        processes = [line.split(None, 2) for line in listed.splitlines()]
        steps = {number for number, _, text in processes if text.startswith("slurmstepd: [")}
        return [(int(parent), int(number)) for number, parent, _ in processes
                if parent in steps and self.runs_on(int(number), node)]

    def runs_on(self, number, node):
        try:
            variables = Path(f"/proc/{number}/environ").read_bytes().split(b"\0")
        except OSError:
            return False
        return {f"SLURMD_NODENAME={node}".encode(), f"SLURM_CONF={self.folder}/slurm.conf".encode()} <= set(variables)

    def stop(self):
        for daemon in self.daemons.values():
            daemon.terminate()
        for daemon in self.daemons.values():
            try:
                daemon.wait(timeout=10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()


@pytest.fixture
def slurm(tmp_path):
    cluster = Slurm(tmp_path / "slurm")
    yield cluster
    cluster.stop()


def wait_for(condition, seconds):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.2)


@needs("slurmctld")
@pytest.mark.skipif(os.geteuid() != 0 or "SPOOL_SLURM" not in os.environ, reason="by tools/dev.sh endure, as root")
def test_an_array_of_slurm_survives_the_loss_of_a_node(good, tmp_path, dump, slurm):
    write_dump(tmp_path / "other.spool", samples(seed=2)[0])
    (tmp_path / "plan.toml").write_text(PLAN.replace("replicates = 2", "replicates = 40"))
    wait_for(lambda: "idle" in slurm.run("sinfo", "--noheader"), 60)
    job = slurm.run("sbatch", "--parsable", "--array=0-3", RECIPES / "slurm_array.sh", "plan.toml", "many", 4,
                    cwd=tmp_path).strip()
    merge = slurm.run("sbatch", "--parsable", f"--dependency=afterany:{job}", "--wrap",
                      f"{PROGRAM} evaluate plan.toml --merge -o many", cwd=tmp_path).strip()
    wait_for(lambda: len(cell_lines(tmp_path / "many")) > 20 and slurm.steps_of("n1"), 120)
    slurm.lose("n1")
    kept = len(cell_lines(tmp_path / "many"))
    wait_for(lambda: not slurm.jobs(), 400)
    told = slurm.run("scontrol", "--oneliner", "show", "job", job)
    print(f"{kept} of 1440 results were there when node n1 was lost; restarts:",
          [word for word in told.split() if word.startswith(("JobId=", "Restarts=", "BatchHost="))])
    assert kept < 1440 and "Restarts=1" in told and merge
    good("evaluate", "plan.toml", "-o", "whole", "--no-pictures")
    assert_same_results(tmp_path / "whole", tmp_path / "many")
