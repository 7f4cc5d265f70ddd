"""Teams from Python, against the command line program and dense samples."""

import json
import pathlib
import unittest

import numpy as np

import clearway as cw
import worlds

SUITE = """
experiments:
  - name: together
    planners: [{planner: boundary}, {planner: constraint}]
    duration: 20
    teams:
      - name: past each other
        robots:
          - {name: left, robot: point, start: [0, 0], goal: [2, 0]}
          - {name: right, robot: point, start: [2, 0.1], goal: [0, 0.1]}
        moving:
          - shape: {name: ball, sphere: 0.1}
            path: [{time: 0, pose: [1, 2, 0, 0, 0, 0]}, {time: 10, pose: [1, -2, 0, 0, 0, 0]}]
"""


class Teams(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        space = cw.ConfigurationSpace(cw.load_robot("point"), cw.FreeSpaceMap(resolution=0.05).snapshot(), "not_occupied", padding=0.0)
        cls.space = space
        cls.robots = [cw.TeamRobot("left", space, [0, 0], [2, 0]), cw.TeamRobot("right", space, [2, 0.1], [0, 0.1])]
        cls.ball = cw.MovingObstacle("ball", [0, 10], [worlds.pose(1, 2), worlds.pose(1, -2)], sphere=0.1)

    def test_runs_are_those_of_the_program_bit_for_bit(self):
        with worlds.folder() as folder:
            suite = pathlib.Path(folder) / "together.yaml"
            suite.write_text(SUITE)
            status, _, err = worlds.run("compare", suite, "--out", pathlib.Path(folder) / "out")
            self.assertEqual(status, 0, err)
            written = [json.loads(file.read_text()) for file in sorted(pathlib.Path(folder).glob("out/teams/**/*.json"))]
        self.assertEqual([team["planner"] for team in written], ["boundary", "constraint"])
        for team in written:
            run = cw.run_team(self.robots, [self.ball], planner=team["planner"], duration=20.0)
            self.assertEqual(run.status, team["status"])
            self.assertEqual(run.period, team["period_s"])
            self.assertEqual(run.security_distance, team["security_distance_m"])
            self.assertEqual(run.step_bound, team["step_bound_m"])
            for trace, robot in zip(run.traces, team["robots"]):
                self.assertEqual(trace.positions.tolist(), robot["positions"])
                self.assertEqual(trace.separations.tolist(), robot["separations_m"])
            verdict = cw.check_team(self.robots, run, [self.ball])
            for name in ("is_apart", "least_separation", "between", "contact", "greatest_speed_share"):
                self.assertEqual(getattr(verdict, name), team["check"].get(name, team["check"].get(name + "_m")), name)

    def test_separations_hold_at_samples(self):
        run = cw.run_team(self.robots, [self.ball], duration=20.0)
        self.assertEqual(run.status, "solved")
        verdict = cw.check_team(self.robots, run, [self.ball])
        self.assertTrue(verdict.is_apart)
        left, right = (trace.positions for trace in run.traces)
        np.testing.assert_array_equal(left[0], self.robots[0].start)
        np.testing.assert_allclose(left[-1], self.robots[0].goal, atol=1e-9)
        radius = self.space.robot.bodies[0].radius
        apart = np.linalg.norm(left - right, axis=1) - 2 * radius
        balls = np.array([self.ball.pose(run.period * k)[:2, 3] for k in range(len(left))])
        from_ball = np.minimum(np.linalg.norm(left - balls, axis=1), np.linalg.norm(right - balls, axis=1)) - radius - 0.1
        self.assertGreaterEqual(min(apart.min(), from_ball.min()) + 1e-9, verdict.least_separation)
        self.assertGreater(verdict.least_separation, 0.0)
        self.assertLess(verdict.least_separation, 0.5)
        alone = cw.check_team(self.robots, run)
        self.assertEqual(alone.least_separation, verdict.between_robots)

    def test_who_is_run_over_is_named(self):
        train = cw.MovingObstacle("train", [0, 1], [worlds.pose(3), worlds.pose(-3)], box=[0.4, 4, 0.4])
        self.assertAlmostEqual(train.greatest_speed, 6.0)
        slow = [cw.TeamRobot("slow", self.space, [0, 0], [0, 0.5])]
        run = cw.run_team(slow, [train])
        self.assertIn("'train'", run.outrun)
        self.assertFalse(cw.check_team(slow, run, [train]).is_apart)
        self.assertGreater(run.traces[0].relaxed, 0)

    def test_mistakes_are_one_sentence(self):
        run = cw.run_team(self.robots, duration=0.5)
        self.assertEqual(run.status, "timed_out")
        for make in (
            lambda: cw.run_team([]),
            lambda: cw.run_team(self.robots + self.robots),
            lambda: cw.run_team(self.robots, planner="beam"),
            lambda: cw.run_team(self.robots, leave_ration=1.0),
            lambda: cw.run_team(self.robots, period=0.0),
            lambda: cw.run_team(self.robots, duration=np.nan),
            lambda: cw.run_team(self.robots, max_acceleration=-1.0),
            lambda: cw.TeamRobot("left", self.space, [0], [2, 0]),
            lambda: cw.run_team([cw.TeamRobot("left", self.space, [np.nan, 0], [2, 0])]),
            lambda: cw.MovingObstacle("ball", [0, 10], [np.eye(4)], sphere=0.1),
            lambda: cw.MovingObstacle("ball", [1, 0], [np.eye(4), np.eye(4)], sphere=0.1),
            lambda: cw.MovingObstacle("ball", [0, np.nan], [np.eye(4), np.eye(4)], sphere=0.1),
            lambda: cw.MovingObstacle("ball", [0], [np.eye(4)]),
            lambda: cw.MovingObstacle("ball", [0, 1], [np.eye(4), worlds.pose(1)], sphere=0.1, repeats=True),
            lambda: cw.check_team(self.robots[:1], run),
            lambda: cw.check_team(self.robots, run, cap=0.0),
            lambda: cw.check_team(self.robots, run, max_acceleration=0.0),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,500}$")


if __name__ == "__main__":
    unittest.main()
