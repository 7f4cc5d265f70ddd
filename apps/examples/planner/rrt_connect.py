#!/usr/bin/env python3
"""A planner of your own beside Clearway's (apps/compare/YOUR_PLANNER.md): RRT-Connect over the robot's spheres.

clearway compare quick --planners rrtconnect,mine --external "mine=python3 apps/examples/planner/rrt_connect.py"
"""
import itertools
import json
import sys
import time

import numpy as np


class Region:
    """Voxels as a grid of bits: those that block, or all but those that are free."""

    def __init__(self, region, edge):
        self.edge, self.otherwise = edge, "free" in region
        cubes = np.array(region.get("blocked", region.get("free"))).reshape(-1, 4)
        lows = np.rint((cubes[:, :3] - cubes[:, 3:] / 2) / edge).astype(int)
        sizes = np.rint(cubes[:, 3] / edge).astype(int)
        self.low = lows.min(axis=0, initial=0)
        self.blocked = np.full((lows + sizes[:, None]).max(axis=0, initial=1) - self.low, self.otherwise)
        for (x, y, z), n in zip(lows - self.low, sizes):
            self.blocked[x : x + n, y : y + n, z : z + n] = not self.otherwise

    def is_met(self, centers, radii):
        reach = int(np.ceil(radii.max() / self.edge))
        near = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 3), axis=-1).reshape(-1, 3)
        cells = np.floor(centers / self.edge).astype(int)[:, None, :] + near
        gaps = np.abs(centers[:, None, :] - (cells + 0.5) * self.edge) - self.edge / 2
        cells = cells[np.linalg.norm(np.maximum(gaps, 0.0), axis=2) <= radii[:, None]] - self.low
        inside = ((cells >= 0) & (cells < self.blocked.shape)).all(axis=1)
        return (self.otherwise and not inside.all()) or self.blocked[tuple(cells[inside].T)].any()


class World:
    """Kinematics and free space, from what the first line says."""

    def __init__(self, world):
        robot = world["robot"]
        self.base, self.joints, self.links = np.array(robot["map_from_base"]), robot["joints"], robot["links"]
        for link in self.links:
            link["parent_from_link"] = np.array(link["parent_from_link"])
        limit = lambda joint, key, otherwise: otherwise if joint[key] is None else joint[key]
        self.low = np.array([limit(joint, "lower", -np.pi) for joint in self.joints])
        self.high = np.array([limit(joint, "upper", np.pi) for joint in self.joints])
        regions = {part: Region(r, world["resolution"]) for r in world["regions"] for part in r["parts"]}
        self.bodies = []  # those that joints move: link, centres, radii, and what is in the way
        for body in robot["bodies"]:
            spheres = np.array(body["spheres"])
            if self.is_moved(body["link"]):
                radii = spheres[:, 3] + world["padding"]
                self.bodies.append((body["link"], spheres[:, :3], radii, regions[body["part"]]))

    def is_moved(self, link):
        while link >= 0 and self.links[link]["joint"] < 0:
            link = self.links[link]["parent"]
        return link >= 0

    def poses(self, q):
        poses = []
        for link in self.links:
            pose = (self.base if link["parent"] < 0 else poses[link["parent"]]) @ link["parent_from_link"]
            if link["joint"] >= 0:
                joint, value = self.joints[link["joint"]], link["multiplier"] * q[link["joint"]] + link["offset"]
                motion, axis = np.eye(4), np.array(link["axis"])
                if joint["type"] == "prismatic":
                    motion[:3, 3] = value * axis
                else:
                    cross = np.cross(np.eye(3), axis)  # cross @ v is axis x v
                    motion[:3, :3] += np.sin(value) * cross + (1 - np.cos(value)) * cross @ cross
                pose = pose @ motion
            poses.append(pose)
        return poses

    def is_free(self, q):  # of other bodies of the robot it knows nothing: the check does
        poses = self.poses(q)
        return not any(region.is_met(centers @ poses[link][:3, :3].T + poses[link][:3, 3], radii)
                       for link, centers, radii, region in self.bodies)

    def is_edge_free(self, a, b, step=0.05):
        count = max(int(np.abs(b - a).max() / step), 1)
        return all(self.is_free(a + (b - a) * i / count) for i in range(1, count + 1))


def grow(world, tree, target, reach=0.5):
    near = min(range(len(tree)), key=lambda i: np.linalg.norm(tree[i][0] - target))
    way = target - tree[near][0]
    q = tree[near][0] + way * min(1.0, reach / max(np.linalg.norm(way), 1e-12))
    if not world.is_edge_free(tree[near][0], q):
        return None
    tree.append((q, near))
    return q


def branch(tree, i=-1):
    path = [tree[i][0]]
    while tree[i][1] is not None:
        i = tree[i][1]
        path.append(tree[i][0])
    return path


def plan(world, query):
    random, until = np.random.default_rng(query["seed"]), time.monotonic() + 0.9 * query.get("time_limit", 60.0)
    trees = [[(np.array(query[end]), None)] for end in ("start", "goal")]
    for turn in itertools.takewhile(lambda _: time.monotonic() < until, itertools.count()):
        one, other = trees[turn % 2], trees[1 - turn % 2]
        q = grow(world, one, random.uniform(world.low, world.high))
        while q is not None and (met := grow(world, other, q)) is not None:
            if np.array_equal(met, q):
                path = branch(one)[::-1] + branch(other)[1:]
                return {"path": [list(p) for p in (path if turn % 2 == 0 else path[::-1])]}
    return {"failed": "the trees did not meet in time"}


world = None
for line in sys.stdin:
    message = json.loads(line)
    if "world" in message:
        world = World(message["world"])
        answer = {"ready": True}
    else:
        answer = plan(world, message["query"])
    print(json.dumps(answer), flush=True)
