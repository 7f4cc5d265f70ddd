#include "planning/files/query_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapping/files/map_file.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace query_record_test {

/// A folder that a record is written to and read from.
class QueryRecordFile : public ::testing::Test {
 protected:
  std::optional<QueryRecord> read(const std::string& text) const {
    folder_.write("queries.json", text);
    return load_query_record(folder_.path());
  }

  TemporaryFolder folder_;
};

QueryRecord example() {
  Random random(8);
  QueryRecord record{std::string(64, 'a'), {}};
  for (const char* name : {"over", "under"}) {
    QueryTerms query;
    query.name = name;
    query.robot = "folder/caf\xc3\xa9.urdf";
    query.scale = 1.0 / 3.0;
    query.map_from_base = random.pose(2.0);
    query.policies = {{"tool", Policy::painted}, {"base", Policy::not_occupied}};
    query.padding = 0.0005;
    query.start = random.point(3.0);
    query.goals = {random.point(3.0), random.point(3.0)};
    query.payload = 0.7;
    query.gravity = random.point(9.0);
    query.joints = {"x", "y", "z"};
    record.queries.push_back(query);
  }
  return record;
}

TEST_F(QueryRecordFile, ReadsBackEveryBit) {
  const QueryRecord record = example();
  const auto back = read(to_json(record));
  ASSERT_TRUE(back);
  EXPECT_EQ(to_json(*back), to_json(record));
  EXPECT_EQ(back->queries[1].map_from_base.matrix(), record.queries[1].map_from_base.matrix());
  EXPECT_EQ(back->queries[1].goals, record.queries[1].goals);
  EXPECT_EQ(back->queries[0].policies, record.queries[0].policies);
  EXPECT_EQ(back->queries[1].payload, record.queries[1].payload);
  EXPECT_EQ(back->queries[1].gravity, record.queries[1].gravity);
  EXPECT_EQ(back->queries[1].joints, record.queries[1].joints);
}

TEST_F(QueryRecordFile, AnOlderOneSaysNothingOfPayloadGravityAndJoints) {
  QueryRecord record = example();
  record.queries[0].joints.pop_back();
  EXPECT_THROW(read(to_json(record)), std::invalid_argument);
  for (QueryTerms& query : record.queries) query.payload = {}, query.gravity = {}, query.joints = {};
  const auto back = read(to_json(record));
  ASSERT_TRUE(back);
  EXPECT_FALSE(back->queries[0].payload);
  EXPECT_FALSE(back->queries[0].gravity);
  EXPECT_TRUE(back->queries[0].joints.empty());
  record.queries[1].payload = -1.0;
  EXPECT_THROW(read(to_json(record)), std::invalid_argument);
}

TEST_F(QueryRecordFile, AnyByteThatIsAnotherIsDamage) {
  const std::string whole = to_json(example());
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    std::string text = whole;
    text[static_cast<std::size_t>(random.below(static_cast<int>(text.size())))] ^=
        static_cast<char>(1 + random.below(255));
    EXPECT_THROW(read(text), DamagedFile) << text;
    EXPECT_THROW(
        read(whole.substr(0, static_cast<std::size_t>(random.below(static_cast<int>(whole.size()) - 2)))),
        DamagedFile);
  }
  EXPECT_THROW(read(std::string(1U << 20, '[')), DamagedFile);
}

TEST_F(QueryRecordFile, NoRecordIsNone) {
  EXPECT_FALSE(load_query_record(folder_.path()));
  EXPECT_FALSE(load_query_record(folder_ / "map.bt"));
}

TEST_F(QueryRecordFile, ALinkThatLeadsNowhereIsRefused) {
  std::filesystem::create_symlink("/nowhere", folder_ / "queries.json");
  EXPECT_THROW(load_query_record(folder_.path()), std::invalid_argument);
}

TEST(QueryRecord, IsSearchedByNameThenByStartAndGoals) {
  const QueryRecord record = example();
  const QueryTerms &over = record.queries[0], &under = record.queries[1];
  EXPECT_EQ(record.find("under", over.start, over.goals, 1e-6), &under);
  EXPECT_EQ(record.find("", over.start, over.goals, 1e-6), &over);
  EXPECT_EQ(record.find("no such", under.start, under.goals, 1e-6), &under);
  Configuration near = over.start;
  near[1] += 9e-7;
  EXPECT_EQ(record.find("", near, over.goals, 1e-6), &over);
  near[1] += 9e-7;
  EXPECT_EQ(record.find("", near, over.goals, 1e-6), nullptr);
  EXPECT_EQ(record.find("", over.start, {over.goals[0]}, 1e-6), nullptr);
  EXPECT_EQ(record.find("", over.start, {over.goals[1], over.goals[0]}, 1e-6), nullptr);
}

TEST(QueryRecord, IsSearchedForTheQueryOfWhichAPlanIsAPart) {
  const QueryRecord record = example();
  const QueryTerms& under = record.queries[1];
  EXPECT_EQ(record.find_whole(under.start, {under.goals[1]}, 1e-6), &under);
  EXPECT_EQ(record.find_whole(under.goals[0], {under.goals[1]}, 1e-6), &under);
  EXPECT_EQ(record.find_whole(under.start, {}, 1e-6), &under);
  EXPECT_EQ(record.find_whole(under.start, {under.goals[1], under.goals[0]}, 1e-6), nullptr);
  EXPECT_EQ(record.find_whole(under.goals[1], {under.goals[0]}, 1e-6), nullptr);
  EXPECT_EQ(record.find_whole(under.start, {record.queries[0].goals[0]}, 1e-6), nullptr);
}

TEST(QueryRecord, ConfigurationsOfOtherSizesOrWithNaNAreInfinitelyFarApart) {
  EXPECT_EQ(largest_difference(Eigen::Vector2d(1, 2), Eigen::Vector2d(1, 2.5)), 0.5);
  EXPECT_EQ(largest_difference(Eigen::Vector2d(1, 2), Eigen::Vector3d(1, 2, 3)),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(largest_difference(Eigen::Vector2d(1, NAN), Eigen::Vector2d(1, NAN)),
            std::numeric_limits<double>::infinity());
}

}  // namespace query_record_test
}  // namespace clearway
