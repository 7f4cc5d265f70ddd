#include "planning/check/check_pick.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planning/geometry/shape.hpp"
#include "planning/path/smooth_motion.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace check_pick_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

constexpr double edge = 0.02, top = 0.1;

/// A gantry whose hand takes a can from the side, with a ball on a rod that is not drawn: on the can's axis,
/// `below` its middle. @param more links and joints
worlds::UrdfRobot gantry(double below, const std::string& more) {
  const std::string none = "<link name='base'/><link name='x'/><link name='y'/>";
  return {"gantry",
          none + urdf_link("hand", "-0.03 0 0", "<sphere radius='0.005'/>") +
              urdf_link("fork", "0 0 0", "<sphere radius='0.005'/>") +
              urdf_joint("jx", "prismatic", "base", "x", "0 0 0", "1 0 0", urdf_limit(-1, 1)) +
              urdf_joint("jy", "prismatic", "x", "y", "0 0 0", "0 1 0", urdf_limit(-1, 1)) +
              urdf_joint("jz", "prismatic", "y", "hand", "0 0 0", "0 0 1", urdf_limit(-1, 1)) +
              urdf_joint("rod", "fixed", "hand", "fork", "0 0 " + std::to_string(-below), "1 0 0", "") +
              more};
}

/// A can on a shelf that is one voxel thick is taken, carried along it and put down; as its legs go by hand.
struct Errand {
  explicit Errand(double below, double lift = 0.1, const std::string& more = "")
      : below_(below), gantry_(gantry(below, more)), robot(gantry_.robot()) {
    for (std::size_t i = 0; i < robot.links.size(); ++i)
      if (robot.links[i].name == "hand") robot.tip_link = static_cast<int>(i);
    pick.object.name = "can";
    pick.object.link = "hand";
    pick.object.shape = Shape::cylinder(0.03, 0.12);
    pick.map_from_object.translation() << 0.2, 0.1, middle;
    pick.map_from_place.translation() << 0.2, -0.1, middle;
    pick.approach << 0.1, 0.0, 0.0;
    pick.lift = lift;
    pick.margin = 0.02;
    legs = {{at(0.05, 0.1, 0), at(0.1, 0.1, 0)}, {at(0.1, 0.1, 0), at(0.2, 0.1, 0)}, {}, {}, {}, {}};
    const int steps = static_cast<int>(std::lround(lift / 0.005));
    for (int i = 0; i <= steps; ++i) legs[2].push_back(at(0.2, 0.1, 0.005 * i));
    legs[3] = {legs[2].back(), at(0.2, -0.1, 0.005 * steps)};
    for (int i = steps; i >= 0; --i) legs[4].push_back(at(0.2, -0.1, 0.005 * i));
    legs[5] = {at(0.2, -0.1, 0), at(0.1, -0.1, 0)};
  }

  static Configuration at(double x, double y, double up) { return Eigen::Vector3d(x, y, middle + up); }

  PickToCheck stated(const Snapshot& map) const {
    return {robot, map, pick, Eigen::Isometry3d::Identity(), legs};
  }

  /// From a voxel to the hand, the fork and, on its way, the can where a verdict says that they meet it.
  double distance_at(const PathVerdict& verdict, const Eigen::Vector3d& voxel) const {
    std::vector<Configuration> all{legs[0][0]};
    std::vector<bool> is_carried;  // on each edge
    for (std::size_t leg = 0; leg < legs.size(); ++leg) {
      all.insert(all.end(), legs[leg].begin() + 1, legs[leg].end());
      is_carried.resize(all.size() - 1, leg >= 2 && leg <= 4);
    }
    const auto i = static_cast<std::size_t>(verdict.edge);
    if (verdict.edge < 0 || i + 1 >= all.size()) return HUGE_VAL;
    const Eigen::Vector3d hand = all[i] + verdict.parameter * (all[i + 1] - all[i]);
    const auto distance_of = [&](const Shape& shape, const Eigen::Vector3d& at) {
      return distance_to_cube(shape, Eigen::Isometry3d(Eigen::Translation3d(at)), voxel, edge).upper;
    };
    const Shape ball = Shape::sphere(0.005);
    return std::min({distance_of(ball, hand + Eigen::Vector3d(-0.03, 0.0, 0.0)),
                     distance_of(ball, hand + Eigen::Vector3d(0.0, 0.0, -below_)),
                     is_carried[i] ? distance_of(pick.object.shape, hand) : HUGE_VAL});
  }

  PathVerdict path(const Snapshot& map) const { return check_pick(stated(map), {}, 0.0); }

  SmoothMotion smooth() const {
    return smooth_motion(ConfigurationSpace(robot, Snapshot(), {.parts = {}, .critical_by_default = false}),
                         legs);
  }
  MotionVerdict motion(const Snapshot& map) const { return motion(map, smooth()); }
  /// @param left_out legs at the end of the motion that it lacks @param share of the speeds that may be
  MotionVerdict motion(const Snapshot& map, const SmoothMotion& made, std::size_t left_out = 0,
                       double share = 1.0) const {
    std::vector<std::size_t> ends = made.leg_ends;
    ends.resize(ends.size() - left_out);
    MotionToCheck motion{made.motion, ends, {legs.front().front()}, rate_limits(robot)};
    motion.limits.velocity *= share;
    for (const auto& leg : legs) motion.stops.push_back(leg.back());
    return check_pick_motion(stated(map), motion, {}, 0.0);
  }

  static constexpr double middle = top + 0.06;
  double below_;
  worlds::UrdfRobot gantry_;
  Robot robot;
  Pick pick;
  std::vector<std::vector<Configuration>> legs;
};

Snapshot shelf() {
  return VoxelScene{edge,
                    {box_of(0.1, -0.2, top - edge, 0.3, 0.2, top - 0.001),   // shelf
                     box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119)},  // can
                    {},
                    {}}
      .snapshot();
}

/// On the contact the support's layer is free for the load alone: a fork that goes up and down through it
/// meets it, and is past it before and after.
TEST(CheckPick, OnTheContactTheRobotItselfKeepsClearOfWhatTheObjectStandsOn) {
  const Snapshot map = shelf();
  const Errand above(-0.1), through(0.06 + edge + 0.007);
  const PathVerdict clear = above.path(map), met = through.path(map);
  EXPECT_TRUE(clear.valid) << clear.first_contact;
  EXPECT_GT(clear.min_clearance, 0.0);
  EXPECT_FALSE(met.valid);
  EXPECT_NE(met.first_contact.find("leg lift, its edge 0"), std::string::npos) << met.first_contact;
  EXPECT_NE(met.first_contact.find("fork touches a voxel"), std::string::npos) << met.first_contact;

  const MotionVerdict clear_motion = above.motion(map), met_motion = through.motion(map);
  EXPECT_TRUE(clear_motion.valid) << clear_motion.fault;
  EXPECT_GT(clear_motion.min_clearance, 0.0);
  EXPECT_FALSE(met_motion.valid);
  EXPECT_EQ(met_motion.min_clearance, 0.0);
  EXPECT_NE(met_motion.fault.find("fork touches a voxel"), std::string::npos) << met_motion.fault;

  // Without the layer the fork passes: nothing else is in its way.
  const Snapshot can_alone =
      VoxelScene{edge, {box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119)}, {}, {}}.snapshot();
  EXPECT_TRUE(through.path(can_alone).valid) << through.path(can_alone).first_contact;
}

TEST(CheckPick, RefusesAnObjectOnALinkThatMovesAgainstTheTip) {
  const Snapshot map = shelf();
  Errand errand(-0.1);
  for (const auto& [link, joint] :
       {std::pair{"y", "'jz'"}, std::pair{"x", "'jz'"}, std::pair{"base", "'jz'"}}) {
    errand.pick.object.link = link;
    const PathVerdict path = errand.path(map);
    EXPECT_FALSE(path.valid);
    for (const std::string& sentence : {path.first_contact, errand.motion(map).fault}) {
      EXPECT_NE(sentence.find(std::string("joint ") + joint + " moves link '" + link), std::string::npos)
          << sentence;
      EXPECT_NE(sentence.find("the tip, link 'hand'"), std::string::npos) << sentence;
    }
  }
  errand.pick.object.link =
      "fork";  // on a rod that is fixed to the hand, of which the load's pose is another
  EXPECT_EQ(errand.path(map).first_contact.find("moves link"), std::string::npos);
}

/// A plan that failed before the object is taken says nothing of how it is held.
TEST(CheckPick, NotesNothingOfAHoldThatIsNotReached) {
  Errand errand(-0.1);
  const Snapshot map = shelf();
  PickToCheck plan = errand.stated(map);
  const std::vector<std::string> whole = pick_notes(plan, 0.0);
  plan.legs.at(1).clear();  // that leads to the object
  EXPECT_LE(pick_notes(plan, 0.0).size(), whole.size());
  plan.legs.clear();
  EXPECT_LE(pick_notes(plan, 0.0).size(), whole.size());
}

TEST(CheckPick, NotesAPlaceBelowWhichTheMapHasNothing) {
  const auto note = [](const Snapshot& map, double up, double to_side) {
    Errand errand(-0.1);
    errand.pick.map_from_place.translation().z() += up;
    errand.pick.map_from_place.translation().y() += to_side;
    const std::vector<std::string> notes = pick_notes(errand.stated(map), 0.0);
    const auto found = std::find_if(notes.begin(), notes.end(), [](const std::string& one) {
      return one.find("below the place") != std::string::npos;
    });
    return found == notes.end() ? std::string() : *found;
  };
  EXPECT_EQ(note(shelf(), 0.0, 0.0), "");
  EXPECT_EQ(note(shelf(), 0.015, 0.0), "");  // its top voxel reaches into the layer
  EXPECT_NE(note(shelf(), 0.05, 0.0).find("below the place of 'can'"), std::string::npos);
  EXPECT_NE(note(shelf(), 0.0, -0.3), "");
  // Its own voxels are gone when it is put down where it stood.
  const Snapshot can_alone =
      VoxelScene{edge, {box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119)}, {}, {}}.snapshot();
  EXPECT_NE(note(can_alone, 0.0, 0.2), "");
}

/// The shelf with the can, and a board at this height of one voxel: what is lifted by 0.2 m is past it at the
/// end of the lift, and does not meet it on the contact.
Snapshot shelf_and_board(double x, double y) {
  return VoxelScene{edge,
                    {box_of(0.1, -0.2, top - edge, 0.3, 0.2, top - 0.001),
                     box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119),
                     box_of(x, y - 0.02, 0.26, x + 0.04, y + 0.02, 0.279)},
                    {},
                    {}}
      .snapshot();
}

TEST(CheckPick, AllOfTheLiftIsProvedAndAllOfTheWayDown) {
  const Errand errand(-0.3, 0.2);
  for (const auto& [leg, y] : {std::pair("leg lift", 0.1), std::pair("leg lower", -0.1)}) {
    const Snapshot beside = shelf_and_board(0.6, y), in_the_way = shelf_and_board(0.18, y);
    EXPECT_TRUE(errand.path(beside).valid) << errand.path(beside).first_contact;
    EXPECT_TRUE(errand.motion(beside).valid) << errand.motion(beside).fault;
    const PathVerdict path = errand.path(in_the_way);
    EXPECT_FALSE(path.valid);
    EXPECT_NE(path.first_contact.find(std::string(leg) + ", its edge"), std::string::npos)
        << path.first_contact;
    const MotionVerdict motion = errand.motion(in_the_way);
    EXPECT_FALSE(motion.valid);
    EXPECT_NE(motion.fault.find(leg), std::string::npos) << motion.fault;
  }
}

/// So many waypoints on and above the support and one at the other end of lift or way down, whose long edge
/// meets the board: refused for the board, or where the long edge begins on the contact for its height.
TEST(CheckPick, TheEdgeThatLeavesTheContactIsProvedHoweverLongItIs) {
  constexpr std::ptrdiff_t all = 41;  // waypoints
  for (const auto& [leg, y] : {std::pair(2U, 0.1), std::pair(4U, -0.1)}) {
    const Snapshot beside = shelf_and_board(0.6, y), in_the_way = shelf_and_board(0.18, y);
    const std::string name = leg == 2 ? "lift" : "lower";
    int valid = 0;
    for (const std::ptrdiff_t kept : {1, 5, 7, 8, 9, 10, 11, 13}) {
      Errand errand(-0.3, 0.2);
      std::vector<Configuration>& path = errand.legs[leg];
      ASSERT_EQ(path.size(), static_cast<std::size_t>(all));
      path.erase(path.begin() + (leg == 2 ? kept : 1), path.begin() + (leg == 2 ? all - 1 : all - kept));
      const PathVerdict free = errand.path(beside), met = errand.path(in_the_way);
      EXPECT_GE(free.valid, valid > 0) << kept << free.first_contact;
      if (!free.valid) {
        EXPECT_NE(free.first_contact.find("'can': " + name + ": "), std::string::npos) << free.first_contact;
      }
      EXPECT_FALSE(met.valid) << kept;
      EXPECT_NE(met.first_contact.find(name), std::string::npos) << kept << met.first_contact;
      valid += free.valid;
    }
    EXPECT_GT(valid, 2) << name;
  }
}

TEST(CheckPick, AMotionThatIsNoneOrTooFastIsRefusedAsSuchWhateverElseIsWrong) {
  const Snapshot map = shelf();
  Errand errand(-0.1);
  EXPECT_TRUE(errand.motion(map).valid);
  const MotionVerdict fast = errand.motion(map, errand.smooth(), 0, 0.5);
  EXPECT_FALSE(fast.valid);
  EXPECT_NE(fast.fault.find("motion: "), std::string::npos);
  errand.pick.approach.x() *= 0.5;  // its way goes on beyond what is stated
  EXPECT_NE(errand.motion(map).fault.find("straight"), std::string::npos) << errand.motion(map).fault;
  EXPECT_EQ(errand.motion(map, errand.smooth(), 0, 0.5).fault, fast.fault);
  EXPECT_EQ(errand.motion(map, errand.smooth(), 1).fault.find("pick"), std::string::npos)
      << errand.motion(map, errand.smooth(), 1).fault;
  EXPECT_NE(errand.motion(map, errand.smooth(), 1).fault.find("it has 5 legs"), std::string::npos)
      << errand.motion(map, errand.smooth(), 1).fault;
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

/// What one leg alone meets is met by path and motion, and named with that leg.
TEST(CheckPick, EachLegIsProvedAgainstWhatItAloneMeets) {
  constexpr double middle = Errand::middle;
  const auto box_about = [](double x, double y, double z, double half) {
    return box_of(x - half, y - half, z - half, x + half, y + half, z + half);
  };
  const std::vector<std::pair<std::string, Eigen::AlignedBox3d>> met{
      {"approach", box_about(0.05, 0.11, middle + 0.01, 0.009)},
      {"reach", box_about(0.13, 0.11, middle + 0.01, 0.009)},
      {"lift", box_about(0.21, 0.11, 0.31, 0.009)},
      {"carry", box_about(0.21, 0.01, 0.25, 0.009)},
      {"lower", box_about(0.21, -0.11, 0.17, 0.009)},
      {"retreat", box_about(0.13, -0.11, middle + 0.01, 0.009)},
      {"leave", box_about(0.03, -0.11, middle + 0.01, 0.009)}};
  Errand errand(-0.3);
  errand.legs.push_back({Errand::at(0.1, -0.1, 0), Errand::at(0.0, -0.1, 0)});
  EXPECT_TRUE(errand.path(shelf()).valid) << errand.path(shelf()).first_contact;
  EXPECT_TRUE(errand.motion(shelf()).valid) << errand.motion(shelf()).fault;
  for (std::size_t leg = 0; leg < met.size(); ++leg) {
    const auto& [name, box] = met[leg];
    const Snapshot map = VoxelScene{
        edge,
        {box_of(0.1, -0.2, top - edge, 0.3, 0.2, top - 0.001),
         box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119), box},
        {},
        {}}.snapshot();
    const PathVerdict path = errand.path(map);
    EXPECT_FALSE(path.valid) << name;
    EXPECT_NE(path.first_contact.find("leg " + name + ", its edge"), std::string::npos) << path.first_contact;
    EXPECT_LT(errand.distance_at(path, box.center()), 2e-4) << name << " edge " << path.edge;
    const MotionVerdict motion = errand.motion(map);
    EXPECT_FALSE(motion.valid) << name;
    EXPECT_EQ(motion.leg, static_cast<int>(leg)) << motion.fault;
    EXPECT_NE(motion.fault.find("leg " + name + ", "), std::string::npos) << motion.fault;
  }
}

/// A ball on the column, which goes along x alone: where the object is put it meets it on the way back, or
/// later. Fingers may touch the object, but not lie deep in it while the hand is open.
TEST(CheckPick, OnTheWayBackTheObjectStandsWhereItWasPut) {
  const auto contact = [](double ahead, double to_side, bool is_finger) {
    const std::string ball = "<sphere radius='0.005'/>",
                      place = std::to_string(ahead) + " " + std::to_string(to_side) + " 0.16";
    const std::string knob = urdf_link("knob", "0 0 0", ball) +
                             urdf_joint("arm", "fixed", "x", "knob", place, "1 0 0", ""),
                      finger = urdf_link("finger", "-0.08 0 0", ball) +
                               urdf_joint("grip", "prismatic", "hand", "finger", "0 0 0", "0 0 1",
                                          urdf_limit(0, 0.1));
    Errand errand(-0.3, 0.1, is_finger ? knob + finger : knob);
    errand.legs.push_back({Errand::at(0.1, -0.1, 0), Errand::at(0.0, -0.1, 0)});
    if (is_finger) {
      errand.pick.grip["grip"] = {0.0, 0.0};
      errand.pick.depth = 0.01;
      errand.pick.object.touches = {"knob"};
      for (auto& leg : errand.legs)
        for (Configuration& q : leg) q = (Configuration(4) << q, 0.0).finished();
    }
    const std::string path = errand.path(shelf()).first_contact, motion = errand.motion(shelf()).fault;
    const std::string same = path.empty() ? "" : "motion: " + path.substr(0, 11);
    EXPECT_EQ(motion.substr(0, same.size()), same) << path;
    EXPECT_EQ(path.empty(), motion.empty());
    return path;
  };
  for (const bool is_finger : {false, true}) {
    EXPECT_EQ(contact(0.06, -0.3, is_finger), "");
    const std::string met = contact(0.06, -0.1, is_finger), later = contact(0.15, -0.1, is_finger);
    EXPECT_TRUE(met.starts_with("leg retreat, its edge")) << met;
    EXPECT_EQ(met.find("can-deeper-than-10mm") != std::string::npos, is_finger) << met;
    EXPECT_TRUE(later.starts_with("leg leave, its edge")) << later;
  }
}

/// Fingers may touch the object from the reach on, not on the way there; the map knows nothing of it.
TEST(CheckPick, OnTheApproachNothingMayTouchTheObject) {
  const Snapshot map = VoxelScene{edge, {box_of(2, 2, 2, 2.01, 2.01, 2.01)}, {}, {}}.snapshot();
  Errand errand(-0.1);
  const auto past = [](double x) { return Errand::at(x, 0.1, -0.07); };  // the fork is in the can at 0.2 m
  errand.legs[0] = {past(0.05), past(0.15), past(0.05), Errand::at(0.1, 0.1, 0)};
  EXPECT_TRUE(errand.path(map).valid) << errand.path(map).first_contact;
  errand.legs[0][1] = past(0.35);
  for (const bool is_finger : {false, true}) {
    if (is_finger) errand.pick.object.touches = {"fork"};
    const PathVerdict path = errand.path(map);
    const MotionVerdict motion = errand.motion(map);
    EXPECT_TRUE(path.first_contact.starts_with("leg approach, its edge 0 ")) << path.first_contact;
    EXPECT_TRUE(motion.fault.starts_with("motion: leg approach, ")) << motion.fault;
  }
}

/// As above with the fork that goes through the support's layer, which is under the place alone.
TEST(CheckPick, TheRobotItselfKeepsClearOfWhatIsUnderThePlace) {
  const Errand through(0.06 + edge + 0.007);
  for (const double y : {-0.2, 0.0}) {
    const Snapshot map = VoxelScene{
        edge,
        {box_of(0.1, y, top - edge, 0.3, y + 0.2, top - 0.001),
         box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119)},
        {},
        {}}.snapshot();
    const std::string leg = y < 0.0 ? "leg lower" : "leg lift";
    EXPECT_NE(through.path(map).first_contact.find(leg), std::string::npos)
        << through.path(map).first_contact;
    EXPECT_NE(through.motion(map).fault.find(leg), std::string::npos) << through.motion(map).fault;
  }
}

}  // namespace check_pick_test
}  // namespace clearway
