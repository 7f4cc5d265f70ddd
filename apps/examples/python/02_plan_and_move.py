"""Plans an arm's motion through painted space, has it proved, and gives it time. Cells begin with "# %%"."""

# %% A PUMA 560, and paint along the arc that its tool takes when the base turns.
import numpy as np

import clearway as cw

robot = cw.load_robot("puma560")
turns = np.arange(-0.7, 0.71, 0.02)
arc = np.tile([0.0, -0.8, 0.3, 0.0, 0.4, 0.0], (len(turns), 1))  # radians
arc[:, 0] = turns
tips = robot.tip_poses(arc)[:, :3, 3]

fused = cw.FreeSpaceMap(resolution=0.03)
volume = fused.add_volume("arcs", robot.critical_parts)
fused.paint(volume, tips, 0.22)
fused.paint(volume, tips + [0.0, 0.0, 0.25], 0.22)

# %% A camera looks against the map's x axis: a wall, and before it a pillar as high as the tip.
top = robot.tip_pose([0.0, -0.8, 0.3, 0.0, 0.4, 0.0])[:3, 3]
y, z = np.meshgrid(np.arange(-1.5, 1.51, 0.02), np.arange(-0.5, 2.01, 0.02))
wall = np.column_stack([np.full(y.size, -3.0), y.ravel(), z.ravel() - 0.8])
heights = np.arange(0.0, top[2], 0.01)
pillar = np.column_stack([np.full_like(heights, top[0] - 2.0), np.zeros_like(heights), heights - 0.8])
camera = np.eye(4)
camera[:3, 3] = [2.0, 0.0, 0.8]
fused.insert(np.vstack([wall, pillar]), camera)

# %% The robot in the map: parts that nobody named keep their usual policies, padding is the robot's accuracy.
space = cw.ConfigurationSpace(robot, fused.snapshot())
print(space.policies)
start, goal = arc[5], arc[-6]
print("start and goal free:", space.are_free(np.array([start, goal])))
print("straight edge free:", space.is_edge_free(start, goal))

# %% Plan, and have it checked by code that no planner shares.
plan = cw.plan(space, start, goal)
print(plan.status, len(plan.waypoints), "waypoints, proved:", plan.is_proved)
print(f"clear by {1000 * plan.validation.min_clearance:.1f} mm, {plan.cost:.1f} J")
there_and_back = cw.plan(space, start, [goal, start], planner="beam", width=20, step_deg=2.0)
print(there_and_back.planner, there_and_back.options["width"], there_and_back.status)

# %% What the map forbids is an outcome; require_proved() makes it an exception for those who want one.
beyond = arc[-1] + [0.8, 0.0, 0.0, 0.0, 0.0, 0.0]
try:
    cw.require_proved(cw.plan(space, start, beyond))
except cw.GoalInvalid as error:
    refusal = str(error)
    print("refused:", refusal)

# %% A proved plan in time: velocity, acceleration and jerk within limits, positions at any time.
planned = cw.plan_motion(space, cw.require_proved(plan), speed=0.5)
motion = planned.motion
moments = np.linspace(0.0, motion.duration, 200)
states = motion.at(moments)
print(f"{motion.duration:.2f} s, at most {np.abs(states['velocity']).max():.2f} rad/s")
program = cw.export_trajectory(robot, plan, cw.trajectory_of(motion), "ros")
print(program.splitlines()[0])

assert plan.is_proved and there_and_back.is_proved and planned.validation.valid
assert np.array_equal(states["position"][0], start) and np.allclose(states["position"][-1], goal, atol=1e-9)
assert refusal
print("as expected")
