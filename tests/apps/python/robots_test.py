"""Robots from Python, against kinematics in NumPy that read the URDF themselves, and the command line program."""

import os
import pathlib
import unittest
import xml.etree.ElementTree as xml

import numpy as np

import clearway as cw
import worlds


def numbers(element, name, usual):
    return np.array([float(word) for word in element.get(name, usual).split()]) if element is not None else \
        np.array([float(word) for word in usual.split()])


def turned(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def urdf_links(file, values):
    """Pose of each link at joint values by name; the root is at the origin."""
    joints = {joint.find("child").get("link"): joint for joint in xml.parse(file).getroot().findall("joint")}

    def place(link):
        if link not in joints:
            return np.eye(4)
        joint = joints[link]
        roll, pitch, yaw = numbers(joint.find("origin"), "rpy", "0 0 0")
        local, move = np.eye(4), np.eye(4)
        local[:3, :3] = turned(np.array([0, 0, 1.0]), yaw) @ turned(np.array([0, 1.0, 0]), pitch) @ turned(np.array([1.0, 0, 0]), roll)
        local[:3, 3] = numbers(joint.find("origin"), "xyz", "0 0 0")
        axis = numbers(joint.find("axis"), "xyz", "1 0 0")
        value = values.get(joint.get("name"), 0.0)
        if joint.get("type") in ("revolute", "continuous"):
            move[:3, :3] = turned(axis, value)
        elif joint.get("type") == "prismatic":
            move[:3, 3] = value * axis / np.linalg.norm(axis)
        return place(joint.find("parent").get("link")) @ local @ move

    return place


def drawn(robot, dice, count):
    lower, upper = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    return dice.uniform(lower, upper, (count, robot.dof))


class Kinematics(unittest.TestCase):
    def test_links_stand_where_the_urdf_puts_them(self):
        dice = np.random.default_rng(1)
        for name in ("puma560", "panda", "arm6", "arm5", "planar2"):
            robot = cw.load_robot(name)
            robot = robot.scaled(1.0 / robot.scale).placed(worlds.pose(0.3, -0.2, 0.1, 0.7))
            for q in drawn(robot, dice, 5):
                place = urdf_links(cw.datasets_folder() / f"robots/{name}.urdf", dict(zip(robot.joint_names, q)) | robot.held)
                for link, pose in zip(robot.links, robot.link_poses(q)):
                    np.testing.assert_allclose(pose, robot.map_from_base @ place(link.name), atol=1e-9, err_msg=link.name)

    def test_many_tips_are_as_single_ones(self):
        robot = cw.load_robot("puma560")
        qs = drawn(robot, np.random.default_rng(2), 9)
        np.testing.assert_array_equal(robot.tip_poses(np.asfortranarray(qs)), [robot.tip_pose(q) for q in qs])
        self.assertEqual(robot.tip_poses(np.empty((0, 6))).shape, (0, 4, 4))

    def test_the_jacobian_is_the_derivative_of_the_tip(self):
        robot = cw.load_robot("panda")
        for q in drawn(robot, np.random.default_rng(3), 5):
            step = 1e-6
            there, back = robot.tip_poses(q + step * np.eye(robot.dof)), robot.tip_poses(q - step * np.eye(robot.dof))
            numeric = (there[:, :3, 3] - back[:, :3, 3]).T / (2 * step)
            np.testing.assert_allclose(robot.jacobian(q)[:3], numeric, atol=1e-7)
            spin = (there[:, :3, :3] - back[:, :3, :3]) / (2 * step) @ robot.tip_pose(q)[:3, :3].T
            np.testing.assert_allclose(robot.jacobian(q)[3:], np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]]), atol=1e-7)

    def test_inverse_kinematics_lead_back_to_the_pose(self):
        dice = np.random.default_rng(4)
        for name in ("puma560", "panda"):
            robot = cw.load_robot(name)
            for q in drawn(robot, dice, 4):
                pose = robot.tip_pose(q)
                np.testing.assert_allclose(robot.tip_pose(robot.inverse_kinematics(pose, q)), pose, atol=1e-5)
                found = robot.goal_configurations(pose, q, starts=4)
                self.assertGreater(len(found), 0)
                np.testing.assert_allclose(robot.tip_poses(found), np.broadcast_to(pose, (len(found), 4, 4)), atol=1e-5)
            self.assertIsNone(robot.inverse_kinematics(worlds.pose(50.0), q))
            for pose, near in ((np.full((4, 4), np.nan), q), (2 * np.eye(4), q), (pose, q * np.nan), (pose, q[1:])):
                for solve in (robot.inverse_kinematics, robot.goal_configurations):
                    with self.assertRaises(ValueError):
                        solve(pose, near)


class Facts(unittest.TestCase):
    def test_the_cost_of_a_robot_without_masses_is_not_known(self):
        text = """<robot name="bare"><link name="base"/><link name="arm"><collision><origin xyz="0.2 0 0"/><geometry>
            <box size="0.4 0.1 0.1"/></geometry></collision>{}</link><joint name="turn" type="revolute"><parent link="base"/>
            <child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="1"/></joint></robot>"""
        mass = """<inertial><origin xyz="0.2 0 0"/><mass value="2"/>
            <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>"""
        with worlds.folder() as folder:
            file = pathlib.Path(folder) / "bare.urdf"
            for has_mass in (False, True):
                file.write_text(text.format(mass if has_mass else ""))
                cost = cw.load_robot(file).path_cost([[0.0], [0.5]])
                self.assertEqual(np.isfinite(cost), has_mass)
        self.assertGreater(cost, 0.0)

    def test_shipped_robots_are_those_of_the_program(self):
        status, out, _ = worlds.run("robots")
        self.assertEqual(status, 0)
        self.assertGreater(len(cw.available_robots()), 4)
        for name in cw.available_robots():
            self.assertIn(name, out)
            robot = cw.load_robot(name)
            self.assertEqual(len(robot.joints), robot.dof)
            self.assertEqual(robot.lower.shape, (robot.dof,))
            self.assertTrue((robot.lower < robot.upper).all())
            self.assertTrue(set(robot.critical_parts) <= set(robot.parts))
            self.assertEqual(sorted({body.part for body in robot.bodies}), robot.parts)
            self.assertIn(robot.name, repr(robot))

    def test_limits_are_reported_in_a_sentence(self):
        robot = cw.load_robot("puma560")
        self.assertEqual(robot.limit_violation(np.zeros(6)), "")
        self.assertIn(robot.joint_names[2], robot.limit_violation([0, 0, 50, 0, 0, 0]))
        self.assertNotEqual(robot.limit_violation([0, 0, np.nan, 0, 0, 0]), "")

    def test_joints_are_fixed_and_scales_chosen(self):
        robot = cw.load_robot("puma560", fixed={cw.load_robot("puma560").joint_names[5]: 0.25}, scale=0.5)
        self.assertEqual((robot.dof, robot.scale, list(robot.held.values())), (5, 0.5, [0.25]))
        whole = cw.load_robot("puma560")
        q = np.array([0.1, -0.8, 0.3, 0.2, 0.4])
        pose = whole.tip_pose([*q, 0.25])
        np.testing.assert_allclose(robot.tip_pose(q)[:3, 3], 0.5 * pose[:3, 3], atol=1e-12)

    def test_a_state_of_the_srdf_is_a_configuration(self):
        with worlds.folder() as folder:
            file = f"{folder}/states.srdf"
            names = cw.load_robot("planar2").joint_names
            with open(file, "w", encoding="utf-8") as srdf:
                srdf.write(f'<robot name="planar2"><group name="arm">{"".join(f"<joint name=%r/>" % n for n in names)}</group>'
                           '<group_state name="bent" group="arm">'
                           + "".join(f'<joint name="{n}" value="{0.1 * (i + 1)}"/>' for i, n in enumerate(names))
                           + "</group_state></robot>")
            robot = cw.load_robot("planar2", srdf=file)
        np.testing.assert_array_equal(robot.configuration("bent"), [0.1 * (i + 1) for i in range(robot.dof)])
        self.assertEqual(robot.states["bent"][names[0]], 0.1)
        np.testing.assert_array_equal(robot.tip_pose("bent"), robot.tip_pose(robot.configuration("bent")))
        with self.assertRaisesRegex(ValueError, "no state 'straight', expected one of bent"):
            robot.configuration("straight")

    def test_arguments_of_xacro_reach_the_program(self):
        before = os.environ["PATH"]
        with worlds.folder() as folder:
            with open(f"{folder}/xacro", "w", encoding="utf-8") as program:  # a stand-in
                program.write(f'#!/bin/sh\n[ "$2" = side:=left ] && cat {cw.datasets_folder()}/robots/planar2.urdf\n')
            os.chmod(f"{folder}/xacro", 0o700)
            with open(f"{folder}/two.urdf.xacro", "w", encoding="utf-8") as robot:
                robot.write('<robot name="two"/>')
            os.environ["PATH"] = f"{folder}:{before}"
            try:
                self.assertEqual(cw.load_robot(f"{folder}/two.urdf.xacro", xacro={"side": "left"}).dof, 2)
                with self.assertRaisesRegex(ValueError, "xacro could not expand it"):
                    cw.load_robot(f"{folder}/two.urdf.xacro", xacro={"side": "right"})
            finally:
                os.environ["PATH"] = before

    def test_mistakes_name_arguments_of_the_module(self):
        with worlds.folder() as folder:
            file = f"{folder}/states.srdf"
            with open(file, "w", encoding="utf-8") as srdf:
                srdf.write('<robot name="planar2"><group name="arm"><joint name="shoulder"/></group>'
                           '<group_state name="bent" group="arm"><joint name="shoulder" value="0.1"/></group_state></robot>')
            robot = cw.load_robot("planar2", srdf=file)
            names = robot.joint_names
            for make, words in (
                (lambda: cw.load_robot("planar2", fixed={names[0]: 99.0}), "^fixed: joint "),
                (lambda: cw.load_robot("planar2", fixed={name: 0.0 for name in names}), r"that moves \(group\)"),
                (lambda: cw.load_robot("planar2", group="arm"), "by srdf or beside"),
                (lambda: robot.configuration("bent"), r"or fixed=\{'JOINT': VALUE\} for that joint"),
            ):
                with self.assertRaisesRegex(ValueError, words) as raised:
                    make()
                self.assertNotIn("--", str(raised.exception))
            with self.assertRaisesRegex(FileNotFoundError, f"{folder}/--group.urdf"):  # a file's name stays
                cw.load_robot(f"{folder}/--group.urdf")

    def test_mistakes_are_one_sentence(self):
        for make in (
            lambda: cw.load_robot("puma561"),
            lambda: cw.load_robot("puma560", fixed={"elbow": 1.0}),
            lambda: cw.load_robot("puma560", group="arm"),
            lambda: cw.load_robot("puma560", scale=np.nan),
            lambda: cw.load_robot("puma560", map_from_base=np.ones((4, 4))),
            lambda: cw.load_robot("puma560").scaled(0.0),
            lambda: cw.load_robot("puma560").jacobian(np.zeros(6), link="nose"),
        ):
            with self.assertRaises(ValueError) as raised:
                make()
            self.assertRegex(str(raised.exception), r"^[^\n]{10,400}$")


if __name__ == "__main__":
    unittest.main()
