#include "tests/mutation/test_program.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <stdexcept>

namespace clearway::mutation {
namespace {

namespace fs = std::filesystem;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) throw std::runtime_error("expected '" + what + "' in: " + text.substr(0, 400));
  return text.replace(at, what.size(), by);
}

std::string quoted_include(const fs::path& path) { return "#include \"" + path.string() + "\""; }

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// The tests of these files, as gtest's filter names them.
std::string filter_of(const std::set<fs::path>& files) {
  std::set<std::string> suites;
  static const std::regex test("(^|\n)(TYPED_)?TEST(_F|_P)?\\(([A-Za-z0-9_]+)");
  for (const fs::path& file : files) {
    const std::string text = read_whole(file);
    for (std::sregex_iterator it(text.begin(), text.end(), test), end; it != end; ++it)
      suites.insert((*it)[4]);
  }
  std::string filter;
  for (const std::string& suite : suites)
    filter += (filter.empty() ? "" : ":") + suite + ".*:*/" + suite + ".*:" + suite + "/*";
  return filter;
}

bool is_test_file(const fs::path& file) {
  const std::string name = file.filename();
  return name.ends_with("_test.cpp") && !name.ends_with("_job_test.cpp");
}

/// The test file of the same name, or of the longest beginning of it, and those that include the header.
std::set<fs::path> tests_of(const fs::path& repository, const fs::path& source) {
  const fs::path floor = repository / "tests" / *source.begin(),
                 tests = repository / "tests" / source.parent_path();
  std::set<fs::path> files;
  for (std::string stem = source.stem();; stem.resize(stem.rfind('_'))) {
    if (const fs::path mirrored = tests / (stem + "_test.cpp"); fs::exists(mirrored)) {
      files.insert(mirrored);
      break;
    }
    if (stem.find('_') == std::string::npos) break;
  }
  const std::string include = "#include \"" + fs::path(source).replace_extension(".hpp").string() + "\"";
  for (const auto& entry : fs::recursive_directory_iterator(floor)) {
    if (is_test_file(entry.path()) && read_whole(entry.path()).find(include) != std::string::npos)
      files.insert(entry.path());
  }
  return files;
}

/// The test that failed, or was running when the program ended.
std::string failed_test(const std::string& output) {
  std::smatch match;
  if (std::regex_search(output, match, std::regex("\\[  FAILED  \\] ([^ ,\n]+/?[^ ,\n]*)"))) return match[1];
  std::string last;
  const std::regex runs("\\[ RUN      \\] ([^ \n]+)");
  for (std::sregex_iterator it(output.begin(), output.end(), runs), end; it != end; ++it) last = (*it)[1];
  return last;
}

}  // namespace

std::string to_string(Outcome::Kind kind) {
  return kind == Outcome::Kind::noticed    ? "noticed"
         : kind == Outcome::Kind::survived ? "survived"
                                           : "not compiled";
}

TestProgram::TestProgram(const fs::path& repository, const fs::path& build, const std::string& floor)
    : repository_(repository), build_(build), floor_(floor) {
  const std::string target = floor + "_tests";
  const fs::path program = build / "bin" / target;
  if (!fs::exists(program)) throw std::runtime_error(program.string() + " is not there, expected it built");
  digest_ = std::to_string(hash_of(read_whole(program)));
  const fs::path scratch = build / "mutation" / "commands";
  const Ended commands = run_command("ninja -C " + quoted(build) + " -t commands " + target, scratch, {});
  if (!commands.is_good())
    throw std::runtime_error("ninja lists no commands of " + target + ", expected a Ninja build");
  const std::string& text = commands.output;
  const std::size_t end = text.find_last_not_of('\n');
  link_ = text.substr(text.rfind('\n', end) + 1, end - text.rfind('\n', end));
  for (const auto& entry : nlohmann::json::parse(read_whole(build / "compile_commands.json"))) {
    const fs::path file = fs::path(entry["file"].get<std::string>()).lexically_relative(repository);
    const std::string command = entry["command"];
    // A source of a floor, as the floor's library has it; tests of the same name are not its.
    if (*file.begin() == floor) units_[file.string()] = {repository / file, command};
    if (entry["file"].get<std::string>().starts_with((build / floor).string() + "/"))
      add_batch(entry["file"], command);
  }
}

/// A batch of a unity build includes each of its sources by its whole path.
void TestProgram::add_batch(const fs::path& batch, const std::string& command) {
  const std::string text = read_whole(batch);
  const std::regex include("#include \"([^\"\n]+)\"");
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it)
    units_[fs::path((*it)[1].str()).lexically_relative(repository_).string()] = {batch, command};
}

Ended TestProgram::run(const std::string& program, double usual, const std::string& filter,
                       const fs::path& folder) const {
  const fs::path scratch = folder / "scratch";
  fs::remove_all(scratch);
  const Limits limits{.cpu = 10.0 + 4.0 * usual, .wall = 60.0 + 10.0 * usual};
  const std::string data = "CLEARWAY_DATASETS=" + quoted(repository_ / "datasets");
  Ended ended =
      run_command("exec env " + data + " " + program + " --gtest_fail_fast --gtest_filter='" + filter + "'",
                  scratch, limits);
  fs::remove_all(scratch);
  return ended;
}

std::vector<std::string> TestProgram::stages_for(const std::string& file) const {
  const std::set<fs::path> nearest = tests_of(repository_, file);
  const std::string near = filter_of(nearest);
  if (near.empty()) return {"*"};
  if (floor_ == "apps") return {near};
  std::set<fs::path> room;  // the others of the mirrored folder
  for (const auto& entry : fs::directory_iterator(repository_ / "tests" / fs::path(file).parent_path()))
    if (is_test_file(entry.path()) && !nearest.contains(entry.path())) room.insert(entry.path());
  const std::string beside = filter_of(room);
  if (beside.empty()) return {near, "-" + near};
  return {near, beside + "-" + near, "-" + near + ":" + beside};
}

double TestProgram::usual_time(const std::string& filter, const fs::path& folder) {
  // What is left when a few are left out takes the same for every file, about: measured once.
  const std::string key = filter.starts_with('-') ? "rest" : filter;
  const std::lock_guard lock(mutex_);
  if (const auto known = usual_.find(key); known != usual_.end()) return known->second;
  // From where the faulty ones run, too: a place in which all tests fail would notice every fault.
  const fs::path program = folder / "faultless";
  // Copied by a process of its own: a file that this one has open for writing, no child of another thread can
  // run.
  run_command("cp " + quoted(build_ / "bin" / (floor_ + "_tests")) + " " + quoted(program), folder, {});
  const Ended ended = run(quoted(program), 150.0, filter, folder);
  fs::remove(program);
  if (!ended.is_good())
    throw std::runtime_error("without any fault the tests of " + floor_ + " fail in " +
                             failed_test(ended.output) + ", expected them to pass");
  return usual_[key] = ended.cpu;
}

fs::path TestProgram::write_faulty(const Candidate& candidate, const fs::path& folder) const {
  const fs::path faulty = folder / fs::path(candidate.file).filename();
  std::string text = candidate.fault.applied_to(read_whole(repository_ / candidate.file));
  // Code for several instruction sets includes itself (Highway): the fault must be in each of them.
  const std::string itself = "#define HWY_TARGET_INCLUDE ";
  if (const std::string original = itself + "\"" + candidate.file + "\"";
      text.find(original) != std::string::npos)
    text = replaced(text, original, itself + "\"" + faulty.string() + "\"");
  std::ofstream(faulty) << text;
  return faulty;
}

Ended TestProgram::build(const Unit& unit, const fs::path& source, const fs::path& folder, Link how) const {
  const fs::path object = folder / "fault.o", program = folder / "tests";
  // Warnings do not count as noticing. Less is optimized, which takes less time and changes no result.
  std::string compile = std::regex_replace(unit.command, std::regex(" -o \\S+ -c \\S+"), "");
  compile = std::regex_replace(compile, std::regex(" -O2(?= )"), " -O1");
  compile = std::regex_replace(compile, std::regex(" (-MD|-MT \\S+|-MF \\S+|-Werror)(?= )"), "");
  const std::string in_build = "cd " + quoted(build_) + " && ";
  Ended compiled =
      run_command(in_build + compile + " -w -o " + quoted(object) + " -c " + quoted(source), folder, {});
  if (!compiled.is_good()) return compiled;
  const std::string out = "-o bin/" + floor_ + "_tests";
  const std::string first = how == Link::beside_its_batch ? "-Wl,-z,muldefs " : "";
  Ended linked = run_command(
      in_build + replaced(link_, out, first + quoted(object) + " -o " + quoted(program)), folder, {});
  if (!linked.is_good() && how == Link::in_its_place)
    throw std::runtime_error("the tests of " + floor_ + " do not link: " + linked.output.substr(0, 800));
  return linked;
}

Outcome TestProgram::tested(const std::string& file, const fs::path& folder) {
  const fs::path program = folder / "tests";
  for (std::string filter : stages_for(file)) {
    const double usual = usual_time(filter, folder);
    for (int repeat = 0; repeat < 4; ++repeat) {
      const Ended ended = run(quoted(program), usual, filter, folder);
      if (ended.is_good()) break;
      const std::string test = failed_test(ended.output);
      if (ended.is_late) return {Outcome::Kind::noticed, test + " (takes too long)"};
      if (ended.signal != 0) return {Outcome::Kind::noticed, test + " (crashes)"};
      if (test.empty()) return {Outcome::Kind::noticed, "the program does not start"};
      if (!run(quoted(program), usual, test, folder).is_good()) return {Outcome::Kind::noticed, test};
      filter +=
          (filter.find('-') == std::string::npos ? "-" : ":") + test;  // it depends on the machine's mood
    }
  }
  return {Outcome::Kind::survived, ""};
}

Outcome TestProgram::tried(const Candidate& candidate, const fs::path& folder) {
  fs::create_directories(folder);
  // What is compiled is a copy, which includes by the same paths.
  const fs::path faulty = write_faulty(candidate, folder), original = repository_ / candidate.file;
  const Unit& unit = units_.at(candidate.file);
  fs::path source = faulty;
  if (unit.source != original) {
    // Alone it takes a fraction of the time. What other files of the batch have of it, inlined, is without
    // the fault then: what survives is tried in its batch.
    if (build(unit, faulty, folder, Link::beside_its_batch).is_good()) {
      const Outcome alone = tested(candidate.file, folder);
      if (alone.kind == Outcome::Kind::noticed) return alone;
    }
    source = folder / "batch.cpp";
    std::ofstream(source) << replaced(read_whole(unit.source), quoted_include(original),
                                      quoted_include(faulty));
  }
  const Ended built = build(unit, source, folder, Link::in_its_place);
  if (!built.is_good()) {
    std::smatch error;
    std::regex_search(built.output, error, std::regex("error: ([^\n]*)"));
    return {Outcome::Kind::not_compiled, error.size() > 1 ? error[1].str() : "compiler ended"};
  }
  return tested(candidate.file, folder);
}

}  // namespace clearway::mutation
