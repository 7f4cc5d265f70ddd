// `inspect` with pictures of a map and of what differs between two.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/console/parse.hpp"
#include "apps/inspect/slice_states.hpp"
#include "mapping/files/map_file.hpp"
#include "tests/apps/page_reader.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace inspect_pictures_test {

class InspectPictures : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("NO_COLOR", "1", 1);
    save_map(a_, folder_ / "a");
    save_map(b_, folder_ / "b");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string bytes(const std::string& name) const { return read_file(folder_ / name); }

  const TemporaryFolder folder_;
  const Snapshot a_ = worlds::random_map(31).snapshot(), b_ = worlds::random_map(32).snapshot();
};

bool blocks(VoxelState state) { return state == VoxelState::occupied || state == VoxelState::conflict; }

/// Voxel by voxel over the box of both, from the states.
std::map<VoxelState, std::size_t> expected_difference(const Snapshot& a, const Snapshot& b) {
  std::map<VoxelState, std::size_t> counts;
  Eigen::AlignedBox3d box = a.bounds();
  box.extend(b.bounds());
  const double edge = a.resolution();
  const Eigen::Vector3i size = (box.sizes() / edge).array().round().cast<int>();
  for (int x = 0; x < size.x(); ++x)
    for (int y = 0; y < size.y(); ++y)
      for (int z = 0; z < size.z(); ++z) {
        const Eigen::Vector3d point = box.min() + edge * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
        const VoxelState here = a.state(point), there = b.state(point);
        if (blocks(here) && blocks(there))
          ++counts[VoxelState::occupied];
        else if (blocks(there))
          ++counts[VoxelState::conflict];
        else if (blocks(here))
          ++counts[VoxelState::painted];
        else if (here != there)
          ++counts[VoxelState::seen_free];
      }
  return counts;
}

TEST_F(InspectPictures, TheDifferenceOfTwoMapsIsThatOfTheirVoxels) {
  auto expected = expected_difference(a_, b_);
  const VoxelCounts counts = MapLeaves::difference(a_, b_).counts();
  EXPECT_EQ(counts.occupied, expected[VoxelState::occupied]);
  EXPECT_EQ(counts.conflict, expected[VoxelState::conflict]);
  EXPECT_EQ(counts.painted, expected[VoxelState::painted]);
  EXPECT_EQ(counts.seen_free, expected[VoxelState::seen_free]);
  EXPECT_GT(counts.conflict, 100U);
  EXPECT_GT(counts.painted, 100U);
  EXPECT_THROW(MapLeaves::difference(a_, worlds::random_map(1, 0.1).snapshot()), std::invalid_argument);
}

TEST_F(InspectPictures, OfTwoMapsShowWhatDiffers) {
  const CommandRun run = run_command({"inspect", path("a"), "--diff", path("b"), "--view", path("diff.html"),
                                      "--slice", "z=0.1", path("diff.png")});
  EXPECT_EQ(run.status, exit_no) << run.log;
  const PageReader reader(bytes("diff.html"));
  EXPECT_EQ(reader.page["title"], "from a to b");
  auto expected = expected_difference(a_, b_);
  for (const auto& set : reader.page["voxels"]) {
    if (set["state"] == "conflict") {
      EXPECT_EQ(set["count"], expected[VoxelState::conflict]);
    }
    if (set["state"] == "painted") {
      EXPECT_EQ(set["count"], expected[VoxelState::painted]);
    }
  }
  EXPECT_EQ(reader.page["stateLabels"].size(), 4U);
  EXPECT_TRUE(bytes("diff.png").starts_with("\x89PNG"));
  ASSERT_EQ(run_command({"inspect", path("a"), "--slice", "z=0.1", path("a.png")}).status, exit_done);
  EXPECT_NE(bytes("diff.png"), bytes("a.png"));
}

TEST_F(InspectPictures, InTheTerminalAreTheStatesOfThePlane) {
  const CommandRun run = run_command({"inspect", path("a"), "--term", "z=0.125"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const MapLeaves map(a_);
  const SlicePlane plane{2, 0.125};
  const SliceFrame frame = slice_frame(map, plane);
  const std::string drawn = slice_text(map, plane, frame.columns, false);
  // A line stands for two rows of voxels: what blocks is seen where either does, free where both are.
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < drawn.size(); at = drawn.find('\n', at) + 1)
    lines.push_back(drawn.substr(at, drawn.find('\n', at) - at));
  const std::map<char, VoxelState> letters{{'X', VoxelState::conflict},
                                           {'#', VoxelState::occupied},
                                           {'+', VoxelState::painted},
                                           {'.', VoxelState::seen_free},
                                           {' ', VoxelState::unknown}};
  const int height = static_cast<int>(lines.size());
  ASSERT_GE(height, frame.rows / 2);
  std::size_t occupied = 0;
  for (int line = 0; line + 1 < height; ++line)
    for (int column = 0; column < frame.columns; ++column) {
      const std::string& text = lines[static_cast<std::size_t>(height - 1 - line)];
      const char letter =
          static_cast<std::size_t>(column) < text.size() ? text[static_cast<std::size_t>(column)] : ' ';
      std::size_t most = slice_states.size() - 1, least = 0;
      for (const int row : {2 * line, 2 * line + 1}) {
        const Eigen::Vector3d point((frame.low.x() + column + 0.5) * map.resolution(),
                                    (frame.low.y() + row + 0.5) * map.resolution(), plane.value);
        const auto found = std::find(slice_states.begin(), slice_states.end(), a_.state(point));
        most = std::min(most, static_cast<std::size_t>(found - slice_states.begin()));
        least = std::max(least, static_cast<std::size_t>(found - slice_states.begin()));
      }
      if (most > 1) most = least;
      EXPECT_EQ(letters.at(letter), slice_states[most]) << line << ' ' << column;
      occupied += letter == '#';
    }
  EXPECT_GT(occupied, 5U);
  EXPECT_NE(run.out.find('#'), std::string::npos);
  EXPECT_NE(slice_text(map, plane, 80, true).find("\033[38;2;"), std::string::npos);
  EXPECT_TRUE(run.out.ends_with("X conflict  # occupied  + painted  . seen free  blank unknown\n"))
      << run.out;
  EXPECT_NE(run.out.find("\nz = 0.125 m; to the right x, "), std::string::npos) << run.out;
  const Eigen::AlignedBox3d bounds = map.bounds();
  EXPECT_EQ(slice_caption(map, {0, 0.05}), "x = 0.05 m; to the right y, " + significant(bounds.min().y()) +
                                               " to " + significant(bounds.max().y()) + " m; upwards z, " +
                                               significant(bounds.min().z()) + " to " +
                                               significant(bounds.max().z()) + " m\n");
  const std::string colours = slice_legend(true, false);
  EXPECT_NE(colours.find("\033[38;2;150;138;126m\u2588\u2588\033[0m occupied"), std::string::npos) << colours;
  const std::string changes = slice_legend(false, true);
  EXPECT_NE(changes.find("X " + difference_label(VoxelState::conflict)), std::string::npos) << changes;
}

TEST_F(InspectPictures, RefuseWhatDoesNotGoTogether) {
  for (const std::vector<std::string>& flags : std::vector<std::vector<std::string>>{
           {"--term", "z=0", "--json"},
           {"--term", "q=0"},
           {"--term", "z=99"},
           {"--diff", path("b"), "--slice", "z=0", path("s.png"), "--clearance", "painted"},
           {"--diff", path("b"), "--slice", "z=0", path("s.png"), "--age"}}) {
    std::vector<std::string> arguments{"inspect", path("a")};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  }
}

TEST_F(InspectPictures, AFarReturnIsLeftOutAndToldOfUnlessTheWholeOrABoxIsAskedFor) {
  ASSERT_EQ(run_command({"inspect", path("a"), "--occupy", "box:0,0,0,4,4,0.5", "--occupy",
                         "sphere:40.025,0.025,0.125,0.001", "--save", path("far")})
                .status,
            exit_done);
  const auto inspect = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"inspect", path("far"), "--term", "z=0.125", "--slice", "z=0.125",
                                 path("far.png"), "--view", path("far.html")});
    return run_command(flags);
  };
  const auto first_look = [&] { return PageReader(bytes("far.html")).page.at("firstLook"); };
  const std::string told = "1 voxel (1 occupied) lies outside; --whole shows it";
  const CommandRun part = inspect({});
  EXPECT_NE(part.out.find(told), std::string::npos) << part.out;
  EXPECT_NE(part.log.find("far.png: " + told), std::string::npos) << part.log;
  ASSERT_FALSE(first_look().is_null());
  EXPECT_LT(first_look()[1][0].get<double>(), 5.0);
  EXPECT_EQ(PageReader(bytes("far.html")).page.at("occupiedBeyond"), 1);
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"--whole"},
        std::vector<std::string>{"--crop=-9,-9,-9,50,9,9", "--save", path("cropped")}}) {
    const CommandRun whole = inspect(flags);
    EXPECT_EQ(whole.status, exit_done) << whole.log;
    EXPECT_EQ((whole.out + whole.log).find("outside"), std::string::npos) << whole.out;
    EXPECT_TRUE(first_look().is_null());
  }
  EXPECT_EQ(
      run_command({"inspect", path("a"), "--diff", path("far"), "--term", "z=0.125"}).out.find("outside"),
      std::string::npos);
  const CommandRun refused = run_command({"inspect", path("far"), "--whole"});
  EXPECT_EQ(refused.status, exit_bad_input);
  EXPECT_NE(refused.log.find("--whole: expected --slice, --term or --view beside it"), std::string::npos);
}

}  // namespace inspect_pictures_test
}  // namespace clearway
