"""The module as a whole: docstrings, stubs, arguments that fit nothing."""

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


def members(owner):
    """Public members of a class that are its own."""
    return {name: value for name, value in vars(owner).items() if not name.startswith("_")}


def signature(function):
    """Names of parameters in order, of those that only keywords give, and of those that may be left out."""
    if inspect.isfunction(function):
        parameters = inspect.signature(function).parameters.values()
        keywords = {p.name for p in parameters if p.kind == p.KEYWORD_ONLY}
        return [p.name for p in parameters], keywords, {p.name for p in parameters if p.default is not p.empty}
    line = function.__doc__.splitlines()[0]
    line = re.sub(r"<[^<>]*>", "None", line)  # values that have no literal
    tree = ast.parse(f"def {line}: ...".replace("self: clearway._clearway.", "self: clearway.")).body[0]
    return of_tree(tree)


def of_tree(tree):
    arguments = tree.args
    plain = [argument.arg for argument in arguments.args]
    keywords = [argument.arg for argument in arguments.kwonlyargs]
    usual = set(plain[len(plain) - len(arguments.defaults):])
    usual |= {name for name, default in zip(keywords, arguments.kw_defaults) if default is not None}
    rest = [arguments.kwarg.arg] if arguments.kwarg else []
    return plain + keywords + (["**"] if rest else []), set(keywords), usual


class Stubs(unittest.TestCase):
    """What the stubs say is there, and what is there they say."""

    @classmethod
    def setUpClass(cls):
        cls.tree = ast.parse(STUBS.read_text(encoding="utf-8"))
        cls.functions = {node.name: node for node in cls.tree.body if isinstance(node, ast.FunctionDef)}
        cls.classes = {node.name: node for node in cls.tree.body if isinstance(node, ast.ClassDef)}

    def test_they_name_all_that_the_module_exports_and_no_more(self):
        self.assertEqual(sorted({**self.functions, **self.classes}), sorted(cw.__all__))
        self.assertTrue((STUBS.parent / "py.typed").is_file())

    def test_functions_have_the_parameters_that_the_stubs_say(self):
        for name, node in self.functions.items():
            with self.subTest(name):
                self.assertEqual(of_tree(node), signature(getattr(cw, name)))

    def test_classes_have_the_members_that_the_stubs_say(self):
        for name, node in self.classes.items():
            owner = getattr(cw, name)
            if name == "VoxelState":
                written = {line.targets[0].id: line.value.value for line in node.body if isinstance(line, ast.Assign)}
                self.assertEqual(written, {state.name: state.value for state in cw.VoxelState})
                continue
            written = {line.name: line for line in node.body if isinstance(line, ast.FunctionDef)}
            fields = {line.target.id for line in node.body if isinstance(line, ast.AnnAssign)}
            with self.subTest(name):
                if issubclass(owner, Exception):
                    self.assertEqual(set(members(owner)), {key for key in written if not key.startswith("_")})
                    continue
                public = {key for key in written if not key.startswith("_")}
                self.assertEqual(public | fields, set(members(owner)))
                for key, line in written.items():
                    value = inspect.getattr_static(owner, key)
                    is_property = any(isinstance(d, ast.Name) and d.id == "property" for d in line.decorator_list)
                    self.assertEqual(is_property, isinstance(value, property), key)
                    if not is_property:
                        self.assertEqual(of_tree(line), signature(getattr(owner, key)), key)


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
    def test_everything_has_one(self):
        self.assertGreater(len(cw.__doc__), 100)
        count = 0
        for name in cw.__all__:
            value = getattr(cw, name)
            things = {name: value}
            if inspect.isclass(value) and name != "VoxelState":
                things |= {f"{name}.{key}": member for key, member in members(value).items() if key != "with_traceback"}
            for key, thing in things.items():
                text = inspect.getdoc(thing) or ""
                text = re.sub(r"^\w+\(.*?\)( -> .*)?$", "", text, flags=re.MULTILINE)  # what pybind11 writes
                self.assertGreater(len(text.strip()), 1, key)  # "kg"
                self.assertNotRegex(text, r"::|@throws|@param|@pre|\bnullptr\b", key)
                count += 1
        self.assertGreater(count, 250)

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
            lambda: cw.load_map("/nowhere"),
            lambda: cw.ContinuedMap(snapshot, hit_probability=0.1),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,400}$")
        for make in (lambda: snapshot.save("/proc/nowhere/map"), lambda: snapshot.export("/proc/nowhere.ply")):
            with self.assertRaises(OSError):
                make()
        with self.assertRaises(TypeError):
            cw.FreeSpaceMap("fine")
        with self.assertRaises(AttributeError):
            snapshot.resolution = 0.1

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
