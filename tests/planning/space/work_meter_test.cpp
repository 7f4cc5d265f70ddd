#include "planning/space/work_meter.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace work_meter_test {

using namespace std::chrono_literals;

void spend(std::chrono::milliseconds time) { std::this_thread::sleep_for(time); }

double total(const WorkTimes& times) {
  return times.search.value_or(0.0) + times.shortcuts.value_or(0.0) + times.proofs.value_or(0.0);
}

TEST(WorkMeter, SplitsWhatWasUsedByTheWallClockAndCountsEachMomentOnce) {
  const auto begin = std::chrono::steady_clock::now();
  WorkMeter meter;
  spend(4ms);
  {
    const WorkMeter::Scope shortcuts(&meter, PlanWork::shortcuts);
    spend(2ms);
    {
      const WorkMeter::Scope proof(&meter, PlanWork::proofs);
      spend(30ms);
    }
  }
  const WorkTimes times = meter.times(5.0);
  // However long the machine stalls: each part took its sleep at least, of no more than this.
  const std::chrono::duration<double> all = std::chrono::steady_clock::now() - begin;
  EXPECT_NEAR(total(times), 5.0, 1e-12);
  EXPECT_GE(*times.search, 5.0 * 0.004 / all.count());
  EXPECT_GE(*times.shortcuts, 5.0 * 0.002 / all.count());
  EXPECT_GE(*times.proofs, 5.0 * 0.030 / all.count());
}

TEST(WorkMeter, KnowsNothingOfWorkThatItNeverCameTo) {
  WorkMeter meter;
  {
    const WorkMeter::Scope none(nullptr, PlanWork::shortcuts);
    std::thread([&meter] { const WorkMeter::Scope of_another_thread(&meter, PlanWork::proofs); }).join();
    spend(1ms);
  }
  const WorkTimes times = meter.times(2.0);
  EXPECT_EQ(times.search, 2.0);
  EXPECT_EQ(times.shortcuts, std::nullopt);
  EXPECT_EQ(times.proofs, std::nullopt);
}

TEST(WorkMeter, AddsLegsOfWhichSomeDidNotComeToAll) {
  const WorkTimes sum = WorkTimes{1.0, 2.0, {}} + WorkTimes{10.0, {}, {}};
  EXPECT_EQ(sum.search, 11.0);
  EXPECT_EQ(sum.shortcuts, 2.0);
  EXPECT_EQ(sum.proofs, std::nullopt);
}

/// Each of the four ways to ask for an edge, whose answers stay what they are.
TEST(WorkMeter, CountsTheProofsOfItsSpaceAloneAndChangesNoAnswer) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
  Random random(5);
  const Eigen::VectorXd aside = Eigen::VectorXd::Constant(6, 1e-3);
  for (int i = 0; i < 40; ++i) {
    const Configuration from = random.configuration(robot),
                        to = from + 0.1 * (random.configuration(robot) - from);
    const auto ask = [&](const ConfigurationSpace& asked, int way) -> double {
      if (way == 0) return asked.is_edge_free(from, to);
      if (way == 1) return asked.is_edge_quickly_free(from, to);
      return way == 2 ? asked.free_share(from, to) : asked.is_edge_free(from, to, aside);
    };
    for (int way = 0; way < 4; ++way) {
      WorkMeter meter;
      const ConfigurationSpace metered = space.metered(meter);
      const double expected = ask(space, way);
      static_cast<void>(metered.is_free(from));
      EXPECT_EQ(meter.times(1.0).proofs, std::nullopt);
      EXPECT_EQ(ask(metered, way), expected);
      EXPECT_TRUE(meter.times(1.0).proofs.has_value()) << way;
    }
  }
  EXPECT_EQ(space.meter(), nullptr);
}

}  // namespace work_meter_test
}  // namespace clearway
