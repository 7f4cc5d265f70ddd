// How far a load may stray between waypoints, against what its way and heights are by arithmetic.
#include "planning/check/pick_ways.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "mapping/free_space_map.hpp"
#include "planning/check/motion_check.hpp"
#include "tests/planning/check/ball_errand.hpp"

namespace clearway::check {
namespace pick_ways_test {

using namespace ball_errand;

constexpr double radius = 0.1, edge = 0.05, length = 0.2;

Pick ball() { return pick_of_ball(radius); }

/// The largest number from 0 to 0.5 m that is accepted, where all smaller ones are.
double largest(const std::function<bool(double)>& is_accepted) {
  double accepted = 0.0, refused = 0.5;
  while (refused - accepted > 1e-10) {
    const double middle = (accepted + refused) / 2;
    (is_accepted(middle) ? accepted : refused) = middle;
  }
  return accepted;
}

/// A ball that the hand holds by its middle, on its way up.
class PickWays : public ::testing::Test {
 protected:
  PickTerms terms(double padding) { return {plan_, {}, padding, 0.0}; }

  bool is_straight(const MotionTubes& curve) {
    try {
      require_no_bow(terms(0.0), PickTerms::lift, {0.0, 0.0, length}, curve);
    } catch (const PickRefusal& refusal) {
      EXPECT_EQ(refusal.leg, PickTerms::lift);
      return false;
    }
    return true;
  }

  bool keeps_heights(double padding, const MotionTubes& curve) {
    try {
      require_heights(terms(padding), carrying_, pick_.map_from_object, PickTerms::lower, curve);
    } catch (const PickRefusal& refusal) {
      EXPECT_EQ(refusal.leg, PickTerms::lower);
      return false;
    }
    return true;
  }

  const Robot robot_ = gantry();
  const Snapshot map_ = FreeSpaceMap({.resolution = edge}).snapshot();
  const Pick pick_ = ball();
  const PickToCheck plan_{robot_, map_, pick_, Eigen::Isometry3d::Identity(),
                          std::vector<std::vector<Configuration>>(6, {at(0, 0, 0)})};
  const Robot carrying_ = terms(0.0).loaded();
};

/// A millimetre, and so much of the ball as its middle's millirad would move it.
constexpr double most_aside = 1e-3 * (2.0 + radius);

TEST_F(PickWays, TheLoadMayStrayFromItsLineByATipsToleranceToEachSide) {
  ASSERT_TRUE(is_straight({{at(0, 0, 0), at(0, 0, length)}, {}}));
  for (const double around : {0.0, 1.0, 2.5, 4.0}) {
    const auto strays = [&](double off) {
      const double x = off * std::cos(around), y = off * std::sin(around);
      return is_straight({{at(0, 0, 0), at(x, y, 0.12), at(0, 0, length)}, {}});
    };
    EXPECT_NEAR(largest(strays), most_aside, 1e-8) << around;
  }
  const auto goes_back = [&](double off) {
    return is_straight({{at(0, 0, 0), at(0, 0, -off), at(0, 0, 0.1)}, {}});
  };
  const auto goes_beyond = [&](double off) {
    return is_straight({{at(0, 0, 0), at(0, 0, length + off)}, {}});
  };
  EXPECT_NEAR(largest(goes_back), most_aside, 1e-8);
  EXPECT_NEAR(largest(goes_beyond), most_aside, 1e-8);
}

TEST_F(PickWays, TheLoadMayTurnUntilAPointOfItStraysAsFar) {
  for (const double sign : {1.0, -1.0}) {
    const auto turns = [&](double by) {
      return is_straight({{at(0, 0, 0), at(0, 0, 0.12, sign * by), at(0, 0, length)}, {}});
    };
    EXPECT_NEAR(2.0 * radius * std::sin(largest(turns) / 2), most_aside, 1e-8);
  }
}

/// A spike that points away from the hand, along either direction of each axis of the object.
TEST_F(PickWays, ALoadMayTurnUntilItsFarthestPointStraysWhicheverThatIs) {
  constexpr double reach = 0.3, thin = 0.01;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d tip = sign * reach * Eigen::Vector3d::Unit(axis),
                            u = thin * Eigen::Vector3d::Unit((axis + 1) % 3),
                            v = thin * Eigen::Vector3d::Unit((axis + 2) % 3);
      Pick spike = pick_;
      spike.object.shape = Shape::convex({tip, u, v, -u, -v});
      const Eigen::Isometry3d hand_from_spike(
          Eigen::Quaterniond::FromTwoVectors(tip, Eigen::Vector3d::UnitX()));
      const PickToCheck plan{robot_, map_, spike, hand_from_spike, plan_.legs};
      const auto turns = [&](double by) {
        try {
          require_no_bow({plan, {}, 0.0, 0.0}, PickTerms::lift, {0.0, 0.0, length},
                         {{at(0, 0, 0), at(0, 0, 0.12, by), at(0, 0, length)}, {}});
        } catch (const PickRefusal&) {
          return false;
        }
        return true;
      };
      EXPECT_NEAR(2.0 * reach * std::sin(largest(turns) / 2), 1e-3 * (2.0 + reach), 1e-8) << axis << sign;
    }
  }
}

TEST_F(PickWays, WhatTheCurveMayBeOffItsChordIsTakenFromThatPieceAlone) {
  const auto left = [&](const Eigen::Vector4d& first, const Eigen::Vector4d& second,
                        const Eigen::Vector4d& third) {
    return largest([&](double off) {
      return is_straight(
          {{at(0, 0, 0), at(0, 0, 0.1), at(off, 0, 0.12), at(0, 0, length)}, {first, second, third}});
    });
  };
  const Eigen::Vector4d none = Eigen::Vector4d::Zero(), slide(4e-4, 0.0, 0.0, 0.0), turn(0.0, 0.0, 0.0, 4e-3);
  EXPECT_NEAR(left(none, none, none), most_aside, 1e-8);
  EXPECT_NEAR(left(slide, none, none), most_aside, 1e-8);
  EXPECT_NEAR(left(none, slide, none), most_aside - 4e-4, 1e-8);
  EXPECT_NEAR(left(none, none, slide), most_aside - 4e-4, 1e-8);
  EXPECT_NEAR(left(none, turn, none), most_aside - 4e-3 * radius, 1e-8);
  EXPECT_EQ(left(2.1e-3 * Eigen::Vector4d::UnitX(), none, none), 0.0);
}

TEST_F(PickWays, OnTheContactTheLoadSinksAndRisesByThePaddingWithinItsBoundsAtMost) {
  for (const auto& [padding, sinking] :
       {std::pair(0.0, 1e-4), std::pair(4e-4, 4e-4), std::pair(0.01, 1e-3)}) {
    const double contact = contact_length(pick_, edge, padding);
    for (const double off : {0.0, 5e-5}) {
      const Eigen::Vector4d along(0.0, 0.0, off, 0.0), beside(off, 0.0, 0.0, 0.0),
          none = Eigen::Vector4d::Zero();
      const auto sinks = [&](double by) {
        return keeps_heights(padding, {{at(0, 0, 0), at(0, 0, -by), at(0, 0, 0)}, {along, along}});
      };
      const auto rises = [&](double by) {
        return keeps_heights(padding, {{at(0, 0, 0), at(0, 0, by), at(0, 0, 0)}, {along, along}});
      };
      EXPECT_NEAR(largest(sinks), sinking - off, 1e-8) << padding;
      EXPECT_NEAR(largest(rises), contact + sinking - off, 1e-8) << padding;
      const auto with_plain_end = [&](double by) {
        return keeps_heights(padding, {{at(0, 0, 0), at(0.1, 0, 0), at(0.1, 0, -by)}, {along, none}});
      };
      EXPECT_NEAR(largest(with_plain_end), sinking, 1e-8) << padding;
      EXPECT_TRUE(keeps_heights(padding, {{at(0, 0, 0), at(0.5, 0.2, 0, 0.5)}, {beside * 0.1}}));
    }
    EXPECT_TRUE(keeps_heights(padding, {{at(0, 0, 0), at(0, 0, 0)}, {}}));
  }
}

/// In an empty map.
struct Errand : BallErrand {
  Errand() : BallErrand(radius, length, 0.4) {}

  std::string refusal() const {
    return check_pick({robot, map, pick, Eigen::Isometry3d::Identity(), legs}, {}, 0.0).first_contact;
  }

  const Snapshot map = FreeSpaceMap({.resolution = edge}).snapshot();
};

TEST(StraightWaysOfAPick, WaypointsMayBeOffByATipsToleranceAndByNothingMore) {
  EXPECT_EQ(Errand().refusal(), "");
  for (const auto& [leg, along, name] : {std::tuple(1, 0, "reach"), std::tuple(2, 2, "lift"),
                                         std::tuple(4, 2, "lower"), std::tuple(5, 0, "retreat")}) {
    for (int joint = 0; joint < 4; ++joint) {
      for (const double sign : {1.0, -1.0}) {
        const auto refusal_of = [&, leg = leg, along = along](double off) {
          Errand errand;
          Configuration& middle = errand.legs[static_cast<std::size_t>(leg)][1];
          if (joint == along) {  // back before its begin, or beyond its end
            const auto& path = errand.legs[static_cast<std::size_t>(leg)];
            const double way = path[2][joint] - path[0][joint];
            middle[joint] = sign > 0.0 ? path[2][joint] + std::copysign(off, way)
                                       : path[0][joint] - std::copysign(off, way);
          } else {
            middle[joint] += sign * off;
          }
          return errand.refusal();
        };
        EXPECT_EQ(refusal_of(0.999e-3).find("straight way"), std::string::npos) << name << " joint " << joint;
        EXPECT_NE(
            refusal_of(1.001e-3).find("a waypoint of " + std::string(name) + " is off its straight way"),
            std::string::npos)
            << name << " joint " << joint << ": " << refusal_of(1.001e-3);
      }
    }
  }
}

TEST(StraightWaysOfAPick, TheirLengthsMayBeOffByATipsToleranceAndByNothingMore) {
  for (const double sign : {1.0, -1.0}) {
    const auto refusal_of = [&](double lift, double approach) {
      Errand errand;
      errand.pick.lift += sign * lift;
      errand.pick.approach.x() += sign * approach;
      return errand.refusal();
    };
    EXPECT_EQ(refusal_of(0.999e-3, 0.999e-3), "");
    EXPECT_NE(refusal_of(1.001e-3, 0.0), "");
    EXPECT_NE(refusal_of(0.0, 1.001e-3), "");
  }
}

}  // namespace pick_ways_test
}  // namespace clearway::check
