# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A network of this machine's own for a cluster: each node in a network namespace, all on a bridge, so that a
cable can be pulled. For root only."""
import os
import shutil
import subprocess


def ip(*words, check=True):
    return subprocess.run(["ip", *words], check=check, capture_output=True, text=True)


def can_make_networks():
    if os.geteuid() != 0 or shutil.which("ip") is None:
        return False
    name = f"pm{os.getpid()}t"
    if ip("netns", "add", name, check=False).returncode != 0:
        return False
    ip("netns", "del", name)
    if ip("link", "add", name, "type", "bridge", check=False).returncode != 0:
        return False
    ip("link", "del", name)
    return True


class Network:
    """Addresses: 10.77.N.1 of this machine, which the controller has, and 10.77.N.2 and so on of nodes."""

    def __init__(self, nodes):
        self.nodes = tuple(nodes)
        self.name = f"pm{os.getpid() % 100000}"
        self.subnet = f"10.77.{os.getpid() % 250}"
        try:
            self.lay()
        except subprocess.CalledProcessError as fault:
            self.remove()
            raise AssertionError(f"{' '.join(fault.cmd)}: {fault.stderr}") from None

    def lay(self):
        bridge = self.name + "b"
        ip("link", "add", bridge, "type", "bridge")
        ip("address", "add", self.controller + "/24", "dev", bridge)
        ip("link", "set", bridge, "up")
        for node in self.nodes:
            space = self.space(node)
            ip("netns", "add", space)
            ip("link", "add", self.cable(node), "type", "veth", "peer", "name", "eth0", "netns", space)
            ip("link", "set", self.cable(node), "master", bridge, "up")
            ip("-n", space, "address", "add", self.address(node) + "/24", "dev", "eth0")
            for device in ("lo", "eth0"):
                ip("-n", space, "link", "set", device, "up")

    @property
    def controller(self):
        return self.subnet + ".1"

    def address(self, node):
        return f"{self.subnet}.{self.nodes.index(node) + 2}"

    def space(self, node):
        return f"{self.name}-{node}"

    def cable(self, node):
        return f"{self.name}v{self.nodes.index(node)}"

    def inside(self, node):
        """What a command in the namespace of a node begins with."""
        return f"ip netns exec {self.space(node)}"

    def pull(self, node):
        ip("link", "set", self.cable(node), "down")

    def plug_in(self, node):
        ip("link", "set", self.cable(node), "up")

    def remove(self):
        for node in self.nodes:
            ip("link", "del", self.cable(node), check=False)
            ip("netns", "del", self.space(node), check=False)
        ip("link", "del", self.name + "b", check=False)
