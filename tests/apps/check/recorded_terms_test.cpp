#include "apps/check/recorded_terms.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace recorded_terms_test {

Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

RecordedTerms queries_at(const std::vector<Eigen::Isometry3d>& bases) {
  RecordedTerms terms;
  for (const Eigen::Isometry3d& base : bases) terms.others.emplace_back().map_from_base = base;
  return terms;
}

TEST(RecordedTerms, ABaseThatAnyOfTheQueriesHasIsKept) {
  const Eigen::Isometry3d first = at(1.0, -2.0, 0.5), second = at(-0.3, 0.4, 0.0);
  const RecordedTerms terms = queries_at({first, second});
  EXPECT_FALSE(terms.base_instead_of(first).has_value());
  EXPECT_FALSE(terms.base_instead_of(second).has_value());
  const Eigen::Isometry3d turned =
      second * Eigen::AngleAxisd(1e-3, Eigen::Vector3d::UnitZ());  // where it stands
  for (const Eigen::Isometry3d& other : {at(1.001, -2.0, 0.5), at(0.3, -0.4, 0.0), turned}) {
    const auto instead = terms.base_instead_of(other);
    ASSERT_TRUE(instead.has_value());
    EXPECT_EQ(instead->matrix(), first.matrix());
  }
  EXPECT_FALSE(queries_at({}).base_instead_of(first).has_value());
}

/// Lengths of other scales say nothing of this one.
TEST(RecordedTerms, OnlyQueriesForTheRobotAtItsScaleBound) {
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(1.0, 0.0);
  QueryTerms query;
  query.name = "another";
  query.start = start, query.goals = {start};
  const auto others = [&](const std::string& robot, double scale) {
    query.robot = robot, query.scale = scale;
    std::vector<std::string> notes;
    return recorded_terms(QueryRecord{"digest", {query}}, {"", "arm", 2, 0.5, start, {goal}}, "digest", notes)
        .others.size();
  };
  EXPECT_EQ(others("arm", 0.5), 1U);
  EXPECT_EQ(others("robots/arm.yaml", 0.5), 1U);
  EXPECT_EQ(others("arm", 1.0), 0U);
  EXPECT_EQ(others("arm", 0.5 + 1e-5), 0U);
  EXPECT_EQ(others("legs", 0.5), 0U);
}

}  // namespace recorded_terms_test
}  // namespace clearway
