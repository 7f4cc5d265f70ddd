"""A planner in another program (apps/compare/YOUR_PLANNER.md), from the command line to the verdict of the check."""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

CLEARWAY = os.environ["CLEARWAY_BINARY"]
EXAMPLE = pathlib.Path(os.environ["CLEARWAY_SOURCE"]) / "apps/examples/planner/rrt_connect.py"

SUITE = """
title: Round a wall
time_limit: 20
worlds:
  - name: wall
    resolution: 0.05
    solids:
      - {name: wall, box: [0.06, 0.3, 0.6], pose: [0.6, 0, 0.8, 0, 0, 0]}
    sensors: [[0.6, -1.5, 0.8], [0.6, 1.5, 0.8], [1.6, 0, 0.8]]
    sensor_range: 3
experiments:
  - name: round
    robot: puma560
    world: wall
    problems:
      - {name: past, start: [-0.8, -0.8, 0.3, 0, 0.4, 0], goals: [[0.8, -0.8, 0.3, 0, 0.4, 0]]}
    policies: {default: not_occupied}
    planners: [{planner: rrtconnect}]
"""


class ExternalPlanner(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        (self.path / "suite.yaml").write_text(SUITE)

    def compare(self, command, *flags, suite=None):
        out = self.path / "out"
        arguments = [CLEARWAY, "compare", suite or self.path / "suite.yaml", "--external", "mine=" + command, "--out", out,
                     "--worst-pages", "0"]
        run = subprocess.run([*arguments, "--json", *flags], capture_output=True, text=True, check=False)
        plans = {file.stem: json.loads(file.read_text()) for file in out.glob("plans/*/*/*.json")}
        return run, plans

    def test_the_example_solves_the_problems_that_its_page_names(self):
        run, _ = self.compare(f"{sys.executable} {EXAMPLE}", "--planners", "mine", "--time-limit", "100", suite="quick")
        self.assertEqual(run.returncode, 0, run.stderr)
        plans = [json.loads(file.read_text()) for file in (self.path / "out").glob("plans/*/*/*.json")]
        self.assertEqual([plan["validation"]["verdict"] for plan in plans], 6 * ["valid"])

    def program(self, text):
        file = self.path / "program.py"
        file.write_text("import json, sys\n" + text)
        return f"{sys.executable} {file}"

    def test_the_example_finds_paths_that_the_check_holds_valid(self):
        run, plans = self.compare(f"{sys.executable} {EXAMPLE}")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(set(plans), {"mine", "rrtconnect"})
        mine = plans["mine"]
        self.assertEqual(mine["planner"], "external")
        self.assertEqual(mine["validation"]["verdict"], "valid", mine["validation"])
        self.assertGreater(mine["time_s"], 0.0)
        with open(self.path / "out/results.csv", newline="") as file:
            rows = {row["label"]: row for row in csv.DictReader(file)}
        for part in ("search_cpu_s", "shortcut_cpu_s", "proof_cpu_s"):
            self.assertEqual(rows["mine"][part], "", part)
            self.assertGreater(float(rows["rrtconnect"][part]), 0.0, part)

    def test_a_path_through_the_wall_is_refused_and_says_where(self):
        straight = self.program(
            "for line in sys.stdin:\n"
            "    message = json.loads(line)\n"
            "    q = message.get('query')\n"
            "    print(json.dumps({'path': [q['start'], q['goal']]} if q else {'ready': True}), flush=True)\n")
        _, plans = self.compare(straight)
        self.assertEqual(plans["mine"]["validation"]["verdict"], "refused")
        self.assertIn("occupied", plans["mine"]["validation"]["first_contact"])

    def test_who_ends_or_talks_nonsense_has_crashed_with_its_last_words(self):
        for text, words in (("sys.exit('no licence found')\n", "no licence found"),
                            ("print('hello', flush=True)\nsys.stdin.read()\n", "expected one JSON object"),
                            ("sys.stdin.readline()\nprint(json.dumps({'ready': True}), flush=True)\n"
                             "sys.stdin.readline()\nprint(json.dumps({'path': [[1, 2]]}), flush=True)\n"
                             "sys.stdin.read()\n", "6 finite numbers")):
            run, plans = self.compare(self.program(text), "--planners", "mine")
            self.assertEqual(plans, {})
            self.assertIn("crashed", run.stderr + run.stdout)
            self.assertIn(words, run.stderr + run.stdout)

    def test_who_asks_for_too_much_memory_is_out_of_memory(self):
        text = ("sys.stdin.readline()\nprint(json.dumps({'ready': True}), flush=True)\nsys.stdin.readline()\n"
                "bytearray(1 << 42)\n")
        run, plans = self.compare(self.program(text), "--planners", "mine", "--memory", "2")
        self.assertEqual(plans, {})
        self.assertIn("out_of_memory", run.stderr + run.stdout)
        self.assertIn("MemoryError", run.stderr + run.stdout)

    def test_who_does_not_answer_in_time_is_timed_out_and_ended(self):
        text = ("import time\nsys.stdin.readline()\n"
                "print(json.dumps({'ready': True}), flush=True)\nsys.stdin.readline()\ntime.sleep(1000)\n")
        run, plans = self.compare(self.program(text), "--planners", "mine", "--time-limit", "0.5")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(plans["mine"]["legs"][0]["status"], "timed_out")
        left = subprocess.run(["pgrep", "-f", str(self.path / "program.py")], capture_output=True, check=False)
        self.assertEqual(left.stdout, b"")

    def test_suites_name_no_command(self):
        (self.path / "suite.yaml").write_text(
            SUITE.replace("{planner: rrtconnect}", "{planner: external, options: {command: touch evil}}"))
        run, _ = self.compare("true")
        self.assertEqual(run.returncode, 2)
        self.assertIn("unknown planner 'external'", run.stderr)


if __name__ == "__main__":
    unittest.main()
