#include "apps/teach/teach_session.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace teach_session_test {

/// A session without pictures: a setup with a probe, spheres painted as the fusion would.
class TeachSessionOf : public testing::Test {
 protected:
  explicit TeachSessionOf(double resolution = 0.05) : map_(MapOptions{.resolution = resolution}) {
    setup_.probe.emplace();
    setup_.volumes = {{.label = "free", .critical_parts = {}}};
    map_.add_volume("free", {});
    RobotSetup robot;
    robot.name = "planar2";
    setup_.robot = robot;
    session_.begin(setup_, map_, counts_);
  }
  /// Does it now and tells why not; empty when it was done.
  std::string act(TeachAction action, const std::string& text = "") {
    TeachEvent event;
    event.time = time_ += 1.0;
    event.action = action;
    if (action == TeachAction::start || action == TeachAction::via || action == TeachAction::goal ||
        action == TeachAction::place)
      event.q = text;
    else if (action == TeachAction::robot)
      event.robot.robot = text;
    else
      event.name = text;
    if (action == TeachAction::plan) event.planner = "rrtconnect";
    due_ = {event};
    session_.before(time_);
    return session_.events().back().refusal;
  }
  /// All that the arm can reach.
  void paint_everything() {
    EXPECT_EQ(act(TeachAction::paint_on), "");
    EXPECT_EQ(session_.brush().use, Brush::Use::paints);
    map_.paint(session_.brush().volume, {Eigen::Vector3d::Zero(), 3.0}, time_);
    ++counts_.spheres;
    EXPECT_EQ(act(TeachAction::paint_off), "");
  }
  /// A rod along the forearm, its middle so far from the elbow; also under the name of another.
  std::string attach(double length, double middle, const std::string& name = "rod") {
    TeachEvent event;
    event.time = time_ += 1.0;
    event.action = TeachAction::attach;
    event.name = name;
    event.load.emplace();
    event.load->setup.name = name;
    event.load->setup.shape = LoadBox{{length, 0.04, 0.04}};
    event.load->setup.link = "forearm";
    event.load->setup.link_from_load.translation().x() = middle;
    due_ = {event};
    session_.before(time_);
    return session_.events().back().refusal;
  }
  std::string remark() const { return session_.events().back().remark; }

  double time_ = 0.0;
  std::vector<TeachEvent> due_;
  clearway::Setup setup_;
  FreeSpaceMap map_;
  FusionCounts counts_;
  TeachSession session_{[this](double) { return std::exchange(due_, {}); }, TeachOptions{.seed = 3}};
};

TEST_F(TeachSessionOf, EachStateTakesWhatBelongsAndRefusesTheRestWithACure) {
  EXPECT_EQ(session_.state(), TeachState::ready);
  EXPECT_EQ(act(TeachAction::paint_off), "paint_off: nothing is being painted; 'paint_on' begins a stroke");
  EXPECT_EQ(act(TeachAction::erase_off), "erase_off: nothing is being erased; 'erase_on' begins that");
  EXPECT_EQ(act(TeachAction::goal, "0,0"), "goal: no start is chosen; 'start' comes first");
  EXPECT_EQ(act(TeachAction::plan), "plan: no start is chosen; 'start' chooses one");
  EXPECT_EQ(act(TeachAction::play), "play: there is no plan; 'plan' makes one");
  EXPECT_EQ(act(TeachAction::approve), "approve: there is no plan that is proved; 'plan' makes one");
  EXPECT_EQ(act(TeachAction::undo), "undo: nothing was done");
  EXPECT_EQ(act(TeachAction::save, "x"), "save: this session saves nothing before its end");
  EXPECT_EQ(act(TeachAction::start), "start: the setup has no gripper to show it with, and the event no 'q'");
  EXPECT_EQ(act(TeachAction::paint_on), "");
  EXPECT_EQ(session_.state(), TeachState::painting);
  for (const TeachAction action : {TeachAction::paint_on, TeachAction::erase_on, TeachAction::start,
                                   TeachAction::plan, TeachAction::volume, TeachAction::robot})
    EXPECT_EQ(act(action, "x"),
              std::string(to_string(action)) + ": a stroke is being painted; 'paint_off' ends it");
  EXPECT_EQ(act(TeachAction::paint_off), "");
  EXPECT_EQ(act(TeachAction::erase_on), "");
  EXPECT_EQ(session_.state(), TeachState::erasing);
  EXPECT_EQ(session_.brush().use, Brush::Use::erases);
  EXPECT_EQ(act(TeachAction::paint_off), "paint_off: the ball erases; 'erase_off' ends that");
  EXPECT_EQ(act(TeachAction::erase_off), "");
  EXPECT_EQ(act(TeachAction::quit), "");
  EXPECT_EQ(session_.state(), TeachState::ended);
  EXPECT_EQ(act(TeachAction::paint_on), "paint_on: the session has ended");
}

TEST_F(TeachSessionOf, StartAndGoalsLieInsideOfThePaintAndAPlanBetweenThemIsApproved) {
  EXPECT_NE(act(TeachAction::start, "0,0").find("start: "), std::string::npos);  // nothing is painted yet
  EXPECT_EQ(session_.state(), TeachState::ready);
  paint_everything();
  EXPECT_NE(act(TeachAction::start, "0").find("start: got 1 values, expected 2"), std::string::npos);
  EXPECT_EQ(act(TeachAction::start, "0,0.3"), "");
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(act(TeachAction::plan), "plan: no goal is chosen; 'goal' chooses one");
  EXPECT_EQ(act(TeachAction::via, "0.5,0.3"), "");
  EXPECT_EQ(act(TeachAction::goal, "1,1"), "");
  EXPECT_EQ(act(TeachAction::goal, "1,0.5"), "");  // replaces
  EXPECT_EQ(session_.goals().size(), 2u);
  EXPECT_EQ(act(TeachAction::plan, "first"), "");
  EXPECT_EQ(act(TeachAction::plan, "first"),
            "plan: there is a plan or a map 'first' already, expected another name");
  EXPECT_EQ(session_.state(), TeachState::planned);
  ASSERT_EQ(session_.plans().size(), 1u);
  EXPECT_TRUE(session_.plans()[0].plan.is_proved());
  EXPECT_EQ(session_.plans()[0].map_digest, map_sha256(map_.snapshot()));
  EXPECT_EQ(act(TeachAction::play), "");
  EXPECT_EQ(session_.state(), TeachState::playing);
  const Plan& plan = session_.plans()[0].plan;
  EXPECT_EQ(session_.shown_configuration(), plan.waypoints().front());
  ASSERT_TRUE(plan.motion);
  EXPECT_EQ(remark(), "it lasts " + short_text(plan.motion->motion.duration(), 3) + " s");
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(session_.state(), TeachState::approved);
  EXPECT_TRUE(session_.plans()[0].is_approved);
}

TEST_F(TeachSessionOf, AllThatWasDoneIsUndoneStepByStep) {
  const std::string empty = map_sha256(map_.snapshot());
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "approval is undone");
  EXPECT_EQ(session_.state(), TeachState::planned);
  EXPECT_FALSE(session_.plans()[0].is_approved);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_TRUE(session_.goals().empty());
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.state(), TeachState::ready);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "stroke is undone");
  EXPECT_EQ(map_.snapshot().counts().painted, 0u);
  EXPECT_NE(act(TeachAction::start, "0,0.3"), "");  // no paint is left
  EXPECT_EQ(act(TeachAction::undo), "undo: nothing was done");
}

TEST_F(TeachSessionOf, APlanIsNotApprovedOnceWhatItRestsOnIsBlocked) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  // A scan that sees something right where the arm goes.
  const Robot& robot = session_.robot()->robot();
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
  const Eigen::Vector3d tip = tip_pose(robot, session_.plans()[0].plan.waypoints().back()).translation();
  for (double dx = -0.1; dx <= 0.1; dx += 0.02)
    for (double dy = -0.1; dy <= 0.1; dy += 0.02)
      scan.points.push_back((tip + Eigen::Vector3d(dx, dy, -2)).cast<float>());
  ++counts_.scans;  // taken, and waits for the place of its sensor
  ASSERT_EQ(act(TeachAction::approve), "");
  ASSERT_EQ(act(TeachAction::undo), "");
  map_.insert(scan);
  ++counts_.scans_inserted;
  const std::string why = act(TeachAction::approve);
  EXPECT_NE(why.find("approve: the map has changed since it was planned: "), std::string::npos) << why;
  EXPECT_EQ(session_.state(), TeachState::planned);
  EXPECT_FALSE(session_.plans()[0].is_approved);
}

/// A motion leaves the plan's edges at corners: it is what a person approves, so it has to hold as well.
TEST_F(TeachSessionOf, TheCheckOfATaughtPlanIsOfItsMotionToo) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::via, "0.5,0.9"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  TaughtPlan taught = session_.plans().at(0);
  ASSERT_TRUE(taught.plan.motion);
  EXPECT_TRUE(check_taught(taught, map_.snapshot()).valid);
  for (Eigen::VectorXd& velocity : taught.plan.motion->motion.velocities) velocity *= 1.5;
  const PathVerdict verdict = check_taught(taught, map_.snapshot());
  EXPECT_FALSE(verdict.valid);
  EXPECT_NE(verdict.first_contact.find("motion"), std::string::npos) << verdict.first_contact;
}

TEST_F(TeachSessionOf, ALoadIsAttachedOnceAndDetachedByItsName) {
  EXPECT_EQ(act(TeachAction::detach), "detach: nothing is attached; 'attach' takes a load");
  EXPECT_EQ(act(TeachAction::attach, "can"),
            "attach: the setup has no load 'can', nor any other; the event may bring one with it, as 'load'");
  LoadSetup can;
  can.name = "can", can.shape = LoadSphere{0.1}, can.link = "forearm";
  setup_.loads = {can};
  EXPECT_EQ(act(TeachAction::attach, "cane"), "attach: the setup has no load 'cane', did you mean 'can'?");
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
  EXPECT_EQ(remark(), "can on forearm");
  EXPECT_EQ(act(TeachAction::attach, "can"), "attach: 'can' is attached already; 'detach' comes first");
  EXPECT_EQ(attach(0.3, 1.0), "");
  EXPECT_EQ(session_.shown_loads().size(), 2u);
  EXPECT_EQ(act(TeachAction::detach), "detach: expected the name of a load, one of 'can' and 'rod'");
  EXPECT_EQ(act(TeachAction::detach, "cup"), "detach: no load 'cup' is attached; 'can' and 'rod' are");
  EXPECT_EQ(act(TeachAction::detach, "can"), "");
  EXPECT_EQ(act(TeachAction::detach), "");
  EXPECT_TRUE(session_.shown_loads().empty());
  setup_.loads.front().link = "hand";
  EXPECT_NE(act(TeachAction::attach, "can").find("robot 'planar2' has no link 'hand'"), std::string::npos);
  setup_.loads.front().link = "forearm";
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
  EXPECT_EQ(act(TeachAction::paint_on), "");
  EXPECT_EQ(act(TeachAction::detach), "detach: a stroke is being painted; 'paint_off' ends it");
  EXPECT_EQ(act(TeachAction::paint_off), "");
  EXPECT_EQ(act(TeachAction::robot, "arm6"), "");  // which holds nothing
  EXPECT_EQ(act(TeachAction::detach), "detach: nothing is attached; 'attach' takes a load");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.shown_loads().size(), 1u);
}

TEST_F(TeachSessionOf, ALoadOfTwoQueriesIsTakenOnlyWhereBothMeanTheSame) {
  LoadSetup can;
  can.name = "can", can.shape = LoadSphere{0.1}, can.link = "forearm";
  setup_.queries.resize(2);
  for (QuerySetup& query : setup_.queries) query.loads = {can};
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
  EXPECT_EQ(act(TeachAction::detach), "");
  setup_.queries[1].loads[0].shape = LoadSphere{0.2};  // the smaller one would stand for both
  EXPECT_NE(act(TeachAction::attach, "can").find("different loads 'can'"), std::string::npos);
  setup_.loads = {can};  // which says so
  EXPECT_EQ(act(TeachAction::attach, "can"), "");
}

/// The paint is a ball of 3 m, the arm's reach 2.05 m: whether the load stays inside is told by its corners.
TEST_F(TeachSessionOf, PlacesAreRefusedWhereTheLoadLeavesThePaint) {
  paint_everything();
  for (const double length : {0.2, 0.6, 1.0, 1.4, 1.8, 2.2, 2.6}) {
    ASSERT_EQ(act(TeachAction::clear), "");
    ASSERT_EQ(attach(length, 1.0 + 0.5 * length), "");
    const bool is_inside = Eigen::Vector3d(2.0 + length, 0.02, 0.02).norm() < 3.0 - 0.1;
    const bool is_outside = 2.0 + length > 3.0;
    const std::string why = act(TeachAction::start, "0,0");
    if (is_inside) {
      EXPECT_EQ(why, "") << length;
      EXPECT_EQ(remark(), "0, 0; with 'rod'");
    }
    if (is_outside) {
      EXPECT_NE(why.find("start: rod"), std::string::npos) << length << why;
    }
    EXPECT_EQ(act(TeachAction::start, "0,2.5"), "") << length;  // folded: within reach of any of them
    EXPECT_EQ(act(TeachAction::goal, "0,0") == "", why.empty()) << length;
    ASSERT_EQ(act(TeachAction::detach, "rod"), "");
    EXPECT_EQ(act(TeachAction::start, "0,0"), "") << length;
    EXPECT_EQ(attach(length, 1.0 + 0.5 * length) == "", why.empty()) << length;  // where the leg would begin
    act(TeachAction::detach, "rod");
  }
}

TEST_F(TeachSessionOf, ALegCarriesWhatIsHeldWhenItsEndIsPicked) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::via, "0.3,0.3"), "");
  ASSERT_EQ(attach(0.4, 1.2), "");
  ASSERT_EQ(act(TeachAction::via, "0.6,0.3"), "");
  ASSERT_EQ(attach(0.1, 0.5, "clip"), "");
  ASSERT_EQ(act(TeachAction::via, "0.9,0.3"), "");
  ASSERT_EQ(act(TeachAction::detach, "rod"), "");
  ASSERT_EQ(act(TeachAction::goal, "1.2,0.3"), "");
  ASSERT_EQ(act(TeachAction::plan, "carry"), "");
  ASSERT_EQ(act(TeachAction::play), "");
  const TaughtPlan& taught = session_.plans().back();
  ASSERT_TRUE(taught.plan.is_proved());
  ASSERT_EQ(taught.plan.loads.size(), 2u);
  EXPECT_EQ(taught.plan.loads[0].load.name, "rod");
  EXPECT_EQ(taught.plan.loads[0].legs, (std::vector<int>{1, 2}));
  EXPECT_EQ(taught.plan.loads[1].legs, (std::vector<int>{2, 3}));
  EXPECT_EQ(taught.plan.policies.at("rod"), taught.plan.policies.at("forearm"));
  const auto planned = std::find_if(session_.events().begin(), session_.events().end(),
                                    [](const auto& told) { return told.event.action == TeachAction::plan; });
  EXPECT_NE(planned->remark.find("carries rod on forearm, legs 2, 3"), std::string::npos) << planned->remark;
  // Along what is played, each leg shows its own loads.
  std::vector<std::size_t> seen;
  for (double at = time_; session_.state() == TeachState::playing; session_.before(at += 0.05))
    if (seen.empty() || seen.back() != session_.shown_loads().size())
      seen.push_back(session_.shown_loads().size());
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 1, 2, 1}));
}

TEST_F(TeachSessionOf, APlanWhoseLoadWasChangedIsNotApprovedAndUndoBringsItBack) {
  paint_everything();
  ASSERT_EQ(attach(0.4, 1.2), "");
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::detach), "");
  EXPECT_EQ(act(TeachAction::approve), "approve: 'rod' was detached since it was planned; plan again");
  EXPECT_NE(attach(0.5, 1.2).find("another load 'rod' rides on a leg before"), std::string::npos);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "detach is undone");
  EXPECT_EQ(session_.shown_loads().size(), 1u);
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(session_.state(), TeachState::approved);
  ASSERT_EQ(attach(0.1, 0.5, "clip"), "");
  EXPECT_EQ(act(TeachAction::plan),
            "plan: 'clip' was attached after the goal was chosen; 'goal' chooses it anew");
  EXPECT_EQ(act(TeachAction::goal, "1,0.5"), "");
  EXPECT_EQ(act(TeachAction::plan), "");
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(session_.plans().back().plan.loads.size(), 2u);
}

/// A post that only the load meets: the plan is refused with it, and holds without.
TEST_F(TeachSessionOf, WhatOnlyTheLoadWouldHitIsHeldAgainstThePlan) {
  for (const bool is_loaded : {true, false}) {
    if (is_loaded) {
      paint_everything();
      ASSERT_EQ(attach(0.4, 1.2), "");
    } else {
      ASSERT_EQ(act(TeachAction::detach), "");
    }
    ASSERT_EQ(act(TeachAction::start, "0,0.01"), "");
    ASSERT_EQ(act(TeachAction::goal, "1,0.01"), "");
    ASSERT_EQ(act(TeachAction::plan), "");
    ASSERT_EQ(act(TeachAction::play), "");
    if (is_loaded) {
      Scan scan;
      scan.map_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
      const Eigen::Vector3d post = 2.3 * Eigen::Vector3d(std::cos(0.5), std::sin(0.5), 0.0);
      for (double z = -0.1; z <= 0.1; z += 0.02)
        scan.points.push_back((post + Eigen::Vector3d(0, 0, z - 2)).cast<float>());
      map_.insert(scan);
      ++counts_.scans_inserted;
    }
    const std::string why = act(TeachAction::approve);
    if (is_loaded) {
      EXPECT_NE(why.find("approve: the map has changed since it was planned: "), std::string::npos) << why;
      EXPECT_NE(why.find("rod"), std::string::npos) << why;
      EXPECT_EQ(act(TeachAction::plan), "");  // with the elbow bent
      EXPECT_EQ(act(TeachAction::approve), "");
      EXPECT_GT(session_.plans().back().plan.waypoints().size(), 2u);
    } else {
      EXPECT_EQ(why, "");
    }
  }
}

/// A can on a table before the six-joint arm, all seen by sensors; a stroke goes round the can.
class TeachPick : public TeachSessionOf {
 protected:
  TeachPick() : TeachSessionOf(0.02) {
    BoardSetup board;
    board.name = "base";
    board.map_from_board = Eigen::Isometry3d::Identity();
    setup_.boards = {board};
    setup_.probe->ball_radius = 0.0225;
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.42, 0.0, 1.5);
    add_box(scan, {0.25, -0.45, 0.05}, {0.69, 0.45, 0.1});
    add_box(scan, {0.41, 0.15, 0.11}, {0.44, 0.18, 0.22});
    see(scan);
    map_.paint(0, {Eigen::Vector3d(0.0, 0.0, 0.5), 1.6}, time_);  // so that the map knows of all places
    ++counts_.spheres;
    TeachEvent robot;
    robot.time = ++time_;
    robot.action = TeachAction::robot;
    robot.robot.robot = "arm6";
    robot.robot.policies = {"not_occupied"};
    EXPECT_EQ(act(robot), "");
  }
  static void add_box(Scan& scan, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    for (double x = low.x(); x <= high.x(); x += 0.02)
      for (double y = low.y(); y <= high.y(); y += 0.02)
        for (double z = low.z(); z <= high.z(); z += 0.02)
          scan.points.push_back((scan.map_from_sensor.inverse() * Eigen::Vector3d(x, y, z)).cast<float>());
  }
  void see(const Scan& scan) {
    map_.insert(scan);
    ++counts_.scans_inserted;
  }
  std::string act(const TeachEvent& event) {
    due_ = {event};
    session_.before(time_);
    return session_.events().back().refusal;
  }
  using TeachSessionOf::act;
  std::string mark(const std::string& name, const std::string& link = "", double x = 0.42) {
    TeachEvent event;
    event.time = ++time_;
    event.action = TeachAction::object;
    event.name = name;
    event.link = link;
    if (const std::string why = act(event); !why.empty()) return why;
    EXPECT_EQ(session_.state(), TeachState::marking);
    EXPECT_EQ(session_.brush().use, Brush::Use::none);
    for (double turn = 0.0; turn < 6.3; turn += 0.3)
      for (const double height : {0.0, 0.05, 0.11}) {
        PaintingSample sample;
        sample.accepted = turn < 6.2;
        sample.sphere.center = {x + 0.025 * std::cos(turn), 0.16 + 0.025 * std::sin(turn), 0.1225 + height};
        sample.sphere.radius = 0.02;
        sample.bound.total = 0.002;
        session_.see({frame_, {}, &sample, {}, time_, {}});
      }
    return act(TeachAction::object_off);
  }
  /// The first of the arm's configurations with the tip so, from above, that the session takes.
  std::string take(TeachAction action, const Eigen::Vector3d& tip, const std::string& name = "") {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = tip;
    pose.linear() = Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Configuration near = (Configuration(6) << 0, -1.9, 1.7, -1.4, -1.57, 0).finished();
    std::string why = "none";
    for (const Configuration& q : goal_configurations(session_.robot()->robot(), pose, near)) {
      TeachEvent event;
      event.time = ++time_;
      event.action = action;
      event.name = name;
      event.q = to_text(std::vector<double>(q.begin(), q.end()));
      if ((why = act(event)).empty()) break;
    }
    return why;
  }
  Frame frame_;
};

TEST_F(TeachPick, AMarkedObjectIsTakenAndPutDownAndOnlyWhatHoldsItTouchesIt) {
  const std::string before = map_sha256(map_.snapshot());
  EXPECT_EQ(act(TeachAction::object_off), "object_off: no object is being marked; 'object' begins that");
  EXPECT_NE(mark("can", "hnd").find("did you mean 'hand'?"), std::string::npos);
  ASSERT_EQ(mark("can"), "");
  EXPECT_EQ(mark("can"), "object: there is an object 'can' already, expected another name");
  EXPECT_EQ(map_sha256(map_.snapshot()), before);
  EXPECT_EQ(act(TeachAction::pick), "pick: no start is chosen; 'start' comes first");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  EXPECT_EQ(act(TeachAction::place, "0,0,0,0,0,0"), "place: nothing is picked; 'pick' comes first");
  EXPECT_EQ(act(TeachAction::pick, "cup"), "pick: no object 'cup' is marked");
  EXPECT_NE(take(TeachAction::pick, {0.42, 0.16, 0.09}), "");  // the hand in the table
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}), "");
  EXPECT_EQ(act(TeachAction::via, "0,-1.9,1.7,-1.4,-1.57,0"),
            "via: a pick has no goals on the way; 'goal' says where the robot goes in the end");
  EXPECT_EQ(act(TeachAction::plan), "plan: no place is chosen; 'place' says where 'can' goes");
  EXPECT_NE(take(TeachAction::place, {0.42, -0.2, 0.17}), "");  // the can in the table
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(act(TeachAction::goal, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(act(TeachAction::plan, "carry"), "");
  ASSERT_EQ(act(TeachAction::play), "")
      << session_.plans().back().plan.explanation() << session_.plans().back().plan.validation.first_contact;
  const TaughtPlan& taught = session_.plans().back();
  ASSERT_TRUE(taught.plan.is_proved());
  ASSERT_TRUE(taught.plan.pick.has_value());
  EXPECT_EQ(taught.plan.legs.size(), 7U);
  ASSERT_EQ(taught.plan.loads.size(), 1U);
  EXPECT_EQ(taught.plan.loads[0].legs, (std::vector<int>{2, 3, 4}));
  // The can stands, rides, and stands where it was put.
  ASSERT_EQ(session_.standing_objects().size(), 1U);
  const Eigen::Vector3d from = session_.standing_objects()[0].second.translation();
  std::size_t rides = 0;
  Eigen::Vector3d last = from;
  for (double at = time_; session_.state() == TeachState::playing; session_.before(at += 0.05)) {
    const auto standing = session_.standing_objects();
    EXPECT_EQ(standing.size() + session_.shown_loads().size(), 1U);
    rides += standing.empty();
    if (!standing.empty()) last = standing[0].second.translation();
  }
  EXPECT_GT(rides, 3U);
  EXPECT_NEAR((last - from).y(), -0.36, 1e-3);
  EXPECT_EQ(act(TeachAction::approve), "");
  EXPECT_EQ(map_sha256(map_.snapshot()), before);
}

TEST_F(TeachPick, APickTakesNoVoxelOfAnotherMarkedObject) {
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.48, 0.0, 1.5);
  add_box(scan, {0.47, 0.15, 0.11}, {0.50, 0.18, 0.22});
  see(scan);
  ASSERT_EQ(mark("can"), "");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(mark("cup", "", 0.48), "");
  const std::string refusal = "with 'can' voxels of 'cup' would leave the map";
  EXPECT_NE(take(TeachAction::pick, {0.42, 0.16, 0.21}, "can").find(refusal), std::string::npos);
  // Marked after the pick: the plan is refused.
  ASSERT_EQ(act(TeachAction::undo), "");
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}, "can"), "");
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(mark("cup", "", 0.48), "");
  EXPECT_NE(act(TeachAction::plan, "carry").find(refusal), std::string::npos);
}

TEST_F(TeachPick, APickIsUndoneStepByStepAndNotApprovedOnceItsWayIsBlocked) {
  ASSERT_EQ(mark("can", "hand"), "");
  ASSERT_EQ(act(TeachAction::start, "0,-1.9,1.7,-1.4,-1.57,0"), "");
  ASSERT_EQ(take(TeachAction::pick, {0.42, 0.16, 0.21}), "");
  ASSERT_EQ(take(TeachAction::place, {0.42, -0.2, 0.212}), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  Scan wall;  // across the way
  wall.map_from_sensor.translation() = Eigen::Vector3d(0.42, 0.0, 1.5);
  add_box(wall, {0.01, -0.03, 0.11}, {0.99, -0.01, 0.9});
  see(wall);
  const std::string why = act(TeachAction::approve);
  EXPECT_NE(why.find("approve: the map has changed since it was planned: "), std::string::npos) << why;
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "plan is undone");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "place is undone");
  EXPECT_NE(act(TeachAction::plan).find("no place is chosen"), std::string::npos);
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "pick is undone");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(remark(), "object is undone");
  EXPECT_TRUE(session_.standing_objects().empty());
}

TEST_F(TeachSessionOf, APlanRestsOnAMapWithTheVolumesThatThereAre) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  ASSERT_EQ(act(TeachAction::volume, "another"), "");
  ASSERT_EQ(act(TeachAction::plan), "");
  ASSERT_EQ(act(TeachAction::play), "");
  EXPECT_EQ(session_.plans()[0].map_digest, map_sha256(map_.snapshot()));
}

TEST_F(TeachSessionOf, ARobotStandsWhereTheSetupHasIt) {
  setup_.robot->map_from_base.translation() = Eigen::Vector3d(0, 0, 0.1);
  setup_.robot->scale = 0.5;
  ASSERT_EQ(act(TeachAction::robot, "planar2"), "");
  EXPECT_EQ(session_.robot()->robot().map_from_base.translation().z(), 0.1);
  EXPECT_EQ(session_.robot()->robot().scale, 0.5);
  ASSERT_EQ(act(TeachAction::robot, "arm6"), "");
  EXPECT_EQ(session_.robot()->robot().map_from_base.translation().z(), 0.1);
  EXPECT_NE(session_.robot()->robot().scale, 0.5);
}

TEST_F(TeachSessionOf, AFailedPlanSaysWhyAndTheChoiceStays) {
  paint_everything();
  ASSERT_EQ(act(TeachAction::start, "0,0.3"), "");
  ASSERT_EQ(act(TeachAction::goal, "1,0.5"), "");
  TeachEvent event;
  event.time = ++time_;
  event.action = TeachAction::plan;
  event.planner = "nosuch";
  due_ = {event};
  session_.before(time_);
  EXPECT_NE(session_.events().back().refusal.find("nosuch"), std::string::npos);
  EXPECT_EQ(session_.state(), TeachState::selecting);
  EXPECT_EQ(act(TeachAction::robot, "nosuch").substr(0, 7), "robot: ");
  EXPECT_EQ(act(TeachAction::robot, "arm6"), "");
  EXPECT_EQ(session_.state(), TeachState::ready);  // another robot: start and goals are gone
  EXPECT_EQ(act(TeachAction::undo), "");
  EXPECT_EQ(session_.state(), TeachState::selecting);
}

TEST(Teach, WhatIsWrongIsToldInOneSentence) {
  const TemporaryFolder folder;
  const std::string recording = "/usr/share/mrpt/datasets/localization_demo.rawlog";
  const auto refusal = [&](const std::string& line) {
    folder.write("e.jsonl", line);
    const CommandRun run =
        run_command({"teach", recording, "--events", folder.file("e.jsonl"), "--out", folder.file("out")});
    EXPECT_EQ(run.status, exit_bad_input) << line;
    EXPECT_TRUE(run.told_in_one_sentence()) << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    return run.log;
  };
  const auto expect = [&](const std::string& line, const std::string& part) {
    const std::string told = refusal(line);
    EXPECT_NE(told.find(part), std::string::npos) << told;
  };
  expect("{\"time\": 0}", "e.jsonl', line 1: field 'action'");
  expect("{\"time\": 0, \"action\": \"pant_on\"}", "an action, did you mean 'paint_on'?");
  expect("{\"time\": -1, \"action\": \"paint_on\"}", "seconds after the first frame, 0 or more");
  expect("{\"time\": 0, \"action\": \"paint_on\", \"lable\": \"x\"}", "no such field with action 'paint_on'");
  expect("{\"time\": 2, \"action\": \"paint_on\"}\n{\"time\": 1, \"action\": \"paint_off\"}",
         "line 2: field 'time': expected a time not before the last line's");
  expect("{\"time\": 0, \"action\": \"plan\", \"name\": \"../x\"}", "letters, digits");
  expect("{\"time\": 0, \"action\": \"plan\", \"planner\": \"bem\"}", "bem");
  expect("{\"time\": 0, \"action\": \"robot\", \"robot\": \"arm6\", \"fixed\": {\"a=b\": 1}}",
         "the name of a joint, without '='");
  expect("{\"time\": 0, \"action\": \"robot\", \"robot\": \"nosuch.urdf\"}", "nosuch.urdf");
  const auto expect_load = [&](const std::string& fields, const std::string& part) {
    expect("\n{\"time\": 0, \"action\": \"attach\", " + fields + "}", part);
  };
  expect_load("\"load\": {\"name\": \"can\", \"sphere\": -1, \"link\": \"hand\"}",
              "e.jsonl', line 2: field 'load', sphere: ");
  expect_load("\"load\": {\"name\": \"can\", \"sphere\": 1, \"lnk\": \"hand\"}", "field 'load', link: ");
  expect_load("\"load\": {\"name\": \"can\", \"sphere\": 1, \"link\": \"hand\", \"legs\": [1]}",
              "no 'legs': a load rides from 'attach' to 'detach'");
  expect_load("\"load\": [1]", "field 'load'");
  expect_load("\"load\": {}, \"name\": \"can\"", "either 'load', a load, or 'name'");
  expect_load("\"q\": \"1\"", "no such field with action 'attach'");
  expect_load("\"name\": \"can\"", "at 0 s, attach: the setup has no load 'can'");
  expect_load("\"load\": {\"name\": \"can\", \"mesh\": \"no.stl\", \"link\": \"hand\"}", "no.stl");
  expect("{\"time\": 0, \"action\": \"object\"}", "field 'name'");
  expect("{\"time\": 0, \"action\": \"object\", \"name\": \"a\", \"mass\": -1}", "a number from 0 to 1e6");
  expect("{\"time\": 0, \"action\": \"pick\", \"approach\": [0, 1]}", "field 'approach'");
  expect("nothing", "is not valid JSON at line 1");
}

TEST(Teach, KeysAreReadBeforeTheSessionAndAreForTheWindow) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& keys, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"teach",  "/usr/share/mrpt/datasets/localization_demo.rawlog",
                                          "--keys", folder.write("k.jsonl", keys),
                                          "--out",  folder.file("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.told_in_one_sentence()) << run.log;
    return run.log;
  };
  EXPECT_NE(refusal("{\"key\": \"1\", \"action\": \"robot\", \"robot\": \"no.urdf\"}", {})
                .find("k.jsonl', key '1', robot: "),
            std::string::npos);
  const std::string fine = "{\"key\": \"1\", \"action\": \"robot\", \"robot\": \"arm6\"}";
  EXPECT_NE(refusal(fine, {"--events", folder.write("e.jsonl", "")}).find("--keys: expected no --events"),
            std::string::npos);
  EXPECT_NE(refusal("{\"key\": 1}", {}).find("k.jsonl', line 1"), std::string::npos);
}

TEST(Teach, ARecordedSessionTakesNoOtherSettings) {
  const TemporaryFolder folder;
  folder.write("session.json", "{}");
  const auto expect = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--out", folder.file("out")});
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.told_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("is a recorded session"), std::string::npos) << run.log;
  };
  const std::string session = folder.file(".");
  expect({"replay", session, "--setup", "nosuch.yaml"});
  expect({"replay", session, "--no-plan"});
  expect({"replay", session, "--seed", "2"});
  expect({"teach", session, "--events", "nosuch.jsonl"});
  expect({"teach", session, "--resolution", "0.1"});
}

TEST(Teach, NothingIsWrittenOverTheRecordingOrIntoIt) {
  const TemporaryFolder folder;
  folder.write("e.jsonl", "{\"time\": 0, \"action\": \"quit\"}");
  folder.write("s.yaml", "map: {resolution: 0.1}\n");
  folder.write("r.rawlog", "a recording");
  std::filesystem::create_directory(folder / "pictures");
  const auto expect = [&](const std::string& source, const std::string& out, const std::string& video,
                          const std::string& part) {
    const CommandRun run = run_command({"teach", folder.file(source), "--setup", folder.file("s.yaml"),
                                        "--events", folder.file("e.jsonl"), "--headless", "--out",
                                        folder.file(out), "--video-out", folder.file(video)});
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.told_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(part), std::string::npos) << run.log;
  };
  expect("pictures", "pictures/taught", "v.mp4", "lies in the recording");
  expect("pictures", "pictures", "v.mp4", "lies in the recording");
  expect("r.rawlog", "taught", "r.rawlog", "is read by SOURCE");
  expect("r.rawlog", "taught", "e.jsonl", "is read by --events");
}

TEST(Teach, WhatASessionRecordedGoesWithNoOtherCommand) {
  const TemporaryFolder folder;
  save_map(FreeSpaceMap({.resolution = 0.1}).snapshot(), folder / "map");
  std::filesystem::create_directories(folder / "taught/session/source");
  std::filesystem::create_directories(folder / "taught/approved");
  const std::string recording =
      folder.write("taught/session/source/frames.rawlog", "all that there is of it");
  folder.write("taught/approved/plan.yaml", "a motion");
  folder.write("taught/.clearway_files", "approved/plan.yaml\nmap.ot\nsession/source/frames.rawlog\n");
  const std::string taught = folder.file("taught");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"replay", recording, "--out", taught},
        {"replay", folder.file("nosuch.rawlog"), "--out", taught},
        {"inspect", folder.file("map"), "--coarsen", "0.2", "--save", taught},
        {"tags", "print", "--out", taught},
        {"compare", "quick", "--out", taught},
        {"track", folder.write("r.rawlog", ""), "--draw", taught, "--setup", "miniature_kitchen"}}) {
    const CommandRun run = run_command(command);
    EXPECT_EQ(run.status, exit_bad_input) << command[0];
    EXPECT_TRUE(run.told_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("it holds 'approved/plan.yaml', which another command wrote"), std::string::npos)
        << command[0] << ": " << run.log;
  }
  EXPECT_EQ(read_file(recording), "all that there is of it");
  EXPECT_TRUE(std::filesystem::exists(folder / "taught/approved/plan.yaml"));
}

TEST(Teach, EventsAreReadBackAsTheyWere) {
  const TemporaryFolder folder;
  const std::string text =
      "{\"time\":0.0,\"action\":\"robot\",\"robot\":\"arm6\",\"scale\":0.5,\"base\":[0.0,1.0,2.0],\"group\":"
      "\"g\","
      "\"fixed\":{\"j\":0.25},\"policies\":{\"default\":\"known_free\",\"tool\":\"painted\"},\"padding\":0."
      "001,"
      "\"near\":[0.0,1.0]}\n"
      "{\"time\":0.5,\"action\":\"attach\",\"load\":{\"name\":\"can\",\"cylinder\":[0.03,0.1],\"link\":"
      "\"hand\",\"pose_deg\":[0.1,0,0,10,20,30.3],\"touches\":[\"finger\"]}}\n"
      "{\"time\":0.5,\"action\":\"attach\",\"name\":\"a cup\"}\n"
      "{\"time\":0.6,\"action\":\"detach\",\"name\":\"a cup\"}\n"
      "{\"time\":0.6,\"action\":\"detach\"}\n"
      "{\"time\":0.7,\"action\":\"object\",\"link\":\"hand\",\"mass\":0.25,\"touches\":[\"finger\"],\"name\":"
      "\"a can\"}\n"
      "{\"time\":0.7,\"action\":\"object\",\"name\":\"\"}\n"
      "{\"time\":0.8,\"action\":\"object_off\"}\n"
      "{\"time\":0.9,\"action\":\"pick\",\"approach\":[0.0,0.1,-0.1],\"lift\":0.2,\"contact\":0.05,\"q\":"
      "\"1\","
      "\"name\":\"a can\"}\n"
      "{\"time\":0.9,\"action\":\"place\",\"q\":\"1\"}\n"
      "{\"time\":1.0,\"action\":\"volume\",\"label\":\"a\",\"critical_parts\":[\"tool\"]}\n"
      "{\"time\":2.5,\"action\":\"start\",\"q\":\"0,1,2\"}\n"
      "{\"time\":3.0,\"action\":\"plan\",\"planner\":\"beam\",\"options\":{\"width\":\"20\"},\"name\":\"p\"}"
      "\n"
      "{\"time\":3.0,\"action\":\"quit\"}\n";
  folder.write("e.jsonl", text);
  std::string again;
  for (const TeachEvent& event : load_teach_events(folder / "e.jsonl")) again += to_json_line(event) + "\n";
  EXPECT_EQ(again, text);
}

TEST(Teach, EventsThatWouldFillTheMemoryAreRefused) {
  const TemporaryFolder folder;
  folder.write("e.jsonl", std::string(100'001, '\n'));
  EXPECT_THROW(load_teach_events(folder / "e.jsonl"), std::invalid_argument);
  folder.write("e.jsonl", std::string(100'000, '\n'));
  EXPECT_TRUE(load_teach_events(folder / "e.jsonl").empty());
}

TEST(Teach, ALoadsNameIsATextHoweverItIsWritten) {
  const TemporaryFolder folder;
  folder.write("e.jsonl",
               "{\"time\":0.5,\"action\":\"attach\",\"load\":{\"name\":5,\"box\":[0.1,0.1,0.1],"
               "\"link\":\"hand\"}}\n");
  const std::string line = to_json_line(load_teach_events(folder / "e.jsonl").front());
  EXPECT_NE(line.find("\"name\":\"5\""), std::string::npos) << line;
}

}  // namespace teach_session_test
}  // namespace clearway
