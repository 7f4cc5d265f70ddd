#include "planning/check/check_pick.hpp"

#include <gtest/gtest.h>

#include "tests/planning/check/can_errand.hpp"

namespace clearway {
namespace check_pick_test {

using namespace can_errand;

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

/// It ends, at rest, where the can is put down.
TEST(CheckPick, AMotionOfFewerLegsThanItsPathIsRefused) {
  const Snapshot map = shelf();
  const Errand errand(-0.1);
  const SmoothMotion made = errand.smooth();
  const std::vector<std::size_t> ends(made.leg_ends.begin(), made.leg_ends.end() - 1);
  const Motion until_place = stretch_of(made.motion, 0, ends.back());
  MotionToCheck motion{until_place, ends, {errand.legs.front().front()}, rate_limits(errand.robot)};
  for (std::size_t leg = 0; leg < ends.size(); ++leg) motion.stops.push_back(errand.legs[leg].back());
  const MotionVerdict verdict = check_pick_motion(errand.stated(map), motion, {}, 0.0);
  EXPECT_FALSE(verdict.valid);
  EXPECT_EQ(verdict.fault, "motion: pick 'can': its motion has 5 legs, its path 6");
}

/// A fork that goes through the support's layer, which is under the place alone.
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
