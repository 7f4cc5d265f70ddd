// What a pick states about tip and object: how far the plan may be off, to the last bit.
#include "planning/check/pick_terms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/slide_robot.hpp"

namespace clearway::check {
namespace pick_terms_test {

Eigen::Isometry3d along(double metres) { return Eigen::Isometry3d(Eigen::Translation3d(0.0, metres, 0.0)); }

/// About z by the least angle from `radians` on that angle_of finds in the turn back, too.
Eigen::Isometry3d about(double radians) {
  double sine = std::sin(radians) * (1.0 - 1e-13);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (bool is_less = true; is_less; sine = std::nextafter(sine, 1.0)) {
    const double cosine = std::sqrt(1.0 - sine * sine);
    pose.linear() << cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0;
    is_less = angle_of(pose.linear().transpose()) < radians;
  }
  return pose;
}

TEST(PickTerms, TheAngleOfATurnIsThatByWhichItWasMadeAboutWhateverAxis) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double angle = i == 0 ? 0.0 : i == 1 ? std::numbers::pi : random.between(0.0, std::numbers::pi);
    const Eigen::AngleAxisd turn(angle, random.point(1.0).normalized());
    ASSERT_NEAR(angle_of(turn.toRotationMatrix()), angle, 1e-12) << turn.axis().transpose();
  }
}

class PickTermsOf : public ::testing::Test {
 protected:
  PickTermsOf() {
    pick_.object.name = "box";
    pick_.object.link = "carriage";
    pick_.object.shape = Shape::box({0.05, 0.05, 0.05});
  }

  /// Empty, or the refusal of a plan that takes and puts the object exactly at the map's origin.
  std::string refusal(const Eigen::Isometry3d& object_from_tip, const Eigen::Isometry3d& map_from_object,
                      const Eigen::Isometry3d& map_from_place) {
    pick_.object_from_tip = object_from_tip;
    pick_.map_from_object = map_from_object;
    pick_.map_from_place = map_from_place;
    const PickToCheck plan{robot_, snapshot_, pick_, Eigen::Isometry3d::Identity(),
                           std::vector<std::vector<Configuration>>(6, {Configuration::Zero(1)})};
    try {
      PickTerms(plan, {}, 0.0, 0.0).require_grasp();
    } catch (const PickRefusal& refused) {
      return refused.sentence;
    }
    return "";
  }

  const Robot robot_ = worlds::slide_robot();
  const Snapshot snapshot_ = FreeSpaceMap({.resolution = 0.1}).snapshot();
  Pick pick_;
};

TEST_F(PickTermsOf, TipAndObjectMayBeOffByTheirTolerancesAndByNothingMore) {
  const Eigen::Isometry3d exactly = Eigen::Isometry3d::Identity();
  for (const auto& off : {along, about}) {
    EXPECT_EQ(refusal(off(same_tip), exactly, exactly), "");
    EXPECT_EQ(refusal(exactly, off(same_place), exactly), "");
    EXPECT_EQ(refusal(exactly, exactly, off(same_place)), "");
    constexpr double more = 1.0 + 1e-9;
    EXPECT_NE(refusal(off(more * same_tip), exactly, exactly).find("the tip takes the object"),
              std::string::npos);
    EXPECT_NE(refusal(exactly, off(more * same_place), exactly).find("the load rides"), std::string::npos);
    EXPECT_NE(refusal(exactly, exactly, off(more * same_place)).find("the object is put down"),
              std::string::npos);
  }
  ASSERT_EQ(angle_of(about(same_place).linear().transpose()), same_place);  // or the test tries less
  ASSERT_EQ(angle_of(about(same_tip).linear()), same_tip);
}

/// After a quarter of a turn on the way the hand comes back a quarter of a turn from where it went in, the
/// same way round.
TEST_F(PickTermsOf, TheWayBackIsTurnedAsTheObjectWas) {
  Robot robot = robot_;
  robot.joints[0].kind = JointKind::revolute;
  robot.joints[0].axis = Eigen::Vector3d::UnitZ();
  robot.joints[0].upper = 2.0;
  pick_.approach << 0.1, 0.0, 0.02;
  pick_.lift = 0.3;
  const Configuration taken = Configuration::Zero(1), put = Configuration::Constant(1, M_PI / 2);
  const PickToCheck plan{robot,
                         snapshot_,
                         pick_,
                         Eigen::Isometry3d::Identity(),
                         {{taken}, {taken}, {taken}, {taken, put}, {put}, {put}}};
  const PickTerms terms(plan, {}, 0.0, 0.0);
  const auto ways = terms.ways();
  EXPECT_EQ(ways[0], std::pair(PickTerms::reach, Eigen::Vector3d(0.1, 0.0, 0.02)));
  EXPECT_EQ(ways[1], std::pair(PickTerms::lift, Eigen::Vector3d(0.0, 0.0, 0.3)));
  EXPECT_EQ(ways[2], std::pair(PickTerms::lower, Eigen::Vector3d(0.0, 0.0, -0.3)));
  EXPECT_EQ(ways[3].first, PickTerms::retreat);
  EXPECT_LT((ways[3].second - Eigen::Vector3d(0.0, -0.1, -0.02)).norm(), 1e-12);
}

/// An object of which no policy speaks must lie in what the strictest of carrier and fingers must.
TEST_F(PickTermsOf, TheObjectsPolicyIsTheStrictestOfWhatHoldsIt) {
  Robot robot = robot_;
  robot.links.push_back(robot.links[1]);
  robot.links[2].name = "pad";
  robot.bodies.push_back(robot.bodies[0]);
  robot.bodies[1].part = "pad";
  robot.bodies[1].link = 2;
  pick_.object.touches = {"pad"};
  const PickToCheck plan{robot, snapshot_, pick_, Eigen::Isometry3d::Identity(), {}};
  constexpr auto strict = Policy::painted, middling = Policy::known_free, loose = Policy::not_occupied;
  const auto chosen = [&](const std::map<std::string, Policy>& policies) {
    return PickTerms(plan, policies, 0.0, 0.0).policies.at("box");
  };
  EXPECT_EQ(chosen({}), loose);
  EXPECT_EQ(chosen({{"carriage", loose}, {"pad", loose}}), loose);
  for (const Policy other : {loose, middling}) {
    EXPECT_EQ(chosen({{"carriage", strict}, {"pad", other}}), strict);
    EXPECT_EQ(chosen({{"carriage", other}, {"pad", strict}}), strict);
    EXPECT_EQ(chosen({{"carriage", middling}, {"pad", other}}), middling);
  }
  EXPECT_EQ(chosen({{"carriage", strict}, {"pad", strict}, {"box", loose}}), loose);  // it is stated
}

/// A hand on a mast: joint 0 lifts it along z, joint 1 is its grip and moves nothing that counts.
Robot mast() {
  Robot robot = worlds::slide_robot();
  robot.joints[0].axis = Eigen::Vector3d::UnitZ();
  robot.joints.push_back(robot.joints[0]);
  robot.joints[1].name = "grip";
  return robot;
}

Configuration at(double height, double grip) { return Eigen::Vector2d(height, grip); }

class PickTermsOfAMast : public ::testing::Test {
 protected:
  PickTermsOfAMast() {
    pick_.object.name = "box";
    pick_.object.link = "carriage";
    pick_.object.shape = Shape::box({0.05, 0.05, 0.05});
    pick_.grip["grip"] = {0.3, 0.1};
  }

  PickTerms terms() const { return {plan_, {}, 0.002, 0.0}; }

  /// Empty, or why it refuses.
  template <class Require>
  std::string refusal(const Require& require) const {
    try {
      require(terms());
    } catch (const PickRefusal& refused) {
      return refused.sentence;
    }
    return "";
  }

  const Robot robot_ = mast();
  const Snapshot snapshot_ = FreeSpaceMap({.resolution = 0.1}).snapshot();
  Pick pick_;
  PickToCheck plan_{robot_, snapshot_, pick_, Eigen::Isometry3d::Identity(),
                    std::vector<std::vector<Configuration>>(6, {at(0, 0)})};
};

TEST_F(PickTermsOfAMast, APlanHasSixLegsOrSevenOfConfigurationsThatFollowEachOther) {
  const auto refused = [&] { return refusal([](const PickTerms& terms) { terms.require_legs(); }); };
  for (const std::size_t count : {0U, 5U, 6U, 7U, 8U}) {
    plan_.legs.assign(count, {at(0, 0)});
    EXPECT_EQ(refused().empty(), count == 6 || count == 7) << count;
  }
  for (std::size_t leg = 0; leg < 6; ++leg) {
    const auto with = [&](const std::vector<Configuration>& waypoints) {
      plan_.legs.assign(6, {at(0, 0), at(0, 0)});
      plan_.legs[leg] = waypoints;
      return refused();
    };
    const std::string name = "leg " + std::to_string(leg + 1);
    EXPECT_EQ(with({at(0, 0)}), "");
    EXPECT_NE(with({}).find(name + " has no waypoints"), std::string::npos) << with({});
    for (const Configuration& bad : {Configuration(Eigen::Vector3d::Zero()), Configuration(), at(0, NAN)})
      EXPECT_NE(with({at(0, 0), bad, at(0, 0)}).find(name + " has a waypoint that is no"), std::string::npos);
    if (leg > 0) {
      EXPECT_NE(with({at(1e-9, 0), at(0, 0)}).find(name + " starts elsewhere"), std::string::npos);
    }
    if (leg < 5) {
      EXPECT_NE(with({at(0, 0), at(0, 1e-9)}).find("starts elsewhere"), std::string::npos);
    }
  }
}

/// With an axis that it goes along or against: of heights about where the contact ends.
TEST_F(PickTermsOfAMast, TheContactEndsAtItsHeightToATolerance) {
  pick_.contact = 0.25;
  pick_.map_from_place.translation().z() = 0.1;
  const auto first = [&](const std::vector<double>& heights) {
    std::vector<Configuration> path;
    for (const double height : heights) path.push_back(at(height, 0.0));
    return terms().first_past_contact(path);
  };
  const auto last = [&](const std::vector<double>& heights) {
    std::vector<Configuration> path;
    for (const double height : heights) path.push_back(at(height, 0.0));
    return terms().last_before_contact(path);
  };
  const double below = 0.25 - 1.1 * same_place, at_it = 0.25 - 0.9 * same_place;
  EXPECT_EQ(first({0.0, 0.1, below, at_it, 0.3}), 3U);
  EXPECT_EQ(first({at_it, 0.0, 0.3}), 0U);
  EXPECT_EQ(first({0.0, 0.3, 0.0, 0.3}), 1U);
  EXPECT_EQ(last({0.5, 0.1 + at_it, 0.1 + below, 0.1}), 1U);
  EXPECT_EQ(last({0.5, 0.4, 0.1, 0.1 + at_it}), 3U);
  EXPECT_EQ(last({0.5, 0.1, 0.5, 0.1}), 2U);
  EXPECT_THROW(first({0.0, below}), PickRefusal);
  EXPECT_THROW(last({0.1 + below, 0.0}), PickRefusal);
  for (const auto& [by, is_beyond] : {std::pair(-1.1, false), std::pair(0.9, false), std::pair(1.1, true)}) {
    const Configuration q = at(0.25 + by * same_place, 0.0), placed = at(0.35 + by * same_place, 0.0);
    EXPECT_EQ(terms().is_beyond_contact(pick_.map_from_object, q), is_beyond) << by;
    EXPECT_EQ(terms().is_beyond_contact(pick_.map_from_place, placed), is_beyond) << by;
  }
}

TEST_F(PickTermsOfAMast, TheHandIsOpenOrClosedToATolerance) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_TRUE(terms().is_open(at(0.5, 0.3 + sign * 0.9 * same_joint)));
    EXPECT_FALSE(terms().is_open(at(0.5, 0.3 + sign * 1.1 * same_joint)));
  }
  using Leg = PickTerms::Leg;
  using Pieces = std::vector<std::vector<Configuration>>;
  const auto refused = [&](Leg leg, const Pieces& pieces) {
    return refusal([&](const PickTerms& terms) { terms.require_hand(leg, pieces); });
  };
  const double open = 0.3, closed = 0.1, near = 0.9 * same_joint, far = 1.1 * same_joint;
  for (const Leg leg : {PickTerms::approach, PickTerms::leave})
    EXPECT_EQ(refused(leg, {{at(0, 0.2), at(1, 0.7)}}), "");
  for (const double sign : {1.0, -1.0}) {
    for (const Leg leg : {PickTerms::lift, PickTerms::carry, PickTerms::lower}) {
      EXPECT_EQ(refused(leg, {{at(0, closed)}, {at(0, closed + sign * near), at(1, closed)}}), "");
      EXPECT_NE(
          refused(leg, {{at(0, closed), at(1, closed + sign * far)}}).find(" has joint 'grip' not closed"),
          std::string::npos);
      EXPECT_NE(refused(leg, {{at(0, closed)}, {at(0, open), at(1, closed)}}), "");
    }
    const auto there = [&](double begin, double way, double end, double moves) {
      return refused(PickTerms::reach,
                     {{at(0, begin)}, {at(0, begin), at(1, way)}, {at(1, way), at(1 + moves, end)}});
    };
    EXPECT_EQ(there(open, open + sign * near, closed, 0.0), "");
    EXPECT_NE(there(open + sign * far, open, closed, 0.0).find(" begins with joint 'grip' not open"),
              std::string::npos);
    EXPECT_NE(there(open, open, closed + sign * far, 0.0).find(" ends with joint 'grip' not closed"),
              std::string::npos);
    EXPECT_NE(there(open, open + sign * far, closed, 0.0).find(": away from the object"), std::string::npos);
    EXPECT_EQ(there(open, open, closed, sign * near), "");
    EXPECT_NE(there(open, open, closed, sign * far).find(": away from the object"), std::string::npos);
    const auto back = [&](double begin, double way, double end, double moves) {
      return refused(PickTerms::retreat,
                     {{at(1, begin), at(1 + moves, way)}, {at(1 + moves, way), at(0, end)}});
    };
    EXPECT_EQ(back(closed, open, open, sign * near), "");
    EXPECT_NE(back(closed + sign * far, open, open, 0.0).find(" begins with joint 'grip' not closed"),
              std::string::npos);
    EXPECT_NE(back(closed, open, open + sign * far, 0.0).find(" ends with joint 'grip' not open"),
              std::string::npos);
    EXPECT_NE(back(closed, open, open, sign * far).find(": away from the object"), std::string::npos);
  }
  pick_.grip["thumb"] = {0.0, 0.0};
  EXPECT_NE(refused(PickTerms::reach, {{at(0, open)}, {at(0, closed)}}).find("lacks a joint of its grip"),
            std::string::npos);
}

/// The carriage's side is 0.05 m from its middle, the object's 0.025 m.
TEST_F(PickTermsOfAMast, WhatIsFartherFromTheObjectThanAHandIsNoted) {
  const auto note = [&](double gap) {
    pick_.map_from_object.translation().y() = 0.075 + gap;
    return hold_note(terms());
  };
  EXPECT_EQ(note(0.0049), "");
  EXPECT_NE(note(0.0051).find("than 5.1 mm: what holds it?"), std::string::npos) << note(0.0051);
  pick_.grip.clear();  // a hand that does not close
  EXPECT_EQ(note(0.0199), "");
  EXPECT_NE(note(0.0201).find("than 20.1 mm: what holds it?"), std::string::npos) << note(0.0201);
  EXPECT_EQ(note(-0.04), "");
  pick_.grip["grip"] = {0.3, 0.1};
  pick_.depth = 0.01;
  EXPECT_EQ(note(-0.0099), "");
  EXPECT_NE(note(-0.0101).find("closes deeper than 10 mm into 'box'"), std::string::npos);
  pick_.object.link = "rail";  // which has no body
  EXPECT_EQ(note(1.0), "");
  pick_.object.touches = {"carriage"};
  EXPECT_NE(note(1.0), "");
}

}  // namespace pick_terms_test
}  // namespace clearway::check
