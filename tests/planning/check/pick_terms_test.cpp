// What a pick states about tip and object: how far the plan may be off, to the last bit.
#include "planning/check/pick_terms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/free_space_map.hpp"
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

}  // namespace pick_terms_test
}  // namespace clearway::check
