"""Loads and picks from Python, against the command line program."""

import json
import pathlib
import unittest

import numpy as np

import clearway as cw
import worlds
from worlds import text, without_times


class Loads(unittest.TestCase):
    """Two posts 0.7 m apart: the point robot's disc of 0.2 m passes between them, a rod of 1 m does not."""

    @classmethod
    def setUpClass(cls):
        fused = cw.FreeSpaceMap(resolution=0.05)
        edges = np.arange(0.925, 1.0, 0.05), np.arange(0.375, 0.45, 0.05), np.arange(-0.075, 0.1, 0.05)
        post = np.stack(np.meshgrid(*edges), -1).reshape(-1, 3)
        fused.insert(np.vstack([post, post * [1, -1, 1]]) + [2.0, 0.0, 0.0], worlds.pose(-2.0))
        cls.folder = worlds.folder()
        cls.addClassCleanup(cls.folder.cleanup)
        fused.snapshot().save(cls.folder.name)
        cls.map = cw.load_map(cls.folder.name)
        cls.robot = cw.load_robot("point")
        cls.space = cw.ConfigurationSpace(cls.robot, cls.map, "not_occupied")
        cls.start, cls.goal = np.zeros(2), np.array([2.0, 0.0])
        cls.rod = cw.Load("rod", "base", worlds.pose(0.0, 0.0, 0.01), box=[0.05, 1.0, 0.05], mass=2.0)
        cls.flags = ["--map", cls.folder.name, "--robot", "point", "--policy", "not_occupied", "--allow-outside", "all"]

    def answer(self, *more):
        return worlds.answer("plan", *self.flags, "--planner", "rrtconnect", "--start=0,0", "--goal=2,0", "--goal=0,0", *more)

    def planned(self, **more):
        return cw.plan(self.space, self.start, [self.goal, self.start], planner="rrtconnect", allow_outside=["all"], **more)

    def file(self, name, content):
        path = pathlib.Path(self.folder.name) / name
        path.write_text(content)
        return path

    def test_plans_with_loads_are_those_of_the_program_bit_for_bit(self):
        rod = "name: rod, box: [0.05, 1, 0.05], link: base, pose: [0, 0, 0.01, 0, 0, 0], mass: 2"
        for legs, more in (([], ""), ([1], ", legs: [2]")):
            load = cw.Load("rod", "base", worlds.pose(0, 0, 0.01), box=[0.05, 1.0, 0.05], mass=2.0, legs=legs)
            plan = self.planned(loads=[load])
            answer = self.answer("--attach", self.file("rod.yaml", "{" + rod + more + "}"))
            self.assertTrue(plan.is_proved, plan.explanation)
            self.assertEqual(without_times(plan.to_dict()), without_times(answer))
            self.assertEqual(len(plan.legs[0].waypoints) > 2, not legs)
            self.assertGreater(len(plan.legs[1].waypoints), 2)
            self.assertEqual((plan.loads[0].name, plan.loads[0].legs, plan.loads[0].mass), ("rod", legs, 2.0))
            np.testing.assert_array_equal(plan.loads[0].edges, [0.05, 1.0, 0.05])
            np.testing.assert_array_equal(plan.loads[0].link_from_load, worlds.pose(0, 0, 0.01))
        self.assertEqual(self.planned().loads, [])

    def test_the_check_is_that_of_the_program_with_the_loads_that_are_stated(self):
        plan, bare = self.planned(loads=[self.rod]), self.planned()
        file = self.file("plan.json", plan.to_json())
        answer = worlds.answer("check", file, *self.flags)
        verdict = cw.check_plan(self.space, plan)
        self.assertTrue(verdict.valid, verdict.first_contact)
        self.assertEqual((answer["verdict"], answer["min_clearance_m"]), ("valid", verdict.min_clearance))
        self.assertGreater(cw.check_plan(self.space, plan, loads=[]).min_clearance, verdict.min_clearance)
        refused = cw.check_plan(self.space, bare, loads=[self.rod])
        self.assertFalse(refused.valid)
        self.assertIn("rod", refused.first_contact)
        self.assertTrue(cw.check_plan(self.space, bare).valid)
        self.assertIs(cw.require_proved(plan, self.space, allow_outside=["all"]), plan)
        with self.assertRaisesRegex(cw.PathRefused, "leaves the map's bounds.*allow_outside"):
            cw.require_proved(plan, self.space)
        with self.assertRaises(TypeError):
            cw.require_proved(file)
        with self.assertRaisesRegex(cw.PathRefused, "rod"):
            cw.require_proved(bare, self.space, loads=[self.rod], allow_outside=["all"])
        # The rod counts where a file says that it rides.
        again = bare.to_dict()
        again["loads"] = plan.to_dict()["loads"]
        with self.assertRaisesRegex(cw.PathRefused, "rod"):
            cw.require_proved(cw.parse_plan(json.dumps(again)), self.space, allow_outside=["all"])

    def test_a_load_may_have_a_policy_of_its_own(self):
        space = cw.ConfigurationSpace(self.robot, self.map, "not_occupied")
        plan = cw.plan(space, self.start, self.goal, loads=[self.rod], load_policies={"rod": "known_free"}, allow_outside=["all"])
        self.assertEqual(plan.status, "start_invalid")
        self.assertEqual(plan.policies["rod"], "known_free")
        free = self.planned(loads=[self.rod])
        self.assertFalse(cw.check_plan(space, free, load_policies={"rod": "known_free"}).valid)

    def test_a_plan_with_loads_has_the_smooth_motion_of_the_program(self):
        plan = self.planned(loads=[self.rod])
        planned = cw.plan_motion(self.space, plan)
        self.assertTrue(planned.validation.valid, planned.validation.fault)
        self.assertGreater(planned.blended, 0)
        with self.assertRaisesRegex(ValueError, "grip_time"):
            cw.plan_motion(self.space, plan, grip_time=-1.0)
        trajectory = cw.trajectory_of(planned.motion)
        self.assertLess(trajectory.times[-1], cw.plan_trajectory(self.robot, plan).times[-1])
        csv = pathlib.Path(self.folder.name) / "way.csv"
        rod = self.file("rod.yaml", "{name: rod, box: [0.05, 1, 0.05], link: base, pose: [0, 0, 0.01, 0, 0, 0], mass: 2}")
        self.answer("--attach", rod, "--trajectory", "csv", csv)
        table = np.loadtxt(csv.read_text().splitlines()[1:], delimiter=",", ndmin=2)
        np.testing.assert_array_equal(table[:, 0], trajectory.times)
        np.testing.assert_array_equal(table[:, 1:3], trajectory.positions)
        self.assertIsNone(plan.motion)

    def test_a_motion_is_checked_with_the_loads_that_are_stated(self):
        file = self.file("rod.yaml", "{name: rod, box: [0.05, 1, 0.05], link: base, pose: [0, 0, 0.01, 0, 0, 0], mass: 2}")
        answer = self.answer("--attach", file, "--motion")
        plan = cw.parse_plan(json.dumps(answer))
        self.assertEqual(plan.motion.grip_time, 1.0)
        self.assertTrue(cw.check_plan(self.space, plan).valid)
        bare = self.answer("--motion")
        answer["motion"] = {**bare["motion"], "grip_time_s": 1.0}
        verdict = cw.check_plan(self.space, cw.parse_plan(json.dumps(answer)))
        self.assertFalse(verdict.valid)
        self.assertIn("motion", verdict.first_contact)

    def test_shapes_are_as_given(self):
        for given, kind in (({"sphere": 0.1}, "sphere"), ({"cylinder": [0.1, 0.3]}, "cylinder"),
                            ({"capsule": (0.1, 0.3)}, "capsule"), ({"box": np.ones(3)}, "box"),
                            ({"vertices": np.eye(3)}, "convex")):
            load = cw.Load("thing", "base", **given)
            self.assertEqual(load.kind, kind)
            self.assertEqual(load.as_dict()["name"], "thing")
        self.assertEqual((load.touches, load.mass), ([], 0.0))
        self.assertEqual(cw.Load("c", "base", cylinder=[0.1, 0.3]).length, 0.3)

    def test_mistakes_are_one_sentence(self):
        plan = self.planned()
        empty = cw.plan(self.space, self.start, [50.0, 50.0], time_limit=1e-9, advice_time=0.0)
        for make in (
            lambda: cw.Load("rod", "base"),
            lambda: cw.Load("rod", "base", box=[1, 1, 1], sphere=1.0),
            lambda: cw.Load("rod", "base", box=[1, 1]),
            lambda: cw.Load("rod", "base", box=[1, 1, np.nan]),
            lambda: cw.Load("rod", "base", sphere=-1.0),
            lambda: cw.Load("rod", "base", cylinder=[1, 2, 3]),
            lambda: cw.Load("rod", "base", vertices=np.zeros((0, 3))),
            lambda: cw.Load("rod", "base", vertices=[[0, 0, np.inf]]),
            lambda: cw.Load("rod", "base", 2 * np.eye(4), sphere=1.0),
            lambda: cw.Load("rod", "base", sphere=0.1, legs=[-1]),
            lambda: self.planned(loads=[cw.Load("rod", "bsae", sphere=0.1)]),
            lambda: self.planned(loads=[cw.Load("base", "base", sphere=0.1)]),
            lambda: self.planned(loads=[cw.Load("rod", "base", sphere=0.1, mass=-1.0)]),
            lambda: self.planned(loads=[cw.Load("rod", "base", sphere=0.1, legs=[2])]),
            lambda: self.planned(loads=[cw.Load("rod", "base", sphere=0.1, touches=["nose"])]),
            lambda: self.planned(loads=[self.rod, self.rod]),
            lambda: self.planned(loads=[self.rod], load_policies={"rod": "free"}),
            lambda: self.planned(loads=[self.rod], load_policies={"nose": "painted"}),
            lambda: cw.check_plan(self.space, plan, loads=[cw.Load("rod", "bsae", sphere=0.1)]),
            lambda: cw.check_plan(self.space, empty),
            lambda: cw.check_plan(cw.ConfigurationSpace(cw.load_robot("puma560"), self.map, "not_occupied"), plan, loads=[self.rod]),
            lambda: cw.plan_trajectory(self.robot, empty),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,500}$")


class Picks(unittest.TestCase):
    """A can on a table, and where it goes."""

    @classmethod
    def setUpClass(cls):
        def cells(low, high):
            axes = [np.arange(a + 0.01, b, 0.02) for a, b in zip(low, high)]
            return np.stack(np.meshgrid(*axes), -1).reshape(-1, 3)

        fused = cw.FreeSpaceMap(resolution=0.02)
        things = np.vstack([cells((0.24, -0.46, 0.04), (0.7, 0.46, 0.1)), cells((0.4, 0.14, 0.1), (0.44, 0.18, 0.22))])
        fused.insert(things + [2.0, 0.0, -0.5], worlds.pose(-2.0, 0.0, 0.5))
        cls.folder = worlds.folder()
        cls.addClassCleanup(cls.folder.cleanup)
        fused.snapshot().save(cls.folder.name)
        cls.robot = cw.load_robot("arm6")
        cls.space = cw.ConfigurationSpace(cls.robot, cw.load_map(cls.folder.name), "not_occupied")
        cls.start = np.array([0, -1.9, 1.7, -1.4, -1.57, 0])
        cls.can = cw.Load("can", "hand", cylinder=[0.03, 0.12], mass=0.3)
        grasp = np.diag([1.0, -1.0, -1.0, 1.0])  # from above
        grasp[2, 3] = 0.04
        cls.pick = cw.Pick(cls.can, worlds.pose(0.42, 0.16, 0.16), worlds.pose(0.42, -0.2, 0.16), object_from_tip=grasp)
        cls.plan = cw.plan(cls.space, cls.start, pick=cls.pick, allow_outside=["all"])
        cls.flags = ["--map", cls.folder.name, "--robot", "arm6", "--policy", "not_occupied", "--allow-outside", "all"]
        cls.yaml = pathlib.Path(cls.folder.name) / "pick.yaml"
        cls.yaml.write_text("{name: can, cylinder: [0.03, 0.12], link: hand, pose: [0.42, 0.16, 0.16, 0, 0, 0], mass: 0.3, "
                            f"place: [0.42, -0.2, 0.16, 0, 0, 0], grasp: [0, 0, 0.04, {np.pi!r}, 0, 0]}}")

    def test_a_can_is_taken_and_put_down_as_by_the_program(self):
        self.assertTrue(self.plan.is_proved, self.plan.explanation)
        self.assertEqual(len(self.plan.legs), 6)
        answer = worlds.answer("plan", *self.flags, "--start=" + text(self.start), "--pick", self.yaml)
        # Its grasp comes through roll, pitch and yaw, ours as a matrix: equal but for rounding.
        np.testing.assert_allclose(self.plan.pick.object_from_tip, answer["pick"]["grasp"], atol=1e-12)
        same = cw.Pick(self.can, answer["pick"]["pose"], answer["pick"]["place"], object_from_tip=answer["pick"]["grasp"])
        plan = cw.plan(self.space, self.start, pick=same, allow_outside=["all"])
        self.assertEqual(without_times(plan.to_dict()), without_times(answer))
        self.assertEqual(plan.loads[0].legs, [2, 3, 4])
        self.assertEqual(plan.tip, answer["tip"])
        # The can goes with the tip: where the leg `carry` ends it is above its place.
        above = self.robot.tip_pose(plan.legs[3].waypoints[-1]) @ np.linalg.inv(plan.pick.object_from_tip)
        np.testing.assert_allclose(above[:3, 3], [0.42, -0.2, 0.26], atol=1e-3)

    def test_what_the_object_must_lie_in_is_stated_as_of_any_load(self):
        free = cw.plan(self.space, self.start, pick=self.pick, allow_outside=["can"], load_policies={"can": "not_occupied"})
        self.assertEqual(free.policies["can"], "not_occupied")
        answer = worlds.answer("plan", *self.flags, "--policy", "can=not_occupied", "--start=" + text(self.start), "--pick",
                               self.yaml)
        self.assertEqual(answer["policy"]["can"], "not_occupied")
        with self.assertRaisesRegex(ValueError, "load_policies: expected names of loads, got 'mug'"):
            cw.plan(self.space, self.start, pick=self.pick, load_policies={"mug": "painted"})

    def test_picks_are_of_the_tip_of_the_spaces_robot(self):
        with self.assertRaisesRegex(ValueError, "^tip: expected none with a pick"):
            cw.plan(self.space, self.start, pick=self.pick, tip="link4")
        other = cw.ConfigurationSpace(cw.load_robot("arm6", tip="link4"), cw.load_map(self.folder.name), "not_occupied")
        with self.assertRaisesRegex(ValueError, "'link4', got '.*hand'"):
            cw.check_plan(other, self.plan, pick=self.pick)
        with self.assertRaisesRegex(ValueError, "elbow"):
            cw.load_robot("arm6", tip="elbow")
        np.testing.assert_allclose(cw.load_robot("arm6", tip="link4").tip_pose(self.start),
                                   self.robot.link_poses(self.start)[4], atol=1e-12)

    def test_the_check_takes_the_pick_from_whoever_states_it(self):
        file = pathlib.Path(self.folder.name) / "plan.json"
        self.plan.save(file)
        answer = worlds.answer("check", file, *self.flags, "--pick", self.yaml)
        verdict = cw.check_plan(self.space, self.plan, pick=self.pick)
        self.assertTrue(verdict.valid, verdict.first_contact)
        self.assertEqual((answer["verdict"], answer["min_clearance_m"]), ("valid", verdict.min_clearance))
        with self.assertRaisesRegex(ValueError, "^pick: expected what the plan may pick"):
            cw.check_plan(self.space, self.plan)
        with self.assertRaisesRegex(ValueError, "^pick: "):
            cw.require_proved(self.plan, self.space)
        with self.assertRaisesRegex(cw.PathRefused, "outside"):
            cw.require_proved(self.plan, self.space, pick=self.pick)
        self.assertIs(cw.require_proved(self.plan, self.space, pick=self.pick, allow_outside=["all"]), self.plan)
        with self.assertRaisesRegex(ValueError, "^allow_outside"):
            cw.check_plan(self.space, self.plan, pick=self.pick, allow_outside=["mug"])
        elsewhere = cw.Pick(self.can, self.pick.map_from_object, worlds.pose(0.42, -0.21, 0.16),
                            object_from_tip=self.pick.object_from_tip)
        self.assertFalse(cw.check_plan(self.space, self.plan, pick=elsewhere).valid)
        taller = cw.Pick(cw.Load("can", "hand", cylinder=[0.03, 0.3]), self.pick.map_from_object, self.pick.map_from_place,
                         object_from_tip=self.pick.object_from_tip)
        self.assertFalse(cw.check_plan(self.space, self.plan, pick=taller).valid)

    def test_mistakes_are_one_sentence(self):
        here, there = self.pick.map_from_object, self.pick.map_from_place
        for make in (
            lambda: cw.Pick(self.can, here, np.zeros((4, 4))),
            lambda: cw.Pick(self.can, 2 * here, there),
            lambda: cw.Pick(cw.Load("can", "hand", sphere=0.1, legs=[1]), here, there),
            lambda: cw.Pick(self.can, here, there, approach=[0, 0]),
            lambda: cw.plan(self.space, self.start, pick=cw.Pick(self.can, here, there, lift=-1.0)),
            lambda: cw.plan(self.space, self.start, pick=cw.Pick(self.can, here, there, contact=np.nan)),
            lambda: cw.plan(self.space, self.start, pick=cw.Pick(self.can, here, there, approach=[0, 0, 0])),
            lambda: cw.plan(self.space, self.start, pick=self.pick, loads=[self.can]),
            lambda: cw.plan(self.space, self.start, [self.start, self.start], pick=self.pick),
            lambda: cw.plan(self.space, self.start, pick=cw.Pick(cw.Load("can", "hnad", sphere=0.1), here, there)),
            lambda: cw.check_plan(self.space, self.plan, pick=self.pick, loads=[self.can]),
            lambda: cw.check_plan(self.space, self.plan, pick=cw.Pick(self.can, here, there, lift=-1.0)),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,500}$")


if __name__ == "__main__":
    unittest.main()
