#include "tests/mutation/test_program.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/mutation/test_stages.hpp"
#include "tests/worlds/trials.hpp"

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

/// The test that failed, or was running when the program ended, or all tests of a suite that could not be set
/// up.
std::string failed_test(const std::string& output) {
  std::smatch match;
  if (std::regex_search(output, match, std::regex("\\[  FAILED  \\] ([^ ,\n]+): SetUpTestSuite")))
    return match[1].str() + ".*";
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
    : repository_(repository),
      build_(build),
      floor_(floor),
      most_trials_(trials(0, 1) == 0 ? Trials::few : Trials::many) {
  const std::string target = floor + "_tests";
  const fs::path program = build / "bin" / target;
  if (!fs::exists(program)) throw std::runtime_error(program.string() + " is not there, expected it built");
  digest_ = std::to_string(hash_of(read_whole(program) + (most_trials_ == Trials::many ? "many" : "")));
  load_times();
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
                       const fs::path& folder, Trials trials) const {
  const fs::path scratch = folder / "scratch";
  fs::remove_all(scratch);
  const Limits limits{.cpu = 10.0 + 4.0 * usual, .wall = 60.0 + 10.0 * usual};
  const std::string data = "CLEARWAY_DATASETS=" + quoted(repository_ / "datasets") +
                           " CLEARWAY_TRIALS=" + (trials == Trials::many ? "many" : "few");
  Ended ended =
      run_command("exec env " + data + " " + program + " --gtest_fail_fast --gtest_filter='" + filter + "'",
                  scratch, limits);
  fs::remove_all(scratch);
  return ended;
}

void TestProgram::measure(const std::string& filter, const fs::path& folder) {
  // From where the faulty ones run, too: a place in which all tests fail would notice every fault.
  const fs::path program = folder / "faultless";
  // Copied by a process of its own: a file that this one has open for writing, no child of another thread can
  // run.
  run_command("cp " + quoted(build_ / "bin" / (floor_ + "_tests")) + " " + quoted(program), folder, {});
  const unsigned shards = std::max(1U, std::thread::hardware_concurrency());
  std::vector<Ended> ended(shards);
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < shards; ++i) {
    threads.emplace_back([&, i] {
      const fs::path own = folder / ("measured" + std::to_string(i));
      const std::string shard = "GTEST_TOTAL_SHARDS=" + std::to_string(shards) +
                                " GTEST_SHARD_INDEX=" + std::to_string(i) +
                                " GTEST_OUTPUT=json:" + quoted(own / "times.json") + " ";
      ended[i] = run(shard + quoted(program), 600.0, filter, own, most_trials_);
    });
  }
  for (std::thread& thread : threads) thread.join();
  fs::remove(program);
  for (unsigned i = 0; i < shards; ++i) {
    if (!ended[i].is_good())
      throw std::runtime_error("without any fault the tests of " + floor_ + " fail in " +
                               failed_test(ended[i].output) + ", expected them to pass");
    add_times(folder / ("measured" + std::to_string(i)) / "times.json", ended[i].cpu);
  }
  std::ofstream kept(build_ / "mutation" / ("times_" + floor_ + ".txt"));
  kept << digest_ << '\n';
  for (const auto& [test, time] : times_) kept << test << ' ' << time << '\n';
}

/// Those that an earlier run measured of the same program.
void TestProgram::load_times() {
  std::ifstream kept(build_ / "mutation" / ("times_" + floor_ + ".txt"));
  std::string digest, test;
  if (!(kept >> digest) || digest != digest_) return;
  for (double time = 0.0; kept >> test >> time;) times_[test] = time;
}

/// gtest writes seconds of the clock, of which other programs may have used a part.
void TestProgram::add_times(const fs::path& json, double cpu) {
  const auto report = nlohmann::json::parse(read_whole(json));
  std::map<std::string, double> times;
  double sum = 1e-9;
  for (const auto& suite : report.at("testsuites")) {
    for (const auto& test : suite.at("testsuite")) {
      const double time = std::stod(test.at("time").get<std::string>());
      times[suite.at("name").get<std::string>() + "." + test.at("name").get<std::string>()] = time;
      sum += time;
    }
  }
  for (const auto& [name, time] : times) times_[name] = time * cpu / sum;
}

std::vector<std::string> TestProgram::tests_of(const std::string& filter, const fs::path& folder) const {
  const std::string program = quoted(build_ / "bin" / (floor_ + "_tests"));
  const Ended listed =
      run_command(program + " --gtest_list_tests --gtest_filter='" + filter + "'", folder, {});
  std::istringstream lines(listed.output);
  std::string suite, line;
  std::vector<std::string> names;
  while (std::getline(lines, line)) {
    const std::string name = line.substr(0, line.find("  #"));  // a parameter is behind it
    if (name.starts_with("  "))
      names.push_back(suite + name.substr(2));
    else
      suite = name;
  }
  return names;
}

double TestProgram::usual_time(const std::string& filter, const fs::path& folder) {
  const std::lock_guard lock(mutex_);
  if (const auto known = usual_.find(filter); known != usual_.end()) return known->second;
  const std::vector<std::string> tests = tests_of(filter, folder);
  const auto is_known = [&](const std::string& name) { return times_.contains(name); };
  if (!std::all_of(tests.begin(), tests.end(), is_known)) measure(floor_ == "apps" ? filter : "*", folder);
  double& usual = usual_[filter] = 0.0;
  for (const std::string& test : tests)
    if (is_known(test)) usual += times_.at(test);
  return usual;
}

/// A header of code that decides is compiled with the one source that includes it.
std::string TestProgram::source_of(const std::string& file) const {
  if (!file.ends_with(".hpp")) return file;
  std::vector<std::string> sources;
  for (const auto& [source, unit] : units_)
    if (read_whole(repository_ / source).find("#include \"" + file + "\"") != std::string::npos)
      sources.push_back(source);
  if (sources.size() != 1)
    throw std::runtime_error(file + " is included by " + std::to_string(sources.size()) +
                             " sources, expected one: faults in it would not be in all of its code");
  return sources.front();
}

fs::path TestProgram::write_faulty(const Candidate& candidate, const fs::path& folder) const {
  const fs::path faulty = folder / fs::path(candidate.file).filename();
  std::string text = candidate.fault.applied_to(read_whole(repository_ / candidate.file));
  if (candidate.file.ends_with(".hpp")) {
    const std::string source = source_of(candidate.file);
    std::ofstream(faulty) << text;
    const fs::path including = folder / fs::path(source).filename();
    std::ofstream(including) << replaced(read_whole(repository_ / source),
                                         "#include \"" + candidate.file + "\"", quoted_include(faulty));
    return including;
  }
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

Outcome TestProgram::tested(const std::vector<std::string>& stages, const fs::path& folder, Trials trials) {
  const fs::path program = folder / "tests";
  for (std::string filter : stages) {
    const double usual = usual_time(filter, folder);
    for (int repeat = 0; repeat < 4; ++repeat) {
      const Ended ended = run(quoted(program), usual, filter, folder, trials);
      if (ended.is_good()) break;
      const std::string test = failed_test(ended.output);
      if (ended.is_late) return {Outcome::Kind::noticed, test + " (takes too long)"};
      if (ended.signal != 0) return {Outcome::Kind::noticed, test + " (crashes)"};
      if (test.empty()) return {Outcome::Kind::noticed, "the program does not start"};
      if (!run(quoted(program), usual, test, folder, trials).is_good()) return {Outcome::Kind::noticed, test};
      filter +=
          (filter.find('-') == std::string::npos ? "-" : ":") + test;  // it depends on the machine's mood
    }
  }
  return {Outcome::Kind::survived, ""};
}

Outcome TestProgram::tried(const Candidate& candidate, const fs::path& folder) {
  fs::create_directories(folder);
  // What is compiled is a copy, which includes by the same paths.
  const std::string compiled = source_of(candidate.file);
  const fs::path faulty = write_faulty(candidate, folder), original = repository_ / compiled;
  const Unit& unit = units_.at(compiled);
  const std::vector<std::string> stages = stages_for(repository_, candidate.file);
  fs::path source = faulty;
  if (unit.source != original) {
    // Alone it takes a fraction of the time. What other files of the batch have of it, inlined, is without
    // the fault then: what survives is tried in its batch, and only there by the tests of other folders.
    if (build(unit, faulty, folder, Link::beside_its_batch).is_good()) {
      const Outcome alone =
          tested({stages.begin(), stages.begin() + (stages.size() + 1) / 2}, folder, Trials::few);
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
  const Outcome soon = tested(stages, folder, Trials::few);
  const bool is_all = soon.kind == Outcome::Kind::noticed || most_trials_ == Trials::few;
  return is_all ? soon : tested(stages, folder, most_trials_);
}

}  // namespace clearway::mutation
