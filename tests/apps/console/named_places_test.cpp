// That no command writes over what it reads, whatever link leads there.
#include "apps/console/named_places.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace named_places_test {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

class NamedPlaces : public ::testing::Test {
 protected:
  void SetUp() override {
    map_ = folder_.file("own");
    save_map(FreeSpaceMap({.resolution = 0.1}).snapshot(), map_);
    file_ = folder_.write("file.txt", "read");
  }

  std::string refusal(const fs::path& output, const fs::path& input) const {
    try {
      require_apart({{"--out", output}}, {{"--in", input}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  static bool would_be_refused(const fs::path& output, const std::vector<NamedPlace>& inputs) {
    try {
      require_apart({{"--out", output}}, inputs);
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  }

  TemporaryFolder folder_;
  std::string map_, file_;
};

TEST_F(NamedPlaces, AnInputIsKnownByEveryName) {
  fs::create_symlink("file.txt", folder_ / "link");
  fs::create_symlink(folder_.path(), folder_ / "round");
  fs::create_hard_link(file_, folder_ / "hard");
  for (const char* name : {"file.txt", "link", "round/file.txt", "hard", "own/../file.txt"}) {
    EXPECT_EQ(refusal(folder_ / name, file_).rfind("--out: '", 0), 0U) << name;
    EXPECT_NE(refusal(file_, folder_ / name).find("is read by --in"), std::string::npos) << name;
  }
  EXPECT_EQ(refusal(folder_ / "new.txt", file_), "");
  EXPECT_EQ(refusal(file_, "puma560"), "");
  EXPECT_EQ(refusal("", file_), "");
  EXPECT_EQ(refusal("", ""), "");
}

TEST_F(NamedPlaces, NoFolderOfAMapIsAnOutputWhereItsPaintIsRead) {
  EXPECT_NE(refusal(map_, map_ + "/painted.csv").find("is read by --in"), std::string::npos);
  EXPECT_EQ(refusal(folder_ / "other", map_ + "/painted.csv"), "");
}

TEST_F(NamedPlaces, DescriptionSettingsAndGroupsOfARobotBelongToIt) {
  for (const char* name : {"arm.urdf", "arm.yaml", "arm.srdf", "arm.csv"}) folder_.write(name, "read");
  for (const char* named : {"arm.urdf", "arm.yaml"})
    for (const char* written : {"arm.urdf", "arm.yaml", "arm.srdf", "arm.csv"})
      EXPECT_EQ(would_be_refused(folder_ / written, places_of_robot("--robot", folder_ / named)),
                std::string(written) != "arm.csv")
          << named << " " << written;
  EXPECT_TRUE(places_of_robot("--robot", "puma560").empty());
}

TEST_F(NamedPlaces, NoFileInTheFolderOfARecordingIsAnOutput) {
  fs::create_directories(folder_ / "source/rgb");
  folder_.write("source/rgb/0001.png", "picture");
  fs::create_symlink(folder_ / "source/rgb", folder_ / "link");
  const auto refusal = [&](const fs::path& output, const fs::path& source) -> std::string {
    try {
      require_not_in({{"--csv", output}}, {"SOURCE", source});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  for (const char* name : {"source/rgb/0001.png", "link/0001.png", "own/../source/rgb/0001.png"})
    EXPECT_NE(refusal(folder_ / name, folder_ / "source").find("is a file of the folder that SOURCE reads"),
              std::string::npos)
        << name;
  EXPECT_EQ(refusal(folder_ / "source/new.csv", folder_ / "source"), "");
  EXPECT_EQ(refusal(file_, folder_ / "source"), "");
  EXPECT_EQ(refusal(file_, file_), "");
  EXPECT_EQ(refusal("", folder_ / "source"), "");
  EXPECT_EQ(refusal(file_, "no such folder"), "");
}

TEST_F(NamedPlaces, AMapIsItsFolderAndWhatIsReadWithIt) {
  folder_.write("own/queries.json", "{}");
  folder_.write("own/plan.json", "{}");
  const fs::path own = map_;
  for (const fs::path& map : {own, own / "map.ot"}) {
    for (const char* name : {"", "map.ot", "painted.csv", "queries.json"})
      EXPECT_NE(refusal(name[0] == '\0' ? own : own / name, map), "") << map << ", " << name;
    EXPECT_EQ(refusal(own / "plan.json", map), "") << map;  // nobody reads it, it may be written anew
  }
}

/// Each command ends before it reads or writes anything else.
TEST_F(NamedPlaces, NoCommandOverwritesWhatItReads) {
  const std::string tree = map_ + "/map.ot", before = read_file(tree);
  const std::string other = folder_.file("other");
  save_map(FreeSpaceMap({.resolution = 0.1}).snapshot(), other);
  const std::string suite = folder_.write(
      "s.yaml",
      "worlds: [{name: w, map: own}]\nplanners: [{planner: rrtconnect}]\nexperiments:\n"
      "  - {name: e, robot: point, problems: [{name: p, world: w, start: [0, 0], goals: [[1, 0]]}]}\n");
  const std::string load = folder_.write("rod.yaml", "{name: rod, box: [0.1, 0.1, 0.1], link: base}");
  const std::string film = folder_.write("film.mp4", "read"), bag = folder_.write("bag.mcap", "read");
  const Arguments plan{"plan", "--map", map_, "--robot", "point", "--start", "0,0", "--goal", "1,0"};
  const auto with = [](Arguments command, const Arguments& more) {
    command.insert(command.end(), more.begin(), more.end());
    return command;
  };
  for (const Arguments& command : {with(plan, {"--out", tree}),
                                   with(plan, {"--csv", tree}),
                                   with(plan, {"--view", map_ + "/painted.csv"}),
                                   with(plan, {"--trajectory", "ros", tree}),
                                   with(plan, {"--attach", load, "--csv", load}),
                                   Arguments{"inspect", map_, "--export", tree},
                                   {"inspect", tree, "--export", tree},
                                   {"inspect", map_, "--slice", "z=0.3", tree},
                                   {"inspect", map_, "--view", tree},
                                   {"inspect", map_, "--diff", other, "--view", other + "/map.ot"},
                                   {"inspect", map_, "--coarsen", "0.2", "--save", map_},
                                   {"compare", suite, "--out", map_},
                                   {"compare", "merge", map_, "--out", map_},
                                   {"track", file_, "--csv", file_},
                                   {"track", map_, "--draw", map_},
                                   {"replay", film, "--out", other, "--video-out", film},
                                   {"replay", bag, "--out", other, "--record", bag},
                                   {"replay", map_, "--out", other, "--overlay", map_}}) {
    const CommandRun run = run_command(command);
    std::string line;
    for (const std::string& word : command) line += word + " ";
    EXPECT_EQ(run.status, exit_bad_input) << line << run.out;
    EXPECT_TRUE(run.complains_in_one_sentence()) << line << run.log;
    EXPECT_NE(run.log.find("is read by "), std::string::npos) << line << run.log;
  }
  EXPECT_EQ(read_file(tree), before);
  EXPECT_EQ(read_file(file_), "read");
}

}  // namespace named_places_test
}  // namespace clearway
