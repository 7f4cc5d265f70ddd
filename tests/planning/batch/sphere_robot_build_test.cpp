// The lists of a robot's spheres against their own definitions.

#include "planning/batch/sphere_robot_build.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "planning/geometry/convex_hull.hpp"
#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace sphere_robot_build_test {

using FloatSphere = SphereRobot::FloatSphere;

Eigen::Vector3f middle_of(const FloatSphere& sphere) { return {sphere.x, sphere.y, sphere.z}; }

void expect_same(const FloatSphere& a, const FloatSphere& b) {
  EXPECT_EQ(middle_of(a), middle_of(b));
  EXPECT_EQ(a.radius, b.radius);
}

/// Each robot among voxels, its parts asked of one field or by turns of two.
void for_each_model(const std::function<void(const CollisionModel&, const SphereRobot&)>& look) {
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    for (const bool two_fields : {false, true}) {
      SCOPED_TRACE(robot.name);
      Policies policies{.critical_by_default = false};
      for (std::size_t i = 0; two_fields && i < robot.bodies.size(); i += 2)
        policies.parts[robot.bodies[i].part] = Policy::known_free;
      const ConfigurationSpace space(robot, worlds::voxels_about(robot, 1), policies);
      ASSERT_NE(space.collision_model().spheres, nullptr);
      look(space.collision_model(), *space.collision_model().spheres);
    }
  }
}

std::vector<FloatSphere> spheres_of(const SphereRobot& robot, int first, int last) {
  return {robot.spheres.begin() + first, robot.spheres.begin() + last};
}

const SphereRobot::Cluster& cluster(const SphereRobot& robot, int i) {
  return robot.clusters[static_cast<std::size_t>(i)];
}

TEST(SphereRobotBuild, EachBodyHasItsCoverInClustersOfEightAndTheMemberThatItIs) {
  for_each_model([](const CollisionModel& model, const SphereRobot& robot) {
    std::vector<int> seen(robot.spheres.size(), 0);
    for (std::size_t body = 0; body < model.robot.bodies.size(); ++body) {
      const std::vector<Sphere> cover = lane_cover(model.robot.bodies[body], model.map.resolution());
      const auto member = std::find(model.indices.begin(), model.indices.end(), static_cast<int>(body));
      const auto [first, last] = robot.bodies[body];
      EXPECT_EQ(static_cast<std::size_t>(last - first), (cover.size() + 7) / 8);
      std::size_t count = 0;
      for (int i = first; i < last; ++i) {
        const auto& [begin, end, bound] = cluster(robot, i);
        EXPECT_TRUE(end - begin == 8 || i + 1 == last);
        expect_same(bound, sphere_around(spheres_of(robot, begin, end)));
        for (int k = begin; k < end; ++k, ++count) {
          const auto sphere = static_cast<std::size_t>(k);
          ++seen[sphere];
          EXPECT_EQ(robot.member[sphere],
                    member == model.indices.end() ? -1 : static_cast<int>(member - model.indices.begin()));
          EXPECT_GE(double(robot.spheres[sphere].radius), cover[count].radius);
          EXPECT_LT(double(robot.spheres[sphere].radius), cover[count].radius * (1.0 + 3e-7));
        }
      }
      EXPECT_EQ(count, cover.size());
      expect_same(robot.body_bounds[body], sphere_around(spheres_of(robot, cluster(robot, first).first,
                                                                    cluster(robot, last - 1).last)));
    }
    EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
    EXPECT_EQ(robot.members, model.members());
    EXPECT_EQ(robot.joints, model.robot.dof());
  });
}

/// Without spheres it would be clear of everything.
TEST(SphereRobotBuild, ARobotIsOnlyCoveredWhereEachOfItsBodiesIs) {
  const Robot robot = load_robot("puma560");
  const auto is_covered = [](const Robot& of) {
    const SphereGround ground{
        std::vector<int>(of.bodies.size(), -1), {}, 0.05, std::vector<std::size_t>(of.bodies.size(), 1)};
    return build_sphere_robot(std::make_shared<const Robot>(of), ground, {}).is_covered;
  };
  EXPECT_TRUE(is_covered(robot));
  for (std::size_t body = 0; body < robot.bodies.size(); ++body) {
    Robot bare = robot;
    bare.bodies[body].cover.clear();
    EXPECT_FALSE(is_covered(bare)) << body;
  }
}

TEST(SphereRobotBuild, WhatLiesInABodyIsSoToAFewRoundings) {
  for_each_model([](const CollisionModel& model, const SphereRobot& robot) {
    for (std::size_t body = 0; body < model.robot.bodies.size(); ++body) {
      const Body& of = model.robot.bodies[body];
      const std::vector<Sphere> cover = lane_cover(of, model.map.resolution());
      std::size_t sphere = static_cast<std::size_t>(cluster(robot, robot.bodies[body].first).first);
      for (const Sphere& one : cover) {
        const Eigen::Vector3d point = of.link_from_shape.inverse() * one.center;
        const double inside = of.shape.has_exact_distance()
                                  ? -of.shape.signed_distance(point)
                                  : HullPlanes(of.shape.surface()).inner_radius(point);
        const double inner = robot.inner[sphere++];
        EXPECT_LE(inner, std::max(inside, 0.0));
        EXPECT_NEAR(inner, inside, 1e-6 * std::abs(inside));
      }
    }
  });
}

TEST(SphereRobotBuild, FramesAndGroupsHoldTheirSpheres) {
  for_each_model([](const CollisionModel& model, const SphereRobot& robot) {
    for (std::size_t frame = 0; frame < robot.frames.size(); ++frame) {
      std::vector<FloatSphere> own;
      for (std::size_t i = 0; i < robot.spheres.size(); ++i)
        if (robot.frame_of[i] == static_cast<int>(frame)) own.push_back(robot.spheres[i]);
      expect_same(robot.bounds[frame], sphere_around(own));
    }
    const auto field_of = [&](int sphere) -> int {
      const int member = robot.member[static_cast<std::size_t>(sphere)];
      if (member < 0) return -1;
      const auto* bytes = &model.bodies[static_cast<std::size_t>(member)].space().byte_field();
      return static_cast<int>(
          std::find_if(robot.fields.begin(), robot.fields.end(),
                       [&](const SphereRobot::Field& field) { return field.bytes == bytes; }) -
          robot.fields.begin());
    };
    std::vector<int> seen(robot.clusters.size(), 0);
    std::pair<int, int> before(static_cast<int>(robot.frames.size()), 0);
    for (const SphereRobot::Group& group : robot.groups) {
      EXPECT_LT((std::pair{group.frame, group.field}), before);  // none twice, the last frames first
      before = {group.frame, group.field};
      for (int i = group.first; i < group.last; ++i) {
        ++seen[static_cast<std::size_t>(i)];
        const int first = cluster(robot, i).first;
        EXPECT_EQ(robot.frame_of[static_cast<std::size_t>(first)], group.frame);
        EXPECT_EQ(field_of(first), group.field);
      }
      expect_same(group.bound, sphere_around(spheres_of(robot, cluster(robot, group.first).first,
                                                        cluster(robot, group.last - 1).last)));
    }
    for (std::size_t i = 0; i < seen.size(); ++i)
      EXPECT_EQ(seen[i], field_of(robot.clusters[i].first) < 0 ? 0 : 1);
  });
}

/// Of a body the largest inner spheres first, none with its middle near that of a larger one, twelve at most.
std::vector<FloatSphere> cores_of(const SphereRobot& robot, int body) {
  const auto [first, last] = robot.bodies[static_cast<std::size_t>(body)];
  std::vector<FloatSphere> inside, cores;
  for (int i = cluster(robot, first).first; i < cluster(robot, last - 1).last; ++i) {
    inside.push_back(robot.spheres[static_cast<std::size_t>(i)]);
    inside.back().radius = robot.inner[static_cast<std::size_t>(i)];
  }
  std::stable_sort(inside.begin(), inside.end(),
                   [](const FloatSphere& a, const FloatSphere& b) { return a.radius > b.radius; });
  for (const FloatSphere& sphere : inside) {
    bool is_wanted = sphere.radius > 0.0F && cores.size() < 12;
    for (const FloatSphere& core : cores)
      is_wanted = is_wanted && (middle_of(sphere) - middle_of(core)).norm() >= 0.5F * core.radius;
    if (is_wanted) cores.push_back(sphere);
  }
  return cores;
}

TEST(SphereRobotBuild, CoresAreTheLargestSpheresInEachBodyApartFromEachOther) {
  std::size_t most = 0;
  for_each_model([&](const CollisionModel& model, const SphereRobot& robot) {
    for (const SphereRobot::Group& group : robot.groups) {
      int at = group.first_core;
      for (int i = group.first; i < group.last;) {
        const int member = robot.member[static_cast<std::size_t>(cluster(robot, i).first)];
        const int body = model.indices[static_cast<std::size_t>(member)];
        const std::vector<FloatSphere> expected = cores_of(robot, body);
        most = std::max(most, expected.size());
        ASSERT_LE(at + static_cast<int>(expected.size()), group.last_core);
        for (const FloatSphere& core : expected)
          expect_same(robot.cores[static_cast<std::size_t>(at++)], core);
        i = robot.bodies[static_cast<std::size_t>(body)].last;
      }
      EXPECT_EQ(at, group.last_core);
    }
  });
  EXPECT_EQ(most, 12U);
}

/// By the joints' own axes, at random configurations: no middle is farther off, and the bound is the sum of
/// lengths that it is said to be.
TEST(SphereRobotBuild, LeversHoldTheMiddlesOfAllSpheres) {
  for_each_model([](const CollisionModel& model, const SphereRobot& robot) {
    std::vector<int> link_of{-1};  // of each frame
    for (std::size_t i = 0; i < model.robot.links.size(); ++i)
      if (model.robot.links[i].joint >= 0) link_of.push_back(static_cast<int>(i));
    ASSERT_EQ(link_of.size(), robot.frames.size());
    Random random(7);
    for (int round = 0; round < 40; ++round) {
      const LinkPoses poses = forward_kinematics(model.robot, random.configuration(model.robot));
      for (const Body& body : model.robot.bodies) {
        int frame = 0;
        for (int i = body.link; i >= 0 && frame == 0;
             i = model.robot.links[static_cast<std::size_t>(i)].parent) {
          const auto known = std::find(link_of.begin() + 1, link_of.end(), i);
          if (known != link_of.end()) frame = static_cast<int>(known - link_of.begin());
        }
        for (int mover = frame; mover > 0; mover = robot.frames[static_cast<std::size_t>(mover)].parent) {
          const float lever =
              robot.lever_of(static_cast<std::size_t>(frame), static_cast<std::size_t>(mover));
          if (!robot.frames[static_cast<std::size_t>(mover)].turns) {
            EXPECT_EQ(lever, 1.0F);
            continue;
          }
          const auto link = static_cast<std::size_t>(link_of[static_cast<std::size_t>(mover)]);
          const Eigen::Vector3d& axis = axis_of(model.robot, model.robot.links[link]);
          for (const Sphere& sphere : body.cover) {
            const Eigen::Vector3d at =
                poses[link].inverse() * poses[static_cast<std::size_t>(body.link)] * sphere.center;
            EXPECT_LE(at.cross(axis).norm(), lever + 1e-6);
          }
        }
      }
    }
  });
}

}  // namespace sphere_robot_build_test
}  // namespace clearway
