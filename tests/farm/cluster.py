# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A Slurm cluster on this machine, without systemd: munged, slurmctld and nodes that are slurmd
processes on loopback. For tests and for trying things out; docs/farm.md shows the same by hand."""
import os
import pathlib
import secrets
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "sinfo", "scancel", "srun")
LOOPBACK = "127.0.0.1"


def missing_programs():
    """Those of a cluster that are not installed; Debian has them in slurm-wlm and munge."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    return [name for name in PROGRAMS if shutil.which(name, path=path) is None]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for opened in sockets:
        opened.bind((LOOPBACK, 0))
    ports = [opened.getsockname()[1] for opened in sockets]
    for opened in sockets:
        opened.close()
    return ports


def wait_for(condition, what, seconds=120):
    """Until condition() is true; what it gave. The limit only ends tests that hang."""
    end = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"waited {seconds} s in vain for: {what}")
        time.sleep(0.05)


def stop(process, number=signal.SIGTERM, seconds=20):
    """Ends a process that we started."""
    if process.poll() is None:
        process.send_signal(number)
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


class Munge:
    """munged with a key of its own."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(mode=0o755)
        key = folder / "key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        self.socket = folder / "socket"
        self.process = subprocess.Popen(
            ["munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.socket}",
             f"--pid-file={folder / 'pid'}", f"--log-file={folder / 'log'}", f"--seed-file={folder / 'seed'}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment())
        wait_for(self.socket.exists, "munged's socket", 20)

    def stop(self):
        stop(self.process)


def environment(**more):
    variables = {name: value for name, value in os.environ.items()
                 if not name.startswith(("SLURM_", "SBATCH_", "SQUEUE_", "OCIO", "PM_"))}
    variables["PATH"] = variables.get("PATH", "") + ":/usr/sbin:/sbin"
    return dict(variables, **more)


class Cluster:
    """nodes: names; up: those that are started at once. All have this machine's processors, and run
    one task at a time when it asks for a whole node, as pm_host farm does."""

    def __init__(self, folder, nodes=("n1", "n2"), up=None, network=None, weights=()):
        """network: a Network of these nodes; None: all are on loopback. weights: of nodes, in their order;
        those with less come first."""
        self.folder = pathlib.Path(folder)
        assert " " not in str(folder), f"{folder}: slurm.conf can't have blanks in names"
        for name in ("state", "log"):
            (self.folder / name).mkdir(parents=True)
        self.nodes = tuple(nodes)
        self.network = network
        self.weights = dict(zip(nodes, weights))
        self.slurmds = {}
        self.controller = None
        self.munge = Munge(self.folder / "munge")
        try:
            self.begin(up)
        except BaseException:
            self.stop()
            raise

    def begin(self, up):
        self.conf = self.write_conf(self.folder / "slurm.conf", self.munge)
        self.start_controller()
        for name in self.nodes if up is None else up:
            self.start_node(name)
        wait_for(lambda: all(self.state_of(name) == "idle" for name in self.slurmds), "nodes that are idle")

    def write_conf(self, file, munge):
        if not hasattr(self, "ports"):
            self.ports = free_ports(1 + len(self.nodes))
        self.user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
        folder = self.folder
        controller = self.network.controller if self.network else LOOPBACK
        lines = [
            "ClusterName=pm", f"SlurmctldHost=localhost({controller})", f"SlurmctldPort={self.ports[0]}",
            f"AuthInfo=socket={munge.socket},cred_expire=5", f"SlurmUser={self.user}", f"SlurmdUser={self.user}",
            f"StateSaveLocation={folder / 'state'}", f"SlurmdSpoolDir={folder}/spool-%n",
            f"SlurmctldPidFile={folder / 'slurmctld.pid'}", f"SlurmdPidFile={folder}/%n.pid",
            f"SlurmctldLogFile={folder / 'log' / 'slurmctld'}", f"SlurmdLogFile={folder / 'log'}/%n",
            "ProctrackType=proctrack/linuxproc", "TaskPlugin=task/none", "MpiDefault=none",
            "SwitchType=switch/none", "ReturnToService=2", "SlurmdTimeout=6", "MessageTimeout=5", "KillWait=1",
            "SchedulerParameters=batch_sched_delay=0,bf_interval=1", "SelectType=select/cons_tres",
            "SelectTypeParameters=CR_Core", "PreemptType=preempt/partition_prio", "PreemptMode=REQUEUE",
            "PropagateResourceLimitsExcept=FSIZE", "PropagatePrioProcess=1",
        ]
        for name, port in zip(self.nodes, self.ports[1:]):
            address = self.network.address(name) if self.network else LOOPBACK
            lines.append(f"NodeName={name} NodeHostname=localhost NodeAddr={address} Port={port} "
                         f"CPUs={os.cpu_count()} RealMemory=500 Weight={self.weights.get(name, 1)} State=UNKNOWN")
        lines += ["PartitionName=render Nodes=ALL Default=YES MaxTime=INFINITE State=UP PriorityTier=1",
                  "PartitionName=urgent Nodes=ALL MaxTime=INFINITE State=UP PriorityTier=10"]
        file.write_text("\n".join(lines) + "\n")
        (file.parent / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n")
        return file

    def environment(self, **more):
        return environment(SLURM_CONF=str(self.conf), **more)

    def ask(self, *words):
        """What a command of Slurm prints; nothing where it fails."""
        done = subprocess.run(words, env=self.environment(), capture_output=True, text=True)
        return done.stdout if done.returncode == 0 else ""

    def start_controller(self):
        self.controller = subprocess.Popen(["slurmctld", "-D", "-f", str(self.conf)], env=self.environment(), cwd=self.folder,
                                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for(lambda: "UP" in self.ask("scontrol", "ping"), "slurmctld", 30)

    def start_node(self, name, *before):
        """before: a shell's commands that come first, as a limit."""
        (self.folder / f"spool-{name}").mkdir(exist_ok=True)
        inside = self.network.inside(name) + " " if self.network else ""
        command = "; ".join([*before, f'exec {inside}slurmd -D -N {name} -f "{self.conf}"'])
        self.slurmds[name] = subprocess.Popen(["sh", "-c", command], env=self.environment(), cwd=self.folder,
                                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def state_of(self, name):
        return self.ask("sinfo", "--noheader", "--Node", f"--nodes={name}", "--partition=render",
                        "--format=%t").strip()

    def resume_nodes(self):
        """What an administrator does after a fault."""
        for name in self.nodes:
            if any(word in self.state_of(name) for word in ("drain", "drng", "down")):
                self.ask("scontrol", "update", f"nodename={name}", "state=resume")

    def stop(self):
        for process in self.slurmds.values():
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
        if self.controller:
            self.ask("scancel", f"--user={self.user}")
        for process in self.slurmds.values():
            stop(process)
        if self.controller:
            stop(self.controller)
        self.munge.stop()
