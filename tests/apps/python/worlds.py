"""Worlds that several tests of the Python module share, and the program to compare with."""

import json
import os
import subprocess
import tempfile

import numpy as np

import clearway as cw


def run(*arguments):
    """Exit status and output of the command line program."""
    done = subprocess.run([os.environ["CLEARWAY_BINARY"], *map(str, arguments)], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def answer(*arguments):
    """The one JSON object that the program prints."""
    status, out, err = run(*arguments, "--json")
    if status not in (0, 1):
        raise AssertionError(f"clearway {arguments} ended with {status}: {err}")
    return json.loads(out)


def pose(x=0.0, y=0.0, z=0.0, turn=0.0):
    """Turned about z, then moved."""
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    matrix[:3, 3] = [x, y, z]
    return matrix


def scanned_room(resolution=0.05, seed=1):
    """A map with paint, free voxels, obstacles and conflicts."""
    dice = np.random.default_rng(seed)
    fused = cw.FreeSpaceMap(resolution=resolution)
    volume = fused.add_volume("stroke", ["tool"])
    fused.paint(volume, dice.uniform(-0.6, 0.6, (12, 3)), dice.uniform(0.15, 0.3, 12))
    for turn in (0.0, 2.0, 4.0):
        directions = dice.normal(size=(1500, 3)) + [2.0, 0.0, 0.0]
        cloud = 1.2 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
        fused.insert(cloud, pose(0.1, 0.05, 0.02, turn), time=turn)
    return fused


def arcs(resolution=0.03):
    """A PUMA 560 with paint where its tool goes, and a pillar in it: that of the C++ example."""
    robot = cw.load_robot("puma560")
    turns = np.arange(-0.7, 0.71, 0.02)
    configurations = np.tile([0.0, -0.8, 0.3, 0.0, 0.4, 0.0], (len(turns), 1))
    configurations[:, 0] = turns
    tips = robot.tip_poses(configurations)[:, :3, 3]
    fused = cw.FreeSpaceMap(resolution=resolution)
    volume = fused.add_volume("arcs", robot.critical_parts)
    fused.paint(volume, tips, 0.22)
    fused.paint(volume, tips + [0.0, 0.0, 0.25], 0.22)
    top = robot.tip_pose(configurations[35])[:3, 3]
    y, z = np.meshgrid(np.arange(-1.5, 1.51, 0.03), np.arange(-0.5, 2.01, 0.03))
    wall = np.column_stack([np.full(y.size, -3.0), y.ravel(), z.ravel() - 0.8])
    heights = np.arange(0.0, top[2], 0.01)
    pillar = np.column_stack([np.full_like(heights, top[0] - 2.0), np.zeros_like(heights), heights - 0.8])
    fused.insert(np.vstack([wall, pillar]), pose(2.0, 0.0, 0.8))
    return robot, fused.snapshot(), configurations[5], configurations[-6]


def folder():
    return tempfile.TemporaryDirectory(prefix="clearway_python_")


def text(q):
    """A configuration as a flag has it, every bit of it."""
    return ",".join(map(repr, np.asarray(q).tolist()))


def without_times(plan):
    """A plan without what a clock measured."""
    plan = json.loads(json.dumps(plan))
    for part in (plan, *plan["legs"]):
        for name in [name for name in part if name.endswith("time_s") or name.endswith("cpu_s")]:
            del part[name]
    return plan
