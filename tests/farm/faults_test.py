#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A farm on Slurm survives faults: each test makes one, proves that it happened, and ends with the
bytes of a local render.

usage: faults_test.py PM_HOST [TEST...]

With PM_FARM=all in the environment all faults are tried, and one that can't be is a failure; else a
few, and without Slurm none (exit 77).
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from cluster import Cluster, Munge, missing_programs, wait_for
from job import SCENE, Farm, Job, children, is_alive, kill
from network import Network, can_make_networks

ALL = os.environ.get("PM_FARM") == "all"
# Some seconds a run, so that there is time for a fault; one thread each, as nodes share the machine.
OPTIONS = ("--size", "96x72", "--bucket-size", "16", "--passes", "24", "--photons", "20000", "--aa", "2:4",
           "--threads", "1")
RUNS = 4


def long_one(test):
    """Tried with PM_FARM=all only."""
    return unittest.skipUnless(ALL, "with PM_FARM=all")(test)


def can_mount():
    if os.geteuid() != 0 or shutil.which("mount") is None:
        return False
    with tempfile.TemporaryDirectory() as folder:
        if subprocess.run(["mount", "-t", "tmpfs", "none", folder], capture_output=True).returncode != 0:
            return False
        subprocess.run(["umount", folder], check=True)
    return True


class Faults(unittest.TestCase):
    nodes, up = ("n1", "n2"), None

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="pm farm ")
        cls.local = pathlib.Path(cls.shared.name) / "local.exr"
        subprocess.run([HOST, SCENE, *OPTIONS, "-o", cls.local, "-q"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm farm ", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.cluster = None

    def up_with(self, nodes=("n1", "n2"), up=None, **more):
        # slurm.conf can't have blanks in names, as the job's folder has them.
        folder = tempfile.TemporaryDirectory(prefix="pm_cluster.", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.cluster = Cluster(folder.name, nodes, up, **more)
        self.addCleanup(self.cluster.stop)
        return self.cluster

    def farm(self, *more, runs=RUNS):
        variables = self.cluster.environment(XDG_CACHE_HOME=str(self.folder / "cache"))
        farm = Farm(HOST, self.folder, variables, "slurm", [*OPTIONS, "--runs", str(runs), *more])
        self.addCleanup(lambda: farm.process and farm.process.poll() is None and farm.process.kill())
        return farm

    def keep_resuming(self):
        """An administrator who lets nodes back that Slurm has taken out."""
        done = threading.Event()
        def work():
            while not done.wait(0.5):
                self.cluster.resume_nodes()
        thread = threading.Thread(target=work)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(done.set)

    def assert_same_bytes(self, farm):
        code = farm.wait()
        self.assertEqual(code, 0, f"{farm.said()}\n{farm.job.attempts()}")
        self.assertTrue(farm.output.read_bytes() == self.local.read_bytes())
        self.assertIn("Machines", (farm.job.folder / "farm.html").read_text())

    def test_nothing_happens(self):
        self.up_with()
        farm = self.farm().start()
        self.assert_same_bytes(farm)
        attempts = farm.job.attempts()
        self.assertEqual({a.machine for a in attempts}, {"n1", "n2"})
        self.assertEqual([a.code for a in attempts], [0] * (RUNS + 1))

    @long_one
    def test_near_nodes_come_first(self):
        self.up_with(weights=(10, 1))
        farm = self.farm().start()
        self.assert_same_bytes(farm)
        first = min(farm.job.attempts(), key=lambda attempt: attempt.start)
        self.assertEqual((first.task, first.machine), (1, "n2"), "photons are alone, on the nearest")

    def test_task_is_killed(self):
        self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run()
        kill(children(victim.process)[:-1], signal.SIGKILL)
        self.assert_same_bytes(farm)
        its = [a for a in farm.job.attempts() if a.task == victim.task]
        self.assertEqual(its[0].code, 128 + signal.SIGKILL)
        self.assertEqual(its[-1].code, 0)
        self.assertIn("exit 137", farm.said())

    def test_task_is_killed_with_all_that_is_around_it(self):
        self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run()
        kill([victim.process, *children(victim.process)], signal.SIGKILL)
        self.assert_same_bytes(farm)
        its = [a for a in farm.job.attempts() if a.task == victim.task]
        self.assertIsNone(its[0].end)
        self.assertGreaterEqual(len(its), 2)

    def test_parts_are_corrupt_and_truncated(self):
        self.up_with()
        farm = self.farm().start()
        first, second = wait_for(lambda: len(farm.job.parts()) >= 2 and farm.job.parts()[:2], "two parts")
        data = bytearray(first.read_bytes())
        data[len(data) // 2] ^= 1
        first.write_bytes(data)
        os.truncate(second, second.stat().st_size // 2)
        self.assert_same_bytes(farm)
        for part in (first, second):
            self.assertIn(f"{part.name}: the part is", farm.said())
            starts = [a for a in farm.job.attempts() if a.task == int(part.stem)]
            self.assertEqual([a.code for a in starts], [0, 0])

    def test_foreign_key_is_refused(self):
        cluster = self.up_with(up=("n1",))
        foreign = Munge(cluster.folder / "foreign")
        self.addCleanup(foreign.stop)
        (cluster.folder / "other").mkdir()
        conf = cluster.write_conf(cluster.folder / "other" / "slurm.conf", foreign)
        farm = self.farm()
        ours = farm.variables
        farm.variables = dict(ours, SLURM_CONF=str(conf))
        self.assertEqual(farm.start().wait(), 2, farm.said())
        self.assertIn("--engine slurm: sinfo", farm.said())
        self.assertEqual(farm.job.attempts(), [])
        # Nor may a machine with another key join.
        with open(self.folder / "stranger", "w") as log:
            stranger = subprocess.Popen(["slurmd", "-D", "-N", "n2", "-f", str(conf)], stdout=log, stderr=log,
                                        env=dict(cluster.environment(), SLURM_CONF=str(conf)))
        log = cluster.folder / "log" / "slurmctld"
        wait_for(lambda: "MESSAGE_NODE_REGISTRATION_STATUS" in log.read_text(), "a refusal of the stranger")
        self.assertIn("Invalid credential", log.read_text())
        farm.variables = ours
        farm.start()
        self.assert_same_bytes(farm)
        stranger.kill()
        stranger.wait()
        self.assertEqual({a.machine for a in farm.job.attempts()}, {"n1"})

    def test_run_is_rendered_twice_at_once(self):
        self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run()
        twin = subprocess.run(["sh", farm.job.folder / "run.sh", str(victim.task)],
                              env=dict(farm.variables, SLURMD_NODENAME="by-hand"), capture_output=True)
        self.assertEqual(twin.returncode, 0)
        self.assert_same_bytes(farm)
        its = {a.machine: a for a in farm.job.attempts() if a.task == victim.task}
        one, other = its[victim.machine], its["by-hand"]
        self.assertEqual((one.code, other.code), (0, 0))
        self.assertLess(max(one.start, other.start), min(one.end, other.end), "they were at once")

    @long_one
    def test_slurmd_is_killed(self):
        cluster = self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run("n2")
        cluster.slurmds["n2"].kill()
        cluster.slurmds["n2"].wait()
        # Slurm marks with a star who does not respond.
        is_gone = lambda: "*" in cluster.state_of("n2") or "down" in cluster.state_of("n2")
        wait_for(lambda: is_gone() or farm.process.poll() is not None, "n2 to be missed")
        self.assertTrue(is_gone())
        cluster.start_node("n2")
        self.assert_same_bytes(farm)
        self.assertIn("n2 now responding", (cluster.folder / "log" / "slurmctld").read_text())
        self.assertTrue(any(a.task == victim.task for a in farm.job.attempts()))

    @long_one
    def test_node_is_cut_off(self):
        if not can_make_networks():
            return self.node_stands_still()  # as it looks from elsewhere
        network = Network(self.nodes)
        self.addCleanup(network.remove)
        cluster = self.up_with(network=network)
        farm = self.farm().start()
        victim = farm.job.wait_for_run("n2")
        network.pull("n2")
        # Its disk would be away as well, and who writes to it would stand still.
        kill(children(victim.process), signal.SIGSTOP)
        again = lambda: [a for a in farm.job.attempts() if a.task == victim.task and a.machine == "n1"]
        wait_for(again, "the task on n1")
        network.plug_in("n2")
        kill(children(victim.process), signal.SIGCONT)
        self.assert_same_bytes(farm)
        self.assertIn("not responding", (cluster.folder / "log" / "slurmctld").read_text())

    @long_one
    def test_node_stands_still(self):
        self.node_stands_still()

    def node_stands_still(self):
        cluster = self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run("n2")
        # Nothing of it answers, and its task goes on, until long after it was given to another.
        slurmd = cluster.slurmds["n2"]
        stepd = int(pathlib.Path(f"/proc/{victim.process}/stat").read_text().rpartition(")")[2].split()[1])
        kill([slurmd.pid, stepd, *children(victim.process)], signal.SIGSTOP)
        again = lambda: [a for a in farm.job.attempts() if a.task == victim.task and a.machine == "n1"]
        wait_for(again, "the task on n1")
        kill([*children(victim.process), stepd, slurmd.pid], signal.SIGCONT)
        self.assert_same_bytes(farm)
        self.assertIn("not responding", (cluster.folder / "log" / "slurmctld").read_text())

    @long_one
    def test_late_joiner(self):
        cluster = self.up_with(up=("n1",))
        farm = self.farm().start()
        farm.job.wait_for_run("n1")
        self.assertEqual({a.machine for a in farm.job.attempts()}, {"n1"})
        cluster.start_node("n2")
        self.assert_same_bytes(farm)
        self.assertIn("n2", {a.machine for a in farm.job.attempts() if a.code == 0})

    @long_one
    def test_early_leaver(self):
        cluster = self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run("n2")
        # The power goes off.
        slurmd = cluster.slurmds.pop("n2")
        stepd = int(pathlib.Path(f"/proc/{victim.process}/stat").read_text().rpartition(")")[2].split()[1])
        kill([slurmd.pid, stepd, *children(victim.process)], signal.SIGKILL)
        slurmd.wait()
        self.assert_same_bytes(farm)
        its = [a for a in farm.job.attempts() if a.task == victim.task]
        self.assertIsNone(its[0].end)
        self.assertEqual(its[-1].machine, "n1")
        self.assertIn(its[-1].code, (0, None))  # its part may come just before its end is noted
        self.assertIn("down", cluster.state_of("n2"))

    @long_one
    def test_preempted_every_few_seconds(self):
        cluster = self.up_with()
        farm = self.farm().start()
        farm.job.wait_for_run()
        for _ in range(3):
            cluster.ask("sbatch", "--parsable", "--partition=urgent", "--exclusive", "--nodes=2",
                        "--output=/dev/null", "--wrap", "sleep 1")
            time.sleep(3)
        self.assert_same_bytes(farm)
        self.assertGreater(len(farm.job.attempts()), RUNS + 1)
        self.assertIn("preempt", (cluster.folder / "log" / "slurmctld").read_text().lower())

    @long_one
    def test_controller_is_terminated(self):
        cluster = self.up_with()
        farm = self.farm().start()
        farm.job.wait_for_run()
        cluster.controller.terminate()
        cluster.controller.wait()
        wait_for(lambda: "does not answer" in farm.said(), "the farm to see it")
        cluster.start_controller()
        self.assert_same_bytes(farm)

    @long_one
    def test_controller_is_killed(self):
        cluster = self.up_with()
        farm = self.farm().start()
        farm.job.wait_for_run()
        cluster.controller.kill()
        cluster.controller.wait()
        wait_for(lambda: "does not answer" in farm.said(), "the farm to see it")
        cluster.start_controller()
        self.keep_resuming()
        self.assert_same_bytes(farm)

    @long_one
    @unittest.skipUnless(can_mount(), "nothing can be mounted")
    def test_disk_is_full(self):
        self.up_with()
        parts = self.folder / "job" / "parts"
        parts.mkdir(parents=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", parts], check=True)
        self.addCleanup(lambda: subprocess.run(["umount", parts], check=True))
        farm = self.farm("--tries", "9").start()
        wait_for(lambda: any(a.code == 4 for a in farm.job.attempts()), "a full disk")
        self.assertEqual(list(parts.iterdir()), farm.job.parts(), "no temporary file is left")
        subprocess.run(["mount", "-o", "remount,size=64m", parts], check=True)
        self.assert_same_bytes(farm)
        self.assertIn("No space left", "".join(farm.job.log(a.task) for a in farm.job.attempts()))

    @long_one
    def test_disk_of_one_node_is_full(self):
        cluster = self.up_with(up=("n1",))
        cluster.start_node("n2", "ulimit -f 200")  # blocks of 512 bytes: no file may be longer
        wait_for(lambda: cluster.state_of("n2") == "idle", "n2")
        farm = self.farm().start()
        self.assert_same_bytes(farm)
        failed = [a for a in farm.job.attempts() if a.code == 4]
        self.assertEqual({a.machine for a in failed}, {"n2"}, farm.job.attempts())

    @long_one
    def test_submitter_is_killed(self):
        self.up_with()
        farm = self.farm().start()
        farm.job.wait_for_run()
        farm.process.kill()
        farm.wait()
        self.assertFalse(farm.output.exists())
        farm.start()
        self.assert_same_bytes(farm)
        self.assertEqual([a.code for a in farm.job.attempts()], [0] * (RUNS + 1), "nothing was started twice")

    @long_one
    def test_submitter_is_interrupted(self):
        cluster = self.up_with()
        farm = self.farm().start()
        victim = farm.job.wait_for_run()
        farm.process.send_signal(signal.SIGINT)
        self.assertEqual(farm.wait(), 130)
        wait_for(lambda: not cluster.ask("squeue", "--noheader").strip(), "an empty queue")
        wait_for(lambda: not is_alive(victim.process), "the task to end")
        self.assertFalse(farm.output.exists())
        farm.start()
        self.assert_same_bytes(farm)


if __name__ == "__main__":
    HOST = pathlib.Path(sys.argv.pop(1)).resolve()
    if missing_programs():
        print("not tried: Slurm is not installed: " + " ".join(missing_programs()))
        sys.exit(1 if ALL else 77)
    result = unittest.main(exit=False, verbosity=2).result
    if ALL and result.skipped:
        print("skipped where all faults were to be tried:", *(str(test) for test, _ in result.skipped))
    sys.exit(0 if result.wasSuccessful() and not (ALL and result.skipped) else 1)
