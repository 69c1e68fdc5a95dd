# SPDX-License-Identifier: Apache-2.0
"""Slurm itself on this machine: munged, slurmctld and two slurmd that listen on loopback."""

from __future__ import annotations

import getpass
import os
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

PATIENCE_S = 120.0
NODES = ("n1", "n2")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol")
CONFIGURATION = """\
ClusterName=weft
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/s
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/log/slurmctld.log
SlurmdLogFile={folder}/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0,sched_min_interval=20000,\
defer_batch
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SlurmctldTimeout=30
SlurmdTimeout=30
KillWait=5
MinJobAge=3600
AccountingStorageType=accounting_storage/none
NodeName=n[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1 \
RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> list[str]:
    """The programs that are not installed."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    return [name for name in PROGRAMS if shutil.which(name, path=path) is None]


def free_ports() -> int:
    """The first of four ports that nobody listens on."""
    for first in range(26800, 30000, 4):
        try:
            for port in range(first, first + 4):
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
            return first
        except OSError:
            continue
    raise RuntimeError("no four free ports in a row")


def wait_for(what, seconds: float = PATIENCE_S) -> bool:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if what():
            return True
        time.sleep(0.1)
    return False


class Loopback:
    """A cluster of two nodes with one processor each, in a folder. Sets PATH and SLURM_CONF."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.held = 0  # tasks that Slurm would not start again
        for inner in ("munge", "state", "spool.n1", "spool.n2", "log"):
            (folder / inner).mkdir(parents=True)
        (folder / "munge").chmod(0o711)
        key = folder / "munge/key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        port = free_ports()
        (folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], user=getpass.getuser(), folder=folder,
            port=port, first=port + 1, last=port + 2))
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        os.environ["PATH"] += ":/usr/sbin:/sbin"
        self.call("munged", f"--key-file={key}", f"--socket={folder}/munge/s",
                  f"--pid-file={folder}/munge/pid", f"--log-file={folder}/munge/log",
                  f"--seed-file={folder}/munge/seed", "--force")
        self.start_controller("-c")
        for node in NODES:
            self.start_node(node, "-c")
        if not wait_for(lambda: self.call("sinfo", "-h", "-o", "%T").strip() == "idle"):
            raise RuntimeError("the nodes do not become idle: " + self.call("sinfo", "-N"))

    def call(self, *words: str, check: bool = True) -> str:
        # Daemons keep what they inherit open, so that nothing may be a pipe.
        answer = self.folder / "answer.txt"
        with open(answer, "w") as file:
            outcome = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=file,
                                  stderr=subprocess.STDOUT, timeout=PATIENCE_S)
        text = answer.read_text(errors="replace")
        if check and outcome.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: {text}")
        return text

    def start_controller(self, *options: str) -> None:
        self.call("slurmctld", *options)
        if not wait_for(lambda: "is UP" in self.call("scontrol", "ping", check=False)):
            raise RuntimeError("slurmctld does not answer")

    def start_node(self, node: str, *options: str) -> None:
        self.call("slurmd", "-N", node, *options)

    def kill_daemon(self, name: str) -> None:
        """`slurmctld`, or `slurmd.n1`: tasks go on without it."""
        file = self.folder / f"{name}.pid"
        process = int(file.read_text())
        os.kill(process, signal.SIGKILL)
        wait_for(lambda: not Path(f"/proc/{process}").exists())
        file.unlink(missing_ok=True)

    def lose_node(self, node: str) -> None:
        """The node with all that runs on it. Slurm is told at once, and not after a timeout."""
        self.kill_daemon("slurmd." + node)
        for process in self.processes(node):
            self.kill(process)
        self.call("scontrol", "update", f"nodename={node}", "state=down", "reason=lost")

    def bring_back(self, node: str) -> None:
        self.start_node(node)
        self.call("scontrol", "update", f"nodename={node}", "state=resume", check=False)

    @staticmethod
    def kill(process: int) -> None:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def processes(self, node: str = "", supervisors: bool = True) -> list[int]:
        """Those of tasks of this cluster, on all nodes or one, and what Slurm watches them with."""
        ours = f"SLURM_CONF={os.environ['SLURM_CONF']}".encode()
        there = f"SLURMD_NODENAME={node}".encode()
        found = set()
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                environment = (entry / "environ").read_bytes().split(b"\0")
                if ours not in environment:
                    continue
                if not any(word.startswith(there) for word in environment):
                    continue
                found.add(int(entry.name))
                parent = (entry / "stat").read_text().rsplit(")", 1)[1].split()[1]
                if supervisors and Path(f"/proc/{parent}/comm").read_text().startswith("slurmstepd"):
                    found.add(int(parent))
            except (OSError, IndexError):
                continue  # it has just ended
        return sorted(found)

    def tasks(self) -> list[str]:
        """Of all jobs: what waits or runs, "12_3"."""
        return self.call("squeue", "-h", "-r", "-o", "%i").split()

    def wait_until_empty(self, seconds: float = PATIENCE_S) -> bool:
        for _ in range(int(seconds / 20.0)):
            if wait_for(self._is_empty, 20.0):
                return True
            # A killed controller forgets jobs that ended just before; nodes that register anew
            # report them.
            self.call("scontrol", "reconfigure", check=False)
        return False

    def _is_empty(self) -> bool:
        for line in self.call("squeue", "-h", "-r", "-t", "PD", "-o", "%i %r").splitlines():
            task, _, reason = line.partition(" ")
            if reason == "BeginTime":  # two minutes of what was put into the queue again
                self.call("scontrol", "update", "JobId=" + task, "StartTime=now", check=False)
            elif "held" in reason:
                self.let_go(task)
        return not self.tasks()

    def let_go(self, task: str) -> None:
        """As an administrator does. A controller that was killed starts again what it had just
        started; the node knows the task already, and Slurm holds the task and drains the node."""
        self.held += 1
        self.call("scontrol", "release", task, check=False)
        for node in NODES:
            if "drain" in self.call("sinfo", "-h", "-n", node, "-o", "%T"):
                self.call("scontrol", "update", f"nodename={node}", "state=resume", check=False)

    def state(self) -> str:
        return self.call("squeue", check=False) + self.call("sinfo", "-N", "-l", check=False)

    def stop(self) -> None:
        for process in self.processes():
            self.kill(process)
        for name in ("slurmd.n1", "slurmd.n2", "slurmctld", "munge/"):
            file = self.folder / f"{name.rstrip('/')}{'/pid' if name.endswith('/') else '.pid'}"
            if file.exists():
                self.kill(int(file.read_text()))
