#include "tests/mutation/floor_build.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>

#include "tests/mutation/reach.hpp"

namespace clearway::mutation {
namespace {

namespace fs = std::filesystem;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) throw std::runtime_error("expected '" + what + "' in: " + text.substr(0, 400));
  return text.replace(at, what.size(), by);
}

std::string quoted_include(const fs::path& path) { return "#include \"" + path.string() + "\""; }

/// A faster one than the compiler's own, where it is installed.
std::string fast_linker() {
  for (const char* name : {"lld", "gold"})
    if (fs::exists(std::string("/usr/bin/ld.") + name)) return std::string("-fuse-ld=") + name + " ";
  return "";
}

}  // namespace

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

FloorBuild::FloorBuild(const fs::path& repository, const fs::path& build, const std::string& floor,
                       Costs& costs)
    : repository_(repository), build_(build), floor_(floor), costs_(costs) {
  if (!fs::exists(program()))
    throw std::runtime_error(program().string() + " is not there, expected it built");
  const std::string target = floor + "_tests";
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
void FloorBuild::add_batch(const fs::path& batch, const std::string& command) {
  const std::string text = read_whole(batch);
  const std::regex include("#include \"([^\"\n]+)\"");
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it)
    units_[fs::path((*it)[1].str()).lexically_relative(repository_).string()] = {batch, command};
}

/// A header of code that decides is compiled with the one source that includes it.
std::string FloorBuild::source_of(const std::string& file) const {
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

fs::path FloorBuild::write(const std::string& file, std::string text, const fs::path& folder) const {
  const fs::path other = folder / fs::path(file).filename();
  if (file.ends_with(".hpp")) {
    const std::string source = source_of(file);
    std::ofstream(other) << text;
    const fs::path including = folder / fs::path(source).filename();
    std::ofstream(including) << replaced(read_whole(repository_ / source), "#include \"" + file + "\"",
                                         quoted_include(other));
    return including;
  }
  // Code for several instruction sets includes itself (Highway): the fault must be in each of them.
  const std::string itself = "#define HWY_TARGET_INCLUDE ";
  if (const std::string original = itself + "\"" + file + "\""; text.find(original) != std::string::npos)
    text = replaced(text, original, itself + "\"" + other.string() + "\"");
  std::ofstream(other) << text;
  return other;
}

Ended FloorBuild::compiled(const Unit& unit, const fs::path& source, const fs::path& object,
                           const fs::path& folder) const {
  // Warnings do not count as noticing. Less is optimized, which takes less time and changes no result.
  std::string command = std::regex_replace(unit.command, std::regex(" -o \\S+ -c \\S+"), "");
  command = std::regex_replace(command, std::regex(" -O2(?= )"), " -O1");
  command = std::regex_replace(command, std::regex(" (-MD|-MT \\S+|-MF \\S+|-Werror)(?= )"), "");
  Ended ended = run_command(
      "cd " + quoted(build_) + " && " + command + " -w -o " + quoted(object) + " -c " + quoted(source),
      folder, {});
  costs_.add("compiling", ended.cpu);
  return ended;
}

Ended FloorBuild::linked(const Objects& objects, const fs::path& folder, Link how) const {
  static const std::string linker = fast_linker();
  std::string inputs = linker + (how == Link::beside_its_batch ? "-Wl,-z,muldefs " : "");
  for (const fs::path& object : objects) inputs += quoted(object) + " ";
  const std::string command =
      replaced(link_, "-o bin/" + floor_ + "_tests", inputs + "-o " + quoted(folder / "tests"));
  Ended ended = run_command("cd " + quoted(build_) + " && " + command, folder, {});
  costs_.add("linking", ended.cpu);
  return ended;
}

bool FloorBuild::shows_data(const fs::path& object, const fs::path& folder) const {
  const Ended symbols = run_command("nm " + quoted(object), folder, {});
  // Tables of virtual functions, "_ZT…", are looked up in the program.
  static const std::regex data("[0-9a-f]+ [BDGRS] (?!_ZT)");
  return !symbols.is_good() || std::regex_search(symbols.output, data);
}

bool FloorBuild::compiles_alone(const std::string& source, const fs::path& folder) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = alone_.find(source); known != alone_.end()) return known->second;
  }
  const bool does = compiled(units_.at(source), repository_ / source, folder / "alone.o", folder).is_good();
  const std::lock_guard lock(mutex_);
  return alone_[source] = does;
}

Ended FloorBuild::build(const Candidate& candidate, const fs::path& folder) {
  fs::create_directories(folder);
  // What is compiled is a copy, which includes by the same paths.
  const std::string name = source_of(candidate.file);
  const fs::path original = repository_ / name, object = folder / "fault.o";
  const fs::path faulty =
      write(candidate.file, candidate.fault.applied_to(read_whole(repository_ / candidate.file)), folder);
  const Unit& unit = units_.at(name);
  fs::path source = faulty;
  if (unit.source != original) {
    // Alone it takes a fraction of the time. Position-independent code calls functions of other files by
    // their symbols, those of its own batch too, and the first definition is linked.
    const Ended alone = compiled(unit, faulty, object, folder);
    if (alone.is_good() && unit.command.find(" -fPIC ") != std::string::npos && !shows_data(object, folder) &&
        linked({object}, folder, Link::beside_its_batch).is_good())
      return alone;
    if (!alone.is_good() && compiles_alone(name, folder)) return alone;
    source = folder / "batch.cpp";
    std::ofstream(source) << replaced(read_whole(unit.source), quoted_include(original),
                                      quoted_include(faulty));
  }
  const Ended whole = compiled(unit, source, object, folder);
  if (!whole.is_good()) return whole;
  const Ended program = linked({object}, folder, Link::in_its_place);
  if (!program.is_good())
    throw std::runtime_error("the tests of " + floor_ + " do not link: " + program.output.substr(0, 800));
  return whole;
}

std::set<int> FloorBuild::probed(const std::vector<Candidate>& candidates, const std::vector<int>& numbers,
                                 const fs::path& object, const fs::path& folder) const {
  const std::string& file = candidates.at(static_cast<std::size_t>(numbers.front())).file;
  const std::string text = read_whole(repository_ / file);
  const auto compiles = [&](const std::set<int>& wanted) {
    std::multimap<std::size_t, int> places;
    for (const int number : wanted)
      places.emplace(place_of_probe(text, candidates[static_cast<std::size_t>(number)].fault.at), number);
    if (places.empty() || places.rbegin()->first == std::string::npos) return false;
    std::string with = text;
    for (auto it = places.rbegin(); it != places.rend(); ++it) with = with_probe(with, it->first, it->second);
    return compiled(units_.at(file), write(file, declares_probes + with, folder), object, folder).is_good();
  };
  const std::set<int> all(numbers.begin(), numbers.end());
  if (compiles(all)) return all;
  std::set<int> some;
  for (const int number : numbers) {
    std::set<int> more = some;
    more.insert(number);
    if (compiles(more)) some = more;
  }
  if (!some.empty()) compiles(some);  // the last one tried may have left no object
  return some;
}

std::set<int> FloorBuild::build_with_probes(const std::vector<Candidate>& candidates,
                                            const fs::path& folder) {
  fs::create_directories(folder);
  std::map<std::string, std::vector<int>> of_files;
  for (std::size_t i = 0; i < candidates.size(); ++i)  // a header's probes would hide those of its source
    if (!candidates[i].file.ends_with(".hpp")) of_files[candidates[i].file].push_back(static_cast<int>(i));
  std::set<int> numbers;
  Objects objects{folder / "reached.o"};
  for (const auto& [file, of_file] : of_files) {
    const fs::path object = folder / ("probes" + std::to_string(objects.size()) + ".o");
    const std::set<int> some = probed(candidates, of_file, object, folder);
    if (!some.empty()) objects.push_back(object);
    numbers.insert(some.begin(), some.end());
  }
  if (!compiled(units_.at(source_of(candidates.front().file)),
                repository_ / "tests/mutation/probes/reached.cpp", objects.front(), folder)
           .is_good())
    throw std::runtime_error("tests/mutation/probes/reached.cpp does not compile");
  const Ended program = linked(objects, folder, Link::beside_its_batch);
  if (!program.is_good())
    throw std::runtime_error("the tests of " + floor_ +
                             " with probes do not link: " + program.output.substr(0, 800));
  return numbers;
}

}  // namespace clearway::mutation
