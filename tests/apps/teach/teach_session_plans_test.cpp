// Plans of a live session, and what its record makes of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "apps/teach/shown_session.hpp"
#include "apps/teach/teach_session.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {
namespace teach_session_plans_test {

/// A session of a small arm in much paint, which saves maps by name.
struct SavingSession {
  explicit SavingSession(bool waits_for_plans)
      : session([this](double until) { return events_until(until); },
                {.waits_for_plans = waits_for_plans,
                 .save = [this](const std::string& name, const Snapshot&) { saved.push_back(name); }}) {
    setup.probe.emplace();
    setup.robot.emplace();
    setup.robot->name = "planar2";
    map.paint(map.add_volume("free", {}), {Eigen::Vector3d::Zero(), 3.0}, 0.0);
    counts.spheres = 1;
    session.begin(setup, map, counts);
  }
  /// Two volumes of paint with a gap between them.
  void split_paint() {
    map = FreeSpaceMap(MapOptions{.resolution = 0.05});
    const int volume = map.add_volume("free", {});
    for (const double x : {-1.2, 1.2}) map.paint(volume, {Eigen::Vector3d(x, 0, 0), 1.1}, 0.0);
    ++counts.spheres;
  }
  std::vector<TeachEvent> events_until(double until) {
    const auto end =
        std::find_if(due.begin(), due.end(), [until](const TeachEvent& event) { return event.time > until; });
    std::vector<TeachEvent> now(due.begin(), end);
    due.erase(due.begin(), end);
    return now;
  }
  void add(double time, TeachAction action, const std::string& text = "") {
    TeachEvent event;
    event.time = time;
    event.action = action;
    (action == TeachAction::start || action == TeachAction::goal ? event.q : event.name) = text;
    due.push_back(event);
  }
  /// What a report says of the events that are recorded.
  std::vector<std::string> record() const {
    std::vector<std::string> lines;
    for (const TaughtEvent& event : session.events())
      if (!event.is_late) lines.push_back(line_of(event));
    return lines;
  }

  clearway::Setup setup;
  FreeSpaceMap map{MapOptions{.resolution = 0.05}};
  FusionCounts counts;
  std::vector<TeachEvent> due;
  std::vector<std::string> saved;
  TeachSession session;
};

TEST(TeachSessionPlans, ASaveThatIsPressedWhileAPlanIsMadeLeavesTheRecordWhole) {
  SavingSession live(false), again(true);
  live.add(1.0, TeachAction::start, "0,0.3");
  live.add(1.0, TeachAction::goal, "1,0.5");
  live.add(1.0, TeachAction::plan, "P");
  live.add(1.0, TeachAction::save, "P");
  live.session.before(1.0);
  EXPECT_EQ(live.session.events().back().refusal, "a plan is being made; wait for it");
  for (double time = 1.1; live.session.state() == TeachState::planning; time += 0.1)
    live.session.before(time);
  live.add(1e6, TeachAction::save, "Q");
  live.session.before(1e6);
  live.session.end();
  for (const TaughtEvent& event : live.session.events())
    if (!event.is_late) again.due.push_back(event.event);
  again.session.before(2e6);
  again.session.end();
  EXPECT_EQ(again.saved, std::vector<std::string>{"Q"});
  EXPECT_EQ(live.saved, again.saved);
  EXPECT_EQ(live.record(), again.record());
}

/// No way leads over the gap, and the planner does not give up before its minute is over.
TEST(TeachSessionPlans, QuitStopsThePlanAndTheRecordLeavesItOut) {
  SavingSession live(false), again(true);
  for (SavingSession* one : {&live, &again}) one->split_paint();
  live.add(1.0, TeachAction::start, "0,0.3");
  live.add(1.0, TeachAction::goal, "3.1,0.3");
  live.add(1.0, TeachAction::plan, "P");
  live.session.before(1.0);
  ASSERT_EQ(live.session.events().back().refusal, "");
  live.session.before(1.1);
  ASSERT_EQ(live.session.state(), TeachState::planning);
  live.add(1.2, TeachAction::quit);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(live.session.before(1.2));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  live.session.end();
  EXPECT_EQ(live.session.events()[2].refusal, "the session ended before it was made");
  EXPECT_TRUE(live.session.plans().empty());
  for (const TaughtEvent& event : live.session.events())
    if (!event.is_late) again.due.push_back(event.event);
  again.session.before(2.0);
  again.session.end();
  EXPECT_EQ(live.record(), again.record());
}

TEST(TeachSessionPlans, ARefusalNamesNoFlagThatASessionLacks) {
  Plan plan;
  plan.legs.emplace_back().status = PlanStatus::solved;
  plan.validation.first_contact = "forearm leaves the map's bounds" + why_refused_outside("forearm");
  EXPECT_EQ(sentence_of(plan),
            "not proved: forearm leaves the map's bounds: nothing is known of that place, which the policy "
            "not_occupied counts as free; paint there, or let a sensor look there");
}

}  // namespace teach_session_plans_test
}  // namespace clearway
