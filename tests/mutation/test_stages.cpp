#include "tests/mutation/test_stages.hpp"

#include <map>
#include <mutex>
#include <regex>
#include <set>

#include "tests/mutation/draw.hpp"

namespace clearway::mutation {
namespace {

namespace fs = std::filesystem;

/// Files are read once.
struct TestFile {
  std::string text;
  std::set<std::string> suites;
  bool draws_cases = false;  ///< it asks how often it shall draw
};

const TestFile& read_once(const fs::path& file) {
  static std::map<fs::path, TestFile> known;
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const auto [it, is_new] = known.try_emplace(file);
  TestFile& read = it->second;
  if (!is_new) return read;
  static const std::regex test("(^|\n)(TYPED_)?TEST(_F|_P)?\\(([A-Za-z0-9_]+)"),
      call("[^A-Za-z0-9_]trials\\(");
  read.text = read_whole(file);
  if (!file.filename().string().ends_with("_test.cpp")) return read;
  for (std::sregex_iterator found(read.text.begin(), read.text.end(), test), end; found != end; ++found)
    read.suites.insert((*found)[4]);
  read.draws_cases = std::regex_search(read.text, call);
  return read;
}

/// The tests of these files, as gtest's filter names them.
std::string filter_of(const std::set<fs::path>& files) {
  std::set<std::string> suites;
  for (const fs::path& file : files)
    suites.insert(read_once(file).suites.begin(), read_once(file).suites.end());
  std::string filter;
  for (const std::string& suite : suites)
    filter += (filter.empty() ? "" : ":") + suite + ".*:*/" + suite + ".*:" + suite + "/*";
  return filter;
}

bool is_test_file(const fs::path& file) {
  const std::string name = file.filename();
  return name.ends_with("_test.cpp") && !name.ends_with("_job_test.cpp");
}

/// The files below a folder that include the source's header.
std::set<fs::path> including(const fs::path& folder, const fs::path& source) {
  const std::string include = "#include \"" + fs::path(source).replace_extension(".hpp").string() + "\"";
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (const std::string kind = entry.path().extension();
        (kind == ".cpp" || kind == ".hpp") && read_once(entry.path()).text.find(include) != std::string::npos)
      files.insert(entry.path());
  return files;
}

/// The test file of the same name, or of the longest beginning of it, and those that include the header.
std::set<fs::path> tests_of(const fs::path& repository, const fs::path& source) {
  const fs::path tests = repository / "tests" / source.parent_path();
  std::set<fs::path> files = including(repository / "tests" / *source.begin(), source);
  std::erase_if(files, [](const fs::path& file) { return !is_test_file(file); });
  for (std::string stem = source.stem();; stem.resize(stem.rfind('_'))) {
    if (const fs::path mirrored = tests / (stem + "_test.cpp"); fs::exists(mirrored)) {
      files.insert(mirrored);
      break;
    }
    if (stem.find('_') == std::string::npos) break;
  }
  return files;
}

/// The tests of a source; of one that no test knows by name those of the sources that include its header.
std::set<fs::path> nearest_tests(const fs::path& repository, const fs::path& source) {
  std::set<fs::path> files = tests_of(repository, source);
  if (!files.empty()) return files;
  for (const fs::path& user : including(repository / *source.begin(), source))
    files.merge(tests_of(repository, user.lexically_relative(repository)));
  return files;
}

}  // namespace

std::vector<Stage> stages_for(const fs::path& repository, const fs::path& source) {
  const std::set<fs::path> nearest = nearest_tests(repository, source);
  const fs::path floor = repository / "tests" / *source.begin();
  std::set<fs::path> room, drawing;  // the others of the mirrored folder
  for (const auto& entry : fs::directory_iterator(repository / "tests" / source.parent_path()))
    if (is_test_file(entry.path()) && !nearest.contains(entry.path())) room.insert(entry.path());
  const bool is_of_apps = *source.begin() == "apps";
  for (const auto& entry : fs::recursive_directory_iterator(floor)) {
    const bool is_run = !is_of_apps || nearest.contains(entry.path()) || room.contains(entry.path());
    if (is_run && is_test_file(entry.path()) && read_once(entry.path()).draws_cases)
      drawing.insert(entry.path());
  }
  const std::string near = filter_of(nearest), beside = filter_of(room), drawn = filter_of(drawing);
  std::string known = near;
  std::vector<Stage> stages;
  if (!near.empty()) stages.push_back({"nearest", near});
  if (!beside.empty()) {
    stages.push_back({"folder", near.empty() ? beside : beside + "-" + near});
    known += (near.empty() ? "" : ":") + beside;
  }
  if (!is_of_apps || known.empty()) stages.push_back({"floor", known.empty() ? "*" : "-" + known});
  if (!drawn.empty()) stages.push_back({"drawn cases", drawn, Trials::many});
  return stages;
}

}  // namespace clearway::mutation
