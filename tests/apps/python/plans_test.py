"""Spaces, plans and checks from Python, against the command line program and dense samples."""

import json
import pathlib
import threading
import subprocess
import sys
import unittest

import numpy as np

import clearway as cw
import worlds
from worlds import text, without_times


class Arm(unittest.TestCase):
    """The PUMA 560 in paint, with the map saved for the program."""

    @classmethod
    def setUpClass(cls):
        cls.robot, snapshot, cls.start, cls.goal = worlds.arcs()
        cls.folder = worlds.folder()
        cls.addClassCleanup(cls.folder.cleanup)
        snapshot.save(cls.folder.name)
        cls.map = cw.load_map(cls.folder.name)
        cls.space = cw.ConfigurationSpace(cls.robot, cls.map)
        cls.flags = ["--map", cls.folder.name, "--robot", "puma560"]

    def test_plans_are_those_of_the_program_bit_for_bit(self):
        for planner, options in (("rrtconnect", {"shortcuts": 20}), ("beam", {"width": 5, "step_deg": 2.0}), ("auto", {})):
            sets = [word for name, value in options.items() for word in ("--set", f"{name}={value}")]
            answer = worlds.answer("plan", *self.flags, "--planner", planner, *sets, "--seed", 3,
                                 "--start=" + text(self.start), "--goal=" + text(self.goal), "--goal=" + text(self.start))
            plan = cw.plan(self.space, self.start, [self.goal, self.start], planner=planner, seed=3, **options)
            self.assertTrue(plan.is_proved, plan.explanation)
            self.assertEqual(without_times(plan.to_dict()), without_times(answer))
            self.assertEqual(plan.waypoints.tolist(), answer["waypoints"])
            self.assertEqual(plan.validation.min_clearance, answer["validation"]["min_clearance_m"])
            shares = np.linspace(0.0, 1.0, 101)[1:, None]  # an edge's cost is that of its parts
            cost = sum(self.robot.path_cost(np.vstack([a, a + shares * (b - a)]))
                       for leg in plan.legs for a, b in zip(leg.waypoints, leg.waypoints[1:]))
            self.assertAlmostEqual(plan.cost, cost, delta=1e-3 * cost)  # sampled otherwise

    def test_the_program_checks_a_saved_plan_and_says_the_same(self):
        plan = cw.plan(self.space, self.start, self.goal, planner="rrtconnect")
        with worlds.folder() as folder:
            file = pathlib.Path(folder) / "plan.json"
            plan.save(file)
            answer = worlds.answer("check", file, *self.flags)
            self.assertEqual(file.read_text(), plan.to_json())
            again = cw.load_plan(file)
        verdict = self.space.check_path(plan.waypoints)
        self.assertEqual(answer["verdict"], "valid")
        self.assertTrue(verdict.valid)
        self.assertEqual(answer["min_clearance_m"], verdict.min_clearance)
        self.assertEqual(answer["policy"], self.space.policies)
        self.assertEqual(answer["padding_m"], self.space.padding)
        self.assertEqual(answer["swept"], self.space.survey_path(plan.waypoints)["swept"])
        self.assertEqual(again.to_json(), cw.parse_plan(plan.to_json()).to_json())
        np.testing.assert_array_equal(again.waypoints, plan.waypoints)

    def test_the_program_refuses_the_path_that_the_check_refuses(self):
        straight = np.array([self.start, self.goal])
        verdict = self.space.check_path(straight)
        self.assertFalse(verdict.valid)
        self.assertEqual(verdict.edge, 0)
        self.assertNotEqual(verdict.first_contact, "")
        plan = cw.plan(self.space, self.start, self.goal, planner="rrtconnect")
        bent = plan.to_dict()
        bent["waypoints"] = straight.tolist()
        bent["legs"][0]["waypoints"] = [0, 1]
        with worlds.folder() as folder:
            file = pathlib.Path(folder) / "plan.json"
            file.write_text(json.dumps(bent))
            answer = worlds.answer("check", file, *self.flags)
        self.assertEqual(answer["verdict"], "refused")
        # Its own words are not taken for the proof.
        with self.assertRaises(cw.PathRefused):
            cw.require_proved(cw.parse_plan(json.dumps(bent)), self.space)
        self.assertIs(cw.require_proved(plan, self.space), plan)
        said = plan.to_dict()
        for key, elsewhere in (("goals", [[value + 0.2 for value in said["goals"][0]]]),
                               ("start", [value + 0.2 for value in said["start"]])):
            missed = cw.parse_plan(json.dumps(said | {key: elsewhere}))
            self.assertFalse(missed.is_proved)
            with self.assertRaisesRegex(cw.PathRefused, key.removesuffix("s")):
                cw.require_proved(missed, self.space)
        self.assertEqual((answer["first_contact"], answer["edge"], answer["parameter"]),
                         (verdict.first_contact, verdict.edge, verdict.parameter))

    def test_joints_in_another_order_are_taken_by_their_names(self):
        plan = cw.plan(self.space, self.start, self.goal, planner="rrtconnect")
        said = plan.to_dict()
        said.pop("motion", None)
        said["joints"].reverse()
        for key in ("waypoints", "goals"):
            said[key] = [values[::-1] for values in said[key]]
        said["start"].reverse()
        turned = cw.parse_plan(json.dumps(said))
        self.assertTrue(cw.check_plan(self.space, turned).valid)
        np.testing.assert_allclose(cw.plan_motion(self.space, turned).motion.positions[-1], plan.waypoints[-1])
        said["joints"] = plan.joints
        self.assertFalse(cw.check_plan(self.space, cw.parse_plan(json.dumps(said))).valid)
        said["scale"] = 0.1
        with self.assertRaisesRegex(ValueError, "scale 1, as the space's is, got 0.1"):
            cw.check_plan(self.space, cw.parse_plan(json.dumps(said)))
        said["scale"] = self.robot.scale
        said["base"][0][3] += 1e-3
        with self.assertRaisesRegex(ValueError, r"whose base is where the space's is, \(0, 0, 0; .*got \(0.001, 0, 0; "):
            cw.check_plan(self.space, cw.parse_plan(json.dumps(said)))
        said["base"][0][3] -= 1e-3
        said["joints"] = ["other", *plan.joints[1:]]
        for use in (cw.check_plan, cw.plan_motion):
            with self.assertRaisesRegex(ValueError, "its joints other"):
                use(self.space, cw.parse_plan(json.dumps(said)))

    def test_plans_and_spaces_belong_together(self):
        plan = cw.plan(self.space, self.start, self.goal, planner="rrtconnect")
        empty = cw.FreeSpaceMap(self.map.resolution).snapshot()
        scaled = cw.ConfigurationSpace(self.robot.scaled(0.5), self.map)
        renamed = cw.parse_plan(json.dumps(plan.to_dict() | {"robot": "elsewhere/other.urdf"}))
        held = cw.parse_plan(json.dumps(plan.to_dict() | {"robot": "robots/puma560.yaml"}))
        with worlds.folder() as folder:
            empty.save(folder)
            other = cw.ConfigurationSpace(self.robot, cw.load_map(folder), "not_occupied")
        memory = cw.ConfigurationSpace(self.robot, empty, "not_occupied")
        for space, said, sentence in (
            (other, plan, "plan: expected one that was made on the space's map, with the sha256 .*…, got one made on another"),
            (memory, plan, "space's map, with the sha256 .*, got one made on another, .*; accept_map=True lets it"),
            (scaled, plan, "scale 0.5, as the space's is, got 1"),
            (self.space, renamed, "for the space's robot, 'puma560', got one for 'elsewhere/other.urdf'"),
        ):
            for use in (cw.check_plan, cw.plan_motion, lambda space, plan: cw.require_proved(plan, space)):
                with self.assertRaisesRegex(ValueError, sentence):
                    use(space, said)
        self.assertTrue(cw.check_plan(self.space, held).valid)
        self.assertTrue(cw.check_plan(memory, plan, accept_map=True).valid)
        self.assertIs(cw.require_proved(plan, memory, accept_map=True, allow_outside=["all"]), plan)
        ours = cw.plan(memory, self.start, self.goal)
        self.assertTrue(cw.check_plan(memory, ours).valid)
        with worlds.folder() as folder:  # a map is the same with a file and without
            empty.save(folder)
            again = cw.ConfigurationSpace(self.robot, cw.load_map(folder), "not_occupied")
            of_file = cw.plan(again, self.start, self.goal)
        self.assertTrue(cw.check_plan(again, ours).valid)
        self.assertTrue(cw.check_plan(memory, of_file).valid)
        seen = cw.FreeSpaceMap(self.map.resolution)
        seen.insert(np.array([[2.0, 2.0, 2.0]]), worlds.pose(1.9, 1.9, 1.9))
        newer = cw.ConfigurationSpace(self.robot, seen.snapshot(), "not_occupied")
        with self.assertRaisesRegex(ValueError, "accept_map=True lets it"):
            cw.plan_motion(newer, of_file)
        with self.assertRaisesRegex(ValueError, "is not proved"):  # as it leaves the map
            cw.plan_motion(newer, of_file, accept_map=True)
        coarse = cw.ConfigurationSpace(self.robot, cw.FreeSpaceMap(0.5).snapshot(), "not_occupied")
        with self.assertRaisesRegex(ValueError, "on voxels of 0.5 m"):
            cw.check_plan(coarse, ours)
        for looser, sentence in ((cw.ConfigurationSpace(self.robot, self.map, "not_occupied"), "not_occupied, got one that demands painted"),
                                 (cw.ConfigurationSpace(self.robot, self.map, padding=0.0), "padding, 0 m, got ")):
            with self.assertRaisesRegex(ValueError, sentence):
                cw.plan_motion(looser, plan)
        for use in (cw.plan_trajectory,
                    lambda robot, plan: cw.export_trajectory(robot, plan, cw.plan_trajectory(self.robot, plan), "csv")):
            with self.assertRaisesRegex(ValueError, "scale 0.5, as the robot's is"):
                use(self.robot.scaled(0.5), plan)

    def test_the_program_judges_the_motion_of_a_saved_plan(self):
        plan = cw.plan(self.space, self.start, self.goal, planner="rrtconnect")
        planned = cw.plan_motion(self.space, plan)
        with worlds.folder() as folder:
            file = pathlib.Path(folder) / "plan.json"
            plan.save(file, motion=planned)
            answer = worlds.answer("check", file, *self.flags)
            again = cw.load_plan(file)
            back = cw.plan(self.space, self.goal, self.start, planner="rrtconnect")
            with self.assertRaisesRegex(ValueError, "motion: expected one from the plan's start to its end"):
                back.save(file, motion=planned)
        self.assertEqual((answer["verdict"], answer["motion"]["verdict"]), ("valid", "valid"))
        np.testing.assert_array_equal(again.motion.motion.positions, planned.motion.positions)
        self.assertIsNone(plan.motion)

    def test_goals_may_be_poses(self):
        pose = self.robot.tip_pose(self.goal)
        plan = cw.plan(self.space, self.start, goal_poses=pose, planner="rrtconnect")
        self.assertTrue(plan.is_proved, plan.explanation)
        np.testing.assert_allclose(self.robot.tip_pose(plan.waypoints[-1]), pose, atol=1e-5)
        x, y, z = pose[:3, 3]
        pitch = -np.arcsin(pose[2, 0])
        roll, yaw = np.arctan2(pose[2, 1], pose[2, 2]), np.arctan2(pose[1, 0], pose[0, 0])
        answer = worlds.answer("plan", *self.flags, "--planner", "rrtconnect", "--start=" + text(self.start),
                             "--goal-pose=" + text([x, y, z, roll, pitch, yaw]))
        np.testing.assert_allclose(plan.goals, answer["goals"], atol=1e-6)

    def test_single_questions_and_arrays_agree_and_edges_hold_at_samples(self):
        dice = np.random.default_rng(5)
        qs = self.start + dice.uniform(-0.4, 0.4, (60, 6)) * [2, 0.5, 0.5, 1, 1, 1]
        free = self.space.are_free(qs)
        self.assertEqual(free.tolist(), [self.space.is_free(q) for q in qs])
        self.assertEqual(free.tolist(), [self.space.check(q).is_free for q in qs])
        self.assertTrue(0 < free.sum() < len(qs))
        distances = self.space.clearances(qs)
        self.assertEqual(distances.tolist(), [self.space.clearance(q) for q in qs])
        self.assertTrue(((distances > 0) <= free).all())
        edges = self.space.are_edges_free(qs[:-1], qs[1:])
        for i in range(len(edges)):
            self.assertEqual(edges[i], self.space.is_edge_free(qs[i], qs[i + 1]))
            self.assertEqual(edges[i], self.space.free_share(qs[i], qs[i + 1]) == 1.0)
            if edges[i]:
                self.assertTrue(self.space.are_free(np.linspace(qs[i], qs[i + 1], 200)).all())
        blocked = self.space.check(qs[np.argmin(free)])
        self.assertIn(blocked.part, blocked.sentence)
        self.assertNotEqual(blocked.obstruction, "none")

    def test_what_is_no_configuration_is_not_free(self):
        for value in (np.nan, np.inf, -np.inf, 1e300):
            q = self.start.copy()
            q[2] = value
            self.assertFalse(self.space.is_free(q))
            self.assertEqual(self.space.are_free([q, self.start]).tolist(), [False, True])
            self.assertFalse(self.space.is_edge_free(self.start, q))
            self.assertEqual(self.space.are_edges_free([self.start], [q]).tolist(), [False])
            self.assertLess(self.space.free_share(self.start, q), 1.0)
            self.assertIn(self.space.check(q).obstruction, ("not_finite", "joint_limit"))
            self.assertFalse(self.space.clearance(q) > 0)
            self.assertFalse(self.space.check_path([self.start, q]).valid)
            self.assertEqual(cw.plan(self.space, q, self.goal).status, "start_invalid")
            self.assertEqual(cw.plan(self.space, self.start, q).status, "goal_invalid")
        self.assertFalse(self.space.check_path(np.empty((0, 6))).valid)

    def test_outcomes_are_errors_for_those_who_want_them(self):
        plan = cw.plan(self.space, self.start, self.goal, planner="rrtconnect")
        self.assertIs(cw.require_proved(plan), plan)
        outside = self.goal + [0.9, 0, 0, 0, 0, 0]
        for error, start, goal, options in (
            (cw.StartInvalid, outside, self.goal, {}),
            (cw.GoalInvalid, self.start, outside, {}),
            (cw.NoPath, self.start, self.goal, {"planner": "beam", "max_steps": 2, "width": 1}),
            (cw.TimedOut, self.start, self.goal, {"planner": "rrtconnect", "time_limit": 1e-9}),
        ):
            with self.assertRaises(error) as raised:
                cw.require_proved(cw.plan(self.space, start, goal, advice_time=0.0, **options))
            self.assertIsInstance(raised.exception, cw.PlanError)
            self.assertEqual(str(raised.exception), raised.exception.plan.explanation)
            self.assertEqual(raised.exception.plan.waypoints.shape, (0, 6))

    def test_policies_and_padding_are_as_asked(self):
        tool = self.robot.critical_parts[0]
        self.assertEqual(self.space.policies[tool], "painted")
        self.assertEqual(self.space.padding, self.robot.position_accuracy)
        loose = cw.ConfigurationSpace(self.robot, self.map, "not_occupied", padding=0.0)
        self.assertEqual((set(loose.policies.values()), loose.padding), ({"not_occupied"}, 0.0))
        mixed = cw.ConfigurationSpace(self.robot, self.map, {tool: "known_free"}, other="not_occupied")
        self.assertEqual(mixed.policies[tool], "known_free")
        self.assertFalse(cw.ConfigurationSpace(self.robot, self.map, padding=0.3).is_free(self.start))

    def test_threads_plan_at_the_same_time(self):
        plans = [None] * 4

        def work(i):
            plans[i] = cw.plan(self.space, self.start, self.goal, planner="rrtconnect", seed=i % 2)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(without_times(plans[0].to_dict()), without_times(plans[2].to_dict()))
        self.assertEqual(without_times(plans[1].to_dict()), without_times(plans[3].to_dict()))
        self.assertTrue(all(plan.is_proved for plan in plans))

    def test_threads_that_work_when_the_interpreter_ends_do_not_abort_it(self):
        code = (
            "import threading, time, numpy as np, clearway as cw\n"
            "space = cw.ConfigurationSpace(cw.load_robot('puma560'), cw.FreeSpaceMap().snapshot(), 'not_occupied')\n"
            "qs = np.random.default_rng(1).uniform(-1, 1, (20000, 6))\n"
            "def work():\n"
            "    while True: space.are_free(qs)\n"
            "for _ in range(3): threading.Thread(target=work, daemon=True).start()\n"
            "time.sleep(0.3)\n"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_mistakes_are_one_sentence(self):
        for make in (
            lambda: cw.plan(self.space, self.start, self.goal, planner="beem"),
            lambda: cw.plan(self.space, self.start, self.goal, planner="beam", widht=20),
            lambda: cw.plan(self.space, self.start, self.goal, planner="beam", width=-1),
            lambda: cw.plan(self.space, self.start[:5], self.goal),
            lambda: cw.plan(self.space, self.start, []),
            lambda: cw.plan(self.space, self.start),
            lambda: cw.plan(self.space, self.start, self.goal, goal_poses=np.eye(4)),
            lambda: cw.plan(self.space, self.start, goal_poses=worlds.pose(90.0)),
            lambda: cw.plan(self.space, "home", self.goal),
            lambda: cw.plan(self.space, self.start, self.goal, time_limit=0.0),
            lambda: cw.plan(self.space, self.start, self.goal, time_limit=np.nan),
            lambda: cw.plan(self.space, self.start, self.goal, payload=-1.0),
            lambda: cw.plan(self.space, self.start, self.goal, gravity=[0, 0, np.nan]),
            lambda: cw.plan(self.space, self.start, self.goal, allow_outside=["nose"]),
            lambda: cw.ConfigurationSpace(self.robot, self.map, "free"),
            lambda: cw.ConfigurationSpace(self.robot, self.map, {"nose": "painted"}),
            lambda: cw.ConfigurationSpace(self.robot, self.map, padding=-1.0),
            lambda: cw.ConfigurationSpace(self.robot, self.map, padding=np.nan),
            lambda: cw.ConfigurationSpace(self.robot, self.map, seen_within=-1.0),
            lambda: self.space.are_edges_free([self.start], [self.start, self.goal]),
            lambda: self.space.check_path([self.start, self.goal], distance_cap=-1.0),
            lambda: cw.parse_plan("{}"),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,500}$")


class Planners(unittest.TestCase):
    def test_every_planner_by_its_name_goes_around_a_wall(self):
        robot = cw.load_robot("point")
        fused = cw.FreeSpaceMap(resolution=0.1)
        y = np.linspace(-0.6, 0.6, 61)
        fused.insert(np.column_stack([np.full_like(y, 0.05), y, np.full_like(y, 0.05)]))
        space = cw.ConfigurationSpace(robot, fused.snapshot(), "not_occupied", padding=0.0)
        start, goal = np.zeros(robot.dof), np.zeros(robot.dof)
        start[0], goal[0] = -0.8, 0.9
        self.assertFalse(space.is_edge_free(start, goal))
        certified = 0
        for name, description in cw.available_planners().items():
            with self.subTest(name):
                self.assertTrue(description)
                self.assertIsInstance(cw.planner_options(name), dict)
                plan = cw.plan(space, start, goal, planner=name, time_limit=1.5, advice_time=0.0, allow_outside=["all"])
                self.assertIn(plan.status, ("solved", "no_path", "timed_out"))
                self.assertEqual(plan.planner, name)
                if plan.status == "solved" and not name.endswith("_fcl"):
                    self.assertTrue(plan.validation.valid, plan.validation.first_contact)
                    certified += 1
        self.assertGreaterEqual(certified, 8)


class Results(unittest.TestCase):
    def test_what_compare_found_is_what_its_table_says(self):
        import csv

        with worlds.folder() as folder:
            out = pathlib.Path(folder) / "out"
            status, _, err = worlds.run("compare", "quick", "--planners", "beam,rrtconnect", "--out", out)
            self.assertEqual(status, 0, err)
            found = cw.load_results(out)
            rows = list(csv.DictReader((out / "results.csv").read_text().splitlines()))
        self.assertEqual(len(found["runs"]), len(rows))
        self.assertEqual([(row["name"], type(row["seed"])) for row in found["suites"]], [("quick", int)])
        for problem in found["problems"]:
            self.assertEqual(np.shape(problem["goals"])[1:], np.shape(problem["start"]))
        for experiment in found["experiments"]:
            self.assertEqual((type(experiment["policies"]), np.shape(experiment["gravity"])), (dict, (3,)))
        for run, row in zip(found["runs"], rows):
            self.assertEqual(run["status"], row["status"])
            self.assertEqual((run["seed"], run["options"]), (int(row["seed"]), json.loads(row["options"])))
            self.assertAlmostEqual(run["length_rad"], float(row["length_rad"]), places=6)
        with self.assertRaisesRegex(FileNotFoundError, "results.sqlite"):
            cw.load_results("/nowhere")
        with worlds.folder() as folder:
            (pathlib.Path(folder) / "results.sqlite").write_bytes(b"SQLite format 3\0" + b"\xff" * 3000)
            with self.assertRaisesRegex(cw.DamagedFile, "not whole"):
                cw.load_results(folder)


if __name__ == "__main__":
    unittest.main()
