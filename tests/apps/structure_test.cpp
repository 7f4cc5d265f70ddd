// The floors of the design page, held: who may include whom, and which headers stay light.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace structure_test {

namespace fs = std::filesystem;

const std::map<std::string, std::set<std::string>> allowed = {
    {"mapping", {"mapping"}},
    {"planning", {"planning", "mapping"}},
    {"tracking", {"tracking"}},
    {"datasets", {"datasets", "mapping/system"}},
    {"apps", {"apps", "planning", "mapping", "tracking", "datasets"}},
};

void for_each_include(const std::string& floor,
                      const std::function<void(const fs::path&, const std::string&, bool quoted)>& visit) {
  const std::regex include(R"rx(^\s*#\s*include\s*([<"])([^>"]+)[>"])rx");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(CLEARWAY_SOURCE_DIR) / floor)) {
    const auto extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (std::regex_search(line, match, include)) visit(entry.path(), match[2], match[1] == "\"");
    }
  }
}

TEST(Structure, floors_include_only_the_floors_below_them) {
  int includes = 0;
  for (const auto& [floor, may] : allowed) {
    for_each_include(floor, [&](const fs::path& file, const std::string& name, bool quoted) {
      if (!quoted) return;
      ++includes;
      const std::string folder = name.substr(0, name.rfind('/'));
      EXPECT_TRUE(may.count(name.substr(0, name.find('/'))) || may.count(folder))
          << file << " includes " << name;
    });
  }
  EXPECT_GT(includes, 50);
}

/// Rooms are the folders of a floor, and what lies at its top is one more. Together they form no circle.
TEST(Structure, rooms_include_each_other_in_no_circle) {
  std::map<std::string, std::set<std::string>> rooms;
  for (const auto& [floor, may] : allowed) {
    for_each_include(floor, [&](const fs::path& file, const std::string& name, bool quoted) {
      const std::string room = fs::relative(file, CLEARWAY_SOURCE_DIR).parent_path();
      const std::string other = fs::path(name).parent_path();
      if (quoted && room != other && other.find('/') != std::string::npos) rooms[room].insert(other);
      if (quoted && room != other && allowed.count(other) != 0) rooms[room].insert(other);
    });
  }
  EXPECT_GT(rooms.size(), 30U);
  // What includes nothing that is left goes, until nothing goes any more.
  for (bool gone = true; gone;) {
    gone = false;
    for (auto room = rooms.begin(); room != rooms.end();) {
      std::erase_if(room->second, [&](const std::string& other) { return !rooms.contains(other); });
      const bool is_free = room->second.empty();
      gone = gone || is_free;
      room = is_free ? rooms.erase(room) : std::next(room);
    }
  }
  for (const auto& [room, others] : rooms) {
    for (const std::string& other : others) ADD_FAILURE() << room << " includes " << other << ", in a circle";
  }
}

TEST(Structure, no_folder_is_a_hall) {
  std::map<std::string, int> files;
  for (const auto& [floor, may] : allowed) {
    for (const std::string& top : {floor, "tests/" + floor}) {
      for (const auto& entry : fs::recursive_directory_iterator(fs::path(CLEARWAY_SOURCE_DIR) / top)) {
        const auto extension = entry.path().extension();
        if (extension == ".hpp" || extension == ".cpp") ++files[entry.path().parent_path()];
      }
    }
  }
  EXPECT_GT(files.size(), 60U);
  for (const auto& [folder, count] : files) EXPECT_LE(count, 36) << folder;
}

/// A new kind of shape is one file there, and the check's own reading of it.
TEST(Structure, kinds_of_shapes_are_known_to_geometry_and_once_to_the_check) {
  std::set<std::string> known;
  for (const auto& [floor, may] : allowed) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(CLEARWAY_SOURCE_DIR) / floor)) {
      const auto extension = entry.path().extension();
      if (extension != ".hpp" && extension != ".cpp") continue;
      std::ifstream file(entry.path());
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      if (text.find("Shape::Kind::") == std::string::npos) continue;
      const std::string name = fs::relative(entry.path(), CLEARWAY_SOURCE_DIR);
      if (!name.starts_with("planning/geometry/")) known.insert(name);
    }
  }
  EXPECT_EQ(known, (std::set<std::string>{"planning/check/path_check_shape.cpp"}));
}

/// The one room of mapping that datasets may use: it must not lead it to the rest of mapping.
TEST(Structure, system_includes_nothing_else_of_ours) {
  for_each_include("mapping/system", [&](const fs::path& file, const std::string& name, bool quoted) {
    EXPECT_TRUE(!quoted || name.starts_with("mapping/system/")) << file << " includes " << name;
  });
}

TEST(Structure, headers_include_nothing_heavier_than_eigen) {
  const std::regex heavy(R"(^(pcl|mrpt|ompl|fcl|nlohmann|CLI|yaml-cpp|assimp|kdl|urdf_|boost|apriltag)\b.*)");
  for (const auto& [floor, may] : allowed) {
    for_each_include(floor, [&](const fs::path& file, const std::string& name, bool quoted) {
      if (quoted || file.extension() != ".hpp") return;
      if (name == "nlohmann/json_fwd.hpp" && (floor == "apps" || floor == "planning")) return;  // names alone
      if (file.string().find("/apps/bench/") != std::string::npos) return;  // a program, no floor
      EXPECT_FALSE(std::regex_match(name, heavy)) << file << " includes " << name;
      const bool opencv = name.rfind("opencv2/", 0) == 0;
      EXPECT_TRUE(!opencv || ((floor == "tracking" || floor == "apps") && name.starts_with("opencv2/core")))
          << file << " includes " << name;
      const bool octomap = name.rfind("octomap/", 0) == 0;
      const bool store = file.filename() == "fused_tree.hpp" || file.filename() == "fused_node.hpp";
      EXPECT_TRUE(!octomap || store) << file << " includes " << name;
    });
  }
}

}  // namespace structure_test
