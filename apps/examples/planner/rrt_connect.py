#!/usr/bin/env python3
"""A planner of your own beside Clearway's (apps/compare/YOUR_PLANNER.md): RRT-Connect over the robot's spheres.

clearway compare quick --planners rrtconnect,mine --external "mine=python3 apps/examples/planner/rrt_connect.py"

Python is slow call by call: so all configurations of an edge go through NumPy at once, and what blocks is looked up in
a grid that knows the nearest blocked voxel of each voxel.
"""
import itertools
import json
import sys
import time

import numpy as np

STEP = 0.05  # rad or m between the configurations of an edge that are looked at
MARGIN = 1.0  # rad or m about the box of start and goal, from which most samples are drawn
SHARE = 0.8  # of the samples that are


def nearest_blocked(blocked, most):
    """Of each voxel the place of the nearest blocked one in the flattened grid; -1: none is within `most` voxels."""
    distance = np.where(blocked, 0, 3 * (most + 1) ** 2).astype(np.int32)  # squared
    nearest = np.where(blocked, np.arange(blocked.size).reshape(blocked.shape), -1).astype(np.int32)
    for axis in range(3):  # a step along this axis, then what is the nearest from there along those before
        before, known = np.moveaxis(distance, axis, 0), np.moveaxis(nearest, axis, 0)
        least, best = before.copy(), known.copy()
        for step in range(1, most + 1):
            ahead, behind = slice(step, None), slice(None, -step)
            for here, there in ((ahead, behind), (behind, ahead)):
                steps = before[there] + step**2
                nearer = steps < least[here]
                np.copyto(least[here], steps, where=nearer)
                np.copyto(best[here], known[there], where=nearer)
        distance, nearest = np.moveaxis(least, 0, axis), np.moveaxis(best, 0, axis)
    return nearest


class Region:
    """Voxels that some parts must keep clear of: those that block, or all but those that are free."""

    def __init__(self, region, edge, reach):
        self.edge, all_blocked = edge, "free" in region
        cubes = np.array(region["free" if all_blocked else "blocked"]).reshape(-1, 4)
        lows = np.rint((cubes[:, :3] - cubes[:, 3:] / 2) / edge).astype(int)
        sizes = np.rint(cubes[:, 3] / edge).astype(int)
        most = int(np.ceil(reach / edge)) + 1  # voxels that matter, and of the rim about the grid
        self.low = lows.min(axis=0, initial=0) - most
        blocked = np.full((lows + sizes[:, None]).max(axis=0, initial=1) + most - self.low, all_blocked)
        for (x, y, z), n in zip(lows - self.low, sizes):
            blocked[x : x + n, y : y + n, z : z + n] = not all_blocked
        self.nearest, self.beyond = nearest_blocked(blocked, most), 0.0 if all_blocked else np.inf

    def clearances(self, points):
        """Distances of points (..., 3) to the nearest voxel that blocks; infinite where none is near."""
        cells = np.floor(points / self.edge).astype(int) - self.low
        inside = ((cells >= 0) & (cells < self.nearest.shape)).all(axis=-1)
        place = np.full(inside.shape, -1)
        place[inside] = self.nearest[tuple(cells[inside].T)]
        blocked = np.stack(np.unravel_index(np.maximum(place, 0), self.nearest.shape), axis=-1) + self.low
        gaps = np.abs(points - (blocked + 0.5) * self.edge) - self.edge / 2
        distances = np.where(place < 0, np.inf, np.linalg.norm(np.maximum(gaps, 0.0), axis=-1))
        return np.where(inside, distances, self.beyond)


class World:
    """Kinematics and free space, from what the first line says."""

    def __init__(self, world):
        robot = world["robot"]
        self.base, self.joints, self.links = np.array(robot["map_from_base"]), robot["joints"], robot["links"]
        limit = lambda joint, key, otherwise: otherwise if joint[key] is None else joint[key]
        self.low = np.array([limit(joint, "lower", -np.pi) for joint in self.joints])
        self.high = np.array([limit(joint, "upper", np.pi) for joint in self.joints])
        bodies = robot["bodies"]
        body = np.repeat(np.arange(len(bodies)), [len(b["spheres"]) for b in bodies])  # of each sphere
        spheres = np.array([sphere for b in bodies for sphere in b["spheres"]])
        self.link, self.centers, self.radii = np.array([b["link"] for b in bodies])[body], spheres[:, :3], spheres[:, 3]
        self.padding = world["padding"]
        moved = np.array([self.is_moved(b["link"]) for b in bodies])
        self.regions = []  # each with the spheres that keep clear of it: those that joints move
        for region in world["regions"]:
            own = moved & [b["part"] in region["parts"] for b in bodies]
            reach = self.radii.max() + self.padding
            self.regions.append((Region(region, world["resolution"], reach), np.flatnonzero(own[body])))
        tested = set(itertools.combinations(range(len(bodies)), 2)) - {tuple(sorted(p)) for p in robot["may_touch"]}
        pairs = [(i, j) for i, j in itertools.combinations(range(len(body)), 2) if (body[i], body[j]) in tested]
        self.one, self.other = np.array(pairs, int).reshape(-1, 2).T

    def is_moved(self, link):
        while link >= 0 and self.links[link]["joint"] < 0:
            link = self.links[link]["parent"]
        return link >= 0

    def poses(self, qs):
        """map_from_link of all links at n configurations: (links, n, 4, 4)."""
        poses = []
        for link in self.links:
            pose = (self.base if link["parent"] < 0 else poses[link["parent"]]) @ np.array(link["parent_from_link"])
            if link["joint"] >= 0:
                axis, values = np.array(link["axis"]), link["multiplier"] * qs[:, link["joint"]] + link["offset"]
                motion = np.tile(np.eye(4), (len(qs), 1, 1))
                if link["type"] == "prismatic":
                    motion[:, :3, 3] = values[:, None] * axis
                else:
                    cross, turn = np.cross(np.eye(3), axis), values[:, None, None]  # cross @ v is axis x v
                    motion[:, :3, :3] += np.sin(turn) * cross + (1 - np.cos(turn)) * (cross @ cross)
                pose = pose @ motion
            poses.append(np.broadcast_to(pose, (len(qs), 4, 4)))
        return np.array(poses)

    def clearances(self, qs):
        """Of n configurations how far the spheres are from what they may not touch; below 0: how deep they are in."""
        poses = self.poses(qs)[self.link]
        centers = np.einsum("snij,sj->nsi", poses[..., :3, :3], self.centers) + poses[..., :3, 3].swapaxes(0, 1)
        gaps = [region.clearances(centers[:, own]) - self.radii[own] - self.padding for region, own in self.regions]
        apart = np.linalg.norm(centers[:, self.one] - centers[:, self.other], axis=2)
        gaps.append(apart - self.radii[self.one] - self.radii[self.other])
        return np.concatenate(gaps, axis=1).min(axis=1, initial=np.inf)


class Tree:
    def __init__(self, root):
        self.nodes, self.parents = root[None], [None]

    def nearest(self, q):
        return int(np.argmin(((self.nodes - q) ** 2).sum(axis=1)))

    def add(self, q, parent):
        self.nodes = np.vstack([self.nodes, q])
        self.parents.append(parent)

    def branch(self):
        """From the root to the last node."""
        path, at = [], len(self.parents) - 1
        while at is not None:
            path.append(self.nodes[at])
            at = self.parents[at]
        return path[::-1]


class RrtConnect:
    def __init__(self, world, query):
        self.world, self.random = world, np.random.default_rng(query["seed"])
        self.start, self.goal = np.array(query["start"]), np.array(query["goal"])
        # Both ends are free, and spheres are larger than the bodies in them: they may be in as deep as there.
        self.least = min(0.0, *world.clearances(np.array([self.start, self.goal]))) - 1e-9
        self.until = time.monotonic() + 0.9 * query.get("time_limit", 60.0)

    def way(self, a, b):
        """Where one gets on the straight way from a to b, and whether that is b."""
        count = max(int(np.ceil(np.abs(b - a).max() / STEP)), 1)
        qs = a + (b - a) * np.linspace(0.0, 1.0, count + 1)[:, None]
        blocked = np.flatnonzero(self.world.clearances(qs[1:]) < self.least)
        return (b, True) if len(blocked) == 0 else (qs[blocked[0]], False)

    def grow(self, tree, target):
        """Goes from the nearest node towards the target; whether it gets on at all, and there."""
        near = tree.nearest(target)
        q, is_there = self.way(tree.nodes[near], target)
        has_moved = not np.array_equal(q, tree.nodes[near])
        if has_moved:
            tree.add(q, near)
        return has_moved, is_there

    def sample(self):
        low, high = self.world.low, self.world.high
        if self.random.random() < SHARE:
            low = np.maximum(low, np.minimum(self.start, self.goal) - MARGIN)
            high = np.minimum(high, np.maximum(self.start, self.goal) + MARGIN)
        return self.random.uniform(low, high)

    def shortened(self, path, tries=50):
        for _ in range(tries):
            i, j = sorted(self.random.integers(len(path), size=2))
            if j > i + 1 and time.monotonic() < self.until and self.way(path[i], path[j])[1]:
                path = path[: i + 1] + path[j:]
        return path

    def path(self):
        trees = [Tree(self.start), Tree(self.goal)]
        for turn in itertools.count():
            one, other = trees[turn % 2], trees[1 - turn % 2]
            if self.grow(one, self.sample())[0] and self.grow(other, one.nodes[-1])[1]:
                to_meeting, from_meeting = (tree.branch() for tree in trees)
                return self.shortened(to_meeting + from_meeting[-2::-1])
            if time.monotonic() > self.until:
                return None


def main():
    world = None
    for line in sys.stdin:
        message = json.loads(line)
        if "world" in message:
            world = World(message["world"])
            answer = {"ready": True}
        else:
            path = RrtConnect(world, message["query"]).path()
            answer = {"path": [list(q) for q in path]} if path else {"failed": "the trees did not meet in time"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
