"""The module as a whole: docstrings, errors, arguments that fit nothing."""

import ast
import contextlib
import copy
import inspect
import os
import pathlib
import pickle
import re
import unittest

import numpy as np

import clearway as cw
import worlds

STUBS = pathlib.Path(cw.__file__).parent / "__init__.pyi"


# What docstrings may name that is no name of Python's: other software, files of its, symbols of papers, frames.
FOREIGN = {"OctoMap", "ColorOcTree", "kdl_parser", "trajectory_msgs", "JointTrajectory", "frame_id", "lookahead_time",
           "clearway_path", "METHODS", "OUTPUTS", "README", "mu_j", "epsilon_j", "d_i", "d_s", "q_end", "map_from_shape"}
# And words that its functions take, or keys of what they return.
WORDS = {"ros", "urscript", "json", "csv", "suites", "experiments", "problems", "evidence", "threshold", "band", "sigmas",
         "noise_constant", "noise_quadratic", "noise_limit", "most_called_free", "a"}
# What only C++ has.
FOREIGN_TO_PYTHON = r"::|@\w+|\bstd\b|\bEigen\b|\bnullptr\b|\bnull\b|const ?&|\bspan<|\bvector<|\w\.[hc]pp\b|\bstruct\b|" \
                    r"\bof no size\b|\bfalse\b|==|&&|\bvoid\b|\boptional\b|\bhandle\b"


def members(owner):
    """Public members of a class that are its own."""
    return {name: value for name, value in vars(owner).items() if not name.startswith("_")}


class Copies(unittest.TestCase):
    def test_no_protocol_of_pickle_ends_the_program(self):
        snapshot = cw.FreeSpaceMap(resolution=0.1).snapshot()
        for thing in (snapshot, cw.load_robot("planar2"), snapshot.counts()):
            for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
                with self.assertRaisesRegex(TypeError, "cannot pickle or copy a clearway."):
                    pickle.dumps(thing, protocol)
            with self.assertRaises(TypeError):
                copy.copy(thing)
        self.assertIs(pickle.loads(pickle.dumps(cw.VoxelState.painted)), cw.VoxelState.painted)


class Docstrings(unittest.TestCase):
    def texts(self):
        """Of everything that is public its name and docstring, without the signatures that pybind11 writes."""
        for name in cw.__all__:
            value = getattr(cw, name)
            things = {name: value}
            if inspect.isclass(value) and name != "VoxelState":
                things |= {f"{name}.{key}": member for key, member in members(value).items() if key != "with_traceback"}
                things[f"{name}.__init__"] = value.__init__
            for key, thing in things.items():
                yield key, re.sub(r"^\w+\(.*?\)( -> .*)?$", "", inspect.getdoc(thing) or "", flags=re.MULTILINE).strip()

    def test_everything_has_one(self):
        self.assertGreater(len(cw.__doc__), 100)
        count = 0
        for key, text in self.texts():
            if not key.endswith("__init__"):  # a class may say it for both
                self.assertGreater(len(text), 1, key)  # "kg"
                count += 1
        self.assertGreater(count, 250)

    def test_they_name_nothing_that_python_does_not_have(self):
        known = FOREIGN | WORDS | set(cw.__all__) | {"ValueError", "TypeError", "FileNotFoundError"}
        for node in ast.walk(ast.parse(STUBS.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                known |= {node.name} | {argument.arg for argument in node.args.args + node.args.kwonlyargs}
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                known.add(node.value)
            elif isinstance(node, ast.Name):
                known.add(node.id)
        for planner in cw.available_planners():
            known |= {planner} | set(cw.planner_options(planner))
        for key, text in self.texts():
            self.assertIsNone(re.search(FOREIGN_TO_PYTHON, text), f"{key}: {text}")
            text = re.sub(r"""'\w+'|"\w+"|\bhelp\(type\(self\)\)""", "", text)
            for word in re.findall(r"\b[a-z]+(?:_[a-z]+)+\b|\b\w+(?=\()|(?<=`)\w+(?=`)|\b[A-Z][a-z]+(?:[A-Z][a-z]+)+\b|"
                                   r"\b[A-Z]\w+(?=\.[a-z])", text):
                self.assertIn(word, known, f"{key}: {text}")

    def test_they_say_which_error_a_file_is(self):
        for load in (cw.load_map, cw.load_plan, cw.load_robot, cw.load_results):
            self.assertIn("Raises FileNotFoundError, or another OSError", " ".join(load.__doc__.split()))
        for load in (cw.load_map, cw.load_plan, cw.load_robot, cw.load_results, cw):
            self.assertIn("DamagedFile", load.__doc__)
        with worlds.folder() as folder:
            file = pathlib.Path(folder) / "map.zip"
            file.write_bytes(b"")
            with self.assertRaises(ValueError) as raised:
                cw.load_map(file)
        suffixes = re.findall(r"\.[a-z]+\b", str(raised.exception).partition("expected")[2])
        self.assertGreater(len(suffixes), 6)
        for suffix in suffixes:  # all that the reader takes
            self.assertRegex(cw.load_map.__doc__, rf"{re.escape(suffix)}\b")

    def test_they_are_those_of_the_headers(self):
        root = pathlib.Path(os.environ["CLEARWAY_SOURCE"])
        for header, sentence, thing in (
            ("mapping/free_space_map.hpp", "Paints the voxels that lie wholly inside", cw.FreeSpaceMap.paint),
            ("planning/space/configuration_space.hpp", "Exact decision: limits, self-collision", cw.ConfigurationSpace.is_free),
            ("planning/check/path_check.hpp", "neither proved free nor shown to collide", cw.PathVerdict.undecided),
        ):
            self.assertIn(sentence, (root / header).read_text(encoding="utf-8"))
            self.assertIn(sentence, thing.__doc__)

    def test_classes_say_that_they_are_from_the_package(self):
        for name in cw.__all__:
            value = getattr(cw, name)
            if inspect.isclass(value):
                self.assertEqual(value.__module__, "clearway", name)

    def test_values_describe_themselves(self):
        fused = worlds.scanned_room()
        snapshot = fused.snapshot()
        self.assertEqual(repr(snapshot.counts())[:21], "VoxelCounts(painted=" + str(snapshot.counts().painted)[:1])
        for value in (fused, snapshot, snapshot.voxel([0, 0, 0]), snapshot.volumes[0], snapshot.blocked_space(max_distance=0.2),
                      cw.load_robot("point"), cw.VoxelState.painted):
            self.assertRegex(repr(value), r"^<?\w+[(.][^\n]{4,600}$")
        self.assertEqual(snapshot.voxel([0, 0, 0]).as_dict()["state"], snapshot.state([0, 0, 0]))


class Page(unittest.TestCase):
    def test_its_code_runs(self):
        page = pathlib.Path(os.environ["CLEARWAY_SOURCE"]) / "apps/python/README.md"
        blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
        self.assertEqual(len(blocks), 1)
        with worlds.folder() as folder, contextlib.chdir(folder):
            names = {}
            exec(blocks[0], names)  # noqa: S102
            self.assertTrue(cw.load_plan("plan.json").is_proved)
            answer = worlds.answer("check", "plan.json", "--map", "map", "--robot", "puma560", "--policy", "not_occupied",
                                 "--allow-outside", "all")
            self.assertEqual(answer["verdict"], "valid")
        self.assertEqual(names["snapshot"].state([0.3, 0.0, 0.4]), cw.VoxelState.painted)


class Hostile(unittest.TestCase):
    """Arguments that fit nothing end in one sentence that names them, whoever takes them."""

    WRONG = {
        "shape": np.zeros((3, 2)),
        "cube": np.zeros((2, 2, 3)),
        "complex": np.zeros((4, 3), complex),
        "text": np.array([["a", "b", "c"]]),
        "truth": np.zeros((4, 3), bool),
        "objects": np.array([[object(), object(), object()]]),
        "dates": np.zeros((4, 3), "datetime64[s]"),
        "ragged": [[0, 0, 0], [0, 0]],
        "none": None,
        "word": "points",
        "number": 3.0,
        "set": {1, 2, 3},
        "structure": np.zeros(4, [("x", float), ("y", float), ("z", float)]),
        "masked": np.ma.masked_array(np.zeros((4, 3)), mask=True),
    }

    def test_arrays_of_points(self):
        fused = cw.FreeSpaceMap()
        volume = fused.add_volume("v", [])
        fused.paint(volume, [0, 0, 0], 0.3)
        snapshot = fused.snapshot()
        space = snapshot.blocked_space(max_distance=0.3)
        for name, value in self.WRONG.items():
            for take in (fused.insert, snapshot.states, space.clearances, space.are_blocked, snapshot.volumes[0].contains,
                         lambda points: fused.paint(volume, points, 0.1), lambda points: space.cast_rays(points, points)):
                with self.subTest(name), self.assertRaises(ValueError) as raised:
                    take(value)
                self.assertRegex(str(raised.exception), r"^\w+: expected [^\n]*, got [^\n]+$")
        self.assertEqual(fused.snapshot().difference(snapshot)["states"], {})

    def test_configurations_and_poses(self):
        robot = cw.load_robot("puma560")
        space = cw.ConfigurationSpace(robot, cw.FreeSpaceMap().snapshot(), "not_occupied")
        for name, value in self.WRONG.items():
            for take in (space.are_free, space.clearances, space.check_path, robot.tip_poses, robot.path_cost):
                with self.subTest(name), self.assertRaises(ValueError):
                    take(value)
            for take in (space.is_free, robot.tip_pose, robot.placed, lambda q: cw.plan(space, q, np.zeros(6))):
                with self.subTest(name), self.assertRaises(ValueError):
                    take(value)
        sheared, mirrored, broken, moved = (np.eye(4) for _ in range(4))
        sheared[0, 1], mirrored[0, 0], broken[2, 3], moved[3, 0] = 3e-3, -1.0, np.nan, 1.0
        for value in (sheared, mirrored, broken, moved, 2 * np.eye(4), np.zeros((4, 4)), np.eye(3)):
            with self.assertRaisesRegex(ValueError, "^map_from_base: expected"):
                robot.placed(value)
            with self.assertRaisesRegex(ValueError, "^map_from_sensor: expected"):
                cw.FreeSpaceMap().insert(np.zeros((1, 3)), value)

    def test_numbers_and_words(self):
        snapshot = worlds.scanned_room().snapshot()
        for make in (
            lambda: cw.FreeSpaceMap(resolution=np.nan),
            lambda: cw.FreeSpaceMap(resolution=0.0),
            lambda: cw.FreeSpaceMap(threads=0),
            lambda: cw.FreeSpaceMap(integration="sure"),
            lambda: cw.FreeSpaceMap(margins={"bond": 1}),
            lambda: cw.FreeSpaceMap(hit_probability=np.nan),
            lambda: cw.FreeSpaceMap(margins={"band": np.nan}),
            lambda: cw.FreeSpaceMap().paint(0, [0, 0, 0], 0.1),
            lambda: cw.FreeSpaceMap().paint(-1, [0, 0, 0], 0.1),
            lambda: cw.FreeSpaceMap().erase(3, [0, 0, 0], 0.1),
            lambda: cw.FreeSpaceMap().undo_stroke(5),
            lambda: cw.FreeSpaceMap().add_volume("a\nb"),
            lambda: cw.FreeSpaceMap().insert([[0, 0, 1]], max_range=np.nan),
            lambda: cw.FreeSpaceMap().insert([[0, 0, 1]], crop=[[1, 1, 1], [0, 0, 0]]),
            lambda: cw.FreeSpaceMap().insert([[0, 0, 1]], bodies=[[0, 0, 0, 0, 0, 1, -1]]),
            lambda: cw.FreeSpaceMap().snapshot().slice("z", 0.0),
            lambda: snapshot.slice("w", 0.0),
            lambda: snapshot.slice("z", np.inf),
            lambda: snapshot.states_in([[-1e9, -1e9, -1e9], [1e9, 1e9, 1e9]]),
            lambda: snapshot.states_in([[-1e300, 0, 0], [1e300, 1, 1]]),
            lambda: snapshot.states_in([[np.nan, 0, 0], [1, 1, 1]]),
            lambda: snapshot.blocked_space("free"),
            lambda: snapshot.blocked_space(max_distance=np.nan),
            lambda: snapshot.blocked_space("painted", volumes=["nobody's"]),
            lambda: snapshot.blocked_space().nearest([0, 0, 0], np.nan),
            lambda: snapshot.blocked_space().cast_ray([0, 0, 0], [0, 0, 0]),
            lambda: snapshot.blocked_space("painted").cast_ray([0, 0, 0], [1e300, 0, 0]),
            lambda: snapshot.blocked_space("not_occupied").cast_ray([1e300, 0, 0], [1, 0, 0]),
            lambda: snapshot.blocked_space("not_occupied").cast_ray([1e10, 0, 0], [-1, 0, 0]),
            lambda: snapshot.blocked_space("painted").cast_rays([[1e300, 0, 0]], [[-1, 0, 0]]),
            lambda: snapshot.ray([0, 0, 0], [0, 0, 0]),
            lambda: snapshot.crop([[0, 0, 0], [np.inf, 1, 1]]),
            lambda: snapshot.coarsen(0.07),
            lambda: snapshot.merge(cw.FreeSpaceMap(resolution=0.07).snapshot()),
            lambda: snapshot.export("/tmp/map.zip"),
            lambda: cw.ContinuedMap(snapshot, hit_probability=0.1),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,400}$")
        for make in (lambda: snapshot.save("/proc/nowhere/map"), lambda: snapshot.export("/proc/nowhere.ply")):
            with self.assertRaises(OSError):
                make()
        space = cw.ConfigurationSpace(cw.load_robot("point"), snapshot, "not_occupied")
        for make in (
            lambda: cw.FreeSpaceMap("fine"),
            lambda: cw.load_map(3),
            lambda: cw.ConfigurationSpace(cw.load_robot("point"), snapshot, ["painted"]),
            lambda: cw.ConfigurationSpace(cw.load_robot("point"), snapshot, {1: "painted"}),
            lambda: cw.plan(space, [0, 0], [0, 0], load_policies={1: "painted"}),
            lambda: cw.plan(space, [0, 0], [0, 0], planner="beam", width={}),
        ):
            with self.assertRaises(TypeError):
                make()
        with self.assertRaises(AttributeError):
            snapshot.resolution = 0.1

    def test_which_error_a_file_is_follows_one_rule(self):
        plan = cw.plan(cw.ConfigurationSpace(cw.load_robot("point"), cw.FreeSpaceMap().snapshot(), "not_occupied"), [0, 0], [0, 0])
        with worlds.folder() as name:
            folder = pathlib.Path(name)
            (folder / "cut.json").write_text(plan.to_json()[:99], encoding="utf-8")
            (folder / "other.json").write_text("{}", encoding="utf-8")
            (folder / "cut.ot").write_bytes(b"# Octomap")
            (folder / "other.zip").write_bytes(b"")
            (folder / "cut.sqlite").write_bytes(b"SQLite format 3")
            (folder / "other.urdf").write_text("<robot name='r'/>", encoding="utf-8")
            (folder / "folder.json").mkdir()
            for load, file, error in (
                (cw.load_plan, "none.json", FileNotFoundError),
                (cw.load_plan, "folder.json", IsADirectoryError),
                (cw.load_plan, "cut.json", cw.DamagedFile),
                (cw.load_plan, "other.json", ValueError),
                (cw.load_map, "none.ot", FileNotFoundError),
                (cw.load_map, "folder.json", FileNotFoundError),  # its map.ot
                (cw.load_map, "cut.ot", cw.DamagedFile),
                (cw.load_map, "other.zip", ValueError),
                (cw.load_robot, "none.urdf", FileNotFoundError),
                (cw.load_robot, "other.urdf", ValueError),
                (lambda file: cw.load_robot("planar2", srdf=file), "none.srdf", FileNotFoundError),
                (cw.load_results, "none", FileNotFoundError),
                (cw.load_results, "cut.sqlite", cw.DamagedFile),
            ):
                with self.subTest(file), self.assertRaises((ValueError, OSError)) as raised:
                    load(folder / file)
                self.assertIs(type(raised.exception), error, file)
                self.assertRegex(str(raised.exception), r"^[^\n]{10,400}$")
                if isinstance(raised.exception, OSError):
                    self.assertNotEqual(raised.exception.errno, 0)
            with self.assertRaises(ValueError) as raised:  # no file
                cw.parse_plan((folder / "cut.json").read_text(encoding="utf-8"))
            self.assertIs(type(raised.exception), ValueError)
            with self.assertRaises(ValueError):
                cw.load_robot("puma561")
            if os.geteuid() != 0:
                (folder / "other.json").chmod(0)
                with self.assertRaises(PermissionError):
                    cw.load_plan(folder / "other.json")
        self.assertTrue(issubclass(cw.DamagedFile, ValueError))

    def test_damaged_files_are_reported_and_nothing_of_them_is_used(self):
        with worlds.folder() as folder:
            worlds.scanned_room().snapshot().save(folder)
            file = pathlib.Path(folder) / "map.ot"
            whole = file.read_bytes()
            file.write_bytes(whole[: len(whole) // 2])
            with self.assertRaisesRegex(cw.DamagedFile, "map.ot"):
                cw.load_map(folder)
            cloud = pathlib.Path(folder) / "cloud.pcd"
            cloud.write_bytes(b"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n\xff\xfe")
            with self.assertRaises(cw.DamagedFile) as raised:
                cw.load_map(cloud)
            self.assertRegex(str(raised.exception), r"^[^\n]{10,400}$")


if __name__ == "__main__":
    unittest.main()
