"""The stubs (__init__.pyi) against the module: names, parameters, types."""

import ast
import enum
import inspect
import pathlib
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


    def annotations(self):
        """Functions, and methods and properties of classes, with what the stubs say of them."""
        for name, node in self.functions.items():
            yield name, getattr(cw, name), node
        for name, node in self.classes.items():
            for line in node.body:
                if isinstance(line, ast.FunctionDef) and not issubclass(getattr(cw, name), (Exception, enum.Enum)):
                    yield f"{name}.{line.name}", inspect.getattr_static(getattr(cw, name), line.name), line

    def test_functions_take_and_give_the_types_that_the_stubs_say(self):
        """As far as pybind11 knows them: arrays are objects to it, and paths os.PathLike."""
        count = 0
        for name, value, node in self.annotations():
            text = getattr(value, "__doc__", None) or ""
            if isinstance(value, property) or not re.match(r"\w+\(", text):
                continue
            line = re.sub(r"<[^<>]*>", "None", text.splitlines()[0]).replace("clearway.", "")
            made = ast.parse(f"def {line}: ...").body[0]
            for own, said in zip([*made.args.args, *made.args.kwonlyargs], [*node.args.args, *node.args.kwonlyargs]):
                if own.arg != "self":
                    self.assertTrue(are_one_type(own.annotation, said.annotation), f"{name}({own.arg})")
                    count += 1
            self.assertTrue(are_one_type(made.returns, node.returns), name)
        self.assertGreater(count, 200)

    def test_properties_have_the_types_that_the_stubs_say(self):
        robot, snapshot, start, goal = worlds.arcs(resolution=0.05)
        space = cw.ConfigurationSpace(robot, snapshot)
        plan = cw.plan(space, start, goal)
        planned, gate = cw.plan_motion(space, plan), cw.Gate()
        gate.publish(space)
        can = cw.Load("can", robot.links[-1].name, sphere=0.05)
        point = cw.ConfigurationSpace(cw.load_robot("point"), snapshot, "not_occupied")
        ball = cw.MovingObstacle("ball", [0, 1], [worlds.pose(5), worlds.pose(6)], sphere=0.1)
        team = [cw.TeamRobot("one", point, [0, 0], [0.1, 0])]
        run = cw.run_team(team, [ball], duration=1.0)
        blocked = snapshot.blocked_space("painted", max_distance=0.3)
        fused = cw.FreeSpaceMap(0.05)
        fused.begin_stroke("by hand")
        shown = [robot, robot.joints[0], robot.links[1], robot.bodies[0], snapshot, snapshot.counts(), snapshot.volumes[0], space,
                 snapshot.voxel([0, 0, 0]), snapshot.ray([0, 0, 0], [1, 0, 0]), blocked,
                 blocked.nearest([0, 0, 0], 0.3), blocked.cast_ray([0, 0, 0], [1, 0, 0]), space.check(start), plan, plan.legs[0],
                 plan.validation, planned, planned.motion, planned.validation, planned.validation.shares, can,
                 cw.Pick(can, worlds.pose(1), worlds.pose(2)), cw.trajectory_of(planned.motion), cw.plan_trajectory(robot, plan),
                 gate.judge([0.0, 1.0], [start, start]), ball, team[0], run, run.traces[0], cw.check_team(team, run, [ball]), fused,
                 fused.insert([[1, 0, 0]]), fused.paint(fused.add_volume("v"), [0, 0, 0], 0.2),
                 fused.snapshot().volumes[0].strokes[0], fused.erase(0, [0, 0, 0], 0.1)]
        seen = set()
        for thing in shown:
            name = type(thing).__name__
            seen.add(name)
            for line in self.classes[name].body:
                if isinstance(line, ast.FunctionDef) and any(isinstance(d, ast.Name) for d in line.decorator_list):
                    value = getattr(thing, line.name)
                    self.assertTrue(is_of(value, line.returns), f"{name}.{line.name} is {value!r}, not {ast.unparse(line.returns)}")
        rest = {name for name in self.classes if not issubclass(getattr(cw, name), (Exception, enum.Enum))} - seen
        self.assertLessEqual(rest, {"ContinuedMap", "Gate", "PaintHint", "ProvedPart"})


def are_one_type(made, said):
    """Whether an annotation of pybind11 may be one of the stubs."""
    made, said = ast.unparse(made), ast.unparse(said)
    given = [part.strip() for part in said.split("|")]
    if match := re.fullmatch(r"Optional\[(.*)\]", made):
        return "None" in given and are_one_type(*(ast.parse(t).body[0].value for t in (match[1], said.replace(" | None", ""))))
    if made == "object":
        return not set(given) & {"bool", "int", "float"} or "ArrayLike" in given or len(given) > 1
    if made.startswith("numpy.ndarray"):
        return said in ("_Doubles", "_Flags", "_Bytes")
    if made == "os.PathLike":
        return said in ("_FilePath", "pathlib.Path")
    if made == "str":
        return said == "str" or said.startswith("Literal") or said in ("_Policy", "_Status")
    if made in ("dict", "tuple"):
        return said.startswith(made + "[")
    inner = re.fullmatch(r"(List|Dict|Tuple)\[(.*)\]", made)
    if not inner:
        return made == said
    outer = {"List": ("list", "Sequence"), "Dict": ("dict",), "Tuple": ("tuple",)}[inner[1]]
    if said.partition("[")[0] not in outer:
        return False
    parts = [ast.parse(text[text.index("[") + 1 : -1]).body[0].value for text in (made, said)]
    parts = [part.elts if isinstance(part, ast.Tuple) else [part] for part in parts]
    return len(parts[0]) == len(parts[1]) and all(map(are_one_type, *parts))


def is_of(value, said):
    """Whether a value is of a type that the stubs name."""
    if isinstance(said, ast.BinOp):
        return is_of(value, said.left) or is_of(value, said.right)
    text = ast.unparse(said)
    arrays = {"_Doubles": np.float64, "_Flags": np.bool_, "_Bytes": np.uint8}
    if text in arrays:
        return isinstance(value, np.ndarray) and value.dtype == arrays[text]
    if text in ("_Policy", "_Status"):
        return isinstance(value, str)
    if isinstance(said, ast.Subscript) and said.value.id in ("list", "dict", "tuple"):
        inner = said.slice.elts if isinstance(said.slice, ast.Tuple) else [said.slice]
        values = [value.keys(), value.values()] if isinstance(value, dict) else [[v] for v in value] if len(inner) > 1 else [value]
        return type(value).__name__ == said.value.id and all(is_of(v, t) for vs, t in zip(values, inner) for v in vs)
    types = {"None": type(None), "Any": object, "pathlib.Path": pathlib.Path, "bool": bool, "int": int, "float": float, "str": str}
    return isinstance(value, types.get(text) or getattr(cw, text)) and not (text == "int" and isinstance(value, bool))


if __name__ == "__main__":
    unittest.main()
