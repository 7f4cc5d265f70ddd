"""Motions, trajectories and the gate from Python, against cubics in NumPy and the command line program."""

import csv
import io
import json
import pathlib
import subprocess
import os
import unittest

import numpy as np

import clearway as cw
import worlds


def hermite(motion, time):
    """Position and velocity of the cubic between two knots."""
    i = min(int(time / motion.period), len(motion.times) - 2)
    s, h = time / motion.period - i, motion.period
    p0, p1, v0, v1 = motion.positions[i], motion.positions[i + 1], motion.velocities[i], motion.velocities[i + 1]
    position = (2 * s**3 - 3 * s**2 + 1) * p0 + (s**3 - 2 * s**2 + s) * h * v0 + (3 * s**2 - 2 * s**3) * p1 + (s**3 - s**2) * h * v1
    velocity = (6 * s**2 - 6 * s) / h * (p0 - p1) + (3 * s**2 - 4 * s + 1) * v0 + (3 * s**2 - 2 * s) * v1
    return position, velocity


class Motions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot, cls.map, cls.start, cls.goal = worlds.arcs()
        cls.space = cw.ConfigurationSpace(cls.robot, cls.map)
        cls.plan = cw.require_proved(cw.plan(cls.space, cls.start, cls.goal, planner="rrtconnect"))
        cls.planned = cw.plan_motion(cls.space, cls.plan)

    def test_the_motion_is_the_cubic_between_its_knots(self):
        motion = self.planned.motion
        times = np.linspace(0.0, motion.duration, 301)
        states = motion.at(times)
        for time, position, velocity in zip(times, states["position"], states["velocity"]):
            expected = hermite(motion, time)
            np.testing.assert_allclose(position, expected[0], atol=1e-9)
            np.testing.assert_allclose(velocity, expected[1], atol=1e-7)
        one = motion.at(float(times[77]))
        np.testing.assert_array_equal(one["position"], states["position"][77])
        self.assertEqual(one["jerk"].shape, (6,))
        np.testing.assert_array_equal(states["position"][0], self.start)
        np.testing.assert_allclose(states["position"][-1], self.goal, atol=1e-9)
        np.testing.assert_allclose(motion.velocities[[0, -1]], 0.0, atol=1e-12)

    def test_it_keeps_limits_and_is_free_at_samples(self):
        motion = self.planned.motion
        self.assertTrue(self.planned.validation.valid, self.planned.validation.fault)
        limits = np.where(self.robot.max_velocity > 0, self.robot.max_velocity, 1.0)
        states = motion.at(np.linspace(0.0, motion.duration, 2001))
        self.assertLessEqual((np.abs(states["velocity"]) / limits).max(), 1 + 1e-6)
        self.assertTrue(self.space.are_free(states["position"]).all())
        self.assertAlmostEqual((np.abs(states["velocity"]) / limits).max(), self.planned.validation.shares.velocity, delta=0.01)
        slow = cw.plan_motion(self.space, self.plan, speed=0.25).motion
        self.assertGreater(slow.duration, motion.duration)
        self.assertLessEqual((np.abs(slow.at(np.linspace(0, slow.duration, 999))["velocity"]) / limits).max(), 0.25 + 1e-6)

    def test_exported_numbers_read_back_to_the_same(self):
        motion = self.planned.motion
        trajectory = cw.trajectory_of(motion)
        np.testing.assert_array_equal(trajectory.positions, motion.positions)
        np.testing.assert_array_equal(trajectory.accelerations, motion.accelerations)
        answer = json.loads(cw.export_trajectory(self.robot, self.plan, trajectory, "ros-json"))
        points = answer["points"] if "points" in answer else answer["trajectory"]["points"]
        np.testing.assert_array_equal([point["positions"] for point in points], motion.positions)
        np.testing.assert_array_equal([point["velocities"] for point in points], motion.velocities)
        table = list(csv.reader(io.StringIO(cw.export_trajectory(self.robot, self.plan, trajectory, "csv"))))
        np.testing.assert_array_equal(np.array(table[1:], float)[:, 1:7], motion.positions)
        with self.assertRaisesRegex(ValueError, "ros"):
            cw.export_trajectory(self.robot, self.plan, trajectory, "rosy")

    def test_the_program_exports_the_same(self):
        with worlds.folder() as folder:
            self.map.save(folder)
            space = cw.ConfigurationSpace(self.robot, cw.load_map(folder))
            plan = cw.plan(space, self.start, self.goal, planner="rrtconnect")
            file = pathlib.Path(folder) / "motion.csv"
            text = [",".join(map(repr, q.tolist())) for q in (self.start, self.goal)]
            worlds.answer("plan", "--map", folder, "--robot", "puma560", "--planner", "rrtconnect", "--start=" + text[0],
                          "--goal=" + text[1], "--export", "csv", file)
            trajectory = cw.trajectory_of(cw.plan_motion(space, plan).motion)
            self.assertEqual(file.read_text(), cw.export_trajectory(self.robot, plan, trajectory, "csv"))

    def test_plans_of_a_placed_robot_are_what_the_program_makes(self):
        base = worlds.pose(turn=0.2)  # about the axis of the first joint
        start, goal = (q - [0.2, 0, 0, 0, 0, 0] for q in (self.start, self.goal))
        placed = self.robot.placed(base)
        with worlds.folder() as folder:
            self.map.save(folder)
            file, exported = pathlib.Path(folder) / "plan.json", pathlib.Path(folder) / "motion.json"
            answer = worlds.answer("plan", "--map", folder, "--robot", "puma560", "--base=0,0,0,0,0,0.2", "--planner", "rrtconnect",
                                   "--start=" + worlds.text(start), "--goal=" + worlds.text(goal), "--out", file, "--motion",
                                   "--export", "json", exported)
            plan = cw.load_plan(file)
            space = cw.ConfigurationSpace(placed, cw.load_map(folder))
            verdict = cw.check_plan(space, plan)
            self.assertTrue(verdict.valid, verdict.first_contact)
            checked = worlds.answer("check", file, "--map", folder, "--robot", "puma560", "--base=0,0,0,0,0,0.2")
            self.assertEqual(checked["verdict"], "valid")
            proved = cw.require_proved(plan, space)
            planned = cw.plan_motion(space, proved)
            np.testing.assert_array_equal(planned.motion.positions, answer["motion"]["positions"])
            for robot in (self.robot, placed):  # one that nobody placed stands where the plan has it
                trajectory = cw.plan_trajectory(robot, proved)
                np.testing.assert_array_equal(trajectory.positions, planned.motion.positions)
                text = cw.export_trajectory(robot, proved, trajectory, "json")
                made, expected = json.loads(text), json.loads(exported.read_text())
                self.assertEqual(made.keys(), expected.keys())
                for key, value in expected.items():
                    if isinstance(value, list) and isinstance(value[0], list):  # accelerations but for rounding
                        np.testing.assert_allclose(made[key], value, atol=1e-9, err_msg=key)
                    else:
                        self.assertEqual(made[key], value, key)
            for make in (
                lambda: cw.plan_trajectory(self.robot.placed(worlds.pose(0.1)), proved),
                lambda: cw.check_plan(cw.ConfigurationSpace(self.robot, cw.load_map(folder)), proved),
                lambda: cw.plan_motion(cw.ConfigurationSpace(self.robot, cw.load_map(folder)), proved),
            ):
                with self.assertRaisesRegex(ValueError, "base is where"):
                    make()

    def test_a_motion_from_a_file_is_checked_whatever_the_file_says(self):
        with worlds.folder() as folder:
            self.map.save(folder)
            space = cw.ConfigurationSpace(self.robot, cw.load_map(folder))
            text = [",".join(map(repr, q.tolist())) for q in (self.start, self.goal)]
            answer = worlds.answer("plan", "--map", folder, "--robot", "puma560", "--planner", "rrtconnect",
                                 "--start=" + text[0], "--goal=" + text[1], "--motion")
            self.assertEqual(answer["motion"]["verdict"], "valid")
            self.assertTrue(cw.require_proved(cw.parse_plan(json.dumps(answer)), space).is_proved)
            knots = answer["motion"]["positions"]
            for knot in knots[len(knots) // 4 : -len(knots) // 4]:
                knot[0] += 1.0  # a leap
            leaping = cw.parse_plan(json.dumps(answer))
            with self.assertRaisesRegex(cw.PathRefused, "the motion: "):
                cw.require_proved(leaping, space)
            answer["motion"]["verdict"] = "refused"
            with self.assertRaisesRegex(ValueError, "motion"):
                cw.plan_trajectory(self.robot, cw.parse_plan(json.dumps(answer)))

    def test_edges_without_blends_stay_on_the_path(self):
        waypoints = self.plan.waypoints
        trajectory = cw.time_parameterize(self.robot, waypoints, sampling_period=0.01)
        np.testing.assert_array_equal(trajectory.positions[[0, -1]], waypoints[[0, -1]])
        np.testing.assert_allclose(np.diff(trajectory.times), 0.01, atol=1e-12)
        for position in trajectory.positions[::25]:
            gaps = []
            for a, b in zip(waypoints[:-1], waypoints[1:]):
                share = np.clip(np.dot(position - a, b - a) / np.dot(b - a, b - a), 0, 1)
                gaps.append(np.linalg.norm(a + share * (b - a) - position))
            self.assertLess(min(gaps), 1e-9)

    def test_mistakes_are_one_sentence(self):
        refused = cw.plan(self.space, self.start, self.goal + [0.9, 0, 0, 0, 0, 0], advice_time=0.0)
        way = cw.time_parameterize(self.robot, self.plan.waypoints)
        elsewhere = cw.time_parameterize(self.robot, [self.start, self.start + 0.1])
        self.assertIn("def", cw.export_trajectory(self.robot, self.plan, way, "urscript"))
        for make in (
            lambda: cw.plan_motion(self.space, refused),
            lambda: cw.plan_motion(self.space, self.plan, speed=0.0),
            lambda: cw.plan_motion(self.space, self.plan, period=np.nan),
            lambda: cw.time_parameterize(self.robot, np.empty((0, 6))),
            lambda: cw.time_parameterize(self.robot, [[np.nan] * 6]),
            lambda: cw.time_parameterize(self.robot, self.plan.waypoints, velocity_scale=2.0),
            lambda: self.planned.motion.at([0.0, np.nan]),
            lambda: self.planned.motion.at(-1.0),
            lambda: self.planned.motion.at(np.zeros((2, 2))),
            # What a controller would follow is of a proved plan, of its robot, from its start to its end.
            lambda: cw.export_trajectory(self.robot, refused, way, "csv"),
            lambda: cw.export_trajectory(cw.load_robot("panda"), self.plan, way, "csv"),
            lambda: cw.export_trajectory(self.robot, self.plan, elsewhere, "urscript"),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,500}$")


class Gates(unittest.TestCase):
    @staticmethod
    def space():
        return cw.ConfigurationSpace(cw.load_robot("puma560"), cw.FreeSpaceMap().snapshot(), "not_occupied")

    def test_chunks_are_judged_as_by_the_program(self):
        robot = cw.load_robot("puma560")
        fused = cw.FreeSpaceMap()
        x, z = np.meshgrid(np.arange(-0.8, 0.8, 0.01), np.arange(-0.6, 0.8, 0.01))
        fused.insert(np.column_stack([x.ravel(), np.full(x.size, 1.01), z.ravel()]), worlds.pose(0.8, -0.6, 0.6))
        chunks, q, time = [], np.array([-0.8, -0.8, 0.3, 0.0, 0.4, 0.0]), 0.0
        for speed in np.arange(0.4, 3.0, 0.2):
            positions = np.tile(q, (8, 1))
            positions[:, 0] += 0.05 * speed * np.arange(8)
            chunks.append((time + 0.05 * np.arange(8), positions))
            q, time = positions[-1], chunks[-1][0][-1]
        broken = chunks[2][1].copy()
        broken[3, 2] = 1e9
        chunks.append((chunks[2][0], broken))
        rod = cw.Load("rod", "tool", worlds.pose(0.0, 0.0, 0.2), box=[0.05, 0.4, 0.05])
        for loads in ([], [rod]):
            with worlds.folder() as folder:
                fused.snapshot().save(folder)
                lines = "\n".join(json.dumps({"times": t.tolist(), "positions": p.tolist()}) for t, p in chunks) + "\n"
                flags = ["gate", "--map", folder, "--robot", "puma560", "--policy", "not_occupied"]
                if loads:
                    file = pathlib.Path(folder) / "rod.yaml"
                    file.write_text("{name: rod, box: [0.05, 0.4, 0.05], link: tool, pose: [0, 0, 0.2, 0, 0, 0]}")
                    flags += ["--attach", str(file)]
                done = subprocess.run([os.environ["CLEARWAY_BINARY"], *flags], input=lines, capture_output=True, text=True)
                answer = [json.loads(line) for line in done.stdout.splitlines()]
                self.assertGreaterEqual(len(answer), len(chunks), done.stderr)
            gate = cw.Gate()
            self.assertEqual(gate.judge(*chunks[0]).reason, "no_map")
            gate = cw.Gate()
            gate.publish(cw.ConfigurationSpace(robot, fused.snapshot(), "not_occupied"), loads=loads)
            verdicts = [gate.judge(times, np.asfortranarray(positions)) for times, positions in chunks]
            self.assertGreater(len({verdict.reason for verdict in verdicts}), 2)
            self.assertEqual("rod" in [verdict.obstruction.part for verdict in verdicts], bool(loads))
            for verdict, line in zip(verdicts, answer):
                self.assertEqual(line["passed"], verdict.is_passed, line)
                if not verdict.is_passed:
                    self.assertEqual(line["reason"], verdict.reason)
                    self.assertTrue(line["sentence"].startswith(verdict.sentence), (line, verdict))
                if line.get("piece"):
                    self.assertEqual(line["piece"]["proved_share"], verdict.parameter)
                    self.assertEqual(line["body"], verdict.obstruction.part)
                self.assertEqual(bool(line.get("voxel")), bool(verdict.evidence))
                self.assertIn(verdict.evidence, line.get("sentence", ""))
                if line.get("may_go"):
                    self.assertEqual(line["may_go"]["until_s"], verdict.may_go.time)
                    self.assertEqual(line["may_go"]["position"], verdict.may_go.position.tolist())
                    self.assertEqual(line["may_go"]["stands_at"], verdict.may_go.stop.tolist())
        with self.assertRaisesRegex(ValueError, "expected no legs"):
            cw.Gate().publish(self.space(), loads=[cw.Load("rod", "link6", box=[0.03, 0.03, 0.4], legs=[0])])

    def test_a_chunk_may_leave_the_last_one_in_its_midst(self):
        gate = cw.Gate(allow_outside=["all"])
        gate.publish(self.space())
        positions = np.tile([-0.8, -0.8, 0.3, 0.0, 0.4, 0.0], (8, 1))
        positions[:, 0] += 0.01 * np.arange(8)
        times = 0.1 * np.arange(8)
        self.assertTrue(gate.judge(times, positions).is_passed)
        self.assertEqual(gate.judge(times[4:], positions[4:]).reason, "jump")
        self.assertEqual(gate.judge(times[4:], positions[4:], leaves_at=3).reason, "jump")
        self.assertTrue(gate.judge(times[4:], positions[4:], leaves_at=4).is_passed)
        self.assertRegex(gate.judge(times[4:], positions[4:], leaves_at=9).sentence, "has 4 configurations")
        with self.assertRaises(TypeError):
            gate.judge(times[4:], positions[4:], leaves_at=-1)

    def test_a_volume_that_names_a_load_counts_for_it(self):
        robot = cw.load_robot("puma560")
        q = np.array([-0.8, -0.8, 0.3, 0.0, 0.4, 0.0])
        at = (robot.tip_pose(q) @ worlds.pose(0.0, 0.0, 0.1))[:3, 3]
        for center, passes in ((at, True), (at + [0.0, 0.0, 0.5], False)):
            fused = cw.FreeSpaceMap()
            fused.paint(fused.add_volume("of the rod", ["rod"]), center, 0.3)
            gate = cw.Gate()
            load = cw.Load("rod", "tool", worlds.pose(0.0, 0.0, 0.1), box=[0.03, 0.03, 0.03])
            gate.publish(cw.ConfigurationSpace(robot, fused.snapshot(), "not_occupied"), loads=[load])
            verdict = gate.judge([0.0, 1.0], np.tile(q, (2, 1)))
            self.assertEqual(verdict.is_passed, passes, verdict)

    def test_mistakes_are_one_sentence(self):
        gate = cw.Gate(max_velocity=[1.0] * 6, deceleration=3.0)
        for make in (
            lambda: gate.judge([0.0, 0.1], np.zeros(6)),
            lambda: gate.judge([0.0], np.zeros((2, 6))),
            lambda: gate.judge([0.0, 0.1], np.zeros((2, 6), complex)),
            lambda: cw.Gate(deceleration=0.0).publish(self.space()),
            lambda: cw.Gate(max_velocity=[1.0, 2.0]).publish(self.space()),
            lambda: gate.restart([np.nan] * 6),
            lambda: gate.restart(3.0),
            lambda: cw.Gate(tolerance=np.nan),
            lambda: cw.Gate(max_age=-1.0),
            lambda: cw.Gate(max_age=1.0).publish(self.space()),  # nobody says when the map was taken
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,500}$")


if __name__ == "__main__":
    unittest.main()
