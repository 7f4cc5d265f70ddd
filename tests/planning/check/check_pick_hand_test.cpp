// The hand of a pick on its way: what it meets before it takes the object, and when it is open and closed.
#include <gtest/gtest.h>

#include <functional>

#include "planning/check/check_pick.hpp"
#include "tests/planning/check/can_errand.hpp"

namespace clearway {
namespace check_pick_hand_test {

using namespace can_errand;

/// The object's voxels leave the map when the hand reaches for it: what else is in them is met on the way
/// there.
TEST(CheckPick, OnTheApproachTheObjectsVoxelsAreStillInTheMap) {
  const Snapshot map =
      VoxelScene{edge, {box_of(0.165, 0.065, top, 0.235, 0.135, top + 0.119)}, {}, {}}.snapshot();
  for (const double x : {0.27, 0.24}) {  // where the fork goes past the can, from 0.01 m beside it on
    Errand errand(-0.1);
    errand.legs[0] = {Errand::at(0.05, 0.3, -0.07),  Errand::at(x, 0.3, -0.07),  Errand::at(x, -0.1, -0.07),
                      Errand::at(0.05, -0.1, -0.07), Errand::at(0.05, 0.1, 0.0), Errand::at(0.1, 0.1, 0.0)};
    const PathVerdict path = errand.path(map);
    const MotionVerdict motion = errand.motion(map);
    EXPECT_EQ(path.valid, x == 0.27) << path.first_contact;
    EXPECT_EQ(motion.valid, x == 0.27) << motion.fault;
    if (path.valid) continue;
    EXPECT_TRUE(path.first_contact.starts_with("leg approach, its edge 1 ")) << path.first_contact;
    EXPECT_TRUE(motion.fault.starts_with("motion: leg approach, ")) << motion.fault;
    for (const std::string& sentence : {path.first_contact, motion.fault})
      EXPECT_NE(sentence.find("fork touches a voxel"), std::string::npos) << sentence;
  }
}

/// Moves the last joint by so much and back between two knots, along a cubic B-spline of four pieces.
void nod(Motion& motion, std::size_t first, std::size_t last, double most) {
  const double weights[] = {1.0, -4.0, 6.0, -4.0, 1.0};
  const std::size_t piece = (last - first) / 4;
  const double seconds = motion.period * static_cast<double>(piece);
  for (std::size_t k = 0; k < 4 * piece; ++k) {
    for (int i = 0; i < 5; ++i) {
      const double t = std::max(static_cast<double>(k) / static_cast<double>(piece) - i, 0.0);
      const double share = most * weights[i] / 4.0;
      motion.positions[first + k].tail<1>().array() += share * t * t * t;
      motion.velocities[first + k].tail<1>().array() += share * 3.0 * t * t / seconds;
      motion.accelerations[first + k].tail<1>().array() += share * 6.0 * t / (seconds * seconds);
    }
  }
}

/// A finger behind the hand that its grip holds still: on the path it stands, in the motion it does not.
TEST(CheckPick, AMotionThatMovesTheHandWhileItHoldsIsRefusedHoweverItsPathIs) {
  const Snapshot map = shelf();
  Errand errand(-0.1, 0.1,
                urdf_link("finger", "-0.08 0 0", "<sphere radius='0.005'/>") +
                    urdf_joint("grip", "prismatic", "hand", "finger", "0 0 0", "0 0 1", urdf_limit(0, 0.1)));
  errand.pick.grip["grip"] = {0.0, 0.0};
  errand.pick.depth = 0.01;  // the hand's ball is on the can's skin
  for (auto& leg : errand.legs)
    for (Configuration& q : leg) q = (Configuration(4) << q, 0.0).finished();
  EXPECT_TRUE(errand.path(map).valid) << errand.path(map).first_contact;
  EXPECT_TRUE(errand.motion(map).valid) << errand.motion(map).fault;
  const SmoothMotion still = errand.smooth();
  for (const auto& [leg, name] : {std::pair(2U, "lift"), std::pair(3U, "carry"), std::pair(4U, "lower")}) {
    SmoothMotion moved = still;
    nod(moved.motion, still.leg_ends[leg - 1], still.leg_ends[leg], 1e-4);
    const MotionVerdict verdict = errand.motion(map, moved);
    EXPECT_FALSE(verdict.valid) << name;
    EXPECT_NE(verdict.fault.find(std::string(name) + " has joint 'grip' not closed"), std::string::npos)
        << verdict.fault;
  }
}

/// With a finger behind the hand that is open on its way to the can and from it, and closed between.
struct OpeningErrand : Errand {
  static constexpr double open = 0.02;

  /// @param more links and joints
  explicit OpeningErrand(const std::string& more = "")
      : Errand(-0.1, 0.1,
               urdf_link("finger", "-0.08 0 0", "<sphere radius='0.005'/>") +
                   urdf_joint("grip", "prismatic", "hand", "finger", "0 0 0", "0 0 1", urdf_limit(0, 0.1)) +
                   more) {
    pick.grip["grip"] = {open, 0.0};
    pick.depth = 0.01;
    const auto with = [](const Configuration& q, double grip) {
      return (Configuration(4) << q, grip).finished();
    };
    for (std::size_t leg = 0; leg < legs.size(); ++leg)
      for (Configuration& q : legs[leg]) q = with(q, leg < 2 || leg > 4 ? open : 0.0);
    legs[1].push_back(legs[2].front());               // it closes
    legs[5].insert(legs[5].begin(), legs[4].back());  // it opens
  }
};

TEST(CheckPickHand, IsAskedForOnEachLegFromTheReachToTheRetreat) {
  const Snapshot map = shelf();
  const OpeningErrand good;
  EXPECT_TRUE(good.path(map).valid) << good.path(map).first_contact;
  const auto refused = [&](const std::function<void(OpeningErrand&)>& change) {
    OpeningErrand errand;
    change(errand);
    const PathVerdict verdict = errand.path(map);
    EXPECT_EQ(verdict.valid, verdict.first_contact.empty());
    EXPECT_EQ(verdict.valid ? -1.0 : verdict.min_clearance, verdict.valid ? -1.0 : 0.0);
    return verdict.first_contact;
  };
  for (const auto& [leg, name] : {std::pair(2U, "lift"), std::pair(4U, "lower")}) {
    const std::string sentence = refused([&](OpeningErrand& errand) { errand.legs[leg][3][3] = 0.01; });
    EXPECT_NE(sentence.find(std::string(name) + " has joint 'grip' not closed"), std::string::npos)
        << sentence;
  }
  const std::string reach = refused([](OpeningErrand& errand) { errand.legs[1].pop_back(); });
  EXPECT_NE(reach, "");
  const std::string retreat = refused([](OpeningErrand& errand) {
    errand.legs[5][1][3] = errand.legs[5][2][3] = 0.01;  // half open
  });
  EXPECT_NE(retreat.find("retreat ends with joint 'grip' not open"), std::string::npos) << retreat;
}

/// On the way back an elbow, which may touch the can, is where it would go through it: closing the hand once
/// more before does not hide that.
TEST(CheckPickHand, OnTheWayBackNothingIsDeepInTheObjectHoweverOftenTheHandCloses) {
  OpeningErrand errand(urdf_link("elbow", "0.08 0 0", "<sphere radius='0.005'/>") +
                       urdf_joint("raise", "prismatic", "y", "elbow", "0 0 0", "0 0 1", urdf_limit(0, 1)));
  errand.pick.object.touches = {"elbow"};
  for (auto& leg : errand.legs)
    for (Configuration& q : leg) q = (Configuration(5) << q, 0.5).finished();
  const Snapshot map = shelf();
  EXPECT_TRUE(errand.path(map).valid) << errand.path(map).first_contact;
  errand.legs[3].back()[4] = Errand::middle;  // down beside the can
  for (const std::size_t leg : {4U, 5U})
    for (Configuration& q : errand.legs[leg]) q[4] = Errand::middle;
  const Configuration closed = errand.legs[5][0], open = errand.legs[5][1];
  for (int i = 0; i < 2; ++i) {
    const PathVerdict verdict = errand.path(map);
    EXPECT_FALSE(verdict.valid) << i;
    EXPECT_NE(verdict.first_contact.find("leg retreat, its edge "), std::string::npos)
        << verdict.first_contact;
    EXPECT_NE(verdict.first_contact.find("elbow touches can-deeper-than-10mm"), std::string::npos)
        << verdict.first_contact;
    errand.legs[5].insert(errand.legs[5].begin(), {closed, open});
  }
}

/// A motion that is refused is as near as nothing, whatever was proved before.
TEST(CheckPickHand, OfAMotionThatIsRefusedNoClearanceIsLeft) {
  const Errand errand(-0.1);
  const Snapshot blocked = VoxelScene{
      edge,
      {box_of(0.1, -0.2, top - edge, 0.3, 0.2, top - 0.001),
       box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119),
       box_of(0.121, -0.119, 0.161, 0.139, -0.101, 0.179)},
      {},
      {}}.snapshot();  // on the way back
  const MotionVerdict verdict = errand.motion(blocked);
  EXPECT_FALSE(verdict.valid);
  EXPECT_EQ(verdict.leg, 5) << verdict.fault;
  EXPECT_EQ(verdict.min_clearance, 0.0);
}

}  // namespace check_pick_hand_test
}  // namespace clearway
