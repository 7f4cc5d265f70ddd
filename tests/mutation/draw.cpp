#include "tests/mutation/draw.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "tests/mutation/code_text.hpp"
#include "tests/mutation/entries.hpp"

namespace clearway::mutation {
namespace {

/// Sources without ".cpp", headers with ".hpp"; a star at the end stands for any rest.
constexpr const char* deciding[] = {"mapping/voxels/voxel_state",
                                    "mapping/voxels/fused_node",
                                    "mapping/voxels/fused_tree_update",
                                    "mapping/field/blocked_cells",
                                    "mapping/field/blocked_field",
                                    "mapping/field/blocked_search",
                                    "mapping/scans/scan_rays",
                                    "mapping/scans/safe_scan",
                                    "mapping/scans/surface_gaps",
                                    "mapping/scans/contested_cells",
                                    "mapping/stamps/seen_stamps",
                                    "mapping/stamps/seen_stamps_edit",
                                    "mapping/stamps/seen_tile",
                                    "mapping/voxels/occupancy_update.hpp",
                                    "mapping/voxels/paint_sphere",
                                    "mapping/volumes/union_contains",
                                    "mapping/volumes/painted_body",
                                    "mapping/maps/map_edit",
                                    "mapping/field/distance_axes",
                                    "mapping/field/distance_tiles*",
                                    "mapping/field/distance_transform",
                                    "planning/space/configuration_space",
                                    "planning/space/edge_proof",
                                    "planning/space/body_collision*",
                                    "planning/batch/*",
                                    "planning/gate/gate*",
                                    "planning/robot/self_collision",
                                    "planning/robot_files/allowed_collisions",
                                    "planning/robot/reach",
                                    "planning/robot/kinematics",
                                    "planning/check/*",
                                    "planning/survey/path_poses",
                                    "planning/survey/path_survey",
                                    "planning/survey/swept_voxels",
                                    "planning/space/proximity",
                                    "planning/space/verdict",
                                    "planning/space/part_policies",
                                    "planning/geometry/voxel_distance",
                                    "planning/geometry/gjk",
                                    "planning/geometry/distance",
                                    "planning/geometry/segment_distance",
                                    "planning/constraint/control_constraints",
                                    "tracking/probe",
                                    "tracking/painting_probe",
                                    "tracking/tag_pose",
                                    "tracking/uncertain_pose",
                                    "datasets/poses/pose_columns",
                                    "datasets/poses/pose_stream",
                                    "datasets/poses/tum_poses",
                                    "apps/check/check_contract",
                                    "apps/check/check_deviations",
                                    "apps/check/recorded_terms",
                                    "apps/check/robot_terms",
                                    "apps/results/compare_summary",
                                    "apps/compare/team_result"};

std::string printed(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

/// "planning/gjk.cpp" of "planning/geometry/gjk.cpp": a file that moves keeps its faults.
std::string without_room(const std::filesystem::path& file) {
  return (*file.begin() / file.filename()).string();
}

}  // namespace

std::uint64_t hash_of(const std::string& text, std::uint64_t seed) {
  std::uint64_t hash = 0xcbf29ce484222325U ^ (seed * 0x9e3779b97f4a7c15U);
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  hash = (hash ^ hash >> 33U) * 0xff51afd7ed558ccdU;
  return hash ^ hash >> 33U;
}

std::string read_whole(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> deciding_files(const std::filesystem::path& repository) {
  std::vector<std::string> files;
  for (const std::string entry : deciding) {
    const std::filesystem::path folder = std::filesystem::path(entry).parent_path();
    const bool is_open = entry.ends_with('*'), is_header = entry.ends_with(".hpp");
    const std::string stem = std::filesystem::path(entry.substr(0, entry.size() - is_open)).filename();
    if (is_header) {
      read_whole(repository / entry);  // throws when it is not there
      files.push_back(entry);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& found : std::filesystem::directory_iterator(repository / folder)) {
      const std::string name = found.path().stem();
      if (found.path().extension() == ".cpp" && (is_open ? name.starts_with(stem) : name == stem))
        files.push_back((folder / found.path().filename()).string());
    }
    if (files.size() == before)
      throw std::runtime_error("there is no " + entry +
                               ".cpp: tests/mutation/draw.cpp names files that decide");
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

std::vector<Candidate> drawn(const std::filesystem::path& repository, std::vector<std::string> files,
                             std::uint64_t seed) {
  // A short draw must not take the same files every time.
  std::sort(files.begin(), files.end(), [&](const std::string& a, const std::string& b) {
    return std::pair(hash_of(without_room(a), seed), a) < std::pair(hash_of(without_room(b), seed), b);
  });
  std::vector<std::vector<std::pair<std::uint64_t, Candidate>>> of_files;
  std::size_t most = 0;
  for (const std::string& file : files) {
    const std::string source = read_whole(repository / file);
    std::map<std::string, int> on_line;  // how often the same change was met on the same text
    auto& list = of_files.emplace_back();
    for (Fault& fault : faults_of(source)) {
      Candidate candidate{file, line_number(source, fault.at), line_at(source, fault.at), "", fault};
      const std::string was = printed(source.substr(fault.at, fault.length));
      candidate.change = (was.size() > 60 ? was.substr(0, 60) + "…" : was) + " -> " + printed(fault.is);
      const std::string what =
          without_room(file) + "\n" + candidate.text + "\n" + fault.kind + "\n" + candidate.change;
      const int number = ++on_line[what];
      if (number > 1) candidate.change += " (" + std::to_string(number) + ")";
      list.emplace_back(hash_of(what + std::to_string(number), seed), std::move(candidate));
    }
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    most = std::max(most, list.size());
  }
  std::vector<Candidate> order;
  for (std::size_t i = 0; i < most; ++i) {
    for (auto& list : of_files)
      if (i < list.size()) order.push_back(std::move(list[i].second));
  }
  return order;
}

std::vector<Candidate> named(const std::filesystem::path& repository, const std::filesystem::path& list) {
  std::vector<Candidate> candidates;
  for (const auto& entry : read_entries(list, {"file", "line", "fault"})) {
    const std::string &file = entry.at("file"), &text = entry.at("line"),
                      source = read_whole(repository / file);
    const std::size_t at = source.find(text);
    if (at == std::string::npos || source.find(text, at + 1) != std::string::npos)
      throw std::runtime_error(list.string() + ": expected once in " + file + ": " + text);
    candidates.push_back({file,
                          line_number(source, at),
                          text,
                          text + " -> " + entry.at("fault"),
                          {"named", at, text.size(), entry.at("fault")}});
  }
  return candidates;
}

}  // namespace clearway::mutation
