"""Maps from Python, against NumPy's brute force and the command line program."""

import gc
import hashlib
import json
import pathlib
import threading
import unittest
import warnings

import numpy as np

import clearway as cw
import worlds


def middles(states, low, edge):
    """Middles of the voxels of a grid, (x, y, z, 3)."""
    return low + (np.stack(np.meshgrid(*map(np.arange, states.shape), indexing="ij"), axis=-1) + 0.5) * edge


def cube_distances(points, centers, edge):
    """From each point to the nearest of the cubes."""
    away = np.maximum(np.abs(points[:, None, :] - centers[None, :, :]) - edge / 2, 0.0)
    return np.linalg.norm(away, axis=2).min(axis=1)


class Painting(unittest.TestCase):
    def test_a_voxel_is_painted_when_it_lies_wholly_inside_a_sphere(self):
        dice = np.random.default_rng(7)
        centers, radii = dice.uniform(-0.5, 0.5, (9, 3)), dice.uniform(0.11, 0.33, 9)
        fused = cw.FreeSpaceMap(resolution=0.05)
        counts = fused.paint(fused.add_volume("v", []), centers, radii)
        states, low = fused.snapshot().states_in([[-1, -1, -1], [1, 1, 1]])
        away = np.abs(middles(states, low, 0.05)[..., None, :] - centers) + 0.025  # to the farthest corner
        inside = (np.linalg.norm(away, axis=-1) <= radii).any(axis=-1)
        np.testing.assert_array_equal(states == cw.VoxelState.painted, inside)
        self.assertEqual(counts.newly, inside.sum())
        self.assertEqual(fused.snapshot().counts().painted, inside.sum())

    def test_poses_printed_with_few_decimals_are_those_that_they_mean(self):
        turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
        pose = np.eye(4)
        pose[:3, :3] = turn @ turn
        cloud = np.array([[1.0, 0.2, 0.3]])
        for decimals in (15, 5, 4):
            fused = cw.FreeSpaceMap(resolution=0.05)
            self.assertEqual(fused.insert(cloud, np.round(pose, decimals)).inserted, 1)
            self.assertEqual(fused.snapshot().state(pose[:3, :3] @ cloud[0]), cw.VoxelState.occupied)
        with self.assertRaisesRegex(ValueError, "orthonormal within 1e-3"):
            fused.insert(cloud, np.round(pose, 2))

    def test_many_spheres_are_as_one_after_the_other(self):
        dice = np.random.default_rng(8)
        centers, radii = dice.uniform(-0.5, 0.5, (6, 3)), dice.uniform(0.1, 0.3, 6)
        at_once, in_turn = cw.FreeSpaceMap(), cw.FreeSpaceMap()
        many = at_once.paint(at_once.add_volume("v", ["tool"]), centers, radii, np.arange(6))
        volume = in_turn.add_volume("v", ["tool"])
        each = [in_turn.paint(volume, c, r, float(t)) for t, (c, r) in enumerate(zip(centers, radii))]
        self.assertEqual(many.newly, sum(counts.newly for counts in each))
        self.assertEqual(at_once.snapshot().difference(in_turn.snapshot())["states"], {})
        painted = at_once.snapshot().volumes[0]
        np.testing.assert_array_equal(painted.centers, centers)
        np.testing.assert_array_equal(painted.radii, radii)
        np.testing.assert_array_equal(painted.times, np.arange(6))
        inside = (np.linalg.norm(centers[:, None] - centers[None], axis=2) <= radii).any(axis=1)
        np.testing.assert_array_equal(painted.contains(centers), inside)

    def test_a_stroke_is_undone(self):
        fused = cw.FreeSpaceMap()
        volume = fused.add_volume("v", [])
        fused.paint(volume, [0, 0, 0], 0.2)
        before = fused.snapshot()
        number = fused.begin_stroke("again", "somebody")
        fused.paint(volume, [0.3, 0, 0], 0.2)
        fused.erase(volume, [0.0, 0.0, 0.0], 0.1)
        fused.end_stroke()
        self.assertNotEqual(fused.snapshot().difference(before)["states"], {})
        self.assertEqual(fused.undo_stroke(), number)
        self.assertEqual(fused.snapshot().difference(before)["states"], {})
        self.assertEqual(fused.undo_stroke(), -1)

    def test_nothing_is_painted_where_one_sphere_is_refused(self):
        fused = cw.FreeSpaceMap()
        volume = fused.add_volume("v", [])
        for radii in ([0.2, 0.0], [0.2, -1.0], [0.2, np.nan], [0.2, np.inf]):
            with self.assertRaisesRegex(ValueError, "^sphere 1: expected"):
                fused.paint(volume, [[0, 0, 0], [1, 0, 0]], radii)
        with self.assertRaisesRegex(ValueError, "^sphere 1: expected"):
            fused.paint(volume, [[0, 0, 0], [1, 0, 0]], 0.2, [0.0, np.nan])
        with self.assertRaisesRegex(ValueError, "at most .* 1000 voxels"):
            fused.paint(volume, [[0, 0, 0], [1, 0, 0]], [0.2, 1e4])
        self.assertEqual(fused.snapshot().counts().painted, 0)


class Scans(unittest.TestCase):
    def test_hits_are_occupied_and_free_voxels_lie_on_rays(self):
        dice = np.random.default_rng(3)
        cloud = dice.uniform(-1, 1, (400, 3)).astype(np.float32)
        cloud *= 1.5 / np.linalg.norm(cloud, axis=1, keepdims=True)
        place = worlds.pose(0.012, 0.013, 0.014, 0.3)
        fused = cw.FreeSpaceMap(resolution=0.1, integration="compatible")
        counts = fused.insert(cloud, place)
        self.assertEqual(counts.inserted, len(cloud))
        states, low = fused.snapshot().states_in([[-2, -2, -2], [2, 2, 2]])
        ends = cloud.astype(float) @ place[:3, :3].T + place[:3, 3]
        hit = np.zeros(states.shape, bool)
        hit[tuple(np.floor((ends - low) / 0.1).astype(int).T)] = True
        np.testing.assert_array_equal(states == cw.VoxelState.occupied, hit)
        passed = np.zeros(states.shape, bool)
        for share in np.linspace(0, 1, 2000):
            passed[tuple(np.floor((place[:3, 3] + share * (ends - place[:3, 3]) - low) / 0.1).astype(int).T)] = True
        free = states == cw.VoxelState.seen_free
        self.assertFalse((passed & ~hit & ~free).any(), "a voxel that a ray passes is not free")
        # Rays that only graze a corner are found by no sample.
        self.assertLess((free & ~passed).sum(), 0.02 * free.sum())

    def test_arrays_of_any_kind_give_the_same_map(self):
        dice = np.random.default_rng(4)
        cloud = dice.uniform(0.5, 1.5, (300, 3)).astype(np.float32)
        wide = np.zeros((600, 6), np.float32)
        wide[::2, ::2] = cloud
        frozen = cloud.copy()
        frozen.flags.writeable = False
        kinds = {
            "doubles": cloud.astype(np.float64),
            "columns": np.asfortranarray(cloud),
            "strides": wide[::2, ::2],
            "backwards": cloud[::-1][::-1],
            "big endian": cloud.astype(">f4"),
            "list": cloud.tolist(),
            "read only": frozen,
            "long doubles": cloud.astype(np.longdouble),
        }
        usual = cw.FreeSpaceMap()
        usual.insert(cloud)
        for name, kind in kinds.items():
            with self.subTest(name):
                fused = cw.FreeSpaceMap()
                self.assertEqual(fused.insert(kind).inserted, 300)
                found = fused.snapshot().difference(usual.snapshot())
                self.assertEqual((found["states"], found["evidence"]), ({}, 0))

    def test_points_that_are_not_finite_are_counted(self):
        cloud = np.ones((4, 3))
        cloud[1, 2], cloud[2, 0] = np.nan, np.inf
        counts = cw.FreeSpaceMap().insert(cloud)
        self.assertEqual((counts.inserted, counts.dropped_invalid), (2, 2))
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # far points need no warning of NumPy's
            self.assertEqual(cw.FreeSpaceMap().insert(1e300 * cloud).dropped_invalid, 4)
        self.assertEqual(counts.as_dict()["dropped_invalid"], 2)
        self.assertEqual(cw.FreeSpaceMap().insert(np.empty((0, 3))).inserted, 0)

    def test_a_box_is_two_points(self):
        fused = cw.FreeSpaceMap(0.1)
        for box in ([0, 0, 0, 1, 1, 1], [[0, 0, 0]], [[0, 0], [1, 1]], "box"):
            with self.assertRaisesRegex((TypeError, ValueError), r"^crop: expected two points \(low, high\)"):
                fused.insert([[0.5, 0.0, 0.0]], crop=box)
        self.assertEqual(fused.insert([[0.5, 0.0, 0.0]], crop=[[0, 0, 0], [1, 1, 1]]).inserted, 1)

    def test_times_that_no_map_keeps_are_refused(self):
        for made in (cw.FreeSpaceMap(0.1), cw.ContinuedMap(cw.FreeSpaceMap(0.1).snapshot())):
            for time in (1.79e18, -1.79e18, np.inf, np.nan):
                with self.assertRaisesRegex(ValueError, "^time: expected a finite number of seconds, at most 1e12 from 0, got"):
                    made.insert([[1.0, 0.0, 0.0]], time=time)
            self.assertEqual(made.insert([[1.0, 0.0, 0.0]], time=1e12).inserted, 1)
            self.assertEqual(made.insert([[1.0, 0.0, 0.0]], time=None).inserted, 1)

    def test_filters(self):
        cloud = np.array([[0.1, 0, 0], [1.0, 0, 0], [2.0, 0, 0], [0, 1.0, 0]])
        bodies = [[0, 0.9, 0, 0, 1.1, 0, 0.05]]
        counts = cw.FreeSpaceMap().insert(cloud, min_range=0.2, max_range=1.5, bodies=bodies)
        self.assertEqual((counts.inserted, counts.beyond_range, counts.dropped_filter), (1, 1, 2))
        counts = cw.FreeSpaceMap().insert(cloud, crop=[[0, -1, -1], [1.5, 0.5, 1]])
        self.assertEqual((counts.inserted, counts.dropped_filter), (2, 2))

    def test_rays_that_met_nothing_free_space_and_hit_none(self):
        map_ = cw.FreeSpaceMap(resolution=0.05)
        counts = map_.insert(np.array([[0.0, 1.0, 0.0]]), clear_to=[[2.0, 0.0, 0.0]])
        self.assertEqual((counts.inserted, counts.cleared), (1, 1))
        snapshot = map_.snapshot()
        states = [snapshot.state([x, 0.025, 0.025]).name for x in (0.5, 1.5, 2.5)]
        self.assertEqual(states, ["seen_free", "seen_free", "unknown"])
        with self.assertRaisesRegex(ValueError, "clear_to"):
            map_.insert(np.array([[0.0, 1.0, 0.0]]), clear_to=[[2.0, 0.0]])

    def test_a_map_is_gone_on_with(self):
        start = worlds.scanned_room().snapshot()
        before = start.counts()
        more = cw.ContinuedMap(start, threads=2)
        more.insert([[0.0, 0.0, 0.3]], time=9.0)
        self.assertIn(more.snapshot().state([0.0, 0.0, 0.3]), (cw.VoxelState.occupied, cw.VoxelState.conflict))
        self.assertEqual(start.counts().as_dict(), before.as_dict())

    def test_threads_that_write_one_map_wait_for_each_other(self):
        dice = np.random.default_rng(5)
        clouds = dice.uniform(-1, 1, (12, 500, 3))
        fused, failures, inserted = cw.FreeSpaceMap(resolution=0.05), [], []

        def work(part):
            try:
                for cloud in part:
                    inserted.append(fused.insert(cloud).inserted)
                    fused.snapshot().states(cloud)
                    with self.assertRaises(ValueError):
                        fused.insert(cloud[:, :2])
            except BaseException as error:  # noqa: B902
                failures.append(error)

        threads = [threading.Thread(target=work, args=(clouds[i::4],)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((failures, sum(inserted)), ([], 6000))
        hits = fused.snapshot().states(clouds[:, :, :].reshape(-1, 3).astype(np.float32))
        self.assertGreater((hits == cw.VoxelState.occupied).mean(), 0.1)


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.map = worlds.scanned_room().snapshot()

    def test_grid_slices_leaves_and_single_questions_agree(self):
        states, low = self.map.states_in()
        points = middles(states, low, self.map.resolution).reshape(-1, 3)
        np.testing.assert_array_equal(self.map.states(points), states.ravel())
        for state in cw.VoxelState:
            if state != cw.VoxelState.unknown:
                self.assertEqual((states == state).sum(), getattr(self.map.counts(), state.name))
        for axis, name in enumerate("xyz"):
            at = 0.03
            plane, extent = self.map.slice(name, at)
            index = int(np.floor((at - low[axis]) / self.map.resolution))
            expected = np.take(states, index, axis=axis)
            np.testing.assert_array_equal(plane, expected.T)
            right = 1 if name == "x" else 0
            self.assertAlmostEqual(extent[0], low[right])
            self.assertAlmostEqual((extent[3] - extent[2]) / self.map.resolution, plane.shape[0])
        for at in (0.15, 0.3, -0.35, 0.6000000000000001):  # on the faces of voxels
            plane, extent = self.map.slice("z", at)
            right = extent[0] + (np.arange(plane.shape[1]) + 0.5) * self.map.resolution
            up = extent[2] + (np.arange(plane.shape[0]) + 0.5) * self.map.resolution
            at_once = self.map.states(np.column_stack([np.tile(right, len(up)), np.repeat(up, len(right)),
                                                       np.full(plane.size, at)]))
            np.testing.assert_array_equal(plane.ravel(), at_once)
        leaves = self.map.leaves()
        np.testing.assert_array_equal(self.map.states(leaves["centers"]), leaves["states"])
        cells = np.rint((leaves["sizes"] / self.map.resolution) ** 3)
        self.assertEqual(cells.sum(), (states != cw.VoxelState.unknown).sum())
        self.assertEqual(self.map.state(points[7]), states.ravel()[7])
        self.assertEqual(self.map.voxel(points[7]).state, states.ravel()[7])

    def test_without_a_box_the_grid_is_that_of_the_bounds(self):
        for edge in (0.02, 0.05, 0.1):
            for index in range(-60, 61):  # 29 * 0.02 / 0.02 is a little less than 29
                fused = cw.FreeSpaceMap(resolution=edge)
                fused.paint(fused.add_volume("v", []), [[(index + 0.5) * edge] * 3], [0.9 * edge])
                states, low = fused.snapshot().states_in()
                np.testing.assert_allclose(low, fused.snapshot().bounds[0], atol=1e-9)
                self.assertEqual(states.tolist(), [[[cw.VoxelState.painted]]], (edge, index))

    def test_clearances_are_lower_bounds_of_the_distance_to_blocked_cubes(self):
        dice = np.random.default_rng(2)
        points = dice.uniform(-1, 1, (200, 3))
        states, low = self.map.states_in()
        centers = middles(states, low, self.map.resolution)
        blocked = np.isin(states, [cw.VoxelState.occupied, cw.VoxelState.conflict])
        exact = cube_distances(points, centers[blocked], self.map.resolution)
        space = self.map.blocked_space("not_occupied", max_distance=0.6)
        bounds = space.clearances(points)
        self.assertTrue((bounds <= exact + 1e-9).all())
        near = exact < 0.5
        self.assertTrue((bounds[near] > exact[near] - self.map.resolution).all())
        np.testing.assert_array_equal(bounds, [space.clearance(point) for point in points])
        np.testing.assert_array_equal(space.are_blocked(centers[blocked]), True)
        self.assertEqual(space.blocked_count, blocked.sum())
        found = space.nearest(points[near][0], 0.6)
        self.assertAlmostEqual(found.distance, exact[near][0], places=9)

    def test_lines_of_sight_are_those_of_samples(self):
        dice = np.random.default_rng(6)
        begins, ends = dice.uniform(-0.6, 0.6, (2, 300, 3))
        ends[::2] *= 2.5
        ends[1::6] = begins[1::6] + 0.1 * ends[1::6]
        for policy, allowed in {
            "known_free": (cw.VoxelState.painted, cw.VoxelState.seen_free),
            "not_occupied": (cw.VoxelState.painted, cw.VoxelState.seen_free, cw.VoxelState.unknown),
            "painted": (cw.VoxelState.painted,),
        }.items():
            seen = self.map.lines_of_sight(begins, ends, policy)
            shares = np.linspace(0, 1, 2001)[:, None, None]
            samples = (begins + shares * (ends - begins)).reshape(-1, 3)
            free = np.isin(self.map.states(samples), allowed).reshape(2001, 300).all(axis=0)
            self.assertFalse((seen & ~free).any(), policy)
            self.assertLessEqual((free & ~seen).sum(), 6, policy)  # a corner between two samples
            self.assertTrue(0 < seen.sum() < 300, policy)
            self.assertEqual(self.map.line_of_sight(begins[0], ends[0], policy), seen[0])
        self.assertFalse(self.map.line_of_sight([50, 0, 0], [60, 0, 0], "known_free"))
        self.assertTrue(self.map.line_of_sight([50, 0, 0], [60, 0, 0], "not_occupied"))
        with self.assertRaisesRegex(ValueError, "line of sight"):
            self.map.line_of_sight([np.nan, 0, 0], [1, 0, 0])

    def test_a_map_is_saved_into_a_folder_of_its_own_as_the_program_does(self):
        with worlds.folder() as folder:
            for name, content in {"plans/one.json": "{}", "provenance.bin": "p", "map.ot": "of another program"}.items():
                place = pathlib.Path(folder) / name.partition("/")[0].replace(".", "_")
                (place / name).parent.mkdir(parents=True)
                (place / name).write_text(content)
                with self.assertRaisesRegex(ValueError, "expected another folder"):
                    self.map.save(place)
                with self.assertRaisesRegex(ValueError, "expected another folder"):
                    cw.save_map(self.map, place)
                self.assertEqual((place / name).read_text(), content)
                self.assertEqual(len(list(place.iterdir())), 1)

    def test_a_map_made_of_one_with_a_record_of_queries_hands_it_on(self):
        with worlds.folder() as folder:
            first, second = pathlib.Path(folder) / "first", pathlib.Path(folder) / "second"
            self.map.save(first)
            digest = hashlib.sha256((first / "map.ot").read_bytes()).hexdigest()
            record = {"format": "clearway queries 1", "map_sha256": digest, "queries": [], "sha256": "0" * 64}
            text = json.dumps(record, indent=1) + "\n"
            text = text.replace("0" * 64, hashlib.sha256(text.encode()).hexdigest())
            (first / "queries.json").write_text(text)
            cw.load_map(first).crop([[-0.5] * 3, [0.5] * 3]).save(second)
            made = json.loads((second / "queries.json").read_text())
            self.assertEqual(made["made_for_sha256"], digest)
            self.assertEqual(made["map_sha256"], hashlib.sha256((second / "map.ot").read_bytes()).hexdigest())
            self.map.save(second)  # of no folder, so that no record is its own
            self.assertFalse((second / "queries.json").exists())

    def test_the_program_says_the_same_of_a_saved_map_bit_for_bit(self):
        with worlds.folder() as folder:
            self.map.save(folder)
            answer = worlds.answer("inspect", folder)
            self.assertEqual(answer["resolution"], self.map.resolution)
            self.assertEqual(answer["voxels"], self.map.counts().as_dict())
            self.assertEqual([answer["bounds"]["min"], answer["bounds"]["max"]], self.map.bounds.tolist())
            loaded = cw.load_map(folder)
            self.assertEqual(self.map.difference(loaded)["states"], {})
            for point in np.random.default_rng(9).uniform(-0.9, 0.9, (5, 3)):
                at = worlds.answer("inspect", folder, "--at=" + ",".join(map(repr, point.tolist())))["at"][0]
                self.assertEqual(at["state"], self.map.state(point).name)
                reach = 40 * self.map.resolution
                for policy, distance in at["clearance_m"].items():
                    space = loaded.blocked_space(policy, [point - reach, point + reach], reach)
                    self.assertEqual(space.clearance(point), distance)

    def test_paint_has_no_age(self):
        with self.assertRaisesRegex(ValueError, "only the policy known_free asks when a voxel was seen"):
            self.map.blocked_space("painted", seen_within=5.0)

    def test_a_cloud_file_is_read_as_the_points_that_it_holds(self):
        random = np.random.default_rng(10)  # too far apart for anything to lie between them
        places = np.stack(np.unravel_index(random.choice(343, 50, replace=False), (7, 7, 7)), -1) - 3
        points = (0.3 * places + random.uniform(-0.05, 0.05, (50, 3))).astype(np.float32)
        with worlds.folder() as folder:
            file = pathlib.Path(folder) / "cloud.ply"
            header = "ply\nformat ascii 1.0\nelement vertex 50\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
            file.write_text(header + "\n".join(" ".join(map(str, point)) for point in points.tolist()) + "\n")
            loaded = cw.load_map(file, cloud_resolution=0.1)
        states, low = loaded.states_in()
        cells = {tuple(cell) for cell in np.floor(points.astype(float) / 0.1).astype(int)}
        found = np.rint(low / 0.1).astype(int) + np.argwhere(states == cw.VoxelState.occupied)
        self.assertEqual({tuple(cell) for cell in found}, cells)

    def test_maps_are_made_of_maps(self):
        other = worlds.scanned_room(seed=2).snapshot()
        both, here, there = (m.states_in([[-1, -1, -1], [1, 1, 1]])[0] for m in (self.map.merge(other), self.map, other))
        hits = [cw.VoxelState.occupied, cw.VoxelState.conflict]
        np.testing.assert_array_equal(np.isin(both, hits), np.isin(here, hits) | np.isin(there, hits))
        box = np.array([[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]])
        np.testing.assert_array_equal(self.map.crop(box).states_in(box)[0], self.map.states_in(box)[0])
        coarse = self.map.coarsen(0.1).states_in([[-1, -1, -1], [1, 1, 1]])[0]
        blocks = np.isin(here, hits).reshape(20, 2, 20, 2, 20, 2).any(axis=(1, 3, 5))
        np.testing.assert_array_equal(np.isin(coarse, hits), blocks)

    def test_answers_outlive_what_they_came_from(self):
        fused = worlds.scanned_room()
        snapshot = fused.snapshot()
        space, volume = snapshot.blocked_space(max_distance=0.3), snapshot.volumes[0]
        points = np.random.default_rng(1).uniform(-1, 1, (20, 3))
        before, radii, leaves = space.clearances(points), volume.radii.copy(), snapshot.leaves()
        states = leaves["states"].copy()
        fused.paint(fused.add_volume("more", []), [0, 0, 0], 0.5)
        del fused, snapshot
        gc.collect()
        np.testing.assert_array_equal(space.clearances(points), before)
        np.testing.assert_array_equal(volume.radii, radii)
        np.testing.assert_array_equal(leaves["states"], states)
        before += 1.0  # an array of its own, to change as one likes


if __name__ == "__main__":
    unittest.main()
