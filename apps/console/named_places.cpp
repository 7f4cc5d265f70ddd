#include "apps/console/named_places.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// Read with the folder of a map or of a session.
constexpr std::array read_with_folder = {"map.ot",       "painted.csv",  "provenance.bin", "seen.bin",
                                         "queries.json", "session.json", "setup.yaml",     "events.jsonl"};

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error);
}

bool is_read_with(const fs::path& folder, const fs::path& output) {
  return std::any_of(read_with_folder.begin(), read_with_folder.end(),
                     [&](const char* name) { return is_same(folder / name, output); });
}

/// The folder whose files are read: of a map.ot the one that it lies in.
fs::path folder_of_input(const fs::path& input) {
  std::error_code error;
  if (fs::is_directory(input, error)) return input;
  if (input.filename() != "map.ot") return {};
  return input.has_parent_path() ? input.parent_path() : fs::path(".");
}

bool would_overwrite(const fs::path& output, const fs::path& input) {
  if (output.empty() || input.empty()) return false;
  const fs::path folder = folder_of_input(input);
  return is_same(output, input) || is_same(output / "map.ot", input) ||
         is_same(output / "painted.csv", input) ||
         (!folder.empty() && (is_same(output, folder) || is_read_with(folder, output)));
}

}  // namespace

void require_apart(const std::vector<NamedPlace>& outputs, const std::vector<NamedPlace>& inputs) {
  for (const NamedPlace& output : outputs) {
    for (const NamedPlace& input : inputs) {
      if (!would_overwrite(output.path, input.path)) continue;
      throw std::invalid_argument(output.flag + ": " + quote_path(output.path.string()) + " is read by " +
                                  input.flag + ", expected another place to write to");
    }
  }
}

std::vector<NamedPlace> places_of_robot(const std::string& flag, const fs::path& robot) {
  if (!robot.has_extension()) return {};
  std::vector<NamedPlace> places{{flag, robot}};
  for (const char* extension : {".urdf", ".yaml", ".srdf"})
    places.push_back({flag, fs::path(robot).replace_extension(extension)});
  return places;
}

void require_not_in(const std::vector<NamedPlace>& outputs, const NamedPlace& folder) {
  std::error_code error;
  if (!fs::is_directory(folder.path, error)) return;
  const fs::path whole = fs::canonical(folder.path, error);
  for (const NamedPlace& output : outputs) {
    if (output.path.empty() || !fs::is_regular_file(output.path, error)) continue;
    const fs::path inner = fs::canonical(output.path, error).lexically_relative(whole);
    if (inner.empty() || *inner.begin() == "..") continue;
    throw std::invalid_argument(output.flag + ": " + quote_path(output.path.string()) +
                                " is a file of the folder that " + folder.flag +
                                " reads, expected another place to write to");
  }
}

}  // namespace clearway
